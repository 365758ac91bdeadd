/* A formula as text: C, GLSL, or the list of its operations, by one walk over the graph; a language is a table of
 * spellings. The order of operations is the graph's, so C that is built without contraction gives the bits of
 * sk_evaluate_double or _float, if its elementary functions do. Expressions are written in place where they are read
 * once and are short; all others get names, from the functions and the lets that they come from. */
#include "formula/emit.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#include "base/status.h"

enum { MOST_HEIGHT = 3, MOST_SECOND = SK_INPUT_VELOCITY * (SK_INPUT_VELOCITY + 1) / 2 };

/* ---- what languages are made of ---- */

void sk_put(sk_writer *w, const char *format, ...) {
    char text[1024];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    w->write(w->user, text);
}

void sk_put_number(sk_writer *w, double value, int digits) {
    char text[40];
    snprintf(text, sizeof text, "%.*g", digits, value);
    for (char *c = text; *c; c++)
        if (*c == ',') *c = '.';
    sk_put(w, "%s%s", text, strpbrk(text, ".en") ? "" : ".0");
}

void sk_put_source(sk_writer *w, const char *line_begin) {
    const char *text = w->formula->text;
    sk_put(w, "%s", line_begin);
    for (; *text; text++) {
        bool ends_comment = text[0] == '/' && text > w->formula->text && text[-1] == '*';
        if (*text == '\n' && text[1]) sk_put(w, "\n%s", line_begin);
        else if (*text != '\n')
            sk_put(w, "%c", *text < ' ' || *text > '~' || *text == '\\' || ends_comment ? '?' : *text);
    }
    sk_put(w, "\n");
}

void sk_put_parameters(sk_writer *w, const char *line_begin) {
    const skein_formula *f = w->formula;
    for (int i = 0; i < f->parameters + f->rests; i++) {
        if (i < f->parameters) sk_put(w, "%sParameter %d is %s.\n", line_begin, i, f->parameter_name[i]);
        else sk_put(w, "%sParameter %d is the value of rest(...) number %d.\n", line_begin, i, i - f->parameters + 1);
    }
}

void sk_put_helpers(sk_writer *w, const char *(*text_of)(size_t), size_t count, int (*op_of)(size_t)) {
    bool used[SK_NODE_COUNT] = {[SK_NODE_CONSTANT] = true};
    const sk_graph *g = &w->formula->graph;
    for (size_t i = 0; i < g->count; i++)
        if (w->live[i]) used[g->data[i].op] = true;
    for (size_t i = 0; i < count; i++)
        if (used[op_of(i)]) w->write(w->user, text_of(i));
}

/* ---- expressions ---- */

/* The precedence of an expression: 1 sums and signs, 2 products, 3 without need of brackets. */
static int tightness(const sk_writer *w, sk_node node) {
    uint8_t op = w->formula->graph.data[node].op;
    if (w->number[node] || w->shared[node] || op <= SK_NODE_PARAMETER || w->language->call[op]) return 3;
    return op == SK_NODE_MULTIPLY ? 2 : 1;
}

static void put_temporary(sk_writer *w, sk_node node) {
    const char *name = w->formula->graph.data[node].name;
    size_t length = strlen(name);
    bool plain =
        length && name[0] != '_' && strncmp(name, "gl_", 3) != 0 && name[length - 1] != '_' && !strstr(name, "__");
    sk_put(w, "%s_%u", plain ? name : "x", w->number[node]);
}

static void put_expression(sk_writer *w, sk_node node);

void sk_put_operand(sk_writer *w, sk_node node, int least) {
    bool name = w->number[node] != 0, brackets = tightness(w, node) < least;
    sk_put(w, "%s", brackets ? "(" : "");
    if (name) put_temporary(w, node);
    else put_expression(w, node);
    sk_put(w, "%s", brackets ? ")" : "");
}

/* Recursive; its depth is the height of the expression. */
static void put_expression(sk_writer *w, sk_node node) {
    const sk_graph_node *n = &w->formula->graph.data[node];
    const char *call = w->language->call[n->op];
    if (w->shared[node]) {
        sk_put(w, "SHARED(%u)", w->shared[node] - 1);
    } else if (n->op == SK_NODE_CONSTANT) {
        w->language->constant(w, n->value);
    } else if (n->op == SK_NODE_INPUT) {
        w->language->input(w, n->arg[0]);
    } else if (n->op == SK_NODE_PARAMETER) {
        w->language->parameter(w, n->arg[0]);
    } else if (call) {
        sk_put(w, "%s(", call);
        for (int k = 0; k < sk_node_op_info[n->op].arity; k++) {
            sk_put(w, "%s", k ? ", " : "");
            sk_put_operand(w, n->arg[k], 0);
        }
        sk_put(w, ")");
    } else if (n->op == SK_NODE_NEGATE) {
        sk_put(w, "-");
        sk_put_operand(w, n->arg[0], 2);
    } else {
        bool product = n->op == SK_NODE_MULTIPLY;
        sk_put_operand(w, n->arg[0], product ? 2 : 1);
        sk_put(w, product ? " * " : n->op == SK_NODE_ADD ? " + " : " - ");
        sk_put_operand(w, n->arg[1], product ? 3 : 2);
    }
}

static void put_output(sk_writer *w, sk_node node) {
    sk_put_operand(w, node, 0);
    sk_put(w, "%s", w->language->end_result);
}

/* ---- the walk ---- */

static size_t outputs_of(const skein_formula *f, sk_node outputs[SK_FORMULA_MOST_OUTPUTS]) {
    size_t count = 0;
    for (int k = 0; k < f->size; k++) {
        outputs[count++] = f->value[k];
        for (int i = 0; i < 3 * f->particles; i++) outputs[count++] = f->by_position[k][i];
    }
    return count;
}

/* Finds the nodes that get names: those that are read more than once, or whose expressions would be too high. */
static void find_names(sk_writer *w) {
    const sk_graph *g = &w->formula->graph;
    uint32_t next = 0;
    for (size_t i = 0; i < g->count; i++) {
        const sk_graph_node *n = &g->data[i];
        int height = 1;
        if (!w->live[i] || n->op <= SK_NODE_PARAMETER || w->shared[i]) continue;
        for (int k = 0; k < sk_node_op_info[n->op].arity; k++)
            if (w->height[n->arg[k]] >= height) height = w->height[n->arg[k]] + 1;
        bool named = w->uses[i] > 1 || height > MOST_HEIGHT || n->op == SK_NODE_LESS;
        if (named) w->number[i] = ++next;
        else w->height[i] = (uint8_t)height;
    }
}

void sk_put_temporaries(sk_writer *w, const sk_node *outputs, size_t count) {
    const sk_graph *g = &w->formula->graph;
    for (size_t i = 0; i < g->count; i++) w->live[i] = false, w->uses[i] = w->number[i] = 0, w->height[i] = 0;
    for (size_t i = 0; i < count; i++) w->live[outputs[i]] = true, w->uses[outputs[i]]++;
    for (size_t i = g->count; i-- > 0;) // nodes below a shared one are needed only for that
        for (int k = 0; w->live[i] && !w->shared[i] && k < sk_node_op_info[g->data[i].op].arity; k++)
            w->live[g->data[i].arg[k]] = true, w->uses[g->data[i].arg[k]]++;
    find_names(w);
    w->language->open(w);
    for (size_t i = 0; i < g->count; i++) {
        if (!w->number[i]) continue;
        sk_put(w, "    %s ", w->language->declaration);
        put_temporary(w, (sk_node)i);
        sk_put(w, " = ");
        put_expression(w, (sk_node)i);
        sk_put(w, ";\n");
    }
}

/* The lower triangle of second derivatives, where formula and language have them. */
static size_t second_outputs_of(const sk_writer *w, sk_node outputs[static MOST_SECOND]) {
    const skein_formula *f = w->formula;
    size_t count = 0, size = 3 * (size_t)f->particles;
    if (!f->hessian || !w->language->second) return 0;
    for (size_t i = 0; i < size; i++)
        for (size_t j = 0; j <= i; j++) outputs[count++] = f->hessian[i * size + j];
    return count;
}

static void put_all(sk_writer *w, const sk_node *outputs, size_t count) {
    const skein_formula *f = w->formula;
    sk_node all[SK_FORMULA_MOST_OUTPUTS + MOST_SECOND];
    memcpy(all, outputs, count * sizeof *all);
    size_t second = second_outputs_of(w, all + count);
    sk_put_temporaries(w, all, count + second);
    for (int k = 0; k < f->size; k++) {
        for (int p = 0; p < f->particles; p++)
            for (int axis = 0; axis < 3; axis++) {
                w->language->derivative(w, k, p, axis);
                put_output(w, f->by_position[k][3 * p + axis]);
            }
    }
    for (int i = 0; second && i < 3 * f->particles; i++)
        for (int j = 0; j <= i; j++) {
            w->language->second(w, i, j);
            put_output(w, all[count++]);
        }
    for (int k = 0; k < f->size; k++) {
        w->language->result(w, k);
        put_output(w, f->value[k]);
    }
    w->language->close(w);
}

/* ---- the graph ---- */

static void put_leaf(sk_writer *w, const sk_graph_node *n) {
    const skein_formula *f = w->formula;
    if (n->op == SK_NODE_CONSTANT) {
        sk_put_number(w, n->value, 10);
    } else if (n->op == SK_NODE_INPUT) {
        sk_glsl_language.input(w, n->arg[0]);
    } else if ((int)n->arg[0] < f->parameters) {
        sk_put(w, "%s", f->parameter_name[n->arg[0]]);
    } else {
        sk_put(w, "rest #%u", f->rest[n->arg[0] - (uint32_t)f->parameters]);
    }
}

static void put_graph(sk_writer *w, const sk_node *outputs, size_t count) {
    const skein_formula *f = w->formula;
    const sk_graph *g = &f->graph;
    sk_node all[SK_FORMULA_MOST_OUTPUTS + SKEIN_FORMULA_MOST_RESTS];
    memcpy(all, outputs, count * sizeof *all);
    memcpy(all + count, f->rest, (size_t)f->rests * sizeof *all);
    sk_graph_mark(g, all, count + (size_t)f->rests, w->live);
    for (size_t i = 0; i < g->count; i++) {
        const sk_graph_node *n = &g->data[i];
        if (!w->live[i]) continue;
        sk_put(w, "#%-4zu %-9s ", i, n->op <= SK_NODE_PARAMETER ? "" : sk_node_op_info[n->op].name);
        if (n->op <= SK_NODE_PARAMETER) put_leaf(w, n);
        for (int k = 0; k < sk_node_op_info[n->op].arity; k++) sk_put(w, "%s#%u", k ? " " : "", n->arg[k]);
        sk_put(w, "%s%s\n", n->name[0] ? "    // " : "", n->name);
    }
    for (int k = 0; k < f->size; k++) {
        if (f->size == 3) sk_put(w, "value.%c = #%u\n", 'x' + k, f->value[k]);
        else sk_put(w, "value = #%u\n", f->value[k]);
        for (int i = 0; i < 3 * f->particles; i++)
            sk_put(w, "d/dp%d.%c = #%u\n", i / 3, 'x' + i % 3, f->by_position[k][i]);
    }
}

/* ---- the calls ---- */

/* Allocates the arrays by node; false when there is no memory. They must be released in either case. */
static bool begin(sk_writer *w, sk_allocator *allocator) {
    size_t nodes = w->formula->graph.count;
    w->live = sk_allocate(allocator, nodes * sizeof *w->live);
    w->uses = sk_allocate(allocator, nodes * sizeof *w->uses);
    w->number = sk_allocate(allocator, nodes * sizeof *w->number);
    w->height = sk_allocate(allocator, nodes * sizeof *w->height);
    w->shared = sk_allocate(allocator, nodes * sizeof *w->shared);
    if (w->shared) memset(w->shared, 0, nodes * sizeof *w->shared);
    return w->live && w->uses && w->number && w->height && w->shared;
}

static void end(sk_writer *w, sk_allocator *allocator) {
    sk_release(allocator, w->live);
    sk_release(allocator, w->uses);
    sk_release(allocator, w->number);
    sk_release(allocator, w->height);
    sk_release(allocator, w->shared);
}

bool sk_formula_put_glsl(const skein_formula *f, const char *head, const sk_node *outputs, size_t count,
                         void (*put)(void *user, const char *text), void *user) {
    sk_writer w = {.formula = f, .language = &sk_shader_language, .write = put, .user = user, .head = head};
    bool good = begin(&w, f->allocator);
    if (good) {
        sk_put_temporaries(&w, outputs, count);
        sk_put(&w, "    float o[%zu];\n", count);
        for (size_t k = 0; k < count; k++) {
            sk_put(&w, "    o[%zu] = ", k);
            put_output(&w, outputs[k]);
        }
    }
    end(&w, f->allocator);
    return good;
}

/* `compiled` is the name of what is to be registered, or NULL for `asked`. */
static skein_status emit(const skein_formula *f, skein_formula_language asked, const char *compiled,
                         void (*write)(void *user, const char *text), void *user, skein_error *error) {
    sk_allocator allocator = sk_default_allocator();
    sk_node outputs[SK_FORMULA_MOST_OUTPUTS];
    size_t count = outputs_of(f, outputs);
    bool kernel = asked == SKEIN_FORMULA_KERNEL || compiled;
    if (kernel && f->size != 1)
        return sk_fail(error, SKEIN_ERROR_VALUE, "", "a constraint's formula is a number, and this one is a vector");
    if (compiled && (f->particles == 0 || f->uses & SK_USES_VELOCITY))
        return sk_fail(error, SKEIN_ERROR_VALUE, "", "a constraint's formula is on particles p0 to p7, and %s",
                       f->particles ? "not on their velocities" : "this one names none");
    sk_writer w = {.formula = f,
                   .language = kernel                     ? &sk_kernel_language
                               : asked == SKEIN_FORMULA_C ? &sk_c_language
                                                          : &sk_glsl_language,
                   .write = write,
                   .user = user};
    bool good = begin(&w, &allocator);
    if (good && asked == SKEIN_FORMULA_GRAPH) put_graph(&w, outputs, count);
    else if (good && compiled) sk_put_compiled(&w, compiled);
    else if (good && kernel) sk_put_kernel(&w);
    else if (good) put_all(&w, outputs, count);
    end(&w, &allocator);
    return good ? SKEIN_OK : sk_fail_memory(error, "a formula as text");
}

skein_status skein_formula_emit(const skein_formula *f, skein_formula_language language,
                                void (*write)(void *user, const char *text), void *user, skein_error *error) {
    if (!f || !write) return sk_fail_null(error, f ? "write" : "formula");
    return emit(f, language, NULL, write, user, error);
}

skein_status skein_formula_emit_compiled(const skein_formula *f, const char *name,
                                         void (*write)(void *user, const char *text), void *user, skein_error *error) {
    if (!f || !write) return sk_fail_null(error, f ? "write" : "formula");
    if (!name) name = "skein_compiled_formula";
    size_t length = strspn(name, "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_");
    if (!length || name[length] || length > 63 || (name[0] >= '0' && name[0] <= '9'))
        return sk_fail(error, SKEIN_ERROR_NAME, "",
                       "'%.60s' cannot be a name in C: that is up to 63 letters, digits and _, and no digit first",
                       name);
    return emit(f, SKEIN_FORMULA_C, name, write, user, error);
}
