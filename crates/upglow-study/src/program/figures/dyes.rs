//! Figure 2: the dyes.

use upglow::Mixing;
use upglow_color::{Contract, Grid, Spectrum};
use upglow_fit::BuildError;
use upglow_study::{ChromaticityDiagram, DyeSpectra, dye_spectra, konig2020};

use super::{Figure, Studio, chromaticity};
use crate::svg::{ABSORPTION, Anchor, Axis, Drawing, EMISSION, Frame, INK, Rect, Stroke, Text};

/// The dyes whose spectra are shown, counted from 1 as in the paper.
const SHOWN: [usize; 2] = [2, 6];
const HEIGHT_MM: f64 = 85.0;
const DIAGRAM: Rect = Rect { left: 10.5, top: 6.0, width: 70.0, height: 70.0 };
const SPECTRA_LEFT_MM: f64 = 97.0;
const SPECTRA_MM: [f64; 2] = [70.0, 27.5];
const RANGE_NM: [f64; 2] = [300.0, 750.0];

pub(super) fn figure_2(_: &Studio<'_>) -> Result<Figure, BuildError> {
    let model = konig2020::dyes(Mixing::Pooled);
    let contract = konig2020::contract();
    let dyes = dye_spectra(&model, &contract.observer);
    let names: Vec<String> = dyes.iter().map(|dye| dye.name.replace('_', " ")).collect();
    let mut drawing = Drawing::new(HEIGHT_MM);
    draw_diagram(&mut drawing, &contract, &dyes, &names);
    for (row, dye) in SHOWN.into_iter().enumerate() {
        let letter = ["b", "c"][row];
        let title = format!("[{letter}] dye {dye}, {}", names[dye - 1]);
        draw_spectra(&mut drawing, row, &dyes[dye - 1], &title);
    }
    let peaks = |dye: usize| {
        let DyeSpectra { absorption_peak_nm, emission_peak_nm, .. } = dyes[dye - 1];
        format!(
            "dye {dye} absorbs most at {absorption_peak_nm:.0} nm and emits most at \
             {emission_peak_nm:.0} nm"
        )
    };
    let listed: Vec<String> = (1..).zip(&names).map(|(i, name)| format!("{i} {name}")).collect();
    let first = dyes.iter().map(|dye| dye.absorption_peak_nm).fold(f64::MAX, f64::min);
    let last = dyes.iter().map(|dye| dye.absorption_peak_nm).fold(0.0, f64::max);
    let caption = format!(
        "(a) Chromaticities of the emissions of the eight dyes, without non-fluorescent \
         reflection, in ring order: {}. Lines join the neighbors that a material may mix. (b, c) \
         Absorption and emission, each scaled to 1: {}; {}. Absorption peaks of the eight range \
         from {first:.0} to {last:.0} nm.",
        listed.join(", "),
        peaks(SHOWN[0]),
        peaks(SHOWN[1]),
    );
    Ok(Figure::new(2, "dyes", drawing, caption))
}

fn draw_diagram(
    drawing: &mut Drawing,
    contract: &Contract,
    dyes: &[DyeSpectra<'_>],
    names: &[String],
) {
    let frame = chromaticity::frame(DIAGRAM);
    let points: Vec<[f64; 2]> = dyes
        .iter()
        .map(|dye| frame.point(dye.emission_xy.expect("a dye's emission is visible")))
        .collect();
    chromaticity::draw_landmarks(drawing, &frame, &ChromaticityDiagram::of(contract));
    let ring = points.iter().chain(&points[..1]).copied();
    drawing.polyline(ring, Stroke::solid(EMISSION, 0.25));
    let center = frame.point([1.0 / 3.0, 1.0 / 3.0]);
    for (number, at) in (1..).zip(&points) {
        drawing.dot(*at, 0.9, EMISSION, Stroke::solid("#ffffff", 0.2));
        draw_number(drawing, number, *at, center);
    }
    chromaticity::draw_key(drawing, &frame, "AP1");
    draw_names(drawing, frame.point([0.535, 0.9]), names);
    frame.draw_axes(drawing);
    frame.draw_title(drawing, "[a] emission of the eight dyes", "");
}

/// Lists the names of the dyes and their numbers, downward from a point of the page.
fn draw_names(drawing: &mut Drawing, [left, top]: [f64; 2], names: &[String]) {
    const LINE_MM: f64 = 3.1;
    for (index, name) in (0_u32..).zip(names) {
        let baseline = top + LINE_MM * f64::from(index);
        let number = (index + 1).to_string();
        drawing.text(&Text::note([left, baseline], &number).bold());
        drawing.text(&Text::note([left + 2.4, baseline], name));
    }
}

/// Draws a dye's number beside its dot, toward the middle of the diagram, away from the locus.
fn draw_number(drawing: &mut Drawing, number: u32, at: [f64; 2], center: [f64; 2]) {
    const APART_MM: f64 = 2.4;
    let inward = [center[0] - at[0], center[1] - at[1]];
    let length = inward[0].hypot(inward[1]).max(f64::MIN_POSITIVE);
    let [x, y] = [0, 1].map(|k| at[k] + APART_MM * inward[k] / length);
    let text = number.to_string();
    drawing.text(&Text::note([x, y + 0.8], &text).bold().anchor(Anchor::Middle).halo());
}

fn draw_spectra(drawing: &mut Drawing, row: usize, dye: &DyeSpectra<'_>, title: &str) {
    let [width, height] = SPECTRA_MM;
    let top = DIAGRAM.top + if row == 0 { 0.0 } else { DIAGRAM.height - height };
    let wavelength = Axis::every("wavelength *λ* / nm", RANGE_NM, 50.0);
    let frame = Frame {
        rect: Rect { left: SPECTRA_LEFT_MM, top, width, height },
        x: if row == 0 { Axis { label: "", ..wavelength } } else { wavelength },
        y: Axis::every("relative value", [0.0, 1.08], 0.5),
    };
    drawing.clipped(frame.rect, |drawing| {
        let absorption = (dye.absorption, dye.absorption_peak_nm, ABSORPTION);
        let emission = (dye.emission, dye.emission_peak_nm, EMISSION);
        for (curve, peak_nm, color) in [absorption, emission] {
            draw_curve(drawing, &frame, curve, peak_nm, color);
        }
    });
    draw_legend(drawing, &frame);
    frame.draw_axes(drawing);
    frame.draw_title(drawing, title, "");
}

fn draw_curve(
    drawing: &mut Drawing,
    frame: &Frame,
    curve: &Spectrum,
    peak_nm: f64,
    color: &'static str,
) {
    let peak = curve.at(peak_nm);
    let samples = Grid::FINE.wavelengths_nm().zip(curve.values());
    let shown: Vec<[f64; 2]> = samples
        .filter(|(nm, _)| (RANGE_NM[0]..=RANGE_NM[1]).contains(nm))
        .map(|(nm, value)| frame.point([nm, value / peak]))
        .collect();
    let ends = [[RANGE_NM[1], 0.0], [RANGE_NM[0], 0.0]].map(|p| frame.point(p));
    drawing.polygon(shown.iter().chain(&ends).copied(), color, 0.1);
    drawing.polyline(shown, Stroke::solid(color, 0.4));
}

fn draw_legend(drawing: &mut Drawing, frame: &Frame) {
    let (left, top) = (frame.rect.left + 2.0, frame.rect.top + 3.4);
    for (row, (name, color)) in
        [("absorption", ABSORPTION), ("emission", EMISSION)].into_iter().enumerate()
    {
        let y = top + 3.2 * row as f64;
        drawing.line([left, y - 0.8], [left + 4.0, y - 0.8], Stroke::solid(color, 0.5));
        drawing.text(&Text::note([left + 5.0, y], name).color(INK));
    }
}
