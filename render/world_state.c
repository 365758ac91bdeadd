/* What is read out of a world for one picture; see world_state.h. */
#include "render/world_state.h"

#include "render/fail.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The least speed (m/s) and strain at the end of a map that finds its own: less than this is rest. */
static const double least_range = 1e-3;

static bool grow(void *array, size_t count, size_t size) {
    void **pointer = array, *grown = realloc(*pointer, count * size + 1);
    if (grown) *pointer = grown;
    return grown != NULL;
}

static bool reserve_particles(render_world_state *s, size_t count) {
    s->particle_count = count;
    if (count <= s->particle_room && s->positions) return true;
    s->particle_room = count;
    return grow(&s->positions, 3 * count, sizeof *s->positions) &&
           grow(&s->velocities, 3 * count, sizeof *s->velocities) && grow(&s->values, count, sizeof *s->values) &&
           grow(&s->shown, count, sizeof *s->shown) && grow(&s->body, count, sizeof *s->body) &&
           grow(&s->weights, count, sizeof *s->weights);
}

/* Lists whose length is known once they were asked for: asked again if there was too little room. */
static skein_status read_springs(render_world_state *s, skein_world *world, skein_error *error) {
    skein_status status = skein_springs_copy(world, s->springs, s->spring_room, &s->spring_count);
    if (status == SKEIN_OK && s->spring_count > s->spring_room) {
        s->spring_room = s->spring_count;
        if (!grow(&s->springs, s->spring_room, sizeof *s->springs)) return render_fail_memory(error, "the springs");
        status = skein_springs_copy(world, s->springs, s->spring_room, &s->spring_count);
    }
    return status ? render_fail(error, status, "", "the springs cannot be read") : SKEIN_OK;
}

static skein_status read_contacts(render_world_state *s, const skein_world *world, skein_error *error) {
    skein_status status = skein_contacts_copy(world, s->contacts, s->contact_room, &s->contact_count);
    if (status == SKEIN_OK && s->contact_count > s->contact_room) {
        s->contact_room = 2 * s->contact_count;
        if (!grow(&s->contacts, s->contact_room, sizeof *s->contacts)) return render_fail_memory(error, "the contacts");
        status = skein_contacts_copy(world, s->contacts, s->contact_room, &s->contact_count);
    }
    return status ? render_fail(error, status, "", "the contacts cannot be read") : SKEIN_OK;
}

/* ---- Values ----------------------------------------------------------------------------------- */

static double speed_of(const render_world_state *s, size_t particle) {
    const double *v = &s->velocities[3 * particle];
    double speed = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    return isfinite(speed) ? speed : 0;
}

static void find_speeds(render_world_state *s, double asked) {
    s->range = asked > 0 ? asked : least_range;
    for (size_t p = 0; p < s->particle_count && !(asked > 0); p++) s->range = fmax(s->range, speed_of(s, p));
    for (size_t p = 0; p < s->particle_count; p++) s->values[p] = (float)fmin(speed_of(s, p) / s->range, 1);
    s->map = RENDER_LITTLE_TO_MUCH;
}

/* Edges count if there are any: bending springs shorten at every fold, which tells nothing of the cloth. */
static bool counts(const render_world_state *s, const skein_spring *spring, bool edges) {
    return (spring->measured || !edges) && isfinite(spring->strain) && spring->particle[0] < s->particle_count &&
           spring->particle[1] < s->particle_count;
}

static bool has_edges(const render_world_state *s) {
    for (size_t i = 0; i < s->spring_count; i++)
        if (s->springs[i].measured) return true;
    return false;
}

static double strain_range(const render_world_state *s, bool edges, double asked) {
    if (asked > 0) return asked;
    double range = least_range;
    for (size_t i = 0; i < s->spring_count; i++)
        if (counts(s, &s->springs[i], edges)) range = fmax(range, fabs((double)s->springs[i].strain));
    return range;
}

/* A particle's strain is the mean of its springs', so that the largest is less than theirs. */
static void find_strains(render_world_state *s, bool edges, double asked) {
    memset(s->values, 0, s->particle_count * sizeof *s->values);
    memset(s->weights, 0, s->particle_count * sizeof *s->weights);
    for (size_t i = 0; i < s->spring_count; i++) {
        if (!counts(s, &s->springs[i], edges)) continue;
        for (int k = 0; k < 2; k++) {
            s->values[s->springs[i].particle[k]] += s->springs[i].strain;
            s->weights[s->springs[i].particle[k]] += 1;
        }
    }
    s->range = asked > 0 ? asked : least_range;
    for (size_t p = 0; p < s->particle_count; p++) {
        if (s->weights[p] > 0) s->values[p] /= s->weights[p];
        if (!(asked > 0)) s->range = fmax(s->range, fabs((double)s->values[p]));
    }
    for (size_t p = 0; p < s->particle_count; p++)
        s->values[p] = (float)fmin(fmax(0.5 + 0.5 * (double)s->values[p] / s->range, 0), 1);
    s->map = RENDER_LESS_TO_MORE;
}

/* ---- Reading ---------------------------------------------------------------------------------- */

skein_status render_world_state_read(render_world_state *s, skein_world *world, const render_view *view, double blend,
                                     skein_error *error) {
    size_t count = skein_particle_count(world);
    bool strain = view->colour == RENDER_BY_STRAIN, speed = view->colour == RENDER_BY_SPEED;
    if (!reserve_particles(s, count)) return render_fail_memory(error, "the particles");
    s->range = s->spring_range = 0;
    s->spring_count = s->contact_count = 0;
    memset(s->shown, RENDER_LOOSE, count * sizeof *s->shown);
    memset(s->body, 0xff, count * sizeof *s->body);
    skein_status status = blend < 1 ? skein_positions_blend(world, blend, 0, count, s->positions)
                                    : skein_positions_copy(world, 0, count, s->positions);
    if (!status && (view->velocities || speed)) status = skein_velocities_copy(world, 0, count, s->velocities);
    if (status) return render_fail(error, status, "", "the particles cannot be read");
    for (size_t p = 0; p < count; p++) { // what is not there is not shown, and not fast
        if (skein_particle_present(world, p)) continue;
        s->shown[p] = RENDER_HIDDEN;
        memset(s->velocities + 3 * p, 0, 3 * sizeof *s->velocities);
    }
    if (view->springs || strain) status = read_springs(s, world, error);
    if (!status && view->contacts) status = read_contacts(s, world, error);
    if (status) return status;

    if (speed) find_speeds(s, view->range);
    if (view->springs || strain) {
        bool edges = has_edges(s);
        s->spring_range = strain_range(s, edges, speed ? 0 : view->range);
        if (strain) find_strains(s, edges, view->range);
    }
    return SKEIN_OK;
}

void render_world_state_release(render_world_state *s) {
    free(s->positions);
    free(s->velocities);
    free(s->springs);
    free(s->contacts);
    free(s->values);
    free(s->shown);
    free(s->body);
    free(s->weights);
    memset(s, 0, sizeof *s);
}

void render_strain_colour(const render_world_state *state, double strain, float colour[3]) {
    render_map_colour(RENDER_LESS_TO_MORE, 0.5 + 0.5 * strain / state->spring_range, colour);
}

void render_particle_colour(const render_world_state *state, size_t particle, float colour[3]) {
    render_map_colour(state->map, state->values[particle], colour);
}
