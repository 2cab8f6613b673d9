//! `upglow inspect` for coefficient tables of any program.

use std::io::Read as _;
use std::path::Path;

use serde::Serialize;
use upglow::{CoefficientTable, open_input, read_input};
use upglow_color::Contract;
use upglow_fit::round_trip;
use upglow_terminal::{Console, Failure, Report};

use crate::args::InspectArgs;
use crate::output::Lines;
use crate::plan;

/// Number and seed of the random colors of the round trip.
const POINTS: usize = 10_000;
const SEED: u64 = 0;

#[derive(Debug, Serialize)]
struct TableReport {
    file: String,
    bytes: u64,
    resolution: usize,
    /// Whether it ends with weights that integrate a reflectance, as rgb2spec requires since 2026.
    integrator: bool,
    rgb_space: String,
    illuminant: String,
    points: usize,
    mean_de2000: f64,
    p95_de2000: f64,
    max_de2000: f64,
}

/// Whether a file starts with the magic number of coefficient tables.
pub(super) fn is_table(path: &Path) -> bool {
    let mut start = [0; 4];
    open_input(path).and_then(|mut file| file.read_exact(&mut start)).is_ok() && &start == b"SPEC"
}

pub(super) fn run(args: InspectArgs, console: &Console) -> Result<(), Failure> {
    let Some(space) = args.space else {
        let message = "not given, expected the RGB space of the table, which does not name it";
        return Err(Failure::option("--space", message));
    };
    let given: Vec<&str> = args.illuminant.as_deref().into_iter().collect();
    let mut given = plan::lights("--illuminant", &given, &args.light)?;
    let illuminant = given.pop().unwrap_or_default();
    let contract = plan::checked(Contract { space, illuminant, ..Contract::default() })?;
    let bytes = read_input(&args.file, CoefficientTable::MOST_BYTES)
        .map_err(|error| Failure::system(&args.file, &error, "a coefficient table"))?;
    let table = CoefficientTable::from_bytes(&bytes);
    let table = table.map_err(|error| Failure::file(&args.file, error))?;
    let spread = round_trip(&table, &contract, POINTS, SEED);
    console.print(&TableReport {
        file: args.file.display().to_string(),
        bytes: bytes.len() as u64,
        resolution: table.resolution(),
        integrator: table.has_integrator(),
        rgb_space: contract.space.name().into(),
        illuminant: contract.illuminant.name().into(),
        points: POINTS,
        mean_de2000: spread.mean,
        p95_de2000: spread.p95,
        max_de2000: spread.max,
    })
}

impl Report for TableReport {
    fn text(&self) -> String {
        let Self { resolution, points, mean_de2000, p95_de2000, max_de2000, .. } = self;
        let mut lines = Lines::default();
        lines
            .add_file("file", &self.file, self.bytes)
            .add("kind", "coefficient table, reflectance only")
            .add("resolution", format_args!("3 × {resolution} × {resolution} × {resolution}"))
            .add("integrator", if self.integrator { "yes" } else { "no" })
            .add("interpreted as", format_args!("{} under {}", self.rgb_space, self.illuminant))
            .add("round trip", format_args!("{points} random colors"))
            .add("mean ΔE00", format_args!("{mean_de2000:.4}"))
            .add("95 % within", format_args!("{p95_de2000:.4}"))
            .add("greatest", format_args!("{max_de2000:.2}"));
        lines.to_string()
    }
}
