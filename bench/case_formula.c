/* Tapes of formulas: value and gradient of 100,000 elements gathered from a mesh, beside the same by hand. Both leave
 * them where a solver would take them up, in the cache: tapes in registers, by hand in arrays of a block. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include <skein/formula.h>

#include "bench/bench.h"
#include "bench/by_hand.h"
#include "formula/formula.h"
#include "formula/tape.h"

enum { ELEMENTS = 100000, QUICK_ELEMENTS = 2048, MOST_PARAMETERS = 10, MOST_OUTPUTS = 13, SIDE = 240, DEPTH = 27 };

static const char *const dihedral_parameters[] = {"rest0", NULL};
static const char *const tet_parameters[] = {"d0", "d1", "d2", "d3", "d4", "d5", "d6", "d7", "d8", "vol", NULL};
static const char *const triangle_parameters[] = {"d0", "d1", "d2", "d3", "area", NULL};

static const struct measured {
    const char *name, *text;
    const char *const *parameters;
    void (*by_hand)(void *), (*by_hand_wide)(void *);
    int particles, parameter_count;
    bool solid;
} all[] = {
    {"distance", "length(p1-p0) - rest0", dihedral_parameters, by_hand_distance, by_hand_wide_distance, 2, 1, false},
    {"dihedral", "dihedral(p0,p1,p2,p3) - rest0", dihedral_parameters, by_hand_dihedral, by_hand_wide_dihedral, 4, 1,
     false},
    {"volume", "dot(cross(p1-p0, p2-p0), p3-p0)/6 - rest0", dihedral_parameters, by_hand_volume, by_hand_wide_volume, 4,
     1, true},
    {"neo-Hookean",
     "let a = p1-p0; let b = p2-p0; let c = p3-p0;\n"
     "let f0 = a*d0 + b*d3 + c*d6; let f1 = a*d1 + b*d4 + c*d7; let f2 = a*d2 + b*d5 + c*d8;\n"
     "let I = dot(f0,f0) + dot(f1,f1) + dot(f2,f2); let J = dot(f0, cross(f1, f2));\n"
     "vol*(0.5*(I-3) + 1.5*(J-1.25)^2 - 0.5*log(I+1))",
     tet_parameters, by_hand_neo_hookean, by_hand_wide_neo_hookean, 4, 10, true},
    {"StVK triangle",
     "let a = p1-p0; let b = p2-p0; let f = a*d0 + b*d2; let g = a*d1 + b*d3;\n"
     "let x = 0.5*(dot(f,f)-1); let y = 0.5*(dot(g,g)-1); let z = 0.5*dot(f,g);\n"
     "area*(x*x + y*y + 2*z*z + 1.5*(x+y)^2)",
     triangle_parameters, by_hand_stvk, by_hand_wide_stvk, 3, 5, false},
};

typedef struct elements {
    size_t count;
    sk_vec4 *positions;
    uint32_t *slot[4];
    real *parameter[MOST_PARAMETERS], *ours[MOST_OUTPUTS], *theirs[MOST_OUTPUTS];
    sk_tape tape;
    sk_tape_input input;
    const sk_tape_kernels *kernels;
} elements;

static double unsteady(size_t i) {
    uint64_t x = (i + 1) * 0x9e3779b97f4a7c15u;
    x = (x ^ x >> 29) * 0xbf58476d1ce4e5b9u;
    return (double)(x >> 11) / 9007199254740992.0 - 0.5;
}

/* A rumpled sheet, or a block of shaken points. */
static void place(elements *e, bool solid) {
    size_t count = solid ? DEPTH * DEPTH * DEPTH : SIDE * SIDE;
    e->positions = aligned_alloc(64, count * sizeof *e->positions);
    if (!e->positions) bench_stop("no memory");
    for (size_t i = 0; i < count; i++) {
        double x = (double)(i % (solid ? DEPTH : SIDE)),
               y = (double)(i / (solid ? DEPTH : SIDE) % (solid ? DEPTH : SIDE));
        double z = solid ? (double)(i / (DEPTH * DEPTH)) : 0.5 * sin(0.7 * x) * cos(0.9 * y);
        e->positions[i] = (sk_vec4){(real)(x + 0.25 * unsteady(3 * i)), (real)(y + 0.25 * unsteady(3 * i + 1)),
                                    (real)(z + 0.25 * unsteady(3 * i + 2)), 1};
    }
}

static void choose_corners(elements *e, bool solid) {
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

static void make_elements(elements *e, const struct measured *m) {
    *e = (elements){.count = bench_quick ? QUICK_ELEMENTS : ELEMENTS};
    place(e, m->solid);
    for (int k = 0; k < 4; k++) e->slot[k] = bench_allocate(e->count, sizeof(uint32_t));
    choose_corners(e, m->solid);
    for (int k = 0; k < m->parameter_count; k++) {
        e->parameter[k] = bench_allocate(e->count, sizeof(real));
        for (size_t i = 0; i < e->count; i++) e->parameter[k][i] = (real)(0.8 + 0.5 * unsteady(i * 16 + (size_t)k));
    }
    for (int k = 0; k < 1 + 3 * m->particles; k++) {
        e->ours[k] = bench_allocate(e->count, sizeof(real));
        e->theirs[k] = bench_allocate(e->count, sizeof(real));
    }
    e->input = (sk_tape_input){.positions = e->positions,
                               .slot = (const uint32_t *const *)e->slot,
                               .parameter = (const real *const *)e->parameter};
    e->kernels = &sk_tape_kernels_of[sk_isa_choose()];
}

static void free_elements(elements *e) {
    free(e->positions);
    for (int k = 0; k < 4; k++) free(e->slot[k]);
    for (int k = 0; k < MOST_PARAMETERS; k++) free(e->parameter[k]);
    for (int k = 0; k < MOST_OUTPUTS; k++) free(e->ours[k]), free(e->theirs[k]);
    sk_tape_free(&e->tape);
}

static void make_tape(elements *e, const struct measured *m, sk_allocator *allocator) {
    skein_error error;
    skein_formula_desc desc = {.text = m->text, .parameters = m->parameters};
    skein_formula *f = skein_formula_create(&desc, NULL, &error);
    if (!f) bench_stop("%s: %s: %s", m->name, error.where, error.message);
    sk_node outputs[MOST_OUTPUTS] = {f->value[0]};
    for (int i = 0; i < 3 * m->particles; i++) outputs[1 + i] = f->by_position[0][i];
    if (sk_tape_create(&e->tape, &f->graph, outputs, 1 + 3 * (size_t)m->particles, allocator, &error))
        bench_stop("%s: %s", m->name, error.message);
    skein_formula_destroy(f);
}

static void run_tape(void *data) {
    elements *e = data;
    static sk_wide registers[SK_TAPE_MEMORY / sizeof(sk_wide)];
    sk_tape_verdict verdict;
    size_t block = SK_LANES * e->tape.wides;
    e->kernels->begin(&e->tape, &e->input, registers);
    for (size_t i = 0; i < e->count; i += block) {
        e->kernels->load(&e->tape, &e->input, i, e->count - i < block ? e->count - i : block, registers);
        e->kernels->run(&e->tape, registers, &verdict);
    }
}

typedef struct job_by_hand {
    void (*run)(void *);
    by_hand_input all;
} job_by_hand;

static void run_by_hand(void *data) {
    enum { BLOCK = 128 };
    static real out[MOST_OUTPUTS][BLOCK];
    const job_by_hand *job = data;
    for (size_t i = 0; i < job->all.count; i += BLOCK) {
        by_hand_input part = job->all;
        part.count = job->all.count - i < BLOCK ? job->all.count - i : BLOCK;
        for (int k = 0; k < 4; k++) part.slot[k] += i;
        for (int k = 0; k < MOST_PARAMETERS && part.parameter[k]; k++) part.parameter[k] += i;
        for (int k = 0; k < MOST_OUTPUTS; k++) part.output[k] = out[k];
        job->run(&part);
    }
}

static void check(elements *e, const struct measured *m, void (*by_hand)(void *), by_hand_input *in) {
    by_hand(in);
    e->kernels->evaluate(&e->tape, &e->input, 0, e->count, e->ours);
    double off = 0, size = 0;
    for (int k = 0; k < 1 + 3 * m->particles; k++)
        for (size_t i = 0; i < e->count; i++) {
            off = fmax(off, fabs((double)(e->ours[k][i] - e->theirs[k][i])));
            size = fmax(size, fabs((double)e->theirs[k][i]));
        }
    if (!(off <= 1e-4 * size)) bench_fault("formula, %s: by hand it differs by %g of %g", m->name, off, size);
}

static void measure(const struct measured *m) {
    elements e;
    sk_allocator allocator = sk_default_allocator();
    make_elements(&e, m);
    make_tape(&e, m, &allocator);
    by_hand_input in = {.positions = &e.positions->x, .count = e.count};
    for (int k = 0; k < 4; k++) in.slot[k] = e.slot[k];
    for (int k = 0; k < MOST_PARAMETERS; k++) in.parameter[k] = e.parameter[k];
    for (int k = 0; k < MOST_OUTPUTS; k++) in.output[k] = e.theirs[k];
    check(&e, m, m->by_hand, &in);
    check(&e, m, m->by_hand_wide, &in);
    job_by_hand scalar = {m->by_hand, in}, wide = {m->by_hand_wide, in};
    bench_job jobs[] = {
        {.run = run_tape, .data = &e}, {.run = run_by_hand, .data = &scalar}, {.run = run_by_hand, .data = &wide}};
    double seconds[3];
    bench_measure(jobs, 3, 0.05, seconds);
    char note[80];
    snprintf(note, sizeof note, "%zu instructions, %zu registers", e.tape.code.count, e.tape.registers);
    bench_result result = {.name = "formula",
                           .size = m->name,
                           .ours = 1e9 * seconds[0] / (double)e.count,
                           .unit = "ns/element",
                           .note = note};
    result.other = "scalar by hand", result.theirs = 1e9 * seconds[1] / (double)e.count;
    bench_report(&result);
    result.other = "wide by hand", result.theirs = 1e9 * seconds[2] / (double)e.count;
    result.as_long = 2.4;
    bench_report(&result);
    free_elements(&e);
}

static void run(void) {
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) measure(&all[i]);
}

const bench_case bench_formula = {"formula", "value and gradient of formulas, against scalar C by hand", run};
