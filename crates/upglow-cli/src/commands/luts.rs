//! Tables of the nearest colors that materials show, for color management.

use upglow::Cube;
use upglow_fit::{MaterialSet, NearestColors, ReachView};
use upglow_shader::{Lut, LutFormat, LutLattice};
use upglow_terminal::{Console, Failure};

use crate::args::ExportArgs;

/// Entries along an axis, unless a cube's own nodes are enough. Half as many leave ten times as many colors more than
/// 0.5 ΔE00 off; twice as many take eight times as long and as much room.
const RESOLUTION: usize = 65;

/// The file, and how many entries it has.
pub(super) fn lut(
    args: &ExportArgs,
    cube: &Cube,
    format: LutFormat,
    console: &Console,
) -> Result<(Vec<u8>, usize), Failure> {
    let (set, view) = (args.target.unwrap_or_default(), args.show.unwrap_or_default());
    let lattice = |range: [f64; 2]| {
        let resolution = |usual| args.resolution.unwrap_or(usual);
        // Between the nodes of a cube its colors are interpolated as a LUT's are.
        match (set, view) {
            (MaterialSet::Cube, ReachView::Nearest) => {
                LutLattice::unit(format, resolution(cube.resolution()))
            }
            _ => LutLattice::around(format, resolution(RESOLUTION), range),
        }
    };
    let (lattice, colors) = console.work(args.threads, |bar| {
        let nearest = NearestColors::new(cube, set);
        let lattice = lattice(nearest.range());
        let lattice = lattice.map_err(|error| Failure::option("--resolution", error))?;
        let colors = nearest.seen_of_all(&lattice.colors(), view, bar);
        Ok::<_, Failure>((lattice, colors.map_err(|_| Failure::Stopped)?))
    })??;
    let text = Lut::new(lattice, &colors).text(title(set, view), &about(args, cube, lattice));
    Ok((text.into_bytes(), colors.len()))
}

fn title(set: MaterialSet, view: ReachView) -> &'static str {
    match (view, set) {
        (ReachView::Nearest, MaterialSet::Cube) => "nearest colors of a cube",
        (ReachView::Nearest, MaterialSet::Reflectance) => "nearest colors of reflectances",
        (ReachView::Nearest, MaterialSet::Any) => "nearest colors of any material",
        (ReachView::OutOfReach, MaterialSet::Cube) => "out of reach of a cube",
        (ReachView::OutOfReach, MaterialSet::Reflectance) => "out of reach of reflectances",
        (ReachView::OutOfReach, MaterialSet::Any) => "out of reach of any material",
    }
}

/// What made the table, and what its numbers mean.
fn about(args: &ExportArgs, cube: &Cube, lattice: LutLattice) -> Vec<String> {
    let contract = cube.contract();
    let [least, most] = lattice.range();
    let file = args.file.file_name().unwrap_or_default().to_string_lossy();
    vec![
        format!("Cube: {file}"),
        format!(
            "Input and output: linear {} under {}, observer {}, adaptation {}",
            contract.space.name(),
            contract.illuminant.name(),
            contract.observer.name(),
            contract.adaptation
        ),
        format!("Channels are clamped to {least:.4}..{most:.4}"),
    ]
}
