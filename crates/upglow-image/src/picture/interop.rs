//! Color spaces by the names of the ASWF Color Interop Forum.

use upglow_color::RgbSpace;

use super::encoding::Encoding;

/// The names of color spaces, without `data` and `unknown`. `docs/guide.md` lists their source.
const IDS: [&str; 15] = [
    "lin_ap1_scene",
    "lin_ap0_scene",
    "lin_rec709_scene",
    "lin_p3d65_scene",
    "lin_rec2020_scene",
    "lin_adobergb_scene",
    "lin_ciexyzd65_scene",
    "srgb_rec709_scene",
    "g24_rec709_scene",
    "g22_rec709_scene",
    "g18_rec709_scene",
    "srgb_ap1_scene",
    "g22_ap1_scene",
    "srgb_p3d65_scene",
    "g22_adobergb_scene",
];

/// The exponent of Adobe RGB (1998), 4.3.4.2.
const ADOBE_GAMMA: f64 = 563.0 / 256.0;

/// What a name of the Color Interop Forum means.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum InteropSpace {
    /// Colors in this RGB space and encoding.
    Color(RgbSpace, Encoding),
    /// `data`: numbers that are no colors.
    Data,
    /// `unknown`: colors of which nothing is known.
    Unknown,
}

impl InteropSpace {
    /// The name of [`InteropSpace::Data`].
    pub(crate) const DATA: &str = "data";

    /// The name of linear colors in an RGB space, if it has one.
    pub fn linear_id(space: &RgbSpace) -> Option<&'static str> {
        let linear = Some(Self::Color(space.clone(), Encoding::Linear));
        IDS.into_iter().find(|id| Self::of_id(id) == linear)
    }

    /// The meaning of a name; `None` for other texts.
    pub fn of_id(id: &str) -> Option<Self> {
        match id {
            Self::DATA => return Some(Self::Data),
            "unknown" => return Some(Self::Unknown),
            _ => {}
        }
        let id = IDS.into_iter().find(|known| *known == id)?;
        let (curve, primaries) = id.strip_suffix("_scene")?.split_once('_')?;
        if primaries == "ciexyzd65" {
            return Some(Self::Color(xyz_d65(), Encoding::XyzD65));
        }
        let encoding = match (curve, primaries) {
            ("lin", _) => Encoding::Linear,
            ("srgb", _) => Encoding::Srgb,
            ("g22", "adobergb") => Encoding::Gamma(ADOBE_GAMMA),
            ("g18", _) => Encoding::Gamma(1.8),
            ("g22", _) => Encoding::Gamma(2.2),
            _ => Encoding::Gamma(2.4),
        };
        Some(Self::Color(RgbSpace::named(primaries).ok()?, encoding))
    }
}

/// X, Y and Z as primaries, whose white is D65.
fn xyz_d65() -> RgbSpace {
    let [axes, white] = ["xyz", "srgb"].map(|name| RgbSpace::named(name).expect("it is built in"));
    RgbSpace::custom("xyz-d65", axes.primaries(), white.white()).expect("its white is inside")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_id_is_a_color_space() {
        let color = |id: &str| match InteropSpace::of_id(id) {
            Some(InteropSpace::Color(space, encoding)) => (space.name().to_owned(), encoding),
            other => panic!("{id}: {other:?}"),
        };
        for id in IDS {
            let is_linear = matches!(color(id).1, Encoding::Linear | Encoding::XyzD65);
            assert_eq!(is_linear, id.starts_with("lin_"), "{id}");
        }
        assert_eq!(color("lin_ap1_scene"), ("acescg".into(), Encoding::Linear));
        assert_eq!(color("g22_adobergb_scene"), ("adobe-rgb".into(), Encoding::Gamma(2.19921875)));
        assert_eq!(color("srgb_p3d65_scene"), ("p3-d65".into(), Encoding::Srgb));
        assert_eq!(color("g24_rec709_scene"), ("srgb".into(), Encoding::Gamma(2.4)));
        assert_eq!(InteropSpace::of_id("data"), Some(InteropSpace::Data));
        assert_eq!(InteropSpace::of_id("srgb_ap0_scene"), None);
        assert_eq!(InteropSpace::of_id("studio:lin_ap1_scene"), None);
    }

    #[test]
    fn linear_spaces_have_the_ids_that_name_them() {
        for (name, id) in [
            ("acescg", Some("lin_ap1_scene")),
            ("aces2065-1", Some("lin_ap0_scene")),
            ("srgb", Some("lin_rec709_scene")),
            ("rec2020", Some("lin_rec2020_scene")),
            ("xyz", None),
        ] {
            assert_eq!(InteropSpace::linear_id(&RgbSpace::named(name).unwrap()), id, "{name}");
        }
    }

    #[test]
    fn the_white_of_xyz_d65_is_its_xyz() {
        let Some(InteropSpace::Color(space, encoding)) = InteropSpace::of_id("lin_ciexyzd65_scene")
        else {
            panic!("it is listed");
        };
        let xyz = upglow_color::Xyz::from_chromaticity(space.white()).0;
        for v in encoding.to_linear(xyz) {
            // Rounding only.
            assert!((v - 1.0).abs() < 1e-14);
        }
    }
}
