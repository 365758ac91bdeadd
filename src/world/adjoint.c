/* The ops of a plan in reverse; see adjoint.h.
 *
 *   forward                     reverse, with a bar over adjoints
 *   X = X + h V                 V- += h X-
 *   V = V + h w F               F- += h w V-
 *   F += f(X, V)                X- += (df/dX)^T F-,   V- += (df/dV)^T F-
 *
 * Elastic forces are minus the gradient of an energy, so that df/dX is symmetric, and its product with F- is how f changes as
 * X moves along F-: two sums of forces by the kernels that the plan has, at X + e F- and X - e F-, whatever
 * kinds they are of; half their sum is f itself, which times F- says what a stiffness does. The part in F- that moves
 * farthest goes by `span`, so small that the third derivative does not show, and so large that rounding does not.
 * Damping, -c (g . v) g with g the gradient of C, is linear in v and symmetric there; in X it is not:
 *
 *   d/dX of -c (g . v)(g . F-)  =  -c ((g . F-) H v + (g . v) H F-),   H u = how g changes along u
 *
 * and is added up element by element. Uniform forces are m g + f - (linear + rate m) v. */
#include <math.h>
#include <string.h>

#include "base/float_mode.h"
#include "constraints/sweep.h"
#include "world/adjoint.h"

/* ---- looking at the plan ---- */

static sk_reverse reverse_of(const sk_op *op) {
    return sk_op_type_of(op)->reverse;
}

static bool is_elementary(const sk_op *op) {
    sk_uniform_force sum = {.label = ""};
    if (op->inner) return false;
    switch (reverse_of(op)) {
    case SK_REVERSE_NOT: return false;
    case SK_REVERSE_ELASTIC: return op->dst == SK_F;
    case SK_REVERSE_FIELD: {
        const sk_force *force = op->rule;
        return op->dst == SK_F && !force->only.some && sk_force_add_uniform(force, &sum);
    }
    default: return true;
    }
}

static skein_status check_plan(const sk_plan *plan, skein_error *error) {
    for (size_t r = 0; r < plan->count; r++) {
        char line[200];
        if (is_elementary(&plan->data[r])) continue;
        sk_op_describe(&plan->data[r], line, sizeof line);
        return sk_fail(error, SKEIN_ERROR_VALUE, "gradient",
                       "a run with this op has no gradient yet: '%.120s'; there are those of methods that add up forces "
                       "(symplectic_euler, leapfrog, rk4 ...), of constraints, gravity, uniform wind and drag",
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

static real *new_numbers(sk_adjoint *a) {
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

skein_status sk_adjoint_begin(sk_adjoint *a, skein_world *world, skein_error *error) {
    skein_status status = check_plan(&world->plan, error);
    if (status) return status;
    *a = (sk_adjoint){.world = world, .reals = 4 * world->particles.slot_capacity, .span = find_span(&world->rules)};
    for (size_t r = 0; r < world->plan.count; r++)
        if (world->plan.data[r].packed > a->packed) a->packed = world->plan.data[r].packed;
    bool good = true, wanted[SK_VECTOR_COUNT] = {[SK_X] = true, [SK_V] = true, [SK_F] = true};
    for (size_t r = 0; r < world->plan.count; r++) {
        wanted[world->plan.data[r].dst] = true;
        for (int i = 0; i < 3; i++) wanted[world->plan.data[r].source[i]] = true;
    }
    for (int v = SK_NONE + 1; v < SK_VECTOR_COUNT; v++)
        if (wanted[v]) good &= (a->of[v] = new_numbers(a)) != NULL;
    real **const others[] = {&a->inverse_mass, &a->mass,     &a->moved,    &a->still,    &a->force[0], &a->force[1],
                             &a->plain[0],     &a->plain[1], &a->plain[2], &a->plain[3], &a->plain[4], &a->side[0],
                             &a->side[1]};
    for (size_t i = 0; i < sizeof others / sizeof *others; i++) good &= (*others[i] = new_numbers(a)) != NULL;
    a->forces = sk_allocate(&world->allocator, (world->rules.forces.count + 1) * sizeof *a->forces);
    if (!good || !a->forces) return sk_fail_memory(error, "a gradient");
    for (size_t i = 0; i < world->rules.forces.count; i++) sk_force_add_uniform(world->rules.forces.data[i], &a->forces[i]);
    find_masses(a);
    return SKEIN_OK;
}

void sk_adjoint_end(sk_adjoint *a) {
    if (!a->world) return;
    sk_allocator *allocator = &a->world->allocator;
    real *const all[] = {a->inverse_mass, a->mass,     a->moved,    a->still,    a->force[0], a->force[1],
                         a->plain[0],     a->plain[1], a->plain[2], a->plain[3], a->plain[4], a->side[0],
                         a->side[1]};
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) sk_release(allocator, all[i]);
    for (int v = 0; v < SK_VECTOR_COUNT; v++) sk_release(allocator, a->of[v]);
    for (size_t i = 0; i < a->tape.count; i++) {
        sk_release(allocator, a->tape.data[i].x);
        sk_release(allocator, a->tape.data[i].v);
    }
    sk_release(allocator, a->tape.data);
    sk_release(allocator, a->forces);
}

/* ---- forward ---- */

static bool keep(sk_adjoint *a, const sk_run *run) {
    sk_allocator *allocator = &a->world->allocator;
    if (a->used == a->tape.count) {
        if (!SK_RESERVE(allocator, &a->tape, a->used + 1)) return false;
        sk_taped *t = &a->tape.data[a->tape.count++]; // what it has, sk_adjoint_end() takes
        *t = (sk_taped){new_numbers(a), new_numbers(a)};
    }
    sk_taped *t = &a->tape.data[a->used];
    if (!t->x || !t->v) return false;
    memcpy(t->x, run->vector[SK_X], a->reals * sizeof(real));
    memcpy(t->v, run->vector[SK_V], a->reals * sizeof(real));
    a->used++;
    return true;
}

static bool looks_at_state(const sk_op *op) {
    return reverse_of(op) == SK_REVERSE_ELASTIC || reverse_of(op) == SK_REVERSE_FIELD;
}

size_t sk_adjoint_looks(const sk_plan *plan, size_t r) {
    const sk_op *op = &plan->data[r];
    size_t count = 0;
    for (size_t k = 1; op->kind == SK_OP_REPEAT && k <= op->length; k++) count += looks_at_state(&op[k]) && !looks_at_state(&op[k - 1]);
    return count * op->end;
}

bool sk_adjoint_run(sk_adjoint *a, double dt, bool tape) {
    skein_world *world = a->world;
    sk_run run = sk_world_run_context(world);
    const sk_op *ops = world->plan.data;
    uint64_t mode = sk_float_mode_enter();
    bool good = true;
    for (size_t r = 0; r < world->plan.count && good; r++) {
        bool repeats = ops[r].kind == SK_OP_REPEAT;
        const sk_op *body = repeats ? &ops[r + 1] : &ops[r];
        size_t count = repeats ? ops[r].length : 1, times = repeats ? ops[r].end : 1;
        for (size_t i = 0; i < times && good; i++) {
            run.iteration = i;
            run.last_iteration = i + 1 == times;
            run.time = world->time + dt * (double)(i + 1) / (double)times;
            for (size_t k = 0; k < count && good; k++) {
                if (tape && looks_at_state(&body[k]) && (!k || !looks_at_state(&body[k - 1]))) good = keep(a, &run);
                sk_run_ops(&run, world->tasks, &body[k], 1);
            }
        }
        r += repeats ? count : 0;
    }
    sk_float_mode_leave(mode);
    world->time += dt;
    return good;
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

/* ---- combines and uniform forces ---- */

static void reverse_combine(sk_adjoint *a, const sk_op *op) {
    sk_reverse reverse = reverse_of(op);
    if (reverse == SK_REVERSE_NOTHING || op->dst == SK_PREVIOUS) return;
    const real *bar = take(a, op->dst);
    if (reverse == SK_REVERSE_SUM) {
        for (int i = 0; i < 3 && op->source[i] != SK_NONE; i++) add(a, a->of[op->source[i]], op->coefficient[i], bar);
    } else {
        add(a, a->of[op->source[0]], 1, bar);
        real *f = a->of[op->source[1]], h = (real)op->coefficient[0];
        for (size_t i = 0; i < a->reals; i++) f[i] += h * a->inverse_mass[i] * bar[i];
    }
}

static void reverse_field(sk_adjoint *a, const sk_op *op, const sk_taped *at) {
    const sk_rules *rules = &a->world->rules;
    size_t number = 0;
    while (rules->forces.data[number] != op->rule) number++;
    sk_uniform_force u = a->forces[number];
    const real *bar = a->of[SK_F];
    real *v = a->of[SK_V], linear = (real)u.linear, rate = (real)u.rate;
    if (linear != 0 || rate != 0)
        for (size_t i = 0; i < a->reals; i++) v[i] -= (linear + rate * a->mass[i]) * bar[i];
    for (size_t e = 0; e < a->effect_count; e++) {
        if (!a->effects[e].on_forces) continue;
        const sk_uniform_force *d = &a->effects[e].force[number];
        double sum = 0;
        for (size_t p = 0; p < a->world->particles.count; p++) {
            size_t stride, place = sk_adjoint_place(a, p, &stride);
            double m = (double)a->mass[place];
            for (size_t k = 0; k < 3 && m > 0; k++, place += stride)
                sum += (double)bar[place] *
                       (m * d->acceleration[k] + d->force[k] - (d->linear + d->rate * m) * (double)at->v[place]);
        }
        a->by_effect[e] += sum;
    }
    if (op->sets) memset(a->of[SK_F], 0, a->reals * sizeof(real));
}

/* ---- constraints ---- */

static const sk_batch *batch_of(const sk_op *op) {
    return ((const sk_sweep *)op->rule)->batch;
}

static double largest(const sk_adjoint *a, const real *x) {
    real most = 0;
    for (size_t i = 0; i < a->reals; i++) {
        real size = x[i] < 0 ? -x[i] : x[i];
        most = size > most ? size : most;
    }
    return (double)most;
}

/* X + e F- and X - e F-, once for all constraints that look at a state. False where F- is 0. */
static bool make_sides(sk_adjoint *a, const sk_taped *at) {
    const real *bar = a->of[SK_F];
    if (a->step > 0) return true;
    double most = largest(a, bar);
    if (!(most > 0)) return false;
    a->step = a->span / most;
    real e = (real)a->step;
    for (size_t i = 0; i < a->reals; i++) {
        a->side[0][i] = at->x[i] + e * bar[i];
        a->side[1][i] = at->x[i] - e * bar[i];
    }
    return true;
}

/* The elastic forces of some ops on one side, without velocities. */
static void sum_forces(sk_adjoint *a, const sk_op *ops, size_t count, int side, double time) {
    sk_run run = sk_world_run_context(a->world);
    memset(a->force[side], 0, a->reals * sizeof(real));
    run.time = time;
    run.vector[SK_X] = (sk_vec4 *)(void *)a->side[side];
    run.vector[SK_V] = (sk_vec4 *)(void *)a->still;
    run.vector[SK_F] = (sk_vec4 *)(void *)a->force[side];
    sk_run_ops(&run, a->world->tasks, ops, count);
}

/* X- gets half their difference over the step; returns half their sum times F-. */
static double take_sides(sk_adjoint *a) {
    const real *bar = a->of[SK_F], *ahead = a->force[0], *behind = a->force[1], half = (real)(0.5 / a->step);
    real *x = a->of[SK_X], sum = 0;
    for (size_t i = 0; i < a->reals; i++) {
        x[i] += half * (ahead[i] - behind[i]);
        sum += bar[i] * (ahead[i] + behind[i]);
    }
    return 0.5 * (double)sum;
}

/* X + e `along` as it is outside of a step, which evaluating a constraint takes. */
static void plain(sk_adjoint *a, int which, const real *x, double e, const real *along) {
    sk_vec4 *to = (sk_vec4 *)(void *)a->plain[which];
    for (size_t p = 0; p < a->world->particles.count; p++) {
        size_t stride, at = sk_adjoint_place(a, p, &stride);
        real moved[3];
        for (size_t k = 0; k < 3; k++, at += stride) moved[k] = x[at] + (along ? (real)e * along[at] : 0);
        to[a->world->particles.slot_of[p]] = (sk_vec4){moved[0], moved[1], moved[2], 0};
    }
}

/* What an element's particles have of a vector. */
typedef double triples[SK_MOST_ARITY][3];

static void load(const sk_adjoint *a, const sk_batch *batch, size_t element, const real *x, triples out) {
    for (size_t i = 0; i < sk_batch_particle_count(batch); i++) {
        size_t stride, at = sk_adjoint_place(a, sk_batch_particle(batch, element, i), &stride);
        for (size_t k = 0; k < 3; k++, at += stride) out[i][k] = (double)x[at];
    }
}

static double along(size_t count, triples g, triples u) {
    double sum = 0;
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) sum += g[i][k] * u[i][k];
    return sum;
}

/* How the gradient changes from one place to another. False without memory. */
static bool change(const sk_batch *batch, double time, size_t element, const sk_vec4 *from, const sk_vec4 *to,
                   double times, triples out) {
    sk_constraint_answer answer;
    triples one;
    size_t count = sk_batch_particle_count(batch);
    if (!batch->type->evaluate(batch, time, from, element, count, &answer, one) ||
        !batch->type->evaluate(batch, time, to, element, count, &answer, out))
        return false;
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) out[i][k] = times * (out[i][k] - one[i][k]);
    return true;
}

/* The damping of one element: what X- and V- get of it. */
static bool reverse_damped(sk_adjoint *a, const sk_batch *batch, double time, size_t element,
                           const double e[2], double c, triples g, triples v, triples bar) {
    const sk_vec4 *x[5];
    triples along_bar = {{0}}, along_v = {{0}};
    size_t count = sk_batch_particle_count(batch);
    for (int i = 0; i < 5; i++) x[i] = (const sk_vec4 *)(const void *)a->plain[i];
    if (!change(batch, time, element, x[2], x[1], 0.5 / e[0], along_bar)) return false;
    if (e[1] > 0 && !change(batch, time, element, x[4], x[3], 0.5 / e[1], along_v)) return false;
    double gv = along(count, g, v), gbar = along(count, g, bar);
    for (size_t i = 0; i < count; i++) {
        size_t stride, place = sk_adjoint_place(a, sk_batch_particle(batch, element, i), &stride);
        for (size_t k = 0; k < 3; k++, place += stride) {
            a->of[SK_X][place] -= (real)(c * (gbar * along_v[i][k] + gv * along_bar[i][k]));
            a->of[SK_V][place] -= (real)(c * gbar * g[i][k]);
        }
    }
    return true;
}

/* Goes through a batch's elements where there is damping, or a field changes it; `by_damping` is the derivative by that. */
static skein_status reverse_elements(sk_adjoint *a, const sk_batch *batch, const sk_taped *at, double time,
                                     double *by_damping, skein_error *error) {
    const sk_material *material = batch->params;
    double fastest = largest(a, at->v), e[2] = {a->step, fastest > 0 ? a->span / fastest : 0};
    const real *bar = a->of[SK_F];
    plain(a, 0, at->x, 0, NULL);
    plain(a, 1, at->x, e[0], bar), plain(a, 2, at->x, -e[0], bar);
    plain(a, 3, at->x, e[1], at->v), plain(a, 4, at->x, -e[1], at->v);
    size_t count = sk_batch_particle_count(batch);
    if (batch->type->enclose || count > SK_MOST_ARITY)
        return sk_fail(error, SKEIN_ERROR_VALUE, batch->label, "its damping has no gradient yet: it encloses a volume");
    for (size_t element = 0; element < batch->count; element++) {
        sk_constraint_answer answer;
        triples g, v, f;
        if (!batch->type->evaluate(batch, time, (const sk_vec4 *)(const void *)a->plain[0], element, count, &answer, g))
            return sk_fail_memory(error, "a gradient");
        if (answer.is_energy || answer.by_time != 0)
            return sk_fail(error, SKEIN_ERROR_VALUE, batch->label,
                           "damping of an energy, or of a constraint that depends on time, has no gradient yet");
        if (answer.one_sided && answer.value >= 0) continue;
        load(a, batch, element, at->v, v), load(a, batch, element, bar, f);
        double scale = batch->scale ? (double)batch->scale[element] : 1;
        *by_damping -= scale * along(count, g, v) * along(count, g, f);
        if (material->damping > 0 && !reverse_damped(a, batch, time, element, e, material->damping * scale, g, v, f))
            return sk_fail_memory(error, "a gradient");
    }
    return SKEIN_OK;
}

/* Ops of one batch. */
static skein_status reverse_forces(sk_adjoint *a, const sk_op *ops, size_t count, const sk_taped *at, double time,
                                   skein_error *error) {
    const sk_batch *batch = batch_of(ops);
    const sk_material *material = batch->params;
    if (!make_sides(a, at)) return SKEIN_OK;
    for (int side = 0; side < 2; side++) sum_forces(a, ops, count, side, time);
    double by_stiffness = take_sides(a) / material->stiffness, by_damping = 0;
    size_t number = 0;
    const sk_rules *rules = &a->world->rules;
    while (rules->batches.data[number] != batch) number++;
    bool elements = material->damping > 0;
    for (size_t i = 0; i < a->effect_count; i++) elements |= a->effects[i].damping[number] != 0;
    skein_status status =
        elements ? reverse_elements(a, batch, at, time - ops->before_end, &by_damping, error) : SKEIN_OK;
    for (size_t i = 0; i < a->effect_count; i++)
        a->by_effect[i] += by_stiffness * a->effects[i].stiffness[number] + by_damping * a->effects[i].damping[number];
    return status;
}

/* ---- the plan ---- */

/* Ops that look at one state, from the last one on; returns how many. */
static size_t reverse_group(sk_adjoint *a, const sk_op *body, size_t last, double time, skein_status *status,
                            skein_error *error) {
    size_t first = last;
    while (first && looks_at_state(&body[first - 1])) first--;
    const sk_taped *at = &a->tape.data[--a->used];
    a->step = 0;
    for (size_t k = last + 1; k-- > first && !*status;) {
        if (reverse_of(&body[k]) == SK_REVERSE_FIELD) {
            reverse_field(a, &body[k], at);
            continue;
        }
        size_t from = k;
        while (from > first && reverse_of(&body[from - 1]) == SK_REVERSE_ELASTIC &&
               batch_of(&body[from - 1]) == batch_of(&body[k]))
            from--;
        *status = reverse_forces(a, &body[from], k - from + 1, at, time, error);
        k = from;
    }
    return last - first + 1;
}

static skein_status reverse_body(sk_adjoint *a, const sk_op *body, size_t count, double time, skein_error *error) {
    skein_status status = SKEIN_OK;
    for (size_t k = count; k > 0 && !status;) {
        const sk_op *op = &body[k - 1];
        size_t done = 1;
        if (looks_at_state(op)) done = reverse_group(a, body, k - 1, time, &status, error);
        else reverse_combine(a, op);
        k -= done;
    }
    return status;
}

skein_status sk_adjoint_reverse(sk_adjoint *a, double start, double dt, skein_error *error) {
    const sk_plan *plan = &a->world->plan;
    skein_status status = SKEIN_OK;
    uint64_t mode = sk_float_mode_enter();
    for (size_t end = plan->count; end > 0 && !status;) {
        // the top-level op that ends there
        size_t r = 0;
        while (r + plan->data[r].length + 1 < end) r += plan->data[r].length + 1;
        const sk_op *op = &plan->data[r];
        if (op->kind != SK_OP_REPEAT) status = reverse_body(a, op, 1, start + dt, error);
        for (size_t i = op->kind == SK_OP_REPEAT ? op->end : 0; i > 0 && !status; i--)
            status = reverse_body(a, op + 1, op->length, start + dt * (double)i / (double)op->end, error);
        end = r;
    }
    sk_float_mode_leave(mode);
    return status;
}
