// Flocks on the card, in Chromium, whose WebGL2 is drawn in software: bird by bird against the processor.
import assert from 'node:assert/strict';
import {existsSync} from 'node:fs';
import {after, before, test} from 'node:test';

import {chromium} from 'playwright-core';

import {ISOLATED, serve} from './server.mjs';

const root = new URL('../../', import.meta.url).pathname;
const browserPath = process.env.CHROMIUM ?? ['/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome'].find(existsSync);
let browser, server;
before(async () => {
    server = await serve(`${root}build/playground`);
    browser = await chromium.launch({executablePath: browserPath, args: ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader']});
});
after(async () => {
    await browser?.close();
    server?.close();
});

async function openPage(hash = '', prepare = () => {}, {address} = server) {
    const context = await browser.newContext({viewport: {width: 800, height: 520}});
    await prepare(context);
    const page = await context.newPage(), errors = [];
    page.setDefaultTimeout(120000);
    page.on('console', (message) => message.type() === 'error' && errors.push(message.text()));
    page.on('pageerror', (error) => errors.push(String(error)));
    await page.goto(address + hash);
    await page.waitForFunction(() => globalThis.skein?.app.state);
    await page.evaluate(() => globalThis.skein.ready);
    return {page, errors, close: () => context.close()};
}
const notice = (page) => page.locator('#notice').textContent();

/* A flock of so many, of about 30 neighbours each, that goes round; `more` are further rules. */
function flying(count, {flocking = {}, more = [], substeps = 1, fps = 60} = {}) {
    const side = 2 * Math.cbrt(count / 7.2);
    return JSON.stringify({
        skein: 1, fps, method: {type: 'symplectic_euler', substeps},
        bodies: [{type: 'flock', name: 'birds', count, spread: [side, side, side], swirl: 4}],
        forces: [
            {type: 'flocking', separation: 0.8, alignment: 0.6, cohesion: 0.6, ...flocking}, {type: 'attraction', centre: [0.5, -0.25, 1]},
            ...more, {type: 'speed_limit', limit: 6}],
    });
}
const side = (count) => 2 * Math.cbrt(count / 7.2);
const hawk = (count, more) => ({type: 'predator', radius: side(count) / 3, line: [0, 0, 2], position: [0.3, 0.2, 0], ...more});

/* Opens a scene and takes a frame by the processor and by the card: how far apart positions and velocities are then at most,
 * and how far the rules took a velocity. */
async function byBoth(page, text, frames = 3) {
    const found = await page.evaluate(async ([scene, on]) => {
        const {skein} = globalThis;
        if (!(await skein.open(null, {text: scene, play: false}))) throw new Error(document.getElementById('notice').textContent);
        await skein.run(on); // out of where they were strewn
        await skein.call('card', true);
        const before = await skein.call('bothEnds'), start = skein.app.state.velocities;
        const [x, v] = [0, 1].map((k) => before[0][k].reduce((most, a, i) => Math.max(most, Math.abs(a - before[1][k][i])), 0));
        return {x, v, moved: before[0][1].reduce((most, a, i) => Math.max(most, Math.abs(a - start[i])), 0)};
    }, [text, frames]);
    return found;
}

test('a frame on the card is the processor\'s to rounding', async (t) => {
    const {page, errors, close} = await openPage('#scene=flag&frame=1');
    const cases = {
        '1 bird': flying(1),
        '33 birds': flying(33, {more: [hawk(33)]}),
        '1,024 birds': flying(1024),
        '1,024 birds within a view, and a hawk': flying(1024, {flocking: {view: 250}, more: [hawk(1024)]}),
        '700 birds by squares, the nearest seven': flying(700, {flocking: {measure: 'distance^2', nearest: 7}}),
        'two rules of a kind, of other reaches': flying(500, {more: [{type: 'flocking', separation: 0.3, alignment: 0, cohesion: 0.2, strength: 3}]}),
        'a hawk that is one of them, in three substeps': flying(400, {more: [hawk(400, {particle: 7, line: [0, 0, 0]})], substeps: 3}),
        'turning, climbing, a wall': flying(400, {more: [{type: 'turn_limit', turn: 60, climb: 20}, {type: 'bounds', size: [6, 7, 5]}]}),
        'in a ball': flying(400, {more: [{type: 'bounds', shape: 'sphere', radius: 3}]}),
        'in at the other side': flying(400, {more: [{type: 'bounds', edge: 'periodic', size: [7, 7, 7]}]}),
        '16,384 birds': flying(16384, {more: [hawk(16384)]}),
    };
    for (const [name, text] of Object.entries(cases))
        await t.test(name, async () => {
            const found = await byBoth(page, text);
            assert.ok(found.moved > 0.01, JSON.stringify(found));
            assert.ok(found.v <= 5e-6 && found.x <= 1e-6, JSON.stringify(found)); // m/s, m; one rounding of 6 m/s is 5e-7
        });
    assert.deepEqual(errors, []);
    await close();
});

test('a text that computes otherwise is found out, whichever it is', async (t) => {
    const count = 400, all = flying(count, {flocking: {view: 250}, more: [hawk(count), {type: 'turn_limit', turn: 60, climb: 20}, {type: 'bounds', size: [6, 7, 5]}]});
    const breaks = {
        flocking: ['-0.5 * cos(', '-0.49 * cos('], walk: ['cz + 1, cells_z - 1', 'cz, cells_z - 1'], attraction: ['square > 0.0, PARAM(dt', 'square < 0.0, PARAM(dt'],
        predator: ['PARAM(p.radius * p.radius) - 1.0', 'PARAM(p.radius * p.radius) - 1.01'], 'speed limit': ['num most = PARAM(p.limit)', 'num most = PARAM(0.99 * p.limit)'],
        'turn limit': ['speed * angle_sine', 'speed * angle_cosine'], bounds: ['pick(leaves, -speed, speed)', 'pick(leaves, -0.9 * speed, speed)'],
    };
    for (const [name, [from, to]] of Object.entries(breaks))
        await t.test(name, async () => {
            let found = 0;
            const {page, close} = await openPage('#scene=flag&frame=1', (context) => context.route('**/assets/card-*.js', async (route) => {
                const answer = await route.fetch(), text = await answer.text();
                found = text.split(from).length - 1; // (it is fetched again, to be kept for offline use)
                await route.fulfill({response: answer, body: text.replaceAll(from, to)});
            }));
            const {v} = await byBoth(page, all);
            assert.ok(found === 1 && v > 1e-4, `${found} ${v}`);
            await close();
        });
});

test('it is chosen in the page, which says what it takes, and is a part of the way', async () => {
    const {page, errors, close} = await openPage('#scene=birds&frame=1');
    const note = () => page.locator('#hash-note').textContent();
    assert.match(await note(), /same hash/);
    await page.locator('#card').click();
    await page.waitForFunction(() => /On the card/.test(document.getElementById('hash-note').textContent));
    assert.match(await note(), /On the card \(.+\) a frame takes [\d.]+ ms, on the processor [\d.]+ ms, and differs by \d?e?[-\d]+ m.*no command has this hash/);
    assert.equal(await page.locator('#card').getAttribute('aria-pressed'), 'true');
    assert.equal(await page.locator('#command').isVisible(), false);
    const run = (frames) => page.evaluate((n) => globalThis.skein.run(n), frames);
    const places = () => page.evaluate(() => globalThis.skein.call('bothEnds').then(([[x]]) => [...x]));
    const {hash} = await run(12), time = await page.evaluate(() => globalThis.skein.app.state.time);
    assert.ok(Math.abs(time - 13 / 60) < 1e-9, `${time}`);
    await run(7);
    await page.evaluate(() => globalThis.skein.seek(13));
    assert.equal(await page.evaluate(() => globalThis.skein.app.state.hash), hash);
    const link = await page.evaluate(() => globalThis.skein.link()), other = await openPage(new URL(link).hash);
    assert.equal(await other.page.evaluate(() => globalThis.skein.app.state.hash), hash);
    assert.equal(await other.page.locator('#card').getAttribute('aria-pressed'), 'true');
    await other.close();
    // a change on the way is the card's, too
    await page.evaluate(() => globalThis.skein.change('forces.3.limit', 4, true));
    await run(1);
    const fastest = await page.evaluate(() => Math.max(...Array.from({length: 1024}, (_, i) => Math.hypot(...globalThis.skein.app.state.velocities.slice(3 * i, 3 * i + 3)))));
    assert.ok(Math.abs(fastest - 4) < 1e-5, `${fastest}`);
    // a hand leads on the processor, and lets go
    const there = (await places()).slice(9, 12).map((x) => x + 1);
    await page.evaluate((place) => globalThis.skein.call('pull', 3, place), there);
    await run(30);
    const led = await page.evaluate(() => [...globalThis.skein.app.state.positions.slice(9, 12)]);
    assert.ok(Math.hypot(...led.map((x, k) => x - there[k])) < 0.5, `${led}, not ${there}`);
    await page.evaluate(() => globalThis.skein.call('letGo'));
    await run(2);
    // anew with a flock of another size, it is chosen still
    await page.evaluate(() => globalThis.skein.change('bodies.0.side', 20, false));
    assert.equal(await page.evaluate(() => globalThis.skein.app.state.onCard), '');
    await run(2);
    await page.locator('#card').click();
    await page.waitForFunction(() => globalThis.skein.app.state.onCard === null);
    assert.deepEqual(errors, []);
    await close();
});

test('where the page has threads, too', async () => {
    const shared = await serve(`${root}build/playground`, ISOLATED);
    const {page, errors, close} = await openPage('#scene=flag&frame=1', () => {}, shared);
    assert.ok((await page.evaluate(() => globalThis.skein.call('threads'))) > 1);
    const found = await byBoth(page, flying(600));
    assert.ok(found.moved > 0.01 && found.v <= 5e-6 && found.x <= 1e-6, JSON.stringify(found));
    assert.deepEqual(errors, []);
    await close();
    shared.close();
});

test('what it does not step is told in words, and goes on on the processor', async () => {
    const {page, errors, close} = await openPage('#scene=gulls&frame=1');
    const choose = async () => {
        await page.locator('#card').click();
        await page.waitForFunction(() => document.getElementById('notice').textContent);
    };
    await choose();
    assert.match(await notice(page), /card does not step this scene: the method is xpbd.*processor/);
    assert.equal(await page.locator('#card').getAttribute('aria-pressed'), 'false');
    await page.evaluate(() => globalThis.skein.open('flag', {play: false}));
    assert.equal(await page.locator('#card').isVisible(), false);
    assert.deepEqual(errors, []);
    await close();
    const bare = await openPage('#scene=birds&frame=1', (context) => context.route('**/assets/card-*.js', async (route) => {
        const answer = await route.fetch();
        await route.fulfill({response: answer, body: (await answer.text()).replace('EXT_color_buffer_float', 'EXT_of_another_card')});
    }));
    await bare.page.locator('#card').click();
    await bare.page.waitForFunction(() => document.getElementById('notice').textContent);
    assert.match(await notice(bare.page), /draws into no textures of floats/);
    assert.equal(await bare.page.evaluate(() => globalThis.skein.app.state.onCard), null);
    await bare.close();
});
