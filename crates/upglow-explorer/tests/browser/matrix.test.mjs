// A sphere in an engine without spectra: WebGPU shades it by the exported 4×4 matrices, beside the page's spectra.

import assert from "node:assert/strict";
import fs from "node:fs";
import path from "node:path";
import { after, before, test } from "node:test";
import { pathToFileURL } from "node:url";

import { CUBE, FOLDER, PAGE_FILE, colorOf, makeCube, openBrowser, openPage, upglow } from "./setup.mjs";

// Of the engine, and of the cube.
const SPACE = "acescg";
const LIGHTS = ["D65", "A", "365 nm lamp"];
// CIEDE2000: a mean over the sphere and the lights; and under daylight, where matrices are exact, at any point: what dyes
// emit is up to 2e-4 more by the page's sums than by the library's.
const DIFFERENCE = 1;
const EXACT = 0.01;
// Of the angle to the eye and to the lamp. Nearer to the rim, single precision of the normal is seen.
const LEAST_COSINE = 0.05;
// Of the difference by red, green and blue alone.
const NEARER = 0.5;

// Pixels along a side of the picture.
const SIZE = 128;
// Eight rows of patches from pale colors to the edge of the space, with eight hues each.
const PATCHES = Array.from({ length: 64 }, (_, k) => {
    const [hue, pale] = [(k % 8) / 8, 0.8 * (1 - Math.floor(k / 8) / 7)];
    const pure = [1 - 6 * Math.abs(hue - 0.5), 6 * Math.abs(hue - 1 / 3), 6 * Math.abs(hue - 2 / 3)];
    return pure.map((v, channel) => Math.max(0.9 * Math.min(Math.max(channel ? 2 - v : -v, 0), 1), pale));
});

// Appended to the exported text. A pixel is what leaves, and the number of its patch, or −1 beside the sphere.
const SPHERE_WGSL = `
struct Scene {
    light: vec4f,
    lamp: vec4f,
    patches: array<vec4f, ${PATCHES.length}>,
}

@group(1) @binding(0) var<uniform> scene: Scene;

@vertex
fn corner(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {
    return vec4f(select(-1.0, 3.0, i == 1), select(-1.0, 3.0, i == 2), 0, 1);
}

@fragment
fn shade(@builtin(position) place: vec4f) -> @location(0) vec4f {
    let at = (2 * place.xy / ${SIZE} - 1) * vec2f(1, -1);
    if (length(at) >= 1) {
        return vec4f(0, 0, 0, -1);
    }
    let normal = vec3f(at, sqrt(1 - dot(at, at)));
    // Eight rows from pole to pole, eight columns over the half that is seen.
    let turn = acos(clamp(at / vec2f(sqrt(1 - at.y * at.y), 1), vec2f(-1), vec2f(1))) / 3.14159265;
    let patch_number = 8 * min(u32(8 * turn.y), 7) + min(u32(8 * turn.x), 7);
    let arriving = scene.light * max(dot(normal, scene.lamp.xyz), 0);
    let m = upglow_matrix(scene.patches[patch_number].rgb);
    let leaves = upglow_relit(m, UpglowLight(arriving.x, arriving.y, arriving.z, arriving.w));
    return vec4f(leaves.red, leaves.green, leaves.blue, f32(patch_number));
}
`;

let browser;

before(async () => {
    makeCube();
    upglow("export", CUBE, path.join(FOLDER, "matrices.wgsl"), "--engine", SPACE);
    browser = await openBrowser({ webgpu: true });
});

after(() => browser?.close());

// What leaves each pixel, `[row][column][R, G, B, patch]`, under a light of four numbers.
function shaded({ code, textures, size, light, lamp, patches }) {
    const bytes = Uint8Array.from(atob(textures), (letter) => letter.charCodeAt(0)).buffer;
    // The head of the file says where the texels begin, and their columns and rows.
    const [texels, width, height] = [64, ...new Uint32Array(bytes, 16, 2)];
    const read = async () => {
        const adapter = await navigator.gpu.requestAdapter();
        const device = await adapter.requestDevice();
        const nodes = device.createTexture({
            size: [width, height], format: "rgba32float", usage: GPUTextureUsage.TEXTURE_BINDING | GPUTextureUsage.COPY_DST,
        });
        device.queue.writeTexture({ texture: nodes }, bytes, { offset: texels, bytesPerRow: 16 * width }, [width, height]);
        const scene = new Float32Array([...light, ...lamp, 0, ...patches.flatMap((rgb) => [...rgb, 0])]);
        const uniform = device.createBuffer({ size: scene.byteLength, usage: GPUBufferUsage.UNIFORM | GPUBufferUsage.COPY_DST });
        device.queue.writeBuffer(uniform, 0, scene);
        const target = device.createTexture({
            size: [size, size], format: "rgba32float", usage: GPUTextureUsage.RENDER_ATTACHMENT | GPUTextureUsage.COPY_SRC,
        });
        const answer = device.createBuffer({ size: 16 * size * size, usage: GPUBufferUsage.MAP_READ | GPUBufferUsage.COPY_DST });
        const module = device.createShaderModule({ code });
        const layout = (entry) => device.createBindGroupLayout({ entries: [{ binding: 0, visibility: GPUShaderStage.FRAGMENT, ...entry }] });
        const layouts = [layout({ texture: { sampleType: "unfilterable-float" } }), layout({ buffer: {} })];
        const pipeline = await device.createRenderPipelineAsync({
            layout: device.createPipelineLayout({ bindGroupLayouts: layouts }),
            vertex: { module },
            fragment: { module, targets: [{ format: "rgba32float" }] },
        });
        const encoder = device.createCommandEncoder();
        const pass = encoder.beginRenderPass({ colorAttachments: [{ view: target.createView(), loadOp: "clear", storeOp: "store" }] });
        pass.setPipeline(pipeline);
        [nodes.createView(), { buffer: uniform }].forEach((resource, k) =>
            pass.setBindGroup(k, device.createBindGroup({ layout: layouts[k], entries: [{ binding: 0, resource }] })));
        pass.draw(3);
        pass.end();
        encoder.copyTextureToBuffer({ texture: target }, { buffer: answer, bytesPerRow: 16 * size }, [size, size]);
        device.queue.submit([encoder.finish()]);
        await answer.mapAsync(GPUMapMode.READ);
        const pixels = [...new Float32Array(answer.getMappedRange())];
        device.destroy();
        return pixels;
    };
    return read();
}

const mean = (values) => values.reduce((sum, v) => sum + v, 0) / values.length;

// CIEDE2000 of pairs of X, Y, Z under a light, whose white is that of the eye if it can be seen by.
function differences({ pairs, name }) {
    const { app, de2000 } = globalThis.explorer;
    const { cube } = app.now;
    const light = cube.lights.find((one) => one.name === name);
    const own = cube.lights[0].white;
    const white = light.is_adapted ? light.white : own;
    const lab = (xyz) => cube.labOf(xyz.map((v, k) => (Math.max(v, 0) * own[k]) / white[k]));
    return pairs.map((pair) => de2000(...pair.map(lab)));
}

test("a sphere shaded by matrices is within 1 ΔE00 of its spectra, averaged over three lights", async () => {
    const { page, told, close } = await openPage(browser, pathToFileURL(PAGE_FILE).href);
    const code = fs.readFileSync(path.join(FOLDER, "matrices.wgsl"), "utf8") + SPHERE_WGSL;
    const textures = fs.readFileSync(path.join(FOLDER, "matrices.textures")).toString("base64");
    // X, Y, Z of the cube's primaries, and the lights as the engine keeps them.
    const primaries = [[1, 0, 0], [0, 1, 0], [0, 0, 1]].map((rgb) => colorOf(rgb).xyz);
    const xyzOf = (rgb) => [0, 1, 2].map((k) => rgb.reduce((sum, v, channel) => sum + v * primaries[channel][k], 0));
    const { lights } = colorOf([1, 1, 1], "--engine", SPACE).engine;
    const spectra = await page.evaluate((patches) => patches.map((value) => {
        globalThis.explorer.set({ space: "ACEScg", value });
        return globalThis.explorer.colorsUnderLights();
    }), PATCHES);
    // Towards the saturated colors.
    const lamp = [0, -0.6, 0.8];
    const means = [];
    let daylit = null;
    for (const name of LIGHTS) {
        const light = lights.find((one) => one.name === name).rgbu;
        const pixels = await page.evaluate(shaded, { code, textures, size: SIZE, light, lamp, patches: PATCHES });
        // The color under daylight, which comes first, times the light: what engines do.
        daylit ??= pixels;
        const pairs = { matrix: [], plain: [] };
        for (let at = 0; at < pixels.length; at += 4) {
            const [x, y] = [at / 4 % SIZE, Math.floor(at / 4 / SIZE)].map((v, k) => (k ? -1 : 1) * (2 * (v + 0.5) / SIZE - 1));
            const z = Math.sqrt(Math.max(1 - x * x - y * y, 0));
            const cosine = x * lamp[0] + y * lamp[1] + z * lamp[2];
            if (Math.min(z, cosine) > LEAST_COSINE) {
                const expected = spectra[pixels[at + 3]][name].map((v) => cosine * v);
                pairs.matrix.push([xyzOf(pixels.slice(at, at + 3)), expected]);
                pairs.plain.push([xyzOf([0, 1, 2].map((k) => daylit[at + k] * light[k])), expected]);
            }
        }
        const found = await page.evaluate(differences, { pairs: pairs.matrix, name });
        const plain = mean(await page.evaluate(differences, { pairs: pairs.plain, name }));
        const most = Math.max(...found);
        means.push(mean(found));
        console.log(`${name}: ΔE00 ${mean(found).toFixed(2)} on average, ${most.toFixed(2)} at most; by RGB alone ${plain.toFixed(2)}`);
        assert.ok(found.length > 0.5 * SIZE * SIZE, name);
        assert.ok(name === "D65" ? most < EXACT : mean(found) < NEARER * plain, name);
    }
    assert.ok(mean(means) < DIFFERENCE, String(means));
    assert.deepEqual(told, []);
    await close();
});
