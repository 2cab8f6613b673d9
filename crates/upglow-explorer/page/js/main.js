// Loads the cube, and redraws every view when the state changes.

import { SCREEN_NAME, de2000 } from "./color.js";
import { readAddress, set, state, watch } from "./state.js";
import { getBytes, getText, served } from "./server.js";
import { Cube, relit } from "./cube.js";
import { fieldSpaces, makePicker } from "./picker.js";
import { makeSpectra } from "./spectra.js";
import { makeHeat } from "./heat.js";
import { makeWhy } from "./why.js";
import { makeRelight } from "./relight.js";
import { makeSphere } from "./sphere.js";
import { makeTools } from "./tools.js";

const byId = (id) => document.getElementById(id);

function bytesOf(id) {
    return Uint8Array.from(atob(byId(id).textContent), (letter) => letter.charCodeAt(0)).buffer;
}

// The cube inside the page.
function embeddedCube() {
    const wgsl = new TextDecoder().decode(bytesOf("cube-shader"));
    const cube = new Cube(0, bytesOf("cube-arrays"), upglow, wgsl);
    cube.setBorders(bytesOf("cube-borders"));
    return cube;
}

// A cube of the program; its borders come later.
async function servedCube(id) {
    const here = new URL(`cube/${id}`, document.baseURI).href;
    const [arrays, module, wgsl] =
        await Promise.all([getBytes(`${here}.data`), import(`${here}.js`), getText(`${here}.wgsl`)]);
    return new Cube(id, arrays, module.upglow, wgsl);
}

const app = {
    now: null,
    spaces: [],
    cube: null,
    // Another cube, to compare with.
    other: null,
    // A material that is shown instead of the cube's own for the color: { sampled, title }.
    shown: null,
    spaceNow: () => app.spaces.find(({ name }) => name === state.space),
    lightNow: () => app.cube.lights.find(({ name }) => name === state.light) ?? app.cube.lights[0],
    // Shows another cube, beside the one before. The numbers of the color stay: under another light they
    // mean the same to the space, but not as XYZ.
    useCube(cube, other = app.cube) {
        if (state.light === app.cube?.lights[0].name) {
            // The light of the contract stays that of the contract.
            state.light = cube.lights[0].name;
        }
        app.other = other;
        app.cube = cube;
        app.spaces = fieldSpaces(cube);
        app.shown = null;
        byId("facts").textContent = facts(cube.meta);
        if (!app.spaceNow()) {
            // The space of the cube before, which no other has.
            state.space = app.spaces[0].name;
            state.value = app.spaces[0].from(app.now.target);
        }
        set({});
        if (!cube.borders) {
            getBytes(`cube/${cube.id}.borders`).then((buffer) => {
                cube.setBorders(buffer);
                redraw();
            }, (error) => app.say(error.message));
        }
    },
    // Shows a cube of the program. What is compared with it may stay.
    async openCube(id, isOtherKept) {
        const cube = await servedCube(id);
        app.useCube(cube, (isOtherKept && app.other) || app.cube);
    },
    forgetOther() {
        app.other = null;
        redraw();
    },
    // Picks a color.
    goTo(xyz) {
        set({ value: app.spaceNow().from(xyz).map((v) => Number(v.toFixed(5))) });
    },
    // Shows a material that is none of the cube's, until a color is picked.
    show(shown) {
        app.shown = shown;
        redraw();
    },
    // A line at the bottom of the page.
    say(line) {
        byId("message").textContent = line;
        byId("message").hidden = line === "";
    },
};

function facts({ name, spaces, lights, resolution, model, dyes, summary }) {
    const kind = dyes.length > 0 ? `${model} of ${dyes.length} dyes` : model;
    const missed = summary.nodes - summary.within_1;
    const share = ((100 * missed) / summary.nodes).toFixed(missed > 0 ? 1 : 0);
    return `${name}: ${spaces[0].name} under ${lights[0].name}, ${resolution}³ nodes, ${kind}; ${share} % miss their color by more than 1 ΔE00`;
}

// All that the views show of the state.
function compute() {
    const { cube } = app;
    const target = app.spaceNow().to(state.value);
    // Numbers in the cube's own space stay exact, so that grays are.
    const rgb = app.spaceNow() === app.spaces[0] ? state.value : cube.rgbOf(target);
    // Numbers of the fields have five decimals: corners of the cube are not outside by rounding.
    const inside = rgb.map((v) => Math.min(Math.max(v, 0), 1));
    const isOutside = rgb.some((v, k) => Math.abs(v - inside[k]) > 2e-5);
    const key = [cube.id, ...inside].join();
    if (app.now?.key !== key) {
        app.sampled = cube.sample(cube.lookUp(inside), "looked up");
    }
    const asked = [state.space, ...state.value].join();
    if (app.before?.asked !== asked || app.before.cube !== app.other) {
        app.before = before(asked);
    }
    const light = app.lightNow();
    const sampled = app.shown?.sampled ?? app.sampled;
    const below = cube.meta.ultraviolet_below_nm;
    return {
        key, cube, target, rgb, inside, sampled, light, below,
        outside: isOutside ? "outside the cube" : "",
        xyz: app.shown ? relit(sampled, cube.lights[0], 1, below) : cube.colorOf(inside),
        shown: app.shown,
        other: app.other,
        otherSampled: app.before?.sampled,
        otherXyz: app.before?.xyz,
        otherTarget: app.before?.target,
    };
}

// The answer of the cube to compare with to the same numbers; null without one.
function before(asked) {
    const cube = app.other;
    if (!cube) {
        return null;
    }
    const space = fieldSpaces(cube).find(({ name }) => name === state.space);
    const target = space ? space.to(state.value) : app.spaceNow().to(state.value);
    const inside = cube.rgbOf(target).map((v) => Math.min(Math.max(v, 0), 1));
    const sampled = cube.sample(cube.lookUp(inside), "before");
    return { asked, cube, target, sampled, xyz: cube.colorOf(inside) };
}

let views = [];
let isAsked = false;

// Draws once before the next frame, however often it is asked for.
function redraw() {
    if (!isAsked) {
        isAsked = true;
        requestAnimationFrame(() => {
            isAsked = false;
            const start = performance.now();
            app.now = compute();
            views.forEach((view) => view.draw(app.now));
            performance.measure("redraw", { start });
        });
    }
}

function takeAddress() {
    const names = app.cube.lights.map(({ name }) => name);
    return readAddress(app.spaces.map(({ name }) => name), names);
}

async function start() {
    const cube = served ? await servedCube(0) : embeddedCube();
    app.cube = cube;
    app.spaces = fieldSpaces(cube);
    Object.assign(state, { space: app.spaces[0].name, light: cube.lights[0].name }, takeAddress());
    app.now = compute();
    views = [
        makePicker(byId("picker"), app),
        makeSpectra(byId("spectra"), app),
        makeHeat(byId("heat"), app),
        makeWhy(byId("why"), app),
        makeRelight(byId("relight"), app),
        makeSphere(byId("sphere"), app),
        makeTools(app),
    ];
    let value = String(state.value);
    watch(() => {
        // A picked color takes the place of a material that was shown.
        if (value !== String(state.value)) {
            value = String(state.value);
            app.shown = null;
        }
        redraw();
    });
    addEventListener("hashchange", () => set(takeAddress()));
    byId("open-help").addEventListener("click", () => byId("help").showModal());
    app.useCube(cube, null);
    document.documentElement.dataset.screen = SCREEN_NAME;
}

start().catch((error) => {
    app.say(error.message);
    throw error;
});
// For the console, and for tests.
globalThis.explorer = {
    app, de2000, set, state,
    // XYZ of the material under each light, as the slider of ultraviolet leaves it.
    colorsUnderLights() {
        const { cube, sampled, below } = compute();
        return Object.fromEntries(cube.lights.map((light) =>
            [light.name, relit(sampled, light, state.uv, below)]));
    },
};
