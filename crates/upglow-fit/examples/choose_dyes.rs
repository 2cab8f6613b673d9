//! Chooses eight of the built-in dyes that match the most colors as films: greedily, then by exchanging
//! one at a time until no exchange helps. If a bright magenta or orange is then missed, the last exchange
//! is the best of those with which both are matched.
//!
//! A set is judged on the nodes of a small ACEScg cube, by the share within 1 ΔE00 under a hard limit of
//! slopes, 0.01/nm, where the sets differ most; the mean difference decides between equal shares.
//!
//! `cargo run --release -p upglow-fit --example choose_dyes`

use std::error::Error;

use upglow::{Accounting, DyeSet, FilmModel, Model, QuantumYield};
use upglow_color::{Contract, LinearRgb, MeasuredDye};
use upglow_fit::{CubeSummary, FitOptions, Fitter, Preset, Unwatched, build_cube};

const DYES: usize = 8;
const RESOLUTION: usize = 13;

fn main() -> Result<(), Box<dyn Error>> {
    let names: Vec<String> = MeasuredDye::all().map(|dye| dye.name).collect();
    let all: Vec<&str> = names.iter().map(String::as_str).collect();
    let mut chosen: Vec<&str> = Vec::new();
    let mut best = f64::NEG_INFINITY;
    while chosen.len() < DYES {
        let (score, dye) = best_of(&all, &chosen)?;
        chosen.push(dye);
        best = score;
        println!("{score:.3} with {}", chosen.join(", "));
    }
    let mut since_exchange = 0;
    while since_exchange < DYES {
        let rest = &chosen[1..];
        let (score, dye) = best_of(&all, rest)?;
        let exchanged = score > best && dye != chosen[0];
        let dye = if exchanged { dye } else { chosen[0] };
        since_exchange = if exchanged { 1 } else { since_exchange + 1 };
        chosen = [rest, &[dye]].concat();
        if exchanged {
            best = score;
            println!("{score:.3} with {}", chosen.join(", "));
        }
    }
    if !glows(&chosen)? {
        let mut last = (f64::NEG_INFINITY, chosen.clone());
        for (place, dye) in (0..DYES).flat_map(|place| all.iter().map(move |dye| (place, *dye))) {
            let mut exchanged = chosen.clone();
            exchanged[place] = dye;
            if !chosen.contains(&dye) && glows(&exchanged)? {
                let score = score(&exchanged)?;
                if score > last.0 {
                    last = (score, exchanged);
                }
            }
        }
        println!("{:.3} with {}", last.0, last.1.join(", "));
    }
    Ok(())
}

/// Whether films of these dyes match two bright colors by the rule of the preset `natural`.
fn glows(names: &[&str]) -> Result<bool, Box<dyn Error>> {
    let film = FilmModel::new(set(names)?, Accounting::Photon, QuantumYield::Fixed(1.0))?;
    let options = Preset::Natural.options();
    let fitter = Fitter::new(&Contract::default(), &Model::Film(film), options)?;
    let magenta = fitter.fit(LinearRgb([0.9, 0.0, 0.9]))?;
    let orange = fitter.fit(LinearRgb([1.58, 0.34, 0.05]))?;
    Ok(magenta.de2000.max(orange.de2000) <= CubeSummary::EXACT_DE2000)
}

fn set(names: &[&str]) -> Result<DyeSet, Box<dyn Error>> {
    let dyes = names.iter().filter_map(|name| MeasuredDye::named(name)).collect();
    Ok(DyeSet::new("candidates", dyes)?)
}

/// The dye that makes the best set with some others, and the set's score.
fn best_of<'d>(all: &[&'d str], others: &[&str]) -> Result<(f64, &'d str), Box<dyn Error>> {
    let mut best = (f64::NEG_INFINITY, all[0]);
    for dye in all.iter().filter(|dye| !others.contains(dye)) {
        let score = score(&[others, &[dye]].concat())?;
        if score > best.0 {
            best = (score, dye);
        }
    }
    Ok(best)
}

/// Percent of the nodes within 1 ΔE00, less a hundredth of the mean difference.
fn score(names: &[&str]) -> Result<f64, Box<dyn Error>> {
    let film = FilmModel::new(set(names)?, Accounting::Energy, QuantumYield::Fixed(1.0))?;
    let options = FitOptions {
        slope_max_per_nm: Some(0.01),
        slope_under_dyes_per_nm: Some(0.01),
        relaxed: false,
        sweeps: 1,
        ..Preset::Natural.options()
    };
    let cube =
        build_cube(&Contract::default(), &Model::Film(film), options, RESOLUTION, &Unwatched)?;
    let CubeSummary { within_1, nodes, mean_de2000, .. } = CubeSummary::of(&cube);
    Ok(100.0 * within_1 as f64 / nodes as f64 - 0.01 * mean_de2000)
}
