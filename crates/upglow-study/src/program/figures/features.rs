//! Figure 4: the shift, width and slope of a reflectance.

use upglow::{Features, Vertex};
use upglow_fit::BuildError;

use super::{Figure, Studio};
use crate::svg::{
    ABSORPTION, Anchor, Axis, Drawing, EMISSION, Frame, INK, MUTED, Rect, Stroke, Text,
};

/// The n-shaped reflectance that is labeled.
const SHAPE: Features = Features { shift_nm: 530.0, width_nm: 75.0, slope_per_nm: -0.008 };
const HEIGHT_MM: f64 = 74.0;
const PANEL_TOP_MM: f64 = 6.0;
const PANEL_MM: [f64; 2] = [69.5, 59.0];
const LEFTS_MM: [f64; 2] = [11.5, 98.0];
const RANGE_NM: [f64; 2] = [400.0, 700.0];
const RANGE_X: [f64; 2] = [-4.0, 2.5];

/// The shape itself, and the U-shaped one with the opposite slope.
const SHAPE_STROKE: Stroke = Stroke::solid(ABSORPTION, 0.5);
const OPPOSITE_STROKE: Stroke = Stroke::solid(MUTED, 0.35).dashed("1.4 0.8");
const GUIDE: Stroke = Stroke::solid(MUTED, 0.2).dashed("0.5 0.6");
const TANGENT: Stroke = Stroke::solid(EMISSION, 0.45);
const ARROW: Stroke = Stroke::solid(INK, 0.25);

pub(super) fn figure_4(_: &Studio<'_>) -> Result<Figure, BuildError> {
    let opposite = Features { slope_per_nm: -SHAPE.slope_per_nm, ..SHAPE };
    let [shape, other] = [SHAPE, opposite].map(|f| f.to_vertex().expect("the slope is not zero"));
    let [parabola, reflectance] = frames();
    let mut drawing = Drawing::new(HEIGHT_MM);
    draw_parabola(&mut drawing, &parabola, shape, other);
    draw_reflectance(&mut drawing, &reflectance, shape, other);
    let Features { shift_nm, width_nm, slope_per_nm } = SHAPE;
    let caption = format!(
        "The features of a reflectance: shift z, the wavelength of the extremum; width w, from \
         there to the steepest point; slope s, the slope of the reflectance there. (a) The \
         parabola x(λ), (b) the reflectance r(λ) = ½ + x / (2√(1 + x²)). Solid: an n-shaped \
         reflectance with z = {shift_nm:.0} nm, w = {width_nm:.0} nm, s = −{:.3}/nm, for which \
         Algorithm 1 gives c0 = −{:.4e}/nm² and the extremum x = {:.3}. Dashed: U-shaped, the same \
         but s > 0; it is the mirror image, 1 − r.",
        -slope_per_nm, -shape.curvature_per_nm2, shape.peak
    );
    Ok(Figure::new(4, "features", drawing, caption))
}

fn frames() -> [Frame; 2] {
    let [width, height] = PANEL_MM;
    let [a, b] = LEFTS_MM.map(|left| Rect { left, top: PANEL_TOP_MM, width, height });
    let wavelength = || Axis::every("wavelength *λ* / nm", RANGE_NM, 50.0);
    [
        Frame { rect: a, x: wavelength(), y: Axis::every("parabola *x*", RANGE_X, 1.0) },
        Frame { rect: b, x: wavelength(), y: Axis::every("reflectance *r*", [0.0, 1.0], 0.2) },
    ]
}

/// Draws `value` over the wavelengths of the frame.
fn draw_curve(drawing: &mut Drawing, frame: &Frame, value: impl Fn(f64) -> f64, stroke: Stroke) {
    let nm = (0..=300).map(|i| RANGE_NM[0] + f64::from(i));
    drawing.clipped(frame.rect, |drawing| {
        drawing.polyline(nm.map(|nm| frame.point([nm, value(nm)])), stroke);
    });
}

fn parabola(vertex: Vertex) -> impl Fn(f64) -> f64 {
    move |nm| vertex.curvature_per_nm2 * (nm - vertex.shift_nm).powi(2) + vertex.peak
}

fn draw_parabola(drawing: &mut Drawing, frame: &Frame, shape: Vertex, other: Vertex) {
    let Features { shift_nm, width_nm, .. } = SHAPE;
    let x = parabola(shape);
    draw_curve(drawing, frame, parabola(other), OPPOSITE_STROKE);
    draw_curve(drawing, frame, &x, SHAPE_STROKE);
    draw_width(drawing, frame, RANGE_X[0] + 1.3);
    for nm in [shift_nm, shift_nm + width_nm] {
        draw_guide(drawing, frame, nm, x(nm));
    }
    let text = "extremum at *z*";
    let [left, top] = frame.point([shift_nm, x(shift_nm)]);
    drawing.text(&Text::note([left, top - 1.8], text).anchor(Anchor::Middle));
    let [left, top] = frame.point([shift_nm + width_nm, x(shift_nm + width_nm)]);
    drawing.text(&Text::note([left + 1.8, top - 0.6], "steepest point of *r*"));
    draw_legend(drawing, frame);
    frame.draw_axes(drawing);
    frame.draw_title(drawing, "[a] parabola", "");
}

fn draw_reflectance(drawing: &mut Drawing, frame: &Frame, shape: Vertex, other: Vertex) {
    let Features { shift_nm, width_nm, slope_per_nm } = SHAPE;
    draw_curve(drawing, frame, |nm| other.at(nm), OPPOSITE_STROKE);
    draw_curve(drawing, frame, |nm| shape.at(nm), SHAPE_STROKE);
    draw_width(drawing, frame, 0.12);
    let edge = [shift_nm + width_nm, shape.at(shift_nm + width_nm)];
    let tangent = [-32.0, 32.0].map(|d| frame.point([edge[0] + d, edge[1] + slope_per_nm * d]));
    drawing.polyline(tangent, TANGENT);
    draw_guide(drawing, frame, shift_nm, shape.at(shift_nm));
    draw_guide(drawing, frame, edge[0], edge[1]);
    let [left, top] = frame.point(edge);
    let text = "slope *s* = d*r*/d*λ*";
    drawing.text(&Text::label([left + 2.4, top - 1.6], text).color(EMISSION));
    frame.draw_axes(drawing);
    frame.draw_title(drawing, "[b] reflectance", "");
}

/// Draws a dot on a point of the curve, and a line from there down to the axis.
fn draw_guide(drawing: &mut Drawing, frame: &Frame, nm: f64, value: f64) {
    let at = frame.point([nm, value]);
    drawing.line([at[0], frame.rect.bottom()], at, GUIDE);
    drawing.dot(at, 0.8, ABSORPTION, Stroke::solid("#ffffff", 0.2));
}

/// Draws the arrow and label of the width at height `value`, and the label of the shift below it.
fn draw_width(drawing: &mut Drawing, frame: &Frame, value: f64) {
    let Features { shift_nm, width_nm, .. } = SHAPE;
    let [from, to] = [shift_nm, shift_nm + width_nm].map(|nm| frame.point([nm, value]));
    drawing.double_arrow(from, to, ARROW);
    let middle = [(from[0] + to[0]) / 2.0, from[1] - 1.2];
    drawing.text(&Text::label(middle, "width *w*").anchor(Anchor::Middle));
    let shift = [from[0] - 1.2, frame.rect.bottom() - 1.6];
    drawing.text(&Text::label(shift, "shift *z*").anchor(Anchor::End));
}

fn draw_legend(drawing: &mut Drawing, frame: &Frame) {
    let (left, top) = (frame.rect.left + 2.5, frame.rect.top + 4.0);
    let lines = [("n-shaped, *s* < 0", SHAPE_STROKE), ("U-shaped, *s* > 0", OPPOSITE_STROKE)];
    for (row, (name, stroke)) in (0_u32..).zip(lines) {
        let y = top + 3.3 * f64::from(row);
        drawing.line([left, y - 0.8], [left + 5.0, y - 0.8], stroke);
        drawing.text(&Text::note([left + 6.2, y], name));
    }
}
