//! The colors of the maps. Each ramp also decreases in lightness, so that it can be read without hue.

use upglow::Model;

use super::display::byte;

/// The meaning of a pixel of the map of needed materials: the worst of its texels, by kind and then by
/// difference.
#[derive(Clone, Copy, Debug, Default, PartialEq, PartialOrd)]
pub(super) enum Heat {
    /// Reflectances match all texels.
    #[default]
    Reflectance,
    /// The furthest texel is this many ΔE00 beyond reflectance.
    Fluorescence(f32),
    /// The furthest texel is this many ΔE00 beyond any material.
    Unreachable(f32),
    /// A value is NaN or infinite.
    NoColor,
}

/// The meaning of a pixel of the maps of a cube.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct CubeHeat {
    /// Greatest ΔE00 of the blends of its texels.
    pub(super) de2000: f32,
    /// Greatest dose of these blends.
    pub(super) dose: f32,
    /// Whether a texel is outside the cube, as not all of its values are in 0..=1.
    pub(super) is_outside: bool,
}

/// Colors for numbers from 0 on, on a logarithmic scale.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Ramp {
    stops: &'static [[u8; 3]],
    /// Where it ends. With a greater value small numbers would look alike; with a smaller one whole
    /// pictures would be at the end.
    full: f64,
    /// Numbers that its legend is marked at.
    pub(super) ticks: &'static [f64],
}

/// ΔE00 beyond reflectance.
pub(super) const FLUORESCENCE: Ramp = Ramp {
    stops: &[[255, 236, 150], [253, 180, 60], [232, 98, 12], [140, 45, 4]],
    full: 30.0,
    ticks: &[1.0, 3.0, 10.0, 30.0],
};
/// ΔE00 beyond any material.
pub(super) const UNREACHABLE: Ramp =
    Ramp { stops: &[[245, 120, 215], [196, 24, 140], [88, 10, 94]], ..FLUORESCENCE };
/// ΔE00 of a cube's blends.
pub(super) const DIFFERENCE: Ramp = Ramp {
    stops: &[[255, 232, 214], [252, 146, 114], [222, 45, 38], [103, 0, 13]],
    full: 10.0,
    ticks: &[0.1, 0.5, 1.0, 2.0, 5.0, 10.0],
};
/// Doses that are sums of optical densities.
const DENSITY: Ramp = Ramp {
    stops: &[[226, 245, 221], [116, 196, 118], [35, 139, 69], [0, 68, 27]],
    full: 6.0,
    ticks: &[0.1, 0.5, 1.0, 2.0, 4.0, 6.0],
};
/// Doses that are concentrations.
const CONCENTRATION: Ramp = Ramp { full: 1.0, ticks: &[0.1, 0.25, 0.5, 0.75, 1.0], ..DENSITY };

/// Black and white of the gray picture, which differ from the ends of the ramps and from the page.
const GRAYS: [f64; 2] = [0.16, 0.82];

const NO_COLOR: [u8; 3] = [0, 200, 230];

/// Doses of a model.
pub(super) fn dose_ramp(model: &Model) -> Ramp {
    if matches!(model, Model::Film(_)) { DENSITY } else { CONCENTRATION }
}

/// What a dose of a model is, in words.
pub(super) fn dose_unit(model: &Model) -> &'static str {
    if matches!(model, Model::Film(_)) { "optical density" } else { "concentration" }
}

impl Heat {
    /// The color of the pixel. Reflectances are gray, of the given brightness, 0..=1.
    pub(super) fn color(self, bright: f64) -> [u8; 3] {
        match self {
            Self::Reflectance => gray(bright),
            Self::Fluorescence(de2000) => FLUORESCENCE.color(de2000.into()),
            Self::Unreachable(de2000) => UNREACHABLE.color(de2000.into()),
            Self::NoColor => NO_COLOR,
        }
    }
}

impl CubeHeat {
    /// The worse of each.
    pub(super) fn add(&mut self, other: Self) {
        self.de2000 = self.de2000.max(other.de2000);
        self.dose = self.dose.max(other.dose);
        self.is_outside |= other.is_outside;
    }

    /// The color of the pixel in the map of differences; matches are gray, of the given brightness.
    pub(super) fn difference_color(self, bright: f64) -> [u8; 3] {
        self.color(self.de2000.into(), EXACT, DIFFERENCE, bright)
    }

    /// The color of the pixel in the map of dye; without dye it is gray, of the given brightness.
    pub(super) fn dose_color(self, ramp: Ramp, bright: f64) -> [u8; 3] {
        self.color(self.dose.into(), 0.0, ramp, bright)
    }

    fn color(self, value: f64, none: f64, ramp: Ramp, bright: f64) -> [u8; 3] {
        match value {
            _ if self.is_outside => NO_COLOR,
            v if v <= none => gray(bright),
            v => ramp.color(v),
        }
    }
}

/// Blends within this ΔE00 match.
const EXACT: f64 = upglow_fit::CubeSummary::EXACT_DE2000;

fn gray(bright: f64) -> [u8; 3] {
    [byte(GRAYS[0] + (GRAYS[1] - GRAYS[0]) * bright); 3]
}

impl Ramp {
    /// The position of a number, 0..=1.
    pub(super) fn position(&self, value: f64) -> f64 {
        (value.ln_1p() / self.full.ln_1p()).clamp(0.0, 1.0)
    }

    /// The number at a position, 0..=1.
    pub(super) fn value(&self, position: f64) -> f64 {
        (position * self.full.ln_1p()).exp_m1()
    }

    /// The color of a number, interpolated linearly between the stops.
    pub(super) fn color(&self, value: f64) -> [u8; 3] {
        let last = self.stops.len() - 1;
        let position = self.position(value) * last as f64;
        let index = (1..last).filter(|&i| i as f64 <= position).count();
        let share = position - index as f64;
        let (a, b) = (self.stops[index], self.stops[index + 1]);
        [0, 1, 2].map(|k| byte((f64::from(a[k]) * (1.0 - share) + f64::from(b[k]) * share) / 255.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RAMPS: [Ramp; 5] = [FLUORESCENCE, UNREACHABLE, DIFFERENCE, DENSITY, CONCENTRATION];

    fn luma([r, g, b]: [u8; 3]) -> f64 {
        0.3 * f64::from(r) + 0.59 * f64::from(g) + 0.11 * f64::from(b)
    }

    #[test]
    fn each_ramp_decreases_in_lightness() {
        for ramp in RAMPS {
            let lumas: Vec<f64> =
                (0..=60).map(|i| luma(ramp.color(ramp.value(f64::from(i) / 60.0)))).collect();
            assert!(lumas.is_sorted_by(|a, b| a > b), "{lumas:?}");
        }
    }

    #[test]
    fn ramps_begin_and_end_at_their_stops_and_have_their_ticks_between() {
        for ramp in RAMPS {
            assert_eq!(ramp.color(0.0), ramp.stops[0]);
            assert_eq!(ramp.color(f64::INFINITY), *ramp.stops.last().unwrap());
            assert_eq!(ramp.ticks.last(), Some(&ramp.full));
            assert!(
                ramp.ticks
                    .iter()
                    .all(|tick| (ramp.value(ramp.position(*tick)) - tick).abs() < 1e-9)
            );
        }
    }

    #[test]
    fn a_cube_s_maps_are_gray_where_it_matches_and_where_it_has_no_dye() {
        let matched = CubeHeat { de2000: 0.009, ..CubeHeat::default() };
        assert_eq!(matched.difference_color(0.5), matched.dose_color(DENSITY, 0.5));
        let mut both = CubeHeat { dose: 0.3, ..CubeHeat::default() };
        both.add(CubeHeat { de2000: 2.0, ..CubeHeat::default() });
        assert_eq!(both.difference_color(0.5), DIFFERENCE.color(2.0));
        assert_eq!(both.dose_color(DENSITY, 0.5), DENSITY.color(0.3_f32.into()));
        both.add(CubeHeat { is_outside: true, ..CubeHeat::default() });
        assert_eq!(both.difference_color(0.5), NO_COLOR);
    }
}
