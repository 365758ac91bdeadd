/* The walk over groups, which is one for the library's own kinds, for texts on tapes and for texts that are compiled: sixteen
 * elements that share no particle come from anywhere in the state vectors, and go back. After projection.h. Whose arithmetic
 * is in registers defines WORK_OUT(element, constants, mode, data), which says whether anything moves, and has meet(). */

/* Puts a part's particles, which are all different, to where they come. */
SK_INLINE void scatter_to(sk_wide3 to, sk_vec4 *vector, size_t packed, const uint32_t *slot, sk_wide4 old) {
    if (!packed) {
        sk_scatter(vector, slot, (sk_wide4){to.x, to.y, to.z, old.w});
        return;
    }
    for (int l = 0; l < SK_PART; l++) sk_store_at(vector, packed, slot[l], sk_v3(to.x[l], to.y[l], to.z[l]));
}

/* A part of a group on its way: what was gathered, and what comes of it. */
typedef struct group_part {
    sk_wide4 at[SK_ARITY], other_at[SK_ARITY];
    sk_element e;
    const uint32_t *slots;
    size_t lane;
} group_part;

SK_INLINE void begin_part(group_part *p, const skein_groups *g, size_t arity, size_t group, size_t part) {
    p->slots = g->slots + group * arity * SK_LANES + part;
    p->lane = group * SK_LANES + part;
}

SK_INLINE sk_wide lanes_at(const real *from) {
    sk_wide a;
    memcpy(&a, from, sizeof a);
    return a;
}

SK_INLINE void take_particle(group_part *p, int i, const skein_groups *g, size_t packed) {
    const uint32_t *slot = p->slots + i * SK_LANES;
    p->at[i] = sk_gather_any((const sk_vec4 *)(const void *)g->positions, packed, slot);
    p->e.x[i] = (sk_wide3){p->at[i].x, p->at[i].y, p->at[i].z}, p->e.w[i] = p->at[i].w;
}

SK_INLINE void take_other(group_part *p, int i, const skein_groups *g, size_t packed) {
    p->other_at[i] = sk_gather_any((const sk_vec4 *)(const void *)g->other, packed, p->slots + i * SK_LANES);
    p->e.other[i] = (sk_wide3){p->other_at[i].x, p->other_at[i].y, p->other_at[i].z};
}

/* What a mode reads of an element besides its particles. */
SK_INLINE void take_values(group_part *p, const skein_groups *g, const sk_element_constants *c, sk_element_mode mode) {
    for (int r = 0; r < SK_RESTS; r++) p->e.rest[r] = lanes_at(g->rest + (size_t)r * g->rest_stride + p->lane);
    p->e.stiffness = lanes_at(g->stiffness + p->lane);
    p->e.soft = lanes_at(g->compliance + p->lane) * c->per_step;
    if (keeps_multiplier(mode)) p->e.multiplier = lanes_at(g->multiplier + p->lane);
}

SK_INLINE void put_down(const group_part *p, const skein_groups *g, size_t packed, sk_element_mode mode) {
    bool sums = mode == SK_MODE_FORCE || mode == SK_MODE_APPLY;
    sk_vec4 *dst = (sk_vec4 *)(void *)(sums ? g->sums : g->positions);
    SK_EACH_PARTICLE_OF (&p->e, i) {
        const uint32_t *slot = p->slots + i * SK_LANES;
        if (!SK_READS(&p->e, i)) continue;
        sk_wide4 old = sums ? sk_gather_any(dst, packed, slot) : p->at[i], other_old = p->other_at[i];
        sk_wide3 from = {old.x, old.y, old.z}, other_from = {other_old.x, other_old.y, other_old.z};
        scatter_to(sums ? with_sign(&p->e, i, from, given(&p->e, i, mode)) : put(&p->e, i, from, p->e.scale, mode), dst,
                   packed, slot, old);
        if (mode == SK_MODE_LIMIT_MOVING)
            scatter_to(put(&p->e, i, other_from, p->e.velocity_scale, mode), (sk_vec4 *)(void *)g->other, packed, slot,
                       other_old);
    }
    if (keeps_multiplier(mode)) memcpy(g->multiplier + p->lane, &p->e.multiplier, sizeof(sk_wide));
}

enum { GROUPS_AHEAD = 12 };

/* Asks for what a group reads in order, long before it is its turn: of large meshes it comes from far away, and in pieces
 * that are too short for a processor to guess. There need be no such group. */
SK_INLINE void fetch_group(const skein_groups *g, size_t group, size_t arity, size_t rests) {
    for (size_t i = 0; i < arity; i++) __builtin_prefetch(g->slots + (group * arity + i) * SK_LANES);
    for (size_t r = 0; r < rests; r++) __builtin_prefetch(g->rest + r * g->rest_stride + group * SK_LANES);
    __builtin_prefetch(g->compliance + group * SK_LANES);
}

/* Gathers, works out and puts back `count` groups from one on, which share no particle. */
typedef void group_meeting(const skein_groups *g, const sk_element_constants *c, size_t group, size_t count,
                           size_t packed, sk_element_mode mode, void *data);

/* All groups, up to `most` at a time. Groups with a particle in strips are reached one by one; where there are no strips,
 * which is asked once for all groups and not at each, the compiler sees no such way, which would take the registers of the
 * other. What is constant is so where this is inlined. */
SK_INLINE void walk_all(const skein_groups *g, const sk_element_constants *c, size_t arity, size_t rests, size_t most,
                        size_t packed, sk_element_mode mode, group_meeting *meeting, void *data) {
    for (size_t group = 0, count; group < g->count; group += count) {
        count = 1;
        if (most > 1) {
            count = g->ahead[group] < most ? g->ahead[group] : most;
            if (count > g->count - group) count = g->count - group;
        }
        for (size_t i = 0; i < count; i++) fetch_group(g, group + i + GROUPS_AHEAD, arity, rests);
        const uint32_t *slots = g->slots + group * arity * SK_LANES;
        bool strips = false;
        for (size_t i = 0; i < count * arity * SK_LANES && packed; i++) strips |= slots[i] < packed;
        meeting(g, c, group, count, strips ? packed : 0, mode, data);
    }
}

SK_INLINE void walk_groups(const skein_groups *g, const sk_element_constants *c, size_t arity, size_t rests,
                           size_t most, sk_element_mode mode, group_meeting *meeting, void *data) {
    if (g->packed) walk_all(g, c, arity, rests, most, g->packed, mode, meeting, data);
    else walk_all(g, c, arity, rests, most, 0, mode, meeting, data);
}

#ifdef WORK_OUT

/* A part's particles come; what else is read of its elements is read when they are worked out, so that no register keeps it
 * until then. */
SK_INLINE void take_part(group_part *p, const skein_groups *g, size_t group, size_t part, size_t packed,
                         sk_element_mode mode) {
    begin_part(p, g, SK_ARITY, group, part);
    SK_EACH_PARTICLE (i) {
        take_particle(p, i, g, packed);
        if (positions_are_enough(mode)) continue;
        if (mode != SK_MODE_FORCE || g->other) take_other(p, i, g, packed);
        else p->e.other[i] = (sk_wide3){{0}, {0}, {0}}; // what no damping is multiplied by must be a number
    }
}

SK_INLINE void meet(const skein_groups *g, const sk_element_constants *c, size_t group, size_t count, size_t packed,
                    sk_element_mode mode, void *data) {
    for (size_t part = 0; part < SK_LANES; part += SK_PART) {
        group_part p;
        take_part(&p, g, group, part, packed, mode);
        take_values(&p, g, c, mode);
        if (WORK_OUT(&p.e, c, mode, data)) put_down(&p, g, packed, mode);
    }
    (void)count, (void)data;
}

/* A part that was taken is there before what follows. With AVX-512 clang would put its shuffles off until it is worked out
 * itself, which takes 1.1 times as long; gcc keeps to what is written, and with AVX2 there are no registers to be early. */
SK_INLINE void settle(group_part *p) {
#if defined(__clang__) && SK_WIDTH == 64
    SK_EACH_PARTICLE (i) {
        sk_wide4 *at = &p->at[i];
        __asm__ volatile("" : "+v"(at->x), "+v"(at->y), "+v"(at->z), "+v"(at->w));
        p->e.x[i] = (sk_wide3){at->x, at->y, at->z}, p->e.w[i] = at->w;
    }
#endif
    (void)p;
}

/* Groups [first, end), each of which shares no particle with the next one, flow: the next part comes before this one is put
 * down, while it waits for its root and its division. (A processor looks some hundred operations ahead, which is less than a
 * part has. A frame of a mesh of 20,164 vertices took 3.1 ms one by one, 2.34 two groups side by side, and takes 2.13 so; with
 * AVX2 2.9, 2.53 and 2.43.) */
SK_INLINE void flow(const skein_groups *g, const sk_element_constants *c, size_t first, size_t end,
                    sk_element_mode mode, void *data) {
    const size_t last = end * SK_LANES - SK_PART;
    group_part now, next;
    take_part(&now, g, first, 0, 0, mode);
    for (size_t lane = first * SK_LANES; lane <= last; lane += SK_PART, now = next) {
        size_t following = lane < last ? lane + SK_PART : last; // (nobody needs the last part twice, nor does it harm)
        if (lane % SK_LANES == 0) fetch_group(g, lane / SK_LANES + GROUPS_AHEAD, SK_ARITY, SK_RESTS);
        take_values(&now, g, c, mode);
        bool moves = WORK_OUT(&now.e, c, mode, data);
        take_part(&next, g, following / SK_LANES, following % SK_LANES, 0, mode);
        settle(&next);
        if (moves) put_down(&now, g, 0, mode);
    }
    (void)data;
}

/* Groups flow where registers are enough for two parts: of SSE they are not (4.1 ms instead of 3.8). */
SK_INLINE void walk_elements(const skein_groups *g, const sk_element_constants *c, sk_element_mode mode, void *data) {
    bool flows = SK_ARITY == 2 && SK_WIDTH > 16 && mode == SK_MODE_PROJECT;
    if (!flows || g->packed) {
        walk_groups(g, c, SK_ARITY, SK_RESTS, 1, mode, meet, data);
        return;
    }
    for (size_t group = 0, end; group < g->count; group = end) {
        for (end = group + 1; end < g->count && g->ahead[end - 1] > 1;) end++;
        flow(g, c, group, end, mode, data);
    }
}

#endif
