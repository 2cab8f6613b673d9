//@if energy
// Share of the absorbed energy that can come out: all of it.
fn upglow_share(nm: f32, mean_nm: f32) -> f32 {
    return 1.0;
}
//@end
//@if photon
// Share of the absorbed energy at nm that can come out around mean_nm, photon by photon, 0 to 1.
fn upglow_share(nm: f32, mean_nm: f32) -> f32 {
    if (nm < mean_nm) {
        return upglow_within(nm / mean_nm, 0.0, 1.0);
    }
    return 1.0;
}
//@end
