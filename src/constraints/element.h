/* As many constraints of one kind as the processor works on at once, on their way through its arithmetic. A kind that
 * is compiled into the library says how many particles an element has (SK_ARITY), and how many rest values (SK_RESTS),
 * before it includes this. One whose value is the length of a weighted sum of positions defines SK_LINEAR, and, for
 * element_arithmetic.h, linear(). One with limits may define SK_BEYOND(element, most): lanes whose value is over `most`
 * are among those that it gives, cheaply. */
#ifndef SK_CONSTRAINTS_ELEMENT_H
#define SK_CONSTRAINTS_ELEMENT_H

#include "base/kernels.h"
#include "constraints/sweep.h"
#include "plan/matrix.h"

/* A loop over an element's particles; unrolled, so that what it fills stays in registers. */
#ifdef __clang__
#define SK_EACH_PARTICLE(i) for (int i = 0; i < SK_ARITY; i++)
#else
#define SK_EACH_PARTICLE(i) _Pragma("GCC unroll 8") for (int i = 0; i < SK_ARITY; i++)
#endif

enum { SK_ROWS_SIDE_BY_SIDE = 8 }; /* strip rows whose chains of elements hide each other's latency */

typedef enum sk_element_mode {
    SK_MODE_FORCE,
    SK_MODE_APPLY, /* the matrix of an implicit solve times a direction */
    SK_MODE_PROJECT,
    SK_MODE_PROJECT_DAMPED,
    SK_MODE_LIMIT,
    SK_MODE_LIMIT_MOVING
} sk_element_mode;

/* What the formula leaves is its value, and its gradient G / divisor. Most kinds have no divisor; that of a distance
 * is its length, so that one division serves the direction and the multiplier. */
typedef struct sk_element {
    sk_wide3 x[SK_ARITY];
    sk_wide w[SK_ARITY];      /* inverse masses */
    sk_wide3 other[SK_ARITY]; /* velocities; of damped projection the positions at the substep's start; a direction */
    sk_wide rest[SK_RESTS], stiffness, multiplier;
    sk_wide soft; /* 1/(k h^2) */
    sk_wide value, divisor;
    sk_wide3 gradient[SK_ARITY];      /* G */
    bool divided, opposite;           /* there is a divisor, and G / divisor has length 1; G of the second is minus the
                                         first's. Constants, once all is inlined. */
    sk_wide scale[SK_ARITY];          /* what comes out, a force or a move, is scale G */
    sk_wide velocity_scale[SK_ARITY]; /* likewise of velocity, from a limit that moves */
    sk_mask over;                     /* a limit: the lanes that are over it, which alone move */
    sk_wide3 across;                  /* of a kind with SK_ACROSS: what is applied besides, to the first */
} sk_element;

/* What is the same for all elements of a row. */
typedef struct sk_element_constants {
    real damping_time; /* c/k, s */
    real per_step;     /* 1/h^2, times the projections that share the stiffness */
    real gamma;        /* c/(k h) */
    real bound;        /* of the relative violation */
    real elastic, both; /* of an implicit solve: the stiffness counts so many times, alone and with its damping */
} sk_element_constants;

static inline sk_element_constants sk_element_prepare(const sk_batch *batch, const sk_row *row) {
    double damping_time = sk_batch_damping_time(batch);
    return (sk_element_constants){(real)damping_time, (real)(row->coefficient[0] / (row->dt * row->dt)),
                                  (real)(damping_time / row->dt), (real)(batch->bound ? *batch->bound : 0),
                                  (real)row->coefficient[0],
                                  (real)row->coefficient[0] + (real)(row->coefficient[1] * damping_time)};
}

/* Declares the kernels that element_sweeps.h and element_stiffness.h define. */
#ifdef SK_WITH_STRIPS
#define SK_WALK_KERNELS(mode)                 \
    SK_KERNELS(sk_row_kernel, mode##_strips); \
    SK_KERNELS(sk_row_kernel, mode##_groups);
#else
#define SK_WALK_KERNELS(mode) SK_KERNELS(sk_row_kernel, mode##_groups);
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
    SK_KERNELS(sk_row_kernel, diagonal);                                                                        \
    SK_KERNELS(sk_row_kernel, blocks);

#endif
