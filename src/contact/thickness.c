/* How thick the features of a pair are: what the rule or their bodies say, or less where a body's own are nearer as it was built. That
 * distance is asked for where it may count, which is of few pairs. */
#include "contact/touch.h"

enum { SOME = 64 };

/* Pairs whose distance as they were built is asked for. */
typedef struct built_pairs {
    SK_VECTOR_ALIGNED uint32_t corner[4][SOME];
    SK_VECTOR_ALIGNED real reals[7][SOME];
    SK_VECTOR_ALIGNED uint8_t bytes[2][SOME];
    uint32_t of[SOME];
    sk_pairs pairs;
} built_pairs;

static void point_at_own(built_pairs *some) {
    sk_pairs *p = &some->pairs;
    real **reals[] = {&p->distance,  &p->thickness, &p->normal[0], &p->normal[1],
                      &p->normal[2], &p->share[0],  &p->share[1]};
    for (size_t i = 0; i < sizeof reals / sizeof *reals; i++) *reals[i] = some->reals[i];
    for (int c = 0; c < 4; c++) p->corner[c] = some->corner[c];
    p->closes = some->bytes[0], p->settled = some->bytes[1];
    p->count = 0, p->capacity = SOME;
}

/* A surface as it was built is not pushed apart: features of one piece are as thick as their distance then allows. */
static void take_built_distances(const sk_touch *touch, sk_pairs *pairs, int sort, built_pairs *some) {
    const real share = (real)0.9;
    for (size_t i = 0; i < SOME; i++) some->pairs.thickness[i] = touch->thickness; // of whatever is nearest there
    sk_pairs_pad(&some->pairs);
    sk_closest[sort][touch->isa](touch->skin.built, &some->pairs);
    for (size_t i = 0; i < some->pairs.count; i++)
        pairs->thickness[some->of[i]] = sk_min(pairs->thickness[some->of[i]], share * some->pairs.distance[i]);
    some->pairs.count = 0;
}

void sk_touch_set_thickness(const sk_touch *touch, sk_pairs *pairs, size_t first, int sort) {
    const sk_skin *skin = &touch->skin;
    // first corners that are so far apart belong to features that are not near, as long as an edge may be
    const real far = (real)1.2 * touch->thickness + 2 * skin->longest;
    built_pairs some;
    point_at_own(&some);
    for (size_t k = first; k < pairs->count; k++) {
        uint32_t a = pairs->corner[0][k], b = pairs->corner[2][k];
        pairs->thickness[k] = sk_pair_thickness(touch, a, b);
        sk_vec3 apart = sk_sub(sk_xyz(skin->built[a]), sk_xyz(skin->built[b]));
        if (skin->piece[a] != skin->piece[b] || sk_dot(apart, apart) > far * far) continue;
        size_t i = some.pairs.count++;
        for (int c = 0; c < 4; c++) some.corner[c][i] = pairs->corner[c][k];
        some.of[i] = (uint32_t)k;
        if (i + 1 == SOME) take_built_distances(touch, pairs, sort, &some);
    }
    take_built_distances(touch, pairs, sort, &some);
}
