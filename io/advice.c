/* Warnings before a run: stable steps by the library's own estimate, rounding by extent and gravity, and what lies inside
 * a collider. */
#include "io/advice.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "io/own_kinds.h"

static double substeps_of(const skein_world *world) {
    skein_value substeps = skein_number(1);
    skein_get_path(world, "method.substeps", &substeps);
    return substeps.number[0];
}

static const char *method_of(const skein_world *world) {
    return skein_object_kind(world, skein_object_at(world, SKEIN_METHOD, 0))->name;
}

/* ---- stability ---- */

/* The longest substep; INFINITY: any. Negative where it could not be found. */
static double stable_substep(skein_world *world, double dt) {
    skein_stability s;
    // most methods have no limit, which no search is needed to know
    const skein_stability stiff = {.modes = {{1e3 * substeps_of(world) / dt, 0}}, .mode_count = 1};
    if (isinf(skein_kinds_stable_substep(io_kinds(), method_of(world), &stiff))) return INFINITY;
    return skein_world_stability(world, &s) ? -1 : skein_kinds_stable_substep(io_kinds(), method_of(world), &s);
}

/* The limit is that of the world as it stands, and what moves is stiffer now and then: a sheet that needed 134 substeps
 * where it was built blew up with 140 on its way down, and held with 150. */
static double needed_for(double dt, double most) {
    const double margin = 1.15;
    if (most < 0) return 0;
    return isinf(most) ? 1 : most > 0 ? ceil(margin * dt / most) : (double)INFINITY;
}

double io_substeps_needed(skein_world *world, double dt) {
    return needed_for(dt, stable_substep(world, dt));
}

static size_t advise_of_instability(skein_world *world, double dt, io_warnings warnings, double *needed) {
    double most = stable_substep(world, dt), substep = dt / substeps_of(world);
    if (needed) *needed = needed_for(dt, most);
    if (most < 0) {
        io_warn(warnings, "whether the step is stable could not be found: %s", skein_world_error(world)->message);
        return 1;
    }
    if (substep <= most) return 0;
    if (most > 0)
        io_warn(warnings,
                "%s is stable with substeps of %.3g ms at most, and these are %.3g ms: set method.substeps to %.0f or "
                "more",
                method_of(world), 1e3 * most, 1e3 * substep, needed_for(dt, most));
    else io_warn(warnings, "undamped springs grow under %s at any step: take another method", method_of(world));
    return 1;
}

/* ---- rounding ---- */

/* The acceleration of gravity, m/s2. */
static double gravity_of(const skein_world *world) {
    for (size_t i = 0; i < skein_object_count(world, SKEIN_FORCE); i++) {
        skein_handle force = skein_object_at(world, SKEIN_FORCE, i);
        skein_value g;
        if (!strcmp(skein_object_kind(world, force)->name, "gravity") && !skein_get(world, force, "acceleration", &g))
            return sqrt(g.number[0] * g.number[0] + g.number[1] * g.number[1] + g.number[2] * g.number[2]);
    }
    return 0;
}

/* The largest coordinate. */
static double extent_of(const skein_world *world) {
    skein_view view = skein_position_view(world);
    double most = 0;
    for (size_t i = 0; i < view.count; i++)
        for (size_t k = 0; k < 3; k++) most = fmax(most, fabs((double)view.xyzw[4 * (size_t)view.slot_of[i] + k]));
    return most;
}

double io_substeps_by_rounding(const skein_world *world, double dt) {
    // measured on a cube in a bowl: at 0.05 it rests 0.1 mm beside where it does in double, at 0.2 15 mm, at 0.8 45 mm
    const double tolerable = 0.1;
    const double epsilon = sizeof(skein_real) == sizeof(double) ? DBL_EPSILON : (double)FLT_EPSILON;
    double g = gravity_of(world), extent = extent_of(world);
    const char *method = method_of(world);
    bool moves_positions = !strcmp(method, "xpbd") || !strcmp(method, "pbd");
    return moves_positions && g > 0 && extent > 0 ? dt / sqrt(epsilon / 2 * extent / (tolerable * g))
                                                  : (double)INFINITY;
}

static size_t advise_of_rounding(const skein_world *world, double dt, io_warnings warnings) {
    double most = io_substeps_by_rounding(world, dt);
    if (substeps_of(world) <= most) return 0;
    io_warn(warnings,
            "in a substep of %.3g ms gravity moves things by hardly more than positions are rounded to at %.3g m: small "
            "forces get lost; set method.substeps to %.0f or less, or build with SKEIN_DOUBLE",
            1e3 * dt / substeps_of(world), extent_of(world), fmax(1, floor(most)));
    return 1;
}

/* ---- what lies inside a collider ---- */

/* The name that an object was given, or its kind's. */
static const char *name_of(const skein_world *world, skein_handle object) {
    skein_value name;
    bool named = !skein_get(world, object, "name", &name) && name.text && name.text[0];
    return named ? name.text : skein_object_kind(world, object)->name;
}

/* The body of a particle that is connected with others, NULL for a loose one's: birds fly off by themselves. */
static const char *connected_body_of(skein_world *world, uint32_t particle) {
    for (size_t i = 0; i < skein_object_count(world, SKEIN_BODY); i++) {
        skein_handle body = skein_object_at(world, SKEIN_BODY, i);
        skein_surface surface;
        size_t edges = 0;
        if (skein_body_surface(world, body, &surface) || particle - surface.first_particle >= surface.particle_count)
            continue;
        bool connected = !skein_body_elements(world, body, SKEIN_EDGES, NULL, 0, &edges) && edges;
        return connected ? name_of(world, body) : NULL;
    }
    return NULL;
}

/* What begins inside comes out at the collider's recovery, which takes its time; says so of the deepest. */
static size_t advise_of_overlap(skein_world *world, double dt, io_warnings warnings) {
    const double fast = 1, deep = 1e-3; // m/s, m
    double h = dt / substeps_of(world), most = fmax(deep, fast * h);
    size_t count = 0;
    if (skein_contacts_copy(world, NULL, 0, &count) || !count) return 0;
    skein_contact *contacts = malloc(count * sizeof *contacts);
    if (!contacts || skein_contacts_copy(world, contacts, count, &count)) count = 0;
    const char *body = NULL, *collider = NULL;
    skein_value recovery = {0};
    for (size_t i = 0; i < count; i++) {
        const char *whose = -contacts[i].gap > most ? connected_body_of(world, contacts[i].particle) : NULL;
        if (!whose) continue;
        most = -contacts[i].gap, body = whose, collider = name_of(world, contacts[i].collider);
        skein_get(world, contacts[i].collider, "recovery", &recovery);
    }
    free(contacts);
    if (!body) return 0;
    io_warn(warnings,
            "'%s' lies %.3g m deep in '%s', and comes out at its recovery of %g m/s, in %.2g s: move one of them if "
            "nothing is to begin inside",
            body, most, collider, recovery.number[0], most / recovery.number[0]);
    return 1;
}

/* ---- what is in each other ---- */

/* Surfaces that contact is to keep apart, and that begin through each other, are led apart, or stay so. */
static size_t advise_of_crossings(skein_world *world, io_warnings warnings) {
    bool meet = false; // else measuring costs a step for nothing
    for (size_t i = 0; i < skein_object_count(world, SKEIN_FORCE); i++)
        meet |= !strcmp(skein_object_kind(world, skein_object_at(world, SKEIN_FORCE, i))->name, "contact");
    skein_statistics s;
    if (!meet || skein_world_statistics(world, &s) || !s.crossings) return 0;
    io_warn(warnings,
            "%zu edge%s through faces at the start: contact leads surfaces apart at its recovery; where both are pinned "
            "they may stay as they are, so move them if some are left in the end",
            s.crossings, s.crossings == 1 ? " goes" : "s go");
    return 1;
}

size_t io_advise(skein_world *world, double dt, io_warnings warnings, double *needed) {
    size_t count = advise_of_instability(world, dt, warnings, needed);
    count += advise_of_rounding(world, dt, warnings);
    count += advise_of_overlap(world, dt, warnings);
    return count + advise_of_crossings(world, warnings);
}
