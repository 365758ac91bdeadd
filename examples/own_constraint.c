/* A constraint of one's own: a leash, which is felt only when it is taut. A ball on it is thrown up: until the leash is taut
 * it flies as if there were none, and then it is never farther away than the leash is long. */
#include <math.h>
#include <skein/kinds.h>
#include <stdio.h>

static const skein_field leash_fields[] = {
    SKEIN_FIELD_OF_FORMULA("reach", "m", 1, 0, 1e6, "the farthest that one end gets from the other"),
};
static const skein_constraint_type leash = {
    .kind = {"leash", "two particles are at most so far apart", SKEIN_CONSTRAINT, leash_fields, 1, 0},
    .formula = "reach >= length(p0 - p1)",
};

const skein_kind *const skein_module_kinds[] = {&leash.kind, NULL}; // so that the command can have it, too

int main(void) {
    skein_error error = {SKEIN_OK, "", ""};
    skein_kinds *kinds = skein_kinds_create(&error);
    if (!kinds || skein_kind_register(kinds, &leash.kind, &error))
        return fprintf(stderr, "own_constraint: %s %s\n", error.where, error.message), 1;
    skein_world_desc desc = skein_default_world_desc();
    desc.kinds = kinds;
    skein_world *world = skein_world_create(&desc, &error);
    const double positions[] = {0, 0, 0, 0.1, 0, 0}, velocities[] = {0, 0, 0, 1, 2, 0}, masses[] = {0, 0.2};
    const uint32_t ends[] = {0, 1};
    bool good =
        world && !skein_method_set(world, "xpbd", SKEIN_SETTINGS(SKEIN_REAL("substeps", 40))) &&
        !skein_particles_add(world, 2, positions, velocities, masses, NULL) &&
        !skein_force_add(world, "gravity", NULL, NULL) &&
        !skein_constraint_add(world, "leash", ends, 1,
                              SKEIN_SETTINGS(SKEIN_REAL("reach", 0.8), SKEIN_REAL("stiffness", INFINITY)), NULL);
    double x[3] = {0, 0, 0}, flight = 0, farthest = 0;
    for (int i = 1; good && i <= 240; i++) {
        good = !skein_world_step(world, 1.0 / 60) && !skein_positions_copy(world, 1, 1, x);
        double t = i / 60.0;
        if (i == 12) flight = hypot(x[0] - (0.1 + t), x[1] - (2 * t - 9.81 * t * t / 2)); // still slack
        farthest = fmax(farthest, hypot(x[0], x[1]));
    }
    if (!good) fprintf(stderr, "own_constraint: %s\n", skein_world_error(world)->message);
    printf("%.0f mm off free flight while slack; at most %.3f m away on a leash of 0.8 m\n", 1e3 * flight, farthest);
    skein_world_destroy(world);
    skein_kinds_destroy(kinds);
    return good && flight < 0.01 && farthest > 0.79 && farthest < 0.808 ? 0 : 1;
}
