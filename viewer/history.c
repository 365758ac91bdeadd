/* A ring of frames; see history.h. */
#include "viewer/history.h"

#include <stdlib.h>
#include <string.h>

enum { MOST_FRAMES = 1200, LEAST_FRAMES = 2 };
static const size_t most_bytes = (size_t)256 << 20;

void viewer_history_release(viewer_history *history) {
    free(history->state);
    free(history->held);
    free(history->times);
    free(history->scratch);
    memset(history, 0, sizeof *history);
    history->empty = true;
}

bool viewer_history_begin(viewer_history *history, const skein_world *world) {
    size_t particles = skein_particle_count(world);
    if (particles != history->particles || !history->state) {
        viewer_history_release(history);
        size_t bytes = 6 * particles * sizeof *history->state + particles + sizeof *history->times;
        size_t room = bytes ? most_bytes / bytes : MOST_FRAMES;
        history->particles = particles;
        history->room = room > MOST_FRAMES ? MOST_FRAMES : room < LEAST_FRAMES ? LEAST_FRAMES : room;
        // what is not yet written takes no memory
        history->state = malloc(history->room * 6 * particles * sizeof *history->state + 1);
        history->held = malloc(history->room * particles + 1);
        history->times = malloc(history->room * sizeof *history->times);
        history->scratch = malloc(3 * particles * sizeof *history->scratch + 1);
    }
    history->empty = true;
    history->first = history->last = 0;
    bool good = history->state && history->held && history->times && history->scratch;
    if (!good) viewer_history_release(history);
    return good;
}

void viewer_history_keep(viewer_history *history, const skein_world *world, uint64_t frame) {
    if (!history->state || skein_particle_count(world) != history->particles) return;
    size_t place = (size_t)(frame % history->room), count = history->particles;
    skein_real *x = history->state + place * 6 * count, *v = x + 3 * count;
    unsigned char *held = history->held + place * count;
    skein_view where = skein_position_view(world), how = skein_velocity_view(world);
    for (size_t i = 0; i < count; i++) {
        const skein_real *p = where.xyzw + 4 * (size_t)where.slot_of[i], *q = how.xyzw + 4 * (size_t)how.slot_of[i];
        memcpy(x + 3 * i, p, 3 * sizeof *p);
        memcpy(v + 3 * i, q, 3 * sizeof *q);
        held[i] = !(p[3] > 0);
    }
    history->times[place] = skein_world_time(world);
    if (history->empty) history->first = frame;
    history->empty = false;
    history->last = frame;
    if (history->last - history->first >= history->room) history->first = history->last - history->room + 1;
}

bool viewer_history_restore(viewer_history *history, skein_world *world, uint64_t frame) {
    bool kept = !history->empty && frame >= history->first && frame <= history->last;
    if (!kept || skein_particle_count(world) != history->particles) return false;
    size_t place = (size_t)(frame % history->room), count = history->particles;
    const skein_real *state = history->state + place * 6 * count;
    const unsigned char *held = history->held + place * count;
    skein_view where = skein_position_view(world);
    // holding stops a particle, so velocities come last
    for (size_t i = 0; i < count; i++) {
        bool now = !(where.xyzw[4 * (size_t)where.slot_of[i] + 3] > 0);
        if (now != (held[i] != 0)) skein_particle_pin(world, i, held[i] != 0);
    }
    for (size_t i = 0; i < 3 * count; i++) history->scratch[i] = (double)state[i];
    bool good = !skein_positions_set(world, 0, count, history->scratch);
    for (size_t i = 0; i < 3 * count; i++) history->scratch[i] = (double)state[3 * count + i];
    return good && !skein_velocities_set(world, 0, count, history->scratch) &&
           !skein_world_time_set(world, history->times[place]);
}
