//! The color of a cube's material under one light, as a node for RGB renderers.

use upglow_color::LinearRgb;
use upglow_color::rounding::to_single;

use crate::error::ShaderError;
use crate::language::Language;
use crate::shader::{OSL_TEXEL, PayloadFile};
use crate::template::places;
use crate::textures::MOST_TEXELS;
use crate::translation::translate;

/// The name of the node, and of its function in every language.
pub(crate) const NODE: &str = "upglow_color";

/// The file of the function in GLSL or OSL.
pub(crate) fn file_name(language: Language) -> String {
    format!("{NODE}.{language}")
}

/// The node's function in the languages of MaterialX: the same for all cubes, which differ in the
/// texture that it reads.
pub fn color_node() -> [PayloadFile; 2] {
    [(Language::Glsl, String::new(), GLSL), (Language::Osl, OSL_TEXEL.to_owned(), OSL)].map(
        |(language, texel, function)| {
            let places = translate(&places(language), language);
            let text = format!("{HEADING}{texel}{places}{function}");
            PayloadFile { name: file_name(language), bytes: text.into_bytes() }
        },
    )
}

const HEADING: &str = "\
// Made by upglow; do not edit.
// SPDX-License-Identifier: MIT OR Apache-2.0
//
// The color of a cube's material under a light: docs/materialx.md.

";

/// Without a texture, the color is what was asked for.
const GLSL: &str = "
vec3 upglow_corner_color(sampler2D colors, UpglowCorner c) {
    return c.weight * texelFetch(colors, ivec2(c.red, c.row), 0).rgb;
}

void upglow_color(sampler2D colors, vec3 rgb, out vec3 result) {
    int n = textureSize(colors, 0).x;
    result = rgb;
    if (n > 1) {
        UpglowMaterial m = upglow_look_up(rgb, n);
        result = upglow_corner_color(colors, m.a) + upglow_corner_color(colors, m.b)
            + upglow_corner_color(colors, m.c) + upglow_corner_color(colors, m.d);
    }
}
";

/// `textureresource` is the type of files in MaterialX.
const OSL: &str = "
color upglow_corner_color(string file, int n, UpglowCorner c) {
    UpglowTexel texel = upglow_texel(file, (c.red + 0.5) / n, (c.row + 0.5) / (2 * n * n));
    return c.weight * color(texel.x, texel.y, texel.z);
}

void upglow_color(textureresource colors, color rgb, output color result) {
    int size[2] = {0, 0};
    result = rgb;
    if (gettextureinfo(colors.filename, \"resolution\", size) && size[0] > 1) {
        int n = size[0];
        UpglowMaterial m = upglow_look_up(rgb, n);
        result = upglow_corner_color(colors.filename, n, m.a)
            + upglow_corner_color(colors.filename, n, m.b)
            + upglow_corner_color(colors.filename, n, m.c)
            + upglow_corner_color(colors.filename, n, m.d);
    }
}
";

/// The colors of a cube's nodes, as the node reads them.
///
/// For n nodes along an axis, pixel (red, blue·n + green) is the color of a node. After these n² rows
/// the same follow in reverse order: some renderers load pictures with the lowest row first, and so
/// find the same numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct ColorTexture {
    /// Width and height, pixels.
    pub size: [usize; 2],
    /// Red, green and blue, `[channel][row][column]`.
    pub planes: [Vec<f32>; 3],
}

impl ColorTexture {
    /// The texture of as many colors as a cube with `resolution` nodes along each axis has, red fastest.
    ///
    /// # Errors
    ///
    /// [`ShaderError::Resolution`] if the texture would have more rows than drivers support.
    ///
    /// # Panics
    ///
    /// If there are not `resolution`³ colors.
    pub fn new(resolution: usize, colors: &[LinearRgb]) -> Result<Self, ShaderError> {
        let rows = 2 * resolution * resolution;
        if rows > MOST_TEXELS {
            return Err(ShaderError::Resolution {
                found: resolution,
                most: (MOST_TEXELS / 2).isqrt(),
            });
        }
        assert_eq!(colors.len(), resolution.pow(3), "one color for each node");
        let plane = |channel: usize| {
            let row = |row: &[LinearRgb]| row.iter().map(|rgb| to_single(rgb.0[channel])).collect();
            let rows: Vec<Vec<f32>> = colors.chunks(resolution).map(row).collect();
            rows.iter().chain(rows.iter().rev()).flatten().copied().collect()
        };
        Ok(Self { size: [resolution, rows], planes: [0, 1, 2].map(plane) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn upside_down_the_texture_is_the_same() {
        let colors: Vec<LinearRgb> = (0..27).map(|i| LinearRgb([f64::from(i); 3])).collect();
        let ColorTexture { size: [width, height], planes } = ColorTexture::new(3, &colors).unwrap();
        assert_eq!([width, height], [3, 18]);
        let row = |y: usize| &planes[1][y * width..][..width];
        for y in 0..height {
            assert_eq!(row(y), row(height - 1 - y));
        }
        // Red 2, green 1, blue 2.
        assert_eq!(row(2 * 3 + 1)[2], 23.0);
    }

    #[test]
    fn cubes_that_make_too_tall_a_texture_are_refused() {
        let texture = |n: usize| ColorTexture::new(n, &vec![LinearRgb([0.0; 3]); n.pow(3)]);
        assert!(texture(64).is_ok());
        let refused = ShaderError::Resolution { found: 65, most: 64 };
        assert_eq!(texture(65).unwrap_err(), refused);
    }

    #[test]
    fn the_function_holds_no_more_than_it_needs() {
        for file in color_node() {
            let text = String::from_utf8(file.bytes).unwrap();
            assert!(text.contains("upglow_look_up("), "{text}");
            for word in ["UPGLOW_", "edge_nm", "//@", "upglow_node("] {
                assert!(!text.contains(word), "{}: {word}", file.name);
            }
        }
    }
}
