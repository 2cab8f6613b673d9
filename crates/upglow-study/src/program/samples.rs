//! Measured surfaces: sets of samples whose colors under any light are known.

use upglow_color::{Adaptation, Colorimetry, Contract, Grid, Lab, Spectrum, Xyz};

use crate::bispectral::Measured;

/// A measured surface.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Sample {
    /// A reflectance from 380 to 780 nm; below and above it is that of the end.
    ///
    /// # Source
    ///
    /// `cie015` recommends the nearest measured value for what is not measured.
    Reflectance(Spectrum),
    /// What of each band of light leaves in each other band.
    Bispectral(Measured),
}

impl Sample {
    /// The color under the light of `colorimetry`, which is on [`SampleSet::grid`].
    pub(crate) fn color(&self, colorimetry: &Colorimetry) -> Xyz {
        match self {
            Self::Reflectance(curve) => {
                let [first, last] = [curve.grid().first_nm(), curve.grid().last_nm()];
                let at = |nm: &f64| curve.at(nm.clamp(f64::from(first), f64::from(last)));
                colorimetry.xyz_from_reflectance(colorimetry.wavelengths_nm().iter().map(at))
            }
            Self::Bispectral(measured) => measured.color(colorimetry),
        }
    }
}

/// Samples of one kind.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SampleSet {
    /// What reports call it.
    pub(crate) name: &'static str,
    pub(crate) samples: Vec<Sample>,
    /// The grid of the sums over their spectra.
    pub(crate) grid: Grid,
}

impl SampleSet {
    /// The 99 object colors of CIE 224:2017.
    pub(crate) fn object_colors() -> Self {
        Self::of_reflectances("99 object colors", include_str!("../../data/ces.csv"))
    }

    /// The paints of the `ColorChecker` chart as ISO 17321-1 has them.
    pub(crate) fn paints() -> Self {
        Self::of_reflectances("24 paints", include_str!("../../data/color_checker.csv"))
    }

    /// Measured fluorescent materials.
    pub(crate) fn fluorescent(measured: &[Measured]) -> Self {
        let samples = measured.iter().cloned().map(Sample::Bispectral).collect();
        Self { name: "fluorescent materials", samples, grid: Measured::GRID }
    }

    fn of_reflectances(name: &'static str, text: &str) -> Self {
        let rows = rows(text);
        let grid = Grid::try_new(380, 780, 5).expect("the wavelengths ascend");
        let is_on_grid = grid.wavelengths_nm().eq(rows.iter().map(|row| row[0]));
        assert!(is_on_grid, "the wavelengths of {name} are 380, 385 … 780 nm");
        let curve = |column: usize| {
            let values = rows.iter().map(|row| row[column]).collect();
            Sample::Reflectance(Spectrum::new(grid, values).expect("the table fills the grid"))
        };
        Self { name, samples: (1..rows[0].len()).map(curve).collect(), grid: Grid::FINE }
    }
}

/// Colors of the border of Pointer's gamut, the most saturated surfaces ever measured, under the light of
/// `contract`: adapted from illuminant C after Bradford.
pub(crate) fn pointers_border(contract: &Contract) -> Vec<Xyz> {
    /// Illuminant C, `cie015`, table T.3.
    const C: Xyz = Xyz([0.980_74, 1.0, 1.182_32]);
    let white = contract.on(Grid::FIT).white();
    let adapted = Adaptation::Bradford.target_from_source(C, white);
    let rows = rows(include_str!("../../data/pointer_gamut.csv"));
    let lab = rows.into_iter().map(|row| {
        let (sin, cos) = row[2].to_radians().sin_cos();
        Lab { l: row[0], a: row[1] * cos, b: row[1] * sin }
    });
    lab.map(|lab| Xyz(adapted * xyz_from_lab(lab, C).0)).collect()
}

/// The inverse of [`upglow_color::lab_from_xyz`].
fn xyz_from_lab(lab: Lab, white: Xyz) -> Xyz {
    let y = (lab.l + 16.0) / 116.0;
    let f = [y + lab.a / 500.0, y, y - lab.b / 200.0];
    Xyz([0, 1, 2].map(|k| {
        let linear = 3.0 * (6.0_f64 / 29.0).powi(2) * (f[k] - 4.0 / 29.0);
        white.0[k] * if f[k] > 6.0 / 29.0 { f[k].powi(3) } else { linear }
    }))
}

/// The numbers of a table that is part of the program: its rows below comments and header.
fn rows(text: &str) -> Vec<Vec<f64>> {
    let lines = text.lines().filter(|line| !line.starts_with('#')).skip(1);
    let number = |cell: &str| cell.parse().expect("the table holds numbers");
    lines.map(|line| line.split(',').map(number).collect()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use upglow_color::lab_from_xyz;

    #[test]
    fn the_tables_have_as_many_samples_as_their_names_say() {
        let count = |set: SampleSet| set.samples.len();
        assert_eq!(count(SampleSet::object_colors()), 99);
        assert_eq!(count(SampleSet::paints()), 24);
        assert_eq!(pointers_border(&Contract::default()).len(), 576);
    }

    #[test]
    fn reflectances_are_shares() {
        for set in [SampleSet::object_colors(), SampleSet::paints()] {
            for sample in &set.samples {
                let Sample::Reflectance(curve) = sample else { panic!("{}", set.name) };
                assert!(curve.values().iter().all(|r| (0.0..=1.0).contains(r)), "{sample:?}");
            }
        }
    }

    #[test]
    fn the_white_paint_has_the_published_color() {
        // ISO 17321-1's figures under D50 after the maker: L* 96.5, a* -0.4, b* 1.2; charts differ by 1.
        let illuminant = upglow_color::Illuminant::named("D50").unwrap();
        let colorimetry = Contract { illuminant, ..Contract::default() }.on(Grid::FINE);
        let white = SampleSet::paints().samples[18].color(&colorimetry);
        let Lab { l, a, b } = colorimetry.lab_from_xyz(white);
        assert!(
            (l - 96.5).abs() < 1.5 && (a + 0.4).abs() < 1.0 && (b - 1.2).abs() < 2.0,
            "{l} {a} {b}"
        );
    }

    #[test]
    fn lab_is_converted_both_ways() {
        let white = Contract::default().on(Grid::FIT).white();
        for lab in [[50.0, 40.0, -60.0], [3.0, 1.0, -2.0], [90.0, -20.0, 80.0]] {
            let [l, a, b] = lab;
            let found = lab_from_xyz(xyz_from_lab(Lab { l, a, b }, white), white);
            // Rounding only.
            assert!(found.de76(Lab { l, a, b }) < 1e-9, "{found:?}");
        }
    }
}
