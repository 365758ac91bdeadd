/* Cutting a plan into passes, and writing a pass as one shader: loads, the ops' texts, stores. */
#include "gpu/compose.h"

#include <stdio.h>

#include "constraints/sweep.h"
#include "gpu/ops.h"

#define BIT(vector) (1u << (vector))

/* The vectors that are kept between steps; all others matter only within one. */
static const uint32_t state_vectors = BIT(SK_X) | BIT(SK_V) | BIT(SK_PREVIOUS);

/* ---- what cannot run ---- */

/* The name of what an op's rule belongs to, for a sweep of a batch: the body or constraint that has the batch. */
static const char *owner_of(const skein_world *world, const sk_op *op, const char **label) {
    for (size_t i = 0; i < world->objects.count; i++) {
        const sk_object *object = world->objects.data[i];
        const sk_batch *const *batches = NULL;
        size_t count = 0;
        if (object->category == SKEIN_BODY)
            batches = (const sk_batch *const *)object->as.body->batch, count = object->as.body->batch_count;
        if (object->category == SKEIN_CONSTRAINT)
            batches = (const sk_batch *const *)(const void *)&object->as.batch, count = 1;
        for (size_t b = 0; b < count; b++)
            if ((const sk_sweep *)op->rule >= batches[b]->sweeps &&
                (const sk_sweep *)op->rule < batches[b]->sweeps + batches[b]->sweep_count)
                return *label = batches[b]->label, object->label;
    }
    return NULL;
}

static skein_status refuse(const skein_world *world, const sk_op *op, const char *why, skein_error *error) {
    const char *label = op->label ? op->label : sk_op_type_of(op)->name, *owner = NULL;
    if (why)
        return sk_fail(error, SKEIN_ERROR_VALUE, "device",
                       "%s cannot run on the graphics card %s: use the processor, --device cpu", label, why);
    owner = owner_of(world, op, &label);
    return sk_fail(error, SKEIN_ERROR_VALUE, "device",
                   "%s%s%s cannot run on the graphics card yet (an op '%s'): use the processor, --device cpu",
                   owner ? owner : "", owner && owner != label ? ": its " : "", owner == label ? "" : label,
                   sk_op_type_of(op)->name);
}

/* ---- cutting ---- */

typedef struct cutter {
    sk_gpu_passes *passes;
    sk_allocator *allocator;
    const skein_world *world;
    size_t pending; /* ops of the list from here on are in no pass yet */
    bool no_memory;
} cutter;

static sk_gpu_pass *add_pass(cutter *c, sk_gpu_pass pass) {
    if (!SK_RESERVE(c->allocator, c->passes, c->passes->count + 1)) return c->no_memory = true, NULL;
    c->passes->data[c->passes->count] = pass;
    return &c->passes->data[c->passes->count++];
}

static uint32_t touched(const sk_op *op) {
    return sk_op_reads(op) | sk_op_writes(op);
}

/* Whether the op reads the neighbours of every particle, among all particles. */
static bool is_everyone(const cutter *c, const sk_op *op) {
    return sk_gpu_op_everyone(op, c->world->particles.count);
}

/* Fills in a pass that begins with op `at` of the list, with as many ops, up to `end`, as fit. */
static void fill_pass(const cutter *c, sk_gpu_pass *pass, size_t at, size_t end) {
    const sk_op *const *ops = c->passes->ops.data;
    uint32_t vectors = 0, written = 0;
    *pass = (sk_gpu_pass){.kind = SK_GPU_SLOTS, .first = at, .block = SK_GPU_HEAD};
    for (; at + pass->count < end; pass->count++) {
        const sk_op *op = ops[at + pass->count];
        bool looks = sk_gpu_op_has_target(op), moves = sk_op_writes(op) & BIT(SK_X);
        bool walks = sk_op_type_of(op)->walks, alone = walks && !is_everyone(c, op);
        // a walk along the grid needs three buffers more
        size_t most = SK_GPU_MOST_VECTORS - (walks || pass->op ? 3 : 0);
        if (pass->count && (alone || ((walks || looks) && written & BIT(SK_X)) || (pass->looks && moves) ||
                            (size_t)__builtin_popcount(vectors | touched(op)) > most ||
                            pass->block + sk_gpu_op_size(op) > SK_GPU_MOST_BLOCK))
            return;
        if (walks) pass->kind = SK_GPU_NEIGHBOURS, pass->op = op;
        pass->looks |= looks;
        vectors |= touched(op);
        written |= sk_op_writes(op);
        pass->block += sk_gpu_op_size(op);
        if (!alone) continue;
        pass->count++;
        return;
    }
}

/* Makes passes of the pending ops before `end`. */
static void flush(cutter *c, size_t end) {
    while (c->pending < end && !c->no_memory) {
        sk_gpu_pass pass;
        fill_pass(c, &pass, c->pending, end);
        if (pass.kind == SK_GPU_NEIGHBOURS) {
            const sk_group *moved = pass.op->group;
            bool everyone = is_everyone(c, pass.op);
            pass.by_place = everyone || moved->first == pass.op->seen->first;
            pass.begin = everyone ? 0 : moved->first;
            pass.end = everyone ? c->world->particles.count : moved->end;
        }
        c->pending += pass.count;
        add_pass(c, pass);
    }
}

/* A kick by a force that has just been cleared. */
static bool does_nothing(const cutter *c, const sk_op *op) {
    const sk_gpu_passes *passes = c->passes;
    if (sk_op_type_of(op)->reverse != SK_REVERSE_KICK || op->dst != op->source[0]) return false;
    for (size_t i = passes->ops.count; i-- > c->pending;) {
        const sk_op *before = passes->ops.data[i];
        if (sk_op_writes(before) >> op->source[1] & 1) return sk_op_clears(before);
    }
    return false;
}

static void add_op(cutter *c, const sk_op *op) {
    if (does_nothing(c, op)) return;
    if (!SK_RESERVE(c->allocator, &c->passes->ops, c->passes->ops.count + 1)) c->no_memory = true;
    else c->passes->ops.data[c->passes->ops.count++] = op;
}

/* A grid: pending ops that it depends on get passes before it, others wait. The grid's own ops are one pass. */
static size_t cut_grid(cutter *c, const sk_op *op, size_t most) {
    size_t end = c->passes->ops.count, count = 1;
    while (end > c->pending && !(sk_op_writes(c->passes->ops.data[end - 1]) & (BIT(SK_X) | BIT(SK_V)))) end--;
    flush(c, end);
    while (count < most && sk_op_type_of(&op[count])->goes_on) count++; // one pass here
    add_pass(c, (sk_gpu_pass){.kind = SK_GPU_GRID, .op = op});
    return count;
}

/* Cuts ops [begin, end) of the plan into passes; repeats may be nested. */
static void cut(cutter *c, const sk_plan *plan, size_t begin, size_t end) {
    for (size_t r = begin; r < end && !c->no_memory;) {
        const sk_op *op = &plan->data[r];
        if (sk_op_type_of(op)->sorts) {
            r += cut_grid(c, op, end - r);
        } else if (op->kind != SK_OP_REPEAT) {
            add_op(c, op);
            r++;
        } else {
            // ops before a single iteration may share its pass
            if (op->end != 1) flush(c, c->passes->ops.count);
            size_t repeat = c->passes->count;
            add_pass(c, (sk_gpu_pass){.kind = SK_GPU_REPEAT, .op = op});
            cut(c, plan, r + 1, r + 1 + op->length);
            if (c->no_memory) return;
            c->passes->data[repeat].count = c->passes->count - repeat - 1;
            r += op->length + 1;
        }
    }
    flush(c, c->passes->ops.count);
}

/* Repeats of one pass whose ops are the same at all times become loops in its shader. */
static void find_loops(sk_gpu_passes *passes) {
    for (size_t i = 0; i + 1 < passes->count; i++) {
        sk_gpu_pass *pass = &passes->data[i + 1];
        if (passes->data[i].kind != SK_GPU_REPEAT || passes->data[i].count != 1 || pass->kind != SK_GPU_SLOTS) continue;
        pass->looped = true;
        for (size_t r = 0; r < pass->count; r++)
            if (sk_gpu_op_moves(passes->ops.data[pass->first + r])) pass->looped = false;
    }
}

/* ---- vectors: what a pass loads, and which of those that it writes are read later ---- */

typedef struct traffic {
    uint32_t uses, loads, writes;
} traffic;

static traffic traffic_of(const sk_gpu_passes *passes, const sk_gpu_pass *pass) {
    traffic t = {0, 0, 0};
    for (size_t r = 0; r < pass->count; r++) {
        const sk_op *op = passes->ops.data[pass->first + r];
        t.loads |= sk_op_reads(op) & ~t.writes;
        t.writes |= sk_op_writes(op);
        t.uses |= touched(op);
    }
    return t;
}

/* ---- texts ---- */

static void put_head(sk_gpu_text *text, const sk_gpu_pass *pass, const sk_op *const *ops) {
    sk_gpu_put(text, "#version 450 core\nlayout(local_size_x = %d) in;\n\n", SK_GPU_GROUP);
    sk_gpu_put(text,
               "layout(std140, binding = 0) uniform ops_block {\n"
               "    uvec4 head; // elements; the first one; iterations; whether the last iteration is the repeat's\n"
               "    vec4 room;\n");
    for (size_t r = 0; r < pass->count; r++) sk_gpu_put_members(text, ops[r], r);
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

static void put_main(sk_gpu_text *text, const sk_gpu_pass *pass, const sk_op *const *ops, const traffic *t,
                     uint32_t stores, size_t particle_count) {
    sk_gpu_put(text, "void main() {\n"
                     "    uint place = (gl_WorkGroupID.y * gl_NumWorkGroups.x + gl_WorkGroupID.x) * gl_WorkGroupSize.x +"
                     " gl_LocalInvocationID.x;\n"
                     "    if (place >= head.x) return;\n");
    sk_gpu_put(text, pass->kind != SK_GPU_NEIGHBOURS ? "    uint slot = place;\n"
                     : pass->by_place                ? "    uint slot = slot_at(place);\n"
                                                     : "    uint slot = slot_of_particle(head.y + place);\n");
    sk_gpu_put(text, "    uint first_slot = %s;\n", pass->kind == SK_GPU_SLOTS ? "head.y" : "0u");
    for (int v = SK_X; v < SK_VECTOR_COUNT; v++) {
        const char *name = sk_gpu_vector_name((sk_vector)v);
        if (!(t->uses >> v & 1)) continue;
        // no fused operations: the correction of a particle in free fall must be exactly 0
        if (t->loads >> v & 1) sk_gpu_put(text, "    precise vec4 %s = at_%s[slot];\n", name, name);
        else sk_gpu_put(text, "    precise vec4 %s = vec4(0);\n", name);
    }
    if (pass->looped)
        sk_gpu_put(
            text,
            "    for (uint iteration = 1u; iteration <= head.z; iteration++) {\n    bool last_iteration = iteration == head.z;\n");
    else sk_gpu_put(text, "    bool last_iteration = head.w != 0u;\n");
    for (size_t r = 0; r < pass->count; r++) sk_gpu_put_statements(text, ops[r], r, particle_count);
    if (pass->looped) sk_gpu_put(text, "    }\n");
    for (int v = SK_X; v < SK_VECTOR_COUNT; v++)
        if (stores >> v & 1)
            sk_gpu_put(text, "    at_%s[slot] = %s;\n", sk_gpu_vector_name((sk_vector)v),
                       sk_gpu_vector_name((sk_vector)v));
    sk_gpu_put(text, "}\n");
}

/* Writes and compiles one pass; `wanted` are the vectors that are loaded later. */
static skein_status make_pass(sk_gpu_passes *passes, sk_gpu_pass *pass, sk_gpu_programs *programs, skein_world *world,
                              bool identity, skein_error *error) {
    const sk_op *const *ops = passes->ops.data + pass->first;
    traffic t = traffic_of(passes, pass);
    uint32_t stores = t.writes & passes->vectors;
    for (int v = SK_X; v < SK_VECTOR_COUNT; v++)
        if ((t.loads | stores) >> v & 1) pass->vector[pass->vector_count++] = (sk_vector)v;
    sk_gpu_text text = {.allocator = &world->allocator};
    put_head(&text, pass, ops);
    put_buffers(&text, pass, t.loads, stores);
    sk_gpu_put_file(&text, "base/arithmetic", 0);
    if (pass->kind == SK_GPU_NEIGHBOURS) {
        sk_gpu_put(&text, "#define IDENTITY %d\n#define BY_PLACE %d\n", identity, pass->by_place);
        sk_gpu_put_file(&text, "gpu/neighbours", 0);
    }
    for (size_t r = 0; r < pass->count; r++) sk_gpu_put_functions(&text, ops, r);
    put_main(&text, pass, ops, &t, stores, world->particles.count);
    const char *what = ops[0]->label ? ops[0]->label : sk_op_type_of(ops[0])->name;
    skein_status status = sk_gpu_program(programs, &world->allocator, &text, what, &pass->program, error);
    sk_release(&world->allocator, text.data);
    return status;
}

skein_status sk_gpu_compose(sk_gpu_passes *passes, sk_gpu_programs *programs, skein_world *world, bool identity,
                            skein_error *error) {
    const sk_plan *plan = &world->plan;
    passes->count = passes->ops.count = 0;
    for (size_t r = 0; r < plan->count; r++) {
        const char *why = NULL;
        if (!sk_gpu_op_can(&plan->data[r], &why)) return refuse(world, &plan->data[r], why, error);
    }
    cutter c = {.passes = passes, .allocator = &world->allocator, .world = world};
    cut(&c, plan, 0, plan->count);
    if (c.no_memory) return sk_fail_memory(error, "the passes");
    find_loops(passes);
    passes->vectors = state_vectors;
    for (size_t i = 0; i < passes->count; i++) passes->vectors |= traffic_of(passes, &passes->data[i]).loads;
    for (size_t i = 0; i < passes->count; i++) {
        sk_gpu_pass *pass = &passes->data[i];
        if (pass->kind != SK_GPU_SLOTS && pass->kind != SK_GPU_NEIGHBOURS) continue;
        skein_status status = make_pass(passes, pass, programs, world, identity, error);
        if (status) return status;
    }
    return SKEIN_OK;
}

void sk_gpu_pack(const sk_gpu_passes *passes, const sk_gpu_pass *pass, const sk_run *run, float (*block)[4]) {
    size_t at = SK_GPU_HEAD;
    for (size_t r = 0; r < pass->count; r++) {
        const sk_op *op = passes->ops.data[pass->first + r];
        sk_gpu_op_pack(op, run, block + at);
        at += sk_gpu_op_size(op);
    }
}
