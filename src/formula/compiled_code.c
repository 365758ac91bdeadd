/* The hash by which two formulas are the same, and the check that compiled code matches its text and may run here. */
#include "formula/compiled_code.h"

#include <string.h>

#include "base/hash.h"
#include "base/status.h"

/* ---- which formulas are the same ---- */

static uint64_t hash_text(uint64_t hash, const char *text) {
    for (; *text; text++) hash = sk_hash_word(hash, (unsigned char)*text);
    return sk_hash_word(hash, 0);
}

static uint64_t hash_node(uint64_t hash, const skein_formula *f, sk_node node, const uint32_t *number) {
    const sk_graph_node *n = &f->graph.data[node];
    uint64_t bits;
    memcpy(&bits, &n->value, sizeof bits);
    hash = sk_hash_word(hash, n->op);
    if (n->op == SK_NODE_CONSTANT) return sk_hash_word(hash, bits);
    if (n->op == SK_NODE_INPUT) return sk_hash_word(hash, n->arg[0]);
    if (n->op == SK_NODE_PARAMETER && n->arg[0] < (uint32_t)f->parameters)
        return hash_text(hash, f->parameter_name[n->arg[0]]);
    if (n->op == SK_NODE_PARAMETER) return sk_hash_word(hash, n->arg[0] - (uint32_t)f->parameters);
    for (int k = 0; k < sk_node_op_info[n->op].arity; k++) hash = sk_hash_word(hash, number[n->arg[k]]);
    return hash;
}

/* Lists all nodes that are computed for an element; returns how many. */
static size_t outputs_of(const skein_formula *f, sk_node *outputs) {
    size_t count = 0, coordinates = 3 * (size_t)f->particles;
    for (int k = 0; k < f->size; k++) {
        outputs[count++] = f->value[k];
        outputs[count++] = f->by_time[k];
        for (size_t i = 0; i < coordinates; i++) outputs[count++] = f->by_position[k][i];
    }
    for (size_t i = 0; i < coordinates * coordinates && f->hessian; i++) outputs[count++] = f->hessian[i];
    return count;
}

skein_status sk_formula_find_hash(skein_formula *f, skein_error *error) {
    sk_node outputs[SK_FORMULA_MOST_OUTPUTS + SK_INPUT_VELOCITY * SK_INPUT_VELOCITY];
    size_t output_count = outputs_of(f, outputs);
    bool *live = sk_allocate(f->allocator, f->graph.count * sizeof *live);
    uint32_t *number = sk_allocate(f->allocator, f->graph.count * sizeof *number), next = 0;
    if (live && number) {
        sk_graph_mark(&f->graph, outputs, output_count, live);
        uint64_t hash =
            sk_hash_word(SK_HASH_START, (uint64_t)f->particles << 32 | (uint64_t)f->rests << 16 |
                                            (uint64_t)f->size << 8 | (f->hessian ? 2 : 0) | (f->at_least_zero ? 1 : 0));
        for (size_t i = 0; i < f->graph.count; i++) {
            if (!live[i]) continue;
            hash = hash_node(hash, f, (sk_node)i, number);
            number[i] = next++;
        }
        for (size_t i = 0; i < output_count; i++) hash = sk_hash_word(hash, number[outputs[i]]);
        f->hash = sk_hash_mix(hash);
    }
    bool good = live && number;
    sk_release(f->allocator, live);
    sk_release(f->allocator, number);
    return good ? SKEIN_OK : sk_fail_memory(error, "a formula");
}

/* ---- whether code may run ---- */

static bool processor_has(skein_instructions needs) {
    if (needs == SKEIN_INSTRUCTIONS_PLAIN) return true;
#ifdef __x86_64__
    if (needs == SKEIN_INSTRUCTIONS_AVX2) return __builtin_cpu_supports("avx2");
    return __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
           __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl");
#else
    return false;
#endif
}

/* The pieces of its text as one; NULL when there is no memory. */
static char *whole_text(const skein_compiled *c, sk_allocator *allocator) {
    size_t length = 0, at = 0;
    for (size_t i = 0; c->text[i]; i++) length += strlen(c->text[i]);
    char *text = sk_allocate(allocator, length + 1);
    for (size_t i = 0; text && c->text[i]; at += strlen(c->text[i]), i++)
        memcpy(text + at, c->text[i], strlen(c->text[i]));
    if (text) text[length] = '\0';
    return text;
}

static skein_status check_hash(const skein_compiled *c, sk_allocator *allocator, skein_error *error) {
    char *text = whole_text(c, allocator);
    if (!text) return sk_fail_memory(error, "a compiled formula");
    const skein_formula_desc desc = {.text = text,
                                     .parameters = c->parameters,
                                     .comparison = !c->energy,
                                     .second = c->energy,
                                     .result = SKEIN_FORMULA_NUMBER};
    skein_formula *f = sk_formula_create(&desc, allocator, NULL, error);
    sk_release(allocator, text);
    skein_status status = f ? SKEIN_OK : error->status;
    if (f && f->hash != c->hash)
        status = sk_fail(error, SKEIN_ERROR_VALUE, "",
                         "the compiled formula '%.80s' is not what its text says, or was emitted by another version of "
                         "Skein: emit and compile it again",
                         f->text);
    skein_formula_destroy(f);
    return status;
}

skein_status sk_compiled_check(const skein_compiled *c, sk_allocator *allocator, skein_error *error) {
    if (c->abi != SKEIN_COMPILED_ABI)
        return sk_fail(error, SKEIN_ERROR_VALUE, "",
                       "the compiled formula has ABI %u, and this library %d: emit and compile it again", c->abi,
                       SKEIN_COMPILED_ABI);
    if (c->real_size != sizeof(skein_real))
        return sk_fail(error, SKEIN_ERROR_VALUE, "",
                       "the compiled formula is in %s, and this library computes in %s: compile it %s -DSKEIN_DOUBLE",
                       c->real_size == 8 ? "double" : "float", sizeof(skein_real) == 8 ? "double" : "float",
                       sizeof(skein_real) == 8 ? "with" : "without");
    if (!processor_has(c->needs))
        return sk_fail(error, SKEIN_ERROR_VALUE, "",
                       "the compiled formula needs %s, which this processor has not: compile it here",
                       c->needs == SKEIN_INSTRUCTIONS_AVX2 ? "AVX2" : "AVX-512");
    if (!c->text || !c->parameters || !c->project || !c->project_damped || !c->force || !c->evaluate)
        return sk_fail(error, SKEIN_ERROR_VALUE, "",
                       "the compiled formula is not whole: one of its pointers is NULL where the emitter writes none");
    return check_hash(c, allocator, error);
}
