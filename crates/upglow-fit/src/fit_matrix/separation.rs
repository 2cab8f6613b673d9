//! A measured matrix as a sum of few emissions, each excited by some of the incident light.

use upglow_color::{Diagonal, DonaldsonMatrix};

use super::goal::{MatrixGoal, ROWS};

/// What re-emits light in a matrix: factors y(i)·ê(o), with Σ ê = 1.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Emitter {
    /// The share of the power of each incident band that is re-emitted.
    pub(super) excitation: Vec<f64>,
    /// The share of that in each outgoing band.
    pub(super) emission: Vec<f64>,
}

/// How often excitations and emissions are improved by turns; a third of it changes no ΔE00 by 0.05.
const ROUNDS: usize = 12;
/// How often each number is improved in one turn.
const SWEEPS: usize = 40;

/// What a difference of one element of the matrix counts, where light and eye have their peaks, beside one of
/// ΔE00. With less, emissions take shapes that no dye has where the colors do not show it.
const ELEMENT_WEIGHT: f64 = 40.0;
/// Elements count at least this share of that.
const LEAST_SHARE: f64 = 0.1;

/// The emitters of a matrix, `count` of them, by alternating least squares with bounds.
///
/// The sum of their factors is fitted to what was measured outside of the diagonal, and to the colors of that. Few
/// emitters cannot follow noise, so that it does no harm below the diagonal; without the elements there, emitters
/// would be free to glow where nothing does.
pub(super) fn separated(
    measured: &DonaldsonMatrix,
    goal: &MatrixGoal,
    count: usize,
) -> Vec<Emitter> {
    let mut work = Separation::start(measured, goal, count);
    for _ in 0..ROUNDS {
        work.improve_excitations();
        work.improve_emissions();
    }
    work.emitters
}

struct Separation<'a> {
    measured: &'a DonaldsonMatrix,
    goal: &'a MatrixGoal,
    /// Squares of the weights of elements; 0 on the diagonal.
    weights: Vec<Vec<f64>>,
    emitters: Vec<Emitter>,
    /// What the emitters lack, `[outgoing][incident]`.
    lacking: Vec<Vec<f64>>,
    /// What they lack in color.
    lacking_color: [f64; ROWS],
    /// The outgoing band of each incident one that is on the diagonal.
    diagonal: Vec<Option<usize>>,
}

impl<'a> Separation<'a> {
    fn start(measured: &'a DonaldsonMatrix, goal: &'a MatrixGoal, count: usize) -> Self {
        let mut diagonal = vec![None; measured.incident_nm().len()];
        measured.diagonal_bands().for_each(|[o, i]| diagonal[i] = Some(o));
        let is_on_diagonal = |o, i: usize| diagonal[i] == Some(o);
        let off = measured
            .with_factors(|o, i| if is_on_diagonal(o, i) { 0.0 } else { measured.factors()[o][i] });
        let lacking = off.factors().to_vec();
        let mut work = Self {
            measured,
            goal,
            weights: weights(goal, |o, i| !is_on_diagonal(o, i)),
            emitters: Vec::new(),
            // Of the colors, the diagonal is not to be explained.
            lacking_color: goal.change(&goal.colors(&off)),
            lacking,
            diagonal,
        };
        work.emitters = (0..count).map(|number| work.first_guess(number, count)).collect();
        work
    }

    /// The emission that one part of the excitation has, from short to long wavelengths, without excitation.
    fn first_guess(&self, number: usize, count: usize) -> Emitter {
        let total = |i: usize| self.lacking.iter().map(|row| row[i].max(0.0)).sum::<f64>();
        let totals: Vec<f64> = (0..self.diagonal.len()).map(total).collect();
        let all: f64 = totals.iter().sum();
        let mut before = 0.0;
        let part: Vec<bool> = totals
            .iter()
            .map(|share| {
                let middle = (before + share / 2.0) / all.max(f64::MIN_POSITIVE);
                before += share;
                upglow_color::rounding::whole(middle * count as f64).min(count - 1) == number
            })
            .collect();
        let of = |row: &Vec<f64>| {
            row.iter()
                .zip(&part)
                .map(|(v, is_in)| if *is_in { *v } else { 0.0 })
                .sum::<f64>()
                .max(0.0)
        };
        let emission: Vec<f64> = self.lacking.iter().map(of).collect();
        let area: f64 = emission.iter().sum();
        let even = 1.0 / emission.len() as f64;
        let emission = emission.iter().map(|e| if area > 0.0 { e / area } else { even }).collect();
        Emitter { excitation: vec![0.0; part.len()], emission }
    }

    /// The color of unit re-emitted power of an emission, without its part on the diagonal of a band.
    fn stimulus(&self, emission: &[f64], incident: usize) -> [f64; 3] {
        let mut stimulus = [0.0; 3];
        for (o, (e, m)) in emission.iter().zip(&self.goal.matching).enumerate() {
            if self.diagonal[incident] != Some(o) {
                (0..3).for_each(|k| stimulus[k] += e * m[k]);
            }
        }
        stimulus
    }

    fn improve_excitations(&mut self) {
        for number in 0..self.emitters.len() {
            let emission = self.emitters[number].emission.clone();
            let most = self.most_excitation(&emission);
            let columns: Vec<[f64; ROWS]> = (0..most.len())
                .map(|i| self.goal.change_of_band(i, self.stimulus(&emission, i)))
                .collect();
            for _ in 0..SWEEPS {
                for i in 0..most.len() {
                    let column = |o: usize| (self.weights[o][i], emission[o], self.lacking[o][i]);
                    let elements = (0..emission.len()).map(column);
                    let found = self.emitters[number].excitation[i];
                    let step = best_step(&columns[i], &self.lacking_color, elements);
                    let next = (found + step).clamp(0.0, most[i]);
                    let moved = next - found;
                    self.emitters[number].excitation[i] = next;
                    take(&mut self.lacking_color, &columns[i], moved);
                    for (row, e) in self.lacking.iter_mut().zip(&emission) {
                        row[i] -= moved * e;
                    }
                }
            }
        }
    }

    fn improve_emissions(&mut self) {
        for number in 0..self.emitters.len() {
            let excitation = self.emitters[number].excitation.clone();
            let columns: Vec<[f64; ROWS]> = (0..self.lacking.len())
                .map(|o| {
                    let color = |(i, y): (usize, &f64)| match self.diagonal[i] == Some(o) {
                        true => [0.0; 3],
                        false => self.goal.matching[o].map(|m| m * y),
                    };
                    let colors: Vec<[f64; 3]> = excitation.iter().enumerate().map(color).collect();
                    self.goal.change(&colors)
                })
                .collect();
            for _ in 0..SWEEPS {
                for (o, column) in columns.iter().enumerate() {
                    let row = |i: usize| (self.weights[o][i], excitation[i], self.lacking[o][i]);
                    let elements = (0..excitation.len()).map(row);
                    let found = self.emitters[number].emission[o];
                    let step = best_step(column, &self.lacking_color, elements);
                    let next = (found + step).max(0.0);
                    let moved = next - found;
                    self.emitters[number].emission[o] = next;
                    take(&mut self.lacking_color, column, moved);
                    for (lacking, y) in self.lacking[o].iter_mut().zip(&excitation) {
                        *lacking -= moved * y;
                    }
                }
            }
            self.emitters[number].normalize();
        }
    }

    /// The greatest excitation that leaves no less absorbed than is re-emitted, photon for photon.
    fn most_excitation(&self, emission: &[f64]) -> Vec<f64> {
        let moments = emission.iter().zip(self.measured.outgoing_nm()).map(|(e, nm)| e * nm);
        let mean_nm: f64 = moments.sum();
        let most = |(nm, on_diagonal): (&f64, &Option<usize>)| {
            let share = upglow::Accounting::Photon.share(*nm, mean_nm);
            let Some(o) = *on_diagonal else { return share };
            let i = self.measured.incident_nm().partition_point(|at| at < nm);
            let together = match self.measured.diagonal() {
                Diagonal::Together => emission[o],
                Diagonal::Reflected => 0.0,
            };
            let absorbed = (1.0 - self.measured.factors()[o][i]).max(0.0);
            (share * absorbed / (1.0 - share * together).max(f64::MIN_POSITIVE)).min(share)
        };
        self.measured.incident_nm().iter().zip(&self.diagonal).map(most).collect()
    }
}

/// An emitter is real if somewhere its excitation is this many times what noise makes of one.
const ABOVE_NOISE: f64 = 5.0;

impl Emitter {
    /// Whether it re-emits more than the noise of the measurement could pretend.
    pub(super) fn is_above_noise(&self, measured: &DonaldsonMatrix) -> bool {
        let most = self.excitation.iter().copied().fold(0.0, f64::max);
        let [typical, _] = measured.noise().unwrap_or_default();
        // The noise of a share that is the best multiple of the emission.
        let length = self.emission.iter().map(|e| e * e).sum::<f64>().sqrt();
        most > ABOVE_NOISE * typical / length.max(f64::MIN_POSITIVE)
    }

    /// Scales the emission to a sum of 1, and the excitation against it.
    fn normalize(&mut self) {
        let area: f64 = self.emission.iter().sum();
        if area > 0.0 {
            self.emission.iter_mut().for_each(|e| *e /= area);
            self.excitation.iter_mut().for_each(|y| *y *= area);
        }
    }
}

/// The step of one number that lowers the sum of squares most: of colors, and of elements with their weight,
/// what a unit of the number adds to them, and what they lack.
fn best_step(
    column: &[f64; ROWS],
    lacking_color: &[f64; ROWS],
    elements: impl Iterator<Item = (f64, f64, f64)>,
) -> f64 {
    let (mut slope, mut curvature) = (0.0, 0.0);
    for (by, lacking) in column.iter().zip(lacking_color) {
        slope += by * lacking;
        curvature += by * by;
    }
    for (weight, by, lacking) in elements {
        slope += weight * by * lacking;
        curvature += weight * by * by;
    }
    if curvature > 0.0 { slope / curvature } else { 0.0 }
}

fn take(lacking: &mut [f64; ROWS], column: &[f64; ROWS], moved: f64) {
    lacking.iter_mut().zip(column).for_each(|(lacking, by)| *lacking -= moved * by);
}

/// Squares of the weights of elements: as daylight is strong, and as the observer sees it.
fn weights(goal: &MatrixGoal, counts: impl Fn(usize, usize) -> bool) -> Vec<Vec<f64>> {
    let seen: Vec<f64> =
        goal.matching.iter().map(|m| m.iter().map(|v| v * v).sum::<f64>().sqrt()).collect();
    let relative = |curve: &[f64]| {
        let peak = curve.iter().copied().fold(0.0, f64::max);
        curve.iter().map(|v| v / peak).collect::<Vec<f64>>()
    };
    let (seen, light) = (relative(&seen), relative(&goal.daylight));
    let weight = |o: usize, i: usize| {
        let weight = ELEMENT_WEIGHT * (LEAST_SHARE + seen[o]) * (LEAST_SHARE + light[i].sqrt());
        if counts(o, i) { weight * weight } else { 0.0 }
    };
    (0..seen.len()).map(|o| (0..light.len()).map(|i| weight(o, i)).collect()).collect()
}
