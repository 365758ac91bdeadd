// The library's own texts for graphics cards, for WebGL2: what stands in src/ is taken as it is, so that no rule is written
// twice. A .glsl file of a rule is GLSL ES 3.00 already; a marked section of arithmetic (src/base/arithmetic.h) is C, too,
// where 1 may be a number of either kind: its whole numbers get a point. `import text from '.../attraction.c?glsl'` gives it.
import {readFileSync} from 'node:fs';

/* Without comments and what only indents: it goes over the network. */
const bare = (text) => text.replace(/\/\*[^]*?\*\/|\/\/.*/g, '').replace(/^[ \t]+|[ \t]+$/gm, '').replace(/\n+/g, '\n');

/* Each whole number outside of brackets as a float. */
export const floats = (text) =>
    text.replace(/\[[^\]]*\]|\d+[.\d]*(?:[eE][-+]?\d+)?|[A-Za-z_]\w*/g, (word) => (/^\d+$/.test(word) ? `${word}.0` : word));

export function glslOf(path) {
    const text = readFileSync(path, 'utf8');
    if (path.endsWith('.glsl')) return bare(text);
    const section = /^\/\/ ---- arithmetic ----\n([^]*?)^\/\/ ---- end of arithmetic ----$/m.exec(text)?.[1];
    if (!section) throw new Error(`${path} has no section of arithmetic`);
    return floats(bare(section));
}

/* For the bundler. */
export const glsl = {
    name: 'glsl',
    enforce: 'pre',
    load(id) {
        if (!id.endsWith('?glsl')) return null;
        this.addWatchFile(id.slice(0, -5));
        return `export default ${JSON.stringify(glslOf(id.slice(0, -5)))};`;
    },
};
