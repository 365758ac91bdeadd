/* A PC2 file as a track of places for pins: read, checked against its body, and let go. */
#include "io/cache.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "io/groups.h"
#include "io/own_kinds.h"
#include "io/pc2.h"
#include "io/reach.h"

/* A motion's numbers take the place of its kind's default. */
static double number_of(const io_settings *settings, const char *name) {
    for (size_t i = 0; i < settings->count; i++)
        if (!strcmp(settings->data[i].name, name)) return settings->data[i].value.number[0];
    const skein_kind *kind = io_kind_find(SKEIN_MOTION, "cache", NULL);
    const skein_field *field = kind ? skein_field_find(kind, name, NULL) : NULL;
    return field ? field->initial[0] : 0;
}

/* The body of that name; or, without a name, the only one that there is. */
static bool find_body(skein_world *world, io_place place, const char *name, skein_surface *surface) {
    size_t count = skein_object_count(world, SKEIN_BODY);
    for (size_t i = 0; i < count; i++) {
        skein_handle body = skein_object_at(world, SKEIN_BODY, i);
        skein_value value;
        bool named = name[0] ? !skein_get(world, body, "name", &value) && !strcmp(value.text, name) : count == 1;
        if (named) return !skein_body_surface(world, body, surface);
    }
    if (name[0])
        io_fault(place, "on", SKEIN_ERROR_NAME, "there is no body of the name '%s'%s", name,
                 io_group_words(world, name));
    else io_fault(place, "on", SKEIN_ERROR_VALUE, "expected the name of the body that the points are of");
    return false;
}

/* Whether the motion holds what is free, too, so that the places of all are wanted. */
static bool holds_free(const io_settings *settings) {
    for (size_t i = 0; i < settings->count; i++) {
        const char *name = settings->data[i].name;
        double number = settings->data[i].value.number[0];
        if (!strcmp(name, "pull") && number > 0) return true;
        if ((!strcmp(name, "max_distance") || !strcmp(name, "backstop")) && isfinite(number)) return true;
    }
    return false;
}

/* Which point of the file each pin of the body is (or, for `all`, each particle): its vertex, its particle, or its place among
 * the pins. Returns how many there are; 0 after a fault. */
static size_t match(const skein_world *world, io_place place, const skein_surface *surface, uint32_t points, bool all,
                    uint32_t *particles, uint32_t *point_of) {
    skein_view view = skein_position_view(world);
    size_t pins = 0;
    all &= points == surface->vertex_count || points == surface->particle_count;
    for (uint32_t i = 0; i < surface->particle_count; i++) {
        uint32_t particle = surface->first_particle + i;
        if (!all && view.xyzw[4 * view.slot_of[particle] + 3] > 0) continue;
        particles[pins] = particle;
        point_of[pins++] = i;
    }
    if (!pins) {
        io_fault(place, "file", SKEIN_ERROR_VALUE,
                 "the body has no pins that a cache could lead: give it \"pins\", or the cache a "
                 "\"max_distance\", \"backstop\" or \"pull\" to hold what is free");
        return 0;
    }
    if (points == surface->vertex_count) {
        // of vertices that were joined the first counts
        uint32_t *vertex_of = malloc((surface->particle_count + 1u) * sizeof *vertex_of);
        if (!vertex_of) {
            io_fault(place, "file", SKEIN_ERROR_MEMORY, "out of memory");
            return 0;
        }
        memset(vertex_of, 0xff, surface->particle_count * sizeof *vertex_of);
        for (size_t v = surface->vertex_count; v-- > 0;)
            vertex_of[surface->particle_of_vertex[v] - surface->first_particle] = (uint32_t)v;
        size_t seen = 0; // what lies within the body is no vertex: nothing leads it
        for (size_t k = 0; k < pins; k++) {
            uint32_t vertex = vertex_of[particles[k] - surface->first_particle];
            if (vertex == UINT32_MAX) continue;
            particles[seen] = particles[k];
            point_of[seen++] = vertex;
        }
        pins = seen;
        free(vertex_of);
        if (!pins) io_fault(place, "file", SKEIN_ERROR_VALUE, "none of the body's pins is a vertex");
    } else if (points == pins) {
        for (size_t k = 0; k < pins; k++) point_of[k] = (uint32_t)k;
    } else if (points != surface->particle_count) {
        io_fault(place, "file", SKEIN_ERROR_VALUE,
                 "the file has %u points: expected as many as the body has vertices (%zu), particles (%u) or pins (%zu)",
                 points, surface->vertex_count, surface->particle_count, pins);
        return 0;
    }
    return pins;
}

/* Takes the pins' points out of every sample. */
static bool read_samples(io_cache *cache, io_pc2_reader *reader, io_pc2_header header, const uint32_t *point_of,
                         size_t pins, skein_error *error) {
    double *all = malloc((size_t)header.points * 3 * sizeof *all);
    cache->places = calloc((size_t)header.samples * pins, 3 * sizeof *cache->places);
    skein_status status = SKEIN_OK;
    if (!all || !cache->places) status = io_error_set(error, SKEIN_ERROR_MEMORY, "", "out of memory");
    for (uint32_t s = 0; s < header.samples && !status; s++) {
        status = io_pc2_read(reader, s, all, error);
        for (size_t k = 0; k < pins && !status; k++)
            memcpy(cache->places + 3 * (s * pins + k), all + 3 * (size_t)point_of[k], 3 * sizeof *all);
    }
    free(all);
    return !status;
}

static bool read_file(io_cache *cache, skein_world *world, io_place place, const io_settings *settings,
                      const char *path) {
    const char *on = io_settings_text(settings, "on");
    skein_surface surface;
    skein_error error = {SKEIN_OK, "", ""};
    io_pc2_header header;
    if (!find_body(world, place, on ? on : "", &surface)) return false;
    io_pc2_reader *reader = io_pc2_open(path, &header, &error);
    uint32_t *point_of = calloc(surface.particle_count + 1u, sizeof *point_of);
    cache->particles = calloc(surface.particle_count + 1u, sizeof *cache->particles);
    bool good = reader != NULL;
    size_t pins = 0;
    if (good && !(good = point_of && cache->particles)) io_error_set(&error, SKEIN_ERROR_MEMORY, "", "out of memory");
    if (good && !header.samples) good = !io_error_set(&error, SKEIN_ERROR_VALUE, path, "there are no samples in it");
    if (good && !(header.rate > 0)) good = !io_error_set(&error, SKEIN_ERROR_VALUE, path, "its rate is not over 0");
    if (good && (pins = match(world, place, &surface, header.points, holds_free(settings), cache->particles, point_of)))
        good = read_samples(cache, reader, header, point_of, pins, &error);
    if (!good) io_fault(place, "file", error.status, "%s%s%s", error.where, error.where[0] ? ": " : "", error.message);
    else
        cache->track = (skein_track){cache->particles, cache->places, pins, header.samples,
                                     (double)header.rate / number_of(settings, "fps")};
    io_pc2_close(reader);
    free(point_of);
    return good && pins;
}

bool io_cache_read(io_cache *cache, skein_world *world, io_place place, const io_settings *settings) {
    const char *file = io_settings_text(settings, "file");
    memset(cache, 0, sizeof *cache);
    if (!file || !file[0]) {
        io_fault(place, "file", SKEIN_ERROR_VALUE, "expected the name of a PC2 file");
        return false;
    }
    char *path = io_path_beside(place.file, file);
    if (!path) io_fault(place, "file", SKEIN_ERROR_MEMORY, "out of memory");
    bool good = path && io_reach_check(place, "file", file, path) && read_file(cache, world, place, settings, path);
    free(path);
    if (!good) io_cache_free(cache);
    return good;
}

void io_cache_free(io_cache *cache) {
    free(cache->particles);
    free(cache->places);
    memset(cache, 0, sizeof *cache);
}
