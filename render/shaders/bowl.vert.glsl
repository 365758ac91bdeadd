// A bowl: the lower part of a sphere.
layout(location = 0) in vec3 direction;

layout(location = 0) uniform vec4 centre_radius;

out vec3 outward;

void main() {
    outward = direction;
    gl_Position = pass.to_clip * vec4(centre_radius.xyz + centre_radius.w * direction, 1.0);
}
