//! The claims of König et al. 2020 as values: the paper's sentence, what was measured, whether it holds, and why.

mod between;
mod dyes;
mod gamut;
mod interpolation;
mod metrics;
mod paths;
mod reradiation;

use std::fmt;

use serde::{Serialize, Serializer};
use upglow_color::Metric;
use upglow_fit::Watch;

use crate::cubes::PAPER_SWEEPS;
use crate::cubes::{Cubes, StudyCube};
use crate::error::StudyError;
use crate::field::Field;

/// A sentence of the paper beside our numbers.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Claim {
    /// A short name in words with hyphens, for tables and tests.
    pub(crate) id: &'static str,
    /// Where the paper says it: section, figure.
    pub(crate) section: &'static str,
    /// What it says, in its words.
    pub(crate) quote: &'static str,
    /// What was measured, and how.
    pub(crate) measure: &'static str,
    /// The numbers.
    pub(crate) numbers: Vec<Number>,
    /// Whether the numbers bear the sentence out.
    pub(crate) verdict: Verdict,
    /// When the verdict is "holds", and the reason where it does not or where the numbers surprise.
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
    /// How many digits behind the point are worth printing.
    #[serde(skip)]
    pub(crate) digits: usize,
    /// The paper's own number, if it has one.
    pub(crate) paper: Option<f64>,
}

/// Whether a claim holds here.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Verdict {
    /// The numbers agree with the sentence.
    Holds,
    /// They do not.
    DoesNotHold,
}

impl Verdict {
    fn holds_if(condition: bool) -> Self {
        if condition { Self::Holds } else { Self::DoesNotHold }
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Holds => "holds",
            Self::DoesNotHold => "does not hold",
        })
    }
}

impl Serialize for Verdict {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_str(self)
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

/// The cubes of the paper's figures, and ours, as fields.
#[derive(Debug)]
pub(crate) struct Fields {
    /// Euclidean RGB, 4 sweeps.
    rgb: Field,
    /// ΔE76, 4 sweeps.
    de76: Field,
    /// ΔE76, 8 sweeps.
    de76_8: Field,
    /// ΔE00, 4 sweeps: the paper's cube.
    de2000: Field,
    /// ΔE00, 4 sweeps, moving features.
    features: Field,
    /// ΔE00, 4 sweeps, fluorescence by formula.
    analytic: Field,
    /// Ours.
    reference: Field,
    /// Ours under ΔE76.
    reference_de76: Field,
}

impl Fields {
    pub(crate) fn of(cubes: &Cubes, watch: &dyn Watch) -> Result<Self, StudyError> {
        let field = |which| cubes.get(which, watch).map(Field::of);
        let paper = |metric, sweeps| StudyCube::Paper { metric, sweeps };
        Ok(Self {
            rgb: field(paper(Metric::Rgb, PAPER_SWEEPS))?,
            de76: field(paper(Metric::De76, PAPER_SWEEPS))?,
            de76_8: field(paper(Metric::De76, 2 * PAPER_SWEEPS))?,
            de2000: field(StudyCube::PAPER)?,
            features: field(StudyCube::PaperFeatures)?,
            analytic: field(StudyCube::PaperAnalytic { sweeps: PAPER_SWEEPS })?,
            reference: field(StudyCube::Reference)?,
            reference_de76: field(StudyCube::Search { metric: Metric::De76 })?,
        })
    }
}

/// Every claim, in the order of the paper's subjects.
pub(crate) fn claims(fields: &Fields) -> Result<Vec<Claim>, StudyError> {
    let mut claims = metrics::claims(fields);
    claims.extend(dyes::claims(fields)?);
    claims.extend(interpolation::claims(fields));
    Ok(claims)
}

/// `part` as a share of `whole`; 0 where there is nothing.
fn share(part: usize, whole: usize) -> f64 {
    if whole == 0 { 0.0 } else { part as f64 / whole as f64 }
}

/// The layer of a grid that is nearest to one of the paper's, numbered 0 to 31.
fn paper_layer(field: &Field, layer: usize) -> usize {
    const PAPER_LAST: usize = 31;
    let last = field.cube().resolution() - 1;
    (layer * last + PAPER_LAST / 2) / PAPER_LAST
}
