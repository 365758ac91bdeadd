// Every scene that runs without files but its own: native's hash after 600 frames, and of some that have come to rest,
// after 6,000. tools/npm --slow [NAME...] runs this, one scene after the other. A scene that takes longer than SKEIN_SECONDS (60)
// here is compared at the frame that it has come to, and its line says so.
import assert from 'node:assert/strict';
import {spawnSync} from 'node:child_process';
import {existsSync, readdirSync, readFileSync} from 'node:fs';
import {test} from 'node:test';

import {World} from '../../../build/npm/skein/skein.js';

const root = new URL('../../../', import.meta.url), FRAMES = 600, LONG = 6000, SECONDS = Number(process.env.SKEIN_SECONDS ?? 60);
const read = (path) => readFileSync(new URL(path, root));
const all = readdirSync(new URL('scenes/', root)).filter((file) => file.endsWith('.json')).map((file) => file.slice(0, -5));
const asked = process.env.SKEIN_SCENES?.split(' ').filter(Boolean) ?? [];
const settled = ['hanging', 'drape', 'cube_bowl', 'rope', 'jelly_ball'];

/* A run whose energies look wrong to the command ends with a failure, and has a hash all the same. */
function native(name, frames) {
    const run = spawnSync(new URL('build/skein', root).pathname,
        ['run', `scenes/${name}.json`, '--frames', `${frames}`, '--quiet', '--json'], {cwd: root});
    return JSON.parse(run.stdout).state_hash;
}

async function compare(t, name, frames) {
    const text = read(`scenes/${name}.json`).toString(), scene = JSON.parse(text), files = {};
    for (const {mesh} of [...(scene.bodies ?? []), ...(scene.colliders ?? [])])
        for (const file of mesh ? new Set([mesh, mesh.replace(/[.]node$/, '.ele')]) : []) { // tetrahedra lie beside their nodes
            if (!existsSync(new URL(`scenes/${file}`, root))) return t.skip(`${file} is not there`);
            files[file] = read(`scenes/${file}`);
        }
    const world = await World.fromScene(text, {files, path: `scenes/${name}.json`}), start = performance.now();
    while (world.frame < frames && performance.now() - start < 1000 * SECONDS) world.step(Math.min(10, frames - world.frame));
    const {frame} = world, hash = world.hash();
    world.free();
    t.diagnostic(`${name}: ${frame} frames, ${hash}${frame < frames ? `; ${frames} take longer than ${SECONDS} s` : ''}`);
    assert.ok(frame > 0);
    assert.equal(hash, native(name, frame));
}

for (const name of asked.length ? asked : all) test(name, (t) => compare(t, name, FRAMES));
for (const name of asked.length ? [] : settled) test(`${name}, come to rest`, (t) => compare(t, name, LONG));
