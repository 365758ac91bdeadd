/* A ring of frames; see history.h. */
#include "viewer/history.h"

#include <stdlib.h>
#include <string.h>

#include <skein/cut.h>

enum { MOST_FRAMES = 1200, LEAST_FRAMES = 2 };
static const size_t most_bytes = (size_t)256 << 20;

/* ---- Cuts ---- */

/* A body's faces, and which of them are cut (NULL: none ever was). */
static size_t faces_of(const skein_world *world, size_t body, skein_cuts *cuts) {
    skein_handle handle = skein_object_at(world, SKEIN_BODY, body);
    skein_surface s;
    if (skein_body_surface(world, handle, &s) || skein_body_cuts(world, handle, cuts)) return 0;
    return s.face_count;
}

static size_t all_faces(const skein_world *world) {
    size_t sum = 0;
    skein_cuts cuts;
    for (size_t b = 0; b < skein_object_count(world, SKEIN_BODY); b++) sum += faces_of(world, b, &cuts);
    return sum;
}

static void forget_cuts(viewer_history *history, size_t from) {
    for (size_t i = from; i < history->cut_count; i++) free(history->cuts[i].face);
    if (from < history->cut_count) history->cut_count = from;
}

/* Notes what is cut from this frame on, where that has changed. */
static void keep_cuts(viewer_history *history, const skein_world *world, uint64_t frame) {
    uint64_t changes = 0;
    size_t known = history->cut_count, at = 0;
    skein_cuts cuts;
    while (known && history->cuts[known - 1].frame >= frame) known--;
    bool forgot = known < history->cut_count;
    forget_cuts(history, known);
    for (size_t b = 0; b < skein_object_count(world, SKEIN_BODY); b++) {
        faces_of(world, b, &cuts);
        changes += cuts.changes;
    }
    if ((changes == history->cut_changes && !forgot) || all_faces(world) != history->faces) return;
    if (known == history->cut_room) {
        size_t room = 2 * known + 8;
        viewer_history_cut *grown = realloc(history->cuts, room * sizeof *grown);
        if (!grown) return;
        history->cuts = grown, history->cut_room = room;
    }
    unsigned char *face = calloc(history->faces + 1, 1);
    if (!face) return;
    for (size_t b = 0; b < skein_object_count(world, SKEIN_BODY); b++) {
        size_t count = faces_of(world, b, &cuts);
        if (cuts.face && count) memcpy(face + at, cuts.face, count);
        at += count;
    }
    history->cuts[history->cut_count++] = (viewer_history_cut){frame, face};
    history->cut_changes = changes;
    // what is known of frames that are forgotten goes, but for what holds on from there
    size_t old = 0;
    while (old + 1 < history->cut_count && history->cuts[old + 1].frame <= history->first)
        free(history->cuts[old++].face);
    history->cut_count -= old;
    memmove(history->cuts, history->cuts + old, history->cut_count * sizeof *history->cuts);
}

/* Makes a body cut where `face` (NULL: nowhere) says so. */
static bool set_cut(skein_world *world, skein_handle body, const skein_cuts *now, const unsigned char *face,
                    size_t count) {
    uint32_t *list = malloc(count * sizeof *list + 1);
    size_t length = 0, same = 0;
    for (size_t f = 0; f < count && list; f++) {
        if (face && face[f]) list[length++] = (uint32_t)f;
        same += (now->face && now->face[f]) == (face && face[f]);
    }
    bool good = list && (same == count ||
                         (!skein_cut_mend(world, body) && (!length || !skein_cut_faces(world, body, list, length))));
    free(list);
    return good;
}

static bool restore_cuts(const viewer_history *history, skein_world *world, uint64_t frame) {
    const viewer_history_cut *cut = NULL;
    size_t at = 0;
    bool good = true;
    for (size_t i = 0; i < history->cut_count && history->cuts[i].frame <= frame; i++) cut = &history->cuts[i];
    if (all_faces(world) != history->faces) return true; // of another world
    for (size_t b = 0; b < skein_object_count(world, SKEIN_BODY); b++) {
        skein_cuts now;
        size_t count = faces_of(world, b, &now);
        if (count)
            good &= set_cut(world, skein_object_at(world, SKEIN_BODY, b), &now, cut ? cut->face + at : NULL, count);
        at += count;
    }
    return good;
}

/* ---- Frames ---- */

void viewer_history_release(viewer_history *history) {
    free(history->state);
    free(history->held);
    free(history->times);
    free(history->scratch);
    forget_cuts(history, 0);
    free(history->cuts);
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
    forget_cuts(history, 0);
    history->cut_changes = 0;
    history->faces = all_faces(world);
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
    keep_cuts(history, world, frame);
}

bool viewer_history_restore(viewer_history *history, skein_world *world, uint64_t frame) {
    bool kept = !history->empty && frame >= history->first && frame <= history->last;
    if (!kept || skein_particle_count(world) != history->particles) return false;
    size_t place = (size_t)(frame % history->room), count = history->particles;
    const skein_real *state = history->state + place * 6 * count;
    const unsigned char *held = history->held + place * count;
    if (!restore_cuts(history, world, frame)) return false;
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
