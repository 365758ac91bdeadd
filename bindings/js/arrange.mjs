// Makes a module of WebAssembly shorter once it is packed: node arrange.mjs MODULE. gzip looks back 32 KB and no further, and
// the sweeps of one constraint are much like those of another which the linker puts 100 KB away. So functions that are alike
// are put next to each other. What each does stays, and names (of functions, tools and features) go. A module with
// instructions that are not known stays as it is.
import {readFileSync, writeFileSync} from 'node:fs';
import {gzipSync} from 'node:zlib';
import {putTogether, takeApart} from './wasm.mjs';

const PIECE = 6; // bytes that count as alike: with 4 or 8 less is won
// Bytes that what comes next is held against, about what gzip looks at; and how much it counts that a function is long (1: of what
// comes next only the share that is alike counts, which leaves the long ones for the end). Which of them packs best changes with
// every function, by a five-hundredth of the module, so all are tried.
const WINDOWS = [29000, 32000, 35000], LENGTHS = [0.5, 0.6, 0.7];

/* Of each function the pieces that it has, as numbers, and of each piece the functions that have it. */
function piecesOf(bodies) {
    const owners = new Map(), pieces = bodies.map(({bytes}, index) => {
        const own = new Set();
        for (let i = 0; i + PIECE <= bytes.length; i++) {
            let piece = 0;
            for (let k = 0; k < PIECE; k++) piece = (Math.imul(piece ^ bytes[i + k], 0x01000193) + 0x9e3779b9) | 0;
            own.add(piece);
        }
        for (const piece of own) owners.has(piece) ? owners.get(piece).push(index) : owners.set(piece, [index]);
        return own;
    });
    return {pieces, owners};
}

/* An order, from the longest on: next comes the function of which most is in the last `window` bytes. */
function orderOf(bodies, {pieces, owners}, window, length) {
    const seen = new Map(), known = bodies.map(() => 0), order = [];
    const count = (index, by) => {
        for (const piece of pieces[index]) {
            const before = seen.get(piece) ?? 0;
            seen.set(piece, before + by);
            if (!before || !(before + by)) for (const owner of owners.get(piece)) known[owner] += by;
        }
    };
    const left = new Set(bodies.keys()), share = (index) => (known[index] + 1e-3) / (pieces[index].size + 1) ** length;
    let size = 0, oldest = 0, next = 0;
    for (const index of left) if (bodies[index].bytes.length > bodies[next].bytes.length) next = index;
    while (left.delete(next)) {
        order.push(next);
        count(next, 1);
        size += bodies[next].bytes.length;
        for (; size > window && oldest < order.length - 1; oldest++) {
            size -= bodies[order[oldest]].bytes.length;
            count(order[oldest], -1);
        }
        let most = 0;
        for (const index of left) if (share(index) > most) most = share((next = index));
    }
    return order;
}

const [path] = process.argv.slice(2);
if (!path) throw new Error('usage: node arrange.mjs MODULE');
let parts;
try {
    parts = takeApart(readFileSync(path));
} catch ({message}) {
    console.error(`arrange: ${path} stays as it is, and is longer: ${message}`);
}
if (parts) {
    const pieces = piecesOf(parts.bodies);
    const modules = WINDOWS.flatMap((window) => LENGTHS.map((length) => putTogether(parts, orderOf(parts.bodies, pieces, window, length))));
    const packed = modules.map((module) => gzipSync(module, {level: 9}).length);
    writeFileSync(path, modules[packed.indexOf(Math.min(...packed))]);
}
