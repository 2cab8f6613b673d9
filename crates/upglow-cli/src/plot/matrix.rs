//! A measured matrix beside a fitted one, as an SVG figure.

use upglow_color::{DonaldsonMatrix, MatrixSums};
use upglow_svg::{Element, byte, escape, hex};

use super::svg::{CAPTION_LETTERS, FAINT, INK, at, file, hundredths, line, outlined, shortened};

const WIDTH: f64 = 1120.0;
const HEIGHT: f64 = 840.0;

/// Left edges of the two maps, and below that of their scale.
const MAPS: [f64; 2] = [78.0, 560.0];
const MAP_TOP: f64 = 52.0;
const MAP_SIZE: [f64; 2] = [400.0, 336.0];
const SCALE: f64 = 1010.0;

/// Edges of the chart of radiance factors.
const LEFT: f64 = 78.0;
const RIGHT: f64 = 790.0;
const TOP: f64 = 500.0;
const BOTTOM: f64 = 770.0;
const SIDE: f64 = 826.0;
const CAPTION_STEP: f64 = 18.0;

/// Colors from nothing to the most, light to dark, so that print without color keeps the order.
const RAMP: [[f64; 3]; 5] = [
    [255.0, 255.0, 255.0],
    [253.0, 219.0, 135.0],
    [241.0, 134.0, 62.0],
    [176.0, 41.0, 89.0],
    [45.0, 12.0, 72.0],
];

/// The content of the figure.
#[derive(Clone, Debug)]
pub(crate) struct MatrixFigure<'a> {
    pub(crate) measured: &'a DonaldsonMatrix,
    /// On the same axes.
    pub(crate) fitted: &'a DonaldsonMatrix,
    /// Those of the radiance factors, under D65.
    pub(crate) sums: &'a MatrixSums,
    pub(crate) caption: Vec<String>,
}

/// The figure as the text of an SVG file.
pub(crate) fn draw(figure: &MatrixFigure<'_>) -> String {
    let most = greatest(figure.measured);
    let mut elements = Vec::new();
    let maps = [(MAPS[0], "measured", figure.measured), (MAPS[1], "fitted", figure.fitted)];
    for (left, name, matrix) in maps {
        elements.extend(map(matrix, left, name, most));
    }
    elements.extend(scale(most));
    elements.extend(chart(figure));
    let text = |(row, line): (u8, &String)| {
        let y = TOP + 12.0 + CAPTION_STEP * f64::from(row);
        at("text", SIDE, y)
            .with("font-size", 12.5)
            .around(escape(&shortened(line, CAPTION_LETTERS)))
    };
    elements.extend((3..).zip(&figure.caption).map(text));
    file([WIDTH, HEIGHT], &elements)
}

/// The greatest share that leaves at another wavelength, for the scale of both maps.
fn greatest(matrix: &DonaldsonMatrix) -> f64 {
    let mut most = 0.0_f64;
    for (row, out_nm) in matrix.factors().iter().zip(matrix.outgoing_nm()) {
        for (value, in_nm) in row.iter().zip(matrix.incident_nm()) {
            most = if out_nm == in_nm { most } else { most.max(*value) };
        }
    }
    if most > 0.0 { most } else { 1.0 }
}

/// The color of a share of the greatest; below 0 it is that of 0, beyond 1 that of 1.
fn color(share: f64) -> String {
    let place = share.clamp(0.0, 1.0) * (RAMP.len() - 1) as f64;
    let below = upglow_color::rounding::whole(place).min(RAMP.len() - 2);
    let fraction = place - below as f64;
    let mixed = |k: usize| RAMP[below][k] + (RAMP[below + 1][k] - RAMP[below][k]) * fraction;
    hex([0, 1, 2].map(|k| byte(mixed(k))))
}

/// The borders between bands, from the lower of the first to the upper of the last.
fn borders(nm: &[f64]) -> Vec<f64> {
    let last = nm.len() - 1;
    let between = nm.windows(2).map(|pair| (pair[0] + pair[1]) / 2.0);
    let first = nm[0] - (nm[1] - nm[0]) / 2.0;
    let end = nm[last] + (nm[last] - nm[last - 1]) / 2.0;
    [first].into_iter().chain(between).chain([end]).collect()
}

fn map(matrix: &DonaldsonMatrix, left: f64, name: &str, most: f64) -> Vec<String> {
    let [width, height] = MAP_SIZE;
    let [incident, outgoing] = [matrix.incident_nm(), matrix.outgoing_nm()].map(borders);
    let part = |borders: &[f64], nm: f64| {
        let [first, last] = [borders[0], borders[borders.len() - 1]];
        (nm - first) / (last - first)
    };
    let x_of = |nm: f64| left + width * part(&incident, nm);
    let y_of = |nm: f64| MAP_TOP + height * (1.0 - part(&outgoing, nm));
    let mut cells = Vec::new();
    for (row, y) in matrix.factors().iter().zip(outgoing.windows(2)) {
        for (value, x) in row.iter().zip(incident.windows(2)) {
            let fill = color(value / most);
            if fill == "#ffffff" {
                continue;
            }
            let (left, top) = (x_of(x[0]), y_of(y[1]));
            let cell = at("rect", hundredths(left), hundredths(top))
                .with("width", hundredths(x_of(x[1]) - left))
                .with("height", hundredths(y_of(y[0]) - top));
            cells.push(cell.with("fill", fill).empty());
        }
    }
    let cells = Element::new("g").with("shape-rendering", "crispEdges").around(cells.join("\n"));
    let mut elements = vec![
        at("text", left + width / 2.0, MAP_TOP - 16.0).with("text-anchor", "middle").around(name),
        cells,
    ];
    for nm in ticks(&incident) {
        let x = hundredths(x_of(nm));
        let number = at("text", &x, MAP_TOP + height + 22.0).with("text-anchor", "middle");
        elements.push(line(&x, MAP_TOP + height, &x, MAP_TOP + height + 6.0, INK).empty());
        elements.push(number.around(nm));
    }
    for nm in ticks(&outgoing) {
        let y = hundredths(y_of(nm));
        elements.push(line(left - 6.0, &y, left, &y, INK).empty());
        let number = at("text", left - 11.0, hundredths(y_of(nm) + 5.0));
        elements.push(number.with("text-anchor", "end").around(nm));
    }
    elements.push(outlined(at("rect", left, MAP_TOP), MAP_SIZE, INK));
    let name_of_x = at("text", left + width / 2.0, MAP_TOP + height + 46.0);
    elements.push(name_of_x.with("text-anchor", "middle").around("incident wavelength / nm"));
    if left == MAPS[0] {
        elements.push(turned(24.0, MAP_TOP + height / 2.0, "outgoing wavelength / nm"));
    }
    elements
}

/// The hundreds of nanometers between borders.
fn ticks(borders: &[f64]) -> impl Iterator<Item = f64> + use<> {
    let [first, last] = [borders[0], borders[borders.len() - 1]];
    (1..=30).map(|k| f64::from(100 * k)).filter(move |nm| (first..=last).contains(nm))
}

fn turned(x: f64, y: f64, words: &str) -> String {
    Element::new("text")
        .with("transform", format_args!("translate({x} {y}) rotate(-90)"))
        .with("text-anchor", "middle")
        .around(words)
}

/// The colors of the maps and what they stand for.
fn scale(most: f64) -> Vec<String> {
    const STEPS: u8 = 48;
    let height = MAP_SIZE[1] / f64::from(STEPS);
    let step = |k: u8| {
        let top = MAP_TOP + MAP_SIZE[1] - height * f64::from(k + 1);
        let share = (f64::from(k) + 0.5) / f64::from(STEPS);
        at("rect", SCALE, hundredths(top))
            .with("width", 22)
            .with("height", hundredths(height))
            .with("fill", color(share))
            .empty()
    };
    let steps = (0..STEPS).map(step).collect::<Vec<_>>().join("\n");
    let mut elements = vec![Element::new("g").with("shape-rendering", "crispEdges").around(steps)];
    for quarter in 0_u8..=4 {
        let y = MAP_TOP + MAP_SIZE[1] * (1.0 - f64::from(quarter) / 4.0) + 5.0;
        let value = format!("{:.4}", most * f64::from(quarter) / 4.0);
        elements.push(at("text", SCALE + 30.0, hundredths(y)).with("font-size", 12).around(value));
    }
    elements.push(outlined(at("rect", SCALE, MAP_TOP), [22.0, MAP_SIZE[1]], INK));
    for (row, words) in [(0_u8, "share per band;"), (1, "the diagonal is beyond")] {
        let y = MAP_TOP + MAP_SIZE[1] + 22.0 + 17.0 * f64::from(row);
        let note = at("text", WIDTH - 12.0, y).with("font-size", 12).with("text-anchor", "end");
        elements.push(note.around(words));
    }
    elements
}

/// The radiance factors under D65.
fn chart(figure: &MatrixFigure<'_>) -> Vec<String> {
    let nm = figure.measured.outgoing_nm();
    let [first, last] = [nm[0], nm[nm.len() - 1]];
    let factors =
        [figure.measured, figure.fitted].map(|matrix| figure.sums.radiance_factor(matrix));
    let most = factors.iter().flatten().flatten().copied().fold(1.0, f64::max);
    let step = if most > 3.0 { 1.0 } else { 0.2 };
    let x_of = |nm: f64| LEFT + (nm - first) / (last - first) * (RIGHT - LEFT);
    let y_of = |value: f64| BOTTOM + value.max(0.0) / (1.05 * most) * (TOP - BOTTOM);
    let mut elements = Vec::new();
    let mut value = 0.0;
    while value <= 1.05 * most {
        let y = hundredths(y_of(value));
        elements.push(line(LEFT, &y, RIGHT, &y, FAINT).empty());
        let number = at("text", LEFT - 11.0, hundredths(y_of(value) + 5.0));
        elements.push(number.with("text-anchor", "end").around(format_args!("{value:.1}")));
        value += step;
    }
    for nm in ticks(&[first, last]) {
        let x = hundredths(x_of(nm));
        elements.push(line(&x, TOP, &x, BOTTOM, FAINT).empty());
        let number = at("text", &x, BOTTOM + 22.0).with("text-anchor", "middle");
        elements.push(number.around(nm));
    }
    let curves = [("measured", INK, "none"), ("fitted", "#d55e00", "7 4")];
    for ((k, (name, color, dashes)), factors) in (0_u8..).zip(curves).zip(&factors) {
        let points = nm.iter().zip(factors).filter_map(|(nm, f)| Some([x_of(*nm), y_of((*f)?)]));
        let stroke = |element: Element| {
            element.with("stroke-width", 2.4).with("stroke-dasharray", dashes).empty()
        };
        let curve = Element::new("polyline").with("points", upglow_svg::points(points, hundredths));
        elements.push(stroke(curve.with("fill", "none").with("stroke", color)));
        let y = TOP + 8.0 + 22.0 * f64::from(k);
        elements.push(stroke(line(SIDE, y, SIDE + 30.0, y, color)));
        elements.push(at("text", SIDE + 40.0, y + 5.0).around(name));
    }
    elements.push(outlined(at("rect", LEFT, TOP), [RIGHT - LEFT, BOTTOM - TOP], INK));
    let name_of_x = at("text", (LEFT + RIGHT) / 2.0, BOTTOM + 48.0).with("text-anchor", "middle");
    elements.push(name_of_x.around("outgoing wavelength / nm"));
    elements.push(turned(24.0, (TOP + BOTTOM) / 2.0, "radiance factor under D65"));
    elements
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_scale_goes_from_white_to_dark() {
        assert_eq!(
            [-1.0, 0.0, 0.25, 1.0, 7.0].map(color),
            ["#ffffff", "#ffffff", "#fddb87", "#2d0c48", "#2d0c48"]
        );
    }

    #[test]
    fn bands_end_in_the_middle_between_wavelengths() {
        assert_eq!(borders(&[400.0, 410.0, 430.0]), [395.0, 405.0, 420.0, 440.0]);
        assert_eq!(ticks(&[300.0, 705.0]).collect::<Vec<_>>(), [300.0, 400.0, 500.0, 600.0, 700.0]);
    }
}
