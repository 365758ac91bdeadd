// The whole state in the address: scene, changes, hands, frame and view, as
// #scene=flag&set=forces.1.velocity=[2,0,3]&done=...&frame=60&camera=... A scene of one's own goes along, packed, and so
// do its meshes.

async function through(stream, bytes) {
    const writer = stream.writable.getWriter();
    writer.write(bytes).catch(() => {}); // what is broken is told by reading
    writer.close().catch(() => {});
    return new Uint8Array(await new Response(stream.readable).arrayBuffer());
}
async function pack(text) {
    const bytes = await through(new CompressionStream('deflate-raw'), new TextEncoder().encode(text));
    let letters = '';
    for (let i = 0; i < bytes.length; i += 8192) letters += String.fromCharCode(...bytes.subarray(i, i + 8192));
    return btoa(letters).replace(/\+/g, '-').replace(/\//g, '_').replace(/=/g, '');
}
async function unpack(text) {
    try {
        const bytes = Uint8Array.from(atob(text.replace(/-/g, '+').replace(/_/g, '/')), (c) => c.charCodeAt(0));
        return new TextDecoder().decode(await through(new DecompressionStream('deflate-raw'), bytes));
    } catch {
        throw new Error('a part of it is damaged or cut off'); // browsers say "Failed to fetch"
    }
}

export const MOST = 500000; // letters: beyond it browsers and servers shorten addresses

export async function write({scene, text, path, files, sets, events, frame, camera}) {
    const fields = new URLSearchParams();
    if (scene) fields.set('scene', scene);
    else {
        fields.set('text', await pack(text));
        fields.set('path', path);
        if (Object.keys(files).length) fields.set('files', await pack(JSON.stringify(files)));
    }
    for (const set of sets) fields.append('set', set);
    if (events.length) fields.set('done', await pack(JSON.stringify(events)));
    if (frame) fields.set('frame', frame);
    if (camera) fields.set('camera', camera.map((x) => Number(x.toFixed(3))).join(','));
    return `#${fields}`;
}

const CALLS = ['pull', 'letGo', 'pin', 'release', 'set', 'card', 'cut'];
const isEvent = (e) => Array.isArray(e) && Number.isInteger(e[0]) && e[0] >= 0 && CALLS.includes(e[1]);

/* Nothing that is read here is trusted: what is no number, or too much, is left out. */
export async function read(hash) {
    const fields = new URLSearchParams(hash.replace(/^#/, '')), frame = Number(fields.get('frame') ?? 0);
    const camera = fields.get('camera')?.split(',').map(Number);
    const json = async (name, otherwise) => (fields.has(name) ? JSON.parse(await unpack(fields.get(name))) : otherwise);
    const events = await json('done', []), files = await json('files', {});
    if (!Array.isArray(events) || !events.every(isEvent)) throw new Error('what was done to the scene is damaged in this address');
    return {
        scene: fields.get('scene'),
        text: fields.has('text') ? await unpack(fields.get('text')) : null,
        path: fields.get('path') ?? 'scene.json',
        files: Object.fromEntries(Object.entries(files).filter(([, content]) => typeof content === 'string')),
        sets: fields.getAll('set'),
        events,
        frame: Number.isInteger(frame) && frame > 0 ? Math.min(frame, 36000) : 0,
        camera: camera?.length === 6 && camera.every(Number.isFinite) ? camera : null,
    };
}
