/* The same bits for any number of threads where whole repeats are walks: threads follow each other down the rows of
 * a grid, of a lattice and of an irregular mesh, several substeps at once. */
#include "constraints/sweep.h"
#include "helpers.h"
#include "world/world.h"

#if SPARING
enum { SUBSTEPS = 9, STEPS = 1 }; // with fewer, no thread runs ahead into the next, and a race would not show
#else
enum { SUBSTEPS = 34, STEPS = 3 };
#endif
enum { SIDE = 90, VERTICES = SIDE * SIDE, MOST_FACES = 2 * VERTICES };

/* Triangles over a square on edge, jittered, cut at random and numbered at random: no grid. */
typedef struct triangles {
    double positions[3 * VERTICES];
    uint32_t sizes[MOST_FACES], corners[3 * MOST_FACES], number[VERTICES];
    skein_mesh mesh;
} triangles;

static void make_triangles(triangles *t) {
    uint64_t seed = 5;
    for (uint32_t i = 0; i < VERTICES; i++) t->number[i] = i;
    for (uint32_t i = VERTICES; i > 1; i--) {
        uint32_t j = (uint32_t)random_between(&seed, 0, i), k = t->number[i - 1];
        t->number[i - 1] = t->number[j], t->number[j] = k;
    }
    for (int i = 0; i < VERTICES; i++) {
        double *p = t->positions + 3 * t->number[i];
        p[0] = (i % SIDE + random_between(&seed, -0.2, 0.2)) / SIDE;
        p[1] = -(i / SIDE + random_between(&seed, -0.2, 0.2)) / SIDE;
        p[2] = 0;
    }
    size_t faces = 0;
    for (uint32_t r = 0; r + 1 < SIDE; r++)
        for (uint32_t c = 0; c + 1 < SIDE; c++) {
            uint32_t a = r * SIDE + c, b = a + 1, d = a + SIDE, e = d + 1, cut = random_between(&seed, 0, 1) < 0.5;
            uint32_t corners[6] = {a, d, cut ? e : b, cut ? a : d, e, b};
            for (int k = 0; k < 6; k++) t->corners[3 * faces + (size_t)k] = t->number[corners[k]];
            t->sizes[faces] = t->sizes[faces + 1] = 3;
            faces += 2;
        }
    t->mesh = (skein_mesh){t->positions, VERTICES, t->sizes, faces, t->corners, 3 * faces};
}

typedef enum body { GRID, LATTICE, TRIANGLES, TWO_BODIES } body;

static void add_body(skein_world *world, body which) {
    static triangles t;
    char pins[64];
    if (!t.mesh.vertex_count) make_triangles(&t);
    if (which == GRID || which == TWO_BODIES)
        OK(world, skein_body_add(world, "cloth", NULL,
                                 SKEIN_SETTINGS(SKEIN_PAIR("grid", 101, 83), SKEIN_VEC3("position", 0, 0.5, 0),
                                                SKEIN_VEC3("velocity", 0.1, -2, 0), SKEIN_TEXT("pins", "top corners"),
                                                SKEIN_REAL("stretch.stiffness", 5), SKEIN_REAL("shear.stiffness", 1),
                                                SKEIN_TEXT("bend.by", "springs"), SKEIN_REAL("bend.stiffness", 0.1)),
                                 NULL));
    if (which == LATTICE)
        OK(world, skein_body_add(world, "lattice", NULL,
                                 SKEIN_SETTINGS(SKEIN_VEC3("grid", 18, 18, 18), SKEIN_VEC3("position", 0, 1, 0),
                                                SKEIN_REAL("mass", 5), SKEIN_REAL("structural.stiffness", 20),
                                                SKEIN_REAL("shear.stiffness", 10), SKEIN_REAL("bending.stiffness", 5)),
                                 NULL));
    if (which < TRIANGLES) return;
    snprintf(pins, sizeof pins, "%u, %u", t.number[0], t.number[SIDE - 1]);
    OK(world, skein_body_add(world, "cloth", &t.mesh,
                             SKEIN_SETTINGS(SKEIN_TEXT("pins", pins), SKEIN_VEC3("position", 0, 0.6, 0.2),
                                            SKEIN_REAL("stretch.stiffness", 5), SKEIN_TEXT("bend.by", "springs"),
                                            SKEIN_REAL("bend.stiffness", 0.1)),
                             NULL));
}

static uint64_t hash_of_run(const char *method, body which, bool contact, int threads) {
    skein_world_desc desc = skein_default_world_desc();
    desc.thread_count = threads;
    skein_world *world = skein_world_create(&desc, NULL);
    assert_non_null(world);
    OK(world, skein_method_set(world, method, SKEIN_SETTINGS(SKEIN_REAL("substeps", SUBSTEPS))));
    add_body(world, which);
    add_gravity(world);
    OK(world, skein_force_add(world, "drag", SKEIN_SETTINGS(SKEIN_REAL("rate", 0.5)), NULL));
    if (contact)
        OK(world, skein_collider_add(world, "sphere",
                                     SKEIN_SETTINGS(SKEIN_VEC3("centre", 0, 0.1, 0), SKEIN_REAL("radius", 0.39),
                                                    SKEIN_REAL("motion.spin", 5)),
                                     NULL));
    steps(world, STEPS, 1.0 / 90);
    skein_statistics s = statistics_of(world);
    assert_int_equal(s.nonfinite, 0);
    assert_true(!contact || s.contacts > 10);
    skein_world_destroy(world);
    return s.state_hash;
}

static void walks_do_not_depend_on_threads(void **state) {
    (void)state;
#if SPARING // which takes a hundred times as long: one count is as good as another
    static const int counts[] = {2};
#else
    static const int counts[] = {2, 3, 5, 8};
#endif
    for (size_t m = 0; m < COUNT(method_names); m++)
        for (body which = GRID; which <= TWO_BODIES; which++)
            for (int contact = 0; contact < 2; contact++) {
                if (contact && which != GRID) continue;
                uint64_t one = hash_of_run(method_names[m], which, contact, 1);
                for (size_t i = 0; i < COUNT(counts); i++) {
                    uint64_t hash = hash_of_run(method_names[m], which, contact, counts[i]);
                    if (hash != one)
                        fail_msg("%s, body %d, contact %d, %d threads", method_names[m], which, contact, counts[i]);
                }
            }
}

/* The irregular mesh's groups walk, so that all this is about something. */
static void count_walks(void *user, const char *line) {
    size_t *count = user;
    count[0] += strstr(line, "project") && strstr(line, "groups");
}

static void the_irregular_mesh_goes_in_groups(void **state) {
    (void)state;
    size_t count = 0;
    skein_world *world = skein_world_create(NULL, NULL);
    add_body(world, TRIANGLES);
    OK(world, skein_world_explain(world, 1.0 / 90, count_walks, &count));
    assert_true(count >= 4); // edges and bends, outward and round
    skein_world_destroy(world);
}

/* What is worked out together shares no particle, and groups are full though only few are open at a time. */
static void groups_that_go_together_share_no_particle(void **state) {
    (void)state;
    skein_world *world = skein_world_create(NULL, NULL);
    add_body(world, TRIANGLES);
    OK(world, skein_world_explain(world, 1.0 / 90, NULL, NULL));
    size_t elements = 0, groups = 0, together = 0;
    uint32_t *latest = calloc(world->particles.slot_count, sizeof *latest);
    for (size_t b = 0; b < world->rules.batches.count; b++) {
        const sk_batch *batch = world->rules.batches.data[b];
        for (size_t s = 0; s < batch->sweep_count; s++) {
            const sk_sweep *sweep = &batch->sweeps[s];
            size_t lanes = batch->arity * SK_LANES;
            for (size_t g = 0; g < sweep->group_count; g++) {
                assert_in_range(sweep->ahead[g], 1, sweep->group_count - g);
                memset(latest, 0, world->particles.slot_count * sizeof *latest);
                for (size_t k = g * lanes; k < (g + sweep->ahead[g]) * lanes; k++) {
                    uint32_t slot = sweep->slots[k];
                    assert_true(slot >= world->particles.spare_slot || !latest[slot]++);
                }
                together += sweep->ahead[g] > 1;
            }
            assert_true(sweep->slab_start || !strcmp(batch->label, "span") ||
                        !strcmp(batch->label, "aggregate")); // it walks; spans lead too far
            elements += sweep->element_count, groups += sweep->group_count;
        }
    }
    assert_true(elements > 10 * VERTICES / 2);
    assert_true((double)elements > 0.5 * SK_LANES * (double)groups);
    assert_true((double)together > 0.9 * (double)groups);
    free(latest);
    skein_world_destroy(world);
}

/* Lanes without an element read and write too: each slab's have slots of their own, or two threads would race for one. */
static void free_lanes_keep_to_their_slab(void **state) {
    (void)state;
    skein_world *world = skein_world_create(NULL, NULL);
    add_body(world, TRIANGLES);
    OK(world, skein_world_explain(world, 1.0 / 90, NULL, NULL));
    const sk_particles *particles = &world->particles;
    size_t unfull = 0;
    for (size_t b = 0; b < world->rules.batches.count; b++) {
        const sk_batch *batch = world->rules.batches.data[b];
        size_t lanes = batch->arity * SK_LANES;
        for (size_t s = 0; s < batch->sweep_count; s++)
            for (size_t j = 0; j + 1 < batch->sweeps[s].walk.rows; j++) {
                const sk_sweep *sweep = &batch->sweeps[s];
                for (size_t k = sweep->slab_start[j] * lanes; k < sweep->slab_start[j + 1] * lanes; k++) {
                    uint32_t slot = sweep->slots[k];
                    if (slot < particles->spare_slot) continue;
                    assert_int_equal((slot - particles->spare_slot) / SK_SLAB_SPARES, j);
                    assert_in_range(slot, particles->slot_count, particles->slot_end - 1);
                    assert_int_equal(particles->particle_of[slot], SK_NOBODY);
                    unfull++;
                }
            }
    }
    assert_true(unfull > 100); // so that this is about something
    skein_world_destroy(world);
}

/* Groups, in whatever company they go, are the plain loop over the springs in their order, to the bit. */
static void groups_are_the_loop(void **state) {
    (void)state;
    skein_world *world = new_world("xpbd", 1);
    add_body(world, TRIANGLES);
    OK(world, skein_set_path(world, "bodies.0.stretch.limit", skein_number(INFINITY)));
    OK(world, skein_set_path(world, "bodies.0.stretch.tether", skein_number(INFINITY)));
    size_t count = skein_particle_count(world);
    double *v = malloc(3 * count * sizeof *v);
    uint64_t seed = 3;
    for (size_t i = 0; i < 3 * count; i++) v[i] = random_between(&seed, -0.2, 0.2);
    OK(world, skein_velocities_set(world, 0, count, v));
    sk_vec4 *x = malloc(count * sizeof *x);
    real h = (real)(1.0 / 64);
    for (size_t i = 0; i < count; i++) {
        sk_vec4 u = world->particles.vector[SK_V][world->particles.slot_of[i]];
        x[i] = world->particles.vector[SK_X][world->particles.slot_of[i]];
        x[i].x += h * u.x, x[i].y += h * u.y, x[i].z += h * u.z; // pins, too, go with their velocity
    }
    steps(world, 1, 1.0 / 64);
    for (size_t b = 0; b < world->rules.batches.count; b++) {
        const sk_batch *batch = world->rules.batches.data[b];
        for (size_t e = 0; e < batch->count; e++) {
            sk_vec4 *p = &x[batch->particle[2 * e]], *q = &x[batch->particle[2 * e + 1]];
            real dx = p->x - q->x, dy = p->y - q->y, dz = p->z - q->z;
            real length = (real)sqrt((double)(dx * dx + dy * dy + dz * dz));
            real soft = batch->lane_compliance[batch->lane[e]] * (real)(64.0 * 64.0);
            real below = length * (p->w + q->w + soft);
            real s = below > 0 ? -(length - batch->rest[e]) / below : 0, a = s * p->w, c = s * q->w;
            p->x += a * dx, p->y += a * dy, p->z += a * dz;
            q->x -= c * dx, q->y -= c * dy, q->z -= c * dz;
        }
    }
    for (size_t i = 0; i < count; i++) {
        sk_vec4 now = world->particles.vector[SK_X][world->particles.slot_of[i]];
        if (!(x[i].x == now.x && x[i].y == now.y && x[i].z == now.z))
            fail_msg("particle %zu: %.9g %.9g %.9g, not %.9g %.9g %.9g", i, (double)now.x, (double)now.y, (double)now.z,
                     (double)x[i].x, (double)x[i].y, (double)x[i].z);
    }
    free(v);
    free(x);
    skein_world_destroy(world);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(walks_do_not_depend_on_threads),
        cmocka_unit_test(the_irregular_mesh_goes_in_groups),
        cmocka_unit_test(free_lanes_keep_to_their_slab),
        cmocka_unit_test(groups_that_go_together_share_no_particle),
        cmocka_unit_test(groups_are_the_loop),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
