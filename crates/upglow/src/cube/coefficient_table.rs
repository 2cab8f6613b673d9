//! Tables of sigmoid coefficients as other renderers read them: `.coeff` files.

use upglow_color::rounding::{to_single, whole};
use upglow_color::{Contract, Grid, LinearRgb};

use crate::material::sigmoid::Sigmoid;

/// Reflectances for the RGB colors of a unit cube, in the layout that `rgb2spec` defined and that
/// Mitsuba 3 and colour-science read.
///
/// Such a file names neither its RGB space nor its light, and holds neither fluorescence nor a slope
/// limit between its nodes; a [`crate::Cube`] does. Use it for programs that read nothing else.
///
/// Nodes are `[largest][brightness][next but one][next][coefficient]`: which channel is the largest,
/// its value by [`CoefficientTable::brightness`], and the two channels after it (red follows blue)
/// divided by it, evenly spaced in 0..=1. The coefficients are c0, c1, c2 for λ in nm.
///
/// # Source
///
/// `jakob`, section 4; the published program `rgb2spec` for the layout.
#[derive(Clone, Debug, PartialEq)]
pub struct CoefficientTable {
    brightness: Vec<f32>,
    nodes: Vec<[f32; 3]>,
    integrator: Option<Integrator>,
}

/// How a reflectance becomes RGB: the end of files since 2026.
#[derive(Clone, Debug, PartialEq)]
struct Integrator {
    /// Weights of the reflectance at [`Integrator::SAMPLES`] wavelengths from 360 to 830 nm,
    /// `[red, green, blue][wavelength]`.
    rgb_weights: [Vec<f32>; 3],
    xyz_from_rgb: [[f32; 3]; 3],
    white: [f32; 3],
}

/// Why a table of coefficients is invalid.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CoefficientTableError {
    /// The content does not begin with `SPEC`.
    #[error("it begins with {found:?}, expected \"SPEC\", a table of coefficients")]
    Magic {
        /// The first bytes as text.
        found: String,
    },
    /// The resolution is out of range.
    #[error("resolution {found}, expected {} to {}", CoefficientTable::RESOLUTIONS[0], CoefficientTable::RESOLUTIONS[1])]
    Resolution {
        /// The resolution found.
        found: usize,
    },
    /// The length fits neither layout.
    #[error("{found} bytes, expected {plain} at this resolution, or {whole} with its integrator")]
    Length {
        /// Bytes found.
        found: usize,
        /// Bytes without an integrator.
        plain: usize,
        /// Bytes with one.
        whole: usize,
    },
    /// Levels of brightness do not rise from 0 to 1.
    #[error("brightness level {index} is {found}, expected levels that rise from 0 to 1")]
    Brightness {
        /// Its index.
        index: usize,
        /// The level found.
        found: f32,
    },
    /// A coefficient is not finite.
    #[error("coefficient {index} is {found}, expected a finite number")]
    Coefficient {
        /// Its index in the file's order.
        index: usize,
        /// What it is.
        found: f32,
    },
    /// The integrator has another number of samples.
    #[error("{found} samples in the integrator, expected {}", Integrator::SLOTS)]
    Samples {
        /// Samples found.
        found: u32,
    },
}

const MAGIC: &[u8; 4] = b"SPEC";
/// Largest channel, by number.
const CHANNELS: usize = 3;

impl CoefficientTable {
    /// Smallest and greatest number of nodes along an axis. With 150 levels of brightness, the last
    /// two are equal in single precision.
    pub const RESOLUTIONS: [usize; 2] = [2, 128];
    /// More bytes than the largest table has.
    pub const MOST_BYTES: u64 = 128 << 20;

    /// The levels of brightness that the published program writes: dense at both ends.
    pub fn levels(resolution: usize) -> Vec<f32> {
        let last = (resolution.max(2) - 1) as f64;
        (0..resolution).map(|k| to_single(smooth_step(smooth_step(k as f64 / last)))).collect()
    }

    /// A table from its levels of brightness and nodes.
    ///
    /// # Errors
    ///
    /// [`CoefficientTableError`] if levels do not rise from 0 to 1, a coefficient is not finite,
    /// or there are not 3·n³ nodes for n levels.
    pub fn new(brightness: Vec<f32>, nodes: Vec<[f32; 3]>) -> Result<Self, CoefficientTableError> {
        let resolution = brightness.len();
        check_resolution(resolution)?;
        let expected = CHANNELS * resolution.pow(3);
        if nodes.len() != expected {
            let bytes = |nodes: usize| 8 + 4 * resolution + 12 * nodes;
            let [found, plain] = [nodes.len(), expected].map(bytes);
            let whole = plain + Integrator::BYTES;
            return Err(CoefficientTableError::Length { found, plain, whole });
        }
        check_levels(&brightness)?;
        let odd = nodes.as_flattened().iter().enumerate().find(|(_, c)| !c.is_finite());
        if let Some((index, &found)) = odd {
            return Err(CoefficientTableError::Coefficient { index, found });
        }
        Ok(Self { brightness, nodes, integrator: None })
    }

    /// Nodes along each axis.
    pub fn resolution(&self) -> usize {
        self.brightness.len()
    }

    /// Values of the largest channel at the nodes, from 0 to 1.
    pub fn brightness(&self) -> &[f32] {
        &self.brightness
    }

    /// Coefficients for λ in nm, in the file's order.
    pub fn nodes(&self) -> &[[f32; 3]] {
        &self.nodes
    }

    /// Adds the sums that turn a reflectance into RGB under the light and observer of a contract,
    /// which newer readers expect at the end of a file.
    #[must_use]
    pub fn with_integrator(self, contract: &Contract) -> Self {
        Self { integrator: Some(Integrator::of(contract)), ..self }
    }

    /// Whether the file says how a reflectance becomes RGB.
    pub fn has_integrator(&self) -> bool {
        self.integrator.is_some()
    }

    /// The color of a node: `largest` is a channel, the others are indices along the axes.
    pub fn node_rgb(&self, [largest, level, next_but_one, next]: [usize; 4]) -> LinearRgb {
        let last = (self.resolution() - 1) as f64;
        let value = f64::from(self.brightness[level]);
        let mut rgb = [value; 3];
        rgb[(largest + 1) % 3] = value * next as f64 / last;
        rgb[(largest + 2) % 3] = value * next_but_one as f64 / last;
        LinearRgb(rgb)
    }

    /// The reflectance that a reader of the file finds for a color, each channel clamped to 0..=1:
    /// coefficients interpolated along three axes.
    pub fn sigmoid(&self, rgb: [f32; 3]) -> Sigmoid {
        let rgb = rgb.map(|v| if v > 0.0 { f64::from(v.min(1.0)) } else { 0.0 });
        // Of equal channels the later one.
        let largest = (1..3).fold(0, |i, j| if rgb[j] >= rgb[i] { j } else { i });
        let value = rgb[largest];
        if value <= 0.0 {
            let [c0, c1, c2] = self.nodes[0].map(f64::from);
            return Sigmoid { c0, c1, c2 };
        }
        let along = |channel: usize| self.along(rgb[(largest + channel) % 3] / value);
        let axes = [self.level_of(value), along(2), along(1)];
        let mut coefficients = [0.0; 3];
        for corner in 0..8_usize {
            let (mut weight, mut place) = (1.0, largest);
            for (axis, (below, fraction)) in axes.into_iter().enumerate() {
                let above = corner >> axis & 1;
                weight *= if above == 1 { fraction } else { 1.0 - fraction };
                place = place * self.resolution() + below + above;
            }
            let node = self.nodes[place];
            (0..3).for_each(|k| coefficients[k] += weight * f64::from(node[k]));
        }
        let [c0, c1, c2] = coefficients;
        Sigmoid { c0, c1, c2 }
    }

    /// The evenly spaced node at or below a fraction, and the distance from it in steps.
    fn along(&self, fraction: f64) -> (usize, f64) {
        let position = fraction * (self.resolution() - 1) as f64;
        let below = whole(position).min(self.resolution() - 2);
        (below, position - below as f64)
    }

    fn level_of(&self, value: f64) -> (usize, f64) {
        let levels = &self.brightness[1..self.resolution() - 1];
        let below = levels.partition_point(|level| f64::from(*level) <= value);
        let [low, high] = [below, below + 1].map(|k| f64::from(self.brightness[k]));
        (below, (value - low) / (high - low))
    }

    /// The file's bytes, with the integrator if there is one. All numbers are little-endian.
    pub fn to_bytes(&self) -> Vec<u8> {
        let resolution = u32::try_from(self.resolution()).expect("at most 128");
        let mut bytes = [MAGIC.as_slice(), &resolution.to_le_bytes()].concat();
        let numbers = self.brightness.iter().chain(self.nodes.as_flattened());
        bytes.extend(numbers.flat_map(|v| v.to_le_bytes()));
        if let Some(integrator) = &self.integrator {
            integrator.append_to(&mut bytes);
        }
        bytes
    }

    /// Reads a file's bytes.
    ///
    /// # Errors
    ///
    /// [`CoefficientTableError`] if the bytes are not such a file.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, CoefficientTableError> {
        let body = bytes.strip_prefix(MAGIC).ok_or_else(|| CoefficientTableError::Magic {
            found: String::from_utf8_lossy(&bytes[..bytes.len().min(4)]).into_owned(),
        })?;
        let wrong_length = |plain: usize| CoefficientTableError::Length {
            found: bytes.len(),
            plain,
            whole: plain + Integrator::BYTES,
        };
        let (resolution, body) = body.split_first_chunk().ok_or_else(|| wrong_length(8))?;
        let resolution = u32::from_le_bytes(*resolution) as usize;
        check_resolution(resolution)?;
        let numbers = resolution + 3 * CHANNELS * resolution.pow(3);
        let (numbers, trailer) =
            body.split_at_checked(4 * numbers).ok_or_else(|| wrong_length(8 + 4 * numbers))?;
        let numbers = read_numbers(numbers);
        let integrator = match trailer.len() {
            0 => None,
            Integrator::BYTES => Some(Integrator::from_bytes(trailer)?),
            _ => return Err(wrong_length(bytes.len() - trailer.len())),
        };
        let (brightness, nodes) = numbers.split_at(resolution);
        let table = Self::new(brightness.to_vec(), nodes.as_chunks().0.to_vec())?;
        Ok(Self { integrator, ..table })
    }
}

impl Integrator {
    /// Wavelengths from 360 to 830 nm at which it takes a reflectance.
    const SAMPLES: usize = 283;
    /// Samples in the file: those after [`Integrator::SAMPLES`] are at 0 nm and have weight 0.
    const SLOTS: usize = 288;
    const BYTES: usize = 4 * (1 + 4 * Self::SLOTS + 9 + 3);
    const FIRST_NM: f64 = 360.0;
    const RANGE_NM: f64 = 470.0;

    /// Sums under the light and observer of a contract, over the straight lines between samples.
    fn of(contract: &Contract) -> Self {
        let colorimetry = contract.on(Grid::FINE);
        let to_rgb = colorimetry.rgb_from_xyz_matrix();
        let mut rgb_weights = [[0.0; Self::SAMPLES]; 3];
        let last = Self::SAMPLES - 1;
        for (nm, xyz) in Grid::FINE.wavelengths_nm().zip(colorimetry.weights()) {
            let position = (nm - Self::FIRST_NM) / Self::RANGE_NM * last as f64;
            if position < 0.0 {
                continue;
            }
            let rgb = to_rgb * *xyz;
            let below = whole(position).min(last - 1);
            let fraction = position - below as f64;
            for k in 0..3 {
                rgb_weights[k][below] += (1.0 - fraction) * rgb[k];
                rgb_weights[k][below + 1] += fraction * rgb[k];
            }
        }
        Self {
            rgb_weights: rgb_weights.map(|w| w.map(to_single).to_vec()),
            xyz_from_rgb: colorimetry.xyz_from_rgb_matrix().0.map(|row| row.map(to_single)),
            white: colorimetry.white().0.map(to_single),
        }
    }

    fn append_to(&self, bytes: &mut Vec<u8>) {
        let last = (Self::SAMPLES - 1) as f64;
        let nowhere = to_single(-Self::FIRST_NM / Self::RANGE_NM);
        let place = |i: usize| if i < Self::SAMPLES { to_single(i as f64 / last) } else { nowhere };
        let slots = u32::try_from(Self::SLOTS).expect("a small constant");
        bytes.extend(slots.to_le_bytes());
        let places = (0..Self::SLOTS).map(place);
        let weights = self.rgb_weights.iter().flat_map(|w| {
            let padding = std::iter::repeat_n(0.0, Self::SLOTS - Self::SAMPLES);
            w.iter().copied().chain(padding)
        });
        let rest = self.xyz_from_rgb.iter().flatten().chain(&self.white).copied();
        bytes.extend(places.chain(weights).chain(rest).flat_map(f32::to_le_bytes));
    }

    fn from_bytes(bytes: &[u8]) -> Result<Self, CoefficientTableError> {
        let (slots, numbers) = bytes.split_at(4);
        let found = u32::from_le_bytes(slots.try_into().expect("four bytes"));
        if found as usize != Self::SLOTS {
            return Err(CoefficientTableError::Samples { found });
        }
        let numbers = read_numbers(numbers);
        let (sampled, rest) = numbers.split_at(4 * Self::SLOTS);
        let weights = |k: usize| sampled[k * Self::SLOTS..][..Self::SAMPLES].to_vec();
        let row = |k: usize| [rest[3 * k], rest[3 * k + 1], rest[3 * k + 2]];
        Ok(Self {
            rgb_weights: [weights(1), weights(2), weights(3)],
            xyz_from_rgb: [row(0), row(1), row(2)],
            white: row(3),
        })
    }
}

fn check_resolution(found: usize) -> Result<(), CoefficientTableError> {
    let [least, most] = CoefficientTable::RESOLUTIONS;
    let valid = (least..=most).contains(&found);
    valid.then_some(()).ok_or(CoefficientTableError::Resolution { found })
}

fn check_levels(levels: &[f32]) -> Result<(), CoefficientTableError> {
    let last = levels.len() - 1;
    let holds = |k: usize| match k {
        0 => levels[0] == 0.0,
        k if k == last => levels[k] == 1.0,
        k => levels[k] > levels[k - 1] && levels[k] < 1.0,
    };
    (0..=last).find(|k| !holds(*k)).map_or(Ok(()), |index| {
        Err(CoefficientTableError::Brightness { index, found: levels[index] })
    })
}

fn read_numbers(bytes: &[u8]) -> Vec<f32> {
    bytes.as_chunks().0.iter().map(|four| f32::from_le_bytes(*four)).collect()
}

fn smooth_step(x: f64) -> f64 {
    x * x * (3.0 - 2.0 * x)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every node another straight line; flat 0.5 everywhere else would hide a wrong order.
    fn table(resolution: usize) -> CoefficientTable {
        let nodes =
            (0..3 * resolution.pow(3)).map(|i| [0.0, 1e-4 * to_single(i as f64), -0.5]).collect();
        let levels = CoefficientTable::levels(resolution);
        CoefficientTable::new(levels, nodes).unwrap().with_integrator(&Contract::default())
    }

    /// Linear RGB of a reflectance.
    fn rgb(integrator: &Integrator, reflectance: Sigmoid) -> [f64; 3] {
        let step_nm = Integrator::RANGE_NM / (Integrator::SAMPLES - 1) as f64;
        integrator.rgb_weights.each_ref().map(|weights| {
            let terms = weights.iter().enumerate();
            let at = |i: usize| reflectance.at(Integrator::FIRST_NM + i as f64 * step_nm);
            terms.map(|(i, w)| f64::from(*w) * at(i)).sum()
        })
    }

    #[test]
    fn bytes_come_back() {
        let table = table(4);
        let bytes = table.to_bytes();
        assert_eq!(bytes.len(), 8 + 16 + 36 * 64 + 4660);
        assert_eq!(CoefficientTable::from_bytes(&bytes), Ok(table.clone()));
        let plain = CoefficientTable { integrator: None, ..table };
        assert_eq!(CoefficientTable::from_bytes(&plain.to_bytes()), Ok(plain));
    }

    #[test]
    fn levels_rise_at_every_resolution() {
        let [least, most] = CoefficientTable::RESOLUTIONS;
        for resolution in least..=most {
            assert_eq!(check_levels(&CoefficientTable::levels(resolution)), Ok(()), "{resolution}");
        }
    }

    #[test]
    fn a_node_s_color_finds_the_node() {
        // Rounding of a color to single precision moves it by 6e-8 of a cell or less.
        const ROUNDING: f64 = 1e-4;
        let table = table(5);
        let n = table.resolution();
        for (index, node) in table.nodes().iter().enumerate() {
            let place = [index / n.pow(3), index / (n * n) % n, index / n % n, index % n];
            let [largest, level, next_but_one, next] = place;
            // Ties go to the later channel, and black has one color only.
            if level == 0 || (next == n - 1) || (next_but_one == n - 1) {
                continue;
            }
            let found = table.sigmoid(table.node_rgb(place).0.map(to_single));
            assert!((found.c1 - f64::from(node[1])).abs() < ROUNDING, "{largest} {place:?}");
        }
    }

    #[test]
    fn white_and_gray_integrate_to_themselves() {
        // Single precision of 283 weights.
        const SINGLE: f64 = 1e-6;
        let integrator = Integrator::of(&Contract::default());
        for gray in [0.18, 0.5, 1.0 - 1e-9] {
            for v in rgb(&integrator, Sigmoid::flat(gray)) {
                assert!((v - gray).abs() < SINGLE, "{v} {gray}");
            }
        }
    }

    #[test]
    fn anything_else_is_refused_with_a_reason() {
        let bytes = table(3).to_bytes();
        let message = |bytes: &[u8]| CoefficientTable::from_bytes(bytes).unwrap_err().to_string();
        assert_eq!(
            message(b"PNG"),
            "it begins with \"PNG\", expected \"SPEC\", a table of coefficients"
        );
        assert_eq!(message(b"SPEC\0\0\0\x01"), "resolution 16777216, expected 2 to 128");
        let plain = 8 + 12 + 36 * 27;
        assert_eq!(
            message(&bytes[..plain + 1]),
            format!("993 bytes, expected {plain} at this resolution, or 5652 with its integrator")
        );
        let mut odd = bytes.clone();
        odd[12..16].copy_from_slice(&0.0_f32.to_le_bytes());
        assert_eq!(message(&odd), "brightness level 1 is 0, expected levels that rise from 0 to 1");
        let mut odd = bytes.clone();
        odd[20..24].copy_from_slice(&f32::NAN.to_le_bytes());
        assert_eq!(message(&odd), "coefficient 0 is NaN, expected a finite number");
        let mut odd = bytes;
        odd[plain] = 7;
        assert!(message(&odd).ends_with("samples in the integrator, expected 288"));
        for end in 0..plain {
            assert!(CoefficientTable::from_bytes(&odd[..end]).is_err());
        }
    }
}
