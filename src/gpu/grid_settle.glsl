// Within its cell a particle stands behind those with lower numbers, however the scatter went; what its neighbours
// look at is copied there.
uint packed_direction(vec3 v) {
    float square = dot(v, v);
    vec3 d = square > 0 ? v * inversesqrt(square) : vec3(0);
    uvec3 q = uvec3(clamp(floor(d * vec3(1023, 1023, 511) + vec3(1024.5, 1024.5, 512.5)), vec3(0), vec3(2047, 2047, 1023)));
    return q.x << 21 | q.y << 10 | q.z;
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
