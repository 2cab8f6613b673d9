//! How the materials of many colors look under lights, to observers.

use rayon::prelude::*;
use upglow::{Cube, LookupError, Material, Mixture, Model, ModelOnGrid};
use upglow_color::{
    Colorimetry, Contract, ContractError, Grid, Illuminant, Lab, LinearRgb, MissingUltraviolet,
    Observer, SeenUnder, Whiteness, WhitenessScale, Xyz, ciede2000,
};

use crate::metamers::Metamers;
use crate::own_material::OwnMaterial;

/// Materials of colors, to be seen under lights.
///
/// Colors between the nodes of a cube are blends of the materials around them. Each material is computed once
/// per light, however many colors it takes part in.
#[must_use]
#[derive(Clone, Debug)]
pub struct Relighting<'c> {
    contract: &'c Contract,
    source: Source<'c>,
    /// For each color all materials that may have it, all of one search; none where these were not searched.
    metamers: Vec<Metamers>,
}

/// Where the materials come from.
#[derive(Clone, Debug)]
enum Source<'c> {
    /// Blends of materials of one model.
    Cube {
        model: &'c Model,
        /// Those that take part in a color.
        materials: Vec<Material>,
        /// For each color four of the materials and their weights.
        blends: Vec<[(usize, f64); 4]>,
    },
    /// Materials with models of their own.
    Own(Vec<OwnMaterial>),
}

/// What takes no part in a blend.
const NOTHING: (usize, f64) = (0, 0.0);

impl<'c> Relighting<'c> {
    /// The blends that the cube returns for colors.
    ///
    /// # Errors
    ///
    /// [`LookupError`] if a component of a color is not a number in 0..=1.
    pub fn of_colors(cube: &'c Cube, colors: &[LinearRgb]) -> Result<Self, LookupError> {
        let around = colors.iter().map(|&rgb| cube.corners(rgb));
        let mut blends = around.collect::<Result<Vec<_>, _>>()?;
        let mut materials = Vec::new();
        let mut places = vec![None; cube.nodes().len()];
        for corner in blends.iter_mut().flatten() {
            let (node, weight) = *corner;
            *corner = NOTHING;
            if weight > 0.0 {
                let place = *places[node].get_or_insert_with(|| {
                    materials.push(cube.node_material(node));
                    materials.len() - 1
                });
                *corner = (place, weight);
            }
        }
        Ok(Self::of_blends(cube, materials, blends))
    }

    /// The nodes of the cube.
    pub fn of_nodes(cube: &'c Cube) -> Self {
        Self::of_materials(cube, (0..cube.nodes().len()).map(|i| cube.node_material(i)).collect())
    }

    /// Materials of the cube's model.
    pub fn of_materials(cube: &'c Cube, materials: Vec<Material>) -> Self {
        let alone = |place| [(place, 1.0), NOTHING, NOTHING, NOTHING];
        let blends = (0..materials.len()).map(alone).collect();
        Self::of_blends(cube, materials, blends)
    }

    /// Materials with models of their own, that have their colors under the light of `contract`.
    pub fn of_own_materials(contract: &'c Contract, materials: Vec<OwnMaterial>) -> Self {
        Self { contract, source: Source::Own(materials), metamers: Vec::new() }
    }

    fn of_blends(cube: &'c Cube, materials: Vec<Material>, blends: Vec<[(usize, f64); 4]>) -> Self {
        let source = Source::Cube { model: cube.model(), materials, blends };
        Self { contract: cube.contract(), source, metamers: Vec::new() }
    }

    /// The same with a band for each color: how far others are of all materials that may have it, which one search
    /// found, in the order of the colors.
    pub fn with_metamers(self, metamers: Vec<Metamers>) -> Self {
        Self { metamers, ..self }
    }

    /// A blend that the cube returned.
    pub fn of_mixture(cube: &'c Cube, mixture: &Mixture<'c>) -> Self {
        let mut blend = [NOTHING; 4];
        let mut materials = Vec::new();
        for (place, (weight, material)) in mixture.parts().enumerate() {
            blend[place] = (place, weight);
            materials.push(material);
        }
        Self::of_blends(cube, materials, vec![blend])
    }

    /// What is to say about these materials under a light: ultraviolet that is not known, where a dye in one of
    /// them absorbs.
    pub fn missing_ultraviolet(&self, light: &Illuminant) -> Option<MissingUltraviolet> {
        light.missing_ultraviolet()?;
        match &self.source {
            Source::Cube { model, materials, .. } => {
                let mut mixtures = materials.iter().map(|&m| Mixture::of(model, m));
                mixtures.find_map(|mixture| mixture.missing_ultraviolet(light))
            }
            Source::Own(own) => own.iter().find_map(|m| m.mixture().missing_ultraviolet(light)),
        }
    }

    /// An observer of these materials.
    ///
    /// # Errors
    ///
    /// [`ContractError`] if the observer does not see the light of the contract.
    pub fn seen_by(&self, observer: &Observer) -> Result<SeenBy<'_>, ContractError> {
        let contract = Contract { observer: observer.clone(), ..self.contract.clone() };
        contract.check()?;
        let own = contract.on(Grid::FIT);
        let colors = self.colors(&own);
        let labs = colors.iter().map(|&(color, _)| own.lab_from_xyz(color)).collect();
        Ok(SeenBy { relighting: self, contract, own, labs })
    }

    /// The colors, and what of them fluorescence emits.
    fn colors(&self, colorimetry: &Colorimetry) -> Vec<(Xyz, Xyz)> {
        let (model, materials, blends) = match &self.source {
            Source::Cube { model, materials, blends } => (model, materials, blends),
            Source::Own(own) => {
                let color = |material: &OwnMaterial| {
                    let sums = ModelOnGrid::new(material.model(), colorimetry);
                    material.mixture().color_and_emission(&sums)
                };
                return own.par_iter().map(color).collect();
            }
        };
        let sums = ModelOnGrid::new(model, colorimetry);
        let each = materials.par_iter().map(|&material| sums.color_and_emission(material));
        let each: Vec<(Xyz, Xyz)> = each.collect();
        let blend = |parts: &[(usize, f64); 4]| {
            let parts = || parts.iter().filter(|(_, weight)| *weight > 0.0);
            let color: Xyz = parts().map(|&(place, weight)| each[place].0 * weight).sum();
            let emitted: Xyz = parts().map(|&(place, weight)| each[place].1 * weight).sum();
            (color, emitted)
        };
        blends.par_iter().map(blend).collect()
    }
}

/// Materials in the eyes of an observer, who knows how they look under the light of the cube.
#[must_use]
#[derive(Clone, Debug)]
pub struct SeenBy<'r> {
    relighting: &'r Relighting<'r>,
    contract: Contract,
    own: Colorimetry,
    /// The colors under the light of the cube.
    labs: Vec<Lab>,
}

impl SeenBy<'_> {
    /// How the materials look under a light, by sums over 5 nm on all threads of the current rayon pool. Results
    /// do not depend on their number.
    pub fn under(&self, light: &Illuminant) -> View {
        let seen = self.contract.seen_under(light, Grid::FIT);
        let own_from_seen = seen.own_from_seen(&self.own);
        let scale = WhitenessScale::new(&self.contract.observer, seen.white);
        let scale = scale.filter(|_| seen.is_adapted);
        let appearance = |((xyz, emitted), own): ((Xyz, Xyz), &Lab)| {
            let adapted = || self.own.lab_from_xyz(Xyz(own_from_seen * xyz.0));
            Appearance {
                xyz,
                lab: upglow_color::lab_from_xyz(xyz, seen.white),
                rgb: seen.colorimetry.rgb_from_xyz(xyz),
                de2000: seen.is_adapted.then(|| ciede2000(*own, adapted())),
                fluorescent_share: (xyz.0[1] > 0.0).then(|| emitted.0[1] / xyz.0[1]),
                whiteness: scale.and_then(|scale| scale.of(xyz)),
                band_de2000: None,
            }
        };
        let colors = self.relighting.colors(&seen.colorimetry);
        let appearances = colors.into_par_iter().zip(&self.labs).map(appearance);
        let mut appearances: Vec<Appearance> = appearances.collect();
        let metamers = &self.relighting.metamers;
        if let Some(first) = metamers.first() {
            let light = first.light_for(&self.contract.observer, light);
            appearances.par_iter_mut().zip(metamers).for_each(|(appearance, metamers)| {
                let band = metamers.band(&light, appearance.xyz, Metamers::USUAL_SHARE);
                appearance.band_de2000 = Some(band);
            });
        }
        View { seen, appearances }
    }

    /// What an RGB renderer multiplies with the RGB of a light to get the colors under it: each over that of the
    /// perfect diffuser, component by component, in the RGB space of the cube.
    ///
    /// # Errors
    ///
    /// [`ColoredLightError`] if the light is outside that space.
    pub fn rgb_over_white(&self, light: &Illuminant) -> Result<Vec<LinearRgb>, ColoredLightError> {
        let view = self.under(light);
        let white = ColoredLightError::check(&self.own, view.seen.colorimetry.white())?;
        let over = |appearance: &Appearance| {
            let rgb = self.own.rgb_from_xyz(appearance.xyz);
            LinearRgb([0, 1, 2].map(|k| rgb.0[k] / white.0[k]))
        };
        Ok(view.appearances.iter().map(over).collect())
    }
}

/// What an observer sees of materials under a light.
#[derive(Clone, Debug, PartialEq)]
pub struct View {
    /// The light and what the observer sees as white.
    pub seen: SeenUnder,
    /// One for each material.
    pub appearances: Vec<Appearance>,
}

/// A light whose RGB are not all positive: no RGB renderer can show it.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("white is {:.4}, {:.4}, {:.4} under this light, expected RGB above 0", rgb[0], rgb[1], rgb[2])]
pub struct ColoredLightError {
    /// The perfect diffuser under the light, in the RGB space of the cube.
    pub rgb: [f64; 3],
}

impl ColoredLightError {
    /// The RGB of the perfect diffuser, whose color is `white`, by the matrices of `colorimetry`.
    ///
    /// # Errors
    ///
    /// The error, if one of them is not positive.
    pub fn check(colorimetry: &Colorimetry, white: Xyz) -> Result<LinearRgb, Self> {
        let white = colorimetry.rgb_from_xyz(white);
        if white.0.iter().all(|v| *v > 0.0) { Ok(white) } else { Err(Self { rgb: white.0 }) }
    }
}

/// How a material looks under a light.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Appearance {
    /// Its color under the light; Y = 1 is white under it if the observer is adapted to the light, else white under
    /// the light of the cube, at equal power.
    pub xyz: Xyz,
    /// CIELAB relative to what the observer sees as white.
    pub lab: Lab,
    /// Linear RGB in the space of the cube.
    pub rgb: LinearRgb,
    /// CIEDE2000 between this color and that under the light of the cube, each as seen by the observer adapted to the
    /// light: 0 for grays. `None` under a light that nobody can adapt to.
    pub de2000: Option<f64>,
    /// Share of Y that fluorescence emits, 0..=1; `None` for black.
    pub fluorescent_share: Option<f64>,
    /// Whiteness and tint, where they are defined.
    pub whiteness: Option<Whiteness>,
    /// How far the material may be off: the ΔE00 from this color within which nine of ten materials are that may
    /// have the color under the light of the cube, by their probabilities; where these were searched.
    pub band_de2000: Option<f64>,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Fitter, Preset};
    use upglow::{FitRecord, Interpolation, Node};

    /// Nodes of 3³ fitted one by one.
    fn cube() -> Cube {
        let contract = Contract::default();
        let (model, options) = (Preset::Natural.model(), Preset::Natural.options());
        let fitter = Fitter::new(&contract, &model, options).unwrap();
        let halves = |i: usize| f64::from(u8::try_from(i % 3).unwrap()) / 2.0;
        let node = |i: usize| {
            let fit = fitter.fit(LinearRgb([halves(i), halves(i / 3), halves(i / 9)])).unwrap();
            Node::new(fit.reflectance, fit.fluorescence, fit.de2000)
        };
        let nodes = (0..27).map(node).collect();
        Cube::new(contract, model, FitRecord::default(), 3, nodes).unwrap()
    }

    #[test]
    fn colors_are_those_of_the_blends_to_the_last_bit() {
        let cube = cube();
        let colors = [[0.9, 0.1, 0.8], [0.5, 0.5, 0.5], [0.0, 0.25, 1.0]].map(LinearRgb);
        let relighting = Relighting::of_colors(&cube, &colors).unwrap();
        let observer = Observer::default();
        let seen_by = relighting.seen_by(&observer).unwrap();
        for light in ["D65", "A", "FL2"] {
            let light = Illuminant::named(light).unwrap();
            let view = seen_by.under(&light);
            let sums = ModelOnGrid::new(cube.model(), &view.seen.colorimetry);
            for (rgb, found) in colors.into_iter().zip(view.appearances) {
                let blend = cube.lookup(rgb, Interpolation::Blend).unwrap();
                assert_eq!(found.xyz, blend.color(&sums));
            }
        }
    }

    #[test]
    fn over_white_grays_are_themselves_under_every_light_and_colors_under_their_own() {
        // Rounding of a matrix and its inverse.
        const ROUNDING: f64 = 1e-12;
        let cube = cube();
        let nodes = Relighting::of_nodes(&cube);
        let observer = Observer::default();
        let seen_by = nodes.seen_by(&observer).unwrap();
        let own = ModelOnGrid::new(cube.model(), &cube.contract().on(Grid::FIT));
        for light in ["D65", "A", "FL11", "LED-B3"] {
            let light_seen = Illuminant::named(light).unwrap();
            let over_white = seen_by.rgb_over_white(&light_seen).unwrap();
            for (gray, expected) in [(0, 0.0), (13, 0.5), (26, 1.0)] {
                // Rounding of the nodes to single precision, and fits of black and white.
                let error = over_white[gray].0.map(|v| (v - expected).abs());
                assert!(error.iter().all(|e| *e < 1e-5), "{light} {:?}", over_white[gray]);
            }
            for (node, found) in over_white.iter().enumerate().filter(|_| light == "D65") {
                let color = own.color(cube.node_material(node));
                let expected = own.colorimetry().rgb_from_xyz(color).0;
                let error = [0, 1, 2].map(|k| (found.0[k] - expected[k]).abs());
                assert!(error.iter().all(|e| *e < ROUNDING), "{found:?} {expected:?}");
            }
        }
        let laser = Illuminant::line("laser", 500.0, 2.0).unwrap();
        let refused = seen_by.rgb_over_white(&laser).unwrap_err();
        assert!(refused.rgb[0] < 0.0, "{refused}");
    }

    #[test]
    fn grays_stay_under_every_light_and_magenta_does_not() {
        // Rounding of Bradford's matrices, in ΔE00.
        const ROUNDING: f64 = 1e-8;
        let cube = cube();
        let colors = [[0.5; 3], [0.3; 3], [1.0; 3], [0.9, 0.0, 0.9]].map(LinearRgb);
        let relighting = Relighting::of_colors(&cube, &colors).unwrap();
        for observer in Observer::NAMES {
            let observer = Observer::named(observer).unwrap();
            let seen_by = relighting.seen_by(&observer).unwrap();
            for light in Illuminant::names() {
                let light = Illuminant::named(light).unwrap();
                let view = seen_by.under(&light);
                let moved = view.appearances.iter().map(|seen| seen.de2000.unwrap());
                let moved: Vec<f64> = moved.collect();
                assert!(moved[..3].iter().all(|&moved| moved < ROUNDING), "{moved:?}");
                let is_own = light == cube.contract().illuminant;
                assert_eq!(moved[3] < ROUNDING, is_own, "{} {moved:?}", light.name());
                let glow = view.appearances.iter().map(|seen| seen.fluorescent_share.unwrap());
                let glow: Vec<f64> = glow.collect();
                assert!(glow[..3] == [0.0; 3] && glow[3] > 0.0 && glow[3] < 1.0, "{glow:?}");
            }
        }
    }

    #[test]
    fn under_an_ultraviolet_lamp_nobody_is_adapted_and_all_light_is_fluorescence() {
        let cube = cube();
        let magenta = [LinearRgb([0.9, 0.0, 0.9])];
        let relighting = Relighting::of_colors(&cube, &magenta).unwrap();
        let seen_by = relighting.seen_by(&cube.contract().observer).unwrap();
        let lamp = Illuminant::mineral_lamp();
        let view = seen_by.under(&lamp);
        assert!(!view.seen.is_adapted);
        let Appearance { de2000, fluorescent_share, whiteness, .. } = view.appearances[0];
        assert_eq!((de2000, whiteness), (None, None));
        assert!(fluorescent_share.unwrap() > 0.99, "{fluorescent_share:?}");
    }

    #[test]
    fn the_white_node_is_the_perfect_diffuser() {
        let cube = cube();
        let relighting = Relighting::of_nodes(&cube);
        let seen_by = relighting.seen_by(&cube.contract().observer).unwrap();
        let view = seen_by.under(&cube.contract().illuminant);
        let Whiteness { whiteness, tint } = view.appearances[26].whiteness.unwrap();
        // Single precision of the node.
        assert!((whiteness - 100.0).abs() < 1e-3 && tint.abs() < 1e-3, "{whiteness} {tint}");
        assert_eq!(view.appearances[0].whiteness, None);
    }
}
