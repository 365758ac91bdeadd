// Makes docs/images/playground.jpg anew: node playground/picture.mjs [FILE [WIDTH HEIGHT light|dark [ADDRESS]]], once
// tools/playground has built the page.
import {existsSync} from 'node:fs';

import {chromium} from 'playwright-core';

import {serve} from './tests/server.mjs';

const root = new URL('../', import.meta.url).pathname;
const [, , file = `${root}docs/images/playground.jpg`, width = 1200, height = 720, colorScheme = 'light', address = '#scene=drape&frame=100'] = process.argv;
const server = await serve(`${root}build/playground`);
const browser = await chromium.launch({
    executablePath: process.env.CHROMIUM ?? ['/usr/bin/chromium', '/usr/bin/chromium-browser', '/usr/bin/google-chrome'].find(existsSync),
    args: ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'],
});
const page = await browser.newPage({viewport: {width: Number(width), height: Number(height)}, colorScheme});
page.setDefaultTimeout(120000);
await page.goto(server.address + address);
await page.waitForFunction(() => globalThis.skein?.app.state);
await page.evaluate(async () => {
    const {skein} = globalThis, settled = () => new Promise((resolve) => setTimeout(resolve, 600));
    await skein.ready;
    for (let i = 0; i < 14; i++) { // a few frames and measures, so that the plots have something to show
        await skein.run(2);
        await skein.measure();
    }
    await settled();
});
await page.screenshot({path: file, ...(file.endsWith('.jpg') ? {quality: 86} : {})});
await browser.close();
server.close();
