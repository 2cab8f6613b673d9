//! Lines of text.

use upglow_svg::{Element, escape};

use super::{INK, number};

/// Size of labels, mm: 7.1 points.
const LABEL_MM: f64 = 2.5;
/// Size of ticks and notes, mm: 6.2 points.
const NOTE_MM: f64 = 2.2;
/// Size and drop of a subscript, relative to the size of the text.
const SUBSCRIPT: [f64; 2] = [0.7, 0.22];

const HALO: [(&str, &str); 3] =
    [("paint-order", "stroke"), ("stroke", "#ffffff"), ("stroke-width", "0.7")];

/// Which part of the line is at the given point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
}

/// One line of text. `*E*` is italic, `_{00}` a subscript, `[a]` at the start a bold panel letter.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Text<'t> {
    at: [f64; 2],
    text: &'t str,
    size_mm: f64,
    anchor: Anchor,
    color: &'t str,
    bold: bool,
    upright: bool,
    halo: bool,
}

impl<'t> Text<'t> {
    /// A label whose baseline starts at a point of the page.
    pub(crate) fn label(at: [f64; 2], text: &'t str) -> Self {
        Self {
            at,
            text,
            size_mm: LABEL_MM,
            anchor: Anchor::Start,
            color: INK,
            bold: false,
            upright: false,
            halo: false,
        }
    }

    /// Smaller text, for ticks and notes.
    pub(crate) fn note(at: [f64; 2], text: &'t str) -> Self {
        Self { size_mm: NOTE_MM, ..Self::label(at, text) }
    }

    pub(crate) fn anchor(self, anchor: Anchor) -> Self {
        Self { anchor, ..self }
    }

    pub(crate) fn color(self, color: &'t str) -> Self {
        Self { color, ..self }
    }

    pub(crate) fn bold(self) -> Self {
        Self { bold: true, ..self }
    }

    /// Rotated to read from bottom to top.
    pub(crate) fn upright(self) -> Self {
        Self { upright: true, ..self }
    }

    /// With a white outline, readable on top of lines.
    pub(crate) fn halo(self) -> Self {
        Self { halo: true, ..self }
    }

    pub(crate) fn to_svg(self) -> String {
        let [x, y] = self.at.map(number);
        let line = Element::new("text");
        let placed = if self.upright {
            line.with("transform", format_args!("translate({x} {y}) rotate(-90)"))
        } else {
            line.with("x", x).with("y", y)
        };
        let anchor = match self.anchor {
            Anchor::Start => None,
            Anchor::Middle => Some("middle"),
            Anchor::End => Some("end"),
        };
        placed
            .with("font-size", number(self.size_mm))
            .with_some("text-anchor", anchor)
            .with_some("fill", (self.color != INK).then_some(self.color))
            .with_some("font-weight", self.bold.then_some("bold"))
            .with_all(HALO.into_iter().filter(|_| self.halo))
            .around(spans(self.text, self.size_mm))
    }
}

/// The text with its marks turned into elements.
fn spans(text: &str, size_mm: f64) -> String {
    let [share, depth] = SUBSCRIPT;
    let (small, drop) = (number(share * size_mm), number(depth * size_mm));
    let span = || Element::new("tspan");
    let mut svg = String::new();
    let mut rest = text;
    let mut lift: Option<String> = None;
    while let Some(c) = rest.chars().next() {
        let marked = [("*", "*"), ("_{", "}"), ("[", "]")].into_iter().find_map(|(open, close)| {
            let (inner, after) = rest.strip_prefix(open)?.split_once(close)?;
            Some((open, escape(inner), after))
        });
        let Some((mark, inner, after)) = marked else {
            let (plain, after) = rest.split_at(
                rest[c.len_utf8()..]
                    .find(['*', '_', '['])
                    .map_or(rest.len(), |end| end + c.len_utf8()),
            );
            svg += &match lift.take() {
                None => escape(plain),
                lift => span().with_some("dy", lift).around(escape(plain)),
            };
            rest = after;
            continue;
        };
        let lifted = lift.take();
        svg += &match mark {
            "*" => span().with("font-style", "italic").with_some("dy", lifted).around(inner),
            "[" => {
                let letter = format!("({inner})");
                span().with("font-weight", "bold").with_some("dy", lifted).around(letter)
            }
            _ => {
                lift = Some(format!("-{drop}"));
                span().with("font-size", &small).with("dy", &drop).around(inner)
            }
        };
        rest = after;
    }
    svg
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn marks_become_elements_and_the_baseline_is_restored() {
        assert_eq!(spans("a < b", 2.0), "a &lt; b");
        assert_eq!(
            spans("[a] Δ*E*_{00} ≤ 1", 2.0),
            "<tspan font-weight=\"bold\">(a)</tspan> Δ<tspan font-style=\"italic\">E</tspan>\
             <tspan font-size=\"1.4\" dy=\"0.44\">00</tspan><tspan dy=\"-0.44\"> ≤ 1</tspan>"
        );
    }

    #[test]
    fn a_lone_mark_is_text() {
        assert_eq!(spans("2 * 3 _ [", 2.0), "2 * 3 _ [");
    }
}
