//! Which kinds of material millions of colors need: the results of
//! [`ColorSolids`](upglow_color::ColorSolids), from convexity instead of a search for each color.

mod boxes;

use std::sync::OnceLock;

use upglow_color::{ColorSolids, Colorimetry, Contract, LinearRgb, Standing, StandingKind};

use boxes::{BoxLattice, Cell, FLUORESCENCE, REFLECTANCE, Reach};

/// The results of [`ColorSolids::standing`](upglow_color::ColorSolids::standing) under one contract,
/// fast enough for every texel of a picture.
///
/// Both solids of colors are convex. So a box of RGB is inside a solid if its eight corners are, and
/// outside if a plane separates them all from it; only colors in boxes that a surface passes through
/// need a search. The size of boxes depends on the color's largest channel, so that they resolve dark
/// colors as finely as bright ones. A box is examined at the first color in it. The results do not
/// depend on earlier colors, or on threads.
#[derive(Debug)]
#[must_use]
pub struct StandingTable {
    reach: Reach,
    /// Black and white, which are frequent in pictures and lie on a surface.
    known: [(LinearRgb, StandingKind); 2],
    /// `[size][signs of blue, green, red]`.
    lattices: Vec<OnceLock<BoxLattice>>,
}

/// The kind of material that a color needs, and an estimate of how far outside it is.
#[derive(Clone, Copy, Debug, PartialEq)]
#[must_use]
pub struct Estimate {
    /// Exactly the kind of [`StandingTable::standing`].
    pub kind: StandingKind,
    /// Distance in XYZ to the nearest color of a reflectance, or, if the color is unreachable, of any
    /// material. Interpolated, and never below the exact distance; 0 for a reflectance.
    pub distance: f64,
    /// ΔE00 to that color, interpolated; 0 for a reflectance.
    pub de2000: f64,
}

/// The largest lattice has size 2⁴ = 16, more than any color that is fitted
/// ([`crate::Fitter::BRIGHTEST`]). Brighter colors are rare enough for a search each.
const LARGEST_EXPONENT: i64 = 4;

/// The smallest has size 2⁻¹³, less than the darkest value of 8 bits in sRGB. Smaller helps only darker
/// colors; larger makes dark pictures need searches.
const SMALLEST_EXPONENT: i64 = -13;

/// Combinations of signs of three channels.
const OCTANTS: usize = 8;

impl StandingTable {
    /// A table for `contract`, by sums over 5 nm; it is filled as it is used.
    pub fn new(contract: &Contract) -> Self {
        let reach = Reach::new(contract);
        let known = [0.0, 1.0].map(|v| (LinearRgb([v; 3]), reach.kind(LinearRgb([v; 3]))));
        let sizes = usize::try_from(LARGEST_EXPONENT - SMALLEST_EXPONENT + 1)
            .expect("the largest is not the smallest");
        let lattices = std::iter::repeat_with(OnceLock::new).take(sizes * OCTANTS).collect();
        Self { reach, known, lattices }
    }

    /// White, matrices and weights of the contract, by sums over 5 nm.
    pub fn colorimetry(&self) -> &Colorimetry {
        &self.reach.colorimetry
    }

    /// The colors that materials reach under the contract.
    pub fn solids(&self) -> &ColorSolids {
        &self.reach.solids
    }

    /// The kind of material that `rgb` needs, and the nearest colors that materials reach; takes a search
    /// unless a reflectance reaches it.
    pub fn standing(&self, rgb: LinearRgb) -> Standing {
        let color = self.colorimetry().xyz_from_rgb(rgb);
        self.reach.solids.standing_of_kind(color, self.kind(rgb))
    }

    /// The kind of material that `rgb` needs; takes nanoseconds for most colors.
    ///
    /// # Examples
    ///
    /// ```
    /// use upglow_color::{Contract, LinearRgb, StandingKind};
    /// use upglow_fit::StandingTable;
    ///
    /// let table = StandingTable::new(&Contract::default());
    /// assert_eq!(table.kind(LinearRgb([0.5, 0.4, 0.3])), StandingKind::Reflectance);
    /// assert_eq!(table.kind(LinearRgb([0.9, 0.0, 0.9])), StandingKind::NeedsFluorescence);
    /// assert_eq!(table.kind(LinearRgb([0.0, 1.0, 0.0])), StandingKind::Unreachable);
    /// ```
    pub fn kind(&self, rgb: LinearRgb) -> StandingKind {
        self.look(rgb).0
    }

    /// The kind of material that `rgb` needs, and an estimate of how far outside it is.
    pub fn estimate(&self, rgb: LinearRgb) -> Estimate {
        let (kind, lattice) = self.look(rgb);
        let [distance, de2000] = match (kind, lattice) {
            (StandingKind::Reflectance, _) => [0.0; 2],
            (StandingKind::NeedsFluorescence, Some(at)) => at.interpolate(rgb, REFLECTANCE),
            (StandingKind::Unreachable, Some(at)) => at.interpolate(rgb, FLUORESCENCE),
            (_, None) => {
                let beyond = self.standing(rgb).beyond();
                [beyond.distance, beyond.de2000]
            }
        };
        Estimate { kind, distance, de2000 }
    }

    /// The kind, and the lattice with the box around `rgb`; `None` if none is large enough.
    fn look(&self, rgb: LinearRgb) -> (StandingKind, Option<&BoxLattice>) {
        let Some(mut lattice) = self.lattice(rgb) else {
            return (self.reach.kind(rgb), None);
        };
        loop {
            match lattice.cell(rgb, &self.reach) {
                Cell::Settled(kind) => return (*kind, Some(lattice)),
                Cell::Divided(parts) => lattice = parts,
                Cell::Mixed(mixed) => {
                    let known = self.known.iter().find(|(color, _)| *color == rgb);
                    let kind = match known {
                        Some((_, kind)) => *kind,
                        None => lattice.kind_in(mixed, rgb, &self.reach),
                    };
                    return (kind, Some(lattice));
                }
            }
        }
    }

    /// The lattice whose size fits `rgb`; `None` if none is large enough.
    fn lattice(&self, rgb: LinearRgb) -> Option<&BoxLattice> {
        let [r, g, b] = rgb.0;
        let largest = r.abs().max(g.abs()).max(b.abs());
        // The sum is finite only if all components are.
        if !(r + g + b).is_finite() {
            return None;
        }
        let exponent = exponent_above(largest).max(SMALLEST_EXPONENT);
        let size = usize::try_from(LARGEST_EXPONENT - exponent).ok()?;
        let octant = rgb.0.iter().rev().fold(0, |o, v| o << 1 | usize::from(v.is_sign_negative()));
        let new = || BoxLattice::around_black(exponent, octant);
        Some(self.lattices[size * OCTANTS + octant].get_or_init(new))
    }
}

/// The least k for which `value` ≤ 2ᵏ, for numbers ≥ 0; −1021 for subnormal numbers.
fn exponent_above(value: f64) -> i64 {
    const MANTISSA_BITS: u32 = 52;
    const BIAS: i64 = 1023;
    // One unit in the last place less, so that k of 2ᵏ is not k + 1.
    let below = value.to_bits().saturating_sub(1);
    (below >> MANTISSA_BITS).cast_signed() - BIAS + 1
}

#[cfg(test)]
mod tests {
    use super::*;
    use rayon::prelude::*;
    use upglow_color::{Adaptation, Illuminant, RgbSpace};

    fn contracts() -> [Contract; 3] {
        let space = |name| RgbSpace::named(name).unwrap();
        let light = |name| Illuminant::named(name).unwrap();
        [
            Contract::default(),
            Contract { space: space("srgb"), illuminant: light("a"), ..Contract::default() },
            Contract {
                space: space("rec2020"),
                adaptation: Adaptation::None,
                ..Contract::default()
            },
        ]
    }

    /// Numbers in 0..1 that are the same in each run: the fractions of multiples of three
    /// irrational numbers fill a cube evenly (an additive recurrence).
    fn spread(index: u32) -> [f64; 3] {
        const STEPS: [f64; 3] =
            [0.819_172_513_396_164_4, 0.671_043_606_703_789_2, 0.549_700_477_901_907_1];
        STEPS.map(|step| (f64::from(index) * step).fract())
    }

    /// Colors inside the unit cube, dark ones, bright ones and negative ones.
    fn color(index: u32) -> LinearRgb {
        let unit = spread(index);
        LinearRgb(match index % 5 {
            0 | 1 => unit,
            2 => unit.map(|v| v * f64::exp2(-f64::from(index % 17))),
            3 => unit.map(|v| 2.5 * v),
            _ => unit.map(|v| 1.3 * v - 0.15),
        })
    }

    /// The result without the table.
    fn searched(table: &StandingTable, rgb: LinearRgb) -> Standing {
        let colorimetry = table.colorimetry();
        ColorSolids::new(colorimetry).standing(colorimetry.xyz_from_rgb(rgb))
    }

    fn assert_same_answers(contract: &Contract, count: u32) {
        let table = StandingTable::new(contract);
        let wrong: Vec<_> = (0..count)
            .into_par_iter()
            .map(color)
            .filter(|&rgb| table.kind(rgb) != searched(&table, rgb).kind)
            .collect();
        assert!(wrong.is_empty(), "{} under {:?}: {wrong:?}", wrong.len(), contract.space);
    }

    #[test]
    fn standings_equal_those_without_the_table() {
        for contract in contracts() {
            let table = StandingTable::new(&contract);
            for rgb in (0..100).map(color) {
                assert_eq!(table.standing(rgb), searched(&table, rgb), "{rgb:?}");
            }
        }
    }

    #[test]
    fn kinds_equal_those_of_the_search() {
        contracts().iter().for_each(|contract| assert_same_answers(contract, 10_000));
    }

    #[test]
    #[ignore = "slow: half a minute; the test above has a tenth as many colors"]
    fn slow_kinds_of_a_hundred_thousand_colors_equal_those_of_the_search() {
        contracts().iter().for_each(|contract| assert_same_answers(contract, 100_000));
    }

    #[test]
    fn kinds_of_corners_and_unusual_numbers_equal_those_of_the_search() {
        let values = [0.0, -0.0, 1.0, 0.5, 2.0, 16.0, 17.0, 1e30, -1.0, 1e-300, f64::MIN_POSITIVE];
        let table = StandingTable::new(&Contract::default());
        let n = values.len();
        for index in 0..n * n * n {
            let rgb = LinearRgb([index, index / n, index / (n * n)].map(|k| values[k % n]));
            assert_eq!(table.kind(rgb), searched(&table, rgb).kind, "{rgb:?}");
        }
    }

    #[test]
    fn nan_and_infinity_are_unreachable() {
        let table = StandingTable::new(&Contract::default());
        for odd in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX] {
            for k in 0..3 {
                let mut rgb = [0.5; 3];
                rgb[k] = odd;
                assert_eq!(table.kind(LinearRgb(rgb)), StandingKind::Unreachable, "{rgb:?}");
            }
        }
    }

    #[test]
    fn an_estimate_never_understates_the_distance_and_rarely_overstates_it_much() {
        /// A coarse box is 1/32 wide; its surface is curved by less than this on average, in XYZ.
        const MEAN_EXCESS: f64 = 2e-3;
        let table = StandingTable::new(&Contract::default());
        let (mut excess, mut count) = (0.0, 0.0);
        for rgb in (0..5000).map(color) {
            let estimate = table.estimate(rgb);
            assert_eq!(estimate.kind, table.kind(rgb));
            let gap = table.standing(rgb).beyond().distance;
            // Rounding of sums, and the tolerance of the search.
            assert!(estimate.distance >= gap - 1e-8, "{rgb:?} {estimate:?} {gap}");
            if rgb.0.iter().all(|v| *v <= 1.0) && gap > 0.0 {
                excess += estimate.distance - gap;
                count += 1.0;
            }
        }
        assert!(count > 100.0 && excess / count < MEAN_EXCESS, "{excess} {count}");
    }

    #[test]
    fn the_distance_is_0_within_reach_and_positive_outside() {
        let table = StandingTable::new(&Contract::default());
        let gray = table.standing(LinearRgb([0.5; 3]));
        assert_eq!((gray.reflectance.distance, gray.fluorescence.de2000), (0.0, 0.0));
        let green = table.standing(LinearRgb([0.0, 1.0, 0.0]));
        assert!(green.reflectance.distance > green.fluorescence.distance);
        assert!(green.fluorescence.de2000 > 1.0);
    }
}
