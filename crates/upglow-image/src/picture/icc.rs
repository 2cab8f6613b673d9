//! ICC profiles of three colorants and one curve.
//!
//! # Source
//!
//! `icc`, clauses 7, 9.2 and 10.

use upglow_color::{Adaptation, Matrix3, RgbSpace, Xyz};

use super::code_points;
use super::encoding::{Encoding, ParametricCurve};
use super::error::PictureError;
use super::stated::{Stated, StatedColor};

/// Who states a color in messages.
const BY: &str = "ICC profile";
/// The white of the connection space.
const D50: Xyz = Xyz([0.9642, 1.0, 0.8249]);
/// Greatest difference of a colorant from that of a built-in space. Profiles of one space differ by up
/// to 3e-4; any two built-in spaces by 0.01.
const SAME_COLORANT: f64 = 1e-3;
/// Greatest difference of a curve from a known one, in linear light. Tables of 1024 numbers of 16 bits
/// and parameters of 16 binary digits stay below it; sRGB and a power of 2.2 differ by 0.007.
const SAME_CURVE: f64 = 1e-3;

/// What a profile states.
///
/// # Errors
///
/// [`PictureError`] if it states a curve of displays of high dynamic range.
pub(super) fn stated(profile: &[u8]) -> Result<StatedColor, PictureError> {
    let Some(tags) = Tags::of(profile) else {
        return Ok(StatedColor::unread("a damaged ICC profile".into()));
    };
    if let Some([b'c', b'i', b'c', b'p', _, _, _, _, _, transfer, ..]) = tags.value(b"cicp") {
        code_points::check_transfer(*transfer, BY)?;
    }
    let class = tags.four(16);
    if !matches!(class, b"RGB " | b"GRAY") {
        let class = String::from_utf8_lossy(class).trim().escape_debug().to_string();
        return Ok(StatedColor::unread(format!("an ICC profile of {class} colors")));
    }
    if let Some(table) = [b"A2B0", b"A2B1", b"A2B2"].into_iter().find(|t| tags.value(t).is_some()) {
        let table = String::from_utf8_lossy(table);
        return Ok(StatedColor::unread(format!("an ICC profile with a table ({table})")));
    }
    let curves: &[&[u8; 4]] =
        if class == b"GRAY" { &[b"kTRC"] } else { &[b"rTRC", b"gTRC", b"bTRC"] };
    let encoding = match curve(&tags, curves) {
        Ok(encoding) => Stated::yes(encoding, BY),
        Err(found) => Stated::Unread(found),
    };
    let space = if class == b"GRAY" {
        Stated::No
    } else {
        match space(&tags) {
            Some(space) => Stated::yes(space, BY),
            None => Stated::Unread("an ICC profile without usable colorants".into()),
        }
    };
    Ok(StatedColor { space, encoding })
}

/// A profile whose header and table of tags are valid.
struct Tags<'p> {
    profile: &'p [u8],
    count: usize,
}

const HEADER_BYTES: usize = 128;
const TAG_BYTES: usize = 12;

impl<'p> Tags<'p> {
    fn of(profile: &'p [u8]) -> Option<Self> {
        let is_profile = profile.get(36..40)? == b"acsp";
        let count = big_endian(profile.get(HEADER_BYTES..HEADER_BYTES + 4)?);
        let end = count.checked_mul(TAG_BYTES)?.checked_add(HEADER_BYTES + 4)?;
        (is_profile && end <= profile.len()).then_some(Self { profile, count })
    }

    fn four(&self, at: usize) -> &'p [u8; 4] {
        self.profile[at..].first_chunk().expect("it is inside the header")
    }

    /// The bytes of a tag.
    fn value(&self, name: &[u8; 4]) -> Option<&'p [u8]> {
        let entries = self.profile[HEADER_BYTES + 4..].chunks_exact(TAG_BYTES).take(self.count);
        let entry = entries.into_iter().find(|entry| entry[..4] == name[..])?;
        let [at, size] = [4, 8].map(|k| big_endian(&entry[k..k + 4]));
        self.profile.get(at..at.checked_add(size)?)
    }

    /// The numbers of a tag of this type.
    fn numbers<const N: usize>(&self, name: &[u8; 4], kind: &[u8; 4]) -> Option<[f64; N]> {
        let value = self.value(name)?;
        let found = value.get(8..8 + 4 * N).filter(|_| value.starts_with(kind))?;
        let numbers: &[[u8; 4]; N] = found.as_chunks().0.try_into().ok()?;
        Some(numbers.map(fixed))
    }
}

fn big_endian(bytes: &[u8]) -> usize {
    bytes.iter().fold(0, |sum, byte| sum << 8 | usize::from(*byte))
}

/// A number with 16 binary digits after the point.
fn fixed(bytes: [u8; 4]) -> f64 {
    f64::from(i32::from_be_bytes(bytes)) / 65536.0
}

/// The built-in space with these colorants, or one of its own.
fn space(tags: &Tags<'_>) -> Option<RgbSpace> {
    let column = |name: &[u8; 4]| tags.numbers::<3>(name, b"XYZ ");
    let columns = [column(b"rXYZ")?, column(b"gXYZ")?, column(b"bXYZ")?];
    let is_same = |space: &RgbSpace| {
        let adapted = adapted_from(Xyz::from_chromaticity(space.white()));
        let known = (adapted * space.xyz_from_rgb()).0;
        (0..3).all(|row| (0..3).all(|k| (known[row][k] - columns[k][row]).abs() < SAME_COLORANT))
    };
    let mut known = RgbSpace::names().into_iter().filter_map(|name| RgbSpace::named(name).ok());
    known.find(is_same).or_else(|| {
        let to_native = match tags.numbers::<9>(b"chad", b"sf32") {
            Some(m) => Matrix3([[m[0], m[1], m[2]], [m[3], m[4], m[5]], [m[6], m[7], m[8]]]),
            None => adapted_from(tags.numbers(b"wtpt", b"XYZ ").map_or(D50, Xyz)),
        };
        let native = to_native.inverse()? * Matrix3::from_columns(columns);
        let chromaticity = |rgb: [f64; 3]| Xyz(native * rgb).chromaticity();
        let [red, green, blue] =
            [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]].map(chromaticity);
        RgbSpace::custom("custom", [red?, green?, blue?], chromaticity([1.0; 3])?).ok()
    })
}

/// The adaptation that profiles use, from a white to that of the connection space.
fn adapted_from(white: Xyz) -> Matrix3 {
    Adaptation::Bradford.target_from_source(white, D50)
}

/// The one curve of all channels, or what is in its place.
fn curve(tags: &Tags<'_>, names: &[&[u8; 4]]) -> Result<Encoding, String> {
    let curves = names.iter().map(|name| tags.value(name).and_then(Curve::of));
    let Some(curves) = curves.collect::<Option<Vec<Curve>>>() else {
        return Err("an ICC profile without usable curves".into());
    };
    let [first, rest @ ..] = &curves[..] else {
        return Err("an ICC profile without curves".into());
    };
    if rest.iter().any(|other| other.distance(|v| first.at(v)) > SAME_CURVE) {
        return Err("an ICC profile with different curves for red, green and blue".into());
    }
    let decoded = |encoding: Encoding| move |v: f64| encoding.to_linear([v; 3])[0];
    let known = [Encoding::Linear, Encoding::Srgb, Encoding::Bt709];
    if let Some(known) = known.into_iter().find(|&e| first.distance(decoded(e)) < SAME_CURVE) {
        return Ok(known);
    }
    match first {
        &Curve::Parametric(ParametricCurve { numbers: [gamma, 1.0, 0.0, _, 0.0, 0.0, _] }) => {
            Encoding::of_gamma(gamma).ok_or_else(|| odd_gamma(gamma))
        }
        Curve::Parametric(curve) => match Encoding::of_gamma(curve.numbers[0]) {
            Some(_) => Ok(Encoding::Parametric(*curve)),
            None => Err(odd_gamma(curve.numbers[0])),
        },
        Curve::Table(table) => {
            let middle = table.at(0.5);
            let gamma = Encoding::Gamma(middle.ln() / 0.5_f64.ln());
            if middle > 0.0 && first.distance(decoded(gamma)) < SAME_CURVE {
                return Ok(gamma);
            }
            Err(format!("an ICC profile with a curve of {} numbers", table.0.len()))
        }
    }
}

fn odd_gamma(gamma: f64) -> String {
    format!("an ICC profile with a gamma of {gamma}, outside {}", Encoding::GAMMAS)
}

enum Curve {
    Parametric(ParametricCurve),
    Table(Table),
}

/// Samples of a curve at equal steps, 0..=1.
struct Table(Vec<f64>);

impl Table {
    fn at(&self, v: f64) -> f64 {
        let last = self.0.len() - 1;
        let position = v * last as f64;
        let low = upglow_color::rounding::whole(position).min(last);
        let high = (low + 1).min(last);
        let share = position - low as f64;
        self.0[low] + share * (self.0[high] - self.0[low])
    }
}

impl Curve {
    fn of(value: &[u8]) -> Option<Self> {
        let parametric = |numbers: [f64; 7]| {
            let is_finite = numbers.iter().all(|v| v.is_finite());
            is_finite.then_some(Self::Parametric(ParametricCurve { numbers }))
        };
        match value.first_chunk()? {
            b"curv" => {
                let count = big_endian(value.get(8..12)?);
                let bytes = value.get(12..count.checked_mul(2)?.checked_add(12)?)?;
                let words: Vec<u16> =
                    bytes.as_chunks().0.iter().map(|b| u16::from_be_bytes(*b)).collect();
                match words[..] {
                    [] => parametric([1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
                    [gamma] => parametric([f64::from(gamma) / 256.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
                    _ => {
                        let fraction = |v: &u16| f64::from(*v) / f64::from(u16::MAX);
                        Some(Self::Table(Table(words.iter().map(fraction).collect())))
                    }
                }
            }
            b"para" => {
                let number = |k: usize| {
                    let bytes = value.get(12 + 4 * k..)?.first_chunk()?;
                    Some(fixed(*bytes))
                };
                let g = number(0)?;
                match big_endian(value.get(8..10)?) {
                    0 => parametric([g, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
                    1 => {
                        let (a, b) = (number(1)?, number(2)?);
                        parametric([g, a, b, 0.0, -b / a, 0.0, 0.0])
                    }
                    2 => {
                        let (a, b, c) = (number(1)?, number(2)?, number(3)?);
                        parametric([g, a, b, 0.0, -b / a, c, c])
                    }
                    3 => parametric([g, number(1)?, number(2)?, number(3)?, number(4)?, 0.0, 0.0]),
                    4 => parametric([
                        g,
                        number(1)?,
                        number(2)?,
                        number(3)?,
                        number(4)?,
                        number(5)?,
                        number(6)?,
                    ]),
                    _ => None,
                }
            }
            _ => None,
        }
    }

    fn at(&self, v: f64) -> f64 {
        match self {
            Self::Parametric(curve) => Encoding::Parametric(*curve).to_linear([v; 3])[0],
            Self::Table(table) => table.at(v),
        }
    }

    /// Greatest difference from another curve over 0..=1; NaN counts as infinite.
    fn distance(&self, other: impl Fn(f64) -> f64) -> f64 {
        const STEPS: u32 = 256;
        let differences = (0..=STEPS).map(|i| {
            let v = f64::from(i) / f64::from(STEPS);
            let difference = (self.at(v) - other(v)).abs();
            if difference.is_nan() { f64::INFINITY } else { difference }
        });
        differences.fold(0.0, f64::max)
    }
}
