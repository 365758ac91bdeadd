// What things are painted with: the gallery's colours, gingham, jelly, birds that beat.
import * as THREE from 'three';

import {THROUGH} from './light.js';

// as in render/frame.c
export const COLOURS = ['#c9412a', '#eda333', '#408f8f', '#8f5485', '#789954', '#5c78b3'];
const CREAM = '#f6e7d0', PAINT = '#2b5f75';
export const PIN = '#22262b';
// sun and around: how bright the sun is, and the light from sky and ground
export const LOOKS = {
    light: {horizon: '#e9ecec', zenith: '#4d8fd1', ground: '#c1b9b0', grid: '#8d857b', collider: PAINT, sun: 1.27, around: 1.15},
    dark: {horizon: '#2f353c', zenith: '#10151d', ground: '#3c3e41', grid: '#5c6167', collider: '#3f7488', sun: 0.95, around: 13},
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
function painted(material, head, code, uniforms, after = '', through = false) {
    material.onBeforeCompile = (shader) => {
        Object.assign(shader.uniforms, uniforms);
        shader.fragmentShader = shader.fragmentShader
            .replace('#include <common>', `#include <common>\n${head}`)
            .replace('#include <color_fragment>', `#include <color_fragment>\n${code}`)
            .replace('#include <emissivemap_fragment>', `#include <emissivemap_fragment>\n${after}`);
        if (through) shader.fragmentShader = shader.fragmentShader.replace('#include <lights_physical_pars_fragment>', `#include <lights_physical_pars_fragment>\n${THROUGH}`);
    };
    return material;
}

export function cloth(number, side, woven) {
    const material = new THREE.MeshStandardMaterial({color: COLOURS[number % COLOURS.length], side, roughness: 0.9});
    material.shadowSide = THREE.DoubleSide;
    if (!woven) return painted(material, '', '', {}, '', true);
    material.defines.USE_UV = '';
    // fibres that stand up catch light at grazing angles
    const after = `
        float grazing = pow(1.0 - abs(dot(normalize(vNormal), normalize(vViewPosition))), 4.0);
        totalEmissiveRadiance += 0.06 * grazing;`;
    return painted(material, `uniform vec3 accent;${GINGHAM}`, 'diffuseColor.rgb = gingham(diffuseColor.rgb, accent, vUv);',
        {accent: {value: new THREE.Color(CREAM)}}, after, true);
}

/* Smooth, and lit through: brighter where it is thin to the eye. */
export function jelly(number) {
    const material = new THREE.MeshPhysicalMaterial({color: COLOURS[number % COLOURS.length], shadowSide: THREE.FrontSide, roughness: 0.22, clearcoat: 0.7, clearcoatRoughness: 0.2});
    const after = `
        float facing = abs(dot(normalize(vNormal), normalize(vViewPosition)));
        totalEmissiveRadiance += diffuseColor.rgb * mix(0.8, 0.38, facing);`;
    return painted(material, '', '', {}, after);
}

export const matter = (number) => new THREE.MeshStandardMaterial({color: COLOURS[number % COLOURS.length], roughness: 0.55, shadowSide: THREE.FrontSide});

export function collider(sort) {
    const bowl = sort === 'bowl';
    return new THREE.MeshStandardMaterial({roughness: bowl ? 0.15 : 0.45, shadowSide: THREE.FrontSide, transparent: bowl, opacity: bowl ? 0.2 : 1, depthWrite: !bowl});
}
/* A bowl's far wall: cream, with a rim and meridians that tell a turn. */
export function bowlInside() {
    const material = new THREE.MeshStandardMaterial({color: CREAM, roughness: 0.35, side: THREE.BackSide, shadowSide: THREE.DoubleSide});
    material.onBeforeCompile = (shader) => {
        shader.uniforms.paint = {value: new THREE.Color(PAINT)};
        shader.vertexShader = shader.vertexShader
            .replace('#include <common>', '#include <common>\nvarying vec3 outward;')
            .replace('#include <begin_vertex>', '#include <begin_vertex>\noutward = position;');
        shader.fragmentShader = shader.fragmentShader
            .replace('#include <common>', `#include <common>
                varying vec3 outward;
                uniform vec3 paint;
                float band(float off, float half_width) {
                    float edge = max(fwidth(off), 1e-5);
                    return 1.0 - smoothstep(half_width - 0.7 * edge, half_width + 0.7 * edge, abs(off));
                }`)
            .replace('#include <color_fragment>', `#include <color_fragment>
                vec3 away = normalize(outward);
                float meridian = max(band(dot(vec3(0.924, 0.0, 0.383), away), 0.012), band(dot(vec3(-0.383, 0.0, 0.924), away), 0.012));
                diffuseColor.rgb = mix(diffuseColor.rgb, paint, max(band(away.y + 0.4226, 0.035), 0.35 * meridian));`); // the rim is 115 degrees from the top
    };
    return material;
}

/* The ground: lines of a grid with cells of `cell` metres and heavier ones of five, averaged over a pixel; it goes over into
 * the sky's haze some `size`s out. */
export function ground(look, cell, size) {
    const material = new THREE.MeshStandardMaterial({color: look.ground, roughness: 1});
    material.onBeforeCompile = (shader) => {
        Object.assign(shader.uniforms, {lineColour: {value: new THREE.Color(look.grid)}, horizon: {value: new THREE.Color(look.horizon)}, cell: {value: cell}, size: {value: size}});
        shader.vertexShader = shader.vertexShader
            .replace('#include <common>', '#include <common>\nvarying vec2 onGround, fromMiddle;')
            .replace('#include <project_vertex>', '#include <project_vertex>\nonGround = (modelMatrix * vec4(transformed, 1.0)).xz;\nfromMiddle = transformed.xz;');
        shader.fragmentShader = shader.fragmentShader
            .replace('#include <common>', `#include <common>
                varying vec2 onGround, fromMiddle;
                uniform vec3 lineColour, horizon;
                uniform float cell, size;
                float lines(vec2 x, float half_width) {
                    vec2 pixel = max(fwidth(x), vec2(1e-6)), off = abs(fract(x - 0.5) - 0.5), wide = max(vec2(half_width), 0.5 * pixel);
                    vec2 cover = clamp((wide - off) / pixel + 0.5, 0.0, 1.0) * (half_width / wide);
                    cover = mix(cover, vec2(2.0 * half_width), clamp(pixel * 2.0 - 0.5, 0.0, 1.0));
                    return max(cover.x, cover.y);
                }`)
            .replace('#include <color_fragment>', `#include <color_fragment>
                float line_ = max(0.4 * lines(onGround / cell, 0.008), 0.7 * lines(onGround / (5.0 * cell), 0.003));
                diffuseColor.rgb = mix(diffuseColor.rgb, lineColour, line_);`)
            .replace('#include <opaque_fragment>', `
                float out_ = length(fromMiddle) / (8.0 * size);
                outgoingLight = mix(outgoingLight, horizon, 1.0 - exp(-out_ * out_));
                #include <opaque_fragment>`);
    };
    return material;
}

/* Wings in two parts, of which the outer one follows the inner, as in render/shaders/bird.vert.glsl: each bird at its own
 * moment of the beat, by `time`. Downwards they glide. */
export function feathers(time) {
    const material = new THREE.MeshStandardMaterial({roughness: 0.8, side: THREE.DoubleSide, flatShading: true});
    material.onBeforeCompile = (shader) => {
        shader.uniforms.beatTime = time;
        shader.vertexShader = shader.vertexShader
            .replace('#include <common>', '#include <common>\nuniform float beatTime;')
            .replace('#include <begin_vertex>', `#include <begin_vertex>
                if (abs(transformed.x) > 0.04 && transformed.y > 0.02 && transformed.y < 0.04) {
                    float climb = normalize((modelMatrix * instanceMatrix)[2].xyz).y, phase = beatTime * 18.0 + float(gl_InstanceID) * 2.399;
                    float stroke = 0.75 * mix(0.3, 1.0, smoothstep(-0.5, 0.1, climb));
                    float inner = stroke * sin(phase) + 0.12, outer = inner + 0.8 * stroke * sin(phase - 0.9) - 0.1;
                    float along = abs(transformed.x), wrist = min(along, 0.5), beyond = along - wrist;
                    transformed.x = sign(transformed.x) * (wrist * cos(inner) + beyond * cos(outer));
                    transformed.y += wrist * sin(inner) + beyond * sin(outer);
                }`);
    };
    return material;
}
/* Each bird of a flock has a colour of its own. */
export function plumage(number) {
    const own = (k) => (number * k) % 1, hue = [0, 0.33, 0.67].map((k) => 0.5 + 0.42 * Math.cos(2 * Math.PI * (own(0.6180339887) + k)));
    return new THREE.Color(...hue.map((c) => c * c * (0.7 + 0.6 * own(0.7548776662))));
}
