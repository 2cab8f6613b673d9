// What the tests share: the program, a cube, a server, and a browser.
//
// UPGLOW names the program, CHROMIUM the browser; UPGLOW_PICTURES a folder for screenshots.

import assert from "node:assert/strict";
import { execFileSync, spawn } from "node:child_process";
import fs from "node:fs";
import os from "node:os";
import path from "node:path";

import { chromium } from "playwright-core";

const PROGRAM = process.env.UPGLOW;
export const FOLDER = fs.mkdtempSync(path.join(os.tmpdir(), "upglow-explorer-"));
export const CUBE = path.join(FOLDER, "cube.safetensors");
export const PAGE_FILE = path.join(FOLDER, "cube.html");
export const PICTURES = process.env.UPGLOW_PICTURES ?? FOLDER;

process.on("exit", () => fs.rmSync(FOLDER, { recursive: true, force: true }));

// Runs the program, and returns what it prints.
export function upglow(...words) {
    return execFileSync(PROGRAM, words, { encoding: "utf8", maxBuffer: 64 << 20, stdio: ["ignore", "pipe", "pipe"] });
}

// The default cube, as a file and as a page.
export function makeCube() {
    fs.mkdirSync(PICTURES, { recursive: true });
    upglow("build", "--output", CUBE, "--quiet");
    upglow("export", CUBE, PAGE_FILE);
}

// What the program says of a color of the cube.
export function colorOf(rgb, ...options) {
    return JSON.parse(upglow("color", CUBE, ...rgb.map(String), "--json", ...options));
}

// The explorer's server: its address, its process, and the time until it said so.
export async function serve(...words) {
    const start = performance.now();
    const server = spawn(PROGRAM, ["explore", ...words, "--no-open"], { stdio: ["ignore", "pipe", "pipe"] });
    let told = "";
    server.stderr.on("data", (text) => { told += text; });
    const address = await new Promise((resolve, reject) => {
        let text = "";
        server.stdout.on("data", (part) => {
            text += part;
            const found = text.match(/http:\/\/\S+/);
            if (found) {
                resolve(found[0]);
            }
        });
        server.on("exit", (status) => reject(new Error(`the server ended with ${status}: ${told}`)));
    });
    return { address, server, ms: performance.now() - start };
}

export async function stop({ server }) {
    const ended = new Promise((resolve) => server.on("exit", (status, signal) => resolve({ status, signal })));
    server.kill("SIGINT");
    return ended;
}

const FLAGS = [
    "--no-sandbox", "--disable-quic", "--no-first-run", "--disable-background-networking",
    "--disable-component-update", "--disable-sync",
];
// Chromium's own driver in software, so that machines without a graphics processor have WebGPU.
// Without the last two it computes, but loses its device when it shows a canvas.
const WEBGPU = [
    "--enable-unsafe-webgpu", "--use-webgpu-adapter=swiftshader", "--enable-features=Vulkan",
    "--use-vulkan=swiftshader", "--use-angle=swiftshader",
];
// Chromium's own words to a page that asks for WebGPU where there is none.
const NO_WEBGPU = "No available adapters.";

export function openBrowser({ webgpu = false } = {}) {
    const args = [...FLAGS, ...(webgpu ? WEBGPU : ["--disable-gpu"])];
    return chromium.launch({ executablePath: process.env.CHROMIUM ?? "/usr/bin/chromium", args });
}

// A page on which every message of the console, every error and every request is kept.
export async function openPage(browser, address, { width = 1440, height = 1000, scheme = "light", hash = "", bypassCSP = false } = {}) {
    const context = await browser.newContext({ viewport: { width, height }, colorScheme: scheme, bypassCSP });
    const page = await context.newPage();
    const told = [];
    const requests = [];
    page.on("console", (message) => {
        if (["error", "warning"].includes(message.type()) && message.text() !== NO_WEBGPU) {
            told.push(message.text());
        }
    });
    page.on("pageerror", (error) => told.push(String(error.stack)));
    page.on("request", (request) => requests.push(request.url()));
    await page.goto(address + hash);
    await page.waitForFunction(() => globalThis.explorer?.app.now?.cube.borders);
    await settled(page);
    return { page, told, requests, close: () => context.close() };
}

// Waits until what the state says is on the screen.
export async function settled(page) {
    await page.evaluate(() => new Promise((resolve) => {
        requestAnimationFrame(() => requestAnimationFrame(resolve));
    }));
}

// Picks a color, waits until it is drawn, and returns what the charts show of it.
export async function pick(page, changes) {
    await page.evaluate((given) => globalThis.explorer.set(given), changes);
    await settled(page);
    return page.evaluate(() => {
        const { sampled, xyz, target, cube } = globalThis.explorer.app.now;
        const plain = (values) => (values ? Array.from(values) : null);
        return {
            reflectance: plain(sampled.reflectance),
            passed: plain(sampled.passed),
            moved: plain(sampled.moved),
            irradiance: plain(cube.lights[0].irradiance),
            fluoresces: sampled.fluoresces,
            xyz: plain(xyz),
            target: plain(target),
        };
    });
}

export function median(values) {
    const sorted = [...values].sort((one, two) => one - two);
    return sorted[Math.floor(sorted.length / 2)];
}

export function assertClose(found, expected, tolerance, what) {
    assert.equal(found.length, expected.length, what);
    for (let i = 0; i < found.length; i += 1) {
        const off = Math.abs(found[i] - expected[i]);
        assert.ok(off <= tolerance, `${what} [${i}]: ${found[i]}, expected ${expected[i]}`);
    }
}
