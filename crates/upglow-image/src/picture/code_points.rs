//! Code points of ITU-T H.273, as PNG's cICP and ICC profiles have them.

use upglow_color::RgbSpace;

use super::encoding::Encoding;
use super::error::PictureError;
use super::stated::{Stated, StatedColor};

const BY: &str = "cICP";

/// What the four numbers of a cICP chunk state.
///
/// # Errors
///
/// [`PictureError`] for PQ, HLG, and numbers that are no RGB of full range.
pub(super) fn stated(
    primaries: u8,
    transfer: u8,
    matrix: u8,
    is_full_range: bool,
) -> Result<StatedColor, PictureError> {
    check_transfer(transfer, BY)?;
    if matrix != 0 || !is_full_range {
        let range = if is_full_range { "full" } else { "narrow" };
        return Err(PictureError::pixels(
            format!("cICP with matrix {matrix} and {range} range"),
            "RGB of full range: save the picture as RGB",
        ));
    }
    let name = match primaries {
        1 => Some("srgb"),
        9 => Some("rec2020"),
        12 => Some("p3-d65"),
        _ => None,
    };
    let encoding = match transfer {
        1 | 6 | 14 | 15 => Some(Encoding::Bt709),
        4 => Some(Encoding::Gamma(2.2)),
        5 => Some(Encoding::Gamma(2.8)),
        8 => Some(Encoding::Linear),
        13 => Some(Encoding::Srgb),
        _ => None,
    };
    let space = name.and_then(|name| RgbSpace::named(name).ok());
    let unread = |what, code| format!("cICP with {what} {code}");
    Ok(StatedColor {
        space: space.map_or_else(
            || Stated::Unread(unread("primaries", primaries)),
            |space| Stated::yes(space, BY),
        ),
        encoding: encoding.map_or_else(
            || Stated::Unread(unread("transfer", transfer)),
            |encoding| Stated::yes(encoding, BY),
        ),
    })
}

/// Refuses the curves of displays of high dynamic range: their numbers are no reflectances.
pub(super) fn check_transfer(transfer: u8, by: &'static str) -> Result<(), PictureError> {
    let curve = match transfer {
        16 => "PQ",
        18 => "HLG",
        _ => return Ok(()),
    };
    Err(PictureError::HighDynamicRange { by, curve })
}
