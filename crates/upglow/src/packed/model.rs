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
    /// That of the dyes; bells make one lobe too.
    pub(crate) mixing: Mixing,
    pub(crate) curves: CurveTable,
    pub(crate) absorption_bells: Bells,
    pub(crate) emission_bells: Bells,
    /// The vectors for several wavelengths at once.
    pub(crate) simd_level: Level,
}

impl PackedModel {
    pub(crate) fn new(model: &Model) -> Self {
        let [absorption_bells, emission_bells] = Bells::of(model);
        let mixing = match model {
            Model::Dyes(dyes) => dyes.options().mixing,
            Model::Reflectance | Model::Analytic(_) => Mixing::Pooled,
        };
        let (curves, simd_level) = (CurveTable::new(model), Level::new());
        Self { model: model.clone(), mixing, curves, absorption_bells, emission_bells, simd_level }
    }
}
