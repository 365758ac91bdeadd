// Makes what follows from the header and the tables: layout.js (where skein_statistics has its members) and skein.d.ts
// (skein.d.ts.in, with the members of statistics and the fields of all kinds): node make-types.mjs SKEIN.H KINDS.JSON FOLDER
// KINDS.JSON is what `skein list --json` prints.
import {readFileSync, writeFileSync} from 'node:fs';

const [header, tables, folder] = process.argv.slice(2);
if (!folder) throw new Error('usage: node make-types.mjs SKEIN.H KINDS.JSON FOLDER');
const here = new URL('.', import.meta.url);
const camel = (name) => name.replace(/_(\w)/g, (_, letter) => letter.toUpperCase());

/* ---- the struct, as WebAssembly lays it out ---- */

const sizes = {uint64_t: ['u64', 8, 8], double: ['f64', 8, 8], size_t: ['u32', 4, 4]};
const body = /typedef struct skein_statistics \{([\s\S]*?)\} skein_statistics;/.exec(readFileSync(header, 'utf8'))[1];
const members = [];
let offset = 0;
for (const [, type, names, comment] of body.matchAll(/(uint64_t|double|size_t) ([^;]+);(?:\s*\/\*([\s\S]*?)\*\/)?/g)) {
    for (const declared of names.split(',').map((s) => s.trim())) {
        const [, name, count] = /^(\w+)(?:\[(\d+)\])?$/.exec(declared);
        const [kind, size, alignment] = sizes[type];
        offset = Math.ceil(offset / alignment) * alignment;
        members.push({
            name: camel(name), offset, help: (comment ?? '').replace(/\s+/g, ' ').trim(),
            type: name === 'state_hash' ? 'hash' : kind + (count ? `x${count}` : ''),
        });
        offset += size * Number(count ?? 1);
    }
}
writeFileSync(
    `${folder}/layout.js`,
    '// Made by make-types.mjs from include/skein/skein.h: where skein_statistics has its members.\nexport const STATISTICS = [\n' +
        members.map((m) => `    ['${m.name}', ${m.offset}, '${m.type}'],\n`).join('') + '];\n');

/* ---- the types ---- */

const js = {hash: 'string', f64x3: '[number, number, number]'};
const statistics = members.map((m) => (m.help ? `    /** ${m.help} */\n` : '') + `    ${m.name}: ${js[m.type] ?? 'number'};\n`);

const types = {
    bool: 'boolean', int: 'number', real: 'number', int2: '[number, number]', int3: '[number, number, number]',
    real2: '[number, number]', vec3: '[number, number, number]', text: 'string | unknown[] | object',
};
const typeOf = (field) => {
    if (field.type === 'choice') return field.choices.map((word) => `'${word}'`).join(' | ');
    return types[field.type] + (field.most === 'infinite' ? " | 'infinite'" : '');
};
const quoted = (text) => text.replace(/\*\//g, '* /');

/* Fields with dots are objects in objects. */
function group(fields) {
    const tree = new Map();
    for (const field of fields) {
        let at = tree;
        const parts = field.name.split('.');
        for (const part of parts.slice(0, -1)) {
            if (!(at.get(part) instanceof Map)) at.set(part, new Map());
            at = at.get(part);
        }
        at.set(parts.at(-1), field);
    }
    return tree;
}
function members_of(tree, indent) {
    let out = '';
    for (const [name, at] of tree) {
        const key = name === '*' ? '[name: string]' : `${name}?`;
        if (at instanceof Map) out += `${indent}${key}: {\n${members_of(at, indent + '    ')}${indent}};\n`;
        else {
            const unit = at.unit ? ` (${at.unit})` : '', initial = JSON.stringify(at.default);
            out += `${indent}/** ${quoted(at.help)}${unit}${at.default === null ? '' : `; ${quoted(initial)} by default`} */\n`;
            out += `${indent}${key}: ${name === '*' ? 'number' : typeOf(at)};\n`;
        }
    }
    return out;
}
const titles = {
    bodies: 'Body', constraints: 'Constraint', forces: 'Force', colliders: 'Collider', motions: 'Motion', methods: 'Method',
};
const extra = {
    bodies: "    /** a mesh's path among the files given, where the kind takes one */\n    mesh?: string;\n",
    constraints: "    /** lists of indices, or a body's elements */\n    particles: number[] | number[][] | {body: string | number; over: 'edges' | 'triangles' | 'hinges'};\n",
};
let text = '';
const document = JSON.parse(readFileSync(tables, 'utf8'));
for (const [list, title] of Object.entries(titles)) {
    const names = [];
    for (const kind of document[list]) {
        const name = camel(`_${kind.name}`) + title, tree = group(kind.fields);
        names.push(name);
        if (tree.has('mesh') || list !== 'bodies') text += '';
        const own = tree.has('mesh') && list === 'bodies' ? '' : extra[list] ?? '';
        text += `/** ${quoted(kind.help)} */\nexport interface ${name} {\n    type: '${kind.name}';\n${own}${members_of(tree, '    ')}}\n`;
    }
    text += `export type ${title} = ${names.join(' | ')};\n\n`;
}
/* The method is a kind; what a scene says of it besides stands beside the kind's own fields. */
function scene_members(fields) {
    const tree = group(fields), beside = tree.get('method');
    tree.delete('method');
    return `${members_of(tree, '    ')}    method?: Method${beside ? ` & {\n${members_of(beside, '        ')}    }` : ''};\n`;
}
const scene = document.scene ? [document.scene].flat()[0] : null;
const declared = readFileSync(new URL('skein.d.ts.in', here), 'utf8')
    .replace('@STATISTICS@', () => statistics.join(''))
    .replace('@KINDS@', () => text)
    .replace('@SCENE@', () => scene_members(scene ? scene.fields : []));
writeFileSync(`${folder}/skein.d.ts`, declared);
