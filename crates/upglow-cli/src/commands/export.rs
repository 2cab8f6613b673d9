//! `upglow export`: converts a cube for other programs.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use serde::Serialize;
use upglow::{Aside, Cube, Model, Node, Sigmoid, Vertex};
use upglow_color::{Choice, Illuminant, RgbSpace};
use upglow_explorer::offline_page;
use upglow_fit::{BuildError, MaterialSet, Preset, Relighting, fit_coefficients};
use upglow_image::{ExrDescription, ExrWriter, InteropSpace, Sample};
use upglow_shader::{
    ColorTexture, Documents, Language, LutFormat, Shader, ShaderError, color_node,
};
use upglow_terminal::{Console, Failure, Report};

use super::material_report::{dye_names, unsigned_zeros};
use super::{documents, luts};
use crate::args::{ExportArgs, ExportFormat, SlopeLimit, limit_text};
use crate::output::{Lines, quoted, warn, warn_of_own_light, warn_of_ultraviolet};
use crate::plan::refuse_ignored;
use crate::{files, plan};

const HEADER: &str = "r,g,b,c0,c1,c2,shift_nm,width_nm,slope_per_nm,dye_a,dye_b,weight,\
                      concentration,density_a,density_b,emission_peak_nm,stokes_shift_nm,de2000";

#[derive(Clone, Debug, Serialize)]
struct ExportReport {
    file: String,
    format: &'static str,
    bytes: u64,
    nodes: usize,
    /// Greatest slope of the reflectances of a coefficient table, or `None` for no limit.
    #[serde(skip_serializing_if = "Option::is_none")]
    slope_max_per_nm: Option<SlopeLimit>,
    /// Files that the exported file refers to.
    textures: Vec<String>,
    /// What the cube's light lacks that its dyes absorb.
    missing_ultraviolet: Option<String>,
}

pub(crate) fn run(args: &ExportArgs, console: &Console) -> Result<(), Failure> {
    let kind = kind(args)?;
    let light = match &args.light {
        Some(name) => Some(plan::light("--light", name, &args.light_file)?),
        None => None,
    };
    files::check_ending(args.output(), &[kind.name()])?;
    files::check_output(args.output())?;
    let cube = files::read_cube(&args.file)?;
    let has_dyes = match kind {
        ExportFormat::Coeff => false,
        ExportFormat::Lut(_) => args.target.unwrap_or_default() == MaterialSet::Cube,
        _ => true,
    };
    let missing_ultraviolet = match &light {
        Some(light) => warn_of_ultraviolet(cube.model().missing_ultraviolet(light)),
        None => has_dyes.then(|| warn_of_own_light(&cube)).flatten(),
    };
    // What the output refers to, and which appears with it.
    let mut beside = Beside::default();
    let (bytes, nodes) = match kind {
        ExportFormat::Csv => (csv(&cube).into_bytes(), cube.nodes().len()),
        ExportFormat::Coeff => coeff(args, &cube, console)?,
        ExportFormat::Html => (page(args, &cube)?, cube.nodes().len()),
        ExportFormat::MaterialX => {
            let document;
            (document, beside) = material(args, &cube, light, console)?;
            (document, cube.nodes().len())
        }
        ExportFormat::Lut(format) => luts::lut(args, &cube, format, console)?,
        ExportFormat::Shader(language) => {
            let source;
            (source, beside) = shader(args, &cube, language)?;
            (source, cube.nodes().len())
        }
    };
    let Beside { mut files, names: textures } = beside;
    files.push(files::aside(args.output(), &bytes)?);
    files::write_together(args.output(), files)?;
    console.print(&ExportReport {
        file: args.output().display().to_string(),
        format: kind.name(),
        bytes: bytes.len() as u64,
        nodes,
        slope_max_per_nm: (kind == ExportFormat::Coeff).then(|| table_limit(args)),
        textures,
        missing_ultraviolet,
    })
}

/// The page to explore the cube with.
fn page(args: &ExportArgs, cube: &Cube) -> Result<Vec<u8>, Failure> {
    let name = args.file.file_stem().unwrap_or_default().to_string_lossy();
    let page = offline_page(cube, &name).map_err(|error| Failure::file(&args.file, error))?;
    Ok(page.into_bytes())
}

/// Files that appear with the output and just before it, so that it never exists without them.
#[derive(Debug, Default)]
struct Beside {
    files: Vec<Aside>,
    names: Vec<String>,
}

impl Beside {
    /// Adds a file that only lacks its name.
    fn add(&mut self, path: &Path, file: Aside) {
        self.files.push(file);
        self.names.push(path.display().to_string());
    }
}

/// The source of a shader, and its textures.
fn shader(
    args: &ExportArgs,
    cube: &Cube,
    language: Language,
) -> Result<(Vec<u8>, Beside), Failure> {
    let stem = args.output().file_stem().unwrap_or_default().to_string_lossy();
    let shader = match &args.engine {
        Some(engine) => Shader::of_matrices(cube, engine, language, &stem),
        None => Shader::new(cube, language, &stem),
    };
    let shader = shader.map_err(|error| match error {
        ShaderError::Name { .. } => Failure::file(args.output(), error),
        ShaderError::Engine(_) => Failure::option("--engine", error),
        error => Failure::file(&args.file, error),
    })?;
    let paths: Vec<PathBuf> =
        shader.payload.iter().map(|file| args.output().with_file_name(&file.name)).collect();
    check_beside(args, &paths)?;
    let mut beside = Beside::default();
    for (path, file) in paths.iter().zip(&shader.payload) {
        beside.add(path, files::aside(path, &file.bytes)?);
    }
    Ok((shader.source.into_bytes(), beside))
}

/// Checks files that are written beside the output.
fn check_beside(args: &ExportArgs, paths: &[PathBuf]) -> Result<(), Failure> {
    files::check_has_place(args.output())?;
    paths.iter().try_for_each(|path| files::check_output(path))
}

/// A MaterialX document, what it refers to, and the same material for USD.
fn material(
    args: &ExportArgs,
    cube: &Cube,
    light: Option<Illuminant>,
    console: &Console,
) -> Result<(Vec<u8>, Beside), Failure> {
    let light = light.unwrap_or_else(|| cube.contract().illuminant.clone());
    let colors = console.work(args.threads, |_| {
        let nodes = Relighting::of_nodes(cube);
        let seen_by = nodes.seen_by(&cube.contract().observer);
        let seen_by = seen_by.map_err(|error| Failure::file(&args.file, error))?;
        let colors = seen_by.rgb_over_white(&light);
        colors.map_err(|error| Failure::option("--light", error))
    })??;
    let texture = ColorTexture::new(cube.resolution(), &colors)
        .map_err(|error| Failure::file(&args.file, error))?;
    let name = args.output().with_extension("colors.exr");
    let file = documents::relative(&name, args.output())?;
    let stem = args.output().file_stem().unwrap_or_default().to_string_lossy();
    let space = InteropSpace::linear_id(&cube.contract().space);
    let documents = Documents::of_cube(&stem, &file, space)
        .map_err(|error| Failure::file(args.output(), error))?;
    let node = color_node().map(|file| (args.output().with_file_name(&file.name), file.bytes));
    let stage = args.output().with_extension("usda");
    let paths = [name, node[0].0.clone(), node[1].0.clone(), stage];
    check_beside(args, &paths)?;
    let mut beside = Beside::default();
    beside.add(&paths[0], colors_aside(&paths[0], &texture, &cube.contract().space)?);
    for (path, bytes) in &node {
        beside.add(path, files::aside(path, bytes)?);
    }
    beside.add(&paths[3], files::aside(&paths[3], documents.usd.as_bytes())?);
    Ok((documents.materialx.into_bytes(), beside))
}

/// The colors of nodes as a picture in single precision, which only lacks its name.
fn colors_aside(path: &Path, texture: &ColorTexture, space: &RgbSpace) -> Result<Aside, Failure> {
    let description = ExrDescription::new(texture.size, ["R", "G", "B"])
        .with_sample(Sample::Float)
        .with_named_space(space);
    let write = || {
        let mut writer = ExrWriter::create(path, description)?;
        let planes = texture.planes.each_ref().map(Vec::as_slice);
        writer.write_band(&planes)?;
        writer.into_file()
    };
    write().map_err(|error| files::unwritten_exr(path, error))
}

/// The format given by the option or by the suffix of the output.
fn kind(args: &ExportArgs) -> Result<ExportFormat, Failure> {
    let suffix = args.output().extension().and_then(|suffix| suffix.to_str()).unwrap_or_default();
    let from_suffix = ExportFormat::named(suffix).ok();
    let kind = args.format.or(from_suffix).ok_or_else(|| {
        let names: Vec<&str> = ExportFormat::ALL.iter().map(|format| format.name()).collect();
        let names = names.join(", ");
        let message =
            format!("not given, expected one of {names}, or an output with such a suffix");
        Failure::option("--format", message)
    })?;
    let coeff = &[ExportFormat::Coeff][..];
    let mtlx = &[ExportFormat::MaterialX][..];
    let luts = &[ExportFormat::Lut(LutFormat::Clf), ExportFormat::Lut(LutFormat::Cube)][..];
    let tables = &[coeff, luts].concat()[..];
    let shaders = Language::ALL.map(ExportFormat::Shader);
    let options = [
        ("--resolution", args.resolution.is_some(), tables),
        ("--target", args.target.is_some(), luts),
        ("--show", args.show.is_some(), luts),
        ("--slope-max-per-nm", args.slope_max_per_nm.is_some(), coeff),
        ("--light", args.light.is_some(), mtlx),
        ("--light-ends", args.light_file.ends.is_some(), mtlx),
        ("--engine", args.engine.is_some(), &shaders),
    ];
    refuse_ignored("--format", kind, &options)?;
    Ok(kind)
}

/// The resolution of the tables that Mitsuba 3 includes.
const TABLE_RESOLUTION: usize = 64;

/// The slope limit of a coefficient table: the one that was given, or that of the paper behind such
/// tables. That of the cube is for materials with dyes; without dyes it would make colors dull.
fn table_limit(args: &ExportArgs) -> SlopeLimit {
    args.slope_max_per_nm.unwrap_or(Preset::Jakob2019.options().slope_max_per_nm)
}

/// A table of reflectances for the cube's RGB space and light, and its number of nodes.
fn coeff(args: &ExportArgs, cube: &Cube, console: &Console) -> Result<(Vec<u8>, usize), Failure> {
    let resolution = args.resolution.unwrap_or(TABLE_RESOLUTION);
    let fitted = console.work(args.threads, |bar| {
        fit_coefficients(cube.contract(), table_limit(args), resolution, bar)
    })?;
    let table = fitted.map_err(|error| match error {
        BuildError::Stopped => Failure::Stopped,
        BuildError::Options(error) => Failure::option("--slope-max-per-nm", error),
        BuildError::Table(error) => Failure::option("--resolution", error),
        error => Failure::file(&args.file, error),
    })?;
    if !matches!(cube.model(), Model::Reflectance) {
        warn("a coefficient table has no fluorescence: colors that need it become duller");
    }
    Ok((table.to_bytes(), table.nodes().len()))
}

/// All nodes, red fastest. Numbers have as many digits as are needed to read them back exactly.
fn csv(cube: &Cube) -> String {
    let mut text = HEADER.to_owned() + "\n";
    for (index, node) in cube.nodes().iter().enumerate() {
        let rgb = cube.node_rgb(index).0.map(|v| v.to_string()).join(",");
        let shape = shape_cells(node);
        let fluorescence = fluorescence_cells(node, cube.model()).join(",");
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{rgb},{shape},{fluorescence},{}", node.de2000);
    }
    text
}

/// c0, c1, c2, shift, width, slope; the last three empty for a flat or straight reflectance.
fn shape_cells(node: &Node) -> String {
    let sigmoid = node.edge().to_sigmoid();
    let features = sigmoid.to_vertex().and_then(Vertex::to_features).map_or_else(
        || ",,".to_owned(),
        |f| format!("{},{},{}", f.shift_nm, f.width_nm, f.slope_per_nm),
    );
    let Sigmoid { c0, c1, c2 } = unsigned_zeros(sigmoid);
    format!("{c0},{c1},{c2},{features}")
}

/// First and second dye, weight, concentration, density of each dye, emission peak, Stokes shift. Cells
/// that do not apply to the model are empty, and all are empty if the node does not fluoresce.
fn fluorescence_cells(node: &Node, model: &Model) -> [String; 8] {
    let [first, second, third] = node.fluorescence;
    let number = |value: f32| value.to_string();
    let names = dye_names(node.material(model).fluorescence, model);
    let [dye_a, dye_b] = names.map_or_else(Default::default, |names| names.map(quoted));
    let no = String::new;
    match model {
        Model::Dyes(_) if second > 0.0 => {
            [dye_a, dye_b, number(first), number(second), no(), no(), no(), no()]
        }
        Model::Film(_) if first > 0.0 => {
            let dye_b = if second > 0.0 { dye_b } else { no() };
            [dye_a, dye_b, no(), no(), number(first), number(second), no(), no()]
        }
        Model::Analytic(_) if third > 0.0 => {
            [no(), no(), no(), number(third), no(), no(), number(first), number(second)]
        }
        _ => Default::default(),
    }
}

impl Report for ExportReport {
    fn text(&self) -> String {
        let mut lines = Lines::default();
        lines.add("format", self.format).add("nodes", self.nodes);
        if let Some(limit) = self.slope_max_per_nm {
            lines.add("slope limit", limit_text(limit));
        }
        lines.add_file("file", &self.file, self.bytes);
        for texture in &self.textures {
            lines.add("textures", texture);
        }
        lines.to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use upglow::{DyeModel, DyeOptions, DyeSet, FitRecord};
    use upglow_color::Contract;

    fn lines(model: Model, node: Node) -> Vec<String> {
        let fit = FitRecord { slope_max_per_nm: None, ..FitRecord::default() };
        let cube = Cube::new(Contract::default(), model, fit, 2, vec![node; 8]).unwrap();
        csv(&cube).lines().map(str::to_owned).collect()
    }

    #[test]
    fn each_node_is_a_line_of_as_many_cells_as_the_header() {
        let set = DyeSet::named("konig8").unwrap();
        let model = Model::Dyes(DyeModel::new(set, DyeOptions::default()).unwrap());
        let node = Node {
            reflectance: [500.0, -0.5, 0.01],
            dyes: [7, 0],
            fluorescence: [0.1, 0.7, 0.0],
            de2000: 0.3,
        };
        let lines = lines(model, node);
        assert_eq!(lines.len(), 9);
        assert!(lines.iter().all(|line| line.matches(',').count() == 17), "{lines:?}");
        assert!(lines[8].starts_with("1,1,1,") && lines[8].ends_with(",0.1,0.7,,,,,0.3"));
    }

    #[test]
    fn a_film_has_the_names_and_densities_of_its_dyes() {
        let model = Preset::Natural.model();
        let names: Vec<&str> =
            model.dyes().unwrap().set().dyes().iter().map(|dye| dye.name.as_str()).collect();
        let cells = |dyes: [u8; 2], [first, second]: [f32; 2]| {
            let node = Node { dyes, fluorescence: [first, second, 0.0], ..Node::default() };
            fluorescence_cells(&node, &model).join(",")
        };
        assert_eq!(cells([3, 1], [2.5, 0.5]), format!("{},{},,,2.5,0.5,,", names[3], names[1]));
        assert_eq!(cells([3, 3], [2.5, 0.0]), format!("{},,,,2.5,0,,", names[3]));
        assert_eq!(cells([0, 0], [0.0, 0.0]), ",,,,,,,");
    }

    #[test]
    fn a_flat_node_without_fluorescence_has_empty_cells() {
        let lines = lines(Model::Reflectance, Node::default());
        assert_eq!(lines[1], "0,0,0,0,0,0,,,,,,,,,,,,0");
    }
}
