//! The pictures of the page, with legends and texts for those who do not see them.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use super::hex;
use crate::check::cube_match::CubeMatch;
use crate::check::palette::{DIFFERENCE, FLUORESCENCE, Ramp, UNREACHABLE};
use crate::check::raster::Raster;
use crate::check::report::{CheckReport, CubeMaps};
use crate::check::text::{escaped, percent};

/// The picture and its maps.
pub(super) fn figures(report: &CheckReport) -> String {
    let counts = &report.counts;
    let size = format!("{} × {} texels", report.width, report.height);
    let mut all = figure(
        &report.thumbnail,
        &format!("The picture in sRGB, {size}."),
        "The picture in sRGB",
        "",
    );
    if let (Some(cube), Some(maps)) = (&report.cube, &report.cube_maps) {
        all += &of_cube(cube, maps, counts.texels > cube.texels);
    }
    let share = |count| percent(counts.share(count));
    let seen = format!(
        "Map of needed materials: reflectances match {}, {} needs fluorescence, no material matches {}.",
        share(counts.reflectance),
        share(counts.needs_fluorescence),
        share(counts.unreachable),
    );
    let mut legend = ramp("beyond reflectance", FLUORESCENCE);
    legend += &ramp("beyond any material", UNREACHABLE);
    legend += &plain("a reflectance", "gray");
    if counts.no_color > 0 {
        legend += &plain("NaN or infinite", "no-color");
    }
    all += &figure(
        &report.heat,
        &seen,
        "Needed materials; each pixel shows the ΔE00 of its furthest texel",
        &legend,
    );
    format!("<div class=\"pictures\">\n{all}</div>\n")
}

fn of_cube(cube: &CubeMatch, maps: &CubeMaps, has_outside: bool) -> String {
    let outside = if has_outside { plain("outside 0 to 1", "no-color") } else { String::new() };
    let worst = cube
        .worst
        .first()
        .map_or(String::new(), |worst| format!(" at column {}, row {}", worst.x, worst.y));
    let seen = format!(
        "Map of the cube&#39;s differences: {} of the texels in range within 1 ΔE00, the greatest {:.2}{worst}.",
        percent(cube.within_one),
        cube.greatest_de2000,
    );
    let legend = ramp("ΔE00", DIFFERENCE) + &plain("matched within 0.01", "gray") + &outside;
    let differences = figure(
        &maps.differences,
        &seen,
        "How far the cube is off; each pixel shows its furthest texel",
        &legend,
    );
    let dye = &cube.dye;
    let names: Vec<String> = dye.dyes.iter().take(3).map(|dye| escaped(&dye.name)).collect();
    let names = if names.is_empty() { String::new() } else { format!(": {}", names.join(", ")) };
    let seen = format!(
        "Map of dye: {} of the texels in range have dye, at most {:.2} of {}{names}.",
        percent(dye.share),
        dye.greatest_dose,
        dye.unit,
    );
    let legend = ramp(&dye.unit, maps.dose_ramp) + &plain("no dye", "gray") + &outside;
    differences
        + &figure(
            &maps.doses,
            &seen,
            "Where the cube has dye; each pixel shows its densest texel",
            &legend,
        )
}

/// A picture with its description, which is escaped, its caption and its legend.
fn figure(raster: &Raster, seen: &str, caption: &str, legend: &str) -> String {
    let legend = match legend {
        "" => String::new(),
        rows => format!("<div class=\"legend\">\n{rows}</div>"),
    };
    format!("<figure>{}<figcaption>{caption}</figcaption>{legend}</figure>\n", image(raster, seen))
}

/// Pictures narrower than this are enlarged without smoothing.
const FEW_PIXELS: u32 = 256;

fn image(raster: &Raster, seen: &str) -> String {
    let data = STANDARD.encode(raster.to_png());
    let class = if raster.width < FEW_PIXELS { " class=\"texels\"" } else { "" };
    let (width, height) = (raster.width, raster.height);
    format!(
        "<img{class} width=\"{width}\" height=\"{height}\" alt=\"{seen}\" \
         src=\"data:image/png;base64,{data}\"/>"
    )
}

fn plain(name: &str, class: &str) -> String {
    format!("<div class=\"ramp plain\"><span>{name}</span><i class=\"{class}\"></i></div>\n")
}

fn ramp(name: &str, ramp: Ramp) -> String {
    // Enough stops to approximate a ramp that is linear in another scale.
    let stop = |i: u32| {
        let position = f64::from(i) / 16.0;
        format!(",{} {:.1}%", hex(ramp.color(ramp.value(position))), 100.0 * position)
    };
    let stops: String = (0..=16).map(stop).collect();
    let tick = |value: &f64| {
        format!("<b style=\"left:{:.1}%\">{value}</b>", 100.0 * ramp.position(*value))
    };
    let ticks: String = ramp.ticks.iter().map(tick).collect();
    format!(
        "<div class=\"ramp\"><span>{name}</span>\
         <i style=\"background:linear-gradient(to right{stops})\">{ticks}</i></div>\n"
    )
}
