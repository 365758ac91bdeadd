/* What a cut severs. Elements of few particles that are beside each other are judged by the faces that these have in
 * common, longer ones by ways along edges; tethers get the length of the way that is left. */
#include <math.h>
#include <string.h>

#include "world/cut.h"

static bool has(const sk_cut *cut, uint32_t face, uint32_t particle) {
    for (size_t i = cut->first[face]; i < cut->first[face + 1]; i++)
        if (cut->corner[i] == particle) return true;
    return false;
}

/* ---- ways along edges ---- */

static const uint32_t no_way = UINT32_MAX;

/* How many edges of faces (`all`, or those that are left) the shortest way has from a to b, or no_way if it has more than
 * `most`. */
static uint32_t edges_between(sk_cut *cut, uint32_t a, uint32_t b, bool all, uint32_t most) {
    size_t count = 1, at = 0, end = 1;
    cut->queue[0] = a;
    cut->mark[a] = ++cut->now;
    for (uint32_t edges = 1; edges <= most && at < count; edges++, end = count)
        for (; at < end; at++) {
            uint32_t p = cut->queue[at];
            for (size_t i = cut->first_side[p]; i < cut->first_side[p + 1]; i++) {
                sk_side side = cut->side[i];
                if (!all && !side.left) continue;
                if (side.particle == b) return edges;
                if (cut->mark[side.particle] == cut->now) continue;
                cut->mark[side.particle] = cut->now;
                cut->queue[count++] = side.particle;
            }
        }
    return no_way;
}

/* Whether one of the faces that have both particles is left. */
static bool is_side_left(const sk_cut *cut, uint32_t a, uint32_t b) {
    for (size_t i = cut->start[a]; i < cut->start[a + 1]; i++)
        if (!cut->face[cut->around[i]] && has(cut, cut->around[i], b)) return true;
    return false;
}

void sk_cut_find_sides(sk_cut *cut) {
    size_t particles = cut->body->particle_count, count = 0;
    for (size_t p = 0; p < particles; p++) {
        bool at_cut = false;
        for (size_t i = cut->start[p]; i < cut->start[p + 1]; i++) at_cut |= cut->face[cut->around[i]];
        cut->to_cut[p] = at_cut ? 0 : no_way;
        if (at_cut) cut->queue[count++] = (uint32_t)p;
        for (size_t i = cut->first_side[p]; i < cut->first_side[p + 1]; i++)
            cut->side[i].left = !at_cut || is_side_left(cut, (uint32_t)p, cut->side[i].particle);
    }
    for (size_t at = 0; at < count; at++) {
        uint32_t p = cut->queue[at];
        for (size_t i = cut->first_side[p]; i < cut->first_side[p + 1]; i++) {
            uint32_t q = cut->side[i].particle;
            if (cut->to_cut[q] != no_way) continue;
            cut->to_cut[q] = cut->to_cut[p] + 1;
            cut->queue[count++] = q;
        }
    }
}

void sk_cut_look_at(sk_cut *cut, sk_batch *batch) {
    if (!batch->only_bounds || sk_batch_carries(batch) || batch->most_edges || batch->arity != 2) return;
    const uint32_t *particle = batch->whole.particle ? batch->whole.particle : batch->particle;
    size_t count = batch->whole.particle ? batch->whole.count : batch->count;
    uint32_t most = 1;
    for (size_t e = 0; e < count; e++) {
        uint32_t a = particle[2 * e] - cut->body->first_particle, b = particle[2 * e + 1] - cut->body->first_particle;
        uint32_t edges = edges_between(cut, a, b, true, no_way);
        if (edges > most) most = edges;
    }
    batch->most_edges = most; // no_way where an element's ends do not hang together: all are looked at then
}

/* ---- elements ---- */

static bool is_severed(sk_cut *cut, const sk_batch *batch, uint32_t a, uint32_t b) {
    bool joined = false;
    for (size_t i = cut->start[a]; i < cut->start[a + 1]; i++) {
        uint32_t face = cut->around[i];
        if (!has(cut, face, b)) continue;
        if (!cut->face[face]) return false;
        joined = true;
    }
    if (joined) return true;
    // A shortest way that meets a cut face comes as near to it from both ends as it is long. What does not only bound goes
    // over two edges at most, and so begins or ends at the cut.
    uint64_t to_cut = (uint64_t)cut->to_cut[a] + cut->to_cut[b];
    if (batch->only_bounds ? to_cut > batch->most_edges : cut->to_cut[a] && cut->to_cut[b]) return false;
    uint32_t edges = edges_between(cut, a, b, true, no_way);
    return edges != no_way && to_cut <= edges && edges_between(cut, a, b, false, edges) > edges;
}

/* Whether a cut face had three of an element's particles. */
static bool spans_cut_face(const sk_cut *cut, const uint32_t *particle, size_t arity) {
    uint32_t first = cut->body->first_particle;
    for (size_t p = 0; p + 2 < arity; p++)
        for (size_t i = cut->start[particle[p] - first]; i < cut->start[particle[p] - first + 1]; i++) {
            uint32_t face = cut->around[i];
            size_t common = 1;
            if (!cut->face[face]) continue;
            for (size_t q = p + 1; q < arity; q++) common += has(cut, face, particle[q] - first);
            if (common > 2) return true;
        }
    return false;
}

bool sk_cut_severs(const void *data, const sk_batch *batch, const uint32_t *particle) {
    sk_cut *cut = (sk_cut *)(uintptr_t)data; // it changes only the marks of searches
    uint32_t first = cut->body->first_particle;
    if (sk_batch_carries(batch)) return true;
    for (size_t i = 0; i < batch->arity; i++)
        if (particle[i] - first >= cut->body->particle_count) return false; // it is also on another body's
    if (spans_cut_face(cut, particle, batch->arity)) return true;
    if (batch->enclosure) return false;
    for (size_t i = 1; i < batch->arity; i++)
        for (size_t j = 0; j < i; j++)
            if (is_severed(cut, batch, particle[i] - first, particle[j] - first)) return true;
    return false;
}

/* ---- tethers ---- */

/* A search for the shortest ways from anchors: along edges and across faces from corner to corner. */
typedef struct ways {
    const sk_cut *cut;
    const sk_particles *particles;
    double *length;         /* of each particle; infinite where no way leads */
    uint32_t *from;         /* the anchor that it comes from */
    uint32_t *heap, *place; /* particles, the nearest on top, and of each its place there plus 1 */
    size_t count;
} ways;

static void settle_in(ways *w, size_t i, uint32_t particle) {
    w->heap[i] = particle;
    w->place[particle] = (uint32_t)i + 1;
}

static void rise(ways *w, uint32_t particle) {
    size_t i = w->place[particle] ? w->place[particle] - 1 : w->count++;
    for (; i && w->length[w->heap[(i - 1) / 2]] > w->length[particle]; i = (i - 1) / 2)
        settle_in(w, i, w->heap[(i - 1) / 2]);
    settle_in(w, i, particle);
}

static uint32_t take_nearest(ways *w) {
    uint32_t top = w->heap[0], last = w->heap[--w->count];
    w->place[top] = 0;
    if (!w->count) return top;
    size_t i = 0, child;
    while ((child = 2 * i + 1) < w->count) {
        if (child + 1 < w->count && w->length[w->heap[child + 1]] < w->length[w->heap[child]]) child++;
        if (w->length[w->heap[child]] >= w->length[last]) break;
        settle_in(w, i, w->heap[child]);
        i = child;
    }
    settle_in(w, i, last);
    return top;
}

/* Finds the ways from the k-th anchors of a limit's elements over all faces, or over those that are left. */
static void find_ways(ways *w, const sk_limit *limit, size_t k, bool all) {
    const sk_cut *cut = w->cut;
    uint32_t first = cut->body->first_particle;
    for (size_t p = 0; p < cut->body->particle_count; p++) w->length[p] = INFINITY, w->place[p] = 0;
    w->count = 0;
    for (size_t e = 0; e < limit->count; e++) {
        uint32_t anchor = limit->particle[e * (1 + limit->anchors) + 1 + k] - first;
        if (limit->length[e * limit->anchors + k] >= (real)SK_FAR || w->length[anchor] == 0) continue;
        w->length[anchor] = 0, w->from[anchor] = anchor;
        rise(w, anchor);
    }
    while (w->count) {
        uint32_t p = take_nearest(w);
        for (size_t i = cut->start[p]; i < cut->start[p + 1]; i++) {
            uint32_t f = cut->around[i];
            if (!all && cut->face[f]) continue;
            for (size_t c = cut->first[f]; c < cut->first[f + 1]; c++) {
                uint32_t q = cut->corner[c];
                const sk_vec3 *built = w->particles->built + first;
                double x = (double)built[q].x - (double)built[p].x, y = (double)built[q].y - (double)built[p].y,
                       z = (double)built[q].z - (double)built[p].z, length = w->length[p] + sqrt(x * x + y * y + z * z);
                if (!(length < w->length[q])) continue;
                w->length[q] = length, w->from[q] = w->from[p];
                rise(w, q);
            }
        }
    }
}

/* Where the way to an anchor is longer than it was, the tether has its length: no less than that along the cloth, and at
 * most 8 % more. Where another anchor is nearer now, it is let go. */
static void find_lengths(const ways *whole, const ways *left, sk_limit *limit, size_t k) {
    uint32_t first = whole->cut->body->first_particle;
    for (size_t e = 0; e < limit->count; e++) {
        const uint32_t *element = limit->particle + e * (1 + limit->anchors);
        uint32_t p = element[0] - first, anchor = element[1 + k] - first;
        real *length = &limit->cut_length[e * limit->anchors + k];
        *length = limit->length[e * limit->anchors + k];
        if (left->length[p] <= whole->length[p] * (1 + 1e-9)) continue;
        bool reaches = left->length[p] < INFINITY && left->from[p] == anchor;
        *length = reaches ? (real)fmax((double)*length, left->length[p]) : (real)SK_FAR;
    }
}

static bool make_ways(ways *w, const skein_world *world, const sk_cut *cut, sk_allocator *allocator) {
    size_t count = cut->body->particle_count;
    *w = (ways){.cut = cut, .particles = &world->particles};
    w->length = sk_allocate(allocator, count * sizeof *w->length);
    w->from = sk_allocate(allocator, count * sizeof *w->from);
    w->heap = sk_allocate(allocator, count * sizeof *w->heap);
    w->place = sk_allocate(allocator, count * sizeof *w->place);
    return w->length && w->from && w->heap && w->place;
}

static void release_ways(ways *w, sk_allocator *allocator) {
    sk_release(allocator, w->length);
    sk_release(allocator, w->from);
    sk_release(allocator, w->heap);
    sk_release(allocator, w->place);
}

bool sk_cut_tethers(skein_world *world, sk_body *body) {
    sk_allocator *allocator = &world->allocator;
    const sk_cut *cut = body->cut;
    ways whole = {0}, left = {0};
    bool good = !cut->count || (make_ways(&whole, world, cut, allocator) && make_ways(&left, world, cut, allocator));
    for (size_t i = 0; i < world->rules.limits.count && good; i++) {
        sk_limit *limit = world->rules.limits.data[i];
        if (limit->enabled != &body->enabled) continue;
        if (!cut->count) {
            sk_release(allocator, limit->cut_length);
            limit->cut_length = NULL;
            continue;
        }
        if (!limit->cut_length)
            limit->cut_length = sk_allocate(allocator, (limit->count * limit->anchors + 1) * sizeof *limit->cut_length);
        good = limit->cut_length != NULL;
        for (size_t k = 0; k < limit->anchors && good; k++) {
            find_ways(&whole, limit, k, true);
            find_ways(&left, limit, k, false);
            find_lengths(&whole, &left, limit, k);
        }
    }
    release_ways(&whole, allocator);
    release_ways(&left, allocator);
    return good;
}
