//! From a measured re-radiation matrix to a material.

use upglow::{Cube, CubeError, Material, Model, Sigmoid};
use upglow_color::{Contract, ContractError, DonaldsonMatrix, Illuminant, MeasuredDye, choices};

pub(crate) mod goal;
mod own_dyes;
mod separation;
mod table_dyes;

use crate::own_material::{FilmPart, OwnMaterial, OwnMaterialError, fitted_dye};
use crate::problem::parabola::MIDDLE_NM;
use goal::{MatrixDifference, MatrixGoal};
use own_dyes::{DyeInFilm, emitting_dyes, film_on_white};
use separation::{Emitter, separated};
use table_dyes::{Found, TableDyes};

/// Which dyes a fitted material may have.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum MatrixDyes {
    /// Dyes whose absorption and emission are those of the matrix.
    #[default]
    Measured,
    /// Those of these dyes that come nearest, with yields of their own.
    Of(Vec<MeasuredDye>),
}

/// What a fitted material reflects.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MatrixReflectance {
    /// The measured reflectance, as a dye that absorbs and does not emit, over white.
    #[default]
    Measured,
    /// The sigmoid that comes nearest.
    Sigmoid,
}

choices!(MatrixReflectance, "reflectance", Measured = "measured", Sigmoid = "sigmoid",);

/// How a matrix is fitted.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MatrixFitOptions {
    /// The dyes; those of the matrix by default.
    pub dyes: MatrixDyes,
    /// How many dyes emit, 1 or 2: by default one of the matrix, or those of a table that come nearest.
    pub count: Option<usize>,
    /// What is reflected; by default what comes nearest. A film holds two dyes, and a measured reflectance takes
    /// one of them. Dyes of a table are over a sigmoid.
    pub reflectance: Option<MatrixReflectance>,
}

/// Why a matrix has no material.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum MatrixFitError {
    /// The number of dyes is out of range.
    #[error("{found} emitting dyes, expected 1 or 2")]
    Count {
        /// The number given.
        found: usize,
    },
    /// The reflectance takes the place of a dye.
    #[error("measured with {found}, expected measured with one dye of the matrix, or sigmoid")]
    Reflectance {
        /// The dyes given.
        found: &'static str,
    },
    /// No dyes were given.
    #[error("no dyes, expected at least one")]
    NoDyes,
    /// Daylight does not reach the matrix.
    #[error(transparent)]
    Contract(#[from] ContractError),
    /// The dyes make no material.
    #[error(transparent)]
    Material(#[from] OwnMaterialError),
}

/// A material fitted to a measured matrix.
#[derive(Clone, Debug, PartialEq)]
#[must_use]
pub struct MatrixFit {
    material: OwnMaterial,
    matrix: DonaldsonMatrix,
}

/// The material of the model `film` that comes nearest to a measured matrix: in the colors of both under
/// daylight, parts of it, incandescent light, equal energy and ultraviolet lamps; for dyes of the matrix also in
/// its elements outside of the diagonal. The colors are those of all that was measured, with its noise. Each
/// absorbed photon gives back as many as the quantum yield says.
///
/// # Errors
///
/// [`MatrixFitError`] if an option is out of range, or the matrix lies where there is no daylight.
///
/// # Examples
///
/// ```
/// use upglow_color::{BispectralUnit, DonaldsonMatrix, Illuminant};
/// use upglow_fit::{MatrixFitOptions, fit_matrix};
///
/// // Half of all light is reflected, and a tenth of that at 370 to 430 nm leaves from 480 to 550 nm.
/// let nm: Vec<f64> = (30..=78).map(|tens| f64::from(10 * tens)).collect();
/// let factor = |o: f64, i: f64| match (i, o) {
///     (370.0..=430.0, 480.0..=550.0) => 0.1 / 8.0,
///     _ if i == o => 0.5,
///     _ => 0.0,
/// };
/// let rows = nm.iter().map(|&o| nm.iter().map(|&i| factor(o, i)).collect()).collect();
/// let measured = DonaldsonMatrix::try_new(nm.clone(), nm, rows, BispectralUnit::PerBand)?;
/// let fit = fit_matrix(&measured, &MatrixFitOptions::default())?;
/// let difference = fit.difference(&measured, &Illuminant::named("A")?)?;
/// assert!(difference.de2000 < 0.1);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn fit_matrix(
    measured: &DonaldsonMatrix,
    options: &MatrixFitOptions,
) -> Result<MatrixFit, MatrixFitError> {
    let MatrixFitOptions { dyes, count, reflectance } = options;
    if let Some(found) = count.filter(|count| !(1..=2).contains(count)) {
        return Err(MatrixFitError::Count { found });
    }
    let fitting = Fitting { measured, goal: MatrixGoal::new(measured)? };
    let is_measured = *reflectance == Some(MatrixReflectance::Measured);
    let two = *count == Some(2);
    let mut found = Vec::new();
    match dyes {
        MatrixDyes::Of(_) if is_measured => {
            return Err(MatrixFitError::Reflectance { found: "dyes of a table" });
        }
        MatrixDyes::Of(dyes) => found.push(fitting.of_table(dyes, *count != Some(1))),
        MatrixDyes::Measured if is_measured && two => {
            return Err(MatrixFitError::Reflectance { found: "two emitting dyes" });
        }
        MatrixDyes::Measured => {
            let emitters = separated(measured, &fitting.goal, count.unwrap_or(1));
            if !two && *reflectance != Some(MatrixReflectance::Sigmoid) {
                found.push(fitting.on_white(&emitters));
            }
            if !is_measured {
                found.push(fitting.on_sigmoid(&emitters));
            }
        }
    }
    let distance = |fit: &MatrixFit| fitting.goal.distance(&fit.matrix);
    // What noise makes of a dye may be none, while another way has one.
    found
        .into_iter()
        .min_by(|a, b| match (a, b) {
            (Ok(a), Ok(b)) => distance(a).total_cmp(&distance(b)),
            (a, b) => a.is_err().cmp(&b.is_err()),
        })
        .expect("one or two dyes, and a reflectance that goes with them")
}

/// A matrix and how materials are compared with it.
struct Fitting<'a> {
    measured: &'a DonaldsonMatrix,
    goal: MatrixGoal,
}

impl Fitting<'_> {
    /// One dye of the matrix and its measured reflectance.
    fn on_white(&self, emitters: &[Emitter]) -> Result<MatrixFit, MatrixFitError> {
        let emitter = emitters.first().filter(|emitter| emitter.is_above_noise(self.measured));
        let dyes = film_on_white(self.measured, emitter);
        MatrixFit::new(self.measured, Sigmoid::flat(1.0), dyes)
    }

    /// Dyes of the matrix over a sigmoid.
    fn on_sigmoid(&self, emitters: &[Emitter]) -> Result<MatrixFit, MatrixFitError> {
        let of_yield = |quantum_yield| {
            let dyes = emitting_dyes(self.measured, emitters, quantum_yield);
            let starts = |of: fn(&DyeInFilm) -> f64| Some([of(dyes.first()?), of(dyes.last()?)]);
            let densities = starts(|(_, density)| *density)?;
            let yields = starts(|(dye, _)| dye.quantum_yield.unwrap_or(1.0))?;
            let dyes: Vec<MeasuredDye> = dyes.iter().map(|(dye, _)| dye.clone()).collect();
            let found = TableDyes::new(self.measured, &self.goal, &dyes).from(densities, yields)?;
            Some((found, dyes))
        };
        let found = FIRST_YIELDS.into_iter().filter_map(of_yield);
        match found.min_by(|(a, _), (b, _)| a.norm().total_cmp(&b.norm())) {
            Some((found, dyes)) => MatrixFit::of(self.measured, &dyes, &found),
            // Where nothing emits, any dye will do.
            None => self.of_table(&MeasuredDye::all().take(1).collect::<Vec<_>>(), false),
        }
    }

    /// The nearest of these dyes over a sigmoid, one or, if two are allowed, two.
    fn of_table(&self, dyes: &[MeasuredDye], two: bool) -> Result<MatrixFit, MatrixFitError> {
        let table = TableDyes::new(self.measured, &self.goal, dyes);
        let found = if two { table.best_of_two() } else { table.best_of_one() };
        MatrixFit::of(self.measured, dyes, &found.ok_or(MatrixFitError::NoDyes)?)
    }
}

/// How far above the least the yields of dyes of the matrix start, over a reflectance that is not measured.
const FIRST_YIELDS: [f64; 3] = [0.1, 0.4, 1.0];

/// What the record of a fit calls this method.
const METHOD: &str = "fit-matrix";

impl MatrixFit {
    fn of(
        measured: &DonaldsonMatrix,
        dyes: &[MeasuredDye],
        found: &Found,
    ) -> Result<Self, MatrixFitError> {
        let with_yield = |k: usize| {
            let dye = fitted_dye(&dyes[found.dyes[k]], found.yields[k], None);
            (dye, found.densities[k])
        };
        let count = if found.dyes[0] == found.dyes[1] { 1 } else { 2 };
        Self::new(measured, found.reflectance, (0..count).map(with_yield).collect())
    }

    fn new(
        measured: &DonaldsonMatrix,
        reflectance: Sigmoid,
        dyes: Vec<DyeInFilm>,
    ) -> Result<Self, MatrixFitError> {
        // As a cube stores it, so that what is reported is what is written.
        let reflectance = reflectance.to_edge(MIDDLE_NM);
        let material = OwnMaterial::new(vec![FilmPart { weight: 1.0, reflectance, dyes }])?;
        let matrix = material.mixture().matrix_like(measured);
        Ok(Self { material, matrix })
    }

    /// The model: a film of the fitted dyes, whose quantum yields are those of the set.
    pub fn model(&self) -> &Model {
        self.material.model()
    }

    /// The material.
    pub fn material(&self) -> Material {
        self.material.parts()[0].1
    }

    /// The material as a matrix on the axes of the measured one.
    pub fn matrix(&self) -> &DonaldsonMatrix {
        &self.matrix
    }

    /// How the material looks beside the matrix it was fitted to.
    ///
    /// # Errors
    ///
    /// [`ContractError`] if the observer sees nothing of D65 on these axes.
    pub fn difference(
        &self,
        measured: &DonaldsonMatrix,
        light: &Illuminant,
    ) -> Result<MatrixDifference, ContractError> {
        MatrixDifference::of(measured, &self.matrix, light)
    }

    /// [`OwnMaterial::to_cube`] under the default contract.
    ///
    /// # Errors
    ///
    /// [`CubeError`] if a number of the material is out of range.
    pub fn to_cube(&self) -> Result<Cube, CubeError> {
        self.material.to_cube(&Contract::default(), METHOD)
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use proptest::prelude::*;
    use std::path::Path;
    use upglow::{Accounting, DyeSet, FilmModel, Fluorescence, Mixture, QuantumYield};
    use upglow_color::BispectralUnit;

    /// Numbers without a pattern, from -1 to 1, of about unit variance.
    fn noise(seed: u64) -> f64 {
        let bits = (seed + 1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        let bits = (bits ^ (bits >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let unit = ((bits ^ (bits >> 32)) >> 11) as f64 / (1u64 << 53) as f64;
        3f64.sqrt() * (2.0 * unit - 1.0)
    }

    /// The matrix of a film of one dye with this noise in each element, and the material of it.
    pub(crate) fn film_matrix(deviation: f64, seed: u64) -> (DonaldsonMatrix, Material) {
        let dyes = MeasuredDye::all().enumerate();
        let dyes: Vec<MeasuredDye> =
            dyes.filter(|(k, _)| *k as u64 % 28 == seed % 28).map(|(_, dye)| dye).collect();
        let set = DyeSet::new("one", dyes).unwrap();
        let film = FilmModel::new(set, Accounting::Photon, QuantumYield::Measured).unwrap();
        let reflectance = Sigmoid { c0: 0.0, c1: 0.01, c2: -4.5 };
        let density = 0.5 + (seed % 5) as f64 / 2.0;
        let material =
            Material { reflectance, fluorescence: Fluorescence::film((0, density), (0, 0.0)) };
        let axis = |first: u32| (first..=780).step_by(10).map(f64::from).collect::<Vec<f64>>();
        let rows = vec![vec![0.0; 49]; 41];
        let empty =
            DonaldsonMatrix::try_new(axis(300), axis(380), rows, BispectralUnit::PerBand).unwrap();
        let quiet = Mixture::of(&Model::Film(film), material).matrix_like(&empty);
        let element = |o: usize, i: usize| {
            quiet.factors()[o][i] + deviation * noise(seed * 10_000 + (o * 100 + i) as u64)
        };
        (quiet.with_factors(element), material)
    }

    fn lights() -> Vec<Illuminant> {
        let named = |name| Illuminant::named(name).unwrap();
        let cut = named("D65-cut400");
        let lamp = Illuminant::mineral_lamp();
        vec![named("A"), named("E"), cut, named("FL2"), named("HP5"), lamp]
    }

    fn mean(fit: &MatrixFit, measured: &DonaldsonMatrix) -> f64 {
        let of = |light: &Illuminant| fit.difference(measured, light).unwrap().de2000;
        let found: Vec<f64> = lights().iter().map(of).collect();
        found.iter().sum::<f64>() / found.len() as f64
    }

    fn of_table(count: usize) -> MatrixFitOptions {
        MatrixFitOptions {
            dyes: MatrixDyes::Of(MeasuredDye::all().collect()),
            count: Some(count),
            reflectance: None,
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(8))]
        #[test]
        fn the_matrix_of_a_film_gives_a_material_that_looks_like_it(seed in 0u64..1000) {
            // Where the dye absorbs more than the least that explains what it emits.
            let (measured, _) = film_matrix(0.0, seed);
            let fit = fit_matrix(&measured, &MatrixFitOptions::default()).unwrap();
            prop_assert!(mean(&fit, &measured) < 0.5, "{}", mean(&fit, &measured));
            // With as much noise as the BFC-450 has: the fit adds little to what that changes itself.
            let (noisy, _) = film_matrix(0.001, seed);
            let fit = fit_matrix(&noisy, &MatrixFitOptions::default()).unwrap();
            // Under the ultraviolet lamp there is little else to be seen than noise.
            let lights = &lights()[..5];
            let mean_of = |matrix: &DonaldsonMatrix| {
                let of = |light| MatrixDifference::of(&measured, matrix, light).unwrap().de2000;
                lights.iter().map(of).sum::<f64>() / 5.0
            };
            let [own, found] = [mean_of(&noisy), mean_of(fit.matrix())];
            prop_assert!(found < own + 0.4, "{found} {own}");
        }
    }

    #[test]
    fn the_dye_and_the_reflectance_of_a_film_are_found() {
        // Where the solver stops.
        const STATIONARY: f64 = 0.02;
        for seed in [1, 12] {
            let (measured, material) = film_matrix(0.0, seed);
            let fit = fit_matrix(&measured, &of_table(1)).unwrap();
            let Fluorescence::Film { densities, .. } = material.fluorescence else { panic!() };
            let Fluorescence::Film { densities: found, .. } = fit.material().fluorescence else {
                panic!("no dye is found")
            };
            assert!((found[0] - densities[0]).abs() < STATIONARY * densities[0], "{found:?}");
            for nm in [450.0, 550.0, 650.0] {
                let error = fit.material().reflectance.at(nm) - material.reflectance.at(nm);
                assert!(error.abs() < STATIONARY, "{error} at {nm} nm");
            }
        }
    }

    #[test]
    fn a_gray_has_no_emitting_dye() {
        let (film, _) = film_matrix(0.0, 0);
        let gray = film.with_factors(|o, i| if o + 8 == i { 0.4 } else { 0.0 });
        let as_measured = MatrixFitOptions {
            reflectance: Some(MatrixReflectance::Measured),
            ..Default::default()
        };
        let fit = fit_matrix(&gray, &as_measured).unwrap();
        // Single precision of the stored material.
        assert!(mean(&fit, &gray) < 1e-3);
        let dyes = fit.model().dyes().unwrap().set().dyes();
        assert_eq!((dyes.len(), dyes[0].quantum_yield), (1, Some(0.0)));
        let sigmoid = MatrixFitOptions {
            reflectance: Some(MatrixReflectance::Sigmoid),
            ..Default::default()
        };
        let fit = fit_matrix(&gray, &sigmoid).unwrap();
        assert!(mean(&fit, &gray) < 0.1, "{}", mean(&fit, &gray));
    }

    #[test]
    fn a_fit_is_a_cube_of_one_material() {
        let (measured, _) = film_matrix(0.0, 3);
        let fit = fit_matrix(&measured, &MatrixFitOptions::default()).unwrap();
        let cube = fit.to_cube().unwrap();
        assert!((0..8).all(|index| cube.node_material(index) == fit.material()));
    }

    #[test]
    fn options_that_do_not_fit_together_are_refused() {
        let (measured, _) = film_matrix(0.0, 3);
        let refused = |options| fit_matrix(&measured, &options).unwrap_err().to_string();
        let three = MatrixFitOptions { count: Some(3), ..MatrixFitOptions::default() };
        assert_eq!(refused(three), "3 emitting dyes, expected 1 or 2");
        let two = MatrixFitOptions {
            count: Some(2),
            reflectance: Some(MatrixReflectance::Measured),
            ..MatrixFitOptions::default()
        };
        assert!(refused(two).starts_with("measured with two emitting dyes, expected"));
        let none = MatrixFitOptions { dyes: MatrixDyes::Of(Vec::new()), ..of_table(1) };
        assert_eq!(refused(none), "no dyes, expected at least one");
    }

    #[test]
    fn measured_materials_look_as_they_were_measured() {
        // Over six lights.
        const MEAN_GOAL: f64 = 1.0;
        const WORST_GOAL: f64 = 1.5;
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../../shared/data/bispectral");
        if !folder.is_dir() {
            eprintln!(
                "skipped: measured_materials_look_as_they_were_measured (no ../shared/data/bispectral)"
            );
            return;
        }
        let mut means = Vec::new();
        for name in ["CIBA12", "HERPIORA", "POLGREE", "TEXTYELL"] {
            let text = std::fs::read_to_string(folder.join(format!("{name}.BFC"))).unwrap();
            let measured = DonaldsonMatrix::from_bfc(&text).unwrap();
            let fit = fit_matrix(&measured, &MatrixFitOptions::default()).unwrap();
            means.push(mean(&fit, &measured));
        }
        let all = means.iter().sum::<f64>() / means.len() as f64;
        assert!(all <= MEAN_GOAL && means.iter().all(|mean| *mean <= WORST_GOAL), "{means:?}");
    }
}
