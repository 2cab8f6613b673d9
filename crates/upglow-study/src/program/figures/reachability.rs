//! Figure 10: which colors any material can match.

use upglow_color::StandingKind;
use upglow_fit::BuildError;
use upglow_study::{konig2020, standing_layer};
use upglow_svg::hex;

use super::sheet::{LETTERS, Sheet, swatch};
use super::{Figure, Studio, percent};
use crate::raster;
use crate::svg::{Axis, Drawing, Frame, Rect, STANDINGS, Text};

/// Blue of the layers shown, in 31sts, and its text in their titles.
const BLUES: [(f64, &str); 5] =
    [(0.0, "0"), (5.0, "5/31"), (15.0, "15/31"), (23.0, "23/31"), (31.0, "1")];
const NAMES: [&str; 3] = ["some reflectance", "only fluorescence", "no material"];
/// Points of a layer's picture per step between nodes.
const POINTS_PER_STEP: usize = 4;

pub(super) fn figure_10(studio: &Studio<'_>) -> Result<Figure, BuildError> {
    let contract = konig2020::contract();
    let nodes = studio.cubes.resolution();
    let side = POINTS_PER_STEP * (nodes - 1) + 1;
    let sheet =
        Sheet { gap_mm: 12.0, title_mm: 7.0, below_mm: 8.0, foot_mm: 15.0, ..Sheet::shared(3, 2) };
    let mut drawing = Drawing::new(sheet.height_mm());
    let mut parts = Vec::new();
    for (i, (blue, name)) in BLUES.into_iter().enumerate() {
        studio.go_on()?;
        let standings = standing_layer(&contract, blue / 31.0, side);
        let found = shares(&standings).map(percent);
        let title = format!("[{}] *B* = {name}", LETTERS[i]);
        draw_layer(&mut drawing, &sheet, i, &standings, &title);
        parts.push(format!("B = {name}: {} / {} / {}", found[0], found[1], found[2]));
    }
    let layers: Vec<Vec<StandingKind>> = (0..nodes)
        .map(|blue| standing_layer(&contract, blue as f64 / (nodes - 1) as f64, nodes))
        .collect();
    draw_shares(&mut drawing, sheet.rect(1, 2), &layers);
    let all = shares(layers.iter().flatten()).map(percent);
    draw_legend(&mut drawing, &sheet, &all);
    let caption = format!(
        "What any material can show of ACEScg under D65, whatever the solver: some reflectance, \
         only a fluorescent material that gives back at most one photon for each absorbed, at no \
         shorter wavelength, or no material at all. (a–e) Layers of {side} × {side} colors; {} \
         (reflectance / fluorescence / nothing). (f) Shares of the {nodes}² nodes of each layer; \
         over all {nodes}³ nodes {}, {} and {}. At B = 0 all colors lie between the red and the \
         green primary of AP1, a line outside the spectral locus; at B = 1 no \
         reflectance but white gives back as much blue. These limits know no slope limit and no dyes.",
        parts.join("; "),
        all[0],
        all[1],
        all[2],
    );
    Ok(Figure::new(10, "reachability", drawing, caption))
}

fn draw_layer(
    drawing: &mut Drawing,
    sheet: &Sheet,
    index: usize,
    standings: &[StandingKind],
    title: &str,
) {
    let (row, column) = (index / sheet.columns, index % sheet.columns);
    let axis = |label| Axis::every(label, [0.0, 1.0], 0.25);
    let (x, y) = (axis("red *R*"), axis("green *G*"));
    let frame = Frame { rect: sheet.rect(row, column), x, y };
    let side = standings.len().isqrt();
    // The top row of the picture is the greatest green.
    let rows = standings.chunks(side).rev().flatten();
    let colors: Vec<[u8; 3]> = rows.map(|&standing| STANDINGS[standing as usize]).collect();
    drawing.pixels(frame.rect, &raster::png(side, &colors));
    frame.draw_axes(drawing);
    frame.draw_title(drawing, title, "");
}

/// Draws the shares over blue as stacked areas.
fn draw_shares(drawing: &mut Drawing, rect: Rect, layers: &[Vec<StandingKind>]) {
    let frame = Frame {
        rect,
        x: Axis::every("blue *B*", [0.0, 1.0], 0.25),
        y: Axis::every("share of the layer / %", [0.0, 100.0], 25.0),
    };
    let last = (layers.len() - 1) as f64;
    let found: Vec<[f64; 3]> = layers.iter().map(shares).collect();
    // Each area starts at zero and covers the lower part of the one drawn before.
    for (standing, color) in STANDINGS.iter().enumerate().rev() {
        let height = |shares: &[f64; 3]| 100.0 * shares[..=standing].iter().sum::<f64>();
        let upper = (0_u32..).zip(&found).map(|(i, s)| [f64::from(i) / last, height(s)]);
        let corners = [[1.0, 0.0], [0.0, 0.0]];
        let outline = upper.chain(corners).map(|p| frame.point(p));
        drawing.polygon(outline, &hex(*color), 1.0);
    }
    frame.draw_axes(drawing);
    frame.draw_title(drawing, "[f] all layers", "");
}

/// Draws a key to the colors, with shares over all nodes, below the columns.
fn draw_legend(drawing: &mut Drawing, sheet: &Sheet, all: &[String; 3]) {
    let baseline = sheet.height_mm() - 2.6;
    for (i, (name, share)) in NAMES.into_iter().zip(all).enumerate() {
        let left = sheet.rect(1, i).left;
        let rect = Rect { left, top: baseline - 2.4, width: 5.0, height: 3.0 };
        swatch(drawing, rect, STANDINGS[i]);
        drawing.text(&Text::label([left + 6.6, baseline], &format!("{name}, {share}")));
    }
}

/// The share of each kind, in the order of [`StandingKind`].
fn shares<'k>(kinds: impl IntoIterator<Item = &'k StandingKind>) -> [f64; 3] {
    let mut counts = [0.0; 3];
    kinds.into_iter().for_each(|&kind| counts[kind as usize] += 1.0);
    let all: f64 = counts.iter().sum();
    counts.map(|count| count / all)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_add_up_to_one() {
        let kinds = [StandingKind::Unreachable, StandingKind::Reflectance];
        assert_eq!(shares(&kinds), [0.5, 0.0, 0.5]);
    }
}
