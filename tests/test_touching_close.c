/* What begins in one place, or is pinned nearer to each other than the thickness of contact: it comes apart where it can, nothing goes through
 * anything, and nobody gains energy of it. */
#include "crossings.h"

static const double step_length = 1.0 / 60, thickness = 0.005;

static void add_sheet(skein_world *world, uint32_t side, const char *pins, double turn, vec3 at) {
    OK(world,
       skein_body_add(world, "cloth", NULL,
                      SKEIN_SETTINGS(SKEIN_PAIR("grid", side, side), SKEIN_TEXT("pins", pins),
                                     SKEIN_VEC3("rotation", turn, 0, 0), SKEIN_VEC3("position", at.x, at.y, at.z)),
                      NULL));
}

static skein_world *new_close_world(const char *method) {
    skein_world *world = new_world(method, 10);
    add_gravity(world);
    OK(world, skein_force_add(world, "contact", SKEIN_SETTINGS(SKEIN_REAL("thickness", thickness)), NULL));
    return world;
}

static double mean_height(const skein_world *world, size_t first, size_t count) {
    double sum = 0;
    for (size_t i = 0; i < count; i++) sum += position_of(world, first + i).y;
    return sum / (double)count;
}

/* Two sheets in one place, level or upright, with equal vertices or others. Where rounding chose who is on which side of whom, they
 * gained up to 45 J in 4 s, and crossed; 0.4 kg that fall by half a metre have 2 J. */
static void what_begins_in_one_place_comes_apart(void **state) {
    (void)state;
    static const char *const methods[] = {"xpbd", "pbd", "backward_euler"};
    for (size_t m = 0; m < COUNT(methods); m++)
        for (int upright = 0; upright < (m < 2 ? 2 : 1); upright++) // the last takes long for crumpled ones
            for (uint32_t other = 9; other < 12; other += 2) {
                if (is_spared(m, 3)) continue;
                skein_world *world = new_close_world(methods[m]);
                OK(world, skein_collider_add(world, "plane", NULL, NULL));
                add_sheet(world, 9, "", 90 * upright, (vec3){0, 0.55, 0});
                add_sheet(world, other, "", 90 * upright, (vec3){0, 0.55, 0});
                crossing_search all = crossing_begin(world);
                double most = 0;
                for (int frame = 0; frame < 100; frame++) {
                    steps(world, 1, step_length);
                    most = fmax(most, statistics_of(world).kinetic_energy);
                    if (frame % 10 == 0) assert_int_equal(crossings_now(&all, world), 0);
                    assert_int_equal(statistics_of(world).crossings, 0);
                }
                assert_true(most < 2.2 && statistics_of(world).kinetic_energy < 5e-3);
                const size_t first = 9 * 9, count = (size_t)other * other;
                if (!upright)
                    assert_float_equal(mean_height(world, first, count) - mean_height(world, 0, first), thickness,
                                       0.0005);
                crossing_free(&all);
                skein_world_destroy(world);
            }
}

/* Curtains whose pinned edges leave each other too little room. Who touches right beside a pin was led apart at the far end of a
 * lever, and three such curtains had 1e9 J. */
static void what_is_pinned_too_near_stays_whole(void **state) {
    (void)state;
    static const struct {
        const char *method;
        double gap;
        int frames;
    } curtains[] = {{"xpbd", 0.001, 30}, {"xpbd", 0.003, 30}, {"pbd", 0.002, 30}, {"backward_euler", 0.003, 10}};
    for (size_t k = 0; k < COUNT(curtains); k++) {
        if (is_spared(k, 4)) continue;
        skein_world *world = new_close_world(curtains[k].method);
        OK(world, skein_force_add(world, "surface_wind", SKEIN_SETTINGS(SKEIN_VEC3("velocity", 0, 0, 3)), NULL));
        for (int i = 0; i < 3; i++)
            add_sheet(world, 8 + 2 * (uint32_t)i, "top edge", 90, (vec3){0, 0, curtains[k].gap * i});
        for (int frame = 0; frame < curtains[k].frames; frame++) {
            steps(world, 1, step_length);
            const skein_statistics s = statistics_of(world);
            if (s.crossings || !(s.kinetic_energy < 1.5) || !(s.max_stretch < 1))
                fail_msg("%s, %g m, frame %d: %zu crossings, %g J, stretched by %g", curtains[k].method,
                         curtains[k].gap, frame, s.crossings, s.kinetic_energy, s.max_stretch);
        }
        skein_world_destroy(world);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_begins_in_one_place_comes_apart),
        cmocka_unit_test(what_is_pinned_too_near_stays_whole),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
