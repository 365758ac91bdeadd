/* Cutting a batch into sweeps: directions along strips, and groups for the rest. */
#include "constraints/enclosure.h"
#include "constraints/groups.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    MOST_DIRECTIONS = 64,
    LEAST_SHARE = 5 /* a direction becomes a strip sweep if a fifth of its places have an element */
};

/* How an element lies in strips: its place, which is the lowest of its particles' places, and the steps from there. */
typedef struct element_place {
    const sk_strips *strips; /* NULL: in none */
    int32_t row_step[SK_MOST_ARITY], column_step[SK_MOST_ARITY];
    uint32_t row, column;
} element_place;

typedef struct direction {
    element_place like; /* an element of it */
    size_t count;
    uint8_t number; /* in the order in which directions were found */
    size_t sweep;   /* its place among the batch's sweeps; SIZE_MAX: it goes in groups */
} direction;

typedef struct cutter {
    sk_batch *batch;
    sk_allocator *allocator;
    const sk_particles *particles;
    int arity;
    direction directions[MOST_DIRECTIONS];
    size_t direction_count;
    uint8_t *direction_of; /* the number of each element's direction; NO_DIRECTION: it goes in groups */
    size_t *lane_of;       /* each element's lane, at first counted from the sweep's first one */
} cutter;

enum { NO_DIRECTION = UINT8_MAX };

static const sk_strips *strips_of(const sk_particles *particles, uint32_t particle) {
    for (size_t i = 0; i < particles->strips.count; i++) {
        const sk_strips *strips = &particles->strips.data[i];
        if (particle >= strips->first_particle && particle - strips->first_particle < strips->count) return strips;
    }
    return NULL;
}

/* Whether two of the particles lie in one block: sixteen elements would then move a particle twice at once. */
static bool meets_itself(const element_place *place, int arity) {
    for (int i = 0; i < arity; i++)
        for (int j = 0; j < i; j++)
            if (place->row_step[i] == place->row_step[j] &&
                (place->column_step[i] - place->column_step[j]) % (int32_t)place->strips->width == 0)
                return true;
    return false;
}

/* Finds the places of an element's particles, for a pair in either order, and returns the lowest. */
static uint32_t places_of(const cutter *c, const uint32_t *particle, uint32_t *at) {
    uint32_t lowest = UINT32_MAX;
    for (int i = 0; i < c->arity; i++) {
        at[i] = c->particles->place[particle[i]];
        if (at[i] < lowest) lowest = at[i];
    }
    if (c->arity == 2 && at[0] > at[1]) at[0] = at[1], at[1] = c->particles->place[particle[0]];
    return lowest;
}

/* Whether an element has the same steps as `place`; then only sets the row and column. */
static bool lies_like(const cutter *c, size_t e, element_place *place) {
    const uint32_t *particle = c->batch->particle + e * (size_t)c->arity;
    const sk_strips *strips = place->strips;
    for (int i = 0; i < c->arity; i++)
        if (particle[i] - strips->first_particle >= strips->count) return false;
    uint32_t at[SK_MOST_ARITY], lowest = places_of(c, particle, at), columns = strips->columns;
    place->row = lowest / columns, place->column = lowest % columns;
    for (int i = 0; i < c->arity; i++) {
        uint32_t column = place->column + (uint32_t)place->column_step[i];
        if (at[i] != (place->row + (uint32_t)place->row_step[i]) * columns + column || column >= columns) return false;
    }
    return true;
}

static element_place place_of_element(const cutter *c, size_t e) {
    const uint32_t *particle = c->batch->particle + e * (size_t)c->arity;
    element_place place = {.strips = strips_of(c->particles, particle[0])}, none = {.strips = NULL};
    if (!place.strips) return none;
    for (int i = 1; i < c->arity; i++)
        if (strips_of(c->particles, particle[i]) != place.strips) return none;
    uint32_t at[SK_MOST_ARITY], lowest = places_of(c, particle, at), columns = place.strips->columns;
    place.row = lowest / columns, place.column = lowest % columns;
    for (int i = 0; i < c->arity; i++) {
        place.row_step[i] = (int32_t)(at[i] / columns) - (int32_t)place.row;
        place.column_step[i] = (int32_t)(at[i] % columns) - (int32_t)place.column;
    }
    return meets_itself(&place, c->arity) ? none : place;
}

/* The order of directions: by strips, then by rows, then by columns. */
static int compare_places(const element_place *a, const element_place *b) {
    if (a->strips != b->strips) return a->strips < b->strips ? -1 : 1;
    for (int i = 0; i < SK_MOST_ARITY; i++)
        if (a->row_step[i] != b->row_step[i]) return a->row_step[i] < b->row_step[i] ? -1 : 1;
    for (int i = 0; i < SK_MOST_ARITY; i++)
        if (a->column_step[i] != b->column_step[i]) return a->column_step[i] < b->column_step[i] ? -1 : 1;
    return 0;
}

static int compare_directions(const void *p, const void *q) {
    return compare_places(&((const direction *)p)->like, &((const direction *)q)->like);
}

static direction *find_direction(cutter *c, const element_place *place) {
    if (!place->strips) return NULL;
    for (size_t d = 0; d < c->direction_count; d++)
        if (!compare_places(&c->directions[d].like, place)) return &c->directions[d];
    if (c->direction_count == MOST_DIRECTIONS) return NULL;
    c->directions[c->direction_count] = (direction){*place, 0, (uint8_t)c->direction_count, SIZE_MAX};
    return &c->directions[c->direction_count++];
}

/* How many strips on particle i of the elements in block k of a row lies. */
static int shift_from(const sk_sweep *sweep, int64_t k, int i) {
    int64_t width = (int64_t)sweep->walk.width, column = k + sweep->column_step[i];
    return (int)(column >= 0 ? column / width : -((width - 1 - column) / width));
}

/* Finds the spans of a strip row. Each particle's blocks cross the end of their strip at most once in a row. */
static void find_spans(sk_sweep *sweep, int arity) {
    sweep->span_count = 0;
    for (size_t k = 0; k < sweep->walk.width; k++) {
        sk_span span = {.first = k, .last = k + 1};
        for (int i = 0; i < arity; i++) {
            span.shift[i] = shift_from(sweep, (int64_t)k, i);
            span.turned |= span.shift[i] != 0;
        }
        sk_span *last = sweep->span_count ? &sweep->span[sweep->span_count - 1] : NULL;
        if (last && !memcmp(last->shift, span.shift, sizeof span.shift)) last->last = k + 1;
        else sweep->span[sweep->span_count++] = span;
    }
}

static void name_sweep(sk_sweep *sweep, int arity) {
    int at = snprintf(sweep->label, sizeof sweep->label, "%.30s", sweep->batch->label);
    for (int i = 0; i < arity && at < (int)sizeof sweep->label; i++)
        if (sweep->row_step[i] || sweep->column_step[i])
            at += snprintf(sweep->label + at, sizeof sweep->label - (size_t)at, " %+d %+d", sweep->row_step[i],
                           sweep->column_step[i]);
}

/* The lane of a place within its sweep, which has a block of sixteen for each column of a strip row or coarse grid. */
static size_t lane_of_place(const sk_batch *batch, size_t width, size_t row, size_t column) {
    size_t block = column % width, strip = column / width;
    if (!batch->coarse) return (row * width + block) * SK_LANES + strip;
    const sk_coarse_grid *grid = &batch->coarse->grid;
    row = (row - grid->row_first) / grid->row_step, block = (block - grid->first) / grid->step;
    return (row * sk_coarse_columns(grid, width) + block) * SK_LANES + strip;
}

/* How many blocks of lanes a sweep along strips has. */
static size_t block_count(const sk_batch *batch, size_t rows, size_t width) {
    if (!batch->coarse) return rows * width;
    return sk_coarse_rows(&batch->coarse->grid, rows) * sk_coarse_columns(&batch->coarse->grid, width);
}

/* Finds each element's direction, mostly that of the element before it, and its lane. */
static void find_directions(cutter *c) {
    direction *d = NULL;
    for (size_t e = 0; e < c->batch->count; e++) {
        element_place place;
        if (d) place = d->like;
        if (!d || !lies_like(c, e, &place)) {
            place = place_of_element(c, e);
            d = find_direction(c, &place);
        }
        c->direction_of[e] = d ? d->number : NO_DIRECTION;
        if (!d) continue;
        d->count++;
        c->lane_of[e] = lane_of_place(c->batch, place.strips->width, place.row, place.column);
    }
}

/* Makes a strip sweep of each direction that fills enough of its places. */
static bool add_strip_sweeps(cutter *c) {
    sk_batch *batch = c->batch;
    find_directions(c);
    qsort(c->directions, c->direction_count, sizeof *c->directions, compare_directions);
    for (size_t i = 0; i < c->direction_count; i++) {
        direction *d = &c->directions[i];
        const sk_strips *strips = d->like.strips;
        size_t places = (size_t)strips->rows * strips->columns, reach = 0;
        if (!batch->coarse && d->count * LEAST_SHARE < places) continue;
        if (!sk_reserve(c->allocator, (void **)&batch->sweeps, &batch->sweep_capacity, batch->sweep_count + 1,
                        sizeof(sk_sweep)))
            return false;
        d->sweep = batch->sweep_count;
        sk_sweep *sweep = &batch->sweeps[batch->sweep_count++];
        for (int k = 0; k < c->arity; k++)
            if ((size_t)d->like.row_step[k] > reach) reach = (size_t)d->like.row_step[k];
        *sweep = (sk_sweep){.batch = batch,
                            .strips = true,
                            .element_count = d->count,
                            .first_lane = batch->lane_count,
                            .walk = {strips->first_slot, strips->rows, strips->width, reach}};
        memcpy(sweep->row_step, d->like.row_step, sizeof sweep->row_step);
        memcpy(sweep->column_step, d->like.column_step, sizeof sweep->column_step);
        find_spans(sweep, c->arity);
        name_sweep(sweep, c->arity);
        batch->lane_count += block_count(batch, strips->rows, strips->width) * SK_LANES;
    }
    for (size_t i = batch->sweep_count; i-- > 0;) {
        bool goes_on =
            i + 1 < batch->sweep_count && batch->sweeps[i].walk.first_slot == batch->sweeps[i + 1].walk.first_slot;
        batch->sweeps[i].together = 1 + (goes_on ? batch->sweeps[i + 1].together : 0);
    }
    return true;
}

/* Turns lanes of a direction into lanes of the batch; SIZE_MAX if an element goes in groups or its lane is taken. */
static bool find_lanes(cutter *c) {
    size_t first[UINT8_MAX + 1];
    for (size_t d = 0; d <= UINT8_MAX; d++) first[d] = SIZE_MAX;
    for (size_t d = 0; d < c->direction_count; d++)
        if (c->directions[d].sweep != SIZE_MAX)
            first[c->directions[d].number] = c->batch->sweeps[c->directions[d].sweep].first_lane;
    bool *taken = sk_allocate(c->allocator, c->batch->lane_count);
    if (!taken) return false;
    for (size_t e = 0; e < c->batch->count; e++) {
        size_t from = first[c->direction_of[e]], lane = from + c->lane_of[e];
        c->lane_of[e] = from == SIZE_MAX || taken[lane] ? SIZE_MAX : lane;
        if (c->lane_of[e] != SIZE_MAX) taken[lane] = true;
    }
    sk_release(c->allocator, taken);
    return true;
}

/* ---- arranging a batch ---- */

void sk_batch_forget_sweeps(sk_batch *batch, sk_allocator *allocator) {
    void **arrays[] = {(void **)&batch->lane,
                       (void **)&batch->lane_rest,
                       (void **)&batch->lane_stiffness,
                       (void **)&batch->lane_compliance,
                       (void **)&batch->lane_multiplier,
                       (void **)&batch->special,
                       (void **)&batch->found};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) {
        sk_release(allocator, *arrays[i]);
        *arrays[i] = NULL;
    }
    for (size_t i = 0; i < batch->sweep_count; i++) {
        sk_release(allocator, batch->sweeps[i].slots);
        sk_release(allocator, batch->sweeps[i].slab_start);
        sk_release(allocator, batch->sweeps[i].ahead);
        batch->sweeps[i] = (sk_sweep){.batch = NULL};
    }
    batch->sweep_count = batch->lane_count = 0;
}

static bool allocate_lanes(sk_batch *batch, sk_allocator *allocator) {
    size_t size = batch->lane_count * sizeof(real);
    batch->lane = sk_allocate(allocator, batch->count * sizeof *batch->lane);
    batch->lane_rest = sk_allocate(allocator, batch->rest_count * size);
    batch->lane_stiffness = sk_allocate(allocator, size);
    batch->lane_compliance = sk_allocate(allocator, size);
    batch->lane_multiplier = sk_allocate(allocator, size);
    batch->special = sk_allocate(allocator, batch->lane_count / SK_LANES);
    batch->found = sk_allocate(allocator, batch->lane_count / SK_LANES * sizeof *batch->found);
    return batch->lane && batch->lane_rest && batch->lane_stiffness && batch->lane_compliance &&
           batch->lane_multiplier && batch->special && batch->found;
}

static bool cut(sk_batch *batch, sk_allocator *allocator, const sk_particles *particles) {
    cutter *c = sk_allocate(allocator, sizeof *c);
    size_t *lane_of = sk_allocate(allocator, batch->count * sizeof *lane_of);
    uint8_t *direction_of = sk_allocate(allocator, batch->count);
    bool good = c && lane_of && direction_of;
    if (good) {
        *c = (cutter){.batch = batch,
                      .allocator = allocator,
                      .particles = particles,
                      .arity = (int)batch->arity,
                      .direction_of = direction_of,
                      .lane_of = lane_of};
        memset(direction_of, NO_DIRECTION, batch->count);
        bool strips = batch->type->project.strips.version[0] || batch->type->limit.strips.version[0];
        good = (!strips || add_strip_sweeps(c)) && find_lanes(c);
    }
    good = good && sk_groups_deal(batch, allocator, particles, lane_of) && allocate_lanes(batch, allocator);
    for (size_t e = 0; e < batch->count && good; e++) batch->lane[e] = (uint32_t)lane_of[e];
    sk_release(allocator, direction_of);
    sk_release(allocator, lane_of);
    sk_release(allocator, c);
    return good;
}

bool sk_batch_arrange(sk_batch *batch, sk_allocator *allocator, const sk_particles *particles) {
    sk_batch_forget_sweeps(batch, allocator);
    batch->stale = true;
    // no sweeps for a body that takes no part: either all of its elements are out, or none (sk_batch_leave_out)
    batch->asleep = false; // who does not sleep of it is pinned (world/sleep.c)
    for (size_t i = 0; i < batch->arity * batch->count && particles->asleep_count && !batch->asleep; i++)
        batch->asleep = particles->presence[batch->particle[i]] == SK_ASLEEP;
    if (batch->count && !sk_particle_counts(particles, batch->particle[0])) return true;
    batch->first_slot = SIZE_MAX, batch->end_slot = 0;
    for (size_t i = 0; i < batch->arity * batch->count; i++) {
        const uint32_t slot = batch->slot[i] = particles->slot_of[batch->particle[i]];
        if (slot < batch->first_slot) batch->first_slot = slot;
        if (slot >= batch->end_slot) batch->end_slot = slot + 1;
    }
    if (batch->aggregate) sk_aggregate_arrange(batch->aggregate, particles);
    // of what sleeps the energy is asked for, and nothing else
    if (!batch->enclosure) return batch->asleep || cut(batch, allocator, particles);
    return sk_enclosure_arrange(batch, allocator, particles) && (batch->asleep || allocate_lanes(batch, allocator));
}

/* Takes a strip sweep's common values from its middle element, and marks the blocks that differ. */
static void mark_special(sk_batch *batch, sk_sweep *sweep) {
    size_t blocks = block_count(batch, sweep->walk.rows, sweep->walk.width);
    size_t middle = sweep->first_lane + (blocks / 2) * SK_LANES + SK_LANES / 2;
    for (size_t r = 0; r < batch->rest_count; r++) sweep->rest[r] = batch->lane_rest[r * batch->lane_count + middle];
    sweep->stiffness = batch->lane_stiffness[middle];
    sweep->compliance = batch->lane_compliance[middle];
    for (size_t b = 0; b < blocks; b++) {
        size_t lane = sweep->first_lane + b * SK_LANES;
        bool special = false;
        for (size_t l = lane; l < lane + SK_LANES; l++)
            special |= batch->lane_stiffness[l] != sweep->stiffness || batch->lane_compliance[l] != sweep->compliance;
        for (size_t r = 0; r < batch->rest_count; r++)
            for (size_t l = lane; l < lane + SK_LANES; l++)
                special |= batch->lane_rest[r * batch->lane_count + l] != sweep->rest[r];
        batch->special[lane / SK_LANES] = special;
    }
}

void sk_batch_refresh(sk_batch *batch) {
    const sk_material *material = batch->params;
    if (!batch->stale || !batch->lane) return;
    batch->stale = false;
    for (size_t i = 0; i < batch->rest_count * batch->lane_count; i++) batch->lane_rest[i] = 0;
    for (size_t l = 0; l < batch->lane_count; l++) {
        batch->lane_stiffness[l] = 0;
        batch->lane_compliance[l] = (real)SK_UNBOUNDED;
    }
    for (size_t e = 0; e < batch->count; e++) {
        double k = material->stiffness * (batch->scale ? (double)batch->scale[e] : 1.0);
        size_t lane = batch->lane[e];
        for (size_t r = 0; r < batch->rest_count; r++)
            batch->lane_rest[r * batch->lane_count + lane] = batch->rest[r * batch->count + e];
        batch->lane_stiffness[lane] = (real)k;
        batch->lane_compliance[lane] = (real)(k > 0 ? 1 / k : SK_UNBOUNDED);
    }
    for (size_t s = 0; s < batch->sweep_count; s++)
        if (batch->sweeps[s].strips) mark_special(batch, &batch->sweeps[s]);
}
