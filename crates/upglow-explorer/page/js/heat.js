export function makeHeat() {
    return { draw() {} };
}
