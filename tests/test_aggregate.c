/* Aggregates of a mesh: what swings is firm and keeps its time, nothing gains momentum, and the bits are the same for any threads, from
 * snapshots, and where indices are used again. */
#include <skein/cut.h>

#include "irregular.h"
#include "swing.h"
#include "world/world.h"

static const double dt = 1.0 / 60;
static const char corners[] = "sphere -0.5 0 -0.5 0.001, sphere 0.5 0 -0.5 0.001";

static skein_world *swinging(uint32_t side, int substeps, int threads, double drag) {
    skein_world_desc desc = skein_default_world_desc();
    desc.thread_count = threads;
    skein_world *world = skein_world_create(&desc, NULL);
    OK(world, skein_method_set(world, "xpbd", SKEIN_SETTINGS(SKEIN_REAL("substeps", substeps))));
    add_irregular(world, side, SKEIN_SETTINGS(SKEIN_TEXT("pins", corners)));
    add_gravity(world);
    if (drag > 0) OK(world, skein_force_add(world, "drag", SKEIN_SETTINGS(SKEIN_REAL("rate", drag)), NULL));
    return world;
}

static size_t count_aggregates(const skein_world *world) {
    size_t count = 0;
    for (size_t i = 0; i < world->rules.batches.count; i++) count += world->rules.batches.data[i]->aggregate != NULL;
    return count;
}

/* Which clothes have them: large ones that are pinned, no grids, and that do not tear. */
static void large_pinned_meshes_have_them(void **state) {
    (void)state;
    skein_world *world = swinging(50, 5, 1, 0);
    assert_true(count_aggregates(world) >= 3);
    for (size_t i = 0; i < world->rules.batches.count; i++) {
        const sk_aggregate *a = world->rules.batches.data[i]->aggregate;
        for (size_t k = 0; a && k < a->count; k++) { // shares of a whole
            double sum = 0;
            for (size_t s = a->start[k]; s < a->start[k + 1]; s++) sum += (double)a->share[s];
            assert_near(sum, 1, 1e-5);
            assert_true(a->start[k + 1] > a->start[k]);
            assert_int_equal(a->start[k] % 2, 0);
        }
        for (size_t h = 0; a && h < a->hub_count; h++) { // parts of a mean
            double sum = (double)a->own[h];
            for (size_t s = a->first_part[h]; s < a->first_part[h + 1]; s++) sum += (double)a->part[s];
            assert_int_equal(a->first_part[h] % 2, 0);
            if (!a->pinned[h]) assert_near(sum, 1, 1e-5);
        }
        if (a) assert_in_range(a->start[a->count], 1, a->share_count);
        if (a) assert_in_range(a->first_part[a->hub_count], 1, a->part_count);
    }
    skein_world_destroy(world);
    for (int k = 0; k < 3; k++) {
        world = new_world("xpbd", 5);
        if (k == 0) add_irregular(world, 20, SKEIN_SETTINGS(SKEIN_TEXT("pins", corners)));
        if (k == 1) add_irregular(world, 50, NULL);
        if (k == 2)
            add_irregular(world, 50, SKEIN_SETTINGS(SKEIN_TEXT("pins", corners), SKEIN_REAL("stretch.tear", 0.5)));
        assert_int_equal(count_aggregates(world), 0);
        skein_world_destroy(world);
    }
}

static size_t count_spans(const skein_world *world) {
    size_t count = 0;
    for (size_t i = 0; i < world->rules.batches.count; i++)
        count += !strcmp(world->rules.batches.data[i]->label, "span");
    return count;
}

/* Dropped on a ball, without pins: at most 17 % of stretch, where it was 39 without spans. A balloon has none, or it could not grow. */
static void what_is_dropped_is_firm(void **state) {
    (void)state;
    static const double half[3] = {0.5, 0.5, 0.5};
    skein_world *world = new_world("xpbd", 10);
    add_gravity(world);
    OK(world, skein_collider_add(world, "sphere", SKEIN_SETTINGS(SKEIN_REAL("radius", 0.25)), NULL));
    OK(world, skein_collider_add(world, "plane", SKEIN_SETTINGS(SKEIN_REAL("offset", -0.3)), NULL));
    add_irregular(world, 64, SKEIN_SETTINGS(SKEIN_VEC3("position", 0.05, 0.4, 0)));
    assert_int_equal(count_spans(world), 2);
    double most = 0;
    for (int f = 0; f < 60; f++) {
        steps(world, 1, dt);
        most = fmax(most, statistics_of(world).max_stretch);
    }
    assert_under(most, 0.25);
    skein_world_destroy(world);
    world = new_world("xpbd", 10);
    add_irregular_sack(world, 30, 60, half, NULL);
    assert_int_equal(count_spans(world), 0);
    skein_world_destroy(world);
}

/* Let go from level. With spans alone it is as firm, but 128 x 128 is not: the 99th percentile is 3.8 % instead of 2.8. */
static void a_mesh_that_swings_is_firm(void **state) {
    (void)state;
    ONLY_IN_PLAIN_BUILDS();
    skein_world *world = swinging(64, 10, 1, 0.3);
    double most = 0, p99 = 0;
    for (int n = 0; n < 110; n++) {
        steps(world, 1, dt);
        most = fmax(most, statistics_of(world).max_stretch), p99 = fmax(p99, statistics_of(world).p99_stretch);
    }
    assert_under(p99, 0.034);
    assert_under(most, 0.14);
    skein_world_destroy(world);
}

static double time_of_swing(uint32_t side, int substeps) {
    return time_of_swing_of(swinging(side, substeps, 1, 0), (size_t)side * side, -0.5);
}

static void a_swing_keeps_its_time(void **state) {
    (void)state;
    ONLY_IN_PLAIN_BUILDS();
    const double few = time_of_swing(64, 10), many = time_of_swing(64, 60),
                 small = time_of_swing(30, 60); // which has spans alone
    assert_true(many > 1 && many < 2);
    assert_near(few, many, 0.02 * many);
    assert_near(small, many, 0.02 * many);
}

/* A mesh that was pinned, and is free now, is thrown apart. */
static void nothing_gains_momentum(void **state) {
    (void)state;
    ONLY_IN_PLAIN_BUILDS();
    skein_world *world = new_world("xpbd", 10);
    add_irregular(world, 52, SKEIN_SETTINGS(SKEIN_TEXT("pins", corners), SKEIN_REAL("stretch.tether", 0.001)));
    assert_true(count_aggregates(world) > 2);
    const size_t count = skein_particle_count(world);
    double *v = malloc(3 * count * sizeof *v), all = 0;
    for (size_t k = 0; k < count; k++) {
        vec3 x = position_of(world, k);
        v[3 * k] = 3 * x.x + 2 * x.x * x.x, v[3 * k + 1] = sin(7 * x.x) + 2 * x.z, v[3 * k + 2] = 2 * x.z + x.x;
        all += fabs(v[3 * k]) * 0.2 / (double)count;
        OK(world, skein_particle_pin(world, k, false));
    }
    OK(world, skein_velocities_set(world, 0, count, v));
    skein_statistics before = statistics_of(world);
    // tethers pull to where the pins were: without them
    for (size_t i = 0; i < world->rules.limits.count; i++) {
        static const double infinite = INFINITY;
        world->rules.limits.data[i]->bound = &infinite;
    }
    steps(world, 20, dt);
    skein_statistics after = statistics_of(world);
    for (int k = 0; k < 3; k++) assert_near(after.momentum[k], before.momentum[k], 2e-4 * all);
    assert_true(after.kinetic_energy < before.kinetic_energy);
    free(v);
    skein_world_destroy(world);
}

enum { STEPS = SPARING ? 3 : 12 };

static void the_bits_are_the_same(void **state) {
    (void)state;
    skein_world *world = swinging(48, 4, 1, 0.3);
    steps(world, STEPS / 2, dt);
    const size_t size = skein_snapshot_size(world);
    void *bytes = malloc(size);
    OK(world, skein_snapshot_write(world, bytes, size, NULL));
    steps(world, STEPS - STEPS / 2, dt);
    const uint64_t hash = skein_world_hash(world);
    for (int threads = 2; threads < 4; threads++) {
        skein_world *other = swinging(48, 4, threads, 0.3), *later = swinging(48, 4, threads, 0.3);
        steps(other, STEPS, dt);
        assert_true(skein_world_hash(other) == hash);
        steps(later, 2, dt);
        OK(later, skein_snapshot_read(later, bytes, size));
        steps(later, STEPS - STEPS / 2, dt);
        assert_true(skein_world_hash(later) == hash);
        skein_world_destroy(other);
        skein_world_destroy(later);
    }
    free(bytes);
    skein_world_destroy(world);
    // one that comes where another was
    world = skein_world_create(NULL, NULL);
    OK(world, skein_method_set(world, "xpbd", SKEIN_SETTINGS(SKEIN_REAL("substeps", 4))));
    OK(world, skein_body_add(world, "cloth", NULL, SKEIN_SETTINGS(SKEIN_PAIR("grid", 60, 60)), NULL));
    add_particle(world, 0, 9, 9, 9); // behind it
    OK(world, skein_remove(world, skein_object_at(world, SKEIN_BODY, 0)));
    add_irregular(world, 48, SKEIN_SETTINGS(SKEIN_TEXT("pins", corners)));
    add_gravity(world);
    OK(world, skein_force_add(world, "drag", SKEIN_SETTINGS(SKEIN_REAL("rate", 0.3)), NULL));
    skein_surface surface;
    OK(world, skein_body_surface(world, skein_object_at(world, SKEIN_BODY, 0), &surface));
    assert_int_equal(surface.first_particle, 0);
    skein_world *fresh = swinging(48, 4, 1, 0.3);
    steps(world, STEPS, dt);
    steps(fresh, STEPS, dt);
    for (size_t i = 0; i < 48 * 48; i++) assert_true(length3(minus(position_of(world, i), position_of(fresh, i))) == 0);
    skein_world_destroy(world);
    skein_world_destroy(fresh);
}

/* After a cut nothing pulls across it; mended, all is as it was. */
static void a_cut_takes_them_away(void **state) {
    (void)state;
    skein_world *world = swinging(46, 4, 1, 1);
    const skein_handle body = skein_object_at(world, SKEIN_BODY, 0);
    const double blade[3][3] = {{-9, 9, 0.01}, {9, 9, 0.01}, {0, -9, 0.01}}; // the lower half goes
    size_t cut;
    OK(world, skein_cut(world, body, blade, &cut));
    assert_true(cut > 40);
    steps(world, STEPS, dt);
    vec3 low = position_of(world, 45 * 46 * (uint64_t)7919 % (46 * 46));
    const double t = STEPS * dt;
    assert_near(low.y, -0.5 * 9.81 * t * t, 0.2 * 9.81 * t * t); // it falls freely, but for the air
    assert_int_equal(statistics_of(world).nonfinite, 0);
    OK(world, skein_cut_mend(world, body));
    OK(world, skein_world_reset(world));
    skein_world *whole = swinging(46, 4, 1, 1);
    steps(world, 3, dt);
    steps(whole, 3, dt);
    assert_true(skein_world_hash(world) == skein_world_hash(whole));
    skein_world_destroy(whole);
    skein_world_destroy(world);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(large_pinned_meshes_have_them), cmocka_unit_test(a_mesh_that_swings_is_firm),
        cmocka_unit_test(what_is_dropped_is_firm),       cmocka_unit_test(a_swing_keeps_its_time),
        cmocka_unit_test(nothing_gains_momentum),        cmocka_unit_test(the_bits_are_the_same),
        cmocka_unit_test(a_cut_takes_them_away),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
