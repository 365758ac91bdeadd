// Static files in build/playground that any server carries, from any folder (relative addresses): the page, the element
// <skein-scene> as skein-scene.js, and sw.js, which keeps all of it for when there is no network.
import {createHash} from 'node:crypto';
import {readFileSync} from 'node:fs';

import {defineConfig} from 'vite';

import {glsl} from './glsl.mjs';

const at = (path) => new URL(path, import.meta.url).pathname;

/* The service worker, with the names of all files and a name of its own for each build. */
const offline = {
    name: 'offline',
    generateBundle(_, bundle) {
        const files = ['./', ...Object.keys(bundle).filter((name) => name !== 'index.html')];
        const version = createHash('sha256').update(JSON.stringify(files)).update(bundle['index.html']?.source ?? '').digest('hex').slice(0, 16);
        const source = readFileSync(at('src/sw.js'), 'utf8').replace('@FILES@', JSON.stringify(files)).replace('@VERSION@', version);
        this.emitFile({type: 'asset', fileName: 'sw.js', source});
    },
};

export default defineConfig({
    base: './',
    resolve: {alias: {skein: at('../build/npm/skein/skein.js')}},
    server: {fs: {allow: [at('..')]}},
    worker: {format: 'es', plugins: () => [glsl]},
    plugins: [offline],
    build: {
        outDir: at('../build/playground'), emptyOutDir: true, target: 'es2022', chunkSizeWarningLimit: 900, assetsInlineLimit: 0,
        rollupOptions: {
            input: {index: at('index.html'), 'skein-scene': at('src/element.js')},
            preserveEntrySignatures: 'allow-extension',
            output: {entryFileNames: ({name}) => (name === 'skein-scene' ? 'skein-scene.js' : 'assets/[name]-[hash].js')},
        },
    },
});
