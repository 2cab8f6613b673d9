//! Pictures and spectral files.

use std::cell::OnceCell;
use std::fs;
use std::path::{Path, PathBuf};

use tempfile::TempDir;
use upglow::Bispectral as _;
use upglow_image::{Declared, ExrReader, Lint, MaterialPicture, Picture, SpectralPicture};

/// Most samples that are decompressed in one run: more is only slower.
const MOST_SAMPLES: usize = 1 << 18;
/// Rows that are read at a time.
const BAND_ROWS: usize = 7;

pub(crate) fn exr(bytes: &[u8]) {
    picture(bytes, "x.exr");
}

pub(crate) fn tiff(bytes: &[u8]) {
    picture(bytes, "x.tif");
}

pub(crate) fn png(bytes: &[u8]) {
    picture(bytes, "x.png");
}

pub(crate) fn jpeg(bytes: &[u8]) {
    picture(bytes, "x.jpg");
}

pub(crate) fn tga(bytes: &[u8]) {
    picture(bytes, "x.tga");
}

pub(crate) fn radiance(bytes: &[u8]) {
    picture(bytes, "x.hdr");
}

/// A new folder, in memory where the system has one there.
pub(crate) fn folder() -> TempDir {
    let memory = Path::new("/dev/shm");
    let made = if memory.is_dir() { TempDir::new_in(memory) } else { TempDir::new() };
    made.expect("a folder for files")
}

thread_local! {
    static FOLDER: OnceCell<TempDir> = const { OnceCell::new() };
}

/// A file with these bytes, until the next one of the same name.
fn file(bytes: &[u8], name: &str) -> PathBuf {
    let path = FOLDER.with(|made| made.get_or_init(folder).path().join(name));
    fs::write(&path, bytes).expect("room for a file");
    path
}

fn picture(bytes: &[u8], name: &str) {
    let path = file(bytes, name);
    let mut picture = match Picture::open_as(&path, &Declared::default()) {
        Ok(picture) => picture,
        Err(error) => return crate::check_message(&error),
    };
    let [width, height] = picture.size();
    assert!(width > 0 && height > 0, "an empty picture");
    if width.saturating_mul(height) > MOST_SAMPLES {
        return;
    }
    let mut rows = 0;
    for band in picture.bands(BAND_ROWS) {
        let band = match band {
            Ok(band) => band,
            Err(error) => return crate::check_message(&error),
        };
        assert_eq!((band.first_row, band.rgb.len() % width), (rows, 0), "a band of part of a row");
        assert!(band.alpha.as_ref().is_none_or(|alpha| alpha.len() == band.rgb.len()));
        rows += band.rows();
    }
    assert_eq!(rows, height, "rows of a whole picture");
}

/// Whether all samples are few enough to be read.
fn is_small(path: &Path) -> bool {
    ExrReader::open(path).is_ok_and(|reader| {
        let [width, height] = reader.size();
        width.saturating_mul(height).saturating_mul(reader.channel_names().len()) <= MOST_SAMPLES
    })
}

/// A spectral file, as a whole or in compact form.
pub(crate) fn spectral(bytes: &[u8]) {
    let path = file(bytes, "spectral.exr");
    if let Err(error) = Lint::of_header(&path) {
        return crate::check_message(&error);
    }
    if !is_small(&path) {
        return;
    }
    match Lint::of_file(&path) {
        Ok(lint) => lint.findings.iter().for_each(|finding| {
            let line = finding.to_string();
            assert!(!line.contains('\n'), "a finding of two lines: {line:?}");
        }),
        Err(error) => crate::check_message(&error),
    }
    let mut picture = match SpectralPicture::open(&path) {
        Ok(picture) => picture,
        Err(error) => return crate::check_message(&error),
    };
    let [width, height] = picture.size();
    if let Err(error) = picture.at(width - 1, height / 2) {
        crate::check_message(&error);
    }
    match picture.matrix(None, None) {
        Ok(matrix) => assert!(matrix.factors().iter().flatten().all(|v| v.is_finite())),
        Err(error) => crate::check_message(&error),
    }
}

/// A file of materials.
pub(crate) fn material(bytes: &[u8]) {
    let path = file(bytes, "material.exr");
    if !is_small(&path) {
        return;
    }
    let mut picture = match MaterialPicture::open(&path) {
        Ok(picture) => picture,
        Err(error) => return crate::check_message(&error),
    };
    let model = picture.model().clone();
    for y in 0..picture.size()[1] {
        let row = match picture.row(y) {
            Ok(row) => row,
            Err(error) => return crate::check_message(&error),
        };
        for material in row {
            let albedo = upglow::Mixture::of(&model, material).albedo(430.0);
            assert!((0.0..=1.0 + 1e-9).contains(&albedo), "an albedo of {albedo}");
        }
    }
}
