/* The pen that methods write plans with: one call a row, or a row for each enabled rule of a sort. */
#ifndef SK_METHODS_WRITER_H
#define SK_METHODS_WRITER_H

#include "colliders/collider.h"
#include "constraints/constraint.h"
#include "forces/force.h"
#include "limits/limit.h"

/* Everything that acts, in the order of its making. Owned by the world. */
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
    const char *sparse_solver; /* the name of the world's; NULL: it has none */
} sk_rules;

typedef struct sk_writer {
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
    size_t turns;       /* and how many of them the repeat has */
    bool predicted;     /* X began the substep at X0 + h V */
    double before;      /* and how long before its end X is by now, s */
    size_t substep;     /* the place of its repeat */
    bool no_memory;     /* the plan is incomplete */
} sk_writer;

/* Opens a repeat of `times` substeps of `h` seconds; sk_write_end closes it. Returns its place. */
size_t sk_write_repeat(sk_writer *writer, size_t times, double h);
void sk_write_end(sk_writer *writer, size_t repeat);
/* Says where X stands from here on: `part` of the substep, 0 at its start (so a repeat begins), 1 at its end. Rules
 * that depend on time take it from there. */
void sk_write_moment(sk_writer *writer, double part);

/* X and V of the strips from quads to packed blocks, and back: around all other rows of a step. */
void sk_write_pack(sk_writer *writer);
void sk_write_unpack(sk_writer *writer);
/* The end of every step: what has all but come to rest does. */
void sk_write_rest(sk_writer *writer);

/* dst = a p + b q (q may be SK_NONE); dst = 0; dst = p + a w q. */
void sk_write_sum(sk_writer *writer, sk_vector dst, double a, sk_vector p, double b, sk_vector q);
void sk_write_clear(sk_writer *writer, sk_vector dst);
void sk_write_kick(sk_writer *writer, sk_vector dst, sk_vector p, double a, sk_vector q);
/* X += h V of held particles alone, for methods that move nothing else by its velocity. */
void sk_write_lead(sk_writer *writer, double h);

/* How a position method's substep begins: the fields, V += h w F (without F where all forces are plain), what steers,
 * X0 = X, V0 = V where there are colliders, X += h V. Once a plan. */
void sk_write_prediction(sk_writer *writer);
/* V += (X - X0 - h V)/h: V learns what moved X since it was predicted. */
void sk_write_correction(sk_writer *writer);

/* The rows that sort a group into cells of at least `radius`; the group stays where it is while the plan does. */
void sk_write_cells(sk_writer *writer, const sk_group *group, double radius);
/* F = all forces on X moving with V: the cells if a rule wants neighbours, then fields and neighbours. */
void sk_write_fields(sk_writer *writer);
/* V += what the rules that steer ask for, then bounds on V: once a substep, see writer_steer.c. */
void sk_write_steering(sk_writer *writer);
/* The bounds once more, where forces have acted on V after them. */
void sk_write_bounds(sk_writer *writer);
bool sk_writes_steering(const sk_rules *rules);
/* F += the springs of every batch. */
void sk_write_forces(sk_writer *writer);
/* X: `passes` sweeps over every batch; X0 is the state at the start of the substep. */
void sk_write_projections(sk_writer *writer, int passes);

/* The same without a memory from pass to pass: each has its share, a `passes`-th, of the stiffness and damping. */
void sk_write_shared_projections(sk_writer *writer, int passes);

/* Whether anything acts on F; where nothing steers either, it is said to, and F is 0. */
bool sk_writes_forces(const sk_writer *writer);
/* Whether any force or damped constraint depends on velocities. */
bool sk_writes_velocity_forces(const sk_writer *writer);
/* Whether contact or limits may change the state behind a substep's back. */
bool sk_writes_corrections(const sk_writer *writer);

typedef enum sk_contact_sort {
    SK_CONTACT_FORCE,
    SK_CONTACT_IMPULSE,
    SK_CONTACT_PUSH,
    SK_CONTACT_SETTLE
} sk_contact_sort;
/* A row for each collider. Settling looks at X0 and V0, the state before the substep's corrections. */
void sk_write_contacts(sk_writer *writer, sk_contact_sort sort);
typedef enum sk_meeting_sort { SK_MEETING_BEGIN, SK_MEETING_PUSH, SK_MEETING_BOUND } sk_meeting_sort;
/* A row for each rule that meets. The other functions here call it: a repeat of substeps begins and ends with such rows,
 * and they push with the limits. */
void sk_write_meetings(sk_writer *writer, sk_meeting_sort sort, sk_vector velocity);
bool sk_writes_meetings(const sk_writer *writer);
/* Limits move X; `velocity` is SK_V where the method does not take velocities from positions, else SK_NONE. */
void sk_write_limits(sk_writer *writer, sk_vector velocity);

/* For the writers' own files: adds a row, with the present substep and layout. */
void sk_add_row(sk_writer *writer, sk_row row);
/* The same row for all sweeps of a batch: a sum over their elements, of which those along the same strips make one row. */
void sk_add_sums(sk_writer *writer, const sk_batch *batch, sk_row row, const sk_sweep_kernels *kernels);
/* The same for a row over slots, on those alone that a rule acts on: a row for each body where it names some. */
void sk_add_row_on(sk_writer *writer, sk_row row, const sk_only *only);

#endif
