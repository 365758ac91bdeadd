// The whole state in the address: scene, changes, frame and view, as #scene=flag&set=forces.1.velocity=[2,0,3]&frame=60...
// A scene of one's own goes along, packed.

async function through(stream, bytes) {
    const writer = stream.writable.getWriter();
    writer.write(bytes).catch(() => {}); // what is broken is told by reading
    writer.close().catch(() => {});
    return new Uint8Array(await new Response(stream.readable).arrayBuffer());
}
async function pack(text) {
    const bytes = await through(new CompressionStream('deflate-raw'), new TextEncoder().encode(text));
    return btoa(String.fromCharCode(...bytes)).replace(/\+/g, '-').replace(/\//g, '_').replace(/=/g, '');
}
async function unpack(text) {
    const bytes = Uint8Array.from(atob(text.replace(/-/g, '+').replace(/_/g, '/')), (c) => c.charCodeAt(0));
    return new TextDecoder().decode(await through(new DecompressionStream('deflate-raw'), bytes));
}

export async function write({scene, text, sets, frame, camera}) {
    const fields = new URLSearchParams();
    if (scene) fields.set('scene', scene);
    else fields.set('text', await pack(text));
    for (const set of sets) fields.append('set', set);
    if (frame) fields.set('frame', frame);
    if (camera) fields.set('camera', camera.map((x) => Number(x.toFixed(3))).join(','));
    return `#${fields}`;
}

/* Nothing that is read here is trusted: what is no number, or too much, is left out. */
export async function read(hash) {
    const fields = new URLSearchParams(hash.replace(/^#/, '')), frame = Number(fields.get('frame') ?? 0);
    const camera = fields.get('camera')?.split(',').map(Number);
    return {
        scene: fields.get('scene'),
        text: fields.has('text') ? await unpack(fields.get('text')) : null,
        sets: fields.getAll('set'),
        frame: Number.isInteger(frame) && frame > 0 ? Math.min(frame, 36000) : 0,
        camera: camera?.length === 6 && camera.every(Number.isFinite) ? camera : null,
    };
}
