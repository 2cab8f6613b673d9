// The color: its fields, a slice by hue and chroma, and a slice of the cube's RGB.

import { SCREEN_NAME, canvasContext, cssColor, de2000, decoded, encoded, labOf, multiply, newImage, onScreen, xyzOfLab } from "./color.js";
import { set, state } from "./state.js";
import { contour, element, svgElement } from "./dom.js";

// Fields of the picker: what their numbers are, and how XYZ becomes them.
export function fieldSpaces({ meta }) {
    const linear = meta.spaces.map(({ name, from_xyz, to_xyz }) => ({
        name,
        from: (xyz) => multiply(from_xyz, xyz),
        to: (value) => multiply(to_xyz, value),
        channels: ["R", "G", "B"],
    }));
    const srgb = linear.find(({ name }) => name === "sRGB");
    const signed = (curve) => (v) => Math.sign(v) * curve(Math.abs(v));
    const coded = {
        name: "sRGB coded",
        from: (xyz) => srgb.from(xyz).map(signed(encoded)),
        to: (value) => srgb.to(value.map(signed(decoded))),
        channels: ["R", "G", "B"],
    };
    const xyz = { name: "XYZ", from: (v) => v, to: (v) => v, channels: ["X", "Y", "Z"] };
    return [...linear, coded, xyz];
}

// Chroma at the edge of the slice.
const MOST_CHROMA = 150;
// Samples of a slice along each axis; the first and the last lie on its edges.
const SAMPLES = 97;

// Steep, so that the line of the cube's border lies on it between two samples.
const OUTSIDE_SCALE = 100;

// The borders, from the least to the greatest.
const BORDERS = [
    ["smooth", "smooth reflectance"],
    ["passive", "any reflectance"],
    ["cube", "this cube within 1 ΔE00"],
    ["any", "any fluorescent material"],
    ["screen", `your screen (${SCREEN_NAME})`],
];

export function makePicker(root, app) {
    const fields = makeFields(root, app);
    const tabs = element("div", { class: "tabs", role: "group", "aria-label": "Slice" });
    const tab = (label, changes, isOn) => {
        const button = element("button", { type: "button" }, label);
        button.addEventListener("click", () => set(changes));
        tabs.append(button);
        return () => button.setAttribute("aria-pressed", String(isOn()));
    };
    const presses = [
        tab("Hue and chroma", { slice: "hue" }, () => state.slice === "hue"),
        ...["R", "G", "B"].map((name, k) => tab(
            `${name} fixed`,
            { slice: "rgb", fixed: k },
            () => state.slice === "rgb" && state.fixed === k,
        )),
    ];
    const plane = element("div", { class: "plane", tabindex: "0", role: "application" });
    const canvas = element("canvas", { width: SAMPLES, height: SAMPLES });
    const lines = svgElement("svg", { viewBox: "0 0 100 100", class: "plane-lines", "aria-hidden": "true" });
    const mark = element("div", { class: "plane-mark" });
    plane.append(canvas, lines, mark);
    const depth = element("input", { type: "range", min: "0", step: "any", id: "depth" });
    const depthLabel = element("label", { for: "depth" });
    const depthValue = element("output", { for: "depth" });
    const legend = element("ul", { class: "legend" });
    for (const [kind, text] of BORDERS) {
        const key = svgElement("svg", { viewBox: "0 0 28 8", "aria-hidden": "true" });
        key.append(...casedLine("M1 4H27", kind));
        legend.append(element("li", {}, key, text));
    }
    root.append(fields.root, tabs, plane,
        element("div", { class: "slider" }, depthLabel, depth, depthValue), legend);

    const moveTo = (x, y) => set(fields.valueOf(slice(app.now).xyzAt(x, y)));
    followPointer(plane, ([x, y]) => moveTo(x, y));
    plane.addEventListener("keydown", (event) => {
        const step = event.shiftKey ? 0.05 : 0.01;
        const move = { ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, -step], ArrowDown: [0, step] }[event.key];
        if (move) {
            event.preventDefault();
            const [x, y] = slice(app.now).placeOf(app.now.target);
            moveTo(Math.min(Math.max(x + move[0], 0), 1), Math.min(Math.max(y + move[1], 0), 1));
        }
    });
    depth.addEventListener("input", () => {
        const { target } = app.now;
        const [x, y] = slice(app.now).placeOf(target);
        set(fields.valueOf(slice(app.now, Number(depth.value)).xyzAt(x, y)));
    });

    let drawn = "";
    return {
        draw(now) {
            fields.draw(now);
            presses.forEach((press) => press());
            const shown = slice(now);
            // The same slice need not be painted again.
            const key = [now.cube.id, Boolean(now.cube.borders), state.slice, state.fixed, shown.depth.toFixed(3)].join();
            if (key !== drawn) {
                drawn = key;
                lines.replaceChildren(...paint(canvas, shown, now.cube));
            }
            const [x, y] = shown.placeOf(now.target);
            mark.style.setProperty("left", `${100 * Math.min(Math.max(x, 0), 1)}%`);
            mark.style.setProperty("top", `${100 * Math.min(Math.max(y, 0), 1)}%`);
            mark.style.setProperty("background", cssColor(onScreen(now.target, now.cube.lights[0])));
            mark.classList.toggle("outside", x < 0 || y < 0 || x > 1 || y > 1);
            depth.max = String(shown.most);
            depth.value = String(shown.depth);
            depthLabel.textContent = shown.depthName;
            depthValue.textContent = shown.depth.toFixed(shown.most > 1 ? 1 : 3);
            plane.setAttribute("aria-label", `${shown.name}; arrow keys move, with Shift faster`);
        },
    };
}

// The part of a plane of colors that is shown, places in 0 to 1 from the upper left.
function slice(now, depth) {
    const { cube, target } = now;
    if (state.slice === "hue") {
        const l = Math.min(depth ?? cube.labOf(target)[0], 100);
        return {
            name: `Hue and chroma at lightness ${l.toFixed(0)}`,
            depth: l,
            most: 100,
            depthName: "Lightness",
            xyzAt: (x, y) => xyzOfLab([l, (2 * x - 1) * MOST_CHROMA, (1 - 2 * y) * MOST_CHROMA], cube.white),
            placeOf(xyz) {
                const [, a, b] = cube.labOf(xyz);
                return [(a / MOST_CHROMA + 1) / 2, (1 - b / MOST_CHROMA) / 2];
            },
        };
    }
    const k = state.fixed;
    const [across, up] = [0, 1, 2].filter((channel) => channel !== k);
    const at = Math.min(Math.max(depth ?? cube.rgbOf(target)[k], 0), 1);
    const names = ["red", "green", "blue"];
    return {
        name: `${names[across]} across and ${names[up]} up, ${names[k]} ${at.toFixed(2)}`,
        depth: at,
        most: 1,
        depthName: names[k],
        xyzAt(x, y) {
            const rgb = [at, at, at];
            rgb[across] = x;
            rgb[up] = 1 - y;
            return cube.xyzOf(rgb);
        },
        placeOf(xyz) {
            const rgb = cube.rgbOf(xyz);
            return [rgb[across], 1 - rgb[up]];
        },
    };
}

// Paints the colors of a slice; the lines where a color is just within reach of each kind.
function paint(canvas, shown, cube) {
    const context = canvasContext(canvas);
    const image = newImage(context, SAMPLES, SAMPLES);
    const fields = BORDERS.map(() => new Float64Array(SAMPLES * SAMPLES));
    const light = cube.lights[0];
    for (let j = 0; j < SAMPLES; j += 1) {
        for (let i = 0; i < SAMPLES; i += 1) {
            const at = j * SAMPLES + i;
            const xyz = shown.xyzAt(i / (SAMPLES - 1), j / (SAMPLES - 1));
            const { rgb, beyond } = onScreen(xyz, light);
            for (let k = 0; k < 3; k += 1) {
                image.data[4 * at + k] = 255 * encoded(rgb[k]) + 0.5;
            }
            image.data[4 * at + 3] = 255;
            const lab = labOf(xyz, cube.white);
            const chroma = Math.hypot(lab[1], lab[2]);
            const hue = (Math.atan2(lab[2], lab[1]) * 180) / Math.PI;
            for (const [field, kind] of [[0, 0], [1, 1], [3, 2]]) {
                fields[field][at] = cube.borders ? chroma - cube.borderChroma(kind, lab[0], hue) : -1;
            }
            fields[2][at] = missedBy(cube, xyz, lab);
            fields[4][at] = beyond;
        }
    }
    context.putImageData(image, 0, 0);
    return fields.flatMap((field, k) => casedLine(contour(field, SAMPLES, 100), BORDERS[k][0]));
}

// How much more than 1 ΔE00 the cube's answer misses a color by; outside its RGB, how far outside.
function missedBy(cube, xyz, lab) {
    const rgb = cube.rgbOf(xyz);
    const outside = Math.max(...rgb.map((v) => Math.max(-v, v - 1)));
    return Math.max(de2000(lab, cube.labOf(cube.colorOf(rgb))) - 1, OUTSIDE_SCALE * outside);
}

function casedLine(d, kind) {
    return ["casing", kind].map((name) => svgElement("path", { d, class: `border ${name}` }));
}

// Calls back with places in 0 to 1 while a pointer is down on an element.
export function followPointer(target, callback) {
    const place = (event) => {
        const { left, top, width, height } = target.getBoundingClientRect();
        const within = (v) => Math.min(Math.max(v, 0), 1);
        callback([within((event.clientX - left) / width), within((event.clientY - top) / height)], event);
    };
    target.addEventListener("pointerdown", (event) => {
        if (event.button === 0) {
            target.setPointerCapture(event.pointerId);
            place(event);
        }
    });
    target.addEventListener("pointermove", (event) => {
        if (target.hasPointerCapture(event.pointerId)) {
            place(event);
        }
    });
}

const digits = (v) => String(Number(v.toFixed(4)));

// The space, its three numbers, and the swatches of what was asked and what the cube answers.
function makeFields(root, app) {
    const space = element("select", { id: "space", "aria-label": "Space of the numbers" });
    // Another cube may have a space that this one has not.
    let listed = null;
    const list = () => {
        if (listed !== app.spaces) {
            listed = app.spaces;
            space.replaceChildren(...listed.map(({ name }) => element("option", { value: name }, name)));
        }
    };
    const inputs = [0, 1, 2].map((k) => {
        const input = element("input", { type: "number", step: "0.01", min: "-10", max: "10", id: `value-${k}` });
        input.addEventListener("input", () => {
            const value = inputs.map((other) => other.valueAsNumber);
            if (value.every((v) => Number.isFinite(v) && Math.abs(v) <= 10)) {
                set({ value });
            }
        });
        return input;
    });
    const labels = [0, 1, 2].map((k) => element("label", { for: `value-${k}` }));
    space.addEventListener("change", () => {
        const found = app.spaces.find(({ name }) => name === space.value);
        set({ space: found.name, value: found.from(app.now.target).map((v) => Number(v.toFixed(5))) });
    });
    const swatch = (name) => {
        const color = element("div", { class: "swatch" });
        const note = element("span", { class: "note" });
        const box = element("div", { class: "asked" }, color, element("span", {}, name), note);
        return { box, color, note };
    };
    const asked = swatch("asked");
    const answer = swatch("answer");
    const box = element("div", { class: "fields" },
        element("div", { class: "numbers" }, space,
            ...inputs.map((input, k) => element("span", { class: "number" }, labels[k], input))),
        element("div", { class: "pair" }, asked.box, answer.box));
    const show = ({ color, note }, xyz, light, text) => {
        const shown = onScreen(xyz, light);
        color.style.setProperty("background", cssColor(shown));
        color.classList.toggle("clipped", shown.clipped);
        color.title = shown.clipped ? `outside ${SCREEN_NAME}: shown as gray as necessary` : "";
        note.textContent = text;
    };
    return {
        root: box,
        // The state of a color in the space of the fields.
        valueOf: (xyz) => ({ value: app.spaceNow().from(xyz).map((v) => Number(v.toFixed(5))) }),
        draw(now) {
            list();
            const { name, channels } = app.spaceNow();
            space.value = name;
            inputs.forEach((input, k) => {
                labels[k].textContent = channels[k];
                input.setAttribute("aria-label", `${channels[k]} in ${name}`);
                if (document.activeElement !== input) {
                    input.value = digits(state.value[k]);
                }
            });
            const light = now.cube.lights[0];
            show(asked, now.target, light, now.outside);
            const missed = de2000(now.cube.labOf(now.target), now.cube.labOf(now.xyz));
            show(answer, now.xyz, light, `ΔE00 ${missed.toFixed(2)}`);
        },
    };
}
