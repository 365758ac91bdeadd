/* Wind on triangles, whichever way they are walked: each particle's force is that of the formula, summed in double over
 * the triangles of its body one by one. (What the formula says of a flat sheet is in test_motion.c.) */
#include "all_methods.h"
#include "helpers.h"

enum { MOST_VERTICES = 2500, MOST_FACES = 5000, MOST_BODIES = 3 };

/* A mesh; `order` says how its faces are cut, or that there is no grid in it. */
typedef struct sheet {
    double position[MOST_VERTICES][3];
    uint32_t size[MOST_FACES], corner[4 * MOST_FACES];
    size_t vertices, faces, corners;
} sheet;

typedef enum cut { QUADS, DOWN, UP, BOTH, HOLED, SHUFFLED } cut;
static const char *const cut_names[] = {"quads", "down", "up", "both", "holed", "shuffled"};

static void add_face(sheet *s, size_t count, const uint32_t *corner) {
    s->size[s->faces++] = (uint32_t)count;
    for (size_t k = 0; k < count; k++) s->corner[s->corners++] = corner[k];
}

/* rows x columns vertices, crumpled, so that no two triangles are alike. */
static sheet *make_sheet(uint32_t rows, uint32_t columns, cut sort) {
    static sheet s;
    static uint32_t name[MOST_VERTICES];
    uint64_t seed = 99;
    s = (sheet){.vertices = (size_t)rows * columns};
    assert_true(s.vertices <= MOST_VERTICES);
    for (uint32_t i = 0; i < s.vertices; i++) name[i] = i;
    for (uint32_t i = (uint32_t)s.vertices; i-- > 1 && sort == SHUFFLED;) {
        uint32_t j = (uint32_t)random_between(&seed, 0, i + 0.999), kept = name[i];
        name[i] = name[j], name[j] = kept;
    }
    for (uint32_t r = 0; r < rows; r++)
        for (uint32_t c = 0; c < columns; c++) {
            double *p = s.position[name[r * columns + c]];
            p[0] = 0.1 * c + random_between(&seed, -0.03, 0.03), p[1] = random_between(&seed, -0.05, 0.05);
            p[2] = 0.1 * r + random_between(&seed, -0.03, 0.03);
        }
    for (uint32_t r = 0; r + 1 < rows; r++)
        for (uint32_t c = 0; c + 1 < columns; c++) {
            const uint32_t *n = &name[r * columns + c];
            uint32_t quad[4] = {n[0], n[columns], n[columns + 1], n[1]};
            bool up = sort == UP || (sort != DOWN && (r + c) % 2);
            if (sort == HOLED && (r * 7 + c * 3) % 11 == 4) continue;
            if (sort == QUADS || sort == HOLED) {
                add_face(&s, 4, quad);
                continue;
            }
            add_face(&s, 3, up ? (uint32_t[]){quad[0], quad[1], quad[3]} : (uint32_t[]){quad[0], quad[1], quad[2]});
            add_face(&s, 3, up ? (uint32_t[]){quad[3], quad[1], quad[2]} : (uint32_t[]){quad[2], quad[3], quad[0]});
        }
    return &s;
}

/* A sheet that nothing holds together, as a body. */
static uint32_t add_sheet(skein_world *world, const sheet *s, const char *name) {
    uint32_t first = (uint32_t)skein_particle_count(world);
    skein_mesh mesh = {&s->position[0][0], s->vertices, s->size, s->faces, s->corner, s->corners};
    OK(world, skein_body_add(world, "cloth", &mesh,
                             SKEIN_SETTINGS(SKEIN_TEXT("name", name), SKEIN_REAL("density", 2),
                                            SKEIN_REAL("stretch.stiffness", 0), SKEIN_REAL("shear.stiffness", 0),
                                            SKEIN_TEXT("bend.by", "springs"), SKEIN_REAL("stretch.tether", HUGE_VAL)),
                             NULL));
    return first;
}

typedef struct wind {
    double velocity[3], drag, lift, density;
} wind;

static double dot(const double *a, const double *b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* The formula, for one triangle: adds a third to each corner's force. */
static void blow_on(const wind *w, const vec3 *x, const vec3 *v, const uint32_t c[3], double (*force)[3]) {
    double edge[3] = {x[c[1]].x - x[c[0]].x, x[c[1]].y - x[c[0]].y, x[c[1]].z - x[c[0]].z};
    double side[3] = {x[c[2]].x - x[c[0]].x, x[c[2]].y - x[c[0]].y, x[c[2]].z - x[c[0]].z};
    double n[3] = {edge[1] * side[2] - edge[2] * side[1], edge[2] * side[0] - edge[0] * side[2],
                   edge[0] * side[1] - edge[1] * side[0]};
    double u[3] = {w->velocity[0] - (v[c[0]].x + v[c[1]].x + v[c[2]].x) / 3,
                   w->velocity[1] - (v[c[0]].y + v[c[1]].y + v[c[2]].y) / 3,
                   w->velocity[2] - (v[c[0]].z + v[c[1]].z + v[c[2]].z) / 3};
    double length = sqrt(dot(n, n)), area = length / 2, speed = sqrt(dot(u, u));
    for (int k = 0; k < 3; k++) n[k] /= length;
    if (dot(u, n) < 0)
        for (int k = 0; k < 3; k++) n[k] = -n[k];
    double facing = dot(u, n);
    for (int k = 0; k < 3; k++) {
        double f = 0.5 * w->density * area *
                   ((w->drag - w->lift) * facing * u[k] + w->lift * speed * speed * n[k] * facing / speed);
        for (int i = 0; i < 3; i++) force[c[i]][k] += f / 3;
    }
}

static void blow_on_sheet(const wind *w, const sheet *s, const vec3 *x, const vec3 *v, double (*force)[3]) {
    for (size_t f = 0, at = 0; f < s->faces; at += s->size[f++])
        for (uint32_t k = 1; k + 1 < s->size[f]; k++)
            blow_on(w, x, v, (const uint32_t[]){s->corner[at], s->corner[at + k], s->corner[at + k + 1]}, force);
}

static void shake(skein_world *world, uint64_t seed) {
    for (size_t i = 0; i < skein_particle_count(world); i++)
        throw_particle(world, i, random_between(&seed, -2, 2), random_between(&seed, -2, 2),
                       random_between(&seed, -2, 2));
}

static skein_handle add_wind(skein_world *world, const wind *w, const char *on) {
    skein_handle handle;
    OK(world, skein_force_add(world, "surface_wind",
                              SKEIN_SETTINGS(SKEIN_VEC3("velocity", w->velocity[0], w->velocity[1], w->velocity[2]),
                                             SKEIN_REAL("drag", w->drag), SKEIN_REAL("lift", w->lift),
                                             SKEIN_REAL("density", w->density), SKEIN_TEXT("on", on)),
                              &handle));
    return handle;
}

static const wind breeze = {{3, -1, 2}, 0.9, 0.5, 1.2};

/* The momenta that particles from `first` on gain in a short step are the formula's forces times its length. `share`:
 * how far they may be off, of the largest. */
static void check_forces(skein_world *world, uint32_t first, const sheet *s, const wind *w, double share,
                         const char *what) {
    static vec3 x[MOST_VERTICES], v[MOST_VERTICES], after[MOST_VERTICES];
    static double force[MOST_VERTICES][3];
    const double dt = 1.0 / 4096;
    memset(force, 0, sizeof force);
    OK(world, skein_positions_copy(world, first, s->vertices, &x[0].x));
    OK(world, skein_velocities_copy(world, first, s->vertices, &v[0].x));
    if (w) blow_on_sheet(w, s, x, v, force);
    steps(world, 1, dt);
    OK(world, skein_velocities_copy(world, first, s->vertices, &after[0].x));
    skein_view view = skein_velocity_view(world);
    double largest = 0;
    for (size_t i = 0; i < s->vertices; i++)
        for (int k = 0; k < 3; k++) largest = fmax(largest, fabs(force[i][k]));
    for (size_t i = 0; i < s->vertices; i++) {
        double mass = (double)view.xyzw[4 * view.slot_of[first + i] + 3];
        double is[3] = {(after[i].x - v[i].x) * mass / dt, (after[i].y - v[i].y) * mass / dt,
                        (after[i].z - v[i].z) * mass / dt};
        for (int k = 0; k < 3; k++)
            if (!(fabs(is[k] - force[i][k]) <= share * largest + 8 * EPSILON * mass / dt))
                fail_msg("%s: particle %zu: force %g instead of %g", what, i, is[k], force[i][k]);
    }
}

/* Grids of all widths (in strips of one column, several, with empty places at their end), however their cells are cut,
 * with holes, and as meshes whose numbers follow nothing. */
static void each_particle_gets_the_formula(void **state) {
    (void)state;
    static const uint32_t grids[][2] = {{2, 2}, {3, 16}, {2, 33}, {5, 17}, {17, 18}, {40, 7}, {31, 64}, {20, 100}};
    for (size_t g = 0; g < COUNT(grids); g++)
        for (int c = QUADS; c <= SHUFFLED; c++) {
            if (grids[g][0] * grids[g][1] < 10 && c > BOTH) continue; // nothing would be left
            const sheet *s = make_sheet(grids[g][0], grids[g][1], (cut)c);
            skein_world *world = new_world("xpbd", 1);
            char what[64];
            snprintf(what, sizeof what, "%u x %u, %s", grids[g][0], grids[g][1], cut_names[c]);
            add_sheet(world, s, "a");
            shake(world, 5);
            add_wind(world, &breeze, "");
            check_forces(world, 0, s, &breeze, 1e-4 + 1e3 * EPSILON, what);
            skein_world_destroy(world);
        }
}

/* Under every method: those of several stages see the force at states a little later. */
static void every_method_has_the_same_wind(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(all_methods); m++) {
        const sheet *s = make_sheet(9, 37, QUADS);
        skein_world *world = skein_world_create(NULL, NULL);
        assert_non_null(world);
        OK(world, skein_method_set(world, all_methods[m], NULL));
        if (!strcmp(all_methods[m], "pbd"))
            OK(world, skein_method_set(world, "pbd", SKEIN_SETTINGS(SKEIN_REAL("inertia", 1))));
        add_sheet(world, s, "a");
        shake(world, 6);
        add_wind(world, &breeze, "");
        check_forces(world, 0, s, &breeze, 0.02, all_methods[m]);
        skein_world_destroy(world);
    }
}

/* Bodies of both sorts beside each other, and wind on some of them. */
static void the_wind_keeps_to_its_bodies(void **state) {
    (void)state;
    static const char *const names[MOST_BODIES] = {"a", "b", "c"};
    static const cut cuts[MOST_BODIES] = {HOLED, SHUFFLED, UP};
    static sheet sheets[MOST_BODIES];
    for (int on = 0; on < 8; on++) {
        for (size_t looked = 0; looked < MOST_BODIES; looked++) {
            skein_world *world = new_world("xpbd", 1);
            uint32_t first[MOST_BODIES];
            char list[16] = "";
            for (size_t b = 0; b < MOST_BODIES; b++) {
                sheets[b] = *make_sheet(6 + (uint32_t)b, 30, cuts[b]);
                first[b] = add_sheet(world, &sheets[b], names[b]);
                if (on & 1 << b)
                    snprintf(list + strlen(list), sizeof list - strlen(list), "%s%s", list[0] ? "," : "", names[b]);
            }
            shake(world, 7);
            if (on) add_wind(world, &breeze, list);
            check_forces(world, first[looked], &sheets[looked], on & 1 << looked ? &breeze : NULL, 1e-4, list);
            skein_world_destroy(world);
        }
    }
}

/* A sheet that flies broadside through still air: m v' = -1/2 rho A drag v^2, so v = v0/(1 + v0 t/l) with
 * l = 2 density/(rho drag). */
static void still_air_slows_as_its_equation_says(void **state) {
    (void)state;
    const double start = 6, l = 2 * 0.5 / (1.2 * 0.8), end = 0.5;
    static const char *const methods[] = {"xpbd", "leapfrog", "rk4"};
    for (size_t m = 0; m < COUNT(methods); m++) {
        skein_world *world = new_world(methods[m], 8);
        OK(world, skein_body_add(world, "cloth", NULL,
                                 SKEIN_SETTINGS(SKEIN_PAIR("grid", 12, 21), SKEIN_REAL("density", 0.5),
                                                SKEIN_VEC3("velocity", 0, start, 0), SKEIN_REAL("stretch.stiffness", 0),
                                                SKEIN_REAL("shear.stiffness", 0), SKEIN_TEXT("bend.by", "springs")),
                                 NULL));
        wind still = {{0, 0, 0}, 0.8, 0.3, 1.2};
        add_wind(world, &still, "");
        // corners bear a half of their share at one end and a whole one at the other, as their masses do not
        double energy = statistics_of(world).kinetic_energy;
        for (int i = 0; i < 30; i++) {
            steps(world, 1, end / 30);
            double now = statistics_of(world).kinetic_energy;
            assert_true(now < energy);
            energy = now;
        }
        assert_share(velocity_of(world, 6 * 21 + 10).y, start / (1 + start * end / l), 0.02);
        skein_world_destroy(world);
    }
}

/* Still air takes energy from whatever moves through it, and a triangle that is a line or a point feels nothing. */
static void nothing_is_gained_from_still_air(void **state) {
    (void)state;
    const sheet *s = make_sheet(15, 35, BOTH);
    wind still = {{0, 0, 0}, 1, 0.4, 1.2};
    skein_world *world = new_world("xpbd", 1);
    add_sheet(world, s, "a");
    shake(world, 8);
    for (size_t i = 0; i < s->vertices; i += 2) place_particle(world, i, 1, 2, 3);
    add_wind(world, &still, "");
    double energy = statistics_of(world).kinetic_energy;
    steps(world, 1, 1.0 / 4096);
    skein_statistics after = statistics_of(world);
    assert_int_equal(after.nonfinite, 0);
    assert_true(after.kinetic_energy <= energy);
    for (size_t i = 0; i < s->vertices; i++) place_particle(world, i, 1, 2, 3);
    energy = statistics_of(world).kinetic_energy;
    steps(world, 1, 1.0 / 1e6);
    assert_int_equal(statistics_of(world).nonfinite, 0);
    assert_share(statistics_of(world).kinetic_energy, energy, 1e-6);
    skein_world_destroy(world);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(each_particle_gets_the_formula),   cmocka_unit_test(every_method_has_the_same_wind),
        cmocka_unit_test(the_wind_keeps_to_its_bodies),     cmocka_unit_test(still_air_slows_as_its_equation_says),
        cmocka_unit_test(nothing_is_gained_from_still_air),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
