/* The state's memory: adding particles and strips, arranging slots, presence, and vectors that are made when needed. */
#include "particles/particles.h"

#include <string.h>

/* In narrower strips an element that leads two columns on could meet its own block (constraints/sweep.h). */
enum { LEAST_WIDTH = 3 };
/* Where a vector begins within a page, different for each (sk_allocate_shifted). */
static size_t apart(int vector) {
    return (size_t)vector * 11 * 64 % 4096;
}

/* Moves one array into a larger block; the new part is zero. */
static bool grow(sk_allocator *allocator, void **array, size_t old_count, size_t new_count, size_t size) {
    void *grown = sk_allocate(allocator, new_count * size);
    if (!grown) return false;
    if (*array && old_count) memcpy(grown, *array, old_count * size);
    sk_release(allocator, *array);
    *array = grown;
    return true;
}

static size_t room_for(size_t capacity, size_t need) {
    size_t room = capacity + capacity / 2 > need ? capacity + capacity / 2 : need;
    return (room + 15) / 16 * 16;
}

/* Temporaries hold nothing between steps: they go when slots change, and come back with the next plan. */
static void drop_temporaries(sk_particles *particles, sk_allocator *allocator) {
    for (int v = SK_T0; v < SK_VECTOR_COUNT; v++) {
        sk_release(allocator, particles->vector[v]);
        particles->vector[v] = NULL;
    }
}

bool sk_particles_want(sk_particles *particles, sk_allocator *allocator, uint32_t wanted) {
    for (int v = SK_T0; v < SK_VECTOR_COUNT; v++) {
        sk_vec4 **vector = &particles->vector[v];
        bool is_wanted = wanted >> v & 1;
        if (is_wanted == (*vector != NULL)) continue;
        sk_release(allocator, *vector);
        *vector =
            is_wanted ? sk_allocate_shifted(allocator, particles->slot_capacity * sizeof **vector, apart(v)) : NULL;
        if (is_wanted && !*vector) return false;
    }
    return true;
}

static bool reserve(sk_particles *particles, sk_allocator *allocator, size_t particle_need, size_t slot_need) {
    // each array grows by itself: if one fails, the others are merely larger than needed
    if (slot_need > particles->slot_capacity) {
        size_t old = particles->slot_capacity, room = room_for(old, slot_need);
        // temporaries, too: if there is no memory, the plan that named them is run on
        for (int v = SK_X; v < SK_VECTOR_COUNT; v++)
            if ((v < SK_T0 || particles->vector[v]) &&
                !grow(allocator, (void **)&particles->vector[v], old, room, sizeof(sk_vec4)))
                return false;
        if (!grow(allocator, (void **)&particles->particle_of, old, room, sizeof(uint32_t))) return false;
        particles->slot_capacity = room;
    }
    if (particle_need > particles->capacity) {
        size_t old = particles->capacity, room = room_for(old, particle_need);
        if (!grow(allocator, (void **)&particles->slot_of, old, room, sizeof(uint32_t)) ||
            !grow(allocator, (void **)&particles->place, old, room, sizeof(uint32_t)) ||
            !grow(allocator, (void **)&particles->rank, old, room, sizeof(uint32_t)) ||
            !grow(allocator, (void **)&particles->built, old, room, sizeof(sk_vec3)) ||
            !grow(allocator, (void **)&particles->mass, old, room, sizeof(real)) ||
            !grow(allocator, (void **)&particles->pinned, old, room, sizeof(bool)) ||
            !grow(allocator, (void **)&particles->presence, old, room, sizeof(uint8_t)))
            return false;
        particles->capacity = room;
    }
    return true;
}

bool sk_particles_add(sk_particles *particles, sk_allocator *allocator, size_t count, const double *positions,
                      const double *velocities, const double *masses) {
    size_t first_slot = particles->slot_end, slots = (count + 15) / 16 * 16;
    if (!reserve(particles, allocator, particles->count + count, first_slot + slots + 16)) return false;
    for (size_t s = first_slot; s < first_slot + slots; s++) particles->particle_of[s] = SK_NOBODY;
    for (size_t k = 0; k < count; k++) {
        size_t i = particles->count + k, s = first_slot + k;
        const double *p = positions + 3 * k, *v = velocities ? velocities + 3 * k : (const double[3]){0, 0, 0};
        real mass = (real)masses[k];
        particles->slot_of[i] = (uint32_t)s;
        particles->particle_of[s] = (uint32_t)i;
        particles->rank[i] = (uint32_t)i;
        particles->built[i] = sk_v3_of(p);
        particles->mass[i] = mass;
        particles->pinned[i] = !(mass > 0);
        particles->presence[i] = SK_HERE;
        particles->vector[SK_X][s] = (sk_vec4){(real)p[0], (real)p[1], (real)p[2], mass > 0 ? 1 / mass : 0};
        particles->vector[SK_V][s] = (sk_vec4){(real)v[0], (real)v[1], (real)v[2], mass};
        particles->vector[SK_PREVIOUS][s] = particles->vector[SK_X][s];
    }
    particles->count += count;
    particles->slot_end += slots;
    particles->arranged = false;
    return true;
}

uint32_t sk_strip_width(uint32_t columns) {
    uint32_t width = (columns + 15) / 16;
    return width < LEAST_WIDTH ? LEAST_WIDTH : width;
}

bool sk_particles_add_strips(sk_particles *particles, sk_allocator *allocator, sk_strips strips, const uint32_t *place) {
    if (!SK_RESERVE(allocator, &particles->strips, particles->strips.count + 1)) return false;
    strips.width = sk_strip_width(strips.columns);
    for (uint32_t i = 0; i < strips.count; i++) particles->place[strips.first_particle + i] = place ? place[i] : i;
    particles->strips.data[particles->strips.count++] = strips;
    particles->arranged = false;
    return true;
}

void sk_particles_truncate(sk_particles *particles, size_t count) {
    for (size_t i = count; i < particles->count; i++) {
        uint32_t slot = particles->slot_of[i];
        particles->particle_of[slot] = SK_NOBODY;
        for (int v = SK_X; v < SK_T0; v++) particles->vector[v][slot] = (sk_vec4){0, 0, 0, 0};
    }
    while (particles->strips.count && particles->strips.data[particles->strips.count - 1].first_particle >= count)
        particles->strips.count--;
    particles->count = count;
}

/* ---- which particles take part ---- */

void sk_particles_set_presence(sk_particles *particles, size_t first, size_t count, sk_presence presence) {
    for (size_t i = first; i < first + count; i++) {
        uint32_t slot = particles->slot_of[i];
        particles->out_count -= particles->presence[i] != SK_HERE;
        particles->gone_count -= particles->presence[i] == SK_GONE;
        particles->asleep_count -= particles->presence[i] == SK_ASLEEP;
        particles->presence[i] = (uint8_t)presence;
        particles->out_count += presence != SK_HERE;
        particles->gone_count += presence == SK_GONE;
        particles->asleep_count += presence == SK_ASLEEP;
        particles->vector[SK_PREVIOUS][slot] = particles->vector[SK_X][slot]; // nothing to blend between
        if (presence != SK_GONE) continue;
        for (int v = SK_X; v < SK_T0; v++) particles->vector[v][slot] = (sk_vec4){0, 0, 0, 0};
        particles->rank[i] = (uint32_t)i;
        particles->mass[i] = 0;
        particles->pinned[i] = true;
        particles->built[i] = (sk_vec3){0, 0, 0};
    }
    size_t kept = 0;
    for (size_t s = 0; s < particles->strips.count; s++) {
        const sk_strips strips = particles->strips.data[s];
        bool mine = strips.first_particle >= first && strips.first_particle < first + count;
        if (presence != SK_GONE || !mine) particles->strips.data[kept++] = strips;
    }
    particles->strips.count = kept;
    particles->arranged = false;
}

size_t sk_particles_find_room(const sk_particles *particles, size_t first, size_t count) {
    size_t run = 0;
    for (size_t i = 0; i < first && particles->gone_count; i++) {
        run = particles->presence[i] == SK_GONE ? run + 1 : 0;
        if (run == count && count) return i + 1 - run;
    }
    return first - run; // moves down over the particles before it that are gone
}

void sk_particles_renumber(sk_particles *particles, size_t first, size_t target) {
    size_t count = particles->count - first, offset = first - target;
    if (!offset) return;
    for (size_t k = 0; k < count; k++) {
        size_t i = target + k, old = first + k;
        particles->gone_count -= particles->presence[i] == SK_GONE;
        particles->out_count -= particles->presence[i] == SK_GONE;
        particles->presence[i] = particles->presence[old];
        particles->slot_of[i] = particles->slot_of[old];
        particles->place[i] = particles->place[old];
        particles->rank[i] = particles->rank[old] - (uint32_t)offset;
        particles->built[i] = particles->built[old];
        particles->mass[i] = particles->mass[old];
        particles->pinned[i] = particles->pinned[old];
        particles->particle_of[particles->slot_of[i]] = (uint32_t)i;
    }
    for (size_t s = 0; s < particles->strips.count; s++)
        if (particles->strips.data[s].first_particle >= first)
            particles->strips.data[s].first_particle -= (uint32_t)offset;
    particles->count = target + count > first ? target + count : first;
    particles->arranged = false;
}

bool sk_particles_next_run(const sk_particles *particles, size_t *first, size_t *end) {
    while (*first < particles->count && !sk_particle_counts(particles, *first)) ++*first;
    *end = particles->out_count ? *first : particles->count;
    while (*end < particles->count && sk_particle_counts(particles, *end)) ++*end;
    return *first < particles->count;
}

/* ---- slots ---- */

static void swap(uint32_t **a, uint32_t **b) {
    uint32_t *kept = *a;
    *a = *b;
    *b = kept;
}

static bool takes_part(const sk_particles *particles, const sk_strips *strips) {
    return particles->presence[strips->first_particle] == SK_HERE;
}

/* Writes every particle's slot into `slot_of`: strips first, and those that take no part from `behind` on. */
static void number_slots(sk_particles *particles, const uint32_t *by_rank, size_t behind, uint32_t *slot_of) {
    size_t next = 0;
    memset(slot_of, 0xff, particles->count * sizeof *slot_of);
    for (size_t s = 0; s < particles->strips.count; s++) {
        sk_strips *strips = &particles->strips.data[s];
        strips->first_slot = takes_part(particles, strips) ? next : SIZE_MAX;
        if (strips->first_slot == SIZE_MAX) continue;
        for (uint32_t i = 0; i < strips->count; i++) {
            uint32_t particle = strips->first_particle + i, place = particles->place[particle];
            size_t r = place / strips->columns, c = place % strips->columns;
            slot_of[particle] = (uint32_t)(next + (r * strips->width + c % strips->width) * 16 + c / strips->width);
        }
        next += (size_t)strips->rows * strips->width * 16;
    }
    for (size_t k = 0; k < particles->count; k++) {
        uint32_t i = by_rank[k];
        if (slot_of[i] == UINT32_MAX && particles->presence[i] == SK_HERE) slot_of[i] = (uint32_t)next++;
    }
    for (size_t i = 0; i < particles->count; i++)
        if (particles->presence[i] == SK_ASLEEP || particles->presence[i] == SK_ASIDE) slot_of[i] = (uint32_t)behind++;
    for (size_t i = 0; i < particles->count; i++)
        if (particles->presence[i] == SK_GONE) slot_of[i] = (uint32_t)behind;
}

bool sk_particles_arrange(sk_particles *particles, sk_allocator *allocator) {
    if (particles->arranged) return true;
    size_t strip_slots = 0, loose = particles->count - particles->out_count, slabs = 0;
    for (size_t s = 0; s < particles->strips.count; s++) {
        const sk_strips *strips = &particles->strips.data[s];
        if (!takes_part(particles, strips)) continue;
        strip_slots += (size_t)strips->rows * strips->width * 16;
        loose -= strips->count;
        if (strips->rows > slabs) slabs = strips->rows;
    }
    size_t empty_slot = strip_slots + (loose + 15) / 16 * 16, slot_count = empty_slot + 16;
    size_t behind = particles->out_count ? (particles->out_count - particles->gone_count + 1 + 15) / 16 * 16 : 0;
    size_t slab = SK_SLAB_BLOCKS * 16;
    if ((loose + slab - 1) / slab > slabs) slabs = (loose + slab - 1) / slab;
    size_t spares = (slabs * SK_SLAB_SPARES + 15) / 16 * 16, slot_end = slot_count + spares + behind;
    if (slot_end > UINT32_MAX) return false;
    // makes all new arrays first, so that a failure changes nothing
    uint32_t *slot_of = sk_allocate(allocator, particles->capacity * sizeof *slot_of);
    sk_vec4 *vector[SK_VECTOR_COUNT] = {NULL};
    uint32_t *by_rank = sk_allocate(allocator, particles->count * sizeof *by_rank);
    uint32_t *particle_of = sk_allocate(allocator, slot_end * sizeof *particle_of);
    bool good = slot_of && by_rank && particle_of;
    for (size_t i = 0; i < particles->count && good; i++) by_rank[particles->rank[i]] = (uint32_t)i;
    for (int v = SK_X; v < SK_T0 && good; v++)
        good = (vector[v] = sk_allocate_shifted(allocator, slot_end * sizeof(sk_vec4), apart(v))) != NULL;
    if (good) {
        number_slots(particles, by_rank, slot_count + spares, slot_of);
        for (int v = SK_X; v < SK_T0; v++)
            for (size_t i = 0; i < particles->count; i++)
                if (particles->presence[i] != SK_GONE)
                    vector[v][slot_of[i]] = particles->vector[v][particles->slot_of[i]];
        for (int v = SK_X; v < SK_T0; v++) {
            sk_vec4 *old = particles->vector[v];
            particles->vector[v] = vector[v];
            vector[v] = old;
        }
        memset(particle_of, 0xff, slot_end * sizeof *particle_of);
        for (size_t i = 0; i < particles->count; i++)
            if (particles->presence[i] != SK_GONE) particle_of[slot_of[i]] = (uint32_t)i;
        swap(&particles->slot_of, &slot_of);
        swap(&particles->particle_of, &particle_of);
        drop_temporaries(particles, allocator);
        particles->slot_count = slot_count;
        particles->slot_end = particles->slot_capacity = slot_end;
        particles->strip_slots = strip_slots;
        particles->empty_slot = empty_slot;
        particles->spare_slot = slot_count;
        particles->spare_slabs = slabs;
        particles->arranged = true;
    }
    for (int v = SK_X; v < SK_T0; v++) sk_release(allocator, vector[v]);
    sk_release(allocator, slot_of);
    sk_release(allocator, particle_of);
    sk_release(allocator, by_rank);
    return good;
}

void sk_particles_forget(sk_particles *particles) {
    if (particles->vector[SK_F]) memset(particles->vector[SK_F], 0, particles->slot_count * sizeof(sk_vec4));
    for (int v = SK_X; v <= SK_PREVIOUS && particles->arranged; v++)
        for (size_t s = 0; particles->vector[v] && s < particles->slot_end; s++)
            if (particles->particle_of[s] == SK_NOBODY) particles->vector[v][s] = (sk_vec4){0, 0, 0, 0};
}

void sk_particles_reset(sk_particles *particles) {
    for (size_t i = 0; i < particles->count; i++) {
        uint32_t s = particles->slot_of[i];
        sk_vec3 p = particles->built[i];
        if (particles->presence[i] == SK_GONE) continue;
        particles->vector[SK_X][s] = (sk_vec4){p.x, p.y, p.z, particles->vector[SK_X][s].w};
        particles->vector[SK_V][s] = (sk_vec4){0, 0, 0, particles->vector[SK_V][s].w};
        particles->vector[SK_PREVIOUS][s] = particles->vector[SK_X][s];
    }
    sk_particles_forget(particles);
}

void sk_particle_pin(sk_particles *particles, size_t particle, bool pinned) {
    uint32_t s = particles->slot_of[particle];
    real mass = particles->mass[particle];
    if (particles->presence[particle] == SK_GONE) return;
    particles->pinned[particle] = pinned || !(mass > 0);
    particles->vector[SK_X][s].w = particles->vector[SK_PREVIOUS][s].w = particles->pinned[particle] ? 0 : 1 / mass;
    if (pinned) particles->vector[SK_V][s] = (sk_vec4){0, 0, 0, particles->vector[SK_V][s].w};
}

void sk_particles_release(sk_particles *particles, sk_allocator *allocator) {
    for (int v = SK_X; v < SK_VECTOR_COUNT; v++) sk_release(allocator, particles->vector[v]);
    sk_release(allocator, particles->slot_of);
    sk_release(allocator, particles->particle_of);
    sk_release(allocator, particles->place);
    sk_release(allocator, particles->rank);
    sk_release(allocator, particles->built);
    sk_release(allocator, particles->mass);
    sk_release(allocator, particles->pinned);
    sk_release(allocator, particles->presence);
    sk_release(allocator, particles->strips.data);
    memset(particles, 0, sizeof *particles);
}
