//! The bytes of one strip or tile, decompressed as they are read.

use std::fmt;
use std::fs::File;
use std::io::{self, Read, Seek, SeekFrom};
use std::path::Path;

use miniz_oxide::inflate::stream::{InflateState, inflate};
use miniz_oxide::{DataFormat, MZError, MZFlush, MZStatus};
use upglow::open_input;
use weezl::LzwStatus;
use weezl::decode::Decoder as LzwDecoder;

use super::super::error::PictureError;
use super::directory::damaged;

/// The compressions that are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Method {
    Plain,
    Lzw,
    Deflate,
    PackBits,
}

impl Method {
    /// The method of a code, or the name of one that is not read.
    pub(super) fn of_code(code: u64) -> Result<Self, String> {
        let name = match code {
            1 => return Ok(Self::Plain),
            5 => return Ok(Self::Lzw),
            8 | 32946 => return Ok(Self::Deflate),
            32773 => return Ok(Self::PackBits),
            2 | 3 | 4 | 32771 => "CCITT",
            6 | 7 => "JPEG",
            34661 => "JBIG",
            33003 | 33005 | 34712 => "JPEG 2000",
            34887 => "LERC",
            34925 => "LZMA",
            34926 | 50000 => "Zstandard",
            34927 | 50001 => "WebP",
            50002 => "JPEG XL",
            other => return Err(format!("compression {other}")),
        };
        Err(format!("{name} compression"))
    }
}

/// One strip or tile at a time, read from a file that is opened once.
pub(super) struct Packed {
    file: File,
    length: u64,
    method: Method,
    /// Whether the bits of each byte are stored in reverse (`FillOrder` 2).
    is_reversed: bool,
    /// Bytes of the strip or tile that are still in the file.
    left: u64,
    buffer: Vec<u8>,
    /// Bytes of the buffer that have been used.
    used: usize,
    state: State,
}

enum State {
    Plain,
    /// Bytes that follow as they are, then repetitions of a byte.
    PackBits {
        literal: usize,
        repeated: (usize, u8),
    },
    Lzw(Box<LzwDecoder>),
    Deflate(Box<InflateState>),
}

/// Bytes read from the file at a time.
const BUFFER_BYTES: u64 = 64 << 10;

impl fmt::Debug for Packed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Packed").field("method", &self.method).finish_non_exhaustive()
    }
}

impl Packed {
    pub(super) fn open(path: &Path, method: Method, is_reversed: bool) -> io::Result<Self> {
        let file = open_input(path)?;
        let length = file.metadata()?.len();
        let (buffer, state) = (Vec::new(), State::Plain);
        Ok(Self { file, length, method, is_reversed, left: 0, buffer, used: 0, state })
    }

    /// Goes to the `size` bytes of a strip or tile at `at`.
    pub(super) fn start(&mut self, at: u64, size: u64) -> Result<(), PictureError> {
        if at.checked_add(size).is_none_or(|end| end > self.length) {
            return Err(damaged(format!("a strip or tile of {size} bytes at byte {at}")));
        }
        self.file.seek(SeekFrom::Start(at))?;
        self.left = size;
        self.buffer.clear();
        self.used = 0;
        self.state = match self.method {
            Method::Plain => State::Plain,
            Method::PackBits => State::PackBits { literal: 0, repeated: (0, 0) },
            Method::Deflate => State::Deflate(InflateState::new_boxed(DataFormat::Zlib)),
            Method::Lzw => {
                let order = weezl::BitOrder::Msb;
                State::Lzw(Box::new(LzwDecoder::with_tiff_size_switch(order, 8)))
            }
        };
        if let (Method::Lzw, [0, second, ..]) = (self.method, self.fill()?)
            && second & 1 == 1
        {
            return Err(PictureError::pixels("LZW of before TIFF 5.0", super::COMPRESSIONS));
        }
        Ok(())
    }

    /// The next decompressed bytes.
    pub(super) fn read(&mut self, to: &mut [u8]) -> Result<(), PictureError> {
        let mut done = 0;
        while done < to.len() {
            let found = self.read_some(&mut to[done..])?;
            if found == 0 {
                return Err(damaged("a strip or tile ends early".into()));
            }
            done += found;
        }
        Ok(())
    }

    /// Checks the checksum behind the last byte, if the compression has one.
    pub(super) fn finish(&mut self) -> Result<(), PictureError> {
        if matches!(self.state, State::Deflate(_)) {
            self.read_some(&mut [0])?;
        }
        Ok(())
    }

    /// Decompresses at least one byte; 0 at the end.
    fn read_some(&mut self, to: &mut [u8]) -> Result<usize, PictureError> {
        loop {
            self.fill()?;
            let input = &self.buffer[self.used..];
            let is_last = input.is_empty();
            let (used, written) = match &mut self.state {
                State::Plain => copied(input, to, to.len()),
                State::PackBits { literal, repeated: (count, byte) } => {
                    if *count > 0 {
                        let written = to.len().min(*count);
                        to[..written].fill(*byte);
                        *count -= written;
                        (0, written)
                    } else if *literal > 0 {
                        let (used, written) = copied(input, to, *literal);
                        *literal -= written;
                        (used, written)
                    } else {
                        match *input {
                            [128, ..] => (1, 0),
                            [head, ..] if head < 128 => {
                                *literal = usize::from(head) + 1;
                                (1, 0)
                            }
                            [head, value, ..] => {
                                (*count, *byte) = (257 - usize::from(head), value);
                                (2, 0)
                            }
                            // A pair that the end of the buffer divides.
                            [_] if self.left > 0 => {
                                self.refill()?;
                                continue;
                            }
                            _ => return Ok(0),
                        }
                    }
                }
                State::Lzw(decoder) => {
                    let result = decoder.decode_bytes(input, to);
                    match result.status {
                        Ok(LzwStatus::Done) if result.consumed_out == 0 => return Ok(0),
                        Ok(_) => (result.consumed_in, result.consumed_out),
                        Err(_) => return Err(damaged("invalid LZW data".into())),
                    }
                }
                State::Deflate(state) => {
                    let result = inflate(state, input, to, MZFlush::None);
                    match result.status {
                        Ok(MZStatus::StreamEnd) if result.bytes_written == 0 => return Ok(0),
                        Ok(_) | Err(MZError::Buf) => (result.bytes_consumed, result.bytes_written),
                        Err(_) => return Err(damaged("invalid deflate data".into())),
                    }
                }
            };
            self.used += used;
            if written > 0 {
                return Ok(written);
            }
            if used == 0 && is_last {
                return Ok(0);
            }
            if used == 0 {
                return Err(damaged("a strip or tile that cannot be decompressed".into()));
            }
        }
    }

    /// The next stored bytes; empty at the end.
    fn fill(&mut self) -> io::Result<&[u8]> {
        if self.used == self.buffer.len() {
            self.refill()?;
        }
        Ok(&self.buffer[self.used..])
    }

    /// Drops the used bytes of the buffer and appends further ones.
    fn refill(&mut self) -> io::Result<()> {
        self.buffer.drain(..self.used);
        self.used = 0;
        let kept = self.buffer.len();
        let count = self.left.min(BUFFER_BYTES);
        (&mut self.file).take(count).read_to_end(&mut self.buffer)?;
        let found = self.buffer.len() - kept;
        self.left = if found == 0 { 0 } else { self.left - found as u64 };
        if self.is_reversed {
            self.buffer[kept..].iter_mut().for_each(|byte| *byte = byte.reverse_bits());
        }
        Ok(())
    }
}

/// Copies at most `most` bytes; how many were read and written.
fn copied(from: &[u8], to: &mut [u8], most: usize) -> (usize, usize) {
    let count = from.len().min(to.len()).min(most);
    to[..count].copy_from_slice(&from[..count]);
    (count, count)
}
