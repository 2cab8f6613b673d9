//! Builds cubes.

mod lattice;
mod neighbors;
mod summary;

use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;
use upglow::{CoefficientTableError, Cube, CubeError, Model, Node};
use upglow_color::{Contract, LinearRgb, Metric};

use crate::fit::Fit;
use crate::fitter::Fitter;
use crate::options::{FitOptions, FitOptionsError, Method};
use crate::progress::{Progress, Watch};
use lattice::Lattice;
pub use summary::{CubeSummary, Spread};

/// Why a cube was not built.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum BuildError {
    /// An option is out of range.
    #[error(transparent)]
    Options(#[from] FitOptionsError),
    /// The resolution is out of range.
    #[error(transparent)]
    Cube(#[from] CubeError),
    /// The resolution of a table is out of range.
    #[error(transparent)]
    Table(#[from] CoefficientTableError),
    /// The watcher stopped the work.
    #[error("stopped")]
    Stopped,
}

/// Fits a material for every node of a cube, on all threads of the current rayon pool.
///
/// First a coarse lattice, each node alone; then, in two steps, the nodes between, each from the
/// materials at the corners of its cell; then sweeps, as many as the options say, in which each node
/// that missed its color tries the materials of its six neighbors; nodes of films also to lower their
/// dose. Last, each node of a film takes, of its matches with at most 1.5 times the least dose, the one nearest
/// to its neighbors' materials. Each of these steps uses the neighbors' materials from before it, so the
/// result does not depend on the number of threads.
/// [`Method::Exhaustive`](crate::Method::Exhaustive) and the methods of König et al. 2020 fit every node
/// alone before the sweeps.
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
    let lattice = Lattice::try_new(resolution)?;
    let fitter = Fitter::new(contract, model, options)?;
    fitter.prepare();
    let mut fits = fit_coarse_to_fine(&fitter, lattice, watch)?;
    let mut moved = vec![true; lattice.len()];
    for _ in 0..options.sweeps {
        let before = fits;
        fits = Stage::new("asking neighbors", lattice.len(), watch)
            .each(lattice.len(), |index| sweep_node(&fitter, lattice, &before, &moved, index))?;
        moved = fits.iter().zip(&before).map(|(now, then)| now != then).collect();
        if !moved.contains(&true) {
            break;
        }
    }
    if fitter.is_film() && options.method == Method::Search {
        fits = neighbors::Choice::new(&fitter, lattice, contract, model).choose(fits, watch)?;
    }
    let nodes = Stage::new("measuring", lattice.len(), watch)
        .each(lattice.len(), |index| stored_node(&fitter, lattice.rgb(index), &fits[index]))?;
    let fit = options.record(model, fitter.evaluations());
    Ok(Cube::new(contract.clone(), model.clone(), fit, resolution, nodes)?)
}

/// Fits the nodes of the coarsest lattice alone, and those of finer ones from the materials around.
fn fit_coarse_to_fine(
    fitter: &Fitter,
    lattice: Lattice,
    watch: &dyn Watch,
) -> Result<Vec<Fit>, BuildError> {
    let stage = Stage::new("fitting", lattice.len(), watch);
    let mut fits = vec![None; lattice.len()];
    for step in lattice.refinements() {
        let nodes = step.nodes();
        let found = stage.each(nodes.len(), |i| {
            let around: Vec<Fit> = step.around(nodes[i]).filter_map(|node| fits[node]).collect();
            fitter.fit_among(lattice.rgb(nodes[i]), &around)
        })?;
        nodes.into_iter().zip(found).for_each(|(node, fit)| fits[node] = Some(fit));
    }
    Ok(fits.into_iter().map(|fit| fit.expect("the steps hold every node")).collect())
}

/// How many nodes a thread takes at a time: enough to make the cost of progress negligible.
const BATCH: usize = 64;

/// A stage of the work: runs in parallel, reports progress, stops when the watcher says so.
pub(crate) struct Stage<'w> {
    name: &'static str,
    done: AtomicUsize,
    total: usize,
    watch: &'w dyn Watch,
}

impl<'w> Stage<'w> {
    pub(crate) fn new(name: &'static str, total: usize, watch: &'w dyn Watch) -> Self {
        Self { name, done: AtomicUsize::new(0), total, watch }
    }

    /// The results of `work` for 0 to `count` − 1, in order.
    pub(crate) fn each<T: Send + Clone>(
        &self,
        count: usize,
        work: impl Fn(usize) -> T + Sync,
    ) -> Result<Vec<T>, BuildError> {
        let batches: Option<Vec<Vec<T>>> = (0..count.div_ceil(BATCH))
            .into_par_iter()
            .map(|batch| self.batch(batch * BATCH..count.min((batch + 1) * BATCH), &work))
            .collect();
        batches.map(|batches| batches.concat()).ok_or(BuildError::Stopped)
    }

    fn batch<T>(&self, range: Range<usize>, work: impl Fn(usize) -> T) -> Option<Vec<T>> {
        let finished = range.len();
        // A node of an exhaustive search takes a second.
        let results = range.map(|node| (!self.watch.stopped()).then(|| work(node)));
        let results = results.collect::<Option<Vec<T>>>()?;
        let done = self.done.fetch_add(finished, Ordering::Relaxed) + finished;
        self.watch.progress(Progress { stage: self.name, done, total: self.total });
        Some(results)
    }
}

/// The fit of one node after a sweep.
///
/// If neither the node nor a neighbor changed in the last sweep, another one would change nothing.
fn sweep_node(
    fitter: &Fitter,
    lattice: Lattice,
    before: &[Fit],
    moved: &[bool],
    index: usize,
) -> Fit {
    let known = before[index];
    let is_settled = !moved[index] && lattice.neighbors(index).all(|i| !moved[i]);
    if fitter.is_final(&known) || is_settled {
        return known;
    }
    let neighbors: Vec<Fit> = lattice.neighbors(index).map(|i| before[i]).collect();
    fitter.improve(lattice.rgb(index), known, &neighbors)
}

/// A fit as the cube stores it, with the color difference of the stored material.
fn stored_node(fitter: &Fitter, rgb: LinearRgb, fit: &Fit) -> Node {
    let model = fitter.model();
    let target = model.colorimetry().xyz_from_rgb(rgb);
    let node = Node::new(fit.reflectance, fit.fluorescence, 0.0);
    let color = model.color(node.material(model.model()));
    let de2000 = Metric::De2000.distance(model.colorimetry(), target, color);
    Node::new(fit.reflectance, fit.fluorescence, de2000)
}
