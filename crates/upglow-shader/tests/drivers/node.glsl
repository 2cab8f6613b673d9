
layout(local_size_x = 64) in;
layout(set = 0, binding = 0) uniform texture2D node_colors;
layout(set = 0, binding = 2, std430) readonly buffer Queries { float queries[]; };
layout(set = 0, binding = 3, std430) buffer Answers { float answers[]; };

void main() {
    uint q = 8u * gl_GlobalInvocationID.x;
    uint a = 16u * gl_GlobalInvocationID.x;
    if (q >= uint(queries.length())) {
        return;
    }
    vec3 result;
    upglow_color(node_colors, vec3(queries[q], queries[q + 1u], queries[q + 2u]), result);
    answers[a] = result.r;
    answers[a + 1u] = result.g;
    answers[a + 2u] = result.b;
}
