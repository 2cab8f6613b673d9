//! Pictures that are stored lying on a side, mirrored or upside down.

use std::ops::Range;

use super::error::PictureError;
use super::source::{Facts, Pixels, Source, check_memory};

/// A picture turned as its orientation says. It is held in memory as a whole.
#[derive(Debug)]
pub(super) struct Turned {
    source: Box<dyn Source>,
    /// Width and height as stored.
    stored: [usize; 2],
    turn: Turn,
    whole: Option<Pixels>,
}

/// Where a pixel is stored: first columns and rows are exchanged, then each may count backwards.
#[derive(Clone, Copy, Debug)]
struct Turn {
    exchanged: bool,
    backwards: [bool; 2],
}

impl Turned {
    /// Turns a picture upright and updates its facts; upright pictures stay as they are.
    pub(super) fn of(
        source: Box<dyn Source>,
        facts: &mut Facts,
    ) -> Result<Box<dyn Source>, PictureError> {
        // Stored columns count backwards where the stored first column is on the right (or, where
        // exchanged, on the bottom), rows where the first row is at the bottom (on the right).
        let (exchanged, backwards) = match facts.orientation {
            2 => (false, [true, false]),
            3 => (false, [true, true]),
            4 => (false, [false, true]),
            5 => (true, [false, false]),
            6 => (true, [false, true]),
            7 => (true, [true, true]),
            8 => (true, [true, false]),
            _ => return Ok(source),
        };
        let stored = facts.size;
        let bytes = stored[0] as u64 * stored[1] as u64 * size_of::<[f32; 4]>() as u64;
        check_memory("a picture that is not stored upright", bytes)?;
        if exchanged {
            facts.size.reverse();
        }
        Ok(Box::new(Self { source, stored, turn: Turn { exchanged, backwards }, whole: None }))
    }
}

impl Source for Turned {
    fn read(&mut self, rows: Range<usize>) -> Result<Pixels, PictureError> {
        let [columns, stored_rows] = self.stored;
        let (rgb, alpha) = match &mut self.whole {
            Some(whole) => whole,
            none => none.insert(self.source.read(0..stored_rows)?),
        };
        let Turn { exchanged, backwards } = self.turn;
        let width = if exchanged { stored_rows } else { columns };
        let place = |i: usize| {
            let shown = [i % width, rows.start + i / width];
            let [mut x, mut y] = if exchanged { [shown[1], shown[0]] } else { shown };
            if backwards[0] {
                x = columns - 1 - x;
            }
            if backwards[1] {
                y = stored_rows - 1 - y;
            }
            y * columns + x
        };
        let count = rows.len() * width;
        let turned = (0..count).map(|i| rgb[place(i)]).collect();
        let alpha = alpha.as_ref().map(|alpha| (0..count).map(|i| alpha[place(i)]).collect());
        Ok((turned, alpha))
    }
}
