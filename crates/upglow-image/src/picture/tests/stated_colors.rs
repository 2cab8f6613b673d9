//! What files state of their colors is used in the standards' order, and never guessed.

use std::fs::File;
use std::io::Write as _;
use std::path::Path;

use tiff::encoder::{Rational, TiffEncoder, colortype};
use tiff::tags::Tag;
use upglow_color::RgbSpace;

use super::super::Picture;
use super::super::encoding::Encoding;
use super::super::linear::LinearPicture;
use super::super::stated::Declared;
use super::tiff_file::TiffFile;
use crate::exr::attribute::{Attribute, Attributes, chromaticities};
use crate::exr::header::{Arrangement, Channel, Sample, Window, print};
use crate::exr::writer::{ExrDescription, ExrWriter};

fn rgb_space(name: &str) -> RgbSpace {
    RgbSpace::named(name).unwrap()
}

/// The space, who states it, the encoding, who states it.
type Found = [String; 4];

fn found(path: &Path, declared: &Declared) -> Result<Found, String> {
    let picture = Picture::open_as(path, declared).map_err(|error| error.to_string())?;
    let chosen = picture.chosen(declared).map_err(|error| error.to_string())?;
    let used = chosen.interpretation;
    Ok([used.space.used, used.space.by, used.encoding.used, used.encoding.by])
}

fn undeclared(path: &Path) -> Result<Found, String> {
    found(path, &Declared::default())
}

fn texts(found: [&str; 4]) -> Result<Found, String> {
    Ok(found.map(Into::into))
}

fn write_exr(path: &Path, channels: &[(&str, f32)], attributes: Attributes) {
    let names = channels.iter().map(|(name, _)| *name);
    let description =
        ExrDescription { attributes, sample: Sample::Float, ..ExrDescription::new([2, 2], names) };
    let mut writer = ExrWriter::create(path, description).unwrap();
    let planes: Vec<Vec<f32>> = channels.iter().map(|(_, v)| vec![*v; 4]).collect();
    writer.write_band(&planes.iter().map(Vec::as_slice).collect::<Vec<_>>()).unwrap();
    writer.finish().unwrap();
}

const RGB: [(&str, f32); 3] = [("R", 0.6), ("G", 0.2), ("B", 0.1)];

#[test]
fn the_container_flag_is_before_the_interop_id_and_that_before_chromaticities() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.exr");
    let flag = ("acesImageContainerFlag".to_owned(), Attribute::new("int", vec![1, 0, 0, 0]));
    let id = |id: &str| ("colorInteropID".to_owned(), Attribute::from(id));
    let primaries = ("chromaticities".to_owned(), chromaticities(&rgb_space("rec2020")));
    let of = |attributes: Vec<(String, Attribute)>| {
        write_exr(&path, &RGB, attributes.into_iter().collect());
        undeclared(&path)
    };
    let flagged = of(vec![flag, id("lin_ap1_scene"), primaries.clone()]);
    let by = "acesImageContainerFlag";
    assert_eq!(flagged, texts(["aces2065-1", by, "linear", by]));
    let by = "colorInteropID";
    let named = of(vec![id("g22_ap1_scene"), primaries.clone()]);
    assert_eq!(named, texts(["acescg", by, "2.2", by]));
    let plain = of(vec![primaries.clone()]);
    assert_eq!(plain, texts(["rec2020", "chromaticities", "linear", "OpenEXR"]));
    for unread in ["unknown", "studio:lin_ap1_scene", "data"] {
        let message = of(vec![id(unread), primaries.clone()]).unwrap_err();
        assert!(message.contains("colorInteropID") && message.contains(unread), "{message}");
    }
    assert!(of(Vec::new()).unwrap_err().contains("its RGB space"));
    write_exr(&path, &RGB, [primaries].into());
    let declared = Declared { space: Some(RgbSpace::default()), ..Declared::default() };
    let chosen = Picture::open(&path).unwrap().chosen(&declared).unwrap();
    let told = chosen.interpretation.space.to_string();
    assert_eq!(told, "acescg (declared; the file states rec2020 (chromaticities))");
}

#[test]
fn channels_that_are_no_colors_are_no_picture() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.exr");
    let of = |names: &[&str], layer: Option<&str>| {
        let channels: Vec<(&str, f32)> = names.iter().map(|name| (*name, 0.5)).collect();
        write_exr(&path, &channels, Attributes::new());
        let declared = Declared { layer: layer.map(Into::into), ..Declared::default() };
        Picture::open_as(&path, &declared).map(|_| ()).map_err(|error| error.to_string())
    };
    for names in [
        &["N.X", "N.Y", "N.Z"][..],
        &["X", "Y", "Z"],
        &["motion.X", "motion.Y"],
        &["BY", "RY", "Y"],
        &["Z"],
        &["A"],
        &["R", "G"],
    ] {
        let message = of(names, None).unwrap_err();
        assert!(message.starts_with("channels ") && message.contains(names[0]), "{message}");
    }
    assert!(of(&["BY", "RY", "Y"], None).unwrap_err().contains("luminance and chroma"));
    for names in [
        &["Y"][..],
        &["A", "Y"],
        &["B", "G", "R", "X", "Y", "Z"],
        &["v.Combined.B", "v.Combined.G", "v.Combined.R", "v.N.X", "v.N.Y", "v.N.Z", "v.Depth.Z"],
    ] {
        assert_eq!(of(names, None), Ok(()), "{names:?}");
    }
    let two = ["a.B", "a.G", "a.R", "b.B", "b.G", "b.R"];
    let message = of(&two, None).unwrap_err();
    assert_eq!(message, "color layers a, b, expected the name of one to be given");
    assert_eq!(of(&two, Some("b")), Ok(()));
    let message = of(&two, Some("c")).unwrap_err();
    assert!(message.ends_with("expected one of the layers a, b"), "{message}");
}

/// A PNG of one pixel with these chunks before its data.
fn write_png(path: &Path, chunks: &[(&[u8; 4], Vec<u8>)]) {
    let mut encoder = png::Encoder::new(File::create(path).unwrap(), 1, 1);
    encoder.set_color(png::ColorType::Rgb);
    let mut writer = encoder.write_header().unwrap();
    for (name, data) in chunks {
        writer.write_chunk(png::chunk::ChunkType(**name), data).unwrap();
    }
    writer.write_image_data(&[128, 64, 32]).unwrap();
}

/// The chunk of an ICC profile.
fn iccp(profile: &[u8]) -> Vec<u8> {
    let mut data = b"profile\0\0".to_vec();
    data.extend(miniz_oxide::deflate::compress_to_vec_zlib(profile, 6));
    data
}

fn gamma(value: u32) -> Vec<u8> {
    value.to_be_bytes().to_vec()
}

/// A profile of an RGB space: a D50 matrix, and one curve for all channels.
fn icc_profile(space: &RgbSpace, curve: &[u8], further: &[(&[u8; 4], Vec<u8>)]) -> Vec<u8> {
    use upglow_color::{Adaptation, Xyz};
    let fixed = |v: f64| {
        // The nearest multiple of 1/65536, as profiles store numbers.
        let scaled = (v * 65536.0).round();
        format!("{scaled}").parse::<i32>().unwrap().to_be_bytes()
    };
    let white = Xyz::from_chromaticity(space.white());
    let adapted = Adaptation::Bradford.target_from_source(white, Xyz([0.9642, 1.0, 0.8249]));
    let columns = (adapted * space.xyz_from_rgb()).0;
    let xyz = |values: [f64; 3]| {
        let mut tag = b"XYZ \0\0\0\0".to_vec();
        values.iter().for_each(|v| tag.extend(fixed(*v)));
        tag
    };
    let column = |k: usize| xyz([0, 1, 2].map(|row| columns[row][k]));
    let mut tags: Vec<(&[u8; 4], Vec<u8>)> = vec![
        (b"rXYZ", column(0)),
        (b"gXYZ", column(1)),
        (b"bXYZ", column(2)),
        (b"wtpt", xyz(white.0)),
    ];
    for name in [b"rTRC", b"gTRC", b"bTRC"] {
        tags.push((name, curve.to_vec()));
    }
    for (name, value) in further {
        tags.retain(|tag| tag.0 != *name);
        tags.push((name, value.clone()));
    }
    let mut profile = vec![0; 128];
    profile[16..20].copy_from_slice(b"RGB ");
    profile[20..24].copy_from_slice(b"XYZ ");
    profile[36..40].copy_from_slice(b"acsp");
    let word = |n: usize| u32::try_from(n).unwrap().to_be_bytes();
    profile.extend(word(tags.len()));
    let mut at = 132 + 12 * tags.len();
    for (name, value) in &tags {
        profile.write_all(&[&name[..], &word(at), &word(value.len())].concat()).unwrap();
        at += value.len();
    }
    tags.iter().for_each(|(_, value)| profile.extend(value));
    profile
}

fn power(gamma: u16) -> Vec<u8> {
    [b"curv\0\0\0\0\0\0\0\x01", &gamma.to_be_bytes()[..]].concat()
}

/// A curve of 1024 numbers.
fn table(encoding: Encoding) -> Vec<u8> {
    let mut curve = b"curv\0\0\0\0\0\0\x04\0".to_vec();
    for i in 0..1024 {
        let linear = encoding.to_linear([f64::from(i) / 1023.0; 3])[0];
        let word = format!("{}", (linear * 65535.0).round()).parse::<u16>().unwrap();
        curve.extend(word.to_be_bytes());
    }
    curve
}

#[test]
fn the_chunks_of_a_png_count_in_the_order_of_the_standard() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.png");
    let of = |chunks: &[(&[u8; 4], Vec<u8>)]| {
        write_png(&path, chunks);
        undeclared(&path)
    };
    let cicp: (&[u8; 4], _) = (b"cICP", vec![9, 8, 0, 1]);
    let profile = icc_profile(&rgb_space("adobe-rgb"), &power(563), &[]);
    let icc: (&[u8; 4], _) = (b"iCCP", iccp(&profile));
    let srgb: (&[u8; 4], _) = (b"sRGB", vec![0]);
    let gama: (&[u8; 4], _) = (b"gAMA", gamma(100_000));
    let all = [cicp, icc, srgb, gama];
    assert_eq!(of(&all), texts(["rec2020", "cICP", "linear", "cICP"]));
    let exponent = (563.0_f64 / 256.0).to_string();
    let icc = texts(["adobe-rgb", "ICC profile", &exponent, "ICC profile"]);
    assert_eq!(of(&all[1..3]), icc);
    assert_eq!(of(&all[2..]), texts(["srgb", "sRGB", "srgb", "sRGB"]));
    let message = of(&all[3..]).unwrap_err();
    assert!(message.contains("its RGB space,"), "{message}");
    let message = of(&[]).unwrap_err();
    assert_eq!(
        message,
        "the file does not state its RGB space and encoding, expected a declaration"
    );
}

#[test]
fn code_points_are_read_or_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.png");
    let declared = Declared {
        space: Some(rgb_space("srgb")),
        encoding: Some(Encoding::Srgb),
        ..Declared::default()
    };
    let of = |points: [u8; 4], declared: &Declared| {
        write_png(&path, &[(b"cICP", points.to_vec())]);
        found(&path, declared)
    };
    let plain = Declared::default();
    for (primaries, space) in [(1, "srgb"), (9, "rec2020"), (12, "p3-d65")] {
        for (transfer, encoding) in
            [(1, "bt709"), (6, "bt709"), (14, "bt709"), (15, "bt709"), (8, "linear"), (13, "srgb")]
        {
            let read = of([primaries, transfer, 0, 1], &plain);
            assert_eq!(read, texts([space, "cICP", encoding, "cICP"]));
        }
    }
    for (transfer, name) in [(16, "PQ"), (18, "HLG")] {
        for declared in [&plain, &declared] {
            let message = of([9, transfer, 0, 1], declared).unwrap_err();
            assert!(message.starts_with(&format!("cICP states {name}, ")), "{message}");
        }
    }
    assert!(of([22, 13, 0, 1], &plain).unwrap_err().starts_with("cICP with primaries 22, which"));
    assert!(of([1, 10, 0, 1], &plain).unwrap_err().starts_with("cICP with transfer 10, which"));
    assert!(of([1, 10, 0, 1], &declared).is_ok());
    let message = of([1, 13, 0, 0], &plain).unwrap_err();
    assert!(message.starts_with("cICP with matrix 0 and narrow range, expected"), "{message}");
}

#[test]
fn profiles_of_a_matrix_and_a_curve_are_read_and_others_refused_by_name() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.tif");
    let of = |profile: Vec<u8>| {
        let file = TiffFile { further: vec![(34675, profile)], ..TiffFile::default() };
        std::fs::write(&path, file.bytes()).unwrap();
        undeclared(&path)
    };
    let by = "ICC profile";
    for name in RgbSpace::names() {
        let read = of(icc_profile(&rgb_space(name), &table(Encoding::Srgb), &[]));
        assert_eq!(read, texts([name, by, "srgb", by]));
    }
    let srgb = rgb_space("srgb");
    let linear = b"curv\0\0\0\0\0\0\0\0".to_vec();
    assert_eq!(of(icc_profile(&srgb, &linear, &[])), texts(["srgb", by, "linear", by]));
    for encoding in [Encoding::Bt709, Encoding::Linear] {
        let read = of(icc_profile(&srgb, &table(encoding), &[]));
        assert_eq!(read, texts(["srgb", by, &encoding.to_string(), by]));
    }
    assert_eq!(of(icc_profile(&srgb, &power(0x1cd), &[])), texts(["srgb", by, "1.80078125", by]));
    // A space of its own, whose white is not D50: its primaries come back.
    let (red, green, blue) = ([0.67, 0.32], [0.24, 0.69], [0.14, 0.05]);
    let own = RgbSpace::custom("own", [red, green, blue], [0.3, 0.31]).unwrap();
    let profile = icc_profile(&own, &linear, &[]);
    let file = TiffFile { further: vec![(34675, profile)], ..TiffFile::default() };
    std::fs::write(&path, file.bytes()).unwrap();
    let read = Picture::open(&path).unwrap();
    let back = read.space().unwrap();
    for (found, expected) in back.primaries().iter().zip([red, green, blue]) {
        for k in 0..2 {
            // Sixteen binary digits of X, Y and Z, of which the least sum is 0.4.
            assert!((found[k] - expected[k]).abs() < 2e-4, "{found:?} {expected:?}");
        }
    }
    type Tag = (&'static [u8; 4], Vec<u8>);
    let refused: [(&[Tag], &str); 4] = [
        (&[(b"A2B0", vec![0; 8])], "an ICC profile with a table (A2B0), which"),
        (&[(b"gTRC", power(0x100))], "an ICC profile with different curves"),
        (&[(b"rTRC", b"none".to_vec())], "an ICC profile without usable curves"),
        (&[(b"rXYZ", b"none".to_vec())], "an ICC profile without usable colorants"),
    ];
    for (tags, line) in refused {
        let message = of(icc_profile(&srgb, &power(0x233), tags)).unwrap_err();
        assert!(message.starts_with(line), "{message}");
    }
    let pq = icc_profile(&srgb, &linear, &[(b"cicp", b"cicp\0\0\0\0\x09\x10\0\x01".to_vec())]);
    let message = of(pq).unwrap_err();
    assert!(message.starts_with("ICC profile states PQ"), "{message}");
    let mut cmyk = icc_profile(&srgb, &linear, &[]);
    cmyk[16..20].copy_from_slice(b"CMYK");
    assert!(of(cmyk).unwrap_err().starts_with("an ICC profile of CMYK colors, which"));
    let whole = icc_profile(&srgb, &linear, &[]);
    for length in 0..whole.len() {
        // No length panics; those with all tags are read.
        let _ = of(whole[..length].to_vec());
    }
    assert!(of(whole[..140].to_vec()).unwrap_err().starts_with("a damaged ICC profile, which"));
}

#[test]
fn colors_are_divided_by_alpha_before_they_are_decoded_and_kept_where_it_is_zero() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.png");
    let mut encoder = png::Encoder::new(File::create(&path).unwrap(), 2, 1);
    encoder.set_color(png::ColorType::Rgba);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    let mut writer = encoder.write_header().unwrap();
    writer.write_image_data(&[128, 64, 0, 128, 255, 0, 128, 0]).unwrap();
    writer.finish().unwrap();
    let first_band = |alpha: &str| -> Result<_, crate::bake::BakeError> {
        let declared = Declared { alpha: alpha.parse().ok(), ..Declared::default() };
        let mut colors = Vec::new();
        let mut picture = LinearPicture::open(&path, &declared)?;
        picture.for_each_band(1, "reading", &upglow_fit::Unwatched, |band| {
            colors.push((band.rgb, band.alpha));
            Ok::<_, crate::bake::BakeError>(())
        })?;
        Ok(colors.remove(0))
    };
    let decoded = |v: f64| Encoding::Srgb.to_linear([v; 3])[0];
    let near = |found: f32, expected: f64| {
        // Rounding to single precision.
        assert!((f64::from(found) - expected).abs() < 1e-6, "{found} {expected}");
    };
    let (rgb, alpha) = first_band("associated").unwrap();
    near(rgb[0][0], 1.0);
    near(rgb[0][1], decoded(0.5));
    near(rgb[1][0], 1.0);
    near(rgb[1][2], decoded(128.0 / 255.0));
    assert_eq!(alpha.unwrap()[1], 0.0);
    for word in ["straight", "none"] {
        let (rgb, alpha) = first_band(word).unwrap();
        near(rgb[0][0], decoded(128.0 / 255.0));
        assert_eq!(alpha.is_some(), word == "straight");
    }
}

/// Chromaticities of no RGB space, and why they are none.
fn no_spaces() -> Vec<([f32; 8], &'static str)> {
    let good = [0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.3127, 0.329];
    let mut found = vec![
        ([0.3; 8], "the three primaries lie on one line, expected a triangle"),
        ([0.0; 8], "expected numbers from -10 to 10, and a y of at least 0.001"),
        ([0.1, 0.1, 0.2, 0.2, 0.3, 0.3, 0.3, 0.3], "the three primaries lie on one line"),
        ([0.64, 0.33, 0.3, 0.6, 0.15, 0.06, 0.7, 0.7], "outside the triangle of the primaries"),
    ];
    for place in 0..8 {
        for value in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX, 10.5] {
            let mut wrong = good;
            wrong[place] = value;
            found.push((wrong, "expected numbers from -10 to 10"));
        }
    }
    found
}

/// What is told of a file, and that a declared space is used instead.
fn told(path: &Path, by: &str) -> String {
    let declared = Declared { space: Some(rgb_space("srgb")), ..Declared::default() };
    let both = Declared { encoding: Some(Encoding::Linear), ..declared.clone() };
    let chosen = Picture::open(path).unwrap().chosen(&both).unwrap();
    let line = format!("srgb (declared; the file states invalid {by})");
    assert_eq!(chosen.interpretation.space.to_string(), line);
    let error = Picture::open(path).unwrap().chosen(&Declared::default()).unwrap_err();
    let cause = std::error::Error::source(&error).map(ToString::to_string);
    format!("{error}: {}", cause.unwrap_or_default())
}

#[test]
fn chromaticities_of_no_space_are_told_as_such_in_every_format() {
    let folder = tempfile::tempdir().unwrap();
    let path = |suffix: &str| folder.path().join(format!("x.{suffix}"));
    for (found, why) in no_spaces() {
        let text = found.map(|v| format!("{v:?}")).join(",");
        let attribute = Attribute::singles("chromaticities", &found);
        write_exr(&path("exr"), &RGB, [("chromaticities".into(), attribute)].into());
        let message = told(&path("exr"), "chromaticities");
        assert!(message.starts_with(&format!("chromaticities {text}: ")), "{message}");
        assert!(message.contains(why) && message.len() < 300, "{message}");

        let lines = format!("PRIMARIES={}\n", found.map(|v| v.to_string()).join(" "));
        let file =
            format!("#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n{lines}\n-Y 1 +X 1\n\u{1}\u{1}\u{1}\u{1}");
        std::fs::write(path("hdr"), file).unwrap();
        let message = told(&path("hdr"), "PRIMARIES");
        assert!(message.starts_with(&format!("PRIMARIES {text}: ")), "{message}");
        assert!(message.contains(why), "{message}");

        // PNG and TIFF have no negative numbers, and PNG only finite ones.
        let is_positive = found.iter().all(|v| *v >= 0.0 && *v < 40_000.0);
        let scaled = found.map(|v| format!("{}", (f64::from(v) * 1e5).round()).parse::<u32>());
        if let (true, [rx, ry, gx, gy, bx, by, wx, wy]) = (is_positive, scaled) {
            let order = [wx, wy, rx, ry, gx, gy, bx, by].map(|v| v.unwrap().to_be_bytes());
            write_png(&path("png"), &[(b"cHRM", order.as_flattened().to_vec())]);
            let message = told(&path("png"), "cHRM");
            assert!(message.starts_with("cHRM ") && message.contains(why), "{message}");
        }
        let ratio = |v: f32| match v {
            v if v.is_nan() => (0, 0),
            v if v.is_infinite() || v > 40_000.0 => (1, 0),
            v => (format!("{}", (f64::from(v) * 1e4).round()).parse::<u32>().unwrap(), 10_000),
        };
        if !found.iter().any(|v| *v < 0.0) {
            let mut encoder = TiffEncoder::new(File::create(path("tif")).unwrap()).unwrap();
            let mut image = encoder.new_image::<colortype::RGB8>(1, 1).unwrap();
            let ratios: Vec<Rational> =
                found.iter().map(|v| ratio(*v)).map(|(n, d)| Rational { n, d }).collect();
            image.encoder().write_tag(Tag::Unknown(319), &ratios[..6]).unwrap();
            image.encoder().write_tag(Tag::Unknown(318), &ratios[6..]).unwrap();
            image.write_data(&[1, 2, 3]).unwrap();
            let message = told(&path("tif"), "primaries and white");
            assert!(
                message.starts_with("primaries and white ") && message.contains(why),
                "{message}"
            );
        }
    }
    let text = [("chromaticities".into(), Attribute::from("0.3"))];
    write_exr(&path("exr"), &RGB, text.into());
    let message = undeclared(&path("exr")).unwrap_err();
    assert!(message.starts_with("chromaticities of the type string, which"), "{message}");
}

#[test]
fn gammas_of_no_picture_are_told_as_such() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.png");
    let declared = Declared { encoding: Some(Encoding::Srgb), ..Declared::default() };
    for value in
        (0..32).flat_map(|bit| [1_u32 << bit, (1 << bit) + 45_455]).chain([10_000, 1_000_000])
    {
        write_png(&path, &[(b"cHRM", chrm()), (b"gAMA", gamma(value))]);
        let number = 1e5 / f64::from(value);
        let found = undeclared(&path);
        if (0.1..=10.0).contains(&number) {
            assert_eq!(found, texts(["srgb", "cHRM", &number.to_string(), "gAMA"]));
        } else {
            let line = format!("gAMA states a gamma of {number}, expected 0.1 to 10");
            assert_eq!(found, Err(line));
            let chosen = Picture::open(&path).unwrap().chosen(&declared).unwrap();
            let used = chosen.interpretation.encoding.to_string();
            assert_eq!(used, "srgb (declared; the file states invalid gAMA)");
        }
    }
    let path = folder.path().join("x.tif");
    for power_256 in [1, 25, 26, 512, 2560, 2561, 0xffff] {
        let profile = icc_profile(&rgb_space("srgb"), &power(power_256), &[]);
        let file = TiffFile { further: vec![(34675, profile)], ..TiffFile::default() };
        std::fs::write(&path, file.bytes()).unwrap();
        let number = f64::from(power_256) / 256.0;
        match undeclared(&path) {
            Ok(found) => assert!((0.1..=10.0).contains(&number), "{found:?}"),
            Err(message) => {
                let line =
                    format!("an ICC profile with a gamma of {number}, outside 0.1 to 10, which");
                assert!(message.starts_with(&line), "{message}");
            }
        }
    }
}

/// The chromaticities of sRGB.
fn chrm() -> Vec<u8> {
    [31_270_u32, 32_900, 64_000, 33_000, 30_000, 60_000, 15_000, 6_000]
        .map(u32::to_be_bytes)
        .concat()
}

#[test]
fn colors_that_are_integers_are_told_as_such() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.exr");
    let of = |prefix: &str, names: &[&str], integers: usize, layer: Option<&str>| {
        let channel = |(i, name): (usize, &&str)| Channel {
            name: format!("{prefix}{name}"),
            sample: if integers >> i & 1 == 1 { Sample::Uint } else { Sample::Half },
            is_linear: false,
        };
        let channels: Vec<Channel> = names.iter().enumerate().map(channel).collect();
        let windows = [Window::of_size([1, 1]); 2];
        let rows = Arrangement::Rows;
        let method = exr::compression::Compression::Uncompressed;
        std::fs::write(&path, print(&channels, method, windows, rows, &Attributes::new())).unwrap();
        let declared = Declared { layer: layer.map(Into::into), ..Declared::default() };
        Picture::open_as(&path, &declared).unwrap_err().to_string()
    };
    for (prefix, layer) in [("", None), ("wall.", None), ("wall.", Some("wall"))] {
        for names in [&["B", "G", "R"][..], &["Y"], &["A", "B", "G", "R"], &["A", "Y"]] {
            for integers in 1..1 << names.len() {
                let of_colors = names
                    .iter()
                    .enumerate()
                    .filter(|(i, name)| integers >> i & 1 == 1 && **name != "A");
                let listed: Vec<String> =
                    of_colors.map(|(_, name)| format!("{prefix}{name}")).collect();
                let message = of(prefix, names, integers, layer);
                if !listed.is_empty() {
                    let listed = listed.join(", ");
                    let line = format!(
                        "channels {listed} of 32-bit integers, expected half or float: save the picture as one of these"
                    );
                    assert_eq!(message, line);
                }
            }
        }
    }
}
