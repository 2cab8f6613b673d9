//! The lights that materials are shown under.

use serde_json::json;
use upglow::Cube;
use upglow_color::{
    Contract, Grid, Illuminant, Matrix3, MissingUltraviolet, RgbSpace, Screen, SeenUnder,
};

/// Ultraviolet light ends here, nm: what the page scales, and what a filter takes away.
pub(crate) const ULTRAVIOLET_BELOW_NM: f64 = 400.0;

/// Daylights, incandescent light, equal energy, and one or two lamps of each kind. All built-in lights
/// would make the page too long.
const SHOWN: [&str; 10] = ["D65", "D60", "D55", "D50", "A", "E", "FL2", "FL11", "HP1", "LED-B3"];

/// The contract's light, those shown always, daylight behind a filter, and an ultraviolet lamp.
pub(crate) fn lights(contract: &Contract) -> Vec<Illuminant> {
    let own = &contract.illuminant;
    let built_in = SHOWN.iter().filter_map(|name| Illuminant::named(name).ok());
    let others = built_in.chain(filtered_daylight()).chain([Illuminant::mineral_lamp()]);
    std::iter::once(own.clone()).chain(others.filter(|light| light.name() != own.name())).collect()
}

/// D65 without ultraviolet.
fn filtered_daylight() -> Option<Illuminant> {
    let daylight = Illuminant::default();
    daylight.cut_below(&format!("{} without UV", daylight.name()), ULTRAVIOLET_BELOW_NM).ok()
}

/// A light, with all that the page needs to show materials under it.
#[derive(Clone, Debug)]
pub(crate) struct ShownLight {
    pub(crate) name: String,
    pub(crate) seen: SeenUnder,
    /// Its power on [`Grid::FINE`] over the greatest.
    pub(crate) power: Vec<f64>,
    /// What it lacks that dyes of the cube absorb.
    missing: Option<MissingUltraviolet>,
}

impl ShownLight {
    pub(crate) fn new(cube: &Cube, light: &Illuminant) -> Self {
        let power = light.power().values();
        let peak = power.iter().copied().fold(0.0, f64::max);
        Self {
            name: light.name().into(),
            seen: cube.contract().seen_under(light, Grid::FIT),
            power: power.iter().map(|power| power / peak).collect(),
            missing: cube.model().missing_ultraviolet(light),
        }
    }

    /// Linear RGB of a screen of this space from XYZ under the light: what is seen as white is the
    /// screen's white.
    fn screen_from_xyz(&self, space: &str) -> Matrix3 {
        let space = RgbSpace::named(space).unwrap_or_default();
        Screen::new(space, self.seen.white).rgb_from_xyz_matrix()
    }

    /// What the page reads of it besides its numbers by wavelength.
    pub(crate) fn description(&self) -> serde_json::Value {
        json!({
            "name": self.name,
            "is_adapted": self.seen.is_adapted,
            "white": self.seen.white.0,
            "missing_ultraviolet": self.missing.as_ref().map(|missing| json!({
                "from_nm": missing.from_nm,
                "sentence": missing.to_string(),
            })),
            "screen": {
                "srgb": self.screen_from_xyz("srgb").0,
                "p3": self.screen_from_xyz("p3-d65").0,
            },
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use upglow::{FitRecord, Model, Node};

    #[test]
    fn lights_that_lack_what_dyes_absorb_say_so() {
        let missing = |cube: &Cube| -> Vec<String> {
            let lights = lights(cube.contract());
            let told = lights.iter().map(|light| ShownLight::new(cube, light).description());
            told.filter_map(|told| Some(told["missing_ultraviolet"]["sentence"].as_str()?.into()))
                .collect()
        };
        let said = ["FL2", "FL11", "HP1", "LED-B3"].map(|name| {
            format!("{name} is given from 380 nm on: what dyes absorb below is not counted")
        });
        assert_eq!(missing(&crate::test_cube()), said);
        let nodes = vec![Node::default(); 8];
        let (contract, fit) = (Contract::default(), FitRecord::default());
        let flat = Cube::new(contract, Model::Reflectance, fit, 2, nodes).unwrap();
        assert_eq!(missing(&flat), [""; 0]);
    }
}
