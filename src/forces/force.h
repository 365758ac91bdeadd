/* Forces: rules that act on particles besides constraints and contact. Each type is one file.
 *
 * A force's kernel adds newtons to F over its domain: particles (slots), triangles of the bodies'
 * surfaces (particles/surface.h), or particles with their neighbours in the grid. */
#ifndef SK_FORCES_FORCE_H
#define SK_FORCES_FORCE_H

#include <math.h>

#include "base/fields.h"
#include "formula/parameters.h"
#include "particles/particles.h"
#include "plan/op.h"
#include "plan/shader.h"

typedef enum sk_domain { SK_OVER_PARTICLES, SK_OVER_TRIANGLES, SK_OVER_NEIGHBOURS, SK_OVER_COLLIDERS } sk_domain;

/* What a rule's kernel writes, and when.
 *   pushes   adds newtons to F, in every stage of a method
 *   steers   adds a change of velocity to S, once a substep, with the op's dt: all of these read the same state
 *   bounds   limits V after all have steered, in the order in which rules were made; may add to S for later ones
 *   meets    contact between surfaces: it has ops of its own in every substep (sk_meeting) */
typedef enum sk_phase { SK_PUSHES, SK_STEERS, SK_BOUNDS, SK_MEETS } sk_phase;

/* A body's particles, and what it is called (base/names.h). */
typedef struct sk_meeting_body {
    size_t first, end;
    const char *name, *groups;
    double thickness, friction; /* its own, which count instead of the rule's where the thickness is over 0 */
} sk_meeting_body;

/* What can be in contact between surfaces: triangles of all bodies, and edges that are in none, by user's indices. */
typedef struct sk_meeting_parts {
    const uint32_t (*triangle)[3], (*edge)[2];
    const sk_meeting_body *body;
    size_t triangle_count, edge_count, body_count;
    uint64_t arrangement; /* changes whenever any of this, or which particles take part, may have changed */
    size_t rule_count;    /* how many rules use these parts */
    struct sk_collider *const *collider;
    size_t collider_count;
} sk_meeting_parts;

typedef struct sk_force sk_force;

/* Contact between surfaces: ops that run in every substep of any method, with the force as their rule.
 *   begin   first: X is the start of the substep
 *   hold    where an implicit solve ends, in its parts: stops vertices as the bound does, and takes those out of the
 *           solve's filter S, so that it goes on with the others
 *   push    with the limits: moves X, and changes V to match if its second source is V
 *   lead    instead of a push, where a solve has pressed apart what is near: leads apart what is through each other
 *   faces   before a push, and while limits are swept: moves X so that colliders hold what lies between particles, too, and changes V as a
 *           push does; with a coefficient of 1 it finds what that is, else it is what it was in the last substep
 *   bound   last: stops vertices before they would pass a surface, and changes V to match
 * They do not declare which slots they reach, and run on one thread. An implicit solve has these besides:
 *   near             finds what presses each other in it, as X is when the substep begins
 *   press            adds the forces to F
 *   diagonal, apply  their part of the matrix, as of forces that depend on place (sk_force_type); the products are those
 *                    of the matrix whose diagonal was asked for last */
typedef struct sk_meeting {
    sk_kernels begin, hold, push, push_on, lead, bound, faces;
    sk_kernels near, press, diagonal, apply;
    /* Makes the force's `state` for the ops, if there is none for these parts. False: no memory. */
    bool (*prepare)(sk_force *force, sk_allocator *allocator, const sk_particles *particles,
                    const sk_meeting_parts *parts, sk_isa isa);
    void (*release)(sk_force *force, sk_allocator *allocator);
    /* Counts the edges that pass through a triangle at the positions x, by slots. False: no memory. */
    bool (*crossings)(sk_force *force, sk_allocator *allocator, const sk_vec4 *x, const uint32_t *slot_of,
                      size_t *count);
    /* Finds the pairs of features no farther apart than their thickness: writes up to `most` to `out`, in which the
     * caller fills in the rules, and their number to `count`. False: no memory. */
    bool (*touching)(sk_force *force, sk_allocator *allocator, const sk_vec4 *x, const uint32_t *slot_of,
                     skein_surface_contact *out, size_t most, size_t *count);
    /* Pairs of bodies' names that do not meet, "cape:shirt, cape:cape"; "": none. */
    const char *(*ignored)(const void *params);
    /* Whether such pairs are written as they should be. */
    skein_status (*check)(const void *params, skein_error *error);
    /* How often there were too many pairs, so that it skipped all, since it was last asked; `first` where it had never been. */
    uint64_t (*gave_up)(sk_force *force, bool *first);
    /* A body that is too thick for its edges, as they were built, in the mean: both in m. NULL: none, or it was told of. */
    const sk_meeting_body *(*crowded)(sk_force *force, sk_allocator *allocator, const sk_meeting_parts *parts,
                                      double *edge, double *thickness);
} sk_meeting;

typedef struct sk_force_type {
    skein_kind kind;
    sk_domain domain;
    sk_phase phase;
    bool passive;     /* it never adds energy: the drag of still air, for example */
    bool once;        /* it bounds velocities between kick and drift only, not at the end of a substep */
    bool sets;        /* its kernel supports the op's `sets`: it can be the first to write F */
    bool on_velocity; /* it depends on velocities, */
    bool (*uses_velocity)(const void *params); /* or does so with these parameters; NULL: always as on_velocity */
    sk_kernels kernel;
    /* Over triangles: the kernel for those of a patch, whose elements are the strip rows of cells, [0, rows - 1): row r
     * adds to F of strip rows r and r + 1. `kernel` is for the rest. */
    sk_kernels over_patch;
    /* For a force that is the same everywhere: its value at a velocity. NULL: it is not such a force. */
    void (*at_velocity)(const void *params, const double v[3], double mass, double force[3]);
    /* For implicit methods, with the op's coefficient a: dst += a d, where -d is the derivative of the force by the
     * particle's own velocity, the same in x, y and z. NULL: it is 0, or too small to matter. */
    sk_kernels resistance;
    /* Neighbour rules: their reach, m; NULL for others. */
    double (*radius)(const void *params);
    /* The same for a force that depends on place, over slots, with coefficients a and b: dst += (a k + b c) p for the
     * direction p, the second source, where k and c, positive definite, approximate minus the derivatives of the force
     * by the particle's own position and velocity; and that matrix's 3 x 3 blocks, xx yy zz into dst, xy xz yz into the
     * second source. As for constraints; NULL: none. */
    sk_kernels apply, diagonal;
    /* The potential energy of a particle at x; NULL: it has none. */
    double (*potential)(const void *params, const double x[3], double mass, double time);
    /* Whether a value had to be guarded (formula/graph.h): for the statistics; NULL: there is nothing to guard. */
    bool (*guarded)(const void *params, const double x[3], const double v[3], double time);
    /* For a field given by a formula: the force on 1 kg, or on a particle if mass does not matter, at rest at x. False
     * without memory. NULL: it is not such a field. */
    bool (*at)(const void *params, const double x[3], double time, double force[3]);
    const sk_making *making; /* what is made from its texts; NULL: nothing */
    /* For a rule over particles that is placed at one of them: that particle, which it does not move. -1, or NULL:
     * none. On a card its position is in the first three numbers of the block. */
    int32_t (*particle)(const void *params);
    /* Checks the parameters of a rule that steers or bounds, before a plan is written; NULL: no check. */
    skein_status (*check)(const void *params, size_t particle_count, skein_error *error);
    /* The name of the body whose particles are its neighbours; "", or NULL: the particles that it acts on. */
    const char *(*neighbours)(const void *params);
    /* Marked arithmetic (base/arithmetic.h), with names that begin with KIND_, has the function that each_particle.h
     * describes for a kind that pushes (KIND_force), steers (KIND_steer) or bounds (KIND_bound), or moves particles
     * (vec3 KIND_shift(params, vec3 x)); over neighbours the force of each, vec3 KIND_push(params, vec3 apart, num
     * distance). A .glsl file over particles defines, for a rule that pushes, steers (w: how much more speed is
     * allowed) or bounds (`steering` has been added to v in this substep):
     *     vec3 force@(vec3 x, vec3 v, float mass),   vec4 steer@(vec3 x, float dt),
     *     vec3 bound@(vec4 x, vec3 v, vec4 steering, float dt)   or, where it moves particles, vec3 shift@(vec3 x),
     * and over neighbours a type `sum@`, its start, the addition of a neighbour, and the newtons or metres a second
     * that result:
     *     sum@ start@(vec3 heading),   void meet@(inout sum@ sum, vec3 apart, float square, vec3 direction),
     *     vec3 finish@(sum@ sum, float dt)
     * where `apart` leads from the neighbour to the particle, `square` is its squared length (less than the radius
     * squared; 0 in the same place), `direction` is the neighbour's unit direction of flight and `heading` the
     * particle's. If it defines MOST@, a number, at most that many neighbours are met: the nearest of those for which
     *     bool sees@(sum@ sum, vec3 apart, float square)
     * is true. */
    sk_shader shader;
    const sk_meeting *meeting; /* of a rule of contact between surfaces */
    /* Over colliders: the time ahead (s), the clearance (m) and the strength (m/s2) of avoidance. */
    void (*look)(const void *params, double look[3]);
} sk_force_type;

/* Of a rule that meets: by how much nearer surfaces may be at first, and since when, where they are nearer than their thickness without
 * having come so by themselves: when a world begins, a body joins it, the rule is enabled or a thickness raised. They are led apart, the
 * slower the less is left of it: by a speed that falls by a hundredth of what gravity takes, so that nothing is thrown, and piles of
 * dozens of layers stay together. */
typedef struct sk_easing {
    double less, since; /* m, s */
    uint32_t asks,
        asks_end; /* particles from which to which it is still to be found out how much is missing: none, if none */
} sk_easing;
/* How much of it is left at a time, m. */
static inline double sk_easing_left(const sk_easing *easing, double time) {
    const double slowing = 0.1; // m/s2
    const double root = sqrt(easing->less) - sqrt(0.5 * slowing) * fmax(0, time - easing->since);
    return root > 0 ? root * root : 0;
}

/* A force as methods see it: a type with its parameters. An op's rule is one of these. */
struct sk_force {
    const sk_force_type *type;
    const void *params;
    const char *label;
    const bool *enabled;
    char *const *on;      /* the names of the bodies that it acts on; "": every particle */
    sk_only only;         /* those bodies, found when a plan is written */
    sk_group moved, seen; /* of a rule that steers or bounds: the particles that it moves and that it reads */
    void *state;          /* of a rule of contact between surfaces: what its ops keep */
    sk_easing easing;     /* of the same */
};

bool sk_force_on_velocity(const sk_force *force);
/* The particle that it is placed at, or -1. */
int32_t sk_force_particle(const sk_force *force);
/* Adds the force to the sum if, with its parameters, it is m g + f - (linear + rate m) v; else returns false. */
bool sk_force_add_uniform(const sk_force *force, sk_uniform_force *sum);

#endif
