/* Whether a run ended as one can: a blow-up may stay finite, and its files look like any others.
 *
 * Owns: the numbers that tell. Noted while a run goes on and judged at its end; the command's words are in app/verdict.c. */
#ifndef SKEIN_IO_VERDICT_H
#define SKEIN_IO_VERDICT_H

#include <skein/skein.h>

typedef struct io_verdict {
    double most_stretch;   /* that the scene allows, as a share */
    bool driven;           /* something does work on it: energy may grow */
    double start_stretch;  /* of the longest edge, as a share */
    double start_elastic;  /* J */
    double most_moving;    /* J, kinetic, the most that was noted */
    double most_potential; /* J, of either sign */
} io_verdict;

typedef enum io_ending { IO_ENDED_WELL, IO_ENDED_TORN, IO_ENDED_GROWN } io_ending;

/* Before the first step. */
io_verdict io_verdict_begin(skein_world *world, double most_stretch, const skein_statistics *start);
/* Now and then. */
void io_verdict_note(io_verdict *verdict, const skein_statistics *now);
/* Judges the end: an edge is stretched far beyond the scene's bound, or there is energy, so many joules, that came from
 * nowhere. */
io_ending io_verdict_end(io_verdict *verdict, const skein_statistics *end, double *growth);

/* Whether every position and velocity is a finite number. */
bool io_is_finite(const skein_world *world);

#endif
