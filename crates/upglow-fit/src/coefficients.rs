//! Fits tables of sigmoid coefficients, for programs that cannot read cubes.

use upglow::{CoefficientTable, Model, Sigmoid};
use upglow_color::rounding::to_single;
use upglow_color::{Contract, Goal, Grid, LinearRgb, Metric};

use crate::cube::{BuildError, Spread, Stage};
use crate::fitter::Fitter;
use crate::preset::Preset;
use crate::problem::parabola::sigmoid_of;
use crate::problem::solver::{SolverOptions, solve};
use crate::problem::{PassiveProblem, Shape};
use crate::progress::Watch;
use crate::search::job::Job;
use crate::verify::random_rgb;

/// Fits the reflectance of every node of a [`CoefficientTable`], on all threads of the current rayon
/// pool.
///
/// The nodes of one hue and saturation are fitted from medium brightness to both ends, each from its
/// neighbor's coefficients, so that these are similar: readers interpolate them. If no reflectance
/// within the slope limit matches, the node gets the nearest one found.
///
/// # Errors
///
/// [`BuildError`] if an option or the resolution is out of range, or `watch` stopped the work.
pub fn fit_coefficients(
    contract: &Contract,
    slope_max_per_nm: Option<f64>,
    resolution: usize,
    watch: &dyn Watch,
) -> Result<CoefficientTable, BuildError> {
    let options = Preset::Jakob2019.options().with_slope_max_per_nm(slope_max_per_nm);
    let fitter = Fitter::new(contract, &Model::Reflectance, options)?;
    let blank = vec![[0.0; 3]; 3 * resolution.pow(3)];
    let brightness = CoefficientTable::levels(resolution);
    let blank = CoefficientTable::new(brightness.clone(), blank)?;
    let count = 3 * resolution * resolution;
    let columns = Stage::new("fitting", count, watch)
        .each(count, |column| Column { fitter: &fitter, table: &blank, column }.follow())?;
    let mut nodes = Vec::with_capacity(blank.nodes().len());
    for of_channel in columns.chunks(resolution * resolution) {
        for step in 0..resolution {
            nodes.extend(of_channel.iter().map(|column| column[step]));
        }
    }
    Ok(CoefficientTable::new(brightness, nodes)?.with_integrator(contract))
}

/// CIEDE2000 between `points` random colors of the contract's RGB space and the reflectances that
/// readers interpolate in `table`, by sums over 5 nm. The same `seed` draws the same colors.
pub fn round_trip(
    table: &CoefficientTable,
    contract: &Contract,
    points: usize,
    seed: u64,
) -> Spread {
    let colorimetry = contract.on(Grid::FIT);
    let miss = |point: usize| {
        let rgb = LinearRgb(random_rgb(seed, point).0.map(|v| f64::from(to_single(v))));
        let found = table.sigmoid(rgb.0.map(to_single));
        let shown = colorimetry.wavelengths_nm().iter().map(|&nm| found.at(nm));
        let shown = colorimetry.xyz_from_reflectance(shown);
        Metric::De2000.distance(&colorimetry, colorimetry.xyz_from_rgb(rgb), shown)
    };
    Spread::of((0..points).map(miss).collect())
}

/// All nodes of one hue and saturation, from dark to bright.
#[derive(Clone, Copy, Debug)]
struct Column<'a> {
    fitter: &'a Fitter,
    table: &'a CoefficientTable,
    /// `[largest][next but one][next]`.
    column: usize,
}

/// Darker colors are fitted at an exposure that brings their greatest channel to this. CIEDE2000 hardly
/// counts the hue of dark colors, but a renderer's light may be bright. Larger makes fits of midtones
/// stricter; smaller loses dark hues.
const LEAST_SEEN: f64 = 0.1;

/// The coefficient of white in published tables, and minus that of black: flat reflectances of 1 − 4e-9
/// and 4e-9.
const GREATEST_FLAT: f64 = 8192.0;

impl Column<'_> {
    fn follow(&self) -> Vec<[f32; 3]> {
        let brightness = self.table.brightness();
        let middle = brightness.partition_point(|value| *value < 0.5).min(brightness.len() - 2);
        let first = self.start(middle);
        let mut found = vec![first; brightness.len()];
        for step in (0..middle).rev() {
            found[step] = self.from(step, found[step + 1]);
        }
        for step in middle + 1..brightness.len() {
            found[step] = self.from(step, found[step - 1]);
        }
        let numbers = found.iter().enumerate().map(|(step, near)| self.stored(step, *near));
        numbers.map(|s| [s.c0, s.c1, s.c2].map(to_single)).collect()
    }

    /// Coefficients of 1, t, t² by the general search.
    fn start(&self, step: usize) -> [f64; 3] {
        let rgb = self.table.node_rgb(self.place(step));
        let fit = self.fitter.fit(rgb).expect("nodes are in 0..=1");
        Shape::Free.numbers(fit.reflectance)
    }

    /// Coefficients for a step of brightness, starting at those of its neighbor.
    fn from(&self, step: usize, near: [f64; 3]) -> [f64; 3] {
        let problem = self.problem(step);
        let free = solve(&problem, near, &SolverOptions::default()).x;
        let limit_per_nm = self.fitter.main().slope_limit_per_nm;
        if Shape::Free.edge(free).slope_per_nm.abs() <= limit_per_nm {
            return free;
        }
        let shape = Shape::Edge { slope_limit_per_nm: limit_per_nm };
        let start = shape.numbers(Shape::Free.edge(near));
        let problem = PassiveProblem { shape, ..problem };
        let edge = solve(&problem, start, &SolverOptions::default()).x;
        Shape::Free.numbers(shape.edge(edge))
    }

    /// The coefficients to store: flat for grays.
    fn stored(&self, step: usize, found: [f64; 3]) -> Sigmoid {
        let job =
            Job { context: &self.fitter.context, stage: self.fitter.main(), goal: self.goal(step) };
        let flat =
            |x: f64| Sigmoid { c0: 0.0, c1: 0.0, c2: x.clamp(-GREATEST_FLAT, GREATEST_FLAT) };
        match job.gray() {
            Some(gray) => flat(gray.reflectance.level),
            None => sigmoid_of(found),
        }
    }

    fn place(&self, step: usize) -> [usize; 4] {
        let (n, column) = (self.table.resolution(), self.column);
        [column / (n * n), step, column / n % n, column % n]
    }

    fn goal(&self, step: usize) -> Goal {
        let colorimetry = self.fitter.model().colorimetry();
        let color = colorimetry.xyz_from_rgb(self.table.node_rgb(self.place(step)));
        Metric::De2000.goal(colorimetry, color)
    }

    fn problem(&self, step: usize) -> PassiveProblem<'_> {
        let value = f64::from(self.table.brightness()[step]);
        // No exposure brightens black.
        let exposure = if value > 0.0 { (LEAST_SEEN / value).max(1.0) } else { 1.0 };
        let colorimetry = self.fitter.model().colorimetry();
        let lit = self.goal(step).xyz() * exposure;
        let goal = Metric::De2000.goal(colorimetry, lit);
        PassiveProblem { sums: &self.fitter.context.sums, goal, shape: Shape::Free, exposure }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::progress::Unwatched;
    use upglow_color::RgbSpace;

    fn srgb() -> Contract {
        Contract { space: RgbSpace::named("srgb").unwrap(), ..Contract::default() }
    }

    #[test]
    fn every_node_of_srgb_is_matched() {
        // Fits end within 1e-4; coefficients in nm lose 5e-4 of the argument in single precision.
        const SINGLE: f64 = 0.02;
        let table = fit_coefficients(&srgb(), None, 8, &Unwatched).unwrap();
        let n = table.resolution();
        let colorimetry = srgb().on(Grid::FIT);
        for (index, [c0, c1, c2]) in table.nodes().iter().map(|c| c.map(f64::from)).enumerate() {
            let place = [index / n.pow(3), index / (n * n) % n, index / n % n, index % n];
            let target = colorimetry.xyz_from_rgb(table.node_rgb(place));
            let found = Sigmoid { c0, c1, c2 };
            let shown = colorimetry.wavelengths_nm().iter().map(|&nm| found.at(nm));
            let shown = colorimetry.xyz_from_reflectance(shown);
            let miss = Metric::De2000.distance(&colorimetry, target, shown);
            assert!(miss < SINGLE, "{place:?} {miss}");
        }
    }

    #[test]
    fn colors_between_nodes_are_nearer_to_their_targets_in_finer_tables() {
        let spread = |resolution| {
            let table = fit_coefficients(&srgb(), None, resolution, &Unwatched).unwrap();
            round_trip(&table, &srgb(), 1000, 0)
        };
        // Linear interpolation errs by the square of the distance between nodes: half the distance
        // should leave a quarter of the error, but brightness is not spaced evenly.
        let [coarse, fine] = [9, 17].map(spread);
        assert!(fine.mean < coarse.mean / 3.0, "{fine:?} {coarse:?}");
        assert_eq!(fine, spread(17));
    }

    #[test]
    fn grays_are_flat_and_white_is_white() {
        let table = fit_coefficients(&srgb(), Some(0.01), 8, &Unwatched).unwrap();
        for gray in [0.0, 0.2, 0.7, 1.0] {
            let found = table.sigmoid([gray; 3]);
            assert_eq!((found.c0, found.c1), (0.0, 0.0));
        }
        // A flat argument of 8192 is 4e-9 from white.
        assert!((table.sigmoid([1.0; 3]).at(550.0) - 1.0).abs() < 1e-8);
    }

    #[test]
    fn no_node_is_steeper_than_the_limit() {
        // Rounding of three coefficients to single precision, at arguments up to ten.
        const SINGLE: f64 = 1e-4;
        let table = fit_coefficients(&Contract::default(), Some(0.01), 6, &Unwatched).unwrap();
        for [c0, c1, c2] in table.nodes().iter().map(|c| c.map(f64::from)) {
            let steepest = Sigmoid { c0, c1, c2 }.steepest_slope_per_nm();
            assert!(steepest < 0.01 + SINGLE, "{steepest}");
        }
    }
}
