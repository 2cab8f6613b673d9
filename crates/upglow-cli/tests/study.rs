//! The seed paper's figures and claims, on small cubes.

mod support;

use support::Folder;

#[test]
fn a_figure_is_written_as_svg_and_png_and_is_the_same_twice() {
    let folder = Folder::new();
    for out in ["a", "b"] {
        folder.done(&format!("figures --only 4 --resolution 4 --out {out}"));
    }
    for name in ["figure-04-features.svg", "figure-04-features.png"] {
        let drawn = folder.read(&format!("a/{name}"));
        assert!(drawn.len() > 1000, "{name}");
        assert_eq!(drawn, folder.read(&format!("b/{name}")), "{name}");
    }
}

#[test]
fn a_figure_that_is_not_there_is_refused() {
    let folder = Folder::new();
    let refused = folder.refused(2, "figures --only 11 --resolution 4");
    assert_eq!(refused, "--only: figure 11, expected 1 to 10");
}

#[test]
fn the_report_is_the_same_on_paper_and_on_the_screen() {
    let folder = Folder::new();
    let printed = folder.done("reproduce --resolution 5 -o report.md");
    assert_eq!(printed.as_bytes(), folder.read("report.md"));
    assert!(printed.starts_with("# The paper's claims, measured"));
}
