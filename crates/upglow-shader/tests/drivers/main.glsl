
layout(local_size_x = 64) in;
layout(set = 0, binding = 2, std430) readonly buffer Queries { float queries[]; };
layout(set = 0, binding = 3, std430) buffer Answers { float answers[]; };

void main() {
    uint q = 8u * gl_GlobalInvocationID.x;
    uint a = 16u * gl_GlobalInvocationID.x;
    if (q >= uint(queries.length())) {
        return;
    }
    UpglowMaterial m = upglow_look_up(vec3(queries[q], queries[q + 1u], queries[q + 2u]));
    float in_nm = queries[q + 3u];
    float out_nm = queries[q + 4u];
    answers[a] = upglow_reflectance(m, in_nm);
    answers[a + 1u] = upglow_albedo(m, in_nm);
    answers[a + 2u] = upglow_reradiation(m, in_nm, out_nm);
    answers[a + 3u] = upglow_incident_pdf(m, in_nm, out_nm);
    answers[a + 4u] = upglow_incident_elastic(m, out_nm);
    answers[a + 5u] = upglow_outgoing_pdf(m, in_nm, out_nm);
    answers[a + 6u] = upglow_outgoing_elastic(m, in_nm);
    UpglowSample came = upglow_sample_incident(m, out_nm, queries[q + 5u], queries[q + 6u]);
    answers[a + 7u] = came.nm;
    answers[a + 8u] = came.throughput;
    answers[a + 9u] = came.pdf;
    answers[a + 10u] = came.elastic ? 1.0 : 0.0;
    UpglowSample left = upglow_sample_outgoing(m, in_nm, queries[q + 5u], queries[q + 6u]);
    answers[a + 11u] = left.nm;
    answers[a + 12u] = left.throughput;
    answers[a + 13u] = left.pdf;
    answers[a + 14u] = left.elastic ? 1.0 : 0.0;
}
