// Within its cell a particle comes after those with lower numbers, in whatever order they were scattered; what its
// neighbours read is copied there.
//
// A direction is two numbers of 16 bits: the sphere laid out as an octahedron, whose lower half is folded outwards. It is
// off by 3e-5 at most; three numbers of 11, 11 and 10 bits, in as much room, are off by 5e-4, which shows in the sums.
const uint standing = 0x80008000u; // a code that no direction has

uint packed_direction(vec3 v) {
    float square = dot(v, v);
    if (!(square > 0)) return standing;
    v *= inversesqrt(square);
    v /= abs(v.x) + abs(v.y) + abs(v.z);
    vec2 folded = mix(vec2(-1), vec2(1), greaterThanEqual(v.xy, vec2(0))) * (1 - abs(v.yx));
    return packSnorm2x16(v.z < 0 ? folded : v.xy);
}

void main() {
    uint place = invocation();
    if (place >= head.x) return;
    uint particle = order[place], slot = slot_of_particle(particle);
    vec3 p = at_X[slot].xyz;
    uint c = cell_of(p), begin = cell[c], end = cell[c + 1u];
    if (c < cell_count) {
        place = begin;
        for (uint k = begin; k < end; k++) place += uint(order[k] < particle);
    }
    number[place] = particle;
    position[place] = vec4(p, uintBitsToFloat(packed_direction(at_V[slot].xyz)));
}
