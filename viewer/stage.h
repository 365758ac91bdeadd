/* The stage: the thread that owns worlds and camera, and has them drawn.
 *
 *     requests --> stage_answer.c, keys.c --> players, camera --> step --> frame --> painter --> exchange.shown
 *
 * A frame is a copy of what a picture shows of a world (render/world_frame.h); the painter draws it on a thread of its
 * own (painter.h, stage_picture.c), whose OpenGL context shares its pictures with the window's, while the worlds are
 * stepped on. Requests are answered between two steps, so that whatever they do to a world is safe. Steps follow the clock through a pacer: time that was
 * spent loading does not count, and a machine that cannot keep up slows down and says so. Between the files of the
 * viewer only. */
#ifndef SKEIN_VIEWER_STAGE_H
#define SKEIN_VIEWER_STAGE_H

#include "film/film.h"
#include "render/draw.h"
#include "render/messages.h"
#include "render/target.h"
#include "render/world_frame.h"
#include "viewer/camera.h"
#include "viewer/exchange.h"
#include "viewer/flock.h"
#include "viewer/grab.h"
#include "viewer/handles.h"
#include "viewer/hunt.h"
#include "viewer/offer.h"
#include "viewer/pace.h"
#include "viewer/painter.h"
#include "viewer/player.h"
#include "viewer/recent.h"
#include "viewer/recorded.h"
#include "viewer/viewer.h"

typedef struct GLFWwindow GLFWwindow;

/* What the painter is to draw, and how that went. */
typedef struct viewer_picture {
    size_t side_count;
    render_camera lens;
    int width, height; /* of the whole picture */
    int level;         /* of detail (pace.h) */
    bool ready;        /* was drawn since the stage last looked */
    double ms;         /* that it took */
    skein_error error;
} viewer_picture;

typedef struct viewer_stage {
    skein_error failure; /* why there is no stage */
    const viewer_options *options;
    const viewer_events *events;
    viewer_exchange *exchange;
    GLFWwindow *context; /* hidden; its context is current on the painter's thread */
    GLFWwindow *card;    /* the same for the stage's own, where a graphics card steps the worlds; or NULL */
    pthread_t thread;
    render_messages messages;

    viewer_player sides[VIEWER_SIDES];
    size_t side_count; /* 0: the gallery alone */
    char compare[VIEWER_TEXT];
    char wanted[VIEWER_TEXT]; /* a scene that could not be opened: tried again when its file changes */
    viewer_camera camera;
    viewer_grab grab;
    viewer_handles handles;
    viewer_hunt hunt;
    viewer_ride ride; /* the chosen bird */
    viewer_lesson lesson;
    viewer_offer offer;
    skein_pacer pacer;
    bool paused, paused_by_focus, play_away, closing;
    bool panel[VIEWER_PANEL_COUNT];
    bool dirty; /* what is shown is not what there is */
    bool news;  /* there are new words, which need no picture */
    bool facts; /* objects or fields have changed: the panels want them anew */
    char message[240];
    bool alarm; /* the message is a warning */
    bool light; /* the theme */

    /* pictures */
    viewer_painter painter;
    int width, height; /* of a whole picture */
    int wide, tall;    /* of the window, as it was last said */
    /* the painter's while it is busy */
    viewer_picture picture;
    render_world_frame *frames[VIEWER_SIDES];
    double framed[VIEWER_SIDES]; /* when the player was opened that the frame is of */
    render_draw *draw;
    render_target target[VIEWER_SIDES]; /* as wide as their part of the window */
    render_target coarse[VIEWER_SIDES]; /* of a level of less detail */
    int coarse_level;                   /* 0: there are none */
    unsigned pictures[VIEWER_PICTURES], framebuffer;
    int drawn_width, drawn_height; /* of the pictures */
    int newest;
    uint64_t generation;

    /* the pointer */
    double x, y, pressed_x, pressed_y;
    bool over;  /* the picture */
    int button; /* that is down; -1: none */
    int button_mods;

    /* time */
    double last, spoke, sampled, profiled; /* when: frames, notes, statistics, passes */
    viewer_pace pace;                      /* since the last look */
    double speed;                          /* simulated over real seconds */
    viewer_slowness slow;                  /* now */
    bool told_slow;                        /* was said of this scene */
    double looked;                         /* when: at what a card has, for what is not finite */
    int due;                               /* steps */
    double begun, stirred;                 /* when the last picture was, and the last that something had changed for */
    int level;                             /* of detail, for what moves */
    bool sharp;                            /* the last picture had all detail */
    double step_ms, draw_ms;
    bool has_drawn; /* a first picture, whose time is not counted */
    bool in_parts;  /* the next picture is drawn in parts: the last took long, or nobody knows yet */

    /* files */
    film *film;
    char film_path[64];
    uint64_t film_frames;
    viewer_recorded recorded[VIEWER_SIDES];
    bool records; /* what is done, into this file and its parts */
    char record_path[PLAYER_PATH];
    double watched; /* when the scene's file was looked at */
    struct {
        long long seconds, nanoseconds, size;
    } stamp;
    struct viewer_gallery *gallery;
    viewer_recent recent;
    double advice_due; /* when to look how many substeps are needed, after a change; 0: nothing has changed */
} viewer_stage;

/* Starts the thread; `context` is a hidden window whose context shares with the window's own, and so is `card`, which is
 * NULL where steps stay on the processor. */
bool viewer_stage_start(viewer_stage *stage, const viewer_options *options, viewer_exchange *exchange,
                        GLFWwindow *context, GLFWwindow *card);
/* Asks it to end, and waits. */
void viewer_stage_join(viewer_stage *stage);

/* ---- between the stage's files ---- */

/* A line for the log panel, the events and the terminal. */
void viewer_say(viewer_stage *stage, skein_log_level level, const char *format, ...)
    __attribute__((format(printf, 3, 4)));
/* A short note in the window, and an event. */
void viewer_note(viewer_stage *stage, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* The "state" line of the events. */
void viewer_tell_state(viewer_stage *stage);

void viewer_stage_open(viewer_stage *stage, const char *path, const char *const *sets);
/* From its file, with these changes on top; as for the player. */
bool viewer_stage_reopen(viewer_stage *stage, viewer_changes *changes, bool stays);
void viewer_stage_reload(viewer_stage *stage); /* its file has changed; what was changed here stays on top */
viewer_reading viewer_stage_reading(const viewer_stage *stage);
void viewer_stage_compare(viewer_stage *stage, const char *set);
/* The camera goes along with a body if the view says so, and says what it does. */
void viewer_stage_follow(viewer_stage *stage);
void viewer_stage_pause(viewer_stage *stage, bool paused);
void viewer_stage_reset(viewer_stage *stage);
void viewer_stage_step(viewer_stage *stage);                  /* one frame */
void viewer_stage_go_to(viewer_stage *stage, uint64_t frame); /* of the history */
void viewer_stage_answer(viewer_stage *stage, const viewer_request *request);
bool viewer_stage_by_key(const viewer_stage *stage); /* the scene advances by keys */
/* The part of the window that a side has: x, and width. */
int viewer_side_width(const viewer_stage *stage, size_t side, int *x);
double viewer_aspect(const viewer_stage *stage); /* width over height of the first side */
/* The side under a place of the picture, and where it is in that side; the ray from the eye through it. */
size_t viewer_side_at(const viewer_stage *stage, double x, double *inside);
void viewer_ray_at(const viewer_stage *stage, size_t side, double x, double y, double direction[3]);

/* stage_change.c: what the user changes; each is kept, and can be undone */
void viewer_stage_method(viewer_stage *stage, size_t side, const char *kind);
void viewer_stage_set(viewer_stage *stage, const viewer_request *request);
void viewer_stage_add_or_remove(viewer_stage *stage, const viewer_request *request);
/* Builds the scene anew with one more "path=value", from the start; false after a printed fault. */
bool viewer_stage_build_with(viewer_stage *stage, const char *set);
/* The same where it stands, of one or of several that are one change. */
bool viewer_stage_build_on(viewer_stage *stage, const char *set);
bool viewer_stage_build_on_all(viewer_stage *stage, const char *const *sets, size_t count);
/* Sets a live field in all worlds for a look; nothing is kept. */
void viewer_stage_try(viewer_stage *stage, skein_category category, size_t index, const skein_field *field,
                      const skein_value *value);
/* Fields of one object as one change: in place in all worlds, or by building anew. */
bool viewer_stage_change_together(viewer_stage *stage, skein_category category, size_t index,
                                  const viewer_spot_change *changes, size_t count, bool live);
/* The name of such objects' list in a scene: "bodies". */
const char *viewer_list_of(skein_category category);
void viewer_stage_undo(viewer_stage *stage);
void viewer_stage_redo(viewer_stage *stage);
void viewer_stage_revert(viewer_stage *stage); /* back to the file */
/* The camera goes along with this body, or stands still where it did so already: a change of the view. */
void viewer_stage_follow_body(viewer_stage *stage, size_t body);

/* stage_picture.c */
bool viewer_pictures_open(viewer_stage *stage, skein_error *error);
void viewer_pictures_close(viewer_stage *stage);
/* Copies what there is into the frames, and places the camera if it has no place yet. Waits for the painter. */
bool viewer_take_frames(viewer_stage *stage);
/* Has the painter draw it: the window gets it once it is done. With all detail, or as much as can be drawn often. False
 * where nothing can be drawn. */
bool viewer_begin_picture(viewer_stage *stage, bool sharp);
/* Learns how the last picture went. */
void viewer_end_picture(viewer_stage *stage);
/* Brings the whole picture, without panels, into memory. */
bool viewer_picture_read(viewer_stage *stage, render_image *image);

/* stage_files.c */
void viewer_save_picture(viewer_stage *stage);
void viewer_save_mesh(viewer_stage *stage);
void viewer_save_scene(viewer_stage *stage);
void viewer_film_toggle(viewer_stage *stage);
void viewer_film_frame(viewer_stage *stage);
/* The scene's name as a file's. */
const char *viewer_stem_of(const viewer_stage *stage, char stem[48]);
void viewer_watch(viewer_stage *stage, bool only_note);
/* "skein-001.png": the first of its kind that is not there yet. */
void viewer_free_name(const char *stem, const char *ending, char *path, size_t size);

/* mirror.c: copies what the panels show; under the exchange's lock */
void viewer_mirror(viewer_stage *stage);
void viewer_measure(viewer_stage *stage);
/* The value in a plain struct at the field's offset: of the view and the scene's settings. */
skein_value viewer_plain_value(const skein_field *field, const void *params);

/* gallery.c */
bool viewer_gallery_open(viewer_stage *stage);
void viewer_gallery_close(viewer_stage *stage);
/* Has the painter, which is idle, make one more picture of a scene, if one is missing. */
void viewer_gallery_work(viewer_stage *stage);

#endif
