
layout(local_size_x = 64) in;
layout(set = 0, binding = 2, std430) readonly buffer Queries { float queries[]; };
layout(set = 0, binding = 3, std430) buffer Answers { float answers[]; };

// What each of the four numbers of light becomes.
void main() {
    uint q = 8u * gl_GlobalInvocationID.x;
    if (q >= uint(queries.length())) {
        return;
    }
    UpglowMatrix m = upglow_matrix(vec3(queries[q], queries[q + 1u], queries[q + 2u]));
    for (uint k = 0u; k < 4u; k += 1u) {
        vec4 is_lit = vec4(equal(uvec4(0u, 1u, 2u, 3u), uvec4(k)));
        UpglowLight light = UpglowLight(is_lit.x, is_lit.y, is_lit.z, is_lit.w);
        UpglowLight leaves = upglow_relit(m, light);
        uint a = 16u * gl_GlobalInvocationID.x + 4u * k;
        answers[a] = leaves.red;
        answers[a + 1u] = leaves.green;
        answers[a + 2u] = leaves.blue;
        answers[a + 3u] = leaves.ultraviolet;
    }
}
