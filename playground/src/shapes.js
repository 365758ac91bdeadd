// Shapes for what is no body's surface: colliders by kind, a bird. Lengths are the fields' own, in metres.
import * as THREE from 'three';

/* A collider's geometry, about its pose; null where it is not known how to draw it. */
export function colliderGeometry(kind, fields) {
    const {radius} = fields;
    if (kind === 'sphere') return new THREE.SphereGeometry(radius, 64, 40);
    if (kind === 'bowl') return new THREE.SphereGeometry(radius, 64, 32, 0, 2 * Math.PI, Math.PI / 2, Math.PI / 2);
    if (kind === 'box') return new THREE.BoxGeometry(...fields.size);
    if (kind === 'capsule') {
        const from = new THREE.Vector3(...fields.from), to = new THREE.Vector3(...fields.to), way = to.clone().sub(from);
        const shape = new THREE.CapsuleGeometry(radius, way.length(), 16, 40);
        const up = new THREE.Vector3(0, 1, 0);
        return shape.applyQuaternion(new THREE.Quaternion().setFromUnitVectors(up, way.normalize()));
    }
    if (kind === 'plane') {
        const shape = new THREE.PlaneGeometry(400, 400), normal = new THREE.Vector3(...fields.normal).normalize();
        return shape.applyQuaternion(new THREE.Quaternion().setFromUnitVectors(new THREE.Vector3(0, 0, 1), normal));
    }
    return null;
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

/* Wings that beat: each bird at its own moment of the beat, by `time`. Changes a material before it is compiled. */
export function beatWings(material, time) {
    material.onBeforeCompile = (shader) => {
        shader.uniforms.beatTime = time;
        shader.vertexShader = shader.vertexShader
            .replace('#include <common>', '#include <common>\nuniform float beatTime;')
            .replace('#include <begin_vertex>', `#include <begin_vertex>
                float out_ = max(abs(transformed.x) - 0.05, 0.0);
                float beat = sin(beatTime * 18.0 + float(gl_InstanceID) * 2.399) * 0.75 + 0.12;
                transformed.y += out_ * beat;
                transformed.x *= 1.0 - 0.28 * beat * beat * step(0.06, abs(transformed.x));`);
    };
    return material;
}

/* A polygon mesh's triangles: each face as a fan from its first corner. */
export function triangles({faceSizes, faceVertices}) {
    const index = [];
    let at = 0;
    for (const size of faceSizes) {
        for (let k = 2; k < size; k++) index.push(faceVertices[at], faceVertices[at + k - 1], faceVertices[at + k]);
        at += size;
    }
    return Uint32Array.from(index);
}
