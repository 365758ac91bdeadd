/* A formula as a tape: a straight line of instructions on registers, each of which holds one number for a block of
 * elements. Made once (tape.c), run for every block (tape_run.c); nothing is allocated while running.
 *
 *     gather   positions of the block's particles into registers, by index
 *     run      every instruction over the block: registers stay in the first cache
 *     store    the outputs, into arrays; or whatever else the caller does with the registers
 *
 * The bits are those of sk_evaluate_float or _double on the same graph: an instruction that adds three products rounds
 * as often as five that do so one by one, and only saves loads, stores and dispatch. */
#ifndef SK_FORMULA_TAPE_H
#define SK_FORMULA_TAPE_H

#include "base/isa.h"
#include "base/wide_types.h"
#include "formula/graph.h"

/* A sum of two or three terms is an instruction: each term a register (A) or the product of two (P). Its number says
 * which: a bit for each term, and one for each sign. And so is minus the sum of two or three that are added. */
enum {
    SK_TAPE_SUM2 = SK_NODE_COUNT,       /* + 4 (first is P) + 2 (minus) + (second is P) */
    SK_TAPE_SUM3 = SK_TAPE_SUM2 + 8,    /* + 16 (first is P) + 8 (minus) + 4 (second is P) + 2 (minus) + (third is P) */
    SK_TAPE_MINUS2 = SK_TAPE_SUM3 + 32, /* + 2 (first is P) + (second is P) */
    SK_TAPE_MINUS3 = SK_TAPE_MINUS2 + 4, /* + 4 (first is P) + 2 (second is P) + (third is P) */
    SK_TAPE_OPS = SK_TAPE_MINUS3 + 8
};

enum {
    SK_TAPE_MEMORY = 64 << 10, /* bytes of registers, on the stack of whoever runs a tape */
    SK_TAPE_WIDES = 8          /* a block is at most so many times sixteen elements */
};

typedef struct sk_instruction {
    uint16_t op, to, from[6];
} sk_instruction;

/* What is loaded into a register before a tape runs. A particle's x, y and z are in three consecutive registers. */
typedef enum sk_tape_source { SK_TAPE_POSITION, SK_TAPE_VELOCITY, SK_TAPE_PARAMETER, SK_TAPE_TIME } sk_tape_source;

typedef struct sk_tape_load {
    uint8_t source, index; /* of the particle or the parameter */
    uint16_t to;
} sk_tape_load;

typedef struct sk_tape_constant {
    uint16_t to;
    real value;
} sk_tape_constant;

typedef struct sk_tape {
    struct {
        sk_instruction *data;
        size_t count, capacity;
    } code;
    struct {
        sk_tape_load *data;
        size_t count, capacity;
    } loads;
    struct {
        sk_tape_constant *data;
        size_t count, capacity;
    } constants;
    uint16_t *output; /* the registers of the outputs; two may share one, which may also be a load's */
    size_t outputs;
    size_t registers;
    size_t wides;  /* of a block: 8, or fewer where registers are so many that they would leave the cache */
    bool unjudged; /* its runner checks for values that are not finite itself: the verdict leaves that out */
    sk_allocator *allocator;
} sk_tape;

/* Makes a tape that computes the nodes. Fails when there is no memory, or for more registers than there may be. */
skein_status sk_tape_create(sk_tape *tape, const sk_graph *graph, const sk_node *outputs, size_t output_count,
                            sk_allocator *allocator, skein_error *error);
void sk_tape_free(sk_tape *tape);

/* The input of a tape. Positions and velocities are state vectors, aligned as such: slots [0, packed) in packed blocks,
 * others in quads. */
typedef struct sk_tape_input {
    const sk_vec4 *positions, *velocities;
    size_t packed;
    const uint32_t *const *slot;  /* slot[particle][element] */
    const real *const *parameter; /* parameter[i][element]; or [i][0] where it is uniform */
    uint64_t uniform;             /* a bit for each parameter that is the same for all elements */
    real time;
} sk_tape_input;

/* The result of a run besides its registers: for each lane, whether a guard acted, and whether the sum of all outputs
 * is finite. Elements whose sum is not should be ignored. */
typedef struct sk_tape_verdict {
    sk_mask guarded[SK_TAPE_WIDES * SK_PARTS], finite[SK_TAPE_WIDES * SK_PARTS];
} sk_tape_verdict;

/* A tape's parts, for kernels that go on with what is in its registers. A register has `vectors` vectors, the same in
 * all calls: tape->wides * SK_PARTS for blocks of elements, and 1 will do where there are no more than SK_PART of them;
 * register r's number i is registers[r * vectors + i]. `begin` comes once, then `run` for each block. */
typedef struct sk_tape_kernels {
    void (*begin)(const sk_tape *tape, const sk_tape_input *input, sk_wide *registers, size_t vectors);
    /* The first `count` vectors of each register, and perhaps more; the verdict is on these. */
    void (*run)(const sk_tape *tape, sk_wide *registers, size_t vectors, size_t count, sk_tape_verdict *verdict);
    /* The verdict on what is finite alone, for registers that something else has filled. */
    void (*judge)(const sk_tape *tape, const sk_wide *registers, size_t vectors, size_t count, sk_mask *finite);
    /* Everything, for elements [begin, end): output k of element e into outputs[k][e]. Elements that are not finite
     * give 0s. Returns how many elements were guarded or not finite. */
    size_t (*evaluate)(const sk_tape *tape, const sk_tape_input *input, size_t begin, size_t end, real *const *outputs);
    /* The same work without the last part, as the benchmark times it. */
    void (*work)(const sk_tape *tape, const sk_tape_input *input, size_t begin, size_t end);
} sk_tape_kernels;

extern const sk_tape_kernels *const sk_tape_kernels_of[SK_ISA_COUNT];

#endif
