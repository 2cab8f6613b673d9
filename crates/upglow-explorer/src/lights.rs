//! The lights that materials are shown under.

use upglow_color::{Adaptation, Contract, Grid, Illuminant, Matrix3, RgbSpace, SeenUnder};

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
}

impl ShownLight {
    pub(crate) fn new(contract: &Contract, light: &Illuminant) -> Self {
        let power = light.power().values();
        let peak = power.iter().copied().fold(0.0, f64::max);
        Self {
            name: light.name().into(),
            seen: contract.seen_under(light, Grid::FIT),
            power: power.iter().map(|power| power / peak).collect(),
        }
    }

    /// Linear RGB of a screen of this space from XYZ under the light: what is seen as white is the
    /// screen's white.
    fn screen_from_xyz(&self, space: &str) -> Matrix3 {
        let space = RgbSpace::named(space).unwrap_or_default();
        let screen = Contract { space, ..Contract::default() }.on(Grid::FIT);
        let adapted = Adaptation::default().target_from_source(self.seen.white, screen.white());
        screen.rgb_from_xyz_matrix() * adapted
    }

    /// What the page reads of it besides its numbers by wavelength.
    pub(crate) fn description(&self) -> serde_json::Value {
        serde_json::json!({
            "name": self.name,
            "is_adapted": self.seen.is_adapted,
            "white": self.seen.white.0,
            "screen": {
                "srgb": self.screen_from_xyz("srgb").0,
                "p3": self.screen_from_xyz("p3-d65").0,
            },
        })
    }
}
