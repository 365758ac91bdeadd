/* Rows of rules that steer: what adds to velocities once a substep, whatever the method.
 *
 *   S = 0                       what the rules ask for; in w, how much more speed is allowed
 *   grid (four rows)            who is near whom, for each rule that looks at neighbours: it sorts its own particles
 *   S += neighbours, then all other rules that steer, in the order of their making: all look at the same X and V
 *   V += S
 *   V bounded                   speed limits and the like
 *
 * Methods that kick and then drift call this between the two, others before all else in a substep. */
#include "methods/writer.h"
#include "plan/sort.h"

static bool is_on(const sk_force *force, sk_deed deed) {
    return *force->enabled && force->type->deed == deed && force->moved.first < force->moved.end;
}

static bool has(const sk_rules *rules, sk_deed deed) {
    for (size_t i = 0; i < rules->forces.count; i++)
        if (is_on(rules->forces.data[i], deed)) return true;
    return false;
}

bool sk_writes_steering(const sk_rules *rules) {
    return has(rules, SK_STEERS) || has(rules, SK_BOUNDS);
}

void sk_write_cells(sk_writer *writer, const sk_group *group, double radius) {
    for (int i = 0; i < SK_SORT_ROWS; i++) {
        const sk_sort_row *part = &sk_sort_rows[i];
        sk_add_row(writer,
                   (sk_row){.kind = SK_ROW_GRID,
                            .order = part->order,
                            .kernel = part->kernels.version[writer->isa],
                            .source = {SK_X, SK_V},
                            .coefficient = {radius},
                            .group = group,
                            .label = part->label,
                            .by_particle = true,
                            .begin = part->by_place ? 0 : group->first_slot / 16 * 16,
                            .end = part->by_place ? group->end - group->first : (group->end_slot + 15) / 16 * 16});
    }
}

/* ---- the rules ---- */

/* A row over the blocks of slots that the rule's particles lie in. */
static sk_row row_of_slots(const sk_writer *writer, const sk_force *force) {
    return (sk_row){.order = SK_FREE,
                    .kernel = force->type->kernel.version[writer->isa],
                    .rule = force,
                    .label = force->label,
                    .begin = force->moved.first_slot / 16 * 16,
                    .end = (force->moved.end_slot + 15) / 16 * 16};
}

static void write_neighbours(sk_writer *writer, const sk_force *force) {
    double radius = force->type->radius(force->params);
    if (!(radius > 0) || force->seen.first == force->seen.end) return; // there are no neighbours
    bool among = force->moved.first == force->seen.first && force->moved.end == force->seen.end;
    sk_write_cells(writer, &force->seen, radius);
    sk_add_row(writer, (sk_row){.kind = SK_ROW_NEIGHBOUR,
                                .order = SK_FREE,
                                .kernel = force->type->kernel.version[writer->isa],
                                .dst = SK_S,
                                .source = {SK_X, SK_V},
                                .rule = force,
                                .label = force->label,
                                .by_particle = true,
                                .begin = among ? 0 : force->moved.first,
                                .end = among ? force->moved.end - force->moved.first : force->moved.end});
}

static void write_fields(sk_writer *writer, const sk_force *force) {
    sk_row row = row_of_slots(writer, force);
    row.kind = SK_ROW_FIELD;
    row.dst = SK_S;
    row.source[0] = SK_X;
    row.source[1] = SK_V;
    row.alone = sk_force_particle(force) >= 0;
    sk_add_row(writer, row);
}

/* A row for each collider. */
static void write_lookouts(sk_writer *writer, const sk_force *force) {
    for (size_t i = 0; i < writer->rules->colliders.count; i++) {
        const sk_collider *collider = writer->rules->colliders.data[i];
        if (!collider->common->enabled) continue;
        sk_row row = row_of_slots(writer, force);
        row.kind = SK_ROW_FIELD;
        row.kernel = sk_avoid.version[writer->isa];
        row.dst = SK_S;
        row.source[0] = SK_X;
        row.source[1] = SK_V;
        row.rule = collider;
        row.group = &force->moved;
        row.label = collider->label;
        force->type->look(force->params, row.coefficient);
        sk_add_row_on(writer, row, &collider->only);
    }
}

static void write_bounds(sk_writer *writer, bool again) {
    const sk_rules *rules = writer->rules;
    for (size_t i = 0; i < rules->forces.count; i++) {
        const sk_force *force = rules->forces.data[i];
        if (!is_on(force, SK_BOUNDS) || (again && force->type->once)) continue;
        sk_row row = row_of_slots(writer, force);
        row.kind = SK_ROW_LIMIT;
        row.dst = SK_V;
        row.source[0] = SK_X;
        row.source[1] = SK_V;
        row.source[2] = has(rules, SK_STEERS) ? SK_S : SK_NONE;
        sk_add_row(writer, row);
    }
}

void sk_write_bounds(sk_writer *writer) {
    write_bounds(writer, true);
}

static void write_combine(sk_writer *writer, const sk_kernels *kernels, sk_vector dst, sk_vector p, sk_vector q,
                          const char *label) {
    sk_add_row(writer, (sk_row){.kind = SK_ROW_COMBINE,
                                .order = SK_FREE,
                                .kernel = kernels->version[writer->isa],
                                .dst = dst,
                                .source = {p, q},
                                .label = label,
                                .end = writer->slot_count});
}

void sk_write_steering(sk_writer *writer) {
    const sk_rules *rules = writer->rules;
    if (has(rules, SK_STEERS)) {
        write_combine(writer, &sk_combine_wipe, SK_S, SK_NONE, SK_NONE, "0");
        for (int neighbours = 1; neighbours >= 0; neighbours--)
            for (size_t i = 0; i < rules->forces.count; i++) {
                const sk_force *force = rules->forces.data[i];
                if (!is_on(force, SK_STEERS) || (force->type->domain == SK_OVER_NEIGHBOURS) != neighbours) continue;
                if (neighbours) write_neighbours(writer, force);
                else if (force->type->domain == SK_OVER_COLLIDERS) write_lookouts(writer, force);
                else write_fields(writer, force);
            }
        write_combine(writer, &sk_combine_steer, SK_V, SK_V, SK_S, "V + S, where free");
    }
    write_bounds(writer, false);
}
