// Runs modules over queries, in Node.
//
//     run_js.mjs FOLDER...
//
// Each folder holds `main.js`, which exports `answer`, its textures, and `queries.f32`, rows of 8 floats.
// The answers, rows of 16 numbers in double precision, go to `answers.f64`. Prints the program's name.

import { readFileSync, writeFileSync } from "node:fs";
import { resolve } from "node:path";
import { pathToFileURL } from "node:url";

// The content of a file in a buffer of its own.
const read = (path) => new Uint8Array(readFileSync(path)).buffer;

for (const name of process.argv.slice(2)) {
    const folder = resolve(name);
    const { answer } = await import(pathToFileURL(`${folder}/main.js`));
    const queries = new Float32Array(read(`${folder}/queries.f32`));
    writeFileSync(`${folder}/answers.f64`, answer(read(`${folder}/shader.textures`), queries));
}
console.log("Node", process.version);
