//! Colors of a TIFF file, read without a crate: `docs/dependencies.md` says why.

mod directory;
mod packed;
mod samples;

use std::fs::File;
use std::io::BufReader;
use std::ops::Range;
use std::path::Path;

pub(super) use self::directory::Directory;
use self::directory::damaged;
use self::packed::{Method, Packed};
use self::samples::{Number, Predictor, Storage};
use upglow::open_input;

use super::chromaticities::stated;
use super::encoding::Encoding;
use super::error::PictureError;
use super::icc;
use super::source::{Alpha, Facts, LastSample, Pixels, Source, check_memory, check_size, pixels};
use super::stated::{Stated, StatedColor};

#[derive(Debug)]
pub(super) struct TiffPicture {
    layout: Layout,
    /// A reader for each plane.
    planes: Vec<Packed>,
    row: Vec<u8>,
    numbers: Vec<f32>,
    /// Rows of the row of tiles that was read last, and their samples.
    tiles: (Range<usize>, Vec<f32>),
}

/// How the samples of a picture are stored.
#[derive(Debug)]
struct Layout {
    size: [usize; 2],
    /// Columns and rows of a strip or tile.
    chunk: [usize; 2],
    is_tiled: bool,
    /// Strips or tiles from left to right.
    across: usize,
    storage: Storage,
    /// Position and bytes of each strip or tile.
    chunks: Vec<[u64; 2]>,
    /// Separately stored planes; 1 if pixels are interleaved.
    planes: usize,
    /// The samples of a pixel that are read: gray or RGB, and the last sample.
    read: Vec<usize>,
    /// Whether 0 is white.
    is_inverted: bool,
}

/// The tags that are used, by their names in TIFF 6.0.
mod tag {
    pub(super) const NEW_SUBFILE_TYPE: u16 = 254;
    pub(super) const IMAGE_WIDTH: u16 = 256;
    pub(super) const IMAGE_LENGTH: u16 = 257;
    pub(super) const BITS_PER_SAMPLE: u16 = 258;
    pub(super) const COMPRESSION: u16 = 259;
    pub(super) const PHOTOMETRIC: u16 = 262;
    pub(super) const FILL_ORDER: u16 = 266;
    pub(super) const STRIP_OFFSETS: u16 = 273;
    pub(in super::super) const ORIENTATION: u16 = 274;
    pub(super) const SAMPLES_PER_PIXEL: u16 = 277;
    pub(super) const ROWS_PER_STRIP: u16 = 278;
    pub(super) const STRIP_BYTE_COUNTS: u16 = 279;
    pub(super) const PLANAR_CONFIGURATION: u16 = 284;
    pub(super) const PREDICTOR: u16 = 317;
    pub(super) const WHITE_POINT: u16 = 318;
    pub(super) const PRIMARIES: u16 = 319;
    pub(super) const TILE_WIDTH: u16 = 322;
    pub(super) const TILE_LENGTH: u16 = 323;
    pub(super) const TILE_OFFSETS: u16 = 324;
    pub(super) const TILE_BYTE_COUNTS: u16 = 325;
    pub(super) const EXTRA_SAMPLES: u16 = 338;
    pub(super) const SAMPLE_FORMAT: u16 = 339;
    pub(super) const ICC_PROFILE: u16 = 34675;
    pub(in super::super) const EXIF: u16 = 34665;
    /// In the directory of Exif.
    pub(in super::super) const EXIF_COLOR_SPACE: u16 = 40961;
}
pub(super) use self::tag::{EXIF, EXIF_COLOR_SPACE, ORIENTATION};

const KINDS: &str = "gray or RGB of 1 to 32 bit integers, or 16, 32 or 64 bit floats";
const COMPRESSIONS: &str = "none, LZW, deflate or PackBits: save the picture as one of these";

type Fields = Directory<BufReader<File>>;

impl TiffPicture {
    pub(super) fn open(path: &Path) -> Result<(Box<dyn Source>, Facts), PictureError> {
        let mut fields = Directory::read(BufReader::new(open_input(path)?))?;
        check_image(&mut fields)?;
        let method = fields.integer(tag::COMPRESSION, 1)?;
        let method = Method::of_code(method);
        let method = method.map_err(|found| PictureError::pixels(found, COMPRESSIONS))?;
        let is_reversed = fields.integer(tag::FILL_ORDER, 1)? == 2;
        let (layout, last_sample) = Layout::of(&mut fields, method)?;
        let color = stated_color(&mut fields, layout.storage.number)?;
        let facts = Facts {
            size: layout.size,
            color,
            last_sample,
            windows: None,
            orientation: fields.integer(tag::ORIENTATION, 1)?,
        };
        let planes = (0..layout.planes).map(|_| Packed::open(path, method, is_reversed));
        let planes = planes.collect::<Result<_, _>>()?;
        let (row, numbers, tiles) = (Vec::new(), Vec::new(), (0..0, Vec::new()));
        Ok((Box::new(Self { layout, planes, row, numbers, tiles }), facts))
    }

    /// Goes to the strip or tile in column `x` of row `y` of those of a plane.
    fn start(&mut self, plane: usize, [x, y]: [usize; 2]) -> Result<(), PictureError> {
        let Layout { size, chunk, across, .. } = self.layout;
        let down = size[1].div_ceil(chunk[1]);
        let index = (plane * down + y) * across + x;
        let found = self.layout.chunks.get(index);
        let &[at, bytes] = found.ok_or_else(|| damaged(format!("no strip or tile {index}")))?;
        self.planes[plane].start(at, bytes)
    }

    /// Reads the next row of the open strip or tile of a plane, and copies the samples of `columns`
    /// pixels to those of the picture's row that begins with `to`.
    fn read_row(
        &mut self,
        plane: usize,
        columns: usize,
        to: &mut [f32],
    ) -> Result<(), PictureError> {
        let Layout { storage, chunk, planes, is_inverted, .. } = self.layout;
        self.row.resize(storage.row_bytes(chunk[0]), 0);
        self.planes[plane].read(&mut self.row)?;
        storage.numbers(&mut self.row, &mut self.numbers);
        let read = &self.layout.read;
        let pixels = self.numbers.chunks_exact(storage.together).take(columns);
        for (from, to) in pixels.zip(to.chunks_exact_mut(read.len())) {
            for (to, &sample) in to.iter_mut().zip(read) {
                if planes == 1 {
                    *to = from[sample];
                } else if sample == plane {
                    *to = from[0];
                }
            }
            if is_inverted && (planes == 1 || plane == 0) {
                to[0] = 1.0 - to[0];
            }
        }
        Ok(())
    }
}

impl Source for TiffPicture {
    fn read(&mut self, rows: Range<usize>) -> Result<Pixels, PictureError> {
        let Layout { size, chunk, is_tiled, .. } = self.layout;
        let channels = self.layout.read.len();
        if !is_tiled {
            return Ok(pixels(&self.read_chunks(rows)?, channels));
        }
        let row = size[0] * channels;
        let mut samples = Vec::with_capacity(rows.len() * row);
        let mut y = rows.start;
        while y < rows.end {
            if !self.tiles.0.contains(&y) {
                let whole = y..size[1].min(y + chunk[1]);
                self.tiles = (whole.clone(), self.read_chunks(whole)?);
            }
            let (known, tiles) = &self.tiles;
            let end = rows.end.min(known.end);
            samples.extend_from_slice(&tiles[(y - known.start) * row..(end - known.start) * row]);
            y = end;
        }
        Ok(pixels(&samples, channels))
    }
}

impl TiffPicture {
    /// The samples of the next rows; with tiles, of a row of tiles.
    fn read_chunks(&mut self, rows: Range<usize>) -> Result<Vec<f32>, PictureError> {
        let Layout { size, chunk, across, is_tiled, .. } = self.layout;
        let channels = self.layout.read.len();
        let mut samples = vec![0.0; rows.len() * size[0] * channels];
        let planes: Vec<usize> = match self.layout.planes {
            1 => vec![0],
            _ => self.layout.read.clone(),
        };
        let mut y = rows.start;
        while y < rows.end {
            // A strip is read row by row, and stays open between bands; tiles are read as a whole.
            let top = y - y % chunk[1];
            let end = rows.end.min(top + chunk[1]);
            let is_whole = end == top + chunk[1] || !is_tiled && end == size[1];
            for x in 0..across {
                let columns = chunk[0].min(size[0] - x * chunk[0]);
                for &plane in &planes {
                    if y == top {
                        self.start(plane, [x, y / chunk[1]])?;
                    }
                    for row in y..end {
                        let first = (row - rows.start) * size[0] + x * chunk[0];
                        self.read_row(plane, columns, &mut samples[first * channels..])?;
                    }
                    if is_whole {
                        self.planes[plane].finish()?;
                    }
                }
            }
            y = end;
        }
        Ok(samples)
    }
}

/// Refuses directories that are not the picture itself.
fn check_image(fields: &mut Fields) -> Result<(), PictureError> {
    let found = match fields.integer(tag::NEW_SUBFILE_TYPE, 0)? {
        kind if kind & 1 != 0 => "a reduced picture first",
        kind if kind & 4 != 0 => "a mask first",
        _ => return Ok(()),
    };
    Err(PictureError::pixels(found, "a file whose first picture is the whole one"))
}

impl Layout {
    fn of(fields: &mut Fields, method: Method) -> Result<(Self, LastSample), PictureError> {
        let size = [side(fields, tag::IMAGE_WIDTH)?, side(fields, tag::IMAGE_LENGTH)?];
        check_size(size)?;
        let per_pixel = usize_of(fields.integer(tag::SAMPLES_PER_PIXEL, 1)?);
        let number = number(fields, per_pixel)?;
        let (colors, is_inverted) = colors(fields)?;
        if per_pixel < colors {
            let found = format!("{per_pixel} samples a pixel");
            return Err(PictureError::pixels(found, KINDS));
        }
        if is_inverted && matches!(number, Number::Float { .. }) {
            return Err(PictureError::pixels("floats whose 0 is white", KINDS));
        }
        let (last, last_sample) = last_sample(fields, colors, per_pixel)?;
        let is_planar = match fields.integer(tag::PLANAR_CONFIGURATION, 1)? {
            1 => false,
            2 => per_pixel > 1,
            other => return Err(damaged(format!("planar configuration {other}"))),
        };
        let planes = if is_planar { per_pixel } else { 1 };
        let storage = Storage {
            number,
            order: fields.order,
            predictor: predictor(fields, method, number)?,
            together: per_pixel / planes,
        };
        let is_tiled = fields.has(tag::TILE_WIDTH);
        let chunk = if is_tiled {
            [side(fields, tag::TILE_WIDTH)?, side(fields, tag::TILE_LENGTH)?]
        } else {
            let rows = fields.integer(tag::ROWS_PER_STRIP, u64::MAX)?;
            [size[0], usize_of(rows).min(size[1])]
        };
        if chunk.contains(&0) {
            let found = format!("strips or tiles of {} by {} pixels", chunk[0], chunk[1]);
            return Err(damaged(found));
        }
        let row_bytes = [chunk[0] as u64, storage.together as u64, number.bits() as u64];
        let row_bytes = row_bytes.into_iter().fold(1, u64::saturating_mul) / 8;
        check_memory("a row of a strip or tile", row_bytes)?;
        let read: Vec<usize> = (0..colors).chain(last).collect();
        if is_tiled {
            let rows = chunk[1].min(size[1]) as u64;
            let bytes = size_of::<[f32; 4]>() as u64;
            check_memory("a row of tiles", rows * size[0] as u64 * bytes)?;
        }
        let across = size[0].div_ceil(chunk[0]);
        let mut layout = Self {
            size,
            chunk,
            is_tiled,
            across,
            storage,
            chunks: Vec::new(),
            planes,
            read,
            is_inverted,
        };
        layout.chunks = layout.chunks(fields, method)?;
        Ok((layout, last_sample))
    }

    /// Position and bytes of each strip or tile.
    fn chunks(&self, fields: &mut Fields, method: Method) -> Result<Vec<[u64; 2]>, PictureError> {
        let [offsets, counts] = if self.is_tiled && fields.has(tag::TILE_OFFSETS) {
            [tag::TILE_OFFSETS, tag::TILE_BYTE_COUNTS]
        } else {
            [tag::STRIP_OFFSETS, tag::STRIP_BYTE_COUNTS]
        };
        let expected = self.across * self.size[1].div_ceil(self.chunk[1]) * self.planes;
        let offsets = fields.integers(offsets)?.unwrap_or_default();
        let counts = match fields.integers(counts)? {
            Some(counts) => counts,
            None if method == Method::Plain && expected == 1 => {
                vec![self.storage.row_bytes(self.chunk[0]).saturating_mul(self.chunk[1]) as u64]
            }
            None => Vec::new(),
        };
        if offsets.len() < expected || counts.len() < expected {
            let found = offsets.len().min(counts.len());
            return Err(damaged(format!("{found} of {expected} strips or tiles")));
        }
        Ok(offsets.into_iter().zip(counts).map(|(at, bytes)| [at, bytes]).collect())
    }
}

/// A width or height; 0 if the field is absent.
fn side(fields: &mut Fields, tag: u16) -> Result<usize, PictureError> {
    Ok(usize_of(fields.integer(tag, 0)?))
}

fn usize_of(value: u64) -> usize {
    usize::try_from(value).unwrap_or(usize::MAX)
}

/// Most samples of a pixel; sizes in bytes stay far from overflow.
const MAX_SAMPLES: usize = 1 << 12;

/// The type of the samples, which must be the same for all.
fn number(fields: &mut Fields, per_pixel: usize) -> Result<Number, PictureError> {
    if !(1..=MAX_SAMPLES).contains(&per_pixel) {
        return Err(PictureError::pixels(format!("{per_pixel} samples a pixel"), KINDS));
    }
    let mut common = |tag: u16, what: &str| {
        let values = fields.integers(tag)?.unwrap_or_else(|| vec![1]);
        let values = &values[..values.len().min(per_pixel)];
        match values {
            [first, rest @ ..] if rest.iter().all(|v| v == first) => Ok(*first),
            _ => Err(PictureError::pixels(format!("samples of {what} {values:?}"), KINDS)),
        }
    };
    let bits = common(tag::BITS_PER_SAMPLE, "bits")?;
    match (common(tag::SAMPLE_FORMAT, "formats")?, bits) {
        (1 | 4, 1..=32) => Ok(Number::Integer { bits: usize_of(bits) }),
        (3, 16 | 32 | 64) => Ok(Number::Float { bytes: usize_of(bits / 8) }),
        (format, bits) => {
            let format = match format {
                1 | 4 => "unsigned integers",
                2 => "signed integers",
                3 => "floats",
                _ => "complex numbers",
            };
            Err(PictureError::pixels(format!("{format} of {bits} bits"), KINDS))
        }
    }
}

/// How many samples make the color, and whether 0 is white.
fn colors(fields: &mut Fields) -> Result<(usize, bool), PictureError> {
    let Some(&[code, ..]) = fields.integers(tag::PHOTOMETRIC)?.as_deref() else {
        return Err(PictureError::pixels("a file that does not say what its samples are", KINDS));
    };
    let found = match code {
        0 => return Ok((1, true)),
        1 => return Ok((1, false)),
        2 => return Ok((3, false)),
        3 => "palette",
        4 => "mask",
        5 => "CMYK",
        6 => "YCbCr",
        8..=10 => "CIELAB",
        32803 => "color filter array",
        32844 | 32845 => "LogLuv",
        other => return Err(PictureError::pixels(format!("pixels of kind {other}"), KINDS)),
    };
    let expected = "gray or RGB: save the picture as one of these";
    Err(PictureError::pixels(format!("{found} pixels"), expected))
}

/// The sample that is or may be alpha, and what the file says of it.
fn last_sample(
    fields: &mut Fields,
    colors: usize,
    per_pixel: usize,
) -> Result<(Option<usize>, LastSample), PictureError> {
    if per_pixel == colors {
        return Ok((None, LastSample::Absent));
    }
    let Some(kinds) = fields.integers(tag::EXTRA_SAMPLES)? else {
        return Ok((Some(colors), LastSample::Unstated));
    };
    let alpha = kinds.iter().take(per_pixel - colors).position(|kind| matches!(kind, 1 | 2));
    Ok(match alpha.map(|i| (i, kinds[i])) {
        Some((i, 1)) => (Some(colors + i), LastSample::Alpha(Alpha::Associated)),
        Some((i, _)) => (Some(colors + i), LastSample::Alpha(Alpha::Straight)),
        None => (Some(colors), LastSample::NotAlpha),
    })
}

fn predictor(
    fields: &mut Fields,
    method: Method,
    number: Number,
) -> Result<Predictor, PictureError> {
    let found = fields.integer(tag::PREDICTOR, 1)?;
    let is_used = matches!(method, Method::Lzw | Method::Deflate);
    let whole_bytes = matches!(number.bits(), 8 | 16 | 32 | 64);
    match (found, number) {
        (1, _) => Ok(Predictor::None),
        // Readers disagree on whether it is then applied.
        (2 | 3, _) if !is_used => Err(PictureError::pixels(
            format!("predictor {found} without LZW or deflate"),
            "no predictor: save the picture again without it",
        )),
        (2, _) if whole_bytes => Ok(Predictor::Horizontal),
        (3, Number::Float { .. }) => Ok(Predictor::Float),
        _ => Err(PictureError::pixels(
            format!("predictor {found} of samples of {} bits", number.bits()),
            "a predictor for whole bytes: save the picture again without it",
        )),
    }
}

fn stated_color(fields: &mut Fields, number: Number) -> Result<StatedColor, PictureError> {
    let by_type = match number {
        Number::Float { .. } => Stated::yes(Encoding::Linear, "floats"),
        Number::Integer { .. } => Stated::No,
    };
    if let Some(profile) = fields.raw(tag::ICC_PROFILE)? {
        let StatedColor { space, encoding } = icc::stated(&profile)?;
        return Ok(StatedColor { space, encoding: encoding.or(by_type) });
    }
    let space = match (fields.fractions(tag::WHITE_POINT)?, fields.fractions(tag::PRIMARIES)?) {
        (Some(white), Some(primaries)) => match (&white[..], &primaries[..]) {
            (&[x, y], &[rx, ry, gx, gy, bx, by]) => {
                stated("primaries and white", [[rx, ry], [gx, gy], [bx, by]], [x, y])
            }
            (white, primaries) => Stated::Unread(format!(
                "primaries of {} and a white of {} numbers",
                primaries.len(),
                white.len()
            )),
        },
        _ => Stated::No,
    };
    Ok(StatedColor { space, encoding: by_type })
}
