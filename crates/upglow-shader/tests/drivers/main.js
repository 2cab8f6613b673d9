
// Answers queries, rows of 8 numbers, by rows of 16.
export function answer(textures, queries) {
    const f = upglow(textures);
    const answers = new Float64Array(2 * queries.length);
    for (let q = 0; q < queries.length; q += 8) {
        const [red, green, blue, in_nm, out_nm, choice, u] = queries.subarray(q, q + 8);
        const m = f.upglow_look_up([red, green, blue]);
        const came = f.upglow_sample_incident(m, out_nm, choice, u);
        const left = f.upglow_sample_outgoing(m, in_nm, choice, u);
        const row = [
            f.upglow_reflectance(m, in_nm),
            f.upglow_albedo(m, in_nm),
            f.upglow_reradiation(m, in_nm, out_nm),
            f.upglow_incident_pdf(m, in_nm, out_nm),
            f.upglow_incident_elastic(m, out_nm),
            f.upglow_outgoing_pdf(m, in_nm, out_nm),
            f.upglow_outgoing_elastic(m, in_nm),
            ...[came, left].flatMap((s) => [s.nm, s.throughput, s.pdf, s.elastic ? 1 : 0]),
            [m.a, m.b, m.c, m.d].reduce((sum, corner) => sum + corner.weight * corner.node, 0),
        ];
        answers.set(row, 2 * q);
    }
    return answers;
}
