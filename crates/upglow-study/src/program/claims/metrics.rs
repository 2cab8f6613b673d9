//! How the choice of color difference affects the fit.

use super::between::MATCHED;
use super::{Claim, Fields, Number, Verdict, paper_layer, share};
use crate::field::Field;
use crate::spread::Spread;

/// A layer has artifacts if more than this share of its nodes are artifacts: ten of 1024 at the
/// paper's resolution. A smaller limit would count one or two nodes at a bend of the gamut's border.
const SOME_ARTIFACTS: f64 = 0.01;

pub(super) fn claims(fields: &Fields) -> Vec<Claim> {
    let [nearest_of_de76, nearest_of_de2000] = nearest(fields);
    vec![
        time(fields),
        time_of_eight_sweeps(fields),
        matched(fields),
        nearest_of_de76,
        nearest_of_de2000,
        artifacts_of_de76(fields),
        artifacts_after_more_sweeps(fields),
        artifacts_of_de2000(fields),
        smoothness_of_de76(fields),
        smoothness_of_de2000(fields),
    ]
}

fn evaluations(field: &Field) -> f64 {
    field.cube().fit().evaluations as f64
}

fn time(fields: &Fields) -> Claim {
    let rgb = evaluations(&fields.rgb);
    let [de76, de2000] = [&fields.de76, &fields.de2000].map(|field| evaluations(field) / rgb);
    Claim {
        id: "metric-time",
        section: "5.1",
        statement: "The whole fit is faster with ΔE76 and with ΔE00 than with the RGB distance: 3 h 18 min and 3 h 20 min in place of 5 h 59 min",
        measure: "evaluations of residuals and derivatives for a whole cube at 4 sweeps, over \
                  those of Euclidean RGB",
        numbers: vec![
            Number::new("ΔE76 / RGB", de76, "", 2).beside(0.55),
            Number::new("ΔE00 / RGB", de2000, "", 2).beside(0.56),
            Number::new("RGB", rgb / 1e6, "million", 2),
        ],
        verdict: Verdict::holds_if(de76 < 1.0 && de2000 < 1.0),
        why: "Holds if both ratios are below 1. They are ratios of this solver, not of the paper's: \
              counted in evaluations, because seconds differ from machine to machine. The likely reason: all derivatives here are exact and a \
              color is done at 0.01 ΔE00 under every metric, so RGB has no slow end to lose time \
              in; most evaluations go to colors that nothing shows, whose problem is nearly linear \
              in RGB and bent in CIELAB.",
    }
}

fn time_of_eight_sweeps(fields: &Fields) -> Claim {
    let ratio = evaluations(&fields.de76_8) / evaluations(&fields.de76);
    Claim {
        id: "eight-sweeps-time",
        section: "5.1",
        statement: "With ΔE76, 8 sweeps take 1.70 times as long as 4: 5 h 36 min in place of 3 h 18 min",
        measure: "evaluations for a whole cube, ΔE76, 8 sweeps over 4",
        numbers: vec![Number::new("8 / 4 sweeps", ratio, "", 2).beside(PAPER_EIGHT_SWEEPS)],
        verdict: Verdict::holds_if(
            (ratio - 1.0) / (PAPER_EIGHT_SWEEPS - 1.0) >= 0.5
                && (ratio - 1.0) / (PAPER_EIGHT_SWEEPS - 1.0) <= 2.0,
        ),
        why: "Holds if the four sweeps more cost between half and twice what they cost in the paper. \
              It is this solver's ratio: it depends on how much of the whole the first fit takes, \
              and on how soon a start that leads nowhere is given up.",
    }
}

/// 5 h 36 min over 3 h 18 min.
const PAPER_EIGHT_SWEEPS: f64 = 1.70;

fn matched(fields: &Fields) -> Claim {
    let share_of = |field: &Field| {
        let nodes = field.cube().nodes();
        share(nodes.iter().filter(|node| node.de2000 <= MATCHED).count(), nodes.len())
    };
    let [rgb, de76, de2000] = [&fields.rgb, &fields.de76, &fields.de2000].map(share_of);
    Claim {
        id: "de-matches-more",
        section: "4.1",
        statement: "ΔE76 and ΔE00 help the fit to converge where the color can be shown exactly",
        measure: "share of the nodes within 0.01 ΔE00 at 4 sweeps",
        numbers: vec![
            Number::new("RGB", 100.0 * rgb, "%", 2),
            Number::new("ΔE76", 100.0 * de76, "%", 2),
            Number::new("ΔE00", 100.0 * de2000, "%", 2),
            Number::new("our own search, ΔE00", 100.0 * share_of(&fields.reference), "%", 2),
        ],
        verdict: Verdict::holds_if(de76 > rgb && de2000 > rgb),
        why: "Holds if both match more nodes than the RGB distance does.",
    }
}

/// Mean ΔE00 and ΔE76 of three cubes, RGB, ΔE76 and ΔE00, over the nodes that none of them matches; and the
/// number of these nodes.
fn misses_of_all(fields: &Fields) -> ([[f64; 2]; 3], usize) {
    let all = [&fields.rgb, &fields.de76, &fields.de2000];
    let is_missed = |node: &usize| all.iter().all(|f| f.cube().nodes()[*node].de2000 > MATCHED);
    let missed: Vec<usize> = (0..fields.rgb.cube().nodes().len()).filter(is_missed).collect();
    let mean = |field: &Field, k: usize| {
        Spread::of(missed.iter().map(|&node| field.differences(node)[k])).mean
    };
    (all.map(|field| [mean(field, 0), mean(field, 1)]), missed.len())
}

/// The claims that ΔE76 and ΔE00 approximate colors better than the RGB distance.
fn nearest(fields: &Fields) -> [Claim; 2] {
    let ([rgb, de76, de2000], missed) = misses_of_all(fields);
    let claim = |name, found: [f64; 2], id, statement, measure| Claim {
        id,
        section: "4.1",
        statement,
        measure,
        numbers: vec![
            Number::new("RGB", rgb[0], "ΔE00", 2),
            Number::new(name, found[0], "ΔE00", 2),
            Number::new("RGB", rgb[1], "ΔE76", 2),
            Number::new(name, found[1], "ΔE76", 2),
            Number::count("nodes", missed),
        ],
        verdict: Verdict::holds_if((0..2).all(|k| found[k] < rgb[k])),
        why: NEARER,
    };
    [
        claim(
            "ΔE76",
            de76,
            "de76-approximates-better",
            "ΔE76 finds better approximations of colors that cannot be shown",
            "mean difference from the color asked for, over the nodes that RGB, ΔE76 and ΔE00 all \
             miss, 4 sweeps",
        ),
        claim(
            "ΔE00",
            de2000,
            "de2000-approximates-better",
            "ΔE00 finds better approximations of colors that cannot be shown",
            "the same for ΔE00",
        ),
    ]
}

/// The rule of both claims about approximations.
const NEARER: &str = "Holds if it is nearer than the RGB distance by both differences: each metric wins \
                      by its own.";

/// Artifacts in the layer B = 0: how many, and whether they are more than [`SOME_ARTIFACTS`].
fn at_black(field: &Field) -> (usize, bool) {
    let (count, nodes) = (field.artifacts_in_layer(0).len(), field.cube().resolution().pow(2));
    (count, share(count, nodes) > SOME_ARTIFACTS)
}

fn artifacts_of_de76(fields: &Fields) -> Claim {
    let (count, some) = at_black(&fields.de76);
    let is_red = |&node: &usize| {
        let [_, green, red] = fields.de76.cube().coordinates(node);
        red > green
    };
    let reds = fields.de76.artifacts_in_layer(0).iter().filter(|node| is_red(node)).count();
    Claim {
        id: "de76-artifacts",
        section: "5.1, figure 7a",
        statement: "At B = 0, ΔE76 with 4 sweeps leaves artifacts between red and green",
        measure: "artifact nodes in the layer B = 0, ΔE76, 4 sweeps",
        numbers: vec![
            Number::count("ΔE76, 4 sweeps", count),
            Number::count("of these with R > G", reds),
            Number::count("RGB, 4 sweeps", at_black(&fields.rgb).0),
            Number::count("our own search, ΔE00", at_black(&fields.reference).0),
            Number::count("nodes in the layer", fields.de76.cube().resolution().pow(2)),
        ],
        verdict: Verdict::holds_if(some),
        why: "Holds if more than 1 % of the layer's nodes are artifacts. Most lie in the \
              greens that no material shows.",
    }
}

fn artifacts_after_more_sweeps(fields: &Fields) -> Claim {
    let ((four, _), (eight, some)) = (at_black(&fields.de76), at_black(&fields.de76_8));
    let everywhere = [&fields.de76, &fields.de76_8].map(Field::artifacts);
    Claim {
        id: "de76-artifacts-8-sweeps",
        section: "5.1, figure 7b",
        statement: "With 8 sweeps most of the artifacts of ΔE76 at B = 0 are gone",
        measure: "artifact nodes in the layer B = 0 and in all layers, ΔE76, 4 and 8 sweeps",
        numbers: vec![
            Number::count("4 sweeps", four),
            Number::count("8 sweeps", eight),
            Number::count("our own search, ΔE76", at_black(&fields.reference_de76).0),
            Number::count("4 sweeps, all layers", everywhere[0]),
            Number::count("8 sweeps, all layers", everywhere[1]),
            Number::count("our own search, ΔE76, all layers", fields.reference_de76.artifacts()),
        ],
        verdict: Verdict::holds_if(!some && 2 * eight <= four),
        why: "Holds if 8 sweeps leave at most half of the artifacts, and less than 1 % of the \
              layer. What 4 of our sweeps leave is not unfinished work, and our own search under \
              ΔE76 leaves much of it too. The likely reason: far outside what can be shown, \
              several materials are about equally near by ΔE76 and look different, and neighbors \
              end at different ones.",
    }
}

fn artifacts_of_de2000(fields: &Fields) -> Claim {
    let ((de76, _), (de2000, some)) = (at_black(&fields.de76), at_black(&fields.de2000));
    let everywhere = [&fields.de76, &fields.de2000].map(Field::artifacts);
    Claim {
        id: "de2000-artifacts",
        section: "5.1, figure 7c",
        statement: "ΔE00 with 4 sweeps removes the remaining artifacts best",
        measure: "artifact nodes in the layer B = 0 and in all layers at 4 sweeps, ΔE76 and ΔE00",
        numbers: vec![
            Number::count("ΔE76", de76),
            Number::count("ΔE00", de2000),
            Number::count("ΔE76, all layers", everywhere[0]),
            Number::count("ΔE00, all layers", everywhere[1]),
        ],
        verdict: Verdict::holds_if(!some && 2 * de2000 <= de76),
        why: "Holds if ΔE00 leaves at most half of the artifacts, and less than 1 % of the layer. \
              ΔE00 weighs lightness and hue more than chroma where chroma is great, so fewer \
              materials are equally near.",
    }
}

/// Color roughness of the whole cube, and of the two layers of figure 6.
fn roughness(field: &Field) -> [f64; 3] {
    let in_layer = |paper: usize| field.color_roughness_in_layer(paper_layer(field, paper)).mean;
    [field.color_roughness().mean, in_layer(31), in_layer(8)]
}

fn smoothness_of_de76(fields: &Fields) -> Claim {
    let [rgb, de76] = [&fields.rgb, &fields.de76].map(roughness);
    let spectral = [&fields.rgb, &fields.de76].map(|field| 100.0 * field.spectral_roughness().mean);
    Claim {
        id: "de76-smoother",
        section: "5.1, figures 3 and 6",
        statement: "With ΔE76 the colors of the cube change much more smoothly than with the RGB distance",
        measure: "mean color roughness of the cube, of the layers B = 1 and B = 0.258, and mean \
                  spectral roughness, at 4 sweeps",
        numbers: vec![
            Number::de2000("RGB", rgb[0]),
            Number::de2000("ΔE76", de76[0]),
            Number::de2000("RGB, B = 1", rgb[1]),
            Number::de2000("ΔE76, B = 1", de76[1]),
            Number::de2000("RGB, B = 0.258", rgb[2]),
            Number::de2000("ΔE76, B = 0.258", de76[2]),
            Number::new("spectra, RGB", spectral[0], "%", 3),
            Number::new("spectra, ΔE76", spectral[1], "%", 3),
        ],
        verdict: Verdict::holds_if((0..3).all(|k| de76[k] < rgb[k])),
        why: "Holds if the colors of ΔE76 are less rough in all three. Under RGB our solver \
              converges everywhere, so what the paper's figures show of it, stripes left by \
              unfinished fits, is not there to be improved on; ΔE76 adds its artifacts.",
    }
}

fn smoothness_of_de2000(fields: &Fields) -> Claim {
    let [rgb, de2000] = [&fields.rgb_32, &fields.de2000].map(roughness);
    let [rgb_layer, de2000_layer] = [&fields.rgb_32, &fields.de2000]
        .map(|field| field.color_roughness_in_layer(paper_layer(field, 22)).mean);
    let spectral =
        [&fields.rgb_32, &fields.de2000].map(|field| 100.0 * field.spectral_roughness().mean);
    Claim {
        id: "de2000-smoother",
        section: "5.1, figure 3",
        statement: "The layer B = 0.7 is smoother with ΔE00 and 4 sweeps than with the RGB distance and 32",
        measure: "mean color roughness of the cube and of the layer B = 0.7, and mean spectral \
                  roughness; RGB with 32 sweeps, ΔE00 with 4",
        numbers: vec![
            Number::de2000("RGB", rgb[0]),
            Number::de2000("ΔE00", de2000[0]),
            Number::de2000("RGB, B = 0.7", rgb_layer),
            Number::de2000("ΔE00, B = 0.7", de2000_layer),
            Number::new("spectra, RGB", spectral[0], "%", 3),
            Number::new("spectra, ΔE00", spectral[1], "%", 3),
        ],
        verdict: Verdict::holds_if(de2000[0] < rgb[0] && de2000_layer < rgb_layer),
        why: "Holds if the colors of ΔE00 are less rough in both. It is the metric in which \
              roughness is measured, as an eye would; the spectra, which no metric sees, are about \
              as rough under either.",
    }
}
