//! Colors of an OpenEXR file.

use std::ops::Range;
use std::path::Path;

use upglow_color::RgbSpace;

use super::chromaticities;
use super::encoding::Encoding;
use super::error::PictureError;
use super::source::{Alpha, Facts, Pixels, Source};
use crate::exr::error::listed;
use crate::exr::header::{Channel, Header};
use crate::exr::reader::ExrReader;

#[derive(Debug)]
pub(super) struct ExrPicture {
    reader: ExrReader,
    /// Channels of red, green and blue; three times the same for gray.
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
        let channels: Vec<usize> = self.colors.into_iter().chain(self.alpha).collect();
        let mut planes = self.reader.read_rows(rows, &channels)?;
        let alpha = planes.drain(self.colors.len()..).next();
        let colors = planes[0].iter().zip(&planes[1]).zip(&planes[2]);
        let rgb = colors.map(|((r, g), b)| [*r, *g, *b]).collect();
        Ok((rgb, alpha))
    }
}

/// The color channels of one layer: the part, and the text before `R` in the channel's name.
#[derive(Clone, Debug, PartialEq)]
struct Layer {
    part: usize,
    part_name: Option<String>,
    prefix: String,
}

impl Layer {
    fn label(&self) -> &str {
        let layer = self.prefix.strip_suffix('.');
        layer.or(self.part_name.as_deref()).unwrap_or("R, G, B")
    }
}

/// The layer of the only plain R, G, B or Y, or the only layer of the file.
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
    let channels = parts.iter().flat_map(|part| &part.channels).map(|c| c.name.as_str());
    let (found, expected) = match all {
        [] => (listed(channels), "R, G, B or Y"),
        _ => (listed(all.iter().map(Layer::label)), "one set of R, G, B"),
    };
    PictureError::Pixels { found: format!("channels {found}"), expected }
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
    let attributes = reader.attributes();
    let stated = attributes.get("chromaticities");
    if let Some(found) = stated.and_then(|value| value.as_singles("chromaticities")) {
        let [rx, ry, gx, gy, bx, by, wx, wy] = found.map(f64::from);
        return chromaticities::space([[rx, ry], [gx, gy], [bx, by]], [wx, wy]);
    }
    let is_aces = attributes.get("acesImageContainerFlag")?.of_kind("int") == Some(&[1, 0, 0, 0]);
    RgbSpace::named("aces2065-1").ok().filter(|_| is_aces)
}
