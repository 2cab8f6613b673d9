// Charts over wavelength: axes, lines and their labels, a cursor by pointer and keys, and files of them.

import { FINE, FIRST_NM, LAST_NM } from "./cube.js";
import { element, svgElement } from "./dom.js";

// Room around the plot in pixels: for the numbers of the axes and for a line of text above.
const ROOM = { left: 40, right: 8, top: 24, bottom: 44 };
// The strip of spectral colors under the plot.
const STRIP = 4;
const TOPS = [1, 1.2, 1.5, 2, 3, 5, 10];

// The end of an axis that holds a value: it grows at once, and shrinks only when that is clearly enough, so
// that it does not flicker while colors are dragged.
export function steppedTop(peak, before, least) {
    const fitting = (value) => {
        if (!(value > least)) {
            return least;
        }
        const decade = 10 ** Math.floor(Math.log10(value));
        return decade * TOPS.find((step) => step * decade >= value * (1 - 1e-9));
    };
    const top = fitting(peak);
    return top < before && fitting(1.15 * peak) >= before ? before : top;
}

// Values of the ticks of an axis from 0 to its top, and how they are written.
function ticksTo(top) {
    const rough = top / 6;
    const decade = 10 ** Math.floor(Math.log10(rough));
    const step = decade * [1, 2, 5, 10].find((v) => v * decade >= rough * (1 - 1e-9));
    const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
    const count = Math.floor(top / step + 1e-9);
    return Array.from({ length: count + 1 }, (_, k) => ({ value: k * step, text: (k * step).toFixed(digits) }));
}

// A number with one decimal: places in pixels.
export const px = (v) => Math.round(10 * v) / 10;

let measuring = null;
const widths = new Map();

// The width of a label in pixels; measuring it in the document would lay out the page.
function widthOf(text) {
    if (!widths.has(text)) {
        measuring ??= element("canvas").getContext("2d");
        measuring.font = `12px ${getComputedStyle(document.body).fontFamily}`;
        widths.set(text, measuring.measureText(text).width);
    }
    return widths.get(text);
}

export class WaveChart {
    // heightOf: pixels, from the width. onCursor: after the cursor moved, to a wavelength or null. onSize: after
    // the chart got another size. colors: of the strip under the axis, [{ nm, color, opacity }].
    constructor({ label, title, heightOf, onCursor, onSize, colors = [] }) {
        Object.assign(this, { label, heightOf, onCursor, onSize, width: 0, height: 0, top: 0, nm: null });
        this.axes = svgElement("g");
        this.plot = svgElement("g", { "clip-path": `url(#${title.id}-clip)` });
        this.marks = svgElement("g");
        this.labels = svgElement("g");
        this.cursor = svgElement("g", { class: "cursor" });
        this.window = svgElement("rect");
        this.strip = svgElement("rect", { height: STRIP, fill: `url(#${title.id}-strip)` });
        const gradient = svgElement("linearGradient", { id: `${title.id}-strip` });
        for (const { nm, color, opacity } of colors) {
            const stop = svgElement("stop", { offset: (nm - FIRST_NM) / (FINE - 1), "stop-opacity": opacity });
            stop.style.setProperty("stop-color", color);
            gradient.append(stop);
        }
        this.svg = svgElement("svg", { "aria-hidden": "true" },
            svgElement("defs", {}, gradient, svgElement("clipPath", { id: `${title.id}-clip` }, this.window)),
            this.axes, this.strip, this.plot, this.marks, this.labels, this.cursor);
        this.title = title.text;
        this.root = element("div", {
            class: "chart", tabindex: "0", role: "slider", "aria-label": label,
            "aria-valuemin": FIRST_NM, "aria-valuemax": LAST_NM, "aria-valuenow": FIRST_NM,
            "aria-valuetext": "no wavelength chosen",
        }, this.svg);
        this.#listen();
        new ResizeObserver(([{ contentRect }]) => this.#resize(Math.floor(contentRect.width))).observe(this.root);
    }

    #resize(width) {
        if (width === this.width || width < 100) {
            return;
        }
        this.width = width;
        this.height = this.heightOf(width);
        const { svg, window: inner } = this;
        for (const [name, value] of Object.entries({
            width, height: this.height, viewBox: `0 0 ${width} ${this.height}`,
        })) {
            svg.setAttribute(name, value);
        }
        this.right = width - ROOM.right;
        this.bottom = this.height - ROOM.bottom;
        this.perNm = (this.right - ROOM.left) / (FINE - 1);
        for (const [name, value] of Object.entries({
            x: ROOM.left, y: ROOM.top, width: this.right - ROOM.left, height: this.bottom - ROOM.top,
        })) {
            inner.setAttribute(name, value);
        }
        this.strip.setAttribute("x", ROOM.left);
        this.strip.setAttribute("y", this.bottom + 1);
        this.strip.setAttribute("width", this.right - ROOM.left);
        this.#drawAxes();
        this.onSize();
        this.#drawCursor();
    }

    // Where the axis ends, and whether that changed.
    setTop(top) {
        if (top === this.top) {
            return;
        }
        this.top = top;
        if (this.width > 0) {
            this.#drawAxes();
        }
    }

    x(nm) {
        return ROOM.left + (nm - FIRST_NM) * this.perNm;
    }

    y(value) {
        return this.bottom - (value / this.top) * (this.bottom - ROOM.top);
    }

    #drawAxes() {
        if (this.top === 0) {
            return;
        }
        const parts = [];
        const text = (x, y, content, kind) => {
            parts.push(svgElement("text", { x: px(x), y: px(y), class: `tick ${kind}` }, content));
        };
        for (const { value, text: number } of ticksTo(this.top)) {
            const y = Math.round(this.y(value)) + 0.5;
            parts.push(svgElement("path", { d: `M${ROOM.left} ${y}H${this.right}`, class: "grid" }));
            text(ROOM.left - 6, y + 4, number, "end");
        }
        const step = this.width < 480 ? 100 : 50;
        for (let nm = FIRST_NM; nm <= LAST_NM; nm += step) {
            const x = Math.round(this.x(nm)) + 0.5;
            parts.push(svgElement("path", { d: `M${x} ${this.bottom}v${STRIP + 4}`, class: "grid" }));
            text(x, this.bottom + 22, nm, nm > FIRST_NM ? "middle" : "start");
        }
        text((ROOM.left + this.right) / 2, this.height - 6, "wavelength (nm)", "middle");
        text(0, 12, this.title, "start");
        this.axes.replaceChildren(...parts);
    }

    // The path of values from 300 nm on; it is broken where there is none.
    path(values, stepNm = 1, every = 1) {
        let d = "";
        let pen = "M";
        for (let i = 0; i < values.length; i += every) {
            const value = values[i];
            if (Number.isNaN(value)) {
                pen = "M";
                continue;
            }
            // Far outside the plot a line needs no place, and drawing programs dislike huge numbers.
            d += `${pen}${px(this.x(FIRST_NM + i * stepNm))} ${px(Math.max(this.y(value), -9999))}`;
            pen = "L";
        }
        return d;
    }

    // The area between values and a level below them.
    area(values, level, stepNm = 1, every = 1) {
        const held = values.map((value) => (value > level ? value : level));
        const y = px(this.y(level));
        const last = Math.floor((values.length - 1) / every) * every;
        return `${this.path(held, stepNm, every)}L${px(this.x(FIRST_NM + last * stepNm))} ${y}L${px(this.x(FIRST_NM))} ${y}Z`;
    }

    // Texts at lines, where few lines cross them: [{ key, text, kind, values, stepNm }] or, at a point, with
    // `at: [nm, value]`; the first are placed first. A label stays near where it was; one without a good
    // place is left out. lines: all that are drawn, [{ values, stepNm }].
    placeLabels(items, lines) {
        const cell = 4;
        const columns = Math.ceil(this.width / cell);
        const rows = Math.ceil(this.height / cell);
        const taken = new Uint8Array(columns * rows);
        const yAt = ({ values, stepNm = 1 }, x) => {
            const place = (x - ROOM.left) / this.perNm / stepNm;
            return this.y(values[Math.min(Math.max(Math.round(place), 0), values.length - 1)]);
        };
        const within = (y) => Math.min(Math.max(y, 0), this.height - 1);
        for (const line of lines) {
            let before = NaN;
            for (let x = ROOM.left; x < this.right; x += cell) {
                const y = within(yAt(line, x));
                if (!Number.isNaN(y)) {
                    const from = Number.isNaN(before) ? y : before;
                    for (let r = Math.floor(Math.min(from, y) / cell); r <= Math.max(from, y) / cell; r += 1) {
                        taken[r * columns + Math.floor(x / cell)] = 1;
                    }
                }
                before = y;
            }
        }
        const boxCost = (x, y, width) => {
            let sum = 0;
            for (let r = Math.floor(y / cell); r < (y + 14) / cell; r += 1) {
                for (let c = Math.floor(x / cell); c < (x + width) / cell; c += 1) {
                    sum += taken[r * columns + c];
                }
            }
            return sum;
        };
        // The title has its place already.
        for (let r = 0; r < 4; r += 1) {
            taken.fill(20, r * columns, r * columns + Math.ceil(widthOf(this.title) / cell));
        }
        this.places ??= new Map();
        const places = new Map();
        const texts = items.map((item) => {
            const width = widthOf(item.text);
            const before = this.places.get(item.key);
            let best = { cost: 20 + width / 6 };
            const consider = (x, y, extra) => {
                if (x < ROOM.left + 2 || x + width > this.right - 2 || y < ROOM.top - 20 || y + 14 > this.bottom - 2) {
                    return;
                }
                const moved = before ? 0.04 * Math.hypot(x - before.x, y - before.y) : 0;
                const least = extra + Math.min(moved, 12);
                if (least < best.cost) {
                    const cost = least + boxCost(x, y, width);
                    best = cost < best.cost ? { cost, x, y } : best;
                }
            };
            const around = (x, y, extra) => {
                consider(x - width / 2, y - 18, extra);
                consider(x + 8, y - 8, extra + 1);
                consider(x - 8 - width, y - 8, extra + 1);
                consider(x - width / 2, y + 4, extra + 2);
            };
            if (item.at) {
                const [x, y] = [this.x(item.at[0]), this.y(item.at[1])];
                for (const dy of [0, 16, -16, 32, -32, 48, -48]) {
                    consider(x + 14, y + dy - 8, Math.abs(dy) / 6);
                    consider(x - 14 - width, y + dy - 8, Math.abs(dy) / 6 + 1);
                }
            } else {
                // At its foot a line is hard to tell from others.
                const peak = item.values.reduce((most, v) => (v > most ? v : most), 1e-9);
                for (let x = ROOM.left + 4; x < this.right; x += 8) {
                    const y = yAt(item, x);
                    if (y >= ROOM.top - 2) {
                        around(x, y, 14 * (1 - ((this.bottom - y) / (this.bottom - ROOM.top)) * (this.top / peak)));
                    }
                }
            }
            if (best.x === undefined) {
                return null;
            }
            places.set(item.key, best);
            for (let r = Math.floor(best.y / cell); r < (best.y + 14) / cell; r += 1) {
                taken.fill(20, r * columns + Math.floor(best.x / cell), r * columns + Math.ceil((best.x + width) / cell));
            }
            const text = svgElement("text", { x: px(best.x), y: px(best.y + 11), class: `label ${item.kind}` }, item.text);
            item.color?.forEach(([name, value]) => text.style.setProperty(name, value));
            return text;
        });
        this.places = places;
        this.labels.replaceChildren(...texts.filter(Boolean));
    }

    // Moves the cursor to a wavelength, or takes it away.
    point(nm) {
        const next = nm === null ? null : Math.min(Math.max(Math.round(nm), FIRST_NM), LAST_NM);
        if (next !== this.nm) {
            this.nm = next;
            this.#drawCursor();
            this.onCursor(next);
        }
    }

    // What a screen reader says of the cursor.
    say(text) {
        this.root.setAttribute("aria-valuenow", this.nm ?? FIRST_NM);
        this.root.setAttribute("aria-valuetext", this.nm === null ? "no wavelength chosen" : text);
    }

    // Dots where the cursor meets lines: [{ value, kind, color }].
    showDots(dots) {
        this.dots = dots;
        this.#drawCursor();
    }

    #drawCursor() {
        if (this.nm === null || this.width === 0) {
            this.cursor.replaceChildren();
            return;
        }
        const x = px(this.x(this.nm));
        const text = `${this.nm} nm`;
        const half = widthOf(text) / 2 + 4;
        const middle = Math.min(Math.max(x, ROOM.left + half), this.right - half);
        const dots = (this.dots ?? []).filter(({ value }) => value >= 0 && value <= this.top).map((dot) => {
            const circle = svgElement("circle", { cx: x, cy: px(this.y(dot.value)), r: 3, class: `dot ${dot.kind}` });
            dot.color?.forEach(([name, value]) => circle.style.setProperty(name, value));
            return circle;
        });
        this.cursor.replaceChildren(
            svgElement("path", { d: `M${x} ${ROOM.top}V${this.bottom}`, class: "hair" }),
            svgElement("rect", {
                x: px(middle - half), y: this.bottom + 8, width: px(2 * half), height: 18, rx: 4, class: "flag",
            }),
            svgElement("text", { x: px(middle), y: this.bottom + 21, class: "flag-text" }, text),
            ...dots,
        );
    }

    #listen() {
        const at = (event) => {
            const { left } = this.root.getBoundingClientRect();
            this.point(FIRST_NM + (event.clientX - left - ROOM.left) / this.perNm);
        };
        this.root.addEventListener("pointermove", at);
        this.root.addEventListener("pointerdown", at);
        // What a finger pointed at stays, and so does what keys chose.
        this.root.addEventListener("pointerleave", (event) => {
            if (event.pointerType === "mouse" && !this.root.matches(":focus-visible")) {
                this.point(null);
            }
        });
        this.root.addEventListener("keydown", (event) => {
            const step = event.shiftKey ? 10 : 1;
            const from = this.nm ?? 550;
            const target = {
                ArrowLeft: from - step, ArrowDown: from - step, ArrowRight: from + step, ArrowUp: from + step,
                PageDown: from - 10, PageUp: from + 10, Home: FIRST_NM, End: LAST_NM, Escape: null,
            }[event.key];
            if (target !== undefined) {
                event.preventDefault();
                this.point(target);
            }
        });
    }
}

// Offers a text as a file.
export function download(name, type, text) {
    const address = URL.createObjectURL(new Blob([text], { type }));
    const link = element("a", { href: address, download: name });
    link.click();
    // Some browsers read it only after the click.
    setTimeout(() => URL.revokeObjectURL(address), 10000);
}

// Rows of values as CSV. Names may hold anything, so that all of them are quoted.
export function csvOf(names, rows) {
    const quoted = names.map((name) => (/^[a-z_]+$/.test(name) ? name : `"${name.replaceAll('"', '""')}"`));
    const number = (v) => (v === null || Number.isNaN(v) ? "" : String(Number(v.toPrecision(9))));
    return `${[quoted, ...rows.map((row) => row.map(number))].map((row) => row.join(",")).join("\n")}\n`;
}

const COPIED = ["fill", "fill-opacity", "stroke", "stroke-width", "stroke-dasharray", "stroke-opacity", "stroke-linecap",
    "stroke-linejoin", "paint-order", "opacity", "font-size", "font-weight", "text-anchor", "stop-color"];
const COLORED = ["fill", "stroke", "stop-color"];

// A drawing by itself: in the light colors, with all styles as attributes that any drawing program reads.
export function standaloneSvg(svg, title) {
    const copy = svg.cloneNode(true);
    const stage = element("div", { class: "stage" }, copy);
    document.body.append(stage);
    const paint = element("canvas", { width: 1, height: 1 }).getContext("2d", { willReadFrequently: true });
    const plain = (color) => {
        if (color === "none" || color.startsWith("url")) {
            return color.replaceAll('"', "");
        }
        paint.clearRect(0, 0, 1, 1);
        paint.fillStyle = color;
        paint.fillRect(0, 0, 1, 1);
        const bytes = paint.getImageData(0, 0, 1, 1).data;
        return `#${[...bytes.slice(0, 3)].map((v) => v.toString(16).padStart(2, "0")).join("")}`;
    };
    for (const node of copy.querySelectorAll("path, rect, text, circle, stop")) {
        const style = getComputedStyle(node);
        if (style.display === "none") {
            node.remove();
            continue;
        }
        const values = COPIED.map((name) => [name, style.getPropertyValue(name)]);
        for (const [name, value] of values) {
            if (value !== "" && value !== "normal" && (name !== "stop-color" || node.tagName === "stop")) {
                node.setAttribute(name, COLORED.includes(name) ? plain(value) : value);
            }
        }
    }
    for (const node of copy.querySelectorAll("[class], [style]")) {
        node.removeAttribute("class");
        node.removeAttribute("style");
    }
    copy.removeAttribute("aria-hidden");
    copy.setAttribute("font-family", "Helvetica, Arial, sans-serif");
    copy.prepend(svgElement("title", {}, title), svgElement("rect", { width: "100%", height: "100%", fill: "#ffffff" }));
    stage.remove();
    return new XMLSerializer().serializeToString(copy);
}
