//! The figures are complete, well-formed, readable and reproducible.

use std::sync::{Arc, OnceLock};

use crate::cubes::Cubes;
use crate::figures::{Display, Figure, figures};
use crate::raster::rendered;
use resvg::usvg::{self, Node, Rect, Tree, fontdb};
use upglow_fit::{Progress, Unwatched, Watch};

/// Small enough to build every cube in seconds.
const RESOLUTION: usize = 4;

fn all() -> &'static [Figure] {
    static ALL: OnceLock<Vec<Figure>> = OnceLock::new();
    ALL.get_or_init(|| {
        figures(&Cubes::new(RESOLUTION), None, Display::AsSrgb, &Unwatched)
            .expect("the resolution is in range")
    })
}

fn parsed(figure: &Figure) -> Tree {
    let mut faces = fontdb::Database::new();
    for face in [
        damascene_fonts_roboto::ROBOTO_REGULAR,
        damascene_fonts_roboto::ROBOTO_BOLD,
        damascene_fonts_roboto::ROBOTO_ITALIC,
    ] {
        faces.load_font_data(face.to_vec());
    }
    let options = usvg::Options { fontdb: Arc::new(faces), ..usvg::Options::default() };
    Tree::from_str(&figure.svg, &options).expect("it is well-formed")
}

/// Each text with its bounding box.
fn texts(group: &usvg::Group) -> Vec<(String, Rect)> {
    let mut found = Vec::new();
    for node in group.children() {
        match node {
            Node::Group(inner) => found.extend(texts(inner)),
            Node::Text(text) => {
                let words: String = text.chunks().iter().map(usvg::TextChunk::text).collect();
                found.push((words, text.flattened().abs_bounding_box()));
            }
            _ => {}
        }
    }
    found
}

#[test]
fn there_are_ten_in_order_with_captions() {
    let numbers: Vec<u32> = all().iter().map(|figure| figure.number).collect();
    assert_eq!(numbers, (1..=10).collect::<Vec<_>>());
    for figure in all() {
        assert!(figure.name.starts_with(&format!("figure-{:02}-", figure.number)));
        assert!(figure.caption.ends_with('.') && figure.caption.chars().any(char::is_numeric));
        assert!(!figure.caption.contains("NaN"), "{}", figure.caption);
    }
}

#[test]
fn every_figure_is_well_formed_and_170_mm_wide() {
    for figure in all() {
        let document = roxmltree::Document::parse(&figure.svg).unwrap();
        let root = document.root_element();
        assert_eq!(root.tag_name().name(), "svg");
        assert_eq!(root.attribute("width"), Some("170mm"), "{}", figure.name);
        for attribute in document.descendants().flat_map(|node| node.attributes()) {
            let is_number = !attribute.value().contains("NaN") && attribute.value() != "inf";
            assert!(attribute.name() == "href" || is_number, "{}: {attribute:?}", figure.name);
        }
    }
}

#[test]
fn no_text_leaves_the_page_or_overlaps_another() {
    for figure in all() {
        let tree = parsed(figure);
        let texts = texts(tree.root());
        assert!(!texts.is_empty(), "{}", figure.name);
        for (i, (words, ink)) in texts.iter().enumerate() {
            let is_inside = ink.left() >= 0.0
                && ink.top() >= 0.0
                && ink.right() <= tree.size().width()
                && ink.bottom() <= tree.size().height();
            assert!(is_inside, "{}: {words:?} at {ink:?}", figure.name);
            for (other, other_ink) in &texts[..i] {
                let apart = ink.right() <= other_ink.left()
                    || other_ink.right() <= ink.left()
                    || ink.bottom() <= other_ink.top()
                    || other_ink.bottom() <= ink.top();
                assert!(apart, "{}: {words:?} overlaps {other:?}", figure.name);
            }
        }
    }
}

#[test]
fn figures_are_reproducible() {
    let again = figures(&Cubes::new(RESOLUTION), None, Display::AsSrgb, &Unwatched).unwrap();
    assert_eq!(again, all());
    for figure in [&again[3], &again[8]] {
        assert_eq!(rendered(&figure.svg, 1.0), rendered(&figure.svg, 1.0), "{}", figure.name);
    }
}

#[test]
fn a_picture_has_the_size_of_its_scale() {
    // 170 mm at 96 pixels to an inch.
    let [small, large] = [1.0, 2.0].map(|scale| width(&rendered(&all()[3].svg, scale)));
    assert!((642..=643).contains(&small) && (1284..=1286).contains(&large), "{small}, {large}");
}

#[test]
fn a_figure_drawn_alone_is_the_same() {
    let one = figures(&Cubes::new(RESOLUTION), Some(4), Display::AsSrgb, &Unwatched).unwrap();
    assert_eq!(one, all()[3..4]);
}

#[test]
fn a_correct_display_changes_the_colors_of_layers() {
    let correct = figures(&Cubes::new(RESOLUTION), Some(5), Display::Correct, &Unwatched).unwrap();
    assert_ne!(correct[0].svg, all()[4].svg);
}

#[test]
fn a_stopped_watcher_stops_the_work() {
    struct Stopped;
    impl Watch for Stopped {
        fn progress(&self, _: Progress) {}

        fn stopped(&self) -> bool {
            true
        }
    }
    let stopped = figures(&Cubes::new(RESOLUTION), None, Display::AsSrgb, &Stopped);
    assert_eq!(stopped.unwrap_err().to_string(), "stopped");
}

/// Width in a PNG's header.
fn width(png: &[u8]) -> u32 {
    u32::from_be_bytes(png[16..20].try_into().expect("four bytes"))
}
