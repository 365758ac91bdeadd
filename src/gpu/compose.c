#include "gpu/compose.h"

#include <stdio.h>

#include "constraints/sweep.h"
#include "gpu/rows.h"

#define BIT(vector) (1u << (vector))

/* What users see of a state; all other vectors matter only within a step. */
static const uint32_t state_vectors = BIT(SK_X) | BIT(SK_V) | BIT(SK_PREVIOUS);

/* ---- what cannot run ---- */

/* The name of what a row's rule belongs to, for a sweep of a batch: the body or constraint that has the batch. */
static const char *owner_of(const skein_world *world, const sk_row *row, const char **label) {
    for (size_t i = 0; i < world->objects.count; i++) {
        const sk_object *object = world->objects.data[i];
        if (!(object->generation % 2)) continue;
        const sk_batch *const *batches = NULL;
        size_t count = 0;
        if (object->category == SKEIN_BODY)
            batches = (const sk_batch *const *)object->as.body->batch, count = object->as.body->batch_count;
        if (object->category == SKEIN_CONSTRAINT)
            batches = (const sk_batch *const *)(const void *)&object->as.batch, count = 1;
        for (size_t b = 0; b < count; b++)
            if ((const sk_sweep *)row->rule >= batches[b]->sweeps &&
                (const sk_sweep *)row->rule < batches[b]->sweeps + batches[b]->sweep_count)
                return *label = batches[b]->label, object->label;
    }
    return NULL;
}

static skein_status refuse(const skein_world *world, const sk_row *row, skein_error *error) {
    const char *label = row->label ? row->label : sk_row_kind_text(row->kind), *owner = NULL;
    if (row->kind == SK_ROW_FORCE || row->kind == SK_ROW_PROJECT || row->kind == SK_ROW_LIMIT ||
        row->kind == SK_ROW_MULTIPLIER)
        owner = owner_of(world, row, &label);
    return sk_fail(error, SKEIN_ERROR_VALUE, "device",
                   "%s%s%s cannot run on the graphics card yet (a row '%s'): use the processor, --device cpu",
                   owner ? owner : "", owner && owner != label ? ": its " : "", owner == label ? "" : label,
                   sk_row_kind_text(row->kind));
}

/* ---- cutting ---- */

static uint32_t touched(const sk_row *row) {
    sk_gpu_use use = sk_gpu_row_use(row);
    return use.reads | use.writes;
}

static size_t count_bits(uint32_t bits) {
    return (size_t)__builtin_popcount(bits);
}

/* How many rows from the first on make one pass; none lies behind `end`. */
static size_t pass_length(const sk_row *rows, size_t count, sk_gpu_pass_kind *kind, size_t *block) {
    uint32_t vectors = 0;
    size_t length = 0;
    *kind = SK_GPU_SLOTS;
    *block = SK_GPU_HEAD;
    for (; length < count; length++) {
        const sk_row *row = &rows[length];
        if (row->kind == SK_ROW_GRID || row->kind == SK_ROW_REPEAT) break;
        // a walk along the grid needs three buffers more
        bool walks = *kind == SK_GPU_NEIGHBOURS || row->kind == SK_ROW_NEIGHBOUR;
        size_t size = *block + sk_gpu_row_size(row), most = SK_GPU_MOST_VECTORS - (walks ? 3 : 0);
        if (length && (count_bits(vectors | touched(row)) > most || size > SK_GPU_MOST_BLOCK)) break;
        if (row->kind == SK_ROW_NEIGHBOUR) *kind = SK_GPU_NEIGHBOURS;
        vectors |= touched(row);
        *block = size;
    }
    return length;
}

static bool add_pass(sk_gpu_passes *passes, sk_allocator *allocator, sk_gpu_pass pass) {
    if (!SK_RESERVE(allocator, passes, passes->count + 1)) return false;
    passes->data[passes->count++] = pass;
    return true;
}

/* Cuts rows [begin, end) of the plan; repeats lie within each other. */
static bool cut(sk_gpu_passes *passes, sk_allocator *allocator, const sk_plan *plan, size_t begin, size_t end) {
    for (size_t r = begin; r < end;) {
        const sk_row *row = &plan->data[r];
        if (row->kind == SK_ROW_REPEAT) {
            size_t repeat = passes->count;
            if (!add_pass(passes, allocator, (sk_gpu_pass){.kind = SK_GPU_REPEAT, .first = r}) ||
                !cut(passes, allocator, plan, r + 1, r + 1 + row->length))
                return false;
            passes->data[repeat].count = passes->count - repeat - 1;
            r += row->length + 1;
            continue;
        }
        sk_gpu_pass pass = {.kind = SK_GPU_GRID, .first = r, .count = 1};
        if (row->kind != SK_ROW_GRID) pass.count = pass_length(row, end - r, &pass.kind, &pass.block);
        if (!add_pass(passes, allocator, pass)) return false;
        r += pass.count;
    }
    return true;
}

/* Repeats of one pass whose rows are the same at all times become loops in its shader. */
static void find_loops(sk_gpu_passes *passes, const sk_plan *plan) {
    for (size_t i = 0; i + 1 < passes->count; i++) {
        sk_gpu_pass *pass = &passes->data[i + 1];
        if (passes->data[i].kind != SK_GPU_REPEAT || passes->data[i].count != 1 || pass->kind != SK_GPU_SLOTS) continue;
        pass->looped = true;
        for (size_t r = 0; r < pass->count; r++)
            if (sk_gpu_row_moves(&plan->data[pass->first + r])) pass->looped = false;
    }
}

/* ---- vectors: what a pass loads, and what of that which it writes somebody will read ---- */

typedef struct traffic {
    uint32_t uses, loads, writes;
} traffic;

static traffic traffic_of(const sk_gpu_pass *pass, const sk_plan *plan) {
    traffic t = {0, 0, 0};
    for (size_t r = 0; r < pass->count; r++) {
        sk_gpu_use use = sk_gpu_row_use(&plan->data[pass->first + r]);
        t.loads |= use.reads & ~t.writes;
        t.writes |= use.writes;
        t.uses |= use.reads | use.writes;
    }
    return t;
}

/* ---- texts ---- */

static void put_head(sk_gpu_text *text, const sk_gpu_pass *pass, const sk_row *rows) {
    sk_gpu_put(text, "#version 450 core\nlayout(local_size_x = %d) in;\n\n", SK_GPU_GROUP);
    sk_gpu_put(text, "layout(std140, binding = 0) uniform rows_block {\n"
                     "    uvec4 head; // elements; the first one; turns; whether the last turn is the repeat's\n"
                     "    vec4 room;\n");
    for (size_t r = 0; r < pass->count; r++) sk_gpu_put_members(text, &rows[r], r);
    sk_gpu_put(text, "};\n\n");
}

static void put_buffers(sk_gpu_text *text, const sk_gpu_pass *pass, uint32_t loads, uint32_t stores) {
    for (size_t i = 0; i < pass->vector_count; i++) {
        const char *name = sk_gpu_vector_name(pass->vector[i]);
        bool load = loads >> pass->vector[i] & 1, store = stores >> pass->vector[i] & 1;
        sk_gpu_put(text, "layout(std430, binding = %zu) restrict %sbuffer block_%s { vec4 at_%s[]; };\n", i,
                   !store  ? "readonly "
                   : !load ? "writeonly "
                           : "",
                   name, name);
    }
    sk_gpu_put(text, "\n");
}

static void put_main(sk_gpu_text *text, const sk_gpu_pass *pass, const sk_row *rows, const traffic *t,
                     uint32_t stores) {
    sk_gpu_put(text, "void main() {\n"
                     "    uint place = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * gl_WorkGroupSize.x +"
                     " gl_LocalInvocationID.x;\n"
                     "    if (place >= head.x) return;\n");
    sk_gpu_put(text, pass->kind == SK_GPU_NEIGHBOURS ? "    uint slot = slot_at(place);\n" : "    uint slot = place;\n");
    for (int v = SK_X; v < SK_VECTOR_COUNT; v++) {
        const char *name = sk_gpu_vector_name((sk_vector)v);
        if (!(t->uses >> v & 1)) continue;
        // no fused operations: what falls freely must be found just where it was predicted
        if (t->loads >> v & 1) sk_gpu_put(text, "    precise vec4 %s = at_%s[slot];\n", name, name);
        else sk_gpu_put(text, "    precise vec4 %s = vec4(0);\n", name);
    }
    if (pass->looped)
        sk_gpu_put(text, "    for (uint turn = 1u; turn <= head.z; turn++) {\n    bool last_turn = turn == head.z;\n");
    else sk_gpu_put(text, "    bool last_turn = head.w != 0u;\n");
    for (size_t r = 0; r < pass->count; r++) sk_gpu_put_statements(text, &rows[r], r);
    if (pass->looped) sk_gpu_put(text, "    }\n");
    for (int v = SK_X; v < SK_VECTOR_COUNT; v++)
        if (stores >> v & 1)
            sk_gpu_put(text, "    at_%s[slot] = %s;\n", sk_gpu_vector_name((sk_vector)v),
                       sk_gpu_vector_name((sk_vector)v));
    sk_gpu_put(text, "}\n");
}

/* Writes and compiles one pass; `wanted` are the vectors that somebody loads. */
static skein_status make_pass(sk_gpu_pass *pass, sk_gpu_programs *programs, skein_world *world, uint32_t wanted,
                              bool identity, skein_error *error) {
    const sk_row *rows = &world->plan.data[pass->first];
    traffic t = traffic_of(pass, &world->plan);
    uint32_t stores = t.writes & wanted;
    for (int v = SK_X; v < SK_VECTOR_COUNT; v++)
        if ((t.loads | stores) >> v & 1) pass->vector[pass->vector_count++] = (sk_vector)v;
    sk_gpu_text text = {.allocator = &world->allocator};
    put_head(&text, pass, rows);
    put_buffers(&text, pass, t.loads, stores);
    if (pass->kind == SK_GPU_NEIGHBOURS) {
        sk_gpu_put(&text, "#define IDENTITY %d\n", identity);
        sk_gpu_put_file(&text, "gpu/neighbours", 0);
    }
    for (size_t r = 0; r < pass->count; r++) sk_gpu_put_functions(&text, &rows[r], r);
    put_main(&text, pass, rows, &t, stores);
    const char *what = rows[0].label ? rows[0].label : sk_row_kind_text(rows[0].kind);
    skein_status status = sk_gpu_program(programs, &world->allocator, &text, what, &pass->program, error);
    sk_release(&world->allocator, text.data);
    return status;
}

skein_status sk_gpu_compose(sk_gpu_passes *passes, sk_gpu_programs *programs, skein_world *world, bool identity,
                            skein_error *error) {
    const sk_plan *plan = &world->plan;
    passes->count = 0;
    for (size_t r = 0; r < plan->count; r++)
        if (!sk_gpu_row_can(&plan->data[r])) return refuse(world, &plan->data[r], error);
    if (!cut(passes, &world->allocator, plan, 0, plan->count)) return sk_fail_memory(error, "the passes");
    find_loops(passes, plan);
    uint32_t wanted = state_vectors;
    for (size_t i = 0; i < passes->count; i++) {
        const sk_gpu_pass *pass = &passes->data[i];
        if (pass->kind != SK_GPU_REPEAT) wanted |= traffic_of(pass, plan).loads;
    }
    passes->vectors = wanted;
    for (size_t i = 0; i < passes->count; i++) {
        sk_gpu_pass *pass = &passes->data[i];
        if (pass->kind != SK_GPU_SLOTS && pass->kind != SK_GPU_NEIGHBOURS) continue;
        skein_status status = make_pass(pass, programs, world, wanted, identity, error);
        if (status) return status;
    }
    return SKEIN_OK;
}

void sk_gpu_pack(const sk_gpu_pass *pass, const sk_plan *plan, double time, float (*block)[4]) {
    size_t at = SK_GPU_HEAD;
    for (size_t r = 0; r < pass->count; r++) {
        const sk_row *row = &plan->data[pass->first + r];
        sk_gpu_row_pack(row, time, block + at);
        at += sk_gpu_row_size(row);
    }
}
