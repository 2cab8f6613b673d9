//! What the interpolation of shift, width and slope does, and what corrects its errors.

use upglow::{Features, Interpolation};
use upglow_color::ciede2000;
use upglow_study::Mixing;

use super::between::{Center, Kind, centers, misses};
use super::paths::{color, lab, path_spreads, random_pairs};
use super::{Claim, Fields, Number, Verdict};
use crate::field::Field;

pub(super) fn claims(fields: &Fields) -> Vec<Claim> {
    let field = &fields.features;
    let centers = centers(field);
    vec![
        near_the_spectrum(field),
        meaningful(field),
        works_with_one_sign(field, &centers),
        grays_have_many_features(field),
        small_slopes(field),
        fails_at_flips(field, &centers),
        fails_at_grays(field, &centers),
        hybrid(field, &centers),
        blend(fields, &centers),
    ]
}

fn near_the_spectrum(field: &Field) -> Claim {
    let pairs = random_pairs(field);
    let [coefficients, features] = [Mixing::Coefficients, Mixing::Features]
        .map(|mixing| path_spreads(field.sums(), &pairs, mixing).from_spectrum);
    Claim {
        id: "features-near-the-spectrum",
        section: "4.3, figure 5",
        quote: "define coefficients in a way that allows for a meaningful interpolation, such \
                that the result is as close as possible to a true interpolation of the \
                corresponding spectra",
        measure: "greatest ΔE00 from the interpolated spectra at the weights ¼, ½ and ¾, between \
                  random pairs of bright, saturated reflectances whose slopes have the same sign",
        numbers: vec![
            Number::new("coefficients, median", coefficients.median, "ΔE00", 2),
            Number::new("features, median", features.median, "ΔE00", 2),
            Number::new("coefficients, mean", coefficients.mean, "ΔE00", 2),
            Number::new("features, mean", features.mean, "ΔE00", 2),
            Number::count("pairs", pairs.len()),
        ],
        verdict: Verdict::holds_if(
            features.median < coefficients.median && features.mean < coefficients.mean,
        ),
        why: "Holds if median and mean are lower for features. A peak that moves is not one peak \
              that fades while another grows: between the ends it is purer than the mixture. Likely \
              too: reflectances that are almost straight have shifts and widths far outside the \
              visible, which do not average with others'.",
    }
}

fn meaningful(field: &Field) -> Claim {
    let pairs = random_pairs(field);
    let [coefficients, features, spectra] =
        [Mixing::Coefficients, Mixing::Features, Mixing::Spectra]
            .map(|mixing| path_spreads(field.sums(), &pairs, mixing));
    Claim {
        id: "features-more-meaningful",
        section: "5.3, figure 5",
        quote: "interpolating the feature based coefficients (shift, width and slope) produces \
                more perceptually meaningful results than interpolating the original coefficients",
        measure: "hue: greatest deviation from an even turn, degrees; pace: longest of 16 steps \
                  over the mean step, ΔE00; detour: length of the way over the distance of its \
                  ends, CIELAB; medians over the same pairs",
        numbers: vec![
            Number::new("hue, coefficients", coefficients.hue_deg.median, "°", 1),
            Number::new("hue, features", features.hue_deg.median, "°", 1),
            Number::new("hue, spectra", spectra.hue_deg.median, "°", 1),
            Number::new("pace, coefficients", coefficients.pace.median, "", 2),
            Number::new("pace, features", features.pace.median, "", 2),
            Number::new("pace, spectra", spectra.pace.median, "", 2),
            Number::new("detour, coefficients", coefficients.detour.median, "", 3),
            Number::new("detour, features", features.detour.median, "", 3),
            Number::new("detour, spectra", spectra.detour.median, "", 3),
        ],
        verdict: Verdict::holds_if(
            features.hue_deg.median < coefficients.hue_deg.median
                && features.pace.median < coefficients.pace.median,
        ),
        why: "Holds if hue and pace are more even: equal weights should make equal steps. They \
              are, by little. The detour is no part of it: hues that change evenly go around gray, \
              not straight through it.",
    }
}

fn works_with_one_sign(field: &Field, centers: &[Center]) -> Claim {
    let [features, coefficients] = [Interpolation::Features, Interpolation::Coefficients]
        .map(|mode| misses(field, centers, |c| c.is_vivid && c.kind == Kind::Colored, mode));
    Claim {
        id: "features-work-with-one-sign",
        section: "5.3",
        quote: "Our approach works well with bright, saturated colors, as long as all colors have \
                the same sign of the slope value",
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

fn grays_have_many_features(field: &Field) -> Claim {
    let show = |shift_nm: f64, width_nm: f64| {
        // Width times slope is constant, so these are the same gray.
        let shape = Features { shift_nm, width_nm, slope_per_nm: 0.1 / width_nm };
        let gray = shape.to_sigmoid().expect("width and slope are not zero");
        lab(field.sums(), color(field.sums(), gray))
    };
    let known = show(550.0, 4000.0);
    let [twice_as_wide, shifted] = [show(550.0, 8000.0), show(450.0, 4000.0)];
    Claim {
        id: "grays-have-many-features",
        section: "4.3",
        quote: "a given gray color can in fact be represented by infinitely many combinations of \
                width and inversely scaled slope values, while varying the shift causes little \
                noticeable effect",
        measure: "ΔE00 of the reflectance of shift 550 nm, width 4000 nm, slope 0.1 / width from \
                  those of twice the width and half the slope, and of a shift of 450 nm",
        numbers: vec![
            Number::de2000("twice the width", ciede2000(known, twice_as_wide)),
            Number::de2000("another shift", ciede2000(known, shifted)),
            Number::new("C*ab", known.a.hypot(known.b), "", 2),
        ],
        verdict: Verdict::holds_if(
            ciede2000(known, twice_as_wide) <= 1.0 && ciede2000(known, shifted) <= 1.0,
        ),
        why: "Holds if neither is visible, within 1 ΔE00.",
    }
}

fn small_slopes(field: &Field) -> Claim {
    let luminance = |slope_per_nm: f64| {
        let shape = Features { shift_nm: 550.0, width_nm: 80.0, slope_per_nm };
        let reflectance = shape.to_sigmoid().expect("width and slope are not zero");
        color(field.sums(), reflectance).0[1]
    };
    let (up, down) = (luminance(0.0005), luminance(-0.0005));
    Claim {
        id: "small-slopes-differ-by-sign",
        section: "4.3",
        quote: "small positive slopes produce bright colors, while small negative slopes produces \
                dark colors",
        measure: "luminance Y of shift 550 nm, width 80 nm, slopes ±0.0005/nm; white has 1",
        numbers: vec![
            Number::new("slope +0.0005/nm", up, "", 3),
            Number::new("slope −0.0005/nm", down, "", 3),
        ],
        verdict: Verdict::holds_if(up > 0.5 && down < 0.5),
        why: "Holds if one is above and the other below one half.",
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
        quote: "produces artifacts for flipping slope signs",
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
        quote: "This model struggles with representing unsaturated, gray colors … This can cause \
                artifacts when interpolating between these extreme values",
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
        quote: "interpolating our coefficients leads to heavy artifacts, which can be avoided by \
                the presented hybrid interpolation approach",
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

fn blend(fields: &Fields, paper_centers: &[Center]) -> Claim {
    let [blend, coefficients] = [Interpolation::Blend, Interpolation::Coefficients]
        .map(|mode| misses(&fields.features, paper_centers, |_| true, mode));
    let ours =
        misses(&fields.reference, &centers(&fields.reference), |_| true, Interpolation::Blend);
    Claim {
        id: "all-dyes-of-a-cell-in-one-material",
        section: "4.2",
        quote: "A possible solution would be a BRDF that includes all fluorescent dyes referenced \
                by the coefficients of all corners of a cube grid cell",
        measure: "ΔE00 from the right color at the centers of all tetrahedra between matched \
                  nodes, with the mixture of the corners' materials",
        numbers: vec![
            Number::de2000("blend, greatest", blend.max),
            Number::de2000("blend in our own cube, greatest", ours.max),
            Number::de2000("coefficients, greatest", coefficients.max),
            Number::count("centers", blend.count),
        ],
        verdict: Verdict::holds_if(blend.max <= 0.02 && ours.max <= 0.02),
        why: "Holds if nothing is further off than the nodes may be, 0.01 ΔE00, and rounding. \
              Mixing whole materials goes beyond the paper's dyes of all corners with one mean \
              reflectance: color is linear in it, so what is exact at the corners is exact between.",
    }
}
