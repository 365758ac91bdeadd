/* CHOLMOD as a world's sparse solver: the factor behind backward_euler's `"preconditioner": "cholesky"`.
 *
 * Outside of the core library, which needs nothing but libc: what links this links CHOLMOD (Debian's
 * libsuitesparse-dev), whose supernodal part is under the GPL. Scenes that are read by io/ have it where it was there
 * when Skein was built; a program attaches it itself:
 *
 *     skein_error error;
 *     if (skein_cholmod_attach(world, &error)) ...
 *     skein_method_set(world, "backward_euler", SKEIN_SETTINGS(SKEIN_TEXT("preconditioner", "cholesky")));
 */
#ifndef SKEIN_SOLVERS_CHOLMOD_H
#define SKEIN_SOLVERS_CHOLMOD_H

#include <skein/skein.h>

#ifdef __cplusplus
extern "C" {
#endif
#if defined(__GNUC__)
#pragma GCC visibility push(default) /* what a shared library shows of itself, and nothing else */
#endif

/* Whether Skein was built with CHOLMOD. */
bool skein_cholmod_is_here(void);

/* Gives the world a solver of its own, which goes with it. It takes its memory from the C library: the factor of a
 * cloth of 65 x 65 is 1.9 million numbers, 15 MB. Fails with SKEIN_ERROR_MEMORY, or with SKEIN_ERROR_VALUE
 * where CHOLMOD is not here; `error` may be NULL. */
skein_status skein_cholmod_attach(skein_world *world, skein_error *error);

#if defined(__GNUC__)
#pragma GCC visibility pop
#endif
#ifdef __cplusplus
}
#endif
#endif
