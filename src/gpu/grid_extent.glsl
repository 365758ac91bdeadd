// The box of all finite particles of a work group goes to the head: what the next frame is made of.
shared uint box_low[3], box_high[3];

void begin_box() {
    if (gl_LocalInvocationID.x < 3u) box_low[gl_LocalInvocationID.x] = box_high[gl_LocalInvocationID.x] = 0u;
    barrier();
}

void add_to_box(vec3 p) {
    for (int k = 0; k < 3; k++) {
        atomicMax(box_low[k], ~ordered(p[k]));
        atomicMax(box_high[k], ordered(p[k]));
    }
}

void end_box() {
    barrier();
    if (gl_LocalInvocationID.x >= 3u) return;
    atomicMax(low[gl_LocalInvocationID.x], box_low[gl_LocalInvocationID.x]);
    atomicMax(high[gl_LocalInvocationID.x], box_high[gl_LocalInvocationID.x]);
}
