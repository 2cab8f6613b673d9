//! The first directory of a TIFF file, and of Exif data, which have the same structure.

use std::collections::BTreeMap;
use std::io::{self, Read, Seek, SeekFrom};

use super::super::error::PictureError;

/// The order of the bytes of numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum ByteOrder {
    Little,
    Big,
}

/// The numbers of a field: its type, how many there are, and where they are in the file.
#[derive(Clone, Copy, Debug)]
struct Entry {
    kind: u16,
    count: u64,
    at: u64,
}

/// The fields of a directory, whose values are read when they are asked for.
#[derive(Debug)]
pub(in super::super) struct Directory<R> {
    source: R,
    length: u64,
    pub(super) order: ByteOrder,
    /// Bytes of a position, 4 or 8.
    word: usize,
    entries: BTreeMap<u16, Entry>,
}

/// Most bytes of the values of a field: the positions of eight million strips or tiles.
const MAX_VALUE: u64 = 64 << 20;

impl<R: Read + Seek> Directory<R> {
    /// Reads the first directory of TIFF or `BigTIFF`.
    ///
    /// # Errors
    ///
    /// [`PictureError`] if the source ends inside it or it is not one.
    pub(in super::super) fn read(mut source: R) -> Result<Self, PictureError> {
        let length = source.seek(SeekFrom::End(0))?;
        let entries = BTreeMap::new();
        let mut directory = Self { source, length, order: ByteOrder::Little, word: 4, entries };
        let [mark, _, low, high] = directory.bytes::<4>(0)?;
        directory.order = if mark == b'M' { ByteOrder::Big } else { ByteOrder::Little };
        directory.word = if low.max(high) == 43 { 8 } else { 4 };
        let start = directory.number(directory.word, directory.word as u64)?;
        directory.read_entries(start)?;
        Ok(directory)
    }

    /// Goes to the directory whose position a field holds; `None` if the field is absent.
    ///
    /// # Errors
    ///
    /// Those of [`Directory::read`].
    pub(in super::super) fn at(mut self, tag: u16) -> Result<Option<Self>, PictureError> {
        if !self.has(tag) {
            return Ok(None);
        }
        let start = self.integer(tag, 0)?;
        self.read_entries(start)?;
        Ok(Some(self))
    }

    fn read_entries(&mut self, start: u64) -> Result<(), PictureError> {
        let (word, length) = (self.word, self.length);
        let count_bytes = if word == 8 { 8 } else { 2 };
        let count = self.number(count_bytes, start)?;
        self.entries.clear();
        let entry_bytes = 4 + 2 * word as u64;
        let first = start + count_bytes as u64;
        let end = count.checked_mul(entry_bytes).and_then(|bytes| bytes.checked_add(first));
        if end.is_none_or(|end| end > length) {
            return Err(damaged(format!("{count} fields at byte {start}")));
        }
        for i in 0..count {
            let at = first + i * entry_bytes;
            let tag = self.small(at)?;
            let kind = self.small(at + 2)?;
            let count = self.number(word, at + 4)?;
            let inline = at + 4 + word as u64;
            let bytes = count.saturating_mul(size_of_kind(kind));
            let at = if bytes <= word as u64 { inline } else { self.number(word, inline)? };
            self.entries.entry(tag).or_insert(Entry { kind, count, at });
        }
        Ok(())
    }

    /// Whether the directory has this field.
    pub(super) fn has(&self, tag: u16) -> bool {
        self.entries.contains_key(&tag)
    }

    /// The integers of a field; `None` if it is absent.
    ///
    /// # Errors
    ///
    /// [`PictureError`] if it lies outside the file or has values of another type.
    pub(super) fn integers(&mut self, tag: u16) -> Result<Option<Vec<u64>>, PictureError> {
        let Some(&entry) = self.entries.get(&tag) else { return Ok(None) };
        if !matches!(entry.kind, 1 | 3 | 4 | 13 | 16 | 18) {
            return Err(damaged(format!("field {tag} is of type {}", entry.kind)));
        }
        let (order, bytes) = (self.order, self.value(tag, entry)?);
        let size = usize::try_from(size_of_kind(entry.kind)).unwrap_or(1);
        Ok(Some(bytes.chunks_exact(size).map(|bytes| order.integer(bytes)).collect()))
    }

    /// The first integer of a field, or `default` if it is absent.
    ///
    /// # Errors
    ///
    /// Those of [`Directory::integers`].
    pub(in super::super) fn integer(
        &mut self,
        tag: u16,
        default: u64,
    ) -> Result<u64, PictureError> {
        let found = self.integers(tag)?;
        Ok(found.and_then(|values| values.first().copied()).unwrap_or(default))
    }

    /// The fractions of a field; `None` if it is absent or has values of another type.
    ///
    /// # Errors
    ///
    /// [`PictureError`] if it lies outside the file.
    pub(super) fn fractions(&mut self, tag: u16) -> Result<Option<Vec<f64>>, PictureError> {
        const RATIONAL: u16 = 5;
        let Some(&entry) = self.entries.get(&tag) else { return Ok(None) };
        if entry.kind != RATIONAL {
            return Ok(None);
        }
        let (order, bytes) = (self.order, self.value(tag, entry)?);
        let half = |bytes: &[u8]| order.integer(bytes) as f64;
        Ok(Some(bytes.chunks_exact(8).map(|b| half(&b[..4]) / half(&b[4..])).collect()))
    }

    /// The bytes of a field; `None` if it is absent.
    ///
    /// # Errors
    ///
    /// [`PictureError`] if it lies outside the file.
    pub(super) fn raw(&mut self, tag: u16) -> Result<Option<Vec<u8>>, PictureError> {
        let Some(&entry) = self.entries.get(&tag) else { return Ok(None) };
        self.value(tag, entry).map(Some)
    }

    fn value(&mut self, tag: u16, entry: Entry) -> Result<Vec<u8>, PictureError> {
        let bytes = entry.count.saturating_mul(size_of_kind(entry.kind));
        let is_inside = entry.at.checked_add(bytes).is_some_and(|end| end <= self.length);
        if bytes > MAX_VALUE || !is_inside {
            return Err(damaged(format!("field {tag} has {bytes} bytes at byte {}", entry.at)));
        }
        let mut value = vec![0; usize::try_from(bytes).unwrap_or(0)];
        self.go_to(entry.at)?;
        self.source.read_exact(&mut value)?;
        Ok(value)
    }

    fn small(&mut self, at: u64) -> Result<u16, PictureError> {
        let bytes = self.bytes::<2>(at)?;
        Ok(match self.order {
            ByteOrder::Little => u16::from_le_bytes(bytes),
            ByteOrder::Big => u16::from_be_bytes(bytes),
        })
    }

    /// An integer of 2, 4 or 8 bytes.
    fn number(&mut self, size: usize, at: u64) -> Result<u64, PictureError> {
        Ok(match size {
            2 => u64::from(self.small(at)?),
            4 => self.order.integer(&self.bytes::<4>(at)?),
            _ => self.order.integer(&self.bytes::<8>(at)?),
        })
    }

    fn bytes<const N: usize>(&mut self, at: u64) -> Result<[u8; N], PictureError> {
        if at.checked_add(N as u64).is_none_or(|end| end > self.length) {
            return Err(damaged(format!("it ends at byte {}, before byte {at}", self.length)));
        }
        let mut bytes = [0; N];
        self.go_to(at)?;
        self.source.read_exact(&mut bytes)?;
        Ok(bytes)
    }

    fn go_to(&mut self, at: u64) -> io::Result<()> {
        // A relative seek keeps a buffer, which holds the next field.
        let here = self.source.stream_position()?;
        self.source.seek_relative(at.wrapping_sub(here).cast_signed())
    }
}

impl ByteOrder {
    /// An unsigned integer of up to eight bytes.
    pub(super) fn integer(self, bytes: &[u8]) -> u64 {
        let add = |sum: u64, byte: &u8| sum << 8 | u64::from(*byte);
        match self {
            Self::Little => bytes.iter().rev().fold(0, add),
            Self::Big => bytes.iter().fold(0, add),
        }
    }
}

/// Bytes of one value; unknown types count as bytes.
fn size_of_kind(kind: u16) -> u64 {
    match kind {
        3 | 8 => 2,
        4 | 9 | 11 | 13 => 4,
        5 | 10 | 12 | 16..=18 => 8,
        _ => 1,
    }
}

pub(super) fn damaged(found: String) -> PictureError {
    PictureError::Damaged { found, format: "TIFF" }
}
