//! A cube's numbers as two textures of four floats per texel.

use upglow::{Cube, DyeModel};
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
    let n = cube.resolution();
    if n * n > MOST_TEXELS {
        return Err(ShaderError::Resolution { found: n, most: MOST_TEXELS.isqrt() });
    }
    let texels = cube.packed_nodes().flat_map(|node| [node.reflectance, node.fluorescence]);
    Ok(Texture { width: 2 * n, texels: texels.collect() })
}

/// The curves of a ring of dyes: texel (2·dye + part, sample).
///
/// Part 0 is absorption and emission, each followed by the step to the next sample. Part 1 is their
/// integrals up to the sample: of the absorption, of the absorption times the wavelength, of the
/// emission. The last row is each dye's quantum yield, mean emission (nm), ∫ returned dλ by itself
/// (nm) and ∫ ê dλ.
pub(crate) fn curves(dyes: &DyeModel) -> Texture {
    let columns: Vec<[Vec<[f64; 4]>; 2]> =
        (0..dyes.curves().len()).map(|dye| dye_columns(dyes, dye)).collect();
    let texels = (0..CURVE_ROWS).flat_map(|row| {
        columns.iter().flat_map(move |[values, integrals]| [values[row], integrals[row]])
    });
    Texture { width: 2 * columns.len(), texels: texels.map(single).collect() }
}

fn dye_columns(dyes: &DyeModel, dye: usize) -> [Vec<[f64; 4]>; 2] {
    let curves = &dyes.curves()[dye];
    let [a, e] = [curves.absorption.values(), curves.emission.values()];
    let rise = |of: &[f64], i: usize| of.get(i + 1).map_or(0.0, |next| next - of[i]);
    let mut values: Vec<[f64; 4]> =
        (0..=BINS).map(|i| [a[i], rise(a, i), e[i], rise(e, i)]).collect();
    let [area, emitted] = [integral(&curves.absorption), integral(&curves.emission)];
    let moment = moment_integral(&curves.absorption);
    let numbers = [
        curves.quantum_yield,
        curves.mean_emission_nm,
        curves.returned_nm(dyes.options().accounting),
        emitted[BINS],
    ];
    values.push(numbers);
    let mut integrals: Vec<[f64; 4]> =
        (0..=BINS).map(|i| [area[i], moment[i], emitted[i], 0.0]).collect();
    integrals.push([0.0; 4]);
    [values, integrals]
}

/// ∫ curve dλ up to each sample: trapezoids 1 nm wide.
fn integral(curve: &Spectrum) -> Vec<f64> {
    running_sum(curve.values().windows(2).map(|pair| 0.5 * (pair[0] + pair[1])))
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
    use upglow::{DyeOptions, DyeSet};

    #[test]
    fn integrals_of_a_curve_are_those_of_its_polygon() {
        let dyes = DyeModel::new(DyeSet::named("konig8").unwrap(), DyeOptions::default()).unwrap();
        for curves in dyes.curves() {
            let a = &curves.absorption;
            // Rounding of sums of 530 terms.
            assert!((integral(a)[BINS] - a.area(300.0, 830.0)).abs() < 1e-10);
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
}
