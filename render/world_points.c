/* The particles of a picture; see world_points.h. */
#include "render/world_points.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Radii of particles and pins, in radii of the scene; where all particles are shown, in distances between them. */
static const double loose_size = 0.014, pin_size = 0.010, crowded_size = 0.36;

static const float loose_colour[3] = {0.925f, 0.640f, 0.200f}, pin_colour[3] = {0.27f, 0.26f, 0.27f};

void render_world_points_release(render_world_points *points) {
    for (int i = 0; i < RENDER_POINT_KIND_COUNT; i++) free(points->positions[i]);
    free(points->colours);
    memset(points, 0, sizeof *points);
}

static bool reserve(render_world_points *points, size_t count) {
    for (int i = 0; i < RENDER_POINT_KIND_COUNT; i++) {
        double *positions = realloc(points->positions[i], count * 3 * sizeof *positions + 1);
        if (!positions) return false;
        points->positions[i] = positions;
        points->points[i] = (render_points){.positions = positions};
    }
    float *colours = realloc(points->colours, count * 3 * sizeof *colours + 1);
    if (colours) points->points[RENDER_PARTICLES].colours = points->colours = colours;
    memcpy(points->points[RENDER_PINS].colour, pin_colour, sizeof pin_colour);
    return colours != NULL;
}

static void paint(const render_world_state *state, const render_view *view, size_t p, float colour[3]) {
    memcpy(colour, loose_colour, sizeof loose_colour);
    if (state->range > 0) {
        render_particle_colour(state, p, colour);
    } else if (view->colour == RENDER_BY_BODY && state->body[p] != UINT32_MAX) {
        render_material material = render_plain_material(state->body[p]);
        memcpy(colour, material.colour, sizeof material.colour);
    }
}

static void add(render_world_points *points, render_point_kind kind, const double position[3]) {
    memcpy(&points->positions[kind][3 * points->points[kind].count++], position, 3 * sizeof *position);
}

/* Pins are pinned particles of a surface, unless most of it is held. */
bool render_world_points_take(render_world_points *points, const render_world_state *state, const skein_view *where,
                              const render_view *view) {
    bool all = view->particles == RENDER_ALL_PARTICLES, none = view->particles == RENDER_NO_PARTICLES;
    if (!reserve(points, state->particle_count)) return false;
    for (size_t p = 0; p < state->particle_count && p < where->count; p++) {
        bool held = where->xyzw[4 * (size_t)where->slot_of[p] + 3] == 0;
        if (state->shown[p] == RENDER_HIDDEN) continue;
        if (!none && (all || state->shown[p] == RENDER_LOOSE)) {
            paint(state, view, p, &points->colours[3 * points->points[RENDER_PARTICLES].count]);
            add(points, RENDER_PARTICLES, &state->positions[3 * p]);
        } else if (held && view->pins && state->shown[p] == RENDER_IN_SURFACE) {
            add(points, RENDER_PINS, &state->positions[3 * p]);
        }
    }
    if (4 * points->points[RENDER_PINS].count > state->particle_count) points->points[RENDER_PINS].count = 0;
    return true;
}

void render_world_points_size(render_world_points *points, const render_view *view, double radius, double apart) {
    double fitting = loose_size * (radius > 0 ? radius : 1);
    if (view->particles == RENDER_ALL_PARTICLES) fitting = fmin(fitting, crowded_size * apart);
    points->points[RENDER_PARTICLES].radius = view->particle_radius > 0 ? view->particle_radius : fitting;
    points->points[RENDER_PINS].radius = pin_size * radius * (points->points[RENDER_PINS].count > 12 ? 0.6 : 1.0);
}
