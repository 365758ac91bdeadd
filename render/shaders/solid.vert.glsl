// Boxes with round edges, and rods: one mesh of a cut sphere (render_shape_solid), an instance for each.
layout(location = 0) in vec3 corner_direction; // 4 times the corner, from -1 to 1, plus the direction
layout(location = 1) in vec4 centre_radius;
layout(location = 2) in vec3 row_x;
layout(location = 3) in vec3 row_y;
layout(location = 4) in vec3 row_z;
layout(location = 5) in vec3 paint;
layout(location = 6) in vec3 marking;
layout(location = 7) in vec3 extent;

centroid out vec3 world;
centroid out vec3 facing;
centroid out vec3 own;
flat out vec3 solid_paint;
flat out vec3 solid_marking;
flat out int is_rod;
#ifdef FINE
centroid out vec3 light_here; // what is seen of the sun, of the whole sky, of the lit ground
#endif

void main() {
    vec3 corner = round(0.25 * corner_direction);
    own = corner_direction - 4.0 * corner;
    vec3 inside = corner * extent + own * centre_radius.w;
    world = centre_radius.xyz + vec3(dot(row_x, inside), dot(row_y, inside), dot(row_z, inside));
    facing = vec3(dot(row_x, own), dot(row_y, own), dot(row_z, own));
    solid_paint = paint;
    solid_marking = marking;
    is_rod = extent.y == 0.0 ? 1 : 0;
#ifdef FINE
    light_here = vec3(sun_seen(world, facing), balls_seen(world, facing, -1), ground_seen(world, facing));
#endif
    gl_Position = pass.to_clip * vec4(world, 1.0);
}
