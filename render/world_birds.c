/* The birds of a picture; see world_birds.h. */
#include "render/world_birds.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* From tip to tip, in radii of the scene. */
static const double usual_span = 0.045;
/* A predator is so many times as large. */
static const double predator_size = 3;
static const float predator_colour[3] = {0.24f, 0.15f, 0.10f};
/* The part of a flock that strays, at each end of each axis; of so many birds, spread over all, that is found out. */
static const double strays = 0.03;
enum { MOST_LOOKED_AT = 8192 };

bool render_are_birds(const skein_world *world, skein_handle body, const render_view *view) {
    skein_shape shape;
    bool shown = !view || (view->birds && view->particles != RENDER_NO_PARTICLES);
    return shown && skein_shape_of(world, body, &shape) == SKEIN_OK && shape.sort == SKEIN_SHAPE_BIRDS;
}

static bool reserve(render_world_birds *all, size_t birds) {
    if (all->count == all->room) {
        render_birds *grown = realloc(all->birds, (all->room + 4) * sizeof *grown);
        if (!grown) return false;
        all->birds = grown;
        size_t *bodies = realloc(all->body, (all->room + 4) * sizeof *bodies);
        if (!bodies) return false;
        all->body = bodies;
        all->room += 4;
    }
    size_t need = all->number_count + 8 * birds;
    if (need > all->number_room) {
        float *grown = realloc(all->numbers, need * sizeof *grown);
        if (!grown) return false;
        all->numbers = grown;
        all->number_room = need;
    }
    return true;
}

static void copy(const skein_view *view, const skein_surface *surface, float *out) {
    for (size_t i = 0; i < surface->particle_count; i++) {
        const skein_real *from = &view->xyzw[4 * (size_t)view->slot_of[surface->first_particle + i]];
        for (int k = 0; k < 4; k++) out[4 * i + (size_t)k] = (float)from[k];
    }
}

static int by_size(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* The box of the birds that keep together. */
static bool find_core(render_birds *birds, const double *positions) {
    size_t stride = birds->count / MOST_LOOKED_AT + 1;
    double *along = malloc((birds->count / stride + 1) * sizeof *along);
    if (!along) return false;
    memcpy(birds->core_least, birds->least, sizeof birds->least);
    memcpy(birds->core_most, birds->most, sizeof birds->most);
    for (size_t k = 0; k < 3; k++) {
        size_t count = 0;
        for (size_t b = 0; b < birds->count; b += stride)
            if (isfinite(positions[3 * b + k])) along[count++] = positions[3 * b + k];
        if (!count) break;
        qsort(along, count, sizeof *along, by_size);
        size_t out = (size_t)(strays * (double)count);
        birds->core_least[k] = along[out], birds->core_most[k] = along[count - 1 - out];
    }
    free(along);
    return true;
}

bool render_add_birds(render_world_birds *all, const skein_world *world, const render_world_state *state,
                      const skein_surface *surface, size_t index) {
    skein_device_info device = skein_world_device(world);
    bool on_card = device.device == SKEIN_DEVICE_CURRENT_GL && device.position_buffer;
    if (!reserve(all, on_card ? 0 : surface->particle_count)) return false;
    all->body[all->count] = index;
    render_birds *birds = &all->birds[all->count++];
    *birds = (render_birds){.count = surface->particle_count};
    if (on_card) {
        birds->position_buffer = device.position_buffer;
        birds->velocity_buffer = device.velocity_buffer;
        birds->bird_buffer = device.particle_buffer; // then they are all there is
        if (device.slot_of) birds->slots = device.slot_of + surface->first_particle;
    } else {
        skein_view v = skein_velocity_view(world);
        float *numbers = all->numbers + all->number_count;
        for (size_t i = 0; i < birds->count; i++)
            for (size_t k = 0; k < 3; k++)
                numbers[4 * i + k] = (float)state->positions[3 * (surface->first_particle + i) + k];
        copy(&v, surface, numbers + 4 * birds->count);
        all->number_count += 8 * birds->count;
    }
    render_bounds bounds = render_bounds_nothing();
    for (size_t i = 0; i < birds->count; i++)
        render_bounds_add(&bounds, &state->positions[3 * (surface->first_particle + i)], 0);
    memcpy(birds->least, bounds.least, sizeof bounds.least);
    memcpy(birds->most, bounds.most, sizeof bounds.most);
    return find_core(birds, &state->positions[3 * surface->first_particle]);
}

bool render_add_predator_bird(render_world_birds *all, const double at[3], const double velocity[3]) {
    if (!reserve(all, 1)) return false;
    all->body[all->count] = SIZE_MAX;
    render_birds *birds = &all->birds[all->count];
    *birds = (render_birds){.count = 1};
    // within the flock's own box, as far as the camera knows
    bool alone = !all->count || !all->birds[0].count;
    for (int k = 0; k < 3; k++) {
        birds->least[k] = alone ? at[k] : all->birds[0].least[k];
        birds->most[k] = alone ? at[k] : all->birds[0].most[k];
        all->numbers[all->number_count + (size_t)k] = (float)at[k];
        all->numbers[all->number_count + 4 + (size_t)k] = (float)velocity[k];
    }
    all->numbers[all->number_count + 3] = all->numbers[all->number_count + 7] = 1;
    all->number_count += 8;
    all->count++;
    return true;
}

void render_world_birds_show(render_world_birds *all, const render_view *view, double range, render_frame *frame) {
    size_t at = 0;
    for (size_t i = 0; i < all->count; i++) {
        render_birds *birds = &all->birds[i];
        if (!birds->position_buffer) { // the array may have moved since they were added
            birds->positions = all->numbers + at;
            birds->velocities = birds->positions + 4 * birds->count;
            at += 8 * birds->count;
        }
        render_material material = render_default_material(all->body[i] == SIZE_MAX ? 0 : all->body[i]);
        memcpy(birds->colour, material.colour, sizeof birds->colour);
        birds->range = range;
        bool predator = all->body[i] == SIZE_MAX;
        if (predator) memcpy(birds->colour, predator_colour, sizeof birds->colour);
        birds->paint = predator                              ? RENDER_ONE_FEATHER
                       : view->colour == RENDER_BY_DIRECTION ? RENDER_BY_DIRECTION_FEATHERS
                       : view->colour == RENDER_BY_SPEED     ? RENDER_BY_SPEED_FEATHERS
                       : view->colour == RENDER_BY_BODY      ? RENDER_ONE_FEATHER
                                                             : RENDER_OWN_FEATHERS;
    }
    frame->birds = all->birds;
    frame->bird_count = all->count;
}

void render_world_birds_size(render_world_birds *all, const render_view *view, double radius) {
    double fitting = usual_span * (radius > 0 ? radius : 1);
    for (size_t i = 0; i < all->count; i++)
        all->birds[i].span = (view->particle_radius > 0 ? 4 * view->particle_radius : fitting) *
                             (all->body[i] == SIZE_MAX ? predator_size : 1);
}

void render_world_birds_clear(render_world_birds *all) {
    all->count = all->number_count = 0;
}

void render_world_birds_release(render_world_birds *all) {
    free(all->birds);
    free(all->body);
    free(all->numbers);
    memset(all, 0, sizeof *all);
}
