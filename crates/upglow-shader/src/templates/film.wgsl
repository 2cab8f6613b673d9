// What each of a corner's dyes does.
struct UpglowPair {
    first: f32,
    second: f32,
}

// The optical density of each of a corner's dyes at nm.
fn upglow_densities(c: UpglowCorner, nm: f32) -> UpglowPair {
    var pair: UpglowPair;
    pair.first = 0.0;
    pair.second = 0.0;
    if (c.density > 0.0) {
        let first: UpglowCurves = upglow_dye_curves(c.dye, nm);
        let second: UpglowCurves = upglow_dye_curves(c.second_dye, nm);
        pair.first = c.density * first.absorption;
        pair.second = c.second_density * second.absorption;
    }
    return pair;
}

// Share of the light at nm that a corner's dyes absorb, 0 to 1.
fn upglow_absorbed(c: UpglowCorner, nm: f32) -> f32 {
    let densities: UpglowPair = upglow_densities(c, nm);
    return 1.0 - exp(-UPGLOW_LN_10 * (densities.first + densities.second));
}

// What a film absorbs over its optical density: a series for a thin one, where the closed form would
// cancel digits; ln 10 at 0.
fn upglow_absorbed_per_density(density: f32) -> f32 {
    let z: f32 = UPGLOW_LN_10 * density;
    if (density >= UPGLOW_THIN) {
        return (1.0 - exp(-z)) / density;
    }
    var series: f32 = 1.0;
    for (var k: i32 = UPGLOW_TERMS; k > 1; k -= 1) {
        series = 1.0 - z / f32(k) * series;
    }
    return UPGLOW_LN_10 * series;
}

// Share of the light at nm that each of a corner's dyes gives back, 0 to 1.
fn upglow_returned_by_each(c: UpglowCorner, nm: f32) -> UpglowPair {
    let densities: UpglowPair = upglow_densities(c, nm);
    let absorbed: f32 = upglow_absorbed_per_density(densities.first + densities.second);
    let first: vec4f = upglow_dye_numbers(c.dye);
    let second: vec4f = upglow_dye_numbers(c.second_dye);
    var pair: UpglowPair;
    pair.first = densities.first * absorbed * first.x * upglow_share(nm, first.y);
    pair.second = densities.second * absorbed * second.x * upglow_share(nm, second.y);
    return pair;
}

// Share of the light at nm that a corner gives back by fluorescence, 0 to 1.
fn upglow_returned(c: UpglowCorner, nm: f32) -> f32 {
    if (c.density <= 0.0) {
        return 0.0;
    }
    let returned: UpglowPair = upglow_returned_by_each(c, nm);
    return returned.first + returned.second;
}

// What a corner emits at nm of what its dyes give back, 1/nm.
fn upglow_emitted(c: UpglowCorner, returned: UpglowPair, nm: f32) -> UpglowPair {
    let first: UpglowCurves = upglow_dye_curves(c.dye, nm);
    let second: UpglowCurves = upglow_dye_curves(c.second_dye, nm);
    var pair: UpglowPair;
    pair.first = c.weight * returned.first * first.emission;
    pair.second = c.weight * returned.second * second.emission;
    return pair;
}

// What a corner adds to the re-radiation, 1/nm.
fn upglow_moved(c: UpglowCorner, in_nm: f32, out_nm: f32) -> f32 {
    if (c.density <= 0.0) {
        return 0.0;
    }
    let emitted: UpglowPair = upglow_emitted(c, upglow_returned_by_each(c, in_nm), out_nm);
    return emitted.first + emitted.second;
}

// The shares of the density levels in a dye's curve.
struct UpglowLevels {
    a: f32,
    b: f32,
    c: f32,
    d: f32,
}

// How far a density has come from one level to the next, 0 to 1.
fn upglow_reached(density: f32, below: f32, level: f32) -> f32 {
    return upglow_within((density - below) / (level - below), 0.0, 1.0);
}

// The curve that incident wavelengths are drawn from is mixed of those of the two nearest levels; below
// the first it is scaled.
fn upglow_levels(density: f32) -> UpglowLevels {
    let to_b: f32 = upglow_reached(density, UPGLOW_LEVEL_A, UPGLOW_LEVEL_B);
    let to_c: f32 = upglow_reached(density, UPGLOW_LEVEL_B, UPGLOW_LEVEL_C);
    let to_d: f32 = upglow_reached(density, UPGLOW_LEVEL_C, UPGLOW_LEVEL_D);
    var levels: UpglowLevels;
    levels.a = upglow_reached(density, 0.0, UPGLOW_LEVEL_A) - to_b;
    levels.b = to_b - to_c;
    levels.c = to_c - to_d;
    levels.d = to_d;
    return levels;
}

fn upglow_mixed(levels: UpglowLevels, texel: vec4f) -> f32 {
    return levels.a * texel.x + levels.b * texel.y + levels.c * texel.z + levels.d * texel.w;
}

// The curve that incident wavelengths are drawn from for one dye: about what it would give back
// without the other one.
fn upglow_proposed(dye: i32, density: f32, nm: f32) -> f32 {
    let place: UpglowPlace = upglow_place(nm);
    if (place.bin < 0) {
        return 0.0;
    }
    let levels: UpglowLevels = upglow_levels(density);
    let column: i32 = 2 * (UPGLOW_DYES + dye);
    let low: f32 = upglow_mixed(levels, upglow_curve(column, place.bin));
    let high: f32 = upglow_mixed(levels, upglow_curve(column, place.bin + 1));
    return mix(low, high, place.t);
}

// The integrals of the curves up to the last level, nm.
fn upglow_level_totals(dye: i32) -> vec4f {
    return upglow_curve(2 * (UPGLOW_DYES + dye) + 1, UPGLOW_BINS);
}

// What a corner adds to the density of in_nm times what leaves at out_nm, 1/nm.
fn upglow_proposed_moved(c: UpglowCorner, in_nm: f32, out_nm: f32) -> f32 {
    if (c.density <= 0.0) {
        return 0.0;
    }
    var proposed: UpglowPair;
    proposed.first = upglow_proposed(c.dye, c.density, in_nm);
    proposed.second = upglow_proposed(c.second_dye, c.second_density, in_nm);
    let emitted: UpglowPair = upglow_emitted(c, proposed, out_nm);
    return emitted.first + emitted.second;
}

// The integral of upglow_proposed_moved over incident wavelengths, for each dye.
fn upglow_leaving_by_each(c: UpglowCorner, out_nm: f32) -> UpglowPair {
    var totals: UpglowPair;
    totals.first = upglow_mixed(upglow_levels(c.density), upglow_level_totals(c.dye));
    totals.second =
        upglow_mixed(upglow_levels(c.second_density), upglow_level_totals(c.second_dye));
    return upglow_emitted(c, totals, out_nm);
}

fn upglow_leaving(c: UpglowCorner, out_nm: f32) -> f32 {
    if (c.density <= 0.0) {
        return 0.0;
    }
    let leaving: UpglowPair = upglow_leaving_by_each(c, out_nm);
    return leaving.first + leaving.second;
}

// The integral of each dye's re-radiation from in_nm over outgoing wavelengths.
fn upglow_arriving_by_each(c: UpglowCorner, in_nm: f32) -> UpglowPair {
    let returned: UpglowPair = upglow_returned_by_each(c, in_nm);
    let first: vec4f = upglow_dye_numbers(c.dye);
    let second: vec4f = upglow_dye_numbers(c.second_dye);
    var pair: UpglowPair;
    pair.first = c.weight * returned.first * first.w;
    pair.second = c.weight * returned.second * second.w;
    return pair;
}

// The integral of a corner's re-radiation from in_nm over outgoing wavelengths.
fn upglow_arriving(c: UpglowCorner, in_nm: f32) -> f32 {
    if (c.density <= 0.0) {
        return 0.0;
    }
    let arriving: UpglowPair = upglow_arriving_by_each(c, in_nm);
    return arriving.first + arriving.second;
}

// A wavelength with the density of upglow_proposed, from u in 0 to 1: one of the levels in
// proportion to its area, then a wavelength from that.
fn upglow_draw_proposed(dye: i32, density: f32, u: f32) -> f32 {
    let levels: UpglowLevels = upglow_levels(density);
    let totals: vec4f = upglow_level_totals(dye);
    let b: f32 = levels.b * totals.y;
    let c: f32 = levels.c * totals.z;
    let d: f32 = levels.d * totals.w;
    var level: i32 = 0;
    var area: f32 = levels.a * totals.x;
    var rest: f32 = u * (area + b + c + d);
    if (rest >= area && b > 0.0) {
        rest -= area;
        area = b;
        level = 1;
    }
    if (rest >= area && c > 0.0) {
        rest -= area;
        area = c;
        level = 2;
    }
    if (rest >= area && d > 0.0) {
        rest -= area;
        area = d;
        level = 3;
    }
    let value: f32 = rest / max(area, UPGLOW_TINY) * upglow_of_level(totals, level);
    let bin: i32 = upglow_bin(dye, level, value);
    let column: i32 = 2 * (UPGLOW_DYES + dye);
    let low: f32 = upglow_of_level(upglow_curve(column, bin), level);
    let high: f32 = upglow_of_level(upglow_curve(column, bin + 1), level);
    let beyond: f32 = value - upglow_integral(dye, bin, level);
    return UPGLOW_FIRST_NM + f32(bin) + upglow_trapezoid(low, high - low, beyond);
}

// An incident wavelength with the density of the curve of one of a corner's dyes: the one on which
// falls what is left of the choice between corners.
fn upglow_draw_incident(c: UpglowCorner, out_nm: f32, rest: f32, u: f32) -> f32 {
    let leaving: UpglowPair = upglow_leaving_by_each(c, out_nm);
    if (rest >= leaving.first && leaving.second > 0.0) {
        return upglow_draw_proposed(c.second_dye, c.second_density, u);
    }
    return upglow_draw_proposed(c.dye, c.density, u);
}

// An outgoing wavelength with the density of one dye's emission, chosen likewise.
fn upglow_draw_outgoing(c: UpglowCorner, in_nm: f32, rest: f32, u: f32) -> f32 {
    let arriving: UpglowPair = upglow_arriving_by_each(c, in_nm);
    if (rest >= arriving.first && arriving.second > 0.0) {
        return upglow_draw_emitted(c.second_dye, u);
    }
    return upglow_draw_emitted(c.dye, u);
}
