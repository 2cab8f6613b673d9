export function makeSphere() {
    return { draw() {} };
}
