//! `upglow relight`: how the materials of a cube look under lights, to observers.

use rayon::prelude::*;
use upglow::Cube;
use upglow_color::{Contract, ContractError, Illuminant, LinearRgb, Observer, Screen, Xyz};
use upglow_fit::{Appearance, MetamerSearch, Progress, Relighting, View, Watch};
use upglow_terminal::{Bar, Console, Failure, check_stopped};

use super::color::fitter_of;
use super::relight_report::{RelightReport, ViewReport};
use crate::args::RelightArgs;
use crate::color_list::{self, NamedColor};
use crate::output::{push_cell, quoted, warn_of_ultraviolet};
use crate::plot::Swatch;
use crate::plot::swatches::{self, Chart, Column};
use crate::{files, metamers, plan};

/// More would take gigabytes: each takes 150 bytes of memory and [`ROW_BYTES`] of a CSV file, twice.
const MOST_ROWS: usize = 2_000_000;

/// Space for a line of a CSV file. With less, lines are moved while they are written; more is memory in vain.
const ROW_BYTES: usize = 300;

/// Colors that are drawn, or printed as text.
pub(super) const MOST_SHOWN: usize = 64;

const HEADER: &str = "name,r,g,b,light,observer,is_adapted,x,y,z,lab_l,lab_a,lab_b,\
                      r_under,g_under,b_under,de2000,fluorescent_share,whiteness,tint,band_de2000";

pub(crate) fn run(args: &RelightArgs, console: &Console) -> Result<(), Failure> {
    let is_search = args.paint.kind.is_some() || args.band;
    args.paint.check_answer(args.paint.kind.is_some(), "--kind")?;
    let listed = listed(args)?;
    for (output, endings) in [(&args.csv, files::CSV), (&args.plot, files::SVG)] {
        if let Some(output) = output {
            files::check_ending(output, endings)?;
            files::check_output(output)?;
        }
    }
    let mut lights = plan::lights_to_see(&args.lights, &args.light)?;
    let observers = args.observers.iter().map(|text| plan::observer(text));
    let mut observers = observers.collect::<Result<Vec<_>, _>>()?;
    let cube = files::read_cube(&args.file)?;
    let Contract { illuminant: own, observer, .. } = cube.contract();
    if args.lights.is_empty() {
        lights.retain(|light| light.name() != own.name());
        lights.insert(0, own.clone());
    }
    if observers.is_empty() {
        observers.push(observer.clone());
    }
    let colors = listed.unwrap_or_else(|| nodes(&cube));
    check_rows(colors.len(), lights.len(), observers.len())?;
    let most = MetamerSearch::MOST_IN_TURN;
    if is_search && colors.len() > most {
        let message = format!(
            "{} colors, expected at most {most} with --kind or --band, which take half a second for each",
            colors.len()
        );
        return Err(Failure::Usage(message));
    }
    let search = || metamers::search(cube.contract(), &[], args.paint.kind.unwrap_or_default());
    let search = is_search.then(search).transpose()?;
    let seen = console.work(args.threads, |bar| {
        let relighting = match &search {
            Some(search) => searched(&cube, &colors, args, search, bar)?,
            None => relighting(&cube, &colors, args)?,
        };
        let views = views(&relighting, &lights, &observers)?;
        let csv = args.csv.as_ref().map(|_| csv(&colors, &views));
        Ok::<_, Failure>((views, csv))
    })?;
    let (views, csv) = seen?;
    if let (Some(path), Some(text)) = (&args.csv, &csv) {
        files::write(path, text)?;
    }
    if let Some(path) = &args.plot {
        files::write(path, swatches::draw(&chart(&cube, &colors, &views, args)).as_bytes())?;
    }
    console.print(&RelightReport {
        file: args.file.display().to_string(),
        rgb_space: cube.contract().space.name(),
        illuminant: own.name(),
        adaptation: cube.contract().adaptation,
        colors: &colors,
        views: &views,
        csv: args.csv.as_ref().map(|path| path.display().to_string()),
        plot: args.plot.as_ref().map(|path| path.display().to_string()),
    })
}

/// Whether colors need not be within the cube.
fn is_fitted(args: &RelightArgs) -> bool {
    args.direct || args.paint.kind.is_some()
}

/// The colors that were given; `None` for all nodes.
fn listed(args: &RelightArgs) -> Result<Option<Vec<NamedColor>>, Failure> {
    match (&args.red, &args.green, &args.blue, &args.colors) {
        (Some(red), Some(green), Some(blue), _) => {
            let rgb = plan::color([red, green, blue], is_fitted(args))?;
            Ok(Some(vec![NamedColor { name: String::new(), rgb }]))
        }
        (.., Some(list)) => color_list::read(list, is_fitted(args)).map(Some),
        _ if args.nodes => Ok(None),
        _ => {
            let message = "not given, expected R G B, --colors FILE.csv or --nodes";
            Err(Failure::Usage(format!("colors: {message}")))
        }
    }
}

fn nodes(cube: &Cube) -> Vec<NamedColor> {
    let node = |i| NamedColor { name: String::new(), rgb: cube.node_rgb(i) };
    (0..cube.nodes().len()).map(node).collect()
}

fn check_rows(colors: usize, lights: usize, observers: usize) -> Result<(), Failure> {
    let rows = colors.saturating_mul(lights).saturating_mul(observers);
    if rows <= MOST_ROWS {
        return Ok(());
    }
    let message = format!(
        "{colors} colors under {lights} lights for {observers} observers are {rows} rows, \
         expected at most {MOST_ROWS}"
    );
    Err(Failure::Usage(message))
}

fn relighting<'c>(
    cube: &'c Cube,
    colors: &[NamedColor],
    args: &RelightArgs,
) -> Result<Relighting<'c>, Failure> {
    if args.nodes {
        return Ok(Relighting::of_nodes(cube));
    }
    if args.direct {
        let fitter = fitter_of(cube, &args.file)?;
        let fits = colors.par_iter().map(|color| {
            check_stopped()?;
            let fit = fitter.fit(color.rgb).map_err(|error| Failure::input("R G B", error))?;
            Ok::<_, Failure>(fit.material())
        });
        let materials = fits.collect::<Result<Vec<_>, Failure>>()?;
        return Ok(Relighting::of_materials(cube, materials));
    }
    let rgb: Vec<LinearRgb> = colors.iter().map(|color| color.rgb).collect();
    Relighting::of_colors(cube, &rgb).map_err(|error| Failure::input("R G B", error))
}

/// All materials that may have the colors, and the answers to be seen: the best of them, or what the cube gives.
fn searched<'c>(
    cube: &'c Cube,
    colors: &[NamedColor],
    args: &RelightArgs,
    search: &MetamerSearch,
    bar: &Bar,
) -> Result<Relighting<'c>, Failure> {
    let contract = cube.contract();
    let mut metamers = Vec::with_capacity(colors.len());
    for (done, color) in colors.iter().enumerate() {
        check_stopped()?;
        bar.progress(Progress { stage: "searching materials", done, total: colors.len() });
        metamers.push(search.of_rgb(&[color.rgb]).map_err(metamers::refused)?);
    }
    let answers = if args.paint.kind.is_some() {
        let answer = |found| metamers::answer(found, &args.paint);
        let answers = metamers.iter().map(answer).collect::<Result<Vec<_>, _>>()?;
        Relighting::of_own_materials(contract, answers)
    } else {
        relighting(cube, colors, args)?
    };
    Ok(answers.with_metamers(metamers))
}

/// Each light for each observer.
fn views(
    relighting: &Relighting<'_>,
    lights: &[Illuminant],
    observers: &[Observer],
) -> Result<Vec<ViewReport>, Failure> {
    let missing = lights.iter().map(|light| relighting.missing_ultraviolet(light));
    let missing: Vec<Option<String>> = missing.map(warn_of_ultraviolet).collect();
    let mut views = Vec::new();
    for observer in observers {
        let refused = |error: ContractError| Failure::option("--observer", error);
        let seen_by = relighting.seen_by(observer).map_err(refused)?;
        for (light, missing) in lights.iter().zip(&missing) {
            check_stopped()?;
            let View { seen, appearances } = seen_by.under(light);
            views.push(ViewReport {
                light: light.name().into(),
                observer: observer.name().into(),
                is_adapted: seen.is_adapted,
                white: seen.white,
                missing_ultraviolet: missing.clone(),
                swatches: swatches_of(seen.white, &appearances),
                appearances,
            });
        }
    }
    Ok(views)
}

/// The first colors as a screen shows them, of which `white` is the white.
fn swatches_of(white: Xyz, appearances: &[Appearance]) -> Vec<Swatch> {
    let screen = Screen::srgb(white);
    let shown = appearances.iter().take(MOST_SHOWN);
    shown.map(|seen| Swatch::of(screen.within(seen.xyz))).collect()
}

/// A line for each color under each light, light by light. Numbers have as many digits as are needed to read them
/// back exactly; cells of what is not defined are empty.
fn csv(colors: &[NamedColor], views: &[ViewReport]) -> Vec<u8> {
    // The same under every light.
    let start = |NamedColor { name, rgb: LinearRgb(rgb) }: &NamedColor| {
        let mut text = quoted(name).into_bytes();
        rgb.iter().for_each(|&value| push_cell(&mut text, value));
        text
    };
    let starts: Vec<Vec<u8>> = colors.par_iter().map(start).collect();
    let block = |view: &ViewReport| {
        let (light, observer) = (quoted(&view.light), quoted(&view.observer));
        let of_view = format!(",{light},{observer},{}", view.is_adapted);
        let mut text = Vec::with_capacity(ROW_BYTES * colors.len());
        for (start, seen) in starts.iter().zip(&view.appearances) {
            text.extend_from_slice(start);
            text.extend_from_slice(of_view.as_bytes());
            let Appearance { xyz: Xyz([x, y, z]), lab, rgb: LinearRgb([r, g, b]), .. } = *seen;
            for value in [x, y, z, lab.l, lab.a, lab.b, r, g, b] {
                push_cell(&mut text, value);
            }
            let whiteness = [seen.whiteness.map(|w| w.whiteness), seen.whiteness.map(|w| w.tint)];
            let maybe = [seen.de2000, seen.fluorescent_share].into_iter().chain(whiteness);
            let maybe = maybe.chain([seen.band_de2000]);
            maybe.for_each(|value| push_cell(&mut text, value.unwrap_or(f64::NAN)));
            text.push(b'\n');
        }
        text
    };
    let header = format!("{HEADER}\n").into_bytes();
    let blocks = views.par_iter().map(block);
    rayon::iter::once(header).chain(blocks).collect::<Vec<_>>().concat()
}

fn chart(cube: &Cube, colors: &[NamedColor], views: &[ViewReport], args: &RelightArgs) -> Chart {
    let own = cube.contract().illuminant.name();
    let names_observers = args.observers.len() > 1;
    let column = |view: &ViewReport| {
        let mut head = vec![view.light.clone()];
        if names_observers {
            head.push(view.observer.clone());
        }
        if !view.is_adapted {
            head.push(format!("seen from {own}"));
        }
        Column { head, swatches: view.swatches.clone() }
    };
    let all = colors.len();
    let some = (all > MOST_SHOWN).then(|| format!("The first {MOST_SHOWN} of {all} colors."));
    let observer = views.first().filter(|_| !names_observers).map(|view| view.observer.as_str());
    let seen_by = observer.map(|name| format!(" for {name}")).unwrap_or_default();
    let adapted = "Each light is shown with its own white as the white of the screen, but for lights that nobody \
                   can adapt to.";
    Chart {
        title: format!("{}{seen_by}", args.file.display()),
        rows: colors.iter().take(MOST_SHOWN).map(NamedColor::label).collect(),
        columns: views.iter().map(column).collect(),
        notes: some.into_iter().chain([adapted.to_owned()]).collect(),
    }
}
