//! A cube of materials: one for each node of a grid over RGB.

use std::ops::RangeInclusive;

use upglow_color::rounding::to_single;
use upglow_color::{Contract, LinearRgb, NameError};

pub(crate) mod coefficient_table;
pub(crate) mod error;
pub(crate) mod file;
pub(crate) mod header;
pub(crate) mod interpolation;
mod plain_json;

use crate::material::analytic_model::AnalyticModel;
use crate::material::edge::Edge;
use crate::material::film_model::FilmModel;
use crate::material::mixture::Mixture;
use crate::material::model::Model;
use crate::material::{Fluorescence, Material};
use interpolation::{Interpolation, cell, tetrahedron};

/// Materials for every node of a regular grid over linear RGB 0..=1, in single precision.
///
/// Nodes are `[blue][green][red]`; node i of n on an axis has the value i / (n − 1).
///
/// # Examples
///
/// A file is written, read and looked up:
///
/// ```
/// use upglow::{Bispectral, Cube, Edge, FitRecord, Fluorescence, Interpolation, Model, Node};
/// use upglow_color::{Contract, LinearRgb};
///
/// let gray = Edge { edge_nm: 550.0, level: 0.0, slope_per_nm: 0.0 };
/// let nodes = vec![Node::new(gray, Fluorescence::None, 0.0); 8];
/// let cube = Cube::new(Contract::default(), Model::Reflectance, FitRecord::default(), 2, nodes)?;
/// let folder = tempfile::tempdir()?;
/// let path = folder.path().join("gray.safetensors");
/// cube.write(&path)?;
///
/// let cube = Cube::read(&path)?;
/// let mixture = cube.lookup(LinearRgb([0.2, 0.5, 0.1]), Interpolation::Blend)?;
/// assert_eq!(mixture.reflectance(500.0), 0.5);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[must_use]
#[derive(Clone, Debug, PartialEq)]
pub struct Cube {
    contract: Contract,
    model: Model,
    fit: FitRecord,
    resolution: usize,
    nodes: Vec<Node>,
}

/// How the materials of a cube were found; empty by default.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FitRecord {
    /// Name of the preset whose model and options these are; `None` if they were chosen one by one.
    #[serde(deserialize_with = "Option::deserialize")]
    pub preset: Option<String>,
    /// Name of the color difference that was minimized.
    pub metric: String,
    /// Greatest |dr/dλ| of a reflectance without fluorescence, 1/nm; `None` for no limit.
    #[serde(deserialize_with = "Option::deserialize")]
    pub slope_max_per_nm: Option<f64>,
    /// Greatest |dr/dλ| of a reflectance under fluorescence, 1/nm; `None` for no limit.
    #[serde(deserialize_with = "Option::deserialize")]
    pub slope_under_dyes_per_nm: Option<f64>,
    /// Whether steeper reflectances were allowed where nothing else matches the color.
    pub relaxed: bool,
    /// How often each node tried its neighbors' materials.
    pub sweeps: u32,
    /// Name of the search method.
    pub method: String,
    /// Evaluations of residuals and derivatives.
    pub evaluations: u64,
}

/// One stored material and its distance from the color it is for.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Node {
    /// Wavelength (nm), level and slope (1/nm) of the reflectance's [`Edge`].
    pub reflectance: [f32; 3],
    /// Numbers of the dyes in the model's set: in a ring, of the first and 0; in a film, of both. Zeros
    /// where no dye is used.
    pub dyes: [u8; 2],
    /// The other numbers of the model. Ring: weight, concentration, 0. Film: optical density of each
    /// dye, 0. Bells: emission peak (nm), Stokes shift (nm), concentration. Zeros where nothing
    /// fluoresces.
    pub fluorescence: [f32; 3],
    /// CIEDE2000 of this material against the node's color under the contract.
    pub de2000: f32,
}

/// Why a color has no material in a cube.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LookupError {
    /// A component is not a number or outside the cube.
    #[error("{channel} is {value}, expected 0 to 1, the range of the cube")]
    Outside {
        /// red, green or blue.
        channel: &'static str,
        /// The value given.
        value: f64,
    },
}

impl LookupError {
    /// Whether a color has a material in every cube.
    ///
    /// # Errors
    ///
    /// [`LookupError::Outside`] if a component is not a number in 0..=1.
    #[inline]
    pub fn check(rgb: LinearRgb) -> Result<(), Self> {
        let is_inside = rgb.0.iter().all(|v| (0.0..=1.0).contains(v));
        if is_inside { Ok(()) } else { Err(Self::outside(rgb.0)) }
    }

    /// The error for a color with a component that is not in 0..=1.
    #[cold]
    pub(crate) fn outside(rgb: [f64; 3]) -> Self {
        let mut named = ["red", "green", "blue"].into_iter().zip(rgb);
        let found = named.find(|(_, v)| !(0.0..=1.0).contains(v));
        let (channel, value) = found.unwrap_or(("red", rgb[0]));
        Self::Outside { channel, value }
    }
}

/// Why nodes describe no cube.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum CubeError {
    /// The resolution is out of range.
    #[error("resolution {found}, expected {} to {}", Cube::RESOLUTIONS[0], Cube::RESOLUTIONS[1])]
    Resolution {
        /// The resolution given.
        found: usize,
    },
    /// There are not resolution³ nodes.
    #[error("{found} nodes, expected {expected}")]
    Count {
        /// Nodes given.
        found: usize,
        /// Nodes needed.
        expected: usize,
    },
    /// The record of the fit has an impossible number or text.
    #[error(transparent)]
    Fit(#[from] FitRecordError),
    /// A node's numbers describe no material of the model.
    #[error("node [{}][{}][{}] (blue, green, red): {cause}", .node[0], .node[1], .node[2])]
    Node {
        /// Blue, green and red index.
        node: [usize; 3],
        /// What is wrong with it.
        cause: NodeError,
    },
}

/// Why a record of a fit is not accepted.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FitRecordError {
    /// A slope limit is not a positive number.
    #[error("slope limit {found}, expected > 0 per nm, or none")]
    SlopeLimit {
        /// The limit given, 1/nm.
        found: f64,
    },
    /// The preset, the metric or the method is not one line of text.
    #[error("preset, metric or method: {0}")]
    Text(Box<NameError>),
}

/// Why a node's numbers describe no material.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
#[error("{what} is {found}, expected {expected}")]
pub struct NodeError {
    /// Which number.
    pub what: &'static str,
    /// The number found.
    pub found: f32,
    /// What it should be.
    pub expected: &'static str,
}

impl Cube {
    /// Smallest and greatest number of nodes along an axis.
    pub const RESOLUTIONS: [usize; 2] = [2, 256];

    /// A cube from its nodes, `[blue][green][red]`.
    ///
    /// # Errors
    ///
    /// [`CubeError`] if the count is wrong, a node is not a material of the model, or the record of the
    /// fit has a slope limit that is not a positive number.
    pub fn new(
        contract: Contract,
        model: Model,
        fit: FitRecord,
        resolution: usize,
        nodes: Vec<Node>,
    ) -> Result<Self, CubeError> {
        let [least, most] = Self::RESOLUTIONS;
        if !(least..=most).contains(&resolution) {
            return Err(CubeError::Resolution { found: resolution });
        }
        let expected = resolution.pow(3);
        if nodes.len() != expected {
            return Err(CubeError::Count { found: nodes.len(), expected });
        }
        fit.check()?;
        let cube = Self { contract, model, fit, resolution, nodes };
        for (index, node) in cube.nodes.iter().enumerate() {
            node.check(&cube.model)
                .map_err(|cause| CubeError::Node { node: cube.coordinates(index), cause })?;
        }
        Ok(cube)
    }

    /// What RGB means here.
    pub fn contract(&self) -> &Contract {
        &self.contract
    }

    /// What the fluorescence is made of.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// How the materials were found.
    pub fn fit(&self) -> &FitRecord {
        &self.fit
    }

    /// Nodes along each axis.
    pub fn resolution(&self) -> usize {
        self.resolution
    }

    /// The nodes, `[blue][green][red]`.
    pub fn nodes(&self) -> &[Node] {
        &self.nodes
    }

    /// Blue, green and red index of node number `index`.
    pub fn coordinates(&self, index: usize) -> [usize; 3] {
        let n = self.resolution;
        [index / (n * n), index / n % n, index % n]
    }

    /// The color of node number `index`.
    pub fn node_rgb(&self, index: usize) -> LinearRgb {
        let [blue, green, red] = self.coordinates(index);
        let last = (self.resolution - 1) as f64;
        LinearRgb([red, green, blue].map(|i| i as f64 / last))
    }

    /// The material of node number `index`.
    pub fn node_material(&self, index: usize) -> Material {
        self.nodes[index].material(&self.model)
    }

    /// The number of the darkest of the eight nodes of the cell around a color; [`Self::corners`] are four
    /// of the eight.
    ///
    /// # Errors
    ///
    /// [`LookupError::Outside`] if a component is not a number in 0..=1.
    #[inline]
    pub fn cell(&self, rgb: LinearRgb) -> Result<usize, LookupError> {
        LookupError::check(rgb)?;
        let n = self.resolution;
        let [red, green, blue] = cell(n, rgb);
        Ok((blue * n + green) * n + red)
    }

    /// Numbers and weights of the four nodes around a color.
    ///
    /// # Errors
    ///
    /// [`LookupError::Outside`] if a component is not a number in 0..=1.
    pub fn corners(&self, rgb: LinearRgb) -> Result<[(usize, f64); 4], LookupError> {
        LookupError::check(rgb)?;
        let n = self.resolution;
        Ok(tetrahedron(n, rgb).map(|([b, g, r], weight)| ((b * n + g) * n + r, weight)))
    }

    /// The material of a color; nothing is allocated.
    ///
    /// # Errors
    ///
    /// [`LookupError::Outside`] if a component is not a number in 0..=1.
    pub fn lookup(
        &self,
        rgb: LinearRgb,
        interpolation: Interpolation,
    ) -> Result<Mixture<'_>, LookupError> {
        let corners = self.corners(rgb)?;
        let materials = corners.map(|(index, weight)| (weight, self.node_material(index)));
        Ok(Mixture::new(&self.model, interpolation.parts(materials)))
    }
}

impl FitRecord {
    fn check(&self) -> Result<(), FitRecordError> {
        let limits = [self.slope_max_per_nm, self.slope_under_dyes_per_nm];
        if let Some(found) = limits.into_iter().flatten().find(|s| !(s.is_finite() && *s > 0.0)) {
            return Err(FitRecordError::SlopeLimit { found });
        }
        let texts = [&self.metric, &self.method];
        texts
            .into_iter()
            .chain(&self.preset)
            .try_for_each(|t| NameError::check_text(t))
            .map_err(|error| FitRecordError::Text(error.into()))
    }
}

/// Greatest sizes of the wavelength (nm), level and slope (1/nm) of a node's reflectance. Within them
/// the coefficients of the parabola, its square and the square of its discriminant are finite in
/// double precision. White and black have a level of ±1e9.
const GREATEST_REFLECTANCE: [(&str, f32, &str); 3] = [
    ("the edge", 1e18, "-1e18 to 1e18 nm"),
    ("the level", 1e10, "-1e10 to 1e10"),
    ("the slope", 1e3, "-1e3 to 1e3 per nm"),
];

impl Node {
    /// Stores a material in single precision.
    ///
    /// # Panics
    ///
    /// If a dye's number is above 254, which no [`crate::DyeSet`] has.
    pub fn new(reflectance: Edge, fluorescence: Fluorescence, de2000: f64) -> Self {
        let Edge { edge_nm, level, slope_per_nm } = reflectance;
        let dye = |number: usize| u8::try_from(number).expect("a set has at most 255 dyes");
        let (dyes, fluorescence) = match fluorescence {
            Fluorescence::None => ([0; 2], [0.0; 3]),
            Fluorescence::Dyes { first, weight, concentration } => {
                ([dye(first), 0], [weight, concentration, 0.0])
            }
            Fluorescence::Film { dyes, densities: [first, second] } => {
                (dyes.map(dye), [first, second, 0.0])
            }
            Fluorescence::Analytic { emission_peak_nm, stokes_shift_nm, concentration } => {
                ([0; 2], [emission_peak_nm, stokes_shift_nm, concentration])
            }
        };
        Self {
            reflectance: [edge_nm, level, slope_per_nm].map(to_single),
            dyes,
            fluorescence: fluorescence.map(to_single),
            de2000: to_single(de2000),
        }
    }

    /// The reflectance by its steepest point, whose slope is the greatest of all.
    pub fn edge(&self) -> Edge {
        let [edge_nm, level, slope_per_nm] = self.reflectance.map(f64::from);
        Edge { edge_nm, level, slope_per_nm }
    }

    /// The material under `model`.
    pub fn material(&self, model: &Model) -> Material {
        let [first, second, third] = self.fluorescence.map(f64::from);
        let fluorescence = match model {
            Model::Dyes(_) if second > 0.0 => {
                let [dye, _] = self.dyes;
                Fluorescence::Dyes { first: dye.into(), weight: first, concentration: second }
            }
            Model::Film(_) if first > 0.0 => {
                Fluorescence::Film { dyes: self.dyes.map(usize::from), densities: [first, second] }
            }
            Model::Analytic(_) if third > 0.0 => Fluorescence::Analytic {
                emission_peak_nm: first,
                stokes_shift_nm: second,
                concentration: third,
            },
            _ => Fluorescence::None,
        };
        Material { reflectance: self.edge().to_sigmoid(), fluorescence }
    }

    /// Checks that the dyes are at most those with these numbers.
    fn check_dyes(&self, greatest: [usize; 2]) -> Result<(), NodeError> {
        let mut dyes = self.dyes.into_iter().zip(greatest);
        match dyes.find(|(dye, greatest)| usize::from(*dye) > *greatest) {
            None => Ok(()),
            Some((dye, greatest)) => {
                let expected =
                    if greatest == 0 { "0, it has no meaning here" } else { "a dye of the set" };
                Err(NodeError { what: "the dye", found: dye.into(), expected })
            }
        }
    }

    /// Checks that its numbers describe a material of a model: every number is in its range, also where
    /// the concentration is 0 and the others have no effect.
    ///
    /// # Errors
    ///
    /// [`NodeError`] names the first number that does not.
    pub fn check(&self, model: &Model) -> Result<(), NodeError> {
        for (found, (what, most, expected)) in
            self.reflectance.into_iter().zip(GREATEST_REFLECTANCE)
        {
            check_range(what, found, -most..=most, expected)?;
        }
        check_range("the CIEDE2000", self.de2000, 0.0..=f32::MAX, "a finite number of 0 or more")?;
        let [first, second, third] = self.fluorescence;
        let fraction = |what, found| check_range(what, found, 0.0..=1.0, "0 to 1");
        let unused = |what, found| check_range(what, found, 0.0..=0.0, "0, it has no meaning here");
        let is_dark = third == 0.0;
        match model {
            Model::Reflectance => {
                self.check_dyes([0; 2])?;
                self.fluorescence.into_iter().try_for_each(|v| unused("the fluorescence", v))
            }
            Model::Dyes(model) => {
                self.check_dyes([model.curves().len() - 1, 0])?;
                fraction("the weight", first)?;
                fraction("the concentration", second)?;
                unused("the third number of the fluorescence", third)
            }
            Model::Film(model) => {
                self.check_dyes([model.dyes().curves().len() - 1; 2])?;
                let [least, most] = FilmModel::DENSITIES.map(to_single);
                check_range("the first optical density", first, least..=most, "0 to 6")?;
                let expected = "0 to the first one";
                check_range("the second optical density", second, least..=first, expected)?;
                unused("the third number of the fluorescence", third)
            }
            Model::Analytic(_) if is_dark && [first, second] == [0.0; 2] => self.check_dyes([0; 2]),
            Model::Analytic(_) => {
                self.check_dyes([0; 2])?;
                fraction("the concentration", third)?;
                let within = |[least, most]: [f64; 2]| to_single(least)..=to_single(most);
                let peaks = within(AnalyticModel::EMISSION_PEAKS_NM);
                check_range("the emission peak", first, peaks, "400 to 710 nm")?;
                let shifts = within(AnalyticModel::STOKES_SHIFTS_NM);
                check_range("the Stokes shift", second, shifts, "10 to 120 nm")
            }
        }
    }
}

fn check_range(
    what: &'static str,
    found: f32,
    range: RangeInclusive<f32>,
    expected: &'static str,
) -> Result<(), NodeError> {
    if range.contains(&found) { Ok(()) } else { Err(NodeError { what, found, expected }) }
}
