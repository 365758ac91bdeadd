/* Flocks on the graphics card: every rule that steers, held against the processor bird by bird after a step, and as a
 * flock after a thousand. */
#include "gpu.h"

/* ---- a flock ------------------------------------------------------------------------------------ */

/* About 30 neighbours each, going round; the hawk is seen along z. */
static skein_world *flying(const char *method, size_t count, bool hawk) {
    skein_world *world = new_world(method, 1);
    double side = 2 * cbrt((double)count / 7.2);
    OK(world, skein_body_add(world, "flock", NULL,
                             SKEIN_SETTINGS(SKEIN_TEXT("name", "birds"), SKEIN_REAL("count", (double)count),
                                            SKEIN_VEC3("spread", side, side, side), SKEIN_REAL("swirl", 4)),
                             NULL));
    OK(world, skein_force_add(world, "flocking",
                              SKEIN_SETTINGS(SKEIN_REAL("separation", 0.8), SKEIN_REAL("alignment", 0.6),
                                             SKEIN_REAL("cohesion", 0.6), SKEIN_REAL("view", hawk ? 250 : 360)),
                              NULL));
    OK(world, skein_force_add(world, "attraction", NULL, NULL));
    if (hawk)
        OK(world, skein_force_add(world, "predator",
                                  SKEIN_SETTINGS(SKEIN_REAL("radius", side / 3), SKEIN_VEC3("line", 0, 0, 2)), NULL));
    OK(world, skein_force_add(world, "speed_limit", SKEIN_SETTINGS(SKEIN_REAL("limit", 6)), NULL));
    return world;
}

static void a_flock_agrees_after_a_step(void **state) {
    (void)state;
    static const size_t counts[] = {1, 33, 1024, 4096, 16384};
    for (size_t i = 0; i < COUNT(counts); i++)
        assert_agree(flying("symplectic_euler", counts[i], i % 2), flying("symplectic_euler", counts[i], i % 2), 1,
                     1e-5, "a flock");
    for (size_t m = 0; m < COUNT(explicit_methods); m++)
        assert_agree(flying(explicit_methods[m], 300, true), flying(explicit_methods[m], 300, true), 2, 1e-4,
                     explicit_methods[m]);
}

/* Steps one world with a rule as it is set here and one without, both on the card: they must part. */
static void assert_matters(skein_world *with, skein_world *without, const char *path, skein_value off, int steps) {
    to_card(with);
    to_card(without);
    OK(without, skein_set_path(without, path, off));
    for (int i = 0; i < steps; i++) {
        OK(with, skein_world_step(with, dt));
        OK(without, skein_world_step(without, dt));
    }
    assert_true(difference(with, without) > 0.01);
    skein_world_destroy(with);
    skein_world_destroy(without);
}

/* Kept from turning, climbing and leaving, and looking out for what is in the way. */
static skein_world *kept(const char *method, bool ball) {
    skein_world *world = flying(method, 400, true);
    OK(world,
       skein_force_add(world, "turn_limit", SKEIN_SETTINGS(SKEIN_REAL("turn", 60), SKEIN_REAL("climb", 20)), NULL));
    if (ball)
        OK(world, skein_force_add(world, "bounds",
                                  SKEIN_SETTINGS(SKEIN_TEXT("shape", "sphere"), SKEIN_REAL("radius", 3)), NULL));
    else
        OK(world, skein_force_add(world, "bounds",
                                  SKEIN_SETTINGS(SKEIN_VEC3("size", 6, 7, 5), SKEIN_VEC3("centre", 0.5, 0, 0)), NULL));
    OK(world, skein_force_add(world, "lookout", SKEIN_SETTINGS(SKEIN_REAL("ahead", 0.5)), NULL));
    OK(world, skein_collider_add(world, "capsule", SKEIN_SETTINGS(SKEIN_VEC3("motion.velocity", 1, 0, 0)), NULL));
    // (who is stopped by friction has no direction of flight but rounding's, and these rules ask for one)
    OK(world,
       skein_collider_add(world, "plane", SKEIN_SETTINGS(SKEIN_REAL("offset", -3), SKEIN_REAL("friction", 0)), NULL));
    return world;
}

static void a_flock_that_is_kept_agrees(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(explicit_methods); m++)
        assert_agree(kept(explicit_methods[m], m % 2), kept(explicit_methods[m], m % 2), 2, 1e-4, explicit_methods[m]);
    // the tests above are about something: each rule alone changes where the birds go
    static const char *const rules[] = {"forces.2.enabled", "forces.4.enabled", "forces.5.enabled", "forces.6.enabled"};
    for (size_t r = 0; r < COUNT(rules); r++)
        assert_matters(kept("symplectic_euler", false), kept("symplectic_euler", false), rules[r], skein_number(0), 2);
}

/* ---- the nearest few ---------------------------------------------------------------------------- */

static skein_world *minding(size_t count, double nearest, bool hawk) {
    skein_world *world = flying("symplectic_euler", count, hawk);
    OK(world, skein_set_path(world, "forces.0.nearest", skein_number(nearest)));
    return world;
}

static void the_nearest_agree(void **state) {
    (void)state;
    static const struct {
        size_t count;
        double nearest;
    } few[] = {{1, 3}, {5, 7}, {700, 1}, {2000, 7}, {1500, 20}, {600, 64}};
    for (size_t i = 0; i < COUNT(few); i++)
        assert_agree(minding(few[i].count, few[i].nearest, i % 2), minding(few[i].count, few[i].nearest, i % 2), 1,
                     1e-5, "the nearest");
    assert_matters(minding(300, 7, true), minding(300, 7, true), "forces.0.nearest", skein_number(0), 2);
    // more than there are in reach are all of them
    skein_world *all = minding(200, 0, false), *most = minding(200, 64, false);
    assert_matters(minding(200, 64, false), minding(200, 3, false), "forces.0.nearest", skein_number(3), 2);
    to_card(all);
    to_card(most);
    OK(all, skein_world_step(all, dt));
    OK(most, skein_world_step(most, dt));
    assert_under(difference(all, most), 1e-5);
    skein_world_destroy(all);
    skein_world_destroy(most);
}

/* ---- a predator among them ---------------------------------------------------------------------- */

/* Bird 7 is a hawk, too: several substeps, each of which looks where it is then. */
static skein_world *hunted(const char *method, bool only_birds) {
    skein_world *world = new_world(method, 3);
    scatter(world, 40, 3, 9);
    OK(world, skein_body_add(world, "flock", NULL,
                             SKEIN_SETTINGS(SKEIN_TEXT("name", "birds"), SKEIN_REAL("count", 300),
                                            SKEIN_VEC3("spread", 6, 6, 6), SKEIN_REAL("speed", 20)),
                             NULL));
    OK(world, skein_force_add(world, "predator",
                              SKEIN_SETTINGS(SKEIN_REAL("particle", only_birds ? 47 : 7), SKEIN_REAL("radius", 3),
                                             SKEIN_VEC3("line", 0, 0, 1), SKEIN_REAL("strength", 40),
                                             SKEIN_TEXT("on", only_birds ? "birds" : "")),
                              NULL));
    OK(world, skein_force_add(world, "flocking",
                              SKEIN_SETTINGS(SKEIN_REAL("separation", 0.5), SKEIN_REAL("alignment", 0.5),
                                             SKEIN_REAL("cohesion", 0.5)),
                              NULL));
    OK(world,
       skein_force_add(world, "predator", SKEIN_SETTINGS(SKEIN_REAL("particle", 100), SKEIN_REAL("radius", 1)), NULL));
    OK(world, skein_force_add(world, "speed_limit", SKEIN_SETTINGS(SKEIN_REAL("limit", 15)), NULL));
    return world;
}

static void a_predator_among_them_agrees(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(explicit_methods); m++)
        assert_agree(hunted(explicit_methods[m], m % 2), hunted(explicit_methods[m], m % 2), 2, 1e-4,
                     explicit_methods[m]);
    assert_matters(hunted("xpbd", false), hunted("xpbd", false), "forces.0.particle", skein_number(8), 2);
    // in parts, where a binding is too small for a vector: the hawk is in one of them
    skein_world *cpu = new_world("symplectic_euler", 3), *gpu = new_world("symplectic_euler", 3);
    for (int w = 0; w < 2; w++) {
        scatter(w ? gpu : cpu, 500, 3, 9);
        OK(w ? gpu : cpu, skein_force_add(w ? gpu : cpu, "predator",
                                          SKEIN_SETTINGS(SKEIN_REAL("particle", 350), SKEIN_REAL("radius", 3)), NULL));
    }
    to_card(gpu);
    ((sk_gpu_device *)(void *)gpu->device)->most_bytes = 16 * 128;
    for (int i = 0; i < 2; i++) {
        OK(cpu, skein_world_step(cpu, dt));
        OK(gpu, skein_world_step(gpu, dt));
    }
    assert_under(difference(cpu, gpu), 1e-4 * FLOAT_OFF);
    skein_world_destroy(cpu);
    skein_world_destroy(gpu);
}

/* ---- periodic edges ----------------------------------------------------------------------------- */

static skein_world *round_and_round(const char *method, const char *edge) {
    skein_world *world = flying(method, 400, false);
    scatter(world, 100, 9, 5); // some of them held, who stay where they are
    OK(world, skein_force_add(world, "bounds",
                              SKEIN_SETTINGS(SKEIN_VEC3("size", 6, 7, 5), SKEIN_VEC3("centre", 0.5, 0, 0),
                                             SKEIN_TEXT("edge", edge)),
                              NULL));
    return world;
}

static void periodic_edges_agree(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(explicit_methods); m++)
        assert_agree(round_and_round(explicit_methods[m], "periodic"), round_and_round(explicit_methods[m], "periodic"),
                     3, 1e-4, explicit_methods[m]);
    assert_matters(round_and_round("xpbd", "periodic"), round_and_round("xpbd", "periodic"), "forces.3.edge",
                   skein_text("wall"), 2);
    // who comes in at the other side does not fly there: between steps it is near where it is after
    skein_world *cpu = round_and_round("symplectic_euler", "periodic"),
                *gpu = round_and_round("symplectic_euler", "periodic");
    to_card(gpu);
    double blend[2][3 * 500];
    skein_world *both[] = {cpu, gpu};
    for (int w = 0; w < 2; w++) {
        OK(both[w], skein_world_step(both[w], dt));
        OK(both[w], skein_positions_blend(both[w], 0.5, 0, 500, blend[w]));
    }
    for (int i = 0; i < 1500; i++) assert_near(blend[0][i], blend[1][i], 1e-4);
    skein_world_destroy(cpu);
    skein_world_destroy(gpu);
}

/* ---- formulas ----------------------------------------------------------------------------------- */

/* Weights by formula, one that minds the time, of all or of the nearest; or only one of the two. */
static skein_world *by_formula(const char *method, int which) {
    skein_world *world = flying(method, 400, which == 1);
    OK(world, skein_set_path(
                  world, "forces.0.formula.towards",
                  skein_text(which == 2 ? "" : "1.5*relative_distance - 0.2/(relative_distance + 0.01) + sin(40*t)")));
    OK(world,
       skein_set_path(
           world, "forces.0.formula.along",
           skein_text(which == 0 ? ""
                                 : "sqrt(relative_distance)*exp(-relative_distance^2) + min(relative_distance, 0.5)")));
    OK(world, skein_set_path(world, "forces.0.nearest", skein_number(which == 1 ? 7 : 0)));
    OK(world, skein_set_path(world, "forces.0.strength", skein_number(3)));
    return world;
}

static void weights_by_formula_agree(void **state) {
    (void)state;
    for (int which = 0; which < 3; which++)
        for (int m = 0; m < 2; m++)
            assert_agree(by_formula(method_names[m], which), by_formula(method_names[m], which), 2, 1e-4,
                         "a flock by formula");
    assert_matters(by_formula("xpbd", 1), by_formula("xpbd", 1), "forces.0.formula.along", skein_text("0"), 2);
    // where there is no number the weight is 0
    skein_world *world = by_formula("xpbd", 0);
    to_card(world);
    OK(world, skein_set_path(world, "forces.0.formula.towards", skein_text("exp(1e3*relative_distance)^9")));
    OK(world, skein_world_step(world, dt));
    skein_statistics statistics;
    OK(world, skein_world_statistics(world, &statistics));
    assert_int_equal(statistics.nonfinite, 0);
    skein_world_destroy(world);
}

/* Fields and potentials, in one shader, each with parameters of its own, under substeps that the time passes in. */
static skein_world *in_fields(const char *method) {
    skein_world *world = new_world(method, 4);
    OK(world, skein_force_add(world, "force_field",
                              SKEIN_SETTINGS(SKEIN_TEXT("force", "vec3(-k*p.x + 5*sin(w*t), -2*v.y, sqrt(abs(p.z)))"),
                                             SKEIN_REAL("parameters.k", 3), SKEIN_REAL("parameters.w", 30)),
                              NULL));
    OK(world, skein_force_add(world, "potential",
                              SKEIN_SETTINGS(SKEIN_TEXT("energy", "a*length(p) + b*p.x*p.y*t + c*exp(-p.z^2)*d*e"),
                                             SKEIN_REAL("parameters.a", 2), SKEIN_REAL("parameters.b", -3),
                                             SKEIN_REAL("parameters.c", 1.5), SKEIN_REAL("parameters.d", 2),
                                             SKEIN_REAL("parameters.e", 0.7), SKEIN_TEXT("per", "particle")),
                              NULL));
    OK(world, skein_force_add(world, "force_field",
                              SKEIN_SETTINGS(SKEIN_TEXT("force", "let r = length(p) + 1; cross(p, v)/r^3"),
                                             SKEIN_TEXT("per", "particle")),
                              NULL));
    scatter(world, 300, 2, 7);
    return world;
}

static void fields_by_formula_agree(void **state) {
    (void)state;
    static const char *const rules[] = {"forces.0.enabled", "forces.1.enabled", "forces.2.enabled"};
    for (size_t m = 0; m < COUNT(explicit_methods); m++)
        assert_agree(in_fields(explicit_methods[m]), in_fields(explicit_methods[m]), 5, 1e-4, explicit_methods[m]);
    for (size_t r = 0; r < COUNT(rules); r++)
        assert_matters(in_fields("rk4"), in_fields("rk4"), rules[r], skein_number(0), 10);
    // a field that is over all bounds is none, and another text is another field
    skein_world *world = in_fields("symplectic_euler");
    to_card(world);
    OK(world, skein_world_step(world, dt));
    OK(world, skein_set_path(world, "forces.0.force", skein_text("vec3(k*w*exp(80*exp(5 + 0*p.x)), 1e30*p.y, 0)")));
    OK(world, skein_world_step(world, dt));
    skein_statistics statistics;
    OK(world, skein_world_statistics(world, &statistics));
    assert_int_equal(statistics.nonfinite, 0);
    assert_true(statistics.kinetic_energy < 1e4);
    skein_world_destroy(world);
}

static void a_profile_is_one_pass(void **state) {
    (void)state;
    skein_world *world = flying("symplectic_euler", 300, false);
    skein_pass passes[4];
    size_t count;
    to_card(world);
    OK(world, skein_world_profile(world, dt, passes, COUNT(passes), &count));
    assert_int_equal(count, 1);
    assert_true(passes[0].seconds > 0);
    skein_world_destroy(world);
}

/* What neighbours within 2 make of a bird's velocity in a step, looking at all of them (flocking.h). */
static void add_steering(const double *x, const double *v, size_t count, size_t i, double out[3]) {
    for (size_t j = 0; j < count; j++) {
        double d[3], square = 0, speed = 0;
        for (int k = 0; k < 3; k++) {
            d[k] = x[3 * j + (size_t)k] - x[3 * i + (size_t)k];
            square += d[k] * d[k];
            speed += v[3 * j + (size_t)k] * v[3 * j + (size_t)k];
        }
        double distance = sqrt(square), relative_distance = distance / 2;
        if (!(distance > 0) || !(relative_distance < 1)) continue;
        double towards = 0, with = 0;
        if (relative_distance < 0.4) towards = 1 - 0.4 / relative_distance;
        else if (relative_distance < 0.7) with = 1 - 0.5 * cos(2 * PI * (relative_distance - 0.4) / 0.3);
        else towards = 0.5 * cos(2 * PI * (relative_distance - 0.7) / 0.3);
        for (int k = 0; k < 3; k++)
            out[k] += dt * (towards * d[k] / distance + with * v[3 * j + (size_t)k] / sqrt(speed));
    }
}

static void the_cards_grid_is_all_pairs(void **state) {
    (void)state;
    for (size_t count = 1024; count <= 16384; count *= 4) {
        skein_world *world = flying("symplectic_euler", count, false);
        OK(world, skein_set_path(world, "forces.1.enabled", skein_number(0)));
        OK(world, skein_set_path(world, "forces.2.limit", skein_number(1e6)));
        double *before = calloc(9 * count, sizeof *before), *v = before + 3 * count, *after = before + 6 * count;
        OK(world, skein_positions_copy(world, 0, count, before));
        OK(world, skein_velocities_copy(world, 0, count, v));
        to_card(world);
        OK(world, skein_world_step(world, dt));
        OK(world, skein_velocities_copy(world, 0, count, after));
        double moved = 0;
        for (size_t i = 0; i < count; i += count / 256) {
            double ought[3] = {v[3 * i], v[3 * i + 1], v[3 * i + 2]};
            add_steering(before, v, count, i, ought);
            for (int k = 0; k < 3; k++) {
                assert_near(after[3 * i + (size_t)k], ought[k], 1e-5);
                moved = fmax(moved, fabs(ought[k] - v[3 * i + (size_t)k]));
            }
        }
        assert_true(moved > 0.1);
        free(before);
        skein_world_destroy(world);
    }
}

/* Two flocks: one minds only itself, the other only the first; a hawk frightens one; loose particles are let be. */
static skein_world *two_flocks(const char *method) {
    static const char *const names[] = {"jays", "daws"};
    skein_world *world = new_world(method, 2);
    scatter(world, 50, 3, 9);
    for (int f = 0; f < 2; f++) {
        OK(world, skein_body_add(world, "flock", NULL,
                                 SKEIN_SETTINGS(SKEIN_TEXT("name", names[f]), SKEIN_REAL("count", 400 + 300 * f),
                                                SKEIN_VEC3("spread", 6, 6, 6), SKEIN_REAL("seed", f)),
                                 NULL));
        OK(world, skein_force_add(world, "flocking",
                                  SKEIN_SETTINGS(SKEIN_REAL("separation", 0.5), SKEIN_REAL("alignment", 0.3 + 0.2 * f),
                                                 SKEIN_REAL("cohesion", 0.2), SKEIN_TEXT("on", names[f]),
                                                 SKEIN_TEXT("neighbours", "jays"), SKEIN_TEXT("measure", "distance^2")),
                                  NULL));
    }
    OK(world,
       skein_force_add(world, "predator", SKEIN_SETTINGS(SKEIN_REAL("radius", 4), SKEIN_TEXT("on", "daws")), NULL));
    OK(world,
       skein_force_add(world, "speed_limit", SKEIN_SETTINGS(SKEIN_REAL("limit", 4), SKEIN_TEXT("on", "jays")), NULL));
    return world;
}

static void flocks_that_mind_each_other_agree(void **state) {
    (void)state;
    for (int m = 0; m < 2; m++)
        assert_agree(two_flocks(method_names[m]), two_flocks(method_names[m]), 2, 1e-4, "one of two flocks");
}

/* After a thousand steps every bird is elsewhere; but the flocks are alike, in the mean of the last 300. */
static void the_flocks_stay_alike(void **state) {
    (void)state;
    enum { STAYING = 400 };
    skein_order order[2] = {{0}, {0}};
    for (int w = 0; w < 2; w++) {
        skein_world *world = flying("symplectic_euler", STAYING, false);
        if (w) to_card(world);
        for (int i = 0; i < 1000; i++) {
            OK(world, skein_world_step(world, dt));
            if (i < 700 || i % 30) continue;
            skein_order now;
            OK(world, skein_order_measure(world, 0, STAYING, (const double[3]){0, 0, 0}, 0, &now));
            order[w].polarization += now.polarization / 10, order[w].milling += now.milling / 10;
            order[w].radius += now.radius / 10, order[w].nearest += now.nearest / 10;
        }
        skein_world_destroy(world);
    }
    // (that of birds that circle is near 0: 5 % of what it can be)
    assert_near(order[1].polarization, order[0].polarization, 0.05);
    assert_share(order[1].milling, order[0].milling, 0.05);
    assert_share(order[1].radius, order[0].radius, 0.05);
    assert_share(order[1].nearest, order[0].nearest, 0.05);
}

/* Where hundreds of neighbours are in reach, as flocks gather, and cells are full. */
static skein_world *gathered(size_t count) {
    skein_world *world = flying("symplectic_euler", count, false);
    OK(world, skein_set_path(world, "forces.0.separation", skein_number(1.5)));
    OK(world, skein_set_path(world, "forces.0.alignment", skein_number(1)));
    OK(world, skein_set_path(world, "forces.0.cohesion", skein_number(1.5)));
    return world;
}

/* It agrees, and comes again in every bit, also once the state has been moved about on the card. */
static void a_gathered_flock_agrees_and_repeats(void **state) {
    (void)state;
    assert_agree(gathered(3000), gathered(3000), 1, 1e-4, "a gathered flock");
    uint64_t hash[2];
    for (int w = 0; w < 2; w++) {
        skein_world *world = gathered(500);
        to_card(world);
        for (int i = 0; i < 70; i++) {
            OK(world, skein_world_step(world, dt));
            if (w && i % 20 == 0) skein_world_hash(world); // looking changes nothing
        }
        hash[w] = skein_world_hash(world);
        skein_world_destroy(world);
    }
    assert_true(hash[0] == hash[1]);
}

static void four_thousand_birds_fly_a_hundred_steps(void **state) {
    (void)state;
    skein_world *world = flying("symplectic_euler", 100000, true);
    to_card(world);
    OK(world, skein_world_step(world, dt));
    skein_device_info info = skein_world_device(world);
    assert_true((double)info.bytes < 100.0 * 100000);
    assert_int_equal(info.pass_count, 3); // the loop of substeps, the grid, and one shader for all the rest
    skein_world_destroy(world);
    world = flying("symplectic_euler", 4096, true);
    to_card(world);
    for (int i = 0; i < 100; i++) OK(world, skein_world_step(world, dt));
    skein_statistics statistics;
    OK(world, skein_world_statistics(world, &statistics));
    assert_int_equal(statistics.nonfinite, 0);
    skein_world_destroy(world);
}

/* After some steps the state lies in the order of the cells: a step from there is the processor's, bird by bird. */
static void birds_that_were_moved_are_the_same_birds(void **state) {
    (void)state;
    skein_world *cpu = flying("symplectic_euler", 500, true), *gpu = flying("symplectic_euler", 500, true);
    double *now = calloc(6 * 500, sizeof *now);
    to_card(gpu);
    for (int i = 0; i < 4; i++) OK(gpu, skein_world_step(gpu, dt));
    assert_null(skein_world_device(gpu).slot_of);
    assert_true(skein_world_device(gpu).particle_buffer != 0);
    OK(gpu, skein_positions_copy(gpu, 0, 500, now));
    OK(gpu, skein_velocities_copy(gpu, 0, 500, now + 1500));
    OK(cpu, skein_positions_set(cpu, 0, 500, now));
    OK(cpu, skein_velocities_set(cpu, 0, 500, now + 1500));
    OK(cpu, skein_world_step(cpu, dt));
    OK(gpu, skein_world_step(gpu, dt));
    assert_under(difference(cpu, gpu), 1e-5);
    // a rule for some of them only: now slots matter, and are the world's again
    for (int w = 0; w < 2; w++) {
        skein_world *world = w ? gpu : cpu;
        scatter(world, 20, 3, 77);
        OK(world, skein_set_path(world, "forces.0.on", skein_text("birds")));
        OK(world, skein_world_step(world, dt));
    }
    assert_non_null(skein_world_device(gpu).slot_of);
    assert_under(difference(cpu, gpu), 1e-4 * FLOAT_OFF);
    free(now);
    skein_world_destroy(cpu);
    skein_world_destroy(gpu);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_flock_agrees_after_a_step),
        cmocka_unit_test(a_flock_that_is_kept_agrees),
        cmocka_unit_test(the_nearest_agree),
        cmocka_unit_test(a_predator_among_them_agrees),
        cmocka_unit_test(periodic_edges_agree),
        cmocka_unit_test(weights_by_formula_agree),
        cmocka_unit_test(fields_by_formula_agree),
        cmocka_unit_test(a_profile_is_one_pass),
        cmocka_unit_test(the_cards_grid_is_all_pairs),
        cmocka_unit_test(flocks_that_mind_each_other_agree),
        cmocka_unit_test(the_flocks_stay_alike),
        cmocka_unit_test(a_gathered_flock_agrees_and_repeats),
        cmocka_unit_test(four_thousand_birds_fly_a_hundred_steps),
        cmocka_unit_test(birds_that_were_moved_are_the_same_birds),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
