//! Evaluation of materials at wavelengths that differ per material: re-radiation, draws and their
//! densities.

use numpy::PyReadonlyArray2;
use pyo3::prelude::*;
use upglow::{Bispectral, Draw, Sample};
use upglow_color::choices;

use crate::arrays::{Number, check_count};
use crate::cube::Cube;
use crate::rows::{Subjects, answers, with_rows};
use crate::threads::Threads;
use crate::word::Word;

/// What is evaluated, at one or two wavelengths (nm) and, for draws, with two random numbers.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Question {
    /// Given the incident and the outgoing wavelength.
    Reradiation,
    /// Given the incident and the outgoing wavelength.
    IncidentPdf,
    /// Given the incident and the outgoing wavelength.
    OutgoingPdf,
    /// Given the outgoing wavelength.
    IncidentElastic,
    /// Given the incident wavelength.
    OutgoingElastic,
    /// Given the outgoing wavelength and two random numbers.
    SampleIncident,
    /// Given the incident wavelength and two random numbers.
    SampleOutgoing,
}

choices!(
    Question,
    "question",
    Reradiation = "reradiation_per_nm",
    IncidentPdf = "incident_pdf_per_nm",
    OutgoingPdf = "outgoing_pdf_per_nm",
    IncidentElastic = "incident_elastic_probability",
    OutgoingElastic = "outgoing_elastic_probability",
    SampleIncident = "sample_incident",
    SampleOutgoing = "sample_outgoing",
);

impl Question {
    /// How many numbers each material is given, and how many its answer has.
    fn counts(self) -> [usize; 2] {
        match self {
            Self::Reradiation | Self::IncidentPdf | Self::OutgoingPdf => [2, 1],
            Self::IncidentElastic | Self::OutgoingElastic => [1, 1],
            Self::SampleIncident | Self::SampleOutgoing => [3, 4],
        }
    }

    /// Writes a material's answer for the numbers `given`.
    fn answer<M: Bispectral<Real: Number>>(self, of: &M, given: &[f64], out: &mut [M::Real]) {
        let at = |number: usize| M::Real::from_double(given[number]);
        match self {
            Self::Reradiation => out[0] = of.reradiation_per_nm(at(0), at(1)),
            Self::IncidentPdf => out[0] = of.incident_pdf_per_nm(at(0), at(1)),
            Self::OutgoingPdf => out[0] = of.outgoing_pdf_per_nm(at(0), at(1)),
            Self::IncidentElastic => out[0] = of.incident_elastic_probability(at(0)),
            Self::OutgoingElastic => out[0] = of.outgoing_elastic_probability(at(0)),
            Self::SampleIncident => fill(out, of.sample_incident(at(0), [at(1), at(2)])),
            Self::SampleOutgoing => fill(out, of.sample_outgoing(at(0), [at(1), at(2)])),
        }
    }
}

/// Writes wavelength (nm), throughput, probability or density (1/nm), and 1 if the wavelength was
/// kept, else 0; NaN and zeros for absorption.
fn fill<T: Number>(out: &mut [T], sample: Option<Sample<T>>) {
    let [zero, one] = [0.0, 1.0].map(T::from_double);
    out.copy_from_slice(&match sample {
        None => [T::NAN, zero, zero, zero],
        Some(Sample { nm, throughput, draw: Draw::Elastic { probability } }) => {
            [nm, throughput, probability, one]
        }
        Some(Sample { nm, throughput, draw: Draw::Fluorescent { per_nm } }) => {
            [nm, throughput, per_nm, zero]
        }
    });
}

/// Each material's answer for its own numbers: `given` is `[color][number]`, the result `[color][1]`,
/// and `[color][4]` for draws.
#[pyfunction]
pub(crate) fn answer<'py>(
    py: Python<'py>,
    cube: &Cube,
    of: Subjects<'py>,
    question: Word<Question>,
    given: PyReadonlyArray2<'py, f64>,
    threads: Threads,
) -> PyResult<Bound<'py, PyAny>> {
    let Word(question) = question;
    let [taken, made] = question.counts();
    let given = given.as_slice()?;
    with_rows!(cube, of, rows => {
        check_count("numbers", given.len(), taken * rows.count)?;
        answers(py, &rows, made, threads, |row, material, out| {
            question.answer(material, &given[row * taken..][..taken], out);
        })
    })
}
