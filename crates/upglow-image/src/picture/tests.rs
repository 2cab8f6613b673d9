//! TIFF and PNG pictures read as they were written.

use std::fs::File;
use std::path::Path;

use tiff::encoder::{TiffEncoder, colortype};
use tiff::tags::Tag;

use super::Picture;
use super::band::Band;
use super::encoding::Encoding;
use super::source::Alpha;
use super::stated::{Declared, DeclaredAlpha};

mod hdr_kinds;
mod jpeg_kinds;
mod other_programs;
mod png_kinds;
mod shared_pictures;
mod stated_colors;
mod tga_kinds;
mod tiff_file;
mod tiff_kinds;

/// Bytes of all values, in a mixed order.
fn byte(i: u32) -> u8 {
    (i * 37).to_le_bytes()[0]
}

fn bands(path: &Path, rows: usize) -> Vec<Band> {
    Picture::open(path).unwrap().bands(rows).collect::<Result<_, _>>().unwrap()
}

fn colors(path: &Path, rows: usize) -> Vec<[f32; 3]> {
    bands(path, rows).into_iter().flat_map(|band| band.rgb).collect()
}

fn png(path: &Path, color: png::ColorType, depth: png::BitDepth, bytes: &[u8], size: [u32; 2]) {
    let mut encoder = png::Encoder::new(File::create(path).unwrap(), size[0], size[1]);
    encoder.set_color(color);
    encoder.set_depth(depth);
    if color == png::ColorType::Indexed {
        encoder.set_palette(vec![0, 0, 0, 255, 0, 51, 0, 255, 255]);
    }
    encoder.write_header().unwrap().write_image_data(bytes).unwrap();
}

#[test]
fn every_kind_of_png_reads_back_as_fractions() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.png");
    let eight: Vec<u8> = (0..5 * 7 * 4).map(byte).collect();
    let part = |v: u8| f32::from(v) / 255.0;

    png(&path, png::ColorType::Rgba, png::BitDepth::Eight, &eight, [5, 7]);
    let read = bands(&path, 3);
    assert_eq!(
        read.iter().map(|b| (b.first_row, b.rows())).collect::<Vec<_>>(),
        [(0, 3), (3, 3), (6, 1)]
    );
    for (band, start) in read.iter().zip([0, 60, 120]) {
        for (i, (rgb, alpha)) in band.rgb.iter().zip(band.alpha.as_ref().unwrap()).enumerate() {
            let stored = &eight[start + 4 * i..];
            assert_eq!((*rgb, *alpha), ([0, 1, 2].map(|k| part(stored[k])), part(stored[3])));
        }
    }
    assert_eq!(Picture::open(&path).unwrap().alpha(), Some(Alpha::Straight));

    png(&path, png::ColorType::Grayscale, png::BitDepth::Eight, &eight[..35], [5, 7]);
    let gray: Vec<[f32; 3]> = eight[..35].iter().map(|&v| [part(v); 3]).collect();
    assert_eq!(colors(&path, 2), gray);

    png(&path, png::ColorType::Indexed, png::BitDepth::Eight, &[0, 1, 2, 1], [2, 2]);
    let red = [1.0, 0.0, 0.2];
    assert_eq!(colors(&path, 1), [[0.0; 3], red, [0.0, 1.0, 1.0], red]);

    png(&path, png::ColorType::Rgb, png::BitDepth::Sixteen, &[0, 0, 255, 255, 1, 0], [1, 1]);
    assert_eq!(colors(&path, 1), [[0.0, 1.0, 256.0 / 65535.0]]);
}

#[test]
fn an_interlaced_png_reads_as_it_was_made() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/interlaced.png");
    let expected: Vec<[f32; 3]> = (0..37_usize)
        .flat_map(|y| (0..40_usize).map(move |x| [((3 * x + 5 * y) % 256) as f32 / 255.0; 3]))
        .collect();
    assert_eq!(colors(&path, 10), expected);
    let encoding = Picture::open(&path).unwrap().encoding();
    assert_eq!(encoding, Some(Encoding::Gamma(100_000.0 / 45_455.0)));
}

#[test]
fn the_space_and_encoding_of_a_png_are_those_it_states() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.png");
    let write = |set: &dyn Fn(&mut png::Encoder<'_, File>)| {
        let mut encoder = png::Encoder::new(File::create(&path).unwrap(), 1, 1);
        encoder.set_color(png::ColorType::Rgb);
        set(&mut encoder);
        encoder.write_header().unwrap().write_image_data(&[1, 2, 3]).unwrap();
        let picture = Picture::open(&path).unwrap();
        (picture.space().map(|s| s.name().to_owned()), picture.encoding())
    };
    assert_eq!(write(&|_| ()), (None, None));
    let srgb = |e: &mut png::Encoder<'_, File>| {
        e.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    };
    assert_eq!(write(&srgb), (Some("srgb".into()), Some(Encoding::Srgb)));
    let p3 = |e: &mut png::Encoder<'_, File>| {
        e.set_source_gamma(png::ScaledFloat::new(1.0));
        e.set_source_chromaticities(png::SourceChromaticities::new(
            (0.3127, 0.3290),
            (0.680, 0.320),
            (0.265, 0.690),
            (0.150, 0.060),
        ));
    };
    assert_eq!(write(&p3), (Some("p3-d65".into()), Some(Encoding::Linear)));
}

#[test]
fn tiff_of_each_depth_reads_back() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.tif");
    let make = || TiffEncoder::new(File::create(&path).unwrap()).unwrap();
    let eight: Vec<u8> = (0..9 * 11 * 3).map(byte).collect();
    make().write_image::<colortype::RGB8>(9, 11, &eight).unwrap();
    let expected: Vec<[f32; 3]> =
        eight.chunks(3).map(|p| [0, 1, 2].map(|k| f32::from(p[k]) / 255.0)).collect();
    assert_eq!(colors(&path, 4), expected);
    assert_eq!(Picture::open(&path).unwrap().encoding(), None);

    let sixteen: Vec<u16> = (0..9 * 11 * 4_u16).map(|i| i * 150).collect();
    make().write_image::<colortype::RGBA16>(9, 11, &sixteen).unwrap();
    // The encoder writes no field that says what the fourth sample is.
    let declared = Declared { alpha: Some(DeclaredAlpha::Straight), ..Declared::default() };
    let mut picture = Picture::open_as(&path, &declared).unwrap();
    let read = [picture.read_band(100).unwrap().unwrap()];
    assert_eq!(read[0].rgb[98], [392, 393, 394].map(|i| f32::from(sixteen[i]) / 65535.0));
    assert_eq!(read[0].alpha.as_ref().unwrap()[98], f32::from(sixteen[395]) / 65535.0);

    let floats: Vec<f32> = (0..9 * 11 * 3_u16).map(|i| f32::from(i) * 0.01 - 1.0).collect();
    make().write_image::<colortype::RGB32Float>(9, 11, &floats).unwrap();
    assert_eq!(colors(&path, 1).as_flattened(), floats);
    assert_eq!(Picture::open(&path).unwrap().encoding(), Some(Encoding::Linear));

    make().write_image::<colortype::Gray16>(9, 11, &sixteen[..99]).unwrap();
    assert_eq!(colors(&path, 5)[98], [f32::from(sixteen[98]) / 65535.0; 3]);
}

#[test]
fn primaries_of_a_tiff_are_read_and_other_colors_than_rgb_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.tif");
    let mut encoder = TiffEncoder::new(File::create(&path).unwrap()).unwrap();
    let mut image = encoder.new_image::<colortype::RGB8>(1, 1).unwrap();
    let ratio = |parts| tiff::encoder::Rational { n: parts, d: 10_000 };
    let white = [3127, 3290].map(ratio);
    let primaries = [7080, 2920, 1700, 7970, 1310, 460].map(ratio);
    image.encoder().write_tag(Tag::Unknown(318), &white[..]).unwrap();
    image.encoder().write_tag(Tag::Unknown(319), &primaries[..]).unwrap();
    image.write_data(&[1, 2, 3]).unwrap();
    let picture = Picture::open(&path).unwrap();
    assert_eq!(picture.space().map(|s| s.name()), Some("rec2020"));

    let mut encoder = TiffEncoder::new(File::create(&path).unwrap()).unwrap();
    encoder.write_image::<colortype::CMYK8>(1, 1, &[1, 2, 3, 4]).unwrap();
    let message = Picture::open(&path).unwrap_err().to_string();
    assert_eq!(message, "CMYK pixels, expected gray or RGB: save the picture as one of these");
}
