/* What the tests of the library share: short words for building worlds, stepping them and comparing numbers.
 *
 * Every helper fails the running test with the words of the world's own error, so that a test needs no
 * error handling of its own. All are inline: a test stays one program from one file. */
#ifndef SKEIN_TESTS_HELPERS_H
#define SKEIN_TESTS_HELPERS_H

#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>
#include <skein/skein.h>

#include "sparing.h"

#define COUNT(array_) (sizeof(array_) / sizeof *(array_))

/* One rounding of the library's numbers, relative. */
#define EPSILON (sizeof(skein_real) == sizeof(double) ? DBL_EPSILON : (double)FLT_EPSILON)

#define PI 3.14159265358979323846

/* For what runs long to prove physics: long runs show sanitizers nothing that a few steps would not, and with more digits, or
 * in WebAssembly, the physics is the same. */
#define PLAIN (!SPARING && sizeof(skein_real) == sizeof(float))
#define ONLY_IN_PLAIN_BUILDS() \
    do                         \
        if (!PLAIN) skip();    \
    while (0)

/* Of cases that are many of one sort, other builds take one in so many, from the first on. */
static inline bool is_spared(size_t number, size_t one_in) {
    return !PLAIN && number % one_in;
}

/* Tests are about threads where they ask for some: all of them share every step, whether that pays or not. */
__attribute__((constructor)) static void share_every_step(void) {
    setenv("SKEIN_THREADS", "always", 0);
}

static const char *const method_names[] = {"symplectic_euler", "xpbd"};

/* ---- Saying what went wrong ------------------------------------------------------------------- */

static inline void check_ok(const skein_world *world, skein_status status, const char *call, const char *file,
                            int line) {
    if (status == SKEIN_OK) return;
    fprintf(stderr, "%s: %s: %s: %s\n", call, skein_status_text(status), skein_world_error(world)->where,
            skein_world_error(world)->message);
    _assert_true(0, call, file, line);
}
#define OK(world_, call_) check_ok((world_), (call_), #call_, __FILE__, __LINE__)

/* The call fails with this status, and the world's error says so with a message that has `part` in it. */
static inline void check_fails(const skein_world *world, skein_status status, skein_status ought, const char *part,
                               const char *call, const char *file, int line) {
    const skein_error *error = skein_world_error(world);
    if (status == ought && error->status == ought && (strstr(error->message, part) || strstr(error->where, part)))
        return;
    fprintf(stderr, "%s: %s instead of %s; '%s': '%s', expected '%s'\n", call, skein_status_text(status),
            skein_status_text(ought), error->where, error->message, part);
    _assert_true(0, call, file, line);
}
#define FAILS(world_, ought_, part_, call_) \
    check_fails((world_), (call_), (ought_), (part_), #call_, __FILE__, __LINE__)

static inline void check_near(double is, double ought, double off, const char *what, const char *file, int line) {
    if (fabs(is - ought) <= off) return;
    fprintf(stderr, "%s is %.9g, expected %.9g +- %.3g (off by %.3g)\n", what, is, ought, off, is - ought);
    _assert_true(0, what, file, line);
}
#define assert_near(is_, ought_, off_) check_near((is_), (ought_), (off_), #is_, __FILE__, __LINE__)
/* Within a share of what it ought to be. */
#define assert_share(is_, ought_, share_) \
    check_near((is_), (ought_), (share_)*fabs((double)(ought_)), #is_, __FILE__, __LINE__)
#define assert_under(is_, most_) check_near((is_), 0, (most_), #is_, __FILE__, __LINE__)

/* ---- Worlds ------------------------------------------------------------------------------------- */

static inline skein_world *new_world(const char *method, int substeps) {
    skein_world *world = skein_world_create(NULL, NULL);
    assert_non_null(world);
    OK(world, skein_method_set(world, method, SKEIN_SETTINGS(SKEIN_REAL("substeps", substeps))));
    return world;
}

static inline void add_gravity(skein_world *world) {
    OK(world, skein_force_add(world, "gravity", NULL, NULL));
}

/* One particle; a mass of 0 holds it. */
static inline uint32_t add_moving(skein_world *world, double mass, double x, double y, double z, double vx, double vy,
                                  double vz) {
    uint32_t first;
    OK(world, skein_particles_add(world, 1, (const double[]){x, y, z}, (const double[]){vx, vy, vz}, &mass, &first));
    return first;
}

static inline uint32_t add_particle(skein_world *world, double mass, double x, double y, double z) {
    return add_moving(world, mass, x, y, z, 0, 0, 0);
}

static inline void add_spring(skein_world *world, uint32_t a, uint32_t b, double stiffness, double damping) {
    OK(world,
       skein_constraint_add(world, "distance", (const uint32_t[]){a, b}, 1,
                            SKEIN_SETTINGS(SKEIN_REAL("stiffness", stiffness), SKEIN_REAL("damping", damping)), NULL));
}

static inline void steps(skein_world *world, int count, double dt) {
    for (int i = 0; i < count; i++) OK(world, skein_world_step(world, dt));
}

typedef struct vec3 {
    double x, y, z;
} vec3;

static inline vec3 position_of(const skein_world *world, size_t particle) {
    vec3 p;
    OK(world, skein_positions_copy(world, particle, 1, &p.x));
    return p;
}

static inline vec3 velocity_of(const skein_world *world, size_t particle) {
    vec3 v;
    OK(world, skein_velocities_copy(world, particle, 1, &v.x));
    return v;
}

static inline skein_statistics statistics_of(skein_world *world) {
    skein_statistics s;
    OK(world, skein_world_statistics(world, &s));
    return s;
}

static inline void place_particle(skein_world *world, size_t particle, double x, double y, double z) {
    OK(world, skein_positions_set(world, particle, 1, (const double[]){x, y, z}));
}

static inline void throw_particle(skein_world *world, size_t particle, double x, double y, double z) {
    OK(world, skein_velocities_set(world, particle, 1, (const double[]){x, y, z}));
}

/* ---- Numbers ------------------------------------------------------------------------------------ */

static inline double length3(vec3 a) {
    return sqrt(a.x * a.x + a.y * a.y + a.z * a.z);
}

static inline vec3 minus(vec3 a, vec3 b) {
    return (vec3){a.x - b.x, a.y - b.y, a.z - b.z};
}

/* A random number in [low, high), the same in every run. */
static inline double random_between(uint64_t *seed, double low, double high) {
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    return low + (high - low) * (double)(*seed >> 11) / 9007199254740992.0;
}

#endif
