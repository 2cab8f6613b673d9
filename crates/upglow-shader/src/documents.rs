//! Surfaces that show the colors of a cube's materials, in MaterialX and USD.

use std::collections::HashSet;
use std::fmt::Write as _;

use crate::color_node::{NODE, file_name};
use crate::language::Language;
use crate::xml::{escaped, is_forbidden, plain};

/// The same materials in both languages. The files that they name are looked for beside them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Documents {
    /// A MaterialX 1.39 document.
    pub materialx: String,
    /// A USD stage with the materials, each bound to a shape.
    pub usd: String,
}

/// A picture, or the tiles of one, with linear colors under a light.
#[derive(Clone, Debug, PartialEq)]
pub struct ColorMap {
    /// The path from the documents' folder, with `/` between folders and `<UDIM>` for the number of a tile.
    pub file: String,
    /// The numbers of the tiles, 1001 and greater; 1001 for a picture without.
    pub tiles: Vec<u32>,
    /// The RGB of the perfect diffuser under the light, in the same space.
    pub white: [f64; 3],
}

/// Why there is no document.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum DocumentError {
    /// XML cannot hold the name, or it would end a text in code that is generated from the document.
    #[error(
        "name {found:?}, expected one without double quotes, backslashes and control characters"
    )]
    Name {
        /// The name of the file.
        found: String,
    },
}

/// The color that the surface of a cube has before a picture is connected to it. No gray, which would look the same
/// without the node.
const SAMPLE: [f64; 3] = [0.5, 0.1, 0.6];
/// What stands for the number of a tile.
const UDIM: &str = "<UDIM>";

/// Where the color of a surface comes from.
enum Source<'a> {
    /// The node, with this texture.
    Node { file: &'a str },
    /// A map.
    Map(&'a ColorMap),
}

impl Documents {
    /// A surface whose color goes through the node [`color_node`](crate::color_node), which reads the
    /// [`ColorTexture`](crate::ColorTexture) in `file`. Its material is called `name`, with `_` in place of what is
    /// no letter or digit. `space` is the name of the cube's linear RGB space in the Color Interop Forum, if it has one.
    ///
    /// # Errors
    ///
    /// [`DocumentError`] if the file has a name that a document cannot hold.
    pub fn of_cube(name: &str, file: &str, space: Option<&str>) -> Result<Self, DocumentError> {
        check(file)?;
        let materials = [Named { name: plain(name), source: Source::Node { file } }];
        Ok(Self { materialx: materialx(&materials, space), usd: usd(&materials, space) })
    }

    /// A surface for each map, in the order given. Its material is called as the file, likewise, with a number where
    /// two would have the same name. `space` is the name of their linear RGB space in the Color Interop Forum, if it
    /// has one.
    ///
    /// # Errors
    ///
    /// [`DocumentError`] if a map has a name that a document cannot hold.
    pub fn of_maps(maps: &[ColorMap], space: Option<&str>) -> Result<Self, DocumentError> {
        maps.iter().try_for_each(|map| check(&map.file))?;
        let mut taken = HashSet::new();
        let named = |map| Named { name: free_name(map, &mut taken), source: Source::Map(map) };
        let materials: Vec<Named<'_>> = maps.iter().map(named).collect();
        Ok(Self { materialx: materialx(&materials, space), usd: usd(&materials, space) })
    }
}

/// A material and where its color comes from.
struct Named<'a> {
    /// Letters, digits and `_`.
    name: String,
    source: Source<'a>,
}

/// Refuses what XML cannot hold, and what MaterialX 1.39.5 would copy into OSL as code: it does not escape texts there.
fn check(file: &str) -> Result<(), DocumentError> {
    let is_bad = |c: char| is_forbidden(c) || ['"', '\\'].contains(&c);
    if file.contains(is_bad) {
        return Err(DocumentError::Name { found: file.into() });
    }
    Ok(())
}

/// A name that no other map has.
fn free_name(map: &ColorMap, taken: &mut HashSet<String>) -> String {
    let stem = map.file.rsplit_once('.').map_or(&*map.file, |(stem, _)| stem).replace(UDIM, "");
    let name = plain(stem.trim_end_matches(['.', '_']));
    let numbered = |count: usize| if count == 1 { name.clone() } else { format!("{name}_{count}") };
    let free = (1..).map(numbered).find(|name| !taken.contains(name)).expect("numbers do not end");
    taken.insert(free.clone());
    free
}

fn materialx(materials: &[Named<'_>], space: Option<&str>) -> String {
    let in_space = space.map(|id| format!(" colorspace=\"{}\"", escaped(id))).unwrap_or_default();
    let mut text = format!(
        "<?xml version=\"1.0\"?>
<!-- Made by upglow {}. SPDX-License-Identifier: MIT OR Apache-2.0 -->
<materialx version=\"1.39\">
",
        env!("CARGO_PKG_VERSION")
    );
    if materials.iter().any(|material| matches!(material.source, Source::Node { .. })) {
        text += &node_definition();
    }
    for Named { name, source } in materials {
        let graph = match source {
            Source::Node { file } => node_graph(file, &in_space),
            Source::Map(map) => map_graph(map, &in_space),
        };
        // Writing to a string does not fail.
        let _ = write!(
            text,
            r#"  <nodegraph name="NG_{name}">
{graph}    <output name="out" type="color3" nodename="color" />
  </nodegraph>
  <open_pbr_surface name="SR_{name}" type="surfaceshader">
    <input name="base_color" type="color3" nodegraph="NG_{name}" output="out" />
    <input name="specular_weight" type="float" value="0.0" />
  </open_pbr_surface>
  <surfacematerial name="M_{name}" type="material">
    <input name="surfaceshader" type="surfaceshader" nodename="SR_{name}" />
  </surfacematerial>
"#
        );
    }
    text + "</materialx>\n"
}

/// The node and where its function is, for each generator of shaders.
fn node_definition() -> String {
    let mut text = format!(
        r#"  <nodedef name="ND_{NODE}" node="{NODE}" nodegroup="texture2d" doc="The color of a material under a light, over that of the perfect diffuser">
    <input name="colors" type="filename" value="" uniform="true" uiname="Colors" doc="The colors of a cube's nodes under the light" />
    <input name="rgb" type="color3" value="0.18, 0.18, 0.18" uiname="RGB" doc="The color of the material under the cube's own light, linear, in the RGB space of the cube" />
    <output name="out" type="color3" defaultinput="rgb" />
  </nodedef>
"#
    );
    for language in [Language::Glsl, Language::Osl] {
        let file = file_name(language);
        // Writing to a string does not fail.
        let _ = writeln!(
            text,
            r#"  <implementation name="IM_{NODE}_gen{language}" nodedef="ND_{NODE}" file="{file}" function="{NODE}" target="gen{language}" />"#
        );
    }
    text
}

/// The document has no color space of its own, which would be converted from before the node, where numbers are in
/// the cube's. What is read from the file states one, so what the node returns is converted.
fn node_graph(file: &str, in_space: &str) -> String {
    format!(
        r#"    <input name="rgb" type="color3" value="{}" uiname="RGB" />
    <{NODE} name="color" type="color3">
      <input name="colors" type="filename" value="{}"{in_space} />
      <input name="rgb" type="color3" interfacename="rgb" />
    </{NODE}>
"#,
        numbers(SAMPLE),
        escaped(file)
    )
}

fn map_graph(map: &ColorMap, in_space: &str) -> String {
    format!(
        r#"    <image name="map" type="color3">
      <input name="file" type="filename" value="{}"{in_space} />
    </image>
    <divide name="color" type="color3">
      <input name="in1" type="color3" nodename="map" />
      <input name="in2" type="color3" value="{}"{in_space} />
    </divide>
"#,
        escaped(&map.file),
        numbers(map.white)
    )
}

fn numbers(of: [f64; 3]) -> String {
    of.map(|value| value.to_string()).join(", ")
}

fn usd(materials: &[Named<'_>], space: Option<&str>) -> String {
    let in_space = space
        .map(|id| format!(" (\n                    colorSpace = \"{id}\"\n                )"))
        .unwrap_or_default();
    let mut networks = String::new();
    let mut shapes = String::new();
    for (place, Named { name, source }) in materials.iter().enumerate() {
        let network = match source {
            Source::Node { file } => node_network(file, &in_space),
            Source::Map(map) => map_network(name, map, &in_space),
        };
        // Writing to a string does not fail.
        let _ = write!(
            networks,
            r#"
        def Material "M_{name}" (
            prepend apiSchemas = ["MaterialXConfigAPI"]
        )
        {{
            uniform string config:mtlx:version = "1.39"
            token outputs:mtlx:surface.connect = </upglow/materials/M_{name}/surface.outputs:out>

            def Shader "surface"
            {{
                uniform token info:id = "ND_open_pbr_surface_surfaceshader"
                color3f inputs:base_color.connect = </upglow/materials/M_{name}/color.outputs:out>
                float inputs:specular_weight = 0
                token outputs:out
            }}
{network}        }}
"#
        );
        shapes += &match source {
            Source::Node { .. } => sphere(name),
            Source::Map(map) => tiles(name, &map.tiles, place),
        };
    }
    format!(
        r#"#usda 1.0
(
    defaultPrim = "upglow"
    doc = "Made by upglow {}. SPDX-License-Identifier: MIT OR Apache-2.0"
    metersPerUnit = 1
    upAxis = "Y"
)

def Xform "upglow" (
    kind = "component"
)
{{
    def Scope "materials"
    {{{networks}    }}
{shapes}}}
"#,
        env!("CARGO_PKG_VERSION")
    )
}

fn node_network(file: &str, in_space: &str) -> String {
    format!(
        r#"
            def Shader "color"
            {{
                uniform token info:id = "ND_{NODE}"
                asset inputs:colors = {}{in_space}
                color3f inputs:rgb = ({})
                color3f outputs:out
            }}
"#,
        asset(file),
        numbers(SAMPLE)
    )
}

fn map_network(name: &str, map: &ColorMap, in_space: &str) -> String {
    format!(
        r#"
            def Shader "map"
            {{
                uniform token info:id = "ND_image_color3"
                asset inputs:file = {}{in_space}
                color3f outputs:out
            }}

            def Shader "color"
            {{
                uniform token info:id = "ND_divide_color3"
                color3f inputs:in1.connect = </upglow/materials/M_{name}/map.outputs:out>
                color3f inputs:in2 = ({}){in_space}
                color3f outputs:out
            }}
"#,
        asset(&map.file),
        numbers(map.white)
    )
}

/// The path of a file beside the stage. Three signs enclose a path that holds one.
fn asset(file: &str) -> String {
    if file.contains('@') {
        format!("@@@./{}@@@", file.replace("@@@", "\\@@@"))
    } else {
        format!("@./{file}@")
    }
}

fn sphere(name: &str) -> String {
    format!(
        r#"
    def Sphere "shape_{name}" (
        prepend apiSchemas = ["MaterialBindingAPI"]
    )
    {{
        float3[] extent = [(-1, -1, -1), (1, 1, 1)]
        rel material:binding = </upglow/materials/M_{name}>
        double radius = 1
    }}
"#
    )
}

/// A square for each tile, at its place in the texture; each set of tiles behind the one before.
fn tiles(name: &str, tiles: &[u32], place: usize) -> String {
    let corners: Vec<[u32; 2]> = tiles
        .iter()
        .flat_map(|tile| {
            let [u, v] = [tile.saturating_sub(1001) % 10, tile.saturating_sub(1001) / 10];
            [[u, v], [u + 1, v], [u + 1, v + 1], [u, v + 1]]
        })
        .collect();
    let list = |cells: Vec<String>| cells.join(", ");
    let point = |[u, v]: &[u32; 2]| format!("({u}, {v}, -{place})");
    let bound = |pick: fn(u32, u32) -> u32| {
        let all = corners.iter().copied().reduce(|a, b| [pick(a[0], b[0]), pick(a[1], b[1])]);
        point(&all.unwrap_or_default())
    };
    format!(
        r#"
    def Mesh "shape_{name}" (
        prepend apiSchemas = ["MaterialBindingAPI"]
    )
    {{
        uniform bool doubleSided = 1
        float3[] extent = [{}, {}]
        int[] faceVertexCounts = [{}]
        int[] faceVertexIndices = [{}]
        rel material:binding = </upglow/materials/M_{name}>
        point3f[] points = [{}]
        texCoord2f[] primvars:st = [{}] (
            interpolation = "vertex"
        )
        uniform token subdivisionScheme = "none"
    }}
"#,
        bound(u32::min),
        bound(u32::max),
        list(tiles.iter().map(|_| "4".into()).collect()),
        list((0..corners.len()).map(|i| i.to_string()).collect()),
        list(corners.iter().map(point).collect()),
        list(corners.iter().map(|[u, v]| format!("({u}, {v})")).collect()),
    )
}
