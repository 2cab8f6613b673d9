//! Colors of whole images.

use std::ffi::c_char;

use upglow::ColorTable;
use upglow_color::{Contract, Grid, Illuminant};

use crate::cube::UpglowCube;
use crate::failure::{Failure, UpglowStatus, guarded};
use crate::pointer::{
    Output, assert_shared_by_threads, borrowed, destroy, refuse_overlap, slice, slice_mut, text,
};

/// The colors of a cube's materials under one light. It is immutable: any number of threads may use
/// it at once. It does not refer to the cube.
#[derive(Debug)]
pub struct UpglowColors {
    table: ColorTable,
}

const _: () = assert_shared_by_threads::<UpglowColors>();

/// Computes the colors of a cube's materials under a built-in light, or under the cube's own if
/// `illuminant` is null: "D50", "D55", "D60", "D65", "D75", "A", "E", "FL1" to "FL12", "FL3.1" to
/// "FL3.15", "HP1" to "HP5", "LED-B1" to "LED-B5", "LED-BH1", "LED-RGB1", "LED-V1", "LED-V2", "ID50",
/// "ID65", "M0", "M1", "M2", a blackbody such as "3000K" or daylight such as "D6200K". Lamps have no
/// power below 380 nm: what dyes absorb there is not counted.
///
/// `*colors` receives colors that the caller owns and must destroy with `upglow_colors_destroy`. All
/// memory for `upglow_xyz` is allocated here: 16 bytes per node of the cube.
///
/// Fails with `UPGLOW_STATUS_INVALID_ARGUMENT` if there is no such light, or it has no luminance for
/// the cube's observer.
///
/// # Safety
///
/// Pointers are null or point to a cube, to text that ends with a zero byte and to room for a
/// pointer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn upglow_colors_create(
    cube: *const UpglowCube,
    illuminant: *const c_char,
    colors: *mut *mut UpglowColors,
) -> UpglowStatus {
    guarded(|| {
        // SAFETY: the caller keeps this function's promise.
        let (cube, output) = unsafe { (borrowed(cube, "cube")?, Output::new(colors, "colors")?) };
        // SAFETY: the same.
        let named = unsafe { named_light(illuminant)? };
        let light = named.unwrap_or_else(|| cube.cube.contract().illuminant.clone());
        output.write(Box::into_raw(UpglowColors::try_new(cube, light)?));
        Ok(())
    })
}

/// Computes the colors of a cube's materials under a measured light.
///
/// `lambda_nm` and `power` are `[count]`: wavelengths (nm) that ascend from 300 or below to 830 or
/// above in steps of at most 10, and the light's relative power at each, 0 or more. Both are copied.
/// `*colors` receives colors as from `upglow_colors_create`.
///
/// Fails with `UPGLOW_STATUS_INVALID_ARGUMENT` if the samples are invalid, and names the index from
/// 0, or if the light has no luminance for the cube's observer.
///
/// # Safety
///
/// Pointers are null or point to a cube, to `count` values each and to room for a pointer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn upglow_colors_create_sampled(
    cube: *const UpglowCube,
    lambda_nm: *const f32,
    power: *const f32,
    count: usize,
    colors: *mut *mut UpglowColors,
) -> UpglowStatus {
    guarded(|| {
        // SAFETY: the caller keeps this function's promise.
        let (cube, output) = unsafe { (borrowed(cube, "cube")?, Output::new(colors, "colors")?) };
        // SAFETY: the same.
        let (nm, power) =
            unsafe { (slice(lambda_nm, count, "lambda_nm")?, slice(power, count, "power")?) };
        let doubles = |values: &[f32]| values.iter().map(|&v| f64::from(v)).collect::<Vec<_>>();
        let [nm, power] = [nm, power].map(doubles);
        let light = Illuminant::from_samples("sampled", &nm, &power, None)?;
        output.write(Box::into_raw(UpglowColors::try_new(cube, light)?));
        Ok(())
    })
}

/// The built-in light of this name; `None` if it is null.
///
/// # Safety
///
/// It is null or points to text that ends with a zero byte.
pub(crate) unsafe fn named_light(illuminant: *const c_char) -> Result<Option<Illuminant>, Failure> {
    // SAFETY: the caller promises it.
    unsafe { named(illuminant, "illuminant", Illuminant::named) }
}

/// What is built in under this name; `None` if it is null.
///
/// # Safety
///
/// It is null or points to text that ends with a zero byte.
pub(crate) unsafe fn named<T, E: Into<Failure>>(
    name: *const c_char,
    argument: &'static str,
    find: impl Fn(&str) -> Result<T, E>,
) -> Result<Option<T>, Failure> {
    if name.is_null() {
        return Ok(None);
    }
    // SAFETY: the caller promises it.
    let name = unsafe { text(name, argument)? }.to_str();
    let name = name.map_err(|_| Failure::NotText { argument })?;
    find(name).map(Some).map_err(Into::into)
}

impl UpglowColors {
    fn try_new(cube: &UpglowCube, illuminant: Illuminant) -> Result<Box<Self>, Failure> {
        let contract = Contract { illuminant, ..cube.cube.contract().clone() };
        contract.check()?;
        Ok(Box::new(Self { table: cube.cube.color_table(&contract.on(Grid::FIT)) }))
    }
}

/// Frees colors; null is allowed and does nothing. No other thread may be using them.
///
/// # Safety
///
/// `colors` is null or came from `upglow_colors_create` or `upglow_colors_create_sampled`, and was
/// not destroyed before.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn upglow_colors_destroy(colors: *mut UpglowColors) {
    // SAFETY: the caller keeps this function's promise, which is the same.
    unsafe { destroy(colors) };
}

/// X, Y and Z of the materials of `count` colors, for the cube's observer; Y of the perfect diffuser
/// under the light is 1.
///
/// `rgb` and `xyz` are `[count][3]`: red, green, blue of each color in turn, linear, in the cube's
/// space; X, Y, Z of each in turn. They must not overlap. X, Y and Z of colors outside the cube, or
/// NaN, are NaN; `*outside`, unless `outside` is null, receives the number of these colors.
///
/// # Safety
///
/// Pointers are null or point to colors, to 3 times `count` values each and to room for a number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn upglow_xyz(
    colors: *const UpglowColors,
    rgb: *const f32,
    xyz: *mut f32,
    count: usize,
    outside: *mut usize,
) -> UpglowStatus {
    guarded(|| {
        refuse_overlap(rgb, xyz.cast::<[f32; 3]>(), count, "xyz")?;
        let mut ignored = 0;
        let outside = if outside.is_null() { &raw mut ignored } else { outside };
        // SAFETY: the caller keeps this function's promise, and the arrays do not overlap.
        let (rgb, xyz) = unsafe { (slice(rgb.cast::<[f32; 3]>(), count, "rgb")?, xyz.cast()) };
        // SAFETY: the same.
        let (colors, xyz, output) = unsafe {
            let xyz = slice_mut(xyz, count, "xyz")?;
            (borrowed(colors, "colors")?, xyz, Output::new(outside, "outside")?)
        };
        output.write(colors.table.xyz(rgb, xyz).expect("both arrays have `count` colors"));
        Ok(())
    })
}
