//! Cubes, which are loaded once and shared by all threads.

use std::ffi::{CStr, CString, OsStr, c_char};
use std::path::Path;

use upglow::{Cube, LookupTable};

use crate::failure::{Failure, UpglowStatus, guarded};
use crate::pointer::{Output, assert_shared_by_threads, borrowed, destroy, slice, text};

/// A cube of materials for all colors of an RGB space. It is immutable: any number of threads may
/// use it at once.
#[derive(Debug)]
pub struct UpglowCube {
    pub(crate) cube: Cube,
    pub(crate) table: LookupTable,
    /// The texts of [`UpglowCubeFacts`], in its order.
    texts: [CString; 6],
}

/// Properties of a cube. The texts are UTF-8, and valid until the cube is destroyed.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct UpglowCubeFacts {
    /// Nodes along each axis, 2 to 256.
    pub resolution: u32,
    /// Whether any of its materials fluoresces.
    pub fluoresces: bool,
    /// Name of the RGB space, whose components are linear.
    pub rgb_space: *const c_char,
    /// CIE 1931 2 degree x and y of the space's red, green and blue.
    pub primaries: [[f64; 2]; 3],
    /// CIE 1931 2 degree x and y of the space's white.
    pub white: [f64; 2],
    /// Name of the light that RGB is seen under, such as "D65".
    pub illuminant: *const c_char,
    /// Name of the observer.
    pub observer: *const c_char,
    /// Chromatic adaptation from the space's white to the light's: "bradford" or "none".
    pub adaptation: *const c_char,
    /// Model of fluorescence: "dyes", "film", "analytic", or "reflectance" for none.
    pub model: *const c_char,
    /// The file's header, in JSON.
    pub header_json: *const c_char,
}

const _: () = assert_shared_by_threads::<UpglowCube>();

impl UpglowCube {
    fn new(cube: Cube) -> Box<Self> {
        let contract = cube.contract();
        let texts = [
            contract.space.name(),
            contract.illuminant.name(),
            contract.observer.name(),
            &contract.adaptation.to_string(),
            cube.model().name(),
            &cube.header_json(),
        ];
        Box::new(Self { table: cube.lookup_table(), texts: texts.map(c_text), cube })
    }

    fn facts(&self) -> UpglowCubeFacts {
        let space = &self.cube.contract().space;
        let texts = self.texts.each_ref().map(|text| text.as_ptr());
        let [rgb_space, illuminant, observer, adaptation, model, header_json] = texts;
        UpglowCubeFacts {
            resolution: u32::try_from(self.cube.resolution()).expect("at most 256"),
            fluoresces: (0..self.cube.nodes().len())
                .any(|node| self.cube.node_material(node).fluorescence.dose() > 0.0),
            rgb_space,
            primaries: space.primaries(),
            white: space.white(),
            illuminant,
            observer,
            adaptation,
            model,
            header_json,
        }
    }
}

/// The text up to its first zero byte, which ends a text in C.
fn c_text(text: &str) -> CString {
    let visible = text.split('\0').next().unwrap_or_default();
    CString::new(visible).expect("cut before the first zero byte")
}

/// Loads the cube in a file.
///
/// `path` is UTF-8, or on Unix any bytes, and ends with a zero byte. `*cube` receives a cube that
/// the caller owns and must destroy with `upglow_cube_destroy`. All memory for look-ups and
/// evaluations is allocated here.
///
/// Fails with `UPGLOW_STATUS_FILE` if the file cannot be read, and with `UPGLOW_STATUS_NOT_A_CUBE`
/// if it is incomplete, not a cube or of an unknown version. The message names the file.
///
/// # Safety
///
/// Pointers are null or point to what is described above.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn upglow_cube_open(
    path: *const c_char,
    cube: *mut *mut UpglowCube,
) -> UpglowStatus {
    guarded(|| {
        // SAFETY: the caller keeps this function's promise.
        let (path, output) = unsafe { (text(path, "path")?, Output::new(cube, "cube")?) };
        let cube = Cube::read(file_path(path)?)?;
        output.write(Box::into_raw(UpglowCube::new(cube)));
        Ok(())
    })
}

#[cfg(unix)]
fn file_path(path: &CStr) -> Result<&Path, Failure> {
    use std::os::unix::ffi::OsStrExt;
    Ok(Path::new(OsStr::from_bytes(path.to_bytes())))
}

#[cfg(not(unix))]
fn file_path(path: &CStr) -> Result<&Path, Failure> {
    let path = path.to_str().map_err(|_| Failure::NotText { argument: "path" })?;
    Ok(Path::new(OsStr::new(path)))
}

/// Loads a cube from the content of its file: `length` bytes, which are copied and may be freed
/// afterwards.
///
/// For the rest, see `upglow_cube_open`.
///
/// # Safety
///
/// Pointers are null or point to what is described above.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn upglow_cube_from_memory(
    bytes: *const u8,
    length: usize,
    cube: *mut *mut UpglowCube,
) -> UpglowStatus {
    guarded(|| {
        // SAFETY: the caller keeps this function's promise.
        let (bytes, output) =
            unsafe { (slice(bytes, length, "bytes")?, Output::new(cube, "cube")?) };
        output.write(Box::into_raw(UpglowCube::new(Cube::from_bytes(bytes)?)));
        Ok(())
    })
}

/// Frees a cube; null is allowed and does nothing.
///
/// Materials that were looked up in it must not be used afterwards. No other thread may be using it.
///
/// # Safety
///
/// `cube` is null or came from `upglow_cube_open` or `upglow_cube_from_memory`, and was not
/// destroyed before.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn upglow_cube_destroy(cube: *mut UpglowCube) {
    // SAFETY: the caller keeps this function's promise, which is the same.
    unsafe { destroy(cube) };
}

/// Writes the properties of a cube. The texts are valid until the cube is destroyed.
///
/// # Safety
///
/// Pointers are null or point to a cube and to room for the facts.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn upglow_cube_facts(
    cube: *const UpglowCube,
    facts: *mut UpglowCubeFacts,
) -> UpglowStatus {
    guarded(|| {
        // SAFETY: the caller keeps this function's promise.
        let (cube, output) = unsafe { (borrowed(cube, "cube")?, Output::new(facts, "facts")?) };
        output.write(cube.facts());
        Ok(())
    })
}
