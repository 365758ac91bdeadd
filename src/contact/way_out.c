/* The least way out of a solid for another one that is in it, where what their crossings say adds up to little.
 *
 * Of two cubes, one on the other and a tenth in it, with faces in one plane, crossings lead up and to two sides, a third each; the upper one went along the
 * diagonal, on which they have more than a cube's width to go, and fell down beside the lower one. So each direction in which one of the crossed faces
 * looks is asked how far it is until no plane across it has something of both; the shortest is taken, where it is less than half as long as what
 * crossings say. Only those are asked that keep their shape: sacks of cloth stayed in each other by it. Of several others the first one counts: with the sum
 * of the ways out of all, in which who is between two stays, stacks of boxes fell nine times as often. */
#include "contact/touch.h"

enum { MOST_DIRECTIONS = 8 };

/* How far one piece has to go along d to be out of another one, m. */
static real way_along(const sk_touch *touch, uint32_t one, uint32_t other, sk_vec3 d) {
    const sk_skin *skin = &touch->skin;
    real least = SK_REAL_MAX, most = -SK_REAL_MAX;
    for (size_t v = 0, left = touch->tangle.whole[one].vertices + touch->tangle.whole[other].vertices; left; v++) {
        if (skin->piece[v] != one && skin->piece[v] != other) continue;
        const real at = sk_dot(d, sk_xyz(touch->p[v]));
        if (skin->piece[v] == one) least = sk_min(least, at);
        else most = sk_max(most, at);
        left--;
    }
    return most - least;
}

/* The pieces of a crossing's edge and triangle. */
static void pieces_of(const sk_touch *touch, size_t i, uint32_t piece[2]) {
    const sk_crossing *crossing = &touch->tangle.crossing.data[i];
    piece[0] = touch->skin.piece[touch->skin.edge[crossing->edge][0]];
    piece[1] = touch->skin.piece[touch->skin.triangle[crossing->triangle][0]];
}

/* What is asked: which piece is to go out of which, the directions that have been tried, and the best of them. */
typedef struct asking {
    const sk_touch *touch;
    uint32_t one, other;
    sk_vec3 tried[MOST_DIRECTIONS], best;
    size_t count;
    real shortest;
} asking;

/* Tries to go where a triangle of one of both looks, or against it, if nothing like that has been tried. */
static void try_face(asking *ask, const uint32_t t[3]) {
    const real alike = (real)0.95;
    const sk_touch *touch = ask->touch;
    const uint32_t piece = touch->skin.piece[t[0]];
    const sk_vec3 a = sk_xyz(touch->p[t[0]]),
                  n = sk_cross(sk_sub(sk_xyz(touch->p[t[1]]), a), sk_sub(sk_xyz(touch->p[t[2]]), a));
    const real length = sk_length(n), out = (real)touch->skin.closed[piece] * (piece == ask->other ? 1 : -1);
    if (!(length > 0) || ask->count == MOST_DIRECTIONS) return;
    const sk_vec3 d = sk_scale(out / length, n);
    for (size_t k = 0; k < ask->count; k++)
        if (sk_dot(ask->tried[k], d) > alike) return;
    ask->tried[ask->count++] = d;
    const real along = way_along(touch, ask->one, ask->other, d);
    if (!(along < ask->shortest)) return;
    ask->shortest = along, ask->best = d;
}

/* The triangle that is crossed, and those that have the edge which crosses it. */
static void try_crossing(asking *ask, const sk_crossing *crossing) {
    const sk_skin *skin = &ask->touch->skin;
    const uint32_t *edge = skin->edge[crossing->edge];
    try_face(ask, skin->triangle[crossing->triangle]);
    for (uint32_t i = skin->leaf_start[edge[0]]; i < skin->leaf_start[edge[0] + 1]; i++) {
        const sk_leaf *leaf = &skin->leaf[skin->leaf_of[i]];
        for (uint32_t k = leaf->first_triangle; k < leaf->first_triangle + leaf->triangles; k++) {
            const uint32_t *t = skin->triangle[k];
            int has = 0;
            for (int c = 0; c < 3; c++) has += t[c] == edge[0] || t[c] == edge[1];
            if (has == 2) try_face(ask, t);
        }
    }
}

/* The other solid of a crossing that a piece has part in, or itself. */
static uint32_t other_of(const sk_touch *touch, size_t i, uint32_t one) {
    uint32_t piece[2];
    pieces_of(touch, i, piece);
    if (piece[0] != one && piece[1] != one) return one;
    const uint32_t other = piece[piece[0] == one];
    return touch->tangle.whole[other].vertices ? other : one; // none: bare edges alone cross, which are sewn to it
}

bool sk_tangle_way_out(const sk_touch *touch, uint32_t one, sk_vec3 *way) {
    const size_t count = touch->tangle.crossing.count;
    asking ask = {.touch = touch,
                  .one = one,
                  .other = one,
                  .tried = {sk_scale(1 / sk_max(sk_length(*way), (real)1e-18), *way)},
                  .count = 1};
    for (size_t i = 0; i < count && ask.other == one; i++) ask.other = other_of(touch, i, one);
    if (ask.other == one) return false;
    ask.shortest = (real)0.5 * way_along(touch, one, ask.other, ask.tried[0]);
    for (size_t i = 0; i < count; i++)
        if (other_of(touch, i, one) == ask.other) try_crossing(&ask, &touch->tangle.crossing.data[i]);
    if (!(sk_dot(ask.best, ask.best) > 0)) return false;
    *way = ask.best;
    return true;
}
