//! Which colors of an RGB space any material can match.

use rayon::prelude::*;
use upglow_color::{ColorSolids, Contract, Grid, LinearRgb, StandingKind};

/// Whether `side`² colors at one blue can be matched by a reflectance, only with fluorescence, or not
/// at all, `[green][red]`; point i of an axis is at i / (side − 1). Each color is searched for exactly.
pub fn standing_layer(contract: &Contract, blue: f64, side: usize) -> Vec<StandingKind> {
    let colorimetry = contract.on(Grid::FIT);
    let solids = ColorSolids::new(&colorimetry);
    let last = (side - 1) as f64;
    (0..side * side)
        .into_par_iter()
        .map(|i| {
            let [red, green] = [i % side, i / side].map(|k| k as f64 / last);
            solids.kind(colorimetry.xyz_from_rgb(LinearRgb([red, green, blue])))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn layers_run_along_red_first() {
        use StandingKind::{NeedsFluorescence, Reflectance, Unreachable};
        let magentas = standing_layer(&Contract::default(), 0.9, 11);
        assert_eq!(magentas[9], NeedsFluorescence);
        let layer = standing_layer(&Contract::default(), 0.0, 2);
        assert_eq!((layer[0], layer[2]), (Reflectance, Unreachable));
        let browns = standing_layer(&Contract::default(), 0.1, 21);
        assert_eq!(browns[4 * 21 + 7], Reflectance);
    }
}
