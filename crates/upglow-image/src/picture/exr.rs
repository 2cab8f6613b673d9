//! Colors of an OpenEXR file.

use std::collections::BTreeSet;
use std::ops::Range;
use std::path::Path;

use upglow_color::RgbSpace;

use super::chromaticities;
use super::encoding::Encoding;
use super::error::PictureError;
use super::interop::InteropSpace;
use super::source::{Alpha, Facts, LastSample, Pixels, Source, check_memory};
use super::stated::{Stated, StatedColor};
use crate::exr::error::{listed, shown};
use crate::exr::header::{Channel, Header, Sample};
use crate::exr::reader::ExrReader;

#[derive(Debug)]
pub(super) struct ExrPicture {
    reader: ExrReader,
    /// Channels of red, green and blue; three times the same for gray.
    colors: [usize; 3],
    alpha: Option<usize>,
}

/// Rows of a tile that may be decompressed again for each band, where its pixels take more memory than is kept.
const KEPT_ROWS: usize = 64;

impl ExrPicture {
    pub(super) fn open(
        path: &Path,
        layer: Option<&str>,
    ) -> Result<(Box<dyn Source>, Facts), PictureError> {
        let mut prefix = String::new();
        let reader = ExrReader::open_with(path, |parts| {
            let chosen = choose(parts, layer)?;
            prefix = chosen.prefix;
            Ok::<_, PictureError>(chosen.part)
        })?;
        // Of higher blocks the rows that follow are kept, because each row would decompress them again.
        if reader.block_rows() > KEPT_ROWS {
            check_memory("a row of tiles", reader.block_row_bytes())?;
        }
        let index = |name: &str| reader.channel(&format!("{prefix}{name}"));
        let colors = match (index("R"), index("G"), index("B")) {
            (Ok(red), Ok(green), Ok(blue)) => [red, green, blue],
            _ => [index("Y")?; 3],
        };
        let alpha = index("A").ok();
        let facts = Facts {
            size: reader.size(),
            color: stated_color(&reader),
            last_sample: match alpha {
                Some(_) => LastSample::Alpha(Alpha::Associated),
                None => LastSample::Absent,
            },
            windows: Some(reader.windows()),
            orientation: 1,
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

    /// The name of the part and that of the layer in it.
    fn full(&self) -> Option<String> {
        Some(format!("{}.{}", self.part_name.as_deref()?, self.prefix.strip_suffix('.')?))
    }

    fn is_named(&self, name: &str) -> bool {
        self.label() == name
            || self.part_name.as_deref() == Some(name)
            || self.full().as_deref() == Some(name)
    }
}

/// The chosen layer; by default that of the only plain R, G, B or Y, or the only one of the file.
fn choose(parts: &[Header], name: Option<&str>) -> Result<Layer, PictureError> {
    let of_parts = |is_counted: fn(&Channel) -> bool| -> Vec<Layer> {
        let each = parts.iter().enumerate();
        each.flat_map(|(i, part)| layers(i, part, is_counted)).collect()
    };
    let all = of_parts(|channel| channel.sample != Sample::Uint);
    // What would be a layer if integers were colors.
    let refused = |is_wanted: &dyn Fn(&Layer) -> bool| {
        let mut possible = of_parts(|_| true).into_iter().filter(|layer| !all.contains(layer));
        possible.find(is_wanted).map(|layer| of_integers(&layer, &parts[layer.part]))
    };
    let only = |wanted: &dyn Fn(&Layer) -> bool| {
        let mut fitting = all.iter().filter(|layer| wanted(layer));
        fitting.next().filter(|_| fitting.next().is_none()).cloned()
    };
    if let Some(name) = name {
        let chosen = only(&|layer| layer.full().as_deref() == Some(name));
        let chosen = chosen.or_else(|| only(&|layer| layer.is_named(name)));
        let expected = || match &all[..] {
            [] => EXPECTED.into(),
            _ => format!("one of the layers {}", labels(&all)),
        };
        return chosen.ok_or_else(|| {
            refused(&|layer| layer.is_named(name)).unwrap_or_else(|| PictureError::Channels {
                found: format!("without one color layer {:?}", shown(name)),
                expected: expected(),
            })
        });
    }
    let chosen = only(&|layer| layer.prefix.is_empty()).or_else(|| only(&|_| true));
    chosen.ok_or_else(|| match &all[..] {
        [] => refused(&|_| true).unwrap_or_else(|| {
            let channels = parts.iter().flat_map(|part| &part.channels);
            let names = listed(channels.map(|c| c.name.as_str()));
            let is_luma = parts.iter().any(|p| p.channels.iter().any(|c| is_chroma(&c.name)));
            let kind = if is_luma { ": luminance and chroma" } else { "" };
            PictureError::Channels { found: names + kind, expected: EXPECTED.into() }
        }),
        _ => PictureError::Layers { found: labels(&all) },
    })
}

const EXPECTED: &str = "R, G and B, or Y alone: save the picture with these";

/// The layers' names, which are those of part and layer where that of the layer alone is ambiguous.
fn labels(all: &[Layer]) -> String {
    let name = |layer: &Layer| {
        let is_ambiguous = all.iter().filter(|other| other.is_named(layer.label())).count() > 1;
        let full = layer.full().filter(|_| is_ambiguous);
        full.unwrap_or_else(|| layer.label().to_owned())
    };
    listed(all.iter().map(name))
}

/// The error of a layer some of whose colors are integers.
fn of_integers(layer: &Layer, header: &Header) -> PictureError {
    let is_color = |c: &&Channel| {
        c.name.strip_prefix(&layer.prefix).is_some_and(|name| ["R", "G", "B", "Y"].contains(&name))
    };
    let integers = header.channels.iter().filter(is_color).filter(|c| c.sample == Sample::Uint);
    let found = format!("{} of 32-bit integers", listed(integers.map(|c| c.name.as_str())));
    PictureError::Channels {
        found,
        expected: "half or float: save the picture as one of these".into(),
    }
}

/// The layers of a part among the channels that are counted.
fn layers(part: usize, header: &Header, is_counted: fn(&Channel) -> bool) -> Vec<Layer> {
    let counted = header.channels.iter().filter(|channel| is_counted(channel));
    let names: BTreeSet<&str> = counted.map(|c| c.name.as_str()).collect();
    let has = |prefix: &str, name: &str| names.contains(format!("{prefix}{name}").as_str());
    let with = |prefix: &str| Layer { part, part_name: header.name.clone(), prefix: prefix.into() };
    let is_colored = |p: &&str| is_prefix(p) && ["R", "G", "B"].iter().all(|n| has(p, n));
    // Beside X, Z or chroma, Y is a coordinate or a luminance.
    let is_gray = |p: &&str| is_prefix(p) && !["X", "Z", "RY", "BY"].iter().any(|n| has(p, n));
    let colored = names.iter().filter_map(|n| n.strip_suffix('R')).filter(is_colored);
    let gray = names.iter().filter_map(|n| n.strip_suffix('Y')).filter(is_gray);
    let gray = gray.filter(|p| !is_colored(p));
    colored.chain(gray).map(with).collect()
}

fn is_prefix(text: &str) -> bool {
    text.is_empty() || text.ends_with('.')
}

fn is_chroma(name: &str) -> bool {
    ["RY", "BY"].contains(&name.rsplit('.').next().unwrap_or_default())
}

/// What a file states, in the order of the Color Interop Forum.
fn stated_color(reader: &ExrReader) -> StatedColor {
    let attributes = reader.attributes();
    let is_aces = attributes
        .get("acesImageContainerFlag")
        .is_some_and(|flag| flag.of_kind("int") == Some(&[1, 0, 0, 0]));
    if is_aces {
        let space = RgbSpace::named("aces2065-1").expect("it is built in");
        return StatedColor::yes(space, Encoding::Linear, "acesImageContainerFlag");
    }
    if let Some(id) = attributes.get("colorInteropID").and_then(|id| id.as_text()) {
        return match InteropSpace::of_id(id) {
            Some(InteropSpace::Color(space, encoding)) => {
                StatedColor::yes(space, encoding, "colorInteropID")
            }
            _ => StatedColor::unread(format!("colorInteropID {:?}", shown(id))),
        };
    }
    const BY: &str = "chromaticities";
    let space = match attributes.get(BY) {
        None => Stated::No,
        Some(value) => match value.as_singles(BY) {
            Some(found) => {
                let [rx, ry, gx, gy, bx, by, wx, wy] = found.map(f64::from);
                chromaticities::stated(BY, [[rx, ry], [gx, gy], [bx, by]], [wx, wy])
            }
            None => Stated::Unread(format!("{BY} of the type {}", shown(&value.kind))),
        },
    };
    StatedColor { space, encoding: Stated::yes(Encoding::Linear, "OpenEXR") }
}
