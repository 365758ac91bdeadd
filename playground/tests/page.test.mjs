// The page in Chromium without a screen, drawn in software: tools/test-web builds it and runs this. Hashes are compared
// with the native command's.
import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import {existsSync, mkdirSync} from 'node:fs';
import {after, before, test} from 'node:test';

import {chromium} from 'playwright-core';

import {serve} from './server.mjs';

const root = new URL('../../', import.meta.url).pathname;
const browserPath = process.env.CHROMIUM ?? ['/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome'].find(existsSync);
const native = (args) => {
    const report = execFileSync(`${root}build/skein`, ['run', ...args, '--quiet', '--json'], {cwd: root, stdio: 'pipe'});
    return JSON.parse(report).state_hash;
};
/* The page's own words for the command, as a shell takes them. */
const nativeByShell = (command) => {
    const line = command.replace(/^skein/, `${root}build/skein`) + ' --quiet --json';
    return JSON.parse(execFileSync('sh', ['-c', line], {cwd: root, stdio: 'pipe'})).state_hash;
};

let browser, server;
before(async () => {
    server = await serve(`${root}build/playground`);
    browser = await chromium.launch({
        executablePath: browserPath,
        args: ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'],
    });
    mkdirSync(`${root}build/playground-tests`, {recursive: true});
});
after(async () => {
    await browser?.close();
    server?.close();
});

/* A page of its own; `errors` are what its console complained of. */
async function openPage(hash = '', options = {}) {
    const context = await browser.newContext({viewport: {width: 800, height: 520}, ...options});
    const page = await context.newPage(), errors = [];
    page.setDefaultTimeout(120000);
    page.on('console', (message) => message.type() === 'error' && errors.push(message.text()));
    page.on('pageerror', (error) => errors.push(String(error)));
    await page.goto(server.address + hash);
    await page.waitForFunction(() => globalThis.skein?.app.state);
    await page.evaluate(() => globalThis.skein.ready);
    return {page, errors, close: () => context.close()};
}
const notice = (page) => page.locator('#notice').textContent();

test('each scene opens, runs 60 frames and has native\'s hash', async (t) => {
    const {page, errors, close} = await openPage();
    const names = await page.evaluate(() => [...globalThis.skein.scenes.keys()]);
    assert.ok(names.length >= 26, names.join(' '));
    for (const name of names)
        await t.test(name, async () => {
            const found = await page.evaluate(async (scene) => {
                const good = await globalThis.skein.open(scene, {play: false});
                return good && globalThis.skein.run(60);
            }, name);
            assert.equal(await notice(page), '');
            assert.equal(found.frame * (found.frame === 60), 60);
            assert.equal(found.hash, native([`scenes/${name}.json`, '--frames', '60']));
        });
    assert.deepEqual(errors, []);
    await close();
});

test('the picture shows the cloth, where it is, and it moves', async () => {
    const {page, errors, close} = await openPage('#scene=flag&frame=30');
    // the share of the picture's middle that is of the cloth's colours: reddish or sand, not the sky's
    const red = async () => {
        const shot = (await page.locator('#picture').screenshot()).toString('base64');
        return page.evaluate(async (data) => {
            const image = await createImageBitmap(await (await fetch(`data:image/png;base64,${data}`)).blob());
            const canvas = new OffscreenCanvas(image.width, image.height), c = canvas.getContext('2d');
            c.drawImage(image, 0, 0);
            const {data: pixels} = c.getImageData(0, 0, image.width, image.height);
            let count = 0;
            for (let i = 0; i < pixels.length; i += 4) count += pixels[i] > 1.3 * pixels[i + 2];
            return count / (pixels.length / 4);
        }, shot);
    };
    await page.waitForTimeout(500);
    assert.ok((await red()) > 0.04, `${await red()}`);
    await page.screenshot({path: `${root}build/playground-tests/flag.png`});
    const frame = () => page.evaluate(() => globalThis.skein.app.state.frame);
    const before_ = await frame();
    assert.equal(before_, 30); // a link with a frame stands there
    await page.locator('#play').click();
    await page.waitForFunction((f) => globalThis.skein.app.state.frame > f + 5, before_);
    await page.locator('#play').click();
    assert.deepEqual(errors, []);
    await close();
});

test('a hand drags a corner, which follows, and is pinned', async () => {
    const {page, errors, close} = await openPage('#scene=hanging&frame=10');
    await page.waitForTimeout(300);
    const particle = await page.evaluate(() => globalThis.skein.app.world.count - 1);
    const [x, y] = await page.evaluate((p) => globalThis.skein.picture.onPage(p), particle);
    const place = () => page.evaluate((p) => globalThis.skein.picture.place(p).toArray(), particle);
    const from = await place(), view = await page.evaluate(() => globalThis.skein.picture.camera);
    // the last corner or its neighbour: within the cloth, next to its edge
    const middle = await page.evaluate(() => {
        const box = document.querySelector('#picture canvas').getBoundingClientRect();
        return [box.left + box.width / 2, box.top + box.height / 2];
    });
    const inside = [x + 0.02 * (middle[0] - x), y + 0.02 * (middle[1] - y)];
    await page.mouse.move(...inside);
    await page.mouse.down();
    const pulled = await page.evaluate(() => globalThis.skein.app.pulled);
    assert.ok(pulled !== null);
    await page.mouse.move(inside[0] - 40, inside[1] - 60, {steps: 4});
    await page.evaluate(() => globalThis.skein.run(60));
    const moved = await page.evaluate((p) => globalThis.skein.picture.onPage(p), pulled);
    assert.ok(Math.abs(moved[0] - (inside[0] - 40)) < 25 && Math.abs(moved[1] - (inside[1] - 60)) < 25, `${moved} ${inside}`);
    assert.notDeepEqual(await place(), from);
    assert.deepEqual(await page.evaluate(() => globalThis.skein.picture.camera), view); // the hand turned no camera
    await page.screenshot({path: `${root}build/playground-tests/drag.png`});
    await page.mouse.up();
    assert.match(await page.locator('#hash-note').textContent(), /hand/);
    await page.locator('#pin').click();
    await page.waitForFunction(() => document.getElementById('pin').textContent === 'Free');
    // beside the cloth the same drag turns the view
    await page.mouse.move(30, 120);
    await page.mouse.down();
    await page.mouse.move(130, 140, {steps: 4});
    await page.mouse.up();
    assert.notDeepEqual(await page.evaluate(() => globalThis.skein.picture.camera), view);
    assert.deepEqual(errors, []);
    await close();
});

test('wind by its control, the method, the command and the link give one hash', async () => {
    const {page, errors, close} = await openPage('#scene=flag&frame=5');
    const field = page.locator('.field[data-path="forces.1.velocity"]');
    assert.equal(await field.locator('.unit').textContent(), 'm/s');
    assert.ok((await field.locator('.help').textContent()).length > 10);
    const input = field.locator('input[type=text]').first();
    await input.fill('2.5');
    await input.press('Enter');
    await page.waitForFunction(() => globalThis.skein.app.touched);
    await page.locator('details[data-path=method] > summary').click();
    await page.locator('#method').selectOption('pbd');
    await page.waitForFunction(() => globalThis.skein.app.world.objects.method[0].name === 'pbd');
    const found = await page.evaluate(() => globalThis.skein.run(40));
    await page.waitForFunction(() => globalThis.skein.app.state.frame === 40);
    const {command, link} = await page.evaluate(async () => ({command: globalThis.skein.command(), link: await globalThis.skein.link()}));
    assert.match(command, /--set 'forces\.1\.velocity=\[2\.5,0\.3,1\.8\]'.*--frames 40/);
    assert.equal(await page.locator('#command').textContent(), command);
    assert.equal(nativeByShell(command), found.hash);
    const other = await openPage(new URL(link).hash);
    await other.page.waitForFunction(() => globalThis.skein.app.state.frame === 40);
    assert.equal(await other.page.evaluate(() => globalThis.skein.app.state.hash), found.hash);
    const [a, b] = [await page.evaluate(() => globalThis.skein.picture.camera), await other.page.evaluate(() => globalThis.skein.picture.camera)];
    a.forEach((x, k) => assert.ok(Math.abs(x - b[k]) < 2e-3));
    assert.deepEqual([...errors, ...other.errors], []);
    await other.close();
    await close();
});

test('a formula is typed: a caret under its fault, then it is in the scene, and native agrees', async () => {
    const {page, errors, close} = await openPage('#scene=hanging&frame=1');
    await page.locator('.formula > summary').click();
    const fault = page.locator('#formula-fault');
    await page.locator('#formula-text').fill('length(p0 - p1) - lenght(p0)');
    await page.waitForFunction(() => document.getElementById('formula-fault').textContent.includes('^'));
    const lines = (await fault.textContent()).split('\n'), caret = lines.findIndex((line) => /^ *\^/.test(line));
    assert.ok(lines[caret - 1].slice(lines[caret].indexOf('^')).startsWith('lenght'), lines.join('\n'));
    assert.ok(await page.locator('#formula-add').isDisabled());
    await page.screenshot({path: `${root}build/playground-tests/formula.png`});
    await page.locator('#formula-text').fill('length(p0 - p1) - 0.8 * rest(length(p0 - p1))');
    await page.waitForFunction(() => document.getElementById('formula-fault').textContent === 'It is good.');
    await page.locator('#formula-add').click();
    await page.waitForFunction(() => globalThis.skein.app.world.objects.constraint.length === 1);
    const found = await page.evaluate(() => globalThis.skein.run(30));
    await page.waitForFunction(() => globalThis.skein.app.state.frame === 30);
    assert.equal(nativeByShell(await page.evaluate(() => globalThis.skein.command())), found.hash);
    assert.deepEqual(errors, []);
    await close();
});

test('a broken address says so and leaves a page that works; a field that is wrong changes nothing', async () => {
    const {page, errors, close} = await openPage('#scene=flag&set=forces.9.rate=2');
    assert.match(await notice(page), /forces/);
    assert.equal(await page.evaluate(() => globalThis.skein.app.scene), 'flag');
    await page.evaluate(() => globalThis.skein.call('play', false));
    const before_ = await page.evaluate(() => globalThis.skein.command());
    await page.evaluate(() => globalThis.skein.change('forces.1.drag', -5, true));
    assert.match(await notice(page), /drag/);
    assert.equal((await page.evaluate(() => globalThis.skein.command())).includes('drag=-5'), false, before_);
    await page.evaluate(() => (location.hash = '#text=%%%'));
    await page.waitForFunction(() => /address/.test(document.getElementById('notice').textContent));
    assert.deepEqual(errors, []);
    await close();
});

test('dark, on a phone, by touch and by keys', async () => {
    const {page, errors, close} = await openPage('#scene=birds&frame=20', {colorScheme: 'dark', viewport: {width: 390, height: 700}, hasTouch: true});
    assert.ok(await page.evaluate(() => document.documentElement.classList.contains('dark')));
    assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth));
    await page.locator('#picture').focus();
    await page.keyboard.press('ArrowRight');
    await page.waitForFunction(() => globalThis.skein.app.state.frame === 21);
    await page.waitForTimeout(500);
    await page.screenshot({path: `${root}build/playground-tests/phone.png`});
    await page.locator('#gallery-open').tap();
    assert.ok((await page.locator('.cards button').count()) >= 26);
    await page.locator('.cards button', {hasText: 'drape'}).first().tap();
    await page.waitForFunction(() => globalThis.skein.app.scene === 'drape');
    assert.deepEqual(errors, []);
    await close();
});
