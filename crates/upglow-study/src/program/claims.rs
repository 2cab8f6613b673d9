//! The claims of König et al. 2020, each as a value: what the paper says, the measured numbers, the
//! verdict and its reason.
//!
//! What is true by construction of the model, whatever is measured, is no claim here: `tests/definitions.rs`
//! checks it, and the report lists it apart.

mod between;
mod dyes;
mod gamut;
mod interpolation;
mod layer_at_flips;
mod metrics;
mod paths;
mod realism;

use std::fmt;

use serde::Serialize;
use upglow_color::{Metric, choices};
use upglow_fit::{BuildError, Watch};
use upglow_study::konig2020;

use crate::cubes::{Cubes, StudyCube};
use crate::field::Field;
use crate::samples::Sample;

/// A statement of the paper and what we measured.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Claim {
    /// A short name of words and hyphens.
    pub(crate) id: &'static str,
    /// Section and figure of the paper.
    pub(crate) section: &'static str,
    /// What the paper says, in our words.
    pub(crate) statement: &'static str,
    /// What was measured, and how.
    pub(crate) measure: &'static str,
    /// The numbers.
    pub(crate) numbers: Vec<Number>,
    /// Whether the numbers confirm the statement.
    pub(crate) verdict: Verdict,
    /// The rule of the verdict, and the reason where the claim does not hold, cannot be judged or the
    /// numbers surprise.
    pub(crate) why: &'static str,
}

/// One number of a claim.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct Number {
    /// What it is.
    pub(crate) name: &'static str,
    /// The number.
    pub(crate) value: f64,
    /// Its unit; empty for a plain number.
    pub(crate) unit: &'static str,
    /// Decimals to print.
    #[serde(skip)]
    pub(crate) digits: usize,
    /// The paper's own number, if it has one.
    pub(crate) paper: Option<f64>,
}

/// Whether the numbers confirm a claim.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Verdict {
    Holds,
    DoesNotHold,
    /// The answer depends on something that the paper does not say.
    CannotBeJudged,
}

choices!(
    Verdict,
    "verdict",
    Holds = "holds",
    DoesNotHold = "does not hold",
    CannotBeJudged = "cannot be judged",
);

impl Verdict {
    fn holds_if(condition: bool) -> Self {
        if condition { Self::Holds } else { Self::DoesNotHold }
    }

    /// The verdict where the paper leaves open how to measure, from one answer per possibility: it
    /// cannot be judged if they differ.
    pub(crate) fn if_agreed(answers: &[bool]) -> Self {
        if answers.windows(2).all(|two| two[0] == two[1]) {
            Self::holds_if(answers.first() == Some(&true))
        } else {
            Self::CannotBeJudged
        }
    }
}

impl Number {
    fn new(name: &'static str, value: f64, unit: &'static str, digits: usize) -> Self {
        Self { name, value, unit, digits, paper: None }
    }

    fn count(name: &'static str, value: usize) -> Self {
        Self::new(name, value as f64, "", 0)
    }

    fn percent(name: &'static str, share: f64) -> Self {
        Self::new(name, 100.0 * share, "%", 1)
    }

    fn de2000(name: &'static str, value: f64) -> Self {
        Self::new(name, value, "ΔE00", 3)
    }

    fn beside(self, paper: f64) -> Self {
        Self { paper: Some(paper), ..self }
    }
}

impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, value, unit, digits, paper } = self;
        write!(f, "{name}: {value:.digits$}")?;
        if !unit.is_empty() {
            write!(f, " {unit}")?;
        }
        match paper {
            Some(paper) => write!(f, " (paper {paper})"),
            None => Ok(()),
        }
    }
}

/// Full widths at half maximum that analytic absorption and emission may have had, nm, and their names:
/// neither the paper nor Jung et al. say.
const ANALYTIC_WIDTHS: [([u32; 2], &str); 9] = [
    ([30, 30], "30 / 30 nm"),
    ([30, 50], "30 / 50 nm"),
    ([30, 80], "30 / 80 nm"),
    ([50, 30], "50 / 30 nm"),
    ([50, 50], "50 / 50 nm"),
    ([50, 80], "50 / 80 nm"),
    ([80, 30], "80 / 30 nm"),
    ([80, 50], "80 / 50 nm"),
    ([80, 80], "80 / 80 nm"),
];

/// The cubes of the paper's figures, and our own.
#[derive(Debug)]
struct Fields {
    /// Euclidean RGB, 4 sweeps.
    rgb: Field,
    /// Euclidean RGB, 32 sweeps.
    rgb_32: Field,
    /// ΔE76, 4 sweeps.
    de76: Field,
    /// ΔE76, 8 sweeps.
    de76_8: Field,
    /// ΔE00, 4 sweeps: the paper's cube.
    de2000: Field,
    /// ΔE00, 4 sweeps, features as the variables.
    features: Field,
    /// ΔE00, 4 sweeps, analytic fluorescence of our widths.
    analytic: Field,
    /// The same with each of [`ANALYTIC_WIDTHS`].
    analytic_by_width: Vec<Field>,
    /// Our own search.
    reference: Field,
    /// Our own search under ΔE76.
    reference_de76: Field,
}

impl Fields {
    fn of(cubes: &Cubes, watch: &dyn Watch) -> Result<Self, BuildError> {
        let field = |which| cubes.get(which, watch).map(Field::of);
        let paper = |metric, sweeps| StudyCube::Paper { metric, sweeps };
        Ok(Self {
            rgb: field(paper(Metric::Rgb, konig2020::SWEEPS))?,
            rgb_32: field(paper(Metric::Rgb, 32))?,
            de76: field(paper(Metric::De76, konig2020::SWEEPS))?,
            de76_8: field(paper(Metric::De76, 2 * konig2020::SWEEPS))?,
            de2000: field(StudyCube::PAPER)?,
            features: field(StudyCube::PaperFeatures)?,
            analytic: field(StudyCube::PAPER_ANALYTIC)?,
            analytic_by_width: ANALYTIC_WIDTHS
                .iter()
                .map(|&(fwhm_nm, _)| field(StudyCube::PaperAnalytic { fwhm_nm }))
                .collect::<Result<_, _>>()?,
            reference: field(StudyCube::REFERENCE)?,
            reference_de76: field(StudyCube::Search { metric: Metric::De76 })?,
        })
    }
}

/// Measures every claim of the paper, in the order of the paper's subjects.
///
/// Builds the cubes that this takes, as far as `cubes` lacks them. `measured` are fluorescent materials
/// whose realism is compared; without any that claim cannot be judged. The numbers are the same on
/// every run.
///
/// # Errors
///
/// [`BuildError`] if the resolution is out of range or `watch` stopped the work.
pub(crate) fn claims(
    cubes: &Cubes,
    measured: &[Sample],
    watch: &dyn Watch,
) -> Result<Vec<Claim>, BuildError> {
    let fields = Fields::of(cubes, watch)?;
    let mut claims = metrics::claims(&fields);
    claims.extend(dyes::claims(&fields));
    claims.push(realism::claim(measured));
    claims.extend(interpolation::claims(&fields));
    claims.extend(layer_at_flips::claims(&fields));
    Ok(claims)
}

/// `part` as a share of `whole`; 0 if `whole` is 0.
fn share(part: usize, whole: usize) -> f64 {
    if whole == 0 { 0.0 } else { part as f64 / whole as f64 }
}

/// The layer of a cube that is nearest to this layer of the paper's cube, 0 to 31.
fn paper_layer(field: &Field, layer: usize) -> usize {
    const PAPER_LAST: usize = 31;
    let last = field.cube().resolution() - 1;
    (layer * last + PAPER_LAST / 2) / PAPER_LAST
}
