//! The surface of a color solid.

use std::f64::consts::PI;

use rayon::prelude::*;
use upglow_color::{ColorSolid, Xyz};

/// Points on the surface of a solid, `[polar][azimuth]`: `steps + 1` angles from the Z axis by
/// `2·steps + 1` angles around it, of which the last equals the first.
///
/// Each point is the color of the solid that lies furthest in one direction of XYZ.
pub fn solid_surface(solid: &ColorSolid, steps: usize) -> Vec<Xyz> {
    let columns = 2 * steps + 1;
    let angle = |i: usize| PI * i as f64 / steps as f64;
    (0..(steps + 1) * columns)
        .into_par_iter()
        .map(|i| {
            // The last column equals the first exactly.
            let (polar, azimuth) = (angle(i / columns), angle(i % columns % (columns - 1)));
            let around = polar.sin();
            solid.support([around * azimuth.cos(), around * azimuth.sin(), polar.cos()])
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use upglow_color::{Contract, Grid};

    #[test]
    fn points_lie_on_the_surface() {
        let colorimetry = Contract::default().on(Grid::FIT);
        let [passive, fluorescent] =
            [ColorSolid::reflectance, ColorSolid::fluorescence].map(|make| make(&colorimetry));
        let steps = 6;
        let points = solid_surface(&passive, steps);
        assert_eq!(points.len(), (steps + 1) * (2 * steps + 1));
        for point in &points {
            assert!(passive.contains(*point) && fluorescent.contains(*point), "{point:?}");
            // No reflectance reaches a point a little further from the middle of the solid.
            let middle = colorimetry.white().0.map(|v| v / 2.0);
            let beyond = [0, 1, 2].map(|k| middle[k] + 1.01 * (point.0[k] - middle[k]));
            assert!(!passive.contains(Xyz(beyond)), "{beyond:?}");
        }
    }

    #[test]
    fn the_last_column_equals_the_first() {
        let colorimetry = Contract::default().on(Grid::FIT);
        let points = solid_surface(&ColorSolid::fluorescence(&colorimetry), 4);
        for row in points.chunks(9) {
            assert_eq!(row[0], row[8]);
        }
    }
}
