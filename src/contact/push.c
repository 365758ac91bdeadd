/* What is near is moved apart, pair by pair, where a method corrects positions; and what goes through each other is led apart. */
#include <string.h>

#include "base/tasks.h"
#include "contact/touch.h"

/* Of the first three. */
static inline real dot_of(sk_quad a, sk_quad b) {
    sk_quad c = a * b;
    return c[0] + c[1] + c[2];
}

/* Pushes features apart, and rubs them by what that took. */
static void push_apart(sk_touch *touch, const sk_push *push) {
    sk_vec4 *q = touch->q;
    const uint32_t *v = push->corner;
    const sk_quad apart = sk_quad_sum(q, v, push->weight), n = {push->normal[0], push->normal[1], push->normal[2], 0};
    const real missing = push->wanted - dot_of(n, apart);
    if (!(missing > 0)) return; // as of most
    const real resist = sk_pair_resist(touch, v, push->weight);
    if (!(resist > 0)) return;
    sk_quad slip = apart - (sk_quad){push->before[0], push->before[1], push->before[2], 0};
    slip[3] = 0;
    slip -= sk_quad_times(dot_of(slip, n), n);
    const real length = sk_sqrt(dot_of(slip, slip)), rub = push->friction * missing;
    const real share = length > rub ? rub / length : 1;
    const sk_quad move =
        sk_quad_times(missing / resist, n) - sk_quad_times(push->friction > 0 ? share / resist : 0, slip);
    for (int c = 0; c < 4; c++) {
        sk_quad to = sk_quad_at(&q[v[c]]) + sk_quad_times(push->weight[c] * touch->inverse[v[c]], move);
        to[3] = 1; // moved
        memcpy(&q[v[c]], &to, sizeof to);
    }
}

/* Puts a vertex that was pushed back to its slot, with the velocity that it got. */
static void store(const sk_touch *touch, const sk_run *run, const sk_op *op, size_t v) {
    if (!(touch->q[v].w > 0)) return;
    const size_t slot = touch->slot[v];
    const sk_vec3 old = sk_xyz(sk_load(run->vector[SK_X], op->packed, slot)), now = sk_xyz(touch->q[v]);
    sk_store_at(run->vector[SK_X], op->packed, slot, now);
    const sk_watch watch = sk_watch_of(run, op);
    if (watch.moved) sk_watch_move(&watch, slot);
    if (op->source[1] != SK_NONE)
        sk_add_at(run->vector[op->source[1]], op->packed, slot, sk_scale((real)(1 / op->dt), sk_sub(now, old)));
}

void sk_touch_push_face(sk_touch *touch, const sk_run *run, const sk_op *op, const sk_face *face) {
    const uint32_t surface = (uint32_t)touch->skin.vertex_count;
    const sk_vec3 n = face->normal, from = sk_sub(face->at, face->way);
    sk_push push = {.corner = {face->corner[0], face->corner[1], face->corner[2], surface},
                    .weight = {face->weight[0], face->weight[1], face->weight[2], -1},
                    .normal = {n.x, n.y, n.z},
                    .wanted = face->wanted,
                    .friction = face->friction};
    for (int c = 0; c < 3; c++) {
        touch->q[push.corner[c]] = sk_load(run->vector[SK_X], op->packed, touch->slot[push.corner[c]]);
        touch->q[push.corner[c]].w = 0;
    }
    touch->q[surface] = (sk_vec4){face->at.x, face->at.y, face->at.z, 0};
    touch->p[surface] = (sk_vec4){from.x, from.y, from.z, 0};
    touch->inverse[surface] = 0;
    const sk_quad before = sk_quad_sum(touch->p, push.corner, push.weight);
    for (int c = 0; c < 3; c++) push.before[c] = before[c];
    push_apart(touch, &push);
    for (int c = 0; c < (face->weight[2] > 0 ? 3 : 2); c++) store(touch, run, op, push.corner[c]);
}

typedef struct pushing {
    sk_touch *touch;
    const sk_run *run;
    const sk_op *op;
} pushing;

enum { VERTICES_AT_ONCE = 2048, PAIRS_AT_ONCE = 512, AHEAD = 8 };

static void load_some(void *data, int thread, size_t begin, size_t end) {
    (void)thread;
    const pushing *job = data;
    for (size_t v = begin; v < end; v++) {
        job->touch->q[v] = sk_load(job->run->vector[SK_X], job->op->packed, job->touch->slot[v]);
        job->touch->q[v].w = 0;
    }
}

static void push_some(void *data, int thread, size_t begin, size_t end) {
    (void)thread;
    sk_touch *touch = ((const pushing *)data)->touch;
    const sk_push_list *pushes = &touch->pushes;
    const size_t last = pushes->start[end];
    for (size_t i = pushes->start[begin]; i < last; i++) {
        __builtin_prefetch(&pushes->pair.data[pushes->dealt.data[i + AHEAD < last ? i + AHEAD : i]]);
        push_apart(touch, &pushes->pair.data[pushes->dealt.data[i]]);
    }
}

static void store_some(void *data, int thread, size_t begin, size_t end) {
    (void)thread;
    const pushing *job = data;
    for (size_t v = begin; v < end; v++) store(job->touch, job->run, job->op, v);
}

static void push_near(sk_touch *touch, sk_run *run, const sk_op *op) {
    const sk_contact_params *params = ((const sk_force *)op->rule)->params;
    const real gain = (real)(60 * op->dt * (double)touch->thickness); // a thickness in a sixtieth of a second
    if (!sk_touch_deal(touch, run->allocator, gain, (real)params->friction)) {
        run->no_memory = true;
        return;
    }
    pushing job = {touch, run, op};
    sk_parallel_pieces(touch->tasks, 0, touch->skin.vertex_count, VERTICES_AT_ONCE, load_some, &job);
    for (size_t sort = 0; sort < SK_PUSH_CLASSES; sort += SK_SLAB_CLASSES)
        for (int r = 0; r < SK_SLAB_ROUNDS; r++) {
            const size_t begin = sort + sk_slab_round[r], end = sort + sk_slab_round[r + 1],
                         count = touch->pushes.start[end] - touch->pushes.start[begin];
            sk_parallel_pieces(touch->tasks, begin, end, count < PAIRS_AT_ONCE ? end - begin : 1, push_some, &job);
        }
    sk_parallel_pieces(touch->tasks, 0, touch->skin.vertex_count, VERTICES_AT_ONCE, store_some, &job);
}

void sk_touch_lead(sk_run *run, const sk_op *op, size_t from, size_t end) {
    (void)from, (void)end;
    sk_touch *touch = ((const sk_force *)op->rule)->state;
    if (!touch) return;
    // what is led apart gets no speed of it
    sk_tangle_lead(touch, run->vector[SK_X], op->source[1] == SK_NONE ? run->vector[SK_X0] : NULL, op->packed);
}

void sk_touch_push_on(sk_run *run, const sk_op *op, size_t from, size_t end) {
    (void)from, (void)end;
    sk_touch *touch = ((const sk_force *)op->rule)->state;
    if (touch && touch->near[SK_CORNERS].count + touch->near[SK_EDGES].count) push_near(touch, run, op);
}

void sk_touch_push(sk_run *run, const sk_op *op, size_t from, size_t end) {
    sk_touch *touch = ((const sk_force *)op->rule)->state;
    if (!touch) return;
    touch->implicit = false;
    touch->corrects = op->source[1] == SK_NONE; // velocities are made of positions afterwards
    sk_touch_push_on(run, op, from, end);
    sk_touch_lead(run, op, from, end);
}
