//! Killed at any moment, a command leaves the file that was there, or its own: never a part of one.

#![expect(clippy::unwrap_used, reason = "a test that cannot start has failed")]

mod support;

use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use support::{Folder, program};

/// What is killed: the command, and the file that it replaces.
const COMMANDS: [(&str, &str); 6] = [
    ("build --preset jakob2019 --resolution 9 -o out.safetensors", "out.safetensors"),
    (
        "bake cube.safetensors in.tga -o out.exr --space srgb --encoding srgb --as material",
        "out.exr",
    ),
    ("bake cube.safetensors in.tga -o out.tx --space srgb --encoding srgb --format tx", "out.tx"),
    (
        "bake cube.safetensors in.tga -o out.png --space srgb --encoding srgb --as radiance --light A",
        "out.png",
    ),
    ("export cube.safetensors out.csv", "out.csv"),
    ("check in.tga --space srgb --encoding srgb -o out.html", "out.html"),
];

/// What was there before.
const OLD: &[u8] = b"what was there before";

fn start(folder: &Folder, words: &str) -> Child {
    Command::new(program())
        .args(words.split_whitespace())
        .arg("--quiet")
        .current_dir(folder.path())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap()
}

/// A picture of 96² pixels of as many colors.
fn picture() -> Vec<u8> {
    let mut bytes = vec![0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 96, 0, 96, 0, 24, 0x20];
    bytes.extend(
        (0..96_u8).flat_map(|y| (0..96).flat_map(move |x| [x * 2, y * 2, 100 + x / 2 + y])),
    );
    bytes
}

/// Kills commands one after the other, at moments spread evenly over the time that they take; how many of them had
/// not ended before.
fn killed(count: u32) -> usize {
    let folder = Folder::new();
    folder.done("build --preset jakob2019 --resolution 5 -o cube.safetensors --quiet");
    folder.write("in.tga", picture());
    let wholes = COMMANDS.map(|(words, file)| {
        let from = Instant::now();
        assert!(start(&folder, words).wait().unwrap().success(), "{words}");
        (folder.read(file), from.elapsed())
    });
    let mut hits = 0;
    for i in 0..count {
        let which = i as usize % COMMANDS.len();
        let ((words, file), (whole, time)) = (COMMANDS[which], &wholes[which]);
        folder.write(file, OLD);
        let mut child = start(&folder, words);
        std::thread::sleep(time.mul_f64(f64::from(i) / f64::from(count)));
        let is_running = child.try_wait().unwrap().is_none();
        child.kill().unwrap();
        child.wait().unwrap();
        let found = folder.read(file);
        let is_whole = found == OLD || found == *whole;
        assert!(is_whole, "{words}: {} bytes after {i} of {count}", found.len());
        hits += usize::from(is_running);
    }
    // What killed runs left beside goes with the next run that writes here.
    for (words, file) in COMMANDS {
        assert!(start(&folder, words).wait().unwrap().success(), "{words}");
        let (whole, _) = &wholes[COMMANDS.iter().position(|(known, _)| *known == words).unwrap()];
        assert_eq!(&folder.read(file), whole, "{words}");
    }
    let left: Vec<String> =
        folder.names().into_iter().filter(|name| name.starts_with(".upglow")).collect();
    assert_eq!(left, [""; 0], "temporary files");
    hits
}

#[test]
fn commands_killed_at_thirty_moments_leave_whole_files() {
    assert!(killed(30) > 0, "every command ended before it was killed");
}

#[test]
#[ignore = "slow: five minutes"]
fn slow_commands_killed_at_a_thousand_moments_leave_whole_files() {
    let hits = killed(1000);
    println!("{hits} of 1000 were killed while they ran");
    assert!(hits > 500, "{hits}");
}

/// A pipe that nobody writes to is refused by every command, in no time.
#[cfg(unix)]
#[test]
fn inputs_that_may_never_end_are_refused_at_once() {
    let folder = Folder::new();
    folder.done("build --preset jakob2019 --resolution 2 -o cube.safetensors --quiet");
    folder.write("in.exr", "");
    assert!(Command::new("mkfifo").arg(folder.path().join("pipe.exr")).status().unwrap().success());
    for input in ["pipe.exr", "/dev/zero", "/dev/urandom"] {
        for words in [
            format!("inspect {input}"),
            format!("verify {input}"),
            format!("check {input}"),
            format!("bake cube.safetensors {input} -o x.exr"),
            format!("bake {input} in.exr -o x.exr"),
            format!("lint {input}"),
            format!("read {input} --at 0,0"),
            format!("build --illuminant {input} -o x"),
            format!("build --observer {input} -o x"),
            format!("fit-matrix {input}"),
            format!("color cube.safetensors --colors {input}"),
        ] {
            let from = Instant::now();
            let run = folder.run(&words);
            assert!(run.status == 1 || run.status == 2, "{words}: {}", run.status);
            assert!(from.elapsed() < Duration::from_secs(20), "{words}");
            support::one_line(&run.stderr);
        }
    }
}
