//! Panels with axes.

use super::{Anchor, Drawing, MUTED, Rect, Stroke, Text, number};

/// One axis of a panel.
#[derive(Clone, Debug)]
pub(crate) struct Axis {
    /// Name and unit.
    pub(crate) label: &'static str,
    /// Values at its ends.
    pub(crate) range: [f64; 2],
    /// Values of the ticks and their texts.
    pub(crate) ticks: Vec<(f64, String)>,
}

impl Axis {
    /// An axis with a tick at every multiple of `step`, at least 0.01, in the range.
    pub(crate) fn every(label: &'static str, range: [f64; 2], step: f64) -> Self {
        let first = (range[0] / step - 1e-9).ceil();
        let last = (range[1] / step + 1e-9).floor();
        let mut ticks = Vec::new();
        let mut multiple = first;
        while multiple <= last {
            let value = multiple * step;
            ticks.push((value, number(value).replace('-', "−")));
            multiple += 1.0;
        }
        Self { label, range, ticks }
    }

    /// The same axis without numbers and label, for a panel beside one that has them.
    pub(crate) fn silent(mut self) -> Self {
        self.label = "";
        self.ticks.iter_mut().for_each(|(_, text)| text.clear());
        self
    }

    fn share(&self, value: f64) -> f64 {
        (value - self.range[0]) / (self.range[1] - self.range[0])
    }
}

/// A panel: a rectangle of the page with axes at its left and lower edges.
#[derive(Clone, Debug)]
pub(crate) struct Frame {
    pub(crate) rect: Rect,
    pub(crate) x: Axis,
    pub(crate) y: Axis,
}

const TICK_MM: f64 = 0.9;
/// Distance from the lower edge to the baselines of numbers and label.
const X_NUMBERS_MM: f64 = 3.4;
const X_LABEL_MM: f64 = 6.6;
/// Distance from the left edge to the ends of numbers.
const Y_NUMBERS_MM: f64 = 1.5;
/// Distance from the numbers to the label, and width of a digit.
const Y_LABEL_MM: f64 = 1.6;
const DIGIT_MM: f64 = 1.22;
/// Half the height of a digit.
const HALF_DIGIT_MM: f64 = 0.78;

impl Frame {
    pub(crate) fn x_of(&self, value: f64) -> f64 {
        self.rect.left + self.x.share(value) * self.rect.width
    }

    pub(crate) fn y_of(&self, value: f64) -> f64 {
        self.rect.bottom() - self.y.share(value) * self.rect.height
    }

    pub(crate) fn point(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [self.x_of(x), self.y_of(y)]
    }

    /// Draws outline, ticks, numbers and labels; to be called after the data is drawn.
    pub(crate) fn draw_axes(&self, drawing: &mut Drawing) {
        drawing.outline(self.rect, Stroke::AXIS);
        self.draw_x_axis(drawing);
        self.draw_y_axis(drawing);
    }

    fn draw_x_axis(&self, drawing: &mut Drawing) {
        let bottom = self.rect.bottom();
        for (value, text) in &self.x.ticks {
            let x = self.x_of(*value);
            drawing.line([x, bottom], [x, bottom + TICK_MM], Stroke::AXIS);
            if !text.is_empty() {
                let note = Text::note([x, bottom + X_NUMBERS_MM], text);
                drawing.text(&note.anchor(Anchor::Middle));
            }
        }
        if !self.x.label.is_empty() {
            let at = [self.rect.center()[0], bottom + X_LABEL_MM];
            drawing.text(&Text::label(at, self.x.label).anchor(Anchor::Middle));
        }
    }

    fn draw_y_axis(&self, drawing: &mut Drawing) {
        let left = self.rect.left;
        for (value, text) in &self.y.ticks {
            let y = self.y_of(*value);
            drawing.line([left - TICK_MM, y], [left, y], Stroke::AXIS);
            if !text.is_empty() {
                let note = Text::note([left - Y_NUMBERS_MM, y + HALF_DIGIT_MM], text);
                drawing.text(&note.anchor(Anchor::End));
            }
        }
        if !self.y.label.is_empty() {
            let digits = self.y.ticks.iter().map(|(_, text)| text.chars().count()).max();
            let numbers_mm = DIGIT_MM * digits.unwrap_or(0) as f64;
            let at = [left - Y_NUMBERS_MM - numbers_mm - Y_LABEL_MM, self.rect.center()[1]];
            drawing.text(&Text::label(at, self.y.label).anchor(Anchor::Middle).upright());
        }
    }

    /// Draws a title above the panel and, if `note` is not empty, a smaller line below it.
    pub(crate) fn draw_title(&self, drawing: &mut Drawing, title: &str, note: &str) {
        let Rect { left, top, .. } = self.rect;
        let rise = if note.is_empty() { 1.6 } else { 4.8 };
        drawing.text(&Text::label([left, top - rise], title));
        if !note.is_empty() {
            drawing.text(&Text::note([left, top - 1.6], note).color(MUTED));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_include_both_ends() {
        let axis = Axis::every("x", [0.0, 0.8], 0.2);
        let texts: Vec<&str> = axis.ticks.iter().map(|(_, text)| text.as_str()).collect();
        assert_eq!(texts, ["0", "0.2", "0.4", "0.6", "0.8"]);
    }

    #[test]
    fn ends_of_a_range_map_to_the_edges() {
        let axis = |range| Axis::every("", range, 1.0);
        let rect = Rect { left: 10.0, top: 20.0, width: 30.0, height: 40.0 };
        let frame = Frame { rect, x: axis([0.0, 2.0]), y: axis([-1.0, 1.0]) };
        assert_eq!(frame.point([0.0, -1.0]), [10.0, 60.0]);
        assert_eq!(frame.point([2.0, 1.0]), [40.0, 20.0]);
    }
}
