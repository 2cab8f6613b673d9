//! A few texels of a picture, drawn at random but always the same ones.

/// `N` texels drawn with equal chances.
///
/// Each place in a picture has a fixed number, as good as random, and the texels with the least numbers are
/// drawn. So joining the draws of the parts of a picture gives the draw of the whole, in any order.
#[derive(Clone, Debug, Default)]
pub(super) struct Draw<const N: usize> {
    /// Number of the place, and color; from the least number on.
    drawn: Vec<(u64, [f32; 3])>,
}

impl<const N: usize> Draw<N> {
    pub(super) fn add(&mut self, at: [usize; 2], rgb: [f32; 3]) {
        self.add_numbered((number(at), rgb));
    }

    pub(super) fn join(&mut self, other: Self) {
        other.drawn.into_iter().for_each(|texel| self.add_numbered(texel));
    }

    /// The colors of the texels that were drawn.
    pub(super) fn colors(&self) -> impl Iterator<Item = [f32; 3]> + '_ {
        self.drawn.iter().map(|(_, rgb)| *rgb)
    }

    fn add_numbered(&mut self, texel: (u64, [f32; 3])) {
        if self.drawn.len() == N && self.drawn.last().is_some_and(|last| last.0 <= texel.0) {
            return;
        }
        let index = self.drawn.partition_point(|other| other.0 < texel.0);
        self.drawn.insert(index, texel);
        self.drawn.truncate(N);
    }
}

/// Different for each place: each step can be undone. The steps are those of the generator `SplitMix64`.
fn number([x, y]: [usize; 2]) -> u64 {
    let mut z = ((y as u64) << 32 | x as u64).wrapping_add(0x9e37_79b9_7f4a_7c15);
    z = (z ^ z >> 30).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ z >> 27).wrapping_mul(0x94d0_49bb_1331_11eb);
    z ^ z >> 31
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_join_to_the_draw_of_the_whole() {
        let draw = |xs: std::ops::Range<u16>| {
            let mut draw = Draw::<20>::default();
            xs.for_each(|x| draw.add([x.into(), 7], [x.into(), 0.0, 0.0]));
            draw
        };
        let whole = draw(0..1000);
        for cut in [0, 1, 10, 500, 1000] {
            let mut joined = draw(cut..1000);
            joined.join(draw(0..cut));
            assert_eq!(joined.drawn, whole.drawn);
        }
    }

    #[test]
    fn the_mean_of_a_draw_is_near_that_of_all() {
        let mut draw = Draw::<400>::default();
        let texels = (0..200_u16).flat_map(|y| (0..200_u16).map(move |x| [x, y]));
        texels.for_each(|[x, y]| draw.add([x.into(), y.into()], [x.into(), y.into(), 0.0]));
        // Five standard errors of a mean of 400 numbers that are even over 200.
        let tolerance = 5.0 * 200.0 / 12.0_f32.sqrt() / 20.0;
        for k in 0..2 {
            let mean = draw.colors().map(|rgb| rgb[k]).sum::<f32>() / 400.0;
            assert!((mean - 99.5).abs() < tolerance, "{mean}");
        }
    }
}
