//! `cargo xtask bench`: runs the benches and writes their medians into docs/PERFORMANCE.md.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::Stdio;
use std::time::{SystemTime, UNIX_EPOCH};

use crate::step::{StepError, cargo, output_of};

/// Lines of the table: what is measured, by which bench, the goal, and the time of other programs.
const GOALS: &str = include_str!("../goals.csv");

/// A bench and its median, as printed; per item where the bench counts items.
#[derive(Clone, Debug, PartialEq)]
struct Measured {
    bench: String,
    median: String,
}

/// Runs every bench, prints the table and writes it.
pub(crate) fn run(root: &Path) -> Result<(), StepError> {
    let mut command = cargo(root, "bench --quiet --workspace --benches");
    command.stderr(Stdio::inherit());
    let page = page(&parse(&output_of(command)?), &machine(), &today());
    println!("{page}");
    let path = root.join("docs/PERFORMANCE.md");
    fs::write(&path, page).map_err(StepError::file(&path))
}

/// Every leaf of divan's trees: `file/function/argument` and its median.
fn parse(text: &str) -> Vec<Measured> {
    let mut path: Vec<String> = Vec::new();
    let mut found = Vec::new();
    for line in text.lines() {
        let is_tree = |c: char| "│├╰─ ".contains(c);
        let depth = line.chars().take_while(|&c| is_tree(c)).count() / 3;
        let rest: String = line.chars().skip_while(|&c| is_tree(c)).collect();
        let cells: Vec<&str> = rest.split('│').map(str::trim).collect();
        if cells.len() < 6 {
            continue;
        }
        if let (true, Some(last)) = (cells[2].ends_with("item/s"), found.last_mut()) {
            set_time_per_item(last, cells[2]);
            continue;
        }
        let (name, fastest) = cells[0].split_once("  ").unwrap_or((cells[0], ""));
        path.truncate(depth);
        path.push(name.trim().to_owned());
        let has_figures = depth > 0 && !fastest.trim().is_empty();
        if has_figures {
            found.push(Measured { bench: path.join("/"), median: cells[2].to_owned() });
        }
    }
    found
}

/// Replaces the time of many items by that of one, from so many items a second.
fn set_time_per_item(measured: &mut Measured, rate: &str) {
    let Some((number, unit)) = rate.split_once(' ') else { return };
    let scale = match unit {
        "item/s" => 1.0,
        "Kitem/s" => 1e3,
        "Mitem/s" => 1e6,
        "Gitem/s" => 1e9,
        _ => return,
    };
    if let Ok(number) = number.parse::<f64>() {
        measured.median = format!("{:.1} ns", 1e9 / (number * scale));
    }
}

fn page(measured: &[Measured], machine: &str, today: &str) -> String {
    let mut page = format!(
        "# Performance\n\nMedians from `cargo xtask bench`, which writes this page. Machine: \
         {machine}. Date: {today}.\n\n| job | measured | goal | peer |\n| --- | --- | --- | --- |\n"
    );
    for [job, bench, goal, peer] in goals() {
        let median = measured.iter().find(|m| m.bench == bench);
        let median = median.map_or("not measured", |m| &m.median);
        writeln!(page, "| {job} | {median} | {goal} | {peer} |").expect("a string takes any text");
    }
    page.push_str(
        "\nWhat limits them: [where-the-time-goes.md](where-the-time-goes.md).\n\nEvery bench:\n\n| bench | median |\n| --- | --- |\n",
    );
    for Measured { bench, median } in measured {
        writeln!(page, "| `{bench}` | {median} |").expect("a string takes any text");
    }
    page
}

/// Job, bench, goal and peer of each line.
fn goals() -> Vec<[String; 4]> {
    let mut reader = csv::ReaderBuilder::new().comment(Some(b'#')).from_reader(GOALS.as_bytes());
    let lines = reader.deserialize().collect::<Result<_, _>>();
    lines.expect("a test reads the same lines")
}

fn machine() -> String {
    let info = fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let model = info.lines().find(|line| line.starts_with("model name"));
    let model = model.and_then(|line| line.split(": ").nth(1)).unwrap_or("unknown processor");
    let threads = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    format!("{model}, {threads} threads")
}

/// The date in UTC, year-month-day.
fn today() -> String {
    let seconds = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |d| d.as_secs());
    let [year, month, day] = civil_date(seconds / 86_400);
    format!("{year}-{month:02}-{day:02}")
}

/// Year, month and day of a number of days since 1970-01-01.
fn civil_date(mut days: u64) -> [u64; 3] {
    let mut year = 1970;
    let is_leap =
        |year: u64| year.is_multiple_of(4) && !year.is_multiple_of(100) || year.is_multiple_of(400);
    while days >= 365 + u64::from(is_leap(year)) {
        days -= 365 + u64::from(is_leap(year));
        year += 1;
    }
    let february = 28 + u64::from(is_leap(year));
    let mut month = 1;
    for length in [31, february, 31, 30, 31, 30, 31, 31, 30, 31, 30] {
        if days < length {
            break;
        }
        days -= length;
        month += 1;
    }
    [year, month, days + 1]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians_are_found_in_a_tree_of_benches() {
        let text = "Timer precision: 10 ns\n\
            build          fastest │ slowest │ median │ mean │ samples │ iters\n\
            ├─ default             │         │        │      │         │\n\
            │  ├─ 32       1.1 s   │ 1.3 s   │ 1.2 s  │ 1 s  │ 3       │ 3\n\
            │  ╰─ 64       9 s     │ 9 s     │ 9.5 s  │ 9 s  │ 3       │ 3\n\
            ╰─ wide14      2 s     │ 2 s     │ 2.5 s  │ 2 s  │ 3       │ 3\n";
        let found = parse(text);
        let expected = [
            ("build/default/32", "1.2 s"),
            ("build/default/64", "9.5 s"),
            ("build/wide14", "2.5 s"),
        ];
        let expected = expected.map(|(b, m)| Measured { bench: b.into(), median: m.into() });
        assert_eq!(found, expected);
    }

    #[test]
    fn a_rate_becomes_the_time_of_one_item() {
        let mut counted = Measured { bench: "lookup".into(), median: "40 µs".into() };
        set_time_per_item(&mut counted, "25 Mitem/s");
        assert_eq!(counted.median, "40.0 ns");
    }

    #[test]
    fn every_goal_names_its_bench() {
        assert!(goals().iter().all(|[job, bench, ..]| !job.is_empty() && bench.contains('/')));
    }

    #[test]
    fn dates_are_those_of_the_calendar() {
        assert_eq!(civil_date(0), [1970, 1, 1]);
        assert_eq!(civil_date(19_782), [2024, 2, 29]);
        assert_eq!(civil_date(20_779), [2026, 11, 22]);
    }
}
