// The package against the native command: hashes, tables, types; and what it does by itself. tools/npm --test runs this,
// once it has laid the package out in build/npm/skein.
import assert from 'node:assert/strict';
import {execFileSync, spawnSync} from 'node:child_process';
import {mkdtempSync, readFileSync, rmSync, writeFileSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {test} from 'node:test';

import {canHaveThreads, formula, functions, kinds, load, PointCache, SkeinError, World} from '../../../build/npm/skein/skein.js';

const root = new URL('../../../', import.meta.url);
const read = (path) => readFileSync(new URL(path, root));
const skein = (...args) => execFileSync(new URL('build/skein', root).pathname, args, {cwd: root, stdio: 'pipe'}).toString();
// A run whose energies look wrong to the command ends with a failure, and has a hash all the same.
const native = (name, frames, sets = []) =>
    JSON.parse(spawnSync(new URL('build/skein', root).pathname, ['run', `scenes/${name}.json`, '--frames', `${frames}`,
        '--quiet', '--json', ...sets.flatMap((set) => ['--set', set])], {cwd: root}).stdout).state_hash;

// Tetrahedra lie beside their nodes.
const meshesOf = (scene) => [...(scene.bodies ?? []), ...(scene.colliders ?? [])].flatMap(({mesh}) =>
    mesh ? [...new Set([mesh, mesh.replace(/[.]node$/, '.ele')])] : []);

async function open(name, sets = []) {
    const text = read(`scenes/${name}.json`).toString(), files = {};
    for (const file of meshesOf(JSON.parse(text))) files[file] = read(`scenes/${file}`);
    return World.fromScene(text, {sets, files, path: `scenes/${name}.json`});
}

// Ten of all kinds; scenes.slow.mjs has all there are.
for (const name of ['flag', 'hanging', 'drape', 'birds', 'rope', 'jelly_ball', 'cube_bowl', 'balloon', 'orbits', 'breathing_rope'])
    test(`${name}: native's hash after 600 frames`, async () => {
        const world = await open(name);
        world.step(600);
        assert.equal(world.hash(), native(name, 600));
        assert.equal(world.frame, 600);
        world.free();
    });

test('a page waits for no more than 500 KB', () => {
    const size = (name) => execFileSync('gzip', ['-9c', new URL(`build/npm/skein/${name}`, root).pathname], {maxBuffer: 1e8}).length; // as tools/npm says it
    assert.ok(size('skein.wasm') <= 500e3, `skein.wasm has ${size('skein.wasm')} bytes gzipped: CMakeLists.txt says what is made small`);
    assert.ok(size('skein-threads.wasm') <= 512e3, `${size('skein-threads.wasm')}`);
});

test('threads in workers: the same bits, whoever has them', async () => {
    assert.ok(canHaveThreads());
    const program = `
        import {load, World} from './skein.js';
        const scene = (pins, grid) => ({skein: 1, bodies: [{type: 'cloth', grid: [grid, grid], pins}], forces: [{type: 'gravity'}, {type: 'surface_wind', velocity: [3, 0, 1]}],
            colliders: [{type: 'sphere', centre: [0.5, -0.3, 0], radius: 0.2}]});
        const {threads} = await load(undefined, {threads: Number(process.argv[1]), environment: {SKEIN_THREADS: 'always'}});
        const large = await World.fromScene(scene('top edge', 72)); // (small enough for machines that have other work, too)
        large.step(4);
        const kept = large.snapshot(), other = await World.fromScene(scene('top corners', 68)); // which gets what threads are left: none
        other.step(2);
        large.step(2);
        const hashes = [large.hash(), other.hash()], text = JSON.stringify(large.scene()).length > 100 && large.positions.length;
        large.restore(kept);
        large.step(2);
        hashes.push(large.hash());
        large.free(); // its threads are the next one's
        other.step(2);
        hashes.push(other.hash());
        other.free();
        for (let i = 0; i < 5; i++) { // worlds come and go
            const world = await World.fromScene(scene('top edge', 66));
            world.step(1);
            hashes.push(world.hash());
            world.free();
        }
        const last = await World.fromScene(scene('top edge', 72)); // waited for by nobody: the program ends all the same
        last.step(1);
        console.log(JSON.stringify({threads, hashes, text}));`;
    const run = (threads) => JSON.parse(execFileSync(process.execPath, ['--input-type=module', '-e', program, `${threads}`],
        {cwd: new URL('build/npm/skein', root), timeout: 300000}));
    const one = run(1), two = run(2);
    assert.deepEqual([one.threads, two.threads], [1, 2]);
    assert.deepEqual(two.hashes, one.hashes);
    assert.equal(one.hashes[2], one.hashes[0]);
});

test('changes before and while it lives give what --set gives', async () => {
    const sets = ['forces.1.velocity=[2,0,3]'];
    const before = await open('flag', sets), live = await open('flag');
    live.set('forces.1.velocity', [2, 0, 3]);
    assert.deepEqual(live.get('forces.1.velocity'), [2, 0, 3]);
    before.step(60);
    live.step(60);
    assert.equal(before.hash(), native('flag', 60, sets));
    assert.equal(live.hash(), before.hash());
    const again = await World.fromScene(live.scene());
    again.step(60);
    assert.equal(again.hash(), live.hash());
    live.set('bodies.flag.stretch.stiffness', 5e3);
    assert.equal(live.get('bodies.0.stretch.stiffness'), 5e3);
    assert.equal(live.scene().bodies[0].stretch.stiffness, 5e3);
});

test('faults name place and words', async () => {
    await assert.rejects(World.fromScene({skein: 1, bodies: [{type: 'cloth', grid: [3, 3], densty: 2}]}), (error) => {
        assert.ok(error instanceof SkeinError);
        assert.match(error.where, /scene\.json: bodies\.0\.densty/);
        assert.match(error.message, /did you mean 'density'/);
        return true;
    });
    await assert.rejects(World.fromScene('{"skein": 1,\n "bodies": }'), /scene\.json:2:/);
    const formula = {type: 'formula', constraint: 'length(p0 - p1) - * 2', particles: [[0, 1]]};
    const bodies = [{type: 'rope', count: 4}];
    await assert.rejects(World.fromScene({skein: 1, bodies, constraints: [formula]}), (error) => {
        assert.match(error.where, /constraints\.0/);
        assert.match(error.message, /\n *\^/); // a caret under the fault
        return true;
    });
    const world = await open('flag');
    assert.throws(() => world.set('bodies.0.grid', [3, 3]), SkeinError);
    assert.throws(() => world.set('method.substeps', -1), /method\.substeps/);
    assert.throws(() => world.set('forces.9.rate', 1), SkeinError);
    assert.throws(() => world.get('colours.0'), /expected one of bodies/);
    assert.throws(() => world.pin(1e6), /expected 0 to/);
    world.free();
    assert.throws(() => world.hash(), /freed/);
    await assert.rejects(World.fromScene(read('scenes/balloon.json').toString()), /no such file among those/);
});

test('the state: views, copies, snapshots', async () => {
    const world = await open('hanging');
    world.step(10);
    const {positions, positionSlots, slotOf} = world;
    for (let i = 0; i < world.count; i += 7)
        for (let k = 0; k < 3; k++) assert.equal(positions[3 * i + k], positionSlots[4 * slotOf[i] + k]);
    const kept = world.snapshot();
    world.step(20);
    const hash = world.hash();
    world.restore(kept);
    assert.equal(world.frame, 10);
    world.step(20);
    assert.equal(world.hash(), hash);
    const measured = world.statistics();
    assert.equal(measured.stateHash, hash); // the last member: all others lie where layout.js says
    assert.equal(measured.particles, world.count);
    assert.ok(Math.abs(measured.time - world.time) < 1e-12 && measured.kineticEnergy > 0);
    // by its numbers alone: the clock has no other way there
    const [now, x, v] = [world.time, world.positions.slice(), world.velocities.slice()];
    world.restore(kept);
    world.setPositions(x);
    world.setVelocities(v);
    world.time = now;
    assert.equal(world.time, now);
    assert.equal(world.frame, 30);
    assert.equal(world.hash(), hash);
    assert.throws(() => (world.time = -1), SkeinError);
    world.reset();
    assert.equal(world.time, 0);
});

test('a snapshot has pins and fields, and goes on in another world of the scene', async () => {
    const world = await open('flag'), other = await open('flag');
    world.step(20);
    world.pin(world.count - 1);
    world.set('forces.1.velocity', [1, 0, 4]);
    world.step(10);
    const kept = world.snapshot();
    world.step(30);
    other.restore(kept);
    assert.equal(other.isHeld(world.count - 1), true);
    assert.deepEqual(other.get('forces.1.velocity'), [1, 0, 4]);
    other.step(30);
    assert.equal(other.hash(), world.hash());
    assert.throws(() => other.restore(kept.subarray(0, kept.length - 9)), SkeinError);
    const stranger = await open('drape');
    assert.throws(() => stranger.restore(kept), SkeinError);
});

test('a recording is replayed, here and by the command; another start is found', async () => {
    const world = await open('flag'), folder = mkdtempSync(join(tmpdir(), 'skein-'));
    world.record();
    world.step(5);
    world.set('forces.1.velocity', [2, 1, 0]);
    world.step(5);
    const recording = world.stopRecording();
    writeFileSync(join(folder, 'flag.record'), recording);
    assert.match(skein('verify', join(folder, 'flag.record')), /the same to the bit/);
    rmSync(folder, {recursive: true});
    const found = (await open('flag')).replay(recording);
    assert.equal(found.found, false);
    assert.equal(found.whole, true);
    assert.ok(found.steps >= 10);
    const cloth = await open('drape');
    assert.throws(() => cloth.replay(recording), SkeinError);
    assert.throws(() => cloth.replay(recording.subarray(0, 7)), SkeinError);
});

for (const [name, body] of [['flag', 'flag'], ['balloon', 'balloon']])
    test(`files of ${name} are the command's, byte by byte`, async () => {
        const folder = mkdtempSync(join(tmpdir(), 'skein-')), formats = ['obj', 'ply', 'stl', 'pc2'];
        skein('run', `scenes/${name}.json`, '--frames', '12', '--quiet', '--out', folder,
            '--set', `output=${JSON.stringify(formats)}`);
        const world = await open(name), {vertexCount} = world.surface(0), cache = new PointCache(vertexCount);
        for (let frame = 0; frame <= 12; frame++) {
            if (frame) world.step(1);
            cache.add(world.vertices(0, vertexCount).positions);
        }
        const first = world.objects('body')[0].fields.find((f) => f.name === 'name').value || body;
        for (const format of formats) {
            const expected = readFileSync(join(folder, `${first}.${format}`));
            const found = format === 'pc2' ? cache.bytes() : world.file(0, format);
            assert.ok(Buffer.from(found).equals(expected), `${format}: ${found.length} bytes, expected ${expected.length}`);
        }
        rmSync(folder, {recursive: true});
        assert.throws(() => world.file(0, 'fbx'), /expected obj, ply or stl/);
        assert.throws(() => world.file(99), SkeinError);
        cache.cut(3);
        assert.equal(cache.bytes().length, 32 + 3 * 12 * vertexCount);
        assert.throws(() => cache.add([1, 2]), RangeError);
    });

test('a formula by itself: what it computes, or where its fault is', async () => {
    const good = await formula('length(p0 - p1) - 2', {result: 'number'});
    assert.equal(good.particles, 2);
    assert.match(good.graph, /sqrt/);
    assert.ok(good.graph.split('\n').length > 5 && good.operations > 5);
    const bad = await formula('1 + lenght(p0)');
    assert.match(bad.fault, /did you mean 'length'/);
    assert.deepEqual([bad.line, bad.column, bad.width], [1, 5, 6]);
    assert.match(bad.shown, /lenght\(p0\)\n *\^{6}/);
    assert.ok((await formula('p0', {result: 'number'})).fault);
});

test('worlds share a module whose memory grows under views', async () => {
    const first = await open('hanging');
    first.step(5);
    const hash = first.hash(), wasm = await load(), before = wasm.memory.buffer.byteLength;
    const many = [];
    while (wasm.memory.buffer.byteLength === before) many.push(await open('drape'));
    assert.equal(first.positions.length, 3 * first.count);
    assert.equal(first.hash(), hash);
    for (const world of many) world.free();
});

test('what is freed is used again', async () => {
    const wasm = await load();
    let before;
    for (let i = 0; i < 400; i++) {
        if (i === 100) before = wasm.memory.buffer.byteLength;
        const world = await open('drape');
        world.step(1);
        world.positions;
        world.statistics();
        world.objects('force');
        world.free();
    }
    // A world of drape has 2 MB. A heap in pieces grows by about as much before it settles: 100 worlds are past that, and
    // 300 more that kept 3.5 KB each would be found.
    assert.ok(wasm.memory.buffer.byteLength - before < 1 << 20, `${wasm.memory.buffer.byteLength - before} bytes more`);
});

test('the hand: pick, pull, pin, release', async () => {
    const world = await open('flag');
    world.step(1);
    const corner = world.count - 1, [x, y, z] = world.positions.slice(3 * corner);
    const found = world.pick([x, y, z + 2], [0, 0, -1], 0.02);
    const near = world.positions.slice(3 * found.particle, 3 * found.particle + 2);
    assert.ok(Math.hypot(near[0] - x, near[1] - y) < 0.1);
    assert.equal(world.pick([100, 100, 100], [0, 1, 0]), null);
    const goal = [x - 0.3, y + 0.2, z + 0.3];
    for (let frame = 0; frame < 60; frame++) {
        world.pull(corner, goal);
        world.step(1);
    }
    const at = world.positions.slice(3 * corner);
    assert.ok(Math.hypot(at[0] - goal[0], at[1] - goal[1], at[2] - goal[2]) < 0.02, `${at}`);
    world.letGo();
    assert.equal(world.isHeld(corner), false);
    world.pin(corner);
    assert.equal(world.isHeld(corner), true);
    world.movePin(corner, goal);
    world.step(1 / world.settings.stepsPerFrame);
    goal.forEach((g, k) => assert.equal(world.positions[3 * corner + k], Math.fround(g)));
    world.release(corner);
    assert.equal(world.isHeld(corner), false);
});

test('the knife: what is cut falls; snapshots, recordings and a reset know it', async () => {
    const scene = {bodies: [{type: 'cloth', grid: [20, 20], rotation: [90, 0, 0], pins: 'top edge'}], forces: [{type: 'gravity'}]};
    const world = await World.fromScene(scene), other = await World.fromScene(scene), blade = [[-5, 0.001, -5], [9, 0.001, 0], [-5, 0.001, 5]];
    assert.deepEqual(world.cuts(0), {count: 0, changes: 0, face: null});
    world.record();
    world.step(2);
    assert.equal(world.cut(0, blade), 19);
    assert.equal(world.cut(0, blade), 0);
    world.step(10);
    assert.equal(new TextDecoder().decode(world.file(0)).match(/^f /gm).length, 361 - 19);
    const lowest = Math.min(...world.positions.filter((_, i) => i % 3 === 1)), snapshot = world.snapshot(), hash = world.hash();
    assert.ok(lowest < -0.6, `${lowest}`);
    assert.equal(world.cuts(0).face.reduce((sum, is) => sum + is, 0), 19);
    const recording = world.stopRecording();
    assert.equal(other.replay(recording).steps, 12 * other.settings.stepsPerFrame);
    assert.equal(other.hash(), hash);
    other.reset();
    assert.equal(other.cuts(0).count, 0);
    other.restore(snapshot);
    world.step(5), other.step(5);
    assert.equal(other.hash(), world.hash());
    other.mend(0);
    assert.equal(other.cuts(0).count, 0);
    assert.throws(() => world.cut(1, blade), SkeinError);
    assert.throws(() => world.cut(0, [[0, 0, 0]]), /three corners/);
    world.free(), other.free();
});

test('surfaces, poses, springs and constraints', async () => {
    const world = await open('drape');
    const surface = world.surface(0), {positions, normals} = world.vertices(0, surface.vertexCount);
    assert.equal(surface.faceVertices.length, surface.faceSizes.reduce((a, b) => a + b));
    assert.ok(surface.faceVertices.every((v) => v < surface.vertexCount));
    const v = surface.vertexCount - 1, p = surface.particleOfVertex[v];
    assert.deepEqual([...positions.slice(3 * v, 3 * v + 3)], [...world.positions.slice(3 * p, 3 * p + 3)]);
    const [nx, ny, nz] = world.vertices(0, surface.vertexCount).normals;
    assert.ok(Math.abs(Math.hypot(nx, ny, nz) - 1) < 1e-6 && normals.length === positions.length);
    const collider = world.objects('collider').findIndex((c) => c.name === 'sphere');
    const centre = world.get(`colliders.${collider}.centre`);
    world.pose(collider).position.forEach((x, k) => assert.ok(Math.abs(x - centre[k]) < 1e-9));
    assert.ok(world.springs().length >= 2 * world.count);
    const spring = await World.fromScene({
        skein: 1, bodies: [{type: 'rope', count: 2, from: [0, 0, 0], to: [3, 4, 0]}],
        constraints: [{type: 'formula', constraint: 'length(p0 - p1) - 2', particles: [[0, 1]]}]});
    const c = spring.constraint('constraint', 0, 0);
    assert.ok(Math.abs(c.value - 3) < 1e-6, `${c.value}`);
    [0.6, 0.8, 0].forEach((g, k) => assert.ok(Math.abs(c.gradient[1][k] - g) < 1e-6)); // (p1 - p0)/|p1 - p0|
    const steps = spring.operations('constraint', 0, 0), last = steps.at(-1);
    assert.ok(Math.abs(last.value - 3) < 1e-6 && steps.some((o) => o.name === 'sqrt' && Math.abs(o.value - 5) < 1e-6));
    [...c.gradient[0], ...c.gradient[1]].forEach((g, k) => assert.ok(Math.abs(g - last.derivatives[k]) < 1e-6));
    steps.forEach((o, i) => assert.ok(o.operands.every((at) => at < i)));
});

test('contacts: with colliders, and of surfaces with each other, but for those that are to be ignored', async () => {
    const sheet = (name, y) => ({type: 'cloth', name, grid: [7, 7], size: [0.6, 0.6], position: [0, y, 0]});
    const world = await World.fromScene({
        skein: 1, bodies: [sheet('lower', 0.1), sheet('upper', 0.2)], forces: [{type: 'gravity'}, {type: 'contact', thickness: 0.01}],
        colliders: [{type: 'sphere', centre: [9, 9, 9], radius: 1}, {type: 'plane'}]});
    assert.deepEqual([world.contacts(), world.surfaceContacts()], [[], []]);
    world.step(60);
    const below = world.contacts(), between = world.surfaceContacts(), {positions} = world;
    assert.ok(below.length > 20 && between.length > 20, `${below.length} ${between.length}`);
    for (const {particle, collider, normal, gap} of below) {
        assert.deepEqual([collider, particle < 49, normal], [1, true, [0, 1, 0]]);
        assert.ok(Math.abs(gap - positions[3 * particle + 1]) < 1e-6);
    }
    for (const {rule, edges, particles, weights, normal, gap, thickness} of between) {
        const first = edges ? 2 : 1, place = [0, 1, 2].map((k) => particles.reduce((sum, p, i) => sum + weights[i] * world.positions[3 * p + k], 0));
        assert.equal(rule, 1);
        assert.ok(Math.abs(thickness - 0.01) < 1e-6 && gap <= 1.001 * thickness, `${gap} ${thickness}`);
        assert.ok(Math.abs(weights.slice(0, first).reduce((a, b) => a + b) - 1) < 1e-5);
        assert.ok(Math.abs(Math.hypot(...place) - gap) < 1e-5 && Math.abs(Math.hypot(...normal) - 1) < 1e-5);
        assert.ok(particles.slice(0, first).some((p) => p < 49) !== particles.slice(first).some((p) => p < 49), `${particles}`); // of the one sheet and the other
    }
    world.set('forces.1.ignore', 'lower:upper');
    assert.equal(world.get('forces.1.ignore'), 'lower:upper');
    world.step(30);
    assert.deepEqual(world.surfaceContacts(), []);
    assert.throws(() => world.set('forces.1.ignore', 7), SkeinError);
    world.free();
    assert.throws(() => world.contacts(), /freed/);
});

test('what things look like, and probes of colliders and fields', async () => {
    const world = await World.fromScene({
        skein: 1, bodies: [{type: 'cloth', grid: [3, 3]}, {type: 'rope', count: 3}],
        forces: [{type: 'force_field', force: 'vec3(p.x, 2, 0)', per: 'mass'}],
        colliders: [{type: 'sphere', centre: [1, 2, 3], radius: 0.5}, {type: 'formula', surface: 'length(p) - 2'}]});
    assert.equal(world.shape('collider', 0).sort, 'ball');
    assert.ok(Math.abs(world.shape('collider', 0).radius - 0.5) < 1e-6);
    assert.equal(world.shape('collider', 1).sort, 'surface');
    assert.equal(world.shape('body', 0).sort, 'surface');
    assert.equal(world.shape('body', 1).sort, 'chain');
    const [a, b] = world.distances(0, [1, 2, 4, 1, 2, 3.25]);
    assert.ok(Math.abs(a - 0.5) < 1e-6 && Math.abs(b + 0.25) < 1e-6, `${a} ${b}`);
    assert.ok(Math.abs(world.distances(1, [3, 0, 4])[0] - 3) < 1e-5);
    assert.deepEqual([...world.forces(0, [7, 0, 0])], [7, 2, 0]);
    assert.throws(() => world.shape('collider', 9), SkeinError);
});

test('a collider whose distances are sampled from a mesh: native\'s bits', async () => {
    const scene = {
        skein: 1, frames: 60, bodies: [{type: 'cloth', grid: [25, 25], size: [1.6, 1.6], position: [0, 1, 0]}], forces: [{type: 'gravity'}],
        colliders: [{type: 'field', mesh: 'ball.obj', cell: 0.05, thickness: 0.01}]};
    const world = await World.fromScene(scene, {files: {'ball.obj': read('meshes/ball.obj')}});
    world.step(60);
    assert.ok(world.contacts().length > 5);
    const folder = mkdtempSync(join(tmpdir(), 'skein-'));
    writeFileSync(join(folder, 'ball.obj'), read('meshes/ball.obj'));
    writeFileSync(join(folder, 'scene.json'), JSON.stringify(scene));
    assert.equal(world.hash(), JSON.parse(skein('run', join(folder, 'scene.json'), '--frames', '60', '--quiet', '--json')).state_hash);
    rmSync(folder, {recursive: true});
    world.free();
});

test('elsewhere at once: a body, a collider; and a mesh collider that deforms', async () => {
    const obj = 'v -2 0 -2\nv 2 0 -2\nv 2 0 2\nv -2 0 2\nf 1 4 3 2\n';
    const world = await World.fromScene({
        skein: 1, bodies: [{type: 'cloth', grid: [9, 9], size: [0.5, 0.5], position: [0, 0.3, 0]}], forces: [{type: 'gravity'}],
        colliders: [{type: 'sphere', centre: [0, 5, 0], radius: 0.2}, {type: 'mesh', mesh: 'floor.obj', thickness: 0.01}]}, {files: {'floor.obj': obj}});
    const before = world.positions.slice(), speed = () => Math.max(...world.velocities.map(Math.abs));
    world.teleportBody(0, [1, 2, 3], [0, 0, 1, 0, 1, 0, -1, 0, 0]); // a quarter about y, and away
    world.positions.forEach((x, i) => {
        const [a, b, c] = [0, 1, 2].map((k) => before[3 * Math.floor(i / 3) + k]);
        assert.ok(Math.abs(x - [c + 1, b + 2, -a + 3][i % 3]) < 1e-6);
    });
    assert.equal(speed(), 0);
    world.teleportBody(0, [-1, -2, -3]);
    assert.throws(() => world.teleportBody(0, [0, 0, 0], [1, 2, 3, 4, 5, 6, 7, 8, 9]), SkeinError);
    assert.throws(() => world.teleportBody(0, [0, 0]), SkeinError);
    world.set('colliders.0.centre', [0, 0.9, 0]); // right through the cloth, had it gone there
    world.teleportCollider(0);
    world.step(30);
    assert.ok(Math.max(...world.velocities.filter((_, i) => i % 3 === 1)) < 0.1);
    for (let frame = 1; frame <= 60; frame++) { // the floor rises by half a metre, and takes the cloth along
        const y = frame / 120;
        world.setColliderVertices(1, [-2, y, -2, 2, y, -2, 2, y, 2, -2, y, 2]);
        world.step(1);
    }
    assert.ok(Math.min(...world.positions.filter((_, i) => i % 3 === 1)) > 0.49, `${world.positions[1]}`);
    assert.throws(() => world.setColliderVertices(1, [1, 2, 3]), SkeinError);
    world.free();
});

test('the functions of formulas are told', async () => {
    const found = await functions(), names = found.map(({usage}) => usage.split('(')[0]);
    assert.ok(['length', 'dihedral', 'rest', 'sin', 'vec3'].every((name) => names.includes(name)) && found.every(({help}) => help.length > 3), names.join(' '));
    const faults = await Promise.all(names.map((name) => formula(`${name}(`)));
    for (const [i, {fault}] of faults.entries()) assert.doesNotMatch(fault, /no name/, names[i]); // each is one that formulas know
});

test('a mesh by itself is the command\'s scene about it', async () => {
    const world = await World.fromMesh('meshes/knot.obj', {'knot.obj': read('meshes/knot.obj')});
    world.step(5);
    const found = JSON.parse(skein('run', 'meshes/knot.obj', '--frames', '5', '--quiet', '--json')).state_hash;
    assert.equal(world.hash(), found);
    const again = await World.fromScene(world.scene(), {files: {'knot.obj': read('meshes/knot.obj')}, path: 'meshes/knot.json'});
    again.step(5);
    assert.equal(again.hash(), found);
    await assert.rejects(World.fromMesh('a.obj', {'a.obj': 'f 1 2 3'}), SkeinError);
});

test('the tables are the command\'s, and the types know every kind, field and call', async () => {
    const tables = JSON.parse(skein('list', '--json')), types = read('build/npm/skein/skein.d.ts').toString();
    const lists = {body: 'bodies', constraint: 'constraints', force: 'forces', collider: 'colliders', motion: 'motions', method: 'methods'};
    for (const [category, list] of Object.entries(lists)) {
        const found = await kinds(category);
        assert.deepEqual(found, tables[list]);
        for (const kind of found) {
            assert.ok(types.includes(`type: '${kind.name}';`), kind.name);
            for (const field of kind.fields) assert.ok(types.includes(field.help.replace(/\*\//g, '* /')), field.name);
        }
    }
    for (const name of Object.getOwnPropertyNames(World.prototype))
        assert.match(types, new RegExp(`^ *(readonly |private )?${name}[(:]`, 'm'), name);
    assert.ok(!types.includes('@'));
});

test('the first program of README.md runs; what is to be written is passed over', async () => {
    const program = /```js\n([\s\S]*?)```/.exec(read('bindings/js/README.md'))[1];
    const from = new URL('build/npm/skein/skein.js', root).href;
    const {world, drawn} = await import('data:text/javascript,' + encodeURIComponent(
        program.replace("'skein'", `'${from}'`) + '\nexport {world, drawn};\nvar drawn;\nfunction draw(x) { drawn = x.slice(); }'));
    assert.ok(drawn.length === 3 * 33 * 33 && drawn.every(Number.isFinite));
    assert.throws(() => world.step(), /freed/);
    const film = JSON.parse(read('scenes/flag.json'));
    film.output = ['film', {type: 'png'}];
    (await World.fromScene(film)).free();
});
