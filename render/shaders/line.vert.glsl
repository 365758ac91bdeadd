// Straight lines as ribbons that face the viewer, some pixels wide.
layout(location = 0) in vec3 from;
layout(location = 1) in vec3 to;
layout(location = 2) in vec3 light;

flat out vec3 paint;

layout(location = 0) uniform vec3 half_pixel; // half a pixel in clip units along x and y; z: width, pixels

void main() {
    paint = light;
    vec4 a = pass.to_clip * vec4(from, 1.0), b = pass.to_clip * vec4(to, 1.0);
    vec2 along = (b.xy / b.w - a.xy / a.w) / half_pixel.xy;
    float length_now = length(along);
    vec2 side = length_now > 1e-6 ? vec2(-along.y, along.x) / length_now : vec2(0.0, 1.0);
    vec4 end = gl_VertexID < 2 ? a : b;
    float hand = (gl_VertexID & 1) == 0 ? -1.0 : 1.0;
    gl_Position = end + vec4(side * hand * half_pixel.xy * half_pixel.z * end.w, end.z * 1e-3, 0.0);
}
