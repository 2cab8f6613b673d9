//! PNG pictures: of single pixels, of dots, and of drawings.

use std::sync::{Arc, OnceLock};

use damascene_fonts_roboto::{ROBOTO_BOLD, ROBOTO_ITALIC, ROBOTO_REGULAR};
use resvg::tiny_skia::{Color, FillRule, IntSize, Paint, PathBuilder, Pixmap, Transform};
use resvg::usvg::{Options, Tree, fontdb};

/// A PNG of opaque sRGB pixels, `[row][column]` from the top left.
///
/// # Panics
///
/// If there are no pixels, or the last row is incomplete.
pub(crate) fn png(columns: usize, colors: &[[u8; 3]]) -> Vec<u8> {
    let side = |n: usize| u32::try_from(n).expect("a picture has fewer than 2³² rows");
    let data = colors.iter().flat_map(|&[r, g, b]| [r, g, b, u8::MAX]).collect();
    let size = IntSize::from_wh(side(columns), side(colors.len() / columns));
    let pixmap = size.and_then(|size| Pixmap::from_vec(data, size)).expect("rows are filled");
    encoded(&pixmap)
}

/// A PNG of dots on a transparent background; centers and radius in pixels. Later dots cover
/// earlier ones.
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
    pixmap.encode_png().expect("encoding to memory does not fail")
}

/// An SVG drawing on white as PNG; at `scale` 1 it has 96 pixels per inch.
///
/// # Panics
///
/// If `svg` is not well-formed, or `scale` is not positive.
pub(crate) fn rendered(svg: &str, scale: f32) -> Vec<u8> {
    let tree = Tree::from_str(svg, &svg_options()).expect("drawings are well-formed");
    let size = tree.size().to_int_size().scale_by(scale).expect("the scale is positive");
    let mut pixmap = Pixmap::new(size.width(), size.height()).expect("no side is zero");
    pixmap.fill(Color::WHITE);
    let fit =
        [size.width() as f32 / tree.size().width(), size.height() as f32 / tree.size().height()];
    resvg::render(&tree, Transform::from_scale(fit[0], fit[1]), &mut pixmap.as_mut());
    encoded(&pixmap)
}

/// The embedded typeface instead of the system's fonts: pictures are the same on every machine.
fn svg_options() -> Options<'static> {
    static FACES: OnceLock<Arc<fontdb::Database>> = OnceLock::new();
    let faces = FACES.get_or_init(|| {
        let mut faces = fontdb::Database::new();
        for face in [ROBOTO_REGULAR, ROBOTO_BOLD, ROBOTO_ITALIC] {
            faces.load_font_data(face.to_vec());
        }
        faces.set_sans_serif_family("Roboto");
        Arc::new(faces)
    });
    Options { fontdb: Arc::clone(faces), font_family: "Roboto".into(), ..Options::default() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_png_holds_the_pixels_it_was_made_of() {
        let colors = [[1, 2, 3], [4, 5, 6], [250, 0, 9], [7, 8, 9]];
        let back = Pixmap::decode_png(&png(2, &colors)).unwrap();
        let found: Vec<[u8; 3]> =
            back.pixels().iter().map(|p| [p.red(), p.green(), p.blue()]).collect();
        assert_eq!(found, colors);
    }

    #[test]
    fn a_dot_is_drawn_at_its_center() {
        let png = dots_png([9, 9], 1.5, &[([2.5, 6.5], [10, 20, 30])]);
        let back = Pixmap::decode_png(&png).unwrap();
        assert_eq!(back.pixel(2, 6).unwrap().alpha(), 255);
        assert_eq!(back.pixel(6, 2).unwrap().alpha(), 0);
    }
}
