//! OpenEXR files are read back as they were written, by bands and by regions.

use std::path::Path;

use proptest::prelude::*;

use super::attribute::{Attributes, chromaticities};
use super::header::{Sample, Window};
use super::reader::ExrReader;
use super::writer::{Compression, ExrDescription, ExrWriter, WriteExrError};
use crate::picture::Picture;

/// Samples that halves hold exactly, different in each channel.
fn planes(size: [usize; 2], channels: usize) -> Vec<Vec<f32>> {
    let sample = |c: usize, i: usize| ((i * 7 + c * 131) % 1024) as f32 / 1024.0;
    (0..channels).map(|c| (0..size[0] * size[1]).map(|i| sample(c, i)).collect()).collect()
}

fn write(path: &Path, description: ExrDescription, planes: &[Vec<f32>], band: usize) {
    let width = description.size[0];
    let mut writer = ExrWriter::create(path, description).unwrap();
    let rows = planes[0].len() / width;
    for top in (0..rows).step_by(band) {
        let range = top * width..rows.min(top + band) * width;
        let bands: Vec<&[f32]> = planes.iter().map(|plane| &plane[range.clone()]).collect();
        writer.write_band(&bands).unwrap();
    }
    writer.finish().unwrap();
}

fn description(size: [usize; 2], names: &[&str]) -> ExrDescription {
    ExrDescription::new(size, names.iter().copied())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn any_cut_into_bands_reads_back(
        width in 1_usize..80, height in 1_usize..70, channels in 1_usize..5, band in 1_usize..40,
        float in any::<bool>(), packing in 0_usize..3, place in (0.0..1.0, 0.0..1.0, 0.0..1.0, 0.0..1.0),
    ) {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("x.exr");
        let names = &["z", "T.550,000000nm", "a", "B"][..channels];
        let planes = planes([width, height], channels);
        let compression = [Compression::None, Compression::Zips, Compression::Zip][packing];
        let sample = if float { Sample::Float } else { Sample::Half };
        let described =
            ExrDescription { compression, sample, ..description([width, height], names) };
        write(&path, described, &planes, band);

        let mut reader = ExrReader::open(&path).unwrap();
        let stored: Vec<&str> = reader.channels().iter().map(|c| c.name.as_str()).collect();
        prop_assert!(stored.is_sorted());
        let numbers: Vec<usize> = names.iter().map(|n| reader.channel(n).unwrap()).collect();
        prop_assert_eq!(&reader.read_rows(0..height, &numbers).unwrap(), &planes);

        let cut = |side: usize, a: f64, b: f64| {
            let at = |u: f64| (0..side).rev().find(|&i| i as f64 <= u * side as f64).unwrap();
            at(a.min(b))..at(a.max(b)) + 1
        };
        let (columns, rows) = (cut(width, place.0, place.1), cut(height, place.2, place.3));
        let region = reader.read_region(columns.clone(), rows.clone(), &numbers).unwrap();
        for (plane, part) in planes.iter().zip(&region) {
            let expected: Vec<f32> = rows.clone()
                .flat_map(|y| plane[y * width..][columns.clone()].to_vec())
                .collect();
            prop_assert_eq!(part, &expected);
        }
    }
}

#[test]
fn pieces_cover_an_image_once_and_are_small() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.exr");
    for (size, channels) in [([300, 200], 3), ([70, 40], 3), ([5, 3], 7)] {
        let names: Vec<String> = (0..channels).map(|c| format!("c{c}")).collect();
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        write(&path, description(size, &names), &planes(size, channels), 16);
        let reader = ExrReader::open(&path).unwrap();
        // With a million channels, a piece is some columns of one row.
        for wanted in [1, 3, 1_000_000] {
            let mut covered = vec![0; size[0] * size[1]];
            for [columns, rows] in reader.pieces(wanted) {
                let bytes = columns.len() * rows.len() * wanted * size_of::<f32>();
                assert!(bytes <= 64 << 20 || rows.len() == 1, "{columns:?} {rows:?}");
                for y in rows {
                    columns.clone().for_each(|x| covered[y * size[0] + x] += 1);
                }
            }
            assert!(covered.iter().all(|&count| count == 1), "{size:?} {wanted}");
        }
    }
}

#[test]
fn bytes_depend_on_neither_bands_nor_threads() {
    let folder = tempfile::tempdir().unwrap();
    let planes = planes([300, 200], 3);
    let file = |name: &str, band: usize, threads: usize| {
        let path = folder.path().join(name);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let attributes: Attributes =
            (0..20).map(|i| (format!("attribute {i}"), format!("value {i}").into())).collect();
        let described = ExrDescription { attributes, ..description([300, 200], &["R", "G", "B"]) };
        pool.install(|| write(&path, described, &planes, band));
        std::fs::read(path).unwrap()
    };
    let first = file("a", 200, 1);
    assert_eq!(first, file("b", 7, 2));
    assert_eq!(first, file("c", 1, 3));
}

#[test]
fn a_written_picture_opens_with_its_space_and_windows() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.exr");
    for name in upglow_color::RgbSpace::names() {
        let space = upglow_color::RgbSpace::named(name).unwrap();
        let attributes = Attributes::from([("chromaticities".into(), chromaticities(&space))]);
        let data = Window { min: [-3, 5], max: [8, 24] };
        let display = Window { min: [0, 0], max: [99, 49] };
        let described = ExrDescription {
            attributes,
            windows: Some([data, display]),
            ..description([12, 20], &["R", "G", "B", "A"])
        };
        let planes = planes([12, 20], 4);
        write(&path, described, &planes, 6);
        let mut picture = Picture::open(&path).unwrap();
        assert_eq!(picture.space().map(|s| s.name()), Some(name));
        assert_eq!(picture.windows(), Some([data, display]));
        assert_eq!((picture.size(), picture.has_alpha()), ([12, 20], true));
        let bands: Vec<_> = picture.bands(16).collect::<Result<_, _>>().unwrap();
        assert_eq!(bands.iter().map(|b| b.rows()).collect::<Vec<_>>(), [16, 4]);
        let last = bands[1].rgb[47];
        assert_eq!(last, [planes[0][239], planes[1][239], planes[2][239]]);
        assert_eq!(bands[1].alpha.as_ref().unwrap()[47], planes[3][239]);
    }
}

#[test]
fn invalid_descriptions_and_bands_are_refused_and_leave_no_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.exr");
    let refused = |described: ExrDescription| {
        ExrWriter::create(&path, described).map(drop).unwrap_err().to_string()
    };
    assert_eq!(refused(description([0, 4], &["R"])), "0 by 4 pixels, expected 1 to 131072 a side");
    assert!(refused(description([4, 4], &["R", "R"])).starts_with("two channels named \"R\""));
    assert!(refused(description([4, 4], &[""])).starts_with("channel or attribute name \"\""));
    let attributes = Attributes::from([("dataWindow".into(), "x".into())]);
    let reserved = ExrDescription { attributes, ..description([4, 4], &["R"]) };
    assert!(refused(reserved).ends_with("expected a name that OpenEXR does not define itself"));

    let mut writer = ExrWriter::create(&path, description([4, 4], &["R", "G"])).unwrap();
    let error = |result: Result<(), WriteExrError>| result.unwrap_err().to_string();
    assert_eq!(error(writer.write_band(&[&[0.0; 4]])), "1 channels in a band, expected 2");
    assert!(
        error(writer.write_band(&[&[0.0; 4], &[0.0; 3]])).starts_with("3 samples in channel G")
    );
    assert_eq!(error(writer.write_band(&[&[0.0; 20], &[0.0; 20]])), "5 rows, expected 4");
    assert!(error(writer.write_band(&[&[0.0; 4], &[7e4; 4]])).starts_with("70000 in channel G"));
    writer.write_band(&[&[65504.0; 4], &[f32::INFINITY; 4]]).unwrap();
    assert_eq!(writer.finish().unwrap_err().to_string(), "1 rows, expected 4");
    assert_eq!(folder.path().read_dir().unwrap().count(), 0);
}

#[test]
fn every_compression_and_tiling_of_another_writer_reads_back() {
    use exr::image::{AnyChannel, AnyChannels, Encoding, FlatSamples, Image, Layer};
    use exr::prelude::*;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("x.exr");
    let size = [70, 45];
    let planes = planes(size, 3);
    let lossless = [
        exr::prelude::Compression::Uncompressed,
        exr::prelude::Compression::RLE,
        exr::prelude::Compression::ZIP1,
        exr::prelude::Compression::ZIP16,
        exr::prelude::Compression::PIZ,
        exr::prelude::Compression::PXR24,
        exr::prelude::Compression::B44,
        exr::prelude::Compression::B44A,
    ];
    for compression in lossless {
        for blocks in [Blocks::ScanLines, Blocks::Tiles(Vec2(16, 8)), Blocks::Tiles(Vec2(128, 128))]
        {
            let channel = |name: &str, plane: &[f32]| {
                // B44 stores floats without loss, and PXR24 halves.
                let halves = plane.iter().map(|v| f16::from_f32(*v)).collect();
                let samples = match compression {
                    exr::prelude::Compression::PXR24 => FlatSamples::F16(halves),
                    _ => FlatSamples::F32(plane.to_vec()),
                };
                AnyChannel::new(name, samples)
            };
            let list = AnyChannels::sort(
                [channel("G", &planes[1]), channel("R", &planes[0]), channel("B", &planes[2])]
                    .into_iter()
                    .collect(),
            );
            let encoding = Encoding { compression, blocks, line_order: LineOrder::Increasing };
            let layer = Layer::new((70, 45), LayerAttributes::named("main"), encoding, list);
            Image::from_layer(layer).write().to_file(&path).unwrap();
            let mut picture = Picture::open(&path).unwrap();
            let mut rgb = Vec::new();
            for band in picture.bands(5) {
                rgb.extend(band.unwrap().rgb);
            }
            let expected: Vec<[f32; 3]> =
                (0..70 * 45).map(|i| [planes[0][i], planes[1][i], planes[2][i]]).collect();
            assert!(rgb == expected, "{compression:?} {blocks:?}");
        }
    }
}
