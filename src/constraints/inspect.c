/* Inspecting constraints: their number and particles, their formula, and its value operation by operation.
 *
 *     text --parse--> graph --by each coordinate, forwards--> value and derivatives of every operation
 *
 * A kind's own formula stands in constraints/emitted/ as a string beside the code made from it; an object's is its
 * text. Both are parsed again here, since steps keep no intermediate values. Called by world/inspect.c; slow, and meant
 * for lessons, checks and windows. */
#include <stdio.h>
#include <string.h>

#include "base/status.h"
#include "constraints/enclosure.h"
#include "formula/evaluate.h"
#include "formula/formula.h"

size_t sk_batch_constraint_count(const sk_batch *batch) {
    return batch->enclosure ? 1 : batch->count;
}

size_t sk_batch_particle_count(const sk_batch *batch) {
    return batch->enclosure ? batch->enclosure->vertex_count : batch->arity;
}

uint32_t sk_batch_particle(const sk_batch *batch, size_t element, size_t i) {
    return batch->enclosure ? batch->enclosure->vertex[i] : batch->particle[element * batch->arity + i];
}

static const skein_formula *own_formula(const sk_batch *batch) {
    const sk_making *making = batch->type->making;
    return making && making->formula_of ? making->formula_of(batch->params) : NULL;
}

const char *sk_batch_text(const sk_batch *batch) {
    const skein_formula *own = own_formula(batch);
    return own ? own->text : batch->type->text ? batch->type->text : "";
}

/* ---- operations ---- */

/* A formula as a list of operations. */
typedef struct parts {
    skein_formula *formula;
    sk_node *node;    /* of each operation */
    size_t count;     /* of operations */
    size_t *place;    /* of each node that the value depends on, its operation */
    sk_node *tangent; /* each operation's derivative by each coordinate, coordinate by coordinate; or NULL */
    bool *live;
    double *values;
} parts;

static skein_formula *read_again(const sk_batch *batch, sk_allocator *allocator, skein_error *error) {
    const skein_formula *own = own_formula(batch);
    const char *names[SKEIN_FORMULA_MOST_PARAMETERS + 1] = {NULL};
    for (int i = 0; own && i < own->parameters; i++) names[i] = own->parameter_name[i];
    skein_formula_desc desc = {.text = sk_batch_text(batch),
                               .parameters = names,
                               .particles = (int)batch->arity,
                               .comparison = true,
                               .result = SKEIN_FORMULA_NUMBER};
    return sk_formula_create(&desc, allocator, NULL, error);
}

static void release_parts(parts *p, sk_allocator *allocator) {
    skein_formula_destroy(p->formula);
    sk_release(allocator, p->node);
    sk_release(allocator, p->place);
    sk_release(allocator, p->tangent);
    sk_release(allocator, p->live);
    sk_release(allocator, p->values);
}

static bool list_operations(parts *p, sk_allocator *allocator) {
    const sk_graph *g = &p->formula->graph;
    p->node = sk_allocate(allocator, g->count * sizeof *p->node);
    p->place = sk_allocate(allocator, g->count * sizeof *p->place);
    bool *live = sk_allocate(allocator, g->count * sizeof *live);
    bool good = p->node && p->place && live;
    if (good) sk_graph_mark(g, p->formula->value, 1, live);
    for (size_t i = 0; good && i < g->count; i++)
        if (live[i]) p->node[p->count] = (sk_node)i, p->place[i] = p->count++;
    sk_release(allocator, live);
    return good;
}

static bool differentiate(parts *p, size_t coordinates, sk_allocator *allocator) {
    p->tangent = sk_allocate(allocator, p->count * coordinates * sizeof *p->tangent);
    bool good = p->tangent != NULL;
    for (size_t c = 0; c < coordinates && good; c++)
        good = sk_tangents(&p->formula->graph, p->node, p->count, SK_INPUT_POSITION + (uint32_t)c,
                           p->tangent + c * p->count);
    return good;
}

/* Evaluates every operation and every derivative. */
static bool evaluate(parts *p, const sk_batch *batch, sk_allocator *allocator, double time, const sk_vec4 *x,
                     size_t element, size_t coordinates) {
    const sk_graph *g = &p->formula->graph;
    double inputs[SK_INPUT_COUNT] = {0}, parameters[SKEIN_FORMULA_MOST_PARAMETERS + SKEIN_FORMULA_MOST_RESTS] = {0};
    size_t own = (size_t)p->formula->parameters;
    for (size_t i = 0; i < batch->arity; i++) {
        sk_vec4 at = x[batch->slot[element * batch->arity + i]];
        inputs[3 * i] = (double)at.x, inputs[3 * i + 1] = (double)at.y, inputs[3 * i + 2] = (double)at.z;
    }
    inputs[SK_INPUT_TIME] = time;
    if (own) memcpy(parameters, batch->type->making->parameters_of(batch->params), own * sizeof *parameters);
    for (size_t r = 0; r < batch->rest_count; r++)
        parameters[own + r] = (double)batch->rest[r * batch->count + element];
    size_t tangents = p->tangent ? p->count * coordinates : 0;
    sk_node *outputs = sk_allocate(allocator, (p->count + tangents) * sizeof *outputs);
    p->live = sk_allocate(allocator, g->count * sizeof *p->live);
    p->values = sk_allocate(allocator, g->count * sizeof *p->values);
    bool good = outputs && p->live && p->values;
    if (good) {
        memcpy(outputs, p->node, p->count * sizeof *outputs);
        if (tangents) memcpy(outputs + p->count, p->tangent, tangents * sizeof *outputs);
        sk_graph_mark(g, outputs, p->count + tangents, p->live);
        sk_evaluate_double(g, p->live, inputs, parameters, p->values);
    }
    sk_release(allocator, outputs);
    return good;
}

/* A readable name: of a leaf what it is, of an operation the word of the text that it came from. */
static void name_operation(const skein_formula *f, const sk_graph_node *n, char *out, size_t size) {
    static const char axis[] = "xyz";
    unsigned number = n->arg[0];
    bool named = (int)number < f->parameters;
    if (n->op == SK_NODE_CONSTANT) snprintf(out, size, "%.9g", n->value);
    else if (n->op == SK_NODE_INPUT && number == SK_INPUT_TIME) snprintf(out, size, "t");
    else if (n->op == SK_NODE_INPUT) snprintf(out, size, "p%u.%c", number / 3, axis[number % 3]);
    else if (n->op == SK_NODE_PARAMETER && named) snprintf(out, size, "%s", f->parameter_name[number]);
    else if (n->op == SK_NODE_PARAMETER) snprintf(out, size, "rest %u", number - (unsigned)f->parameters + 1);
    else snprintf(out, size, "%s", n->name);
}

static void tell_operation(const parts *p, size_t i, skein_operation *out) {
    const sk_graph_node *n = &p->formula->graph.data[p->node[i]];
    *out = (skein_operation){.name = sk_node_op_info[n->op].name, .operand_count = sk_node_op_info[n->op].arity};
    name_operation(p->formula, n, out->label, sizeof out->label);
    for (int k = 0; k < out->operand_count; k++) out->operand[k] = p->place[n->arg[k]];
    out->value = p->values[p->node[i]];
}

skein_status sk_batch_operations(const sk_batch *batch, sk_allocator *allocator, double time, const sk_vec4 *x,
                                 size_t element, skein_operation *out, double *derivatives, size_t most, size_t *count,
                                 skein_error *error) {
    size_t coordinates = 3 * batch->arity;
    parts p = {.formula = read_again(batch, allocator, error)};
    if (!p.formula) return error->status;
    bool good = list_operations(&p, allocator), wanted = derivatives && most;
    if (good && wanted) good = differentiate(&p, coordinates, allocator);
    bool large = p.formula->graph.too_large;
    if (good && most) good = evaluate(&p, batch, allocator, time, x, element, coordinates);
    for (size_t i = 0; good && i < p.count && i < most; i++) {
        tell_operation(&p, i, &out[i]);
        for (size_t c = 0; c < coordinates && wanted; c++)
            derivatives[i * coordinates + c] = p.values[p.tangent[c * p.count + i]];
    }
    *count = good ? p.count : 0;
    release_parts(&p, allocator);
    if (good) return SKEIN_OK;
    if (!large) return sk_fail_memory(error, "a formula's operations");
    return sk_fail(error, SKEIN_ERROR_LIMIT, "", "more than %d operations with the derivatives of each: ask without",
                   SK_GRAPH_MOST_NODES);
}
