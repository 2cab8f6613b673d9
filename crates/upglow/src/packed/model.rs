//! A model of fluorescence, with its curves as inner loops read them.

use fearless_simd::Level;

use crate::material::formula::Mixing;
use crate::material::model::Model;
use crate::packed::bells::Bells;
use crate::packed::curve_table::CurveTable;

/// What packed materials of one model share.
#[derive(Clone, Debug)]
pub(crate) struct PackedModel {
    pub(crate) model: Model,
    pub(crate) rule: Rule,
    pub(crate) curves: CurveTable,
    pub(crate) absorption_bells: Bells,
    pub(crate) emission_bells: Bells,
    /// The vectors for several wavelengths at once.
    pub(crate) simd_level: Level,
}

/// How two dyes of one material make lobes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Rule {
    /// Two neighbors of a ring; bells make one lobe, as pooled dyes do.
    Ring(Mixing),
    /// Any two in a film: a lobe each.
    Film,
}

impl Rule {
    /// How many lobes a material has.
    #[inline(always)]
    pub(crate) fn lobes(self) -> usize {
        match self {
            Self::Ring(mixing) => mixing.lobes(),
            Self::Film => 2,
        }
    }
}

impl PackedModel {
    pub(crate) fn new(model: &Model) -> Self {
        let [absorption_bells, emission_bells] = Bells::of(model);
        let rule = match model {
            Model::Dyes(dyes) => Rule::Ring(dyes.options().mixing),
            Model::Film(_) => Rule::Film,
            Model::Reflectance | Model::Analytic(_) => Rule::Ring(Mixing::Pooled),
        };
        let (curves, simd_level) = (CurveTable::new(model), Level::new());
        Self { model: model.clone(), rule, curves, absorption_bells, emission_bells, simd_level }
    }
}
