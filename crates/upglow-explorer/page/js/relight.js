// The material under every light, and the slider of ultraviolet.

import { SCREEN, SCREEN_NAME, cssColor, de2000, multiply, onScreen } from "./color.js";
import { set, state } from "./state.js";
import { missingUltraviolet, relit } from "./cube.js";
import { element } from "./dom.js";

// A material as it would be if it kept the wavelength of all light: as dark where dyes absorb.
export function reflectedOnly(sampled) {
    return { ...sampled, response: null };
}

// Few steps, so that the exposure stays while a color is dragged. More than the last would show the violet
// that every reflectance has below 400 nm as if it glowed.
const EXPOSURES = [1, 2, 5, 10, 20, 50];

// By what the screen brightens a light's colors while only ultraviolet is on: by the same for all lights
// that eyes adapt to, so that they can be compared. A lamp to which nobody adapts has all its light still.
export function exposureUnder(light, { cube, sampled, below }) {
    if (state.uv !== "only" || !light.is_adapted) {
        return 1;
    }
    const brightest = cube.lights.filter((other) => other.is_adapted).map((other) =>
        Math.max(...multiply(other.screen[SCREEN], relit(sampled, other, "only", below))));
    return EXPOSURES.findLast((factor) => factor * Math.max(...brightest) <= 1) ?? 1;
}

export function scaled(xyz, factor) {
    return xyz.map((v) => factor * v);
}

// How much ultraviolet there is, in words.
export function ultravioletText(factor) {
    return state.uv === "only" ? `UV only, exposure × ${factor}` : `UV ${Math.round(100 * state.uv)} %`;
}

const MINUS = "\u2212";
const fixed = (v) => v.toFixed(4).replace("-", MINUS);

export function makeRelight(root, app) {
    const ultraviolet = makeUltraviolet(app);
    const parts = [["before", "before"], ["total", "total"], ["reflected", "reflected"]];
    const heads = parts.map(([name, text]) => element("span", { class: name }, text));
    heads[0].title = "the cube before";
    heads[1].title = "reflected and re-radiated light";
    heads[2].title = "the same material without the light that its dyes send out";
    const head = element("div", { class: "light-head note" },
        element("span", { class: "light-halves" }, ...heads), element("span", {}, "light"),
        element("span", { class: "light-missed", title: "from the asked color, after adaptation to the light" }, "ΔE00"));
    const list = element("ul", { class: "lights" });
    const numbers = makeNumbers(parts);
    const missing = element("p", { class: "note light-missing" });
    root.append(ultraviolet.root, head, list, numbers.root, missing);

    let rows = [];
    let made = "";
    return {
        draw(now) {
            const { cube, light, below } = now;
            ultraviolet.draw(now);
            // Files of users add lights.
            const key = [cube.id, ...cube.lights.map(({ name }) => name)].join();
            if (made !== key) {
                made = key;
                rows = cube.lights.map((each) => makeLightRow(each, cube, parts));
                list.replaceChildren(...rows.map((row) => row.root));
            }
            const shown = {
                before: now.otherSampled ?? null,
                total: now.sampled,
                reflected: reflectedOnly(now.sampled),
            };
            root.classList.toggle("compared", shown.before !== null);
            const asked = cube.labOf(now.target);
            const adapted = exposureUnder(cube.lights[0], now);
            rows.forEach((row) => {
                const colors = parts.map(([name]) => shown[name] && relit(shown[name], row.light, state.uv, below));
                const missed = row.light.is_adapted && state.uv !== "only"
                    ? de2000(asked, cube.labOf(cube.asUnderOwnLight(colors[1], row.light))).toFixed(2)
                    : "–";
                row.draw(colors, missed, row.light.is_adapted ? adapted : 1, row.light === light);
                if (row.light === light) {
                    numbers.draw(light.name, colors);
                    missing.textContent = missingUltraviolet(now.sampled, light);
                }
            });
        },
    };
}

// A light to choose, with what the material looks like under it.
function makeLightRow(light, cube, parts) {
    const halves = parts.map(([name]) => element("span", { class: `light-half ${name}` }));
    const missed = element("span", { class: "light-missed" });
    const seen = light.is_adapted ? [] : [element("span", { class: "note" }, `seen from ${cube.lights[0].name}`)];
    const button = element("button", { type: "button", class: "light-row" },
        element("span", { class: "light-halves" }, ...halves),
        element("span", { class: "light-name" }, element("span", {}, light.name), ...seen), missed);
    button.addEventListener("click", () => set({ light: light.name }));
    return {
        root: element("li", {}, button),
        light,
        draw(colors, text, factor, isChosen) {
            const lines = colors.map((xyz, k) => {
                if (!xyz) {
                    return "";
                }
                const shown = onScreen(scaled(xyz, factor), light);
                halves[k].style.setProperty("background", cssColor(shown));
                halves[k].classList.toggle("clipped", shown.clipped);
                return `${parts[k][1]}: XYZ ${xyz.map(fixed).join(", ")}${shown.clipped ? `, outside ${SCREEN_NAME}` : ""}`;
            });
            missed.textContent = text;
            button.title = lines.filter((line) => line !== "").join("\n");
            button.setAttribute("aria-pressed", String(isChosen));
        },
    };
}

// The numbers of the chosen light.
function makeNumbers(parts) {
    const title = element("th", { scope: "col" });
    const rows = parts.map(([name, text]) => {
        const cells = ["X", "Y", "Z"].map(() => element("td"));
        return { cells, root: element("tr", { class: name }, element("th", { scope: "row" }, text), ...cells) };
    });
    const heads = ["X", "Y", "Z"].map((text) => element("th", { scope: "col" }, text));
    return {
        root: element("table", { class: "light-numbers" },
            element("thead", {}, element("tr", {}, title, ...heads)),
            element("tbody", {}, ...rows.map((row) => row.root))),
        draw(name, colors) {
            title.textContent = `XYZ under ${name}`;
            rows.forEach(({ cells }, k) => cells.forEach((cell, channel) => {
                cell.textContent = colors[k] ? fixed(colors[k][channel]) : "";
            }));
        },
    };
}

// How much of the lights' ultraviolet there is.
function makeUltraviolet(app) {
    // By arrow keys 5 %.
    const slider = element("input", { type: "range", min: "0", max: "2", step: "0.05", id: "uv", list: "uv-ticks" });
    const ticks = element("datalist", { id: "uv-ticks" });
    const marks = element("div", { class: "uv-marks note", "aria-hidden": "true" });
    for (const value of [0, 1, 2]) {
        ticks.append(element("option", { value: String(value) }));
        marks.append(element("span", {}, `${100 * value} %`));
    }
    const value = element("output", { for: "uv" });
    const only = element("button", { type: "button", class: "uv-only" }, "UV only");
    const note = element("p", { class: "note uv-note" });
    // Where "UV only" returns to.
    let before = 1;
    slider.addEventListener("input", () => set({ uv: slider.valueAsNumber }));
    only.addEventListener("click", () => set({ uv: state.uv === "only" ? before : "only" }));
    return {
        root: element("div", { class: "uv" },
            element("label", { for: "uv" }, "Ultraviolet"), value, only,
            element("div", { class: "uv-slider" }, slider, ticks, marks), note),
        draw(now) {
            const isOnly = state.uv === "only";
            before = isOnly ? before : state.uv;
            slider.value = String(before);
            slider.setAttribute("aria-valuetext", isOnly ? "only ultraviolet" : `${Math.round(100 * before)} %`);
            const factor = exposureUnder(now.cube.lights[0], now);
            value.textContent = isOnly ? `exposure × ${factor}` : `${Math.round(100 * before)} %`;
            only.setAttribute("aria-pressed", String(isOnly));
            note.textContent = isOnly
                ? `Shows only what light below ${now.below} nm makes.`
                : `Scales what each light has below ${now.below} nm.`;
        },
    };
}
