//! TIFF files of every kind, with the numbers that they hold.

use half::f16;
use miniz_oxide::deflate::compress_to_vec_zlib;
use upglow_color::rounding::to_single;

/// A file to write.
#[derive(Clone, Debug)]
pub(super) struct TiffFile {
    pub(super) size: [usize; 2],
    pub(super) kind: Kind,
    pub(super) is_big_endian: bool,
    pub(super) is_bigtiff: bool,
    pub(super) is_planar: bool,
    pub(super) chunk: Chunk,
    pub(super) compression: u16,
    pub(super) predictor: u16,
    pub(super) fill_order: u16,
    pub(super) photometric: u16,
    pub(super) samples: usize,
    /// Kinds of the samples beside the colors.
    pub(super) extra: Option<Vec<u16>>,
    pub(super) orientation: u16,
    /// Further fields of bytes.
    pub(super) further: Vec<(u16, Vec<u8>)>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Kind {
    Integer(u32),
    Float(u32),
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Chunk {
    Strips(usize),
    Tiles([usize; 2]),
}

impl Default for TiffFile {
    fn default() -> Self {
        Self {
            size: [19, 21],
            kind: Kind::Integer(8),
            is_big_endian: false,
            is_bigtiff: false,
            is_planar: false,
            chunk: Chunk::Strips(5),
            compression: 1,
            predictor: 1,
            fill_order: 1,
            photometric: 2,
            samples: 3,
            extra: None,
            orientation: 1,
            further: Vec::new(),
        }
    }
}

impl TiffFile {
    /// The stored bits of a sample: scattered, but the same in every run.
    fn code(&self, [x, y]: [usize; 2], sample: usize) -> u64 {
        let mixed = (x as u64 * 0x9e37_79b9 + y as u64 * 0x85eb_ca6b + sample as u64 * 0xc2b2_ae35)
            .wrapping_mul(0xff51_afd7_ed55_8ccd);
        let mixed = mixed ^ mixed >> 29;
        match self.kind {
            Kind::Integer(bits) => mixed & ((1 << bits) - 1),
            Kind::Float(bits) => {
                let value = (mixed % 4001) as f64 / 1000.0 - 1.0;
                match bits {
                    16 => u64::from(f16::from_f64(value).to_bits()),
                    32 => u64::from(to_single(value).to_bits()),
                    _ => value.to_bits(),
                }
            }
        }
    }

    /// The number that a sample means.
    pub(super) fn number(&self, at: [usize; 2], sample: usize) -> f32 {
        let code = self.code(at, sample);
        match self.kind {
            Kind::Integer(bits) => {
                let fraction = to_single(code as f64 / ((1_u64 << bits) - 1) as f64);
                if self.photometric == 0 && sample == 0 { 1.0 - fraction } else { fraction }
            }
            Kind::Float(16) => f16::from_bits(u16::try_from(code).unwrap()).to_f32(),
            Kind::Float(32) => f32::from_bits(u32::try_from(code).unwrap()),
            Kind::Float(_) => to_single(f64::from_bits(code)),
        }
    }

    fn bits(&self) -> usize {
        match self.kind {
            Kind::Integer(bits) | Kind::Float(bits) => bits as usize,
        }
    }

    /// The packed bytes of a row of codes of one strip or tile.
    fn row(&self, mut codes: Vec<u64>, together: usize) -> Vec<u8> {
        let bits = self.bits();
        if self.predictor == 2 {
            for i in (together..codes.len()).rev() {
                let difference = codes[i].wrapping_sub(codes[i - together]);
                codes[i] = if bits == 64 { difference } else { difference & ((1 << bits) - 1) };
            }
        }
        if self.predictor == 3 {
            let size = bits / 8;
            let planes = (0..size).rev();
            let mut bytes: Vec<u8> =
                planes.flat_map(|k| codes.iter().map(move |c| c.to_le_bytes()[k])).collect();
            for i in (together..bytes.len()).rev() {
                bytes[i] = bytes[i].wrapping_sub(bytes[i - together]);
            }
            return bytes;
        }
        if !bits.is_multiple_of(8) {
            let mut bytes = vec![0; (codes.len() * bits).div_ceil(8)];
            for (i, code) in codes.iter().enumerate() {
                for bit in 0..bits {
                    let at = i * bits + bit;
                    let one = u8::try_from(code >> (bits - 1 - bit) & 1).unwrap();
                    bytes[at / 8] |= one << (7 - at % 8);
                }
            }
            return bytes;
        }
        let bytes = codes.iter().flat_map(|code| {
            let mut bytes = code.to_le_bytes()[..bits / 8].to_vec();
            if self.is_big_endian {
                bytes.reverse();
            }
            bytes
        });
        bytes.collect()
    }

    /// The compressed bytes of each strip or tile, planes outermost.
    fn chunks(&self) -> Vec<Vec<u8>> {
        let [width, height] = self.size;
        let (columns, rows, is_tiled) = match self.chunk {
            Chunk::Strips(rows) => (width, rows, false),
            Chunk::Tiles([columns, rows]) => (columns, rows, true),
        };
        let planes = if self.is_planar { self.samples } else { 1 };
        let together = self.samples / planes;
        let mut chunks = Vec::new();
        for plane in 0..planes {
            for top in (0..height).step_by(rows) {
                for left in (0..width).step_by(columns) {
                    let end = if is_tiled { top + rows } else { height.min(top + rows) };
                    let row = |y| {
                        let columns = left..left + columns;
                        let codes = columns
                            .flat_map(|x| (0..together).map(move |s| self.code([x, y], plane + s)));
                        self.row(codes.collect(), together)
                    };
                    let mut bytes = self.compressed((top..end).map(row).collect());
                    if self.fill_order == 2 {
                        bytes.iter_mut().for_each(|b| *b = b.reverse_bits());
                    }
                    chunks.push(bytes);
                }
            }
        }
        chunks
    }

    fn compressed(&self, rows: Vec<Vec<u8>>) -> Vec<u8> {
        match self.compression {
            5 => {
                let order = weezl::BitOrder::Msb;
                let mut encoder = weezl::encode::Encoder::with_tiff_size_switch(order, 8);
                encoder.encode(&rows.concat()).unwrap()
            }
            8 | 32946 => compress_to_vec_zlib(&rows.concat(), 4),
            // Rows are packed one by one.
            32773 => rows.iter().flat_map(|row| packed_bits(row)).collect(),
            _ => rows.concat(),
        }
    }

    /// The file.
    pub(super) fn bytes(&self) -> Vec<u8> {
        let mut file = Writer { bytes: Vec::new(), file: self };
        file.bytes.extend(if self.is_big_endian { b"MM" } else { b"II" });
        if self.is_bigtiff {
            for word in [43, 8, 0] {
                file.push(word, 2);
            }
        } else {
            file.push(42, 2);
        }
        let word = if self.is_bigtiff { 8 } else { 4 };
        let start = file.bytes.len();
        file.push(0, word);
        let chunks = self.chunks();
        let mut places = Vec::new();
        for chunk in &chunks {
            places.push(file.bytes.len() as u64);
            file.bytes.extend(chunk);
        }
        let sizes = chunks.iter().map(|chunk| chunk.len() as u64).collect();
        let one = |value: usize| vec![value as u64];
        let each = |value: u64| vec![value; self.samples];
        let format = if matches!(self.kind, Kind::Float(_)) { 3 } else { 1 };
        let (short, long) = (3_u16, 4);
        let mut fields = vec![
            (256, long, one(self.size[0])),
            (257, long, one(self.size[1])),
            (258, short, each(self.bits() as u64)),
            (259, short, one(self.compression.into())),
            (262, short, one(self.photometric.into())),
            (266, short, one(self.fill_order.into())),
            (274, short, one(self.orientation.into())),
            (277, short, one(self.samples)),
            (284, short, one(if self.is_planar { 2 } else { 1 })),
            (317, short, one(self.predictor.into())),
            (339, short, each(format)),
        ];
        if let Some(extra) = &self.extra {
            fields.push((338, short, extra.iter().map(|v| u64::from(*v)).collect()));
        }
        match self.chunk {
            Chunk::Strips(rows) => {
                fields.extend([(278, long, one(rows)), (273, long, places), (279, long, sizes)]);
            }
            Chunk::Tiles([columns, rows]) => fields.extend([
                (322, long, one(columns)),
                (323, long, one(rows)),
                (324, long, places),
                (325, long, sizes),
            ]),
        }
        for (tag, bytes) in &self.further {
            fields.push((*tag, 7, bytes.iter().map(|b| u64::from(*b)).collect()));
        }
        fields.sort_by_key(|field| field.0);
        let mut entries = Writer { bytes: Vec::new(), file: self };
        for (tag, kind, values) in &fields {
            let size = [(3, 2), (4, 4), (7, 1)].iter().find(|(k, _)| k == kind).unwrap().1;
            entries.push(u64::from(*tag), 2);
            entries.push(u64::from(*kind), 2);
            entries.push(values.len() as u64, word);
            let mut value = Writer { bytes: Vec::new(), file: self };
            values.iter().for_each(|v| value.push(*v, size));
            if value.bytes.len() <= word {
                value.bytes.resize(word, 0);
                entries.bytes.extend(value.bytes);
            } else {
                entries.push(file.bytes.len() as u64, word);
                file.bytes.extend(value.bytes);
            }
        }
        let at = file.bytes.len() as u64;
        file.push(fields.len() as u64, if self.is_bigtiff { 8 } else { 2 });
        file.bytes.extend(entries.bytes);
        file.push(0, word);
        let mut place = Writer { bytes: Vec::new(), file: self };
        place.push(at, word);
        file.bytes[start..start + word].copy_from_slice(&place.bytes);
        file.bytes
    }
}

struct Writer<'f> {
    bytes: Vec<u8>,
    file: &'f TiffFile,
}

impl Writer<'_> {
    fn push(&mut self, value: u64, size: usize) {
        let mut bytes = value.to_le_bytes()[..size].to_vec();
        if self.file.is_big_endian {
            bytes.reverse();
        }
        self.bytes.extend(bytes);
    }
}

/// Runs of three and more as repetitions, the rest literally.
fn packed_bits(row: &[u8]) -> Vec<u8> {
    let mut packed = Vec::new();
    let mut rest = row;
    while let Some(first) = rest.first() {
        let run = rest.iter().take(128).take_while(|v| *v == first).count();
        if run >= 3 {
            packed.extend([u8::try_from(257 - run).unwrap(), *first]);
            rest = &rest[run..];
            continue;
        }
        let is_run = |i: usize| rest[i..].iter().take(3).filter(|v| **v == rest[i]).count() == 3;
        let end = (1..rest.len().min(128)).find(|&i| is_run(i)).unwrap_or(rest.len().min(128));
        packed.push(u8::try_from(end - 1).unwrap());
        packed.extend(&rest[..end]);
        rest = &rest[end..];
    }
    packed
}
