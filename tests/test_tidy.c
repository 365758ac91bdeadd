/* Large flocks move in memory, and nobody can tell by the bits: neither beside a flock that stays, nor for several
 * threads, nor from the start again, nor under any method. */
#include "helpers.h"
#include "world/world.h"

enum { BIRDS = 36000 };

static const double dt = 1.0 / 60;

typedef struct allocations {
    bool refuse;
} allocations;

static void *allocate(void *user, size_t size, size_t alignment) {
    allocations *a = user;
    return a->refuse ? NULL : aligned_alloc(alignment, size);
}

static void release(void *user, void *memory, size_t size) {
    (void)user, (void)size;
    free(memory);
}

/* Two flocks, the rules over all or over one and the other; two pinned particles far away, tied to each other or not:
 * what is tied stays where it is. */
static skein_world *flocks(int threads, bool overlapping, bool tied, allocations *a) {
    skein_world_desc desc = skein_default_world_desc();
    desc.thread_count = threads;
    if (a) desc.allocate = allocate, desc.release = release, desc.memory_user = a;
    skein_world *world = skein_world_create(&desc, NULL);
    assert_non_null(world);
    OK(world, skein_method_set(world, "symplectic_euler", SKEIN_SETTINGS(SKEIN_REAL("substeps", 1))));
    for (int f = 0; f < 2; f++)
        OK(world, skein_body_add(
                      world, "flock", NULL,
                      SKEIN_SETTINGS(SKEIN_TEXT("name", f ? "many" : "few"), SKEIN_REAL("count", f ? BIRDS - 500 : 500),
                                     SKEIN_VEC3("spread", 40, 60, 40), SKEIN_REAL("speed", 20), SKEIN_REAL("seed", f)),
                      NULL));
    for (int f = 0; f < 2; f++)
        OK(world, skein_force_add(world, "flocking",
                                  SKEIN_SETTINGS(SKEIN_REAL("separation", f ? 1 : 0.6), SKEIN_REAL("alignment", 0.5),
                                                 SKEIN_REAL("cohesion", 0.5),
                                                 SKEIN_TEXT("on", f             ? "few"
                                                                  : overlapping ? ""
                                                                                : "many")),
                                  NULL));
    OK(world, skein_force_add(world, "attraction", NULL, NULL));
    OK(world, skein_force_add(world, "speed_limit", NULL, NULL));
    for (int i = 0; i < 2; i++)
        OK(world, skein_particles_add(world, 1, (const double[]){1e4, 0, i}, NULL, (const double[]){0}, NULL));
    if (tied) OK(world, skein_constraint_add(world, "distance", (const uint32_t[]){BIRDS, BIRDS + 1}, 1, NULL, NULL));
    return world;
}

/* How many slots do not follow the slot of the particle before; each particle's slot is its own. */
static size_t moved(const skein_world *world) {
    const sk_particles *all = &world->particles;
    size_t count = 0, taken = 0;
    for (size_t i = 1; i < all->count; i++) count += all->slot_of[i] != all->slot_of[i - 1] + 1;
    for (size_t i = 0; i < all->count; i++) assert_int_equal(all->particle_of[all->slot_of[i]], i);
    for (size_t s = 0; s < all->slot_count; s++) taken += all->particle_of[s] != SK_NOBODY;
    assert_int_equal(taken, all->count);
    return count;
}

/* Steps, the clock set so that the world is tidied after the first and the third. */
static uint64_t fly(skein_world *world) {
    for (int n = 0; n < 5; n++) {
        if (n == 2) world->steps = 64;
        OK(world, skein_world_step(world, dt));
    }
    return skein_world_hash(world);
}

static void a_flock_that_moves_in_memory_flies_the_same(void **state) {
    (void)state;
    for (int overlapping = 0; overlapping < 2; overlapping++) {
        skein_world *still = flocks(1, overlapping, true, NULL);
        uint64_t hash = fly(still);
        assert_int_equal(moved(still), 0);
        size_t count = skein_particle_count(still);
        double *middle = malloc(3 * count * sizeof *middle), *other = malloc(3 * count * sizeof *other);
        OK(still, skein_positions_blend(still, 0.5, 0, count, middle));
        for (int threads = SPARING ? 3 : 1; threads < 4; threads++) {
            skein_world *world = flocks(threads, overlapping, false, NULL);
            assert_true(fly(world) == hash);
            assert_true(moved(world) > BIRDS / 2);
            OK(world, skein_positions_blend(world, 0.5, 0, count, other));
            assert_memory_equal(middle, other, 3 * count * sizeof *other);
            if (threads < 3) {
                skein_world_destroy(world);
                continue;
            }
            // from the start again, though slots are elsewhere by now
            OK(world, skein_world_reset(world));
            OK(still, skein_world_reset(still));
            assert_true(fly(world) == fly(still));
            skein_world_destroy(world);
        }
        skein_world_destroy(still);
        free(middle);
        free(other);
    }
}

static void order_is_measured_wherever_slots_are(void **state) {
    (void)state;
    skein_world *world[] = {flocks(1, false, true, NULL), flocks(1, false, false, NULL)};
    skein_order o[2];
    for (int w = 0; w < 2; w++) {
        fly(world[w]);
        OK(world[w], skein_order_measure(world[w], 300, 2000, (const double[]){0, 0, 0}, 2, &o[w]));
        skein_world_destroy(world[w]);
    }
    assert_memory_equal(&o[0], &o[1], sizeof o[0]);
}

static void moving_takes_no_memory(void **state) {
    (void)state;
    allocations a = {.refuse = false};
    skein_world *world = flocks(1, true, false, &a), *same = flocks(1, true, true, NULL);
    world->steps = 1; // not the first: what a step itself needs is there after it
    OK(world, skein_world_step(world, dt));
    OK(same, skein_world_step(same, dt));
    assert_int_equal(moved(world), 0);
    world->steps = 64;
    a.refuse = true;
    for (int n = 0; n < 2; n++) {
        OK(world, skein_world_step(world, dt));
        OK(same, skein_world_step(same, dt));
    }
    assert_true(moved(world) > BIRDS / 2);
    assert_true(skein_world_hash(world) == skein_world_hash(same));
    a.refuse = false;
    // more particles, and all are arranged anew
    for (int w = 0; w < 2; w++) {
        skein_world *it = w ? same : world;
        OK(it, skein_particles_add(it, 1, (const double[]){1, 2, 3}, NULL, (const double[]){1}, NULL));
        OK(it, skein_world_step(it, dt));
        OK(it, skein_world_step(it, dt));
    }
    assert_true(skein_world_hash(world) == skein_world_hash(same));
    skein_world_destroy(world);
    skein_world_destroy(same);
}

/* Every method, whatever it keeps from step to step; some birds are nowhere. */
static void under_every_method_the_bits_stay(void **state) {
    (void)state;
    ONLY_IN_PLAIN_BUILDS();
    if (sizeof(skein_real) == sizeof(double)) skip(); // takes long there, and has nothing of its own
    for (size_t m = 0;; m++) {
        const skein_kind *method = skein_kind_at(SKEIN_METHOD, m);
        if (!method) break;
        skein_world *world[] = {flocks(1, true, true, NULL), flocks(1, true, false, NULL)};
        for (int w = 0; w < 2; w++) {
            OK(world[w], skein_method_set(world[w], method->name, SKEIN_SETTINGS(SKEIN_REAL("substeps", 1))));
            OK(world[w], skein_force_add(world[w], "drag", SKEIN_SETTINGS(SKEIN_REAL("rate", 0.3)), NULL));
            OK(world[w], skein_particle_pin(world[w], 700, true));
            world[w]->particles.vector[SK_X][world[w]->particles.slot_of[700]].x = SK_REAL_MAX / 2; // in no cell
            for (int n = 0; n < 3; n++) {
                if (n == 1) world[w]->steps = 64;
                OK(world[w], skein_world_step(world[w], dt));
            }
        }
        assert_true(skein_world_hash(world[0]) == skein_world_hash(world[1]));
        assert_true(!strcmp(method->name, "backward_euler") || moved(world[1]) > BIRDS / 2);
        for (int w = 0; w < 2; w++) skein_world_destroy(world[w]);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_flock_that_moves_in_memory_flies_the_same),
        cmocka_unit_test(order_is_measured_wherever_slots_are),
        cmocka_unit_test(moving_takes_no_memory),
        cmocka_unit_test(under_every_method_the_bits_stay),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
