/* A scene that is played: its file, its world, the frames that were, and what it looks like.
 *
 *     file --open--> world --advance--> frames --> history
 *
 * The stage has one, or two side by side. Invariant: an open player has a scene and a world; opening another scene
 * leaves it as it was if that one has a fault. */
#ifndef SKEIN_VIEWER_PLAYER_H
#define SKEIN_VIEWER_PLAYER_H

#include "io/scene.h"
#include "render/world_frame.h"
#include "viewer/changes.h"
#include "viewer/history.h"
#include "viewer/viewer.h"

enum { PLAYER_PATH = 1024, PLAYER_NAME = 256 };

/* Where messages go. */
typedef struct viewer_reporter {
    void (*say)(void *user, skein_log_level level, const char *text);
    void *user;
} viewer_reporter;

typedef struct viewer_player {
    char path[PLAYER_PATH];
    viewer_changes changes; /* on top of the file: what was given, then what was done */
    io_scene *scene;
    io_scene_settings settings;
    skein_world *world;
    render_view view; /* the scene's, as changed since; its texts are the scene's, but for the followed body's */
    char follow[PLAYER_NAME]; /* that body's name, once it was changed */
    double opened;            /* s: when, which tells its world from others */
    int steps, step;          /* a frame; taken of the present one */
    double dt;                /* of a step */
    uint64_t frame;
    viewer_history history;
    unsigned char *pins; /* which particles were held when it was built */
    double *velocities;  /* and what they had then, which the library's reset takes from them; m/s, three each */
    viewer_reporter reporter;
    bool failed;   /* a step failed: said once */
    bool grown;    /* an object has come or gone since it was built: `scene` does not have it */
    double needed; /* substeps, where there are too few to be stable; else 0 */
} viewer_player;

/* How scenes are read. */
typedef struct viewer_reading {
    const skein_kind *const *exporters;
    int threads;                         /* 0: the scene's */
    void (*prepare)(skein_world *world); /* once it is built; or NULL */
    const char *const *allowed;          /* paths that scenes may have read besides (io/reach.h) */
    viewer_device device;                /* an OpenGL context is current on this thread, if it is to be a card */
} viewer_reading;

/* Opens a scene, or a mesh as a cloth. `sets` as for io_scene_read, copied. Faults are reported; false after one. */
bool viewer_player_open(viewer_player *player, const char *path, const char *const *sets, const viewer_reading *reading,
                        viewer_reporter reporter);
/* The same scene anew from its file, with these changes on top, which it takes over (or NULL: its own). With `stays` it
 * goes on where it stood, if it has as many particles as before. */
bool viewer_player_reopen(viewer_player *player, viewer_changes *changes, bool stays, const viewer_reading *reading);
/* Writes the scene with all changes that are done, as a file that opens to the same. */
skein_status viewer_player_write(const viewer_player *player, const char *path, const viewer_reading *reading,
                                 skein_error *error);
/* The scene's description with all changes that are done; NULL after a reported fault. Free it. */
io_scene *viewer_player_scene(const viewer_player *player, const viewer_reading *reading);
void viewer_player_close(viewer_player *player); /* one that never was open is allowed */

/* One step that is measured row by row: up to `most` passes go to `passes`. Else as viewer_player_step(). */
bool viewer_player_profile(viewer_player *player, bool *new_frame, skein_pass *passes, size_t most, size_t *count);
/* One step; `new_frame` tells whether it completed a frame. False after a reported fault. */
bool viewer_player_step(viewer_player *player, bool *new_frame);
/* Whether a graphics card steps its world: then there is no history, which would bring every frame back from it. */
bool viewer_player_on_card(const viewer_player *player);
/* Says what the world will suffer from as it is now: a step that is not stable, rounding (io/advice.h); and keeps how many
 * substeps it needs. */
void viewer_player_advise(viewer_player *player);
/* The same without a word where it needs as many as before. */
void viewer_player_advise_anew(viewer_player *player);
/* As it was built. */
void viewer_player_reset(viewer_player *player);
/* As it was in a frame that is kept. */
bool viewer_player_go_to(viewer_player *player, uint64_t frame);

#endif
