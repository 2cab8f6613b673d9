//! Fits a material to one color.

use std::sync::atomic::Ordering;

use rayon::prelude::*;
use upglow::{Fluorescence, Model, ModelOnGrid};
use upglow_color::{Contract, LinearRgb};

use crate::fit::{Fit, better};
use crate::options::{FitOptions, FitOptionsError, Method};
use crate::search::context::{Context, Stage};
use crate::search::job::Job;
use crate::search::konig2020::Parameters;

/// Fits materials to colors under one contract, with one model.
#[derive(Debug)]
pub struct Fitter {
    pub(crate) context: Context,
    /// The slope limit of a reflectance alone.
    pub(crate) alone: Stage,
    /// The slope limits of a reflectance under dyes, in the order in which they are tried.
    with_dyes: Vec<Stage>,
    options: FitOptions,
}

/// Why a color cannot be fitted.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ColorError {
    /// A component is out of range or NaN.
    #[error("{channel} is {value}, expected 0 to {}", Fitter::BRIGHTEST)]
    Outside {
        /// red, green or blue.
        channel: &'static str,
        /// The value given.
        value: f64,
    },
}

/// Fits stay below the slope limit by this share of it, so that rounding to single precision, 6e-8, does
/// not exceed it.
const SLOPE_MARGIN: f64 = 1e-6;

impl Fitter {
    /// The greatest RGB component that is fitted: no fluorescent material is ten times as bright as white.
    pub const BRIGHTEST: f64 = 10.0;

    /// Prepares fits under a contract, with a model.
    ///
    /// # Errors
    ///
    /// [`FitOptionsError`] if an option is out of range.
    pub fn new(
        contract: &Contract,
        model: &Model,
        options: FitOptions,
    ) -> Result<Self, FitOptionsError> {
        options.check(model)?;
        let context = Context::new(contract, model);
        let stage = |limit_per_nm: f64| Stage::new(limit_per_nm * (1.0 - SLOPE_MARGIN));
        let (alone_per_nm, with_dyes_per_nm) = options.slope_limits_per_nm()?;
        let alone = stage(alone_per_nm);
        let with_dyes = with_dyes_per_nm.into_iter().map(stage).collect();
        Ok(Self { context, alone, with_dyes, options })
    }

    /// The model and the contract, on the grid of the fit.
    pub fn model(&self) -> &ModelOnGrid {
        &self.context.model
    }

    /// Makes what fits by the rule need, on all threads; otherwise the first that needs it makes it.
    pub(crate) fn prepare(&self) {
        if self.is_film() {
            self.with_dyes.par_iter().for_each(|stage| {
                self.context.starts(stage);
            });
        }
    }

    /// How often residuals and derivatives were evaluated so far, in all fits.
    pub fn evaluations(&self) -> u64 {
        self.context.evaluations.load(Ordering::Relaxed)
    }

    /// The material of `rgb`, which may be brighter than white.
    ///
    /// A reflectance if one matches the color within 0.01 ΔE00; else a match with as little fluorescence
    /// as the color needs; else the nearest material that the search finds.
    ///
    /// # Errors
    ///
    /// [`ColorError`] if a component is not in 0..=10.
    pub fn fit(&self, rgb: LinearRgb) -> Result<Fit, ColorError> {
        for (channel, value) in ["red", "green", "blue"].into_iter().zip(rgb.0) {
            if !(0.0..=Self::BRIGHTEST).contains(&value) {
                return Err(ColorError::Outside { channel, value });
            }
        }
        let fit = self.fit_among(rgb, &[]);
        if !self.is_film() || self.options.method != Method::Search || self.is_final(&fit) {
            return Ok(fit);
        }
        Ok(self.lightened(rgb, fit))
    }

    /// The material of `rgb`, which is in 0..=1, with those of colors around it as starts.
    pub(crate) fn fit_among(&self, rgb: LinearRgb, around: &[Fit]) -> Fit {
        let job = self.job(rgb);
        job.gray().unwrap_or_else(|| match self.options.method {
            Method::Search | Method::Exhaustive if self.is_film() || !self.has_one_limit() => {
                self.by_rule(rgb, around)
            }
            Method::Search => job.search(around),
            Method::Exhaustive => job.search_exhaustively(),
            Method::Konig2020 => job.konig2020_first(Parameters::Coefficients),
            Method::Konig2020Features => job.konig2020_first(Parameters::Features),
        })
    }

    /// The best of `known` and of the fits that start from the neighbors' materials.
    pub(crate) fn improve(&self, rgb: LinearRgb, known: Fit, neighbors: &[Fit]) -> Fit {
        let job = self.job(rgb);
        match self.options.method {
            Method::Search | Method::Exhaustive if self.is_film() => {
                job.improve_film(known, neighbors)
            }
            Method::Search | Method::Exhaustive => job.improve(known, neighbors),
            Method::Konig2020 => job.konig2020_again(Parameters::Coefficients, known, neighbors),
            Method::Konig2020Features => {
                job.konig2020_again(Parameters::Features, known, neighbors)
            }
        }
    }

    /// Whether no neighbor's material can improve a fit: it matches, and no dose could be smaller.
    pub(crate) fn is_final(&self, fit: &Fit) -> bool {
        fit.is_matched() && (!self.is_film() || fit.fluorescence == Fluorescence::None)
    }

    /// Matches of `rgb` near the materials of its neighbors, no steeper than the limit that `known` needed.
    pub(crate) fn matches_near(&self, rgb: LinearRgb, known: Fit, neighbors: &[Fit]) -> Vec<Fit> {
        self.job_at(rgb, self.stage_of(&known)).matches_near(known, neighbors)
    }

    /// The best of `known` and of fits from many starts, within the first limit under dyes that leads to a
    /// match.
    fn lightened(&self, rgb: LinearRgb, known: Fit) -> Fit {
        let own_limit = self.stage_of(&known).slope_limit_per_nm;
        let mut nearest = known;
        for stage in &self.with_dyes {
            let found = self.job_at(rgb, stage).film_from_many_starts();
            let is_gentler = stage.slope_limit_per_nm < own_limit;
            let best = if is_gentler { found } else { better(Some(known), found) };
            if best.is_matched() {
                return best;
            }
            nearest = better(Some(nearest), best);
        }
        nearest
    }

    /// The stage of the first limit under dyes that a reflectance keeps.
    fn stage_of(&self, fit: &Fit) -> &Stage {
        let slope = fit.reflectance.slope_per_nm.abs();
        let is_wide = |stage: &&Stage| slope <= stage.slope_limit_per_nm * (1.0 + SLOPE_MARGIN);
        self.with_dyes.iter().find(is_wide).unwrap_or(self.main())
    }

    pub(crate) fn is_film(&self) -> bool {
        matches!(self.model().model(), Model::Film(_))
    }

    /// The material by the rule of choosing: a reflectance within its limit, else a material with dyes
    /// within theirs, else, if limits are relaxed, either of them within steeper ones; if all miss, the
    /// nearest.
    fn by_rule(&self, rgb: LinearRgb, around: &[Fit]) -> Fit {
        let job = self.job_at(rgb, &self.alone);
        let free = job.reflectance_without_limit();
        let passive = job.reflectance_near(free);
        if passive.is_matched() {
            return passive;
        }
        let within = |stage: &Stage| {
            let job = self.job_at(rgb, stage);
            let is_steeper = stage.slope_limit_per_nm > self.alone.slope_limit_per_nm;
            let alone = if is_steeper { job.reflectance_near(free) } else { passive };
            if alone.is_matched() {
                return alone;
            }
            better(Some(alone), self.glowing(&job, around, passive))
        };
        let (widest, gentler) = self.with_dyes.split_last().expect("there is at least one stage");
        // Beside misses a color is probably missed too; then the widest limits alone show it.
        let is_beside_misses = !around.is_empty() && !around.iter().any(Fit::is_matched);
        let widest_first = is_beside_misses.then(|| within(widest));
        if let Some(missed) = widest_first.filter(|fit| !fit.is_matched()) {
            return missed;
        }
        let mut best = passive;
        for stage in gentler {
            best = better(Some(best), within(stage));
            if best.is_matched() {
                return best;
            }
        }
        better(Some(best), widest_first.unwrap_or_else(|| within(widest)))
    }

    /// The best material with dyes by the method of the options.
    fn glowing(&self, job: &Job<'_>, around: &[Fit], passive: Fit) -> Fit {
        match (self.is_film(), self.options.method) {
            (true, Method::Exhaustive) => job.film_exhaustively(),
            (true, _) => job.film(around, passive),
            (false, Method::Exhaustive) => job.search_exhaustively(),
            (false, _) => job.search(around),
        }
    }

    /// The stage of the limit under dyes.
    pub(crate) fn main(&self) -> &Stage {
        &self.with_dyes[0]
    }

    /// Whether one slope limit holds for all materials.
    fn has_one_limit(&self) -> bool {
        self.with_dyes.len() == 1 && self.main().slope_limit_per_nm == self.alone.slope_limit_per_nm
    }

    fn job(&self, rgb: LinearRgb) -> Job<'_> {
        self.job_at(rgb, self.main())
    }

    fn job_at<'f>(&'f self, rgb: LinearRgb, stage: &'f Stage) -> Job<'f> {
        let colorimetry = self.model().colorimetry();
        let goal = self.options.metric.goal(colorimetry, colorimetry.xyz_from_rgb(rgb));
        Job { context: &self.context, stage, goal }
    }
}
