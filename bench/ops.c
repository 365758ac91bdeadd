/* Ops of a plan run alone, as a step would run them: in the layout that they expect, repeated as in a frame, by the
 * world's own runner. */
#include <stdlib.h>
#include <string.h>

#include "base/float_mode.h"
#include "bench/worlds.h"
#include "world/world.h"

struct bench_ops {
    skein_world *world;
    sk_op *ops;   /* a repeat, and the ops in it */
    size_t count; /* with the repeat */
};

/* Runs the plan's ops that bring X and V into the layout of a step, or back; there need not be any. */
static void run_layout_ops(skein_world *world, sk_op_kind kind) {
    sk_run run = sk_world_run_context(world);
    for (size_t r = 0; r < world->plan.count; r++)
        if (world->plan.data[r].kind == kind) sk_run_ops(&run, world->tasks, &world->plan.data[r], 1);
}

bench_ops *bench_ops_create(skein_world *world, sk_op_kind kind) {
    bench_need(world, skein_world_explain(world, 1.0 / 60, NULL, NULL)); // makes the plan
    const sk_plan *plan = &world->plan;
    bench_ops *ops = bench_allocate(1, sizeof *ops);
    ops->ops = bench_allocate(plan->count + 1, sizeof *ops->ops);
    ops->world = world;
    ops->ops[0] = (sk_op){.kind = SK_OP_REPEAT, .order = SK_ORDERED, .label = "repeat", .end = 1};
    ops->count = 1;
    for (size_t r = 0; r < plan->count; r++) {
        if (plan->data[r].kind == SK_OP_REPEAT) ops->ops[0] = plan->data[r];
        if (plan->data[r].kind == kind) ops->ops[ops->count++] = plan->data[r];
    }
    ops->ops[0].length = ops->count - 1;
    if (ops->count == 1) {
        bench_say("the plan has no %s ops", sk_op_types[kind].name);
        free(ops->ops);
        free(ops);
        return NULL;
    }
    run_layout_ops(world, SK_OP_PACK);
    return ops;
}

void bench_ops_destroy(bench_ops *ops) {
    if (!ops) return;
    run_layout_ops(ops->world, SK_OP_UNPACK);
    free(ops->ops);
    free(ops);
}

static void run(bench_ops *ops, const sk_op *first, size_t count, size_t iteration) {
    sk_run context = sk_world_run_context(ops->world);
    context.iteration = iteration;
    uint64_t mode = sk_float_mode_enter();
    sk_run_ops(&context, ops->world->tasks, first, count);
    sk_float_mode_leave(mode);
}

void bench_ops_run(void *data) {
    bench_ops *ops = data;
    run(ops, ops->ops, ops->count, 0);
}

void bench_ops_run_once(void *data) {
    bench_ops *ops = data;
    run(ops, ops->ops + 1, ops->count - 1, 1);
}

size_t bench_ops_iterations(const bench_ops *ops) {
    return ops->ops[0].end;
}

void bench_ops_forces(bench_ops *ops, double *out) {
    sk_particles *particles = &ops->world->particles;
    sk_vec4 *forces = particles->vector[SK_F];
    memset(forces, 0, particles->slot_count * sizeof *forces);
    bench_ops_run_once(ops);
    for (size_t i = 0; i < particles->count; i++) {
        sk_vec4 f = sk_load(forces, ops->ops[1].packed, particles->slot_of[i]);
        out[3 * i] = (double)f.x, out[3 * i + 1] = (double)f.y, out[3 * i + 2] = (double)f.z;
    }
}
