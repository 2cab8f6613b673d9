//! The HTML page of a check, in a single file.

mod figures;
mod style;
mod tables;

use upglow_fit::MaterialKind;

use self::figures::figures;
use self::style::STYLE;
use self::tables::{changes, dyes, flaws, missed, worst};
use super::cube_match::CubeMatch;
use super::report::CheckReport;
use super::text::{escaped, grouped, percent};

impl CheckReport {
    /// An HTML page about some pictures, without scripts or external resources, well-formed as XML.
    #[must_use]
    pub fn page(reports: &[Self]) -> String {
        let title = match reports {
            [one] => format!("Check of {}", escaped(&one.file)),
            many => format!("Check of {} pictures", many.len()),
        };
        let is_alone = reports.len() == 1;
        let overview = if is_alone { String::new() } else { overview(&title, reports) };
        let heading = Heading { level: if is_alone { 1 } else { 2 } };
        let articles = reports.iter().enumerate().map(|(i, r)| article(i, r, heading));
        format!(
            "<!DOCTYPE html>\n<html xmlns=\"http://www.w3.org/1999/xhtml\" lang=\"en\">\n<head>\n\
             <meta charset=\"utf-8\"/>\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n\
             <title>{title}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n<main>\n\
             {overview}{}</main>\n</body>\n</html>\n",
            articles.collect::<String>()
        )
    }
}

/// The level of a picture's heading; its sections are one below.
#[derive(Clone, Copy)]
struct Heading {
    level: u8,
}

impl Heading {
    fn picture(self, text: &str) -> String {
        format!("<h{0} class=\"picture\">{1}</h{0}>\n", self.level, escaped(text))
    }

    fn section(self, text: &str) -> String {
        format!("<h{0} class=\"section\">{1}</h{0}>\n", self.level + 1, escaped(text))
    }
}

fn overview(title: &str, reports: &[CheckReport]) -> String {
    let row = |(i, report): (usize, &CheckReport)| {
        format!(
            "<tr><td><a href=\"#picture-{i}\">{}</a></td><td class=\"wide\">{}</td><td>{}</td></tr>\n",
            escaped(&report.file),
            bar(report),
            escaped(&report.headline()),
        )
    };
    let rows: String = reports.iter().enumerate().map(row).collect();
    format!(
        "<section class=\"overview\">\n<h1>{title}</h1>\n\
         <div class=\"scroll\"><table>\n<thead><tr><th>picture</th><th>needed materials</th>\
         <th>result</th></tr></thead>\n<tbody>\n{rows}</tbody>\n</table></div>\n</section>\n"
    )
}

fn article(index: usize, report: &CheckReport, heading: Heading) -> String {
    let CheckReport { width, height, .. } = report;
    let of_cube = report.cube.as_ref().map(|cube| cube_sections(cube, heading));
    format!(
        "<article id=\"picture-{index}\">\n<header>\n{}\
         <p class=\"facts\">{width} × {height} texels · read as {} · checked in {} under {}</p>\n</header>\n\
         <p class=\"verdict\">{}</p>\n<p class=\"next\">{}</p>\n{}{}{}{}{}{}{}</article>\n",
        heading.picture(&report.file),
        escaped(&report.interpretation.to_string()),
        escaped(&report.rgb_space),
        escaped(&report.illuminant),
        escaped(&report.headline()),
        with_code(&report.advice()),
        figures(report),
        of_cube.unwrap_or_default(),
        heading.section("Which materials it needs"),
        bar(report),
        shares(report),
        flaws(report, heading),
        worst(&report.worst, heading),
    )
}

/// Text with what is between backticks as code.
fn with_code(text: &str) -> String {
    let parts = text.split('`').enumerate();
    let marked = parts.map(|(i, part)| match i % 2 {
        0 => escaped(part),
        _ => format!("<code>{}</code>", escaped(part)),
    });
    marked.collect()
}

fn cube_sections(cube: &CubeMatch, heading: Heading) -> String {
    let CubeMatch { file, texels, within_one, within_two, mean_de2000, greatest_de2000, .. } = cube;
    let item = |(kind, count): (MaterialKind, u64)| {
        let share = count as f64 / (*texels).max(1) as f64;
        format!(
            "<li><b>{}</b> {} <small>{}</small></li>\n",
            percent(share),
            kind.label(),
            grouped(count)
        )
    };
    let kinds: String = cube.kinds.each().into_iter().map(item).collect();
    format!(
        "{}<p>Of {} texels in range its blends match <b>{}</b> within 1 ΔE00 and <b>{}</b> within 2; \
         the mean is {mean_de2000:.2}, the greatest {greatest_de2000:.2}.</p>\n\
         <ul class=\"shares\">\n{kinds}</ul>\n{}{}{}",
        heading.section(&format!("What {file} makes of it")),
        grouped(*texels),
        percent(*within_one),
        percent(*within_two),
        missed(&cube.worst, heading),
        dyes(&cube.dye, heading),
        changes(cube, heading),
    )
}

/// The four kinds of texels: class of style, name, count.
fn kinds(report: &CheckReport) -> [(&'static str, &'static str, u64); 4] {
    let counts = &report.counts;
    [
        ("reflectance", "matched by a reflectance", counts.reflectance),
        ("fluorescence", "needs fluorescence", counts.needs_fluorescence),
        ("unreachable", "matched by no material", counts.unreachable),
        ("no-color", "NaN or infinite", counts.no_color),
    ]
}

fn bar(report: &CheckReport) -> String {
    let part = |(class, name, count): (&str, &str, u64)| {
        // Each kind that occurs has a visible width.
        let width = (100.0 * report.counts.share(count)).max(0.4);
        format!(
            "<span class=\"{class}\" style=\"flex-grow:{width:.3}\" title=\"{name}: {}\"></span>",
            percent(report.counts.share(count))
        )
    };
    let parts: String = kinds(report).into_iter().filter(|kind| kind.2 > 0).map(part).collect();
    format!("<div class=\"bar\" aria-hidden=\"true\">{parts}</div>\n")
}

fn shares(report: &CheckReport) -> String {
    let item = |(class, name, count): (&str, &str, u64)| {
        format!(
            "<li><span class=\"key {class}\"></span><b>{}</b> {name} <small>{}</small></li>\n",
            percent(report.counts.share(count)),
            grouped(count)
        )
    };
    let kinds = kinds(report).into_iter();
    let shown = kinds.filter(|&(class, _, count)| class != "no-color" || count > 0);
    format!("<ul class=\"shares\">\n{}</ul>\n", shown.map(item).collect::<String>())
}

fn hex([r, g, b]: [u8; 3]) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}
