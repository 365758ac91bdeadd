/* Every instruction set that the processor has, side by side: the same worlds, whose states must have the same hash. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/isa.h"
#include "bench/worlds.h"

enum { WIDTHS = 3, MESH = 20164, BIRDS = 16384 };
static const char *const sets[WIDTHS] = {"avx512", "avx2", "sse"};

/* ---- the worlds ---- */

static int side(void) {
    return bench_quick ? 16 : 128;
}

static skein_world *hanging(void) {
    return bench_cloth(&(bench_scene){.rows = side(), .columns = side(), .stiffness = BENCH_RIGID, .drag = 1});
}

static skein_world *damped(void) {
    return bench_cloth(&(bench_scene){.rows = side(), .columns = side(), .damping = 0.1, .iterations = 2});
}

/* So soft that it is stable: states that blew up are NaNs, whose bits are nobody's promise. */
static skein_world *by_forces(void) {
    return bench_cloth(&(bench_scene){
        .rows = side(), .columns = side(), .method = "symplectic_euler", .stiffness = 1e-3, .damping = 1e-6});
}

static skein_world *irregular(void) {
    static bench_mesh mesh; // the worlds have their own copies
    if (!mesh.mesh.vertex_count) mesh = bench_mesh_irregular(bench_quick ? 400 : MESH, true);
    return bench_cloth(&(bench_scene){.mesh = &mesh, .drag = 1});
}

static skein_world *jelly(void) {
    return bench_lattice(bench_quick ? 4 : 20, &(bench_scene){.substeps = 5, .iterations = 2, .drag = 1});
}

/* Lies on a ball and the floor. */
static skein_world *draped(void) {
    skein_world *world =
        bench_cloth(&(bench_scene){.rows = side(), .columns = side(), .pins = "", .stiffness = BENCH_RIGID, .drag = 1});
    bench_need(world, skein_collider_add(world, "plane", SKEIN_SETTINGS(SKEIN_REAL("offset", -0.3)), NULL));
    bench_need(world,
               skein_collider_add(world, "sphere",
                                  SKEIN_SETTINGS(SKEIN_REAL("radius", 0.2), SKEIN_VEC3("centre", 0, -0.21, 0)), NULL));
    return world;
}

/* What a user gets who says nothing: bending by angles, tethers, a limit. */
static skein_world *by_default(void) {
    skein_world *world = bench_world(1);
    bench_need(world, skein_body_add(
                          world, "cloth", NULL,
                          SKEIN_SETTINGS(SKEIN_PAIR("grid", side(), side()), SKEIN_TEXT("pins", "top corners")), NULL));
    bench_need(world, skein_force_add(world, "gravity", NULL, NULL));
    bench_need(world, skein_method_set(world, "xpbd", SKEIN_SETTINGS(SKEIN_REAL("substeps", 10))));
    return world;
}

/* Forces on every particle, one after the other. */
static skein_world *windy(void) {
    skein_world *world = by_forces();
    static const char *const names[] = {"wind", "drag", "attraction", "speed_limit"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        bench_need(world, skein_force_add(world, names[i],
                                          i == 1 ? SKEIN_SETTINGS(SKEIN_REAL("quadratic", 1e-4)) : NULL, NULL));
    bench_need(world, skein_set_path(world, "bodies.0.stretch.stiffness", skein_number(0)));
    bench_need(world, skein_set_path(world, "bodies.0.shear.stiffness", skein_number(0)));
    bench_need(world, skein_set_path(world, "bodies.0.bend.stiffness", skein_number(0)));
    return world;
}

/* A force by a formula, on its tape. */
static skein_world *in_a_field(void) {
    skein_world *world = hanging();
    bench_need(world, skein_force_add(
                          world, "force_field",
                          SKEIN_SETTINGS(SKEIN_TEXT("force", "vec3(sin(3*p.x + t), 0.2*exp(-p.y^2), p.z*v.x)")), NULL));
    return world;
}

static skein_world *birds(void) {
    skein_world *world = bench_world(1);
    double count = bench_quick ? 500 : BIRDS, spread = bench_quick ? 25 : 80;
    bench_need(world, skein_method_set(world, "symplectic_euler", SKEIN_SETTINGS(SKEIN_REAL("substeps", 1))));
    bench_need(world,
               skein_body_add(world, "flock", NULL,
                              SKEIN_SETTINGS(SKEIN_REAL("count", count), SKEIN_VEC3("spread", spread, spread, spread)),
                              NULL));
    bench_need(world, skein_force_add(world, "flocking",
                                      SKEIN_SETTINGS(SKEIN_REAL("separation", 3), SKEIN_REAL("alignment", 4.0 / 3),
                                                     SKEIN_REAL("cohesion", 7.0 / 3)),
                                      NULL));
    return world;
}

static skein_world *implicit(void) {
    int n = bench_quick ? 9 : 33;
    return bench_cloth(&(bench_scene){.rows = n, .columns = n, .method = "backward_euler", .substeps = 1});
}

/* ---- side by side ---- */

/* The world as an instruction set works it; NULL if the processor lacks that. */
static skein_world *made_by(const char *set, skein_world *(*make)(void)) {
    setenv("SKEIN_SIMD", set, 1);
    bool there = !strcmp(sk_isa_text(sk_isa_choose()), set);
    skein_world *world = there ? make() : NULL;
    if (world) bench_steps(world, bench_quick ? 2 : 20);
    return world;
}

static void compare(const char *name, skein_world *(*make)(void), const double bars[WIDTHS]) {
    skein_world *worlds[WIDTHS];
    bench_job jobs[WIDTHS];
    double seconds[WIDTHS];
    int made[WIDTHS], count = 0;
    for (int i = 0; i < WIDTHS; i++) {
        worlds[count] = made_by(sets[i], make);
        if (!worlds[count]) continue;
        if (skein_world_hash(worlds[count]) != skein_world_hash(worlds[0]))
            bench_fault("%s: %s has other bits than %s", name, sets[i], sets[made[0]]);
        jobs[count] = (bench_job){.run = bench_step, .data = worlds[count]};
        made[count++] = i;
    }
    if (count) bench_measure(jobs, (size_t)count, 0.2, seconds);
    for (int k = 0; k < count; k++) {
        int i = made[k];
        bench_report(&(bench_result){.name = name,
                                     .size = sets[i],
                                     .ours = 1e3 * seconds[k],
                                     .unit = "ms/step",
                                     .other = k ? sets[made[0]] : NULL,
                                     .theirs = k ? 1e3 * seconds[0] : 0,
                                     .as_long = k && made[0] == 0 ? bars[i] : 0});
        skein_world_destroy(worlds[k]);
    }
}

static void run_widths(void) {
    static const struct {
        const char *name;
        skein_world *(*make)(void);
        double bars[WIDTHS];
    } cases[] = {
        {"widths: w1", hanging, {0, 1.6, 2.9}},
        {"widths: damped, 2 sweeps", damped, {0, 2, 3.5}},
        {"widths: draped", draped, {0, 2, 3.5}},
        {"widths: jelly", jelly, {0, 2, 3.5}},
        {"widths: irregular mesh", irregular, {0, 2, 3.5}},
        {"widths: default cloth", by_default, {0, 2, 3.5}},
        {"widths: by forces", by_forces, {0, 2, 3.5}},
        {"widths: wind and others", windy, {0, 2, 3.5}},
        {"widths: force field", in_a_field, {0, 2, 3.5}},
        {"widths: backward Euler", implicit, {0, 2, 3.5}},
        {"widths: flock", birds, {0, 2, 3.5}},
    };
    const char *asked = getenv("SKEIN_SIMD");
    char *before = asked ? strdup(asked) : NULL;
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) compare(cases[i].name, cases[i].make, cases[i].bars);
    if (before) setenv("SKEIN_SIMD", before, 1);
    else unsetenv("SKEIN_SIMD");
    free(before);
}

const bench_case bench_widths = {"widths", "the same worlds by every instruction set, one beside the other", run_widths};
