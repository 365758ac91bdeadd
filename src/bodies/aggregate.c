/* Making the aggregates of a mesh, each of the hubs of the finer one before it, up to the coarsest.
 *
 * Measured on irregular meshes let go from level that swing by two corners, 10 substeps, a little drag, 99th percentile and largest
 * stretch, the worst of all frames: 64 x 64 2.9 and 12 % (with spans alone 3.0 and 12), 128 x 128 2.8 and 22 (3.8 and 22), for 1.4 times the time.
 * Where all hubs stood for themselves: 1.5 and 7.6, and 3.0 and 20; but meshes of regular triangles that hung by four corners blew up. Those
 * of the finest level by a half or not at all 3.0 and 3.3 % of 128 x 128; altogether 2.6, but ten times the energy at rest. Shares that are exact for whatever
 * moves as a plane does (moving least squares) are no better. Shares squared, distances up to 3 spacings,
 * and four sweeps change 64 by 0.2 % and 128 by 0.4, either way; one sweep costs 0.1 to 0.15; spacings that begin at 4 edges 0.7.
 * A reach of 1.6 has 1.3 times as many hubs to take shares of as 1.4, one of 1.25 four fifths: 64 x 64 1.88, 1.81 and 1.75 % (most 8.1, 7.9, 7.8), 128 x 128
 * 1.35, 1.31 and 1.32 (14, 13, 11.5), 180 x 180 1.44, 1.42 and 1.42 (17, 14, 12); but a roof that hangs by two corners 29, 32 and 62 % at most. */
#include "bodies/aggregate.h"

#include <math.h>
#include <string.h>

#include "base/status.h"
#include "bodies/geodesic.h"
#include "constraints/aggregate.h"

enum {
    MOST_LEVELS = 8,
    LEAST_HUBS = 9,         /* of the coarsest */
    LEAST_PARTICLES = 2000, /* smaller meshes are firm enough with spans, and faster */
    SWEEPS = 2              /* of its distances, forth and back */
};
static const double reach = 1.4, /* hubs' distances that a vertex takes shares up to: a hub is within one */
    long_way = 2,                /* hubs that are nearer have a distance */
    finest_itself = 0.75;        /* hubs of the finest level stand for themselves so far, and so are firmer */

/* A hub that a member of the finer level is near. */
typedef struct tie {
    uint32_t member, hub; /* places in both levels */
    double distance;
} tie;

typedef struct level {
    uint32_t *particle; /* its members, or hubs, in the order of their ranks */
    double *mass;       /* that goes with each */
    double (*mean)[3];  /* of the places, as they were built, of all that goes with each */
    size_t count;
    struct {
        tie *data;
        size_t count, capacity;
    } ties, pairs; /* of members of the finer one with these hubs; of these hubs with each other (member, hub) */
} level;

typedef struct builder {
    sk_allocator *allocator;
    sk_geodesic *geodesic;
    const sk_sheet *sheet;
    const double *mass; /* of particles */
    const bool *pinned;
    double edge;                  /* m: a mean one */
    level level[MOST_LEVELS + 1]; /* the first: all particles */
    size_t count;
    uint32_t *place;  /* of particles: in the finer level, or UINT32_MAX */
    uint32_t *hub_at; /* of particles: in the level in the making, or UINT32_MAX */
    bool *covered;    /* of particles */
    /* in the search from a hub: */
    double spacing;
    level *now;
    uint32_t hub;
    bool no_memory;
} builder;

static double apart(const double *a, const double *b) {
    return hypot(hypot(a[0] - b[0], a[1] - b[1]), a[2] - b[2]);
}

static void see(void *user, uint32_t particle, double distance) {
    builder *b = user;
    level *l = b->now;
    if (b->place[particle] == UINT32_MAX || b->no_memory) return;
    if (distance < b->spacing) b->covered[particle] = true;
    if (b->hub_at[particle] != UINT32_MAX && b->hub_at[particle] != b->hub && distance < long_way * b->spacing) {
        b->no_memory |= !SK_RESERVE(b->allocator, &l->pairs, l->pairs.count + 1);
        if (!b->no_memory) l->pairs.data[l->pairs.count++] = (tie){b->hub_at[particle], b->hub, distance};
    }
    if (distance < reach * b->spacing && distance > 0) {
        b->no_memory |= !SK_RESERVE(b->allocator, &l->ties, l->ties.count + 1);
        if (!b->no_memory) l->ties.data[l->ties.count++] = (tie){b->place[particle], b->hub, distance};
    }
}

/* Takes members as hubs, in their order, that are not within the spacing of one. False when there is no memory. */
static bool choose_hubs(builder *b, const level *finer, level *l) {
    b->now = l;
    l->particle = sk_allocate(b->allocator, finer->count * sizeof *l->particle);
    if (!l->particle) return false;
    for (size_t i = 0; i < finer->count; i++) {
        const uint32_t particle = finer->particle[i];
        b->place[particle] = (uint32_t)i;
        b->hub_at[particle] = UINT32_MAX;
        b->covered[particle] = false;
    }
    for (size_t i = 0; i < finer->count && !b->no_memory; i++) {
        const uint32_t particle = finer->particle[i];
        if (b->covered[particle]) continue;
        b->hub = (uint32_t)l->count;
        b->hub_at[particle] = b->hub;
        l->particle[l->count++] = particle;
        if (!sk_geodesic_near(b->geodesic, particle, long_way * b->spacing, see, b)) return false;
    }
    return !b->no_memory;
}

static double share_of(const builder *b, const tie *t) {
    return 1 - t->distance / (reach * b->spacing);
}

/* How much of what hub i of the level in the making stands for is its own place, and how much a member's place by a tie; and whether it
 * was built pinned, or carries nothing, and stands for itself. */
static double own_part(const builder *b, const level *finer, const level *l, size_t i) {
    const double itself = b->count == 1 ? finest_itself : 0, mass = finer->mass[b->place[l->particle[i]]];
    return l->mass[i] > 0 ? itself + (1 - itself) * mass / l->mass[i] : 1;
}

static double part_of(const builder *b, const level *finer, const level *l, const double *sum, const tie *t) {
    const double itself = b->count == 1 ? finest_itself : 0, mass = finer->mass[t->member];
    return l->mass[t->hub] > 0 ? (1 - itself) * share_of(b, t) / sum[t->member] * mass / l->mass[t->hub] : 0;
}

static bool is_alone(const builder *b, const level *l, size_t i) {
    return b->pinned[l->particle[i]] || !(l->mass[i] > 0);
}

static bool is_hub(const builder *b, const level *finer, size_t member) {
    return b->hub_at[finer->particle[member]] != UINT32_MAX;
}

static void add_times(double to[3], double factor, const double *place) {
    for (int c = 0; c < 3; c++) to[c] += factor * place[c];
}

/* Where what hubs stand for was built. */
static void find_means(const builder *b, const level *finer, level *l, const double *sum) {
    memset(l->mean, 0, l->count * sizeof *l->mean);
    for (size_t i = 0; i < l->count; i++)
        add_times(l->mean[i], is_alone(b, l, i) ? 1 : own_part(b, finer, l, i), finer->mean[b->place[l->particle[i]]]);
    for (size_t i = 0; i < l->ties.count; i++) {
        const tie *t = &l->ties.data[i];
        if (is_hub(b, finer, t->member) || is_alone(b, l, t->hub)) continue;
        add_times(l->mean[t->hub], part_of(b, finer, l, sum, t), finer->mean[t->member]);
    }
}

/* The sums of what each member takes, and what hubs carry. */
static bool sum_up(builder *b, const level *finer, level *l, double *sum) {
    l->mass = sk_allocate(b->allocator, l->count * sizeof *l->mass);
    l->mean = sk_allocate(b->allocator, l->count * sizeof *l->mean);
    if (!l->mass || !l->mean) return false;
    memset(sum, 0, finer->count * sizeof *sum);
    for (size_t i = 0; i < l->ties.count; i++) sum[l->ties.data[i].member] += share_of(b, &l->ties.data[i]);
    for (size_t i = 0; i < l->count; i++) l->mass[i] = finer->mass[b->place[l->particle[i]]];
    for (size_t i = 0; i < l->ties.count; i++) {
        const tie *t = &l->ties.data[i];
        if (is_hub(b, finer, t->member)) continue; // it goes its own way
        l->mass[t->hub] += share_of(b, t) / sum[t->member] * finer->mass[t->member];
    }
    find_means(b, finer, l, sum);
    return true;
}

/* Deals ties to what is carried, and to hubs, whose ties follow each other: in pairs, an odd one with one of 0 after it. `row` is a
 * member's place among what is carried, or UINT32_MAX; `next` has room for all carried ones. */
static void deal_ties(const builder *b, const level *finer, const level *l, const double *sum, const uint32_t *row,
                      uint32_t *next, sk_aggregate *a) {
    for (size_t i = 0; i < l->ties.count; i++)
        if (row[l->ties.data[i].member] != UINT32_MAX) a->start[row[l->ties.data[i].member] + 1]++;
    for (size_t i = 0; i < a->count; i++) {
        next[i] = a->start[i];
        a->start[i + 1] += a->start[i] + a->start[i + 1] % 2;
    }
    size_t part = 0;
    for (size_t hub = 0, i = 0; hub < a->hub_count; hub++) {
        for (; i < l->ties.count && l->ties.data[i].hub == hub; i++) {
            const tie *t = &l->ties.data[i];
            if (row[t->member] == UINT32_MAX) continue;
            const uint32_t at = next[row[t->member]]++;
            a->of[at] = t->hub;
            a->share[at] = (real)(share_of(b, t) / sum[t->member]);
            a->from[part] = row[t->member];
            a->part[part++] = (real)part_of(b, finer, l, sum, t);
        }
        part += part % 2;
        a->first_part[hub + 1] = (uint32_t)part;
    }
}

/* What is carried, in the order of members. */
static sk_aggregate *carried_by(const builder *b, const level *finer, const level *l, const double *sum,
                                uint32_t first) {
    size_t carried = finer->count - l->count, parts = 0, next = 0;
    for (size_t i = 0; i < l->ties.count; i++) parts += !is_hub(b, finer, l->ties.data[i].member);
    sk_aggregate *a = sk_aggregate_create(b->allocator, l->count, carried, parts + carried, parts + l->count);
    uint32_t *row = sk_allocate(b->allocator, (finer->count + carried) * sizeof *row);
    if (!a || !row) {
        sk_aggregate_release(a, b->allocator);
        sk_release(b->allocator, row);
        return NULL;
    }
    a->times = SWEEPS;
    for (size_t i = 0; i < l->count; i++) {
        a->hub[i] = first + l->particle[i];
        a->pinned[i] = is_alone(b, l, i);
        a->own[i] = (real)own_part(b, finer, l, i);
    }
    for (size_t i = 0; i < finer->count; i++) {
        row[i] = UINT32_MAX;
        if (is_hub(b, finer, i)) continue;
        a->particle[next] = first + finer->particle[i];
        row[i] = (uint32_t)next++;
    }
    deal_ties(b, finer, l, sum, row, row + finer->count, a);
    sk_release(b->allocator, row);
    return a;
}

/* How far apart what two hubs stand for may be: as far as it was built; but where a sheet is bent, as far as when it is
 * spread out, at least. A distance along an arc is longer than its chord, and what is around its ends lies off it by about as
 * much again. */
static double length_of(const builder *b, const level *l, const tie *pair) {
    const double *first = b->sheet->position[l->particle[pair->member]],
                 *second = b->sheet->position[l->particle[pair->hub]];
    const double chord = apart(first, second), bent = chord > 0 ? fmax(1, pair->distance / chord) : 1;
    return bent * bent * apart(l->mean[pair->member], l->mean[pair->hub]);
}

static skein_status add_batch(const builder *b, const level *l, sk_aggregate *a, skein_world *world, sk_body *body,
                              skein_error *error) {
    const size_t count = l->pairs.count;
    uint32_t *pairs = sk_allocate(b->allocator, 2 * count * sizeof *pairs);
    real *rest = sk_allocate(b->allocator, 3 * count * sizeof *rest);
    skein_status status = pairs && rest ? SKEIN_OK : sk_fail_memory(error, "aggregate");
    for (size_t e = 0; e < count && !status; e++) {
        const uint32_t ends[] = {l->pairs.data[e].member, l->pairs.data[e].hub};
        rest[e] = (real)length_of(b, l, &l->pairs.data[e]);
        for (int k = 0; k < 2; k++) {
            const uint32_t particle = l->particle[ends[k]];
            pairs[2 * e + (size_t)k] = body->first_particle + particle;
            rest[(1 + (size_t)k) * count + e] = (real)(b->mass[particle] / l->mass[ends[k]]);
        }
    }
    if (!status)
        status = sk_world_add_body_batch(world, body, &sk_coarse_distance, "aggregate", (sk_material){0, 0}, false,
                                         count, pairs, rest, NULL, error);
    if (!status) sk_world_bound_aggregate(body, &body->tether_bound, a);
    else sk_aggregate_release(a, b->allocator);
    sk_release(b->allocator, pairs);
    sk_release(b->allocator, rest);
    return status;
}

static bool begin(builder *b, const sk_sheet *sheet, const double *mass, const bool *pinned, const uint32_t *rank) {
    const size_t count = sheet->particle_count;
    level *all = &b->level[0];
    double sum = 0;
    size_t edges = 0;
    b->allocator = sheet->allocator;
    b->sheet = sheet, b->mass = mass, b->pinned = pinned;
    b->geodesic = sk_geodesic_create(sheet);
    b->place = sk_allocate(b->allocator, count * sizeof *b->place);
    b->hub_at = sk_allocate(b->allocator, count * sizeof *b->hub_at);
    b->covered = sk_allocate(b->allocator, count * sizeof *b->covered);
    all->particle = sk_allocate(b->allocator, count * sizeof *all->particle);
    all->mass = sk_allocate(b->allocator, count * sizeof *all->mass);
    all->mean = sk_allocate(b->allocator, count * sizeof *all->mean);
    if (!b->geodesic || !b->place || !b->hub_at || !b->covered || !all->particle || !all->mass || !all->mean)
        return false;
    for (size_t i = 0; i < count; i++) all->particle[rank[i]] = (uint32_t)i;
    for (size_t i = 0; i < count; i++) all->mass[i] = mass[all->particle[i]];
    for (size_t i = 0; i < count; i++) memcpy(all->mean[i], sheet->position[all->particle[i]], sizeof *all->mean);
    all->count = count;
    b->count = 1;
    for (size_t f = 0; f < sheet->face_count; f++) {
        const uint32_t *c = sheet->corners + sheet->face_start[f];
        const size_t size = sheet->face_start[f + 1] - sheet->face_start[f];
        for (size_t k = 0; k < size; k++, edges++) {
            sum += apart(sheet->position[c[k]], sheet->position[c[(k + 1) % size]]);
        }
    }
    b->edge = edges ? sum / (double)edges : 0;
    return true;
}

static void end(builder *b) {
    for (size_t k = 0; k <= MOST_LEVELS; k++) {
        sk_release(b->allocator, b->level[k].particle);
        sk_release(b->allocator, b->level[k].mass);
        sk_release(b->allocator, b->level[k].mean);
        sk_release(b->allocator, b->level[k].ties.data);
        sk_release(b->allocator, b->level[k].pairs.data);
    }
    sk_geodesic_release(b->geodesic);
    sk_release(b->allocator, b->place);
    sk_release(b->allocator, b->hub_at);
    sk_release(b->allocator, b->covered);
}

/* Marks hubs of the coarsest level but one: some dozens. */
static void mark_held(const builder *b, size_t coarsest, bool *held) {
    const level *l = &b->level[coarsest > 1 ? coarsest - 1 : coarsest];
    for (size_t i = 0; i < l->count && coarsest; i++) held[l->particle[i]] = true;
}

skein_status sk_aggregates_add(const sk_sheet *sheet, const double *mass, const bool *pinned, const uint32_t *rank,
                               skein_world *world, sk_body *body, sk_held_hubs *held, skein_error *error) {
    builder *b = sk_allocate(sheet->allocator, sizeof *b);
    sk_aggregate *made[MOST_LEVELS + 1] = {NULL};
    double *sum = sk_allocate(sheet->allocator, (sheet->particle_count + 1) * sizeof *sum);
    bool good = b && sum && begin(b, sheet, mass, pinned, rank);
    for (; good && b->edge > 0 && sheet->particle_count >= LEAST_PARTICLES && !sheet->grid_rows &&
           b->count <= MOST_LEVELS;
         b->count++) {
        const level *finer = &b->level[b->count - 1];
        level *l = &b->level[b->count];
        b->spacing = b->edge * pow(2, (double)b->count);
        for (size_t i = 0; i < sheet->particle_count; i++) b->place[i] = UINT32_MAX;
        good = choose_hubs(b, finer, l);
        if (!good || l->count < LEAST_HUBS || l->count == finer->count || !l->pairs.count) break;
        good =
            sum_up(b, finer, l, sum) && (made[b->count] = carried_by(b, finer, l, sum, body->first_particle)) != NULL;
    }
    skein_status status = good ? SKEIN_OK : sk_fail_memory(error, "aggregate");
    size_t coarsest = MOST_LEVELS;
    while (coarsest && !made[coarsest]) coarsest--;
    *held = (sk_held_hubs){.edge = b ? b->edge : 0};
    if (!status && coarsest) {
        held->is = sk_allocate(sheet->allocator, sheet->particle_count * sizeof *held->is);
        if (held->is) mark_held(b, coarsest, held->is);
        else status = sk_fail_memory(error, "aggregate");
    }
    for (size_t k = 1; k <= coarsest; k++) made[k]->finer = made[k - 1], made[k]->coarsest = k == coarsest;
    for (size_t k = coarsest + 1; k-- > 1;) {
        if (!status) status = add_batch(b, &b->level[k], made[k], world, body, error);
        else sk_aggregate_release(made[k], sheet->allocator);
    }
    if (b && b->allocator) end(b);
    sk_release(sheet->allocator, sum);
    sk_release(sheet->allocator, b);
    return status;
}
