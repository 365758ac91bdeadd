/* The target of a fit: see fit_target.h.
 *
 * A cache has the vertices of a body, as skein run writes them, or its particles. Its samples are frames, whole or not; each
 * has to be at the end of a step. Where a sample is at the start of the run, which is given, it counts for nothing. */
#include "app/fit_target.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "io/clip.h"
#include "io/groups.h"
#include "io/pc2.h"

static bool fail(const char *where, const char *format, ...) IO_PRINTF(2, 3);
static bool fail(const char *where, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    fprintf(stderr, "skein: %s: ", where);
    vfprintf(stderr, format, arguments);
    fprintf(stderr, "\n");
    va_end(arguments);
    return false;
}

/* ---- which particles ---- */

/* The body of that name, or the only one. */
static bool find_body(skein_world *world, const char *name, skein_surface *surface) {
    size_t count = skein_object_count(world, SKEIN_BODY);
    for (size_t i = 0; i < count; i++) {
        skein_handle body = skein_object_at(world, SKEIN_BODY, i);
        skein_value value;
        bool named = name ? !skein_get(world, body, "name", &value) && !strcmp(value.text, name) : count == 1;
        if (named && !skein_body_surface(world, body, surface)) return true;
    }
    if (name) return fail("--body", "there is no body of the name '%s'%s", name, io_group_words(world, name));
    return fail("--body", "the scene has %zu bodies: name the one that the target shows", count);
}

/* The particle of each point; of vertices that were joined the first counts, and the others are UINT32_MAX. */
static bool match(const char *path, const skein_surface *s, uint32_t points, uint32_t *particle_of) {
    if (points == s->vertex_count) {
        bool *seen = calloc(s->particle_count + 1u, sizeof *seen);
        if (!seen) return fail(path, "out of memory");
        for (size_t v = 0; v < points; v++) {
            uint32_t particle = s->particle_of_vertex[v];
            particle_of[v] = seen[particle - s->first_particle] ? UINT32_MAX : particle;
            seen[particle - s->first_particle] = true;
        }
        free(seen);
        return true;
    }
    for (uint32_t i = 0; i < points; i++) particle_of[i] = s->first_particle + i;
    return points == s->particle_count ||
           fail(path, "it has %u points: expected as many as the body has vertices (%zu) or particles (%u)", points,
                s->vertex_count, s->particle_count);
}

/* ---- which steps ---- */

/* After how many steps a sample is; SIZE_MAX past the end, `whole` false where it is within a step. */
static size_t step_of(const app_scene *loaded, const io_pc2_header *header, uint32_t sample, int last_frame,
                      bool *whole) {
    double dt, frame = (double)header->start + sample * (double)header->rate;
    double steps = frame * io_scene_steps_per_frame(&loaded->settings, &dt);
    *whole = fabs(steps - round(steps)) < 1e-3 && steps > -0.5;
    return frame > last_frame + 1e-6 ? SIZE_MAX : *whole ? (size_t)(steps + 0.5) : 0;
}

/* ---- reading ---- */

typedef struct unit {
    int up;
    double scale;
} unit;

static bool read_unit(const app_arguments *arguments, unit *u) {
    const char *up = app_value(arguments, "--up"), *scale = app_value(arguments, "--scale");
    char *end = NULL;
    *u = (unit){up && !strcmp(up, "z") ? IO_UP_Z : IO_UP_Y, scale ? strtod(scale, &end) : 1};
    if (up && strcmp(up, "y") != 0 && strcmp(up, "z") != 0) return fail("--up", "'%s': expected y or z", up);
    if (scale && (end == scale || *end || !(u->scale >= 1e-6 && u->scale <= 1e6)))
        return fail("--scale", "'%s': expected a number, 1e-6 to 1e6", scale);
    return true;
}

/* Back from the file's axes and unit. */
static void place(const unit *u, const double *from, double *to) {
    double x = from[0] / u->scale, y = from[1] / u->scale, z = from[2] / u->scale;
    to[0] = x;
    to[1] = u->up == IO_UP_Z ? z : y;
    to[2] = u->up == IO_UP_Z ? -y : z;
}

static bool add_sample(app_fit_target *t, const char *path, uint32_t sample, const unit *u, const double *all,
                       const uint32_t *particle_of, uint32_t points, size_t step) {
    double *places = t->places + 3 * t->particle_count * t->sample_count;
    for (uint32_t p = 0, i = 0; p < points; p++) {
        if (particle_of[p] == UINT32_MAX) continue;
        for (int k = 0; k < 3; k++)
            if (!isfinite(all[3 * (size_t)p + (size_t)k]))
                return fail(path, "sample %u, point %u: its place is not finite", sample, p);
        place(u, all + 3 * (size_t)p, places + 3 * (size_t)i++);
    }
    t->steps[t->sample_count++] = step;
    return true;
}

static bool read_samples(app_fit_target *t, const app_scene *loaded, const char *path, io_pc2_reader *reader,
                         const io_pc2_header *header, const uint32_t *particle_of, const unit *u) {
    skein_error error = {SKEIN_OK, "", ""};
    double *all = malloc((size_t)header->points * 3 * sizeof *all);
    t->steps = calloc((size_t)header->samples + 1, sizeof *t->steps);
    t->places = calloc((size_t)header->samples * t->particle_count + 1, 3 * sizeof *t->places);
    bool good = (all && t->steps && t->places) || fail(path, "out of memory");
    for (uint32_t s = 0; s < header->samples && good; s++) {
        bool whole;
        size_t step = step_of(loaded, header, s, loaded->settings.frames, &whole);
        if (step == SIZE_MAX) break;
        if (!whole)
            good = fail(path, "sample %u is at frame %g, which is no end of a step: change the scene's step", s,
                        (double)header->start + s * (double)header->rate);
        else if (step && io_pc2_read(reader, s, all, &error)) good = fail(error.where, "%s", error.message);
        else if (step) good = add_sample(t, path, s, u, all, particle_of, header->points, step);
    }
    free(all);
    return good &&
           (t->sample_count || fail(path, "it has no sample after the start and up to frame %d, the scene's last",
                                    loaded->settings.frames));
}

bool app_fit_target_read(app_fit_target *target, const app_scene *loaded, const app_arguments *arguments) {
    const char *path = app_value(arguments, "--target");
    skein_surface surface;
    skein_error error = {SKEIN_OK, "", ""};
    io_pc2_header header = {0};
    unit u;
    *target = (app_fit_target){0};
    if (!path) return fail("--target", "which point cache is to be matched? --target CACHE.pc2");
    if (!read_unit(arguments, &u) || !find_body(loaded->world, app_value(arguments, "--body"), &surface)) return false;
    io_pc2_reader *reader = io_pc2_open(path, &header, &error);
    if (!reader) return fail(error.where, "%s", error.message);
    uint32_t *particle_of = calloc(header.points + 1u, sizeof *particle_of);
    target->particles = calloc(header.points + 1u, sizeof *target->particles);
    bool good = particle_of && target->particles;
    if (!good) fail(path, "out of memory");
    good = good && match(path, &surface, header.points, particle_of);
    for (uint32_t p = 0; p < header.points && good; p++)
        if (particle_of[p] != UINT32_MAX) target->particles[target->particle_count++] = particle_of[p];
    good = good && read_samples(target, loaded, path, reader, &header, particle_of, &u);
    io_pc2_close(reader);
    free(particle_of);
    return good;
}

void app_fit_target_free(app_fit_target *target) {
    free(target->particles);
    free(target->steps);
    free(target->places);
    *target = (app_fit_target){0};
}
