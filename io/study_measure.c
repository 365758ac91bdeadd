/* What a study can measure: a table of quantities, each a place in the statistics, in the order of a flock, or a measure
 * of where a body's particles are. */
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include "io/groups.h"
#include "io/order.h"
#include "io/study_inside.h"

typedef enum source { OF_WORLD, OF_FLOCK, OF_PLACES } source;
typedef enum place { CENTRE_X, CENTRE_Y, CENTRE_Z, LOWEST, HIGHEST, FARTHEST_OUT } place;

struct io_study_quantity {
    const char *name, *unit, *help;
    source source;
    bool whole; /* a count */
    size_t offset;
};

#define NUMBER(name_, unit_, help_) \
    { #name_, unit_, help_, OF_WORLD, false, offsetof(skein_statistics, name_) }
#define AXIS(name_, of_, axis_, unit_, help_) \
    { name_, unit_, help_, OF_WORLD, false, offsetof(skein_statistics, of_) + axis_ * sizeof(double) }
#define COUNTED(name_, help_) \
    { #name_, "", help_, OF_WORLD, true, offsetof(skein_statistics, name_) }
#define ORDER(name_, unit_, help_) \
    { #name_, unit_, help_, OF_FLOCK, false, offsetof(skein_order, name_) }
#define PLACE(name_, place_, help_) \
    { name_, "m", help_, OF_PLACES, false, place_ }
static const io_study_quantity quantities[] = {
    NUMBER(kinetic_energy, "J", "energy of motion"),
    NUMBER(potential_energy, "J", "of gravity and potentials"),
    NUMBER(elastic_energy, "J", "in constraints"),
    NUMBER(dissipated_energy, "J", "the energy at the start less that now"),
    AXIS("momentum_x", momentum, 0, "kg m/s", "momentum along x"),
    AXIS("momentum_y", momentum, 1, "kg m/s", "along y"),
    AXIS("momentum_z", momentum, 2, "kg m/s", "along z"),
    AXIS("angular_momentum_x", angular_momentum, 0, "kg m2/s", "angular momentum about the origin, along x"),
    AXIS("angular_momentum_y", angular_momentum, 1, "kg m2/s", "along y"),
    AXIS("angular_momentum_z", angular_momentum, 2, "kg m2/s", "along z"),
    NUMBER(max_stretch, "", "largest stretch of an edge, as a share of its length"),
    NUMBER(p99_stretch, "", "99 % of the edges stretch at most so much"),
    NUMBER(most_over_limit, "", "the most that an edge stretches beyond its limit"),
    NUMBER(max_penetration, "m", "below a collider's thickness"),
    NUMBER(residual, "", "of the last step's solve (backward_euler)"),
    COUNTED(contacts, "pairs of a particle and a collider that touch"),
    COUNTED(crossings, "of an edge and a triangle"),
    COUNTED(contact_overflows, "searches of contact that gave up"),
    COUNTED(asleep, "particles of bodies that sleep"),
    COUNTED(all_unsolved, "substeps that a solve left unsolved"),
    COUNTED(guarded, "values of formulas that have none"),
    ORDER(polarization, "", "of a flock: 1, all fly the same way; 0, no common way"),
    ORDER(milling, "", "1, all circle the centre the same way round"),
    ORDER(nearest, "m", "mean distance of a bird to the nearest one"),
    {"groups", "", "of birds that are in reach of each other", OF_FLOCK, true, offsetof(skein_order, groups)},
    ORDER(radius, "m", "mean distance of birds from the centre"),
    ORDER(farthest, "m", "the largest of them"),
    ORDER(speed, "m/s", "mean speed of birds"),
    PLACE("centre_x", CENTRE_X, "mean position of a body's particles, or of all"),
    PLACE("centre_y", CENTRE_Y, "the same, along y"),
    PLACE("centre_z", CENTRE_Z, "the same, along z"),
    PLACE("lowest", LOWEST, "the least y of a body's particles, or of all"),
    PLACE("highest", HIGHEST, "the largest y"),
    PLACE("spread", FARTHEST_OUT, "the largest distance of a particle from their mean position"),
};

const io_study_quantity *io_study_quantity_find(const char *name, char hint[IO_HINT_SIZE]) {
    const char *names[COUNT_OF(quantities)];
    for (size_t i = 0; i < COUNT_OF(quantities); i++) {
        names[i] = quantities[i].name;
        if (!strcmp(name, names[i])) return &quantities[i];
    }
    io_hint(name, names, COUNT_OF(quantities), hint);
    return NULL;
}

const char *io_study_quantity_unit(const io_study_quantity *what) {
    return what->unit;
}

bool io_study_quantity_of_body(const io_study_quantity *what) {
    return what->source != OF_WORLD;
}

const char *io_study_quantity_at(size_t index, const char **unit, const char **help) {
    if (index >= COUNT_OF(quantities)) return NULL;
    *unit = quantities[index].unit, *help = quantities[index].help;
    return quantities[index].name;
}

/* ---- measuring ---- */

static double take(const void *from, const io_study_quantity *what) {
    const char *at = (const char *)from + what->offset;
    double x;
    if (what->whole) { // a uint64_t or a size_t
        _Static_assert(sizeof(size_t) == sizeof(uint64_t) || sizeof(size_t) == 4, "counts");
        if (what->source == OF_WORLD && what->offset == offsetof(skein_statistics, all_unsolved)) {
            uint64_t count;
            memcpy(&count, at, sizeof count);
            return (double)count;
        }
        size_t count;
        memcpy(&count, at, sizeof count);
        return (double)count;
    }
    memcpy(&x, at, sizeof x);
    return x;
}

/* The body of that name, or number from 0; of none, the first flock where one is wanted. */
static bool find_body(skein_world *world, const io_study_wanted *w, skein_handle *body) {
    size_t number =
        w->body && strspn(w->body, "0123456789") == strlen(w->body) ? strtoull(w->body, NULL, 10) : SIZE_MAX;
    for (size_t i = 0; i < skein_object_count(world, SKEIN_BODY); i++) {
        skein_value name = {0, {0, 0, 0}, ""};
        *body = skein_object_at(world, SKEIN_BODY, i);
        if (i == number || (!w->body && io_is_flock(world, *body))) return true;
        if (w->body && !skein_get(world, *body, "name", &name) && name.text && !strcmp(name.text, w->body)) return true;
    }
    return false;
}

static double measure_places(const skein_world *world, size_t first, size_t count, place what) {
    skein_view view = skein_position_view(world);
    double centre[3] = {0, 0, 0}, low = INFINITY, high = -INFINITY, out = 0;
    for (size_t i = first; i < first + count; i++) {
        const skein_real *p = view.xyzw + 4 * (size_t)view.slot_of[i];
        for (int k = 0; k < 3; k++) centre[k] += (double)p[k] / (double)count;
        low = fmin(low, (double)p[1]), high = fmax(high, (double)p[1]);
    }
    if (!count) return NAN;
    if (what <= CENTRE_Z) return centre[what];
    if (what == LOWEST || what == HIGHEST) return what == LOWEST ? low : high;
    for (size_t i = first; i < first + count; i++) {
        const skein_real *p = view.xyzw + 4 * (size_t)view.slot_of[i];
        double square = 0;
        for (int k = 0; k < 3; k++) square += ((double)p[k] - centre[k]) * ((double)p[k] - centre[k]);
        out = fmax(out, sqrt(square));
    }
    return out;
}

/* Statistics and the order of a body are measured once a frame, however many quantities they have. */
typedef struct looked {
    skein_statistics statistics;
    skein_order order;
    bool has_statistics;
    const char *order_of; /* the name of the body, or "" for the first flock; NULL: none yet */
} looked;

static skein_status measure(skein_world *world, const io_study_wanted *w, looked *seen, double *x, skein_error *error) {
    skein_handle body;
    skein_status status = SKEIN_OK;
    bool found = w->what->source != OF_WORLD && find_body(world, w, &body);
    if (w->what->source == OF_WORLD) {
        if (!seen->has_statistics) status = skein_world_statistics(world, &seen->statistics);
        seen->has_statistics = !status;
        *x = status ? NAN : take(&seen->statistics, w->what);
    } else if (!found && (w->body || w->what->source == OF_FLOCK)) {
        return io_error_set(error, SKEIN_ERROR_NAME, w->name, "%s%s: there is no %s%s%s", w->name,
                            w->body ? ".body" : "", w->body ? "body of the name " : "flock, and no \"body\" is named",
                            w->body ? w->body : "", w->body ? io_group_words(world, w->body) : "");
    } else if (w->what->source == OF_FLOCK) {
        const char *name = w->body ? w->body : "";
        if (!seen->order_of || strcmp(seen->order_of, name) != 0) status = io_order_measure(world, body, &seen->order);
        seen->order_of = status ? NULL : name;
        *x = status ? NAN : take(&seen->order, w->what);
    } else {
        skein_surface surface = {.particle_count = (uint32_t)skein_particle_count(world)};
        if (w->body) status = skein_body_surface(world, body, &surface);
        *x = status ? NAN
                    : measure_places(world, surface.first_particle, surface.particle_count, (place)w->what->offset);
    }
    if (status) *error = *skein_world_error(world);
    return status;
}

skein_status io_study_measure_now(skein_world *world, const io_study_wanted *wanted, io_study_note *notes, size_t count,
                                  int frame, bool last, skein_error *error) {
    looked seen = {.has_statistics = false, .order_of = NULL};
    double now = skein_world_time(world);
    for (size_t m = 0; m < count; m++) {
        const io_study_wanted *w = &wanted[m];
        io_study_note *note = &notes[m];
        bool due = w->over == IO_STUDY_END ? last : frame % w->every == 0 && now >= w->from * (1 - 1e-12);
        double x = NAN;
        if (!due) continue;
        skein_status status = measure(world, w, &seen, &x, error);
        if (status) return status;
        note->sum += x;
        note->least = note->count ? fmin(note->least, x) : x;
        note->most = note->count ? fmax(note->most, x) : x;
        note->last = x;
        note->count++;
    }
    return SKEIN_OK;
}

double io_study_measured(const io_study_wanted *w, const io_study_note *note) {
    if (!note->count) return NAN;
    switch (w->over) {
    case IO_STUDY_MEAN: return note->sum / (double)note->count;
    case IO_STUDY_LEAST: return note->least;
    case IO_STUDY_MOST: return note->most;
    case IO_STUDY_END: break;
    }
    return note->last;
}
