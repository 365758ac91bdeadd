// Going back and on again, without a page: against runs that never went back.
import assert from 'node:assert/strict';
import {readFileSync} from 'node:fs';
import {test} from 'node:test';

import {World} from '../../build/npm/skein/skein.js';
import {Timeline} from '../src/timeline.js';

const scene = JSON.parse(readFileSync(new URL('../../scenes/rope.json', import.meta.url)));
const open = () => World.fromScene(scene);

test('a long play keeps its snapshots within bounds, and any frame is found again', async () => {
    const world = await open(), line = new Timeline(world, 200e3), hashes = new Map();
    for (let frame = 1; frame <= 3000; frame++) {
        line.advance();
        if (frame % 431 === 0) hashes.set(frame, world.hash());
        assert.ok(line.bytes <= 200e3, `${line.bytes} at ${frame}`);
    }
    for (const frame of [2586, 431, 1724, 3000, 862]) {
        line.seek(frame);
        if (hashes.has(frame)) assert.equal(world.hash(), hashes.get(frame));
        assert.equal(world.frame, frame);
    }
    assert.equal(line.end, 3000);
    world.free();
});

test('hands and changes are done again, in a branch as on the old way', async () => {
    const world = await open(), line = new Timeline(world), particle = world.count - 1, go = (n) => { for (let i = 0; i < n; i++) line.advance(); };
    go(13);
    for (let i = 0; i < 20; i++) {
        line.act('pull', particle, 0.4 + 0.01 * i, 0.5, 0.1);
        line.act('pull', particle, 0.4 + 0.01 * i, 0.6, 0.1); // two places before one step
        go(1);
    }
    line.act('letGo');
    line.act('pin', 0);
    go(30);
    const first = world.hash(), events = line.events;
    assert.equal(events.filter((e) => e[1] === 'pull').length, 20);
    line.seek(25); // while it was pulled
    const middle = world.hash();
    line.seek(63);
    assert.equal(world.hash(), first);
    line.seek(25);
    assert.equal(world.hash(), middle);
    line.act('letGo');
    go(38);
    const second = world.hash();
    assert.notEqual(second, first);
    assert.deepEqual([line.branches, line.branch, line.end], [2, 1, 63]);
    line.switchTo(0);
    assert.equal(world.hash(), first);
    line.switchTo(1);
    assert.equal(world.hash(), second);
    line.seek(7);
    line.seek(63);
    assert.equal(world.hash(), second);
    // what a link has
    const other = await open(), replayed = new Timeline(other);
    replayed.replay(events, 63);
    assert.equal(other.hash(), first);
    assert.deepEqual(replayed.events, events);
    assert.throws(() => line.act('free'), TypeError);
    let frames = 0;
    line.runThrough(63, () => frames++);
    assert.equal(frames, 64);
    assert.equal(world.hash(), second);
});
