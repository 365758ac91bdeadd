/* A mesh's elements, in blocks for tapes and in arrays for C by hand, and the check that both give the same. */
#include "bench/elements.h"

#include <math.h>
#include <stdlib.h>

enum { ELEMENTS = 100000, QUICK_ELEMENTS = 2048, SIDE = 240, DEPTH = 27 };

/* ---- formulas ---- */

#ifdef BENCH_DUAL
#define BY_DUAL(name_) by_dual_##name_
#else
#define BY_DUAL(name_) NULL
#endif
#ifdef BENCH_ADOLC
#define BY_ADOLC(name_) by_adolc_##name_
#else
#define BY_ADOLC(name_) NULL
#endif
#define ALL(name_) by_hand_##name_, by_hand_wide_##name_, emitted_##name_, BY_DUAL(name_), BY_ADOLC(name_)

const bench_functions bench_functions_of[BENCH_FORMULAS] = {
    {ALL(distance), NULL, NULL},
    {ALL(dihedral), NULL, NULL},
    {ALL(volume), NULL, NULL},
    {ALL(neo_hookean), by_hand_second_neo_hookean, emitted_second_neo_hookean},
    {ALL(stvk), by_hand_second_stvk, emitted_second_stvk},
};

/* ---- elements ---- */

static double unsteady(size_t i) {
    uint64_t x = (i + 1) * 0x9e3779b97f4a7c15u;
    x = (x ^ x >> 29) * 0xbf58476d1ce4e5b9u;
    return (double)(x >> 11) / 9007199254740992.0 - 0.5;
}

static void place(bench_elements *e, bool solid) {
    e->position_count = solid ? DEPTH * DEPTH * DEPTH : SIDE * SIDE;
    e->positions = aligned_alloc(64, (e->position_count * sizeof *e->positions + 63) / 64 * 64);
    if (!e->positions) bench_stop("no memory");
    for (size_t i = 0; i < e->position_count; i++) {
        double x = (double)(i % (solid ? DEPTH : SIDE)),
               y = (double)(i / (solid ? DEPTH : SIDE) % (solid ? DEPTH : SIDE));
        double z = solid ? (double)(i / (DEPTH * DEPTH)) : 0.5 * sin(0.7 * x) * cos(0.9 * y);
        e->positions[i] = (sk_vec4){(real)(x + 0.25 * unsteady(3 * i)), (real)(y + 0.25 * unsteady(3 * i + 1)),
                                    (real)(z + 0.25 * unsteady(3 * i + 2)), 1};
    }
}

static void choose_corners(bench_elements *e, bool solid) {
    static const uint32_t tets[6][4] = {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7},
                                        {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}};
    for (size_t i = 0; i < e->count; i++) {
        size_t cell = solid ? i / 6 : i / 2, side = solid ? DEPTH - 1 : SIDE - 2;
        size_t x = cell % side, y = cell / side % side, z = cell / (side * side);
        for (uint32_t k = 0; k < 4; k++) {
            uint32_t c = tets[i % 6][k];
            size_t flat[2][4] = {{1, SIDE, 0, SIDE + 1}, {1, SIDE + 1, SIDE, SIDE + 2}};
            e->slot[k][i] = solid ? (uint32_t)(x + (c & 1) + DEPTH * (y + (c >> 1 & 1) + DEPTH * (z + (c >> 2))))
                                  : (uint32_t)(x + SIDE * y + flat[i % 2][k]);
        }
    }
}

void bench_elements_make(bench_elements *e, bool solid, int parameter_count, size_t outputs) {
    *e = (bench_elements){.count = bench_quick ? QUICK_ELEMENTS : ELEMENTS};
    place(e, solid);
    for (int k = 0; k < 4; k++) e->slot[k] = bench_allocate(e->count, sizeof(uint32_t));
    choose_corners(e, solid);
    for (int k = 0; k < parameter_count; k++) {
        e->parameter[k] = bench_allocate(e->count, sizeof(real));
        for (size_t i = 0; i < e->count; i++) e->parameter[k][i] = (real)(0.8 + 0.5 * unsteady(i * 16 + (size_t)k));
    }
    e->ours = bench_allocate(outputs * e->count, sizeof(real));
    e->theirs = bench_allocate(outputs * e->count, sizeof(real));
    e->input = (sk_tape_input){.positions = e->positions,
                               .slot = (const uint32_t *const *)e->slot,
                               .parameter = (const real *const *)e->parameter};
}

void bench_elements_free(bench_elements *e) {
    free(e->positions);
    for (int k = 0; k < 4; k++) free(e->slot[k]);
    for (int k = 0; k < BY_HAND_MOST_PARAMETERS; k++) free(e->parameter[k]);
    free(e->ours);
    free(e->theirs);
}

/* ---- tapes ---- */

void bench_tape_make(bench_tape *t, const bench_elements *e, const bench_text *m, bool second) {
    skein_error error;
    skein_formula_desc desc = {.text = m->text, .parameters = m->parameters, .second = second};
    *t = (bench_tape){.elements = e, .allocator = sk_default_allocator()};
    skein_formula *f = skein_formula_create(&desc, NULL, &error);
    if (!f) bench_stop("%s: %s: %s", m->name, error.where, error.message);
    sk_node outputs[BY_HAND_MOST_SECOND];
    size_t coordinates = 3 * (size_t)m->particles, count = 0;
    if (!second) outputs[count++] = f->value[0];
    for (size_t i = 0; i < coordinates && !second; i++) outputs[count++] = f->by_position[0][i];
    for (size_t i = 0; i < coordinates && second; i++)
        for (size_t j = 0; j <= i; j++) outputs[count++] = f->hessian[i * coordinates + j];
    if (sk_tape_create(&t->tape, &f->graph, outputs, count, &t->allocator, &error))
        bench_stop("%s: %s", m->name, error.message);
    skein_formula_destroy(f);
}

void bench_tape_free(bench_tape *t) {
    sk_tape_free(&t->tape);
}

void bench_tape_run(void *data) {
    const bench_tape *t = data;
    const bench_elements *e = t->elements;
    sk_tape_kernels_of[sk_isa_choose()]->work(&t->tape, &e->input, 0, e->count);
}

/* ---- by hand ---- */

bench_by_hand bench_by_hand_of(const bench_elements *e, by_hand_function *run, size_t block) {
    bench_by_hand h = {run, {.positions = &e->positions->x, .count = e->count}, block};
    for (int k = 0; k < 4; k++) h.all.slot[k] = e->slot[k];
    for (int k = 0; k < BY_HAND_MOST_PARAMETERS; k++) h.all.parameter[k] = e->parameter[k];
    h.all.output = e->theirs;
    h.all.stride = e->count;
    return h;
}

void bench_by_hand_run(void *data) {
    static real out[BY_HAND_MOST_SECOND * 128];
    const bench_by_hand *h = data;
    for (size_t i = 0; i < h->all.count; i += h->block) {
        by_hand_input part = h->all;
        part.count = h->all.count - i < h->block ? h->all.count - i : h->block;
        for (int k = 0; k < 4; k++) part.slot[k] += i;
        for (int k = 0; k < BY_HAND_MOST_PARAMETERS && part.parameter[k]; k++) part.parameter[k] += i;
        part.output = out;
        part.stride = h->block;
        h->run(&part);
    }
}

void bench_check_by_hand(const bench_elements *e, const bench_tape *t, const bench_by_hand *h, const char *name) {
    real *ours[BY_HAND_MOST_SECOND];
    double off = 0, size = 0;
    for (size_t k = 0; k < t->tape.outputs; k++) ours[k] = e->ours + k * e->count;
    h->run(&h->all);
    sk_tape_kernels_of[sk_isa_choose()]->evaluate(&t->tape, &e->input, 0, e->count, ours);
    for (size_t i = 0; i < t->tape.outputs * e->count; i++) {
        off = fmax(off, fabs((double)(e->ours[i] - e->theirs[i])));
        size = fmax(size, fabs((double)e->theirs[i]));
    }
    if (!(off <= 1e-4 * size)) bench_fault("%s: it differs by %g of %g from the tape", name, off, size);
}
