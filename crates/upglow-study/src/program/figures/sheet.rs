//! Pages of square panels, and layers of a cube drawn in them.

use upglow_svg::hex;

use super::cut::Cut;
use super::display::Painter;
use super::{Studio, percent};
use crate::raster;
use crate::svg::{Axis, Drawing, Frame, PAGE_MM, Rect, Stroke};

/// The letters of panels.
pub(crate) const LETTERS: [&str; 10] = ["a", "b", "c", "d", "e", "f", "g", "h", "i", "j"];

/// The arrangement of panels on a page; they are as large as its width allows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sheet {
    pub(crate) columns: usize,
    pub(crate) rows: usize,
    /// Space left of the first column, for numbers and a label.
    pub(crate) left_mm: f64,
    /// Space between columns.
    pub(crate) gap_mm: f64,
    /// Space above each row, for its titles.
    pub(crate) title_mm: f64,
    /// Space below each row but the last, for its numbers.
    pub(crate) below_mm: f64,
    /// Space below the last row, for numbers, a label and a legend.
    pub(crate) foot_mm: f64,
}

/// Space right of the last column, for half the number of the last tick.
const RIGHT_MM: f64 = 2.0;

impl Sheet {
    /// Panels that share their axes, with titles of two lines.
    pub(crate) const fn shared(columns: usize, rows: usize) -> Self {
        Self {
            columns,
            rows,
            left_mm: 10.5,
            gap_mm: 4.0,
            title_mm: 9.0,
            below_mm: 1.0,
            foot_mm: 8.2,
        }
    }

    /// Length of a panel's sides, mm.
    pub(crate) fn side_mm(&self) -> f64 {
        let gaps = self.gap_mm * (self.columns - 1) as f64;
        (PAGE_MM - self.left_mm - RIGHT_MM - gaps) / self.columns as f64
    }

    /// Height of the page, mm.
    pub(crate) fn height_mm(&self) -> f64 {
        let rows = self.rows as f64;
        rows * (self.title_mm + self.side_mm()) + (rows - 1.0) * self.below_mm + self.foot_mm
    }

    pub(crate) fn rect(&self, row: usize, column: usize) -> Rect {
        let side = self.side_mm();
        Rect {
            left: self.left_mm + column as f64 * (side + self.gap_mm),
            top: self.title_mm + row as f64 * (side + self.title_mm + self.below_mm),
            width: side,
            height: side,
        }
    }

    /// The frame of a panel over red and green. Only the outer panels have numbers and labels.
    pub(crate) fn layer_frame(&self, row: usize, column: usize, cut: &Cut<'_>) -> Frame {
        let [x, y] = layer_axes(cut);
        Frame {
            rect: self.rect(row, column),
            x: if row + 1 == self.rows { x } else { x.silent() },
            y: if column == 0 { y } else { y.silent() },
        }
    }
}

/// Axes over the points of a layer, each point in the middle of its cell.
fn layer_axes(cut: &Cut<'_>) -> [Axis; 2] {
    let last = (cut.layer.side - 1) as f64;
    let axis = |label, [low, high]: [usize; 2]| {
        let range = [(low as f64 - 0.5) / last, (high as f64 + 0.5) / last];
        let step = if range[1] - range[0] > 0.7 { 0.25 } else { 0.1 };
        Axis::every(label, range, step)
    };
    [axis("red *R*", cut.red), axis("green *G*", cut.green)]
}

/// Layers of up to this many columns are drawn as cells, larger ones as an embedded picture.
const MOST_CELLS: usize = 40;

/// Draws the points of a layer in the colors that `paint` returns for their indices.
pub(crate) fn draw_points(
    drawing: &mut Drawing,
    frame: &Frame,
    cut: &Cut<'_>,
    paint: impl Fn(usize) -> [u8; 3],
) {
    let colors: Vec<[u8; 3]> = cut.picture().map(paint).collect();
    if cut.columns() <= MOST_CELLS {
        drawing.cells(frame.rect, [cut.columns(), cut.rows()], &colors);
    } else {
        drawing.pixels(frame.rect, &raster::png(cut.columns(), &colors));
    }
    frame.draw_axes(drawing);
}

/// Draws a layer's colors, and its errors under the title.
pub(crate) fn draw_layer(
    drawing: &mut Drawing,
    frame: &Frame,
    cut: &Cut<'_>,
    title: &str,
    painter: Painter,
) {
    draw_points(drawing, frame, cut, |index| painter.paint(cut.layer.colors[index]));
    let (mean, within) = cut.errors();
    let note = format!("mean Δ*E*_{{00}} {mean:.2}; {} within 1", percent(within));
    frame.draw_title(drawing, title, &note);
}

/// A page of layers, each with its title in the drawing and its name in the caption. Returns the
/// drawing, and the names and errors for the caption.
pub(super) fn layers_page(
    studio: &Studio<'_>,
    sheet: &Sheet,
    panels: &[(String, String, Cut<'_>)],
) -> (Drawing, String) {
    let mut drawing = Drawing::new(sheet.height_mm());
    let mut parts = Vec::new();
    for (i, (title, name, cut)) in panels.iter().enumerate() {
        let letter = LETTERS[i];
        let frame = sheet.layer_frame(i / sheet.columns, i % sheet.columns, cut);
        draw_layer(&mut drawing, &frame, cut, &format!("[{letter}] {title}"), studio.painter());
        parts.push(format!("({letter}) {name}: {}", errors_text(cut)));
    }
    (drawing, parts.join("; "))
}

/// The errors of a layer's points, for a caption.
pub(crate) fn errors_text(cut: &Cut<'_>) -> String {
    let (mean, within) = cut.errors();
    format!("mean ΔE00 {mean:.2}, {} within 1", percent(within))
}

/// A rectangle of one color with an outline.
pub(crate) fn swatch(drawing: &mut Drawing, rect: Rect, color: [u8; 3]) {
    drawing.fill(rect, &hex(color));
    drawing.outline(rect, Stroke::AXIS);
}
