/* Worlds to measure. Built through the public header; only the springs' order and the plan's ops are read from
 * within, since that is what is measured. */
#include "bench/worlds.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

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
    return batch->type->arity == 2 ? batch->count : 0;
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

/* An element and the lane of Skein's sweeps that it is in: lanes are walked in their order. */
typedef struct walked {
    uint32_t lane, element;
} walked;

static int compare_walked(const void *a, const void *b) {
    uint32_t x = ((const walked *)a)->lane, y = ((const walked *)b)->lane;
    return (x > y) - (x < y);
}

static walked *order_elements(const sk_batch *batch, bench_order order) {
    walked *elements = bench_allocate(batch->count, sizeof *elements);
    for (uint32_t e = 0; e < batch->count; e++)
        elements[e] = (walked){order == BENCH_AS_WALKED ? batch->lane[e] : e, e};
    qsort(elements, batch->count, sizeof *elements, compare_walked);
    return elements;
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

/* Springs as `listing` has them; each particle of `world` at the place that `place_of` says. */
static plain_system *make_plain(const skein_world *world, const skein_world *listing, bench_order order,
                                const uint32_t *place_of, size_t places, double h) {
    plain_system *system = plain_create(places, bench_spring_count(listing));
    if (!system) bench_stop("no memory for the plain loop");
    copy_particles(system, world, place_of);
    system->per_step = (float)(1 / (h * h));
    plain_spring *spring = system->springs;
    for (size_t b = 0; b < listing->rules.batches.count; b++) {
        const sk_batch *batch = listing->rules.batches.data[b];
        const sk_material *material = batch->params;
        walked *elements = order_elements(batch, order);
        for (size_t i = 0; i < spring_count(batch); i++, spring++) {
            size_t e = elements[i].element;
            uint32_t p = batch->particle[2 * e], q = batch->particle[2 * e + 1];
            double scale = batch->scale ? (double)batch->scale[e] : 1;
            spring->a = (int)(place_of ? place_of[p] : p), spring->b = (int)(place_of ? place_of[q] : q);
            spring->rest = (float)batch->rest[e];
            spring->stiffness = (float)(material->stiffness * scale);
            spring->compliance = 1 / spring->stiffness;
            spring->damping = (float)(material->damping * scale);
        }
        free(elements);
    }
    return system;
}

plain_system *bench_plain(const skein_world *world, bench_order order, bool as_they_lie, double h) {
    const uint32_t *place_of = as_they_lie ? world->particles.slot_of : NULL;
    size_t places = as_they_lie ? world->particles.slot_count : world->particles.count;
    return make_plain(world, world, order, place_of, places, h);
}

plain_system *bench_plain_listed_by(const skein_world *world, const skein_world *listing, double h) {
    return make_plain(world, listing, BENCH_AS_LISTED, NULL, world->particles.count, h);
}
