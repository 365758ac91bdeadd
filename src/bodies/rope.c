/* A rope: particles in a line, with springs to the next one and to the one after that. It is a lattice of
 * count x 1 x 1 with a friendlier name: its stiffness is the rope's own, the force at which it would be twice
 * as long, so that it hangs and swings the same with any number of particles.
 *
 *   from o--o--o--o--o--o to          a longer one than the way between its ends hangs as at rest:  o       o
 *         \___/ bend                                                                                \_o_o_/ */
#include <math.h>
#include <string.h>

#include "base/elementary.h"
#include "bodies/block.h"
#include "bodies/body.h"

typedef struct rope_params {
    int32_t count;
    double from[3], to[3], length, velocity[3], density;
    char *pins;
    sk_material stretch, bend;
    double limit, tether;
} rope_params;

static const skein_field fields[] = {
    SK_INT(rope_params, count, "count", "", 33, 2, 1000000, "particles from end to end"),
    SK_VEC3(rope_params, from, "from", "m", 0, 0, 0, "its first particle"),
    SK_VEC3(rope_params, to, "to", "m", 1, 0, 0, "its last particle, or the way to go there"),
    SK_REAL(rope_params, length, "length", "m", 0, 0, 1e9,
            "0: from one end to the other; a longer one hangs between them, a shorter one ends before"),
    SK_VEC3(rope_params, velocity, "velocity", "m/s", 0, 0, 0, "at the start"),
    SK_REAL(rope_params, density, "density", "kg/m", 0.1, 1e-9, 1e9, "mass of a metre, shared out equally"),
    SK_TEXT(rope_params, pins, "pins", "",
            "pinned particles: \"first\", \"last\", numbers, \"box x y z x y z\", \"sphere x y z r\""),
    SK_REAL(rope_params, stretch.stiffness, "stretch.stiffness", "N", 1e4, 0, SK_UNBOUNDED,
            "the force that would make it twice as long"),
    SK_REAL(rope_params, stretch.damping, "stretch.damping", "N s", 0, 0, SK_FAR, "of stretching"),
    SK_REAL(rope_params, bend.stiffness, "bend.stiffness", "N", 0, 0, SK_UNBOUNDED,
            "the same of springs between particles 2 apart; 0 is a chain"),
    SK_REAL(rope_params, bend.damping, "bend.damping", "N s", 0, 0, SK_FAR, "of bending"),
    SK_REAL(rope_params, limit, "stretch.limit", "", SK_UNBOUNDED, 0, SK_UNBOUNDED,
            "strain limit: no part gets longer than rest times 1 + this; \"infinite\" is none"),
    SK_REAL(rope_params, tether, "stretch.tether", "", 0.01, 0, SK_UNBOUNDED,
            "no particle gets farther from a pin than along the rope, times 1 + this; \"infinite\" is none"),
};

enum { BEND, STRETCH }; /* the body's batches, in the order of sweeps */
enum { MOST_SINGLE_ANCHORS = 4 };

/* ---- where it lies ---- */

static double sinh_of(double x) {
    double e = sk_exp(x);
    return 0.5 * (e - 1 / e);
}

static double inverse_sinh(double x) {
    double log = sk_log(fabs(x) + sqrt(x * x + 1));
    return x < 0 ? -log : log;
}

/* The x > 0 with sinh(x)/x = ratio, by halving; ratio is over 1. */
static double solve_sag(double ratio) {
    double low = 0, high = 1;
    while (sinh_of(high) < ratio * high) high *= 2;
    for (int i = 0; i < 60; i++) {
        double middle = 0.5 * (low + high);
        if (sinh_of(middle) < ratio * middle) low = middle;
        else high = middle;
    }
    return high;
}

static void lay_straight(const sk_block *block, const rope_params *params, double length, double way) {
    for (size_t i = 0; i < block->count; i++)
        for (int k = 0; k < 3; k++)
            block->position[i][k] = params->from[k] + (params->to[k] - params->from[k]) * (length / way) * (double)i /
                                                          (double)(block->count - 1);
}

/* Along the catenary of this length between the ends: y = a cosh((u - lowest)/a) over the way u along the ground. */
static void lay_hanging(const sk_block *block, const rope_params *params, double length) {
    double dx = params->to[0] - params->from[0], dz = params->to[2] - params->from[2];
    double rise = params->to[1] - params->from[1], ground = sqrt(dx * dx + dz * dz);
    // ends above each other have no way along the ground: a little one does for a narrow loop
    double least = 1e-6 * length, across = ground > least ? ground : least;
    double ux = ground > least ? dx / ground : 1, uz = ground > least ? dz / ground : 0;
    double ratio = sqrt((length - rise) * (length + rise)) / across;
    double a = across / (2 * solve_sag(ratio > 1 + 1e-12 ? ratio : 1 + 1e-12));
    double lowest = 0.5 * across - 0.5 * a * sk_log((length + rise) / (length - rise));
    double start = sinh_of(-lowest / a), start_height = sqrt(1 + start * start);
    for (size_t i = 0; i < block->count; i++) {
        double slope = start + length * (double)i / (double)(block->count - 1) / a;
        double u = lowest + a * inverse_sinh(slope);
        block->position[i][0] = params->from[0] + ux * u;
        block->position[i][1] = params->from[1] + a * (sqrt(1 + slope * slope) - start_height);
        block->position[i][2] = params->from[2] + uz * u;
    }
    memcpy(block->position[0], params->from, sizeof params->from);
    memcpy(block->position[block->count - 1], params->to, sizeof params->to);
}

static double way_of(const rope_params *params) {
    double square = 0;
    for (int k = 0; k < 3; k++) square += (params->to[k] - params->from[k]) * (params->to[k] - params->from[k]);
    return sqrt(square);
}

static double length_of(const rope_params *params) {
    return params->length > 0 ? params->length : way_of(params);
}

/* Places the particles; the rope's length comes back. */
static skein_status lay(const sk_block *block, const rope_params *params, double *length) {
    double way = way_of(params);
    *length = length_of(params);
    if (!(*length > 0))
        return sk_fail(block->error, SKEIN_ERROR_VALUE, "to", "a rope needs two ends that are apart, or a length");
    if (*length > way * (1 + 1e-9)) lay_hanging(block, params, *length);
    else lay_straight(block, params, *length, way);
    return SKEIN_OK;
}

skein_status sk_rope_choose_words(void *data, const char *words) {
    sk_block *block = data;
    static const char *const forms[] = {"first", "last", "all"};
    if (!strcmp(words, forms[0])) block->pinned[0] = true;
    else if (!strcmp(words, forms[1])) block->pinned[block->count - 1] = true;
    else if (!strcmp(words, forms[2])) memset(block->pinned, 1, block->count * sizeof *block->pinned);
    else
        return sk_fail(
            block->error, SKEIN_ERROR_NAME, "pins",
            "'%s' names no part of a rope; expected numbers, \"first\", \"last\", \"all\", \"box x y z x y z\" "
            "or \"sphere x y z radius\"",
            words);
    return SKEIN_OK;
}

/* ---- tethers ---- */

/* The nearest pin of each particle, counted along the rope. */
static void find_nearest(const bool *pins, size_t count, uint32_t *nearest) {
    size_t last = SIZE_MAX;
    for (size_t i = 0; i < count; i++) {
        if (pins[i]) last = i;
        nearest[i] = last == SIZE_MAX ? UINT32_MAX : (uint32_t)last;
    }
    last = SIZE_MAX;
    for (size_t i = count; i-- > 0;) {
        if (pins[i]) last = i;
        if (last != SIZE_MAX && (nearest[i] == UINT32_MAX || last - i < i - nearest[i])) nearest[i] = (uint32_t)last;
    }
}

/* Each of a few pins tethers every particle; with many, only the nearest one does. The few are listed first: searching
 * for them for each particle made a rope of 100,000 take seconds. */
static skein_status add_tethers(skein_world *world, sk_body *body, const void *data, const bool *to,
                                skein_error *error) {
    const rope_params *params = data;
    sk_allocator *allocator = &world->allocator;
    size_t count = (size_t)params->count, pins = 0, free = 0, filled = 0, few[MOST_SINGLE_ANCHORS];
    const double link = length_of(params) / (double)(params->count - 1);
    const bool *pinned = world->particles.pinned + body->first_particle;
    for (size_t i = 0; i < count; i++) {
        if (to[i] && pins < MOST_SINGLE_ANCHORS) few[pins] = i;
        pins += to[i];
        free += !pinned[i];
    }
    if (!pins || !free) return SKEIN_OK;
    size_t anchors = pins <= MOST_SINGLE_ANCHORS ? pins : 1;
    uint32_t first = body->first_particle, *nearest = sk_allocate(allocator, count * sizeof *nearest);
    uint32_t *particles = sk_allocate(allocator, count * (1 + anchors) * sizeof *particles);
    real *lengths = sk_allocate(allocator, count * anchors * sizeof *lengths);
    skein_status status = nearest && particles && lengths ? SKEIN_OK : sk_fail_memory(error, "tethers");
    if (!status) find_nearest(to, count, nearest);
    for (size_t i = 0; i < count && !status; i++) {
        if (pinned[i]) continue;
        uint32_t *element = particles + filled * (1 + anchors);
        element[0] = first + (uint32_t)i;
        for (size_t k = 0; k < anchors; k++) {
            size_t anchor = anchors == pins ? few[k] : nearest[i], apart = anchor > i ? anchor - i : i - anchor;
            element[1 + k] = first + (uint32_t)anchor;
            lengths[filled * anchors + k] = (real)(link * (double)apart);
        }
        filled++;
    }
    if (!status) status = sk_world_add_tethers(world, body, SK_LIMIT_LAST, filled, anchors, particles, lengths, error);
    sk_release(allocator, nearest);
    sk_release(allocator, particles);
    sk_release(allocator, lengths);
    return status;
}

/* ---- the type ---- */

static bool live(const void *params, const char *field) {
    (void)params;
    static const char *const names[] = {"stretch.stiffness", "stretch.damping", "bend.stiffness",
                                        "bend.damping",      "stretch.limit",   "stretch.tether"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (!strcmp(field, names[i])) return true;
    return false;
}

static void change(sk_body *body, const void *data) {
    const rope_params *params = data;
    *body->material[BEND] = params->bend;
    *body->material[STRETCH] = params->stretch;
    body->strain_bound = params->limit;
    body->tether_bound = params->tether;
}

static skein_status build(skein_world *world, sk_body *body, const void *data, const skein_mesh *mesh,
                          skein_error *error) {
    const rope_params *params = data;
    if (mesh) return sk_fail(error, SKEIN_ERROR_VALUE, "mesh", "a rope is made from its ends, not from a mesh");
    sk_block block = {.world = world, .body = body, .error = error, .size = {(uint32_t)params->count, 1, 1}};
    double length = 0;
    skein_status status = sk_block_begin(&block);
    if (!status) status = lay(&block, params, &length);
    double link = length / (double)(params->count - 1);
    if (!status)
        status = sk_block_add_particles(&block, params->density * length, params->velocity, params->pins,
                                        sk_rope_choose_words);
    const sk_block_springs bend = {{2, 0, 0}, 2 * link, 0.5 / link}, stretch = {{1, 0, 0}, link, 1 / link};
    if (!status) status = sk_block_add_springs(&block, "bend", params->bend, false, &bend, 1);
    if (!status) status = sk_block_add_springs(&block, "stretch", params->stretch, true, &stretch, 1);
    if (!status) {
        sk_world_add_strain_limit(body);
        status = add_tethers(world, body, params, block.pinned, error);
    }
    if (!status) status = sk_block_add_strips(&block);
    if (!status) status = sk_block_add_surface(&block);
    if (!status) change(body, params);
    sk_block_release(&block);
    return status;
}

const sk_body_type sk_rope = {
    .kind = {"rope", "a line of particles, straight or hanging between its ends", SKEIN_BODY, fields,
             sizeof fields / sizeof *fields, sizeof(rope_params)},
    .build = build,
    .live = live,
    .change = change,
    .tether = add_tethers,
    .shape = SKEIN_SHAPE_CHAIN,
};
