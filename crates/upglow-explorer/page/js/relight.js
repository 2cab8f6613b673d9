export function makeRelight() {
    return { draw() {} };
}
