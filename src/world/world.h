/* The world: particles, objects, rules and the plan, and the functions that builders may call.
 *
 *   objects   what users hold handles of: bodies, constraints, forces, colliders
 *   rules     what methods see: batches, forces, colliders, limits, in the order of their making
 *   plan      the ops that the method wrote for these rules and this step; rewritten when they change
 *
 * Nothing in src/world/ knows a kind by name: types come in as pointers from the catalogue above. */
#ifndef SK_WORLD_WORLD_H
#define SK_WORLD_WORLD_H

#include "base/names.h"
#include "base/pace.h"
#include "base/printf.h"
#include "base/status.h"
#include "base/tasks.h"
#include "formula/parameters.h"
#include "methods/method.h"
#include "motions/motion.h"
#include "particles/surface.h"
#include "plan/matrix.h"
#include "plan/share.h"
#include "plan/solve.h"

typedef struct sk_body sk_body;
typedef struct sk_cut sk_cut;

/* A builder: lays down particles and rules through the functions below. */
typedef struct sk_body_type {
    skein_kind kind;
    /* Builds the body. What it added is taken back if it fails. */
    skein_status (*build)(skein_world *world, sk_body *body, const void *params, const skein_mesh *mesh,
                          skein_error *error);
    /* Whether a field can change once the body is built (a stiffness can, a grid's size cannot). */
    bool (*live)(const void *params, const char *field);
    /* Passes changed parameters on to the body's rules. */
    void (*change)(sk_body *body, const void *params);
    /* Adds tethers to some of its particles, pins[i] of each, once it is built (world/tethers.c); NULL: it has none. */
    skein_status (*tether)(skein_world *world, sk_body *body, const void *params, const bool *pins, skein_error *error);
    skein_shape_sort shape;    /* what it looks like: its faces, if nothing is said */
    const sk_making *making;   /* what is made from its parameters; NULL: nothing */
    const sk_presets *presets; /* a choice that stands for other fields; NULL: none does */
    bool is_sheet; /* its faces, as fans one after the other, are its triangles, and all that it is: it can be cut */
} sk_body_type;

enum { SK_MOST_BODY_BATCHES = 16 };

/* What is known of a body's rest (world/sleep.c). */
typedef struct sk_rest {
    bool asleep;
    bool roused;          /* it was changed by hand since the last step: it is to wake, and who is near where it */
    real low[3], high[3]; /* was then */
    sk_vec3 *from;        /* where it was when it began to be still, particle_count; NULL: that is to begin */
    double still;         /* s: for how long it has been */
    uint64_t near;        /* whom it might touch meanwhile: a sum over them */
} sk_rest;

/* What a body added to the world. */
struct sk_body {
    uint32_t first_particle, particle_count;
    uint32_t *particle_of_vertex, *face_sizes, *face_vertices; /* the surface as it came */
    size_t vertex_count, face_count, face_vertex_count;
    size_t first_triangle, triangle_count; /* of the world's */
    uint32_t grid_rows, grid_columns;      /* 0: not a grid */
    float *corner_uv;                      /* face_vertex_count x 2, or NULL: kept for whoever draws */
    sk_batch *batch[SK_MOST_BODY_BATCHES];
    sk_material *material[SK_MOST_BODY_BATCHES]; /* of the batch beside it */
    size_t batch_count;
    double tether_bound, strain_bound; /* of its limits */
    double tear_bound;                 /* the stretch at which its edges give way; 0: never */
    bool *built_pins,
        *late_pins; /* of each particle: whether it was pinned as the body was built, and whether there are tethers to
                                   * it because it was so later; NULL: none */
    sk_cut *cut;    /* NULL: it never was (world/cut.h) */
    bool enabled;
    sk_rest rest;
    const char *label; /* its name, else its kind's */
};

/* What bodies, constraints and forces have besides their own fields. */
typedef struct sk_common {
    char *name, *on; /* on: forces only */
    bool enabled, visible;
    char *groups; /* bodies only: names, commas between them */
    double sleep; /* bodies only: m/s, 0: never */
} sk_common;

typedef struct sk_object {
    uint32_t index, generation; /* of its handle; the generation is odd once it lives */
    skein_category category;
    const skein_kind *kind;
    skein_kind *own_kind;    /* what `kind` is where it takes parameters, else NULL */
    const sk_making *making; /* what its type makes from its parameters; NULL: nothing */
    void *params;            /* the kind's fields */
    union {
        sk_common plain;
        sk_collider_common collider;
        sk_motion_common motion;
    } common;
    char label[96];
    const sk_body_type *body_type; /* bodies only */
    void *user;                    /* the program's own */
    union {
        sk_body *body;
        sk_batch *batch;
        sk_force *force;
        sk_collider *collider;
        sk_motion *motion;
    } as;
} sk_object;

/* Where a handle leads: to an object, or to nobody until the next one takes it. */
typedef struct sk_entry {
    sk_object *object;
    uint32_t generation;
} sk_entry;

/* Where steps are computed, when it is not the processor: runs the same plan on its own copy of the state. The
 * world does not know what it is; src/gpu/ makes one. A device is `ahead` when its X, V and P are newer than the
 * world's, and `behind` when the world's are newer. */
typedef struct sk_device sk_device;
struct sk_device {
    /* Takes a new plan, or says which rule of it cannot run there. */
    skein_status (*prepare)(sk_device *device, skein_world *world, skein_error *error);
    /* Runs the plan once; `run` holds the time, and the world's vectors if the device is behind. */
    skein_status (*step)(sk_device *device, skein_world *world, sk_run *run, skein_error *error);
    /* Copies X, V and P into the world's. */
    skein_status (*read)(sk_device *device, skein_world *world, skein_error *error);
    void (*release)(sk_device *device, skein_world *world);
    void (*wait)(sk_device *device); /* until all that was asked for is done */
    bool ahead, behind;
    const char *name; /* of one that is no card, else NULL */
};

/* A motion as a frame, in a step: where it puts what was built (world/frames.c). */
typedef struct sk_leg {
    sk_frame start, carried, end;
    bool carries, jumps;
} sk_leg;

/* Particles that were carried along before a step. */
typedef struct sk_carried {
    size_t first, count;
    sk_frame way;
    bool jumps;
} sk_carried;

/* A pinned particle and the place that it is to have at the end of the step. */
typedef struct sk_pin {
    uint32_t particle;
    double place[3];
} sk_pin;

struct skein_world {
    sk_allocator allocator;
    skein_world_desc desc;
    uint64_t identity; /* in its handles: no other world that lives has it */
    skein_error words; /* the last failure; reached through `error`, also where the world is constant */
    skein_error *error;
    sk_tasks *tasks;
    sk_pace pace; /* how many of the threads a step takes */
    sk_particles particles;
    bool supported;         /* their SUPPORT is not all 0 */
    sk_triangles triangles; /* as user's indices */
    sk_surface surface;     /* the same as slots */
    sk_rules rules;
    struct {
        sk_object **data;
        size_t count, capacity;
    } objects; /* those that live, in the order of their making */
    struct {
        sk_entry *data;
        size_t count, capacity;
    } places; /* a handle's index leads here */
    struct {
        char **data;
        size_t count, capacity;
    } gone_names; /* of bodies that were removed, and groups that lost a body, where rules still name them */
    const sk_method_type *method;
    void *method_params;
    sk_plan plan;
    sk_op *live; /* room for those of its ops that a step needs (step.c), where some are not always needed; else NULL */
    double plan_dt;    /* the step that the plan was written for, */
    int plan_substeps; /* and how many substeps it has */
    struct {
        uint64_t *moved, *found_held; /* as a run has them; NULL: the plan has no ops with turns */
        size_t room;                  /* of both */
        uint64_t turn, turns;         /* the next step's first one; how many the plan has */
        bool never;                   /* for tests: all is looked at */
    } watch;
    float substep;        /* s, of the last step, if its method shortens slowly; else 0 */
    bool sweeps_more;     /* the plan has sweeps for what is strained although nothing limits it (strained.c) */
    bool plan_stale;      /* rules, settings or the method have changed */
    bool unfused;         /* the plan stays as the method writes it (plan/fuse.h) */
    bool slots_stale;     /* particles, batches or limits were added: slots and sweeps are to be found anew */
    bool pins_stale;      /* somebody was pinned, or let go */
    uint64_t arrangement; /* how often slots were found */
    bool roused;          /* rules have changed since the last step: all that sleeps is to wake */
    bool sleepers_known;  /* among those that sleep so many edges go through triangles: */
    size_t crossings_asleep;
    bool presence_stale; /* bodies were taken out or back: constraints on their particles are to be looked through */
    sk_isa isa;
    sk_cells cells;
    sk_group everybody;
    struct {
        sk_pin *data;
        size_t count, capacity;
    } pins, led; /* what a program says for the next step, and that after what motions say; a later one of the same
                    particle counts */
    struct {
        sk_motion **data;
        size_t count, capacity;
    } motions;
    struct {
        sk_leg *data;
        size_t count, capacity;
    } legs; /* of each motion, in the present step */
    struct {
        sk_carried *data;
        size_t count, capacity;
    } carried; /* in the present step */
    sk_leashes leashes;
    bool motions_stale; /* whom they lead is to be found anew */
    uint32_t *led_at;   /* of each particle its place in `led`, while motions are asked */
    double time;
    uint64_t steps, substeps;
    uint64_t unsolved, solver_failures; /* of all steps, where a method solves */
    uint64_t contact_overflows;         /* and how often contact gave up */
    double first_energy;                /* J, when the first step began */
    sk_solve solve;                     /* of the last step */
    sk_matrix matrix;                   /* where a plan factors one, and the solver */
    sk_device *device;                  /* NULL: the processor */
    struct {
        const skein_compiled **data;
        size_t count, capacity;
    } compiled;                     /* what was registered; the newest is asked first */
    struct sk_recording *recording; /* NULL: nobody records */
    sk_share *share;                /* NULL: this is the whole run */
};

/* The body that an object at a place of the list is; NULL: another. */
static inline sk_body *sk_world_body_at(const skein_world *world, size_t i) {
    return world->objects.data[i]->category == SKEIN_BODY ? world->objects.data[i]->as.body : NULL;
}

/* ---- for the catalogue: adding objects of a known type ---- */

skein_status sk_world_add_body(skein_world *world, const sk_body_type *type, const skein_mesh *mesh,
                               const skein_setting *settings, skein_handle *handle);
skein_status sk_world_add_constraint(skein_world *world, const sk_constraint_type *type, const uint32_t *particles,
                                     size_t count, const skein_setting *settings, skein_handle *handle);
skein_status sk_world_find_arity(skein_world *world, const sk_constraint_type *type, const skein_setting *settings,
                                 size_t *arity);
skein_status sk_world_add_force(skein_world *world, const sk_force_type *type, const skein_setting *settings,
                                skein_handle *handle);
skein_status sk_world_add_collider(skein_world *world, const sk_collider_type *type, const skein_mesh *mesh,
                                   const skein_setting *settings, skein_handle *handle);
skein_status sk_world_add_motion(skein_world *world, const sk_motion_type *type, const skein_track *track,
                                 const skein_setting *settings, skein_handle *handle);
skein_status sk_world_set_method(skein_world *world, const sk_method_type *type, const skein_setting *settings);
/* The error of a call on this world, to fill in; NULL where there is no world. */
skein_error *sk_world_error(const skein_world *world);
/* Returns from a public call where the argument of this name is NULL (`world_` may be it). */
#define SK_NEED(world_, argument_)                                                 \
    do {                                                                           \
        if (!(argument_)) return sk_fail_null(sk_world_error(world_), #argument_); \
    } while (0)

/* ---- for builders ---- */

skein_status sk_world_add_particles(skein_world *world, size_t count, const double *positions, const double *velocities,
                                    const double *masses, skein_error *error);
/* A batch of a body. `measured` ones count in the stretch statistics. Empty batches are allowed. */
skein_status sk_world_add_body_batch(skein_world *world, sk_body *body, const sk_constraint_type *type,
                                     const char *label, sk_material material, bool measured, size_t count,
                                     const uint32_t *particles, const real *rest, const real *scale, skein_error *error);
skein_status sk_world_add_tethers(skein_world *world, sk_body *body, sk_limit_order order, size_t count, size_t anchors,
                                  const uint32_t *particles, const real *lengths, skein_error *error);
/* Says that the body's `count` particles are a grid of rows x columns: particle i has place place[i] (row x columns
 * + column; each its own), or i itself where `place` is NULL. Places may stay empty. */
skein_status sk_world_add_strips(skein_world *world, const sk_body *body, uint32_t rows, uint32_t columns,
                                 uint32_t count, const uint32_t *place, skein_error *error);
/* Says in which order the body's particles should lie in memory: rank[i] is the place of its i-th one. */
void sk_world_rank_particles(skein_world *world, const sk_body *body, const uint32_t *rank, size_t count);
/* Sweeps the body's newest batch by halves, forth and back (methods/plan_builder.h). */
void sk_world_sweep_both_ways(sk_body *body);
/* Makes the body's newest batch a bound and nothing else (constraints/constraint.h). */
void sk_world_only_bound(sk_body *body, const double *bound);
/* Makes it one on the distances of a coarse grid (constraints/coarse.h); false when there is no memory. */
bool sk_world_bound_coarse(skein_world *world, sk_body *body, const double *bound, const sk_coarse *coarse);
/* Makes it one on the distances of hubs, whose aggregate it owns from then on (constraints/aggregate.h). */
void sk_world_bound_aggregate(sk_body *body, const double *bound, sk_aggregate *aggregate);
/* Lets position methods take the body's newest batch in every second substep, where it is soft for that: `quickness` is as
 * in constraints/constraint.h. */
void sk_world_take_seldom(sk_body *body, double quickness);
/* Notes of all batches with a strain bound whether anything is stretched by more than half of it, and of a sheet's edges without one
 * whether they are to be swept more (strained.c). */
void sk_world_note_strained(skein_world *world, double dt);
/* Keeps the edges of the body's newest batch under its strain bound. */
void sk_world_add_strain_limit(sk_body *body);
/* These edges are a sheet's, which its tethers keep firm: see sk_batch.tether. */
void sk_world_keep_firm(sk_body *body);
skein_status sk_world_add_triangles(skein_world *world, size_t count, const uint32_t (*corners)[3], skein_error *error);
void sk_world_log(skein_world *world, skein_log_level level, const char *format, ...) SK_PRINTF(3, 4);

/* ---- between the world's own files ---- */

/* The object of a handle; NULL for a stale one, one of another world, and the method's. */
sk_object *sk_object_of(const skein_world *world, skein_handle handle);
/* The same, of one category (SKEIN_CATEGORY_COUNT: of any); where it is NULL the world's error says why. */
sk_object *sk_object_find(const skein_world *world, skein_handle handle, skein_category category);
/* Says what is wrong with a handle that should be of `what`, and returns SKEIN_ERROR_HANDLE. */
skein_status sk_fail_handle(const skein_world *world, skein_handle handle, const char *what, const char *where);
/* The handle of the object at a place of the list. */
skein_handle sk_handle_at(const skein_world *world, size_t index);
/* A number of its kind's fields; 0 where it has none of that name. */
double sk_object_number(const sk_object *object, const char *name);
/* Releases an object's parameters and itself. */
void sk_object_release(sk_allocator *allocator, sk_object *object);
/* Fields that objects of a category share, and where they are stored. */
const skein_field *sk_common_fields(skein_category category, size_t *count);
void *sk_common_of(sk_object *object);
/* Defaults, then what presets stand for (NULL: there are none), then settings, each checked. On failure nothing is left
 * in `params`. */
skein_status sk_settings_apply(sk_allocator *allocator, const skein_kind *kind, const sk_presets *presets, void *params,
                               const skein_field *common, size_t common_count, void *common_params,
                               const skein_setting *settings, skein_error *error);
const skein_field *sk_kind_field(const skein_kind *kind, const char *name, skein_error *error);
void sk_body_release(skein_world *world, sk_body *body);
/* ---- tethers to what is pinned later (world/tethers.c) ---- */
/* Notes whom a body is built to be tethered to. False when there is no memory. */
bool sk_world_note_built_pins(skein_world *world, sk_body *body, bool tethered);
/* Releases a body's tethers, or those of them that are `late`. */
void sk_world_remove_tethers(skein_world *world, const sk_body *body, bool late_alone);
/* Makes tethers to who is pinned now and was not as its body was built. */
skein_status sk_world_tether_pins(skein_world *world, skein_error *error);
/* ---- bodies that come and go (world/presence.c) ---- */
/* Takes a body out, or back in: what it is made of stays. */
skein_status sk_world_enable_body(skein_world *world, sk_body *body, bool enabled);
/* Releases all that a body has added, and itself; its particles are gone. */
skein_status sk_world_remove_body(skein_world *world, sk_body *body, const char *name, const char *groups);
/* Gives the newest body the indices of particles that are gone, if it fits in, before anybody has seen its own: all
 * that it added from these marks on. */
void sk_world_reuse_indices(skein_world *world, sk_body *body, size_t batches, size_t limits);
/* Leaves out of constraints what is not there. */
skein_status sk_world_settle_presence(skein_world *world, skein_error *error);
/* ---- bodies that sleep (world/sleep.c) ---- */
/* Wakes whom something comes near in the next step of dt, or what was roused. */
skein_status sk_world_wake(skein_world *world, double dt, skein_error *error);
/* After a step: what has been still for long enough falls asleep. */
skein_status sk_world_let_sleep(skein_world *world, double dt, skein_error *error);
/* A rule was changed, or particles are going to be, by hand: all that sleeps, or the bodies that have some of these, with all that
 * they may touch where they are and where they will be, wake before the next step, and rest begins anew. */
void sk_world_rouse(skein_world *world);
void sk_world_rouse_at(skein_world *world, size_t first, size_t count);
void sk_world_wake_all(skein_world *world);
/* The body sleeps from now on, or wakes. */
void sk_body_set_asleep(skein_world *world, sk_body *body, bool asleep);
/* What is known of its rest is known no longer; where it sleeps, somebody else says where its particles are. */
void sk_body_forget_rest(skein_world *world, sk_body *body);
/* ---- whom rules act on (world/whom.c) ---- */
/* Finds the bodies that rules name; an unknown name is an error. The slots are up to date. */
skein_status sk_world_find_whom(skein_world *world, skein_error *error);
/* Whether a body or a group is called so, or was. */
bool sk_world_knows(const skein_world *world, sk_word name);
/* Whether any body is in a group of that name. */
bool sk_world_has_group(const skein_world *world, sk_word name);
/* Fails where nobody is called so, or was; and the same of each name of a list. */
skein_status sk_world_check_name(const skein_world *world, const char *label, sk_word name, skein_error *error);
skein_status sk_world_check_names(const skein_world *world, const char *label, const char *names, skein_error *error);
/* The next body, enabled or not, that a list means, by its name or a group's, from *cursor = 0 on; NULL at the end. */
const sk_body *sk_world_next_named(const skein_world *world, const char *names, size_t *cursor);
/* Whether a body is there, and all pinned. */
bool sk_world_stands(const skein_world *world, const sk_body *body);
/* Lists those that sleep, and what is all pinned, of the bodies that names mean; false when there is no memory. */
bool sk_world_list_sleepers(skein_world *world, const char *names, sk_only *only);
/* Shows what can meet to the rules that meet. Whom they act on is found. */
skein_status sk_world_prepare_meetings(skein_world *world, skein_error *error);
/* Rules that meet may find what has not been led apart by them yet (sk_easing): of a body or of all, or where a field was set. */
void sk_world_ease_meetings(skein_world *world, const sk_body *body);
void sk_world_ease_changed(skein_world *world, const sk_object *object, const char *field);
/* How many edges go through triangles that they are not to pass. */
skein_status sk_world_count_crossings(skein_world *world, size_t *count, skein_error *error);
/* Warns of contact that gave up in a step, once for each rule. */
void sk_world_tell_of_meetings(skein_world *world);
/* Before a force is released: what it keeps. */
void sk_world_end_meeting(skein_world *world, sk_force *force);
/* The next run of particles that take part and that a rule `on` these bodies acts on, from *cursor = 0 on: in the order
 * of particles where it acts on all, else body by body. False at the end. */
bool sk_world_next_run(const skein_world *world, const char *on, size_t *cursor, size_t *first, size_t *end);
/* Keeps those names of a list that rules name: nobody may be called so from now on. */
skein_status sk_world_remember_names(skein_world *world, const char *names);
void sk_world_forget_names(skein_world *world);
/* Finds the particles' slots and cuts batches into sweeps, if anything was added. */
skein_status sk_world_arrange(skein_world *world, skein_error *error);
/* Lets what is compiled run for all objects whose formula it is. */
void sk_world_run_compiled(skein_world *world);
/* Brings the plan up to date for a step of dt. */
skein_status sk_world_compile(skein_world *world, double dt, skein_error *error);
/* Whether [first, first + count) are particles. */
skein_status sk_world_check_range(const skein_world *world, size_t first, size_t count);
/* Before the state is read: what a device is ahead comes back. It changes no state, only where it stands; a failure
 * is in the world's error, and the state is then the last one that came back. */
skein_status sk_world_fetch(const skein_world *world);
/* Before the state is changed by hand: the same, and the device is behind. */
skein_status sk_world_touch(skein_world *world);
/* Whether a track is good for a motion of the type; makes one (NULL: no memory); releases it. */
skein_status sk_world_check_track(const skein_world *world, const sk_motion_type *type, const skein_track *track);
sk_motion *sk_motion_create(sk_allocator *allocator, const sk_motion_type *type, const skein_track *track);
void sk_motion_release(sk_motion *motion, sk_allocator *allocator);
/* Whether there is the body that a motion is `on`, and the pins in it that it names. */
skein_status sk_world_check_motion(skein_world *world, const sk_motion *motion, skein_error *error);
/* Finds whom motions lead, if anything has changed. */
skein_status sk_world_find_pins(skein_world *world, skein_error *error);
/* Those who are to sit on colliders find their seats now, before these are changed: they sit where all was built. */
void sk_world_seat_all(skein_world *world);
/* Before a step: what lives in moving frames is carried along, and colliders that go with them are on their way. */
skein_status sk_world_carry(skein_world *world, double dt, skein_error *error);
/* Whether a motion carries a body along, or holds it near its places. */
bool sk_world_carries(const skein_world *world, const sk_common *body);
/* Where motions will have led what goes with them when a step of dt is over: first for all, then of a collider, by its name. False
 * when there is no memory. */
bool sk_world_look_ahead(skein_world *world, double dt);
sk_frame sk_world_frame_ahead(const skein_world *world, const char *collider);
/* After it: positions before the step are where they were before that. */
void sk_world_uncarry_previous(skein_world *world);
/* Where time, fields or motions have changed: colliders stand where their frames put them. False: no memory. */
bool sk_world_place_colliders(skein_world *world);
/* Whether a motion holds what is free near its places. */
bool sk_motion_is_leash(const sk_motion *motion);
/* Whether motions hold what is free near its places; and before a step, where (world/leashes.c). */
bool sk_world_has_leashes(const skein_world *world);
skein_status sk_world_set_leashes(skein_world *world, double dt, skein_error *error);
/* Lists what is to be led to its place at `time`. False when there is no memory. */
bool sk_world_lead(skein_world *world, double time);
/* As many substeps as a step of `dt` is to have where pins are led fast in contact; else as many as usual (world/finer.c). False when there
 * is no memory. */
bool sk_world_find_finer(skein_world *world, double dt, int usual, int *substeps);
/* Before a step of `dt` runs: all that is led is on its way, and whoever follows what moves is told (world/pins.c). */
skein_status sk_world_set_out(skein_world *world, double dt, skein_error *error);
/* After it: what was led has arrived, and rests. Where the step failed it has not moved, and its places still wait. */
skein_status sk_world_arrive(skein_world *world, bool done);
/* Changes where steps are computed; NULL is the processor. The former device is released. On failure nothing changes,
 * and the caller keeps the new one. */
skein_status sk_world_set_device(skein_world *world, sk_device *device);
/* Whether all that the plan does can be done where the world has a part of a run. */
skein_status sk_world_check_share(skein_world *world, skein_error *error);
/* The run context of the world's present state. */
sk_run sk_world_run_context(skein_world *world);
/* After a step: moves particles to slots near their neighbours', every so often (world/reorder.c). */
void sk_world_reorder(skein_world *world);
/* What skein_stable_substep says, of a known type. */
double sk_stable_substep(const sk_method_type *method, const skein_stability *stability);
/* Fills in the kinetic, potential and elastic energies, and the momenta. The slots are to be up to date. */
void sk_world_measure_energy(const skein_world *world, skein_statistics *statistics);
double sk_seconds(void); /* of a clock that only goes forward */
/* Runs ops in their order; the plan's are a whole step. Where the run has `seconds`, by the clock and one by one, else
 * as fast as it can be. */
void sk_run_ops(sk_run *run, sk_tasks *tasks, const sk_op *ops, size_t count);

#endif
