//! The tables of the page.

use upglow_color::{Nearest, StandingKind};

use super::{Heading, hex, with_code};
use crate::check::alternatives::{Change, MissedTexel};
use crate::check::cube_match::{ColorDifference, CubeMatch};
use crate::check::dye_use::{DyeUse, UsedDye};
use crate::check::report::{CheckReport, Flaw, WorstTexel};
use crate::check::text::{escaped, grouped, percent, signed, value};

/// A table that scrolls where it is wider than the page. Names of columns that begin with `#` are aligned
/// right.
fn table(columns: &[&str], rows: &str) -> String {
    let head = |name: &&str| match name.strip_prefix('#') {
        Some(name) => format!("<th class=\"number\">{name}</th>"),
        None => format!("<th>{name}</th>"),
    };
    let heads: String = columns.iter().map(head).collect();
    format!(
        "<div class=\"scroll\"><table>\n<thead><tr>{heads}</tr></thead>\n<tbody>\n{rows}</tbody>\n\
         </table></div>\n"
    )
}

/// Said once below each table that has swatches.
const SWATCHES: &str = "The nearest colors are so in XYZ; another may be nearer in ΔE00. Where a color of a row is outside sRGB, its swatches are grayer and darker by the \
    same factor, so that they differ as the colors do. ΔL*, ΔC*, ΔH*: lighter, more colorful and further \
    from red to yellow are positive.";

fn swatch(color: [u8; 3]) -> String {
    format!("<span class=\"swatch\" style=\"background:{}\"></span>", hex(color))
}

fn deltas(difference: &ColorDifference) -> String {
    let ColorDifference { lightness, chroma, hue } = difference;
    let cell = |v: f64| format!("<td class=\"number\">{}</td>", signed(v));
    [*lightness, *chroma, *hue].map(cell).concat()
}

pub(super) fn flaws(report: &CheckReport, heading: Heading) -> String {
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
            "<tr><th class=\"name\" scope=\"row\">{}</th><td class=\"number\">{}</td><td>{}</td></tr>\n",
            flaw,
            grouped(report.counts.of(flaw)),
            places.join(" ")
        )
    };
    let found = Flaw::ALL.into_iter().filter(|&flaw| report.counts.of(flaw) > 0);
    let columns = ["value", "#texels", "the first texels, as (column, row): red, green, blue"];
    heading.section("Values out of range") + &table(&columns, &found.map(row).collect::<String>())
}

pub(super) fn worst(texels: &[WorstTexel], heading: Heading) -> String {
    if texels.is_empty() {
        return String::new();
    }
    let rows: String = texels.iter().map(worst_row).collect();
    let columns = [
        "column, row",
        "red, green, blue",
        "color",
        "nearest reflectance",
        "nearest of any material",
        "#ΔL*",
        "#ΔC*",
        "#ΔH*",
    ];
    format!(
        "{}{}<p class=\"note\">The number beside a swatch is its ΔE00 from the texel&#39;s color. The \
         last columns lead to the nearest of any material, or to the nearest reflectance if some material \
         matches. {SWATCHES}</p>\n",
        heading.section("The texels furthest beyond"),
        table(&columns, &rows),
    )
}

fn worst_row(texel: &WorstTexel) -> String {
    let [r, g, b] = texel.rgb.map(value);
    let [own, reflectance, any] = texel.swatches.map(swatch);
    let beside = |nearest: &Nearest| match nearest.distance {
        0.0 => "matched".into(),
        _ => format!("{:.2}", nearest.de2000),
    };
    let class = match texel.standing.kind {
        StandingKind::Unreachable => "unreachable",
        _ => "fluorescence",
    };
    format!(
        "<tr><td class=\"name\"><span class=\"key {class}\"></span>{}, {}</td><td class=\"name\">{r}, {g}, {b}</td>\
         <td>{own}</td><td class=\"name\">{reflectance}{}</td><td class=\"name\">{any}{}</td>{}</tr>\n",
        texel.x,
        texel.y,
        beside(&texel.standing.reflectance),
        beside(&texel.standing.fluorescence),
        deltas(&texel.difference),
    )
}

/// The texels that a cube misses.
pub(super) fn missed(texels: &[MissedTexel], heading: Heading) -> String {
    if texels.is_empty() {
        return "<p class=\"fine\">No blend is more than 0.01 ΔE00 off.</p>\n".into();
    }
    let rows: String = texels.iter().map(missed_row).collect();
    let columns = [
        "column, row",
        "red, green, blue",
        "#ΔE00",
        "color",
        "the cube&#39;s",
        "nearest of any material",
        "#ΔL*",
        "#ΔC*",
        "#ΔH*",
        "#baked",
        "why",
    ];
    format!(
        "{}{}<p class=\"note\">No two are alike. <i>Baked</i> is the ΔE00 of the single material that \
         <code>upglow bake</code> stores. {SWATCHES}</p>\n",
        heading.section("The texels furthest off"),
        table(&columns, &rows),
    )
}

fn missed_row(texel: &MissedTexel) -> String {
    let [r, g, b] = texel.rgb.map(value);
    let [own, made, any] = texel.swatches.map(swatch);
    let nearest = match texel.material_de2000 {
        0.0 => "matched".into(),
        de2000 => format!("{de2000:.2}"),
    };
    let baked = texel.polished_de2000.map_or_else(String::new, |de2000| format!("{de2000:.2}"));
    format!(
        "<tr><td class=\"name\">{}, {}</td><td class=\"name\">{r}, {g}, {b}</td><td class=\"number\"><b>{:.2}</b></td>\
         <td>{own}</td><td>{made}</td><td class=\"name\">{any}{nearest}</td>{}\
         <td class=\"number\">{baked}</td><td class=\"why\">{}</td></tr>\n",
        texel.x,
        texel.y,
        texel.de2000,
        deltas(&texel.difference),
        escaped(&texel.cause.to_string()),
    )
}

pub(super) fn dyes(dye: &DyeUse, heading: Heading) -> String {
    if dye.share == 0.0 {
        return "<p class=\"fine\">No blend has dye.</p>\n".into();
    }
    let summary = format!(
        "{}<p><b>{}</b> of the texels in range have dye; their mean {unit} is {:.3}, the greatest \
         {:.3}.</p>\n",
        heading.section("Where it has dye"),
        percent(dye.share),
        dye.mean_dose,
        dye.greatest_dose,
        unit = dye.unit,
    );
    if dye.dyes.is_empty() {
        return summary;
    }
    let row = |dye: &UsedDye| {
        format!(
            "<tr><th class=\"name\" scope=\"row\">{}</th><td class=\"number\">{}</td>\
             <td class=\"number\">{:.3}</td><td class=\"number\">{:.3}</td></tr>\n",
            escaped(&dye.name),
            percent(dye.share),
            dye.mean,
            dye.greatest
        )
    };
    let rows: String = dye.dyes.iter().map(row).collect();
    let columns = ["dye", "#texels", &format!("#mean {} there", dye.unit), "#greatest"];
    summary + &table(&columns, &rows)
}

/// What other cubes would do.
pub(super) fn changes(cube: &CubeMatch, heading: Heading) -> String {
    let fitted = cube.changes.iter().map(|change| change.fitted).max().unwrap_or(0);
    if fitted == 0 {
        return String::new();
    }
    let row = |change: &Change| {
        let about = if change.fitted == 0 { "" } else { "about " };
        let options = match change.options.as_str() {
            "" => String::new(),
            options => with_code(&format!("`{options}`")),
        };
        format!(
            "<tr><th class=\"name\" scope=\"row\">{}</th><td class=\"number\">{about}{}</td>\
             <td class=\"number\">{about}{}</td><td class=\"name\">{options}</td></tr>\n",
            escaped(&change.name),
            percent(change.within_one),
            percent(change.with_dye),
        )
    };
    let rows: String = cube.changes.iter().map(row).collect();
    let columns = ["cube", "#within 1 ΔE00", "#with dye", "options of upglow build"];
    format!(
        "{}{}<p class=\"note\">Estimated from {fitted} texels of this picture, fitted one by one.</p>\n",
        heading.section("What would change it"),
        table(&columns, &rows),
    )
}
