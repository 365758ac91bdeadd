/* The stage's thread and its clock; see stage.h. */
#include "viewer/stage.h"

#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define GLFW_INCLUDE_NONE
#include <GLFW/glfw3.h>

#include "viewer/blow_up.h"

/* Pictures a second at most; how long steps may go on before the stage looks at what is asked; how often the scene's
 * file is looked at, and speed is judged. */
static const double most_rate = 60, longest_stepping = 0.005, watch_every = 0.25, judge_every = 1, profile_every = 1;
/* What was drawn with less detail is drawn with all of it once nothing has moved for so long (s). */
static const double rest = 0.25;

/* ---- Words ---- */

static void log_line(viewer_stage *stage, skein_log_level level, const char *text) {
    viewer_shown *shown = &stage->exchange->shown;
    pthread_mutex_lock(&stage->exchange->lock);
    viewer_line *line = &shown->log[shown->log_count++ % VIEWER_LOG_LINES];
    line->level = level;
    snprintf(line->text, sizeof line->text, "%.799s", text);
    pthread_mutex_unlock(&stage->exchange->lock);
    stage->news = true;
}

void viewer_say(viewer_stage *stage, skein_log_level level, const char *format, ...) {
    char text[800];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    log_line(stage, level, text);
    viewer_event(stage->events, "%s %s", level == SKEIN_LOG_WARNING ? "warning" : "log", text);
    fprintf(stderr, "skein: %s%s\n", level == SKEIN_LOG_WARNING ? "warning: " : "", text);
    if (level == SKEIN_LOG_WARNING)
        snprintf(stage->message, sizeof stage->message, "%.*s", 239, text), stage->alarm = true;
}

void viewer_note(viewer_stage *stage, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(stage->message, sizeof stage->message, format, arguments);
    va_end(arguments);
    stage->alarm = false;
    stage->spoke = viewer_seconds();
    log_line(stage, SKEIN_LOG_INFO, stage->message);
    viewer_event(stage->events, "note %s", stage->message);
}

void viewer_tell_state(viewer_stage *stage) {
    if (!stage->events->file) return;
    if (!stage->side_count) {
        viewer_event(stage->events, "state no scene");
        return;
    }
    const viewer_player *player = &stage->sides[0];
    const double *eye = stage->camera.lens.eye, *at = stage->camera.lens.target;
    viewer_event(stage->events,
                 "state paused=%d frame=%" PRIu64 " time=%.9g method=%s colour=%d flying=%d sides=%zu hash=%016" PRIx64
                 " eye=%.6g,%.6g,%.6g target=%.6g,%.6g,%.6g",
                 stage->paused, player->frame, skein_world_time(player->world),
                 skein_object_kind(player->world, skein_object_at(player->world, SKEIN_METHOD, 0))->name,
                 player->view.colour, stage->camera.flying, stage->side_count, skein_world_hash(player->world), eye[0],
                 eye[1], eye[2], at[0], at[1], at[2]);
}

/* ---- Time ---- */

static void blew_up(viewer_stage *stage) {
    char words[600];
    viewer_stage_pause(stage, true);
    for (size_t side = 0; side < stage->side_count; side++) {
        viewer_player *player = &stage->sides[side];
        if (viewer_is_finite(player->world)) continue;
        viewer_explain_blow_up(player, words, sizeof words);
        viewer_player_advise_anew(player);
        char help[100] = "smaller substeps or another method may hold it";
        if (player->needed > 0) snprintf(help, sizeof help, "%.0f substeps would hold it", player->needed);
        viewer_say(stage, SKEIN_LOG_WARNING, "%s; %s", words, help);
    }
    stage->sampled = 0;
    stage->facts = true;
}

static bool is_finite(viewer_stage *stage) {
    // looking brings the state back from a card
    double now = viewer_seconds();
    bool look = now - stage->looked > judge_every;
    if (look) stage->looked = now;
    for (size_t s = 0; s < stage->side_count; s++)
        if ((look || !viewer_player_on_card(&stage->sides[s])) && !viewer_is_finite(stage->sides[s].world))
            return false;
    return true;
}

/* Now and then, while the plots are looked at, a step is measured pass by pass; it has the same bits. */
static bool profile_is_due(const viewer_stage *stage) {
    return stage->panel[VIEWER_PANEL_PLOTS] && viewer_seconds() - stage->profiled > profile_every;
}

static bool profile(viewer_stage *stage, bool *new_frame) {
    skein_pass passes[VIEWER_PASSES];
    size_t count = 0;
    bool good = viewer_player_profile(&stage->sides[0], new_frame, passes, VIEWER_PASSES, &count);
    if (count > VIEWER_PASSES) count = VIEWER_PASSES;
    viewer_side *side = &stage->exchange->shown.sides[0];
    pthread_mutex_lock(&stage->exchange->lock);
    side->pass_count = good ? count : 0;
    for (size_t p = 0; p < side->pass_count; p++) {
        side->passes[p].milliseconds = 1e3 * passes[p].seconds * stage->sides[0].steps;
        snprintf(side->passes[p].label, sizeof side->passes[p].label, "%.12s %.48s", passes[p].kind, passes[p].label);
    }
    pthread_mutex_unlock(&stage->exchange->lock);
    stage->profiled = viewer_seconds();
    return good;
}

/* One step of the first side, and as many of the second as bring it to the same time. */
static bool step_all(viewer_stage *stage, bool *new_frame) {
    viewer_player *first = &stage->sides[0];
    if (stage->grab.side == 0) viewer_grab_lead(&stage->grab, first->world, first->dt);
    viewer_lesson_before(stage);
    bool good = profile_is_due(stage) ? profile(stage, new_frame) : viewer_player_step(first, new_frame), ignored;
    viewer_lesson_after(stage);
    if (good) viewer_recorded_step(stage, 0);
    for (size_t s = 1; s < stage->side_count; s++) {
        viewer_player *other = &stage->sides[s];
        while (good && skein_world_time(other->world) + 0.5 * other->dt <= skein_world_time(first->world)) {
            if (stage->grab.side == s) viewer_grab_lead(&stage->grab, other->world, other->dt);
            good = viewer_player_step(other, &ignored);
            if (good) viewer_recorded_step(stage, s);
        }
    }
    return good;
}

void viewer_stage_step(viewer_stage *stage) {
    bool new_frame = false, good = stage->side_count > 0;
    double start = viewer_seconds();
    while (good && !new_frame) good = step_all(stage, &new_frame);
    stage->step_ms = 1e3 * (viewer_seconds() - start);
    if (good && stage->film) viewer_film_frame(stage);
    if (good && !is_finite(stage)) blew_up(stage);
    stage->sampled = 0; // every frame that was asked for is in the plots
    viewer_measure(stage);
    stage->dirty = true;
}

static void judge_speed(viewer_stage *stage, double now) {
    if (now - stage->spoke < 0) stage->spoke = now;
    if (stage->pace.real < judge_every) return;
    char text[300];
    stage->speed = stage->pace.simulated / stage->pace.real;
    viewer_slowness slow = viewer_pace_judge(&stage->pace);
    viewer_slowness_text(slow, &stage->pace, text, sizeof text);
    // the first second of a scene is often slow
    bool tell = text[0] && slow == stage->slow && !stage->told_slow;
    if (tell) viewer_note(stage, "%s", text);
    stage->told_slow |= tell;
    stage->slow = slow;
    viewer_event(stage->events, "pace speed=%.3f pictures=%.3g step_ms=%.4g draw_ms=%.4g level=%d slow=%s",
                 stage->speed, (double)stage->pace.pictures / stage->pace.real,
                 1e3 * stage->pace.worked / fmax((double)stage->pace.steps, 1), stage->draw_ms, stage->level,
                 viewer_slowness_word(stage->slow));
    stage->pace = (viewer_pace){0};
}

/* Seconds of processor time that this thread has had. */
static double worked_seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

static bool plays(const viewer_stage *stage) {
    return stage->side_count && !stage->paused && !viewer_stage_by_key(stage) && !viewer_handles_wait(stage);
}

/* Takes steps that are due, for a few milliseconds; the others stay due. What a slow machine cannot do in time is
 * dropped, so that it never has to catch up. */
static void advance(viewer_stage *stage) {
    double now = viewer_seconds(), elapsed = now - stage->last;
    stage->last = now;
    if (viewer_camera_move(&stage->camera, fmin(elapsed, 0.1))) stage->dirty = true;
    if (!plays(stage)) stage->due = 0;
    if (!plays(stage)) return;
    stage->due += skein_pacer_feed(&stage->pacer, elapsed);
    if (stage->due > stage->pacer.most_steps) stage->due = stage->pacer.most_steps;
    bool good = true;
    int taken = 0;
    double worked = worked_seconds();
    while (stage->due > 0 && good && viewer_seconds() - now < longest_stepping) {
        bool new_frame;
        good = step_all(stage, &new_frame);
        stage->due--, taken++;
        stage->pace.simulated += good ? stage->pacer.step : 0;
        if (good && new_frame && stage->film) viewer_film_frame(stage);
    }
    stage->pace.real += elapsed;
    stage->pace.steps += (size_t)taken;
    stage->pace.worked += worked_seconds() - worked;
    if (taken) stage->step_ms = 1e3 * (viewer_seconds() - now) / taken * stage->sides[0].steps;
    judge_speed(stage, now);
    if (!good) viewer_stage_pause(stage, true);
    else if (!is_finite(stage)) blew_up(stage);
    if (taken) viewer_measure(stage);
    stage->dirty = true; // time goes on between steps, too
}

/* Whether pictures follow each other: time goes on, or the camera is moved. */
static bool moves(const viewer_stage *stage) {
    bool moving = plays(stage) || stage->button >= 0;
    for (int m = 0; m < VIEWER_MOTION_COUNT; m++) moving |= stage->camera.down[m];
    return moving;
}

/* How long nothing has to happen by itself. */
static double patience(viewer_stage *stage) {
    double now = viewer_seconds(), wait = watch_every;
    if (plays(stage) && stage->due > 0) return 0;
    if (moves(stage)) wait = fmax(stage->last + 1 / most_rate - now, 0);
    // a picture that the painter is busy with ends the wait
    if (stage->dirty && !viewer_painter_busy(&stage->painter))
        wait = fmin(wait, fmax(stage->begun + 1 / most_rate - now, 0));
    if (!stage->dirty && !stage->sharp) wait = fmin(wait, fmax(stage->begun + rest - now, 0.01));
    return wait;
}

/* ---- The thread ---- */

static void publish(viewer_stage *stage) {
    viewer_exchange *exchange = stage->exchange;
    viewer_measure(stage);
    viewer_lesson_refresh(stage);
    pthread_mutex_lock(&exchange->lock);
    viewer_mirror(stage);
    pthread_mutex_unlock(&exchange->lock);
    stage->news = false;
}

/* The painter is idle: a picture of what there is now, or where nothing has changed one for the gallery. */
static void paint_next(viewer_stage *stage) {
    viewer_end_picture(stage);
    double now = viewer_seconds();
    if (stage->dirty && now >= stage->begun + 1 / most_rate) {
        bool moving = moves(stage) || now - stage->stirred < rest;
        stage->stirred = now;
        viewer_begin_picture(stage, !moving);
        publish(stage); // together with the picture
    } else if (!stage->dirty && !stage->sharp && now >= stage->begun + rest) {
        viewer_begin_picture(stage, true);
    } else if (!stage->dirty && stage->panel[VIEWER_PANEL_GALLERY]) {
        viewer_gallery_work(stage);
    }
}

static void turn(viewer_stage *stage) {
    size_t count;
    const viewer_request *requests = viewer_take(stage->exchange, patience(stage), &count);
    for (size_t i = 0; i < count && !stage->closing; i++) viewer_stage_answer(stage, &requests[i]);
    if (stage->closing) return;
    double now = viewer_seconds();
    if (now - stage->watched >= watch_every) {
        viewer_watch(stage, false);
        stage->watched = now;
    }
    if (stage->advice_due > 0 && now >= stage->advice_due && stage->side_count) {
        stage->advice_due = 0;
        viewer_player_advise_anew(&stage->sides[0]);
        stage->news = true;
    }
    advance(stage);
    if (stage->message[0] && now - stage->spoke > 6) {
        stage->message[0] = 0;
        stage->news = true;
    }
    // the panels' answer does not wait for a picture
    if (count || stage->news) {
        publish(stage);
        if (stage->exchange->wake) stage->exchange->wake();
    }
    if (!viewer_painter_busy(&stage->painter)) paint_next(stage);
}

static void *stage_thread(void *data) {
    viewer_stage *stage = data;
    skein_error error = {SKEIN_OK, "", ""};
    if (stage->card) glfwMakeContextCurrent(stage->card);
    if (viewer_pictures_open(stage, &error)) {
        stage->last = stage->spoke = viewer_seconds();
        if (stage->options->record) viewer_recorded_begin(stage, stage->options->record);
        if (stage->options->path) viewer_stage_open(stage, stage->options->path, stage->options->sets);
        if (stage->side_count && stage->options->compare) viewer_stage_compare(stage, stage->options->compare);
        if (!stage->side_count) stage->panel[VIEWER_PANEL_GALLERY] = true;
        viewer_gallery_open(stage);
        viewer_recent_read(&stage->recent);
        stage->dirty = true;
        while (!stage->closing) turn(stage);
        if (stage->film) viewer_film_toggle(stage);
        viewer_recorded_end(stage);
        viewer_gallery_close(stage);
        viewer_lesson_release(&stage->lesson);
        viewer_hunt_release(&stage->hunt);
        viewer_handles_release_memory(&stage->handles);
        for (size_t s = 0; s < VIEWER_SIDES; s++) viewer_player_close(&stage->sides[s]);
    } else {
        stage->failure = error;
    }
    viewer_pictures_close(stage);
    if (stage->card) glfwMakeContextCurrent(NULL);
    viewer_event(stage->events, "opengl stage errors=%zu warnings=%zu %s", stage->messages.errors,
                 stage->messages.warnings, stage->messages.last);
    pthread_mutex_lock(&stage->exchange->lock);
    stage->exchange->shown.finished = true;
    pthread_mutex_unlock(&stage->exchange->lock);
    if (stage->exchange->wake) stage->exchange->wake();
    return NULL;
}

bool viewer_stage_start(viewer_stage *stage, const viewer_options *options, viewer_exchange *exchange,
                        GLFWwindow *context, GLFWwindow *card) {
    stage->options = options;
    stage->exchange = exchange;
    stage->events = exchange->events;
    stage->context = context;
    stage->card = card;
    stage->paused = options->paused;
    stage->panel[VIEWER_PANEL_SIDE] = options->panels;
    stage->light = options->theme == VIEWER_LIGHT;
    stage->button = -1;
    stage->newest = -1;
    stage->speed = 1;
    stage->pacer = skein_default_pacer();
    return !pthread_create(&stage->thread, NULL, stage_thread, stage);
}

void viewer_stage_join(viewer_stage *stage) {
    viewer_request close = {.kind = VIEWER_CLOSE};
    viewer_ask(stage->exchange, &close);
    pthread_join(stage->thread, NULL);
}
