//! Figure 5: three kinds of interpolation between two reflectances.

use upglow::Features;
use upglow_color::{Grid, Lab};
use upglow_fit::BuildError;
use upglow_study::{Mixing, konig2020};

use super::sheet::swatch;
use super::{Figure, Studio};
use crate::svg::{Anchor, Axis, Drawing, Frame, MUTED, Rect, Stroke, Text, WEIGHTS};

/// The two ends: a blue and an orange, both n-shaped.
const FROM: Features = Features { shift_nm: 450.0, width_nm: 45.0, slope_per_nm: -0.009 };
const TO: Features = Features { shift_nm: 620.0, width_nm: 60.0, slope_per_nm: -0.008 };

const ROW_TOP_MM: f64 = 6.0;
const ROW_STEP_MM: f64 = 46.0;
const PLOT_MM: [f64; 2] = [119.0, 35.0];
const LEFT_MM: f64 = 11.0;
const KEY_LEFT_MM: f64 = 136.0;
const SWATCH_MM: [f64; 2] = [18.0, 6.2];
/// Space below the last plot, for numbers and a label.
const FOOT_MM: f64 = 8.2;
const RANGE_NM: [f64; 2] = [380.0, 720.0];

/// Weights of the second end.
const SHARES: [f64; 5] = [0.0, 0.25, 0.5, 0.75, 1.0];

const ROWS: [(Mixing, &str); 3] = [
    (Mixing::Coefficients, "[a] coefficients *c*_{0}, *c*_{1}, *c*_{2}"),
    (Mixing::Spectra, "[b] spectra"),
    (Mixing::Features, "[c] features *z*, *w*, *s*"),
];

pub(super) fn figure_5(studio: &Studio<'_>) -> Result<Figure, BuildError> {
    let colorimetry = konig2020::contract().on(Grid::FINE);
    let painter = studio.display.painter(&colorimetry);
    let mut drawing = Drawing::new(ROW_TOP_MM + 2.0 * ROW_STEP_MM + PLOT_MM[1] + FOOT_MM);
    let mut halves = Vec::new();
    for (row, (mixing, title)) in (0_u32..).zip(ROWS) {
        let frame = frame(row);
        let spectra = SHARES.map(|share| {
            mixing.sample([FROM, TO], share).expect("the slopes have one sign and are not zero")
        });
        let colors = spectra.each_ref().map(|r| colorimetry.xyz_from_reflectance(r.clone()));
        draw_spectra(&mut drawing, &frame, &spectra);
        frame.draw_title(&mut drawing, title, "");
        let shown = colors.map(|color| painter.paint(colorimetry.rgb_from_xyz(color)));
        draw_key(&mut drawing, &frame, shown);
        halves.push(half_text(&spectra[2], colorimetry.lab_from_xyz(colors[2])));
    }
    let caption = format!(
        "Linear interpolation between two reflectances with weights 0, ¼, ½, ¾, 1: of the \
         coefficients (a), of the spectra (b), of the features (c). The ends: {}; {}. At weight ½ \
         (a) {}; (b) {}; (c) {}. Swatches show each reflectance under D65. {}",
        end_text(FROM),
        end_text(TO),
        halves[0],
        halves[1],
        halves[2],
        studio.display.note(),
    );
    Ok(Figure::new(5, "interpolation", drawing, caption))
}

fn end_text(Features { shift_nm, width_nm, slope_per_nm }: Features) -> String {
    format!("z = {shift_nm:.0} nm, w = {width_nm:.0} nm, s = −{:.3}/nm", -slope_per_nm)
}

/// The peak of a reflectance, and its color.
fn half_text(samples: &[f64], color: Lab) -> String {
    let peak = Grid::FINE.wavelengths_nm().zip(samples).max_by(|a, b| a.1.total_cmp(b.1));
    let (nm, value) = peak.expect("the grid has wavelengths");
    let (chroma, hue) = (color.a.hypot(color.b), color.b.atan2(color.a).to_degrees());
    format!(
        "peaks at {nm:.0} nm with {value:.2}, and has L* {:.0}, chroma {chroma:.0}, hue {:.0}°",
        color.l,
        hue.rem_euclid(360.0)
    )
}

fn frame(row: u32) -> Frame {
    let [width, height] = PLOT_MM;
    let top = ROW_TOP_MM + f64::from(row) * ROW_STEP_MM;
    let is_last = row + 1 == 3;
    let label = if is_last { "wavelength *λ* / nm" } else { "" };
    Frame {
        rect: Rect { left: LEFT_MM, top, width, height },
        x: Axis::every(label, RANGE_NM, 40.0),
        y: Axis::every("reflectance *r*", [0.0, 1.0], 0.25),
    }
}

fn draw_spectra(drawing: &mut Drawing, frame: &Frame, spectra: &[Vec<f64>; 5]) {
    drawing.clipped(frame.rect, |drawing| {
        for (spectrum, color) in spectra.iter().zip(WEIGHTS) {
            let samples = Grid::FINE.wavelengths_nm().zip(spectrum);
            let shown = samples.filter(|(nm, _)| (RANGE_NM[0]..=RANGE_NM[1]).contains(nm));
            let points = shown.map(|(nm, value)| frame.point([nm, *value]));
            drawing.polyline(points, Stroke::solid(color, 0.45));
        }
    });
    frame.draw_axes(drawing);
}

/// Draws for each weight its line style, its value and its color.
fn draw_key(drawing: &mut Drawing, frame: &Frame, colors: [[u8; 3]; 5]) {
    let [width, height] = SWATCH_MM;
    let step = (PLOT_MM[1] - height) / 4.0;
    for (i, (color, name)) in (0_u32..).zip(colors.into_iter().zip(["0", "¼", "½", "¾", "1"])) {
        let top = frame.rect.top + f64::from(i) * step;
        let middle = top + height / 2.0;
        let line = Stroke::solid(WEIGHTS[i as usize], 0.6);
        drawing.line([KEY_LEFT_MM, middle], [KEY_LEFT_MM + 6.0, middle], line);
        let at = [KEY_LEFT_MM + 9.0, middle + 0.9];
        drawing.text(&Text::label(at, name).anchor(Anchor::Middle).color(MUTED));
        swatch(drawing, Rect { left: KEY_LEFT_MM + 14.0, top, width, height }, color);
    }
    let heads = [(2.4, "line"), (9.0, "weight"), (14.0 + width / 2.0, "color")];
    for (left, head) in heads {
        let at = [KEY_LEFT_MM + left, frame.rect.top - 1.6];
        drawing.text(&Text::note(at, head).anchor(Anchor::Middle).color(MUTED));
    }
}
