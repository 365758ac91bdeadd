// A triangle mesh into a depth map.
layout(location = 0) in vec3 position;

void main() {
    gl_Position = pass.to_clip * vec4(position, 1.0);
}
