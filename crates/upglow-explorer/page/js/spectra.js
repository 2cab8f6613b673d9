// The spectra of the material: what it reflects, absorbs and sends out, and the light it is in.

import { multiply, SCREEN, cssColor } from "./color.js";
import { state } from "./state.js";
import { COARSE, FINE, FIRST_NM, STEP_NM, kept, radianceFactor } from "./cube.js";
import { element, svgElement } from "./dom.js";
import { WaveChart, colored, csvOf, download, px, standaloneSvg, steppedTop } from "./chart.js";

// The switches: what is drawn, how it is called in the list and at its line.
const CURVES = [
    { key: "total", name: "Total", label: "total radiance factor" },
    { key: "reflectance", name: "Reflectance", label: "reflectance" },
    { key: "base", name: "Base", label: "base reflectance" },
    { key: "slope", name: "Slope", label: "steepest slope of the base reflectance" },
    { key: "passed", name: "Let through", label: "what the dyes let through" },
    { key: "absorbed", name: "Dyes absorb", label: "what each dye absorbs" },
    { key: "emitted", name: "Dyes emit", label: "emission of each dye" },
    { key: "light", name: "Light", label: "light" },
    { key: "leaving", name: "Light leaving", label: "light leaving" },
    { key: "before", name: "Before", label: "cube before" },
];
const LABEL_OF = new Map(CURVES.map(({ key, label }) => [key, label]));
// Samples of lines in the list that are not a straight one.
const SAMPLES_OF = {
    absorbed: { d: "M0 8C6 8 6 0 10 0S14 8 20 8Z", class: "absorbed" },
    emitted: { d: "M0 7C6 7 6 1 10 1S14 7 20 7", class: "emitted" },
};
// Emission of this much per nanometer is drawn at 1, so that emission of common dyes fills half the chart.
const EMISSION_AT_1 = 0.04;
// Dyes of smaller doses are drawn fainter: a blend of nodes often has traces of some.
const FULL_DOSE = 0.05;
const LARGER = [1, 2, 5, 10, 20, 50, 100, 200, 500, 1000];
// Dyes that have a row of their own under the chart; the others share the row below.
const DYE_ROWS = 3;
// The axis ends at what is seen: at its ends a light may be so dim that any emission exceeds it.
const SEEN_NM = [390, 730];

const atNm = (nm) => nm - FIRST_NM;
const written = (value) => (Number.isNaN(value) || value === null ? "–" : value.toFixed(3));

export function makeSpectra(root, app) {
    // What the user switched; light that leaves is shown by itself only where radiance factors say little.
    const chosen = new Map();
    const isOn = (key) => chosen.get(key) ?? (key !== "leaving" || Boolean(shown?.isDark));
    let shown = null;

    const chart = new WaveChart({
        label: "Spectra by wavelength; arrow keys move, with Shift faster",
        title: { id: "spectra", text: "radiance factor (total: by 5 nm)" },
        heightOf: (width) => Math.round(Math.min(Math.max(0.54 * width, 272), 420)),
        colors: spectralColors(app.now.cube),
        onCursor: readOut,
        onSize: () => shown && drawLines(),
    });
    const over = chart.plot.appendChild(svgElement("path", { class: "over" }));
    const lines = new Map();
    const dyeLayer = svgElement("g");
    const addLines = (...keys) => keys.forEach((key) =>
        lines.set(key, chart.plot.appendChild(svgElement("path", { class: `curve ${key}` }))));
    addLines("light", "leaving");
    chart.plot.append(dyeLayer);
    addLines("passed", "base", "before-reflectance", "before-total", "total", "reflectance", "slope");
    const oneLine = chart.marks.appendChild(svgElement("path", { class: "one" }));

    const keys = element("div", { class: "keys", role: "group", "aria-label": "Lines shown" });
    const values = new Map();
    const buttons = new Map(CURVES.map(({ key, name, label }) => {
        const value = element("span", { class: "value", "aria-hidden": "true" });
        const sample = svgElement("svg", { viewBox: "0 0 20 8", class: "sample", "aria-hidden": "true" },
            svgElement("path", SAMPLES_OF[key] ?? { d: "M0 4H20", class: `curve ${key}` }));
        const button = element("button", { type: "button", title: label },
            sample, element("span", {}, name), value);
        button.addEventListener("click", () => {
            chosen.set(key, !isOn(key));
            drawLines();
        });
        values.set(key, value);
        keys.append(button);
        return [key, button];
    }));

    const table = makeDyeTable();
    const saving = (name, type, textOf) => {
        const button = element("button", { type: "button", "aria-label": `Save as ${name}` }, name);
        button.addEventListener("click", () => {
            const title = `Spectra of ${state.space} ${state.value.join(", ")} under ${shown.light.name}`;
            const file = title.replaceAll(/[^A-Za-z0-9.-]+/g, "-");
            download(`${file}.${name.toLowerCase()}`, type, textOf(title));
        });
        return button;
    };
    const head = element("div", { class: "head" }, root.querySelector("h2"),
        saving("CSV", "text/csv", asCsv),
        saving("SVG", "image/svg+xml", (title) => standaloneSvg(chart.svg, title)));
    root.append(head, chart.root, keys, table.root);

    // All lines that are drawn: values from 300 nm by steps.
    function curves() {
        const { sampled, factor, power, before } = shown;
        const list = [
            { key: "total", values: factor.total, stepNm: STEP_NM },
            { key: "reflectance", values: sampled.reflectance },
        ];
        if (sampled.fluoresces) {
            list.push({ key: "base", values: shown.base });
            list.push({ key: "passed", values: sampled.passed });
        }
        list.push({ key: "leaving", values: shown.leaving, stepNm: STEP_NM });
        list.push({ key: "light", values: power });
        if (before) {
            list.push({ key: "before", line: "before-total", values: before.total, stepNm: STEP_NM });
            list.push({ key: "before", line: "before-reflectance", values: before.reflectance });
        }
        return list.filter(({ key, values: v }) => v && isOn(key));
    }

    function drawLines() {
        for (const [key, button] of buttons) {
            button.setAttribute("aria-pressed", String(isOn(key)));
            button.classList.toggle("absent", shown.absent.has(key));
        }
        buttons.get("before").hidden = !shown.before;
        const drawn = curves();
        const peak = Math.max(...drawn.filter(({ key }) => key === "total" || key === "before")
            .map(({ values: v, stepNm = 1 }) => peakSeen(v, stepNm)), 0);
        chart.setTop(steppedTop(peak, chart.top, 1));
        if (chart.width === 0) {
            return;
        }
        const byLine = new Map(drawn.map((curve) => [curve.line ?? curve.key, curve]));
        for (const [name, path] of lines) {
            const curve = byLine.get(name);
            // Lines of light may be a nanometer wide; all else is smooth.
            path.setAttribute("d", curve
                ? chart.path(curve.values, curve.stepNm, curve.stepNm || name === "light" ? 1 : 2) : "");
        }
        const { total } = shown.factor;
        over.setAttribute("d", isOn("total") && peak > 1 ? chart.area(total, 1, STEP_NM) : "");
        const y = Math.round(chart.y(1)) + 0.5;
        oneLine.setAttribute("d", `M${px(chart.x(FIRST_NM))} ${y}H${px(chart.x(FIRST_NM + FINE - 1))}`);
        drawDyes();
        const slope = isOn("slope") ? drawSlope() : null;
        if (!slope) {
            lines.get("slope").setAttribute("d", "");
        }
        drawLabels(drawn, slope);
        readOut();
    }

    function drawDyes() {
        const parts = [];
        for (const dye of shown.dyes) {
            const paint = (d, kind) => {
                const path = svgElement("path", { d, class: `${kind} ${dye.kind}` });
                parts.push(colored(path, [...dye.color, ["--faint", Math.min(dye.dose / FULL_DOSE, 1)]]));
            };
            if (isOn("absorbed")) {
                paint(chart.area(dye.absorbed, 0, 1, 3), "absorbed");
            }
            if (isOn("emitted")) {
                paint(chart.path(dye.scaled, 1, 3), "emitted");
            }
        }
        dyeLayer.replaceChildren(...parts);
    }

    // The tangent at the steepest point; its place for the label.
    function drawSlope() {
        const { nm, perNm } = shown.steepest;
        if (Math.abs(perNm) < 5e-5) {
            return null;
        }
        const { base } = shown;
        const value = (base[atNm(Math.floor(nm))] + base[atNm(Math.ceil(nm))]) / 2;
        const across = chart.x(nm + 1) - chart.x(nm);
        const down = chart.y(value + perNm) - chart.y(value);
        const reach = 24 / Math.hypot(across, down);
        const [x, y] = [chart.x(nm), chart.y(value)];
        const end = (side) => `${px(x + side * reach * across)} ${px(y + side * reach * down)}`;
        lines.get("slope").setAttribute("d", `M${end(-1)}L${end(1)}`);
        return [nm, value];
    }

    function drawLabels(drawn, slope) {
        const items = drawn.map((curve) => ({
            ...curve, key: curve.line ?? curve.key, kind: curve.key,
            text: curve.key === "leaving" ? shown.leavingText : LABEL_OF.get(curve.key),
        })).filter(({ key }) => key !== "before-reflectance");
        // Without dyes the two are the same line, which has one label.
        const isOne = !shown.sampled.fluoresces && isOn("reflectance");
        const named = items.filter(({ key }) => key !== "total" || !isOne);
        if (isOne && isOn("total")) {
            named.find(({ key }) => key === "reflectance").text = "reflectance = total radiance factor";
        }
        const drawnLines = [...drawn];
        for (const dye of shown.dyes.filter(({ dose }) => dose >= FULL_DOSE)) {
            if (isOn("absorbed")) {
                named.splice(2, 0, {
                    key: `${dye.name} a`, text: `${dye.name}, ${shown.doseName} ${dye.dose.toFixed(2)}`,
                    short: dye.name, kind: dye.kind, color: dye.color, values: dye.absorbed,
                });
                drawnLines.push({ values: dye.absorbed });
            }
            if (isOn("emitted")) {
                named.push({
                    key: `${dye.name} e`, text: `emission (1 is ${EMISSION_AT_1}/nm)`,
                    short: "emission", kind: dye.kind, color: dye.color, values: dye.scaled,
                });
                drawnLines.push({ values: dye.scaled });
            }
        }
        if (slope) {
            const [short] = shown.slopeText.split(" under");
            named.splice(1, 0, { key: "slope", text: shown.slopeText, short, kind: "slope", at: slope });
        }
        const text = "1: as much as arrives";
        const one = { key: "one", text, kind: "light", values: [1, 1], stepNm: FINE, nearNm: 770 };
        named.splice(1, 0, one);
        drawnLines.push(one);
        chart.placeLabels(named, drawnLines);
    }

    // Values at the cursor: in the list, the table and, for screen readers, in words.
    function readOut() {
        const { nm } = chart;
        const { sampled, factor, power, before, steepest } = shown;
        const coarse = nm === null ? 0 : Math.round(atNm(nm) / STEP_NM);
        const valueOf = (list) => (list.length === COARSE ? list[coarse] : list[atNm(nm)]);
        const at = (list) => (nm === null || !list ? null : valueOf(list));
        const found = {
            total: at(factor.total), reflectance: at(sampled.reflectance), base: at(shown.base),
            passed: at(sampled.passed ?? null), light: at(power), leaving: at(factor.leaving),
            before: at(before?.total),
        };
        for (const [key, value] of Object.entries(found)) {
            values.get(key).textContent = nm === null ? "" : written(value);
        }
        values.get("slope").textContent = Math.abs(steepest.perNm).toFixed(4);
        table.draw(shown, nm === null ? null : atNm(nm));
        const words = CURVES.filter(({ key }) => (found[key] ?? null) !== null && isOn(key))
            .map(({ key, label }) => `${label} ${written(found[key])}`);
        const dyes = nm === null ? [] : shown.dyes.slice(0, DYE_ROWS)
            .map((dye) => `${dye.name} absorbs ${written(dye.absorbed[atNm(nm)])}`);
        chart.say(`${nm} nm: ${[...words, ...dyes].join(", ")}`);
        const dots = () => curves().map((curve) => ({ value: at(curve.values), kind: curve.key }));
        chart.showDots(nm === null ? [] : dots());
    }

    // What is on screen at every nanometer; radiance factors only where they are computed.
    function asCsv() {
        const columns = curves().map(({ key, line, values: v, stepNm = 1 }) => {
            // Not as it is drawn, perhaps larger.
            const all = key === "leaving" ? shown.factor.leaving : v;
            const valueAt = (i) => (i % stepNm === 0 ? all[i / stepNm] : null);
            return { name: (line ?? LABEL_OF.get(key)).replaceAll(/[ -]/g, "_"), valueAt };
        });
        for (const dye of shown.dyes) {
            if (isOn("absorbed")) {
                columns.push({ name: `absorbed by ${dye.name}`, valueAt: (i) => dye.absorbed[i] });
            }
            if (isOn("emitted")) {
                columns.push({ name: `emission of ${dye.name} per nm`, valueAt: (i) => dye.emission[i] });
            }
        }
        const row = (i) => [FIRST_NM + i, ...columns.map(({ valueAt }) => valueAt(i))];
        const rows = Array.from({ length: FINE }, (_, i) => row(i));
        return csvOf(["wavelength_nm", ...columns.map(({ name }) => name)], rows);
    }

    let drawn = [];
    return {
        draw(now) {
            const next = [now.sampled, now.light, state.uv, now.otherSampled];
            if (next.some((part, k) => part !== drawn[k])) {
                drawn = next;
                shown = describe(now);
                drawLines();
            }
        },
    };
}

function peakSeen(values, stepNm) {
    const [from, to] = SEEN_NM.map((nm) => atNm(nm) / stepNm);
    return values.slice(from, to + 1).reduce((peak, v) => (v > peak ? v : peak), 0);
}

// All that the chart shows of the state.
function describe(now) {
    const { sampled, light, below, cube } = now;
    const factor = radianceFactor(sampled, light, state.uv, below);
    const power = Float64Array.from(light.power, (v, i) => v * kept(FIRST_NM + i, state.uv, below));
    const seen = factor.total.slice(atNm(400) / STEP_NM, atNm(700) / STEP_NM + 1);
    const isDark = seen.filter((v) => Number.isNaN(v)).length > seen.length / 2;
    // Under a lamp of ultraviolet, what is sent out is faint beside the lamp: it is drawn larger.
    const faint = peakSeen(factor.leaving, STEP_NM);
    const scale = isDark ? LARGER.findLast((by) => by * faint <= 1) ?? 1 : 1;
    const dyes = sampled.dyes.map((dye) => ({
        ...dye, ...dyeColor(dye, cube), scaled: dye.emission.map((v) => v / EMISSION_AT_1),
    }));
    const base = sampled.base ?? sampled.reflectance;
    const steepest = steepestOf(base);
    const before = now.otherSampled && {
        total: radianceFactor(now.otherSampled, light, state.uv, below).total,
        reflectance: now.otherSampled.reflectance,
    };
    const absent = new Set(sampled.fluoresces ? [] : ["base", "passed", "absorbed", "emitted"]);
    return {
        sampled, base, light, factor, power, isDark, dyes, steepest, absent,
        leaving: factor.leaving.map((v) => scale * v),
        leavingText: scale > 1 ? `light leaving × ${scale}` : "light leaving",
        before,
        slopeText: slopeText(Math.abs(steepest.perNm), now),
        doseName: cube.meta.model === "film" ? "optical density" : "concentration",
    };
}

// A dye has the hue of what it emits; neighbors among the cube's dyes differ in lightness.
function dyeColor(dye, cube) {
    const xyz = [0, 1, 2].map((k) => {
        let sum = 0;
        for (let o = 0; o < COARSE; o += 1) {
            sum += dye.emission[STEP_NM * o] * cube.matching[3 * o + k];
        }
        return sum;
    });
    const [, a, b] = cube.labOf(xyz.map((v) => (xyz[1] > 0 ? (0.4 * v) / xyz[1] : 0)));
    const hue = ((Math.atan2(b, a) * 180) / Math.PI + 360) % 360;
    const isOdd = cube.meta.dyes.indexOf(dye.name) % 2 === 1;
    return { color: [["--hue", `${hue.toFixed(1)}deg`]], kind: isOdd ? "dye odd" : "dye" };
}

// Two sides of a peak are often as steep as each other up to rounding: the first is named.
const AS_STEEP = 0.97;

// The greatest slope of a curve, and where it is.
function steepestOf(values) {
    const slopes = Float64Array.from(values.slice(1), (value, i) => value - values[i]);
    const most = slopes.reduce((best, slope) => Math.max(best, Math.abs(slope)), 0);
    let i = slopes.findIndex((slope) => Math.abs(slope) >= AS_STEEP * most);
    while (Math.abs(slopes[i + 1]) > Math.abs(slopes[i])) {
        i += 1;
    }
    return { nm: FIRST_NM + i + 0.5, perNm: Math.sign(slopes[i]) * most };
}

// A slope and its limit. Between nodes with and without dyes the limit is the greater one.
function slopeText(perNm, { sampled: { fluoresces }, cube, shown }) {
    const { slope_max_per_nm: alone, slope_under_dyes_per_nm: underDyes } = cube.meta.fit;
    const slope = perNm.toFixed(4);
    // The curve is sampled by 1 nm and rounded.
    const isWithin = (limit) => limit !== null && perNm <= limit * (1 + 1e-3);
    if (fluoresces && isWithin(underDyes)) {
        return `${slope} of at most ${underDyes} per nm under dyes`;
    }
    if (isWithin(alone)) {
        return `${slope} of at most ${alone} per nm`;
    }
    // A material that is none of the cube's need not keep to its limits.
    const isOther = alone === null || shown;
    return isOther ? `${slope} per nm` : `${slope} per nm: above ${alone}, as nothing else matched`;
}

// Colors of light by wavelength, as strong as the screen shows them, and fading where they are hardly seen.
function spectralColors(cube) {
    const found = [];
    for (let nm = SEEN_NM[0]; nm <= SEEN_NM[1]; nm += 2 * STEP_NM) {
        const i = atNm(nm) / STEP_NM;
        const xyz = [0, 1, 2].map((k) => cube.matching[3 * i + k]);
        const rgb = multiply(cube.lights[0].screen[SCREEN], xyz).map((v) => Math.max(v, 0));
        const most = Math.max(...rgb, 1e-9);
        const seen = Math.min(Math.sqrt((xyz[0] + xyz[1] + xyz[2]) / 0.2), 1);
        found.push({
            nm,
            color: cssColor({ rgb: rgb.map((v) => v / most) }),
            // A gradient goes on as it ends.
            opacity: SEEN_NM.includes(nm) ? 0 : seen.toFixed(3),
        });
    }
    return found;
}

// The dyes, their doses, and what they do at the cursor. It keeps its height.
function makeDyeTable() {
    const heads = ["Dye", "", "absorbs", "emits /nm"].map((text, k) =>
        element("th", { scope: "col", class: k > 0 ? "number-cell" : "" }, text));
    const rows = Array.from({ length: DYE_ROWS + 1 }, () => {
        const sample = svgElement("svg", { viewBox: "0 0 12 12", class: "dye-sample", "aria-hidden": "true" },
            svgElement("rect", { width: 12, height: 12, rx: 3 }));
        const name = element("span", { class: "dye-name" });
        const cells = [0, 1, 2].map(() => element("td", { class: "number-cell" }));
        const row = element("tr", {}, element("td", {}, element("div", {}, sample, name)), ...cells);
        return { row, sample, name, cells };
    });
    const table = element("table", { class: "dyes" },
        element("thead", {}, element("tr", {}, ...heads)),
        element("tbody", {}, ...rows.map(({ row }) => row)));
    return {
        root: table,
        draw({ dyes, doseName }, at) {
            heads[1].textContent = doseName;
            const listed = dyes.length > rows.length
                ? [...dyes.slice(0, DYE_ROWS), together(dyes.slice(DYE_ROWS))] : dyes;
            rows.forEach(({ sample, name, cells }, k) => {
                const dye = listed[k];
                name.textContent = dye?.name ?? (k === 0 ? "No dye: the material is a reflectance." : "");
                name.title = name.textContent;
                sample.setAttribute("class", `dye-sample ${dye?.kind ?? "none"}`);
                colored(sample, dye?.color);
                const dose = dye && (dye.dose < 5e-4 ? "< 0.001" : dye.dose.toFixed(3));
                const numbers = [dose, dye?.absorbed[at]?.toFixed(3), dye?.emission?.[at]?.toFixed(4)];
                cells.forEach((cell, column) => {
                    cell.textContent = numbers[column] ?? "";
                });
            });
        },
    };
}

// Dyes without rows of their own.
function together(dyes) {
    const sumOf = (valueOf) => dyes.reduce((sum, dye) => sum + valueOf(dye), 0);
    return {
        name: `${dyes.length} more`,
        dose: sumOf(({ dose }) => dose),
        absorbed: dyes[0].absorbed.map((_, i) => sumOf(({ absorbed }) => absorbed[i])),
    };
}
