//! Lists of colors in CSV files.

use std::path::Path;

use upglow_color::{LinearRgb, NameError};
use upglow_terminal::Failure;

use crate::{files, plan};

/// A color with a name, which may be empty.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub(crate) struct NamedColor {
    pub(crate) name: String,
    pub(crate) rgb: LinearRgb,
}

impl NamedColor {
    /// Its numbers, with up to four decimals.
    pub(crate) fn numbers(&self) -> String {
        let rounded = self.rgb.0.map(|v| ((v * 1e4).round() / 1e4).to_string());
        format!("({})", rounded.join(", "))
    }

    /// Its name, or else its numbers.
    pub(crate) fn label(&self) -> String {
        if self.name.is_empty() { self.numbers() } else { self.name.clone() }
    }
}

const HEADERS: [&str; 2] = ["r,g,b", "name,r,g,b"];

/// Longer names are a mistake.
const MOST_NAME_LETTERS: usize = 100;

/// Reads the colors of a file, each in the range of a look-up or of a direct fit.
pub(crate) fn read(path: &Path, direct: bool) -> Result<Vec<NamedColor>, Failure> {
    let expected = format!("a CSV file with the header {}", HEADERS.join(" or "));
    let text = files::read_text(path, &expected)?;
    parsed(&text, direct).map_err(|fault| Failure::file(path, fault))
}

/// Lines that start with `#` are comments, as in files of curves.
fn parsed(text: &str, direct: bool) -> Result<Vec<NamedColor>, String> {
    let text = text.trim_start_matches('\u{feff}');
    let mut lines = (1..).zip(text.lines()).filter(|(_, l)| !l.starts_with('#') && !l.is_empty());
    let header = lines.next().map_or("", |(_, l)| l).trim();
    if !HEADERS.contains(&header) {
        let found: String = header.chars().take(80).collect();
        let [plain, named] = HEADERS;
        return Err(format!("header {found:?}, expected {plain:?} or {named:?}"));
    }
    let expected = header.split(',').count();
    let color = |(line, text): (usize, &str)| {
        let cells: Vec<&str> = text.split(',').map(str::trim).collect();
        let (name, [red, green, blue]) = match cells[..] {
            [red, green, blue] if expected == 3 => ("", [red, green, blue]),
            [name, red, green, blue] if expected == 4 => (name, [red, green, blue]),
            _ => return Err(format!("line {line}: {} cells, expected {expected}", cells.len())),
        };
        let letters = name.chars().count();
        if letters > MOST_NAME_LETTERS {
            return Err(format!(
                "line {line}: a name of {letters} letters, expected at most {MOST_NAME_LETTERS}"
            ));
        }
        NameError::check_text(name).map_err(|error| format!("line {line}: {error}"))?;
        let component = |channel, text| {
            plan::component(text, direct)
                .map_err(|fault| format!("line {line}: {channel}: {fault}"))
        };
        let rgb = [component("r", red)?, component("g", green)?, component("b", blue)?];
        Ok(NamedColor { name: name.to_owned(), rgb: LinearRgb(rgb) })
    };
    let colors = lines.map(color).collect::<Result<Vec<_>, _>>()?;
    if colors.is_empty() { Err("no colors, expected a line for each".into()) } else { Ok(colors) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colors_with_and_without_names_are_read() {
        let named = parsed("# mine\nname,r,g,b\nvest, 0.9,1,0\n\n,0,0,0.5\n", false).unwrap();
        let vest = NamedColor { name: "vest".into(), rgb: LinearRgb([0.9, 1.0, 0.0]) };
        let blue = NamedColor { name: String::new(), rgb: LinearRgb([0.0, 0.0, 0.5]) };
        assert_eq!(named, [vest, blue.clone()]);
        assert_eq!(
            parsed("\u{feff}# mine\nr,g,b\n0,0,0.5\n", false).unwrap(),
            std::slice::from_ref(&blue)
        );
        assert_eq!(parsed("\u{feff}r,g,b\r\n0,0,0.5\r\n", false).unwrap(), [blue]);
        assert_eq!(parsed("r,g,b\n2,0,0\n", true).unwrap()[0].rgb, LinearRgb([2.0, 0.0, 0.0]));
    }

    #[test]
    fn a_name_is_one_line_of_text() {
        for c in ['\u{1b}', '\u{7}', '\u{0}', '\u{9b}', '\u{202e}', '\u{2028}'] {
            let line = parsed(&format!("name,r,g,b\nx{c}y,0,0,0\n"), false).unwrap_err();
            assert!(line.starts_with("line 2: ") && line.contains(", expected "), "{line:?}");
        }
    }

    #[test]
    fn faults_name_the_line() {
        let long = format!("name,r,g,b\n{},0,0,0", "x".repeat(101));
        for (text, fault) in [
            ("", "header \"\", expected \"r,g,b\" or \"name,r,g,b\""),
            ("R,G,B\n", "header \"R,G,B\", expected \"r,g,b\" or \"name,r,g,b\""),
            ("r,g,b\n", "no colors, expected a line for each"),
            ("r,g,b\n\n0,0\n", "line 3: 2 cells, expected 3"),
            ("name,r,g,b\n0,0,0\n", "line 2: 3 cells, expected 4"),
            ("r,g,b\n0,0,0\n0,x,0\n", "line 3: g: \"x\", expected a number from 0 to 1"),
            ("r,g,b\n0,0,NaN\n", "line 2: b: NaN, expected 0 to 1"),
            (
                "r,g,b\n2,0,0\n",
                "line 2: r: 2 is beyond the cube, expected 0 to 1, or --direct, which fits colors up to 10",
            ),
            (&long, "line 2: a name of 101 letters, expected at most 100"),
        ] {
            assert_eq!(parsed(text, false), Err(fault.into()));
        }
    }
}
