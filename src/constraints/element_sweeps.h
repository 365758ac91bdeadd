/* The kernels that walk over a kind's elements, once for each instruction set, after element_arithmetic.h, whose
 * work_out() they call. Loading and storing particles is here and in <skein/inside/group_walk.h> alone, so that the
 * arithmetic is independent of the layout. SK_WITH_STRIPS asks for walks along strips, SK_WITH_LIMITS for limits. */

#define WORK_OUT(e, c, mode, data) work_out(e, c, mode)
#include <skein/inside/group_walk.h>

/* A walk that serves two modes. Where bytes are dear (SK_SMALL: a page waits for them) it is there once and is told the
 * mode, which costs up to an eighth of its time; elsewhere the mode is a constant where it is inlined. So it is
 * for projections of pairs that keep their multipliers everywhere: they are short, and most elements are pairs; but not for those
 * that only pull, which few cloths have. */
#ifdef SK_SMALL
#define SK_TOLD static __attribute__((noinline))
#else
#define SK_TOLD SK_INLINE
#endif
#if defined SK_SMALL && SK_ARITY == 2 && !defined SK_ONE_SIDED
#define SK_TOLD_KEPT SK_INLINE
#else
#define SK_TOLD_KEPT SK_TOLD
#endif

/* A part of a packed block. */
SK_INLINE sk_wide3 load3(const sk_wide *part) {
    return (sk_wide3){part[0], part[SK_PARTS], part[2 * SK_PARTS]};
}
SK_INLINE void store3(sk_wide *part, sk_wide3 a) {
    part[0] = a.x, part[SK_PARTS] = a.y, part[2 * SK_PARTS] = a.z;
}
/* Reads what a mode needs of a part of sixteen elements besides positions. */
SK_INLINE void set_values(sk_element *e, const sk_sweep *sweep, const sk_element_constants *constants, size_t lane,
                          bool special, bool multiplier) {
    const sk_batch *batch = sweep->batch;
    if (special) {
        for (int r = 0; r < SK_RESTS; r++)
            e->rest[r] = *(const sk_wide *)(const void *)(batch->lane_rest + (size_t)r * batch->lane_count + lane);
        e->stiffness = *(const sk_wide *)(const void *)(batch->lane_stiffness + lane);
        e->soft = *(const sk_wide *)(const void *)(batch->lane_compliance + lane) * constants->per_step;
    } else {
        for (int r = 0; r < SK_RESTS; r++) e->rest[r] = sk_splat(sweep->rest[r]);
        e->stiffness = sk_splat(sweep->stiffness);
        e->soft = sk_splat(sweep->compliance * constants->per_step);
    }
    if (multiplier) e->multiplier = *(const sk_wide *)(const void *)(batch->lane_multiplier + lane);
}

#ifdef SK_WITH_STRIPS
/* Elements that lead over the end of a strip need their blocks' lanes rotated by `shift`: a rotated copy of `rows`
 * rows, and x, y and z rotated back. */
SK_INLINE void rotate(sk_wide *to, const sk_wide *block, int rows, int shift) {
    for (int r = 0; r < rows * SK_PARTS; r += SK_PARTS) sk_rotate_lanes(to + r, block + r, shift);
}
SK_INLINE void turn_back(sk_wide *block, const sk_wide *from, int shift) {
    rotate(block, from, 3, -shift);
}

/* The offsets of the blocks of an element's particles from the block of its place, in slots. */
typedef struct offsets {
    ptrdiff_t slots[SK_ARITY];
    int shift[SK_ARITY];
    const sk_watch *watch; /* of what a limit walks over; else NULL */
} offsets;

/* Whether the block of particle i must be rotated. The first of a pair never is, for its place is the pair's: the
 * compiler can use that. */
SK_INLINE bool turns(const offsets *o, int i, bool turned) {
    return turned && (SK_ARITY == 2 ? i == 1 : o->shift[i] != 0);
}

SK_INLINE offsets offsets_of(const sk_sweep *sweep, const sk_span *span, const sk_watch *watch, bool turned) {
    offsets o;
    o.watch = watch;
    SK_EACH_PARTICLE (i) {
        o.shift[i] = turned ? span->shift[i] : 0;
        o.slots[i] = ((ptrdiff_t)sweep->row_step[i] * (ptrdiff_t)sweep->walk.width + sweep->column_step[i] -
                      (ptrdiff_t)o.shift[i] * (ptrdiff_t)sweep->walk.width) *
                     SK_LANES;
    }
    return o;
}

/* ---- strips: projections and limits ---- */

/* Computes a part of sixteen elements; x and other belong to their particles. False if nothing moves. */
SK_INLINE bool meet_part(const sk_sweep *sweep, const sk_element_constants *constants, size_t lane, bool special,
                         sk_element_mode mode, sk_wide *const *x, sk_wide *const *other) {
    sk_element e;
    SK_EACH_PARTICLE (i) {
        e.x[i] = load3(x[i]);
        e.w[i] = x[i][3 * SK_PARTS];
        if (!positions_are_enough(mode)) e.other[i] = load3(other[i]);
    }
    set_values(&e, sweep, constants, lane, special, keeps_multiplier(mode));
    if (!work_out(&e, constants, mode)) return false;
    // from the loaded values: reading them again would wait for the stores
    SK_EACH_PARTICLE (i) {
        store3(x[i], put(&e, i, e.x[i], e.scale, mode));
        if (mode == SK_MODE_LIMIT_MOVING) store3(other[i], put(&e, i, e.other[i], e.velocity_scale, mode));
    }
    if (keeps_multiplier(mode)) *(sk_wide *)(void *)(sweep->batch->lane_multiplier + lane) = e.multiplier;
    return true;
}

/* Whether sixteen elements are as when they were found within their bound. */
SK_INLINE bool is_found(uint64_t found, size_t slot, const offsets *o) {
    bool holds = true;
    SK_EACH_PARTICLE (i) holds &= sk_watch_holds(o->watch, found, slot + (size_t)o->slots[i]);
    return holds;
}

/* Computes sixteen elements. `mode` is a constant where this is inlined, and so is `turned`, whether lanes of some
 * block are rotated. */
SK_INLINE void meet_blocks(sk_run *run, const sk_sweep *sweep, const sk_element_constants *constants, size_t lane,
                           size_t slot, const offsets *o, bool turned, sk_element_mode mode) {
    uint64_t *found = sweep->batch->found + lane / SK_LANES;
    const sk_watch *watch = o->watch;
    const bool watches = SK_WATCHES && mode == SK_MODE_LIMIT && watch->moved;
    if (watches && is_found(*found, slot, o)) return;
    bool special = turned || sweep->batch->special[lane / SK_LANES];
    bool reads_other = !positions_are_enough(mode);
    sk_vec4 *from = run->vector[mode == SK_MODE_PROJECT_DAMPED ? SK_X0 : SK_V];
    sk_wide *x[SK_ARITY], *other[SK_ARITY] = {NULL}, *at[SK_ARITY], *other_at[SK_ARITY] = {NULL};
    sk_wide copy[SK_ARITY][4 * SK_PARTS], other_copy[SK_ARITY][3 * SK_PARTS];
    SK_EACH_PARTICLE (i) {
        size_t block = slot + (size_t)o->slots[i];
        at[i] = x[i] = (sk_wide *)(void *)(run->vector[SK_X] + block);
        if (turns(o, i, turned)) rotate(at[i] = copy[i], x[i], 4, o->shift[i]);
        if (!reads_other) continue;
        other_at[i] = other[i] = (sk_wide *)(void *)(from + block);
        if (turns(o, i, turned)) rotate(other_at[i] = other_copy[i], other[i], 3, o->shift[i]);
    }
    bool moves = false;
    for (size_t p = 0; p < SK_PARTS; p++) {
        sk_wide *part[SK_ARITY], *other_part[SK_ARITY] = {NULL};
        SK_EACH_PARTICLE (i) {
            part[i] = at[i] + p;
            if (reads_other) other_part[i] = other_at[i] + p;
        }
        moves |= meet_part(sweep, constants, lane + p * SK_PART, special, mode, part, other_part);
    }
    if (watches) *found = moves ? 0 : watch->now;
    if (!moves) return;
    SK_EACH_PARTICLE (i) {
        if (watches) sk_watch_move(watch, slot + (size_t)o->slots[i]);
        if (!turns(o, i, turned)) continue;
        turn_back(x[i], at[i], o->shift[i]);
        if (mode == SK_MODE_LIMIT_MOVING) turn_back(other[i], other_at[i], o->shift[i]);
    }
}

/* The rows, or the blocks in rows, of a half: every one or every second, and whether the odd ones. */
typedef struct stride {
    size_t row, block;
    bool odd;
} stride;

SK_INLINE stride stride_of(const sk_sweep *sweep, sk_half half) {
    bool by_rows = sk_sweep_halves_rows(sweep);
    return (stride){half && by_rows ? 2 : 1, half && !by_rows ? 2 : 1, half == SK_ODD_HALF};
}
/* The first row or block of the half from `from` on. */
SK_INLINE size_t first_of(size_t from, size_t every, bool odd) {
    return every == 2 ? from + (from % 2 != odd) : from;
}

/* The blocks of a span in strip rows [begin, end). Along a row each block waits for the one before it, so rows that
 * share no particle are interleaved. */
SK_INLINE void meet_span(sk_run *run, const sk_sweep *sweep, const sk_element_constants *constants, size_t begin,
                         size_t end, const sk_span *span, const offsets *o, sk_half half, bool turned,
                         sk_element_mode mode) {
    size_t line = sweep->walk.width * SK_LANES, first_slot = sweep->walk.first_slot;
    stride n = stride_of(sweep, half);
    size_t first = first_of(span->first, n.block, n.odd), step = n.block * SK_LANES;
    if (sweep->walk.reach) {
        for (size_t at = begin * line + first * SK_LANES; at < begin * line + span->last * SK_LANES; at += step)
            meet_blocks(run, sweep, constants, sweep->first_lane + at, first_slot + at, o, turned, mode);
        return;
    }
    size_t first_row = first_of(begin, n.row, n.odd);
    for (size_t k = first; k < span->last; k += n.block)
        for (size_t at = first_row * line + k * SK_LANES; at < end * line; at += n.row * line)
            meet_blocks(run, sweep, constants, sweep->first_lane + at, first_slot + at, o, turned, mode);
}

/* The same for a coarse grid, which has lanes of its own. */
SK_INLINE void meet_coarse(sk_run *run, const sk_sweep *sweep, const sk_element_constants *constants, size_t begin,
                           size_t end, const sk_span *span, const offsets *o, bool turned, sk_element_mode mode) {
    const sk_coarse_grid *grid = &sweep->batch->coarse->grid;
    size_t width = sweep->walk.width, count = sk_coarse_columns(grid, width);
    size_t row = begin > grid->row_first ? (begin - grid->row_first + grid->row_step - 1) / grid->row_step : 0;
    for (size_t b = 0; b < count; b++) {
        size_t k = grid->first + b * grid->step;
        if (k < span->first || k >= span->last) continue;
        for (size_t r = row, at; (at = grid->row_first + r * grid->row_step) < end; r++)
            meet_blocks(run, sweep, constants, sweep->first_lane + (r * count + b) * SK_LANES,
                        sweep->walk.first_slot + (at * width + k) * SK_LANES, o, turned, mode);
    }
}

typedef void span_walk(sk_run *run, const sk_sweep *sweep, const sk_element_constants *constants, size_t begin,
                       size_t end, const sk_span *span, const offsets *o, sk_half half);

/* Strip rows [begin, end), one by one unless they are interleaved. `turned` walks the spans that lead over a strip's
 * end: a function of its own, since these are few and inlining it everywhere would be slow to compile. */
SK_INLINE void sweep_strips(sk_run *run, const sk_op *op, size_t begin, size_t end, sk_element_mode mode,
                            span_walk *turned) {
    const sk_sweep *sweep = op->rule;
    sk_element_constants constants = sk_element_prepare(sweep->batch, op);
    const sk_watch watch = sk_watch_of(run, op);
    offsets o[SK_MOST_ARITY];
    for (size_t i = 0; i < sweep->span_count; i++)
        o[i] = offsets_of(sweep, &sweep->span[i], SK_WATCHES ? &watch : NULL, sweep->span[i].turned);
    size_t side_by_side = sweep->walk.reach == 0 ? SK_ROWS_SIDE_BY_SIDE * stride_of(sweep, op->half).row : 1;
    const sk_coarse *coarse = mode == SK_MODE_LIMIT ? sweep->batch->coarse : NULL;
    if (coarse && sweep->walk.reach == 0) side_by_side = SK_ROWS_SIDE_BY_SIDE * coarse->grid.row_step;
    for (size_t r = begin; r < end; r += side_by_side) {
        size_t stop = r + side_by_side < end ? r + side_by_side : end;
        for (size_t i = 0; i < sweep->span_count; i++) {
            const sk_span *at = &sweep->span[i];
            if (coarse && !at->turned) meet_coarse(run, sweep, &constants, r, stop, at, &o[i], false, mode);
            else if (!at->turned) meet_span(run, sweep, &constants, r, stop, at, &o[i], op->half, false, mode);
            else if (mode == SK_MODE_PROJECT && SK_ARITY == 2)
                meet_span(run, sweep, &constants, r, stop, at, &o[i], op->half, true, mode);
            else turned(run, sweep, &constants, r, stop, at, &o[i], op->half);
        }
    }
}

#endif
#if defined SK_WITH_STRIPS && !defined SK_ONLY_BOUNDS
/* ---- strips: forces, and products with a direction ---- */

/* Adds the forces of a span in strip row r to those of its particles that lie in the requested rows (`gets`). */
SK_INLINE void pull_span(sk_run *run, const sk_op *op, const sk_sweep *sweep, const sk_element_constants *constants,
                         size_t r, const sk_span *span, bool turned, const bool *gets, sk_element_mode mode) {
    size_t line = sweep->walk.width * SK_LANES;
    offsets o = offsets_of(sweep, span, NULL, turned);
    for (size_t at = r * line + span->first * SK_LANES; at < r * line + span->last * SK_LANES; at += SK_LANES) {
        size_t lane = sweep->first_lane + at, slot = sweep->walk.first_slot + at;
        bool special = turned || sweep->batch->special[lane / SK_LANES];
        sk_wide *f[SK_ARITY], copy[SK_ARITY][2][3 * SK_PARTS], sum[SK_ARITY][3 * SK_PARTS] = {{{0}}};
        const sk_wide *x[SK_ARITY], *v[SK_ARITY];
        SK_EACH_PARTICLE (i) {
            x[i] = (const sk_wide *)(const void *)(run->vector[SK_X] + slot + o.slots[i]);
            v[i] = (const sk_wide *)(const void *)(run->vector[op->source[1]] + slot + o.slots[i]);
            f[i] = (sk_wide *)(void *)(run->vector[op->dst] + slot + o.slots[i]);
            if (!turned) continue;
            rotate(copy[i][0], x[i], 3, o.shift[i]);
            rotate(copy[i][1], v[i], 3, o.shift[i]);
            if (gets[i]) rotate(sum[i], f[i], 3, o.shift[i]); // others may belong to another thread
            x[i] = copy[i][0], v[i] = copy[i][1];
        }
        for (size_t p = 0; p < SK_PARTS; p++) {
            sk_element e;
            SK_EACH_PARTICLE (i) e.x[i] = load3(x[i] + p), e.other[i] = load3(v[i] + p);
            set_values(&e, sweep, constants, lane + p * SK_PART, special, false);
            work_out(&e, constants, mode);
            SK_EACH_PARTICLE (i) {
                sk_wide *to = (turned ? sum[i] : f[i]) + p;
                if (gets[i]) store3(to, with_sign(&e, i, load3(to), given(&e, i, mode)));
            }
        }
        SK_EACH_PARTICLE (i)
            if (turned && gets[i]) turn_back(f[i], sum[i], o.shift[i]);
    }
}

typedef void pull_walk(sk_run *run, const sk_op *op, const sk_sweep *sweep, const sk_element_constants *constants,
                       size_t r, const sk_span *span, const bool *gets);

/* All directions of a batch at once, for the sums on strip rows [begin, end). The contributions of earlier rows are
 * computed again rather than waited for, so that every division of the rows gives the same sums. */
SK_INLINE void pull_strips(sk_run *run, const sk_op *op, size_t begin, size_t end, sk_element_mode mode,
                           pull_walk *turned) {
    const sk_sweep *sweeps = op->rule;
    sk_element_constants constants = sk_element_prepare(sweeps->batch, op);
    size_t reach = op->walk.reach;
    for (size_t r = begin > reach ? begin - reach : 0; r < end; r++)
        for (size_t d = 0; d < sweeps->together; d++) {
            const sk_sweep *sweep = &sweeps[d];
            bool gets[SK_ARITY], any = false;
            if (r + sweep->walk.reach >= sweep->walk.rows) continue;
            SK_EACH_PARTICLE (i) {
                size_t at = r + (size_t)sweep->row_step[i];
                any |= gets[i] = at >= begin && at < end;
            }
            for (size_t i = 0; i < sweep->span_count && any; i++) {
                const sk_span *at = &sweep->span[i];
                if (!at->turned) pull_span(run, op, sweep, &constants, r, at, false, gets, mode);
                else turned(run, op, sweep, &constants, r, at, gets);
            }
        }
}

SK_INLINE sk_element_mode sum_mode(bool applies) {
    return applies ? SK_MODE_APPLY : SK_MODE_FORCE;
}
SK_TOLD void sum_turned(sk_run *run, const sk_op *op, const sk_sweep *sweep, const sk_element_constants *constants,
                        size_t r, const sk_span *span, const bool *gets, bool applies) {
    pull_span(run, op, sweep, constants, r, span, true, gets, sum_mode(applies));
}
SK_TOLD void sum_strips(sk_run *run, const sk_op *op, size_t begin, size_t end, bool applies, pull_walk *turned) {
    pull_strips(run, op, begin, end, sum_mode(applies), turned);
}

/* Defines the kernel, and its function for spans over the end of a strip. */
#define SK_PULLS(name, applies)                                                                              \
    static __attribute__((noinline)) void name##_turned(sk_run *run, const sk_op *op, const sk_sweep *sweep, \
                                                        const sk_element_constants *constants, size_t r,     \
                                                        const sk_span *span, const bool *gets) {             \
        sum_turned(run, op, sweep, constants, r, span, gets, applies);                                       \
    }                                                                                                        \
    void SK_KERNEL(name##_strips)(sk_run * run, const sk_op *op, size_t begin, size_t end) {                 \
        sum_strips(run, op, begin, end, applies, name##_turned);                                             \
    }
SK_PULLS(force, false)
SK_PULLS(apply, true)
#undef SK_PULLS
#endif

/* ---- groups ---- */

#if defined SK_WITH_LIMITS && !defined SK_SMALL
/* Says who moves of a part: of groups the lanes that do, for the others are anywhere. */
SK_INLINE void tell_moved(const sk_watch *watch, const group_part *p) {
    const uint32_t bits = sk_more_bits(sk_select(p->e.over, sk_splat(1), sk_splat(0)), sk_splat(0));
    SK_EACH_PARTICLE (i)
        for (size_t l = 0; l < SK_PART; l++)
            if (bits >> l & 1) sk_watch_move(watch, p->slots[(size_t)i * SK_LANES + l]);
}

/* Limits groups, but for those that are as when they were found within their bound. */
static void limit_watched(const skein_groups *g, const sk_element_constants *constants, const sk_watch *watch,
                          uint64_t *found) {
    for (size_t group = 0; group < g->count; group++) {
        const uint32_t *slots = g->slots + group * SK_ARITY * SK_LANES;
        uint64_t last = 0;
        for (size_t i = 0; i < SK_ARITY * SK_LANES; i++)
            last = watch->moved[slots[i] / 16] > last ? watch->moved[slots[i] / 16] : last;
        if (found[group] > watch->since && last < found[group]) continue;
        bool moves = false;
        for (size_t part = 0; part < SK_LANES; part += SK_PART) {
            group_part p;
            take_part(&p, g, group, part, g->packed, SK_MODE_LIMIT);
            take_values(&p, g, constants, SK_MODE_LIMIT);
            if (!work_out(&p.e, constants, SK_MODE_LIMIT)) continue;
            put_down(&p, g, g->packed, SK_MODE_LIMIT);
            tell_moved(watch, &p);
            moves = true;
        }
        found[group] = moves ? 0 : watch->now;
    }
}
#endif

SK_INLINE void sweep_groups(sk_run *run, const sk_op *op, size_t begin, size_t end, sk_element_mode mode) {
    const sk_sweep *sweep = op->rule;
    sk_element_constants constants = sk_element_prepare(sweep->batch, op);
    const skein_groups groups = sk_groups_of(run, op, begin, end, mode);
#if defined SK_WITH_LIMITS && !defined SK_SMALL
    const sk_watch watch = sk_watch_of(run, op);
    if (mode == SK_MODE_LIMIT && watch.moved) {
        const size_t first = sweep->slab_start ? sweep->slab_start[begin] : begin;
        limit_watched(&groups, &constants, &watch, sweep->batch->found + sweep->first_lane / SK_LANES + first);
        return;
    }
#endif
    walk_elements(&groups, &constants, mode, NULL);
}

#define SK_GROUP_WALK(name, mode)                                                            \
    void SK_KERNEL(name##_groups)(sk_run * run, const sk_op *op, size_t begin, size_t end) { \
        sweep_groups(run, op, begin, end, mode);                                             \
    }
#ifdef SK_WITH_STRIPS
#define SK_TURNED(name, walk)                                                                                \
    static __attribute__((noinline)) void name##_turned(                                                     \
        sk_run *run, const sk_sweep *sweep, const sk_element_constants *constants, size_t begin, size_t end, \
        const sk_span *span, const offsets *o, sk_half half) {                                               \
        walk;                                                                                                \
    }
SK_INLINE void meet_turned(sk_run *run, const sk_sweep *sweep, const sk_element_constants *constants, size_t begin,
                           size_t end, const sk_span *span, const offsets *o, sk_half half, sk_element_mode mode) {
    if (mode == SK_MODE_LIMIT && sweep->batch->coarse)
        meet_coarse(run, sweep, constants, begin, end, span, o, true, mode);
    else meet_span(run, sweep, constants, begin, end, span, o, half, true, mode);
}
#define SK_WALKS(name, mode)                                                                 \
    SK_TURNED(name, meet_turned(run, sweep, constants, begin, end, span, o, half, mode))     \
    void SK_KERNEL(name##_strips)(sk_run * run, const sk_op *op, size_t begin, size_t end) { \
        sweep_strips(run, op, begin, end, mode, name##_turned);                              \
    }                                                                                        \
    SK_GROUP_WALK(name, mode)
#else
#define SK_WALKS SK_GROUP_WALK
#endif
#ifndef SK_ONLY_BOUNDS
/* Forces, or products with a direction. */
SK_TOLD void sum_groups(sk_run *run, const sk_op *op, size_t begin, size_t end, bool applies) {
    sweep_groups(run, op, begin, end, applies ? SK_MODE_APPLY : SK_MODE_FORCE);
}
void SK_KERNEL(force_groups)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    sum_groups(run, op, begin, end, false);
}
void SK_KERNEL(apply_groups)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    sum_groups(run, op, begin, end, true);
}

SK_WALKS(project, SK_MODE_PROJECT)

/* Projections that keep their multipliers, with damping or without. */
#ifdef SK_WITH_STRIPS
SK_TOLD void keep_turned(sk_run *run, const sk_sweep *sweep, const sk_element_constants *constants, size_t begin,
                         size_t end, const sk_span *span, const offsets *o, sk_half half, bool damped) {
    meet_span(run, sweep, constants, begin, end, span, o, half, true,
              damped ? SK_MODE_PROJECT_DAMPED : SK_MODE_PROJECT_KEPT);
}
SK_TURNED(project_kept, keep_turned(run, sweep, constants, begin, end, span, o, half, false))
SK_TURNED(project_damped, keep_turned(run, sweep, constants, begin, end, span, o, half, true))
SK_TOLD_KEPT void keep_strips(sk_run *run, const sk_op *op, size_t begin, size_t end, bool damped) {
    sweep_strips(run, op, begin, end, damped ? SK_MODE_PROJECT_DAMPED : SK_MODE_PROJECT_KEPT,
                 damped ? project_damped_turned : project_kept_turned);
}
void SK_KERNEL(project_damped_strips)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    if (sk_is_damped(op)) keep_strips(run, op, begin, end, true);
    else keep_strips(run, op, begin, end, false);
}
#endif
SK_TOLD_KEPT void keep_groups(sk_run *run, const sk_op *op, size_t begin, size_t end, bool damped) {
    sweep_groups(run, op, begin, end, damped ? SK_MODE_PROJECT_DAMPED : SK_MODE_PROJECT_KEPT);
}
void SK_KERNEL(project_damped_groups)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    if (sk_is_damped(op)) keep_groups(run, op, begin, end, true);
    else keep_groups(run, op, begin, end, false);
}
#endif
#ifdef SK_WITH_LIMITS
SK_WALKS(limit, SK_MODE_LIMIT)
SK_WALKS(limit_moving, SK_MODE_LIMIT_MOVING)
#endif
#undef SK_WALKS
#undef SK_TURNED
#undef SK_GROUP_WALK
