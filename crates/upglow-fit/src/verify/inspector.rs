//! Checks one color after another and records the findings.

use upglow::{Bispectral, Cube, Interpolation, Mixture, ModelOnGrid};
use upglow_color::{LinearRgb, Xyz, ciede2000};

use super::VerifyOptions;
use super::finding::{Finding, Outcome, Subject, greatest, worse};
use super::laws::{LAWS, Law, Rule};
use super::spectra::{Sampler, Spectra};
use super::subjects::Subjects;
use crate::cube::CubeSummary;

/// How many random colors are compared with the run-time library, at a millisecond each. Fewer would
/// miss the rarer dyes.
const LIBRARY_POINTS: usize = 64;

/// How many random colors are compared for every pair of wavelengths, at 30 ms each.
const PAIR_POINTS: usize = 4;

/// The findings of a piece of the work.
#[derive(Clone, Debug, Default)]
pub(super) struct Findings {
    /// One for each of [`LAWS`].
    pub(super) laws: [Outcome; LAWS.len()],
    /// Sums over 1 nm against 5 nm for nodes that match, CIEDE2000.
    pub(super) grid_nodes: Figure,
    /// The same for random colors between such nodes.
    pub(super) grid_points: Figure,
    /// The same for all other nodes and random colors.
    pub(super) grid_missed: Figure,
    /// Random colors against their targets, CIEDE2000.
    pub(super) points: Figure,
}

/// Numbers of which the mean, a percentile or the greatest is reported.
#[derive(Clone, Debug, Default)]
pub(super) struct Figure {
    pub(super) values: Vec<f64>,
    pub(super) outcome: Outcome,
}

/// A cube, and what the checks of all its colors have in common.
pub(super) struct Inspector<'c> {
    cube: &'c Cube,
    interpolation: Interpolation,
    pub(super) subjects: Subjects,
    sampler: Sampler<'c>,
    pub(super) rules: [Rule; LAWS.len()],
}

impl Findings {
    /// Merges the findings of a later piece.
    pub(super) fn add(&mut self, later: Self) {
        for (sum, outcome) in self.laws.iter_mut().zip(later.laws) {
            sum.add(outcome);
        }
        self.grid_nodes.add(later.grid_nodes);
        self.grid_points.add(later.grid_points);
        self.grid_missed.add(later.grid_missed);
        self.points.add(later.points);
    }
}

impl Figure {
    fn see(&mut self, finding: Finding) {
        self.values.push(finding.value);
        self.outcome.see(finding, f64::INFINITY);
    }

    fn add(&mut self, later: Self) {
        self.values.extend(later.values);
        self.outcome.add(later.outcome);
    }
}

impl<'c> Inspector<'c> {
    pub(super) fn new(cube: &'c Cube, options: &VerifyOptions) -> Self {
        Self {
            cube,
            interpolation: options.interpolation,
            subjects: Subjects::new(cube, options),
            sampler: Sampler::new(cube.contract(), cube.model()),
            rules: LAWS.map(|law| law.rule(cube, options)),
        }
    }

    /// Checks one piece of the work; `spectra` is scratch space.
    pub(super) fn inspect(&self, piece: usize, spectra: &mut Spectra) -> Findings {
        let mut findings = Findings::default();
        for index in self.subjects.piece(piece) {
            let subject = self.subjects.get(index);
            let mixture = self.mixture(subject);
            self.sampler.sample(mixture.parts(), spectra);
            self.see_light(subject, spectra, &mut findings);
            self.see_slope(subject, spectra, &mut findings);
            self.see_gray(subject, &mixture, spectra, &mut findings);
            self.see_color(subject, spectra, &mut findings);
            if self.subjects.is_among_first_points(index, LIBRARY_POINTS) {
                self.see_library(subject, &mixture, spectra, &mut findings);
            }
            if self.subjects.is_among_first_points(index, PAIR_POINTS) {
                let colors = [spectra.color(&self.sampler.fine), self.color_by_pairs(&mixture)];
                self.see(Law::Library, subject, difference(colors), None, &mut findings);
            }
        }
        findings
    }

    fn mixture(&self, subject: Subject) -> Mixture<'c> {
        match subject {
            Subject::Node(index) => Mixture::of(self.cube.model(), self.cube.node_material(index)),
            Subject::Gray(rgb) | Subject::Point(rgb) => {
                self.cube.lookup(rgb, self.interpolation).expect("subjects lie in 0..=1")
            }
        }
    }

    /// Records a value under a law, if the law applies.
    fn see(
        &self,
        law: Law,
        subject: Subject,
        value: f64,
        wavelength_nm: Option<f64>,
        findings: &mut Findings,
    ) {
        let rule = &self.rules[law as usize];
        if rule.applies {
            let finding = Finding { value, subject, wavelength_nm };
            findings.laws[law as usize].see(finding, rule.most());
        }
    }

    /// The laws of energy and bounds.
    fn see_light(&self, subject: Subject, spectra: &Spectra, findings: &mut Findings) {
        let (albedo, at) = greatest(spectra.albedo());
        self.see(Law::Energy, subject, albedo, self.nm(at), findings);
        let outside = |share: &f64| (share - share.clamp(0.0, 1.0)).abs();
        let shares = spectra.reflectance.iter().zip(spectra.reflected.iter());
        let (excess, at) =
            greatest(shares.zip(spectra.returned.iter()).map(|((r, reflected), returned)| {
                worse(outside(r), worse(outside(reflected), outside(returned)))
            }));
        self.see(Law::Bounds, subject, excess, self.nm(at), findings);
    }

    /// The steepest sample, and for nodes the steepest point between samples, in closed form.
    fn see_slope(&self, subject: Subject, spectra: &Spectra, findings: &mut Findings) {
        let (mut steepest, at) = greatest(spectra.slope_per_nm.iter().map(|s| s.abs()));
        let mut nm = self.nm(at);
        if let Subject::Node(index) = subject {
            let edge = self.cube.nodes()[index].edge();
            if edge.slope_per_nm.abs() > steepest {
                (steepest, nm) = (edge.slope_per_nm.abs(), Some(edge.edge_nm));
            }
            if self.cube.node_material(index).fluorescence.dose() > 0.0 {
                self.see(Law::SlopeUnderDyes, subject, steepest, nm, findings);
            }
        }
        self.see(Law::Slope, subject, steepest, nm, findings);
    }

    fn see_gray(
        &self,
        subject: Subject,
        mixture: &Mixture<'_>,
        spectra: &Spectra,
        findings: &mut Findings,
    ) {
        let LinearRgb([value, green, blue]) = subject.rgb(self.cube);
        if value != green || value != blue {
            return;
        }
        let samples = || spectra.reflectance.iter().copied();
        let (most, _) = greatest(samples());
        let (negative_least, at) = greatest(samples().map(|r| -r));
        self.see(Law::GrayFlat, subject, most + negative_least, self.nm(at), findings);
        let concentration = mixture.parts().map(|(w, m)| w * m.fluorescence.dose()).sum();
        self.see(Law::GrayPassive, subject, concentration, None, findings);
        let is_node = matches!(subject, Subject::Node(_));
        if is_node || self.interpolation == Interpolation::Blend {
            let (error, at) = greatest(samples().map(|r| (r - value).abs()));
            self.see(Law::GrayValue, subject, error, self.nm(at), findings);
            if is_node && (value == 0.0 || value == 1.0) {
                self.see(Law::WhiteBlack, subject, error, self.nm(at), findings);
            }
        }
    }

    /// The color against its target, and sums over 1 nm against sums over 5 nm.
    fn see_color(&self, subject: Subject, spectra: &Spectra, findings: &mut Findings) {
        let rgb = subject.rgb(self.cube);
        let [fit, fine] = [&self.sampler.fit, &self.sampler.fine].map(|sums| &sums.colorimetry);
        let fit_lab = fit.lab_from_xyz(spectra.color(&self.sampler.fit));
        let fine_lab = fine.lab_from_xyz(spectra.color(&self.sampler.fine));
        let target = fit.lab_from_xyz(fit.xyz_from_rgb(rgb));
        let missed = ciede2000(target, fit_lab);
        let finding = |value| Finding { value, subject, wavelength_nm: None };
        let between_grids = finding(ciede2000(fit_lab, fine_lab));
        match subject {
            Subject::Node(index) => {
                let stored = f64::from(self.cube.nodes()[index].de2000);
                self.see(Law::Stored, subject, (stored - missed).abs(), None, findings);
                let is_exact = stored <= CubeSummary::EXACT_DE2000;
                let grid =
                    if is_exact { &mut findings.grid_nodes } else { &mut findings.grid_missed };
                grid.see(between_grids);
            }
            Subject::Gray(_) => {}
            Subject::Point(_) => {
                if self.all_corners_are_exact(rgb) {
                    self.see(Law::Exact, subject, missed, None, findings);
                    findings.grid_points.see(between_grids);
                } else {
                    findings.grid_missed.see(between_grids);
                }
                findings.points.see(finding(missed));
            }
        }
    }

    fn all_corners_are_exact(&self, rgb: LinearRgb) -> bool {
        let corners = self.cube.corners(rgb).expect("subjects lie in 0..=1");
        let difference = |index: usize| f64::from(self.cube.nodes()[index].de2000);
        corners
            .iter()
            .all(|&(index, weight)| weight == 0.0 || difference(index) <= CubeSummary::EXACT_DE2000)
    }

    /// The spectra and the color against the functions that renderers call, wavelength by wavelength.
    fn see_library(
        &self,
        subject: Subject,
        mixture: &Mixture<'_>,
        spectra: &Spectra,
        findings: &mut Findings,
    ) {
        let shares = spectra.reflected.iter().zip(spectra.albedo());
        let (error, at) = greatest(shares.zip(self.sampler.wavelengths_nm.iter()).map(
            |((reflected, albedo), &nm)| {
                worse(
                    (reflected - mixture.reflectance(nm)).abs(),
                    (albedo - mixture.albedo(nm)).abs(),
                )
            },
        ));
        self.see(Law::Library, subject, error, self.nm(at), findings);
        let sums = ModelOnGrid::new(self.cube.model(), &self.sampler.fit.colorimetry);
        let colors = [spectra.color(&self.sampler.fit), mixture.color(&sums)];
        self.see(Law::Library, subject, difference(colors), None, findings);
    }

    /// The color by the library's re-radiation between all pairs of wavelengths.
    fn color_by_pairs(&self, mixture: &Mixture<'_>) -> Xyz {
        let colorimetry = &self.sampler.fine.colorimetry;
        let nm = &*self.sampler.wavelengths_nm;
        let reflected = nm.iter().map(|&nm| mixture.reflectance(nm));
        let mut color = colorimetry.xyz_from_reflectance(reflected);
        if mixture.is_fluorescent() {
            for (&out_nm, matching) in nm.iter().zip(colorimetry.matching()) {
                let pairs = nm.iter().zip(colorimetry.irradiance());
                let arrives: f64 =
                    pairs.map(|(&in_nm, e)| e * mixture.reradiation_per_nm(in_nm, out_nm)).sum();
                color += arrives * Xyz(*matching);
            }
        }
        color
    }

    fn nm(&self, index: usize) -> Option<f64> {
        Some(self.sampler.wavelengths_nm[index])
    }
}

/// The greatest difference of tristimulus values.
fn difference([a, b]: [Xyz; 2]) -> f64 {
    greatest((a - b).0.into_iter().map(f64::abs)).0
}

#[cfg(test)]
mod tests {
    use super::*;
    use upglow::{FitRecord, Model, Node};
    use upglow_color::Contract;

    /// No cube's numbers cause this, so it is put into the spectra.
    #[test]
    fn light_that_was_not_there_breaks_the_laws_of_energy_and_bounds() {
        let nodes = vec![Node::default(); 8];
        let (contract, fit) = (Contract::default(), FitRecord::default());
        let cube = Cube::new(contract, Model::Reflectance, fit, 2, nodes).unwrap();
        let inspector = Inspector::new(&cube, &VerifyOptions { points: 0, ..Default::default() });
        let subject = Subject::Node(0);
        let mixture = inspector.mixture(subject);
        let violations = |value: Option<f64>| {
            let (mut spectra, mut findings) = (Spectra::new(), Findings::default());
            inspector.sampler.sample(mixture.parts(), &mut spectra);
            if let Some(value) = value {
                spectra.reflected[100] = value;
            }
            inspector.see_light(subject, &spectra, &mut findings);
            [Law::Energy, Law::Bounds].map(|law| findings.laws[law as usize].violations)
        };
        assert_eq!(violations(None), [0, 0]);
        assert_eq!(violations(Some(1.5)), [1, 1]);
        assert_eq!(violations(Some(-0.5)), [0, 1]);
        assert_eq!(violations(Some(f64::NAN)), [1, 1]);
    }
}
