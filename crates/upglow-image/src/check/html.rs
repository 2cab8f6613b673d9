//! The HTML page of a check, in a single file.

mod style;
mod text;

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use upglow_color::{Nearest, StandingKind};
use upglow_fit::MaterialKind;

use self::style::STYLE;
use self::text::{escaped, grouped, percent, value};
use super::cube_match::CubeMatch;
use super::palette::{Heat, ramp_position};
use super::raster::Raster;
use super::report::{CheckReport, Flaw, WorstTexel};

impl CheckReport {
    /// An HTML page about some pictures, without scripts or external resources, well-formed as XML. Each
    /// picture prints on one sheet of paper.
    #[must_use]
    pub fn page(reports: &[Self]) -> String {
        let title = match reports {
            [one] => format!("What {} needs", escaped(&one.file)),
            many => format!("What {} pictures need", many.len()),
        };
        let overview = if reports.len() > 1 { overview(reports) } else { String::new() };
        let articles: String = reports.iter().enumerate().map(|(i, r)| article(i, r)).collect();
        format!(
            "<!DOCTYPE html>\n<html xmlns=\"http://www.w3.org/1999/xhtml\" lang=\"en\">\n<head>\n\
             <meta charset=\"utf-8\"/>\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n\
             <title>{title}</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n<main>\n\
             {overview}{articles}</main>\n</body>\n</html>\n"
        )
    }
}

fn overview(reports: &[CheckReport]) -> String {
    let row = |(i, report): (usize, &CheckReport)| {
        format!(
            "<tr><td><a href=\"#picture-{i}\">{}</a></td><td class=\"wide\">{}</td><td>{}</td></tr>\n",
            escaped(&report.file),
            bar(report),
            headline(report),
        )
    };
    let rows: String = reports.iter().enumerate().map(row).collect();
    let count = reports.len();
    format!(
        "<section class=\"overview\">\n<h1>What {count} pictures need</h1>\n\
         <table>\n<tbody>\n{rows}</tbody>\n</table>\n</section>\n"
    )
}

fn article(index: usize, report: &CheckReport) -> String {
    let CheckReport { width, height, .. } = report;
    format!(
        "<article id=\"picture-{index}\">\n<header>\n<h2>{}</h2>\n\
         <p class=\"facts\">{width} × {height} texels · read as {} · checked in {} under {}</p>\n</header>\n\
         <p class=\"verdict\">{}</p>\n<p class=\"next\">{}</p>\n{}{}{}{}{}{}</article>\n",
        escaped(&report.file),
        escaped(&report.interpretation.to_string()),
        escaped(&report.rgb_space),
        escaped(&report.illuminant),
        headline(report),
        next(report),
        bar(report),
        shares(report),
        pictures(report),
        flaws(report),
        worst(&report.worst),
        report.cube.as_ref().map(cube_match).unwrap_or_default(),
    )
}

/// The result in one sentence.
fn headline(report: &CheckReport) -> String {
    let counts = &report.counts;
    let share = |part| percent(counts.share(part));
    let needs = share(counts.needs_fluorescence);
    match (counts.no_color, counts.unreachable, counts.needs_fluorescence) {
        (0, 0, 0) => "Reflectances match every texel.".into(),
        (0, 0, _) => {
            format!("{needs} of the texels need fluorescence; materials match all texels.")
        }
        (0, unreachable, 0) => format!("No material matches {} of the texels.", share(unreachable)),
        (0, unreachable, _) => {
            let beyond = share(unreachable);
            format!("{needs} of the texels need fluorescence; no material matches {beyond}.")
        }
        (1, ..) => "1 texel is NaN or infinite.".into(),
        (no_color, ..) => format!("{} texels are NaN or infinite.", grouped(no_color)),
    }
}

/// Advice in one sentence.
fn next(report: &CheckReport) -> &'static str {
    let counts = &report.counts;
    if counts.no_color > 0 {
        "Find the cause of the NaN or infinite values (the first texels are listed below), or make them black with <code>--repair</code>."
    } else if !counts.all_in_range() {
        "Baking refuses values outside 0 to 1: correct them, or use <code>--repair clip</code>, <code>scale</code> or <code>nearest</code>."
    } else if counts.unreachable > 0 {
        "Desaturate the areas that are pink to purple in the map, or let <code>--repair nearest</code> move them to the nearest color of a material."
    } else if counts.needs_fluorescence > 0 {
        "Bake it with a cube that has dyes; without dyes, the areas that are yellow to brown in the map become less saturated."
    } else {
        "Bake it with any cube: it needs no fluorescence."
    }
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
    format!("<div class=\"bar\">{parts}</div>\n")
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

fn pictures(report: &CheckReport) -> String {
    format!(
        "<div class=\"pictures\">\n<figure>{}<figcaption>The picture in sRGB</figcaption>\
         </figure>\n<figure>{}<figcaption>Needed materials; ΔE00 of the furthest texel</figcaption>{}\
         </figure>\n</div>\n",
        image(&report.thumbnail, "the picture"),
        image(&report.heat, "the heat map"),
        legend(report),
    )
}

/// Pictures narrower than this are enlarged without smoothing.
const FEW_PIXELS: u32 = 256;

fn image(raster: &Raster, name: &str) -> String {
    let data = STANDARD.encode(raster.to_png());
    let class = if raster.width < FEW_PIXELS { " class=\"texels\"" } else { "" };
    let (width, height) = (raster.width, raster.height);
    format!(
        "<img{class} width=\"{width}\" height=\"{height}\" alt=\"{name}\" \
         src=\"data:image/png;base64,{data}\"/>"
    )
}

fn legend(report: &CheckReport) -> String {
    let counts = &report.counts;
    let mut rows = ramp("beyond reflectance", Heat::Fluorescence);
    rows += &ramp("beyond any material", Heat::Unreachable);
    rows += "<div class=\"ramp plain\"><span>a reflectance</span><i class=\"gray\"></i></div>\n";
    if counts.no_color > 0 {
        rows += "<div class=\"ramp plain\"><span>NaN or infinite</span><i class=\"no-color\"></i></div>\n";
    }
    format!("<div class=\"legend\">\n{rows}</div>")
}

/// Differences that a ramp is marked at.
const TICKS: [f64; 4] = [1.0, 3.0, 10.0, 30.0];

fn ramp(name: &str, heat: fn(f64) -> Heat) -> String {
    // Enough stops to approximate a ramp that is linear in another scale.
    let stops = (0..=16).map(|i| 30.0_f64.ln_1p() * f64::from(i) / 16.0).map(f64::exp_m1);
    let stop =
        |de2000| format!(",{} {:.1}%", hex(heat(de2000).color(0.0)), 100.0 * ramp_position(de2000));
    let stops: String = stops.map(stop).collect();
    let tick = |de2000: f64| {
        format!("<b style=\"left:{:.1}%\">{de2000}</b>", 100.0 * ramp_position(de2000))
    };
    let ticks: String = TICKS.into_iter().map(tick).collect();
    format!(
        "<div class=\"ramp\"><span>{name}</span>\
         <i style=\"background:linear-gradient(to right{stops})\">{ticks}</i></div>\n"
    )
}

fn flaws(report: &CheckReport) -> String {
    if report.counts.all_in_range() {
        return "<p class=\"fine\">All values are in 0 to 1.</p>\n".into();
    }
    let row = |flaw: Flaw| {
        let places: Vec<String> = report
            .flaws
            .iter()
            .filter(|texel| texel.flaw == flaw)
            .map(|texel| {
                let [r, g, b] = texel.rgb.map(value);
                format!("<span class=\"place\">({}, {}): {r}, {g}, {b}</span>", texel.x, texel.y)
            })
            .collect();
        format!(
            "<tr><th class=\"name\">{}</th><td class=\"number\">{}</td><td>{}</td></tr>\n",
            flaw,
            grouped(report.counts.of(flaw)),
            places.join(" ")
        )
    };
    let found = Flaw::ALL.into_iter().filter(|&flaw| report.counts.of(flaw) > 0);
    format!(
        "<h3>Values out of range</h3>\n<table>\n<thead><tr><th>value</th><th class=\"number\">texels\
         </th><th>the first texels, as (column, row): red, green, blue</th></tr></thead>\n\
         <tbody>\n{}</tbody>\n</table>\n",
        found.map(row).collect::<String>()
    )
}

fn worst(texels: &[WorstTexel]) -> String {
    if texels.is_empty() {
        return String::new();
    }
    let rows: String = texels.iter().map(worst_row).collect();
    format!(
        "<h3>The worst texels</h3>\n<table>\n<thead><tr><th>column, row</th><th>red, green, blue</th>\
         <th>color</th><th>nearest reflectance</th><th>nearest of any material</th></tr></thead>\n\
         <tbody>\n{rows}</tbody>\n</table>\n\
         <p class=\"note\">Swatches are clipped to sRGB, so different colors may look alike. \
         The number beside a swatch is its ΔE00 from the texel's color.</p>\n"
    )
}

fn worst_row(texel: &WorstTexel) -> String {
    let [r, g, b] = texel.rgb.map(value);
    let [own, reflectance, any] = texel.swatches.map(hex);
    let swatch =
        |color: &str| format!("<span class=\"swatch\" style=\"background:{color}\"></span>");
    let beside = |nearest: &Nearest| match nearest.distance {
        0.0 => "matched".into(),
        _ => format!("{:.2}", nearest.de2000),
    };
    let class = match texel.standing.kind {
        StandingKind::Unreachable => "unreachable",
        _ => "fluorescence",
    };
    format!(
        "<tr><td><span class=\"key {class}\"></span>{}, {}</td><td>{r}, {g}, {b}</td><td>{}</td>\
         <td>{}{}</td><td>{}{}</td></tr>\n",
        texel.x,
        texel.y,
        swatch(&own),
        swatch(&reflectance),
        beside(&texel.standing.reflectance),
        swatch(&any),
        beside(&texel.standing.fluorescence),
    )
}

fn cube_match(found: &CubeMatch) -> String {
    let CubeMatch { file, texels, within_one, within_two, mean_de2000, greatest_de2000, kinds } =
        found;
    let item = |(kind, count): (MaterialKind, u64)| {
        let share = count as f64 / (*texels).max(1) as f64;
        format!(
            "<li><b>{}</b> {} <small>{}</small></li>\n",
            percent(share),
            kind.label(),
            grouped(count)
        )
    };
    let kinds: String = kinds.each().into_iter().map(item).collect();
    format!(
        "<h3>Match with {}</h3>\n<p>Of {} texels in range its blends match <b>{}</b> within 1 ΔE00 \
         and <b>{}</b> within 2; the mean is {mean_de2000:.2}, the greatest \
         {greatest_de2000:.2}.</p>\n<ul class=\"shares\">\n{kinds}</ul>\n",
        escaped(file),
        grouped(*texels),
        percent(*within_one),
        percent(*within_two),
    )
}

fn hex([r, g, b]: [u8; 3]) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}
