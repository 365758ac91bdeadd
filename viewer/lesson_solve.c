/* One solve of a scene that advances by keys, and what it found: each constraint's value and derivatives before and after,
 * by the same automatic derivatives, however the constraint was made. */
#include <inttypes.h>
#include <math.h>
#include <string.h>

#include "viewer/stage.h"

enum { MOST_SAID = 4, MOST_PARTICLES = VIEWER_LESSON_PARTICLES };

/* A constraint, as it was at a time. */
typedef struct said {
    skein_handle object;
    size_t index;
    char name[64];
    double value, gradient[MOST_PARTICLES][3], place[MOST_PARTICLES][3];
    uint32_t particle[MOST_PARTICLES];
    size_t particles, all_particles;
} said;

static bool look(skein_world *world, said *s, double *stiffness) {
    skein_constraint_value value;
    if (skein_constraint_evaluate(world, s->object, s->index, &value, s->particle, &s->gradient[0][0], MOST_PARTICLES))
        return false;
    s->value = value.value;
    s->all_particles = value.particle_count;
    s->particles = value.particle_count < MOST_PARTICLES ? value.particle_count : MOST_PARTICLES;
    for (size_t i = 0; i < s->particles; i++) skein_positions_copy(world, s->particle[i], 1, s->place[i]);
    if (!s->name[0]) snprintf(s->name, sizeof s->name, "%.63s", value.label);
    *stiffness = value.stiffness;
    return true;
}

/* Those that pull at all, up to `most`; returns how many there are. */
static size_t find(skein_world *world, said *list, size_t most) {
    static const skein_category categories[2] = {SKEIN_CONSTRAINT, SKEIN_BODY};
    size_t found = 0;
    for (int c = 0; c < 2; c++)
        for (size_t o = 0; o < skein_object_count(world, categories[c]); o++) {
            size_t count = 0;
            skein_value enabled;
            skein_handle object = skein_object_at(world, categories[c], o);
            if (skein_get(world, object, "enabled", &enabled) || enabled.number[0] == 0) continue;
            if (skein_constraint_count(world, object, &count)) continue;
            for (size_t i = 0; i < count; i++) {
                said one = {.object = object, .index = i};
                double stiffness;
                if (!look(world, &one, &stiffness) || !(stiffness > 0)) continue;
                if (found < most) list[found] = one;
                found++;
            }
        }
    return found;
}

/* Without a minus at 0. */
static double plain(double x) {
    return x + 0.0;
}

static void put_derivatives(const said *s, char *text, size_t size) {
    size_t length = 0;
    text[0] = 0;
    for (size_t i = 0; i < 3 * s->particles && length < size; i++)
        length += (size_t)snprintf(text + length, size - length, " %.6g", plain(s->gradient[i / 3][i % 3]));
    if (s->all_particles > s->particles && length < size)
        snprintf(text + length, size - length, " (and of %zu more particles)", s->all_particles - s->particles);
}

static void put_places(const said *s, char *text, size_t size) {
    size_t length = 0;
    text[0] = 0;
    for (size_t i = 0; i < s->particles && length < size; i++)
        length += (size_t)snprintf(text + length, size - length, "%s(%.6g, %.6g, %.6g)", i ? " " : "",
                                   plain(s->place[i][0]), plain(s->place[i][1]), plain(s->place[i][2]));
}

static void say(viewer_stage *stage, const said *s, const char *when) {
    char derivatives[400], places[300];
    put_derivatives(s, derivatives, sizeof derivatives);
    put_places(s, places, sizeof places);
    viewer_say(stage, SKEIN_LOG_INFO, "solve %" PRIu64 " %s %s: C %.6g; derivatives%s; at %s", stage->sides[0].frame,
               s->name, when, plain(s->value), derivatives, places);
}

/* In short, for the window; the log has it in full. */
static void note(viewer_stage *stage, const said *before, const said *after) {
    char derivatives[400];
    put_derivatives(before, derivatives, sizeof derivatives);
    bool fits = before->particles <= 2;
    viewer_note(stage, "solve %" PRIu64 " %s: C %.6g; derivatives%s; then C %.6g", stage->sides[0].frame, before->name,
                plain(before->value), fits ? derivatives : " in the log (F4)", plain(after->value));
}

void viewer_stage_solve(viewer_stage *stage) {
    said before[MOST_SAID], after[MOST_SAID];
    double ignored;
    if (!stage->side_count) return;
    skein_world *world = stage->sides[0].world;
    size_t count = find(world, before, MOST_SAID), shown = count < MOST_SAID ? count : MOST_SAID;
    viewer_stage_step(stage);
    for (size_t i = shown; i-- > 0;) {
        after[i] = before[i];
        if (!look(world, &after[i], &ignored)) continue;
        say(stage, &before[i], "before");
        say(stage, &after[i], "after");
        if (i == 0) note(stage, &before[0], &after[0]);
    }
    if (count > shown)
        viewer_say(stage, SKEIN_LOG_INFO, "solve %" PRIu64 ": there are %zu more constraints", stage->sides[0].frame,
                   count - shown);
    if (!count) viewer_note(stage, "solve %" PRIu64 ": there is no constraint", stage->sides[0].frame);
}
