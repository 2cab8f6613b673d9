//! The material of one color in single precision, ready to evaluate.

use crate::lookup_table::{LookupTable, PackedNode, greater_of, smaller_of, to_single};
use crate::{Accounting, Model};

/// The four materials around a color, mixed by weight: a [`crate::Mixture`] for inner loops.
///
/// Every answer is within 1e-5 of the mixture's, and none panics, whatever the wavelength. Nothing
/// is allocated, and a look-up, an evaluation or a draw takes tens of nanoseconds at most.
#[derive(Clone, Copy, Debug)]
pub struct Blend<'t> {
    pub(crate) table: &'t LookupTable,
    /// Whether any of the four fluoresces.
    fluorescent: bool,
    pub(crate) weights: [f32; 4],
    edge_nm: [f32; 4],
    /// Coefficients of 1, d and d², `[coefficient][corner]`.
    parabola: [[f32; 4]; 3],
    /// What [`PackedNode::fluorescence`] says, `[number][corner]`.
    pub(crate) fluorescence: [[f32; 4]; 4],
}

/// A number for each lobe, `[lobe][corner]`: pooled dyes and bells have one, separate dyes two.
pub(crate) type PerLobe = [[f32; 4]; 2];

impl<'t> Blend<'t> {
    #[inline(always)]
    pub(crate) fn new(table: &'t LookupTable, weights: [f32; 4], nodes: [PackedNode; 4]) -> Self {
        let parabola = |number: usize| nodes.map(|node| node.parabola[number]);
        let fluorescence = |number: usize| nodes.map(|node| node.fluorescence[number]);
        let concentration = fluorescence(1);
        Self {
            table,
            fluorescent: concentration[0] + concentration[1] + concentration[2] + concentration[3]
                > 0.0,
            weights,
            edge_nm: parabola(0),
            parabola: [parabola(1), parabola(2), parabola(3)],
            fluorescence: [fluorescence(0), concentration, fluorescence(2), fluorescence(3)],
        }
    }

    /// Whether any light comes back at another wavelength.
    pub fn is_fluorescent(&self) -> bool {
        self.fluorescent
            && self.weights.iter().zip(self.fluorescence[1]).any(|(w, c)| *w > 0.0 && c > 0.0)
    }

    /// Share of incident light at `lambda_nm` that is reflected at the same wavelength, 0..=1.
    #[inline]
    pub fn reflectance(&self, lambda_nm: f32) -> f32 {
        self.reflectance_through(lambda_nm, &self.pairs_absorbed(lambda_nm))
    }

    /// The reflectance behind what the lobes absorb.
    #[inline(always)]
    pub(crate) fn reflectance_through(&self, lambda_nm: f32, absorbed: &PerLobe) -> f32 {
        let mut shown = [0.0; 4];
        for i in 0..4 {
            let d = lambda_nm - self.edge_nm[i];
            let x = self.parabola[0][i] + d * (self.parabola[1][i] + d * self.parabola[2][i]);
            shown[i] = self.weights[i] * (1.0 - (absorbed[0][i] + absorbed[1][i])) * sigmoid(x);
        }
        sum(shown)
    }

    /// [`Blend::reflectance`] at four wavelengths, nm.
    #[inline]
    pub fn reflectance4(&self, lambda_nm: [f32; 4]) -> [f32; 4] {
        self.reflectances(lambda_nm)
    }

    /// [`Blend::reflectance`] at eight wavelengths, nm.
    #[inline]
    pub fn reflectance8(&self, lambda_nm: [f32; 8]) -> [f32; 8] {
        self.reflectances(lambda_nm)
    }

    /// Plain arrays, which compile to vectors of four on every x86-64. Wider ones, chosen at run
    /// time, take a call for each material; inside this crate they gained nothing.
    #[inline(always)]
    fn reflectances<const N: usize>(&self, lambda_nm: [f32; N]) -> [f32; N] {
        let mut total = [0.0; N];
        if !self.fluorescent {
            for i in 0..4 {
                let shown = self.shown(i, lambda_nm);
                (0..N).for_each(|k| total[k] += self.weights[i] * shown[k]);
            }
            return total;
        }
        let absorbed = self.absorbed(lambda_nm);
        for i in 0..4 {
            let shown = self.shown(i, lambda_nm);
            (0..N).for_each(|k| total[k] += self.weights[i] * (1.0 - absorbed[i][k]) * shown[k]);
        }
        total
    }

    /// The reflectance of one corner where nothing is absorbed.
    #[inline(always)]
    fn shown<const N: usize>(&self, i: usize, lambda_nm: [f32; N]) -> [f32; N] {
        let [constant, linear, quadratic] = self.parabola.map(|c| c[i]);
        let edge_nm = self.edge_nm[i];
        let mut shown = [0.0; N];
        for k in 0..N {
            let d = lambda_nm[k] - edge_nm;
            shown[k] = sigmoid(constant + d * (linear + d * quadratic));
        }
        shown
    }

    /// Share of light that each corner's fluorescence absorbs, `[corner][wavelength]`.
    #[inline(always)]
    fn absorbed<const N: usize>(&self, lambda_nm: [f32; N]) -> [[f32; N]; 4] {
        let mut absorbed = [[0.0; N]; 4];
        let [first, concentration, _, last] = self.fluorescence;
        match &self.table.model {
            Model::Reflectance => {}
            Model::Dyes(_) => {
                let rows = lambda_nm.map(|nm| self.table.curves.row(nm));
                for i in 0..4 {
                    let number = dye(last[i]);
                    let pairs = rows.map(|row| self.table.curves.absorption(row, number));
                    for k in 0..N {
                        let [a, b] = pairs[k];
                        absorbed[i][k] = concentration[i] * (a + first[i] * (b - a));
                    }
                }
            }
            Model::Analytic(_) => {
                let bells = self.table.absorption_bells;
                for i in 0..4 {
                    for k in 0..N {
                        absorbed[i][k] = concentration[i] * bells.at(last[i], lambda_nm[k]);
                    }
                }
            }
        }
        absorbed
    }

    /// Energy that comes out per nm at `out_nm` by fluorescence, per unit that came in at `in_nm`;
    /// 1/nm.
    #[inline]
    pub fn reradiation_per_nm(&self, in_nm: f32, out_nm: f32) -> f32 {
        if !self.fluorescent {
            return 0.0;
        }
        self.moved(&self.returned(in_nm), &self.emission(out_nm))
    }

    /// The re-radiation for what the lobes return of one wavelength and emit at another, 1/nm.
    #[inline(always)]
    pub(crate) fn moved(&self, returned: &PerLobe, emission: &PerLobe) -> f32 {
        sum([0, 1, 2, 3].map(|i| {
            self.weights[i] * (returned[0][i] * emission[0][i] + returned[1][i] * emission[1][i])
        }))
    }

    /// Share of incident light at `in_nm` that comes out at any wavelength, 0..=1.
    #[inline]
    pub fn albedo(&self, in_nm: f32) -> f32 {
        let absorbed = self.pairs_absorbed(in_nm);
        let [one, two] = self.returned_of(in_nm, &absorbed);
        let returned = [0, 1, 2, 3].map(|i| self.weights[i] * (one[i] + two[i]));
        self.reflectance_through(in_nm, &absorbed) + sum(returned)
    }

    /// What each corner's dyes or bells absorb of light at `lambda_nm`.
    #[inline(always)]
    pub(crate) fn pairs_absorbed(&self, lambda_nm: f32) -> PerLobe {
        let mut absorbed = [[0.0; 4]; 2];
        if !self.fluorescent {
            return absorbed;
        }
        let [first, concentration, _, last] = self.fluorescence;
        match &self.table.model {
            Model::Reflectance => {}
            Model::Dyes(_) => {
                let row = self.table.curves.row(lambda_nm);
                for i in 0..4 {
                    let [a, b] = self.table.curves.absorption(row, dye(last[i]));
                    absorbed[0][i] = concentration[i] * (1.0 - first[i]) * a;
                    absorbed[1][i] = concentration[i] * first[i] * b;
                }
            }
            Model::Analytic(_) => {
                let bells = self.table.absorption_bells;
                (0..4).for_each(|i| {
                    absorbed[0][i] = concentration[i] * bells.at(last[i], lambda_nm);
                });
            }
        }
        absorbed
    }

    /// What each corner's lobes return of light at `in_nm`.
    #[inline(always)]
    pub(crate) fn returned(&self, in_nm: f32) -> PerLobe {
        self.returned_of(in_nm, &self.pairs_absorbed(in_nm))
    }

    /// What each corner's lobes return of what its dyes or bells absorbed at `in_nm`.
    #[inline(always)]
    pub(crate) fn returned_of(&self, in_nm: f32, absorbed: &PerLobe) -> PerLobe {
        let mut returned = [[0.0; 4]; 2];
        if !self.fluorescent {
            return returned;
        }
        let [first, _, _, last] = self.fluorescence;
        match &self.table.model {
            Model::Reflectance => {}
            Model::Dyes(model) => {
                let accounting = model.options().accounting;
                let separate = self.table.is_separate();
                for i in 0..4 {
                    let [one, two] = self.table.curves.pair(dye(last[i]));
                    let back =
                        |yielded: f32, mean_nm: f32| yielded * share(accounting, in_nm, mean_nm);
                    if separate {
                        returned[0][i] =
                            absorbed[0][i] * back(one.quantum_yield, one.mean_emission_nm);
                        returned[1][i] =
                            absorbed[1][i] * back(two.quantum_yield, two.mean_emission_nm);
                    } else {
                        let mix = |a: f32, b: f32| a + first[i] * (b - a);
                        let yielded = mix(one.quantum_yield, two.quantum_yield);
                        let mean_nm = mix(one.mean_emission_nm, two.mean_emission_nm);
                        returned[0][i] = (absorbed[0][i] + absorbed[1][i]) * back(yielded, mean_nm);
                    }
                }
            }
            Model::Analytic(model) => {
                let yielded = to_single(model.quantum_yield());
                for i in 0..4 {
                    let share = share(model.accounting(), in_nm, first[i]);
                    returned[0][i] = absorbed[0][i] * yielded * share;
                }
            }
        }
        returned
    }

    /// Where each corner's lobes give it back, `[lobe][corner]`, 1/nm.
    #[inline(always)]
    pub(crate) fn emission(&self, out_nm: f32) -> PerLobe {
        if !self.fluorescent {
            return [[0.0; 4]; 2];
        }
        let [first, _, _, last] = self.fluorescence;
        match &self.table.model {
            Model::Reflectance => [[0.0; 4]; 2],
            Model::Dyes(_) => {
                let row = self.table.curves.row(out_nm);
                let separate = self.table.is_separate();
                let mut emission = [[0.0; 4]; 2];
                for i in 0..4 {
                    let [a, b] = self.table.curves.emission(row, dye(last[i]));
                    emission[0][i] = if separate { a } else { a + first[i] * (b - a) };
                    emission[1][i] = b;
                }
                emission
            }
            Model::Analytic(_) => {
                let emission = self.table.emission_bells;
                [std::array::from_fn(|i| emission.at(first[i], out_nm)), [0.0; 4]]
            }
        }
    }

    /// What leaves from each lobe of light that is 1 at every wavelength, where the lobes' emission
    /// is `emission`; `[lobe + 2·corner]`.
    #[inline(always)]
    pub(crate) fn leaving_shares(&self, emission: &PerLobe) -> [f32; 8] {
        if !self.fluorescent {
            return [0.0; 8];
        }
        let [weight, concentration, returned_nm, number] = self.fluorescence;
        let separate = self.table.is_separate();
        let mut shares = [0.0; 8];
        for i in 0..4 {
            let [one, two] = if separate {
                let [one, two] = self.table.curves.pair(dye(number[i]));
                [(1.0 - weight[i]) * one.returned_nm, weight[i] * two.returned_nm]
                    .map(|nm| concentration[i] * nm)
            } else {
                [returned_nm[i], 0.0]
            };
            shares[2 * i] = self.weights[i] * one * emission[0][i];
            shares[2 * i + 1] = self.weights[i] * two * emission[1][i];
        }
        shares
    }

    /// What leaves from each lobe of the light of which it returns `returned`;
    /// `[lobe + 2·corner]`.
    #[inline(always)]
    pub(crate) fn arriving_shares(&self, returned: &PerLobe) -> [f32; 8] {
        if !self.fluorescent {
            return [0.0; 8];
        }
        let [weight, _, _, number] = self.fluorescence;
        let separate = self.table.is_separate();
        let dyes = matches!(self.table.model, Model::Dyes(_));
        let mut shares = [0.0; 8];
        for i in 0..4 {
            let [one, two] = if dyes {
                let [one, two] = self.table.curves.pair(dye(number[i])).map(|dye| dye.emitted);
                if separate { [one, two] } else { [one + weight[i] * (two - one), 0.0] }
            } else {
                [1.0, 0.0]
            };
            shares[2 * i] = self.weights[i] * returned[0][i] * one;
            shares[2 * i + 1] = self.weights[i] * returned[1][i] * two;
        }
        shares
    }
}

/// Cubic B-splines of one width in single precision.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Bells {
    /// 1 / distance of knots, 1/nm.
    per_step: f32,
    /// Factor of the bell with area 1 and unit step, over 6.
    scale: f32,
}

impl Bells {
    /// Absorption with a peak of 1, and emission with an area of 1.
    pub(crate) fn of(model: &Model) -> [Self; 2] {
        let Model::Analytic(model) = model else { return [Self::default(); 2] };
        let [absorption, emission] =
            [model.absorption_bell(0.0).step_nm.recip(), model.emission_bell(0.0).step_nm.recip()];
        [
            Self { per_step: to_single(absorption), scale: 1.5 / 6.0 },
            Self { per_step: to_single(emission), scale: to_single(emission / 6.0) },
        ]
    }

    #[inline(always)]
    fn at(self, center_nm: f32, nm: f32) -> f32 {
        let v = (nm - center_nm).abs() * self.per_step;
        // The bell as two cubes, each of which is zero beyond its knot.
        let (outer, inner) = (greater_of(2.0 - v, 0.0), greater_of(1.0 - v, 0.0));
        self.scale * (outer * outer * outer - 4.0 * inner * inner * inner)
    }
}

#[inline(always)]
fn share(accounting: Accounting, nm: f32, mean_nm: f32) -> f32 {
    match accounting {
        Accounting::Energy => 1.0,
        Accounting::Photon => (nm / mean_nm).min(1.0),
    }
}

/// The number of a dye that was stored among other numbers.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "it was made from a dye's number"
)]
#[inline(always)]
pub(crate) fn dye(number: f32) -> usize {
    number as i32 as usize
}

/// Beyond this, squares overflow; at this, a reflectance is exactly 0 or 1.
const SATURATED: f32 = 1e9;

#[inline(always)]
fn sigmoid(x: f32) -> f32 {
    let x = greater_of(smaller_of(x, SATURATED), -SATURATED);
    0.5 + 0.5 * x / (1.0 + x * x).sqrt()
}

#[inline(always)]
pub(crate) fn sum([a, b, c, d]: [f32; 4]) -> f32 {
    (a + b) + (c + d)
}
