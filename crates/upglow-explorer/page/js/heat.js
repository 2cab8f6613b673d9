// Re-radiation as a map: from which wavelengths light comes (down), and to which it goes (across).

import { canvasContext, encoded, newImage, onScreen, xyzOfLab } from "./color.js";
import { COARSE, FIRST_NM, LAST_NM, STEP_NM } from "./cube.js";
import { element, svgElement } from "./dom.js";
import { WaveChart, px, steppedTop } from "./chart.js";

const SHADES = 256;
// Lightness of nothing and of the most, for light and dark surroundings; between them it grows evenly.
const LIGHTNESSES = { light: [97, 18], dark: [17, 97] };
// The violet of the accent, as its CIELAB hue in degrees, and chroma in the middle.
const HUE = 302;
const CHROMA = 72;
// The map's axis ends at least here, 1/nm.
const LEAST_TOP = 0.005;
// Light of so large a share of what a row sends is between the wavelengths that the text names.
const NAMED_SHARE = 0.9;

// Pixels left of the map and above it, for its numbers; style.css leaves them free.
const ROOM_OF_MAP = { left: 40, above: 24 };

const isDark = matchMedia("(prefers-color-scheme: dark)");
const wholeNm = (index) => FIRST_NM + STEP_NM * index;

export function makeHeat(root, app) {
    const canvas = element("canvas", { width: COARSE, height: COARSE });
    const overlay = svgElement("svg", { "aria-hidden": "true" });
    const hairs = svgElement("path", { class: "hair" });
    const empty = element("p", { class: "map-empty" },
        "This material does not fluoresce: light keeps its wavelength.");
    const map = element("div", {
        class: "map", tabindex: "0", role: "application",
        "aria-label": "Re-radiation: incident wavelength down, emitted across; arrow keys move, Shift faster",
    }, canvas, overlay, empty);
    const bar = element("canvas", { width: SHADES, height: 1 });
    const barTexts = [0, 1, 2].map(() => element("span"));
    const scale = element("div", { class: "map-scale" }, bar, element("div", {}, ...barTexts));
    const cell = element("p", { class: "map-cell" });
    const text = element("p", { class: "map-text" });
    const spoken = element("p", { class: "unseen", "aria-live": "polite" });
    const chart = new WaveChart({
        label: "The row of the map by emitted wavelength; arrow keys move, with Shift faster",
        title: { id: "row", text: "re-radiated (1/nm)" },
        heightOf: () => 240,
        onCursor: () => readRow(),
        onSize: () => shown && drawRow(),
    });
    const area = chart.plot.appendChild(svgElement("path", { class: "over" }));
    const line = chart.plot.appendChild(svgElement("path", { class: "curve row" }));
    root.append(element("div", { class: "heat-views" },
        element("div", { class: "heat-map" }, map, scale),
        element("div", { class: "heat-row" }, text, chart.root, cell, spoken)));

    let shown = null;
    // The side of the map in pixels.
    let side = 0;
    let top = LEAST_TOP;
    // Row and column that were pointed at; until then the row that sends the most.
    let at = null;
    let shades = shadesFor(app.now.cube);
    isDark.addEventListener("change", () => {
        shades = shadesFor(app.now.cube);
        drawBar();
        if (shown) {
            paint();
        }
    });
    new ResizeObserver(([{ contentRect }]) => {
        if (Math.floor(contentRect.width) !== side) {
            side = Math.floor(contentRect.width);
            drawAxes();
        }
    }).observe(map);

    const place = (index) => (index + 0.5) / COARSE;

    function drawAxes() {
        const { left, above } = ROOM_OF_MAP;
        const words = (x, y, kind, content) =>
            svgElement("text", { x: px(x), y: px(y), class: kind }, content);
        const [right, below] = [left + side, above + side];
        const parts = [
            words(0, 12, "", "incident (nm)"),
            words(left + side / 2, below + 34, "middle", "emitted (nm)"),
        ];
        for (let nm = FIRST_NM; nm <= LAST_NM; nm += 100) {
            const along = ((nm - FIRST_NM) / (LAST_NM - FIRST_NM + STEP_NM)) * side + side / COARSE / 2;
            const [x, y] = [px(left + along), px(above + along)];
            parts.push(
                words(left - 6, y + 4, "end", nm),
                words(x, below + 17, "middle", nm),
                svgElement("path", { d: `M${left - 4} ${y}h4M${x} ${below}v4`, class: "grid" }),
            );
        }
        // Below the diagonal, at the end where dyes seldom absorb.
        const middle = side * 0.68;
        const turned = `translate(${px(left + middle - 6)} ${px(above + middle + 14)}) rotate(45)`;
        parts.push(
            svgElement("rect", { x: left, y: above, width: side, height: side, class: "frame" }),
            svgElement("path", { d: `M${left} ${above}L${right} ${below}`, class: "diagonal" }),
            svgElement("text", { transform: turned, class: "middle" }, "reflected: same wavelength"),
        );
        overlay.replaceChildren(...parts, hairs);
        drawHairs();
    }

    function drawHairs() {
        const { left, above } = ROOM_OF_MAP;
        if (!shown) {
            return;
        }
        const [row, column] = at ?? [shown.strongest, null];
        const y = px(above + place(row) * side);
        const across = column === null ? "" : `M${px(left + place(column) * side)} ${above}v${side}`;
        hairs.setAttribute("d", `M${left} ${y}h${side}${across}`);
    }

    function paint() {
        const context = canvasContext(canvas);
        const image = newImage(context, COARSE, COARSE);
        const { moved } = shown.sampled;
        if (moved) {
            for (let i = 0; i < moved.length; i += 1) {
                const shade = Math.min(Math.round(Math.sqrt(moved[i] / top) * (SHADES - 1)), SHADES - 1);
                if (shade > 0) {
                    image.data.set(shades.subarray(4 * shade, 4 * shade + 4), 4 * i);
                }
            }
        }
        context.putImageData(image, 0, 0);
    }

    function drawBar() {
        const context = canvasContext(bar);
        const image = newImage(context, SHADES, 1);
        image.data.set(shades);
        context.putImageData(image, 0, 0);
        // The scale is of square roots: a quarter of the most is in the middle.
        [0, top / 4, top].forEach((value, k) => {
            barTexts[k].textContent = `${Number(value.toPrecision(3))}${k === 2 ? "/nm" : ""}`;
        });
    }

    const rowNow = () => (at ? at[0] : shown.strongest);
    const valuesOf = (row) => shown.sampled.moved?.slice(row * COARSE, (row + 1) * COARSE) ?? NOTHING;

    function drawRow() {
        const values = valuesOf(rowNow());
        chart.setTop(top);
        const nm = wholeNm(rowNow());
        const reflected = shown.sampled.reflectance[nm - FIRST_NM];
        const { sum, from, to } = spreadOf(values);
        const back = sum > 5e-4
            ? `comes back, most of it at ${from} to ${to} nm` : "comes back at other wavelengths";
        const came = `Of light at ${nm} nm: ${percent(sum)} ${back}`;
        text.textContent = `${came}; ${percent(reflected)} is reflected.`;
        if (chart.width > 0) {
            area.setAttribute("d", chart.area(values, 0, STEP_NM));
            line.setAttribute("d", chart.path(values, STEP_NM));
        }
        drawHairs();
        readRow();
    }

    function readRow() {
        if (!shown) {
            return;
        }
        const column = chart.nm === null ? null : Math.round((chart.nm - FIRST_NM) / STEP_NM);
        const value = column === null ? null : valuesOf(rowNow())[column];
        cell.textContent = column === null
            ? "" : `${wholeNm(rowNow())} nm → ${wholeNm(column)} nm: ${value.toFixed(5)}/nm`;
        chart.say(cell.textContent);
        chart.showDots(value === null ? [] : [{ value, kind: "total" }]);
    }

    function pointTo(row, column) {
        const held = (v) => Math.min(Math.max(v, 0), COARSE - 1);
        at = [held(row), held(column)];
        chart.point(wholeNm(at[1]));
        drawRow();
    }

    const fromPointer = (event) => {
        const { left, above } = ROOM_OF_MAP;
        const box = map.getBoundingClientRect();
        const index = (v) => Math.floor((v / side) * COARSE);
        pointTo(index(event.clientY - box.top - above), index(event.clientX - box.left - left));
    };
    map.addEventListener("pointermove", fromPointer);
    map.addEventListener("pointerdown", fromPointer);
    map.addEventListener("keydown", (event) => {
        const step = event.shiftKey ? 10 : 1;
        const [row, column] = at ?? [shown.strongest, shown.strongest];
        const move = {
            ArrowUp: [-step, 0], ArrowDown: [step, 0], ArrowLeft: [0, -step], ArrowRight: [0, step],
        }[event.key];
        if (move) {
            event.preventDefault();
            pointTo(row + move[0], column + move[1]);
            spoken.textContent = `${text.textContent} ${cell.textContent}`;
        }
    });

    drawBar();
    return {
        draw({ sampled }) {
            if (shown?.sampled === sampled) {
                return;
            }
            const { most, strongest } = mostOf(sampled.moved);
            shown = { sampled, strongest };
            empty.hidden = sampled.fluoresces;
            const next = steppedTop(most, top, LEAST_TOP);
            if (next !== top) {
                top = next;
                drawBar();
            }
            paint();
            drawRow();
        },
    };
}

const NOTHING = new Float64Array(COARSE);
export const percent = (share) => `${(100 * share).toFixed(1)}\u00a0%`;

// The greatest value, and the row that sends the most.
function mostOf(moved) {
    let [most, strongest, mostSent] = [0, 30, 0];
    for (let i = 0; moved && i < COARSE; i += 1) {
        let sent = 0;
        for (let o = 0; o < COARSE; o += 1) {
            const value = moved[i * COARSE + o];
            sent += value;
            most = Math.max(most, value);
        }
        if (sent > mostSent) {
            [strongest, mostSent] = [i, sent];
        }
    }
    return { most, strongest };
}

// How much a row sends in all, and between which wavelengths most of that is.
function spreadOf(values) {
    const all = values.reduce((sum, v) => sum + v, 0);
    let before = 0;
    let [from, to] = [0, COARSE - 1];
    for (let o = 0; o < COARSE; o += 1) {
        const next = before + values[o];
        const crosses = (share) => before < share * all && next >= share * all;
        from = crosses((1 - NAMED_SHARE) / 2) ? o : from;
        to = crosses((1 + NAMED_SHARE) / 2) ? o : to;
        before = next;
    }
    return { sum: STEP_NM * all, from: wholeNm(from), to: wholeNm(to) };
}

// Colors of the map from nothing to the most, as bytes of the screen's space.
function shadesFor(cube) {
    const [first, last] = isDark.matches ? LIGHTNESSES.dark : LIGHTNESSES.light;
    const bytes = new Uint8ClampedArray(4 * SHADES);
    const hue = (HUE * Math.PI) / 180;
    for (let k = 0; k < SHADES; k += 1) {
        const share = k / (SHADES - 1);
        const chroma = CHROMA * Math.sin(Math.PI * share);
        const lab = [first + share * (last - first), chroma * Math.cos(hue), chroma * Math.sin(hue)];
        const { rgb } = onScreen(xyzOfLab(lab, cube.white), cube.lights[0]);
        bytes.set([...rgb.map((v) => 255 * encoded(v)), 255], 4 * k);
    }
    return bytes;
}
