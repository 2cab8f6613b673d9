//! The cubes that figures and claims are taken from, each built once.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use upglow::{AnalyticModel, Cube, DyeModel, DyeOptions, DyeSet, Model};
use upglow_color::{Contract, Metric};
use upglow_fit::{FitOptions, Method, Watch, build_cube};

use crate::error::StudyError;

/// Which cube. All are under the default contract, ACEScg under D65, with slopes of 0.01/nm at most.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum StudyCube {
    /// Ours, with every default: eight dyes, CIEDE2000, our own search.
    Reference,
    /// Ours under another color difference.
    Search {
        /// The color difference that is minimized.
        metric: Metric,
    },
    /// The paper's way: eight dyes, moving coefficients.
    Paper {
        /// The color difference that is minimized.
        metric: Metric,
        /// How often nodes try their neighbors' materials; the paper calls it iterations.
        sweeps: u32,
    },
    /// The paper's way, moving shift, width and slope: CIEDE2000, four sweeps.
    PaperFeatures,
    /// The paper's way with fluorescence by formula: CIEDE2000, moving coefficients.
    PaperAnalytic {
        /// How often nodes try their neighbors' materials.
        sweeps: u32,
    },
}

/// Sweeps of the paper's figures, where they say nothing else.
pub(crate) const PAPER_SWEEPS: u32 = 4;

impl StudyCube {
    /// The paper's way with dyes, CIEDE2000 and four sweeps, as in its figures 1, 3 and 7.
    pub(crate) const PAPER: Self = Self::Paper { metric: Metric::De2000, sweeps: PAPER_SWEEPS };

    /// What fluoresces in it.
    ///
    /// # Errors
    ///
    /// [`StudyError`] never, as long as the built-in set of dyes is complete.
    pub(crate) fn model(self) -> Result<Model, StudyError> {
        match self {
            Self::PaperAnalytic { .. } => Ok(Model::Analytic(AnalyticModel::default())),
            Self::Reference | Self::Search { .. } | Self::Paper { .. } | Self::PaperFeatures => {
                let dyes = DyeSet::named("konig8")?;
                Ok(Model::Dyes(DyeModel::new(dyes, DyeOptions::default())?))
            }
        }
    }

    /// How it is fitted.
    pub(crate) fn options(self) -> FitOptions {
        let konig2020 =
            |metric, sweeps, method| FitOptions { metric, sweeps, method, ..FitOptions::default() };
        match self {
            Self::Reference => FitOptions::default(),
            Self::Search { metric } => FitOptions { metric, ..FitOptions::default() },
            Self::Paper { metric, sweeps } => konig2020(metric, sweeps, Method::Konig2020),
            Self::PaperFeatures => {
                konig2020(Metric::De2000, PAPER_SWEEPS, Method::Konig2020Features)
            }
            Self::PaperAnalytic { sweeps } => konig2020(Metric::De2000, sweeps, Method::Konig2020),
        }
    }
}

/// Cubes of one resolution, built when first asked for and kept.
#[derive(Debug)]
pub(crate) struct Cubes {
    resolution: usize,
    built: Mutex<HashMap<StudyCube, Arc<Cube>>>,
}

impl Cubes {
    /// None yet. The paper's resolution is 32.
    pub(crate) fn new(resolution: usize) -> Self {
        Self { resolution, built: Mutex::default() }
    }

    /// Nodes along each axis.
    pub(crate) fn resolution(&self) -> usize {
        self.resolution
    }

    /// A cube, built on all threads of the current rayon pool if it was not asked for before.
    ///
    /// The result is the same on every call and for any number of threads. Asked by two threads at
    /// once for a cube that is not there yet, both build it.
    ///
    /// # Errors
    ///
    /// [`StudyError`] if the resolution is out of range or `watch` stopped the work.
    pub(crate) fn get(&self, which: StudyCube, watch: &dyn Watch) -> Result<Arc<Cube>, StudyError> {
        if let Some(known) = self.built().get(&which) {
            return Ok(Arc::clone(known));
        }
        // Not under the lock: a thread that waits for the others of its pool may be given a task
        // that asks for a cube too.
        let model = which.model()?;
        let cube =
            build_cube(&Contract::default(), &model, which.options(), self.resolution, watch)?;
        Ok(Arc::clone(self.built().entry(which).or_insert_with(|| Arc::new(cube))))
    }

    fn built(&self) -> MutexGuard<'_, HashMap<StudyCube, Arc<Cube>>> {
        self.built.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use upglow_fit::Unwatched;

    #[test]
    fn a_cube_is_built_once_and_is_the_same_from_a_fresh_start() {
        let (cubes, others) = (Cubes::new(4), Cubes::new(4));
        for which in [StudyCube::Reference, StudyCube::PAPER, StudyCube::PaperFeatures] {
            let first = cubes.get(which, &Unwatched).unwrap();
            assert!(Arc::ptr_eq(&first, &cubes.get(which, &Unwatched).unwrap()));
            assert_eq!(first, others.get(which, &Unwatched).unwrap());
        }
    }

    #[test]
    fn a_resolution_out_of_range_is_refused() {
        let refused = Cubes::new(1).get(StudyCube::Reference, &Unwatched).unwrap_err();
        assert_eq!(refused.to_string(), "resolution 1, expected 2 to 256");
    }
}
