// Reading the grid, see grid.h, for passes that search neighbours. Bindings 5 to 7 are its own.
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
#define cell_at(k) cell[k]
#define position_at(k) texelFetch(positions, k)

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

// What grid_settle.glsl packed: a unit vector, or 0.
vec3 unpacked(float direction) {
    uint bits = floatBitsToUint(direction);
    vec2 flat_part = unpackSnorm2x16(bits);
    vec3 v = vec3(flat_part, 1 - abs(flat_part.x) - abs(flat_part.y));
    float fold = max(-v.z, 0.0);
    v.x -= v.x >= 0 ? fold : -fold;
    v.y -= v.y >= 0 ? fold : -fold;
    return v * (bits == 0x80008000u ? 0 : inversesqrt(dot(v, v)));
}

int clamped(float place, int cells) {
    return place < 0 ? 0 : place >= float(cells) ? cells - 1 : int(place);
}
