//! What `upglow color` prints.

use std::fmt::Write as _;

use serde::Serialize;
use upglow::{Fluorescence, Material, Model, Vertex};
use upglow_fit::CubeSummary;

use crate::output::{Lines, Report, Side, Table, triple, unsigned_zero};
use crate::plot::Curves;

/// Beyond this a miss shows beside the color itself; smaller would cry over what nobody sees.
const VISIBLE_DE2000: f64 = 1.0;

#[derive(Clone, Debug, Serialize)]
pub(crate) struct ColorReport {
    pub(crate) file: String,
    pub(crate) rgb_space: String,
    pub(crate) rgb: [f64; 3],
    /// The color asked for under the cube's illuminant.
    pub(crate) xyz: [f64; 3],
    /// `None` for a direct fit.
    pub(crate) interpolation: Option<String>,
    pub(crate) de2000: f64,
    pub(crate) standing: StandingReport,
    pub(crate) parts: Vec<PartReport>,
    pub(crate) illuminant: String,
    pub(crate) adaptation: String,
    pub(crate) lights: Vec<LightReport>,
    pub(crate) plot: Option<String>,
    pub(crate) curves: CurvesReport,
    #[serde(skip)]
    pub(crate) drawing: Drawing,
}

/// The curves drawn in text, where they are wanted.
#[derive(Clone, Debug)]
pub(crate) struct Drawing(pub(crate) Option<String>);

/// The limits of physics around a color.
#[derive(Clone, Copy, Debug, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub(crate) enum StandingReport {
    Reflectance,
    NeedsFluorescence { reflectance_distance_xyz: f64, reflectance_de2000: f64 },
    Unreachable { fluorescence_distance_xyz: f64, fluorescence_de2000: f64 },
}

/// One material of a mixture.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct PartReport {
    weight: f64,
    c0: f64,
    c1: f64,
    c2: f64,
    /// The greatest |dr/dλ|, 0 for a flat reflectance, 1/nm.
    steepest_per_nm: f64,
    /// `None` for a flat reflectance, and for one with a straight parabola.
    shift_nm: Option<f64>,
    width_nm: Option<f64>,
    slope_per_nm: Option<f64>,
    pub(crate) fluorescence: Option<FluorescenceReport>,
}

#[derive(Clone, Debug, Serialize)]
#[serde(untagged)]
pub(crate) enum FluorescenceReport {
    Dyes { dye_a: String, dye_b: String, weight: f64, concentration: f64 },
    Analytic { emission_peak_nm: f64, stokes_shift_nm: f64, concentration: f64 },
}

/// The material's color under one light.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct LightReport {
    pub(crate) name: String,
    pub(crate) xyz: [f64; 3],
    pub(crate) rgb: [f64; 3],
}

/// [`Curves`] as they are printed.
#[derive(Clone, Debug, Serialize)]
pub(crate) struct CurvesReport {
    wavelengths_nm: Vec<f64>,
    /// (1 − c·a)·r, 0..=1.
    reflectance: Vec<f64>,
    /// c·a, 0..=1.
    absorption: Vec<f64>,
    /// Under the cube's illuminant, 1 at its peak.
    emission: Vec<f64>,
}

impl PartReport {
    pub(crate) fn new((weight, material): (f64, Material), model: &Model) -> Self {
        let sigmoid = material.reflectance;
        let features = sigmoid.to_vertex().and_then(Vertex::to_features);
        Self {
            weight,
            c0: unsigned_zero(sigmoid.c0),
            c1: unsigned_zero(sigmoid.c1),
            c2: unsigned_zero(sigmoid.c2),
            steepest_per_nm: sigmoid.steepest_slope_per_nm(),
            shift_nm: features.map(|f| f.shift_nm),
            width_nm: features.map(|f| f.width_nm),
            slope_per_nm: features.map(|f| f.slope_per_nm),
            fluorescence: FluorescenceReport::new(material.fluorescence, model),
        }
    }
}

impl FluorescenceReport {
    fn new(fluorescence: Fluorescence, model: &Model) -> Option<Self> {
        match (fluorescence, model) {
            (Fluorescence::Dyes { first, weight, concentration }, Model::Dyes(dyes)) => {
                let name = |dye: usize| dyes.set().dyes().get(dye).map(|dye| dye.name.clone());
                let dye_b = name(dyes.partner(first))?;
                Some(Self::Dyes { dye_a: name(first)?, dye_b, weight, concentration })
            }
            (
                Fluorescence::Analytic { emission_peak_nm, stokes_shift_nm, concentration },
                Model::Analytic(_),
            ) => Some(Self::Analytic { emission_peak_nm, stokes_shift_nm, concentration }),
            _ => None,
        }
    }

    /// What fluoresces, for a caption.
    pub(crate) fn names(self) -> Vec<String> {
        match self {
            Self::Dyes { dye_a, dye_b, weight, .. } => {
                let shares = [(dye_a, 1.0 - weight), (dye_b, weight)];
                shares
                    .into_iter()
                    .filter(|(_, share)| *share > 0.0)
                    .map(|(name, _)| format!("dye {name}"))
                    .collect()
            }
            Self::Analytic { emission_peak_nm, .. } => {
                vec![format!("emission peak {emission_peak_nm:.0} nm")]
            }
        }
    }
}

impl CurvesReport {
    pub(crate) fn new(curves: &Curves) -> Self {
        Self {
            wavelengths_nm: curves.wavelengths_nm.clone(),
            reflectance: curves.reflectance.clone(),
            absorption: curves.absorption.clone(),
            emission: curves.emission.clone(),
        }
    }
}

impl StandingReport {
    fn text(self) -> String {
        match self {
            Self::Reflectance => "some reflectance shows it".into(),
            Self::NeedsFluorescence { reflectance_distance_xyz, reflectance_de2000 } => format!(
                "needs fluorescence: the nearest reflectance is {reflectance_distance_xyz:.4} away in XYZ, ΔE00 {reflectance_de2000:.2}"
            ),
            Self::Unreachable { fluorescence_distance_xyz, fluorescence_de2000 } => format!(
                "no material shows it: the nearest is {fluorescence_distance_xyz:.4} away in XYZ, ΔE00 {fluorescence_de2000:.2}"
            ),
        }
    }
}

impl Report for ColorReport {
    fn text(&self) -> String {
        let mut text = self.head();
        if let Drawing(Some(drawing)) = &self.drawing {
            let _ = write!(text, "\n{drawing}");
        }
        let _ = write!(text, "\n{}", self.shapes());
        let _ = write!(text, "\n{}", self.fluorescence());
        let _ = write!(text, "\n{}", self.colors());
        text
    }
}

impl ColorReport {
    fn head(&self) -> String {
        let [r, g, b] = self.rgb;
        let material = match (&self.interpolation, self.parts.len()) {
            (None, _) => "fitted directly".into(),
            (Some(interpolation), 1) => format!("looked up, {interpolation}, one material"),
            (Some(interpolation), n) => {
                format!("looked up, {interpolation}, a mixture of {n} materials")
            }
        };
        let judgment = match self.de2000 {
            found if found <= CubeSummary::EXACT_DE2000 => ", exact",
            found if found > VISIBLE_DE2000 => ", visibly off",
            _ => "",
        };
        let mut lines = Lines::default();
        lines
            .add("color", format_args!("{} ({r}, {g}, {b})", self.rgb_space))
            .add("stands", self.standing.text())
            .add("material", material)
            .add("ΔE00", format_args!("{:.4}{judgment}", self.de2000));
        if let Some(plot) = &self.plot {
            lines.add("plot", plot);
        }
        lines.to_string()
    }

    fn shapes(&self) -> String {
        let head = ["part", "weight", "shift nm", "width nm", "slope /nm", "c0", "c1", "c2"];
        let mut table = Table::new(head.map(|name| (name, Side::Right)));
        for (number, part) in (1..).zip(&self.parts) {
            let without = if part.steepest_per_nm == 0.0 { "flat" } else { "straight" };
            let optional = |value: Option<f64>, decimals: usize| {
                value.map_or(without.into(), |v| format!("{v:.decimals$}"))
            };
            table.add([
                format!("{number}"),
                format!("{:.4}", part.weight),
                optional(part.shift_nm, 2),
                optional(part.width_nm, 2),
                optional(part.slope_per_nm, 6),
                format!("{:.5e}", part.c0),
                format!("{:.5e}", part.c1),
                format!("{:.5e}", part.c2),
            ]);
        }
        table.to_string()
    }

    fn fluorescence(&self) -> String {
        let (dyes, bells) = (self.dye_table(), self.bell_table());
        dyes.or(bells).unwrap_or_else(|| "no fluorescence\n".into())
    }

    /// `None` where no part has dyes.
    fn dye_table(&self) -> Option<String> {
        let mut table = Table::new([
            ("part", Side::Right),
            ("concentration", Side::Right),
            ("share", Side::Right),
            ("dye", Side::Left),
            ("share", Side::Right),
            ("dye", Side::Left),
        ]);
        let mut found = false;
        for (number, part) in (1..).zip(&self.parts) {
            if let Some(FluorescenceReport::Dyes { dye_a, dye_b, weight, concentration }) =
                &part.fluorescence
            {
                found = true;
                table.add([
                    format!("{number}"),
                    format!("{concentration:.4}"),
                    format!("{:.4}", 1.0 - weight),
                    dye_a.clone(),
                    format!("{weight:.4}"),
                    dye_b.clone(),
                ]);
            }
        }
        found.then(|| table.to_string())
    }

    /// `None` where no part has bells.
    fn bell_table(&self) -> Option<String> {
        let head = ["part", "concentration", "emission peak nm", "Stokes shift nm"];
        let mut table = Table::new(head.map(|name| (name, Side::Right)));
        let mut found = false;
        for (number, part) in (1..).zip(&self.parts) {
            if let Some(FluorescenceReport::Analytic {
                emission_peak_nm,
                stokes_shift_nm,
                concentration,
            }) = &part.fluorescence
            {
                found = true;
                table.add([
                    format!("{number}"),
                    format!("{concentration:.4}"),
                    format!("{emission_peak_nm:.2}"),
                    format!("{stokes_shift_nm:.2}"),
                ]);
            }
        }
        found.then(|| table.to_string())
    }

    fn colors(&self) -> String {
        let head = ["light", "X        Y        Z", "R        G        B"];
        let sides = [Side::Left, Side::Right, Side::Right];
        let mut table = Table::new([0, 1, 2].map(|column| (head[column], sides[column])));
        for light in &self.lights {
            table.add([light.name.clone(), triple(light.xyz), triple(light.rgb)]);
        }
        let Self { rgb_space: space, illuminant: own, adaptation, .. } = self;
        format!(
            "{table}\
             RGB is linear {space}, adaptation {adaptation}. White is Y = 1 under each light but the\n\
             lamp, which has as much power as {own} and is seen by an eye adapted to {own}.\n"
        )
    }
}
