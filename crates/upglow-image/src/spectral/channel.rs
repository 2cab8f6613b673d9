//! Channel names of the spectral layout of OpenEXR.
//!
//! # Source
//!
//! `fichet`: radiance `S0.` to `S3.`, reflectance `T.`, re-radiation `T.` with two wavelengths, a
//! comma as the decimal mark, because a point separates layers.

use std::cmp::Ordering;
use std::fmt;
use std::str::FromStr;

use upglow_color::{BispectralUnit, Choice as _};

use crate::exr::attribute::Attributes;

/// A spectral channel. Wavelengths are in nm, whatever the unit in the name.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum SpectralChannel {
    /// Radiance or another emissive quantity: `S0.` and, for polarized light, `S1.` to `S3.`.
    Radiance {
        /// The Stokes component, 0..=3.
        stokes: u8,
        /// Wavelength, nm; > 0.
        nm: f64,
    },
    /// Reflectance or transmittance at one wavelength: `T.`; the diagonal of a re-radiation
    /// matrix.
    Reflectance {
        /// Wavelength, nm; > 0.
        nm: f64,
    },
    /// Share of light at one wavelength that leaves at another: `T.` with two wavelengths.
    Reradiation {
        /// Wavelength of the incident light, nm; > 0.
        in_nm: f64,
        /// Wavelength of the outgoing light, nm; > 0.
        out_nm: f64,
    },
}

/// Why a name is not that of a spectral channel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum SpectralNameError {
    /// The name does not begin like that of a spectral channel: an ordinary channel, not an error.
    NotSpectral,
    /// The name begins like that of a spectral channel, but is invalid.
    Invalid {
        /// The invalid part.
        found: String,
        /// What would be valid.
        expected: &'static str,
    },
}

/// SI prefixes for 10³, 10⁶ and so on, and for 10⁻³, 10⁻⁶ and so on.
const LARGE_AND_SMALL: [&str; 2] = ["kMGTPEZY", "munpfazy"];

/// Speed of light in vacuum, m/s: exact by definition.
const LIGHT_M_PER_S: f64 = 299_792_458.0;

/// Nanometers per meter, as a power of ten.
const NANO: i32 = 9;

impl SpectralChannel {
    /// Whether a name begins like that of a spectral channel, valid or not.
    pub(crate) fn is_spectral(name: &str) -> bool {
        split(name).is_some()
    }

    /// Index of the kind (the Stokes component, then reflectance, then re-radiation) and wavelengths in
    /// nm, of which a missing second one is 0.
    pub(crate) fn key(self) -> (u8, [f64; 2]) {
        match self {
            Self::Radiance { stokes, nm } => (stokes, [nm, 0.0]),
            Self::Reflectance { nm } => (4, [nm, 0.0]),
            Self::Reradiation { in_nm, out_nm } => (5, [in_nm, out_nm]),
        }
    }
}

/// The order of two [`SpectralChannel::key`]s.
pub(crate) fn key_order(a: (u8, [f64; 2]), b: (u8, [f64; 2])) -> Ordering {
    let waves = |k: usize| a.1[k].total_cmp(&b.1[k]);
    a.0.cmp(&b.0).then(waves(0)).then(waves(1))
}

/// Indices of the incident and the outgoing band of each pair that has a channel: those with the longer
/// wavelength outgoing.
pub(crate) fn rising_pairs(bands: usize) -> impl Iterator<Item = [usize; 2]> {
    (0..bands).flat_map(move |incident| (incident + 1..bands).map(move |o| [incident, o]))
}

/// The kind, `S0` to `S3` or `T`, and the rest of the name after the point.
fn split(name: &str) -> Option<(&str, &str)> {
    let (kind, rest) = name.split_once('.')?;
    matches!(kind, "S0" | "S1" | "S2" | "S3" | "T").then_some((kind, rest))
}

impl FromStr for SpectralChannel {
    type Err = SpectralNameError;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        let Some((kind, rest)) = split(name) else {
            return Err(SpectralNameError::NotSpectral);
        };
        let parts: Vec<&str> = rest.split('.').collect();
        // Digits without a unit are the integer part of a number with a decimal point.
        let digits = |part: &&str| !part.is_empty() && part.bytes().all(|b| b.is_ascii_digit());
        if parts[..parts.len() - 1].iter().any(digits) {
            return Err(invalid("a decimal point", "a comma as in 550,000000nm"));
        }
        let waves = parts.iter().map(|part| wavelength_nm(part)).collect::<Result<Vec<_>, _>>()?;
        let stokes = kind.as_bytes().get(1).map(|digit| digit - b'0');
        match (stokes, &waves[..]) {
            (Some(stokes), &[nm]) => Ok(Self::Radiance { stokes, nm }),
            (None, &[nm]) => Ok(Self::Reflectance { nm }),
            (None, &[in_nm, out_nm]) => Ok(Self::Reradiation { in_nm, out_nm }),
            (stokes, _) => {
                let expected = if stokes.is_some() { "1" } else { "1 or 2" };
                Err(invalid(format!("{} wavelengths", waves.len()), expected))
            }
        }
    }
}

fn invalid(found: impl Into<String>, expected: &'static str) -> SpectralNameError {
    SpectralNameError::Invalid { found: found.into(), expected }
}

/// One wavelength or frequency, as `550,000000nm` or `545THz`, in nm.
fn wavelength_nm(text: &str) -> Result<f64, SpectralNameError> {
    let (number, unit) = number_and_unit(text);
    if number.is_empty() {
        return Err(invalid(format!("no number before {unit:?}"), "one as 550,000000nm"));
    }
    let power = |base: &str| prefix_power(unit.strip_suffix(base)?);
    let nm = match (power("Hz"), power("m")) {
        (Some(power), _) => parse(number, power).map(|hz| LIGHT_M_PER_S / hz * 1e9),
        (None, Some(power)) => parse(number, power + NANO),
        _ => {
            let expected = "m or Hz with an SI prefix, as nm or THz";
            return Err(invalid(format!("the unit {unit:?}"), expected));
        }
    };
    nm.filter(|nm| nm.is_finite() && *nm > 0.0).ok_or_else(|| {
        invalid(format!("the number {number:?}"), "digits with at most one comma, above 0")
    })
}

/// The power of ten of an SI prefix.
fn prefix_power(prefix: &str) -> Option<i32> {
    let [thousands, thousandths] = LARGE_AND_SMALL
        .map(|letters| (1..).zip(letters.chars()).find(|(_, c)| prefix.chars().eq([*c])));
    match prefix {
        "" => Some(0),
        "da" => Some(1),
        "h" => Some(2),
        "d" => Some(-1),
        "c" => Some(-2),
        _ => thousands.map(|(n, _)| 3 * n).or(thousandths.map(|(n, _)| -3 * n)),
    }
}

/// Splits before the unit; an exponent, as in `5,5e2nm`, belongs to the number.
pub(crate) fn number_and_unit(text: &str) -> (&str, &str) {
    let end = text.find(|c: char| !(c.is_ascii_digit() || c == ',')).unwrap_or(text.len());
    let (number, rest) = text.split_at(end);
    let exponent = rest.strip_prefix(['e', 'E']).filter(|_| !number.is_empty());
    let Some(exponent) = exponent else { return (number, rest) };
    let unsigned = exponent.strip_prefix(['+', '-']).unwrap_or(exponent);
    let digits = unsigned.bytes().take_while(u8::is_ascii_digit).count();
    if digits == 0 {
        return (number, rest);
    }
    let length = end + 1 + (exponent.len() - unsigned.len()) + digits;
    text.split_at(length)
}

/// The number times a power of ten, rounded once, so that 550nm is exactly 550 nm.
fn parse(number: &str, power: i32) -> Option<f64> {
    let plain = number.replacen(',', ".", 1);
    if plain.contains(',') || plain == "." {
        return None;
    }
    let (mantissa, exponent) = plain.split_once(['e', 'E']).unwrap_or((&plain, "0"));
    let exponent: i32 = exponent.parse().ok()?;
    format!("{mantissa}e{}", exponent.checked_add(power)?).parse().ok()
}

impl fmt::Display for SpectralChannel {
    /// The name of the channel, in nm with six decimals like the reference implementation of the layout.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let wave = |nm: f64| format!("{nm:.6}nm").replace('.', ",");
        match *self {
            Self::Radiance { stokes, nm } => write!(f, "S{stokes}.{}", wave(nm)),
            Self::Reflectance { nm } => write!(f, "T.{}", wave(nm)),
            Self::Reradiation { in_nm, out_nm } => write!(f, "T.{}.{}", wave(in_nm), wave(out_nm)),
        }
    }
}

/// Attribute: the version of the layout.
pub(crate) const LAYOUT_VERSION: &str = "spectralLayoutVersion";
/// The version that upglow reads and writes.
pub(crate) const LAYOUT_VERSION_VALUE: &str = "1.0";
/// Attribute: the unit of `S0.` channels.
pub(crate) const EMISSIVE_UNITS: &str = "emissiveUnits";
/// Attribute of upglow: the unit of re-radiation channels, which the layout does not specify.
pub(crate) const BISPECTRAL_UNIT: &str = "upglow.bispectralUnit";

/// The unit of re-radiation that a file states, if it is a known one.
pub(crate) fn stated_unit(attributes: &Attributes) -> Option<BispectralUnit> {
    BispectralUnit::named(attributes.get(BISPECTRAL_UNIT)?.as_text()?).ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn read(name: &str) -> Result<SpectralChannel, SpectralNameError> {
        name.parse()
    }

    #[test]
    fn other_spellings_of_names_are_read() {
        for name in
            ["T.550,000000nm", "T.550,000nm", "T.550nm", "T.5,5e2nm", "T.0,55um", "T.55e1nm"]
        {
            assert_eq!(read(name), Ok(SpectralChannel::Reflectance { nm: 550.0 }), "{name}");
        }
        let stokes = read("S2.0,0000005m").unwrap();
        assert_eq!(stokes, SpectralChannel::Radiance { stokes: 2, nm: 500.0 });
        let Ok(SpectralChannel::Radiance { stokes: 0, nm }) = read("S0.600THz") else { panic!() };
        assert!((nm - 499.654_096_7).abs() < 1e-6, "{nm}");
        let pair = read("T.380,000000nm.390,000000nm");
        assert_eq!(pair, Ok(SpectralChannel::Reradiation { in_nm: 380.0, out_nm: 390.0 }));
    }

    #[test]
    fn invalid_names_are_refused_with_the_invalid_part() {
        for (name, expected) in [
            ("T.nm", "no number before \"nm\""),
            ("T.", "no number before \"\""),
            ("S0.Hz", "no number before \"Hz\""),
            ("S0.T.550nm", "no number before \"T\""),
            ("T.550.5nm", "a decimal point"),
            ("T.550.000000nm.560.000000nm", "a decimal point"),
            ("T.550", "the unit \"\""),
            ("T.550qm", "the unit \"qm\""),
            ("T.5,5,0nm", "the number \"5,5,0\""),
            ("T.,nm", "the number \",\""),
            ("T.0nm", "the number \"0\""),
            ("T.1e400nm", "the number \"1e400\""),
            ("S0.400nm.500nm", "2 wavelengths"),
            ("T.400nm.500nm.600nm", "3 wavelengths"),
        ] {
            let Err(SpectralNameError::Invalid { found, .. }) = read(name) else {
                panic!("{name} is accepted");
            };
            assert_eq!(found, expected, "{name}");
        }
        for name in ["R", "S4.550nm"] {
            assert_eq!(read(name), Err(SpectralNameError::NotSpectral));
        }
    }

    proptest! {
        #[test]
        fn printed_names_are_read_back(micro in 1_u32..4_000_000_000, other in 1_u32..4_000_000_000, stokes in 0_u8..4) {
            let nm = |n: u32| f64::from(n) / 1e6;
            for channel in [
                SpectralChannel::Reflectance { nm: nm(micro) },
                SpectralChannel::Radiance { stokes, nm: nm(micro) },
                SpectralChannel::Reradiation { in_nm: nm(micro), out_nm: nm(other) },
            ] {
                prop_assert_eq!(read(&channel.to_string()), Ok(channel));
            }
        }

        #[test]
        fn no_name_panics(name in "(S0|T|S3)?\\.?[0-9,.eE+nmHzTkd-]{0,20}") {
            if let Ok(channel) = read(&name) {
                let (_, [first, second]) = channel.key();
                let is_pair = matches!(channel, SpectralChannel::Reradiation { .. });
                prop_assert!(first > 0.0 && (second > 0.0 || !is_pair));
            }
        }

        #[test]
        fn no_text_panics(name in ".{0,30}") {
            let _ = read(&name);
        }
    }
}
