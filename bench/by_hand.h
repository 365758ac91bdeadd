/* Values and derivatives by hand, and by other means than a tape: what tapes and emitted kernels are measured against.
 * Positions are four floats each; an element's particles are slot[particle][element]. Outputs are arrays, `stride`
 * numbers from one to the next: the value, then the gradient's x, y and z of each particle; or the lower triangle of
 * the second derivatives, row by row. */
#ifndef SKEIN_BENCH_BY_HAND_H
#define SKEIN_BENCH_BY_HAND_H

#include <skein/skein.h>

#ifdef __cplusplus
extern "C" {
#endif

enum { BY_HAND_MOST_PARAMETERS = 10, BY_HAND_MOST_SECOND = 78 };

typedef struct by_hand_input {
    const skein_real *positions;
    const uint32_t *slot[4];
    const skein_real *parameter[BY_HAND_MOST_PARAMETERS];
    skein_real *output;
    size_t stride, count;
} by_hand_input;

typedef void by_hand_function(const by_hand_input *in);

/* One element after the other (by_hand.c), built as plain.c is: -O3 -march=native. */
by_hand_function by_hand_distance, by_hand_dihedral, by_hand_volume, by_hand_neo_hookean, by_hand_stvk;

/* Sixteen at a time in the library's arithmetic (by_hand_wide.c, by_hand_second.c); arrays must go on to the next
 * multiple of sixteen elements. */
by_hand_function by_hand_wide_distance, by_hand_wide_dihedral, by_hand_wide_volume, by_hand_wide_neo_hookean,
    by_hand_wide_stvk;
by_hand_function by_hand_second_neo_hookean, by_hand_second_stvk;

/* Likewise, but what `skein formula --emit kernel` writes (emitted_wide.c). */
by_hand_function emitted_distance, emitted_dihedral, emitted_volume, emitted_neo_hookean, emitted_stvk;
/* And what `skein formula --emit c --hessian` writes (emitted_second.c). */
by_hand_function emitted_second_neo_hookean, emitted_second_stvk;

/* A textbook's class of dual numbers in C++ (dual.cpp), -O3 -march=native, one element after the other. */
by_hand_function by_dual_distance, by_dual_dihedral, by_dual_volume, by_dual_neo_hookean, by_dual_stvk;

/* ADOL-C (adolc.cpp): traced once, then its reverse mode for each element, in double. */
by_hand_function by_adolc_distance, by_adolc_dihedral, by_adolc_volume, by_adolc_neo_hookean, by_adolc_stvk;

/* ---- projections (by_hand_project.c) ---- */

/* Groups of sixteen elements that share no particle, as a sweep has them: of each group sixteen first particles,
 * sixteen second ones ...; a rest value and a compliance (1/k) a lane. `per_step` is 1/h^2. */
typedef struct by_hand_sweep {
    skein_real *positions; /* four floats each, the inverse mass in the fourth; projected */
    const uint32_t *slots;
    const skein_real *rest, *compliance;
    size_t group_count;
    skein_real per_step;
} by_hand_sweep;

typedef void by_hand_projection(const by_hand_sweep *sweep);
by_hand_projection by_hand_project_distance, by_hand_project_dihedral, by_hand_project_volume, by_hand_project_area;

#ifdef __cplusplus
}
#endif
#endif
