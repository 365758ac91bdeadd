// Spheres: one mesh of the unit sphere, an instance for each.
layout(location = 0) in vec3 direction;
layout(location = 1) in vec4 centre_radius;
layout(location = 2) in vec3 row_x;
layout(location = 3) in vec3 row_y;
layout(location = 4) in vec3 row_z;
layout(location = 5) in vec3 paint;
layout(location = 6) in vec3 marking;

centroid out vec3 facing;
centroid out vec3 own;
flat out vec4 ball;
flat out vec3 ball_paint;
flat out vec3 ball_marking;
flat out int number;
#ifdef FINE
flat out vec3 light_here; // what is seen from the ball's sunny side of the sun, of the whole sky, of the lit ground
#endif

void main() {
    facing = vec3(dot(row_x, direction), dot(row_y, direction), dot(row_z, direction));
    own = direction;
    ball = centre_radius;
    ball_paint = paint;
    ball_marking = marking;
    number = gl_InstanceID;
#ifdef FINE
    vec3 sunny = centre_radius.xyz + 1.3 * centre_radius.w * scene.sun.xyz;
    light_here = vec3(sun_seen(sunny, scene.sun.xyz), balls_seen(sunny, scene.sun.xyz, -1), ground_seen(sunny, vec3(0.0)));
#endif
    gl_Position = pass.to_clip * vec4(centre_radius.xyz + centre_radius.w * facing, 1.0);
}
