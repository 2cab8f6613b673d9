//! Colors under lights as an SVG figure: a row for each color, a column for each light.

use upglow_svg::{Element, escape};

use super::Swatch;
use super::svg::{at, file, outlined, shortened};

/// The figure and its texts.
#[derive(Clone, Debug)]
pub(crate) struct Chart {
    pub(crate) title: String,
    /// A name for each row.
    pub(crate) rows: Vec<String>,
    pub(crate) columns: Vec<Column>,
    /// Lines at the foot.
    pub(crate) notes: Vec<String>,
}

/// A light and how the color of each row looks under it.
#[derive(Clone, Debug)]
pub(crate) struct Column {
    /// The light, the observer, and other lines above the swatches.
    pub(crate) head: Vec<String>,
    pub(crate) swatches: Vec<Swatch>,
}

const MARGIN: f64 = 20.0;
/// Width of the names of rows.
const NAMES: f64 = 190.0;
/// Longer names would extend into the swatches.
const NAME_LETTERS: usize = 26;
/// Longer lines above a column would extend into the next.
const HEAD_LETTERS: usize = 15;
const SMALL: f64 = 12.0;
const LINE: f64 = 17.0;
const WIDTH: f64 = 110.0;
const HEIGHT: f64 = 44.0;
/// Sides of the mark of a color outside sRGB, a triangle in a corner.
const MARK: f64 = 13.0;
/// Narrower pages would cut the title and the notes.
const LEAST_WIDTH: f64 = 670.0;

/// The chart as the text of an SVG file.
pub(crate) fn draw(chart: &Chart) -> String {
    let lines = chart.columns.iter().map(|column| column.head.len()).max().unwrap_or(0);
    let top = MARGIN + 34.0 + LINE * count(lines);
    let bottom = top + HEIGHT * count(chart.rows.len());
    let left = MARGIN + NAMES;
    let mut elements = vec![at("text", MARGIN, MARGIN + 12.0).around(escape(&chart.title))];
    for (i, name) in chart.rows.iter().enumerate() {
        let y = top + HEIGHT * (count(i) + 0.5) + 4.0;
        elements.push(small(MARGIN, y).around(escape(&shortened(name, NAME_LETTERS))));
    }
    let mut is_outside = false;
    for (k, column) in chart.columns.iter().enumerate() {
        let x = left + WIDTH * count(k);
        for (i, line) in column.head.iter().enumerate() {
            let y = top - 9.0 - LINE * count(lines - 1 - i);
            elements.push(small(x + 2.0, y).around(escape(&shortened(line, HEAD_LETTERS))));
        }
        for (i, swatch) in column.swatches.iter().enumerate() {
            let y = top + HEIGHT * count(i);
            let area = at("rect", x, y).with("width", WIDTH).with("height", HEIGHT);
            let area = area.with("fill", &swatch.hex).with("shape-rendering", "crispEdges");
            elements.push(area.empty());
            if swatch.is_outside {
                elements.push(mark(x + WIDTH, y));
                is_outside = true;
            }
        }
    }
    let width = WIDTH * count(chart.columns.len());
    elements.push(outlined(at("rect", left, top), [width, bottom - top], "#999999"));
    let mut y = bottom + 24.0;
    if is_outside {
        elements.push(mark(MARGIN + MARK, y - 10.0));
        elements.push(small(MARGIN + MARK + 8.0, y).around("outside sRGB, shown duller"));
        y += LINE;
    }
    for note in &chart.notes {
        elements.push(small(MARGIN, y).around(escape(note)));
        y += LINE;
    }
    file([(left + width + MARGIN).max(LEAST_WIDTH), y + 2.0], &elements)
}

fn small(x: f64, y: f64) -> Element {
    at("text", x, y).with("font-size", SMALL)
}

/// The mark of a color outside sRGB, whose upper right corner is given; it can be seen on any color.
fn mark(right: f64, y: f64) -> String {
    let corners = [[right - MARK, y], [right, y], [right, y + MARK]];
    Element::new("polygon")
        .with("points", upglow_svg::points(corners, |v| v.to_string()))
        .with("fill", "#ffffff")
        .with("stroke", "#222222")
        .empty()
}

/// A number of rows or columns.
fn count(number: usize) -> f64 {
    number as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    fn chart(is_outside: bool) -> Chart {
        let column = |name: &str| Column {
            head: vec![name.into(), "seen from D65".into()],
            swatches: vec![Swatch { hex: "#7cbc59".into(), is_outside }],
        };
        Chart {
            title: "a < b".into(),
            rows: vec!["x".repeat(40)],
            columns: vec![column("D65"), column("A")],
            notes: vec!["the first 1 of 2 colors".into()],
        }
    }

    #[test]
    fn each_color_under_each_light_is_a_swatch_and_those_outside_are_marked() {
        let inside = draw(&chart(false));
        // Paper, frame and two swatches.
        assert_eq!(inside.matches("<rect").count(), 4);
        assert!(!inside.contains("polygon") && !inside.contains("outside"));
        let outside = draw(&chart(true));
        // The third explains the two.
        assert_eq!(outside.matches("<polygon").count(), 3);
        assert!(outside.contains("outside sRGB, shown duller"));
    }

    #[test]
    fn names_are_escaped_and_shortened_and_the_notes_are_said() {
        let svg = draw(&chart(false));
        assert!(svg.contains("a &lt; b") && svg.contains("xx…<"), "{svg}");
        assert!(svg.contains("the first 1 of 2 colors") && svg.contains("seen from D65"));
    }
}
