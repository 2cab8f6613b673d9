//! Curves in text: dots in Braille patterns, two by four a character.

use super::{Curves, FIRST_NM, LAST_NM};

const COLUMNS: usize = 60;
const ROWS: usize = 12;
const DOTS_ACROSS: usize = 2 * COLUMNS;
const DOTS_DOWN: usize = 4 * ROWS;

/// Wavelengths with a label, nm.
const LABELS_NM: [u32; 5] = [300, 400, 500, 600, 700];

/// Bit of each dot of a Braille pattern, `[row][column]`.
const BITS: [[u32; 2]; 4] = [[0x01, 0x08], [0x02, 0x10], [0x04, 0x20], [0x40, 0x80]];
const EMPTY_PATTERN: u32 = 0x2800;

const REFLECTANCE: &str = "reflectance";
const EMISSION: &str = "emission";

const RESET: &str = "\u{1b}[0m";

/// One curve and how it is drawn.
struct Stroke<'c> {
    name: &'static str,
    /// Dots drawn, then dots left out, along the curve.
    dashes: (usize, usize),
    /// Select Graphic Rendition code of its color.
    ansi: &'static str,
    /// Whether the area below is dotted.
    filled: bool,
    points: Vec<(f64, f64)>,
    sample: &'c str,
}

/// Draws the curves, with axes and a legend; `colored` for a terminal.
pub(crate) fn draw(curves: &Curves, colored: bool) -> String {
    let stroke = |name, dashes, ansi, sample, curve: &[f64]| Stroke {
        name,
        dashes,
        filled: name == EMISSION,
        ansi,
        sample,
        points: if name == REFLECTANCE {
            curves.shown(curve).collect()
        } else {
            curves.lifted(curve).collect()
        },
    };
    let mut strokes = vec![stroke(REFLECTANCE, (1, 0), "\u{1b}[1m", "⠒⠒⠒", &curves.reflectance)];
    if curves.is_fluorescent() {
        strokes.push(stroke("absorption", (2, 2), "\u{1b}[34m", "⠒ ⠒", &curves.absorption));
        strokes.push(stroke(EMISSION, (1, 0), "\u{1b}[33m", "⠴⠶⠦", &curves.emission));
    }
    let mut canvas = Canvas::default();
    for (number, stroke) in strokes.iter().enumerate() {
        canvas.draw(number, stroke);
    }
    let paint = |text: &str, stroke: &Stroke<'_>| match colored {
        true => format!("{}{text}{RESET}", stroke.ansi),
        false => text.to_owned(),
    };
    let mut text = String::new();
    for row in 0..ROWS {
        let line: String = (0..COLUMNS)
            .map(|column| match canvas.owner[row][column] {
                Some(owner) => paint(&canvas.pattern(row, column).to_string(), &strokes[owner]),
                None => " ".into(),
            })
            .collect();
        text += format!("{} {line}", level_label(row)).trim_end();
        text.push('\n');
    }
    text += &axis();
    let legend = strokes.iter().map(|s| format!("{} {}", paint(s.sample, s), s.name));
    text += &format!("     {}\n", legend.collect::<Vec<_>>().join("   "));
    text
}

/// The scale at the left: 1 at the top, 0 at the bottom.
fn level_label(row: usize) -> &'static str {
    match row {
        0 => "1.0 ┤",
        5 => "0.5 ┤",
        row if row == ROWS - 1 => "0.0 ┤",
        _ => "    │",
    }
}

fn axis() -> String {
    let mut ticks = vec!['─'; COLUMNS];
    let mut labels = vec![' '; COLUMNS + 2];
    for nm in LABELS_NM {
        let column = dot_of(f64::from(nm), FIRST_NM, LAST_NM, DOTS_ACROSS) / 2;
        ticks[column] = '┬';
        for (k, digit) in nm.to_string().chars().enumerate() {
            labels[column + k] = digit;
        }
    }
    let text = |chars: Vec<char>| chars.into_iter().collect::<String>();
    let labels = text(labels);
    format!("    └{}\n    {} nm\n", text(ticks), labels.trim_end())
}

/// The number of the dot that a value falls on.
fn dot_of(value: f64, first: f64, last: f64, dots: usize) -> usize {
    let position = (value - first) / (last - first) * (dots - 1) as f64;
    (0..dots)
        .min_by(|&a, &b| (a as f64 - position).abs().total_cmp(&(b as f64 - position).abs()))
        .unwrap_or(0)
}

struct Canvas {
    dots: [[u32; COLUMNS]; ROWS],
    /// The first curve that set a dot there.
    owner: [[Option<usize>; COLUMNS]; ROWS],
}

impl Default for Canvas {
    fn default() -> Self {
        Self { dots: [[0; COLUMNS]; ROWS], owner: [[None; COLUMNS]; ROWS] }
    }
}

impl Canvas {
    /// Draws a curve as a line of dots, without gaps where it is steep.
    fn draw(&mut self, number: usize, stroke: &Stroke<'_>) {
        let (drawn, skipped) = stroke.dashes;
        let mut previous: Option<usize> = None;
        let mut length = 0;
        for x in 0..DOTS_ACROSS {
            let Some(value) = value_at(&stroke.points, x) else { continue };
            let y = dot_of(1.0 - value.clamp(0.0, 1.0), 0.0, 1.0, DOTS_DOWN);
            let from = previous.map_or(y, |p| {
                if p < y {
                    p + 1
                } else if p > y {
                    p - 1
                } else {
                    y
                }
            });
            for y in from.min(y)..=from.max(y) {
                if length % (drawn + skipped) < drawn {
                    self.set(x, y, number);
                }
                length += 1;
            }
            if stroke.filled && x % 4 == 0 {
                (y..DOTS_DOWN).filter(|y| y % 4 == 2).for_each(|y| self.set(x, y, number));
            }
            previous = Some(y);
        }
    }

    fn set(&mut self, x: usize, y: usize, number: usize) {
        let (row, column) = (y / 4, x / 2);
        self.dots[row][column] |= BITS[y % 4][x % 2];
        self.owner[row][column].get_or_insert(number);
    }

    fn pattern(&self, row: usize, column: usize) -> char {
        char::from_u32(EMPTY_PATTERN + self.dots[row][column]).unwrap_or(' ')
    }
}

/// The curve's value at the wavelength of a column of dots.
fn value_at(points: &[(f64, f64)], x: usize) -> Option<f64> {
    let nm = FIRST_NM + (LAST_NM - FIRST_NM) * x as f64 / (DOTS_ACROSS - 1) as f64;
    let above = points.partition_point(|(at, _)| *at < nm);
    let begun = above > 0 || points.first().is_some_and(|(at, _)| *at <= nm);
    points.get(above).filter(|_| begun).map(|(_, value)| *value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use upglow_color::Grid;

    fn curves(reflectance: f64, emission: f64) -> Curves {
        let wavelengths_nm: Vec<f64> = Grid::FINE.wavelengths_nm().collect();
        let flat = |value| vec![value; wavelengths_nm.len()];
        Curves {
            reflectance: flat(reflectance),
            absorption: flat(emission),
            emission: flat(emission),
            wavelengths_nm,
        }
    }

    #[test]
    fn a_white_line_is_at_the_top_and_a_black_one_at_the_bottom() {
        let filled = |value| {
            let text = draw(&curves(value, 0.0), false);
            text.lines().position(|line| line.contains('⠉') || line.contains('⣀'))
        };
        assert_eq!((filled(1.0), filled(0.0)), (Some(0), Some(ROWS - 1)));
    }

    #[test]
    fn the_picture_is_as_wide_as_its_axis_and_colored_on_demand() {
        let plain = draw(&curves(0.3, 1.0), false);
        assert!(plain.lines().all(|line| line.chars().count() <= COLUMNS + 8), "{plain}");
        assert_eq!(plain.lines().count(), ROWS + 3);
        assert!(!plain.contains('\u{1b}') && plain.contains("emission"));
        assert!(draw(&curves(0.3, 1.0), true).contains(RESET));
        assert!(!draw(&curves(0.3, 0.0), false).contains("emission"));
    }
}
