/* Energies and momenta. Sums are taken in blocks of 1,024 particles or elements in the user's order, so that
 * they do not depend on slots or threads. */
#include "world/world.h"

enum { SUM_BLOCK = 1024 };

/* What a block of particles adds up to. */
typedef struct block_sums {
    double kinetic, potential, momentum[3], angular[3];
} block_sums;

static void add_particle(const sk_rules *rules, double time, size_t particle, sk_vec4 x, sk_vec4 v, block_sums *sums) {
    double m = (double)v.w, p[3] = {(double)x.x, (double)x.y, (double)x.z};
    double u[3] = {(double)v.x, (double)v.y, (double)v.z};
    sums->kinetic += 0.5 * m * (u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
    for (int k = 0; k < 3; k++) {
        int next = (k + 1) % 3, last = (k + 2) % 3;
        sums->momentum[k] += m * u[k];
        sums->angular[k] += m * (p[next] * u[last] - p[last] * u[next]);
    }
    for (size_t f = 0; f < rules->forces.count; f++) {
        const sk_force *force = rules->forces.data[f];
        if (*force->enabled && force->type->potential && sk_only_has(&force->only, particle))
            sums->potential += force->type->potential(force->params, p, m, time);
    }
}

static void measure_particles(const skein_world *world, skein_statistics *s) {
    const sk_particles *all = &world->particles;
    for (size_t first = 0; first < all->count; first += SUM_BLOCK) {
        size_t last = first + SUM_BLOCK < all->count ? first + SUM_BLOCK : all->count;
        block_sums sums = {0};
        for (size_t i = first; i < last; i++) {
            sk_vec4 x = all->vector[SK_X][all->slot_of[i]];
            if (x.w > 0 && sk_particle_counts(all, i))
                add_particle(&world->rules, world->time, i, x, all->vector[SK_V][all->slot_of[i]], &sums);
        }
        s->kinetic_energy += sums.kinetic;
        s->potential_energy += sums.potential;
        for (int k = 0; k < 3; k++) {
            s->momentum[k] += sums.momentum[k];
            s->angular_momentum[k] += sums.angular[k];
        }
    }
}

static double batch_energy(const sk_batch *batch, double time, const sk_vec4 *x, size_t *guarded) {
    const sk_material *material = batch->params;
    double sum = 0, energy[SUM_BLOCK];
    bool rigid = material->stiffness >= SK_UNBOUNDED;
    for (size_t first = 0; first < batch->count; first += SUM_BLOCK) {
        size_t last = first + SUM_BLOCK < batch->count ? first + SUM_BLOCK : batch->count;
        double block = 0;
        *guarded += batch->type->energy(batch, time, x, first, last, energy);
        for (size_t e = first; e < last; e++)
            block += (batch->scale ? (double)batch->scale[e] : 1.0) * energy[e - first];
        sum += block;
    }
    return rigid ? 0 : material->stiffness * sum;
}

void sk_world_measure_energy(const skein_world *world, skein_statistics *statistics) {
    measure_particles(world, statistics);
    for (size_t i = 0; i < world->rules.batches.count; i++) {
        const sk_batch *batch = world->rules.batches.data[i];
        if (!sk_batch_is_loaded(batch)) continue;
        if (batch->type->whole_energy)
            statistics->elastic_energy +=
                batch->type->whole_energy(batch, world->particles.vector[SK_X], &statistics->guarded);
        else
            statistics->elastic_energy +=
                batch_energy(batch, world->time, world->particles.vector[SK_X], &statistics->guarded);
    }
}

/* ---- what gives it energy ---- */

static bool collider_moves(const sk_collider_common *common, bool deforms) {
    const double *v = common->velocity;
    return deforms || v[0] != 0 || v[1] != 0 || v[2] != 0 || common->spin != 0;
}

static bool pinned_particle_moves(const skein_world *world) {
    const sk_particles *all = &world->particles;
    for (size_t i = 0; i < all->count; i++) {
        uint32_t slot = all->slot_of[i];
        sk_vec4 v = all->vector[SK_V][slot];
        if (!(all->vector[SK_X][slot].w > 0) && (v.x != 0 || v.y != 0 || v.z != 0)) return true;
    }
    return false;
}

/* Whether energies are others at another time, with everything in the same place. */
static bool energy_depends_on_time(skein_world *world) {
    const double later = 0.37; // of no period that anybody would choose
    skein_statistics now = {0}, then = {0};
    double time = world->time;
    sk_world_measure_energy(world, &now);
    world->time = time + later;
    sk_world_measure_energy(world, &then);
    world->time = time;
    return now.potential_energy != then.potential_energy || now.elastic_energy != then.elastic_energy;
}

bool skein_world_is_driven(skein_world *world) {
    if (!world) return false;
    const sk_rules *rules = &world->rules;
    for (size_t i = 0; i < rules->forces.count; i++) {
        const sk_force *force = rules->forces.data[i];
        if (*force->enabled && !force->type->potential && !force->type->passive) return true;
    }
    for (size_t i = 0; i < rules->colliders.count; i++) {
        const sk_collider *collider = rules->colliders.data[i];
        if (!collider->common->enabled) continue;
        if (collider_moves(collider->common, collider->type->deforms)) return true;
        if (sk_collider_mass(collider) > 0) return true; // it cancels what pulls back what leaves (contact.c)
    }
    for (size_t i = 0; i < world->motions.count; i++)
        if (world->motions.data[i]->common->enabled) return true;            // wherever its pins may stand just now
    if (sk_world_fetch(world) || sk_world_arrange(world, NULL)) return true; // it cannot be said
    return pinned_particle_moves(world) || energy_depends_on_time(world);
}
