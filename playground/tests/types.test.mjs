// The package as somebody else has it: unpacked in a folder of its own it runs in node, and its types are TypeScript's, as
// strict as that can be.
import assert from 'node:assert/strict';
import {execFileSync, spawnSync} from 'node:child_process';
import {mkdtempSync, readdirSync, rmSync, symlinkSync, writeFileSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {test} from 'node:test';

const root = new URL('../../', import.meta.url).pathname, packed = readdirSync(`${root}build`).filter((name) => /^skein-.*[.]tgz$/.test(name)).at(-1);
const PROGRAM = `
    import {World, SkeinError, PointCache, formula, functions, kinds, load, canHaveThreads, type Scene, type Kind, type Statistics} from 'skein';
    const scene: Scene = {
        skein: 1,
        method: {type: 'xpbd', substeps: 10, budget_ms: 0},
        bodies: [{type: 'cloth', grid: [33, 33], pins: 'top edge', rotation: [90, 0, 0]}],
        forces: [{type: 'gravity'}, {type: 'surface_wind', velocity: [3, 0, 1]}],
        colliders: [{type: 'sphere', centre: [0, 0, 0], radius: 0.4}],
    };
    export async function main(): Promise<void> {
        await load(undefined, {threads: canHaveThreads() ? 2 : 1});
        const world: World = await World.fromScene(scene, {sets: ['method.substeps=12']});
        world.step(60);
        const hash: string = world.hash(), xyz: Float32Array = world.positions, measured: Statistics = world.statistics(), list: Kind[] = world.objects('force');
        world.set('forces.1.velocity', [6, 0, 1]);
        world.teleportBody(0, [0, 1, 0]);
        const cache = new PointCache(world.count);
        cache.add(xyz);
        const near = world.pick([0, 0, 5], [0, 0, -1], 0.1);
        if (near) world.pull(near.particle, [0, 1, 0]);
        try {
            await World.fromScene('{}');
        } catch (error) {
            if (error instanceof SkeinError) for (const fault of error.faults) hash.concat(fault.where, fault.message);
        }
        const {fault, column} = await formula('length(p0 - '), names: string[] = (await functions()).map((f) => f.usage);
        void [measured.kineticEnergy, list[0]?.fields[0]?.unit, cache.bytes().length, fault, column, names, await kinds('body')];
    }
    // @ts-expect-error there is no such kind
    const wrong: Scene = {skein: 1, bodies: [{type: 'clothh'}]};
    // @ts-expect-error a radius is a number
    const alsoWrong: Scene = {skein: 1, colliders: [{type: 'sphere', radius: 'large'}]};
    void [wrong, alsoWrong];`;

test('the package in an empty folder: types in strict mode, and an ES module for node', async () => {
    const folder = mkdtempSync(join(tmpdir(), 'skein-'));
    writeFileSync(join(folder, 'package.json'), '{"type": "module", "private": true}');
    execFileSync('npm', ['install', '--offline', '--no-audit', '--no-fund', '--silent', `${root}build/${packed}`], {cwd: folder});
    writeFileSync(join(folder, 'program.mts'), PROGRAM);
    symlinkSync(`${root}playground/node_modules/typescript`, join(folder, 'node_modules/typescript'));
    for (const kind of [['--module', 'nodenext'], ['--module', 'esnext', '--moduleResolution', 'bundler']]) {
        const {stdout, status} = spawnSync(process.execPath, ['node_modules/typescript/bin/tsc', '--strict', '--noEmit', '--target', 'es2022', '--lib', 'es2022,dom',
            '--exactOptionalPropertyTypes', '--noUncheckedIndexedAccess', ...kind, 'program.mts'], {cwd: folder, encoding: 'utf8'});
        assert.equal(stdout, '');
        assert.equal(status, 0);
    }
    writeFileSync(join(folder, 'run.js'), `
        import {World} from 'skein';
        const world = await World.fromScene({skein: 1, bodies: [{type: 'cloth', grid: [9, 9], pins: 'top edge'}], forces: [{type: 'gravity'}]});
        world.step(30);
        console.log(world.hash());`);
    writeFileSync(join(folder, 'scene.json'), '{"skein": 1, "bodies": [{"type": "cloth", "grid": [9, 9], "pins": "top edge"}], "forces": [{"type": "gravity"}]}');
    const report = execFileSync(`${root}build/skein`, ['run', join(folder, 'scene.json'), '--frames', '30', '--quiet', '--json']);
    assert.equal(execFileSync(process.execPath, ['run.js'], {cwd: folder, encoding: 'utf8'}).trim(), JSON.parse(report).state_hash);
    rmSync(folder, {recursive: true});
});
