/* Whether features come near each other on straight ways, against what is plain to see, in every instruction set. */
#include "base/isa.h"
#include "contact/touch.h"
#include "helpers.h"

/* Corners before and after, and how near they come, m. */
typedef struct passing {
    int sort;
    sk_vec3 x[2][4];
    double nearest;
} passing;

#define TRIANGLE            \
    {0, 0, 0}, {1, 0, 0}, { \
        0, 0, 1             \
    }

static const passing cases[] = {
    // a vertex goes through a triangle, goes past it, stops above it, slides over it, and meets one that comes to it
    {SK_CORNERS, {{{0.2, 0.5, 0.2}, TRIANGLE}, {{0.2, -0.5, 0.2}, TRIANGLE}}, 0},
    {SK_CORNERS, {{{-0.3, 0.5, 0.2}, TRIANGLE}, {{-0.3, -0.5, 0.2}, TRIANGLE}}, 0.3},
    {SK_CORNERS, {{{0.2, 0.5, 0.2}, TRIANGLE}, {{0.2, 0.1, 0.2}, TRIANGLE}}, 0.1},
    {SK_CORNERS, {{{-0.5, 0.2, 0.2}, TRIANGLE}, {{1.5, 0.2, 0.2}, TRIANGLE}}, 0.2},
    {SK_CORNERS, {{{0.2, 0.5, 0.2}, TRIANGLE}, {{0.2, 0.5, 0.2}, {0, 0.4, 0}, {1, 0.4, 0}, {0, 0.4, 1}}}, 0.1},
    // edges go through each other, past each other's end, side by side, and as one
    {SK_EDGES,
     {{{-1, 0.5, 0}, {1, 0.5, 0}, {0, 0, -1}, {0, 0, 1}}, {{-1, -0.5, 0}, {1, -0.5, 0}, {0, 0, -1}, {0, 0, 1}}},
     0},
    {SK_EDGES,
     {{{0.4, 0.5, 0}, {1, 0.5, 0}, {0, 0, -1}, {0, 0, 1}}, {{0.4, -0.5, 0}, {1, -0.5, 0}, {0, 0, -1}, {0, 0, 1}}},
     0.4},
    {SK_EDGES,
     {{{-1, 0.5, 0}, {1, 0.5, 0}, {-1, 0, 0.3}, {1, 0, 0.3}}, {{-1, -0.5, 0}, {1, -0.5, 0}, {-1, 0, 0.3}, {1, 0, 0.3}}},
     0.3},
    {SK_EDGES,
     {{{-1, 0.2, 0}, {1, 0.2, 0}, {0, 0, -1}, {0, 0, 1}}, {{9, 9.2, 7}, {11, 9.2, 7}, {10, 9, 6}, {10, 9, 8}}},
     0.2},
};

static void they_pass_where_they_do(void **state) {
    (void)state;
    const sk_isa widest = sk_isa_choose();
    for (int isa = 0; isa <= (int)widest; isa++)
        for (size_t c = 0; c < COUNT(cases); c++) {
            const passing *p = &cases[c];
            // between two moments of 64, they may come nearer by a half of what they go there
            sk_vec3 way = sk_sub(sk_sub(p->x[1][0], p->x[0][0]), sk_sub(p->x[1][3], p->x[0][3]));
            const double between = (double)sk_length(way) / 128;
            const bool nearer = sk_passes[p->sort][isa](p->x, (real)(p->nearest + 1e-4));
            const bool farther =
                p->nearest > 0 && sk_passes[p->sort][isa](p->x, (real)(p->nearest - 2 * between - 1e-4));
            if (!nearer || farther) fail_msg("case %zu: %d, %d", c, nearer, farther);
        }
}

/* However fast: what goes through is not stepped over. */
static void what_is_fast_passes_too(void **state) {
    (void)state;
    uint64_t seed = 3;
    const sk_isa widest = sk_isa_choose();
    for (int i = 0; i < 2000; i++) {
        sk_vec3 x[2][4], hit = {(real)0.3, 0, (real)0.3};
        const sk_vec3 triangle[3] = {TRIANGLE};
        const double speed = pow(10, random_between(&seed, -2, 2)), when = random_between(&seed, 0.05, 0.95);
        const sk_vec3 to = {(real)(speed * random_between(&seed, -1, 1)), (real)-speed,
                            (real)(speed * random_between(&seed, -1, 1))};
        for (int end = 0; end < 2; end++) {
            x[end][0] = sk_add(hit, sk_scale((real)(end - when), to));
            for (int k = 0; k < 3; k++) x[end][1 + k] = triangle[k];
        }
        for (int isa = 0; isa <= (int)widest; isa++)
            assert_true(sk_passes[SK_CORNERS][isa]((const sk_vec3(*)[4])x, (real)1e-5));
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(they_pass_where_they_do),
        cmocka_unit_test(what_is_fast_passes_too),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
