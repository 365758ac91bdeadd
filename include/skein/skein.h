/* Skein: real-time particle dynamics in plain C.
 *
 * Everything is particles under rules, and a method that turns rules into motion. A world holds
 * particles, rules (constraints, forces, colliders) and one method; bodies are builders that lay
 * down particles and rules. See docs/guide.md for a walk through, examples/ for whole programs.
 *
 * Conventions
 *   Units     SI: metres, kilograms, seconds, newtons. Angles in degrees where a field says so.
 *   Axes      right handed, y up (nothing but the default gravity and "top" depends on it).
 *   Positions are four `skein_real`: x, y, z, inverse mass (1/kg; 0 means the particle is pinned).
 *   Errors    every call that can fail returns a `skein_status`; the words are in skein_world_error(), or in the
 *             `skein_error` that is passed, which may always be NULL. A call that fails changes nothing, unless its
 *             words say so, and what it would have filled in is not to be read. SKEIN_ERROR_VALUE may come from any
 *             call, SKEIN_ERROR_HANDLE from any that takes a handle; which others may is said with each ("fails with").
 *             Where a graphics card steps, calls that look at the state may fail as skein_world_device_set() may.
 *   Pointers  may be NULL where it is said, and an array where its count is 0; `handle` and `settings` of calls that
 * add, too. Elsewhere NULL is an error like any other: SKEIN_ERROR_VALUE with the argument's name; from calls that
 * return no status 0, NULL, false or an empty view. What is passed stays the caller's and is only read during the call,
 * unless it is said. Threads   a world belongs to one thread at a time; different worlds are independent. After fork()
 * a child has none of the world's own threads: it may neither step nor destroy a world that may have more than one
 * (both would wait for ever). Make worlds after the fork, or call exec. Bits      the same input gives the same bits,
 * for any number of threads.
 */
#ifndef SKEIN_H
#define SKEIN_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif
#if defined(__GNUC__)
#pragma GCC visibility push(default) /* what a shared library shows of itself, and nothing else */
#endif

/* The version of this header, which compares as a number; skein_version() is the library's. */
#define SKEIN_VERSION_MAJOR 0
#define SKEIN_VERSION_MINOR 1
#define SKEIN_VERSION_PATCH 0
#define SKEIN_VERSION_NUMBER (1000000 * SKEIN_VERSION_MAJOR + 1000 * SKEIN_VERSION_MINOR + SKEIN_VERSION_PATCH)
#define SKEIN_VERSION "0.1.0"

/* The library computes in float, or in double when built with -DSKEIN_DOUBLE=ON; a program says the same by defining
 * SKEIN_DOUBLE. Where the two differ they do not link: what makes a world and what hands out numbers of this type has a
 * name of its own in each. A binding that looks names up (dlsym) asks for skein_world_create_float, then for
 * skein_world_create_double: the one that is there says how wide numbers in views are. All other names, and all other
 * numbers of this header, are the same in both. */
#ifdef SKEIN_DOUBLE
typedef double skein_real;
#define skein_world_create skein_world_create_double
#define skein_position_view skein_position_view_double
#define skein_velocity_view skein_velocity_view_double
#else
typedef float skein_real;
#define skein_world_create skein_world_create_float
#define skein_position_view skein_position_view_float
#define skein_velocity_view skein_velocity_view_float
#endif

/* ---- Status and errors --------------------------------------------------------------------- */

typedef enum skein_status {
    SKEIN_OK = 0,
    SKEIN_ERROR_MEMORY, /* the allocator returned NULL */
    SKEIN_ERROR_VALUE,  /* a value has the wrong type or is out of range */
    SKEIN_ERROR_NAME,   /* no kind, field or body of that name */
    SKEIN_ERROR_HANDLE, /* the handle is stale, of another world or of another category */
    SKEIN_ERROR_MESH,   /* the mesh cannot be what was asked of it */
    SKEIN_ERROR_FILE,   /* a file cannot be read or written */
    SKEIN_ERROR_SYNTAX, /* a file or text is malformed */
    SKEIN_ERROR_LIMIT   /* more than an index can count; the message names the need */
} skein_status;

/* What went wrong, in words. `where` names the place (a field's path, a file and line) or is "". */
typedef struct skein_error {
    skein_status status;
    char where[256];
    char message[512];
} skein_error;

/* A constant word for a status: "ok", "out of memory", ... */
const char *skein_status_text(skein_status status);

/* The library's SKEIN_VERSION_NUMBER: that of the header it was compiled with. */
int skein_version(void);

/* ---- Values, fields and kinds: every parameter is described once ------------------------------ */

typedef enum skein_field_type {
    SKEIN_FIELD_BOOL,
    SKEIN_FIELD_INT,
    SKEIN_FIELD_INT2, /* two whole numbers, as in a grid's rows and columns */
    SKEIN_FIELD_INT3,
    SKEIN_FIELD_REAL,
    SKEIN_FIELD_REAL2,
    SKEIN_FIELD_VEC3,
    SKEIN_FIELD_CHOICE, /* one word of `choices` */
    SKEIN_FIELD_TEXT
} skein_field_type;

/* One parameter of a kind. Defaults, the scene reader, its messages, `--set`, `skein list` and the
 * reference page all come from tables of these. */
typedef struct skein_field {
    const char *name; /* dots make groups: "stretch.stiffness"; "parameters.*" stands for all that an object's formulas
                         name, "parameters.R", say, which the object's own kind has one by one */
    skein_field_type type;
    size_t offset;       /* of the value in the kind's parameters; internal */
    const char *unit;    /* "N/m"; "" where there is none */
    double initial[3];   /* the default's numbers (a choice: its place in the list) */
    double least, most;  /* the range of every component, inclusive */
    const char *choices; /* "area|uniform|angle", or NULL */
    const char *text;    /* the default of a text field, or NULL */
    const char *help;    /* one line */
} skein_field;

typedef enum skein_category {
    SKEIN_BODY,
    SKEIN_CONSTRAINT,
    SKEIN_FORCE,
    SKEIN_COLLIDER,
    SKEIN_MOTION,
    SKEIN_METHOD,
    SKEIN_SCENE,
    SKEIN_EXPORTER,
    SKEIN_VIEW,
    SKEIN_CATEGORY_COUNT
} skein_category;

/* A kind of body, constraint, force, collider, method or exporter, with its own fields (a scene's and a
 * view's, too). */
typedef struct skein_kind {
    const char *name;
    const char *help; /* one or two lines */
    skein_category category;
    const skein_field *fields;
    size_t field_count;
    size_t params_size; /* internal */
} skein_kind;

/* A value for a field: `count` numbers, or a text when `count` is 0. A bool is 0 or 1; a choice is
 * given by its word or by its place, and read as its place. */
typedef struct skein_value {
    int count;
    double number[3];
    const char *text;
} skein_value;

/* One field set by name. Fields not named keep their defaults. names.h has the names as constants. A list of settings
 * is given where it is used, or kept as an array that ends with SKEIN_END, in C and in C++:
 *     skein_collider_add(world, "sphere", SKEIN_SETTINGS(SKEIN_REAL("radius", 0.3), SKEIN_VEC3("centre", 0, 1, 0)), NULL);
 *     const skein_setting ball[] = {SKEIN_REAL("radius", 0.3), SKEIN_VEC3("centre", 0, 1, 0), SKEIN_END};
 * A call reads its settings and keeps none of them, nor their texts. (In C, SKEIN_SETTINGS lives to the end of the block
 * that it stands in. In C++ it is a value, skein_settings<count>: `auto ball = SKEIN_SETTINGS(...)` keeps it, and a
 * pointer to one that is about to go does not compile.) */
typedef struct skein_setting {
    const char *name;
    skein_value value;
} skein_setting;

// clang-format off
#ifdef __cplusplus
#define SKEIN_SETTING_OF(name_, count_, x_, y_, z_, text_)                                                    \
    skein_setting{(name_), {(count_), {static_cast<double>(x_), static_cast<double>(y_), static_cast<double>(z_)}, (text_)}}
#define SKEIN_NO_TEXT nullptr
#define SKEIN_SETTINGS(...) skein_settings_of(__VA_ARGS__)
#else
#define SKEIN_SETTING_OF(name_, count_, x_, y_, z_, text_)                                                    \
    {(name_), {(count_), {(double)(x_), (double)(y_), (double)(z_)}, (text_)}}
#define SKEIN_NO_TEXT NULL
#define SKEIN_SETTINGS(...) ((const skein_setting[]){__VA_ARGS__, SKEIN_END})
#endif
#define SKEIN_REAL(name_, x_) SKEIN_SETTING_OF(name_, 1, x_, 0, 0, SKEIN_NO_TEXT)
#define SKEIN_PAIR(name_, x_, y_) SKEIN_SETTING_OF(name_, 2, x_, y_, 0, SKEIN_NO_TEXT)
#define SKEIN_VEC3(name_, x_, y_, z_) SKEIN_SETTING_OF(name_, 3, x_, y_, z_, SKEIN_NO_TEXT)
#define SKEIN_TEXT(name_, text_) SKEIN_SETTING_OF(name_, 0, 0, 0, 0, text_)
#define SKEIN_END SKEIN_SETTING_OF(SKEIN_NO_TEXT, 0, 0, 0, 0, SKEIN_NO_TEXT)
// clang-format on

/* The library's kinds of a category, `index` from 0; NULL past the end, and for SKEIN_SCENE, SKEIN_EXPORTER and SKEIN_VIEW,
 * which the command has and the library has not. What is returned here and below is constant and lasts. */
const skein_kind *skein_kind_at(skein_category category, size_t index);
/* The kind of that name; NULL (and SKEIN_ERROR_NAME with the nearest right name in `error`) where there is none. */
const skein_kind *skein_kind_find(skein_category category, const char *name, skein_error *error);
/* "body", "constraint", ... */
const char *skein_category_text(skein_category category);
/* Fields that every kind of the category has besides its own ("enabled", "visible", ...). */
const skein_field *skein_common_fields(skein_category category, size_t *count);
/* Whether a kind makes use of a field, its own or a common one: false where it is refused a value other than its default, as those of
 * moving frames are in a motion that is none ("jump" in an "attach"), and for what is no field of it. */
bool skein_kind_takes(const skein_kind *kind, const char *field);
/* A kind's own or common field by name; NULL (and the nearest right name in `error`) if none. In a kind that takes
 * parameters, "parameters.R" is found as "parameters.*". */
const skein_field *skein_field_find(const skein_kind *kind, const char *name, skein_error *error);
/* Checks a value against a field's type and range without setting anything: SKEIN_OK or SKEIN_ERROR_VALUE. */
skein_status skein_field_check(const skein_field *field, const skein_value *value, skein_error *error);

/* Prints a value as a scene would show it; returns the length that it needs, as snprintf does. `text` may be NULL. */
size_t skein_value_text(const skein_field *field, const skein_value *value, char *text, size_t size);

/* ---- Worlds ------------------------------------------------------------------------------------ */

typedef struct skein_world skein_world;

/* A body, rule, collider or method of one world. A handle that outlived its object, or that is given to another world,
 * is an error, never a crash. All zero it is no object's. What is in it is the library's. */
typedef struct skein_handle {
    uint32_t index, generation;
    uint64_t world;
} skein_handle;

static inline bool skein_handle_equal(skein_handle a, skein_handle b) {
    return a.index == b.index && a.generation == b.generation && a.world == b.world;
}

typedef enum skein_log_level { SKEIN_LOG_INFO, SKEIN_LOG_WARNING } skein_log_level;

/* What a world takes from its surroundings. Fill with skein_default_world_desc(), then change. */
typedef struct skein_kinds skein_kinds; /* kinds of a program's own: kinds.h */
typedef struct skein_world_desc {
    /* Memory: returns NULL when there is none; `alignment` is a power of two. Both or neither. */
    void *(*allocate)(void *user, size_t size, size_t alignment);
    void (*release)(void *user, void *memory, size_t size);
    void *memory_user;
    /* Messages, one line each without a newline. NULL keeps quiet. */
    void (*log)(void *user, skein_log_level level, const char *message);
    void *log_user;
    /* Tasks: runs task(data, 0) ... task(data, task_count - 1), at once or in any order, and
     * returns when all are done. NULL uses the world's own threads. */
    void (*run_tasks)(void *user, void (*task)(void *data, int index), void *data, int task_count);
    void *tasks_user;
    /* The most threads of the world's own pool, the caller included, 1 to 64; 0: as many as there are processors. A
     * step takes as many of them as have proved faster. Or the tasks to cut an op into where `run_tasks` is given. The
     * result does not depend on it. */
    int thread_count;
    /* Kinds besides the library's own, which the world can make objects of, and which outlive it; NULL: none. */
    const skein_kinds *kinds;
} skein_world_desc;

skein_world_desc skein_default_world_desc(void);

/* Makes an empty world under XPBD. `desc` NULL means the defaults. NULL on failure, with SKEIN_ERROR_VALUE or
 * SKEIN_ERROR_MEMORY in `error`, or SKEIN_ERROR_LIMIT on an x86-64 processor without SSE 4.1. The caller destroys it. */
skein_world *skein_world_create(const skein_world_desc *desc, skein_error *error);
void skein_world_destroy(skein_world *world); /* NULL is allowed */

/* The last failure of a call on this world; its status is SKEIN_OK if none failed yet. The world's own, and as long as
 * it; of NULL a constant that says so. */
const skein_error *skein_world_error(const skein_world *world);

/* ---- Building ---------------------------------------------------------------------------------- */

/* A polygon mesh, only read during the call it is given to. Faces are stored one after the other:
 * face f has `face_sizes[f]` corners (3 or more), 0-based indices into the vertices. For a body that is made of
 * tetrahedra ("tetrahedra") each "face" is one of them, of four corners in any order. */
typedef struct skein_mesh {
    const double *positions; /* vertex_count x 3, metres */
    size_t vertex_count;
    const uint32_t *face_sizes; /* face_count */
    size_t face_count;
    const uint32_t *face_vertices; /* sum of face_sizes */
    size_t face_vertex_count;
} skein_mesh;

/* How much a face counts in the normals of its vertices. */
typedef enum skein_normals {
    SKEIN_NORMALS_AREA,    /* by its area */
    SKEIN_NORMALS_UNIFORM, /* as much as any other */
    SKEIN_NORMALS_ANGLE    /* by its angle at the vertex: the same for any cut into triangles */
} skein_normals;

/* Unit normals of a mesh's vertices, into out[vertex_count x 3]; the mesh as for skein_body_add(). A face without area
 * counts nothing; a vertex without a face that counts has (0, 1, 0). Fails with SKEIN_ERROR_MESH for a face of fewer
 * than 3 corners and for a corner that is no vertex. */
skein_status skein_mesh_normals(const skein_mesh *mesh, skein_normals weighting, double *out, skein_error *error);

/* Adds loose particles, in order. `positions` and `velocities` are count x 3 (velocities may be
 * NULL: at rest); `masses` are in kg, 0 holds the particle where it is. `first` receives the index
 * of the first one and may be NULL. Indices never change. Fails with SKEIN_ERROR_MEMORY and SKEIN_ERROR_LIMIT. */
skein_status skein_particles_add(skein_world *world, size_t count, const double *positions, const double *velocities,
                                 const double *masses, uint32_t *first);

/* Adds a body of a kind of SKEIN_BODY ("cloth", ...). `mesh` may be NULL where the kind can do without. This and the
 * next calls fail with SKEIN_ERROR_NAME (of a kind or field), SKEIN_ERROR_SYNTAX (of a formula), SKEIN_ERROR_LIMIT and
 * SKEIN_ERROR_MEMORY; this one with SKEIN_ERROR_MESH, too. */
skein_status skein_body_add(skein_world *world, const char *kind, const skein_mesh *mesh, const skein_setting *settings,
                            skein_handle *handle);
/* Adds `count` constraints of one kind, each on the kind's number of particles (`distance`: 2; `formula` and `energy`:
 * as many as the formula names), with the rest values of the present positions. They share their settings. `particles`
 * are theirs one after the other, no one twice in a constraint. */
skein_status skein_constraint_add(skein_world *world, const char *kind, const uint32_t *particles, size_t count,
                                  const skein_setting *settings, skein_handle *handle);
/* How many particles each constraint of the kind takes, with these settings (NULL: the defaults). */
skein_status skein_constraint_arity(skein_world *world, const char *kind, const skein_setting *settings, size_t *arity);
skein_status skein_force_add(skein_world *world, const char *kind, const skein_setting *settings, skein_handle *handle);
skein_status skein_collider_add(skein_world *world, const char *kind, const skein_setting *settings,
                                skein_handle *handle);
/* Adds a collider of a kind that is made from a mesh ("mesh"), which is copied; of others with `mesh` NULL, as
 * skein_collider_add() does. Vertices at the same place are one, and faces are cut into triangles from their first corner. What
 * is wrong with the mesh and does not matter much (open edges, faces that disagree) is told to the world's log. Fails
 * with SKEIN_ERROR_MESH, too. */
skein_status skein_collider_add_mesh(skein_world *world, const char *kind, const skein_mesh *mesh,
                                     const skein_setting *settings, skein_handle *handle);
/* Where the vertices of a "mesh" collider are from now on, m, in the mesh's own coordinates: vertex_count x 3, in the order
 * in which the mesh was given (of vertices that were at one place the first counts). They come there in the next step, so
 * that the surface has a velocity for friction and impacts; set before each step, it may deform in any way. Fails
 * with SKEIN_ERROR_VALUE for another number of vertices, for what is not finite and under 1e12, and for other kinds;
 * with SKEIN_ERROR_MEMORY. */
skein_status skein_collider_vertices_set(skein_world *world, skein_handle collider, const double *positions,
                                         size_t vertex_count);
/* Places that particles go through, only read during the call they are given to: `sample_count` times, from the motion's
 * start on, `interval` seconds apart, those of all `particle_count` particles. */
typedef struct skein_track {
    const uint32_t *particles; /* particle_count */
    const double *places;      /* sample_count x particle_count x 3, metres; finite, under 1e15 */
    size_t particle_count, sample_count;
    double interval; /* s, over 0 */
} skein_track;

/* Adds a motion ("translate", "turn", "keys", "cache"): in each step it leads pinned particles, all or some of a body's, as
 * skein_pins_move() would, to where its fields say for the end of the step. Those places follow from the time, and from
 * where the particles were built; several motions of one pin act one after the other, in the order of their making. What
 * skein_pins_move() says counts instead. Whom it leads is found when a step is made, or skein_world_explain() called: then
 * a name of no body or group fails with SKEIN_ERROR_NAME. `track` is for "cache" and NULL for all others; `settings` and `handle`
 * may be NULL. Fails with SKEIN_ERROR_VALUE, SKEIN_ERROR_NAME, SKEIN_ERROR_LIMIT and SKEIN_ERROR_MEMORY. */
skein_status skein_motion_add(skein_world *world, const char *kind, const skein_track *track,
                              const skein_setting *settings, skein_handle *handle);
/* Sets the method; its former settings are gone. The world's own fields are kept. */
skein_status skein_method_set(skein_world *world, const char *kind, const skein_setting *settings);
/* Removes a body, constraint, force or collider. Its handle is stale from then on; an `index` of a later object may be
 * the same, its generation is not. SKEIN_ERROR_HANDLE for the method and for handles of nothing; SKEIN_ERROR_MEMORY.
 *
 * With a body go its particles, constraints and surface. The indices of all other particles stay. Its own are of nobody
 * (skein_particle_present() is false): positions and velocities read 0 there, in views with a w of 0, and what is
 * written there is dropped; until a body that is added later, and has no more particles than lie there together, gets
 * them. So skein_particle_count() never falls, and a game that adds and removes bodies for hours holds no more
 * than its largest moment needed, with some room between bodies of different sizes. Constraints of the program's own
 * lose those of their elements that one of the particles was in (enclosed_volume and pressure act no more). Rules whose
 * `on` or `neighbours` names the body move nobody until there is a body of that name again.
 *
 * A body that is not `enabled` is out of it in the same way, with all that it has: it does not move, is in no contact,
 * statistics, hash, ray, flock or list, costs a step nothing, and constraints of the program's own on its particles
 * rest. Its positions and velocities can be read and written; enabled again it goes on from them. All others move as if
 * there were no such body, to the bit. Taking a body out or back costs about what adding one costs. Graphics cards
 * refuse to step a world in which particles are out of it (SKEIN_ERROR_VALUE, in the step). */
skein_status skein_remove(skein_world *world, skein_handle handle);

/* ---- Fields of living objects ------------------------------------------------------------------ */

/* Sets or gets one field of an object. A field that shapes what was already built (a grid's size)
 * is refused with SKEIN_ERROR_VALUE. A text that is set is copied; one that is returned lives until the field changes.
 * Fails with SKEIN_ERROR_NAME where there is no such field; setting, also with SKEIN_ERROR_SYNTAX, SKEIN_ERROR_LIMIT and
 * SKEIN_ERROR_MEMORY. */
skein_status skein_set(skein_world *world, skein_handle handle, const char *field, skein_value value);
skein_status skein_get(const skein_world *world, skein_handle handle, const char *field, skein_value *value);
/* Whether the field of an object can be set now: it exists, and shapes nothing that is already built. */
bool skein_field_is_live(const skein_world *world, skein_handle handle, const char *field);
/* Set and get by path: "bodies.0.stretch.stiffness", "colliders.ball.radius" (a name), "method.substeps".
 * Numbers count objects of the category in the order of their making. Fails as the two above, and with
 * SKEIN_ERROR_NAME where the path leads nowhere. */
skein_status skein_set_path(skein_world *world, const char *path, skein_value value);
skein_status skein_get_path(const skein_world *world, const char *path, skein_value *value);
/* Shorthands for values. */
static inline skein_value skein_number(double x) {
    skein_value v = {1, {x, 0, 0}, NULL};
    return v;
}
static inline skein_value skein_vector(double x, double y, double z) {
    skein_value v = {3, {x, y, z}, NULL};
    return v;
}
static inline skein_value skein_text(const char *text) {
    skein_value v = {0, {0, 0, 0}, text};
    return v;
}

/* Living objects of a category, in the order of their making; past the end a handle of no object. */
size_t skein_object_count(const skein_world *world, skein_category category);
skein_handle skein_object_at(const skein_world *world, skein_category category, size_t index);
/* The kind of an object; NULL for a stale handle. The method's handle is skein_object_at(..., SKEIN_METHOD, 0). Where
 * the kind takes parameters of formulas, it is the object's own, and lives as long as the object: its fields are the
 * kind's and the parameters that the object was made with. */
const skein_kind *skein_object_kind(const skein_world *world, skein_handle handle);
bool skein_handle_valid(const skein_world *world, skein_handle handle);
/* A pointer of the program's own on a body, constraint, force or collider: the library keeps it and never looks. NULL
 * until it is set, and for a handle of none of these. Nothing is done with it when the object goes. */
skein_status skein_user_set(skein_world *world, skein_handle handle, void *user);
void *skein_user(const skein_world *world, skein_handle handle);

/* ---- Stepping ---------------------------------------------------------------------------------- */

#define SKEIN_DEFAULT_STEP (1.0 / 90.0) /* seconds */

/* Advances the world by `dt` seconds (more than 0, at most 1e6), in the method's substeps: PBD and XPBD take fewer where a step is
 * shorter than the one before, so that these get shorter by a fifth at most, or there is one more. Fails with SKEIN_ERROR_VALUE
 * where the method or device cannot run a rule, SKEIN_ERROR_NAME where a rule names a body that is not there,
 * SKEIN_ERROR_MEMORY, and with what a sparse solver returns. */
skein_status skein_world_step(skein_world *world, double dt);
/* Positions as they were built; velocities, forces, time and counters zero. */
skein_status skein_world_reset(skein_world *world);
double skein_world_time(const skein_world *world); /* seconds of simulated time */
/* Sets the clock alone: what moves by it (colliders) is elsewhere then. With positions and velocities that were copied
 * before, it takes a world back to where it was, but for how long its last substep was, which snapshots know. 0 to 1e15. */
skein_status skein_world_time_set(skein_world *world, double seconds);

/* A fixed step for a loop with uneven frames: time goes in, whole steps come out, the rest is kept.
 * Feed it frame times only, never the time spent loading. */
typedef struct skein_pacer {
    double step;      /* seconds */
    int most_steps;   /* at most so many steps a feed; what is beyond is dropped (the world slows down) */
    double remainder; /* seconds fed but not yet stepped, under one step */
    double dropped;   /* seconds dropped so far */
} skein_pacer;

skein_pacer skein_default_pacer(void); /* SKEIN_DEFAULT_STEP, at most 8 steps a feed */
/* Adds `seconds` (NaN, negative and infinite count as 0) and returns the number of steps to take now. */
int skein_pacer_feed(skein_pacer *pacer, double seconds);
/* How far the present lies between the last two states, 0 to 1. */
double skein_pacer_blend(const skein_pacer *pacer);

/* ---- Where steps are computed -------------------------------------------------------------------- */

typedef enum skein_device {
    SKEIN_DEVICE_CPU,       /* the processor: every rule, the same bits everywhere */
    SKEIN_DEVICE_GPU,       /* a graphics card, through an OpenGL 4.5 context of the world's own */
    SKEIN_DEVICE_CURRENT_GL /* the same, in the OpenGL context that is current on this thread: it must be current at
                               every later call on the world, too */
} skein_device;

/* Changes where steps are computed; the state goes along. The card runs the same plan, in float, and keeps the state
 * there: it comes back when a call looks at it (a view, a copy, statistics, a hash), and only then. A rule that cannot
 * run on a card is named when a plan is made: by the next step, or by skein_world_explain(). Fails with
 * SKEIN_ERROR_VALUE where there is no such device, with SKEIN_ERROR_LIMIT for what is too much for it, and with
 * SKEIN_ERROR_MEMORY. */
skein_status skein_world_device_set(skein_world *world, skein_device device);

/* Waits until the steps asked for are done: a card works behind the calls. For measuring; nothing else needs it. */
void skein_world_wait(const skein_world *world);

typedef struct skein_device_info {
    skein_device device;
    const char *name;  /* "processor", or the card and its driver; as long as the device is the world's */
    bool software;     /* a graphics card that the processor plays: right, but slow */
    size_t bytes;      /* held on the card now */
    size_t pass_count; /* shaders that a step runs, and the loops around them */
    /* For drawing without reading back: OpenGL buffers of four floats a slot, x, y, z and the inverse mass, or velocity
     * and mass. 0 where the card has not the newest state, as before the first step and after calls that change it; and
     * changed by whatever adds particles. Particle i is in slot slot_of[i]; or,
     * where that is NULL, particle_buffer holds a whole number a slot, the particle there, and a step may change it. */
    unsigned position_buffer, velocity_buffer, particle_buffer;
    const uint32_t *slot_of;
    size_t slot_count;
} skein_device_info;
skein_device_info skein_world_device(const skein_world *world);

/* ---- Sparse solvers ------------------------------------------------------------------------------ */

/* A sparse symmetric matrix: its lower triangle, column after column. Row 3 i + k is of particle i (the user's index)
 * along axis k. */
typedef struct skein_sparse_matrix {
    size_t size;          /* rows, and columns: 3 x particles */
    const int64_t *start; /* size + 1: column c has the entries start[c] to start[c + 1] - 1 */
    const int64_t *row;   /* start[size]: ascending in each column, which begins with its diagonal */
    const double *value;  /* start[size], kg: mass, damping times substep, stiffness times its square. NULL while the
                             matrix is analysed */
} skein_sparse_matrix;

/* What can factor such matrices, for backward_euler's `"preconditioner": "cholesky"`. The library brings none;
 * solvers/cholmod.h does. Called on the thread that steps, one call at a time; two worlds that step at once need one
 * each. What is passed to a call is only there until it returns. The same calls must lead to the same bits if steps are
 * to. */
typedef struct skein_sparse_solver {
    const char *name; /* for messages; as long as the solver is the world's */
    void *user;
    /* Takes the places of a matrix's entries (no values): when a plan is made, once for each arrangement of particles
     * and constraints. What it returns, with `error` filled in, the step or skein_world_explain() returns. */
    skein_status (*analyse)(void *user, const skein_sparse_matrix *pattern, skein_error *error);
    /* Factors a matrix of the last pattern, positive definite but for rounding. False where it cannot: that is counted
     * (solver_failures), and the solve goes on with the particles' own blocks. Asked for in each iteration of Newton's
     * method. */
    bool (*factor)(void *user, const skein_sparse_matrix *matrix);
    /* x = matrix^-1 b, of the last matrix that was factored; `b` and `x` are `size` numbers, x unset. False where it
     * cannot. Asked for in each iteration of conjugate gradients. */
    bool (*solve)(void *user, const double *b, double *x);
    void (*release)(void *user); /* when the world goes, or takes another; NULL: nothing is to be released */
} skein_sparse_solver;

/* Gives the world a solver (copied; the world releases it), or with NULL takes it away. On failure it stays the
 * caller's, and the world keeps the one it had. Analyse, factor and solve may not be NULL; a name may. */
skein_status skein_sparse_solver_set(skein_world *world, const skein_sparse_solver *solver);

/* ---- Reading and writing the state ------------------------------------------------------------- */

/* The state without a copy, valid until the next step or change. Particle i stands at
 * xyzw[4 * slot_of[i]]; slots are in the order that is good for speed. */
typedef struct skein_view {
    const skein_real *xyzw;
    const uint32_t *slot_of;
    size_t count;
} skein_view;

/* The caller's memory for three numbers each of many: those of the i-th begin at data + i * stride bytes, and what lies
 * between is left alone. Make one with skein_floats() or skein_doubles(). */
typedef enum skein_number_type { SKEIN_FLOAT32, SKEIN_FLOAT64 } skein_number_type;
typedef struct skein_buffer {
    void *data;
    size_t stride; /* bytes, at least those of three numbers; 0: one three right after the other */
    skein_number_type type;
} skein_buffer;

static inline skein_buffer skein_floats(float *data, size_t stride) {
    skein_buffer buffer = {data, stride, SKEIN_FLOAT32};
    return buffer;
}
static inline skein_buffer skein_doubles(double *data, size_t stride) {
    skein_buffer buffer = {data, stride, SKEIN_FLOAT64};
    return buffer;
}

/* All indices that there are, those of bodies that are disabled or were removed, too. */
size_t skein_particle_count(const skein_world *world);
/* Whether a body sleeps: it has come to rest, as its `sleep` says, and steps leave it out until something comes near it, its pins
 * are led elsewhere, or it or a rule is changed. Setting any of its fields wakes it. False for what is no body. */
bool skein_body_asleep(const skein_world *world, skein_handle body);
/* Whether a particle takes part: its body, if it has one, is enabled and was not removed. False beyond the last one. */
bool skein_particle_present(const skein_world *world, size_t particle);
/* Where the state cannot be fetched from a device, skein_world_error() says so, and a view has what was there before. */
skein_view skein_position_view(const skein_world *world); /* w is the inverse mass */
skein_view skein_velocity_view(const skein_world *world); /* w is the mass, kg (pinned ones too) */
/* Copies `count` particles from `first` on, in the user's order, into out[count x 3]. These fail with
 * SKEIN_ERROR_VALUE where there are not so many. */
skein_status skein_positions_copy(const skein_world *world, size_t first, size_t count, double *out);
skein_status skein_velocities_copy(const skein_world *world, size_t first, size_t count, double *out);
/* The same of where they were built, and are after skein_world_reset(). */
skein_status skein_positions_built(const skein_world *world, size_t first, size_t count, double *out);
/* The same into memory of any layout, a vertex buffer's, say. */
skein_status skein_positions_copy_to(const skein_world *world, size_t first, size_t count, skein_buffer to);
skein_status skein_velocities_copy_to(const skein_world *world, size_t first, size_t count, skein_buffer to);
/* Positions between the last two steps: 0 gives the state before the last step, 1 the present; beyond these it goes on
 * straight. Any finite number. */
skein_status skein_positions_blend(const skein_world *world, double blend, size_t first, size_t count, double *out);
/* Writes positions or velocities, count x 3. Finite numbers only. */
skein_status skein_positions_set(skein_world *world, size_t first, size_t count, const double *xyz);
skein_status skein_velocities_set(skein_world *world, size_t first, size_t count, const double *xyz);
/* Holds a particle where it is, or lets it go with the mass it was built with, and with the velocity that it has. From the next
 * step on the rest of a cloth or rope is tethered to it. */
skein_status skein_particle_pin(skein_world *world, size_t particle, bool pinned);
/* Says where pinned particles are to be at the end of the next step: `particles` are `count` indices (NULL: 0 to count
 * - 1), `xyz` are count x 3, in metres. In the step they go there in straight lines at constant velocities, substep by
 * substep and under every method, so that what hangs on them is led, not torn: damping and tethers see that velocity.
 * Called before each step, it moves pins along any path; `skein_positions_set` puts them there at a blow instead.
 *
 * After the step each stands at its place, to the last bit, and its velocity is 0: there it stays until it is moved
 * again. (A pinned particle that was given a velocity, and no place, goes on with it instead.) What is let go then
 * begins at rest, unless it is given a velocity. Of several places for one particle the last counts. Places wait until
 * a step is taken; a reset forgets them, and so does a particle that is not pinned by then. Their work is counted with
 * what was changed by hand (dissipated_energy). On a graphics card each such step brings the state back.
 *
 * SKEIN_ERROR_VALUE for a particle that is not there or not pinned, and for places that are not finite or beyond 1e15;
 * nothing has changed then. A step in which a pin would have to be faster than 1e15 m/s fails, and forgets all places.
 */
skein_status skein_pins_move(skein_world *world, const uint32_t *particles, size_t count, const double *xyz);

/* ---- Snapshots ---- */

/* All that steps and calls have changed since the world was built, as bytes: positions, velocities, who is held, the
 * clock and its counts, every live field of the method and of all objects, ways that colliders are on, places that wait
 * for pins. A world that reads it goes on with the same bits as the one that it was taken of, on any machine: the world
 * itself, or one that was built by the same calls. What was built (meshes, constraints, masses) is not in it, and is
 * compared. The bytes can be kept in memory, or in a file; docs/recording.md has their layout. */
/* How many bytes a snapshot takes now: about 36 a particle in float, 72 in double. */
size_t skein_snapshot_size(const skein_world *world);
/* Writes it to `out`, of `size` bytes; `written` (or NULL) receives how many it took. Fails with SKEIN_ERROR_LIMIT where
 * that is too little room. */
skein_status skein_snapshot_write(const skein_world *world, void *out, size_t size, size_t *written);
/* Takes the world to where it was. Nothing of `bytes` is trusted, and nothing is allocated by what they say: fails with
 * SKEIN_ERROR_SYNTAX for what is no snapshot or a damaged one, SKEIN_ERROR_LIMIT for one of a newer version,
 * SKEIN_ERROR_VALUE and SKEIN_ERROR_NAME for one of another precision or of a world that was built otherwise, and
 * SKEIN_ERROR_MEMORY, after which some fields may be set and others not. */
skein_status skein_snapshot_read(skein_world *world, const void *bytes, size_t size);

typedef struct skein_snapshot_info {
    uint32_t version;
    uint32_t real_size; /* bytes of a number: 4 in float, 8 in double */
    double time;        /* s */
    uint64_t steps, particles, objects;
    size_t size; /* bytes of the snapshot; what follows them is the caller's own */
} skein_snapshot_info;
/* Looks at a snapshot without a world: whether it is whole, and of what. Fails as above. */
skein_status skein_snapshot_look(const void *bytes, size_t size, skein_snapshot_info *info, skein_error *error);

/* What a body's surface is drawn as by whoever draws: its field "look", whose places these are. */
typedef enum skein_look {
    SKEIN_LOOK_CLOTH, /* woven */
    SKEIN_LOOK_JELLY, /* smooth, lit through, with round edges */
    SKEIN_LOOK_PLAIN  /* of one colour */
} skein_look;

/* What a body drew and its particles. Pointers live as long as the body. */
typedef struct skein_surface {
    uint32_t first_particle, particle_count;
    const uint32_t *particle_of_vertex; /* vertex_count: where the mesh's vertices are (welding) */
    size_t vertex_count;
    const uint32_t *face_sizes; /* as they came */
    size_t face_count;
    const uint32_t *face_vertices; /* vertices, not particles */
    size_t face_vertex_count;
    uint32_t grid_rows, grid_columns; /* 0 where the body is not a grid */
    const float *corner_uv;           /* face_vertex_count x 2, or NULL: see skein_body_uv_set() */
} skein_surface;
skein_status skein_body_surface(const skein_world *world, skein_handle body, skein_surface *surface);
/* Copies where the vertices of a body's surface are, and their unit normals, weighted by area (vertices that welding
 * joined share one): both of the surface's `vertex_count` vertices, between the last two steps as
 * skein_positions_blend() says (1: now). The data of one of the buffers may be NULL: it is left out. Fails with
 * SKEIN_ERROR_MEMORY. */
skein_status skein_body_vertices_copy(skein_world *world, skein_handle body, double blend, skein_buffer positions,
                                      skein_buffer normals);
/* Sets of a body's particles that constraints can be made on. Faces are cut into triangles from their first corner. */
typedef enum skein_elements {
    SKEIN_EDGES,     /* 2: whatever the body's stretch is measured along */
    SKEIN_TRIANGLES, /* 3 */
    SKEIN_HINGES,    /* 4: the ends of a side that two triangles share, and the corners across from it */
    SKEIN_TETRAHEDRA /* 4: of a body that is made of them */
} skein_elements;
/* Copies up to `most` of them, with so many particles each; `count` receives how many there are. `out` may be NULL: only
 * the count is wanted. Fails with SKEIN_ERROR_MEMORY. */
skein_status skein_body_elements(skein_world *world, skein_handle body, skein_elements what, uint32_t *out, size_t most,
                                 size_t *count);
/* Keeps texture coordinates for a body's surface, one pair for each corner of each face (so that a seam may have
 * two); they are for drawing only, and copied. `corner_count` is the surface's face_vertex_count. Fails with
 * SKEIN_ERROR_MEMORY. */
skein_status skein_body_uv_set(skein_world *world, skein_handle body, const float *corner_uv, size_t corner_count);

/* Where a collider stands now, for drawing. `shape` is the kind's name. */
typedef struct skein_pose {
    double position[3]; /* a sphere's centre, the middle of a capsule's line, a point of a plane */
    double rotation[9]; /* rows of a rotation matrix: the motion's, after a box's own */
} skein_pose;
skein_status skein_collider_pose(const skein_world *world, skein_handle collider, skein_pose *pose);

/* What a collider or body looks like to whoever draws it, whatever its kind is. A new kind needs to say nothing: what is
 * solid is seen by its distances, a body by its faces. */
typedef enum skein_shape_sort {
    SKEIN_SHAPE_SURFACE, /* a collider: its skein_collider_triangles(), or where skein_collider_probe() finds 0; a body: its faces, or loose particles */
    SKEIN_SHAPE_PLANE,   /* `axis` is its unit normal */
    SKEIN_SHAPE_BALL,    /* of `radius` */
    SKEIN_SHAPE_BOWL,    /* the inside of a ball of `radius` */
    SKEIN_SHAPE_CAPSULE, /* a ball of `radius` drawn from -`axis` to `axis` */
    SKEIN_SHAPE_BOX,     /* of `size` */
    SKEIN_SHAPE_CHAIN,   /* a body: rods from each particle to the next */
    SKEIN_SHAPE_BIRDS    /* a body: each particle flies by itself, where its velocity leads */
} skein_shape_sort;
typedef struct skein_shape {
    skein_shape_sort sort;
    double radius, axis[3], size[3]; /* m, about its skein_pose.position, before its rotation; 0 where it has none */
} skein_shape;
skein_status skein_shape_of(const skein_world *world, skein_handle object, skein_shape *shape);

/* The triangles that contact finds a collider by ("mesh"), which whoever draws it draws, from both sides: an open mesh has no inside
 * whose border could be looked for. Vertices that were given at one place are one here. None (`count` 0) for all other
 * colliders. Pointers live as long as the collider. */
typedef struct skein_triangles {
    const uint32_t *vertices; /* count x 3; of a closed mesh counterclockwise as seen from outside, else as they came */
    size_t count, vertex_count;
} skein_triangles;
skein_status skein_collider_triangles(const skein_world *world, skein_handle collider, skein_triangles *triangles);
/* Copies where their `vertex_count` vertices are now, m, in the world. Fails with SKEIN_ERROR_VALUE where there are none. */
skein_status skein_collider_vertices_copy(const skein_world *world, skein_handle collider, skein_buffer positions);

/* A collider whose place was set since the last step (its centre, ends, rotation, normal or offset, by skein_set() or
 * skein_set_path()) travels there through the next step, in a straight line and turning the shorter way round, evenly:
 * friction and impacts see that velocity, and what is in its way is met in every substep. Set before each step, it
 * moves along any path; when it is not set it rests, but for its `motion`. `motion` goes on from what is set: a centre
 * is where it would be without it. Setting fields of `motion` alone is no way that is made: the collider is at once
 * where they put it. Together they say how it goes on (`centre` where it stands now, `motion.velocity`, and
 * `motion.start` now), and what they have not moved does not travel. Sizes and radii change at once.
 *
 * This call says that what has been set since the last step, vertices as well, is no way, but where the collider stands from now on. So
 * does a reset, and setting the time; a collider that is not enabled does not travel. Its work on particles counts
 * against the dissipated energy. */
skein_status skein_collider_teleport(skein_world *world, skein_handle collider);

/* A body is elsewhere at once: each of its particles, pinned ones too, goes from x to turn x + shift, and its velocity turns. It
 * is not flung, and nothing is met on the way. `turn` has the rows of a rotation, NULL is none; `shift` in metres, NULL is
 * none. Places that pins were told, and those of motions, stay: a motion says itself what is a jump (`jump`, `jump_times`).
 * A collider that jumps with it: set its place, then call skein_collider_teleport(). With part of the way that a character
 * makes in a frame, called before each step, a program carries its clothes along, as a motion's `inertia` does. Fails with
 * SKEIN_ERROR_VALUE for a turn that is none, and numbers that are not finite. */
skein_status skein_body_teleport(skein_world *world, skein_handle body, const double turn[9], const double shift[3]);

/* Two particles that a rule keeps at a distance: an edge or diagonal of a cloth, a `distance`. */
typedef struct skein_spring {
    uint32_t particle[2];
    float strain;  /* (length - rest)/rest now; 0 where the rest length is 0 */
    bool measured; /* it counts in the statistics' stretch: an edge of a mesh, or added by itself */
} skein_spring;
/* Copies up to `most` of the springs of enabled rules, in the order of their making; `count` receives how many
 * there are. Fails with SKEIN_ERROR_MEMORY. */
skein_status skein_springs_copy(skein_world *world, skein_spring *out, size_t most, size_t *count);

/* ---- Looking into constraints ---- */

/* One constraint of an object as the state stands: a function C of a few particles that is to be 0; one-sided, at least
 * 0. Where it is an energy, its forces are -stiffness times its gradient; else they are -stiffness C times it, without
 * the damping. Not finite where something overflows: solves then leave it out. */
typedef struct skein_constraint_value {
    double value;     /* C: m for a distance, rad for angles, m2 for an area, m3 for volumes, as the text has it for a
                         formula. An energy over its stiffness, J */
    double by_time;   /* its derivative by t alone, 1/s: 0 where a formula does not name t */
    double stiffness; /* with its share of the material; infinity is rigid */
    bool is_energy, one_sided;
    bool guarded;          /* something had no value here, and 0 or the nearest was taken (docs/formula.md) */
    size_t particle_count; /* 2 to 8; all of its particles for a closed surface, which is one constraint */
    const char *label;     /* of a body which part ("stretch"), of a constraint its name or kind */
    const char *text;      /* its formula; "" for a closed surface. Both live until the object changes */
} skein_constraint_value;

/* How many constraints a constraint object has, or a body has in all its parts, one part after the other. What is not
 * enabled counts, what is gone or on a body that is taken out does not. Fails with SKEIN_ERROR_HANDLE for other objects,
 * and with SKEIN_ERROR_MEMORY. */
skein_status skein_constraint_count(skein_world *world, skein_handle object, size_t *count);
/* What constraint `index` is now, by the automatic derivatives that solves use, in double. Of its particles in their
 * order in the formula (p0, p1 ...), up to `most` go to `particles`, and its gradient by them (1/m of the value's unit)
 * to `gradient`, most x 3; both may be NULL if `most` is 0. A world is not changed by looking. Fails with
 * SKEIN_ERROR_VALUE where there is no such index, and as above. */
skein_status skein_constraint_evaluate(skein_world *world, skein_handle object, size_t index,
                                       skein_constraint_value *value, uint32_t *particles, double *gradient,
                                       size_t most);

/* A step on the way to a constraint's value. */
typedef struct skein_operation {
    const char *name;  /* "input", "constant", "parameter"; "add", "sqrt" ..., as `skein formula --graph` has them */
    char label[40];    /* of the first three what it is: "p0.x", "t", "0.5", "L", "rest 1"; else the word of the text
                            that it comes of ("length"), or "" */
    int operand_count; /* 0 to 4 */
    size_t operand[4]; /* operations before it. "less" is a < b ? c : d */
    double value;
} skein_operation;

/* A constraint's formula, operation by operation: each after those that it reads, the last is the value. Up to `most` go
 * to `operations`; `derivatives` (or NULL) receives those of each by all coordinates of the constraint's particles,
 * forwards by the chain rule: most x 3 particle_count. `count` receives how many there are: 0 for a closed surface, which
 * is a sum of many formulas. Fails as above, and with SKEIN_ERROR_LIMIT for derivatives of a formula so large that each
 * of its operations cannot have its own. */
skein_status skein_constraint_operations(skein_world *world, skein_handle object, size_t index,
                                         skein_operation *operations, double *derivatives, size_t most, size_t *count);

/* A particle within a collider's thickness, as the statistics count them. */
typedef struct skein_contact {
    uint32_t particle;
    skein_handle collider;
    double normal[3]; /* unit, out of the solid */
    double gap;       /* m, from the collider's surface; negative inside */
} skein_contact;
/* Copies up to `most` of the contacts of enabled colliders; `count` receives how many there are. */
skein_status skein_contacts_copy(const skein_world *world, skein_contact *out, size_t most, size_t *count);

/* Two features of surfaces that touch, as a rule of contact keeps them: a vertex and a triangle, or two edges. */
typedef struct skein_surface_contact {
    skein_handle rule;
    bool edges; /* particle[0] and [1] are one edge, [2] and [3] the other; else [0] meets the triangle of the rest */
    uint32_t particle[4];
    double weight[4]; /* of the particles: those of the first feature add up to 1, those of the second to -1. The sum of
                             weights times places is the way from the second feature's nearest point to the first's */
    double normal[3]; /* unit, from the second feature to the first */
    double gap, thickness; /* m: how far apart they are, and are to be */
} skein_surface_contact;
/* Copies up to `most` of the pairs that are no farther apart than their thickness by more than a thousandth, by the positions as
 * they are; `count` receives how many there are. They come rule by rule, in an order that follows from the bodies alone.
 * Costs a search over all surfaces: about what a step does in which everything has moved. */
skein_status skein_surface_contacts_copy(skein_world *world, skein_surface_contact *out, size_t most, size_t *count);

/* Where `count` points (count x 3) are seen from a collider's surface as it stands now: how far off, as contact takes
 * it (negative inside; far away, formulas may say 1e15), and the unit normals out of the solid. Either may be NULL. */
skein_status skein_collider_probe(const skein_world *world, skein_handle collider, size_t count, const double *points,
                                  double *distances, double *normals);

/* What a force field or a potential does now to a particle that rests at each of `count` points (count x 3): `forces`
 * (count x 3) in m/s2 where its formula is per mass, else in N. Fails with SKEIN_ERROR_VALUE for one that is no field
 * by formula, and with SKEIN_ERROR_MEMORY. */
skein_status skein_force_probe(const skein_world *world, skein_handle force, size_t count, const double *points,
                               double *forces);

/* ---- What is where: for picking with a mouse, and for sensors ------------------------------------- */

/* What a ray meets first. */
typedef struct skein_hit {
    double t;            /* m along the ray; infinity where it meets nothing, and then nothing else holds */
    double point[3];     /* where */
    double normal[3];    /* unit: a collider's, out of the solid; a face's, towards the ray's origin */
    skein_handle object; /* a body or a collider */
    size_t face;         /* of a body: which, as it came */
    uint32_t particle;   /* of a body: that corner of the face which is nearest to the point */
} skein_hit;

/* Casts a ray at the surfaces of bodies (SKEIN_BODY) or at colliders (SKEIN_COLLIDER), without their thickness. The
 * direction may have any length but 0. From inside a solid the ray goes on until it comes out and meets another wall,
 * so that one looks into a bowl from outside. Objects that are not `visible`, and colliders that are not `enabled`, are
 * passed over. Costs a look at every face, or some probes of every collider. */
skein_status skein_ray_cast(const skein_world *world, const double origin[3], const double direction[3],
                            skein_category category, skein_hit *hit);
/* The particle that is nearest to a point; `metres` (or NULL) receives how far. Fails where there are none. */
skein_status skein_particle_near_point(const skein_world *world, const double point[3], uint32_t *particle,
                                       double *metres);
/* Of the particles within `radius` + `slope` t of a ray, t metres along it, the one nearest to it by that measure; for
 * particles that are drawn as balls of that radius, and a pointer that is a few pixels wide. `t` receives that,
 * infinity where there is none. */
skein_status skein_particle_near_ray(const skein_world *world, const double origin[3], const double direction[3],
                                     double radius, double slope, uint32_t *particle, double *t);

/* ---- Measures ---------------------------------------------------------------------------------- */

typedef struct skein_statistics {
    uint64_t steps, substeps;
    double time;                /* s, simulated */
    double kinetic_energy;      /* J */
    double potential_energy;    /* J, of gravity (0 at the origin) and potentials */
    double elastic_energy;      /* J, in constraints; what is rigid holds none */
    double dissipated_energy;   /* J: the energy when the first step began, less the energy now. What damping, friction,
                                   impacts and the method itself have taken; wind, moving colliders and changes made by
                                   hand count against it */
    double momentum[3];         /* kg m/s */
    double angular_momentum[3]; /* kg m2/s, about the origin */
    double max_stretch;         /* largest (length - rest)/rest of the edges; 0.01 is one per cent */
    double p99_stretch;         /* 99 % of the edges stretch at most so much */
    size_t limited;             /* edges that have a strain limit, "stretch.limit" of a cloth */
    size_t over_limit;          /* of these, stretched by more than 1.1 times that */
    double most_over_limit; /* the most that an edge stretches beyond its limit: 0.002 if one of 0.01 stretches by 0.012 */
    /* of the last step of a method that solves for it (backward_euler), else 0 */
    double residual;          /* what was left of the balance of momentum, as a share of its start: the worst
                                 substep's */
    size_t unsolved;          /* substeps left with more than the tolerance, and more than rounding explains */
    size_t newton_iterations; /* of Newton's method */
    size_t cg_iterations;     /* of conjugate gradients */
    size_t solver_factors;    /* that a sparse solver was asked for */
    size_t solver_failures;   /* of these, and of its solves: the solve went on with each particle's own block */
    /* of all steps since the beginning or the last skein_world_reset() */
    uint64_t all_unsolved, all_solver_failures;
    uint64_t contact_overflows; /* searches that found more pairs for the force "contact" than there is room for, so that nothing
                                   touched until the next one: its thickness is too large for the bodies, or they have blown
                                   up. Since the beginning or the last reset; a snapshot does not hold it */
    double max_penetration; /* m, below a collider's thickness */
    size_t contacts;        /* pairs of a particle and a collider that touch */
    size_t crossings;       /* of an edge and a triangle that contact keeps apart (the force "contact"); else 0 */
    size_t particles, pinned_particles, constraints;
    size_t asleep;       /* particles of bodies that sleep (a body's `sleep`) */
    size_t nonfinite;    /* particles with a position or velocity that is not finite */
    size_t guarded;      /* values of formulas that have none at the present state, where 0 or the nearest was taken:
                            of each collider and force at each free particle (docs/formula.md) */
    size_t memory_bytes; /* held by the world now */
    uint64_t state_hash; /* of positions and velocities in the user's order */
} skein_statistics;

/* Measures the present state; costs about one step, and scratch memory for the edges. Fails with SKEIN_ERROR_MEMORY. */
skein_status skein_world_statistics(skein_world *world, skein_statistics *statistics);
/* Whether anything but the method's own errors may give the world energy, as it stands: wind and steering, a field of
 * force, an energy or a constraint that depends on t, a collider or a pinned particle that moves, a motion, a collider
 * with a mass. Where nothing does, kinetic, potential and elastic energy together never grow. Costs two measurements of
 * energy. */
bool skein_world_is_driven(skein_world *world);
/* Only the hash. */
uint64_t skein_world_hash(const skein_world *world);

/* How particles fly together: a flock's order parameters. */
typedef struct skein_order {
    size_t count;        /* particles with finite positions and velocities */
    double polarization; /* length of the mean direction of flight: 1, all fly the same way; 0, no common way */
    double milling;      /* length of the mean of (r x v)/(|r| |v|), with r from the centre: 1, all circle it the
                            same way round */
    double nearest;      /* m, mean distance to the nearest one */
    size_t groups;       /* of particles that are nearer than the group distance to one of the group */
    double radius;       /* m, mean distance from the centre */
    double farthest;     /* m, the largest of them */
    double speed;        /* m/s, mean */
} skein_order;

/* Measures `count` particles from `first` on, about a centre (m). A group distance (m) of 0 counts no groups. Fails with
 * SKEIN_ERROR_MEMORY. */
skein_status skein_order_measure(skein_world *world, size_t first, size_t count, const double centre[3],
                                 double group_distance, skein_order *order);

/* ---- Stability --------------------------------------------------------------------------------- */

/* A way in which the world can vibrate. */
typedef struct skein_mode {
    double frequency;    /* omega, rad/s */
    double damping_rate; /* zeta omega, 1/s: its amplitude dies as exp(-rate t) */
} skein_mode;

/* What limits the substep of explicit methods: the stiffest mode first, then (where there is damping) the most damped
 * one, and one between. None without finite springs and without air. */
typedef struct skein_stability {
    skein_mode modes[3];
    size_t mode_count;
    bool swinging_is_free; /* the only damping is along constraints: swinging is not damped, and grows, however
                              slowly, under methods that gain energy */
} skein_stability;

/* Finds those modes for the world as it lies, by power iteration; costs as much as some hundred force evaluations.
 * Rigid constraints, contact and neighbour rules are left out. (Under explicit_euler and midpoint slower modes that
 * have less damping for their stiffness may still grow, slowly.) Fails with SKEIN_ERROR_MEMORY. */
skein_status skein_world_stability(skein_world *world, skein_stability *stability);
/* The largest substep (s) at which no mode grows under the method: 0 if there is none, infinity if any will do. NaN for
 * a method that does not exist. */
double skein_stable_substep(const char *method, const skein_stability *stability);

/* What the ops of one kind and name took together. */
typedef struct skein_pass {
    const char *kind; /* "project", "force", ... */
    char label[64];   /* of the rule: "stretch +0 +1"; "" for the arithmetic of whole vectors */
    double seconds;
} skein_pass;

/* Takes a step, with the same bits as skein_world_step(), but one op of the plan after the other, and measures each.
 * That is slower than a step, whose ops share the cache; the shares tell where the time goes. Copies up to `most`
 * passes in the order of the plan; `count` receives how many there are. A step on a device is one pass. Fails as a step
 * does. */
skein_status skein_world_profile(skein_world *world, double dt, skein_pass *out, size_t most, size_t *count);

/* ---- The plan ---------------------------------------------------------------------------------- */

/* Writes the plan's ops as text, a line each, for a step of `dt`. Lines go to `write` in order; NULL only
 * makes the plan, which says whether the method can run the rules. Fails as a step does. */
skein_status skein_world_explain(skein_world *world, double dt, void (*write)(void *user, const char *line), void *user);

/* Whether ops of the plan are fused, as they are in a new world: what predicts, saves and corrects is one op then
 * instead of several, the bits are the same, and steps are quicker. Plans for a card always are. */
void skein_world_fuse(skein_world *world, bool fuse);

#if defined(__GNUC__)
#pragma GCC visibility pop
#endif
#ifdef __cplusplus
}

/* ---- Settings in C++ ----------------------------------------------------------------------------- */

/* A list of settings as a value. It turns into a pointer where it stays, and only there: given to a call as it is made,
 * it goes by the functions below; kept by `auto` it is an array like any other. */
template <size_t count_> struct skein_settings {
    skein_setting list[count_ + 1];
    operator const skein_setting *() const & {
        return list;
    }
    operator const skein_setting *() const && = delete; /* the list would be gone: keep it by auto, or as an array */
};

template <typename... setting_> skein_settings<sizeof...(setting_)> skein_settings_of(const setting_ &...setting) {
    return {{setting..., SKEIN_END}};
}

template <size_t count_>
skein_status skein_body_add(skein_world *world, const char *kind, const skein_mesh *mesh,
                            const skein_settings<count_> &settings, skein_handle *handle) {
    return skein_body_add(world, kind, mesh, settings.list, handle);
}
template <size_t count_>
skein_status skein_constraint_add(skein_world *world, const char *kind, const uint32_t *particles, size_t count,
                                  const skein_settings<count_> &settings, skein_handle *handle) {
    return skein_constraint_add(world, kind, particles, count, settings.list, handle);
}
template <size_t count_>
skein_status skein_constraint_arity(skein_world *world, const char *kind, const skein_settings<count_> &settings,
                                    size_t *arity) {
    return skein_constraint_arity(world, kind, settings.list, arity);
}
template <size_t count_>
skein_status skein_force_add(skein_world *world, const char *kind, const skein_settings<count_> &settings,
                             skein_handle *handle) {
    return skein_force_add(world, kind, settings.list, handle);
}
template <size_t count_>
skein_status skein_collider_add(skein_world *world, const char *kind, const skein_settings<count_> &settings,
                                skein_handle *handle) {
    return skein_collider_add(world, kind, settings.list, handle);
}
template <size_t count_>
skein_status skein_collider_add_mesh(skein_world *world, const char *kind, const skein_mesh *mesh,
                                     const skein_settings<count_> &settings, skein_handle *handle) {
    return skein_collider_add_mesh(world, kind, mesh, settings.list, handle);
}
template <size_t count_>
skein_status skein_method_set(skein_world *world, const char *kind, const skein_settings<count_> &settings) {
    return skein_method_set(world, kind, settings.list);
}
#endif
#endif
