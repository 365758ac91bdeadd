/* Forces: what pushes particles besides constraints and contact. Each type is one file.
 *
 * A force's kernel adds newtons to F over its domain: particles (slots), triangles of the bodies'
 * surfaces (particles/surface.h), or particles with their neighbours in the grid. */
#ifndef SK_FORCES_FORCE_H
#define SK_FORCES_FORCE_H

#include "base/fields.h"
#include "formula/parameters.h"
#include "particles/particles.h"
#include "plan/op.h"
#include "plan/shader.h"

typedef enum sk_domain { SK_OVER_PARTICLES, SK_OVER_TRIANGLES, SK_OVER_NEIGHBOURS, SK_OVER_COLLIDERS } sk_domain;

/* What a rule's kernel writes, and when.
 *   pushes   adds newtons to F, in every stage of a method
 *   steers   adds a change of velocity to S, once a substep, with the op's dt: all of these read the same state
 *   bounds   puts V right once all have steered, and may add to S what later ones are to know; in the order of making
 *   meets    surfaces meet surfaces: it has ops of its own in every substep (sk_meeting)
 */
typedef enum sk_phase { SK_PUSHES, SK_STEERS, SK_BOUNDS, SK_MEETS } sk_phase;

/* A body's particles, and its name. */
typedef struct sk_meeting_body {
    size_t first, end;
    const char *name;
} sk_meeting_body;

/* What can meet: triangles, and edges that are in none, of all bodies, by the user's indices of their particles. */
typedef struct sk_meeting_parts {
    const uint32_t (*triangle)[3], (*edge)[2];
    const sk_meeting_body *body;
    size_t triangle_count, edge_count, body_count;
    uint64_t arrangement; /* another number where any of it, or who takes part, may have changed */
    size_t rule_count;    /* how many rules are shown them */
} sk_meeting_parts;

typedef struct sk_force sk_force;

/* How a rule meets: ops that are run in every substep of any method, with the force as their rule.
 *   begin   before all else: X is where the substep starts
 *   push    with the limits: moves X, and V by as much where its second source is V
 *   bound   last of all: no vertex goes where it would have passed a surface; V is told
 * They do not declare what they reach, and one thread runs them. */
typedef struct sk_meeting {
    sk_kernels begin, push, bound;
    /* Makes what the ops keep (state of the force), if it is not there or not of these parts. False: no memory. */
    bool (*prepare)(sk_force *force, sk_allocator *allocator, const sk_particles *particles,
                    const sk_meeting_parts *parts, sk_isa isa);
    void (*release)(sk_force *force, sk_allocator *allocator);
    /* How many edges go through a triangle, of the places x of slots. False: no memory. */
    bool (*crossings)(sk_force *force, sk_allocator *allocator, const sk_vec4 *x, const uint32_t *slot_of, size_t *count);
    /* The pairs of features that are no farther apart than their thickness: up to `most` go to `out`, whose rules are the
     * caller's to fill in; `count` is how many there are. False: no memory. */
    bool (*touching)(sk_force *force, sk_allocator *allocator, const sk_vec4 *x, const uint32_t *slot_of,
                     skein_surface_contact *out, size_t most, size_t *count);
    /* Pairs of bodies' names that do not meet, "cape:shirt, cape:cape"; "": none. */
    const char *(*ignored)(const void *params);
    /* Whether there was so much to meet in some substep that it let all of it be. True once: what the world tells. */
    bool (*gave_up)(sk_force *force);
} sk_meeting;

typedef struct sk_force_type {
    skein_kind kind;
    sk_domain domain;
    sk_phase phase;
    bool passive;     /* it takes energy, as the drag of still air does, and never gives any */
    bool once;        /* what it bounds is bounded between kick and drift only, and not at the end of a substep */
    bool sets;        /* its kernel minds the op's `sets`: it can be the first to write F */
    bool on_velocity; /* it depends on velocities, */
    bool (*uses_velocity)(const void *params); /* or does so with these parameters; NULL: what on_velocity says */
    sk_kernels kernel;
    /* Over triangles: the same for those of a patch, whose elements are the strip rows of cells, [0, rows - 1): that of
     * row r adds to F of strip rows r and r + 1. `kernel` has the rest. */
    sk_kernels over_patch;
    /* Of a force that is the same everywhere: what it is at a velocity. NULL: it is not. */
    void (*at_velocity)(const void *params, const double v[3], double mass, double force[3]);
    /* For implicit methods, with the op's coefficient a: dst += a d, where -d is how the force grows with the
     * particle's own velocity; the same in x, y and z. NULL: it does not, or too little to matter. */
    sk_kernels resistance;
    /* Neighbour rules: how far they reach, m; NULL else. */
    double (*radius)(const void *params);
    /* The same where a force depends on place, over slots, with coefficients a and b: dst += (a k + b c) p for the
     * direction p, its second source, where -k and -c, positive definite, are about how the force grows with the
     * particle's own position and velocity; and that matrix's 3 x 3 blocks, xx yy zz into dst, xy xz yz into its second
     * source. As constraints have them; NULL: none. */
    sk_kernels apply, diagonal;
    /* The potential energy of a particle at x; NULL: it has none. */
    double (*potential)(const void *params, const double x[3], double mass, double time);
    /* Whether a value had to be guarded (formula/graph.h): for the statistics; NULL: there is nothing to guard. */
    bool (*guarded)(const void *params, const double x[3], const double v[3], double time);
    /* Of a field that a formula gives: the force on 1 kg, or on a particle where mass does not count, that rests at x.
     * False where there is no memory. NULL: it is no such field. */
    bool (*at)(const void *params, const double x[3], double time, double force[3]);
    const sk_making *making; /* what is made from its texts; NULL: nothing */
    /* Over particles, of a rule that looks where one of them is: which; that one it does not move. -1, or NULL: none.
     * On a card its position is in the first three numbers of the block. */
    int32_t (*particle)(const void *params);
    /* What a rule that steers or bounds says about the parameters together, before a plan is written; NULL: nothing. */
    skein_status (*check)(const void *params, size_t particle_count, skein_error *error);
    /* The name of the body that it looks at; "", or NULL: those that it acts on. */
    const char *(*neighbours)(const void *params);
    /* Of arithmetic (base/arithmetic.h) whose names begin with KIND_: what each_particle.h says for a kind that pushes
     * (KIND_force), steers (KIND_steer) or bounds (KIND_bound), or moves particles (vec3 KIND_shift(params, vec3 x));
     * over neighbours what each adds, vec3 KIND_push(params, vec3 apart, num distance).
     * A .glsl file over particles defines, for a rule that pushes, steers (w: how much more speed is allowed) or bounds
     * (`steering` is what has been added to v in this substep):
     *     vec3 force@(vec3 x, vec3 v, float mass),   vec4 steer@(vec3 x, float dt),
     *     vec3 bound@(vec4 x, vec3 v, vec4 steering, float dt)   or, where it moves particles, vec3 shift@(vec3 x),
     * and over neighbours a sum of its own type, what each neighbour adds, and the newtons or metres a second that
     * come of it:
     *     sum@ start@(vec3 heading),   void meet@(inout sum@ sum, vec3 apart, float square, vec3 direction),
     *     vec3 finish@(sum@ sum, float dt)
     * where `apart` leads from the neighbour here, `square` is its squared length (less than that of the radius, and
     * 0 in one place), and `direction` is the neighbour's unit direction of flight, as `heading` is the particle's own.
     * Where it defines MOST@, a number, it meets so many at the most: the nearest of those whom
     *     bool sees@(sum@ sum, vec3 apart, float square)
     * is true of. */
    sk_shader shader;
    const sk_meeting *meeting; /* of a rule that meets */
    /* Over colliders: the time ahead (s), the clearance (m) and the strength (m/s2) of steering clear. */
    void (*look)(const void *params, double look[3]);
} sk_force_type;

/* A force as methods see it: a type with its parameters. An op's rule is one of these. */
struct sk_force {
    const sk_force_type *type;
    const void *params;
    const char *label;
    const bool *enabled;
    char *const *on;      /* the names of the bodies that it acts on; "": every particle */
    sk_only only;         /* those, found when a plan is written; */
    sk_group moved, seen; /* and of a rule that steers or bounds, whom it moves and looks at */
    void *state;          /* of a rule that meets: what its ops keep */
};

bool sk_force_on_velocity(const sk_force *force);
/* The particle that it looks at, or -1. */
int32_t sk_force_particle(const sk_force *force);
/* Adds the force to the sum if with its parameters it is m g + f - (linear + rate m) v, else returns false. */
bool sk_force_add_uniform(const sk_force *force, sk_uniform_force *sum);

#endif
