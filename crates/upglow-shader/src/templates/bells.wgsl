// The cubic B-spline of unit step and area around 0.
fn upglow_bell(u: f32) -> f32 {
    let v: f32 = abs(u);
    if (v < 1.0) {
        return 2.0 / 3.0 + v * v * (0.5 * v - 1.0);
    }
    if (v < 2.0) {
        let tail: f32 = 2.0 - v;
        return tail * tail * tail / 6.0;
    }
    return 0.0;
}

// The area of the bell left of u.
fn upglow_bell_area(u: f32) -> f32 {
    let v: f32 = abs(u);
    var right: f32 = 0.0;
    if (v < 1.0) {
        right = 0.5 - v * (2.0 / 3.0 + v * v * (v / 8.0 - 1.0 / 3.0));
    } else if (v < 2.0) {
        let tail: f32 = 2.0 - v;
        right = tail * tail * tail * tail / 24.0;
    }
    if (u < 0.0) {
        return right;
    }
    return 1.0 - right;
}

// The place below which u of the bell's area lies.
fn upglow_bell_quantile(u: f32) -> f32 {
    let lower: f32 = min(u, 1.0 - u);
    var v: f32 = 2.0 - sqrt(sqrt(24.0 * lower));
    if (lower > 1.0 / 24.0) {
        let y: f32 = 0.5 - lower;
        // The first two terms of the inverse series, and a third that is right where the tail
        // begins; Newton's steps from there.
        v = y * (1.5 + y * y * (1.6875 + y * y * 7.42));
        for (var newton: i32 = 0; newton < UPGLOW_NEWTON_STEPS; newton += 1) {
            v += (y - (upglow_bell_area(v) - 0.5)) / upglow_bell(v);
        }
    }
    if (u < 0.5) {
        return -v;
    }
    return v;
}

// Share of the light at nm that a corner absorbs by fluorescence, 0 to 1.
fn upglow_absorbed(c: UpglowCorner, nm: f32) -> f32 {
    let bound_nm: f32 = upglow_within(nm, 0.0, UPGLOW_FARTHEST_NM);
    let u: f32 = (bound_nm - c.absorption_nm) / UPGLOW_ABSORPTION_STEP_NM;
    return c.concentration * 1.5 * upglow_bell(u);
}

// The density with which a corner emits, 1/nm.
fn upglow_emission(c: UpglowCorner, nm: f32) -> f32 {
    let bound_nm: f32 = upglow_within(nm, 0.0, UPGLOW_FARTHEST_NM);
    let u: f32 = (bound_nm - c.emission_nm) / UPGLOW_EMISSION_STEP_NM;
    return upglow_bell(u) / UPGLOW_EMISSION_STEP_NM;
}

// Share of the light at nm that a corner gives back by fluorescence, 0 to 1.
fn upglow_returned(c: UpglowCorner, nm: f32) -> f32 {
    return upglow_absorbed(c, nm) * UPGLOW_QUANTUM_YIELD * upglow_share(nm, c.emission_nm);
}

// What a corner adds to the re-radiation, 1/nm.
fn upglow_moved(c: UpglowCorner, in_nm: f32, out_nm: f32) -> f32 {
    return c.weight * upglow_returned(c, in_nm) * upglow_emission(c, out_nm);
}

// The integral of a corner's re-radiation to out_nm over incident wavelengths.
fn upglow_leaving(c: UpglowCorner, out_nm: f32) -> f32 {
    return c.weight * c.returned_nm * upglow_emission(c, out_nm);
}

// The integral of a corner's re-radiation from in_nm over outgoing wavelengths.
fn upglow_arriving(c: UpglowCorner, in_nm: f32) -> f32 {
    return c.weight * upglow_returned(c, in_nm);
}
//@if energy

// An incident wavelength with the density of what a corner gives back.
fn upglow_draw_incident(c: UpglowCorner, out_nm: f32, rest: f32, u: f32) -> f32 {
    return c.absorption_nm + UPGLOW_ABSORPTION_STEP_NM * upglow_bell_quantile(u);
}
//@end
//@if photon

// The integral of v times the bell over v left of u.
fn upglow_bell_moment(u: f32) -> f32 {
    let v: f32 = abs(u);
    if (v < 1.0) {
        return -(7.0 / 30.0 - v * v * (1.0 / 3.0 - v * v * (0.25 - v / 10.0)));
    }
    if (v < 2.0) {
        let tail: f32 = 2.0 - v;
        return -tail * tail * tail * tail * (1.0 / 12.0 - tail / 30.0);
    }
    return 0.0;
}

// The integral of a corner's absorption times upglow_share below a wavelength, over its area.
fn upglow_given_below(c: UpglowCorner, nm: f32) -> f32 {
    let h: f32 = UPGLOW_ABSORPTION_STEP_NM;
    let to: f32 = (nm - c.absorption_nm) / h;
    let rising_to: f32 = (min(nm, c.emission_nm) - c.absorption_nm) / h;
    let rising: f32 = upglow_bell_area(rising_to);
    let moment: f32 = c.absorption_nm * rising + h * upglow_bell_moment(rising_to);
    return moment / c.emission_nm + upglow_bell_area(to) - rising;
}

// An incident wavelength with the density of what a corner gives back: Newton's steps, halvings
// where they leave the bracket.
fn upglow_draw_incident(c: UpglowCorner, out_nm: f32, rest: f32, u: f32) -> f32 {
    var low: f32 = c.absorption_nm - 2.0 * UPGLOW_ABSORPTION_STEP_NM;
    var high: f32 = c.absorption_nm + 2.0 * UPGLOW_ABSORPTION_STEP_NM;
    let value: f32 = u * upglow_given_below(c, high);
    var nm: f32 = c.absorption_nm + UPGLOW_ABSORPTION_STEP_NM * upglow_bell_quantile(u);
    for (var newton: i32 = 0; newton < UPGLOW_BRACKETED_STEPS; newton += 1) {
        let excess: f32 = upglow_given_below(c, nm) - value;
        if (excess > 0.0) {
            high = nm;
        } else {
            low = nm;
        }
        let bell: f32 = upglow_bell((nm - c.absorption_nm) / UPGLOW_ABSORPTION_STEP_NM);
        let slope: f32 = bell / UPGLOW_ABSORPTION_STEP_NM * upglow_share(nm, c.emission_nm);
        let next: f32 = nm - excess / max(slope, UPGLOW_TINY);
        nm = 0.5 * (low + high);
        if (next >= low && next <= high) {
            nm = next;
        }
    }
    return nm;
}
//@end

// An outgoing wavelength with the density of a corner's emission.
fn upglow_draw_outgoing(c: UpglowCorner, in_nm: f32, rest: f32, u: f32) -> f32 {
    return c.emission_nm + UPGLOW_EMISSION_STEP_NM * upglow_bell_quantile(u);
}
