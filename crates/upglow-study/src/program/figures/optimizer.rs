//! Figures 3, 6 and 7: how the metric and the number of sweeps affect a layer.

use upglow_color::{Choice, Metric};
use upglow_fit::BuildError;
use upglow_study::Layer;

use super::cut::Cut;
use super::sheet::{Sheet, layers_page};
use super::{Figure, Studio};
use crate::cubes::StudyCube;

/// The metric and sweeps of a cube by the paper's method.
type Variant = (Metric, u32);

const RGB_4: Variant = (Metric::Rgb, 4);
const RGB_32: Variant = (Metric::Rgb, 32);
const DE76_4: Variant = (Metric::De76, 4);
const DE76_8: Variant = (Metric::De76, 8);
const DE2000_4: Variant = (Metric::De2000, 4);

/// The whole layer, red and green.
const WHOLE: [[f64; 2]; 2] = [[0.0, 1.0], [0.0, 1.0]];
/// The part of the layer that figure 3 shows, red and green.
const PART: [[f64; 2]; 2] = [[0.5, 1.0], [0.0, 0.5]];

pub(super) fn figure_3(studio: &Studio<'_>) -> Result<Figure, BuildError> {
    let layers = layers(studio, [(RGB_32, 0.7), (DE2000_4, 0.7)])?;
    let lead = format!(
        "Part of the layer of nodes at B = {:.3} (the one nearest to 0.7), by the paper's method.",
        layers[0].1.blue
    );
    Ok(page(studio, 3, "metrics-part", Sheet::shared(2, 1), &lead, &layers, PART))
}

pub(super) fn figure_6(studio: &Studio<'_>) -> Result<Figure, BuildError> {
    let panels = [(RGB_4, 1.0), (DE76_4, 1.0), (RGB_4, 8.0 / 31.0), (DE76_4, 8.0 / 31.0)];
    let layers = layers(studio, panels)?;
    let lead = format!(
        "Layers B = {:.0} (a, b) and B = {:.3} (c, d), by the paper's method.",
        layers[0].1.blue, layers[2].1.blue
    );
    Ok(page(studio, 6, "metrics", Sheet::shared(2, 2), &lead, &layers, WHOLE))
}

pub(super) fn figure_7(studio: &Studio<'_>) -> Result<Figure, BuildError> {
    let layers = layers(studio, [(DE76_4, 0.0), (DE76_8, 0.0), (DE2000_4, 0.0)])?;
    let lead = "Layer B = 0, by the paper's method.";
    Ok(page(studio, 7, "sweeps", Sheet::shared(3, 1), lead, &layers, WHOLE))
}

/// For each variant and blue the layer of nodes nearest to that blue.
fn layers<const N: usize>(
    studio: &Studio<'_>,
    panels: [(Variant, f64); N],
) -> Result<Vec<(Variant, Layer)>, BuildError> {
    let layer = |((metric, sweeps), blue)| {
        let cube = studio.cubes.get(StudyCube::Paper { metric, sweeps }, studio.watch)?;
        let index = Layer::nearest_node(cube.resolution(), blue);
        Ok(((metric, sweeps), Layer::of_nodes(&cube, index)))
    };
    panels.into_iter().map(layer).collect()
}

/// Layers side by side, each with its metric, sweeps, blue and errors.
fn page(
    studio: &Studio<'_>,
    number: u32,
    name: &str,
    sheet: Sheet,
    lead: &str,
    layers: &[(Variant, Layer)],
    [red, green]: [[f64; 2]; 2],
) -> Figure {
    let mut panels = Vec::new();
    for ((metric, sweeps), layer) in layers {
        let (marked, plain) = match metric {
            Metric::Rgb => ("RGB distance", "Euclidean distance in RGB"),
            Metric::De76 => ("Δ*E*_{76}", "ΔE76"),
            Metric::De2000 => ("Δ*E*_{00}", "ΔE00"),
            other => (other.name(), other.name()),
        };
        let blue = blue_text(layer.blue);
        let title = format!("{marked}, {sweeps} sweeps, *B* = {blue}");
        panels.push((title, format!("{plain}, {sweeps} sweeps"), Cut::of(layer, red, green)));
    }
    let (drawing, parts) = layers_page(studio, &sheet, &panels);
    let caption = format!("{lead} {parts}. {}", studio.display.note());
    Figure::new(number, name, drawing, caption)
}

fn blue_text(blue: f64) -> String {
    if blue == 0.0 || blue == 1.0 { format!("{blue:.0}") } else { format!("{blue:.3}") }
}
