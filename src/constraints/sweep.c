/* Cutting a batch into sweeps. */
#include "constraints/groups.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum {
    MOST_DIRECTIONS = 64,
    LEAST_SHARE = 5 /* a direction becomes a strip sweep if a fifth of its places have an element */
};

/* Where an element lies: in which strips and direction, and at which place of the first particle. */
typedef struct element_place {
    const sk_strips *strips; /* NULL: in none */
    int32_t row_step, column_step;
    uint32_t row, column;
} element_place;

typedef struct direction {
    const sk_strips *strips;
    int32_t row_step, column_step;
    size_t count;
    size_t sweep; /* its place among the batch's sweeps, SIZE_MAX: goes in groups */
} direction;

typedef struct cutter {
    sk_batch *batch;
    sk_allocator *allocator;
    const sk_particles *particles;
    direction directions[MOST_DIRECTIONS];
    size_t direction_count;
} cutter;

static const sk_strips *strips_of(const sk_particles *particles, uint32_t particle) {
    for (size_t i = 0; i < particles->strips.count; i++) {
        const sk_strips *strips = &particles->strips.data[i];
        if (particle >= strips->first_particle && particle - strips->first_particle < strips->count) return strips;
    }
    return NULL;
}

/* Elements are told apart by the step from the lower to the higher place. */
static element_place place_of(const sk_particles *particles, uint32_t p, uint32_t q) {
    element_place none = {NULL, 0, 0, 0, 0};
    const sk_strips *strips = strips_of(particles, p);
    if (!strips || strips != strips_of(particles, q) || p == q) return none;
    uint32_t a = particles->place[p], b = particles->place[q];
    if (a > b) a = particles->place[q], b = particles->place[p];
    element_place place = {strips, (int32_t)(b / strips->columns) - (int32_t)(a / strips->columns),
                           (int32_t)(b % strips->columns) - (int32_t)(a % strips->columns), a / strips->columns,
                           a % strips->columns};
    // a block that met itself would move a particle twice at once
    return place.row_step || place.column_step % (int32_t)strips->width ? place : none;
}

static direction *find_direction(cutter *c, element_place place) {
    if (!place.strips) return NULL;
    for (size_t d = 0; d < c->direction_count; d++) {
        direction *known = &c->directions[d];
        if (known->strips == place.strips && known->row_step == place.row_step &&
            known->column_step == place.column_step)
            return known;
    }
    if (c->direction_count == MOST_DIRECTIONS) return NULL;
    c->directions[c->direction_count] = (direction){place.strips, place.row_step, place.column_step, 0, SIZE_MAX};
    return &c->directions[c->direction_count++];
}

static element_place place_of_element(const cutter *c, size_t e) {
    return place_of(c->particles, c->batch->particle[2 * e], c->batch->particle[2 * e + 1]);
}

static int compare_directions(const void *p, const void *q) {
    const direction *a = p, *b = q;
    if (a->strips != b->strips) return a->strips < b->strips ? -1 : 1;
    if (a->row_step != b->row_step) return a->row_step < b->row_step ? -1 : 1;
    return (a->column_step > b->column_step) - (a->column_step < b->column_step);
}

/* Finds the spans of a strip row, one or two. */
static void find_spans(sk_sweep *sweep) {
    int64_t width = (int64_t)sweep->walk.width, step = sweep->column_step;
    int64_t shift = step >= 0 ? step / width : -((width - 1 - step) / width);
    int64_t cut = (shift + 1) * width - step; // from here on one strip farther
    if (cut > width) cut = width;
    sweep->span[0] = (sk_span){0, (size_t)cut, (int)shift};
    sweep->span[1] = (sk_span){(size_t)cut, (size_t)width, (int)shift + 1};
    sweep->span_count = cut < width ? 2 : 1;
}

/* Counts the directions, and makes a strip sweep of each that fills enough of its places. */
static bool add_strip_sweeps(cutter *c) {
    sk_batch *batch = c->batch;
    for (size_t e = 0; e < batch->count; e++) {
        direction *d = find_direction(c, place_of_element(c, e));
        if (d) d->count++;
    }
    qsort(c->directions, c->direction_count, sizeof *c->directions, compare_directions);
    for (size_t i = 0; i < c->direction_count; i++) {
        direction *d = &c->directions[i];
        size_t places = (size_t)d->strips->rows * d->strips->columns;
        if (d->count * LEAST_SHARE < places) continue;
        if (!sk_reserve(c->allocator, (void **)&batch->sweeps, &batch->sweep_capacity, batch->sweep_count + 1,
                        sizeof(sk_sweep)))
            return false;
        d->sweep = batch->sweep_count;
        sk_sweep *sweep = &batch->sweeps[batch->sweep_count++];
        *sweep = (sk_sweep){.batch = batch,
                            .strips = true,
                            .element_count = d->count,
                            .first_lane = batch->lane_count,
                            .row_step = d->row_step,
                            .column_step = d->column_step,
                            .walk = {d->strips->first_slot, d->strips->rows, d->strips->width, (size_t)d->row_step}};
        find_spans(sweep);
        snprintf(sweep->label, sizeof sweep->label, "%.30s %+d %+d", batch->label, d->row_step, d->column_step);
        batch->lane_count += (size_t)d->strips->rows * d->strips->width * SK_LANES;
    }
    for (size_t i = batch->sweep_count; i-- > 0;) {
        bool goes_on =
            i + 1 < batch->sweep_count && batch->sweeps[i].walk.first_slot == batch->sweeps[i + 1].walk.first_slot;
        batch->sweeps[i].together = 1 + (goes_on ? batch->sweeps[i + 1].together : 0);
    }
    return true;
}

/* The lane of an element in a strip sweep; SIZE_MAX if it is in none or the lane is taken. */
static size_t strip_lane(cutter *c, size_t e, const bool *taken) {
    element_place place = place_of_element(c, e);
    direction *d = find_direction(c, place);
    if (!d || d->sweep == SIZE_MAX) return SIZE_MAX;
    size_t width = place.strips->width;
    size_t lane = c->batch->sweeps[d->sweep].first_lane + (place.row * width + place.column % width) * SK_LANES +
                  place.column / width;
    return taken[lane] ? SIZE_MAX : lane;
}

/* ---- the whole cut ---- */

void sk_batch_forget_sweeps(sk_batch *batch, sk_allocator *allocator) {
    void **arrays[] = {(void **)&batch->lane,
                       (void **)&batch->lane_rest,
                       (void **)&batch->lane_stiffness,
                       (void **)&batch->lane_compliance,
                       (void **)&batch->lane_multiplier,
                       (void **)&batch->special};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) {
        sk_release(allocator, *arrays[i]);
        *arrays[i] = NULL;
    }
    for (size_t i = 0; i < batch->sweep_count; i++) {
        sk_release(allocator, batch->sweeps[i].slots);
        sk_release(allocator, batch->sweeps[i].slab_start);
        batch->sweeps[i].slots = batch->sweeps[i].slab_start = NULL;
    }
    batch->sweep_count = batch->lane_count = 0;
}

static bool allocate_lanes(sk_batch *batch, sk_allocator *allocator) {
    size_t size = batch->lane_count * sizeof(real);
    batch->lane = sk_allocate(allocator, batch->count * sizeof *batch->lane);
    batch->lane_rest = sk_allocate(allocator, size);
    batch->lane_stiffness = sk_allocate(allocator, size);
    batch->lane_compliance = sk_allocate(allocator, size);
    batch->lane_multiplier = sk_allocate(allocator, size);
    batch->special = sk_allocate(allocator, batch->lane_count / SK_LANES);
    return batch->lane && batch->lane_rest && batch->lane_stiffness && batch->lane_compliance &&
           batch->lane_multiplier && batch->special;
}

bool sk_batch_arrange(sk_batch *batch, sk_allocator *allocator, const sk_particles *particles) {
    cutter *c = sk_allocate(allocator, sizeof *c);
    size_t *lane_of = sk_allocate(allocator, batch->count * sizeof *lane_of);
    bool *taken = NULL, good = c && lane_of;
    sk_batch_forget_sweeps(batch, allocator);
    for (size_t i = 0; i < 2 * batch->count; i++) batch->slot[i] = particles->slot_of[batch->particle[i]];
    if (good) {
        *c = (cutter){.batch = batch, .allocator = allocator, .particles = particles};
        good = add_strip_sweeps(c);
    }
    if (good) good = (taken = sk_allocate(allocator, batch->lane_count)) != NULL;
    for (size_t e = 0; e < batch->count && good; e++) {
        lane_of[e] = strip_lane(c, e, taken);
        if (lane_of[e] != SIZE_MAX) taken[lane_of[e]] = true;
    }
    good = good && sk_groups_deal(batch, allocator, particles, lane_of) && allocate_lanes(batch, allocator);
    for (size_t e = 0; e < batch->count && good; e++) batch->lane[e] = (uint32_t)lane_of[e];
    sk_release(allocator, taken);
    sk_release(allocator, lane_of);
    sk_release(allocator, c);
    return good;
}

/* The values of a strip sweep's middle element stand for all; blocks that differ are marked. */
static void mark_special(sk_batch *batch, sk_sweep *sweep) {
    size_t blocks = sweep->walk.rows * sweep->walk.width;
    size_t middle = sweep->first_lane + (blocks / 2) * SK_LANES + SK_LANES / 2;
    sweep->rest = batch->lane_rest[middle];
    sweep->stiffness = batch->lane_stiffness[middle];
    sweep->compliance = batch->lane_compliance[middle];
    for (size_t b = 0; b < blocks; b++) {
        size_t lane = sweep->first_lane + b * SK_LANES;
        bool special = false;
        for (size_t l = lane; l < lane + SK_LANES; l++)
            special |= batch->lane_rest[l] != sweep->rest || batch->lane_stiffness[l] != sweep->stiffness ||
                       batch->lane_compliance[l] != sweep->compliance;
        batch->special[lane / SK_LANES] = special;
    }
}

void sk_batch_refresh(sk_batch *batch) {
    const sk_material *material = batch->params;
    for (size_t l = 0; l < batch->lane_count; l++) {
        batch->lane_rest[l] = batch->lane_stiffness[l] = 0;
        batch->lane_compliance[l] = (real)SK_UNBOUNDED;
    }
    for (size_t e = 0; e < batch->count; e++) {
        double k = material->stiffness * (batch->scale ? (double)batch->scale[e] : 1.0);
        size_t lane = batch->lane[e];
        batch->lane_rest[lane] = batch->rest[e];
        batch->lane_stiffness[lane] = (real)k;
        batch->lane_compliance[lane] = (real)(k > 0 ? 1 / k : SK_UNBOUNDED);
    }
    for (size_t s = 0; s < batch->sweep_count; s++)
        if (batch->sweeps[s].strips) mark_special(batch, &batch->sweeps[s]);
}
