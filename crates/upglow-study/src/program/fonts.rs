//! The typeface of the figures: embedded, so that no machine's own fonts change a picture.

use std::sync::{Arc, OnceLock};

use damascene_fonts_roboto::{ROBOTO_BOLD, ROBOTO_ITALIC, ROBOTO_REGULAR};
use resvg::usvg::{Options, fontdb};

/// What an SVG file asks for: the typeface of the PNG first, then what machines have.
pub(crate) const FONT_STACK: &str = "Roboto, 'Helvetica Neue', Helvetica, Arial, sans-serif";

/// How SVG is read: with the embedded typeface and nothing of the system.
pub(crate) fn svg_options() -> Options<'static> {
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
