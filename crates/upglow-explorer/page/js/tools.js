export function makeTools() {
    return { draw() {} };
}
