/* Which two triangles are one leaf, and in which order leaves are.
 *
 * A cell's two are, which follow each other on both sides of their longest edge; of all others, those that have but one neighbour
 * left are taken first (Karp and Sipser 1981), so that hardly any stays alone: of a closed mesh one in a hundred. What a search
 * costs goes by leaves, and by pairs of them.
 *
 * Leaves are in the order of their triangles; where these lie about in a body's file anyhow they follow a curve. So what a leaf, its
 * neighbours and their vertices need is near in memory. (A mesh of 26,002 vertices that falls into a heap took 30 s with leaves of
 * one triangle, 20 with pairs, 15 in this order; a grid of 100 x 100 along a curve 16 for 13 along its rows.) */
#include "contact/make/curve.h"
#include "contact/skin.h"

#include <math.h>
#include <string.h>

#define NOBODY UINT32_MAX

typedef struct matching {
    const sk_particles *particles;
    const uint32_t (*triangle)[3];
    size_t count;
    const uint8_t *here;
    uint32_t (*beside)[3]; /* over the edge from corner k to the next: another triangle; or NOBODY */
    uint8_t *left;         /* how many of these have no partner */
    uint32_t *single;      /* a stack of those of which one is left */
    size_t singles;
    uint32_t *partner;
} matching;

static bool is_free(const matching *m, uint32_t t) {
    return m->partner[t] == NOBODY;
}

static real square_of_edge(const matching *m, uint32_t t, int k) {
    const uint32_t *corner = m->triangle[t];
    sk_vec3 way = sk_sub(m->particles->built[corner[(k + 1) % 3]], m->particles->built[corner[k]]);
    return sk_dot(way, way);
}

static bool is_longest(const matching *m, uint32_t t, int k) {
    real square = square_of_edge(m, t, k);
    return square >= square_of_edge(m, t, (k + 1) % 3) && square >= square_of_edge(m, t, (k + 2) % 3);
}

/* One that lies on another is beside nobody there: they have no two ends. */
static bool are_same(const uint32_t a[3], const uint32_t b[3]) {
    for (int k = 0; k < 3; k++)
        if (a[k] != b[0] && a[k] != b[1] && a[k] != b[2]) return false;
    return true;
}

/* Of more than two triangles at an edge the first two are beside each other, and the next two. */
static bool find_beside(matching *m, sk_allocator *allocator) {
    size_t size = 16;
    while (size < 6 * m->count) size *= 2;
    uint32_t *table =
        sk_allocate(allocator, size * sizeof *table); // of edges: three times the triangle, and which of its
    if (!table) return false;
    memset(table, 0xff, size * sizeof *table);
    memset(m->beside, 0xff, m->count * sizeof *m->beside);
    for (uint32_t t = 0; t < m->count; t++)
        for (uint32_t k = 0; m->here[t] && k < 3; k++) {
            const uint32_t a = m->triangle[t][k], b = m->triangle[t][(k + 1) % 3], low = a < b ? a : b,
                           high = a < b ? b : a;
            size_t at = sk_edge_place(low, high, size - 1);
            for (; table[at] != NOBODY; at = (at + 1) & (size - 1)) {
                const uint32_t other = table[at] / 3, of = table[at] % 3;
                const uint32_t c = m->triangle[other][of], d = m->triangle[other][(of + 1) % 3];
                if ((c != low || d != high) && (c != high || d != low)) continue;
                if (m->beside[other][of] != NOBODY) table[at] = 3 * t + k;
                else if (!are_same(m->triangle[t], m->triangle[other]))
                    m->beside[other][of] = t, m->beside[t][k] = other;
                break;
            }
            if (table[at] == NOBODY) table[at] = 3 * t + k;
        }
    sk_release(allocator, table);
    return true;
}

static void pair_up(matching *m, uint32_t a, uint32_t b) {
    m->partner[a] = b, m->partner[b] = a;
    const uint32_t both[2] = {a, b};
    for (int i = 0; i < 2; i++)
        for (int k = 0; k < 3; k++) {
            uint32_t other = m->beside[both[i]][k];
            if (other != NOBODY && is_free(m, other) && --m->left[other] == 1) m->single[m->singles++] = other;
        }
}

/* Those that follow each other over the longest edge of both. */
static void pair_cells(matching *m) {
    for (uint32_t t = 0; t + 1 < m->count; t++)
        for (int k = 0; k < 3 && is_free(m, t); k++) {
            if (m->beside[t][k] != t + 1 || !is_free(m, t + 1) || !is_longest(m, t, k)) continue;
            for (int o = 0; o < 3; o++)
                if (m->beside[t + 1][o] == t && is_longest(m, t + 1, o)) m->partner[t] = t + 1, m->partner[t + 1] = t;
        }
}

/* With whom of those that are left beside it: the one that has the fewest others, and of these over the longest edge. */
static void pair_one(matching *m, uint32_t t) {
    int best = -1;
    for (int k = 0; k < 3 && is_free(m, t); k++) {
        uint32_t other = m->beside[t][k];
        if (other == NOBODY || !is_free(m, other)) continue;
        if (best >= 0) {
            uint8_t left = m->left[other], least = m->left[m->beside[t][best]];
            if (left > least || (left == least && !(square_of_edge(m, t, k) > square_of_edge(m, t, best)))) continue;
        }
        best = k;
    }
    if (best >= 0) pair_up(m, t, m->beside[t][best]);
}

static void pair_others(matching *m) {
    for (uint32_t t = 0; t < m->count; t++) {
        m->left[t] = 0;
        for (int k = 0; k < 3; k++)
            if (m->beside[t][k] != NOBODY && is_free(m, m->beside[t][k])) m->left[t]++;
        if (is_free(m, t) && m->left[t] == 1) m->single[m->singles++] = t;
    }
    for (uint32_t t = 0; t < m->count; t++) {
        while (m->singles) pair_one(m, m->single[--m->singles]);
        pair_one(m, t);
    }
    while (m->singles) pair_one(m, m->single[--m->singles]);
}

/* ---- the order ---- */

/* Whether those from one to another lie about: how far apart, among them, those are that are beside each other. In rows it is a
 * third of a row; where nearly all are cells, these are in rows, however long. */
static bool lie_about(const matching *m, size_t first, size_t end) {
    double sum = 0, count = 0, cells = 0;
    for (size_t t = first; t < end; t++) cells += m->partner[t] == t + 1 || (t && m->partner[t] == t - 1);
    if (cells > 0.9 * (double)(end - first)) return false;
    for (size_t t = first; t < end; t++)
        for (int k = 0; k < 3; k++) {
            if (m->beside[t][k] == NOBODY) continue;
            sum += fabs((double)m->beside[t][k] - (double)t);
            count++;
        }
    return sum > 2 * sqrt((double)(end - first)) * count;
}

static void follow_curve(const matching *m, size_t first, size_t end, uint64_t *place, uint32_t *order,
                         uint32_t *other) {
    sk_vec3 low = {SK_REAL_MAX, SK_REAL_MAX, SK_REAL_MAX}, high = {-SK_REAL_MAX, -SK_REAL_MAX, -SK_REAL_MAX};
    for (size_t t = first; t < end; t++) {
        sk_vec3 b = m->particles->built[m->triangle[t][0]];
        low = (sk_vec3){sk_min(low.x, b.x), sk_min(low.y, b.y), sk_min(low.z, b.z)};
        high = (sk_vec3){sk_max(high.x, b.x), sk_max(high.y, b.y), sk_max(high.z, b.z)};
    }
    const sk_curve curve = sk_curve_through(low, high);
    for (size_t t = first; t < end; t++)
        place[t - first] = sk_curve_place(&curve, m->particles->built[m->triangle[t][0]]);
    sk_sort_by_place(place, order + first, place + (end - first), other, end - first);
}

/* The end of the run of triangles of one body from one on; of no body it is alone. Bodies mostly follow each other, as triangles do:
 * they are looked for from `at` on. */
static size_t end_of_body(const matching *m, const sk_meeting_parts *parts, size_t first, size_t *at) {
    const uint32_t particle = m->triangle[first][0];
    size_t end = first + 1;
    for (size_t tried = 0; tried < parts->body_count; tried++, ++*at) {
        if (*at >= parts->body_count) *at = 0;
        const sk_meeting_body *body = &parts->body[*at];
        if (particle < body->first || particle >= body->end) continue;
        while (end < m->count && m->triangle[end][0] >= body->first && m->triangle[end][0] < body->end) end++;
        break;
    }
    return end;
}

static bool put_in_order(const matching *m, sk_allocator *allocator, const sk_meeting_parts *parts, uint32_t *order) {
    uint64_t *place = sk_allocate(allocator, 2 * (m->count + 1) * sizeof *place);
    uint32_t *other = sk_allocate(allocator, (m->count + 1) * sizeof *other);
    for (size_t t = 0; t < m->count; t++) order[t] = (uint32_t)t;
    for (size_t first = 0, end, at = 0; first < m->count && place && other; first = end) {
        end = end_of_body(m, parts, first, &at);
        if (lie_about(m, first, end)) follow_curve(m, first, end, place, order, other);
    }
    bool good = place && other;
    sk_release(allocator, place);
    sk_release(allocator, other);
    return good;
}

bool sk_leaves_deal(uint32_t *partner, uint32_t *order, sk_allocator *allocator, const sk_particles *particles,
                    const sk_meeting_parts *parts, const uint8_t *here) {
    const size_t count = parts->triangle_count;
    matching m = {.particles = particles, .triangle = parts->triangle, .count = count, .here = here, .partner = partner};
    m.beside = sk_allocate(allocator, (count + 1) * sizeof *m.beside);
    m.left = sk_allocate(allocator, count + 1);
    m.single =
        sk_allocate(allocator, (2 * count + 1) * sizeof *m.single); // each is put there when one is left, and at first
    bool good = m.beside && m.left && m.single && find_beside(&m, allocator);
    memset(partner, 0xff, count * sizeof *partner);
    if (good) pair_cells(&m), pair_others(&m);
    good = good && put_in_order(&m, allocator, parts, order);
    sk_release(allocator, m.beside);
    sk_release(allocator, m.left);
    sk_release(allocator, m.single);
    return good;
}
