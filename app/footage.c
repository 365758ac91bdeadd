/* A film while a world is stepped: the camera placed by a run ahead, the picture drawn, the encoder fed. */
#include "app/footage.h"

#ifdef SKEIN_RENDER
#include <stdio.h>
#include <stdlib.h>

#include "app/progress.h"
#include "app/terminal.h"
#include "render/studio.h"
#include "render/world_frame.h"

/* The camera takes in so many frames at most, and nothing that makes the subject so many times wider than the
 * start and the ways on which pinned particles are led: what falls out of the world or blows up is let go. */
enum { MOST_AHEAD = 900, MOST_GROWTH = 4 };

struct app_footage {
    const app_scene *loaded;
    render_studio *studio;
    film *film;
    render_image image;
    bool drawing; /* a picture is begun, and not yet in the film */
    bool told;    /* a fault was printed: one is enough */
    int frame, every;
    app_footage_facts facts;
};

/* ---- looking ahead ---- */

static void ignore_fault(void *user, const skein_error *error) {
    (void)user, (void)error; // the same was built before without one
}

/* What the camera is to hold, and what that is measured by: the start, and where pinned particles have been since, for
 * these neither fall nor blow up. */
typedef struct subject_ahead {
    render_subject held;
    render_hull start, led;
} subject_ahead;

static void add_pinned(render_hull *hull, const skein_world *world) {
    skein_view view = skein_position_view(world);
    for (size_t i = 0; i < view.count; i++) {
        const skein_real *x = view.xyzw + 4 * (size_t)view.slot_of[i];
        const double at[3] = {(double)x[0], (double)x[1], (double)x[2]};
        if (x[3] == 0 && skein_particle_present(world, i)) render_hull_add(hull, at, 0);
    }
}

/* Adds what the world holds now, unless that makes it far too large: then only what is led. */
static void take_in(subject_ahead *taken, render_world_frame *frame, skein_world *world, const render_view *view) {
    if (render_world_frame_update(frame, world, view, NULL)) return;
    render_subject both = render_subject_of(render_world_frame_get(frame));
    if (render_hull_empty(&both.all)) return;
    render_subject_join(&both, &taken->held);
    if (render_hull_empty(&taken->start)) taken->start = both.all;
    double middle[3]; // a camera that follows somebody has him whatever his way is
    if (!render_world_frame_followed(frame, middle)) add_pinned(&taken->led, world);
    render_hull meant = taken->start;
    render_hull_join(&meant, &taken->led);
    render_bounds bounds = render_hull_bounds(&both.all), least = render_hull_bounds(&meant);
    if (render_bounds_radius(&bounds) <= MOST_GROWTH * render_bounds_radius(&least)) {
        taken->held = both;
        return;
    }
    render_hull_join(&taken->held.bodies, &taken->led);
    render_hull_join(&taken->held.all, &taken->led);
}

/* All that the first frames hold, from a run of its own. */
static render_subject look_ahead(const app_scene *loaded, int frames, bool quiet) {
    subject_ahead taken = {render_subject_nothing(), render_hull_nothing(), render_hull_nothing()};
    io_faults faults = {ignore_fault, NULL, 0, NULL};
    skein_world_desc desc = skein_default_world_desc();
    desc.thread_count = loaded->settings.threads;
    skein_world *world = io_scene_build(loaded->scene, &desc, &faults);
    // where a card steps the world, it looks ahead as well
    skein_device device = skein_world_device(loaded->world).device;
    if (world && (device == SKEIN_DEVICE_GPU || device == SKEIN_DEVICE_CURRENT_GL))
        skein_world_device_set(world, SKEIN_DEVICE_CURRENT_GL);
    render_world_frame *frame = render_world_frame_create(NULL);
    double dt;
    int steps = io_scene_steps_per_frame(&loaded->settings, &dt);
    if (frames > MOST_AHEAD) frames = MOST_AHEAD;
    app_progress p = app_progress_start("looking ahead: frame", frames, quiet);
    p.quiet |= !p.terminal;
    for (int i = 0; world && frame && i < frames && !app_interrupted(); i++) {
        take_in(&taken, frame, world, io_scene_view(loaded->scene));
        bool good = true;
        for (int s = 0; s < steps && good; s++) good = !skein_world_step(world, dt);
        if (!good) break; // the run itself will tell
        app_progress_show(&p, i + 1);
    }
    if (p.line_open) app_terminal_draw("\r%*s\r", 100, ""); // the run's own bar takes its place
    render_world_frame_destroy(frame);
    skein_world_destroy(world);
    return taken.held;
}

/* ---- beginning ---- */

static void note_changes(const app_footage *f, const char *path, const film_format *format, const film_options *asked,
                         const int32_t size[2]) {
    if (size[0] != asked->size[0] || size[1] != asked->size[1])
        fprintf(stderr, "skein: %s: %s has even sizes only: %d x %d instead of %d x %d\n", path, format->help, size[0],
                size[1], asked->size[0], asked->size[1]);
    if (f->every > 1)
        fprintf(stderr, "skein: %s: %s plays %g pictures a second at most: one frame in %d is taken\n", path,
                format->help, format->most_rate, f->every);
    if (render_studio_samples(f->studio) < asked->samples)
        fprintf(stderr, "skein: %s: the driver has no more than %d samples a pixel\n", path,
                render_studio_samples(f->studio));
}

static bool open_all(app_footage *f, const char *path, const film_options *asked, bool quiet, skein_error *error) {
    const film_format *format = film_format_of(path, error);
    if (!format) return false;
    film_options options = *asked;
    film_fit_size(format, options.size);
    f->every = film_every(format, f->loaded->settings.fps);
    f->facts = (app_footage_facts){0, {options.size[0], options.size[1]}, f->loaded->settings.fps / f->every};
    f->studio = render_studio_create(options.size, options.samples, io_scene_view(f->loaded->scene), error);
    if (f->studio && !quiet) note_changes(f, path, format, asked, options.size);
    f->film = f->studio ? film_create(path, &options, f->loaded->settings.fps, error) : NULL;
    return f->film != NULL;
}

app_footage *app_footage_begin(const app_scene *loaded, const char *path, const film_options *options, int frames,
                               bool quiet) {
    skein_error error = {SKEIN_ERROR_MEMORY, "", "out of memory"};
    app_footage *f = calloc(1, sizeof *f);
    if (f) f->loaded = loaded;
    if (!f || !open_all(f, path, options, quiet, &error)) {
        app_print_error(&error);
        app_footage_abandon(f);
        return NULL;
    }
    // in the context that draws, what moves is drawn from where it is
    if (skein_world_device(loaded->world).device == SKEIN_DEVICE_GPU)
        skein_world_device_set(loaded->world, SKEIN_DEVICE_CURRENT_GL);
    render_subject held = look_ahead(loaded, frames, quiet);
    if (!render_hull_empty(&held.all)) render_studio_hold(f->studio, &held);
    return f;
}

/* ---- frames ---- */

/* Brings the picture that is being drawn into the film. */
static skein_status develop(app_footage *f, skein_error *error) {
    if (!f->drawing) return SKEIN_OK;
    f->drawing = false;
    skein_status status = render_studio_develop(f->studio, &f->image, error);
    if (!status) status = film_add(f->film, &f->image, error);
    if (!status) f->facts.pictures++;
    return status;
}

bool app_footage_frame(app_footage *f) {
    skein_error error = {SKEIN_OK, "", ""};
    if (f->frame++ % f->every) return true;
    skein_status status = develop(f, &error);
    if (!status) status = render_studio_shoot(f->studio, f->loaded->world, &error);
    f->drawing = !status;
    f->told = status != SKEIN_OK;
    if (status) app_print_error(&error);
    return !status;
}

static void release(app_footage *f) {
    // the context goes: what the world has there comes back first
    if (skein_world_device(f->loaded->world).device == SKEIN_DEVICE_CURRENT_GL)
        skein_world_device_set(f->loaded->world, SKEIN_DEVICE_CPU);
    render_studio_destroy(f->studio);
    render_image_release(&f->image);
    free(f);
}

bool app_footage_end(app_footage *f, app_footage_facts *facts) {
    skein_error error = {SKEIN_OK, "", ""}, later = {SKEIN_OK, "", ""};
    skein_status status = develop(f, &error), ended = film_finish(f->film, &later);
    if ((status || ended) && !f->told) app_print_error(status ? &error : &later);
    if (facts) *facts = f->facts;
    release(f);
    return !status && !ended;
}

void app_footage_abandon(app_footage *f) {
    if (!f) return;
    film_abandon(f->film);
    release(f);
}
#endif
