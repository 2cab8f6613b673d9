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
    // A crossing is known by the edge it lies on, so that pieces of neighboring cells meet there.
    const pieces = new Map();
    const join = (from, to) => pieces.set(from, [...(pieces.get(from) ?? []), to]);
    for (let j = 0; j < n - 1; j += 1) {
        for (let i = 0; i < n - 1; i += 1) {
            // The corners of a cell, clockwise from the upper left.
            const at = j * n + i;
            const corners = [at, at + 1, at + n + 1, at + n];
            const inside = corners.map((corner) => field[corner] <= 0);
            if (inside.every((v) => v === inside[0])) {
                continue;
            }
            const edges = [0, 1, 2, 3].filter((k) => inside[k] !== inside[(k + 1) % 4])
                .map((k) => Math.min(corners[k], corners[(k + 1) % 4]) * 2 + (k % 2));
            // Four crossings are two pieces; either way of joining them is as good.
            for (let k = 0; k < edges.length; k += 2) {
                join(edges[k], edges[k + 1]);
                join(edges[k + 1], edges[k]);
            }
        }
    }
    const place = (edge) => {
        const from = edge >> 1;
        const to = edge % 2 === 0 ? from + 1 : from + n;
        const t = field[from] / (field[from] - field[to]);
        const along = (axis) => ((1 - t) * axis(from) + t * axis(to)) * scale;
        return `${along((k) => k % n).toFixed(2)} ${along((k) => Math.floor(k / n)).toFixed(2)}`;
    };
    const follow = (start) => {
        const line = [];
        for (let edge = start; edge !== undefined;) {
            line.push(place(edge));
            const next = pieces.get(edge)?.pop();
            if (next !== undefined) {
                pieces.set(next, pieces.get(next).filter((back) => back !== edge));
            }
            edge = next;
        }
        return `M${line.join("L")}`;
    };
    // Lines that end at the border of the square begin there; what is left is closed.
    const ends = [...pieces].filter(([, next]) => next.length === 1).map(([edge]) => edge);
    const starts = [...ends, ...pieces.keys()];
    return starts.filter((edge) => pieces.get(edge).length > 0).map(follow).join("");
}
