/* The ops of a plan in reverse; see adjoint.h.
 *
 *   forward                     reverse, with a bar over adjoints
 *   X = X + h V                 V- += h X-
 *   V = V + h w F               F- += h w V-
 *   F += f(X, V)                X- += (df/dX)^T F-,   V- += (df/dV)^T F-
 *   V += h (g + w f - d V)      V- -= h d V-, where free
 *   V += a (X - (X0 + b V))     X- += a V-,   X0- -= a V-,   V- *= 1 - a b
 *
 * Forces are in adjoint_force.c, an implicit solve in adjoint_solve.c, projections in adjoint_project.c. */
#include <math.h>
#include <string.h>

#include "base/float_mode.h"
#include "constraints/sweep.h"
#include "plan/newton.h"
#include "world/adjoint.h"

/* ---- looking at the plan ---- */

static sk_reverse reverse_of(const sk_op *op) {
    return sk_op_type_of(op)->reverse;
}

/* Whether an op is V += h (a uniform force), or V += a (X - (X0 + b V)). */
static bool pulls(const sk_op *op) {
    return reverse_of(op) == SK_REVERSE_SUM && sk_op_type_of(op)->rule == SK_RULE_UNIFORM;
}
static bool corrects(const sk_op *op) {
    return reverse_of(op) == SK_REVERSE_SUM && sk_op_type_of(op)->reads & SK_USES_DST;
}

static bool is_elementary(const sk_op *op) {
    sk_uniform_force sum = {.label = ""};
    if (op->inner && !pulls(op)) return false;
    if (sk_adjoint_projects(op)) return !((const sk_sweep *)op->rule)->batch->type->enclose;
    switch (reverse_of(op)) {
    case SK_REVERSE_NOT: return false;
    case SK_REVERSE_SOLVE: return op->kernel == sk_newton_solve;
    case SK_REVERSE_BY_SOLVE: return sk_adjoint_opens(op); // of the others in a solve nobody asks
    case SK_REVERSE_ELASTIC: return op->dst == SK_F;
    case SK_REVERSE_FIELD: {
        const sk_force *force = op->rule;
        return op->dst == SK_F && !force->only.some && sk_force_add_uniform(force, &sum);
    }
    default: return true;
    }
}

static skein_status check_plan(const sk_plan *plan, skein_error *error) {
    size_t solve_end = 0;
    for (size_t r = 0; r < plan->count; r++) {
        char line[200];
        const sk_op *op = &plan->data[r];
        if (reverse_of(op) == SK_REVERSE_SOLVE) solve_end = r + op->length + 1;
        if (is_elementary(op) || (r < solve_end && reverse_of(op) == SK_REVERSE_BY_SOLVE)) continue;
        sk_op_describe(&plan->data[r], line, sizeof line);
        return sk_fail(
            error, SKEIN_ERROR_VALUE, "gradient",
            "a run with this op has no gradient yet: '%.120s'; there are those of methods that add up forces "
            "(symplectic_euler, leapfrog, rk4 ...), of backward_euler, xpbd and pbd, of constraints, gravity, "
            "uniform wind and drag",
            line);
    }
    return SKEIN_OK;
}

/* Where the numbers of a particle lie while the plan runs. */
size_t sk_adjoint_place(const sk_adjoint *a, size_t particle, size_t *stride) {
    size_t slot = a->world->particles.slot_of[particle];
    *stride = slot < a->packed ? SK_LANES : 1;
    return slot < a->packed ? slot / SK_LANES * SK_LANES * 4 + slot % SK_LANES : 4 * slot;
}

real *sk_adjoint_new_numbers(sk_adjoint *a) {
    return sk_allocate(&a->world->allocator, a->reals * sizeof(real));
}

static void find_masses(sk_adjoint *a) {
    const sk_particles *all = &a->world->particles;
    for (size_t p = 0; p < all->count; p++) {
        size_t stride, at = sk_adjoint_place(a, p, &stride);
        const sk_vec4 *x = &all->vector[SK_X][all->slot_of[p]], *v = &all->vector[SK_V][all->slot_of[p]];
        for (size_t k = 0; k < 3 && x->w > 0; k++) {
            a->inverse_mass[at + k * stride] = x->w;
            a->mass[at + k * stride] = v->w;
        }
    }
}

/* A hundred-thousandth of the mean edge, or of a metre where nothing has a length. */
static double find_span(const sk_rules *rules) {
    double sum = 0, count = 0;
    for (size_t i = 0; i < rules->batches.count; i++) {
        const sk_batch *batch = rules->batches.data[i];
        for (size_t e = 0; batch->measured && e < batch->count; e++) sum += (double)batch->rest[e], count++;
    }
    return 1e-5 * (sum > 0 ? sum / count : 1);
}

/* Whether anything that is looked at in reverse depends on velocities. */
static bool keeps_velocities(const sk_adjoint *a) {
    const sk_rules *rules = &a->world->rules;
    bool keeps = a->krylov.op || a->projections;
    for (size_t i = 0; i < rules->batches.count; i++) {
        keeps |= ((const sk_material *)rules->batches.data[i]->params)->damping > 0;
        for (size_t e = 0; e < a->effect_count; e++) keeps |= a->effects[e].damping[i] != 0;
    }
    for (size_t e = 0; e < a->effect_count; e++) keeps |= a->effects[e].on_forces;
    return keeps;
}

skein_status sk_adjoint_begin(sk_adjoint *a, skein_world *world, skein_error *error) {
    skein_status status = check_plan(&world->plan, error);
    if (status) return status;
    *a = (sk_adjoint){.world = world,
                      .reals = 4 * world->particles.slot_capacity,
                      .span = find_span(&world->rules),
                      .effects = a->effects,
                      .effect_count = a->effect_count,
                      .by_effect = a->by_effect};
    for (size_t r = 0; r < world->plan.count; r++)
        if (world->plan.data[r].packed > a->packed) a->packed = world->plan.data[r].packed;
    bool good = true, wanted[SK_VECTOR_COUNT] = {[SK_X] = true, [SK_V] = true, [SK_F] = true};
    for (size_t r = 0; r < world->plan.count; r++) {
        const sk_op *op = &world->plan.data[r];
        sk_reverse reverse = reverse_of(op);
        if (reverse == SK_REVERSE_SOLVE) good &= sk_adjoint_begin_solve(a, op), r += op->length;
        if (reverse == SK_REVERSE_SOLVE || reverse == SK_REVERSE_BY_SOLVE) continue; // no vector of theirs outlives it
        wanted[op->dst] = true;
        for (int i = 0; i < 3; i++) wanted[op->source[i]] = true;
    }
    for (int v = SK_NONE + 1; v < SK_VECTOR_COUNT; v++)
        if (wanted[v]) good &= (a->of[v] = sk_adjoint_new_numbers(a)) != NULL;
    real **const others[] = {&a->inverse_mass, &a->mass,     &a->moved,    &a->still,    &a->force[0],
                             &a->force[1],     &a->plain[0], &a->plain[1], &a->plain[2], &a->plain[3],
                             &a->plain[4],     &a->side[0],  &a->side[1],  &a->unit,     &a->linear};
    for (size_t i = 0; i < sizeof others / sizeof *others; i++)
        good &= (*others[i] = sk_adjoint_new_numbers(a)) != NULL;
    a->forces = sk_allocate(&world->allocator, (world->rules.forces.count + 1) * sizeof *a->forces);
    good &= sk_adjoint_begin_projections(a);
    if (!good || !a->forces) return sk_fail_memory(error, "a gradient");
    for (size_t i = 0; i < world->rules.forces.count; i++)
        sk_force_add_uniform(world->rules.forces.data[i], &a->forces[i]);
    find_masses(a);
    a->keeps_v = keeps_velocities(a);
    for (size_t e = 0; e < a->effect_count; e++) a->pulled |= a->effects[e].on_forces;
    return SKEIN_OK;
}

void sk_adjoint_end(sk_adjoint *a) {
    if (!a->world) return;
    sk_allocator *allocator = &a->world->allocator;
    real *const all[] = {a->inverse_mass, a->mass,     a->moved,    a->still,    a->force[0],
                         a->force[1],     a->plain[0], a->plain[1], a->plain[2], a->plain[3],
                         a->plain[4],     a->side[0],  a->side[1],  a->unit,     a->linear};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) sk_release(allocator, all[i]);
    sk_adjoint_end_solve(a);
    sk_adjoint_end_projections(a);
    for (int v = 0; v < SK_VECTOR_COUNT; v++) sk_release(allocator, a->of[v]);
    for (size_t i = 0; i < a->tape.count; i++) {
        sk_release(allocator, a->tape.data[i].x);
        sk_release(allocator, a->tape.data[i].v);
    }
    sk_release(allocator, a->tape.data);
    sk_release(allocator, a->forces);
}

/* ---- forward ---- */

static bool keep(sk_adjoint *a, const sk_run *run, sk_vector second) {
    sk_allocator *allocator = &a->world->allocator;
    if (a->used == a->tape.count) {
        if (!SK_RESERVE(allocator, &a->tape, a->used + 1)) return false;
        sk_taped *t = &a->tape.data[a->tape.count++]; // what it has, sk_adjoint_end() takes
        *t = (sk_taped){sk_adjoint_new_numbers(a), a->keeps_v ? sk_adjoint_new_numbers(a) : NULL};
    }
    sk_taped *t = &a->tape.data[a->used];
    if (!t->x || (a->keeps_v && !t->v)) return false;
    memcpy(t->x, run->vector[SK_X], a->reals * sizeof(real));
    if (a->keeps_v) memcpy(t->v, run->vector[second], a->reals * sizeof(real));
    a->used++;
    return true;
}

/* Whether op k of a substep is the first of those that take one state from the tape. */
static bool begins_group(const sk_op *body, size_t k, bool (*is)(const sk_op *op)) {
    return is(&body[k]) && (!k || !is(&body[k - 1]));
}

size_t sk_adjoint_looks(const sk_plan *plan, size_t r) {
    const sk_op *op = &plan->data[r];
    size_t count = 0;
    for (size_t k = 1; op->kind == SK_OP_REPEAT && k <= op->length; k++)
        if (reverse_of(&op[k]) == SK_REVERSE_SOLVE) return op->end;
    for (size_t k = 0; op->kind == SK_OP_REPEAT && k < op->length; k++)
        count += (size_t)begins_group(op + 1, k, sk_adjoint_looks_at_state) +
                 (size_t)begins_group(op + 1, k, sk_adjoint_projects) + (size_t)pulls(&op[1 + k]);
    return count * op->end;
}

/* Op k of a substep, and with it those that it leads. In front of a solve, whose forces are its own, none are wanted. */
static bool run_op(sk_adjoint *a, sk_run *run, const sk_op *body, size_t *k, bool tape) {
    const sk_op *op = &body[*k];
    bool solves = reverse_of(op) == SK_REVERSE_SOLVE, looks = sk_adjoint_looks_at_state(op), good = true;
    if (looks && a->krylov.op) return true;
    if (tape && begins_group(body, *k, sk_adjoint_looks_at_state)) good = keep(a, run, SK_V);
    if (tape && begins_group(body, *k, sk_adjoint_projects)) good = keep(a, run, SK_X0);
    if (tape && pulls(op) && a->pulled) good = keep(a, run, SK_V);
    sk_run_ops(run, a->world->tasks, op, solves ? 1 + op->length : 1);
    if (!solves) return good;
    *k += op->length;
    return !tape || keep(a, run, SK_V);
}

skein_status sk_adjoint_run(sk_adjoint *a, double dt, bool tape, skein_error *error) {
    skein_world *world = a->world;
    skein_status status = sk_world_set_out(world, dt, error);
    if (status) return status;
    sk_run run = sk_world_run_context(world);
    const sk_op *ops = world->plan.data;
    uint64_t mode = sk_float_mode_enter();
    bool good = true;
    if (!tape) { // as in any step
        sk_run_ops(&run, world->tasks, ops, world->plan.count);
        good = !run.no_memory;
    }
    for (size_t r = 0; r < world->plan.count && good && tape; r++) {
        bool repeats = ops[r].kind == SK_OP_REPEAT;
        const sk_op *body = repeats ? &ops[r + 1] : &ops[r];
        size_t count = repeats ? ops[r].length : 1, times = repeats ? ops[r].end : 1;
        for (size_t i = 0; i < times && good; i++) {
            run.iteration = i;
            run.last_iteration = i + 1 == times;
            run.time = world->time + dt * (double)(i + 1) / (double)times;
            for (size_t k = 0; k < count && good; k++) good = run_op(a, &run, body, &k, tape);
        }
        r += repeats ? count : 0;
    }
    sk_float_mode_leave(mode);
    status = sk_world_arrive(world, good);
    world->time += dt;
    return good ? status : sk_fail_memory(error, "a gradient's states");
}

/* ---- sums over all numbers ---- */

static void add(const sk_adjoint *a, real *to, double factor, const real *p) {
    for (size_t i = 0; i < a->reals; i++) to[i] += (real)factor * p[i];
}

/* The adjoint of what an op has written, which is handed on: it is 0 from then on. */
static const real *take(sk_adjoint *a, sk_vector dst) {
    memcpy(a->moved, a->of[dst], a->reals * sizeof(real));
    memset(a->of[dst], 0, a->reals * sizeof(real));
    return a->moved;
}

/* ---- combines ---- */

/* X- and X0- of V += a (X - (X0 + b V)). */
static void reverse_correction(sk_adjoint *a, const sk_op *op) {
    double by = op->coefficient[0], back = op->coefficient[1];
    real *v = a->of[op->dst];
    add(a, a->of[op->source[0]], by, v);
    add(a, a->of[op->source[1]], -by, v);
    for (size_t i = 0; i < a->reals; i++) v[i] *= (real)(1 - by * back);
}

/* What of the effects of V += h (g + w f - (rate + w linear) V) a particle has, of whom V- starts at `bar`. */
static double pulled_by(const sk_uniform_force *d, double w, const real *bar, const real *v, size_t stride) {
    double sum = 0;
    for (size_t k = 0; k < 3; k++)
        sum += (double)bar[k * stride] *
               (d->acceleration[k] + w * d->force[k] - (d->rate + w * d->linear) * (double)v[k * stride]);
    return sum;
}

static void reverse_pull(sk_adjoint *a, const sk_op *op) {
    const sk_uniform_force *u = op->rule;
    const sk_particles *all = &a->world->particles;
    const sk_rules *rules = &a->world->rules;
    const real *before = a->pulled ? a->tape.data[--a->used].v : NULL;
    real *v = a->of[SK_V];
    for (size_t p = 0; p < all->count; p++) {
        size_t stride, at = sk_adjoint_place(a, p, &stride), slot = all->slot_of[p];
        double w = (double)a->inverse_mass[at];
        if (!(w > 0) || (op->inner && (slot < op->first_slot || slot >= op->end_slot))) continue;
        for (size_t e = 0; e < a->effect_count && before; e++)
            for (size_t i = 0; i < rules->forces.count && a->effects[e].on_forces; i++)
                if (sk_only_has_slot(&rules->forces.data[i]->only, slot))
                    a->by_effect[e] += op->dt * pulled_by(&a->effects[e].force[i], w, v + at, before + at, stride);
        for (size_t k = 0; k < 3; k++) v[at + k * stride] *= (real)(1 - op->dt * (u->rate + w * u->linear));
    }
}

static void reverse_combine(sk_adjoint *a, const sk_op *op) {
    sk_reverse reverse = reverse_of(op);
    if (corrects(op)) reverse_correction(a, op);
    if (pulls(op)) reverse_pull(a, op);
    if (corrects(op) || pulls(op)) return;
    if (reverse == SK_REVERSE_NOTHING || reverse == SK_REVERSE_BY_SOLVE || op->dst == SK_PREVIOUS) return;
    real *dst = a->of[op->dst];
    const real *bar = dst;
    bool stays = op->source[0] == op->dst; // it is changed, not written anew
    if (!stays) bar = take(a, op->dst);
    if (reverse == SK_REVERSE_SUM) {
        for (int i = stays; i < 3 && op->source[i] != SK_NONE; i++)
            add(a, a->of[op->source[i]], op->coefficient[i], bar);
        if (stays && op->coefficient[0] != 1) add(a, dst, op->coefficient[0] - 1, dst);
    } else {
        if (!stays) add(a, a->of[op->source[0]], 1, bar);
        real *f = a->of[op->source[1]], h = (real)op->coefficient[0];
        for (size_t i = 0; i < a->reals; i++) f[i] += h * a->inverse_mass[i] * bar[i];
    }
}

/* ---- the plan ---- */

/* The ops that look at the same state as the last one, which the tape has last; `count` receives how many. */
static skein_status reverse_group(sk_adjoint *a, const sk_op *body, size_t last, double time, size_t *count,
                                  skein_error *error) {
    size_t first = last;
    while (first && sk_adjoint_looks_at_state(&body[first - 1])) first--;
    *count = last - first + 1;
    if (a->krylov.op) return SKEIN_OK; // they did not run
    return sk_adjoint_reverse_looks(a, &body[first], *count, &a->tape.data[--a->used], time, error);
}

/* Where the op that ends before `end` begins: a solve leads those behind it. */
static size_t start_of(const sk_adjoint *a, const sk_op *body, size_t end) {
    const sk_op *solve = a->krylov.op;
    return solve && solve >= body && solve + solve->length == &body[end - 1] ? (size_t)(solve - body) : end - 1;
}

/* The projections of a substep, likewise. */
static skein_status reverse_projections(sk_adjoint *a, const sk_op *body, size_t last, size_t iteration, double time,
                                        size_t *count, skein_error *error) {
    size_t first = last;
    while (first && sk_adjoint_projects(&body[first - 1])) first--;
    *count = last - first + 1;
    return sk_adjoint_reverse_projections(a, &body[first], *count, iteration, &a->tape.data[--a->used], time, error);
}

static skein_status reverse_body(sk_adjoint *a, const sk_op *body, size_t count, size_t iteration, double time,
                                 skein_error *error) {
    skein_status status = SKEIN_OK;
    for (size_t end = count; end > 0 && !status;) {
        size_t k = start_of(a, body, end), done = end - k;
        const sk_op *op = &body[k];
        if (reverse_of(op) == SK_REVERSE_SOLVE)
            status = sk_adjoint_reverse_solve(a, &a->tape.data[--a->used], time, error);
        else if (sk_adjoint_looks_at_state(op)) status = reverse_group(a, body, k, time, &done, error);
        else if (sk_adjoint_projects(op)) status = reverse_projections(a, body, k, iteration, time, &done, error);
        else reverse_combine(a, op);
        end -= done;
    }
    return status;
}

/* A pin that is led has its place and rests when a step is over, whatever was before. Its velocity on the way led there from
 * where it was: V = (place - X)/dt. */
static void reverse_pins(sk_adjoint *a, double dt, bool arrived) {
    const skein_world *world = a->world;
    for (size_t i = 0; i < world->led.count; i++) {
        size_t p = world->led.data[i].particle, stride;
        if (!world->particles.pinned[p] || !sk_particle_is_here(&world->particles, p)) continue;
        size_t at = sk_adjoint_place(a, p, &stride);
        for (size_t k = 0; k < 3; k++, at += stride) {
            if (arrived) a->of[SK_X][at] = 0;
            else a->of[SK_X][at] -= a->of[SK_V][at] / (real)dt;
            a->of[SK_V][at] = 0;
        }
    }
}

skein_status sk_adjoint_reverse(sk_adjoint *a, double start, double dt, skein_error *error) {
    const sk_plan *plan = &a->world->plan;
    skein_status status = SKEIN_OK;
    if (!sk_world_lead(a->world, start + dt)) return sk_fail_memory(error, "places for pins");
    reverse_pins(a, dt, true);
    uint64_t mode = sk_float_mode_enter();
    for (size_t end = plan->count; end > 0 && !status;) {
        // the top-level op that ends there
        size_t r = 0;
        while (r + plan->data[r].length + 1 < end) r += plan->data[r].length + 1;
        const sk_op *op = &plan->data[r];
        if (op->kind != SK_OP_REPEAT) status = reverse_body(a, op, 1, 0, start + dt, error);
        for (size_t i = op->kind == SK_OP_REPEAT ? op->end : 0; i > 0 && !status; i--)
            status = reverse_body(a, op + 1, op->length, i - 1, start + dt * (double)i / (double)op->end, error);
        end = r;
    }
    sk_float_mode_leave(mode);
    reverse_pins(a, dt, false);
    a->world->led.count = 0;
    return status;
}
