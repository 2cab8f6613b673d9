// Elements, and lines of equal value.

function made(node, attributes, children) {
    for (const [name, value] of Object.entries(attributes)) {
        node.setAttribute(name, value);
    }
    node.append(...children);
    return node;
}

export function element(name, attributes = {}, ...children) {
    return made(document.createElement(name), attributes, children);
}

export function svgElement(name, attributes = {}, ...children) {
    return made(document.createElementNS("http://www.w3.org/2000/svg", name), attributes, children);
}

// The path on which a field of n × n samples over a square of this size is 0, by marching squares.
export function contour(field, n, size) {
    const scale = size / (n - 1);
    const parts = [];
    for (let j = 0; j < n - 1; j += 1) {
        for (let i = 0; i < n - 1; i += 1) {
            const at = j * n + i;
            // The corners of a cell, clockwise from the upper left.
            const values = [field[at], field[at + 1], field[at + n + 1], field[at + n]];
            const inside = values.map((v) => v <= 0);
            if (inside.every((v) => v === inside[0])) {
                continue;
            }
            const corners = [[i, j], [i + 1, j], [i + 1, j + 1], [i, j + 1]];
            const crossings = [];
            for (let k = 0; k < 4; k += 1) {
                const next = (k + 1) % 4;
                if (inside[k] !== inside[next]) {
                    const t = values[k] / (values[k] - values[next]);
                    crossings.push([0, 1].map((axis) =>
                        ((1 - t) * corners[k][axis] + t * corners[next][axis]) * scale));
                }
            }
            // Four crossings are two lines; either way of joining them is as good.
            for (let k = 0; k < crossings.length; k += 2) {
                const [from, to] = [crossings[k], crossings[k + 1]]
                    .map((point) => point.map((v) => v.toFixed(2)).join(" "));
                parts.push(`M${from}L${to}`);
            }
        }
    }
    return parts.join("");
}
