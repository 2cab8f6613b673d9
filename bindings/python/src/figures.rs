//! The numbers behind the figures of `upglow-study`.

use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use upglow::{FeatureError, Features, Interpolation};
use upglow_color::{ColorSolid, Grid, Lab, Xyz, choices};
use upglow_study::{ChromaticityDiagram, Layer, Mixing};

use crate::contract::Contract;
use crate::cube::Cube;
use crate::errors::{check_range, value_error};
use crate::model::Model;
use crate::observer::Observer;
use crate::threads::{Threads, on_threads};
use crate::word::Word;

/// Most points along one axis of an array: more would fill the memory, and are a typing error.
const MOST_POINTS: usize = 2048;

/// Numbers, `[row][column]`.
type Rows<'py> = Bound<'py, PyArray2<f64>>;

fn rows<'py, const N: usize>(
    py: Python<'py>,
    rows: impl IntoIterator<Item = [f64; N]>,
) -> PyResult<Rows<'py>> {
    let numbers: Vec<f64> = rows.into_iter().flatten().collect();
    let count = numbers.len() / N;
    PyArray1::from_vec(py, numbers).reshape([count, N])
}

/// A chromaticity; NaN if it is undefined, as that of black is.
fn xy(chromaticity: Option<[f64; 2]>) -> [f64; 2] {
    chromaticity.unwrap_or([f64::NAN; 2])
}

/// Wavelengths (nm) and chromaticities of the locus, `[wavelength][x y]`; chromaticities of the
/// primaries, `[primary][x y]`, and of white, `[1][x y]`.
#[pyfunction]
pub(crate) fn chromaticity_diagram<'py>(
    py: Python<'py>,
    contract: &Contract,
) -> PyResult<(Bound<'py, PyArray1<f64>>, Rows<'py>, Rows<'py>, Rows<'py>)> {
    let ChromaticityDiagram { locus, primaries, white } =
        ChromaticityDiagram::of(&contract.contract);
    Ok((
        PyArray1::from_iter(py, locus.iter().map(|(nm, _)| f64::from(*nm))),
        rows(py, locus.iter().map(|(_, xy)| *xy))?,
        rows(py, primaries)?,
        rows(py, [white])?,
    ))
}

/// X, Y, Z and chromaticity of each node's color, `[node][X Y Z]` and `[node][x y]`.
#[pyfunction]
pub(crate) fn node_colors<'py>(
    py: Python<'py>,
    cube: &Cube,
    threads: Threads,
) -> PyResult<(Rows<'py>, Rows<'py>)> {
    let colors = py.detach(|| {
        let colorimetry = cube.cube.contract().on(Grid::FIT);
        on_threads(threads, || upglow_study::node_colors(&cube.cube, &colorimetry))
    })?;
    let chromaticities = colors.iter().map(|color| xy(color.chromaticity()));
    Ok((rows(py, colors.iter().map(|color| color.0))?, rows(py, chromaticities)?))
}

/// Blue, linear RGB, ΔE00, and whether all nodes that are mixed are exact.
type LayerArrays<'py> = (f64, Rows<'py>, Bound<'py, PyArray1<f64>>, Bound<'py, PyArray1<bool>>);

/// Blue, linear RGB of the materials, `[green · red][channel]`, ΔE00 to the colors that they stand
/// for, and whether all nodes that are mixed are exact: of the layer of nodes nearest to `blue`, or
/// of `side`² colors at `blue`.
#[pyfunction]
pub(crate) fn layer<'py>(
    py: Python<'py>,
    cube: &Cube,
    blue: f64,
    side: Option<usize>,
    interpolation: Word<Interpolation>,
    threads: Threads,
) -> PyResult<LayerArrays<'py>> {
    check_range("blue", blue, [0.0, 1.0])?;
    check_range("side", side.unwrap_or(cube.cube.resolution()), [2, MOST_POINTS])?;
    let cube = &cube.cube;
    let make = || match side {
        None => Layer::of_nodes(cube, Layer::nearest_node(cube.resolution(), blue)),
        Some(side) => Layer::between_nodes(cube, blue, side, interpolation.0),
    };
    let layer = py.detach(|| on_threads(threads, make))?;
    Ok((
        layer.blue,
        rows(py, layer.colors.iter().map(|color| color.0))?,
        PyArray1::from_vec(py, layer.de2000),
        PyArray1::from_vec(py, layer.has_exact_nodes),
    ))
}

/// Names, absorption, emission (1/nm), peaks of both (nm) and chromaticity of the emission.
type DyeArrays<'py> = (Vec<String>, Rows<'py>, Rows<'py>, Rows<'py>, Rows<'py>);

/// For each dye of a model: name, absorption and emission (1/nm) at 300 to 830 nm,
/// `[dye][wavelength]`, peaks of both (nm) and chromaticity of the emission for an observer,
/// `[dye][2]`.
#[pyfunction]
pub(crate) fn dye_spectra<'py>(
    py: Python<'py>,
    model: &Model,
    observer: &Observer,
) -> PyResult<DyeArrays<'py>> {
    let upglow::Model::Dyes(model) = &model.0 else {
        let found = model.0.name();
        return Err(value_error(format_args!("the model is {found}, expected dyes")));
    };
    let dyes = upglow_study::dye_spectra(model, &observer.0);
    let absorptions: Vec<_> = dyes.iter().map(|dye| dye.absorption.values().to_vec()).collect();
    let emissions: Vec<_> = dyes.iter().map(|dye| dye.emission.values().to_vec()).collect();
    Ok((
        dyes.iter().map(|dye| dye.name.to_owned()).collect(),
        PyArray2::from_vec2(py, &absorptions)?,
        PyArray2::from_vec2(py, &emissions)?,
        rows(py, dyes.iter().map(|dye| [dye.absorption_peak_nm, dye.emission_peak_nm]))?,
        rows(py, dyes.iter().map(|dye| xy(dye.emission_xy)))?,
    ))
}

/// The materials whose colors fill a solid.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Materials {
    Reflectance,
    Fluorescence,
}

choices!(Materials, "materials", Reflectance = "reflectance", Fluorescence = "fluorescence");

/// X, Y, Z and L*, a*, b* of points on the surface of the solid of all reflectances, or of all
/// fluorescent materials: `[polar · azimuth][3]`, `steps` + 1 by 2 · `steps` + 1.
#[pyfunction]
pub(crate) fn solid_surface<'py>(
    py: Python<'py>,
    contract: &Contract,
    materials: Word<Materials>,
    steps: usize,
    threads: Threads,
) -> PyResult<(Rows<'py>, Rows<'py>)> {
    check_range("steps", steps, [2, MOST_POINTS])?;
    let colorimetry = &contract.colorimetry;
    let solid = match materials.0 {
        Materials::Reflectance => ColorSolid::reflectance(colorimetry),
        Materials::Fluorescence => ColorSolid::fluorescence(colorimetry),
    };
    let surface: Vec<Xyz> =
        py.detach(|| on_threads(threads, || upglow_study::solid_surface(&solid, steps)))?;
    let lab = surface.iter().map(|&color| {
        let Lab { l, a, b } = colorimetry.lab_from_xyz(color);
        [l, a, b]
    });
    Ok((rows(py, surface.iter().map(|color| color.0))?, rows(py, lab)?))
}

/// Reflectances interpolated between two, which are given by shift (nm), width (nm) and slope
/// (1/nm), at 300 to 830 nm, `[share][wavelength]`.
#[pyfunction]
pub(crate) fn mixed_reflectances<'py>(
    py: Python<'py>,
    first: [f64; 3],
    second: [f64; 3],
    mixing: Word<Mixing>,
    shares: Vec<f64>,
) -> PyResult<Rows<'py>> {
    let ends = [first, second].map(|[shift_nm, width_nm, slope_per_nm]| Features {
        shift_nm,
        width_nm,
        slope_per_nm,
    });
    let curves: Result<Vec<_>, FeatureError> =
        shares.iter().map(|&share| mixing.0.sample(ends, share)).collect();
    Ok(PyArray2::from_vec2(py, &curves.map_err(value_error)?)?)
}
