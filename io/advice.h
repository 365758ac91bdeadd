/* What a world will suffer from, foretold before it is run: steps that its method is not stable with, substeps so short
 * that positions round away what forces do, particles that begin inside a collider, and surfaces that begin in each other.
 *
 * Called by the command and the window, so that both say the same. */
#ifndef SKEIN_IO_ADVICE_H
#define SKEIN_IO_ADVICE_H

#include "io/file.h"

/* How many substeps a step of `dt` takes to be stable under the world's method, by its stiffest mode as it lies: 1
 * where nothing limits them, INFINITY where none is enough, 0 where it could not be found. Costs as much as some steps
 * where a method has a limit, else nothing. */
double io_substeps_needed(skein_world *world, double dt);

/* The most substeps whose moves under gravity are well over what positions are rounded to, INFINITY where the method does
 * not mind. */
double io_substeps_by_rounding(const skein_world *world, double dt);

/* Says what it foretells, each warning with its remedy. Returns how many there were. `needed`, if it is not NULL, gets
 * io_substeps_needed(). */
size_t io_advise(skein_world *world, double dt, io_warnings warnings, double *needed);

#endif
