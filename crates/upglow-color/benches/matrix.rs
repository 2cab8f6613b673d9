//! How long does the color of a measured matrix under a light take?

use divan::{Bencher, black_box};
use upglow_color::{BispectralUnit, DonaldsonMatrix, Illuminant, MatrixSums, Observer};

fn main() {
    divan::main();
}

/// Lights: one that is smooth, and one with lines.
const LIGHTS: [&str; 2] = ["D65", "FL11"];

/// The axes of the BFC-450: 380 to 780 nm leave, 300 to 780 nm arrive, by 10 nm.
fn matrix() -> DonaldsonMatrix {
    let axis = |first: u32| -> Vec<f64> { (first..=780).step_by(10).map(f64::from).collect() };
    let (incident, outgoing) = (axis(300), axis(380));
    let share = |out_nm: f64, in_nm: f64| match out_nm - in_nm {
        0.0 => 0.5,
        shift if shift > 0.0 => 1e-4 * (780.0 - out_nm) / shift,
        _ => 0.0,
    };
    let row = |&out_nm: &f64| incident.iter().map(|&in_nm| share(out_nm, in_nm)).collect();
    let values = outgoing.iter().map(row).collect();
    let matrix = DonaldsonMatrix::try_new(incident, outgoing, values, BispectralUnit::PerBand);
    matrix.expect("its axes ascend")
}

/// The matrix times a light that is already on its axes.
#[divan::bench(args = LIGHTS)]
fn color(bencher: Bencher<'_, '_>, light: &str) {
    let (matrix, light) = (matrix(), Illuminant::named(light).expect("it is built in"));
    let sums = MatrixSums::new(&matrix, &light, &Observer::default()).expect("it is seen");
    bencher.bench(|| sums.color(black_box(&matrix)));
}

/// The same from the light itself.
#[divan::bench(args = LIGHTS)]
fn color_of_light(bencher: Bencher<'_, '_>, light: &str) {
    let (matrix, light) = (matrix(), Illuminant::named(light).expect("it is built in"));
    let observer = Observer::default();
    bencher.bench(|| black_box(&matrix).color(&light, &observer));
}
