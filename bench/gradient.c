/* What a gradient of a run costs, in runs: a cloth of 20 x 20 that swings from its top edge, its gradient by all start
 * positions and velocities and three stiffnesses.
 *
 *     build/skein_bench_gradient [FRAMES [TIMES]]
 *
 * Prints the least processor time of so many runs and of so many gradients, with all states kept and with checkpoints. */
#include <math.h>
#include <skein/gradient.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

#define NUMBER(name_, value_)       \
    {                               \
        name_, {                    \
            1, {value_, 0, 0}, NULL \
        }                           \
    }
static const skein_setting end = {NULL, {0, {0, 0, 0}, NULL}};

static double seconds(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* Half the sum of the last state's squares. */
static double measure(void *user, const skein_gradient_state *state) {
    double sum = 0;
    if (state->step != *(const size_t *)user) return 0;
    for (size_t i = 0; i < 3 * state->particle_count; i++) {
        sum += 0.5 * state->positions[i] * state->positions[i];
        state->by_positions[i] = state->positions[i];
    }
    return sum;
}

static skein_world *make(const char *method, int substeps) {
    skein_world_desc desc = skein_default_world_desc();
    desc.thread_count = 1;
    skein_world *world = skein_world_create(&desc, NULL);
    const skein_setting of_method[] = {NUMBER("substeps", substeps), end}, drag[] = {NUMBER("rate", 2), end};
    const skein_setting cloth[] = {{"grid", {2, {20, 20, 0}, NULL}},    {"pins", {0, {0, 0, 0}, "top edge"}},
                                   {"rotation", {3, {60, 0, 0}, NULL}}, NUMBER("stretch.tether", (double)INFINITY),
                                   NUMBER("stretch.stiffness", 100),    NUMBER("shear.stiffness", 20),
                                   NUMBER("bend.rigidity", 1e-4),       end};
    bool good = world && !skein_method_set(world, method, of_method) &&
                !skein_body_add(world, "cloth", NULL, cloth, NULL) && !skein_force_add(world, "gravity", NULL, NULL) &&
                !skein_force_add(world, "drag", drag, NULL);
    if (good) return world;
    fprintf(stderr, "skein_bench_gradient: %s\n", world ? skein_world_error(world)->message : "out of memory");
    exit(1);
}

static void compare(const char *method, int substeps, size_t frames, int times) {
    skein_world *world = make(method, substeps);
    double *by = malloc(6 * skein_particle_count(world) * sizeof *by), by_field[3],
           least[3] = {INFINITY, INFINITY, INFINITY};
    const char *const fields[] = {"bodies.0.stretch.stiffness", "bodies.0.shear.stiffness", "bodies.0.bend.rigidity",
                                  NULL};
    for (int t = 0; t < 3 * times && by; t++) {
        skein_gradient_desc desc = {1 / 60.0, frames, measure, &frames, fields, t % 3 == 2}; // 1 byte: checkpoints
        skein_gradient_result result = {0, by, by + 3 * skein_particle_count(world), by_field};
        skein_world_reset(world);
        double began = seconds();
        for (size_t i = 0; i < frames && t % 3 == 0; i++) skein_world_step(world, 1 / 60.0);
        if (t % 3 && skein_gradient(world, &desc, &result)) {
            fprintf(stderr, "skein_bench_gradient: %s\n", skein_world_error(world)->message);
            exit(1);
        }
        least[t % 3] = fmin(least[t % 3], seconds() - began);
    }
    printf("%-17s %2d substeps, %zu frames: a run %.3g s; its gradient %.2f runs, with checkpoints %.2f\n", method,
           substeps, frames, least[0], least[1] / least[0], least[2] / least[0]);
    free(by);
    skein_world_destroy(world);
}

int main(int count, char **words) {
    size_t frames = count > 1 ? (size_t)strtoul(words[1], NULL, 10) : 40;
    int times = count > 2 ? atoi(words[2]) : 5;
    compare("symplectic_euler", 16, frames ? frames : 1, times);
    compare("backward_euler", 2, frames ? frames : 1, times);
    compare("xpbd", 16, frames ? frames : 1, times);
    return 0;
}
