/* Measures of the present state. */
#include <string.h>

#include "base/hash.h"
#include "world/world.h"

uint64_t skein_world_hash(const skein_world *world) {
    if (!world) return 0;
    sk_world_fetch(world);
    uint64_t hash = SK_HASH_START;
    for (size_t i = 0; i < world->particles.count; i++) {
        uint32_t slot = world->particles.slot_of[i];
        if (!sk_particle_counts(&world->particles, i)) continue;
        for (sk_vector vector = SK_X; vector <= SK_V; vector++) {
            const sk_vec4 *p = &world->particles.vector[vector][slot];
            const real xyz[3] = {p->x, p->y, p->z};
            for (int k = 0; k < 3; k++) {
                uint64_t word = 0;
                memcpy(&word, &xyz[k], sizeof xyz[k]);
                hash = sk_hash_word(hash, word);
            }
        }
    }
    return hash;
}

static bool is_finite(sk_vec4 p) {
    return sk_abs(p.x) <= SK_REAL_MAX && sk_abs(p.y) <= SK_REAL_MAX && sk_abs(p.z) <= SK_REAL_MAX;
}

/* Free particles at which formulas of forces had to be guarded. */
static size_t count_guarded(const skein_world *world, const sk_force *force) {
    const sk_particles *all = &world->particles;
    size_t guarded = 0;
    for (size_t i = 0; i < all->count && *force->enabled && force->type->guarded; i++) {
        sk_vec4 x = all->vector[SK_X][all->slot_of[i]], v = all->vector[SK_V][all->slot_of[i]];
        const double p[3] = {(double)x.x, (double)x.y, (double)x.z}, u[3] = {(double)v.x, (double)v.y, (double)v.z};
        if (x.w > 0 && sk_particle_is_here(all, i) && sk_only_has(&force->only, i))
            guarded += force->type->guarded(force->params, p, u, world->time);
    }
    return guarded;
}

static void count_particles(const skein_world *world, skein_statistics *s) {
    const sk_particles *all = &world->particles;
    for (size_t i = 0; i < all->count; i++) {
        sk_vec4 v = all->vector[SK_V][all->slot_of[i]], x = all->vector[SK_X][all->slot_of[i]];
        if (!sk_particle_counts(all, i)) continue;
        s->nonfinite += !is_finite(v) || !is_finite(x);
        s->pinned_particles += !(x.w > 0);
    }
}

static real middle_of_three(real a, real b, real c) {
    return sk_max(sk_min(a, b), sk_min(sk_max(a, b), c));
}

/* The k-th least, from 0, which the order then has at k, and nothing less behind it (Hoare's selection). A sort would take as long as
 * a step of large meshes. */
static real put_kth(real *x, size_t count, size_t k) {
    for (size_t low = 0, high = count - 1; low < high;) {
        const real middle = middle_of_three(x[low], x[(low + high) / 2], x[high]);
        size_t i = low, j = high;
        while (i <= j) {
            while (x[i] < middle) i++;
            while (x[j] > middle) j--;
            if (i > j) break;
            const real other = x[i];
            x[i++] = x[j], x[j] = other;
            if (!j) break;
            j--;
        }
        if (k <= j) high = j;
        else if (k >= i) low = i;
        else break;
    }
    return x[k];
}

/* Those of a body that is not there do not count. */
static bool is_there(const skein_world *world, const sk_batch *batch) {
    return batch->count && !batch->only_bounds && !batch->rests && !batch->broken &&
           sk_particle_counts(&world->particles, batch->particle[0]);
}

/* A limit is kept to a tenth of itself, and to rounding. */
static void count_over_limit(const sk_batch *batch, const real *strain, skein_statistics *s) {
    static const double share = 0.1, rounding = 1e-5;
    if (!batch->bound || !(*batch->bound < SK_UNBOUNDED)) return;
    double bound = *batch->bound;
    s->limited += batch->count;
    for (size_t i = 0; i < batch->count; i++) {
        double over = (double)strain[i] - bound;
        s->over_limit += !(over <= share * bound + rounding);
        if (over > s->most_over_limit) s->most_over_limit = over;
    }
}

static skein_status measure_stretch(skein_world *world, skein_statistics *s, skein_error *error) {
    const sk_rules *rules = &world->rules;
    size_t edges = 0;
    for (size_t i = 0; i < rules->batches.count; i++) {
        if (!is_there(world, rules->batches.data[i])) continue;
        s->constraints += rules->batches.data[i]->type->enclose ? 1 : rules->batches.data[i]->count;
        if (rules->batches.data[i]->measured) edges += rules->batches.data[i]->count;
    }
    if (!edges) return SKEIN_OK;
    real *strain = sk_allocate(&world->allocator, edges * sizeof *strain);
    if (!strain) return sk_fail_memory(error, "statistics");
    size_t filled = 0;
    for (size_t i = 0; i < rules->batches.count; i++) {
        const sk_batch *batch = rules->batches.data[i];
        if (!batch->measured || !is_there(world, batch)) continue;
        batch->type->strain(batch, world->particles.vector[SK_X], 0, batch->count, strain + filled);
        count_over_limit(batch, strain + filled, s);
        filled += batch->count;
    }
    // NaN is in no order; it is counted as nonfinite anyway
    for (size_t i = 0; i < edges; i++)
        if (!(sk_abs(strain[i]) <= SK_REAL_MAX)) strain[i] = SK_REAL_MAX;
    const size_t at = (size_t)((double)(edges - 1) * 0.99);
    real most = 0;
    s->p99_stretch = (double)sk_max(put_kth(strain, edges, at), 0);
    for (size_t i = at; i < edges; i++) most = sk_max(most, strain[i]);
    s->max_stretch = (double)most;
    sk_release(&world->allocator, strain);
    return SKEIN_OK;
}

skein_status skein_world_statistics(skein_world *world, skein_statistics *statistics) {
    SK_NEED(world, world);
    SK_NEED(world, statistics);
    skein_error *error = sk_world_error(world);
    skein_status status = sk_world_fetch(world);
    memset(statistics, 0, sizeof *statistics);
    if (status) return status;
    const sk_particles *all = &world->particles;
    statistics->memory_bytes = world->allocator.bytes;
    statistics->steps = world->steps;
    statistics->substeps = world->substeps;
    statistics->time = world->time;
    statistics->residual = world->solve.residual;
    statistics->unsolved = world->solve.unsolved;
    statistics->newton_iterations = world->solve.newton_iterations;
    statistics->cg_iterations = world->solve.iterations;
    statistics->solver_factors = world->solve.factors;
    statistics->solver_failures = world->solve.failures;
    statistics->all_unsolved = world->unsolved;
    statistics->all_solver_failures = world->solver_failures;
    statistics->contact_overflows = world->contact_overflows;
    statistics->particles = all->count - all->out_count + all->asleep_count;
    statistics->asleep = all->asleep_count;
    status = sk_world_arrange(world, error); // the slots of new rules may not be known yet
    skein_error ignored;                     // a name that no body has is a step's to tell
    if (!status) sk_world_find_whom(world, &ignored);
    if (status) return status;
    count_particles(world, statistics);
    sk_world_measure_energy(world, statistics);
    if (world->steps)
        statistics->dissipated_energy = world->first_energy - statistics->kinetic_energy -
                                        statistics->potential_energy - statistics->elastic_energy;
    for (size_t i = 0; i < world->rules.colliders.count; i++) {
        const sk_collider *collider = world->rules.colliders.data[i];
        if (!collider->common->enabled) continue;
        for (size_t at = 0, first, end; sk_world_next_run(world, collider->common->on, &at, &first, &end);) {
            sk_collider_measure(collider, world->time, world->isa, all->vector[SK_X], all->slot_of + first, end - first,
                                &statistics->max_penetration, &statistics->contacts);
            statistics->guarded +=
                sk_collider_count_guarded(collider, world->time, all->vector[SK_X], all->slot_of + first, end - first);
        }
    }
    for (size_t i = 0; i < world->rules.forces.count; i++)
        statistics->guarded += count_guarded(world, world->rules.forces.data[i]);
    status = measure_stretch(world, statistics, error);
    if (!status) status = sk_world_count_crossings(world, &statistics->crossings, error);
    statistics->state_hash = skein_world_hash(world);
    return status;
}
