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
    const values = Array.from({ length: count + 1 }, (_, k) => k * step);
    return values.map((value) => ({ value, text: value.toFixed(digits) }));
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

function setAll(node, attributes) {
    Object.entries(attributes).forEach(([name, value]) => node.setAttribute(name, value));
    return node;
}

// Sets custom properties of an element, which its styles read.
export function colored(node, properties = []) {
    properties.forEach(([name, value]) => node.style.setProperty(name, value));
    return node;
}

const LABEL_HEIGHT = 14;
// Pixels of a cell in which lines and labels are counted: smaller is slower, larger leaves room unused.
const CELL = 4;
// What a label costs that covers a cell of another, in cells of lines.
const COVERED = 20;
// What it costs that a label leaves its spot: less makes labels jump about while colors are dragged, more
// leaves them where lines have come to cross them.
const MOVED = 24;
// What it costs that a label has its short text, in cells of lines.
const SHORTENED = 32;
// Below this share of its peak a line is too near to the others at the axis to have its label there.
const FOOT = 0.15;

// Which cells of a chart have lines or labels in them.
class Taken {
    constructor(width, height) {
        this.height = height;
        this.columns = Math.ceil(width / CELL);
        this.cells = new Uint8Array(this.columns * Math.ceil(height / CELL));
    }

    addLine(from, to, heightAt) {
        let before = NaN;
        for (let x = from; x < to; x += CELL) {
            const y = Math.min(Math.max(heightAt(x), 0), this.height - 1);
            const other = Number.isNaN(before) ? y : before;
            const column = Math.floor(x / CELL);
            const last = Math.floor(Math.max(y, other) / CELL);
            for (let row = Math.floor(Math.min(y, other) / CELL); row <= last; row += 1) {
                this.cells[row * this.columns + column] = 1;
            }
            before = y;
        }
    }

    // Rows and columns of the box of a label: first ones, and ends.
    #cellsOf(x, y, width) {
        const [top, left] = [y, x].map((v) => Math.floor(v / CELL));
        return [top, Math.ceil((y + LABEL_HEIGHT) / CELL), left, Math.ceil((x + width) / CELL)];
    }

    addBox(x, y, width) {
        const [top, bottom, left, right] = this.#cellsOf(x, y, width);
        for (let row = top; row < bottom; row += 1) {
            this.cells.fill(COVERED, row * this.columns + left, row * this.columns + right);
        }
    }

    under(x, y, width) {
        const [top, bottom, left, right] = this.#cellsOf(x, y, width);
        let sum = 0;
        for (let row = top; row < bottom; row += 1) {
            for (let column = left; column < right; column += 1) {
                sum += this.cells[row * this.columns + column];
            }
        }
        return sum;
    }
}

export class WaveChart {
    // title: of the axis of values, { id, text }. heightOf: pixels, from the width. onCursor: called after
    // the cursor moved, to a wavelength or null. onSize: called after the chart got another size. colors: of
    // the strip under the axis, [{ nm, color, opacity }].
    constructor({ label, title, heightOf, onCursor, onSize, colors = [] }) {
        Object.assign(this, { heightOf, onCursor, onSize, title: title.text });
        Object.assign(this, { width: 0, height: 0, top: 0, nm: null, dots: [], places: new Map() });
        this.axes = svgElement("g");
        this.plot = svgElement("g", { "clip-path": `url(#${title.id}-clip)` });
        this.marks = svgElement("g");
        this.labels = svgElement("g");
        this.cursor = svgElement("g", { class: "cursor" });
        this.window = svgElement("rect");
        this.strip = svgElement("rect", { height: STRIP, fill: `url(#${title.id}-strip)` });
        const gradient = svgElement("linearGradient", { id: `${title.id}-strip` });
        for (const { nm, color, opacity } of colors) {
            const offset = ((nm - FIRST_NM) / (FINE - 1)).toFixed(4);
            const stop = svgElement("stop", { offset, "stop-opacity": opacity });
            stop.style.setProperty("stop-color", color);
            gradient.append(stop);
        }
        this.svg = svgElement("svg", { "aria-hidden": "true" },
            svgElement("defs", {}, gradient, svgElement("clipPath", { id: `${title.id}-clip` }, this.window)),
            this.axes, this.strip, this.plot, this.marks, this.labels, this.cursor);
        this.root = element("div", {
            class: "chart", tabindex: "0", role: "slider", "aria-label": label,
            "aria-valuemin": FIRST_NM, "aria-valuemax": LAST_NM, "aria-valuenow": FIRST_NM,
            "aria-valuetext": "no wavelength chosen",
        }, this.svg);
        this.#listen();
        const resize = ([{ contentRect }]) => this.#resize(Math.floor(contentRect.width));
        new ResizeObserver(resize).observe(this.root);
    }

    #resize(width) {
        if (width === this.width || width < 100) {
            return;
        }
        this.width = width;
        this.height = this.heightOf(width);
        setAll(this.svg, { width, height: this.height, viewBox: `0 0 ${width} ${this.height}` });
        this.right = width - ROOM.right;
        this.bottom = this.height - ROOM.bottom;
        this.perNm = (this.right - ROOM.left) / (FINE - 1);
        const across = { x: ROOM.left, width: this.right - ROOM.left };
        setAll(this.window, { ...across, y: ROOM.top, height: this.bottom - ROOM.top });
        setAll(this.strip, { ...across, y: this.bottom + 1 });
        this.#drawAxes();
        this.onSize();
        this.#drawCursor();
    }

    // Ends the axis at a value.
    setTop(top) {
        if (top !== this.top) {
            this.top = top;
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
        if (this.top === 0 || this.width === 0) {
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
            } else {
                // Far outside the plot a line needs no place, and drawing programs dislike huge numbers.
                d += `${pen}${px(this.x(FIRST_NM + i * stepNm))} ${px(Math.max(this.y(value), -9999))}`;
                pen = "L";
            }
        }
        return d;
    }

    // The area between values and a level below them.
    area(values, level, stepNm = 1, every = 1) {
        const held = values.map((value) => (value > level ? value : level));
        const y = px(this.y(level));
        const last = Math.floor((values.length - 1) / every) * every;
        const [left, right] = [0, last].map((i) => px(this.x(FIRST_NM + i * stepNm)));
        return `${this.path(held, stepNm, every)}L${right} ${y}L${left} ${y}Z`;
    }

    // Texts at lines, where few lines cross them: [{ key, text, short, kind, color, values, stepNm }], best
    // at nearNm; or at a point, [{ at: [nm, value] }]. The first are placed first. A label stays near where
    // it was; one without a good place is left out. lines: all that are drawn, [{ values, stepNm }].
    placeLabels(items, lines) {
        const taken = new Taken(this.width, this.height);
        for (const line of lines) {
            taken.addLine(ROOM.left, this.right, (x) => this.#heightAt(line, x));
        }
        // The title has its place already.
        taken.addBox(0, 0, widthOf(this.title));
        const placed = new Map();
        for (const item of items) {
            const best = this.#bestPlace(item, taken);
            if (best) {
                taken.addBox(best.x, best.y, widthOf(best.text));
                placed.set(item.key, { ...best, item });
            }
        }
        this.places = placed;
        this.labels.replaceChildren(...[...placed.values()].map(({ x, y, text, item: { kind, color } }) => {
            const label = svgElement("text", { x: px(x), y: px(y + 11), class: `label ${kind}` }, text);
            return colored(label, color);
        }));
    }

    // Where a line is at a place across, in pixels.
    #heightAt({ values, stepNm = 1 }, x) {
        const index = Math.round((x - ROOM.left) / this.perNm / stepNm);
        return this.y(values[Math.min(Math.max(index, 0), values.length - 1)]);
    }

    // The place and the text of a label with the least cost: for lines that cross it, for labels below it,
    // and for being elsewhere than before.
    #bestPlace(item, taken) {
        const before = this.places.get(item.key);
        const longest = widthOf(item.text);
        // Up to this cost a label is legible.
        let best = { cost: 20 + longest / 6 };
        for (const text of [item.text, item.short].filter(Boolean)) {
            const width = widthOf(text);
            const consider = (spot, x, y, extra) => {
                if (x < ROOM.left + 2 || x + width > this.right - 2 || y < ROOM.top - 20
                    || y + LABEL_HEIGHT > this.bottom - 2) {
                    return;
                }
                const stays = !before || (spot === before.spot && text === before.text);
                const least = extra + (stays ? 0 : MOVED) + (text === item.text ? 0 : SHORTENED);
                const cost = least < best.cost ? least + taken.under(x, y, width) : least;
                if (cost < best.cost) {
                    best = { cost, spot, x, y, text };
                }
            };
            this.#offerPlaces(item, width, consider);
        }
        return best.text ? best : null;
    }

    // Calls back with spots for a label: a number that stays while the line moves, the corner of the box, and
    // what it costs before lines are counted.
    #offerPlaces(item, width, consider) {
        const beside = (spot, x, y, gap, extra) => {
            consider(spot, x + gap, y - 8, extra);
            consider(spot + 1, x - gap - width, y - 8, extra);
        };
        if (item.at) {
            const [x, y] = [this.x(item.at[0]), this.y(item.at[1])];
            for (const dy of [0, 16, -16, 32, -32, 48, -48]) {
                beside(2 * dy, x, y + dy, 14, Math.abs(dy) / 6);
            }
            return;
        }
        const peak = item.values.reduce((most, v) => (v > most ? v : most), 1e-9);
        for (let x = ROOM.left + 4; x < this.right; x += 8) {
            const y = this.#heightAt(item, x);
            const share = ((this.bottom - y) / (this.bottom - ROOM.top)) * (this.top / peak);
            if (y >= ROOM.top - 2 && share > FOOT) {
                const extra = item.nearNm ? Math.abs(x - this.x(item.nearNm)) / 30 : 14 * (1 - share);
                consider(x + 2, x - width / 2, y - 18, extra);
                consider(x + 3, x - width / 2, y + 4, extra + 2);
                beside(x, x, y, 8, extra + 1);
            }
        }
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

    // Dots where the cursor meets lines: [{ value, kind }].
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
        const dots = this.dots.filter(({ value }) => value >= 0 && value <= this.top).map(({ value, kind }) =>
            svgElement("circle", { cx: x, cy: px(this.y(value)), r: 3, class: `dot ${kind}` }));
        this.cursor.replaceChildren(
            svgElement("path", { d: `M${x} ${ROOM.top}V${this.bottom}`, class: "hair" }),
            setAll(svgElement("rect", { height: 18, rx: 4, class: "flag" }), {
                x: px(middle - half), y: this.bottom + 8, width: px(2 * half),
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

// Properties that a saved drawing needs, each with the value that it has anyway.
const COPIED = {
    fill: "", stroke: "none", "fill-opacity": "1", "stroke-opacity": "1", "stroke-width": "1px",
    "stroke-dasharray": "none", "stroke-linecap": "butt", "stroke-linejoin": "miter", "paint-order": "normal",
    opacity: "1", "text-anchor": "start", "font-size": "14px",
};
// Pixels of white around a saved drawing.
const PAPER = 12;
const COPIED_OF_STOPS = { "stop-color": "" };

// A drawing by itself: in the light colors, with all styles as attributes that any drawing program reads.
export function standaloneSvg(svg, title) {
    const copy = svg.cloneNode(true);
    copy.querySelector(".cursor").remove();
    const stage = element("div", { class: "chart stage" }, copy);
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
        for (const [name, usual] of Object.entries(node.tagName === "stop" ? COPIED_OF_STOPS : COPIED)) {
            const value = style.getPropertyValue(name);
            if (value !== usual) {
                node.setAttribute(name, /fill$|stroke$|color$/.test(name) ? plain(value) : value);
            }
        }
    }
    for (const node of copy.querySelectorAll("[class], [style]")) {
        node.removeAttribute("class");
        node.removeAttribute("style");
    }
    copy.removeAttribute("aria-hidden");
    copy.setAttribute("font-family", "Helvetica, Arial, sans-serif");
    const { width, height } = svg.viewBox.baseVal;
    const around = { width: width + 2 * PAPER, height: height + 2 * PAPER };
    setAll(copy, { ...around, viewBox: `${-PAPER} ${-PAPER} ${around.width} ${around.height}` });
    const paper = svgElement("rect", { x: -PAPER, y: -PAPER, ...around, fill: "#ffffff" });
    copy.prepend(svgElement("title", {}, title), paper);
    stage.remove();
    return new XMLSerializer().serializeToString(copy);
}
