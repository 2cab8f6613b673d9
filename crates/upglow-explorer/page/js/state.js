// What the user chose, which the address after # holds, and who wants to know of changes.

// space, value: a color in one of the spaces of the fields. uv: the ultraviolet of lights over what they
// have, or "only". slice: which picker is shown. fixed: the channel that the slice of the RGB cube fixes.
export const state = {
    space: "",
    value: [0.9, 0.1, 0.4],
    light: "",
    uv: 1,
    slice: "hue",
    fixed: 2,
    lamp: [-0.5, 0.6],
};

const watchers = [];

export function watch(watcher) {
    watchers.push(watcher);
}

// Changes some of the state, and tells everyone.
export function set(changes) {
    Object.assign(state, changes);
    writeAddress();
    watchers.forEach((watcher) => watcher());
}

const short = (v) => String(Number(v.toFixed(5)));

function writeAddress() {
    const words = new URLSearchParams({
        color: [state.space, ...state.value.map(short)].join(","),
        light: state.light,
        uv: String(state.uv),
        slice: state.slice === "hue" ? "hue" : "rgb".at(state.fixed),
        lamp: state.lamp.map(short).join(","),
    });
    // Commas stay readable.
    history.replaceState(null, "", "#" + words.toString().replaceAll("%2C", ","));
}

// The state that an address names; what is no valid value is left out.
export function readAddress(spaces, lights) {
    const words = new URLSearchParams(location.hash.slice(1));
    const numbers = (text, count) => {
        const found = text.split(",").map(Number);
        return text !== "" && found.length === count && found.every(Number.isFinite) ? found : null;
    };
    const found = {};
    const [space, ...rest] = (words.get("color") ?? "").split(",");
    const value = numbers(rest.join(","), 3);
    if (spaces.includes(space) && value && value.every((v) => Math.abs(v) <= 100)) {
        Object.assign(found, { space, value });
    }
    if (lights.includes(words.get("light"))) {
        found.light = words.get("light");
    }
    const uv = words.get("uv");
    if (uv === "only") {
        found.uv = uv;
    } else if (uv !== null && uv !== "" && Number(uv) >= 0 && Number(uv) <= 2) {
        found.uv = Number(uv);
    }
    const slice = words.get("slice");
    if (slice === "hue") {
        found.slice = slice;
    } else if (["r", "g", "b"].includes(slice)) {
        Object.assign(found, { slice: "rgb", fixed: "rgb".indexOf(slice) });
    }
    const lamp = numbers(words.get("lamp") ?? "", 2);
    if (lamp && Math.hypot(...lamp) <= 1) {
        found.lamp = lamp;
    }
    return found;
}
