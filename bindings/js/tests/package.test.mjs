// The package against the native command: hashes, tables, types; and what it does by itself. tools/npm --test runs this,
// once it has laid the package out in build/npm/skein.
import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import {readFileSync} from 'node:fs';
import {test} from 'node:test';

import {kinds, load, SkeinError, World} from '../../../build/npm/skein/skein.js';

const root = new URL('../../../', import.meta.url);
const read = (path) => readFileSync(new URL(path, root));
const skein = (...args) => execFileSync(new URL('build/skein', root).pathname, args, {cwd: root, stdio: 'pipe'}).toString();
const native = (name, frames, sets = []) =>
    JSON.parse(skein('run', `scenes/${name}.json`, '--frames', `${frames}`, '--quiet', '--json',
        ...sets.flatMap((set) => ['--set', set]))).state_hash;

async function open(name, sets = []) {
    const text = read(`scenes/${name}.json`).toString(), files = {};
    for (const body of JSON.parse(text).bodies ?? [])
        for (const file of [body.mesh, body.mesh?.replace(/[.]node$/, '.ele')]) // tetrahedra lie beside their nodes
            if (file) files[file] = read(`scenes/${file}`);
    return World.fromScene(text, {sets, files, path: `scenes/${name}.json`});
}

for (const name of ['flag', 'hanging', 'drape', 'birds', 'rope', 'jelly_ball', 'cube_bowl', 'balloon', 'orbits', 'breathing_rope'])
    test(`${name}: native's hash after 600 frames`, async () => {
        const world = await open(name);
        world.step(600);
        assert.equal(world.hash(), native(name, 600));
        assert.equal(world.frame, 600);
        world.free();
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
    world.reset();
    assert.equal(world.time, 0);
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
    for (let i = 0; i < 80; i++) {
        if (i === 20) before = wasm.memory.buffer.byteLength;
        const world = await open('drape');
        world.step(1);
        world.positions;
        world.statistics();
        world.objects('force');
        world.free();
    }
    assert.ok(wasm.memory.buffer.byteLength - before < 1 << 20); // a world of drape has 2 MB; a heap in pieces some more
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
