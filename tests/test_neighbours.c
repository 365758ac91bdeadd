/* Who is near whom: every particle is in its cell, in order, and separation finds the same neighbours as a loop over
 * all pairs does. */
#include "helpers.h"
#include "world/world.h"

/* ---- The cells ---------------------------------------------------------------------------------- */

typedef struct crowd {
    sk_vec4 *at, *v;                 /* by slot */
    uint32_t *slot_of, *particle_of; /* a permutation, so that slots and the user's order differ */
    size_t count, slots;             /* every fifth slot is empty */
} crowd;

static crowd make_crowd(size_t count, uint64_t *seed, bool in_order) {
    size_t slots = count + count / 4 + 1;
    crowd c = {calloc(slots, sizeof(sk_vec4)),
               calloc(slots, sizeof(sk_vec4)),
               calloc(count + 1, sizeof(uint32_t)),
               malloc(slots * sizeof(uint32_t)),
               count,
               slots};
    for (size_t i = 0; i < count; i++) c.slot_of[i] = (uint32_t)(i + i / 4);
    for (size_t i = count; i-- > 1 && !in_order;) {
        size_t j = (size_t)random_between(seed, 0, (double)(i + 1));
        uint32_t swapped = c.slot_of[i];
        c.slot_of[i] = c.slot_of[j], c.slot_of[j] = swapped;
    }
    memset(c.particle_of, 0xff, slots * sizeof(uint32_t));
    for (size_t i = 0; i < count; i++) c.particle_of[c.slot_of[i]] = (uint32_t)i;
    return c;
}

static void release_crowd(crowd *c) {
    free(c->at);
    free(c->v);
    free(c->slot_of);
    free(c->particle_of);
}

static void put(crowd *c, size_t particle, double x, double y, double z) {
    c->at[c->slot_of[particle]] = (sk_vec4){(real)x, (real)y, (real)z, 1};
    c->v[c->slot_of[particle]] = (sk_vec4){0, (real)particle, 0, 1};
}

static bool is_number(sk_vec4 p) {
    double most = (double)SK_REAL_MAX / 4;
    return fabs((double)p.x) <= most && fabs((double)p.y) <= most && fabs((double)p.z) <= most;
}

static size_t cells_of(const sk_cells *cells) {
    size_t most = 0;
    for (int32_t y = 0; y < cells->count_y; y++)
        for (int32_t z = 0; z < cells->count_z; z++) {
            size_t end = (size_t)(sk_cells_line(cells, y, z) + cells->count_x);
            if (end > most) most = end;
        }
    return most;
}

/* Each finite particle of the group is once in the cells, in the cell of its place, those of one in the user's order.
 */
static void assert_cells_are_sound(const sk_cells *cells, const crowd *c, double radius, size_t first, size_t end) {
    assert_true((double)cells->size >= (double)(real)radius * (1 - 1e-6));
    size_t count = cells_of(cells), finite = 0;
    assert_true(count >= 1 && (double)count <= 4.0 * (double)(end - first) + 64);
    assert_int_equal(cells->start[0], 0);
    uint8_t *lines = calloc(count, 1);
    for (int32_t z = 0; z < cells->count_z; z++)
        for (int32_t y = 0; y < cells->count_y; y++) {
            int32_t line = sk_cells_line(cells, y, z);
            for (int32_t x = 0; x < cells->count_x; x++) {
                size_t cell = (size_t)(line + x);
                assert_true(cell < count && !lines[cell]); // no two lines share a cell
                lines[cell] = 1;
                assert_true(cells->start[cell] <= cells->start[cell + 1]);
                for (uint32_t k = cells->start[cell]; k < cells->start[cell + 1]; k++) {
                    uint32_t slot = cells->slot[k], particle = c->particle_of[slot];
                    assert_true(particle >= first && particle < end);
                    assert_int_equal(cells->cell[slot - cells->group.first_slot], cell);
                    sk_vec4 p = c->at[slot];
                    assert_true(cells->x[k] == p.x && cells->y[k] == p.y && cells->z[k] == p.z);
                    assert_true(fabs((double)cells->uy[k] - (particle > 0)) < 4 * EPSILON && cells->ux[k] == 0);
                    if (k > cells->start[cell]) assert_true(particle > c->particle_of[cells->slot[k - 1]]);
                    // the cell is where the particle is, but for a rounding at its walls
                    double place[3] = {((double)p.x - (double)cells->origin.x) * SK_CELLS_ACROSS,
                                       (double)p.y - (double)cells->origin.y, (double)p.z - (double)cells->origin.z};
                    const int32_t index[3] = {x, y, z};
                    for (int d = 0; d < 3; d++) {
                        double in_cell = place[d] / (double)cells->size - index[d],
                               rounding = 8 * EPSILON * (index[d] + 1);
                        assert_true(in_cell >= -rounding && in_cell <= 1 + rounding);
                    }
                    finite++;
                }
            }
        }
    for (size_t cell = 0; cell < count; cell++)
        if (!lines[cell]) assert_int_equal(cells->start[cell], cells->start[cell + 1]);
    free(lines);
    assert_int_equal(cells->count, finite);
    assert_int_equal(cells->start[count], finite);
    for (size_t i = first; i < end; i++) finite -= is_number(c->at[c->slot_of[i]]);
    assert_int_equal(finite, 0);
}

/* The whole crowd, and a part of it. */
static void assert_crowd_is_sorted(sk_cells *cells, sk_allocator *allocator, const crowd *c, double radius) {
    sk_state state = {c->at, c->v, 0, c->particle_of};
    for (int part = 0; part < 2; part++) {
        sk_group group = {part ? c->count / 3 : 0, part ? c->count / 2 : c->count, 0, c->slots, 0};
        assert_true(sk_cells_sort(cells, allocator, &state, &group, (real)radius));
        assert_cells_are_sound(cells, c, radius, group.first, group.end);
    }
}

static void every_particle_is_in_its_cell(void **state) {
    (void)state;
    uint64_t seed = 41;
    sk_allocator allocator = sk_default_allocator();
    sk_cells cells = {0};
    // the same cells for all, as in a world: they grow, shrink and forget
    static const size_t counts[] = {1, 2, 500, 3, 6000, 0, 64};
    static const double sizes[] = {1, 1e-3, 3, 30, 1e6};
    for (size_t n = 0; n < COUNT(counts); n++)
        for (size_t s = 0; s < COUNT(sizes); s++) {
            crowd c = make_crowd(counts[n], &seed, s % 2);
            cells.in_order = s % 2;
            for (size_t i = 0; i < c.count; i++)
                put(&c, i, random_between(&seed, -sizes[s], sizes[s]), random_between(&seed, -1, 0) * sizes[s],
                    random_between(&seed, 5, 5.5) * sizes[s]);
            assert_crowd_is_sorted(&cells, &allocator, &c, 0.1);
            release_crowd(&c);
        }
    sk_cells_release(&cells, &allocator);
    assert_int_equal(allocator.bytes, 0);
}

static void odd_crowds_are_sorted_too(void **state) {
    (void)state;
    uint64_t seed = 43;
    sk_allocator allocator = sk_default_allocator();
    sk_cells cells = {0};
    crowd c = make_crowd(300, &seed, false);
    // all in one place
    for (size_t i = 0; i < c.count; i++) put(&c, i, 1, 2, 3);
    assert_crowd_is_sorted(&cells, &allocator, &c, 0.1);
    // on a lattice whose pitch is the cells' own: every particle on a wall
    for (size_t i = 0; i < c.count; i++)
        put(&c, i, 0.25 * (double)(i % 7), 0.25 * (double)(i / 7 % 7), 0.25 * (double)(i / 49));
    assert_crowd_is_sorted(&cells, &allocator, &c, 0.25);
    // on long lines, which are many layers of one line each
    for (size_t i = 0; i < c.count; i++) put(&c, i, 0, random_between(&seed, -900, 900), 0);
    assert_crowd_is_sorted(&cells, &allocator, &c, 0.1);
    for (size_t i = 0; i < c.count; i++) put(&c, i, 0, random_between(&seed, -10, 10), random_between(&seed, -2, 2));
    assert_crowd_is_sorted(&cells, &allocator, &c, 0.3);
    // far outliers, and particles that are nowhere: those are in no cell
    for (size_t i = 0; i < c.count; i++)
        put(&c, i, random_between(&seed, -1, 1), random_between(&seed, -1, 1), random_between(&seed, -1, 1));
    put(&c, 7, 1e9, -1e9, 1e9);
    put(&c, 8, -1e15, 0, 0);
    put(&c, 9, NAN, 0, 0);
    put(&c, 10, 0, INFINITY, 0);
    put(&c, 11, 0, 0, -INFINITY);
    put(&c, 12, 0, (double)SK_REAL_MAX, 0);
    assert_crowd_is_sorted(&cells, &allocator, &c, 0.1);
    // nobody is anywhere
    for (size_t i = 0; i < c.count; i++) put(&c, i, NAN, NAN, NAN);
    assert_crowd_is_sorted(&cells, &allocator, &c, 0.1);
    assert_int_equal(cells.count, 0);
    release_crowd(&c);
    sk_cells_release(&cells, &allocator);
    assert_int_equal(allocator.bytes, 0);
}

/* ---- Separation --------------------------------------------------------------------------------- */

enum { MOST = 1200 };

/* Particles of different masses at the given places feel separation for one step; compares each one's momentum with
 * a loop over all pairs. */
static void assert_pushes_are_those_of_all_pairs(double (*place)[3], size_t count, double radius, const char *method) {
    double dt = 1.0 / 64, strength = 0.7;
    skein_world *world = new_world(method, 1);
    uint64_t seed = 47;
    for (size_t i = 0; i < count; i++) {
        double mass = random_between(&seed, 0.5, 2);
        OK(world, skein_particles_add(world, 1, place[i], NULL, &mass, NULL));
    }
    OK(world, skein_force_add(world, "separation",
                              SKEIN_SETTINGS(SKEIN_REAL("radius", radius), SKEIN_REAL("strength", strength)), NULL));
    vec3 *x = calloc(count, sizeof *x);
    OK(world, skein_positions_copy(world, 0, count, &x[0].x)); // as the library has rounded them
    steps(world, 1, dt);
    skein_view view = skein_velocity_view(world);
    for (size_t i = 0; i < count; i++) {
        vec3 force = {0, 0, 0};
        double scale = 0;
        for (size_t j = 0; j < count; j++) {
            vec3 d = minus(x[i], x[j]);
            double distance = length3(d);
            if (!(distance > 0) || distance >= radius) continue;
            double push = strength * (1 - distance / radius);
            force.x += push * d.x / distance, force.y += push * d.y / distance, force.z += push * d.z / distance;
            scale += strength;
        }
        double mass = (double)view.xyzw[4 * view.slot_of[i] + 3];
        vec3 v = velocity_of(world, i), is = {mass * v.x / dt, mass * v.y / dt, mass * v.z / dt};
        assert_under(length3(minus(is, force)), 20 * EPSILON * (scale + strength));
    }
    free(x);
    skein_world_destroy(world);
}

static void separation_is_that_of_all_pairs(void **state) {
    (void)state;
    static double place[MOST][3];
    uint64_t seed = 53;
    for (size_t m = 0; m < COUNT(method_names); m++) {
        const char *method = method_names[m];
        // scattered: few, many, and all in reach of each other
        for (int i = 0; i < MOST; i++)
            for (int k = 0; k < 3; k++) place[i][k] = random_between(&seed, -1, 1);
        assert_pushes_are_those_of_all_pairs(place, 3, 0.8, method);
        assert_pushes_are_those_of_all_pairs(place, MOST, 0.15, method);
        assert_pushes_are_those_of_all_pairs(place, MOST, 0.4, method);
        assert_pushes_are_those_of_all_pairs(place, 200, 50, method);
        // some in the very same place: they do not push each other, but all others do
        for (int i = 0; i < 60; i++) memcpy(place[i + 60], place[i], sizeof place[i]);
        for (int i = 0; i < 30; i++) memcpy(place[i + 120], place[i], sizeof place[i]);
        assert_pushes_are_those_of_all_pairs(place, 300, 0.3, method);
        // outliers so far away that the cells must grow to cover them
        place[5][0] = 1e9, place[6][1] = -1e9, place[7][2] = 1e9, place[8][2] = 1e9;
        assert_pushes_are_those_of_all_pairs(place, 400, 0.25, method);
        // on a lattice of the radius' own pitch, where every distance is at the edge of the reach
        for (int i = 0; i < 512; i++)
            place[i][0] = 0.25 * (i % 8), place[i][1] = 0.25 * (i / 8 % 8), place[i][2] = 0.25 * (i / 64);
        assert_pushes_are_those_of_all_pairs(place, 512, 0.25, method);
        assert_pushes_are_those_of_all_pairs(place, 512, 0.375, method);
    }
}

/* Two rules of different reach share the grid of the wider one, and each keeps its own reach. */
static void rules_of_different_reach_share_a_grid(void **state) {
    (void)state;
    for (int wide_last = 0; wide_last < 2; wide_last++) {
        skein_world *world = new_world("symplectic_euler", 1);
        add_particle(world, 1, 0, 0, 0), add_particle(world, 1, 0.5, 0, 0), add_particle(world, 1, -0.15, 0, 0);
        for (int k = 0; k < 2; k++) {
            bool wide = k == wide_last;
            OK(world,
               skein_force_add(
                   world, "separation",
                   SKEIN_SETTINGS(SKEIN_REAL("radius", wide ? 1 : 0.2), SKEIN_REAL("strength", wide ? 0.1 : 1)), NULL));
        }
        steps(world, 1, 1);
        assert_near(velocity_of(world, 0).x, 0.25 - 0.1 * 0.5 + 0.1 * 0.85, 1e-6);
        assert_near(velocity_of(world, 1).x, 0.1 * 0.5 + 0.1 * 0.35, 1e-6);
        skein_world_destroy(world);
    }
}

/* A wider rule that is switched off must not widen the grid of the other: not even roundings may tell. */
static void a_disabled_rule_leaves_the_grid_alone(void **state) {
    (void)state;
    uint64_t hash[2];
    for (int with = 0; with < 2; with++) {
        skein_world *world = new_world("symplectic_euler", 1);
        uint64_t seed = 59;
        for (int i = 0; i < 400; i++)
            add_particle(world, 1, random_between(&seed, -1, 1), random_between(&seed, -1, 1),
                         random_between(&seed, -1, 1));
        OK(world, skein_force_add(world, "separation", SKEIN_SETTINGS(SKEIN_REAL("radius", 0.3)), NULL));
        if (with)
            OK(world, skein_force_add(world, "separation",
                                      SKEIN_SETTINGS(SKEIN_REAL("radius", 0.9), SKEIN_REAL("enabled", 0)), NULL));
        steps(world, 1, 0.01);
        hash[with] = skein_world_hash(world);
        skein_world_destroy(world);
    }
    assert_true(hash[0] == hash[1]);
}

static void a_held_particle_pushes_but_stays(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(method_names); m++) {
        skein_world *world = new_world(method_names[m], 1);
        add_particle(world, 0, 0, 0, 0), add_particle(world, 2, 0.5, 0, 0);
        OK(world, skein_force_add(world, "separation",
                                  SKEIN_SETTINGS(SKEIN_REAL("radius", 1), SKEIN_REAL("strength", 3)), NULL));
        steps(world, 1, 1.0 / 64);
        assert_under(length3(position_of(world, 0)), 0);
        assert_share(velocity_of(world, 1).x, 3 * 0.5 / 2 / 64, 10 * EPSILON);
        skein_world_destroy(world);
    }
}

/* A particle that has got lost is counted, and no one's neighbour; the others go on. */
static void a_particle_that_is_nowhere_harms_no_one(void **state) {
    (void)state;
    skein_world *world = new_world("symplectic_euler", 1);
    add_particle(world, 1, 0, 0, 0), add_particle(world, 1, 0.5, 0, 0), add_particle(world, 1, 0.25, 0, 0);
    OK(world,
       skein_force_add(world, "separation", SKEIN_SETTINGS(SKEIN_REAL("radius", 1), SKEIN_REAL("strength", 1)), NULL));
    world->particles.vector[SK_X][world->particles.slot_of[2]].y = (real)NAN;
    steps(world, 1, 1.0 / 64);
    assert_share(velocity_of(world, 0).x, -0.5 / 64, 10 * EPSILON);
    assert_share(velocity_of(world, 1).x, 0.5 / 64, 10 * EPSILON);
    assert_int_equal(statistics_of(world).nonfinite, 1);
    skein_world_destroy(world);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(every_particle_is_in_its_cell),
        cmocka_unit_test(odd_crowds_are_sorted_too),
        cmocka_unit_test(separation_is_that_of_all_pairs),
        cmocka_unit_test(rules_of_different_reach_share_a_grid),
        cmocka_unit_test(a_disabled_rule_leaves_the_grid_alone),
        cmocka_unit_test(a_held_particle_pushes_but_stays),
        cmocka_unit_test(a_particle_that_is_nowhere_harms_no_one),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
