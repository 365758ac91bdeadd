/* Whole projections of XPBD, gather to scatter, of constraints that a program adds between loose particles: the kernels
 * that the library was built with, the same texts emitted and compiled beside the library, and on tapes; all beside
 * kernels by hand over the same groups. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <skein/compiled.h>

#include "base/float_mode.h"
#include "bench/elements.h"
#include "bench/worlds.h"
#include "constraints/sweep.h"
#include "world/world.h"

#define SUBSTEP (1.0 / 60) // one a frame, so that a run of the ops is a sweep

/* Made by bench_emit --compiled, and built as a user's are. */
extern const skein_compiled compiled_distance, compiled_dihedral, compiled_volume, compiled_area;

static const struct measured {
    const bench_kind_text *text;
    const skein_compiled *compiled;
    by_hand_projection *by_hand;
    size_t arity;
    bool solid;
} all[BENCH_KINDS] = {
    {&bench_kind_texts[BENCH_DISTANCE], &compiled_distance, by_hand_project_distance, 2, false},
    {&bench_kind_texts[BENCH_DIHEDRAL], &compiled_dihedral, by_hand_project_dihedral, 4, false},
    {&bench_kind_texts[BENCH_VOLUME], &compiled_volume, by_hand_project_volume, 4, true},
    {&bench_kind_texts[BENCH_AREA], &compiled_area, by_hand_project_area, 3, false},
};

/* What runs the constraints. */
enum { EMITTED, COMPILED, TAPE, WAYS };
static const char *const way_names[WAYS] = {"emitted", "compiled", "tape"};

/* A world of loose particles with constraints of one kind, its ops, and the state that every block starts from. */
typedef struct subject {
    skein_world *world;
    bench_ops *ops;
    const sk_batch *batch;
    by_hand_projection *by_hand;
    sk_vec4 *start, *copy; /* of all slots; by hand it is the copy that is projected */
    size_t bytes;
} subject;

static void make_subject(subject *s, const struct measured *m, const bench_elements *e, int way) {
    double *x = bench_allocate(3 * e->position_count, sizeof *x), *mass = bench_allocate(e->position_count, sizeof *x);
    uint32_t *corners = bench_allocate(m->arity * e->count, sizeof *corners);
    for (size_t i = 0; i < e->position_count; i++) {
        x[3 * i] = (double)e->positions[i].x, x[3 * i + 1] = (double)e->positions[i].y;
        x[3 * i + 2] = (double)e->positions[i].z, mass[i] = 1;
    }
    for (size_t i = 0; i < m->arity * e->count; i++) corners[i] = e->slot[i % m->arity][i / m->arity];
    *s = (subject){.world = bench_world(1), .by_hand = m->by_hand};
    bench_need(s->world, skein_particles_add(s->world, e->position_count, x, NULL, mass, NULL));
    const skein_setting settings[] = {
        SKEIN_REAL("stiffness", 1e4), SKEIN_TEXT("constraint", m->text->text), {NULL, {0, {0, 0, 0}, NULL}}};
    const skein_setting built_in[] = {SKEIN_REAL("stiffness", 1e4), {NULL, {0, {0, 0, 0}, NULL}}};
    bench_need(s->world, skein_constraint_add(s->world, way == EMITTED ? m->text->kind : "formula", corners, e->count,
                                              way == EMITTED ? built_in : settings, NULL));
    if (way == COMPILED) bench_need(s->world, skein_formula_register(s->world, m->compiled));
    bench_need(s->world, skein_method_set(s->world, "xpbd", SKEIN_SETTINGS(SKEIN_REAL("substeps", 1))));
    bench_shake(s->world, 0.2, 0);
    s->ops = bench_ops_create(s->world, SK_OP_PROJECT);
    if (!s->ops) bench_stop("kinds: no projections");
    s->batch = s->world->rules.batches.data[0];
    s->bytes = (s->world->particles.slot_end * sizeof(sk_vec4) + 63) / 64 * 64;
    s->start = aligned_alloc(64, s->bytes), s->copy = aligned_alloc(64, s->bytes);
    if (!s->start || !s->copy) bench_stop("no memory");
    memcpy(s->start, s->world->particles.vector[SK_X], s->world->particles.slot_end * sizeof(sk_vec4));
    free(x);
    free(mass);
    free(corners);
}

static void free_subject(subject *s) {
    bench_ops_destroy(s->ops);
    skein_world_destroy(s->world);
    free(s->start);
    free(s->copy);
}

static void start_rows(void *data) {
    subject *s = data;
    memcpy(s->world->particles.vector[SK_X], s->start, s->world->particles.slot_end * sizeof(sk_vec4));
}

static void run_rows(void *data) {
    bench_ops_run(((subject *)data)->ops);
}

static void start_by_hand(void *data) {
    subject *s = data;
    memcpy(s->copy, s->start, s->world->particles.slot_end * sizeof(sk_vec4));
}

static void run_by_hand(void *data) {
    const subject *s = data;
    uint64_t mode = sk_float_mode_enter();
    for (size_t i = 0; i < s->batch->sweep_count; i++) {
        const sk_sweep *sweep = &s->batch->sweeps[i];
        s->by_hand(&(by_hand_sweep){.positions = &s->copy->x,
                                    .slots = sweep->slots,
                                    .rest = s->batch->lane_rest + sweep->first_lane,
                                    .compliance = s->batch->lane_compliance + sweep->first_lane,
                                    .group_count = sweep->group_count,
                                    .per_step = (real)(1 / (SUBSTEP * SUBSTEP))});
    }
    sk_float_mode_leave(mode);
}

/* One sweep of each moves all particles alike, but for rounding. */
static void check(subject *s, const char *name) {
    const sk_vec4 *x = s->world->particles.vector[SK_X];
    double off = 0, far = 0;
    start_rows(s);
    start_by_hand(s);
    run_rows(s);
    run_by_hand(s);
    for (size_t i = 0; i < s->world->particles.count; i++) {
        uint32_t at = s->world->particles.slot_of[i];
        off = fmax(off, fabs((double)(x[at].x - s->copy[at].x)) + fabs((double)(x[at].y - s->copy[at].y)) +
                            fabs((double)(x[at].z - s->copy[at].z)));
        far = fmax(far, fabs((double)(x[at].x - s->start[at].x)));
    }
    if (!(off <= 1e-3 * far)) bench_fault("kinds, %s: by hand it differs by %g of %g", name, off, far);
    if (bench_ops_iterations(s->ops) != 1)
        bench_fault("kinds, %s: %zu sweeps in a run", name, bench_ops_iterations(s->ops));
}

/* How many groups a tape runs at once, on the average. */
static double groups_a_block(const sk_batch *batch) {
    size_t groups = 0, blocks = 0;
    for (size_t i = 0; i < batch->sweep_count; i++)
        for (size_t g = 0; g < batch->sweeps[i].group_count; g += batch->sweeps[i].ahead[g], blocks++)
            groups += batch->sweeps[i].ahead[g];
    return (double)groups / (double)blocks;
}

static void measure(const struct measured *m) {
    bench_elements e;
    subject subjects[WAYS];
    bench_job jobs[WAYS + 1];
    double seconds[WAYS + 1];
    bench_elements_make(&e, m->solid, 0, 0);
    for (int i = 0; i < WAYS; i++) {
        make_subject(&subjects[i], m, &e, i);
        check(&subjects[i], m->text->kind);
        jobs[i] = (bench_job){.run = run_rows, .data = &subjects[i], .prepare = start_rows};
    }
    jobs[WAYS] = (bench_job){.run = run_by_hand, .data = &subjects[EMITTED], .prepare = start_by_hand};
    bench_measure(jobs, WAYS + 1, 0.05, seconds);
    char note[80];
    bench_result result = {.name = "kinds", .unit = "ns/element", .other = "wide by hand", .note = note};
    result.theirs = 1e9 * seconds[WAYS] / (double)e.count;
    for (int i = 0; i < WAYS; i++) {
        const sk_batch *batch = subjects[i].batch;
        char size[40];
        snprintf(size, sizeof size, "%s, %s", m->text->kind, way_names[i]);
        int length = snprintf(note, sizeof note, "%zu groups", batch->lane_count / SK_LANES);
        if (i == TAPE) snprintf(note + length, sizeof note - (size_t)length, ", %.1f a block", groups_a_block(batch));
        result.size = size;
        result.ours = 1e9 * seconds[i] / (double)e.count;
        result.as_long = i == TAPE ? 1.5 : 1.15;
        bench_report(&result);
    }
    for (int i = 0; i < WAYS; i++) free_subject(&subjects[i]);
    bench_elements_free(&e);
}

static void run(void) {
    for (size_t i = 0; i < BENCH_KINDS; i++) measure(&all[i]);
}

const bench_case bench_kinds = {"kinds", "whole projections of kinds and of formulas, against wide C by hand", run};
