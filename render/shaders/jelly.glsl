// Jelly: light that goes into a body, is coloured on its way, and comes out elsewhere. How far it goes is known from an
// ellipsoid like the body: two square roots a way, no map and no pass of its own.

layout(location = 9) uniform vec3 body_middle;
layout(location = 10) uniform vec3 body_curve;    // 1 / half its axes, 1/m
layout(location = 11) uniform float body_thin;    // half the least of them, m

// The way from a place on the surface, within the body, along a direction of length 1: metres.
float way_within(vec3 from, vec3 direction) {
    vec3 p = (from - body_middle) * body_curve, d = direction * body_curve;
    float a = dot(d, d), b = dot(d, p);
    return max((sqrt(max(b * b - a * (dot(p, p) - 1.0), 0.0)) - b) / a, 0.0);
}

// What is left of white light after so many halves of the body's least thickness: the body's colour once for each. `ink`
// is the logarithm of that colour, to the base 2.
vec3 left_after(vec3 ink, float halves) {
    return exp2(ink * halves);
}

// What is seen through it: the sky, or the ground where it is not hidden from the sky.
vec3 seen_behind(vec3 from, vec3 ray) {
    if (ray.y > -0.02) return sky_colour(ray);
    vec3 at = from - ray * ((from.y - scene.ground.w) / ray.y);
    return scene.ground.rgb * scene.sun_light.rgb * mix(0.45, 0.85, under_seen(at));
}

// All its light but the gloss. `cosine` is of the sun, `seen` the part of it that arrives here; `open` and `below` are
// as for any surface.
vec3 jelly_light(vec3 world, vec3 albedo, vec3 normal, vec3 view, float cosine, float seen, float open, float below) {
    // light goes round: the sun's on a side that looks away, too, and there its own shadow does not count
    float wrapped = max(cosine + 0.4, 0.0) / 1.4;
    float lit = mix(1.0, seen, smoothstep(-0.1, 0.3, cosine));
    vec3 skin = albedo * (0.46 * scene.sun_light.rgb * wrapped * wrapped * lit + 0.42 * ambient_light(normal, below) * open);

    vec3 ink = log2(max(albedo, 0.012));
    // the sun's from within: it came in on the other side, and what is thin there glows
    vec3 glow = scene.sun_light.rgb * left_after(ink, 0.5 / body_thin * way_within(world, scene.sun.xyz)) * 0.26 * open;

    // and what is behind, bent
    vec3 ray = refract(-view, normal, 0.75);
    float way = way_within(world, ray);
    vec3 through = seen_behind(world + way * ray, ray) * left_after(ink, 0.95 / body_thin * way) * 0.55;
    return skin + glow + through;
}
