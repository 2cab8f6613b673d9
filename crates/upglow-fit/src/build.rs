//! Builds cubes.

use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;
use upglow::{Cube, CubeError, FitRecord, Model, Node};
use upglow_color::{Contract, LinearRgb, Metric};

use crate::fitter::EXACT;
use crate::{Fit, FitOptions, FitOptionsError, Fitter, Progress, Watch};

/// Why no cube was built.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BuildError {
    /// An option is out of range.
    #[error(transparent)]
    Options(#[from] FitOptionsError),
    /// The resolution is out of range.
    #[error(transparent)]
    Cube(#[from] CubeError),
    /// The watcher stopped the work.
    #[error("stopped")]
    Stopped,
}

/// Fits a material for every node of a cube, on all threads of the current rayon pool.
///
/// First each node alone; then, in as many sweeps as the options say, each node that missed its
/// color tries the materials of its six neighbors, as they were before the sweep. So the result
/// does not depend on the number of threads.
///
/// # Errors
///
/// [`BuildError`] if an option is out of range or `watch` stopped the work.
pub fn build_cube(
    contract: &Contract,
    model: &Model,
    options: FitOptions,
    resolution: usize,
    watch: &dyn Watch,
) -> Result<Cube, BuildError> {
    let lattice = Lattice::new(resolution)?;
    let fitter = Fitter::new(contract, model, options)?;
    let mut fits = each_node(lattice, "fitting", watch, |index| {
        fitter.fit(lattice.rgb(index)).expect("nodes are in 0..=1")
    })?;
    let mut moved = vec![true; lattice.len()];
    for _ in 0..options.sweeps {
        let before = fits;
        fits = each_node(lattice, "asking neighbors", watch, |index| {
            sweep_node(&fitter, lattice, &before, &moved, index)
        })?;
        moved = fits.iter().zip(&before).map(|(now, then)| now != then).collect();
        if !moved.contains(&true) {
            break;
        }
    }
    let nodes = each_node(lattice, "measuring", watch, |index| {
        stored_node(&fitter, lattice.rgb(index), &fits[index])
    })?;
    let fit = FitRecord {
        metric: options.metric.to_string(),
        slope_max_per_nm: options.slope_max_per_nm,
        sweeps: options.sweeps,
        method: options.method.to_string(),
        evaluations: fitter.evaluations(),
    };
    Ok(Cube::new(contract.clone(), model.clone(), fit, resolution, nodes)?)
}

/// The nodes of a cube, `[blue][green][red]`.
#[derive(Clone, Copy, Debug)]
struct Lattice {
    resolution: usize,
}

impl Lattice {
    fn new(resolution: usize) -> Result<Self, CubeError> {
        let [least, most] = Cube::RESOLUTIONS;
        if (least..=most).contains(&resolution) {
            Ok(Self { resolution })
        } else {
            Err(CubeError::Resolution { found: resolution })
        }
    }

    fn len(self) -> usize {
        self.resolution.pow(3)
    }

    fn rgb(self, index: usize) -> LinearRgb {
        let n = self.resolution;
        let last = (n - 1) as f64;
        LinearRgb([index % n, index / n % n, index / (n * n)].map(|i| i as f64 / last))
    }

    /// The up to six nodes beside one.
    fn neighbors(self, index: usize) -> impl Iterator<Item = usize> {
        let n = self.resolution;
        [1, n, n * n].into_iter().flat_map(move |stride| {
            let place = index / stride % n;
            let below = (place > 0).then(|| index - stride);
            let above = (place + 1 < n).then(|| index + stride);
            below.into_iter().chain(above)
        })
    }
}

/// How many nodes a thread takes at a time: enough that telling progress costs nothing.
const BATCH: usize = 64;

/// `work` for each node, in the order of the nodes.
fn each_node<T: Send + Copy>(
    lattice: Lattice,
    stage: &'static str,
    watch: &dyn Watch,
    work: impl Fn(usize) -> T + Sync,
) -> Result<Vec<T>, BuildError> {
    let total = lattice.len();
    let done = AtomicUsize::new(0);
    let batches: Option<Vec<Vec<T>>> = (0..total.div_ceil(BATCH))
        .into_par_iter()
        .map(|batch| {
            if watch.stopped() {
                return None;
            }
            let range = batch * BATCH..total.min((batch + 1) * BATCH);
            let finished = range.len();
            let results = range.map(&work).collect();
            let done = done.fetch_add(finished, Ordering::Relaxed) + finished;
            watch.progress(Progress { stage, done, total });
            Some(results)
        })
        .collect();
    batches.map(|batches| batches.concat()).ok_or(BuildError::Stopped)
}

/// One node in a sweep: what it had, or better from its neighbors.
///
/// Where neither the node nor a neighbor moved in the last sweep, nothing new can come of it.
fn sweep_node(
    fitter: &Fitter,
    lattice: Lattice,
    before: &[Fit],
    moved: &[bool],
    index: usize,
) -> Fit {
    let known = before[index];
    let is_settled = !moved[index] && lattice.neighbors(index).all(|i| !moved[i]);
    if known.de2000 <= EXACT || is_settled {
        return known;
    }
    let neighbors: Vec<Fit> = lattice.neighbors(index).map(|i| before[i]).collect();
    fitter.improve(lattice.rgb(index), known, &neighbors)
}

/// A fit as the cube keeps it, with the color difference of what is kept.
fn stored_node(fitter: &Fitter, rgb: LinearRgb, fit: &Fit) -> Node {
    let model = fitter.model();
    let target = model.colorimetry().xyz_from_rgb(rgb);
    let mut node = Node::new(fit.reflectance, fit.fluorescence, 0.0);
    let color = model.color(node.material(model.model()));
    let de2000 = Metric::De2000.distance(model.colorimetry(), target, color);
    node = Node::new(fit.reflectance, fit.fluorescence, de2000);
    node
}
