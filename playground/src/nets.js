// The surface of a solid of which only distances are known, as triangles: naive surface nets (Gibson, Constrained elastic
// surface nets, 1998). `distances(points)` gives them for x, y, z after x, y, z.

/* Within a box from `least` to `most`; `cells` along its longest side. Null where there is no surface in it. */
export function surfaceNet(distances, least, most, cells) {
    const size = most.map((x, k) => x - least[k]), step = Math.max(...size) / cells;
    const n = size.map((x) => Math.max(2, Math.ceil(x / step)) + 1), at = (i, j, k) => i + n[0] * (j + n[1] * k);
    const values = sample(distances, least, step, n);
    const corner = new Int32Array(n[0] * n[1] * n[2]).fill(-1), positions = [], index = [];
    const edges = [[0, 1], [0, 2], [0, 4], [1, 3], [1, 5], [2, 3], [2, 6], [3, 7], [4, 5], [4, 6], [5, 7], [6, 7]];
    const inside = (x) => x < 0;
    for (let k = 0; k + 1 < n[2]; k++)
        for (let j = 0; j + 1 < n[1]; j++)
            for (let i = 0; i + 1 < n[0]; i++) {
                const d = [0, 1, 2, 3, 4, 5, 6, 7].map((c) => values[at(i + (c & 1), j + ((c >> 1) & 1), k + (c >> 2))]);
                let crossings = 0;
                const sum = [0, 0, 0];
                for (const [a, b] of edges) {
                    if (inside(d[a]) === inside(d[b])) continue;
                    const t = d[a] / (d[a] - d[b]);
                    crossings++;
                    for (let x = 0; x < 3; x++) sum[x] += ((a >> x) & 1) * (1 - t) + ((b >> x) & 1) * t;
                }
                if (!crossings) continue;
                corner[at(i, j, k)] = positions.length / 3;
                [i, j, k].forEach((cell, x) => positions.push(least[x] + step * (cell + sum[x] / crossings)));
            }
    // a quad about each edge of the grid that goes through the surface
    const stride = [1, n[0], n[0] * n[1]];
    for (let k = 1; k + 1 < n[2]; k++)
        for (let j = 1; j + 1 < n[1]; j++)
            for (let i = 1; i + 1 < n[0]; i++)
                for (let axis = 0; axis < 3; axis++) {
                    const here = at(i, j, k), out = inside(values[here]);
                    if (out === inside(values[here + stride[axis]])) continue;
                    const u = stride[(axis + 1) % 3], v = stride[(axis + 2) % 3];
                    const quad = [here, here - u, here - u - v, here - v].map((c) => corner[c]);
                    if (quad.some((c) => c < 0)) continue;
                    if (!out) quad.reverse();
                    index.push(quad[0], quad[1], quad[2], quad[0], quad[2], quad[3]);
                }
    return index.length ? {positions: Float32Array.from(positions), index: Uint32Array.from(index)} : null;
}

function sample(distances, least, step, n) {
    const points = new Float64Array(3 * n[0] * n[1] * n[2]);
    let at = 0;
    for (let k = 0; k < n[2]; k++)
        for (let j = 0; j < n[1]; j++)
            for (let i = 0; i < n[0]; i++) {
                points[at++] = least[0] + step * i;
                points[at++] = least[1] + step * j;
                points[at++] = least[2] + step * k;
            }
    return distances(points);
}

/* Where a solid may be: a coarse look in a box narrows it to the cells that its surface goes through. */
export function boundSurface(distances, least, most, cells = 20) {
    const size = most.map((x, k) => x - least[k]), step = Math.max(...size) / cells, n = size.map((x) => Math.ceil(x / step) + 1);
    const values = sample(distances, least, step, n), from = [Infinity, Infinity, Infinity], to = [-Infinity, -Infinity, -Infinity];
    values.forEach((value, at) => {
        if (value > 0.9 * step) return;
        const cell = [at % n[0], Math.floor(at / n[0]) % n[1], Math.floor(at / (n[0] * n[1]))];
        cell.forEach((c, k) => {
            from[k] = Math.min(from[k], least[k] + step * (c - 1.2));
            to[k] = Math.max(to[k], least[k] + step * (c + 1.2));
        });
    });
    return from[0] < to[0] ? {least: from, most: to} : null;
}
