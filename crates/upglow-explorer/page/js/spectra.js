export function makeSpectra() {
    return { draw() {} };
}
