// A dye at one wavelength.
struct UpglowCurves {
    absorption: f32, // share of incident light at concentration 1, 0 to 1
    emission: f32, // density of unit area, 1/nm
}

// Where a wavelength lies among the samples of the curves.
struct UpglowPlace {
    bin: i32, // number of the sample before it; -1 outside all
    t: f32, // the distance from there in steps, 0 to 1
}

fn upglow_place(nm: f32) -> UpglowPlace {
    var place: UpglowPlace;
    place.bin = -1;
    place.t = 0.0;
    let steps: f32 = upglow_within(nm, 0.0, UPGLOW_FARTHEST_NM) - UPGLOW_FIRST_NM;
    if (steps >= 0.0 && steps <= f32(UPGLOW_BINS)) {
        place.bin = min(i32(steps), UPGLOW_BINS - 1);
        place.t = steps - f32(place.bin);
    }
    return place;
}

// The curves of a dye: straight lines between samples, zero beyond the last.
fn upglow_dye_curves(dye: i32, nm: f32) -> UpglowCurves {
    var curves: UpglowCurves;
    curves.absorption = 0.0;
    curves.emission = 0.0;
    let place: UpglowPlace = upglow_place(nm);
    if (place.bin >= 0) {
        let texel: vec4f = upglow_curve(2 * dye, place.bin);
        curves.absorption = texel.x + place.t * texel.y;
        curves.emission = texel.z + place.t * texel.w;
    }
    return curves;
}

// Quantum yield, mean emission (nm), what it returns by itself of light that is 1 at every
// wavelength (nm), and the area of its emission.
fn upglow_dye_numbers(dye: i32) -> vec4f {
    return upglow_curve(2 * dye, UPGLOW_BINS + 1);
}

//@if dyes
// Integrals of a dye's curves up to a sample: of the absorption, of the absorption times the
// wavelength, of the emission.
fn upglow_integral(dye: i32, sample_number: i32, which: i32) -> f32 {
    let texel: vec4f = upglow_curve(2 * dye + 1, sample_number);
    if (which == UPGLOW_ABSORPTION) {
        return texel.x;
    }
    if (which == UPGLOW_MOMENT) {
        return texel.y;
    }
    return texel.z;
}
//@end
//@if film
// The number of density level k in a texel of a film.
fn upglow_of_level(texel: vec4f, k: i32) -> f32 {
    if (k == 0) {
        return texel.x;
    }
    if (k == 1) {
        return texel.y;
    }
    if (k == 2) {
        return texel.z;
    }
    return texel.w;
}

// Integrals of a dye's curves up to a sample: of what it returns at a density level, or of the
// emission.
fn upglow_integral(dye: i32, sample_number: i32, which: i32) -> f32 {
    if (which == UPGLOW_EMISSION) {
        let texel: vec4f = upglow_curve(2 * dye + 1, sample_number);
        return texel.z;
    }
    return upglow_of_level(upglow_curve(2 * (UPGLOW_DYES + dye) + 1, sample_number), which);
}
//@end

// The bin of 1 nm in which an integral reaches a value.
fn upglow_bin(dye: i32, which: i32, value: f32) -> i32 {
    var low: i32 = 0;
    var high: i32 = UPGLOW_BINS;
    for (var halving: i32 = 0; halving < UPGLOW_HALVINGS; halving += 1) {
        let middle: i32 = i32((low + high) / 2);
        if (upglow_integral(dye, middle, which) <= value) {
            low = middle;
        } else {
            high = middle;
        }
    }
    return min(low, UPGLOW_BINS - 1);
}

// The t, 0 to 1, at which a density that begins with start and grows by rise has this area.
fn upglow_trapezoid(start: f32, rise: f32, area: f32) -> f32 {
    let root: f32 = sqrt(max(start * start + 2.0 * area * rise, 0.0));
    if (start + root > 0.0) {
        return upglow_within(2.0 * area / (start + root), 0.0, 1.0);
    }
    return 0.0;
}

// A wavelength with the density of a dye's emission, from u in 0 to 1.
fn upglow_draw_emitted(dye: i32, u: f32) -> f32 {
    let area: f32 = u * upglow_integral(dye, UPGLOW_BINS, UPGLOW_EMISSION);
    let bin: i32 = upglow_bin(dye, UPGLOW_EMISSION, area);
    let texel: vec4f = upglow_curve(2 * dye, bin);
    let rest: f32 = area - upglow_integral(dye, bin, UPGLOW_EMISSION);
    return UPGLOW_FIRST_NM + f32(bin) + upglow_trapezoid(texel.z, texel.w, rest);
}
