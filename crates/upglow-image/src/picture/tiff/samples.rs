//! Samples of a row of a strip or tile, as numbers.

use half::f16;
use upglow_color::rounding::to_single;

use super::super::source::{add_bytes, add_words};
use super::directory::ByteOrder;

/// How samples are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Number {
    /// Unsigned integers of 1 to 32 bits.
    Integer { bits: usize },
    /// Floats of 2, 4 or 8 bytes.
    Float { bytes: usize },
}

/// What was done to samples before they were compressed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Predictor {
    None,
    /// Each sample is the difference from the one to its left.
    Horizontal,
    /// The same for bytes, which were sorted by significance before.
    Float,
}

/// The storage of the samples of a row.
#[derive(Clone, Copy, Debug)]
pub(super) struct Storage {
    pub(super) number: Number,
    pub(super) order: ByteOrder,
    pub(super) predictor: Predictor,
    /// Samples of a pixel that are stored together.
    pub(super) together: usize,
}

impl Number {
    pub(super) fn bits(self) -> usize {
        match self {
            Self::Integer { bits } => bits,
            Self::Float { bytes } => 8 * bytes,
        }
    }
}

impl Storage {
    /// Bytes of a row of `pixels`.
    pub(super) fn row_bytes(self, pixels: usize) -> usize {
        (pixels * self.together * self.number.bits()).div_ceil(8)
    }

    /// The numbers in the bytes of a row: integers as fractions of the greatest.
    pub(super) fn numbers(self, bytes: &mut Vec<u8>, to: &mut Vec<f32>) {
        to.clear();
        let bits = self.number.bits();
        if !bits.is_multiple_of(8) {
            let count = bytes.len() * 8 / bits;
            to.extend((0..count).map(|i| integer_of_bits(bytes, i * bits, bits)));
            return;
        }
        let size = bits / 8;
        match self.predictor {
            Predictor::Float => self.undo_float(bytes, size),
            predictor => {
                if self.order == ByteOrder::Big {
                    bytes.chunks_exact_mut(size).for_each(<[u8]>::reverse);
                }
                if predictor == Predictor::Horizontal {
                    self.undo_horizontal(bytes, size);
                }
            }
        }
        match self.number {
            Number::Integer { bits: 8 } => add_bytes(bytes, to),
            Number::Integer { bits: 16 } => {
                add_words(bytes.as_chunks().0.iter().map(|b| u16::from_le_bytes(*b)), to);
            }
            Number::Integer { bits } => {
                let words = bytes.chunks_exact(size).map(|b| ByteOrder::Little.integer(b));
                to.extend(words.map(|v| fraction(v, bits)));
            }
            Number::Float { bytes: 2 } => {
                let halves = bytes.as_chunks().0.iter().map(|b| f16::from_le_bytes(*b));
                to.extend(halves.map(f16::to_f32));
            }
            Number::Float { bytes: 4 } => {
                to.extend(bytes.as_chunks().0.iter().map(|b| f32::from_le_bytes(*b)));
            }
            Number::Float { .. } => {
                let doubles = bytes.as_chunks().0.iter().map(|b| f64::from_le_bytes(*b));
                to.extend(doubles.map(to_single));
            }
        }
    }

    /// Adds to each number of `size` bytes, lowest first, the one of the pixel to its left.
    fn undo_horizontal(self, bytes: &mut [u8], size: usize) {
        let step = size * self.together;
        for at in (step..bytes.len()).step_by(size) {
            let mut carry = 0;
            for k in at..(at + size).min(bytes.len()) {
                let sum = u16::from(bytes[k]) + u16::from(bytes[k - step]) + carry;
                let [low, high] = sum.to_le_bytes();
                (bytes[k], carry) = (low, u16::from(high));
            }
        }
    }

    /// Adds the bytes to the left, then gathers those of each number, lowest first.
    fn undo_float(self, bytes: &mut Vec<u8>, size: usize) {
        for at in self.together..bytes.len() {
            bytes[at] = bytes[at].wrapping_add(bytes[at - self.together]);
        }
        let count = bytes.len() / size;
        let gathered = (0..count).flat_map(|i| (0..size).rev().map(move |k| (i, k)));
        *bytes = gathered.map(|(i, k)| bytes[k * count + i]).collect();
    }
}

/// The number in `bits` bits, highest first, as a fraction of the greatest.
fn integer_of_bits(bytes: &[u8], at: usize, bits: usize) -> f32 {
    let bit = |i: usize| u64::from(bytes[i / 8] >> (7 - i % 8) & 1);
    fraction((at..at + bits).fold(0, |sum, i| sum << 1 | bit(i)), bits)
}

fn fraction(value: u64, bits: usize) -> f32 {
    let greatest = (1_u64 << bits) - 1;
    to_single(value as f64 / greatest as f64)
}
