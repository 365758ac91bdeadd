// Reads USD text by three.js's parser and loader: node check_usda.mjs MODULES FOLDER NAME UP SCALE FPS
// FOLDER has NAME.usda and NAME.pc2 of the same run. All samples must agree to the bit, and what the header says with UP,
// SCALE and FPS; what the loader makes of the first frame must lie in metres with y up.
import { readFileSync } from 'fs';
import { resolve } from 'path';
import { pathToFileURL } from 'url';

const [modules, folder, name, up, scale, fps] = process.argv.slice(2);
const loaders = pathToFileURL(resolve(modules, 'node_modules/three/examples/jsm/loaders')).href;
const { USDAParser } = await import(loaders + '/usd/USDAParser.js');
const { USDLoader } = await import(loaders + '/USDLoader.js');

let faults = 0;
function expect(good, words) {
    if (good) return;
    if (faults++ < 10) console.log(`${folder}/${name}.usda: ${words}`);
}
const same = (a, b) => a !== undefined && a.length === b.length && b.every((x, i) => Math.fround(a[i]) === x);

// The point cache: 32 bytes of header, then samples.
const cache = readFileSync(`${folder}/${name}.pc2`);
const points = cache.readUInt32LE(16), every = cache.readFloatLE(24), samples = cache.readUInt32LE(28);
const sample = (s) => Array.from({ length: 3 * points }, (_, i) => cache.readFloatLE(32 + 4 * (3 * points * s + i)));

const text = readFileSync(`${folder}/${name}.usda`, 'utf8');
const { specsByPath } = new USDAParser().parseData(text);
const head = specsByPath['/'].fields, prim = head.defaultPrim;
const of = (attribute) => specsByPath[`/${prim}.${attribute}`]?.fields;
expect(head.upAxis === up.toUpperCase(), `upAxis is ${head.upAxis}`);
expect(Math.abs(head.metersPerUnit * scale - 1) < 1e-12, `metersPerUnit is ${head.metersPerUnit}`);
expect(head.timeCodesPerSecond === Number(fps), `timeCodesPerSecond is ${head.timeCodesPerSecond}`);
const { times, values } = of('points').timeSamples;
expect(times.length === samples, `${times.length} samples of points, ${samples} in the cache`);
values.forEach((value, s) => {
    expect(times[s] === s * every, `sample ${s} is at ${times[s]}`);
    expect(same(value, sample(s)), `sample ${s} is another one than the cache's`);
});
expect(text.includes(`\n    endTimeCode = ${(samples - 1) * every} `), 'endTimeCode');

const is_mesh = specsByPath[`/${prim}`].fields.typeName === 'Mesh';
if (is_mesh) {
    const counts = of('faceVertexCounts').default, corners = of('faceVertexIndices').default;
    expect(counts.reduce((a, b) => a + b, 0) === corners.length, 'counts and corners of faces');
    expect(corners.every((c) => c >= 0 && c < points), 'corners');
    const normals = of('normals').timeSamples.values;
    expect(normals.length === samples, 'samples of normals');
    for (const n of normals)
        for (let i = 0; i < n.length; i += 3)
            expect(Math.abs(Math.hypot(n[i], n[i + 1], n[i + 2]) - 1) < 1e-6, 'a normal is not of length 1');
    // the loader cuts faces into triangles and turns the whole
    const group = new USDLoader().parse(text);
    group.updateMatrixWorld(true);
    const mesh = group.getObjectByProperty('isMesh', true);
    const triangles = counts.reduce((a, b) => a + b - 2, 0);
    expect(mesh.geometry.attributes.position.count === 3 * triangles, `${triangles} triangles`);
    expect(!of('primvars:st') || mesh.geometry.attributes.uv !== undefined, 'texture coordinates');
    const first = sample(0), v = mesh.geometry.attributes.position.clone().applyMatrix4(mesh.matrixWorld);
    for (let k = 0; k < 3; k++) { // of the first face its first corner
        const raw = (axis) => first[3 * corners[0] + axis] / scale;
        const metres = up === 'z' ? [raw(0), raw(2), -raw(1)] : [raw(0), raw(1), raw(2)];
        expect(Math.abs(v.array[k] - metres[k]) < 1e-5, `the loader has ${v.array.slice(0, 3)}, not ${metres}`);
    }
}
console.log(`${folder}/${name}.usda: ${samples} samples of ${points} points, ${faults} faults`);
process.exit(faults ? 1 : 0);
