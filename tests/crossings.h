/* Edges that go through triangles, counted by ourselves: all edges and all triangles of a world's bodies, sorted along x
 * so that large worlds can be looked at in every frame. Knows nothing of the library's own search. */
#ifndef TESTS_CROSSINGS_H
#define TESTS_CROSSINGS_H

#include "helpers.h"

typedef struct crossing {
    uint32_t edge[2], triangle[3];
} crossing;

typedef struct crossing_search {
    uint32_t (*corner)[3];
    size_t count, room;
    vec3 *x;
    uint32_t *order; /* of triangles, by their least x */
    double *low, *high;
    size_t found;
    crossing first; /* of those that were found */
} crossing_search;

static inline vec3 crossing_cross(vec3 a, vec3 b) {
    return (vec3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static inline double crossing_volume(vec3 a, vec3 b, vec3 c, vec3 d) {
    vec3 n = crossing_cross(minus(b, a), minus(c, a)), to = minus(d, a);
    return n.x * to.x + n.y * to.y + n.z * to.z;
}

/* Whether p q goes through the triangle t; what has a corner in common does not, nor what begins or ends within two
 * roundings of its plane: a flat sheet's own edges lie there. */
static inline bool crossing_is(const vec3 *x, uint32_t p, uint32_t q, const uint32_t t[3]) {
    for (int k = 0; k < 3; k++)
        if (p == t[k] || q == t[k]) return false;
    double one = crossing_volume(x[t[0]], x[t[1]], x[t[2]], x[p]),
           two = crossing_volume(x[t[0]], x[t[1]], x[t[2]], x[q]);
    double least = 2 * EPSILON * (fabs(x[p].x) + fabs(x[p].y) + fabs(x[p].z)) *
                   length3(crossing_cross(minus(x[t[1]], x[t[0]]), minus(x[t[2]], x[t[0]])));
    if (!((one > least && two < -least) || (one < -least && two > least))) return false;
    double s[3];
    for (int k = 0; k < 3; k++) s[k] = crossing_volume(x[p], x[q], x[t[k]], x[t[(k + 1) % 3]]);
    return (s[0] > 0 && s[1] > 0 && s[2] > 0) || (s[0] < 0 && s[1] < 0 && s[2] < 0);
}

static inline crossing_search crossing_begin(skein_world *world) {
    crossing_search all = {0};
    for (size_t b = 0; b < skein_object_count(world, SKEIN_BODY); b++) {
        skein_surface s;
        OK(world, skein_body_surface(world, skein_object_at(world, SKEIN_BODY, b), &s));
        all.corner = realloc(all.corner, (all.count + s.face_vertex_count + 1) * sizeof *all.corner);
        const uint32_t *corner = s.face_vertices;
        for (size_t f = 0; f < s.face_count; corner += s.face_sizes[f++])
            for (uint32_t k = 1; k + 1 < s.face_sizes[f]; k++, all.count++)
                for (uint32_t j = 0; j < 3; j++)
                    all.corner[all.count][j] = s.particle_of_vertex[corner[j ? k + j - 1 : 0]];
    }
    all.x = malloc((skein_particle_count(world) + 1) * sizeof *all.x);
    all.order = malloc((all.count + 1) * sizeof *all.order);
    all.low = malloc(3 * (all.count + 1) * sizeof *all.low);
    all.high = malloc(3 * (all.count + 1) * sizeof *all.high);
    for (size_t t = 0; t < all.count; t++) all.order[t] = (uint32_t)t;
    return all;
}

static inline void crossing_free(crossing_search *all) {
    free(all->corner), free(all->x), free(all->order), free(all->low), free(all->high);
}

static inline void crossing_sides(crossing_search *all, const uint32_t edges[3], const uint32_t t[3]) {
    for (int k = 0; k < 3; k++)
        if (crossing_is(all->x, edges[k], edges[(k + 1) % 3], t)) {
            if (!all->found++) all->first = (crossing){{edges[k], edges[(k + 1) % 3]}, {t[0], t[1], t[2]}};
        }
}

/* Sides of triangles that go through triangles; a side that two share counts twice. */
static inline size_t crossings_now(crossing_search *all, const skein_world *world) {
    OK(world, skein_positions_copy(world, 0, skein_particle_count(world), &all->x->x));
    for (size_t t = 0; t < all->count; t++)
        for (int k = 0; k < 3; k++) {
            const uint32_t *c = all->corner[t];
            double a = (&all->x[c[0]].x)[k], b = (&all->x[c[1]].x)[k], d = (&all->x[c[2]].x)[k];
            all->low[3 * t + (size_t)k] = fmin(a, fmin(b, d));
            all->high[3 * t + (size_t)k] = fmax(a, fmax(b, d));
        }
    for (size_t i = 1; i < all->count; i++) { // nearly sorted since the last time
        uint32_t t = all->order[i];
        size_t at = i;
        for (; at && all->low[3 * all->order[at - 1]] > all->low[3 * t]; at--) all->order[at] = all->order[at - 1];
        all->order[at] = t;
    }
    all->found = 0;
    for (size_t i = 0; i < all->count; i++)
        for (size_t j = i + 1; j < all->count; j++) {
            size_t a = 3 * (size_t)all->order[i], b = 3 * (size_t)all->order[j];
            if (all->low[b] > all->high[a]) break;
            if (all->low[b + 1] > all->high[a + 1] || all->low[a + 1] > all->high[b + 1]) continue;
            if (all->low[b + 2] > all->high[a + 2] || all->low[a + 2] > all->high[b + 2]) continue;
            crossing_sides(all, all->corner[a / 3], all->corner[b / 3]);
            crossing_sides(all, all->corner[b / 3], all->corner[a / 3]);
        }
    return all->found;
}

/* The same of a world whose surfaces are looked for now. */
static inline size_t crossings_of(skein_world *world) {
    crossing_search all = crossing_begin(world);
    const size_t crossings = crossings_now(&all, world);
    crossing_free(&all);
    return crossings;
}

#endif
