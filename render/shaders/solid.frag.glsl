// Solids: colliders and rods.
centroid in vec3 world;
centroid in vec3 facing;
centroid in vec3 own;
flat in vec3 solid_paint;
flat in vec3 solid_marking;
flat in int is_rod;
#ifdef FINE
centroid in vec3 light_here;
#endif
out vec4 colour;

void main() {
    vec3 n = normalize(facing), view = normalize(scene.eye.xyz - world);
#ifdef FINE
    vec3 albedo = solid_paint;
    float seen = light_here.x, open = light_here.y, below = light_here.z;
#else
    // a box: its round edges; a rod: its ends, and a line along it that tells a turn about itself
    vec3 where = abs(normalize(own));
    float edge = is_rod == 1 ? max(where.x, own.y > 0.0 ? 0.16 - where.z : 0.0)
                             : 1.0 - max(where.x, max(where.y, where.z));
    float soft = max(fwidth(edge), 1e-5);
    vec3 albedo = mix(solid_paint, solid_marking, clamp((edge - 0.004) / soft, 0.0, 1.0));
    float seen = sun_seen(world, n), open = balls_seen(world, n, -1), below = ground_seen(world, n);
#endif
    vec3 sun = scene.sun_light.rgb * seen * max(dot(n, scene.sun.xyz), 0.0);
    vec3 ambient = ambient_light(n, below) * open;
    vec3 light = albedo * (sun + ambient);
#ifndef FINE
    light += glaze(n, view) * open * below + sun_spot(n, view, seen);
#endif
    colour = vec4(display(scene.modes.x == 1 ? blinn_phong(albedo, n, view) : light), 1.0);
}
