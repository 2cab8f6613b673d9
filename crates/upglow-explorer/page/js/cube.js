// A cube: its materials by the functions of its shader, and their colors.

import { labOf, multiply } from "./color.js";

export const FIRST_NM = 300;
export const FINE = 531;
export const LAST_NM = FIRST_NM + FINE - 1;
// Sums over emitted light are over 5 nm, as the library's.
export const STEP_NM = 5;
export const COARSE = 107;

// The arrays of a safetensors file, and its metadata.
function readArrays(buffer) {
    const length = Number(new DataView(buffer).getBigUint64(0, true));
    const header = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 8, length)));
    const arrays = {};
    const types = { U8: Uint8Array, F32: Float32Array, F64: Float64Array };
    const { __metadata__: metadata, ...tensors } = header;
    for (const [name, { dtype, data_offsets: [start, end] }] of Object.entries(tensors)) {
        arrays[name] = new types[dtype](buffer.slice(8 + length + start, 8 + length + end));
    }
    return { arrays, metadata: JSON.parse(metadata.explorer) };
}

// A light as materials are summed under it.
export function makeLight(description, nm, irradiance, weights, power) {
    return { ...description, nm, irradiance, weights, power };
}

export class Cube {
    // functions: what the shader exports in JavaScript. wgsl: the shader's text in WGSL.
    constructor(id, buffer, functions, wgsl) {
        const { arrays, metadata } = readArrays(buffer);
        this.id = id;
        this.meta = metadata;
        this.wgsl = wgsl;
        this.textures = arrays.textures.buffer;
        this.functions = functions(this.textures);
        this.nodeXyz = arrays.node_xyz;
        this.nodeDose = arrays.node_dose;
        this.matching = arrays.matching;
        this.borders = null;
        const part = (name, k, size) => arrays[name].subarray(k * size, (k + 1) * size);
        this.lights = metadata.lights.map((description, k) => makeLight(
            description,
            part("lights_nm", k, COARSE),
            part("lights_irradiance", k, COARSE),
            part("lights_weights", k, 3 * COARSE),
            part("lights_power", k, FINE),
        ));
        this.white = metadata.white;
    }

    // Greatest chroma of each kind of material by lightness and hue.
    setBorders(buffer) {
        this.borders = new Float32Array(buffer);
    }

    // Greatest chroma of a kind at a lightness and a hue in degrees, between those of the table.
    borderChroma(kind, lightness, hue) {
        const [, rows, columns] = this.meta.borders;
        const row = Math.min(Math.max((lightness / 100) * (rows - 1), 0), rows - 1);
        const column = (((hue % 360) + 360) % 360 / 360) * columns;
        const i = Math.min(Math.floor(row), rows - 2);
        const j = Math.floor(column) % columns;
        const at = (r, c) => this.borders[(kind * rows + r) * columns + (c % columns)];
        const t = column - Math.floor(column);
        const along = (r) => at(r, j) * (1 - t) + at(r, j + 1) * t;
        return along(i) * (1 - (row - i)) + along(i + 1) * (row - i);
    }

    lookUp(rgb) {
        return this.functions.upglow_look_up(rgb);
    }

    // The color that the cube answers with, mixed of its nodes' colors.
    colorOf(rgb) {
        return this.mixedColor(this.lookUp(rgb));
    }

    mixedColor({ a, b, c, d }) {
        const xyz = this.nodeXyz;
        const mixed = (k) => a.weight * xyz[3 * a.node + k] + b.weight * xyz[3 * b.node + k]
            + c.weight * xyz[3 * c.node + k] + d.weight * xyz[3 * d.node + k];
        return [mixed(0), mixed(1), mixed(2)];
    }

    mixedDose({ a, b, c, d }) {
        const dose = this.nodeDose;
        return a.weight * dose[a.node] + b.weight * dose[b.node]
            + c.weight * dose[c.node] + d.weight * dose[d.node];
    }

    rgbOf(xyz) {
        return multiply(this.meta.spaces[0].from_xyz, xyz);
    }

    xyzOf(rgb) {
        return multiply(this.meta.spaces[0].to_xyz, rgb);
    }

    labOf(xyz) {
        return labOf(xyz, this.white);
    }

    // What looks under the cube's own light as XYZ do under another to eyes adapted to that: both are then
    // the same on a screen.
    asUnderOwnLight(xyz, light) {
        const { to_xyz: toXyz } = this.meta.spaces.find(({ name }) => name === "sRGB");
        return multiply(toXyz, multiply(light.screen.srgb, xyz));
    }

    // All that charts show of a material of the cube.
    sample(material, label) {
        const f = this.functions;
        const corners = [material.a, material.b, material.c, material.d].filter((c) => c.weight > 0);
        const dyes = this.meta.model === "reflectance" ? [] : dyesOf(corners, f, this.meta);
        const reflectance = new Float64Array(FINE);
        const base = new Float64Array(FINE);
        const passed = dyes.length > 0 ? new Float64Array(FINE) : null;
        for (let i = 0; i < FINE; i += 1) {
            const nm = FIRST_NM + i;
            reflectance[i] = f.upglow_reflectance(material, nm);
            for (const c of corners) {
                base[i] += f.upglow_corner_base(c, nm);
                if (passed) {
                    passed[i] += c.weight * (1 - f.upglow_absorbed(c, nm));
                }
            }
        }
        const fluoresces = dyes.length > 0;
        const moved = fluoresces ? movedBy(material, f) : null;
        const response = fluoresces ? responseOf(material, f, this.matching) : null;
        return { label, reflectance, base, passed, dyes, moved, response, fluoresces };
    }
}

// The dyes of a material's corners with their doses: optical densities in films, concentrations else.
function dyesOf(corners, f, { model, dyes: names }) {
    const found = new Map();
    const add = (name, dose, absorbed, emission) => {
        if (dose <= 0) {
            return;
        }
        const dye = found.get(name)
            ?? { name, dose: 0, absorbed: new Float64Array(FINE), emission: new Float64Array(FINE) };
        dye.dose += dose;
        for (let i = 0; i < FINE; i += 1) {
            dye.absorbed[i] += absorbed(FIRST_NM + i);
            dye.emission[i] = emission(FIRST_NM + i);
        }
        found.set(name, dye);
    };
    for (const c of corners) {
        const emission = (dye) => (nm) => f.upglow_dye_curves(dye, nm).emission;
        if (model === "film") {
            const absorbed = (pick) => (nm) => {
                const { first, second } = f.upglow_densities(c, nm);
                const all = first + second;
                return all > 0 ? (c.weight * f.upglow_absorbed(c, nm) * pick(first, second)) / all : 0;
            };
            add(names[c.dye], c.weight * c.density, absorbed((one) => one), emission(c.dye));
            add(names[c.second_dye], c.weight * c.second_density, absorbed((_, two) => two),
                emission(c.second_dye));
        } else if (model === "dyes") {
            const next = f.upglow_next(c.dye);
            for (const [dye, share] of [[c.dye, 1 - c.second], [next, c.second]]) {
                const dose = c.weight * c.concentration * share;
                add(names[dye], dose, (nm) => dose * f.upglow_dye_curves(dye, nm).absorption, emission(dye));
            }
        } else if (c.concentration > 0) {
            add(`bell at ${c.emission_nm.toFixed(0)} nm`, c.weight * c.concentration,
                (nm) => c.weight * f.upglow_absorbed(c, nm), (nm) => f.upglow_emission(c, nm));
        }
    }
    return [...found.values()].sort((one, two) => two.dose - one.dose);
}

// The re-radiation from each wavelength (row) to each (column), 1/nm, by 5 nm.
function movedBy(material, f) {
    const moved = new Float64Array(COARSE * COARSE);
    for (let i = 0; i < COARSE; i += 1) {
        const nm = FIRST_NM + STEP_NM * i;
        if (f.upglow_albedo(material, nm) - f.upglow_reflectance(material, nm) > 0) {
            for (let o = 0; o < COARSE; o += 1) {
                moved[i * COARSE + o] = f.upglow_reradiation(material, nm, FIRST_NM + STEP_NM * o);
            }
        }
    }
    return moved;
}

// What light of each whole wavelength is seen as after it was moved, over the light: X, Y, Z.
function responseOf(material, f, matching) {
    const response = new Float64Array(3 * FINE);
    for (let i = 0; i < FINE; i += 1) {
        const nm = FIRST_NM + i;
        if (!(f.upglow_albedo(material, nm) - f.upglow_reflectance(material, nm) > 0)) {
            continue;
        }
        for (let o = 0; o < COARSE; o += 1) {
            const moved = STEP_NM * f.upglow_reradiation(material, nm, FIRST_NM + STEP_NM * o);
            for (let k = 0; k < 3; k += 1) {
                response[3 * i + k] += moved * matching[3 * o + k];
            }
        }
    }
    return response;
}

// The share of a light's wavelength that is left by the slider of ultraviolet.
export function kept(nm, uv, below) {
    if (uv === "only") {
        return nm < below ? 1 : 0;
    }
    return nm < below ? uv : 1;
}

// XYZ of a sampled material under a light with its ultraviolet scaled.
export function relit(sampled, light, uv, below) {
    const xyz = [0, 0, 0];
    for (let i = 0; i < COARSE; i += 1) {
        const share = kept(light.nm[i], uv, below);
        const at = Math.round(light.nm[i]) - FIRST_NM;
        for (let k = 0; k < 3; k += 1) {
            let seen = light.weights[3 * i + k] * sampled.reflectance[at];
            if (sampled.response) {
                seen += light.irradiance[i] * sampled.response[3 * at + k];
            }
            xyz[k] += share * seen;
        }
    }
    return xyz;
}

// What is to say of a material under a light whose power is not known where the material absorbs ultraviolet.
export function missingUltraviolet(sampled, light) {
    const missing = light.missing_ultraviolet;
    const absorbed = missing && sampled.response?.slice(0, 3 * (missing.from_nm - FIRST_NM));
    return absorbed?.some((seen) => seen > 0) ? `${missing.sentence}.` : "";
}

// A radiance factor is a ratio without meaning where less of a light's peak than this arrives.
const LEAST_POWER = 1e-3;

// Light that leaves over light that arrives, in bands of 5 nm, NaN where none arrives: the whole (total) and
// the part of fluorescence (moved). leaving: the light that leaves, over the peak of the light. Lights with
// lines are averaged over each band: a sample would hit a line or miss it.
export function radianceFactor(sampled, light, uv, below) {
    const total = new Float64Array(COARSE);
    const moved = new Float64Array(COARSE);
    const leaving = new Float64Array(COARSE);
    const power = Float64Array.from({ length: COARSE }, (_, i) => bandPower(light.power, STEP_NM * i, uv, below));
    for (let o = 0; o < COARSE; o += 1) {
        let sent = 0;
        if (sampled.moved) {
            for (let i = 0; i < COARSE; i += 1) {
                sent += STEP_NM * power[i] * sampled.moved[i * COARSE + o];
            }
        }
        leaving[o] = sampled.reflectance[STEP_NM * o] * power[o] + sent;
        moved[o] = power[o] > LEAST_POWER ? sent / power[o] : NaN;
        total[o] = sampled.reflectance[STEP_NM * o] + moved[o];
    }
    return { total, moved, leaving };
}

// The mean power of a light in the band of 5 nm around a sample.
function bandPower(power, middle, uv, below) {
    const half = (STEP_NM - 1) / 2;
    let sum = 0;
    let count = 0;
    for (let i = Math.max(middle - half, 0); i <= Math.min(middle + half, FINE - 1); i += 1) {
        sum += power[i] * kept(FIRST_NM + i, uv, below);
        count += 1;
    }
    return sum / count;
}
