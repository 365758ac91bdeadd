// A triangle mesh: positions and normals come anew every frame, uv once.
layout(location = 0) in vec3 position;
layout(location = 1) in vec3 normal;
layout(location = 2) in vec2 uv;

centroid out vec3 world;
out vec3 unmoved; // the same, for differences between pixels, which centroids would spoil
centroid out vec3 facing;
out vec2 place;

layout(location = 0) uniform float lift; // drawn nearer by this part of the distance

void main() {
    world = unmoved = position;
    facing = normal;
    place = uv;
    gl_Position = pass.to_clip * vec4(position, 1.0);
    gl_Position.z *= 1.0 + lift;
}
