/* The walks of constraints between two particles, once for each instruction set (no include guard).
 *
 * The kind that includes this has defined SK_ISA(pair), its arithmetic on sixteen elements at once: it
 * reads a and b and writes da and db (and, when moving, dv_a and dv_b): a gets da, b loses db. How particles
 * come in and go out is here alone, so that the arithmetic does not know the layout. */

/* Reads what a mode needs of sixteen elements besides positions. */
SK_INLINE void SK_ISA(set_values)(sk_pair *p, const sk_sweep *sweep, const sk_pair_constants *constants, size_t lane,
                                  bool special, bool multiplier) {
    const sk_batch *batch = sweep->batch;
    if (special) {
        p->rest = *(const sk_wide *)(const void *)(batch->lane_rest + lane);
        p->stiffness = *(const sk_wide *)(const void *)(batch->lane_stiffness + lane);
        p->soft = *(const sk_wide *)(const void *)(batch->lane_compliance + lane) * constants->per_step;
    } else {
        p->rest = SK_ISA(sk_splat)(sweep->rest);
        p->stiffness = SK_ISA(sk_splat)(sweep->stiffness);
        p->soft = SK_ISA(sk_splat)(sweep->compliance * constants->per_step);
    }
    if (multiplier) p->multiplier = *(const sk_wide *)(const void *)(batch->lane_multiplier + lane);
}

SK_INLINE sk_wide3 SK_ISA(load3)(const sk_wide *block) {
    return (sk_wide3){block[0], block[1], block[2]};
}
SK_INLINE void SK_ISA(add3)(sk_wide *block, sk_wide3 d) {
    block[0] += d.x, block[1] += d.y, block[2] += d.z;
}
SK_INLINE void SK_ISA(take3)(sk_wide *block, sk_wide3 d) {
    block[0] -= d.x, block[1] -= d.y, block[2] -= d.z;
}
/* Lanes turned by `shift`, as blocks do that meet over the end of a strip. */
SK_INLINE sk_wide SK_ISA(turn)(sk_wide a, int shift) {
    return shift ? SK_ISA(sk_rotate)(a, shift) : a;
}
SK_INLINE sk_wide3 SK_ISA(turn3)(sk_wide3 a, int shift) {
    return (sk_wide3){SK_ISA(turn)(a.x, shift), SK_ISA(turn)(a.y, shift), SK_ISA(turn)(a.z, shift)};
}

/* ---- strips: projections and limits ---- */

/* Block a meets block b. `mode` is a constant where this is inlined, and `shift` is or is not 0. */
SK_INLINE void SK_ISA(meet_blocks)(sk_run *run, const sk_sweep *sweep, const sk_pair_constants *constants, size_t lane,
                                   size_t slot_a, size_t slot_b, int shift, sk_pair_mode mode) {
    bool special = shift || sweep->batch->special[lane / SK_LANES];
    sk_wide *xa = (sk_wide *)(void *)(run->vector[SK_X] + slot_a),
            *xb = (sk_wide *)(void *)(run->vector[SK_X] + slot_b);
    sk_wide3 b = SK_ISA(load3)(xb);
    sk_pair p = {.a = SK_ISA(load3)(xa), .b = SK_ISA(turn3)(b, shift), .wa = xa[3], .wb = SK_ISA(turn)(xb[3], shift)};
    sk_wide *other_a = NULL, *other_b = NULL;
    if (mode != SK_PAIR_PROJECT && mode != SK_PAIR_LIMIT) {
        sk_vec4 *other = run->vector[mode == SK_PAIR_PROJECT_DAMPED ? SK_X0 : SK_V];
        other_a = (sk_wide *)(void *)(other + slot_a), other_b = (sk_wide *)(void *)(other + slot_b);
        p.other_a = SK_ISA(load3)(other_a);
        p.other_b = SK_ISA(turn3)(SK_ISA(load3)(other_b), shift);
    }
    SK_ISA(set_values)(&p, sweep, constants, lane, special, mode == SK_PAIR_PROJECT_DAMPED);
    SK_ISA(pair)(&p, constants, mode);
    // from what was loaded: reading again would wait for the stores
    sk_wide3 db = SK_ISA(turn3)(p.db, -shift);
    xa[0] = p.a.x + p.da.x, xa[1] = p.a.y + p.da.y, xa[2] = p.a.z + p.da.z;
    xb[0] = b.x - db.x, xb[1] = b.y - db.y, xb[2] = b.z - db.z;
    if (mode == SK_PAIR_PROJECT_DAMPED) *(sk_wide *)(void *)(sweep->batch->lane_multiplier + lane) = p.multiplier;
    if (mode == SK_PAIR_LIMIT_MOVING) {
        SK_ISA(add3)(other_a, p.dv_a);
        SK_ISA(take3)(other_b, SK_ISA(turn3)(p.dv_b, -shift));
    }
}

/* Blocks [first, last) of strip rows [begin, end): along a row each block waits for the one before it, so
 * rows that share no particle go side by side. */
SK_INLINE void SK_ISA(meet_span)(sk_run *run, const sk_sweep *sweep, const sk_pair_constants *constants, size_t begin,
                                 size_t end, size_t first, size_t last, int shift, sk_pair_mode mode) {
    size_t line = sweep->walk.width * SK_LANES, first_slot = sweep->walk.first_slot;
    size_t to_b = (size_t)((int64_t)sweep->row_step * (int64_t)line +
                           (sweep->column_step - (int64_t)shift * (int64_t)sweep->walk.width) * SK_LANES);
    if (sweep->row_step) {
        for (size_t at = begin * line + first * SK_LANES; at < begin * line + last * SK_LANES; at += SK_LANES)
            SK_ISA(meet_blocks)
        (run, sweep, constants, sweep->first_lane + at, first_slot + at, first_slot + at + to_b, shift, mode);
        return;
    }
    for (size_t k = first; k < last; k++)
        for (size_t at = begin * line + k * SK_LANES; at < end * line; at += line) SK_ISA(meet_blocks)
    (run, sweep, constants, sweep->first_lane + at, first_slot + at, first_slot + at + to_b, shift, mode);
}

typedef void SK_ISA(span_walk)(sk_run *run, const sk_sweep *sweep, const sk_pair_constants *constants, size_t begin,
                               size_t end, size_t first, size_t last, int shift);

/* Strip rows [begin, end), one by one unless they go side by side. `turned` walks the spans that lead over a strip's
 * end: a function of its own, since few do and inlining it everywhere would be slow to compile. */
SK_INLINE void SK_ISA(sweep_strips)(sk_run *run, const sk_row *row, size_t begin, size_t end, sk_pair_mode mode,
                                    SK_ISA(span_walk) * turned) {
    const sk_sweep *sweep = row->rule;
    sk_pair_constants constants = sk_pair_prepare(sweep->batch, row);
    size_t side_by_side = sweep->row_step == 0 ? SK_ROWS_SIDE_BY_SIDE : 1;
    for (size_t r = begin; r < end; r += side_by_side) {
        size_t stop = r + side_by_side < end ? r + side_by_side : end;
        for (size_t i = 0; i < sweep->span_count; i++) {
            sk_span at = sweep->span[i];
            if (!at.shift) SK_ISA(meet_span)(run, sweep, &constants, r, stop, at.first, at.last, 0, mode);
            else if (mode == SK_PAIR_PROJECT)
                SK_ISA(meet_span)(run, sweep, &constants, r, stop, at.first, at.last, at.shift, mode);
            else turned(run, sweep, &constants, r, stop, at.first, at.last, at.shift);
        }
    }
}

/* ---- strips: forces ---- */

/* Which ends of a strip row's elements get their forces: those in the rows that are asked for. */
typedef struct SK_ISA(pull_ends) {
    bool a, b;
} SK_ISA(pull_ends);

/* Blocks [first, last) of strip row r pull at their partners. */
SK_INLINE void SK_ISA(pull_span)(sk_run *run, const sk_row *row, const sk_sweep *sweep,
                                 const sk_pair_constants *constants, size_t r, sk_span span, int shift,
                                 SK_ISA(pull_ends) ends) {
    size_t line = sweep->walk.width * SK_LANES;
    ptrdiff_t to_b = ((ptrdiff_t)sweep->row_step * (ptrdiff_t)line +
                      (sweep->column_step - (ptrdiff_t)shift * (ptrdiff_t)sweep->walk.width) * SK_LANES) *
                     4;
    size_t begin = r * line + span.first * SK_LANES, end = r * line + span.last * SK_LANES;
    for (size_t at = begin; at < end; at += SK_LANES) {
        size_t slot = sweep->walk.first_slot + at;
        const real *x = (const real *)(const void *)(run->vector[SK_X] + slot),
                   *v = (const real *)(const void *)(run->vector[SK_V] + slot);
        real *f = (real *)(void *)(run->vector[row->dst] + slot);
        sk_pair p = {.a = SK_ISA(load3)((const sk_wide *)(const void *)x),
                     .b = SK_ISA(turn3)(SK_ISA(load3)((const sk_wide *)(const void *)(x + to_b)), shift),
                     .other_a = SK_ISA(load3)((const sk_wide *)(const void *)v),
                     .other_b = SK_ISA(turn3)(SK_ISA(load3)((const sk_wide *)(const void *)(v + to_b)), shift)};
        size_t lane = sweep->first_lane + at;
        SK_ISA(set_values)(&p, sweep, constants, lane, shift || sweep->batch->special[lane / SK_LANES], false);
        SK_ISA(pair)(&p, constants, SK_PAIR_FORCE);
        if (ends.a) SK_ISA(add3)((sk_wide *)(void *)f, p.da);
        if (ends.b) SK_ISA(take3)((sk_wide *)(void *)(f + to_b), SK_ISA(turn3)(p.db, -shift));
    }
}

/* The same over the end of a strip, as a function of its own. */
static __attribute__((noinline)) void SK_ISA(pull_turned)(sk_run *run, const sk_row *row, const sk_sweep *sweep,
                                                          const sk_pair_constants *constants, size_t r, sk_span span,
                                                          SK_ISA(pull_ends) ends) {
    SK_ISA(pull_span)(run, row, sweep, constants, r, span, span.shift, ends);
}

/* All directions of a batch at once, for the forces on strip rows [begin, end): what they get from rows before
 * is worked out again rather than waited for, so that every cut of the rows gives the same sums. */
static void SK_ISA(force_strips)(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    const sk_sweep *sweeps = row->rule;
    sk_pair_constants constants = sk_pair_prepare(sweeps->batch, row);
    size_t reach = row->walk.reach;
    for (size_t r = begin > reach ? begin - reach : 0; r < end; r++)
        for (size_t d = 0; d < sweeps->together; d++) {
            const sk_sweep *sweep = &sweeps[d];
            size_t partner = r + (size_t)sweep->row_step;
            SK_ISA(pull_ends) ends = {r >= begin, partner >= begin && partner < end};
            if (partner >= sweep->walk.rows || (!ends.a && !ends.b)) continue;
            for (size_t i = 0; i < sweep->span_count; i++) {
                sk_span at = sweep->span[i];
                if (!at.shift) SK_ISA(pull_span)(run, row, sweep, &constants, r, at, 0, ends);
                else SK_ISA(pull_turned)(run, row, sweep, &constants, r, at, ends);
            }
        }
}

/* ---- groups ---- */

/* Sixteen particles of a vector, some of which are in packed blocks. */
SK_INLINE sk_wide4 SK_ISA(gather_any)(const sk_vec4 *vector, size_t packed, const uint32_t *slot) {
    sk_wide4 out;
    for (int l = 0; l < SK_LANES; l++) {
        sk_vec4 q = sk_load(vector, packed, slot[l]);
        out.x[l] = q.x, out.y[l] = q.y, out.z[l] = q.z, out.w[l] = q.w;
    }
    return out;
}

SK_INLINE sk_wide4 SK_ISA(gather)(const sk_vec4 *vector, size_t packed, const uint32_t *slot) {
    return packed ? SK_ISA(gather_any)(vector, packed, slot) : SK_ISA(sk_gather)(vector, slot);
}

/* Adds to sixteen different particles (sign 1) or takes from them (-1); `old` is what was gathered. */
SK_INLINE void SK_ISA(scatter_sum)(sk_vec4 *vector, size_t packed, const uint32_t *slot, sk_wide4 old, int sign,
                                   sk_wide3 d) {
    if (sign > 0) old.x += d.x, old.y += d.y, old.z += d.z;
    else old.x -= d.x, old.y -= d.y, old.z -= d.z;
    if (!packed) {
        SK_ISA(sk_scatter)(vector, slot, old);
        return;
    }
    for (int l = 0; l < SK_LANES; l++) sk_store_at(vector, packed, slot[l], sk_v3(old.x[l], old.y[l], old.z[l]));
}

SK_INLINE void SK_ISA(meet_group)(sk_run *run, const sk_row *row, const sk_sweep *sweep,
                                  const sk_pair_constants *constants, size_t group, size_t packed, sk_pair_mode mode) {
    const uint32_t *sa = sweep->slots + group * 2 * SK_LANES, *sb = sa + SK_LANES;
    sk_vec4 *x = run->vector[SK_X], *other = run->vector[mode == SK_PAIR_PROJECT_DAMPED ? SK_X0 : SK_V];
    sk_wide4 a = SK_ISA(gather)(x, packed, sa), b = SK_ISA(gather)(x, packed, sb), oa = {0}, ob = {0};
    sk_pair p = {.a = {a.x, a.y, a.z}, .b = {b.x, b.y, b.z}, .wa = a.w, .wb = b.w};
    if (mode != SK_PAIR_PROJECT && mode != SK_PAIR_LIMIT) {
        oa = SK_ISA(gather)(other, packed, sa), ob = SK_ISA(gather)(other, packed, sb);
        p.other_a = (sk_wide3){oa.x, oa.y, oa.z}, p.other_b = (sk_wide3){ob.x, ob.y, ob.z};
    }
    size_t lane = sweep->first_lane + group * SK_LANES;
    SK_ISA(set_values)(&p, sweep, constants, lane, true, mode == SK_PAIR_PROJECT_DAMPED);
    SK_ISA(pair)(&p, constants, mode);
    if (mode == SK_PAIR_FORCE) {
        sk_vec4 *f = run->vector[row->dst];
        SK_ISA(scatter_sum)(f, packed, sa, SK_ISA(gather)(f, packed, sa), 1, p.da);
        SK_ISA(scatter_sum)(f, packed, sb, SK_ISA(gather)(f, packed, sb), -1, p.db);
        return;
    }
    SK_ISA(scatter_sum)(x, packed, sa, a, 1, p.da);
    SK_ISA(scatter_sum)(x, packed, sb, b, -1, p.db);
    if (mode == SK_PAIR_PROJECT_DAMPED) *(sk_wide *)(void *)(sweep->batch->lane_multiplier + lane) = p.multiplier;
    if (mode == SK_PAIR_LIMIT_MOVING) {
        SK_ISA(scatter_sum)(other, packed, sa, oa, 1, p.dv_a);
        SK_ISA(scatter_sum)(other, packed, sb, ob, -1, p.dv_b);
    }
}

/* Groups [begin, end), or those of slabs [begin, end). Groups with a particle in strips are rare: they are reached one
 * by one. */
SK_INLINE void SK_ISA(sweep_groups)(sk_run *run, const sk_row *row, size_t begin, size_t end, sk_pair_mode mode) {
    const sk_sweep *sweep = row->rule;
    sk_pair_constants constants = sk_pair_prepare(sweep->batch, row);
    if (sweep->slab_start) begin = sweep->slab_start[begin], end = sweep->slab_start[end];
    for (size_t g = begin; g < end; g++) {
        const uint32_t *slots = sweep->slots + g * 2 * SK_LANES;
        bool strips = false;
        for (int i = 0; i < 2 * SK_LANES && row->packed; i++) strips |= slots[i] < row->packed;
        SK_ISA(meet_group)(run, row, sweep, &constants, g, strips ? row->packed : 0, mode);
    }
}

#define SK_GROUP_WALK(name, mode)                                                                  \
    static void SK_ISA(name##_groups)(sk_run * run, const sk_row *row, size_t begin, size_t end) { \
        SK_ISA(sweep_groups)(run, row, begin, end, mode);                                          \
    }
#define SK_PAIR_WALKS(name, mode)                                                                                   \
    static __attribute__((noinline)) void SK_ISA(name##_turned)(sk_run * run, const sk_sweep *sweep,                \
                                                                const sk_pair_constants *constants, size_t begin,   \
                                                                size_t end, size_t first, size_t last, int shift) { \
        SK_ISA(meet_span)(run, sweep, constants, begin, end, first, last, shift, mode);                             \
    }                                                                                                               \
    static void SK_ISA(name##_strips)(sk_run * run, const sk_row *row, size_t begin, size_t end) {                  \
        SK_ISA(sweep_strips)(run, row, begin, end, mode, SK_ISA(name##_turned));                                    \
    }                                                                                                               \
    SK_GROUP_WALK(name, mode)
SK_GROUP_WALK(force, SK_PAIR_FORCE)
SK_PAIR_WALKS(project, SK_PAIR_PROJECT)
SK_PAIR_WALKS(project_damped, SK_PAIR_PROJECT_DAMPED)
SK_PAIR_WALKS(limit, SK_PAIR_LIMIT)
SK_PAIR_WALKS(limit_moving, SK_PAIR_LIMIT_MOVING)
#undef SK_PAIR_WALKS
#undef SK_GROUP_WALK
