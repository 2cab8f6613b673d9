//! Light sources.

use std::path::Path;

use crate::grid::Grid;
use crate::light_bands::LightBands;
use crate::names::{NameError, name_after_file};
use crate::observer::Observer;
use crate::samples::{SampleRules, SamplesError, curves_from_samples, fine_means};
use crate::spectrum::{Spectrum, SpectrumCsvError, read_columns};
use crate::tables::daylight::{DAYLIGHT_COMPONENTS, DAYLIGHT_FIRST_NM, DAYLIGHT_STEP_NM};
use crate::tables::lamps::{LAMPS, LAMPS_FIRST_NM, LAMPS_LAST_NM, LAMPS_STEP_NM};

/// A named light: relative spectral power on [`Grid::FINE`], 300 to 830 nm.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize), serde(transparent))]
#[must_use]
pub struct Illuminant {
    name: String,
    #[cfg_attr(feature = "serde", serde(skip))]
    power: Spectrum,
}

/// Why a light is rejected.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum IlluminantError {
    /// No built-in light has this name.
    #[error("unknown illuminant {found:?}, expected {}, or a CSV file", Illuminant::NAMES.join(", "))]
    Unknown {
        /// The name given.
        found: String,
    },
    /// The CSV text is not a spectrum.
    #[error(transparent)]
    Csv(#[from] SpectrumCsvError),
    /// The samples are not a spectrum.
    #[error(transparent)]
    Samples(#[from] SamplesError),
    /// The peak or width of a line is not a wavelength.
    #[error("{what} is {found}, expected {expected}")]
    Line {
        /// `peak_nm` or `fwhm_nm`.
        what: &'static str,
        /// The number given, nm.
        found: f64,
        /// What it should be.
        expected: &'static str,
    },
    /// The name cannot be that of this light.
    #[error(transparent)]
    Name(#[from] NameError),
    /// The light has no power at visible wavelengths.
    #[error("no power between 360 and 830 nm, expected some")]
    Invisible,
}

/// Today's second radiation constant (1.438776877e-2 m·K) over that of the temperature scale in which
/// the nominal color temperatures of daylight were defined (1.4380e-2 m·K): they scale by the ratio.
const C2_NOW_OVER_C2_THEN: f64 = 1.438_776_877 / 1.438_0;

/// Greatest difference of a power from that of the built-in light of the same name, relative to the
/// greatest power. The standards print six digits, half a unit of the last of which is 4e-6 of the
/// greatest power of D65: their tables are the built-in lights too. Larger would let the name
/// cover lights of other colors.
const NAME_TOLERANCE: f64 = 1e-5;

/// The wavelength at which daylights and illuminant A have power 100, nm.
const REFERENCE_NM: f64 = 560.0;

/// The least full width at half maximum of a line, nm. Narrower ones would lose their power to the
/// rounding of wavelengths.
const NARROWEST_NM: f64 = 1e-3;

/// Lines at least this wide, nm, are sampled: 1 nm samples have their power and colors within 1e-5.
/// Narrower ones are averaged over each nanometer.
const SAMPLED_FROM_NM: f64 = 2.0;

impl Illuminant {
    /// The built-in lights.
    pub const NAMES: [&str; 10] =
        ["D65", "D60", "D55", "D50", "A", "E", "FL2", "FL11", "HP1", "LED-B3"];

    /// The built-in light of this name, in any case.
    ///
    /// # Errors
    ///
    /// [`IlluminantError::Unknown`] lists the known names.
    pub fn named(name: &str) -> Result<Self, IlluminantError> {
        match name.to_ascii_uppercase().as_str() {
            "D65" => Ok(Self::daylight("D65", 6500.0)),
            "D60" => Ok(Self::daylight("D60", 6000.0)),
            "D55" => Ok(Self::daylight("D55", 5500.0)),
            "D50" => Ok(Self::daylight("D50", 5000.0)),
            "A" => Ok(Self::a()),
            "E" => Ok(Self::from_fn("E", |_| 100.0)),
            _ => Self::lamp(name).ok_or_else(|| IlluminantError::Unknown { found: name.into() }),
        }
    }

    /// A lamp of the tables, whose power is zero below 380 and above 780 nm.
    fn lamp(name: &str) -> Option<Self> {
        let (name, power) = LAMPS.iter().find(|(known, _)| known.eq_ignore_ascii_case(name))?;
        let grid = Grid::try_new(LAMPS_FIRST_NM, LAMPS_LAST_NM, LAMPS_STEP_NM)
            .expect("the table is on a grid");
        let power = Spectrum::new(grid, power.to_vec()).expect("the table fills the grid");
        Some(Self { name: (*name).into(), power: power.resampled(Grid::FINE) })
    }

    /// The light in CSV text with the header `wavelength_nm,power`, 300 to 830 nm.
    ///
    /// # Errors
    ///
    /// [`IlluminantError`] if the text does not define a spectrum, or one without visible power.
    pub fn from_csv(name: &str, text: &str) -> Result<Self, IlluminantError> {
        let [power] = read_columns(text, ["power"], SampleRules::LIGHT)?;
        Self::from_spectrum(name, &power)
    }

    /// The light in the CSV text of a file, named after the file: by its stem, or by its whole name
    /// where the stem is that of a built-in light with other numbers.
    ///
    /// # Errors
    ///
    /// As [`Illuminant::from_csv`].
    pub fn from_csv_file(path: &Path, text: &str) -> Result<Self, IlluminantError> {
        let is_taken = |name: &str| {
            matches!(
                Self::from_csv(name, text),
                Err(IlluminantError::Name(NameError::Taken { .. }))
            )
        };
        Self::from_csv(&name_after_file(path, is_taken), text)
    }

    /// A light from samples of its relative power: ascending wavelengths (nm) from 300 to 830 nm in
    /// steps of at most 10 nm, and a power of 0 or more for each.
    ///
    /// # Errors
    ///
    /// [`IlluminantError`] if the samples do not define a spectrum, or one without visible power.
    pub fn from_samples(
        name: &str,
        wavelengths_nm: &[f64],
        power: &[f64],
    ) -> Result<Self, IlluminantError> {
        let columns = [("power", power)];
        let [power] = curves_from_samples(wavelengths_nm, columns, SampleRules::LIGHT)?;
        Self::from_spectrum(name, &power)
    }

    /// A light from its relative power.
    ///
    /// # Errors
    ///
    /// [`IlluminantError`] if a power is negative, if all are zero from 360 to 830 nm, or if the name
    /// is that of a built-in light with other numbers.
    pub fn from_spectrum(name: &str, power: &Spectrum) -> Result<Self, IlluminantError> {
        let power = power.resampled(Grid::FINE);
        SampleRules::LIGHT.check_curve("power", &power)?;
        let first_visible = 60;
        if power.values()[first_visible..].iter().all(|&p| p <= 0.0) {
            return Err(IlluminantError::Invisible);
        }
        NameError::check_text(name)?;
        if let Ok(known) = Self::named(name) {
            NameError::check_curve(
                "illuminant",
                name,
                "power",
                &power,
                &known.power,
                NAME_TOLERANCE,
            )?;
        }
        Ok(Self { name: name.into(), power })
    }

    /// A lamp with one Gaussian line, like an ultraviolet LED: peak and full width at half maximum in
    /// nm, power 100 at the peak. The 1 nm samples of a line narrower than 2 nm are means that keep its
    /// power.
    ///
    /// # Errors
    ///
    /// [`IlluminantError`] if the width is below 0.001 nm, if no power is left between 360 and 830 nm,
    /// or if the name is that of a built-in light.
    pub fn line(name: &str, peak_nm: f64, fwhm_nm: f64) -> Result<Self, IlluminantError> {
        let fault = |what, found, expected| Err(IlluminantError::Line { what, found, expected });
        if !peak_nm.is_finite() {
            return fault("peak_nm", peak_nm, "a finite number");
        }
        if !(fwhm_nm.is_finite() && fwhm_nm >= NARROWEST_NM) {
            return fault("fwhm_nm", fwhm_nm, "0.001 or more");
        }
        let shape = |nm: f64| (-4.0 * 2f64.ln() * ((nm - peak_nm) / fwhm_nm).powi(2)).exp();
        let line = Self::from_fn(name, |nm| 100.0 * shape(nm));
        if fwhm_nm >= SAMPLED_FROM_NM {
            return Self::from_spectrum(name, &line.power);
        }
        // To three widths on either side of the peak, where the line has fallen to 1e-11; then it is dark.
        let power = |i: i32, nm: f64| if i.abs() > 48 { 0.0 } else { 100.0 * shape(nm) };
        let near = (-49..=49).map(|i| (i, peak_nm + fwhm_nm / 16.0 * f64::from(i)));
        let ends = [f64::from(Grid::FINE.first_nm()) - 1.0, f64::from(Grid::FINE.last_nm()) + 1.0];
        let [first, last] = ends;
        let is_inside = |(_, nm): &(i32, f64)| *nm > first && *nm < last;
        let inside = near.filter(is_inside).map(|(i, nm)| (nm, power(i, nm)));
        let samples = std::iter::once((first, 0.0)).chain(inside).chain([(last, 0.0)]);
        Self::from_spectrum(name, &fine_means(samples))
    }

    /// A phase of daylight of the given nominal correlated color temperature.
    ///
    /// # Source
    ///
    /// `cie015`, section 4.1.2; M1 and M2 rounded to three decimals as CIE does for its tables.
    fn daylight(name: &str, nominal_cct_k: f64) -> Self {
        let t = nominal_cct_k * C2_NOW_OVER_C2_THEN;
        let [x, y] = daylight_chromaticity(t);
        let m = 0.0241 + 0.2562 * x - 0.7341 * y;
        let to_three_decimals = |v: f64| (v * 1000.0).round() / 1000.0;
        let m1 = to_three_decimals((-1.3515 - 1.7703 * x + 5.9114 * y) / m);
        let m2 = to_three_decimals((0.0300 - 31.4424 * x + 30.0717 * y) / m);
        let grid = Grid::try_new(DAYLIGHT_FIRST_NM, Grid::FINE.last_nm(), DAYLIGHT_STEP_NM)
            .expect("the table is on a grid");
        let values =
            DAYLIGHT_COMPONENTS.iter().map(|[s0, s1, s2]| s0 + m1 * s1 + m2 * s2).collect();
        let power = Spectrum::new(grid, values).expect("the table fills the grid");
        let scale = 100.0 / power.at(REFERENCE_NM);
        Self { name: name.into(), power: power.resampled(Grid::FINE).scaled(scale) }
    }

    /// CIE standard illuminant A, incandescent light.
    ///
    /// # Source
    ///
    /// `cie015`, section 4.1.1, equation 1: 2848 K with the second constant 1.435e7 nm·K.
    fn a() -> Self {
        let planck = |nm: f64| nm.powi(-5) / ((1.435e7 / (2848.0 * nm)).exp() - 1.0);
        Self::from_fn("A", |nm| 100.0 * planck(nm) / planck(REFERENCE_NM))
    }

    fn from_fn(name: &str, power: impl Fn(f64) -> f64) -> Self {
        let values = Grid::FINE.wavelengths_nm().map(power).collect();
        let power = Spectrum::new(Grid::FINE, values).expect("the formula is finite everywhere");
        Self { name: name.into(), power }
    }

    /// The name that files state.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Relative spectral power on [`Grid::FINE`].
    pub fn power(&self) -> &Spectrum {
        &self.power
    }

    /// Relative power in the band around each wavelength of a grid, in units of [`Illuminant::power`]:
    /// a sample, or, if the light has structure between the grid's wavelengths that this observer or a
    /// dye would notice, a mean of the 1 nm samples.
    pub fn power_in_bands(&self, grid: Grid, observer: &Observer) -> Vec<f64> {
        LightBands::power_on(self, observer, grid)
    }
}

impl Default for Illuminant {
    /// CIE standard illuminant D65.
    fn default() -> Self {
        Self::daylight("D65", 6500.0)
    }
}

/// Chromaticity of daylight of correlated color temperature `t`, K; 4000 to 25000 K.
///
/// # Source
///
/// `cie015`, section 4.1.2, equations 6 to 8.
fn daylight_chromaticity(t: f64) -> [f64; 2] {
    let x = if t <= 7000.0 {
        0.244_063 + 0.099_11e3 / t + 2.967_8e6 / t.powi(2) - 4.607_0e9 / t.powi(3)
    } else {
        0.237_040 + 0.247_48e3 / t + 1.901_8e6 / t.powi(2) - 2.006_4e9 / t.powi(3)
    };
    [x, -3.000 * x * x + 2.870 * x - 0.275]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_share_of_d65_below_380_nm_is_that_of_the_standard() {
        let d65 = Illuminant::default();
        let ultraviolet: f64 = d65.power().values()[..80].iter().sum();
        let share = ultraviolet / d65.power().values().iter().sum::<f64>();
        assert!((share - 0.065).abs() < 0.001, "{share}");
    }

    #[test]
    fn whites_have_the_published_chromaticities() {
        // `cie015`, tables T.3 and T.8.1: five printed digits, of sums over 360 to 830 nm by 1 nm.
        const PUBLISHED: [(&str, [f64; 2]); 4] = [
            ("D65", [0.312_72, 0.329_03]),
            ("D55", [0.332_43, 0.347_44]),
            ("D50", [0.345_67, 0.358_51]),
            ("A", [0.447_58, 0.407_45]),
        ];
        // One unit of the last digit: the tables sum a power that is rounded to six digits.
        const PRINTED_DIGITS: f64 = 1.5e-5;
        for (name, expected) in PUBLISHED {
            let illuminant = Illuminant::named(name).unwrap();
            let contract = crate::Contract { illuminant, ..crate::Contract::default() };
            let white = contract.on(Grid::FINE).white().chromaticity().unwrap();
            for k in 0..2 {
                assert!((white[k] - expected[k]).abs() < PRINTED_DIGITS, "{name} {white:?}");
            }
        }
    }

    #[test]
    fn a_narrow_line_is_dark_beside_it() {
        for width_nm in [0.01, 0.5, 1.9] {
            let power = Illuminant::line("line", 365.0, width_nm).unwrap().power().clone();
            for (nm, value) in Grid::FINE.wavelengths_nm().zip(power.values()) {
                // Three widths, and the nanometer around each sample.
                let is_far = (nm - 365.0).abs() > 3.1 * width_nm + 2.0;
                assert!(!is_far || *value == 0.0, "{width_nm}: {value} at {nm} nm");
            }
        }
    }

    #[test]
    fn names_are_accepted_in_any_case_and_errors_list_them() {
        assert_eq!(Illuminant::named("d50").unwrap().name(), "D50");
        assert_eq!(Illuminant::named("led-b3").unwrap().name(), "LED-B3");
        assert_eq!(
            Illuminant::named("F11").unwrap_err().to_string(),
            "unknown illuminant \"F11\", expected D65, D60, D55, D50, A, E, FL2, FL11, HP1, LED-B3, or a \
             CSV file"
        );
    }

    #[test]
    fn samples_and_csv_text_give_the_same_light() {
        let d50 = Illuminant::named("D50").unwrap();
        let nm: Vec<f64> = Grid::FINE.wavelengths_nm().collect();
        let sampled = Illuminant::from_samples("lamp", &nm, d50.power().values()).unwrap();
        let rows = nm.iter().zip(d50.power().values()).map(|(nm, p)| format!("{nm},{p}\n"));
        let text = "wavelength_nm,power\n".to_owned() + &rows.collect::<String>();
        assert_eq!(sampled, Illuminant::from_csv("lamp", &text).unwrap());
        assert_eq!(sampled.power(), d50.power());
        let negative = vec![-1.0; nm.len()];
        assert_eq!(
            Illuminant::from_samples("lamp", &nm, &negative).unwrap_err().to_string(),
            "sample 0: -1 in column \"power\", expected a value of 0 or more"
        );
    }

    #[test]
    fn a_built_in_name_is_for_the_built_in_light_only() {
        let flat = Spectrum::new(Grid::FINE, vec![1.0; Grid::FINE.len()]).unwrap();
        for name in Illuminant::NAMES {
            let known = Illuminant::named(name).unwrap();
            for spelling in [name.to_owned(), name.to_lowercase()] {
                let same = Illuminant::from_spectrum(&spelling, known.power()).unwrap();
                assert_eq!(same.power(), known.power());
                let printed = known.power().clone().scaled(1.0 + 4e-6);
                assert!(Illuminant::from_spectrum(&spelling, &printed).is_ok(), "{name}");
                let scaled = known.power().clone().scaled(1.0 + 2e-5);
                assert!(Illuminant::from_spectrum(&spelling, &scaled).is_err(), "{name}");
                let other = Illuminant::from_spectrum(&spelling, &flat).unwrap_err();
                assert!(matches!(other, IlluminantError::Name(NameError::Taken { .. })), "{name}");
                assert!(Illuminant::line(&spelling, 450.0, 20.0).is_err(), "{name}");
            }
        }
        let refused = Illuminant::from_spectrum("E", &flat).unwrap_err().to_string();
        assert_eq!(
            refused,
            "\"E\" is a built-in illuminant whose power at 300 nm is 100, found 1: \
             expected the built-in numbers, or another name"
        );
        assert!(Illuminant::from_spectrum("two\nlines", &flat).is_err());
    }

    #[test]
    fn a_light_from_a_file_never_hides_a_built_in_one() {
        let text = |light: &Illuminant| {
            let power = light.power().values().iter();
            let rows = Grid::FINE.wavelengths_nm().zip(power).map(|(nm, p)| format!("{nm},{p}\n"));
            "wavelength_nm,power\n".to_owned() + &rows.collect::<String>()
        };
        let named = |path: &str, light: &Illuminant| {
            Illuminant::from_csv_file(Path::new(path), &text(light)).unwrap().name().to_owned()
        };
        let [a, e] = ["A", "E"].map(|name| Illuminant::named(name).unwrap());
        assert_eq!(named("lamps/A.csv", &e), "A.csv");
        assert_eq!(named("lamps/a.csv", &e), "a.csv");
        assert_eq!(named("lamps/A.csv", &a), "A");
        assert_eq!(named("lamps/f11.csv", &e), "f11");
        assert!(Illuminant::from_csv_file(Path::new("lamps/A"), &text(&e)).is_err());
    }

    #[test]
    fn powers_beyond_the_range_of_sums_are_refused() {
        for (power, holds) in [(1e-31, false), (1e-30, true), (1e30, true), (1e31, false)] {
            let light = Spectrum::new(Grid::FINE, vec![power; Grid::FINE.len()]).unwrap();
            assert_eq!(Illuminant::from_spectrum("x", &light).is_ok(), holds, "{power}");
        }
        for [peak_nm, fwhm_nm] in [[f64::NAN, 1.0], [500.0, 0.0], [500.0, f64::INFINITY]] {
            let line = Illuminant::line("x", peak_nm, fwhm_nm);
            assert!(matches!(line, Err(IlluminantError::Line { .. })));
        }
    }

    #[test]
    fn negative_power_is_refused() {
        let mut values = vec![1.0; Grid::FINE.len()];
        values[100] = -0.5;
        let dark = Spectrum::new(Grid::FINE, values).unwrap();
        let refused = Illuminant::from_spectrum("dark", &dark).unwrap_err();
        assert_eq!(
            refused.to_string(),
            "400 nm: -0.5 in column \"power\", expected a value of 0 or more"
        );
    }

    #[test]
    fn a_light_without_visible_power_is_refused() {
        let mut values = vec![0.0; Grid::FINE.len()];
        values[10] = 1.0;
        let dark = Spectrum::new(Grid::FINE, values).unwrap();
        assert_eq!(Illuminant::from_spectrum("dark", &dark), Err(IlluminantError::Invisible));
    }
}
