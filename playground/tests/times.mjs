// What frames take in Chromium: `tools/test-web --times`. W1 of the benchmark (bench/case_frames.c) by one thread and by two,
// and a step of 16,384 birds by one, in a worker of a page that may have threads, with the package as it is packed. The least
// of some rounds counts, in turn, so that what else the machine does counts little; bars that are missed are said and make it fail.
import {existsSync} from 'node:fs';

import {chromium} from 'playwright-core';

import {ISOLATED, serve} from './server.mjs';

const root = new URL('../../', import.meta.url).pathname, ROUNDS = Number(process.argv[2] ?? 12);

/* Hangs by two corners: rigid springs and drag, 10 substeps of a sweep. */
const w1 = (side) => {
    const rigid = {stiffness: 'infinite', damping: 0};
    return {
        skein: 1, method: {type: 'xpbd', substeps: 10},
        bodies: [{type: 'cloth', grid: [side, side], density: 0.2, pins: 'top corners', stretch: {...rigid, limit: 'infinite', tether: 'infinite'}, shear: rigid, bend: {by: 'springs', ...rigid}}],
        forces: [{type: 'gravity'}, {type: 'drag', rate: 1}],
    };
};
/* About 30 neighbours each, that go round. */
const birds = (count) => {
    const side = 2 * Math.cbrt(count / 7.2);
    return {
        skein: 1, method: {type: 'symplectic_euler', substeps: 1}, bodies: [{type: 'flock', count, spread: [side, side, side], swirl: 4}],
        forces: [{type: 'flocking', separation: 0.8, alignment: 0.6, cohesion: 0.6}, {type: 'attraction', centre: [0.5, -0.25, 1]}, {type: 'speed_limit', limit: 6}],
    };
};
const CASES = [
    {name: 'W1, 32 x 32', scene: w1(32), bar: 0.35, frames: 60}, {name: 'W1, 64 x 64', scene: w1(64), bar: 1.2, frames: 30},
    {name: 'W1, 128 x 128', scene: w1(128), bar: 3, frames: 10, two: true}, {name: '16,384 birds', scene: birds(16384), bar: 16, frames: 4},
];

/* In a worker of the page: opens the scenes with so many threads, and answers each message {index, frames} by ms a frame. */
const WORKER = `
    import {load, World} from '/skein.js';
    const worlds = [];
    onmessage = async ({data}) => {
        if (data.scenes) {
            await load(undefined, {threads: data.threads, environment: data.threads > 1 ? {SKEIN_THREADS: 'always'} : undefined});
            for (const scene of data.scenes) {
                const world = await World.fromScene(scene);
                world.step(30); // out of where it begins
                worlds.push(world);
            }
            postMessage(worlds.map((world) => world.hash()));
            return;
        }
        const start = performance.now();
        worlds[data.index].step(data.frames);
        postMessage((performance.now() - start) / data.frames);
    };`;

const server = await serve(`${root}build/npm/skein`, ISOLATED);
const browser = await chromium.launch({
    executablePath: process.env.CHROMIUM ?? ['/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome'].find(existsSync), args: ['--no-sandbox']});
const page = await browser.newPage();
await page.route('**/', (route) => route.fulfill({contentType: 'text/html', body: '<!doctype html>', headers: ISOLATED}));
await page.route('**/worker.js', (route) => route.fulfill({contentType: 'text/javascript', body: WORKER, headers: ISOLATED}));
await page.goto(server.address);
await page.evaluate(() => {
    globalThis.workers = new Map();
    globalThis.ask = (threads, message) => {
        if (!globalThis.workers.has(threads)) globalThis.workers.set(threads, new Worker('/worker.js', {type: 'module'}));
        const worker = globalThis.workers.get(threads);
        return new Promise((resolve, reject) => {
            worker.onmessage = ({data}) => resolve(data);
            worker.onerror = (event) => reject(new Error(event.message));
            worker.postMessage(message);
        });
    };
});
const ask = (threads, message) => page.evaluate(([t, m]) => globalThis.ask(t, m), [threads, message]);
const two = CASES.filter((c) => c.two), found = CASES.map(() => ({one: Infinity, two: Infinity})), hashes = [];
for (const threads of [1, 2]) hashes.push(await ask(threads, {threads, scenes: (threads === 1 ? CASES : two).map((c) => c.scene)}));
for (let round = 0; round < ROUNDS; round++)
    for (const [index, {frames, two: both}] of CASES.entries()) {
        found[index].one = Math.min(found[index].one, await ask(1, {index, frames}));
        if (both) found[index].two = Math.min(found[index].two, await ask(2, {index: two.indexOf(CASES[index]), frames}));
    }
await browser.close();
server.close();

let good = true;
const row = (name, value, bar, reached) => {
    good &&= reached;
    console.log(`${name.padEnd(34)} ${value.padStart(9)}   ${bar.padEnd(14)} ${reached ? 'reached' : 'missed'}`);
};
for (const [index, {name, bar}] of CASES.entries()) row(`${name}, one thread`, `${found[index].one.toFixed(3)} ms`, `at most ${bar} ms`, found[index].one <= bar);
for (const [index, c] of CASES.entries())
    if (c.two) row(`${c.name}, two threads`, `${(found[index].one / found[index].two).toFixed(2)}x`, 'at least 1.5x', found[index].one >= 1.5 * found[index].two);
row('the same hash by two threads', '', '', two.every((c, k) => hashes[1][k] === hashes[0][CASES.indexOf(c)]));
process.exitCode = good ? 0 : 1;
