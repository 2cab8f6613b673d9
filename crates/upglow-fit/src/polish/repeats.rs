//! Colors that occurred before in a batch.

/// Where colors occurred last, for a limited number of colors.
///
/// A material depends only on its color, so forgotten colors do not change results.
#[derive(Debug)]
pub(super) struct Repeats {
    /// Indices of texels, by a hash of their colors.
    seen: Vec<usize>,
    shift: u32,
}

/// Slots for colors. More exceed the first-level cache of processors; fewer forget a color before it
/// occurs in the next row of a tile.
const MOST_SLOTS: usize = 2048;
/// An empty slot.
const NOTHING: usize = usize::MAX;
/// Odd numbers near the golden section of 2⁶⁴ and the root of 2 times 2⁶³, whose products spread
/// neighboring colors over all slots.
const MIX: [u64; 2] = [0x9e37_79b9_7f4a_7c15, 0xb504_f333_f9de_6485];

impl Repeats {
    /// For a batch of this many texels.
    pub(super) fn new(texels: usize) -> Self {
        let slots = texels.clamp(2, MOST_SLOTS).next_power_of_two();
        Self { seen: vec![NOTHING; slots], shift: u64::BITS - slots.trailing_zeros() }
    }

    /// An earlier texel with the same bits, if one is remembered. Remembers this one.
    #[inline(always)]
    #[expect(clippy::cast_possible_truncation, reason = "a slot's number has eleven bits")]
    pub(super) fn earlier(&mut self, rgb: &[[f32; 3]], texel: usize) -> Option<usize> {
        let bits = |[r, g, b]: &[f32; 3]| [r.to_bits(), g.to_bits(), b.to_bits()];
        let here @ [r, g, b] = bits(&rgb[texel]);
        let mixed = ((u64::from(r) << 32) | u64::from(g)).wrapping_mul(MIX[0]);
        let mixed = (mixed ^ (mixed >> 32) ^ u64::from(b)).wrapping_mul(MIX[1]);
        let slot = &mut self.seen[(mixed >> self.shift) as usize];
        let earlier = std::mem::replace(slot, texel);
        rgb.get(earlier).is_some_and(|rgb| bits(rgb) == here).then_some(earlier)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_a_color_with_the_same_bits_is_a_repeat() {
        let rgb = [[0.5; 3], [0.5, 0.5, 0.25], [0.5; 3], [0.0; 3], [-0.0, 0.0, 0.0], [0.5; 3]];
        let mut repeats = Repeats::new(1 << 20);
        let found: Vec<Option<usize>> = (0..6).map(|i| repeats.earlier(&rgb, i)).collect();
        assert_eq!(found, [None, None, Some(0), None, None, Some(2)]);
    }

    #[test]
    fn batches_may_have_any_size_and_colors_any_value() {
        for texels in [0_u16, 1, 2, 3, 5000] {
            let rgb: Vec<[f32; 3]> = (0..texels).map(|i| [f32::from(i), 0.0, f32::NAN]).collect();
            let mut repeats = Repeats::new(rgb.len());
            assert!((0..rgb.len()).all(|i| repeats.earlier(&rgb, i).is_none()));
        }
    }
}
