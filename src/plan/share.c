/* Sorts of a world that has a part of a run: the border, cells of the whole run's box, and the whole run's order in them. */
#include "plan/share.h"
#include "plan/sort.h"

/* The frame of cells for `everybody`, so many, in the box, with places for the group's particles. False: no memory. */
static bool frame_of_all(sk_cells *cells, sk_allocator *allocator, const skein_border *border, const sk_group *group, real radius) {
    sk_group all = *group;
    all.out = (group->end - group->first) - border->everybody; // which may be fewer than none: it is taken off again
    if (!sk_cells_frame_box(cells, allocator, sk_v3(border->low[0], border->low[1], border->low[2]),
                            sk_v3(border->high[0], border->high[1], border->high[2]), &all, radius))
        return false;
    cells->group = *group;
    cells->in_order = false;
    size_t layers = ((size_t)cells->count_y + (size_t)cells->layer - 1) / (size_t)cells->layer;
    size_t count = (size_t)cells->count_x * (size_t)cells->layer * layers * (size_t)cells->count_z;
    return sk_reserve(allocator, (void **)&cells->start, &cells->start_capacity, count + 2, sizeof *cells->start);
}

/* Has the blocks of strips in quads, as the program knows slots, or packed again. */
static void lay(sk_run *run, const sk_op *op, bool quads) {
    const sk_share *share = op->rule;
    const sk_kernels *kernels = quads ? &sk_unpack : &sk_pack;
    static const sk_vector vectors[] = {SK_X, SK_V};
    if (op->packed <= op->group->first_slot && op->packed <= op->seen->first_slot) return; // nobody is asked about
    for (size_t i = 0; i < sizeof vectors / sizeof *vectors; i++) {
        const sk_op blocks = {.dst = vectors[i], .source = {vectors[i]}, .end = op->packed};
        kernels->version[share->isa](run, &blocks, 0, op->packed);
    }
}

static void exchange(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    sk_share *share = (sk_share *)(uintptr_t)op->rule;
    skein_border border = {.everybody = 1};
    const skein_share_look look = {op->seen->first, op->seen->end, op->group->first, op->group->end};
    const skein_state state = {run->particle_count, run->slot_count, run->slot_of, run->particle_of,
                               (skein_real(*)[4])(void *)run->vector[SK_X], (skein_real(*)[4])(void *)run->vector[SK_V]};
    lay(run, op, true);
    share->failed = share->failed || !share->given.measure(share->given.user, &look, &state, &border);
    sk_cells *cells = run->cells;
    if (border.alone) {
        lay(run, op, false);
        share->frame(run, op, begin, end);
        cells->in_order = false;
        return;
    }
    if (!frame_of_all(cells, run->allocator, &border, op->group, (real)op->coefficient[0])) {
        run->no_memory = true;
        lay(run, op, false);
        return;
    }
    // candidates lie in whole cells (space/cells_wide.h): one more along y and z, and along x those of the reach
    const skein_cells shown = {{cells->origin.x, cells->origin.y, cells->origin.z},
                               {cells->per_x, cells->per_yz, cells->per_yz},
                               {cells->count_x, cells->count_y, cells->count_z},
                               {SK_CELLS_ACROSS + 1, 1, 1}};
    share->failed = share->failed || !share->given.exchange(share->given.user, &look, &shown, &state);
    lay(run, op, false);
}

/* Members of a cell, by their numbers in the whole run. They are few, or in order but for few. */
static void put_in_order(uint32_t *slot, size_t count, const uint32_t *number, const uint32_t *particle_of) {
    for (size_t k = 1; k < count; k++) {
        uint32_t moved = slot[k], own = number[particle_of[moved]];
        size_t at = k;
        for (; at > 0 && number[particle_of[slot[at - 1]]] > own; at--) slot[at] = slot[at - 1];
        slot[at] = moved;
    }
}

static void copy(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    const sk_share *share = op->rule;
    sk_cells *cells = run->cells;
    sk_state state = {run->vector[SK_X], run->vector[SK_V], op->packed, run->particle_of};
    if (run->no_memory) return;
    sk_cells_settle(cells, &state, begin, end, &begin, &end);
    for (size_t place = begin, next; place < end; place = next) {
        uint32_t cell = cells->cell[cells->slot[place] - cells->group.first_slot];
        for (next = place + 1; next < end && cells->cell[cells->slot[next] - cells->group.first_slot] == cell;) next++;
        put_in_order(cells->slot + place, next - place, share->given.number, run->particle_of);
    }
    sk_cells_copy(cells, &state, begin, end);
}

/* Who looks into the cells of the sort at `place`: the group of the rule that steers by them, or where rules push, of which
 * several share a sort, all that are in them. */
static const sk_group *who_looks(const sk_plan *plan, size_t place) {
    for (size_t r = place + SK_SORT_OPS; r < plan->count && !sk_op_type_of(&plan->data[r])->sorts; r++)
        if (sk_op_type_of(&plan->data[r])->walks && plan->data[r].group) return plan->data[r].group;
    return plan->data[place].group;
}

void sk_share_plan(sk_plan *plan, sk_share *share, sk_isa isa) {
    share->isa = isa;
    for (size_t r = 0; r + SK_SORT_OPS <= plan->count; r++) {
        sk_op *first = &plan->data[r], *last = first + SK_SORT_OPS - 1;
        if (!sk_op_type_of(first)->sorts) continue;
        first->seen = who_looks(plan, r);
        share->frame = first->kernel;
        first->kernel = exchange, first->rule = share, first->label = "border, frame of cells";
        last->kernel = copy, last->rule = share;
    }
}

bool sk_op_can_be_shared(const sk_op *op) {
    const sk_op_type *type = sk_op_type_of(op);
    bool of_slots = type->reads || (type->arithmetic && type->kernels) || type->rule == SK_RULE_COLLIDER;
    return !op->alone && (of_slots || op->kind == SK_OP_REPEAT || sk_op_is_joined(op));
}

bool sk_op_is_joined(const sk_op *op) {
    static const sk_op_kind kinds[] = {SK_OP_PACK,       SK_OP_UNPACK, SK_OP_FORCE, SK_OP_PROJECT,
                                       SK_OP_MULTIPLIER, SK_OP_LIMIT};
    for (size_t i = 0; i < sizeof kinds / sizeof *kinds; i++)
        if (op->kind == kinds[i]) return true;
    return false;
}
