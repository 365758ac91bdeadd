/* Constraints and energies that are texts: any formula of up to eight particles (docs/formula.md).
 *
 * A constraint C wants to be 0, or, written `a >= b`, at least 0. An energy E is what its forces come from; under
 * position methods it is the constraint C = sqrt(2 E), without ever dividing by the root: where E and its gradient are
 * 0, so is the correction. Both run on a tape: up to four groups of sixteen elements that share no particle are one
 * block, gathered, run through the tape, solved and put back group by group, in their order. */
#include "constraints/formula.h"
#include "base/kernels.h"

/* Loops over an element's particles. */
#ifdef __clang__
#define UNROLLED
#else
#define UNROLLED _Pragma("GCC unroll 4")
#endif

enum { NOWHERE = 0xffff };

/* The registers where a tape wants an element's positions and rest values. */
typedef struct places {
    uint16_t position[SK_MOST_ARITY], rest[SKEIN_FORMULA_MOST_RESTS];
} places;

typedef size_t energy_of(const sk_batch *batch, double time, const sk_vec4 *x, size_t begin, size_t end, double *out);

#define SK_UNIT formula
SK_KERNELS(energy_of, energy);
SK_KERNELS(sk_row_kernel, force_groups);
SK_KERNELS(sk_row_kernel, project_groups);
SK_KERNELS(sk_row_kernel, project_damped_groups);
SK_KERNELS(sk_row_kernel, apply);
SK_KERNELS(sk_row_kernel, diagonal);
SK_KERNELS(sk_row_kernel, blocks);

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

/* Groups [first, first + count) of a sweep, or sixteen elements of a batch, on their way. */
typedef struct block {
    SK_VECTOR_ALIGNED sk_wide registers[SK_TAPE_MEMORY / sizeof(sk_wide)]; /* positions stay where the tape has them */
    size_t vectors;                                                        /* of each register */
    sk_wide w[SK_FORMULA_GROUPS * SK_PARTS][SK_MOST_ARITY];
    sk_tape_verdict verdict;
} block;

/* Once before the blocks of a row: what is the same for all elements. */
static void begin_tape(block *b, const sk_batch *batch, const sk_tape *tape, double time) {
    const sk_formula_params *params = batch->params;
    int count = params->made->formula->parameters;
    real value[SKEIN_FORMULA_MOST_PARAMETERS];
    const real *parameter[SKEIN_FORMULA_MOST_PARAMETERS];
    for (int i = 0; i < count; i++) value[i] = (real)params->parameter[i], parameter[i] = &value[i];
    sk_tape_input input = {.parameter = parameter, .uniform = ((uint64_t)1 << count) - 1, .time = (real)time};
    b->vectors = tape->wides * SK_PARTS;
    sk_tape_kernels_of[SK_THIS_ISA]->begin(tape, &input, b->registers, b->vectors);
}

/* Puts a part of sixteen elements into the tape's registers, as vector i of each: the particles that it reads, and rest
 * values, which are `stride` reals from one to the next. */
SK_INLINE void fill(block *b, const places *to, size_t i, size_t arity, size_t rests, const sk_vec4 *x, size_t packed,
                    const uint32_t *slots, const real *rest, size_t stride) {
    size_t vectors = b->vectors;
    UNROLLED
    for (size_t p = 0; p < arity; p++) {
        if (to->position[p] == NOWHERE) continue;
        sk_wide *at = b->registers + to->position[p] * vectors + i;
        sk_wide4 q = sk_gather_any(x, packed, slots + p * SK_LANES);
        at[0] = q.x, at[vectors] = q.y, at[2 * vectors] = q.z, b->w[i][p] = q.w;
    }
    for (size_t r = 0; r < rests; r++)
        if (to->rest[r] != NOWHERE)
            memcpy(b->registers + to->rest[r] * vectors + i, rest + r * stride, sizeof(sk_wide));
}

/* What came out of the tape for a part of sixteen elements. */
typedef struct answer {
    sk_wide value, by_time;
    sk_wide3 gradient[SK_MOST_ARITY];
    sk_mask active; /* finite, and not on the free side */
} answer;

SK_INLINE void take_answer(answer *a, const block *b, const sk_tape *tape, size_t arity, size_t i, bool one_sided) {
    const uint16_t *output = tape->output;
    const sk_wide *registers = b->registers + i;
#define OUTPUT(k_) registers[output[k_] * b->vectors]
    sk_wide sum = a->value = OUTPUT(0);
    UNROLLED
    for (size_t p = 0; p < arity; p++) {
        sk_wide3 g = a->gradient[p] = (sk_wide3){OUTPUT(3 * p + 1), OUTPUT(3 * p + 2), OUTPUT(3 * p + 3)};
        sum += g.x, sum += g.y, sum += g.z;
    }
    sum += a->by_time = OUTPUT(3 * arity + 1);
#undef OUTPUT
    // as tapes are judged, which may have been done
    sk_mask finite = ~sk_differ(sum - sum, (sk_wide){0});
    if (!tape->unjudged) finite &= b->verdict.finite[i];
    a->active = one_sided ? finite & sk_negative(a->value) : finite;
    if (!sk_any(~finite)) return;
    a->value = sk_keep(finite, a->value), a->by_time = sk_keep(finite, a->by_time);
    for (size_t p = 0; p < arity; p++) {
        sk_wide3 g = a->gradient[p];
        a->gradient[p] = (sk_wide3){sk_keep(finite, g.x), sk_keep(finite, g.y), sk_keep(finite, g.z)};
    }
}

SK_INLINE sk_wide sum_along(const answer *a, const sk_wide3 *u, size_t arity) {
    sk_wide sum = sk_dot_wide(a->gradient[0], u[0]);
    for (size_t p = 1; p < arity; p++) sum += sk_dot_wide(a->gradient[p], u[p]);
    return sum;
}

/* ---- from value and gradient to a factor of the gradient ---- */

SK_INLINE sk_wide pull(const answer *a, const sk_wide3 *v, size_t arity, bool is_energy, sk_wide stiffness,
                       real damping_time) {
    if (is_energy) return sk_keep(a->active, -stiffness);
    sk_wide rate = sum_along(a, v, arity) + a->by_time;
    return sk_keep(a->active, stiffness * (-a->value - damping_time * rate));
}

/* The sum of w |gradient|^2. */
SK_INLINE sk_wide weight_of(const answer *a, const sk_wide *w, size_t arity) {
    sk_wide weight = w[0] * sk_dot_wide(a->gradient[0], a->gradient[0]);
    UNROLLED
    for (size_t p = 1; p < arity; p++) weight += w[p] * sk_dot_wide(a->gradient[p], a->gradient[p]);
    return weight;
}

/* Of an energy C^2 = 2 E takes part in place of C = sqrt(2 E), whose gradient has no value where E is 0. */
SK_INLINE sk_wide project(const answer *a, const sk_wide *w, size_t arity, bool is_energy, sk_wide soft) {
    sk_wide weight = weight_of(a, w, arity), above = -a->value, below = weight + soft;
    if (is_energy) {
        sk_wide square = sk_keep(sk_positive(a->value), 2 * a->value);
        // an infinite compliance times 0 is nothing
        above = -square, below = weight + sk_keep(sk_positive(square), soft * square);
    }
    return sk_keep(a->active & sk_positive(below), above / below);
}

/* `moved` from the substep's start on; `multiplier` is kept up to date. A one-sided one only ever pushes. */
SK_INLINE sk_wide project_damped(const answer *a, const sk_wide *w, const sk_wide3 *moved, size_t arity,
                                 const sk_constraint_formula *made, sk_wide soft, real gamma, real h,
                                 sk_wide *multiplier) {
    sk_wide weight = weight_of(a, w, arity);
    sk_wide held = sk_keep(sk_differ(*multiplier, (sk_wide){0}), soft * *multiplier), change, s;
    if (made->is_energy) {
        sk_wide square = sk_keep(sk_positive(a->value), 2 * a->value);
        sk_wide root = sk_wide_sqrt(square);
        sk_wide below = weight + sk_keep(sk_positive(square), soft * square);
        s = sk_keep(a->active & sk_positive(below), root * (-root - held) / below);
        *multiplier += root * s;
        return s;
    }
    sk_wide rate = sum_along(a, moved, arity) + h * a->by_time;
    sk_wide below = (1 + gamma) * weight + soft;
    sk_mask on = sk_positive(below) & (made->one_sided ? a->active | sk_positive(*multiplier) : a->active);
    change = sk_keep(on, (-a->value - held - gamma * rate) / below);
    if (made->one_sided) change = sk_select(sk_negative(*multiplier + change), -*multiplier, change);
    *multiplier += change;
    return change;
}

/* ---- the walk ---- */

SK_INLINE void put_back(sk_vec4 *vector, size_t packed, const uint32_t *slot, sk_wide4 old, sk_wide s, sk_wide3 g) {
    old.x += s * g.x, old.y += s * g.y, old.z += s * g.z;
    if (!packed) {
        sk_scatter(vector, slot, old);
        return;
    }
    for (int l = 0; l < SK_PART; l++) sk_store_at(vector, packed, slot[l], sk_v3(old.x[l], old.y[l], old.z[l]));
}

/* Vector `i` of a block whose tape has run: some part of sixteen elements, their first one at `lane`, with their
 * particles' slots. Particles that the formula does not read stay where they are. */
SK_INLINE void settle_part(sk_run *run, const sk_row *row, const sk_sweep *sweep, const block *b,
                           const sk_formula_factors *f, const places *to, size_t arity, size_t i, size_t lane,
                           const uint32_t *slots, size_t packed, sk_row_kind kind, bool damped) {
    const sk_batch *batch = sweep->batch;
    const sk_constraint_formula *made = ((const sk_formula_params *)batch->params)->made;
    size_t vectors = b->vectors;
    answer a;
    sk_wide w[SK_MOST_ARITY] = {{0}}, s;
    sk_wide3 other[SK_MOST_ARITY];
    take_answer(&a, b, &made->tape, arity, i, made->one_sided);
    UNROLLED
    for (size_t p = 0; p < arity; p++) {
        other[p] = (sk_wide3){{0}, {0}, {0}}; // what no damping is multiplied by must be a number
        if (to->position[p] == NOWHERE) continue;
        const sk_wide *x = b->registers + to->position[p] * vectors + i;
        w[p] = b->w[i][p];
        if (!damped) continue;
        sk_wide4 o = sk_gather_any(run->vector[row->source[1]], packed, slots + p * SK_LANES);
        other[p] = (sk_wide3){o.x, o.y, o.z};
        if (kind == SK_ROW_PROJECT) other[p] = (sk_wide3){x[0] - o.x, x[vectors] - o.y, x[2 * vectors] - o.z};
    }
    sk_vec4 *dst = run->vector[row->dst];
    if (kind == SK_ROW_FORCE) {
        sk_wide stiffness = *(const sk_wide *)(const void *)(batch->lane_stiffness + lane);
        s = pull(&a, other, arity, made->is_energy, stiffness, f->damping_time);
    } else {
        sk_wide soft = *(const sk_wide *)(const void *)(batch->lane_compliance + lane) * f->per_step;
        sk_wide *multiplier = (sk_wide *)(void *)(batch->lane_multiplier + lane);
        s = damped ? project_damped(&a, w, other, arity, made, soft, f->gamma, (real)row->dt, multiplier)
                   : project(&a, w, arity, made->is_energy, soft);
    }
    UNROLLED
    for (size_t p = 0; p < arity; p++) {
        if (to->position[p] == NOWHERE) continue;
        const sk_wide *x = b->registers + to->position[p] * vectors + i;
        const uint32_t *slot = slots + p * SK_LANES;
        sk_wide4 old;
        if (kind == SK_ROW_FORCE) old = sk_gather_any(dst, packed, slot);
        else old = (sk_wide4){x[0], x[vectors], x[2 * vectors], w[p]};
        put_back(dst, packed, slot, old, kind == SK_ROW_FORCE ? s : s * w[p], a.gradient[p]);
    }
}

/* Groups [begin, end), or those of slabs [begin, end), block after block. `arity` is the batch's, a constant where it
 * pays: then what belongs to an element's particles stays in registers. */
SK_INLINE void walk(sk_run *run, const sk_row *row, size_t begin, size_t end, sk_row_kind kind, bool damped,
                    size_t arity) {
    const sk_sweep *sweep = row->rule;
    const sk_batch *batch = sweep->batch;
    const sk_constraint_formula *made = ((const sk_formula_params *)batch->params)->made;
    if (made->compiled) {
        sk_compiled_walk(run, row, begin, end, kind, damped);
        return;
    }
    const sk_tape *tape = &made->tape;
    places to = find_places(batch, tape);
    sk_formula_factors f = sk_formula_find_factors(batch, row);
    block b;
    if (sweep->slab_start) begin = sweep->slab_start[begin], end = sweep->slab_start[end];
    begin_tape(&b, batch, tape, run->time - row->before);
    for (size_t first = begin, count; first < end; first += count) {
        size_t packed[SK_FORMULA_GROUPS];
        count = sweep->ahead[first] < tape->wides ? sweep->ahead[first] : tape->wides;
        if (count > end - first) count = end - first;
        // what is beyond repeats the last, and later whatever an earlier block left there: nobody reads it
        for (size_t i = 0; i < (first == begin ? tape->wides : count); i++) {
            size_t group = first + (i < count ? i : count - 1);
            const uint32_t *slots = sweep->slots + group * arity * SK_LANES;
            bool strips = false;
            for (size_t l = 0; l < arity * SK_LANES && row->packed; l++) strips |= slots[l] < row->packed;
            packed[i] = strips ? row->packed : 0;
            const real *rest = batch->lane_rest + sweep->first_lane + group * SK_LANES;
            for (size_t part = 0; part < SK_PARTS; part++)
                fill(&b, &to, i * SK_PARTS + part, arity, batch->rest_count, run->vector[SK_X], packed[i],
                     slots + part * SK_PART, rest + part * SK_PART, batch->lane_count);
        }
        sk_tape_kernels_of[SK_THIS_ISA]->run(tape, b.registers, b.vectors, count * SK_PARTS, &b.verdict);
        for (size_t i = 0; i < count; i++)
            for (size_t part = 0; part < SK_PARTS; part++)
                settle_part(run, row, sweep, &b, &f, &to, arity, i * SK_PARTS + part,
                            sweep->first_lane + (first + i) * SK_LANES + part * SK_PART,
                            sweep->slots + (first + i) * arity * SK_LANES + part * SK_PART, packed[i], kind, damped);
    }
}

static size_t arity_of(const sk_row *row) {
    return ((const sk_sweep *)row->rule)->batch->arity;
}
void SK_KERNEL(force_groups)(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    const sk_sweep *sweep = row->rule;
    bool damped = sk_batch_damping_time(sweep->batch) > 0;
    walk(run, row, begin, end, SK_ROW_FORCE, damped, arity_of(row));
}
void SK_KERNEL(project_groups)(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    switch (arity_of(row)) {
    case 2: walk(run, row, begin, end, SK_ROW_PROJECT, false, 2); break;
    case 3: walk(run, row, begin, end, SK_ROW_PROJECT, false, 3); break;
    case 4: walk(run, row, begin, end, SK_ROW_PROJECT, false, 4); break;
    default: walk(run, row, begin, end, SK_ROW_PROJECT, false, arity_of(row));
    }
}
void SK_KERNEL(project_damped_groups)(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    walk(run, row, begin, end, SK_ROW_PROJECT, true, arity_of(row));
}

/* ---- implicit solves: elements, not groups ---- */

/* Runs a tape of one sixteen that has begun, or what is compiled for it, on elements [begin, begin + count), at most
 * sixteen; lanes past them repeat the last. */
static void run_elements(block *b, const sk_batch *batch, const sk_tape *tape, bool compiled, double time,
                         const sk_vec4 *x, size_t packed, size_t begin, size_t count) {
    uint32_t slot[SK_MOST_ARITY][SK_LANES];
    SK_VECTOR_ALIGNED real rest[SKEIN_FORMULA_MOST_RESTS][SK_LANES]; // as compiled code takes them
    places to = find_places(batch, tape);
    for (size_t l = 0; l < SK_LANES; l++) {
        size_t e = begin + (l < count ? l : count - 1);
        for (size_t p = 0; p < batch->arity; p++) slot[p][l] = batch->slot[e * batch->arity + p];
        for (size_t r = 0; r < batch->rest_count; r++) rest[r][l] = batch->rest[r * batch->count + e];
    }
    if (compiled) {
        const sk_constraint_formula *made = ((const sk_formula_params *)batch->params)->made;
        real *outputs[3 * SK_MOST_ARITY * (3 * SK_MOST_ARITY + 1) / 2];
        SK_VECTOR_ALIGNED sk_wide at[SK_MOST_ARITY][4][SK_PARTS], finite[SK_PARTS];
        for (size_t p = 0; p < batch->arity; p++)
            for (size_t part = 0; part < SK_PARTS; part++) {
                sk_wide4 q = sk_gather_any(x, packed, slot[p] + part * SK_PART);
                at[p][0][part] = q.x, at[p][1][part] = q.y, at[p][2][part] = q.z, at[p][3][part] = q.w;
            }
        for (size_t k = 0; k < tape->outputs; k++) outputs[k] = (real *)(b->registers + tape->output[k] * SK_PARTS);
        sk_compiled_evaluate(batch, time, tape == &made->hessian, (const real *)at, rest[0], outputs, (real *)finite);
        for (size_t part = 0; part < SK_PARTS; part++) b->verdict.finite[part] = sk_positive(finite[part]);
        return;
    }
    for (size_t part = 0; part < SK_PARTS; part++)
        fill(b, &to, part, batch->arity, batch->rest_count, x, packed, slot[0] + part * SK_PART,
             rest[0] + part * SK_PART, SK_LANES);
    sk_tape_kernels_of[SK_THIS_ISA]->run(tape, b->registers, SK_PARTS, SK_PARTS, &b->verdict);
}

/* The matrix of a part of sixteen elements: a lower triangle of 3 arity rows, positive definite. */
typedef struct matrix {
    sk_wide entry[3 * SK_MOST_ARITY * (3 * SK_MOST_ARITY + 1) / 2];
} matrix;
#define ENTRY(m_, i_, j_) (m_)->entry[(i_) * ((i_) + 1) / 2 + (j_)]

/* A constraint's k grad C grad C^T. */
static void square_gradient(matrix *m, const answer *a, size_t arity) {
    sk_wide g[3 * SK_MOST_ARITY];
    for (size_t p = 0; p < arity; p++) {
        g[3 * p] = sk_keep(a->active, a->gradient[p].x);
        g[3 * p + 1] = sk_keep(a->active, a->gradient[p].y);
        g[3 * p + 2] = sk_keep(a->active, a->gradient[p].z);
    }
    for (size_t i = 0; i < 3 * arity; i++)
        for (size_t j = 0; j <= i; j++) ENTRY(m, i, j) = g[i] * g[j];
}

/* The nearest that Gill's and Murray's factorisation comes to a symmetric matrix with one that is positive definite:
 * pivots that are too small for their columns are raised, and what they were raised by is added to the diagonal. */
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

/* A walk over a row's elements, part by part, with their matrices: elements [at, at + count) of the batch. */
typedef struct stiff_walk {
    const sk_run *run;
    const sk_row *row;
    const sk_tape *tape;
    block b; /* of sixteen elements */
    size_t part, next, at, count, end;
    matrix m;
} stiff_walk;

static void start_walk(stiff_walk *w, const sk_run *run, const sk_row *row, size_t begin, size_t end) {
    const sk_batch *batch = row->rule;
    const sk_constraint_formula *made = ((const sk_formula_params *)batch->params)->made;
    w->run = run, w->row = row, w->next = begin, w->end = end, w->part = 0;
    w->tape = made->is_energy ? &made->hessian : &made->single;
    begin_tape(&w->b, batch, w->tape, run->time - row->before);
}

/* The stiffness over k of the part that the walk has come to, elastic and both with damping. */
static void find_stiffness(stiff_walk *w) {
    const sk_batch *batch = w->row->rule;
    const sk_constraint_formula *made = ((const sk_formula_params *)batch->params)->made;
    if (made->is_energy) {
        for (size_t k = 0; k < w->tape->outputs; k++)
            w->m.entry[k] =
                sk_keep(w->b.verdict.finite[w->part], w->b.registers[w->tape->output[k] * SK_PARTS + w->part]);
        make_definite(&w->m, 3 * batch->arity);
    } else {
        answer a;
        take_answer(&a, &w->b, w->tape, batch->arity, w->part, made->one_sided);
        square_gradient(&w->m, &a, batch->arity);
    }
    const sk_material *material = batch->params;
    real both =
        (real)(material->stiffness * (w->row->coefficient[0] + w->row->coefficient[1] * sk_batch_damping_time(batch)));
    for (size_t k = 0; k < 3 * batch->arity * (3 * batch->arity + 1) / 2; k++) w->m.entry[k] *= both;
}

/* Goes on to the next part; false at the end. */
static bool walk_on(stiff_walk *w) {
    if (w->next >= w->end) return false;
    const sk_batch *batch = w->row->rule;
    size_t left = w->end - w->next;
    if (w->part == 0)
        run_elements(&w->b, batch, w->tape, ((const sk_formula_params *)batch->params)->made->compiled,
                     w->run->time - w->row->before, w->run->vector[SK_X], w->row->packed, w->next,
                     left < SK_LANES ? left : SK_LANES);
    find_stiffness(w);
    w->at = w->next, w->count = left < SK_PART ? left : SK_PART;
    w->next += w->count, w->part = (w->part + 1) % SK_PARTS;
    return true;
}

void SK_KERNEL(apply)(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    const sk_batch *batch = row->rule;
    const sk_vec4 *q = run->vector[row->source[1]];
    size_t size = 3 * batch->arity;
    stiff_walk w;
    start_walk(&w, run, row, begin, end);
    while (walk_on(&w)) {
        sk_wide u[3 * SK_MOST_ARITY] = {{0}}, f[3 * SK_MOST_ARITY];
        for (size_t l = 0; l < w.count; l++)
            for (size_t p = 0; p < batch->arity; p++) {
                sk_vec4 v = sk_load(q, row->packed, batch->slot[(w.at + l) * batch->arity + p]);
                u[3 * p][l] = v.x, u[3 * p + 1][l] = v.y, u[3 * p + 2][l] = v.z;
            }
        for (size_t i = 0; i < size; i++) {
            f[i] = (sk_wide){0};
            for (size_t j = 0; j < size; j++) f[i] += (j <= i ? ENTRY(&w.m, i, j) : ENTRY(&w.m, j, i)) * u[j];
        }
        for (size_t l = 0; l < w.count; l++)
            for (size_t p = 0; p < batch->arity; p++)
                sk_add_at(run->vector[row->dst], row->packed, batch->slot[(w.at + l) * batch->arity + p],
                          sk_v3(f[3 * p][l], f[3 * p + 1][l], f[3 * p + 2][l]));
    }
}

void SK_KERNEL(diagonal)(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    const sk_batch *batch = row->rule;
    stiff_walk w;
    start_walk(&w, run, row, begin, end);
    while (walk_on(&w)) {
        for (size_t l = 0; l < w.count; l++)
            for (size_t p = 0; p < batch->arity; p++) {
                uint32_t slot = batch->slot[(w.at + l) * batch->arity + p];
                size_t i = 3 * p;
                sk_add_at(run->vector[row->dst], row->packed, slot,
                          sk_v3(ENTRY(&w.m, i, i)[l], ENTRY(&w.m, i + 1, i + 1)[l], ENTRY(&w.m, i + 2, i + 2)[l]));
                sk_add_at(run->vector[row->source[1]], row->packed, slot,
                          sk_v3(ENTRY(&w.m, i + 1, i)[l], ENTRY(&w.m, i + 2, i)[l], ENTRY(&w.m, i + 2, i + 1)[l]));
            }
    }
}

void SK_KERNEL(blocks)(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    const sk_batch *batch = row->rule;
    size_t arity = batch->arity, pairs = arity * (arity - 1) / 2;
    stiff_walk w;
    start_walk(&w, run, row, begin, end);
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
    begin_tape(&b, batch, &made->single, time);
    for (size_t at = begin; at < end; at += SK_LANES) {
        size_t count = end - at < SK_LANES ? end - at : SK_LANES;
        run_elements(&b, batch, &made->single, false, time, x, 0, at, count); // a tape counts its guards
        for (size_t part = 0; part * SK_PART < count; part++) {
            answer a;
            take_answer(&a, &b, &made->single, batch->arity, part, made->one_sided);
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

/* Every version gives the same bits; the first is on every machine. */
static size_t energy(const sk_batch *batch, double time, const sk_vec4 *x, size_t begin, size_t end, double *out) {
    static energy_of *const versions[] = SK_EACH_ISA(energy);
    return versions[0](batch, time, x, begin, end, out);
}

/* What both kinds have in common. */
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
