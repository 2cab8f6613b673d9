// Why a color has its material; other cubes are built, and files opened, while the page stays in use.

import assert from "node:assert/strict";
import fs from "node:fs";
import path from "node:path";
import { after, before, test } from "node:test";
import { pathToFileURL } from "node:url";
import { crc32, deflateSync } from "node:zlib";

import { CUBE, FOLDER, PAGE_FILE, colorOf, makeCube, openBrowser, openPage, pick, serve, settled, stop, upglow } from "./setup.mjs";

// Half of the last decimal that the page prints.
const PRINTED = 0.005;
// Fields and addresses have five decimals.
const FIELDS = 1e-5;

let browser;
let served;
const offline = () => pathToFileURL(PAGE_FILE).href;

before(async () => {
    makeCube();
    browser = await openBrowser();
    served = await serve(CUBE);
});

after(async () => {
    await browser?.close();
    if (served) {
        await stop(served);
    }
});

const textOf = (page, selector) => page.evaluate((which) => document.querySelector(which).textContent, selector);

// Picks a color, and waits for what the program says of it.
async function explain(page, value) {
    await pick(page, { space: "ACEScg", value });
    await page.waitForTimeout(200);
    await page.waitForFunction(() => !document.getElementById("why").classList.contains("is-old"));
    return textOf(page, ".why-sentence");
}

// The ΔE00 in the row of this name.
function distanceTo(page, name) {
    return page.evaluate((which) => {
        const row = [...document.querySelectorAll(".why-table tbody tr")]
            .find((each) => each.querySelector("th").textContent.startsWith(which));
        return Number(row.querySelector(".why-number").textContent);
    }, name);
}

test("the standing is that of the program, and the way to the border ends at it", async () => {
    const { page, told, close } = await openPage(browser, served.address);
    for (const rgb of [[0.5, 0.4, 0.3], [0.02, 0.9, 0.1], [0, 1, 0], [0.9, 0, 0.9]]) {
        const sentence = await explain(page, rgb);
        const { kind, reflectance_de2000: away, reflectance_distance_xyz: distance } = colorOf(rgb).standing;
        const start = { reflectance: "A reflectance", needs_fluorescence: "No reflectance", unreachable: "No material" }[kind];
        assert.ok(sentence.startsWith(start), sentence);
        if (kind === "needs_fluorescence") {
            assert.ok(sentence.includes(`${distance.toFixed(4)} away, ΔE00 ${away.toFixed(2)}`), sentence);
            const before_ = page.url();
            await page.click("[aria-label='Go to the nearest any reflectance']");
            await page.waitForTimeout(300);
            await page.waitForFunction(() => !document.getElementById("why").classList.contains("is-old"));
            assert.notEqual(page.url(), before_);
            assert.match(await textOf(page, ".why-sentence"), /^A reflectance/);
        }
    }
    assert.deepEqual(told, []);
    await close();
});

test("no color of the cube is nearer than the nearest that is told", async () => {
    for (const address of [served.address, offline()]) {
        const { page, close } = await openPage(browser, address);
        for (const rgb of [[1.3, 0.2, 0.1], [-0.1, 0.9, 0.1], [0, 1, 0], [1.2, 1.1, 0.1]]) {
            await pick(page, { space: "ACEScg", value: rgb });
            const nearest = await distanceTo(page, "color of this cube");
            // Colors of the cube at each 16th of its sides.
            const others = await page.evaluate((target) => {
                const { app: { cube }, de2000 } = globalThis.explorer;
                const steps = Array.from({ length: 17 }, (_, k) => k / 16);
                const colors = steps.flatMap((r) => steps.flatMap((g) => steps.map((b) => cube.colorOf([r, g, b]))));
                const asked = cube.labOf(cube.xyzOf(target));
                return Math.min(...colors.map((xyz) => de2000(asked, cube.labOf(xyz))));
            }, rgb);
            assert.ok(nearest <= others + PRINTED, `${rgb}: ${nearest}, and another ${others}`);
        }
        await close();
    }
});

test("a color brighter than the cube has the material fitted to it", async () => {
    const { page, told, close } = await openPage(browser, served.address);
    await explain(page, [1.5, 1.2, 0.2]);
    const { title, missed } = await page.evaluate(() => {
        const { app, de2000 } = globalThis.explorer;
        return {
            title: app.now.shown?.title,
            missed: de2000(app.cube.labOf(app.now.target), app.cube.labOf(app.now.xyz)),
        };
    });
    assert.equal(title, "direct fit");
    assert.ok(missed < 0.1, `ΔE00 ${missed}`);
    assert.match(await textOf(page, ".why-note"), /direct fit/);
    await explain(page, [0.5, 0.4, 0.3]);
    assert.equal(await page.evaluate(() => globalThis.explorer.app.now.shown), null);
    assert.deepEqual(told, []);
    await close();
});

const built = (page) => page.waitForFunction(() => document.querySelector(".build-status").textContent.startsWith("Built"));

test("a cube is built as the program builds it, beside the one before", async () => {
    const { page, told, close } = await openPage(browser, served.address, { hash: "#color=ACEScg,0.9,0.1,0.4" });
    await page.click("#open-build");
    await page.selectOption("#build--preset", "konig2020");
    await page.fill("#build--slope-max-per-nm", "0.02");
    await page.click(".build-sizes button:text-is('17')");
    await page.click("#build button[type=submit]");
    await built(page);
    await settled(page);
    const { summary, other } = await page.evaluate(() => {
        const { cube, other: before_ } = globalThis.explorer.app;
        return { summary: cube.meta.summary, other: before_.meta.summary.nodes };
    });
    assert.equal(other, 32 ** 3);
    const line = await textOf(page, ".command code");
    const file = path.join(FOLDER, "again.safetensors");
    upglow(...line.split(" ").slice(1).map((word) => (word === "cube.safetensors" ? file : word)), "--quiet");
    const found = JSON.parse(upglow("inspect", file, "--json")).summary;
    assert.equal(summary.mean_de2000, found.mean_de2000);
    assert.equal(summary.fluorescent, found.fluorescent);
    await page.click("text=Swap");
    await settled(page);
    assert.equal(await page.evaluate(() => globalThis.explorer.app.cube.meta.resolution), 32);
    assert.deepEqual(told, []);
    await close();
});

test("the page is in use while a cube is built, and a build can be stopped", async () => {
    const { page, close } = await openPage(browser, served.address);
    await page.click("#open-build");
    await page.click(".build-sizes button:text-is('64')");
    await page.click("#build button[type=submit]");
    await page.waitForFunction(() => /fitting/.test(document.querySelector(".build-status").textContent));
    await explain(page, [0.3, 0.5, 0.2]);
    const { target } = await pick(page, { space: "XYZ", value: [0.3, 0.2, 0.1] });
    assert.deepEqual(target, [0.3, 0.2, 0.1]);
    await page.click("#build >> text=Stop");
    await page.waitForFunction(() => document.querySelector(".build-status").textContent === "Stopped.");
    await page.keyboard.press("Escape");
    assert.equal(await page.evaluate(() => document.getElementById("build").open), false);
    await close();
});

test("a refusal stands at the field it names", async () => {
    const { page, close } = await openPage(browser, served.address);
    await page.click("#open-build");
    await page.fill("#build--slope-max-per-nm", "9");
    await page.click("#build button[type=submit]");
    await page.waitForSelector("#build--slope-max-per-nm[aria-invalid=true]");
    assert.match(await textOf(page, "#build--slope-max-per-nm-wrong"), /^slope limit 9\/nm, expected/);
    await close();
});

// An sRGB PNG of one color per texel, [row][column].
function png(rows) {
    const chunk = (type, data) => {
        const text = Buffer.concat([Buffer.from(type), data]);
        const [length, check] = [data.length, crc32(text)].map((v) => {
            const bytes = Buffer.alloc(4);
            bytes.writeUInt32BE(v);
            return bytes;
        });
        return Buffer.concat([length, text, check]);
    };
    const head = Buffer.alloc(13);
    head.writeUInt32BE(rows[0].length, 0);
    head.writeUInt32BE(rows.length, 4);
    head.set([8, 2], 8);
    const texels = Buffer.from(rows.flatMap((row) => [0, ...row.flat()]));
    const start = Buffer.from([0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a]);
    const parts = [["IHDR", head], ["sRGB", Buffer.from([0])], ["IDAT", deflateSync(texels)], ["IEND", Buffer.alloc(0)]];
    return Buffer.concat([start, ...parts.map(([type, data]) => chunk(type, data))]);
}

const RED = [200, 30, 60];
const GRAY = [119, 119, 119];

test("a picture is shown beside what the cube makes of it, and a texel is the color", async () => {
    const file = path.join(FOLDER, "two.png");
    fs.writeFileSync(file, png([[RED, GRAY], [GRAY, GRAY]]));
    for (const address of [served.address, offline()]) {
        const { page, told, close } = await openPage(browser, address);
        await page.setInputFiles("#drop-file", file);
        await page.waitForFunction(() => /use dyes/.test(document.querySelector(".shares")?.textContent));
        assert.match(await textOf(page, ".shares"), /^0\.0\s% of the texels miss .*; 0\.0\s% use dyes\.$/);
        await page.focus(".texels");
        await page.keyboard.press("Shift+ArrowUp");
        await page.keyboard.press("Shift+ArrowLeft");
        await settled(page);
        const [first] = await page.evaluate((coded) => {
            const { app } = globalThis.explorer;
            const space = app.spaces.find(({ name }) => name === "sRGB coded");
            const found = space.from(app.now.target).map((v) => 255 * v);
            return [Math.max(...found.map((v, k) => Math.abs(v - coded[k])))];
        }, RED);
        // The steepest part of the sRGB curve.
        assert.ok(first < 13 * 255 * FIELDS, `${first}`);
        assert.deepEqual(told, []);
        await close();
    }
});

const opened = (page) => page.waitForFunction(() => {
    const line = document.querySelector(".drop-status").textContent;
    return line !== "" && !line.startsWith("Reading");
});

test("a light is chosen, a dye can be built with, and a pixel shows its spectrum", async () => {
    const { page, told, close } = await openPage(browser, served.address);
    const lines = (row) => Array.from({ length: 107 }, (_, i) => row(300 + 5 * i)).join("\n");
    const bell = (nm, peak) => Math.exp(-(((nm - peak) / 30) ** 2)).toFixed(6);
    const light = path.join(FOLDER, "my lamp.csv");
    fs.writeFileSync(light, `wavelength_nm,power\n${lines((nm) => `${nm},${bell(nm, 600)}`)}\n`);
    await page.setInputFiles("#drop-file", light);
    await opened(page);
    assert.equal(await page.evaluate(() => globalThis.explorer.app.now.light.name), "my lamp");

    const dye = path.join(FOLDER, "mine.csv");
    const row = (nm) => `${nm},${bell(nm, 450)},${bell(nm, 520)}`;
    fs.writeFileSync(dye, `wavelength_nm,absorption,emission\n${lines(row)}\n`);
    await page.setInputFiles("#drop-file", dye);
    await page.waitForFunction(() => document.querySelector(".drop-status").textContent.startsWith("The dye mine"));
    await page.click("#open-build");
    await page.selectOption("#build--dyes", "dropped");
    await page.selectOption("#build--illuminant", "D65");
    await page.click(".build-sizes button:text-is('17')");
    await page.click("#build button[type=submit]");
    await built(page);
    await page.waitForFunction(() => globalThis.explorer.app.cube.meta.dyes.join() === "mine");
    // The light of the file is seen by the new cube, too.
    await page.waitForFunction(() => globalThis.explorer.app.now.light.name === "my lamp");

    const [picture, spectra] = ["one.png", "one.exr"].map((name) => path.join(FOLDER, name));
    fs.writeFileSync(picture, png([[RED]]));
    upglow("bake", CUBE, picture, "--output", spectra, "--as", "spectral", "--quiet");
    await page.setInputFiles("#drop-file", spectra);
    await page.waitForFunction(() => document.querySelector(".drop-status").textContent.startsWith("one.exr, 1 × 1"));
    await page.focus(".texels");
    await page.keyboard.press("Enter");
    await page.waitForFunction(() => globalThis.explorer.app.now.shown?.title === "one.exr at 0,0");
    const { sampled } = await page.evaluate(() => {
        const { now } = globalThis.explorer.app;
        return { sampled: Array.from(now.sampled.reflectance) };
    });
    assert.ok(sampled[350] > 0.3 && sampled[250] < 0.1, `${sampled[350]} at 650 nm, ${sampled[250]} at 550 nm`);
    assert.deepEqual(told, []);
    await close();
});

test("a file that is no picture is refused in one line", async () => {
    const file = path.join(FOLDER, "damaged.png");
    fs.writeFileSync(file, png([[RED]]).subarray(0, 40));
    for (const address of [served.address, offline()]) {
        const { page, close } = await openPage(browser, address);
        await page.setInputFiles("#drop-file", file);
        await page.waitForFunction(() => /^damaged\.png: ./.test(document.querySelector(".drop-status").textContent));
        assert.equal(await page.locator(".texels").count(), 0);
        await close();
    }
});
