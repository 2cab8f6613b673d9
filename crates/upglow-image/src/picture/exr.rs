//! Colors of an OpenEXR file.

use std::ops::Range;
use std::path::Path;

use upglow_color::RgbSpace;

use super::chromaticities::space_of_singles;
use super::encoding::Encoding;
use super::error::PictureError;
use super::source::{Alpha, Facts, Pixels, Source};
use crate::exr::attribute::Attribute;
use crate::exr::header::{Channel, Header};
use crate::exr::reader::ExrReader;

#[derive(Debug)]
pub(super) struct ExrPicture {
    reader: ExrReader,
    /// Numbers of red, green and blue; three times the same for gray.
    colors: [usize; 3],
    alpha: Option<usize>,
}

impl ExrPicture {
    pub(super) fn open(path: &Path) -> Result<(Box<dyn Source>, Facts), PictureError> {
        let mut prefix = String::new();
        let reader = ExrReader::open_with(path, |parts| {
            let chosen = choose(parts)?;
            prefix = chosen.prefix;
            Ok::<_, PictureError>(chosen.part)
        })?;
        let index = |name: &str| reader.channel(&format!("{prefix}{name}"));
        let colors = match (index("R"), index("G"), index("B")) {
            (Ok(red), Ok(green), Ok(blue)) => [red, green, blue],
            _ => [index("Y")?; 3],
        };
        let alpha = index("A").ok();
        let facts = Facts {
            size: reader.size(),
            space: space(&reader),
            encoding: Some(Encoding::Linear),
            alpha: alpha.map(|_| Alpha::Associated),
            windows: Some(reader.windows()),
            block_rows: reader.block_rows(),
        };
        Ok((Box::new(Self { reader, colors, alpha }), facts))
    }
}

impl Source for ExrPicture {
    fn read(&mut self, rows: Range<usize>) -> Result<Pixels, PictureError> {
        let [red, green, blue] = self.colors;
        let gray = red == green;
        let colors = if gray { vec![red] } else { vec![red, green, blue] };
        let channels: Vec<usize> = colors.into_iter().chain(self.alpha).collect();
        let planes = self.reader.read_rows(rows, &channels)?;
        let plane = |k: usize| &planes[if gray { 0 } else { k }];
        let rgb = plane(0).iter().zip(plane(1)).zip(plane(2)).map(|((r, g), b)| [*r, *g, *b]);
        let rgb = rgb.collect();
        Ok((rgb, self.alpha.and(planes.into_iter().last())))
    }
}

/// A set of colors in a file: the part, and what stands before `R` in the channel's name.
#[derive(Clone, Debug, PartialEq)]
struct Layer {
    part: usize,
    part_name: Option<String>,
    prefix: String,
}

impl Layer {
    fn label(&self) -> String {
        match (self.prefix.strip_suffix('.'), &self.part_name) {
            (Some(layer), _) => layer.into(),
            (None, Some(part)) => part.clone(),
            (None, None) => "R, G, B".into(),
        }
    }
}

/// The only plain R, G, B, or the only layer there is.
fn choose(parts: &[Header]) -> Result<Layer, PictureError> {
    let all: Vec<Layer> = parts.iter().enumerate().flat_map(|(i, part)| layers(i, part)).collect();
    let only = |wanted: fn(&Layer) -> bool| {
        let mut fitting = all.iter().filter(|layer| wanted(layer));
        fitting.next().filter(|_| fitting.next().is_none()).cloned()
    };
    let chosen = only(|layer| layer.prefix.is_empty()).or_else(|| only(|_| true));
    chosen.ok_or_else(|| not_chosen(parts, &all))
}

fn not_chosen(parts: &[Header], all: &[Layer]) -> PictureError {
    /// A line that a person reads.
    const SHOWN: usize = 12;
    let (names, expected): (Vec<String>, _) = match all {
        [] => {
            let channels = parts.iter().flat_map(|part| &part.channels);
            (channels.map(|c| c.name.clone()).take(SHOWN + 1).collect(), "R, G, B or Y")
        }
        _ => (all.iter().map(Layer::label).take(SHOWN + 1).collect(), "one set of R, G, B"),
    };
    let mut found: Vec<String> = names.iter().map(|name| brief(name)).collect();
    if found.len() > SHOWN {
        found[SHOWN] = "…".into();
    }
    PictureError::Channels { found, expected }
}

/// A name as a part of one line.
fn brief(name: &str) -> String {
    /// Layers are named with a word or two.
    const LONGEST: usize = 20;
    name.chars().take(LONGEST).map(|c| if c.is_control() { '\u{fffd}' } else { c }).collect()
}

fn layers(part: usize, header: &Header) -> Vec<Layer> {
    let names: Vec<&str> = header.channels.iter().map(|c: &Channel| c.name.as_str()).collect();
    let has = |prefix: &str, name: &str| names.iter().any(|n| n.strip_prefix(prefix) == Some(name));
    let with = |prefix: &str| Layer { part, part_name: header.name.clone(), prefix: prefix.into() };
    let colored = names.iter().filter_map(|n| n.strip_suffix('R'));
    let colored = colored.filter(|p| is_prefix(p) && has(p, "G") && has(p, "B"));
    let mut found: Vec<Layer> = colored.map(with).collect();
    let gray = names.iter().filter_map(|n| n.strip_suffix('Y')).filter(|p| is_prefix(p));
    let gray: Vec<Layer> = gray.map(with).filter(|layer| !found.contains(layer)).collect();
    found.extend(gray);
    found
}

fn is_prefix(text: &str) -> bool {
    text.is_empty() || text.ends_with('.')
}

fn space(reader: &ExrReader) -> Option<RgbSpace> {
    match reader.attributes().get("chromaticities") {
        Some(Attribute::Chromaticities(found)) => space_of_singles(*found),
        _ => {
            let aces = reader.attributes().get("acesImageContainerFlag")?;
            RgbSpace::named("aces2065-1").ok().filter(|_| *aces == Attribute::Int(1))
        }
    }
}
