/* From a graph to a tape: which nodes become instructions of their own, in which order, in which registers. */
#include "formula/tape.h"

#include <string.h>

#include "base/status.h"

enum { NO_REGISTER = UINT16_MAX };
static const uint32_t NEVER = UINT32_MAX; // as the place of a last use

/* A node's properties while a tape is made. */
typedef struct plan_of_node {
    bool live, is_output;
    bool inside;                       /* a product or sum that is computed within the sums that read it */
    bool ordered;                      /* has its place on the tape */
    uint8_t terms;                     /* of a sum: 2, or 3 with one of its arguments inside */
    uint16_t place;                    /* its register */
    uint32_t uses, uses_in_sums, last; /* the last instruction that reads it */
} plan_of_node;

typedef struct builder {
    const sk_graph *graph;
    plan_of_node *plan;
    sk_tape *tape;
    struct {
        sk_node *data;
        size_t count, capacity;
    } order, stack;
    struct {
        uint16_t *data;
        size_t count, capacity;
    } free; /* registers to be used again */
    bool no_memory;
} builder;

#define PUSH(b_, array_, ...)                                               \
    do {                                                                    \
        if (SK_RESERVE((b_)->tape->allocator, array_, (array_)->count + 1)) \
            (array_)->data[(array_)->count++] = (__VA_ARGS__);              \
        else (b_)->no_memory = true;                                        \
    } while (0)

static bool is_sum(const builder *b, sk_node node) {
    return b->graph->data[node].op == SK_NODE_ADD || b->graph->data[node].op == SK_NODE_SUBTRACT;
}

static bool is_leaf(const builder *b, sk_node node) {
    return b->graph->data[node].op <= SK_NODE_PARAMETER;
}

/* ---- which nodes are instructions ---- */

static void count_uses(builder *b, const sk_node *outputs, size_t output_count, const bool *live) {
    for (size_t i = 0; i < output_count; i++) b->plan[outputs[i]].is_output = true;
    for (size_t i = 0; i < b->graph->count; i++) {
        const sk_graph_node *n = &b->graph->data[i];
        b->plan[i].live = live[i];
        for (int k = 0; live[i] && k < sk_node_op_info[n->op].arity; k++) {
            b->plan[n->arg[k]].uses++;
            b->plan[n->arg[k]].uses_in_sums += is_sum(b, (sk_node)i);
        }
    }
}

/* A sum's argument that may be its first two terms. What is subtracted may not: a - (b + c) rounds otherwise. */
static int prefix_of(const builder *b, sk_node node) {
    const sk_graph_node *n = &b->graph->data[node];
    for (int k = 0; k < (n->op == SK_NODE_ADD ? 2 : 1); k++) {
        const plan_of_node *argument = &b->plan[n->arg[k]];
        if (is_sum(b, n->arg[k]) && argument->uses == 1 && !argument->is_output && argument->terms == 2) return k;
    }
    return -1;
}

/* Whether a sum's terms are all added. */
static bool only_adds(const builder *b, sk_node sum) {
    int prefix = b->plan[sum].terms == 3 ? prefix_of(b, sum) : -1;
    const sk_graph_node *n = &b->graph->data[sum];
    return n->op == SK_NODE_ADD && (prefix < 0 || b->graph->data[n->arg[prefix]].op == SK_NODE_ADD);
}

/* A product that at most two sums read is computed within each of them, since a load and a multiplication there cost
 * less than an instruction and a register of its own. */
static void choose_instructions(builder *b) {
    enum { MOST_COPIES = 2 };
    for (size_t i = 0; i < b->graph->count; i++) {
        plan_of_node *plan = &b->plan[i];
        if (!plan->live) continue;
        if (b->graph->data[i].op == SK_NODE_MULTIPLY)
            plan->inside = !plan->is_output && plan->uses == plan->uses_in_sums && plan->uses <= MOST_COPIES;
        if (b->graph->data[i].op == SK_NODE_NEGATE) {
            sk_node sum = b->graph->data[i].arg[0];
            const plan_of_node *of = &b->plan[sum];
            if (is_sum(b, sum) && of->uses == 1 && !of->is_output && only_adds(b, sum)) b->plan[sum].inside = true;
        }
        if (!is_sum(b, (sk_node)i)) continue;
        int prefix = prefix_of(b, (sk_node)i);
        plan->terms = prefix < 0 ? 2 : 3;
        if (prefix >= 0) b->plan[b->graph->data[i].arg[prefix]].inside = true;
    }
}

/* ---- what an instruction reads ---- */

static unsigned add_term(const builder *b, sk_node node, sk_node operands[6], int *count) {
    const sk_graph_node *n = &b->graph->data[node];
    bool product = n->op == SK_NODE_MULTIPLY && b->plan[node].inside;
    operands[(*count)++] = product ? n->arg[0] : node;
    if (product) operands[(*count)++] = n->arg[1];
    return product;
}

static int operands_of_sum(const builder *b, sk_node node, sk_node operands[6], uint16_t *op) {
    const sk_graph_node *n = &b->graph->data[node];
    int count = 0;
    int prefix = b->plan[node].terms == 3 ? prefix_of(b, node) : -1;
    const sk_graph_node *two = prefix < 0 ? n : &b->graph->data[n->arg[prefix]];
    unsigned number = add_term(b, two->arg[0], operands, &count);
    number = number * 4 + (two->op == SK_NODE_SUBTRACT ? 2 : 0) + add_term(b, two->arg[1], operands, &count);
    *op = (uint16_t)(SK_TAPE_SUM2 + number);
    if (prefix < 0) return count;
    number = number * 4 + (n->op == SK_NODE_SUBTRACT ? 2 : 0) + add_term(b, n->arg[1 - prefix], operands, &count);
    *op = (uint16_t)(SK_TAPE_SUM3 + number);
    return count;
}

/* The operands of a node's instruction, and the instruction's number. */
static int operands_of(const builder *b, sk_node node, sk_node operands[6], uint16_t *op) {
    const sk_graph_node *n = &b->graph->data[node];
    int count = 0;
    if (n->op == SK_NODE_NEGATE && is_sum(b, n->arg[0]) && b->plan[n->arg[0]].inside) {
        uint16_t sum;
        count = operands_of_sum(b, n->arg[0], operands, &sum);
        // without the signs' bits, which are 0
        unsigned two = sum - (unsigned)SK_TAPE_SUM2, three = sum - (unsigned)SK_TAPE_SUM3;
        if (sum < SK_TAPE_SUM3) *op = (uint16_t)(SK_TAPE_MINUS2 + (two >> 2 << 1 | (two & 1)));
        else *op = (uint16_t)(SK_TAPE_MINUS3 + (three >> 4 << 2 | (three >> 2 & 1) << 1 | (three & 1)));
        return count;
    }
    if (!is_sum(b, node)) {
        *op = n->op;
        for (; count < sk_node_op_info[n->op].arity; count++) operands[count] = n->arg[count];
        return count;
    }
    return operands_of_sum(b, node, operands, op);
}

/* ---- the order ---- */

/* Puts each output's own nodes just before it, so that few registers are in use at a time. */
static void put_in_order(builder *b, sk_node output) {
    PUSH(b, &b->stack, output);
    while (b->stack.count && !b->no_memory) {
        sk_node node = b->stack.data[b->stack.count - 1], operands[6];
        uint16_t op;
        bool ready = true;
        if (b->plan[node].ordered || is_leaf(b, node)) {
            b->stack.count--;
            continue;
        }
        for (int k = operands_of(b, node, operands, &op); k-- > 0;) {
            if (b->plan[operands[k]].ordered || is_leaf(b, operands[k])) continue;
            PUSH(b, &b->stack, operands[k]);
            ready = false;
        }
        if (!ready || b->no_memory) continue;
        b->stack.count--;
        b->plan[node].ordered = true;
        PUSH(b, &b->order, node);
    }
}

static void find_last_uses(builder *b) {
    sk_node operands[6];
    uint16_t op;
    for (size_t i = 0; i < b->order.count; i++)
        for (int k = operands_of(b, b->order.data[i], operands, &op); k-- > 0;) b->plan[operands[k]].last = (uint32_t)i;
}

/* ---- registers ---- */

static uint16_t new_registers(builder *b, size_t count) {
    size_t first = b->tape->registers;
    b->tape->registers += count;
    return first + count < NO_REGISTER ? (uint16_t)first : 0; // too many are refused at the end
}

static void load_leaves(builder *b) {
    uint16_t particle[2 * SK_FORMULA_PARTICLES];
    memset(particle, 0xff, sizeof particle);
    for (size_t i = 0; i < b->graph->count; i++) {
        const sk_graph_node *n = &b->graph->data[i];
        plan_of_node *plan = &b->plan[i];
        uint8_t index = (uint8_t)n->arg[0];
        if (!plan->live) continue;
        if (n->op == SK_NODE_CONSTANT) {
            plan->place = new_registers(b, 1);
            PUSH(b, &b->tape->constants, (sk_tape_constant){plan->place, (real)n->value});
        } else if (n->op == SK_NODE_PARAMETER || (n->op == SK_NODE_INPUT && index == SK_INPUT_TIME)) {
            plan->place = new_registers(b, 1);
            uint8_t source = n->op == SK_NODE_PARAMETER ? SK_TAPE_PARAMETER : SK_TAPE_TIME;
            PUSH(b, &b->tape->loads, (sk_tape_load){source, index, plan->place});
        } else if (n->op == SK_NODE_INPUT) {
            uint16_t *first = &particle[index / 3];
            bool velocity = index >= SK_INPUT_VELOCITY;
            uint8_t number = (uint8_t)(index / 3 - (velocity ? SK_FORMULA_PARTICLES : 0));
            if (*first == NO_REGISTER) {
                *first = new_registers(b, 3);
                PUSH(b, &b->tape->loads, (sk_tape_load){velocity ? SK_TAPE_VELOCITY : SK_TAPE_POSITION, number, *first});
            }
            plan->place = (uint16_t)(*first + index % 3);
        }
    }
}

/* Registers of operands that are read for the last time may take the result: instructions work lane by lane. */
static void write_code(builder *b) {
    for (size_t i = 0; i < b->order.count && !b->no_memory; i++) {
        sk_node node = b->order.data[i], operands[6];
        sk_instruction instruction = {0};
        int count = operands_of(b, node, operands, &instruction.op);
        for (int k = 0; k < count; k++) {
            plan_of_node *operand = &b->plan[operands[k]];
            instruction.from[k] = operand->place;
            if (operand->last != i || operand->is_output || is_leaf(b, operands[k])) continue;
            operand->last = NEVER; // it is freed once, also when it is read twice
            PUSH(b, &b->free, operand->place);
        }
        instruction.to = b->free.count ? b->free.data[--b->free.count] : new_registers(b, 1);
        b->plan[node].place = instruction.to;
        PUSH(b, &b->tape->code, instruction);
    }
}

static void build(builder *b, const sk_node *outputs, size_t output_count) {
    sk_tape *tape = b->tape;
    bool *live = sk_allocate(tape->allocator, b->graph->count * sizeof *live);
    b->plan = sk_allocate(tape->allocator, b->graph->count * sizeof *b->plan);
    tape->output = sk_allocate(tape->allocator, (output_count + 1) * sizeof *tape->output);
    b->no_memory = !live || !b->plan || !tape->output;
    if (!b->no_memory) {
        sk_graph_mark(b->graph, outputs, output_count, live);
        count_uses(b, outputs, output_count, live);
        choose_instructions(b);
        for (size_t i = 0; i < output_count; i++) put_in_order(b, outputs[i]);
        find_last_uses(b);
        load_leaves(b);
        write_code(b);
        for (size_t i = 0; i < output_count; i++) tape->output[i] = b->plan[outputs[i]].place;
        tape->outputs = output_count;
    }
    sk_release(tape->allocator, live);
    sk_release(tape->allocator, b->plan);
    sk_release(tape->allocator, b->order.data);
    sk_release(tape->allocator, b->stack.data);
    sk_release(tape->allocator, b->free.data);
}

skein_status sk_tape_create(sk_tape *tape, const sk_graph *graph, const sk_node *outputs, size_t output_count,
                            sk_allocator *allocator, skein_error *error) {
    const size_t most = SK_TAPE_MEMORY / (SK_LANES * sizeof(real)), cached = most * 3 / 4;
    *tape = (sk_tape){.allocator = allocator};
    builder b = {.graph = graph, .tape = tape};
    build(&b, outputs, output_count);
    skein_status status = SKEIN_OK;
    if (b.no_memory) status = sk_fail_memory(error, "a formula's tape");
    else if (tape->registers > most)
        status = sk_fail(error, SKEIN_ERROR_LIMIT, "",
                         "the formula is too large to run: it needs %zu numbers at once for each element, where %zu "
                         "are the most",
                         tape->registers, most);
    if (status) sk_tape_free(tape);
    else
        for (tape->wides = SK_TAPE_WIDES; tape->wides > 1 && tape->registers * tape->wides > cached;) tape->wides /= 2;
    return status;
}

void sk_tape_free(sk_tape *tape) {
    sk_release(tape->allocator, tape->code.data);
    sk_release(tape->allocator, tape->loads.data);
    sk_release(tape->allocator, tape->constants.data);
    sk_release(tape->allocator, tape->output);
    *tape = (sk_tape){.allocator = tape->allocator};
}
