//! Chromatic adaptation from the white of an RGB space to the white of the illuminant.

use crate::matrix::Matrix3;
use crate::values::Xyz;

/// How colors of the RGB space are adapted to the illuminant's white.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
#[non_exhaustive]
pub enum Adaptation {
    /// Bradford's cone responses are scaled from the space's white to the illuminant's, so RGB (1, 1, 1)
    /// is the perfect diffuser.
    #[default]
    Bradford,
    /// The space's own matrix is used unchanged. Grays are flat only if both whites are the same.
    None,
}

/// Bradford's sharpened cone responses. # Source: `bradford`, as in ICC.1:2022, annex E.
const LMS_FROM_XYZ: Matrix3 =
    Matrix3([[0.8951, 0.2664, -0.1614], [-0.7502, 1.7135, 0.0367], [0.0389, -0.0685, 1.0296]]);

impl Adaptation {
    /// The matrix from tristimulus values under the white `source` to those under the white `target`.
    pub fn target_from_source(self, source: Xyz, target: Xyz) -> Matrix3 {
        match self {
            Self::None => Matrix3::IDENTITY,
            Self::Bradford => {
                let (from, to) = (LMS_FROM_XYZ * source.0, LMS_FROM_XYZ * target.0);
                let gains = Matrix3::diagonal([0, 1, 2].map(|k| to[k] / from[k]));
                let xyz_from_lms = LMS_FROM_XYZ.inverse().expect("the constant is invertible");
                xyz_from_lms * gains * LMS_FROM_XYZ
            }
        }
    }
}

crate::choices!(Adaptation, "adaptation", Bradford = "bradford", None = "none");

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bradford_maps_one_white_to_the_other() {
        let (d60, d65) = (Xyz([0.952_65, 1.0, 1.008_83]), Xyz([0.950_43, 1.0, 1.088_80]));
        let adapted = Adaptation::Bradford.target_from_source(d60, d65) * d60.0;
        for k in 0..3 {
            // Rounding only.
            assert!((adapted[k] - d65.0[k]).abs() < 1e-14);
        }
    }
}
