//! Sums over wavelength for residuals and their derivatives.

use fearless_simd::prelude::*;
use fearless_simd::{Level, dispatch, f64x4};
use upglow::ModelOnGrid;
use upglow_color::Xyz;

use super::parabola::{Parabola, scaled};

/// Samples of a curve at the visible wavelengths, padded to whole vectors.
pub(crate) type Lanes = [f64; LANES];

/// 360, 365 … 830 nm are 95 samples of the 5 nm grid.
const LANES: usize = 96;
/// Partial sums per sum. The number is the same on every machine, and no product is fused with a sum,
/// so results have the same bits everywhere.
const WIDTH: usize = 4;

/// Weights and wavelengths of the sums.
#[derive(Clone, Debug)]
pub(crate) struct Sums {
    t: Lanes,
    weights: [Lanes; 3],
    wavelengths_nm: Lanes,
    first: usize,
    simd_level: Level,
}

/// The color of a reflectance behind an absorber, and derivatives.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reflected<const K: usize> {
    /// ∫ w·(1 − absorbed)·r.
    pub(crate) color: Xyz,
    /// Derivatives of the color with respect to the parabola's coefficients.
    pub(crate) by_parabola: [Xyz; 3],
    /// ∫ w·other·r for each other curve.
    pub(crate) seen_by: [Xyz; K],
}

impl Sums {
    /// The sums of a model's light and observer.
    ///
    /// # Panics
    ///
    /// If the model is not on a grid with at most 96 visible wavelengths; fits use 5 nm.
    pub(crate) fn new(model: &ModelOnGrid) -> Self {
        let weights = model.colorimetry().weights();
        let seen = |w: &[f64; 3]| w.iter().any(|v| *v != 0.0);
        let first = weights.iter().position(seen).unwrap_or(0);
        let mut sums = Self {
            t: [0.0; LANES],
            weights: [[0.0; LANES]; 3],
            wavelengths_nm: [0.0; LANES],
            first,
            simd_level: Level::new(),
        };
        assert!(weights.len() - first <= LANES, "fits run on the 5 nm grid");
        for (i, (w, &nm)) in weights.iter().zip(model.wavelengths_nm()).skip(first).enumerate() {
            sums.t[i] = scaled(nm);
            sums.wavelengths_nm[i] = nm;
            (0..3).for_each(|k| sums.weights[k][i] = w[k]);
        }
        sums
    }

    /// The part of a curve on the model's grid that the observer sees.
    pub(crate) fn lanes(&self, curve: &[f64]) -> Lanes {
        let mut lanes = [0.0; LANES];
        lanes.iter_mut().zip(&curve[self.first..]).for_each(|(lane, v)| *lane = *v);
        lanes
    }

    /// A function of wavelength, and its slope, at each lane.
    pub(crate) fn sample(&self, f: impl Fn(f64) -> (f64, f64)) -> [Lanes; 2] {
        let mut lanes = [[0.0; LANES]; 2];
        for (i, &nm) in self.wavelengths_nm.iter().enumerate() {
            (lanes[0][i], lanes[1][i]) = f(nm);
        }
        lanes
    }

    /// The reflectance at each lane.
    pub(crate) fn reflectance(&self, [q0, q1, q2]: Parabola) -> Lanes {
        self.t.map(|t| {
            let x = q0 + t * (q1 + t * q2);
            0.5 + 0.5 * x / (1.0 + x * x).sqrt()
        })
    }

    /// ∫ w·curve.
    pub(crate) fn integrate(&self, curve: impl Fn(usize) -> f64) -> Xyz {
        let mut sums = [[0.0; WIDTH]; 3];
        for at in (0..LANES).step_by(WIDTH) {
            for lane in 0..WIDTH {
                let value = curve(at + lane);
                for (sum, w) in sums.iter_mut().zip(&self.weights) {
                    sum[lane] += w[at + lane] * value;
                }
            }
        }
        Xyz(sums.map(|[a, b, c, d]| (a + b) + (c + d)))
    }

    /// The color of a reflectance behind an absorber that takes the share `absorbed`, and the color
    /// that is lost to each of `others` at concentration 1.
    pub(crate) fn reflect<const K: usize>(
        &self,
        parabola: Parabola,
        absorbed: &Lanes,
        others: [&Lanes; K],
    ) -> Reflected<K> {
        dispatch!(self.simd_level, simd => simd.vectorize(
            #[inline(always)]
            || self.reflect_in_vectors(simd, parabola, absorbed, others),
        ))
    }

    /// [`Sums::reflect`], compiled once for each instruction set.
    #[inline(always)]
    fn reflect_in_vectors<S: Simd, const K: usize>(
        &self,
        simd: S,
        parabola: Parabola,
        absorbed: &Lanes,
        others: [&Lanes; K],
    ) -> Reflected<K> {
        let vector = |lanes: &Lanes, at: usize| f64x4::from_slice(simd, &lanes[at..at + WIDTH]);
        let [q0, q1, q2] = parabola.map(|q| f64x4::splat(simd, q));
        let (half, one) = (f64x4::splat(simd, 0.5), f64x4::splat(simd, 1.0));
        let zero = f64x4::splat(simd, 0.0);
        let mut color = [zero; 3];
        let mut by = [[zero; 3]; 3];
        let mut seen = [[zero; 3]; K];
        for at in (0..LANES).step_by(WIDTH) {
            let t = vector(&self.t, at);
            let x = q0 + t * (q1 + t * q2);
            let inverse = one / (one + x * x).sqrt();
            let half_inverse = half * inverse;
            let r = half + x * half_inverse;
            let through = one - vector(absorbed, at);
            let shown = r * through;
            let slope = half_inverse * inverse * inverse * through;
            let slope_t = slope * t;
            let slopes = [slope, slope_t, slope_t * t];
            for k in 0..3 {
                let w = vector(&self.weights[k], at);
                color[k] += w * shown;
                for m in 0..3 {
                    by[m][k] += w * slopes[m];
                }
                let w_r = w * r;
                for (seen, other) in seen.iter_mut().zip(others) {
                    seen[k] += w_r * vector(other, at);
                }
            }
        }
        Reflected {
            color: Xyz(color.map(total)),
            by_parabola: by.map(|by| Xyz(by.map(total))),
            seen_by: seen.map(|seen| Xyz(seen.map(total))),
        }
    }
}

#[inline(always)]
fn total<S: Simd>(lanes: f64x4<S>) -> f64 {
    (lanes[0] + lanes[1]) + (lanes[2] + lanes[3])
}

/// No absorption.
pub(crate) const CLEAR: Lanes = [0.0; LANES];

/// `f` of each lane's index.
pub(crate) fn lanes_from(f: impl Fn(usize) -> f64) -> Lanes {
    std::array::from_fn(f)
}
