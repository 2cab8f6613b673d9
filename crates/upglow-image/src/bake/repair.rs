//! Values that no cube holds, and colors that no material shows, made into ones that can be baked.

use rayon::prelude::*;
use upglow_color::rounding::to_single;
use upglow_color::{LinearRgb, StandingKind, choices};
use upglow_fit::StandingTable;

/// What to do with texels that cannot be baked as they are.
///
/// With each, a texel with a value that is NaN or infinite becomes black, and is counted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Repair {
    /// Each value becomes the nearest in 0..=1.
    Clip,
    /// The whole picture is divided by its greatest value, if that is above 1; what is negative
    /// becomes 0.
    Scale,
    /// Each texel becomes the nearest color in XYZ that some material shows, then each value the
    /// nearest in 0..=1.
    Nearest,
}

/// A repair with all it must know of the picture.
#[derive(Clone, Copy, Debug)]
pub(super) struct Repairer<'a> {
    pub(super) repair: Repair,
    /// The picture's greatest value, by [`greatest_value`], where [`Repair::reads_all_first`].
    pub(super) greatest: f32,
    /// What materials show under the picture's contract.
    pub(super) table: &'a StandingTable,
}

/// How many texels a repair changed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Repaired {
    /// Texels that are not what they were, those made black among them.
    pub(super) changed: u64,
    /// Texels with a value that was NaN or infinite, made black.
    made_black: u64,
}

/// Texels that one core repairs at a time: enough to be worth handing over.
const REPAIRED_TOGETHER: usize = 1024;

/// How far a texel moves from the border of what materials show towards a gray, as a share of the
/// distance. Single precision rounds by 6e-8, so with much less a texel could end up outside; with much
/// more one could see it.
const OFF_THE_BORDER: f64 = 1e-5;

/// Halvings of the distance to gray for a color that 0..=1 moved out of reach: to a thousandth of it.
const HALVINGS: usize = 10;

/// The greatest finite value; 0 if there is none above. The greatest of a picture is the greatest
/// of its parts.
pub(super) fn greatest_value(rgb: &[[f32; 3]]) -> f32 {
    let finite = rgb.as_flattened().iter().copied().filter(|v| v.is_finite());
    finite.fold(0.0, f32::max)
}

impl Repair {
    /// Whether the whole picture must be read once, for [`greatest_value`], before a texel changes.
    pub(super) fn reads_all_first(self) -> bool {
        self == Self::Scale
    }
}

impl Repairer<'_> {
    /// Repairs texels in place. Afterwards all values are in 0..=1.
    pub(super) fn repair(&self, rgb: &mut [[f32; 3]]) -> Repaired {
        let parts = rgb.par_chunks_mut(REPAIRED_TOGETHER);
        let repaired = parts.map(|part| {
            part.iter_mut().fold(Repaired::default(), |sum, texel| sum.with(self.texel(texel)))
        });
        repaired.reduce(Repaired::default, Repaired::with)
    }

    fn texel(&self, texel: &mut [f32; 3]) -> Repaired {
        let made_black = texel.iter().any(|v| !v.is_finite());
        let repaired = if made_black { [0.0; 3] } else { self.color(*texel) };
        let changed = repaired != *texel;
        *texel = repaired;
        Repaired { changed: u64::from(changed), made_black: u64::from(made_black) }
    }

    fn color(&self, rgb: [f32; 3]) -> [f32; 3] {
        match self.repair {
            Repair::Scale if self.greatest > 1.0 => rgb.map(|v| clipped(v / self.greatest)),
            Repair::Clip | Repair::Scale => rgb.map(clipped),
            Repair::Nearest => nearest(rgb, self.table),
        }
    }
}

impl Repaired {
    /// Both together.
    fn with(self, other: Self) -> Self {
        Self {
            changed: self.changed + other.changed,
            made_black: self.made_black + other.made_black,
        }
    }
}

/// The nearest value in 0..=1.
fn clipped(value: f32) -> f32 {
    value.clamp(0.0, 1.0)
}

/// The nearest color that some material shows, in 0..=1, as single precision holds it.
///
/// Clipping may move it out of reach again; then it goes on straight towards the gray of its mean
/// value, no further than it must.
fn nearest(rgb: [f32; 3], table: &StandingTable) -> [f32; 3] {
    if is_shown(rgb, table) && is_shown(rgb.map(clipped), table) {
        return rgb.map(clipped);
    }
    // Of a color within reach this is the color itself.
    let found = table.standing(LinearRgb(rgb.map(f64::from))).fluorescence.color;
    let found = table.colorimetry().rgb_from_xyz(found).0.map(|v| v.clamp(0.0, 1.0));
    let gray = found.iter().sum::<f64>() / 3.0;
    let towards_gray = |share: f64| found.map(|v| to_single(v + share * (gray - v)));
    let shown = |share: f64| is_shown(towards_gray(share), table);
    towards_gray(if shown(OFF_THE_BORDER) { OFF_THE_BORDER } else { least_share(shown) })
}

/// About the least share of the distance to gray at which a color is shown; gray itself is.
fn least_share(shown: impl Fn(f64) -> bool) -> f64 {
    let (mut outside, mut inside) = (OFF_THE_BORDER, 1.0);
    for _ in 0..HALVINGS {
        let middle = (outside + inside) / 2.0;
        *(if shown(middle) { &mut inside } else { &mut outside }) = middle;
    }
    inside
}

fn is_shown(rgb: [f32; 3], table: &StandingTable) -> bool {
    table.kind(LinearRgb(rgb.map(f64::from))) != StandingKind::Unreachable
}

choices!(Repair, "repair", Clip = "clip", Scale = "scale", Nearest = "nearest");

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::sync::OnceLock;
    use upglow_color::{Choice, Contract};

    fn table() -> &'static StandingTable {
        static TABLE: OnceLock<StandingTable> = OnceLock::new();
        TABLE.get_or_init(|| StandingTable::new(&Contract::default()))
    }

    fn repairer(repair: Repair, greatest: f32) -> Repairer<'static> {
        Repairer { repair, greatest, table: table() }
    }

    fn any_value() -> impl Strategy<Value = f32> {
        let odd = prop::sample::select(vec![f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX]);
        prop_oneof![8 => -0.5..3.0_f32, 1 => odd]
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        #[test]
        fn after_any_repair_all_values_are_in_range_and_a_second_one_changes_nothing(
            texels in prop::collection::vec(prop::array::uniform3(any_value()), 1..40),
        ) {
            for &repair in Repair::ALL {
                let mut rgb = texels.clone();
                let found = repairer(repair, greatest_value(&rgb)).repair(&mut rgb);
                prop_assert!(rgb.as_flattened().iter().all(|v| (0.0..=1.0).contains(v)));
                let black = texels.iter().filter(|t| t.iter().any(|v| !v.is_finite())).count();
                prop_assert_eq!(found.made_black, black as u64);
                let changed = texels.iter().zip(&rgb).filter(|(a, b)| a != b).count();
                prop_assert_eq!(found.changed, changed as u64);
                let again = repairer(repair, greatest_value(&rgb)).repair(&mut rgb);
                prop_assert_eq!(again, Repaired::default(), "{}", repair);
            }
        }

        #[test]
        fn the_nearest_is_shown_by_some_material(rgb in prop::array::uniform3(-0.5..3.0_f32)) {
            let mut texel = [rgb];
            repairer(Repair::Nearest, 0.0).repair(&mut texel);
            prop_assert!(is_shown(texel[0], table()), "{rgb:?} {texel:?}");
        }
    }

    #[test]
    fn colors_that_can_be_baked_stay_to_the_bit() {
        let good = [[0.0; 3], [1.0; 3], [0.2, 0.3, 0.4], [0.9, 0.0, 0.9]];
        for &repair in Repair::ALL {
            let mut rgb = good;
            let found = repairer(repair, greatest_value(&rgb)).repair(&mut rgb);
            assert_eq!((rgb, found), (good, Repaired::default()), "{repair}");
        }
    }

    #[test]
    fn scaling_keeps_the_ratios_and_makes_the_greatest_value_one() {
        let mut rgb = [[2.0, 1.0, 0.5], [-1.0, 4.0, f32::INFINITY], [0.0, 4.0, 1.0]];
        let greatest = greatest_value(&rgb);
        let found = repairer(Repair::Scale, greatest).repair(&mut rgb);
        assert_eq!(rgb, [[0.5, 0.25, 0.125], [0.0; 3], [0.0, 1.0, 0.25]]);
        assert_eq!(found, Repaired { changed: 3, made_black: 1 });
    }

    #[test]
    fn names_round_trip() {
        for &repair in Repair::ALL {
            assert_eq!(repair.to_string().parse(), Ok(repair));
        }
        assert!("shift".parse::<Repair>().is_err());
    }
}
