/* The adjoint of a plan: its ops in reverse. Of each vector there is an *adjoint*, the derivative of the measure by it;
 * an op that read vectors and wrote one hands that one's adjoint on to them. Called by run_gradient.c.
 *
 * Vectors lie as they do while the plan runs, strips in packed blocks; the w of adjoints are 0, always, so that sums go over all
 * numbers alike. */
#ifndef SK_WORLD_ADJOINT_H
#define SK_WORLD_ADJOINT_H

#include "world/world.h"

/* What a field changes: a batch's stiffness and damping, and a force, each by one of the field. */
typedef struct sk_effect {
    double *stiffness, *damping; /* of each batch */
    sk_uniform_force *force;     /* of each force */
    bool on_forces;              /* on any */
} sk_effect;

/* X and V, where forces were looked at; of an implicit solve, what it has found; of projections, X before the first of a
 * substep, and X0 in the place of V. */
typedef struct sk_taped {
    real *x, *v;
} sk_taped;

/* What solving with the transposed matrix takes: see adjoint_solve.c. */
enum { SK_KRYLOV = 20 };
typedef struct sk_krylov {
    const sk_op *op; /* the plan's solve; NULL: it has none */
    real *basis[SK_KRYLOV + 1], *change[SK_KRYLOV], *right, *left, *by_x, *by_v;
    double *by_effect;
    size_t products; /* so far */
} sk_krylov;

typedef struct sk_projections sk_projections; /* what going through projections takes: see adjoint_project.c */

typedef struct sk_adjoint {
    skein_world *world;
    size_t reals;  /* of a vector: 4 a slot, spare ones too */
    size_t packed; /* slots in packed blocks while the plan runs */
    double span;   /* m, how far positions are moved to either side to see how a force changes */
    real *of[SK_VECTOR_COUNT];
    real *inverse_mass, *mass; /* of each number; 0 beside x, y and z, and for particles that are pinned or none */
    real *moved, *still, *force[2], *plain[5];
    real *side[2];      /* X a little to either side, along the adjoint of F, */
    double step;        /* by so much of that; 0: not made for the present state */
    double work;        /* of the forces added up there so far, times the adjoint of F */
    double most;        /* the largest number of the adjoint of F; below 0: not looked for */
    real *unit;         /* that adjoint over `most`; */
    real *linear;       /* forces there of what is linear, */
    bool unit_made;     /* for the present state; */
    double linear_work; /* and X times them */
    bool keeps_v;       /* the tape has V: forces, or what is asked of them, depend on it */
    bool pulled;        /* the tape has X and V before each op that pulls: a field changes forces */
    struct {
        sk_taped *data;
        size_t count, capacity;
    } tape;
    size_t used; /* of the tape */
    sk_krylov krylov;
    sk_projections *projections; /* NULL: the plan has none */
    sk_uniform_force *forces;    /* each of the world's as it is */
    sk_effect *effects;
    size_t effect_count;
    double *by_effect;
} sk_adjoint;

/* Looks whether the plan can be gone through in reverse, and makes what that takes; the effects are there. */
skein_status sk_adjoint_begin(sk_adjoint *a, skein_world *world, skein_error *error);
void sk_adjoint_end(sk_adjoint *a);
/* A step: runs the plan once, and puts what its forces looked at on the tape, if `tape`. */
skein_status sk_adjoint_run(sk_adjoint *a, double dt, bool tape, skein_error *error);
/* Goes through it in reverse, from what the tape had last on: adjoints of X and V after the step become those before
 * it, at the time `start`. Fails where a damped constraint is none that can be followed. */
skein_status sk_adjoint_reverse(sk_adjoint *a, double start, double dt, skein_error *error);
/* ---- between the files of adjoints ---- */

/* Ops that look at one state, of whose forces F- is the adjoint: X-, V- and fields get their part of it, and F- is 0
 * where the first of the ops sets F. */
skein_status sk_adjoint_reverse_looks(sk_adjoint *a, const sk_op *ops, size_t count, const sk_taped *at, double time,
                                      skein_error *error);
static inline bool sk_adjoint_looks_at_state(const sk_op *op) {
    sk_reverse reverse = sk_op_type_of(op)->reverse;
    return (reverse == SK_REVERSE_ELASTIC && op->dst == SK_F) || reverse == SK_REVERSE_FIELD;
}
/* Whether an op makes S, which a solve reads. */
bool sk_adjoint_opens(const sk_op *op);
/* Memory for a plan's solve, and its end. */
bool sk_adjoint_begin_solve(sk_adjoint *a, const sk_op *solve);
void sk_adjoint_end_solve(sk_adjoint *a);
/* An implicit solve that found `at`: adjoints of X and V after it become those of X0 and V0. */
skein_status sk_adjoint_reverse_solve(sk_adjoint *a, const sk_taped *at, double time, skein_error *error);
/* Whether an op is one of projections: of a sweep, or of its multipliers. */
bool sk_adjoint_projects(const sk_op *op);
/* Memory for a plan's projections, and its end. */
bool sk_adjoint_begin_projections(sk_adjoint *a);
void sk_adjoint_end_projections(sk_adjoint *a);
/* The projections of a substep: X- after them becomes X- before them, X0- and fields get their part. */
skein_status sk_adjoint_reverse_projections(sk_adjoint *a, const sk_op *ops, size_t count, size_t iteration,
                                            const sk_taped *at, double time, skein_error *error);
/* The number of vectors' numbers, zeroed. */
real *sk_adjoint_new_numbers(sk_adjoint *a);

/* ---- */

/* How often op r of a plan, or the ops that it repeats, put a state on the tape; 0 for those that are repeated. */
size_t sk_adjoint_looks(const sk_plan *plan, size_t r);
/* Where in a vector's numbers a particle's x is, and how far y and z are from each other. */
size_t sk_adjoint_place(const sk_adjoint *a, size_t particle, size_t *stride);
static inline void sk_effect_release(sk_effect *effect, sk_allocator *allocator) {
    sk_release(allocator, effect->stiffness);
    sk_release(allocator, effect->damping);
    sk_release(allocator, effect->force);
}

#endif
