/* Contact's broad phase, a tree of boxes, beside a plain chained hash that finds the same pairs; and MuJoCo's drape in
 * kind. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "bench/worlds.h"
#include "contact/search/search.h"
#include "world/world.h"

/* ---- a chained hash: each box in every cell that it touches, chains of entries, pairs looked at in their first cell ---- */

typedef struct chained {
    sk_box *box; /* as they were when it was made: steps put others there */
    size_t count, entry_count, room, heads, pairs;
    double cell;
    uint32_t *head, *next, *item;
    int32_t (*cell_of)[3]; /* of entries: several cells may have one head */
} chained;

typedef int32_t cell_range[2][3];

static void cells_of(const chained *c, const sk_box *box, cell_range range) {
    for (int k = 0; k < 3; k++) {
        range[0][k] = (int32_t)floor((double)box->low[0][k] / c->cell);
        range[1][k] = (int32_t)floor((double)box->high[0][k] / c->cell);
    }
}

static uint32_t head_of(const chained *c, int32_t x, int32_t y, int32_t z) {
    return ((uint32_t)x * 73856093u ^ (uint32_t)y * 19349663u ^ (uint32_t)z * 83492791u) & (uint32_t)(c->heads - 1);
}

/* Whether this is the least cell that both are in: there the pair counts. */
static bool is_first(const cell_range a, const cell_range b, const int32_t at[3]) {
    for (int k = 0; k < 3; k++)
        if (at[k] != (a[0][k] > b[0][k] ? a[0][k] : b[0][k])) return false;
    return true;
}

static void find_by_hash(void *data) {
    chained *c = data;
    c->entry_count = c->pairs = 0;
    memset(c->head, 0xff, c->heads * sizeof *c->head);
    for (uint32_t i = 0; i < c->count; i++) {
        cell_range own, other;
        int32_t at[3];
        cells_of(c, &c->box[i], own);
        c->pairs++; // with itself, as the tree has it
        for (at[0] = own[0][0]; at[0] <= own[1][0]; at[0]++)
            for (at[1] = own[0][1]; at[1] <= own[1][1]; at[1]++)
                for (at[2] = own[0][2]; at[2] <= own[1][2]; at[2]++) {
                    uint32_t *head = &c->head[head_of(c, at[0], at[1], at[2])];
                    for (uint32_t e = *head; e != UINT32_MAX; e = c->next[e]) {
                        uint32_t j = c->item[e];
                        if (memcmp(c->cell_of[e], at, sizeof at) != 0) continue; // of another cell with this head
                        if (j == i || !sk_boxes_meet(&c->box[i], &c->box[j])) continue;
                        cells_of(c, &c->box[j], other);
                        c->pairs += is_first((const int32_t(*)[3])own, (const int32_t(*)[3])other, at);
                    }
                    if (c->entry_count == c->room) bench_stop("the hash has room for %zu entries", c->room);
                    c->item[c->entry_count] = i;
                    memcpy(c->cell_of[c->entry_count], at, sizeof at);
                    c->next[c->entry_count] = *head;
                    *head = (uint32_t)c->entry_count++;
                }
    }
}

static chained new_hash(const sk_touch *touch, double cells) {
    chained c = {.count = touch->skin.leaf_count, .heads = 1};
    double sum = 0;
    c.box = bench_allocate(c.count, sizeof *c.box);
    memcpy(c.box, touch->leaf_box, c.count * sizeof *c.box);
    for (size_t i = 0; i < c.count; i++) {
        double most = 0;
        for (int k = 0; k < 3; k++) most = fmax(most, (double)(c.box[i].high[0][k] - c.box[i].low[0][k]));
        sum += most;
    }
    c.cell = cells * sum / (double)c.count;
    while (c.heads < 2 * c.count) c.heads *= 2;
    c.room = 256 * c.count;
    c.head = bench_allocate(c.heads, sizeof *c.head);
    c.next = bench_allocate(c.room, sizeof *c.next);
    c.item = bench_allocate(c.room, sizeof *c.item);
    c.cell_of = bench_allocate(c.room, sizeof *c.cell_of);
    return c;
}

static void free_hash(chained *c) {
    free(c->box), free(c->head), free(c->next), free(c->item), free(c->cell_of);
}

/* ---- the tree ---- */

typedef struct tree_job {
    skein_world *world;
    sk_touch *touch;
} tree_job;

/* Every leaf anew, as after a step in which all of them left their courses. */
static void find_by_tree(void *data) {
    tree_job *job = data;
    bool too_many;
    memset(job->touch->anew, 1, job->touch->skin.leaf_count);
    job->touch->refit = true;
    job->touch->tasks = NULL;
    if (!sk_touch_partners(job->touch, &job->world->allocator, SIZE_MAX / 2, true, &too_many))
        bench_stop("out of memory");
}

static sk_touch *touch_of(skein_world *world) {
    for (size_t i = 0; i < world->rules.forces.count; i++)
        if (world->rules.forces.data[i]->type->meeting) return world->rules.forces.data[i]->state;
    bench_stop("no contact");
}

static skein_world *sheet(int rows, int columns, double length, double width, int substeps) {
    skein_world *world = bench_world(1);
    bench_need(world, skein_method_set(world, "xpbd", SKEIN_SETTINGS(SKEIN_REAL("substeps", substeps))));
    bench_need(world, skein_force_add(world, "gravity", NULL, NULL));
    bench_need(world, skein_force_add(world, "drag", SKEIN_SETTINGS(SKEIN_REAL("rate", 0.3)), NULL));
    bench_need(world, skein_collider_add(world, "plane", SKEIN_SETTINGS(SKEIN_REAL("friction", 0.5)), NULL));
    bench_need(world, skein_body_add(world, "cloth", NULL,
                                     SKEIN_SETTINGS(SKEIN_PAIR("grid", rows, columns), SKEIN_PAIR("size", length, width),
                                                    SKEIN_VEC3("position", 0, 0.55, 0),
                                                    SKEIN_VEC3("rotation", substeps > 1 ? 87 : 0, 10, 0)),
                                     NULL));
    bench_need(world, skein_force_add(world, "contact", SKEIN_SETTINGS(SKEIN_REAL("thickness", 0.004)), NULL));
    return world;
}

/* A sheet that stands on its edge, as it is and fallen in a heap. */
static void broad_phase(int side, int frames) {
    skein_world *world = sheet(side, side, 1, 1, 10);
    bench_steps(world, frames);
    skein_statistics s;
    bench_need(world, skein_world_statistics(world, &s)); // which puts a box around each leaf as it is
    tree_job tree = {world, touch_of(world)};
    chained hash[3];
    bench_job jobs[4] = {{.run = find_by_tree, .data = &tree}};
    for (int i = 0; i < 3; i++) {
        hash[i] = new_hash(tree.touch, 1 + 0.5 * i);
        jobs[i + 1] = (bench_job){.run = find_by_hash, .data = &hash[i]};
    }
    double seconds[4], best = INFINITY;
    bench_measure(jobs, 4, 0.1, seconds);
    for (int i = 0; i < 3; i++) {
        if (hash[i].pairs != tree.touch->partner.count)
            bench_fault("the tree finds %zu pairs, the hash %zu", tree.touch->partner.count, hash[i].pairs);
        best = fmin(best, seconds[i + 1]);
        free_hash(&hash[i]);
    }
    char size[40];
    snprintf(size, sizeof size, "%d x %d, frame %d", side, side, frames);
    bench_report(&(bench_result){.name = "all pairs of leaves anew",
                                 .size = size,
                                 .ours = 1e3 * seconds[0],
                                 .unit = "ms",
                                 .other = "chained hash",
                                 .theirs = 1e3 * best,
                                 .faster = 7,
                                 .note = "two triangles a leaf; the hash by the best of three sizes of cells"});
    skein_world_destroy(world);
}

/* What a frame costs where nothing is near: all of contact, which looks for pairs when somebody leaves the way that it
 * was expected on, and a hash that is made anew in each of ten substeps. */
static void frame_alone(int side) {
    skein_world *touching = sheet(side, side, 1, 1, 10), *free = sheet(side, side, 1, 1, 10);
    bench_need(free, skein_set_path(free, "forces.2.enabled", skein_number(0)));
    for (int i = 0; i < 2; i++) {
        skein_world *world = i ? free : touching;
        bench_need(world, skein_set_path(world, "colliders.0.enabled", skein_number(0)));
        bench_steps(world, bench_quick ? 1 : 20); // it falls, and goes on falling
    }
    skein_statistics s;
    bench_need(touching, skein_world_statistics(touching, &s));
    chained hash = new_hash(touch_of(touching), 1);
    bench_job jobs[] = {
        {.run = bench_step, .data = touching}, {.run = bench_step, .data = free}, {.run = find_by_hash, .data = &hash}};
    double seconds[3];
    bench_measure(jobs, 3, 0.1, seconds);
    char size[40];
    snprintf(size, sizeof size, "%d x %d", side, side);
    bench_report(&(bench_result){
        .name = "a frame, nothing near",
        .size = size,
        .ours = 1e3 * fmax(seconds[0] - seconds[1], 1e-6),
        .unit = "ms",
        .other = "chained hash",
        .theirs = 1e4 * seconds[2],
        .faster = 7,
        .note = "ours is all of contact, a falling sheet with it less one without; the hash ten times"});
    free_hash(&hash);
    skein_world_destroy(touching);
    skein_world_destroy(free);
}

/* ---- MuJoCo's drape ---- */

static double seconds_now(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* 507 vertices fall on a box, which is smaller than they are, and then lie there; a step of 2 ms is one substep. */
static void drape(void) {
    skein_world *world = sheet(13, 39, 1.2, 0.4, 1);
    bench_need(world, skein_collider_add(
                          world, "box",
                          SKEIN_SETTINGS(SKEIN_VEC3("centre", 0, 0.25, 0), SKEIN_VEC3("size", 0.3, 0.5, 0.3)), NULL));
    double sum = 0, worst = 0, last = 0;
    int steps = bench_quick ? 20 : 1500;
    uint64_t crossings = 0;
    for (int i = 0; i < steps; i++) {
        double start = seconds_now(), took;
        bench_need(world, skein_world_step(world, 0.002));
        took = seconds_now() - start;
        sum += took;
        worst = fmax(worst, took);
        if (i >= steps - steps / 5) last += took;
        if (i % 50) continue;
        skein_statistics s;
        bench_need(world, skein_world_statistics(world, &s));
        crossings += s.crossings;
    }
    const char *note =
        "13 x 39 particles, self-contact on; the bar is a hundredth of 27 ms, which MuJoCo 3.14 took at least";
    bench_report(&(bench_result){.name = "drape on a box, mean",
                                 .size = "507",
                                 .ours = 1e3 * sum / steps,
                                 .unit = "ms/step",
                                 .under = 0.27,
                                 .note = note});
    bench_report(&(bench_result){
        .name = "at rest", .size = "507", .ours = 5e3 * last / steps, .unit = "ms/step", .under = 0.27, .note = note});
    bench_report(&(bench_result){.name = "worst", .size = "507", .ours = 1e3 * worst, .unit = "ms/step", .note = note});
    bench_report(&(bench_result){
        .name = "crossings", .size = "507", .ours = (double)crossings, .unit = "in all", .under = 1, .note = note});
    skein_world_destroy(world);
}

static void run_broad(void) {
    drape();
    int side = bench_quick ? 12 : 100;
    frame_alone(side);
    broad_phase(side, 0);
    broad_phase(side, bench_quick ? 2 : 30);
}

const bench_case bench_broad = {"broad", "MuJoCo's drape in kind; contact's broad phase beside a chained hash",
                                run_broad};
