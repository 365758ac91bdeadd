/* Dividing elements into groups of sixteen that share no particle, and finding how threads can walk along them.
 *
 * Elements are taken in order. Where that order starts again from low slots (outward springs, then those that go round)
 * a new sweep begins, so that the groups of each go through the particles once, and threads can follow each other. */
#include "constraints/groups.h"

#include <stdio.h>
#include <string.h>

enum {
    GROUP_DISTANCE = 4, /* the largest distance that dependent groups are kept apart, if possible */
    LEAST_BEHIND = 16,  /* groups that stay open behind the newest one: a sixteenth of all, but at least this many */
    MOST_BEHIND = 32,   /* and at most this many: particles between pass from thread to thread in each sweep */
    MOST_PASSES = 8,    /* sweeps that a batch is cut into */
    LEAST_SLABS = 12,   /* of a walk, */
    LEAST_SHARE = 6     /* and for each slab of its reach */
};

#define FREE_LANE UINT32_MAX /* in place of a slot until fill_free_lanes() */

typedef struct dealer {
    sk_batch *batch;
    sk_allocator *allocator;
    const sk_particles *particles;
    size_t *lane_of;
    size_t arity;
} dealer;

typedef struct grouping {
    size_t first, last; /* elements [first, last) */
    uint32_t *latest;   /* a slot's newest group, counted from 1; 0: none */
    uint32_t *next;     /* by group: itself while it has room, else a later one */
    uint8_t *filled;    /* elements of a group */
    uint32_t *group;    /* of each element from the first on */
    size_t group_count;
} grouping;

static bool is_left(const dealer *d, size_t e) {
    return d->lane_of[e] == SIZE_MAX;
}

/* ---- dealing ---- */

/* The first group from `group` on that has room (a union-find structure with path compression). */
static uint32_t first_open(uint32_t *next, uint32_t group) {
    uint32_t open = group;
    while (next[open] != open) open = next[open];
    while (next[group] != open) {
        uint32_t step = next[group];
        next[group] = open;
        group = step;
    }
    return open;
}

/* The distance between dependent groups, if possible: four for kinds that work in blocks, two for others. */
static uint32_t distance_of(const dealer *d) {
    return d->batch->type->in_blocks ? GROUP_DISTANCE : 2;
}

static void deal(const dealer *d, grouping *g) {
    uint32_t distance = distance_of(d);
    size_t behind = (g->last - g->first) / SK_LANES / 16;
    behind = behind < LEAST_BEHIND ? LEAST_BEHIND : behind > MOST_BEHIND ? MOST_BEHIND : behind;
    for (size_t e = g->first; e < g->last; e++) {
        if (!is_left(d, e)) continue;
        const uint32_t *slot = d->batch->slot + e * d->arity;
        uint32_t after = 0;
        for (size_t i = 0; i < d->arity; i++)
            if (g->latest[slot[i]] > after) after = g->latest[slot[i]];
        // not far behind the newest: members of a group are then near in memory, and groups go through it once
        uint32_t first = g->group_count > behind ? (uint32_t)(g->group_count - behind) : 0;
        if (after && after - 1 + distance > first) first = after - 1 + distance;
        uint32_t group = first_open(g->next, first);
        g->group[e - g->first] = group;
        for (size_t i = 0; i < d->arity; i++) g->latest[slot[i]] = group + 1;
        if (++g->filled[group] == SK_LANES) g->next[group] = group + 1;
        if (group + 1 > g->group_count) g->group_count = group + 1;
    }
}

/* Removes groups that stayed empty, as between the single elements of a chain. */
static void close_up(const dealer *d, grouping *g) {
    size_t count = 0;
    for (size_t i = 0; i < g->group_count; i++) {
        g->next[i] = (uint32_t)count; // its new number
        if (g->filled[i]) g->filled[count++] = g->filled[i];
    }
    for (size_t e = g->first; e < g->last; e++)
        if (is_left(d, e)) g->group[e - g->first] = g->next[g->group[e - g->first]];
    g->group_count = count;
}

/* ---- the sweep ---- */

/* Gives the elements their lanes, in order within a group, and the groups their slots; free lanes get theirs when the
 * walk is known (fill_free_lanes). */
static sk_sweep *add_sweep(const dealer *d, grouping *g, size_t left) {
    sk_batch *batch = d->batch;
    if (!sk_reserve(d->allocator, (void **)&batch->sweeps, &batch->sweep_capacity, batch->sweep_count + 1,
                    sizeof(sk_sweep)))
        return NULL;
    size_t count = g->group_count * d->arity * SK_LANES;
    uint32_t *slots = sk_allocate(d->allocator, count * sizeof *slots);
    if (!slots) return NULL;
    sk_sweep *sweep = &batch->sweeps[batch->sweep_count++];
    *sweep = (sk_sweep){.batch = batch,
                        .element_count = left,
                        .first_lane = batch->lane_count,
                        .slots = slots,
                        .group_count = g->group_count};
    snprintf(sweep->label, sizeof sweep->label, "%.40s groups", batch->label);
    for (size_t i = 0; i < count; i++) slots[i] = FREE_LANE;
    memset(g->filled, 0, g->group_count);
    for (size_t e = g->first; e < g->last; e++) {
        if (!is_left(d, e)) continue;
        size_t group = g->group[e - g->first], lane = g->filled[group]++;
        for (size_t i = 0; i < d->arity; i++)
            slots[(group * d->arity + i) * SK_LANES + lane] = batch->slot[e * d->arity + i];
        d->lane_of[e] = batch->lane_count + group * SK_LANES + lane;
    }
    batch->lane_count += g->group_count * SK_LANES;
    return sweep;
}

/* Finds for each group how many from it on share no particle. False when there is no memory. */
static bool find_blocks(const dealer *d, sk_sweep *sweep, uint32_t *latest) {
    sweep->ahead = sk_allocate(d->allocator, sweep->group_count);
    if (!sweep->ahead) return false;
    memset(latest, 0, d->particles->slot_count * sizeof *latest);
    size_t open = 0; // groups before it are done
    for (size_t g = 0; g < sweep->group_count; g++) {
        size_t before = 0; // the newest group that shares a particle, counted from 1
        for (size_t i = 0; i < d->arity * SK_LANES; i++) {
            uint32_t slot = sweep->slots[g * d->arity * SK_LANES + i];
            if (slot == FREE_LANE) continue;
            if (latest[slot] > before && latest[slot] != g + 1) before = latest[slot];
            latest[slot] = (uint32_t)g + 1;
        }
        if (g >= SK_BLOCK_GROUPS && before + SK_BLOCK_GROUPS < g + 1) before = g + 1 - SK_BLOCK_GROUPS;
        for (; open < before; open++) sweep->ahead[open] = (uint8_t)(g - open);
    }
    for (; open < sweep->group_count; open++) sweep->ahead[open] = (uint8_t)(sweep->group_count - open);
    return true;
}

/* ---- its walk ---- */

/* The strips that a slot lies in, or all slots behind the strips, as a walk without reach. */
static sk_walk region_of(const sk_particles *particles, uint32_t slot) {
    for (size_t i = 0; i < particles->strips.count; i++) {
        const sk_strips *s = &particles->strips.data[i];
        size_t slots = (size_t)s->rows * s->width * SK_LANES;
        if (slot >= s->first_slot && slot - s->first_slot < slots)
            return (sk_walk){s->first_slot, s->rows, s->width, 0};
    }
    size_t slots = particles->empty_slot - particles->strip_slots, slab = SK_SLAB_BLOCKS * SK_LANES;
    return (sk_walk){particles->strip_slots, (slots + slab - 1) / slab, SK_SLAB_BLOCKS, 0};
}

/* Finds the first and last slab that a group touches; false if it leaves the region. */
static bool find_slabs(const dealer *d, const uint32_t *slots, const sk_walk *walk, size_t slab[2]) {
    slab[0] = SIZE_MAX, slab[1] = 0;
    for (size_t i = 0; i < d->arity * SK_LANES; i++) {
        if (slots[i] == FREE_LANE) continue;
        if (slots[i] < walk->first_slot) return false;
        size_t at = (slots[i] - walk->first_slot) / (walk->width * SK_LANES);
        if (at >= walk->rows) return false;
        if (at < slab[0]) slab[0] = at;
        if (at > slab[1]) slab[1] = at;
    }
    return true;
}

/* Gives the sweep a walk if its groups are nearly in the order of slots. False when there is no memory. */
static bool find_walk(const dealer *d, sk_sweep *sweep) {
    sk_walk walk = region_of(d->particles, sweep->slots[0]);
    if (walk.rows < LEAST_SLABS) return true;
    uint32_t *start = sk_allocate(d->allocator, (walk.rows + 1) * sizeof *start);
    if (!start) return false;
    // backwards: a group belongs to the lowest slab that it or one after it touches
    size_t lowest = walk.rows - 1;
    bool walks = true;
    for (size_t j = 0; j <= walk.rows; j++) start[j] = (uint32_t)sweep->group_count;
    for (size_t g = sweep->group_count; g-- > 0 && walks;) {
        size_t slab[2];
        walks = find_slabs(d, sweep->slots + g * d->arity * SK_LANES, &walk, slab);
        if (slab[0] < lowest) lowest = slab[0];
        if (walks && slab[1] - lowest > walk.reach) walk.reach = slab[1] - lowest;
        start[lowest] = (uint32_t)g;
    }
    for (size_t j = walk.rows; j-- > 0;)
        if (start[j] > start[j + 1]) start[j] = start[j + 1];
    start[0] = 0;
    if (walks && walk.reach * LEAST_SHARE <= walk.rows) {
        sweep->walk = walk;
        sweep->slab_start = start;
    } else {
        sk_release(d->allocator, start);
    }
    return true;
}

/* Free lanes read and write spare slots, which have no mass: those of their slab, so that threads stay apart as with
 * particles, and a different one in each group, so that none waits for the stores of the last. */
static void fill_free_lanes(const dealer *d, sk_sweep *sweep) {
    size_t slab = 0, lanes = d->arity * SK_LANES;
    for (size_t g = 0; g < sweep->group_count; g++) {
        while (sweep->slab_start && g >= sweep->slab_start[slab + 1]) slab++;
        size_t spare = d->particles->spare_slot + slab * SK_SLAB_SPARES + g % SK_SLAB_SPARES;
        for (size_t i = g * lanes; i < (g + 1) * lanes; i++)
            if (sweep->slots[i] == FREE_LANE) sweep->slots[i] = (uint32_t)spare;
    }
}

/* ---- passes ---- */

/* Cuts the elements where their order starts again: where slots fall back by more than half of all. */
static size_t find_passes(const dealer *d, size_t first[MOST_PASSES + 1]) {
    size_t count = 0, highest = 0;
    first[count++] = 0;
    for (size_t e = 0; e < d->batch->count && count < MOST_PASSES; e++) {
        if (!is_left(d, e)) continue;
        size_t low = SIZE_MAX;
        for (size_t i = 0; i < d->arity; i++)
            if (d->batch->slot[e * d->arity + i] < low) low = d->batch->slot[e * d->arity + i];
        if (low + d->particles->slot_count / 2 < highest) first[count++] = e, highest = 0;
        if (low > highest) highest = low;
    }
    first[count] = d->batch->count;
    return count;
}

static bool add_pass(const dealer *d, size_t first, size_t last) {
    size_t left = 0;
    for (size_t e = first; e < last; e++) left += is_left(d, e);
    if (!left) return true;
    // in the worst case all elements share a particle: each has a group of its own, GROUP_DISTANCE apart
    size_t most = left * GROUP_DISTANCE + GROUP_DISTANCE + 1;
    grouping g = {.first = first, .last = last};
    g.latest = sk_allocate(d->allocator, (d->particles->slot_count + SK_LANES) * sizeof *g.latest);
    g.next = sk_allocate(d->allocator, most * sizeof *g.next);
    g.filled = sk_allocate(d->allocator, most);
    g.group = sk_allocate(d->allocator, (last - first) * sizeof *g.group);
    bool good = g.latest && g.next && g.filled && g.group;
    for (size_t i = 0; i < most && good; i++) g.next[i] = (uint32_t)i;
    if (good) {
        deal(d, &g);
        close_up(d, &g);
        sk_sweep *sweep = add_sweep(d, &g, left);
        good = sweep && find_walk(d, sweep) && find_blocks(d, sweep, g.latest);
        if (good) fill_free_lanes(d, sweep);
    }
    sk_release(d->allocator, g.latest);
    sk_release(d->allocator, g.next);
    sk_release(d->allocator, g.filled);
    sk_release(d->allocator, g.group);
    return good;
}

bool sk_groups_deal(sk_batch *batch, sk_allocator *allocator, const sk_particles *particles, size_t *lane_of) {
    dealer d = {batch, allocator, particles, lane_of, batch->arity};
    size_t first[MOST_PASSES + 1], count = find_passes(&d, first);
    for (size_t i = 0; i < count; i++)
        if (!add_pass(&d, first[i], first[i + 1])) return false;
    return true;
}
