//! Textures as TIFF files, for OSL, which reads no other layout.

use crate::textures::Texture;

const SHORT: u16 = 3;
const LONG: u16 = 4;

/// The file: a header of 8 bytes, the directory, the bits of a sample and its format four times
/// each, the texels in one strip.
///
/// The fourth channel is marked as data other than opacity, so that readers do not multiply by it.
///
/// # Source
///
/// TIFF 6.0, sections 2, 6, 18 and 19: 32-bit IEEE floats, little-endian.
pub(crate) fn tiff(texture: &Texture) -> Vec<u8> {
    const FLOAT: u32 = 3;
    const RGB: u32 = 2;
    const CHANNELS: u32 = 4;
    const ENTRIES: u32 = 11;
    const DIRECTORY_END: u32 = 8 + 2 + 12 * ENTRIES + 4;
    const FORMATS_AT: u32 = DIRECTORY_END + 8;
    const TEXELS_AT: u32 = FORMATS_AT + 8;
    let [width, height] = [texture.width, texture.height()].map(size);
    let mut bytes = b"II\x2a\0\x08\0\0\0".to_vec();
    put(&mut bytes, ENTRIES, 2);
    let entries: [(u16, u16, u32, u32); ENTRIES as usize] = [
        (256, LONG, 1, width),
        (257, LONG, 1, height),
        (258, SHORT, CHANNELS, DIRECTORY_END),
        (259, SHORT, 1, 1),
        (262, SHORT, 1, RGB),
        (273, LONG, 1, TEXELS_AT),
        (277, SHORT, 1, CHANNELS),
        (278, LONG, 1, height),
        (279, LONG, 1, 16 * width * height),
        (338, SHORT, 1, 0),
        (339, SHORT, CHANNELS, FORMATS_AT),
    ];
    for (tag, kind, count, value) in entries {
        bytes.extend([tag, kind].into_iter().flat_map(u16::to_le_bytes));
        bytes.extend([count, value].into_iter().flat_map(u32::to_le_bytes));
    }
    put(&mut bytes, 0, 4);
    (0..CHANNELS).for_each(|_| put(&mut bytes, 32, 2));
    (0..CHANNELS).for_each(|_| put(&mut bytes, FLOAT, 2));
    bytes.extend(texture.texels.iter().flatten().flat_map(|value| value.to_le_bytes()));
    bytes
}

/// Appends the lowest `length` bytes of a number.
fn put(bytes: &mut Vec<u8>, number: u32, length: usize) {
    bytes.extend(&number.to_le_bytes()[..length]);
}

fn size(texels: usize) -> u32 {
    u32::try_from(texels).expect("a texture has at most 8192 texels along an axis")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_texels_are_where_the_directory_says() {
        let texture = Texture { width: 2, texels: vec![[1.0, 2.0, 3.0, 4.0]; 6] };
        let bytes = tiff(&texture);
        let short = |at: usize| u16::from_le_bytes(bytes[at..at + 2].try_into().unwrap());
        let long = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap()) as usize;
        let entries: Vec<usize> = (0..usize::from(short(8))).map(|i| 10 + 12 * i).collect();
        assert!(entries.is_sorted_by_key(|&at| short(at)));
        let value = |tag: u16| entries.iter().find(|&&at| short(at) == tag).map(|&at| long(at + 8));
        assert_eq!([value(256), value(257)], [Some(2), Some(3)]);
        let [texels, length] = [value(273).unwrap(), value(279).unwrap()];
        assert_eq!(texels + length, bytes.len());
        assert_eq!(bytes[texels..texels + 4], 1.0_f32.to_le_bytes());
        assert_eq!(short(value(258).unwrap()), 32);
        assert_eq!(short(value(339).unwrap()), 3);
    }
}
