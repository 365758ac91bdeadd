/* Recordings of what is done in the window; see recorded.h. */
#include "viewer/recorded.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <skein/record.h>

#include "io/file.h"
#include "viewer/stage.h"

static bool put(void *user, const void *bytes, size_t size) {
    io_output_write(user, bytes, size);
    return io_output_status(user, NULL) == SKEIN_OK;
}

/* "a.skeinrec", "a-2.skeinrec", ...; of the world beside the first "a-other.skeinrec". */
static void name_part(const viewer_stage *stage, size_t side, viewer_recorded *r) {
    const char *path = stage->record_path, *slash = strrchr(path, '/'), *dot = strrchr(slash ? slash : path, '.');
    int stem = (int)(dot && dot > path ? (size_t)(dot - path) : strlen(path));
    char number[24] = "";
    if (r->part > 1) snprintf(number, sizeof number, "-%d", r->part);
    snprintf(r->path, sizeof r->path, "%.*s%s%s%s", stem, path, side ? "-other" : "", number, path + stem);
}

/* What its world was built of. Objects that came or went since are in the file with all changes. */
static char *make_note(const viewer_stage *stage, const viewer_player *player) {
    viewer_reading reading = viewer_stage_reading(stage);
    io_scene *anew = player->grown ? viewer_player_scene(player, &reading) : NULL;
    const io_scene *scene = player->grown ? anew : player->scene;
    char *note = scene ? io_scene_note(scene, player->path, NULL, 0) : NULL;
    io_scene_free(anew);
    return note;
}

/* Ends it without a file; `why` NULL: what its output says. */
static void give_up(viewer_stage *stage, size_t side, const char *why) {
    viewer_recorded *r = &stage->recorded[side];
    skein_error error = {SKEIN_OK, "", ""};
    if (r->output) io_output_status(r->output, &error);
    viewer_say(stage, SKEIN_LOG_WARNING, "%s: %s: nothing is recorded any more", r->path, why ? why : error.message);
    io_output_abandon(r->output);
    r->output = NULL;
    stage->records = false;
}

static void begin_side(viewer_stage *stage, size_t side) {
    const viewer_player *player = &stage->sides[side];
    viewer_recorded *r = &stage->recorded[side];
    skein_error error = {SKEIN_OK, "", ""};
    r->steps = 0;
    r->opened = player->opened;
    name_part(stage, side, r);
    if (viewer_player_on_card(player)) {
        give_up(stage, side, "a card's steps have bits of their own, only the processor's can be verified");
        return;
    }
    char *note = make_note(stage, player);
    r->output = note ? io_output_open(r->path, &error) : NULL;
    skein_recorder to = {.write = put, .user = r->output, .note = note};
    if (!r->output) give_up(stage, side, note ? error.message : "the scene's file cannot be read any more");
    else if (skein_record_begin(player->world, &to)) give_up(stage, side, NULL);
    else viewer_event(stage->events, "recording %s", r->path);
    free(note);
}

/* The world that it is of may be gone, which has ended it. A part in which no step was taken shows nothing. */
static void end_side(viewer_stage *stage, size_t side, bool by_hand) {
    viewer_recorded *r = &stage->recorded[side];
    viewer_player *player = &stage->sides[side];
    skein_error error = {SKEIN_OK, "", ""};
    skein_status status = SKEIN_OK;
    bool is_there = player->world && player->opened == r->opened;
    if (is_there && (status = skein_record_end(player->world)) != SKEIN_OK) error = *skein_world_error(player->world);
    bool keep = r->steps > 0 || (by_hand && r->part == 1);
    uint64_t size = io_output_place(r->output);
    if (status || !keep) io_output_abandon(r->output);
    else status = io_output_commit(r->output, &error);
    r->output = NULL;
    if (status) {
        viewer_say(stage, SKEIN_LOG_WARNING, "%s: %s", r->path, error.message);
    } else if (keep) {
        viewer_note(stage, "saved %.140s: %" PRIu64 " steps (%.1f MB); `skein verify` does them again", r->path,
                    r->steps, 1e-6 * (double)size);
        viewer_event(stage->events, "recorded %s steps=%" PRIu64, r->path, r->steps);
        r->part++;
    }
}

void viewer_recorded_begin(viewer_stage *stage, const char *path) {
    char stem[48], name[64];
    if (!path) viewer_free_name(viewer_stem_of(stage, stem), ".skeinrec", name, sizeof name);
    snprintf(stage->record_path, sizeof stage->record_path, "%s", path ? path : name);
    for (size_t s = 0; s < VIEWER_SIDES; s++) stage->recorded[s].part = 1;
    stage->records = true;
    viewer_recorded_follow(stage);
    if (stage->records && stage->side_count)
        viewer_note(stage, "records all that is done in %.140s; J ends it", stage->record_path);
    stage->dirty = true;
}

void viewer_recorded_end(viewer_stage *stage) {
    for (size_t s = 0; s < VIEWER_SIDES; s++)
        if (stage->recorded[s].output) end_side(stage, s, true);
    stage->records = false;
    stage->dirty = true;
}

void viewer_recorded_follow(viewer_stage *stage) {
    for (size_t s = 0; s < VIEWER_SIDES; s++) {
        const viewer_recorded *r = &stage->recorded[s];
        bool is_there = s < stage->side_count;
        if (r->output && !(is_there && stage->sides[s].opened == r->opened)) end_side(stage, s, false);
        if (stage->records && is_there && !r->output) begin_side(stage, s);
    }
}

void viewer_recorded_anew(viewer_stage *stage, size_t side) {
    stage->sides[side].grown = true;
    if (stage->recorded[side].output) end_side(stage, side, false);
    if (stage->records) begin_side(stage, side);
}

void viewer_recorded_step(viewer_stage *stage, size_t side) {
    viewer_recorded *r = &stage->recorded[side];
    if (!r->output) return;
    r->steps++;
    if (io_output_is_due(r->output)) io_output_flush(r->output);
    if (io_output_status(r->output, NULL) == SKEIN_OK) return;
    skein_record_end(stage->sides[side].world);
    give_up(stage, side, NULL);
}
