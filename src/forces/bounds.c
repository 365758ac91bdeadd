/* Bounds: a box or a ball that is not left by more than a step.
 *
 *   wall       what would be outside after this substep, or is, has its velocity turned inwards, as by a mirror
 *   periodic   what is outside a box comes in again at the other side; the two sides do not see each other */
#include "forces/force.h"

#include "base/kernels.h"
#include "base/status.h"

typedef struct bounds_params {
    int32_t shape, edge;
    double centre[3], size[3], radius;
} bounds_params;

enum { BOX, BALL };
enum { WALL, PERIODIC };

#define SK_UNIT bounds
SK_KERNELS(sk_row_kernel, kernel);

#ifdef SK_ISA

SK_INLINE sk_wide axis_of(const sk_wide4 *v, int k) {
    return k == 0 ? v->x : k == 1 ? v->y : v->z;
}

SK_INLINE void set_axis(sk_wide4 *v, int k, sk_wide to) {
    if (k == 0) v->x = to;
    else if (k == 1) v->y = to;
    else v->z = to;
}

/* Mirrors what leaves the box. */
SK_INLINE void in_box(const bounds_params *params, sk_wide4 x, sk_wide4 *v, real h, sk_mask moved) {
    for (int k = 0; k < 3; k++) {
        sk_wide at = axis_of(&x, k), speed = axis_of(v, k), next = at + h * speed;
        real low = (real)(params->centre[k] - 0.5 * params->size[k]),
             high = (real)(params->centre[k] + 0.5 * params->size[k]);
        sk_mask over = sk_more(next, sk_splat(high)) & sk_positive(speed);
        sk_mask under = sk_more(sk_splat(low), next) & sk_negative(speed);
        set_axis(v, k, sk_select(moved & (over | under), -speed, speed));
    }
}

SK_INLINE void in_ball(const bounds_params *params, sk_wide4 x, sk_wide4 *v, real h, sk_mask moved) {
    sk_vec3 c = sk_v3_of(params->centre);
    sk_wide3 d = {x.x + h * v->x - c.x, x.y + h * v->y - c.y, x.z + h * v->z - c.z};
    sk_wide square = sk_dot_wide(d, d), out = d.x * v->x + d.y * v->y + d.z * v->z;
    real radius = (real)params->radius;
    sk_mask over = moved & sk_more(square, sk_splat(radius * radius)) & sk_positive(out);
    sk_wide k = sk_keep(over, (real)2 * out / square);
    v->x -= k * d.x, v->y -= k * d.y, v->z -= k * d.z;
}

/* Moves what is outside by whole sizes of the box, in all vectors that say where it is or was. */
SK_INLINE void come_in(sk_run *run, const sk_row *row, size_t slot, sk_wide4 x, sk_mask moved) {
    const bounds_params *params = ((const sk_force *)row->rule)->params;
    bool packed = slot < row->packed;
    sk_wide4 shift = {{0}, {0}, {0}, {0}};
    sk_mask any = {0};
    for (int k = 0; k < 3; k++) {
        sk_wide at = axis_of(&x, k), size = sk_splat((real)params->size[k]);
        real low = (real)(params->centre[k] - 0.5 * params->size[k]),
             high = (real)(params->centre[k] + 0.5 * params->size[k]);
        sk_mask over = moved & sk_more(at, sk_splat(high));
        sk_mask under = moved & sk_more(sk_splat(low), at);
        set_axis(&shift, k, sk_select(over, -size, sk_keep(under, size)));
        any |= over | under;
    }
    if (!sk_any(any)) return;
    x.x = sk_plus_where(any, x.x, shift.x), x.y = sk_plus_where(any, x.y, shift.y);
    x.z = sk_plus_where(any, x.z, shift.z);
    sk_store_part(run->vector[SK_X], slot, packed, x);
    sk_wide4 before = sk_load_part(run->vector[SK_PREVIOUS], slot, false); // always quads
    before.x = sk_plus_where(any, before.x, shift.x), before.y = sk_plus_where(any, before.y, shift.y);
    before.z = sk_plus_where(any, before.z, shift.z);
    sk_store_part(run->vector[SK_PREVIOUS], slot, false, before);
}

void SK_KERNEL(kernel)(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    const sk_force *force = row->rule;
    const bounds_params *params = force->params;
    real h = (real)row->dt;
    for (size_t slot = begin; slot < end; slot += SK_PART) {
        bool packed = slot < row->packed;
        sk_wide4 x = sk_load_part(run->vector[SK_X], slot, packed);
        sk_wide4 v = sk_load_part(run->vector[SK_V], slot, packed);
        sk_mask moved = sk_lanes_between(slot, force->moved.first_slot, force->moved.end_slot) & sk_positive(x.w);
        if (params->edge) {
            come_in(run, row, slot, x, moved);
            continue;
        }
        if (params->shape) in_ball(params, x, &v, h, moved);
        else in_box(params, x, &v, h, moved);
        sk_store_moved(run->vector[SK_V], slot, packed, v);
    }
}

#else

static const skein_field fields[] = {
    {"shape",
     SKEIN_FIELD_CHOICE,
     offsetof(bounds_params, shape),
     "",
     {BOX, 0, 0},
     0,
     0,
     "box|sphere",
     NULL,
     "what is not left"},
    {"edge",
     SKEIN_FIELD_CHOICE,
     offsetof(bounds_params, edge),
     "",
     {WALL, 0, 0},
     0,
     0,
     "wall|periodic",
     NULL,
     "what leaves is turned back, or comes in at the other side of the box"},
    SK_VEC3(bounds_params, centre, "centre", "m", 0, 0, 0, "its middle"),
    SK_SIZE3(bounds_params, size, "size", "m", 100, 100, 100, "of the box, from side to side"),
    SK_REAL(bounds_params, radius, "radius", "m", 50, 1e-6, 1e9, "of the sphere"),
};

static skein_status check(const void *data, size_t particle_count, skein_error *error) {
    const bounds_params *params = data;
    (void)particle_count;
    if (params->edge == PERIODIC && params->shape == BALL)
        return sk_fail(error, SKEIN_ERROR_VALUE, "edge", "a sphere has no other side: periodic bounds are a box");
    return SKEIN_OK;
}

static void pack(const void *data, float (*block)[4]) {
    const bounds_params *params = data;
    sk_shader_vector(block[0], params->centre);
    block[0][3] = params->shape == BALL ? (float)params->radius : 0;
    for (int k = 0; k < 3; k++) {
        double half = 0.5 * params->size[k];
        block[1][k] = (float)half;
        block[2][k] = (float)(params->centre[k] - half), block[3][k] = (float)(params->centre[k] + half);
    }
}

static bool shifts(const void *params) {
    return ((const bounds_params *)params)->edge == PERIODIC;
}

const sk_force_type sk_bounds = {
    .kind = {"bounds", "a box or a sphere that is not left", SKEIN_FORCE, fields, sizeof fields / sizeof *fields,
             sizeof(bounds_params)},
    .domain = SK_OVER_PARTICLES,
    .deed = SK_BOUNDS,
    .once = true,
    .kernel = {SK_EACH_ISA(kernel)},
    .check = check,
    .shader = {.file = "forces/bounds", .size = 4, .pack = pack, .shifts = shifts},
};
#endif
