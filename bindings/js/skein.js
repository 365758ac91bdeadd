// Skein in JavaScript: a World is opened from a scene, stepped and looked at. The same bits as the native library.
//
//     import {World} from 'skein';
//     const world = await World.fromScene(sceneJson);
//     world.step(60);
//     console.log(world.hash(), world.positions);
//
// Units are SI: metres, kilograms, seconds; y is up. What fails throws a SkeinError that names the place. One module of
// WebAssembly serves all worlds of a page or worker. skein.d.ts has every call with its words; README.md the ways to use it.
import {STATISTICS} from './layout.js';
import {wasi} from './wasi.js';

export class SkeinError extends Error {
    constructor(faults) {
        super(faults.map((f) => (f.where ? `${f.where}: ` : '') + f.message).join('\n') || 'out of memory');
        this.name = 'SkeinError';
        this.faults = faults;
        this.where = faults[0]?.where ?? '';
        this.status = faults[0]?.status ?? 'out of memory';
    }
}

const LISTS = ['bodies', 'constraints', 'forces', 'colliders', 'motions', 'method']; // in skein_category's order
const CATEGORIES = ['body', 'constraint', 'force', 'collider', 'motion', 'method', 'scene', 'exporter', 'view'];
const encoder = new TextEncoder(), decoder = new TextDecoder();

/* ---- the module ---- */

let loading = null;

async function bytesOf(source) {
    if (source instanceof ArrayBuffer || ArrayBuffer.isView(source)) return source;
    const url = new URL(source ?? new URL('./skein.wasm', import.meta.url));
    if (url.protocol === 'file:') {
        const fs = 'node:fs/promises'; // (a name that bundlers leave alone)
        return (await import(/* @vite-ignore */ fs)).readFile(url);
    }
    const answer = await fetch(url);
    if (!answer.ok) throw new Error(`cannot fetch ${url}: ${answer.status}`);
    return answer.arrayBuffer();
}

const log = (line) => console.warn(`skein: ${line}`);

async function start(source, environment) {
    let exports = null;
    const imports = {wasi_snapshot_preview1: wasi(() => exports.memory, log, environment)};
    const compiled = source instanceof WebAssembly.Module ? source : await WebAssembly.compile(await bytesOf(source));
    exports = (await WebAssembly.instantiate(compiled, imports)).exports;
    exports._initialize();
    return {...exports, threads: 1};
}

/* ---- threads, in workers ---- */

const PAGE = 65536, LEAST_MEMORY = 16777216 / PAGE, MOST_MEMORY = 2147483648 / PAGE; // as bindings/js/CMakeLists.txt has them
const STACK = 524288, MOST_THREADS = 64, PATIENCE = 20000; // bytes; ms for a worker to come

/* Whether memory can be shared with workers, and be waited for here: a page must be isolated (it is sent with
 * Cross-Origin-Opener-Policy: same-origin and Cross-Origin-Embedder-Policy: require-corp), and only workers may wait. */
export function canHaveThreads() {
    try {
        const memory = new WebAssembly.Memory({initial: 1, maximum: 1, shared: true});
        Atomics.wait(new Int32Array(memory.buffer), 0, 1); // which is at once not 1, or not allowed
        return typeof WorkerGlobalScope === 'undefined' || globalThis.crossOriginIsolated === true;
    } catch {
        return false;
    }
}

async function beginWorker() {
    if (typeof Worker !== 'undefined') return new Worker(new URL('./thread.js', import.meta.url), {type: 'module'});
    const threads = 'node:worker_threads', here = import.meta.url; // (names that bundlers leave alone)
    const {Worker: NodeWorker} = await import(/* @vite-ignore */ threads), worker = new NodeWorker(new URL('./thread.js', here), {execArgv: []});
    return {
        postMessage: (data) => worker.postMessage(data),
        unref: () => worker.unref(),
        terminate: () => worker.terminate(),
        set onmessage(hear) {
            worker.on('message', (data) => hear({data}));
        },
        set onerror(hear) {
            worker.on('error', hear);
        },
    };
}

function come(worker, data) {
    return new Promise((resolve, reject) => {
        const late = setTimeout(() => reject(new Error('a worker did not come')), PATIENCE);
        worker.onmessage = () => resolve(clearTimeout(late));
        worker.onerror = (event) => reject((clearTimeout(late), new Error(event.message ?? 'a worker could not be started')));
        worker.postMessage(data);
    });
}

/* The other flavour, with so many threads, the caller included. */
async function startShared(source, threads, environment) {
    const memory = new WebAssembly.Memory({initial: LEAST_MEMORY, maximum: MOST_MEMORY, shared: true});
    const from = source ?? new URL('./skein-threads.wasm', import.meta.url);
    const module = from instanceof WebAssembly.Module ? from : await WebAssembly.compile(await bytesOf(from));
    const imports = {env: {memory}, wasi_snapshot_preview1: wasi(() => memory, log, environment)};
    const {exports} = await WebAssembly.instantiate(module, imports);
    exports._initialize();
    const workers = [];
    try {
        for (let seat = 0; seat < Math.min(threads, MOST_THREADS) - 1; seat++) {
            const worker = await beginWorker(), bottom = exports.js_take(STACK);
            workers.push(worker);
            await come(worker, {module, memory, seat, stack: (bottom + STACK) & ~15});
            worker.unref?.(); // in node: it keeps no program alive
        }
        while (exports.js_workers() < workers.length) await new Promise((resolve) => setTimeout(resolve, 1)); // to their seats
    } catch (error) {
        for (const worker of workers) worker.terminate();
        throw error;
    }
    return {...exports, memory, threads: workers.length + 1};
}

/* Loads the module once: skein.wasm from beside this file, or from an address, bytes or a compiled module. With `threads`
 * above 1, and where these can be had, skein-threads.wasm instead (`threadsWasm` is then where), with that many; else one
 * thread does the same. The answer's `threads` says how many there are. A step takes as many as have proved faster;
 * all of them with {SKEIN_THREADS: 'always'} as the `environment`, which is for measurements. */
export function load(source, {threads = 1, threadsWasm, environment} = {}) {
    const begin = async () => {
        if (threads > 1 && canHaveThreads())
            try {
                return await startShared(threadsWasm, threads, environment);
            } catch (error) {
                log(`there are no threads, one does all: ${error.message}`);
            }
        return start(source, environment);
    };
    loading ??= begin().catch((error) => {
        loading = null; // the next call may have better luck
        throw error;
    });
    return loading;
}

/* ---- memory ---- */

function put(wasm, text) {
    const bytes = typeof text === 'string' ? encoder.encode(text) : text;
    const at = wasm.js_take(bytes.length + 1);
    if (!at) throw new SkeinError([]);
    const memory = new Uint8Array(wasm.memory.buffer, at, bytes.length + 1);
    memory.set(bytes);
    memory[bytes.length] = 0;
    return {at, size: bytes.length};
}

function words(wasm, at) {
    const memory = new Uint8Array(wasm.memory.buffer);
    return decoder.decode(memory.slice(at, memory.indexOf(0, at))); // (a copy: no text is read out of shared memory)
}

function takeJson(wasm, at) {
    if (!at) throw new SkeinError([]);
    const text = words(wasm, at);
    wasm.js_give(at);
    return JSON.parse(text);
}

/* Calls `use` with texts in the module's memory, which go afterwards. */
function withTexts(wasm, texts, use) {
    const places = texts.map((text) => put(wasm, text));
    try {
        return use(...places.map((place) => place.at));
    } finally {
        for (const place of places) wasm.js_give(place.at);
    }
}

/* The tables: every kind of a category ("body", "force", ..., "scene", "view") with fields, units and help. */
export async function kinds(category) {
    const wasm = await load();
    return takeJson(wasm, wasm.js_kinds(CATEGORIES.indexOf(category)));
}

const RESULTS = ['any', 'number', 'vector']; // in skein_formula_result's order

/* Looks at a formula by itself: its operations with those of its gradient as text, or its fault with the place. */
export async function formula(text, {particles = 0, velocities = false, result = 'any'} = {}) {
    const wasm = await load();
    return withTexts(wasm, [text], (at) => takeJson(wasm, wasm.js_formula(at, particles, velocities, RESULTS.indexOf(result))));
}

/* The functions that formulas have: {usage, help} each. */
export async function functions() {
    const wasm = await load();
    return takeJson(wasm, wasm.js_functions());
}

export {PointCache} from './pc2.js';

/* ---- worlds ---- */

const forgotten = new FinalizationRegistry(({wasm, js, scratch}) => {
    for (const place of scratch.values()) wasm.js_give(place.at);
    wasm.js_close(js);
});

export class World {
    #wasm;
    #js;
    #path;
    #scratch = new Map(); // memory by its use, for what is copied out again and again

    /* A mesh by itself, `files[path]`, as the scene that the command makes of it. */
    static async fromMesh(path, files, options = {}) {
        return World.fromScene('', {...options, files, path});
    }
    static async fromScene(scene, {sets = [], files = {}, path = 'scene.json', wasm: source} = {}) {
        return new World(await load(source), scene, sets, files, path);
    }

    constructor(wasm, scene, sets, files, path) {
        this.#wasm = wasm;
        this.#path = path;
        this.#js = wasm.js_new();
        if (!this.#js) throw new SkeinError([]);
        try {
            this.#open(typeof scene === 'string' ? scene : JSON.stringify(scene), sets, files, path);
        } catch (error) {
            wasm.js_close(this.#js);
            this.#js = 0;
            throw error;
        }
        this.settings = takeJson(wasm, wasm.js_settings(this.#js));
        forgotten.register(this, {wasm, js: this.#js, scratch: this.#scratch}, this);
    }

    #open(text, sets, files, path) {
        const wasm = this.#wasm, folder = path.slice(0, path.lastIndexOf('/') + 1);
        for (const [name, content] of Object.entries(files)) {
            const bytes = put(wasm, content instanceof ArrayBuffer ? new Uint8Array(content) : content);
            withTexts(wasm, [name[0] === '/' ? name : folder + name], (at) => wasm.js_file_add(this.#js, at, bytes.at, bytes.size));
        }
        const scene = put(wasm, text);
        const good = withTexts(wasm, [path, ...sets], (at, ...places) => {
            const list = put(wasm, new Uint8Array(new Uint32Array([...places, 0]).buffer));
            const opened = wasm.js_open(this.#js, scene.at, scene.size, at, places.length ? list.at : 0, wasm.threads);
            wasm.js_give(list.at);
            return opened;
        });
        wasm.js_give(scene.at);
        if (!good) this.#fail();
    }

    #fail() {
        throw new SkeinError(takeJson(this.#wasm, this.#wasm.js_faults(this.#js)));
    }
    #check(good) {
        if (!good) this.#fail();
    }
    get #world() {
        if (!this.#js) throw new SkeinError([{status: 'value', where: '', message: 'the world was freed'}]);
        return this.#js;
    }
    /* Room for `size` bytes that stays until another size is wanted. */
    #room(use, size) {
        let room = this.#scratch.get(use);
        if (room?.size !== size) {
            if (room) this.#wasm.js_give(room.at);
            this.#scratch.delete(use);
            room = {at: this.#wasm.js_take(size), size};
            if (!room.at) throw new SkeinError([]);
            this.#scratch.set(use, room);
        }
        return room.at;
    }
    #floats(at, count) {
        return new Float32Array(this.#wasm.memory.buffer, at, count);
    }
    #words(at, count) {
        return new Uint32Array(this.#wasm.memory.buffer, at, count);
    }

    free() {
        if (!this.#js) return;
        forgotten.unregister(this);
        for (const place of this.#scratch.values()) this.#wasm.js_give(place.at);
        this.#scratch.clear();
        this.#wasm.js_close(this.#js);
        this.#js = 0;
    }

    /* ---- stepping ---- */

    step(frames = 1) {
        this.#check(this.#wasm.js_step(this.#world, frames * this.settings.stepsPerFrame));
    }
    reset() {
        this.#check(this.#wasm.js_reset(this.#world));
    }
    get time() {
        return this.#wasm.js_time(this.#world);
    }
    /* Sets the clock alone: with positions and velocities from elsewhere it takes a world there. */
    set time(seconds) {
        this.#check(this.#wasm.js_time_set(this.#world, seconds));
    }
    get frame() {
        return Math.round(this.time * this.settings.fps);
    }
    hash() {
        return BigInt.asUintN(64, this.#wasm.js_hash(this.#world)).toString(16).padStart(16, '0');
    }
    statistics() {
        const at = this.#wasm.js_statistics(this.#world);
        if (!at) this.#fail();
        const view = new DataView(this.#wasm.memory.buffer), found = {};
        const read = {
            f64: (place) => view.getFloat64(place, true),
            u32: (place) => view.getUint32(place, true),
            u64: (place) => Number(view.getBigUint64(place, true)),
            'f64x3': (place) => [0, 8, 16].map((k) => view.getFloat64(place + k, true)),
            hash: (place) => view.getBigUint64(place, true).toString(16).padStart(16, '0'),
        };
        for (const [name, offset, type] of STATISTICS) found[name] = read[type](at + offset);
        return found;
    }

    /* ---- the state ---- */

    get count() {
        return this.#wasm.js_count(this.#world);
    }
    /* The state itself: four floats a slot, and the slot of each particle. */
    get positionSlots() {
        return this.#floats(this.#wasm.js_slots(this.#world, false), 4 * this.#slotCount);
    }
    get velocitySlots() {
        return this.#floats(this.#wasm.js_slots(this.#world, true), 4 * this.#slotCount);
    }
    get #slotCount() {
        return this.#wasm.js_slot_count(this.#world);
    }
    get slotOf() {
        return this.#words(this.#wasm.js_slot_of(this.#world), this.count);
    }
    get positions() {
        return this.#copied(false);
    }
    get velocities() {
        return this.#copied(true);
    }
    #copied(velocities) {
        const at = this.#room(velocities ? 'velocities' : 'positions', 12 * this.count);
        this.#check(this.#wasm.js_copy(this.#world, velocities, at));
        return this.#floats(at, 3 * this.count);
    }
    setPositions(xyz, first = 0) {
        this.#put(false, xyz, first);
    }
    setVelocities(xyz, first = 0) {
        this.#put(true, xyz, first);
    }
    #put(velocities, xyz, first) {
        const numbers = Float64Array.from(xyz), place = put(this.#wasm, new Uint8Array(numbers.buffer));
        const good = this.#wasm.js_state_set(this.#world, velocities, first, numbers.length / 3, place.at);
        this.#wasm.js_give(place.at);
        this.#check(good);
    }
    /* All that changes, as bytes to come back to; they are of this world or of one that was opened from the same scene. */
    snapshot() {
        const wasm = this.#wasm, size = wasm.js_snapshot_size(this.#world), at = wasm.js_take(size);
        if (!at) throw new SkeinError([]);
        try {
            const written = wasm.js_snapshot_write(this.#world, at, size);
            this.#check(written);
            return new Uint8Array(wasm.memory.buffer, at, written).slice();
        } finally {
            wasm.js_give(at);
        }
    }
    restore(snapshot) {
        this.#withBytes(snapshot, (at, size) => this.#check(this.#wasm.js_snapshot_read(this.#world, at, size)));
    }
    /* Records what is done from now on, until stopRecording() gives it; replay() or `skein verify` do it again and compare. */
    record() {
        const version = this.#wasm.js_version(), words = [1e6, 1e3, 1].map((unit) => Math.floor(version / unit) % 1000).join('.');
        const note = {skein: words, path: this.#path, scene: this.scene()}; // as `skein record` has it
        withTexts(this.#wasm, [JSON.stringify(note)], (at) => this.#check(this.#wasm.js_record_begin(this.#world, at)));
    }
    stopRecording() {
        this.#check(this.#wasm.js_record_end(this.#world));
        const size = this.#wasm.js_recorded_size(this.#js);
        return new Uint8Array(this.#wasm.memory.buffer, this.#wasm.js_recorded(this.#js), size).slice();
    }
    replay(recording) {
        return this.#withBytes(recording, (at, size) => {
            const text = this.#wasm.js_replay(this.#world, at, size);
            if (!text) this.#fail();
            return takeJson(this.#wasm, text);
        });
    }
    #withBytes(bytes, use) {
        const place = put(this.#wasm, bytes instanceof Uint8Array ? bytes : new Uint8Array(bytes));
        try {
            return use(place.at, place.size);
        } finally {
            this.#wasm.js_give(place.at);
        }
    }

    /* ---- objects and fields ---- */

    objects(category) {
        return takeJson(this.#wasm, this.#wasm.js_objects(this.#world, CATEGORIES.indexOf(category)));
    }
    #place(path) {
        const [list, ...rest] = path.split('.'), category = LISTS.indexOf(list);
        let index = 0;
        if (category < 0) throw this.#nowhere(path, `expected one of ${LISTS.join(', ')} at its beginning`);
        if (list !== 'method') {
            const word = rest.shift() ?? '';
            index = /^\d+$/.test(word)
                ? Number(word)
                : this.objects(CATEGORIES[category]).findIndex(
                      (o) => o.fields.find((f) => f.name === 'name')?.value === word);
            if (index < 0) throw this.#nowhere(path, `there is none named '${word}' in ${list}`);
        }
        return {category, index, object: list === 'method' ? list : `${list}.${index}`, field: rest.join('.')};
    }
    #nowhere(path, message) {
        return new SkeinError([{status: 'name', where: path, message}]);
    }
    get(path) {
        const {category, index, field} = this.#place(path);
        const at = withTexts(this.#wasm, [field], (name) => this.#wasm.js_get(this.#world, category, index, name));
        if (!at) this.#fail();
        return takeJson(this.#wasm, at);
    }
    set(path, value) {
        const {category, index, object, field} = this.#place(path);
        this.#check(
            withTexts(this.#wasm, [object, field, JSON.stringify(value)], (place, name, json) =>
                this.#wasm.js_set(this.#world, category, index, place, name, json)));
    }
    /* The scene with all that was set: opened again, it gives the same world. */
    scene() {
        return takeJson(this.#wasm, this.#wasm.js_document(this.#world));
    }

    /* ---- elsewhere at once ---- */

    /* A body's particles turn about the origin (`turn`, a rotation's rows) and go by a shift, with nothing flung or met on the way. */
    teleportBody(body, shift = [0, 0, 0], turn = [1, 0, 0, 0, 1, 0, 0, 0, 1]) {
        this.#withNumbers([...Array.from(turn), ...Array.from(shift)], 12, (at) => this.#check(this.#wasm.js_body_teleport(this.#world, body, at)));
    }
    /* What was set of a collider's place since the last step is no way that it travels. */
    teleportCollider(collider) {
        this.#check(this.#wasm.js_collider_teleport(this.#world, collider));
    }
    /* Where the vertices of a "mesh" collider are at the end of the next step. */
    setColliderVertices(collider, xyz) {
        this.#withNumbers(xyz, xyz.length, (at) => this.#check(this.#wasm.js_collider_vertices(this.#world, collider, at, xyz.length / 3)));
    }
    #withNumbers(numbers, count, use) {
        if (numbers.length !== count || count % 3) throw new SkeinError([{status: 'value', where: '', message: `${numbers.length} numbers: expected ${count === 12 ? '9 of a turn and 3 of a shift' : 'three a vertex'}`}]);
        return this.#withBytes(new Uint8Array(Float64Array.from(numbers).buffer), use);
    }

    /* ---- the hand ---- */

    isHeld(particle) {
        return Boolean(this.#wasm.js_is_held(this.#world, this.#particle(particle)));
    }
    pin(particle) {
        this.#check(this.#wasm.js_hold(this.#world, this.#particle(particle), true));
    }
    release(particle) {
        this.#check(this.#wasm.js_hold(this.#world, this.#particle(particle), false));
    }
    movePin(particle, [x, y, z]) {
        this.#check(this.#wasm.js_move_pin(this.#world, this.#particle(particle), x, y, z));
    }
    pull(particle, [x, y, z]) {
        this.#wasm.js_pull(this.#world, this.#particle(particle), x, y, z);
    }
    letGo() {
        this.#wasm.js_let_go(this.#world);
    }
    #particle(particle) {
        if (Number.isInteger(particle) && particle >= 0 && particle < this.count) return particle;
        throw new SkeinError([
            {status: 'value', where: 'particle', message: `expected 0 to ${this.count - 1}, not ${particle}`}]);
    }
    pick(origin, direction, radius = 0, slope = 0) {
        const room = this.#room('pick', 72);
        new Float64Array(this.#wasm.memory.buffer, room, 8).set([...origin, ...direction, radius, slope]);
        const particle = this.#wasm.js_pick(this.#world, room, room + 64);
        return particle < 0 ? null : {particle, t: new Float64Array(this.#wasm.memory.buffer, room + 64, 1)[0]};
    }

    /* ---- the knife ---- */

    /* Cuts a cloth where a blade, a triangle with these corners, meets it; how many faces that took away. */
    cut(body, blade) {
        const numbers = Float64Array.from(blade.flat()), room = this.#room('blade', 72);
        if (numbers.length !== 9) throw new SkeinError([{status: 'value', where: 'blade', message: 'expected three corners'}]);
        new Float64Array(this.#wasm.memory.buffer, room, 9).set(numbers);
        const count = this.#wasm.js_cut(this.#world, body, room);
        this.#check(count >= 0);
        return count;
    }
    mend(body) {
        this.#check(this.#wasm.js_mend(this.#world, body));
    }
    /* What is cut of a body: how many faces, of each face whether it is (null where none ever was), and a number that
     * grows with every change. */
    cuts(body) {
        const room = this.#room('cuts', 12);
        this.#check(this.#wasm.js_cuts(this.#world, body, room));
        const [at, count, changes] = this.#words(room, 3);
        return {count, changes, face: at ? new Uint8Array(this.#wasm.memory.buffer, at, this.surface(body).faceSizes.length).slice() : null};
    }

    /* ---- what is drawn ---- */

    surface(body) {
        const room = this.#room('surface', 40);
        this.#check(this.#wasm.js_surface(this.#world, body, room));
        const [particleOf, sizes, corners, uv, firstParticle, particleCount, vertexCount, faceCount, cornerCount, rows] =
            this.#words(room, 10).slice();
        return {
            firstParticle, particleCount, vertexCount, gridRows: rows,
            particleOfVertex: this.#words(particleOf, vertexCount).slice(),
            faceSizes: this.#words(sizes, faceCount).slice(),
            faceVertices: this.#words(corners, cornerCount).slice(),
            uv: uv ? this.#floats(uv, 2 * cornerCount).slice() : null,
        };
    }
    /* A surface's vertices and unit normals as they are now. */
    vertices(body, vertexCount) {
        const size = 12 * vertexCount, at = this.#room(`vertices ${body}`, 2 * size);
        this.#check(this.#wasm.js_vertices(this.#world, body, at, at + size));
        return {positions: this.#floats(at, 3 * vertexCount), normals: this.#floats(at + size, 3 * vertexCount)};
    }
    /* A body as a file: "obj", "ply" or "stl", the bytes that the command writes. */
    file(body, format = 'obj') {
        const room = this.#room('file', 8);
        const good = withTexts(this.#wasm, [format], (name) => this.#wasm.js_clip(this.#world, body, name, room));
        const [at, size] = this.#words(room, 2), bytes = new Uint8Array(this.#wasm.memory.buffer, at, size).slice();
        this.#wasm.js_give(at);
        this.#check(good);
        return bytes;
    }
    /* What a body or collider looks like: its sort ("ball", "box", "surface" ...) and measures. */
    shape(category, index) {
        const at = this.#wasm.js_shape(this.#world, CATEGORIES.indexOf(category), index);
        if (!at) this.#fail();
        return takeJson(this.#wasm, at);
    }
    /* How far points (x, y, z each) are from a collider's surface; negative inside. */
    distances(collider, points) {
        return this.#probe(false, collider, points, points.length / 3);
    }
    /* What a force field does to a particle at rest at each of the points. */
    forces(force, points) {
        return this.#probe(true, force, points, points.length);
    }
    #probe(force, index, points, numbers) {
        const wasm = this.#wasm, at = wasm.js_take(8 * (points.length + numbers));
        if (!at) throw new SkeinError([]);
        try {
            new Float64Array(wasm.memory.buffer, at, points.length).set(points);
            const out = at + 8 * points.length;
            this.#check(wasm.js_probe(this.#world, force, index, points.length / 3, at, out));
            return new Float64Array(wasm.memory.buffer, out, numbers).slice();
        } finally {
            wasm.js_give(at);
        }
    }
    pose(collider) {
        const room = this.#room('pose', 96);
        this.#check(this.#wasm.js_pose(this.#world, collider, room));
        const numbers = [...new Float64Array(this.#wasm.memory.buffer, room, 12)];
        return {position: numbers.slice(0, 3), rotation: numbers.slice(3)};
    }
    /* Particles that touch a collider now. */
    contacts() {
        return this.#list('js_contacts', 6, ([particle, collider, x, y, z, gap]) => ({particle, collider, normal: [x, y, z], gap}));
    }
    /* Where surfaces touch each other now, as forces of the kind "contact" keep them apart: a vertex and a triangle, or two
     * edges. Costs a search over all surfaces. */
    surfaceContacts() {
        return this.#list('js_surface_contacts', 15, (n) => ({
            rule: n[0], edges: Boolean(n[1]), particles: n.slice(2, 6), weights: n.slice(6, 10), normal: n.slice(10, 13),
            gap: n[13], thickness: n[14],
        }));
    }
    /* What a call lists, `wide` numbers each. */
    #list(call, wide, read) {
        const room = this.#room('list', 8), good = this.#wasm[call](this.#world, room), [at, count] = this.#words(room, 2);
        this.#check(good);
        const numbers = new Float64Array(this.#wasm.memory.buffer, at, wide * count), found = [];
        for (let i = 0; i < count; i++) found.push(read([...numbers.subarray(wide * i, wide * (i + 1))]));
        this.#wasm.js_give(at);
        return found;
    }
    springs() {
        const count = this.#wasm.js_springs(this.#world, 0, 0);
        if (!count) return new Uint32Array(0);
        const at = this.#room('springs', 8 * count);
        this.#wasm.js_springs(this.#world, at, count);
        return this.#words(at, 2 * count).slice();
    }
    constraintCount(category, object) {
        return this.#wasm.js_constraint_count(this.#world, CATEGORIES.indexOf(category), object);
    }
    /* The same, operation by operation, each with its derivatives by all coordinates of its particles. */
    operations(category, object, index) {
        const at = this.#wasm.js_operations(this.#world, CATEGORIES.indexOf(category), object, index);
        if (!at) this.#fail();
        return takeJson(this.#wasm, at);
    }
    constraint(category, object, index) {
        const at = this.#wasm.js_constraint(this.#world, CATEGORIES.indexOf(category), object, index);
        if (!at) this.#fail();
        return takeJson(this.#wasm, at);
    }
}
