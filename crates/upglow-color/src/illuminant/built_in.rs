//! The built-in lights, by name.

use super::{Illuminant, IlluminantError};
use crate::grid::Grid;
use crate::spectrum::Spectrum;
use crate::tables::daylight::{DAYLIGHT_COMPONENTS, DAYLIGHT_FIRST_NM, DAYLIGHT_STEP_NM};
use crate::tables::lamps::LAMPS;

/// The second radiation constant, h·c/k, nm·K. All three are exact in the SI since 2019.
const C2_NM_K: f64 = 1.438_776_877e7;

/// The same constant over that of the temperature scale in which the nominal color temperatures of
/// daylight were defined: they scale by the ratio.
const C2_NOW_OVER_C2_THEN: f64 = C2_NM_K / 1.438_0e7;

/// Daylights with a name, and their nominal correlated color temperatures, K.
const DAYLIGHTS: [(&str, f64); 5] =
    [("D50", 5000.0), ("D55", 5500.0), ("D60", 6000.0), ("D65", 6500.0), ("D75", 7500.0)];

/// Names of other lights that are computed.
const COMPUTED: [&str; 5] = ["A", "E", "M0", "M1", "M2"];

/// Correlated color temperatures of daylight, K: those for which the CIE gives its formula.
const DAYLIGHT_K: [f64; 2] = [4000.0, 25_000.0];

/// Temperatures of blackbodies, K. A cooler one hardly glows; a hotter one looks as the hottest.
const BLACKBODY_K: [f64; 2] = [1000.0, 100_000.0];

/// The wavelength at which lights that are computed have power 100, nm.
const REFERENCE_NM: f64 = 560.0;

/// Light for measurements without ultraviolet has no power below this wavelength, nm.
///
/// # Source
///
/// `iso13655`, measurement condition M2.
const M2_FROM_NM: f64 = 420.0;

/// Between the name of a light and the wavelength below which a filter takes it.
const CUT: &str = "-CUT";
/// Where filters for ultraviolet begin to let light pass, nm.
const CUTS_NM: [u32; 2] = [320, 500];

impl Illuminant {
    /// The built-in lights as a list for messages and help.
    pub const FAMILIES: &str = "D50, D55, D60, D65, D75, A, E, FL1 to FL12, FL3.1 to FL3.15, \
        HP1 to HP5, LED-B1 to LED-B5, LED-BH1, LED-RGB1, LED-V1, LED-V2, ID50, ID65, M0, M1, M2, \
        1000K to 100000K (blackbody), D4000K to D25000K (daylight), D65-cut400 (any of them without power \
        below 320 to 500 nm)";

    /// Every name of a built-in light that is not made of a temperature.
    #[must_use]
    pub fn names() -> Vec<&'static str> {
        let daylights = DAYLIGHTS.iter().map(|(name, _)| *name);
        let lamps = LAMPS.iter().flat_map(|table| table.lamps).map(|(name, _)| *name);
        daylights.chain(COMPUTED).chain(lamps).collect()
    }

    /// The built-in light of this name, in any case.
    ///
    /// - `D50`, `D55`, `D60`, `D65`, `D75`: daylight of that nominal correlated color temperature in
    ///   hundreds of kelvins; `A`: incandescent light; `E`: equal power at all wavelengths
    /// - `FL1` to `FL12`, `FL3.1` to `FL3.15`, `HP1` to `HP5`, `LED-B1` to `LED-V2`: the lamps of the
    ///   CIE, given from 380 to 780 nm; `ID50`, `ID65`: daylight behind a window, given from 300 to 780 nm
    /// - `M0`, `M1`, `M2`: the measurement conditions of the graphic industry. M0 is A, M1 is D50, M2 is
    ///   D50 without power below 420 nm
    /// - `3000K`: a blackbody of that temperature, 1000 to 100000 K
    /// - `D6200K`: daylight of that correlated color temperature, 4000 to 25000 K. `D65` is `D6503.5K`,
    ///   nearly: its nominal temperature is that of an older scale
    /// - `D65-cut400`: one of these behind a filter that takes all power below that wavelength, 320 to 500 nm
    ///
    /// # Errors
    ///
    /// [`IlluminantError::Unknown`] lists the known names; [`IlluminantError::Temperature`] if there is
    /// no formula for the temperature; [`IlluminantError::Cut`] if the filter begins elsewhere.
    ///
    /// # Source
    ///
    /// `cie015`: illuminants A, D, FL, HP, LED and ID. `iso13655`: M0 to M2.
    pub fn named(name: &str) -> Result<Self, IlluminantError> {
        let word = name.to_ascii_uppercase();
        if let Some((light, nm)) = word.rsplit_once(CUT) {
            return Self::cut(name, light, nm);
        }
        if let Some((known, nominal_k)) = DAYLIGHTS.iter().find(|(known, _)| *known == word) {
            return Ok(Self::nominal_daylight(known, *nominal_k));
        }
        match word.as_str() {
            "A" | "M0" => Ok(Self::a()),
            "E" => Ok(Self::from_fn("E", |_| 100.0)),
            "M1" => Self::named("D50"),
            "M2" => Ok(Self::nominal_daylight("D50", 5000.0).filtered("M2", M2_FROM_NM)),
            _ => match Self::lamp(&word) {
                Some(lamp) => Ok(lamp),
                None => Self::of_temperature(&word, name),
            },
        }
    }

    /// A light behind a filter.
    fn cut(name: &str, light: &str, nm: &str) -> Result<Self, IlluminantError> {
        let light = Self::named(light)?;
        let [least_nm, most_nm] = CUTS_NM;
        match nm.parse::<u32>() {
            Ok(nm) if (least_nm..=most_nm).contains(&nm) => {
                let filtered = format!("{}{}{nm}", light.name, CUT.to_ascii_lowercase());
                Ok(light.filtered(&filtered, f64::from(nm)))
            }
            _ => Err(IlluminantError::Cut { name: name.into(), range_nm: CUTS_NM }),
        }
    }

    pub(super) fn d65() -> Self {
        Self::nominal_daylight("D65", 6500.0)
    }

    /// A lamp of the tables.
    fn lamp(word: &str) -> Option<Self> {
        LAMPS.iter().find_map(|table| {
            let (name, power) = table.lamps.iter().find(|(name, _)| *name == word)?;
            let grid = Grid::try_new(table.first_nm, table.last_nm, table.step_nm)
                .expect("the table is on a grid");
            let power = Spectrum::new(grid, power.to_vec()).expect("the table fills the grid");
            Some(Self::of(name, &power))
        })
    }

    /// The light of a word such as `3000K` or `D6200K`.
    fn of_temperature(word: &str, name: &str) -> Result<Self, IlluminantError> {
        let (kind, range_k, number) = match word.strip_prefix('D') {
            Some(number) => ("daylight", DAYLIGHT_K, number),
            None => ("a blackbody", BLACKBODY_K, word),
        };
        let is_digit = |c: char| c.is_ascii_digit() || c == '.';
        let number = number.strip_suffix('K').filter(|number| number.chars().all(is_digit));
        let Some(found_k) = number.and_then(|number| number.parse::<f64>().ok()) else {
            return Err(IlluminantError::Unknown { found: name.into() });
        };
        let [least_k, most_k] = range_k;
        if !(least_k..=most_k).contains(&found_k) {
            return Err(IlluminantError::Temperature { name: name.into(), kind, found_k, range_k });
        }
        Ok(match kind {
            "daylight" => Self::daylight(&format!("D{found_k}K"), found_k),
            _ => Self::blackbody(&format!("{found_k}K"), found_k, C2_NM_K),
        })
    }

    fn nominal_daylight(name: &str, nominal_k: f64) -> Self {
        Self::daylight(name, nominal_k * C2_NOW_OVER_C2_THEN)
    }

    /// A phase of daylight of the given correlated color temperature.
    ///
    /// # Source
    ///
    /// `cie015`, section 4.1.2; M1 and M2 rounded to three decimals as CIE does for its tables.
    fn daylight(name: &str, cct_k: f64) -> Self {
        let [x, y] = daylight_chromaticity(cct_k);
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
        let power = power.resampled(Grid::FINE).scaled(scale);
        Self::of(name, &power)
    }

    /// CIE standard illuminant A, incandescent light.
    ///
    /// # Source
    ///
    /// `cie015`, section 4.1.1, equation 1: 2848 K with the second constant 1.435e7 nm·K.
    fn a() -> Self {
        Self::blackbody("A", 2848.0, 1.435e7)
    }

    /// Planck's law for a temperature, K, and a second radiation constant, nm·K.
    fn blackbody(name: &str, t_k: f64, c2_nm_k: f64) -> Self {
        let planck = |nm: f64| nm.powi(-5) / ((c2_nm_k / (t_k * nm)).exp() - 1.0);
        Self::from_fn(name, |nm| 100.0 * planck(nm) / planck(REFERENCE_NM))
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
