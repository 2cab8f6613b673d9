//! Drawings in millimeters, written as SVG.

mod frame;
mod palette;
mod text;

use std::fmt::Write as _;

pub(crate) use frame::{Axis, Frame};
pub(crate) use palette::{
    ABSORPTION, EMISSION, INK, MUTED, STANDINGS, WEIGHTS, byte, error_color, hex,
};
pub(crate) use text::{Anchor, Text};

use crate::fonts::FONT_STACK;
use crate::raster::base64;

/// Width of every figure: the text width of a journal's page.
pub(crate) const PAGE_MM: f64 = 170.0;

/// A rectangle on the page, mm from its top left corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Rect {
    pub(crate) left: f64,
    pub(crate) top: f64,
    pub(crate) width: f64,
    pub(crate) height: f64,
}

impl Rect {
    pub(crate) fn bottom(self) -> f64 {
        self.top + self.height
    }

    pub(crate) fn center(self) -> [f64; 2] {
        [self.left + self.width / 2.0, self.top + self.height / 2.0]
    }
}

/// How a line is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Stroke {
    pub(crate) color: &'static str,
    pub(crate) width_mm: f64,
    /// Lengths of dashes and gaps, mm; empty for a solid line.
    pub(crate) dashes: &'static str,
}

impl Stroke {
    /// Frames and ticks.
    pub(crate) const AXIS: Self = Self::solid(INK, 0.2);

    pub(crate) const fn solid(color: &'static str, width_mm: f64) -> Self {
        Self { color, width_mm, dashes: "" }
    }

    pub(crate) const fn dashed(self, dashes: &'static str) -> Self {
        Self { dashes, ..self }
    }

    fn attributes(self) -> String {
        let Self { color, width_mm, dashes } = self;
        let dashes = match dashes {
            "" => String::new(),
            some => format!(" stroke-dasharray=\"{some}\""),
        };
        format!("fill=\"none\" stroke=\"{color}\" stroke-width=\"{}\"{dashes}", number(width_mm))
    }
}

/// A page that things are drawn on, one above the other.
#[derive(Clone, Debug)]
pub(crate) struct Drawing {
    height_mm: f64,
    body: String,
    clips: usize,
}

impl Drawing {
    pub(crate) fn new(height_mm: f64) -> Self {
        Self { height_mm, body: String::new(), clips: 0 }
    }

    /// The SVG file.
    pub(crate) fn finish(self, title: &str, description: &str) -> String {
        let (width, height) = (number(PAGE_MM), number(self.height_mm));
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}mm\" height=\"{height}mm\" \
             viewBox=\"0 0 {width} {height}\" font-family=\"{FONT_STACK}\" fill=\"{INK}\" \
             stroke-linejoin=\"round\" role=\"img\">\n<title>{}</title>\n<desc>{}</desc>\n\
             <rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>\n{}</svg>\n",
            escape(title),
            escape(description),
            self.body
        )
    }

    pub(crate) fn line(&mut self, from: [f64; 2], to: [f64; 2], stroke: Stroke) {
        self.polyline([from, to], stroke);
    }

    pub(crate) fn polyline(&mut self, at: impl IntoIterator<Item = [f64; 2]>, stroke: Stroke) {
        let points = points(at);
        self.put(format_args!("<polyline points=\"{points}\" {}/>", stroke.attributes()));
    }

    pub(crate) fn polygon(
        &mut self,
        at: impl IntoIterator<Item = [f64; 2]>,
        fill: &str,
        opacity: f64,
    ) {
        let (points, opacity) = (points(at), number(opacity));
        self.put(format_args!(
            "<polygon points=\"{points}\" fill=\"{fill}\" fill-opacity=\"{opacity}\"/>"
        ));
    }

    pub(crate) fn fill(&mut self, rect: Rect, fill: &str) {
        let [x, y, w, h] = [rect.left, rect.top, rect.width, rect.height].map(number);
        self.put(format_args!(
            "<rect x=\"{x}\" y=\"{y}\" width=\"{w}\" height=\"{h}\" fill=\"{fill}\"/>"
        ));
    }

    pub(crate) fn outline(&mut self, rect: Rect, stroke: Stroke) {
        let [x, y, w, h] = [rect.left, rect.top, rect.width, rect.height].map(number);
        let stroke = stroke.attributes();
        self.put(format_args!("<rect x=\"{x}\" y=\"{y}\" width=\"{w}\" height=\"{h}\" {stroke}/>"));
    }

    pub(crate) fn dot(&mut self, at: [f64; 2], radius_mm: f64, fill: &str, stroke: Stroke) {
        let ([x, y], r) = (at.map(number), number(radius_mm));
        self.put(format_args!("<circle cx=\"{x}\" cy=\"{y}\" r=\"{r}\" fill=\"{fill}\"/>"));
        let stroke = stroke.attributes();
        self.put(format_args!("<circle cx=\"{x}\" cy=\"{y}\" r=\"{r}\" {stroke}/>"));
    }

    /// A line with a filled head at either end.
    pub(crate) fn double_arrow(&mut self, from: [f64; 2], to: [f64; 2], stroke: Stroke) {
        const HEAD_MM: [f64; 2] = [1.6, 0.55];
        let along = [to[0] - from[0], to[1] - from[1]];
        let length = along[0].hypot(along[1]);
        let [u, v] = along.map(|c| c / length);
        let inset = |tip: [f64; 2], sign: f64| {
            [tip[0] + sign * HEAD_MM[0] * u, tip[1] + sign * HEAD_MM[0] * v]
        };
        self.line(inset(from, 1.0), inset(to, -1.0), stroke);
        for (tip, sign) in [(from, 1.0), (to, -1.0)] {
            let [x, y] = inset(tip, sign);
            let (dx, dy) = (-v * HEAD_MM[1], u * HEAD_MM[1]);
            self.polygon([tip, [x + dx, y + dy], [x - dx, y - dy]], stroke.color, 1.0);
        }
    }

    /// Cells of one color each, `[row][column]` from the top left, that fill `rect`.
    pub(crate) fn cells(&mut self, rect: Rect, size: [usize; 2], colors: &[[u8; 3]]) {
        // Where cells only meet, antialiasing lets the page shine through: each reaches under those
        // that come after it.
        const OVERLAP: f64 = 0.5;
        let [columns, rows] = size;
        let [x, y] = [rect.left, rect.top].map(number);
        let [u, v] = [rect.width / columns as f64, rect.height / rows as f64].map(number_fine);
        self.put(format_args!("<g transform=\"translate({x} {y}) scale({u} {v})\">"));
        for (row, line) in colors.chunks(columns).enumerate() {
            for (start, length) in runs(line) {
                let last = start + length == columns;
                let width = length as f64 + if last { 0.0 } else { OVERLAP };
                let height = 1.0 + if row + 1 == rows { 0.0 } else { OVERLAP };
                let (width, height, fill) = (number(width), number(height), hex(line[start]));
                self.put(format_args!(
                    "<path d=\"M{start} {row}h{width}v{height}h-{width}z\" fill=\"{fill}\"/>"
                ));
            }
        }
        self.put(format_args!("</g>"));
    }

    /// A PNG picture stretched over `rect`, its pixels sharp.
    pub(crate) fn pixels(&mut self, rect: Rect, png: &[u8]) {
        let [x, y, w, h] = [rect.left, rect.top, rect.width, rect.height].map(number);
        let data = base64(png);
        self.put(format_args!(
            "<image x=\"{x}\" y=\"{y}\" width=\"{w}\" height=\"{h}\" preserveAspectRatio=\"none\" \
             style=\"image-rendering:pixelated\" href=\"data:image/png;base64,{data}\"/>"
        ));
    }

    /// What `draw` draws, cut off at the edges of `rect`.
    pub(crate) fn clipped(&mut self, rect: Rect, draw: impl FnOnce(&mut Self)) {
        let id = self.clips;
        self.clips += 1;
        let [x, y, w, h] = [rect.left, rect.top, rect.width, rect.height].map(number);
        self.put(format_args!(
            "<clipPath id=\"clip{id}\"><rect x=\"{x}\" y=\"{y}\" width=\"{w}\" height=\"{h}\"/>\
             </clipPath>\n<g clip-path=\"url(#clip{id})\">"
        ));
        draw(self);
        self.put(format_args!("</g>"));
    }

    pub(crate) fn text(&mut self, text: &Text<'_>) {
        self.put(format_args!("{}", text.to_svg()));
    }

    fn put(&mut self, element: std::fmt::Arguments<'_>) {
        writeln!(self.body, "{element}").expect("a string takes any text");
    }
}

/// Start and length of each run of equal colors.
fn runs(line: &[[u8; 3]]) -> Vec<(usize, usize)> {
    let mut start = 0;
    line.chunk_by(|a, b| a == b)
        .map(|run| {
            let found = (start, run.len());
            start += run.len();
            found
        })
        .collect()
}

fn points(at: impl IntoIterator<Item = [f64; 2]>) -> String {
    let point = |[x, y]: [f64; 2]| format!("{},{}", number(x), number(y));
    at.into_iter().map(point).collect::<Vec<_>>().join(" ")
}

/// A length to a hundredth of a millimeter, the same text everywhere.
pub(crate) fn number(value: f64) -> String {
    trimmed(format!("{value:.2}"))
}

/// A factor that lengths are multiplied by.
fn number_fine(value: f64) -> String {
    trimmed(format!("{value:.5}"))
}

fn trimmed(text: String) -> String {
    let short = text.trim_end_matches('0').trim_end_matches('.');
    if short == "-0" { "0".into() } else { short.into() }
}

/// Text as XML holds it.
pub(crate) fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_have_no_negative_zero() {
        assert_eq!(number(1.5), "1.5");
        assert_eq!(number(120.0), "120");
        assert_eq!(number(-0.001), "0");
        assert_eq!(number(-2.345_67), "-2.35");
    }

    #[test]
    fn equal_neighbors_make_one_run() {
        let (a, b) = ([0, 0, 0], [9, 9, 9]);
        assert_eq!(runs(&[a, a, b, a]), [(0, 2), (2, 1), (3, 1)]);
    }
}
