//! The lights under which a fitted material must look like a measured matrix.

use upglow_color::{
    Contract, ContractError, DonaldsonMatrix, Illuminant, Matrix3, MatrixSums, Xyz, ciede2000,
};

/// Lights of the goal: whole ones, ultraviolet lamps, and parts of daylight.
pub(super) const LIGHTS: usize = WHOLE.len() + LAMPS + PARTS;
/// Three numbers for each light.
pub(super) const ROWS: usize = 3 * LIGHTS;

/// Daylight, incandescent light, equal energy, and daylight without ultraviolet.
const WHOLE: [&str; 4] = ["D65", "A", "E", "D65-cut400"];

/// Lamps from 330 to 420 nm; each has as much power as daylight, to which the observer is adapted.
const LAMPS: usize = 7;
const FIRST_LAMP_NM: f64 = 330.0;
const LAMP_STEP_NM: f64 = 15.0;
/// Full width at half maximum of a lamp, as of an ultraviolet LED, nm.
const LAMP_FWHM_NM: f64 = 16.0;
/// What a ΔE00 under a lamp counts beside one under a whole light. With 1, the other lights suffer from what a
/// model of few dyes misses under lamps.
const LAMP_WEIGHT: f64 = 0.5;

/// Parts of daylight around 420 to 700 nm. Their differences are seen beside the rest of it.
const PARTS: usize = 15;
const FIRST_PART_NM: f64 = 420.0;
const PART_STEP_NM: f64 = 20.0;
/// Full width at half maximum of a part, nm: with wider ones, lamps with lines are not provided for.
const PART_FWHM_NM: f64 = 40.0;

/// One light of the goal.
#[derive(Clone, Debug)]
struct Light {
    /// Power that arrives in each incident band.
    arriving: Vec<f64>,
    /// Three numbers from XYZ whose squares add up to that of the weighted ΔE00.
    by_xyz: Matrix3,
    /// The measured color.
    measured: Xyz,
}

impl Light {
    /// Lets the light count less, the more of the measured color is noise: as if each ΔE00 that noise makes came to
    /// one ΔE00 of the model. Where a material is nearly black, under most lamps, noise makes many.
    fn weigh_noise(&mut self, noise: f64, matching: &[[f64; 3]]) {
        let power: f64 = self.arriving.iter().map(|e| e * e).sum();
        let mut expected = 0.0;
        for by in self.by_xyz.0 {
            let seen = |m: &[f64; 3]| (by[0] * m[0] + by[1] * m[1] + by[2] * m[2]).powi(2);
            expected += noise * noise * power * matching.iter().map(seen).sum::<f64>();
        }
        self.by_xyz = Matrix3::diagonal([(1.0 + expected).sqrt().recip(); 3]) * self.by_xyz;
    }
}

/// What a fitted material is measured by: small differences of color from a matrix, as CIEDE2000 counts them,
/// under [`LIGHTS`]. Under light of any kind the difference is a sum of those under parts of it.
#[derive(Clone, Debug)]
pub(super) struct MatrixGoal {
    lights: Vec<Light>,
    /// x̄, ȳ, z̄ at each outgoing wavelength.
    pub(super) matching: Vec<[f64; 3]>,
    /// Daylight in each incident band.
    pub(super) daylight: Vec<f64>,
}

impl MatrixGoal {
    pub(super) fn new(measured: &DonaldsonMatrix) -> Result<Self, ContractError> {
        let contract = Contract::default();
        let day = MatrixSums::new(measured, &contract.illuminant, &contract.observer)?;
        let by_xyz = day.difference_by_xyz(day.color(measured));
        let whole = WHOLE.map(|name| Illuminant::named(name).expect("it is built in"));
        let mut lights = Vec::with_capacity(LIGHTS);
        for light in whole {
            let sums = MatrixSums::new(measured, &light, &contract.observer)?;
            let measured = sums.color(measured);
            let by_xyz = sums.difference_by_xyz(measured);
            lights.push(Light { arriving: sums.arriving().to_vec(), by_xyz, measured });
        }
        for k in 0..LAMPS {
            let peak_nm = FIRST_LAMP_NM + LAMP_STEP_NM * k as f64;
            let lamp = Illuminant::line("lamp", peak_nm, LAMP_FWHM_NM).expect("it is visible");
            let sums = measured.seen_under(&contract, &lamp)?;
            let arriving = scaled_to(sums.arriving(), day.arriving().iter().sum());
            let measured = color(measured, &arriving, day.matching());
            let by_xyz = Matrix3::diagonal([LAMP_WEIGHT; 3]) * day.difference_by_xyz(measured);
            lights.push(Light { arriving, by_xyz, measured });
        }
        for k in 0..PARTS {
            let center_nm = FIRST_PART_NM + PART_STEP_NM * k as f64;
            let powers = measured.incident_nm().iter().zip(day.arriving());
            let arriving: Vec<f64> =
                powers.map(|(nm, e)| e * bell(*nm, center_nm, PART_FWHM_NM)).collect();
            let measured = color(measured, &arriving, day.matching());
            lights.push(Light { arriving, by_xyz, measured });
        }
        let matching = day.matching().to_vec();
        let [noise, _] = measured.noise().unwrap_or_default();
        lights.iter_mut().for_each(|light| light.weigh_noise(noise, &matching));
        Ok(Self { lights, matching, daylight: day.arriving().to_vec() })
    }

    /// The color that a matrix on the axes of the measured one makes of unit power in each incident band.
    pub(super) fn colors(&self, matrix: &DonaldsonMatrix) -> Vec<[f64; 3]> {
        let mut colors = vec![[0.0; 3]; matrix.incident_nm().len()];
        for (row, m) in matrix.factors().iter().zip(&self.matching) {
            for (color, factor) in colors.iter_mut().zip(row) {
                (0..3).for_each(|k| color[k] += factor * m[k]);
            }
        }
        colors
    }

    /// Root of the sum of squares of a matrix's weighted differences.
    pub(super) fn distance(&self, matrix: &DonaldsonMatrix) -> f64 {
        self.residuals(&self.colors(matrix)).iter().map(|r| r * r).sum::<f64>().sqrt()
    }

    /// The weighted differences of a material from the measured colors, from the color that it makes of unit
    /// power in each incident band.
    pub(super) fn residuals(&self, colors: &[[f64; 3]]) -> [f64; ROWS] {
        let mut rows = [0.0; ROWS];
        for (light, rows) in self.lights.iter().zip(rows.chunks_mut(3)) {
            let color = sum(&light.arriving, colors);
            rows.copy_from_slice(&(light.by_xyz * (Xyz(color) - light.measured).0));
        }
        rows
    }

    /// The change of [`MatrixGoal::residuals`] with these changes of the colors.
    pub(super) fn change(&self, colors: &[[f64; 3]]) -> [f64; ROWS] {
        let mut rows = [0.0; ROWS];
        for (light, rows) in self.lights.iter().zip(rows.chunks_mut(3)) {
            rows.copy_from_slice(&(light.by_xyz * sum(&light.arriving, colors)));
        }
        rows
    }

    /// The change of [`MatrixGoal::residuals`] with the color of one incident band.
    pub(super) fn change_of_band(&self, incident: usize, color: [f64; 3]) -> [f64; ROWS] {
        let mut rows = [0.0; ROWS];
        for (light, rows) in self.lights.iter().zip(rows.chunks_mut(3)) {
            let arriving = light.arriving[incident];
            rows.copy_from_slice(&(light.by_xyz * color.map(|v| v * arriving)));
        }
        rows
    }
}

fn sum(arriving: &[f64], colors: &[[f64; 3]]) -> [f64; 3] {
    let mut sums = [0.0; 3];
    for (power, color) in arriving.iter().zip(colors) {
        (0..3).for_each(|k| sums[k] += power * color[k]);
    }
    sums
}

fn color(matrix: &DonaldsonMatrix, arriving: &[f64], matching: &[[f64; 3]]) -> Xyz {
    matrix.leaving(arriving).into_iter().zip(matching).map(|(power, m)| power * Xyz(*m)).sum()
}

fn scaled_to(power: &[f64], total: f64) -> Vec<f64> {
    let found: f64 = power.iter().sum();
    power.iter().map(|p| if found > 0.0 { p * total / found } else { 0.0 }).collect()
}

fn bell(nm: f64, center_nm: f64, fwhm_nm: f64) -> f64 {
    (-4.0 * 2f64.ln() * ((nm - center_nm) / fwhm_nm).powi(2)).exp()
}

/// How a fitted matrix looks beside the measured one under one light.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
#[must_use]
pub struct MatrixDifference {
    /// Name of the light.
    pub light: String,
    /// Whether the observer is adapted to it. If not, it is too dark for that: it has as much power as
    /// D65, and the observer is adapted to D65.
    pub is_adapted: bool,
    /// The color of the measured matrix.
    pub measured: Xyz,
    /// The color of the fitted one.
    pub fitted: Xyz,
    /// CIEDE2000 between the two.
    pub de2000: f64,
    /// CIEDE2000 between the measured matrix and itself without what lies below the diagonal: what noise
    /// alone may change.
    pub noise_de2000: f64,
}

impl MatrixDifference {
    /// The difference of two matrices on the same axes.
    ///
    /// # Errors
    ///
    /// [`ContractError`] if the observer sees nothing of D65 on these axes.
    pub fn of(
        measured: &DonaldsonMatrix,
        fitted: &DonaldsonMatrix,
        light: &Illuminant,
    ) -> Result<Self, ContractError> {
        let sums = measured.seen_under(&Contract::default(), light)?;
        let colors = [measured, fitted, &measured.without_noise()].map(|matrix| sums.color(matrix));
        let [own, other, quiet] = colors.map(|xyz| sums.lab_from_xyz(xyz));
        Ok(Self {
            light: light.name().into(),
            is_adapted: sums.is_adapted(),
            measured: colors[0],
            fitted: colors[1],
            de2000: ciede2000(own, other),
            noise_de2000: ciede2000(own, quiet),
        })
    }
}
