//! Wavelengths drawn from a material, their probabilities and densities.

use upglow::{Bispectral, Draw, Sample};

use crate::failure::UpglowStatus;
use crate::material::{UpglowMaterial, answer, answer_to};

/// How a wavelength was drawn.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UpglowDraw {
    /// Nothing was drawn: the light is absorbed, and the path ends.
    Absorbed = 0,
    /// The wavelength was kept.
    Elastic = 1,
    /// The wavelength was changed.
    Fluorescent = 2,
}

/// A wavelength drawn from a material.
///
/// The elastic part is a Dirac delta: it has a probability and no density. The fluorescent part has
/// a density, which combines with those of other strategies by multiple importance sampling.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UpglowSample {
    /// How it was drawn.
    pub draw: UpglowDraw,
    /// The wavelength drawn, nm; the known one if nothing was drawn.
    pub lambda_nm: f32,
    /// Factor for the path's throughput: the material's value divided by the probability or density
    /// of the draw. It depends on the known wavelength alone, except for
    /// incident wavelengths of films; 0 if nothing was drawn.
    pub throughput: f32,
    /// Probability of keeping the wavelength, 0 to 1; 0 unless it was kept.
    pub probability: f32,
    /// Density of the wavelength drawn, 1/nm; 0 unless it was changed.
    pub pdf_per_nm: f32,
}

impl UpglowSample {
    fn new(known_nm: f32, sample: Option<Sample<f32>>) -> Self {
        let (lambda_nm, throughput) = sample.map_or((known_nm, 0.0), |s| (s.nm, s.throughput));
        let (draw, probability, pdf_per_nm) = match sample.map(|s| s.draw) {
            None => (UpglowDraw::Absorbed, 0.0, 0.0),
            Some(Draw::Elastic { probability }) => (UpglowDraw::Elastic, probability, 0.0),
            Some(Draw::Fluorescent { per_nm }) => (UpglowDraw::Fluorescent, 0.0, per_nm),
        };
        Self { draw, lambda_nm, throughput, probability, pdf_per_nm }
    }
}

/// Draws the wavelength of incident light, given that of the light that leaves, for paths that start
/// at the camera.
///
/// `u` are 2 independent numbers in 0 to 1, 1 excluded; the first chooses between reflection and
/// fluorescence, the second draws the wavelength.
///
/// cbindgen:ptrs-as-arrays=[[u; 2]]
///
/// # Safety
///
/// Pointers are null or point to a material that was looked up, to 2 values and to room for the
/// sample.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn upglow_sample_incident(
    material: *const UpglowMaterial,
    out_nm: f32,
    u: *const f32,
    sample: *mut UpglowSample,
) -> UpglowStatus {
    // SAFETY: the caller keeps this function's promise, which is the same.
    unsafe {
        answer_to(material, (u, "u"), (sample, "sample"), |m, u| {
            UpglowSample::new(out_nm, m.sample_incident(out_nm, u))
        })
    }
}

/// The density, 1/nm, with which `upglow_sample_incident` draws `in_nm` by fluorescence.
///
/// # Safety
///
/// Pointers are null or point to a material that was looked up and to room for the answer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn upglow_incident_pdf(
    material: *const UpglowMaterial,
    in_nm: f32,
    out_nm: f32,
    per_nm: *mut f32,
) -> UpglowStatus {
    // SAFETY: the caller keeps this function's promise, which is the same.
    unsafe { answer(material, (per_nm, "per_nm"), |m| m.incident_pdf_per_nm(in_nm, out_nm)) }
}

/// The probability, 0 to 1, that `upglow_sample_incident` keeps the wavelength.
///
/// # Safety
///
/// Pointers are null or point to a material that was looked up and to room for the answer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn upglow_incident_elastic_probability(
    material: *const UpglowMaterial,
    out_nm: f32,
    probability: *mut f32,
) -> UpglowStatus {
    // SAFETY: the caller keeps this function's promise, which is the same.
    unsafe {
        answer(material, (probability, "probability"), |m| m.incident_elastic_probability(out_nm))
    }
}

/// Draws the wavelength of the light that leaves, given that of incident light, for paths that start
/// at a light.
///
/// `u` are 2 independent numbers in 0 to 1, 1 excluded; the first chooses between reflection and
/// fluorescence, the second draws the wavelength.
///
/// cbindgen:ptrs-as-arrays=[[u; 2]]
///
/// # Safety
///
/// Pointers are null or point to a material that was looked up, to 2 values and to room for the
/// sample.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn upglow_sample_outgoing(
    material: *const UpglowMaterial,
    in_nm: f32,
    u: *const f32,
    sample: *mut UpglowSample,
) -> UpglowStatus {
    // SAFETY: the caller keeps this function's promise, which is the same.
    unsafe {
        answer_to(material, (u, "u"), (sample, "sample"), |m, u| {
            UpglowSample::new(in_nm, m.sample_outgoing(in_nm, u))
        })
    }
}

/// The density, 1/nm, with which `upglow_sample_outgoing` draws `out_nm` by fluorescence.
///
/// # Safety
///
/// Pointers are null or point to a material that was looked up and to room for the answer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn upglow_outgoing_pdf(
    material: *const UpglowMaterial,
    in_nm: f32,
    out_nm: f32,
    per_nm: *mut f32,
) -> UpglowStatus {
    // SAFETY: the caller keeps this function's promise, which is the same.
    unsafe { answer(material, (per_nm, "per_nm"), |m| m.outgoing_pdf_per_nm(in_nm, out_nm)) }
}

/// The probability, 0 to 1, that `upglow_sample_outgoing` keeps the wavelength.
///
/// # Safety
///
/// Pointers are null or point to a material that was looked up and to room for the answer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn upglow_outgoing_elastic_probability(
    material: *const UpglowMaterial,
    in_nm: f32,
    probability: *mut f32,
) -> UpglowStatus {
    // SAFETY: the caller keeps this function's promise, which is the same.
    unsafe {
        answer(material, (probability, "probability"), |m| m.outgoing_elastic_probability(in_nm))
    }
}
