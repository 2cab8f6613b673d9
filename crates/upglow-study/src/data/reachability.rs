//! What any material can show of an RGB space.

use rayon::prelude::*;
use upglow_color::{ColorSolid, Colorimetry, Contract, Grid, LinearRgb};

/// What it takes to show a color.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Reach {
    /// Some reflectance shows it.
    Reflectance,
    /// No reflectance does, but some fluorescent material.
    Fluorescence,
    /// No material does.
    Nothing,
}

impl Reach {
    /// All of them, in the order of [`shares`].
    pub const ALL: [Self; 3] = [Self::Reflectance, Self::Fluorescence, Self::Nothing];
}

/// The limits of all materials under a contract: exact, and slower than a
/// [`StandingTable`](upglow_fit::StandingTable). They know no slope limit and no dyes, and count photons.
#[derive(Clone, Debug)]
pub struct Reachability {
    colorimetry: Colorimetry,
    reflectance: ColorSolid,
    fluorescence: ColorSolid,
}

impl Reachability {
    /// The limits under a contract, by sums over 5 nm.
    pub fn of(contract: &Contract) -> Self {
        let colorimetry = contract.on(Grid::FIT);
        let reflectance = ColorSolid::reflectance(&colorimetry);
        let fluorescence = ColorSolid::fluorescence(&colorimetry);
        Self { colorimetry, reflectance, fluorescence }
    }

    /// What it takes to show a color; any finite numbers.
    pub fn reach(&self, rgb: LinearRgb) -> Reach {
        let color = self.colorimetry.xyz_from_rgb(rgb);
        if self.reflectance.contains(color) {
            Reach::Reflectance
        } else if self.fluorescence.contains(color) {
            Reach::Fluorescence
        } else {
            Reach::Nothing
        }
    }

    /// What it takes to show `side`² colors at one blue, `[green][red]`: point i of an axis stands for
    /// i / (side − 1).
    pub fn layer(&self, blue: f64, side: usize) -> Vec<Reach> {
        let last = (side - 1) as f64;
        (0..side * side)
            .into_par_iter()
            .map(|i| {
                let [red, green] = [i % side, i / side].map(|k| k as f64 / last);
                self.reach(LinearRgb([red, green, blue]))
            })
            .collect()
    }
}

/// Shares of each [`Reach`], in the order of [`Reach::ALL`].
pub fn shares<'r>(reaches: impl IntoIterator<Item = &'r Reach>) -> [f64; 3] {
    let mut counts = [0.0; 3];
    reaches.into_iter().for_each(|&reach| counts[reach as usize] += 1.0);
    let all: f64 = counts.iter().sum();
    counts.map(|count| count / all)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_brown_a_magenta_and_a_green_differ_in_what_they_take() {
        let limits = Reachability::of(&Contract::default());
        let found = [[0.35, 0.2, 0.1], [0.9, 0.0, 0.9], [0.0, 1.0, 0.0]]
            .map(|rgb| limits.reach(LinearRgb(rgb)));
        assert_eq!(found, Reach::ALL);
    }

    #[test]
    fn layers_start_with_black_and_run_along_red() {
        let limits = Reachability::of(&Contract::default());
        let layer = limits.layer(0.0, 2);
        assert_eq!(layer[0], limits.reach(LinearRgb([0.0; 3])));
        assert_eq!(layer[1], limits.reach(LinearRgb([1.0, 0.0, 0.0])));
        assert_eq!(shares(&[Reach::Nothing, Reach::Reflectance]), [0.5, 0.0, 0.5]);
    }
}
