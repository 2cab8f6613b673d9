//! Materials as 4×4 matrices, for engines without spectra.

use std::ffi::c_char;

use upglow::ReducedTable;
use upglow_color::rounding::to_single;
use upglow_color::{EngineSpace, Grid, ReducedBasis, RgbSpace};

use crate::colors::{named, named_light};
use crate::cube::UpglowCube;
use crate::failure::{UpglowStatus, guarded};
use crate::pointer::{Output, array, assert_shared_by_threads, borrowed, destroy};

/// The materials of a cube as 4x4 matrices of light given by four numbers: three of color, and ultraviolet. It is immutable:
/// any number of threads may use it at once. It does not refer to the cube.
#[derive(Debug)]
pub struct UpglowMatrices {
    basis: ReducedBasis,
    table: ReducedTable,
    /// `None` for X, Y, Z.
    engine: Option<EngineSpace>,
}

const _: () = assert_shared_by_threads::<UpglowMatrices>();

/// Computes the matrices of a cube's materials. `docs/rgb-engines.md` of the sources has the equation
/// and the errors.
///
/// `engine` is the name of the RGB space that an engine keeps light in, as for `upglow build --space`:
/// light is then linear red, green and blue, each 1 in the cube's own light, and U. Null: X, Y, Z and U.
///
/// `*matrices` receives matrices that the caller owns and must destroy with
/// `upglow_matrices_destroy`. All memory for `upglow_reduced_matrix` is allocated here: 64 bytes per
/// node of the cube.
///
/// Fails with `UPGLOW_STATUS_INVALID_ARGUMENT` if the light of the cube has next to no blue, green or
/// red, or there is no such RGB space.
///
/// # Safety
///
/// Pointers are null or point to a cube, to text that ends with a zero byte and to room for a pointer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn upglow_matrices_create(
    cube: *const UpglowCube,
    engine: *const c_char,
    matrices: *mut *mut UpglowMatrices,
) -> UpglowStatus {
    guarded(|| {
        // SAFETY: the caller keeps this function's promise.
        let (cube, output) =
            unsafe { (borrowed(cube, "cube")?, Output::new(matrices, "matrices")?) };
        // SAFETY: the same.
        let engine = unsafe { named(engine, "engine", RgbSpace::named)? };
        let basis = ReducedBasis::try_new(cube.cube.contract(), Grid::FIT)?;
        let engine = engine.map(|space| basis.engine_space(&space)).transpose()?;
        let table = cube.cube.reduced_table(&basis);
        let table = match &engine {
            Some(engine) => table.in_engine(engine),
            None => table,
        };
        let made = UpglowMatrices { basis, table, engine };
        output.write(Box::into_raw(Box::new(made)));
        Ok(())
    })
}

/// Frees matrices; null is allowed and does nothing. No other thread may be using them.
///
/// # Safety
///
/// `matrices` is null or came from `upglow_matrices_create`, and was not destroyed before.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn upglow_matrices_destroy(matrices: *mut UpglowMatrices) {
    // SAFETY: the caller keeps this function's promise, which is the same.
    unsafe { destroy(matrices) };
}

/// The matrix of a color's material: `matrix` is `[4][4]`, outgoing and incident, each X, Y, Z, U or R, G, B, U. Its
/// product with the four numbers of a light is what leaves. Matrices may be interpolated and filtered.
///
/// `rgb` is red, green and blue, linear, in the cube's space.
///
/// Fails with `UPGLOW_STATUS_OUTSIDE` if a component is not in 0 to 1.
///
/// # Safety
///
/// Pointers are null or point to matrices, to 3 values and to room for 16.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn upglow_reduced_matrix(
    matrices: *const UpglowMatrices,
    rgb: *const f32,
    matrix: *mut f32,
) -> UpglowStatus {
    guarded(|| {
        // SAFETY: the caller keeps this function's promise.
        let (matrices, rgb, output) = unsafe {
            let output = Output::new(matrix.cast::<[[f32; 4]; 4]>(), "matrix")?;
            (borrowed(matrices, "matrices")?, array(rgb, "rgb")?, output)
        };
        output.write(matrices.table.matrix(rgb)?);
        Ok(())
    })
}

/// X, Y, Z and U, or R, G, B and U, of a built-in light, named as for `upglow_colors_create`, or of the cube's own if
/// `illuminant` is null: `light` is `[4]`. A perfect diffuser has Y = 1; light too dark to see by, such
/// as an ultraviolet lamp's, has as much power as the cube's own. D65 has U = 1. It allocates memory,
/// and frees it.
///
/// Fails with `UPGLOW_STATUS_INVALID_ARGUMENT` if there is no such light.
///
/// # Safety
///
/// Pointers are null or point to matrices, to text that ends with a zero byte and to room for 4 values.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn upglow_reduced_light(
    matrices: *const UpglowMatrices,
    illuminant: *const c_char,
    light: *mut f32,
) -> UpglowStatus {
    guarded(|| {
        // SAFETY: the caller keeps this function's promise.
        let (matrices, output) = unsafe {
            let output = Output::new(light.cast::<[f32; 4]>(), "light")?;
            (borrowed(matrices, "matrices")?, output)
        };
        // SAFETY: the same.
        let named = unsafe { named_light(illuminant)? };
        let numbers = named.map_or(matrices.basis.white(), |light| matrices.basis.light(&light));
        let numbers = matrices.engine.map_or(numbers, |engine| engine.light(numbers));
        output.write(numbers.0.map(to_single));
        Ok(())
    })
}
