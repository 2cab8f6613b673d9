//! The report of `upglow color`.

use serde::Serialize;
use upglow::{Features, Fluorescence, Interpolation, Material, Model, Sigmoid, Vertex};
use upglow_color::{Adaptation, LinearRgb, Nearest, Standing, StandingKind, Xyz};
use upglow_fit::{Appearance, CubeSummary, MaterialKind};
use upglow_terminal::Report;

use super::engine::EngineReport;
use super::material_report::{ReflectanceReport, dye_names};
use crate::metamers::{KnownReport, PaintReport};
use crate::output::{Lines, Side, Table, triple};
use crate::plot::Curves;

/// A difference above this is visible when both colors are side by side.
const VISIBLE_DE2000: f64 = 1.0;

#[derive(Debug, Serialize)]
pub(crate) struct ColorReport<'a> {
    pub(crate) file: String,
    pub(crate) rgb_space: &'a str,
    pub(crate) rgb: LinearRgb,
    /// The requested color under the cube's illuminant.
    pub(crate) xyz: Xyz,
    /// `None` for a direct fit and for a search.
    pub(crate) interpolation: Option<Interpolation>,
    /// What a search among all materials that may have the color took it for.
    pub(crate) paint: Option<&'a PaintReport>,
    pub(crate) de2000: f64,
    pub(crate) kind: MaterialKind,
    pub(crate) standing: StandingReport,
    #[serde(skip)]
    pub(crate) reachable: Standing,
    pub(crate) parts: Vec<PartReport<'a>>,
    pub(crate) illuminant: &'a str,
    pub(crate) adaptation: Adaptation,
    pub(crate) lights: Vec<LightReport>,
    /// The material for an engine without spectra.
    pub(crate) engine: Option<EngineReport>,
    pub(crate) plot: Option<String>,
    pub(crate) output: Option<String>,
    pub(crate) curves: &'a Curves,
}

/// Whether physics allows a material of this color, and how far off the nearest one is.
#[derive(Debug, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub(crate) enum StandingReport {
    Reflectance,
    NeedsFluorescence { reflectance_distance_xyz: f64, reflectance_de2000: f64 },
    Unreachable { fluorescence_distance_xyz: f64, fluorescence_de2000: f64 },
}

/// One material of a mixture.
#[derive(Debug, Serialize)]
pub(crate) struct PartReport<'a> {
    weight: f64,
    #[serde(flatten)]
    reflectance: ReflectanceReport,
    /// `None` for a flat reflectance, and for one whose parabola is a straight line.
    shift_nm: Option<f64>,
    width_nm: Option<f64>,
    slope_per_nm: Option<f64>,
    fluorescence: Option<FluorescenceReport<'a>>,
}

#[derive(Debug, Serialize)]
#[serde(untagged)]
enum FluorescenceReport<'a> {
    Dyes {
        dye_a: &'a str,
        dye_b: &'a str,
        weight: f64,
        concentration: f64,
    },
    /// `dye_b` is `None` for a single dye.
    Film {
        dye_a: &'a str,
        dye_b: Option<&'a str>,
        density_a: f64,
        density_b: f64,
        /// Shares of what is absorbed that come back as light.
        yield_a: f64,
        yield_b: f64,
        dose: f64,
    },
    Analytic {
        emission_peak_nm: f64,
        stokes_shift_nm: f64,
        concentration: f64,
    },
}

/// How the material looks under one light.
#[derive(Debug, Serialize)]
pub(crate) struct LightReport {
    pub(crate) name: String,
    /// Whether the observer is adapted to it, so that white has Y = 1; otherwise it has as much power as
    /// the cube's light, and the observer is adapted to that.
    pub(crate) is_adapted: bool,
    #[serde(flatten)]
    pub(crate) appearance: Appearance,
    /// What the light lacks that a dye of the material absorbs.
    pub(crate) missing_ultraviolet: Option<String>,
}

impl<'a> PartReport<'a> {
    pub(crate) fn new((weight, material): (f64, Material), model: &'a Model) -> Self {
        let Material { reflectance, fluorescence } = material;
        let features = reflectance.to_vertex().and_then(Vertex::to_features);
        let feature = |of: fn(Features) -> f64| features.map(of);
        Self {
            weight,
            reflectance: reflectance.into(),
            shift_nm: feature(|f| f.shift_nm),
            width_nm: feature(|f| f.width_nm),
            slope_per_nm: feature(|f| f.slope_per_nm),
            fluorescence: FluorescenceReport::new(fluorescence, model),
        }
    }

    /// Whether a dye of a film emits.
    fn emits(&self) -> bool {
        match self.fluorescence {
            Some(FluorescenceReport::Film { yield_a, yield_b, .. }) => yield_a + yield_b > 0.0,
            _ => false,
        }
    }

    /// The dyes or the emission peak, for a caption.
    pub(crate) fn emitters(&self) -> Vec<String> {
        match &self.fluorescence {
            None => Vec::new(),
            Some(FluorescenceReport::Dyes { dye_a, dye_b, weight, .. }) => {
                let shares = [(dye_a, 1.0 - weight), (dye_b, *weight)];
                let used = shares.into_iter().filter(|(_, share)| *share > 0.0);
                used.map(|(name, _)| format!("dye {name}")).collect()
            }
            Some(FluorescenceReport::Film { dye_a, dye_b, .. }) => [Some(*dye_a), *dye_b]
                .into_iter()
                .flatten()
                .map(|name| format!("dye {name}"))
                .collect(),
            Some(FluorescenceReport::Analytic { emission_peak_nm, .. }) => {
                vec![format!("emission peak {emission_peak_nm:.0} nm")]
            }
        }
    }
}

impl<'a> FluorescenceReport<'a> {
    fn new(fluorescence: Fluorescence, model: &'a Model) -> Option<Self> {
        match fluorescence {
            Fluorescence::Dyes { weight, concentration, .. } => {
                let [dye_a, dye_b] = dye_names(fluorescence, model)?;
                Some(Self::Dyes { dye_a, dye_b, weight, concentration })
            }
            Fluorescence::Film { dyes, densities: [density_a, density_b] } => {
                let [dye_a, dye_b] = dye_names(fluorescence, model)?;
                let curves = model.dyes()?.curves();
                let [yield_a, yield_b] = dyes.map(|dye| curves[dye].quantum_yield);
                let dye_b = (density_b > 0.0).then_some(dye_b);
                let dose = fluorescence.dose();
                Some(Self::Film { dye_a, dye_b, density_a, density_b, yield_a, yield_b, dose })
            }
            Fluorescence::Analytic { emission_peak_nm, stokes_shift_nm, concentration } => {
                Some(Self::Analytic { emission_peak_nm, stokes_shift_nm, concentration })
            }
            Fluorescence::None => None,
        }
    }
}

impl From<Standing> for StandingReport {
    fn from(standing: Standing) -> Self {
        let Nearest { distance, de2000, .. } = standing.beyond();
        match standing.kind {
            StandingKind::Reflectance => Self::Reflectance,
            StandingKind::NeedsFluorescence => Self::NeedsFluorescence {
                reflectance_distance_xyz: distance,
                reflectance_de2000: de2000,
            },
            StandingKind::Unreachable => Self::Unreachable {
                fluorescence_distance_xyz: distance,
                fluorescence_de2000: de2000,
            },
        }
    }
}

impl Report for ColorReport<'_> {
    fn text(&self) -> String {
        let mut pieces = vec![self.head(), self.shapes(), self.fluorescence(), self.colors()];
        pieces.extend(self.engine.as_ref().map(EngineReport::text));
        pieces.join("\n")
    }
}

impl ColorReport<'_> {
    fn head(&self) -> String {
        let LinearRgb([r, g, b]) = self.rgb;
        let material = match (&self.interpolation, self.parts.len()) {
            (None, 1) if self.paint.is_some() => "the best single one of a paint".into(),
            (None, n) if self.paint.is_some() => {
                format!("the best mixture of a paint, of {n} materials")
            }
            (None, _) => "fitted directly".into(),
            (Some(interpolation), 1) => format!("looked up, {interpolation}, one material"),
            (Some(interpolation), n) => {
                format!("looked up, {interpolation}, a mixture of {n} materials")
            }
        };
        let remark = match self.de2000 {
            found if found <= CubeSummary::EXACT_DE2000 => ", exact",
            found if found > VISIBLE_DE2000 => ", visibly off",
            _ => "",
        };
        let mut lines = Lines::default();
        lines
            .add("color", format_args!("{} ({r}, {g}, {b})", self.rgb_space))
            .add("reachable", self.reachable)
            .add("material", material)
            .add("kind", self.kind_text())
            .add("ΔE00", format_args!("{:.4}{remark}", self.de2000));
        if let Some(paint) = self.paint {
            for KnownReport { light, rgb: LinearRgb([r, g, b]), de2000, .. } in &paint.known {
                lines.add("known", format_args!("{light} ({r}, {g}, {b}), ΔE00 {de2000:.2}"));
            }
            lines.add("fluoresces", paint.fluoresces());
        }
        if let Some(output) = &self.output {
            lines.add("output", output);
        }
        if let Some(plot) = &self.plot {
            lines.add("plot", plot);
        }
        lines.to_string()
    }

    fn kind_text(&self) -> &'static str {
        match self.kind {
            MaterialKind::Reflectance if self.paint.is_some() => "reflectance alone",
            MaterialKind::Dyed if self.paint.is_some() => {
                match self.parts.iter().any(PartReport::emits) {
                    true => "with dye",
                    false => "with dyes that absorb only",
                }
            }
            MaterialKind::Reflectance => "reflectance alone, within the slope limit",
            MaterialKind::Dyed => "with dye, within the slope limits",
            MaterialKind::Steep => "steeper than the slope limits",
            MaterialKind::Missed => "missed, no material of the cube matches",
            _ => self.kind.label(),
        }
    }

    fn shapes(&self) -> String {
        let head = ["part", "weight", "shift nm", "width nm", "slope /nm", "c0", "c1", "c2"];
        let mut table = Table::new(head.map(|name| (name, Side::Right)));
        for (number, part) in (1..).zip(&self.parts) {
            let Sigmoid { c0, c1, c2 } = part.reflectance.coefficients;
            let without = if part.reflectance.steepest_per_nm == 0.0 { "flat" } else { "straight" };
            let optional = |value: Option<f64>, decimals: usize| {
                value.map_or(without.into(), |v| format!("{v:.decimals$}"))
            };
            table.add([
                format!("{number}"),
                format!("{:.4}", part.weight),
                optional(part.shift_nm, 2),
                optional(part.width_nm, 2),
                optional(part.slope_per_nm, 6),
                format!("{c0:.5e}"),
                format!("{c1:.5e}"),
                format!("{c2:.5e}"),
            ]);
        }
        table.to_string()
    }

    /// A table of the dyes, the films or the analytic curves of the parts that fluoresce.
    fn fluorescence(&self) -> String {
        let mut dyes = Table::new([
            ("part", Side::Right),
            ("concentration", Side::Right),
            ("share", Side::Right),
            ("dye", Side::Left),
            ("share", Side::Right),
            ("dye", Side::Left),
        ]);
        let mut films = Table::new([
            ("part", Side::Right),
            ("dose", Side::Right),
            ("density", Side::Right),
            ("yield", Side::Right),
            ("dye", Side::Left),
            ("density", Side::Right),
            ("yield", Side::Right),
            ("dye", Side::Left),
        ]);
        let head = ["part", "concentration", "emission peak nm", "Stokes shift nm"];
        let mut analytic = Table::new(head.map(|name| (name, Side::Right)));
        for (number, part) in (1..).zip(&self.parts) {
            let number = number.to_string();
            match &part.fluorescence {
                Some(FluorescenceReport::Dyes { dye_a, dye_b, weight, concentration }) => {
                    dyes.add([
                        number,
                        format!("{concentration:.4}"),
                        format!("{:.4}", 1.0 - weight),
                        (*dye_a).to_owned(),
                        format!("{weight:.4}"),
                        (*dye_b).to_owned(),
                    ]);
                }
                Some(FluorescenceReport::Film {
                    dye_a,
                    dye_b,
                    density_a,
                    density_b,
                    yield_a,
                    yield_b,
                    dose,
                }) => {
                    let of_b = |text: String| dye_b.map_or(String::new(), |_| text);
                    films.add([
                        number,
                        format!("{dose:.4}"),
                        format!("{density_a:.4}"),
                        format!("{yield_a:.2}"),
                        (*dye_a).to_owned(),
                        of_b(format!("{density_b:.4}")),
                        of_b(format!("{yield_b:.2}")),
                        dye_b.unwrap_or_default().to_owned(),
                    ]);
                }
                Some(FluorescenceReport::Analytic {
                    emission_peak_nm,
                    stokes_shift_nm,
                    concentration,
                }) => {
                    analytic.add([
                        number,
                        format!("{concentration:.4}"),
                        format!("{emission_peak_nm:.2}"),
                        format!("{stokes_shift_nm:.2}"),
                    ]);
                }
                None => {}
            }
        }
        if !dyes.is_empty() {
            dyes.to_string()
        } else if !films.is_empty() {
            films.to_string()
        } else if !analytic.is_empty() {
            analytic.to_string()
        } else {
            "no fluorescence\n".into()
        }
    }

    fn colors(&self) -> String {
        let mut table = Table::new([
            ("light", Side::Left),
            ("X        Y        Z", Side::Right),
            ("R        G        B", Side::Right),
            ("fluorescent", Side::Right),
            (if self.paint.is_some() { BAND } else { "" }, Side::Right),
        ]);
        for LightReport { name, appearance, .. } in &self.lights {
            let Appearance { xyz, rgb, fluorescent_share, band_de2000, .. } = appearance;
            let fluorescent = percent(*fluorescent_share);
            table.add([
                name.clone(),
                triple(xyz.0),
                triple(rgb.0),
                fluorescent,
                band(*band_de2000),
            ]);
        }
        let Self { rgb_space: space, illuminant: own, adaptation, .. } = self;
        let dark = self.lights.iter().filter(|light| !light.is_adapted);
        let dark: Vec<&str> = dark.map(|light| light.name.as_str()).collect();
        let note = if self.paint.is_some() { BAND_NOTE } else { "" };
        format!("{table}{}{SHARE_NOTE}\n{note}", scale_note(space, own, *adaptation, &dark))
    }
}

/// What is in the column `fluorescent`.
pub(super) const SHARE_NOTE: &str = "fluorescent: share of Y that dyes emit.";

/// A share in percent; empty where it is not defined.
pub(super) fn percent(share: Option<f64>) -> String {
    share.map_or(String::new(), |share| format!("{:.1} %", 100.0 * share))
}

/// The column of [`Appearance::band_de2000`].
pub(super) const BAND: &str = "± ΔE00";

/// What is in it.
pub(super) const BAND_NOTE: &str =
    "± ΔE00: nine of ten materials that may have the color are within this.\n";

pub(super) fn band(band_de2000: Option<f64>) -> String {
    band_de2000.map_or(String::new(), |band| format!("{band:.1}"))
}

/// What RGB and Y mean under lights, some of which are too `dark` to see by.
pub(super) fn scale_note(space: &str, own: &str, adaptation: Adaptation, dark: &[&str]) -> String {
    let text = format!("RGB is linear {space}, adaptation {adaptation}. White has Y = 1");
    if dark.is_empty() {
        return text + " under each light.\n";
    }
    let (dark, have) = (dark.join(", "), if dark.len() == 1 { "has" } else { "have" });
    format!(
        "{text} under each light except\n\
         {dark}, which {have} as much power as {own} and nearly no visible light: the observer\n\
         is adapted to {own}.\n"
    )
}
