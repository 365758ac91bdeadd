// Draws a world: surfaces lit on both sides, balls and rods for what has none, birds, colliders, a sun with soft shadows.
// Owns what lies on the graphics card; `describe` gives it a world, `show` a state of it.
import * as THREE from 'three';
import {OrbitControls} from 'three/addons/controls/OrbitControls.js';

import {Light, setUpRenderer} from './light.js';
import {bowlInside, cloth, collider, COLOURS, feathers, ground, jelly, LOOKS, matter, PIN, plumage} from './materials.js';
import {arrowGeometry, birdGeometry, colliderGeometry, isLevel, triangles, weave} from './shapes.js';

/* Where a camera that looks along -back stands and what it looks at, for all points to be within `tall` of the middle (a tangent),
 * and how much of the picture's longer side the particles take then. As in render/camera.c. */
function hold(positions, corners, centre, back, tall, aspect, size) {
    const right = new THREE.Vector3(0, 1, 0).cross(back).normalize(), up = back.clone().cross(right), off = new THREE.Vector3(), wide = tall * aspect;
    const most = [-Infinity, -Infinity], least = [Infinity, Infinity], own = {most: [-Infinity, -Infinity], least: [Infinity, Infinity]};
    let nearest = -Infinity;
    const count = positions.length / 3, seen = (i) => (i < count ? off.fromArray(positions, 3 * i) : off.copy(corners[i - count])).sub(centre);
    for (let i = 0; i < count + corners.length; i++) {
        const point = seen(i), z = point.dot(back);
        nearest = Math.max(nearest, z);
        [[right, wide], [up, tall]].forEach(([axis, tangent], k) => {
            const x = point.dot(axis);
            most[k] = Math.max(most[k], x + tangent * z);
            least[k] = Math.min(least[k], x - tangent * z);
            if (i >= count) return;
            own.most[k] = Math.max(own.most[k], x);
            own.least[k] = Math.min(own.least[k], x);
        });
    }
    const far = Math.max((most[0] - least[0]) / (2 * wide), (most[1] - least[1]) / (2 * tall), nearest + 0.25 * size, 1e-6);
    const target = centre.clone().addScaledVector(right, (most[0] + least[0]) / 2).addScaledVector(up, (most[1] + least[1]) / 2 + 0.05 * far * tall);
    return {far, target, large: Math.max(...[wide, tall].map((tangent, k) => (own.most[k] - own.least[k]) / (2 * far * tangent)))};
}

export class Picture {
    #holder;
    #renderer;
    #scene = new THREE.Scene();
    #camera = new THREE.PerspectiveCamera(34, 1, 0.01, 2000);
    #light = new Light(this.#scene);
    #ground;
    #look = LOOKS.light;
    #parts = null; // of the world that is drawn
    #state = null;
    #beat = {value: 0};
    #arrows = {count: 0, mesh: null};
    #wanted = false;
    #drifting = false;
    #byHand = false; // somebody has turned the view
    #sizes;

    constructor(holder) {
        this.#holder = holder;
        this.#renderer = new THREE.WebGLRenderer({antialias: true, preserveDrawingBuffer: true}); // throws where there is no WebGL2
        setUpRenderer(this.#renderer);
        this.#renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
        holder.append(this.#renderer.domElement);
        this.controls = new OrbitControls(this.#camera, this.#renderer.domElement);
        this.controls.addEventListener('change', () => this.draw());
        this.controls.addEventListener('start', () => (this.#byHand = true));
        this.#light.look = this.#look;
        this.#sizes = new ResizeObserver(() => this.resize());
        this.#sizes.observe(holder);
        this.resize();
    }

    get canvas() {
        return this.#renderer.domElement;
    }
    get camera() {
        return [...this.#camera.position.toArray(), ...this.controls.target.toArray()];
    }
    set camera([x, y, z, ...at]) {
        this.#camera.position.set(x, y, z);
        this.controls.target.set(...at);
        this.#byHand = true;
        if (this.#parts?.size) this.#light.aim(this.controls.target, this.#parts.size);
        this.controls.update();
        this.draw();
    }
    set dark(on) {
        this.#look = on ? LOOKS.dark : LOOKS.light;
        this.#light.look = this.#look;
        if (this.#parts) this.#paint();
        this.draw();
    }

    resize() {
        const {clientWidth: width, clientHeight: height} = this.#holder;
        if (!width || !height) return;
        this.#renderer.setSize(width, height);
        this.#camera.aspect = width / height;
        this.#camera.updateProjectionMatrix();
        if (this.#parts?.framed && !this.#byHand && this.controls.enabled) this.frame(); // of a narrower picture all is to be seen, too
        this.draw();
    }

    /* Turns the view by so many degrees to the right and up, and goes so many times as near: for keys. */
    turn(right, up, nearer = 1) {
        const {target} = this.controls, off = new THREE.Spherical().setFromVector3(this.#camera.position.clone().sub(target));
        off.theta += THREE.MathUtils.degToRad(right);
        off.phi -= THREE.MathUtils.degToRad(up);
        off.radius /= nearer;
        this.#byHand = true;
        this.#camera.position.setFromSpherical(off.makeSafe()).add(target);
        this.controls.update();
        this.draw();
    }
    /* Soon, once, however often it is asked for. */
    draw() {
        if (this.#wanted) return;
        this.#wanted = true;
        requestAnimationFrame(() => {
            this.#wanted = false;
            this.drawNow();
        });
    }
    drawNow() {
        this.#renderer.render(this.#scene, this.#camera);
        this.onDrawn?.();
    }
    /* Gives the card's memory back. */
    end() {
        this.#sizes.disconnect();
        this.controls.dispose();
        this.#scene.traverse((thing) => {
            thing.geometry?.dispose();
            thing.material?.dispose?.();
            thing.dispose?.();
        });
        this.#renderer.dispose();
        this.#renderer.domElement.remove();
    }

    /* ---- a world ---- */

    describe(world) {
        if (this.#parts) {
            this.#scene.remove(this.#parts.all);
            this.#parts.all.traverse((thing) => {
                thing.geometry?.dispose();
                thing.material?.dispose();
                thing.dispose?.();
            });
        }
        const all = new THREE.Group();
        this.#parts = {
            all, world, framed: false,
            surfaces: world.bodies.map((body, i) => (body.faceSizes.length ? this.#surface(body, i, all) : null)),
            colliders: world.colliders.map((collider) => this.#collider(collider, all)),
            ...this.#loose(world, all),
        };
        this.#scene.add(all);
        this.#paint();
    }

    #surface(body, number, all) {
        const shape = new THREE.BufferGeometry();
        shape.setIndex(new THREE.BufferAttribute(triangles(body), 1));
        for (const name of ['position', 'normal'])
            shape.setAttribute(name, new THREE.BufferAttribute(new Float32Array(3 * body.vertexCount), 3).setUsage(THREE.DynamicDrawUsage));
        const materials = body.look === 'jelly' ? [jelly(number)] : [THREE.FrontSide, THREE.BackSide].map((side) => cloth(number, side, body.look === 'cloth'));
        for (const material of materials) {
            const mesh = new THREE.Mesh(shape, material);
            mesh.frustumCulled = false;
            mesh.receiveShadow = true;
            mesh.castShadow = material.side === THREE.FrontSide;
            all.add(mesh);
        }
        return shape;
    }

    #collider(thing, all) {
        const shape = thing.visible ? colliderGeometry(thing) : null;
        if (!shape) return null;
        const mesh = new THREE.Mesh(shape, collider(thing.sort)), bowl = thing.sort === 'bowl';
        mesh.castShadow = thing.sort !== 'plane' && !bowl;
        mesh.receiveShadow = !bowl;
        if (bowl) { // the far wall is seen from within, the near one seen through
            const inside = new THREE.Mesh(shape, bowlInside());
            inside.castShadow = inside.receiveShadow = true;
            mesh.add(inside);
        }
        mesh.visible = !isLevel(thing); // which is drawn as the ground
        mesh.userData.sort = thing.sort;
        mesh.matrixAutoUpdate = false;
        all.add(mesh);
        return mesh;
    }

    /* Particles without a surface: birds of a flock, rods along a rope, balls for others with rods along their springs. */
    #loose(world, all) {
        const birds = [], balls = [], rods = [], isBall = new Uint8Array(world.count);
        for (const body of world.bodies)
            for (let i = 0; i < body.particleCount; i++) {
                const p = body.firstParticle + i;
                if (body.shape === 'birds') birds.push(p);
                else if (body.shape === 'chain' && i) rods.push(p - 1, p);
                if (body.shape === 'birds' || body.shape === 'chain' || body.faceSizes.length) continue;
                balls.push(p);
                isBall[p] = 1;
            }
        for (let i = 0; i < world.springs.length; i += 2)
            if (isBall[world.springs[i]] && isBall[world.springs[i + 1]]) rods.push(world.springs[i], world.springs[i + 1]);
        const many = (count, shape, material) => {
            const mesh = new THREE.InstancedMesh(shape, material, count);
            mesh.frustumCulled = false;
            mesh.castShadow = mesh.receiveShadow = true;
            mesh.instanceMatrix.setUsage(THREE.DynamicDrawUsage);
            if (count) all.add(mesh);
            return mesh;
        };
        const birdMesh = many(birds.length, birdGeometry(), feathers(this.#beat));
        birds.forEach((_, i) => birdMesh.setColorAt(i, plumage(i)));
        return {
            birds, balls, rods, birdMesh, pins: null,
            ballMesh: many(balls.length, new THREE.SphereGeometry(1, 20, 14), matter(0)),
            rodMesh: many(rods.length / 2, new THREE.CapsuleGeometry(1, 1, 6, 12).scale(1, 1 / 3, 1), matter(balls.length ? 2 : 0)),
        };
    }

    #paint() {
        for (const mesh of this.#parts.colliders) mesh?.material.color.set(mesh.userData.sort === 'plane' ? this.#look.ground : this.#look.collider);
        if (this.#ground) this.#setGround(this.#ground.userData);
    }

    /* ---- a state ---- */

    show(state) {
        if (!this.#parts) return;
        this.#state = state;
        state.surfaces.forEach((surface, i) => {
            const shape = this.#parts.surfaces[i];
            if (!surface || !shape) return;
            if (surface.cut) shape.setIndex(new THREE.BufferAttribute(triangles(this.#parts.world.bodies[i], surface.cut), 1));
            shape.attributes.position.array.set(surface.positions);
            shape.attributes.normal.array.set(surface.normals);
            if (!shape.attributes.uv) shape.setAttribute('uv', new THREE.BufferAttribute(weave(this.#parts.world.bodies[i], surface.positions), 2));
            shape.attributes.position.needsUpdate = shape.attributes.normal.needsUpdate = true;
        });
        const side = 1.6 * (this.#parts.size ?? 1);
        state.poses.forEach(({position, rotation: r}, i) => {
            const mesh = this.#parts.colliders[i];
            if (!mesh) return;
            mesh.matrix.set(r[0], r[1], r[2], position[0], r[3], r[4], r[5], position[1], r[6], r[7], r[8], position[2], 0, 0, 0, 1);
            if (mesh.userData.sort === 'plane') mesh.matrix.multiply(new THREE.Matrix4().makeScale(side, side, side));
        });
        this.#beat.value = state.time;
        this.#lowerGround(state);
        this.#placeLoose(state);
        this.#placePins(state);
        this.#placeArrows(state.arrows);
        if (!this.#parts.framed) this.frame();
        this.#goAfter(state);
        this.draw();
    }

    #radius(state) {
        const given = this.#parts.world.settings.particleRadius;
        return given || 0.012 * (this.#parts.size ?? 1);
    }

    #placeLoose({positions, velocities}) {
        const {birds, balls, rods, birdMesh, ballMesh, rodMesh} = this.#parts, radius = this.#radius();
        const matrix = new THREE.Matrix4(), at = new THREE.Vector3(), to = new THREE.Vector3(), turn = new THREE.Quaternion();
        const x = new THREE.Vector3(), y = new THREE.Vector3(), z = new THREE.Vector3();
        balls.forEach((p, i) => {
            matrix.makeScale(radius, radius, radius).setPosition(positions[3 * p], positions[3 * p + 1], positions[3 * p + 2]);
            ballMesh.setMatrixAt(i, matrix);
        });
        for (let i = 0; i < rods.length; i += 2) {
            at.fromArray(positions, 3 * rods[i]);
            to.fromArray(positions, 3 * rods[i + 1]).sub(at);
            const length = to.length() || 1e-9;
            turn.setFromUnitVectors(y.set(0, 1, 0), z.copy(to).divideScalar(length));
            matrix.compose(at.addScaledVector(to, 0.5), turn, x.set(0.7 * radius, length, 0.7 * radius));
            rodMesh.setMatrixAt(i / 2, matrix);
        }
        birds.forEach((p, i) => {
            z.fromArray(velocities, 3 * p);
            if (z.lengthSq() < 1e-12) z.set(0, 0, 1);
            z.normalize();
            x.set(0, 1, 0).cross(z);
            if (x.lengthSq() < 1e-9) x.set(1, 0, 0);
            x.normalize();
            y.crossVectors(z, x);
            // a bird leans into its turn: by the share of sideways change since the last state
            const old = this.#parts.headings?.[i];
            if (old) {
                const lean = THREE.MathUtils.clamp(-12 * x.dot(to.subVectors(z, old)), -0.9, 0.9);
                const smooth = (this.#parts.leans[i] = 0.85 * (this.#parts.leans[i] ?? 0) + 0.15 * lean);
                x.applyAxisAngle(z, smooth);
                y.crossVectors(z, x);
            }
            ((this.#parts.headings ??= [])[i] ??= new THREE.Vector3()).copy(z);
            this.#parts.leans ??= [];
            const size = 3 * radius;
            matrix.makeBasis(x.multiplyScalar(size), y.multiplyScalar(size), z.multiplyScalar(size));
            matrix.setPosition(positions[3 * p], positions[3 * p + 1], positions[3 * p + 2]);
            birdMesh.setMatrixAt(i, matrix);
        });
        for (const mesh of [birdMesh, ballMesh, rodMesh]) mesh.instanceMatrix.needsUpdate = true;
    }

    /* Small dark balls on what holds a surface. */
    #placePins({positions, held}) {
        let {pins} = this.#parts;
        if (pins?.count !== held.length) {
            pins?.removeFromParent();
            pins?.geometry.dispose();
            pins?.material.dispose();
            pins = this.#parts.pins = held.length ? new THREE.InstancedMesh(new THREE.SphereGeometry(1, 10, 8), matter(0), held.length) : null;
            if (!pins) return;
            pins.material.color.set(PIN);
            pins.frustumCulled = false;
            this.#parts.all.add(pins);
        }
        const matrix = new THREE.Matrix4(), place = (p) => new THREE.Vector3().fromArray(positions, 3 * p);
        const apart = held.length > 1 ? place(held[0]).distanceTo(place(held[1])) : Infinity, radius = Math.min(0.0022 * (this.#parts.size ?? 1), 0.25 * apart);
        held.forEach((p, i) => pins.setMatrixAt(i, matrix.makeScale(radius, radius, radius).setPosition(positions[3 * p], positions[3 * p + 1], positions[3 * p + 2])));
        if (pins) pins.instanceMatrix.needsUpdate = true;
    }

    /* Gradients or forces: from a point along a vector, the longest of them a sixth of the scene. */
    #placeArrows(arrows) {
        const count = arrows ? arrows.from.length / 3 : 0;
        if (this.#arrows.count !== count || !this.#arrows.mesh) {
            this.#arrows.mesh?.removeFromParent();
            const material = new THREE.MeshStandardMaterial({color: COLOURS[1], roughness: 0.5, emissive: COLOURS[1], emissiveIntensity: 0.25});
            this.#arrows = {count, mesh: count ? new THREE.InstancedMesh(arrowGeometry(), material, count) : null};
            if (!count) return;
            this.#arrows.mesh.frustumCulled = false;
            this.#scene.add(this.#arrows.mesh);
        }
        const along = new THREE.Vector3(), at = new THREE.Vector3(), up = new THREE.Vector3(0, 1, 0), turn = new THREE.Quaternion(), matrix = new THREE.Matrix4();
        let most = 1e-12;
        for (let i = 0; i < count; i++) most = Math.max(most, along.fromArray(arrows.along, 3 * i).length());
        for (let i = 0; i < count; i++) {
            along.fromArray(arrows.along, 3 * i);
            const length = Math.max((along.length() / most) * (this.#parts.size ?? 1) * (count > 12 ? 0.07 : 0.17), 1e-9);
            turn.setFromUnitVectors(up, along.normalize());
            this.#arrows.mesh.setMatrixAt(i, matrix.compose(at.fromArray(arrows.from, 3 * i), turn, along.set(length, length, length)));
        }
        this.#arrows.mesh.instanceMatrix.needsUpdate = true;
    }

    /* Where a camera has all in the picture, as near as that goes, from where the scene's view says. What stands around large things is cut off rather than that the bodies become small. */
    #hold() {
        const {positions} = this.#state, box = new THREE.Box3(), point = new THREE.Vector3(), corners = [];
        for (let i = 0; i < positions.length; i += 3) box.expandByPoint(point.fromArray(positions, i));
        const own = box.clone(), {world, colliders} = this.#parts, view = world.settings.view, camera = view.camera ?? {};
        for (const mesh of colliders)
            if (mesh && mesh.userData.sort !== 'plane') {
                mesh.geometry.computeBoundingBox();
                const theirs = mesh.geometry.boundingBox.clone().applyMatrix4(mesh.matrix);
                box.union(theirs);
                for (let k = 0; k < 8; k++) corners.push(new THREE.Vector3(...'xyz'.split('').map((axis, j) => ((k >> j) & 1 ? theirs.max : theirs.min)[axis])));
            }
        const under = world.colliders.findIndex((c) => isLevel(c) && c.visible), level = under < 0 ? null : this.#state.poses[under].position[1];
        if (level !== null && box.min.y - level < box.getSize(point).length()) {
            box.expandByPoint(box.getCenter(point).setY(level));
            for (const {firstParticle: first, particleCount: count} of world.bodies) { // and where each body comes to lie
                const sum = [0, 0, 0];
                for (let i = 3 * first; i < 3 * (first + count); i++) sum[i % 3] += positions[i] / count;
                if (count) corners.push(new THREE.Vector3(sum[0], level, sum[2]));
            }
        } else if (view.ground !== false) corners.push(box.getCenter(new THREE.Vector3()).setY(box.min.y - 0.2 * box.getSize(point).length())); // room to sink, and for a shadow
        const centre = box.getCenter(new THREE.Vector3()), size = Math.max(box.getSize(point).length(), 1e-3);
        const turn = THREE.MathUtils.degToRad(camera.azimuth ?? 27), height = THREE.MathUtils.degToRad(camera.elevation ?? 14);
        const back = new THREE.Vector3(Math.sin(turn) * Math.cos(height), Math.sin(height), Math.cos(turn) * Math.cos(height));
        const tall = 0.79 * Math.tan(THREE.MathUtils.degToRad(this.#camera.fov / 2)), {aspect} = this.#camera, zoom = camera.zoom ?? 1;
        let held = null;
        for (let share = 1; share > -0.1 && !(held?.large >= 0.31); share -= 0.2)
            held = hold(positions, corners.map((corner) => own.clampPoint(corner, new THREE.Vector3()).lerp(corner, share)), centre, back, tall * zoom, aspect, size / zoom);
        return {...held, back, size, level, centre, lowest: box.min.y};
    }
    /* Turns the camera there; sun and ground follow. */
    frame() {
        const held = this.#hold(), {back, size, level, centre} = held;
        this.#drifting = false;
        this.#byHand = false;
        this.#parts.framed = true;
        this.#parts.size = size;
        this.#parts.level = level !== null;
        this.#camera.near = held.far / 200;
        this.#camera.far = Math.max(held.far, size) * 60;
        this.#camera.updateProjectionMatrix();
        this.controls.target.copy(held.target);
        this.#camera.position.copy(back).multiplyScalar(held.far).add(held.target);
        this.controls.update();
        this.#lightAndGround(centre, size, held.lowest, level);
        this.show(this.#state);
    }

    /* A flag that the wind turns round, a cloth that is let go: where the bodies leave the picture, and nobody has chosen a
     * view, the camera goes after them. */
    #goAfter({positions, playing}) {
        if (!playing || this.#byHand || !this.controls.enabled || !positions.length) return;
        const sum = [0, 0, 0];
        for (let i = 0; i < positions.length; i++) sum[i % 3] += positions[i];
        const middle = new THREE.Vector3(...sum).multiplyScalar(3 / positions.length);
        const seen = middle.clone().project(this.#camera), off = Math.max(Math.abs(seen.x), Math.abs(seen.y));
        this.#drifting = off > (this.#drifting ? 0.1 : 0.6) && off < 30; // (what has blown up is nowhere)
        if (!this.#drifting) return;
        const {target} = this.controls, ahead = this.#camera.getWorldDirection(new THREE.Vector3()), way = middle.sub(target).multiplyScalar(0.06);
        way.addScaledVector(ahead, -way.dot(ahead));
        target.add(way);
        this.#camera.position.add(way);
        this.controls.update();
        this.#light.aim(target, this.#parts.size);
    }

    #lightAndGround(centre, size, lowest, level) {
        const height = level ?? lowest - 0.3 * size; // what hangs and falls has room
        this.#light.aim(centre, size);
        this.#setGround({size, height, centre});
    }

    /* Where no plane is the ground, it goes out of the way of what sinks. */
    #lowerGround({positions}) {
        if (!this.#parts.framed || this.#parts.level || !this.#ground) return;
        let lowest = Infinity;
        for (let i = 1; i < positions.length; i += 3) lowest = Math.min(lowest, positions[i]);
        const {size, height, centre} = this.#ground.userData;
        if (lowest < height + 0.02 * size && lowest > -1e6) this.#setGround({size, height: lowest - 0.15 * size, centre});
    }

    #setGround({size, height, centre}) {
        if (this.#ground) {
            this.#scene.remove(this.#ground);
            this.#ground.geometry.dispose();
            this.#ground.material.dispose();
        }
        const power = 10 ** Math.floor(Math.log10(size / 9)), cell = power * [5, 2, 1].find((n) => n * power <= size / 9);
        this.#ground = new THREE.Mesh(new THREE.CircleGeometry(30 * size, 64).rotateX(-Math.PI / 2), ground(this.#look, cell, size));
        this.#ground.position.copy(centre).setY(height - 0.001 * size);
        this.#ground.receiveShadow = true;
        this.#ground.userData = {size, height, centre};
        this.#scene.add(this.#ground);
        this.#ground.visible = this.#parts.world.settings.view.ground !== false;
    }

    /* ---- the hand ---- */

    #pointer(event) {
        const box = this.canvas.getBoundingClientRect();
        return new THREE.Vector2((2 * (event.clientX - box.left)) / box.width - 1, 1 - (2 * (event.clientY - box.top)) / box.height);
    }
    #ray(event) {
        const caster = new THREE.Raycaster();
        caster.setFromCamera(this.#pointer(event), this.#camera);
        return caster;
    }

    /* The particle under a pointer: a surface's corner, or a ball or bird within some pixels; where the pointer is on none,
     * a surface's corner within some pixels, too, for borders are thin and move; null where none is. */
    pick(event) {
        if (!this.#parts || !this.#state) return null;
        const caster = this.#ray(event), {surfaces, balls, birds, rods, world, colliders} = this.#parts, {positions} = this.#state;
        let best = {distance: Infinity, particle: -1};
        surfaces.forEach((shape, i) => {
            if (!shape) return;
            shape.computeBoundingSphere();
            const hit = caster.intersectObject(new THREE.Mesh(shape, new THREE.MeshBasicMaterial({side: THREE.DoubleSide})), false)[0];
            if (!hit || hit.distance >= best.distance) return;
            const point = new THREE.Vector3(), away = (v) => point.fromArray(shape.attributes.position.array, 3 * v).distanceTo(hit.point);
            const vertex = [hit.face.a, hit.face.b, hit.face.c].reduce((a, b) => (away(b) < away(a) ? b : a));
            best = {distance: hit.distance, particle: world.bodies[i].particleOfVertex[vertex]};
        });
        const box = this.canvas.getBoundingClientRect(), here = this.#pointer(event), point = new THREE.Vector3();
        let nearest = event.pointerType === 'touch' ? 28 : 14;
        const look = (p) => {
            const distance = point.fromArray(positions, 3 * p).distanceTo(this.#camera.position);
            point.project(this.#camera);
            const pixels = Math.hypot((point.x - here.x) * box.width, (point.y - here.y) * box.height) / 2;
            if (pixels < nearest && point.z < 1) {
                nearest = pixels;
                best = {distance, particle: p};
            }
        };
        for (const p of [...balls, ...birds, ...rods]) look(p);
        if (best.particle < 0) surfaces.forEach((shape, i) => shape && world.bodies[i].particleOfVertex.forEach(look));
        const wall = caster.intersectObjects(colliders.filter((c) => c && !['plane', 'bowl'].includes(c.userData.sort)), false)[0];
        if (best.particle < 0 || (wall && wall.distance < best.distance - 0.02)) return null;
        return best.particle;
    }
    ray(event) {
        const {origin, direction} = this.#ray(event).ray;
        return {origin: origin.toArray(), direction: direction.toArray()};
    }
    /* The triangle that a pointer's stroke on the page sweeps: from the eye through both ends, to beyond all there is. */
    blade(from, to) {
        const far = (at) => {
            const {origin, direction} = this.#ray(at).ray;
            return origin.clone().addScaledVector(direction, 4 * origin.distanceTo(this.controls.target) + 4 * (this.#parts.size ?? 1));
        };
        return [this.#camera.position, far(from), far(to)].map((point) => point.toArray());
    }
    place(particle) {
        return new THREE.Vector3().fromArray(this.#state.positions, 3 * particle);
    }
    /* Where the pointer is in the plane through a point that faces the camera. */
    inPlane(event, through) {
        const plane = new THREE.Plane().setFromNormalAndCoplanarPoint(this.#camera.getWorldDirection(new THREE.Vector3()), through);
        return this.#ray(event).ray.intersectPlane(plane, new THREE.Vector3())?.toArray() ?? null;
    }
    /* How many triangles of bodies are drawn. */
    get drawnTriangles() {
        return this.#parts.surfaces.reduce((sum, shape) => sum + (shape ? shape.index.count / 3 : 0), 0);
    }
    /* Where on the page a particle is, for tests and for help. */
    onPage(particle) {
        const box = this.canvas.getBoundingClientRect(), point = this.place(particle).project(this.#camera);
        return [box.left + ((point.x + 1) / 2) * box.width, box.top + ((1 - point.y) / 2) * box.height];
    }
}
