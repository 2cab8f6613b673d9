//! 4×4 matrices of measured samples, beside the samples under other lights.

use upglow_color::{
    Contract, DonaldsonMatrix, Grid, Illuminant, LinearRgb, MatrixSums, ReducedBasis, Reduction,
    Xyz, Xyzu, ciede2000,
};

use crate::samples::Sample;

/// How an engine without spectra lights a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Engine {
    /// X, Y, Z, U by parts of daylight.
    Xyzu,
    /// X, Y, Z by the same parts.
    Xyz,
    /// X, Y, Z, U by the sensors themselves, as `fichet_rgb` has it.
    Sensors,
    /// Linear ACEScg times the color under daylight.
    Rgb,
}

impl Engine {
    pub(crate) const ALL: [Self; 4] = [Self::Xyzu, Self::Xyz, Self::Sensors, Self::Rgb];

    /// What reports call it.
    pub(crate) const fn name(self) -> &'static str {
        match self {
            Self::Xyzu => "4×4, parts of daylight",
            Self::Xyz => "3×3, parts of daylight",
            Self::Sensors => "4×4, matching functions",
            Self::Rgb => "ACEScg times a color",
        }
    }

    /// ΔE00 between the light that leaves the last of some samples, which reflect one after the other, and what the
    /// engine makes of it, for each light. The engine knows light by its numbers.
    pub(crate) fn differences(self, samples: &[&Sample], lights: &[Illuminant]) -> Vec<f64> {
        let axes: Vec<Axes<'_>> = samples.iter().map(|sample| Axes::of(sample)).collect();
        let predictions: Vec<_> = axes.iter().map(|axes| self.prediction(axes)).collect();
        let difference = |light| {
            let sums = samples[0].sums(light);
            let mut power = sums.arriving().to_vec();
            let mut found = axes[0].light(&power);
            let mut expected = Xyzu::default();
            for (i, (axes, predict)) in axes.iter().zip(&predictions).enumerate() {
                if i > 0 {
                    power = axes.arriving(samples[i - 1].matrix().outgoing_nm(), &power);
                }
                power = axes.matrix.leaving(&power);
                found = predict(found);
                expected = axes.sum(axes.matrix.outgoing_nm(), &power);
            }
            ciede2000(sums.lab_from_xyz(expected.xyz()), sums.lab_from_xyz(found.xyz()))
        };
        lights.iter().map(difference).collect()
    }

    fn prediction<'a>(self, axes: &'a Axes) -> Box<dyn Fn(Xyzu) -> Xyzu + 'a> {
        let nm = axes.matrix.incident_nm();
        let parts = ReducedBasis::parts_of(nm, axes.own.arriving());
        match self {
            Self::Xyzu => {
                let (reduction, answers) = axes.reduction(&parts);
                let matrix = reduction.matrix(answers);
                Box::new(move |light| matrix * light)
            }
            Self::Xyz => {
                let (reduction, answers) = axes.reduction(&parts);
                let matrix = reduction.without_ultraviolet(reduction.matrix(answers));
                Box::new(move |light| without_ultraviolet(Xyz(matrix * light.xyz().0)))
            }
            Self::Sensors => {
                let sensor = |k: usize| nm.iter().map(|nm| axes.sensors(*nm)[k]).collect();
                let (reduction, answers) = axes.reduction(&[0, 1, 2, 3].map(sensor));
                let matrix = reduction.unlimited(answers);
                Box::new(move |light| matrix * light)
            }
            Self::Rgb => {
                let colorimetry = Contract::default().on(Grid::FIT);
                let rgb = move |xyz| colorimetry.rgb_from_xyz(xyz).0;
                let [color, white] = [axes.own.color(axes.matrix), axes.own.white()].map(&rgb);
                let albedo = [0, 1, 2].map(|k| color[k] / white[k]);
                let colorimetry = Contract::default().on(Grid::FIT);
                Box::new(move |light| {
                    let light = rgb(light.xyz());
                    let leaves = LinearRgb([0, 1, 2].map(|k| albedo[k] * light[k]));
                    without_ultraviolet(colorimetry.xyz_from_rgb(leaves))
                })
            }
        }
    }
}

fn without_ultraviolet(Xyz([x, y, z]): Xyz) -> Xyzu {
    Xyzu([x, y, z, 0.0])
}

/// Sums on the axes of a sample.
struct Axes<'a> {
    matrix: &'a DonaldsonMatrix,
    /// Under daylight.
    own: MatrixSums,
    /// U of daylight before it is scaled to 1.
    ultraviolet_of_daylight: f64,
}

impl<'a> Axes<'a> {
    fn of(sample: &'a Sample) -> Self {
        let (matrix, own) = (sample.matrix(), sample.sums(&Illuminant::default()));
        let ultraviolet = matrix.incident_nm().iter().map(|nm| ReducedBasis::ultraviolet_at(*nm));
        let ultraviolet_of_daylight = ultraviolet.zip(own.arriving()).map(|(u, e)| u * e).sum();
        Self { matrix, own, ultraviolet_of_daylight }
    }

    /// x̄, ȳ, z̄ and the sensor of U; beyond the outgoing axis nothing is seen.
    fn sensors(&self, nm: f64) -> [f64; 4] {
        let seen = self.matrix.outgoing_nm().iter().position(|other| *other == nm);
        let [x, y, z] = seen.map_or([0.0; 3], |o| self.own.matching()[o]);
        [x, y, z, ReducedBasis::ultraviolet_at(nm) / self.ultraviolet_of_daylight]
    }

    /// Power in the incident bands, of power in the outgoing bands of another sample. What these do not have is dark.
    fn arriving(&self, outgoing_nm: &[f64], power: &[f64]) -> Vec<f64> {
        let of =
            |nm: &f64| outgoing_nm.iter().position(|other| other == nm).map_or(0.0, |o| power[o]);
        self.matrix.incident_nm().iter().map(of).collect()
    }

    /// The numbers of a light of this power.
    fn light(&self, arriving: &[f64]) -> Xyzu {
        self.sum(self.matrix.incident_nm(), arriving)
    }

    fn sum(&self, axis_nm: &[f64], power: &[f64]) -> Xyzu {
        let mut sum = [0.0; 4];
        for (nm, power) in axis_nm.iter().zip(power) {
            let sensors = self.sensors(*nm);
            (0..4).for_each(|k| sum[k] += sensors[k] * power);
        }
        Xyzu(sum)
    }

    /// How matrices are made by four lights, and what the sample makes of these.
    fn reduction(&self, lights: &[Vec<f64>; 4]) -> (Reduction, [Xyzu; 4]) {
        let white = self.light(self.own.arriving());
        let reduction = Reduction::try_new(lights.each_ref().map(|light| self.light(light)), white)
            .expect("an observer tells the parts of daylight apart");
        let answer =
            |light: &Vec<f64>| self.sum(self.matrix.outgoing_nm(), &self.matrix.leaving(light));
        (reduction, lights.each_ref().map(answer))
    }
}
