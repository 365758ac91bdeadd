// Where birds are; see render/birds.h. Those of one flock are instances from 0 on.
layout(std430, binding = 0) restrict readonly buffer positions_block { vec4 positions[]; };
layout(std430, binding = 1) restrict readonly buffer velocities_block { vec4 velocities[]; };
layout(std430, binding = 2) restrict readonly buffer slots_block { uint slots[]; };

layout(location = 1) uniform uint first; // of the flock, among all birds
layout(location = 2) uniform int listed; // 0: in order; 1: in the slots of a list; 2: the list says who is in a slot

uint slot_of(uint instance) {
    return listed == 2 ? instance : listed == 1 ? slots[first + instance] : first + instance;
}

uint bird_of(uint instance) {
    return listed == 2 ? slots[instance] : instance;
}

// Numbers from 0 to 1 that belong to a bird.
float own_number(uint bird, uint which) {
    uint x = (first + bird) * 4u + which;
    x ^= x >> 16;
    x *= 0x7feb352du;
    x ^= x >> 15;
    x *= 0x846ca68bu;
    x ^= x >> 16;
    return float(x >> 8) / 16777216.0;
}
