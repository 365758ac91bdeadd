// Judges GLB files by Khronos's gltf-validator: node check_glb.cjs MODULES FILE... Fails on any error or warning.
const { createRequire } = require('module');
const { readFileSync } = require('fs');
const { resolve } = require('path');
const [modules, ...files] = process.argv.slice(2);
const validator = createRequire(resolve(modules) + '/')('gltf-validator');

async function check(file) {
    const report = await validator.validateBytes(new Uint8Array(readFileSync(file)));
    const { numErrors, numWarnings, messages } = report.issues;
    console.log(`${file}: ${numErrors} errors, ${numWarnings} warnings; ` +
        `${report.info.totalVertexCount} vertices, ${report.info.totalTriangleCount} triangles`);
    for (const m of messages.slice(0, 10)) console.log(`  ${m.code} ${m.pointer}: ${m.message}`);
    return numErrors + numWarnings === 0;
}

Promise.all(files.map(check)).then((good) => process.exit(files.length && good.every(Boolean) ? 0 : 1));
