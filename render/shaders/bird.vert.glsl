// Birds: along the velocity, leaning, with wings in two parts of which the outer one follows the inner.
layout(location = 0) in vec4 place; // of the mesh; w: 1 on wings
layout(std430, binding = 3) restrict readonly buffer postures_block { vec4 postures[]; };
layout(location = 3) uniform float size; // half the span
layout(location = 6) uniform uint from;  // instances that are drawn already

out vec3 world;
#ifdef FINE
layout(location = 4) uniform int paint;   // 0: a colour of its own; 1: by direction; 2: the flock's; 3: by speed
layout(location = 5) uniform vec3 colour; // the flock's
layout(location = 7) uniform vec2 speeds; // the part of the colours' range for a metre a second, and their map
layout(binding = 3) uniform sampler1DArray colour_maps;
flat out vec3 feathers;
flat out vec3 light_here; // as for balls
#endif

void main() {
    uint instance = uint(gl_InstanceID) + from, bird = bird_of(instance), slot = slot_of(instance);
    vec3 at = positions[slot].xyz, v = velocities[slot].xyz;
    vec4 posture = postures[first + bird];
    float speed = length(v);
    vec3 ahead = speed > 0 ? v / speed : vec3(0, 0, 1);
    vec3 left = cross(vec3(0, 1, 0), ahead);
    left = dot(left, left) > 1e-6 ? normalize(left) : vec3(1, 0, 0); // straight up or down any side will do
    vec3 up = cross(ahead, left);
    float c = cos(posture.z), s = sin(posture.z);
    vec3 leaning = c * left - s * up; // into a turn to the left the left wing goes down
    up = c * up + s * left;

    vec3 p = place.xyz;
    if (place.w > 0) {
        // downwards they glide
        float stroke = 0.75 * mix(0.3, 1.0, smoothstep(-0.5, 0.1, ahead.y));
        float inner = stroke * sin(posture.y) + 0.12, outer = inner + 0.8 * stroke * sin(posture.y - 0.9) - 0.1;
        float out_to = abs(p.x), wrist = min(out_to, 0.5), beyond = out_to - wrist;
        p.x = sign(p.x) * (wrist * cos(inner) + beyond * cos(outer));
        p.y += wrist * sin(inner) + beyond * sin(outer);
    }
    world = at + size * (p.x * leaning + p.y * up + p.z * ahead);
#ifdef FINE
    vec3 hue = 0.5 + 0.42 * cos(6.2831853 * (own_number(bird, 0u) + vec3(0, 0.33, 0.67)));
    vec3 own = hue * hue * (0.7 + 0.6 * own_number(bird, 1u));
    vec3 by_direction = mix(vec3(0.05, 0.13, 0.62), vec3(0.70, 0.05, 0.03), step(0.0, ahead.z));
    feathers = paint == 0 ? own : paint == 1 ? by_direction : colour;
    if (paint == 3) feathers = textureLod(colour_maps, vec2(min(speed * speeds.x, 1.0), speeds.y), 0.0).rgb;
    vec3 sunny = at + 1.5 * size * scene.sun.xyz;
    light_here = vec3(sun_seen(sunny, scene.sun.xyz), balls_seen(sunny, scene.sun.xyz, -1), ground_seen(sunny, vec3(0.0)));
#endif
    gl_Position = pass.to_clip * vec4(world, 1.0);
}
