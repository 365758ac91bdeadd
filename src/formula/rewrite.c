/* Terms: nodes rewritten as a number times a node, so that nodes which differ by a sign or a factor, or are the same
 * polynomial written in different ways, are computed once. For nodes that second.c adds to a graph: existing ones, and
 * so their bits, stay as they are. */
#include "formula/rewrite.h"

#include <math.h>

#include "base/hash.h"

/* ---- numbers times nodes ---- */

static sk_term number(sk_graph *g, double value) {
    return (sk_term){value, sk_constant(g, 1)};
}

static bool is_one(const sk_graph *g, sk_node node) {
    double value;
    return sk_is_constant(g, node, &value) && value == 1;
}

sk_node sk_term_node(sk_graph *g, sk_term t) {
    if (t.factor == 0 || is_one(g, t.node)) return sk_constant(g, t.factor);
    if (t.factor == 1) return t.node;
    if (t.factor == -1) return sk_negative_of(g, t.node);
    return sk_times(g, sk_constant(g, t.factor), t.node);
}

/* A term whose factor is only a sign: the rest of the factor goes into the node. */
sk_term sk_term_whole(sk_graph *g, sk_term t) {
    return (sk_term){t.factor < 0 ? -1 : 1, sk_term_node(g, (sk_term){fabs(t.factor), t.node})};
}

sk_term sk_term_product(sk_graph *g, sk_term a, sk_term b) {
    if (a.factor == 0 || b.factor == 0) return SK_NO_TERM;
    double factor = a.factor * b.factor;
    if (is_one(g, a.node)) return (sk_term){factor, b.node};
    if (is_one(g, b.node)) return (sk_term){factor, a.node};
    return (sk_term){factor, sk_plain(g, SK_NODE_MULTIPLY, a.node, b.node)};
}

sk_term sk_term_sum(sk_graph *g, sk_term a, sk_term b) {
    if (a.factor == 0) return b;
    if (b.factor == 0) return a;
    if (a.node == b.node) return (sk_term){a.factor + b.factor, a.node};
    if (fabs(a.factor) != fabs(b.factor)) a = sk_term_whole(g, a), b = sk_term_whole(g, b);
    if (a.factor == b.factor) return (sk_term){a.factor, sk_plus(g, a.node, b.node)};
    // one order for differences, so that each exists once
    if (a.node > b.node) return (sk_term){b.factor, sk_minus(g, b.node, a.node)};
    return (sk_term){a.factor, sk_minus(g, a.node, b.node)};
}

static sk_term just(sk_graph *g, sk_node node) {
    double value;
    return sk_is_constant(g, node, &value) ? number(g, value) : (sk_term){1, node};
}

/* A node from its arguments' terms. */
static sk_term rewrite(sk_graph *g, sk_node node, const sk_term *of) {
    const sk_graph_node n = g->data[node];
    if (n.op <= SK_NODE_PARAMETER) return just(g, node);
    const sk_term a = of[n.arg[0]], b = of[n.arg[1]];
    switch (n.op) {
    case SK_NODE_ADD: return sk_term_sum(g, a, b);
    case SK_NODE_SUBTRACT: return sk_term_sum(g, a, (sk_term){-b.factor, b.node});
    case SK_NODE_MULTIPLY: return sk_term_product(g, a, b);
    case SK_NODE_NEGATE: return (sk_term){-a.factor, a.node};
    case SK_NODE_RECIPROCAL: {
        sk_term size = sk_term_whole(g, a);
        sk_term inverse = just(g, sk_of(g, SK_NODE_RECIPROCAL, size.node));
        return (sk_term){size.factor * inverse.factor, inverse.node};
    }
    case SK_NODE_LESS: {
        sk_node left = sk_term_node(g, a), right = sk_term_node(g, b), zero = sk_constant(g, 0);
        const sk_term yes = of[n.arg[2]], no = of[n.arg[3]];
        if (no.factor == 0 && yes.factor != 0) return (sk_term){yes.factor, sk_less(g, left, right, yes.node, zero)};
        if (yes.factor == 0 && no.factor != 0) return (sk_term){no.factor, sk_less(g, left, right, zero, no.node)};
        sk_node first = sk_term_node(g, yes), second = sk_term_node(g, no);
        return just(g, sk_less(g, left, right, first, second));
    }
    case SK_NODE_ATAN2:
    case SK_NODE_POW: {
        sk_node first = sk_term_node(g, a), second = sk_term_node(g, b);
        return just(g, n.op == SK_NODE_POW ? sk_power(g, first, second) : sk_arctangent(g, first, second));
    }
    default: return just(g, sk_of(g, (sk_node_op)n.op, sk_term_node(g, a)));
    }
}

/* ---- what is the same ---- */

/* A node's value modulo the prime 2^61 - 1, with random numbers for leaves: sums and products that are the same
 * polynomial have the same value, however they are written, and others differ but for one case in 10^12. Other
 * operations are hashes of their arguments' values. */
#define PRIME (((uint64_t)1 << 61) - 1)
__extension__ typedef unsigned __int128 wide_word;

static uint64_t times_modulo(uint64_t a, uint64_t b) {
    wide_word product = (wide_word)a * b;
    uint64_t sum = (uint64_t)(product & PRIME) + (uint64_t)(product >> 61);
    return sum >= PRIME ? sum - PRIME : sum;
}

/* A double is a whole number times a power of 2, and 2^61 is 1 here. */
static uint64_t constant_modulo(double value) {
    int exponent;
    double fraction = frexp(fabs(value), &exponent);
    if (!isfinite(value)) return sk_hash_mix(value > 0) % PRIME;
    uint64_t size = (uint64_t)ldexp(fraction, 53);
    size = times_modulo(size, (uint64_t)1 << (((exponent - 53) % 61 + 61) % 61));
    return value < 0 && size ? PRIME - size : size;
}

static uint64_t value_modulo(const sk_graph *g, sk_node node, const uint64_t *of) {
    const sk_graph_node *n = &g->data[node];
    uint64_t a, b, hash = sk_hash_word(SK_HASH_START, n->op);
    if (n->op == SK_NODE_CONSTANT) return constant_modulo(n->value);
    if (n->op <= SK_NODE_PARAMETER) return sk_hash_mix(sk_hash_word(hash, n->arg[0])) % PRIME;
    a = of[n->arg[0]], b = of[n->arg[1]];
    switch (n->op) {
    case SK_NODE_ADD: return (a + b) % PRIME;
    case SK_NODE_SUBTRACT: return (a + PRIME - b) % PRIME;
    case SK_NODE_NEGATE: return (PRIME - a) % PRIME;
    case SK_NODE_MULTIPLY: return times_modulo(a, b);
    default:
        for (int k = 0; k < sk_node_op_info[n->op].arity; k++) hash = sk_hash_word(hash, of[n->arg[k]]);
        return sk_hash_mix(hash) % PRIME;
    }
}

/* What is known of a graph's nodes while they are rewritten. */
typedef struct rewriting {
    bool *live;
    sk_term *of;
    uint64_t *modulo;
    uint32_t *table; /* node + 1, by its value or minus that */
    size_t table_size;
} rewriting;

/* The place of a value, or minus that, in the table. */
static uint32_t *find_value(const rewriting *r, uint64_t modulo) {
    uint64_t key = modulo < PRIME - modulo ? modulo : PRIME - modulo;
    size_t at = (size_t)sk_hash_mix(key) & (r->table_size - 1);
    for (; r->table[at]; at = (at + 1) & (r->table_size - 1)) {
        uint64_t there = r->modulo[r->table[at] - 1];
        if (there == modulo || there == PRIME - modulo) break;
    }
    return &r->table[at];
}

static sk_term find_or_rewrite(sk_graph *g, sk_node node, rewriting *r) {
    uint64_t modulo = r->modulo[node] = value_modulo(g, node, r->modulo);
    if (!modulo) return SK_NO_TERM;
    uint32_t *place = find_value(r, modulo);
    if (!*place) {
        *place = node + 1;
        return rewrite(g, node, r->of);
    }
    sk_term same = r->of[*place - 1];
    if (r->modulo[*place - 1] != modulo) same.factor = -same.factor;
    return same;
}

/* Nodes as terms of nodes that are shared wherever they can be. */
bool sk_rewrite(sk_graph *g, const sk_node *nodes, size_t count, sk_term *terms) {
    size_t before = g->count;
    rewriting r = {.table_size = 64};
    while (r.table_size < 2 * before) r.table_size *= 2;
    r.live = sk_allocate(g->allocator, before * sizeof *r.live);
    r.of = sk_allocate(g->allocator, before * sizeof *r.of);
    r.modulo = sk_allocate(g->allocator, before * sizeof *r.modulo);
    r.table = sk_allocate(g->allocator, r.table_size * sizeof *r.table);
    bool good = r.live && r.of && r.modulo && r.table;
    if (!good) g->no_memory = true;
    if (good) {
        sk_graph_mark(g, nodes, count, r.live);
        for (size_t i = 0; i < before; i++)
            if (r.live[i]) r.of[i] = find_or_rewrite(g, (sk_node)i, &r);
        for (size_t k = 0; k < count; k++) terms[k] = r.of[nodes[k]];
    }
    sk_release(g->allocator, r.live);
    sk_release(g->allocator, r.of);
    sk_release(g->allocator, r.modulo);
    sk_release(g->allocator, r.table);
    return !g->no_memory && !g->too_large;
}
