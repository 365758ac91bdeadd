// A triangle mesh: positions and normals come anew every frame, uv once.
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec2 uv;
layout(location = 3) in float value;

centroid out vec3 world;
centroid out vec3 facing;
out vec3 place; // uv and the value
#ifdef FINE
centroid out vec3 light_here; // what is seen of the sun, of the whole sky, of the lit ground
#endif

layout(location = 0) uniform float lift; // drawn nearer by this part of the distance

void main() {
    world = position;
    facing = normal;
    place = vec3(uv, value);
#ifdef FINE
    vec3 side = dot(normal, scene.eye.xyz - position) < 0.0 ? -normal : normal;
    light_here = vec3(sun_seen(position, normal), balls_seen(position, side, -1), ground_seen(position, side));
#endif
    gl_Position = pass.to_clip * vec4(position, 1.0);
    gl_Position.z *= 1.0 + lift;
}
