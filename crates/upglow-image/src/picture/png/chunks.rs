//! The chunks before the pixels. The decoder leaves out those that it cannot read, as if the file had none.

use std::io::{BufRead, Read, Seek, SeekFrom};

use png::Info;

use super::{CHUNK_BYTES, damaged, refusal};
use crate::picture::error::PictureError;

/// What the chunks before the pixels state of themselves.
#[derive(Debug)]
pub(super) struct Chunks {
    pub(super) size: [usize; 2],
    pub(super) is_indexed: bool,
    /// The content of cICP.
    pub(super) code_points: Option<[u8; 4]>,
    /// Those of [`USED`] that the file has.
    used: Vec<&'static str>,
}

/// Chunks that change what the pixels are; each may be there once.
const USED: [&str; 7] = ["cICP", "iCCP", "sRGB", "gAMA", "cHRM", "tRNS", "eXIf"];

/// Before the first chunk.
const SIGNATURE_BYTES: u64 = 8;
const CHECKSUM_BYTES: i64 = 4;
// The color types of IHDR.
const GRAY: u8 = 0;
const RGB: u8 = 2;
const INDEXED: u8 = 3;

impl Chunks {
    /// Reads the names and lengths of the chunks up to the first with pixels, and the content of IHDR and cICP.
    ///
    /// # Errors
    ///
    /// [`PictureError`] if a chunk has another length than its kind, or is there twice.
    pub(super) fn read(file: &mut (impl BufRead + Seek)) -> Result<Self, PictureError> {
        file.seek(SeekFrom::Start(SIGNATURE_BYTES))?;
        let (mut length, mut name) = head(file)?;
        if (length, name) != (13, *b"IHDR") {
            return Err(damaged("its first chunk is not a header of 13 bytes"));
        }
        let [a, b, c, d, e, f, g, h, _, color, ..] = content::<13>(file)?;
        let size = [[a, b, c, d], [e, f, g, h]].map(|side| u32::from_be_bytes(side) as usize);
        let mut found =
            Self { size, is_indexed: color == INDEXED, code_points: None, used: Vec::new() };
        length = 0;
        loop {
            file.seek_relative(i64::from(length) + CHECKSUM_BYTES)?;
            (length, name) = head(file)?;
            if name == *b"IDAT" {
                return Ok(found);
            }
            let Ok(name) = str::from_utf8(&name) else { continue };
            if !has_length(name, length, color) {
                return Err(damaged(format!("its {name} chunk has {length} bytes")));
            }
            if let Some(name) = USED.into_iter().find(|used| *used == name) {
                if found.used.contains(&name) {
                    return Err(damaged(format!("two {name} chunks")));
                }
                found.used.push(name);
            }
            if name == "cICP" {
                found.code_points = Some(content(file)?);
                length = 0;
            }
        }
    }

    /// Refuses a file of which the decoder left out a chunk.
    ///
    /// # Errors
    ///
    /// [`PictureError`] names the chunk.
    pub(super) fn check_all_are_in(&self, info: &Info<'_>) -> Result<(), PictureError> {
        let is_in = |name: &str| match name {
            "cICP" => info.coding_independent_code_points.is_some(),
            "iCCP" => info.icc_profile.is_some(),
            "sRGB" => info.srgb.is_some(),
            "gAMA" => info.gama_chunk.is_some(),
            "cHRM" => info.chrm_chunk.is_some(),
            "tRNS" => info.trns.is_some(),
            _ => info.exif_metadata.is_some(),
        };
        match self.used.iter().find(|name| !is_in(name)) {
            Some(&"iCCP") => {
                let most = CHUNK_BYTES >> 20;
                Err(damaged(format!("its iCCP chunk is invalid or inflates to over {most} MiB")))
            }
            Some(name) => Err(damaged(format!("its {name} chunk is invalid or in a wrong place"))),
            None => Ok(()),
        }
    }
}

/// Whether a chunk of this name can have this length in a picture of this color type.
fn has_length(name: &str, length: u32, color: u8) -> bool {
    match (name, color) {
        ("cICP" | "gAMA", _) => length == 4,
        ("sRGB", _) => length == 1,
        ("cHRM", _) => length == 32,
        ("PLTE", _) => length.is_multiple_of(3),
        ("tRNS", GRAY) => length == 2,
        ("tRNS", RGB) => length == 6,
        _ => true,
    }
}

/// Length and name of the next chunk.
fn head(file: &mut impl Read) -> Result<(u32, [u8; 4]), PictureError> {
    let [a, b, c, d, name @ ..] = content::<8>(file)?;
    Ok((u32::from_be_bytes([a, b, c, d]), name))
}

fn content<const N: usize>(file: &mut impl Read) -> Result<[u8; N], PictureError> {
    let mut bytes = [0; N];
    file.read_exact(&mut bytes).map_err(|error| refusal(error.into()))?;
    Ok(bytes)
}
