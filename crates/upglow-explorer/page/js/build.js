// Builds other cubes while the page stays in use, and compares them with the one before.

import { cssColor, de2000, onScreen } from "./color.js";
import { NEEDS_PROGRAM, getJson, postJson, served } from "./server.js";
import { element } from "./dom.js";
import { percent } from "./heat.js";

// How often the program is asked how far it is.
const POLL_MS = 120;
// Nodes along each axis: of cubes that are built as a slider is released, and those to choose from.
const MOVING = 17;
const RESOLUTIONS = [17, 32, 48, 64];
const USUAL = 32;
// The sliders of slopes are logarithmic, 1/nm.
const SLOPES = [0.002, 0.2];

// What the program calls files that were opened: this for all dyes, this and a name for a light.
const MINE = "dropped";
const FLUORESCENT = ["film", "dyes", "analytic"];

// Options that are one of a list, with the models that they apply to.
const LISTS = [
    ["--preset", "Preset"],
    ["--model", "Model"],
    ["--space", "RGB space"],
    ["--illuminant", "Light"],
    ["--dyes", "Dyes", ["film", "dyes"]],
    ["--accounting", "What is conserved", FLUORESCENT],
    ["--mixing", "Mixing of two dyes", ["dyes"]],
    ["--slope-limits", "Slope limits"],
];
const SLIDERS = [
    ["--slope-max-per-nm", "Greatest slope of a reflectance, 1/nm"],
    ["--slope-under-dyes-per-nm", "Greatest slope under dyes, 1/nm", FLUORESCENT],
];

export function makeBuild(root, app) {
    if (!served) {
        root.append(element("p", {}, NEEDS_PROGRAM), commandLine("upglow explore").root);
        return { draw() {} };
    }
    const form = element("form", { class: "build-form", novalidate: "" });
    const comparison = makeComparison(app);
    root.append(form);
    let choices = null;
    // Dyes that were opened.
    let mine = null;
    // Options that are not as the preset has them.
    const given = {};
    let resolution = USUAL;
    let latest = 0;
    let job = null;
    let fields = [];

    const optionOf = (name) => choices.options.find((option) => option.name === name);
    const presetOptions = () => {
        const chosen = given["--preset"] ?? optionOf("--preset").default;
        return choices.presets.find(({ name }) => name === chosen).options;
    };
    const valueOf = (name) => given[name] ?? presetOptions()[name];
    const wordsOf = (name) => ({
        "--preset": () => choices.presets.map((preset) => preset.name),
        "--space": () => choices.spaces,
        "--illuminant": () => [...choices.lights, ...choices.dropped_lights],
        "--dyes": () => [...choices.dye_sets.map((set) => set.name), ...(mine ? [MINE] : [])],
    })[name]?.() ?? optionOf(name).words;

    const live = element("input", { type: "checkbox", id: "build-live" });
    const start = element("button", { type: "submit", class: "primary" }, "Build");
    const stop = element("button", { type: "button" }, "Stop");
    const reset = element("button", { type: "button" }, "As the preset");
    const bar = element("progress", { max: "1", value: "0", "aria-label": "Progress of the build" });
    const status = element("p", { class: "note build-status", role: "status" });
    const command = commandLine("upglow build -o cube.safetensors");

    function change(name, value) {
        if (value === "" || value === undefined) {
            delete given[name];
        } else {
            given[name] = value;
        }
        drawForm();
        if (live.checked) {
            build();
        }
    }

    function list([name, label, models]) {
        const select = element("select", { id: `build${name}`, title: optionOf(name)?.help ?? "" });
        select.addEventListener("change", () => change(name, select.value));
        return {
            name, models,
            root: fieldOf(label, select),
            draw() {
                const usual = optionOf(name)?.default;
                const ofPreset = presetOptions()[name];
                const words = wordsOf(name).filter((word) => word !== usual);
                const first = usual ?? (ofPreset ? `${ofPreset} (preset)` : "default");
                select.replaceChildren(
                    element("option", { value: "" }, first),
                    ...words.map((word) => element("option", { value: word }, shownWord(word))));
                select.value = given[name] ?? "";
            },
        };
    }

    // Of files that were opened, the names.
    function shownWord(word) {
        return word === MINE ? `my dyes: ${mine.dyes.join(", ")}` : word.replace(`${MINE}:`, "opened: ");
    }

    function slider([name, label, models]) {
        const [least, most] = SLOPES;
        const number = element("input", {
            id: `build${name}`, type: "number", min: "0.0001", max: "0.2", step: "any",
            title: optionOf(name).help,
        });
        const range = element("input", {
            type: "range", min: "0", max: "1", step: "any", "aria-label": label,
        });
        const [other] = SLIDERS.map((slope) => slope[0]).filter((slope) => slope !== name);
        const take = (value) => {
            // The limit under dyes is at most the other.
            const isBeyond = name === SLIDERS[0][0] ? slopeOf(other) > value : slopeOf(other) < value;
            if (isBeyond && applies(other)) {
                given[other] = String(value);
            }
            change(name, String(value));
        };
        const at = () => Number((least * (most / least) ** range.valueAsNumber).toPrecision(2));
        range.addEventListener("input", () => {
            number.value = String(at());
        });
        range.addEventListener("change", () => take(at()));
        number.addEventListener("change", () => {
            if (number.value === "") {
                change(name, "");
            } else {
                take(number.valueAsNumber);
            }
        });
        return {
            name, models,
            root: fieldOf(label, number, range),
            draw() {
                number.value = given[name] ?? "";
                number.placeholder = String(slopeOf(name));
                range.value = String(Math.log(slopeOf(name) / least) / Math.log(most / least));
            },
        };
    }

    // No limit is the steepest that there is.
    const slopeOf = (name) => {
        const value = Number(valueOf(name));
        return Number.isFinite(value) ? value : SLOPES[1];
    };

    function applies(name) {
        const { models } = fields.find((field) => field.name === name);
        return !models || models.includes(valueOf("--model"));
    }

    function drawForm() {
        for (const { name, root: box, draw } of fields) {
            box.root.hidden = !applies(name);
            box.say("");
            draw();
        }
        for (const button of sizes.children) {
            const isOn = Number(button.textContent) === (live.checked ? MOVING : resolution);
            button.setAttribute("aria-pressed", String(isOn));
            button.disabled = live.checked;
        }
        reset.disabled = Object.keys(given).every((name) => name === "--preset");
    }

    const sizes =
        element("div", { class: "build-sizes", role: "group", "aria-label": "Nodes along each axis" });
    for (const size of RESOLUTIONS) {
        const button = element("button", { type: "button" }, String(size));
        button.addEventListener("click", () => {
            resolution = size;
            drawForm();
        });
        sizes.append(button);
    }

    async function load() {
        if (!choices) {
            choices = await getJson("choices");
            fields = [...LISTS.map(list), ...SLIDERS.map(slider)];
            form.append(
                ...fields.map((field) => field.root.root),
                element("div", { class: "field wide" },
                    element("span", { class: "note", "aria-hidden": "true" }, "Nodes along each axis"),
                    sizes),
                element("label", { class: "build-live", for: "build-live" }, live,
                    `Build as I move: ${MOVING}³ at each change`),
                element("div", { class: "build-buttons" }, start, stop, reset),
                element("div", { class: "wide" }, bar, status),
                comparison.root,
                element("div", { class: "wide" },
                    element("p", { class: "note" }, "The same on the command line:"), command.root));
            drawForm();
            idle("");
        }
    }

    function idle(line) {
        job = null;
        stop.disabled = true;
        bar.value = 0;
        status.textContent = line;
    }

    // A refusal, at the field that it names.
    function refuse(line) {
        const name = /^(--[a-z-]+): /.exec(line)?.[1];
        const field = fields.find((other) => other.name === name && !other.root.root.hidden);
        field?.root.say(line.slice(name.length + 2));
        idle(field ? `Not built: see ${name}.` : line);
    }

    async function build() {
        latest += 1;
        const ticket = latest;
        fields.forEach((field) => field.root.say(""));
        const entries = Object.entries(given).filter(([name]) => applies(name));
        const isLive = live.checked;
        const size = isLive ? MOVING : resolution;
        const options = Object.fromEntries([...entries, ["--resolution", String(size)]]);
        if (options["--dyes"] === MINE && mine.normalize) {
            options["--normalize-dyes"] = "";
        }
        try {
            job = await postJson("build", { options });
            command.say(job.command);
            stop.disabled = false;
            while (job.state === "running" && ticket === latest) {
                bar.value = job.share;
                const percentage = (100 * job.share).toFixed(0);
                status.textContent = `${job.text}: ${percentage} %, ${job.seconds.toFixed(1)} s`;
                await new Promise((done) => { setTimeout(done, POLL_MS); });
                job = ticket === latest ? await getJson(`build/${job.id}`) : job;
            }
            if (ticket !== latest) {
                return;
            }
            const { state, seconds, error, cube } = job;
            if (state === "done") {
                await app.openCube(cube, isLive);
                idle(`Built ${size}³ nodes in ${seconds.toFixed(1)} s.`);
                bar.value = 1;
            } else {
                idle(state === "stopped" ? "Stopped." : "");
                if (error) {
                    refuse(error);
                }
            }
        } catch (error) {
            if (ticket === latest) {
                refuse(error.message);
            }
        }
    }

    form.addEventListener("submit", (event) => {
        event.preventDefault();
        build();
    });
    live.addEventListener("change", () => {
        drawForm();
        if (live.checked) {
            build();
        }
    });
    stop.addEventListener("click", () => {
        postJson(`build/${job.id}/stop`, {}).catch((error) => idle(error.message));
    });
    reset.addEventListener("click", () => {
        for (const name of Object.keys(given)) {
            if (name !== "--preset") {
                delete given[name];
            }
        }
        change("--preset", given["--preset"]);
    });

    return {
        open: () => load().catch((error) => app.say(error.message)),
        // Files that were opened are among the choices.
        async refresh(dyes = mine) {
            mine = dyes;
            if (choices) {
                choices = await getJson("choices");
                drawForm();
            }
        },
        draw: comparison.draw,
    };
}

// A control with its label, and a line for what is wrong with its value.
export function fieldOf(label, control, wide) {
    const wrong = element("p", { class: "field-error", id: `${control.id}-wrong`, hidden: "" });
    const root = element("div", { class: wide ? "field wide" : "field" },
        element("label", { for: control.id, class: "note" }, label), control, ...(wide ? [wide] : []), wrong);
    return {
        root,
        say(line) {
            wrong.textContent = line;
            wrong.hidden = line === "";
            control.setAttribute("aria-invalid", String(line !== ""));
            control.setAttribute("aria-describedby", wrong.id);
        },
    };
}

// Words to type, with a button that copies them.
function commandLine(text) {
    const code = element("code", { tabindex: "0" }, text);
    const copy = element("button", { type: "button" }, "Copy");
    copy.addEventListener("click", async () => {
        try {
            await navigator.clipboard.writeText(code.textContent);
            copy.textContent = "Copied";
            setTimeout(() => { copy.textContent = "Copy"; }, 1500);
        } catch {
            // Without the right to copy, the words are selected for the user to do it.
            getSelection().selectAllChildren(code);
        }
    });
    return {
        root: element("div", { class: "command" }, code, copy),
        say(line) {
            code.textContent = line;
        },
    };
}

// What is compared: its name, and its value of a cube and of the color's answer.
const COMPARED = [
    ["ΔE00 of this color", (_, difference) => difference.toFixed(2)],
    ["mean ΔE00 of nodes", ({ summary }) => summary.mean_de2000.toFixed(3)],
    ["nodes above 1 ΔE00", ({ summary }) => percent(1 - summary.within_1 / summary.nodes)],
    ["nodes with dyes", ({ summary }) => percent(summary.fluorescent / summary.nodes)],
];

// The cube before beside the one that is shown.
function makeComparison(app) {
    const swatches = [element("td"), element("td")];
    const heads = [element("th", { scope: "col" }), element("th", { scope: "col" })];
    const cells = COMPARED.map(() => [element("td"), element("td")]);
    const swap = element("button", { type: "button" }, "Swap");
    swap.addEventListener("click", () => app.useCube(app.other));
    const forget = element("button", { type: "button" }, "Forget the one before");
    forget.addEventListener("click", () => app.forgetOther());
    const table = element("table", { class: "build-compared" },
        element("thead", {}, element("tr", {}, element("td"), ...heads)),
        element("tbody", {},
            element("tr", {}, element("th", { scope: "row" }, "its answer"), ...swatches),
            ...COMPARED.map(([name], k) =>
                element("tr", {}, element("th", { scope: "row" }, name), ...cells[k]))));
    const root = element("div", { class: "wide", hidden: "" }, table,
        element("div", { class: "build-buttons" }, swap, forget));
    return {
        root,
        draw(now) {
            root.hidden = !now.other;
            if (!now.other) {
                return;
            }
            const sides = [
                ["before", now.other, now.otherXyz, now.otherTarget],
                ["now", now.cube, now.xyz, now.target],
            ];
            sides.forEach(([word, cube, xyz, target], k) => {
                heads[k].title = cube.meta.name;
                const words = `${cube.meta.resolution}³, ${cube.meta.name}`;
                heads[k].replaceChildren(word, element("span", { class: "note" }, words));
                swatches[k].style.setProperty("background", cssColor(onScreen(xyz, cube.lights[0])));
                const difference = de2000(cube.labOf(target), cube.labOf(xyz));
                COMPARED.forEach(([, text], row) => {
                    cells[row][k].textContent = text(cube.meta, difference);
                });
            });
        },
    };
}
