//! Colors of a cube's materials under a light, for arrays of RGB.

use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray2, PyReadwriteArray2};
use pyo3::prelude::*;
use upglow::ColorTable;
use upglow_color::{Colorimetry, Contract, Grid, LinearRgb, Metric, Xyz, choices};

use crate::arrays::{Number, fill, fill_batches, to_single, triples, values, zeros};
use crate::cube::Cube;
use crate::errors::value_error;
use crate::illuminant::Illuminant;
use crate::threads::Threads;
use crate::word::Word;

/// The colors of a cube's materials under one light.
#[pyclass(frozen, module = "upglow._upglow")]
#[derive(Debug)]
pub(crate) struct Colors {
    table: ColorTable,
    colorimetry: Colorimetry,
}

/// How a light is scaled.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Scale {
    /// White has Y = 1 under any light.
    White,
    /// The light has the power of the cube's own.
    Power,
}

choices!(Scale, "scale", White = "white", Power = "power");

/// The colors of a cube's materials under `light`, or under its own; sums are over 1 or 5 nm.
#[pyfunction]
pub(crate) fn colors(
    py: Python<'_>,
    cube: &Cube,
    light: Option<&Illuminant>,
    scale: Word<Scale>,
    step_nm: u32,
) -> PyResult<Colors> {
    let grid = match step_nm {
        1 => Grid::FINE,
        5 => Grid::FIT,
        _ => return Err(value_error(format_args!("step_nm is {step_nm}, expected 1 or 5"))),
    };
    let contract = cube.cube.contract();
    let own = || contract.on(grid);
    let colorimetry = match (light, scale.0) {
        (None, _) => own(),
        (Some(light), Scale::White) => {
            let contract = Contract { illuminant: light.0.clone(), ..contract.clone() };
            contract.check().map_err(value_error)?;
            contract.on(grid)
        }
        (Some(light), Scale::Power) => own().relit(&contract.observer, &light.0),
    };
    Ok(py.detach(|| Colors { table: cube.cube.color_table(&colorimetry), colorimetry }))
}

#[pymethods]
impl Colors {
    /// X, Y, Z of each RGB, `[color][X Y Z]`; NaN outside 0..=1.
    fn xyz<'py>(
        &self,
        py: Python<'py>,
        rgb: PyReadonlyArray2<'py, f32>,
        threads: Threads,
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        self.each(py, triples(&rgb)?, threads, |_| ())
    }

    /// Linear RGB under the light of each RGB, `[color][channel]`; NaN outside 0..=1.
    fn rgb<'py>(
        &self,
        py: Python<'py>,
        rgb: PyReadonlyArray2<'py, f32>,
        threads: Threads,
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        self.each(py, triples(&rgb)?, threads, |colors| {
            for color in colors {
                let LinearRgb(rgb) = self.colorimetry.rgb_from_xyz(Xyz(color.map(f64::from)));
                *color = to_single(Xyz(rgb));
            }
        })
    }

    /// CIEDE2000 of the material of each RGB against the RGB itself.
    fn de2000<'py>(
        &self,
        py: Python<'py>,
        rgb: PyReadonlyArray2<'py, f32>,
        threads: Threads,
    ) -> PyResult<Bound<'py, PyArray1<f32>>> {
        let rgb = triples(&rgb)?;
        let found = self.each(py, rgb, threads, |_| ())?;
        let found = found.readonly();
        let found = triples(&found)?;
        let mut out = values(0.0, rgb.len())?;
        let difference = |row: usize| {
            let target = self.colorimetry.xyz_from_rgb(LinearRgb(rgb[row].map(f64::from)));
            Metric::De2000.distance(&self.colorimetry, target, Xyz(found[row].map(f64::from)))
        };
        fill(py, threads, &mut out, 1, |row, out| out[0] = f32::from_double(difference(row)))?;
        Ok(PyArray1::from_vec(py, out))
    }
}

/// Colors that a thread works on at a time.
const BATCH: usize = 16 * 1024;

impl Colors {
    fn each<'py>(
        &self,
        py: Python<'py>,
        rgb: &[[f32; 3]],
        threads: Threads,
        finish: impl Fn(&mut [[f32; 3]]) + Sync,
    ) -> PyResult<Bound<'py, PyArray2<f32>>> {
        let array = zeros(py, [rgb.len(), 3])?;
        let mut writable: PyReadwriteArray2<'_, f32> = array.readwrite();
        let (out, _) = writable.as_slice_mut()?.as_chunks_mut::<3>();
        fill_batches(py, threads, out, BATCH, |batch, out| {
            let rgb = &rgb[batch * BATCH..][..out.len()];
            self.table.xyz(rgb, out).expect("as many results as colors");
            finish(out);
        })?;
        drop(writable);
        Ok(array)
    }
}
