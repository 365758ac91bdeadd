// Counts to places: STAGE 0 adds up 4,096 cells a group, 1 adds those up, 2 gives each cell what is before it.
shared uint part[256];

// Sums of all parts up to each one's own, itself included.
void add_up(uint t) {
    barrier();
    for (uint step = 1u; step < 256u; step <<= 1) {
        uint before = t >= step ? part[t - step] : 0u;
        barrier();
        part[t] += before;
        barrier();
    }
}

uint count_at(uint c) {
    return c < cell_count + 2u ? cell[c] : 0u;
}

void main() {
    uint t = gl_LocalInvocationID.x;
#if STAGE == 0
    uint first = group() * 4096u + t * 16u, total = 0u;
    for (uint k = 0u; k < 16u; k++) total += count_at(first + k);
    part[t] = total;
    add_up(t);
    if (t == 255u) sum_of[group()] = part[255];
#elif STAGE == 1
    uint groups = (cell_count + 2u + 4095u) / 4096u, carry = 0u;
    for (uint first = 0u; first < groups; first += 256u) {
        uint own = first + t < groups ? sum_of[first + t] : 0u;
        part[t] = own;
        add_up(t);
        if (first + t < groups) sum_of[first + t] = carry + part[t] - own;
        carry += part[255];
        barrier();
    }
#else
    if (group() * 4096u >= cell_count + 2u) return;
    uint first = group() * 4096u + t * 16u, total = 0u;
    for (uint k = 0u; k < 16u; k++) total += count_at(first + k);
    part[t] = total;
    add_up(t);
    uint at = sum_of[group()] + part[t] - total;
    for (uint k = 0u; k < 16u && first + k < cell_count + 2u; k++) {
        uint count = cell[first + k];
        cell[first + k] = at;
        at += count;
    }
#endif
}
