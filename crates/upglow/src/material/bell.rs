//! The bell of the analytic fluorescence: a uniform cubic B-spline.

/// Full width at half maximum of the cubic B-spline of unit knot step: twice the root of
/// u³/2 − u² + 1/3 = 0 in 0..1.
const FWHM_OF_UNIT_STEP: f64 = 1.444_703_448_928_752_5;

/// A cubic B-spline bell over wavelength.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Bell {
    pub(crate) center_nm: f64,
    /// Distance of knots, nm; the bell is zero two steps from its center.
    pub(crate) step_nm: f64,
}

impl Bell {
    pub(crate) fn new(center_nm: f64, fwhm_nm: f64) -> Self {
        Self { center_nm, step_nm: fwhm_nm / FWHM_OF_UNIT_STEP }
    }

    /// The bell with a peak of 1, and its derivative by the center.
    pub(crate) fn peak_one(self, lambda_nm: f64) -> (f64, f64) {
        let (b, slope) = cubic((lambda_nm - self.center_nm) / self.step_nm);
        (1.5 * b, -1.5 * slope / self.step_nm)
    }

    /// The bell with an area of 1 (1/nm), and its derivative by the center.
    pub(crate) fn area_one(self, lambda_nm: f64) -> (f64, f64) {
        let (b, slope) = cubic((lambda_nm - self.center_nm) / self.step_nm);
        (b / self.step_nm, -slope / (self.step_nm * self.step_nm))
    }

    /// The area of [`Bell::area_one`] between two wavelengths, 0..=1.
    pub(crate) fn area_between(self, from_nm: f64, to_nm: f64) -> f64 {
        let at = |nm: f64| cubic_area((nm - self.center_nm) / self.step_nm);
        at(to_nm) - at(from_nm)
    }

    /// ∫ b·min(λ / `limit_nm`, 1) dλ below a wavelength, for the bell b of area 1.
    pub(crate) fn shared_area_below(self, limit_nm: f64, nm: f64) -> f64 {
        let below_nm = nm.min(limit_nm);
        let u = (below_nm - self.center_nm) / self.step_nm;
        let moment = self.center_nm * cubic_area(u) + self.step_nm * cubic_moment(u);
        moment / limit_nm + self.area_between(below_nm, nm)
    }

    /// The wavelength below which `u` of the area lies, `u` in 0..=1.
    pub(crate) fn quantile(self, u: f64) -> f64 {
        let lower = u.min(1.0 - u).max(0.0);
        let v = if lower < 1.0 / 24.0 {
            2.0 - (24.0 * lower).sqrt().sqrt()
        } else {
            inner_quantile(0.5 - lower)
        };
        self.center_nm + self.step_nm * if u < 0.5 { -v } else { v }
    }

    /// The wavelength below which `u` of the whole [`Bell::shared_area_below`] lies.
    pub(crate) fn shared_quantile(self, limit_nm: f64, u: f64) -> f64 {
        let reach = 2.0 * self.step_nm;
        let (mut low, mut high) = (self.center_nm - reach, self.center_nm + reach);
        let target = u * self.shared_area_below(limit_nm, high);
        let mut nm = self.quantile(u);
        for _ in 0..NEWTON_STEPS {
            let excess = self.shared_area_below(limit_nm, nm) - target;
            if excess > 0.0 {
                high = nm;
            } else {
                low = nm;
            }
            let slope = self.area_one(nm).0 * (nm / limit_nm).min(1.0);
            let next = nm - excess / slope;
            let next = if next > low && next < high { next } else { 0.5 * (low + high) };
            if (next - nm).abs() < QUANTILE_NM {
                return next;
            }
            nm = next;
        }
        nm
    }
}

/// Enough for every quantile: where Newton's step leaves the bracket, the bracket is halved.
const NEWTON_STEPS: usize = 60;
/// The search ends when a step is shorter. A larger limit fails a test of the samples, a smaller
/// one costs a step.
const QUANTILE_NM: f64 = 1e-9;

/// The distance from the center within which `y` of the area lies on one side, 0 ≤ y ≤ 11/24.
fn inner_quantile(y: f64) -> f64 {
    // The first two terms of the inverse series, and a third that is right where the tail begins.
    let y2 = y * y;
    let mut v = y * (1.5 + y2 * (1.6875 + y2 * 7.42));
    // The start errs by 0.02, and each step squares the error, times 1.5 where the bell is steep.
    for _ in 0..4 {
        v -= (0.5 - y - (1.0 - cubic_area(v))) / cubic(v).0;
    }
    v
}

/// ∫ v·[`cubic`](v) dv left of `u`.
fn cubic_moment(u: f64) -> f64 {
    let v = u.abs();
    if v < 1.0 {
        -(7.0 / 30.0 - v * v * (1.0 / 3.0 - v * v * (0.25 - v / 10.0)))
    } else if v < 2.0 {
        let tail = 2.0 - v;
        -tail.powi(4) * (1.0 / 12.0 - tail / 30.0)
    } else {
        0.0
    }
}

/// The area of [`cubic`] left of `u`.
fn cubic_area(u: f64) -> f64 {
    let v = u.abs();
    let right = if v < 1.0 {
        0.5 - v * (2.0 / 3.0 + v * v * (v / 8.0 - 1.0 / 3.0))
    } else if v < 2.0 {
        (2.0 - v).powi(4) / 24.0
    } else {
        0.0
    };
    if u < 0.0 { right } else { 1.0 - right }
}

/// The cubic B-spline of unit step and area around 0, and its slope; its peak is 2/3.
fn cubic(u: f64) -> (f64, f64) {
    let (v, sign) = (u.abs(), u.signum());
    if v < 1.0 {
        (2.0 / 3.0 + v * v * (0.5 * v - 1.0), sign * v * (1.5 * v - 2.0))
    } else if v < 2.0 {
        let tail = 2.0 - v;
        (tail * tail * tail / 6.0, -sign * 0.5 * tail * tail)
    } else {
        (0.0, 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bell_has_its_peak_width_and_area() {
        let bell = Bell::new(550.0, 50.0);
        assert!((bell.peak_one(550.0).0 - 1.0).abs() < 1e-15);
        assert!((bell.peak_one(575.0).0 - 0.5).abs() < 1e-12);
        assert!((bell.peak_one(525.0).0 - 0.5).abs() < 1e-12);
        let area: f64 = (0..=5300).map(|i| bell.area_one(300.0 + 0.1 * f64::from(i)).0).sum();
        // The sum of a B-spline over a fine grid errs by the fourth power of step over knot step.
        assert!((area * 0.1 - 1.0).abs() < 1e-9);
    }

    #[test]
    fn areas_are_sums_of_the_bell() {
        let bell = Bell::new(550.0, 50.0);
        for (from, to) in [(400.0, 700.0), (530.0, 540.0), (500.0, 510.0), (555.0, 620.0)] {
            let n = 10_000;
            let step = (to - from) / f64::from(n);
            let sum: f64 =
                (0..n).map(|i| bell.area_one(from + step * (f64::from(i) + 0.5)).0).sum();
            // A midpoint sum errs by the square of its step.
            assert!((bell.area_between(from, to) - sum * step).abs() < 1e-6, "{from} {to}");
        }
    }

    #[test]
    fn a_quantile_is_where_the_area_is_its_share() {
        let bell = Bell::new(480.0, 50.0);
        let n = 1000;
        for i in 0..=n {
            let u = f64::from(i) / f64::from(n);
            // Rounding, after Newton's last step.
            assert!((bell.area_between(0.0, bell.quantile(u)) - u).abs() < 1e-13, "{u}");
            for limit_nm in [430.0, 490.0, 700.0] {
                let whole = bell.shared_area_below(limit_nm, 830.0);
                let nm = bell.shared_quantile(limit_nm, u);
                let share = bell.shared_area_below(limit_nm, nm) / whole;
                assert!((share - u).abs() < QUANTILE_NM, "{u} {limit_nm} {nm}");
            }
        }
    }

    #[test]
    fn shared_areas_are_sums_of_the_shared_bell() {
        let bell = Bell::new(480.0, 50.0);
        for (limit_nm, to_nm) in [(430.0, 470.0), (490.0, 600.0), (700.0, 455.0), (470.0, 512.0)] {
            let n = 10_000;
            let step = (to_nm - 400.0) / f64::from(n);
            let value = |i: i32| {
                let nm = 400.0 + step * (f64::from(i) + 0.5);
                bell.area_one(nm).0 * (nm / limit_nm).min(1.0)
            };
            let sum: f64 = (0..n).map(value).sum::<f64>() * step;
            // A midpoint sum errs by the square of its step.
            assert!((bell.shared_area_below(limit_nm, to_nm) - sum).abs() < 1e-6, "{limit_nm}");
        }
    }

    #[test]
    fn derivatives_match_differences() {
        let at = |center: f64, nm: f64| Bell::new(center, 45.0).area_one(nm);
        for nm in [495.0, 530.0, 549.0, 551.0, 590.0, 640.0] {
            let h = 1e-4;
            let quotient = (at(550.0 + h, nm).0 - at(550.0 - h, nm).0) / (2.0 * h);
            assert!((at(550.0, nm).1 - quotient).abs() < 1e-9, "{nm}");
        }
    }
}
