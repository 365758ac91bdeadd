// The simulation, in a worker: drawing never waits for it. Messages in: {id, call, args}, answered by {id, value} or
// {id, faults}. Out, besides: {state}, whenever there is something new to draw and the last one was taken ("taken").
import {formula, functions, kinds, load, PointCache, SkeinError, World} from 'skein';

import {boundSurface, surfaceNet} from './nets.js';
import {Timeline} from './timeline.js';

let world = null, timeline = null, drawn = null, serial = 0; // what of it is drawn, and which world it is
let playing = false, owed = 0, before = 0, waits = false, stale = false, looping = 0;
const spent = []; // ms of each frame since the last state
let shownCuts = []; // of each body, how often what is cut had changed when it was last sent
let gradient = null; // {category, object, index}: the constraint whose gradient is shown

// As many threads as there are processors, up to four, where the page may have them: it has its own, and so have others.
const loaded = load(undefined, {threads: Math.min(4, navigator.hardwareConcurrency ?? 1)});
loaded.catch(() => {}); // whoever opens a scene is told

/* ---- what there is to draw ---- */

function box(margin) {
    const {positions} = world, least = [Infinity, Infinity, Infinity], most = [-Infinity, -Infinity, -Infinity];
    positions.forEach((x, i) => {
        least[i % 3] = Math.min(least[i % 3], x);
        most[i % 3] = Math.max(most[i % 3], x);
    });
    const side = Math.max(...most.map((x, k) => x - least[k]), 1e-3);
    return {least: least.map((x) => x - margin * side), most: most.map((x) => x + margin * side)};
}

/* Triangles of a collider that is known by its distances alone, about its pose. */
function net(index) {
    const distances = (points) => world.distances(index, points), around = box(1.2);
    const found = boundSurface(distances, around.least, around.most, 24);
    const surface = found && surfaceNet(distances, found.least, found.most, 64);
    if (!surface) return null;
    const {position, rotation: r} = world.pose(index), {positions} = surface;
    for (let v = 0; v < positions.length; v += 3) {
        const d = [0, 1, 2].map((k) => positions[v + k] - position[k]);
        for (let k = 0; k < 3; k++) positions[v + k] = r[k] * d[0] + r[3 + k] * d[1] + r[6 + k] * d[2];
    }
    return surface;
}

const value = (object, name, otherwise) => object.fields.find((f) => f.name === name)?.value ?? otherwise;

function describe() {
    const objects = Object.fromEntries(
        ['method', 'body', 'constraint', 'force', 'collider', 'motion'].map((c) => [c, world.objects(c)]));
    const bodies = objects.body.map((body, index) => ({
        kind: body.name, name: value(body, 'name', ''), look: value(body, 'look', 'cloth'), shape: world.shape('body', index).sort,
        ...world.surface(index)}));
    const colliders = objects.collider.map((c, index) => {
        const shape = world.shape('collider', index), visible = value(c, 'visible', true) && value(c, 'enabled', true);
        return {kind: c.name, visible, ...shape, net: shape.sort === 'surface' && visible ? net(index) : null};
    });
    shownCuts = bodies.map(() => 0);
    drawn = {bodies, flock: bodies.some((b) => b.shape === 'birds'), colliders: colliders.length};
    return {serial, settings: world.settings, bodies, colliders, springs: world.springs(), count: world.count, objects};
}

function arrows() {
    if (!gradient) return null;
    const {category, object, index} = gradient;
    if (category === 'force') {
        const {positions} = world, every = Math.max(1, Math.ceil(world.count / 400)), at = [];
        for (let p = 0; p < world.count; p += every) at.push(positions[3 * p], positions[3 * p + 1], positions[3 * p + 2]);
        return {from: at, along: [...world.forces(object, at)], value: null};
    }
    const found = world.constraint(category, object, Math.min(index, Math.max(0, world.constraintCount(category, object) - 1)));
    const {positions} = world;
    return {from: found.particles.flatMap((p) => [...positions.slice(3 * p, 3 * p + 3)]), along: found.gradient.flat(), value: found.value, particles: found.particles};
}

/* The particles of surfaces that are held, as far as what was done says that they may have changed. */
let holding = {of: '', particles: []};
function held() {
    const of = `${serial} ${timeline.branch} ${timeline.events.length} ${timeline.events.at(-1)?.[1] === 'set' ? world.frame : ''}`;
    if (of === holding.of) return holding.particles;
    const particles = [];
    for (const body of drawn.bodies)
        for (let i = 0; body.faceSizes.length && i < body.particleCount; i++)
            if (world.isHeld(body.firstParticle + i)) particles.push(body.firstParticle + i);
    holding = {of, particles};
    return particles;
}

function state() {
    const surfaces = drawn.bodies.map((body, index) => {
        if (!body.faceSizes.length) return null;
        const {positions, normals} = world.vertices(index, body.vertexCount), {changes, face} = world.cuts(index);
        const sent = {positions: positions.slice(), normals: normals.slice(), cut: changes === shownCuts[index] ? null : face};
        shownCuts[index] = changes;
        return sent;
    });
    return {
        serial, surfaces, held: held(), positions: world.positions.slice(), velocities: drawn.flock ? world.velocities.slice() : null,
        poses: Array.from({length: drawn.colliders}, (_, i) => world.pose(i)), arrows: arrows(),
        frame: world.frame, time: world.time, hash: world.hash(), spent: spent.splice(0), playing,
        onCard: timeline.onCard, end: timeline.end, branch: timeline.branch, branches: timeline.branches, done: timeline.events.length,
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

/* ---- the graphics card ---- */

let card = null; // asked for by the first who wants it
async function theCard() {
    const {Card} = await import('./card.js');
    return (card ??= new Card());
}

/* A frame from here by both: what they take, in ms, and how far apart they are then; the world is as it was. */
function bothWays() {
    if (timeline.onCard !== '') return null;
    const before = world.snapshot(), ends = [], ms = [];
    for (const step of [() => world.step(1), () => card.step(world)]) {
        const times = [], begun = performance.now();
        while (times.length < 5 && (times.length < 2 || performance.now() - begun < 500)) {
            world.restore(before);
            const start = performance.now();
            step();
            times.push(performance.now() - start);
        }
        ms.push(Math.min(...times));
        ends.push([world.positions.slice(), world.velocities.slice()]);
    }
    world.restore(before);
    const [apart, faster] = [0, 1].map((k) => ends[0][k].reduce((most, a, i) => Math.max(most, Math.abs(a - ends[1][k][i])), 0));
    return {name: card.name, processor: ms[0], card: ms[1], apart, faster, ends};
}

/* ---- time ---- */

function advance() {
    const start = performance.now();
    timeline.advance();
    spent.push(performance.now() - start);
    if (spent.length > 240) spent.shift();
}

function tick(mine) {
    if (!playing || !world || mine !== looping) return;
    const now = performance.now(), {fps} = world.settings;
    owed = Math.min(owed + ((now - before) / 1000) * fps, 4); // a slow machine slows the world down
    before = now;
    try {
        let any = false;
        for (; owed >= 1; owed--, any = true) {
            advance();
            if (performance.now() - now > 50) owed = Math.min(owed, 1);
        }
        if (any) show();
        setTimeout(tick, 2, mine);
    } catch (error) {
        playing = false;
        postMessage({broken: faultsOf(error)});
        show();
    }
}

function play(on) {
    playing = on;
    before = performance.now();
    owed = 0;
    if (on) tick(++looping);
    show();
}

/* ---- calls ---- */

const calls = {
    threads: async () => (await loaded).threads,
    kinds: (category) => kinds(category),
    formula: (text, options) => formula(text, options),
    functions: () => functions(),
    async open(text, sets, files, path, frame = 0, events = []) {
        const next = text ? await World.fromScene(text, {sets, files, path}) : await World.fromMesh(path, files, {sets});
        const line = new Timeline(next); // what fails leaves the old world
        try {
            if (events.some((e) => e[1] === 'card')) line.card = await theCard().catch(() => null);
            line.replay(events, frame);
        } catch (error) {
            next.free();
            throw error;
        }
        world?.free();
        [world, timeline, gradient] = [next, line, null];
        serial++;
        spent.length = 0;
        playing = false;
        const found = describe();
        show();
        return found;
    },
    /* Whether a scene can be opened. */
    async check(text, sets, files, path) {
        (await World.fromScene(text, {sets, files, path})).free();
    },
    play,
    run(frames) {
        playing = false;
        for (let i = 0; i < frames; i++) advance();
        show();
        return {frame: world.frame, hash: world.hash()};
    },
    seek(frame) {
        playing = false;
        timeline.seek(Math.min(frame, timeline.end));
        show();
    },
    /* On to a frame, as far as 100 ms take. */
    follow(frame) {
        const start = performance.now();
        if (frame < world.frame) timeline.seek(frame);
        while (world.frame < frame && performance.now() - start < 100) advance();
        show();
        return world.frame;
    },
    switchTo(branch) {
        playing = false;
        timeline.switchTo(branch);
        show();
        return Object.fromEntries(['method', 'body', 'constraint', 'force', 'collider', 'motion'].map((c) => [c, world.objects(c)]));
    },
    events: () => timeline.events,
    /* Steps from now on are on the card, or not; what came of a frame by both. Throws in words where there is no card, or where it
     * has not what this scene needs. */
    async card(on) {
        const mine = timeline;
        if (on) {
            mine.card = await theCard();
            const why = mine.card.why(mine.world);
            if (why) throw new Error(why);
        }
        mine.act('card', on);
        show();
        return on && mine === timeline ? calls.bothWays() : null;
    },
    bothWays() {
        const found = bothWays();
        delete found?.ends;
        return found;
    },
    /* The same for tests: every bird by both. */
    bothEnds: () => bothWays()?.ends,
    where: () => ({frame: world.frame, events: timeline.events}),
    set(path, value) {
        if (world.frame || timeline.end) timeline.act('set', path, value);
        else {
            world.set(path, value);
            timeline.begin();
        }
        show();
        return world.frame;
    },
    pull: (particle, place) => timeline.act('pull', particle, ...place),
    letGo: () => timeline.act('letGo'),
    togglePin(particle) {
        const held = world.isHeld(particle);
        timeline.act(held ? 'release' : 'pin', particle);
        show();
        return !held;
    },
    /* A stroke of the knife: a blade from the eye through both of its ends, at every cloth. How many faces it took. */
    cut(blade) {
        let count = 0;
        drawn.bodies.forEach((body, index) => {
            if (body.kind !== 'cloth') return;
            const before = world.cuts(index).count;
            timeline.act('cut', index, ...blade.flat());
            count += world.cuts(index).count - before;
        });
        show();
        return count;
    },
    isHeld: (particle) => world.isHeld(particle),
    measure: () => world.statistics(),
    showGradient(what) {
        gradient = what;
        try {
            arrows();
        } catch (error) {
            gradient = null;
            throw error;
        }
        show();
    },
    constraint: (category, object, index) => world.constraint(category, object, index),
    constraintCount: (category, object) => world.constraintCount(category, object),
    operations: (category, object, index) => world.operations(category, object, index),
    scene: () => world.scene(),
    file: (body, format) => world.file(body, format),
    /* The whole way up to here as a point cache. */
    pointCache(body) {
        const {vertexCount} = drawn.bodies[body], cache = new PointCache(vertexCount), {frame} = world;
        timeline.runThrough(frame, () => cache.add(world.vertices(body, vertexCount).positions));
        return cache.bytes();
    },
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
