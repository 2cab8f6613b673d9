//! What the interpolation of shift, width and slope does, and what corrects its errors.

use std::ops::RangeInclusive;

use upglow::{Features, Interpolation};
use upglow_study::Mixing;

use super::between::{Center, Kind, centers, misses};
use super::paths::{Ends, PathSpreads, path_spreads, random_pairs};
use super::{Claim, Fields, Number, Verdict};
use crate::field::Field;
use crate::spread::Spread;

pub(super) fn claims(fields: &Fields) -> Vec<Claim> {
    let field = &fields.features;
    let centers = centers(field);
    vec![
        near_the_spectrum(field),
        meaningful(field),
        works_with_one_sign(field, &centers),
        fails_at_flips(field, &centers),
        fails_at_grays(field, &centers),
        hybrid(field, &centers),
    ]
}

/// The pairs of which the paper may speak: all, and those of peaks like the two in its figure 5.
fn pairs_of_both_kinds(field: &Field) -> [Vec<Ends>; 2] {
    let is_visible_peak = |found: &Features| {
        let Features { shift_nm, width_nm, slope_per_nm } = *found;
        slope_per_nm < 0.0
            && [shift_nm - width_nm, shift_nm + width_nm].iter().all(|nm| VISIBLE_NM.contains(nm))
    };
    [random_pairs(field, |_| true), random_pairs(field, is_visible_peak)]
}

/// Wavelengths that are visible, nm. A narrower range would leave out peaks at its ends, a wider one would
/// include reflectances that look like an edge.
const VISIBLE_NM: RangeInclusive<f64> = 380.0..=780.0;

fn near_the_spectrum(field: &Field) -> Claim {
    let pairs = pairs_of_both_kinds(field);
    let [all, peaks] = pairs.each_ref().map(|pairs| {
        [Mixing::Coefficients, Mixing::Features]
            .map(|mixing| path_spreads(field.sums(), pairs, mixing).from_spectrum)
    });
    let nearer = |[coefficients, features]: [Spread; 2]| {
        [features.median < coefficients.median, features.mean < coefficients.mean]
    };
    Claim {
        id: "features-near-the-spectrum",
        section: "4.3, figure 5",
        statement: "Interpolating the features comes nearer to the interpolated spectra than \
                    interpolating the coefficients",
        measure: "greatest ΔE00 from the interpolated spectra at the weights ¼, ½ and ¾, between \
                  random pairs of bright, saturated reflectances whose slopes have the same sign: all \
                  such pairs, and those of two peaks as in figure 5: negative slopes, steepest points \
                  from 380 to 780 nm",
        numbers: vec![
            Number::new("coefficients, median", all[0].median, "ΔE00", 2),
            Number::new("features, median", all[1].median, "ΔE00", 2),
            Number::new("coefficients, mean", all[0].mean, "ΔE00", 2),
            Number::new("features, mean", all[1].mean, "ΔE00", 2),
            Number::count("pairs", pairs[0].len()),
            Number::new("peaks, coefficients, median", peaks[0].median, "ΔE00", 2),
            Number::new("peaks, features, median", peaks[1].median, "ΔE00", 2),
            Number::new("peaks, coefficients, mean", peaks[0].mean, "ΔE00", 2),
            Number::new("peaks, features, mean", peaks[1].mean, "ΔE00", 2),
            Number::count("pairs of peaks", pairs[1].len()),
        ],
        verdict: Verdict::if_agreed(&[nearer(all), nearer(peaks)].concat()),
        why: "Holds if median and mean are lower for features between both kinds of pairs, does not \
              hold if they are higher between both, and cannot be judged otherwise: the paper shows \
              one pair of peaks and does not say of which pairs it speaks. Between peaks features come \
              nearer, between all reflectances coefficients do: many are almost straight or almost \
              an edge, with shifts and widths far outside the visible, which do not average with \
              others'.",
    }
}

fn meaningful(field: &Field) -> Claim {
    let [all, peaks] = pairs_of_both_kinds(field).map(|pairs| {
        [Mixing::Coefficients, Mixing::Features, Mixing::Spectra]
            .map(|mixing| path_spreads(field.sums(), &pairs, mixing))
    });
    let more_even = |[coefficients, features, _]: [PathSpreads; 3]| {
        [
            features.hue_deg.median < coefficients.hue_deg.median,
            features.pace.median < coefficients.pace.median,
        ]
    };
    Claim {
        id: "features-more-meaningful",
        section: "5.3, figure 5",
        statement: "Interpolating the features gives perceptually more meaningful colors than \
                    interpolating the coefficients",
        measure: "hue: greatest deviation from an even turn, degrees; pace: longest of 16 steps \
                  over the mean step, ΔE00; detour: length of the way over the distance of its \
                  ends, CIELAB; medians over the same two kinds of pairs",
        numbers: vec![
            Number::new("hue, coefficients", all[0].hue_deg.median, "°", 1),
            Number::new("hue, features", all[1].hue_deg.median, "°", 1),
            Number::new("hue, spectra", all[2].hue_deg.median, "°", 1),
            Number::new("pace, coefficients", all[0].pace.median, "", 2),
            Number::new("pace, features", all[1].pace.median, "", 2),
            Number::new("pace, spectra", all[2].pace.median, "", 2),
            Number::new("detour, coefficients", all[0].detour.median, "", 3),
            Number::new("detour, features", all[1].detour.median, "", 3),
            Number::new("detour, spectra", all[2].detour.median, "", 3),
            Number::new("peaks, hue, coefficients", peaks[0].hue_deg.median, "°", 1),
            Number::new("peaks, hue, features", peaks[1].hue_deg.median, "°", 1),
            Number::new("peaks, pace, coefficients", peaks[0].pace.median, "", 2),
            Number::new("peaks, pace, features", peaks[1].pace.median, "", 2),
        ],
        verdict: Verdict::if_agreed(&[more_even(all), more_even(peaks)].concat()),
        why: "Holds if hue and pace are more even between both kinds of pairs, does not hold if \
              neither is between any, and cannot be judged otherwise: equal weights should make \
              equal steps, but the paper does not say what is meaningful, nor of which pairs. The \
              detour is no part of it: hues that change evenly go around gray, not straight through \
              it.",
    }
}

fn works_with_one_sign(field: &Field, centers: &[Center]) -> Claim {
    let [features, coefficients] = [Interpolation::Features, Interpolation::Coefficients]
        .map(|mode| misses(field, centers, |c| c.is_vivid && c.kind == Kind::Colored, mode));
    Claim {
        id: "features-work-with-one-sign",
        section: "5.3",
        statement: "Features work well between bright, saturated colors whose slopes have one sign",
        measure: "ΔE00 from the right color at the centers of tetrahedra between matched nodes, \
                  slopes of one sign, all corners bright and saturated",
        numbers: vec![
            Number::de2000("features, median", features.median),
            Number::de2000("features, 95 %", features.p95),
            Number::de2000("coefficients, median", coefficients.median),
            Number::de2000("coefficients, 95 %", coefficients.p95),
            Number::count("centers", features.count),
        ],
        verdict: Verdict::holds_if(features.p95 <= 1.0),
        why: "Holds if 95 % are within 1 ΔE00, just visible. Coefficients come nearer all the same.",
    }
}

fn fails_at_flips(field: &Field, centers: &[Center]) -> Claim {
    let misses = |kind, mode| misses(field, centers, |center| center.kind == kind, mode);
    let features = misses(Kind::Flip, Interpolation::Features);
    let coefficients = misses(Kind::Flip, Interpolation::Coefficients);
    let one_sign = misses(Kind::Colored, Interpolation::Features);
    Claim {
        id: "features-fail-at-sign-flips",
        section: "5.3, figure 8b",
        statement: "Where slopes change sign, interpolated features produce artifacts",
        measure: "ΔE00 from the right color at the centers of tetrahedra between matched nodes, \
                  slopes of both signs",
        numbers: vec![
            Number::de2000("features, mean", features.mean),
            Number::de2000("features, 95 %", features.p95),
            Number::de2000("coefficients, mean", coefficients.mean),
            Number::de2000("features at one sign, mean", one_sign.mean),
            Number::count("centers", features.count),
        ],
        verdict: Verdict::holds_if(
            features.mean > 1.0 && features.mean > 2.0 * one_sign.mean.max(coefficients.mean),
        ),
        why: "Holds if the mean is visible and at least twice that of coefficients there, and of \
              features at one sign. A mean of slopes of both signs is near zero, and a reflectance \
              of that slope is white or black.",
    }
}

fn fails_at_grays(field: &Field, centers: &[Center]) -> Claim {
    let misses = |kind, mode| misses(field, centers, |center| center.kind == kind, mode);
    let gray = misses(Kind::Gray, Interpolation::Features);
    let colored = misses(Kind::Colored, Interpolation::Features);
    let coefficients = misses(Kind::Gray, Interpolation::Coefficients);
    Claim {
        id: "features-fail-at-grays",
        section: "4.3",
        statement: "Near gray, interpolated features can produce artifacts",
        measure: "ΔE00 from the right color at the centers of tetrahedra between matched nodes, \
                  slopes of one sign, a corner with C*ab ≤ 10 and none exactly gray",
        numbers: vec![
            Number::de2000("features, mean", gray.mean),
            Number::de2000("features, 95 %", gray.p95),
            Number::de2000("features away from gray, mean", colored.mean),
            Number::de2000("coefficients, mean", coefficients.mean),
            Number::count("centers", gray.count),
        ],
        verdict: Verdict::holds_if(gray.mean > 2.0 * colored.mean.max(coefficients.mean)),
        why: "Holds if the mean is at least twice that away from gray, and that of coefficients.",
    }
}

fn hybrid(field: &Field, centers: &[Center]) -> Claim {
    let [features, hybrid, blend] =
        [Interpolation::Features, Interpolation::Hybrid, Interpolation::Blend]
            .map(|mode| misses(field, centers, |center| center.kind == Kind::Flip, mode));
    Claim {
        id: "hybrid-repairs-sign-flips",
        section: "5.3, figure 8c",
        statement: "Hybrid interpolation avoids the heavy artifacts of features",
        measure: "ΔE00 from the right color at the same centers, slopes of both signs",
        numbers: vec![
            Number::de2000("features, mean", features.mean),
            Number::de2000("hybrid, mean", hybrid.mean),
            Number::de2000("features, greatest", features.max),
            Number::de2000("hybrid, greatest", hybrid.max),
            Number::de2000("blend, greatest", blend.max),
        ],
        verdict: Verdict::holds_if(2.0 * hybrid.mean <= features.mean),
        why: "Holds if hybrid at most halves the mean.",
    }
}
