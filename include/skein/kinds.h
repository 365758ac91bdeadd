/* Kinds of a program's own: forces, constraints, colliders, bodies, motions and methods beside those of the library, with
 * the same tables of fields. They are listed, set by name, checked, drawn and stepped as the library's are.
 *
 *     skein_kinds *kinds = skein_kinds_create(NULL);
 *     skein_kind_register(kinds, &updraught.kind, &error);       // a skein_force_type, say
 *     skein_world_desc desc = skein_default_world_desc();
 *     desc.kinds = kinds;
 *     skein_world *world = skein_world_create(&desc, &error);
 *     skein_force_add(world, "updraught", SKEIN_SETTINGS(SKEIN_REAL("lift", 9)), NULL);
 *
 * A registry belongs to the program, not to the library, which has no global state: worlds are given it, and two parts
 * of a program may have one each. What is registered (types, tables, texts) is not copied; it, and the registry, must
 * outlive the worlds. Only one thread may register, before others use the registry.
 *
 * A kind says its arithmetic in one of two ways:
 *   formula   a text (docs/formula.md) in which its fields stand by their names. It is differentiated, runs wide, under
 *             implicit methods and on graphics cards, and says its energy. Its fields are SKEIN_FIELD_REAL.
 *   function  C, called from the step's threads at once, so it reads and writes nothing but its arguments. Graphics cards
 *             refuse it with a message, and the step fails, unless steps are on the processor. */
#ifndef SKEIN_KINDS_H
#define SKEIN_KINDS_H

#include <skein/skein.h>

#ifdef __cplusplus
extern "C" {
#endif
#if defined(__GNUC__)
#pragma GCC visibility push(default)
#endif

/* ---- Registries ---- */

/* An empty registry; NULL with SKEIN_ERROR_MEMORY. The caller destroys it, after the worlds that have it. */
skein_kinds *skein_kinds_create(skein_error *error);
void skein_kinds_destroy(skein_kinds *kinds); /* NULL is allowed */

/* Registers the type that begins with this kind: one of the types below, by the kind's category. Everything is checked,
 * formulas too. Fails with SKEIN_ERROR_NAME where there is a kind of that name already, or a field is named twice,
 * SKEIN_ERROR_SYNTAX of a formula, SKEIN_ERROR_LIMIT and SKEIN_ERROR_MEMORY. */
skein_status skein_kind_register(skein_kinds *kinds, const skein_kind *kind, skein_error *error);

/* As skein_kind_at() and skein_kind_find(), the registry's kinds after the library's. `kinds` may be NULL. What they
 * return is the kind as objects have it, not the address that was registered. */
const skein_kind *skein_kinds_at(const skein_kinds *kinds, skein_category category, size_t index);
const skein_kind *skein_kinds_find(const skein_kinds *kinds, skein_category category, const char *name,
                                   skein_error *error);

/* ---- Tables of fields ---- */

/* Rows of a table: of a kind by functions, whose values are in the struct `s_`; and of a formula's kind, where the library
 * finds the place. A REAL is a double there, an INT an int32_t, a BOOL a bool, a VEC3 double[3], a TEXT a char *. */
// clang-format off
#define SKEIN_FIELD_OF_REAL(s_, member_, name_, unit_, initial_, least_, most_, help_)                        \
    {name_, SKEIN_FIELD_REAL, offsetof(s_, member_), unit_, {initial_, 0, 0}, least_, most_, NULL, NULL, help_}
#define SKEIN_FIELD_OF_VEC3(s_, member_, name_, unit_, x_, y_, z_, help_)                                     \
    {name_, SKEIN_FIELD_VEC3, offsetof(s_, member_), unit_, {x_, y_, z_}, -1e15, 1e15, NULL, NULL, help_}
#define SKEIN_FIELD_OF_INT(s_, member_, name_, unit_, initial_, least_, most_, help_)                         \
    {name_, SKEIN_FIELD_INT, offsetof(s_, member_), unit_, {initial_, 0, 0}, least_, most_, NULL, NULL, help_}
#define SKEIN_FIELD_OF_BOOL(s_, member_, name_, initial_, help_)                                              \
    {name_, SKEIN_FIELD_BOOL, offsetof(s_, member_), "", {initial_, 0, 0}, 0, 1, NULL, NULL, help_}
#define SKEIN_FIELD_OF_TEXT(s_, member_, name_, initial_, help_)                                              \
    {name_, SKEIN_FIELD_TEXT, offsetof(s_, member_), "", {0, 0, 0}, 0, 0, NULL, initial_, help_}
#define SKEIN_FIELD_OF_FORMULA(name_, unit_, initial_, least_, most_, help_)                                  \
    {name_, SKEIN_FIELD_REAL, 0, unit_, {initial_, 0, 0}, least_, most_, NULL, NULL, help_}
// clang-format on

/* ---- Forces ---- */

/* Particles side by side, for compilers to make vectors of: number k of axis a is x[a][k]. Some places may be empty: their
 * mass is 0, and what is said for them is dropped. */
enum { SKEIN_LANES = 16 };
typedef struct skein_lanes {
    skein_real x[3][SKEIN_LANES], v[3][SKEIN_LANES]; /* m, m/s */
    skein_real mass[SKEIN_LANES];                    /* kg */
} skein_lanes;

typedef struct skein_force_type {
    skein_kind kind;       /* of SKEIN_FORCE */
    const char *formula;   /* a vector of p, v and t, or NULL: the functions below */
    const char *potential; /* instead: an energy of p and t, of 1 kg or of a particle, whose gradient pulls */
    bool per_particle;     /* of a formula: it is N or J of each particle; else m/s2, or J/kg */
    bool on_velocity;      /* of functions: the force depends on v */
    /* Writes the force on each particle, N; `time` in s. */
    void (*force)(const void *params, double time, const skein_lanes *particles, skein_real force[3][SKEIN_LANES]);
    /* The potential energy of a particle, J; NULL: it has none. */
    double (*energy)(const void *params, double time, const double x[3], double mass);
} skein_force_type;

/* ---- Constraints ---- */

/* By a formula of p0 to p7, which wants to be 0 or, written `a >= b`, at least 0; or by an energy, J. Besides its own
 * fields such a kind has those of `formula` ("stiffness", "damping") or `energy` ("scale"), with their defaults. */
typedef struct skein_constraint_type {
    skein_kind kind;              /* of SKEIN_CONSTRAINT */
    const char *formula, *energy; /* one of both */
} skein_constraint_type;

/* ---- Colliders ---- */

typedef struct skein_collider_type {
    skein_kind kind; /* of SKEIN_COLLIDER */
    /* A number of p and t, positive outside of the solid; such a kind also has the fields "centre" and "rotation".
     * NULL: the functions below are used. */
    const char *formula;
    /* Where it stands before any motion, m; NULL: at the origin. What a program moves there travels (skein.h). */
    void (*place)(const void *params, double position[3]);
    /* How far a point p is from the surface, m, negative inside, and its unit normal out of the solid: p is seen from
     * the collider's own place, before it is turned. `time` in s. */
    double (*distance)(const void *params, double time, const double p[3], double normal[3]);
    /* What it looks like, into a shape that is all zero before. NULL: as its distance has it, which is meshed. */
    void (*shape)(const void *params, skein_shape *shape);
} skein_collider_type;

/* ---- Motions ---- */

typedef struct skein_motion_type {
    skein_kind kind; /* of SKEIN_MOTION */
    /* Moves a pin's place, m, `time` s after the motion's start. */
    void (*move)(const void *params, double time, double place[3]);
} skein_motion_type;

/* ---- Bodies ---- */

/* What a body is built with, during its `build`. Each call may fail, with the words in the world's error. */
typedef struct skein_builder skein_builder;

typedef struct skein_body_type {
    skein_kind kind; /* of SKEIN_BODY */
    /* Lays down the body; what it has laid is taken back if it fails. `mesh` is NULL where none was given. */
    skein_status (*build)(skein_builder *builder, const void *params, const skein_mesh *mesh);
    skein_shape_sort shape; /* SKEIN_SHAPE_SURFACE: its faces; or SKEIN_SHAPE_CHAIN, SKEIN_SHAPE_BIRDS */
} skein_body_type;

/* Particles of the body, once and first: as skein_particles_add(). They are its numbers 0, 1 ... below. */
skein_status skein_build_particles(skein_builder *builder, size_t count, const double *positions,
                                   const double *velocities, const double *masses);
/* `count` springs between two of them each, as long as they lie; `stiffness` N/m, `damping` N s/m. They count in the
 * stretch that is measured. `label` is constant. At most 8 calls. */
skein_status skein_build_springs(skein_builder *builder, const char *label, size_t count, const uint32_t *pairs,
                                 double stiffness, double damping);
/* The faces that it is drawn with, and that wind acts on: of 3 of them each. Once. */
skein_status skein_build_triangles(skein_builder *builder, size_t count, const uint32_t *corners);
/* Fails with words, for a `build` to return. */
skein_status skein_build_fail(skein_builder *builder, const char *field, const char *message);

/* ---- Methods ---- */

/* What a method writes its step with: ops of a plan (docs/design.md), not arithmetic. */
typedef struct skein_plan_builder skein_plan_builder;

/* Vectors of all particles. */
typedef enum skein_plan_vector {
    SKEIN_NO_VECTOR,
    SKEIN_X, /* position */
    SKEIN_V, /* velocity */
    SKEIN_F, /* force, N */
    SKEIN_SAVED_X,
    SKEIN_SAVED_V, /* for a method's own use */
    SKEIN_T0,
    SKEIN_T1,
    SKEIN_T2,
    SKEIN_T3
} skein_plan_vector;

typedef struct skein_method_type {
    skein_kind kind; /* of SKEIN_METHOD; the field "substeps", if it has one, an INT, is what steps are counted by */
    /* Writes one step of `dt` seconds. */
    void (*write)(skein_plan_builder *builder, const void *params, double dt);
    bool takes_rigid; /* it projects positions, and can keep what has infinite stiffness; else such a world is refused */
    /* One substep of the oscillator x'' = -x - 2 zeta x' as a matrix on (x, v), by rows, `z` being the substep; it says
     * which substeps are stable. NULL: all are. */
    void (*amplify)(double z, double zeta, double matrix[4]);
} skein_method_type;

/* As skein_stable_substep(), of a method that may be registered here. `kinds` may be NULL. */
double skein_kinds_stable_substep(const skein_kinds *kinds, const char *method, const skein_stability *stability);

/* Opens a repeat of `times` substeps of `h` seconds, that ends with skein_write_end() of what it returns. */
size_t skein_write_repeat(skein_plan_builder *builder, size_t times, double h);
void skein_write_end(skein_plan_builder *builder, size_t repeat);
/* X stands at this part of the substep from here on: 0 its start, 1 its end. */
void skein_write_stage_time(skein_plan_builder *builder, double part);
/* dst = a p + b q; dst = p + a q/m, q being a force. SKEIN_NO_VECTOR is left out. */
void skein_write_sum(skein_plan_builder *builder, skein_plan_vector dst, double a, skein_plan_vector p, double b,
                     skein_plan_vector q);
void skein_write_kick(skein_plan_builder *builder, skein_plan_vector dst, skein_plan_vector p, double a,
                      skein_plan_vector q);
/* F = all forces and those of every constraint, without what contact holds back. */
void skein_write_forces(skein_plan_builder *builder);
/* V += steering, once a substep; then bounds on V, which skein_write_bounds() applies once more. */
void skein_write_steering(skein_plan_builder *builder);
void skein_write_bounds(skein_plan_builder *builder);
/* Projects X on all constraints, `passes` times; SKEIN_SAVED_X holds the positions at the start of the substep. */
void skein_write_projections(skein_plan_builder *builder, int passes);
/* The end of a substep, once X and V are final: impacts, limits, and moving particles out of colliders. */
void skein_write_contacts(skein_plan_builder *builder);

/* ---- Modules ---- */

/* Kinds in a shared object, which the command loads where the environment's SKEIN_KINDS names it (several are separated by
 * colons): its one symbol, a list that ends with NULL. */
extern const skein_kind *const skein_module_kinds[];

#if defined(__GNUC__)
#pragma GCC visibility pop
#endif
#ifdef __cplusplus
}
#endif
#endif
