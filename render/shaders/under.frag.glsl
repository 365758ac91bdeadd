// The sky's light on the ground: what the things above it leave over. The map `below` holds their
// undersides, seen from the ground. Each tap of a spiral stands for a level ring from radius a to b at the
// height h found there, whose share of the sky is exactly h^2 / (a^2 + h^2) - h^2 / (b^2 + h^2).
in vec2 place;
out vec4 light;

layout(binding = 0) uniform sampler2D below;
layout(location = 0) uniform vec3 extent; // x: the map's side, y: the height at depth 1, z: a texel (metres)

const int taps = 64;
const mat2 golden_turn = mat2(-0.737369, 0.675490, -0.675490, -0.737369);

void main() {
    vec2 here = 0.5 + 0.5 * place;
    float reach = 0.22 * extent.x, hidden = 0.0;
    vec2 spoke = vec2(1.0, 0.0);
    for (int i = 0; i < taps; i++) {
        // radii grow as the square of the tap's number, so that most taps are near
        vec2 u = vec2(i, i + 1) / float(taps);
        vec2 away = reach * u * u;
        float depth = textureLod(below, here + spoke * 0.5 * (away.x + away.y) / extent.x, 0.0).r;
        float height = max(depth * extent.y, 0.5 * extent.z);
        vec2 share = height * height / (away * away + height * height);
        if (depth < 1.0) hidden += share.x - share.y;
        spoke = golden_turn * spoke;
    }
    light = vec4(1.0 - min(hidden, 1.0));
}
