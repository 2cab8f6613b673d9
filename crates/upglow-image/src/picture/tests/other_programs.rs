//! Pictures that `OpenImageIO` writes read as it reads them itself, texel by texel.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

use super::super::Picture;
use super::super::stated::{Declared, DeclaredAlpha};
use crate::python::python;

/// Greatest difference in JPEG: the standard lets each number of a transform be off by one step of 8 bits,
/// which the conversion to blue nearly doubles, and each decoder smooths color that is stored at half the
/// size in its own way. Four steps, and the rounding of single precision.
const JPEG: f32 = 4.01 / 255.0;

struct Kind {
    file: String,
    size: [usize; 2],
    channels: usize,
}

impl Kind {
    fn of(line: &str) -> Self {
        let words: Vec<&str> = line.split(' ').collect();
        let &[file, width, height, channels] = &words[..] else { panic!("{line}") };
        let [width, height, channels] = [width, height, channels].map(|n| n.parse().unwrap());
        Self { file: file.into(), size: [width, height], channels }
    }

    fn suffix(&self) -> &str {
        self.file.rsplit('.').next().unwrap()
    }

    /// Our numbers, channel by channel of each pixel.
    fn read(&self, folder: &Path) -> Vec<f32> {
        let declared = Declared { alpha: Some(DeclaredAlpha::Straight), ..Declared::default() };
        let path = folder.join(&self.file);
        let picture = Picture::open_as(&path, &declared);
        let mut picture = picture.unwrap_or_else(|error| panic!("{}: {error}", self.file));
        assert_eq!(picture.size(), self.size, "{}", self.file);
        let mut numbers = Vec::new();
        for band in picture.bands(7) {
            let band = band.unwrap_or_else(|error| panic!("{}: {error}", self.file));
            let colors = if self.channels < 3 { 1 } else { 3 };
            for (i, rgb) in band.rgb.iter().enumerate() {
                numbers.extend(&rgb[..colors]);
                numbers.extend(band.alpha.as_ref().map(|alpha| alpha[i]));
            }
        }
        numbers
    }
}

#[test]
fn what_open_image_io_writes_reads_as_it_reads_it() {
    let Some(python) = python("OpenImageIO, numpy") else {
        println!(
            "skipped: what_open_image_io_writes_reads_as_it_reads_it, no python3 with OpenImageIO"
        );
        return;
    };
    let folder = tempfile::tempdir().unwrap();
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/readers/write_pictures.py");
    let output = Command::new(python).arg(script).arg(folder.path()).output().unwrap();
    let failed = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{failed}");
    print!("{}", String::from_utf8_lossy(&output.stdout));
    let list = std::fs::read_to_string(folder.path().join("kinds.txt")).unwrap();
    // Files, those that are the same, and the greatest difference.
    let mut table: BTreeMap<String, (usize, usize, f32)> = BTreeMap::new();
    for kind in list.lines().map(Kind::of) {
        let theirs = std::fs::read(folder.path().join(format!("{}.raw", kind.file))).unwrap();
        let theirs = theirs.as_chunks().0.iter().map(|bytes| f32::from_le_bytes(*bytes));
        let ours = kind.read(folder.path());
        assert_eq!(ours.len(), theirs.len(), "{}", kind.file);
        let off = ours.iter().zip(theirs).map(|(a, b)| (a - b).abs()).fold(0.0, f32::max);
        let row = table.entry(kind.suffix().to_owned()).or_default();
        *row = (row.0 + 1, row.1 + usize::from(off == 0.0), row.2.max(off));
        // All others are the same, also where compression lost something.
        let tolerance = if kind.suffix() == "jpg" { JPEG } else { 0.0 };
        assert!(off <= tolerance, "{}: differs by {off}", kind.file);
    }
    for (suffix, (count, same, most)) in table {
        println!("{suffix}: {count} pictures, {same} the same, greatest difference {most}");
    }
}
