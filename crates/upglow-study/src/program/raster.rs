//! Pictures of pixels as PNG: from colors, dots on a transparent ground, drawings on white.

use resvg::tiny_skia::{Color, FillRule, IntSize, Paint, PathBuilder, Pixmap, Transform};

/// A PNG of opaque pixels, `[row][column]` from the top left.
///
/// # Panics
///
/// If there are no pixels, or they do not fill the rows.
pub(crate) fn png(columns: usize, colors: &[[u8; 3]]) -> Vec<u8> {
    let side = |n: usize| u32::try_from(n).expect("a picture has fewer than 2³² rows");
    let data = colors.iter().flat_map(|&[r, g, b]| [r, g, b, u8::MAX]).collect();
    let size = IntSize::from_wh(side(columns), side(colors.len() / columns));
    let pixmap = size.and_then(|size| Pixmap::from_vec(data, size)).expect("rows are filled");
    encoded(&pixmap)
}

/// A PNG of dots on a transparent ground; centers and radius in pixels. Later dots lie above.
///
/// # Panics
///
/// If a side is zero.
pub(crate) fn dots_png(size: [u32; 2], radius: f32, dots: &[([f32; 2], [u8; 3])]) -> Vec<u8> {
    let mut pixmap = Pixmap::new(size[0], size[1]).expect("no side is zero");
    for &([x, y], [r, g, b]) in dots {
        let Some(circle) = PathBuilder::from_circle(x, y, radius) else { continue };
        let mut paint = Paint::default();
        paint.set_color(Color::from_rgba8(r, g, b, u8::MAX));
        pixmap.fill_path(&circle, &paint, FillRule::Winding, Transform::identity(), None);
    }
    encoded(&pixmap)
}

fn encoded(pixmap: &Pixmap) -> Vec<u8> {
    pixmap.encode_png().expect("memory takes any bytes")
}

/// A picture on white, as PNG.
///
/// # Panics
///
/// If `svg` is not one that [`crate::svg`] wrote, or the picture has no pixels.
pub(crate) fn rendered(svg: &str, scale: f32) -> Vec<u8> {
    let tree = resvg::usvg::Tree::from_str(svg, &crate::fonts::svg_options())
        .expect("drawings are well-formed");
    let size = tree.size().to_int_size().scale_by(scale).expect("the scale is positive");
    let mut pixmap = Pixmap::new(size.width(), size.height()).expect("no side is zero");
    pixmap.fill(Color::WHITE);
    let fit =
        [size.width() as f32 / tree.size().width(), size.height() as f32 / tree.size().height()];
    resvg::render(&tree, Transform::from_scale(fit[0], fit[1]), &mut pixmap.as_mut());
    encoded(&pixmap)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_come_back_from_their_png() {
        let colors = [[1, 2, 3], [4, 5, 6], [250, 0, 9], [7, 8, 9]];
        let back = Pixmap::decode_png(&png(2, &colors)).unwrap();
        let found: Vec<[u8; 3]> =
            back.pixels().iter().map(|p| [p.red(), p.green(), p.blue()]).collect();
        assert_eq!(found, colors);
    }

    #[test]
    fn a_dot_lies_where_it_is_put() {
        let png = dots_png([9, 9], 1.5, &[([2.5, 6.5], [10, 20, 30])]);
        let back = Pixmap::decode_png(&png).unwrap();
        assert_eq!(back.pixel(2, 6).unwrap().alpha(), 255);
        assert_eq!(back.pixel(6, 2).unwrap().alpha(), 0);
    }
}
