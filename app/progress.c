/* A progress bar, Ctrl-C as a flag that loops ask for, and one frame's steps, which say what went wrong in them. */
#include "app/progress.h"

#include "app/terminal.h"

#include <math.h>
#include <signal.h>
#include <stdio.h>
#include <unistd.h>

#include "app/verdict.h"

/* ---- interrupts ---- */

static volatile sig_atomic_t interrupted, catching;

static void on_interrupt(int number) {
    interrupted = number;
}

void app_catch_interrupts(void) {
    struct sigaction action = {.sa_handler = on_interrupt, .sa_flags = (int)SA_RESETHAND | SA_RESTART};
    catching = 1;
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
}

bool app_interrupt(int number) {
    if (catching) interrupted = number;
    return catching;
}

int app_interrupted(void) {
    return interrupted;
}

/* ---- progress ---- */

app_progress app_progress_start(const char *what, int frames, bool quiet) {
    return (app_progress){.what = what,
                          .quiet = quiet || !frames,
                          .terminal = isatty(STDERR_FILENO) != 0,
                          .frames = frames,
                          .start = app_seconds()};
}

void app_progress_show(app_progress *p, int frame) {
    double now = app_seconds(), elapsed = now - p->start;
    bool due = p->terminal ? now - p->last >= 0.05 : frame % ((p->frames + 9) / 10) == 0;
    if (p->quiet || (!due && frame != p->frames)) return;
    p->last = now;
    char bar[31];
    for (int i = 0; i < 30; i++) bar[i] = i < (int)(30.0 * frame / p->frames) ? '#' : '.';
    bar[30] = 0;
    app_terminal_draw("%s[%s] %s %d of %d, %.1f s, %.0f s left%s", p->terminal ? "\r" : "", bar, p->what, frame,
                      p->frames, elapsed, elapsed / frame * (p->frames - frame), p->terminal ? "   " : "\n");
    p->line_open = p->terminal;
}

void app_progress_end(app_progress *p) {
    if (p->line_open) fprintf(stderr, "\n");
    p->line_open = false;
}

/* ---- a frame ---- */

enum { FRAMES_BETWEEN_LOOKS = 60 };

bool app_step_frame(const app_scene *loaded, int frame, int steps, double dt, app_progress *p) {
    skein_world *world = loaded->world;
    bool good = true;
    for (int s = 0; s < steps && good; s++) good = !skein_world_step(world, dt);
    // a card would have to send the state each time
    bool looks = skein_world_device(world).device == SKEIN_DEVICE_CPU || frame % FRAMES_BETWEEN_LOOKS == 0;
    if (good && (!looks || io_is_finite(world))) return true;
    // said at once, instead of writing such files to the end
    app_progress_end(p);
    skein_statistics now;
    skein_error error;
    char remedy[200];
    if (!good || skein_world_statistics(world, &now)) error = *skein_world_error(world);
    else
        io_error_set(&error, SKEIN_ERROR_VALUE, loaded->path,
                     "blew up in frame %d: %zu of %zu particles are no longer finite; %s", frame, now.nonfinite,
                     now.particles, app_remedy(loaded, remedy, sizeof remedy));
    app_print_error(&error);
    app_keep_error(&error, p->failure);
    return false;
}
