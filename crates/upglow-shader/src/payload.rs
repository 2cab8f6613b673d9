//! Textures as one file of bytes.

use crate::textures::Texture;

/// The file's first bytes.
pub(crate) const MAGIC: [u8; 8] = *b"UPGLOWTX";
pub(crate) const VERSION: u32 = 1;
/// Bytes before the texels.
pub(crate) const HEADER_BYTES: usize = 64;
pub(crate) const TEXEL_BYTES: usize = 16;

/// A header, then the texels of the nodes and of the curves, if there are any; little-endian.
pub(crate) fn payload(resolution: usize, nodes: &Texture, curves: Option<&Texture>) -> Vec<u8> {
    let texels = || nodes.texels.iter().chain(curves.iter().flat_map(|c| &c.texels));
    let mut bytes = Vec::with_capacity(HEADER_BYTES + texels().count() * TEXEL_BYTES);
    bytes.extend(MAGIC);
    let [curve_columns, curve_rows] = curves.map_or([0; 2], |c| [c.width, c.height()]);
    let sizes = [resolution, nodes.width, nodes.height(), curve_columns, curve_rows].map(size);
    for number in [VERSION].into_iter().chain(sizes) {
        bytes.extend(number.to_le_bytes());
    }
    bytes.extend(checksum(nodes, curves).to_le_bytes());
    bytes.resize(HEADER_BYTES, 0);
    bytes.extend(texels().flatten().flat_map(|value| value.to_le_bytes()));
    bytes
}

/// FNV-1a of the textures' bytes, 64 bits: tells the textures of one cube from another's.
pub(crate) fn checksum(nodes: &Texture, curves: Option<&Texture>) -> u64 {
    const START: u64 = 0xcbf2_9ce4_8422_2325;
    const PRIME: u64 = 0x0100_0000_01b3;
    let texels = nodes.texels.iter().chain(curves.iter().flat_map(|c| &c.texels));
    let bytes = texels.flatten().flat_map(|value| value.to_le_bytes());
    bytes.fold(START, |hash, byte| (hash ^ u64::from(byte)).wrapping_mul(PRIME))
}

fn size(texels: usize) -> u32 {
    u32::try_from(texels).expect("a texture has at most 8192 texels along an axis")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_header_states_the_sizes_and_the_checksum() {
        let nodes = Texture { width: 4, texels: vec![[1.0, 2.0, 3.0, 4.0]; 16] };
        let curves = Texture { width: 2, texels: vec![[0.5; 4]; 6] };
        let bytes = payload(2, &nodes, Some(&curves));
        assert_eq!(bytes.len(), 64 + 16 * 16 + 6 * 16);
        assert_eq!(&bytes[..8], b"UPGLOWTX");
        let number = |at: usize| u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap());
        assert_eq!([8, 12, 16, 20, 24, 28].map(number), [1, 2, 4, 4, 2, 3]);
        let stated = u64::from_le_bytes(bytes[32..40].try_into().unwrap());
        assert_eq!(stated, checksum(&nodes, Some(&curves)));
        assert_ne!(stated, checksum(&nodes, None));
        assert_eq!(bytes[64..68], 1.0_f32.to_le_bytes());
    }

    #[test]
    fn the_checksum_is_the_published_one() {
        // FNV-1a of sixteen zero bytes, by the definition: each step multiplies by the prime.
        let zeros = Texture { width: 1, texels: vec![[0.0; 4]] };
        let expected =
            (0..16).fold(0xcbf2_9ce4_8422_2325_u64, |hash, _| hash.wrapping_mul(0x0100_0000_01b3));
        assert_eq!(checksum(&zeros, None), expected);
    }
}
