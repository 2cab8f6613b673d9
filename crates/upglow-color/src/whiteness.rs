//! Whiteness and tint of nearly white surfaces.

use crate::contract::Contract;
use crate::grid::Grid;
use crate::observer::Observer;
use crate::values::Xyz;

/// How white a surface is, and which color its white leans to.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[must_use]
pub struct Whiteness {
    /// Whiteness W; 100 is the perfect diffuser, more is bluer.
    pub whiteness: f64,
    /// Tint T; 0 is the perfect diffuser, positive is greener, negative redder.
    pub tint: f64,
}

/// The whiteness formulas of the CIE for one light and observer.
///
/// # Source
///
/// `cie15_2004`, section 9.1: coefficients and limits of the third edition, which `whiteness_CIE2004` of
/// colour-science 0.4.7 repeats. The fourth edition, `cie015`, was not compared.
#[derive(Clone, Copy, Debug, PartialEq)]
#[must_use]
pub struct WhitenessScale {
    /// The perfect diffuser, x, y.
    white: [f64; 2],
    white_y: f64,
    /// Weight of x in the tint.
    tint_by_x: f64,
}

/// The observers that the formulas are for, and the weight of x in the tint for each.
const OBSERVERS: [(&str, f64); 2] = [("cie-1931-2deg", 1000.0), ("cie-1964-10deg", 900.0)];

/// A light is like D65 if its white is this near in x, y. Smaller would refuse lamps that simulate D65 (FL7
/// and ID65 are 0.003 away); larger would accept D60, 0.012 away, for which the formulas are not meant.
const LIKE_D65: f64 = 0.005;

impl WhitenessScale {
    /// The scale under a light for which `white` is the perfect diffuser; `None` if the formulas are not
    /// defined: for lights that do not have the color of D65, and observers other than those of 1931 and 1964.
    pub fn new(observer: &Observer, white: Xyz) -> Option<Self> {
        let is_it = |word: &str| Observer::named(word).is_ok_and(|o| o.name() == observer.name());
        let (_, tint_by_x) = OBSERVERS.into_iter().find(|(word, _)| is_it(word))?;
        let daylight = Contract { observer: observer.clone(), ..Contract::default() };
        let d65 = daylight.on(Grid::FIT).white().chromaticity()?;
        let [x, y] = white.chromaticity()?;
        let is_near = (x - d65[0]).hypot(y - d65[1]) <= LIKE_D65;
        is_near.then_some(Self { white: [x, y], white_y: white.0[1], tint_by_x })
    }

    /// Whiteness and tint of a color; `None` beyond the limits that the CIE gives for the formulas: a whiteness
    /// above 40 and below 5Y − 280, a tint above −4 and below 2, where Y of the perfect diffuser is 100.
    pub fn of(&self, xyz: Xyz) -> Option<Whiteness> {
        let luminance = 100.0 * xyz.0[1] / self.white_y;
        let [x, y] = xyz.chromaticity()?;
        let [dx, dy] = [self.white[0] - x, self.white[1] - y];
        let whiteness = luminance + 800.0 * dx + 1700.0 * dy;
        let tint = self.tint_by_x * dx - 650.0 * dy;
        let is_white = whiteness > 40.0 && whiteness < 5.0 * luminance - 280.0;
        (is_white && tint > -4.0 && tint < 2.0).then_some(Whiteness { whiteness, tint })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::illuminant::Illuminant;

    fn scale(light: &str, observer: &str) -> Option<WhitenessScale> {
        let illuminant = Illuminant::named(light).unwrap();
        let observer = Observer::named(observer).unwrap();
        let contract = Contract { illuminant, observer: observer.clone(), ..Contract::default() };
        WhitenessScale::new(&observer, contract.on(Grid::FIT).white())
    }

    #[test]
    fn the_perfect_diffuser_has_whiteness_100_and_no_tint() {
        for (observer, _) in OBSERVERS {
            for light in ["D65", "ID65", "FL7"] {
                let scale = scale(light, observer).unwrap();
                let white = Xyz::from_chromaticity(scale.white);
                let Whiteness { whiteness, tint } = scale.of(white).unwrap();
                // Rounding only.
                assert!((whiteness - 100.0).abs() < 1e-9 && tint.abs() < 1e-9, "{light}");
            }
        }
    }

    #[test]
    fn whiteness_has_the_values_of_colour_science() {
        // The example of `colour.colorimetry.whiteness_CIE2004` in colour-science 0.4.7, for each observer.
        for ((_, tint_by_x), tint) in OBSERVERS.into_iter().zip([-1.305, -1.025]) {
            let scale = WhitenessScale { white: [0.3139, 0.3311], white_y: 1.0, tint_by_x };
            let found = scale.of(Xyz::from_chromaticity([0.3167, 0.3334])).unwrap();
            // Rounding only.
            assert!((found.whiteness - 93.85).abs() < 1e-9 && (found.tint - tint).abs() < 1e-9);
        }
    }

    #[test]
    fn whiteness_is_for_whites_under_daylight_alone() {
        for (light, observer) in
            [("A", "cie-1931-2deg"), ("D60", "cie-1931-2deg"), ("D65", "cie-2015-2deg")]
        {
            assert_eq!(scale(light, observer), None, "{light} {observer}");
        }
        let scale = scale("D65", "cie-1931-2deg").unwrap();
        let gray = 0.5 * Xyz::from_chromaticity(scale.white);
        assert_eq!(scale.of(gray), None);
        assert_eq!(scale.of(Xyz([0.5, 1.0, 0.2])), None);
        assert_eq!(scale.of(Xyz([0.0; 3])), None);
    }
}
