// The scenes and meshes of the repository, as the bundler finds them. A scene whose mesh is not in the repository (it is
// fetched by `make demo`) is left out.
const texts = import.meta.glob('../../scenes/*.json', {query: '?raw', import: 'default', eager: true});
const meshes = import.meta.glob('../../meshes/*.{obj,off,node,ele}', {query: '?url', import: 'default', eager: true});

const meshesOf = (text) =>
    (JSON.parse(text).bodies ?? []).flatMap(({mesh}) => (mesh ? [mesh, mesh.replace(/[.]node$/, '.ele')] : []));
const address = (mesh) => meshes[`../../meshes/${mesh.split('/meshes/').pop()}`];

export const scenes = new Map();
for (const [path, text] of Object.entries(texts)) {
    const name = /([^/]+)[.]json$/.exec(path)[1];
    if (meshesOf(text).every(address)) scenes.set(name, {name, text, description: JSON.parse(text).description ?? ''});
}

/* What a scene names, fetched. */
export async function filesOf(text) {
    const files = {};
    for (const mesh of new Set(meshesOf(text))) {
        if (!address(mesh)) continue; // the reader says that it is not there
        files[mesh] = await (await fetch(new URL(address(mesh), document.baseURI))).text();
    }
    return files;
}
