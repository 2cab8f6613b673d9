//! Colors under generated lamps with lines, against sums over 0.05 nm.

#![expect(clippy::unwrap_used, reason = "a test may panic")]

use upglow::{
    Bispectral, DyeModel, DyeOptions, DyeSet, Edge, Fluorescence, Material, Mixture, Model,
    ModelOnGrid,
};
use upglow_color::rounding::whole;
use upglow_color::{Contract, Grid, Illuminant, Lab, Observer, Xyz, ciede2000, lab_from_xyz};

/// Random numbers, `splitmix`.
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }
}

/// Gaussian lines on a constant background.
struct Lamp {
    /// Wavelength (nm), full width at half maximum (nm) and power.
    lines: Vec<[f64; 3]>,
    background_per_nm: f64,
}

impl Lamp {
    /// Three to eight lines.
    fn random(random: &mut Random, widths_nm: [f64; 2], background_per_nm: f64) -> Self {
        let line = |random: &mut Random| {
            let peak_nm = random.between(390.0, 680.0);
            [peak_nm, random.between(widths_nm[0], widths_nm[1]), random.between(20.0, 200.0)]
        };
        let count = 3 + whole(6.0 * random.unit());
        Self { lines: (0..count).map(|_| line(random)).collect(), background_per_nm }
    }

    fn power(&self, nm: f64) -> f64 {
        let exponent = 4.0 * 2f64.ln();
        let unit_area = (exponent / std::f64::consts::PI).sqrt();
        let line = |&[peak_nm, fwhm_nm, power]: &[f64; 3]| {
            power * unit_area / fwhm_nm * (-exponent * ((nm - peak_nm) / fwhm_nm).powi(2)).exp()
        };
        self.background_per_nm + self.lines.iter().map(line).sum::<f64>()
    }

    /// The light with samples at these wavelengths, on the contract's other defaults.
    fn contract(&self, nm: &[f64]) -> Contract {
        let power: Vec<f64> = nm.iter().map(|&nm| self.power(nm)).collect();
        let illuminant = Illuminant::from_samples("lamp", nm, &power, None).unwrap();
        Contract { illuminant, ..Contract::default() }
    }
}

fn every(step_nm: f64) -> Vec<f64> {
    let count = whole((530.0 / step_nm).round());
    (0..=count).map(|i| 300.0 + 530.0 * i as f64 / count as f64).collect()
}

fn model() -> Model {
    let set = DyeSet::named("konig8").unwrap();
    Model::Dyes(DyeModel::new(set, DyeOptions::default()).unwrap())
}

/// A reflectance, in every second material behind a dye.
fn material(random: &mut Random, slope_max_per_nm: f64) -> Material {
    let edge = Edge {
        edge_nm: random.between(400.0, 700.0),
        level: random.between(-2.0, 2.0),
        slope_per_nm: random.between(-slope_max_per_nm, slope_max_per_nm),
    };
    let dye = Fluorescence::Dyes {
        first: whole(8.0 * random.unit()),
        weight: 0.0,
        concentration: random.unit(),
    };
    let fluorescence = if random.unit() < 0.5 { dye } else { Fluorescence::None };
    Material { reflectance: edge.to_sigmoid(), fluorescence }
}

/// The color of a material by sums over 0.05 nm.
fn reference(lamp: &Lamp, model: &Model, material: Material) -> Lab {
    let Model::Dyes(dyes) = model else { unreachable!() };
    let mixture = Mixture::of(model, material);
    let observer = Observer::default();
    let (mut white, mut reflected, mut emitted) = (Xyz::default(), Xyz::default(), Xyz::default());
    let (mut absorbed, mut area) = (0.0, 0.0);
    for nm in every(0.05) {
        let seen = Xyz(observer.matching().each_ref().map(|curve| curve.at(nm)));
        let power = lamp.power(nm);
        white += power * seen;
        reflected += power * mixture.reflectance(nm) * seen;
        if let Fluorescence::Dyes { first, concentration, .. } = material.fluorescence {
            let curves = &dyes.curves()[first];
            absorbed += power * concentration * curves.absorption.at(nm);
            emitted += curves.emission.at(nm) * seen;
            area += curves.emission.at(nm);
        }
    }
    let color = if area > 0.0 { reflected + absorbed / area * emitted } else { reflected };
    lab_from_xyz(color, white)
}

/// CIEDE2000 of materials under a contract against others, by sums over a grid.
fn differences(contract: &Contract, grid: Grid, colors: &[(Material, Lab)]) -> Vec<f64> {
    let colorimetry = contract.on(grid);
    let sums = ModelOnGrid::new(&model(), &colorimetry);
    let shown = |material| colorimetry.lab_from_xyz(sums.color(material));
    colors.iter().map(|&(material, lab)| ciede2000(lab, shown(material))).collect()
}

/// Widths of lines (nm), the step (nm) that resolves them, and the background.
const LAMPS: [([f64; 2], f64, f64); 5] = [
    ([0.2, 1.0], 0.05, 0.02),
    ([0.2, 1.0], 0.05, 3.0),
    ([1.0, 2.0], 0.25, 0.5),
    ([2.0, 6.0], 1.0, 0.02),
    ([2.0, 6.0], 1.0, 3.0),
];

#[test]
fn colors_under_lamps_with_lines_are_those_of_fine_sums() {
    // Greatest slope of reflectances, 1/nm, and mean and greatest CIEDE2000 of sums over the 107
    // wavelengths of a 5 nm grid and over 1 nm. Reflectances are not straight between them, and dark
    // colors of single lines count such errors most. Sampling the lamps at 5 nm errs by up to 95.
    const LIMITS: [(f64, [[f64; 2]; 2]); 2] =
        [(0.01, [[0.03, 0.3], [0.03, 0.1]]), (0.05, [[0.06, 1.5], [0.06, 0.6]])];
    let model = model();
    let mut random = Random(7);
    for (widths_nm, step_nm, background) in LAMPS {
        for (slope_max_per_nm, limits) in LIMITS {
            let mut found = [Vec::new(), Vec::new()];
            for _ in 0..8 {
                let lamp = Lamp::random(&mut random, widths_nm, background);
                let materials = (0..16).map(|_| material(&mut random, slope_max_per_nm));
                let colors: Vec<_> = materials.map(|m| (m, reference(&lamp, &model, m))).collect();
                let contract = lamp.contract(&every(step_nm));
                for (found, grid) in found.iter_mut().zip([Grid::FIT, Grid::FINE]) {
                    found.extend(differences(&contract, grid, &colors));
                }
            }
            for (found, [mean, most]) in found.into_iter().zip(limits) {
                let worst = found.iter().copied().fold(0.0, f64::max);
                let average = found.iter().sum::<f64>() / found.len() as f64;
                println!("{widths_nm:?} {background} {slope_max_per_nm} {average:.3} {worst:.3}");
                assert!(average < mean && worst < most, "{widths_nm:?} {slope_max_per_nm}");
            }
        }
    }
}

#[test]
fn a_lamp_has_the_same_colors_however_its_lines_are_sampled() {
    // Straight lines between samples of 1/20 to 1/4 of a line's width.
    const INTERPOLATION: f64 = 0.05;
    let model = model();
    let mut random = Random(11);
    for _ in 0..4 {
        let lamp = Lamp::random(&mut random, [1.0, 2.0], 0.5);
        let mut irregular = vec![300.0];
        while irregular[irregular.len() - 1] < 830.0 {
            irregular.push(irregular[irregular.len() - 1] + random.between(0.05, 0.25));
        }
        let dense = lamp.contract(&every(0.05));
        let colorimetry = dense.on(Grid::FIT);
        let sums = ModelOnGrid::new(&model, &colorimetry);
        let colors: Vec<_> = (0..32)
            .map(|_| material(&mut random, 0.01))
            .map(|m| (m, colorimetry.lab_from_xyz(sums.color(m))))
            .collect();
        for nm in [every(0.1), every(0.25), irregular] {
            let found = differences(&lamp.contract(&nm), Grid::FIT, &colors);
            let worst = found.into_iter().fold(0.0, f64::max);
            println!("{worst:.3}");
            assert!(worst < INTERPOLATION, "{worst}");
        }
    }
}
