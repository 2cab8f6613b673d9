//! Curves as an SVG figure.

use std::fmt::Write as _;

use super::{Curves, FIRST_NM, Figure, LAST_NM, Swatch};

const WIDTH: f64 = 900.0;
const HEIGHT: f64 = 520.0;

/// Edges of the plot.
const LEFT: f64 = 78.0;
const RIGHT: f64 = 636.0;
const TOP: f64 = 28.0;
const BOTTOM: f64 = 448.0;

/// The value at the top: curves that reach 1 do not touch the frame.
const HIGHEST: f64 = 1.05;

/// Left edge of the legend and the swatches.
const SIDE: f64 = 668.0;
const SWATCH: f64 = 100.0;

/// Longer lines of the caption would leave the page at the font's usual width.
const CAPTION_LETTERS: usize = 31;
/// Four lines and the dyes of four materials; more would leave the page.
const CAPTION_LINES: usize = 12;
const CAPTION_STEP: f64 = 18.0;

const FONT: &str = "'DejaVu Sans', Verdana, Arial, sans-serif";
const INK: &str = "#222222";
const FAINT: &str = "#dddddd";

/// A curve's name, color, dashes and points. Colors keep apart for color-blind readers, dashes in
/// print without color.
struct Stroke {
    name: &'static str,
    color: &'static str,
    dashes: &'static str,
    points: String,
}

/// The figure as the text of an SVG file.
pub(crate) fn draw(figure: &Figure<'_>) -> String {
    let strokes = strokes(figure.curves);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{WIDTH}\" height=\"{HEIGHT}\" \
         viewBox=\"0 0 {WIDTH} {HEIGHT}\" font-family=\"{FONT}\" font-size=\"14\" fill=\"{INK}\">\n\
         <rect width=\"{WIDTH}\" height=\"{HEIGHT}\" fill=\"#ffffff\"/>\n"
    );
    svg += &axes();
    if figure.curves.is_fluorescent() {
        svg += &emission_area(figure.curves);
    }
    for stroke in &strokes {
        let _ = writeln!(
            svg,
            "<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"2.4\" \
             stroke-linejoin=\"round\" stroke-dasharray=\"{}\"/>",
            stroke.points, stroke.color, stroke.dashes
        );
    }
    svg += &legend(&strokes);
    svg += &swatches(figure);
    svg + "</svg>\n"
}

fn strokes(curves: &Curves) -> Vec<Stroke> {
    let stroke = |name, color, dashes, points| Stroke { name, color, dashes, points };
    let reflectance = points(curves.shown(&curves.reflectance));
    let mut strokes = vec![stroke("reflectance (1 − c·a)·r", INK, "none", reflectance)];
    if curves.is_fluorescent() {
        let absorption = points(curves.lifted(&curves.absorption));
        let emission = points(curves.lifted(&curves.emission));
        strokes.push(stroke("absorption c·a", "#0072b2", "9 4", absorption));
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
    let point = |(nm, value)| format!("{:.2},{:.2}", x_of(nm), y_of(value));
    curve.map(point).collect::<Vec<_>>().join(" ")
}

fn emission_area(curves: &Curves) -> String {
    let area = points(curves.shown(&curves.emission));
    format!(
        "<polygon points=\"{LEFT},{BOTTOM} {area} {RIGHT},{BOTTOM}\" fill=\"#d55e00\" fill-opacity=\"0.08\"/>\n"
    )
}

/// Grid, frame, ticks and names of the axes.
fn axes() -> String {
    let mut svg = String::new();
    for nm in (300..=750).step_by(50) {
        let x = x_of(f64::from(nm));
        let _ = writeln!(
            svg,
            "<line x1=\"{x:.2}\" y1=\"{TOP}\" x2=\"{x:.2}\" y2=\"{BOTTOM}\" stroke=\"{FAINT}\"/>\n\
             <line x1=\"{x:.2}\" y1=\"{BOTTOM}\" x2=\"{x:.2}\" y2=\"{}\" stroke=\"{INK}\"/>\n\
             <text x=\"{x:.2}\" y=\"{}\" text-anchor=\"middle\">{nm}</text>",
            BOTTOM + 6.0,
            BOTTOM + 23.0
        );
    }
    for tenths in (0..=10).step_by(2) {
        let (value, y) = (f64::from(tenths) / 10.0, y_of(f64::from(tenths) / 10.0));
        let _ = writeln!(
            svg,
            "<line x1=\"{LEFT}\" y1=\"{y:.2}\" x2=\"{RIGHT}\" y2=\"{y:.2}\" stroke=\"{FAINT}\"/>\n\
             <line x1=\"{}\" y1=\"{y:.2}\" x2=\"{LEFT}\" y2=\"{y:.2}\" stroke=\"{INK}\"/>\n\
             <text x=\"{}\" y=\"{:.2}\" text-anchor=\"end\">{value:.1}</text>",
            LEFT - 6.0,
            LEFT - 11.0,
            y + 5.0
        );
    }
    let (middle_x, middle_y) = ((LEFT + RIGHT) / 2.0, (TOP + BOTTOM) / 2.0);
    let _ = writeln!(
        svg,
        "<rect x=\"{LEFT}\" y=\"{TOP}\" width=\"{}\" height=\"{}\" fill=\"none\" stroke=\"{INK}\"/>\n\
         <text x=\"{middle_x}\" y=\"{}\" text-anchor=\"middle\">wavelength / nm</text>\n\
         <text transform=\"translate(24 {middle_y}) rotate(-90)\" text-anchor=\"middle\">share of incident light; emission relative to its peak</text>",
        RIGHT - LEFT,
        BOTTOM - TOP,
        BOTTOM + 52.0
    );
    svg
}

fn legend(strokes: &[Stroke]) -> String {
    let mut svg = String::new();
    for (row, stroke) in (0_u8..).zip(strokes) {
        let y = TOP + 12.0 + 24.0 * f64::from(row);
        let _ = writeln!(
            svg,
            "<line x1=\"{SIDE}\" y1=\"{y}\" x2=\"{}\" y2=\"{y}\" stroke=\"{}\" stroke-width=\"2.4\" stroke-dasharray=\"{}\"/>\n\
             <text x=\"{}\" y=\"{}\">{}</text>",
            SIDE + 30.0,
            stroke.color,
            stroke.dashes,
            SIDE + 40.0,
            y + 5.0,
            stroke.name
        );
    }
    svg
}

/// Target and result side by side, so that a difference shows at their common edge.
fn swatches(figure: &Figure<'_>) -> String {
    let top = TOP + 122.0;
    let mut svg = String::new();
    let pair = [("target", &figure.target, 0.0), ("material", &figure.result, SWATCH)];
    for (name, Swatch { hex, .. }, offset) in pair {
        let _ = writeln!(
            svg,
            "<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{name}</text>\n\
             <rect x=\"{}\" y=\"{top}\" width=\"{SWATCH}\" height=\"{SWATCH}\" fill=\"{hex}\" shape-rendering=\"crispEdges\"/>",
            SIDE + offset + SWATCH / 2.0,
            top - 9.0,
            SIDE + offset
        );
    }
    let _ = writeln!(
        svg,
        "<rect x=\"{SIDE}\" y=\"{top}\" width=\"{}\" height=\"{SWATCH}\" fill=\"none\" stroke=\"#999999\"/>",
        2.0 * SWATCH
    );
    let clipped = figure.target.clipped || figure.result.clipped;
    let note = clipped.then(|| "outside sRGB, shown clipped".to_owned());
    let lines = figure.caption.iter().take(CAPTION_LINES).cloned().chain(note);
    for (row, line) in (0_u8..).zip(lines) {
        let y = top + SWATCH + 26.0 + CAPTION_STEP * f64::from(row);
        let text = escaped(&shortened(&line));
        let _ = writeln!(svg, "<text x=\"{SIDE}\" y=\"{y}\" font-size=\"12.5\">{text}</text>");
    }
    svg
}

fn shortened(line: &str) -> String {
    if line.chars().count() <= CAPTION_LETTERS {
        return line.to_owned();
    }
    line.chars().take(CAPTION_LETTERS - 1).chain(['…']).collect()
}

/// Text as XML holds it; control characters, which it cannot hold, are left out.
fn escaped(text: &str) -> String {
    let plain: String = text.chars().filter(|c| !c.is_control()).collect();
    plain.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;
    use upglow_color::LinearRgb;

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
        let swatch = Swatch::from_linear(LinearRgb([0.2, 0.5, 0.1]));
        Figure { curves, target: swatch.clone(), result: swatch, caption: vec![caption.into()] }
    }

    #[test]
    fn names_from_files_are_escaped_and_cut() {
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
