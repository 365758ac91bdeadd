/* Whole frames: against their sweeps, by two threads, and beside Bullet's soft body. */
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "bench/worlds.h"
#ifdef BENCH_BULLET
#include "bench/bullet.h"
#endif

/* ---- a frame and its sweeps ---- */

static void substep_of(const bench_scene *scene, const char *size, double bar) {
    skein_world *world = bench_cloth(scene), *swept = bench_cloth(scene);
    bench_steps(world, 20);
    bench_steps(swept, 20);
    bench_ops *ops = bench_ops_create(swept, SK_OP_PROJECT);
    if (ops) {
        bench_job jobs[] = {{.run = bench_step, .data = world}, {.run = bench_ops_run, .data = ops}};
        double seconds[2];
        bench_measure(jobs, 2, 0.1, seconds);
        bench_report(&(bench_result){.name = "substep",
                                     .size = size,
                                     .ours = 1e3 * seconds[0],
                                     .unit = "ms/frame",
                                     .other = "its sweeps alone",
                                     .theirs = 1e3 * seconds[1],
                                     .as_long = bar,
                                     .note = "10 substeps, gravity, drag"});
    }
    bench_ops_destroy(ops);
    skein_world_destroy(world);
    skein_world_destroy(swept);
}

static void run_substep(void) {
    char size[40];
    for (int n = 64; n <= (bench_quick ? 64 : 256); n *= 2) {
        snprintf(size, sizeof size, "grid %d x %d", n, n);
        substep_of(&(bench_scene){.rows = n, .columns = n, .drag = 1}, size, 1.3);
    }
    size_t vertices = bench_quick ? 1000 : 50000;
    bench_mesh mesh = bench_mesh_irregular(vertices, false);
    snprintf(size, sizeof size, "mesh of %zu", vertices);
    substep_of(&(bench_scene){.mesh = &mesh, .drag = 1}, size, 1.3);
    bench_mesh_release(&mesh);
}

const bench_case bench_substep = {"substep", "a frame of XPBD against its sweeps alone", run_substep};

/* ---- threads ---- */

/* Frames and sweeps, by one thread and by two. */
static void threads_of(bench_scene scene, const char *size, double bar) {
    skein_world *worlds[4]; // frames by one and by two, sweeps likewise
    for (int i = 0; i < 4; i++) {
        scene.threads = 1 + i % 2;
        worlds[i] = bench_cloth(&scene);
        bench_steps(worlds[i], 20);
    }
    bench_ops *ops[] = {bench_ops_create(worlds[2], SK_OP_PROJECT), bench_ops_create(worlds[3], SK_OP_PROJECT)};
    bench_job jobs[] = {{.run = bench_step, .data = worlds[0]},
                        {.run = bench_step, .data = worlds[1]},
                        {.run = bench_ops_run, .data = ops[0]},
                        {.run = bench_ops_run, .data = ops[1]}};
    double seconds[4];
    bench_measure(jobs, ops[0] && ops[1] ? 4 : 2, 0.1, seconds);
    for (int i = 0; i < (ops[0] && ops[1] ? 4 : 2); i += 2)
        bench_report(&(bench_result){.name = i ? "threads, sweeps" : "threads, frames",
                                     .size = size,
                                     .ours = 1e3 * seconds[i + 1],
                                     .unit = "ms/frame",
                                     .other = "one thread",
                                     .theirs = 1e3 * seconds[i],
                                     .faster = bar,
                                     .note = "two threads"});
    for (int i = 0; i < 2; i++) bench_ops_destroy(ops[i]);
    for (int i = 0; i < 4; i++) skein_world_destroy(worlds[i]);
}

static void run_threads(void) {
    if (sysconf(_SC_NPROCESSORS_ONLN) < 2) bench_say("one processor: two threads cannot be faster");
    char size[40];
    for (int n = bench_quick ? 64 : 128; n <= (bench_quick ? 64 : 256); n *= 2) {
        snprintf(size, sizeof size, "grid %d x %d", n, n);
        threads_of((bench_scene){.rows = n, .columns = n, .drag = 1}, size, 1.6);
    }
    size_t vertices = bench_quick ? 1000 : 20000;
    bench_mesh mesh = bench_mesh_irregular(vertices, false);
    snprintf(size, sizeof size, "mesh of %zu", vertices);
    threads_of((bench_scene){.mesh = &mesh, .drag = 1}, size, 1.5);
    bench_mesh_release(&mesh);
}

const bench_case bench_threads = {"threads", "two threads against one: whole frames, and their sweeps", run_threads};

/* ---- the W's ---- */

static const double floor_height = -0.8, ball_height = -0.45, ball_radius = 0.35, friction = 0.3, thickness = 0.002,
                    drag = 1;
static const int sweeps = 10;

/* A W: what Skein runs, and what there is to fall on. */
typedef struct contest {
    const char *name, *size;
    skein_world *world;
    bool floor, ball;
    double under, faster; /* the bars: ms a frame, and against Bullet, */
    double firm;          /* and how far 99 of 100 edges may be stretched; 0: no such bar */
    const char *settings;
} contest;

static void add_colliders(const contest *c) {
    const skein_setting rough[] = {SKEIN_REAL("friction", friction), SKEIN_REAL("thickness", thickness)};
    if (c->floor)
        bench_need(c->world,
                   skein_collider_add(c->world, "plane",
                                      SKEIN_SETTINGS(SKEIN_REAL("offset", floor_height), rough[0], rough[1]), NULL));
    if (c->ball)
        bench_need(c->world, skein_collider_add(c->world, "sphere",
                                                SKEIN_SETTINGS(SKEIN_VEC3("centre", 0, ball_height, 0),
                                                               SKEIN_REAL("radius", ball_radius), rough[0], rough[1]),
                                                NULL));
}

#ifdef BENCH_BULLET
static bullet_world *make_bullet(const contest *c) {
    size_t count = skein_particle_count(c->world);
    double *x = bench_allocate(3 * count, sizeof(double)), *masses = bench_allocate(count, sizeof(double));
    skein_view view = skein_position_view(c->world);
    skein_positions_copy(c->world, 0, count, x);
    for (size_t i = 0; i < count; i++) {
        double w = (double)view.xyzw[4 * view.slot_of[i] + 3];
        masses[i] = w > 0 ? 1 / w : 0;
    }
    uint32_t *pairs = bench_pairs(c->world);
    bullet_world *bullet = bullet_create(&(bullet_scene){.positions = x,
                                                         .masses = masses,
                                                         .particle_count = count,
                                                         .pairs = pairs,
                                                         .pair_count = bench_spring_count(c->world),
                                                         .iterations = sweeps,
                                                         .drag = drag,
                                                         .floor = c->floor,
                                                         .ball = c->ball,
                                                         .floor_height = floor_height,
                                                         .ball_height = ball_height,
                                                         .ball_radius = ball_radius,
                                                         .friction = friction,
                                                         .thickness = thickness});
    free(x);
    free(masses);
    free(pairs);
    return bullet;
}

static bench_stretch bullet_stretch(const contest *c, const bullet_world *bullet) {
    double *x = bench_allocate(3 * skein_particle_count(c->world), sizeof(double));
    bullet_positions(bullet, x);
    bench_stretch stretch = bench_stretch_at(c->world, x);
    free(x);
    return stretch;
}
#endif

/* Five blocks of a second each, in turns, from the start of the fall; stretch is that of the last frame. */
static void hold_contest(const contest *c) {
    add_colliders(c);
    size_t frames = bench_quick ? 2 : 60;
    bench_job jobs[2] = {{.run = bench_step, .data = c->world, .calls = frames}};
    double seconds[2] = {0, 0};
    bench_result result = {
        .name = c->name, .size = c->size, .unit = "ms/frame", .under = c->under, .firm = c->firm, .note = c->settings};
#ifdef BENCH_BULLET
    bullet_world *bullet = make_bullet(c);
    jobs[1] = (bench_job){.run = bullet_step, .data = bullet, .calls = frames};
    bench_measure(jobs, 2, 0, seconds);
    bench_stretch theirs = bullet_stretch(c, bullet);
    result.other = "Bullet", result.theirs = 1e3 * seconds[1], result.faster = c->faster;
    result.other_stretch = &theirs;
    bullet_destroy(bullet);
#else
    bench_measure(jobs, 1, 0, seconds);
#endif
    result.ours = 1e3 * seconds[0];
    bench_stretch ours = bench_stretch_now(c->world);
    result.stretch = &ours;
    bench_report(&result);
    skein_world_destroy(c->world);
}

static void cloth_contest(contest c, const char *pins) {
    int n = bench_quick ? 16 : 128;
    char size[40];
    snprintf(size, sizeof size, "grid %d x %d", n, n);
    c.size = size;
    c.world = bench_cloth(&(bench_scene){
        .rows = n, .columns = n, .pins = pins, .substeps = sweeps, .stiffness = BENCH_RIGID, .drag = drag});
    hold_contest(&c);
}

#define BULLET_SETTINGS "; Bullet: rigid, 1 step, piterations 10, kLST 1, kDP 0.0165, kCHR 1, kDF 1, the same friction"

static void run_w1(void) {
    cloth_contest((contest){.name = "W1",
                            .under = 0.9,
                            .faster = 15,
                            .settings = "rigid, drag 1/s, 10 substeps of 1 sweep" BULLET_SETTINGS},
                  NULL);
}

static void run_w2(void) {
    cloth_contest((contest){.name = "W2",
                            .floor = true,
                            .ball = true,
                            .under = 1.6,
                            .faster = 10,
                            .settings = "rigid, drag 1/s, friction 0.3, 10 substeps of 1 sweep" BULLET_SETTINGS},
                  "");
}

/* A rigid block shivered for ever with one sweep a substep while its springs were swept direction by direction. */
static void run_w3(void) {
    int n = bench_quick ? 4 : 20;
    char size[40];
    snprintf(size, sizeof size, "lattice %d^3", n);
    contest contests[] = {{.name = "W3",
                           .size = size,
                           .floor = true,
                           .under = 0.6,
                           .faster = 9,
                           .firm = 0.005,
                           .settings = "rigid, drag 1/s, friction 0.3, 10 substeps of 1 sweep" BULLET_SETTINGS},
                          {.name = "W3, 2 sweeps",
                           .size = size,
                           .floor = true,
                           .under = 0.7,
                           .faster = 9,
                           .settings = "rigid, drag 1/s, friction 0.3, 5 substeps of 2 sweeps" BULLET_SETTINGS}};
    for (int i = 0; i < 2; i++) {
        contests[i].world = bench_lattice(
            n,
            &(bench_scene){.substeps = sweeps / (i + 1), .iterations = i + 1, .stiffness = BENCH_RIGID, .drag = drag});
        if (contests[i].world) hold_contest(&contests[i]);
    }
}

const bench_case bench_w1 = {"w1", "frames of a cloth that hangs by two corners, beside Bullet", run_w1};
const bench_case bench_w2 = {"w2", "frames of a cloth that falls on a ball and the floor, beside Bullet", run_w2};
const bench_case bench_w3 = {"w3", "frames of a jelly cube that falls on the floor, beside Bullet", run_w3};
