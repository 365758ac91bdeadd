/* Rows for an implicit solve: residual, product, diagonal and factor, from the stiffness that each rule brings. */
#include "methods/writer_solve.h"

#include <stddef.h>

size_t sk_write_solve(sk_writer *writer, sk_row_kernel *kernel, const void *params, const char *label) {
    sk_add_row(writer, (sk_row){.kind = SK_ROW_SOLVE,
                                .order = SK_ORDERED,
                                .kernel = kernel,
                                .rule = params,
                                .label = label,
                                .end = 1});
    return writer->plan->count - 1;
}

size_t sk_write_part(sk_writer *writer, int part, const char *label) {
    sk_add_row(writer, (sk_row){.kind = SK_ROW_PART, .order = SK_ORDERED, .part = part, .label = label});
    return writer->plan->count - 1;
}

void sk_write_pass(sk_writer *writer, const sk_kernels *kernels, sk_vector dst, sk_vector p, sk_vector q,
                   const char *label) {
    sk_add_row(writer, (sk_row){.kind = SK_ROW_COMBINE,
                                .order = SK_FREE,
                                .kernel = kernels->version[writer->isa],
                                .dst = dst,
                                .source = {p, q, SK_NONE},
                                .label = label,
                                .end = writer->slot_count});
}

static bool is_elastic(const sk_batch *batch) {
    return sk_batch_pulls(batch) && ((const sk_material *)batch->params)->stiffness < SK_UNBOUNDED;
}

/* The kernel that lies so far behind the start of a type: what a kind has for an implicit solve. */
static sk_row_kernel *kernel_at(const sk_writer *writer, const void *type, size_t offset) {
    return ((const sk_kernels *)(const void *)((const char *)type + offset))->version[writer->isa];
}

/* A row for each batch whose kind has such a kernel; those that walk for a product have been written before. */
static void add_batches(sk_writer *writer, sk_row row, size_t kernel) {
    row.order = SK_ORDERED; // elements that share a particle add to it in their order
    for (size_t i = 0; i < writer->rules->batches.count; i++) {
        const sk_batch *batch = writer->rules->batches.data[i];
        row.kernel = kernel_at(writer, batch->type, kernel);
        row.rule = batch;
        row.label = batch->label;
        row.end = batch->count;
        bool walks = kernel == offsetof(sk_constraint_type, apply) && batch->type->apply_sweep.groups.version[writer->isa];
        if (is_elastic(batch) && row.kernel && !walks) sk_add_row(writer, row);
    }
}

static void add_forces(sk_writer *writer, sk_row row, size_t kernel) {
    row.order = SK_FREE;
    row.end = writer->slot_count;
    for (size_t i = 0; i < writer->rules->forces.count; i++) {
        const sk_force *force = writer->rules->forces.data[i];
        row.kernel = kernel_at(writer, force->type, kernel);
        row.rule = force;
        row.label = force->label;
        if (*force->enabled && row.kernel) sk_add_row_on(writer, row, &force->only);
    }
}

void sk_write_apply(sk_writer *writer, sk_vector dst, sk_vector p, double a, double b) {
    sk_row row = {.kind = SK_ROW_APPLY, .dst = dst, .source = {SK_X, p, SK_NONE}, .coefficient = {a, b}};
    for (size_t i = 0; i < writer->rules->batches.count; i++) {
        const sk_batch *batch = writer->rules->batches.data[i];
        const sk_sweep_kernels *kernels = &batch->type->apply_sweep;
        if (is_elastic(batch) && kernels->groups.version[writer->isa]) sk_add_sums(writer, batch, row, kernels);
    }
    add_batches(writer, row, offsetof(sk_constraint_type, apply));
    add_forces(writer, row, offsetof(sk_force_type, apply));
}

void sk_write_multiply(sk_writer *writer, double a, double b) {
    sk_vector direction = (sk_vector)SK_DIRECTION, product = (sk_vector)SK_PRODUCT;
    sk_write_pass(writer, &sk_solve_direction, direction, product, (sk_vector)SK_INERTIA,
                  "T8 + beta T7; T8 = inertia T7");
    sk_write_apply(writer, product, direction, a, b);
    sk_write_pass(writer, &sk_solve_curvature, product, direction, SK_NONE, "S T8; sum T7 T8");
}

void sk_write_diagonal(sk_writer *writer, sk_vector diagonal, sk_vector off, double a, double b) {
    sk_row row = {.kind = SK_ROW_LINEARISE, .dst = diagonal, .source = {SK_X, off}, .coefficient = {a, b}};
    add_batches(writer, row, offsetof(sk_constraint_type, diagonal));
}

void sk_write_diagonal_of_forces(sk_writer *writer, sk_vector diagonal, sk_vector off, double a, double b) {
    sk_row row = {.kind = SK_ROW_LINEARISE, .dst = diagonal, .source = {SK_X, off}, .coefficient = {a, b}};
    add_forces(writer, row, offsetof(sk_force_type, diagonal));
}

static void add_call(sk_writer *writer, sk_row_kernel *kernel, sk_vector dst, sk_vector p, sk_vector q,
                     const char *label) {
    sk_add_row(writer, (sk_row){.kind = SK_ROW_CALL,
                                .order = SK_ORDERED,
                                .kernel = kernel,
                                .dst = dst,
                                .source = {p, q, SK_NONE},
                                .label = label,
                                .end = writer->particle_count});
}

void sk_write_factor(sk_writer *writer, sk_vector diagonal, sk_vector off, double a, double b) {
    add_call(writer, sk_matrix_clear, SK_NONE, diagonal, off, "A: particles");
    add_batches(writer, (sk_row){.kind = SK_ROW_LINEARISE, .source = {SK_X}, .coefficient = {a, b}}, offsetof(sk_constraint_type, blocks));
    add_call(writer, sk_matrix_factor, SK_NONE, (sk_vector)SK_FILTER0, (sk_vector)SK_FILTER1, "L L^T of S A S + 1 - S");
}

void sk_write_factor_solve(sk_writer *writer, sk_vector dst, sk_vector p) {
    add_call(writer, sk_matrix_solve, dst, p, SK_NONE, "(L L^T)^-1");
}

void sk_write_resistance(sk_writer *writer, sk_vector dst, double a) {
    sk_row row = {.kind = SK_ROW_LINEARISE, .dst = dst, .source = {SK_V}, .coefficient = {a}};
    add_forces(writer, row, offsetof(sk_force_type, resistance));
}

static void add_filters(sk_writer *writer, const sk_kernels *kernels, sk_vector friction) {
    for (size_t i = 0; i < writer->rules->colliders.count; i++) {
        const sk_collider *collider = writer->rules->colliders.data[i];
        if (!collider->common->enabled) continue;
        sk_add_row_on(writer,
                      (sk_row){.kind = SK_ROW_CONTACT_FILTER,
                               .order = SK_FREE,
                               .kernel = kernels->version[writer->isa],
                               .dst = (sk_vector)SK_FILTER0,
                               .source = {SK_X, (sk_vector)SK_FILTER1, friction},
                               .rule = collider,
                               .label = collider->label,
                               .end = writer->slot_count},
                      &collider->only);
    }
}

void sk_write_filters(sk_writer *writer) {
    sk_write_pass(writer, &sk_solve_open, (sk_vector)SK_FILTER0, SK_X, (sk_vector)SK_FILTER1, "S = 1 (0 if held)");
    sk_write_clear(writer, (sk_vector)SK_FRICTION);
    add_filters(writer, &sk_contact_filter, (sk_vector)SK_FRICTION);
}

void sk_write_more_filters(sk_writer *writer) {
    add_filters(writer, &sk_contact_filter_more, SK_X0);
}
