// The simulation, in a worker: drawing never waits for it. Messages in: {id, call, args}, answered by {id, value} or
// {id, faults}. Out, besides: {state}, whenever there is something new to draw and the last one was taken ("taken").
import {kinds, SkeinError, World} from 'skein';

let world = null, drawn = null, serial = 0; // what of it is drawn, and which world it is
let playing = false, owed = 0, before = 0, waits = false, stale = false;
const spent = []; // ms of each frame since the last state

/* ---- what there is to draw ---- */

function describe() {
    const bodies = world.objects('body').map((body, index) => ({kind: body.name, ...world.surface(index)}));
    const colliders = world.objects('collider').map((c) => ({
        kind: c.name, fields: Object.fromEntries(c.fields.map((f) => [f.name, f.value]))}));
    drawn = {bodies, flock: bodies.some((b) => b.kind === 'flock'), colliders: colliders.length};
    return {
        serial, settings: world.settings, bodies, colliders, springs: world.springs(), count: world.count,
        objects: Object.fromEntries(
            ['method', 'body', 'constraint', 'force', 'collider', 'motion'].map((c) => [c, world.objects(c)])),
    };
}

function state() {
    const surfaces = drawn.bodies.map((body, index) => {
        if (!body.faceSizes.length) return null;
        const {positions, normals} = world.vertices(index, body.vertexCount);
        return {positions: positions.slice(), normals: normals.slice()};
    });
    return {
        serial, surfaces, positions: world.positions.slice(), velocities: drawn.flock ? world.velocities.slice() : null,
        poses: Array.from({length: drawn.colliders}, (_, i) => world.pose(i)),
        frame: world.frame, time: world.time, hash: world.hash(), spent: spent.splice(0), playing,
    };
}

function show() {
    if (!world) return;
    if (waits) {
        stale = true;
        return;
    }
    const sent = state(), arrays = [sent.positions, sent.velocities];
    for (const surface of sent.surfaces) arrays.push(surface?.positions, surface?.normals);
    postMessage({state: sent}, arrays.filter(Boolean).map((a) => a.buffer));
    waits = true;
    stale = false;
}

/* ---- time ---- */

function advance(frames) {
    for (let i = 0; i < frames; i++) {
        const start = performance.now();
        world.step(1);
        spent.push(performance.now() - start);
    }
}

function tick() {
    if (!playing || !world) return;
    const now = performance.now(), {fps} = world.settings;
    owed = Math.min(owed + ((now - before) / 1000) * fps, 4); // a slow machine slows the world down
    before = now;
    try {
        let any = false;
        for (; owed >= 1; owed--, any = true) {
            advance(1);
            if (performance.now() - now > 50) owed = Math.min(owed, 1);
        }
        if (any) show();
        setTimeout(tick, 2);
    } catch (error) {
        playing = false;
        postMessage({broken: faultsOf(error)});
        show();
    }
}

/* ---- calls ---- */

const calls = {
    kinds: (category) => kinds(category),
    async open(text, sets, files, path, frames = 0) {
        const next = await World.fromScene(text, {sets, files, path}); // what fails leaves the old world
        world?.free();
        world = next;
        serial++;
        spent.length = 0;
        owed = 0;
        before = performance.now();
        advance(frames);
        const found = describe();
        show();
        return found;
    },
    /* Whether a scene can be opened. */
    async check(text, sets, files, path) {
        (await World.fromScene(text, {sets, files, path})).free();
    },
    play(on) {
        playing = on;
        before = performance.now();
        owed = 0;
        if (on) tick();
        show();
    },
    run(frames) {
        playing = false;
        advance(frames);
        show();
        return {frame: world.frame, hash: world.hash()};
    },
    set(path, value) {
        world.set(path, value);
        show();
    },
    pull: (particle, place) => world.pull(particle, place),
    letGo: () => world.letGo(),
    togglePin(particle) {
        const held = world.isHeld(particle);
        if (held) world.release(particle);
        else world.pin(particle);
        return !held;
    },
    measure: () => world.statistics(),
    constraint: (category, object, index) => world.constraint(category, object, index),
    scene: () => world.scene(),
    memory: () => world.statistics().memoryBytes,
};

const faultsOf = (error) =>
    error instanceof SkeinError ? error.faults : [{status: 'error', where: '', message: String(error?.message ?? error)}];

onmessage = async ({data}) => {
    if (data === 'taken') {
        waits = false;
        if (stale) show();
        return;
    }
    try {
        postMessage({id: data.id, value: await calls[data.call](...data.args)});
    } catch (error) {
        postMessage({id: data.id, faults: faultsOf(error)});
    }
};
