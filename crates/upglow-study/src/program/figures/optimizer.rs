//! Figures 3, 6 and 7: what metric and sweeps do to a layer.

use upglow_color::{Choice, Grid, Metric};

use super::cut::Cut;
use super::sheet::{Sheet, errors_text, layers_page};
use super::{Figure, Studio};
use crate::cubes::StudyCube;
use crate::error::StudyError;
use upglow_study::Layer;

/// A cube by the paper's method and the name of its metric, for a drawing and for a caption.
#[derive(Clone, Copy, Debug)]
struct Variant {
    metric: Metric,
    sweeps: u32,
}

impl Variant {
    fn marked(self) -> String {
        let metric = match self.metric {
            Metric::Rgb => "RGB distance",
            Metric::De76 => "Δ*E*_{76}",
            Metric::De2000 => "Δ*E*_{00}",
            other => other.name(),
        };
        format!("{metric}, {} sweeps", self.sweeps)
    }

    fn plain(self) -> String {
        let metric = match self.metric {
            Metric::Rgb => "Euclidean distance in RGB",
            Metric::De76 => "ΔE76",
            Metric::De2000 => "ΔE00",
            other => other.name(),
        };
        format!("{metric}, {} sweeps", self.sweeps)
    }

    /// The layer of nodes nearest to `blue`.
    fn layer(self, studio: &Studio<'_>, blue: f64) -> Result<Layer, StudyError> {
        let Self { metric, sweeps } = self;
        let cube = studio.cubes.get(StudyCube::Paper { metric, sweeps }, studio.watch)?;
        Ok(Layer::of_nodes(&cube, Layer::nearest_node(cube.resolution(), blue)))
    }
}

const RGB_4: Variant = Variant { metric: Metric::Rgb, sweeps: 4 };
const RGB_32: Variant = Variant { metric: Metric::Rgb, sweeps: 32 };
const DE76_4: Variant = Variant { metric: Metric::De76, sweeps: 4 };
const DE76_8: Variant = Variant { metric: Metric::De76, sweeps: 8 };
const DE2000_4: Variant = Variant { metric: Metric::De2000, sweeps: 4 };

const LETTERS: [&str; 4] = ["a", "b", "c", "d"];

/// The part of the layer that figure 3 shows, red and green.
const PART: [[f64; 2]; 2] = [[0.5, 1.0], [0.0, 0.5]];

pub(super) fn figure_3(studio: &Studio<'_>) -> Result<Figure, StudyError> {
    let variants = [RGB_32, DE2000_4];
    let layers = variants.map(|variant| variant.layer(studio, 0.7));
    let layers: Vec<Layer> = layers.into_iter().collect::<Result<_, _>>()?;
    let cuts = layers.iter().map(|layer| Cut::of(layer, PART[0], PART[1]));
    let panels: Vec<(Variant, Cut<'_>)> = variants.into_iter().zip(cuts).collect();
    let lead = format!(
        "Part of the layer of nodes at B = {:.3} (the one nearest to 0.7), by the paper's method.",
        layers[0].blue
    );
    Ok(page(studio, 3, "metrics-part", Sheet::shared(2, 1), &lead, &panels))
}

pub(super) fn figure_6(studio: &Studio<'_>) -> Result<Figure, StudyError> {
    let panels = [(RGB_4, 1.0), (DE76_4, 1.0), (RGB_4, 8.0 / 31.0), (DE76_4, 8.0 / 31.0)];
    let layers = panels.map(|(variant, blue)| variant.layer(studio, blue));
    let layers: Vec<Layer> = layers.into_iter().collect::<Result<_, _>>()?;
    let lead = format!(
        "Layers B = {:.0} (a, b) and B = {:.3} (c, d), by the paper's method.",
        layers[0].blue, layers[2].blue
    );
    let cuts = layers.iter().map(Cut::whole);
    let panels: Vec<(Variant, Cut<'_>)> = panels.map(|(v, _)| v).into_iter().zip(cuts).collect();
    Ok(page(studio, 6, "metrics", Sheet::shared(2, 2), &lead, &panels))
}

pub(super) fn figure_7(studio: &Studio<'_>) -> Result<Figure, StudyError> {
    let variants = [DE76_4, DE76_8, DE2000_4];
    let layers = variants.map(|variant| variant.layer(studio, 0.0));
    let layers: Vec<Layer> = layers.into_iter().collect::<Result<_, _>>()?;
    let cuts = layers.iter().map(Cut::whole);
    let panels: Vec<(Variant, Cut<'_>)> = variants.into_iter().zip(cuts).collect();
    let lead = "Layer B = 0, by the paper's method.";
    Ok(page(studio, 7, "sweeps", Sheet::shared(3, 1), lead, &panels))
}

/// Layers side by side, each with its metric, sweeps, blue and errors.
fn page(
    studio: &Studio<'_>,
    number: u32,
    name: &str,
    sheet: Sheet,
    lead: &str,
    panels: &[(Variant, Cut<'_>)],
) -> Figure {
    let painter = studio.display.painter(&upglow_color::Contract::default().on(Grid::FIT));
    let lettered = || LETTERS.into_iter().zip(panels);
    let titled: Vec<(String, Cut<'_>)> = lettered()
        .map(|(letter, (variant, cut))| {
            let blue = blue_text(cut.layer.blue);
            (format!("[{letter}] {}, *B* = {blue}", variant.marked()), *cut)
        })
        .collect();
    let parts: Vec<String> = lettered()
        .map(|(letter, (variant, cut))| {
            format!("({letter}) {}: {}", variant.plain(), errors_text(cut))
        })
        .collect();
    let caption = format!("{lead} {}. {}", parts.join("; "), studio.display.note());
    Figure::new(number, name, layers_page(&sheet, &titled, painter), caption)
}

fn blue_text(blue: f64) -> String {
    if blue == 0.0 || blue == 1.0 { format!("{blue:.0}") } else { format!("{blue:.3}") }
}
