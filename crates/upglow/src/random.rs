//! Pseudo-random materials for tests, and the test that draws have the density they claim.

use crate::*;

/// A generator whose sequence is its seed's.
#[derive(Clone, Debug)]
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed)
    }

    /// The next number in 0..1, by Steele's `SplitMix64`.
    pub(crate) fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// One of the first `count` numbers.
    pub(crate) fn below(&mut self, count: usize) -> usize {
        place(self.unit() * count as f64)
    }

    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// A node that is valid under `model`; one in four does not fluoresce.
    pub(crate) fn node(&mut self, model: &Model) -> Node {
        let reflectance = Edge {
            edge_nm: self.between(350.0, 750.0),
            level: self.between(-2.5, 2.5),
            slope_per_nm: self.between(-0.02, 0.02),
        };
        let concentration = (self.between(-0.33, 1.0)).max(0.0);
        let fluorescence = match model {
            _ if concentration == 0.0 => Fluorescence::None,
            Model::Reflectance => Fluorescence::None,
            Model::Dyes(model) => Fluorescence::Dyes {
                first: self.below(model.curves().len()),
                weight: self.unit(),
                concentration,
            },
            Model::Film(model) => {
                let mut dye = |most: f64| {
                    (self.below(model.dyes().curves().len()), most * self.unit().powi(2))
                };
                Fluorescence::film(dye(6.0), dye(3.0))
            }
            Model::Analytic(_) => Fluorescence::Analytic {
                emission_peak_nm: self.between(400.0, 710.0),
                stokes_shift_nm: self.between(10.0, 120.0),
                concentration,
            },
        };
        Node::new(reflectance, fluorescence, 0.0)
    }
}

/// The whole part of a position; 0 for negative ones.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "its fraction goes")]
pub(crate) fn place(position: f64) -> usize {
    position as usize
}

/// Four materials with weights that add up to 1.
pub(crate) fn materials(model: &Model, random: &mut Random) -> [(f64, Material); 4] {
    let mut cuts = [random.unit(), random.unit(), random.unit()];
    cuts.sort_by(f64::total_cmp);
    let weights = [cuts[0], cuts[1] - cuts[0], cuts[2] - cuts[1], 1.0 - cuts[2]];
    weights.map(|weight| (weight, random.node(model).material(model)))
}

/// One model of each kind and rule.
pub(crate) fn models() -> Vec<Model> {
    let bells = AnalyticModel::new(30.0, 60.0, Accounting::Photon, 0.7).expect("in range");
    let mut models =
        vec![Model::Reflectance, Model::Analytic(AnalyticModel::default()), Model::Analytic(bells)];
    for accounting in [Accounting::Energy, Accounting::Photon] {
        let set = DyeSet::named("konig8").expect("built in");
        let film = FilmModel::new(set, accounting, QuantumYield::Measured).expect("in range");
        models.push(Model::Film(film));
        for mixing in [Mixing::Pooled, Mixing::Separate] {
            for optical_density in [None, Some(4.0)] {
                let quantum_yield = QuantumYield::Measured;
                let options = DyeOptions { accounting, mixing, quantum_yield, optical_density };
                let set = DyeSet::named("konig8").expect("built in");
                models.push(Model::Dyes(DyeModel::new(set, options).expect("in range")));
            }
        }
    }
    models
}

/// Width of the bins of the test, nm.
const BIN_NM: f64 = 12.5;
/// The bins cover 200 to 850 nm: bells of the analytic model absorb from 211 nm on.
const BINS: usize = 52;
/// Below this count, chi-square's distribution is not that of normal deviates.
const LEAST_EXPECTED: f64 = 8.0;

/// Pearson's chi-square test of draws against their density and the probability of the elastic
/// one. The limit is five standard deviations above the mean of the distribution, and eight for
/// its long tail where the bins are few.
pub(crate) fn assert_drawn_from(
    draws: usize,
    mut sample: impl FnMut(usize) -> Option<Sample<f64>>,
    per_nm: impl Fn(f64) -> f64,
    elastic: f64,
) {
    let mut counts = [0.0; BINS + 1];
    for i in 0..draws {
        match sample(i) {
            Some(Sample { draw: Draw::Elastic { .. }, .. }) => counts[BINS] += 1.0,
            Some(Sample { nm, .. }) => counts[place((nm - 200.0) / BIN_NM)] += 1.0,
            None => return assert_eq!((elastic, per_nm(500.0)), (0.0, 0.0)),
        }
    }
    let area = |bin: usize| {
        let at = |i: usize| 200.0 + BIN_NM * (bin as f64 + (i as f64 + 0.5) / 250.0);
        (0..250).map(|i| per_nm(at(i))).sum::<f64>() * BIN_NM / 250.0
    };
    let mut expected: Vec<f64> = (0..BINS).map(area).collect();
    expected.push(elastic);
    let total: f64 = expected.iter().sum();
    // Midpoint sums over bins that may begin and end within a step of the tables.
    assert!((total - 1.0).abs() < 2e-4, "the density adds up to {total}");
    let (mut chi_square, mut terms) = (0.0, 0.0);
    let (mut rare, mut rare_expected) = (0.0, 0.0);
    for (count, expected) in counts.iter().zip(expected) {
        let expected = expected * draws as f64;
        if expected < LEAST_EXPECTED {
            rare += count;
            rare_expected += expected;
        } else {
            chi_square += (count - expected).powi(2) / expected;
            terms += 1.0;
        }
    }
    if rare_expected >= LEAST_EXPECTED {
        chi_square += (rare - rare_expected).powi(2) / rare_expected;
        terms += 1.0;
    } else {
        assert!(rare < 40.0, "{rare} draws where {rare_expected} were expected");
    }
    let freedom = f64::max(terms - 1.0, 1.0);
    let limit = freedom + 5.0 * (2.0 * freedom).sqrt() + 8.0;
    assert!(chi_square < limit, "chi-square {chi_square} of {freedom} degrees of freedom");
}
