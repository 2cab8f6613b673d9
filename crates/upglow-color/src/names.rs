//! Names of lights, observers, RGB spaces and dyes: a built-in name stands for built-in numbers.

use std::ffi::OsStr;
use std::path::Path;

use crate::spectrum::Spectrum;

/// Why something cannot have a name.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum NameError {
    /// The text would break the line that it is printed in.
    #[error("text {found:?} holds a control character, expected one line")]
    Control {
        /// The text's first characters.
        found: String,
    },
    /// The name is that of something built in, which has other numbers.
    #[error(
        "{name:?} is a built-in {kind} whose {number} is {expected}, found {found}: expected the built-in numbers, or another name"
    )]
    Taken {
        /// What has the name: "illuminant", "dye" and so on.
        kind: &'static str,
        /// The name.
        name: String,
        /// The first number that differs, with its wavelength if it has one.
        number: String,
        /// The built-in number.
        expected: String,
        /// The number given.
        found: String,
    },
}

impl NameError {
    /// Refuses a text that does not fit in one line.
    ///
    /// # Errors
    ///
    /// [`NameError::Control`] if a character is not [plain](is_plain).
    pub fn check_text(text: &str) -> Result<(), Self> {
        if !text.chars().all(is_plain) {
            return Err(Self::Control { found: text.chars().take(40).collect() });
        }
        Ok(())
    }

    /// Refuses a curve that is not the built-in one. Samples may differ by `tolerance` times the
    /// greatest built-in sample.
    pub(crate) fn check_curve(
        kind: &'static str,
        name: &str,
        column: &str,
        found: &Spectrum,
        built_in: &Spectrum,
        tolerance: f64,
    ) -> Result<(), Self> {
        let limit = tolerance * built_in.peak();
        let pairs = found.values().iter().zip(built_in.values());
        let mut samples = built_in.grid().wavelengths_nm().zip(pairs);
        match samples.find(|(_, (found, expected))| (*found - *expected).abs() > limit) {
            None => Ok(()),
            Some((nm, (found, expected))) => Err(Self::Taken {
                kind,
                name: name.into(),
                number: format!("{column} at {nm} nm"),
                expected: expected.to_string(),
                found: found.to_string(),
            }),
        }
    }
}

/// Whether a character stays in its place in a line of text: no control character, separator of lines or mark that
/// changes the direction of others. Names hold no others, and programs print none.
#[must_use]
pub fn is_plain(c: char) -> bool {
    let moves = matches!(
        c,
        '\u{61c}' | '\u{200e}' | '\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}'
    );
    // What XML cannot hold either.
    let is_none = matches!(c, '\u{feff}' | '\u{fffe}' | '\u{ffff}');
    !c.is_control() && !moves && !is_none
}

/// The name of what was read from a file: the stem of the file's name, or the whole name where the stem
/// is that of something built in with other numbers. So `A.csv` with another light than illuminant A
/// is called "A.csv".
pub(crate) fn name_after_file(path: &Path, is_taken: impl Fn(&str) -> bool) -> String {
    let text = |part: Option<&OsStr>| {
        part.map(|part| part.to_string_lossy().into_owned()).unwrap_or_default()
    };
    let stem = text(path.file_stem());
    if is_taken(&stem) { text(path.file_name()) } else { stem }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_of_all_scripts_are_plain_and_what_moves_others_is_not() {
        assert!("CIE 1931 2° 照明 ضوء <b>&\"'\\ ❤\u{200d}🔥".chars().all(is_plain));
        for odd in
            "\u{0}\t\n\r\u{1b}\u{7f}\u{85}\u{9b}\u{202e}\u{2067}\u{200f}\u{2029}\u{feff}".chars()
        {
            assert!(!is_plain(odd), "{odd:?}");
            assert!(NameError::check_text(&format!("a{odd}b")).is_err());
        }
    }
}
