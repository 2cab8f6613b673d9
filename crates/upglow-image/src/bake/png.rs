//! PNG pictures, written by bands of rows.

use std::fmt;
use std::io::{self, BufReader, Write as _};
use std::path::Path;
use std::sync::{Arc, Mutex};

use png::{BitDepth, ColorType, Encoder, SrgbRenderingIntent, StreamWriter};
use upglow::{Aside, open_input};
use upglow_color::choices;

use super::attributes;

/// Bits of each sample of a PNG file.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum PngBits {
    /// One byte.
    #[default]
    Eight,
    /// Two bytes.
    Sixteen,
}

choices!(PngBits, "number of bits", Eight = "8", Sixteen = "16");

/// A PNG file that is being written from top to bottom, in sRGB. It appears under its name when
/// [`PngWriter::finish`] returns; a writer that is dropped before leaves no file.
pub(super) struct PngWriter {
    rows: StreamWriter<'static, Shared>,
    file: Shared,
    bits: PngBits,
}

/// A file that the encoder writes to, and that is ours again when it has finished.
#[derive(Clone, Debug)]
struct Shared(Arc<Mutex<Aside>>);

impl PngWriter {
    /// Starts the file of a picture, with alpha or without; `made` is kept in it as text.
    pub(super) fn create(
        path: &Path,
        [width, height]: [usize; 2],
        has_alpha: bool,
        bits: PngBits,
        made: String,
    ) -> io::Result<Self> {
        let side = |n: usize| u32::try_from(n).map_err(io::Error::other);
        let file = Shared(Arc::new(Mutex::new(Aside::create(path)?)));
        let mut encoder = Encoder::new(file.clone(), side(width)?, side(height)?);
        encoder.set_color(if has_alpha { ColorType::Rgba } else { ColorType::Rgb });
        encoder.set_depth(match bits {
            PngBits::Eight => BitDepth::Eight,
            PngBits::Sixteen => BitDepth::Sixteen,
        });
        encoder.set_source_srgb(SrgbRenderingIntent::RelativeColorimetric);
        encoder.add_text_chunk(attributes::MADE.to_owned(), made)?;
        let rows = encoder.write_header()?.into_stream_writer()?;
        Ok(Self { rows, file, bits })
    }

    /// Writes rows: a plane of samples in 0..=1 for each channel.
    pub(super) fn write_band(&mut self, planes: &[Vec<f32>]) -> io::Result<()> {
        let texels = planes.first().map_or(0, Vec::len);
        let samples = (0..texels).flat_map(|i| planes.iter().map(move |plane| plane[i]));
        let bytes: Vec<u8> = match self.bits {
            PngBits::Eight => samples.map(to_u8).collect(),
            PngBits::Sixteen => samples.flat_map(|v| to_u16(v).to_be_bytes()).collect(),
        };
        self.rows.write_all(&bytes)
    }

    /// Completes the file but for its name.
    pub(super) fn into_file(self) -> io::Result<Aside> {
        self.rows.finish()?;
        let aside = Arc::into_inner(self.file.0).expect("the encoder has been dropped");
        Ok(aside.into_inner().expect("no thread panicked with it"))
    }
}

/// The text [`attributes::MADE`] of a PNG file, if it has one.
pub(super) fn made(path: &Path) -> Option<String> {
    let file = BufReader::new(open_input(path).ok()?);
    let reader = png::Decoder::new(file).read_info().ok()?;
    let texts = &reader.info().uncompressed_latin1_text;
    texts.iter().find(|text| text.keyword == attributes::MADE).map(|text| text.text.clone())
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "it is in range")]
fn to_u8(share: f32) -> u8 {
    (share.clamp(0.0, 1.0) * f32::from(u8::MAX)).round() as u8
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "it is in range")]
fn to_u16(share: f32) -> u16 {
    (share.clamp(0.0, 1.0) * f32::from(u16::MAX)).round() as u16
}

impl io::Write for Shared {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.lock().map_err(|_| io::ErrorKind::Other)?.write(bytes)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.0.lock().map_err(|_| io::ErrorKind::Other)?.flush()
    }
}

impl fmt::Debug for PngWriter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { file, bits, .. } = self;
        f.debug_struct("PngWriter").field("file", file).field("bits", bits).finish_non_exhaustive()
    }
}
