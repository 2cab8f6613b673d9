
@group(0) @binding(2) var<storage, read> queries: array<f32>;
@group(0) @binding(3) var<storage, read_write> answers: array<f32>;

// What each of the four numbers of light becomes.
@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) id: vec3u) {
    let q = 8u * id.x;
    if (q >= arrayLength(&queries)) {
        return;
    }
    let m = upglow_matrix(vec3f(queries[q], queries[q + 1u], queries[q + 2u]));
    for (var k = 0u; k < 4u; k += 1u) {
        let is_lit = select(vec4f(0.0), vec4f(1.0), vec4u(0u, 1u, 2u, 3u) == vec4u(k));
        let light = UpglowLight(is_lit.x, is_lit.y, is_lit.z, is_lit.w);
        let leaves = upglow_relit(m, light);
        let a = 16u * id.x + 4u * k;
        answers[a] = leaves.red;
        answers[a + 1u] = leaves.green;
        answers[a + 2u] = leaves.blue;
        answers[a + 3u] = leaves.ultraviolet;
    }
}
