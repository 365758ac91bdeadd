/* A part of elements of one kind of constraint: what its arithmetic works on, for as many elements at once as the
 * processor allows. A kind that is compiled into the library defines the numbers of particles (SK_ARITY) and of rest
 * values (SK_RESTS) of an element before it includes this. A kind whose value is the length of a weighted sum of
 * positions also defines SK_LINEAR and, for element_arithmetic.h, linear(). A kind whose value is the length of any
 * other vector L, and 0 at rest, may define SK_VECTOR and spread(), for the matrix of implicit solves: k J^T J with all
 * of J = dL/dx, since the gradient of the length says nothing about other directions. A kind with limits may define
 * SK_BEYOND(element, most), a cheap test that includes all lanes whose value is over `most`; one that only bounds
 * (SK_ONLY_BOUNDS) neither pulls nor projects. A kind without a divisor may say by how much a projection changes C at most
 * (SK_MOST_CHANGE). Kinds by formula, whose elements have any number of particles, define SK_ARITY as the largest number, and more
 * (projection.h). */
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
    double dt = op->dt > 0 ? op->dt : (double)INFINITY; // an op of forces has no substep
    return (sk_element_constants){(real)damping_time,
                                  (real)(op->coefficient[0] / (dt * dt)),
                                  (real)(damping_time / dt),
                                  (real)op->dt,
                                  (real)sk_batch_bound(batch),
                                  (real)op->coefficient[0],
                                  (real)op->coefficient[0] + (real)(op->coefficient[1] * damping_time)};
}

/* Whether a projection with kept multipliers has damping. */
static inline bool sk_is_damped(const sk_op *op) {
    return sk_element_prepare(((const sk_sweep *)op->rule)->batch, op).gamma > 0;
}

/* Groups [begin, end) of an op's sweep, or those of slabs [begin, end). */
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
#ifdef SK_ONLY_BOUNDS
#define SK_ELEMENT_KERNELS SK_LIMIT_KERNELS
#else
#define SK_ELEMENT_KERNELS                                                                                        \
    SK_WALK_KERNELS(force)                                                                                        \
    SK_WALK_KERNELS(apply)                                                                                        \
    SK_WALK_KERNELS(project) SK_WALK_KERNELS(project_damped) SK_LIMIT_KERNELS SK_KERNELS(sk_op_kernel, diagonal); \
    SK_KERNELS(sk_op_kernel, blocks);
#endif

#endif
