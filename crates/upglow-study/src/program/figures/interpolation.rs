//! Figures 8 and 9: how colors between the nodes are interpolated.

use upglow::Interpolation;
use upglow_fit::BuildError;
use upglow_study::Layer;

use super::cut::Cut;
use super::display::Painter;
use super::sheet::{LETTERS, Sheet, draw_points, errors_text, layers_page};
use super::{Figure, Studio, percent};
use crate::cubes::StudyCube;
use crate::svg::{Anchor, Drawing, PAGE_MM, Rect, Stroke, Text, error_color};

const BLUE: f64 = 0.7;
/// Points along each axis of a picture for each node of the cube.
const POINTS_PER_NODE: usize = 8;

/// The error that the darkest color stands for, ΔE00.
const GREATEST_ERROR: f64 = 10.0;

/// The four interpolations of the paper, in its order.
const PAPERS: [(Interpolation, &str); 4] = [
    (Interpolation::None, "none"),
    (Interpolation::Features, "features"),
    (Interpolation::Hybrid, "hybrid"),
    (Interpolation::Coefficients, "coefficients"),
];
const OURS: (Interpolation, &str) = (Interpolation::Blend, "blend");

fn layer(studio: &Studio<'_>, interpolation: Interpolation) -> Result<Layer, BuildError> {
    studio.go_on()?;
    let cube = studio.cubes.get(StudyCube::PaperFeatures, studio.watch)?;
    let side = POINTS_PER_NODE * cube.resolution();
    Ok(Layer::between_nodes(&cube, BLUE, side, interpolation))
}

pub(super) fn figure_8(studio: &Studio<'_>) -> Result<Figure, BuildError> {
    let layers = PAPERS.map(|(interpolation, _)| layer(studio, interpolation));
    let layers: Vec<Layer> = layers.into_iter().collect::<Result<_, _>>()?;
    let panel =
        |((_, name), layer): ((_, &str), _)| (name.to_owned(), name.to_owned(), Cut::whole(layer));
    let panels: Vec<_> = PAPERS.into_iter().zip(&layers).map(panel).collect();
    let (drawing, parts) = layers_page(studio, &Sheet::shared(2, 2), &panels);
    let caption = format!(
        "Interpolation at B = {BLUE}, {:.1} steps of nodes from 0, in the {n}³ cube fitted in \
         features; {side} × {side} colors. {parts}. {}",
        BLUE * (studio.cubes.resolution() - 1) as f64,
        studio.display.note(),
        n = studio.cubes.resolution(),
        side = layers[0].side,
    );
    Ok(Figure::new(8, "interpolated-layers", drawing, caption))
}

pub(super) fn figure_9(studio: &Studio<'_>) -> Result<Figure, BuildError> {
    let sheet =
        Sheet { gap_mm: 3.0, title_mm: 6.0, below_mm: 0.0, foot_mm: 19.5, ..Sheet::shared(5, 2) };
    let mut drawing = Drawing::new(sheet.height_mm());
    let mut parts = Vec::new();
    let mut exact = 0.0;
    for (column, (interpolation, name)) in PAPERS.into_iter().chain([OURS]).enumerate() {
        let layer = layer(studio, interpolation)?;
        draw_column(&mut drawing, &sheet, column, name, &layer, studio.painter());
        exact = share(&layer.has_exact_nodes);
        let (errors, worst) = (errors_text(&Cut::whole(&layer)), worst_between_exact(&layer));
        parts.push(format!("{name}: {errors}, at most {worst:.2} between exact nodes"));
    }
    draw_scale(&mut drawing, sheet.height_mm() - 9.5);
    let caption = format!(
        "The four interpolations of figure 8 beside blend, which mixes the materials of the four \
         nodes around a color: colors (a–e) and ΔE00 to the color asked for (f–j), at B = {BLUE}. \
         {}. For {} of the colors all nodes that take part are exact, within 0.01 ΔE00. The errors \
         that blend leaves are those of the nodes: there the fit found no material that shows the \
         color. {}",
        parts.join("; "),
        percent(exact),
        studio.display.note(),
    );
    Ok(Figure::new(9, "blend", drawing, caption))
}

/// Draws a layer's colors, and its errors below them.
fn draw_column(
    drawing: &mut Drawing,
    sheet: &Sheet,
    column: usize,
    name: &str,
    layer: &Layer,
    painter: Painter,
) {
    let cut = Cut::whole(layer);
    let [colors, errors] = [0, 1].map(|row| sheet.layer_frame(row, column, &cut));
    draw_points(drawing, &colors, &cut, |i| painter.paint(layer.colors[i]));
    colors.draw_title(drawing, &format!("[{}] {name}", LETTERS[column]), "");
    draw_points(drawing, &errors, &cut, |i| error_color(layer.de2000[i] / GREATEST_ERROR));
    let letter = LETTERS[sheet.columns + column];
    let title = format!("[{letter}] mean Δ*E*_{{00}} {:.2}", cut.errors().0);
    errors.draw_title(drawing, &title, "");
}

/// The greatest CIEDE2000 of the points whose nodes are all exact; 0 if there are none.
fn worst_between_exact(layer: &Layer) -> f64 {
    let pairs = layer.de2000.iter().zip(&layer.has_exact_nodes);
    pairs.filter(|(_, exact)| **exact).map(|(d, _)| *d).fold(0.0, f64::max)
}

fn share(of: &[bool]) -> f64 {
    of.iter().filter(|&&yes| yes).count() as f64 / of.len() as f64
}

/// The key to the errors' colors, in the middle of the page.
fn draw_scale(drawing: &mut Drawing, top: f64) {
    const STEPS: usize = 40;
    let rect = Rect { left: PAGE_MM / 2.0 - 35.0, top, width: 70.0, height: 2.6 };
    let colors: Vec<[u8; 3]> =
        (0..STEPS).map(|i| error_color((i as f64 + 0.5) / STEPS as f64)).collect();
    drawing.cells(rect, [STEPS, 1], &colors);
    drawing.outline(rect, Stroke::AXIS);
    for tick in 0..=5 {
        let x = rect.left + rect.width * f64::from(tick) / 5.0;
        drawing.line([x, rect.bottom()], [x, rect.bottom() + 0.9], Stroke::AXIS);
        let value = format!("{}{}", if tick == 5 { "≥ " } else { "" }, 2 * tick);
        let note = Text::note([x, rect.bottom() + 3.4], &value);
        drawing.text(&note.anchor(Anchor::Middle));
    }
    let name = Text::label([rect.left - 2.0, rect.top + 2.2], "error Δ*E*_{00}");
    drawing.text(&name.anchor(Anchor::End));
}
