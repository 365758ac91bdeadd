/* A flock: 500 birds that keep apart, fly alike and stay together, and a hawk that the program leads; how alike they fly,
 * before and after. */
#include <math.h>
#include <skein/skein.h>
#include <stdio.h>
#include <stdlib.h>

enum { BIRDS = 500 };

/* 1: all fly the same way, 0: each its own. */
static double order(const skein_world *world) {
    static double v[3 * BIRDS];
    double sum[3] = {0, 0, 0};
    if (skein_velocities_copy(world, 0, BIRDS, v)) return -1;
    for (size_t i = 0; i < BIRDS; i++) {
        double speed = sqrt(v[3 * i] * v[3 * i] + v[3 * i + 1] * v[3 * i + 1] + v[3 * i + 2] * v[3 * i + 2]);
        for (size_t k = 0; k < 3; k++) sum[k] += v[3 * i + k] / (speed > 0 ? speed : 1) / BIRDS;
    }
    return sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
}

static void check(const skein_world *world, skein_status status) {
    if (!status) return;
    fprintf(stderr, "flock: %s %s\n", skein_world_error(world)->where, skein_world_error(world)->message);
    exit(1);
}

int main(void) {
    const skein_setting birds[] = {SKEIN_REAL("count", BIRDS), SKEIN_VEC3("spread", 12, 12, 12), SKEIN_END};
    const skein_setting rules[] = {SKEIN_REAL("separation", 1), SKEIN_REAL("alignment", 2), SKEIN_REAL("cohesion", 1),
                                   SKEIN_END};
    const skein_setting hawk[] = {SKEIN_VEC3("position", 30, 0, 0), SKEIN_END};
    skein_handle predator;
    skein_error failure = {0};
    skein_world *world = skein_world_create(NULL, &failure);
    if (!world) return fprintf(stderr, "flock: %s\n", failure.message), 1;
    check(world, skein_method_set(world, "symplectic_euler", NULL));
    check(world, skein_body_add(world, "flock", NULL, birds, NULL));
    check(world, skein_force_add(world, "flocking", rules, NULL));
    check(world, skein_force_add(world, "predator", hawk, &predator));
    double before = order(world);
    for (int i = 0; i < 600; i++) {
        skein_value place = {3, {30 - 3 * skein_world_time(world), 0, 0}, NULL}; /* it comes nearer */
        check(world, skein_set(world, predator, "position", place));
        check(world, skein_world_step(world, SKEIN_DEFAULT_STEP));
    }
    double after = order(world);
    printf("%d birds, %.1f s: they flew %.0f %% alike, and now %.0f %%\n", BIRDS, skein_world_time(world), 100 * before,
           100 * after);
    skein_world_destroy(world);
    return !(after > 0.8 && before < 0.3);
}
