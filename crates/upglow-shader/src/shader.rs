//! A cube as source text and the files it reads.

use std::f32::consts::LN_10;
use std::fmt::Write as _;

use upglow::{Accounting, AnalyticModel, Cube, FARTHEST_NM, FilmModel, Model};
use upglow_color::rounding::to_single;
use upglow_color::{Grid, Illuminant, MeasuredDye, ReducedBasis, RgbSpace};

use crate::error::ShaderError;
use crate::javascript::module;
use crate::language::Language;
use crate::payload::{HEADER_BYTES, TEXEL_BYTES, checksum, payload};
use crate::template::{functions, matrix_functions};
use crate::textures::{BINS, Texture, curves, film_curves, matrices, nodes};
use crate::tiff::tiff;
use crate::translation::translate;

/// A cube for a shader: source text, and the files with its numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Shader {
    /// The functions, in the requested language. Every name begins with `upglow_`, `Upglow` or
    /// `UPGLOW_`.
    pub source: String,
    /// The files to keep beside the source: one of both textures, or for OSL one of each.
    pub payload: Vec<PayloadFile>,
}

/// A file with a shader's numbers; `docs/shaders.md` describes it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PayloadFile {
    /// The file's name, without a folder: `name.textures`, or `name.nodes.tif` and
    /// `name.curves.tif` for OSL.
    pub name: String,
    /// Its content.
    pub bytes: Vec<u8>,
}

/// The greatest number below 1 for drivers with one bit less than single precision. A draw of 1
/// itself could fall beyond the last wavelength with a density above 0.
const BELOW_ONE: f32 = 1.0 - f32::EPSILON;
/// Smallest divisor: below every area or density that wavelengths are drawn from, above what drivers
/// flush to zero.
const TINY: f32 = 1e-30;
/// Below this optical density a film's absorption is a series. With a smaller one, the closed form
/// cancels more digits than OSL has, whose renderers approximate the exponential; with a larger one,
/// the series needs more terms.
const THIN: f32 = 0.5;
/// Terms of that series: the first that is left out is 1e-8 of the sum at [`THIN`].
const TERMS: u32 = 11;
/// Halvings that find one bin among all.
const HALVINGS: u32 = BINS.ilog2() + 1;
/// The start errs by 0.02, and each step squares the error: the third is below single precision.
const NEWTON_STEPS: u32 = 3;
/// Newton's steps to a quantile in single precision, from a start that errs by less than a tenth of
/// the bell. With fewer, draws in the bell's tails, where some steps are halvings, fall short.
const BRACKETED_STEPS: u32 = 12;

impl Shader {
    /// The shader of a cube; its files are called `name` with a suffix.
    ///
    /// # Errors
    ///
    /// [`ShaderError`] if the cube has more than 90 nodes along an axis, or `name` is not made of
    /// letters, digits, `.`, `-` and `_`.
    pub fn new(cube: &Cube, language: Language, name: &str) -> Result<Self, ShaderError> {
        let nodes = nodes(cube)?;
        let curves = match cube.model() {
            Model::Dyes(dyes) => Some(curves(dyes)),
            Model::Film(film) => Some(film_curves(film)),
            Model::Reflectance | Model::Analytic(_) => None,
        };
        let contents = Contents {
            subject: format!("Spectral materials for {}.", colors(cube)),
            nodes,
            curves,
            constants: constants(cube),
            functions: functions(cube.model(), language),
        };
        contents.shader(cube, language, name)
    }

    /// A shader for engines without spectra: the 4×4 matrix of a color, by which its material acts on light of four
    /// numbers, linear red, green and blue in `engine` and ultraviolet. Its files are called `name` with a suffix.
    ///
    /// # Errors
    ///
    /// [`ShaderError`] as for [`Shader::new`], and if the cube's light cannot be divided into four parts.
    pub fn of_matrices(
        cube: &Cube,
        engine: &RgbSpace,
        language: Language,
        name: &str,
    ) -> Result<Self, ShaderError> {
        let basis = ReducedBasis::try_new(cube.contract(), Grid::FIT)?;
        let space = basis.engine_space(engine)?;
        let table = cube.reduced_table(&basis).in_engine(&space);
        let mut subject = format!(
            "Matrices for {}, by which their materials act on light as\nlinear {} and ultraviolet:",
            colors(cube),
            engine.name(),
        );
        for light in [Illuminant::named("A"), Illuminant::named("FL11")].into_iter().flatten() {
            let numbers = space.light(basis.light(&light)).0.map(|v| format!("{v:.4}"));
            // Writing to a string does not fail.
            let _ = write!(subject, "\n{:<5} {}", light.name(), numbers.join(" "));
        }
        let contents = Contents {
            subject,
            nodes: matrices(cube, &table)?,
            curves: None,
            constants: resolution(cube),
            functions: matrix_functions(language),
        };
        contents.shader(cube, language, name)
    }
}

/// What a shader is made of.
struct Contents {
    /// What the functions are for, a sentence.
    subject: String,
    nodes: Texture,
    curves: Option<Texture>,
    /// In the templates' dialect, as the functions.
    constants: String,
    functions: String,
}

impl Contents {
    fn shader(&self, cube: &Cube, language: Language, name: &str) -> Result<Shader, ShaderError> {
        let is_plain = |c: char| c.is_alphanumeric() || ['.', '-', '_'].contains(&c);
        if name.is_empty() || !name.chars().all(is_plain) {
            return Err(ShaderError::Name { found: name.into() });
        }
        let Self { subject, nodes, constants, functions, .. } = self;
        let curves = self.curves.as_ref();
        let payload = payload_files(cube, language, name, nodes, curves);
        let checksum = checksum(nodes, curves);
        let mut source = heading(cube, subject, language, &payload, checksum, curves.is_some());
        let constants = translate(constants, language);
        let functions = fetches(language, name, nodes, curves) + &translate(functions, language);
        source += &match language {
            Language::JavaScript => module(&constants, &functions, &payload[0], checksum),
            _ => constants + "\n" + &functions,
        };
        Ok(Shader { source, payload })
    }
}

/// The colors that functions take, in words.
fn colors(cube: &Cube) -> String {
    format!("linear {} colors", cube.contract().space.name())
}

fn payload_files(
    cube: &Cube,
    language: Language,
    name: &str,
    nodes: &Texture,
    curves: Option<&Texture>,
) -> Vec<PayloadFile> {
    let file = |suffix: &str, bytes| PayloadFile { name: format!("{name}.{suffix}"), bytes };
    if language != Language::Osl {
        return vec![file("textures", payload(cube.resolution(), nodes, curves))];
    }
    let mut files = vec![file("nodes.tif", tiff(nodes))];
    files.extend(curves.map(|curves| file("curves.tif", tiff(curves))));
    files
}

/// The comment at the top: what made the text, from what, and how to bind it.
fn heading(
    cube: &Cube,
    subject: &str,
    language: Language,
    payload: &[PayloadFile],
    checksum: u64,
    has_curves: bool,
) -> String {
    let contract = cube.contract();
    let names: Vec<&str> = payload.iter().map(|file| file.name.as_str()).collect();
    let mut text = String::new();
    let mut line = |words: &str| {
        // Writing to a string does not fail.
        let _ = writeln!(text, "{}", format!("// {}", in_comment(words)).trim_end());
    };
    line(&format!("Made by upglow {}; do not edit.", env!("CARGO_PKG_VERSION")));
    line("SPDX-License-Identifier: MIT OR Apache-2.0");
    line("");
    subject.lines().for_each(&mut line);
    line(&format!(
        "{} nodes an axis, model {}, light {}, observer {}.",
        cube.resolution(),
        cube.model().name(),
        contract.illuminant.name(),
        contract.observer.name()
    ));
    line(&format!("Reads {}; checksum {checksum:016x}.", names.join(", ")));
    if let Some(dyes) = cube.model().dyes() {
        line(
            "The license above is that of this code. The curves that it reads keep the terms of their dyes:",
        );
        dyes.set().dyes().iter().for_each(|dye| line(&terms(dye)));
    }
    binding(language, has_curves).lines().for_each(line);
    text.push('\n');
    text
}

/// The name of a dye, and whose it is.
fn terms(dye: &MeasuredDye) -> String {
    match dye.provenance.as_str() {
        "" => format!("{}, terms not stated", dye.name),
        provenance => format!("{}: {provenance}", dye.name),
    }
}

/// Words as a comment of one line holds them: names from a cube may have signs that end a comment, continue it on the
/// next line or close the element of a page that the code is in; `_` stands for those.
fn in_comment(words: &str) -> String {
    let is_word = |c: char| c.is_alphanumeric() || " .,;:/-_+()'°×".contains(c);
    words.chars().map(|c| if is_word(c) { c } else { '_' }).collect()
}

/// How to bind the textures.
fn binding(language: Language, has_curves: bool) -> String {
    let textures = if has_curves { "upglow_nodes and upglow_curves" } else { "upglow_nodes" };
    let verb = if has_curves { "are textures" } else { "is a texture" };
    match language {
        Language::Wgsl => format!(
            "{textures} {verb} of rgba32float; bind to group 0 from binding 0 on,\n\
             or change the numbers in the attributes."
        ),
        Language::Glsl => format!(
            "{textures} {verb} of RGBA32F; from binding 0 on, or as\n\
             UPGLOW_NODES_LAYOUT and UPGLOW_CURVES_LAYOUT say if defined before.\n\
             UPGLOW_SAMPLER can name another type that texelFetch takes."
        ),
        Language::Hlsl => format!(
            "{textures} {verb} of R32G32B32A32_FLOAT; registers t0 on, or\n\
             UPGLOW_NODES_REGISTER and UPGLOW_CURVES_REGISTER if defined before."
        ),
        Language::Osl => "The files are found along the renderer's path for textures, or as\n\
                          UPGLOW_NODES and UPGLOW_CURVES say if defined before."
            .into(),
        Language::JavaScript => {
            "A module: upglow(textures) takes that file as an ArrayBuffer and\n\
                                 returns the functions by their names."
                .into()
        }
    }
}

/// The number of nodes along an axis, in the templates' dialect.
fn resolution(cube: &Cube) -> String {
    format!("const UPGLOW_RESOLUTION: i32 = {};\n", cube.resolution())
}

/// The constants of this cube, in the templates' dialect.
fn constants(cube: &Cube) -> String {
    let mut text = resolution(cube);
    let mut number = |name: &str, kind: &str, value: &str| {
        // Writing to a string does not fail.
        let _ = writeln!(text, "const UPGLOW_{name}: {kind} = {value};");
    };
    number("FARTHEST_NM", "f32", &float(FARTHEST_NM));
    if *cube.model() != Model::Reflectance {
        number("BELOW_ONE", "f32", &float(BELOW_ONE));
        number("TINY", "f32", &float(TINY));
    }
    if let Some(dyes) = cube.model().dyes() {
        number("DYES", "i32", &dyes.curves().len().to_string());
        number("FIRST_NM", "f32", &format!("{}.0", Grid::FINE.first_nm()));
        number("BINS", "i32", &BINS.to_string());
        number("HALVINGS", "i32", &HALVINGS.to_string());
    }
    match cube.model() {
        Model::Reflectance => {}
        Model::Dyes(_) => {
            for (which, name) in ["ABSORPTION", "MOMENT", "EMISSION"].into_iter().enumerate() {
                number(name, "i32", &which.to_string());
            }
        }
        Model::Film(_) => {
            for (name, level) in ["A", "B", "C", "D"].into_iter().zip(FilmModel::LEVELS) {
                number(&format!("LEVEL_{name}"), "f32", &float(to_single(level)));
            }
            // After the levels, which are integrals 0, 1, 2 and 3.
            number("EMISSION", "i32", &FilmModel::LEVELS.len().to_string());
            number("LN_10", "f32", &float(LN_10));
            number("THIN", "f32", &float(THIN));
            number("TERMS", "i32", &TERMS.to_string());
        }
        Model::Analytic(bells) => {
            let [absorption, emission] = steps_nm(bells).map(float);
            number("ABSORPTION_STEP_NM", "f32", &absorption);
            number("EMISSION_STEP_NM", "f32", &emission);
            number("QUANTUM_YIELD", "f32", &float(to_single(bells.quantum_yield())));
            number("NEWTON_STEPS", "i32", &NEWTON_STEPS.to_string());
            if bells.accounting() == Accounting::Photon {
                number("BRACKETED_STEPS", "i32", &BRACKETED_STEPS.to_string());
            }
        }
    }
    text
}

/// Distances of knots of the bells of absorption and emission, nm.
///
/// A bell of unit area has its peak of 2/3 over the step.
fn steps_nm(bells: &AnalyticModel) -> [f32; 2] {
    let emission = 2.0 / 3.0 / bells.emission(0.0, 0.0).0;
    let widths = bells.absorption_fwhm_nm() / bells.emission_fwhm_nm();
    [to_single(emission * widths), to_single(emission)]
}

/// The shortest digits that read back as the same number, always with a decimal point.
fn float(value: f32) -> String {
    format!("{value:?}")
}

/// The textures and the functions that read a texel of them.
fn fetches(language: Language, name: &str, nodes: &Texture, curves: Option<&Texture>) -> String {
    let mut text = match language {
        Language::Glsl => GLSL_SAMPLER.to_owned(),
        Language::Osl => OSL_TEXEL.to_owned(),
        Language::Wgsl | Language::Hlsl | Language::JavaScript => String::new(),
    };
    let mut texels_before = 0;
    let textures = [("node", "nodes", Some(nodes)), ("curve", "curves", curves)];
    for (binding, (texel, texture, found)) in textures.into_iter().enumerate() {
        let Some(found) = found else { continue };
        let macros = texture.to_uppercase();
        text += &match language {
            Language::Wgsl => wgsl_fetch(binding, texel, texture),
            Language::Glsl => glsl_fetch(binding, texel, texture, &macros),
            Language::Hlsl => hlsl_fetch(binding, texel, texture, &macros),
            Language::Osl => osl_fetch(name, texel, texture, &macros, found),
            Language::JavaScript => js_fetch(texel, texture, found, texels_before),
        };
        texels_before += found.texels.len();
    }
    text
}

fn wgsl_fetch(binding: usize, texel: &str, texture: &str) -> String {
    format!(
        "@group(0) @binding({binding}) var upglow_{texture}: texture_2d<f32>;

fn upglow_{texel}(column: i32, row: i32) -> vec4f {{
    return textureLoad(upglow_{texture}, vec2i(column, row), 0);
}}

"
    )
}

fn glsl_fetch(binding: usize, texel: &str, texture: &str, macros: &str) -> String {
    format!(
        "#ifndef UPGLOW_{macros}_LAYOUT
#define UPGLOW_{macros}_LAYOUT binding = {binding}
#endif
layout(UPGLOW_{macros}_LAYOUT) uniform highp UPGLOW_SAMPLER upglow_{texture};

vec4 upglow_{texel}(int column, int row) {{
    return texelFetch(upglow_{texture}, ivec2(column, row), 0);
}}

"
    )
}

fn hlsl_fetch(binding: usize, texel: &str, texture: &str, macros: &str) -> String {
    format!(
        "#ifndef UPGLOW_{macros}_REGISTER
#define UPGLOW_{macros}_REGISTER t{binding}
#endif
Texture2D<float4> upglow_{texture} : register(UPGLOW_{macros}_REGISTER);

float4 upglow_{texel}(int column, int row) {{
    return upglow_{texture}.Load(int3(column, row, 0));
}}

"
    )
}

/// Vulkan has textures without a sampler.
const GLSL_SAMPLER: &str = "#ifndef UPGLOW_SAMPLER
#define UPGLOW_SAMPLER sampler2D
#endif
";

/// OSL has no type of four numbers, and reads textures by coordinates in 0..1.
pub(crate) const OSL_TEXEL: &str = r#"struct UpglowTexel {
    float x;
    float y;
    float z;
    float w;
};

UpglowTexel upglow_texel(string file, float s, float t) {
    UpglowTexel texel;
    float w = 0.0;
    color rgb = texture(file, s, t, 0.0, 0.0, 0.0, 0.0, "interp", "closest", "wrap", "clamp",
        "alpha", w);
    texel.x = rgb[0];
    texel.y = rgb[1];
    texel.z = rgb[2];
    texel.w = w;
    return texel;
}

"#;

fn osl_fetch(name: &str, texel: &str, texture: &str, macros: &str, found: &Texture) -> String {
    let [width, height] = [found.width, found.height()];
    format!(
        "#ifndef UPGLOW_{macros}
#define UPGLOW_{macros} \"{name}.{texture}.tif\"
#endif

UpglowTexel upglow_{texel}(int column, int row) {{
    return upglow_texel(UPGLOW_{macros}, (column + 0.5) / {width}.0, (row + 0.5) / {height}.0);
}}

"
    )
}

/// `texels_before` are those before the texture in the file.
fn js_fetch(texel: &str, texture: &str, found: &Texture, texels_before: usize) -> String {
    let first_byte = HEADER_BYTES + TEXEL_BYTES * texels_before;
    let (width, floats) = (found.width, 4 * found.texels.len());
    format!(
        "const upglow_{texture} = new Float32Array(textures, {first_byte}, {floats});

function upglow_{texel}(column, row) {{
    const at = 4 * (row * {width} + column);
    return {{
        x: upglow_{texture}[at],
        y: upglow_{texture}[at + 1],
        z: upglow_{texture}[at + 2],
        w: upglow_{texture}[at + 3],
    }};
}}

"
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use upglow::{FitRecord, Node};
    use upglow_color::Contract;

    fn cube(model: Model, resolution: usize) -> Cube {
        let nodes = vec![Node::default(); resolution.pow(3)];
        Cube::new(Contract::default(), model, FitRecord::default(), resolution, nodes).unwrap()
    }

    #[test]
    fn cubes_that_make_too_tall_a_texture_are_refused() {
        let shader = |n| Shader::new(&cube(Model::Reflectance, n), Language::Wgsl, "x");
        assert!(shader(90).is_ok());
        assert_eq!(
            shader(91).unwrap_err().to_string(),
            "resolution 91, expected at most 90: textures have up to 8192 rows"
        );
    }

    #[test]
    fn names_that_could_break_the_text_are_refused() {
        for name in ["", "a\"b", "a\nb", "../a", "a b"] {
            let found = Shader::new(&cube(Model::Reflectance, 2), Language::Osl, name).unwrap_err();
            assert_eq!(found, ShaderError::Name { found: name.into() });
        }
    }

    #[test]
    fn the_knots_are_those_of_the_widths() {
        let [absorption, emission] = steps_nm(&AnalyticModel::default());
        // Single precision of numbers below 64. The width of the unit bell is in the file's format.
        assert!((absorption - 50.0 / 1.444_703_4).abs() < 4e-6);
        assert!((emission - 45.0 / 1.444_703_4).abs() < 4e-6);
    }

    #[test]
    fn the_heading_names_the_payload_and_its_checksum() {
        let shader = Shader::new(&cube(Model::Reflectance, 2), Language::Glsl, "gray").unwrap();
        let stated = &shader.payload[0].bytes[32..40];
        let stated = u64::from_le_bytes(stated.try_into().unwrap());
        let line = format!("// Reads gray.textures; checksum {stated:016x}.\n");
        assert!(shader.source.contains(&line), "{}", shader.source);
    }
}
