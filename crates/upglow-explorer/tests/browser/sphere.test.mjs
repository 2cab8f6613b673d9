// The spheres: WebGPU with the exported WGSL computes what the page does, which draws on without it.

import assert from "node:assert/strict";
import { after, before, test } from "node:test";
import { pathToFileURL } from "node:url";

import { PAGE_FILE, assertClose, makeCube, openBrowser, openPage, pick, settled } from "./setup.mjs";

// The shader's single precision, over the greatest of X, Y and Z.
const SINGLE = 1e-6;

let browser;

before(async () => {
    makeCube();
    browser = await openBrowser({ webgpu: true });
});

after(() => browser?.close());

const open = () => openPage(browser, pathToFileURL(PAGE_FILE).href, { height: 1600 });

// What the shader computed of what is shown.
async function computed(page) {
    await page.waitForFunction(() => globalThis.explorer.app.sphere.gpuXyz());
    return page.evaluate(() => globalThis.explorer.app.sphere.gpuXyz());
}

const note = (page) => page.locator("#sphere > .note").textContent();

test("the shader's colors are those of the page", async () => {
    const { page, told, close } = await open();
    await computed(page);
    for (const value of [[0.9, 0.1, 0.4], [0.5, 0.4, 0.3], [0.3, 0.95, 0.2], [0.9, 0, 0.9], [1, 1, 1]]) {
        for (const changes of [{ light: "D65", uv: 1 }, { light: "A", uv: 0 }, { light: "FL11", uv: 2 }]) {
            await pick(page, { space: "ACEScg", value, ...changes });
            const found = await computed(page);
            const expected = await page.evaluate(() => globalThis.explorer.colorsUnderLights());
            const total = expected[changes.light];
            assertClose(found.slice(0, 3), total, SINGLE * Math.max(...total), `${value} under ${changes.light}`);
        }
    }
    assert.match(await note(page), /WGSL/);
    assert.deepEqual(told, []);
    await close();
});

test("without its device the page draws on", async () => {
    const { page, close } = await openLost();
    await pick(page, { space: "ACEScg", value: [0.3, 0.95, 0.2] });
    await page.waitForFunction(() => document.querySelector("#sphere > .note").textContent.includes("without WebGPU"));
    assert.equal(await page.evaluate(() => globalThis.explorer.app.sphere.gpuXyz()), null);
    const drawn = await page.evaluate(() => {
        const canvas = document.querySelector("#sphere canvas");
        const { data } = canvas.getContext("2d").getImageData(canvas.width / 4, canvas.height / 2, 1, 1);
        return [...data];
    });
    assert.equal(drawn[3], 255);
    assert.ok(drawn[1] > drawn[0] && drawn[1] > drawn[2], String(drawn));
    await close();
});

// A page whose device was taken away after it had drawn.
async function openLost() {
    const opened = await open();
    const { page } = opened;
    await computed(page);
    // The page keeps its device to itself, so it is caught on the way there when the page loads again.
    await page.addInitScript(() => {
        const request = GPUAdapter.prototype.requestDevice;
        GPUAdapter.prototype.requestDevice = async function kept(...words) {
            globalThis.device = await request.apply(this, words);
            return globalThis.device;
        };
    });
    await page.reload();
    await page.waitForFunction(() => globalThis.explorer?.app.sphere);
    await settled(page);
    await computed(page);
    await page.evaluate(() => globalThis.device.destroy());
    return opened;
}
