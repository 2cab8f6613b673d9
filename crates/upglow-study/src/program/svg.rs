//! Drawings in millimeters, as SVG.

mod frame;
mod palette;
mod text;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD as BASE64;
use upglow_svg::{Element, escape, hex, points};

pub(crate) use frame::{Axis, Frame};
pub(crate) use palette::{ABSORPTION, EMISSION, INK, MUTED, STANDINGS, WEIGHTS, error_color};
pub(crate) use text::{Anchor, Text};

/// Width of every figure: the text width of a journal's page.
pub(crate) const PAGE_MM: f64 = 170.0;

/// The typeface of the PNG files first, then common fonts for viewers of the SVG files.
const FONT_STACK: &str = "Roboto, 'Helvetica Neue', Helvetica, Arial, sans-serif";

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

    /// An element of this size and position.
    fn place(self, name: &'static str) -> Element {
        let Self { left, top, width, height } = self;
        let sides = [("x", left), ("y", top), ("width", width), ("height", height)];
        Element::new(name).with_all(sides.map(|(side, mm)| (side, number(mm))))
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

    /// Draws an element as a line without filling it.
    fn draw(self, element: Element) -> Element {
        element
            .with("fill", "none")
            .with("stroke", self.color)
            .with("stroke-width", number(self.width_mm))
            .with_some("stroke-dasharray", Some(self.dashes).filter(|dashes| !dashes.is_empty()))
    }
}

/// A page; what is drawn later covers what was drawn before.
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
        let content = [
            String::new(),
            Element::new("title").around(escape(title)),
            Element::new("desc").around(escape(description)),
            Element::new("rect")
                .with("width", &width)
                .with("height", &height)
                .with("fill", "#ffffff")
                .empty(),
            self.body,
        ];
        let svg = Element::new("svg")
            .with("xmlns", "http://www.w3.org/2000/svg")
            .with("width", format_args!("{width}mm"))
            .with("height", format_args!("{height}mm"))
            .with("viewBox", format_args!("0 0 {width} {height}"))
            .with("font-family", FONT_STACK)
            .with("fill", INK)
            .with("stroke-linejoin", "round")
            .with("role", "img");
        svg.around(content.join("\n")) + "\n"
    }

    pub(crate) fn line(&mut self, from: [f64; 2], to: [f64; 2], stroke: Stroke) {
        self.polyline([from, to], stroke);
    }

    pub(crate) fn polyline(&mut self, at: impl IntoIterator<Item = [f64; 2]>, stroke: Stroke) {
        let line = Element::new("polyline").with("points", points(at, number));
        self.put(stroke.draw(line));
    }

    pub(crate) fn polygon(
        &mut self,
        at: impl IntoIterator<Item = [f64; 2]>,
        fill: &str,
        opacity: f64,
    ) {
        let area = Element::new("polygon").with("points", points(at, number));
        self.put(area.with("fill", fill).with("fill-opacity", number(opacity)));
    }

    pub(crate) fn fill(&mut self, rect: Rect, fill: &str) {
        self.put(rect.place("rect").with("fill", fill));
    }

    pub(crate) fn outline(&mut self, rect: Rect, stroke: Stroke) {
        self.put(stroke.draw(rect.place("rect")));
    }

    pub(crate) fn dot(&mut self, at: [f64; 2], radius_mm: f64, fill: &str, stroke: Stroke) {
        let [x, y] = at;
        let sides = [("cx", x), ("cy", y), ("r", radius_mm)];
        let circle = Element::new("circle").with_all(sides.map(|(side, mm)| (side, number(mm))));
        self.put(circle.clone().with("fill", fill));
        self.put(stroke.draw(circle));
    }

    /// A line with filled arrowheads at both ends.
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

    /// Fills `rect` with cells of one color each, `[row][column]` from the top left.
    pub(crate) fn cells(&mut self, rect: Rect, size: [usize; 2], colors: &[[u8; 3]]) {
        // Antialiasing would let the page shine through between cells that only touch, so each
        // extends below the cells that are drawn after it.
        const OVERLAP: f64 = 0.5;
        let [columns, rows] = size;
        let [x, y] = [rect.left, rect.top].map(number);
        let [u, v] = [rect.width / columns as f64, rect.height / rows as f64].map(number_fine);
        let mut cells = String::new();
        for (row, line) in colors.chunks(columns).enumerate() {
            for (start, length) in runs(line) {
                let last = start + length == columns;
                let width = number(length as f64 + if last { 0.0 } else { OVERLAP });
                let height = number(1.0 + if row + 1 == rows { 0.0 } else { OVERLAP });
                let outline = format!("M{start} {row}h{width}v{height}h-{width}z");
                let cell = Element::new("path").with("d", outline).with("fill", hex(line[start]));
                cells = cells + "\n" + &cell.empty();
            }
        }
        let place = format!("translate({x} {y}) scale({u} {v})");
        self.put_around(Element::new("g").with("transform", place), &(cells + "\n"));
    }

    /// Stretches a PNG picture over `rect` without smoothing.
    pub(crate) fn pixels(&mut self, rect: Rect, png: &[u8]) {
        let data = BASE64.encode(png);
        let picture = rect
            .place("image")
            .with("preserveAspectRatio", "none")
            .with("style", "image-rendering:pixelated")
            .with("href", format_args!("data:image/png;base64,{data}"));
        self.put(picture);
    }

    /// Clips what `draw` draws to `rect`.
    pub(crate) fn clipped(&mut self, rect: Rect, draw: impl FnOnce(&mut Self)) {
        let id = format!("clip{}", self.clips);
        self.clips += 1;
        let clip = Element::new("clipPath").with("id", &id);
        self.put_around(clip, &rect.place("rect").empty());
        let outside = std::mem::take(&mut self.body);
        draw(self);
        let inside = std::mem::replace(&mut self.body, outside);
        let group = Element::new("g").with("clip-path", format_args!("url(#{id})"));
        self.put_around(group, &format!("\n{inside}"));
    }

    pub(crate) fn text(&mut self, text: &Text<'_>) {
        self.body += &text.to_svg();
        self.body.push('\n');
    }

    fn put(&mut self, element: Element) {
        self.body += &element.empty();
        self.body.push('\n');
    }

    fn put_around(&mut self, element: Element, content: &str) {
        self.body += &element.around(content);
        self.body.push('\n');
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

/// A length to a hundredth of a millimeter.
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
