// What arranges the functions of a module (arrange.mjs) against the module that was packed: another order does the same.
import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import {mkdtempSync, readFileSync, rmSync, writeFileSync} from 'node:fs';
import {tmpdir} from 'node:os';
import {join} from 'node:path';
import {after, test} from 'node:test';
import {pathToFileURL} from 'node:url';

import {putTogether, takeApart} from '../wasm.mjs';

const root = new URL('../../../', import.meta.url), folder = mkdtempSync(join(tmpdir(), 'skein-'));
const read = (name) => readFileSync(new URL(`build/npm/skein/${name}`, root));
const packed = (bytes) => execFileSync('gzip', ['-9c'], {input: bytes, maxBuffer: 1e8}).length;
const inOrder = (parts) => parts.bodies.map((_, i) => i);
const shuffled = (parts) => inOrder(parts).sort((a, b) => ((a * 7919) % 4099) - ((b * 7919) % 4099));
after(() => rmSync(folder, {recursive: true}));

for (const name of ['skein.wasm', 'skein-threads.wasm'])
    test(`${name}: in the same order, the same bytes; in another, and back again`, () => {
        const bytes = read(name), parts = takeApart(bytes), {bodies, imports} = parts;
        assert.ok(bodies.length > 1000 && imports > 0);
        assert.equal(Buffer.compare(putTogether(parts, inOrder(parts)), bytes), 0);
        const other = putTogether(parts, inOrder(parts).reverse()), again = takeApart(other);
        assert.ok(WebAssembly.validate(other));
        assert.notEqual(Buffer.compare(other, bytes), 0);
        assert.equal(Buffer.compare(putTogether(again, inOrder(again).reverse()), bytes), 0);
    });

test('in another order it computes the same, tables, exports and all', () => {
    const parts = takeApart(read('skein.wasm')), path = join(folder, 'other.wasm');
    writeFileSync(path, putTogether(parts, shuffled(parts)));
    const program = `
        import {readFileSync} from 'node:fs';
        import {load, World} from '${new URL('build/npm/skein/skein.js', root)}';
        await load(process.argv[1] ? new URL(process.argv[1]) : undefined);
        const hashes = [];
        for (const name of ['flag', 'drape', 'birds', 'formula_bending']) {
            const world = await World.fromScene(readFileSync('scenes/' + name + '.json', 'utf8'));
            world.step(40);
            hashes.push(world.hash());
        }
        console.log(hashes.join());`;
    const run = (...args) => execFileSync(process.execPath, ['--input-type=module', '-e', program, ...args], {cwd: root}).toString();
    const expected = run();
    assert.match(expected, /^([0-9a-f]{16},){3}[0-9a-f]{16}\n$/);
    assert.equal(run(pathToFileURL(path).href), expected);
});

test('alike functions find each other from any order', () => {
    const bytes = read('skein.wasm'), parts = takeApart(bytes), path = join(folder, 'shuffled.wasm');
    const before = putTogether(parts, shuffled(parts));
    writeFileSync(path, before);
    execFileSync(process.execPath, [new URL('bindings/js/arrange.mjs', root).pathname, path]);
    const sizes = [before, readFileSync(path), bytes].map(packed);
    assert.ok(sizes[1] < 0.95 * sizes[0] && sizes[1] < 1.01 * sizes[2], `${sizes}`);
});

test('what it does not know it refuses', () => {
    const module = (...body) => Uint8Array.from([0, 97, 115, 109, 1, 0, 0, 0, 1, 4, 1, 0x60, 0, 0, 3, 2, 1, 0, 10, body.length + 4, 1, body.length + 2, 0, ...body, 0x0b]);
    assert.equal(takeApart(module(0x10, 0)).bodies[0].calls.length, 1); // it calls itself
    assert.throws(() => takeApart(module(0x06, 0x40)), /no such instruction/); // try
    assert.throws(() => takeApart(module(0xfd, 0x80, 2)), /no such instruction/); // wider vectors, relaxed ones
    assert.throws(() => takeApart(module(0x41).subarray(0, 20)), /ends too early/);
});
