//! Numbers of the command line.

use std::fmt::Display;
use std::str::FromStr;

/// A whole number, or `expected` in the message.
///
/// # Errors
///
/// What was found and expected, in one line.
pub fn whole<T: FromStr>(text: &str, expected: &str) -> Result<T, String> {
    text.parse().map_err(|_| format!("{text:?}, expected {expected}"))
}

/// A whole number of at least the first bound and at most the second.
///
/// # Errors
///
/// What was found and expected, in one line.
pub fn in_range<T>([least, most]: [usize; 2], text: &str) -> Result<T, String>
where
    T: Copy + Display + FromStr + Into<usize>,
{
    let expected = format!("a whole number from {least} to {most}");
    let found: T = whole(text, &expected)?;
    if (least..=most).contains(&found.into()) {
        Ok(found)
    } else {
        Err(format!("{found}, expected {expected}"))
    }
}
