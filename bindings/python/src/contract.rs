//! Contracts: what RGB means.

use std::sync::OnceLock;

use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use upglow_color::{Adaptation, Colorimetry, Grid, RgbSpace};
use upglow_fit::StandingTable;

use crate::errors::value_error;
use crate::illuminant::Illuminant;
use crate::observer::Observer;
use crate::word::Word;

/// RGB space, illuminant, observer and chromatic adaptation.
#[pyclass(frozen, module = "upglow._upglow")]
#[derive(Debug)]
pub(crate) struct Contract {
    pub(crate) contract: upglow_color::Contract,
    pub(crate) colorimetry: Colorimetry,
    standing: OnceLock<StandingTable>,
}

/// An RGB space, as Python gives it.
#[derive(FromPyObject)]
enum Space {
    Name(String),
    /// Chromaticities of red, green, blue and white.
    Numbers([f64; 8]),
}

impl Contract {
    pub(crate) fn of(contract: upglow_color::Contract) -> Self {
        let colorimetry = contract.on(Grid::FIT);
        Self { contract, colorimetry, standing: OnceLock::new() }
    }

    /// What materials can reproduce colors under this contract; made at the first call.
    pub(crate) fn standing_table(&self) -> &StandingTable {
        self.standing.get_or_init(|| StandingTable::new(&self.contract))
    }
}

#[pymethods]
impl Contract {
    #[new]
    fn new(
        space: Space,
        illuminant: &Illuminant,
        observer: &Observer,
        adaptation: Word<Adaptation>,
    ) -> PyResult<Self> {
        let space = match space {
            Space::Name(name) => RgbSpace::named(&name),
            Space::Numbers([rx, ry, gx, gy, bx, by, wx, wy]) => {
                RgbSpace::custom("custom", [[rx, ry], [gx, gy], [bx, by]], [wx, wy])
            }
        };
        let contract = upglow_color::Contract {
            space: space.map_err(value_error)?,
            illuminant: illuminant.0.clone(),
            observer: observer.0.clone(),
            adaptation: adaptation.0,
        };
        contract.check().map_err(value_error)?;
        Ok(Self::of(contract))
    }

    /// The names of the built-in RGB spaces.
    #[staticmethod]
    fn spaces() -> Vec<&'static str> {
        RgbSpace::names().to_vec()
    }

    /// Name of the RGB space.
    #[getter]
    fn space(&self) -> &str {
        self.contract.space.name()
    }

    /// Chromaticities (x, y) of red, green, blue, `[primary][x y]`.
    #[getter]
    fn primaries_xy<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        matrix(py, self.contract.space.primaries())
    }

    /// Chromaticity (x, y) of RGB (1, 1, 1).
    #[getter]
    fn white_xy<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.contract.space.white())
    }

    /// The light.
    #[getter]
    fn illuminant(&self) -> Illuminant {
        Illuminant(self.contract.illuminant.clone())
    }

    /// The observer.
    #[getter]
    fn observer(&self) -> Observer {
        Observer(self.contract.observer.clone())
    }

    /// `bradford` or `none`.
    #[getter]
    fn adaptation(&self) -> String {
        self.contract.adaptation.to_string()
    }

    /// XYZ of the perfect diffuser, sums over 5 nm.
    #[getter]
    fn white_xyz<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        PyArray1::from_slice(py, &self.colorimetry.white().0)
    }

    /// The matrix that takes RGB to XYZ, `[X Y Z][red green blue]`.
    #[getter]
    fn xyz_from_rgb<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        matrix(py, self.colorimetry.xyz_from_rgb_matrix().0)
    }

    /// The matrix that takes XYZ to RGB, `[red green blue][X Y Z]`.
    #[getter]
    fn rgb_from_xyz<'py>(&self, py: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        matrix(py, self.colorimetry.rgb_from_xyz_matrix().0)
    }
}

fn matrix<const N: usize>(py: Python<'_>, rows: [[f64; N]; 3]) -> Bound<'_, PyArray2<f64>> {
    PyArray2::from_vec2(py, &rows.map(Vec::from)).expect("all rows are of one length")
}
