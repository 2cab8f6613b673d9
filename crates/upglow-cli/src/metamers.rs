//! The materials that a color may have: options, searches and what reports say of them.

use serde::Serialize;
use upglow_color::{
    Colorimetry, Contract, Grid, Illuminant, LinearRgb, Xyz, ciede2000, lab_from_xyz,
};
use upglow_fit::{Fitter, MetamerError, MetamerSearch, Metamers, OwnMaterial, PaintKind};
use upglow_terminal::Failure;

use crate::args::{AnswerName, LightArgs, PaintArgs};
use crate::plan;

impl PaintArgs {
    /// Checks that an answer is chosen only where a search gives one, which `options` ask for.
    pub(crate) fn check_answer(&self, is_search: bool, options: &str) -> Result<(), Failure> {
        match self.answer {
            Some(_) if !is_search => {
                let message = format!("given without {options}, expected it with that");
                Err(Failure::option("--answer", message))
            }
            _ => Ok(()),
        }
    }
}

/// A color that is known under a light beside that of the cube.
pub(crate) struct KnownColor {
    pub(crate) light: Illuminant,
    pub(crate) rgb: LinearRgb,
}

/// The colors of `--known`, whose words are light, R, G, B, light, …
pub(crate) fn known_colors(words: &[String], args: &LightArgs) -> Result<Vec<KnownColor>, Failure> {
    let known = words.as_chunks::<4>().0.iter().map(|[light, components @ ..]| {
        let light = plan::light("--known", light, args)?;
        let mut rgb = [0.0; 3];
        for (value, text) in rgb.iter_mut().zip(components) {
            let brightest = Fitter::BRIGHTEST;
            let number = text.trim().parse().ok();
            let in_range = number.filter(|number: &f64| number.abs() <= brightest);
            *value = in_range.ok_or_else(|| {
                let message =
                    format!("{text:?}, expected a number from -{brightest} to {brightest}");
                Failure::option("--known", message)
            })?;
        }
        Ok(KnownColor { light, rgb: LinearRgb(rgb) })
    });
    known.collect()
}

/// A search for colors under the light of the contract and those of known colors.
pub(crate) fn search(
    contract: &Contract,
    known: &[KnownColor],
    kind: PaintKind,
) -> Result<MetamerSearch, Failure> {
    let lights: Vec<Illuminant> = known.iter().map(|known| known.light.clone()).collect();
    MetamerSearch::new(contract, &lights, kind).map_err(refused)
}

/// The material that is the answer.
pub(crate) fn answer(metamers: &Metamers, args: &PaintArgs) -> Result<OwnMaterial, Failure> {
    let found = match args.answer.unwrap_or_default() {
        AnswerName::Single => metamers.single(),
        AnswerName::Mixture => metamers.mixture(),
    };
    found.map_err(refused)
}

pub(crate) fn refused(error: MetamerError) -> Failure {
    match error {
        MetamerError::Lights { .. } => Failure::option("--known", error),
        _ => Failure::input("R G B", error),
    }
}

/// What is known of a paint, and how sure the answer is.
#[derive(Debug, Serialize)]
pub(crate) struct PaintReport {
    pub(crate) kind: PaintKind,
    pub(crate) answer: AnswerName,
    /// The probability that a paint of these colors fluoresces, where of twenty paints one does.
    pub(crate) fluorescent_probability: f64,
    pub(crate) known: Vec<KnownReport>,
}

/// How far the answer is from a known color.
#[derive(Debug, Serialize)]
pub(crate) struct KnownReport {
    pub(crate) light: String,
    pub(crate) rgb: LinearRgb,
    pub(crate) de2000: f64,
    /// What is to say where its ultraviolet is not known.
    pub(crate) missing_ultraviolet: Option<String>,
}

impl PaintReport {
    /// `seen` is the color of the answer under each known light.
    pub(crate) fn new(
        contract: &Contract,
        args: &PaintArgs,
        fluorescent_probability: f64,
        known: &[KnownColor],
        missing_ultraviolet: impl Fn(&Illuminant) -> Option<String>,
        seen: impl Fn(&Colorimetry) -> Xyz,
    ) -> Self {
        let known = known.iter().map(|KnownColor { light, rgb }| {
            let under = contract.seen_under(light, Grid::FIT);
            let target = under.colorimetry.xyz_from_rgb(*rgb);
            let lab = |xyz| lab_from_xyz(xyz, under.white);
            let de2000 = ciede2000(lab(target), lab(seen(&under.colorimetry)));
            let missing_ultraviolet = missing_ultraviolet(light);
            KnownReport { light: light.name().into(), rgb: *rgb, de2000, missing_ultraviolet }
        });
        Self {
            kind: args.kind.unwrap_or_default(),
            answer: args.answer.unwrap_or_default(),
            fluorescent_probability,
            known: known.collect(),
        }
    }

    /// Whether the paint fluoresces, and what a wrong assumption costs.
    pub(crate) fn fluoresces(&self) -> String {
        let probability = self.fluorescent_probability;
        let percent = match 100.0 * probability {
            percent if percent < 1.0 => "less than 1 %".into(),
            percent if percent > 99.0 => "more than 99 %".into(),
            percent => format!("{percent:.0} %"),
        };
        let colors = if self.known.is_empty() { "color" } else { "colors" };
        let judged = format!("by its {colors} with a probability of {percent}");
        match self.kind {
            PaintKind::Any => judged,
            PaintKind::Ordinary => format!("no, as asked; {judged}"),
            PaintKind::Fluorescent if probability > 0.99 => format!("yes, as asked; {judged}"),
            PaintKind::Fluorescent => format!(
                "yes, as asked; {judged}.\nA paint that does not is shown worse: with a mean error of \
                 3.9 in place of 1.2 ΔE00 under seven lights"
            ),
        }
    }
}
