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
}

impl Relit {
    pub(crate) fn of(lit: &LitSet, way: &dyn Way) -> Self {
        let made = |(sample, seen): (&Sample, &Vec<(MatrixSums, Lab)>)| {
            let made = way.material(sample);
            let matrix = made.matrix_like(sample.matrix());
            let difference = |(sums, color): &(MatrixSums, Lab)| {
                ciede2000(*color, sums.lab_from_xyz(sums.color(&matrix)))
            };
            (seen.iter().map(difference).collect(), made.is_dyed())
        };
        let (de2000, dyed): (_, Vec<bool>) =
            lit.set.samples.par_iter().zip(&lit.seen).map(made).unzip();
        let told = way.told();
        Self {
            de2000,
            told: lit.lights.iter().map(|light| told.contains(light)).collect(),
            dyed: dyed.into_iter().filter(|is_dyed| *is_dyed).count(),
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
