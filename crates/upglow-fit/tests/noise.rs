//! How much more noise the draws of incident wavelengths have than draws in proportion to what returns.
#![expect(clippy::unwrap_used, reason = "a test that cannot start has failed")]

use upglow::{Bispectral, Interpolation, Mixture};
use upglow_color::{Contract, Illuminant};
use upglow_fit::{Preset, Unwatched, build_cube, random_rgb};

/// Incident wavelengths, nm; a step of 1 nm.
const INCIDENT_NM: std::ops::RangeInclusive<u32> = 300..=830;

/// Mean squares of what one draw brings from a light: of the material's draws, and of draws in proportion to
/// what returns, whose throughput is always the same. Less the square of the mean, these are variances.
struct Noise {
    mean: f64,
    drawn: f64,
    proportional: f64,
}

impl Noise {
    fn of(material: &Mixture<'_>, light: &Illuminant, out_nm: f64) -> Self {
        let power = |nm: f64| light.power().at(nm) / light.power().peak();
        let reflected = material.reflectance(out_nm);
        let elastic = material.incident_elastic_probability(out_nm);
        let (mut mean, mut all) = (reflected * power(out_nm), reflected);
        let mut drawn = if elastic > 0.0 { mean * mean / elastic } else { 0.0 };
        let mut squares = mean * power(out_nm);
        for in_nm in INCIDENT_NM.map(f64::from) {
            let moved = material.reradiation_per_nm(in_nm, out_nm);
            if moved == 0.0 {
                continue;
            }
            let (brought, pdf) =
                (moved * power(in_nm), material.incident_pdf_per_nm(in_nm, out_nm));
            assert!(pdf > 0.0, "light of {in_nm} nm returns and is never drawn");
            mean += brought;
            all += moved;
            drawn += brought * brought / pdf;
            squares += brought * power(in_nm);
        }
        Self { mean, drawn, proportional: all * squares }
    }
}

/// The ratio of two standard deviations relative to the mean, over random colors that fluoresce.
fn ratio(preset: Preset, light: &Illuminant) -> f64 {
    let options = preset.options();
    let cube = build_cube(&Contract::default(), &preset.model(), options, 9, &Unwatched).unwrap();
    let (mut drawn, mut proportional) = (0.0, 0.0);
    for index in 0..1000 {
        let mixture = cube.lookup(random_rgb(5, index), Interpolation::Blend).unwrap();
        for out_nm in (440..=680).step_by(20).map(f64::from) {
            let noise = Noise::of(&mixture, light, out_nm);
            if noise.mean > 1e-3 && noise.mean > mixture.reflectance(out_nm) * 1.01 {
                let square = noise.mean * noise.mean;
                drawn += noise.drawn / square - 1.0;
                proportional += noise.proportional / square - 1.0;
            }
        }
    }
    (drawn / proportional).sqrt()
}

#[test]
fn draws_are_hardly_noisier_than_in_proportion_to_what_returns() {
    for preset in [Preset::Natural] {
        for light in ["D65", "A"] {
            let ratio = ratio(preset, &Illuminant::named(light).unwrap());
            println!("{preset} {light} {ratio:.3}");
            assert!(ratio < 1.1, "{preset} under {light}: {ratio}");
        }
    }
}
