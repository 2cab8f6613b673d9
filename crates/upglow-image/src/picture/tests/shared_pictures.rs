//! Pictures of other programs, if the folder with them is available.

use std::path::{Path, PathBuf};

use upglow_color::RgbSpace;
use upglow_fit::Unwatched;

use super::super::encoding::Encoding;
use super::super::linear::LinearPicture;
use super::super::stated::Declared;
use crate::bake::BakeError;

/// Colors of all texels, and alpha, as linear light.
fn read(path: &Path, declared: &Declared) -> Result<(Vec<[f32; 3]>, Vec<f32>), String> {
    let mut picture = LinearPicture::open(path, declared).map_err(|error| error.to_string())?;
    let (mut rgb, mut alpha) = (Vec::new(), Vec::new());
    let all = picture.for_each_band(8, "reading", &Unwatched, |band| {
        rgb.extend(band.rgb);
        alpha.extend(band.alpha.unwrap_or_default());
        Ok::<_, BakeError>(())
    });
    all.map_err(|error| error.to_string())?;
    Ok((rgb, alpha))
}

#[test]
fn pictures_of_other_programs_have_their_right_values_or_are_refused_by_name() {
    let folder =
        PathBuf::from(concat!(env!("CARGO_MANIFEST_DIR"), "/../../../shared/data/pictures"));
    if !folder.is_dir() {
        eprintln!(
            "skipped: pictures_of_other_programs_have_their_right_values_or_are_refused_by_name \
             (no ../shared/data/pictures)"
        );
        return;
    }
    let srgb = Declared {
        space: RgbSpace::named("srgb").ok(),
        encoding: Some(Encoding::Srgb),
        ..Declared::default()
    };
    let own = Declared::default();
    let decoded = |v: f64| {
        let [v, ..] = Encoding::Srgb.to_linear([v; 3]);
        upglow_color::rounding::to_single(v)
    };
    // Half a unit of 8 bits of color, divided by an alpha of 64 or 128 of 255.
    let [rounded, exact] = [0.01, 1e-6];
    let half = decoded(128.0 / 255.0);
    let rgb = [0.6, 0.2, 0.1];
    let near_white = [100.0, 50.0, 150.0].map(|v| decoded(v / 255.0));
    type Value<'d> = (&'static str, &'d Declared, [f32; 3], Option<f32>, f32);
    let values: [Value<'_>; 9] = [
        ("assoc_alpha_white.tif", &srgb, [1.0; 3], Some(64.0 / 255.0), rounded),
        ("assoc_alpha_orange.tif", &srgb, [1.0, half, 0.0], Some(128.0 / 255.0), rounded),
        ("layers_with_normals.exr", &own, rgb, Some(1.0), exact),
        ("icc_srgb.png", &own, [half; 3], None, 1.0),
        ("gray_alpha.tif", &srgb, [half; 3], Some(128.0 / 255.0), exact),
        ("bits_1_wide_1.tif", &srgb, [1.0; 3], None, exact),
        ("tiled_lzw.tif", &srgb, [half; 3], None, exact),
        ("extra_sample_predictor.tif", &srgb, near_white, None, exact),
        (
            "two_layers.exr",
            &Declared { layer: Some("albedo".into()), ..own.clone() },
            rgb,
            None,
            1.0,
        ),
    ];
    for (file, declared, expected, expected_alpha, tolerance) in values {
        let (rgb, alpha) =
            read(&folder.join(file), declared).unwrap_or_else(|e| panic!("{file}: {e}"));
        let differs = |found: f32, expected: f32| (found - expected).abs() > tolerance;
        for found in rgb {
            let off = (0..3).any(|k| differs(found[k], expected[k]));
            assert!(!off, "{file}: {found:?}, expected {expected:?}");
        }
        assert_eq!(alpha.is_empty(), expected_alpha.is_none(), "{file}");
        for (found, expected) in alpha.into_iter().zip(expected_alpha) {
            assert!(!differs(found, expected), "{file}: alpha {found}");
        }
    }
    for (file, line) in [
        ("luma_chroma.exr", "channels BY, RY, Y: luminance and chroma, expected R, G and B"),
        ("normals_only.exr", "channels N.X, N.Y, N.Z, expected R, G and B"),
        ("two_layers.exr", "color layers albedo, diffuse, expected the name of one"),
        ("cicp_pq.png", "cICP states PQ, a curve of displays"),
        ("damaged_crc.png", "damaged: its data or a checksum is wrong, expected a whole PNG"),
    ] {
        for declared in [&own, &srgb] {
            let message = read(&folder.join(file), declared).unwrap_err();
            assert!(message.starts_with(line), "{file}: {message}");
        }
    }
    let [upright, lying] = ["orientation_1.tif", "orientation_6.tif"]
        .map(|file| read(&folder.join(file), &srgb).unwrap());
    // A quarter turn to the right: the lower left becomes the upper left.
    let turned = [2, 0, 3, 1].map(|i| upright.0[i]);
    assert_eq!(lying.0, turned);
    let tagged = folder.join("wrong_tag.exr");
    for space in [None, Some(RgbSpace::default())] {
        let picture =
            LinearPicture::open(&tagged, &Declared { space: space.clone(), ..own.clone() });
        let by = &picture.unwrap().interpretation().space.clone();
        let (used, overruled) = match space {
            Some(_) => ("acescg", Some("srgb (chromaticities)".to_owned())),
            None => ("srgb", None),
        };
        assert_eq!((by.used.as_str(), &by.overruled), (used, &overruled));
    }
}
