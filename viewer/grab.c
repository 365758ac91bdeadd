/* Pulling and pinning; see grab.h. */
#include "viewer/grab.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The spring's rate (1/s): the way left shrinks to a third in 1/rate; and the stretch at which the hand gives way. */
static const double rate = 14, most_stretch = 0.15;

bool viewer_is_held(const skein_world *world, uint32_t particle) {
    skein_view view = skein_position_view(world);
    return !(view.xyzw[4 * (size_t)view.slot_of[particle] + 3] > 0);
}

static double distance(const double a[3], const double b[3]) {
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
}

/* Notes the springs on the particle, with the lengths that they rest at. */
static void note_springs(viewer_grab *grab, skein_world *world) {
    size_t count = 0;
    grab->neighbour_count = 0;
    if (skein_springs_copy(world, NULL, 0, &count) || !count) return;
    skein_spring *springs = malloc(count * sizeof *springs);
    if (!springs || skein_springs_copy(world, springs, count, &count)) {
        free(springs);
        return;
    }
    for (size_t i = 0; i < count && grab->neighbour_count < 16; i++) {
        const uint32_t *ends = springs[i].particle;
        if (ends[0] != grab->particle && ends[1] != grab->particle) continue;
        double x[3], y[3];
        uint32_t other = ends[0] == grab->particle ? ends[1] : ends[0];
        if (skein_positions_copy(world, grab->particle, 1, x) || skein_positions_copy(world, other, 1, y)) continue;
        double rest = distance(x, y) / (1 + (double)springs[i].strain);
        if (!(rest > 0) || !isfinite(rest)) continue;
        grab->neighbours[grab->neighbour_count] = other;
        grab->rests[grab->neighbour_count++] = rest;
    }
    free(springs);
}

void viewer_grab_take(viewer_grab *grab, skein_world *world, size_t side, uint32_t particle) {
    memset(grab, 0, sizeof *grab);
    grab->holding = true;
    grab->side = side;
    grab->particle = particle;
    grab->was_held = viewer_is_held(world, particle);
    skein_positions_copy(world, particle, 1, grab->goal);
    memcpy(grab->depth, grab->goal, sizeof grab->depth);
    note_springs(grab, world);
}

/* 1 where the springs are at rest, 0 where the way to the goal stretches one too far. */
static double give_way(const viewer_grab *grab, const skein_world *world, const double x[3], const double way[3]) {
    double least = 1;
    for (int i = 0; i < grab->neighbour_count; i++) {
        double y[3];
        if (skein_positions_copy(world, grab->neighbours[i], 1, y)) continue;
        double length = distance(x, y), out = 0;
        for (int k = 0; k < 3; k++) out += (x[k] - y[k]) * way[k];
        if (!(length > 0) || out <= 0) continue; // that way it gets shorter
        double stretch = (length / grab->rests[i] - 1) / most_stretch;
        least = fmin(least, fmax(1 - stretch, 0));
    }
    return least;
}

void viewer_grab_lead(viewer_grab *grab, skein_world *world, double dt) {
    if (!grab->holding || !grab->moved) return;
    double x[3], way[3];
    if (skein_positions_copy(world, grab->particle, 1, x)) return;
    if (!viewer_is_held(world, grab->particle)) skein_particle_pin(world, grab->particle, true);
    for (int k = 0; k < 3; k++) way[k] = grab->goal[k] - x[k];
    // the exact way of x' = rate (goal - x) over the step
    double share = (1 - exp(-rate * dt)) * give_way(grab, world, x, way);
    for (int k = 0; k < 3; k++) {
        x[k] += share * way[k];
        grab->led[k] = share * way[k] / dt;
    }
    skein_pins_move(world, &grab->particle, 1, x);
}

void viewer_grab_release(viewer_grab *grab, skein_world *world) {
    if (!grab->holding) return;
    grab->holding = false;
    if (!grab->moved) return;
    skein_particle_pin(world, grab->particle, grab->was_held);
    // let go, it flies on as it was led
    if (!grab->was_held) skein_velocities_set(world, grab->particle, 1, grab->led);
}

bool viewer_toggle_pin(skein_world *world, uint32_t particle) {
    bool held = viewer_is_held(world, particle);
    skein_particle_pin(world, particle, !held);
    return viewer_is_held(world, particle);
}
