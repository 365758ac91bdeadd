/* Sixteen constraints between two particles, on their way through a kind's arithmetic. */
#ifndef SK_CONSTRAINTS_PAIR_H
#define SK_CONSTRAINTS_PAIR_H

#include "base/wide_types.h"
#include "constraints/sweep.h"

enum { SK_ROWS_SIDE_BY_SIDE = 8 }; /* strip rows whose chains of elements hide each other's latency */

typedef enum sk_pair_mode {
    SK_PAIR_FORCE,
    SK_PAIR_PROJECT,
    SK_PAIR_PROJECT_DAMPED,
    SK_PAIR_LIMIT,
    SK_PAIR_LIMIT_MOVING
} sk_pair_mode;

typedef struct sk_pair {
    sk_wide3 a, b;             /* positions */
    sk_wide wa, wb;            /* inverse masses */
    sk_wide3 other_a, other_b; /* velocities; of damped projection the positions at the substep's start */
    sk_wide rest, stiffness, multiplier;
    sk_wide soft;        /* 1/(k h^2) */
    sk_wide3 da, db;     /* what comes out, forces or moves: a gets da, b loses db */
    sk_wide3 dv_a, dv_b; /* likewise of velocity, from a limit that moves */
} sk_pair;

/* What is the same for all elements of a row. */
typedef struct sk_pair_constants {
    real damping_time; /* c/k, s */
    real per_step;     /* 1/h^2, times the projections that share the stiffness */
    real gamma;        /* c/(k h) */
    real most;         /* 1 + bound */
} sk_pair_constants;

static inline sk_pair_constants sk_pair_prepare(const sk_batch *batch, const sk_row *row) {
    double damping_time = sk_batch_damping_time(batch);
    return (sk_pair_constants){(real)damping_time, (real)(row->coefficient[0] / (row->dt * row->dt)),
                               (real)(damping_time / row->dt), (real)(1 + (batch->bound ? *batch->bound : 0))};
}

#endif
