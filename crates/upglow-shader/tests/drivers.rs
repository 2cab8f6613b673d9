//! Shaders on a real driver: their results are the library's.

#![expect(clippy::unwrap_used, reason = "a test fails where its files cannot be made")]

mod support;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use upglow::{
    Accounting, AnalyticModel, Bispectral, Cube, Draw, DyeModel, DyeOptions, DyeSet, Edge,
    FilmModel, FitRecord, Fluorescence, Interpolation, Mixing, Mixture, Model, Node, QuantumYield,
    Sample,
};
use upglow_color::{Contract, Grid, LinearRgb, ReducedBasis, RgbSpace};
use upglow_shader::{ColorTexture, Language, Shader, color_node};

use crate::support::{python, runs};

/// Single precision of numbers near 10 under the root, and of curves at 1 nm.
const SHARE: f64 = 1e-5;
/// Single precision of densities up to 0.05 per nm.
const PER_NM: f64 = 1e-6;
/// The same where only the textures are in single precision: the peaks of bells, to 3e-5 nm, on flanks of
/// 0.02 per nm.
const SHARE_OF_TEXTURES: f64 = 1e-6;
const PER_NM_OF_TEXTURES: f64 = 2e-8;

const RESOLUTION: usize = 5;
const RANDOM_QUERIES: usize = 4000;
const DRAWS: usize = 20_000;

/// A generator whose sequence is its seed's, by Steele's `SplitMix64`.
struct Random(u64);

impl Random {
    /// The next number in 0..1, one of single precision.
    fn unit(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 40) as f32 / (1_u32 << 24) as f32
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * f64::from(self.unit())
    }

    fn dye(&mut self, dyes: &DyeModel) -> usize {
        let n = dyes.curves().len();
        let place = self.between(0.0, n as f64);
        (0..n).rev().find(|&i| i as f64 <= place).unwrap_or(0)
    }

    /// A node that is valid under `model`; one in four does not fluoresce.
    fn node(&mut self, model: &Model) -> Node {
        let reflectance = Edge {
            edge_nm: self.between(350.0, 750.0),
            level: self.between(-2.5, 2.5),
            slope_per_nm: self.between(-0.02, 0.02),
        };
        let concentration = self.between(-0.33, 1.0).max(0.0);
        let fluorescence = match model {
            _ if concentration == 0.0 => Fluorescence::None,
            Model::Reflectance => Fluorescence::None,
            Model::Dyes(dyes) => {
                let first = self.dye(dyes);
                Fluorescence::Dyes { first, weight: self.between(0.0, 1.0), concentration }
            }
            Model::Film(film) => {
                // Thin ones too, whose formula is a series.
                let mut dye = || {
                    let density = 6.0 * self.between(0.0, 1.0).powi(3);
                    (self.dye(film.dyes()), density)
                };
                Fluorescence::film(dye(), dye())
            }
            Model::Analytic(_) => Fluorescence::Analytic {
                emission_peak_nm: self.between(400.0, 710.0),
                stokes_shift_nm: self.between(10.0, 120.0),
                concentration,
            },
        };
        Node::new(reflectance, fluorescence, 0.0)
    }
}

/// One model of each kind and rule.
fn models() -> Vec<Model> {
    let bells = AnalyticModel::new(30.0, 60.0, Accounting::Photon, 0.7).unwrap();
    let mut models =
        vec![Model::Reflectance, Model::Analytic(AnalyticModel::default()), Model::Analytic(bells)];
    for accounting in [Accounting::Energy, Accounting::Photon] {
        let set = DyeSet::named("konig8").unwrap();
        models.push(Model::Film(FilmModel::new(set, accounting, QuantumYield::Measured).unwrap()));
        for mixing in [Mixing::Pooled, Mixing::Separate] {
            for optical_density in [None, Some(4.0)] {
                let quantum_yield = QuantumYield::Measured;
                let options = DyeOptions { accounting, mixing, quantum_yield, optical_density };
                let set = DyeSet::named("konig8").unwrap();
                models.push(Model::Dyes(DyeModel::new(set, options).unwrap()));
            }
        }
    }
    models
}

/// Cubes of each model, with materials all over what models can hold.
fn cubes() -> Vec<Cube> {
    let cube = |(seed, model): (u64, Model)| {
        let mut random = Random(seed);
        let nodes = (0..RESOLUTION.pow(3)).map(|_| random.node(&model)).collect();
        Cube::new(Contract::default(), model, FitRecord::default(), RESOLUTION, nodes).unwrap()
    };
    (0..).zip(models()).map(cube).collect()
}

/// What a shader is asked: red, green, blue, incident and outgoing wavelength (nm), the two numbers
/// that wavelengths are drawn with.
#[derive(Clone, Copy, Debug)]
struct Query {
    rgb: [f32; 3],
    in_nm: f32,
    out_nm: f32,
    u: [f32; 2],
}

/// The results of a shader, in the order of `drivers/main.*`.
#[derive(Clone, Copy, Debug)]
struct Answer {
    reflectance: f64,
    albedo: f64,
    reradiation: f64,
    incident_pdf: f64,
    incident_elastic: f64,
    outgoing_pdf: f64,
    outgoing_elastic: f64,
    came: Drawn,
    left: Drawn,
    /// The numbers of the corners' nodes, mixed by their weights; only in `JavaScript`.
    node: f64,
}

#[derive(Clone, Copy, Debug)]
struct Drawn {
    nm: f64,
    throughput: f64,
    pdf: f64,
    elastic: bool,
}

impl Query {
    fn random(random: &mut Random) -> Self {
        let rgb = [random.unit(), random.unit(), random.unit()];
        // Beyond all curves on either side.
        let [in_nm, out_nm] = [(); 2].map(|()| 280.0 + 580.0 * random.unit());
        Self { rgb, in_nm, out_nm, u: [random.unit(), random.unit()] }
    }

    fn to_bytes(self) -> Vec<u8> {
        let [r, g, b] = self.rgb;
        let numbers = [r, g, b, self.in_nm, self.out_nm, self.u[0], self.u[1], 0.0];
        numbers.into_iter().flat_map(f32::to_le_bytes).collect()
    }
}

impl Answer {
    fn from_numbers(a: &[f64; 16]) -> Self {
        let drawn =
            |a: &[f64]| Drawn { nm: a[0], throughput: a[1], pdf: a[2], elastic: a[3] == 1.0 };
        Self {
            reflectance: a[0],
            albedo: a[1],
            reradiation: a[2],
            incident_pdf: a[3],
            incident_elastic: a[4],
            outgoing_pdf: a[5],
            outgoing_elastic: a[6],
            came: drawn(&a[7..11]),
            left: drawn(&a[11..15]),
            node: a[15],
        }
    }
}

/// Invalid colors and wavelengths, each among ordinary numbers.
fn odd_queries() -> Vec<Query> {
    let plain = Query { rgb: [0.3, 0.4, 0.8], in_nm: 450.0, out_nm: 550.0, u: [0.9, 0.5] };
    let odd = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, -1.0, 0.0, 1.0, 2.0, 1e4, 1e38, 1e-40];
    let of = |v: f32| {
        [
            Query { rgb: [v, 0.4, 0.8], ..plain },
            Query { rgb: [0.3, v, v], ..plain },
            Query { rgb: [v; 3], ..plain },
            Query { in_nm: v, ..plain },
            Query { out_nm: v, ..plain },
            Query { u: [v, 0.5], ..plain },
            Query { u: [0.9, v], ..plain },
            Query { rgb: [v; 3], in_nm: v, out_nm: v, u: [v; 2] },
        ]
    };
    odd.into_iter().flat_map(of).collect()
}

/// One color and pair of wavelengths, drawn for many times.
fn draws(random: &mut Random) -> Vec<Query> {
    let mut draw = || [random.unit(), random.unit()];
    let of = |u| Query { rgb: [0.62, 0.35, 0.71], in_nm: 450.3, out_nm: 560.7, u };
    (0..DRAWS).map(|_| of(draw())).collect()
}

fn queries(seed: u64) -> Vec<Query> {
    let mut random = Random(seed);
    let mut queries: Vec<Query> = (0..RANDOM_QUERIES).map(|_| Query::random(&mut random)).collect();
    queries.extend(odd_queries());
    queries.extend(draws(&mut random));
    queries
}

fn here(file: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/drivers").join(file)
}

fn node() -> Option<PathBuf> {
    runs("node").then(|| "node".into())
}

/// The block of the documentation in a language.
fn example(language: Language) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/shaders.md");
    let text = fs::read_to_string(path).unwrap();
    let (_, after) = text.split_once(&format!("```{language}\n")).unwrap();
    after.split_once("```").unwrap().0.into()
}

/// How a program that compiles a fragment shader is called, and the text before the shader's.
fn fragment_compiler(language: Language) -> Option<(Command, &'static str)> {
    let python = |packages: &str, code: &str| {
        let mut command = Command::new(python(packages)?);
        command.args(["-c", code]);
        Some(command)
    };
    let glslang = |arguments: &[&str]| {
        let mut command = Command::new("glslangValidator");
        command.args(arguments);
        runs("glslangValidator").then_some(command)
    };
    Some(match language {
        Language::Wgsl => (python("wgpu", COMPILE_WGSL)?, ""),
        Language::Glsl => (glslang(&["-S", "frag"])?, "#version 420\n"),
        Language::Hlsl => (glslang(&["-V", "-D", "-e", "main", "-S", "frag", "-o", "x.spv"])?, ""),
        Language::Osl => (python("bpy", COMPILE_OSL)?, ""),
        Language::JavaScript => {
            let mut command = Command::new(node()?);
            command.args(["--input-type=module", "-e", RUN_JS]);
            (command, "")
        }
    })
}

const COMPILE_WGSL: &str = "\
import sys, wgpu
if not wgpu.gpu.enumerate_adapters_sync(): sys.exit('no Vulkan driver')
device = wgpu.gpu.request_adapter_sync().request_device_sync()
device.create_shader_module(code=open(sys.argv[1]).read())
";

/// Runs a module where `fetch` reads files.
const RUN_JS: &str = "\
import { readFileSync } from 'node:fs';
import { pathToFileURL } from 'node:url';
globalThis.fetch = async (path) => new Response(readFileSync(path));
await import(pathToFileURL(process.argv[1]));
";

const COMPILE_OSL: &str = "\
import sys, bpy, _cycles
sys.exit(not _cycles.osl_compile(sys.argv[1], 'x.oso'))
";

#[test]
fn the_examples_of_the_documentation_compile() {
    let folder = tempfile::tempdir().unwrap();
    // Reflectance, bells twice, dyes.
    let cubes = &cubes()[..4];
    for language in Language::ALL {
        if let Err(reason) = compile_examples(language, cubes, folder.path()) {
            println!("skipped: the_examples_of_the_documentation_compile in {language}, {reason}");
        }
    }
}

/// Compiles a language's example after the text of each cube, or names what is missing for that.
fn compile_examples(language: Language, cubes: &[Cube], folder: &Path) -> Result<(), String> {
    for cube in cubes {
        let (mut compiler, before) = fragment_compiler(language).ok_or("no compiler")?;
        let Shader { source, payload } = Shader::new(cube, language, "acescg").unwrap();
        let path = folder.join(format!("example.{language}"));
        let text = match language {
            Language::JavaScript => {
                fs::write(folder.join("package.json"), ES_MODULES).unwrap();
                fs::write(folder.join("acescg.js"), source).unwrap();
                fs::write(folder.join(&payload[0].name), &payload[0].bytes).unwrap();
                example(language)
            }
            _ => format!("{before}{source}{}", example(language)),
        };
        fs::write(&path, text).unwrap();
        let output = compiler.arg(&path).current_dir(folder).output().unwrap();
        let said = String::from_utf8_lossy(&output.stdout);
        let failed = String::from_utf8_lossy(&output.stderr);
        if failed.contains(NO_DRIVER) {
            return Err(NO_DRIVER.into());
        }
        assert!(output.status.success(), "{language}: {said}{failed}");
    }
    Ok(())
}

/// What scripts say where Vulkan finds no driver.
const NO_DRIVER: &str = "no Vulkan driver";

/// What glslang needs to know, and the text that comes before a shader's.
fn glslang(language: Language) -> Option<(&'static [&'static str], &'static str)> {
    match language {
        Language::Glsl => Some((
            &["-V", "-S", "comp"],
            "#version 450\n\
             #extension GL_EXT_samplerless_texture_functions : require\n\
             #define UPGLOW_SAMPLER texture2D\n",
        )),
        Language::Hlsl => Some((&["-V", "-D", "-e", "main", "-S", "comp"], "")),
        Language::Wgsl | Language::Osl | Language::JavaScript => None,
    }
}

/// Writes a shader, named "shader", its queries and the program `main` that answers them; compiles it where the
/// driver takes no source.
fn prepare(folder: &Path, shader: &Shader, main: &str, language: Language, queries: &[Query]) {
    fs::create_dir(folder).unwrap();
    for file in &shader.payload {
        fs::write(folder.join(&file.name), &file.bytes).unwrap();
    }
    let bytes: Vec<u8> = queries.iter().flat_map(|query| query.to_bytes()).collect();
    fs::write(folder.join("queries.f32"), bytes).unwrap();
    let (arguments, before) = glslang(language).unwrap_or_default();
    let before = match language {
        Language::Osl => osl_paths(folder),
        _ => before.to_owned(),
    };
    let main = fs::read_to_string(here(&format!("{main}.{language}"))).unwrap();
    let source = folder.join(format!("main.{language}"));
    fs::write(&source, format!("{before}{}{main}", shader.source)).unwrap();
    if !arguments.is_empty() {
        let output = Command::new("glslangValidator")
            .args(arguments)
            .args(["-o".as_ref(), folder.join("main.spv").as_os_str(), source.as_os_str()])
            .output()
            .unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stdout));
    }
}

/// Where an OSL shader finds its files: renderers have no folder of a shader's own.
fn osl_paths(folder: &Path) -> String {
    let files = [("NODES", "shader.nodes"), ("CURVES", "shader.curves"), ("QUERIES", "queries")];
    let line = |(name, file): (&str, &str)| {
        let prefix = if name == "QUERIES" { "" } else { "UPGLOW_" };
        format!("#define {prefix}{name} {:?}\n", folder.join(format!("{file}.tif")))
    };
    files.into_iter().map(line).collect()
}

fn read_answers(folder: &Path) -> Vec<[f64; 16]> {
    let single = |bytes: &[u8]| f64::from(f32::from_le_bytes(bytes.try_into().unwrap()));
    let double = |bytes: &[u8]| f64::from_le_bytes(bytes.try_into().unwrap());
    let numbers: Vec<f64> = match fs::read(folder.join("answers.f64")) {
        Ok(bytes) => bytes.chunks_exact(8).map(double).collect(),
        Err(_) => {
            let bytes = fs::read(folder.join("answers.f32")).unwrap();
            bytes.chunks_exact(4).map(single).collect()
        }
    };
    numbers.as_chunks().0.to_vec()
}

/// Makes Node read `.js` as modules, as browsers do.
const ES_MODULES: &str = r#"{"type": "module"}"#;

/// The program that answers queries in a language, or what is missing for it.
fn runner(language: Language) -> Result<Command, String> {
    let (program, script) = match language {
        Language::JavaScript => (node().ok_or("no node")?, "run_js.mjs"),
        Language::Osl => (python("numpy, bpy").ok_or("no python3 with numpy, bpy")?, "run_osl.py"),
        _ => (python("numpy, wgpu").ok_or("no python3 with numpy, wgpu")?, "run_shaders.py"),
    };
    let mut command = Command::new(program);
    command.arg(here(script));
    Ok(command)
}

/// What a shader was asked and answered.
type Answered = (Vec<Query>, Vec<[f64; 16]>);

/// What the program `main` makes of each shader, or why that is missing.
fn answers(language: Language, shaders: &[Shader], main: &str) -> Result<Vec<Answered>, String> {
    let mut command = runner(language)?;
    if glslang(language).is_some() && !runs("glslangValidator") {
        return Err("no glslangValidator".into());
    }
    let folder = tempfile::tempdir().unwrap();
    let at = |i: usize| folder.path().join(i.to_string());
    let asked: Vec<Vec<Query>> = (0..).take(shaders.len()).map(queries).collect();
    for (i, (shader, asked)) in shaders.iter().zip(&asked).enumerate() {
        prepare(&at(i), shader, main, language, asked);
    }
    fs::write(folder.path().join("package.json"), ES_MODULES).unwrap();
    let output = command.args((0..shaders.len()).map(at)).output().unwrap();
    let failed = String::from_utf8_lossy(&output.stderr);
    if failed.contains(NO_DRIVER) {
        return Err(NO_DRIVER.into());
    }
    assert!(output.status.success(), "{failed}");
    let said = String::from_utf8_lossy(&output.stdout);
    println!("{language} on {}", said.lines().last().unwrap_or_default());
    Ok(asked.into_iter().enumerate().map(|(i, asked)| (asked, read_answers(&at(i)))).collect())
}

/// The greatest errors of what a shader computes.
#[derive(Debug, Default)]
struct Errors {
    share: f64,
    per_nm: f64,
    /// Draws that fell on another side of a choice than the library's, by rounding.
    flips: usize,
}

impl Errors {
    fn compare(&mut self, mixture: &Mixture<'_>, query: Query, answer: &Answer) {
        let [in_nm, out_nm] = [query.in_nm, query.out_nm].map(f64::from);
        let mut share = |found: f64, expected: f64, what: &str| {
            assert!((found - expected).abs() < SHARE, "{what}: {found} {expected} {query:?}");
            self.share = self.share.max((found - expected).abs());
        };
        share(answer.reflectance, mixture.reflectance(in_nm), "reflectance");
        share(answer.albedo, mixture.albedo(in_nm), "albedo");
        let [leaving, arriving] = [throughput_leaving(mixture, out_nm), mixture.albedo(in_nm)];
        // The probability of a dark material is a ratio of small numbers.
        let scaled = |found: f64, whole: f64| found * whole.min(1.0);
        share(
            scaled(answer.incident_elastic, leaving),
            scaled(mixture.incident_elastic_probability(out_nm), leaving),
            "incident elastic",
        );
        share(
            scaled(answer.outgoing_elastic, arriving),
            scaled(mixture.outgoing_elastic_probability(in_nm), arriving),
            "outgoing elastic",
        );
        let mut per_nm = |found: f64, expected: f64, what: &str| {
            assert!((found - expected).abs() < PER_NM, "{what}: {found} {expected} {query:?}");
            self.per_nm = self.per_nm.max((found - expected).abs());
        };
        per_nm(answer.reradiation, mixture.reradiation_per_nm(in_nm, out_nm), "re-radiation");
        let expected = mixture.incident_pdf_per_nm(in_nm, out_nm);
        per_nm(scaled(answer.incident_pdf, leaving), scaled(expected, leaving), "incident density");
        let expected = mixture.outgoing_pdf_per_nm(in_nm, out_nm);
        per_nm(
            scaled(answer.outgoing_pdf, arriving),
            scaled(expected, arriving),
            "outgoing density",
        );
        let u = query.u.map(f64::from);
        let came = answer.came.agrees(mixture.sample_incident(out_nm, u), leaving, |nm| {
            [mixture.incident_pdf_per_nm(nm, out_nm), mixture.reradiation_per_nm(nm, out_nm)]
        });
        let arriving = mixture.sample_outgoing(in_nm, [0.0; 2]).map_or(0.0, |s| s.throughput);
        let left = answer.left.agrees(mixture.sample_outgoing(in_nm, u), arriving, |nm| {
            [mixture.outgoing_pdf_per_nm(in_nm, nm), mixture.reradiation_per_nm(in_nm, nm)]
        });
        self.flips += usize::from(!came) + usize::from(!left);
    }
}

/// W of the camera's way, which the library states with a sample.
fn throughput_leaving(mixture: &Mixture<'_>, out_nm: f64) -> f64 {
    mixture.sample_incident(out_nm, [0.0; 2]).map_or(0.0, |sample| sample.throughput)
}

impl Drawn {
    /// Whether the library drew the same, with checks of what must hold in any case. `whole` is the
    /// library's throughput of elastic draws; `at` are its density and re-radiation at a wavelength
    /// drawn, 1/nm.
    fn agrees(
        &self,
        expected: Option<Sample<f64>>,
        whole: f64,
        at: impl Fn(f64) -> [f64; 2],
    ) -> bool {
        // Areas of curves in single precision, through four roundings.
        const AREA: f64 = 2e-6;
        const NM: f64 = 2e-3;
        let Some(Sample { nm, draw, .. }) = expected else {
            assert!(self.throughput < SHARE, "{self:?}");
            return true;
        };
        if self.elastic {
            assert!((self.throughput - whole).abs() < 2.0 * SHARE, "{self:?} {whole}");
        } else {
            let [pdf, carried] = at(self.nm);
            let error = (self.pdf - pdf).abs() * whole.min(1.0);
            assert!(error < PER_NM, "{self:?} {expected:?} {error}");
            let error = (self.throughput - carried / pdf).abs();
            assert!(error < 2.0 * SHARE, "{self:?} {expected:?} {error}");
        }
        match draw {
            Draw::Elastic { probability } => {
                self.elastic
                    && self.nm == nm
                    && (self.pdf - probability).abs() * whole.min(1.0) < SHARE
            }
            Draw::Fluorescent { per_nm } => {
                let distance = (self.nm - nm).abs();
                !self.elastic && (distance < NM || distance * per_nm.max(self.pdf) < AREA)
            }
        }
    }
}

/// Pearson's chi-square test of drawn wavelengths against a density over bins of 12.5 nm, and of
/// elastic draws against their probability. The limit is five standard deviations above the mean of
/// the distribution, and eight for its long tail where the bins are few.
fn assert_drawn_from(draws: &[Drawn], pdf_at: impl Fn(f64) -> f64, elastic: f64) {
    const BIN_NM: f64 = 12.5;
    const FIRST_NM: f64 = 200.0;
    const BINS: usize = 52;
    const LEAST_EXPECTED: f64 = 8.0;
    let bin_of = |nm: f64| (0..BINS).rev().find(|&i| FIRST_NM + BIN_NM * i as f64 <= nm);
    let mut counts = [0.0; BINS + 1];
    for drawn in draws {
        let bin = if drawn.elastic { BINS } else { bin_of(drawn.nm).expect("above 200 nm") };
        counts[bin] += 1.0;
    }
    let area = |bin: usize| {
        let at = |i: usize| FIRST_NM + BIN_NM * (bin as f64 + (i as f64 + 0.5) / 250.0);
        (0..250).map(|i| pdf_at(at(i))).sum::<f64>() * BIN_NM / 250.0
    };
    let expected = (0..BINS).map(area).chain([elastic]).map(|share| share * draws.len() as f64);
    let (mut chi_square, mut terms) = (0.0, 0.0);
    let (mut rare, mut rare_expected) = (0.0, 0.0);
    for (count, expected) in counts.iter().zip(expected) {
        if expected < LEAST_EXPECTED {
            rare += count;
            rare_expected += expected;
        } else {
            chi_square += (count - expected).powi(2) / expected;
            terms += 1.0;
        }
    }
    assert!(rare < rare_expected + 40.0, "{rare} draws where {rare_expected} were expected");
    let freedom = f64::max(terms - 1.0, 1.0);
    let limit = freedom + 5.0 * (2.0 * freedom).sqrt() + 8.0;
    assert!(chi_square < limit, "chi-square {chi_square} of {freedom} degrees of freedom");
}

/// Whether a result is one that a material can have, for any query.
fn assert_sound(query: Query, answer: &Answer) {
    let shares =
        [answer.reflectance, answer.albedo, answer.incident_elastic, answer.outgoing_elastic];
    assert!(shares.iter().all(|v| (0.0..=1.000_001).contains(v)), "{query:?} {answer:?}");
    let densities = [answer.reradiation, answer.incident_pdf, answer.outgoing_pdf];
    assert!(densities.iter().all(|v| (0.0..1e3).contains(v)), "{query:?} {answer:?}");
    for (drawn, known_nm) in [(answer.came, query.out_nm), (answer.left, query.in_nm)] {
        assert!((0.0..1e3).contains(&drawn.throughput), "{query:?} {answer:?}");
        assert!((0.0..1e3).contains(&drawn.pdf), "{query:?} {answer:?}");
        // What was given comes back unread.
        let kept = drawn.nm.to_bits() == f64::from(known_nm).to_bits() || known_nm.is_nan();
        assert!(
            drawn.elastic && kept || (200.0..850.0).contains(&drawn.nm),
            "{query:?} {answer:?}"
        );
    }
}

/// Whether the known wavelengths come back from the program as they were: Cycles shows nothing
/// negative or infinite, and holds what is too bright.
fn carries(language: Language, query: &Query) -> bool {
    let shown = |nm: f32| (1e-30..=1e4).contains(&nm) || nm == 0.0;
    language != Language::Osl || shown(query.in_nm) && shown(query.out_nm)
}

fn mixture(cube: &Cube, query: Query) -> Mixture<'_> {
    cube.lookup(LinearRgb(query.rgb.map(f64::from)), Interpolation::Blend).unwrap()
}

fn check(
    language: Language,
    cube: &Cube,
    queries: &[Query],
    answers: &[Answer],
    errors: &mut Errors,
) {
    assert_eq!(queries.len(), answers.len());
    let flips = errors.flips;
    for (&query, answer) in queries.iter().zip(answers).take(RANDOM_QUERIES) {
        errors.compare(&mixture(cube, query), query, answer);
    }
    // A choice within rounding of its border: about 1e-6 of all choices.
    assert!(errors.flips - flips <= RANDOM_QUERIES / 1000, "{errors:?}");
    let draws = queries.len() - DRAWS;
    let odd = queries.iter().zip(answers).take(draws).skip(RANDOM_QUERIES);
    for (&query, answer) in odd.filter(|(query, _)| carries(language, query)) {
        assert_sound(query, answer);
    }
    let (query, mixture) = (queries[draws], mixture(cube, queries[draws]));
    let [in_nm, out_nm] = [query.in_nm, query.out_nm].map(f64::from);
    let of = |which: fn(&Answer) -> Drawn| answers[draws..].iter().map(which).collect::<Vec<_>>();
    assert_drawn_from(
        &of(|answer| answer.came),
        |nm| mixture.incident_pdf_per_nm(nm, out_nm),
        mixture.incident_elastic_probability(out_nm),
    );
    assert_drawn_from(
        &of(|answer| answer.left),
        |nm| mixture.outgoing_pdf_per_nm(in_nm, nm),
        mixture.outgoing_elastic_probability(in_nm),
    );
}

/// Whether the weights mix the nodes to the color itself: the number of a node, red fastest, is a
/// linear function of its color.
fn assert_mixes_nodes((query, answer): (&Query, &Answer)) {
    let n = RESOLUTION as f64;
    let [red, green, blue] = query.rgb.map(|v| f64::from(v) * (n - 1.0));
    let expected = (blue * n + green) * n + red;
    // Double precision of numbers below 125.
    assert!((answer.node - expected).abs() < 1e-12, "{query:?} {} {expected}", answer.node);
}

fn check_language(language: Language, test: &str) {
    let cubes = cubes();
    let shaders: Vec<Shader> =
        cubes.iter().map(|cube| Shader::new(cube, language, "shader").unwrap()).collect();
    let answered = match answers(language, &shaders, "main") {
        Ok(answered) => answered,
        Err(reason) => return println!("skipped: {test}, {reason}"),
    };
    let with_names = |(queries, numbers): Answered| {
        (queries, numbers.iter().map(Answer::from_numbers).collect::<Vec<Answer>>())
    };
    let answered: Vec<_> = answered.into_iter().map(with_names).collect();
    let mut errors = Errors::default();
    for (cube, (queries, answers)) in cubes.iter().zip(&answered) {
        check(language, cube, queries, answers, &mut errors);
    }
    println!("{language}: {errors:?} over {} queries", cubes.len() * RANDOM_QUERIES);
    if language == Language::JavaScript {
        assert!(errors.share < SHARE_OF_TEXTURES && errors.per_nm < PER_NM_OF_TEXTURES);
        for (queries, answers) in &answered {
            queries.iter().zip(answers).take(RANDOM_QUERIES).for_each(assert_mixes_nodes);
        }
    }
}

#[test]
fn wgsl_answers_what_the_library_answers() {
    check_language(Language::Wgsl, "wgsl_answers_what_the_library_answers");
}

#[test]
fn glsl_answers_what_the_library_answers() {
    check_language(Language::Glsl, "glsl_answers_what_the_library_answers");
}

#[test]
fn hlsl_answers_what_the_library_answers() {
    check_language(Language::Hlsl, "hlsl_answers_what_the_library_answers");
}

#[test]
fn javascript_answers_what_the_library_answers() {
    check_language(Language::JavaScript, "javascript_answers_what_the_library_answers");
}

#[test]
fn osl_answers_what_the_library_answers() {
    check_language(Language::Osl, "osl_answers_what_the_library_answers");
}

/// Compares the matrices of a shader with the library's, for an engine of other primaries than the cube's.
fn check_matrices(language: Language, test: &str) {
    // Single precision of numbers up to 4, and in OSL of these with 8 added.
    let rounding = if language == Language::Osl { 5e-6 } else { 1e-6 };
    let cubes = &cubes()[..4];
    let engine = RgbSpace::named("rec709").unwrap();
    let shader = |cube| Shader::of_matrices(cube, &engine, language, "shader").unwrap();
    let shaders: Vec<Shader> = cubes.iter().map(shader).collect();
    let answered = match answers(language, &shaders, "matrix") {
        Ok(answered) => answered,
        Err(reason) => return println!("skipped: {test}, {reason}"),
    };
    let mut greatest = 0.0_f64;
    for (cube, (queries, answers)) in cubes.iter().zip(&answered) {
        assert_eq!(queries.len(), answers.len());
        let basis = ReducedBasis::try_new(cube.contract(), Grid::FIT).unwrap();
        let table = cube.reduced_table(&basis).in_engine(&basis.engine_space(&engine).unwrap());
        for (query, answer) in queries.iter().zip(answers) {
            // What is outside counts as the nearer end, and NaN as 0.
            let inside = query.rgb.map(|v| if v > 0.0 { v.min(1.0) } else { 0.0 });
            let expected = table.matrix(inside).unwrap();
            let (columns, _) = answer.as_chunks::<4>();
            for (row, column) in (0..4).flat_map(|row| (0..4).map(move |column| (row, column))) {
                let (asked, shift) = match language {
                    Language::Osl => ((row, column) != (3, 3), 8.0),
                    _ => (true, 0.0),
                };
                let error = columns[column][row] - shift - f64::from(expected[row][column]);
                assert!(!asked || error.abs() < rounding, "{query:?}: {answer:?} {expected:?}");
                greatest = greatest.max(if asked { error.abs() } else { 0.0 });
            }
        }
    }
    println!("{language}: matrices differ by at most {greatest:e}");
}

#[test]
fn matrices_are_the_library_s_in_wgsl() {
    check_matrices(Language::Wgsl, "matrices_are_the_library_s_in_wgsl");
}

#[test]
fn matrices_are_the_library_s_in_glsl() {
    check_matrices(Language::Glsl, "matrices_are_the_library_s_in_glsl");
}

#[test]
fn matrices_are_the_library_s_in_hlsl() {
    check_matrices(Language::Hlsl, "matrices_are_the_library_s_in_hlsl");
}

#[test]
fn matrices_are_the_library_s_in_javascript() {
    check_matrices(Language::JavaScript, "matrices_are_the_library_s_in_javascript");
}

#[test]
fn matrices_are_the_library_s_in_osl() {
    check_matrices(Language::Osl, "matrices_are_the_library_s_in_osl");
}

/// The colors that the node returns, per query.
fn node_colors(
    language: Language,
    n: usize,
    queries: &[Query],
    texture: &ColorTexture,
) -> Result<Vec<[f64; 3]>, String> {
    let (script, packages) = match language {
        Language::Osl => ("run_osl.py", "bpy, numpy"),
        _ => ("run_shaders.py", "wgpu, numpy"),
    };
    let python = python(packages).ok_or("no Python with ".to_owned() + packages)?;
    if language == Language::Glsl && !runs("glslangValidator") {
        return Err("no glslangValidator".into());
    }
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let bytes: Vec<u8> = queries.iter().flat_map(|query| query.to_bytes()).collect();
    fs::write(at("queries.f32"), bytes).unwrap();
    let [red, green, blue] = &texture.planes;
    let texels = red.iter().zip(green).zip(blue).map(|((r, g), b)| [*r, *g, *b, 1.0]);
    let texels: Vec<u8> = texels.flatten().flat_map(f32::to_le_bytes).collect();
    // The layout of `docs/shaders.md`.
    let sizes = [1, n, texture.size[0], texture.size[1], 0, 0].map(|v| u32::try_from(v).unwrap());
    let mut payload = b"UPGLOWTX".to_vec();
    payload.extend(sizes.into_iter().flat_map(u32::to_le_bytes));
    payload.resize(64, 0);
    payload.extend(texels);
    fs::write(at("shader.textures"), payload).unwrap();
    let suffix = format!(".{language}");
    let file = color_node().into_iter().find(|file| file.name.ends_with(&suffix)).unwrap();
    let node = String::from_utf8(file.bytes).unwrap();
    let main = fs::read_to_string(here(&format!("node.{language}"))).unwrap();
    let source = at(&format!("main.{language}"));
    match language {
        Language::Osl => {
            let [colors, queries] = ["colors.tif", "queries.tif"].map(&at);
            let before = format!(
                "#define COLORS {colors:?}\n#define QUERIES {queries:?}\n\
                 struct textureresource {{ string filename; string colorspace; }};\n"
            );
            fs::write(&source, before + &node + &main).unwrap();
        }
        _ => {
            let (arguments, before) = glslang(language).unwrap();
            let text = format!("{before}{}{main}", node.replace("sampler2D", "texture2D"));
            fs::write(&source, text).unwrap();
            let output = Command::new("glslangValidator")
                .args(arguments)
                .args(["-o".as_ref(), at("main.spv").as_os_str(), source.as_os_str()])
                .output()
                .unwrap();
            assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stdout));
        }
    }
    let output = Command::new(python).arg(here(script)).arg(folder.path()).output().unwrap();
    let failed = String::from_utf8_lossy(&output.stderr);
    if failed.contains(NO_DRIVER) {
        return Err(NO_DRIVER.into());
    }
    assert!(output.status.success(), "{failed}");
    let bytes = fs::read(at("answers.f32")).unwrap();
    let numbers: Vec<f64> =
        bytes.as_chunks().0.iter().map(|word| f64::from(f32::from_le_bytes(*word))).collect();
    Ok(numbers.as_chunks::<16>().0.iter().map(|a| [a[0], a[1], a[2]]).collect())
}

/// Compares with the blend of the nodes' colors that the library's weights make.
fn check_node(language: Language, test: &str) {
    // Single precision of sums of numbers below 2.
    const ROUNDING: f64 = 1e-6;
    let cube = &cubes()[0];
    let mut random = Random(7);
    let colors: Vec<LinearRgb> = (0..RESOLUTION.pow(3))
        .map(|_| LinearRgb([(); 3].map(|()| random.between(0.0, 1.8))))
        .collect();
    let texture = ColorTexture::new(RESOLUTION, &colors).unwrap();
    let mut queries: Vec<Query> = (0..2000).map(|_| Query::random(&mut random)).collect();
    queries.extend(odd_queries());
    let found = match node_colors(language, RESOLUTION, &queries, &texture) {
        Ok(found) => found,
        Err(reason) => return println!("skipped: {test}, {reason}"),
    };
    assert_eq!(found.len(), queries.len());
    for (query, found) in queries.iter().zip(found) {
        // What is outside counts as the nearer end, and NaN as 0.
        let inside = query.rgb.map(|v| f64::from(if v > 0.0 { v.min(1.0) } else { 0.0 }));
        let corners = cube.corners(LinearRgb(inside)).unwrap();
        let blend = |k: usize| corners.iter().map(|(node, w)| w * colors[*node].0[k]).sum::<f64>();
        for k in 0..3 {
            let error = (found[k] - blend(k)).abs();
            assert!(error < ROUNDING, "{query:?}: {found:?}, expected {}", blend(k));
        }
    }
}

#[test]
fn the_color_node_blends_the_colors_of_nodes_in_glsl() {
    check_node(Language::Glsl, "the_color_node_blends_the_colors_of_nodes_in_glsl");
}

#[test]
fn the_color_node_blends_the_colors_of_nodes_in_osl() {
    check_node(Language::Osl, "the_color_node_blends_the_colors_of_nodes_in_osl");
}

/// Prints for each file what a module says to its content.
const TRY_TEXTURES: &str = "\
import { readFileSync } from 'node:fs';
import { upglow } from './shader.js';
for (const path of process.argv.slice(1)) {
    try {
        upglow(new Uint8Array(readFileSync(path)).buffer);
        console.log('fits');
    } catch (error) {
        console.log(error.message);
    }
}
";

#[test]
fn a_module_takes_no_textures_but_its_own() {
    const TEST: &str = "a_module_takes_no_textures_but_its_own";
    let Some(node) = node() else {
        return println!("skipped: {TEST}, no node");
    };
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, bytes: &[u8]| fs::write(folder.path().join(name), bytes).unwrap();
    let cube = &cubes()[3];
    let Shader { source, payload } = Shader::new(cube, Language::JavaScript, "shader").unwrap();
    write("package.json", ES_MODULES.as_bytes());
    write("shader.js", source.as_bytes());
    let own = &payload[0].bytes;
    let changed = |at: usize| {
        let mut bytes = own.clone();
        bytes[at] ^= 3;
        bytes
    };
    let length = own.len();
    let tries = [
        (own.clone(), "fits".to_owned()),
        (vec![], "shader.textures: expected a file that begins with UPGLOWTX".into()),
        (changed(0), "shader.textures: expected a file that begins with UPGLOWTX".into()),
        (changed(8), "shader.textures: version 2, expected 1".into()),
        (own[..100].to_vec(), format!("shader.textures: 100 bytes, expected {length}")),
        (changed(length - 1), "shader.textures: checksum ".into()),
    ];
    let names: Vec<String> = (0..tries.len()).map(|i| i.to_string()).collect();
    names.iter().zip(&tries).for_each(|(name, (bytes, _))| write(name, bytes));
    let mut command = Command::new(node);
    command.args(["--input-type=module", "-e", TRY_TEXTURES]).args(&names);
    let output = command.current_dir(folder.path()).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let said = String::from_utf8_lossy(&output.stdout);
    assert_eq!(said.lines().count(), tries.len(), "{said}");
    for (line, (_, expected)) in said.lines().zip(&tries) {
        assert!(line.starts_with(expected), "{line}, expected {expected}");
    }
}
