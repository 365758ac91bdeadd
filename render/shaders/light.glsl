// Shadows and occlusion: for stages that receive light. A fragment stage turns its taps from pixel to pixel, which
// hides that they are few; a vertex stage, which is FINE, does not.

layout(binding = 0) uniform sampler2DShadow sun_compare;
layout(binding = 1) uniform sampler2D sun_depth;
layout(binding = 2) uniform sampler2D under_light;

#ifdef FINE // a vertex stage
float first_turn() {
    return 0.0;
}
#else
float first_turn() {
    return 6.2831853 * fract(52.9829189 * fract(dot(gl_FragCoord.xy, vec2(0.06711056, 0.00583715))));
}
#endif

const mat2 golden_turn = mat2(-0.737369, 0.675490, -0.675490, -0.737369);
const mat2 seventh_turn = mat2(0.623490, 0.781831, -0.781831, 0.623490);

// The sun's light at an offset from a place in the map, if the receiver went on as a plane; 0 to 1.
float compare(vec3 at, vec2 offset, vec2 slope, float bias) {
    return textureLod(sun_compare, vec3(at.xy + offset, min(at.z + dot(slope, offset) - bias, 1.0)), 0.0);
}

// The part of the sun that is seen from a point, 0 to 1. The shadow's edge is as wide as the sun's
// disc makes it: percentage-closer soft shadows (Fernando 2005), on a disc of golden-angle taps that
// is turned from pixel to pixel. The receiver counts as a plane, so that a wide disc casts no shadow of
// itself.
float sun_seen(vec3 point, vec3 normal) {
    // from a little off the surface, more where the sun grazes it: the map's texels are steps, and triangles are flat
    float slant = dot(normal, scene.sun.xyz);
    float off = sqrt(max(1.0 - slant * slant, 0.0)) * 1.5 * scene.sun_map.z / scene.sun_map.x;
    vec3 at = (scene.to_sun * vec4(point + normal * (slant < 0.0 ? -off : off), 1.0)).xyz;
    bool outside = any(lessThan(at, vec3(0.0))) || any(greaterThan(at.xy, vec2(1.0)));
    if (scene.sun_map.w == 0.0 || outside) return 1.0;

    // how depth changes along uv on the receiver's own plane; nearly edge on it would grow without end
    float metres = scene.sun_map.y, texel = scene.sun_map.z, per_metre = scene.sun_map.x;
    vec3 tilt = mat3(scene.to_sun) * normal * vec3(1.0 / per_metre, 1.0 / per_metre, metres);
    vec2 slope = -tilt.xy / (per_metre * metres * max(abs(tilt.z), 0.12)) * sign(tilt.z);
    float bias = 1.6 * texel / per_metre / metres;

    float turn = first_turn();
    vec2 start = vec2(cos(turn), sin(turn));

    // what stands between here and the sun's disc, on the average: the cone towards it opens with the gap
    float cone = metres * scene.sun.w * per_metre;
    float reach = clamp(at.z * cone, 2.0 * texel, 0.12);
    vec2 spoke = start;
    float blockers = 0.0, depth_sum = 0.0;
    for (int i = 0; i < scene.counts.y; i++) {
        float part = (float(i) + 0.5) / float(scene.counts.y), away = part * part * reach;
        float depth = textureLod(sun_depth, at.xy + spoke * away, 0.0).r;
        float limit = at.z + min(dot(slope, spoke * away) - bias, -0.4 * (away - 2.0 * texel) / cone);
        if (depth < min(limit, 1.0)) {
            blockers += 1.0;
            depth_sum += depth;
        }
        spoke = golden_turn * spoke;
    }
    if (blockers == 0.0) return 1.0;
    float width = clamp((at.z - depth_sum / blockers) * cone, 1.5 * texel, reach);

    // two rings, near the rim and within, tell whether this is penumbra at all
    float light = 0.0;
    for (int i = 0; i < scene.counts.w; i++) {
        light += compare(at, spoke * width * ((i & 1) == 0 ? 0.9 : 0.4), slope, bias);
        spoke = seventh_turn * spoke;
    }
    // (few blockers count in part: that hides which pixels happened to find them)
    float sure = min(0.4 * blockers, 1.0);
    if (light == 0.0 || light == float(scene.counts.w)) return mix(1.0, light / float(scene.counts.w), sure);

    light = 0.0;
    for (int i = 0; i < scene.counts.z; i++) {
        float away = sqrt((float(i) + 0.5) / float(scene.counts.z)) * width;
        light += compare(at, spoke * away, slope, bias);
        spoke = golden_turn * spoke;
    }
    return mix(1.0, light / float(scene.counts.z), sure);
}

// The part of the sky's light that reaches the ground at a point, 0 to 1.
float under_seen(vec3 point) {
    if (scene.under_map.w == 0.0) return 1.0;
    vec2 uv = (point.xz - scene.under_map.xy) * scene.under_map.z;
    return texture(under_light, uv).r;
}

// The part of the sky's light that the spheres leave, after Inigo Quilez's sphere occlusion. `own` is
// the sphere the point lies on, or -1.
float balls_seen(vec3 point, vec3 normal, int own) {
    float light = 1.0;
    for (int i = 0; i < scene.counts.x; i++) {
        if (i == own) continue;
        vec3 away = scene.balls[i].xyz - point;
        float distance = length(away);
        float cosine = dot(normal, away / distance);
        float h = max(distance / scene.balls[i].w, 1.0), h2 = h * h;
        float hidden = max(cosine, 0.0) / h2;
        if (h2 * cosine * cosine < 1.0) hidden = pow(clamp(0.5 * (cosine * h + 1.0) / h2, 0.0, 1.0), 1.5);
        light *= 1.0 - hidden;
    }
    return light;
}

// How much of the ground's light reaches a point above it: less where the ground lies in the dark. A wall sees the
// ground before it, the farther out the higher up.
float ground_seen(vec3 point, vec3 normal) {
    float out_there = 0.5 * max(point.y - scene.ground.w, 0.0) + 0.03 / scene.under_map.z;
    return mix(0.25, 1.0, under_seen(point + normal * vec3(out_there, 0.0, out_there)));
}
