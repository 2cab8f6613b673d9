//! The report of `upglow relight`.

use serde::Serialize;
use upglow_color::{Adaptation, Xyz};
use upglow_fit::Appearance;
use upglow_terminal::Report;

use super::color_report::{BAND, BAND_NOTE, SHARE_NOTE, band, percent, scale_note};
use super::relight::MOST_SHOWN;
use crate::color_list::NamedColor;
use crate::output::{Lines, Side, Table, decimal, triple};
use crate::plot::Swatch;

#[derive(Debug, Serialize)]
pub(crate) struct RelightReport<'a> {
    pub(crate) file: String,
    pub(crate) rgb_space: &'a str,
    /// The light of the cube.
    pub(crate) illuminant: &'a str,
    pub(crate) adaptation: Adaptation,
    pub(crate) colors: &'a [NamedColor],
    pub(crate) views: &'a [ViewReport],
    pub(crate) csv: Option<String>,
    pub(crate) plot: Option<String>,
}

/// What an observer sees under a light.
#[derive(Debug, Serialize)]
pub(crate) struct ViewReport {
    pub(crate) light: String,
    pub(crate) observer: String,
    pub(crate) is_adapted: bool,
    /// What the observer sees as white.
    pub(crate) white: Xyz,
    pub(crate) missing_ultraviolet: Option<String>,
    /// One for each color.
    #[serde(rename = "colors")]
    pub(crate) appearances: Vec<Appearance>,
    /// One for each of the first colors.
    #[serde(skip)]
    pub(crate) swatches: Vec<Swatch>,
}

impl Report for RelightReport<'_> {
    fn text(&self) -> String {
        let shown = self.colors.iter().enumerate().take(MOST_SHOWN);
        let mut blocks: Vec<String> = shown.map(|(i, color)| self.color(i, color)).collect();
        blocks.push(self.notes());
        blocks.join("\n")
    }
}

impl RelightReport<'_> {
    /// One color under each light.
    fn color(&self, index: usize, color: &NamedColor) -> String {
        let mut table = Table::new([
            ("light", Side::Left),
            ("X        Y        Z", Side::Right),
            ("L*      a*      b*", Side::Right),
            ("R        G        B", Side::Right),
            ("ΔE00", Side::Right),
            ("fluorescent", Side::Right),
            ("W", Side::Right),
            ("T", Side::Right),
            (if self.has_bands() { BAND } else { "" }, Side::Right),
        ]);
        let names_observers = self.views.iter().any(|v| v.observer != self.views[0].observer);
        for view in self.views {
            let Appearance { xyz, lab, rgb, de2000, fluorescent_share, whiteness, band_de2000 } =
                view.appearances[index];
            let observer =
                if names_observers { format!(", {}", view.observer) } else { String::new() };
            let some = |value: Option<f64>, decimals| {
                value.map_or(String::new(), |value| decimal(value, 0, decimals))
            };
            table.add([
                format!("{}{observer}", view.light),
                triple(xyz.0),
                [lab.l, lab.a, lab.b].map(|v| decimal(v, 6, 2)).join("  "),
                triple(rgb.0),
                some(de2000, 2),
                percent(fluorescent_share),
                some(whiteness.map(|w| w.whiteness), 1),
                some(whiteness.map(|w| w.tint), 1),
                band(band_de2000),
            ]);
        }
        let name = if color.name.is_empty() { String::new() } else { format!("{}: ", color.name) };
        format!("{name}{} {}\n{table}", self.rgb_space, color.numbers())
    }

    fn has_bands(&self) -> bool {
        let mut seen = self.views.iter().flat_map(|view| &view.appearances);
        seen.next().is_some_and(|appearance| appearance.band_de2000.is_some())
    }

    fn notes(&self) -> String {
        let mut text = String::new();
        if let Some(more) = self.colors.len().checked_sub(MOST_SHOWN).filter(|more| *more > 0) {
            text += &format!("{more} more colors: --csv FILE.csv or --json has all.\n\n");
        }
        let mut dark: Vec<&str> = Vec::new();
        for view in self.views.iter().filter(|view| !view.is_adapted) {
            if !dark.contains(&view.light.as_str()) {
                dark.push(&view.light);
            }
        }
        text += &scale_note(self.rgb_space, self.illuminant, self.adaptation, &dark);
        text += &format!(
            "L* a* b* are relative to white. ΔE00: difference from the color under {}, each as seen by an\n\
             observer adapted to the light. {SHARE_NOTE} W, T: whiteness and tint\n\
             of the CIE, of whites under light like D65.\n",
            self.illuminant
        );
        text += if self.has_bands() { BAND_NOTE } else { "" };
        let mut files = Lines::default();
        for (name, path) in [("table", &self.csv), ("plot", &self.plot)] {
            if let Some(path) = path {
                files.add(name, path);
            }
        }
        text + &files.to_string()
    }
}
