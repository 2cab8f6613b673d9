//! `upglow-study figures`: draws the figures of the paper, and our own.

use serde::Serialize;
use upglow_terminal::{Bar, Console, Failure, Report, files};

use super::failure;
use crate::args::FiguresArgs;
use crate::cubes::Cubes;
use crate::figures::{Figure, figures};
use crate::raster;

/// Pixels of the PNG per pixel of the SVG: 192 pixels per inch.
const PNG_SCALE: f32 = 2.0;

#[derive(Clone, Debug, Serialize)]
struct FiguresReport {
    folder: String,
    figures: Vec<FigureReport>,
}

#[derive(Clone, Debug, Serialize)]
struct FigureReport {
    number: u32,
    svg: String,
    png: String,
    caption: String,
}

pub(super) fn run(args: &FiguresArgs, console: &Console) -> Result<(), Failure> {
    // The folder is created later, when there is something to put in it.
    let probe =
        if args.output.is_dir() { args.output.join("figure.svg") } else { args.output.clone() };
    files::check_output(&probe)?;
    let cubes = Cubes::new(args.resolution);
    let draw = |bar: &Bar| figures(&cubes, args.only, args.display, bar);
    let drawn = console.work(args.threads, draw)?.map_err(failure)?;
    files::make_folder(&args.output)?;
    let written = drawn.iter().map(|figure| write(args, figure)).collect::<Result<Vec<_>, _>>()?;
    let folder = args.output.display().to_string();
    console.print(&FiguresReport { folder, figures: written })
}

fn write(args: &FiguresArgs, figure: &Figure) -> Result<FigureReport, Failure> {
    let [svg, png] =
        ["svg", "png"].map(|suffix| args.output.join(format!("{}.{suffix}", figure.name)));
    files::write(&svg, figure.svg.as_bytes())?;
    files::write(&png, &raster::rendered(&figure.svg, PNG_SCALE))?;
    Ok(FigureReport {
        number: figure.number,
        svg: svg.display().to_string(),
        png: png.display().to_string(),
        caption: figure.caption.clone(),
    })
}

impl Report for FiguresReport {
    fn text(&self) -> String {
        let mut text = String::new();
        for FigureReport { number, svg, caption, .. } in &self.figures {
            text += &format!("Figure {number}: {svg}\n{caption}\n\n");
        }
        text + &format!("{} figures in {}, each as SVG and PNG\n", self.figures.len(), self.folder)
    }
}
