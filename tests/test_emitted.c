/* What the library runs is what stands in src/constraints/emitted/: with another formula there, things move otherwise.
 * (That the files are the emitter's is emitted.sh's to say.) */
#include "constraints/constraint.h"
#include "helpers.h"
#include "world/world.h"

extern const sk_constraint_type sk_distance, sk_changed_distance; // changed_distance.c

static double length_after(const sk_constraint_type *type, const char *method, double stiffness) {
    skein_world *world = new_world(method, 20);
    add_particle(world, 0, 0, 0, 0);
    add_particle(world, 1, 0.5, 0, 0);
    OK(world, skein_force_add(world, "drag", SKEIN_SETTINGS(SKEIN_REAL("rate", 20)), NULL));
    OK(world, sk_world_add_constraint(world, type, (const uint32_t[]){0, 1}, 1,
                                      SKEIN_SETTINGS(SKEIN_REAL("stiffness", stiffness)), NULL));
    steps(world, 120, 1.0 / 60);
    double length = position_of(world, 1).x;
    skein_world_destroy(world);
    return length;
}

/* The changed one wants to be twice as long as it was made. */
static void another_formula_moves_otherwise(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(method_names); m++) {
        assert_near(length_after(&sk_distance, method_names[m], 100), 0.5, 1e-4);
        assert_near(length_after(&sk_changed_distance, method_names[m], 100), 1, 1e-3);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(another_formula_moves_otherwise)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
