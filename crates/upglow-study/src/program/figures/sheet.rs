//! Panels of equal size in rows and columns, and layers of a cube in them.

use upglow_svg::hex;

use crate::figures::cut::Cut;
use crate::figures::display::Painter;
use crate::raster;
use crate::svg::{Axis, Drawing, Frame, PAGE_MM, Rect, Stroke};

/// Where the panels of a page lie: as large as the page's width allows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sheet {
    pub(crate) columns: usize,
    pub(crate) rows: usize,
    /// Room left of the first column: numbers and a label.
    pub(crate) left_mm: f64,
    /// Room between columns.
    pub(crate) gap_mm: f64,
    /// Room above each row: its titles.
    pub(crate) title_mm: f64,
    /// Room below each row but the last: its numbers, where it has any.
    pub(crate) below_mm: f64,
    /// Room below the last row: numbers, a label and what else there is.
    pub(crate) foot_mm: f64,
}

/// Room right of the last column: half the number of the last tick.
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

    /// The frame of a panel over red and green: only the outer ones have words.
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

/// Up to this many columns each point is a cell of the drawing; beyond, a pixel of a picture.
const MOST_CELLS: usize = 40;

/// The cells of a layer, in the colors that `paint` gives to the points of these numbers.
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

/// A panel with a layer's colors, and its errors under the title.
pub(crate) fn draw_layer(
    drawing: &mut Drawing,
    frame: &Frame,
    cut: &Cut<'_>,
    title: &str,
    painter: Painter,
) {
    draw_points(drawing, frame, cut, |index| painter.paint(cut.layer.colors[index]));
    frame.draw_title(drawing, title, &errors_note(cut));
}

/// A page of layers.
pub(crate) fn layers_page(
    sheet: &Sheet,
    panels: &[(String, Cut<'_>)],
    painter: Painter,
) -> Drawing {
    let mut drawing = Drawing::new(sheet.height_mm());
    for (i, (title, cut)) in panels.iter().enumerate() {
        let frame = sheet.layer_frame(i / sheet.columns, i % sheet.columns, cut);
        draw_layer(&mut drawing, &frame, cut, title, painter);
    }
    drawing
}

/// The errors of a layer's points, marked up for a drawing.
pub(crate) fn errors_note(cut: &Cut<'_>) -> String {
    let (mean, within) = cut.errors();
    format!("mean Δ*E*_{{00}} {mean:.2}; {} within 1", super::percent(within))
}

/// The errors of a layer's points, for a caption.
pub(crate) fn errors_text(cut: &Cut<'_>) -> String {
    let (mean, within) = cut.errors();
    format!("mean ΔE00 {mean:.2}, {} within 1", super::percent(within))
}

/// A color of the page as SVG writes it.
pub(crate) fn swatch(drawing: &mut Drawing, rect: Rect, color: [u8; 3]) {
    drawing.fill(rect, &hex(color));
    drawing.outline(rect, Stroke::AXIS);
}
