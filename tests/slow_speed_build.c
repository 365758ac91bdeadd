/* A large cloth is built in under a second, in under 200 bytes a spring, and steps with no more. */
#include "helpers.h"
#include <time.h>

/* Of this process, so that others on the machine do not count. */
static double seconds_now(void) {
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

typedef struct peak {
    size_t now, most;
} peak;

static void *take(void *user, size_t size, size_t alignment) {
    peak *p = user;
    p->now += size;
    if (p->now > p->most) p->most = p->now;
    return aligned_alloc(alignment, size);
}

static void give_back(void *user, void *memory, size_t size) {
    ((peak *)user)->now -= size;
    free(memory);
}

static void a_large_cloth_is_built_in_no_time(void **state) {
    (void)state;
    enum { SIDE = 256 };
    static double positions[3 * SIDE * SIDE];
    static uint32_t sizes[(SIDE - 1) * (SIDE - 1)], corners[4 * (SIDE - 1) * (SIDE - 1)];
    for (uint32_t r = 0; r < SIDE; r++)
        for (uint32_t c = 0; c < SIDE; c++)
            positions[3 * (r * SIDE + c)] = 0.01 * c, positions[3 * (r * SIDE + c) + 2] = 0.01 * r;
    uint32_t *corner = corners;
    for (uint32_t r = 0; r + 1 < SIDE; r++)
        for (uint32_t c = 0; c + 1 < SIDE; c++) {
            uint32_t a = r * SIDE + c;
            sizes[r * (SIDE - 1) + c] = 4;
            *corner++ = a, *corner++ = a + SIDE, *corner++ = a + SIDE + 1, *corner++ = a + 1;
        }
    const skein_mesh mesh = {positions, SIDE * SIDE, sizes, COUNT(sizes), corners, COUNT(corners)};
    static const size_t count = 2 * SIDE * (SIDE - 1) + 2 * (SIDE - 1) * (SIDE - 1) + 2 * SIDE * (SIDE - 2);
    for (int way = 0; way < 3; way++) { // a grid, the same as a mesh, the same with all corners welded
        peak p = {0, 0};
        skein_world_desc desc = skein_default_world_desc();
        desc.allocate = take, desc.release = give_back, desc.memory_user = &p;
        skein_world *world = skein_world_create(&desc, NULL);
        assert_non_null(world);
        double start = seconds_now();
        if (!way)
            OK(world, skein_body_add(world, "cloth", NULL,
                                     SKEIN_SETTINGS(SKEIN_TEXT("bend.by", "springs"), SKEIN_PAIR("grid", SIDE, SIDE),
                                                    SKEIN_TEXT("pins", "corners")),
                                     NULL));
        else
            OK(world,
               skein_body_add(world, "cloth", &mesh,
                              SKEIN_SETTINGS(SKEIN_TEXT("bend.by", "springs"), SKEIN_REAL("weld", way == 2 ? 1e-4 : 0),
                                             SKEIN_TEXT("pins", "0 255 65280 65535")),
                              NULL));
        add_gravity(world);
        steps(world, 1, 1.0 / 90);
        double taken = seconds_now() - start;
        skein_statistics s = statistics_of(world);
        assert_int_equal(s.constraints, count);
        assert_true(taken < 1);
        assert_true((double)p.now < 200.0 * (double)count);
        assert_true((double)p.most < 200.0 * (double)count);
        skein_world_destroy(world);
        assert_int_equal(p.now, 0);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_large_cloth_is_built_in_no_time),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
