/* Predators and the chosen bird; see world_flock.h. */
#include "render/world_flock.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "render/linear.h"

static const double pi = 3.14159265358979323846;
static const float zone_colours[3][3] = {{0.85f, 0.13f, 0.10f}, {0.10f, 0.58f, 0.20f}, {0.13f, 0.30f, 0.85f}};
static const float reach_colour[3] = {0.35f, 0.10f, 0.08f};

/* ---- Reading rules ---- */

static double number_of(const skein_world *world, skein_handle force, const char *field, double otherwise) {
    skein_value value;
    return skein_get(world, force, field, &value) ? otherwise : value.number[0];
}

static bool has_fields(const skein_world *world, skein_handle force, const char *const *names) {
    for (; *names; names++)
        if (!skein_field_find(skein_object_kind(world, force), *names, NULL)) return false;
    return true;
}

bool render_flock_zones(const skein_world *world, skein_handle force, double radii[3]) {
    static const char *const names[] = {"separation", "alignment", "cohesion", NULL};
    if (!has_fields(world, force, names) || number_of(world, force, "enabled", 1) == 0) return false;
    double reach = 0;
    for (int i = 0; i < 3; i++) radii[i] = reach += number_of(world, force, names[i], 0);
    // by the square of the distance, a zone is a share of the square of the reach
    bool squared = number_of(world, force, "measure", 0) != 0;
    for (int i = 0; i < 3 && squared && reach > 0; i++) radii[i] = sqrt(radii[i] * reach);
    return reach > 0;
}

static bool is_predator(const skein_world *world, skein_handle force) {
    static const char *const names[] = {"line", "position", "radius", "particle", NULL};
    return has_fields(world, force, names) && number_of(world, force, "enabled", 1) != 0;
}

bool render_has_flying_predator(const skein_world *world) {
    for (size_t f = 0; f < skein_object_count(world, SKEIN_FORCE); f++) {
        skein_handle force = skein_object_at(world, SKEIN_FORCE, f);
        if (is_predator(world, force) && number_of(world, force, "particle", -1) >= 0) return true;
    }
    return false;
}

/* ---- Circles ---- */

static void add_circle(render_world_lines *lines, const double centre[3], const double axis[3], double radius,
                       const float colour[3]) {
    enum { SIDES = 48 };
    double along[3] = {axis[0], axis[1], axis[2]}, u[3], v[3], before[3] = {0, 0, 0};
    render_normalise(along);
    render_basis(along, u, v);
    for (int i = 0; i <= SIDES; i++) {
        double turn = 2 * pi * i / SIDES, at[3];
        for (int k = 0; k < 3; k++) at[k] = centre[k] + radius * (cos(turn) * u[k] + sin(turn) * v[k]);
        if (i) render_add_line(lines, RENDER_ZONES, before, at, colour);
        memcpy(before, at, sizeof at);
    }
}

static void add_ball(render_world_lines *lines, const double centre[3], double radius, const float colour[3]) {
    for (int k = 0; k < 3; k++) {
        double axis[3] = {k == 0, k == 1, k == 2};
        if (radius > 0) add_circle(lines, centre, axis, radius, colour);
    }
}

/* ---- The chosen bird ---- */

typedef struct neighbour {
    double square;
    uint32_t particle;
} neighbour;

static int by_distance(const void *a, const void *b) {
    const neighbour *one = a, *other = b;
    return (one->square > other->square) - (one->square < other->square);
}

/* Who counts for the chosen one under a rule, the nearest first. NULL without memory; free it. */
static neighbour *find_neighbours(skein_world *world, skein_handle force, const render_world_state *state,
                                  uint32_t chosen, double reach, size_t *count) {
    neighbour *all = malloc(state->particle_count * sizeof *all + 1);
    double v[3] = {0, 0, 0}, view = cos(0.5 * number_of(world, force, "view", 360) * pi / 180);
    bool sees_all = number_of(world, force, "view", 360) >= 360;
    *count = 0;
    if (!all || skein_velocities_copy(world, chosen, 1, v)) return all;
    double speed = sqrt(render_dot(v, v));
    for (size_t p = 0; p < state->particle_count; p++) {
        double off[3];
        for (size_t k = 0; k < 3; k++) off[k] = state->positions[3 * p + k] - state->positions[3 * (size_t)chosen + k];
        double square = render_dot(off, off);
        bool seen = sees_all || !(speed > 0) || render_dot(off, v) >= view * speed * sqrt(square);
        if (p == chosen || !(square > 0 && square < reach * reach) || !seen || !skein_particle_present(world, p))
            continue;
        all[(*count)++] = (neighbour){square, (uint32_t)p};
    }
    qsort(all, *count, sizeof *all, by_distance);
    double most = number_of(world, force, "nearest", 0);
    if (most > 0 && (double)*count > most) *count = (size_t)most;
    return all;
}

void render_add_zones(render_world_lines *lines, skein_world *world, const render_world_state *state, uint32_t chosen) {
    if (chosen >= state->particle_count) return;
    const double *at = &state->positions[3 * (size_t)chosen];
    for (size_t f = 0; f < skein_object_count(world, SKEIN_FORCE); f++) {
        skein_handle force = skein_object_at(world, SKEIN_FORCE, f);
        double radii[3];
        size_t count;
        if (!render_flock_zones(world, force, radii)) continue;
        for (int z = 0; z < 3; z++)
            if (z == 0 || radii[z] > radii[z - 1]) add_ball(lines, at, radii[z], zone_colours[z]);
        neighbour *all = find_neighbours(world, force, state, chosen, radii[2], &count);
        lines->no_memory |= !all;
        for (size_t i = 0; i < count && all; i++) {
            double distance = sqrt(all[i].square);
            int zone = distance < radii[0] ? 0 : distance < radii[1] ? 1 : 2;
            render_add_line(lines, RENDER_ZONES, at, &state->positions[3 * (size_t)all[i].particle], zone_colours[zone]);
        }
        free(all);
    }
}

/* ---- Predators ---- */

/* The middle of the first flock. */
static void flock_middle(const render_world_birds *birds, double middle[3]) {
    for (int k = 0; k < 3; k++)
        middle[k] =
            birds->count && birds->birds[0].count ? 0.5 * (birds->birds[0].least[k] + birds->birds[0].most[k]) : 0;
}

static bool add_predator(render_world_birds *birds, render_world_lines *lines, skein_world *world,
                         const render_world_state *state, skein_handle force) {
    skein_value position, line;
    double at[3], v[3], middle[3], radius = number_of(world, force, "radius", 0);
    double particle = number_of(world, force, "particle", -1);
    if (skein_get(world, force, "position", &position) || skein_get(world, force, "line", &line)) return true;
    flock_middle(birds, middle);
    memcpy(at, position.number, sizeof at);
    double length = sqrt(render_dot(line.number, line.number));
    for (int k = 0; k < 3; k++) v[k] = middle[k] - at[k];
    if (particle >= 0 && particle < (double)state->particle_count) {
        memcpy(at, &state->positions[3 * (size_t)particle], sizeof at);
        if (skein_velocities_copy(world, (size_t)particle, 1, v)) return true;
    } else if (length > 0) {
        double depth = render_dot(v, line.number) / (length * length);
        for (int k = 0; k < 3; k++) at[k] += depth * line.number[k], v[k] = middle[k] - at[k];
        // it is feared at any depth: circles around the line
        for (int c = -1; c <= 1; c++) {
            double centre[3];
            for (int k = 0; k < 3; k++) centre[k] = at[k] + c * radius * line.number[k] / length;
            add_circle(lines, centre, line.number, radius, reach_colour);
        }
    }
    if (particle >= 0 || !(length > 0)) add_ball(lines, at, radius, reach_colour);
    return render_add_predator_bird(birds, at, v);
}

bool render_add_predators(render_world_birds *birds, render_world_lines *lines, skein_world *world,
                          const render_world_state *state) {
    bool good = true;
    for (size_t f = 0; f < skein_object_count(world, SKEIN_FORCE) && good; f++) {
        skein_handle force = skein_object_at(world, SKEIN_FORCE, f);
        if (is_predator(world, force) && number_of(world, force, "visible", 1) != 0)
            good = add_predator(birds, lines, world, state, force);
    }
    return good;
}
