export function makeWhy() {
    return { draw() {} };
}
