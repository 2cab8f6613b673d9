//! The header of an OpenEXR file: parsed with every size checked, written with sorted attributes.
//!
//! The layout is that of `openexr`, "OpenEXR File Layout". The `exr` crate is not used for this,
//! because it keeps attributes in a hash map, so that its files differ from run to run.

use std::io::Read;

use exr::compression::Compression as Method;

use super::attribute::{Attribute, Attributes};
use super::error::ExrError;

/// The first four bytes of every OpenEXR file.
pub(crate) const MAGIC: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];
const VERSION: u8 = 2;
const TILED: u32 = 0x200;
const LONG_NAMES: u32 = 0x400;
const DEEP: u32 = 0x800;
const MULTI_PART: u32 = 0x1000;

/// Longest name of an attribute, a type or a channel, bytes.
const MAX_NAME: usize = 255;
/// Longer names need a flag in the version field.
const SHORT_NAME: usize = 31;
/// Most bytes of one attribute: 100,000 channels with names of 255 characters fit.
const MAX_ATTRIBUTE: u32 = 64 << 20;
/// Most bytes of all headers of a file together.
const MAX_HEADER: u64 = 256 << 20;
/// Most rows or columns: four times the largest textures; sizes in bytes stay far from overflow.
pub(crate) const MAX_SIDE: usize = 1 << 17;
/// `OpenEXR` itself refuses windows with a corner here or farther from the origin.
const FAR_CORNER: i32 = i32::MAX / 2;
/// Most parts of a file: far beyond the views and layers of any production file.
const MAX_PARTS: usize = 4096;

/// How a channel stores its samples.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sample {
    /// 16-bit float: 11 significant bits, at most 65504.
    Half = 1,
    /// 32-bit float.
    Float = 2,
    /// 32-bit unsigned integer; read, never written.
    Uint = 0,
}

impl Sample {
    /// Bytes of one sample.
    pub(crate) fn bytes(self) -> usize {
        match self {
            Self::Half => 2,
            Self::Float | Self::Uint => 4,
        }
    }

    fn of_code(code: i32) -> Option<Self> {
        [Self::Half, Self::Float, Self::Uint].into_iter().find(|sample| *sample as i32 == code)
    }
}

/// One channel of an image.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Channel {
    /// Its name; a point separates the names of layers and channel.
    pub(crate) name: String,
    /// The type of its samples.
    pub(crate) sample: Sample,
    /// Whether B44 compresses the samples themselves instead of their logarithms.
    pub(crate) is_linear: bool,
}

/// A rectangle of pixels, including both corners; the origin may lie anywhere.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Window {
    /// Column and row of the first pixel.
    pub(crate) min: [i32; 2],
    /// Column and row of the last pixel.
    pub(crate) max: [i32; 2],
}

impl Window {
    /// The window of a picture of this width and height whose first pixel is (0, 0).
    ///
    /// Sides are clamped to 1..=131,072, the sizes that files can have.
    pub(crate) fn of_size(size: [usize; 2]) -> Self {
        let last = |side: usize| i32::try_from(side.clamp(1, MAX_SIDE) - 1).unwrap_or(i32::MAX);
        Self { min: [0, 0], max: size.map(last) }
    }

    /// Width and height; `None` unless both are 1 or more.
    pub(crate) fn size(self) -> Option<[usize; 2]> {
        let side = |k: usize| {
            let pixels = i64::from(self.max[k]) - i64::from(self.min[k]) + 1;
            usize::try_from(pixels).ok().filter(|&side| side > 0)
        };
        Some([side(0)?, side(1)?])
    }

    fn is_near(self) -> bool {
        let corners = [self.min, self.max];
        corners.as_flattened().iter().all(|v| v.unsigned_abs() < FAR_CORNER.unsigned_abs())
    }

    fn to_bytes(self) -> Vec<u8> {
        let numbers = [self.min, self.max];
        numbers.as_flattened().iter().flat_map(|v| v.to_le_bytes()).collect()
    }

    fn from_bytes(bytes: &[u8]) -> Option<Self> {
        let words: &[[u8; 4]; 4] = bytes.as_chunks().0.try_into().ok()?;
        let [x0, y0, x1, y1] = words.map(i32::from_le_bytes);
        (bytes.len() == 16).then_some(Self { min: [x0, y0], max: [x1, y1] })
    }
}

/// The compression methods that are supported, by their codes in files.
const METHODS: [Method; 10] = [
    Method::Uncompressed,
    Method::RLE,
    Method::ZIP1,
    Method::ZIP16,
    Method::PIZ,
    Method::PXR24,
    Method::B44,
    Method::B44A,
    Method::DWAA(None),
    Method::DWAB(None),
];

/// The name of a method, as the standard and other programs have it.
pub(crate) fn method_name(method: Method) -> &'static str {
    match method {
        Method::Uncompressed => "uncompressed",
        Method::RLE => "RLE",
        Method::ZIP1 => "ZIPS",
        Method::ZIP16 => "ZIP",
        Method::PIZ => "PIZ",
        Method::PXR24 => "PXR24",
        Method::B44 => "B44",
        Method::B44A => "B44A",
        Method::DWAA(_) => "DWAA",
        Method::DWAB(_) => "DWAB",
        _ => "unknown",
    }
}

/// The header of one part of a file.
#[derive(Clone, Debug)]
pub(crate) struct Header {
    pub(crate) channels: Vec<Channel>,
    pub(crate) method: Method,
    pub(crate) data: Window,
    pub(crate) display: Window,
    /// Width and height of the data window.
    pub(crate) size: [usize; 2],
    /// Width and height of a tile, if the image is stored in tiles.
    pub(crate) tiles: Option<[usize; 2]>,
    /// Whether there are levels of half the sides, rounded down, to one pixel.
    pub(crate) is_mipmap: bool,
    /// Blocks of all levels; files of many parts state it.
    pub(crate) chunk_count: Option<usize>,
    /// Name of the part, if it has one.
    pub(crate) name: Option<String>,
    /// The attributes that are not [`FIELDS`].
    pub(crate) attributes: Attributes,
}

/// The headers of a file.
#[derive(Debug)]
pub(crate) struct Headers {
    pub(crate) parts: Vec<Header>,
    pub(crate) multi_part: bool,
    /// Position after the headers, bytes.
    pub(crate) end: u64,
}

impl Headers {
    /// Reads the headers from the beginning of a file.
    pub(crate) fn read(source: impl Read) -> Result<Self, ExrError> {
        let mut bytes = Bytes { source, position: 0 };
        let magic = bytes.take::<4>("the magic number")?;
        if magic != MAGIC {
            let found = format!("the file begins with {magic:02x?}");
            return Err(ExrError::invalid(found, "an OpenEXR file: [76, 2f, 31, 01]"));
        }
        let version = u32::from_le_bytes(bytes.take("the version")?);
        let [number, ..] = version.to_le_bytes();
        if number != VERSION {
            return Err(ExrError::invalid(format!("OpenEXR version {number}"), VERSION));
        }
        if version & DEEP != 0 {
            return Err(ExrError::invalid("deep data", "flat images"));
        }
        let multi_part = version & MULTI_PART != 0;
        let mut parts = Vec::new();
        while let Some(header) = read_header(&mut bytes, version)? {
            parts.push(header);
            if parts.len() > MAX_PARTS {
                let (found, expected) = (parts.len(), format!("at most {MAX_PARTS}"));
                return Err(ExrError::header("number of parts", found, expected));
            }
            if !multi_part {
                break;
            }
        }
        if parts.is_empty() {
            return Err(ExrError::header("number of parts", "0", "1 or more"));
        }
        Ok(Self { parts, multi_part, end: bytes.position })
    }
}

/// The next header; `None` at the empty one that ends the headers of a multi-part file.
fn read_header<R: Read>(bytes: &mut Bytes<R>, version: u32) -> Result<Option<Header>, ExrError> {
    let mut attributes = Attributes::new();
    loop {
        let name = bytes.name("an attribute's name")?;
        if name.is_empty() {
            break;
        }
        let kind = bytes.name("an attribute's type")?;
        let length = u32::from_le_bytes(bytes.take("an attribute's size")?);
        if length > MAX_ATTRIBUTE {
            let expected = format!("at most {MAX_ATTRIBUTE} bytes");
            return Err(ExrError::header(&name, format!("{length} bytes"), expected));
        }
        if bytes.position > MAX_HEADER {
            return Err(ExrError::header("header", "over 256 MiB", "at most 256 MiB"));
        }
        let mut value = bytes.vec(length as usize, &name)?;
        if kind == "string" {
            value = String::from_utf8_lossy(&value).into_owned().into_bytes();
        }
        let value = Attribute::new(&kind, value);
        if !value.has_valid_length() {
            return Err(ExrError::header(&name, format!("a {kind} of {length} bytes"), kind));
        }
        attributes.insert(name, value);
    }
    if attributes.is_empty() && version & MULTI_PART != 0 {
        return Ok(None);
    }
    build(attributes, version).map(Some)
}

fn build(mut attributes: Attributes, version: u32) -> Result<Header, ExrError> {
    let value = |name: &str, kind: &str| match attributes.get(name) {
        Some(value) => value
            .of_kind(kind)
            .ok_or_else(|| ExrError::header(name, format!("a {}", value.kind), kind)),
        None => Err(ExrError::header(name, "absent", kind)),
    };
    let stated = |name, kind| attributes.contains_key(name).then(|| value(name, kind)).transpose();
    let window = |name, most: usize| {
        let bytes = value(name, "box2i")?;
        let window = Window::from_bytes(bytes)
            .ok_or_else(|| ExrError::header(name, format!("{} bytes", bytes.len()), "16 bytes"))?;
        let size = window.size().filter(|size| size.iter().all(|&side| side <= most));
        let wrong = |expected: String| {
            let Window { min, max } = window;
            ExrError::header(name, format!("{min:?} to {max:?}"), expected)
        };
        let size = size.ok_or_else(|| wrong(format!("1 to {most} pixels a side")))?;
        if !window.is_near() {
            return Err(wrong(format!("corners nearer to 0 than {FAR_CORNER}")));
        }
        Ok((window, size))
    };
    let (data, size) = window("dataWindow", MAX_SIDE)?;
    let (display, _) = window("displayWindow", usize::MAX)?;
    let tiled = match stated("type", "string")? {
        Some(b"scanlineimage") => false,
        Some(b"tiledimage") => true,
        Some(other) => {
            let found = String::from_utf8_lossy(other);
            return Err(ExrError::header("type", found, "scanlineimage or tiledimage"));
        }
        None => version & TILED != 0,
    };
    let tiles = tiled.then(|| parse_tiles(value("tiles", "tiledesc")?)).transpose()?;
    let header = Header {
        channels: parse_channels(value("channels", "chlist")?)?,
        method: parse_method(value("compression", "compression")?)?,
        data,
        display,
        size,
        tiles: tiles.map(|(size, _)| size),
        is_mipmap: tiles.is_some_and(|(_, is_mipmap)| is_mipmap),
        chunk_count: stated("chunkCount", "int")?.map(parse_count).transpose()?,
        name: stated("name", "string")?.map(|name| String::from_utf8_lossy(name).into_owned()),
        attributes: Attributes::new(),
    };
    attributes.retain(|name, _| !is_reserved(name));
    Ok(Header { attributes, ..header })
}

/// Attributes that [`Header`] has as fields, or that are not used.
const FIELDS: [&str; 12] = [
    "channels",
    "chunkCount",
    "compression",
    "dataWindow",
    "displayWindow",
    "lineOrder",
    "name",
    "pixelAspectRatio",
    "screenWindowCenter",
    "screenWindowWidth",
    "tiles",
    "type",
];

/// Whether the format itself defines this attribute.
pub(crate) fn is_reserved(name: &str) -> bool {
    FIELDS.contains(&name)
}

fn parse_count(bytes: &[u8]) -> Result<usize, ExrError> {
    let count = bytes.try_into().map_or(-1, i32::from_le_bytes);
    usize::try_from(count).map_err(|_| ExrError::header("chunkCount", count, "a number of blocks"))
}

fn parse_method(bytes: &[u8]) -> Result<Method, ExrError> {
    let found = match *bytes {
        [code] => match (METHODS.get(usize::from(code)), code) {
            (Some(method), _) => return Ok(*method),
            (None, 10 | 11) => format!("HTJ2K (code {code})"),
            (None, _) => format!("of code {code}"),
        },
        _ => format!("of {} bytes", bytes.len()),
    };
    let names = METHODS.map(method_name).join(", ");
    Err(ExrError::invalid(format!("compression is {found}"), format!("one of {names}")))
}

/// The size of tiles, and whether there are all levels, rounded down.
fn parse_tiles(bytes: &[u8]) -> Result<([usize; 2], bool), ExrError> {
    let wrong = |found: String| {
        ExrError::header("tiles", found, format!("width and height from 1 to {MAX_SIDE}"))
    };
    let ([width, height], [mode]) = bytes.as_chunks::<4>() else {
        return Err(wrong(format!("{} bytes", bytes.len())));
    };
    let size = [width, height].map(|side| u32::from_le_bytes(*side) as usize);
    if size.iter().any(|side| !(1..=MAX_SIDE).contains(side)) {
        return Err(wrong(format!("{} by {}", size[0], size[1])));
    }
    Ok((size, *mode == MIPMAP_ROUND_DOWN))
}

/// Bytes after the name of a channel: sample type, flag and padding, subsampling in x and y.
const CHANNEL_TAIL: usize = 16;

fn parse_channels(mut bytes: &[u8]) -> Result<Vec<Channel>, ExrError> {
    let cut = || ExrError::truncated("the list of channels");
    let mut channels: Vec<Channel> = Vec::new();
    loop {
        let end = bytes.iter().take(MAX_NAME + 1).position(|&b| b == 0).ok_or_else(cut)?;
        let name = String::from_utf8_lossy(&bytes[..end]).into_owned();
        bytes = &bytes[end + 1..];
        if name.is_empty() {
            break;
        }
        let (tail, rest) = bytes.split_at_checked(CHANNEL_TAIL).ok_or_else(cut)?;
        channels.push(parse_channel(name, tail)?);
        bytes = rest;
    }
    let mut names: Vec<&str> = channels.iter().map(|c| c.name.as_str()).collect();
    names.sort_unstable();
    if let Some(pair) = names.windows(2).find(|pair| pair[0] == pair[1]) {
        return Err(ExrError::header("channels", format!("{} twice", pair[0]), "each name once"));
    }
    Ok(channels)
}

fn parse_channel(name: String, tail: &[u8]) -> Result<Channel, ExrError> {
    let words = tail.as_chunks::<4>().0;
    let [code, _, x, y] = [0, 1, 2, 3].map(|k| i32::from_le_bytes(words[k]));
    let sample = Sample::of_code(code).ok_or_else(|| {
        let found = format!("sample type {code} in channel {name}");
        ExrError::header("channels", found, "0, 1 or 2")
    })?;
    if (x, y) != (1, 1) {
        let found = format!("channel {name} sampled every {x} by {y} pixels");
        return Err(ExrError::header("channels", found, "every pixel"));
    }
    Ok(Channel { name, sample, is_linear: tail[4] != 0 })
}

/// Reads from a source and counts the bytes; errors name what was being read.
struct Bytes<R> {
    source: R,
    position: u64,
}

impl<R: Read> Bytes<R> {
    fn take<const N: usize>(&mut self, what: &str) -> Result<[u8; N], ExrError> {
        let mut bytes = [0; N];
        self.source.read_exact(&mut bytes).map_err(|error| ExrError::read(error, what))?;
        self.position += N as u64;
        Ok(bytes)
    }

    /// The value of attribute `what`. The vector grows as bytes arrive, so that a false length costs
    /// no memory.
    fn vec(&mut self, length: usize, what: &str) -> Result<Vec<u8>, ExrError> {
        let mut bytes = Vec::new();
        let mut limited = (&mut self.source).take(length as u64);
        limited.read_to_end(&mut bytes).map_err(|error| ExrError::read(error, what))?;
        if bytes.len() < length {
            return Err(ExrError::truncated(format!("attribute {what}")));
        }
        self.position += length as u64;
        Ok(bytes)
    }

    fn name(&mut self, what: &str) -> Result<String, ExrError> {
        let mut name = Vec::new();
        loop {
            match self.take::<1>(what)? {
                [0] => return Ok(String::from_utf8_lossy(&name).into_owned()),
                [byte] if name.len() < MAX_NAME => name.push(byte),
                _ => {
                    let expected = format!("at most {MAX_NAME} characters");
                    return Err(ExrError::header(what, "longer", expected));
                }
            }
        }
    }
}

/// How the blocks of an image are stored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Arrangement {
    /// Rows, from the top.
    Rows,
    /// Square tiles of this side, at all levels down to one pixel, in any order.
    Mipmap {
        /// Pixels.
        side: u32,
    },
}

/// Levels of an image in tiles: all down to one pixel, each of half the sides, rounded down.
const MIPMAP_ROUND_DOWN: u8 = 1;

/// The header of a file that has one part.
///
/// `channels` are sorted by name.
pub(crate) fn print(
    channels: &[Channel],
    method: Method,
    [data, display]: [Window; 2],
    arrangement: Arrangement,
    attributes: &Attributes,
) -> Vec<u8> {
    let code = METHODS.iter().position(|known| *known == method).expect("a method of the list");
    let code = u8::try_from(code).expect("there are ten");
    let mut all = attributes.clone();
    let (line_order, tiled) = match arrangement {
        Arrangement::Rows => (0, 0),
        Arrangement::Mipmap { side } => {
            let sides = [side.to_le_bytes(); 2];
            let tiles = [sides.as_flattened(), &[MIPMAP_ROUND_DOWN]].concat();
            all.insert("tiles".into(), Attribute::new("tiledesc", tiles));
            (2, TILED)
        }
    };
    let fields = [
        ("channels", Attribute::new("chlist", print_channels(channels))),
        ("compression", Attribute::new("compression", vec![code])),
        ("dataWindow", Attribute::new("box2i", data.to_bytes())),
        ("displayWindow", Attribute::new("box2i", display.to_bytes())),
        ("lineOrder", Attribute::new("lineOrder", vec![line_order])),
        ("pixelAspectRatio", Attribute::singles("float", &[1.0])),
        ("screenWindowCenter", Attribute::singles("v2f", &[0.0; 2])),
        ("screenWindowWidth", Attribute::singles("float", &[1.0])),
    ];
    all.extend(fields.map(|(name, value)| (name.to_owned(), value)));
    let channel_names = channels.iter().map(|c| c.name.len());
    let longest = all.keys().map(String::len).chain(channel_names).max().unwrap_or(0);
    let long = if longest > SHORT_NAME { LONG_NAMES } else { 0 };
    let mut bytes = MAGIC.to_vec();
    bytes.extend((u32::from(VERSION) | long | tiled).to_le_bytes());
    for (name, Attribute { kind, bytes: value }) in &all {
        for text in [name, kind] {
            bytes.extend(text.as_bytes());
            bytes.push(0);
        }
        bytes.extend(u32::try_from(value.len()).unwrap_or(u32::MAX).to_le_bytes());
        bytes.extend(value);
    }
    bytes.push(0);
    bytes
}

fn print_channels(channels: &[Channel]) -> Vec<u8> {
    let mut bytes = Vec::new();
    for Channel { name, sample, is_linear } in channels {
        bytes.extend(name.as_bytes());
        bytes.push(0);
        for word in [*sample as i32, i32::from(*is_linear), 1, 1] {
            bytes.extend(word.to_le_bytes());
        }
    }
    bytes.push(0);
    bytes
}

/// Whether a channel or attribute may have this name.
pub(crate) fn is_name(name: &str) -> bool {
    (1..=MAX_NAME).contains(&name.len()) && !name.contains('\0')
}

#[cfg(test)]
mod tests {
    use super::*;

    fn printed() -> (Vec<Channel>, Attributes, Vec<u8>) {
        let channel = |name: &str, sample| Channel { name: name.into(), sample, is_linear: false };
        let channels = vec![channel("B", Sample::Half), channel("Z", Sample::Float)];
        let attributes = Attributes::from([
            ("owner".into(), "me".into()),
            ("a name of more than thirty-one letters".into(), Attribute::singles("float", &[2.5])),
        ]);
        let display = Window::of_size([7, 9]);
        let data = Window { min: [-1, 2], max: [3, 8] };
        let bytes =
            print(&channels, Method::ZIP16, [data, display], Arrangement::Rows, &attributes);
        (channels, attributes, bytes)
    }

    #[test]
    fn a_header_is_read_back_from_its_bytes() {
        let (channels, attributes, bytes) = printed();
        let headers = Headers::read(&bytes[..]).unwrap();
        let header = &headers.parts[0];
        assert_eq!(headers.end, bytes.len() as u64);
        assert_eq!((header.size, header.data.min), ([5, 7], [-1, 2]));
        assert_eq!((&header.channels, &header.attributes), (&channels, &attributes));
        assert_eq!((header.method, header.display.max), (Method::ZIP16, [6, 8]));
    }

    #[test]
    fn a_truncated_header_is_refused_wherever_it_ends() {
        let (_, _, bytes) = printed();
        for length in 0..bytes.len() {
            let message = Headers::read(&bytes[..length]).unwrap_err().to_string();
            assert!(message.starts_with("the file ends inside "), "{length}: {message}");
        }
    }

    #[test]
    fn invalid_sizes_are_refused() {
        let message = |window: Window| {
            let bytes = print(
                &[],
                Method::Uncompressed,
                [window; 2],
                Arrangement::Rows,
                &Attributes::new(),
            );
            Headers::read(&bytes[..]).unwrap_err().to_string()
        };
        let huge = message(Window { min: [0, 0], max: [i32::MAX, 3] });
        assert!(huge.ends_with("expected 1 to 131072 pixels a side"), "{huge}");
        let far = message(Window { min: [FAR_CORNER - 2, 0], max: [FAR_CORNER, 3] });
        assert_eq!(
            far,
            "dataWindow is [1073741821, 0] to [1073741823, 3], expected corners nearer to 0 than 1073741823"
        );
        let inverted = message(Window { min: [0, i32::MAX], max: [5, i32::MIN] });
        assert!(inverted.starts_with("dataWindow is [0, 2147483647] to"), "{inverted}");
    }

    #[test]
    fn windows_are_read_exactly_where_openexr_reads_them() {
        let good = Window { min: [3, -4], max: [9, 5] };
        let read = |windows: [Window; 2]| {
            let rows = Arrangement::Rows;
            let bytes = print(&[], Method::Uncompressed, windows, rows, &Attributes::new());
            Headers::read(&bytes[..]).map(|_| ()).map_err(|error| error.to_string())
        };
        let corners = [-1, 1].map(|sign| [0, 1, 2, 9, 1 << 20, FAR_CORNER].map(|off| (sign, off)));
        for &(sign, off) in corners.as_flattened() {
            let at = sign * (FAR_CORNER - off);
            for axis in [0, 1] {
                let mut window = Window { min: [0; 2], max: [1; 2] };
                (window.min[axis], window.max[axis]) =
                    if at < 0 { (at, at + 1) } else { (at - 1, at) };
                for (name, windows) in [("data", [window, good]), ("display", [good, window])] {
                    let found = read(windows);
                    let far = format!("{name}Window is {:?} to {:?}, ", window.min, window.max);
                    match off {
                        0 => assert!(found.unwrap_err().starts_with(&far)),
                        _ => assert_eq!(found, Ok(()), "{far}"),
                    }
                }
                let mut empty = good;
                empty.max[axis] = empty.min[axis] - 1 - (off & 0xff);
                assert!(read([good, empty]).unwrap_err().starts_with("displayWindow is "));
            }
        }
    }

    #[test]
    fn other_methods_are_refused_with_those_that_are_read() {
        for code in 0..=u8::MAX {
            let found = parse_method(&[code]).map_err(|error| error.to_string());
            let of = match code {
                0..=9 => {
                    assert!(found.is_ok());
                    continue;
                }
                10 | 11 => format!("HTJ2K (code {code})"),
                _ => format!("of code {code}"),
            };
            let names = "uncompressed, RLE, ZIPS, ZIP, PIZ, PXR24, B44, B44A, DWAA, DWAB";
            assert_eq!(found, Err(format!("compression is {of}, expected one of {names}")));
        }
        assert!(
            parse_method(&[0, 0]).unwrap_err().to_string().starts_with("compression is of 2 bytes")
        );
    }
}
