// The program that serves the page, if one does: the page may also be a file by itself.

export const served = document.getElementById("cube-arrays") === null;

export const NEEDS_PROGRAM = "This needs the program: run upglow explore.";

// The answer of the program, or an Error with its one line.
async function asked(path, options) {
    let answer;
    try {
        answer = await fetch(path, options);
    } catch {
        throw new Error("The program does not answer: was it stopped?");
    }
    if (answer.ok) {
        return answer;
    }
    const text = await answer.text();
    let line = text || `${answer.status} ${answer.statusText}`;
    try {
        line = JSON.parse(text).error ?? line;
    } catch {
        // Not JSON: the text itself.
    }
    throw new Error(line);
}

export async function getJson(path) {
    return (await asked(path)).json();
}

export async function getBytes(path) {
    return (await asked(path)).arrayBuffer();
}

export async function getText(path) {
    return (await asked(path)).text();
}

export async function postJson(path, content, signal) {
    const headers = { "content-type": "application/json" };
    return (await asked(path, { method: "POST", headers, body: JSON.stringify(content), signal })).json();
}

export async function postFile(path, file) {
    const headers = { "content-type": "application/octet-stream" };
    return (await asked(path, { method: "POST", headers, body: file })).json();
}

// A material as the program sends it, as charts take it.
export function sampledOf({ moved, passed, ...rest }) {
    const bytes = moved ? Uint8Array.from(atob(moved), (letter) => letter.charCodeAt(0)) : null;
    return { ...rest, passed: rest.fluoresces ? passed : null, moved: bytes && new Float32Array(bytes.buffer) };
}
