//! Where a cube's blends have dye, and how much of which.

use upglow::{Cube, DyeModel};
use upglow_color::LinearRgb;

/// The dyes of a cube's nodes.
#[derive(Debug)]
pub(super) struct Doses<'c> {
    cube: &'c Cube,
    /// `[blue][green][red]`.
    nodes: Vec<NodeDose>,
}

#[derive(Clone, Copy, Debug)]
struct NodeDose {
    dose: f64,
    dyes: [(usize, f64); 2],
}

/// Use of dye in a picture.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct DyeUse {
    /// What a dose is: the sum of optical densities, or a concentration.
    pub unit: String,
    /// Share of the texels in range whose blends have dye, 0..=1.
    pub share: f64,
    /// Mean dose of those that have dye.
    pub mean_dose: f64,
    /// Greatest dose.
    pub greatest_dose: f64,
    /// The dyes that are used, from the one in most texels on. Empty for bells by formula.
    pub dyes: Vec<UsedDye>,
}

/// Use of one dye in a picture.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct UsedDye {
    /// Its name.
    pub name: String,
    /// Share of the texels in range whose blends have it, 0..=1.
    pub share: f64,
    /// Mean amount in those, in the unit of the dose.
    pub mean: f64,
    /// Greatest amount.
    pub greatest: f64,
}

/// Sums of amounts, as integers so that the order of addition does not matter.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct DyeSums {
    all: Amounts,
    /// As many as the last dye that occurred.
    dyes: Vec<Amounts>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Amounts {
    texels: u64,
    sum: u128,
    greatest: f64,
}

/// The unit of the sums of amounts: finer than the single precision of the cube.
const UNIT: f64 = 1.0 / 4_294_967_296.0;

impl<'c> Doses<'c> {
    pub(super) fn new(cube: &'c Cube) -> Self {
        let dyes = cube.model().dyes();
        let node = |index| {
            let fluorescence = cube.node_material(index).fluorescence;
            let none = [(0, 0.0); 2];
            let dyes = dyes.map_or(none, |model| fluorescence.dyes(model));
            NodeDose { dose: fluorescence.dose(), dyes }
        };
        Self { cube, nodes: (0..cube.nodes().len()).map(node).collect() }
    }

    /// The dose of a color's blend, which is added to `sums`. `None` outside 0..=1.
    pub(super) fn add(&self, rgb: LinearRgb, sums: &mut DyeSums) -> Option<f64> {
        let corners = self.cube.corners(rgb).ok()?;
        let parts = corners.map(|(index, weight)| (weight, &self.nodes[index]));
        let dose: f64 = parts.iter().map(|(weight, node)| weight * node.dose).sum();
        if dose > 0.0 {
            sums.all.add(dose);
            let of_parts = parts.iter().flat_map(|(weight, node)| {
                node.dyes.iter().map(move |(dye, amount)| (*dye, weight * amount))
            });
            sums.add_dyes(of_parts.filter(|(_, amount)| *amount > 0.0));
        }
        Some(dose)
    }

    pub(super) fn finish(&self, sums: &DyeSums, texels: u64) -> DyeUse {
        let model = self.cube.model();
        let all = sums.all.finish(texels);
        let named = |model: &DyeModel| {
            let names = model.set().dyes().iter().map(|dye| dye.name.clone());
            let used = names.zip(&sums.dyes).filter(|(_, amounts)| amounts.texels > 0);
            let mut used: Vec<_> = used.collect();
            // The sort keeps the order of dyes in as many texels.
            used.sort_by_key(|(_, amounts)| std::cmp::Reverse(amounts.texels));
            used.into_iter()
                .map(|(name, amounts)| {
                    let [share, mean, greatest] = amounts.finish(texels);
                    UsedDye { name, share, mean, greatest }
                })
                .collect()
        };
        DyeUse {
            unit: super::palette::dose_unit(model).into(),
            share: all[0],
            mean_dose: all[1],
            greatest_dose: all[2],
            dyes: model.dyes().map_or_else(Vec::new, named),
        }
    }
}

/// Dyes in a blend: those of two in each of four materials.
const IN_A_BLEND: usize = 8;

impl DyeSums {
    pub(super) fn join(&mut self, other: &Self) {
        self.all.join(&other.all);
        self.make_room(other.dyes.len());
        self.dyes.iter_mut().zip(&other.dyes).for_each(|(all, part)| all.join(part));
    }

    /// Adds the dyes of one texel; a dye of several materials of its blend counts once.
    fn add_dyes(&mut self, parts: impl Iterator<Item = (usize, f64)>) {
        let mut dyes = [(0, 0.0); IN_A_BLEND];
        let mut count = 0;
        for (dye, amount) in parts {
            let known = dyes[..count].iter().position(|(other, _)| *other == dye);
            let index = known.unwrap_or(count);
            count = count.max(index + 1);
            dyes[index] = (dye, dyes[index].1 + amount);
        }
        for &(dye, amount) in &dyes[..count] {
            self.make_room(dye + 1);
            self.dyes[dye].add(amount);
        }
    }

    fn make_room(&mut self, dyes: usize) {
        if self.dyes.len() < dyes {
            self.dyes.resize(dyes, Amounts::default());
        }
    }
}

impl Amounts {
    fn add(&mut self, amount: f64) {
        self.texels += 1;
        self.sum += u128::from(units(amount));
        self.greatest = self.greatest.max(amount);
    }

    fn join(&mut self, other: &Self) {
        self.texels += other.texels;
        self.sum += other.sum;
        self.greatest = self.greatest.max(other.greatest);
    }

    /// Share of `texels`, mean and greatest amount.
    fn finish(&self, texels: u64) -> [f64; 3] {
        let share = self.texels as f64 / texels.max(1) as f64;
        [share, self.sum as f64 * UNIT / self.texels.max(1) as f64, self.greatest]
    }
}

#[expect(clippy::cast_possible_truncation, reason = "the value is rounded first")]
#[expect(clippy::cast_sign_loss, reason = "amounts are not negative")]
fn units(amount: f64) -> u64 {
    (amount / UNIT).round() as u64
}
