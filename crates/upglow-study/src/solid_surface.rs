//! The surface of a color solid.

use std::f64::consts::PI;

use rayon::prelude::*;
use upglow_color::{ColorSolid, Xyz};

/// Points of the surface of a solid, `[polar][azimuth]`: `steps + 1` angles from the Z axis by
/// `2·steps + 1` around it, the last the first again.
///
/// Each is the color of the solid that lies furthest in one direction of XYZ, so all lie on the
/// surface, and between them the surface is no further out than the planes through them.
pub fn solid_surface(solid: &ColorSolid, steps: usize) -> Vec<Xyz> {
    let columns = 2 * steps + 1;
    let angle = |i: usize| PI * i as f64 / steps as f64;
    (0..(steps + 1) * columns)
        .into_par_iter()
        .map(|i| {
            // The last column is the first, to the last bit.
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
    fn every_point_is_in_the_solid_and_none_is_further_out() {
        let colorimetry = Contract::default().on(Grid::FIT);
        let [passive, fluorescent] =
            [ColorSolid::reflectance, ColorSolid::fluorescence].map(|make| make(&colorimetry));
        let steps = 6;
        let points = solid_surface(&passive, steps);
        assert_eq!(points.len(), (steps + 1) * (2 * steps + 1));
        for point in &points {
            assert!(passive.contains(*point) && fluorescent.contains(*point), "{point:?}");
            // A little further from the middle of the solid no reflectance reaches.
            let middle = colorimetry.white().0.map(|v| v / 2.0);
            let beyond = [0, 1, 2].map(|k| middle[k] + 1.01 * (point.0[k] - middle[k]));
            assert!(!passive.contains(Xyz(beyond)), "{beyond:?}");
        }
    }

    #[test]
    fn rows_close() {
        let colorimetry = Contract::default().on(Grid::FIT);
        let points = solid_surface(&ColorSolid::fluorescence(&colorimetry), 4);
        for row in points.chunks(9) {
            assert_eq!(row[0], row[8]);
        }
    }
}
