// A wavelength drawn from a material.
struct UpglowSample {
    nm: f32, // the wavelength drawn
    throughput: f32, // factor of the path's throughput; 0 for nothing
    pdf: f32, // 1/nm; of an elastic draw its probability
    elastic: bool, // whether the wavelength was kept
}

fn upglow_ratio(part: f32, whole: f32) -> f32 {
    if (whole > 0.0) {
        return part / whole;
    }
    return 0.0;
}

// A draw that keeps the wavelength.
fn upglow_elastic_sample(nm: f32, reflected: f32, throughput: f32) -> UpglowSample {
    var drawn: UpglowSample;
    drawn.nm = nm;
    drawn.throughput = throughput;
    drawn.pdf = upglow_ratio(reflected, throughput);
    drawn.elastic = true;
    return drawn;
}
//@if passive

// Draws the wavelength of incident light, given that of light that leaves: the camera's way.
fn upglow_sample_incident(m: UpglowMaterial, out_nm: f32, choice: f32, u: f32) -> UpglowSample {
    let reflected: f32 = upglow_reflectance(m, out_nm);
    return upglow_elastic_sample(out_nm, reflected, reflected);
}

// The density with which upglow_sample_incident draws in_nm by fluorescence, 1/nm.
fn upglow_incident_pdf(m: UpglowMaterial, in_nm: f32, out_nm: f32) -> f32 {
    return 0.0;
}

// The probability that upglow_sample_incident keeps the wavelength.
fn upglow_incident_elastic(m: UpglowMaterial, out_nm: f32) -> f32 {
    let reflected: f32 = upglow_reflectance(m, out_nm);
    return upglow_ratio(reflected, reflected);
}

// Draws the wavelength of light that leaves, given that of incident light: the light's way.
fn upglow_sample_outgoing(m: UpglowMaterial, in_nm: f32, choice: f32, u: f32) -> UpglowSample {
    return upglow_sample_incident(m, in_nm, choice, u);
}

// The density with which upglow_sample_outgoing draws out_nm by fluorescence, 1/nm.
fn upglow_outgoing_pdf(m: UpglowMaterial, in_nm: f32, out_nm: f32) -> f32 {
    return 0.0;
}

// The probability that upglow_sample_outgoing keeps the wavelength.
fn upglow_outgoing_elastic(m: UpglowMaterial, in_nm: f32) -> f32 {
    return upglow_incident_elastic(m, in_nm);
}
//@end
//@if fluorescent

// What each corner carries at the known wavelength.
struct UpglowShares {
    elastic: f32,
    a: f32,
    b: f32,
    c: f32,
    d: f32,
    total: f32,
}

fn upglow_shares(reflected: f32, a: f32, b: f32, c: f32, d: f32) -> UpglowShares {
    var shares: UpglowShares;
    shares.elastic = reflected;
    shares.a = a;
    shares.b = b;
    shares.c = c;
    shares.d = d;
    shares.total = reflected + a + b + c + d;
    return shares;
}

// What leaves at out_nm of light that is 1 at every wavelength; of a film, what draws follow instead.
fn upglow_shares_leaving(m: UpglowMaterial, out_nm: f32) -> UpglowShares {
    return upglow_shares(
        upglow_reflectance(m, out_nm), upglow_leaving(m.a, out_nm), upglow_leaving(m.b, out_nm),
        upglow_leaving(m.c, out_nm), upglow_leaving(m.d, out_nm));
}

// What leaves of light at in_nm.
fn upglow_shares_arriving(m: UpglowMaterial, in_nm: f32) -> UpglowShares {
    return upglow_shares(
        upglow_reflectance(m, in_nm), upglow_arriving(m.a, in_nm), upglow_arriving(m.b, in_nm),
        upglow_arriving(m.c, in_nm), upglow_arriving(m.d, in_nm));
}

// A corner, and what is left of the choice between corners.
struct UpglowChoice {
    corner: UpglowCorner,
    rest: f32,
}

// The corner on which the rest of a choice falls; for one beyond all, the last that carries
// anything.
fn upglow_choose(m: UpglowMaterial, shares: UpglowShares, rest: f32) -> UpglowChoice {
    var chosen: UpglowChoice;
    chosen.corner = m.a;
    chosen.rest = rest;
    let to_b: f32 = shares.a;
    let to_c: f32 = to_b + shares.b;
    let to_d: f32 = to_c + shares.c;
    if (rest >= to_b && shares.b > 0.0) {
        chosen.corner = m.b;
        chosen.rest = rest - to_b;
    }
    if (rest >= to_c && shares.c > 0.0) {
        chosen.corner = m.c;
        chosen.rest = rest - to_c;
    }
    if (rest >= to_d && shares.d > 0.0) {
        chosen.corner = m.d;
        chosen.rest = rest - to_d;
    }
    return chosen;
}

// Whether a choice falls on reflection.
fn upglow_keeps(shares: UpglowShares, choice: f32) -> bool {
    return choice * shares.total < shares.elastic || shares.total <= shares.elastic;
}

fn upglow_shifted_sample(nm: f32, reradiation: f32, throughput: f32) -> UpglowSample {
    var drawn: UpglowSample;
    drawn.nm = nm;
    drawn.throughput = throughput;
    drawn.pdf = reradiation / throughput;
    drawn.elastic = false;
    return drawn;
}

// What upglow_sample_incident draws in_nm in proportion to, 1/nm.
//@end
//@if concentrated
fn upglow_drawn(m: UpglowMaterial, in_nm: f32, out_nm: f32) -> f32 {
    return upglow_reradiation(m, in_nm, out_nm);
}
//@end
//@if film
fn upglow_drawn(m: UpglowMaterial, in_nm: f32, out_nm: f32) -> f32 {
    let a: f32 = upglow_proposed_moved(m.a, in_nm, out_nm);
    let b: f32 = upglow_proposed_moved(m.b, in_nm, out_nm);
    let c: f32 = upglow_proposed_moved(m.c, in_nm, out_nm);
    let d: f32 = upglow_proposed_moved(m.d, in_nm, out_nm);
    return a + b + c + d;
}
//@end
//@if fluorescent

// Draws the wavelength of incident light, given that of light that leaves: the camera's way.
// choice and u are independent numbers in 0 to 1: the first chooses between reflection and
// fluorescence, the second draws the wavelength.
fn upglow_sample_incident(m: UpglowMaterial, out_nm: f32, choice: f32, u: f32) -> UpglowSample {
    let shares: UpglowShares = upglow_shares_leaving(m, out_nm);
    let bound_choice: f32 = upglow_within(choice, 0.0, UPGLOW_BELOW_ONE);
    if (upglow_keeps(shares, bound_choice)) {
        return upglow_elastic_sample(out_nm, shares.elastic, shares.total);
    }
    let rest: f32 = bound_choice * shares.total - shares.elastic;
    let chosen: UpglowChoice = upglow_choose(m, shares, rest);
    let bound_u: f32 = upglow_within(u, 0.0, UPGLOW_BELOW_ONE);
    let in_nm: f32 = upglow_draw_incident(chosen.corner, out_nm, chosen.rest, bound_u);
    let density: f32 = upglow_drawn(m, in_nm, out_nm);
//@end
//@if concentrated
    return upglow_shifted_sample(in_nm, density, shares.total);
//@end
//@if film
    var drawn: UpglowSample = upglow_shifted_sample(in_nm, density, shares.total);
    drawn.throughput *= upglow_ratio(upglow_reradiation(m, in_nm, out_nm), density);
    return drawn;
//@end
//@if fluorescent
}

// The density with which upglow_sample_incident draws in_nm by fluorescence, 1/nm.
fn upglow_incident_pdf(m: UpglowMaterial, in_nm: f32, out_nm: f32) -> f32 {
    let shares: UpglowShares = upglow_shares_leaving(m, out_nm);
    return upglow_ratio(upglow_drawn(m, in_nm, out_nm), shares.total);
}

// The probability that upglow_sample_incident keeps the wavelength.
fn upglow_incident_elastic(m: UpglowMaterial, out_nm: f32) -> f32 {
    let shares: UpglowShares = upglow_shares_leaving(m, out_nm);
    return upglow_ratio(shares.elastic, shares.total);
}

// Draws the wavelength of light that leaves, given that of incident light: the light's way.
// choice and u are as for upglow_sample_incident.
fn upglow_sample_outgoing(m: UpglowMaterial, in_nm: f32, choice: f32, u: f32) -> UpglowSample {
    let shares: UpglowShares = upglow_shares_arriving(m, in_nm);
    let bound_choice: f32 = upglow_within(choice, 0.0, UPGLOW_BELOW_ONE);
    if (upglow_keeps(shares, bound_choice)) {
        return upglow_elastic_sample(in_nm, shares.elastic, shares.total);
    }
    let rest: f32 = bound_choice * shares.total - shares.elastic;
    let chosen: UpglowChoice = upglow_choose(m, shares, rest);
    let bound_u: f32 = upglow_within(u, 0.0, UPGLOW_BELOW_ONE);
    let out_nm: f32 = upglow_draw_outgoing(chosen.corner, in_nm, chosen.rest, bound_u);
    return upglow_shifted_sample(out_nm, upglow_reradiation(m, in_nm, out_nm), shares.total);
}

// The density with which upglow_sample_outgoing draws out_nm by fluorescence, 1/nm.
fn upglow_outgoing_pdf(m: UpglowMaterial, in_nm: f32, out_nm: f32) -> f32 {
    let shares: UpglowShares = upglow_shares_arriving(m, in_nm);
    return upglow_ratio(upglow_reradiation(m, in_nm, out_nm), shares.total);
}

// The probability that upglow_sample_outgoing keeps the wavelength.
fn upglow_outgoing_elastic(m: UpglowMaterial, in_nm: f32) -> f32 {
    let shares: UpglowShares = upglow_shares_arriving(m, in_nm);
    return upglow_ratio(shares.elastic, shares.total);
}
//@end
