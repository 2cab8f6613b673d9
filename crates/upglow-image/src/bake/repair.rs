//! Changes colors that cannot be baked into colors that can.

use rayon::prelude::*;
use upglow_color::rounding::to_single;
use upglow_color::{LinearRgb, StandingKind, choices};
use upglow_fit::StandingTable;

/// How to change texels that cannot be baked as they are.
///
/// Texels with a value that is NaN or infinite always become black. Alpha of NaN and -∞ becomes 0, that of +∞
/// becomes 1; finite alpha stays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Repair {
    /// Clamps each value to 0..=1.
    Clip,
    /// Divides the whole picture by its greatest value, if that is above 1; negative values become 0.
    Scale,
    /// Moves each texel to the nearest color in XYZ that some material matches, then clamps each value
    /// to 0..=1.
    Nearest,
}

/// A repair, and the data that it uses.
#[derive(Clone, Copy, Debug)]
pub(super) struct Repairer<'a> {
    pub(super) repair: Repair,
    /// For [`Repair::Scale`]: the [`greatest_value`] of the picture.
    pub(super) greatest: f32,
    /// The colors that materials match under the picture's contract.
    pub(super) table: &'a StandingTable,
}

/// Texels per parallel task.
const REPAIRED_TOGETHER: usize = 1024;

/// How far a texel moves from the border of the reachable colors towards a gray, as a share of the
/// distance. Single precision rounds by 6e-8: a much smaller share could leave a texel outside; a much
/// larger one would be visible.
const OFF_THE_BORDER: f64 = 1e-5;

/// Bisections of the distance to gray, for a color that clamping made unreachable.
const BISECTIONS: usize = 10;

/// The greatest finite value; 0 if none is above 0.
pub(super) fn greatest_value(rgb: &[[f32; 3]]) -> f32 {
    let finite = rgb.as_flattened().iter().copied().filter(|v| v.is_finite());
    finite.fold(0.0, f32::max)
}

impl Repairer<'_> {
    /// Repairs texels in place, so that all values of colors are in 0..=1 and alpha is finite. Returns the
    /// number of texels that changed.
    pub(super) fn repair(&self, rgb: &mut [[f32; 3]], alpha: Option<&mut [f32]>) -> u64 {
        let changed = |texel: &mut [f32; 3]| {
            let is_finite = texel.iter().all(|v| v.is_finite());
            let repaired = if is_finite { self.color(*texel) } else { [0.0; 3] };
            std::mem::replace(texel, repaired) != repaired
        };
        let texels = rgb.par_iter_mut().with_min_len(REPAIRED_TOGETHER);
        match alpha {
            Some(alpha) => {
                let each = texels.zip(alpha);
                each.map(|(rgb, alpha)| u64::from(changed(rgb) | made_finite(alpha))).sum()
            }
            None => texels.map(|rgb| u64::from(changed(rgb))).sum(),
        }
    }

    fn color(&self, rgb: [f32; 3]) -> [f32; 3] {
        match self.repair {
            Repair::Scale if self.greatest > 1.0 => rgb.map(|v| clamped(v / self.greatest)),
            Repair::Clip | Repair::Scale => rgb.map(clamped),
            Repair::Nearest => nearest(rgb, self.table),
        }
    }
}

/// Makes alpha finite; returns whether it was not.
fn made_finite(alpha: &mut f32) -> bool {
    let is_finite = alpha.is_finite();
    if !is_finite {
        *alpha = if *alpha > 0.0 { 1.0 } else { 0.0 };
    }
    !is_finite
}

fn clamped(value: f32) -> f32 {
    value.clamp(0.0, 1.0)
}

/// The nearest reachable color in 0..=1, in single precision.
///
/// Clamping may make the nearest color unreachable again; it then moves towards the gray of its mean
/// value as far as necessary.
fn nearest(rgb: [f32; 3], table: &StandingTable) -> [f32; 3] {
    if is_reachable(rgb, table) && is_reachable(rgb.map(clamped), table) {
        return rgb.map(clamped);
    }
    // For a reachable color this is the color itself.
    let found = table.standing(LinearRgb(rgb.map(f64::from))).fluorescence.color;
    let found = table.colorimetry().rgb_from_xyz(found).0.map(|v| v.clamp(0.0, 1.0));
    let gray = found.iter().sum::<f64>() / 3.0;
    let towards_gray = |share: f64| found.map(|v| to_single(v + share * (gray - v)));
    let (mut outside, mut inside) = (OFF_THE_BORDER, 1.0);
    if is_reachable(towards_gray(outside), table) {
        return towards_gray(outside);
    }
    for _ in 0..BISECTIONS {
        let middle = (outside + inside) / 2.0;
        let reachable = is_reachable(towards_gray(middle), table);
        *(if reachable { &mut inside } else { &mut outside }) = middle;
    }
    towards_gray(inside)
}

fn is_reachable(rgb: [f32; 3], table: &StandingTable) -> bool {
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
                let found = repairer(repair, greatest_value(&rgb)).repair(&mut rgb, None);
                prop_assert!(rgb.as_flattened().iter().all(|v| (0.0..=1.0).contains(v)));
                for (before, after) in texels.iter().zip(&rgb) {
                    prop_assert!(before.iter().all(|v| v.is_finite()) || *after == [0.0; 3]);
                }
                let changed = texels.iter().zip(&rgb).filter(|(a, b)| a != b).count();
                prop_assert_eq!(found, changed as u64);
                let again = repairer(repair, greatest_value(&rgb)).repair(&mut rgb, None);
                prop_assert_eq!(again, 0, "{}", repair);
            }
        }

        #[test]
        fn the_nearest_is_reachable_by_some_material(rgb in prop::array::uniform3(-0.5..3.0_f32)) {
            let mut texel = [rgb];
            repairer(Repair::Nearest, 0.0).repair(&mut texel, None);
            prop_assert!(is_reachable(texel[0], table()), "{rgb:?} {texel:?}");
        }
    }

    proptest! {
        #[test]
        fn after_any_repair_alpha_is_finite_and_texels_that_changed_are_counted_once(
            texels in prop::collection::vec((prop::array::uniform3(any_value()), any_value()), 1..40),
        ) {
            let (before, alphas): (Vec<_>, Vec<_>) = texels.into_iter().unzip();
            for &repair in Repair::ALL {
                let (mut rgb, mut alpha) = (before.clone(), alphas.clone());
                let repairer = repairer(repair, greatest_value(&rgb));
                let found = repairer.repair(&mut rgb, Some(&mut alpha));
                let mut changed = 0;
                for i in 0..rgb.len() {
                    let expected = match alphas[i] {
                        f32::INFINITY => 1.0,
                        a if a.is_finite() => a,
                        _ => 0.0,
                    };
                    prop_assert_eq!(alpha[i], expected);
                    changed += u64::from(before[i] != rgb[i] || alphas[i] != alpha[i]);
                }
                prop_assert_eq!(found, changed, "{}", repair);
            }
        }
    }

    #[test]
    fn colors_that_can_be_baked_stay_to_the_bit() {
        let good = [[0.0; 3], [1.0; 3], [0.2, 0.3, 0.4], [0.9, 0.0, 0.9]];
        for &repair in Repair::ALL {
            let mut rgb = good;
            let found = repairer(repair, greatest_value(&rgb)).repair(&mut rgb, None);
            assert_eq!((rgb, found), (good, 0), "{repair}");
        }
    }

    #[test]
    fn scaling_keeps_the_ratios_and_makes_the_greatest_value_one() {
        let mut rgb = [[2.0, 1.0, 0.5], [-1.0, 4.0, f32::INFINITY], [0.0, 4.0, 1.0]];
        let greatest = greatest_value(&rgb);
        let found = repairer(Repair::Scale, greatest).repair(&mut rgb, None);
        assert_eq!(rgb, [[0.5, 0.25, 0.125], [0.0; 3], [0.0, 1.0, 0.25]]);
        assert_eq!(found, 3);
    }

    #[test]
    fn names_round_trip() {
        for &repair in Repair::ALL {
            assert_eq!(repair.to_string().parse(), Ok(repair));
        }
        assert!("shift".parse::<Repair>().is_err());
    }
}
