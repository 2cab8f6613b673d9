//! Looks at one color after another and takes note of what it finds.

use upglow::{Bispectral, Cube, Interpolation, Mixture, ModelOnGrid};
use upglow_color::{LinearRgb, Xyz, ciede2000};

use super::VerifyOptions;
use super::finding::{Finding, Outcome, Subject, greatest, worse};
use super::laws::{LAWS, Law, Rule};
use super::spectra::{Sampler, Spectra};
use super::subjects::Subjects;
use crate::cube::CubeSummary;

/// Random colors that are compared with the run-time library. Fewer would miss the rarer dyes;
/// each takes a millisecond.
const LIBRARY_POINTS: usize = 64;

/// Random colors for which the library is asked for every pair of wavelengths: 30 ms each.
const PAIR_POINTS: usize = 4;

/// What a piece of the work found.
#[derive(Clone, Debug, Default)]
pub(super) struct Findings {
    /// One for each of [`LAWS`].
    pub(super) laws: [Outcome; LAWS.len()],
    /// 1 nm against 5 nm, nodes.
    pub(super) grid_nodes: Figure,
    /// 1 nm against 5 nm, random colors.
    pub(super) grid_points: Figure,
    /// Random colors against their targets.
    pub(super) points: Figure,
}

/// Numbers that are reported as a whole.
#[derive(Clone, Debug, Default)]
pub(super) struct Figure {
    pub(super) values: Vec<f64>,
    pub(super) outcome: Outcome,
}

/// A cube and everything that all its colors share.
pub(super) struct Inspector<'c> {
    cube: &'c Cube,
    interpolation: Interpolation,
    subjects: Subjects,
    sampler: Sampler<'c>,
    rules: [Rule; LAWS.len()],
}

impl Findings {
    /// Adds what a later piece found.
    pub(super) fn add(&mut self, later: Self) {
        for (sum, outcome) in self.laws.iter_mut().zip(later.laws) {
            sum.add(outcome);
        }
        self.grid_nodes.add(later.grid_nodes);
        self.grid_points.add(later.grid_points);
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

    pub(super) fn subjects(&self) -> &Subjects {
        &self.subjects
    }

    pub(super) fn rules(&self) -> &[Rule; LAWS.len()] {
        &self.rules
    }

    /// Checks one piece of the work; `spectra` is scratch.
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
                self.see_pairs(subject, &mixture, spectra, &mut findings);
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

    /// Takes note of a value under a law, where the law applies.
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

    /// Energy and bounds.
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

    /// The steepest sample, and for a node the steepest point between samples in closed form.
    fn see_slope(&self, subject: Subject, spectra: &Spectra, findings: &mut Findings) {
        let (mut steepest, at) = greatest(spectra.slope_per_nm.iter().map(|s| s.abs()));
        let mut nm = self.nm(at);
        if let Subject::Node(index) = subject {
            let edge = self.cube.nodes()[index].edge();
            if edge.slope_per_nm.abs() > steepest {
                (steepest, nm) = (edge.slope_per_nm.abs(), Some(edge.edge_nm));
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
        let concentration = mixture.parts().map(|(w, m)| w * m.fluorescence.concentration()).sum();
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

    /// The color against its target, and by 1 nm against by 5 nm.
    fn see_color(&self, subject: Subject, spectra: &Spectra, findings: &mut Findings) {
        let rgb = subject.rgb(self.cube);
        let [fit, fine] = [&self.sampler.fit, &self.sampler.fine].map(|sums| &sums.colorimetry);
        let fit_lab = fit.lab_from_xyz(self.sampler.fit_color(spectra));
        let fine_lab = fine.lab_from_xyz(self.sampler.fine_color(spectra));
        let target = fit.lab_from_xyz(fit.xyz_from_rgb(rgb));
        let missed = ciede2000(target, fit_lab);
        let finding = |value| Finding { value, subject, wavelength_nm: None };
        let between_grids = finding(ciede2000(fit_lab, fine_lab));
        match subject {
            Subject::Node(index) => {
                let stored = f64::from(self.cube.nodes()[index].de2000);
                self.see(Law::Stored, subject, (stored - missed).abs(), None, findings);
                findings.grid_nodes.see(between_grids);
            }
            Subject::Gray(_) => {}
            Subject::Point(_) => {
                if self.all_corners_are_exact(rgb) {
                    self.see(Law::Exact, subject, missed, None, findings);
                }
                findings.grid_points.see(between_grids);
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

    /// The same by the functions that a renderer calls, wavelength by wavelength.
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
        let colors = (self.sampler.fit_color(spectra), mixture.color(&sums));
        self.see(Law::Library, subject, difference(colors), None, findings);
    }

    /// The same for the color, by the library's re-radiation between all pairs of wavelengths.
    fn see_pairs(
        &self,
        subject: Subject,
        mixture: &Mixture<'_>,
        spectra: &Spectra,
        findings: &mut Findings,
    ) {
        let colors = (self.sampler.fine_color(spectra), self.color_by_pairs(mixture));
        self.see(Law::Library, subject, difference(colors), None, findings);
    }

    /// The color by sums over every incident and every outgoing nanometer.
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
fn difference((a, b): (Xyz, Xyz)) -> f64 {
    greatest((a - b).0.into_iter().map(f64::abs)).0
}
