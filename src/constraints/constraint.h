/* Constraints: functions C(x) of a few particles that are to be zero.
 *
 * A *type* is one file: its fields, its rest values and its kernels. A *batch* is a list of elements of
 * one type that share their settings; the world owns batches, bodies and users add them. A batch is cut
 * into *sweeps* (sweep.h), and methods write an op for each. From the energy E = k C^2 / 2 (k stiffness,
 * c damping, h the substep) follow
 *
 *   force     f  = -(k C + c dC/dt) grad C
 *   project   dl = (-C - l/(k h^2) - g dC) / ((1 + g) sum w |grad C|^2 + 1/(k h^2)),   dx = w grad C dl
 *             with g = c/(k h) and dC = grad C . (x - x0)           (XPBD; Macklin, Mueller 2016)
 *   limit     C is moved back to a bound that it has passed, as if rigid there
 *
 * An element's stiffness is the batch's times the element's scale, its share of the material. */
#ifndef SK_CONSTRAINTS_CONSTRAINT_H
#define SK_CONSTRAINTS_CONSTRAINT_H

#include "base/fields.h"
#include "constraints/aggregate.h"
#include "constraints/coarse.h"
#include "formula/parameters.h"
#include "particles/particles.h"
#include "plan/op.h"

typedef struct sk_batch sk_batch;
typedef struct sk_sweep sk_sweep;
typedef struct sk_enclosure sk_enclosure;

enum { SK_MOST_ARITY = 8 }; /* particles an element */

/* A kernel for each way to walk a sweep; kinds without kernels along strips always go in groups. */
typedef struct sk_sweep_kernels {
    sk_kernels strips, groups;
} sk_sweep_kernels;

/* A constraint's value at the present positions. */
typedef struct sk_constraint_answer {
    double value, by_time; /* C, or an energy over the stiffness; its derivative by t alone */
    bool is_energy, one_sided, guarded;
} sk_constraint_answer;

typedef bool sk_any_beyond_kernel(const sk_batch *batch, const sk_vec4 *x, real most);

typedef struct sk_constraint_type {
    skein_kind kind; /* the parameters begin with an sk_material */
    int arity;       /* particles an element, 2 to 8 */
    int rest_count;  /* rest values of an element */
    /* The same two numbers if they differ between objects; NULL: they are the ones above. */
    int (*arity_of)(const void *params);
    int (*rest_count_of)(const void *params);
    /* The rest values of an element whose particles stand at x[0 .. arity); false when there is no memory. */
    bool (*rest)(const void *params, const double (*x)[3], double *rest);
    bool linear;        /* its elastic forces are linear in the positions, and 0 where all stand at the origin */
    bool in_blocks;     /* groups that share no particle are computed together */
    double most_change; /* of C in one projection; 0: any */
    sk_sweep_kernels force;
    sk_sweep_kernels project;        /* without damping, one pass a substep: no multiplier is kept */
    sk_sweep_kernels project_damped; /* with damping or several passes: multipliers are kept */
    sk_sweep_kernels limit;          /* moves positions so that C is within the batch's bound. Not every kind has one */
    sk_sweep_kernels limit_moving;   /* the same, also for velocities, where these are not taken from positions */
    /* For implicit solves, with the op's coefficients a and b: dst += (a k + b c) p for the direction p, the second
     * source, where k and c are the stiffness and damping at X (positive definite), over a sweep like forces or, for
     * kinds without that, over a batch's elements; and that matrix's diagonal 3 x 3 blocks, xx yy zz into dst, xy xz yz
     * into the second source. */
    sk_sweep_kernels apply_sweep;
    sk_kernels apply, diagonal;
    /* Adds all blocks of the same matrix to the run's (plan/matrix.h). NULL: an element has too many particles for
     * that, and the factor leaves it out. */
    sk_kernels blocks;
    /* Relative violation of elements [begin, end): (length - rest)/rest for a distance. */
    void (*strain)(const sk_batch *batch, const sk_vec4 *x, size_t begin, size_t end, real *strain);
    /* Whether any may be violated by more than that: no more may be than are. NULL: ask for all. */
    sk_any_beyond_kernel *any_beyond[SK_ISA_COUNT];
    /* Energies over the stiffness of elements [begin, end), C^2 / 2; returns how many had to be guarded
     * (formula/graph.h). */
    size_t (*energy)(const sk_batch *batch, double time, const sk_vec4 *x, size_t begin, size_t end, double *energy);
    /* For inspection: an element's value, and the gradients by up to `most` particles, in double, with the kernels'
     * derivatives. For a kind that encloses, those of the one constraint on all elements, by its vertices. False when
     * there is no memory. */
    bool (*evaluate)(const sk_batch *batch, double time, const sk_vec4 *x, size_t element, size_t most,
                     sk_constraint_answer *answer, double (*gradient)[3]);
    const char *text;        /* the kind's formula; NULL: it has none, or each object has its own (`making`) */
    const sk_making *making; /* what is made from its texts; NULL: nothing */
    /* For kinds whose batch is one constraint on all its elements, the triangles of a closed surface: makes the batch's
     * enclosure (enclosure.h), or says what is wrong with the surface. Their sweep kernels walk one group, apply and
     * diagonal the whole batch, and they have one energy, J, instead of `energy`. NULL for all others. */
    skein_status (*enclose)(sk_batch *batch, sk_allocator *allocator, const sk_particles *particles, skein_error *error);
    double (*whole_energy)(const sk_batch *batch, const sk_vec4 *x, size_t *guarded);
} sk_constraint_type;

/* The parameters of every constraint kind. */
typedef struct sk_material {
    double stiffness; /* infinity is rigid, for position methods only */
    double damping;
} sk_material;

/* A list of elements. */
typedef struct sk_elements {
    size_t count;
    uint32_t *particle; /* count x arity, user's indices */
    real *rest;         /* rest_count x count: the first value of all elements, then the second ... */
    real *scale;        /* NULL: all 1 */
} sk_elements;

struct sk_batch {
    const sk_constraint_type *type;
    void *params; /* the type's, an sk_material first; owned by whoever owns the batch */
    const char *label;
    const bool *enabled;
    const double *bound;  /* on the relative violation, enforced by limit ops; NULL: none */
    const double *tether; /* of a sheet's edges: how much its tethers let it stretch. While that is finite, and nothing
                           * limits them, those that only too few sweeps can have left stretched are taken back
                           * (world/strained.c); NULL: never */
    bool strained;        /* when the present step began some were near their bound, or beyond it */
    bool only_bounds;     /* it only bounds: it does not pull, and is not counted */
    double quickness;     /* 1/s2 for a stiffness of 1: an element's largest sum of w |grad C|^2, times its scale: the
                            square of its angular frequency. If low for the substep, position methods may project the
                            batch in every second one, with the same stiffness; 0: in every one */
    sk_coarse *coarse;    /* its particles are those of a coarse grid (constraints/coarse.h), only bounded; or NULL */
    sk_aggregate *aggregate; /* its particles are hubs, which carry others (constraints/aggregate.h), only bounded */
    uint32_t most_edges; /* of one that only bounds: so many edges of its body's surface lead from end to end of an element
                            at most; 0: that was not looked for yet (world/severed.c) */
    bool measured;       /* an edge of a body: it counts in the stretch of the statistics */
    size_t count, arity, rest_count;
    uint32_t *particle;          /* count x arity, user's indices */
    uint32_t *slot;              /* the same as slots, */
    size_t first_slot, end_slot; /* which are all in [first, end) */
    real *rest;                  /* rest_count x count: first all first ones */
    real *scale;                 /* NULL: all 1 */
    sk_elements whole;           /* all elements, if some are left out above; else empty */
    bool broken, rests; /* of one constraint on all elements: some of its particles are gone, or take no part */
    bool asleep;        /* all that it is on sleeps: it is there, and does not act */
    uint32_t *pair;     /* arity (arity - 1)/2 x count: where pairs' blocks lie in the world's matrix; NULL: none */

    /* Made from the above when slots change: elements in the order of sweeps, each with a lane. */
    sk_sweep *sweeps;
    size_t sweep_count, sweep_capacity;
    uint32_t *lane; /* of each element */
    size_t lane_count;
    real *lane_rest;       /* rest_count x lane_count; lanes without an element have 0 here, */
    real *lane_stiffness;  /* 0 here, */
    real *lane_compliance; /* and infinity here, so that they have no effect */
    real *lane_multiplier; /* lambda of XPBD, only read if a substep keeps it */
    uint8_t *special;      /* for each block of 16 lanes: some lane differs from the sweep's common values */
    uint64_t *found;       /* and in which turn all of them were within their bound (plan/op.h, sk_watch) */
    bool stale;            /* the lanes are new, or the parameters have changed: sk_batch_refresh() is needed */

    sk_enclosure *enclosure; /* of a kind that has one, else NULL */
    bool both_ways;          /* swept in halves: one on the way forward through all batches, one on the way back */
    bool compiled;           /* compiled code runs it, which needs no blocks of groups */
};

/* Whether corrections of its elements are carried on to other particles, by a coarse grid or an aggregate. */
static inline bool sk_batch_carries(const sk_batch *batch) {
    return batch->coarse || batch->aggregate;
}
/* Makes a batch from copies of the arrays; NULL when there is no memory. `rest` has rest_count x count reals, `scale`
 * (or NULL) `count`. It keeps the pointer to the parameters. */
sk_batch *sk_batch_create(sk_allocator *allocator, const sk_constraint_type *type, const void *params, size_t count,
                          const uint32_t *particles, const real *rest, const real *scale);
/* Whether it acts at all. */
bool sk_batch_is_on(const sk_batch *batch);
/* Whether it acts and pulls: exerts forces, or is projected. */
bool sk_batch_pulls(const sk_batch *batch);
/* Whether it is of edges that are meant to be firm, and that nothing limits; and what limit ops take them back to, where nothing limits
 * them, or else its bound. */
bool sk_batch_is_firm(const sk_batch *batch);
#define SK_FIRM_BOUND 0.05 /* of a stiff sheet hardly anything is meant to be stretched by more */
static inline double sk_batch_bound(const sk_batch *batch) {
    if (!batch->bound) return 0;
    const bool own = !batch->tether || *batch->bound < SK_UNBOUNDED;
    return own || !sk_batch_is_firm(batch) ? *batch->bound : SK_FIRM_BOUND;
}
/* Whether it pulls, or would if it did not sleep: it holds energy. */
bool sk_batch_is_loaded(const sk_batch *batch);
/* Leaves out the elements of particles that take no part (for good if they are gone), and restores those whose
 * particles all take part again. False when there is no memory: nothing has changed then. */
bool sk_batch_leave_out(sk_batch *batch, sk_allocator *allocator, const sk_particles *particles);
int sk_constraint_arity(const sk_constraint_type *type, const void *params);
int sk_constraint_rest_count(const sk_constraint_type *type, const void *params);
void sk_batch_release(sk_batch *batch, sk_allocator *allocator);
/* Cuts the batch into sweeps for the particles' present slots. False when there is no memory. */
bool sk_batch_arrange(sk_batch *batch, sk_allocator *allocator, const sk_particles *particles);
/* Releases the sweeps and all that belongs to them. */
void sk_batch_forget_sweeps(sk_batch *batch, sk_allocator *allocator);
/* ---- for inspection (inspect.c), while slots are up to date ---- */
/* How many constraints the batch is, and how many particles each has. */
size_t sk_batch_constraint_count(const sk_batch *batch);
size_t sk_batch_particle_count(const sk_batch *batch);
/* Particle i of a constraint. */
uint32_t sk_batch_particle(const sk_batch *batch, size_t element, size_t i);
/* Its formula; "" where there is none. */
const char *sk_batch_text(const sk_batch *batch);
/* Does the work of skein_constraint_operations(). */
skein_status sk_batch_operations(const sk_batch *batch, sk_allocator *allocator, double time, const sk_vec4 *x,
                                 size_t element, skein_operation *out, double *derivatives, size_t most, size_t *count,
                                 skein_error *error);

/* Updates the lanes' rest values and stiffness to the parameters, if they are stale. */
void sk_batch_refresh(sk_batch *batch);
/* Sets the multipliers of a sweep to zero: the kernel of multiplier ops. */
sk_op_kernel sk_sweep_clear_multipliers;

/* The batch's damping over stiffness, in seconds; 0 for a rigid batch. */
double sk_batch_damping_time(const sk_batch *batch);

extern const struct sk_constraint_type sk_coarse_distance, sk_extension; /* not for users */

#endif
