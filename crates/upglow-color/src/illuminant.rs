//! Light sources.

mod built_in;

use std::fmt;
use std::path::Path;

use crate::grid::Grid;
use crate::light_bands::LightBands;
use crate::names::{NameError, name_after_file};
use crate::observer::Observer;
use crate::samples::{Ends, SampleRules, SamplesError, curves_from_samples, fine_means};
use crate::spectrum::{Spectrum, SpectrumCsvError, read_columns};

/// A named light: relative spectral power on [`Grid::FINE`], 300 to 830 nm. Many lamps are published
/// from 380 to 780 nm only: their power is zero beyond, see [`Illuminant::given_nm`].
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize), serde(transparent))]
#[must_use]
pub struct Illuminant {
    name: String,
    #[cfg_attr(feature = "serde", serde(skip))]
    power: Spectrum,
    #[cfg_attr(feature = "serde", serde(skip))]
    given_nm: [u32; 2],
}

/// Why a light is rejected.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum IlluminantError {
    /// No built-in light has this name.
    #[error("unknown illuminant {found:?}, expected {}, or a CSV file", Illuminant::FAMILIES)]
    Unknown {
        /// The name given.
        found: String,
    },
    /// No such phase of daylight or blackbody is built in.
    #[error("{name:?} is {kind} of {found_k} K, expected {} to {} K", range_k[0], range_k[1])]
    Temperature {
        /// The name given.
        name: String,
        /// "a blackbody" or "daylight".
        kind: &'static str,
        /// The temperature given, K.
        found_k: f64,
        /// Least and greatest temperature, K.
        range_k: [f64; 2],
    },
    /// No such filter for ultraviolet is built in.
    #[error("{name:?}, expected a wavelength of {} to {} nm behind -cut, as in D65-cut400", range_nm[0], range_nm[1])]
    Cut {
        /// The name given.
        name: String,
        /// Least and greatest wavelength, nm.
        range_nm: [u32; 2],
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

impl IlluminantError {
    /// Whether samples end within 300 to 830 nm, so that [`Ends`] could say what is beyond.
    pub fn lacks_ends(&self) -> bool {
        let (Self::Samples(error) | Self::Csv(SpectrumCsvError::Samples(error))) = self else {
            return false;
        };
        matches!(error, SamplesError::Range { .. })
    }
}

/// A light whose power is not known at short wavelengths; as text, what that means.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MissingUltraviolet {
    /// Name of the light.
    pub light: String,
    /// Where the power is known from, nm.
    pub from_nm: u32,
}

impl MissingUltraviolet {
    /// The wavelengths of [`Grid::FINE`] at which the power is not known, nm.
    pub fn wavelengths_nm(&self) -> impl Iterator<Item = f64> + Clone + use<> {
        (Grid::FINE.first_nm()..self.from_nm).map(f64::from)
    }
}

impl fmt::Display for MissingUltraviolet {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { light, from_nm } = self;
        write!(f, "{light} is given from {from_nm} nm on: what dyes absorb below is not counted")
    }
}

/// Greatest difference of a power from that of the built-in light of the same name, relative to the
/// greatest power. The standards print six digits, half a unit of the last of which is 4e-6 of the
/// greatest power of D65: their tables are the built-in lights too. Larger would let the name
/// cover lights of other colors.
const NAME_TOLERANCE: f64 = 1e-5;

/// The least full width at half maximum of a line, nm. Narrower ones would lose their power to the
/// rounding of wavelengths.
const NARROWEST_NM: f64 = 1e-3;

/// Lines at least this wide, nm, are sampled: 1 nm samples have their power and colors within 1e-5.
/// Narrower ones are averaged over each nanometer.
const SAMPLED_FROM_NM: f64 = 2.0;

impl Illuminant {
    /// The light in CSV text with the header `wavelength_nm,power`: 300 to 830 nm, or with `ends` at
    /// least 400 to 700 nm.
    ///
    /// # Errors
    ///
    /// [`IlluminantError`] if the text does not define a spectrum, or one without visible power.
    pub fn from_csv(name: &str, text: &str, ends: Option<Ends>) -> Result<Self, IlluminantError> {
        let [power] = read_columns(text, ["power"], SampleRules::LIGHT.ending(ends))?;
        Self::from_spectrum(name, &power)
    }

    /// The light in the CSV text of a file, named after the file: by its stem, or by its whole name
    /// where the stem is that of a built-in light with other numbers.
    ///
    /// # Errors
    ///
    /// As [`Illuminant::from_csv`].
    pub fn from_csv_file(
        path: &Path,
        text: &str,
        ends: Option<Ends>,
    ) -> Result<Self, IlluminantError> {
        let is_taken = |name: &str| {
            matches!(
                Self::from_csv(name, text, ends),
                Err(IlluminantError::Name(NameError::Taken { .. }))
            )
        };
        Self::from_csv(&name_after_file(path, is_taken), text, ends)
    }

    /// A light from samples of its relative power: ascending wavelengths (nm) from 300 to 830 nm, or
    /// with `ends` at least from 400 to 700 nm, in steps of at most 10 nm, and a power of 0 or more for
    /// each.
    ///
    /// # Errors
    ///
    /// [`IlluminantError`] if the samples do not define a spectrum, or one without visible power.
    pub fn from_samples(
        name: &str,
        wavelengths_nm: &[f64],
        power: &[f64],
        ends: Option<Ends>,
    ) -> Result<Self, IlluminantError> {
        let columns = [("power", power)];
        let rules = SampleRules::LIGHT.ending(ends);
        let [power] = curves_from_samples(wavelengths_nm, columns, rules)?;
        Self::from_spectrum(name, &power)
    }

    /// A light from its relative power, which is zero beyond its grid.
    ///
    /// # Errors
    ///
    /// [`IlluminantError`] if a power is negative, if all are zero from 360 to 830 nm, or if the name
    /// is that of a built-in light with other numbers.
    pub fn from_spectrum(name: &str, power: &Spectrum) -> Result<Self, IlluminantError> {
        let mut light = Self::of(name, power);
        let power = &light.power;
        SampleRules::LIGHT.check_curve("power", power)?;
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
                power,
                &known.power,
                NAME_TOLERANCE,
            )?;
            light.given_nm = known.given_nm;
        }
        Ok(light)
    }

    /// A light whose power is valid, and whose name is its own.
    fn of(name: &str, power: &Spectrum) -> Self {
        let (given, fine) = (power.grid(), Grid::FINE);
        let first_nm = given.first_nm().clamp(fine.first_nm(), fine.last_nm());
        let last_nm = given.last_nm().clamp(fine.first_nm(), fine.last_nm());
        Self { name: name.into(), power: power.resampled(fine), given_nm: [first_nm, last_nm] }
    }

    /// This light behind a filter that takes all power below `nm`, and only that.
    ///
    /// # Errors
    ///
    /// [`IlluminantError`] if no power is left between 360 and 830 nm, or if the name is that of a
    /// built-in light with other numbers.
    pub fn cut_below(&self, name: &str, nm: f64) -> Result<Self, IlluminantError> {
        let light = self.filtered(name, nm);
        Self::from_spectrum(name, &light.power).map(|_| light)
    }

    /// The same for a name that is free.
    fn filtered(&self, name: &str, from_nm: f64) -> Self {
        let light = Self::from_fn(name, |nm| if nm < from_nm { 0.0 } else { self.power.at(nm) });
        // Behind the filter the power is known.
        let [first_nm, last_nm] = self.given_nm;
        let is_known = from_nm > f64::from(first_nm);
        let first_nm = if is_known { Grid::FINE.first_nm() } else { first_nm };
        Self { given_nm: [first_nm, last_nm], ..light }
    }

    /// An ultraviolet lamp as used for minerals and banknotes, under which only fluorescence is visible: a line
    /// at 365 nm, 12 nm wide at half of its height.
    pub fn mineral_lamp() -> Self {
        let [peak_nm, fwhm_nm] = [365.0, 12.0];
        Self::line(&format!("{peak_nm} nm lamp"), peak_nm, fwhm_nm)
            .expect("its power reaches beyond 360 nm")
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

    fn from_fn(name: &str, power: impl Fn(f64) -> f64) -> Self {
        let values = Grid::FINE.wavelengths_nm().map(power).collect();
        let power = Spectrum::new(Grid::FINE, values).expect("the formula is finite everywhere");
        Self::of(name, &power)
    }

    /// The name that files state.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Relative spectral power on [`Grid::FINE`].
    pub fn power(&self) -> &Spectrum {
        &self.power
    }

    /// First and last wavelength at which the power is known, nm; it is zero beyond.
    pub fn given_nm(&self) -> [u32; 2] {
        self.given_nm
    }

    /// What is to say about a light whose power is not known from 300 nm on, where materials absorb
    /// ultraviolet.
    pub fn missing_ultraviolet(&self) -> Option<MissingUltraviolet> {
        let [from_nm, _] = self.given_nm;
        (from_nm > Grid::FINE.first_nm())
            .then(|| MissingUltraviolet { light: self.name.clone(), from_nm })
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
        Self::d65()
    }
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
            format!("unknown illuminant \"F11\", expected {}, or a CSV file", Illuminant::FAMILIES)
        );
    }

    #[test]
    fn samples_and_csv_text_give_the_same_light() {
        let d50 = Illuminant::named("D50").unwrap();
        let nm: Vec<f64> = Grid::FINE.wavelengths_nm().collect();
        let sampled = Illuminant::from_samples("lamp", &nm, d50.power().values(), None).unwrap();
        let rows = nm.iter().zip(d50.power().values()).map(|(nm, p)| format!("{nm},{p}\n"));
        let text = "wavelength_nm,power\n".to_owned() + &rows.collect::<String>();
        assert_eq!(sampled, Illuminant::from_csv("lamp", &text, None).unwrap());
        assert_eq!(sampled.power(), d50.power());
        let negative = vec![-1.0; nm.len()];
        assert_eq!(
            Illuminant::from_samples("lamp", &nm, &negative, None).unwrap_err().to_string(),
            "sample 0: -1 in column \"power\", expected a value of 0 or more"
        );
    }

    #[test]
    fn a_built_in_name_is_for_the_built_in_light_only() {
        let flat = Spectrum::new(Grid::FINE, vec![1.0; Grid::FINE.len()]).unwrap();
        for name in Illuminant::names() {
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
            Illuminant::from_csv_file(Path::new(path), &text(light), None)
                .unwrap()
                .name()
                .to_owned()
        };
        let [a, e] = ["A", "E"].map(|name| Illuminant::named(name).unwrap());
        assert_eq!(named("lamps/A.csv", &e), "A.csv");
        assert_eq!(named("lamps/a.csv", &e), "a.csv");
        assert_eq!(named("lamps/A.csv", &a), "A");
        assert_eq!(named("lamps/f11.csv", &e), "f11");
        assert!(Illuminant::from_csv_file(Path::new("lamps/A"), &text(&e), None).is_err());
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
    fn a_light_that_ends_early_needs_to_say_what_is_beyond() {
        let nm: Vec<f64> = (0..=80).map(|i| 380.0 + 5.0 * f64::from(i)).collect();
        let power: Vec<f64> = nm.iter().map(|nm| nm - 370.0).collect();
        let light = |ends| Illuminant::from_samples("lamp", &nm, &power, ends);
        let refused = light(None).unwrap_err();
        assert!(refused.lacks_ends());
        let line = "covers 380 to 780 nm, expected at least 300 to 830 nm";
        assert_eq!(refused.to_string(), line);
        let [zero, hold] = [Ends::Zero, Ends::Hold].map(|ends| light(Some(ends)).unwrap());
        assert_eq!((zero.given_nm(), hold.given_nm()), ([380, 780], [300, 830]));
        let ends =
            |light: &Illuminant| [300.0, 379.0, 380.0, 780.0, 781.0].map(|nm| light.power.at(nm));
        assert_eq!(ends(&zero), [0.0, 0.0, 10.0, 410.0, 0.0]);
        assert_eq!(ends(&hold), [10.0, 10.0, 10.0, 410.0, 410.0]);
        let short = Illuminant::from_samples("lamp", &nm[5..], &power[5..], Some(Ends::Hold));
        let line = "covers 405 to 780 nm, expected at least 400 to 700 nm";
        assert_eq!(short.unwrap_err().to_string(), line);
    }

    #[test]
    fn a_light_between_whole_wavelengths_keeps_its_power_at_its_ends() {
        // Rounding only.
        const ROUNDING: f64 = 1e-9;
        let nm: Vec<f64> = (0..=400).map(|i| 380.5 + f64::from(i)).collect();
        let power = vec![2.0; nm.len()];
        for (ends, area) in [(Ends::Zero, 800.0), (Ends::Hold, 2.0 * 531.0)] {
            let light = Illuminant::from_samples("lamp", &nm, &power, Some(ends)).unwrap();
            assert!((light.power.values().iter().sum::<f64>() - area).abs() < ROUNDING, "{ends}");
        }
    }

    #[test]
    fn a_published_lamp_is_the_built_in_one() {
        let fl4 = Illuminant::named("FL4").unwrap();
        let [first_nm, last_nm] = fl4.given_nm();
        let nm: Vec<f64> = (first_nm..=last_nm).step_by(5).map(f64::from).collect();
        let power: Vec<f64> = nm.iter().map(|nm| fl4.power.at(*nm)).collect();
        let light = |ends| Illuminant::from_samples("FL4", &nm, &power, Some(ends));
        assert_eq!(light(Ends::Zero).unwrap().given_nm(), fl4.given_nm());
        assert!(matches!(light(Ends::Hold), Err(IlluminantError::Name(NameError::Taken { .. }))));
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
