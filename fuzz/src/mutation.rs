//! Altered files: the same ones for the same seed.

/// A xorshift generator.
#[derive(Clone, Debug)]
pub struct Random(u64);

impl Random {
    /// The generator of a seed.
    #[must_use]
    pub fn new(seed: u64) -> Self {
        let mut random = Self((seed ^ 0x9e37_79b9_7f4a_7c15) | 1);
        // The first numbers of small seeds are alike.
        for _ in 0..16 {
            random.next();
        }
        random
    }

    fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    /// A number from 0 to below `end`, which is 1 or more.
    pub fn below(&mut self, end: usize) -> usize {
        usize::try_from(self.next() % end.max(1) as u64).unwrap_or(0)
    }

    fn byte(&mut self) -> u8 {
        self.next().to_le_bytes()[0]
    }
}

/// Alters files of a corpus.
#[derive(Clone, Debug)]
pub struct Mutator {
    files: Vec<Vec<u8>>,
    random: Random,
}

/// Numbers at which programs go wrong, as 32 bits.
const NUMBERS: [u32; 12] = [
    0,
    1,
    0x7f,
    0xff,
    0x7fff,
    0xffff,
    0x10000,
    0x7fff_ffff,
    0x8000_0000,
    0xffff_ffff,
    0x7fc0_0000,
    0x7f80_0000,
];
/// Texts at which readers of text go wrong.
const TEXTS: [&str; 14] = [
    "1e308",
    "-1e308",
    "1e-320",
    "nan",
    "inf",
    "-0",
    "0",
    ",",
    "\n",
    "\"",
    "\\",
    "\u{202e}",
    "\u{1b}[2J",
    "e",
];
/// A file never grows beyond this.
const MOST_BYTES: usize = 1 << 18;
/// The bytes in which most headers are.
const HEADER_BYTES: usize = 600;

impl Mutator {
    /// Alters these files, of which there is one or more.
    #[must_use]
    pub fn new(files: Vec<Vec<u8>>, random: Random) -> Self {
        Self { files, random }
    }

    /// The next altered file.
    pub fn next_file(&mut self) -> Vec<u8> {
        let at = self.random.below(self.files.len());
        let mut bytes = self.files.get(at).cloned().unwrap_or_default();
        for _ in 0..=self.random.below(5) {
            self.alter(&mut bytes);
        }
        bytes.truncate(MOST_BYTES);
        bytes
    }

    fn alter(&mut self, bytes: &mut Vec<u8>) {
        let random = &mut self.random;
        let end = if random.below(2) == 0 { bytes.len().min(HEADER_BYTES) } else { bytes.len() };
        let at = random.below(end + 1).min(bytes.len());
        let length = 1 + random.below(8);
        let to = bytes.len().min(at + length);
        match random.below(10) {
            0 | 1 if at < bytes.len() => bytes[at] = random.byte(),
            2 if at < bytes.len() => bytes[at] ^= 1 << random.below(8),
            3 => {
                let number = NUMBERS[random.below(NUMBERS.len())];
                let number =
                    if random.below(2) == 0 { number.to_le_bytes() } else { number.to_be_bytes() };
                let width = [1, 2, 4][random.below(3)];
                let (from, end) = (4 - width, bytes.len().min(at + width));
                bytes[at..end].copy_from_slice(&number[from..from + end - at]);
            }
            4 => drop(bytes.drain(at..to)),
            5 => bytes.truncate(at),
            6 => {
                let copied = bytes[at..to].to_vec();
                let place = random.below(bytes.len() + 1);
                drop(bytes.splice(place..place, copied));
            }
            7 => {
                let text = TEXTS[random.below(TEXTS.len())];
                drop(bytes.splice(at..to, text.bytes()));
            }
            8 => {
                let other = &self.files[random.below(self.files.len())];
                let from = random.below(other.len() + 1);
                let end = other.len().min(from + random.below(256));
                let part = other[from..end].to_vec();
                let replaced = bytes.len().min(at + part.len());
                drop(bytes.splice(at..replaced, part));
            }
            _ => {
                let more: Vec<u8> = (0..length).map(|_| random.byte()).collect();
                drop(bytes.splice(at..at, more));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_seed_gives_the_same_files_and_another_gives_others() {
        let files = |seed| {
            let mut mutator = Mutator::new(vec![vec![1; 40], vec![2; 9]], Random::new(seed));
            (0..500).map(|_| mutator.next_file()).collect::<Vec<_>>()
        };
        assert_eq!(files(3), files(3));
        assert_ne!(files(3), files(4));
    }
}
