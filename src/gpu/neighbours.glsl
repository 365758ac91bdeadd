// What walks along the grid: see grid.h. Bindings 5 to 7 are its own.
layout(std430, binding = 5) restrict readonly buffer block_cells {
    uint low[3], high[3];
    uint cell_count;
    float per_size, per_size_x;
    int cells_x, cells_y, cells_z;
    float origin_x, origin_y, origin_z, size;
    uint unused[16];
    uint cell[];
};
layout(std430, binding = 6) restrict readonly buffer block_number { uint number[]; };
#if !IDENTITY
layout(std430, binding = 7) restrict readonly buffer block_slot_of { uint slot_of[]; };
#endif
layout(binding = 0) uniform samplerBuffer positions; // in order, with the packed direction

uint slot_of_particle(uint particle) {
#if IDENTITY
    return particle;
#else
    return slot_of[particle];
#endif
}

uint slot_at(uint place) {
    return slot_of_particle(number[place]);
}

// 11, 11 and 10 bits as the fractions of numbers from 1 to 2.
vec3 unpacked(float direction) {
    uint bits = floatBitsToUint(direction);
    uvec3 fraction = uvec3(bits >> 9 & 0x7ff000u, bits << 2 & 0x7ff000u, bits << 13 & 0x7fe000u);
    return uintBitsToFloat(fraction | 0x3f800000u) * vec3(2048.0 / 1023, 2048.0 / 1023, 1024.0 / 511) -
           vec3(3072.0 / 1023, 3072.0 / 1023, 1536.0 / 511);
}

int clamped(float place, int cells) {
    return place < 0 ? 0 : place >= float(cells) ? cells - 1 : int(place);
}
