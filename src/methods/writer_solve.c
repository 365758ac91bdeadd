#include "methods/writer_solve.h"

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

static void add_batches(sk_writer *writer, sk_row_kind kind, const sk_kernels *(*kernels_of)(const sk_batch *batch),
                        sk_vector dst, sk_vector second, double a, double b) {
    for (size_t i = 0; i < writer->rules->batches.count; i++) {
        const sk_batch *batch = writer->rules->batches.data[i];
        sk_row_kernel *kernel = kernels_of(batch)->version[writer->isa];
        if (!is_elastic(batch) || !kernel) continue;
        sk_add_row(writer, (sk_row){.kind = kind,
                                    .order = SK_ORDERED, // elements that share a particle add to it in their order
                                    .kernel = kernel,
                                    .dst = dst,
                                    .source = {SK_X, second, SK_NONE},
                                    .coefficient = {a, b},
                                    .rule = batch,
                                    .label = batch->label,
                                    .end = batch->count});
    }
}

typedef const sk_kernels *force_kernels(const sk_force_type *type);

static const sk_kernels *force_apply(const sk_force_type *type) {
    return &type->apply;
}
static const sk_kernels *force_diagonal(const sk_force_type *type) {
    return &type->diagonal;
}
static const sk_kernels *force_resistance(const sk_force_type *type) {
    return &type->resistance;
}

static void add_forces(sk_writer *writer, sk_row row, force_kernels *kernels_of) {
    for (size_t i = 0; i < writer->rules->forces.count; i++) {
        const sk_force *force = writer->rules->forces.data[i];
        row.order = SK_FREE;
        row.kernel = kernels_of(force->type)->version[writer->isa];
        row.rule = force;
        row.label = force->label;
        row.end = writer->slot_count;
        if (*force->enabled && row.kernel) sk_add_row_on(writer, row, &force->only);
    }
}

/* Of a kind that has no walk for it. */
static const sk_kernels *apply_of(const sk_batch *batch) {
    static const sk_kernels none;
    return batch->type->apply_sweep.groups.version[0] ? &none : &batch->type->apply;
}
static const sk_kernels *diagonal_of(const sk_batch *batch) {
    return &batch->type->diagonal;
}
static const sk_kernels *blocks_of(const sk_batch *batch) {
    return &batch->type->blocks;
}

void sk_write_apply(sk_writer *writer, sk_vector dst, sk_vector p, double a, double b) {
    sk_row row = {.kind = SK_ROW_APPLY, .dst = dst, .source = {SK_X, p, SK_NONE}, .coefficient = {a, b}};
    for (size_t i = 0; i < writer->rules->batches.count; i++) {
        const sk_batch *batch = writer->rules->batches.data[i];
        const sk_sweep_kernels *kernels = &batch->type->apply_sweep;
        if (is_elastic(batch) && kernels->groups.version[writer->isa]) sk_add_sums(writer, batch, row, kernels);
    }
    add_batches(writer, SK_ROW_APPLY, apply_of, dst, p, a, b);
    add_forces(writer, row, force_apply);
}

void sk_write_multiply(sk_writer *writer, double a, double b) {
    sk_vector direction = (sk_vector)SK_DIRECTION, product = (sk_vector)SK_PRODUCT;
    sk_write_pass(writer, &sk_solve_direction, direction, product, (sk_vector)SK_INERTIA,
                  "T8 + beta T7; T8 = inertia T7");
    sk_write_apply(writer, product, direction, a, b);
    sk_write_pass(writer, &sk_solve_curvature, product, direction, SK_NONE, "S T8; sum T7 T8");
}

void sk_write_diagonal(sk_writer *writer, sk_vector diagonal, sk_vector off, double a, double b) {
    add_batches(writer, SK_ROW_LINEARISE, diagonal_of, diagonal, off, a, b);
}

void sk_write_diagonal_of_forces(sk_writer *writer, sk_vector diagonal, sk_vector off, double a, double b) {
    sk_row row = {.kind = SK_ROW_LINEARISE, .dst = diagonal, .source = {SK_X, off}, .coefficient = {a, b}};
    add_forces(writer, row, force_diagonal);
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
    add_batches(writer, SK_ROW_LINEARISE, blocks_of, SK_NONE, SK_NONE, a, b);
    add_call(writer, sk_matrix_factor, SK_NONE, (sk_vector)SK_FILTER0, (sk_vector)SK_FILTER1, "L L^T of S A S + 1 - S");
}

void sk_write_factor_solve(sk_writer *writer, sk_vector dst, sk_vector p) {
    add_call(writer, sk_matrix_solve, dst, p, SK_NONE, "(L L^T)^-1");
}

void sk_write_resistance(sk_writer *writer, sk_vector dst, double a) {
    sk_row row = {.kind = SK_ROW_LINEARISE, .dst = dst, .source = {SK_V}, .coefficient = {a}};
    add_forces(writer, row, force_resistance);
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
