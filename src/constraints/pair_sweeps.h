/* The walks of constraints between two particles, once for each instruction set (no include guard).
 *
 * The kind that includes this has defined SK_ISA(pair), its arithmetic on sixteen elements at once: it
 * reads a and b and writes da and db (and, when moving, dv_a and dv_b). How particles come in and go out
 * is here alone, so that the arithmetic does not know the layout. */

/* Reads what a mode needs of sixteen elements besides positions. */
SK_INLINE void SK_ISA(set_values)(sk_pair *p, const sk_sweep *sweep, size_t lane, bool special, bool multiplier) {
    const sk_batch *batch = sweep->batch;
    if (special) {
        p->rest = *(const sk_wide *)(const void *)(batch->lane_rest + lane);
        p->stiffness = *(const sk_wide *)(const void *)(batch->lane_stiffness + lane);
        p->compliance = *(const sk_wide *)(const void *)(batch->lane_compliance + lane);
    } else {
        p->rest = SK_ISA(sk_splat)(sweep->rest);
        p->stiffness = SK_ISA(sk_splat)(sweep->stiffness);
        p->compliance = SK_ISA(sk_splat)(sweep->compliance);
    }
    if (multiplier) p->multiplier = *(const sk_wide *)(const void *)(batch->lane_multiplier + lane);
}

SK_INLINE sk_wide3 SK_ISA(load3)(const sk_wide *block) {
    return (sk_wide3){block[0], block[1], block[2]};
}
SK_INLINE void SK_ISA(add3)(sk_wide *block, sk_wide3 d) {
    block[0] += d.x, block[1] += d.y, block[2] += d.z;
}
/* Turns the lanes of a block at a strip's end: shift 1 takes each lane's next one, -1 the one before. */
SK_INLINE sk_wide SK_ISA(shift1)(sk_wide a, int shift) {
    return shift > 0 ? SK_ISA(sk_rotate_up)(a) : shift < 0 ? SK_ISA(sk_rotate_down)(a) : a;
}
SK_INLINE sk_wide3 SK_ISA(shift3)(sk_wide3 a, int shift) {
    return (sk_wide3){SK_ISA(shift1)(a.x, shift), SK_ISA(shift1)(a.y, shift), SK_ISA(shift1)(a.z, shift)};
}

/* Block a meets block b. `mode` is a constant where this is inlined. */
SK_INLINE void SK_ISA(meet_blocks)(sk_run *run, const sk_row *row, const sk_sweep *sweep,
                                   const sk_pair_constants *constants, size_t lane, size_t slot_a, size_t slot_b,
                                   int shift, sk_pair_mode mode) {
    bool special = shift || sweep->batch->special[lane / SK_LANES];
    sk_wide *xa = (sk_wide *)(void *)(run->vector[SK_X] + slot_a),
            *xb = (sk_wide *)(void *)(run->vector[SK_X] + slot_b);
    sk_pair p = {.a = SK_ISA(load3)(xa),
                 .b = SK_ISA(shift3)(SK_ISA(load3)(xb), shift),
                 .wa = xa[3],
                 .wb = SK_ISA(shift1)(xb[3], shift)};
    sk_wide *other_a = NULL, *other_b = NULL;
    if (mode != SK_PAIR_PROJECT && mode != SK_PAIR_LIMIT) {
        sk_vec4 *other = run->vector[mode == SK_PAIR_PROJECT_DAMPED ? SK_X0 : SK_V];
        other_a = (sk_wide *)(void *)(other + slot_a), other_b = (sk_wide *)(void *)(other + slot_b);
        p.other_a = SK_ISA(load3)(other_a);
        p.other_b = SK_ISA(shift3)(SK_ISA(load3)(other_b), shift);
    }
    SK_ISA(set_values)(&p, sweep, lane, special, mode == SK_PAIR_PROJECT_DAMPED);
    SK_ISA(pair)(&p, constants, mode);
    if (mode == SK_PAIR_FORCE) {
        sk_vec4 *f = run->vector[row->dst];
        SK_ISA(add3)((sk_wide *)(void *)(f + slot_a), p.da);
        SK_ISA(add3)((sk_wide *)(void *)(f + slot_b), SK_ISA(shift3)(p.db, -shift));
    } else if (shift) {
        SK_ISA(add3)(xa, p.da);
        SK_ISA(add3)(xb, SK_ISA(shift3)(p.db, -shift));
    } else {
        // from what was loaded: reading again would wait for the stores
        xa[0] = p.a.x + p.da.x, xa[1] = p.a.y + p.da.y, xa[2] = p.a.z + p.da.z;
        xb[0] = p.b.x + p.db.x, xb[1] = p.b.y + p.db.y, xb[2] = p.b.z + p.db.z;
    }
    if (mode == SK_PAIR_PROJECT_DAMPED) *(sk_wide *)(void *)(sweep->batch->lane_multiplier + lane) = p.multiplier;
    if (mode == SK_PAIR_LIMIT_MOVING) {
        SK_ISA(add3)(other_a, p.dv_a);
        SK_ISA(add3)(other_b, SK_ISA(shift3)(p.dv_b, -shift));
    }
}

/* Over the end of a strip; a function of its own for each mode, since it is rare and would be inlined often. */
typedef void SK_ISA(meet_end)(sk_run *run, const sk_row *row, const sk_sweep *sweep, const sk_pair_constants *constants,
                              size_t lane, size_t slot_a, size_t slot_b, int shift);

/* Strip rows [begin, end). Along a row each block waits for the one before it, so four rows go side by
 * side where they share no particle; the answer is the same. */
SK_INLINE void SK_ISA(sweep_strips)(sk_run *run, const sk_row *row, size_t begin, size_t end, sk_pair_mode mode,
                                    SK_ISA(meet_end) * meet_end) {
    const sk_sweep *sweep = row->rule;
    sk_pair_constants constants = sk_pair_prepare(sweep->batch, row);
    size_t width = sweep->walk.width, side_by_side = sweep->row_step == 0 ? 4 : 1;
    for (size_t r = begin; r < end; r += side_by_side) {
        size_t stop = r + side_by_side < end ? r + side_by_side : end;
        for (size_t k = 0; k < width; k++) {
            int32_t partner = (int32_t)k + sweep->column_step;
            int shift = partner < 0 ? -1 : partner >= (int32_t)width ? 1 : 0;
            size_t place = (size_t)(partner - shift * (int32_t)width);
            for (size_t i = r; i < stop; i++) {
                size_t block = i * width + k, lane = sweep->first_lane + block * SK_LANES;
                size_t slot_a = sweep->walk.first_slot + block * SK_LANES;
                size_t slot_b = sweep->walk.first_slot + ((i + (size_t)sweep->row_step) * width + place) * SK_LANES;
                if (__builtin_expect(shift == 0, 1))
                    SK_ISA(meet_blocks)(run, row, sweep, &constants, lane, slot_a, slot_b, 0, mode);
                else meet_end(run, row, sweep, &constants, lane, slot_a, slot_b, shift);
            }
        }
    }
}

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

/* Adds to sixteen different particles; `old` is what was gathered. */
SK_INLINE void SK_ISA(scatter_sum)(sk_vec4 *vector, size_t packed, const uint32_t *slot, sk_wide4 old, sk_wide3 d) {
    old.x += d.x, old.y += d.y, old.z += d.z;
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
    SK_ISA(set_values)(&p, sweep, lane, true, mode == SK_PAIR_PROJECT_DAMPED);
    SK_ISA(pair)(&p, constants, mode);
    if (mode == SK_PAIR_FORCE) {
        sk_vec4 *f = run->vector[row->dst];
        SK_ISA(scatter_sum)(f, packed, sa, SK_ISA(gather)(f, packed, sa), p.da);
        SK_ISA(scatter_sum)(f, packed, sb, SK_ISA(gather)(f, packed, sb), p.db);
        return;
    }
    SK_ISA(scatter_sum)(x, packed, sa, a, p.da);
    SK_ISA(scatter_sum)(x, packed, sb, b, p.db);
    if (mode == SK_PAIR_PROJECT_DAMPED) *(sk_wide *)(void *)(sweep->batch->lane_multiplier + lane) = p.multiplier;
    if (mode == SK_PAIR_LIMIT_MOVING) {
        SK_ISA(scatter_sum)(other, packed, sa, oa, p.dv_a);
        SK_ISA(scatter_sum)(other, packed, sb, ob, p.dv_b);
    }
}

/* Groups [begin, end). Groups with a particle in strips are rare: they are reached one by one. */
SK_INLINE void SK_ISA(sweep_groups)(sk_run *run, const sk_row *row, size_t begin, size_t end, sk_pair_mode mode) {
    const sk_sweep *sweep = row->rule;
    sk_pair_constants constants = sk_pair_prepare(sweep->batch, row);
    for (size_t g = begin; g < end; g++) {
        const uint32_t *slots = sweep->slots + g * 2 * SK_LANES;
        bool strips = false;
        for (int i = 0; i < 2 * SK_LANES && row->packed; i++) strips |= slots[i] < row->packed;
        SK_ISA(meet_group)(run, row, sweep, &constants, g, strips ? row->packed : 0, mode);
    }
}

#define SK_PAIR_WALKS(name, mode)                                                                                    \
    static __attribute__((noinline)) void SK_ISA(name##_end)(sk_run * run, const sk_row *row, const sk_sweep *sweep, \
                                                             const sk_pair_constants *constants, size_t lane,        \
                                                             size_t slot_a, size_t slot_b, int shift) {              \
        SK_ISA(meet_blocks)(run, row, sweep, constants, lane, slot_a, slot_b, shift, mode);                          \
    }                                                                                                                \
    static void SK_ISA(name##_strips)(sk_run * run, const sk_row *row, size_t begin, size_t end) {                   \
        SK_ISA(sweep_strips)(run, row, begin, end, mode, SK_ISA(name##_end));                                        \
    }                                                                                                                \
    static void SK_ISA(name##_groups)(sk_run * run, const sk_row *row, size_t begin, size_t end) {                   \
        SK_ISA(sweep_groups)(run, row, begin, end, mode);                                                            \
    }
SK_PAIR_WALKS(force, SK_PAIR_FORCE)
SK_PAIR_WALKS(project, SK_PAIR_PROJECT)
SK_PAIR_WALKS(project_damped, SK_PAIR_PROJECT_DAMPED)
SK_PAIR_WALKS(limit, SK_PAIR_LIMIT)
SK_PAIR_WALKS(limit_moving, SK_PAIR_LIMIT_MOVING)
#undef SK_PAIR_WALKS
