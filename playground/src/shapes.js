// Shapes for what is no body's surface, by what the library says that things look like; a bird; places on a cloth's weave.
import * as THREE from 'three';

/* A collider's geometry, about its pose and before its rotation; null where there is nothing to draw. */
export function colliderGeometry({sort, radius, axis, size, net}) {
    if (sort === 'ball') return new THREE.SphereGeometry(radius, 64, 40);
    if (sort === 'bowl') return new THREE.SphereGeometry(radius, 64, 32, 0, 2 * Math.PI, (115 / 180) * Math.PI, (65 / 180) * Math.PI);
    if (sort === 'box') return new THREE.BoxGeometry(...size);
    if (sort === 'capsule') {
        const half = new THREE.Vector3(...axis), shape = new THREE.CapsuleGeometry(radius, 2 * half.length(), 16, 40);
        return shape.applyQuaternion(new THREE.Quaternion().setFromUnitVectors(new THREE.Vector3(0, 1, 0), half.normalize()));
    }
    if (sort === 'plane') // of side 1: it is as large as suits the scene
        return new THREE.PlaneGeometry(1, 1).applyQuaternion(new THREE.Quaternion().setFromUnitVectors(new THREE.Vector3(0, 0, 1), new THREE.Vector3(...axis)));
    if (!net) return null;
    const shape = new THREE.BufferGeometry();
    shape.setAttribute('position', new THREE.BufferAttribute(net.positions, 3));
    shape.setIndex(new THREE.BufferAttribute(net.index, 1));
    shape.computeVertexNormals();
    return shape;
}
export const isLevel = ({sort, axis}) => sort === 'plane' && axis[1] > 0.999;

/* An arrow along +y of length 1. */
export function arrowGeometry() {
    const stem = new THREE.CylinderGeometry(0.022, 0.022, 0.78, 10).translate(0, 0.39, 0).toNonIndexed();
    const head = new THREE.ConeGeometry(0.075, 0.24, 14).translate(0, 0.88, 0).toNonIndexed();
    const shape = new THREE.BufferGeometry();
    for (const name of ['position', 'normal'])
        shape.setAttribute(name, new THREE.BufferAttribute(Float32Array.from([...stem.attributes[name].array, ...head.attributes[name].array]), 3));
    return shape;
}

/* Where each vertex of a surface is on its weave, in squares: by its rows and columns, its texture coordinates, or from
 * above as it stands. */
export function weave(body, positions) {
    const {vertexCount, gridRows: rows, uv, faceVertices} = body, places = new Float32Array(2 * vertexCount), squares = 20;
    if (rows > 1 && vertexCount % rows === 0) {
        const columns = vertexCount / rows, wide = columns / rows;
        for (let v = 0; v < vertexCount; v++) places.set([(squares * Math.floor(v / columns)) / (rows - 1), (squares * wide * (v % columns)) / (columns - 1)], 2 * v);
    } else if (uv) faceVertices.forEach((v, corner) => places.set([squares * uv[2 * corner], squares * uv[2 * corner + 1]], 2 * v));
    else {
        const box = new THREE.Box3().setFromArray(positions), size = box.getSize(new THREE.Vector3()), most = Math.max(size.x, size.y, size.z, 1e-9);
        for (let v = 0; v < vertexCount; v++) places.set([(squares * positions[3 * v]) / most, (squares * (positions[3 * v + 2] + positions[3 * v + 1])) / most], 2 * v);
    }
    return places;
}

/* Seen along the flight (+z) with the left wing at +x; the wings span 2, as in render/birds.c. */
const body = [
    [0, 0, 0.55, 0, 0.07, 0.1, -0.08, 0, 0.1], [0, 0, 0.55, 0.08, 0, 0.1, 0, 0.07, 0.1],
    [0, 0, 0.55, -0.08, 0, 0.1, 0, -0.08, 0.1], [0, 0, 0.55, 0, -0.08, 0.1, 0.08, 0, 0.1],
    [0, 0, -0.5, -0.08, 0, 0.1, 0, 0.07, 0.1], [0, 0, -0.5, 0, 0.07, 0.1, 0.08, 0, 0.1],
    [0, 0, -0.5, 0, -0.08, 0.1, -0.08, 0, 0.1], [0, 0, -0.5, 0.08, 0, 0.1, 0, -0.08, 0.1],
    [0, 0.01, -0.3, -0.17, 0.01, -0.75, 0.17, 0.01, -0.75],
];
const wing = [
    [0.05, 0.03, 0.26, 0.5, 0.03, 0.32, 0.5, 0.03, -0.06], [0.05, 0.03, 0.26, 0.5, 0.03, -0.06, 0.05, 0.03, -0.16],
    [0.5, 0.03, 0.32, 1, 0.03, -0.08, 0.5, 0.03, -0.06],
];
const mirrored = (triangle) => triangle.map((x, i) => (i % 3 === 0 ? -x : x));
const swapped = ([a, b, c, ...rest]) => [a, b, c, ...rest.slice(3), ...rest.slice(0, 3)];
export function birdGeometry() {
    const triangles = [...body, ...wing, ...wing.map((t) => swapped(mirrored(t)))];
    const shape = new THREE.BufferGeometry();
    shape.setAttribute('position', new THREE.BufferAttribute(Float32Array.from(triangles.flat()), 3));
    shape.computeVertexNormals();
    return shape;
}

/* A polygon mesh's triangles: each face that is not cut as a fan from its first corner. */
export function triangles({faceSizes, faceVertices}, cut = null) {
    const index = [];
    let at = 0;
    for (const [face, size] of faceSizes.entries()) {
        for (let k = 2; k < size && !cut?.[face]; k++) index.push(faceVertices[at], faceVertices[at + k - 1], faceVertices[at + k]);
        at += size;
    }
    return Uint32Array.from(index);
}
