//! Writes SVG as text: elements with attributes, escaped text, lists of points, colors.
//!
//! Each program decides what it draws and how it formats numbers. The same calls give the same bytes
//! on every machine.

use std::fmt::{Display, Write as _};

/// An element to which attributes are added; they keep the order of the calls.
///
/// ```
/// use upglow_svg::{Element, escape};
///
/// let note = Element::new("text").with("x", 3).with("y", 4.5).around(escape("a < b"));
/// assert_eq!(note, r#"<text x="3" y="4.5">a &lt; b</text>"#);
/// ```
#[derive(Clone, Debug)]
#[must_use]
pub struct Element {
    name: &'static str,
    start: String,
}

impl Element {
    /// An element without attributes.
    pub fn new(name: &'static str) -> Self {
        Self { name, start: format!("<{name}") }
    }

    /// Adds an attribute; the value is not escaped.
    pub fn with(mut self, attribute: &str, value: impl Display) -> Self {
        write!(self.start, " {attribute}=\"{value}\"").expect("writing to a string cannot fail");
        self
    }

    /// Adds an attribute if there is a value.
    pub fn with_some(self, attribute: &str, value: Option<impl Display>) -> Self {
        match value {
            Some(value) => self.with(attribute, value),
            None => self,
        }
    }

    /// Adds attributes, each a name and a value.
    pub fn with_all<V: Display>(
        self,
        attributes: impl IntoIterator<Item = (&'static str, V)>,
    ) -> Self {
        attributes.into_iter().fold(self, |element, (name, value)| element.with(name, value))
    }

    /// The element without content.
    #[must_use]
    pub fn empty(self) -> String {
        self.start + "/>"
    }

    /// The element around other elements or [escaped](escape) text.
    #[must_use]
    pub fn around(self, content: impl Display) -> String {
        let Self { name, start } = self;
        format!("{start}>{content}</{name}>")
    }
}

/// Escapes text for XML, without characters that XML cannot represent.
#[must_use]
pub fn escape(text: &str) -> String {
    let plain: String =
        text.chars().filter(|c| !c.is_control() && !['\u{fffe}', '\u{ffff}'].contains(c)).collect();
    plain.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

/// The points of a polyline or polygon, each coordinate formatted by `number`.
pub fn points(at: impl IntoIterator<Item = [f64; 2]>, number: impl Fn(f64) -> String) -> String {
    let point = |[x, y]: [f64; 2]| format!("{},{}", number(x), number(y));
    at.into_iter().map(point).collect::<Vec<_>>().join(" ")
}

/// The nearest integer in 0..=255.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped and rounded")]
#[must_use]
pub fn byte(value: f64) -> u8 {
    value.clamp(0.0, 255.0).round() as u8
}

/// An sRGB color as `#rrggbb`.
#[must_use]
pub fn hex([r, g, b]: [u8; 3]) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn attributes_keep_their_order_and_absent_ones_are_left_out() {
        let line = Element::new("line").with("y1", 2).with_some("fill", None::<&str>);
        assert_eq!(line.with_all([("x1", 1)]).empty(), r#"<line y1="2" x1="1"/>"#);
    }

    #[test]
    fn text_is_escaped() {
        assert_eq!(escape("<script>&\u{7}"), "&lt;script&gt;&amp;");
    }

    #[test]
    fn colors_are_rounded_and_clamped() {
        assert_eq!([-1.0, 117.6, 300.0].map(byte), [0, 118, 255]);
        assert_eq!(hex([118, 0, 255]), "#7600ff");
    }
}
