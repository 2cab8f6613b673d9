//! Example pictures, defined by formulas because no freely licensed picture has such a wide gamut.

use upglow_color::rounding::to_single;

/// A picture in linear ACEScg, each channel 0..=1.
#[derive(Clone, Copy, Debug)]
pub struct ExamplePicture {
    /// The name of its file, without extension.
    pub name: &'static str,
    /// A description.
    pub about: &'static str,
    /// Width and height in texels.
    pub size: [usize; 2],
    color: fn([f64; 2]) -> [f64; 3],
}

impl ExamplePicture {
    /// The three pictures.
    pub const ALL: [Self; 3] = [
        Self {
            name: "pool",
            about: "tiles of a swimming pool, with a ring of ACEScg (0.9, 0, 0.9) that no reflectance shows",
            size: [512, 512],
            color: pool,
        },
        Self {
            name: "chart",
            about: "twelve hues, from gray to the edge of ACEScg, and twelve grays",
            size: [576, 384],
            color: chart,
        },
        Self {
            name: "dusk",
            about: "an evening sky with lamps: smooth gradients of wide-gamut colors, as in a photograph",
            size: [768, 432],
            color: dusk,
        },
    ];

    /// The color of the texel in column `x` of row `y`, counted from the top left.
    pub fn texel(&self, [x, y]: [usize; 2]) -> [f32; 3] {
        let at = [(x as f64 + 0.5) / self.size[0] as f64, (y as f64 + 0.5) / self.size[1] as f64];
        (self.color)(at).map(to_single)
    }

    /// All texels of a row.
    pub fn row(&self, y: usize) -> Vec<[f32; 3]> {
        (0..self.size[0]).map(|x| self.texel([x, y])).collect()
    }
}

/// Blue square tiles with light grout, and a magenta ring on top.
fn pool([u, v]: [f64; 2]) -> [f64; 3] {
    const TILES: f64 = 16.0;
    const MAGENTA: [f64; 3] = [0.9, 0.0, 0.9];
    let [x, y] = [u * TILES, v * TILES];
    let edge = |p: f64| (p.fract() - 0.5).abs();
    let grout = step(0.45, 0.48, edge(x).max(edge(y)));
    let shade = scatter([x.floor(), y.floor()]);
    let tile = mix([0.02, 0.22, 0.42], [0.12, 0.55, 0.66], shade);
    let water = mix(tile, [0.55, 0.6, 0.58], grout);
    let radius = ((u - 0.5).powi(2) + (v - 0.5).powi(2)).sqrt();
    let off = (radius - 0.3).abs();
    mix(MAGENTA, water, step(0.055, 0.06, off))
}

/// Columns of hues whose saturation increases from top to bottom, and a last row of grays.
fn chart([u, v]: [f64; 2]) -> [f64; 3] {
    const COLUMNS: f64 = 12.0;
    const ROWS: f64 = 8.0;
    const FRAME: [f64; 3] = [0.03; 3];
    let [x, y] = [u * COLUMNS, v * ROWS];
    if (x.fract() - 0.5).abs() > 0.44 || (y.fract() - 0.5).abs() > 0.44 {
        return FRAME;
    }
    let (column, row) = (x.floor(), y.floor());
    if row == ROWS - 1.0 {
        return [column / (COLUMNS - 1.0); 3];
    }
    let saturation = (row + 1.0) / (ROWS - 1.0);
    mix([0.5; 3], hue(column / COLUMNS).map(|c| 0.9 * c), saturation)
}

/// A sky from deep blue over magenta to orange, with hills and lamps of all hues.
fn dusk([u, v]: [f64; 2]) -> [f64; 3] {
    const LAMPS: f64 = 9.0;
    let glow = (1.0 - ((u - 0.7) / 0.9).powi(2)).max(0.0);
    let high = mix([0.02, 0.03, 0.28], [0.55, 0.05, 0.5], step(0.05, 0.55, v));
    let sky = mix(high, [0.98, 0.42, 0.06], step(0.35, 0.75, v) * glow);
    let crest = 0.72 + 0.05 * wave(1.3 * u + 0.1) + 0.02 * wave(4.1 * u);
    let land = mix([0.03, 0.06, 0.05], [0.01, 0.02, 0.02], step(crest, 1.0, v));
    let scene = mix(sky, land, step(crest, crest + 0.01, v));
    let lamp = (u * LAMPS).floor();
    let [x, y] = [(u * LAMPS).fract() - 0.5, (v - 0.86) * LAMPS * 9.0 / 16.0];
    let light = hue(lamp / LAMPS).map(|c| 0.95 * c);
    mix(light, scene, step(0.06, 0.4, (x * x + y * y).sqrt()))
}

/// A saturated hue for 0..1: red, green, blue and back to red.
fn hue(turn: f64) -> [f64; 3] {
    let channel = |center: f64| {
        let off = (turn - center).abs();
        let off = off.min(1.0 - off);
        (2.0 - 6.0 * off).clamp(0.0, 1.0)
    };
    [channel(0.0), channel(1.0 / 3.0), channel(2.0 / 3.0)]
}

/// A smooth step from 0 at `from` to 1 at `to`.
fn step(from: f64, to: f64, at: f64) -> f64 {
    let t = ((at - from) / (to - from)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

fn mix(a: [f64; 3], b: [f64; 3], share: f64) -> [f64; 3] {
    [0, 1, 2].map(|k| a[k] + share * (b[k] - a[k]))
}

/// A wave between −1 and 1 of period 1, made of parabolas.
fn wave(turn: f64) -> f64 {
    let t = 2.0 * turn.rem_euclid(1.0) - 1.0;
    4.0 * t * (t.abs() - 1.0)
}

/// A number in 0..1 for each pair of integers, without a visible pattern.
fn scatter([x, y]: [f64; 2]) -> f64 {
    (0.5 + 0.5 * wave(0.618_034 * x + 0.754_878 * y * (x + 1.0) + 0.31 * y)).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_texel_is_a_color_of_the_cube() {
        for picture in ExamplePicture::ALL {
            for y in 0..picture.size[1] {
                let row = picture.row(y);
                assert!(row.as_flattened().iter().all(|v| (0.0..=1.0).contains(v)));
            }
        }
    }

    #[test]
    fn the_pool_has_its_ring() {
        let pool = ExamplePicture::ALL[0];
        assert_eq!(pool.texel([256 + 153, 256]), [0.9, 0.0, 0.9]);
        assert!(pool.texel([256, 256])[2] > pool.texel([256, 256])[0]);
    }
}
