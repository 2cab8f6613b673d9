//! Wavelength grids.

use crate::rounding::whole;

/// Equally spaced wavelengths, both ends included.
///
/// An integral over a grid is the sum of the samples times [`Grid::step_nm`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Grid {
    first_nm: u32,
    last_nm: u32,
    step_nm: u32,
}

/// Why a wavelength grid is rejected.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum GridError {
    /// The range is empty, or the step is zero or does not divide it.
    #[error(
        "grid {first_nm} to {last_nm} nm in steps of {step_nm} nm, expected first < last and a step > 0 that divides the range"
    )]
    Step {
        /// First wavelength, nm.
        first_nm: u32,
        /// Last wavelength, nm.
        last_nm: u32,
        /// Step, nm.
        step_nm: u32,
    },
}

impl Grid {
    /// 300, 301 … 830 nm: the grid on which every spectrum is stored and on which results are verified.
    pub const FINE: Self = Self { first_nm: 300, last_nm: 830, step_nm: 1 };
    /// 300, 305 … 830 nm: the grid of the sums in a fit.
    pub const FIT: Self = Self { first_nm: 300, last_nm: 830, step_nm: 5 };

    /// The grid from `first_nm` to `last_nm`.
    ///
    /// # Errors
    ///
    /// [`GridError::Step`] unless first < last and the step is > 0 and divides the range.
    pub const fn try_new(first_nm: u32, last_nm: u32, step_nm: u32) -> Result<Self, GridError> {
        if first_nm >= last_nm || step_nm == 0 || !(last_nm - first_nm).is_multiple_of(step_nm) {
            return Err(GridError::Step { first_nm, last_nm, step_nm });
        }
        Ok(Self { first_nm, last_nm, step_nm })
    }

    /// The grid of these ascending wavelengths, if they are one.
    pub(crate) fn of(wavelengths_nm: &[f64]) -> Option<Self> {
        let &[first, second, ..] = wavelengths_nm else { return None };
        let last = wavelengths_nm[wavelengths_nm.len() - 1];
        let [first, step, last] = [first, second - first, last].map(|nm| whole(nm).try_into().ok());
        let grid = Self::try_new(first?, last?, step?).ok()?;
        grid.wavelengths_nm().eq(wavelengths_nm.iter().copied()).then_some(grid)
    }

    /// First wavelength, nm.
    pub const fn first_nm(self) -> u32 {
        self.first_nm
    }

    /// Last wavelength, nm.
    pub const fn last_nm(self) -> u32 {
        self.last_nm
    }

    /// Distance between neighbors, nm.
    pub const fn step_nm(self) -> u32 {
        self.step_nm
    }

    /// Number of wavelengths; at least 2.
    #[expect(clippy::len_without_is_empty, reason = "a grid is never empty")]
    pub const fn len(self) -> usize {
        ((self.last_nm - self.first_nm) / self.step_nm) as usize + 1
    }

    /// The wavelengths in ascending order, nm.
    pub fn wavelengths_nm(
        self,
    ) -> impl DoubleEndedIterator<Item = f64> + ExactSizeIterator + Clone {
        let Self { first_nm, step_nm, .. } = self;
        (0..self.len()).map(move |i| f64::from(first_nm) + f64::from(step_nm) * i as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_fit_grid_has_107_wavelengths_from_300_to_830() {
        let nm: Vec<f64> = Grid::FIT.wavelengths_nm().collect();
        assert_eq!((nm.len(), nm[0], nm[1], nm[106]), (107, 300.0, 305.0, 830.0));
        assert_eq!(Grid::FINE.len(), 531);
    }

    #[test]
    fn wavelengths_without_a_common_step_are_no_grid() {
        let of = |nm: &[f64]| Grid::of(nm);
        assert_eq!(of(&[300.0, 310.0, 320.0]), Grid::try_new(300, 320, 10).ok());
        assert_eq!([of(&[300.0, 310.0, 325.0]), of(&[300.5, 310.5]), of(&[300.0])], [None; 3]);
    }

    #[test]
    fn a_step_that_does_not_divide_the_range_is_refused() {
        assert!(Grid::try_new(400, 700, 7).is_err());
        assert!(Grid::try_new(400, 700, 0).is_err());
        assert!(Grid::try_new(700, 400, 10).is_err());
        assert_eq!(Grid::try_new(400, 700, 10).unwrap().len(), 31);
    }
}
