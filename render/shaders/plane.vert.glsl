// Planes: the ground as a disc out to where it has faded, others as a square.
layout(location = 0) in vec2 corner;

layout(location = 0) uniform vec3 origin;
layout(location = 1) uniform vec3 along;   // with its length: half of a square's side, or a disc's radius
layout(location = 2) uniform vec3 across;

out vec3 interpolated;
out vec2 place;

void main() {
    place = corner;
    interpolated = origin + corner.x * along + corner.y * across;
    gl_Position = pass.to_clip * vec4(interpolated, 1.0);
}
