// Particles as balls.
centroid in vec3 facing;
centroid in vec3 own;
flat in vec4 ball;
flat in vec3 ball_paint;
flat in vec3 ball_marking;
flat in int number;
#ifdef FINE
flat in vec3 light_here;
#endif
out vec4 colour;

// 1 for colliders, whose numbers are those of scene.balls; 0 for particles
layout(location = 1) uniform int collider;

// A band about the great circle across `axis`, of half-width `half_width` (radii), with soft edges.
float band(vec3 axis, float half_width, vec3 where) {
    float off = abs(dot(axis, where));
    float edge = max(fwidth(dot(axis, where)), 1e-5);
    return 1.0 - smoothstep(half_width - 0.7 * edge, half_width + 0.7 * edge, off);
}

void main() {
    vec3 n = normalize(facing), where = normalize(own);
    vec3 world = ball.xyz + ball.w * n;
    vec3 view = normalize(scene.eye.xyz - world);

#ifdef FINE
    vec3 albedo = ball_paint;
    float seen = light_here.x, open = light_here.y, below = light_here.z;
#else
    // four meridians and the equator, so that a turn about any axis shows
    float marked = band(vec3(0.0, 1.0, 0.0), 0.075, where);
    marked = max(marked, band(vec3(0.924, 0.0, 0.383), 0.028, where));
    marked = max(marked, band(vec3(-0.383, 0.0, 0.924), 0.028, where));
    vec3 albedo = mix(ball_paint, ball_marking, marked);

    float seen = sun_seen(world, n), below = ground_seen(world, n);
    float open = balls_seen(world, n, collider == 1 ? number : -1);
#endif
    vec3 sun = scene.sun_light.rgb * seen * max(dot(n, scene.sun.xyz), 0.0);
    vec3 ambient = ambient_light(n, below) * open;

    vec3 light = albedo * (sun + ambient) + glaze(n, view) * open * below + sun_spot(n, view, seen);
    colour = vec4(display(scene.modes.x == 1 ? blinn_phong(albedo, n, view) : light), 1.0);
}
