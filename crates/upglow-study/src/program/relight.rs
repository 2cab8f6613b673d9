//! How materials that were made of what is known of surfaces look under other lights, beside the surfaces.

use std::ops::Range;

use rayon::prelude::*;
use upglow_color::{Illuminant, Lab, MatrixSums, ciede2000};

use crate::samples::{Sample, SampleSet};
use crate::spread::Spread;
use crate::ways::Way;

/// Samples under lights.
#[derive(Clone, Debug)]
pub(crate) struct LitSet<'a> {
    set: &'a SampleSet,
    lights: &'a [Illuminant],
    /// The sums under each light and the color, `[sample][light]`.
    seen: Vec<Vec<(MatrixSums, Lab)>>,
}

impl<'a> LitSet<'a> {
    pub(crate) fn new(set: &'a SampleSet, lights: &'a [Illuminant]) -> Self {
        let under = |sample: &Sample, light| {
            let sums = sample.sums(light);
            let color = sums.lab_from_xyz(sums.color(sample.matrix()));
            (sums, color)
        };
        let seen = |sample| lights.iter().map(|light| under(sample, light)).collect();
        Self { set, lights, seen: set.samples.par_iter().map(seen).collect() }
    }
}

/// How far the materials of one way are from a set of samples.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Relit {
    /// ΔE00, `[sample][light]`.
    de2000: Vec<Vec<f64>>,
    /// Whether the way was told the color, `[light]`.
    pub(crate) told: Vec<bool>,
    /// How many materials have a dye.
    pub(crate) dyed: usize,
    /// Of the colors that the way was not told, the share that is within its band; `None` if it has none.
    pub(crate) in_band: Option<f64>,
}

impl Relit {
    pub(crate) fn of(lit: &LitSet, way: &dyn Way) -> Self {
        let told = way.told();
        let told: Vec<bool> = lit.lights.iter().map(|light| told.contains(light)).collect();
        let made = |(sample, seen): (&Sample, &Vec<(MatrixSums, Lab)>)| {
            let made = way.material(sample);
            let matrix = made.matrix_like(sample.matrix());
            let mut in_band = Vec::new();
            let mut de2000 = Vec::with_capacity(seen.len());
            for (k, (sums, color)) in seen.iter().enumerate() {
                let answer = sums.color(&matrix);
                let error = ciede2000(*color, sums.lab_from_xyz(answer));
                de2000.push(error);
                let band = (!told[k]).then(|| made.band(&lit.lights[k], answer)).flatten();
                in_band.extend(band.map(|band| f64::from(u8::from(error <= band))));
            }
            (de2000, made.is_dyed(), in_band)
        };
        let made: Vec<_> = lit.set.samples.par_iter().zip(&lit.seen).map(made).collect();
        let in_band: Vec<f64> = made.iter().flat_map(|(.., in_band)| in_band).copied().collect();
        Self {
            dyed: made.iter().filter(|(_, is_dyed, _)| *is_dyed).count(),
            in_band: (!in_band.is_empty()).then(|| Spread::of(in_band).mean),
            de2000: made.into_iter().map(|(de2000, ..)| de2000).collect(),
            told,
        }
    }

    /// ΔE00 of each sample under one of the lights.
    pub(crate) fn under(&self, light: usize) -> Vec<f64> {
        self.de2000.iter().map(|sample| sample[light]).collect()
    }

    /// The mean of each sample over those of some lights that the way was not told of.
    pub(crate) fn means(&self, lights: Range<usize>) -> Vec<f64> {
        let others = || lights.clone().filter(|light| !self.told[*light]);
        let mean = |sample: &Vec<f64>| Spread::of(others().map(|light| sample[light])).mean;
        self.de2000.iter().map(mean).collect()
    }
}

/// Sets of samples. Without measured fluorescent materials there is no set of these.
pub(crate) fn sets(measured: &[Sample]) -> Vec<SampleSet> {
    let mut sets = vec![SampleSet::object_colors(), SampleSet::paints()];
    if !measured.is_empty() {
        sets.push(SampleSet::fluorescent(measured));
    }
    sets
}
