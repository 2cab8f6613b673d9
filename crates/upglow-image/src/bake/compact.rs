//! The compact bispectral form: reflectance in bands and maps of the dyes.

use upglow::{Cube, Interpolation, Mixing, Mixture, Model, Node};
use upglow_color::{Grid, LinearRgb};
use upglow_fit::{KindCounts, MaterialKind, Polisher};

use super::maker::{Filled, Maker};
use super::radiance::{NAMES, RadianceMaker};
use super::{BakeError, attributes};
use crate::exr::attribute::Attributes;
use crate::exr::header::Sample;
use crate::exr::writer::Compression;
use crate::spectral::compact::{CompactForm, CompactLayout, MOST_EXTRA_CHANNELS};

/// Fills the channels of a [`CompactLayout`] and a preview.
#[derive(Debug)]
pub(super) struct CompactMaker<'c> {
    cube: &'c Cube,
    layout: CompactLayout,
    preview: RadianceMaker<'c>,
    /// Pooled dyes and films fit in one map per dye only if each texel has a single material.
    polisher: Option<Polisher<'c>>,
}

/// What the channels hold.
const CHANNELS: &str = "compact bispectral form, as docs/spectral-exr.md of upglow describes: \
                        T.<wavelength>: share of the light at a wavelength that leaves in the same \
                        band; the other maps: how much of which dye moves light to other bands; \
                        R, G, B: linear color under the contract's light";

impl<'c> CompactMaker<'c> {
    /// # Errors
    ///
    /// [`BakeError`] if the cube has no dyes, or its dyes do not fit the form.
    pub(super) fn new(cube: &'c Cube, grid: Grid) -> Result<Self, BakeError> {
        let (layout, is_single) = match cube.model() {
            Model::Dyes(dyes) => {
                let fits = dyes.curves().len() <= MOST_EXTRA_CHANNELS;
                let form = if fits { CompactForm::PerDye } else { CompactForm::PerLobe };
                let is_single = fits && dyes.options().mixing == Mixing::Pooled;
                (CompactLayout::new(dyes, grid, form)?, is_single)
            }
            Model::Film(film) => (CompactLayout::in_film(film, grid)?, true),
            model @ (Model::Reflectance | Model::Analytic(_)) => {
                return Err(BakeError::NoDyes { found: model.name() });
            }
        };
        Ok(Self {
            cube,
            layout,
            preview: RadianceMaker::new(cube, cube.contract().illuminant.clone()),
            polisher: is_single.then(|| Polisher::new(cube)).transpose()?,
        })
    }

    /// Passes the mixture that is stored for each texel to `store`, in the order of the texels. Returns
    /// the kinds of the mixtures.
    fn for_each_mixture(
        &self,
        rgb: &[[f32; 3]],
        mut store: impl FnMut(&Mixture<'_>),
    ) -> KindCounts {
        let Some(polisher) = &self.polisher else {
            for rgb in rgb {
                let color = LinearRgb(rgb.map(f64::from));
                let mixture = self.cube.lookup(color, Interpolation::Blend);
                store(&mixture.expect("texels outside were repaired or refused"));
            }
            return self.preview.kinds(rgb);
        };
        let mut nodes = vec![Node::default(); rgb.len()];
        polisher.polish(rgb, &mut nodes).expect("as many materials as texels");
        for node in &nodes {
            store(&Mixture::of(self.cube.model(), node.material(self.cube.model())));
        }
        nodes.iter().map(|node| MaterialKind::of_node(node, self.cube)).collect()
    }
}

impl Maker for CompactMaker<'_> {
    fn channels(&self) -> Vec<String> {
        let preview = NAMES.map(str::to_owned).into_iter();
        preview.chain(self.layout.channel_names()).collect()
    }

    fn attributes(&self) -> Attributes {
        let mut attributes = attributes::spectral(self.cube, CHANNELS);
        attributes.extend(self.layout.attributes());
        attributes
    }

    fn compression(&self) -> Compression {
        Compression::Zips
    }

    /// Half precision would change positions on the ring of dyes.
    fn sample(&self, requested: Sample) -> Sample {
        match self.layout.form() {
            CompactForm::PerDye => requested,
            CompactForm::PerLobe => Sample::Float,
        }
    }

    fn fill(&self, rgb: &[[f32; 3]], planes: &mut [&mut [f32]]) -> Filled {
        let (preview, stored) = planes.split_at_mut(NAMES.len());
        self.preview.fill_rgb(rgb, preview);
        let mut texel = 0;
        let kinds = self.for_each_mixture(rgb, |mixture| {
            let values = self.layout.encode(mixture).expect("the form was chosen for the model");
            for (plane, value) in stored.iter_mut().zip(values) {
                plane[texel] = value;
            }
            texel += 1;
        });
        kinds.into()
    }
}
