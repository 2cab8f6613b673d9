fn upglow_next(dye: i32) -> i32 {
    if (dye + 1 < UPGLOW_DYES) {
        return dye + 1;
    }
    return 0;
}

// Share of the light at nm that a corner's dyes absorb, 0 to 1.
fn upglow_absorbed(c: UpglowCorner, nm: f32) -> f32 {
    if (c.concentration <= 0.0) {
        return 0.0;
    }
    let first: UpglowCurves = upglow_dye_curves(c.dye, nm);
    let second: UpglowCurves = upglow_dye_curves(upglow_next(c.dye), nm);
    return c.concentration * mix(first.absorption, second.absorption, c.second);
}

// The wavelength below which the integral of the absorption is this.
fn upglow_absorption_quantile(dye: i32, area: f32) -> f32 {
    let bin: i32 = upglow_bin(dye, UPGLOW_ABSORPTION, area);
    let texel: vec4f = upglow_curve(2 * dye, bin);
    let rest: f32 = area - upglow_integral(dye, bin, UPGLOW_ABSORPTION);
    return UPGLOW_FIRST_NM + f32(bin) + upglow_trapezoid(texel.x, texel.y, rest);
}
//@if energy

// The integral of what a dye absorbs and gives back at concentration and quantum yield 1, nm.
fn upglow_absorbed_total(dye: i32, mean_nm: f32) -> f32 {
    return upglow_integral(dye, UPGLOW_BINS, UPGLOW_ABSORPTION);
}

// A wavelength with the density of what a dye gives back, from u in 0 to 1.
fn upglow_draw_absorbed(dye: i32, mean_nm: f32, u: f32) -> f32 {
    return upglow_absorption_quantile(dye, u * upglow_absorbed_total(dye, mean_nm));
}
//@end
//@if photon

// Integrals of a dye's absorption up to a wavelength.
struct UpglowIntegrals {
    area: f32, // of the absorption, nm
    moment: f32, // of the absorption times the wavelength, nm²
}

fn upglow_integrals(dye: i32, bin: i32, t: f32) -> UpglowIntegrals {
    let texel: vec4f = upglow_curve(2 * dye, bin);
    let area: f32 = t * (texel.x + 0.5 * t * texel.y);
    let moment: f32 = t * t * (texel.x / 2.0 + t * texel.y / 3.0);
    var integrals: UpglowIntegrals;
    integrals.area = upglow_integral(dye, bin, UPGLOW_ABSORPTION) + area;
    integrals.moment = upglow_integral(dye, bin, UPGLOW_MOMENT)
        + (UPGLOW_FIRST_NM + f32(bin)) * area + moment;
    return integrals;
}

fn upglow_integrals_to(dye: i32, nm: f32) -> UpglowIntegrals {
    let place: f32 = upglow_within(nm - UPGLOW_FIRST_NM, 0.0, f32(UPGLOW_BINS));
    let bin: i32 = min(i32(place), UPGLOW_BINS - 1);
    return upglow_integrals(dye, bin, place - f32(bin));
}

// The integral of what a dye absorbs and gives back at concentration and quantum yield 1, nm.
fn upglow_absorbed_total(dye: i32, mean_nm: f32) -> f32 {
    let below: UpglowIntegrals = upglow_integrals_to(dye, mean_nm);
    let area: f32 = upglow_integral(dye, UPGLOW_BINS, UPGLOW_ABSORPTION);
    return below.moment / mean_nm + area - below.area;
}

// The wavelength below which the integral of the absorption times the wavelength is this: the root
// for a density that is straight after it was weighted, then Newton's step.
fn upglow_moment_quantile(dye: i32, moment: f32) -> f32 {
    let bin: i32 = upglow_bin(dye, UPGLOW_MOMENT, moment);
    let nm: f32 = UPGLOW_FIRST_NM + f32(bin);
    let texel: vec4f = upglow_curve(2 * dye, bin);
    let start: f32 = texel.x * nm;
    let rise: f32 = (texel.x + texel.y) * (nm + 1.0) - start;
    let t: f32 = upglow_trapezoid(start, rise, moment - upglow_integral(dye, bin, UPGLOW_MOMENT));
    let found: UpglowIntegrals = upglow_integrals(dye, bin, t);
    let slope: f32 = (texel.x + t * texel.y) * (nm + t);
    if (slope > 0.0) {
        return nm + upglow_within(t - (found.moment - moment) / slope, 0.0, 1.0);
    }
    return nm + t;
}

// A wavelength with the density of what a dye gives back, from u in 0 to 1.
fn upglow_draw_absorbed(dye: i32, mean_nm: f32, u: f32) -> f32 {
    let mean: UpglowIntegrals = upglow_integrals_to(dye, mean_nm);
    let value: f32 = u * upglow_absorbed_total(dye, mean_nm);
    if (value * mean_nm < mean.moment) {
        return upglow_moment_quantile(dye, value * mean_nm);
    }
    return upglow_absorption_quantile(dye, mean.area + value - mean.moment / mean_nm);
}
//@end
//@if pooled

// Both dyes of a corner as one.
struct UpglowPair {
    quantum_yield: f32,
    mean_nm: f32,
    emitted: f32, // area of the emission
}

fn upglow_pair(c: UpglowCorner) -> UpglowPair {
    let first: vec4f = upglow_dye_numbers(c.dye);
    let second: vec4f = upglow_dye_numbers(upglow_next(c.dye));
    var pair: UpglowPair;
    pair.quantum_yield = mix(first.x, second.x, c.second);
    pair.mean_nm = mix(first.y, second.y, c.second);
    pair.emitted = mix(first.w, second.w, c.second);
    return pair;
}

// The density with which a corner's dyes emit, 1/nm.
fn upglow_emission(c: UpglowCorner, nm: f32) -> f32 {
    let first: UpglowCurves = upglow_dye_curves(c.dye, nm);
    let second: UpglowCurves = upglow_dye_curves(upglow_next(c.dye), nm);
    return mix(first.emission, second.emission, c.second);
}

// Share of the light at nm that a corner gives back by fluorescence, 0 to 1.
fn upglow_returned(c: UpglowCorner, nm: f32) -> f32 {
    let pair: UpglowPair = upglow_pair(c);
    return upglow_absorbed(c, nm) * pair.quantum_yield * upglow_share(nm, pair.mean_nm);
}

// What a corner adds to the re-radiation, 1/nm.
fn upglow_moved(c: UpglowCorner, in_nm: f32, out_nm: f32) -> f32 {
    if (c.concentration <= 0.0) {
        return 0.0;
    }
    return c.weight * upglow_returned(c, in_nm) * upglow_emission(c, out_nm);
}

// The integral of a corner's re-radiation to out_nm over incident wavelengths.
fn upglow_leaving(c: UpglowCorner, out_nm: f32) -> f32 {
    if (c.concentration <= 0.0) {
        return 0.0;
    }
    return c.weight * c.returned_nm * upglow_emission(c, out_nm);
}

// The integral of a corner's re-radiation from in_nm over outgoing wavelengths.
fn upglow_arriving(c: UpglowCorner, in_nm: f32) -> f32 {
    if (c.concentration <= 0.0) {
        return 0.0;
    }
    let pair: UpglowPair = upglow_pair(c);
    return c.weight * upglow_returned(c, in_nm) * pair.emitted;
}

// An incident wavelength with the density of what a corner gives back.
fn upglow_draw_incident(c: UpglowCorner, out_nm: f32, rest: f32, u: f32) -> f32 {
    let pair: UpglowPair = upglow_pair(c);
    let first: f32 = (1.0 - c.second) * upglow_absorbed_total(c.dye, pair.mean_nm);
    let second: f32 = c.second * upglow_absorbed_total(upglow_next(c.dye), pair.mean_nm);
    let value: f32 = u * (first + second);
    if (value >= first && second > 0.0) {
        return upglow_draw_absorbed(upglow_next(c.dye), pair.mean_nm, (value - first) / second);
    }
    return upglow_draw_absorbed(c.dye, pair.mean_nm, value / max(first, UPGLOW_TINY));
}

// An outgoing wavelength with the density of a corner's emission.
fn upglow_draw_outgoing(c: UpglowCorner, in_nm: f32, rest: f32, u: f32) -> f32 {
    let numbers: vec4f = upglow_dye_numbers(c.dye);
    let next_numbers: vec4f = upglow_dye_numbers(upglow_next(c.dye));
    let first: f32 = (1.0 - c.second) * numbers.w;
    let second: f32 = c.second * next_numbers.w;
    let value: f32 = u * (first + second);
    if (value >= first && second > 0.0) {
        return upglow_draw_emitted(upglow_next(c.dye), (value - first) / second);
    }
    return upglow_draw_emitted(c.dye, value / max(first, UPGLOW_TINY));
}
//@end
//@if separate

// Share of the light at nm that a dye by itself gives back at concentration 1, 0 to 1.
fn upglow_dye_returned(dye: i32, nm: f32) -> f32 {
    let curves: UpglowCurves = upglow_dye_curves(dye, nm);
    let numbers: vec4f = upglow_dye_numbers(dye);
    return curves.absorption * numbers.x * upglow_share(nm, numbers.y);
}

// Share of the light at nm that a corner gives back by fluorescence, 0 to 1.
fn upglow_returned(c: UpglowCorner, nm: f32) -> f32 {
    if (c.concentration <= 0.0) {
        return 0.0;
    }
    let first: f32 = upglow_dye_returned(c.dye, nm);
    let second: f32 = upglow_dye_returned(upglow_next(c.dye), nm);
    return c.concentration * mix(first, second, c.second);
}

// The re-radiation of one dye of a material, whose share of it is given, 1/nm.
fn upglow_dye_moved(share: f32, dye: i32, in_nm: f32, out_nm: f32) -> f32 {
    let curves: UpglowCurves = upglow_dye_curves(dye, out_nm);
    return share * upglow_dye_returned(dye, in_nm) * curves.emission;
}

// The integral of upglow_dye_moved over incident wavelengths.
fn upglow_dye_leaving(share: f32, dye: i32, out_nm: f32) -> f32 {
    let curves: UpglowCurves = upglow_dye_curves(dye, out_nm);
    let numbers: vec4f = upglow_dye_numbers(dye);
    return share * numbers.z * curves.emission;
}

// The integral of upglow_dye_moved over outgoing wavelengths.
fn upglow_dye_arriving(share: f32, dye: i32, in_nm: f32) -> f32 {
    let numbers: vec4f = upglow_dye_numbers(dye);
    return share * upglow_dye_returned(dye, in_nm) * numbers.w;
}

// What a corner adds to the re-radiation, 1/nm.
fn upglow_moved(c: UpglowCorner, in_nm: f32, out_nm: f32) -> f32 {
    if (c.concentration <= 0.0) {
        return 0.0;
    }
    let share: f32 = c.weight * c.concentration;
    return upglow_dye_moved(share * (1.0 - c.second), c.dye, in_nm, out_nm)
        + upglow_dye_moved(share * c.second, upglow_next(c.dye), in_nm, out_nm);
}

// The integral of a corner's re-radiation to out_nm over incident wavelengths.
fn upglow_leaving(c: UpglowCorner, out_nm: f32) -> f32 {
    if (c.concentration <= 0.0) {
        return 0.0;
    }
    let share: f32 = c.weight * c.concentration;
    return upglow_dye_leaving(share * (1.0 - c.second), c.dye, out_nm)
        + upglow_dye_leaving(share * c.second, upglow_next(c.dye), out_nm);
}

// The integral of a corner's re-radiation from in_nm over outgoing wavelengths.
fn upglow_arriving(c: UpglowCorner, in_nm: f32) -> f32 {
    if (c.concentration <= 0.0) {
        return 0.0;
    }
    let share: f32 = c.weight * c.concentration;
    return upglow_dye_arriving(share * (1.0 - c.second), c.dye, in_nm)
        + upglow_dye_arriving(share * c.second, upglow_next(c.dye), in_nm);
}

// An incident wavelength with the density of what one of a corner's dyes gives back: the one on
// which falls what is left of the choice between corners.
fn upglow_draw_incident(c: UpglowCorner, out_nm: f32, rest: f32, u: f32) -> f32 {
    let share: f32 = c.weight * c.concentration;
    let first: f32 = upglow_dye_leaving(share * (1.0 - c.second), c.dye, out_nm);
    let second: f32 = upglow_dye_leaving(share * c.second, upglow_next(c.dye), out_nm);
    var dye: i32 = c.dye;
    if (rest >= first && second > 0.0) {
        dye = upglow_next(c.dye);
    }
    let numbers: vec4f = upglow_dye_numbers(dye);
    return upglow_draw_absorbed(dye, numbers.y, u);
}

// An outgoing wavelength with the density of one dye's emission, chosen likewise.
fn upglow_draw_outgoing(c: UpglowCorner, in_nm: f32, rest: f32, u: f32) -> f32 {
    let share: f32 = c.weight * c.concentration;
    let first: f32 = upglow_dye_arriving(share * (1.0 - c.second), c.dye, in_nm);
    let second: f32 = upglow_dye_arriving(share * c.second, upglow_next(c.dye), in_nm);
    if (rest >= first && second > 0.0) {
        return upglow_draw_emitted(upglow_next(c.dye), u);
    }
    return upglow_draw_emitted(c.dye, u);
}
//@end
