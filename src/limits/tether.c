#ifdef SK_ISA

/* Takes the lanes of p back onto the spheres around their anchors that they have left. */
SK_INLINE void SK_ISA(pull_in)(sk_wide3 *p, sk_wide3 anchor, sk_wide most) {
    sk_wide3 d = {p->x - anchor.x, p->y - anchor.y, p->z - anchor.z};
    sk_wide square = SK_ISA(sk_dot_wide)(d, d);
    sk_mask out = SK_ISA(sk_more)(square, most * most);
    if (!SK_ISA(sk_any)(out)) return;
    sk_wide s = most / SK_ISA(sk_wide_sqrt)(square);
    p->x = SK_ISA(sk_select)(out, anchor.x + s * d.x, p->x);
    p->y = SK_ISA(sk_select)(out, anchor.y + s * d.y, p->y);
    p->z = SK_ISA(sk_select)(out, anchor.z + s * d.z, p->z);
}

/* Anchor k of a block, where it stood at the start of the step: held particles stay there, and another thread may be
 * storing their block. One that is not held any more lets go. */
SK_INLINE sk_wide3 SK_ISA(anchor_of)(sk_run *run, const sk_limit *limit, size_t block, size_t k, sk_wide *most) {
    const uint32_t *anchor = limit->anchor + (limit->shared ? k : (block * limit->anchors + k) * SK_LANES);
    sk_wide3 at;
    for (int l = 0; l < SK_LANES; l++) {
        if (l && limit->shared) break;
        sk_vec4 q = run->vector[SK_PREVIOUS][anchor[l]];
        if (limit->shared) {
            at = (sk_wide3){SK_ISA(sk_splat)(q.x), SK_ISA(sk_splat)(q.y), SK_ISA(sk_splat)(q.z)};
            if (q.w > 0) *most = SK_ISA(sk_splat)((real)SK_FAR);
        } else {
            at.x[l] = q.x, at.y[l] = q.y, at.z[l] = q.z;
            if (q.w > 0) (*most)[l] = (real)SK_FAR;
        }
    }
    return at;
}

/* Several anchors are taken in turn, once forwards and once backwards, and the mean is kept: the last
 * one to pull would win otherwise, and a cloth between two pins would hang askew. Where velocities are
 * not taken from positions (a second source), the velocity away from an anchor ends here too. */
static void SK_ISA(keep_tethers)(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    const sk_limit *limit = row->rule;
    real factor = (real)(1 + *limit->bound);
    size_t anchors = limit->anchors;
    for (size_t slot = begin; slot < end; slot += SK_LANES) {
        size_t block = (slot - limit->first_slot) / SK_LANES;
        const sk_wide *length = (const sk_wide *)(const void *)limit->slot_length + block * anchors;
        sk_wide4 x = SK_ISA(sk_load_block)(run->vector[row->dst], slot, slot < row->packed);
        sk_wide3 forth = {x.x, x.y, x.z}, back = forth;
        for (size_t k = 0; k < anchors; k++) {
            sk_wide most = factor * length[k];
            sk_wide3 anchor = SK_ISA(anchor_of)(run, limit, block, k, &most);
            SK_ISA(pull_in)(&forth, anchor, most);
        }
        sk_mask moved =
            (SK_ISA(sk_differ)(forth.x, x.x) | SK_ISA(sk_differ)(forth.y, x.y) | SK_ISA(sk_differ)(forth.z, x.z)) &
            SK_ISA(sk_positive)(x.w);
        if (!SK_ISA(sk_any)(moved)) continue;
        if (anchors > 1) {
            for (size_t k = anchors; k-- > 0;) {
                sk_wide most = factor * length[k];
                sk_wide3 anchor = SK_ISA(anchor_of)(run, limit, block, k, &most);
                SK_ISA(pull_in)(&back, anchor, most);
            }
            real half = (real)0.5;
            forth = (sk_wide3){half * (forth.x + back.x), half * (forth.y + back.y), half * (forth.z + back.z)};
        }
        sk_wide3 move = {forth.x - x.x, forth.y - x.y, forth.z - x.z};
        x.x = SK_ISA(sk_select)(moved, forth.x, x.x);
        x.y = SK_ISA(sk_select)(moved, forth.y, x.y);
        x.z = SK_ISA(sk_select)(moved, forth.z, x.z);
        SK_ISA(sk_store_block)(run->vector[row->dst], slot, slot < row->packed, x);
        if (row->source[1] == SK_NONE) continue;
        // what still goes against the move stops
        sk_vec4 *velocity = run->vector[row->source[1]];
        sk_wide4 v = SK_ISA(sk_load_block)(velocity, slot, slot < row->packed);
        sk_wide square = SK_ISA(sk_dot_wide)(move, move), against = move.x * v.x + move.y * v.y + move.z * v.z;
        sk_wide s =
            SK_ISA(sk_keep)(moved & SK_ISA(sk_positive)(square) & SK_ISA(sk_negative)(against), -against / square);
        v.x += s * move.x, v.y += s * move.y, v.z += s * move.z;
        SK_ISA(sk_store_block)(velocity, slot, slot < row->packed, v);
    }
}

#else
#include "limits/limit.h"

#include <string.h>

#define SK_KERNELS "limits/tether.c"
#include "base/for_each_isa.h"

/* Whether all elements have the anchors of the first one. */
static bool anchors_shared(size_t count, size_t anchors, const uint32_t *particles) {
    for (size_t e = 1; e < count; e++)
        if (memcmp(particles + 1, particles + e * (1 + anchors) + 1, anchors * sizeof *particles)) return false;
    return true;
}

sk_limit *sk_tethers_create(sk_allocator *allocator, size_t count, size_t anchors, const uint32_t *particles,
                            const real *lengths) {
    sk_limit *limit = sk_allocate(allocator, sizeof *limit);
    if (!limit) return NULL;
    size_t indices = count * (1 + anchors);
    limit->kernel = (sk_kernels){SK_EACH_ISA(keep_tethers)};
    limit->count = count;
    limit->anchors = anchors;
    limit->shared = anchors_shared(count, anchors, particles);
    limit->particle = sk_allocate(allocator, indices * sizeof *limit->particle);
    limit->length = sk_allocate(allocator, count * anchors * sizeof *limit->length);
    if (!limit->particle || !limit->length) {
        sk_limit_release(limit, allocator);
        return NULL;
    }
    if (count) {
        memcpy(limit->particle, particles, indices * sizeof *particles);
        memcpy(limit->length, lengths, count * anchors * sizeof *lengths);
    }
    return limit;
}

void sk_limit_release(sk_limit *limit, sk_allocator *allocator) {
    if (!limit) return;
    sk_release(allocator, limit->particle);
    sk_release(allocator, limit->length);
    sk_release(allocator, limit->slot_length);
    sk_release(allocator, limit->anchor);
    sk_release(allocator, limit);
}

bool sk_limit_arrange(sk_limit *limit, sk_allocator *allocator, const sk_particles *particles) {
    size_t anchors = limit->anchors, low = SIZE_MAX, high = 0;
    sk_release(allocator, limit->slot_length);
    sk_release(allocator, limit->anchor);
    limit->slot_length = NULL;
    limit->anchor = NULL;
    for (size_t e = 0; e < limit->count; e++) {
        size_t slot = particles->slot_of[limit->particle[e * (1 + anchors)]];
        if (slot < low) low = slot;
        if (slot + 1 > high) high = slot + 1;
    }
    limit->first_slot = limit->count ? low / SK_LANES * SK_LANES : 0;
    limit->slot_count = limit->count ? (high + SK_LANES - 1) / SK_LANES * SK_LANES - limit->first_slot : 0;
    limit->slot_length = sk_allocate(allocator, limit->slot_count * anchors * sizeof *limit->slot_length);
    limit->anchor =
        sk_allocate(allocator, (limit->shared ? anchors : limit->slot_count * anchors) * sizeof *limit->anchor);
    if (!limit->slot_length || !limit->anchor) return false;
    for (size_t i = 0; i < limit->slot_count * anchors; i++) {
        limit->slot_length[i] = (real)SK_FAR;
        if (!limit->shared) limit->anchor[i] = (uint32_t)particles->empty_slot;
    }
    for (size_t e = 0; e < limit->count; e++) {
        const uint32_t *element = limit->particle + e * (1 + anchors);
        size_t at = particles->slot_of[element[0]] - limit->first_slot, block = at / SK_LANES, lane = at % SK_LANES;
        for (size_t k = 0; k < anchors; k++) {
            size_t place = (block * anchors + k) * SK_LANES + lane;
            limit->slot_length[place] = limit->length[e * anchors + k];
            limit->anchor[limit->shared ? k : place] = particles->slot_of[element[1 + k]];
        }
    }
    return true;
}
#endif
