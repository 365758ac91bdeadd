/* Constraints and energies by formula: texts of up to eight particles (docs/formula.md).
 *
 * A constraint C is to be 0, or, written `a >= b`, at least 0. An energy E has the forces -grad E; position methods
 * treat it as the constraint C = sqrt(2 E), without ever dividing by the root: where E and its gradient are 0, so is
 * the correction (<skein/inside/projection.h>). Both run on a tape, or as code that a C compiler made from the text
 * (include/skein/compiled.h). Up to four groups of sixteen elements that share no particle are one block: they are
 * loaded and run together, then finished and stored group by group, in order. */
#include "constraints/formula.h"

#ifndef __clang__ // gcc does not see that all loops over an element's particles have the same length
#pragma GCC diagnostic ignored "-Wmaybe-uninitialized"
#endif

#define SK_ARITY SK_MOST_ARITY
#define SK_ARITY_OF(e) ((e)->arity)
#define SK_READS(e, i) ((e)->reads[i])
#define SK_RESTS 0
#include "constraints/element.h"
#include "formula/compiled_code.h"

enum { NOWHERE = 0xffff };

/* The registers from which a tape reads an element's positions and rest values. */
typedef struct places {
    uint16_t position[SK_MOST_ARITY], rest[SKEIN_FORMULA_MOST_RESTS];
} places;

typedef size_t energy_of(const sk_batch *batch, double time, const sk_vec4 *x, size_t begin, size_t end, double *out);

#define SK_UNIT formula
SK_KERNELS(energy_of, energy);
SK_KERNELS(sk_op_kernel, force_groups);
SK_KERNELS(sk_op_kernel, project_groups);
SK_KERNELS(sk_op_kernel, project_damped_groups);
SK_KERNELS(sk_op_kernel, apply);
SK_KERNELS(sk_op_kernel, diagonal);
SK_KERNELS(sk_op_kernel, blocks);

#ifdef SK_ISA

static places find_places(const sk_batch *batch, const sk_tape *tape) {
    int first_rest = ((const sk_formula_params *)batch->params)->made->formula->parameters;
    places to;
    memset(&to, 0xff, sizeof to);
    for (size_t l = 0; l < tape->loads.count; l++) {
        sk_tape_load load = tape->loads.data[l];
        if (load.source == SK_TAPE_POSITION) to.position[load.index] = load.to;
        else if (load.source == SK_TAPE_PARAMETER && load.index >= first_rest)
            to.rest[load.index - first_rest] = load.to;
    }
    return to;
}

/* ---- in and out ---- */

/* Groups of a sweep, or sixteen elements of a batch, while they are computed. Compiled code uses the tape's registers
 * too. */
typedef struct block {
    SK_VECTOR_ALIGNED sk_wide registers[SK_TAPE_MEMORY / sizeof(sk_wide)]; /* positions stay where the tape has them */
    size_t vectors;                                                        /* of each register */
    sk_wide w[SK_FORMULA_GROUPS * SK_PARTS][SK_MOST_ARITY];
    sk_tape_verdict verdict;
    const sk_constraint_formula *made;
    const sk_tape *tape;
    places to;
    size_t arity, rests;
    const skein_compiled *compiled; /* runs in place of the tape; NULL: the tape runs */
    skein_element_values elements;  /* its arguments, which point to these: */
    const real *position[SK_MOST_ARITY], *rest[SKEIN_FORMULA_MOST_RESTS];
    real *output[3 * SK_MOST_ARITY * (3 * SK_MOST_ARITY + 1) / 2];
    real parameter[SKEIN_FORMULA_MOST_PARAMETERS];
} block;

static real *register_of(block *b, uint16_t number) {
    return (real *)(b->registers + (number == NOWHERE ? 0 : number) * b->vectors);
}

static void find_compiled_parameters(const sk_formula_params *params, real value[SKEIN_FORMULA_MOST_PARAMETERS]) {
    const sk_constraint_formula *made = params->made;
    for (size_t i = 0; made->compiled->parameters[i]; i++) value[i] = (real)params->parameter[made->parameter_of[i]];
}

static void begin_compiled(block *b, const sk_batch *batch, double time) {
    const sk_formula_params *params = batch->params;
    find_compiled_parameters(params, b->parameter);
    for (size_t p = 0; p < batch->arity; p++) b->position[p] = register_of(b, b->to.position[p]);
    for (size_t r = 0; r < batch->rest_count; r++) b->rest[r] = register_of(b, b->to.rest[r]);
    for (size_t k = 0; k < b->tape->outputs; k++) b->output[k] = register_of(b, b->tape->output[k]);
    b->elements = (skein_element_values){.positions = b->position,
                                         .stride = b->vectors * SK_PART,
                                         .rest = b->rest,
                                         .parameters = b->parameter,
                                         .time = (real)time,
                                         .elementary = sk_compiled_elementary(b->compiled->lanes),
                                         .outputs = b->output};
}

/* Once before all blocks of an op: sets what is the same for all elements. */
static void begin_block(block *b, const sk_batch *batch, const sk_tape *tape, const skein_compiled *compiled,
                        double time) {
    const sk_formula_params *params = batch->params;
    b->made = params->made, b->tape = tape, b->compiled = compiled;
    b->to = find_places(batch, tape);
    b->arity = batch->arity, b->rests = batch->rest_count;
    b->vectors = tape->wides * SK_PARTS;
    if (compiled) {
        begin_compiled(b, batch, time);
        return;
    }
    int count = params->made->formula->parameters;
    const real *parameter[SKEIN_FORMULA_MOST_PARAMETERS];
    for (int i = 0; i < count; i++) b->parameter[i] = (real)params->parameter[i], parameter[i] = &b->parameter[i];
    sk_tape_input input = {.parameter = parameter, .uniform = ((uint64_t)1 << count) - 1, .time = (real)time};
    sk_tape_kernels_of[SK_THIS_ISA]->begin(tape, &input, b->registers, b->vectors);
    // a tape also runs on vectors that a block does not fill: these must be finite
    for (size_t p = 0; p < batch->arity; p++)
        if (b->to.position[p] != NOWHERE)
            memset(register_of(b, b->to.position[p]), 0, 3 * b->vectors * sizeof(sk_wide));
    for (size_t r = 0; r < batch->rest_count; r++)
        if (b->to.rest[r] != NOWHERE) memset(register_of(b, b->to.rest[r]), 0, b->vectors * sizeof(sk_wide));
}

/* Runs the first `count` vectors of each register. */
static void run_block(block *b, size_t count) {
    const sk_tape_kernels *kernels = sk_tape_kernels_of[SK_THIS_ISA];
    if (!b->compiled) {
        kernels->run(b->tape, b->registers, b->vectors, count, &b->verdict);
        return;
    }
    b->elements.count = count * SK_PART;
    if (b->tape == &b->made->hessian) b->compiled->second(&b->elements);
    else b->compiled->evaluate(&b->elements);
    if (!b->tape->unjudged) kernels->judge(b->tape, b->registers, b->vectors, count, b->verdict.finite);
}

/* Puts a part of elements into the tape's registers, as vector i of each: the particles that it reads, and the rest
 * values, which are `stride` reals apart. */
SK_INLINE void fill(block *b, size_t i, size_t arity, size_t rests, const sk_vec4 *x, size_t packed,
                    const uint32_t *slots, const real *rest, size_t stride) {
    const size_t vectors = b->vectors;
    SK_UNROLLED
    for (size_t p = 0; p < arity; p++) {
        if (b->to.position[p] == NOWHERE) continue;
        sk_wide *at = b->registers + b->to.position[p] * vectors + i;
        sk_wide4 q = sk_gather_any(x, packed, slots + p * SK_LANES);
        at[0] = q.x, at[vectors] = q.y, at[2 * vectors] = q.z, b->w[i][p] = q.w;
    }
    for (size_t r = 0; r < rests; r++)
        if (b->to.rest[r] != NOWHERE)
            memcpy(b->registers + b->to.rest[r] * vectors + i, rest + r * stride, sizeof(sk_wide));
}

/* Takes the results for vector i of a block, a part of elements. */
SK_INLINE void take_answer(sk_element *e, const block *b, size_t arity, size_t i, bool weighed) {
    const uint16_t *output = b->tape->output;
    const sk_wide *registers = b->registers + i;
    e->judged = e->timed = true, e->divided = e->opposite = false;
    e->is_energy = b->made->is_energy, e->one_sided = b->made->one_sided;
    e->arity = (int)arity;
#define OUTPUT(k_) registers[output[k_] * b->vectors]
    e->value = OUTPUT(0);
    SK_EACH_PARTICLE_OF (e, p) e->gradient[p] = (sk_wide3){OUTPUT(3 * p + 1), OUTPUT(3 * p + 2), OUTPUT(3 * p + 3)};
    e->by_time = OUTPUT(3 * arity + 1);
#undef OUTPUT
    judge(e, weighed);
}

/* ---- the walk ---- */

#include <skein/inside/group_walk.h>

/* Finishes and stores vector i of a block that has run. Particles that the formula does not read keep their place. */
SK_INLINE void settle_part(group_part *p, const skein_groups *g, const sk_element_constants *c, const block *b,
                           size_t arity, size_t i, size_t packed, sk_element_mode mode) {
    const size_t vectors = b->vectors;
    sk_element *e = &p->e;
    bool others = mode == SK_MODE_PROJECT_DAMPED || (mode == SK_MODE_FORCE && c->damping_time > 0);
    e->arity = (int)arity;
    SK_EACH_PARTICLE_OF (e, q) {
        e->reads[q] = b->to.position[q] != NOWHERE;
        e->x[q] = e->other[q] = (sk_wide3){{0}, {0}, {0}}; // multiplied by zero damping, so it must be finite
        e->w[q] = (sk_wide){0};
        if (!e->reads[q]) continue;
        const sk_wide *x = b->registers + b->to.position[q] * vectors + i;
        e->x[q] = (sk_wide3){x[0], x[vectors], x[2 * vectors]}, e->w[q] = b->w[i][q];
        p->at[q] = (sk_wide4){x[0], x[vectors], x[2 * vectors], e->w[q]};
        if (others) take_other(p, q, g, packed);
    }
    take_values(p, g, c, mode);
    take_answer(e, b, arity, i, mode != SK_MODE_FORCE);
    answer(e, c, mode);
    put_down(p, g, packed, mode);
}

/* Computes `count` groups as a block. `arity` is the batch's, a constant where that is faster: then values of an
 * element's particles stay in processor registers. */
SK_INLINE void meet_block(const skein_groups *g, const sk_element_constants *c, size_t first, size_t count,
                          size_t packed, sk_element_mode mode, block *b, size_t arity) {
    for (size_t i = 0; i < count * SK_PARTS; i++) {
        size_t group = first + i / SK_PARTS, part = i % SK_PARTS * SK_PART;
        fill(b, i, arity, b->rests, (const sk_vec4 *)(const void *)g->positions, packed,
             g->slots + group * arity * SK_LANES + part, g->rest + group * SK_LANES + part, g->rest_stride);
    }
    run_block(b, count * SK_PARTS);
    for (size_t i = 0; i < count * SK_PARTS; i++) {
        group_part p;
        begin_part(&p, g, arity, first + i / SK_PARTS, i % SK_PARTS * SK_PART);
        settle_part(&p, g, c, b, arity, i, packed, mode);
    }
}

#define MEETING(name_, arity_)                                                                             \
    SK_INLINE void name_(const skein_groups *g, const sk_element_constants *c, size_t first, size_t count, \
                         size_t packed, sk_element_mode mode, void *data) {                                \
        block *b = data;                                                                                   \
        meet_block(g, c, first, count, packed, mode, b, (arity_));                                         \
    }
MEETING(meet_2, 2)
MEETING(meet_3, 3)
MEETING(meet_4, 4)
MEETING(meet_any, b->arity)
#undef MEETING

/* Runs compiled code on the same groups. */
static void run_compiled(skein_groups *g, const sk_element_constants *c, const sk_batch *batch, double time,
                         sk_element_mode mode) {
    const sk_formula_params *params = batch->params;
    const skein_compiled *compiled = params->made->compiled;
    real parameter[SKEIN_FORMULA_MOST_PARAMETERS];
    find_compiled_parameters(params, parameter);
    g->parameters = parameter, g->time = (real)time, g->elementary = sk_compiled_elementary(compiled->lanes);
    g->step = c->step, g->damping_time = c->damping_time, g->per_step = c->per_step, g->gamma = c->gamma;
    if (mode == SK_MODE_FORCE && !(c->damping_time > 0)) g->other = NULL;
    if (mode == SK_MODE_FORCE) compiled->force(g);
    else if (mode == SK_MODE_PROJECT) compiled->project(g);
    else compiled->project_damped(g);
}

SK_INLINE void walk(sk_run *run, const sk_op *op, size_t begin, size_t end, sk_element_mode mode,
                    group_meeting *meeting) {
    const sk_batch *batch = ((const sk_sweep *)op->rule)->batch;
    const sk_constraint_formula *made = ((const sk_formula_params *)batch->params)->made;
    const sk_element_constants constants = sk_element_prepare(batch, op);
    skein_groups groups = sk_groups_of(run, op, begin, end, mode);
    if (made->compiled) {
        run_compiled(&groups, &constants, batch, run->time - op->before_end, mode);
        return;
    }
    block b;
    begin_block(&b, batch, &made->tape, NULL, run->time - op->before_end);
    walk_groups(&groups, &constants, batch->arity, batch->rest_count, made->tape.wides, mode, meeting, &b);
}

void SK_KERNEL(force_groups)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    walk(run, op, begin, end, SK_MODE_FORCE, meet_any);
}
void SK_KERNEL(project_groups)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    switch (((const sk_sweep *)op->rule)->batch->arity) {
#ifndef SK_SMALL // where bytes are dear, one walk serves all, as it does when forces are summed
    case 2: walk(run, op, begin, end, SK_MODE_PROJECT, meet_2); break;
    case 3: walk(run, op, begin, end, SK_MODE_PROJECT, meet_3); break;
    case 4: walk(run, op, begin, end, SK_MODE_PROJECT, meet_4); break;
#endif
    default: walk(run, op, begin, end, SK_MODE_PROJECT, meet_any);
    }
}
void SK_KERNEL(project_damped_groups)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    if (sk_is_damped(op)) walk(run, op, begin, end, SK_MODE_PROJECT_DAMPED, meet_any);
    else walk(run, op, begin, end, SK_MODE_PROJECT_KEPT, meet_any);
}

/* ---- implicit solves: elements, not groups ---- */

/* Runs a block on elements [begin, begin + count), at most sixteen; lanes past them repeat the last element. */
static void run_elements(block *b, const sk_batch *batch, const sk_vec4 *x, size_t packed, size_t begin, size_t count) {
    uint32_t slot[SK_MOST_ARITY][SK_LANES];
    SK_VECTOR_ALIGNED real rest[SKEIN_FORMULA_MOST_RESTS][SK_LANES];
    for (size_t l = 0; l < SK_LANES; l++) {
        size_t e = begin + (l < count ? l : count - 1);
        for (size_t p = 0; p < batch->arity; p++) slot[p][l] = batch->slot[e * batch->arity + p];
        for (size_t r = 0; r < batch->rest_count; r++) rest[r][l] = batch->rest[r * batch->count + e];
    }
    for (size_t part = 0; part < SK_PARTS; part++)
        fill(b, part, batch->arity, batch->rest_count, x, packed, slot[0] + part * SK_PART, rest[0] + part * SK_PART,
             SK_LANES);
    run_block(b, SK_PARTS);
}

/* The matrices of a part of elements: lower triangles of 3 arity rows, positive definite. */
typedef struct matrix {
    sk_wide entry[3 * SK_MOST_ARITY * (3 * SK_MOST_ARITY + 1) / 2];
} matrix;
#define ENTRY(m_, i_, j_) (m_)->entry[(i_) * ((i_) + 1) / 2 + (j_)]

/* A constraint's k grad C grad C^T. */
static void square_gradient(matrix *m, const sk_element *a, size_t arity) {
    sk_wide g[3 * SK_MOST_ARITY];
    for (size_t p = 0; p < arity; p++) {
        g[3 * p] = sk_keep(a->active, a->gradient[p].x);
        g[3 * p + 1] = sk_keep(a->active, a->gradient[p].y);
        g[3 * p + 2] = sk_keep(a->active, a->gradient[p].z);
    }
    for (size_t i = 0; i < 3 * arity; i++)
        for (size_t j = 0; j <= i; j++) ENTRY(m, i, j) = g[i] * g[j];
}

/* Makes a symmetric matrix positive definite as in Gill and Murray's factorisation: pivots that are too small for their
 * columns are raised, and the difference is added to the diagonal. */
static void make_definite(matrix *m, size_t size) {
    matrix l = *m;
    sk_wide largest = {0}, off = {0}, raised[3 * SK_MOST_ARITY];
    for (size_t i = 0; i < size; i++)
        for (size_t j = 0; j <= i; j++) {
            sk_wide a = sk_wide_abs(ENTRY(m, i, j)), *most = i == j ? &largest : &off;
            *most = sk_select(sk_more(a, *most), a, *most);
        }
    sk_wide bound = sk_select(sk_more(off, (real)size * largest), off / (real)size, largest);
    sk_wide least = largest * (real)(sizeof(real) == 8 ? 1e-12 : 1e-5);
    for (size_t j = 0; j < size; j++) {
        sk_wide pivot = ENTRY(&l, j, j), column = {0};
        for (size_t i = j + 1; i < size; i++) {
            sk_wide a = sk_wide_abs(ENTRY(&l, i, j));
            column = sk_select(sk_more(a, column), a, column);
        }
        sk_wide needed = sk_keep(sk_positive(bound), column * column / bound), d = pivot;
        d = sk_select(sk_more(needed, d), needed, d);
        d = sk_select(sk_more(least, d), least, d);
        raised[j] = d - pivot;
        sk_wide inverse = sk_keep(sk_positive(d), 1 / d);
        for (size_t i = j + 1; i < size; i++) {
            sk_wide factor = ENTRY(&l, i, j) * inverse;
            for (size_t k = j + 1; k <= i; k++) ENTRY(&l, i, k) -= factor * ENTRY(&l, k, j);
        }
    }
    for (size_t j = 0; j < size; j++) ENTRY(m, j, j) += raised[j];
}

/* A loop over an op's elements, part by part, with their matrices: now at elements [at, at + count) of the batch. */
typedef struct stiff_walk {
    const sk_run *run;
    const sk_op *op;
    block b; /* of sixteen elements */
    size_t part, next, at, count, end;
    matrix m;
} stiff_walk;

static void start_walk(stiff_walk *w, const sk_run *run, const sk_op *op, size_t begin, size_t end) {
    const sk_batch *batch = op->rule;
    const sk_constraint_formula *made = ((const sk_formula_params *)batch->params)->made;
    w->run = run, w->op = op, w->next = begin, w->end = end, w->part = 0;
    begin_block(&w->b, batch, made->is_energy ? &made->hessian : &made->single, made->compiled,
                run->time - op->before_end);
}

/* Finds the matrices of the present part, over k: the stiffness, and that with damping. */
static void find_stiffness(stiff_walk *w) {
    const sk_batch *batch = w->op->rule;
    const sk_constraint_formula *made = ((const sk_formula_params *)batch->params)->made;
    if (made->is_energy) {
        for (size_t k = 0; k < w->b.tape->outputs; k++)
            w->m.entry[k] =
                sk_keep(w->b.verdict.finite[w->part], w->b.registers[w->b.tape->output[k] * SK_PARTS + w->part]);
        make_definite(&w->m, 3 * batch->arity);
    } else {
        sk_element a;
        take_answer(&a, &w->b, batch->arity, w->part, false);
        square_gradient(&w->m, &a, batch->arity);
    }
    const sk_material *material = batch->params;
    real both =
        (real)(material->stiffness * (w->op->coefficient[0] + w->op->coefficient[1] * sk_batch_damping_time(batch)));
    for (size_t k = 0; k < 3 * batch->arity * (3 * batch->arity + 1) / 2; k++) w->m.entry[k] *= both;
}

/* Goes on to the next part; false at the end. */
static bool walk_on(stiff_walk *w) {
    if (w->next >= w->end) return false;
    const sk_batch *batch = w->op->rule;
    size_t left = w->end - w->next;
    if (w->part == 0)
        run_elements(&w->b, batch, w->run->vector[SK_X], w->op->packed, w->next, left < SK_LANES ? left : SK_LANES);
    find_stiffness(w);
    w->at = w->next, w->count = left < SK_PART ? left : SK_PART;
    w->next += w->count, w->part = (w->part + 1) % SK_PARTS;
    return true;
}

void SK_KERNEL(apply)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    const sk_batch *batch = op->rule;
    const sk_vec4 *q = run->vector[op->source[1]];
    size_t size = 3 * batch->arity;
    stiff_walk w;
    start_walk(&w, run, op, begin, end);
    while (walk_on(&w)) {
        sk_wide u[3 * SK_MOST_ARITY] = {{0}}, f[3 * SK_MOST_ARITY];
        for (size_t l = 0; l < w.count; l++)
            for (size_t p = 0; p < batch->arity; p++) {
                sk_vec4 v = sk_load(q, op->packed, batch->slot[(w.at + l) * batch->arity + p]);
                u[3 * p][l] = v.x, u[3 * p + 1][l] = v.y, u[3 * p + 2][l] = v.z;
            }
        for (size_t i = 0; i < size; i++) {
            f[i] = (sk_wide){0};
            for (size_t j = 0; j < size; j++) f[i] += (j <= i ? ENTRY(&w.m, i, j) : ENTRY(&w.m, j, i)) * u[j];
        }
        for (size_t l = 0; l < w.count; l++)
            for (size_t p = 0; p < batch->arity; p++)
                sk_add_at(run->vector[op->dst], op->packed, batch->slot[(w.at + l) * batch->arity + p],
                          sk_v3(f[3 * p][l], f[3 * p + 1][l], f[3 * p + 2][l]));
    }
}

void SK_KERNEL(diagonal)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    const sk_batch *batch = op->rule;
    stiff_walk w;
    start_walk(&w, run, op, begin, end);
    while (walk_on(&w)) {
        for (size_t l = 0; l < w.count; l++)
            for (size_t p = 0; p < batch->arity; p++) {
                uint32_t slot = batch->slot[(w.at + l) * batch->arity + p];
                size_t i = 3 * p;
                sk_add_at(run->vector[op->dst], op->packed, slot,
                          sk_v3(ENTRY(&w.m, i, i)[l], ENTRY(&w.m, i + 1, i + 1)[l], ENTRY(&w.m, i + 2, i + 2)[l]));
                sk_add_at(run->vector[op->source[1]], op->packed, slot,
                          sk_v3(ENTRY(&w.m, i + 1, i)[l], ENTRY(&w.m, i + 2, i)[l], ENTRY(&w.m, i + 2, i + 1)[l]));
            }
    }
}

void SK_KERNEL(blocks)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    const sk_batch *batch = op->rule;
    size_t arity = batch->arity, pairs = arity * (arity - 1) / 2;
    stiff_walk w;
    start_walk(&w, run, op, begin, end);
    while (walk_on(&w)) {
        for (size_t l = 0; l < w.count; l++) {
            const uint32_t *particle = batch->particle + arity * (w.at + l);
            const uint32_t *pair = batch->pair + pairs * (w.at + l);
            for (size_t p = 0; p < arity; p++)
                for (size_t q = 0; q <= p; q++) {
                    double entry[3][3];
                    for (size_t i = 0; i < 3; i++)
                        for (size_t j = 0; j < 3; j++) {
                            size_t r = 3 * p + i, c = 3 * q + j;
                            entry[i][j] = (double)(c <= r ? ENTRY(&w.m, r, c)[l] : ENTRY(&w.m, c, r)[l]);
                        }
                    if (p == q) sk_matrix_add_diagonal(run->matrix, particle[p], entry);
                    else sk_matrix_add_pair(run->matrix, particle[p], particle[q], pair[p * (p - 1) / 2 + q], entry);
                }
        }
    }
}
#undef ENTRY

/* ---- measuring ---- */

size_t SK_KERNEL(energy)(const sk_batch *batch, double time, const sk_vec4 *x, size_t begin, size_t end,
                         double *energy) {
    const sk_constraint_formula *made = ((const sk_formula_params *)batch->params)->made;
    size_t guarded = 0;
    block b;
    begin_block(&b, batch, &made->single, NULL, time); // always the tape, which counts guarded values
    for (size_t at = begin; at < end; at += SK_LANES) {
        size_t count = end - at < SK_LANES ? end - at : SK_LANES;
        run_elements(&b, batch, x, 0, at, count);
        for (size_t part = 0; part * SK_PART < count; part++) {
            sk_element a;
            take_answer(&a, &b, batch->arity, part, false);
            sk_mask odd = b.verdict.guarded[part] | ~b.verdict.finite[part];
            for (size_t l = 0; l < SK_PART && part * SK_PART + l < count; l++) {
                double c = (double)a.value[l];
                energy[at - begin + part * SK_PART + l] = !a.active[l] ? 0 : made->is_energy ? c : 0.5 * c * c;
                guarded += odd[l] != 0;
            }
        }
    }
    return guarded;
}

#else

static const skein_field constraint_fields[] = {
    SK_TEXT(sk_formula_params, text, "constraint", "length(p0 - p1) - rest(length(p0 - p1))",
            "a formula of p0 to p7 and t that wants to be 0, or `a >= b`; rest(...) is taken when it is made"),
    SK_REAL(sk_formula_params, material.stiffness, "stiffness", "J", 1e4, 0, SK_UNBOUNDED,
            "twice the energy where the formula is 1; \"infinite\" is rigid (position methods only)"),
    SK_REAL(sk_formula_params, material.damping, "damping", "J s", 0, 0, SK_FAR,
            "against the formula's change in time, as stiffness is against its value"),
    SK_PARAMETERS(sk_formula_params, parameter, "a number that the formula names: { \"L\": 0.5 }, say"),
};

static const skein_field energy_fields[] = {
    SK_TEXT(sk_formula_params, text, "energy", "0.5 * (length(p0 - p1) - rest(length(p0 - p1)))^2",
            "a formula of p0 to p7 and t, in joules; position methods need it to be 0 at the least"),
    SK_REAL(sk_formula_params, material.stiffness, "scale", "", 1, 0, SK_FAR, "a factor of the energy"),
    SK_PARAMETERS(sk_formula_params, parameter, "a number that the formula names: { \"k\": 100 }, say"),
};

/* Every version gives the same bits; the first runs on every machine. */
static size_t energy(const sk_batch *batch, double time, const sk_vec4 *x, size_t begin, size_t end, double *out) {
    static energy_of *const versions[] = SK_EACH_ISA(energy);
    return versions[0](batch, time, x, begin, end, out);
}

/* The members that both kinds have in common. */
#define ON_A_TAPE                                                                                                    \
    .arity_of = sk_formula_arity_of, .rest_count_of = sk_formula_rest_count_of, .rest = sk_formula_rest,             \
    .in_blocks = true, .force.groups = {SK_EACH_ISA(force_groups)}, .project.groups = {SK_EACH_ISA(project_groups)}, \
    .project_damped.groups = {SK_EACH_ISA(project_damped_groups)}, .apply = {SK_EACH_ISA(apply)},                    \
    .diagonal = {SK_EACH_ISA(diagonal)}, .blocks = {SK_EACH_ISA(blocks)}, .energy = energy,                          \
    .evaluate = sk_formula_evaluate_one

const sk_constraint_type sk_formula_constraint = {
    .kind = {"formula", "any function of up to eight particles that wants to be 0, or at least 0", SKEIN_CONSTRAINT,
             constraint_fields, sizeof constraint_fields / sizeof *constraint_fields, sizeof(sk_formula_params)},
    ON_A_TAPE,
    .making = &sk_formula_making,
};

const sk_constraint_type sk_energy = {
    .kind = {"energy", "any energy of up to eight particles", SKEIN_CONSTRAINT, energy_fields,
             sizeof energy_fields / sizeof *energy_fields, sizeof(sk_formula_params)},
    ON_A_TAPE,
    .making = &sk_energy_making,
};
#endif
