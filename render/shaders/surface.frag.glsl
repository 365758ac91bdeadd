// Surfaces of bodies: cloth, jelly, plain.
centroid in vec3 world;
centroid in vec3 facing;
in vec3 place;
#ifdef FINE
centroid in vec3 light_here;
#endif
out vec4 colour;

layout(location = 1) uniform vec3 front;
layout(location = 2) uniform vec3 accent;
layout(location = 3) uniform vec3 lining;
layout(location = 4) uniform int pattern;
layout(location = 5) uniform vec2 repeats;
layout(location = 6) uniform float translucency;
layout(location = 7) uniform int rows_first; // an image's top is at u = 0, else at v = 1
layout(location = 8) uniform float map;      // which colour map

layout(binding = 3) uniform sampler1DArray colour_maps;
layout(binding = 4) uniform sampler2D image;

// A wave of -1 and 1 with period 2, averaged over `width`: never aliases.
vec2 square_wave(vec2 x, vec2 width) {
    vec2 from = abs(fract((x - 0.5 * width) * 0.5) - 0.5), to = abs(fract((x + 0.5 * width) * 0.5) - 0.5);
    return 2.0 * (from - to) / width;
}

vec3 pattern_colour(vec3 base) {
    if (pattern == 4) return texture(colour_maps, vec2(place.z, map)).rgb;
    if (pattern == 3) {
        vec2 at = rows_first == 1 ? (place.xy * repeats).yx : vec2(0.0, 1.0) + vec2(1.0, -1.0) * place.xy * repeats;
        return texture(image, at).rgb;
    }
    vec2 x = place.xy * repeats * 2.0;
    vec2 width = max(fwidth(x), vec2(1e-4));
    vec2 wave = square_wave(x, width);
    if (pattern == 1) return mix(base, accent, 0.5 + 0.5 * wave.x * wave.y);
    if (pattern != 2) return base;

    // gingham: both dyed, one dyed, none; then threads that run across each other
    float dye = 0.5 + 0.25 * (wave.x + wave.y);
    vec3 cloth = mix(accent, base, dye);
    const float threads = 7.0;
    vec2 seen = clamp(1.0 - 1.6 * width * threads, 0.0, 1.0);
    vec2 ridge = cos(x * threads * 6.2831853) * seen;
    return cloth * (1.0 + 0.07 * ridge.x * (1.0 - 0.5 * ridge.y) + 0.05 * ridge.y);
}

void main() {
    // the side that we look at: the normal is made to point to it
    vec3 view = normalize(scene.eye.xyz - world);
    vec3 n = dot(facing, facing) > 0.0 ? normalize(gl_FrontFacing ? facing : -facing) : view;
    n = normalize(n - min(dot(n, view), 0.0) * 1.01 * view); // a smooth normal may look away where its triangle does not
    vec3 albedo = pattern_colour(gl_FrontFacing ? front : lining);

    float cosine = dot(n, scene.sun.xyz);
#ifdef FINE
    float seen = light_here.x, open = light_here.y, below = light_here.z;
#else
    float seen = sun_seen(world, n), open = balls_seen(world, n, -1), below = ground_seen(world, n);
#endif
#ifdef GLAZED
    vec3 inner = jelly_light(world, albedo, n, view, cosine, seen, open, below);
    vec3 light = inner + glaze(n, view) * open * below + 0.8 * sun_spot(n, view, seen);
#else
    vec3 sun = scene.sun_light.rgb * seen * max(cosine, 0.0);
    vec3 through = scene.sun_light.rgb * seen * max(-cosine, 0.0) * translucency;
    vec3 ambient = ambient_light(n, below) * open;

    // fibres that stand up catch light at grazing angles
    float rim = pow(1.0 - clamp(dot(n, view), 0.0, 1.0), 4.0);
    vec3 sheen = (0.10 * sun + 0.16 * ambient) * rim;
    vec3 half_way = normalize(scene.sun.xyz + view);
    vec3 gloss = sun * 0.05 * pow(max(dot(n, half_way), 0.0), 18.0);
    vec3 light = albedo * (sun + ambient) + albedo * albedo * through + sheen + gloss;
#endif
    colour = vec4(display(scene.modes.x == 1 ? blinn_phong(albedo, n, view) : light), 1.0);
}
