/* skein_gradient(): the run forward, its states kept or computed once more from checkpoints, and backward through it.
 *
 *   steps        0 . . . . . . . . . . . . n        all states on the tape, where memory allows; else
 *   checkpoints  o     o     o     o                every so many steps a state, a square root of them in all, and
 *                            [ tape)                the tape of one segment at a time, from the last to the first
 *
 * What a field changes is found by setting it a little more and less, and looking: stiffness and damping of batches,
 * and uniform forces. The rest has to stay as it is, or the field is refused. */
#include <skein/gradient.h>

#include <math.h>
#include <string.h>

#include "base/hash.h"
#include "world/adjoint.h"
#include "world/cut.h"

/* ---- what fields change ---- */

/* All that a field may change but stiffness, damping and uniform forces. */
static uint64_t rest_of(const skein_world *world) {
    uint64_t hash = SK_HASH_START;
    for (size_t p = 0; p < world->particles.count; p++) {
        uint64_t bits = 0;
        memcpy(&bits, &world->particles.mass[p], sizeof world->particles.mass[p]);
        hash = sk_hash_word(hash, bits + world->particles.pinned[p]);
    }
    for (size_t i = 0; i < world->rules.batches.count; i++) {
        const sk_batch *batch = world->rules.batches.data[i];
        hash = sk_hash_word(hash, batch->count + (batch->enabled && *batch->enabled ? 0x10000000000u : 0));
        for (size_t e = 0; e < batch->count * batch->rest_count; e++) {
            uint64_t bits = 0;
            memcpy(&bits, &batch->rest[e], sizeof batch->rest[e]);
            hash = sk_hash_word(hash, bits);
        }
        for (size_t e = 0; batch->scale && e < batch->count; e++) {
            uint64_t bits = 0;
            memcpy(&bits, &batch->scale[e], sizeof batch->scale[e]);
            hash = sk_hash_word(hash, bits);
        }
    }
    hash = sk_hash_word(hash, (uint64_t)world->method->substeps(world->method_params));
    return sk_hash_word(hash, world->rules.forces.count);
}

/* Adds `factor` times what batches and forces are now. False where a force is not uniform. */
static bool add_present(const skein_world *world, sk_effect *effect, double factor) {
    for (size_t i = 0; i < world->rules.batches.count; i++) {
        const sk_material *material = world->rules.batches.data[i]->params;
        if (!isfinite(material->stiffness)) continue;
        effect->stiffness[i] += factor * material->stiffness;
        effect->damping[i] += factor * material->damping;
    }
    for (size_t i = 0; i < world->rules.forces.count; i++) {
        sk_uniform_force u = {.label = ""}, *sum = &effect->force[i];
        if (!*world->rules.forces.data[i]->enabled) continue;
        if (!sk_force_add_uniform(world->rules.forces.data[i], &u)) return false;
        for (int k = 0; k < 3; k++) {
            sum->acceleration[k] += factor * u.acceleration[k];
            sum->force[k] += factor * u.force[k];
        }
        sum->linear += factor * u.linear;
        sum->rate += factor * u.rate;
    }
    return true;
}

static bool is_nothing(const skein_world *world, sk_effect *effect) {
    bool nothing = true;
    for (size_t i = 0; i < world->rules.forces.count; i++) {
        const sk_uniform_force *f = &effect->force[i];
        for (int k = 0; k < 3; k++) nothing &= f->acceleration[k] == 0 && f->force[k] == 0;
        nothing &= f->linear == 0 && f->rate == 0;
    }
    effect->on_forces = !nothing;
    for (size_t i = 0; i < world->rules.batches.count; i++)
        nothing &= effect->stiffness[i] == 0 && effect->damping[i] == 0;
    return nothing;
}

/* Whether batches that a field changes pull: those that do not are not in the plan. */
static bool pulls(const skein_world *world, const sk_effect *effect) {
    bool all = true;
    for (size_t i = 0; i < world->rules.batches.count; i++)
        if (effect->stiffness[i] != 0 || effect->damping[i] != 0) all &= sk_batch_pulls(world->rules.batches.data[i]);
    return all;
}

/* Sets number k of a field, and brings what hangs on it up to date. */
static skein_status set_number(skein_world *world, const char *path, skein_value value, int k, double x) {
    value.number[k] = x;
    skein_status status = skein_set_path(world, path, value);
    return status ? status : sk_world_arrange(world, sk_world_error(world));
}

/* What one number of a field changes. */
static skein_status find_effect(skein_world *world, const char *path, skein_value value, int k, sk_effect *effect) {
    skein_error *error = sk_world_error(world);
    sk_allocator *allocator = &world->allocator;
    effect->stiffness = sk_allocate(allocator, (world->rules.batches.count + 1) * sizeof(double));
    effect->damping = sk_allocate(allocator, (world->rules.batches.count + 1) * sizeof(double));
    effect->force = sk_allocate(allocator, (world->rules.forces.count + 1) * sizeof *effect->force);
    if (!effect->stiffness || !effect->damping || !effect->force) return sk_fail_memory(error, "a gradient");
    double x = value.number[k], step = x != 0 ? 1e-4 * fabs(x) : 1e-4, ends[2] = {x + step, x - step};
    if (!isfinite(x)) return sk_fail(error, SKEIN_ERROR_VALUE, path, "it is infinite: there is no derivative by it");
    uint64_t rest = rest_of(world);
    bool same = true, uniform = true;
    for (int end = 0; end < 2; end++) {
        skein_status status = set_number(world, path, value, k, ends[end]);
        if (status && end) status = set_number(world, path, value, k, ends[1] = x); // at its least already
        if (status) return status;                                                  // and nothing was set
        same &= rest_of(world) == rest;
        uniform &= add_present(world, effect, (end ? -1 : 1));
    }
    skein_status status = set_number(world, path, value, k, x);
    if (status) return status;
    double width = ends[0] - ends[1];
    for (size_t i = 0; i < world->rules.batches.count; i++) effect->stiffness[i] /= width, effect->damping[i] /= width;
    for (size_t i = 0; i < world->rules.forces.count; i++) {
        sk_uniform_force *f = &effect->force[i];
        for (int axis = 0; axis < 3; axis++) f->acceleration[axis] /= width, f->force[axis] /= width;
        f->linear /= width, f->rate /= width;
    }
    bool nothing = is_nothing(world, effect);
    if (same && uniform && pulls(world, effect) && !nothing) return SKEIN_OK;
    return sk_fail(
        error, SKEIN_ERROR_VALUE, path,
        !uniform   ? "a force that is not uniform has no gradient yet"
        : !same    ? "it changes masses, rest lengths or who takes part: there is no gradient by such a field yet"
        : !nothing ? "what it changes has a stiffness of 0 and takes no part: begin with a small one"
                   : "nothing that a gradient follows hangs on it: stiffness, damping, gravity, wind and drag are");
}

static size_t count_numbers(skein_world *world, const char *const *fields, skein_status *status) {
    size_t count = 0;
    for (; fields && *fields && !*status; fields++) {
        skein_value value;
        *status = skein_get_path(world, *fields, &value);
        if (!*status && value.text)
            *status = sk_fail(sk_world_error(world), SKEIN_ERROR_VALUE, *fields, "it is no number");
        if (!*status) count += (size_t)value.count;
    }
    return count;
}

static skein_status find_effects(sk_adjoint *a, skein_world *world, const char *const *fields) {
    skein_status status = SKEIN_OK;
    size_t count = count_numbers(world, fields, &status);
    if (status || !count) return status;
    a->world = world;
    a->effects = sk_allocate(&world->allocator, count * sizeof *a->effects);
    a->by_effect = sk_allocate(&world->allocator, count * sizeof *a->by_effect);
    if (!a->effects || !a->by_effect) return sk_fail_memory(sk_world_error(world), "a gradient");
    for (; *fields && !status; fields++) {
        skein_value value;
        skein_get_path(world, *fields, &value);
        for (int k = 0; k < value.count && !status; k++)
            status = find_effect(world, *fields, value, k, &a->effects[a->effect_count++]);
    }
    return status;
}

static void forget_effects(sk_allocator *allocator, sk_effect *effects, size_t count, double *by_effect) {
    for (size_t i = 0; i < count; i++) sk_effect_release(&effects[i], allocator);
    sk_release(allocator, effects);
    sk_release(allocator, by_effect);
}

/* ---- the way forth and back ---- */

/* A state between steps. */
typedef struct kept_state {
    sk_vec4 *x, *v;
} kept_state;

typedef struct journey {
    sk_adjoint a;
    skein_world *world;
    const skein_gradient_desc *desc;
    double start;            /* s */
    size_t segment;          /* steps of one */
    kept_state *checkpoints; /* at the start of each segment */
    kept_state *ends;        /* of the present segment's steps, and its start */
    size_t checkpoint_count, end_count;
    double *numbers; /* four times 3 a particle: positions, velocities, and the derivatives by them */
    double value;
} journey;

static kept_state *new_states(journey *j, size_t count) {
    size_t bytes = j->world->particles.slot_capacity * sizeof(sk_vec4);
    kept_state *states = sk_allocate(&j->world->allocator, count * sizeof *states);
    bool good = states != NULL;
    for (size_t i = 0; i < count && good; i++) {
        states[i] = (kept_state){sk_allocate(&j->world->allocator, bytes), sk_allocate(&j->world->allocator, bytes)};
        good = states[i].x && states[i].v;
    }
    return states; // what is missing is found by who asks has_all()
}

static bool has_all(const kept_state *states, size_t count) {
    bool all = states != NULL;
    for (size_t i = 0; i < count && all; i++) all = states[i].x && states[i].v;
    return all;
}

static void release_states(journey *j, kept_state *states, size_t count) {
    for (size_t i = 0; states && i < count; i++) {
        sk_release(&j->world->allocator, states[i].x);
        sk_release(&j->world->allocator, states[i].v);
    }
    sk_release(&j->world->allocator, states);
}

static void keep_state(const journey *j, kept_state *to) {
    size_t bytes = j->world->particles.slot_capacity * sizeof(sk_vec4);
    memcpy(to->x, j->world->particles.vector[SK_X], bytes);
    memcpy(to->v, j->world->particles.vector[SK_V], bytes);
}

static void go_back(const journey *j, const kept_state *to, size_t step) {
    size_t bytes = j->world->particles.slot_capacity * sizeof(sk_vec4);
    memcpy(j->world->particles.vector[SK_X], to->x, bytes);
    memcpy(j->world->particles.vector[SK_V], to->v, bytes);
    j->world->time = j->start + j->desc->dt * (double)step;
}

/* Asks what a state adds to the measure, and adds the derivatives to the adjoints. */
static void measure(journey *j, const kept_state *at, size_t step) {
    size_t count = j->world->particles.count;
    double *x = j->numbers, *v = x + 3 * count, *by_x = v + 3 * count, *by_v = by_x + 3 * count;
    memset(by_x, 0, 6 * count * sizeof *by_x);
    for (size_t p = 0; p < count; p++) {
        sk_vec4 place = at->x[j->world->particles.slot_of[p]], speed = at->v[j->world->particles.slot_of[p]];
        x[3 * p] = (double)place.x, x[3 * p + 1] = (double)place.y, x[3 * p + 2] = (double)place.z;
        v[3 * p] = (double)speed.x, v[3 * p + 1] = (double)speed.y, v[3 * p + 2] = (double)speed.z;
    }
    skein_gradient_state state = {step, j->start + j->desc->dt * (double)step, count, x, v, by_x, by_v};
    j->value += j->desc->measure(j->desc->user, &state);
    for (size_t p = 0; p < count; p++) {
        size_t stride, place = sk_adjoint_place(&j->a, p, &stride);
        for (size_t k = 0; k < 3; k++, place += stride) {
            j->a.of[SK_X][place] += (real)by_x[3 * p + k];
            j->a.of[SK_V][place] += (real)by_v[3 * p + k];
        }
    }
}

/* Steps [first, end) forward, with a tape and the state after each. */
static skein_status tape_segment(journey *j, size_t first, size_t end) {
    skein_status status = SKEIN_OK;
    keep_state(j, &j->ends[0]);
    j->a.used = 0;
    for (size_t step = first; step < end && !status; step++) {
        status = sk_adjoint_run(&j->a, j->desc->dt, true, sk_world_error(j->world));
        keep_state(j, &j->ends[step - first + 1]);
    }
    return status;
}

/* And backward. The state at its start is the last of the segment before, which measures it. */
static skein_status reverse_segment(journey *j, size_t first, size_t end) {
    skein_status status = SKEIN_OK;
    for (size_t step = end; step > first && !status; step--) {
        measure(j, &j->ends[step - first], step);
        status = sk_adjoint_reverse(&j->a, j->start + j->desc->dt * (double)(step - 1), j->desc->dt,
                                    sk_world_error(j->world));
    }
    return status;
}

static skein_status travel(journey *j) {
    size_t steps = j->desc->steps, segments = (steps + j->segment - 1) / j->segment;
    skein_error *error = sk_world_error(j->world);
    skein_status status = SKEIN_OK;
    for (size_t s = 0; s < segments && !status; s++) {
        size_t first = s * j->segment, end = s + 1 < segments ? first + j->segment : steps;
        keep_state(j, &j->checkpoints[s]);
        if (s + 1 == segments) status = tape_segment(j, first, end);
        else
            for (size_t step = first; step < end && !status; step++)
                status = sk_adjoint_run(&j->a, j->desc->dt, false, error);
    }
    if (!status && j->world->solve.unsolved)
        status = sk_fail(error, SKEIN_ERROR_VALUE, "gradient",
                         "%zu substeps were not solved: their states are none to differentiate; more newton_iterations "
                         "or substeps solve them",
                         j->world->solve.unsolved);
    for (size_t s = segments; s > 0 && !status; s--) {
        size_t first = (s - 1) * j->segment, end = s < segments ? first + j->segment : steps;
        if (s < segments) {
            go_back(j, &j->checkpoints[s - 1], first);
            status = tape_segment(j, first, end);
        }
        if (!status) status = reverse_segment(j, first, end);
    }
    if (!status) measure(j, &j->checkpoints[0], 0);
    return status;
}

/* How many steps a segment has: all, where their states fit. */
static size_t choose_segment(const journey *j) {
    size_t looks = 0, steps = j->desc->steps, most = j->desc->most_bytes ? j->desc->most_bytes : (size_t)256 << 20;
    const sk_plan *plan = &j->world->plan;
    for (size_t r = 0; r < plan->count; r++) looks += sk_adjoint_looks(plan, r);
    double bytes =
        (double)(looks + 1) * (double)steps * 2 * sizeof(sk_vec4) * (double)j->world->particles.slot_capacity;
    return bytes <= (double)most ? steps : (size_t)ceil(sqrt((double)steps));
}

static void fill_in(const journey *j, skein_gradient_result *result) {
    result->value = j->value;
    for (size_t p = 0; p < j->world->particles.count; p++) {
        size_t stride, place = sk_adjoint_place(&j->a, p, &stride);
        for (size_t k = 0; k < 3; k++, place += stride) {
            if (result->by_positions) result->by_positions[3 * p + k] = (double)j->a.of[SK_X][place];
            if (result->by_velocities) result->by_velocities[3 * p + k] = (double)j->a.of[SK_V][place];
        }
    }
    for (size_t i = 0; result->by_field && i < j->a.effect_count; i++) result->by_field[i] = j->a.by_effect[i];
}

/* With the effects in place and the plan written. */
static skein_status run_journey(journey *j, skein_gradient_result *result) {
    skein_world *world = j->world;
    skein_error *error = sk_world_error(world);
    skein_status status = sk_adjoint_begin(&j->a, world, error);
    if (status) return status;
    j->segment = choose_segment(j);
    j->checkpoint_count = (j->desc->steps + j->segment - 1) / j->segment;
    j->end_count = j->segment + 1;
    j->checkpoints = new_states(j, j->checkpoint_count);
    j->ends = new_states(j, j->end_count);
    j->numbers = sk_allocate(&world->allocator, (12 * world->particles.count + 1) * sizeof *j->numbers);
    if (!has_all(j->checkpoints, j->checkpoint_count) || !has_all(j->ends, j->end_count) || !j->numbers)
        return sk_fail_memory(error, "a gradient's states");
    sk_solve account = world->solve;
    world->solve = (sk_solve){.scale = 0};
    status = travel(j);
    world->solve = account;
    if (status) return status;
    fill_in(j, result);
    return isfinite(result->value)
               ? SKEIN_OK
               : sk_fail(error, SKEIN_ERROR_VALUE, "gradient", "the measure is no finite number: the run blew up, say");
}

static skein_status check(skein_world *world, const skein_gradient_desc *desc) {
    skein_error *error = sk_world_error(world);
    if (sizeof(real) != sizeof(double))
        return sk_fail(error, SKEIN_ERROR_VALUE, "gradient",
                       "gradients are worked out by a library in double precision (-DSKEIN_DOUBLE=ON): in float, "
                       "rounding is too large for them");
    if (world->device)
        return sk_fail(error, SKEIN_ERROR_VALUE, "gradient", "gradients are worked out on the processor");
    if (sk_world_tears(world))
        return sk_fail(error, SKEIN_ERROR_VALUE, "gradient",
                       "a body that tears has no gradient: set its stretch.tear to 0");
    if (world->pins.count)
        return sk_fail(error, SKEIN_ERROR_VALUE, "gradient",
                       "%zu places of pins wait for the next step: a gradient leads pins by motions alone",
                       world->pins.count);
    for (size_t i = 0; i < world->motions.count; i++) {
        const sk_motion_common *common = world->motions.data[i]->common;
        if (common->enabled &&
            (common->inertia < 1 || common->jump < SK_UNBOUNDED || common->jump_turn < 180 || common->jump_times[0]))
            return sk_fail(error, SKEIN_ERROR_VALUE, world->motions.data[i]->label,
                           "bodies that a motion carries along (inertia under 1, or jumps) have no gradient yet");
    }
    for (size_t i = 0; i < world->objects.count; i++)
        if (world->objects.data[i]->category == SKEIN_BODY && world->objects.data[i]->common.plain.sleep > 0)
            return sk_fail(error, SKEIN_ERROR_VALUE, world->objects.data[i]->label,
                           "what falls asleep has no gradient: set its sleep to 0");
    if (!desc->steps || desc->steps > 100000000)
        return sk_fail(error, SKEIN_ERROR_VALUE, "steps", "%zu steps: expected 1 to 100000000", desc->steps);
    return SKEIN_OK;
}

/* The world as it was found: what the journey and the fields' being tried has changed. */
typedef struct found_state {
    sk_vec4 *vectors; /* X, V and those of the last step's start, of each particle */
    double time;
    float substep; /* of the last step before: those of a journey are all alike */
} found_state;

static const sk_vector found_vectors[] = {SK_X, SK_V, SK_PREVIOUS};
enum { FOUND = sizeof found_vectors / sizeof *found_vectors };

static bool find_state(skein_world *world, found_state *found) {
    const sk_particles *all = &world->particles;
    found->time = world->time;
    found->vectors = sk_allocate(&world->allocator, (FOUND * all->count + 1) * sizeof *found->vectors);
    for (size_t p = 0; found->vectors && p < all->count; p++)
        for (size_t i = 0; i < FOUND; i++)
            found->vectors[FOUND * p + i] = all->vector[found_vectors[i]][all->slot_of[p]];
    return found->vectors != NULL;
}

static void leave_state(skein_world *world, found_state *found) {
    const sk_particles *all = &world->particles;
    world->time = found->time, world->substep = found->substep;
    for (size_t p = 0; p < all->count; p++)
        for (size_t i = 0; i < FOUND; i++)
            all->vector[found_vectors[i]][all->slot_of[p]] = found->vectors[FOUND * p + i];
    sk_release(&world->allocator, found->vectors);
}

skein_status skein_gradient(skein_world *world, const skein_gradient_desc *desc, skein_gradient_result *result) {
    SK_NEED(world, world);
    SK_NEED(world, desc);
    SK_NEED(world, result);
    SK_NEED(world, desc->measure);
    skein_error *error = sk_world_error(world);
    found_state found = {.substep = world->substep};
    world->substep = 0;
    skein_status status = check(world, desc);
    if (!status) status = sk_world_compile(world, desc->dt, error);
    if (!status && !find_state(world, &found)) status = sk_fail_memory(error, "a gradient");
    if (status) {
        world->substep = found.substep;
        return status;
    }
    struct sk_recording *recording = world->recording;
    bool unfused = world->unfused;
    journey j = {.world = world, .desc = desc, .start = world->time};
    world->recording = NULL; // nothing of this is to be done again
    status = find_effects(&j.a, world, desc->fields);
    skein_world_fuse(world, false);
    if (!status) status = sk_world_compile(world, desc->dt, error);
    if (!status) status = run_journey(&j, result);
    skein_world_fuse(world, !unfused);
    leave_state(world, &found);
    world->recording = recording;
    release_states(&j, j.checkpoints, j.checkpoint_count);
    release_states(&j, j.ends, j.end_count);
    sk_release(&world->allocator, j.numbers);
    forget_effects(&world->allocator, j.a.effects, j.a.effect_count, j.a.by_effect);
    sk_adjoint_end(&j.a);
    return status;
}
