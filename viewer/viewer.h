/* The window: a scene is played, looked at, pulled, changed and measured.
 *
 *     app/view.c --viewer_run--> window.c (GLFW, panels) <--exchange.c--> stage.c (worlds, camera)
 *                                        ^---------- pictures ---------- painter.c (OpenGL)
 *
 * Three threads: the window's own, which only shows the newest picture and the panels over it; the stage's, which owns
 * the worlds, steps them and answers what the window asks; and the painter's, which draws copies of them into pictures.
 * So panels answer at once, however long a step or a picture takes, and steps go on while a picture is drawn.
 * Invariant: nothing of a world is touched outside the stage's thread. */
#ifndef SKEIN_VIEWER_VIEWER_H
#define SKEIN_VIEWER_VIEWER_H

#include "skein/skein.h"
#include "viewer/theme.h"

/* What to do when the window is not the one being typed into. */
typedef enum viewer_unfocused { VIEWER_BY_SCENE, VIEWER_PAUSE, VIEWER_PLAY } viewer_unfocused;

/* Where steps are computed: on a graphics card (or llvmpipe, which plays one) where the scene can run there; or only where
 * there is a real one. */
typedef enum viewer_device { VIEWER_ON_PROCESSOR, VIEWER_ON_CARD, VIEWER_ON_CARD_IF_ANY } viewer_device;

typedef struct viewer_options {
    const char *path;                   /* a scene or a mesh; NULL: the gallery */
    const char *scenes;                 /* the gallery's folder; NULL: io_scenes_folder's first */
    const char *const *sets;            /* "path=value" for the first scene, NULL-terminated; or NULL */
    const char *const *allowed;         /* files and folders that scenes may have read besides (io/reach.h), or NULL */
    const skein_kind *const *exporters; /* for the scene reader, the view's kind among them */
    const char *events;                 /* a file that is told what happens, "-" for standard output; NULL: none */
    const char *record;                 /* a file that all that is done is recorded in; NULL: none */
    const char *compare;                /* "path=value" of a second world beside the first; NULL: none */
    int32_t size[2], samples, threads;  /* threads 0: the scene's */
    double scale;                       /* of the letters; 0: as the screen has it */
    viewer_theme theme;
    viewer_unfocused unfocused;
    viewer_device device;
    bool paused, panels;
    void (*prepare)(skein_world *world); /* is given each world before its first step, on the stage's thread; or NULL */
} viewer_options;

viewer_options viewer_default_options(void);

/* Opens the window and stays until it is closed. `error` says why it could not open: no display, no OpenGL 4.5. */
skein_status viewer_run(const viewer_options *options, skein_error *error);

/* One line about each key, in the order of the table that the window itself uses; `index` from 0, false past the end.
 */
bool viewer_key_line(size_t index, char *line, size_t size);

#endif
