//! How long does it take to see many colors under many lights?

use std::sync::LazyLock;

use divan::{Bencher, black_box};
use upglow::Cube;
use upglow_color::{Contract, Illuminant, LinearRgb, Observer};
use upglow_fit::{Preset, Relighting, Unwatched, build_cube, random_rgb};

fn main() {
    divan::main();
}

const COLORS: usize = 100_000;

const LIGHTS: [&str; 10] = ["D65", "D50", "D55", "D75", "A", "E", "FL2", "FL11", "HP1", "LED-B3"];

static CUBE: LazyLock<Cube> = LazyLock::new(|| {
    let (model, options) = (Preset::Natural.model(), Preset::Natural.options());
    let cube = build_cube(&Contract::default(), &model, options, 32, &Unwatched);
    cube.expect("nobody stops it")
});

/// Colors of the default cube under ten lights, with all that `upglow relight` says of them.
#[divan::bench(sample_count = 5, sample_size = 1)]
fn colors_under_ten_lights(bencher: Bencher<'_, '_>) {
    let lights = LIGHTS.map(|name| Illuminant::named(name).expect("it is built in"));
    let colors: Vec<LinearRgb> = (0..COLORS).map(|i| random_rgb(1, i)).collect();
    let observer = Observer::default();
    LazyLock::force(&CUBE);
    bencher.bench(|| {
        let relighting = Relighting::of_colors(&CUBE, &colors).expect("they are in the cube");
        let seen_by = relighting.seen_by(&observer).expect("its light is seen");
        lights.iter().for_each(|light| drop(black_box(seen_by.under(light))));
    });
}
