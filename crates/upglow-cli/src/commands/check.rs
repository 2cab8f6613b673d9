//! `upglow check`: what pictures ask of materials.

use std::path::{Path, PathBuf};

use serde::Serialize;
use upglow::Cube;
use upglow_color::{Contract, StandingKind};
use upglow_fit::{Progress, Watch};
use upglow_image::{
    CheckReport, CheckedPicture, CubeOpinion, Judge, LinearPicture, Located, WorstTexel, check_page,
};
use upglow_terminal::{Bar, Console, Failure, Report, check_stopped};

use super::bake::picture_failure;
use crate::args::CheckArgs;
use crate::output::Lines;
use crate::{files, pictures, plan};

/// Rows that are read at a time: enough to keep every core busy.
const BAND_ROWS: usize = 64;

#[derive(Debug, Serialize)]
struct PictureReport<'a> {
    file: &'a str,
    width: usize,
    height: usize,
    rgb_space: &'a str,
    illuminant: &'a str,
    texels: u64,
    shown_by_reflectance: f64,
    needs_fluorescence: f64,
    shown_by_nothing: f64,
    no_color: u64,
    above_one: u64,
    negative: u64,
    not_a_number: u64,
    infinite: u64,
    /// The first texels of each flaw. JSON has `null` for what it has no number for.
    flaws: &'a [Located],
    worst: Vec<WorstReport>,
    cube: Option<CubeReport<'a>>,
    heat_map: Option<String>,
    /// The page that all pictures are on.
    page: Option<String>,
}

#[derive(Debug, Serialize)]
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

#[derive(Debug, Serialize)]
struct CubeReport<'a> {
    file: &'a str,
    #[serde(flatten)]
    opinion: CubeOpinion,
}

pub(crate) fn run(args: &CheckArgs, console: &Console) -> Result<(), Failure> {
    let inputs = pictures::find(&args.inputs)?;
    check_outputs(args, &inputs)?;
    let cube = args.cube.as_deref().map(files::read_cube).transpose()?;
    let contract = contract(args, cube.as_ref())?;
    let mut judges = Judges { contract: &contract, cube: cube.as_ref(), known: Vec::new() };
    let mut found = Vec::new();
    for input in &inputs {
        found.push(console.work(args.threads, |bar| check(input, args, &mut judges, bar))??);
    }
    let names: Vec<String> = inputs.iter().map(|input| input.display().to_string()).collect();
    let cube_name = args.cube.as_ref().map(|path| path.display().to_string());
    let light = contract.illuminant.name();
    let checked = names.iter().zip(&found).map(|(name, (space, report))| CheckedPicture {
        name,
        space,
        light,
        cube: cube_name.as_deref(),
        report,
    });
    let checked: Vec<CheckedPicture<'_>> = checked.collect();
    if let Some(output) = &args.output {
        files::write(output, check_page(&checked).as_bytes())?;
    }
    if let (Some(path), [(_, report)]) = (&args.heat_map, &found[..]) {
        files::write(path, &report.heat.to_png())?;
    }
    checked.iter().try_for_each(|picture| console.print(&PictureReport::new(picture, args)))
}

fn check_outputs(args: &CheckArgs, inputs: &[PathBuf]) -> Result<(), Failure> {
    if args.heat_map.is_some() && inputs.len() != 1 {
        let message = format!(
            "given with {} pictures, expected one; --output has all heat maps",
            inputs.len()
        );
        return Err(Failure::option("--heat-map", message));
    }
    let mut outputs = args.output.iter().chain(&args.heat_map);
    outputs.try_for_each(|output| files::check_output_of(output, args.cube.as_deref(), inputs))
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
    plan::checked(contract)
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
    args: &CheckArgs,
    judges: &mut Judges<'_>,
    bar: &Bar,
) -> Result<(String, CheckReport), Failure> {
    let open = LinearPicture::open(input, &args.picture.assumed());
    let mut picture = open.map_err(|error| picture_failure(error, input))?;
    let (contract, judge) = judges.of(&picture)?;
    picture.convert_to(contract);
    let [width, height] = picture.picture().size();
    let faulty = |error| Failure::file(input, error);
    let mut checker = judge.checker(width, height).map_err(faulty)?;
    let unread = |error| Failure::file(input, error);
    while let Some(band) = picture.read_band(BAND_ROWS).map_err(unread)? {
        check_stopped()?;
        checker.add(band.first_row, &band.rgb).map_err(faulty)?;
        let done = band.first_row + band.rows();
        bar.progress(Progress { stage: "checking", done, total: height });
    }
    let report = checker.finish().map_err(faulty)?;
    Ok((contract.space.name().to_owned(), report))
}

impl<'a> PictureReport<'a> {
    fn new(picture: &CheckedPicture<'a>, args: &CheckArgs) -> Self {
        let report = picture.report;
        let counts = report.counts;
        let share = |count: u64| count as f64 / counts.texels as f64;
        let shown = |path: &Option<PathBuf>| path.as_ref().map(|path| path.display().to_string());
        let opinion = report.cube.zip(picture.cube);
        Self {
            file: picture.name,
            width: report.width,
            height: report.height,
            rgb_space: picture.space,
            illuminant: picture.light,
            texels: counts.texels,
            shown_by_reflectance: share(counts.reflectance),
            needs_fluorescence: share(counts.needs_fluorescence),
            shown_by_nothing: share(counts.unreachable),
            no_color: counts.no_color,
            above_one: counts.above_one,
            negative: counts.negative,
            not_a_number: counts.not_a_number,
            infinite: counts.infinite,
            flaws: &report.located,
            worst: report.worst.iter().map(WorstReport::from).collect(),
            cube: opinion.map(|(opinion, file)| CubeReport { file, opinion }),
            heat_map: shown(&args.heat_map),
            page: shown(&args.output),
        }
    }
}

impl From<&WorstTexel> for WorstReport {
    fn from(texel: &WorstTexel) -> Self {
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

impl Report for PictureReport<'_> {
    fn text(&self) -> String {
        let percent = |share: f64| format!("{:.2} %", 100.0 * share);
        let mut lines = Lines::default();
        lines
            .add("picture", format_args!("{}, {} × {}", self.file, self.width, self.height))
            .add("judged as", format_args!("{} under {}", self.rgb_space, self.illuminant))
            .add("reflectance shows", percent(self.shown_by_reflectance))
            .add("fluorescence needed", percent(self.needs_fluorescence))
            .add("nothing shows", percent(self.shown_by_nothing));
        let counts = [
            ("no colors", self.no_color),
            ("above 1", self.above_one),
            ("negative", self.negative),
            ("not a number", self.not_a_number),
            ("infinite", self.infinite),
        ];
        for (name, count) in counts.into_iter().filter(|(_, count)| *count > 0) {
            lines.add(name, format_args!("{count} texels"));
        }
        for (i, Located { flaw, x, y, rgb }) in self.flaws.iter().enumerate() {
            let name = if i == 0 { "at" } else { "" };
            lines.add(name, format_args!("{x},{y} ({}): {flaw}", rgb_text(*rgb)));
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
        if let Some(CubeReport { file, opinion }) = &self.cube {
            lines.add(
                "with the cube",
                format_args!(
                    "{file}: {} within 1 ΔE00, {} within 2; mean {:.2}, greatest {:.2}",
                    percent(opinion.within_one),
                    percent(opinion.within_two),
                    opinion.mean,
                    opinion.greatest,
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
