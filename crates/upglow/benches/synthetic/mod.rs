//! Cubes and numbers for benches, made from a seed: no fit is needed to time a look-up.

#![allow(dead_code, reason = "each bench uses its part")]

use upglow::{
    Accounting, AnalyticModel, Cube, DyeModel, DyeOptions, DyeSet, Edge, FilmModel, FitRecord,
    Fluorescence, Model, Node, QuantumYield,
};
use upglow_color::Contract;

/// How many look-ups or evaluations make one measured batch: enough that the clock is no part of
/// it, and few enough that inputs and outputs stay in the first-level cache's neighborhood.
pub(crate) const CALLS: usize = 4096;

/// Steele's `SplitMix64`.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn unit(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 40) as f32 / (1_u32 << 24) as f32
    }

    /// Any of 256 numbers.
    pub(crate) fn byte(&mut self) -> u8 {
        self.unit();
        (self.0 >> 56).to_le_bytes()[0]
    }

    pub(crate) fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.unit()
    }

    pub(crate) fn rgb(&mut self) -> [f32; 3] {
        [self.unit(), self.unit(), self.unit()]
    }

    /// A wavelength that is seen, nm.
    pub(crate) fn wavelength_nm(&mut self) -> f32 {
        self.between(380.0, 720.0)
    }
}

/// The kinds of material that cost different times.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Kind {
    /// Nothing fluoresces, as for most colors of a fitted cube.
    Passive,
    /// Every node holds two dyes of its own choice in a thin solution.
    Dyes,
    /// Every node holds a film of any two dyes: the most expensive cube there can be.
    Film,
    /// Every node holds bells of its own choice.
    Bells,
}

/// A cube of unrelated materials, the least coherent there can be.
pub(crate) fn cube(resolution: usize, kind: Kind) -> Cube {
    let model = match kind {
        Kind::Bells => Model::Analytic(AnalyticModel::default()),
        Kind::Film => {
            let set = DyeSet::named("wide8").expect("built in");
            let film = FilmModel::new(set, Accounting::Photon, QuantumYield::default());
            Model::Film(film.expect("valid"))
        }
        Kind::Passive | Kind::Dyes => {
            let set = DyeSet::named("konig8").expect("built in");
            Model::Dyes(DyeModel::new(set, DyeOptions::default()).expect("valid"))
        }
    };
    let mut random = Random(7);
    let nodes = (0..resolution.pow(3)).map(|_| {
        let reflectance = Edge {
            edge_nm: random.between(350.0, 750.0).into(),
            level: random.between(-1.5, 1.5).into(),
            slope_per_nm: random.between(-0.01, 0.01).into(),
        };
        let concentration = random.between(0.1, 1.0).into();
        let fluorescence = match kind {
            Kind::Passive => Fluorescence::None,
            Kind::Dyes => Fluorescence::Dyes {
                first: usize::from(random.byte() % 8),
                weight: random.unit().into(),
                concentration,
            },
            Kind::Film => {
                let mut dye = || (usize::from(random.byte() % 8), random.between(0.1, 3.0).into());
                Fluorescence::film(dye(), dye())
            }
            Kind::Bells => Fluorescence::Analytic {
                emission_peak_nm: random.between(400.0, 710.0).into(),
                stokes_shift_nm: random.between(10.0, 120.0).into(),
                concentration,
            },
        };
        Node::new(reflectance, fluorescence, 0.0)
    });
    Cube::new(Contract::default(), model, FitRecord::default(), resolution, nodes.collect())
        .expect("nodes are in range")
}
