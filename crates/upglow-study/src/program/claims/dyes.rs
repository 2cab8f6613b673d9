//! How eight measured dyes compare with analytic fluorescence.

use upglow::Fluorescence;
use upglow_color::{ColorSolid, Grid};

use super::between::MATCHED;
use super::gamut::bright_area;
use super::reradiation::{Backward, backward_shares};
use super::{Claim, Fields, Number, Verdict, paper_layer, share};
use crate::field::Field;

/// Two gamuts are similar if the area of one is within this share of the other's.
const SIMILAR: f64 = 0.1;

/// A color is reached if the material is within this ΔE00 of it: just visible side by side.
const REACHED: f32 = 1.0;

pub(super) fn claims(fields: &Fields) -> Vec<Claim> {
    vec![
        border(fields),
        gamut(fields),
        artifacts(fields),
        time(fields),
        indices(fields),
        backward(),
    ]
}

fn reached(field: &Field) -> f64 {
    let nodes = field.cube().nodes();
    share(nodes.iter().filter(|node| node.de2000 <= REACHED).count(), nodes.len())
}

fn border(fields: &Fields) -> Claim {
    let cube = fields.reference.cube();
    let colorimetry = cube.contract().on(Grid::FIT);
    let (reflectance, all) =
        (ColorSolid::reflectance(&colorimetry), ColorSolid::fluorescence(&colorimetry));
    let count = cube.nodes().len();
    let shown_by = |solid: &ColorSolid| {
        let color = |index: &usize| colorimetry.xyz_from_rgb(cube.node_rgb(*index));
        share((0..count).filter(|index| solid.contains(color(index))).count(), count)
    };
    let passive = (0..count).filter(|&index| {
        let node = cube.nodes()[index];
        cube.node_material(index).fluorescence == Fluorescence::None && node.de2000 <= MATCHED
    });
    let (any, smooth) = (shown_by(&reflectance), share(passive.count(), count));
    Claim {
        id: "reflectance-fails-at-the-border",
        section: "2",
        quote: "they can only reproduce colors inside the gamut of solid reflectances … but fail \
                at more saturated colors near the border of wide-gamut RGB spaces such as ACEScg",
        measure: "share of the nodes that any reflectance shows, that a smooth one alone shows \
                  within 0.01 ΔE00, that smooth ones with eight dyes show within 1 ΔE00, that any \
                  fluorescent material shows",
        numbers: vec![
            Number::percent("any reflectance", any),
            Number::percent("smooth reflectance", smooth),
            Number::percent("with eight dyes", reached(&fields.reference)),
            Number::percent("any fluorescent material", shown_by(&all)),
        ],
        verdict: Verdict::holds_if(any < 1.0 && smooth < reached(&fields.reference)),
        why: "Holds if some nodes are beyond every reflectance and dyes add to what smooth \
              reflectances reach.",
    }
}

fn gamut(fields: &Fields) -> Claim {
    let [dyes, analytic] = [&fields.de2000, &fields.analytic].map(bright_area);
    Claim {
        id: "gamut-of-eight-dyes",
        section: "5.2, figure 1e and f",
        quote: "with our eight dyes from Figure 2 we achieve a similar gamut as the analytical \
                model",
        measure: "area in xy of the convex hull of the chromaticities shown with X+Y+Z ≥ 1.5; \
                  share of the nodes within 1 ΔE00; ΔE00, 4 sweeps",
        numbers: vec![
            Number::new("area, dyes", dyes, "", 4),
            Number::new("area, analytic", analytic, "", 4),
            Number::new("dyes / analytic", dyes / analytic, "", 2),
            Number::percent("nodes, dyes", reached(&fields.de2000)),
            Number::percent("nodes, analytic", reached(&fields.analytic)),
        ],
        verdict: Verdict::holds_if((dyes / analytic - 1.0).abs() <= SIMILAR),
        why: "Holds if the areas differ by at most 10 %. The paper compares outlines by eye. The \
              formula's widths are ours, Jung et al. give none, and it may put its emission at any \
              wavelength with any Stokes shift, so it reaches more nodes than eight fixed dyes.",
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
        quote: "The cube grid layers for B = 0.161 (a, b) and B = 0.742 (c, d) reveal artifacts in \
                the dye-based model",
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
        quote: "computation time is higher due to the brute force optimization over dye pairs",
        measure: "evaluations for a whole cube with dyes, over those by formula; ΔE00, 4 sweeps",
        numbers: vec![
            Number::new("dyes / analytic", dyes / analytic, "", 2),
            Number::new("our own search with dyes / analytic", ours / analytic, "", 2),
        ],
        verdict: Verdict::holds_if(dyes > analytic),
        why: "Holds if the ratio is above 1. Eight pairs are eight fits for each start, and more \
              nodes are never reached, which every sweep tries again. Our own search follows only \
              the most promising starts of a table.",
    }
}

fn indices(fields: &Fields) -> Claim {
    let (pairs, differing) = neighboring_dyes(&fields.de2000);
    let (our_pairs, our_differing) = neighboring_dyes(&fields.reference);
    Claim {
        id: "adjacent-dye-indices-differ",
        section: "4.2",
        quote: "adjacent entries in the precomputed coefficient cube can have different dye indices",
        measure: "neighbors along an axis that both fluoresce: share with different first dyes",
        numbers: vec![
            Number::percent("ΔE00, 4 sweeps", share(differing, pairs)),
            Number::percent("our own search", share(our_differing, our_pairs)),
            Number::count("pairs of neighbors", pairs),
        ],
        verdict: Verdict::holds_if(differing > 0),
        why: "Holds if there are any. Nothing in the fit prefers a neighbor's dyes once a color is \
              matched or no other pair comes nearer.",
    }
}

/// Neighbors along an axis that both fluoresce, and how many of these have different first dyes.
fn neighboring_dyes(field: &Field) -> (usize, usize) {
    let fluorescence = |node: usize| field.cube().node_material(node).fluorescence;
    let (mut pairs, mut differing) = (0, 0);
    for (a, b) in field.pairs() {
        if let (Fluorescence::Dyes { first: i, .. }, Fluorescence::Dyes { first: j, .. }) =
            (fluorescence(a), fluorescence(b))
        {
            pairs += 1;
            differing += usize::from(i != j);
        }
    }
    (pairs, differing)
}

fn backward() -> Claim {
    let shares = backward_shares();
    let (of_red, others): (Vec<&Backward>, Vec<&Backward>) =
        shares.iter().partition(|share| share.first == RED);
    let greatest = |shares: &[&Backward], of: fn(&Backward) -> f64| {
        shares.iter().map(|share| of(share)).fold(0.0, f64::max)
    };
    let pooled = greatest(&of_red, |share| share.pooled);
    let separate = greatest(&of_red, |share| share.separate);
    Claim {
        id: "separate-dyes-are-more-accurate",
        section: "4.2",
        quote: "It would be more accurate to calculate absorption and emission for both dyes \
                separately and interpolate the result",
        measure: "share of the re-radiated energy that leaves at shorter wavelengths than it came, \
                  under D65, at the weight where it is greatest when pooled; the pair is the red Alexa Fluor 635 \
                  with the violet Alexa Fluor 405, where the ring closes",
        numbers: vec![
            Number::percent("pooled", pooled),
            Number::percent("separate", separate),
            Number::percent("pooled, worst other pair", greatest(&others, |share| share.pooled)),
            Number::percent(
                "separate, worst other pair",
                greatest(&others, |share| share.separate),
            ),
        ],
        verdict: Verdict::holds_if(separate < pooled),
        why: "Holds if keeping the dyes apart lowers the share. Pooled, the violet emitter gives \
              back what the red dye absorbed, which no fluorescence does; what is left when they \
              are apart is the overlap of each dye's own curves.",
    }
}

/// The dye that emits at the longest wavelengths; the next one in the ring is violet.
const RED: &str = "Alexa_Fluor_635";
