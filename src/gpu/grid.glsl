// What the grid's shaders share: the buffers, the head of the cells' buffer, and a particle's cell.
layout(std140, binding = 0) uniform grid_block {
    uvec4 head; // particles; most cells; the first particle
    vec4 asked; // the least size of a cell
};

layout(std430, binding = 0) restrict readonly buffer block_X { vec4 at_X[]; };
layout(std430, binding = 1) restrict readonly buffer block_V { vec4 at_V[]; };
layout(std430, binding = 2) restrict buffer block_cells {
    uint low[3], high[3]; // of the box that is being found: both as what grows, 0 for nothing
    uint cell_count;      // behind the last cell is one for particles that are nowhere
    float per_size, per_size_x;
    int cells_x, cells_y, cells_z;
    float origin_x, origin_y, origin_z, size;
    uint unused[16];
    uint cell[]; // counts, then where they begin
};
layout(std430, binding = 3) restrict buffer block_number { uint number[]; };
layout(std430, binding = 4) restrict buffer block_order { uint order[]; };
layout(std430, binding = 5) restrict writeonly buffer block_position { vec4 position[]; };
layout(std430, binding = 6) restrict buffer block_sums { uint sum_of[]; };
#if !IDENTITY
layout(std430, binding = 7) restrict readonly buffer block_slot_of { uint slot_of[]; };
#endif

uint invocation() {
    return (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * gl_WorkGroupSize.x + gl_LocalInvocationID.x;
}

uint group() {
    return gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x;
}

uint slot_of_particle(uint particle) {
#if IDENTITY
    return particle;
#else
    return slot_of[particle];
#endif
}

bool is_finite(vec3 p) {
    // comparisons that NaN fails
    return abs(p.x) <= 8.5e37 && abs(p.y) <= 8.5e37 && abs(p.z) <= 8.5e37;
}

// Numbers as whole ones in the same order, and back.
uint ordered(float x) {
    uint bits = floatBitsToUint(x);
    return (bits >> 31) != 0u ? ~bits : bits | 0x80000000u;
}
float unordered(uint bits) {
    return uintBitsToFloat((bits >> 31) != 0u ? bits & 0x7fffffffu : ~bits);
}

// A place along an axis, clamped; as a number first, for it may be too large for a whole one.
int clamped(float place, int cells) {
    return place < 0 ? 0 : place >= float(cells) ? cells - 1 : int(place);
}

// The same for every shader that asks, whatever it does with it.
uint cell_of(vec3 p) {
    if (!is_finite(p)) return cell_count;
    precise float x = (p.x - origin_x) * per_size_x, y = (p.y - origin_y) * per_size, z = (p.z - origin_z) * per_size;
    return uint((clamped(z, cells_z) * cells_y + clamped(y, cells_y)) * cells_x + clamped(x, cells_x));
}
