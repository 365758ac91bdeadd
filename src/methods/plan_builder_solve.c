/* Ops for an implicit solve: residual, product, diagonal and factor, from the stiffness of each rule. */
#include "methods/plan_builder_solve.h"

#include <stddef.h>

size_t sk_write_solve(sk_plan_builder *builder, sk_op_kernel *kernel, const void *params, const char *label) {
    sk_add_op(
        builder,
        (sk_op){.kind = SK_OP_SOLVE, .order = SK_ORDERED, .kernel = kernel, .rule = params, .label = label, .end = 1});
    return builder->plan->count - 1;
}

size_t sk_write_part(sk_plan_builder *builder, int part, const char *label) {
    sk_add_op(builder, (sk_op){.kind = SK_OP_PART, .order = SK_ORDERED, .part = part, .label = label});
    return builder->plan->count - 1;
}

void sk_write_pass(sk_plan_builder *builder, const sk_kernels *kernels, sk_vector dst, sk_vector p, sk_vector q,
                   const char *label) {
    sk_add_op(builder, (sk_op){.kind = SK_OP_PASS,
                               .order = SK_FREE,
                               .kernel = kernels->version[builder->isa],
                               .dst = dst,
                               .source = {p, q, SK_NONE},
                               .label = label,
                               .end = builder->slot_count});
}

static bool is_elastic(const sk_batch *batch) {
    return sk_batch_pulls(batch) && ((const sk_material *)batch->params)->stiffness < SK_UNBOUNDED;
}

/* The kernel of an implicit solve at the byte offset `offset` in a kind's type. */
static sk_op_kernel *kernel_at(const sk_plan_builder *builder, const void *type, size_t offset) {
    return ((const sk_kernels *)(const void *)((const char *)type + offset))->version[builder->isa];
}

/* Adds an op for each batch whose kind has the kernel. Products of kinds that sweep are left out: sk_write_apply() has
 * written them. */
static void add_batches(sk_plan_builder *builder, sk_op op, size_t kernel) {
    op.order = SK_ORDERED; // elements that share a particle add to it in their order
    for (size_t i = 0; i < builder->rules->batches.count; i++) {
        const sk_batch *batch = builder->rules->batches.data[i];
        op.kernel = kernel_at(builder, batch->type, kernel);
        op.rule = batch;
        op.label = batch->label;
        op.end = batch->count;
        bool walks =
            kernel == offsetof(sk_constraint_type, apply) && batch->type->apply_sweep.groups.version[builder->isa];
        if (is_elastic(batch) && op.kernel && !walks) sk_add_op(builder, op);
    }
}

static void add_forces(sk_plan_builder *builder, sk_op op, size_t kernel) {
    op.order = SK_FREE;
    op.end = builder->slot_count;
    for (size_t i = 0; i < builder->rules->forces.count; i++) {
        const sk_force *force = builder->rules->forces.data[i];
        op.kernel = kernel_at(builder, force->type, kernel);
        op.rule = force;
        op.label = force->label;
        if (*force->enabled && op.kernel) sk_add_op_on(builder, op, &force->only);
    }
}

/* The same for surfaces that meet. */
static void add_meetings(sk_plan_builder *builder, sk_op op, size_t kernel) {
    op.order = SK_ORDERED; // pairs that share a corner
    op.end = builder->slot_count;
    for (size_t i = 0; i < builder->rules->forces.count; i++) {
        const sk_force *force = builder->rules->forces.data[i];
        if (!sk_meets(force)) continue;
        op.kernel = kernel_at(builder, force->type->meeting, kernel);
        op.rule = force;
        op.label = force->label;
        sk_add_op(builder, op);
    }
}

void sk_write_near(sk_plan_builder *builder) {
    builder->presses = true;
    add_meetings(builder, (sk_op){.kind = SK_OP_MEET, .source = {SK_X, SK_V}}, offsetof(sk_meeting, near));
}

void sk_write_pressing(sk_plan_builder *builder) {
    add_meetings(builder, (sk_op){.kind = SK_OP_MEET, .dst = SK_F, .source = {SK_X, SK_V}}, offsetof(sk_meeting, press));
}

void sk_write_apply(sk_plan_builder *builder, sk_vector dst, sk_vector p, double a, double b) {
    sk_op op = {.kind = SK_OP_APPLY, .dst = dst, .source = {SK_X, p, SK_NONE}, .coefficient = {a, b}};
    for (size_t i = 0; i < builder->rules->batches.count; i++) {
        const sk_batch *batch = builder->rules->batches.data[i];
        const sk_sweep_kernels *kernels = &batch->type->apply_sweep;
        if (is_elastic(batch) && kernels->groups.version[builder->isa]) sk_add_sums(builder, batch, op, kernels);
    }
    add_batches(builder, op, offsetof(sk_constraint_type, apply));
    add_forces(builder, op, offsetof(sk_force_type, apply));
    if (builder->presses) add_meetings(builder, op, offsetof(sk_meeting, apply));
}

void sk_write_multiply(sk_plan_builder *builder, double a, double b) {
    sk_vector direction = (sk_vector)SK_DIRECTION, product = (sk_vector)SK_PRODUCT;
    sk_write_pass(builder, &sk_solve_direction, direction, product, (sk_vector)SK_INERTIA,
                  "T8 + beta T7; T8 = inertia T7");
    sk_write_apply(builder, product, direction, a, b);
    sk_write_pass(builder, &sk_solve_curvature, product, direction, SK_NONE, "S T8; sum T7 T8");
}

void sk_write_diagonal(sk_plan_builder *builder, sk_vector diagonal, sk_vector off, double a, double b) {
    sk_op op = {.kind = SK_OP_LINEARISE, .dst = diagonal, .source = {SK_X, off}, .coefficient = {a, b}};
    add_batches(builder, op, offsetof(sk_constraint_type, diagonal));
}

void sk_write_diagonal_of_forces(sk_plan_builder *builder, sk_vector diagonal, sk_vector off, double a, double b) {
    sk_op op = {.kind = SK_OP_LINEARISE, .dst = diagonal, .source = {SK_X, off}, .coefficient = {a, b}};
    add_forces(builder, op, offsetof(sk_force_type, diagonal));
    if (builder->presses) add_meetings(builder, op, offsetof(sk_meeting, diagonal));
}

static void add_call(sk_plan_builder *builder, sk_op_kernel *kernel, sk_vector dst, sk_vector p, sk_vector q,
                     const char *label) {
    sk_add_op(builder, (sk_op){.kind = SK_OP_CALL,
                               .order = SK_ORDERED,
                               .kernel = kernel,
                               .dst = dst,
                               .source = {p, q, SK_NONE},
                               .label = label,
                               .end = builder->particle_count});
}

void sk_write_factor(sk_plan_builder *builder, sk_vector diagonal, sk_vector off, double a, double b) {
    add_call(builder, sk_matrix_clear, SK_NONE, diagonal, off, "A: particles");
    add_batches(builder, (sk_op){.kind = SK_OP_LINEARISE, .source = {SK_X}, .coefficient = {a, b}},
                offsetof(sk_constraint_type, blocks));
    add_call(builder, sk_matrix_factor, SK_NONE, (sk_vector)SK_FILTER0, (sk_vector)SK_FILTER1, "L L^T of S A S + 1 - S");
}

void sk_write_factor_solve(sk_plan_builder *builder, sk_vector dst, sk_vector p) {
    add_call(builder, sk_matrix_solve, dst, p, SK_NONE, "(L L^T)^-1");
}

void sk_write_resistance(sk_plan_builder *builder, sk_vector dst, double a) {
    sk_op op = {.kind = SK_OP_LINEARISE, .dst = dst, .source = {SK_V}, .coefficient = {a}};
    add_forces(builder, op, offsetof(sk_force_type, resistance));
}

static void add_filters(sk_plan_builder *builder, const sk_kernels *kernels, sk_vector friction) {
    for (size_t i = 0; i < builder->rules->colliders.count; i++) {
        const sk_collider *collider = builder->rules->colliders.data[i];
        if (!collider->common->enabled) continue;
        sk_add_op_on(builder,
                     (sk_op){.kind = SK_OP_CONTACT_FILTER,
                             .order = SK_FREE,
                             .kernel = kernels->version[builder->isa],
                             .dst = (sk_vector)SK_FILTER0,
                             .source = {SK_X, (sk_vector)SK_FILTER1, friction},
                             .rule = collider,
                             .label = collider->label,
                             .end = builder->slot_count},
                     &collider->only);
    }
}

void sk_write_filters(sk_plan_builder *builder) {
    sk_write_pass(builder, &sk_solve_open, (sk_vector)SK_FILTER0, SK_X, (sk_vector)SK_FILTER1, "S = 1 (0 if pinned)");
    sk_write_clear(builder, (sk_vector)SK_FRICTION);
    add_filters(builder, &sk_contact_filter, (sk_vector)SK_FRICTION);
}

void sk_write_more_filters(sk_plan_builder *builder) {
    add_filters(builder, &sk_contact_filter_more, SK_X0);
}
