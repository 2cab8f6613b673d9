//! The same bytes on every processor: the program's outputs on emulated ones, by Debian's package `qemu-user`.
#![cfg(target_arch = "x86_64")]
#![expect(clippy::unwrap_used, reason = "a test fails where its files cannot be made")]

mod support;

use std::process::Command;

use crate::support::{Folder, program};

const EMULATOR: &str = "qemu-x86_64";

/// Without SSE4, without AVX, with AVX2 and FMA.
const PROCESSORS: [&str; 3] = ["core2duo", "Nehalem", "Haswell"];

/// What is run, each with the name of what it writes. The first makes the cube that the others read.
const RUNS: [(&str, &str); 6] = [
    ("build --resolution 3 --threads 2 -o", "cube.safetensors"),
    ("bake cube.safetensors small.exr --threads 2 -o", "material.exr"),
    ("bake cube.safetensors small.exr --as radiance --light A --threads 2 -o", "radiance.exr"),
    ("bake cube.safetensors small.exr --as rgbu --threads 2 -o", "matrix.exr"),
    ("export cube.safetensors", "cube.glsl"),
    ("color cube.safetensors 0.9 0.2 0.4 --direct --plot", "color.svg"),
];

/// The files in a folder that these runs made.
fn made(processor: Option<&str>) -> Vec<(String, Vec<u8>)> {
    let folder = Folder::new();
    let picture = folder.path().join("small.exr");
    small_picture(&picture);
    for (words, output) in RUNS {
        let mut command = match processor {
            None => Command::new(program()),
            Some(processor) => {
                let mut command = Command::new(EMULATOR);
                command.args(["-cpu", processor]).arg(program());
                command
            }
        };
        let words = words.split_whitespace().chain([output]);
        let done = command.args(words).current_dir(folder.path()).output().unwrap();
        let said = String::from_utf8_lossy(&done.stderr);
        assert!(done.status.success(), "{processor:?} {output}: {said}");
    }
    let names = folder.names();
    names.into_iter().map(|name| (name.clone(), folder.read(&name))).collect()
}

/// Colors all over the cube, in ACEScg.
fn small_picture(path: &std::path::Path) {
    use upglow_image::{ExrDescription, ExrWriter};
    let described = ExrDescription::new([16, 4], ["R", "G", "B"])
        .with_space(&upglow_color::RgbSpace::default());
    let plane = |stride: usize| (0..64).map(|i| (i * stride % 64) as f32 / 63.0).collect();
    let planes: [Vec<f32>; 3] = [1, 5, 23].map(plane);
    let mut writer = ExrWriter::create(path, described).unwrap();
    writer.write_band(&planes.each_ref().map(Vec::as_slice)).unwrap();
    writer.finish().unwrap();
}

#[test]
fn every_processor_makes_the_same_bytes() {
    if Command::new(EMULATOR).arg("--version").output().is_err() {
        return println!("skipped: every_processor_makes_the_same_bytes, no {EMULATOR}");
    }
    let own = made(None);
    assert!(own.len() > RUNS.len(), "{} files", own.len());
    for processor in PROCESSORS {
        for ((name, expected), (also, found)) in own.iter().zip(made(Some(processor))) {
            assert!(*name == also && *expected == found, "{processor}: {name} differs");
        }
    }
}
