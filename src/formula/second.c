/* Second derivatives of a number by positions, in the way that takes the fewest operations of several.
 *
 * If translating all particles changes nothing, one particle's rows and columns are minus the sums of the others'. The
 * rest can be the gradient's derivatives, input by input; or come from a *cut*: a few nodes s through which alone the
 * value E depends on the inputs, such as the invariants of an energy. By the chain rule, applied twice,
 *
 *     H = sum E_st (grad s)(grad t)^T + sum E_s hess s
 *
 * so that every entry is a few products of numbers that rows share. Cuts are found from the value downwards, and the
 * way with the fewest operations is kept. Terms are rewritten as a number times a node, so that nodes which differ by a
 * sign or a factor are computed once. The rest of the graph, and so its bits, stays as it is. */
#include <math.h>
#include <string.h>

#include "formula/rewrite.h"

enum {
    MOST_CUT = 4,
    MOST_NODES = SK_GRAPH_MOST_NODES / 16, /* of a graph in which more ways are looked for */
    MOST_COORDINATES = SK_INPUT_VELOCITY,
    MOST_ENTRIES = MOST_COORDINATES * (MOST_COORDINATES + 1) / 2
};

/* What is computed of: the coordinates of the particles that are kept. */
typedef struct maker {
    sk_graph *graph;
    sk_node output;
    size_t particles, left_out; /* a particle, or `particles` where none is */
    uint32_t inputs[MOST_COORDINATES];
    size_t count;   /* of inputs */
    sk_node *entry; /* count^2, the lower triangle */
} maker;

/* The sum of terms that are no use elsewhere: as few signs as there can be. */
static sk_term sum_of(sk_graph *g, sk_term *terms, size_t count) {
    size_t first = 0;
    sk_term out = SK_NO_TERM;
    while (first + 1 < count && terms[first].factor < 0) first++;
    for (size_t i = 0; i < count; i++) {
        sk_term next = sk_term_whole(g, terms[(first + i) % count]);
        if (i == 0) out = next;
        else if (out.factor == next.factor) out.node = sk_plus(g, out.node, next.node);
        else out.node = sk_minus(g, out.node, next.node);
    }
    return out;
}

/* ---- what moving all particles does ---- */

/* How much nodes grow when all particles move by 1 along an axis; NAN: it depends on the positions. */
static double drift_of(const sk_graph *g, sk_node node, uint32_t axis, const double *of) {
    const sk_graph_node *n = &g->data[node];
    if (!(n->uses & SK_USES_POSITION)) return 0;
    if (n->op == SK_NODE_INPUT) return n->arg[0] % 3 == axis;
    double k, a = of[n->arg[0]], b = of[n->arg[1]];
    switch (n->op) {
    case SK_NODE_ADD: return a + b;
    case SK_NODE_SUBTRACT: return a - b;
    case SK_NODE_NEGATE: return -a;
    case SK_NODE_MULTIPLY: return sk_is_constant(g, n->arg[0], &k) ? k * b : a == 0 && b == 0 ? 0 : NAN;
    case SK_NODE_LESS: return a == b && of[n->arg[2]] == of[n->arg[3]] ? of[n->arg[2]] : NAN;
    default:
        for (int i = 0; i < sk_node_op_info[n->op].arity; i++)
            if (of[n->arg[i]] != 0) return NAN;
        return 0;
    }
}

static bool stays_where_all_move(sk_graph *g, sk_node output) {
    double *of = sk_allocate(g->allocator, ((size_t)output + 1) * sizeof *of);
    bool stays = of;
    if (!of) g->no_memory = true;
    for (uint32_t axis = 0; axis < 3 && stays; axis++) {
        for (size_t i = 0; i <= output; i++) of[i] = drift_of(g, (sk_node)i, axis, of);
        stays = of[output] == 0;
    }
    sk_release(g->allocator, of);
    return stays;
}

/* The particle that most nodes read, as the origin of all others. */
static size_t find_origin(const sk_graph *g, sk_node output, size_t particles) {
    size_t uses[SK_FORMULA_PARTICLES] = {0}, origin = 0;
    for (size_t i = 0; i <= output; i++)
        for (int k = 0; k < sk_node_op_info[g->data[i].op].arity; k++) {
            const sk_graph_node *n = &g->data[g->data[i].arg[k]];
            if (n->op == SK_NODE_INPUT && n->arg[0] < SK_INPUT_VELOCITY) uses[n->arg[0] / 3]++;
        }
    for (size_t p = 1; p < particles; p++)
        if (uses[p] > uses[origin]) origin = p;
    return origin;
}

/* ---- ways to the entries ---- */

#define ENTRY(m_, i_, j_) (m_)->entry[(i_) * (m_)->count + (j_)]

/* Derivatives of the gradient, input by input, the rows from each on. */
static bool go_forward(const maker *m, const sk_node *gradient, sk_node *out) {
    for (size_t j = 0; j < m->count; j++) {
        sk_node column[MOST_COORDINATES];
        if (!sk_tangents(m->graph, gradient + j, m->count - j, m->inputs[j], column)) return false;
        for (size_t i = j; i < m->count; i++) out[i * (i + 1) / 2 + j] = column[i - j];
    }
    return true;
}

static bool find_plainly(maker *m) {
    sk_node gradient[MOST_COORDINATES], second[MOST_ENTRIES];
    sk_term terms[MOST_ENTRIES];
    size_t entries = m->count * (m->count + 1) / 2;
    if (!sk_gradient(m->graph, m->output, m->inputs, m->count, gradient) || !go_forward(m, gradient, second) ||
        !sk_rewrite(m->graph, second, entries, terms))
        return false;
    for (size_t i = 0; i < m->count; i++)
        for (size_t j = 0; j <= i; j++) ENTRY(m, i, j) = sk_term_node(m->graph, terms[i * (i + 1) / 2 + j]);
    return true;
}

/* A node of a cut, and what is known of it. */
typedef struct member {
    sk_term by, *gradient, *second; /* E_s; the lower triangle */
    sk_term by_two[MOST_CUT];       /* E_st */
    sk_term row[MOST_COORDINATES];  /* sum E_st grad t */
} member;

/* Nodes that are made for a cut, and the terms that they become, all at once. */
typedef struct workspace {
    member member[MOST_CUT];
    sk_node node[MOST_CUT * (1 + MOST_CUT + MOST_COORDINATES + MOST_ENTRIES)];
    sk_term term[MOST_CUT * (1 + MOST_CUT + MOST_COORDINATES + MOST_ENTRIES)];
} workspace;

/* The gradient's common factor goes to where it is one number. */
static double take_factor(const maker *m, member *s) {
    double factor = 0;
    bool common = true;
    for (size_t i = 0; i < m->count; i++) {
        double size = fabs(s->gradient[i].factor);
        if (size == 0) continue;
        common &= factor == 0 || size == factor;
        factor = size;
    }
    if (!common || factor == 0) factor = 1;
    for (size_t i = 0; i < m->count; i++) {
        sk_term *t = &s->gradient[i];
        if (t->factor != 0) *t = sk_term_whole(m->graph, (sk_term){t->factor / factor, t->node});
    }
    return factor;
}

/* False also where E is linear in the cut. */
static bool find_members(const maker *m, const sk_node *cut, size_t count, workspace *w) {
    sk_graph *g = m->graph;
    size_t entries = m->count * (m->count + 1) / 2, used = count + count * count;
    sk_node *two = w->node + count;
    bool bent = false;
    if (!sk_gradient_by(g, m->output, cut, count, w->node)) return false;
    for (size_t k = 0; k < count; k++)
        if (!sk_gradient_by(g, w->node[k], cut, count, two + k * count)) return false;
    for (size_t k = 0; k < count * count; k++) {
        double value;
        bent |= !sk_is_constant(g, two[k], &value) || value != 0;
    }
    if (!bent) return false; // the value is a sum of these: nothing is gained
    for (size_t k = 0; k < count; k++) {
        sk_node *gradient = w->node + used;
        w->member[k].gradient = w->term + used, w->member[k].second = w->term + used + m->count;
        used += m->count + entries;
        if (!sk_gradient(g, cut[k], m->inputs, m->count, gradient) || !go_forward(m, gradient, gradient + m->count))
            return false;
    }
    if (!sk_rewrite(g, w->node, used, w->term)) return false;
    double factor[MOST_CUT];
    for (size_t k = 0; k < count; k++) {
        w->member[k].by = w->term[k];
        factor[k] = take_factor(m, &w->member[k]);
    }
    for (size_t k = 0; k < count; k++)
        for (size_t l = 0; l < count; l++) { // the lower one for both
            sk_term t = w->term[count + (k > l ? k * count + l : l * count + k)], *to = &w->member[k].by_two[l];
            *to = t.factor == 0 ? t : sk_term_whole(g, (sk_term){t.factor * factor[k] * factor[l], t.node});
        }
    return true;
}

static bool find_by_cut(maker *m, const sk_node *cut, size_t count, workspace *w) {
    sk_graph *g = m->graph;
    member *s = w->member;
    if (!find_members(m, cut, count, w)) return false;
    for (size_t k = 0; k < count; k++)
        for (size_t i = 0; i < m->count; i++) {
            sk_term terms[MOST_CUT];
            size_t many = 0;
            for (size_t l = 0; l < count; l++) {
                sk_term t = sk_term_product(g, s[k].by_two[l], s[l].gradient[i]);
                if (t.factor != 0) terms[many++] = t;
            }
            s[k].row[i] = many ? sum_of(g, terms, many) : SK_NO_TERM;
        }
    for (size_t i = 0; i < m->count; i++)
        for (size_t j = 0; j <= i; j++) {
            sk_term terms[2 * MOST_CUT];
            size_t many = 0;
            for (size_t k = 0; k < count; k++) {
                sk_term t = sk_term_product(g, s[k].row[i], s[k].gradient[j]),
                        second = s[k].second[i * (i + 1) / 2 + j];
                if (t.factor != 0) terms[many++] = t;
                if (second.factor == 0 || s[k].by.factor == 0) continue;
                sk_term by = sk_term_whole(g, (sk_term){s[k].by.factor * second.factor, s[k].by.node});
                terms[many++] = sk_term_product(g, by, (sk_term){1, second.node});
            }
            ENTRY(m, i, j) = sk_term_node(g, many ? sum_of(g, terms, many) : SK_NO_TERM);
        }
    return !g->no_memory && !g->too_large;
}

/* ---- cuts ---- */

/* Cuts by the number of their members: the last node that was opened on the way down to each, and how many of those
 * before it were no sums. Of two cuts with as many of these the larger one only has sums taken apart. */
typedef struct cuts {
    size_t lowest[MOST_CUT + 1], bends[MOST_CUT + 1];
} cuts;

static bool is_linear(const sk_graph *g, const sk_graph_node *n) {
    if (n->op != SK_NODE_MULTIPLY) return n->op == SK_NODE_ADD || n->op == SK_NODE_SUBTRACT || n->op == SK_NODE_NEGATE;
    return !(g->data[n->arg[0]].uses & g->data[n->arg[1]].uses & SK_USES_POSITION);
}

/* Goes down from the value, the last node first, until `last` has been opened; what is reached then is a cut. */
static void open_down_to(const maker *m, size_t last, bool *reached, cuts *found) {
    const sk_graph *g = m->graph;
    size_t size = 1, bends = 0;
    memset(reached, 0, ((size_t)m->output + 1) * sizeof *reached);
    reached[m->output] = true;
    for (size_t i = (size_t)m->output + 1; i-- > last;) {
        const sk_graph_node *n = &g->data[i];
        if (!reached[i] || n->op == SK_NODE_INPUT) continue;
        reached[i] = false, size--, bends += !is_linear(g, n);
        for (int k = n->op == SK_NODE_LESS ? 2 : 0; k < sk_node_op_info[n->op].arity; k++) {
            bool counts = (g->data[n->arg[k]].uses & SK_USES_POSITION) && !reached[n->arg[k]];
            if (counts) reached[n->arg[k]] = true, size++;
        }
        if (size <= MOST_CUT && found) found->lowest[size] = i, found->bends[size] = bends;
    }
}

/* ---- all of it ---- */

static size_t count_operations(const maker *m, const sk_node *hessian, size_t size, bool *live) {
    const sk_graph *g = m->graph;
    size_t count = 0;
    sk_graph_mark(g, hessian, size * size, live);
    for (size_t i = 0; i < g->count; i++) count += live[i] && g->data[i].op > SK_NODE_PARAMETER;
    return count;
}

static sk_node kept_entry(const maker *m, size_t i, size_t j) {
    return i >= j ? ENTRY(m, i, j) : ENTRY(m, j, i);
}

/* Coordinate 3 p + axis of the particles that are kept. */
static size_t index_of(const maker *m, size_t coordinate) {
    return coordinate / 3 > m->left_out ? coordinate - 3 : coordinate;
}

/* Minus the sum of a row's entries at one axis: of the entries as they are, since they are there anyway. */
static sk_node left_over(const maker *m, size_t row, size_t axis, const sk_node *hessian) {
    sk_graph *g = m->graph;
    sk_node sum = sk_constant(g, 0);
    bool any = false;
    for (size_t p = 0; p < m->particles; p++) {
        sk_node entry = hessian[row * 3 * m->particles + 3 * p + axis];
        double value;
        if (p == m->left_out || (sk_is_constant(g, entry, &value) && value == 0)) continue;
        sum = any ? sk_plain(g, SK_NODE_ADD, sum, entry) : entry;
        any = true;
    }
    return sk_negative_of(g, sum);
}

static void fill(const maker *m, sk_node *hessian) {
    size_t size = 3 * m->particles, first = 3 * m->left_out, past = first + 3;
    for (size_t i = 0; i < size; i++)
        for (size_t j = 0; j < size; j++)
            if (i / 3 != m->left_out && j / 3 != m->left_out)
                hessian[i * size + j] = kept_entry(m, index_of(m, i), index_of(m, j));
    if (m->left_out == m->particles) return;
    for (size_t i = 0; i < size; i++)
        for (size_t j = first; j < past && i / 3 != m->left_out; j++)
            hessian[j * size + i] = hessian[i * size + j] = left_over(m, i, j - first, hessian);
    for (size_t i = first; i < past; i++)
        for (size_t j = first; j <= i; j++)
            hessian[j * size + i] = hessian[i * size + j] = left_over(m, i, j - first, hessian);
}

/* Each way's entries are computed into `try`, and kept in `hessian` where they take the fewest operations so far. */
static void keep_better(const maker *m, sk_node *try, sk_node *hessian, size_t *fewest) {
    sk_graph *g = m->graph;
    size_t size = 3 * m->particles;
    fill(m, try);
    bool *live = sk_allocate(g->allocator, g->count * sizeof *live);
    if (!live) g->no_memory = true;
    size_t operations = live ? count_operations(m, try, size, live) : SIZE_MAX;
    if (operations < *fewest) {
        memcpy(hessian, try, size * size * sizeof *try);
        *fewest = operations;
    }
    sk_release(g->allocator, live);
}

static void try_all(maker *m, workspace *w, bool *reached, sk_node *try, sk_node *hessian) {
    size_t fewest = SIZE_MAX;
    cuts found = {0};
    open_down_to(m, 0, reached, &found);
    if (find_plainly(m)) keep_better(m, try, hessian, &fewest);
    for (size_t k = 1; k <= MOST_CUT && m->graph->count < MOST_NODES; k++) {
        sk_node cut[MOST_CUT];
        size_t count = 0;
        bool is_new = found.bends[k] > 0; // else the value is a sum of it
        for (size_t j = 1; j < k; j++) is_new &= found.bends[j] != found.bends[k];
        if (!is_new) continue;
        open_down_to(m, found.lowest[k], reached, NULL);
        for (size_t i = 0; i <= m->output && count < MOST_CUT; i++)
            if (reached[i]) cut[count++] = (sk_node)i;
        if (find_by_cut(m, cut, count, w)) keep_better(m, try, hessian, &fewest);
    }
}

bool sk_second_derivatives(sk_graph *graph, sk_node output, size_t particles, sk_node *hessian) {
    sk_allocator *allocator = graph->allocator;
    size_t size = 3 * particles;
    if (graph->no_memory || graph->too_large) return false;
    maker m = {.graph = graph, .output = output, .particles = particles, .left_out = particles};
    if (particles > 1 && stays_where_all_move(graph, output)) m.left_out = find_origin(graph, output, particles);
    for (uint32_t i = 0; i < size; i++)
        if (i / 3 != m.left_out) m.inputs[m.count++] = SK_INPUT_POSITION + i;
    sk_term value = SK_NO_TERM;
    if (!sk_rewrite(graph, &output, 1, &value)) return false;
    m.output = sk_term_node(graph, value);
    m.entry = sk_allocate(allocator, (m.count * m.count + 1) * sizeof *m.entry);
    workspace *w = sk_allocate(allocator, sizeof *w);
    bool *reached = sk_allocate(allocator, (size_t)m.output + 1);
    sk_node *try = sk_allocate(allocator, (size * size + 1) * sizeof *try);
    if (!m.entry || !w || !reached || !try) graph->no_memory = true;
    else try_all(&m, w, reached, try, hessian);
    sk_release(allocator, m.entry);
    sk_release(allocator, w);
    sk_release(allocator, reached);
    sk_release(allocator, try);
    return !graph->no_memory && !graph->too_large;
}
