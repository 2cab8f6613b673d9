//! The spectra of a mixture at every nanometer, and its colors by sums over them.
//!
//! This works on whole arrays and shares no formula with the run-time library, which evaluates one
//! wavelength at a time. Each run compares the two for some colors.

use std::f64::consts::LN_10;

use upglow::{Accounting, DyeCurves, DyeModel, Fluorescence, Material, Mixing, Model, Sigmoid};
use upglow_color::rounding::whole;
use upglow_color::{Colorimetry, Contract, Grid, Xyz};

/// Wavelengths of [`Grid::FINE`].
const FINE: usize = Grid::FINE.len();

/// One number for each wavelength of [`Grid::FINE`].
pub(super) type Samples = [f64; FINE];

/// A contract and a model on both grids.
pub(super) struct Sampler<'m> {
    model: &'m Model,
    /// Sums over 1 nm.
    pub(super) fine: StridedSums,
    /// Sums over 5 nm.
    pub(super) fit: StridedSums,
    pub(super) wavelengths_nm: Box<Samples>,
    dyes: Vec<SampledDye>,
}

/// Sums over some of the samples of [`Grid::FINE`].
pub(super) struct StridedSums {
    pub(super) colorimetry: Colorimetry,
    /// The samples of incident light.
    incident: Vec<usize>,
    /// Every how many samples there is one of emitted light.
    stride: usize,
    /// Which entry of a [`Stimulus`] it makes.
    index: usize,
}

struct SampledDye {
    /// Absorptance at concentration 1.
    absorption: Box<Samples>,
    /// Color of one unit of emitted energy.
    stimulus: Stimulus,
    quantum_yield: f64,
    mean_emission_nm: f64,
}

/// A color by sums over 1 nm and over 5 nm.
type Stimulus = [Xyz; 2];

/// The spectra of a mixture, and the color of its emission under the contract's light.
pub(super) struct Spectra {
    /// The mean of the parts' sigmoids, the reflectance r if nothing fluoresced.
    pub(super) reflectance: Box<Samples>,
    /// dr/dλ, 1/nm.
    pub(super) slope_per_nm: Box<Samples>,
    /// Share of light reflected at its own wavelength: r, less what is absorbed.
    pub(super) reflected: Box<Samples>,
    /// Share of light re-radiated at other wavelengths.
    pub(super) returned: Box<Samples>,
    emitted: Stimulus,
    /// Scratch space for one part: its sigmoid, what it absorbs in all, and what one lobe absorbs.
    sigmoid: Box<Samples>,
    absorbed: Box<Samples>,
    lobe_absorbed: Box<Samples>,
}

/// One absorber and one emitter.
struct Lobe {
    absorber: Absorber,
    strength: f64,
    quantum_yield: f64,
    accounting: Accounting,
    mean_emission_nm: f64,
    stimulus: Stimulus,
}

enum Absorber {
    Dyes {
        first: usize,
        second: usize,
        weight: f64,
    },
    /// A dye in a film together with another, each with its optical density.
    InFilm {
        own: (usize, f64),
        other: (usize, f64),
    },
    Bell {
        center_nm: f64,
    },
}

fn zeros() -> Box<Samples> {
    Box::new([0.0; FINE])
}

fn sampled(values: impl IntoIterator<Item = f64>) -> Box<Samples> {
    let mut samples = zeros();
    samples.iter_mut().zip(values).for_each(|(sample, value)| *sample = value);
    samples
}

impl StridedSums {
    fn new(contract: &Contract, grid: Grid, index: usize) -> Self {
        let stride = (grid.step_nm() / Grid::FINE.step_nm()) as usize;
        let colorimetry = contract.on(grid);
        let sample = |&nm: &f64| whole(nm - f64::from(Grid::FINE.first_nm()));
        let incident = colorimetry.wavelengths_nm().iter().map(sample).collect();
        Self { colorimetry, incident, stride, index }
    }

    /// The color of a reflectance.
    fn reflected(&self, share: &Samples) -> Xyz {
        self.colorimetry.xyz_from_reflectance(self.incident.iter().map(|&i| share[i]))
    }

    /// The energy of these shares of the incident light.
    fn energy(&self, share: &Samples) -> f64 {
        let light = self.colorimetry.irradiance();
        self.incident.iter().zip(light).map(|(&i, e)| share[i] * e).sum()
    }

    /// The color of one unit of energy with this spectrum; `unit` is the sum of the samples.
    fn emission(&self, samples: &[f64], unit: f64) -> Xyz {
        let bands = samples.iter().step_by(self.stride).zip(self.colorimetry.matching());
        bands.map(|(e, m)| *e * Xyz(*m)).sum::<Xyz>() / unit
    }
}

impl SampledDye {
    fn new(curves: &DyeCurves, fine: &StridedSums, fit: &StridedSums) -> Self {
        let emission = curves.emission.values();
        let stimulus = |sums: &StridedSums| {
            // The sum over the grid instead of the exact area, so that a dye emits exactly its yield.
            let area = emission.iter().step_by(sums.stride).sum();
            sums.emission(emission, area)
        };
        Self {
            absorption: sampled(curves.absorption.values().iter().copied()),
            stimulus: [fine, fit].map(stimulus),
            quantum_yield: curves.quantum_yield,
            mean_emission_nm: curves.mean_emission_nm,
        }
    }
}

impl<'m> Sampler<'m> {
    pub(super) fn new(contract: &Contract, model: &'m Model) -> Self {
        let (fine, fit) =
            (StridedSums::new(contract, Grid::FINE, 0), StridedSums::new(contract, Grid::FIT, 1));
        let curves = model.dyes().map_or(&[][..], DyeModel::curves);
        let dyes = curves.iter().map(|c| SampledDye::new(c, &fine, &fit)).collect();
        Self { model, fine, fit, wavelengths_nm: sampled(Grid::FINE.wavelengths_nm()), dyes }
    }

    /// Computes the spectra of the mixture of `parts`.
    pub(super) fn sample(
        &self,
        parts: impl Iterator<Item = (f64, Material)>,
        spectra: &mut Spectra,
    ) {
        spectra.clear();
        for (weight, material) in parts {
            spectra.add_reflectance(weight, material.reflectance, &self.wavelengths_nm);
            spectra.absorbed.fill(0.0);
            for lobe in self.lobes(material.fluorescence).into_iter().flatten() {
                self.add_lobe(weight, &lobe, spectra);
            }
            spectra.add_reflected(weight);
        }
    }

    fn add_lobe(&self, weight: f64, lobe: &Lobe, spectra: &mut Spectra) {
        self.fill_absorbed(lobe, &mut spectra.lobe_absorbed);
        for i in 0..FINE {
            let taken = spectra.lobe_absorbed[i];
            spectra.absorbed[i] += taken;
            let given = taken * lobe.quantum_yield * lobe.share(self.wavelengths_nm[i]);
            spectra.lobe_absorbed[i] = given;
            spectra.returned[i] += weight * given;
        }
        for sums in [&self.fine, &self.fit] {
            let energy = weight * sums.energy(&spectra.lobe_absorbed);
            spectra.emitted[sums.index] += energy * lobe.stimulus[sums.index];
        }
    }

    fn fill_absorbed(&self, lobe: &Lobe, absorbed: &mut Samples) {
        match (&lobe.absorber, self.model) {
            (&Absorber::Dyes { first, second, weight }, _) => {
                let (a, b) = (&self.dyes[first].absorption, &self.dyes[second].absorption);
                for i in 0..FINE {
                    absorbed[i] = lobe.strength * ((1.0 - weight) * a[i] + weight * b[i]);
                }
            }
            (&Absorber::InFilm { own: (dye, density), other: (other, other_density) }, _) => {
                let (a, b) = (&self.dyes[dye].absorption, &self.dyes[other].absorption);
                for i in 0..FINE {
                    let own = density * a[i];
                    absorbed[i] = lobe.strength * absorbed_in_film(own, other_density * b[i]);
                }
            }
            (&Absorber::Bell { center_nm }, Model::Analytic(model)) => {
                for i in 0..FINE {
                    let (share, _) = model.absorption(center_nm, self.wavelengths_nm[i]);
                    absorbed[i] = lobe.strength * share;
                }
            }
            (Absorber::Bell { .. }, _) => absorbed.fill(0.0),
        }
    }

    /// The lobes of a fluorescence, up to two.
    fn lobes(&self, fluorescence: Fluorescence) -> [Option<Lobe>; 2] {
        match (fluorescence, self.model) {
            (Fluorescence::Dyes { first, weight, concentration }, Model::Dyes(model)) => {
                match model.options().mixing {
                    Mixing::Pooled => {
                        [Some(self.pooled_lobe(model, first, weight, concentration)), None]
                    }
                    Mixing::Separate => [
                        Some(self.lone_lobe(model, first, concentration * (1.0 - weight))),
                        Some(self.lone_lobe(model, model.partner(first), concentration * weight)),
                    ],
                }
            }
            (
                Fluorescence::Film { dyes: [first, second], densities: [most, least] },
                Model::Film(film),
            ) => {
                let dyes = [(first, most), (second, least)];
                let lobe = |own: (usize, f64), other| {
                    let absorber = Absorber::InFilm { own, other };
                    (own.1 > 0.0).then(|| self.lobe_of_dye(film.dyes(), own.0, absorber, 1.0))
                };
                [lobe(dyes[0], dyes[1]), lobe(dyes[1], dyes[0])]
            }
            (
                Fluorescence::Analytic { emission_peak_nm, stokes_shift_nm, concentration },
                Model::Analytic(_),
            ) => [self.bell_lobe(emission_peak_nm, stokes_shift_nm, concentration), None],
            _ => [None, None],
        }
    }

    fn pooled_lobe(&self, model: &DyeModel, first: usize, weight: f64, strength: f64) -> Lobe {
        let second = model.partner(first);
        let (a, b) = (&self.dyes[first], &self.dyes[second]);
        let mix = |x: f64, y: f64| (1.0 - weight) * x + weight * y;
        Lobe {
            absorber: Absorber::Dyes { first, second, weight },
            strength,
            quantum_yield: mix(a.quantum_yield, b.quantum_yield),
            accounting: model.options().accounting,
            mean_emission_nm: mix(a.mean_emission_nm, b.mean_emission_nm),
            stimulus: [0, 1].map(|i| (1.0 - weight) * a.stimulus[i] + weight * b.stimulus[i]),
        }
    }

    fn lone_lobe(&self, model: &DyeModel, dye: usize, strength: f64) -> Lobe {
        let absorber = Absorber::Dyes { first: dye, second: dye, weight: 0.0 };
        self.lobe_of_dye(model, dye, absorber, strength)
    }

    fn lobe_of_dye(&self, model: &DyeModel, dye: usize, absorber: Absorber, strength: f64) -> Lobe {
        let sampled = &self.dyes[dye];
        Lobe {
            absorber,
            strength,
            quantum_yield: sampled.quantum_yield,
            accounting: model.options().accounting,
            mean_emission_nm: sampled.mean_emission_nm,
            stimulus: sampled.stimulus,
        }
    }

    fn bell_lobe(&self, peak_nm: f64, stokes_shift_nm: f64, strength: f64) -> Option<Lobe> {
        let Model::Analytic(model) = self.model else { return None };
        let emission = self.wavelengths_nm.map(|nm| model.emission(peak_nm, nm).0);
        let stimulus = |sums: &StridedSums| sums.emission(&emission, 1.0 / sums.stride as f64);
        Some(Lobe {
            absorber: Absorber::Bell { center_nm: peak_nm - stokes_shift_nm },
            strength,
            quantum_yield: model.quantum_yield(),
            accounting: model.accounting(),
            mean_emission_nm: peak_nm,
            stimulus: [&self.fine, &self.fit].map(stimulus),
        })
    }
}

/// What a part of a film with the optical density `own` absorbs beside one with the density `other`:
/// its share of the light that does not pass.
fn absorbed_in_film(own: f64, other: f64) -> f64 {
    match own + other {
        0.0 => 0.0,
        density => own / density * -(-LN_10 * density).exp_m1(),
    }
}

impl Lobe {
    /// The share of absorbed energy that can be re-radiated at a quantum yield of 1.
    fn share(&self, lambda_nm: f64) -> f64 {
        match self.accounting {
            Accounting::Energy => 1.0,
            Accounting::Photon => (lambda_nm / self.mean_emission_nm).min(1.0),
        }
    }
}

impl Spectra {
    pub(super) fn new() -> Self {
        Self {
            reflectance: zeros(),
            slope_per_nm: zeros(),
            reflected: zeros(),
            returned: zeros(),
            emitted: Stimulus::default(),
            sigmoid: zeros(),
            absorbed: zeros(),
            lobe_absorbed: zeros(),
        }
    }

    fn clear(&mut self) {
        self.reflectance.fill(0.0);
        self.slope_per_nm.fill(0.0);
        self.reflected.fill(0.0);
        self.returned.fill(0.0);
        self.emitted = Stimulus::default();
    }

    fn add_reflectance(&mut self, weight: f64, sigmoid: Sigmoid, wavelengths_nm: &Samples) {
        let Sigmoid { c0, c1, c2 } = sigmoid;
        let (sigmoids, sum) = (&mut *self.sigmoid, &mut *self.reflectance);
        let slope = &mut *self.slope_per_nm;
        for i in 0..FINE {
            let nm = wavelengths_nm[i];
            let x = (c0 * nm + c1) * nm + c2;
            let flatness = 1.0 + x * x;
            let root = flatness.sqrt();
            let r = 0.5 + 0.5 * x / root;
            sigmoids[i] = r;
            sum[i] += weight * r;
            slope[i] += weight * 0.5 * (2.0 * c0 * nm + c1) / (flatness * root);
        }
    }

    fn add_reflected(&mut self, weight: f64) {
        let (reflected, sigmoid) = (&mut *self.reflected, &*self.sigmoid);
        let absorbed = &*self.absorbed;
        for i in 0..FINE {
            reflected[i] += weight * (1.0 - absorbed[i]) * sigmoid[i];
        }
    }

    /// The color under the contract's light.
    pub(super) fn color(&self, sums: &StridedSums) -> Xyz {
        sums.reflected(&self.reflected) + self.emitted[sums.index]
    }

    /// Share of the light of each wavelength that is reflected or re-radiated.
    pub(super) fn albedo(&self) -> impl Iterator<Item = f64> + '_ {
        self.reflected.iter().zip(self.returned.iter()).map(|(a, b)| a + b)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use upglow::{
        AnalyticModel, Bispectral, DyeOptions, DyeSet, Features, FilmModel, Mixture, ModelOnGrid,
        QuantumYield,
    };

    /// Rounding only: sums of 531 numbers of at most 1.
    const ROUNDING: f64 = 1e-12;

    fn models() -> Vec<Model> {
        let mut models = vec![
            Model::Reflectance,
            Model::Analytic(AnalyticModel::new(50.0, 45.0, Accounting::Photon, 0.7).unwrap()),
        ];
        for accounting in [Accounting::Energy, Accounting::Photon] {
            for mixing in [Mixing::Pooled, Mixing::Separate] {
                let quantum_yield = QuantumYield::Measured;
                let optical_density = Some(4.0);
                let options = DyeOptions { accounting, mixing, quantum_yield, optical_density };
                let set = DyeSet::named("konig8").unwrap();
                models.push(Model::Dyes(DyeModel::new(set, options).unwrap()));
            }
            let set = DyeSet::named("konig8").unwrap();
            let film = FilmModel::new(set, accounting, QuantumYield::Measured).unwrap();
            models.push(Model::Film(film));
        }
        models
    }

    fn material(model: &Model) -> Material {
        let shape = Features { shift_nm: 520.0, width_nm: 40.0, slope_per_nm: -0.009 };
        let fluorescence = match model {
            Model::Reflectance => Fluorescence::None,
            Model::Dyes(_) => Fluorescence::Dyes { first: 7, weight: 0.3, concentration: 0.9 },
            Model::Film(_) => Fluorescence::film((5, 0.3), (2, 4.0)),
            Model::Analytic(_) => Fluorescence::Analytic {
                emission_peak_nm: 611.3,
                stokes_shift_nm: 47.7,
                concentration: 0.8,
            },
        };
        Material { reflectance: shape.to_sigmoid().unwrap(), fluorescence }
    }

    #[test]
    fn spectra_and_colors_are_those_of_the_run_time_library() {
        let contract = Contract::default();
        for model in models() {
            let sampler = Sampler::new(&contract, &model);
            let mixture = Mixture::of(&model, material(&model));
            let mut spectra = Spectra::new();
            sampler.sample(mixture.parts(), &mut spectra);
            for (i, nm) in Grid::FINE.wavelengths_nm().enumerate() {
                let albedo = spectra.reflected[i] + spectra.returned[i];
                assert!((spectra.reflected[i] - mixture.reflectance(nm)).abs() < ROUNDING);
                assert!((albedo - mixture.albedo(nm)).abs() < ROUNDING, "{nm} nm");
            }
            for sums in [&sampler.fine, &sampler.fit] {
                let color = spectra.color(sums);
                let expected = mixture.color(&ModelOnGrid::new(&model, &sums.colorimetry));
                for k in 0..3 {
                    let error = (color.0[k] - expected.0[k]).abs();
                    assert!(error < ROUNDING, "{} {error:e}", model.name());
                }
            }
        }
    }

    #[test]
    fn slopes_are_those_of_the_sigmoid() {
        let model = Model::Reflectance;
        let sampler = Sampler::new(&Contract::default(), &model);
        let sigmoid = material(&model).reflectance;
        let mut spectra = Spectra::new();
        sampler.sample([(1.0, Material::passive(sigmoid))].into_iter(), &mut spectra);
        for (slope, nm) in spectra.slope_per_nm.iter().zip(Grid::FINE.wavelengths_nm()) {
            assert!((slope - sigmoid.slope_per_nm(nm)).abs() < ROUNDING);
        }
    }
}
