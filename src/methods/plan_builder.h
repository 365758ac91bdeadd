/* The plan builder, with which methods write plans: a call adds one op, or one for each enabled rule of a kind. */
#ifndef SK_METHODS_PLAN_BUILDER_H
#define SK_METHODS_PLAN_BUILDER_H

#include "colliders/collider.h"
#include "constraints/constraint.h"
#include "forces/force.h"
#include "limits/leash.h"
#include "limits/limit.h"

/* All rules of a world, in the order in which they were made. Owned by the world. */
typedef struct sk_rules {
    struct {
        sk_batch **data;
        size_t count, capacity;
    } batches;
    struct {
        sk_force **data;
        size_t count, capacity;
    } forces;
    struct {
        sk_collider **data;
        size_t count, capacity;
    } colliders;
    struct {
        sk_limit **data;
        size_t count, capacity;
    } limits;
    const sk_leashes *leashes; /* of the world's motions; NULL: there are none */
    bool strained;             /* when the present step began, some edge was near its bound (world/strained.c) */
    const char *sparse_solver; /* the name of the world's sparse solver; NULL: it has none */
} sk_rules;

typedef struct sk_plan_builder {
    sk_plan *plan;
    sk_allocator *allocator;
    const sk_rules *rules;
    sk_isa isa;
    size_t slot_count, particle_count;
    const sk_surface *surface;
    const sk_group *everybody;
    size_t strip_slots; /* the first slots, which are in strips */
    size_t packed;      /* the first slots that are in packed blocks now */
    double h;           /* of the present substep, s, */
    size_t iterations;  /* and how many of them the repeat has */
    bool sweeps_more;   /* edges that are not limited are swept more in steps that begin with some that are strained */
    bool predicted;     /* the substep began with X = X0 + h V */
    bool presses;       /* surfaces that are near press each other apart within the solve, and are not pushed */
    double before_end;  /* how long before the end of the substep X is now, s */
    size_t substep;     /* the place of the substep's repeat */
    uint32_t turn;      /* the last one of ops that have turns (plan/op.h) */
    uint32_t since;     /* that of ops that are added now, which then have turns; 0: they have none */
    const bool *strained; /* ops that are added now run only where that is so; NULL: always */
    bool no_memory;       /* the plan is incomplete */
} sk_plan_builder;

/* Opens a repeat of `times` substeps of `h` seconds; sk_write_end closes it. Returns its place. */
size_t sk_write_repeat(sk_plan_builder *builder, size_t times, double h);
void sk_write_end(sk_plan_builder *builder, size_t repeat);
/* Sets the time of X for the following ops: `part` of the substep, 0 at its start (as a repeat begins), 1 at its end.
 * Rules that depend on time use it. */
void sk_write_stage_time(sk_plan_builder *builder, double part);

/* Convert X and V of the strips from quads to packed blocks, and back: before and after all other ops of a step. */
void sk_write_pack(sk_plan_builder *builder);
void sk_write_unpack(sk_plan_builder *builder);
/* The end of every step: velocities too small to be seen become 0. */
void sk_write_rest(sk_plan_builder *builder);

/* X0 = X if contact reads X0: for methods that do not save it themselves, before they move X. */
void sk_write_start(sk_plan_builder *builder);
/* dst = a p + b q (q may be SK_NONE); dst = 0; dst = p + a w q. */
void sk_write_sum(sk_plan_builder *builder, sk_vector dst, double a, sk_vector p, double b, sk_vector q);
void sk_write_clear(sk_plan_builder *builder, sk_vector dst);
void sk_write_kick(sk_plan_builder *builder, sk_vector dst, sk_vector p, double a, sk_vector q);
/* X += h V for pinned particles alone, for methods that move no others by their velocities. */
void sk_write_lead(sk_plan_builder *builder, double h);

/* The steps of methods that integrate forces. X0 = X, V0 = V. */
void sk_write_save(sk_plan_builder *builder);
/* F = the total force at X and V: forces, constraints and contact. */
void sk_write_derivative(sk_plan_builder *builder);
/* X = X0 + a v, V = V0 + a w f. */
void sk_write_stage(sk_plan_builder *builder, double a, sk_vector v, sk_vector f);
/* The end of their substep: contact changes V, limits are applied, and particles are pushed out of colliders. */
void sk_write_impulses(sk_plan_builder *builder);

/* The start of a position method's substep: forces on particles, V += h w F (without F where all forces are uniform),
 * steering, X0 = X, V0 = V where there are colliders, X += h V. At most once in a plan. */
void sk_write_prediction(sk_plan_builder *builder);
/* V += (X - X0 - h V)/h: adds to V what moved X since the prediction. */
void sk_write_correction(sk_plan_builder *builder);

/* The ops that sort a group into cells of at least `radius`. The plan keeps the pointer to the group. */
void sk_write_cells(sk_plan_builder *builder, const sk_group *group, double radius);
/* F = the forces at X and V that rules exert: cells if a rule needs neighbours, then forces on particles and pairs. */
void sk_write_fields(sk_plan_builder *builder);
/* V += what the rules that steer ask for, then bounds on V: once a substep, see plan_builder_steer.c. */
void sk_write_steering(sk_plan_builder *builder);
/* The bounds once more, where forces have changed V after them. */
void sk_write_bounds(sk_plan_builder *builder);
bool sk_writes_steering(const sk_rules *rules);
/* F += the forces of every batch's constraints. */
void sk_write_forces(sk_plan_builder *builder);
/* Projects X by `passes` sweeps over every batch; X0 holds the positions at the start of the substep. */
void sk_write_projections(sk_plan_builder *builder, int passes);

/* The same without multipliers kept between passes: each pass has a `passes`-th of the stiffness and damping. */
void sk_write_shared_projections(sk_plan_builder *builder, int passes);

/* Whether anything acts on F. Where nothing steers either, it returns true, and F is 0. */
bool sk_writes_forces(const sk_plan_builder *builder);
/* Whether any force or damped constraint depends on velocities. */
bool sk_writes_velocity_forces(const sk_plan_builder *builder);
/* Whether contact or limits may change the state after a substep's own ops. */
bool sk_writes_corrections(const sk_plan_builder *builder);
bool sk_writes_contacts(const sk_rules *rules);
/* The first batch of infinite stiffness; NULL if there is none. */
const sk_batch *sk_first_rigid_batch(const sk_rules *rules);

typedef enum sk_contact_sort {
    SK_CONTACT_FORCE,
    SK_CONTACT_IMPULSE,
    SK_CONTACT_PUSH,
    SK_CONTACT_UPDATE
} sk_contact_sort;
/* An op for each collider. An update reads X0 and V0, the state before the substep's corrections. */
void sk_write_contacts(sk_plan_builder *builder, sk_contact_sort sort);
typedef enum sk_meeting_sort {
    SK_MEETING_BEGIN,
    SK_MEETING_HOLD,
    SK_MEETING_PUSH,
    SK_MEETING_PUSH_ON,
    SK_MEETING_LEAD,
    SK_MEETING_FACES,       /* from here on they ask where the substep began */
    SK_MEETING_FACES_AGAIN, /* those that were found where the last substep ended */
    SK_MEETING_BOUND
} sk_meeting_sort;
/* An op for each rule of contact between surfaces. The other functions here call it: a repeat of substeps begins and
 * ends with such ops, and the ops that push come with the limits. */
void sk_write_meetings(sk_plan_builder *builder, sk_meeting_sort sort, sk_vector velocity);
bool sk_writes_meetings(const sk_plan_builder *builder);
/* Limits, which move X; `velocity` is SK_V where the method does not take velocities from positions, else SK_NONE. */
void sk_write_limits(sk_plan_builder *builder, sk_vector velocity);

/* Whether updates of colliders leave for the next substep by which planes who touches them is held, while limits are swept (colliders/collider.h);
 * before them, nobody is. */
bool sk_keeps_planes(const sk_plan_builder *builder);
void sk_write_forget_planes(sk_plan_builder *builder);

/* For the builder's own files: adds an op, with the present substep and layout. */
void sk_add_op(sk_plan_builder *builder, sk_op op);
/* Adds a sweep's op, run in each `every`-th substep; `coefficient` is the number of ops that share the stiffness, or how far a limit goes beyond
 * its bound. */
void sk_add_sweep(sk_plan_builder *builder, const sk_sweep *sweep, sk_half half, sk_op_kind kind,
                  const sk_sweep_kernels *kernels, sk_vector dst, sk_vector second, double coefficient, size_t every,
                  sk_op_while during, const bool *strained);
/* Whether something bounds a batch's elements; whether tethers are kept, and whether they go with coarse grids; and adds their op. */
bool sk_batch_has_bound(const sk_batch *batch);
bool sk_limit_is_kept(const sk_limit *limit);
bool sk_limit_has_coarse(const sk_plan_builder *builder, const sk_limit *limit);
void sk_add_limit(sk_plan_builder *builder, const sk_limit *limit, sk_vector velocity);
/* Adds `op` for all sweeps of a batch, as sums over their elements; sweeps along the same strips share one op. */
void sk_add_sums(sk_plan_builder *builder, const sk_batch *batch, sk_op op, const sk_sweep_kernels *kernels);
/* Adds an op over slots, only for those that a rule acts on: one for each body if the rule names bodies. */
void sk_add_op_on(sk_plan_builder *builder, sk_op op, const sk_only *only);
/* The number of elements of a sweep's op: strip rows that have a partner `reach` rows on, slabs or groups. */
size_t sk_rows_of_sweep(const sk_sweep *sweep, size_t reach);
/* Whether a force adds to F and is enabled; and whether it is contact between surfaces that is. */
bool sk_pushes(const sk_force *force);
bool sk_meets(const sk_force *force);

#endif
