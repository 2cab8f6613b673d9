//! `upglow check`: what pictures ask of materials.

use std::path::{Path, PathBuf};

use serde::Serialize;
use upglow::Cube;
use upglow_color::Contract;
use upglow_color::StandingKind;
use upglow_fit::Watch;
use upglow_image::{
    Assumed, CheckReport, CheckedPicture, Counts, Flaw, Judge, LinearPicture, Located, WorstTexel,
    check_page,
};
use upglow_terminal::{Bar, Failure, on_threads};

use super::bake::picture_failure;
use crate::args::CheckArgs;
use crate::output::{Format, Lines, Report};
use crate::{files, pictures, plan};

/// Rows that are read at a time: enough to keep every core busy.
const BAND_ROWS: usize = 64;

#[derive(Clone, Debug, Serialize)]
struct PictureReport {
    file: String,
    width: usize,
    height: usize,
    rgb_space: String,
    illuminant: String,
    texels: u64,
    shown_by_reflectance: f64,
    needs_fluorescence: f64,
    shown_by_nothing: f64,
    no_color: u64,
    above_one: u64,
    negative: u64,
    not_a_number: u64,
    infinite: u64,
    /// The first texels of each flaw.
    flaws: Vec<FlawReport>,
    worst: Vec<WorstReport>,
    cube: Option<CubeReport>,
    heat_map: Option<String>,
    /// The page that all pictures are on.
    page: Option<String>,
}

#[derive(Clone, Debug, Serialize)]
struct FlawReport {
    flaw: &'static str,
    x: usize,
    y: usize,
    /// `null` stands for what JSON has no number for.
    rgb: [f32; 3],
}

#[derive(Clone, Debug, Serialize)]
struct WorstReport {
    x: usize,
    y: usize,
    rgb: [f32; 3],
    needs: &'static str,
    /// ΔE00 to the nearest color of any reflectance.
    reflectance_de2000: f64,
    /// ΔE00 to the nearest color of any material.
    material_de2000: f64,
}

#[derive(Clone, Debug, Serialize)]
struct CubeReport {
    file: String,
    within_one: f64,
    within_two: f64,
    mean_de2000: f64,
    greatest_de2000: f64,
}

pub(crate) fn run(args: &CheckArgs, format: Format, quiet: bool) -> Result<(), Failure> {
    let inputs = pictures::find(&args.inputs)?;
    check_outputs(args, &inputs)?;
    let assumed = pictures::assumed(&args.picture)?;
    let cube = args.cube.as_deref().map(files::read_cube).transpose()?;
    let contract = contract(args, cube.as_ref())?;
    let bar = Bar::start(quiet);
    let mut judges = Judges { contract: &contract, cube: cube.as_ref(), known: Vec::new() };
    let mut found = Vec::new();
    for input in &inputs {
        let checked = on_threads(args.threads, || check(input, &assumed, &mut judges, &bar))?;
        bar.finish();
        found.push(checked?);
    }
    let names: Vec<String> = inputs.iter().map(|input| input.display().to_string()).collect();
    let cube_name = args.cube.as_ref().map(|path| path.display().to_string());
    if let Some(output) = &args.output {
        let light = contract.illuminant.name();
        let pictures = names.iter().zip(&found).map(|(name, (space, report))| CheckedPicture {
            name,
            space,
            light,
            cube: cube_name.as_deref(),
            report,
        });
        let page = check_page(&pictures.collect::<Vec<_>>());
        files::write(output, page.as_bytes())?;
    }
    if let (Some(path), [(_, report)]) = (&args.heat_map, &found[..]) {
        files::write(path, &report.heat.to_png())?;
    }
    let light = contract.illuminant.name();
    for (number, (name, (space, report))) in names.iter().zip(&found).enumerate() {
        format.separate(number)?;
        let shown = |path: &Option<PathBuf>| path.as_ref().map(|path| path.display().to_string());
        format.print(&PictureReport {
            heat_map: shown(&args.heat_map),
            page: shown(&args.output),
            ..PictureReport::new(name, space, light, cube_name.as_deref(), report)
        })?;
    }
    Ok(())
}

fn check_outputs(args: &CheckArgs, inputs: &[PathBuf]) -> Result<(), Failure> {
    if args.heat_map.is_some() && inputs.len() != 1 {
        let pictures = inputs.len();
        return Err(Failure::option(
            "--heat-map",
            format_args!(
                "given with {pictures} pictures, expected one; --output has all heat maps"
            ),
        ));
    }
    for output in args.output.iter().chain(&args.heat_map) {
        files::check_output(output)?;
        if let Some(input) = inputs.iter().find(|input| files::is_same(input, output)) {
            let input = input.display();
            let message = format_args!("the picture {input} itself, expected another file");
            return Err(Failure::file(output, message));
        }
        if let Some(cube) = &args.cube {
            files::check_distinct(cube, output)?;
        }
    }
    Ok(())
}

/// The light and adaptation; the RGB space is each picture's own, or the cube's.
fn contract(args: &CheckArgs, cube: Option<&Cube>) -> Result<Contract, Failure> {
    let mut contract = cube.map(|cube| cube.contract().clone()).unwrap_or_default();
    if let Some(text) = &args.illuminant {
        contract.illuminant = plan::light("--illuminant", text)?;
    }
    if let Some(adaptation) = args.adapt {
        contract.adaptation = adaptation;
    }
    plan::check(&contract)?;
    Ok(contract)
}

/// A judge for each RGB space: what one has found out serves the next picture too.
struct Judges<'a> {
    contract: &'a Contract,
    cube: Option<&'a Cube>,
    known: Vec<(Contract, Judge)>,
}

impl Judges<'_> {
    /// The judge of a picture, in the cube's RGB space or in the picture's own.
    fn of(&mut self, picture: &LinearPicture) -> Result<&(Contract, Judge), Failure> {
        let mut contract = self.contract.clone();
        if self.cube.is_none() {
            contract.space = picture.space().clone();
        }
        let known = self.known.iter().position(|(known, _)| *known == contract);
        let index = match known {
            Some(index) => index,
            None => {
                let mut judge = Judge::new(&contract);
                if let Some(cube) = self.cube {
                    let asked = judge.with_cube(cube);
                    judge = asked.map_err(|error| Failure::option("--cube", error))?;
                }
                self.known.push((contract, judge));
                self.known.len() - 1
            }
        };
        Ok(&self.known[index])
    }
}

/// What one picture asks for, and the name of the RGB space that it was judged in.
fn check(
    input: &Path,
    assumed: &Assumed,
    judges: &mut Judges<'_>,
    bar: &Bar,
) -> Result<(String, CheckReport), Failure> {
    let open = LinearPicture::open(input, assumed);
    let mut picture = open.map_err(|error| picture_failure(&error, input))?;
    let (contract, judge) = judges.of(&picture)?;
    picture.convert_to(contract);
    let [width, height] = picture.picture().size();
    let faulty = |error: &dyn std::fmt::Display| Failure::file(input, error);
    let mut checker = judge.checker(width, height).map_err(|error| faulty(&error))?;
    while let Some(band) = picture.read_band(BAND_ROWS).map_err(|error| faulty(&error))? {
        if bar.stopped() {
            return Err(Failure::Stopped);
        }
        checker.add(band.first_row, &band.rgb).map_err(|error| faulty(&error))?;
        let done = band.first_row + band.rows();
        bar.progress(upglow_fit::Progress { stage: "checking", done, total: height });
    }
    let report = checker.finish().map_err(|error| faulty(&error))?;
    Ok((contract.space.name().to_owned(), report))
}

impl PictureReport {
    fn new(file: &str, space: &str, light: &str, cube: Option<&str>, report: &CheckReport) -> Self {
        let Counts { texels, .. } = report.counts;
        let share = |count: u64| count as f64 / texels as f64;
        let counts = &report.counts;
        let cube = report.cube.zip(cube).map(|(opinion, file)| CubeReport {
            file: file.into(),
            within_one: opinion.within_one,
            within_two: opinion.within_two,
            mean_de2000: opinion.mean,
            greatest_de2000: opinion.greatest,
        });
        Self {
            file: file.into(),
            width: report.width,
            height: report.height,
            rgb_space: space.into(),
            illuminant: light.into(),
            texels,
            shown_by_reflectance: share(counts.reflectance),
            needs_fluorescence: share(counts.needs_fluorescence),
            shown_by_nothing: share(counts.unreachable),
            no_color: counts.no_color,
            above_one: counts.of(Flaw::AboveOne),
            negative: counts.of(Flaw::Negative),
            not_a_number: counts.of(Flaw::NotANumber),
            infinite: counts.of(Flaw::Infinite),
            flaws: report.located.iter().map(FlawReport::new).collect(),
            worst: report.worst.iter().map(WorstReport::new).collect(),
            cube,
            heat_map: None,
            page: None,
        }
    }
}

impl FlawReport {
    fn new(located: &Located) -> Self {
        let Located { flaw, x, y, rgb } = *located;
        let flaw = match flaw {
            Flaw::AboveOne => "above 1",
            Flaw::Negative => "negative",
            Flaw::NotANumber => "no number",
            Flaw::Infinite => "infinite",
        };
        Self { flaw, x, y, rgb }
    }
}

impl WorstReport {
    fn new(texel: &WorstTexel) -> Self {
        Self {
            x: texel.x,
            y: texel.y,
            rgb: texel.rgb,
            needs: match texel.standing.kind {
                StandingKind::Reflectance => "reflectance",
                StandingKind::NeedsFluorescence => "fluorescence",
                StandingKind::Unreachable => "nothing shows it",
            },
            reflectance_de2000: texel.standing.reflectance.de2000,
            material_de2000: texel.standing.fluorescence.de2000,
        }
    }
}

/// Red, green and blue to four decimals: halves have no more.
fn rgb_text([r, g, b]: [f32; 3]) -> String {
    format!("{r:.4}, {g:.4}, {b:.4}")
}

impl Report for PictureReport {
    fn text(&self) -> String {
        let percent = |share: f64| format!("{:.2} %", 100.0 * share);
        let mut lines = Lines::default();
        lines
            .add("picture", format_args!("{}, {} × {}", self.file, self.width, self.height))
            .add("judged as", format_args!("{} under {}", self.rgb_space, self.illuminant))
            .add("reflectance shows", percent(self.shown_by_reflectance))
            .add("fluorescence needed", percent(self.needs_fluorescence))
            .add("nothing shows", percent(self.shown_by_nothing));
        if self.no_color > 0 {
            lines.add("no colors", format_args!("{} texels", self.no_color));
        }
        let flaws = [
            ("above 1", self.above_one),
            ("negative", self.negative),
            ("not a number", self.not_a_number),
            ("infinite", self.infinite),
        ];
        for (name, count) in flaws.into_iter().filter(|(_, count)| *count > 0) {
            lines.add(name, format_args!("{count} texels"));
        }
        for (i, flaw) in self.flaws.iter().enumerate() {
            let name = if i == 0 { "at" } else { "" };
            let rgb = rgb_text(flaw.rgb);
            let FlawReport { flaw, x, y, .. } = flaw;
            lines.add(name, format_args!("{x},{y} ({rgb}): {flaw}"));
        }
        for (i, worst) in self.worst.iter().enumerate() {
            let name = if i == 0 { "worst" } else { "" };
            let WorstReport { x, y, needs, .. } = worst;
            let rgb = rgb_text(worst.rgb);
            let (passive, any) = (worst.reflectance_de2000, worst.material_de2000);
            lines.add(
                name,
                format_args!(
                    "{x},{y} ({rgb}): {needs}; ΔE00 {passive:.1} to the nearest reflectance, \
                     {any:.1} to the nearest of all materials"
                ),
            );
        }
        if let Some(cube) = &self.cube {
            let CubeReport { file, mean_de2000, greatest_de2000, .. } = cube;
            lines.add(
                "with the cube",
                format_args!(
                    "{file}: {} within 1 ΔE00, {} within 2; mean {mean_de2000:.2}, greatest {greatest_de2000:.2}",
                    percent(cube.within_one),
                    percent(cube.within_two)
                ),
            );
        }
        for (name, path) in [("heat map", &self.heat_map), ("page", &self.page)] {
            if let Some(path) = path {
                lines.add(name, path);
            }
        }
        lines.to_string()
    }
}
