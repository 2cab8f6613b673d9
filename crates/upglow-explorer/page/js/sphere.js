// Spheres of the material under a lamp that moves, shaded by WebGPU with the cube's own WGSL, or without it
// in the same way.

import { canvasContext, encoded, newImage, onScreen } from "./color.js";
import { set, state } from "./state.js";
import { relit } from "./cube.js";
import { element } from "./dom.js";
import { followPointer } from "./picker.js";
import { exposureUnder, reflectedOnly, scaled, ultravioletText } from "./relight.js";
import { makeGpu } from "./gpu.js";

// A second lamp, opposite to the first, has this share of its light, so that the dark side can be read.
const FILL = 0.12;
// Pixels beside a sphere, and above and below it, where there are words.
const MARGIN = [8, 24];
// More pixels would cost time and show nothing.
const MOST_RATIO = 2;
// Shades of the spheres without WebGPU, closer together where it is dark: less than a step of 8 bits apart.
const SHADE_STEPS = 512;

export function makeSphere(root, app) {
    const stage = element("div", { class: "sphere-stage" });
    const caption = element("p", { class: "sphere-light" });
    const areas = ["total", "reflected"].map(makeArea);
    const both = element("input", { type: "checkbox", id: "sphere-both" });
    both.checked = true;
    const note = element("p", { class: "note" });
    const plain = element("canvas", { "aria-hidden": "true" });
    const context = canvasContext(plain);
    let canvas = plain;
    stage.append(canvas, caption, ...areas.map((area) => area.root));
    root.append(stage,
        element("label", { class: "sphere-both" }, both, "Beside it: reflected light alone"), note);

    // The canvas of WebGPU takes the place of the other as soon as it has something to show.
    const show = (other) => {
        if (canvas !== other) {
            canvas.replaceWith(other);
            canvas = other;
        }
    };
    const say = (line) => {
        if (note.textContent !== line) {
            note.textContent = line;
        }
    };
    const gpu = makeGpu(show, () => draw(app.now, true), (off) =>
        say(`WebGPU, by the exported WGSL: ${off.toExponential(0)} from double precision.`));

    let isVisible = false;
    // For tests; what is off the screen is not computed.
    app.sphere = { gpuXyz: () => (isVisible ? gpu.xyz() : null) };
    // Of the stage. Asking for it in each draw would have the browser lay out the page at once.
    let size = { width: 0, height: 0 };
    let drawn = "";
    let light = null;
    const draw = (now, isAnew = false) => {
        const ratio = Math.min(devicePixelRatio, MOST_RATIO);
        const width = Math.round(size.width * ratio);
        const height = Math.round(size.height * ratio);
        const count = both.checked ? 2 : 1;
        const key = [now.key, state.uv, ...state.lamp, width, height, count].join();
        // A material that is none of the cube's has no key of its own.
        const isSame = drawn === key && light === now.light && !now.shown && !isAnew;
        if (!isVisible || !(width > 0 && height > 0) || isSame) {
            return;
        }
        drawn = key;
        light = now.light;
        const radius = Math.min(width / count / 2 - MARGIN[0] * ratio, height / 2 - MARGIN[1] * ratio);
        const lamp = [...state.lamp, Math.sqrt(Math.max(1 - state.lamp[0] ** 2 - state.lamp[1] ** 2, 0))];
        const factor = exposureUnder(light, now);
        const view = { width, height, radius, count, lamp, fill: FILL, factor, light, uv: state.uv };
        const colors = [now.sampled, reflectedOnly(now.sampled)]
            .map((sampled) => relit(sampled, light, state.uv, now.below));
        caption.textContent = `${light.name}, ${ultravioletText(factor)}`;
        stage.classList.toggle("two", count === 2);
        areas.forEach((area, k) => area.draw(radius / ratio, onScreen(scaled(colors[k], factor), light)));
        if (!now.shown && gpu.draw(now, view, colors)) {
            return;
        }
        gpu.forget();
        say(now.shown ? "Computed in JavaScript: this material is not of the cube." : gpu.isOut()
            ? "Computed in JavaScript, without WebGPU." : "Computed in JavaScript.");
        show(plain);
        paintSpheres(context, view, colors);
    };
    both.addEventListener("change", () => draw(app.now));
    new ResizeObserver(([{ contentRect }]) => {
        size = contentRect;
        draw(app.now);
    }).observe(stage);
    new IntersectionObserver(([entry]) => {
        isVisible = entry.isIntersecting;
        draw(app.now);
    }, { rootMargin: "64px" }).observe(stage);
    return { draw };
}

// A sphere's part of the stage, on which the lamp is dragged.
function makeArea(name) {
    const mark = element("div", { class: "plane-mark" });
    const root = element("div", { class: "sphere-area", role: "application" }, mark, element("span", {}, name));
    root.tabIndex = name === "total" ? 0 : -1;
    let radius = 1;
    followPointer(root, ([x, y]) => moveLamp(
        ((x - 0.5) * root.clientWidth) / radius,
        ((0.5 - y) * root.clientHeight) / radius,
    ));
    root.addEventListener("keydown", (event) => {
        const step = event.shiftKey ? 0.1 : 0.02;
        const move = { ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, step], ArrowDown: [0, -step] }[event.key];
        if (move) {
            event.preventDefault();
            moveLamp(state.lamp[0] + move[0], state.lamp[1] + move[1]);
        }
    });
    return {
        root,
        // Its radius in pixels of the page, and its color where the lamp is right above.
        draw(pixels, shown) {
            radius = pixels;
            mark.style.setProperty("left", `calc(50% + ${(radius * state.lamp[0]).toFixed(1)}px)`);
            mark.style.setProperty("top", `calc(50% - ${(radius * state.lamp[1]).toFixed(1)}px)`);
            root.classList.toggle("clipped", shown.clipped);
            const [x, y] = state.lamp.map((v) => v.toFixed(2));
            root.setAttribute("aria-label", `Sphere, ${name}; lamp ${x} to the right, ${y} up; arrow keys move it, with Shift faster`);
        },
    };
}

// The lamp stays before the spheres.
function moveLamp(x, y) {
    const length = Math.max(Math.hypot(x, y), 1);
    // Rounded towards the middle, so that its address is within the disk.
    set({ lamp: [x, y].map((v) => Math.trunc((1e5 * v) / length) / 1e5) });
}

// The light that arrives at a point of a sphere with this normal, over that of the lamp right above.
function arriving(cosine) {
    return cosine > 0 ? cosine : -FILL * cosine;
}

// The bytes of a color by the square root of the light that arrives.
function shadesOf(xyz, { factor, light }) {
    const shades = new Uint8ClampedArray(3 * (SHADE_STEPS + 1));
    for (let k = 0; k <= SHADE_STEPS; k += 1) {
        const { rgb } = onScreen(scaled(xyz, factor * (k / SHADE_STEPS) ** 2), light);
        rgb.forEach((v, channel) => {
            shades[3 * k + channel] = 255 * encoded(v);
        });
    }
    return shades;
}

// The same picture as that of the WGSL in gpu.js.
function paintSpheres(context, view, colors) {
    const { width, height, count, radius, lamp } = view;
    const { canvas } = context;
    if (canvas.width !== width || canvas.height !== height) {
        Object.assign(canvas, { width, height });
    }
    const image = newImage(context, width, height);
    for (let sphere = 0; sphere < count; sphere += 1) {
        const shades = shadesOf(colors[sphere], view);
        const middle = ((sphere + 0.5) * width) / count;
        const first = Math.max(Math.floor(middle - radius - 1), 0);
        const last = Math.min(Math.ceil(middle + radius + 1), width);
        for (let j = 0; j < height; j += 1) {
            for (let i = first; i < last; i += 1) {
                let x = (i + 0.5 - middle) / radius;
                let y = (height / 2 - j - 0.5) / radius;
                const distance = Math.sqrt(x * x + y * y);
                const covered = Math.min((1 - distance) * radius + 0.5, 1);
                if (covered <= 0) {
                    continue;
                }
                const z = distance < 1 ? Math.sqrt(1 - distance * distance) : 0;
                if (distance > 1) {
                    x /= distance;
                    y /= distance;
                }
                const shade = arriving(x * lamp[0] + y * lamp[1] + z * lamp[2]);
                const from = 3 * Math.min(Math.round(SHADE_STEPS * Math.sqrt(shade)), SHADE_STEPS);
                const at = 4 * (j * width + i);
                image.data[at] = shades[from];
                image.data[at + 1] = shades[from + 1];
                image.data[at + 2] = shades[from + 2];
                image.data[at + 3] = 255 * covered + 0.5;
            }
        }
    }
    context.putImageData(image, 0, 0);
}
