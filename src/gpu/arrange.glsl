// Moving whole vectors: STAGE 0 and 2 gather by a list, 1 and 3 copy, 4 scatters by a list. Of four floats, or (2, 3)
// of whole numbers.
#if STAGE == 2 || STAGE == 3
#define NUMBER uint
#else
#define NUMBER vec4
#endif
layout(std430, binding = 0) restrict readonly buffer block_from { NUMBER from[]; };
layout(std430, binding = 1) restrict writeonly buffer block_to { NUMBER to[]; };
layout(std430, binding = 2) restrict readonly buffer block_list { uint list[]; };
layout(location = 0) uniform uint count;

void main() {
    uint i = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * gl_WorkGroupSize.x + gl_LocalInvocationID.x;
    if (i >= count) return;
#if STAGE == 0 || STAGE == 2
    to[i] = from[list[i]];
#elif STAGE == 1 || STAGE == 3
    to[i] = from[i];
#else
    to[list[i]] = from[i];
#endif
}
