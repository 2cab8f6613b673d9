//! Whether materials fitted to a color look like a measured fluorescent material of that color under other
//! lights.

use upglow::{Mixing, Model};
use upglow_color::Metric;
use upglow_fit::{FitOptions, Method};
use upglow_study::konig2020;

use super::{ANALYTIC_WIDTHS, Claim, Number, Verdict};
use crate::lights::smooth_lights;
use crate::relight::{LitSet, Relit};
use crate::samples::{Sample, SampleSet};
use crate::spread::Spread;
use crate::ways::OneColor;

pub(super) fn claim(measured: &[Sample]) -> Claim {
    let claim = Claim {
        id: "dyes-are-more-realistic",
        section: "5.2",
        statement: "Measured dyes make fluorescence more realistic than the analytic model does",
        measure: "nothing",
        numbers: Vec::new(),
        verdict: Verdict::CannotBeJudged,
        why: "No measured materials were given: `--bispectral FOLDER` compares with the matrices in \
              a folder.",
    };
    if measured.is_empty() { claim } else { judged(claim, measured) }
}

fn judged(claim: Claim, measured: &[Sample]) -> Claim {
    let analytic = |fwhm_nm| Model::Analytic(konig2020::analytic(fwhm_nm));
    let dyes = Model::Dyes(konig2020::dyes(Mixing::Pooled));
    let usual = konig2020::options(Metric::De2000, konig2020::SWEEPS);
    let ours = FitOptions { method: Method::Search, ..usual };
    let reflectance = Differences::of(&Model::Reflectance, usual, measured);
    let by_search = Differences::of(&dyes, ours, measured);
    let dyes = Differences::of(&dyes, usual, measured);
    let our_width = Differences::of(&analytic(konig2020::ANALYTIC_FWHM_NM), usual, measured);
    let by_width = ANALYTIC_WIDTHS
        .map(|(fwhm_nm, name)| (name, Differences::of(&analytic(fwhm_nm), usual, measured)));
    let all = 0..measured.len();
    let de2000 = |name, value| Number::new(name, value, "ΔE00", 2);
    let others = |found: &Differences| mean(&found.others, all.clone());
    let d65 = |found: &Differences| mean(&found.d65, all.clone());
    let nearer = all.clone().filter(|&i| dyes.others[i] < our_width.others[i]).count();
    let mut numbers = vec![
        de2000("reflectance alone", others(&reflectance)),
        de2000("dyes", others(&dyes)),
        de2000("dyes, our own search", others(&by_search)),
    ];
    numbers.extend(by_width.iter().map(|(name, found)| de2000(name, others(found))));
    numbers.extend([
        de2000("under D65, reflectance alone", d65(&reflectance)),
        de2000("under D65, dyes", d65(&dyes)),
        de2000("under D65, dyes, our own search", d65(&by_search)),
        de2000("under D65, 50 / 45 nm", d65(&our_width)),
        Number::count("materials", measured.len()),
        Number::count("of these nearer with dyes than with 50 / 45 nm", nearer),
    ]);
    // All materials, and all but one of them: a mean of few must not hang on a single one.
    let left_out = std::iter::once(None).chain(all.clone().map(Some));
    let answers: Vec<bool> = left_out
        .filter(|left_out| left_out.is_none() || measured.len() > 1)
        .flat_map(|left_out| {
            let kept: Vec<usize> = all.clone().filter(|&i| Some(i) != left_out).collect();
            let of = |found: &Differences| mean(&found.others, kept.iter().copied());
            by_width.iter().map(|(_, found)| of(&dyes) < of(found)).collect::<Vec<_>>()
        })
        .collect();
    Claim {
        measure: "the color of each measured material under D65, fitted by the paper's method with \
                  ΔE00: alone, with dyes, and with analytic fluorescence of these widths (absorption \
                  / emission); mean ΔE00 from the measured material under A, under E and under D65 \
                  without light below 400 nm",
        numbers,
        verdict: Verdict::if_agreed(&answers),
        why: "Holds if dyes are nearer than analytic fluorescence of every width, for all materials \
              together and whichever one is left out; does not hold if they never are; cannot be \
              judged otherwise: no paper gives the widths, and of few materials a single one must not \
              decide. What a model misses under D65 it misses under the other lights too.",
        ..claim
    }
}

/// The mean of the values at these indices.
fn mean(values: &[f64], at: impl Iterator<Item = usize>) -> f64 {
    Spread::of(at.map(|i| values[i])).mean
}

/// ΔE00 between measured materials and those fitted to their colors, in the order of the materials.
#[derive(Clone, Debug)]
struct Differences {
    /// Under D65, which the materials are fitted under.
    d65: Vec<f64>,
    /// Mean under the other lights.
    others: Vec<f64>,
}

impl Differences {
    fn of(model: &Model, options: FitOptions, measured: &[Sample]) -> Self {
        let way = OneColor::try_new(model.name(), &konig2020::contract(), model, options)
            .expect("the options are in range");
        let (set, lights) = (SampleSet::fluorescent(measured), smooth_lights());
        let relit = Relit::of(&LitSet::new(&set, &lights), &way);
        Self { others: relit.means(0..lights.len()), d65: relit.under(0) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use upglow_color::{BispectralUnit, DonaldsonMatrix};

    /// A material that reflects half of all light, and moves some of it from 400 nm to 500 nm.
    fn half(moved: f64) -> Sample {
        let nm: Vec<f64> = (30..=78).map(|tens| f64::from(10 * tens)).collect();
        let factor = |o: f64, i: f64| match (i, o) {
            _ if i == o => 0.5,
            (400.0, 500.0) => moved,
            _ => 0.0,
        };
        let rows = nm.iter().map(|&o| nm.iter().map(|&i| factor(o, i)).collect()).collect();
        let unit = BispectralUnit::PerBand;
        let matrix = DonaldsonMatrix::try_new(nm.clone(), nm, rows, unit).unwrap();
        Sample::try_new("half".into(), matrix).unwrap()
    }

    fn of_reflectance(moved: f64) -> Differences {
        let options = konig2020::options(Metric::De2000, konig2020::SWEEPS);
        Differences::of(&Model::Reflectance, options, &[half(moved)])
    }

    #[test]
    fn without_measurements_nothing_is_judged() {
        assert_eq!(claim(&[]).verdict, Verdict::CannotBeJudged);
    }

    /// The color is fitted within this, ΔE00.
    const MATCHED: f64 = 0.01;

    #[test]
    fn a_gray_without_fluorescence_looks_the_same_under_every_light() {
        let found = of_reflectance(0.0);
        assert!(found.d65[0] < MATCHED && found.others[0] < MATCHED, "{found:?}");
    }

    #[test]
    fn fluorescence_looks_different_without_the_light_that_excites_it() {
        let found = of_reflectance(0.5);
        assert!(found.others[0] > 1.0, "{found:?}");
    }
}
