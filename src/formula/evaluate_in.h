/* The scalar evaluator for one format (no include guard: see evaluate.c). */

static NUMBER NAME(guard)(bool acts, NUMBER instead, NUMBER x, bool *guarded) {
    *guarded |= acts;
    return acts ? instead : x;
}

static NUMBER NAME(power)(NUMBER x, NUMBER y, bool *guarded) {
    if (y == 0) return 1;
    NUMBER base = NAME(guard)(!(x > 0), 1, x, guarded);
    return x > 0 ? ELEMENTARY(pow)(base, y) : 0;
}

NUMBER NAME(sk_apply)(sk_node_op op, const NUMBER *a, bool *guarded) {
    const NUMBER x = a[0];
    switch (op) {
    case SK_NODE_ADD: return x + a[1];
    case SK_NODE_SUBTRACT: return x - a[1];
    case SK_NODE_MULTIPLY: return x * a[1];
    case SK_NODE_NEGATE: return -x;
    case SK_NODE_RECIPROCAL: return NAME(guard)(!(x >= LEAST || x <= -LEAST), 0, 1 / x, guarded);
    case SK_NODE_SQRT: return ROOT(NAME(guard)(!(x >= 0), 0, x, guarded));
    case SK_NODE_ABS: return x < 0 ? -x : x + 0;
    case SK_NODE_LESS: return x < a[1] ? a[2] : a[3];
    case SK_NODE_EXP: return ELEMENTARY(exp)(NAME(guard)(!(x <= MOST_EXP), MOST_EXP, x, guarded));
    case SK_NODE_LOG: return ELEMENTARY(log)(NAME(guard)(!(x >= LEAST), LEAST, x, guarded));
    case SK_NODE_SIN: return ELEMENTARY(sin)(x);
    case SK_NODE_COS: return ELEMENTARY(cos)(x);
    case SK_NODE_TAN: return ELEMENTARY(tan)(x);
    case SK_NODE_ASIN: return ELEMENTARY(asin)(x > 1 ? 1 : x < -1 ? -1 : x);
    case SK_NODE_ACOS: return ELEMENTARY(acos)(x > 1 ? 1 : x < -1 ? -1 : x);
    case SK_NODE_ATAN2: return ELEMENTARY(atan2)(x, a[1]);
    case SK_NODE_POW: return NAME(power)(x, a[1], guarded);
    default: return 0; // leaves have no arguments
    }
}

bool NAME(sk_evaluate)(const sk_graph *graph, const bool *live, const NUMBER *inputs, const NUMBER *parameters,
                       NUMBER *values) {
    bool guarded = false;
    for (size_t i = 0; i < graph->count; i++) {
        const sk_graph_node *node = &graph->data[i];
        NUMBER a[4] = {0};
        if (!live[i]) continue;
        for (int k = 0; k < sk_node_op_info[node->op].arity; k++) a[k] = values[node->arg[k]];
        values[i] = node->op == SK_NODE_CONSTANT    ? (NUMBER)node->value
                    : node->op == SK_NODE_INPUT     ? inputs[node->arg[0]]
                    : node->op == SK_NODE_PARAMETER ? parameters[node->arg[0]]
                                                    : NAME(sk_apply)((sk_node_op)node->op, a, &guarded);
    }
    return guarded;
}
