// A triangle mesh: positions and normals come anew every frame, uv once.
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec2 uv;

centroid out vec3 world;
out vec3 unmoved; // the same, for differences between pixels, which centroids would spoil
centroid out vec3 facing;
out vec2 place;
centroid out float seen_here; // the sun, where it is found by vertex

layout(location = 0) uniform float lift; // drawn nearer by this part of the distance
layout(location = 7) uniform int fine;   // 1: triangles are no larger than a few pixels

void main() {
    world = unmoved = position;
    facing = normal;
    place = uv;
    seen_here = fine == 1 ? sun_seen(position, normal) : 1.0;
    gl_Position = pass.to_clip * vec4(position, 1.0);
    gl_Position.z *= 1.0 + lift;
}
