//! Dyes whose curves are those of a measured matrix.

use upglow::{Accounting, FilmModel};
use upglow_color::{Diagonal, DonaldsonMatrix, Grid, MeasuredDye, Spectrum};

use super::separation::Emitter;

/// Where the matrix comes from, in the dyes' provenance.
const PROVENANCE: &str = "curves of a measured re-radiation matrix";

/// Less light passes no film.
const LEAST_PASSED: f64 = 1e-6;

/// A yield follows from the bands that excite at least this share of the most: in others, noise decides.
const EXCITED_SHARE: f64 = 0.1;

/// A dye, and the optical density it has in the material.
pub(super) type DyeInFilm = (MeasuredDye, f64);

/// A white material under a film that makes a matrix: the dye that emits, if any, and a dye without emission
/// that absorbs what else is missing in the reflected light.
///
/// The emitting dye has the least quantum yield with which it absorbs no more than is missing.
pub(super) fn film_on_white(
    measured: &DonaldsonMatrix,
    emitter: Option<&Emitter>,
) -> Vec<DyeInFilm> {
    let incident_nm = measured.incident_nm();
    let none = vec![0.0; incident_nm.len()];
    let excitation = emitter.map_or(&none, |emitter| &emitter.excitation);
    let reflected = reflected(measured, emitter);
    let curve = emitter.map(|emitter| Emission::of(emitter, measured));
    let needed = needed(incident_nm, excitation, curve.as_ref());
    // Where nothing is measured of the reflected light, only the emitting dye is known to absorb.
    let missing: Vec<Option<f64>> =
        reflected.iter().map(|found| found.map(|r| 1.0 - r.clamp(LEAST_PASSED, 1.0))).collect();
    let quantum_yield = least_yield(&needed, excitation, &missing);
    let (mut emitting, mut absorbing) = (Vec::new(), Vec::new());
    for (needed, missing) in needed.iter().zip(&missing) {
        let own = if quantum_yield > 0.0 { needed / quantum_yield } else { 0.0 };
        let absorbed = missing.unwrap_or(own).min(1.0 - LEAST_PASSED);
        let density = -(1.0 - absorbed).log10();
        let share = if absorbed > 0.0 { (own / absorbed).min(1.0) } else { 0.0 };
        emitting.push(density * share);
        absorbing.push(density * (1.0 - share));
    }
    let mut dyes = Vec::new();
    if let Some(curve) = curve {
        let absorption = on_fine(incident_nm, &emitting, Beyond::Nothing);
        let name = "measured_emitter";
        dyes.extend(dye(name, absorption, curve.spectrum, quantum_yield));
    }
    let absorption = on_fine(incident_nm, &absorbing, Beyond::Nearest);
    dyes.extend(dye("measured_absorber", absorption, at_the_end(), 0.0));
    dyes
}

/// Emitting dyes over a reflectance that is not yet known, each with this quantum yield or, where that is too
/// little for its excitation, with the least that is enough.
pub(super) fn emitting_dyes(
    measured: &DonaldsonMatrix,
    emitters: &[Emitter],
    quantum_yield: f64,
) -> Vec<DyeInFilm> {
    let incident_nm = measured.incident_nm();
    let mut dyes = Vec::new();
    for (number, emitter) in (1..).zip(emitters) {
        let curve = Emission::of(emitter, measured);
        let needed = needed(incident_nm, &emitter.excitation, Some(&curve));
        let least = needed.iter().copied().fold(0.0, f64::max).min(1.0);
        let quantum_yield = least + (1.0 - least) * quantum_yield;
        let density = |needed: &f64| -(1.0 - needed / quantum_yield).max(LEAST_PASSED).log10();
        let densities: Vec<f64> = needed.iter().map(density).collect();
        let absorption = on_fine(incident_nm, &densities, Beyond::Nothing);
        let name = format!("measured_emitter_{number}");
        dyes.extend(dye(&name, absorption, curve.spectrum, quantum_yield));
    }
    dyes
}

/// The light that is reflected in each incident band, without what is re-emitted in it.
fn reflected(measured: &DonaldsonMatrix, emitter: Option<&Emitter>) -> Vec<Option<f64>> {
    let mut reflected = vec![None; measured.incident_nm().len()];
    for [o, i] in measured.diagonal_bands() {
        let emitted = match (emitter, measured.diagonal()) {
            (Some(Emitter { excitation, emission }), Diagonal::Together) => {
                excitation[i] * emission[o]
            }
            _ => 0.0,
        };
        reflected[i] = Some(measured.factors()[o][i] - emitted);
    }
    reflected
}

/// The emission of a dye on [`Grid::FINE`].
struct Emission {
    spectrum: Spectrum,
    mean_nm: f64,
    /// The area of the curve through the emitter's bands, which is 1 but for bands of different widths.
    area: f64,
}

impl Emission {
    fn of(emitter: &Emitter, measured: &DonaldsonMatrix) -> Self {
        let bands = measured.outgoing_bands_nm();
        let nm = measured.outgoing_nm();
        let last = nm.len() - 1;
        // It ends one band beyond the last wavelength, so that its area is the sum over the bands.
        let ends = [nm[0] - bands[0], nm[last] + bands[last]];
        let places: Vec<f64> =
            [ends[0]].into_iter().chain(nm.iter().copied()).chain([ends[1]]).collect();
        let densities = emitter.emission.iter().zip(&bands).map(|(e, width)| e / width);
        let densities: Vec<f64> = [0.0].into_iter().chain(densities).chain([0.0]).collect();
        let spectrum = on_fine(&places, &densities, Beyond::Nothing);
        let area = spectrum.integral();
        let samples = spectrum.grid().wavelengths_nm().zip(spectrum.values());
        let moment: f64 = samples.map(|(nm, e)| nm * e).sum();
        Self { mean_nm: moment / area.max(f64::MIN_POSITIVE), spectrum, area }
    }
}

/// The share of each incident band that a dye with a quantum yield of 1 must absorb.
fn needed(incident_nm: &[f64], excitation: &[f64], curve: Option<&Emission>) -> Vec<f64> {
    let Some(Emission { mean_nm, area, .. }) = curve else { return vec![0.0; excitation.len()] };
    let share = |nm: &f64| Accounting::Photon.share(*nm, *mean_nm);
    incident_nm.iter().zip(excitation).map(|(nm, y)| y * area / share(nm)).collect()
}

/// The least yield with which a dye absorbs no more than is missing, where it is excited.
fn least_yield(needed: &[f64], excitation: &[f64], missing: &[Option<f64>]) -> f64 {
    let most = excitation.iter().copied().fold(0.0, f64::max);
    let excited = excitation.iter().map(|y| *y > EXCITED_SHARE * most);
    let of = |((needed, missing), is_excited): ((&f64, &Option<f64>), bool)| {
        let absorbed = missing.unwrap_or(1.0 - LEAST_PASSED).max(LEAST_PASSED);
        if is_excited { needed / absorbed } else { 0.0 }
    };
    needed.iter().zip(missing).zip(excited).map(of).fold(0.0, f64::max).min(1.0)
}

/// What a curve is beyond its samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Beyond {
    Nothing,
    Nearest,
}

/// The curve through samples at ascending wavelengths, on [`Grid::FINE`].
fn on_fine(nm: &[f64], values: &[f64], beyond: Beyond) -> Spectrum {
    let last = nm.len() - 1;
    let at = |place: f64| {
        if !(nm[0]..=nm[last]).contains(&place) && beyond == Beyond::Nothing {
            return 0.0;
        }
        let above = nm.partition_point(|at| *at < place).clamp(1, last);
        let fraction = (place - nm[above - 1]) / (nm[above] - nm[above - 1]);
        values[above - 1] + (values[above] - values[above - 1]) * fraction.clamp(0.0, 1.0)
    };
    let values = Grid::FINE.wavelengths_nm().map(at).collect();
    Spectrum::new(Grid::FINE, values).expect("means of finite numbers")
}

/// An emission that is of no color, for a dye that emits nothing: every dye has one.
fn at_the_end() -> Spectrum {
    let last_nm = f64::from(Grid::FINE.last_nm());
    on_fine(&[last_nm - 1.0, last_nm], &[0.0, 1.0], Beyond::Nothing)
}

/// The dye with these optical densities, if it absorbs anything.
fn dye(
    name: &str,
    densities: Spectrum,
    emission: Spectrum,
    quantum_yield: f64,
) -> Option<DyeInFilm> {
    let density = densities.peak();
    if density.is_nan() || density <= 0.0 {
        return None;
    }
    let density = density.min(FilmModel::DENSITIES[1]);
    let dye = MeasuredDye {
        name: name.into(),
        absorption: densities.scaled(density.recip()),
        emission,
        quantum_yield: Some(quantum_yield),
        provenance: PROVENANCE.into(),
    };
    Some((dye, density))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_are_linear_between_samples() {
        let curve = |beyond| on_fine(&[400.0, 410.0], &[1.0, 2.0], beyond);
        let at = |nm| [Beyond::Nothing, Beyond::Nearest].map(|beyond| curve(beyond).at(nm));
        assert_eq!([at(399.0), at(405.0), at(411.0)], [[0.0, 1.0], [1.5; 2], [0.0, 2.0]]);
    }
}
