/* Stepping: bring the plan up to date, run it, move the clock. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "base/float_mode.h"
#include "plan/fuse.h"
#include "world/cut.h"
#include "world/record.h"
#include "world/world.h"

skein_status sk_world_arrange(skein_world *world, skein_error *error) {
    if (!world->slots_stale) return SKEIN_OK;
    skein_status status = sk_world_touch(world); // the state goes to new slots
    if (status) return status;
    sk_allocator *allocator = &world->allocator;
    if ((status = sk_world_settle_presence(world, error))) return status;
    bool good = sk_particles_arrange(&world->particles, allocator);
    for (size_t i = 0; i < world->rules.batches.count && good; i++)
        good = sk_batch_arrange(world->rules.batches.data[i], allocator, &world->particles);
    for (size_t i = 0; i < world->rules.limits.count && good; i++)
        if (*world->rules.limits.data[i]->enabled)
            good = sk_limit_arrange(world->rules.limits.data[i], allocator, &world->particles);
    if (!good) return sk_fail_memory(error, "the order of sweeps");
    if (!sk_surface_arrange(&world->surface, allocator, &world->particles, &world->triangles))
        return sk_fail_memory(error, "triangles");
    world->slots_stale = false;
    world->plan_stale = true;
    world->arrangement++;
    world->matrix.shaped = false;
    return SKEIN_OK;
}

/* A collider lighter than a particle would go on inwards with it: it stops it instead, and that is said once. */
static void warn_of_light_colliders(skein_world *world) {
    const sk_particles *all = &world->particles;
    for (size_t i = 0; i < world->rules.colliders.count; i++) {
        sk_collider *collider = world->rules.colliders.data[i];
        double mass = sk_collider_mass(collider), heaviest = 0;
        if (!(mass > 0) || mass == collider->warned_mass) continue;
        for (size_t p = 0; p < all->count; p++)
            if (!all->pinned[p] && sk_particle_is_here(all, p) && (double)all->mass[p] > heaviest)
                heaviest = (double)all->mass[p];
        if (!(mass < heaviest)) continue;
        sk_world_log(world, SKEIN_LOG_WARNING,
                     "%s: its mass of %g kg is less than that of a particle, %g kg: such particles stop at it",
                     collider->label, mass, heaviest);
        collider->warned_mass = mass;
    }
}

/* Makes the temporaries that the plan names, and no others. */
static bool make_temporaries(skein_world *world) {
    uint32_t wanted = 0;
    for (size_t r = 0; r < world->plan.count; r++) {
        const sk_op *op = &world->plan.data[r];
        wanted |= 1u << op->dst | op->also_writes;
        for (int i = 0; i < 3; i++) wanted |= 1u << op->source[i];
    }
    return sk_particles_want(&world->particles, &world->allocator, wanted);
}

/* Memory for what the plan sorts, so that it cannot be wanting in the midst of a step. */
static bool make_cells(skein_world *world) {
    bool good = true, sorts = false;
    for (size_t r = 0; r < world->plan.count && good; r++) {
        const sk_op *op = &world->plan.data[r];
        if (!sk_op_type_of(op)->sorts) continue;
        sorts = true;
        good = sk_cells_reserve(&world->cells, &world->allocator, op->group);
    }
    world->cells.in_order = sorts;
    for (size_t i = 1; i < world->particles.count && world->cells.in_order; i++)
        world->cells.in_order = world->particles.slot_of[i - 1] < world->particles.slot_of[i];
    return good;
}

/* Makes the shape of the matrix where an op calls for it, and shows it to the solver. It has the blocks of all batches,
 * also of those that are not enabled: analysing costs more than some zeros. */
static skein_status make_matrix(skein_world *world, skein_error *error) {
    sk_allocator *allocator = &world->allocator;
    sk_matrix *matrix = &world->matrix;
    size_t count = world->rules.batches.count, part_count = 0;
    bool wanted = false;
    for (size_t r = 0; r < world->plan.count; r++) wanted |= sk_op_type_of(&world->plan.data[r])->factors;
    if (!wanted) sk_matrix_release(matrix, allocator);
    if (!wanted || matrix->shaped) return SKEIN_OK;
    sk_matrix_part *parts = sk_allocate(allocator, (count + 1) * sizeof *parts);
    bool good = parts != NULL;
    for (size_t i = 0; i < count && good; i++) {
        sk_batch *batch = world->rules.batches.data[i];
        if (!batch->type->blocks.version[world->isa] || batch->only_bounds || batch->asleep) continue;
        sk_release(allocator, batch->pair);
        batch->pair =
            sk_allocate(allocator, batch->count * batch->arity * (batch->arity - 1) / 2 * sizeof *batch->pair);
        good = batch->pair != NULL;
        parts[part_count++] = (sk_matrix_part){batch->particle, batch->count, batch->arity, batch->pair};
    }
    good = good && sk_matrix_shape(matrix, allocator, world->particles.count, parts, part_count);
    sk_release(allocator, parts);
    if (!good) return sk_fail_memory(error, "the solve's matrix");
    skein_sparse_matrix pattern = sk_matrix_view(matrix, false);
    skein_status status = matrix->solver.analyse(matrix->solver.user, &pattern, error);
    matrix->shaped = !status;
    return status;
}

skein_status skein_sparse_solver_set(skein_world *world, const skein_sparse_solver *solver) {
    SK_NEED(world, world);
    if (solver && (!solver->analyse || !solver->factor || !solver->solve))
        return sk_fail(sk_world_error(world), SKEIN_ERROR_VALUE, "solver",
                       "a sparse solver needs analyse, factor and solve");
    sk_matrix *matrix = &world->matrix;
    if (matrix->solver.release) matrix->solver.release(matrix->solver.user);
    matrix->solver = solver ? *solver : (skein_sparse_solver){.name = NULL};
    matrix->shaped = false;
    world->rules.sparse_solver = solver ? solver->name ? solver->name : "a solver" : NULL;
    world->plan_stale = true;
    return SKEIN_OK;
}

/* Room for the ops of a step, where not all are always needed. */
static bool make_live(skein_world *world) {
    bool any = false;
    sk_release(&world->allocator, world->live);
    world->live = NULL;
    for (size_t r = 0; r < world->plan.count; r++) any |= world->plan.data[r].strained != NULL;
    return !any || (world->live = sk_allocate(&world->allocator, world->plan.count * sizeof *world->live));
}

/* Room for who was moved when, where ops of the plan say so. */
static bool make_watch(skein_world *world) {
    if (!SK_WATCHES) return true;
    const size_t blocks = world->particles.slot_capacity / 16; // spare slots lie behind all others
    uint32_t turns = 0;
    for (size_t r = 0; r < world->plan.count; r++)
        if (world->plan.data[r].turn > turns) turns = world->plan.data[r].turn;
    // other parts of a run move what they share
    const size_t wanted = turns && !world->device && !world->share ? blocks + 1 : 0;
    world->watch.turns = turns;
    if (world->watch.room == wanted) return true; // of the plan before, whose turns are all over
    sk_release(&world->allocator, world->watch.moved);
    sk_release(&world->allocator, world->watch.found_held);
    world->watch.moved = world->watch.found_held = NULL, world->watch.room = 0;
    if (!wanted) return true;
    world->watch.moved = sk_allocate(&world->allocator, wanted * sizeof *world->watch.moved);
    world->watch.found_held = sk_allocate(&world->allocator, wanted * sizeof *world->watch.found_held);
    if (!world->watch.moved || !world->watch.found_held) return false;
    world->watch.room = wanted;
    return true;
}

/* How many substeps a step of dt has: as many as its method says, or more where pins are fast (`most`), but where they would be shorter
 * than four fifths of the last ones, as many as that allows, or one more than there are of those in it. A sheet of 33 x 33 that hangs still by two corners gains 0.8 J at most with all of them in steps of 1/30 and
 * 1/144 s in turn, 1e-4 so; a frame of 0.1 s between ones of 1/144: 0.1 J, and 0.007; frames of 1/30 to 1/144 by chance 0.009, and 3e-4 (two thirds
 * instead of four fifths: 0.004); so do irregular meshes, and in contact. Not less than one more, or frames of 1/144 s stay with one substep. */
static int substeps_of(const skein_world *world, double dt, int most) {
    if (!world->method->shortens_slowly || !(world->substep > 0) || isinf(world->substep)) return most;
    const double as_long = dt / (double)world->substep;
    return (int)fmin(fmax(floor(1.25 * as_long), floor(as_long + 1e-3) + 1), most);
}

/* Writes the method's part of the plan, with other parameters where these are more or fewer substeps. */
static void write_method(sk_plan_builder *builder, const skein_world *world, double dt, int substeps) {
    const sk_method_type *method = world->method;
    sk_substeps *other = NULL;
    if (substeps != method->substeps(world->method_params)) {
        other = sk_allocate(builder->allocator, method->kind.params_size);
        builder->no_memory |= !other;
        if (!other) return;
        memcpy(other, world->method_params, method->kind.params_size);
        other->substeps = substeps;
    }
    method->write(builder, other ? other : world->method_params, dt);
    sk_release(builder->allocator, other);
}

skein_status sk_world_compile(skein_world *world, double dt, skein_error *error) {
    if (!(dt > 0) || !(dt <= 1e6))
        return sk_fail(error, SKEIN_ERROR_VALUE, "dt", "a step of %g s: expected more than 0, at most 1e6", dt);
    if (world->plan_stale) sk_world_run_compiled(world);
    skein_status status = sk_world_tether_pins(world, error);
    if (!status) status = sk_world_arrange(world, error);
    if (!status) status = sk_world_find_pins(world, error);
    if (status) return status;
    int most = world->method->substeps(world->method_params);
    if (world->method->shortens_slowly && !sk_world_find_finer(world, dt, most, &most))
        return sk_fail_memory(error, "places for pins");
    const int substeps = substeps_of(world, dt, most);
    if (!world->plan_stale && world->plan_dt == dt && world->plan_substeps == substeps) return SKEIN_OK;
    const sk_method_type *method = world->method;
    status = sk_method_check(method, world->method_params, &world->rules, error);
    if (!status) status = sk_world_find_whom(world, error);
    if (!status) status = sk_world_prepare_meetings(world, error);
    if (status) return status;
    for (size_t i = 0; i < world->rules.batches.count; i++) sk_batch_refresh(world->rules.batches.data[i]);
    warn_of_light_colliders(world);
    world->plan_stale = true; // until it is whole
    world->plan.count = 0;
    sk_plan_builder builder = {
        .plan = &world->plan,
        .allocator = &world->allocator,
        .rules = &world->rules,
        .isa = world->isa,
        .slot_count = world->particles.slot_count,
        .strip_slots = world->particles.strip_slots,
        .particle_count = world->particles.count,
        .everybody = &world->everybody,
        .surface = &world->surface,
        .h = dt,
    };
    sk_write_sum(&builder, SK_PREVIOUS, 1, SK_X, 0, SK_NONE);
    if (!world->device) sk_write_pack(&builder);
    write_method(&builder, world, dt, substeps);
    if (!world->device) {
        sk_write_rest(&builder); // a card would have to look at everything once more, and minds thin numbers not at all
        sk_write_unpack(&builder);
    }
    if (!world->unfused || world->device)
        builder.no_memory |= !sk_plan_fuse(&world->plan, &world->allocator, world->isa);
    if (builder.no_memory || (!world->device && (!make_temporaries(world) || !make_cells(world))))
        return sk_fail_memory(error, "the plan");
#ifndef SK_SMALL // no page has a part of a run
    if (world->share) sk_share_plan(&world->plan, world->share, world->isa);
#endif
    if (!make_live(world) || !make_watch(world)) return sk_fail_memory(error, "the plan");
    status = world->share ? sk_world_check_share(world, error) : SKEIN_OK;
    if (!status) status = make_matrix(world, error);
    if (status) return status;
    if (world->device && (status = world->device->prepare(world->device, world, error))) return status;
    world->plan_dt = dt;
    world->plan_substeps = substeps;
    world->sweeps_more = builder.sweeps_more;
    world->plan_stale = false;
    return SKEIN_OK;
}

sk_run sk_world_run_context(skein_world *world) {
    world->supported = true; // as far as anybody knows
    sk_run run = {
        .supported = &world->supported,
        .slot_count = world->particles.slot_count,
        .slot_of = world->particles.slot_of,
        .particle_of = world->particles.particle_of,
        .particle_count = world->particles.count,
        .surface = &world->surface,
        .cells = &world->cells,
        .allocator = &world->allocator,
        .time = world->time,
        .solve = &world->solve,
        .matrix = &world->matrix,
    };
    memcpy(run.vector, world->particles.vector, sizeof run.vector);
    return run;
}

/* How many ops from the first on are needed in this step, as copies in `live`: those for what is strained are not, where nothing is. What
 * is only passed over costs, too: ops of a walk lag behind each other, and threads wait for each. */
static size_t find_live(const skein_world *world) {
    const sk_plan *plan = &world->plan;
    size_t count = 0;
    for (size_t r = 0; r < plan->count; r++) {
        const sk_op *op = &plan->data[r];
        if (op->strained && !*op->strained) continue;
        world->live[count] = *op;
        for (size_t k = r + 1; k <= r + op->length; k++)
            if (plan->data[k].strained && !*plan->data[k].strained) world->live[count].length--;
        count++;
    }
    return count;
}

/* One step; `seconds` of each op of the plan, or NULL to run them as fast as they go. The plan is up to date. */
static skein_status take_step(skein_world *world, double dt, double *seconds, skein_error *error) {
    if (!world->steps) {
        skein_statistics start = {0};
        sk_world_measure_energy(world, &start);
        world->first_energy = start.kinetic_energy + start.potential_energy + start.elastic_energy;
    }
    world->solve = (sk_solve){.scale = 0};
    if (world->share) world->share->failed = false;
    skein_status status = sk_world_set_out(world, dt, error);
    if (status) return status;
    sk_run run = sk_world_run_context(world);
    if (world->device) {
        status = world->device->step(world->device, world, &run, error);
    } else {
        sk_tasks_use(world->tasks, sk_pace_threads(&world->pace));
        double start = world->pace.levels > 1 ? sk_seconds() : 0;
        uint64_t mode = sk_float_mode_enter();
        run.seconds = seconds;
        sk_world_note_strained(world, dt);
        run.strained = world->rules.strained;
        run.turn = world->watch.turn, run.turns = world->watch.turns;
        run.moved = world->watch.never ? NULL : world->watch.moved, run.found_held = world->watch.found_held;
        if (world->live && !seconds) sk_run_ops(&run, world->tasks, world->live, find_live(world));
        else sk_run_ops(&run, world->tasks, world->plan.data, world->plan.count);
        sk_float_mode_leave(mode);
        world->watch.turn = run.turn + run.turns;
        if (world->pace.levels > 1 && !seconds) sk_pace_note(&world->pace, sk_seconds() - start);
        if (world->share && world->share->failed)
            status = sk_fail(error, SKEIN_ERROR_VALUE, "share", "what lies at the border of this part did not come");
        if (run.no_memory) status = sk_fail_memory(error, "the neighbour grid; the step was not finished");
    }
    skein_status arrived = sk_world_arrive(world, !status);
    if (status || arrived) return status ? status : arrived;
    world->time += dt;
    world->steps++;
    world->unsolved += world->solve.unsolved;
    world->solver_failures += world->solve.failures;
    world->substeps += (uint64_t)world->plan_substeps;
    world->substep = world->method->shortens_slowly ? (float)(dt / world->plan_substeps) : 0;
    sk_world_tell_of_meetings(world);
    if (sk_world_tears(world) && (status = sk_world_tear(world, error))) return status;
    if (!world->device) sk_world_reorder(world);
    return sk_world_let_sleep(world, dt, error);
}

skein_status skein_world_step(skein_world *world, double dt) {
    SK_NEED(world, world);
    skein_error *error = sk_world_error(world);
    skein_status status = sk_world_wake(world, dt, error);
    if (!status) status = sk_world_compile(world, dt, error);
    if (!status && world->recording) sk_record_step(world, dt);
    return status ? status : take_step(world, dt, NULL, error);
}

/* ---- what its passes take ---- */

/* Adds an op's seconds to the pass of its kind and name; `count` passes are there, the first `most` of them in `out`.
 */
static void add_to_passes(const sk_op *op, double seconds, skein_pass *out, size_t most, size_t *count) {
    const sk_op_type *type = sk_op_type_of(op);
    const char *kind = type->name, *label = type->arithmetic || !op->label ? "" : op->label;
    for (size_t i = 0; i < *count && i < most; i++)
        if (out[i].kind == kind && !strncmp(out[i].label, label, sizeof out[i].label - 1)) {
            out[i].seconds += seconds;
            return;
        }
    if (*count < most) {
        out[*count].kind = kind;
        out[*count].seconds = seconds;
        snprintf(out[*count].label, sizeof out[*count].label, "%s", label);
    }
    ++*count;
}

skein_status skein_world_profile(skein_world *world, double dt, skein_pass *out, size_t most, size_t *count) {
    SK_NEED(world, world);
    SK_NEED(world, count);
    if (most) SK_NEED(world, out);
    skein_error *error = sk_world_error(world);
    *count = 0;
    skein_status status = sk_world_wake(world, dt, error);
    if (!status) status = sk_world_compile(world, dt, error);
    if (status) return status;
    if (world->recording) sk_record_step(world, dt);
    if (world->device) { // whose ops run together
        double start = sk_seconds();
        status = take_step(world, dt, NULL, error);
        skein_world_wait(world);
        if (!status && most) out[0] = (skein_pass){.kind = "device", .seconds = sk_seconds() - start};
        *count = status ? 0 : 1;
        return status;
    }
    double *seconds = sk_allocate(&world->allocator, world->plan.count * sizeof *seconds);
    if (!seconds) return sk_fail_memory(error, "the profile");
    memset(seconds, 0, world->plan.count * sizeof *seconds);
    status = take_step(world, dt, seconds, error);
    for (size_t r = 0; r < world->plan.count && !status; r++)
        if (world->plan.data[r].kernel) add_to_passes(&world->plan.data[r], seconds[r], out, most, count);
    sk_release(&world->allocator, seconds);
    return status;
}

/* Where time jumps, nothing is on its way: no collider, and who is to be led apart is asked anew. */
static void stop_what_moves(skein_world *world) {
    for (size_t i = 0; i < world->rules.colliders.count; i++) sk_collider_stop(world->rules.colliders.data[i]);
    sk_world_ease_meetings(world, NULL);
}

skein_status skein_world_reset(skein_world *world) {
    SK_NEED(world, world);
    skein_status status = sk_world_touch(world); // masses may have changed, and where particles are held
    if (status) return status;
    world->solve = (sk_solve){.scale = 0};
    sk_world_wake_all(world);
    sk_particles_reset(&world->particles);
    for (size_t i = 0; i < world->objects.count; i++)
        if (world->objects.data[i]->category == SKEIN_BODY) sk_cut_set(world, world->objects.data[i]->as.body, NULL);
    world->pins.count = 0;
    stop_what_moves(world);
    world->time = 0, world->substep = 0;
    sk_world_place_colliders(world);
    world->steps = world->substeps = world->unsolved = world->solver_failures = world->contact_overflows = 0;
    sk_record_reset(world);
    return SKEIN_OK;
}

double skein_world_time(const skein_world *world) {
    return world ? world->time : 0;
}

skein_status skein_world_time_set(skein_world *world, double seconds) {
    SK_NEED(world, world);
    if (!(seconds >= 0) || !(seconds <= SK_FAR))
        return sk_fail(sk_world_error(world), SKEIN_ERROR_VALUE, "seconds", "a time of %g s: expected 0 to 1e15",
                       seconds);
    stop_what_moves(world);
    sk_world_rouse(world);
    world->time = seconds, world->substep = 0; // how long the last one was says nothing of the next
    sk_world_place_colliders(world);
    sk_record_clock(world, seconds);
    return SKEIN_OK;
}

skein_status skein_world_explain(skein_world *world, double dt, void (*write)(void *user, const char *line),
                                 void *user) {
    SK_NEED(world, world);
    skein_status status = sk_world_compile(world, dt, sk_world_error(world));
    if (status) return status;
    if (!write) return SKEIN_OK;
    enum { MOST_DEPTH = 8 };
    size_t open_until[MOST_DEPTH], depth = 0; // of the ops that lead others, around an op
    for (size_t r = 0; r < world->plan.count; r++) {
        const sk_op *op = &world->plan.data[r];
        while (depth && r >= open_until[depth - 1]) depth--;
        char line[384] = "                                ";
        sk_op_describe(op, line + 4 * depth, sizeof line - 4 * depth);
        write(user, line);
        if (op->length && depth < MOST_DEPTH) open_until[depth++] = r + op->length + 1;
    }
    return SKEIN_OK;
}

void skein_world_fuse(skein_world *world, bool fuse) {
    if (!world || world->unfused == !fuse) return;
    world->unfused = !fuse;
    world->plan_stale = true;
}

/* ---- a fixed step for loops with uneven frames ---- */

skein_pacer skein_default_pacer(void) {
    return (skein_pacer){.step = SKEIN_DEFAULT_STEP, .most_steps = 8};
}

int skein_pacer_feed(skein_pacer *pacer, double seconds) {
    if (!pacer) return 0;
    if (!(seconds > 0) || isinf(seconds)) seconds = 0;
    pacer->remainder += seconds;
    // a hair of tolerance, so that 1/60 s fed twice is the same as 1/30 s fed once
    double whole = floor(pacer->remainder / pacer->step + 1e-9);
    if (whole > pacer->most_steps) {
        pacer->dropped += (whole - pacer->most_steps) * pacer->step;
        pacer->remainder -= (whole - pacer->most_steps) * pacer->step;
        whole = pacer->most_steps;
    }
    pacer->remainder -= whole * pacer->step;
    if (pacer->remainder < 0) pacer->remainder = 0;
    return (int)whole;
}

double skein_pacer_blend(const skein_pacer *pacer) {
    if (!pacer) return 0;
    double blend = pacer->remainder / pacer->step;
    return blend < 0 ? 0 : blend > 1 ? 1 : blend;
}
