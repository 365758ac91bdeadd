// Long play in Chromium: a flag is played, picked up and let go, run back and forth for so many minutes (the first argument; 20),
// with rows of what the page holds each minute: `tools/test-web --long [MINUTES]`. Fails where memory grows: the most that is held
// in the second half, after the collection of garbage, may be a tenth and 4 MB over the most in the first. (Snapshots to go back to
// take up to 128 MB, and then every second one goes.)
import assert from 'node:assert/strict';
import {readdirSync, readFileSync} from 'node:fs';

import {chromium} from 'playwright-core';

import {serve} from './server.mjs';

const root = new URL('../../', import.meta.url).pathname, minutes = Number(process.argv[2] ?? 20);
const server = await serve(`${root}build/playground`);
const browser = await chromium.launch({
    executablePath: process.env.CHROMIUM,
    args: ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'],
});
const page = await browser.newPage({viewport: {width: 640, height: 420}}), errors = [];
page.on('console', (message) => message.type() === 'error' && errors.push(message.text()));
page.on('pageerror', (error) => errors.push(String(error)));
await page.goto(server.address);
await page.waitForFunction(() => globalThis.skein?.app.state);
await page.evaluate(() => globalThis.skein.ready);
const session = await page.context().newCDPSession(page);

/* Resident megabytes of the process that draws and simulates the page: the largest of Chromium's renderers. */
function resident() {
    let most = 0;
    for (const name of readdirSync('/proc'))
        if (/^\d+$/.test(name))
            try {
                if (readFileSync(`/proc/${name}/cmdline`, 'utf8').includes('--type=renderer'))
                    most = Math.max(most, Number(/VmRSS:\s*(\d+)/.exec(readFileSync(`/proc/${name}/status`, 'utf8'))[1]) / 1024);
            } catch {
                // a process that has gone in between
            }
    return most;
}

async function sample() {
    await session.send('HeapProfiler.collectGarbage');
    return {heap: (await session.send('Runtime.getHeapUsage')).usedSize / 1048576, resident: resident(), frame: await page.evaluate(() => globalThis.skein.app.state.frame)};
}

await page.evaluate(() => globalThis.skein.open('flag', {play: true}));
console.log('minute  frame  JavaScript MB  process MB');
const rows = [], begin = Date.now();
const box = await page.locator('#picture').boundingBox();
for (let minute = 0; minute <= minutes; minute++) {
    while (Date.now() < begin + minute * 60000) {
        // a hand that takes hold of the middle, pulls and lets go
        await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
        await page.mouse.down();
        for (let i = 1; i <= 5; i++) await page.mouse.move(box.x + box.width * (0.5 + 0.03 * i), box.y + box.height * 0.5), await page.waitForTimeout(100);
        await page.mouse.up();
        await page.waitForTimeout(2000);
    }
    const row = await sample();
    rows.push(row);
    console.log(`${String(minute).padStart(6)} ${String(row.frame).padStart(6)} ${row.heap.toFixed(2).padStart(14)} ${row.resident.toFixed(1).padStart(11)}`);
}
await browser.close();
server.close();
assert.deepEqual(errors, []);
const {frame} = rows.at(-1), half = Math.ceil(rows.length / 2), most = (some, what) => Math.max(...some.map((row) => row[what]));
assert.ok(frame > 60 * minutes, `${frame} frames in ${minutes} minutes`);
for (const what of ['heap', 'resident']) {
    const early = most(rows.slice(0, half), what), late = most(rows.slice(half), what);
    assert.ok(late <= 1.1 * early + 4, `${what}: ${early} MB, then ${late} MB`);
}
