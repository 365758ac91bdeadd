/* What is done in the window, recorded: every step, pull, pin and change, so that `skein verify` does it again.
 *
 *     J, --record FILE --> FILE --scene built anew--> FILE-2 --> ... --> J, the window is closed
 *
 * A recording (skein/record.h) is of one world. Where the window builds another, opens another scene, or an object comes
 * or goes, the file is ended and the next part begins with the state as it stands; each part can be verified alone. A
 * world beside the first has files of its own. Invariant: a side that is recorded has the output that its world writes
 * to, which outlives that world. */
#ifndef SKEIN_VIEWER_RECORDED_H
#define SKEIN_VIEWER_RECORDED_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct viewer_stage;
struct io_output;

enum { RECORDED_PATH = 1100 };

typedef struct viewer_recorded {
    struct io_output *output; /* NULL: this side is not recorded */
    char path[RECORDED_PATH]; /* of this part */
    int part;                 /* from 1; of those that are kept */
    double opened;            /* of the player whose world is recorded */
    uint64_t steps;           /* in this part */
} viewer_recorded;

/* Begins to record into this file, or one with the scene's name in the working directory (NULL). */
void viewer_recorded_begin(struct viewer_stage *stage, const char *path);
void viewer_recorded_end(struct viewer_stage *stage);
/* The worlds may be others than they were: what is recorded goes on with those. */
void viewer_recorded_follow(struct viewer_stage *stage);
/* An object has come into a world or gone from it: the next part begins. */
void viewer_recorded_anew(struct viewer_stage *stage, size_t side);
/* A step was taken: what is written so far can be read if the window is killed; a full disk is told. */
void viewer_recorded_step(struct viewer_stage *stage, size_t side);

#endif
