//! What a file states of its colors, and what its reader makes of that.

use std::fmt;

use upglow_color::rounding::to_single;
use upglow_color::{RgbSpace, RgbSpaceError, choices};

use super::encoding::Encoding;
use super::error::PictureError;
use super::source::{Alpha, LastSample};

/// What a file states of one property.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Stated<T> {
    /// Nothing.
    No,
    /// A value, and the part of the file that states it.
    Yes { value: T, by: &'static str },
    /// Something that is not read: it must not be guessed.
    Unread(String),
    /// Something that is not valid.
    Invalid(Box<StatementError>),
}

/// Why what a file states is not valid.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum StatementError {
    /// Chromaticities of no RGB space.
    #[error("{by} {}", numbers(.found))]
    Chromaticities {
        /// The part of the file that states them.
        by: &'static str,
        /// Those of red, green, blue and white.
        found: [[f64; 2]; 4],
        /// What is wrong with them.
        source: RgbSpaceError,
    },
    /// A gamma that no picture has.
    #[error("{by} states a gamma of {found}, expected {}", Encoding::GAMMAS)]
    Gamma {
        /// The part of the file that states it.
        by: &'static str,
        /// The gamma.
        found: f64,
    },
}

impl StatementError {
    fn by(&self) -> &'static str {
        let (Self::Chromaticities { by, .. } | Self::Gamma { by, .. }) = self;
        by
    }
}

/// Chromaticities as `--space` has them, in the digits of single precision.
fn numbers(found: &[[f64; 2]; 4]) -> String {
    let each = found.as_flattened().iter().map(|&v| format!("{:?}", to_single(v)));
    each.collect::<Vec<_>>().join(",")
}

/// What a file states of its colors.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct StatedColor {
    pub(super) space: Stated<RgbSpace>,
    pub(super) encoding: Stated<Encoding>,
}

impl<T> Stated<T> {
    pub(super) fn yes(value: T, by: &'static str) -> Self {
        Self::Yes { value, by }
    }

    pub(super) fn invalid(error: StatementError) -> Self {
        Self::Invalid(Box::new(error))
    }

    /// This statement, or the other if there is none.
    pub(super) fn or(self, other: Self) -> Self {
        if matches!(self, Self::No) { other } else { self }
    }
}

impl StatedColor {
    pub(super) fn yes(space: RgbSpace, encoding: Encoding, by: &'static str) -> Self {
        Self { space: Stated::yes(space, by), encoding: Stated::yes(encoding, by) }
    }

    pub(super) fn unread(found: String) -> Self {
        Self { space: Stated::Unread(found.clone()), encoding: Stated::Unread(found) }
    }
}

/// What the caller declares of pictures. It has priority over what files state.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Declared {
    /// The RGB space.
    pub space: Option<RgbSpace>,
    /// The encoding.
    pub encoding: Option<Encoding>,
    /// How colors and alpha are combined.
    pub alpha: Option<DeclaredAlpha>,
    /// The layer of an OpenEXR file: the text before `.R`, or the name of its part.
    pub layer: Option<String>,
}

/// How colors and the sample after them are combined.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DeclaredAlpha {
    /// It is alpha, and colors are not multiplied by it.
    Straight,
    /// It is alpha, and colors are multiplied by it.
    Associated,
    /// It is not alpha, or it has no meaning.
    None,
}

choices!(
    DeclaredAlpha,
    "use of alpha",
    Straight = "straight",
    Associated = "associated",
    None = "none",
);

/// Who states a property of a picture, and what.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Word {
    /// The property that was used.
    pub used: String,
    /// Who stated it: "declared", or a part of the file.
    pub by: String,
    /// What the file states, if something else was declared.
    pub overruled: Option<String>,
}

/// How the numbers of a picture were understood, and on whose word.
#[derive(Clone, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize))]
pub struct Interpretation {
    /// The RGB space.
    pub space: Word,
    /// The encoding.
    pub encoding: Word,
    /// How alpha was used: straight, associated or none.
    pub alpha: &'static str,
}

impl Interpretation {
    /// Whether the file states another RGB space or encoding than was declared.
    pub fn is_overruled(&self) -> bool {
        self.space.overruled.is_some() || self.encoding.overruled.is_some()
    }
}

impl fmt::Display for Word {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { used, by, overruled } = self;
        match overruled {
            Some(file) => write!(f, "{used} ({by}; the file states {file})"),
            None => write!(f, "{used} ({by})"),
        }
    }
}

impl fmt::Display for Interpretation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { space, encoding, alpha } = self;
        write!(f, "RGB space {space}, encoding {encoding}, alpha {alpha}")
    }
}

/// The space, encoding and alpha of a picture: what was declared, or else what the file states.
#[derive(Clone, Debug)]
pub(crate) struct Chosen {
    pub(crate) space: RgbSpace,
    pub(crate) encoding: Encoding,
    pub(crate) interpretation: Interpretation,
}

/// The use of the sample after the colors.
pub(super) fn alpha(
    stated: LastSample,
    declared: Option<DeclaredAlpha>,
) -> Result<Option<Alpha>, PictureError> {
    Ok(match (stated, declared) {
        (LastSample::Absent, _) | (_, Some(DeclaredAlpha::None)) => None,
        (_, Some(DeclaredAlpha::Straight)) => Some(Alpha::Straight),
        (_, Some(DeclaredAlpha::Associated)) => Some(Alpha::Associated),
        (LastSample::Alpha(alpha), None) => Some(alpha),
        (LastSample::NotAlpha, None) => None,
        (LastSample::Unstated, None) => return Err(PictureError::Alpha),
    })
}

/// The space and encoding to use.
///
/// # Errors
///
/// [`PictureError::Unstated`] if neither the file nor the caller states both, [`PictureError::Statement`] if
/// what the file states is not valid and nothing else is declared.
pub(super) fn choose(
    stated: &StatedColor,
    declared: &Declared,
    alpha: Option<Alpha>,
) -> Result<Chosen, PictureError> {
    let space = word(&stated.space, declared.space.as_ref(), |space| space.name().to_owned());
    let encoding = word(&stated.encoding, declared.encoding.as_ref(), Encoding::to_string);
    let alpha = match alpha {
        Some(Alpha::Associated) => DeclaredAlpha::Associated,
        Some(Alpha::Straight) => DeclaredAlpha::Straight,
        None => DeclaredAlpha::None,
    };
    match (space, encoding) {
        (Ok((space, space_word)), Ok((encoding, encoding_word))) => {
            let alpha = upglow_color::Choice::name(alpha);
            let interpretation =
                Interpretation { space: space_word, encoding: encoding_word, alpha };
            Ok(Chosen { space, encoding, interpretation })
        }
        (space, encoding) => {
            let missing = match (space.is_err(), encoding.is_err()) {
                (true, true) => Missing::Both,
                (true, false) => Missing::Space,
                _ => Missing::Encoding,
            };
            let mut found = None;
            for unknown in [space.err(), encoding.err()].into_iter().flatten() {
                match unknown {
                    Unknown::Unstated => {}
                    Unknown::Unread(text) => found = found.or(Some(text)),
                    Unknown::Invalid(error) => return Err(error.into()),
                }
            }
            Err(PictureError::Unstated { missing, found: Found(found) })
        }
    }
}

/// Which of RGB space and encoding nobody states.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Missing {
    /// The RGB space.
    Space,
    /// The encoding.
    Encoding,
    /// Both.
    Both,
}

impl fmt::Display for Missing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Space => "its RGB space",
            Self::Encoding => "its encoding",
            Self::Both => "its RGB space and encoding",
        })
    }
}

/// What a file states instead, which is not read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Found(pub(super) Option<String>);

impl fmt::Display for Found {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.0 {
            Some(found) => write!(f, "{found}, which is not read, does not say"),
            None => f.write_str("the file does not state"),
        }
    }
}

/// Why neither file nor caller state a property.
enum Unknown {
    Unstated,
    Unread(String),
    Invalid(Box<StatementError>),
}

/// The declared value, or the stated one.
fn word<T: Clone + PartialEq>(
    stated: &Stated<T>,
    declared: Option<&T>,
    name: impl Fn(&T) -> String,
) -> Result<(T, Word), Unknown> {
    match (declared, stated) {
        (Some(declared), stated) => {
            let overruled = match stated {
                Stated::Yes { value, by } if value != declared => {
                    Some(format!("{} ({by})", name(value)))
                }
                Stated::Unread(found) => Some(found.clone()),
                Stated::Invalid(error) => Some(format!("invalid {}", error.by())),
                _ => None,
            };
            let word = Word { used: name(declared), by: "declared".into(), overruled };
            Ok((declared.clone(), word))
        }
        (None, Stated::Yes { value, by }) => {
            let word = Word { used: name(value), by: (*by).into(), overruled: None };
            Ok((value.clone(), word))
        }
        (None, Stated::No) => Err(Unknown::Unstated),
        (None, Stated::Unread(found)) => Err(Unknown::Unread(found.clone())),
        (None, Stated::Invalid(error)) => Err(Unknown::Invalid(error.clone())),
    }
}
