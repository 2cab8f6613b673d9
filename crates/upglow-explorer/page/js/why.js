// Why a color has the material it has: what physics allows, and the nearest colors of each kind.

import { cssColor, de2000, labOf, onScreen } from "./color.js";
import { NEEDS_PROGRAM, postJson, sampledOf, served } from "./server.js";
import { element } from "./dom.js";

// The program is asked when the color has rested for so long.
const REST_MS = 120;
// Differences below are printed as 0.00.
const NO_DIFFERENCE = 0.005;
// Nodes from which the search between nodes starts.
const STARTS = 2;
// The last step of that search, in RGB.
const FINEST = 1 / 4096;

// What is nearest: its name, and what the button does.
const NEAREST = [
    ["cube", "color of this cube", "Go"],
    ["passive", "smooth reflectance", "Show"],
    ["reflectance", "any reflectance", "Go"],
    ["material", "any material", "Go"],
    ["fitted", "direct fit", "Show"],
];

export function makeWhy(root, app) {
    const sentence = element("p", { class: "why-sentence", "aria-live": "polite" });
    const body = element("tbody");
    const table = element("table", { class: "why-table" },
        element("thead", {}, element("tr", {},
            element("th", { scope: "col", colspan: "2" }, "Nearest"),
            element("th", { scope: "col" }, "ΔE00"),
            element("td"))),
        body);
    const rows = {};
    for (const [kind, name, action] of NEAREST) {
        if (served || kind === "cube") {
            rows[kind] = makeNearest(name, action);
            body.append(rows[kind].root);
        }
    }
    const note = element("p", { class: "note why-note" });
    root.append(sentence, table, note);

    const searched = searchOf();
    // The color that answer belongs to, and the one that was asked for.
    let answer = null;
    let answered = "";
    let asked = "";
    let timer = 0;
    let running = null;
    // The color for which the direct fit was shown by itself.
    let forced = "";

    async function ask(now, key) {
        running?.abort();
        running = new AbortController();
        const { signal } = running;
        try {
            answer = await postJson("color", { cube: now.cube.id, xyz: now.target }, signal);
            answered = key;
        } catch (error) {
            if (signal.aborted) {
                return;
            }
            answer = { error: error.message };
            answered = key;
        }
        if (app.now) {
            draw(app.now);
        }
    }

    function drawAnswer(now, key) {
        const isOld = answered !== key;
        root.classList.toggle("is-old", isOld);
        if (isOld) {
            return;
        }
        if (answer.error) {
            sentence.textContent = `The program says: ${answer.error}.`;
            return;
        }
        sentence.textContent = standingSentence(answer);
        const { reflectance, material, fitted, passive } = answer;
        // Those that are nearest in XYZ; fits may come nearer in ΔE00, and are materials of these kinds too.
        drawColor(rows.reflectance, now, reflectance, [[passive, "the smooth one"]]);
        drawColor(rows.material, now, material, [[fitted, "the direct fit"], [passive, "the smooth one"]]);
        const limit = now.cube.meta.fit.slope_max_per_nm;
        const smooth = typeof limit === "number" ? `slope up to ${limit}/nm` : "no slope limit";
        drawMaterial(rows.passive, now, passive, smooth, answer.passive_refusal, "smooth reflectance");
        drawMaterial(rows.fitted, now, fitted, fitted?.kind_text ?? "", answer.fitted_refusal, "direct fit");
        // A color outside the cube has no look-up of its own.
        if (now.outside && fitted && !now.shown && forced !== key) {
            forced = key;
            show(fitted, "direct fit");
        }
        note.textContent = now.outside && now.shown
            ? "The cube does not hold this color: charts show the direct fit, not a look-up."
            : "";
    }

    function drawColor(row, now, nearest, fits) {
        let best = [nearest, "nearest in XYZ"];
        for (const [found, text] of fits) {
            best = found && found.de2000 < best[0].de2000 ? [found, text] : best;
        }
        row.draw(now, best[0], best[1], { act: () => app.goTo(best[0].xyz), isOn: false });
    }

    function show(found, title) {
        app.show({ sampled: sampledOf(found), title, found });
    }

    function drawMaterial(row, now, found, text, refusal, title) {
        if (!found) {
            row.refuse(now, refusal ?? "none");
            return;
        }
        const isOn = now.shown?.found === found;
        row.draw(now, found, text, { act: () => (isOn ? app.show(null) : show(found, title)), isOn });
    }

    function drawCube(now) {
        const { rgb, xyz, difference } = searched(now.cube, now.target);
        const at = `at RGB ${rgb.map((v) => v.toFixed(3)).join(" ")}`;
        rows.cube.draw(now, { xyz, de2000: difference }, at, {
            act: () => app.goTo(now.cube.xyzOf(rgb)),
            isOn: false,
        });
    }

    function draw(now) {
        const key = [now.cube.id, ...now.target].join();
        drawCube(now);
        if (!served) {
            sentence.textContent = standingByBorders(now);
            note.textContent = "Approximate, by the drawn borders. Nearest reflectances and the direct fit "
                + `are not here. ${NEEDS_PROGRAM}`;
            return;
        }
        if (asked !== key) {
            asked = key;
            clearTimeout(timer);
            timer = setTimeout(ask, REST_MS, now, key);
        }
        drawAnswer(now, key);
    }

    return { draw };
}

// One kind of nearest color: the color asked for beside it, what it is, its distance, and a button.
function makeNearest(name, action) {
    const asked = element("span");
    const found = element("span");
    const text = element("span", { class: "note" });
    const distance = element("td", { class: "why-number" });
    const button = element("button", { type: "button" }, action);
    let act = () => {};
    button.addEventListener("click", () => act());
    const root = element("tr", {},
        element("td", { class: "why-swatch", "aria-hidden": "true" }, element("div", {}, asked, found)),
        element("th", { scope: "row" }, name, text),
        distance,
        element("td", {}, button));
    const paint = (half, xyz, now) =>
        half.style.setProperty("background", cssColor(onScreen(xyz, now.cube.lights[0])));
    return {
        root,
        draw(now, { xyz, de2000: difference }, words, { act: next, isOn }) {
            paint(asked, now.target, now);
            paint(found, xyz, now);
            const isSame = difference < NO_DIFFERENCE;
            text.textContent = isSame && action === "Go" ? "this color itself" : words;
            distance.textContent = Math.max(difference, 0).toFixed(2);
            act = next;
            button.disabled = isSame && action === "Go";
            const verb = action === "Go" ? "Go to the nearest" : "Show the";
            button.setAttribute("aria-label", `${verb} ${name}`);
            if (action === "Show") {
                button.setAttribute("aria-pressed", String(isOn));
            }
        },
        refuse(now, line) {
            paint(asked, now.target, now);
            found.style.setProperty("background", "none");
            text.textContent = line;
            text.title = line;
            distance.textContent = "–";
            button.disabled = true;
            button.setAttribute("aria-label", `${name}: none`);
        },
    };
}

// What physics allows, in one sentence. A color at a border is found outside by the decimals of its fields.
function standingSentence({ standing, reflectance, material }) {
    const isReached = (nearest) => nearest.de2000 < NO_DIFFERENCE;
    const away = ({ de2000: difference, distance }) =>
        `the nearest in XYZ is ${distance.toFixed(4)} away, ΔE00 ${difference.toFixed(2)}.`;
    if (standing === "reflectance") {
        return "A reflectance shows this color.";
    }
    if (isReached(reflectance)) {
        return "A reflectance just shows this color: it is at the border.";
    }
    if (standing === "needs_fluorescence") {
        return `No reflectance shows this color: ${away(reflectance)} A fluorescent material shows it.`;
    }
    return isReached(material)
        ? "A fluorescent material just shows this color: it is at the border."
        : `No material shows this color: ${away(material)}`;
}

// The same from the borders at the color's lightness and hue.
function standingByBorders({ cube, target }) {
    const [l, a, b] = cube.labOf(target);
    const chroma = Math.hypot(a, b);
    const hue = (Math.atan2(b, a) * 180) / Math.PI;
    if (l > 100) {
        return "No reflectance shows this color: it is brighter than white.";
    }
    const away = (kind) => {
        const most = l < 0 ? 0 : Math.min(chroma, cube.borderChroma(kind, l, hue));
        const radians = (hue * Math.PI) / 180;
        return de2000([l, a, b], [Math.max(l, 0), most * Math.cos(radians), most * Math.sin(radians)]);
    };
    const nearest = (kind) =>
        `the nearest of its lightness and hue is about ΔE00 ${away(kind).toFixed(1)} away.`;
    if (away(1) < NO_DIFFERENCE) {
        return "A reflectance shows this color.";
    }
    return away(2) < NO_DIFFERENCE
        ? `No reflectance shows this color: ${nearest(1)} A fluorescent material shows it.`
        : `No material shows this color: ${nearest(2)}`;
}

// The nearest color of a cube, with the last answer kept.
function searchOf() {
    const labs = new WeakMap();
    let last = {};
    return (cube, target) => {
        const key = [cube.id, ...target].join();
        if (last.key !== key || last.cube !== cube) {
            if (!labs.has(cube)) {
                labs.set(cube, nodeLabs(cube));
            }
            last = { key, cube, found: nearestOfCube(cube, labs.get(cube), target) };
        }
        return last.found;
    };
}

function nodeLabs({ nodeXyz, white }) {
    const labs = new Float32Array(nodeXyz.length);
    for (let i = 0; i < nodeXyz.length; i += 3) {
        labs.set(labOf(nodeXyz.subarray(i, i + 3), white), i);
    }
    return labs;
}

// The nodes that are nearest by lightness, chroma and hue, weighted at the color as ΔE00 weights them.
function nearestNodes(labs, [l, a, b]) {
    const chroma = Math.hypot(a, b);
    const [cos, sin] = chroma > 0 ? [a / chroma, b / chroma] : [1, 0];
    const byChroma = 1 / (1 + 0.045 * chroma);
    const byHue = 1 / (1 + 0.015 * chroma);
    const l50 = (l - 50) ** 2;
    const byLightness = 1 / (1 + (0.015 * l50) / Math.sqrt(20 + l50));
    const found = Array.from({ length: STARTS }, () => [Infinity, 0]);
    for (let i = 0; i < labs.length; i += 3) {
        const da = labs[i + 1] - a;
        const db = labs[i + 2] - b;
        const dl = (labs[i] - l) * byLightness;
        const dc = (da * cos + db * sin) * byChroma;
        const dh = (db * cos - da * sin) * byHue;
        const squared = dl * dl + dc * dc + dh * dh;
        if (squared < found[STARTS - 1][0]) {
            found[STARTS - 1] = [squared, i / 3];
            found.sort((one, two) => one[0] - two[0]);
        }
    }
    return found.map(([, node]) => node);
}

// The RGB whose color in the cube is nearest to a color: from the nearest nodes, by steps that are halved
// when none leads nearer. Colors between nodes are linear in RGB, so that this ends near the best.
function nearestOfCube(cube, labs, target) {
    const lab = labOf(target, cube.white);
    const n = cube.meta.resolution;
    const differenceAt = (rgb) => de2000(lab, labOf(cube.colorOf(rgb), cube.white));
    const within = (v) => Math.min(Math.max(v, 0), 1);
    const looked = cube.rgbOf(target).map(within);
    const starts = nearestNodes(labs, lab)
        .map((node) => [1, n, n * n].map((stride) => (Math.floor(node / stride) % n) / (n - 1)));
    let best = { difference: Infinity };
    for (const start of [looked, ...starts]) {
        let rgb = start;
        let difference = differenceAt(rgb);
        for (let step = 0.5 / (n - 1); step > FINEST && difference > NO_DIFFERENCE;) {
            const from = difference;
            for (const move of MOVES) {
                const next = rgb.map((v, k) => within(v + step * move[k]));
                const there = differenceAt(next);
                if (there < difference) {
                    [rgb, difference] = [next, there];
                }
            }
            step = difference < from ? step : step / 2;
        }
        if (difference < best.difference) {
            best = { rgb, difference };
        }
        if (difference <= NO_DIFFERENCE) {
            break;
        }
    }
    return { ...best, xyz: cube.colorOf(best.rgb) };
}

// Steps along, and diagonally between, the axes of RGB.
const MOVES = [-1, 0, 1]
    .flatMap((r) => [-1, 0, 1].flatMap((g) => [-1, 0, 1].map((b) => [r, g, b])))
    .filter((move) => move.some((v) => v !== 0));
