/* A limit on speed: |v| is at most the limit, and what a predator has added to it in this substep. It stands between
 * the kick and the drift of methods that have them (methods/writer_steer.c). */
#include "base/kernels.h"
#include "forces/force.h"

typedef struct speed_limit_params {
    double limit;
} speed_limit_params;

#define SK_UNIT speed_limit
SK_KERNELS(sk_row_kernel, kernel);

#ifdef SK_ISA

void SK_KERNEL(kernel)(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    const sk_force *force = row->rule;
    const speed_limit_params *params = force->params;
    for (size_t slot = begin; slot < end; slot += SK_PART) {
        bool packed = slot < row->packed;
        sk_wide4 v = sk_load_part(run->vector[SK_V], slot, packed);
        sk_wide most = sk_splat((real)params->limit);
        if (row->source[2] != SK_NONE) most += sk_load_part(run->vector[row->source[2]], slot, packed).w;
        most = sk_keep(sk_positive(most), most);
        sk_wide square = v.x * v.x + v.y * v.y + v.z * v.z;
        sk_mask over =
            sk_more(square, most * most) & sk_lanes_between(slot, force->moved.first_slot, force->moved.end_slot);
        if (!sk_any(over)) continue;
        sk_wide k = sk_select(over, most / sk_wide_sqrt(square), sk_splat(1));
        v.x *= k, v.y *= k, v.z *= k;
        sk_store_part(run->vector[SK_V], slot, packed, v);
    }
}

#else

static const skein_field fields[] = {
    SK_REAL(speed_limit_params, limit, "limit", "m/s", 9, 0, SK_FAR, "the highest speed; what flees may be faster"),
};

static void pack(const void *params, float (*block)[4]) {
    block[0][0] = (float)((const speed_limit_params *)params)->limit;
}

const sk_force_type sk_speed_limit = {
    .kind = {"speed_limit", "nothing is faster than this", SKEIN_FORCE, fields, sizeof fields / sizeof *fields,
             sizeof(speed_limit_params)},
    .domain = SK_OVER_PARTICLES,
    .deed = SK_BOUNDS,
    .kernel = {SK_EACH_ISA(kernel)},
    .shader = {.file = "forces/speed_limit", .size = 1, .pack = pack},
};
#endif
