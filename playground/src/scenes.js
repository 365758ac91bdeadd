// The scenes, meshes and pictures of the repository, as the bundler finds them. A scene whose mesh is not in the repository
// (it is fetched by `make demo`) is left out.
const texts = import.meta.glob('../../scenes/*.json', {query: '?raw', import: 'default', eager: true});
const meshes = import.meta.glob('../../meshes/*.{obj,off,node,ele}', {query: '?url', import: 'default', eager: true});
const pictures = import.meta.glob('../../docs/images/scenes/*.png', {query: '?url', import: 'default', eager: true});

const meshesOf = ({bodies = [], colliders = []}) =>
    [...bodies, ...colliders].flatMap(({mesh}) => (mesh ? [mesh, mesh.replace(/[.]node$/, '.ele')] : []));
const address = (mesh) => meshes[`../../meshes/${mesh.split('/meshes/').pop()}`];
const here = (path) => new URL(path, import.meta.url).href;

export const scenes = new Map();
for (const [path, text] of Object.entries(texts)) {
    const name = /([^/]+)[.]json$/.exec(path)[1], scene = JSON.parse(text), picture = pictures[`../../docs/images/scenes/${name}.png`];
    if (meshesOf(scene).every(address)) scenes.set(name, {name, text, description: scene.description ?? '', picture: picture && here(picture)});
}

/* What a scene names, fetched, besides what was given already. */
export async function filesOf(text, given = {}) {
    const files = {...given};
    let scene = {};
    try {
        scene = JSON.parse(text || '{}');
    } catch {
        return files; // the reader says what is wrong with it
    }
    for (const mesh of new Set(meshesOf(scene))) {
        if (files[mesh] || !address(mesh)) continue; // the reader says that it is not there
        files[mesh] = await (await fetch(here(address(mesh)))).text();
    }
    return files;
}
