
@group(0) @binding(2) var<storage, read> queries: array<f32>;
@group(0) @binding(3) var<storage, read_write> answers: array<f32>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let q = 8u * id.x;
    let a = 16u * id.x;
    if (q >= arrayLength(&queries)) {
        return;
    }
    let m = upglow_look_up(vec3f(queries[q], queries[q + 1u], queries[q + 2u]));
    let in_nm = queries[q + 3u];
    let out_nm = queries[q + 4u];
    answers[a] = upglow_reflectance(m, in_nm);
    answers[a + 1u] = upglow_albedo(m, in_nm);
    answers[a + 2u] = upglow_reradiation(m, in_nm, out_nm);
    answers[a + 3u] = upglow_incident_pdf(m, in_nm, out_nm);
    answers[a + 4u] = upglow_incident_elastic(m, out_nm);
    answers[a + 5u] = upglow_outgoing_pdf(m, in_nm, out_nm);
    answers[a + 6u] = upglow_outgoing_elastic(m, in_nm);
    let came = upglow_sample_incident(m, out_nm, queries[q + 5u], queries[q + 6u]);
    answers[a + 7u] = came.nm;
    answers[a + 8u] = came.throughput;
    answers[a + 9u] = came.pdf;
    answers[a + 10u] = select(0.0, 1.0, came.elastic);
    let left = upglow_sample_outgoing(m, in_nm, queries[q + 5u], queries[q + 6u]);
    answers[a + 11u] = left.nm;
    answers[a + 12u] = left.throughput;
    answers[a + 13u] = left.pdf;
    answers[a + 14u] = select(0.0, 1.0, left.elastic);
}
