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
    if (mode == SK_MODE_PROJECT_DAMPED) p->e.multiplier = lanes_at(g->multiplier + p->lane);
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
    if (mode == SK_MODE_PROJECT_DAMPED) memcpy(g->multiplier + p->lane, &p->e.multiplier, sizeof(sk_wide));
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

/* All groups, up to `most` at a time. Groups with a particle in strips are reached one by one. What is constant is so where
 * this is inlined. */
SK_INLINE void walk_groups(const skein_groups *g, const sk_element_constants *c, size_t arity, size_t rests,
                           size_t most, sk_element_mode mode, group_meeting *meeting, void *data) {
    for (size_t group = 0, count; group < g->count; group += count) {
        count = 1;
        if (most > 1) {
            count = g->ahead[group] < most ? g->ahead[group] : most;
            if (count > g->count - group) count = g->count - group;
        }
        for (size_t i = 0; i < count; i++) fetch_group(g, group + i + GROUPS_AHEAD, arity, rests);
        const uint32_t *slots = g->slots + group * arity * SK_LANES;
        bool strips = false;
        for (size_t i = 0; i < count * arity * SK_LANES && g->packed; i++) strips |= slots[i] < g->packed;
        meeting(g, c, group, count, strips ? g->packed : 0, mode, data);
    }
}

#ifdef WORK_OUT

enum { PAIR = 2 };

SK_INLINE void take_part(group_part *p, const skein_groups *g, const sk_element_constants *c, size_t group, size_t part,
                         size_t packed, sk_element_mode mode) {
    begin_part(p, g, SK_ARITY, group, part);
    SK_EACH_PARTICLE (i) {
        take_particle(p, i, g, packed);
        if (mode == SK_MODE_PROJECT || mode == SK_MODE_LIMIT) continue;
        if (mode != SK_MODE_FORCE || g->other) take_other(p, i, g, packed);
        else p->e.other[i] = (sk_wide3){{0}, {0}, {0}}; // what no damping is multiplied by must be a number
    }
    take_values(p, g, c, mode);
}

/* Two groups that share no particle go side by side: one's roots and divisions are worked out while the other waits for
 * its own. */
SK_INLINE void meet(const skein_groups *g, const sk_element_constants *c, size_t group, size_t count, size_t packed,
                    sk_element_mode mode, void *data) {
    for (size_t part = 0; part < SK_LANES; part += SK_PART) {
        group_part p, q;
        if (count == PAIR) {
            take_part(&p, g, c, group, part, 0, mode);
            take_part(&q, g, c, group + 1, part, 0, mode);
            (void)WORK_OUT(&p.e, c, mode, data);
            (void)WORK_OUT(&q.e, c, mode, data);
            put_down(&p, g, 0, mode);
            put_down(&q, g, 0, mode);
        } else {
            take_part(&p, g, c, group, part, packed, mode);
            if (WORK_OUT(&p.e, c, mode, data)) put_down(&p, g, packed, mode);
        }
    }
    (void)data;
}

/* Pairs are worth it where registers are enough for both. */
SK_INLINE void walk_elements(const skein_groups *g, const sk_element_constants *c, sk_element_mode mode, void *data) {
    bool pairs = SK_ARITY == 2 && SK_WIDTH > 16 && mode == SK_MODE_PROJECT && !g->packed;
    walk_groups(g, c, SK_ARITY, SK_RESTS, pairs ? PAIR : 1, mode, meet, data);
}

#endif
