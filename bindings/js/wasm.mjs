/* A module of WebAssembly taken apart: its sections, the bodies of its functions, and the places in them where a function is
 * meant by its index; and put together again with the functions in another order. Knows the instructions of version 2 of the
 * standard and those of threads, and refuses what it does not know. */

const TYPE = 1, IMPORT = 2, FUNCTION = 3, GLOBAL = 6, EXPORT = 7, START = 8, ELEMENT = 9, CODE = 10, CUSTOM = 0;

class Reader {
    constructor(bytes, at = 0) {
        this.bytes = bytes;
        this.at = at;
    }
    byte() {
        if (this.at >= this.bytes.length) throw new Error('it ends too early');
        return this.bytes[this.at++];
    }
    /* LEB128, which signed numbers have, too: what those are worth is asked of nobody but lengths and indices. */
    number() {
        let value = 0, scale = 1;
        for (let byte = 128; byte >= 128; scale *= 128) value += ((byte = this.byte()) & 127) * scale;
        return value;
    }
    skip(count) {
        this.at += count;
    }
    take(count) {
        if (this.at + count > this.bytes.length) throw new Error('it ends too early');
        return this.bytes.subarray(this.at, (this.at += count));
    }
    list(element) {
        return Array.from({length: this.number()}, element);
    }
}

function number(value) {
    const bytes = [];
    for (; value >= 128; value = Math.floor(value / 128)) bytes.push((value % 128) | 128);
    return [...bytes, value];
}

const joined = (parts) => Buffer.concat(parts.map((part) => Uint8Array.from(part)));

/* ---- instructions ---- */

const memory = (r) => (r.number(), r.number());

function skipVector(r) {
    const code = r.number();
    if (code < 12 || code === 92 || code === 93) memory(r);
    else if (code < 14) r.skip(16); // a constant; a shuffle
    else if (code >= 21 && code < 35) r.skip(1); // a lane
    else if (code >= 84 && code < 92) memory(r), r.skip(1);
    else if (code > 255) throw new Error(`no such instruction is known: 0xfd ${code}`);
}

function skipBulk(r) {
    const code = r.number();
    if (code > 17) throw new Error(`no such instruction is known: 0xfc ${code}`);
    if (code >= 8) r.number();
    if (code === 8 || code === 10 || code === 12 || code === 14) r.number();
}

function skipAtomic(r) {
    const code = r.number();
    if (code === 3) r.skip(1);
    else if (code < 3 || (code >= 16 && code < 79)) memory(r);
    else throw new Error(`no such instruction is known: 0xfe ${code}`);
}

/* Goes past one instruction, and calls found(before, after) where the index of a function stands. */
function skipInstruction(r, found) {
    const code = r.byte();
    if (code === 0x10 || code === 0xd2) { // call, ref.func
        const before = r.at;
        r.number();
        found(before, r.at);
    } else if ((code >= 0x28 && code < 0x3f)) memory(r);
    else if (code >= 0x20 && code < 0x27) r.number(); // variables, tables
    else if (code >= 0x02 && code < 0x05) r.number(); // what a block has
    else if (code === 0x0c || code === 0x0d || code === 0x3f || code === 0x40 || code === 0x41 || code === 0x42 || code === 0xd0) r.number();
    else if (code === 0x0e) r.list(() => r.number()), r.number();
    else if (code === 0x11) memory(r); // a type and a table
    else if (code === 0x1c) r.list(() => r.number());
    else if (code === 0x43) r.skip(4);
    else if (code === 0x44) r.skip(8);
    else if (code === 0xfc) skipBulk(r);
    else if (code === 0xfd) skipVector(r);
    else if (code === 0xfe) skipAtomic(r);
    else if (!(code < 2 || code === 0x05 || code === 0x0b || code === 0x0f || code === 0x1a || code === 0x1b || (code >= 0x45 && code < 0xc5) || code === 0xd1))
        throw new Error(`no such instruction is known: ${code}`);
}

/* A body's bytes between the indices of functions, and those. */
function takeBody(bytes) {
    const r = new Reader(bytes), pieces = [], calls = [];
    let from = 0;
    r.list(() => (r.number(), r.number())); // its variables
    while (r.at < bytes.length)
        skipInstruction(r, (before, after) => {
            pieces.push(bytes.subarray(from, before));
            calls.push(new Reader(bytes, before).number());
            from = after;
        });
    pieces.push(bytes.subarray(from));
    return {bytes, pieces, calls};
}

/* ---- the module ---- */

function countImports(r) {
    let count = 0;
    r.list(() => {
        r.skip(r.number()), r.skip(r.number()); // the module's name and its own
        const kind = r.byte();
        if (kind === 0) r.number(), count++;
        else {
            if (kind !== 2) r.skip(1); // the type of what a table or a variable holds
            if (kind === 3) r.skip(1);
            else if (r.byte() & 1) memory(r);
            else r.number();
        }
    });
    return count;
}

/* {sections, imports: how many functions are imported, types, bodies}: of the own functions, in their order. */
export function takeApart(bytes) {
    const r = new Reader(bytes, 8), sections = [], found = {sections, imports: 0, types: [], bodies: []};
    while (r.at < bytes.length) {
        const id = r.byte(), content = r.take(r.number()), inner = new Reader(content);
        if (id !== CUSTOM) sections.push({id, content}); // names are another order's
        if (id === IMPORT) found.imports = countImports(inner);
        if (id === FUNCTION) found.types = inner.list(() => inner.number());
        if (id === CODE) found.bodies = inner.list(() => takeBody(inner.take(inner.number())));
    }
    return found;
}

function placedExports(r, place) {
    return joined([number(r.number()), ...function* () {
        while (r.at < r.bytes.length) {
            const from = r.at;
            r.skip(r.number());
            const kind = r.byte(), index = r.number();
            yield r.bytes.subarray(from, r.at - number(index).length);
            yield number(kind === 0 ? place(index) : index);
        }
    }()]);
}

/* Tables' first contents: lists of functions, each from a constant place on, are all that compilers of C write. */
function placedElements(r, place) {
    const count = r.number();
    return joined([number(count), ...Array.from({length: count}, () => {
        const from = r.at;
        if (r.number() !== 0) throw new Error('a table is filled in a way that is not known');
        while (r.bytes[r.at] !== 0x0b) skipInstruction(r, () => {});
        r.skip(1);
        const before = r.bytes.subarray(from, r.at), functions = r.list(() => place(r.number()));
        return joined([before, number(functions.length), ...functions.map(number)]);
    })]);
}

/* The bytes of the module with its own functions in another order: order[i] is the one that comes to be number i. */
export function putTogether({sections, imports, types, bodies}, order) {
    const places = new Array(order.length);
    order.forEach((old, now) => (places[old] = imports + now));
    const place = (index) => (index < imports ? index : places[index - imports]);
    const rewritten = {
        [FUNCTION]: () => joined([number(order.length), ...order.map((i) => number(types[i]))]),
        [EXPORT]: (r) => placedExports(r, place),
        [START]: (r) => number(place(r.number())),
        [ELEMENT]: (r) => placedElements(r, place),
        [CODE]: () => joined([number(order.length), ...order.flatMap((i) => {
            const {pieces, calls} = bodies[i];
            const body = joined(pieces.flatMap((piece, k) => (k < calls.length ? [piece, number(place(calls[k]))] : [piece])));
            return [number(body.length), body];
        })]),
    };
    const parts = sections.flatMap(({id, content}) => {
        const now = rewritten[id] ? rewritten[id](new Reader(content)) : content;
        return [[id], number(now.length), now];
    });
    return joined([[0, 97, 115, 109, 1, 0, 0, 0], ...parts]);
}
