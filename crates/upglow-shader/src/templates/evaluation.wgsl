// What a corner would reflect if it absorbed nothing for fluorescence.
fn upglow_corner_base(c: UpglowCorner, nm: f32) -> f32 {
    let d: f32 = nm - c.edge_nm;
    let x: f32 = c.level + d * (c.rise + d * c.bend);
    return c.weight * (0.5 + 0.5 * x / sqrt(1.0 + x * x));
}

fn upglow_corner_reflectance(c: UpglowCorner, nm: f32) -> f32 {
//@if fluorescent
    return upglow_corner_base(c, nm) * (1.0 - upglow_absorbed(c, nm));
//@end
//@if passive
    return upglow_corner_base(c, nm);
//@end
}

// Share of incident light at nm that is reflected at the same wavelength, 0 to 1.
fn upglow_reflectance(m: UpglowMaterial, nm: f32) -> f32 {
    let bound_nm: f32 = upglow_within(nm, 0.0, UPGLOW_FARTHEST_NM);
    let a: f32 = upglow_corner_reflectance(m.a, bound_nm);
    let b: f32 = upglow_corner_reflectance(m.b, bound_nm);
    let c: f32 = upglow_corner_reflectance(m.c, bound_nm);
    let d: f32 = upglow_corner_reflectance(m.d, bound_nm);
    return upglow_within(a + b + c + d, 0.0, 1.0);
}

// Energy that comes out per nm at out_nm by fluorescence, per unit that came in at in_nm; 1/nm.
fn upglow_reradiation(m: UpglowMaterial, in_nm: f32, out_nm: f32) -> f32 {
//@if fluorescent
    let ab: f32 = upglow_moved(m.a, in_nm, out_nm) + upglow_moved(m.b, in_nm, out_nm);
    let cd: f32 = upglow_moved(m.c, in_nm, out_nm) + upglow_moved(m.d, in_nm, out_nm);
    return ab + cd;
//@end
//@if passive
    return 0.0;
//@end
}

// Share of incident light at nm that comes out at any wavelength, 0 to 1.
fn upglow_albedo(m: UpglowMaterial, nm: f32) -> f32 {
//@if fluorescent
    let ab: f32 = m.a.weight * upglow_returned(m.a, nm) + m.b.weight * upglow_returned(m.b, nm);
    let cd: f32 = m.c.weight * upglow_returned(m.c, nm) + m.d.weight * upglow_returned(m.d, nm);
    return min(upglow_reflectance(m, nm) + ab + cd, 1.0);
//@end
//@if passive
    return upglow_reflectance(m, nm);
//@end
}
