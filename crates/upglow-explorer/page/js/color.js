// Colors: matrices, CIELAB, differences, and what a screen shows. Everything is XYZ with Y = 1 for white.

export function multiply(m, v) {
    const row = ([a, b, c]) => a * v[0] + b * v[1] + c * v[2];
    return [row(m[0]), row(m[1]), row(m[2])];
}

// The sRGB curve, which Display P3 uses too.
export function encoded(v) {
    return v <= 0.0031308 ? 12.92 * v : 1.055 * v ** (1 / 2.4) - 0.055;
}

export function decoded(v) {
    return v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4;
}

// CIE 15:2018, section 8.2.1.
const LINEAR_BELOW = 216 / 24389;
const LINEAR_SLOPE = 24389 / 27 / 116;

export function labOf(xyz, white) {
    const [x, y, z] = [0, 1, 2].map((k) => {
        const t = xyz[k] / white[k];
        return t > LINEAR_BELOW ? Math.cbrt(t) : LINEAR_SLOPE * t + 16 / 116;
    });
    return [116 * y - 16, 500 * (x - y), 200 * (y - z)];
}

export function xyzOfLab([l, a, b], white) {
    const y = (l + 16) / 116;
    return [y + a / 500, y, y - b / 200].map((f, k) => {
        const cube = f * f * f;
        return white[k] * (cube > LINEAR_BELOW ? cube : (f - 16 / 116) / LINEAR_SLOPE);
    });
}

// CIEDE2000 of two CIELAB colors; CIE 142-2001.
export function de2000([l1, a1, b1], [l2, a2, b2]) {
    const degrees = Math.PI / 180;
    const mean7 = ((Math.hypot(a1, b1) + Math.hypot(a2, b2)) / 2) ** 7;
    const g = 1 + 0.5 * (1 - Math.sqrt(mean7 / (mean7 + 25 ** 7)));
    const c1 = Math.hypot(g * a1, b1);
    const c2 = Math.hypot(g * a2, b2);
    const hue = (a, b) => (a === 0 && b === 0 ? 0 : (Math.atan2(b, a) / degrees + 360) % 360);
    const h1 = hue(g * a1, b1);
    const h2 = hue(g * a2, b2);
    let dh = c1 * c2 === 0 ? 0 : h2 - h1;
    dh += dh > 180 ? -360 : dh < -180 ? 360 : 0;
    const dH = 2 * Math.sqrt(c1 * c2) * Math.sin((dh / 2) * degrees);
    let h = h1 + h2;
    if (c1 * c2 !== 0) {
        h = Math.abs(h1 - h2) <= 180 ? h / 2 : (h + (h < 360 ? 360 : -360)) / 2;
    }
    const t = 1 - 0.17 * Math.cos((h - 30) * degrees) + 0.24 * Math.cos(2 * h * degrees)
        + 0.32 * Math.cos((3 * h + 6) * degrees) - 0.2 * Math.cos((4 * h - 63) * degrees);
    const c = (c1 + c2) / 2;
    const l50 = ((l1 + l2) / 2 - 50) ** 2;
    const dl = (l2 - l1) / (1 + (0.015 * l50) / Math.sqrt(20 + l50));
    const dc = (c2 - c1) / (1 + 0.045 * c);
    const dhue = dH / (1 + 0.015 * c * t);
    const turn = 2 * Math.sqrt(c ** 7 / (c ** 7 + 25 ** 7))
        * Math.sin(60 * Math.exp(-(((h - 275) / 25) ** 2)) * degrees);
    return Math.sqrt(dl * dl + dc * dc + dhue * dhue - turn * dc * dhue);
}

// The widest space that the screen says it shows.
export const SCREEN = matchMedia("(color-gamut: p3)").matches ? "p3" : "srgb";
export const SCREEN_NAME = SCREEN === "p3" ? "Display P3" : "sRGB";
export const CSS_SPACE = SCREEN === "p3" ? "display-p3" : "srgb";
// The luminance of the screen's linear RGB.
export const LUMINANCE = SCREEN === "p3" ? [0.22897, 0.69174, 0.07929] : [0.21264, 0.71517, 0.07219];
// Half a step of eight bits near black: less than that beyond 0 to 1 does not show.
const ROUNDING = 1.5e-4;

// A color of a light on the screen: linear RGB within 0 to 1, how far outside it was (at most 0 inside), and
// whether that shows. A color outside keeps its luminance and hue and becomes as gray as necessary.
export function onScreen(xyz, light) {
    const rgb = multiply(light.screen[SCREEN], xyz);
    const beyond = Math.max(-rgb[0], -rgb[1], -rgb[2], rgb[0] - 1, rgb[1] - 1, rgb[2] - 1);
    const clipped = !(beyond <= ROUNDING);
    let gray = 0;
    let share = 1;
    if (clipped) {
        const luminance = rgb[0] * LUMINANCE[0] + rgb[1] * LUMINANCE[1] + rgb[2] * LUMINANCE[2];
        gray = Math.min(Math.max(luminance, 0), 1);
        for (const v of rgb) {
            const off = v - gray;
            share = off > 0 ? Math.min(share, (1 - gray) / off) : off < 0 ? Math.min(share, gray / -off) : share;
        }
    }
    const within = (v) => Math.min(Math.max(gray + share * (v - gray), 0), 1);
    return { rgb: [within(rgb[0]), within(rgb[1]), within(rgb[2])], beyond, clipped };
}

// The same as a CSS color.
export function cssColor({ rgb }) {
    return `color(${CSS_SPACE} ${rgb.map((v) => encoded(v).toFixed(5)).join(" ")})`;
}

// A 2D context whose numbers are those of the screen's space.
export function canvasContext(canvas) {
    return canvas.getContext("2d", { colorSpace: CSS_SPACE });
}

export function newImage(context, width, height) {
    return context.createImageData(width, height, { colorSpace: CSS_SPACE });
}
