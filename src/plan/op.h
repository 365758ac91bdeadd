/* The ops of a plan: what a step does, as data.
 *
 * An op names vectors, a kernel and a range of elements; the runner (world/run.c) knows nothing else.
 * Methods write ops (methods/plan_builder.h), and rules have the kernels (constraints/, forces/, colliders/).
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
    SK_T0,       /* temporaries: they exist only if the plan names them, and hold nothing between steps */
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
    SK_S,       /* steering: a change of velocity, and in w how much more speed is allowed; also a temporary */
    SK_SUPPORT, /* where surfaces meet each other and colliders: the unit normal of who pushed last in this substep, or 0 */
    SK_VECTOR_COUNT
} sk_vector;

/* The kinds of ops. What holds for all ops of a kind stands in its row of sk_op_types, where the runners look it up. */
typedef enum sk_op_kind {
    SK_OP_PACK,
    SK_OP_UNPACK,
    SK_OP_SUM, /* from here to REST: arithmetic on whole vectors, see sk_op_types */
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
    SK_OP_PASS, /* a solve's other arithmetic on vectors; its label says which */
    SK_OP_SORT, /* the first op of a sort, and those that continue it */
    SK_OP_SORT_ON,
    SK_OP_FIELD,    /* forces on particles: those that add to F, */
    SK_OP_STEERING, /* those that steer, */
    SK_OP_AVOID,    /* and those that steer away from a collider */
    SK_OP_NEIGHBOUR,
    SK_OP_FORCE,
    SK_OP_PROJECT,
    SK_OP_MULTIPLIER,
    SK_OP_CONTACT_FORCE,
    SK_OP_CONTACT_VELOCITY,
    SK_OP_CONTACT_POSITION,
    SK_OP_CONTACT_SWEEP, /* for particles that moved through a collider within a substep */
    SK_OP_CONTACT_UPDATE,
    SK_OP_LIMIT, /* limits lengths */
    SK_OP_BOUND, /* a force that limits velocities, */
    SK_OP_SHIFT, /* or moves positions */
    SK_OP_APPLY,
    SK_OP_LINEARISE,
    SK_OP_CONTACT_FILTER,
    SK_OP_MEET,
    SK_OP_CALL,  /* not a loop over elements: calls a solver from outside */
    SK_OP_SOLVE, /* an algorithm in C that runs the parts after it, in an order that it decides */
    SK_OP_PART,  /* heads the ops of one part of a solve, which run only when the solve calls for them */
    SK_OP_REPEAT,
    SK_OP_KIND_COUNT
} sk_op_kind;

/* Free: each element writes only its own slot, so any division among threads gives the same bits.
 * Ordered: the result is that of the sequential order. */
typedef enum sk_order { SK_FREE, SK_ORDERED } sk_order;

/* Triangles of the bodies' surfaces, by their corners. */
typedef struct sk_triangles {
    uint32_t (*corner)[3];
    size_t count, capacity;
} sk_triangles;

/* Which elements of a sweep along strips an op projects: all, or those in strip rows with even or odd numbers; where
 * elements lead from row to row, those in blocks with even or odd numbers. */
typedef enum sk_half { SK_WHOLE, SK_EVEN_HALF, SK_ODD_HALF } sk_half;

/* The strips of particles that an op walks along, so that threads can follow each other down the rows of a grid; all
 * zero if it does not. An element in strip row j of an ordered op also writes row j + reach; one of a free op writes
 * row j alone, and reads rows j - reach to j + reach. */
typedef struct sk_walk {
    size_t first_slot;  /* of the strips */
    size_t rows, width; /* strip rows; blocks a row */
    size_t reach;
} sk_walk;

/* The triangles in the cells of a grid whose particles lie in strips. A cell is named by its first corner:
 *
 *     0 . 1      (r, c)      (r, c + 1)       its triangle with tip t has corner t and the two beside it,
 *     . \ .                                   but not corner 3 - t
 *     2 . 3      (r + 1, c)  (r + 1, c + 1) */
typedef struct sk_patch {
    sk_walk walk;
    uint16_t (*has)[4]; /* of each block: bit l of [t] says whether lane l's cell has the triangle with tip t */
} sk_patch;

/* All triangles by the slots of their corners, for forces that act on areas: those in patches, and the rest. */
typedef struct sk_surface {
    sk_patch *patches;
    size_t patch_count;
    sk_triangles rest;
    uint32_t *number; /* for each of the rest, its number among all triangles that take part */
    size_t number_capacity;
} sk_surface;

typedef struct sk_op sk_op;

/* What kernels may read and write while a plan runs. */
typedef struct sk_run sk_run;
struct sk_run {
    sk_vec4 *vector[SK_VECTOR_COUNT];
    size_t slot_count;           /* a multiple of 16; slots without a particle are all zero */
    const uint32_t *slot_of;     /* of the user's particles */
    const uint32_t *particle_of; /* of slots: the user's index, or SK_NOBODY */
    size_t particle_count;
    bool *supported; /* some of SUPPORT is not 0; threads that run ops share it */
    const sk_surface *surface;
    sk_cells *cells;
    sk_allocator *allocator;
    double time;                                              /* at the end of the present substep, s */
    struct sk_solve *solve;                                   /* what a solve and its ops share (plan/solve.h) */
    struct sk_matrix *matrix;                                 /* of a solve with a factor (plan/matrix.h), else NULL */
    void (*ops)(sk_run *run, const sk_op *ops, size_t count); /* for solves: runs ops of the same plan, */
    struct sk_tasks *tasks;                                   /* on these threads */
    double *seconds; /* for each op from `timed` on, its time is added here; NULL: not measured */
    const sk_op *timed;
    size_t iteration;     /* of the innermost repeat, from 0 on, */
    bool last_iteration;  /* and whether it is the last */
    bool strained;        /* when the step began some edge was near its bound (world/strained.c) */
    bool near;            /* surfaces are near each other in this substep, */
    double near_at;       /* which ends at this time */
    bool no_memory;       /* an allocation failed: so will the step */
    uint64_t turn, turns; /* added to ops' own turns they never get less; how many a pass over the plan has */
    uint64_t *moved;      /* of sixteen slots: in which turn any was moved last; NULL: nobody says (sk_watch) */
    uint64_t *found_held; /* and in which none was to be held any more (colliders/contact.c) */
};

typedef void sk_op_kernel(sk_run *run, const sk_op *op, size_t begin, size_t end);

/* A kernel in a version for each instruction set. */
typedef struct sk_kernels {
    sk_op_kernel *version[SK_ISA_COUNT];
} sk_kernels;

/* What an op's `rule` points to. */
typedef enum sk_rule_sort { SK_OTHER_RULE, SK_RULE_UNIFORM, SK_RULE_FORCE, SK_RULE_COLLIDER } sk_rule_sort;

/* How the adjoint pass differentiates an op (world/adjoint.h). */
typedef enum sk_reverse {
    SK_REVERSE_NOT, /* not supported yet */
    SK_REVERSE_NOTHING,
    SK_REVERSE_SUM,     /* dst = a p + b q + c r */
    SK_REVERSE_KICK,    /* dst = p + a w q */
    SK_REVERSE_FIELD,   /* F += a force, if that is uniform */
    SK_REVERSE_ELASTIC, /* F += a sweep of constraints */
    SK_REVERSE_SOLVE,   /* an implicit solve, as a whole */
    SK_REVERSE_BY_SOLVE /* an op within a solve, which the solve stands for */
} sk_reverse;

/* What an op reads and writes: bits of vectors, and these, which stand for the op's own dst and sources. */
enum {
    SK_USES_DST = 1 << 28,
    SK_USES_FIRST = 1 << 29, /* the sources */
    SK_USES_SECOND = 1 << 30,
};
#define SK_USES_THIRD (1u << 31)
#define SK_USES_SOURCES ((uint32_t)SK_USES_FIRST | (uint32_t)SK_USES_SECOND | SK_USES_THIRD)

/* How an op runs on a graphics card: in GLSL, where '@' is its number in a shader, and
 *   $d $p $q $r   its dst and sources; 0 for a missing $r,
 *   $s            the weighted sum of its sources,        $b   q, or q + b d where its second coefficient is not 0,
 *   $f            F, or 0 where it does not read F,       $=   "=" where it sets, else "+=",
 *   $k            the name of its rule's kind             $x   "x, " where the rule's force depends on place
 *   $o            what `other` returns for it. */
typedef struct sk_on_card {
    const char *statement; /* for one slot; NULL: it cannot run there */
    const char *call;      /* what the statement calls, made from the arithmetic of the rule's kind (plan/shader.h) */
    const char *shared;    /* arithmetic that it also needs, once for all ops: "colliders/response"; NULL: none */
    const char *file;      /* a text that it also needs: "gpu/walk" */
    const char *(*other)(const sk_op *op);
} sk_on_card;

typedef struct sk_op_type {
    const char *name;          /* in `skein explain` and in profiles; several kinds may share one */
    const sk_kernels *kernels; /* NULL: rules have them */
    const char *formula;       /* what `skein explain` shows of an op without a label, see plan.c; NULL: its sources */
    sk_rule_sort rule;
    uint32_t reads, writes; /* besides what the op itself says; complete only for kinds that can run on a card */
    sk_reverse reverse;
    bool arithmetic; /* on whole vectors: a label of such an op is a formula, not a name */
    bool leads;      /* the ops after it belong to it, and run when it decides */
    bool sorts;      /* it begins a sort of its group into cells */
    bool goes_on;    /* it continues what the op before it began */
    bool factors;    /* it needs the matrix of a solve (plan/matrix.h) */
    bool walks;      /* it reads neighbours, by the cells */
    bool at_end;     /* its rule is evaluated at the end of the substep, not at the time of the state */
    sk_on_card card;
} sk_op_type;

extern const sk_op_type sk_op_types[SK_OP_KIND_COUNT];

/* When an op runs. Projecting in every second substep would shake bodies that rest on each other, and so is done only
 * while no surfaces are near. */
typedef enum sk_op_while { SK_ALWAYS, SK_WHILE_APART, SK_WHILE_NEAR } sk_op_while;

struct sk_op {
    sk_op_kind kind;
    sk_order order;
    sk_op_kernel *kernel; /* NULL for a repeat or a part; a solve's runs on the thread that runs the plan */
    sk_vector dst, source[3];
    double coefficient[3];
    double dt;                        /* of the substep, s */
    double before_end;                /* how long before the end of the substep the state that it reads is, s */
    const void *rule;                 /* a force, a collider, a batch */
    const sk_patch *patch;            /* of triangles in strips, else NULL */
    const sk_group *group, *seen;     /* particles that it moves or sorts, and those that it reads; NULL: all */
    uint32_t also_reads, also_writes; /* bits of vectors, besides those of its kind */
    const char *label;                /* its name in `skein explain` */
    sk_op_kernel *inner;              /* the kernel of an op over some slots only, whose `kernel` is sk_run_partly */
    size_t first_slot, end_slot;      /* of such an op, within [begin, end); else 0 */
    size_t begin, end;                /* elements; a repeat: the number of iterations is `end` */
    bool sets;                        /* a field op: F is written, not added to */
    bool by_particle;     /* its elements are the user's particles, not slots: it cannot run in chunks with others */
    bool alone;           /* it reads slots other than its own: it cannot either */
    bool from_prediction; /* it reads X0 only for X0 + b V, b being its second coefficient: 0 if X0 holds that sum */
    size_t every;         /* it runs in every `every`-th iteration of its repeat, and in the last; 0: in all */
    sk_op_while during;   /* and, unless SK_ALWAYS, only while surfaces are near each other, or only while not; */
    const bool *strained; /* and, unless NULL, only in steps that begin with edges near their bounds */
    size_t packed;        /* slots [0, packed) are in packed blocks when it runs */
    sk_walk walk;         /* of ops whose elements are strip rows */
    sk_half half;         /* of a sweep along strips */
    size_t length;        /* of a repeat, a solve or a part: how many ops after it belong to it */
    int part;             /* a part's number */
    uint32_t turn;  /* its number among those of a pass that pass over what has not moved (sk_watch); 0: it is none */
    uint32_t since; /* and what was found before that turn counts for none */
};

/* The force m g + f - (linear + rate m) v on every particle: gravity, uniform wind and air drag together. Predictions
 * apply it directly to velocities, so that F need not be written and read. */
typedef struct sk_uniform_force {
    double acceleration[3], force[3], linear, rate;
    char label[64]; /* names the forces that it combines */
} sk_uniform_force;

/* A range of slots that the same rules act on, and how methods predict them. */
typedef struct sk_plan_part {
    size_t first_slot, end_slot;
    sk_uniform_force uniform; /* the rule of its prediction ops if they need no F */
    bool is_uniform, steered;
} sk_plan_part;

typedef struct sk_plan {
    sk_op *data;
    size_t count, capacity;
    struct {
        sk_plan_part *data;
        size_t count, capacity;
    } parts; /* cover all slots; ops point into them */
} sk_plan;

/* Appends an op; false when there is no memory. */
bool sk_plan_add(sk_plan *plan, sk_allocator *allocator, sk_op op);
/* Runs the op's inner kernel over whole blocks, and keeps the values of slots outside of [first_slot, end_slot). */
sk_op_kernel sk_run_partly;
/* The op restricted to these slots. */
sk_op sk_op_for(sk_op op, size_t first_slot, size_t end_slot);
/* Whether an op runs in the present iteration. */
static inline bool sk_op_is_due(const sk_run *run, const sk_op *op) {
    if (op->during && (op->during == SK_WHILE_NEAR) != run->near) return false;
    if (op->strained && !*op->strained) return false;
    return op->every < 2 || run->iteration % op->every == op->every - 1;
}

#ifdef SK_SMALL // a page waits for each byte
#define SK_WATCHES false
#else
#define SK_WATCHES true
#endif

/* For ops that are swept over and over: most of what they look at is as they left it, and has not moved. Who is passed over was found in a turn
 * after all of his last moved, which is as good as to find him again: the same bits. */
typedef struct sk_watch {
    uint64_t since, now;
    uint64_t *moved; /* NULL: nobody watches */
} sk_watch;

static inline __attribute__((always_inline)) sk_watch sk_watch_of(const sk_run *run, const sk_op *op) {
    return (sk_watch){run->turn + op->since, run->turn + op->turn, SK_WATCHES && op->turn ? run->moved : NULL};
}
/* Whether what was found in a turn holds for what lies at a slot. */
static inline bool sk_watch_holds(const sk_watch *watch, uint64_t found, size_t slot) {
    return found > watch->since && watch->moved[slot / 16] < found;
}
/* What lies at a slot moves. (Threads that push pairs may say so at once.) */
static inline void sk_watch_move(const sk_watch *watch, size_t slot) {
    __atomic_store_n(&watch->moved[slot / 16], watch->now, __ATOMIC_RELAXED);
}

/* One line about an op, as `skein explain` shows it. */
void sk_op_describe(const sk_op *op, char *text, size_t size);
/* Bits of the vectors whose values before the op affect it, and of those that it writes. */
uint32_t sk_op_reads(const sk_op *op);
uint32_t sk_op_writes(const sk_op *op);

static inline const sk_op_type *sk_op_type_of(const sk_op *op) {
    return &sk_op_types[op->kind];
}
/* Whether it is an algorithm that decides when the ops after it run. */
static inline bool sk_op_decides(const sk_op *op) {
    return op->kernel && sk_op_type_of(op)->leads;
}
/* Whether it sets dst to 0. */
static inline bool sk_op_clears(const sk_op *op) {
    return sk_op_type_of(op)->reverse == SK_REVERSE_SUM && op->source[0] == SK_NONE;
}

/* Arithmetic on vectors: the kernels of combine ops, in the order of their names. Components w keep their values.
 *   dst = a p + b q + c r        (a source of SK_NONE is left out)
 *   dst += a (p - (q + b dst))   a correction of velocity: p has moved away from where dst would have taken q
 *   dst = p + a w q              a kick: w is the inverse mass
 *   wipe                         dst = 0, also w
 *   steer                        dst += q, where the inverse mass is not 0
 *   lead                         dst += a q, where the inverse mass is 0; dst is X
 *   pull                         dst += h (the plan's uniform force), where the inverse mass is not 0; dst is V
 *   predict                      V += h w F; V0 = V if the third source is V0; X0 = X, or X0 = X + h V if the third
 *                                source is X; X += h V: one op in place of four (plan/fuse.h)
 *   predict_uniform              the same, with the plan's uniform force in place of F
 *   correct_and_predict          V += a (X - X0), the end of a substep; then predict_uniform, the start of the next,
 *                                but not in the last iteration of its repeat
 *   rest                         dst = 0 where its size is at most a = SK_REST_SPEED: the end of a step */
extern const sk_kernels sk_combine_sum, sk_combine_correction, sk_combine_kick, sk_combine_wipe, sk_combine_steer,
    sk_combine_lead, sk_combine_pull, sk_combine_predict, sk_combine_predict_uniform, sk_combine_correct_and_predict,
    sk_combine_rest;
/* m/s: what is slower has come to rest (base/float_mode.h). The square of this number is not yet denormal. */
#define SK_REST_SPEED ((real)(sizeof(real) == sizeof(double) ? 1e-140 : 1e-18))
/* Convert blocks of dst from quads to packed and back, in place. */
extern const sk_kernels sk_pack, sk_unpack;

#endif
