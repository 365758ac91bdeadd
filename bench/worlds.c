/* Worlds to measure. Built through the public header; only the springs' order and the plan's ops are read from
 * within, since that is what is measured. */
#include "bench/worlds.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "constraints/sweep.h"
#include "world/world.h"

void bench_need(skein_world *world, skein_status status) {
    if (!status) return;
    const skein_error *error = skein_world_error(world);
    bench_stop("%s%s%s", error->where, error->where[0] ? ": " : "", error->message);
}

skein_world *bench_world(int threads) {
    skein_world_desc desc = skein_default_world_desc();
    desc.thread_count = threads ? threads : 1;
    skein_error error;
    skein_world *world = skein_world_create(&desc, &error);
    if (!world) bench_stop("%s", error.message);
    return world;
}

static void add_surroundings(skein_world *world, const bench_scene *scene) {
    if (!scene->weightless) bench_need(world, skein_force_add(world, "gravity", NULL, NULL));
    if (scene->drag > 0)
        bench_need(world, skein_force_add(world, "drag", SKEIN_SETTINGS(SKEIN_REAL("rate", scene->drag)), NULL));
    const char *method = scene->method ? scene->method : "xpbd";
    bench_need(world, skein_method_set(world, method,
                                       SKEIN_SETTINGS(SKEIN_REAL("substeps", scene->substeps ? scene->substeps : 10))));
    if (scene->iterations > 1)
        bench_need(world, skein_set_path(world, "method.iterations", skein_number(scene->iterations)));
    bench_need(world, skein_world_explain(world, 1.0 / 60, NULL, NULL)); // makes the plan: slots and sweeps are found
}

skein_world *bench_cloth(const bench_scene *scene) {
    skein_world *world = bench_world(scene->threads);
    double stiffness = scene->stiffness > 0 ? scene->stiffness : 1e4, damping = scene->damping;
    const char *pins = scene->pins ? scene->pins : scene->mesh ? scene->mesh->pins : "top corners";
    skein_setting settings[] = {SKEIN_REAL("density", 0.2),
                                SKEIN_TEXT("pins", pins),
                                SKEIN_REAL("stretch.stiffness", stiffness),
                                SKEIN_REAL("shear.stiffness", stiffness),
                                SKEIN_TEXT("bend.by", "springs"),
                                SKEIN_REAL("bend.stiffness", stiffness),
                                SKEIN_REAL("stretch.damping", damping),
                                SKEIN_REAL("shear.damping", damping),
                                SKEIN_REAL("bend.damping", damping),
                                SKEIN_REAL("stretch.limit", INFINITY),
                                SKEIN_REAL("stretch.tether", INFINITY),
                                SKEIN_PAIR("grid", scene->rows, scene->columns),
                                {NULL, {0, {0, 0, 0}, NULL}}};
    if (scene->mesh) settings[sizeof settings / sizeof *settings - 2].name = NULL;
    bench_need(world, skein_body_add(world, "cloth", scene->mesh ? &scene->mesh->mesh : NULL, settings, NULL));
    add_surroundings(world, scene);
    return world;
}

skein_world *bench_lattice(int n, const bench_scene *scene) {
    skein_error error;
    if (!skein_kind_find(SKEIN_BODY, "lattice", &error)) {
        bench_say("no lattice in this build");
        return NULL;
    }
    skein_world *world = bench_world(scene->threads);
    double stiffness = scene->stiffness > 0 ? scene->stiffness : 1e4, damping = scene->damping;
    bench_need(world, skein_body_add(
                          world, "lattice", NULL,
                          SKEIN_SETTINGS(
                              SKEIN_VEC3("grid", n, n, n), SKEIN_REAL("mass", 1),
                              SKEIN_TEXT("shear.diagonals", "faces"), SKEIN_REAL("bending.springs", 0),
                              SKEIN_REAL("structural.stiffness", stiffness), SKEIN_REAL("structural.damping", damping),
                              SKEIN_REAL("shear.stiffness", stiffness), SKEIN_REAL("shear.damping", damping)),
                          NULL));
    add_surroundings(world, scene);
    return world;
}

void bench_step(void *world) {
    bench_need(world, skein_world_step(world, 1.0 / 60));
}

void bench_steps(skein_world *world, int count) {
    for (int i = 0; i < count; i++) bench_step(world);
}

/* Springs, which others have too; not what a body may have besides. */
static size_t spring_count(const sk_batch *batch) {
    return batch->type->arity == 2 && !batch->only_bounds ? batch->count : 0;
}

size_t bench_spring_count(const skein_world *world) {
    size_t count = 0;
    for (size_t b = 0; b < world->rules.batches.count; b++) count += spring_count(world->rules.batches.data[b]);
    return count;
}

void bench_shake(skein_world *world, double distance, double speed) {
    size_t count = skein_particle_count(world);
    double *x = bench_allocate(3 * count, sizeof *x), *v = bench_allocate(3 * count, sizeof *v);
    uint64_t seed = 1;
    bench_need(world, skein_positions_copy(world, 0, count, x));
    for (size_t i = 0; i < 3 * count; i++) {
        x[i] += distance * (bench_random(&seed) - 0.5);
        v[i] = speed * (bench_random(&seed) - 0.5);
    }
    bench_need(world, skein_positions_set(world, 0, count, x));
    bench_need(world, skein_velocities_set(world, 0, count, v));
    free(x);
    free(v);
}

/* ---- stretch ---- */

static int compare_doubles(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

bench_stretch bench_stretch_at(const skein_world *world, const double *x) {
    double *stretch = bench_allocate(bench_spring_count(world), sizeof *stretch), sum = 0;
    size_t count = 0;
    for (size_t i = 0; i < world->rules.batches.count; i++) {
        const sk_batch *batch = world->rules.batches.data[i];
        for (size_t e = 0; e < spring_count(batch) && batch->measured; e++) {
            const double *a = x + 3 * batch->particle[2 * e], *b = x + 3 * batch->particle[2 * e + 1];
            double rest = (double)batch->rest[e], length = hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]);
            stretch[count] = length > rest && rest > 0 ? length / rest - 1 : 0;
            sum += stretch[count++];
        }
    }
    bench_stretch result = {0};
    qsort(stretch, count, sizeof *stretch, compare_doubles);
    if (count) result = (bench_stretch){sum / (double)count, stretch[(count - 1) * 99 / 100], stretch[count - 1]};
    free(stretch);
    return result;
}

bench_stretch bench_stretch_now(const skein_world *world) {
    size_t count = skein_particle_count(world);
    double *x = bench_allocate(3 * count, sizeof *x);
    skein_positions_copy(world, 0, count, x);
    bench_stretch result = bench_stretch_at(world, x);
    free(x);
    return result;
}

/* ---- the same springs for others ---- */

uint32_t *bench_pairs(const skein_world *world) {
    uint32_t *pairs = bench_allocate(2 * bench_spring_count(world), sizeof *pairs), *next = pairs;
    for (size_t b = 0; b < world->rules.batches.count; b++) {
        const sk_batch *batch = world->rules.batches.data[b];
        size_t springs = spring_count(batch);
        if (springs) memcpy(next, batch->particle, 2 * springs * sizeof *next);
        next += 2 * springs;
    }
    return pairs;
}

static void copy_particles(plain_system *system, const skein_world *world, const uint32_t *place_of) {
    skein_view x = skein_position_view(world), v = skein_velocity_view(world);
    for (size_t i = 0; i < x.count; i++) {
        const skein_real *xi = x.xyzw + 4 * (size_t)x.slot_of[i], *vi = v.xyzw + 4 * (size_t)v.slot_of[i];
        plain_particle *p = &system->particles[place_of ? place_of[i] : i];
        for (int k = 0; k < 3; k++) p->x[k] = (float)xi[k], p->v[k] = (float)vi[k];
        p->w = (float)xi[3];
    }
}

static void put_spring(plain_system *system, const sk_batch *batch, size_t e, double share, const uint32_t *place_of) {
    const sk_material *material = batch->params;
    uint32_t p = batch->particle[2 * e], q = batch->particle[2 * e + 1];
    double scale = batch->scale ? (double)batch->scale[e] : 1;
    plain_spring *spring = &system->springs[system->spring_count++];
    *spring = (plain_spring){.a = (int)(place_of ? place_of[p] : p),
                             .b = (int)(place_of ? place_of[q] : q),
                             .rest = (float)batch->rest[e],
                             .stiffness = (float)(material->stiffness * scale),
                             .damping = (float)(material->damping * scale)};
    spring->compliance = (float)share / spring->stiffness;
}

static void put_as_listed(plain_system *system, const skein_world *world, const uint32_t *place_of) {
    for (size_t b = 0; b < world->rules.batches.count; b++) {
        const sk_batch *batch = world->rules.batches.data[b];
        for (size_t e = 0; e < spring_count(batch); e++) put_spring(system, batch, e, 1, place_of);
    }
}

/* What an op projects, lane by lane. */
static void put_as_swept(plain_system *system, const sk_op *op, const uint32_t *place_of) {
    const sk_sweep *sweep = op->rule;
    const sk_batch *batch = sweep->batch;
    size_t count = spring_count(batch) ? sk_sweep_lane_count(sweep) : 0;
    uint32_t *element = bench_allocate(count, sizeof *element); // and one, so that 0 is none
    for (size_t e = 0; e < spring_count(batch); e++)
        if (batch->lane[e] - sweep->first_lane < count) element[batch->lane[e] - sweep->first_lane] = (uint32_t)e + 1;
    for (size_t lane = 0; lane < count; lane++)
        if (element[lane] && sk_sweep_half_has(sweep, op->half, lane))
            put_spring(system, batch, element[lane] - 1, op->coefficient[0], place_of);
    free(element);
}

static void put_as_walked(plain_system *system, const skein_world *world, const uint32_t *place_of) {
    for (size_t r = 0; r < world->plan.count; r++)
        if (world->plan.data[r].kind == SK_OP_PROJECT) put_as_swept(system, &world->plan.data[r], place_of);
}

plain_system *bench_plain(const skein_world *world, bench_order order, bool as_they_lie, double h) {
    size_t places = as_they_lie ? world->particles.slot_count : world->particles.count;
    const uint32_t *place_of = as_they_lie ? world->particles.slot_of : NULL;
    plain_system *system = plain_create(places, bench_spring_count(world));
    if (!system) bench_stop("no memory for the plain loop");
    copy_particles(system, world, place_of);
    system->per_step = (float)(1 / (h * h));
    system->spring_count = 0;
    (order == BENCH_AS_WALKED ? put_as_walked : put_as_listed)(system, world, place_of);
    if (system->spring_count != bench_spring_count(world))
        bench_stop("%zu springs are swept of %zu", system->spring_count, bench_spring_count(world));
    return system;
}

/* A spring, and when a reader of the file has met both its ends, or one of them. */
typedef struct filed_spring {
    size_t both, one;
    plain_spring spring;
} filed_spring;

static int compare_filed(const void *a, const void *b) {
    const filed_spring *x = a, *y = b;
    return x->both != y->both ? (x->both > y->both) - (x->both < y->both) : (x->one > y->one) - (x->one < y->one);
}

static void sort_as_filed(plain_spring *springs, size_t count, const size_t *met) {
    filed_spring *filed = bench_allocate(count, sizeof *filed);
    for (size_t s = 0; s < count; s++) {
        size_t a = met[springs[s].a], b = met[springs[s].b];
        filed[s] = (filed_spring){a > b ? a : b, a > b ? b : a, springs[s]};
    }
    qsort(filed, count, sizeof *filed, compare_filed);
    for (size_t s = 0; s < count; s++) springs[s] = filed[s].spring;
    free(filed);
}

plain_system *bench_plain_as_filed(const skein_world *world, const skein_mesh *mesh, double h) {
    plain_system *system = bench_plain(world, BENCH_AS_LISTED, false, h);
    size_t *met = bench_allocate(mesh->vertex_count, sizeof *met), first = 0;
    for (size_t c = mesh->face_vertex_count; c-- > 0;) met[mesh->face_vertices[c]] = c;
    for (size_t b = 0; b < world->rules.batches.count; b++) {
        size_t count = spring_count(world->rules.batches.data[b]);
        sort_as_filed(system->springs + first, count, met);
        first += count;
    }
    free(met);
    return system;
}
