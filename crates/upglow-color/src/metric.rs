//! Color difference metrics. A new one is a variant with residuals and their derivatives.

use crate::ciede2000::ciede2000_residuals;
use crate::colorimetry::Colorimetry;
use crate::lab::{Lab, lab_jacobian};
use crate::matrix::Matrix3;
use crate::values::Xyz;

/// How far one color is from another.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Metric {
    /// Euclidean distance in linear RGB of the contract's space, times 100.
    Rgb,
    /// Euclidean distance in CIELAB.
    De76,
    /// CIEDE2000.
    #[default]
    De2000,
}

/// Scales RGB distances to ΔE, in which white is 100 from black, so that one set of solver tolerances
/// serves every metric.
const RGB_SCALE: f64 = 100.0;

impl Metric {
    /// The distance between two colors under `colorimetry`.
    pub fn distance(self, colorimetry: &Colorimetry, target: Xyz, sample: Xyz) -> f64 {
        norm(self.goal(colorimetry, target).residuals(sample).0)
    }

    /// The distance to one target; what all such distances have in common is computed once.
    pub fn goal(self, colorimetry: &Colorimetry, target: Xyz) -> Goal {
        Goal {
            metric: self,
            white: colorimetry.white(),
            scaled_rgb_from_xyz: Matrix3::diagonal([RGB_SCALE; 3])
                * colorimetry.rgb_from_xyz_matrix(),
            xyz: target,
            lab: colorimetry.lab_from_xyz(target),
        }
    }
}

/// A target color and a metric for the distance to it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Goal {
    metric: Metric,
    white: Xyz,
    scaled_rgb_from_xyz: Matrix3,
    xyz: Xyz,
    lab: Lab,
}

impl Goal {
    /// The metric of the distances.
    pub fn metric(&self) -> Metric {
        self.metric
    }

    /// The target.
    pub fn xyz(&self) -> Xyz {
        self.xyz
    }

    /// The target in CIELAB.
    pub fn lab(&self) -> Lab {
        self.lab
    }

    /// The same target with another metric.
    #[must_use]
    pub fn under(self, metric: Metric) -> Self {
        Self { metric, ..self }
    }

    /// The distance of `sample` from the target.
    pub fn distance(&self, sample: Xyz) -> f64 {
        norm(self.residuals(sample).0)
    }

    /// Three numbers whose squares add up to the square of the distance, and their derivatives with
    /// respect to the sample, `[residual][X Y Z]`.
    pub fn residuals(&self, sample: Xyz) -> ([f64; 3], Matrix3) {
        match self.metric {
            Metric::Rgb => {
                let difference = sample - self.xyz;
                (self.scaled_rgb_from_xyz * difference.0, self.scaled_rgb_from_xyz)
            }
            Metric::De76 => {
                let (lab, by_xyz) = lab_jacobian(sample, self.white);
                ([lab.l - self.lab.l, lab.a - self.lab.a, lab.b - self.lab.b], by_xyz)
            }
            Metric::De2000 => {
                let (lab, lab_by_xyz) = lab_jacobian(sample, self.white);
                let (residuals, by_lab) = ciede2000_residuals(self.lab, lab);
                (residuals, by_lab * lab_by_xyz)
            }
        }
    }
}

fn norm(v: [f64; 3]) -> f64 {
    v.iter().map(|x| x * x).sum::<f64>().sqrt()
}

crate::choices!(Metric, "metric", De2000 = "de2000", De76 = "de76", Rgb = "rgb");

#[cfg(test)]
mod tests {
    use super::*;
    use crate::choice::Choice;
    use crate::contract::Contract;
    use crate::grid::Grid;

    #[test]
    fn residuals_have_the_distance_as_their_norm_and_exact_derivatives() {
        // Central differences with this step: truncation about 1e-6 of the slope.
        const STEP: f64 = 1e-6;
        const TOLERANCE: f64 = 1e-5;
        let colorimetry = Contract::default().on(Grid::FIT);
        let (target, sample) = (Xyz([0.4, 0.3, 0.2]), [0.35, 0.33, 0.31]);
        for &metric in Metric::ALL {
            let goal = metric.goal(&colorimetry, target);
            let (residuals, jacobian) = goal.residuals(Xyz(sample));
            let distance = metric.distance(&colorimetry, target, Xyz(sample));
            // Rounding only.
            assert!((norm(residuals) - distance).abs() < 1e-10, "{metric}");
            for k in 0..3 {
                let moved = |by: f64| {
                    let mut p = sample;
                    p[k] += by;
                    goal.residuals(Xyz(p)).0
                };
                let (up, down) = (moved(STEP), moved(-STEP));
                for r in 0..3 {
                    let slope = (up[r] - down[r]) / (2.0 * STEP);
                    let error = (jacobian.0[r][k] - slope).abs();
                    assert!(error < TOLERANCE * (1.0 + slope.abs()), "{metric} {r} {k}");
                }
            }
        }
    }

    #[test]
    fn names_round_trip() {
        for &metric in Metric::ALL {
            assert_eq!(metric.to_string().parse(), Ok(metric));
        }
        assert!("de94".parse::<Metric>().is_err());
    }
}
