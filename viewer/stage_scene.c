/* What happens to the stage's scenes: opening, going back, comparing two. */
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "viewer/stage.h"

static void player_says(void *user, skein_log_level level, const char *text) {
    viewer_say(user, level, "%s", text);
}

viewer_reading viewer_stage_reading(const viewer_stage *stage) {
    return (viewer_reading){stage->options->exporters, stage->options->threads, stage->options->prepare,
                            stage->options->allowed, stage->card ? stage->options->device : VIEWER_ON_PROCESSOR};
}

/* After anything that took time which must not count, or that changed what the clock steps. */
static void restart_clock(viewer_stage *stage) {
    const viewer_player *player = &stage->sides[0];
    stage->last = viewer_seconds();
    stage->pace = (viewer_pace){0};
    stage->speed = 1;
    stage->slow = VIEWER_IN_TIME;
    stage->told_slow = false;
    stage->sampled = 0;
    stage->grab.holding = false;
    stage->ride = (viewer_ride){.bird = UINT32_MAX};
    stage->facts = stage->dirty = true;
    if (!stage->side_count) return;
    int most = 4 * player->steps;
    stage->pacer = (skein_pacer){.step = player->dt, .most_steps = most > 8 ? most : 8};
}

/* ---- Opening ---- */

static void end_compare(viewer_stage *stage) {
    if (stage->side_count > 1) viewer_player_close(&stage->sides[1]);
    if (stage->side_count > 1) stage->side_count = 1;
    stage->compare[0] = 0;
}

static void note_opened(viewer_stage *stage, const char *how) {
    const viewer_player *player = &stage->sides[0];
    viewer_event(stage->events, "%s particles=%zu bodies=%zu path=%s", how, skein_particle_count(player->world),
                 skein_object_count(player->world, SKEIN_BODY), player->path);
}

void viewer_stage_open(viewer_stage *stage, const char *path, const char *const *sets) {
    viewer_reading reading = viewer_stage_reading(stage);
    if (stage->film) viewer_film_toggle(stage);
    if (!viewer_player_open(&stage->sides[0], path, sets, &reading, (viewer_reporter){player_says, stage})) {
        viewer_event(stage->events, "cannot open %s", path);
        stage->panel[VIEWER_PANEL_LOG] = true;
        if (!stage->side_count) snprintf(stage->wanted, sizeof stage->wanted, "%s", path);
        viewer_watch(stage, true);
        restart_clock(stage);
        return;
    }
    if (!stage->side_count) stage->side_count = 1;
    end_compare(stage);
    stage->panel[VIEWER_PANEL_GALLERY] = false;
    stage->camera.placed = false;
    viewer_stage_follow(stage);
    stage->in_parts = true;
    viewer_watch(stage, true);
    restart_clock(stage);
    viewer_handles_anew(stage, true);
    viewer_offer_forget(stage);
    viewer_lesson_begin(stage);
    const char *name = stage->sides[0].settings.name;
    viewer_note(stage, "%s: %zu particles", name[0] ? name : path, skein_particle_count(stage->sides[0].world));
    note_opened(stage, "opened");
    viewer_recorded_follow(stage);
    skein_error error = {SKEIN_OK, "", ""};
    if (!viewer_recent_add(&stage->recent, path, &error))
        viewer_say(stage, SKEIN_LOG_INFO, "%s: %s", error.where, error.message);
}

void viewer_stage_follow(viewer_stage *stage) {
    viewer_camera *camera = &stage->camera;
    const char *body = stage->sides[0].view.camera.follow;
    bool did = camera->follows;
    camera->follows = body[0] != 0;
    camera->has_middle = camera->placed = false;
    stage->dirty = true;
    if (camera->follows) viewer_note(stage, "the view goes along with %.100s; T ends it", body);
    else if (did) viewer_note(stage, "the view stands still");
}

static void compare_with(viewer_stage *stage, const char *set, const viewer_changes *own);

bool viewer_stage_reopen(viewer_stage *stage, viewer_changes *changes, bool stays) {
    viewer_reading reading = viewer_stage_reading(stage);
    if (stage->film) viewer_film_toggle(stage);
    char followed[PLAYER_NAME];
    snprintf(followed, sizeof followed, "%s", stage->sides[0].view.camera.follow);
    bool good = viewer_player_reopen(&stage->sides[0], changes, stays, &reading);
    if (good && strcmp(followed, stage->sides[0].view.camera.follow) != 0) viewer_stage_follow(stage);
    if (!good) {
        viewer_note(stage, "the scene has a fault (see the log): the last good one goes on");
        stage->panel[VIEWER_PANEL_LOG] = true;
        viewer_event(stage->events, "kept path=%s", stage->sides[0].path);
    } else {
        note_opened(stage, "reopened");
        if (stage->side_count > 1) {
            char compare[VIEWER_TEXT];
            viewer_changes own;
            memcpy(compare, stage->compare, sizeof compare);
            bool copied = viewer_changes_copy(&own, &stage->sides[1].changes);
            compare_with(stage, compare, copied ? &own : NULL);
            if (copied) viewer_changes_free(&own);
        }
    }
    viewer_watch(stage, true);
    restart_clock(stage);
    viewer_handles_anew(stage, false);
    viewer_recorded_follow(stage);
    return good;
}

void viewer_stage_reload(viewer_stage *stage) {
    const viewer_changes *changes = &stage->sides[0].changes;
    if (!viewer_stage_reopen(stage, NULL, false)) return;
    if (changes->done > changes->given)
        viewer_note(stage, "read again, with your changes on top (%zu)", changes->done - changes->given);
    else viewer_note(stage, "read again");
}

/* ---- Two side by side ---- */

/* Two worlds from the start, the second with one more set and what was changed in it, or NULL. */
static void compare_with(viewer_stage *stage, const char *set, const viewer_changes *own) {
    viewer_reading reading = viewer_stage_reading(stage);
    char text[VIEWER_TEXT];
    snprintf(text, sizeof text, "%s", set); // it may be the stage's own
    if (!stage->side_count) return;
    end_compare(stage);
    if (text[0]) {
        viewer_changes changes = {NULL, 0, 0, 0, 0};
        bool good =
            viewer_changes_copy(&changes, &stage->sides[0].changes) && viewer_changes_add(&changes, text, NULL, NULL);
        size_t given = changes.count;
        for (size_t i = own ? own->given : 0; own && good && i < own->done; i++)
            good = viewer_changes_add(&changes, own->data[i].set, NULL, NULL);
        const char **sets = good ? viewer_changes_sets(&changes) : NULL;
        good = sets && viewer_player_open(&stage->sides[1], stage->sides[0].path, sets, &reading,
                                          (viewer_reporter){player_says, stage});
        free(sets);
        viewer_changes_free(&changes);
        if (good) {
            stage->side_count = 2;
            stage->sides[1].changes.given = given;
            snprintf(stage->compare, sizeof stage->compare, "%s", text);
            stage->sides[1].view = stage->sides[0].view;
            viewer_stage_reset(stage); // both begin together
            viewer_note(stage, "side by side with %s, from the start", text);
        }
    } else {
        viewer_note(stage, "one scene again");
    }
    stage->camera.placed = false;
    restart_clock(stage);
    viewer_handles_anew(stage, false);
    viewer_recorded_follow(stage);
    viewer_tell_state(stage);
}

void viewer_stage_compare(viewer_stage *stage, const char *set) {
    compare_with(stage, set, NULL);
}

/* ---- Time ---- */

void viewer_stage_pause(viewer_stage *stage, bool paused) {
    if (stage->paused == paused) return;
    stage->paused = paused;
    stage->paused_by_focus = false;
    stage->last = viewer_seconds();
    stage->pace = (viewer_pace){0};
    stage->dirty = true;
    viewer_event(stage->events, paused ? "paused" : "plays");
}

void viewer_stage_reset(viewer_stage *stage) {
    stage->grab.holding = false;
    for (size_t s = 0; s < stage->side_count; s++) viewer_player_reset(&stage->sides[s]);
    stage->pacer.remainder = 0;
    for (size_t s = 0; s < VIEWER_SIDES; s++) {
        pthread_mutex_lock(&stage->exchange->lock);
        memset(&stage->exchange->shown.sides[s].plots, 0, sizeof(viewer_plots));
        pthread_mutex_unlock(&stage->exchange->lock);
    }
    stage->sampled = 0;
    stage->dirty = true;
    viewer_event(stage->events, "reset");
}

void viewer_stage_go_to(viewer_stage *stage, uint64_t frame) {
    bool kept = stage->side_count > 0;
    stage->grab.holding = false;
    for (size_t s = 0; s < stage->side_count; s++) kept &= viewer_player_go_to(&stage->sides[s], frame);
    if (!kept) viewer_note(stage, "frame %" PRIu64 " is not kept any more", frame);
    else viewer_event(stage->events, "went to %" PRIu64, frame);
    stage->pacer.remainder = 0;
    stage->sampled = 0;
    stage->dirty = true;
}

/* ---- Scenes that advance by keys ---- */

bool viewer_stage_by_key(const viewer_stage *stage) {
    return stage->side_count && stage->sides[0].settings.advance == IO_BY_KEY;
}
