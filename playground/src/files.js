// Files in and out: meshes and scenes that are opened or dropped on the page, and what is saved from it.
const MESH = /[.](obj|off|ply|stl|glb|gltf|node|ele)$/i;

export function save(name, content, type) {
    const address = URL.createObjectURL(new Blob([content], {type})), link = document.createElement('a');
    Object.assign(link, {href: address, download: name});
    link.click();
    setTimeout(() => URL.revokeObjectURL(address), 10000);
}

/* A film of a canvas in real time; `stop()` resolves to its bytes. */
export function film(canvas) {
    const type = ['video/webm;codecs=vp9', 'video/webm;codecs=vp8', 'video/webm'].find((t) => globalThis.MediaRecorder?.isTypeSupported(t));
    if (!type) throw new Error('This browser films no WebM.');
    const parts = [], recorder = new MediaRecorder(canvas.captureStream(60), {mimeType: type, videoBitsPerSecond: 8e6});
    recorder.ondataavailable = ({data}) => parts.push(data);
    recorder.start(500);
    return {
        stop: () => new Promise((resolve) => {
            recorder.onstop = () => resolve(new Blob(parts, {type: 'video/webm'}));
            recorder.stop();
        }),
    };
}

export function offerFiles({app, $, simulation, open, notice, picture}) {
    const name = () => app.world?.settings.name || 'scene';
    const body = () => Math.max(0, app.world.bodies.findIndex((b) => b.faceSizes.length));
    const guarded = (act) => async () => {
        try {
            await act();
        } catch (error) {
            notice(error.message);
        }
    };

    /* Files of a person: a scene with the meshes that it names, or a mesh by itself. */
    async function openFiles(list) {
        const files = {}, chosen = [...list];
        for (const file of chosen) {
            const text = !/[.](ply|stl|glb)$/i.test(file.name);
            files[file.name] = text ? await file.text() : new Uint8Array(await file.arrayBuffer());
        }
        const scene = chosen.find((file) => /[.]json$/i.test(file.name)), mesh = chosen.find((file) => MESH.test(file.name));
        if (scene) {
            const {[scene.name]: text, ...rest} = files;
            await open(null, {text, path: scene.name, files: rest});
        } else if (mesh) await open(null, {text: '', path: mesh.name, files});
        else notice('A mesh (OBJ, OFF, PLY, STL, glTF, TetGen) or a scene (JSON) can be opened.');
    }
    $('open-file').addEventListener('click', () => $('file').click());
    $('file').addEventListener('change', guarded(async () => {
        await openFiles($('file').files);
        $('file').value = '';
    }));
    addEventListener('dragover', (event) => event.preventDefault());
    addEventListener('drop', (event) => {
        event.preventDefault();
        if (event.dataTransfer?.files.length) guarded(() => openFiles(event.dataTransfer.files))();
    });

    $('save-obj').addEventListener('click', guarded(async () => save(`${name()}.obj`, await simulation.call('file', body(), 'obj'), 'model/obj')));
    $('save-pc2').addEventListener('click', guarded(async () => save(`${name()}.pc2`, await simulation.call('pointCache', body()), 'application/octet-stream')));
    $('save-scene').addEventListener('click', guarded(async () =>
        save(`${name()}.json`, JSON.stringify(await simulation.call('scene'), null, 2), 'application/json')));
    $('save-png').addEventListener('click', guarded(async () => {
        picture().drawNow();
        save(`${name()}-${app.state.frame}.png`, await new Promise((resolve) => picture().canvas.toBlob(resolve)), 'image/png');
    }));
    let running = null;
    $('save-webm').addEventListener('click', guarded(async () => {
        const button = $('save-webm');
        if (!running) {
            running = film(picture().canvas);
            button.textContent = 'Stop filming and save';
            notice('Filming. More > Stop filming saves it.');
            await simulation.call('play', true);
            return;
        }
        save(`${name()}.webm`, await running.stop(), 'video/webm');
        running = null;
        button.textContent = 'Film what is shown (WebM)';
        notice('');
    }));
    return {openFiles};
}
