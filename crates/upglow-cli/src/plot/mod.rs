//! Figures of a material's curves, and of matrices.

pub(crate) mod matrix;
pub(crate) mod svg;
pub(crate) mod swatches;

use upglow::{Bispectral, Material, Mixture, Model, Sigmoid};
use upglow_color::{Colorimetry, Grid, Shown, srgb_encoded};
use upglow_svg::{byte, hex};

/// First wavelength of every figure, nm.
const FIRST_NM: f64 = 300.0;
/// Last wavelength of every figure, nm.
const LAST_NM: f64 = 780.0;

/// A curve below this value cannot be told from zero.
const VISIBLE: f64 = 1e-3;

/// The curves of a material on [`Grid::FINE`].
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub(crate) struct Curves {
    pub(crate) wavelengths_nm: Vec<f64>,
    /// Share of light reflected without a change of wavelength, 0..=1.
    pub(crate) reflectance: Vec<f64>,
    /// Share of light absorbed by the dyes, 0..=1.
    pub(crate) absorption: Vec<f64>,
    /// Light emitted by fluorescence, relative to its peak; all zero without fluorescence.
    pub(crate) emission: Vec<f64>,
}

impl Curves {
    pub(crate) fn of(mixture: &Mixture<'_>, colorimetry: &Colorimetry) -> Self {
        let fine = || Grid::FINE.wavelengths_nm();
        Self {
            wavelengths_nm: fine().collect(),
            reflectance: fine().map(|nm| mixture.reflectance(nm)).collect(),
            absorption: fine().map(|nm| absorption(mixture, nm)).collect(),
            emission: emission(mixture, colorimetry),
        }
    }

    pub(crate) fn is_fluorescent(&self) -> bool {
        self.emission.iter().any(|&value| value > 0.0)
    }

    /// The visible points of a curve, without the zeros before and after it.
    fn lifted<'c>(&'c self, curve: &'c [f64]) -> impl Iterator<Item = (f64, f64)> + 'c {
        let above = |v: &f64| *v > VISIBLE;
        let first = curve.iter().position(above).unwrap_or(curve.len()).saturating_sub(1);
        let last = curve.iter().rposition(above).map_or(0, |last| last + 1);
        let nm = &self.wavelengths_nm;
        let range = move |points: &usize| (first..=last).contains(points);
        let points = (0..nm.len()).filter(range).map(|i| (nm[i], curve[i]));
        points.filter(|(nm, _)| (FIRST_NM..=LAST_NM).contains(nm))
    }

    /// The points of a curve within the wavelengths of the figure.
    fn shown<'c>(&'c self, curve: &'c [f64]) -> impl Iterator<Item = (f64, f64)> + 'c {
        let range = FIRST_NM..=LAST_NM;
        let points = self.wavelengths_nm.iter().copied().zip(curve.iter().copied());
        points.filter(move |(nm, _)| range.contains(nm))
    }
}

/// The share absorbed at one wavelength: what a white reflectance with the same dyes does not reflect.
fn absorption(mixture: &Mixture<'_>, nm: f64) -> f64 {
    let of_part = |model: &Model, part: Material| {
        let white = Material { reflectance: Sigmoid::flat(1.0), ..part };
        1.0 - Mixture::of(model, white).reflectance(nm)
    };
    let glowing = mixture.parts().filter(|(_, part)| part.fluorescence.dose() > 0.0);
    glowing.map(|(weight, part)| weight * of_part(mixture.model(), part)).sum()
}

/// Light emitted by fluorescence, relative to its peak.
fn emission(mixture: &Mixture<'_>, colorimetry: &Colorimetry) -> Vec<f64> {
    let incident = || colorimetry.wavelengths_nm().iter().zip(colorimetry.irradiance());
    let at = |out_nm: f64| -> f64 {
        incident().map(|(&in_nm, power)| power * mixture.reradiation_per_nm(in_nm, out_nm)).sum()
    };
    let emitted: Vec<f64> = if mixture.is_fluorescent() {
        Grid::FINE.wavelengths_nm().map(at).collect()
    } else {
        vec![0.0; Grid::FINE.len()]
    };
    let peak = emitted.iter().copied().fold(0.0, f64::max);
    if peak > 0.0 { emitted.iter().map(|value| value / peak).collect() } else { emitted }
}

/// The content of a figure.
#[derive(Clone, Debug)]
pub(crate) struct Figure<'a> {
    pub(crate) curves: &'a Curves,
    /// The requested color.
    pub(crate) target: Swatch,
    /// The color of the material.
    pub(crate) result: Swatch,
    pub(crate) caption: Vec<String>,
}

/// An sRGB color for a screen.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Swatch {
    /// `#rrggbb`.
    pub(crate) hex: String,
    /// Whether the color itself is outside sRGB, and this one grayer.
    pub(crate) is_outside: bool,
}

/// Channels up to this far outside 0..=1 are not said to be outside: materials match the corners of sRGB only
/// as nearly as this.
const OUTSIDE: f64 = 1e-3;

impl Swatch {
    /// A color of an sRGB screen.
    pub(crate) fn of(Shown { rgb, beyond }: Shown) -> Self {
        let hex = hex(rgb.0.map(|v| byte(255.0 * srgb_encoded(v))));
        Self { hex, is_outside: beyond > OUTSIDE }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use upglow::{DyeModel, DyeOptions, DyeSet, Fluorescence};
    use upglow_color::{Contract, LinearRgb, RgbSpace, Screen};

    #[test]
    fn screen_colors_have_their_published_values() {
        let swatch = |rgb| {
            let srgb = Contract { space: RgbSpace::named("srgb").unwrap(), ..Contract::default() };
            let srgb = srgb.on(Grid::FIT);
            Swatch::of(Screen::srgb(srgb.white()).within(srgb.xyz_from_rgb(LinearRgb(rgb))))
        };
        // Middle gray of 18 % is 118 in sRGB.
        assert_eq!(swatch([0.18, 0.0, 1.0]), Swatch { hex: "#7600ff".into(), is_outside: false });
        assert!(swatch([1.2, 0.0, 1.0]).is_outside);
    }

    #[test]
    fn absorption_and_reflectance_of_a_white_material_add_up_to_one() {
        let dyes = DyeModel::new(DyeSet::named("konig8").unwrap(), DyeOptions::default()).unwrap();
        let model = Model::Dyes(dyes);
        let material = Material {
            reflectance: Sigmoid::flat(1.0),
            fluorescence: Fluorescence::Dyes { first: 3, weight: 0.3, concentration: 0.6 },
        };
        let mixture = Mixture::of(&model, material);
        let curves = Curves::of(&mixture, &Contract::default().on(Grid::FIT));
        for (r, a) in curves.reflectance.iter().zip(&curves.absorption) {
            // Rounding only.
            assert!((r + a - 1.0).abs() < 1e-12);
        }
        assert!(curves.is_fluorescent());
        assert_eq!(curves.emission.iter().copied().fold(0.0, f64::max), 1.0);
    }
}
