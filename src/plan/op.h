/* The ops of a plan: what a step does, as data.
 *
 * An op names vectors, a kernel and a range of elements; the runner (world/run.c) knows nothing else.
 * Methods write ops (methods/plan_builder.h), rules bring the kernels (constraints/, forces/, colliders/).
 *
 *   kind     dst   sources        coefficients   rule                 range
 *   field    F     X V                           gravity              [0, particles)
 *   force    F     X V                           batch of distances   [0, elements)
 *   combine  V     V F            1, h                                [0, slots)
 */
#ifndef SK_PLAN_OP_H
#define SK_PLAN_OP_H

#include "base/isa.h"
#include "base/layout.h"
#include "base/memory.h"
#include "base/vector.h"
#include "space/cells.h"

/* The state vectors, one sk_vec4 a slot. */
typedef enum sk_vector {
    SK_NONE,
    SK_X,        /* position, inverse mass */
    SK_V,        /* velocity, mass */
    SK_F,        /* force */
    SK_X0,       /* position saved at the start of a substep */
    SK_V0,       /* velocity saved likewise */
    SK_PREVIOUS, /* position at the start of the step, for blending between frames; always quads */
    SK_T0,       /* temporaries: there only while the plan names them, and empty outside a step */
    SK_T1,
    SK_T2,
    SK_T3,
    SK_T4,
    SK_T5,
    SK_T6,
    SK_T7,
    SK_T8,
    SK_T9,
    SK_T10,
    SK_T11,
    SK_S, /* what steers: a change of velocity, and in w how much more speed is allowed; a temporary, too */
    SK_VECTOR_COUNT
} sk_vector;

/* The kinds of ops: what is so of all ops of a kind stands in its row of sk_op_types, and who runs plans looks there. */
typedef enum sk_op_kind {
    SK_OP_PACK,
    SK_OP_UNPACK,
    SK_OP_SUM, /* the arithmetic of whole vectors, up to REST: see sk_op_types */
    SK_OP_CORRECTION,
    SK_OP_KICK,
    SK_OP_WIPE,
    SK_OP_STEER,
    SK_OP_LEAD,
    SK_OP_PULL,
    SK_OP_PREDICT,
    SK_OP_PREDICT_UNIFORM,
    SK_OP_CORRECT_AND_PREDICT,
    SK_OP_REST,
    SK_OP_PASS, /* other arithmetic, of a solve: its label says which */
    SK_OP_SORT, /* the first op of a sort, and those that go on with it */
    SK_OP_SORT_ON,
    SK_OP_FIELD, /* forces on particles: those that push, */
    SK_OP_STEERING, /* that steer, */
    SK_OP_AVOID,    /* and that steer clear of a collider */
    SK_OP_NEIGHBOUR,
    SK_OP_FORCE,
    SK_OP_PROJECT,
    SK_OP_MULTIPLIER,
    SK_OP_CONTACT_FORCE,
    SK_OP_CONTACT_VELOCITY,
    SK_OP_CONTACT_POSITION,
    SK_OP_CONTACT_SWEEP, /* of what moved through a collider */
    SK_OP_CONTACT_UPDATE,
    SK_OP_LIMIT, /* of lengths; */
    SK_OP_BOUND, /* of velocities, */
    SK_OP_SHIFT, /* and of places, by a force */
    SK_OP_APPLY,
    SK_OP_LINEARISE,
    SK_OP_CONTACT_FILTER,
    SK_OP_MEET,
    SK_OP_CALL,  /* what is no loop over elements: a solver from outside */
    SK_OP_SOLVE, /* an algorithm in C that has the ops behind it run, part by part, until it is content */
    SK_OP_PART,  /* of a solve: heads ops that run when it asks for them, and are passed over else */
    SK_OP_REPEAT,
    SK_OP_KIND_COUNT
} sk_op_kind;

/* Free: each element writes only its own slot, so any cut over threads gives the same bits.
 * Ordered: the sequential order is the answer. */
typedef enum sk_order { SK_FREE, SK_ORDERED } sk_order;

/* Triangles of all bodies' surfaces, by their corners. */
typedef struct sk_triangles {
    uint32_t (*corner)[3];
    size_t count, capacity;
} sk_triangles;

/* Which elements of a sweep along strips an op projects. Halves are alike: those in strip rows with even numbers and in
 * rows with odd ones, or where elements lead from row to row, in such blocks. */
typedef enum sk_half { SK_WHOLE, SK_EVEN_HALF, SK_ODD_HALF } sk_half;

/* Which strips of particles an op walks along, so that threads can follow each other down the rows of a
 * grid; all zero where it does not. An element of an ordered op's strip row j also writes row j + reach;
 * one of a free op writes row j alone, and reads rows j - reach to j + reach. */
typedef struct sk_walk {
    size_t first_slot;  /* of the strips */
    size_t rows, width; /* strip rows; blocks a row */
    size_t reach;
} sk_walk;

/* The triangles in the cells of a grid whose particles lie in strips. A cell is known by its first corner:
 *
 *     0 . 1      (r, c)      (r, c + 1)       its triangle with tip t has corner t and the two beside it,
 *     . \ .                                   3 - t is the corner that it has not
 *     2 . 3      (r + 1, c)  (r + 1, c + 1) */
typedef struct sk_patch {
    sk_walk walk;
    uint16_t (*has)[4]; /* of each block: bit l of [t] says whether lane l's cell has the triangle with tip t */
} sk_patch;

/* All triangles, as slots, for forces that act on areas: those in patches, and the rest. */
typedef struct sk_surface {
    sk_patch *patches;
    size_t patch_count;
    sk_triangles rest;
    uint32_t *number; /* of each of the rest, which it is among all that take part */
    size_t number_capacity;
} sk_surface;

typedef struct sk_op sk_op;

/* What a kernel may touch while a plan runs. */
typedef struct sk_run sk_run;
struct sk_run {
    sk_vec4 *vector[SK_VECTOR_COUNT];
    size_t slot_count;           /* a multiple of 16; slots without a particle are zero and weigh nothing */
    const uint32_t *slot_of;     /* of the user's particles */
    const uint32_t *particle_of; /* of slots: the user's index, or SK_NOBODY */
    size_t particle_count;
    const sk_surface *surface;
    sk_cells *cells;
    sk_allocator *allocator;
    double time;              /* at the end of the present substep, s */
    struct sk_solve *solve;   /* what a solve and its ops tell each other (plan/solve.h) */
    struct sk_matrix *matrix; /* of a solve with a factor (plan/matrix.h), else NULL */
    void (*ops)(sk_run *run, const sk_op *ops, size_t count);    /* for solves: runs these, of the same plan, */
    struct sk_tasks *tasks;                                      /* on these threads */
    double *seconds;          /* of each op from `timed` on what it takes is added to; NULL: nobody asks */
    const sk_op *timed;
    size_t iteration;              /* of the innermost repeat, from 0 on, */
    bool last_iteration;           /* and whether it is the last */
    bool near;                     /* surfaces are near each other in this substep, */
    double near_at;                /* which ends at this time */
    bool no_memory;           /* a growing list could not grow: the step fails and says so */
};

typedef void sk_op_kernel(sk_run *run, const sk_op *op, size_t begin, size_t end);

/* A kernel in a version for each instruction set. */
typedef struct sk_kernels {
    sk_op_kernel *version[SK_ISA_COUNT];
} sk_kernels;

/* What an op's rule is. */
typedef enum sk_rule_sort { SK_OTHER_RULE, SK_RULE_UNIFORM, SK_RULE_FORCE, SK_RULE_COLLIDER } sk_rule_sort;

/* How a gradient goes through an op in reverse (world/adjoint.h). */
typedef enum sk_reverse {
    SK_REVERSE_NOT, /* not yet */
    SK_REVERSE_NOTHING,
    SK_REVERSE_SUM, /* dst = a p + b q + c r */
    SK_REVERSE_KICK, /* dst = p + a w q */
    SK_REVERSE_FIELD, /* F += a force, if that is uniform */
    SK_REVERSE_ELASTIC, /* F += a sweep of constraints */
    SK_REVERSE_SOLVE, /* an implicit solve, as a whole; */
    SK_REVERSE_BY_SOLVE /* and the ops that are its alone */
} sk_reverse;

/* Whom an op reads and writes: bits of vectors, and these of its own. */
enum {
    SK_USES_DST = 1 << 28,
    SK_USES_FIRST = 1 << 29, /* its sources */
    SK_USES_SECOND = 1 << 30,
};
#define SK_USES_THIRD (1u << 31)
#define SK_USES_SOURCES ((uint32_t)SK_USES_FIRST | (uint32_t)SK_USES_SECOND | SK_USES_THIRD)

/* How an op runs on a graphics card: in GLSL, where '@' is its number in a shader, and
 *   $d $p $q $r   its dst and sources; a $r that is none is 0,
 *   $s            the weighted sum of its sources,        $b   q, or q + b d where its second coefficient is not 0,
 *   $f            F, or 0 where it does not read that,    $=   "=" where it sets, else "+=",
 *   $k            the name of its rule's kind             $x   "x, " where the rule's force depends on place
 *   $o            what `other` says of it. */
typedef struct sk_on_card {
    const char *statement; /* for one slot; NULL: it cannot run there */
    const char *call;      /* what the statement calls, made of the arithmetic of the rule's kind (plan/shader.h) */
    const char *file;      /* a text that it needs besides, "gpu/walk" */
    const char *(*other)(const sk_op *op);
} sk_on_card;

typedef struct sk_op_type {
    const char *name;          /* in `skein explain` and in profiles; several kinds may be one to users */
    const sk_kernels *kernels; /* NULL: rules bring them */
    const char *formula;       /* what `skein explain` shows of an op without a label, see plan.c; NULL: its sources */
    sk_rule_sort rule;
    uint32_t reads, writes; /* besides what one op says itself; only of ops that can run on a card are they all there is */
    sk_reverse reverse;
    bool arithmetic; /* of whole vectors: a label is no name, but a formula, too */
    bool leads;      /* the ops behind it are its own: they run when it says so */
    bool sorts;      /* its group into cells */
    bool goes_on;    /* it is a part of what the op before it has begun */
    bool factors;    /* it needs the matrix of a solve (plan/matrix.h) */
    bool walks;      /* it looks at neighbours, in the cells */
    bool at_end;     /* its rule is asked for the end of the substep, not for the time of the state */
    sk_on_card card;
} sk_op_type;

extern const sk_op_type sk_op_types[SK_OP_KIND_COUNT];

/* When an op runs: what is taken in every second substep where nothing is near would shake what lies on something. */
typedef enum sk_op_while { SK_ALWAYS, SK_WHILE_APART, SK_WHILE_NEAR } sk_op_while;

struct sk_op {
    sk_op_kind kind;
    sk_order order;
    sk_op_kernel *kernel; /* NULL for a repeat or a part; a solve: all of it, on the thread that runs the plan */
    sk_vector dst, source[3];
    double coefficient[3];
    double dt;             /* of the substep, s */
    double before_end;     /* how long before the end of the substep the state is that it looks at, s */
    const void *rule;      /* a force, a collider, a batch */
    const sk_patch *patch; /* of triangles in strips, else NULL */
    const sk_group *group, *seen; /* whom it moves or sorts, and at whom it looks; NULL: everybody */
    uint32_t also_reads;   /* bits of vectors, besides what its kind says */
    const char *label;     /* its name in `skein explain` */
    sk_op_kernel *inner;  /* of an op over some slots only: `kernel` is sk_run_partly then */
    size_t first_slot, end_slot; /* of such an op, within [begin, end); else 0 */
    size_t begin, end;     /* elements; a repeat: the number of iterations is `end` */
    bool sets;             /* a field op: F is written, not added to */
    bool by_particle;      /* its elements are the user's particles, not slots: not to be run in chunks with others */
    bool alone;            /* it looks at slots that are not its own: nor is that */
    bool from_prediction; /* it looks at X0 only to know X0 + b V, b being its second coefficient, 0 where X0 is that */
    size_t every;          /* it runs in each so many-th iteration of its repeat, and in the last of them; 0: in all */
    sk_op_while during;    /* and only while surfaces are near each other, or are not */
    size_t packed;         /* slots [0, packed) are in packed blocks when it runs */
    sk_walk walk;          /* of ops whose elements are strip rows */
    sk_half half;          /* of a sweep along strips */
    size_t length;         /* a repeat, a solve or a part of one: how many ops after it are its own */
    int part;              /* a part: which */
};

/* m g + f - (linear + rate m) v on every particle: gravity, uniform wind and air drag together. Methods that
 * predict take it in at once, so that F need not be written and read. */
typedef struct sk_uniform_force {
    double acceleration[3], force[3], linear, rate;
    char label[64]; /* of the forces that it stands for */
} sk_uniform_force;

/* Slots that the same rules act on, and what methods that predict do for them. */
typedef struct sk_plan_part {
    size_t first_slot, end_slot;
    sk_uniform_force uniform; /* the rule of its prediction ops that need no F */
    bool is_uniform, steered;
} sk_plan_part;

typedef struct sk_plan {
    sk_op *data;
    size_t count, capacity;
    struct {
        sk_plan_part *data;
        size_t count, capacity;
    } parts; /* of all slots; ops point into them */
} sk_plan;

/* Appends an op; false when there is no memory. */
bool sk_plan_add(sk_plan *plan, sk_allocator *allocator, sk_op op);
/* Runs the op's inner kernel over whole blocks, and leaves what the slots beside [first_slot, end_slot) have. */
sk_op_kernel sk_run_partly;
/* The op for these slots alone. */
sk_op sk_op_for(sk_op op, size_t first_slot, size_t end_slot);
/* Whether an op runs in the present iteration. */
static inline bool sk_op_is_due(const sk_run *run, const sk_op *op) {
    if (op->during && (op->during == SK_WHILE_NEAR) != run->near) return false;
    return op->every < 2 || run->iteration % op->every == op->every - 1;
}
/* One line about an op, as `skein explain` shows it. */
void sk_op_describe(const sk_op *op, char *text, size_t size);
/* Bits of the vectors whose values before the op matter, and of those that it writes. */
uint32_t sk_op_reads(const sk_op *op);
uint32_t sk_op_writes(const sk_op *op);

static inline const sk_op_type *sk_op_type_of(const sk_op *op) {
    return &sk_op_types[op->kind];
}
/* Whether it is an algorithm that runs the ops behind it as it decides. */
static inline bool sk_op_decides(const sk_op *op) {
    return op->kernel && sk_op_type_of(op)->leads;
}
/* Whether it makes dst 0. */
static inline bool sk_op_clears(const sk_op *op) {
    return sk_op_type_of(op)->reverse == SK_REVERSE_SUM && op->source[0] == SK_NONE;
}

/* The arithmetic of vectors: the kernels of combine ops. The w components stay as they are.
 *   dst = a p + b q + c r        (a source of SK_NONE is left out)
 *   dst += a (p - (q + b dst))   velocity: what moved p away from where dst alone would have taken q
 *   dst = p + a w q              a kick: w is the inverse mass
 *   wipe                         dst = 0, w too
 *   steer                        dst += q, where the inverse mass is not 0
 *   lead                         dst += a q, where the inverse mass is 0; dst is X
 *   pull                         dst += h (the plan's uniform force), where the inverse mass is not 0; dst is V
 *   predict                      V += h w F; V0 = V where the third source is V0; X0 = X, or what X is going to
 *                                be where the third source is X; X += h V: one op
 *                                for what would be four (plan/fuse.h)
 *   predict_uniform              the same, with the plan's uniform force in place of F
 *   correct_and_predict          V += a (X - X0), and but for the last iteration of its repeat predict_uniform: the end
 * of one substep and the start of the next rest                         dst = 0 where it is at most a: the end of a
 * step, a being SK_REST_SPEED */
extern const sk_kernels sk_combine_sum, sk_combine_correction, sk_combine_kick, sk_combine_wipe, sk_combine_steer,
    sk_combine_lead, sk_combine_pull, sk_combine_predict, sk_combine_predict_uniform, sk_combine_correct_and_predict,
    sk_combine_rest;
/* m/s: what is slower has come to rest (base/float_mode.h). The square of such a number is not
 * thin yet. */
#define SK_REST_SPEED ((real)(sizeof(real) == sizeof(double) ? 1e-140 : 1e-18))
/* Turns blocks of dst from quads to packed, and back, in place. */
extern const sk_kernels sk_pack, sk_unpack;

#endif
