// Static files in build/playground that any server carries, from any folder (relative addresses).
import {defineConfig} from 'vite';

const at = (path) => new URL(path, import.meta.url).pathname;

export default defineConfig({
    base: './',
    resolve: {alias: {skein: at('../build/npm/skein/skein.js')}},
    server: {fs: {allow: [at('..')]}},
    worker: {format: 'es'},
    build: {outDir: at('../build/playground'), emptyOutDir: true, target: 'es2022', chunkSizeWarningLimit: 900},
});
