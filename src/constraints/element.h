/* As many constraints of one kind as the processor works on at once, on their way through its arithmetic. A kind that
 * is compiled into the library says how many particles an element has (SK_ARITY), and how many rest values (SK_RESTS),
 * before it includes this. One whose value is the length of a weighted sum of positions defines SK_LINEAR, and, for
 * element_arithmetic.h, linear(). One with limits may define SK_BEYOND(element, most): lanes whose value is over `most`
 * are among those that it gives, cheaply. Texts, whose elements have any number of particles, say SK_ARITY as the most that
 * there may be, and more (projection.h). */
#ifndef SK_CONSTRAINTS_ELEMENT_H
#define SK_CONSTRAINTS_ELEMENT_H

#include <math.h>
#include <skein/compiled.h>

#include "base/kernels.h"
#include "constraints/sweep.h"
#include "plan/matrix.h"

#ifdef SK_ISA

#include <skein/inside/projection.h>

enum { SK_ROWS_SIDE_BY_SIDE = 8 }; /* strip rows whose chains of elements hide each other's latency */

static inline sk_element_constants sk_element_prepare(const sk_batch *batch, const sk_op *op) {
    double damping_time = sk_batch_damping_time(batch);
    double dt = op->dt > 0 ? op->dt : (double)INFINITY; // a force knows no step
    return (sk_element_constants){(real)damping_time,
                                  (real)(op->coefficient[0] / (dt * dt)),
                                  (real)(damping_time / dt),
                                  (real)op->dt,
                                  (real)(batch->bound ? *batch->bound : 0),
                                  (real)op->coefficient[0],
                                  (real)op->coefficient[0] + (real)(op->coefficient[1] * damping_time)};
}

/* Whether multipliers that are kept are damped, too. */
static inline bool sk_is_damped(const sk_op *op) {
    return sk_element_prepare(((const sk_sweep *)op->rule)->batch, op).gamma > 0;
}

/* Groups [begin, end) of a row, or those of slabs [begin, end). */
static inline skein_groups sk_groups_of(sk_run *run, const sk_op *op, size_t begin, size_t end, sk_element_mode mode) {
    const sk_sweep *sweep = op->rule;
    const sk_batch *batch = sweep->batch;
    if (sweep->slab_start) begin = sweep->slab_start[begin], end = sweep->slab_start[end];
    size_t lane = sweep->first_lane + begin * SK_LANES;
    bool sums = mode == SK_MODE_FORCE || mode == SK_MODE_APPLY;
    sk_vector other = mode == SK_MODE_APPLY ? op->source[1] : mode == SK_MODE_PROJECT_DAMPED ? SK_X0 : SK_V;
    return (skein_groups){
        .count = end - begin,
        .slots = sweep->slots + begin * batch->arity * SK_LANES,
        .ahead = sweep->ahead ? sweep->ahead + begin : NULL,
        .packed = op->packed,
        .positions = &run->vector[SK_X]->x,
        .other = &run->vector[other]->x,
        .sums = sums ? &run->vector[op->dst]->x : NULL,
        .rest = batch->lane_rest + lane,
        .rest_stride = batch->lane_count,
        .stiffness = batch->lane_stiffness + lane,
        .compliance = batch->lane_compliance + lane,
        .multiplier = batch->lane_multiplier + lane,
    };
}

#endif

/* Declares the kernels that element_sweeps.h and element_stiffness.h define. */
#ifdef SK_WITH_STRIPS
#define SK_WALK_KERNELS(mode)                \
    SK_KERNELS(sk_op_kernel, mode##_strips); \
    SK_KERNELS(sk_op_kernel, mode##_groups);
#else
#define SK_WALK_KERNELS(mode) SK_KERNELS(sk_op_kernel, mode##_groups);
#endif
#ifdef SK_WITH_LIMITS
#define SK_LIMIT_KERNELS SK_WALK_KERNELS(limit) SK_WALK_KERNELS(limit_moving)
#else
#define SK_LIMIT_KERNELS
#endif
#define SK_ELEMENT_KERNELS                                                                                      \
    SK_WALK_KERNELS(force)                                                                                      \
    SK_WALK_KERNELS(apply)                                                                                      \
    SK_WALK_KERNELS(project) SK_WALK_KERNELS(project_damped) SK_LIMIT_KERNELS                                   \
    SK_KERNELS(sk_op_kernel, diagonal);                                                                        \
    SK_KERNELS(sk_op_kernel, blocks);

#endif
