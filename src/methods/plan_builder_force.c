/* Ops that add up forces: those on particles, triangles and pairs of neighbours, and those of constraints. */
#include "constraints/sweep.h"
#include "methods/plan_builder.h"
#include "particles/surface.h"

bool sk_pushes(const sk_force *force) {
    return *force->enabled && force->type->phase == SK_PUSHES;
}

/* The largest radius of the enabled neighbour rules that share cells; 0 if there is none. */
static double widest_radius(const sk_rules *rules) {
    double widest = 0;
    for (size_t i = 0; i < rules->forces.count; i++) {
        const sk_force *force = rules->forces.data[i];
        if (!sk_pushes(force) || force->type->domain != SK_OVER_NEIGHBOURS || force->only.some) continue;
        double radius = force->type->radius(force->params);
        if (radius > widest) widest = radius;
    }
    return widest;
}

/* Whether a rule acts on the body whose strips these are; no other body has slots there. */
static bool acts_on_strips(const sk_only *only, const sk_walk *walk) {
    size_t end = walk->first_slot + walk->rows * walk->width * SK_LANES;
    for (size_t i = 0; i < only->count; i++)
        if (only->data[i].first_slot < end && only->data[i].end_slot > walk->first_slot) return true;
    return !only->some;
}

/* Adds an op for the triangles of each patch, and one for the rest: of all bodies, or of those that the rule names.
 * Neighbouring triangles add to the same corners, so the ops are ordered. */
static void add_surface(sk_plan_builder *builder, sk_op op, const sk_force *force) {
    const sk_surface *surface = builder->surface;
    const sk_only *only = &force->only;
    sk_op along = op;
    op.order = along.order = SK_ORDERED;
    along.kernel = force->type->over_patch.version[builder->isa];
    for (size_t i = 0; i < surface->patch_count; i++) {
        const sk_patch *patch = &surface->patches[i];
        if (!patch->has || !acts_on_strips(only, &patch->walk)) continue;
        along.patch = patch;
        along.walk = patch->walk;
        along.end = patch->walk.rows - patch->walk.reach;
        sk_add_op(builder, along);
    }
    for (size_t i = 0; i < (only->some ? only->count : 1); i++) {
        op.begin = only->some ? sk_surface_rest_from(surface, only->data[i].first_triangle) : 0;
        op.end = only->some ? sk_surface_rest_from(surface, only->data[i].end_triangle) : surface->rest.count;
        if (op.begin < op.end) sk_add_op(builder, op);
    }
}

/* Adds a force's op, or one for each body that it names. */
static void add_field(sk_plan_builder *builder, sk_op op, const sk_force *force) {
    const sk_only *only = &force->only;
    if (force->type->domain == SK_OVER_TRIANGLES) {
        add_surface(builder, op, force);
    } else if (only->some && force->type->domain == SK_OVER_NEIGHBOURS) {
        // cells of its own, so that other rules' sums do not depend on its radius; the kernel skips other bodies
        if (only->count) sk_write_cells(builder, builder->everybody, force->type->radius(force->params));
        if (only->count) sk_add_op(builder, op);
    } else {
        sk_add_op_on(builder, op, only);
    }
}

/* Whether a force is a neighbour rule on some bodies only. Such rules come last: they sort cells of their own. */
static bool comes_late(const sk_force *force) {
    return force->only.some && force->type->domain == SK_OVER_NEIGHBOURS;
}

void sk_write_fields(sk_plan_builder *builder) {
    const sk_rules *rules = builder->rules;
    bool first = true; // forces like gravity set F if they come first; others add to F = 0
    double radius = widest_radius(rules);
    if (radius > 0) sk_write_cells(builder, builder->everybody, radius);
    for (size_t n = 0; n < 2 * rules->forces.count; n++) {
        const sk_force *force = rules->forces.data[n % rules->forces.count];
        if (!sk_pushes(force) || comes_late(force) != (n >= rules->forces.count)) continue;
        bool sets = first && force->type->sets && !force->only.some;
        if (first && !sets) sk_write_clear(builder, SK_F);
        first = false;
        sk_op op = {.kind = SK_OP_FIELD,
                    .order = SK_FREE,
                    .kernel = force->type->kernel.version[builder->isa],
                    .dst = SK_F,
                    .source = {SK_X, SK_V},
                    .rule = force,
                    .label = force->label,
                    .end = builder->slot_count};
        if (force->type->domain == SK_OVER_NEIGHBOURS) {
            op.kind = SK_OP_NEIGHBOUR;
            op.by_particle = true;
            op.end = builder->particle_count;
        }
        op.sets = sets;
        add_field(builder, op, force);
    }
    if (first) sk_write_clear(builder, SK_F);
}

size_t sk_rows_of_sweep(const sk_sweep *sweep, size_t reach) {
    return sweep->strips ? sweep->walk.rows - reach : sweep->slab_start ? sweep->walk.rows : sweep->group_count;
}

/* Adds one op for all sweeps of a batch along the same strips: it computes each strip row's sum as a whole, and so is
 * free. Leaves `first` at the first sweep that is not in strips. */
static void add_strip_sums(sk_plan_builder *builder, const sk_batch *batch, size_t *first, const sk_op *model,
                           const sk_sweep_kernels *kernels) {
    for (; *first < batch->sweep_count && batch->sweeps[*first].strips; *first += batch->sweeps[*first].together) {
        const sk_sweep *sweep = &batch->sweeps[*first];
        sk_op op = *model;
        op.order = SK_FREE;
        op.kernel = kernels->strips.version[builder->isa];
        op.rule = sweep;
        op.label = batch->label;
        op.walk = sweep->walk;
        op.end = sweep->walk.rows;
        for (size_t i = 1; i < sweep->together; i++)
            if (sweep[i].walk.reach > op.walk.reach) op.walk.reach = sweep[i].walk.reach;
        sk_add_op(builder, op);
    }
}

void sk_add_sums(sk_plan_builder *builder, const sk_batch *batch, sk_op op, const sk_sweep_kernels *kernels) {
    size_t first = 0;
    add_strip_sums(builder, batch, &first, &op, kernels);
    op.order = SK_ORDERED;
    op.kernel = kernels->groups.version[builder->isa];
    for (; first < batch->sweep_count; first++) {
        const sk_sweep *sweep = &batch->sweeps[first];
        op.rule = sweep;
        op.label = sweep->label;
        op.walk = sweep->walk;
        op.end = sk_rows_of_sweep(sweep, sweep->walk.reach);
        sk_add_op(builder, op);
    }
}

void sk_write_forces(sk_plan_builder *builder) {
    for (size_t i = 0; i < builder->rules->batches.count; i++) {
        const sk_batch *batch = builder->rules->batches.data[i];
        sk_op op = {.kind = SK_OP_FORCE, .dst = SK_F, .source = {SK_X, SK_V}, .coefficient = {1}};
        if (sk_batch_pulls(batch)) sk_add_sums(builder, batch, op, &batch->type->force);
    }
}

bool sk_writes_forces(const sk_plan_builder *builder) {
    const sk_rules *rules = builder->rules;
    bool any = !sk_writes_steering(rules);
    for (size_t i = 0; i < rules->forces.count; i++) any |= sk_pushes(rules->forces.data[i]);
    for (size_t i = 0; i < rules->batches.count; i++) any |= sk_batch_pulls(rules->batches.data[i]);
    return any || sk_writes_contacts(rules);
}

bool sk_writes_velocity_forces(const sk_plan_builder *builder) {
    const sk_rules *rules = builder->rules;
    for (size_t i = 0; i < rules->batches.count; i++)
        if (sk_batch_pulls(rules->batches.data[i]) && sk_batch_damping_time(rules->batches.data[i]) > 0) return true;
    for (size_t i = 0; i < rules->forces.count; i++)
        if (sk_pushes(rules->forces.data[i]) && sk_force_on_velocity(rules->forces.data[i])) return true;
    return false;
}

const sk_batch *sk_first_rigid_batch(const sk_rules *rules) {
    for (size_t i = 0; i < rules->batches.count; i++) {
        const sk_batch *batch = rules->batches.data[i];
        const sk_material *material = batch->params;
        if (sk_batch_is_on(batch) && material->stiffness >= SK_UNBOUNDED) return batch;
    }
    return NULL;
}
