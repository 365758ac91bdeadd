/* What a particle, a spring and a step cost: large cloths, a short rope, rest, memory. */
#include <stdio.h>
#include <stdlib.h>

#include "bench/worlds.h"

/* ---- size ---- */

static void report_cost(const char *size, double nanoseconds, double first, double bytes) {
    bench_report(&(bench_result){.name = "scale",
                                 .size = size,
                                 .ours = nanoseconds,
                                 .unit = "ns/particle",
                                 .other = first > 0 ? "the smallest" : NULL,
                                 .theirs = first,
                                 .as_long = first > 0 ? 1.3 : 0,
                                 .note = "a step of 10 substeps, gravity, drag"});
    bench_report(
        &(bench_result){.name = "scale, memory", .size = size, .ours = bytes, .unit = "bytes/spring", .under = 200});
}

static void ignore(void *user, const char *line) {
    (void)user, (void)line;
}

/* A sheet's springs, its order and its first step's preparation, from nothing to a world that can be stepped. */
static void build_a_million(void *data) {
    (void)data;
    int side = bench_quick ? 100 : 1000;
    skein_world *world = bench_cloth(&(bench_scene){.rows = side, .columns = side});
    bench_need(world, skein_world_explain(world, 1.0 / 60, ignore, NULL)); // makes all that a step needs
    skein_world_destroy(world);
}

static void report_build(void) {
    bench_job job = {.run = build_a_million, .calls = 1};
    double seconds;
    bench_measure(&job, 1, 0, &seconds);
    bench_report(&(bench_result){.name = "scale, build",
                                 .size = bench_quick ? "grid 100 x 100" : "grid 1000 x 1000",
                                 .ours = seconds,
                                 .unit = "s",
                                 .under = 1,
                                 .note = "a world with one cloth, made ready for its first step, and destroyed"});
}

/* Sizes are timed in turns; a million particles take seconds for each of their blocks. */
static void run_scale(void) {
    static const int sides[] = {100, 316, 1000};
    int count = bench_quick ? 1 : 3;
    skein_world *worlds[3];
    bench_job jobs[3];
    double seconds[3];
    report_build();
    for (int i = 0; i < count; i++) {
        worlds[i] = bench_cloth(&(bench_scene){.rows = sides[i], .columns = sides[i], .drag = 1});
        bench_steps(worlds[i], 2);
        jobs[i] = (bench_job){.run = bench_step, .data = worlds[i]};
    }
    bench_measure(jobs, (size_t)count, 0.1, seconds);
    for (int i = 0; i < count; i++) {
        skein_statistics s;
        bench_need(worlds[i], skein_world_statistics(worlds[i], &s));
        seconds[i] /= (double)s.particles;
        char size[40];
        snprintf(size, sizeof size, "grid %d x %d", sides[i], sides[i]);
        report_cost(size, 1e9 * seconds[i], i ? 1e9 * seconds[0] : 0, (double)s.memory_bytes / (double)s.constraints);
        skein_world_destroy(worlds[i]);
    }
}

/* Meshes whose vertices are numbered at random, after a second of hanging. */
static void run_irregular(void) {
    static const size_t vertices[] = {20164, 500000};
    int count = bench_quick ? 1 : 2;
    skein_world *worlds[2];
    bench_job jobs[2];
    double seconds[2];
    bench_stretch stretch[2];
    for (int i = 0; i < count; i++) {
        bench_mesh mesh = bench_mesh_irregular(bench_quick ? 400 : vertices[i], true);
        worlds[i] = bench_cloth(&(bench_scene){.mesh = &mesh, .drag = 1});
        bench_mesh_release(&mesh);
        bench_steps(worlds[i], bench_quick || i ? 2 : 60);
        jobs[i] = (bench_job){.run = bench_step, .data = worlds[i]};
        stretch[i] = bench_stretch_now(worlds[i]);
    }
    bench_measure(jobs, (size_t)count, 0.1, seconds);
    double particle[2];
    for (int i = 0; i < count; i++) {
        particle[i] = 1e9 * seconds[i] / (double)skein_particle_count(worlds[i]);
        char size[40];
        snprintf(size, sizeof size, "%zu vertices", skein_particle_count(worlds[i]));
        bench_report(&(bench_result){.name = "irregular",
                                     .size = size,
                                     .ours = 1e3 * seconds[i],
                                     .unit = "ms/frame",
                                     .under = i ? 0 : 2.4,
                                     .stretch = i ? NULL : &stretch[i],
                                     .note = "numbered at random; 10 substeps, gravity, drag"});
        if (i)
            bench_report(&(bench_result){.name = "irregular",
                                         .size = size,
                                         .ours = particle[i],
                                         .unit = "ns/particle",
                                         .other = "the smaller one",
                                         .theirs = particle[0],
                                         .as_long = 1.4});
        skein_world_destroy(worlds[i]);
    }
}

const bench_case bench_irregular = {"irregular", "meshes numbered at random, of 20,164 and 500,000 vertices",
                                    run_irregular};

const bench_case bench_scale = {"scale", "10,000 to 1,000,000 particles: time a step, memory", run_scale};

/* ---- a short rope ---- */

/* As a body, and as constraints one after the other, which must keep to their order. */
static void run_rope(void) {
    enum { BEADS = 100 };
    for (int loose = 0; loose < 2; loose++) {
        skein_world *world = bench_world(1);
        if (loose) {
            double positions[3 * BEADS] = {0}, masses[BEADS];
            uint32_t pairs[2 * (BEADS - 1)];
            for (uint32_t i = 0; i < BEADS; i++) {
                positions[3 * i] = 0.01 * i;
                masses[i] = i ? 0.001 : 0;
                if (i) pairs[2 * i - 2] = i - 1, pairs[2 * i - 1] = i;
            }
            bench_need(world, skein_particles_add(world, BEADS, positions, NULL, masses, NULL));
            bench_need(world, skein_constraint_add(world, "distance", pairs, BEADS - 1, NULL, NULL));
        } else {
            bench_need(world,
                       skein_body_add(world, "rope", NULL,
                                      SKEIN_SETTINGS(SKEIN_REAL("count", BEADS), SKEIN_TEXT("pins", "first")), NULL));
        }
        bench_need(world, skein_force_add(world, "gravity", NULL, NULL));
        bench_steps(world, 20);
        bench_job job = {.run = bench_step, .data = world};
        double seconds;
        bench_measure(&job, 1, 0.05, &seconds);
        bench_report(&(bench_result){.name = "rope",
                                     .size = loose ? "100, constraints" : "100, a body",
                                     .ours = 1e6 * seconds,
                                     .unit = "us/step",
                                     .under = loose ? 0 : 20,
                                     .note = loose ? "99 distances one after the other, 10 substeps, gravity"
                                                   : "a rope held at one end, 10 substeps, gravity"});
        skein_world_destroy(world);
    }
}

const bench_case bench_rope = {"rope", "a step of 100 particles in a row", run_rope};

/* ---- rest ---- */

static void start_again(void *data) {
    bench_need(data, skein_world_reset(data));
    bench_steps(data, 10);
}

/* Without gravity, a strong drag takes speeds through the smallest numbers there are, and to zero. */
static void start_moving(void *data) {
    start_again(data);
    bench_shake(data, 1e-3, 1);
}

static void settled_of(bench_scene scene, const char *size, int settling, void (*start)(void *world)) {
    scene.rows = scene.columns = 64;
    skein_world *moving = bench_cloth(&scene), *settled = bench_cloth(&scene);
    start(settled);
    bench_steps(settled, settling);
    size_t calls = bench_quick ? 2 : 60;
    bench_job jobs[] = {{.run = bench_step, .data = moving, .prepare = start, .calls = calls},
                        {.run = bench_step, .data = settled, .calls = calls}};
    double seconds[2];
    bench_measure(jobs, 2, 0, seconds);
    bench_report(&(bench_result){.name = "settled",
                                 .size = size,
                                 .ours = 1e3 * seconds[1],
                                 .unit = "ms/frame",
                                 .other = "while it moves",
                                 .theirs = 1e3 * seconds[0],
                                 .as_long = 1.2});
    skein_world_destroy(moving);
    skein_world_destroy(settled);
}

static void run_settled(void) {
    settled_of((bench_scene){.drag = 4}, "hanging, 64 x 64", bench_quick ? 2 : 1800, start_again);
    // speeds pass 1e-38 after about 88/drag seconds: in the middle of what is timed, and long before it
    settled_of((bench_scene){.drag = 60, .weightless = true}, "slowing down, 64 x 64", bench_quick ? 2 : 60,
               start_moving);
    settled_of((bench_scene){.drag = 60, .weightless = true}, "at rest, 64 x 64", bench_quick ? 2 : 600, start_moving);
}

const bench_case bench_settled = {"settled", "a step of a cloth at rest against one that moves", run_settled};

/* ---- allocations ---- */

static void *count_allocation(void *user, size_t size, size_t alignment) {
    ++*(size_t *)user;
    return aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
}

static void release(void *user, void *memory, size_t size) {
    (void)user, (void)size;
    free(memory);
}

/* A ball, a floor, and a rule that looks for neighbours: everything that could grow while it runs. */
static void run_memory(void) {
    size_t calls = 0;
    skein_world_desc desc = skein_default_world_desc();
    desc.allocate = count_allocation, desc.release = release, desc.memory_user = &calls;
    skein_world *world = skein_world_create(&desc, NULL);
    if (!world) bench_stop("no memory for a world");
    bench_need(world, skein_body_add(world, "cloth", NULL, SKEIN_SETTINGS(SKEIN_PAIR("grid", 40, 40)), NULL));
    bench_need(world, skein_force_add(world, "gravity", NULL, NULL));
    bench_need(world, skein_force_add(world, "separation", SKEIN_SETTINGS(SKEIN_REAL("radius", 0.02)), NULL));
    bench_need(world, skein_collider_add(world, "plane", SKEIN_SETTINGS(SKEIN_REAL("offset", -0.8)), NULL));
    bench_need(world,
               skein_collider_add(world, "sphere",
                                  SKEIN_SETTINGS(SKEIN_VEC3("centre", 0, -0.45, 0), SKEIN_REAL("radius", 0.35)), NULL));
    bench_steps(world, 2);
    size_t before = calls;
    bench_steps(world, bench_quick ? 5 : 120);
    bench_report(&(bench_result){.name = "memory",
                                 .size = "grid 40 x 40",
                                 .ours = (double)(calls - before),
                                 .unit = "allocations",
                                 .under = 1,
                                 .note = "from the third step to the end of a fall on a ball and the floor"});
    skein_world_destroy(world);
}

const bench_case bench_memory = {"memory", "allocations after the second step", run_memory};
