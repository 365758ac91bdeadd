/* Wind on triangles: drag along the air's velocity, lift across it (after Keckeisen and others 2004).
 *
 *   u  the air's velocity past the triangle        n  the unit normal, turned to u.n >= 0
 *   F = 1/2 rho A ((drag - lift) (u.n) u + lift |u|^2 n (u.n)/|u|),   a third to each corner
 *
 * A triangle edge-on to the wind feels nothing; one square to it feels drag alone. With N = 2 A n, whichever way it
 * points, a corner's share is
 *
 *   rho/12 ((drag - lift) |u.N| u + lift (u.N) |u|/|N| N)
 *
 * which takes one division and one root. Triangles of a grid are visited cell by cell along its strips, sixteen cells
 * at once: their corners are blocks, and no index is read. A cell's four corners get one sum each; the sums for corners
 * that it shares with the next cell wait for that one in registers. */
#include "base/kernels.h"
#include "forces/force.h"

typedef struct surface_wind_params {
    double velocity[3], drag, lift, density;
} surface_wind_params;

/* Triangles with a smaller |N|^2, m4, are ignored as rounding errors, so that |u|/|N| can be computed as one root. */
#define LEAST_SQUARE ((real)1e-30)

#define SK_UNIT surface_wind
SK_KERNELS(sk_op_kernel, over_patch);
SK_KERNELS(sk_op_kernel, over_rest);

#ifdef SK_ISA

typedef struct blow {
    sk_vec3 wind;
    real along, lifting;
} blow;

/* The lanes of a part whose bits are set in a word that has a bit for each lane of a block. */
SK_INLINE sk_mask lanes_in(uint16_t word, size_t part) {
    static const SK_VECTOR_ALIGNED sk_lane_int bit[SK_LANES] = {1,       1 << 1,  1 << 2,  1 << 3, 1 << 4,  1 << 5,
                                                                1 << 6,  1 << 7,  1 << 8,  1 << 9, 1 << 10, 1 << 11,
                                                                1 << 12, 1 << 13, 1 << 14, 1 << 15};
    if (word == UINT16_MAX) return (sk_mask){0} == 0;
    sk_mask at = ((const sk_mask *)(const void *)bit)[part];
    return ((at & (sk_lane_int)word) != 0);
}

SK_INLINE sk_wide3 load3(const sk_wide *part) {
    return (sk_wide3){part[0], part[SK_PARTS], part[2 * SK_PARTS]};
}
SK_INLINE sk_wide3 plus3(sk_wide3 a, sk_wide3 b) {
    return (sk_wide3){a.x + b.x, a.y + b.y, a.z + b.z};
}
SK_INLINE sk_wide3 minus3(sk_wide3 a, sk_wide3 b) {
    return (sk_wide3){a.x - b.x, a.y - b.y, a.z - b.z};
}
SK_INLINE void add3(sk_wide *part, sk_wide3 a) {
    part[0] += a.x, part[SK_PARTS] += a.y, part[2 * SK_PARTS] += a.z;
}

SK_INLINE blow blow_of(const surface_wind_params *params) {
    return (blow){sk_v3_of(params->velocity), (real)(params->density * (params->drag - params->lift) / 12),
                  (real)(params->density * params->lift / 12)};
}

/* A corner's share of the force on the triangle with this edge and tip. `moving`: its corners' velocities, summed. */
SK_INLINE sk_wide3 share_of(const blow *air, sk_wide3 edge, sk_wide3 to_tip, sk_wide3 moving, sk_mask there) {
    const real third = (real)1 / 3;
    sk_wide3 flow = {air->wind.x - third * moving.x, air->wind.y - third * moving.y, air->wind.z - third * moving.z};
    sk_wide3 normal = {edge.y * to_tip.z - edge.z * to_tip.y, edge.z * to_tip.x - edge.x * to_tip.z,
                       edge.x * to_tip.y - edge.y * to_tip.x};
    sk_wide square = sk_dot_wide(normal, normal), across = sk_dot_wide(normal, flow);
    there &= sk_more(square, sk_splat(LEAST_SQUARE));
    sk_wide a = sk_keep(there, air->along * sk_wide_abs(across));
    sk_wide b = sk_keep(there, air->lifting * across * sk_wide_sqrt(sk_dot_wide(flow, flow) / square));
    return (sk_wide3){a * flow.x + b * normal.x, a * flow.y + b * normal.y, a * flow.z + b * normal.z};
}

/* Adds the forces of the two triangles beside the diagonal from `base` to `far` to the sums of the four corners, or
 * sets these if the two are `alone`. */
SK_INLINE void add_two(const blow *air, const sk_wide3 *x, const sk_wide3 *v, sk_wide3 *sum, bool alone, int base,
                       int far, int tip, int other, const uint16_t *has, size_t part) {
    sk_wide3 edge = minus3(x[far], x[base]), moving = plus3(v[base], v[far]);
    sk_wide3 one = share_of(air, edge, minus3(x[tip], x[base]), plus3(moving, v[tip]), lanes_in(has[tip], part));
    sk_wide3 two = share_of(air, edge, minus3(x[other], x[base]), plus3(moving, v[other]), lanes_in(has[other], part));
    sk_wide3 both = plus3(one, two);
    if (alone) {
        sum[tip] = one, sum[other] = two, sum[base] = sum[far] = both;
        return;
    }
    sum[tip] = plus3(sum[tip], one), sum[other] = plus3(sum[other], two);
    sum[base] = plus3(sum[base], both), sum[far] = plus3(sum[far], both);
}

/* The blocks at the corners of sixteen cells. */
typedef struct corners {
    const sk_wide *x[4], *v[4];
} corners;

SK_INLINE void blow_on(const blow *air, const corners *at, const uint16_t *has, size_t part, bool falling, bool rising,
                       sk_wide3 *sum) {
    sk_wide3 x[4], v[4];
    for (int i = 0; i < 4; i++) x[i] = load3(at->x[i] + part), v[i] = load3(at->v[i] + part);
    if (falling) add_two(air, x, v, sum, true, 0, 3, 1, 2, has, part);
    if (rising) add_two(air, x, v, sum, !falling, 1, 2, 0, 3, has, part);
    if (!falling && !rising)
        for (int i = 0; i < 4; i++) sum[i] = (sk_wide3){{0}, {0}, {0}};
}

/* Cells whose diagonals do not all fall. They are rare, and a function of their own: inlined, they would take registers
 * from the common case (AVX2 and SSE took 1.1 times as long). */
static __attribute__((noinline)) void blow_on_others(const blow *air, const corners *at, const uint16_t *has,
                                                     size_t part, sk_wide3 *sum) {
    bool falling = has[1] | has[2], rising = has[0] | has[3];
    if (falling && rising) blow_on(air, at, has, part, true, true, sum);
    else blow_on(air, at, has, part, false, rising, sum);
}

/* Sums for the corners that the cells visited last share with the next ones of the row. */
typedef struct waiting {
    sk_wide3 upper, lower;
} waiting;

/* Sixteen cells: adds the sums of their left corners, with those that have waited, to f and, a row on, to f_below. */
SK_INLINE void blow_on_cells(const blow *air, const corners *at, const uint16_t *has, size_t part, sk_wide *f,
                             sk_wide *f_below, waiting *to) {
    sk_wide3 sum[4];
    if ((has[1] | has[2]) && !(has[0] | has[3])) {
        blow_on(air, at, has, part, true, false, sum);
    } else {
        sk_wide3 others[4];
        blow_on_others(air, at, has, part, others);
        for (int i = 0; i < 4; i++) sum[i] = others[i];
    }
    add3(f + part, plus3(to->upper, sum[0]));
    add3(f_below + part, plus3(to->lower, sum[2]));
    to->upper = sum[1], to->lower = sum[3];
}

/* x, y and z of a block with lanes rotated to the next strip: the right corners of the last cells of a row. */
SK_INLINE void turn3(sk_wide *to, const sk_wide *block, int shift) {
    for (int r = 0; r < 3 * SK_PARTS; r += SK_PARTS) sk_rotate_lanes(to + r, block + r, shift);
}

/* Cells of strip rows [begin, end): those of a row add to its own particles, and to those of the next row. */
void SK_KERNEL(over_patch)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    const surface_wind_params *params = ((const sk_force *)op->rule)->params;
    const sk_patch *patch = op->patch;
    const blow air = blow_of(params);
    size_t width = patch->walk.width, line = width * 4 * SK_PARTS; // vectors a strip row
    for (size_t r = begin; r < end; r++) {
        size_t first = patch->walk.first_slot * 4 / SK_PART + r * line;
        const sk_wide *x = (const sk_wide *)(const void *)run->vector[SK_X] + first;
        const sk_wide *v = (const sk_wide *)(const void *)run->vector[SK_V] + first;
        sk_wide *f = (sk_wide *)(void *)run->vector[op->dst] + first;
        sk_wide turned[4][3 * SK_PARTS], over[2][3 * SK_PARTS];
        turn3(turned[0], x, 1), turn3(turned[1], x + line, 1);
        turn3(turned[2], v, 1), turn3(turned[3], v + line, 1);
        for (size_t p = 0; p < SK_PARTS; p++) {
            waiting to = {{{0}, {0}, {0}}, {{0}, {0}, {0}}};
            size_t here = 0, next = 4 * SK_PARTS;
            for (size_t k = 0; k + 1 < width; k++, here = next, next += 4 * SK_PARTS) {
                corners at = {{x + here, x + next, x + line + here, x + line + next},
                              {v + here, v + next, v + line + here, v + line + next}};
                blow_on_cells(&air, &at, patch->has[r * width + k], p, f + here, f + line + here, &to);
            }
            corners at = {{x + here, turned[0], x + line + here, turned[1]},
                          {v + here, turned[2], v + line + here, turned[3]}};
            blow_on_cells(&air, &at, patch->has[r * width + width - 1], p, f + here, f + line + here, &to);
            over[0][p] = to.upper.x, over[0][SK_PARTS + p] = to.upper.y, over[0][2 * SK_PARTS + p] = to.upper.z;
            over[1][p] = to.lower.x, over[1][SK_PARTS + p] = to.lower.y, over[1][2 * SK_PARTS + p] = to.lower.z;
        }
        for (size_t i = 0; i < 2; i++) {
            sk_wide back[3 * SK_PARTS];
            turn3(back, over[i], -1); // to the next lane
            for (size_t n = 0; n < 3 * SK_PARTS; n++) f[i * line + n] += back[n];
        }
    }
}

/* Triangles that lie in no grid. A part of them is computed at once, which is safe since none reads F; then their
 * shares are added to the corners triangle by triangle. */
SK_INLINE void blow_on_part(sk_run *run, const sk_op *op, const blow *air, size_t begin, size_t count) {
    uint32_t corner[3][SK_PART];
    bool strips = false;
    for (size_t l = 0; l < SK_PART; l++)
        for (int k = 0; k < 3; k++) {
            corner[k][l] = run->surface->rest.corner[begin + (l < count ? l : 0)][k];
            strips |= corner[k][l] < op->packed;
        }
    size_t packed = strips ? op->packed : 0;
    sk_wide3 x[3], moving = {{0}, {0}, {0}};
    for (int k = 0; k < 3; k++) {
        sk_wide4 at = sk_gather_any(run->vector[SK_X], packed, corner[k]),
                 v = sk_gather_any(run->vector[SK_V], packed, corner[k]);
        x[k] = (sk_wide3){at.x, at.y, at.z};
        moving = plus3(moving, (sk_wide3){v.x, v.y, v.z});
    }
    sk_wide3 share = share_of(air, minus3(x[1], x[0]), minus3(x[2], x[0]), moving, (sk_mask){0} == 0);
    SK_VECTOR_ALIGNED real lane[3][SK_PART];
    memcpy(lane[0], &share.x, sizeof lane[0]), memcpy(lane[1], &share.y, sizeof lane[1]);
    memcpy(lane[2], &share.z, sizeof lane[2]);
    for (size_t l = 0; l < count; l++)
        for (int k = 0; k < 3; k++)
            sk_add_at(run->vector[op->dst], packed, corner[k][l], sk_v3(lane[0][l], lane[1][l], lane[2][l]));
}

void SK_KERNEL(over_rest)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    const blow air = blow_of(((const sk_force *)op->rule)->params);
    for (size_t t = begin; t < end; t += SK_PART) blow_on_part(run, op, &air, t, end - t < SK_PART ? end - t : SK_PART);
}

#else

static const skein_field fields[] = {
    SK_VEC3(surface_wind_params, velocity, "velocity", "m/s", 0, 0, 0, "the air's velocity; 0 is still air"),
    SK_REAL(surface_wind_params, drag, "drag", "", 1.0, 0, 100, "coefficient of the part along the wind"),
    SK_REAL(surface_wind_params, lift, "lift", "", 0.4, 0, 100, "coefficient of the part along the normal"),
    SK_REAL(surface_wind_params, density, "density", "kg/m3", 1.2, 0, 1e4, "of the air"),
};

const sk_force_type sk_surface_wind = {
    .kind = {"surface_wind", "wind by triangle: lift and drag from its normal and its velocity through the air",
             SKEIN_FORCE, fields, sizeof fields / sizeof *fields, sizeof(surface_wind_params)},
    .domain = SK_OVER_TRIANGLES,
    .on_velocity = true,
    .kernel = {SK_EACH_ISA(over_rest)},
    .over_patch = {SK_EACH_ISA(over_patch)},
};
#endif
