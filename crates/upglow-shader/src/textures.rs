//! A cube's numbers as two textures of four floats per texel.

use upglow::{Cube, DyeModel, FilmModel, ReducedTable};
use upglow_color::rounding::to_single;
use upglow_color::{Grid, Spectrum};

use crate::error::ShaderError;

/// The most texels along an axis, which is `WebGPU`'s default limit. OpenGL ES and Direct3D 10
/// require less.
pub(crate) const MOST_TEXELS: usize = 8192;

/// Bins of 1 nm in the range of the curves.
pub(crate) const BINS: usize = Grid::FINE.len() - 1;

/// Rows of the texture of curves: one for each sample, and one for the dyes' numbers.
const CURVE_ROWS: usize = BINS + 2;

/// Four floats per texel, `[row][column]`.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Texture {
    pub(crate) width: usize,
    pub(crate) texels: Vec<[f32; 4]>,
}

impl Texture {
    pub(crate) fn height(&self) -> usize {
        self.texels.len() / self.width.max(1)
    }
}

/// The nodes: texel (2·red + part, blue·n + green) of n nodes along an axis.
///
/// Part 0 is the reflectance of [`upglow::PackedNode`], part 1 its fluorescence.
///
/// # Errors
///
/// [`ShaderError::Resolution`] if the texture would have more rows than drivers support.
pub(crate) fn nodes(cube: &Cube) -> Result<Texture, ShaderError> {
    let texels = cube.packed_nodes().map(|node| [node.reflectance, node.fluorescence]);
    of_nodes(cube, texels)
}

/// The matrices of the nodes: texel (4·red + row, blue·n + green).
///
/// # Errors
///
/// [`ShaderError::Resolution`] if the texture would have more rows than drivers support.
pub(crate) fn matrices(cube: &Cube, table: &ReducedTable) -> Result<Texture, ShaderError> {
    let rows = |numbers: [f32; 16]| [0, 1, 2, 3].map(|r| [0, 1, 2, 3].map(|c| numbers[4 * r + c]));
    of_nodes(cube, table.nodes().map(rows))
}

/// As many texels side by side for each node.
fn of_nodes<const N: usize>(
    cube: &Cube,
    texels: impl Iterator<Item = [[f32; 4]; N]>,
) -> Result<Texture, ShaderError> {
    let n = cube.resolution();
    if n * n > MOST_TEXELS {
        return Err(ShaderError::Resolution { found: n, most: MOST_TEXELS.isqrt() });
    }
    Ok(Texture { width: N * n, texels: texels.flatten().collect() })
}

/// The curves of a ring of dyes: texel (2·dye + part, sample).
///
/// Part 0 is absorption and emission, each followed by the step to the next sample. Part 1 is their
/// integrals up to the sample: of the absorption, of the absorption times the wavelength, of the
/// emission. The last row is each dye's quantum yield, mean emission (nm), ∫ returned dλ by itself
/// (nm) and ∫ ê dλ.
pub(crate) fn curves(dyes: &DyeModel) -> Texture {
    of_columns((0..dyes.curves().len()).flat_map(|dye| dye_columns(dyes, dye)))
}

/// The curves of a film: those of its dyes as in [`curves`], and after them texel
/// (2·(dyes + dye) + part, sample).
///
/// Part 0 is what the dye returns at each of [`FilmModel::LEVELS`], part 1 the integrals of that up to
/// the sample. In the last row they are zeros.
pub(crate) fn film_curves(film: &FilmModel) -> Texture {
    let dyes = film.dyes();
    let numbers = || 0..dyes.curves().len();
    let levels = numbers().flat_map(|dye| level_columns(film, dye));
    of_columns(numbers().flat_map(|dye| dye_columns(dyes, dye)).chain(levels))
}

/// A column of [`CURVE_ROWS`] texels.
type Column = Vec<[f64; 4]>;

fn of_columns(columns: impl Iterator<Item = Column>) -> Texture {
    let columns: Vec<Column> = columns.collect();
    let texels = (0..CURVE_ROWS).flat_map(|row| columns.iter().map(move |column| column[row]));
    Texture { width: columns.len(), texels: texels.map(single).collect() }
}

fn level_columns(film: &FilmModel, dye: usize) -> [Column; 2] {
    let quantum_yield = film.dyes().curves()[dye].quantum_yield;
    let returned = film.proposed(dye).map(|level| level.iter().map(|a| quantum_yield * a));
    let returned = returned.map(Iterator::collect::<Vec<f64>>);
    let integrals = returned.each_ref().map(|level| integral(level));
    [returned, integrals].map(|levels| {
        let row = |i: usize| levels.each_ref().map(|level| level.get(i).copied().unwrap_or(0.0));
        (0..CURVE_ROWS).map(row).collect()
    })
}

fn dye_columns(dyes: &DyeModel, dye: usize) -> [Column; 2] {
    let curves = &dyes.curves()[dye];
    let [a, e] = [curves.absorption.values(), curves.emission.values()];
    let rise = |of: &[f64], i: usize| of.get(i + 1).map_or(0.0, |next| next - of[i]);
    let mut values: Column = (0..=BINS).map(|i| [a[i], rise(a, i), e[i], rise(e, i)]).collect();
    let [area, emitted] = [integral(a), integral(e)];
    let moment = moment_integral(&curves.absorption);
    let numbers = [
        curves.quantum_yield,
        curves.mean_emission_nm,
        curves.returned_nm(dyes.options().accounting),
        emitted[BINS],
    ];
    values.push(numbers);
    let mut integrals: Column = (0..=BINS).map(|i| [area[i], moment[i], emitted[i], 0.0]).collect();
    integrals.push([0.0; 4]);
    [values, integrals]
}

/// ∫ curve dλ up to each sample: trapezoids 1 nm wide.
fn integral(curve: &[f64]) -> Vec<f64> {
    running_sum(curve.windows(2).map(|pair| 0.5 * (pair[0] + pair[1])))
}

/// ∫ curve·λ dλ up to each sample, for the straight lines between samples 1 nm apart.
fn moment_integral(curve: &Spectrum) -> Vec<f64> {
    let bins = curve.values().windows(2).zip(Grid::FINE.wavelengths_nm());
    running_sum(
        bins.map(|(pair, nm)| 0.5 * nm * (pair[0] + pair[1]) + pair[0] / 6.0 + pair[1] / 3.0),
    )
}

fn running_sum(terms: impl Iterator<Item = f64>) -> Vec<f64> {
    let sums = terms.scan(0.0, |sum, term| {
        *sum += term;
        Some(*sum)
    });
    std::iter::once(0.0).chain(sums).collect()
}

/// The nearest numbers in single precision; 0 if one is not finite.
fn single(texel: [f64; 4]) -> [f32; 4] {
    texel.map(to_single).map(|value| if value.is_finite() { value } else { 0.0 })
}

#[cfg(test)]
mod tests {
    use super::*;
    use upglow::{Accounting, DyeOptions, DyeSet, QuantumYield};

    #[test]
    fn integrals_of_a_curve_are_those_of_its_polygon() {
        let dyes = DyeModel::new(DyeSet::named("konig8").unwrap(), DyeOptions::default()).unwrap();
        for curves in dyes.curves() {
            let a = &curves.absorption;
            // Rounding of sums of 530 terms.
            assert!((integral(a.values())[BINS] - a.area(300.0, 830.0)).abs() < 1e-10);
            let n = 530_000;
            let step = 530.0 / f64::from(n);
            let at = |i| 300.0 + step * (f64::from(i) + 0.5);
            let sum: f64 = (0..n).map(|i| a.at(at(i)) * at(i)).sum::<f64>() * step;
            // A midpoint sum errs by the square of its step.
            assert!((moment_integral(a)[BINS] / sum - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn the_ring_has_a_pair_of_columns_per_dye_and_a_row_of_numbers() {
        let dyes = DyeModel::new(DyeSet::named("konig8").unwrap(), DyeOptions::default()).unwrap();
        let texture = curves(&dyes);
        assert_eq!([texture.width, texture.height()], [16, 532]);
        let numbers = texture.texels[531 * 16 + 2 * 3];
        let [quantum_yield, mean_nm, returned_nm, emitted] = numbers.map(f64::from);
        let dye = &dyes.curves()[3];
        assert_eq!(quantum_yield, 1.0);
        // Single precision of numbers below 1024.
        assert!((mean_nm - dye.mean_emission_nm).abs() < 4e-5);
        assert!((returned_nm - dye.absorption.area(300.0, 830.0)).abs() < 4e-5);
        assert!((0.99..=1.0).contains(&emitted));
    }

    #[test]
    fn the_levels_of_a_film_follow_the_columns_of_its_dyes() {
        let set = || DyeSet::named("konig8").unwrap();
        let film = FilmModel::new(set(), Accounting::Energy, QuantumYield::Fixed(0.5)).unwrap();
        let texture = film_curves(&film);
        assert_eq!([texture.width, texture.height()], [32, 532]);
        let texel = |column: usize, row: usize| texture.texels[row * 32 + column].map(f64::from);
        let plain = curves(film.dyes());
        for row in 0..532 {
            assert_eq!(texture.texels[row * 32..][..16], plain.texels[row * 16..][..16]);
        }
        let absorption = film.dyes().curves()[3].absorption.values();
        let column = 2 * (8 + 3);
        let mut integrals = [0.0; 4];
        for row in 0..531 {
            for (k, level) in FilmModel::LEVELS.into_iter().enumerate() {
                let absorbed = |row: usize| 1.0 - 10_f64.powf(-level * absorption[row]);
                // Single precision of numbers below 1.
                assert!((texel(column, row)[k] - 0.5 * absorbed(row)).abs() < 6e-8);
                integrals[k] +=
                    if row == 0 { 0.0 } else { 0.25 * (absorbed(row - 1) + absorbed(row)) };
                // Single precision of numbers below 512.
                assert!((texel(column + 1, row)[k] - integrals[k]).abs() < 4e-5);
            }
        }
        assert_eq!([texel(column, 531), texel(column + 1, 531)], [[0.0; 4]; 2]);
    }
}
