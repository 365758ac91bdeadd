/* Cutting cloth: what a blade meets, what that severs, what goes on as it was, and what holds a cut: snapshots,
 * recordings, every number of threads. */
#include <skein/cut.h>
#include <skein/record.h>

#include "all_methods.h"
#include "helpers.h"

static const double dt = 1.0 / 60;

/* A cloth of 1 x 1 m that hangs by its upper edge (y = 0.5), in the plane z = 0. */
typedef struct hanging {
    skein_world *world;
    skein_handle cloth;
    skein_surface surface;
    uint32_t rows;
} hanging;

static hanging hang(const char *method, int threads, uint32_t rows) {
    skein_world_desc desc = skein_default_world_desc();
    desc.thread_count = threads;
    hanging h = {.world = skein_world_create(&desc, NULL), .rows = rows};
    assert_non_null(h.world);
    OK(h.world, skein_method_set(h.world, method, SKEIN_SETTINGS(SKEIN_REAL("substeps", 20))));
    add_particle(h.world, 1, 9, 9, 9); // so that the body does not begin with particle 0
    add_gravity(h.world);
    OK(h.world, skein_body_add(h.world, "cloth", NULL,
                               SKEIN_SETTINGS(SKEIN_PAIR("grid", rows, rows), SKEIN_VEC3("rotation", 90, 0, 0),
                                              SKEIN_TEXT("pins", "top edge"), SKEIN_REAL("stretch.stiffness", 4),
                                              SKEIN_REAL("shear.stiffness", 1)),
                               &h.cloth));
    OK(h.world, skein_body_surface(h.world, h.cloth, &h.surface));
    return h;
}

/* A level cut at this height, from the left border to x = `until`. Returns how many faces it took away. */
static size_t slit(const hanging *h, double y, double until) {
    size_t count = 0;
    const double blade[3][3] = {{-5, y, -5 - until}, {until, y, 0}, {-5, y, 5 + until}};
    OK(h->world, skein_cut(h->world, h->cloth, blade, &count));
    return count;
}

static size_t count_cut(const hanging *h) {
    skein_cuts cuts;
    size_t count = 0;
    OK(h->world, skein_body_cuts(h->world, h->cloth, &cuts));
    for (size_t f = 0; cuts.face && f < h->surface.face_count; f++) count += cuts.face[f];
    assert_int_equal(count, cuts.count);
    return count;
}

/* Half of the cloth: the rows whose particles are below a height; their mean height and velocity by mass. */
typedef struct half {
    bool *has;
    size_t count;
    double y, v;
} half;

static half find_half(const hanging *h, double y) {
    half p = {calloc(h->surface.particle_count, sizeof *p.has), 0, 0, 0};
    for (size_t i = 0; i < h->surface.particle_count; i++)
        p.count += p.has[i] = position_of(h->world, h->surface.first_particle + i).y < y;
    return p;
}

/* Of a grid, particles of a border have half the mass of others, corners a quarter. */
static void measure(const hanging *h, half *p) {
    double sum = 0;
    p->y = p->v = 0;
    for (size_t i = 0; i < h->surface.particle_count; i++) {
        size_t row = i / h->rows, column = i % h->rows, last = h->rows - 1;
        double mass = (row == 0 || row == last ? 0.5 : 1) * (column == 0 || column == last ? 0.5 : 1);
        if (!p->has[i]) continue;
        sum += mass;
        p->y += mass * position_of(h->world, h->surface.first_particle + i).y;
        p->v += mass * velocity_of(h->world, h->surface.first_particle + i).y;
    }
    p->y /= sum, p->v /= sum;
}

/* Cut across its middle, the lower half of a cloth falls freely, by every method: its centre of mass goes as a stone
 * does, whatever springs do within it. The upper half hangs on. */
static void the_lower_half_falls_freely(void **state) {
    (void)state;
    const uint32_t sizes[] = {20, 70}; // with spans, with coarse grids
    for (size_t m = 0; m < COUNT(all_methods); m++)
        for (size_t s = 0; s < COUNT(sizes); s++) {
            bool loses_energy = m == 1 || m >= 6; // the others gain some where springs are as fast as on the larger one
            if (s && (!loses_energy || (SPARING && m != 7))) continue;
            hanging h = hang(all_methods[m], 2, sizes[s]);
            steps(h.world, 6, dt);
            double middle = position_of(h.world, h.surface.first_particle + sizes[s] * (sizes[s] / 2)).y;
            double below = position_of(h.world, h.surface.first_particle + sizes[s] * (sizes[s] / 2 - 1)).y;
            double y = (middle + below) / 2, t = 12 * dt;
            assert_int_equal(slit(&h, y, 9), sizes[s] - 1);
            half lower = find_half(&h, y);
            assert_int_equal(lower.count, sizes[s] * sizes[s] / 2);
            measure(&h, &lower);
            double y0 = lower.y, v0 = lower.v;
            steps(h.world, 12, dt);
            measure(&h, &lower);
            if (fabs(lower.v - v0 + 9.81 * t) > 1e-3) print_message("%s, %u rows:\n", all_methods[m], sizes[s]);
            assert_near(lower.v, v0 - 9.81 * t, 1e-3);
            assert_near(lower.y, y0 + v0 * t - 9.81 * t * t / 2, 9.81 * t * dt / 20 + 1e-4);
            for (size_t i = 0; i < h.surface.particle_count; i++)
                if (!lower.has[i]) assert_true(position_of(h.world, h.surface.first_particle + i).y > y - 0.1);
            free(lower.has);
            skein_world_destroy(h.world);
        }
}

/* A cloth that is cut off below its pins but for the last column hangs by that: its far corner comes to lie farther below
 * than the cloth is long, where tethers along what was cut would not have let it. */
static void tethers_go_around_a_cut(void **state) {
    (void)state;
    hanging h = hang("xpbd", 1, 20);
    OK(h.world, skein_set(h.world, h.cloth, "stretch.stiffness", skein_number(1000)));
    OK(h.world, skein_force_add(h.world, "drag", SKEIN_SETTINGS(SKEIN_REAL("rate", 2)), NULL));
    assert_int_equal(slit(&h, 0.5 - 0.5 / 19, 0.5 - 1.5 / 19), 18);
    steps(h.world, 150, dt);
    double lowest = 0;
    for (size_t i = 0; i < h.surface.particle_count; i++)
        lowest = fmin(lowest, position_of(h.world, h.surface.first_particle + i).y);
    assert_true(lowest < 0.5 - 1.25 && lowest > 0.5 - 2.1); // a diagonal is 1.41 m long, along edges 2 m
    skein_world_destroy(h.world);
}

/* ---- the same bits ---- */

static uint64_t hash_after(const hanging *h, int count) {
    steps(h->world, count, dt);
    uint64_t hash = skein_world_hash(h->world);
    skein_world_destroy(h->world);
    return hash;
}

static void the_same_bits(void **state) {
    (void)state;
    const uint32_t sizes[] = {20, 70};
    static const char *const sets[] = {"sse", "avx2", "avx512"};
    for (size_t s = 0; s < COUNT(sizes); s++) {
        uint64_t hash = 0, whole = 0;
        for (int threads = 1; threads < 5; threads += threads == 1 ? 1 : 2)
            for (size_t k = 0; k < COUNT(sets); k++) {
                setenv("SKEIN_SIMD", sets[k], 1);
                hanging h = hang("xpbd", threads, sizes[s]);
                unsetenv("SKEIN_SIMD");
                steps(h.world, 3, dt);
                assert_int_equal(slit(&h, 0.001, 0.2), (size_t)(0.7 * (sizes[s] - 1)) + 1);
                uint64_t now = hash_after(&h, 8);
                if (!hash) hash = now;
                assert_true(now == hash);
            }
        // in parts, from the other end; what is mended is as if it had never been cut
        hanging h = hang("xpbd", 1, sizes[s]), other = hang("xpbd", 2, sizes[s]), never = hang("xpbd", 1, sizes[s]);
        steps(h.world, 3, dt), steps(other.world, 3, dt), steps(never.world, 3, dt);
        skein_cuts cuts;
        slit(&h, 0.001, 0.2);
        OK(h.world, skein_body_cuts(h.world, h.cloth, &cuts));
        for (uint32_t f = (uint32_t)h.surface.face_count; f-- > 0;)
            if (cuts.face[f]) OK(other.world, skein_cut_faces(other.world, other.cloth, &f, 1));
        assert_true(hash_after(&h, 8) == hash);
        slit(&never, -0.3, 9);
        OK(never.world, skein_cut_mend(never.world, never.cloth));
        assert_int_equal(count_cut(&never), 0);
        whole = hash_after(&never, 8);
        assert_true(hash_after(&other, 8) == hash && whole != hash);
        h = hang("xpbd", 1, sizes[s]);
        assert_true(hash_after(&h, 11) == whole);
    }
}

/* ---- what holds a cut ---- */

static void a_reset_makes_whole(void **state) {
    (void)state;
    hanging h = hang("xpbd", 1, 20), never = hang("xpbd", 1, 20);
    slit(&h, 0, 9);
    steps(h.world, 5, dt);
    slit(&h, 0.2, 9);
    OK(h.world, skein_world_reset(h.world));
    assert_int_equal(count_cut(&h), 0);
    assert_true(hash_after(&h, 9) == hash_after(&never, 9));
}

static void snapshots_hold_cuts(void **state) {
    (void)state;
    hanging h = hang("xpbd", 1, 20), other = hang("xpbd", 1, 20);
    size_t whole_size = skein_snapshot_size(h.world), size;
    void *whole = malloc(whole_size);
    OK(h.world, skein_snapshot_write(h.world, whole, whole_size, NULL));
    steps(h.world, 3, dt);
    slit(&h, 0, 0.1);
    steps(h.world, 3, dt);
    unsigned char *bytes = malloc(size = skein_snapshot_size(h.world));
    OK(h.world, skein_snapshot_write(h.world, bytes, size, NULL));
    skein_snapshot_info info;
    assert_int_equal(skein_snapshot_look(bytes, size, &info, NULL), SKEIN_OK);
    assert_int_equal(info.version, 2);
    slit(&other, 0.4, 9); // which the snapshot knows nothing of
    OK(other.world, skein_snapshot_read(other.world, bytes, size));
    assert_int_equal(count_cut(&other), count_cut(&h));
    steps(h.world, 6, dt), steps(other.world, 6, dt);
    assert_true(skein_world_hash(h.world) == skein_world_hash(other.world));
    OK(h.world, skein_snapshot_read(h.world, whole, whole_size));
    assert_int_equal(count_cut(&h), 0);
    OK(h.world, skein_snapshot_read(h.world, bytes, size));
    steps(h.world, 6, dt);
    assert_true(skein_world_hash(h.world) == skein_world_hash(other.world));
    skein_world_destroy(h.world), skein_world_destroy(other.world);
    free(bytes), free(whole);
}

typedef struct tape {
    unsigned char bytes[1 << 19];
    size_t size;
} tape;

static bool put(void *user, const void *bytes, size_t size) {
    tape *t = user;
    if (size > sizeof t->bytes - t->size) return false;
    memcpy(t->bytes + t->size, bytes, size);
    t->size += size;
    return true;
}

static void recordings_hold_cuts(void **state) {
    (void)state;
    hanging h = hang("xpbd", 2, 20), other = hang("xpbd", 1, 20);
    tape *t = calloc(1, sizeof *t);
    steps(h.world, 2, dt);
    OK(h.world, skein_record_begin(h.world, &(skein_recorder){.write = put, .user = t, .note = "cuts"}));
    steps(h.world, 2, dt);
    slit(&h, 0, 0.1);
    steps(h.world, 4, dt);
    slit(&h, 0.2, -0.1);
    steps(h.world, 4, dt);
    OK(h.world, skein_cut_mend(h.world, h.cloth));
    steps(h.world, 2, dt);
    slit(&h, -0.2, 9);
    steps(h.world, 2, dt);
    OK(h.world, skein_record_end(h.world));
    skein_difference d;
    OK(other.world, skein_replay(other.world, t->bytes, t->size, &d));
    assert_true(!d.found && d.is_whole && d.steps == 14);
    assert_int_equal(count_cut(&other), count_cut(&h));
    assert_true(skein_world_hash(h.world) == skein_world_hash(other.world));
    skein_world_destroy(h.world), skein_world_destroy(other.world);
    free(t);
}

/* ---- what does not meet a cut face ---- */

/* With all of its faces cut a cloth is loose particles: no wind moves it, no ray meets it, and nothing is stretched. */
static void nothing_meets_what_is_cut(void **state) {
    (void)state;
    for (int cut = 0; cut < 2; cut++) {
        hanging h = hang("xpbd", 1, 20);
        uint32_t *all = malloc(h.surface.face_count * sizeof *all);
        for (size_t f = 0; f < h.surface.face_count; f++) all[f] = (uint32_t)f;
        OK(h.world, skein_force_add(h.world, "surface_wind", SKEIN_SETTINGS(SKEIN_VEC3("velocity", 0, 0, 10)), NULL));
        if (cut) OK(h.world, skein_cut_faces(h.world, h.cloth, all, h.surface.face_count));
        free(all);
        skein_hit hit;
        const double from[3] = {0.013, 0.2, 3}, along[3] = {0, 0, -1};
        OK(h.world, skein_ray_cast(h.world, from, along, SKEIN_BODY, &hit));
        assert_int_equal(hit.t < INFINITY, !cut);
        steps(h.world, 12, dt);
        vec3 p = position_of(h.world, h.surface.first_particle + 10 * 20 + 10);
        if (cut) assert_true(p.z == 0);
        else assert_true(p.z > 0.01);
        skein_statistics s = statistics_of(h.world);
        if (cut) assert_true(s.elastic_energy == 0);
        else assert_true(s.elastic_energy > 0);
        skein_world_destroy(h.world);
    }
}

/* A cloth that falls on a board of cloth stays there; where the board's faces are cut it falls through. */
static void contact_goes_through_what_is_cut(void **state) {
    (void)state;
    for (int cut = 0; cut < 2; cut++) {
        skein_world *world = new_world("xpbd", 10);
        skein_handle board, patch;
        skein_surface surface, falling;
        add_gravity(world);
        OK(world, skein_body_add(world, "cloth", NULL,
                                 SKEIN_SETTINGS(SKEIN_PAIR("grid", 9, 9), SKEIN_TEXT("pins", "all")), &board));
        OK(world, skein_body_add(world, "cloth", NULL,
                                 SKEIN_SETTINGS(SKEIN_PAIR("grid", 4, 4), SKEIN_PAIR("size", 0.25, 0.25),
                                                SKEIN_VEC3("position", 0, 0.1, 0)),
                                 &patch));
        OK(world, skein_force_add(world, "contact", SKEIN_SETTINGS(SKEIN_REAL("thickness", 0.01)), NULL));
        OK(world, skein_body_surface(world, board, &surface));
        OK(world, skein_body_surface(world, patch, &falling));
        size_t count = 0;
        uint32_t all[64];
        assert_int_equal(surface.face_count, COUNT(all));
        for (uint32_t f = 0; f < COUNT(all); f++) all[f] = f;
        if (cut) OK(world, skein_cut_faces(world, board, all, COUNT(all)));
        steps(world, 60, dt);
        for (size_t i = 0; i < falling.particle_count; i++)
            count += position_of(world, falling.first_particle + i).y < -0.5;
        assert_int_equal(count, cut ? falling.particle_count : 0);
        skein_world_destroy(world);
    }
}

/* What is enclosed gets out where a face is cut: a balloon that was pressed outward is at rest then. */
static void a_balloon_bursts(void **state) {
    (void)state;
    const double corners[6][3] = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    const uint32_t sizes[8] = {3, 3, 3, 3, 3, 3, 3, 3};
    const uint32_t faces[8][3] = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                                  {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
    const skein_mesh mesh = {&corners[0][0], 6, sizes, 8, &faces[0][0], 24};
    for (int cut = 0; cut < 2; cut++) {
        skein_world *world = new_world("symplectic_euler", 10);
        skein_handle cloth;
        skein_surface surface;
        OK(world, skein_body_add(world, "cloth", &mesh, NULL, &cloth));
        OK(world,
           skein_constraint_add(world, "pressure", &faces[0][0], 8, SKEIN_SETTINGS(SKEIN_REAL("pressure", 100)), NULL));
        OK(world, skein_body_surface(world, cloth, &surface));
        assert_int_equal(surface.particle_count, 6);
        if (cut) OK(world, skein_cut_faces(world, cloth, (const uint32_t[]){5}, 1));
        steps(world, 1, dt);
        double speed = length3(velocity_of(world, 0));
        if (cut) assert_near(speed, 0, 1e-6);
        else assert_true(speed > 0.01);
        if (cut) OK(world, skein_cut_mend(world, cloth));
        steps(world, 1, dt);
        assert_true(length3(velocity_of(world, 0)) > 0.001);
        skein_world_destroy(world);
    }
}

/* ---- refusals ---- */

static void refusals(void **state) {
    (void)state;
    hanging h = hang("xpbd", 1, 5);
    skein_handle rope;
    size_t count = 7;
    OK(h.world, skein_body_add(h.world, "rope", NULL, NULL, &rope));
    const double blade[3][3] = {{-5, 0.1, -5}, {5, 0.1, -5}, {0, 0.1, 5}},
                 bad[3][3] = {{0, 0, 0}, {0, NAN, 0}, {1, 1, 1}};
    FAILS(h.world, SKEIN_ERROR_VALUE, "only sheets", skein_cut(h.world, rope, blade, &count));
    FAILS(h.world, SKEIN_ERROR_VALUE, "corner 1 of the blade", skein_cut(h.world, h.cloth, bad, &count));
    FAILS(h.world, SKEIN_ERROR_VALUE, "no face 16 (the body has 16)",
          skein_cut_faces(h.world, h.cloth, (const uint32_t[]){3, 16}, 2));
    FAILS(h.world, SKEIN_ERROR_HANDLE, "", skein_cut(h.world, (skein_handle){0}, blade, &count));
    FAILS(h.world, SKEIN_ERROR_HANDLE, "", skein_cut_mend(h.world, (skein_handle){0}));
    assert_int_equal(count, 7);
    assert_int_equal(count_cut(&h), 0);
    OK(h.world, skein_cut_mend(h.world, rope));
    // a blade beside the cloth meets nothing, one within a face meets that, and what is cut is not counted again
    const double beside[3][3] = {{2, -1, -1}, {2, 1, -1}, {2, 0, 1}},
                 within[3][3] = {{0.05, 0.1, -1}, {0.1, 0.12, 1}, {0.1, 0.2, -1}};
    OK(h.world, skein_cut(h.world, h.cloth, beside, &count));
    assert_int_equal(count, 0);
    OK(h.world, skein_cut(h.world, h.cloth, within, &count));
    assert_int_equal(count, 1);
    OK(h.world, skein_cut(h.world, h.cloth, blade, &count));
    assert_int_equal(count, 3);
    skein_world_destroy(h.world);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_lower_half_falls_freely),
        cmocka_unit_test(tethers_go_around_a_cut),
        cmocka_unit_test(the_same_bits),
        cmocka_unit_test(a_reset_makes_whole),
        cmocka_unit_test(snapshots_hold_cuts),
        cmocka_unit_test(recordings_hold_cuts),
        cmocka_unit_test(nothing_meets_what_is_cut),
        cmocka_unit_test(contact_goes_through_what_is_cut),
        cmocka_unit_test(a_balloon_bursts),
        cmocka_unit_test(refusals),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
