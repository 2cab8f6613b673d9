//! LUTs of the nearest colors, as OpenColorIO checks and applies them.

#![expect(clippy::unwrap_used, reason = "a test that cannot start has failed")]

#[path = "../../upglow-image/src/python.rs"]
mod python;
mod support;

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use rayon::prelude::*;
use support::Folder;
use upglow::Cube;
use upglow_color::rounding::to_single;
use upglow_color::{Choice as _, LinearRgb, Metric, StandingKind, Xyz};
use upglow_fit::{MaterialSet, NearestColors, ReachView, StandingTable, random_rgb};
use upglow_shader::{LutFormat, LutLattice};

const SCRIPT: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/luts/apply.py");

/// The greatest relative error of OpenColorIO's powers, which it reads from tables: a square root, and a square.
const POWERS: f32 = 5e-5;

/// Positions within a LUT are in single precision.
const POSITIONS: f32 = 1e-7;

/// ΔE00 of the powers, and of marks that begin just beyond white.
const UNCHANGED_DE2000: f64 = 0.05;

/// Share of random colors within 0.5 ΔE00, though the border of what materials show is curved and interpolation cuts its
/// corners. It is 93.7 % of the fewest for a table of 17 entries along an axis; another nearest color, such as that of
/// the other set, leaves less.
const LEAST_WITHIN: f64 = 0.9;

fn python_with_ocio() -> Option<PathBuf> {
    python::python("PyOpenColorIO, numpy")
}

const SKIPPED: &str = "skipped: no Python with PyOpenColorIO, see tests/luts/requirements.txt";

/// What OpenColorIO makes of colors by each of the files; it must have nothing to say against one.
fn applied(
    python: &Path,
    folder: &Folder,
    interpolation: &str,
    files: &[String],
    colors: &[[f32; 3]],
) -> Vec<Vec<[f32; 3]>> {
    let mut command = Command::new(python);
    command.arg(SCRIPT).arg(interpolation).args(files).current_dir(folder.path());
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    let bytes: Vec<u8> = colors.as_flattened().iter().flat_map(|v| v.to_le_bytes()).collect();
    // The script reads everything before it writes.
    child.stdin.take().unwrap().write_all(&bytes).unwrap();
    let output = child.wait_with_output().unwrap();
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success() && said.is_empty(), "{files:?}: {said}");
    let (numbers, _) = output.stdout.as_chunks::<4>();
    let numbers: Vec<f32> = numbers.iter().map(|bytes| f32::from_le_bytes(*bytes)).collect();
    let (results, _) = numbers.as_chunks::<3>();
    assert_eq!(results.len(), files.len() * colors.len());
    results.chunks(colors.len()).map(<[_]>::to_vec).collect()
}

/// The name of a file, which is written into the folder.
fn export(
    folder: &Folder,
    set: MaterialSet,
    view: ReachView,
    format: LutFormat,
    options: &str,
) -> String {
    let name = format!("{set}-{view}.{format}");
    folder.done(&format!("export cube {name} --target {set} --show {view} {options}"));
    name
}

fn close(found: [f32; 3], expected: [f32; 3]) -> bool {
    let off = |k: usize| (found[k] - expected[k]).abs();
    (0..3).all(|k| off(k) <= POWERS * expected[k].abs() + POSITIONS)
}

#[test]
fn opencolorio_reads_every_lut_and_grays_stay_what_they_are() {
    let Some(python) = python_with_ocio() else { return eprintln!("{SKIPPED}") };
    let folder = Folder::new();
    folder.done("build -o cube.safetensors --resolution 5");
    std::fs::rename(folder.path().join("cube.safetensors"), folder.path().join("cube")).unwrap();
    let mut files = Vec::new();
    for &set in MaterialSet::ALL {
        for &view in ReachView::ALL {
            for &format in LutFormat::ALL {
                files.push(export(&folder, set, view, format, "--resolution 9"));
            }
        }
    }
    let grays: Vec<[f32; 3]> = (0..=1000_u16).map(|i| [f32::from(i) / 1000.0; 3]).collect();
    let far = [[2.0; 3], [1.0; 3], [-0.3, 0.5, 4.0], [0.0, 0.5, 1.0], [f32::NAN; 3]];
    let colors = [&grays[..], &far].concat();
    let found = applied(&python, &folder, "tetrahedral", &files, &colors);
    for (file, found) in files.iter().zip(&found) {
        for (gray, found) in grays.iter().zip(found) {
            // White itself is the last within reach, so that rounding may already show a little of the mark.
            let is_white = gray[0] == 1.0 && file.contains("out-of-reach");
            assert!(is_white || close(*found, *gray), "{file}: {gray:?} {found:?}");
        }
        let far = &found[grays.len()..];
        assert!(far.as_flattened().iter().all(|v| v.is_finite()), "{file}: {far:?}");
        if file.starts_with("cube-nearest") {
            assert_eq!([far[0], far[2]], [far[1], far[3]], "{file}: values are clamped to 0..1");
        }
    }
}

#[test]
fn a_lut_is_the_same_for_any_number_of_threads_and_says_what_it_holds() {
    let folder = Folder::new();
    folder.done("build -o cube.safetensors --resolution 3");
    for (format, options) in [("clf", ""), ("cube", "--target any --show out-of-reach")] {
        let export = |threads: usize| {
            let words = format!("export cube.safetensors {threads}.{format} --threads {threads}");
            let report = folder.json(&format!("{words} --resolution 9 {options}"));
            assert_eq!((&report["format"], &report["nodes"]), (&format.into(), &729.into()));
            folder.read(&format!("{threads}.{format}"))
        };
        let text = export(1);
        assert!(text == export(3), "{format}");
        let text = String::from_utf8(text).unwrap();
        assert!(text.contains("Input and output: linear acescg under D65, observer CIE 1931 2"));
        let numbers = |line: &str| line.split(' ').map(str::parse::<f32>).all(|v| v.is_ok());
        assert_eq!(text.lines().filter(|line| numbers(line)).count(), 729, "{format}");
    }
}

/// ΔE00 of some colors.
#[derive(Default)]
struct Differences(Vec<f64>);

impl Differences {
    /// Count, median, 95 %, 99.9 %, greatest, share within 0.5.
    fn row(&mut self, name: &str) {
        let within = 100.0 * self.within(0.5);
        let Self(all) = self;
        all.sort_by(f64::total_cmp);
        let at = |permille: usize| all.get((all.len().max(1) - 1) * permille / 1000);
        let cell = |permille| at(permille).map_or(String::new(), |found| format!("{found:.3}"));
        let cells = [500, 950, 999, 1000].map(cell).join(" | ");
        println!("| {name} | {} | {cells} | {within:.2} % |", all.len());
    }

    fn within(&self, limit: f64) -> f64 {
        self.0.iter().filter(|found| **found <= limit).count() as f64 / self.0.len().max(1) as f64
    }

    fn greatest(&self) -> f64 {
        self.0.iter().copied().fold(0.0, f64::max)
    }
}

/// Which of the nodes of a color's cell the materials show: all, some or none.
#[derive(Clone, Copy, PartialEq)]
enum Place {
    Within,
    Border,
    Beyond,
}

struct Cells {
    axis: Vec<f64>,
    is_shown: Vec<bool>,
}

impl Cells {
    fn new(lattice: LutLattice, is_shown: impl Fn(LinearRgb) -> bool + Send + Sync) -> Self {
        let n = lattice.resolution();
        let colors = lattice.colors();
        let axis = colors[..n].iter().map(|rgb| rgb.0[0]).collect();
        Self { axis, is_shown: colors.into_par_iter().map(is_shown).collect() }
    }

    fn place(&self, rgb: [f32; 3]) -> Place {
        let n = self.axis.len();
        let cell = rgb
            .map(|v| self.axis.partition_point(|node| *node <= f64::from(v)).clamp(1, n - 1) - 1);
        let corner = |i: usize| {
            let [r, g, b] = [0, 1, 2].map(|k| cell[k] + (i >> k & 1));
            self.is_shown[(b * n + g) * n + r]
        };
        match (0..8).filter(|i| corner(*i)).count() {
            8 => Place::Within,
            0 => Place::Beyond,
            _ => Place::Border,
        }
    }
}

/// The sets of colors: random, and as many darker ones.
fn colors(count: usize) -> [(&'static str, Vec<[f32; 3]>); 2] {
    let single = |rgb: LinearRgb| rgb.0.map(to_single);
    let random: Vec<[f32; 3]> = (0..count).map(|i| single(random_rgb(1, i))).collect();
    let dark = random.iter().map(|rgb| rgb.map(|v| v * v * v)).collect();
    [("random", random), ("dark", dark)]
}

/// Compares LUTs with what `check` says of each color, and prints tables.
fn compare(count: usize, resolution: usize, options: &str) {
    let Some(python) = python_with_ocio() else { return eprintln!("{SKIPPED}") };
    let folder = Folder::new();
    folder.done(&format!("build -o cube.safetensors --resolution {resolution}"));
    std::fs::rename(folder.path().join("cube.safetensors"), folder.path().join("cube")).unwrap();
    let cube = Cube::read(folder.path().join("cube")).unwrap();
    for format in [LutFormat::Clf, LutFormat::Cube] {
        for interpolation in ["tetrahedral", "linear"] {
            // A CLF file states its interpolation.
            if format == LutFormat::Cube || interpolation == "tetrahedral" {
                compare_cube(&python, &folder, &cube, format, interpolation, count);
            }
        }
        for set in [MaterialSet::Reflectance, MaterialSet::Any] {
            compare_limits(&python, &folder, &cube, format, set, count, options);
        }
    }
}

const HEAD: &str = "| colors | count | median | 95 % | 99.9 % | greatest | ≤ 0.5 |\n| --- | --- | --- | --- | --- | --- | --- |";

fn compare_cube(
    python: &Path,
    folder: &Folder,
    cube: &Cube,
    format: LutFormat,
    interpolation: &str,
    count: usize,
) {
    let table = StandingTable::new(cube.contract());
    let colorimetry = table.colorimetry();
    let blends = cube.color_table(colorimetry);
    let file = export(folder, MaterialSet::Cube, ReachView::Nearest, format, "");
    println!("\n{file}, {interpolation}\n\n{HEAD}");
    for (name, colors) in colors(count) {
        let found =
            applied(python, folder, interpolation, std::slice::from_ref(&file), &colors).remove(0);
        let mut expected = vec![[0.0; 3]; colors.len()];
        blends.xyz(&colors, &mut expected).unwrap();
        let difference = |(found, expected): (&[f32; 3], &[f32; 3])| {
            let found = colorimetry.xyz_from_rgb(LinearRgb(found.map(f64::from)));
            Metric::De2000.distance(colorimetry, Xyz(expected.map(f64::from)), found)
        };
        let all = found.par_iter().zip(&expected).map(difference).collect();
        let mut all = Differences(all);
        all.row(name);
        if interpolation == "tetrahedral" {
            // Single precision of colors near black.
            assert!(all.greatest() < 0.01, "{file}");
        }
    }
}

/// What LUTs make of a color.
struct Found {
    place: Place,
    /// ΔE00 to the nearest color.
    beyond: f64,
    /// ΔE00 between the nearest color and what the LUT shows.
    off: f64,
    /// ΔE00 between the color and the view of marks.
    changed: f64,
}

fn compare_limits(
    python: &Path,
    folder: &Folder,
    cube: &Cube,
    format: LutFormat,
    set: MaterialSet,
    count: usize,
    options: &str,
) {
    let table = StandingTable::new(cube.contract());
    let colorimetry = table.colorimetry();
    let most = match set {
        MaterialSet::Reflectance => StandingKind::Reflectance,
        _ => StandingKind::NeedsFluorescence,
    };
    let is_shown = |rgb| table.kind(rgb) <= most;
    let views = [ReachView::Nearest, ReachView::OutOfReach];
    let files = views.map(|view| export(folder, set, view, format, options));
    let text = String::from_utf8(folder.read(&files[0])).unwrap();
    let resolution = text.lines().find_map(|line| {
        let size = line.trim().strip_prefix("LUT_3D_SIZE ");
        size.or_else(|| line.trim().strip_prefix("<Array dim=\"")?.split(' ').next())
    });
    let range = NearestColors::new(cube, set).range();
    let lattice = LutLattice::around(format, resolution.unwrap().parse().unwrap(), range).unwrap();
    let cells = Cells::new(lattice, is_shown);
    println!(
        "\n{} with {} entries along an axis, tetrahedral\n\n{HEAD}",
        files[0],
        lattice.resolution()
    );
    for (name, colors) in colors(count) {
        let found = applied(python, folder, "tetrahedral", &files, &colors);
        let xyz = |rgb: [f32; 3]| colorimetry.xyz_from_rgb(LinearRgb(rgb.map(f64::from)));
        let found_of = |i: usize| {
            let rgb = LinearRgb(colors[i].map(f64::from));
            let standing = table.standing(rgb);
            let nearest = match set {
                MaterialSet::Reflectance => standing.reflectance,
                _ => standing.fluorescence,
            };
            let off =
                |to: Xyz, of: usize| Metric::De2000.distance(colorimetry, to, xyz(found[of][i]));
            Found {
                place: cells.place(colors[i]),
                beyond: nearest.de2000,
                off: off(nearest.color, 0),
                changed: off(xyz(colors[i]), 1),
            }
        };
        let all: Vec<Found> = (0..colors.len()).into_par_iter().map(found_of).collect();
        let off = |place: &[Place]| {
            let here = all.iter().filter(|found| place.contains(&found.place));
            Differences(here.map(|found| found.off).collect())
        };
        let mut within = off(&[Place::Within]);
        let mut everywhere = off(&[Place::Within, Place::Border, Place::Beyond]);
        assert!(within.greatest() < UNCHANGED_DE2000, "{}: {}", files[0], within.greatest());
        assert!(name != "random" || everywhere.within(0.5) > LEAST_WITHIN, "{}", files[0]);
        within.row(&format!("{name}, within reach, not in a cell at the border"));
        off(&[Place::Border]).row(&format!("{name}, in a cell at the border"));
        off(&[Place::Beyond]).row(&format!("{name}, out of reach, not in a cell at the border"));
        everywhere.row(&format!("{name}, all"));
        let changed = |is_wanted: fn(&Found) -> bool| {
            let wanted = all.iter().filter(|found| is_wanted(found));
            Differences(wanted.map(|found| found.changed).collect())
        };
        let mut unmarked = changed(|found| found.place == Place::Within);
        let mut marked = changed(|found| found.beyond >= 1.5);
        assert!(unmarked.greatest() < UNCHANGED_DE2000, "{}: {}", files[1], unmarked.greatest());
        assert!(name != "random" || marked.within(0.5) == 0.0, "{}", files[1]);
        unmarked.row(&format!("{name}, marked though within reach, not in a cell at the border"));
        changed(|found| found.beyond == 0.0).row(&format!("{name}, marked though within reach"));
        marked.row(&format!("{name}, marked, 1.5 or more out of reach"));
    }
}

#[test]
fn luts_show_the_nearest_colors_that_check_finds() {
    compare(1000, 5, "--resolution 17");
}

#[test]
#[ignore = "takes four minutes"]
fn slow_luts_show_the_nearest_colors_that_check_finds() {
    compare(100_000, 32, "");
}
