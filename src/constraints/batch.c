/* Batches: their arrays, the elements left out while bodies take no part, multipliers, and which batches act. */
#include <string.h>

#include "constraints/enclosure.h"
#include "constraints/severed.h"

int sk_constraint_arity(const sk_constraint_type *type, const void *params) {
    return type->arity_of ? type->arity_of(params) : type->arity;
}

int sk_constraint_rest_count(const sk_constraint_type *type, const void *params) {
    return type->rest_count_of ? type->rest_count_of(params) : type->rest_count;
}

sk_batch *sk_batch_create(sk_allocator *allocator, const sk_constraint_type *type, const void *params, size_t count,
                          const uint32_t *particles, const real *rest, const real *scale) {
    sk_batch *batch = sk_allocate(allocator, sizeof *batch);
    if (!batch) return NULL;
    batch->type = type;
    batch->count = count;
    batch->arity = (size_t)sk_constraint_arity(type, params);
    batch->rest_count = (size_t)sk_constraint_rest_count(type, params);
    size_t indices = count * batch->arity, rests = count * batch->rest_count;
    batch->particle = sk_allocate(allocator, indices * sizeof *batch->particle);
    batch->slot = sk_allocate(allocator, indices * sizeof *batch->slot);
    batch->rest = sk_allocate(allocator, rests * sizeof *batch->rest);
    batch->scale = scale ? sk_allocate(allocator, count * sizeof *batch->scale) : NULL;
    if (!batch->particle || !batch->slot || !batch->rest || (scale && !batch->scale)) {
        sk_batch_release(batch, allocator);
        return NULL;
    }
    if (count) {
        memcpy(batch->particle, particles, indices * sizeof *particles);
        if (rests) memcpy(batch->rest, rest, rests * sizeof *rest);
        if (scale) memcpy(batch->scale, scale, count * sizeof *scale);
    }
    return batch;
}

static bool is_there(const sk_batch *batch) {
    return *batch->enabled && batch->count && !batch->broken && !batch->rests;
}

bool sk_batch_is_on(const sk_batch *batch) {
    return is_there(batch) && !batch->asleep;
}

bool sk_batch_pulls(const sk_batch *batch) {
    return sk_batch_is_on(batch) && !batch->only_bounds;
}

bool sk_batch_is_firm(const sk_batch *batch) {
    return sk_batch_pulls(batch) && batch->tether && *batch->tether < SK_UNBOUNDED && !(*batch->bound < SK_UNBOUNDED);
}

bool sk_batch_is_loaded(const sk_batch *batch) {
    return is_there(batch) && !batch->only_bounds;
}

/* ---- elements that are left out ---- */

/* By whom elements are judged. */
typedef struct judge {
    const sk_batch *batch;
    const sk_particles *particles;
    const sk_severing *severing; /* or NULL */
} judge;

/* An element's presence: that of the particle which is there least, and aside of one that is severed. */
static sk_presence presence_of(const judge *j, const uint32_t *particle) {
    sk_presence least = SK_HERE;
    for (size_t i = 0; i < j->batch->arity; i++)
        if (j->particles->presence[particle[i]] > least) least = j->particles->presence[particle[i]];
    bool severed = least <= SK_ASLEEP && j->severing && j->severing->severs(j->severing->data, j->batch, particle);
    return severed ? SK_ASIDE : least;
}

/* Looks at each element once, for that may take long; NULL when there is no memory. */
static sk_presence *look_at_all(const judge *j, const sk_elements *all, sk_allocator *allocator) {
    sk_presence *of = sk_allocate(allocator, (all->count + 1) * sizeof *of);
    for (size_t e = 0; of && e < all->count; e++) of[e] = presence_of(j, all->particle + e * j->batch->arity);
    return of;
}

static size_t count_up_to(const sk_presence *of, size_t all, sk_presence most) {
    size_t count = 0;
    for (size_t e = 0; e < all; e++) count += of[e] <= most;
    return count;
}

static void release_elements(sk_elements *elements, sk_allocator *allocator) {
    sk_release(allocator, elements->particle);
    sk_release(allocator, elements->rest);
    sk_release(allocator, elements->scale);
    *elements = (sk_elements){0, NULL, NULL, NULL};
}

/* Copies the elements whose presence is not beyond `most`; false when there is no memory. */
static bool copy_elements(const sk_batch *batch, const sk_elements *from, const sk_presence *of, sk_presence most,
                          sk_allocator *allocator, sk_elements *to) {
    size_t count = count_up_to(of, from->count, most), next = 0;
    *to = (sk_elements){count, sk_allocate(allocator, count * batch->arity * sizeof *to->particle),
                        sk_allocate(allocator, count * batch->rest_count * sizeof *to->rest),
                        from->scale ? sk_allocate(allocator, count * sizeof *to->scale) : NULL};
    if (!to->particle || !to->rest || (from->scale && !to->scale)) {
        release_elements(to, allocator);
        return false;
    }
    for (size_t e = 0; e < from->count; e++) {
        if (of[e] > most) continue;
        memcpy(to->particle + next * batch->arity, from->particle + e * batch->arity,
               batch->arity * sizeof *to->particle);
        for (size_t r = 0; r < batch->rest_count; r++) to->rest[r * count + next] = from->rest[r * from->count + e];
        if (from->scale) to->scale[next] = from->scale[e];
        next++;
    }
    return true;
}

static sk_elements elements_of(const sk_batch *batch) {
    return (sk_elements){batch->count, batch->particle, batch->rest, batch->scale};
}

static void set_elements(sk_batch *batch, const sk_elements *elements) {
    batch->count = elements->count, batch->particle = elements->particle;
    batch->rest = elements->rest, batch->scale = elements->scale;
}

bool sk_batch_leave_out(sk_batch *batch, sk_allocator *allocator, const sk_particles *particles) {
    return sk_batch_leave_out_severed(batch, allocator, particles, NULL);
}

/* Takes those that are here, and keeps all that are not gone. False when there is no memory: nothing has changed then. */
static bool leave_out(sk_batch *batch, const sk_elements *all, const sk_presence *of, sk_allocator *allocator) {
    sk_elements present = elements_of(batch), kept, now;
    if (!copy_elements(batch, all, of, SK_ASIDE, allocator, &kept)) return false;
    if (!copy_elements(batch, all, of, SK_ASLEEP, allocator, &now)) {
        release_elements(&kept, allocator);
        return false;
    }
    sk_batch_forget_sweeps(batch, allocator); // sweeps refer to elements by their old numbers
    release_elements(&batch->whole, allocator);
    release_elements(&present, allocator);
    set_elements(batch, &now);
    if (now.count == kept.count) release_elements(&kept, allocator);
    batch->whole = kept;
    return true;
}

bool sk_batch_leave_out_severed(sk_batch *batch, sk_allocator *allocator, const sk_particles *particles,
                                const sk_severing *severing) {
    const judge j = {batch, particles, severing};
    sk_elements present = elements_of(batch), all = batch->whole.particle ? batch->whole : present;
    sk_presence *of = look_at_all(&j, &all, allocator);
    if (!of) return false;
    size_t not_gone = count_up_to(of, all.count, SK_ASIDE), here = count_up_to(of, all.count, SK_ASLEEP);
    bool good = true;
    if (batch->enclosure) {
        batch->broken |= not_gone < all.count;
        batch->rests = here < all.count;
    } else if (not_gone < all.count || here != present.count || (here < all.count && severing)) {
        // as many as before are the same ones, but where a cut was mended and another made
        good = leave_out(batch, &all, of, allocator);
    }
    sk_release(allocator, of);
    return good;
}

void sk_batch_release(sk_batch *batch, sk_allocator *allocator) {
    if (!batch) return;
    sk_batch_forget_sweeps(batch, allocator);
    sk_enclosure_release(batch->enclosure, allocator);
    sk_aggregate_release(batch->aggregate, allocator);
    release_elements(&batch->whole, allocator);
    void *arrays[] = {batch->coarse,
                      batch->particle,
                      batch->slot,
                      batch->rest,
                      batch->scale,
                      batch->sweeps,
                      batch->lane,
                      batch->lane_rest,
                      batch->lane_stiffness,
                      batch->lane_compliance,
                      batch->lane_multiplier,
                      batch->special,
                      batch->found,
                      batch->pair};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) sk_release(allocator, arrays[i]);
    sk_release(allocator, batch);
}

double sk_batch_damping_time(const sk_batch *batch) {
    const sk_material *material = batch->params;
    return material->stiffness > 0 ? material->damping / material->stiffness : 0;
}

void sk_sweep_clear_multipliers(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    (void)run;
    const sk_sweep *sweep = op->rule;
    // an element of the op is a strip row, a slab or a group
    if (sweep->slab_start) begin = sweep->slab_start[begin], end = sweep->slab_start[end];
    size_t lanes = (sweep->strips ? sweep->walk.width : 1) * SK_LANES;
    memset(sweep->batch->lane_multiplier + sweep->first_lane + begin * lanes, 0, (end - begin) * lanes * sizeof(real));
}
