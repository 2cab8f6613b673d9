//! Building blocks of text reports: lines of names and values, and tables.

use std::fmt::{self, Display};
use std::io::Write as _;

use upglow::Cube;
use upglow_color::MissingUltraviolet;
use upglow_fit::{CubeSummary, KindCounts, MaterialKind};
use upglow_terminal::{say, size};

/// Prints a warning on standard error.
pub(crate) fn warn(message: impl Display) {
    say(&format!("upglow: warning: {message}"));
}

/// Prints each warning about ultraviolet that a light lacks, and returns it for the report.
pub(crate) fn warn_of_ultraviolet(missing: Option<MissingUltraviolet>) -> Option<String> {
    let text = missing?.to_string();
    warn(&text);
    Some(text)
}

/// The same for a cube and the light that its colors are under.
pub(crate) fn warn_of_own_light(cube: &Cube) -> Option<String> {
    warn_of_ultraviolet(cube.model().missing_ultraviolet(&cube.contract().illuminant))
}

/// Prints on standard error what is wrong with one picture of several.
pub(crate) fn failed(line: &str) {
    say(&format!("upglow: {line}"));
}

/// Lines of names and values, with the values aligned.
#[derive(Clone, Debug, Default)]
pub(crate) struct Lines {
    rows: Vec<(String, String)>,
}

impl Lines {
    /// Adds a line. An empty name continues the line before.
    pub(crate) fn add(&mut self, name: impl Display, value: impl Display) -> &mut Self {
        let name = name.to_string();
        let name = if name.is_empty() { name } else { name + ":" };
        self.rows.push((name, value.to_string()));
        self
    }

    /// Adds a line with a file and its size.
    pub(crate) fn add_file(&mut self, name: &str, file: &str, bytes: u64) -> &mut Self {
        self.add(name, format_args!("{file}, {}", size(bytes)))
    }

    /// Adds a line per number of a summary.
    pub(crate) fn add_summary(&mut self, summary: &CubeSummary) -> &mut Self {
        let share = |count| share(count, summary.nodes as u64);
        self.add("nodes", summary.nodes);
        self.add_kinds(&summary.kinds);
        self.add("within 1", format_args!("{}  ΔE00 ≤ 1", share(summary.within_1 as u64)))
            .add("within 2", format_args!("{}  ΔE00 ≤ 2", share(summary.within_2 as u64)))
            .add("mean ΔE00", format_args!("{:.3}", summary.mean_de2000))
            .add("p95 ΔE00", format_args!("{:.3}", summary.p95_de2000))
            .add("max ΔE00", format_args!("{:.3}", summary.max_de2000))
    }

    /// Adds a line per kind of material.
    pub(crate) fn add_kinds(&mut self, kinds: &KindCounts) -> &mut Self {
        let all = kinds.each().iter().map(|(_, count)| count).sum();
        for (kind, count) in kinds.each() {
            let remark = match kind {
                MaterialKind::Missed => format!("  ΔE00 > {}", CubeSummary::EXACT_DE2000),
                _ => String::new(),
            };
            self.add(kind.label(), share(count, all) + &remark);
        }
        self
    }
}

/// A count and its share of all, which is at least as great; aligned for the same `all`.
fn share(count: u64, all: u64) -> String {
    let width = all.to_string().len();
    let percent = 100.0 * count as f64 / all.max(1) as f64;
    format!("{count:width$}  {percent:6.2} %")
}

impl Display for Lines {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let width = self.rows.iter().map(|(name, _)| name.chars().count()).max().unwrap_or(0);
        for (name, value) in &self.rows {
            writeln!(f, "{}", format!("{name:width$}  {value}").trim_end())?;
        }
        Ok(())
    }
}

/// The alignment of a column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Side {
    Left,
    Right,
}

/// A table with a header.
#[derive(Clone, Debug)]
pub(crate) struct Table<const N: usize> {
    sides: [Side; N],
    rows: Vec<[String; N]>,
}

impl<const N: usize> Table<N> {
    pub(crate) fn new(columns: [(&str, Side); N]) -> Self {
        let sides = columns.map(|(_, side)| side);
        Self { sides, rows: vec![columns.map(|(head, _)| head.to_owned())] }
    }

    /// Whether there is no row below the header.
    pub(crate) fn is_empty(&self) -> bool {
        self.rows.len() == 1
    }

    pub(crate) fn add(&mut self, row: [String; N]) {
        self.rows.push(row);
    }
}

impl<const N: usize> Display for Table<N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let width = |column: usize| {
            self.rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0)
        };
        let widths: [usize; N] = std::array::from_fn(width);
        for row in &self.rows {
            let cells = (0..N).map(|column| {
                let (cell, width) = (&row[column], widths[column]);
                match self.sides[column] {
                    Side::Left => format!("{cell:width$}"),
                    Side::Right => format!("{cell:>width$}"),
                }
            });
            writeln!(f, "{}", cells.collect::<Vec<_>>().join("  ").trim_end())?;
        }
        Ok(())
    }
}

/// Three numbers with four decimals, aligned.
pub(crate) fn triple(values: [f64; 3]) -> String {
    values.map(|v| decimal(v, 7, 4)).join("  ")
}

/// A number with some decimals, as wide as given.
pub(crate) fn decimal(value: f64, width: usize, decimals: usize) -> String {
    let text = format!("{value:width$.decimals$}");
    // No sign before zero.
    if text.contains(|c: char| ('1'..='9').contains(&c)) {
        text
    } else {
        format!("{:width$.decimals$}", 0.0)
    }
}

/// A cell of a CSV file: text, in double quotes if it contains a separator, and behind `'` if spreadsheets would
/// calculate it as a formula.
pub(crate) fn quoted(text: &str) -> String {
    let text = match text.starts_with(['=', '+', '-', '@']) {
        true => format!("'{text}"),
        false => text.to_owned(),
    };
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text
    }
}

/// Adds a comma and a cell of a CSV file: a number with as many digits as are needed to read it back exactly and
/// without an exponent, nothing for NaN. `Display` takes more than twice as long for the same digits, but for the
/// last one of a few fractions of powers of 2, halfway between two that would do.
pub(crate) fn push_cell(text: &mut Vec<u8>, value: f64) {
    text.push(b',');
    let start = text.len();
    // Writing to memory cannot fail.
    let _ = serde_json::to_writer(&mut *text, &value);
    let written = &text[start..];
    if written.ends_with(b".0") {
        text.truncate(text.len() - 2);
    } else if written.contains(&b'e') || !value.is_finite() {
        text.truncate(start);
        let _ = if value.is_nan() { Ok(()) } else { write!(text, "{value}") };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_are_aligned() {
        let mut lines = Lines::default();
        lines.add("model", "dyes").add("RGB space", "acescg").add("", "more");
        assert_eq!(lines.to_string(), "model:      dyes\nRGB space:  acescg\n            more\n");
    }

    #[test]
    fn columns_are_aligned_left_or_right() {
        let mut table = Table::new([("light", Side::Left), ("X", Side::Right)]);
        table.add(["D65".into(), "0.95".into()]);
        assert_eq!(table.to_string(), "light     X\nD65    0.95\n");
    }

    #[test]
    fn zero_has_no_sign() {
        assert_eq!(triple([-1e-9, 0.5, -0.25]), " 0.0000   0.5000  -0.2500");
    }

    #[test]
    fn cells_are_as_short_as_display_and_are_read_back_exactly() {
        let cell = |value: f64| {
            let mut text = Vec::new();
            push_cell(&mut text, value);
            let text = String::from_utf8(text).unwrap();
            text.strip_prefix(',').unwrap().to_owned()
        };
        let ends = [0.0, -0.0, 1.0, -2.0, 0.1, 1e-5, 1e-7, -1.7e-17, 1e16, 1e300, 5e-324];
        // All digits, over all sizes that colors have.
        let sizes = (-60..20).map(|power| 2.0_f64.powi(power));
        let many = sizes.flat_map(|size| (1..500).map(move |i| f64::from(i) / 6.0 * size));
        for value in ends.into_iter().chain(many).chain([f64::INFINITY]) {
            let (found, expected) = (cell(value), value.to_string());
            assert_eq!(found.len(), expected.len(), "{found} {expected}");
            assert_eq!(found.parse::<f64>().unwrap().to_bits(), value.to_bits(), "{found}");
        }
        assert_eq!([cell(f64::NAN), cell(1e-7), cell(3.0)], ["", "0.0000001", "3"]);
    }

    #[test]
    fn text_with_a_separator_is_quoted() {
        assert_eq!(quoted("a,\"b\""), "\"a,\"\"b\"\"\"");
        assert_eq!(quoted("ATTO_390"), "ATTO_390");
        assert_eq!(quoted("=HYPERLINK(\"x\",1)"), "\"'=HYPERLINK(\"\"x\"\",1)\"");
    }
}
