/* Constraints: functions C(x) of a few particles that want to be zero.
 *
 * A *type* is one file: its fields, its rest value and its kernels. A *batch* is a range of elements of
 * one type that share their settings; the world owns batches, bodies and users add them, methods write
 * a row for each. From the energy E = k C^2 / 2 (k stiffness, c damping, h the substep) follow
 *
 *   force     f  = -(k C + c dC/dt) grad C
 *   project   dl = (-C - l/(k h^2) - g dC) / ((1 + g) sum w |grad C|^2 + 1/(k h^2)),   dx = w grad C dl
 *             with g = c/(k h) and dC = grad C . (x - x0)           (XPBD; Macklin, Mueller 2016)
 *
 * An element's stiffness is the batch's times its scale: the share of the material that it stands for. */
#ifndef SK_CONSTRAINTS_CONSTRAINT_H
#define SK_CONSTRAINTS_CONSTRAINT_H

#include "base/fields.h"
#include "plan/row.h"

typedef struct sk_batch sk_batch;

typedef struct sk_constraint_type {
    skein_kind kind; /* the parameters begin with an sk_material */
    int arity;       /* particles an element */
    /* The rest value of an element whose particles stand at x[0 .. arity). */
    double (*rest)(const double (*x)[3]);
    sk_row_kernel *force;
    sk_row_kernel *project;        /* without damping, one pass a substep: no multiplier is kept */
    sk_row_kernel *project_damped; /* with damping or several passes */
    /* Relative violation of elements [begin, end): (length - rest)/rest for a distance. */
    void (*strain)(const sk_batch *batch, const sk_vec4 *x, size_t begin, size_t end, real *strain);
} sk_constraint_type;

/* What every constraint kind is made of. */
typedef struct sk_material {
    double stiffness; /* infinity is rigid, for position methods only */
    double damping;
} sk_material;

struct sk_batch {
    const sk_constraint_type *type;
    void *params;     /* the type's, an sk_material first; owned by whoever owns the batch */
    const char *label;
    const bool *enabled;
    bool measured;    /* an edge of a body: it counts in the stretch of the statistics */
    size_t count;
    uint32_t *particle;  /* count x arity, user's indices */
    uint32_t *slot;      /* the same as slots */
    real *rest;
    real *scale;         /* NULL: all 1 */
    real *stiffness;     /* params' times scale, refreshed when either changes */
    real *compliance;    /* 1 over it */
    real *multiplier;    /* lambda of XPBD, only read where a substep has several passes */
};

/* Makes a batch of copies; NULL when there is no memory. `rest` and `scale` (or NULL) have `count` reals. */
sk_batch *sk_batch_create(sk_allocator *allocator, const sk_constraint_type *type, size_t count,
                          const uint32_t *particles, const real *rest, const real *scale);
void sk_batch_release(sk_batch *batch, sk_allocator *allocator);
/* Brings slots and element stiffness up to date with the particles' slots and the parameters. */
void sk_batch_refresh(sk_batch *batch, const uint32_t *slot_of);
/* Sets the multipliers to zero: the kernel of multiplier rows. */
sk_row_kernel sk_batch_clear_multipliers;

/* Of a row: the batch's damping over stiffness, in seconds; 0 for a rigid batch. */
double sk_batch_damping_time(const sk_batch *batch);

extern const sk_constraint_type sk_distance;

#endif
