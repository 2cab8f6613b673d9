//! The page: one HTML text made of the files in `page/`.

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use upglow::Cube;

use crate::cube_data::{CubeData, ExplorerError};

const HTML: &str = include_str!("../page/index.html");
const STYLE: &str = include_str!("../page/style.css");

/// Signs of the style, in none of its texts, that mean the same without the spaces beside them.
const SPACED: [&str; 5] = [": ", "; ", ", ", " { ", " }"];

/// Each after those that it imports.
const SCRIPTS: [&str; 17] = [
    include_str!("../page/js/color.js"),
    include_str!("../page/js/state.js"),
    include_str!("../page/js/server.js"),
    include_str!("../page/js/cube.js"),
    include_str!("../page/js/dom.js"),
    include_str!("../page/js/chart.js"),
    include_str!("../page/js/picker.js"),
    include_str!("../page/js/spectra.js"),
    include_str!("../page/js/heat.js"),
    include_str!("../page/js/why.js"),
    include_str!("../page/js/relight.js"),
    include_str!("../page/js/gpu.js"),
    include_str!("../page/js/sphere.js"),
    include_str!("../page/js/build.js"),
    include_str!("../page/js/drop.js"),
    include_str!("../page/js/tools.js"),
    include_str!("../page/js/main.js"),
];

/// The page with a cube in it, which needs neither a server nor a network.
///
/// # Errors
///
/// [`ExplorerError`] if the cube has more nodes than shaders support, or a slope limit out of range.
pub fn offline_page(cube: &Cube, name: &str) -> Result<String, ExplorerError> {
    let CubeData { script, shader, arrays } = CubeData::new(cube, name)?;
    let borders = CubeData::borders(cube)?;
    let data = [
        embedded("cube-arrays", &STANDARD.encode(arrays)),
        embedded("cube-borders", &STANDARD.encode(borders)),
        embedded("cube-shader", &STANDARD.encode(shader)),
    ];
    Ok(page(&data.concat(), Some(&script)))
}

/// The page that a server gives out, which asks it for cubes.
#[cfg_attr(not(feature = "server"), expect(dead_code, reason = "only servers need it"))]
pub(crate) fn served_page() -> String {
    page("", None)
}

/// Text that no browser shows or runs; `text` has only letters of base64.
fn embedded(id: &str, text: &str) -> String {
    format!("<script type=\"application/octet-stream\" id=\"{id}\">{text}</script>\n")
}

/// The page around data and a cube's functions.
fn page(data: &str, functions: Option<&str>) -> String {
    let script: String = functions.into_iter().chain(SCRIPTS).map(in_one_scope).collect();
    let style: String = plain_lines(STYLE).flat_map(|line| [line, "\n"]).collect();
    let style = SPACED.iter().fold(style, |style, sign| style.replace(sign, sign.trim()));
    HTML.replace("/*STYLE*/", &style)
        .replace("<!--DATA-->", data)
        // Last, so that nothing in it is taken for a place of the others.
        .replace("/*SCRIPT*/", &script)
}

/// A module as part of one script: without what it imports from the others, its exports as plain names.
fn in_one_scope(module: &str) -> String {
    let lines = plain_lines(module).filter(|line| !line.starts_with("import "));
    lines.flat_map(|line| [line.strip_prefix("export ").unwrap_or(line), "\n"]).collect()
}

/// What browsers need of a text: a quarter of it is indentation, empty lines, and comments for readers of
/// the files.
fn plain_lines(text: &str) -> impl Iterator<Item = &str> {
    let is_comment =
        |line: &str| line.starts_with("//") || line.starts_with("/*") && line.ends_with("*/");
    let lines = text.lines().map(str::trim_start);
    lines.filter(move |line| !line.is_empty() && !is_comment(line))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_cube;

    #[test]
    fn the_page_names_no_other_address() {
        let page = offline_page(&test_cube(), "a cube").unwrap();
        // What SVG is, and what is in the page itself.
        let rest = page.replace("http://www.w3.org/2000/svg", "").replace("url(#", "");
        for word in ["http:", "https:", "//cdn", "src=", "@import", "url("] {
            assert!(!rest.contains(word), "{word}");
        }
        assert!(page.contains("id=\"cube-arrays\"") && !page.contains("/*SCRIPT*/"));
    }

    #[test]
    fn imports_name_files_that_come_before() {
        let names = include_str!("page.rs").lines().filter_map(|line| {
            line.trim().strip_prefix("include_str!(\"../page/js/")?.strip_suffix("\"),")
        });
        let names: Vec<&str> = names.collect();
        assert_eq!(names.len(), SCRIPTS.len());
        for (k, script) in SCRIPTS.iter().enumerate() {
            for line in script.lines().filter(|line| line.starts_with("import ")) {
                let file = line.rsplit('/').next().and_then(|name| name.strip_suffix("\";"));
                let place = names.iter().position(|name| Some(*name) == file);
                assert!(place.is_some_and(|place| place < k), "{}: {line}", names[k]);
            }
        }
    }

    #[test]
    fn a_module_becomes_part_of_one_script() {
        let module = "import { a } from \"./a.js\";\n\n// The same.\nexport const b = a;\n\
                      export function c() {\n    // Twice.\n    return b; // \u{201c}b\u{201d}\n}\n";
        let expected = "const b = a;\nfunction c() {\nreturn b; // \u{201c}b\u{201d}\n}\n";
        assert_eq!(in_one_scope(module), expected);
    }

    #[test]
    fn names_of_files_cannot_become_markup() {
        let page = offline_page(&test_cube(), "</script><script>alert(1)</script>").unwrap();
        assert!(!page.contains("alert(1)"));
    }
}
