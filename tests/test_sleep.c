/* Bodies that come to rest fall asleep, with all that they may touch, and wake when something comes near, when they are changed or
 * a rule is; asleep they count in all that is measured; and none of it depends on threads, or on where a world was saved. */
#include <skein/cut.h>
#include <skein/gradient.h>
#include <skein/kinds.h>
#include <skein/record.h>

#include "all_methods.h"
#include "crossings.h"
#include "purse.h"

static const double dt = 1.0 / 60;

static skein_world *ground(const char *method, int threads) {
    skein_world_desc desc = skein_default_world_desc();
    desc.thread_count = threads;
    skein_world *world = skein_world_create(&desc, NULL);
    OK(world, skein_method_set(world, method, SKEIN_SETTINGS(SKEIN_REAL("substeps", 5))));
    add_gravity(world);
    OK(world, skein_force_add(world, "drag", SKEIN_SETTINGS(SKEIN_REAL("rate", 1)), NULL));
    OK(world, skein_force_add(world, "contact",
                              SKEIN_SETTINGS(SKEIN_REAL("thickness", 0.01), SKEIN_TEXT("name", "contact")), NULL));
    OK(world, skein_collider_add(world, "plane", SKEIN_SETTINGS(SKEIN_REAL("friction", 0.5)), NULL));
    return world;
}

/* A sheet of a quarter of a metre that falls from y. */
static skein_handle sheet(skein_world *world, const char *name, const char *pins, double sleep, double x, double y,
                          double turned) {
    skein_handle body;
    OK(world,
       skein_body_add(world, "cloth", NULL,
                      SKEIN_SETTINGS(SKEIN_TEXT("name", name), SKEIN_PAIR("grid", 9, 9), SKEIN_PAIR("size", 0.25, 0.25),
                                     SKEIN_TEXT("pins", pins), SKEIN_REAL("sleep", sleep),
                                     SKEIN_VEC3("position", x, y, 0), SKEIN_VEC3("rotation", turned, 15, 0)),
                      &body));
    return body;
}

static void until_asleep(skein_world *world, skein_handle body, int most) {
    for (int i = 0; i < most && !skein_body_asleep(world, body); i++) steps(world, 1, dt);
    if (!skein_body_asleep(world, body)) fail_msg("awake after %g s", most * dt);
}

static uint32_t first_of(const skein_world *world, skein_handle body) {
    skein_surface surface;
    OK(world, skein_body_surface(world, body, &surface));
    return surface.first_particle;
}

/* ---- what rests ---- */

static void what_rests_sleeps_and_counts(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(all_methods); m++) {
        if (!strcmp(all_methods[m], "explicit_euler") || (SPARING && m % 3)) continue; // there nothing rests
        skein_world *world = ground(all_methods[m], 1);
        if (strcmp(all_methods[m], "xpbd") != 0 && strcmp(all_methods[m], "pbd") != 0 &&
            strcmp(all_methods[m], "backward_euler") != 0)
            OK(world, skein_set_path(world, "method.substeps", skein_number(100)));
        skein_handle a = sheet(world, "a", "", 0.05, 0, 0.1, 3);
        static const char *const names[] = {"stretch.stiffness", "shear.stiffness"};
        for (int i = 0; i < 2; i++) OK(world, skein_set(world, a, names[i], skein_number(100)));
        steps(world, 60, dt);
        for (int i = 0; i < 400 && !skein_body_asleep(world, a); i++) steps(world, 1, dt);
        if (!skein_body_asleep(world, a)) fail_msg("%s: awake", all_methods[m]);
        skein_statistics s = statistics_of(world);
        assert_int_equal(s.asleep, 81);
        assert_int_equal(s.particles, 81);
        assert_true(s.constraints > 200 && s.contacts > 9);
        assert_true(s.kinetic_energy == 0 && s.elastic_energy >= 0 && isfinite(s.max_stretch));
        assert_true(skein_particle_present(world, 0));
        const uint64_t hash = skein_world_hash(world);
        const vec3 at = position_of(world, 40);
        steps(world, 10, dt);
        assert_true(skein_world_hash(world) == hash);
        assert_true(length3(minus(position_of(world, 40), at)) == 0);
        // to wake it is as to begin there, at rest
        double x[3 * 81];
        OK(world, skein_positions_copy(world, 0, 81, x));
        skein_statistics now = statistics_of(world);
        assert_near(now.elastic_energy, s.elastic_energy, 0);
        assert_near(now.potential_energy, s.potential_energy, 0);
        assert_near(now.max_stretch, s.max_stretch, 0);
        OK(world, skein_set(world, a, "visible", skein_number(1)));
        steps(world, 1, dt);
        assert_false(skein_body_asleep(world, a));
        now = statistics_of(world);
        assert_int_equal(now.asleep, 0);
        assert_int_equal(now.constraints, s.constraints);
        assert_near(now.potential_energy, s.potential_energy, 0.01 * s.potential_energy);
        skein_world_destroy(world);
    }
}

/* Elastic energy, stretch, crossings and contacts of what sleeps are those of what is awake in the same places. */
static void it_is_measured_as_if_awake(void **state) {
    (void)state;
    skein_world *world = ground("xpbd", 1);
    skein_handle a = sheet(world, "a", "", 0.05, 0, 0.3, 80), b = sheet(world, "b", "", 0.05, 0.02, 0.6, 3);
    OK(world, skein_set_path(world, "forces.contact.recovery", skein_number(0)));
    until_asleep(world, a, 900);
    assert_true(skein_body_asleep(world, b));
    // one is put through the other, by hand, and must sleep so: it is not led apart
    double x[3 * 81];
    OK(world, skein_positions_copy(world, first_of(world, b), 81, x));
    for (int i = 0; i < 81; i++) x[3 * i + 1] -= 0.012;
    OK(world, skein_positions_set(world, first_of(world, b), 81, x));
    until_asleep(world, b, 900);
    skein_statistics asleep = statistics_of(world), again = statistics_of(world);
    crossing_search all = crossing_begin(world);
    const size_t ours = crossings_now(&all, world);
    size_t touching, others;
    OK(world, skein_surface_contacts_copy(world, NULL, 0, &touching));
    skein_world *other = ground("xpbd", 1);
    sheet(other, "a", "", 0, 0, 0.3, 80), sheet(other, "b", "", 0, 0.02, 0.6, 3);
    for (size_t i = 0; i < 2 * 81; i++) {
        vec3 p = position_of(world, i);
        place_particle(other, i, p.x, p.y, p.z);
    }
    skein_statistics awake = statistics_of(other);
    OK(other, skein_surface_contacts_copy(other, NULL, 0, &others));
    assert_true(ours > 0 && asleep.crossings > 0);
    assert_int_equal(asleep.crossings, awake.crossings);
    assert_int_equal(again.crossings, asleep.crossings);
    assert_int_equal(touching, others);
    assert_true(touching > 0);
    assert_int_equal(asleep.contacts, awake.contacts);
    assert_int_equal(asleep.constraints, awake.constraints);
    assert_near(asleep.elastic_energy, awake.elastic_energy, 0);
    assert_near(asleep.max_stretch, awake.max_stretch, 0);
    assert_true(asleep.state_hash == awake.state_hash);
    crossing_free(&all);
    skein_world_destroy(other);
    skein_world_destroy(world);
}

/* ---- who sleeps with whom ---- */

static void those_who_touch_sleep_together(void **state) {
    (void)state;
    skein_world *world = ground("xpbd", 1);
    skein_handle far = sheet(world, "far", "", 0.05, 3, 0.1, 3);
    skein_handle low = sheet(world, "low", "", 0.05, 0, 0.1, 3), high = sheet(world, "high", "", 0.05, 0.05, 1.5, 3);
    skein_handle restless = sheet(world, "restless", "", 0, 6, 0.1, 3),
                 on_it = sheet(world, "on it", "", 0.05, 6, 0.2, 3);
    skein_handle held = sheet(world, "held", "all", 0, 9, 0.05, 0),
                 on_held = sheet(world, "on held", "", 0.05, 9, 0.2, 3);
    bool far_alone = false;
    for (int i = 0; i < 600 && !(skein_body_asleep(world, high) && skein_body_asleep(world, on_held)); i++) {
        steps(world, 1, dt);
        far_alone |= skein_body_asleep(world, far) && !skein_body_asleep(world, low);
        assert_true(skein_body_asleep(world, low) == skein_body_asleep(world, high) ||
                    position_of(world, first_of(world, high)).y > 0.2);
    }
    (void)far_alone;
    assert_true(skein_body_asleep(world, far) && skein_body_asleep(world, low) && skein_body_asleep(world, high));
    assert_true(skein_body_asleep(world, on_held) && !skein_body_asleep(world, held)); // what is pinned is no hindrance
    assert_false(skein_body_asleep(world, restless) || skein_body_asleep(world, on_it)); // what may not sleep is
    // what wakes one of a pile wakes all of it, and nobody else
    OK(world, skein_velocities_set(world, first_of(world, high), 1, (const double[]){0, 0.1, 0}));
    steps(world, 1, dt);
    assert_false(skein_body_asleep(world, low) || skein_body_asleep(world, high));
    assert_true(skein_body_asleep(world, far) && skein_body_asleep(world, on_held));
    // what is tied to another is awake with it
    until_asleep(world, low, 600);
    skein_handle tie;
    OK(world, skein_constraint_add(world, "distance", (const uint32_t[]){first_of(world, far), first_of(world, low)}, 1,
                                   NULL, &tie));
    steps(world, 1, dt);
    assert_false(skein_body_asleep(world, far) || skein_body_asleep(world, on_held)); // a rule was added
    for (int i = 0; i < 600 && !skein_body_asleep(world, low); i++) steps(world, 1, dt);
    assert_true(skein_body_asleep(world, low) == skein_body_asleep(world, far));
    OK(world, skein_velocities_set(world, first_of(world, far), 1, (const double[]){0, 0.1, 0}));
    steps(world, 1, dt);
    assert_false(skein_body_asleep(world, low) || skein_body_asleep(world, far));
    skein_world_destroy(world);
}

/* ---- what wakes ---- */

static void what_falls_wakes_before_it_lands(void **state) {
    (void)state;
    for (int fast = 0; fast < 2; fast++) {
        skein_world *world = ground("xpbd", 1);
        skein_handle low = sheet(world, "low", "", 0.05, 0, 0.1, 3),
                     high = sheet(world, "high", "top edge", 0.05, 0, 4, 90);
        until_asleep(world, low, 600);
        until_asleep(world, high, 1200);
        const uint32_t first = first_of(world, high);
        for (uint32_t i = 0; i < 81; i++) {
            OK(world, skein_particle_pin(world, first + i, false));
            throw_particle(world, first + i, 0, fast ? -40 : 0, 0);
        }
        steps(world, 1, dt);
        assert_true(skein_body_asleep(world, low) && !skein_body_asleep(world, high));
        crossing_search all = crossing_begin(world);
        bool woken = false;
        for (int i = 0; i < 90; i++) {
            steps(world, 1, dt);
            assert_int_equal(crossings_now(&all, world), 0);
            woken |= !skein_body_asleep(world, low);
        }
        assert_true(woken);
        until_asleep(world, high, 900);
        until_asleep(world, low, 900);
        crossing_free(&all);
        skein_world_destroy(world);
    }
}

static void colliders_wake_whom_they_come_near(void **state) {
    (void)state;
    skein_world *world = ground("xpbd", 1);
    skein_handle ball, a = sheet(world, "a", "", 0.05, 0, 0.1, 3), b = sheet(world, "b", "", 0.05, 2, 0.1, 3);
    OK(world, skein_collider_add(world, "sphere",
                                 SKEIN_SETTINGS(SKEIN_REAL("radius", 0.1), SKEIN_VEC3("centre", 0, 1, 0)), &ball));
    until_asleep(world, a, 600);
    until_asleep(world, b, 600);
    for (int i = 1; i < 40; i++) { // a program moves it in every step, and says again what it is
        OK(world, skein_set(world, ball, "centre", skein_vector(0, 1 - 0.01 * i, 0)));
        OK(world, skein_set(world, ball, "radius", skein_number(0.1)));
        OK(world, skein_set_path(world, "forces.0.acceleration", skein_vector(0, -9.81, 0)));
        steps(world, 1, dt);
        assert_true(skein_body_asleep(world, a) && skein_body_asleep(world, b));
    }
    OK(world, skein_set(world, ball, "centre", skein_vector(0, -1, 0))); // through it, in one step
    steps(world, 1, dt);
    assert_true(!skein_body_asleep(world, a) && skein_body_asleep(world, b));
    until_asleep(world, a, 600);
    // one that moves by itself, past b and away
    OK(world, skein_set(world, ball, "centre", skein_vector(4, 0.1, 0)));
    steps(world, 1, dt);
    until_asleep(world, b, 600);
    OK(world, skein_set(world, ball, "motion.velocity", skein_vector(-2, 0, 0))); // from the beginning of time on
    OK(world, skein_set(world, ball, "centre", skein_vector(10 + 2 * skein_world_time(world), 0.1, 0)));
    steps(world, 2, dt);
    until_asleep(world, b, 120);
    bool woken = false;
    for (int i = 0; i < 360; i++) {
        steps(world, 1, dt);
        woken |= !skein_body_asleep(world, b);
    }
    assert_true(woken);
    // its size, where it is switched off: rules
    OK(world, skein_set(world, ball, "motion.velocity", skein_vector(0, 0, 0)));
    steps(world, 1, dt);
    until_asleep(world, b, 900);
    until_asleep(world, a, 900);
    OK(world, skein_set(world, ball, "radius", skein_number(0.2)));
    steps(world, 1, dt);
    assert_false(skein_body_asleep(world, a) || skein_body_asleep(world, b));
    skein_world_destroy(world);
}

/* Each of these calls wakes everybody, or the body that it is about. */
static void calls_wake(void **state) {
    (void)state;
    enum { GRAVITY, METHOD, FORCE, REMOVE, TIME, BODY, PIN, PLACE, CUT, PINS, RESET, CALLS };
    skein_world *world = ground("xpbd", 1);
    skein_handle a = sheet(world, "a", "", 0.05, 0, 0.1, 3), b = sheet(world, "b", "corners", 0.05, 2, 0.1, 3),
                 force = {0, 0, 0};
    const uint32_t first[] = {first_of(world, a), first_of(world, b)};
    for (int call = 0; call < CALLS; call++) {
        until_asleep(world, a, 900);
        until_asleep(world, b, 900);
        bool all = true; // else b alone
        vec3 p = position_of(world, first[1]);
        switch (call) {
        case GRAVITY: OK(world, skein_set_path(world, "forces.0.acceleration", skein_vector(0, -9, 0))); break;
        case METHOD: OK(world, skein_set_path(world, "method.substeps", skein_number(6))); break;
        case FORCE:
            OK(world, skein_force_add(world, "wind", SKEIN_SETTINGS(SKEIN_VEC3("force", 0, 0, 0)), &force));
            break;
        case REMOVE: OK(world, skein_remove(world, force)); break;
        case TIME: OK(world, skein_world_time_set(world, 3)); break;
        case BODY: OK(world, skein_set(world, b, "visible", skein_number(1))), all = false; break;
        case PIN: OK(world, skein_particle_pin(world, first[1] + 30, true)), all = false; break;
        case PLACE:
            OK(world, skein_positions_set(world, first[1], 1, &p.x)); // where it is
            steps(world, 1, dt);
            assert_true(skein_body_asleep(world, b));
            p.y += 0.001;
            OK(world, skein_positions_set(world, first[1], 1, &p.x)), all = false;
            break;
        case CUT: OK(world, skein_cut_faces(world, b, (const uint32_t[]){9}, 1)), all = false; break;
        case PINS: {
            OK(world, skein_pins_move(world, &first[1], 1, &p.x)); // where it is
            steps(world, 1, dt);
            assert_true(skein_body_asleep(world, b));
            p.y += 0.01;
            OK(world, skein_pins_move(world, &first[1], 1, &p.x)), all = false;
            break;
        }
        default: OK(world, skein_world_reset(world)); break;
        }
        steps(world, 1, dt);
        if (skein_body_asleep(world, b) || skein_body_asleep(world, a) == all) fail_msg("call %d", call);
    }
    // a pin that is led arrives where it was to be
    assert_int_equal(statistics_of(world).asleep, 0);
    skein_world_destroy(world);
}

/* ---- what held it up goes ---- */

/* A sheet lies on a pinned plate, which is taken away: the sheet falls, asleep or about to be, with a plate that sleeps or not. */
static void what_loses_its_hold_falls(void **state) {
    (void)state;
    enum { DISABLED, REMOVED, PLACED, TELEPORTED, UNPINNED, LED, ITSELF, WAYS };
    for (int way = 0; way < WAYS; way++)
        for (int when = 0; when < (SPARING ? 1 : way == LED ? 2 : 3); when++) {
            skein_world *world = ground("xpbd", 1);
            // one whose corners alone are pinned keeps awake what lies on it
            skein_handle plate = sheet(world, "plate", when == 2 ? "corners" : "all", when == 1 ? 0.05 : 0, 0, 0.5, 0);
            skein_handle body = sheet(world, "body", "", 0.02, 0.02, 0.52, 0);
            if (when == 2) steps(world, 200, dt);
            else until_asleep(world, body, 600);
            steps(world, 3, dt);
            const uint32_t first = first_of(world, plate);
            const double up[3] = {0, 0.5, 0}, aside[3] = {9, 0, 0};
            assert_true(position_of(world, first_of(world, body) + 40).y > 0.4);
            double x[3 * 81];
            uint32_t which[81];
            OK(world, skein_positions_copy(world, first, 81, x));
            for (uint32_t i = 0; i < 81; i++) which[i] = first + i, x[3 * i] += 9;
            switch (way) {
            case DISABLED: OK(world, skein_set(world, plate, "enabled", skein_number(0))); break;
            case REMOVED: OK(world, skein_remove(world, plate)); break;
            case PLACED: OK(world, skein_positions_set(world, first, 81, x)); break;
            case TELEPORTED: OK(world, skein_body_teleport(world, plate, NULL, aside)); break;
            case UNPINNED:
                for (uint32_t i = 0; i < 81; i++) OK(world, skein_particle_pin(world, first + i, false));
                break;
            case LED: OK(world, skein_pins_move(world, which, 81, x)); break;
            default: OK(world, skein_body_teleport(world, body, NULL, up)); break;
            }
            steps(world, 6, dt); // it has begun to fall
            assert_false(skein_body_asleep(world, body));
            const double most = way == ITSELF ? 1.1 : 0.51;
            steps(world, 60, dt);
            if (way != ITSELF && !(position_of(world, first_of(world, body) + 40).y < most - 0.2))
                fail_msg("way %d, %d: it is still at %g m", way, when, position_of(world, first_of(world, body) + 40).y);
            skein_world_destroy(world);
        }
}

/* The same of a collider: whatever is set beside its place, in one frame. */
static void what_a_collider_held_falls(void **state) {
    (void)state;
    enum { MOVED, SMALLER, BOTH, THIN, OFF, REMOVED, WAYS };
    for (int way = 0; way < WAYS; way++) {
        skein_world *world = ground("xpbd", 1);
        skein_handle box, body = sheet(world, "body", "", 0.05, 0, 0.58, 0);
        OK(world, skein_collider_add(world, "box",
                                     SKEIN_SETTINGS(SKEIN_VEC3("size", 1, 0.5, 1), SKEIN_VEC3("centre", 0, 0.3, 0),
                                                    SKEIN_REAL("thickness", 0.02)),
                                     &box));
        until_asleep(world, body, 600);
        if (way == MOVED || way == BOTH)
            OK(world, skein_set(world, box, "centre", skein_vector(0, way == BOTH ? 0.299 : -1, 0)));
        if (way == SMALLER || way == BOTH) OK(world, skein_set(world, box, "size", skein_vector(1, 0.3, 1)));
        if (way == THIN) OK(world, skein_set(world, box, "thickness", skein_number(0.001)));
        if (way == OFF) OK(world, skein_set(world, box, "enabled", skein_number(0)));
        if (way == REMOVED) OK(world, skein_remove(world, box));
        steps(world, 60, dt);
        const double y = position_of(world, 40).y;
        if (!(y < (way == THIN ? 0.56 : 0.5))) fail_msg("way %d: it is still at %g m", way, y);
        skein_world_destroy(world);
    }
}

/* Ground that is tilted, in one step. */
static void what_lies_on_a_plane_slides(void **state) {
    (void)state;
    skein_world *world = ground("xpbd", 1);
    skein_handle body = sheet(world, "body", "", 0.05, 0, 0.1, 3);
    until_asleep(world, body, 600);
    OK(world, skein_set_path(world, "colliders.0.normal", skein_vector(1, 1, 0)));
    steps(world, 60, dt);
    assert_true(!skein_body_asleep(world, body) && position_of(world, 40).x > 0.5);
    skein_world_destroy(world);
}

/* Contacts and crossings of a plate and a body are those of two that are awake in the same places. */
static void is_as_if_awake(skein_world *world) {
    size_t touching, others;
    skein_world *other = ground("xpbd", 1);
    sheet(other, "plate", "all", 0, 0, 0.5, 0), sheet(other, "body", "", 0, 0.02, 0.62, 0);
    for (size_t i = 0; i < 2 * 81; i++) {
        vec3 p = position_of(world, i);
        place_particle(other, i, p.x, p.y, p.z);
    }
    OK(world, skein_surface_contacts_copy(world, NULL, 0, &touching));
    OK(other, skein_surface_contacts_copy(other, NULL, 0, &others));
    assert_int_equal(touching, others);
    assert_true(touching > 0);
    assert_int_equal(statistics_of(world).crossings, statistics_of(other).crossings);
    skein_world_destroy(other);
}

/* What falls on a plate that sleeps, all pinned, is held by it. */
static void what_stands_pinned_wakes(void **state) {
    (void)state;
    skein_world *world = ground("xpbd", 1);
    skein_handle plate = sheet(world, "plate", "all", 0.05, 0, 0.5, 0);
    until_asleep(world, plate, 60);
    skein_handle body = sheet(world, "body", "", 0.05, 0.02, 0.62, 0); // which wakes all
    steps(world, 2, dt);
    assert_true(skein_body_asleep(world, plate) && !skein_body_asleep(world, body));
    for (int i = 0; i < 60; i++) {
        steps(world, 1, dt);
        const double y = position_of(world, first_of(world, body) + 40).y;
        if (y < 0.52 && !skein_body_asleep(world, body)) assert_false(skein_body_asleep(world, plate));
    }
    assert_true(position_of(world, first_of(world, body) + 40).y > 0.5);
    until_asleep(world, body, 600);
    steps(world, 3, dt);
    assert_true(skein_body_asleep(world, plate));
    is_as_if_awake(world);
    OK(world, skein_set(world, plate, "sleep", skein_number(0))); // what sleeps on what does not
    steps(world, 1, dt);
    until_asleep(world, body, 600);
    assert_false(skein_body_asleep(world, plate));
    is_as_if_awake(world);
    skein_world_destroy(world);
}

/* A weight of no body hangs from a sheet: it moves, and so nothing sleeps; pinned, it holds the sheet, and is no hindrance. */
static void loose_ends_count(void **state) {
    (void)state;
    static const char *const methods[] = {"xpbd", "backward_euler"};
    for (size_t m = 0; m < COUNT(methods); m++)
        for (int order = 0; order < 2; order++)
            for (int pinned = 0; pinned < 2; pinned++) {
                if (is_spared(4 * m + 2 * (size_t)order + (size_t)pinned, 3)) continue;
                skein_world *world = ground(methods[m], 1);
                skein_handle body = sheet(world, "body", "top edge", 0.05, 0, 1.5, 90);
                const uint32_t end = first_of(world, body) + 72, weight = add_particle(world, 0.01, 0.125, 1.1, 0);
                OK(world, skein_constraint_add(world, "distance",
                                               order ? (const uint32_t[]){weight, end} : (const uint32_t[]){end, weight},
                                               1, NULL, NULL));
                if (pinned) OK(world, skein_particle_pin(world, weight, true));
                for (int i = 0; i < 300; i++) {
                    steps(world, 1, dt);
                    assert_false(skein_body_asleep(world, body) && !pinned);
                }
                assert_true(skein_body_asleep(world, body) == (pinned == 1));
                assert_true(position_of(world, weight).y > 0.3);
                OK(world, skein_particle_pin(world, weight, !pinned));
                throw_particle(world, weight, 0, pinned ? -2 : 0, 0);
                steps(world, 1, dt);
                if (pinned) assert_false(skein_body_asleep(world, body));
                if (pinned) steps(world, 300, dt);
                else until_asleep(world, body, 1200);
                assert_true(skein_body_asleep(world, body) == (pinned == 0));
                skein_world_destroy(world);
            }
}

/* One of two that a constraint joins is taken out, the other sleeps, and the first comes back. */
static void what_comes_back_is_joined_again(void **state) {
    (void)state;
    skein_world *world = ground("xpbd", 1);
    skein_handle a = sheet(world, "a", "", 0.05, 0, 0.1, 3), b = sheet(world, "b", "", 0.05, 2, 0.1, 3);
    OK(world, skein_constraint_add(world, "distance", (const uint32_t[]){first_of(world, b), first_of(world, a)}, 1,
                                   NULL, NULL));
    until_asleep(world, a, 600);
    assert_true(skein_body_asleep(world, b));
    OK(world, skein_set(world, a, "enabled", skein_number(0)));
    steps(world, 1, dt);
    until_asleep(world, b, 600);
    OK(world, skein_set(world, a, "enabled", skein_number(1)));
    steps(world, 1, dt);
    assert_false(skein_body_asleep(world, a) || skein_body_asleep(world, b));
    until_asleep(world, a, 600);
    throw_particle(world, first_of(world, a), 0, 0.2, 0);
    steps(world, 1, dt);
    assert_false(skein_body_asleep(world, a) || skein_body_asleep(world, b));
    skein_world_destroy(world);
}

/* A collider that a motion leads, fast and from standing still, pushes what sleeps as it does what is awake. */
static void what_sets_out_fast_is_seen(void **state) {
    (void)state;
    double y[2];
    for (int sleeps = 0; sleeps < 2; sleeps++) {
        skein_world *world = ground("xpbd", 1);
        skein_handle body = sheet(world, "body", "corners", sleeps ? 0.05 : 0, 0, 1.5, 0);
        OK(world, skein_collider_add(world, "box",
                                     SKEIN_SETTINGS(SKEIN_TEXT("name", "box"), SKEIN_VEC3("size", 0.1, 0.02, 0.1),
                                                    SKEIN_VEC3("centre", 0, 1.57, 0)),
                                     NULL));
        sheet(world, "other", "corners", 0, 5, 1.5, 0);
        OK(world, skein_motion_add(world, "keys", NULL,
                                   SKEIN_SETTINGS(SKEIN_TEXT("colliders", "box"), SKEIN_TEXT("on", "other"),
                                                  SKEIN_TEXT("keys", "0 0 0 0, 3 0 0 0, 3.02 0 -0.2 0")),
                                   NULL));
        steps(world, 178, dt);
        assert_true(skein_body_asleep(world, body) == (sleeps == 1));
        steps(world, 6, dt);
        y[sleeps] = position_of(world, 40).y;
        skein_world_destroy(world);
    }
    assert_near(y[0], y[1], 0.02);
    assert_true(y[1] < 1.45);
}

/* Vertices of a mesh that are set far, onto what sleeps, or away from under it, in a step. */
static void vertices_that_are_led_are_seen(void **state) {
    (void)state;
    static const uint32_t sizes[6] = {4, 4, 4, 4, 4, 4},
                          faces[24] = {0, 1, 3, 2, 4, 6, 7, 5, 0, 4, 5, 1, 2, 3, 7, 6, 0, 2, 6, 4, 1, 5, 7, 3};
    for (int onto = 0; onto < 2; onto++) {
        double at[8][3], to[8][3];
        for (int i = 0; i < 8; i++) {
            const double x = i & 4 ? 0.4 : -0.4, y = i & 2 ? 0.1 : -0.1, z = i & 1 ? 0.4 : -0.4;
            memcpy(at[i], (const double[]){x, y + (onto ? 5 : 0.4), z}, sizeof at[i]);
            memcpy(to[i], (const double[]){x, y + (onto ? 1.15 : -3), z}, sizeof to[i]);
        }
        skein_world *world = ground("xpbd", 1);
        skein_mesh mesh = {.positions = &at[0][0],
                           .vertex_count = 8,
                           .face_sizes = sizes,
                           .face_count = 6,
                           .face_vertices = faces,
                           .face_vertex_count = 24};
        skein_handle box, body = sheet(world, "body", onto ? "corners" : "", 0.05, 0, onto ? 1.2 : 0.56, 0);
        OK(world, skein_collider_add_mesh(world, "mesh", &mesh, NULL, &box));
        OK(world, skein_collider_vertices_set(world, box, &at[0][0], 8)); // where they are: it is led, and stands
        until_asleep(world, body, 600);
        steps(world, 2, dt);
        OK(world, skein_collider_vertices_set(world, box, &at[0][0], 8));
        steps(world, 1, dt);
        assert_true(skein_body_asleep(world, body));
        OK(world, skein_collider_vertices_set(world, box, &to[0][0], 8));
        steps(world, 1, dt);
        assert_false(skein_body_asleep(world, body));
        steps(world, 60, dt);
        if (!onto) assert_true(position_of(world, 40).y < 0.1);
        skein_world_destroy(world);
    }
}

/* What has lain on something that moves, and loses it, falls: a formula that drops after three seconds. And who is led slowly by
 * his pins never sleeps. */
static void nobody_falls_asleep_in_the_air(void **state) {
    (void)state;
    skein_world *world = ground("xpbd", 1);
    skein_handle body = sheet(world, "body", "", 0.05, 0, 0.51, 0),
                 led = sheet(world, "led", "corners", 0.05, 4, 1.5, 0);
    OK(world, skein_collider_add(world, "formula",
                                 SKEIN_SETTINGS(SKEIN_TEXT("surface", "p.y - 0.5 + 5*min(max(t - 3, 0)*100, 1)"),
                                                SKEIN_TEXT("on", "body")),
                                 NULL));
    OK(world,
       skein_motion_add(world, "keys", NULL,
                        SKEIN_SETTINGS(SKEIN_TEXT("on", "led"), SKEIN_TEXT("keys", "0 0 0 0, 9 0 0.09 0")), NULL));
    for (int i = 0; i < 300; i++) {
        steps(world, 1, dt);
        const double y = position_of(world, 40).y;
        if (skein_body_asleep(world, body) && y > 0.1) fail_msg("step %d: asleep at %g m", i, y);
        if (skein_body_asleep(world, led)) fail_msg("step %d: asleep while it is led", i);
    }
    assert_true(position_of(world, 40).y < 0.1);
    skein_world_destroy(world);
}

/* Two that lie on one pinned plate do not know of each other; of a crossing that is gone nothing is told. */
static void who_has_nothing_to_do_with_it_sleeps_on(void **state) {
    (void)state;
    skein_world *world = ground("xpbd", 1);
    skein_handle ends[2];
    for (int k = 0; k < 2; k++) ends[k] = sheet(world, k ? "b" : "a", "", 0.05, k, 0.52, 0);
    OK(world,
       skein_body_add(world, "cloth", NULL,
                      SKEIN_SETTINGS(SKEIN_TEXT("name", "plate"), SKEIN_PAIR("grid", 5, 20), SKEIN_PAIR("size", 2, 0.5),
                                     SKEIN_TEXT("pins", "all"), SKEIN_VEC3("position", 0.5, 0.5, 0)),
                      NULL));
    until_asleep(world, ends[0], 600);
    until_asleep(world, ends[1], 600);
    throw_particle(world, first_of(world, ends[0]) + 40, 0, 0.3, 0);
    for (int i = 0; i < 10; i++) {
        steps(world, 1, dt);
        assert_true(!skein_body_asleep(world, ends[0]) && skein_body_asleep(world, ends[1]));
    }
    until_asleep(world, ends[0], 600);
    // one that is put through the other, and then away again
    double x[3 * 81];
    const uint32_t b = first_of(world, ends[1]);
    OK(world, skein_set_path(world, "forces.contact.recovery", skein_number(0)));
    OK(world, skein_positions_copy(world, b, 81, x));
    for (int i = 0; i < 81; i++) x[3 * i] -= 0.93, x[3 * i + 1] += 0.3 * x[3 * i + 2];
    OK(world, skein_positions_set(world, b, 81, x));
    until_asleep(world, ends[1], 900);
    if (!statistics_of(world).crossings) fail_msg("nothing crosses: the test shows nothing");
    for (int i = 0; i < 81; i++) x[3 * i + 1] += 5;
    OK(world, skein_positions_set(world, b, 81, x));
    assert_int_equal(statistics_of(world).crossings, 0);
    skein_world_destroy(world);
}

/* Kinds by functions of a program may change as time goes by, and nobody can read it. */
static double sinking(const void *params, double time, const double x[3], double normal[3]) {
    (void)params;
    normal[0] = normal[2] = 0, normal[1] = 1;
    return x[1] - (time < 3 ? 0.5 : 0.2);
}

typedef struct lifting_params {
    char *label;
} lifting_params;

static void lifting(const void *params, double time, const skein_lanes *in, skein_real force[3][SKEIN_LANES]) {
    (void)params;
    for (int i = 0; i < SKEIN_LANES; i++)
        force[0][i] = force[2][i] = 0, force[1][i] = (skein_real)(time > 3 ? 30 : 0) * in->mass[i];
}

static void functions_of_a_program_keep_awake(void **state) {
    (void)state;
    static const skein_collider_type collider = {.kind = {"sinking", "sinks after 3 s", SKEIN_COLLIDER, NULL, 0, 0},
                                                 .distance = sinking};
    static const skein_field fields[] = {SKEIN_FIELD_OF_TEXT(lifting_params, label, "label", "which", "words")};
    static const skein_force_type force = {
        .kind = {"lifting", "lifts after 3 s", SKEIN_FORCE, fields, 1, sizeof(lifting_params)}, .force = lifting};
    skein_kinds *kinds = skein_kinds_create(NULL);
    skein_error error;
    assert_int_equal(skein_kind_register(kinds, &collider.kind, &error), SKEIN_OK);
    assert_int_equal(skein_kind_register(kinds, &force.kind, &error), SKEIN_OK);
    for (int k = 0; k < 2; k++) {
        skein_world_desc desc = skein_default_world_desc();
        desc.kinds = kinds;
        skein_world *world = skein_world_create(&desc, NULL);
        OK(world, skein_method_set(world, "xpbd", SKEIN_SETTINGS(SKEIN_REAL("substeps", 5))));
        add_gravity(world);
        OK(world, skein_collider_add(world, "plane", NULL, NULL));
        if (k) OK(world, skein_force_add(world, "lifting", SKEIN_SETTINGS(SKEIN_TEXT("label", "north")), NULL));
        else OK(world, skein_collider_add(world, "sinking", NULL, NULL));
        skein_handle body = sheet(world, "body", "", 0.05, 0, k ? 0.05 : 0.55, 0);
        steps(world, 170, dt);
        assert_false(skein_body_asleep(world, body));
        steps(world, 90, dt);
        const double y = position_of(world, 40).y;
        assert_true(k ? y > 2 : y < 0.3);
        skein_world_destroy(world);
    }
    skein_kinds_destroy(kinds);
}

static double no_measure(void *user, const skein_gradient_state *state) {
    (void)user, (void)state;
    return 0;
}

static void gradients_refuse_sleep(void **state) {
    (void)state;
    skein_world *world = new_world("symplectic_euler", 1);
    sheet(world, "body", "", 0.05, 0, 1, 0);
    skein_gradient_desc desc = {.steps = 3, .dt = dt, .measure = no_measure};
    skein_gradient_result result = {.value = 0};
    FAILS(world, SKEIN_ERROR_VALUE, sizeof(skein_real) == sizeof(double) ? "sleep" : "double precision",
          skein_gradient(world, &desc, &result));
    skein_world_destroy(world);
}

/* ---- what does not sleep ---- */

static void what_may_be_moved_does_not_sleep(void **state) {
    (void)state;
    static const struct {
        const char *kind;
        const skein_setting set[4];
        bool sleeps;
    } some[] = {
        {"force_field", {SKEIN_TEXT("force", "vec3(0, 0, 0.0001*max(t - 50, 0))"), SKEIN_TEXT("on", "a")}, false},
        {"force_field", {SKEIN_TEXT("force", "vec3(0, 0, 0.0001*sqrt(1 + p.y*p.y))"), SKEIN_TEXT("on", "a")}, true},
        {"force_field", {SKEIN_TEXT("force", "vec3(0, 0, 0.0001*max(t - 50, 0))"), SKEIN_TEXT("on", "b")}, true},
        {"speed_limit", {SKEIN_REAL("limit", 100)}, false},
        {"separation", {SKEIN_REAL("radius", 0.001)}, false},
    };
    for (size_t k = 0; k < COUNT(some); k++) {
        skein_world *world = ground("xpbd", 1);
        skein_handle a = sheet(world, "a", "", 0.05, 0, 0.1, 3);
        sheet(world, "b", "", 0, 5, 0.1, 3);
        OK(world, skein_force_add(world, some[k].kind, some[k].set, NULL));
        steps(world, 300, dt);
        if (skein_body_asleep(world, a) != some[k].sleeps) fail_msg("%s, %zu", some[k].kind, k);
        skein_world_destroy(world);
    }
    // nor what a collider that moves is near, or what lives in a frame
    for (int k = 0; k < 3; k++) {
        skein_world *world = ground("xpbd", 1);
        skein_handle a = sheet(world, "a", k == 2 ? "corners" : "", 0.05, 0, 0.1, 3);
        if (k < 2)
            OK(world,
               skein_collider_add(world, "sphere",
                                  SKEIN_SETTINGS(SKEIN_REAL("radius", 0.1), SKEIN_VEC3("centre", k ? 4 : 0, -0.1, 0),
                                                 SKEIN_REAL("motion.spin", 0.01), SKEIN_REAL("friction", 0)),
                                  NULL));
        else OK(world, skein_motion_add(world, "translate", NULL, SKEIN_SETTINGS(SKEIN_REAL("inertia", 0.5)), NULL));
        steps(world, 300, dt);
        assert_true(skein_body_asleep(world, a) == (k == 1));
        skein_world_destroy(world);
    }
}

/* ---- the same bits ---- */

static skein_world *pile(int threads) {
    skein_world *world = ground("xpbd", threads);
    sheet(world, "a", "", 0.05, 0, 0.2, 40);
    sheet(world, "b", "corners", 0.05, 2, 0.3, 0);
    sheet(world, "c", "", 0.05, 0.03, 4, 10); // it falls on what sleeps
    OK(world, skein_collider_add(world, "sphere",
                                 SKEIN_SETTINGS(SKEIN_REAL("radius", 0.1), SKEIN_VEC3("centre", 2, -4, 0),
                                                SKEIN_VEC3("motion.velocity", 0, 1, 0)),
                                 NULL)); // and it wakes b
    return world;
}

enum { PILE_STEPS = 330 };

static void nudge(skein_world *world, int i) {
    if (i == 200) OK(world, skein_velocities_set(world, 3, 1, (const double[]){0, 0.3, 0}));
    if (i == 260) OK(world, skein_set_path(world, "method.substeps", skein_number(6)));
}

static void it_goes_on_from_anywhere(void **state) {
    (void)state;
    enum { EVERY = 13 };
    skein_world *world = pile(1);
    uint64_t hash[PILE_STEPS];
    size_t asleep[PILE_STEPS], changes = 0;
    struct {
        void *bytes;
        size_t size;
    } saved[PILE_STEPS / EVERY + 1];
    for (int i = 0; i < PILE_STEPS; i++) {
        nudge(world, i);
        if (i % EVERY == 0) { // after a call that has woken somebody, too: 260
            size_t size = skein_snapshot_size(world);
            saved[i / EVERY].bytes = malloc(size);
            OK(world, skein_snapshot_write(world, saved[i / EVERY].bytes, size, &saved[i / EVERY].size));
            assert_int_equal(size, saved[i / EVERY].size);
        }
        steps(world, 1, dt);
        hash[i] = skein_world_hash(world);
        asleep[i] = statistics_of(world).asleep;
        changes += i && asleep[i] != asleep[i - 1];
    }
    assert_true(changes >= 5);
    skein_world_destroy(world);
    for (int s = 0; s <= (PILE_STEPS - 1) / EVERY; s += SPARING ? 5 : 1) {
        skein_world *other = pile(1 + s % 3);
        if (s % 2) steps(other, 150, dt); // whatever slept there
        OK(other, skein_snapshot_read(other, saved[s].bytes, saved[s].size));
        for (int i = s * EVERY; i < PILE_STEPS && i < s * EVERY + 120; i++) {
            if (i > s * EVERY) nudge(other, i);
            steps(other, 1, dt);
            if (skein_world_hash(other) != hash[i] || statistics_of(other).asleep != asleep[i])
                fail_msg("from step %d: other bits after step %d, %zu asleep for %zu", s * EVERY, i,
                         statistics_of(other).asleep, asleep[i]);
        }
        skein_world_destroy(other);
    }
    // what is damaged is refused, or at least breaks nothing
    skein_world *other = pile(1);
    const int last = (PILE_STEPS - 1) / EVERY;
    unsigned char *bytes = saved[last].bytes;
    for (size_t i = 40; i < saved[last].size; i += saved[last].size / 97) {
        bytes[i] ^= 5;
        if (!skein_snapshot_read(other, bytes, saved[last].size)) fail_msg("byte %zu", i);
        bytes[i] ^= 5;
    }
    skein_world_destroy(other);
    for (int s = 0; s <= last; s++) free(saved[s].bytes);
}

/* What was set after the last step is in a snapshot; a reset is a beginning. */
static void nothing_is_forgotten(void **state) {
    (void)state;
    skein_world *world = ground("xpbd", 1), *other = ground("xpbd", 1);
    skein_handle a = sheet(world, "a", "", 0.05, 0, 0.1, 3);
    sheet(other, "a", "", 0.05, 0, 0.1, 3);
    until_asleep(world, a, 600);
    double v[3 * 81];
    for (int i = 0; i < 3 * 81; i++) v[i] = i % 3 == 1 ? 3 : 0;
    OK(world, skein_velocities_set(world, 0, 81, v));
    size_t size = skein_snapshot_size(world);
    void *bytes = malloc(size);
    OK(world, skein_snapshot_write(world, bytes, size, NULL));
    OK(other, skein_snapshot_read(other, bytes, size));
    free(bytes);
    for (int i = 0; i < 60; i++) {
        steps(world, 1, dt);
        steps(other, 1, dt);
        assert_true(skein_world_hash(world) == skein_world_hash(other));
        if (i == 10) assert_true(position_of(world, 40).y > 0.2);
    }
    OK(world, skein_world_reset(world));
    steps(world, 20, dt);
    OK(world, skein_world_reset(world));
    OK(other, skein_world_reset(other));
    for (int i = 0; i < 60; i++) {
        steps(world, 1, dt);
        steps(other, 1, dt);
        assert_true(skein_world_hash(world) == skein_world_hash(other));
    }
    skein_world_destroy(world);
    skein_world_destroy(other);
}

typedef struct tape {
    unsigned char *bytes;
    size_t size;
} tape;

static bool write_tape(void *user, const void *bytes, size_t size) {
    tape *t = user;
    t->bytes = realloc(t->bytes, t->size + size);
    memcpy(t->bytes + t->size, bytes, size);
    t->size += size;
    return true;
}

static void it_is_replayed(void **state) {
    (void)state;
    tape t = {NULL, 0};
    skein_world *world = pile(2), *other = pile(1);
    const skein_recorder to = {.write = write_tape, .user = &t};
    OK(world, skein_record_begin(world, &to));
    for (int i = 0; i < PILE_STEPS; i++) {
        nudge(world, i);
        steps(world, 1, dt);
    }
    OK(world, skein_record_end(world));
    skein_difference difference;
    OK(other, skein_replay(other, t.bytes, t.size, &difference));
    assert_true(skein_world_hash(world) == skein_world_hash(other));
    free(t.bytes);
    skein_world_destroy(world);
    skein_world_destroy(other);
}

/* ---- where memory is wanting ---- */

static int play(purse *p) {
    skein_world_desc desc = purse_world(p);
    skein_world *world = skein_world_create(&desc, NULL);
    int failed = -1;
    if (world && !skein_method_set(world, "xpbd", SKEIN_SETTINGS(SKEIN_REAL("substeps", 2))) &&
        !skein_force_add(world, "gravity", NULL, NULL) && !skein_force_add(world, "contact", NULL, NULL) &&
        !skein_collider_add(world, "plane", NULL, NULL) &&
        !skein_body_add(
            world, "cloth", NULL,
            SKEIN_SETTINGS(SKEIN_PAIR("grid", 4, 4), SKEIN_REAL("sleep", 1), SKEIN_VEC3("position", 0, 0.01, 0)),
            NULL)) {
        failed = 0;
        for (int f = 0; f < 20; f++) {
            skein_statistics s;
            if (f == 16) failed += skein_velocities_set(world, 0, 1, (const double[]){0, 0.1, 0}) != 0;
            failed += skein_world_step(world, 1.0 / 30) != 0;
            if (f % 6 == 5) failed += skein_world_statistics(world, &s) != 0;
        }
        if (p->fail_at == SIZE_MAX) assert_int_equal(statistics_of(world).asleep, 0);
    }
    skein_world_destroy(world);
    assert_int_equal(p->blocks, 0);
    return failed;
}

static void without_memory_it_says_so(void **state) {
    (void)state;
    purse p = {.fail_at = SIZE_MAX};
    assert_int_equal(play(&p), 0);
    const size_t calls = p.calls;
    int told = 0;
    for (size_t at = 0; at < calls; at += SPARING ? 11 : 3) {
        purse one = {.fail_at = at};
        told += play(&one) != 0;
    }
    assert_true(told > 20);
}

/* ---- contact of nobody ---- */

static void contact_forgets_who_is_not_there(void **state) {
    (void)state;
    static const char *const methods[] = {"xpbd", "backward_euler"};
    for (size_t m = 0; m < COUNT(methods); m++) {
        if (is_spared(m, 2)) continue;
        skein_world *world = ground(methods[m], 1);
        skein_handle a = sheet(world, "a", "", 0, 0, 0.15, 70), b = sheet(world, "b", "", 0, 0.02, 0.3, 5);
        steps(world, 40, dt);
        size_t touching;
        OK(world, skein_surface_contacts_copy(world, NULL, 0, &touching));
        assert_true(touching > 0);
        OK(world, skein_set(world, a, "enabled", skein_number(0)));
        OK(world, skein_set(world, b, "enabled", skein_number(0)));
        const uint64_t hash = skein_world_hash(world);
        steps(world, 10, dt);
        assert_true(skein_world_hash(world) == hash);
        OK(world, skein_set(world, b, "enabled", skein_number(1)));
        steps(world, 10, dt);
        skein_world_destroy(world);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(what_rests_sleeps_and_counts),
        cmocka_unit_test(it_is_measured_as_if_awake),
        cmocka_unit_test(those_who_touch_sleep_together),
        cmocka_unit_test(what_falls_wakes_before_it_lands),
        cmocka_unit_test(colliders_wake_whom_they_come_near),
        cmocka_unit_test(calls_wake),
        cmocka_unit_test(what_loses_its_hold_falls),
        cmocka_unit_test(what_a_collider_held_falls),
        cmocka_unit_test(what_lies_on_a_plane_slides),
        cmocka_unit_test(what_stands_pinned_wakes),
        cmocka_unit_test(loose_ends_count),
        cmocka_unit_test(what_comes_back_is_joined_again),
        cmocka_unit_test(what_sets_out_fast_is_seen),
        cmocka_unit_test(vertices_that_are_led_are_seen),
        cmocka_unit_test(nobody_falls_asleep_in_the_air),
        cmocka_unit_test(who_has_nothing_to_do_with_it_sleeps_on),
        cmocka_unit_test(functions_of_a_program_keep_awake),
        cmocka_unit_test(gradients_refuse_sleep),
        cmocka_unit_test(what_may_be_moved_does_not_sleep),
        cmocka_unit_test(it_goes_on_from_anywhere),
        cmocka_unit_test(nothing_is_forgotten),
        cmocka_unit_test(it_is_replayed),
        cmocka_unit_test(without_memory_it_says_so),
        cmocka_unit_test(contact_forgets_who_is_not_there),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
