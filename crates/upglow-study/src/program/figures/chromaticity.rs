//! Draws the CIE 1931 chromaticity diagram.

use upglow_study::ChromaticityDiagram;

use crate::svg::{Anchor, Axis, Drawing, Frame, INK, MUTED, Rect, Stroke, Text};

/// Marked wavelengths of the locus, nm; 540 would overlap the corner of AP1.
const MARKS_NM: [u32; 7] = [470, 480, 500, 520, 550, 570, 590];
/// Distance from the locus to the middle of a mark's number, mm.
const MARK_MM: f64 = 3.5;
const TICK_MM: f64 = 0.8;

const LOCUS: Stroke = Stroke::solid(INK, 0.3);
const PURPLES: Stroke = Stroke::solid(INK, 0.2).dashed("0.8 0.6");
const TRIANGLE: Stroke = Stroke::solid(MUTED, 0.25).dashed("1.4 0.7");

/// A square diagram: both axes have the same scale.
pub(crate) fn frame(rect: Rect) -> Frame {
    let axis = |label, range| Axis::every(label, range, 0.2);
    Frame { rect, x: axis("*x*", [-0.15, 0.85]), y: axis("*y*", [-0.05, 0.95]) }
}

/// Draws the spectral locus, the line of purples, the triangle of the primaries, and white.
pub(crate) fn draw_landmarks(drawing: &mut Drawing, frame: &Frame, diagram: &ChromaticityDiagram) {
    let ChromaticityDiagram { locus, primaries, white } = diagram;
    let ends = [locus[0].1, locus[locus.len() - 1].1].map(|xy| frame.point(xy));
    drawing.polyline(ends, PURPLES);
    drawing.polyline(locus.iter().map(|(_, xy)| frame.point(*xy)), LOCUS);
    let white = frame.point(*white);
    for (nm, xy) in locus.iter().filter(|(nm, _)| MARKS_NM.contains(nm)) {
        draw_mark(drawing, *nm, frame.point(*xy), white);
    }
    let [r, g, b] = primaries.map(|xy| frame.point(xy));
    drawing.polyline([r, g, b, r], TRIANGLE);
    draw_plus(drawing, white);
}

/// Draws a key to triangle and white, in the corner outside the locus.
pub(crate) fn draw_key(drawing: &mut Drawing, frame: &Frame, triangle: &str) {
    let [x, y] = frame.point([0.58, 0.07]);
    drawing.line([x, y - 0.7], [x + 4.0, y - 0.7], TRIANGLE);
    drawing.text(&Text::note([x + 5.0, y], triangle));
    draw_plus(drawing, [x + 2.0, y + 2.6]);
    drawing.text(&Text::note([x + 5.0, y + 3.3], "D65"));
}

fn draw_plus(drawing: &mut Drawing, [x, y]: [f64; 2]) {
    const ARM_MM: f64 = 0.9;
    let stroke = Stroke::solid(INK, 0.25);
    drawing.line([x - ARM_MM, y], [x + ARM_MM, y], stroke);
    drawing.line([x, y - ARM_MM], [x, y + ARM_MM], stroke);
}

/// Draws a tick at the locus, and the wavelength outside of it.
fn draw_mark(drawing: &mut Drawing, nm: u32, at: [f64; 2], white: [f64; 2]) {
    let away = [at[0] - white[0], at[1] - white[1]];
    let length = away[0].hypot(away[1]);
    let [u, v] = away.map(|c| c / length);
    drawing.line(at, [at[0] + TICK_MM * u, at[1] + TICK_MM * v], Stroke::AXIS);
    let text = nm.to_string();
    let middle = [at[0] + MARK_MM * u, at[1] + MARK_MM * v + 0.8];
    drawing.text(&Text::note(middle, &text).anchor(Anchor::Middle).color(MUTED).halo());
}
