//! The cubes that figures and claims are computed from, each built once.

use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use upglow::{Cube, Mixing, Model};
use upglow_color::Metric;
use upglow_fit::{BuildError, FitOptions, Method, Watch, build_cube};
use upglow_study::konig2020;

/// Which cube. All have the paper's contract and its limit of slopes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum StudyCube {
    /// Our own search with the paper's dyes.
    Search {
        /// The color difference that is minimized.
        metric: Metric,
    },
    /// The paper's method: eight dyes, coefficients as the variables.
    Paper {
        /// The color difference that is minimized.
        metric: Metric,
        /// How often nodes try their neighbors' materials; the paper calls it iterations.
        sweeps: u32,
    },
    /// The paper's method with shift, width and slope as the variables: CIEDE2000, four sweeps.
    PaperFeatures,
    /// The paper's method with analytic fluorescence: CIEDE2000, four sweeps.
    PaperAnalytic {
        /// Full widths at half maximum of absorption and emission, nm.
        fwhm_nm: [u32; 2],
    },
}

/// Sweeps of our own search. More of them find little: it meets most nodes that it can before the first.
const SEARCH_SWEEPS: u32 = 2;

impl StudyCube {
    /// Our own search for the materials that the paper's method searches for.
    pub(crate) const REFERENCE: Self = Self::Search { metric: Metric::De2000 };

    /// The paper's method with dyes, CIEDE2000 and four sweeps, as in its figures 1, 3 and 7.
    pub(crate) const PAPER: Self =
        Self::Paper { metric: Metric::De2000, sweeps: konig2020::SWEEPS };

    /// The paper's method with analytic fluorescence of our widths.
    pub(crate) const PAPER_ANALYTIC: Self =
        Self::PaperAnalytic { fwhm_nm: konig2020::ANALYTIC_FWHM_NM };

    fn model(self) -> Model {
        match self {
            Self::PaperAnalytic { fwhm_nm } => Model::Analytic(konig2020::analytic(fwhm_nm)),
            Self::Search { .. } | Self::Paper { .. } | Self::PaperFeatures => {
                Model::Dyes(konig2020::dyes(Mixing::Pooled))
            }
        }
    }

    fn options(self) -> FitOptions {
        let usual = konig2020::options(Metric::De2000, konig2020::SWEEPS);
        match self {
            Self::Search { metric } => {
                FitOptions { metric, sweeps: SEARCH_SWEEPS, method: Method::Search, ..usual }
            }
            Self::Paper { metric, sweeps } => konig2020::options(metric, sweeps),
            Self::PaperFeatures => FitOptions { method: Method::Konig2020Features, ..usual },
            Self::PaperAnalytic { .. } => usual,
        }
    }
}

/// Cubes of one resolution, each built when it is first needed.
#[derive(Debug)]
pub(crate) struct Cubes {
    resolution: usize,
    built: Mutex<HashMap<StudyCube, Arc<Cube>>>,
}

impl Cubes {
    /// Builds nothing yet. The paper's resolution is 32.
    pub(crate) fn new(resolution: usize) -> Self {
        Self { resolution, built: Mutex::default() }
    }

    /// Nodes along each axis.
    pub(crate) fn resolution(&self) -> usize {
        self.resolution
    }

    /// Returns a cube; the first call builds it on all threads of the current rayon pool.
    ///
    /// The result does not depend on the number of threads. Two threads that ask for the same
    /// missing cube at the same time both build it.
    ///
    /// # Errors
    ///
    /// [`BuildError`] if the resolution is out of range or `watch` stopped the work.
    pub(crate) fn get(&self, which: StudyCube, watch: &dyn Watch) -> Result<Arc<Cube>, BuildError> {
        if let Some(known) = self.built().get(&which) {
            return Ok(Arc::clone(known));
        }
        // Without holding the lock: a thread that waits for its rayon pool may run another task
        // that needs a cube.
        let contract = konig2020::contract();
        let cube = build_cube(&contract, &which.model(), which.options(), self.resolution, watch)?;
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
        for which in [StudyCube::REFERENCE, StudyCube::PAPER, StudyCube::PaperFeatures] {
            let first = cubes.get(which, &Unwatched).unwrap();
            assert!(Arc::ptr_eq(&first, &cubes.get(which, &Unwatched).unwrap()));
            assert_eq!(first, others.get(which, &Unwatched).unwrap());
        }
    }

    #[test]
    fn a_resolution_out_of_range_is_refused() {
        let refused = Cubes::new(1).get(StudyCube::REFERENCE, &Unwatched).unwrap_err();
        assert_eq!(refused.to_string(), "resolution 1, expected 2 to 256");
    }
}
