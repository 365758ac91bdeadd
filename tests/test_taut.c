/* Who is held back by contact does not tear off his neighbours (src/contact/taut.c). */
#include "irregular.h"

/* A tube of irregular triangles, of which every other row and column is a third as wide, so that light corners lie between heavy
 * ones; it falls on the ground at 4 m/s, which is 7 mm a substep, and its edges are 1.5 and 8.5 mm. */
static void what_crumples_does_not_tear(void **state) {
    (void)state;
    ONLY_IN_PLAIN_BUILDS();
    enum { ALONG = 80, AROUND = 40, FRAMES = 8 };
    const double edge = 0.005, thin = 0.3, turn = 2 * PI / AROUND;
    skein_world *world = new_world("xpbd", 10);
    skein_mesh mesh = irregular_mesh(ALONG, AROUND, true);
    double *p = (double *)mesh.positions;
    for (size_t i = 0; i < 3 * mesh.vertex_count; i += 3) {
        double at[2] = {p[i], p[i + 2]};
        for (int k = 0; k < 2; k++) {
            const double first = 2 * floor(at[k] / 2), on = at[k] - first;
            at[k] = first + (on < 1 ? on * thin : thin + (on - 1) * (2 - thin));
        }
        const double angle = turn * at[0], radius = edge / turn;
        p[i] = radius * cos(angle), p[i + 1] = edge * at[1], p[i + 2] = radius * sin(angle);
    }
    add_and_free(world, mesh, p,
                 SKEIN_SETTINGS(SKEIN_VEC3("position", 0, 0.01, 0), SKEIN_VEC3("rotation", 3, 0, 2), SKEIN_VEC3("velocity", 0, -4, 0)));
    add_gravity(world);
    OK(world, skein_collider_add(world, "plane", NULL, NULL));
    OK(world, skein_force_add(world, "contact", SKEIN_SETTINGS(SKEIN_REAL("thickness", 0.001)), NULL));
    double most = 0;
    for (int frame = 1; frame <= FRAMES; frame++) {
        steps(world, 1, 1.0 / 60);
        if (frame >= 4) most = fmax(most, statistics_of(world).p99_stretch);
    }
    assert_under(most, 0.35); // 0.26; where only pairs hold back, 0.50
    skein_world_destroy(world);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(what_crumples_does_not_tear)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
