//! The program on small cubes.
#![expect(clippy::unwrap_used, reason = "a test that cannot start has failed")]

use std::path::Path;
use std::process::Output;

use assert_cmd::Command;

/// Runs the program in a folder with these arguments, separated by blanks.
fn run(folder: &Path, words: &str) -> Output {
    let mut program = Command::new(assert_cmd::cargo::cargo_bin!("upglow-study"));
    program.args(words.split_whitespace()).current_dir(folder).output().unwrap()
}

/// Standard output of a run that must succeed and print nothing to standard error.
fn done(folder: &Path, words: &str) -> String {
    let Output { status, stdout, stderr } = run(folder, words);
    assert!(status.success() && stderr.is_empty(), "{words}");
    String::from_utf8(stdout).unwrap()
}

/// Standard error of a run that must fail with this status and write no file.
fn refused(folder: &Path, expected: i32, words: &str) -> String {
    let Output { status, stdout, stderr } = run(folder, words);
    assert_eq!((status.code(), &stdout[..]), (Some(expected), &b""[..]), "{words}");
    assert_eq!(folder.read_dir().unwrap().count(), 0, "{words}");
    String::from_utf8(stderr).unwrap()
}

fn read(folder: &Path, name: &str) -> Vec<u8> {
    std::fs::read(folder.join(name)).unwrap()
}

#[test]
fn a_figure_is_written_as_svg_and_png_and_is_reproducible() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for out in ["a", "b"] {
        done(folder, &format!("figures --only 4 --resolution 4 --out {out}"));
    }
    for name in ["figure-04-features.svg", "figure-04-features.png"] {
        let drawn = read(folder, &format!("a/{name}"));
        assert!(drawn.len() > 1000, "{name}");
        assert_eq!(drawn, read(folder, &format!("b/{name}")), "{name}");
    }
}

#[test]
fn a_figure_of_an_unknown_number_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    for number in [0, 11] {
        let refused = refused(folder, 2, &format!("figures --only {number} --resolution 4"));
        let expected = "expected a whole number from 1 to 10";
        assert_eq!(refused, format!("upglow-study: --only: {number}, {expected}\n"));
    }
}

#[test]
fn the_report_is_the_same_in_the_file_and_on_standard_output() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    let printed = done(folder, "reproduce --resolution 5 -o report.md");
    assert_eq!(printed.as_bytes(), read(folder, "report.md"));
    assert!(printed.starts_with("# The paper's claims, measured"));
}

#[test]
fn measured_materials_that_cannot_be_read_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let report = |measured: &Path| {
        let words = format!("reproduce --resolution 4 --bispectral {}", measured.display());
        refused(folder.path(), 1, &words)
    };
    let measured = tempfile::tempdir().unwrap();
    let name = measured.path().display().to_string();
    assert_eq!(
        report(measured.path()),
        format!("upglow-study: {name}: no file .BFC, expected BFC-450 matrices\n")
    );
    std::fs::write(measured.path().join("a.bfc"), "VEC_01\nCSV\n").unwrap();
    let message = report(measured.path());
    let expected = r#"a.bfc: line 2 is "CSV", expected BFC-450 Matrix File"#;
    assert!(
        message.ends_with(&format!("{expected}\n")) && message.lines().count() == 1,
        "{message}"
    );
    let message = report(&measured.path().join("absent"));
    assert!(message.contains("expected a folder of BFC-450 matrices"), "{message}");
}

#[test]
fn the_claims_are_printed_as_one_json_document() {
    let folder = tempfile::tempdir().unwrap();
    let printed = done(folder.path(), "reproduce --resolution 4 --json");
    assert!(
        printed.starts_with(
            r#"{"resolution":4,"measured":[],"claims":[{"id":"metric-time","section":"#
        )
    );
    assert_eq!(printed.matches('\n').count(), 1);
}

#[test]
fn surfaces_under_other_lights_are_tables_or_one_json_document() {
    let folder = tempfile::tempdir().unwrap();
    let printed = done(folder.path(), "relight --only natural --only jung2019");
    let rows = printed.lines().filter(|line| line.starts_with("| natural |"));
    assert_eq!(rows.count(), 2, "{printed}");
    let printed = done(folder.path(), "relight --json --only natural");
    assert!(printed.starts_with(r#"{"sets":[{"samples":"99 object colors","count":99,"#));
    assert_eq!(printed.matches('\n').count(), 1);
    let message = refused(folder.path(), 1, "relight --bispectral absent");
    assert!(message.contains("expected a folder of BFC-450 matrices"), "{message}");
    let message = refused(folder.path(), 2, "relight --only neutral");
    let expected =
        "--only: unknown way \"neutral\", expected one of: natural; konig2020; jung2019;";
    assert!(message.contains(expected), "{message}");
}

#[test]
fn the_effects_of_the_rule_do_not_depend_on_the_number_of_threads() {
    let folder = tempfile::tempdir().unwrap();
    let [one, two] = [1, 2].map(|threads| {
        let words = format!("rule --resolution 4 --nodes 3 --colors 100 --threads {threads}");
        done(folder.path(), &words)
    });
    assert!(one.contains("| fitted by themselves | "), "{one}");
    assert_eq!(one, two);
    let refused = refused(folder.path(), 2, "rule --resolution 1");
    assert_eq!(refused, "upglow-study: --resolution: 1, expected a whole number from 2 to 256\n");
}
