/* Quads that lie like a grid's are one, however they are numbered: the same sweeps, the same motion. */
#include <math.h>

#include "helpers.h"

enum { ROWS = 21, COLUMNS = 34, MOST = ROWS * COLUMNS };

typedef struct quads {
    double positions[MOST * 3];
    uint32_t sizes[MOST], corners[4 * MOST], number[MOST]; /* number[row * COLUMNS + column], UINT32_MAX: not there */
    skein_mesh mesh;
} quads;

static uint32_t random_below(uint64_t *state, uint32_t most) {
    *state = *state * 6364136223846793005u + 1442695040888963407u;
    return (uint32_t)((*state >> 33) % most);
}

/* A grid on edge with the places inside [first, last) of both directions left out; shuffled where `seed` is not 0. */
static void make(quads *q, int first, int last, bool ring, uint64_t seed) {
    bool used[MOST] = {false};
    size_t faces = 0, vertices = 0;
    for (int r = 0; r + 1 < ROWS; r++)
        for (int c = 0; c + 1 < COLUMNS + ring; c++) {
            if (r >= first && r < last && c >= first && c < last) continue;
            int right = (c + 1) % COLUMNS;
            int corner[4] = {r * COLUMNS + c, (r + 1) * COLUMNS + c, (r + 1) * COLUMNS + right, r * COLUMNS + right};
            for (int k = 0; k < 4; k++) q->corners[4 * faces + (size_t)k] = (uint32_t)corner[k], used[corner[k]] = true;
            q->sizes[faces++] = 4;
        }
    for (size_t i = 0; i < MOST; i++) q->number[i] = used[i] ? (uint32_t)vertices++ : UINT32_MAX;
    uint32_t shuffled[MOST];
    for (uint32_t i = 0; i < vertices; i++) shuffled[i] = i;
    for (uint32_t i = (uint32_t)vertices; seed && i > 1; i--) {
        uint32_t j = random_below(&seed, i), t = shuffled[i - 1];
        shuffled[i - 1] = shuffled[j], shuffled[j] = t;
    }
    for (size_t i = 0; i < MOST; i++) {
        if (!used[i]) continue;
        q->number[i] = shuffled[q->number[i]];
        double *p = q->positions + 3 * q->number[i], turn = 6.283185307179586 / COLUMNS * (double)(i % COLUMNS);
        p[0] = ring ? cos(turn) : 0.05 * (double)(i % COLUMNS);
        p[1] = -0.05 * (double)(i / COLUMNS);
        p[2] = ring ? sin(turn) : 0;
    }
    for (size_t k = 0; k < 4 * faces; k++) q->corners[k] = q->number[q->corners[k]];
    for (uint32_t f = (uint32_t)faces; seed && f > 1; f--) { // faces in any order, beginning at any corner
        uint32_t j = random_below(&seed, f), turn = random_below(&seed, 4), a[4], b[4];
        memcpy(a, q->corners + 4 * (f - 1), sizeof a);
        memcpy(b, q->corners + 4 * j, sizeof b);
        for (uint32_t k = 0; k < 4; k++) q->corners[4 * j + k] = a[(k + turn) % 4];
        if (j != f - 1) memcpy(q->corners + 4 * (f - 1), b, sizeof b);
    }
    q->mesh = (skein_mesh){q->positions, vertices, q->sizes, faces, q->corners, 4 * faces};
}

static skein_world *hang(const quads *q) {
    char pins[64]; // in the first row and more to one side, so that the grid can be laid in one way only
    snprintf(pins, sizeof pins, "%u, %u", q->number[0], q->number[COLUMNS / 2]);
    skein_world *world = skein_world_create(NULL, NULL);
    OK(world, skein_force_add(world, "gravity", NULL, NULL));
    OK(world, skein_force_add(world, "wind", SKEIN_SETTINGS(SKEIN_VEC3("force", 0, 0, 1e-3)), NULL));
    OK(world, skein_body_add(world, "cloth", &q->mesh,
                             SKEIN_SETTINGS(SKEIN_TEXT("bend.by", "springs"), SKEIN_TEXT("pins", pins)), NULL));
    return world;
}

static void count_line(void *user, const char *line) {
    size_t *count = user;
    count[0] += strstr(line, "project") && strstr(line, "+0 +1");
    count[1] += strstr(line, "project") && strstr(line, "groups");
}

/* How many project rows are strips along a row, and how many are groups. */
static void count_rows(skein_world *world, size_t count[2]) {
    count[0] = count[1] = 0;
    OK(world, skein_world_explain(world, 1.0 / 60, count_line, count));
}

static void shuffled_quads_move_as_the_grid_does(void **state) {
    (void)state;
    static quads q[2];
    static double x[2][MOST][3];
    for (int hole = 0; hole < 2; hole++) {
        size_t count[2];
        double worst = 0;
        for (int k = 0; k < 2; k++) {
            make(&q[k], 6, hole ? 14 : 6, false, k ? 7 : 0);
            skein_world *world = hang(&q[k]);
            for (int i = 0; i < 40; i++) OK(world, skein_world_step(world, 1.0 / 60));
            count_rows(world, count);
            assert_true(count[0] == 1 && count[1] == 0);
            OK(world, skein_positions_copy(world, 0, q[k].mesh.vertex_count, (double *)x[k]));
            skein_world_destroy(world);
        }
        for (size_t i = 0; i < MOST; i++)
            for (int k = 0; k < 3 && q[0].number[i] != UINT32_MAX; k++)
                worst = fmax(worst, fabs(x[0][q[0].number[i]][k] - x[1][q[1].number[i]][k]));
        assert_true(worst < 1e-6);
    }
}

static void a_ring_is_no_grid(void **state) {
    (void)state;
    static quads q;
    size_t count[2];
    make(&q, 0, 0, true, 3);
    skein_world *world = hang(&q);
    count_rows(world, count);
    assert_true(count[0] == 0 && count[1] >= 1);
    OK(world, skein_world_step(world, 1.0 / 60));
    skein_world_destroy(world);
}

/* Fails at one call. */
typedef struct purse {
    size_t calls, fail_at, blocks;
} purse;

static void *take(void *user, size_t size, size_t alignment) {
    purse *p = user;
    if (p->calls++ == p->fail_at) return NULL;
    p->blocks++;
    return aligned_alloc(alignment, size);
}

static void give_back(void *user, void *memory, size_t size) {
    (void)size;
    ((purse *)user)->blocks--;
    free(memory);
}

static void without_memory_the_body_is_not_added(void **state) {
    (void)state;
    static quads q;
    make(&q, 6, 14, false, 5);
    skein_status status = SKEIN_ERROR_MEMORY;
    for (size_t n = 1; status == SKEIN_ERROR_MEMORY; n++) {
        purse p = {0, SIZE_MAX, 0};
        skein_world_desc desc = skein_default_world_desc();
        desc.allocate = take, desc.release = give_back, desc.memory_user = &p;
        skein_world *world = skein_world_create(&desc, NULL);
        p.fail_at = p.calls + n - 1;
        status = skein_body_add(world, "cloth", &q.mesh, SKEIN_SETTINGS(SKEIN_TEXT("pins", "0")), NULL);
        assert_true(status == SKEIN_OK || status == SKEIN_ERROR_MEMORY);
        assert_true(skein_object_count(world, SKEIN_BODY) == (status == SKEIN_OK));
        skein_world_destroy(world);
        assert_int_equal(p.blocks, 0);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(shuffled_quads_move_as_the_grid_does),
        cmocka_unit_test(a_ring_is_no_grid),
        cmocka_unit_test(without_memory_the_body_is_not_added),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
