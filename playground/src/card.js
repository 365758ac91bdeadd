// Flocks on the graphics card, in WebGL2, which has no compute shaders: a counting sort puts the birds into cells here, then
// one pass of a fragment shader, a bird each, walks the cells and gives the new positions and velocities, which come back.
// The rules' arithmetic and the walk are the library's own texts (../glsl.mjs). What a card adds up it adds in another order
// than the processor: both agree to rounding, not in every bit.
import arithmetic from '../../src/base/arithmetic.glsl?glsl';
import attraction from '../../src/forces/attraction.c?glsl';
import bounds from '../../src/forces/bounds.c?glsl';
import flocking from '../../src/forces/flocking.glsl?glsl';
import predator from '../../src/forces/predator.c?glsl';
import speedLimit from '../../src/forces/speed_limit.c?glsl';
import turnLimit from '../../src/forces/turn_limit.c?glsl';
import walk from '../../src/gpu/walk.glsl?glsl';

const TEXTS = {attraction, predator, speed_limit: speedLimit, turn_limit: turnLimit, bounds};
const STEERS = ['attraction', 'predator'];
const WIDE = 256; // texels of a row: a bird or a cell each

/* What the walk reads, as src/gpu/neighbours.glsl has it for OpenGL 4.5; directions need no packing here. */
const READING = `
uniform sampler2D positions, velocities, directions;
uniform highp usampler2D cells;
uniform uint cell_count;
uniform float per_size, per_size_x, origin_x, origin_y, origin_z, size;
uniform int cells_x, cells_y, cells_z;
ivec2 texel(int k) { return ivec2(k & ${WIDE - 1}, k / ${WIDE}); }
uint cell_at(int k) { return texelFetch(cells, texel(k), 0).x; }
uint cell_at(uint k) { return cell_at(int(k)); }
vec4 position_at(int k) { return texelFetch(positions, texel(k), 0); }
vec3 unpacked(float place) { return texelFetch(directions, texel(int(place)), 0).xyz; }
int clamped(float place, int most) { return place < 0.0 ? 0 : place >= float(most) ? most - 1 : int(place); }
int findLSB(uint bits) { return int(floatBitsToUint(float(bits & (~bits + 1u))) >> 23) - 127; }
#define BY_PLACE 1
`;
/* Cards need not know their cosines: SwiftShader's are off by a thousandth, which shows. These are off by 4e-7, by the
 * polynomial of src/forces/flocking.h. */
const COSINES = `
float exact_cos(float x) {
    float t = 0.159154943 * x, s;
    t -= floor(t + 0.5);
    s = t * t;
    return 0.999999989 - s * (19.7392045 + s * (-64.9391159 + s * (85.4501134 + s * (-60.1674298 + s * (25.9668846 - 6.52770596 * s)))));
}
#define cos(x) exact_cos(x)
#define sin(x) exact_cos((x) - 1.57079633)
`;
const CORNERS = `#version 300 es
void main() { gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0.0, 1.0); }`;

/* ---- what a scene asks for ---- */

const value = (object, name) => object.fields.find((f) => f.name === name)?.value;
const numbers = ({type, value: given, choices}) =>
    type === 'vec3' ? given : [type === 'choice' ? choices.indexOf(given) : given === 'infinite' ? Infinity : Number(given)];
/* The fields that are numbers, as the struct of a kind's parameters has them (src/gpu/ops.c). */
const fieldsOf = (force) => force.fields.filter((f) => 'value' in f && f.type !== 'text' && !/[.*]/.test(f.name));

/* As sk_flocking_numbers_of() in src/forces/flocking.c has them. */
function flockingNumbers(force) {
    const [separation, alignment, cohesion, view] = ['separation', 'alignment', 'cohesion', 'view'].map((name) => value(force, name));
    const reach = separation + alignment + cohesion, away = separation / reach, along = (separation + alignment) / reach;
    const block = [
        1 / reach, away, along, alignment > 0 ? 1 / (along - away) : 0,
        cohesion > 0 ? 1 / (1 - along) : 0, 1e-4 * reach, value(force, 'strength'), Number(value(force, 'measure') !== 'distance'),
        view >= 360 ? -2 : Math.cos((view * Math.PI) / 360), 0, 0, 0];
    return {reach, block};
}

/* The rules of a scene that the card steps as symplectic Euler does: those that look at neighbours, then those that steer,
 * then those that bound, each in the scene's order (src/methods/plan_builder_steer.c). Else throws why not. */
function rulesOf(world) {
    const [method] = world.objects('method'), bodies = world.objects('body');
    if (method.name !== 'symplectic_euler') throw new Error(`the method is ${method.name}, and the card has symplectic_euler`);
    if (bodies.length !== 1 || bodies[0].name !== 'flock' || value(bodies[0], 'enabled') === false) throw new Error('it takes a scene of one flock and no other body');
    for (const category of ['constraint', 'collider', 'motion'])
        if (world.objects(category).length) throw new Error(`it has no ${category}s`);
    const rules = [];
    for (const force of world.objects('force')) {
        if (value(force, 'enabled') === false) continue;
        const name = value(force, 'name') || force.name, around = ['on', 'neighbours'].map((f) => value(force, f)).filter(Boolean);
        if (around.some((text) => text !== value(bodies[0], 'name'))) throw new Error(`${name} is not about the whole flock`);
        if (force.name === 'flocking') {
            if (value(force, 'formula.towards') || value(force, 'formula.along')) throw new Error(`${name} is by formulas, and the card has the zones`);
            const {reach, block} = flockingNumbers(force);
            if (reach > 0) rules.push({kind: 'flocking', phase: 0, reach, block, nearest: value(force, 'nearest')});
        } else if (TEXTS[force.name]) {
            const fields = fieldsOf(force), block = fields.flatMap(numbers);
            const shifts = force.name === 'bounds' && value(force, 'edge') === 'periodic';
            rules.push({kind: force.name, phase: STEERS.includes(force.name) ? 1 : 2, fields, block, shifts, reach: 0, particle: value(force, 'particle') ?? -1});
        } else throw new Error(`it has no ${force.name}, but the rules of flocks alone`);
    }
    return {substeps: value(method, 'substeps'), rules: rules.sort((a, b) => a.phase - b.phase)};
}

/* ---- the shader ---- */

const numbered = (text, n) => text.replaceAll('@', n);

/* A rule's uniforms and functions; arithmetic once for all rules of a kind. */
function functionsOf({kind, fields, block, nearest}, n, there) {
    const uniforms = `uniform vec4 op${n}[2];\nuniform vec4 rule${n}[${Math.ceil(block.length / 4)}];\nuniform int target${n};\n`;
    if (kind === 'flocking') return uniforms + (nearest ? `#define MOST${n} ${nearest}\n` : '') + numbered(flocking + walk, n);
    let at = 0;
    const one = () => `rule${n}[${at >> 2}][${at++ & 3}]`, wide = (f) => f.type === 'vec3';
    const struct = `struct ${kind}_params {\n${fields.map((f) => `${wide(f) ? 'vec3' : 'float'} ${f.name};\n`).join('')}};\n`;
    const given = fields.map((f) => (wide(f) ? `vec3(${one()}, ${one()}, ${one()})` : one()));
    return `${uniforms}${there ? '' : struct + TEXTS[kind]}${kind}_params params${n}() { return ${kind}_params(${given.join(', ')}); }\n`;
}

/* As the statements of src/plan/op_types.c have it. */
function statementOf({kind, phase, shifts, particle}, n, steered) {
    if (phase === 0) return `S.xyz += walk${n}(place, X.xyz, V.xyz);\n`;
    const mine = particle >= 0 ? `if (int(place) != target${n}) ` : '';
    if (phase === 1) return `${mine}S += ${kind}_steer(params${n}(), X.xyz, op${n}[0].w);\n`;
    if (shifts) return `if (X.w > 0.0) X.xyz += ${kind}_shift(params${n}(), X.xyz);\n`;
    return `V.xyz = ${kind}_bound(params${n}(), X, V.xyz, ${steered ? 'S' : 'vec4(0.0)'}, op${n}[0].w);\n`;
}

function shaderOf(rules) {
    const steered = rules.some(({phase}) => phase < 2), steering = rules.filter(({phase}) => phase < 2).length;
    const statements = rules.map((rule, n) => statementOf(rule, n, steered));
    return `#version 300 es
precision highp float;
precision highp int;
precision highp sampler2D;
${arithmetic}${READING}${COSINES}
uniform float step_size;
layout(location = 0) out vec4 new_position;
layout(location = 1) out vec4 new_velocity;
${rules.map((rule, n) => functionsOf(rule, n, rules.findIndex(({kind}) => kind === rule.kind) < n)).join('')}
void main() {
    int k = int(gl_FragCoord.y) * ${WIDE} + int(gl_FragCoord.x);
    uint place = uint(k);
    vec4 moving = texelFetch(velocities, texel(k), 0); // who is held has its mass with a minus
    vec4 X = vec4(position_at(k).xyz, moving.w > 0.0 ? 1.0 / moving.w : 0.0), V = vec4(moving.xyz, abs(moving.w)), S = vec4(0.0);
    ${statements.slice(0, steering).join('    ')}    if (X.w > 0.0) V.xyz += S.xyz;
    ${statements.slice(steering).join('    ')}    X.xyz = X.xyz + step_size * V.xyz;
    new_position = X;
    new_velocity = V;
}`;
}

/* ---- cells ---- */

/* A counting sort into cells as wide as the reach along y and z, and four times finer along x where there is room, as
 * src/gpu/grid_*.glsl have it: in floats, so that the walk's cells are these. */
class Cells {
    constructor(count) {
        this.room = Math.ceil(count / 4096 + 1) * 4096;
        this.starts = new Uint32Array(Math.ceil((this.room + 2) / WIDE) * WIDE);
        this.order = new Uint32Array(count);
        this.cell = new Uint32Array(count);
        this.counts = [1, 1, 1];
        this.origin = [0, 0, 0];
    }
    #frame(x, radius) {
        const least = [Infinity, Infinity, Infinity], most = [-Infinity, -Infinity, -Infinity];
        for (let i = 0; i < x.length; i += 3)
            for (let k = 0; k < 3; k++) {
                const at = x[i + k];
                if (at < least[k]) least[k] = at;
                if (at > most[k]) most[k] = at;
            }
        let size = Math.fround(radius || 1), fine = 4;
        for (;;) {
            this.counts = [0, 1, 2].map((k) => Math.floor(((most[k] - least[k]) / size) * (k ? 1 : fine)) + 1);
            if (this.counts[0] * this.counts[1] * this.counts[2] <= this.room) break;
            if (fine > 1) fine /= 2;
            else size = Math.fround(size * 1.25);
        }
        this.count = this.counts[0] * this.counts[1] * this.counts[2];
        this.origin = least;
        this.size = size;
        this.per = [Math.fround(fine / size), Math.fround(1 / size)];
    }
    sort(x, radius) {
        this.#frame(x, radius);
        const {fround} = Math, {starts, order, cell, count} = this, [nx, ny, nz] = this.counts, [ox, oy, oz] = this.origin, [px, p] = this.per;
        starts.fill(0, 0, count + 2);
        for (let i = 0, at = 0; i < cell.length; i++, at += 3) {
            const a = Math.min(fround(fround(x[at] - ox) * px) | 0, nx - 1), b = Math.min(fround(fround(x[at + 1] - oy) * p) | 0, ny - 1);
            const c = (Math.min(fround(fround(x[at + 2] - oz) * p) | 0, nz - 1) * ny + b) * nx + a;
            cell[i] = c;
            starts[c]++;
        }
        let before = 0;
        for (let c = 0; c <= count + 1; c++) {
            before += starts[c];
            starts[c] = before;
        }
        for (let i = cell.length - 1; i >= 0; i--) order[--starts[cell[i]]] = i; // within a cell by number
    }
}

/* ---- the card ---- */

const NAMES = ['positions', 'velocities', 'directions'];

export class Card {
    #gl;
    #programs = new Map();
    #plan = null; // of a world as it is: forgotten when something is changed
    #world = null;
    #textures = {};
    #frame = null;
    #count = 0;

    /* Throws in words why there is none. */
    constructor() {
        const gl = typeof OffscreenCanvas === 'undefined' ? null : new OffscreenCanvas(1, 1).getContext('webgl2', {antialias: false, depth: false, powerPreference: 'high-performance'});
        if (!gl) throw new Error('this browser has no WebGL2 for a worker');
        if (!gl.getExtension('EXT_color_buffer_float')) throw new Error('this card draws into no textures of floats');
        this.#gl = gl;
        this.name = gl.getParameter(gl.getExtension('WEBGL_debug_renderer_info')?.UNMASKED_RENDERER_WEBGL ?? gl.RENDERER);
    }

    /* The world was changed by someone else than step(). */
    forget() {
        this.#plan = null;
    }
    /* Why it cannot step this world, or '' where it can. */
    why(world) {
        if (world !== this.#world) this.#plan = null;
        this.#world = world;
        try {
            this.#plan ??= this.#look(world);
            return '';
        } catch (error) {
            return error.message;
        }
    }

    #look(world) {
        const {substeps, rules} = rulesOf(world), {count} = world, text = shaderOf(rules);
        if (count !== this.#count) this.#make(count);
        if (!this.#programs.has(text)) this.#programs.set(text, this.#compile(text));
        const places = world.positionSlots, masses = world.velocitySlots, weights = new Float32Array(count);
        world.slotOf.forEach((slot, i) => (weights[i] = places[4 * slot + 3] > 0 ? masses[4 * slot + 3] : -masses[4 * slot + 3]));
        return {substeps, rules, program: this.#programs.get(text), weights, reach: Math.max(0, ...rules.map((rule) => rule.reach))};
    }
    #compile(text) {
        const gl = this.#gl, program = gl.createProgram();
        for (const [type, source] of [[gl.VERTEX_SHADER, CORNERS], [gl.FRAGMENT_SHADER, text]]) {
            const shader = gl.createShader(type);
            gl.shaderSource(shader, source);
            gl.compileShader(shader);
            gl.attachShader(program, shader);
            if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(`the card's compiler: ${gl.getShaderInfoLog(shader)}`);
        }
        gl.linkProgram(program);
        if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(`the card's linker: ${gl.getProgramInfoLog(program)}`);
        return program;
    }

    #texture(format, rows) {
        const gl = this.#gl, texture = gl.createTexture();
        gl.bindTexture(gl.TEXTURE_2D, texture);
        gl.texStorage2D(gl.TEXTURE_2D, 1, format, WIDE, rows);
        for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, filter, gl.NEAREST);
        return texture;
    }
    #make(count) {
        const gl = this.#gl, rows = Math.ceil((count + 4) / WIDE); // the walk reads up to three behind the last
        const cells = new Cells(count), most = gl.getParameter(gl.MAX_TEXTURE_SIZE);
        if (Math.max(rows, cells.starts.length / WIDE) > most) throw new Error(`it has room for ${(most - 32) * WIDE} birds`);
        for (const texture of Object.values(this.#textures)) gl.deleteTexture(texture);
        for (const name of [...NAMES, 'new_positions', 'new_velocities']) this.#textures[name] = this.#texture(gl.RGBA32F, rows);
        this.#textures.cells = this.#texture(gl.R32UI, cells.starts.length / WIDE);
        this.#frame ??= gl.createFramebuffer();
        gl.bindFramebuffer(gl.FRAMEBUFFER, this.#frame);
        ['new_positions', 'new_velocities'].forEach((name, i) =>
            gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0 + i, gl.TEXTURE_2D, this.#textures[name], 0));
        gl.drawBuffers([gl.COLOR_ATTACHMENT0, gl.COLOR_ATTACHMENT1]);
        if (gl.checkFramebufferStatus(gl.FRAMEBUFFER) !== gl.FRAMEBUFFER_COMPLETE) throw new Error('this card does not draw into two textures of floats');
        gl.viewport(0, 0, WIDE, rows);
        this.cells = cells;
        this.rows = rows;
        this.arrays = Object.fromEntries(NAMES.map((name) => [name, new Float32Array(4 * WIDE * rows)]));
        this.#count = count;
    }

    /* A frame on. The caller has asked why() before. */
    step(world) {
        const {stepsPerFrame, dt} = world.settings, {substeps} = this.#plan;
        const x = world.positions.slice(), v = world.velocities.slice();
        let {time} = world;
        for (let step = 0; step < stepsPerFrame; step++, time += dt)
            for (let i = 0; i < substeps; i++) this.#substep(x, v, dt / substeps);
        world.setPositions(x);
        world.setVelocities(v);
        world.time = time;
    }

    #substep(x, v, h) {
        const gl = this.#gl, {reach} = this.#plan, {cells} = this;
        cells.sort(x, reach);
        this.#send(x, v);
        this.#say(x, h);
        gl.drawArrays(gl.TRIANGLES, 0, 3);
        this.#take(gl.COLOR_ATTACHMENT0, this.arrays.positions, x);
        this.#take(gl.COLOR_ATTACHMENT1, this.arrays.velocities, v);
        if (gl.isContextLost()) throw new Error('the graphics card was lost: load the page again');
    }
    /* The birds in the order of their cells, and where each cell begins. */
    #send(x, v) {
        const gl = this.#gl, {weights} = this.#plan, {cells: {order, starts, count}} = this, {positions, velocities, directions} = this.arrays;
        for (let place = 0, at = 0; place < order.length; place++, at += 4) {
            const i = order[place], j = 3 * i, a = v[j], b = v[j + 1], c = v[j + 2], speed = Math.sqrt(a * a + b * b + c * c), per = speed > 0 ? 1 / speed : 0;
            positions[at] = x[j], positions[at + 1] = x[j + 1], positions[at + 2] = x[j + 2], positions[at + 3] = place;
            velocities[at] = a, velocities[at + 1] = b, velocities[at + 2] = c, velocities[at + 3] = weights[i];
            directions[at] = per * a, directions[at + 1] = per * b, directions[at + 2] = per * c;
        }
        NAMES.forEach((name, unit) => {
            gl.activeTexture(gl.TEXTURE0 + unit);
            gl.bindTexture(gl.TEXTURE_2D, this.#textures[name]);
            gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, WIDE, this.rows, gl.RGBA, gl.FLOAT, this.arrays[name]);
        });
        gl.activeTexture(gl.TEXTURE0 + NAMES.length);
        gl.bindTexture(gl.TEXTURE_2D, this.#textures.cells);
        gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, WIDE, Math.ceil((count + 2) / WIDE), gl.RED_INTEGER, gl.UNSIGNED_INT, starts);
    }
    #say(x, h) {
        const gl = this.#gl, {program, rules} = this.#plan, {cells} = this, at = (name) => gl.getUniformLocation(program, name);
        gl.useProgram(program);
        [...NAMES, 'cells'].forEach((name, unit) => gl.uniform1i(at(name), unit));
        gl.uniform1ui(at('cell_count'), cells.count);
        const floats = {per_size_x: cells.per[0], per_size: cells.per[1], size: cells.size, step_size: h};
        'xyz'.split('').forEach((axis, k) => {
            gl.uniform1i(at(`cells_${axis}`), cells.counts[k]);
            floats[`origin_${axis}`] = cells.origin[k];
        });
        for (const [name, number] of Object.entries(floats)) gl.uniform1f(at(name), number);
        rules.forEach(({block, reach, particle = -1}, n) => {
            const full = new Float32Array(4 * Math.ceil(block.length / 4));
            full.set(block);
            if (particle >= 0) { // it is where that bird is
                full.set(x.subarray(3 * particle, 3 * particle + 3));
                gl.uniform1i(at(`target${n}`), cells.order.indexOf(particle));
            }
            gl.uniform4fv(at(`op${n}`), [0, 0, 0, h, reach, 0, 0, 0]);
            gl.uniform4fv(at(`rule${n}`), full);
        });
    }
    #take(from, into, to) {
        const gl = this.#gl, {order} = this.cells;
        gl.readBuffer(from);
        gl.readPixels(0, 0, WIDE, this.rows, gl.RGBA, gl.FLOAT, into);
        for (let place = 0, at = 0; place < order.length; place++, at += 4) {
            const j = 3 * order[place];
            to[j] = into[at], to[j + 1] = into[at + 1], to[j + 2] = into[at + 2];
        }
    }
}
