/* Rules for some bodies only: every force and collider, under every method, moves the bodies that it names and no
 * other, to the bit. */
#include "all_methods.h"
#include "gpu.h"

enum { NAMED, OTHER, BODIES };
enum { LOOSE_PARTICLES = 21, STEPS = 4 }; // no multiple of sixteen: blocks are shared

typedef struct two {
    skein_world *world;
    size_t first[BODIES], count[BODIES];
} two;

/* Two bodies beside each other, of which neither is at rest: flocks, or cloths. One is in the groups "chosen" and "few". */
static two make_two(const char *method, bool cloths, int threads) {
    skein_world_desc desc = skein_default_world_desc();
    desc.thread_count = threads;
    two t = {.world = skein_world_create(&desc, NULL)};
    OK(t.world, skein_method_set(t.world, method, SKEIN_SETTINGS(SKEIN_REAL("substeps", 3))));
    add_moving(t.world, 1, 9, 9, 9, 0.1, 0.2, 0.3); // somebody of no body
    for (int b = 0; b < BODIES; b++) {
        skein_handle body;
        skein_surface surface;
        const char *name = b == NAMED ? "named" : "other", *groups = b == NAMED ? "chosen, few" : "few or none";
        if (cloths)
            OK(t.world,
               skein_body_add(t.world, "cloth", NULL,
                              SKEIN_SETTINGS(SKEIN_PAIR("grid", 6, 7), SKEIN_TEXT("name", name),
                                             SKEIN_TEXT("groups", groups), SKEIN_REAL("stretch.stiffness", 100),
                                             SKEIN_REAL("shear.stiffness", 50), SKEIN_VEC3("position", 0, 0.3 * b, 0)),
                              &body));
        else
            OK(t.world, skein_body_add(t.world, "flock", NULL,
                                       SKEIN_SETTINGS(SKEIN_REAL("count", LOOSE_PARTICLES), SKEIN_TEXT("name", name),
                                                      SKEIN_TEXT("groups", groups), SKEIN_VEC3("spread", 1, 1, 1),
                                                      SKEIN_REAL("speed", 0.7)),
                                       &body));
        OK(t.world, skein_body_surface(t.world, body, &surface));
        t.first[b] = surface.first_particle, t.count[b] = surface.particle_count;
    }
    add_gravity(t.world);
    OK(t.world, skein_force_add(t.world, "drag", SKEIN_SETTINGS(SKEIN_REAL("rate", 0.2)), NULL));
    return t;
}

/* Settings with which the kind does something to those at the origin. */
static const skein_setting *settings_of(const char *kind) {
    static const struct {
        const char *kind;
        skein_setting settings[5];
    } known[] = {
        {"wind", {SKEIN_VEC3("force", 0.1, 0.2, 0.3)}},
        {"surface_wind", {SKEIN_VEC3("velocity", 3, 1, 2)}},
        {"drag", {SKEIN_REAL("linear", 0.1), SKEIN_REAL("quadratic", 0.2)}},
        {"separation", {SKEIN_REAL("radius", 0.7), SKEIN_REAL("strength", 0.5)}},
        {"speed_limit", {SKEIN_REAL("limit", 0.1)}},
        {"turn_limit", {SKEIN_REAL("turn", 60), SKEIN_REAL("climb", 20)}},
        {"bounds", {SKEIN_VEC3("size", 0.02, 0.02, 0.02)}},
        {"predator", {SKEIN_REAL("radius", 5)}},
        {"lookout", {SKEIN_REAL("clearance", 3)}},
        {"force_field", {SKEIN_TEXT("force", "vec3(1, 2, 3)")}},
        {"potential", {SKEIN_TEXT("energy", "3*p.x + dot(p, p)")}},
        {"plane", {SKEIN_REAL("offset", 0.2), SKEIN_REAL("restitution", 0.5)}},
        {"sphere", {SKEIN_VEC3("centre", 0, 0.1, 0), SKEIN_REAL("radius", 0.5)}},
        {"box", {SKEIN_VEC3("size", 0.7, 0.7, 0.7)}},
        {"capsule", {SKEIN_REAL("radius", 0.4)}},
        {"bowl", {SKEIN_REAL("radius", 0.3)}},
        {"formula", {SKEIN_TEXT("surface", "p.y - 0.1")}},
        {"field", {SKEIN_REAL("cell", 0.05)}},
    };
    for (size_t i = 0; i < COUNT(known); i++)
        if (!strcmp(known[i].kind, kind)) return known[i].settings;
    return NULL;
}

/* For colliders that are made from one: a cube about the origin. */
static const double block_points[8][3] = {{-0.35, -0.35, -0.35}, {0.35, -0.35, -0.35}, {-0.35, 0.35, -0.35},
                                          {0.35, 0.35, -0.35},   {-0.35, -0.35, 0.35}, {0.35, -0.35, 0.35},
                                          {-0.35, 0.35, 0.35},   {0.35, 0.35, 0.35}};
static const uint32_t block_sizes[6] = {4, 4, 4, 4, 4, 4},
                      block_corners[24] = {0, 2, 3, 1, 4, 5, 7, 6, 0, 1, 5, 4, 2, 6, 7, 3, 0, 4, 6, 2, 1, 3, 7, 5};
static const skein_mesh block = {&block_points[0][0], 8, block_sizes, 6, block_corners, 24};

static void add_rule(skein_world *world, const skein_kind *kind, const char *on) {
    skein_handle rule;
    // for the lookout to see
    if (!strcmp(kind->name, "lookout"))
        OK(world, skein_collider_add(world, "sphere",
                                     SKEIN_SETTINGS(SKEIN_REAL("radius", 0.01), SKEIN_VEC3("centre", 0, -2, 0)), NULL));
    if (kind->category == SKEIN_FORCE) OK(world, skein_force_add(world, kind->name, settings_of(kind->name), &rule));
    else
        OK(world, skein_collider_add_mesh(world, kind->name, skein_field_find(kind, "mesh", NULL) ? &block : NULL,
                                          settings_of(kind->name), &rule));
    OK(world, skein_set(world, rule, "on", skein_text(on)));
}

/* How many numbers of a body's state differ, and the farthest apart. */
static size_t differ(const two *a, const two *b, int body, double *worst) {
    double x[2][3 * 64], v[2][3 * 64];
    size_t count = 0;
    *worst = 0;
    const two *both[2] = {a, b};
    for (int w = 0; w < 2; w++) {
        OK(both[w]->world, skein_positions_copy(both[w]->world, both[w]->first[body], both[w]->count[body], x[w]));
        OK(both[w]->world, skein_velocities_copy(both[w]->world, both[w]->first[body], both[w]->count[body], v[w]));
    }
    for (size_t i = 0; i < 3 * a->count[body]; i++) {
        count += x[0][i] != x[1][i] || v[0][i] != v[1][i];
        *worst = fmax(*worst, fmax(fabs(x[0][i] - x[1][i]), fabs(v[0][i] - v[1][i])));
    }
    return count;
}

static void try_rule(const char *method, const skein_kind *kind, bool cloths, const char *on) {
    two with = make_two(method, cloths, 1 + cloths), without = make_two(method, cloths, 1);
    // somebody to be seen, but far from all
    if (!strcmp(kind->name, "lookout"))
        OK(without.world,
           skein_collider_add(without.world, "sphere",
                              SKEIN_SETTINGS(SKEIN_REAL("radius", 0.01), SKEIN_VEC3("centre", 0, -2, 0)), NULL));
    add_rule(with.world, kind, on);
    steps(with.world, STEPS, 1.0 / 60), steps(without.world, STEPS, 1.0 / 60);
    double moved, off;
    size_t named = differ(&with, &without, NAMED, &moved), other = differ(&with, &without, OTHER, &off);
    // one solve has one number of iterations for all: there others are the same to its tolerance
    bool same = strcmp(method, "backward_euler") ? other == 0 : off < 1e-3;
    if (!named || !same)
        fail_msg("%s, %s on %s, '%s': %zu numbers of the body named differ, %zu of the other (by %g)", method,
                 kind->name, cloths ? "cloths" : "flocks", on, named, other, off);
    skein_world_destroy(with.world), skein_world_destroy(without.world);
}

static void each_rule_moves_whom_it_names(void **state) {
    (void)state;
    static const char *const calls[] = {"named", "chosen", " few, named ,chosen"}; // all of them mean the same body
    for (size_t m = 0; m < COUNT(all_methods); m++)
        for (int cloths = 0; cloths < 2; cloths++) {
            const char *on = calls[(2 * m + (size_t)cloths) % COUNT(calls)];
            for (size_t k = 0; skein_kind_at(SKEIN_FORCE, k); k++) {
                const skein_kind *kind = skein_kind_at(SKEIN_FORCE, k);
                if (!strcmp(kind->name, "surface_wind") && !cloths) continue; // it has nothing to act on
                if (!strcmp(kind->name, "contact")) continue;                 // nothing touches here: test_touching.c
                try_rule(all_methods[m], kind, cloths, on);
            }
            for (size_t k = 0; skein_kind_at(SKEIN_COLLIDER, k); k++)
                try_rule(all_methods[m], skein_kind_at(SKEIN_COLLIDER, k), cloths, on);
        }
}

/* Who is at rest, and is not named, stays so to the bit, also where one system of equations is solved for all. */
static void who_rests_is_let_be(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(all_methods); m++) {
        skein_world *world = new_world(all_methods[m], 3);
        for (int b = 0; b < 2; b++)
            OK(world,
               skein_body_add(world, "cloth", NULL,
                              SKEIN_SETTINGS(SKEIN_PAIR("grid", 5, 5), SKEIN_REAL("stretch.stiffness", 100),
                                             SKEIN_REAL("shear.stiffness", 50), SKEIN_TEXT("name", b ? "b" : "a")),
                              NULL));
        OK(world, skein_force_add(world, "gravity", SKEIN_SETTINGS(SKEIN_TEXT("on", "a")), NULL));
        OK(world, skein_force_add(world, "surface_wind",
                                  SKEIN_SETTINGS(SKEIN_VEC3("velocity", 1, 2, 3), SKEIN_TEXT("on", "a")), NULL));
        OK(world, skein_collider_add(world, "sphere", SKEIN_SETTINGS(SKEIN_TEXT("on", "a")), NULL));
        vec3 x = position_of(world, 30);
        steps(world, 5, 0.01);
        assert_true(length3(minus(position_of(world, 30), x)) == 0 && length3(velocity_of(world, 30)) == 0);
        assert_true(length3(velocity_of(world, 5)) > 0);
        skein_world_destroy(world);
    }
}

/* By closed forms: two clouds, one that falls and one that is blown, under each method. */
static void each_follows_its_own_law(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(all_methods); m++) {
        skein_world *world = new_world(all_methods[m], 4);
        for (int b = 0; b < 3; b++)
            OK(world,
               skein_body_add(world, "flock", NULL,
                              SKEIN_SETTINGS(SKEIN_REAL("count", 5), SKEIN_REAL("speed", 0), SKEIN_REAL("mass", 0.5),
                                             SKEIN_TEXT("name", b == 0   ? "falls"
                                                                : b == 1 ? "is blown"
                                                                         : "does both")),
                              NULL));
        skein_handle gravity;
        OK(world, skein_force_add(world, "gravity", SKEIN_SETTINGS(SKEIN_TEXT("on", "falls, does both")), &gravity));
        OK(world, skein_force_add(
                      world, "wind",
                      SKEIN_SETTINGS(SKEIN_VEC3("force", 1, 0, 0), SKEIN_TEXT("on", " does both ,is blown")), NULL));
        steps(world, 30, 0.01);
        double gain[2] = {-9.81 * 0.3, 1 / 0.5 * 0.3};
        for (int b = 0; b < 3; b++)
            for (size_t i = 0; i < 5; i++) {
                vec3 v = velocity_of(world, 5 * (size_t)b + i);
                assert_near(v.y, b == 1 ? 0 : gain[0], b == 1 ? 0 : 1e-4);
                assert_near(v.x, b == 0 ? 0 : gain[1], b == 0 ? 0 : 1e-4);
            }
        // potential energy is of those alone that fall
        skein_statistics s = statistics_of(world);
        double ought = 0;
        for (size_t i = 0; i < 15; i++)
            if (i / 5 != 1) ought += 0.5 * 9.81 * position_of(world, i).y;
        assert_near(s.potential_energy, ought, 1e-4 * (1 + fabs(ought)));
        OK(world, skein_set(world, gravity, "on", skein_text("")));
        steps(world, 10, 0.01);
        assert_near(velocity_of(world, 7).y, -9.81 * 0.1, 1e-4);
        skein_world_destroy(world);
    }
}

static void contacts_are_of_those_named(void **state) {
    (void)state;
    two t = make_two("xpbd", false, 1);
    skein_contact contact[2 * LOOSE_PARTICLES];
    size_t count;
    OK(t.world,
       skein_collider_add(t.world, "plane", SKEIN_SETTINGS(SKEIN_REAL("offset", 5), SKEIN_TEXT("on", "other")), NULL));
    OK(t.world, skein_contacts_copy(t.world, contact, COUNT(contact), &count));
    assert_int_equal(count, LOOSE_PARTICLES);
    for (size_t i = 0; i < count; i++)
        assert_in_range(contact[i].particle, t.first[OTHER], t.first[OTHER] + LOOSE_PARTICLES - 1);
    assert_int_equal(statistics_of(t.world).contacts, LOOSE_PARTICLES);
    skein_world_destroy(t.world);
}

static void unknown_names_are_told(void **state) {
    (void)state;
    two t = make_two("xpbd", false, 1);
    skein_handle wind, plane;
    OK(t.world, skein_force_add(t.world, "wind", SKEIN_SETTINGS(SKEIN_TEXT("on", "named, othr")), &wind));
    FAILS(t.world, SKEIN_ERROR_NAME, "'othr'; did you mean 'other'?", skein_world_step(t.world, 0.01));
    OK(t.world, skein_set(t.world, wind, "on", skein_text("named,other")));
    OK(t.world, skein_world_step(t.world, 0.01));
    OK(t.world, skein_collider_add(t.world, "plane", SKEIN_SETTINGS(SKEIN_TEXT("on", "nmed")), &plane));
    FAILS(t.world, SKEIN_ERROR_NAME, "did you mean 'named'?", skein_world_step(t.world, 0.01));
    OK(t.world, skein_set(t.world, plane, "on", skein_text("named, chossen")));
    FAILS(t.world, SKEIN_ERROR_NAME, "there is no body or group of the name 'chossen'; did you mean 'chosen'?",
          skein_world_step(t.world, 0.01));
    OK(t.world, skein_remove(t.world, plane));
    // a rule that steers moves bodies that lie beside each other, or says so
    OK(t.world, skein_body_add(t.world, "flock", NULL,
                               SKEIN_SETTINGS(SKEIN_REAL("count", 3), SKEIN_TEXT("name", "third")), NULL));
    skein_handle limit;
    OK(t.world, skein_force_add(t.world, "speed_limit", SKEIN_SETTINGS(SKEIN_TEXT("on", "named, other")), &limit));
    OK(t.world, skein_world_step(t.world, 0.01));
    OK(t.world, skein_set(t.world, limit, "on", skein_text("named, third")));
    FAILS(t.world, SKEIN_ERROR_VALUE, "give each a rule of its own", skein_world_step(t.world, 0.01));
    skein_world_destroy(t.world);
}

/* On a card: the same as on the processor, or refused in plain words. */
static void cards_know_whom(void **state) {
    (void)state;
    static const skein_category categories[] = {SKEIN_FORCE, SKEIN_COLLIDER};
    static const char *const methods[] = {"xpbd", "symplectic_euler"};
    for (size_t m = 0; m < COUNT(methods); m++)
        for (size_t c = 0; c < COUNT(categories); c++)
            for (size_t k = 0; skein_kind_at(categories[c], k); k++) {
                const skein_kind *kind = skein_kind_at(categories[c], k);
                if (!strcmp(kind->name, "surface_wind") || !strcmp(kind->name, "contact")) continue; // never run there
                if (skein_field_find(kind, "mesh", NULL)) continue; // nor do colliders made from meshes
                two cpu = make_two(methods[m], false, 1), gpu = make_two(methods[m], false, 1);
                add_rule(cpu.world, kind, "other"), add_rule(gpu.world, kind, "other");
                if (!strcmp(kind->name, "separation")) {
                    to_card(gpu.world);
                    FAILS(gpu.world, SKEIN_ERROR_VALUE, "'on' some bodies only", skein_world_step(gpu.world, dt));
                    skein_world_destroy(cpu.world), skein_world_destroy(gpu.world);
                    continue;
                }
                assert_agree(cpu.world, gpu.world, 3, 3e-5, kind->name);
            }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_rule_moves_whom_it_names), cmocka_unit_test(who_rests_is_let_be),
        cmocka_unit_test(each_follows_its_own_law),      cmocka_unit_test(contacts_are_of_those_named),
        cmocka_unit_test(unknown_names_are_told),        cmocka_unit_test(cards_know_whom),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
