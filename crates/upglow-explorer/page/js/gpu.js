// WebGPU: the color of a material by the WGSL that the cube is exported as, and spheres of that color.

import { CSS_SPACE, LUMINANCE, SCREEN } from "./color.js";
import { COARSE, FINE, FIRST_NM, STEP_NM, kept, relit } from "./cube.js";
import { element } from "./dom.js";

// Where the texels begin in the file of textures, and where it has the sizes of its two textures.
const TEXELS = 64;
const SIZES = [16, 24];
const BYTES_A_TEXEL = 16;

// Invocations of a workgroup, and the parts in which each outgoing wavelength sums the incident ones: few
// numbers after each other, so that single precision loses few digits, and enough work at a time.
const INVOCATIONS = 128;
const PARTS = 8;

// Appended to the cube's WGSL. The sums are those of relit: over incident wavelengths for each outgoing one,
// then over those.
const COLOR_WGSL = `
const COUNT: u32 = ${COARSE};
const INVOCATIONS: u32 = ${INVOCATIONS};
const PARTS: u32 = ${PARTS};

struct Wavelength {
    nm: f32,
    irradiance: f32,
    weights: vec3f,
    matching: vec3f,
}

@group(1) @binding(0) var<storage, read> wavelengths: array<Wavelength, COUNT>;
@group(1) @binding(1) var<uniform> color: vec4f;
@group(1) @binding(2) var<storage, read_write> leaving: array<f32, COUNT * PARTS>;
@group(1) @binding(3) var<storage, read_write> seen: array<vec4f, 2>;

@compute @workgroup_size(INVOCATIONS)
fn re_radiate(@builtin(global_invocation_id) id: vec3u) {
    if (id.x >= COUNT * PARTS) {
        return;
    }
    let out_nm = ${FIRST_NM}.0 + ${STEP_NM}.0 * f32(id.x / PARTS);
    let m = upglow_look_up(color.rgb);
    var sum = 0.0;
    for (var i = id.x % PARTS; i < COUNT; i += PARTS) {
        if (wavelengths[i].irradiance > 0) {
            sum += wavelengths[i].irradiance * upglow_reradiation(m, wavelengths[i].nm, out_nm);
        }
    }
    leaving[id.x] = sum;
}

var<workgroup> sums: array<vec3f, INVOCATIONS>;

fn sum_of(i: u32, part: vec3f) -> vec3f {
    sums[i] = part;
    workgroupBarrier();
    for (var half = INVOCATIONS / 2; half > 0; half /= 2) {
        if (i < half) {
            sums[i] += sums[i + half];
        }
        workgroupBarrier();
    }
    let sum = sums[0];
    workgroupBarrier();
    return sum;
}

@compute @workgroup_size(INVOCATIONS)
fn see(@builtin(local_invocation_index) i: u32) {
    var reflected = vec3f();
    var moved = vec3f();
    if (i < COUNT) {
        let m = upglow_look_up(color.rgb);
        reflected = wavelengths[i].weights * upglow_reflectance(m, wavelengths[i].nm);
        var sum = 0.0;
        for (var part = 0u; part < PARTS; part += 1) {
            sum += leaving[i * PARTS + part];
        }
        moved = ${STEP_NM}.0 * sum * wavelengths[i].matching;
    }
    let alone = sum_of(i, reflected);
    let total = alone + sum_of(i, moved);
    if (i == 0) {
        seen[0] = vec4f(total, 0);
        seen[1] = vec4f(alone, 0);
    }
}
`;

// The same picture as that of paintSpheres.
const SPHERES_WGSL = `
struct View {
    screen: mat3x3f,
    luminance: vec3f,
    factor: f32,
    lamp: vec3f,
    fill: f32,
    size: vec2f,
    radius: f32,
    count: f32,
}

@group(0) @binding(0) var<uniform> view: View;
@group(0) @binding(1) var<uniform> seen: array<vec4f, 2>;

@vertex
fn corner(@builtin(vertex_index) i: u32) -> @builtin(position) vec4f {
    return vec4f(select(-1.0, 3.0, i == 1), select(-1.0, 3.0, i == 2), 0, 1);
}

fn on_screen(rgb: vec3f) -> vec3f {
    let gray = saturate(dot(view.luminance, rgb));
    let off = rgb - gray;
    var share = 1.0;
    for (var k = 0; k < 3; k += 1) {
        if (off[k] != 0) {
            share = min(share, select(-gray, 1 - gray, off[k] > 0) / off[k]);
        }
    }
    return saturate(gray + share * off);
}

@fragment
fn shade(@builtin(position) place: vec4f) -> @location(0) vec4f {
    let width = view.size.x / view.count;
    let sphere = min(floor(place.x / width), view.count - 1);
    let middle = vec2f((sphere + 0.5) * width, view.size.y / 2);
    let at = (place.xy - middle) * vec2f(1, -1) / view.radius;
    let distance = length(at);
    let covered = saturate((1 - distance) * view.radius + 0.5);
    let normal = vec3f(at / max(distance, 1.0), sqrt(max(1 - distance * distance, 0.0)));
    let cosine = dot(normal, view.lamp);
    let light = view.factor * select(-view.fill * cosine, cosine, cosine > 0);
    let rgb = on_screen(light * (view.screen * seen[u32(sphere)].xyz));
    let coded = select(1.055 * pow(rgb, vec3f(1 / 2.4)) - 0.055, 12.92 * rgb, rgb <= vec3f(0.0031308));
    return vec4f(covered * coded, covered);
}
`;

// Numbers of View.
const VIEW_FLOATS = 24;

// show: puts a canvas on the page. changed: asks for a draw, as WebGPU came or went. found: is told how far the
// colors that were read back are from the given ones, over those or white, whichever is greater.
export function makeGpu(show, changed, found) {
    const canvas = element("canvas", { "aria-hidden": "true" });
    let device = null;
    let isOut = !navigator.gpu;
    let engine = null;
    let preparing = null;
    let isBusy = false;
    let next = null;
    let values = null;

    const fail = () => {
        isOut = true;
        engine = null;
        next = null;
        changed();
    };

    const prepare = async (cube) => {
        if (!device) {
            const adapter = await navigator.gpu.requestAdapter();
            device = await adapter.requestDevice();
            device.lost.then(fail);
            device.addEventListener("uncapturederror", fail);
        }
        const made = await makeEngine(device, canvas, cube);
        engine?.free();
        engine = made;
        changed();
    };

    const compute = async (now, uv, colors) => {
        isBusy = true;
        engine.compute(now, uv);
        try {
            values = await engine.read();
            const most = Math.max(...colors.flat(), ...whiteUnder(now.light, uv, now.below));
            const off = colors.flat().map((v, k) => Math.abs(v - values[k]) / most);
            found(Math.max(...off));
        } finally {
            isBusy = false;
            const wanted = next;
            next = null;
            if (wanted && engine) {
                draw(...wanted);
            }
        }
    };

    // Whether WebGPU draws it, now or soon. At most one color is being computed, so that the page never waits; of those
    // that were asked for meanwhile, the last is next.
    function draw(now, view, colors) {
        if (isOut) {
            return false;
        }
        if (engine?.cube !== now.cube) {
            if (preparing !== now.cube) {
                preparing = now.cube;
                prepare(now.cube).catch(fail);
            }
            return false;
        }
        next = null;
        const isNew = engine.material !== now.key || engine.light !== now.light || engine.uv !== view.uv;
        if (isNew && isBusy) {
            next = [now, view, colors];
            return true;
        }
        if (isNew) {
            values = null;
            Object.assign(engine, { material: now.key, light: now.light, uv: view.uv });
            compute(now, view.uv, colors).catch(fail);
        }
        engine.render(view);
        show(canvas);
        return true;
    }
    return {
        draw,
        isOut: () => isOut,
        // X, Y, Z of what is shown in total, then of what is reflected; null until they are there.
        xyz: () => (next ? null : values),
        // Another draws.
        forget() {
            next = null;
            values = null;
            if (engine) {
                engine.material = "";
            }
        },
    };
}

// What is on the device for one cube.
async function makeEngine(device, canvas, cube) {
    const context = canvas.getContext("webgpu");
    const format = navigator.gpu.getPreferredCanvasFormat();
    context.configure({ device, format, colorSpace: CSS_SPACE, alphaMode: "premultiplied" });

    const { STORAGE, UNIFORM, COPY_DST, COPY_SRC, MAP_READ } = GPUBufferUsage;
    const buffer = (floats, usage) => device.createBuffer({ size: 4 * floats, usage });
    const wavelengths = buffer(12 * COARSE, STORAGE | COPY_DST);
    const color = buffer(4, UNIFORM | COPY_DST);
    const leaving = buffer(PARTS * COARSE, STORAGE);
    const seen = buffer(8, STORAGE | UNIFORM | COPY_SRC);
    const answer = buffer(8, MAP_READ | COPY_DST);
    const view = buffer(VIEW_FLOATS, UNIFORM | COPY_DST);
    const textures = texturesOf(device, cube.textures);

    const { COMPUTE } = GPUShaderStage;
    const layout = (entries) => device.createBindGroupLayout({
        entries: entries.map((entry, binding) => ({ binding, ...entry })),
    });
    const group = (its, resources) => device.createBindGroup({
        layout: its, entries: resources.map((resource, binding) => ({ binding, resource })),
    });
    const cubeLayout = layout(textures.map(() =>
        ({ visibility: COMPUTE, texture: { sampleType: "unfilterable-float" } })));
    const colorLayout = layout(["read-only-storage", "uniform", "storage", "storage"].map((type) =>
        ({ visibility: COMPUTE, buffer: { type } })));
    const groups = [
        group(cubeLayout, textures.map((texture) => texture.createView())),
        group(colorLayout, [wavelengths, color, leaving, seen].map((each) => ({ buffer: each }))),
    ];

    const colors = device.createShaderModule({ code: cube.wgsl + COLOR_WGSL });
    const spheres = device.createShaderModule({ code: SPHERES_WGSL });
    const colorPipeline = (entryPoint) => device.createComputePipelineAsync({
        layout: device.createPipelineLayout({ bindGroupLayouts: [cubeLayout, colorLayout] }),
        compute: { module: colors, entryPoint },
    });
    const [reRadiate, see, shade] = await Promise.all([
        colorPipeline("re_radiate"),
        colorPipeline("see"),
        device.createRenderPipelineAsync({
            layout: "auto",
            vertex: { module: spheres },
            fragment: { module: spheres, targets: [{ format }] },
        }),
    ]);

    const viewGroup = group(shade.getBindGroupLayout(0), [view, seen].map((each) => ({ buffer: each })));

    return {
        cube,
        compute({ inside, light, below }, uv) {
            device.queue.writeBuffer(wavelengths, 0, wavelengthsOf(cube, light, uv, below));
            device.queue.writeBuffer(color, 0, new Float32Array([...inside, 0]));
            const encoder = device.createCommandEncoder();
            const pass = encoder.beginComputePass();
            groups.forEach((each, k) => pass.setBindGroup(k, each));
            pass.setPipeline(reRadiate);
            pass.dispatchWorkgroups(Math.ceil((PARTS * COARSE) / INVOCATIONS));
            pass.setPipeline(see);
            pass.dispatchWorkgroups(1);
            pass.end();
            encoder.copyBufferToBuffer(seen, 0, answer, 0, answer.size);
            device.queue.submit([encoder.finish()]);
        },
        // X, Y, Z in total, and of what is reflected.
        async read() {
            await answer.mapAsync(GPUMapMode.READ);
            const values = [...new Float32Array(answer.getMappedRange())];
            answer.unmap();
            return [...values.slice(0, 3), ...values.slice(4, 7)];
        },
        render({ width, height, radius, count, lamp, fill, factor, light }) {
            if (canvas.width !== width || canvas.height !== height) {
                Object.assign(canvas, { width, height });
            }
            const columns = [0, 1, 2].flatMap((k) => [...light.screen[SCREEN].map((row) => row[k]), 0]);
            device.queue.writeBuffer(view, 0, new Float32Array(
                [...columns, ...LUMINANCE, factor, ...lamp, fill, width, height, radius, count]));
            const encoder = device.createCommandEncoder();
            const pass = encoder.beginRenderPass({
                colorAttachments: [{
                    view: context.getCurrentTexture().createView(), loadOp: "clear", storeOp: "store", clearValue: [0, 0, 0, 0],
                }],
            });
            pass.setPipeline(shade);
            pass.setBindGroup(0, viewGroup);
            pass.draw(3);
            pass.end();
            device.queue.submit([encoder.finish()]);
        },
        free() {
            [wavelengths, color, leaving, seen, answer, view, ...textures].forEach((each) => each.destroy());
        },
    };
}

// The cube's textures; a cube without dyes has only that of its nodes.
function texturesOf(device, file) {
    const header = new DataView(file);
    let offset = TEXELS;
    return SIZES.map((at) => [header.getUint32(at, true), header.getUint32(at + 4, true)])
        .filter(([width]) => width > 0)
        .map(([width, height]) => {
            const texture = device.createTexture({
                size: [width, height], format: "rgba32float", usage: GPUTextureUsage.TEXTURE_BINDING | GPUTextureUsage.COPY_DST,
            });
            const bytesPerRow = BYTES_A_TEXEL * width;
            device.queue.writeTexture({ texture }, file, { offset, bytesPerRow }, [width, height]);
            offset += bytesPerRow * height;
            return texture;
        });
}

// Never 0, so that nothing is divided by it.
function whiteUnder(light, uv, below) {
    const white = relit({ reflectance: new Float64Array(FINE).fill(1), response: null }, light, uv, below);
    return [...white, Number.MIN_VALUE];
}

// Rows of Wavelength.
function wavelengthsOf(cube, light, uv, below) {
    const rows = new Float32Array(12 * COARSE);
    for (let i = 0; i < COARSE; i += 1) {
        const share = kept(light.nm[i], uv, below);
        rows[12 * i] = Math.round(light.nm[i]);
        rows[12 * i + 1] = share * light.irradiance[i];
        for (let k = 0; k < 3; k += 1) {
            rows[12 * i + 4 + k] = share * light.weights[3 * i + k];
            rows[12 * i + 8 + k] = cube.matching[3 * i + k];
        }
    }
    return rows;
}
