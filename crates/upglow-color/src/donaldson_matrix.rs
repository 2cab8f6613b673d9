//! Measured re-radiation (Donaldson) matrices.

use crate::choices;
use crate::contract::{Contract, ContractError};
use crate::illuminant::{Illuminant, MissingUltraviolet};
use crate::observer::Observer;
use crate::rounding::shown;
use crate::values::Xyz;

mod bfc;
mod csv;
mod sums;

pub use bfc::BfcError;
pub use csv::MatrixCsvError;
pub use sums::MatrixSums;

/// A measured re-radiation matrix: which share of the power that arrives in one band leaves in another.
///
/// A band reaches to the middle between neighboring wavelengths; one at an end of an axis is as wide on its
/// outer side as on its inner. Values are stored per band. Below the diagonal, where light would leave at
/// a shorter wavelength than it arrived, a measurement holds only noise. It stays, because sums without
/// its negative half would be too bright; [`DonaldsonMatrix::noise`] is its size.
///
/// # Source
///
/// `astm_e2152`: bispectral radiance factors and their sums with a light.
///
/// # Examples
///
/// ```
/// use upglow_color::{BispectralUnit, DonaldsonMatrix, Illuminant, Observer};
///
/// let nm: Vec<f64> = (30..=78).map(|tens| f64::from(10 * tens)).collect();
/// let half = |o: usize, i: usize| if o == i { 0.5 } else { 0.0 };
/// let rows = (0..49).map(|o| (0..49).map(|i| half(o, i)).collect()).collect();
/// let gray = DonaldsonMatrix::try_new(nm.clone(), nm, rows, BispectralUnit::PerBand)?;
/// let color = gray.color(&Illuminant::default(), &Observer::default())?;
/// assert!((color.0[1] - 0.5).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
#[must_use]
pub struct DonaldsonMatrix {
    incident_nm: Vec<f64>,
    outgoing_nm: Vec<f64>,
    /// `[outgoing][incident]`, per band.
    factors: Vec<Vec<f64>>,
    unit: BispectralUnit,
    diagonal: Diagonal,
}

/// The unit of a re-radiation matrix.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BispectralUnit {
    /// Share of the incident power that leaves within the band of the outgoing wavelength.
    PerBand,
    /// Share of the incident power that leaves per nanometer at the outgoing wavelength.
    PerNm,
}

choices!(BispectralUnit, "unit of re-radiation", PerBand = "per band", PerNm = "per nm",);

/// What a matrix holds where light leaves in the band in which it arrived.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Diagonal {
    /// Reflected light together with what is re-emitted within the band, as a double monochromator
    /// measures it.
    Together,
    /// Reflected light alone.
    Reflected,
}

choices!(Diagonal, "diagonal", Together = "together", Reflected = "reflected");

/// Why numbers are no matrix.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum DonaldsonError {
    /// Too few or too many wavelengths.
    #[error("{found} {axis} wavelengths, expected {} to {}", AXIS_LENGTHS[0], AXIS_LENGTHS[1])]
    AxisLength {
        /// `incident` or `outgoing`.
        axis: &'static str,
        /// Wavelengths given.
        found: usize,
    },
    /// A wavelength is out of range or not above the one before it.
    #[error("{axis} wavelength {} nm, expected ascending numbers from {} to {} nm", shown(*found), AXIS_RANGE_NM[0], AXIS_RANGE_NM[1])]
    Wavelength {
        /// `incident` or `outgoing`.
        axis: &'static str,
        /// The wavelength given, nm.
        found: f64,
    },
    /// The light that leaves was not measured in all of the visible range.
    #[error("outgoing wavelengths {first_nm} to {last_nm} nm, expected at least {} to {} nm", VISIBLE_NM[0], VISIBLE_NM[1])]
    Range {
        /// First outgoing wavelength, nm.
        first_nm: f64,
        /// Last outgoing wavelength, nm.
        last_nm: f64,
    },
    /// Rows and axes differ in number.
    #[error("{found} values for {expected} {axis} wavelengths, expected one for each")]
    Shape {
        /// `incident` or `outgoing`.
        axis: &'static str,
        /// Values given.
        found: usize,
        /// Wavelengths given.
        expected: usize,
    },
    /// A value is no possible share.
    #[error(
        "{} from {incident_nm} to {outgoing_nm} nm, expected a share of -{MOST} to {MOST} per band",
        shown(*found)
    )]
    Value {
        /// Where the light arrives, nm.
        incident_nm: f64,
        /// Where it leaves, nm.
        outgoing_nm: f64,
        /// The share, per band.
        found: f64,
    },
    /// A reflectance was given where the matrix has no diagonal.
    #[error("a reflectance at {found} nm, expected one only at wavelengths that are on both axes")]
    OffDiagonal {
        /// Its wavelength, nm.
        found: f64,
    },
}

/// No material gives back ten times the light that arrives in a band; more is a damaged file.
const MOST: f64 = 10.0;

/// Smallest and greatest number of wavelengths of an axis.
const AXIS_LENGTHS: [usize; 2] = [2, DonaldsonMatrix::MOST_WAVELENGTHS];

/// Range of wavelengths, nm: beyond it, numbers are probably in another unit.
const AXIS_RANGE_NM: [f64; 2] = [100.0, 3000.0];

/// What outgoing wavelengths must cover, nm: beyond it, an observer sees less than a hundredth of the peak.
const VISIBLE_NM: [f64; 2] = [400.0, 700.0];

/// Light that leaves this many bands below the band where it arrived is noise; nearer, the slits of the
/// instrument pass some of the reflected light.
const NOISE_BANDS: f64 = 1.5;

impl DonaldsonMatrix {
    /// Most wavelengths of an axis: every nanometer of the range of measurement.
    pub const MOST_WAVELENGTHS: usize = 1001;

    /// A matrix from its values `[outgoing][incident]` at ascending wavelengths, nm. Where light leaves in
    /// the band in which it arrived, they hold reflected and re-emitted light together.
    ///
    /// # Errors
    ///
    /// [`DonaldsonError`] says which wavelength or value is invalid.
    pub fn try_new(
        incident_nm: Vec<f64>,
        outgoing_nm: Vec<f64>,
        mut values: Vec<Vec<f64>>,
        unit: BispectralUnit,
    ) -> Result<Self, DonaldsonError> {
        check_axis("incident", &incident_nm)?;
        check_axis("outgoing", &outgoing_nm)?;
        let [first_nm, last_nm] = [outgoing_nm[0], outgoing_nm[outgoing_nm.len() - 1]];
        if first_nm > VISIBLE_NM[0] || last_nm < VISIBLE_NM[1] {
            return Err(DonaldsonError::Range { first_nm, last_nm });
        }
        check_length("outgoing", values.len(), outgoing_nm.len())?;
        values.iter().try_for_each(|row| check_length("incident", row.len(), incident_nm.len()))?;
        if unit == BispectralUnit::PerNm {
            for (row, width_nm) in values.iter_mut().zip(bands_nm(&outgoing_nm)) {
                row.iter_mut().for_each(|value| *value *= width_nm);
            }
        }
        for (row, &outgoing_nm) in values.iter().zip(&outgoing_nm) {
            for (&found, &incident_nm) in row.iter().zip(&incident_nm) {
                if !(-MOST..=MOST).contains(&found) {
                    return Err(DonaldsonError::Value { incident_nm, outgoing_nm, found });
                }
            }
        }
        let diagonal = Diagonal::Together;
        Ok(Self { incident_nm, outgoing_nm, factors: values, unit, diagonal })
    }

    /// The matrix with this reflectance on its diagonal, in place of what was there: wavelengths (nm) that
    /// are on both axes, and the share of light that is reflected there without a change of wavelength.
    ///
    /// # Errors
    ///
    /// [`DonaldsonError`] if a wavelength is not on both axes, or a reflectance out of range.
    pub fn with_reflectance(mut self, reflectance: &[(f64, f64)]) -> Result<Self, DonaldsonError> {
        for &(nm, found) in reflectance {
            let [o, i] = [&self.outgoing_nm, &self.incident_nm].map(|axis| index_of(axis, nm));
            let (Some(o), Some(i)) = (o, i) else {
                return Err(DonaldsonError::OffDiagonal { found: nm });
            };
            if !(-MOST..=MOST).contains(&found) {
                let [incident_nm, outgoing_nm] = [nm; 2];
                return Err(DonaldsonError::Value { incident_nm, outgoing_nm, found });
            }
            self.factors[o][i] = found;
        }
        self.diagonal = Diagonal::Reflected;
        Ok(self)
    }

    /// Another matrix on the same axes, from the share of each outgoing and incident band, by their indices.
    ///
    /// # Panics
    ///
    /// If a share is not finite.
    pub fn with_factors(&self, factor: impl Fn(usize, usize) -> f64) -> Self {
        let row = |o| (0..self.incident_nm.len()).map(|i| factor(o, i)).collect::<Vec<f64>>();
        let factors: Vec<Vec<f64>> = (0..self.outgoing_nm.len()).map(row).collect();
        assert!(factors.iter().flatten().all(|v| v.is_finite()), "expected finite shares");
        Self { factors, ..self.clone() }
    }

    /// The matrix with zeros where a measurement holds only noise, below the diagonal.
    pub fn without_noise(&self) -> Self {
        let bands = Bands::of(self);
        self.with_factors(|o, i| if bands.is_noise(o, i) { 0.0 } else { self.factors[o][i] })
    }

    /// Where light arrives, nm; ascending.
    pub fn incident_nm(&self) -> &[f64] {
        &self.incident_nm
    }

    /// Where light leaves, nm; ascending.
    pub fn outgoing_nm(&self) -> &[f64] {
        &self.outgoing_nm
    }

    /// The share of the power that arrives in a band that leaves in another, `[outgoing][incident]`.
    pub fn factors(&self) -> &[Vec<f64>] {
        &self.factors
    }

    /// The unit in which the values were given.
    pub fn unit(&self) -> BispectralUnit {
        self.unit
    }

    /// What the diagonal holds.
    pub fn diagonal(&self) -> Diagonal {
        self.diagonal
    }

    /// Widths of the outgoing bands, nm.
    pub fn outgoing_bands_nm(&self) -> Vec<f64> {
        bands_nm(&self.outgoing_nm)
    }

    /// The indices of the outgoing and the incident band of each wavelength that is on both axes.
    pub fn diagonal_bands(&self) -> impl Iterator<Item = [usize; 2]> + '_ {
        let outgoing = self.outgoing_nm.iter().enumerate();
        outgoing.filter_map(|(o, &nm)| Some([o, index_of(&self.incident_nm, nm)?]))
    }

    /// The root of the mean square below the diagonal, where a measurement holds only noise, and the
    /// greatest size there, both per band; `None` if nothing was measured there.
    pub fn noise(&self) -> Option<[f64; 2]> {
        let bands = Bands::of(self);
        let mut found = Vec::new();
        for (o, row) in self.factors.iter().enumerate() {
            let below = row.iter().enumerate().filter(|(i, _)| bands.is_noise(o, *i));
            found.extend(below.map(|(_, value)| *value));
        }
        let mean_square = found.iter().map(|v| v * v).sum::<f64>() / found.len() as f64;
        let greatest = found.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
        (!found.is_empty()).then_some([mean_square.sqrt(), greatest])
    }

    /// What is to say about this matrix under a light: ultraviolet that is not known, where light arrives that the
    /// matrix moves to other wavelengths.
    pub fn missing_ultraviolet(&self, light: &Illuminant) -> Option<MissingUltraviolet> {
        light.missing_ultraviolet().filter(|missing| {
            let short = self.incident_nm.iter().take_while(|nm| **nm < f64::from(missing.from_nm));
            let mut short = short.enumerate();
            short.any(|(i, in_nm)| {
                let mut leaving = self.outgoing_nm.iter().zip(&self.factors);
                leaving.any(|(out_nm, row)| out_nm > in_nm && row[i] > 0.0)
            })
        })
    }

    /// The color under a light, where the perfect diffuser has Y = 1.
    ///
    /// # Errors
    ///
    /// [`ContractError`] if the observer sees nothing of the light.
    pub fn color(&self, light: &Illuminant, observer: &Observer) -> Result<Xyz, ContractError> {
        Ok(MatrixSums::new(self, light, observer)?.color(self))
    }

    /// The sums of this matrix under another light of as much power as the contract's; see
    /// [`Contract::seen_under`].
    ///
    /// # Errors
    ///
    /// [`ContractError`] if the observer sees nothing of the contract's own light.
    pub fn seen_under(
        &self,
        contract: &Contract,
        light: &Illuminant,
    ) -> Result<MatrixSums, ContractError> {
        MatrixSums::seen_under(self, contract, light)
    }

    /// What leaves in each outgoing band where this power arrives in each incident one.
    #[must_use]
    pub fn leaving(&self, arriving: &[f64]) -> Vec<f64> {
        let of = |row: &Vec<f64>| row.iter().zip(arriving).map(|(factor, e)| factor * e).sum();
        self.factors.iter().map(of).collect()
    }
}

/// The axes of a matrix with the widths of their bands.
struct Bands<'m> {
    matrix: &'m DonaldsonMatrix,
    incident: Vec<f64>,
    outgoing: Vec<f64>,
}

impl<'m> Bands<'m> {
    fn of(matrix: &'m DonaldsonMatrix) -> Self {
        let [incident, outgoing] =
            [&matrix.incident_nm, &matrix.outgoing_nm].map(|nm| bands_nm(nm));
        Self { matrix, incident, outgoing }
    }

    /// Whether light that arrived in a band can only by noise leave in another.
    fn is_noise(&self, outgoing: usize, incident: usize) -> bool {
        let band_nm = self.outgoing[outgoing].max(self.incident[incident]);
        let (out_nm, in_nm) =
            (self.matrix.outgoing_nm[outgoing], self.matrix.incident_nm[incident]);
        out_nm < in_nm - NOISE_BANDS * band_nm
    }
}

/// The index of a wavelength in an axis.
fn index_of(axis: &[f64], nm: f64) -> Option<usize> {
    axis.binary_search_by(|found| found.total_cmp(&nm)).ok()
}

fn check_length(axis: &'static str, found: usize, expected: usize) -> Result<(), DonaldsonError> {
    if found == expected { Ok(()) } else { Err(DonaldsonError::Shape { axis, found, expected }) }
}

fn check_axis(axis: &'static str, nm: &[f64]) -> Result<(), DonaldsonError> {
    let [least, most] = AXIS_LENGTHS;
    if !(least..=most).contains(&nm.len()) {
        return Err(DonaldsonError::AxisLength { axis, found: nm.len() });
    }
    let [first_nm, last_nm] = AXIS_RANGE_NM;
    let mut before = f64::NEG_INFINITY;
    for &found in nm {
        if !(found > before && (first_nm..=last_nm).contains(&found)) {
            return Err(DonaldsonError::Wavelength { axis, found });
        }
        before = found;
    }
    Ok(())
}

/// The width of the band around each of at least two wavelengths.
pub(crate) fn bands_nm(axis: &[f64]) -> Vec<f64> {
    let last = axis.len() - 1;
    let step = |k: usize| axis[k + 1] - axis[k];
    (0..=last)
        .map(|k| match k {
            0 => step(0),
            k if k == last => step(k - 1),
            k => (step(k - 1) + step(k)) / 2.0,
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tens(first: u32, last: u32) -> Vec<f64> {
        (first / 10..=last / 10).map(|k| f64::from(10 * k)).collect()
    }

    fn matrix(factor: impl Fn(f64, f64) -> f64) -> DonaldsonMatrix {
        let (incident, outgoing) = (tens(300, 780), tens(380, 780));
        let row = |o: &f64| incident.iter().map(|&i| factor(*o, i)).collect();
        let rows = outgoing.iter().map(row).collect();
        DonaldsonMatrix::try_new(incident, outgoing, rows, BispectralUnit::PerBand).unwrap()
    }

    #[test]
    fn a_density_is_stored_per_band() {
        let axis = vec![390.0, 400.0, 500.0, 700.0];
        let rows = vec![vec![1e-3; 4]; 4];
        let per_nm = DonaldsonMatrix::try_new(axis.clone(), axis, rows, BispectralUnit::PerNm);
        let first: Vec<f64> = per_nm.unwrap().factors().iter().map(|row| row[0]).collect();
        let expected = [0.01, 0.055, 0.15, 0.2];
        // Rounding only.
        assert!(first.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-15), "{first:?}");
    }

    #[test]
    fn noise_is_what_leaves_more_than_a_band_below_where_it_arrived() {
        let found = matrix(|o, i| if o < i { -0.002 } else { 0.5 });
        let [typical, greatest] = found.noise().unwrap();
        assert!((typical - 0.002).abs() < 1e-15 && (greatest - 0.002).abs() < 1e-15);
        let found = matrix(|o, i| if o <= i - 20.0 { 0.0 } else { 0.5 });
        assert_eq!(found.noise(), Some([0.0; 2]));
        assert_eq!(found.without_noise(), found);
        let blue = DonaldsonMatrix::try_new(
            tens(300, 400),
            tens(390, 700),
            vec![vec![0.1; 11]; 32],
            BispectralUnit::PerBand,
        );
        assert_eq!(blue.unwrap().noise(), None);
    }

    #[test]
    fn ultraviolet_is_missing_where_the_matrix_moves_light_of_it() {
        let missing = |from_nm: f64, light: &str| {
            let light = Illuminant::named(light).unwrap();
            let moves = matrix(|o, i| if o == i { 0.5 } else { f64::from(i == from_nm && o > i) });
            moves.missing_ultraviolet(&light).map(|missing| missing.from_nm)
        };
        assert_eq!(missing(370.0, "FL2"), Some(380));
        assert_eq!(missing(300.0, "FL2"), Some(380));
        assert_eq!(missing(380.0, "FL2"), None);
        assert_eq!(missing(370.0, "D65"), None);
    }

    #[test]
    fn reflected_light_apart_replaces_the_diagonal() {
        let found = matrix(|o, i| if o == i { 0.9 } else { 0.01 });
        let apart = found.clone().with_reflectance(&[(380.0, 0.3), (780.0, 0.4)]).unwrap();
        assert_eq!((apart.factors()[0][8], apart.factors()[40][48]), (0.3, 0.4));
        assert_eq!((apart.diagonal(), apart.factors()[1][9]), (Diagonal::Reflected, 0.9));
        let refused = found.with_reflectance(&[(300.0, 0.3)]).unwrap_err().to_string();
        let expected =
            "a reflectance at 300 nm, expected one only at wavelengths that are on both axes";
        assert_eq!(refused, expected);
    }

    #[test]
    fn errors_name_what_is_wrong() {
        let refused = |incident: Vec<f64>, outgoing: Vec<f64>, value: f64| {
            let rows = vec![vec![value; incident.len()]; outgoing.len()];
            let unit = BispectralUnit::PerBand;
            DonaldsonMatrix::try_new(incident, outgoing, rows, unit).unwrap_err().to_string()
        };
        let visible = || tens(400, 700);
        assert_eq!(
            refused(vec![500.0, 400.0], visible(), 0.0),
            "incident wavelength 400 nm, expected ascending numbers from 100 to 3000 nm"
        );
        assert_eq!(
            refused(visible(), vec![0.4, 0.7], 0.0),
            "outgoing wavelength 0.4 nm, expected ascending numbers from 100 to 3000 nm"
        );
        assert_eq!(
            refused(visible(), tens(420, 700), 0.0),
            "outgoing wavelengths 420 to 700 nm, expected at least 400 to 700 nm"
        );
        assert_eq!(
            refused(vec![400.0], visible(), 0.0),
            "1 incident wavelengths, expected 2 to 1001"
        );
        assert_eq!(
            refused(visible(), visible(), f64::NAN),
            "NaN from 400 to 400 nm, expected a share of -10 to 10 per band"
        );
        let rows = vec![vec![0.0; 31]; 30];
        let short = DonaldsonMatrix::try_new(visible(), visible(), rows, BispectralUnit::PerNm);
        assert_eq!(
            short.unwrap_err().to_string(),
            "30 values for 31 outgoing wavelengths, expected one for each"
        );
    }
}
