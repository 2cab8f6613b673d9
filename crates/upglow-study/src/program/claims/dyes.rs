//! How eight measured dyes compare with analytic fluorescence.

use super::gamut::bright_area;
use super::{ANALYTIC_WIDTHS, Claim, Fields, Number, Verdict, paper_layer, share};
use crate::field::Field;

/// Two gamuts are similar if the area of one is within this share of the other's.
const SIMILAR: f64 = 0.1;

/// A color is reached if the material is within this ΔE00 of it: just visible side by side.
const REACHED: f32 = 1.0;

pub(super) fn claims(fields: &Fields) -> Vec<Claim> {
    vec![gamut(fields), artifacts(fields), time(fields)]
}

fn reached(field: &Field) -> f64 {
    let nodes = field.cube().nodes();
    share(nodes.iter().filter(|node| node.de2000 <= REACHED).count(), nodes.len())
}

fn gamut(fields: &Fields) -> Claim {
    let area = bright_area(&fields.de2000);
    let ratio_to = |field: &Field| area / bright_area(field);
    let ratios: Vec<f64> = fields.analytic_by_width.iter().map(ratio_to).collect();
    let by_width = ANALYTIC_WIDTHS.iter().zip(&ratios);
    let mut numbers: Vec<Number> =
        by_width.map(|((_, name), ratio)| Number::new(name, *ratio, "", 2)).collect();
    numbers.extend([
        Number::new("our 50 / 45 nm", ratio_to(&fields.analytic), "", 2),
        Number::percent("nodes, dyes", reached(&fields.de2000)),
        Number::percent("nodes, analytic of our widths", reached(&fields.analytic)),
    ]);
    let similar: Vec<bool> = ratios.iter().map(|ratio| (ratio - 1.0).abs() <= SIMILAR).collect();
    Claim {
        id: "gamut-of-eight-dyes",
        section: "5.2, figure 1e and f",
        statement: "The eight dyes reach a gamut similar to that of the analytic model",
        measure: "area in xy of the convex hull of the chromaticities shown with X+Y+Z ≥ 1.5, \
                  dyes over analytic of these full widths at half maximum (absorption / emission); share of the nodes within 1 ΔE00; ΔE00, 4 sweeps",
        numbers,
        verdict: Verdict::if_agreed(&similar),
        why: "Holds if the areas differ by at most 10 % for every width, does not hold if they differ \
              by more for every width, and cannot be judged otherwise: neither the paper nor Jung et \
              al. give the widths of the analytic curves, and the ratio depends on them. The paper \
              compares outlines by eye.",
    }
}

fn artifacts(fields: &Fields) -> Claim {
    let in_figure = |field: &Field| -> usize {
        [5, 23].map(|layer| field.artifacts_in_layer(paper_layer(field, layer)).len()).iter().sum()
    };
    let [dyes, analytic] = [&fields.de2000, &fields.analytic].map(Field::artifacts);
    Claim {
        id: "dyes-have-artifacts",
        section: "5.2, figure 1a to d",
        statement: "At B = 0.161 and B = 0.742 the model with dyes has artifacts, more than the analytic one",
        measure: "artifact nodes in those two layers, and in all, with dyes and by formula; ΔE00, \
                  4 sweeps",
        numbers: vec![
            Number::count("dyes, both layers", in_figure(&fields.de2000)),
            Number::count("analytic, both layers", in_figure(&fields.analytic)),
            Number::count("dyes, all layers", dyes),
            Number::count("analytic, all layers", analytic),
            Number::count("our own search, all layers", fields.reference.artifacts()),
        ],
        verdict: Verdict::holds_if(dyes > analytic),
        why: "Holds if all layers together have more artifacts with dyes. Our own search \
              has as many, so they are no failure of the search: where no pair of dyes shows a \
              color, the nearest that one shows bends from pair to pair.",
    }
}

fn time(fields: &Fields) -> Claim {
    let [dyes, analytic, ours] = [&fields.de2000, &fields.analytic, &fields.reference]
        .map(|field| field.cube().fit().evaluations as f64);
    Claim {
        id: "dyes-take-longer",
        section: "5.2",
        statement: "The fit takes longer with dyes, because it tries every pair of dyes",
        measure: "evaluations for a whole cube with dyes, over those by formula; ΔE00, 4 sweeps",
        numbers: vec![
            Number::new("dyes / analytic", dyes / analytic, "", 2),
            Number::new("our own search with dyes / analytic", ours / analytic, "", 2),
        ],
        verdict: Verdict::holds_if(dyes > analytic),
        why: "Holds if the ratio is above 1. It is this solver's ratio. Eight pairs are eight fits for each start, and more \
              nodes are never reached, which every sweep tries again. Our own search follows only \
              the most promising starts of a table.",
    }
}
