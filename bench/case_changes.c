/* What a world that is changed before every step costs, against one that is let be. */
#include "bench/worlds.h"

/* A world, and which of its two sides it is on. */
typedef struct changed {
    skein_world *world;
    skein_handle object;
    bool turned;
} changed;

static void step_another_dt(void *data) {
    changed *c = data;
    c->turned = !c->turned;
    bench_need(c->world, skein_world_step(c->world, (c->turned ? 1.01 : 1) / 60.0));
}

static void step_moved_collider(void *data) {
    changed *c = data;
    c->turned = !c->turned;
    bench_need(c->world, skein_set(c->world, c->object, "centre", skein_vector(0.3, -0.4, c->turned ? 0.001 : 0)));
    bench_need(c->world, skein_world_step(c->world, 1 / 60.0));
}

static void step_turned_wind(void *data) {
    changed *c = data;
    c->turned = !c->turned;
    bench_need(c->world, skein_set(c->world, c->object, "force", skein_vector(c->turned ? 1e-7 : 0, 0, 0)));
    bench_need(c->world, skein_world_step(c->world, 1 / 60.0));
}

static void step_alone(void *data) {
    bench_need(((changed *)data)->world, skein_world_step(((changed *)data)->world, 1 / 60.0));
}

static changed make(int n) {
    changed c = {.world = bench_cloth(&(bench_scene){.rows = n, .columns = n, .drag = 1})};
    return c;
}

static changed with_sphere(int n) {
    changed c = make(n);
    bench_need(c.world, skein_collider_add(
                            c.world, "sphere",
                            SKEIN_SETTINGS(SKEIN_REAL("radius", 0.2), SKEIN_VEC3("centre", 0.3, -0.4, 0)), &c.object));
    return c;
}

static changed with_wind(int n) {
    changed c = make(n);
    bench_need(c.world, skein_force_add(c.world, "wind", NULL, &c.object));
    return c;
}

static void run_changes(void) {
    static const struct {
        const char *what;
        changed (*make)(int n);
        void (*step)(void *data);
    } kinds[] = {{"another dt", make, step_another_dt},
                 {"a collider is moved", with_sphere, step_moved_collider},
                 {"the wind turns", with_wind, step_turned_wind}};
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++) {
        int n = bench_quick ? 32 : 128;
        changed let_be = kinds[i].make(n), other = kinds[i].make(n);
        bench_steps(let_be.world, 20);
        bench_steps(other.world, 20);
        bench_job jobs[] = {{.run = kinds[i].step, .data = &other}, {.run = step_alone, .data = &let_be}};
        double seconds[2];
        bench_measure(jobs, 2, 0.1, seconds);
        bench_report(&(bench_result){.name = "changes",
                                     .size = kinds[i].what,
                                     .ours = 1e3 * seconds[0],
                                     .unit = "ms/frame",
                                     .other = "let be",
                                     .theirs = 1e3 * seconds[1],
                                     .as_long = 1.03,
                                     .note = "grid 128 x 128, 10 substeps, changed before each step"});
        skein_world_destroy(let_be.world);
        skein_world_destroy(other.world);
    }
}

const bench_case bench_changes = {
    "changes", "a step before which something was set, against one before which nothing was", run_changes};
