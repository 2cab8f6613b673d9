//! Plans of bakes and their tasks.
#![expect(clippy::unwrap_used, reason = "helpers of tests fail as tests do")]

#[path = "../../upglow-image/src/python.rs"]
mod python;
mod support;

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};

use support::{Folder, program};
use upglow_color::RgbSpace;
use upglow_image::{ExrDescription, ExrWriter};

/// A cube, and so many small pictures in a folder, no two the same.
fn desk(count: usize) -> Folder {
    let folder = Folder::new();
    folder.done("build --preset konig2020 --resolution 4 -o cube");
    std::fs::create_dir(folder.path().join("in")).unwrap();
    for i in 0..count {
        picture(&folder, &name(i), i as f32 / count as f32);
    }
    folder
}

fn name(i: usize) -> String {
    format!("in/p{i:04}.exr")
}

fn picture(folder: &Folder, name: &str, red: f32) {
    let described = ExrDescription::new([4, 3], ["R", "G", "B"]).with_space(&RgbSpace::default());
    let mut writer = ExrWriter::create(folder.path().join(name), described).unwrap();
    let ramp: Vec<f32> = (0..12).map(|i| i as f32 / 11.0).collect();
    writer.write_band(&[&[red; 12], &ramp, &[0.25; 12]]).unwrap();
    writer.finish().unwrap();
}

/// The names and bytes of all files of a folder, without those that a killed run left half-written.
fn content(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut files: Vec<_> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap())
        .map(|entry| (entry.file_name().into_string().unwrap(), entry.path()))
        .filter(|(name, _)| !name.starts_with(".upglow-"))
        .map(|(name, path)| (name, std::fs::read(path).unwrap()))
        .collect();
    files.sort();
    files
}

/// How many files tasks wrote, and how many they left as they were.
fn counts(folder: &Folder, words: &str) -> [usize; 2] {
    let told = folder.json(words);
    ["pictures", "unchanged"].map(|key| told[key].as_array().unwrap().len())
}

#[test]
fn tasks_write_what_one_run_writes_and_nothing_twice() {
    let folder = desk(7);
    folder.done("bake cube in -o one");
    let told = folder.json("bake cube in -o out --plan plan.json");
    assert_eq!((&told["tasks"], &told["texels"]), (&7.into(), &84.into()));
    assert!(!folder.path().join("out").exists());
    assert_eq!(counts(&folder, "bake --task 3 plan.json"), [1, 0]);
    assert_eq!(counts(&folder, "bake --task 7,2-4 plan.json"), [3, 1]);
    assert_eq!(counts(&folder, "bake --task 1-7 --threads 1 plan.json"), [3, 4]);
    assert_eq!(counts(&folder, "bake --task 1-7 plan.json"), [0, 7]);
    let [one, out] = ["one", "out"].map(|name| content(&folder.path().join(name)));
    assert!(one == out);
    // `--update` of one run and tasks are the same mechanism.
    assert_eq!(counts(&folder, "bake cube in -o out --update"), [0, 7]);

    picture(&folder, &name(4), 0.77);
    folder.done("bake cube in -o out --plan plan.json");
    assert_eq!(counts(&folder, "bake --task 1-7 plan.json"), [1, 6]);
}

#[test]
fn a_plan_holds_in_another_folder_with_all_options_of_the_bake() {
    let folder = desk(2);
    let options = "--as radiance --light A --light D65 --format png --bits 16 --exposure -1";
    std::fs::create_dir(folder.path().join("jobs")).unwrap();
    folder.done(&format!("bake cube in -o one --repair=clip {options}"));
    folder.done(&format!("bake cube in -o out --repair=clip {options} --plan jobs/plan.json"));
    let moved = Folder::new();
    for part in ["in", "jobs"] {
        std::fs::create_dir(moved.path().join(part)).unwrap();
        for (name, bytes) in content(&folder.path().join(part)) {
            moved.write(&format!("{part}/{name}"), bytes);
        }
    }
    moved.write("cube", folder.read("cube"));
    moved.done("bake --task 1-2 jobs/plan.json");
    let [one, out] =
        [(&folder, "one"), (&moved, "out")].map(|(f, name)| content(&f.path().join(name)));
    assert_eq!(one.len(), 4);
    assert!(one == out);
}

#[test]
fn what_has_changed_since_the_plan_is_refused_in_one_line() {
    let folder = desk(3);
    folder.done("bake cube in -o out --plan plan.json");
    let bake = |status, words: &str| folder.refused(status, words);
    let line = bake(2, "bake --task 4 plan.json");
    assert_eq!(line, "--task: task 4, expected 1 to 3, those of plan.json");
    let line = bake(2, "bake --task 1 plan.json --light A");
    assert_eq!(line, "--task: given with --light=A, expected no option that the plan has");
    let line = bake(1, "bake --task 1 cube");
    assert_eq!(line, "cube: no plan, expected a plan made by `upglow bake --plan`");

    let plan = String::from_utf8(folder.read("plan.json")).unwrap();
    folder.write("other.json", plan.replace("\"upglow_plan\":1", "\"upglow_plan\":2"));
    let line = bake(1, "bake --task 1 other.json");
    assert_eq!(line, "other.json: a plan of version 2, expected 1; make the plan again");
    folder.write("other.json", plan.replace("\"program\":\"", "\"program\":\"9"));
    let line = bake(1, "bake --task 1 other.json");
    assert!(line.starts_with("other.json: a plan of upglow 9"), "{line}");

    picture(&folder, &name(1), 0.9);
    std::fs::remove_file(folder.path().join(name(2))).unwrap();
    let (changed, end) = ("changed since the plan: SHA-256 ", "; make the plan again");
    let line = folder.run("bake --task 2 plan.json").stderr;
    assert!(line.starts_with(&format!("upglow: in/p0001.exr: {changed}")), "{line}");
    assert!(line.trim_end().ends_with(end) && line.lines().count() == 1, "{line}");
    // The others are done.
    let run = folder.run("bake --task 1-3 plan.json");
    assert_eq!((run.status, run.stderr.lines().count()), (1, 3), "{}", run.stderr);
    assert!(run.stderr.ends_with("2 of 3 pictures were not baked, named above, expected none\n"));
    assert_eq!(content(&folder.path().join("out")).len(), 1);
    let line = folder.run("lint --task 1-3 plan.json").stderr;
    assert!(line.contains("upglow: out/p0002.material.exr: not there, expected what task 3"));

    folder.done("build --preset konig2020 --resolution 3 -o cube");
    let line = bake(1, "bake --task 1 plan.json");
    assert!(line.starts_with(&format!("cube: {changed}")) && line.ends_with(end), "{line}");
}

#[test]
fn a_picture_that_cannot_be_baked_prevents_the_plan() {
    let folder = desk(2);
    folder.write("in/bad.exr", "no picture");
    let line = folder.refused(1, "bake cube in -o out --plan plan.json");
    assert!(line.starts_with("in/bad.exr: "), "{line}");
    folder.write("in/worse.png", "no picture");
    let run = folder.run("bake cube in -o out --plan plan.json");
    let end = "2 of 4 pictures cannot be baked, named above, expected none; no plan was written\n";
    assert!(run.status == 1 && run.stderr.ends_with(end), "{}", run.stderr);
    assert!(!folder.path().join("plan.json").exists());
    let line = folder.refused(1, "bake cube in/p0000.exr -o out --plan plan.txt");
    assert_eq!(line, "plan.txt: a name that ends in .txt, expected one that ends in .json");
}

#[test]
fn after_a_kill_only_what_is_missing_is_done_and_all_bytes_are_the_same() {
    const COUNT: usize = 200;
    /// Far longer than the program takes on a busy machine.
    const PATIENCE: Duration = Duration::from_secs(60);
    let folder = desk(COUNT);
    folder.done("bake cube in -o one");
    folder.done("bake cube in -o out --plan plan.json");
    let out = folder.path().join("out");
    let mut worker = Command::new(program())
        .args(["bake", "--quiet", "--task", "1-200", "plan.json"])
        .current_dir(folder.path())
        .stdout(Stdio::null())
        .spawn()
        .unwrap();
    let start = Instant::now();
    while !out.exists() || content(&out).len() < COUNT / 4 {
        assert!(start.elapsed() < PATIENCE, "the worker does not work");
        std::thread::sleep(Duration::from_millis(1));
    }
    // On Unix this is the signal 9.
    worker.kill().unwrap();
    worker.wait().unwrap();
    let done = content(&out).len();
    assert!(done < COUNT, "the worker was done before it was killed");
    assert_eq!(counts(&folder, "bake --task 1-200 plan.json"), [COUNT - done, done]);
    assert!(content(&out) == content(&folder.path().join("one")));
}

/// Runs the job of so many pictures with Open Job Description's own program.
fn run_job(count: usize, options: &str) {
    let Some(python) = python::python("openjd.cli") else {
        eprintln!("skipped: no Python with openjd-cli, see tests/farm/requirements.txt");
        return;
    };
    let folder = desk(count);
    folder.done(&format!("bake cube in -o one {options}"));
    folder.done(&format!("bake cube in -o out {options} --plan job.template.json"));
    for words in [vec!["check"], vec!["run", "--job-param"]] {
        let upglow = format!("Upglow={}", program().display());
        let parameter = (words.len() > 1).then_some(upglow);
        let output = Command::new(&python)
            .args(["-m", "openjd", words[0], "job.template.json"])
            .args(["--extensions", "TASK_CHUNKING"])
            .args(&words[1..])
            .args(parameter)
            .current_dir(folder.path())
            .output()
            .unwrap();
        let told = String::from_utf8_lossy(&output.stdout);
        assert!(output.status.success(), "{told}");
    }
    let [one, out] = ["one", "out"].map(|name| content(&folder.path().join(name)));
    assert_eq!(one.len(), count);
    assert!(one == out);
    let page = String::from_utf8(folder.read("check.html")).unwrap();
    assert!(page.contains(&format!("<title>Check of {count} pictures</title>")));
}

#[test]
fn a_job_template_bakes_lints_and_checks() {
    run_job(3, "--as spectral --bands 400:700:50");
}

#[test]
#[ignore = "takes half a minute"]
fn slow_a_job_of_a_thousand_pictures() {
    run_job(1000, "");
}
