//! Figure 1: analytic fluorescence and eight dyes.

use std::sync::Arc;

use upglow::Cube;
use upglow_color::Grid;
use upglow_fit::{BuildError, CubeSummary};
use upglow_study::{ChromaticityDiagram, Layer, konig2020, node_colors};

use super::cut::Cut;
use super::display::Painter;
use super::sheet::{Sheet, draw_layer, errors_text};
use super::{Figure, Studio, chromaticity, percent};
use crate::cubes::StudyCube;
use crate::raster;
use crate::svg::{Drawing, Rect};

/// Blue of the layers shown.
const BLUES: [f64; 2] = [5.0 / 31.0, 23.0 / 31.0];
/// Least X + Y + Z of the colors in the diagram.
const BRIGHT: f64 = 1.5;
/// Radius of a color's dot in the diagram, mm; larger dots hide their neighbors.
const DOT_MM: f64 = 0.28;
/// Pixels per millimeter of the picture with the dots: about 600 per inch.
const PIXELS_PER_MM: f64 = 24.0;

/// One row of the figure: a cube, and the letters of its panels.
struct Row {
    model: &'static str,
    letters: [&'static str; 3],
    cube: Arc<Cube>,
}

pub(super) fn figure_1(studio: &Studio<'_>) -> Result<Figure, BuildError> {
    let get = |which| studio.cubes.get(which, studio.watch);
    let analytic = get(StudyCube::PAPER_ANALYTIC)?;
    let rows = [
        Row { model: "analytic", letters: ["a", "c", "e"], cube: analytic },
        Row { model: "eight dyes", letters: ["b", "d", "f"], cube: get(StudyCube::PAPER)? },
    ];
    let sheet = Sheet { gap_mm: 12.0, below_mm: 8.0, ..Sheet::shared(3, 2) };
    let mut drawing = Drawing::new(sheet.height_mm());
    let mut errors = Vec::new();
    let mut bright = Vec::new();
    for (index, row) in rows.iter().enumerate() {
        let painter = studio.painter();
        errors.extend(draw_layers(&mut drawing, &sheet, index, row, painter));
        bright.push(draw_chromaticities(&mut drawing, sheet.rect(index, 2), row, painter));
    }
    errors.sort();
    let caption = caption(studio, &rows, &errors, &bright);
    Ok(Figure::new(1, "gamut", drawing, caption))
}

fn caption(studio: &Studio<'_>, rows: &[Row; 2], errors: &[String], bright: &[usize]) -> String {
    let summaries = rows.each_ref().map(|row| CubeSummary::of(&row.cube));
    let within = summaries.map(|s| percent(s.within_1 as f64 / s.nodes as f64));
    format!(
        "Analytic (a, c, e) and dye-based (b, d, f) fluorescence without interpolation, by the \
         paper's method with ΔE00 and {sweeps} sweeps. Layers of the {n}³ cube near B = {:.3} (a, b) and \
         B = {:.3} (c, d): {}. Chromaticities of all nodes with X + Y + Z ≥ {BRIGHT} (e: {} nodes, f: \
         {}), in the CIE 1931 diagram with the AP1 triangle. Over the whole cube the mean ΔE00 is \
         {:.2} against {:.2}, and {} against {} of the nodes are within 1. Slopes are at most \
         {slope}/nm. {}",
        BLUES[0],
        BLUES[1],
        errors.join("; "),
        bright[0],
        bright[1],
        summaries[0].mean_de2000,
        summaries[1].mean_de2000,
        within[0],
        within[1],
        studio.display.note(),
        n = studio.cubes.resolution(),
        sweeps = konig2020::SWEEPS,
        slope = konig2020::SLOPE_MAX_PER_NM,
    )
}

/// Draws the layers of one row, and returns their errors for the caption.
fn draw_layers(
    drawing: &mut Drawing,
    sheet: &Sheet,
    index: usize,
    row: &Row,
    painter: Painter,
) -> Vec<String> {
    // Each row is treated as the last so that it has its own numbers: the diagrams in the third
    // column need the space below the row anyway.
    let sheet = Sheet { rows: index + 1, ..*sheet };
    let panels = BLUES.into_iter().zip(row.letters).enumerate();
    let drawn = panels.map(|(column, (blue, letter))| {
        let layer = Layer::of_nodes(&row.cube, Layer::nearest_node(row.cube.resolution(), blue));
        let title = format!("[{letter}] {}, *B* = {:.3}", row.model, layer.blue);
        let frame = sheet.layer_frame(index, column, &Cut::whole(&layer));
        draw_layer(drawing, &frame, &Cut::whole(&layer), &title, painter);
        format!("({letter}) {}", errors_text(&Cut::whole(&layer)))
    });
    drawn.collect()
}

/// Draws the diagram of a cube's bright colors, and returns how many there are.
fn draw_chromaticities(drawing: &mut Drawing, rect: Rect, row: &Row, painter: Painter) -> usize {
    let frame = chromaticity::frame(rect);
    let colorimetry = row.cube.contract().on(Grid::FIT);
    let mut colors = node_colors(&row.cube, &colorimetry);
    colors.retain(|color| color.0.iter().sum::<f64>() >= BRIGHT);
    let dots: Vec<([f32; 2], [u8; 3])> = colors
        .iter()
        .filter_map(|color| {
            let [x, y] = frame.point(color.chromaticity()?);
            let at = [x - rect.left, y - rect.top].map(|mm| single(mm * PIXELS_PER_MM));
            Some((at, painter.paint(colorimetry.rgb_from_xyz(*color))))
        })
        .collect();
    let side = pixels(rect.width * PIXELS_PER_MM);
    drawing.pixels(rect, &raster::dots_png([side; 2], single(DOT_MM * PIXELS_PER_MM), &dots));
    let diagram = ChromaticityDiagram::of(row.cube.contract());
    chromaticity::draw_landmarks(drawing, &frame, &diagram);
    chromaticity::draw_key(drawing, &frame, "AP1");
    frame.draw_axes(drawing);
    let title = format!("[{}] {}, all nodes", row.letters[2], row.model);
    let note = format!("{} with *X* + *Y* + *Z* ≥ {BRIGHT}", colors.len());
    frame.draw_title(drawing, &title, &note);
    colors.len()
}

#[expect(clippy::cast_possible_truncation, reason = "pixel coordinates need no more precision")]
fn single(value: f64) -> f32 {
    value as f32
}

#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "the side of a picture is positive and small"
)]
fn pixels(value: f64) -> u32 {
    value.round() as u32
}
