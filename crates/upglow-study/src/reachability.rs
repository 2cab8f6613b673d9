//! What any material can show of an RGB space.

use rayon::prelude::*;
use upglow_color::{ColorSolids, Contract, Grid, LinearRgb, StandingKind};

/// What it takes to show `side`² colors at one blue, `[green][red]`: point i of an axis stands for
/// i / (side − 1). By a search for each color, which is exact.
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
    fn layers_start_with_black_and_run_along_red_then_green() {
        use StandingKind::{NeedsFluorescence, Reflectance, Unreachable};
        let magentas = standing_layer(&Contract::default(), 0.9, 11);
        assert_eq!(magentas[9], NeedsFluorescence);
        let layer = standing_layer(&Contract::default(), 0.0, 2);
        assert_eq!((layer[0], layer[2]), (Reflectance, Unreachable));
        let browns = standing_layer(&Contract::default(), 0.1, 21);
        assert_eq!(browns[4 * 21 + 7], Reflectance);
    }
}
