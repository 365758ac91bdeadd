// A bowl's far wall, which we see from within, or its near one: GLASS, so that what lies in the bowl can be seen.
in vec3 outward;
out vec4 colour;

layout(location = 0) uniform vec4 centre_radius;
layout(location = 1) uniform vec3 paint;
layout(location = 2) uniform vec3 marking;
layout(location = 3) uniform float rim; // the height of it, from -1 to 1
layout(location = 4) uniform mat3 turned; // by columns: the bowl's own axes

float band(float off, float half_width) {
    float edge = max(fwidth(off), 1e-5);
    return 1.0 - smoothstep(half_width - 0.7 * edge, half_width + 0.7 * edge, abs(off));
}

void main() {
    vec3 out_there = normalize(outward);
#ifdef GLASS
    vec3 n = out_there;
#else
    vec3 n = -out_there;
#endif
    vec3 world = centre_radius.xyz + centre_radius.w * out_there, view = normalize(scene.eye.xyz - world);
    float edge = band(out_there.y - rim, 0.035);
    n = normalize(n + vec3(0.0, 0.8 * edge, 0.0)); // the rim is round
    float facing_sun = max(dot(n, scene.sun.xyz), 0.0);
#ifdef GLASS
    float glance = pow(1.0 - clamp(dot(n, view), 0.0, 1.0), 3.0);
    vec3 glass = glaze(n, view) * 5.0 + paint * ambient_light(n, 1.0);
    vec3 solid = paint * (scene.sun_light.rgb * facing_sun + ambient_light(n, 1.0));
    colour = vec4(display(mix(glass, solid, edge)), mix(0.10 + 0.45 * glance, 0.92, edge));
#else
    // meridians tell a turn
    vec3 where = out_there * turned;
    float lines = max(band(dot(vec3(0.924, 0.0, 0.383), where), 0.012), band(dot(vec3(-0.383, 0.0, 0.924), where), 0.012));
    vec3 albedo = mix(marking, paint, max(edge, 0.35 * lines));
    // the bowl hides a part of the sky from its own depth
    float open = mix(0.62, 1.0, smoothstep(-1.0, rim, out_there.y)) * balls_seen(world, n, -1);
    float seen = sun_seen(world, n);
    vec3 sun = scene.sun_light.rgb * seen * facing_sun;
    vec3 light = albedo * (sun + ambient_light(n, 1.0) * open) + 0.5 * glaze(n, view) * open + 0.3 * sun_spot(n, view, seen);
    colour = vec4(display(scene.modes.x == 1 ? blinn_phong(albedo, n, view) : light), 1.0);
#endif
}
