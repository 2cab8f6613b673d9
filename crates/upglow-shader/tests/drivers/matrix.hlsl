
StructuredBuffer<float> queries : register(t2);
RWStructuredBuffer<float> answers : register(u3);

// What each of the four numbers of light becomes.
[numthreads(64, 1, 1)]
void main(uint3 id : SV_DispatchThreadID) {
    uint count;
    uint stride;
    queries.GetDimensions(count, stride);
    uint q = 8 * id.x;
    if (q >= count) {
        return;
    }
    UpglowMatrix m = upglow_matrix(float3(queries[q], queries[q + 1], queries[q + 2]));
    for (uint k = 0; k < 4; k += 1) {
        UpglowLight light;
        light.red = k == 0 ? 1.0 : 0.0;
        light.green = k == 1 ? 1.0 : 0.0;
        light.blue = k == 2 ? 1.0 : 0.0;
        light.ultraviolet = k == 3 ? 1.0 : 0.0;
        UpglowLight leaves = upglow_relit(m, light);
        uint a = 16 * id.x + 4 * k;
        answers[a] = leaves.red;
        answers[a + 1] = leaves.green;
        answers[a + 2] = leaves.blue;
        answers[a + 3] = leaves.ultraviolet;
    }
}
