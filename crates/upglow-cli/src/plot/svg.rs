//! Curves as an SVG figure.

use std::fmt::Display;

use upglow_svg::{Element, escape};

use super::{Curves, FIRST_NM, Figure, LAST_NM, Swatch};

const WIDTH: f64 = 900.0;
const HEIGHT: f64 = 520.0;

/// Edges of the plot.
const LEFT: f64 = 78.0;
const RIGHT: f64 = 636.0;
const TOP: f64 = 28.0;
const BOTTOM: f64 = 448.0;

/// The value at the top, above 1 so that no curve touches the frame.
const HIGHEST: f64 = 1.05;

/// Left edge of the legend and the swatches.
const SIDE: f64 = 668.0;
const SWATCH: f64 = 100.0;
const SWATCH_TOP: f64 = TOP + 122.0;

/// Longer lines of the caption would extend beyond the page.
pub(super) const CAPTION_LETTERS: usize = 31;
/// Four lines and the dyes of four materials; more would extend beyond the page.
const CAPTION_LINES: usize = 12;
const CAPTION_STEP: f64 = 18.0;

const FONT: &str = "'DejaVu Sans', Verdana, Arial, sans-serif";
pub(super) const INK: &str = "#222222";
pub(super) const FAINT: &str = "#dddddd";

/// A curve's name, color, dashes and points. Color-blind readers can tell the colors apart, and in
/// print without color the dashes.
struct Stroke {
    name: &'static str,
    color: &'static str,
    dashes: &'static str,
    points: String,
}

/// The figure as the text of an SVG file.
pub(crate) fn draw(figure: &Figure<'_>) -> String {
    let strokes = strokes(figure.curves);
    let mut elements = axes();
    if figure.curves.is_fluorescent() {
        elements.push(emission_area(figure.curves));
    }
    elements.extend(strokes.iter().map(Stroke::curve));
    elements.extend((0_u8..).zip(&strokes).flat_map(|(row, stroke)| stroke.legend(row)));
    elements.extend(swatches(figure));
    elements.extend(caption(figure));
    file([WIDTH, HEIGHT], &elements)
}

/// A file of elements on white paper.
pub(super) fn file([width, height]: [f64; 2], elements: &[String]) -> String {
    let svg = Element::new("svg")
        .with("xmlns", "http://www.w3.org/2000/svg")
        .with("width", width)
        .with("height", height)
        .with("viewBox", format_args!("0 0 {width} {height}"))
        .with("font-family", FONT)
        .with("font-size", 14)
        .with("fill", INK);
    let paper = Element::new("rect").with("width", width).with("height", height);
    let paper = paper.with("fill", "#ffffff").empty();
    svg.around(format_args!("\n{paper}\n{}\n", elements.join("\n"))) + "\n"
}

impl Stroke {
    fn curve(&self) -> String {
        Element::new("polyline")
            .with("points", &self.points)
            .with("fill", "none")
            .with("stroke", self.color)
            .with("stroke-width", 2.4)
            .with("stroke-linejoin", "round")
            .with("stroke-dasharray", self.dashes)
            .empty()
    }

    /// A line in the style of the curve and its name, beside the plot.
    fn legend(&self, row: u8) -> [String; 2] {
        let y = TOP + 12.0 + 24.0 * f64::from(row);
        let piece = line(SIDE, y, SIDE + 30.0, y, self.color)
            .with("stroke-width", 2.4)
            .with("stroke-dasharray", self.dashes);
        [piece.empty(), at("text", SIDE + 40.0, y + 5.0).around(self.name)]
    }
}

fn strokes(curves: &Curves) -> Vec<Stroke> {
    let stroke = |name, color, dashes, points| Stroke { name, color, dashes, points };
    let reflectance = points(curves.shown(&curves.reflectance));
    let mut strokes = vec![stroke("reflectance", INK, "none", reflectance)];
    if curves.is_fluorescent() {
        let absorption = points(curves.lifted(&curves.absorption));
        let emission = points(curves.lifted(&curves.emission));
        strokes.push(stroke("absorbed by dyes", "#0072b2", "9 4", absorption));
        strokes.push(stroke("emission / its peak", "#d55e00", "2.5 3", emission));
    }
    strokes
}

fn x_of(nm: f64) -> f64 {
    LEFT + (nm - FIRST_NM) / (LAST_NM - FIRST_NM) * (RIGHT - LEFT)
}

fn y_of(value: f64) -> f64 {
    BOTTOM + value / HIGHEST * (TOP - BOTTOM)
}

fn points(curve: impl Iterator<Item = (f64, f64)>) -> String {
    upglow_svg::points(curve.map(|(nm, value)| [x_of(nm), y_of(value)]), hundredths)
}

pub(super) fn hundredths(value: f64) -> String {
    format!("{value:.2}")
}

pub(super) fn at(name: &'static str, x: impl Display, y: impl Display) -> Element {
    Element::new(name).with("x", x).with("y", y)
}

pub(super) fn line(
    x1: impl Display,
    y1: impl Display,
    x2: impl Display,
    y2: impl Display,
    color: &str,
) -> Element {
    Element::new("line")
        .with("x1", x1)
        .with("y1", y1)
        .with("x2", x2)
        .with("y2", y2)
        .with("stroke", color)
}

fn emission_area(curves: &Curves) -> String {
    let area = points(curves.shown(&curves.emission));
    Element::new("polygon")
        .with("points", format_args!("{LEFT},{BOTTOM} {area} {RIGHT},{BOTTOM}"))
        .with("fill", "#d55e00")
        .with("fill-opacity", 0.08)
        .empty()
}

/// Grid, frame, ticks and names of the axes.
fn axes() -> Vec<String> {
    let mut elements = Vec::new();
    for nm in (300..=750).step_by(50) {
        let x = hundredths(x_of(f64::from(nm)));
        let number = at("text", &x, BOTTOM + 23.0).with("text-anchor", "middle");
        elements.extend([
            line(&x, TOP, &x, BOTTOM, FAINT).empty(),
            line(&x, BOTTOM, &x, BOTTOM + 6.0, INK).empty(),
            number.around(nm),
        ]);
    }
    for tenths in (0..=10).step_by(2) {
        let value = f64::from(tenths) / 10.0;
        let y = hundredths(y_of(value));
        let number = at("text", LEFT - 11.0, hundredths(y_of(value) + 5.0));
        elements.extend([
            line(LEFT, &y, RIGHT, &y, FAINT).empty(),
            line(LEFT - 6.0, &y, LEFT, &y, INK).empty(),
            number.with("text-anchor", "end").around(format_args!("{value:.1}")),
        ]);
    }
    let (middle_x, middle_y) = ((LEFT + RIGHT) / 2.0, (TOP + BOTTOM) / 2.0);
    let name_of_y = Element::new("text")
        .with("transform", format_args!("translate(24 {middle_y}) rotate(-90)"))
        .with("text-anchor", "middle");
    elements.extend([
        outlined(at("rect", LEFT, TOP), [RIGHT - LEFT, BOTTOM - TOP], INK),
        at("text", middle_x, BOTTOM + 52.0).with("text-anchor", "middle").around("wavelength / nm"),
        name_of_y.around("share of incident light; emission relative to its peak"),
    ]);
    elements
}

pub(super) fn outlined(rect: Element, [width, height]: [f64; 2], color: &str) -> String {
    rect.with("width", width)
        .with("height", height)
        .with("fill", "none")
        .with("stroke", color)
        .empty()
}

/// Target and result side by side, so that a difference is visible at their common edge.
fn swatches(figure: &Figure<'_>) -> Vec<String> {
    let pair = [("target", &figure.target, SIDE), ("material", &figure.result, SIDE + SWATCH)];
    let both = pair.into_iter().flat_map(|(name, Swatch { hex, .. }, left)| {
        let title = at("text", left + SWATCH / 2.0, SWATCH_TOP - 9.0);
        let area = at("rect", left, SWATCH_TOP).with("width", SWATCH).with("height", SWATCH);
        [
            title.with("text-anchor", "middle").around(name),
            area.with("fill", hex).with("shape-rendering", "crispEdges").empty(),
        ]
    });
    let frame = outlined(at("rect", SIDE, SWATCH_TOP), [2.0 * SWATCH, SWATCH], "#999999");
    both.chain([frame]).collect()
}

/// The lines below the swatches.
fn caption(figure: &Figure<'_>) -> Vec<String> {
    let is_outside = figure.target.is_outside || figure.result.is_outside;
    let note = is_outside.then(|| "outside sRGB, shown duller".to_owned());
    let lines = figure.caption.iter().take(CAPTION_LINES).cloned().chain(note);
    let text = |(row, line): (u8, String)| {
        let y = SWATCH_TOP + SWATCH + 26.0 + CAPTION_STEP * f64::from(row);
        at("text", SIDE, y)
            .with("font-size", 12.5)
            .around(escape(&shortened(&line, CAPTION_LETTERS)))
    };
    (0..).zip(lines).map(text).collect()
}

/// At most so many letters of a line.
pub(super) fn shortened(line: &str, letters: usize) -> String {
    if line.chars().count() <= letters {
        return line.to_owned();
    }
    line.chars().take(letters - 1).chain(['…']).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curves(emission: f64) -> Curves {
        let wavelengths_nm = vec![300.0, 500.0, 780.0, 830.0];
        Curves {
            reflectance: vec![0.5; 4],
            absorption: vec![emission / 2.0; 4],
            emission: vec![emission; 4],
            wavelengths_nm,
        }
    }

    fn figure<'c>(curves: &'c Curves, caption: &str) -> Figure<'c> {
        let swatch = Swatch { hex: "#7cbc59".into(), is_outside: false };
        Figure { curves, target: swatch.clone(), result: swatch, caption: vec![caption.into()] }
    }

    #[test]
    fn names_from_files_are_escaped_and_shortened() {
        let curves = curves(1.0);
        let svg = draw(&figure(&curves, "<script>&\u{7}"));
        assert!(svg.contains("&lt;script&gt;&amp;</text>"));
        let long = draw(&figure(&curves, &"x".repeat(100)));
        assert!(long.contains("xx…<") && !long.contains(&"x".repeat(40)));
    }

    #[test]
    fn every_point_lies_in_the_frame_and_passive_materials_have_one_curve() {
        let fluorescent = curves(1.0);
        let svg = draw(&figure(&fluorescent, "a"));
        assert_eq!(svg.matches("<polyline").count(), 3);
        let passive = curves(0.0);
        let svg = draw(&figure(&passive, "a"));
        assert_eq!(svg.matches("<polyline").count(), 1);
        assert!(svg.contains(&format!("points=\"{LEFT:.2},{:.2}", y_of(0.5))), "{svg}");
        assert!(!svg.contains("NaN"));
    }
}
