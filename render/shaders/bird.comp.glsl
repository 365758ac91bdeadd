// Moves wings on, and leans into turns.
layout(local_size_x = 64) in;
layout(std430, binding = 3) restrict buffer postures_block { vec4 postures[]; }; // heading, phase of the beat, lean
layout(location = 0) uniform uint count;
layout(location = 3) uniform float seconds; // since the postures; 0: nothing is known of what was before
layout(location = 4) uniform int fresh;     // 1: there are no postures yet

void main() {
    uint instance = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * 64u + gl_LocalInvocationID.x;
    if (instance >= count) return;
    uint bird = bird_of(instance);
    vec3 v = velocities[slot_of(instance)].xyz;
    vec4 posture = fresh == 1 ? vec4(0, 6.2831853 * own_number(bird, 3u), 0, 0) : postures[first + bird];
    float level = length(v.xz), speed = length(v), heading = level > 0 ? atan(v.x, v.z) : posture.x;
    if (seconds > 0) {
        // two beats a second, and one more for every four metres a second
        posture.y = mod(posture.y + 6.2831853 * seconds * (2 + 0.25 * min(speed, 100.0)), 6.2831853);
        float turn = heading - posture.x;
        turn -= 6.2831853 * round(turn / 6.2831853);
        // the lean at which weight and turn are in balance, taken on within about a quarter of a second
        float lean = clamp(atan(level * turn / (seconds * 9.81)), -1.2, 1.2);
        posture.z = mix(lean, posture.z, exp(-4 * seconds));
    }
    posture.x = heading;
    // whoever is nowhere stays nowhere
    postures[first + bird] = vec4(isnan(posture.x) ? 0 : posture.x, posture.y, isnan(posture.z) ? 0 : posture.z, 0);
}
