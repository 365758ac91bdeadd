// The light of pictures, as render/shaders has it: a sun whose disc makes shadows soft, the farther from what casts them the
// softer; light from the sky and from the ground; a sky that is pale above the horizon; and how light becomes colour.
import * as THREE from 'three';

const SUN = new THREE.Vector3(-0.62, 0.86, 0.42).normalize(), SPREAD = Math.tan(THREE.MathUtils.degToRad(2.2));

/* Straight up to 0.76, then ever flatter and paler. */
const DISPLAY = `
    vec3 CustomToneMapping(vec3 light) {
        float peak = max(light.r, max(light.g, light.b));
        if (peak > 0.76) {
            float squeezed = 1.0 - 0.0576 / (peak - 0.52);
            light = mix(vec3(squeezed), light * (squeezed / peak), 1.0 / (0.15 * (peak - squeezed) + 1.0));
        }
        return light;
    }`;

/* Percentage-closer soft shadows (Fernando 2005), on discs of golden-angle taps that are turned from pixel to pixel. The
 * light's radius is here how far the cone towards the sun's disc opens, in uv over the whole depth. What is nearer than the
 * cone allows at a tap is the receiver itself, and counts for nothing. */
const SHADOW = `
    bool hidesSun(sampler2D map, vec3 at, vec2 offset, float away, float bias, float cone, out float depth) {
        depth = texture2D(map, at.xy + offset).r;
        return depth < at.z - max(bias, 0.4 * away / cone);
    }
    float getShadow(sampler2D map, vec2 size, float intensity, float bias, float cone, vec4 coord) {
        vec3 at = coord.xyz / coord.w;
        if (any(lessThan(at, vec3(0.0))) || any(greaterThan(at, vec3(1.0)))) return 1.0;
        const mat2 golden = mat2(-0.737369, 0.675490, -0.675490, -0.737369);
        float texel = 1.0 / size.x, turn = 6.2831853 * fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715))));
        float reach = clamp(at.z * cone, 2.0 * texel, 0.06), blockers = 0.0, sum = 0.0, depth;
        vec2 spoke = vec2(cos(turn), sin(turn));
        for (int i = 0; i < 10; i++) {
            float part = (float(i) + 0.5) / 10.0, away = part * part * reach;
            if (hidesSun(map, at, spoke * away, max(away - 2.0 * texel, 0.0), bias, cone, depth)) {
                blockers += 1.0;
                sum += depth;
            }
            spoke = golden * spoke;
        }
        if (blockers == 0.0) return 1.0;
        float width = clamp((at.z - sum / blockers) * cone, 1.5 * texel, reach), hidden = 0.0;
        for (int i = 0; i < 18; i++) {
            float away = sqrt((float(i) + 0.5) / 18.0) * width;
            if (hidesSun(map, at, spoke * away, max(away - 2.0 * texel, 0.0), bias, cone, depth)) hidden += 1.0;
            spoke = golden * spoke;
        }
        return mix(1.0, 1.0 - hidden / 18.0, intensity * min(0.4 * blockers, 1.0));
    }`;

/* three's own shaders, changed once: what lies on the sun's side is looked for from that side of a surface, so that light
 * which comes through a cloth is found, too. */
function change(name, from, to) {
    const {[name]: chunk} = THREE.ShaderChunk, changed = chunk.replace(from, to);
    if (changed === chunk) throw new Error(`three has another ${name}`);
    THREE.ShaderChunk[name] = changed;
}
change('tonemapping_pars_fragment', 'vec3 CustomToneMapping( vec3 color ) { return color; }', DISPLAY);
change('shadowmap_pars_fragment', /(#else\s+(?:\/\/.*\s+)?)float getShadow\([\s\S]*?(#endif\s+#if NUM_SUN_LIGHT_SHADOWS > 0\s+float getSunShadow)/, `$1${SHADOW}\n$2`);
change('shadowmap_vertex', 'shadowWorldNormal * directionalLightShadows[ i ].shadowNormalBias',
    `shadowWorldNormal * directionalLightShadows[ i ].shadowNormalBias *
        (dot(vec3(directionalShadowMatrix[ i ][0].z, directionalShadowMatrix[ i ][1].z, directionalShadowMatrix[ i ][2].z), shadowWorldNormal) > 0.0 ? -1.0 : 1.0)`);

/* Cloth lets a third of the sun's light through, dyed twice. */
export const THROUGH = `
    void RE_Direct_Cloth(const in IncidentLight directLight, const in vec3 position, const in vec3 normal, const in vec3 view,
            const in vec3 clearcoat, const in PhysicalMaterial material, inout ReflectedLight reflected) {
        RE_Direct_Physical(directLight, position, normal, view, clearcoat, material, reflected);
        float behind = saturate(-dot(normal, directLight.direction));
        reflected.directDiffuse += 0.3 * behind * directLight.color * BRDF_Lambert(material.diffuseColor * material.diffuseColor);
    }
    #undef RE_Direct
    #define RE_Direct RE_Direct_Cloth`;

export function setUpRenderer(renderer) {
    renderer.shadowMap.enabled = true;
    renderer.shadowMap.type = THREE.BasicShadowMap; // whose part of the shader is the one above
    renderer.toneMapping = THREE.CustomToneMapping;
}

export class Light {
    sun = new THREE.DirectionalLight('#ffffff', 1);
    #around = new THREE.LightProbe();
    #sky;

    constructor(scene) {
        const material = new THREE.ShaderMaterial({
            side: THREE.BackSide, depthWrite: false, uniforms: {horizon: {value: new THREE.Color()}, zenith: {value: new THREE.Color()}},
            vertexShader: `
                varying vec3 ray;
                void main() {
                    ray = position;
                    gl_Position = (projectionMatrix * vec4(mat3(viewMatrix) * position, 1.0)).xyww;
                }`,
            fragmentShader: `
                varying vec3 ray;
                uniform vec3 horizon, zenith;
                void main() {
                    float height = max(normalize(ray).y, 0.0);
                    gl_FragColor = vec4(mix(horizon, zenith, 1.0 - exp(-14.0 * height)), 1.0);
                    #include <tonemapping_fragment>
                    #include <colorspace_fragment>
                }`,
        });
        this.#sky = new THREE.Mesh(new THREE.SphereGeometry(1, 48, 64), material);
        this.#sky.frustumCulled = false;
        this.#sky.renderOrder = 1; // it lies at the far end, and is worked out where nothing else is
        this.sun.castShadow = true;
        this.sun.shadow.mapSize.set(2048, 2048);
        scene.add(this.#sky, this.sun, this.sun.target, this.#around);
    }
    /* The colours of a look: sky, ground, and how bright both lights are. */
    set look({horizon, zenith, ground, sun, around}) {
        const {uniforms} = this.#sky.material, colour = (name) => new THREE.Color(name);
        uniforms.horizon.value.set(horizon);
        uniforms.zenith.value.set(zenith);
        this.sun.color.set('#fff9ee');
        this.sun.intensity = Math.PI * sun;
        // of a normal n: the sky's where it looks up, the ground's where it looks down, more on the sun's side; as harmonics
        const above = colour(horizon).lerp(colour(zenith), 0.35).multiplyScalar(0.57 * around), below = colour(ground).multiplyScalar(0.46 * around);
        const side = new THREE.Vector2(SUN.x, SUN.z).normalize(), first = Math.PI / 0.886227, second = Math.PI / 1.023328;
        const {coefficients} = this.#around.sh, rgb = ({r, g, b}, scale) => new THREE.Vector3(r, g, b).multiplyScalar(scale);
        coefficients[0].copy(rgb(above.clone().add(below), 0.5 * first));
        coefficients[1].copy(rgb(above, 0.5 * second)).sub(rgb(below, 0.5 * second));
        coefficients[2].copy(rgb(above, 0.19 * side.y * second));
        coefficients[3].copy(rgb(above, 0.19 * side.x * second));
    }
    /* The sun shines on a ball of so many metres about a place. */
    aim(centre, size) {
        const {sun} = this, {shadow} = sun, near = 0.01 * size, far = 5 * size;
        sun.position.copy(SUN).multiplyScalar(2 * size).add(centre);
        sun.target.position.copy(centre);
        Object.assign(shadow.camera, {left: -size, right: size, top: size, bottom: -size, near, far});
        shadow.camera.updateProjectionMatrix();
        shadow.normalBias = 0.003 * size;
        shadow.radius = (SPREAD * (far - near)) / (2 * size);
        shadow.bias = 0.0006;
    }
}
