// Opens files: a picture beside the cube's answers to it, a picture of spectra, a light, a dye.

import { canvasContext, cssColor, de2000, encoded, decoded, newImage, onScreen } from "./color.js";
import { set } from "./state.js";
import { NEEDS_PROGRAM, getBytes, getJson, postFile, sampledOf, served } from "./server.js";
import { makeLight, relit } from "./cube.js";
import { fieldOf } from "./build.js";
import { followPointer } from "./picker.js";
import { percent } from "./heat.js";
import { element } from "./dom.js";

// The page stays responsive if work is put aside so often.
const SLICE_MS = 8;
// Texels along an axis of a picture that the page reads by itself.
const MOST_TEXELS = 512;
// The start of a file by which its kind is told: a table's header, a picture's channels.
const HEAD_BYTES = 65536;

// Colors of differences, ΔE00, between which the map is mixed: coded sRGB.
const RAMP = [
    [0, [128, 128, 128]],
    [1, [255, 216, 74]],
    [2, [240, 120, 40]],
    [5, [160, 0, 60]],
];
// Texels with dyes, and those without.
const DYED = [177, 156, 255];
const PLAIN = [96, 96, 96];

export function makeDrop(root, app, panels) {
    const chooser = element("input", { type: "file", id: "drop-file", class: "drop-file" });
    const status = element("p", { class: "note drop-status", role: "status" });
    const shown = element("div");
    const kinds = served
        ? "A picture (EXR, TIFF, PNG, JPEG, HDR, TGA), a spectral or bispectral EXR, a light or a dye as CSV."
        : `A PNG or JPEG, read as sRGB. For other pictures, spectra, lights and dyes: ${NEEDS_PROGRAM}`;
    const reading = makeReading(() => take(file));
    root.append(
        element("div", { class: "drop-choose" },
            element("label", { for: "drop-file", class: "drop-label" }, "Choose a file"), chooser,
            element("span", { class: "note" }, "or drop one anywhere on the page")),
        element("p", { class: "note" }, kinds), status, reading.root, shown);
    // The file that is shown.
    let file = null;
    let view = null;
    let latest = 0;
    // Lights of files, which every cube is to have.
    const lights = [];
    let seenCube = null;

    async function take(taken) {
        if (file !== taken) {
            file = taken;
            reading.forget();
        }
        latest += 1;
        const ticket = latest;
        const say = (line) => {
            if (ticket === latest) {
                status.textContent = line;
            }
        };
        const show = (made) => {
            if (ticket === latest) {
                view = made;
                shown.replaceChildren(made.root);
                made.draw(app.now);
            }
        };
        panels.open();
        say(`Reading ${taken.name} …`);
        try {
            say(await opened(taken, show));
        } catch (error) {
            // Refusals name the file already.
            reading.root.open = true;
            const { message } = error;
            say(message.startsWith(taken.name) ? message : `${taken.name}: ${message}`);
        }
    }

    // Shows a file, and returns a line that says what it is.
    async function opened(taken, show) {
        const query = new URLSearchParams({ name: taken.name, cube: app.cube.id });
        if (!served) {
            show(makePicture(app, await picturedByBrowser(taken)));
            return `${taken.name}, read by the browser as sRGB.`;
        }
        const head = new TextDecoder("latin1").decode(await taken.slice(0, HEAD_BYTES).arrayBuffer());
        if (/\.csv$/i.test(taken.name)) {
            return head.includes("absorption") ? openDye(query, taken) : openLight(taken);
        }
        const isSpectral = head.includes("spectralLayoutVersion");
        await reading.offer(isSpectral ? ["unit"] : ["space", "encoding", "alpha", "layer"]);
        for (const [name, value] of reading.values()) {
            query.set(name, value);
        }
        const answer = await postFile(`${isSpectral ? "spectral" : "picture"}?${query}`, taken);
        const texels = new Float32Array(await getBytes(`drop/${answer.id}.data`));
        const { id, step, columns: width, rows: height } = answer;
        const picture = { id, step, width, height, texels, space: app.spaces[0] };
        show(isSpectral ? makeSpectralPicture(app, picture) : makePicture(app, picture));
        const size = `${answer.width} × ${answer.height} texels`;
        if (!isSpectral) {
            return `${taken.name}, ${size}: ${answer.sentence}.`;
        }
        const [first, last] = [answer.wavelengths_nm.at(0), answer.wavelengths_nm.at(-1)];
        return [`${taken.name}, ${size}: ${answer.kind}, ${first} to ${last} nm.`, ...answer.notes].join(" ");
    }

    async function openLight(taken) {
        reading.forget();
        const added = await addLight(app.cube, taken);
        lights.push(taken);
        await panels.build.refresh();
        set({ light: added });
        return `The light ${added} is chosen. Build has it, too.`;
    }

    async function openDye(query, taken) {
        reading.forget();
        const { name, dyes, normalize } = await postFile(`dye?${query}`, taken);
        await panels.build.refresh({ dyes, normalize });
        return `The dye ${name} is one of ${dyes.length} that Build takes as my dyes.`;
    }

    async function addLight(cube, taken) {
        const query = new URLSearchParams({ name: taken.name, cube: cube.id });
        const { nm, irradiance, weights, power, ...description } = await postFile(`light?${query}`, taken);
        const light = makeLight(description, nm, irradiance, weights.flat(), power);
        const at = cube.lights.findIndex((other) => other.name === light.name);
        if (at < 0) {
            cube.lights.push(light);
        } else if (at > 0) {
            cube.lights[at] = light;
        }
        // The first is the cube's own: it was built under this light.
        return light.name;
    }

    chooser.addEventListener("change", () => {
        if (chooser.files.length > 0) {
            take(chooser.files[0]);
            // The same file can be chosen again.
            chooser.value = "";
        }
    });
    const holdsFiles = (event) => event.dataTransfer?.types.includes("Files");
    addEventListener("dragover", (event) => {
        if (holdsFiles(event)) {
            event.preventDefault();
            document.body.classList.add("is-dropping");
        }
    });
    addEventListener("dragleave", (event) => {
        if (event.relatedTarget === null) {
            document.body.classList.remove("is-dropping");
        }
    });
    addEventListener("drop", (event) => {
        document.body.classList.remove("is-dropping");
        if (holdsFiles(event)) {
            event.preventDefault();
            take(event.dataTransfer.files[0]);
        }
    });

    return {
        draw(now) {
            view?.draw(now);
            if (seenCube !== now.cube) {
                seenCube = now.cube;
                for (const light of lights) {
                    addLight(now.cube, light).then(() => set({}), (error) => app.say(error.message));
                }
            }
        },
    };
}

// How the numbers of a file are meant, where the user knows better than the file says.
function makeReading(change) {
    const fields = element("div", { class: "build-form" });
    const root = element("details", { class: "drop-reading", hidden: "" },
        element("summary", { class: "note" }, "What the file does not say"), fields);
    const words = {
        space: ["RGB space", (choices) => choices.spaces],
        encoding: ["Encoding", (choices) => choices.encodings],
        alpha: ["Alpha", (choices) => choices.alphas],
        layer: ["Layer"],
        unit: ["Unit of re-radiation", (choices) => choices.bispectral_units],
    };
    let selects = [];
    return {
        root,
        forget() {
            selects = [];
            root.hidden = true;
        },
        async offer(names) {
            if (selects.length > 0) {
                return;
            }
            const choices = await getJson("choices");
            selects = names.map((name) => {
                const [label, list] = words[name];
                const id = `drop-${name}`;
                const select = list
                    ? element("select", { id }, element("option", { value: "" }, "as the file says"),
                        ...list(choices).map((word) => element("option", { value: word }, word)))
                    : element("input", { id, type: "text", placeholder: "the one that there is" });
                select.addEventListener("change", change);
                return { name, select, field: fieldOf(label, select).root };
            });
            fields.replaceChildren(...selects.map(({ field }) => field));
            root.hidden = false;
            root.open = false;
        },
        values: () => selects
            .map(({ name, select }) => [name, select.value])
            .filter(([, value]) => value !== ""),
    };
}

// What browsers decode, in linear sRGB.
async function picturedByBrowser(file) {
    let bitmap;
    try {
        bitmap = await createImageBitmap(file, { colorSpaceConversion: "default" });
    } catch {
        throw new Error("no picture that this browser reads; expected PNG or JPEG");
    }
    const step = Math.max(1, Math.ceil(Math.max(bitmap.width, bitmap.height) / MOST_TEXELS));
    const [width, height] = [bitmap.width, bitmap.height].map((size) => Math.ceil(size / step));
    const canvas = element("canvas", { width: String(width), height: String(height) });
    const context = canvas.getContext("2d", { willReadFrequently: true });
    context.imageSmoothingEnabled = false;
    context.drawImage(bitmap, 0, 0, width, height);
    const { data } = context.getImageData(0, 0, width, height);
    const linear = Float32Array.from({ length: 256 }, (_, code) => decoded(code / 255));
    const texels = new Float32Array(3 * width * height);
    for (let i = 0; i < width * height; i += 1) {
        for (let k = 0; k < 3; k += 1) {
            texels[3 * i + k] = linear[data[4 * i + k]];
        }
    }
    return { width, height, step, texels, space: { name: "sRGB" } };
}

// Gives way to what else the page has to do.
const giveWay = () => new Promise((done) => { setTimeout(done); });

// A canvas of texels in which one is picked, by pointer or arrow keys.
function makeTexels(width, height, label, pick) {
    const canvas = element("canvas", { width: String(width), height: String(height) });
    const mark = element("div", { class: "texel-mark", hidden: "" });
    const named = { tabindex: "0", role: "application", "aria-label": label };
    const root = element("div", { class: "texels", ...named }, canvas, mark);
    // Two of them fit into the panel, one below the other.
    root.style.setProperty("max-width", `calc(30vh * ${width / height})`);
    let at = [Math.floor(width / 2), Math.floor(height / 2)];
    const within = (v, most) => Math.min(Math.max(v, 0), most - 1);
    const go = (x, y) => pick([within(x, width), within(y, height)]);
    followPointer(root, ([x, y]) => go(Math.floor(x * width), Math.floor(y * height)));
    root.addEventListener("keydown", (event) => {
        const step = event.shiftKey ? 10 : 1;
        const move = {
            ArrowLeft: [-step, 0], ArrowRight: [step, 0], ArrowUp: [0, -step], ArrowDown: [0, step],
            Enter: [0, 0],
        }[event.key];
        if (move) {
            event.preventDefault();
            go(at[0] + move[0], at[1] + move[1]);
        }
    });
    return {
        root,
        context: canvasContext(canvas),
        mark([x, y]) {
            at = [x, y];
            mark.hidden = false;
            mark.style.setProperty("left", `${(100 * (x + 0.5)) / width}%`);
            mark.style.setProperty("top", `${(100 * (y + 0.5)) / height}%`);
        },
    };
}

// Bytes of an image from linear RGB of the screen.
function putColor(image, at, { rgb }) {
    for (let k = 0; k < 3; k += 1) {
        image.data[at + k] = 255 * encoded(rgb[k]) + 0.5;
    }
    image.data[at + 3] = 255;
}

function putCode(image, at, code) {
    for (let k = 0; k < 3; k += 1) {
        image.data[at + k] = code[k];
    }
    image.data[at + 3] = 255;
}

function rampAt(difference) {
    const after = RAMP.findIndex(([value]) => value > difference);
    if (after < 0) {
        return RAMP.at(-1)[1];
    }
    const [[from, low], [to, high]] = [RAMP[after - 1], RAMP[after]];
    const t = (difference - from) / (to - from);
    return low.map((v, k) => v + t * (high[k] - v));
}

// A picture, beside how far the cube's answers are from its texels and which of them use dyes.
function makePicture(app, { width, height, step, texels, space }) {
    const label = "arrow keys move, with Shift faster; the color is that of the texel";
    const original = makeTexels(width, height, `Picture: ${label}`, pick);
    const map = makeTexels(width, height, `Map of differences: ${label}`, pick);
    const modes = [["Difference", "difference"], ["Dyes", "dyes"]].map(([name, mode]) => {
        const button = element("button", { type: "button" }, name);
        button.addEventListener("click", () => {
            shownMode = mode;
            paintMap(0, height);
            drawModes();
        });
        return { button, mode };
    });
    const key = element("div", { class: "ramp", "aria-hidden": "true" });
    const gradient = RAMP.map(([value, code]) => `rgb(${code.join(" ")}) ${(100 * value) / 5}%`);
    const ramp = element("div", { class: "ramp-colors" });
    ramp.style.setProperty("background", `linear-gradient(to right, ${gradient.join(", ")})`);
    for (const [value] of RAMP) {
        const tick = element("span", { class: "note" }, value === 5 ? "5+ ΔE00" : String(value));
        tick.style.setProperty("left", `${(100 * value) / 5}%`);
        key.append(tick);
    }
    key.append(ramp);
    const dyeSwatch = element("span", { class: "dye-swatch" });
    const dyeKey = element("p", { class: "note dye-key" }, dyeSwatch, "with dyes");
    const shares = element("p", { class: "shares" });
    const texel = element("p", { class: "note texel" }, "Click a texel, or move with the arrow keys.");
    const root = element("div", { class: "opened" },
        shares,
        element("div", { class: width < height ? "pictures tall" : "pictures" }, original.root, map.root),
        element("div", { class: "tabs", role: "group", "aria-label": "What the map shows" },
            ...modes.map(({ button }) => button)),
        element("div", { class: "map-keys" }, key, dyeKey), texel);

    const differences = new Float32Array(width * height);
    const doses = new Float32Array(width * height);
    const images = [original, map].map(({ context }) => newImage(context, width, height));
    let shownMode = "difference";
    let cube = null;
    let at = null;

    function drawModes() {
        for (const { button, mode } of modes) {
            button.setAttribute("aria-pressed", String(mode === shownMode));
        }
        key.classList.toggle("away", shownMode !== "difference");
        dyeKey.classList.toggle("away", shownMode !== "dyes");
    }

    // The space by its name: under another light its numbers mean another XYZ.
    const spaceNow = () => app.spaces.find(({ name }) => name === space.name) ?? space;
    const valueAt = (i) => [texels[3 * i], texels[3 * i + 1], texels[3 * i + 2]];

    function pick([x, y]) {
        at = [x, y];
        app.goTo(spaceNow().to(valueAt(y * width + x)));
        drawTexel();
    }

    function drawTexel() {
        if (at) {
            const [x, y] = at;
            const i = y * width + x;
            [original, map].forEach((canvas) => canvas.mark(at));
            const dose = doses[i] > 0 ? `dyes of dose ${doses[i].toFixed(3)}` : "no dyes";
            texel.textContent = `Texel ${x * step}, ${y * step}: ΔE00 ${differences[i].toFixed(2)}, ${dose}.`;
        }
    }

    function paintMap(from, to) {
        for (let i = from * width; i < to * width; i += 1) {
            const dyed = doses[i] > 0 ? DYED : PLAIN;
            putCode(images[1], 4 * i, shownMode === "dyes" ? dyed : rampAt(differences[i]));
        }
        map.context.putImageData(images[1], 0, 0, 0, from, width, to - from);
    }

    // Asks the cube for all texels, by rows; stops when there is another cube.
    async function assess(asked) {
        const found = spaceNow();
        const isOwn = found === app.spaces[0];
        const light = asked.lights[0];
        let count = 0;
        let missed = 0;
        let dyed = 0;
        let from = 0;
        let start = performance.now();
        for (let y = 0; y < height; y += 1) {
            for (let i = y * width; i < (y + 1) * width; i += 1) {
                const value = valueAt(i);
                const xyz = found.to(value);
                const rgb = isOwn ? value : asked.rgbOf(xyz);
                const material = asked.lookUp(rgb.map((v) => Math.min(Math.max(v, 0), 1)));
                differences[i] = de2000(asked.labOf(xyz), asked.labOf(asked.mixedColor(material)));
                doses[i] = asked.mixedDose(material);
                putColor(images[0], 4 * i, onScreen(xyz, light));
                count += 1;
                missed += differences[i] > 1 ? 1 : 0;
                dyed += doses[i] > 0 ? 1 : 0;
            }
            if (performance.now() - start > SLICE_MS || y === height - 1) {
                original.context.putImageData(images[0], 0, 0, 0, from, width, y + 1 - from);
                paintMap(from, y + 1);
                from = y + 1;
                shares.textContent = `Looking up: ${((100 * from) / height).toFixed(0)} %`;
                await giveWay();
                if (cube !== asked) {
                    return;
                }
                start = performance.now();
            }
        }
        const texelsShown = step > 1 ? `the ${width} × ${height} texels shown` : "the texels";
        shares.textContent = `${percent(missed / count)} of ${texelsShown} miss by more than 1 ΔE00; `
            + `${percent(dyed / count)} use dyes.`;
        drawTexel();
    }

    drawModes();
    return {
        root,
        draw(now) {
            if (cube !== now.cube) {
                cube = now.cube;
                assess(cube);
            }
        },
    };
}

// A picture of spectra; a pixel's material takes the place of the cube's.
function makeSpectralPicture(app, { id, width, height, step, texels, space }) {
    const view = makeTexels(width, height, "Picture: arrow keys move; charts show the pixel", pick);
    const root = element("div", { class: "opened" },
        element("div", { class: "pictures" }, view.root),
        element("p", { class: "note texel" }, "Click a pixel: charts show its spectrum, under every light."));
    const text = root.lastChild;
    const image = newImage(view.context, width, height);
    const light = app.cube.lights[0];
    for (let i = 0; i < width * height; i += 1) {
        const value = [texels[3 * i], texels[3 * i + 1], texels[3 * i + 2]];
        putColor(image, 4 * i, onScreen(space.to(value), light));
    }
    view.context.putImageData(image, 0, 0);
    let isAsking = false;
    let next = null;

    // One request at a time; of those that come meanwhile only the last counts.
    async function pick(place) {
        view.mark(place);
        next = place;
        if (isAsking) {
            return;
        }
        isAsking = true;
        while (next) {
            const [x, y] = next.map((v) => v * step);
            next = null;
            try {
                const { cube, now } = app;
                const answer = await getJson(`drop/${id}/pixel?x=${x}&y=${y}&cube=${cube.id}`);
                const sampled = sampledOf(answer);
                app.goTo(relit(sampled, cube.lights[0], 1, now.below));
                app.show({ sampled, title: answer.label });
                text.textContent = `Pixel ${x}, ${y}: charts show its spectrum, under every light.`;
            } catch (error) {
                text.textContent = error.message;
            }
        }
        isAsking = false;
    }

    return { root, draw() {} };
}
