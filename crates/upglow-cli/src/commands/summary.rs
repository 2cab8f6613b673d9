//! How well a cube's nodes match their colors, printed.

use serde::Serialize;
use upglow::Cube;
use upglow_fit::CubeSummary;

use crate::output::Lines;

/// [`CubeSummary`] as it is printed.
#[derive(Clone, Copy, Debug, Serialize)]
pub(crate) struct SummaryReport {
    nodes: usize,
    exact: usize,
    within_1: usize,
    within_2: usize,
    mean_de2000: f64,
    p95_de2000: f64,
    max_de2000: f64,
    fluorescent: usize,
}

impl SummaryReport {
    pub(crate) fn of(cube: &Cube) -> Self {
        let CubeSummary {
            nodes,
            exact,
            within_1,
            within_2,
            mean_de2000,
            p95_de2000,
            max_de2000,
            fluorescent,
        } = CubeSummary::of(cube);
        Self { nodes, exact, within_1, within_2, mean_de2000, p95_de2000, max_de2000, fluorescent }
    }

    /// Adds a line for each number.
    pub(crate) fn add_to(&self, lines: &mut Lines) {
        let width = self.nodes.to_string().len();
        let share = |count: usize| {
            let percent = 100.0 * count as f64 / self.nodes.max(1) as f64;
            format!("{count:width$}  {percent:6.2} %")
        };
        let exact = format!("{}  ΔE00 ≤ {}", share(self.exact), CubeSummary::EXACT_DE2000);
        lines
            .add("nodes", self.nodes)
            .add("exact", exact)
            .add("within 1", format_args!("{}  ΔE00 ≤ 1", share(self.within_1)))
            .add("within 2", format_args!("{}  ΔE00 ≤ 2", share(self.within_2)))
            .add("fluorescent", share(self.fluorescent))
            .add("mean ΔE00", format_args!("{:.3}", self.mean_de2000))
            .add("p95 ΔE00", format_args!("{:.3}", self.p95_de2000))
            .add("max ΔE00", format_args!("{:.3}", self.max_de2000));
    }
}
