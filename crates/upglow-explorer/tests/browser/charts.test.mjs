// The charts draw and save what the program says, and nothing moves while colors change.

import assert from "node:assert/strict";
import fs from "node:fs";
import { after, before, test } from "node:test";
import { pathToFileURL } from "node:url";

import { PAGE_FILE, assertClose, colorOf, makeCube, openBrowser, openPage, pick, settled } from "./setup.mjs";

const GLOWING = { space: "ACEScg", value: [0.9, 0.1, 0.4], light: "D65", uv: 1 };
// Single precision of the cube's tables.
const SINGLE = 1e-6;
// Light of ordinary daylight is averaged over 5 nm to draw it, and weighted at every fifth nanometer to sum.
const BANDS = 1e-3;

let browser;

before(async () => {
    makeCube();
    browser = await openBrowser();
});

after(() => browser?.close());

const open = (options) => openPage(browser, pathToFileURL(PAGE_FILE).href, options);

// The content of the file that a button of the spectra saves.
async function saved(page, button) {
    const [file] = await Promise.all([
        page.waitForEvent("download"),
        page.locator("#spectra .head").getByText(button, { exact: true }).click(),
    ]);
    return fs.readFileSync(await file.path(), "utf8");
}

// Columns of a CSV, by name; no name in these tests has a comma.
function columnsOf(csv) {
    const [names, ...rows] = csv.trimEnd().split("\n").map((line) => line.split(","));
    const column = (k) => rows.map((row) => (row[k] === "" ? NaN : Number(row[k])));
    return Object.fromEntries(names.map((name, k) => [name.replaceAll('"', ""), column(k)]));
}

test("the CSV holds the program's spectra, and a radiance factor that is seen as the color", async () => {
    const { page, told, close } = await open();
    await pick(page, GLOWING);
    const columns = columnsOf(await saved(page, "CSV"));
    const { curves, xyz } = colorOf(GLOWING.value);
    assertClose(columns.wavelength_nm, Array.from({ length: 531 }, (_, i) => 300 + i), 0, "wavelengths");
    assertClose(columns.reflectance, curves.reflectance, SINGLE, "reflectance");
    const absorbed = Object.keys(columns).filter((name) => name.startsWith("absorbed by "));
    const all = columns.wavelength_nm.map((_, i) => absorbed.reduce((sum, name) => sum + columns[name][i], 0));
    assertClose(all, curves.absorption, SINGLE, "absorbed by all dyes");
    const matching = await page.evaluate(() => Array.from(globalThis.explorer.app.now.cube.matching));
    const { light } = columns;
    const band = (i) => light.slice(Math.max(i - 2, 0), i + 3).reduce((sum, v, _, { length }) => sum + v / length, 0);
    const seen = [0, 1, 2].map((k) => {
        let [sum, white] = [0, 0];
        for (let o = 0; o < 107; o += 1) {
            const total = columns.total_radiance_factor[5 * o];
            sum += (total || 0) * band(5 * o) * matching[3 * o + k];
            white += band(5 * o) * matching[3 * o + 1];
        }
        return sum / white;
    });
    assertClose(seen, xyz, BANDS, "the radiance factor as a color");
    assert.ok(Math.max(...columns.total_radiance_factor.filter((v) => v === v)) > 1);
    assert.deepEqual(told, []);
    await close();
});

test("a line that was switched off stays off, and is in no file", async () => {
    const { page, close } = await open();
    await pick(page, GLOWING);
    const button = page.locator("#spectra .keys button", { hasText: "Reflectance" });
    assert.equal(await button.getAttribute("aria-pressed"), "true");
    await button.click();
    await pick(page, { uv: 0.5 });
    assert.equal(await button.getAttribute("aria-pressed"), "false");
    const columns = columnsOf(await saved(page, "CSV"));
    assert.ok("total_radiance_factor" in columns && !("reflectance" in columns));
    await close();
});

test("the SVG is a drawing by itself, in light colors also from a dark page", async () => {
    const { page, close } = await open({ scheme: "dark" });
    await pick(page, GLOWING);
    const svg = await saved(page, "SVG");
    assert.ok(!/class=|style=|var\(|light-dark|lch\(|NaN/.test(svg), svg.match(/class=|style=|var\(|NaN/)?.[0]);
    const told = await page.evaluate((text) => {
        const drawing = new DOMParser().parseFromString(text, "image/svg+xml");
        return [drawing.querySelector("parsererror")?.textContent ?? "", drawing.documentElement.textContent];
    }, svg);
    assert.equal(told[0], "");
    assert.match(told[1], /total radiance factor/);
    assert.match(svg, /fill="#1c1c1c"/);
    await close();
});

test("arrow keys read the spectra and the map", async () => {
    const { page, close } = await open();
    await pick(page, GLOWING);
    const chart = page.locator("#spectra .chart");
    await chart.focus();
    await page.keyboard.press("Home");
    await page.keyboard.press("Shift+ArrowRight");
    assert.equal(await chart.getAttribute("aria-valuenow"), "310");
    const reflectance = await page.evaluate(() => globalThis.explorer.app.now.sampled.reflectance[10].toFixed(3));
    assert.ok((await chart.getAttribute("aria-valuetext")).includes(`reflectance ${reflectance}`));
    await page.locator("#heat .map").focus();
    await page.keyboard.press("Shift+ArrowUp");
    assert.match(await page.locator("#heat [aria-live]").textContent(), /^Of light at \d+ nm: [\d.]+\s% comes back/);
    await close();
});

test("no part of the charts changes its size with the color, the light or the ultraviolet", async () => {
    for (const width of [1440, 390]) {
        const { page, told, close } = await open({ width });
        const found = await page.evaluate(async () => {
            const { app, set } = globalThis.explorer;
            const parts = [...document.querySelectorAll("#spectra > *, #heat .heat-views > * > *")];
            const sizes = new Set();
            const damaged = new Set();
            for (let k = 0; k < 60; k += 1) {
                const value = [(k % 7) / 6, (k % 5) / 4, (k % 11) / 10];
                set({ space: "ACEScg", value, light: app.cube.lights[k % 12].name, uv: [1, 2, 0, "only"][k % 4] });
                await new Promise((next) => { requestAnimationFrame(() => requestAnimationFrame(next)); });
                sizes.add(parts.map((part) => Math.round(part.getBoundingClientRect().height)).join());
                for (const path of document.querySelectorAll("#spectra path, #heat path")) {
                    if (/NaN|undefined|Infinity/.test(path.getAttribute("d"))) {
                        damaged.add(path.getAttribute("class"));
                    }
                }
                for (const text of document.querySelectorAll("#spectra .chart text, #heat svg text")) {
                    const [inner, outer] = [text, text.ownerSVGElement].map((node) => node.getBoundingClientRect());
                    if (inner.left < outer.left - 1 || inner.right > outer.right + 1) {
                        damaged.add(`clipped: ${text.textContent}`);
                    }
                }
            }
            return { sizes: [...sizes], damaged: [...damaged] };
        });
        assert.equal(found.sizes.length, 1, found.sizes.join("\n"));
        assert.deepEqual(found.damaged, []);
        assert.deepEqual(told, []);
        await settled(page);
        await close();
    }
});
