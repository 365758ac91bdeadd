/* Between the window and the stage: requests go one way, what there is to show comes back the other.
 *
 *     window --viewer_ask--> queue --viewer_take--> stage
 *     window <--viewer_shown (under the lock)-- stage and painter, after every picture
 *
 * Invariant: `shown` is read and written only while the lock is held, and nobody waits for anything else meanwhile;
 * so the window never waits for a step. */
#ifndef SKEIN_VIEWER_EXCHANGE_H
#define SKEIN_VIEWER_EXCHANGE_H

#include <pthread.h>

#include "skein/skein.h"
#include "viewer/events.h"
#include "viewer/gizmo.h"
#include "viewer/lesson.h"
#include "viewer/offer.h"
#include "viewer/pace.h"

enum {
    VIEWER_TEXT = 1024,
    VIEWER_PICTURES = 4,
    VIEWER_SIDES = 2,
    VIEWER_SAMPLES = 240,
    VIEWER_LOG_LINES = 200,
    VIEWER_RECENTS = 8
};

/* ---- requests ---- */

typedef enum viewer_request_kind {
    VIEWER_KEY_DOWN,  /* code: GLFW's key; mods */
    VIEWER_KEY_UP,    /* code */
    VIEWER_BUTTON,    /* code: the mouse's button; down; mods; x, y */
    VIEWER_MOVE,      /* x, y; down: over a panel, or out of the window */
    VIEWER_SCROLL,    /* y: clicks of the wheel, forward is closer */
    VIEWER_RESIZE,    /* x, y: pixels */
    VIEWER_FOCUS,     /* down: has it now */
    VIEWER_SET,       /* category, index, field, value: of an object, the method, the view or the scene; side; down: its
                         control is still held, and what it says next belongs to the same change */
    VIEWER_METHOD,    /* text: the kind; side */
    VIEWER_ADD,       /* category, text: the kind */
    VIEWER_REMOVE,    /* category, index */
    VIEWER_MAKE,      /* code: a piece of the palette; text: its file, if it has one */
    VIEWER_DUPLICATE, /* category, index */
    VIEWER_KIND,      /* category, index, text: the kind that it becomes */
    VIEWER_TO_MESH,   /* index: of a body */
    VIEWER_FOLLOW,    /* index: of a body that the camera goes along with, or no longer */
    VIEWER_TOOL,      /* category, index; code: a viewer_tool, handles on that object */
    VIEWER_BRUSH,     /* x: its radius, pixels */
    VIEWER_OPEN,      /* text: a scene or mesh */
    VIEWER_SCRUB,     /* x: a frame */
    VIEWER_COMPARE,   /* text: path=value for the second side; "" ends it */
    VIEWER_PLAY_AWAY, /* down: go on playing without the focus */
    VIEWER_PANEL,     /* code: a viewer_panel; down: open it */
    VIEWER_LESSON,    /* code: -1, 1: another object; 0: its constraint x */
    VIEWER_FORMULA,   /* text: another one for the lesson's constraint */
    VIEWER_PARAMETER, /* down: what is offered is made; else it is left */
    VIEWER_SAVED,     /* text: a file that the window itself wrote */
    VIEWER_FAULT,     /* text: for the log */
    VIEWER_CLOSE
} viewer_request_kind;

typedef struct viewer_request {
    viewer_request_kind kind;
    int code, mods, side;
    bool down;
    double x, y;
    skein_category category;
    size_t index;
    const skein_field *field; /* of the tables, which last */
    skein_value value;        /* a text is in `text` */
    char text[VIEWER_TEXT];
} viewer_request;

/* ---- what is shown ---- */

/* Windows that open and close. */
typedef enum viewer_panel {
    VIEWER_PANEL_SIDE, /* the panels at the side */
    VIEWER_PANEL_GALLERY,
    VIEWER_PANEL_KEYS,
    VIEWER_PANEL_PLOTS,
    VIEWER_PANEL_LOG,
    VIEWER_PANEL_LESSON,
    VIEWER_PANEL_COUNT
} viewer_panel;

/* A field of one object alone, a parameter of its formulas: its kind goes with its world, and what is shown or asked
 * for may be of a world that has just gone. */
typedef struct viewer_own_field {
    skein_field field;
    char name[64];
    struct viewer_own_field *next;
} viewer_own_field;

/* A field of something as it stands. */
typedef struct viewer_entry {
    const skein_field *field;
    skein_value value;
    double anchor;              /* its largest number when it was first seen: sliders are measured by it */
    bool shapes;                /* a change builds the scene anew */
    const skein_field *instead; /* that has taken its place, so that it counts for nothing; or NULL */
    bool cut;                   /* of a longer text */
    char text[VIEWER_TEXT];
} viewer_entry;

/* An object, the method, the view or the scene, with its fields. */
typedef struct viewer_object {
    skein_category category;
    size_t index;
    const skein_kind *kind;
    char name[96];
    size_t first, count; /* of its entries */
} viewer_object;

typedef enum viewer_quantity {
    VIEWER_KINETIC,
    VIEWER_POTENTIAL,
    VIEWER_ELASTIC,
    VIEWER_TOTAL,
    VIEWER_STRETCH,
    VIEWER_CONTACTS,
    VIEWER_STEP_MS,
    VIEWER_DRAW_MS,
    VIEWER_POLARIZATION, /* of a flock: gaps where there is none */
    VIEWER_MILLING,
    VIEWER_QUANTITY_COUNT
} viewer_quantity;

/* The newest sample is before `next`; the oldest is at it. */
typedef struct viewer_plots {
    float value[VIEWER_QUANTITY_COUNT][VIEWER_SAMPLES], time[VIEWER_SAMPLES]; /* s */
    size_t next, count;
} viewer_plots;

/* What a pass of the plan took. */
typedef struct viewer_pass {
    char label[64];
    double milliseconds;
} viewer_pass;
enum { VIEWER_PASSES = 40 };

typedef struct viewer_line {
    skein_log_level level;
    char text[800];
} viewer_line;

/* A scene of the gallery. */
typedef struct viewer_card {
    char path[VIEWER_TEXT], title[64], about[480];
    unsigned texture; /* 0: none yet */
    bool broken;      /* `about` says why */
} viewer_card;

/* A part of a gizmo, for those who follow the events. */
typedef struct viewer_handle_place {
    char name[64];
    double at[2];
} viewer_handle_place;

/* One of the worlds that are shown. */
typedef struct viewer_side {
    char name[160];
    viewer_object *objects;
    size_t object_count, object_room;
    viewer_entry *entries;
    size_t entry_count, entry_room;
    viewer_own_field *own_fields; /* each that there ever was */
    skein_statistics statistics;
    viewer_plots plots;
    viewer_pass passes[VIEWER_PASSES];
    size_t pass_count;
    bool flock;             /* there is one, whose order is plotted */
    viewer_strokes strokes; /* over its picture */
    viewer_handle_place handles[GIZMO_PARTS];
} viewer_side;

typedef struct viewer_shown {
    unsigned pictures[VIEWER_PICTURES]; /* renderbuffers, shared by both contexts */
    int width, height;                  /* of the pictures */
    uint64_t generation;                /* changes with the pictures */
    int newest, in_use;                 /* places of pictures; -1: none. in_use is the window's */
    char title[256], message[240];
    char about[480]; /* what the scene shows, in its own words */
    bool light /* the theme */, alarm /* the message is a warning */;
    bool has_scene, paused, recording, flying, by_key, play_away, finished /* the stage has ended */;
    viewer_slowness slow;
    bool panel[VIEWER_PANEL_COUNT];
    uint64_t frame, first_frame, last_frame; /* of the history */
    double time, speed;                      /* s; simulated over real time */
    double needed;                           /* substeps, where there are too few to be stable; else 0 */
    char recent[VIEWER_RECENTS][VIEWER_TEXT];
    size_t recent_count;
    size_t changes;   /* that are done, besides those that were given */
    viewer_tool tool; /* that the pointer has, and the object that it is for */
    skein_category tool_category;
    size_t tool_index;
    double brush;        /* its radius, pixels */
    char tool_words[96]; /* what it does, at tool_at */
    double tool_at[2];
    viewer_offer offer;   /* a text that was not taken */
    viewer_lesson lesson; /* while its panel is open */
    size_t side_count;
    viewer_side sides[VIEWER_SIDES];
    viewer_line log[VIEWER_LOG_LINES];
    size_t log_count; /* so far; the newest is at (log_count - 1) % VIEWER_LOG_LINES */
    viewer_card *cards;
    size_t card_count;
} viewer_shown;

typedef struct viewer_exchange {
    pthread_mutex_t lock, queue_lock;
    pthread_cond_t asked;
    viewer_request *queue, *taken;
    size_t queue_count, queue_room, taken_room;
    bool nudged; /* under queue_lock */
    viewer_shown shown;
    const viewer_events *events;
    void (*wake)(void); /* calls the window when there is something new; or NULL */
} viewer_exchange;

bool viewer_exchange_open(viewer_exchange *exchange, const viewer_events *events);
void viewer_exchange_close(viewer_exchange *exchange);

/* Puts a request into the queue (a move replaces a move right before it, a field's new value
 * the one before). Without memory it is dropped, and said. */
void viewer_ask(viewer_exchange *exchange, const viewer_request *request);
/* Lets the stage look at what there is, though nothing is asked. */
void viewer_nudge(viewer_exchange *exchange);
/* Waits until something is asked or it is nudged, at most so long; returns what was asked, in order, valid until the next call. */
const viewer_request *viewer_take(viewer_exchange *exchange, double seconds, size_t *count);

#endif
