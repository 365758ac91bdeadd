/* A constraint's formula as a file of C to be compiled and registered: its value, gradient and, of an energy, second
 * derivatives, in the macros of include/skein/compiled_formula.h. The operations are the graph's, one by one, so that the
 * bits are those of tapes. */
#include <inttypes.h>
#include <string.h>

#include "formula/emit.h"

/* A formula of more operations than LONG is compiled once, and called by each walk. */
enum { LONG = 2000, MOST_PIECE = 96, MOST_SHARED = 64 };

/* The text as several strings, since compilers need not accept long ones. */
static void put_text(sk_writer *w) {
    const char *text = w->formula->text;
    sk_put(w, "static const char *const formula_text[] = {");
    for (size_t at = 0; text[at];) {
        sk_put(w, "\n    \"");
        for (size_t i = 0; i < MOST_PIECE && text[at]; i++, at++) {
            char c = text[at];
            if (c == '\n') {
                sk_put(w, "\\n");
                at++;
                break;
            }
            if (c == '\t') sk_put(w, "\\t");
            else if (c >= ' ' && c <= '~') sk_put(w, "%s%c", strchr("\"\\?", c) ? "\\" : "", c);
            else sk_put(w, "\\%03o", (unsigned)(unsigned char)c);
        }
        sk_put(w, "\",");
    }
    sk_put(w, " NULL};\n");
}

static void put_sizes(sk_writer *w, size_t operations, size_t shared) {
    const skein_formula *f = w->formula;
    sk_put(w, "#define SKEIN_PARTICLES %d\n#define SKEIN_PARAMETERS %d\n#define SKEIN_RESTS %d\n", f->particles,
           f->parameters, f->rests);
    sk_put(w, "#define SKEIN_SHARED %zu\n#define SKEIN_ENERGY %d\n#define SKEIN_ONE_SIDED %d\n", shared,
           f->hessian != NULL, f->at_least_zero);
    if (operations > LONG) sk_put(w, "#define SKEIN_LONG\n");
    sk_put(w, "#include <skein/compiled_formula.h>\n\n");
}

/* Finds the nodes that depend on parameters and time alone, and so are the same for all elements, but are read by nodes
 * that are not. Returns how many. */
static size_t find_shared(sk_writer *w, const sk_node *outputs, size_t output_count, sk_node shared[MOST_SHARED]) {
    const skein_formula *f = w->formula;
    const sk_graph *g = &f->graph;
    size_t count = 0;
    uint8_t *varies = w->height; // not in use yet
    sk_graph_mark(g, outputs, output_count, w->live);
    for (size_t i = 0; i < g->count; i++) {
        const sk_graph_node *n = &g->data[i];
        varies[i] = n->op == SK_NODE_INPUT       ? n->arg[0] != SK_INPUT_TIME
                    : n->op == SK_NODE_PARAMETER ? n->arg[0] >= (uint32_t)f->parameters
                                                 : 0;
        for (int k = 0; n->op > SK_NODE_PARAMETER && k < sk_node_op_info[n->op].arity; k++)
            varies[i] |= varies[n->arg[k]];
        w->uses[i] = 0;
    }
    for (size_t i = 0; i < g->count; i++)
        for (int k = 0; w->live[i] && varies[i] && k < sk_node_op_info[g->data[i].op].arity; k++)
            w->uses[g->data[i].arg[k]] = 1;
    for (size_t i = 0; i < output_count; i++) w->uses[outputs[i]] = 1;
    for (size_t i = 0; i < g->count && count < MOST_SHARED; i++)
        if (w->live[i] && w->uses[i] && !varies[i] && g->data[i].op > SK_NODE_PARAMETER) shared[count++] = (sk_node)i;
    return count;
}

static void put_shared(sk_writer *w, const sk_node *shared, size_t count) {
    if (!count) return;
    sk_put(w, "SHARED_BY_ALL(shared) {\n");
    sk_put_temporaries(w, shared, count);
    for (size_t i = 0; i < count; i++) {
        sk_put(w, "    SHARE(%zu, ", i);
        sk_put_operand(w, shared[i], 0);
        sk_put(w, ");\n");
    }
    sk_put(w, "}\n\n");
    for (size_t i = 0; i < count; i++) w->shared[shared[i]] = (uint32_t)i + 1;
}

static void put_formula(sk_writer *w, size_t operations) {
    const skein_formula *f = w->formula;
    sk_node outputs[SK_INPUT_VELOCITY + 2], shared[MOST_SHARED];
    size_t count = 0, coordinates = 3 * (size_t)f->particles;
    outputs[count++] = f->value[0];
    for (size_t i = 0; i < coordinates; i++) outputs[count++] = f->by_position[0][i];
    double by_time;
    bool moves = !sk_is_constant(&f->graph, f->by_time[0], &by_time) || by_time != 0;
    if (moves) outputs[count++] = f->by_time[0];
    size_t shared_count = find_shared(w, outputs, count, shared);
    put_sizes(w, operations, shared_count);
    put_shared(w, shared, shared_count);
    sk_put(w, "FORMULA(formula) {\n");
    sk_put_temporaries(w, outputs, count);
    for (size_t i = 0; i < coordinates; i++) {
        sk_put(w, "    GRADIENT(0, %zu, %zu, ", i / 3, i % 3);
        sk_put_operand(w, f->by_position[0][i], 0);
        sk_put(w, ");\n");
    }
    if (moves) {
        sk_put(w, "    BY_TIME(0, ");
        sk_put_operand(w, f->by_time[0], 0);
        sk_put(w, ");\n");
    }
    sk_put(w, "    VALUE(0, ");
    sk_put_operand(w, f->value[0], 0);
    sk_put(w, ");\n}\n");
    for (size_t i = 0; i < shared_count; i++) w->shared[shared[i]] = 0;
}

static void put_second(sk_writer *w) {
    const skein_formula *f = w->formula;
    sk_node outputs[SK_INPUT_VELOCITY * (SK_INPUT_VELOCITY + 1) / 2];
    size_t count = 0, coordinates = 3 * (size_t)f->particles;
    for (size_t i = 0; i < coordinates; i++)
        for (size_t j = 0; j <= i; j++) outputs[count++] = f->hessian[i * coordinates + j];
    sk_put(w, "\nSECOND(second) {\n");
    sk_put_temporaries(w, outputs, count);
    count = 0;
    for (size_t i = 0; i < coordinates; i++)
        for (size_t j = 0; j <= i; j++) {
            sk_put(w, "    HESSIAN(%zu, %zu, ", i, j);
            sk_put_operand(w, outputs[count++], 0);
            sk_put(w, ");\n");
        }
    sk_put(w, "}\n");
}

void sk_put_compiled(sk_writer *w, const char *name) {
    const skein_formula *f = w->formula;
    sk_put_source(w, "// ");
    sk_put(w,
           "//\n// Made by `skein formula --emit c`, for constraints of kind `%s`; hash %016" PRIx64
           ". Compile it with\n",
           f->hessian ? "energy" : "formula", f->hash);
    sk_put(w, "//     cc -std=gnu17 -O3 -march=native -ffp-contract=off -fno-math-errno -c\n");
    sk_put(w, "// and give %s to skein_formula_register().\n", name);
    sk_put_parameters(w, "// ");
    put_formula(w, skein_formula_about(f).operations);
    if (f->hessian) put_second(w);
    sk_put(w, "\n");
    put_text(w);
    sk_put(w, "static const char *const formula_parameters[] = {");
    for (int i = 0; i < f->parameters; i++) sk_put(w, "\"%s\", ", f->parameter_name[i]);
    sk_put(w, "NULL};\nSKEIN_COMPILED(%s, UINT64_C(0x%016" PRIx64 "), formula_text, formula_parameters);\n", name,
           f->hash);
}
