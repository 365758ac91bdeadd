/* Rows of rules that meet: surfaces with each other, whatever the method. */
#include "methods/writer.h"

static bool meets(const sk_force *force) {
    return *force->enabled && force->type->deed == SK_MEETS;
}

bool sk_writes_meetings(const sk_writer *writer) {
    for (size_t i = 0; i < writer->rules->forces.count; i++)
        if (meets(writer->rules->forces.data[i])) return true;
    return false;
}

void sk_write_meetings(sk_writer *writer, sk_meeting_sort sort, sk_vector velocity) {
    for (size_t i = 0; i < writer->rules->forces.count; i++) {
        const sk_force *force = writer->rules->forces.data[i];
        if (!meets(force)) continue;
        const sk_meeting *meeting = force->type->meeting;
        const sk_kernels *kernels[] = {&meeting->begin, &meeting->push, &meeting->bound};
        sk_add_row(writer, (sk_row){.kind = SK_ROW_MEET,
                                    .order = SK_ORDERED,
                                    .kernel = kernels[sort]->version[writer->isa],
                                    .dst = sort == SK_MEETING_BEGIN ? SK_NONE : SK_X,
                                    .source = {SK_X, velocity, SK_NONE},
                                    .rule = force,
                                    .label = force->label,
                                    .end = writer->slot_count});
    }
}
