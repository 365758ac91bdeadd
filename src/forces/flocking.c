/* Flocking: a particle steers away from near neighbours, along with farther ones, and towards those at the edge of the
 * reach (Reynolds 1987, in three zones). See flocking.h for the weights.
 *
 * For each particle the candidates in up to nine ranges of the cells are tested sixteen at a time; those within reach
 * are packed into a list, and evaluated sixteen at a time. The k-th of them is added to lane k mod 16, and the lanes
 * are added up in a fixed order: the same bits for any width. A particle finds itself among its neighbours, at distance
 * 0, where there is no direction: it adds nothing, nor does another in the same place. */
#include "forces/flocking.h"

#include <stdio.h>
#include <string.h>

#include "base/elementary.h"
#include "base/kernels.h"
#include "base/status.h"
#include "forces/pair_formula.h"
#include "formula/formula.h"

#define SK_UNIT flocking
SK_KERNELS(sk_op_kernel, kernel);

#ifdef SK_ISA

#include "space/cells_wide.h"

enum { AHEAD = 8 };
enum { ROOM = 256 }; // the room of the list of neighbours

/* Weights by formulas: their tapes, and room for the registers. */
typedef struct weight_formulas {
    const sk_pair_formula *pair;
    sk_wide registers[SK_PAIR_WEIGHTS][SK_TAPE_MEMORY / sizeof(sk_wide)];
} weight_formulas;

typedef struct neighbours {
    real x[ROOM + 2 * SK_LANES], y[ROOM + 2 * SK_LANES], z[ROOM + 2 * SK_LANES];
    real ux[ROOM + 2 * SK_LANES], uy[ROOM + 2 * SK_LANES], uz[ROOM + 2 * SK_LANES];
    size_t count;
    sk_vec3 heading;           // the particle's own direction; 0 if it is at rest, and then sees all round
    weight_formulas *formulas; // NULL: the zones' own weights
} neighbours;

SK_INLINE sk_wide wide_at(const real *at) {
    sk_wide a;
    memcpy(&a, at, sizeof a);
    return a;
}

/* Pointers to the cells' copies, in locals, which stores to the list cannot change. */
typedef struct cell_copies {
    const real *x, *y, *z, *ux, *uy, *uz;
} cell_copies;

#if SK_WIDTH < 64 && (defined(__SSSE3__) || defined(__wasm_simd128__)) && !defined(SKEIN_DOUBLE)
#define MOVES_UP
/* For each mask of four bits, the byte shuffle that packs the floats whose bits are set; 0 follows them. */
#define FLOAT(l_) 4 * (l_), 4 * (l_) + 1, 4 * (l_) + 2, 4 * (l_) + 3
#define NONE -1, -1, -1, -1
static const SK_VECTOR_ALIGNED int8_t moved_up[16][16] = {
    {NONE, NONE, NONE, NONE},
    {FLOAT(0), NONE, NONE, NONE},
    {FLOAT(1), NONE, NONE, NONE},
    {FLOAT(0), FLOAT(1), NONE, NONE},
    {FLOAT(2), NONE, NONE, NONE},
    {FLOAT(0), FLOAT(2), NONE, NONE},
    {FLOAT(1), FLOAT(2), NONE, NONE},
    {FLOAT(0), FLOAT(1), FLOAT(2), NONE},
    {FLOAT(3), NONE, NONE, NONE},
    {FLOAT(0), FLOAT(3), NONE, NONE},
    {FLOAT(1), FLOAT(3), NONE, NONE},
    {FLOAT(0), FLOAT(1), FLOAT(3), NONE},
    {FLOAT(2), FLOAT(3), NONE, NONE},
    {FLOAT(0), FLOAT(2), FLOAT(3), NONE},
    {FLOAT(1), FLOAT(2), FLOAT(3), NONE},
    {FLOAT(0), FLOAT(1), FLOAT(2), FLOAT(3)},
};
#undef FLOAT
#undef NONE

#ifdef __SSSE3__
typedef __m128i four_floats;
SK_INLINE four_floats load_four(const void *from) {
    return _mm_loadu_si128(from);
}
SK_INLINE void put_up(float *to, const float *from, four_floats order) {
    _mm_storeu_si128((__m128i *)(void *)to, _mm_shuffle_epi8(load_four(from), order));
}
#else
typedef v128_t four_floats;
SK_INLINE four_floats load_four(const void *from) {
    return wasm_v128_load(from);
}
SK_INLINE void put_up(float *to, const float *from, four_floats order) {
    wasm_v128_store(to, wasm_i8x16_swizzle(load_four(from), order));
}
#endif
#endif

/* Puts the candidates within reach into the list from k on, and returns its new end; d leads to them from the particle.
 * (The end is kept in a register: in the list itself, each addition would wait for the store before it, 40 cycles a
 * particle.) */
SK_INLINE size_t keep_near(neighbours *near, size_t k, const cell_copies *copies, size_t place, sk_wide3 d,
                           sk_wide squares, sk_wide square, uint32_t some) {
#if SK_WIDTH == 64 && !defined(SKEIN_DOUBLE)
    __mmask16 bits = _mm512_mask_cmp_ps_mask((__mmask16)some, (__m512)square, (__m512)squares, _CMP_GT_OQ);
    // one compression of lane numbers for six permutations: half the work of six compressions
    const sk_mask all = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
    __m512i lanes = _mm512_maskz_compress_epi32(bits, (__m512i)all);
    _mm512_storeu_ps(near->x + k, _mm512_permutexvar_ps(lanes, (__m512)d.x));
    _mm512_storeu_ps(near->y + k, _mm512_permutexvar_ps(lanes, (__m512)d.y));
    _mm512_storeu_ps(near->z + k, _mm512_permutexvar_ps(lanes, (__m512)d.z));
    _mm512_storeu_ps(near->ux + k, _mm512_permutexvar_ps(lanes, _mm512_loadu_ps(copies->ux + place)));
    _mm512_storeu_ps(near->uy + k, _mm512_permutexvar_ps(lanes, _mm512_loadu_ps(copies->uy + place)));
    _mm512_storeu_ps(near->uz + k, _mm512_permutexvar_ps(lanes, _mm512_loadu_ps(copies->uz + place)));
    return k + (size_t)__builtin_popcount(bits);
#elif defined(MOVES_UP)
    uint32_t bits = sk_more_bits(square, squares) & some; // (the former has none over a vector's lanes)
    // no early return if there are none: that branch is mispredicted too often
    const float *const from[6] = {(const float *)&d.x, (const float *)&d.y, (const float *)&d.z,
                                  copies->ux + place,  copies->uy + place,  copies->uz + place};
    float *const to[6] = {near->x, near->y, near->z, near->ux, near->uy, near->uz};
    for (int first = 0; first < SK_PART; first += 4, bits >>= 4) {
        const four_floats order = load_four(moved_up[bits & 15]);
        for (int i = 0; i < 6; i++) put_up(to[i] + k, from[i] + first, order);
        k += (size_t)__builtin_popcount(bits & 15);
    }
    return k;
#else
    uint32_t bits = sk_more_bits(square, squares) & some; // (the former has none over a vector's lanes)
    for (; bits; bits &= bits - 1, k++) {
        int l = __builtin_ctz(bits);
        near->x[k] = d.x[l], near->y[k] = d.y[l], near->z[k] = d.z[l];
        near->ux[k] = copies->ux[place + (size_t)l];
        near->uy[k] = copies->uy[place + (size_t)l];
        near->uz[k] = copies->uz[place + (size_t)l];
    }
    return k;
#endif
}

/* Keeps the n->count nearest of those in view, in their order; those in the same place do not count. */
static void prune(neighbours *near, const sk_flocking_numbers *n) {
    real square[ROOM + 2 * SK_LANES], best[SK_FLOCKING_MOST_NEAREST];
    int found = 0, ties = 0;
    for (size_t k = 0; k < near->count; k++) {
        sk_vec3 d = {near->x[k], near->y[k], near->z[k]};
        real s = square[k] = sk_dot(d, d);
        bool seen = n->sees_all || sk_dot(near->heading, near->heading) == 0 ||
                    sk_dot(d, near->heading) >= n->view * sk_sqrt(s);
        if (!(s > 0) || !seen) square[k] = 0;
        if (!(square[k] > 0) || (found == n->count && s >= best[found - 1])) continue;
        int at = found < n->count ? found++ : found - 1;
        for (; at > 0 && best[at - 1] > s; at--) best[at] = best[at - 1];
        best[at] = s;
    }
    real farthest = found ? best[found - 1] : 0;
    for (int k = found; k-- > 0 && best[k] == farthest;) ties++; // how many to keep at exactly the largest distance
    size_t kept = 0;
    real *lists[] = {near->x, near->y, near->z, near->ux, near->uy, near->uz};
    for (size_t k = 0; k < near->count; k++) {
        if (!(square[k] > 0) || square[k] > farthest || (square[k] == farthest && ties-- <= 0)) continue;
        for (int i = 0; i < 6; i++) lists[i][kept] = lists[i][k];
        kept++;
    }
    near->count = kept;
}

/* A vector of neighbours in the list. */
typedef struct hits {
    sk_wide3 d;
    sk_wide per, relative_distance; // 1/distance
    sk_mask counts;
} hits;

SK_INLINE hits hits_at(const neighbours *near, size_t k, const sk_flocking_numbers *n) {
    hits h = {.d = {wide_at(near->x + k), wide_at(near->y + k), wide_at(near->z + k)}};
    sk_wide least = sk_splat(n->least), square = sk_dot_wide(h.d, h.d);
    sk_wide distance = sk_wide_sqrt(square);
    distance = sk_select(sk_more(distance, least), distance, least);
    h.per = sk_splat(1) / distance;
    h.relative_distance = distance * sk_splat(n->per_reach);
    if (n->squared) h.relative_distance *= h.relative_distance;
    h.counts = sk_positive(square);
    if (!n->sees_all) {
        sk_vec3 u = near->heading;
        sk_wide ahead = h.d.x * sk_splat(u.x) + h.d.y * sk_splat(u.y) + h.d.z * sk_splat(u.z);
        real all_round = u.x * u.x + u.y * u.y + u.z * u.z > 0 ? 0 : 1; // a particle at rest sees all round
        h.counts &= sk_at_most(sk_splat(n->view) * distance, ahead + sk_splat(2 * all_round) * distance);
    }
    return h;
}

/* Adds the weighted contributions of a vector of neighbours. */
SK_INLINE void add_hits(const neighbours *near, size_t k, const hits *h, sk_wide towards, sk_wide with, sk_wide3 *sum) {
    towards = sk_keep(h->counts, towards * h->per);
    with = sk_keep(h->counts, with);
    sum->x += towards * h->d.x + with * wide_at(near->ux + k);
    sum->y += towards * h->d.y + with * wide_at(near->uy + k);
    sum->z += towards * h->d.z + with * wide_at(near->uz + k);
}

SK_INLINE void add_near(const neighbours *near, size_t k, const sk_flocking_numbers *n, sk_wide3 *sum) {
    hits h = hits_at(near, k, n);
    sk_wide one = sk_splat(1), half = sk_splat((real)0.5), away_to = sk_splat(n->away), along_to = sk_splat(n->along);
    sk_wide inverse = sk_splat(n->reach) * h.per; // 1/relative_distance
    if (n->squared) inverse *= inverse;
    sk_mask away = sk_more(away_to, h.relative_distance);
    sk_mask along = sk_more(along_to, h.relative_distance) & ~away;
    // from -0.5 to 0.5 through the zone
    sk_wide a = sk_select(along, (h.relative_distance - away_to) * sk_splat(n->per_along),
                          (h.relative_distance - along_to) * sk_splat(n->per_towards)) -
                half;
    sk_wide s = a * a, cosine = half * SK_FLOCKING_COSINE(s);
    sk_wide towards = sk_select(away, one - away_to * inverse, cosine);
    add_hits(near, k, &h, sk_keep(~along, towards), sk_keep(along, one - cosine), sum);
}

/* The same by formulas, for `count` neighbours from k on, a multiple of sixteen that fits the tape's block. */
static void add_by_formula(const neighbours *near, size_t k, size_t count, const sk_flocking_numbers *n,
                           sk_wide3 sum[SK_PARTS]) {
    const sk_pair_formula *pair = near->formulas->pair;
    sk_tape_verdict verdict[SK_PAIR_WEIGHTS];
    for (int w = 0; w < SK_PAIR_WEIGHTS; w++) {
        sk_wide *registers = near->formulas->registers[w];
        if (!pair->formula[w]) continue;
        size_t vectors = pair->tape[w].wides * SK_PARTS;
        for (size_t i = 0; i < vectors && pair->relative_distance[w] != UINT16_MAX; i++)
            registers[pair->relative_distance[w] * vectors + i] =
                hits_at(near, k + (SK_PART * i < count ? SK_PART * i : 0), n).relative_distance;
        sk_tape_kernels_of[SK_THIS_ISA]->run(&pair->tape[w], registers, vectors, vectors, &verdict[w]);
    }
    for (size_t i = 0; SK_PART * i < count; i++) {
        hits h = hits_at(near, k + SK_PART * i, n);
        sk_wide weight[SK_PAIR_WEIGHTS] = {{0}, {0}};
        for (int w = 0; w < SK_PAIR_WEIGHTS; w++) {
            size_t vectors = pair->tape[w].wides * SK_PARTS;
            if (pair->formula[w])
                weight[w] =
                    sk_keep(verdict[w].finite[i], near->formulas->registers[w][pair->tape[w].output[0] * vectors + i]);
        }
        add_hits(near, k + SK_PART * i, &h, weight[SK_TOWARDS], weight[SK_ALONG], &sum[i % SK_PARTS]);
    }
}

/* Adds `count` neighbours from the front of the list, a multiple of sixteen. */
SK_INLINE void add_all(const neighbours *near, size_t count, const sk_flocking_numbers *n, sk_wide3 sum[SK_PARTS]) {
    if (!near->formulas) {
        for (size_t k = 0; k < count; k += SK_LANES)
            for (size_t part = 0; part < SK_PARTS; part++) add_near(near, k + part * SK_PART, n, &sum[part]);
        return;
    }
    size_t block = SK_LANES * SK_TAPE_WIDES;
    for (int w = 0; w < SK_PAIR_WEIGHTS; w++)
        if (near->formulas->pair->formula[w] && SK_LANES * near->formulas->pair->tape[w].wides < block)
            block = SK_LANES * near->formulas->pair->tape[w].wides;
    for (size_t k = 0; k < count; k += block) add_by_formula(near, k, count - k < block ? count - k : block, n, sum);
}

/* Evaluates all whole sixteens of the list, and moves the rest to its front. */
SK_INLINE void work_out(neighbours *near, const sk_flocking_numbers *n, sk_wide3 sum[SK_PARTS]) {
    if (n->count) {
        prune(near, n);
        return;
    }
    size_t whole = near->count / SK_LANES * SK_LANES;
    add_all(near, whole, n, sum);
    real *lists[] = {near->x, near->y, near->z, near->ux, near->uy, near->uz};
    for (int i = 0; i < 6; i++) memcpy(lists[i], lists[i] + whole, SK_LANES * sizeof(real));
    near->count -= whole;
}

/* Tests the listed candidates, and keeps those within reach. */
SK_INLINE void test(const sk_cells *cells, const sk_flocking_numbers *n, sk_vec3 p, sixteen_lists *sixteens,
                    neighbours *near, sk_wide3 sum[SK_PARTS]) {
    sk_wide square = sk_splat(n->reach * n->reach);
    const sk_wide3 here = {sk_splat(p.x), sk_splat(p.y), sk_splat(p.z)};
    const cell_copies copies = {cells->x, cells->y, cells->z, cells->ux, cells->uy, cells->uz};
    size_t count = near->count;
    for (size_t k = 0, all = sixteens->count; k < all; k++) {
        size_t place = sixteens->place[k];
        for (uint32_t some = sixteens->some[k]; some; some >>= SK_PART % 32, place += SK_PART) {
            sk_wide3 d = {wide_at(copies.x + place) - here.x, wide_at(copies.y + place) - here.y,
                          wide_at(copies.z + place) - here.z};
            count = keep_near(near, count, &copies, place, d, sk_dot_wide(d, d), square, some);
        }
        if (count < ROOM) continue;
        near->count = count;
        work_out(near, n, sum);
        count = near->count;
    }
    near->count = count;
    sixteens->count = 0;
}

/* The steering of one particle at p. */
SK_INLINE sk_vec3 steer(const sk_cells *cells, const nine_lines *lines, const sk_flocking_numbers *n, sk_vec3 p,
                        neighbours *near) {
    nine_ranges ranges;
    find_ranges(cells, lines, p, n->reach, &ranges);
    sixteen_lists sixteens;
    sixteens.count = 0;
    sk_wide3 sum[SK_PARTS] = {{{0}, {0}, {0}}};
    near->count = 0;
    // ranges of over 32 are few: lists twice before testing
    list(&ranges, &sixteens);
    list(&ranges, &sixteens);
    while (list(&ranges, &sixteens))
        if (sixteens.count >= SIXTEENS) test(cells, n, p, &sixteens, near, sum);
    test(cells, n, p, &sixteens, near, sum);
    if (n->count) prune(near, n);
    // fill up with neighbours in the same place, which add nothing
    real *lists[] = {near->x, near->y, near->z, near->ux, near->uy, near->uz};
    for (int i = 0; i < 6; i++) memset(lists[i] + near->count, 0, SK_LANES * sizeof(real));
    add_all(near, (near->count + SK_LANES - 1) / SK_LANES * SK_LANES, n, sum);
    sk_wide x[SK_PARTS], y[SK_PARTS], z[SK_PARTS];
    for (int i = 0; i < SK_PARTS; i++) x[i] = sum[i].x, y[i] = sum[i].y, z[i] = sum[i].z;
    return sk_v3(sk_sum(x), sk_sum(y), sk_sum(z));
}

SK_INLINE sk_vec3 heading_of(sk_vec4 v) {
    real speed = sk_length(sk_xyz(v));
    return speed > 0 && speed <= (real)SK_REAL_MAX ? sk_scale(1 / speed, sk_xyz(v)) : sk_v3(0, 0, 0);
}

/* Elements are places if the rule's particles are each other's neighbours, else the user's particles. */
static void fly(sk_run *run, const sk_op *op, size_t begin, size_t end, weight_formulas *formulas) {
    const sk_force *force = op->rule;
    const sk_flocking_params *params = force->params;
    const sk_flocking_numbers numbers = sk_flocking_numbers_of(params);
    const sk_cells *cells = run->cells;
    bool among = force->moved.first == force->seen.first && force->moved.end == force->seen.end;
    real scale = (real)(op->dt * params->strength);
    nine_lines lines = lines_of(cells);
    neighbours near;
    near.formulas = formulas;
    if (!cells->count) return; // no neighbours, or no memory for the cells
    if (among && end > cells->count) end = cells->count;
    for (size_t i = begin; i < end; i++) {
        uint32_t slot = among ? cells->slot[i] : run->slot_of[i];
        // slots may be anywhere in memory
        if (among) __builtin_prefetch(&run->vector[op->dst][cells->slot[i + AHEAD < end ? i + AHEAD : i]], 1);
        sk_vec3 p =
            among ? sk_v3(cells->x[i], cells->y[i], cells->z[i]) : sk_xyz(sk_load(run->vector[SK_X], op->packed, slot));
        near.heading = sk_v3(0, 0, 0);
        if (!numbers.sees_all) near.heading = heading_of(sk_load(run->vector[SK_V], op->packed, slot));
        sk_add_at(run->vector[op->dst], op->packed, slot, sk_scale(scale, steer(cells, &lines, &numbers, p, &near)));
    }
}

static void fly_by_formula(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    weight_formulas formulas;
    formulas.pair = ((const sk_flocking_params *)((const sk_force *)op->rule)->params)->pair;
    sk_tape_input input = {.time = (real)run->time};
    for (int w = 0; w < SK_PAIR_WEIGHTS; w++)
        if (formulas.pair->formula[w])
            sk_tape_kernels_of[SK_THIS_ISA]->begin(&formulas.pair->tape[w], &input, formulas.registers[w],
                                                   formulas.pair->tape[w].wides * SK_PARTS);
    fly(run, op, begin, end, &formulas);
}

void SK_KERNEL(kernel)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    const sk_flocking_params *params = ((const sk_force *)op->rule)->params;
    if (params->pair) fly_by_formula(run, op, begin, end);
    else fly(run, op, begin, end, NULL);
}

#else

// clang-format off
static const skein_field fields[] = {
    SK_REAL(sk_flocking_params, separation, "separation", "m", 45, 0, 1e9, "width of the zone whose neighbours push away"),
    SK_REAL(sk_flocking_params, alignment, "alignment", "m", 20, 0, 1e9, "and of the next zone, whose neighbours are flown along with"),
    SK_REAL(sk_flocking_params, cohesion, "cohesion", "m", 35, 0, 1e9, "and of the last, at whose edges neighbours are drawn to; 0, 0, 0: no neighbours"),
    {"measure", SKEIN_FIELD_CHOICE, offsetof(sk_flocking_params, measure), "", {0, 0, 0}, 0, 0, "distance|distance^2", NULL,
     "how far through the zones a neighbour is: by its distance, or by the square of it"},
    SK_REAL(sk_flocking_params, strength, "strength", "m/s2", 1, 0, SK_FAR, "how strongly each neighbour counts"),
    SK_REAL(sk_flocking_params, view, "view", "degrees", 360, 0, 360, "the angle that each sees, round its direction of flight; 360: all round"),
    SK_INT(sk_flocking_params, nearest, "nearest", "", 0, 0, SK_FLOCKING_MOST_NEAREST, "of the neighbours in reach only so many count, the nearest; 0: all"),
    SK_TEXT(sk_flocking_params, neighbours, "neighbours", "", "the names of the bodies, or of groups of them, that it looks at, commas between them; empty: those that it is `on`"),
    SK_TEXT(sk_flocking_params, towards, "formula.towards", "", "the weight of a neighbour along the direction to it, as a formula of `relative_distance` (0 beside it, 1 at the reach); where there is a formula, the zones only say how far the rule reaches"),
    SK_TEXT(sk_flocking_params, along, "formula.along", "", "the weight along its direction of flight, likewise"),
};
// clang-format on

static double radius(const void *data) {
    const sk_flocking_params *params = data;
    return params->separation + params->alignment + params->cohesion;
}

static const char *neighbours(const void *data) {
    return ((const sk_flocking_params *)data)->neighbours;
}

static skein_status make(void *data, const skein_kind *kind, sk_allocator *allocator, skein_error *error) {
    sk_flocking_params *params = data;
    sk_pair_formula *pair;
    (void)kind;
    skein_status status =
        sk_pair_formula_create(&pair, (const char *const[]){params->towards, params->along},
                               (const char *const[]){"formula.towards", "formula.along"}, allocator, error);
    if (status) return status;
    sk_pair_formula_release(params->pair, allocator);
    params->pair = pair;
    return SKEIN_OK;
}

static void unmake(void *data, sk_allocator *allocator) {
    sk_pair_formula_release(((sk_flocking_params *)data)->pair, allocator);
}

static const sk_making making = {.make = make, .unmake = unmake};

sk_flocking_numbers sk_flocking_numbers_of(const sk_flocking_params *params) {
    double reach = radius(params);
    if (!(reach > 0)) return (sk_flocking_numbers){0};
    double away = params->separation / reach, along = (params->separation + params->alignment) / reach;
    return (sk_flocking_numbers){
        .reach = (real)reach,
        .per_reach = (real)(1 / reach),
        .away = (real)away,
        .along = (real)along,
        .per_along = params->alignment > 0 ? (real)(1 / (along - away)) : 0,
        .per_towards = params->cohesion > 0 ? (real)(1 / (1 - along)) : 0,
        .least = (real)(1e-4 * reach),
        .squared = params->measure != 0,
        .sees_all = params->view >= 360,
        .view = (real)sk_cos(params->view * (3.141592653589793 / 360)),
        .count = params->nearest,
    };
}

static void pack(const void *data, float (*block)[4]) {
    const sk_flocking_params *params = data;
    sk_flocking_numbers n = sk_flocking_numbers_of(params);
    const float numbers[3][4] = {
        {(float)n.per_reach, (float)n.away, (float)n.along, (float)n.per_along},
        {(float)n.per_towards, (float)n.least, (float)params->strength, n.squared ? 1.0f : 0.0f},
        {n.sees_all ? -2.0f : (float)n.view, 0, 0, 0}};
    memcpy(block, numbers, sizeof numbers);
}

static bool write(const void *data, void (*put)(void *user, const char *text), void *user) {
    const sk_flocking_params *params = data;
    char line[64];
    snprintf(line, sizeof line, "#define MOST@ %d\n", (int)params->nearest);
    if (params->nearest) put(user, line);
    if (!params->pair) return true;
    put(user, "#define FORMULA@\n");
    return sk_pair_formula_put_glsl(params->pair, put, user);
}

static bool changes(const void *data) {
    const sk_pair_formula *pair = ((const sk_flocking_params *)data)->pair;
    for (int w = 0; pair && w < SK_PAIR_WEIGHTS; w++)
        if (pair->formula[w] && pair->formula[w]->uses & SK_USES_TIME) return true;
    return false;
}

const sk_force_type sk_flocking = {
    .kind = {"flocking", "neighbours push apart, fly along or draw together, by how far they are", SKEIN_FORCE, fields,
             sizeof fields / sizeof *fields, sizeof(sk_flocking_params)},
    .domain = SK_OVER_NEIGHBOURS,
    .phase = SK_STEERS,
    .kernel = {SK_EACH_ISA(kernel)},
    .radius = radius,
    .neighbours = neighbours,
    .making = &making,
    .shader = {.file = "forces/flocking", .size = 3, .pack = pack, .write = write, .changes = changes},
};
#endif
