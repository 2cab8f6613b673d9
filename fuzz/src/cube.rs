//! Cubes from strangers: refused, or materials that obey the laws of energy.

use std::collections::BTreeMap;

use safetensors::SafeTensors;
use sha2::{Digest as _, Sha256};
use upglow::{Bispectral as _, Cube, Interpolation};
use upglow_color::rounding::to_single;
use upglow_color::{Choice as _, LinearRgb};

/// Energy beyond 1 that rounding may add, in double and in single precision.
const ROUNDING: [f64; 2] = [1e-9, 1e-4];

/// A cube's file, whose checksum is made right first.
pub(crate) fn cube(bytes: &[u8]) {
    let mended = mended(bytes);
    let cube = match Cube::from_bytes(mended.as_deref().unwrap_or(bytes)) {
        Ok(cube) => cube,
        Err(error) => return crate::check_message(&error),
    };
    let again = Cube::from_bytes(&cube.to_bytes()).expect("what was read can be written and read");
    assert_eq!(again.to_bytes(), cube.to_bytes(), "a cube that is read back differs");
    check_answers(&cube);
}

/// Questions to a cube, whose answers obey the laws.
pub(crate) fn check_answers(cube: &Cube) {
    const COLORS: [[f64; 3]; 5] =
        [[0.0; 3], [1.0; 3], [1.0, 0.0, 0.3], [0.2, 0.9, 0.1], [0.01, 0.02, 0.98]];
    const WAVELENGTHS_NM: [f64; 6] = [300.0, 377.5, 450.0, 555.0, 601.25, 830.0];
    let packed = cube.lookup_table();
    for rgb in COLORS {
        for &interpolation in Interpolation::ALL {
            let mixture = cube.lookup(LinearRgb(rgb), interpolation).expect("inside");
            for nm in WAVELENGTHS_NM {
                check_share(mixture.reflectance(nm), ROUNDING[0]);
                if interpolation == Interpolation::Blend {
                    check_share(mixture.albedo(nm), ROUNDING[0]);
                }
                let moved = mixture.reradiation_per_nm(nm, 560.0);
                assert!(moved.is_finite() && moved >= 0.0, "re-radiation {moved} at {nm} nm");
            }
        }
        let mixture = packed.lookup(rgb.map(to_single)).expect("inside");
        for nm in WAVELENGTHS_NM.map(to_single) {
            check_share(mixture.reflectance(nm).into(), ROUNDING[1]);
            check_share(mixture.albedo(nm).into(), ROUNDING[1]);
        }
    }
}

fn check_share(found: f64, rounding: f64) {
    assert!((0.0..=1.0 + rounding).contains(&found), "a share of {found}");
}

/// The file with the checksum of what it holds, as `docs/cube-format.md` defines it; `None` if it is no container.
fn mended(bytes: &[u8]) -> Option<Vec<u8>> {
    let (_, metadata) = SafeTensors::read_metadata(bytes).ok()?;
    let header = metadata.metadata().as_ref()?.get("upglow")?.clone();
    let file = SafeTensors::deserialize(bytes).ok()?;
    let tensors: BTreeMap<String, _> = file.tensors().into_iter().collect();
    let mut hash = Sha256::new_with_prefix(&header);
    for (name, tensor) in tensors.iter().filter(|(name, _)| *name != "sha256") {
        let shape: Vec<String> = tensor.shape().iter().map(usize::to_string).collect();
        hash.update(format!("\n{name} {} {}\n", tensor.dtype(), shape.join(",")));
        hash.update(tensor.data());
    }
    let stored = tensors.get("sha256")?.data();
    let at = stored.as_ptr().addr() - bytes.as_ptr().addr();
    let mut mended = bytes.to_vec();
    mended.get_mut(at..at + stored.len())?.copy_from_slice(hash.finalize().get(..stored.len())?);
    Some(mended)
}
