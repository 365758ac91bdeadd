/* Substeps for a time a frame ("budget_ms" of a scene's method): chosen once, where the scene is built, by what steps
 * take there and then. What was chosen takes the place of the budget in the scene's document, so that all that is kept
 * of a run (its report, snapshots, recordings) has the number, and does the same again on any machine. */
#ifndef SKEIN_IO_BUDGET_H
#define SKEIN_IO_BUDGET_H

#include "io/scene.h"

/* What so many substeps came to in the frames that were tried. */
typedef struct io_trial {
    int substeps;
    double ms;          /* a frame, in the mean */
    double max_stretch; /* the largest in any frame that was looked at; 0 without edges */
    double p99_stretch; /* the largest of what 99 % of the edges stay under */
} io_trial;

typedef struct io_budget {
    double ms;                    /* what was asked for, a frame; 0: no budget, and nothing else holds */
    int frames;                   /* that were tried, from the start */
    bool exceeded;                /* even one substep takes longer */
    bool bounded;                 /* there was time for more, which rounding would undo, or which nobody needs */
    io_trial chosen, half, twice; /* by half as many substeps, and by twice as many; 0 substeps: not tried */
} io_budget;

/* The most substeps that cost at most `ms`, by a cost in ms of so many; 1 where even that costs more. As near to it
 * as one in sixteen, and never more than `most`. Costs are asked for in an order that depends on them alone; where more
 * substeps never cost less, a larger budget never gets fewer. */
int io_budget_substeps(double ms, int most, double (*cost)(void *user, int substeps), void *user);

/* Chooses for a world that has just been built: steps it from its start, sets method.substeps, and takes it back, to the
 * bit. Fails with SKEIN_ERROR_MEMORY, or as the world does. */
skein_status io_budget_choose(skein_world *world, const io_scene_settings *settings, io_budget *budget,
                              skein_error *error);

/* The same in words, on one line: what was chosen, and what half and twice as many come to. */
void io_budget_text(const io_budget *budget, char *text, size_t size);

#endif
