//! Materials: look-ups into the caller's memory, and their evaluation.

use std::mem::MaybeUninit;

use upglow::{Bispectral, PackedMixture};

use crate::cube::UpglowCube;
use crate::failure::{Failure, UpglowStatus, guarded};
use crate::pointer::{
    Output, array, assert_shared_by_threads, borrowed, refuse_overlap, slice, slice_mut,
};

/// The material of one color, in the caller's memory: on the stack, in an array, in another struct.
/// Nothing is allocated for it and nothing has to be freed. It may be copied.
///
/// `upglow_look_up` fills it; its content is private. It refers to its cube, which must outlive it.
/// A material of all zeros is empty, and functions refuse it. Any number of threads may read one.
#[repr(C, align(16))]
#[derive(Clone, Copy, Debug)]
pub struct UpglowMaterial {
    /// More room than this version needs, in reserve for later ones.
    words: [MaybeUninit<u64>; 32],
}

/// The content of an [`UpglowMaterial`] after a look-up.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
struct Filled<'c> {
    mark: u64,
    blend: PackedMixture<'c>,
}

/// Marks a material as filled: a value that uninitialized memory is unlikely to have.
const MARK: u64 = 0x7567_6c6f_775f_6d31;

const _: () = assert!(size_of::<Filled<'_>>() <= size_of::<UpglowMaterial>());
const _: () = assert!(align_of::<Filled<'_>>() <= align_of::<UpglowMaterial>());

const _: () = assert_shared_by_threads::<Filled<'_>>();

/// # Safety
///
/// The pointer is null or points to a material that is zeros or filled, whose cube lives, and that
/// is not written to for `'c`.
#[inline(always)]
pub(crate) unsafe fn looked_up<'c>(
    material: *const UpglowMaterial,
) -> Result<&'c PackedMixture<'c>, Failure> {
    // SAFETY: the caller promises that it is null or a material.
    let material: *const UpglowMaterial = unsafe { borrowed(material, "material")? };
    // SAFETY: a material has room for `Filled`, whose first word is zero or the mark.
    if unsafe { material.cast::<u64>().read() } != MARK {
        return Err(Failure::EmptyMaterial);
    }
    // SAFETY: only a look-up writes the mark, and it writes the rest with it.
    Ok(unsafe { &(*material.cast::<Filled<'c>>()).blend })
}

/// Looks up the material of a color: 3 linear components in the cube's RGB space, 0 to 1.
///
/// It allocates nothing. The material refers to the cube.
///
/// Fails with `UPGLOW_STATUS_OUTSIDE` if a component is not in 0 to 1; clamp first to get the nearest
/// color of the cube.
///
/// cbindgen:ptrs-as-arrays=[[rgb; 3]]
///
/// # Safety
///
/// Pointers are null or point to a cube, to 3 values and to room for a material.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn upglow_look_up(
    cube: *const UpglowCube,
    rgb: *const f32,
    material: *mut UpglowMaterial,
) -> UpglowStatus {
    guarded(|| {
        // SAFETY: the caller keeps this function's promise.
        let (cube, rgb) = unsafe { (borrowed(cube, "cube")?, array(rgb, "rgb")?) };
        // SAFETY: the same; a material has room for `Filled`, and its alignment.
        let output = unsafe { Output::new(material, "material")?.narrowed::<Filled<'_>>() };
        output.write(Filled { mark: MARK, blend: cube.table.lookup(rgb)? });
        Ok(())
    })
}

/// Looks up the materials of `count` colors.
///
/// `rgb` is `[count][3]`: red, green, blue of each color in turn, linear, in the cube's space; `materials`
/// is `[count]`, and must not overlap it. It allocates nothing. Colors outside the cube, or NaN, get
/// an empty material, all zeros, which functions refuse; `*outside`, unless `outside` is null, receives
/// the number of these colors.
///
/// # Safety
///
/// Pointers are null or point to a cube, to 3 times `count` values, to room for `count` materials and
/// to room for a number.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn upglow_look_up_many(
    cube: *const UpglowCube,
    rgb: *const f32,
    materials: *mut UpglowMaterial,
    count: usize,
    outside: *mut usize,
) -> UpglowStatus {
    guarded(|| {
        refuse_overlap(rgb, materials, count, "materials")?;
        let mut ignored = 0;
        let outside = if outside.is_null() { &raw mut ignored } else { outside };
        // SAFETY: the caller keeps this function's promise, and the arrays do not overlap.
        let (cube, rgb) =
            unsafe { (borrowed(cube, "cube")?, slice(rgb.cast::<[f32; 3]>(), count, "rgb")?) };
        // SAFETY: the same; a material may hold anything, as nothing of it is promised.
        let (materials, output) = unsafe {
            (slice_mut(materials, count, "materials")?, Output::new(outside, "outside")?)
        };
        let mut absent = 0;
        for (rgb, material) in rgb.iter().zip(materials) {
            match cube.table.lookup(*rgb) {
                Ok(blend) => material.fill(blend),
                Err(_) => {
                    *material = UpglowMaterial::EMPTY;
                    absent += 1;
                }
            }
        }
        output.write(absent);
        Ok(())
    })
}

impl UpglowMaterial {
    /// A material that every function refuses.
    const EMPTY: Self = Self { words: [MaybeUninit::new(0); 32] };

    fn fill(&mut self, blend: PackedMixture<'_>) {
        let filled: *mut Filled<'_> = std::ptr::from_mut(self).cast();
        // SAFETY: a material has room for `Filled`, and its alignment.
        unsafe { filled.write(Filled { mark: MARK, blend }) };
    }
}

/// Writes a result of `ask` for a material to `place`, which messages call `name`.
///
/// # Safety
///
/// Pointers are null or point to a material that was looked up and to room for the answer.
#[inline(always)]
pub(crate) unsafe fn answer<T>(
    material: *const UpglowMaterial,
    (place, name): (*mut T, &'static str),
    ask: impl FnOnce(&PackedMixture<'_>) -> T,
) -> UpglowStatus {
    guarded(|| {
        // SAFETY: the caller keeps this function's promise.
        let (material, output) = unsafe { (looked_up(material)?, Output::new(place, name)?) };
        output.write(ask(material));
        Ok(())
    })
}

/// [`answer`] for an `ask` with `N` values at `values`, which messages call `values_name`.
///
/// # Safety
///
/// Pointers are null or point to a material that was looked up, to `N` values and to room for the
/// answer, which may be where the values are.
#[inline(always)]
pub(crate) unsafe fn answer_to<const N: usize, T>(
    material: *const UpglowMaterial,
    (values, values_name): (*const f32, &'static str),
    (place, name): (*mut T, &'static str),
    ask: impl FnOnce(&PackedMixture<'_>, [f32; N]) -> T,
) -> UpglowStatus {
    guarded(|| {
        // SAFETY: the caller keeps this function's promise.
        let (material, values) = unsafe { (looked_up(material)?, array(values, values_name)?) };
        // SAFETY: the same.
        let output = unsafe { Output::new(place, name)? };
        output.write(ask(material, values));
        Ok(())
    })
}

/// Whether the material re-radiates any light at another wavelength.
///
/// # Safety
///
/// Pointers are null or point to a material that was looked up and to room for the answer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn upglow_is_fluorescent(
    material: *const UpglowMaterial,
    is_fluorescent: *mut bool,
) -> UpglowStatus {
    // SAFETY: the caller keeps this function's promise, which is the same.
    unsafe { answer(material, (is_fluorescent, "is_fluorescent"), |m| m.is_fluorescent()) }
}

/// Share of incident light at `lambda_nm` that is reflected at the same wavelength, 0 to 1; divided by
/// pi it is the elastic BRDF.
///
/// Any wavelength is allowed; those outside 0 to 10000 nm are clamped.
///
/// # Safety
///
/// Pointers are null or point to a material that was looked up and to room for the answer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn upglow_reflectance(
    material: *const UpglowMaterial,
    lambda_nm: f32,
    reflectance: *mut f32,
) -> UpglowStatus {
    // SAFETY: the caller keeps this function's promise, which is the same.
    unsafe { answer(material, (reflectance, "reflectance"), |m| m.reflectance(lambda_nm)) }
}

/// `upglow_reflectance` at 4 wavelengths (nm), faster than one at a time. Both arrays may be the same.
///
/// cbindgen:ptrs-as-arrays=[[lambda_nm; 4], [reflectance; 4]]
///
/// # Safety
///
/// Pointers are null or point to a material that was looked up and to 4 values each.
#[expect(clippy::doc_markdown, reason = "cbindgen reads its line as it is")]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn upglow_reflectance_4(
    material: *const UpglowMaterial,
    lambda_nm: *const f32,
    reflectance: *mut f32,
) -> UpglowStatus {
    // SAFETY: the caller keeps this function's promise, which is the same.
    unsafe {
        let place = (reflectance.cast::<[f32; 4]>(), "reflectance");
        answer_to(material, (lambda_nm, "lambda_nm"), place, |m, nm| m.reflectance4(nm))
    }
}

/// `upglow_reflectance` at 8 wavelengths (nm), faster than one at a time. Both arrays may be the same.
///
/// cbindgen:ptrs-as-arrays=[[lambda_nm; 8], [reflectance; 8]]
///
/// # Safety
///
/// Pointers are null or point to a material that was looked up and to 8 values each.
#[expect(clippy::doc_markdown, reason = "cbindgen reads its line as it is")]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn upglow_reflectance_8(
    material: *const UpglowMaterial,
    lambda_nm: *const f32,
    reflectance: *mut f32,
) -> UpglowStatus {
    // SAFETY: the caller keeps this function's promise, which is the same.
    unsafe {
        let place = (reflectance.cast::<[f32; 8]>(), "reflectance");
        answer_to(material, (lambda_nm, "lambda_nm"), place, |m, nm| m.reflectance8(nm))
    }
}

/// Energy re-radiated per nm at `out_nm`, per unit of energy incident at `in_nm`; 1/nm, 0 or more.
/// It does not include reflection at the same wavelength.
///
/// # Safety
///
/// Pointers are null or point to a material that was looked up and to room for the answer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn upglow_reradiation(
    material: *const UpglowMaterial,
    in_nm: f32,
    out_nm: f32,
    per_nm: *mut f32,
) -> UpglowStatus {
    // SAFETY: the caller keeps this function's promise, which is the same.
    unsafe { answer(material, (per_nm, "per_nm"), |m| m.reradiation_per_nm(in_nm, out_nm)) }
}

/// Share of incident light at `in_nm` that leaves at any wavelength, 0 to 1: reflectance plus the
/// integral of the re-radiation.
///
/// # Safety
///
/// Pointers are null or point to a material that was looked up and to room for the answer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn upglow_albedo(
    material: *const UpglowMaterial,
    in_nm: f32,
    albedo: *mut f32,
) -> UpglowStatus {
    // SAFETY: the caller keeps this function's promise, which is the same.
    unsafe { answer(material, (albedo, "albedo"), |m| m.albedo(in_nm)) }
}
