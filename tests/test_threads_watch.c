/* Sweeps over bounds pass over what has not moved since it was found within them (plan/op.h, sk_watch): that changes no bit. Held against the same
 * worlds, where all is looked at. */
#include "irregular.h"
#include "world/world.h"

enum { FRAMES = SPARING ? 12 : 60 };

typedef struct watching {
    const char *name, *method;
    int substeps, side;
    bool irregular, touches, limited, tied, torn, driven;
    const char *collider;
} watching;

static void add_cloth(skein_world *world, const watching *c, double height) {
    const skein_setting *all = SKEIN_SETTINGS(
        SKEIN_PAIR("grid", c->side, c->side + 3), SKEIN_VEC3("position", 0.013, height, 0.017),
        SKEIN_VEC3("rotation", 3, 20, 5), SKEIN_TEXT("fabric", c->limited ? "none" : "cotton"),
        SKEIN_REAL("stretch.limit", c->limited ? 0.02 : INFINITY), SKEIN_REAL("stretch.tear", c->torn ? 0.04 : 0));
    if (c->irregular) add_irregular(world, (uint32_t)c->side, all + 1); // which is no grid
    else OK(world, skein_body_add(world, "cloth", NULL, all, NULL));
}

static skein_world *new_watched(const watching *c, int threads) {
    skein_world_desc desc = skein_default_world_desc();
    desc.thread_count = threads;
    skein_world *world = skein_world_create(&desc, NULL);
    assert_non_null(world);
    OK(world, skein_method_set(world, c->method, SKEIN_SETTINGS(SKEIN_REAL("substeps", c->substeps))));
    add_gravity(world);
    if (c->touches) OK(world, skein_force_add(world, "contact", NULL, NULL));
    OK(world, skein_collider_add(world, "plane", NULL, NULL));
    OK(world, skein_collider_add(world, c->collider,
                                 SKEIN_SETTINGS(SKEIN_VEC3("centre", 0, 0.4, 0),
                                                SKEIN_VEC3("motion.velocity", c->driven, 0, 0),
                                                SKEIN_REAL("motion.spin", c->driven ? 2 : 0)),
                                 NULL));
    add_cloth(world, c, 1.02);
    if (c->side < 70) add_cloth(world, c, 1.06); // else a repeat is one walk (world/run.c)
    if (c->tied) {                               // one body's edges hold the other
        const uint32_t pairs[] = {3, (uint32_t)skein_particle_count(world) - 4, 40,
                                  (uint32_t)skein_particle_count(world) - 41};
        OK(world, skein_constraint_add(world, "distance", pairs, 2, SKEIN_SETTINGS(SKEIN_REAL("stiffness", 1e4)), NULL));
    }
    return world;
}

/* Whether any edges were found within their bound, so that they could be passed over. */
static bool was_any_found(const skein_world *world) {
    bool any = false;
    for (size_t i = 0; i < world->rules.batches.count; i++) {
        const sk_batch *batch = world->rules.batches.data[i];
        for (size_t b = 0; b < batch->lane_count / SK_LANES; b++) any |= batch->found[b] > 0;
    }
    return any;
}

static void nothing_changes(void **state) {
    (void)state;
    static const watching cases[] = {
        {"large", "xpbd", 5, 70, false, false, false, false, false, false, "sphere"},
        {"grid", "xpbd", 10, 33, false, false, false, false, false, false, "sphere"},
        {"limited", "xpbd", 10, 24, false, false, true, false, false, false, "box"},
        {"irregular", "xpbd", 10, 25, true, false, false, false, false, false, "box"},
        {"irregular, limited", "xpbd", 5, 25, true, false, true, false, false, false, "sphere"},
        {"touching", "xpbd", 10, 20, false, true, false, false, false, false, "box"},
        {"touching, limited", "xpbd", 10, 16, true, true, true, false, false, false, "box"},
        {"driven", "xpbd", 10, 24, false, false, true, false, false, true, "box"},
        {"tied", "xpbd", 10, 20, false, false, true, true, false, false, "sphere"},
        {"torn", "xpbd", 10, 20, false, false, false, false, true, true, "box"},
        {"pbd", "pbd", 10, 20, false, false, true, false, false, false, "box"},
        {"forces", "symplectic_euler", 40, 12, false, false, true, false, false, false, "sphere"},
    };
    for (size_t c = 0; c < COUNT(cases); c++) {
        if (SPARING && c % 3) continue;
        uint64_t hash[3];
        for (int way = 0; way < 3; way++) {
            skein_world *world = new_watched(&cases[c], way == 2 ? 2 : 1);
            world->watch.never = way == 0;
            steps(world, FRAMES, 1.0 / 60);
            hash[way] = skein_world_hash(world);
            const bool watches = SK_WATCHES && strcmp(cases[c].name, "forces") != 0;
            assert_int_equal(world->watch.moved != NULL, watches);
            if (!way) assert_false(was_any_found(world));
            else if (!SPARING && watches) assert_true(was_any_found(world));
            skein_world_destroy(world);
        }
        if (hash[0] != hash[1] || hash[0] != hash[2]) fprintf(stderr, "%s\n", cases[c].name);
        assert_true(hash[0] == hash[1] && hash[0] == hash[2]);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(nothing_changes)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
