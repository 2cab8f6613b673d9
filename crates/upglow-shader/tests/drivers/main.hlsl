
StructuredBuffer<float> queries : register(t2);
RWStructuredBuffer<float> answers : register(u3);

[numthreads(64, 1, 1)]
void main(uint3 id : SV_DispatchThreadID) {
    uint count;
    uint stride;
    queries.GetDimensions(count, stride);
    uint q = 8 * id.x;
    uint a = 16 * id.x;
    if (q >= count) {
        return;
    }
    UpglowMaterial m = upglow_look_up(float3(queries[q], queries[q + 1], queries[q + 2]));
    float in_nm = queries[q + 3];
    float out_nm = queries[q + 4];
    answers[a] = upglow_reflectance(m, in_nm);
    answers[a + 1] = upglow_albedo(m, in_nm);
    answers[a + 2] = upglow_reradiation(m, in_nm, out_nm);
    answers[a + 3] = upglow_incident_pdf(m, in_nm, out_nm);
    answers[a + 4] = upglow_incident_elastic(m, out_nm);
    answers[a + 5] = upglow_outgoing_pdf(m, in_nm, out_nm);
    answers[a + 6] = upglow_outgoing_elastic(m, in_nm);
    UpglowSample came = upglow_sample_incident(m, out_nm, queries[q + 5], queries[q + 6]);
    answers[a + 7] = came.nm;
    answers[a + 8] = came.throughput;
    answers[a + 9] = came.pdf;
    answers[a + 10] = came.elastic ? 1.0 : 0.0;
    UpglowSample left = upglow_sample_outgoing(m, in_nm, queries[q + 5], queries[q + 6]);
    answers[a + 11] = left.nm;
    answers[a + 12] = left.throughput;
    answers[a + 13] = left.pdf;
    answers[a + 14] = left.elastic ? 1.0 : 0.0;
}
