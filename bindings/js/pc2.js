// PC2 point caches in memory: the positions of a run, as Blender, 3ds Max and Maya read them. io/pc2.h has the layout.
const HEADER = 32, NAME = 'POINTCACHE2\0';

export class PointCache {
    #points;
    #samples = [];

    /* `vertices` in each sample. */
    constructor(vertices) {
        this.#points = vertices;
    }
    get samples() {
        return this.#samples.length;
    }
    /* A sample: x, y, z of each vertex. It is copied. */
    add(positions) {
        if (positions.length !== 3 * this.#points) throw new RangeError(`expected ${3 * this.#points} numbers, not ${positions.length}`);
        this.#samples.push(Float32Array.from(positions));
    }
    /* Takes away all samples from a number on: for a run that went back. */
    cut(samples) {
        this.#samples.length = Math.min(this.#samples.length, samples);
    }
    /* The whole file. */
    bytes() {
        const size = 12 * this.#points, file = new Uint8Array(HEADER + size * this.#samples.length), view = new DataView(file.buffer);
        file.set(new TextEncoder().encode(NAME));
        view.setInt32(12, 1, true);
        view.setInt32(16, this.#points, true);
        view.setFloat32(20, 0, true);
        view.setFloat32(24, 1, true);
        view.setInt32(28, this.#samples.length, true);
        this.#samples.forEach((sample, i) => sample.forEach((x, k) => view.setFloat32(HEADER + i * size + 4 * k, x, true)));
        return file;
    }
}
