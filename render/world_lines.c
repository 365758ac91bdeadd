/* The lines of a picture; see world_lines.h. */
#include "render/world_lines.h"

#include "render/meshes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void render_world_lines_clear(render_world_lines *lines) {
    for (int i = 0; i < RENDER_LINE_KIND_COUNT; i++) lines->sets[i].count = 0;
    lines->no_memory = false;
}

void render_world_lines_release(render_world_lines *lines) {
    for (int i = 0; i < RENDER_LINE_KIND_COUNT; i++) {
        free(lines->sets[i].positions);
        free(lines->sets[i].colours);
    }
    free(lines->normals);
    memset(lines, 0, sizeof *lines);
}

static bool reserve(render_world_lines *lines, render_line_set *set) {
    if (set->count < set->room) return true;
    size_t room = 2 * set->room + 64;
    double *positions = realloc(set->positions, room * 6 * sizeof *positions);
    if (positions) set->positions = positions;
    float *colours = positions ? realloc(set->colours, room * 3 * sizeof *colours) : NULL;
    if (colours) set->colours = colours, set->room = room;
    else lines->no_memory = true;
    return colours != NULL;
}

static bool is_finite(const double p[3]) {
    return isfinite(p[0]) && isfinite(p[1]) && isfinite(p[2]);
}

void render_add_line(render_world_lines *lines, render_line_kind kind, const double from[3], const double to[3],
                     const float colour[3]) {
    render_line_set *set = &lines->sets[kind];
    if (!is_finite(from) || !is_finite(to) || !reserve(lines, set)) return;
    memcpy(&set->positions[6 * set->count], from, 3 * sizeof *from);
    memcpy(&set->positions[6 * set->count + 3], to, 3 * sizeof *to);
    memcpy(&set->colours[3 * set->count++], colour, 3 * sizeof *colour);
}

/* From a point, so many times `along`. */
static void add_ray(render_world_lines *lines, render_line_kind kind, const double from[3], const double along[3],
                    double times, const float colour[3]) {
    double to[3];
    for (int k = 0; k < 3; k++) to[k] = from[k] + times * along[k];
    render_add_line(lines, kind, from, to, colour);
}

void render_add_wireframe(render_world_lines *lines, const render_body_mesh *mesh, const render_world_state *state) {
    static const float ink[3] = {0.17f, 0.15f, 0.16f};
    for (size_t i = 0; i < mesh->edge_count; i++) {
        const uint32_t *edge = &mesh->edges[2 * i];
        render_add_line(lines, RENDER_WIREFRAME, &state->positions[3 * (size_t)edge[0]],
                        &state->positions[3 * (size_t)edge[1]], ink);
    }
}

void render_add_springs(render_world_lines *lines, const render_world_state *state) {
    for (size_t i = 0; i < state->spring_count; i++) {
        const skein_spring *spring = &state->springs[i];
        float colour[3];
        if (state->shown[spring->particle[0]] == RENDER_HIDDEN) continue;
        render_strain_colour(state, (double)spring->strain, colour);
        render_add_line(lines, RENDER_SPRINGS, &state->positions[3 * (size_t)spring->particle[0]],
                        &state->positions[3 * (size_t)spring->particle[1]], colour);
    }
}

void render_add_normals(render_world_lines *lines, const render_surface *surface, double length) {
    static const float blue[3] = {0.13f, 0.35f, 0.75f};
    if (surface->vertex_count > lines->normal_room) {
        float *normals = realloc(lines->normals, surface->vertex_count * 3 * sizeof *normals);
        lines->no_memory |= !normals;
        if (!normals) return;
        lines->normals = normals;
        lines->normal_room = surface->vertex_count;
    }
    render_surface_normals(surface, lines->normals);
    for (size_t v = 0; v < surface->vertex_count; v++) {
        const float *n = &lines->normals[3 * v];
        const double along[3] = {(double)n[0], (double)n[1], (double)n[2]};
        if (surface->weld && surface->weld[v] != v) continue;
        add_ray(lines, RENDER_NORMALS, &surface->positions[3 * v], along, length, blue);
    }
}

void render_add_velocities(render_world_lines *lines, const render_world_state *state, double seconds) {
    static const float green[3] = {0.05f, 0.45f, 0.30f};
    for (size_t p = 0; p < state->particle_count; p++) {
        if (state->shown[p] == RENDER_HIDDEN) continue;
        add_ray(lines, RENDER_VELOCITIES, &state->positions[3 * p], &state->velocities[3 * p], seconds, green);
    }
}

void render_add_contacts(render_world_lines *lines, const render_world_state *state, double length) {
    static const float magenta[3] = {0.80f, 0.06f, 0.45f};
    for (size_t i = 0; i < state->contact_count; i++) {
        const skein_contact *contact = &state->contacts[i];
        double foot[3];
        if (contact->particle >= state->particle_count || state->shown[contact->particle] == RENDER_HIDDEN) continue;
        for (int k = 0; k < 3; k++)
            foot[k] = state->positions[3 * (size_t)contact->particle + (size_t)k] - contact->gap * contact->normal[k];
        add_ray(lines, RENDER_CONTACTS, foot, contact->normal, length, magenta);
    }
}

void render_add_arrow(render_world_lines *lines, render_line_kind kind, const double from[3], const double along[3],
                      const float colour[3]) {
    static const double barb = 0.28, slant = 0.13;
    double tip[3], size = sqrt(along[0] * along[0] + along[1] * along[1] + along[2] * along[2]);
    for (int k = 0; k < 3; k++) tip[k] = from[k] + along[k];
    render_add_line(lines, kind, from, tip, colour);
    // to both sides, level, or for an arrow that stands upright along x
    double level = hypot(along[0], along[2]);
    bool upright = level < 1e-3 * size;
    double side[3] = {upright ? size : size * along[2] / level, 0, upright ? 0 : -size * along[0] / level};
    for (int sign = -1; sign <= 1; sign += 2) {
        double back[3];
        for (int k = 0; k < 3; k++) back[k] = -barb * along[k] + sign * slant * side[k];
        add_ray(lines, kind, tip, back, 1, colour);
    }
    if (kind != RENDER_GRADIENTS || !(size > 0)) return;
    // seen from the side, too
    double over[3] = {side[1] * along[2] - side[2] * along[1], side[2] * along[0] - side[0] * along[2],
                      side[0] * along[1] - side[1] * along[0]};
    for (int sign = -1; sign <= 1; sign += 2) {
        double back[3];
        for (int k = 0; k < 3; k++) back[k] = -barb * along[k] + sign * slant * over[k] / size;
        add_ray(lines, kind, tip, back, 1, colour);
    }
}

void render_add_field(render_world_lines *lines, size_t count, const double *points, const double *forces,
                      double length) {
    static const float orange[3] = {0.80f, 0.36f, 0.05f};
    static const double least = 0.02 /* of the strongest, to be seen */;
    double strongest = 0;
    for (size_t i = 0; i < count; i++) {
        const double *f = &forces[3 * i];
        double strength = sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]);
        if (isfinite(strength)) strongest = fmax(strongest, strength);
    }
    for (size_t i = 0; i < count; i++) {
        const double *f = &forces[3 * i];
        double strength = sqrt(f[0] * f[0] + f[1] * f[1] + f[2] * f[2]), along[3];
        if (!(strength > least * strongest)) continue;
        for (int k = 0; k < 3; k++) along[k] = f[k] / strongest * length;
        render_add_arrow(lines, RENDER_FIELDS, &points[3 * i], along, orange);
    }
}

void render_add_axes(render_world_lines *lines, double length) {
    static const float colours[3][3] = {{0.85f, 0.12f, 0.10f}, {0.10f, 0.60f, 0.15f}, {0.10f, 0.30f, 0.85f}};
    for (int k = 0; k < 3; k++) {
        const double origin[3] = {0, 0, 0};
        double along[3] = {0, 0, 0};
        along[k] = 1;
        add_ray(lines, RENDER_AXES, origin, along, length, colours[k]);
    }
}

void render_world_lines_show(render_world_lines *lines, double width, render_frame *frame) {
    static const double thickness[RENDER_LINE_KIND_COUNT] = {0.8, 1, 1, 1, 1.6, 1, 1, 1.6, 2.2, 1};
    for (int i = 0; i < RENDER_LINE_KIND_COUNT; i++) {
        const render_line_set *set = &lines->sets[i];
        bool body = i == RENDER_WIREFRAME || i == RENDER_SPRINGS || i == RENDER_CONSTRAINTS;
        lines->lines[i] = (render_lines){.positions = set->positions,
                                         .count = set->count,
                                         .width = width * thickness[i],
                                         .colours = set->colours,
                                         .aside = !body};
    }
    frame->lines = lines->lines;
    frame->lines_count = RENDER_LINE_KIND_COUNT;
}
