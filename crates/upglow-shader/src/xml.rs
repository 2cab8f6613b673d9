//! Texts and names in XML.

/// Text between double quotes, or between elements.
pub(crate) fn escaped(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped += "&amp;",
            '<' => escaped += "&lt;",
            '>' => escaped += "&gt;",
            '"' => escaped += "&quot;",
            _ => escaped.push(c),
        }
    }
    escaped
}

/// Whether XML cannot hold a character, or would read another in its place.
pub(crate) fn is_forbidden(c: char) -> bool {
    c.is_control() || ['\u{fffe}', '\u{ffff}'].contains(&c)
}

/// The text with `_` in place of what names may not hold.
pub(crate) fn plain(text: &str) -> String {
    text.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect()
}
