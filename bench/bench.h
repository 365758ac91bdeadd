/* What the benchmark's cases share: worlds to measure, the student's plain loop beside them, timing. */
#ifndef SKEIN_BENCH_BENCH_H
#define SKEIN_BENCH_BENCH_H

#include <skein/skein.h>

/* A row of the table: what was measured, and against what. */
typedef struct bench_result {
    const char *name;
    char size[32];
    double ns;       /* an element (or ms a frame, see unit) */
    double other_ns; /* of what it is compared with; 0: nothing */
    const char *unit, *other;
    double stretch, other_stretch; /* at the end; negative: not measured */
} bench_result;

void bench_report(const bench_result *result);

/* Runs body again and again for at least `seconds` a block; the median of five blocks, in seconds a call. */
double bench_median(void (*body)(void *data), void *data, double seconds);

/* W1: a grid of n x n particles, 1 m2, held by two corners; see docs of the case. */
skein_world *bench_cloth(int n, const char *method, int substeps, int threads, bool drag);

/* The student's loops: an array of structs, one constraint after the other, float. */
typedef struct plain_cloth plain_cloth;
plain_cloth *plain_cloth_create(int n, double stiffness, double substep);
void plain_cloth_destroy(plain_cloth *cloth);
size_t plain_cloth_springs(const plain_cloth *cloth);
void plain_cloth_project(void *cloth); /* one XPBD sweep in type order */
void plain_cloth_force(void *cloth);   /* damped spring forces, scattered */

#endif
