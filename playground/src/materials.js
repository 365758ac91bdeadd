// What things are painted with: the gallery's colours, gingham, jelly, birds that beat.
import * as THREE from 'three';

// as in render/frame.c
export const COLOURS = ['#c9412a', '#eda333', '#408f8f', '#8f5485', '#789954', '#5c78b3'];
const CREAM = '#f6e7d0', PAINT = '#3d7688';
export const LOOKS = {
    light: {sky: '#e3e8ea', ground: '#d6d1c6', grid: '#7d766a', collider: PAINT, bird: '#2c3238', light: 1},
    dark: {sky: '#1b1f24', ground: '#34373b', grid: '#666d74', collider: '#4a7c8d', bird: '#e4e7e8', light: 0.92},
};

/* Both dyed, one dyed, none, as gingham is woven; averaged over a pixel, so that it never shimmers. */
const GINGHAM = `
    vec2 wave(vec2 x, vec2 width) {
        vec2 from = abs(fract((x - 0.5 * width) * 0.5) - 0.5), to = abs(fract((x + 0.5 * width) * 0.5) - 0.5);
        return 2.0 * (from - to) / width;
    }
    vec3 gingham(vec3 base, vec3 accent, vec2 uv) {
        vec2 x = uv * 2.0, width = max(fwidth(x), vec2(1e-4)), w = wave(x, width);
        return mix(accent, base, 0.5 + 0.25 * (w.x + w.y));
    }`;

/* Changes a material before it is compiled: `code` paints diffuseColor. */
function painted(material, head, code, uniforms, after = '') {
    material.onBeforeCompile = (shader) => {
        Object.assign(shader.uniforms, uniforms);
        shader.fragmentShader = shader.fragmentShader
            .replace('#include <common>', `#include <common>\n${head}`)
            .replace('#include <color_fragment>', `#include <color_fragment>\n${code}`)
            .replace('#include <emissivemap_fragment>', `#include <emissivemap_fragment>\n${after}`);
    };
    return material;
}

export function cloth(number, side, woven) {
    const material = new THREE.MeshStandardMaterial({color: COLOURS[number % COLOURS.length], side, roughness: 0.82});
    material.shadowSide = THREE.DoubleSide;
    if (!woven) return material;
    material.defines.USE_UV = '';
    // light that comes through from behind, and fibres that catch it at grazing angles
    const after = `
        float grazing = pow(1.0 - abs(dot(normalize(vNormal), normalize(vViewPosition))), 4.0);
        totalEmissiveRadiance += diffuseColor.rgb * (0.05 + 0.16 * grazing);`;
    return painted(material, `uniform vec3 accent;${GINGHAM}`, 'diffuseColor.rgb = gingham(diffuseColor.rgb, accent, vUv);',
        {accent: {value: new THREE.Color(CREAM)}}, after);
}

/* Smooth, and lit through: brighter where it is thin to the eye. */
export function jelly(number) {
    const material = new THREE.MeshPhysicalMaterial({color: COLOURS[number % COLOURS.length], roughness: 0.22, clearcoat: 0.7, clearcoatRoughness: 0.2});
    const after = `
        float facing = abs(dot(normalize(vNormal), normalize(vViewPosition)));
        totalEmissiveRadiance += diffuseColor.rgb * mix(0.8, 0.38, facing);`;
    return painted(material, '', '', {}, after);
}

export const matter = (number) => new THREE.MeshStandardMaterial({color: COLOURS[number % COLOURS.length], roughness: 0.55});

export function collider(sort) {
    const bowl = sort === 'bowl';
    return new THREE.MeshStandardMaterial({
        roughness: 0.45, side: bowl ? THREE.DoubleSide : THREE.FrontSide, transparent: bowl, opacity: bowl ? 0.24 : 1, depthWrite: !bowl});
}

/* The ground: lines of a grid with cells of `cell` metres and heavier ones of five, averaged over a pixel. */
export function ground(colour, line, cell) {
    const material = new THREE.MeshStandardMaterial({color: colour, roughness: 1});
    material.onBeforeCompile = (shader) => {
        Object.assign(shader.uniforms, {lineColour: {value: new THREE.Color(line)}, cell: {value: cell}});
        shader.vertexShader = shader.vertexShader
            .replace('#include <common>', '#include <common>\nvarying vec2 onGround;')
            .replace('#include <project_vertex>', '#include <project_vertex>\nonGround = (modelMatrix * vec4(transformed, 1.0)).xz;');
        shader.fragmentShader = shader.fragmentShader
            .replace('#include <common>', `#include <common>
                varying vec2 onGround;
                uniform vec3 lineColour;
                uniform float cell;
                float lines(vec2 x, float half_width) {
                    vec2 pixel = max(fwidth(x), vec2(1e-6)), off = abs(fract(x - 0.5) - 0.5), wide = max(vec2(half_width), 0.5 * pixel);
                    vec2 cover = clamp((wide - off) / pixel + 0.5, 0.0, 1.0) * (half_width / wide);
                    cover = mix(cover, vec2(2.0 * half_width), clamp(pixel * 2.0 - 0.5, 0.0, 1.0));
                    return max(cover.x, cover.y);
                }`)
            .replace('#include <color_fragment>', `#include <color_fragment>
                float line_ = max(0.5 * lines(onGround / cell, 0.009), 0.75 * lines(onGround / (5.0 * cell), 0.0035));
                diffuseColor.rgb = mix(diffuseColor.rgb, lineColour, line_);`);
    };
    return material;
}

/* Wings that beat: each bird at its own moment of the beat, by `time`. */
export function feathers(time) {
    const material = new THREE.MeshStandardMaterial({roughness: 0.8, side: THREE.DoubleSide});
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
