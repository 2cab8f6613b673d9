//! Chooses, among the exact matches of each node, the one nearest to its neighbors' materials.

use rayon::prelude::*;
use upglow::{Fluorescence, Model, ModelOnGrid};
use upglow_color::{Contract, Grid, LinearRgb};

use super::Stage;
use super::lattice::Lattice;
use crate::cube::BuildError;
use crate::fit::Fit;
use crate::fitter::Fitter;
use crate::progress::Watch;
use crate::seams::lights;

/// A match may have this many times the least dose. With 2, seams are no weaker, by more than 0.1 in the
/// greatest tenth under a UV lamp and not at all under A and LED-B3.
const MOST_DOSE: f64 = 1.5;

/// How often each node looks at its neighbors.
const ROUNDS: usize = 3;

/// How the colors of a material shift from the contract's light to others, in Lab.
type Shifts = [[f64; 3]; 3];

const NONE: Shifts = [[0.0; 3]; 3];

/// Replaces the material of each node that fluoresces by the match nearest to the materials of its
/// neighbors, of those with at most 1.5 times the least dose.
///
/// Two materials are near if their colors shift alike under other lights. Nodes are updated in two sets,
/// like the fields of a chessboard: while a node is updated, none of its neighbors changes.
pub(super) struct Choice<'f> {
    fitter: &'f Fitter,
    lattice: Lattice,
    lights: Vec<ModelOnGrid>,
}

impl<'f> Choice<'f> {
    pub(super) fn new(
        fitter: &'f Fitter,
        lattice: Lattice,
        contract: &Contract,
        model: &Model,
    ) -> Self {
        let on = |illuminant| {
            let contract = Contract { illuminant, ..contract.clone() };
            ModelOnGrid::new(model, &contract.on(Grid::FIT))
        };
        Self { fitter, lattice, lights: lights().map(on).to_vec() }
    }

    pub(super) fn choose(
        &self,
        mut fits: Vec<Fit>,
        watch: &dyn Watch,
    ) -> Result<Vec<Fit>, BuildError> {
        let has_choice =
            |i: &usize| fits[*i].is_matched() && fits[*i].fluorescence != Fluorescence::None;
        let fields: [Vec<usize>; 2] = (0..fits.len())
            .filter(has_choice)
            .partition(|&node| self.lattice.parity(node) == 0)
            .into();
        let stage = Stage::new("choosing", ROUNDS * (fields[0].len() + fields[1].len()), watch);
        let least: Vec<f64> = fits.iter().map(|fit| fit.fluorescence.dose()).collect();
        let mut is_asked = vec![false; fits.len()];
        for &node in fields.iter().flatten() {
            is_asked[node] = true;
            self.lattice.neighbors(node).for_each(|neighbor| is_asked[neighbor] = true);
        }
        let shifts = |(fit, asked): (&Fit, &bool)| if *asked { self.shifts(fit) } else { NONE };
        let mut shifts: Vec<Shifts> = fits.par_iter().zip(&is_asked).map(shifts).collect();
        // Which nodes changed when they were asked last; those that are never asked do not change.
        let mut moved = vec![false; fits.len()];
        fields.iter().flatten().for_each(|&node| moved[node] = true);
        for nodes in std::iter::repeat_n(&fields, ROUNDS).flatten() {
            let chosen = stage.each(nodes.len(), |k| {
                let node = nodes[k];
                let mut around = self.lattice.neighbors(node).chain([node]);
                // If nothing changed since the node was asked last, it would answer the same.
                around
                    .any(|i| moved[i])
                    .then(|| self.chosen(&fits, &shifts, node, MOST_DOSE * least[node]))
            })?;
            for (&node, chosen) in nodes.iter().zip(chosen) {
                moved[node] = chosen.is_some_and(|(fit, _)| fit != fits[node]);
                if let Some(chosen) = chosen {
                    (fits[node], shifts[node]) = chosen;
                }
            }
        }
        Ok(fits)
    }

    /// The nearest match of one node, and its shifts.
    fn chosen(
        &self,
        fits: &[Fit],
        shifts: &[Shifts],
        node: usize,
        most_dose: f64,
    ) -> (Fit, Shifts) {
        let known = fits[node];
        let around: Vec<usize> =
            self.lattice.neighbors(node).filter(|&i| fits[i].is_matched()).collect();
        let neighbors: Vec<Fit> = around.iter().map(|&i| fits[i]).collect();
        let rgb: LinearRgb = self.lattice.rgb(node);
        let distance = |of: &Shifts| around.iter().map(|&i| square(of, &shifts[i])).sum::<f64>();
        let mut best = (known, shifts[node]);
        let mut least = distance(&best.1);
        let matches = self.fitter.matches_near(rgb, known, &neighbors).into_iter();
        for candidate in matches.filter(|fit| fit.fluorescence.dose() <= most_dose) {
            let shift = self.shifts(&candidate);
            let found = distance(&shift);
            if found < least {
                (best, least) = ((candidate, shift), found);
            }
        }
        best
    }

    fn shifts(&self, fit: &Fit) -> Shifts {
        let home = fit.lab;
        let mut shifts = NONE;
        for (shift, light) in shifts.iter_mut().zip(&self.lights) {
            let lab = light.colorimetry().lab_from_xyz(light.color(fit.material()));
            *shift = [lab.l - home.l, lab.a - home.a, lab.b - home.b];
        }
        shifts
    }
}

fn square(one: &Shifts, two: &Shifts) -> f64 {
    let pairs = one.as_flattened().iter().zip(two.as_flattened());
    pairs.map(|(a, b)| (a - b) * (a - b)).sum()
}
