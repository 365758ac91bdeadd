/* The kernel of tethers, and their arrays. Each particle is pulled to its anchors in turn, in both orders, and the
 * results are averaged. */
#include "base/kernels.h"
#include "limits/limit.h"

#include <stddef.h>
#include <string.h>

#define SK_UNIT tether
SK_KERNELS(sk_op_kernel, keep_tethers);

#ifdef SK_ISA

/* Moves the lanes of p that are outside of the spheres around their anchors back onto them; returns which. */
SK_INLINE sk_mask pull_in(sk_wide3 *p, sk_wide3 anchor, sk_wide most) {
    sk_wide3 d = {p->x - anchor.x, p->y - anchor.y, p->z - anchor.z};
    sk_wide square = sk_dot_wide(d, d);
    sk_mask out = sk_more(square, most * most);
    if (!sk_any(out)) return out;
    sk_wide s = most / sk_wide_sqrt(square);
    p->x = sk_select(out, anchor.x + s * d.x, p->x);
    p->y = sk_select(out, anchor.y + s * d.y, p->y);
    p->z = sk_select(out, anchor.z + s * d.z, p->z);
    return out;
}

/* The index of anchor k's values in an array by blocks, for a part that begins `at` slots after the first. */
SK_INLINE size_t place_of(const sk_limit *limit, size_t at, size_t k) {
    return (at / SK_LANES * limit->anchors + k) * SK_LANES + at % SK_LANES;
}

/* The places in `pins` of anchor k for the lanes of a part, and whether all are the same. */
typedef struct part_pins {
    const uint32_t *pin;
    bool same;
} part_pins;

SK_INLINE part_pins pins_of(const sk_limit *limit, size_t at, size_t k) {
    if (limit->shared) return (part_pins){limit->pin_of + k, true};
    part_pins pins = {limit->pin_of + place_of(limit, at, k), true};
    for (int l = 1; l < SK_PART; l++) pins.same &= pins.pin[l] == pins.pin[0];
    return pins;
}

/* One member of the anchors of a part; `offset` is its place in an sk_anchor. */
SK_INLINE sk_wide of_anchor(const sk_limit *limit, const part_pins *pins, size_t offset) {
    const real *number = (const real *)(const void *)limit->pins + offset;
    enum { STRIDE = sizeof(sk_anchor) / sizeof(real) };
    if (pins->same) return sk_splat(number[pins->pin[0] * STRIDE]);
    sk_wide all;
    for (int l = 0; l < SK_PART; l++) all[l] = number[pins->pin[l] * STRIDE];
    return all;
}

#define NUMBER_OF(member) (offsetof(sk_anchor, member) / sizeof(real))

SK_INLINE sk_wide3 velocity_of(const sk_limit *limit, const part_pins *pins) {
    return (sk_wide3){of_anchor(limit, pins, NUMBER_OF(velocity.x)), of_anchor(limit, pins, NUMBER_OF(velocity.y)),
                      of_anchor(limit, pins, NUMBER_OF(velocity.z))};
}

/* The positions of a part's anchors, `since` seconds after the start of the step. An anchor that is not pinned any more
 * holds nothing. */
SK_INLINE sk_wide3 anchor_of(const sk_limit *limit, const part_pins *pins, real since, sk_wide *most) {
    sk_wide3 from = {of_anchor(limit, pins, NUMBER_OF(start.x)), of_anchor(limit, pins, NUMBER_OF(start.y)),
                     of_anchor(limit, pins, NUMBER_OF(start.z))};
    if (limit->lets_go) {
        sk_mask free = sk_positive(of_anchor(limit, pins, NUMBER_OF(free)));
        *most = sk_select(free, sk_splat((real)SK_FAR), *most);
    }
    if (!limit->moves) return from;
    sk_wide3 v = velocity_of(limit, pins);
    return (sk_wide3){from.x + since * v.x, from.y + since * v.y, from.z + since * v.z};
}

/* The sum of the velocities of the anchors that pulled at a lane, and their number. */
typedef struct pullers {
    sk_wide3 velocity;
    sk_wide count;
} pullers;

/* Pulls the lanes of p towards anchor k. */
SK_INLINE void pull_by(const sk_limit *limit, size_t at, size_t k, real factor, real since, sk_wide3 *p, pullers *by) {
    sk_wide most = factor * *(const sk_wide *)(const void *)(limit->slot_length + place_of(limit, at, k));
    part_pins pins = pins_of(limit, at, k);
    sk_wide3 anchor = anchor_of(limit, &pins, since, &most);
    sk_mask out = pull_in(p, anchor, most);
    if (!limit->moves || !sk_any(out)) return;
    sk_wide3 v = velocity_of(limit, &pins);
    by->velocity.x += sk_keep(out, v.x);
    by->velocity.y += sk_keep(out, v.y);
    by->velocity.z += sk_keep(out, v.z);
    by->count += sk_keep(out, sk_splat(1));
}

/* A velocity relative to the mean of the anchors that pulled. */
SK_INLINE sk_wide3 seen_by(const pullers *by, sk_wide4 v) {
    sk_wide share = 1 / sk_select(sk_positive(by->count), by->count, sk_splat(1));
    return (sk_wide3){v.x - share * by->velocity.x, v.y - share * by->velocity.y, v.z - share * by->velocity.z};
}

/* Several anchors are applied in turn, once forward and once backward, and the mean is taken: otherwise the last one
 * would win, and a cloth between two pins would hang askew. Where velocities are not taken from positions (there is a
 * second source), the velocity away from an anchor is removed as well. */
void SK_KERNEL(keep_tethers)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    const sk_limit *limit = op->rule;
    real factor = (real)(1 + *limit->bound), since = (real)(run->time - op->before_end - limit->start);
    size_t anchors = limit->anchors;
    for (size_t slot = begin; slot < end; slot += SK_PART) {
        size_t at = slot - limit->first_slot;
        if (limit->empty[at / SK_LANES]) continue;
        sk_wide4 x = sk_load_part(run->vector[op->dst], slot, slot < op->packed);
        sk_wide3 forth = {x.x, x.y, x.z}, back = forth;
        pullers by = {{{0}, {0}, {0}}, {0}};
        for (size_t k = 0; k < anchors; k++) pull_by(limit, at, k, factor, since, &forth, &by);
        sk_mask moved =
            (sk_differ(forth.x, x.x) | sk_differ(forth.y, x.y) | sk_differ(forth.z, x.z)) & sk_positive(x.w);
        if (!sk_any(moved)) continue;
        if (anchors > 1) {
            for (size_t k = anchors; k-- > 0;) pull_by(limit, at, k, factor, since, &back, &by);
            real half = (real)0.5;
            forth = (sk_wide3){half * (forth.x + back.x), half * (forth.y + back.y), half * (forth.z + back.z)};
        }
        sk_wide3 move = {forth.x - x.x, forth.y - x.y, forth.z - x.z};
        x.x = sk_select(moved, forth.x, x.x);
        x.y = sk_select(moved, forth.y, x.y);
        x.z = sk_select(moved, forth.z, x.z);
        sk_store_part(run->vector[op->dst], slot, slot < op->packed, x);
        if (op->source[1] == SK_NONE) continue;
        // remove the velocity against the move
        sk_vec4 *velocity = run->vector[op->source[1]];
        sk_wide4 v = sk_load_part(velocity, slot, slot < op->packed);
        sk_wide3 u = {v.x, v.y, v.z};
        if (limit->moves) u = seen_by(&by, v);
        sk_wide square = sk_dot_wide(move, move), against = sk_dot_wide(move, u);
        sk_mask stops = moved & sk_positive(square) & sk_negative(against);
        sk_wide s = -against / square;
        v.x = sk_plus_where(stops, v.x, s * move.x);
        v.y = sk_plus_where(stops, v.y, s * move.y);
        v.z = sk_plus_where(stops, v.z, s * move.z);
        sk_store_part(velocity, slot, slot < op->packed, v);
    }
}
#undef NUMBER_OF

#else

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
    sk_release(allocator, limit->cut_length);
    sk_release(allocator, limit->slot_length);
    sk_release(allocator, limit->empty);
    sk_release(allocator, limit->pin_of);
    sk_release(allocator, limit->pins);
    sk_release(allocator, limit);
}

/* Lists the particles that are anchors, each once, and the place of each in the list. Place 0 stands for none. False
 * when there is no memory. */
static bool list_pins(sk_limit *limit, sk_allocator *allocator, const sk_particles *particles, uint32_t *place_of) {
    size_t anchors = limit->anchors, count = 1;
    memset(place_of, 0, particles->count * sizeof *place_of);
    for (size_t i = 0; i < limit->count * anchors; i++) {
        uint32_t particle = limit->particle[i / anchors * (1 + anchors) + 1 + i % anchors];
        if (!place_of[particle]) place_of[particle] = (uint32_t)count++;
    }
    limit->pins = sk_allocate(allocator, count * sizeof *limit->pins);
    if (!limit->pins) return false;
    limit->pin_count = count;
    limit->pins[0] = (sk_anchor){.slot = (uint32_t)particles->empty_slot};
    for (size_t i = 0; i < particles->count; i++)
        if (place_of[i]) limit->pins[place_of[i]] = (sk_anchor){.slot = particles->slot_of[i]};
    return true;
}

/* Lanes that are not tethered get the anchor of one beside them, without effect, so that parts more often have a single
 * anchor. */
static void fill_gaps(sk_limit *limit) {
    for (size_t i = 0; i < limit->slot_count * limit->anchors; i += SK_LANES) {
        uint32_t pin = 0;
        for (size_t l = i; l < i + SK_LANES && !pin; l++) pin = limit->pin_of[l];
        for (size_t l = i; l < i + SK_LANES; l++)
            if (!limit->pin_of[l]) limit->pin_of[l] = pin;
    }
}

/* Fills the arrays by slot, from the first to the last slot that is tethered. */
static void fill_blocks(sk_limit *limit, const sk_particles *particles, const uint32_t *place_of) {
    const real *length = limit->cut_length ? limit->cut_length : limit->length;
    size_t anchors = limit->anchors;
    for (size_t i = 0; i < limit->slot_count * anchors; i++) {
        limit->slot_length[i] = (real)SK_FAR;
        if (!limit->shared) limit->pin_of[i] = 0;
    }
    for (size_t block = 0; block < limit->slot_count / SK_LANES; block++) limit->empty[block] = true;
    for (size_t e = 0; e < limit->count; e++) {
        const uint32_t *element = limit->particle + e * (1 + anchors);
        size_t at = particles->slot_of[element[0]] - limit->first_slot, block = at / SK_LANES, lane = at % SK_LANES;
        limit->empty[block] = false;
        for (size_t k = 0; k < anchors; k++) {
            size_t place = (block * anchors + k) * SK_LANES + lane;
            limit->slot_length[place] = length[e * anchors + k];
            limit->pin_of[limit->shared ? k : place] = place_of[element[1 + k]];
        }
    }
    if (!limit->shared) fill_gaps(limit);
}

bool sk_limit_arrange(sk_limit *limit, sk_allocator *allocator, const sk_particles *particles) {
    size_t anchors = limit->anchors, low = SIZE_MAX, high = 0;
    sk_release(allocator, limit->slot_length);
    sk_release(allocator, limit->empty);
    sk_release(allocator, limit->pin_of);
    sk_release(allocator, limit->pins);
    limit->slot_length = NULL;
    limit->empty = NULL;
    limit->pin_of = NULL;
    limit->pins = NULL;
    limit->asleep = limit->count && particles->presence[limit->particle[0]] == SK_ASLEEP;
    if (limit->asleep) return true;
    for (size_t e = 0; e < limit->count; e++) {
        size_t slot = particles->slot_of[limit->particle[e * (1 + anchors)]];
        if (slot < low) low = slot;
        if (slot + 1 > high) high = slot + 1;
    }
    limit->first_slot = limit->count ? low / SK_LANES * SK_LANES : 0;
    limit->slot_count = limit->count ? (high + SK_LANES - 1) / SK_LANES * SK_LANES - limit->first_slot : 0;
    limit->slot_length = sk_allocate(allocator, limit->slot_count * anchors * sizeof *limit->slot_length);
    limit->pin_of =
        sk_allocate(allocator, (limit->shared ? anchors : limit->slot_count * anchors) * sizeof *limit->pin_of);
    limit->empty = sk_allocate(allocator, limit->slot_count / SK_LANES * sizeof *limit->empty);
    uint32_t *place_of = sk_allocate(allocator, particles->count * sizeof *place_of);
    bool good = limit->slot_length && limit->empty && limit->pin_of && place_of &&
                list_pins(limit, allocator, particles, place_of);
    if (good) fill_blocks(limit, particles, place_of);
    sk_release(allocator, place_of);
    return good;
}

void sk_limit_begin(sk_limit *limit, const sk_vec4 *x, const sk_vec4 *v, double time) {
    limit->start = time;
    limit->moves = limit->lets_go = false;
    for (size_t i = 0; i < limit->pin_count; i++) {
        sk_anchor *pin = &limit->pins[i];
        sk_vec4 p = x[pin->slot], u = v[pin->slot];
        pin->start = sk_v3(p.x, p.y, p.z);
        pin->velocity = p.w > 0 ? sk_v3(0, 0, 0) : sk_v3(u.x, u.y, u.z);
        pin->free = p.w;
        limit->lets_go |= p.w > 0;
        limit->moves |= pin->velocity.x != 0 || pin->velocity.y != 0 || pin->velocity.z != 0;
    }
}
#endif
