/* Which panels lie spread out: bounds on how their triangles lie, sixteen panels at a time, and the boxes around them. */
#include <string.h>

#include "base/kernels.h"
#include "base/tasks.h"
#include "contact/touch.h"
#define SK_UNIT spread

/* J of sixteen panels: the least and the most of its numbers. */
typedef struct sk_panel_bounds {
    SK_VECTOR_ALIGNED real least[6][SK_PANEL_LANES], most[6][SK_PANEL_LANES];
} sk_panel_bounds;
/* Whether panels are within some distance of where they are expected at some share of their courses; and, where somebody may be
 * held back, were so had they gone a common way. */
typedef struct sk_course_values {
    real share, off;
    bool held; // somebody may be, and goes
    sk_vec3 common;
} sk_course_values;
/* Of places x of vertices; J is noted. With `course`, returns whether a panel is off its course. */
typedef bool sk_measure_kernel(const sk_vec4 *x, const sk_spread *spread, size_t group, const sk_course_values *course,
                               sk_panel_bounds *out);
SK_KERNELS(sk_measure_kernel, measure);
/* The square of the longest way of all slots. */
typedef real sk_longest_kernel(const sk_vec4 *before, const sk_vec4 *x, size_t packed, size_t slots);
SK_KERNELS(sk_longest_kernel, longest);

#ifdef SK_ISA
#include "contact/lanes.h"

/* Bounds of sixteen panels, while their rows are gone through. */
typedef struct bounds {
    sk_wide least[6], most[6], change, low[3], high[3];
} bounds;

/* J = [d1 d2] / [u1 u2], where d are differences of corners and u those on the plane. */
SK_INLINE void add_triangle(bounds *b, sk_wide3 d1, sk_wide3 d2, real (*inverse)[SK_PANEL_LANES],
                            real (*gradient)[SK_PANEL_LANES], size_t l) {
    const sk_wide i0 = *sk_row(inverse[0] + l), i1 = *sk_row(inverse[1] + l);
    const sk_wide i2 = *sk_row(inverse[2] + l), i3 = *sk_row(inverse[3] + l);
    const sk_wide j[6] = {d1.x * i0 + d2.x * i1, d1.y * i0 + d2.y * i1, d1.z * i0 + d2.z * i1,
                          d1.x * i2 + d2.x * i3, d1.y * i2 + d2.y * i3, d1.z * i2 + d2.z * i3};
    sk_wide change = sk_splat(0);
    for (int k = 0; k < 6; k++) {
        sk_wide *was = sk_row_to(gradient[k] + l), off = j[k] - *was;
        change = change + off * off;
        *was = j[k];
        b->least[k] = sk_least_wide(b->least[k], j[k]);
        b->most[k] = sk_most_wide(b->most[k], j[k]);
    }
    b->change = sk_most_wide(b->change, change);
}

/* Lanes that are out of bounds along an axis. */
SK_INLINE uint32_t off_course(const sk_panels *panels, const bounds *b, size_t l, int k,
                              const sk_course_values *course) {
    const sk_tree_block *c = &panels->course;
    const real common = k == 0 ? course->common.x : k == 1 ? course->common.y : course->common.z;
    const sk_wide share = sk_splat(course->share), off = sk_splat(course->off), way = sk_splat(common);
    const sk_wide low = *sk_row(c->low[0][k] + l), high = *sk_row(c->high[0][k] + l);
    const sk_wide least = low + share * (*sk_row(c->low[1][k] + l) - low) - off;
    const sk_wide most = high + share * (*sk_row(c->high[1][k] + l) - high) + off;
    sk_wide first = b->low[k], last = b->high[k];
    if (course->held) {
        first = sk_least_wide(first, *sk_row(panels->low[k] + l) + way);
        last = sk_most_wide(last, *sk_row(panels->high[k] + l) + way);
    }
    return sk_more_bits(least, first) | sk_more_bits(last, most);
}

bool SK_KERNEL(measure)(const sk_vec4 *x, const sk_spread *spread, size_t group, const sk_course_values *course,
                        sk_panel_bounds *out) {
    const sk_wide far = sk_splat(SK_REAL_MAX);
    sk_panels *panels = &spread->sixteen[group];
    uint32_t off = 0;
    for (size_t l = 0; l < SK_PANEL_LANES; l += SK_PART) {
        bounds b = {.change = sk_splat(0)};
        for (int k = 0; k < 6; k++) b.least[k] = far, b.most[k] = -far;
        for (int k = 0; k < 3; k++) b.low[k] = far, b.high[k] = -far;
        for (size_t r = spread->row_start[group]; r < spread->row_start[group + 1]; r++) {
            sk_wide3 at[4];
            for (int c = 0; c < 4; c++) {
                sk_wide4 here = sk_gather(x, spread->corner[r][c] + l);
                at[c] = (sk_wide3){here.x, here.y, here.z};
                b.low[0] = sk_least_wide(b.low[0], here.x), b.high[0] = sk_most_wide(b.high[0], here.x);
                b.low[1] = sk_least_wide(b.low[1], here.y), b.high[1] = sk_most_wide(b.high[1], here.y);
                b.low[2] = sk_least_wide(b.low[2], here.z), b.high[2] = sk_most_wide(b.high[2], here.z);
            }
            const sk_wide3 along = {at[1].x - at[0].x, at[1].y - at[0].y, at[1].z - at[0].z};
            for (int t = 0; t < 2; t++) {
                const sk_wide3 other = {at[2 + t].x - at[0].x, at[2 + t].y - at[0].y, at[2 + t].z - at[0].z};
                add_triangle(&b, along, other, spread->inverse[r][t], spread->gradient[r][t], l);
            }
        }
        for (int k = 0; k < 6; k++)
            *sk_row_to(out->least[k] + l) = b.least[k], *sk_row_to(out->most[k] + l) = b.most[k];
        for (int k = 0; k < 3; k++) {
            if (course) off |= off_course(panels, &b, l, k, course);
            *sk_row_to(panels->low_before[k] + l) = *sk_row(panels->low[k] + l);
            *sk_row_to(panels->high_before[k] + l) = *sk_row(panels->high[k] + l);
            *sk_row_to(panels->low[k] + l) = b.low[k];
            *sk_row_to(panels->high[k] + l) = b.high[k];
        }
        *sk_row_to(panels->change + l) = b.change;
    }
    return off;
}

real SK_KERNEL(longest)(const sk_vec4 *before, const sk_vec4 *x, size_t packed, size_t slots) {
    sk_wide most = sk_splat(0);
    for (size_t b = 0; b < slots; b += 16)
        for (size_t l = b; l < b + 16; l += SK_PART) {
            sk_wide4 from = sk_load_part(before, l, b < packed), to = sk_load_part(x, l, b < packed);
            sk_wide3 way = {to.x - from.x, to.y - from.y, to.z - from.z};
            most = sk_most_wide(most, sk_dot_wide(way, way));
        }
    real square = 0;
    for (size_t l = 0; l < SK_PART; l++) square = sk_max(square, most[l]);
    return square;
}
#else
static sk_longest_kernel *const longest_kernel[SK_ISA_COUNT] = SK_EACH_ISA(longest);
static sk_measure_kernel *const measure_kernel[SK_ISA_COUNT] = SK_EACH_ISA(measure);

enum { GROUPS_AT_ONCE = 4, BLOCKS_AT_ONCE = 64, REST = 4 };

/* A pair that loses less than nine tenths of its gap in a substep does not close. */
static const real closing_share = (real)0.8;
/* Who is to go out has to have more room, such a share of what there is at most: it is looked for if it comes in. */
static const real room = (real)0.2;

/* What is looked for passes over all leaves, and who comes in is looked for at once: so it pays only where that much of all is out,
 * to begin with, and then. (An irregular disc that swings and folds took 1.1 times as long without these, and 0.75 and 0.5 leave it so.) */
static const double most_to_begin = 0.9, most_to_stay = 0.7;

/* ---- where panels are, and how they lie ---- */

typedef struct measuring {
    sk_touch *touch;
    const sk_vec4 *x;
    const sk_course_values *course;
} measuring;

/* How far from where they are expected panels may be. */
static real off_course_of(const sk_touch *touch) {
    return touch->thickness;
}

static void measure_some(void *data, int thread, size_t begin, size_t end) {
    (void)thread;
    const measuring *job = data;
    sk_touch *touch = job->touch;
    sk_spread *spread = &touch->spread;
    for (size_t g = begin; g < end; g++) {
        sk_panel_bounds m;
        if (measure_kernel[touch->isa](job->x, spread, g, job->course, &m))
            __atomic_store_n(&spread->off_course, true, __ATOMIC_RELAXED);
        for (size_t l = 0, p = g * SK_PANEL_LANES; l < SK_PANEL_LANES && p < spread->count; l++, p++)
            for (int k = 0; k < 6; k++) spread->least[p][k] = m.least[k][l], spread->least[p][6 + k] = -m.most[k][l];
    }
}

/* Where vertices are at x: on their ways, or not. */
static void measure(sk_touch *touch, const sk_vec4 *x, bool ways) {
    const sk_spread *spread = &touch->spread;
    const bool held = spread->out_count < spread->count; // somebody may be, and goes the common way
    const sk_course_values course = {(real)(spread->age + 1) / SK_PANEL_AHEAD, off_course_of(touch), held,
                                     touch->common};
    measuring job = {touch, x, ways && spread->age < SK_PANEL_AHEAD ? &course : NULL};
    const size_t groups = (spread->count + SK_PANEL_LANES - 1) / SK_PANEL_LANES;
    sk_parallel_pieces(touch->tasks, 0, groups, GROUPS_AT_ONCE, measure_some, &job);
}

/* How well places are known. */
static real rounding_of(const sk_spread *spread, size_t p) {
    const real share = sizeof(real) == 8 ? (real)4e-15 : (real)2e-6;
    const sk_panels *panels = &spread->sixteen[p / SK_PANEL_LANES];
    const size_t l = p % SK_PANEL_LANES;
    real far = 0;
    for (int k = 0; k < 3; k++) far = sk_max(far, sk_max(sk_abs(panels->low[k][l]), sk_abs(panels->high[k][l])));
    return share * far;
}

static real change_of(const sk_spread *spread, size_t p) {
    return spread->sixteen[p / SK_PANEL_LANES].change[p % SK_PANEL_LANES];
}

/* c / |A| of a block and those around it, where A is the middle of all J; and the most that J has changed, squared. */
static real keeps_of(const sk_spread *spread, size_t b, real *change) {
    real least[16];
    const uint32_t first = spread->around.start[b], end = spread->around.start[b + 1];
    memcpy(least, spread->least[spread->around.number[first]], sizeof least);
    *change = change_of(spread, spread->around.number[first]);
    for (uint32_t i = first + 1; i < end; i++) {
        const real *other = spread->least[spread->around.number[i]];
        for (int k = 0; k < 16; k++) least[k] = other[k] < least[k] ? other[k] : least[k];
        *change = sk_max(*change, change_of(spread, spread->around.number[i]));
    }
    real a[6], half[6];
    for (int k = 0; k < 6; k++)
        a[k] = (real)0.5 * (least[k] - least[6 + k]), half[k] = (real)-0.5 * (least[k] + least[6 + k]);
    real uu = 0, vv = 0, uv = 0, off_u = 0, off_v = 0, across = 0;
    for (int k = 0; k < 3; k++) {
        real u = sk_abs(a[k]), v = sk_abs(a[3 + k]);
        uu += a[k] * a[k], vv += a[3 + k] * a[3 + k], uv += a[k] * a[3 + k];
        off_u += u * half[k], off_v += v * half[3 + k], across += u * half[3 + k] + v * half[k];
    }
    real c = sk_min(uu - off_u, vv - off_v) - sk_abs(uv) - (real)0.5 * across, norm = sk_max(uu, vv) + sk_abs(uv);
    return norm > 0 ? c / sk_sqrt(norm) : 0;
}

/* Whether nothing of a block comes near anything else of it; by so much more than it must. */
static bool lies_spread(sk_touch *touch, size_t b, bool ways) {
    const sk_spread *spread = &touch->spread;
    sk_panel_block *block = &touch->spread.block[b];
    if (!block->whole) return false;
    // as pairs are no thicker than nine tenths of what they were apart
    const real thickness = sk_min(touch->thickness, (real)0.9 * block->apart);
    const real need = (SK_NEAR_THICKNESSES + (real)0.01) * thickness +
                      rounding_of(spread, spread->members.number[spread->members.start[b]]);
    real change, keeps = keeps_of(spread, b, &change), kept = block->keeps, off = block->steep * spread->gone;
    block->keeps = keeps;
    const real least = block->spread ? need : need + room * (block->apart - need);
    if (!(keeps * block->apart > least)) return false; // of what is no number, neither
    return !ways || (sk_sqrt(change) + off) * block->across < closing_share * (kept - off);
}

/* How far vertices may go until a block may not be spread. */
static real room_of(const sk_touch *touch, const sk_panel_block *block) {
    const real least = (SK_NEAR_THICKNESSES + (real)0.02) * touch->thickness / block->apart; // (or less)
    return sk_min(block->keeps - least, closing_share * least / block->across) / block->steep;
}

typedef struct judging {
    sk_touch *touch;
    bool ways;
} judging;

static void judge_some(void *data, int thread, size_t begin, size_t end) {
    (void)thread;
    const judging *job = data;
    for (size_t b = begin; b < end; b++) job->touch->spread.block[b].spread = lies_spread(job->touch, b, job->ways);
}

static bool are_spread(const sk_spread *spread, size_t p) {
    bool all = spread->blocks.start[p] < spread->blocks.start[p + 1];
    for (uint32_t i = spread->blocks.start[p]; i < spread->blocks.start[p + 1]; i++)
        all &= spread->block[spread->blocks.number[i]].spread;
    return all;
}

/* ---- boxes ---- */

/* What has blown up is everywhere. */
static void bound_box(sk_box *box) {
    const real far = (real)1e15;
    for (int end = 0; end < 2; end++)
        for (int k = 0; k < 3; k++) {
            if (!(box->low[end][k] > -far)) box->low[end][k] = -far;
            if (!(box->high[end][k] < far)) box->high[end][k] = far;
            if (!(box->low[end][k] < far)) box->low[end][k] = -far;
            if (!(box->high[end][k] > -far)) box->high[end][k] = far;
        }
}

/* Boxes of panels: of their ways, and of who is held back and goes what all go together; or where they are. */
static void box_panels(sk_touch *touch, bool ways) {
    sk_spread *spread = &touch->spread;
    const real common[3] = {touch->common.x, touch->common.y, touch->common.z},
               gone = spread->gone; // (since they were before)
    const bool held = spread->out_count < spread->count;
    for (size_t p = 0; p < spread->count; p++) {
        const sk_panels *panels = &spread->sixteen[p / SK_PANEL_LANES];
        const size_t l = p % SK_PANEL_LANES;
        sk_box box = {{{0}}, {{0}}};
        for (int k = 0; k < 3; k++) {
            real low = panels->low[k][l], high = panels->high[k][l];
            if (ways) {
                real from = panels->low_before[k][l] - gone, to = panels->high_before[k][l] + gone;
                low = sk_min(low, from), high = sk_max(high, to);
                if (held) low = sk_min(low, from + common[k]), high = sk_max(high, to + common[k]);
            }
            box.low[0][k] = box.low[1][k] = low, box.high[0][k] = box.high[1][k] = high;
        }
        spread->box[p] = box;
        bound_box(&spread->box[p]);
    }
}

/* Puts all boxes into the tree. */
static void fit(sk_spread *spread) {
    const sk_quad nowhere = {SK_REAL_MAX, SK_REAL_MAX, SK_REAL_MAX, 0};
    sk_tree *tree = &spread->tree;
    for (int level = 0; level < tree->levels; level++)
        for (size_t b = 0; b < tree->blocks[level]; b++)
            for (size_t l = 0, i = b * SK_TREE_WIDTH; l < SK_TREE_WIDTH; l++, i++) {
                sk_tree_block *block = &tree->block[level][b];
                const bool there = i < (level ? tree->blocks[level - 1] : spread->count);
                sk_box box = {{nowhere, nowhere}, {-nowhere, -nowhere}};
                if (there) box = level ? sk_box_around(&tree->block[level - 1][i]) : spread->wide[i];
                for (int n = 0; n < 6; n++) {
                    const int end = n / 3, k = n % 3;
                    block->low[end][k][l] = box.low[end][k], block->high[end][k][l] = box.high[end][k];
                }
            }
}

static bool is_beside(const sk_spread *spread, size_t p, size_t other) {
    for (uint32_t i = spread->beside.start[p]; i < spread->beside.start[p + 1]; i++)
        if (spread->beside.number[i] == other) return true;
    return false;
}

/* Who is out and may come nearer to another one that is not beside it comes in, and so does that. */
static void part(sk_touch *touch, real near) {
    sk_spread *spread = &touch->spread;
    const real half = (real)0.5 * near;
    const sk_quad wider = {half, half, half, 0};
    uint32_t hit[SK_TREE_WIDTH * SK_TREE_WIDTH];
    for (size_t p = 0; p < spread->count; p++)
        for (int end = 0; end < 2; end++) {
            spread->wide[p].low[end] = spread->box[p].low[end] - wider;
            spread->wide[p].high[end] = spread->box[p].high[end] + wider;
        }
    fit(spread);
    for (size_t a = 0; a < spread->tree.blocks[0]; a++) {
        const size_t first = a * SK_TREE_WIDTH, left = spread->count - first;
        const uint32_t lanes = left < SK_TREE_WIDTH ? (1u << left) - 1 : (1u << SK_TREE_WIDTH) - 1;
        sk_box all = spread->wide[first];
        for (size_t p = first + 1; p < first + SK_TREE_WIDTH && p < spread->count; p++)
            sk_box_widen(&all, &spread->wide[p]);
        size_t blocks = sk_tree_blocks[touch->isa](&spread->tree, &all, a, spread->met);
        for (size_t k = 0; k < blocks; k++) {
            size_t b = spread->met[k],
                   count = sk_tree_hits[touch->isa](&spread->tree, a, b, lanes, spread->wide, true, hit);
            for (size_t i = 0; i < count; i++) {
                size_t p = first + (hit[i] >> SK_TREE_SHIFT), other = b * SK_TREE_WIDTH + hit[i] % SK_TREE_WIDTH;
                if (p == other || !(spread->out[p] | spread->out[other]) || is_beside(spread, p, other)) continue;
                spread->out[p] = spread->out[other] = 0;
            }
        }
    }
}

/* ---- who is out ---- */

static void mark_corners(const sk_touch *touch, size_t p, uint8_t *mark, uint8_t bit) {
    const sk_spread *spread = &touch->spread;
    const sk_skin *skin = &touch->skin;
    for (uint32_t i = spread->leaves.start[p]; i < spread->leaves.start[p + 1]; i++) {
        const sk_leaf *leaf = &skin->leaf[spread->leaves.number[i]];
        for (uint32_t t = leaf->first_triangle; t < leaf->first_triangle + leaf->triangles; t++)
            for (int c = 0; c < 3; c++) mark[skin->triangle[t][c]] |= bit;
        for (uint32_t e = leaf->first_edge; e < leaf->first_edge + leaf->edges; e++)
            for (int c = 0; c < 2; c++) mark[skin->edge[e][c]] |= bit;
    }
}

/* Notes which patches have no leaf that is in. */
static void turn_patches(sk_touch *touch) {
    sk_spread *spread = &touch->spread;
    sk_calm *calm = &touch->calm;
    const size_t leaves = touch->skin.leaf_count;
    for (size_t p = 0; p < calm->patch_count; p++) {
        bool out = true;
        for (size_t slot = p * SK_PATCH_LEAVES; slot < (p + 1) * SK_PATCH_LEAVES && slot < leaves; slot++)
            out &= spread->out[spread->of_leaf[touch->tree.leaf_at[slot]]];
        if (out) calm->patch[p] = (sk_calm_patch){.calm = false};
        calm->holds[p / SK_PATCH_LANES] = -1; // it is to be looked at
        spread->patch_out[p] = out;
    }
}

/* After panels have come in or gone out: vertices that need a course, and others have none; lost are those who need one from now
 * on, and all of panels that have come in, for nobody has looked for what is near these. */
static bool turn(sk_touch *touch) {
    enum { IN = 1, CAME = 2 };
    sk_spread *spread = &touch->spread;
    uint8_t *mark = spread->mark;
    const bool none_had = spread->out_count == spread->count; // a course
    bool any = false;
    memset(mark, 0, touch->skin.vertex_count);
    spread->out_count = 0;
    for (size_t p = 0; p < spread->count; p++) {
        spread->out_count += spread->out[p];
        spread->went_out |= spread->out[p] && !spread->was_out[p];
        spread->turned[p] |= spread->out[p] != spread->was_out[p];
        if (spread->out[p]) continue;
        mark_corners(touch, p, mark, spread->was_out[p] ? IN | CAME : IN);
        for (uint32_t i = spread->beside.start[p]; i < spread->beside.start[p + 1]; i++)
            if (spread->out[spread->beside.number[i]]) mark_corners(touch, spread->beside.number[i], mark, IN);
    }
    for (size_t v = 0; v < touch->skin.vertex_count; v++) {
        const bool in = mark[v] & IN, out = spread->vertex_out[v];
        if (in != out && !(mark[v] & CAME)) continue;
        spread->vertex_out[v] = !in;
        sk_touch_put_course(touch, v, in); // until it gets one
        touch->lost[v] |= in;
        any |= in;
    }
    memcpy(spread->was_out, spread->out, spread->count);
    if (any &&
        none_had) { // courses begin here, and boxes do not lead far ahead, although for long nobody has left a course
        touch->now = 0, touch->until = 10;
        touch->lost_since = touch->skin.vertex_count;
    }
    turn_patches(touch);
    touch->holds = false;
    return any;
}

/* What is no nearer along an axis is not near. */
static real near_of(const sk_touch *touch) {
    return (SK_NEAR_THICKNESSES + (real)0.01) * touch->thickness;
}

/* Whether so few are out that it does not pay. */
static bool are_few_out(const sk_spread *spread) {
    size_t out = 0;
    for (size_t p = 0; p < spread->count; p++) out += spread->out[p];
    return !spread->eager && (double)out < (spread->out_count ? most_to_stay : most_to_begin) * (double)spread->count;
}

/* Judges all where they have been measured; whether vertices are lost. */
static bool judge(sk_touch *touch, bool more, bool ways) {
    sk_spread *spread = &touch->spread;
    judging job = {touch, ways};
    spread->holds = 0;
    sk_parallel_pieces(touch->tasks, 0, spread->block_count, BLOCKS_AT_ONCE, judge_some, &job);
    for (size_t p = 0; p < spread->count; p++)
        if (spread->out[p] || more) spread->out[p] = are_spread(spread, p);
    if (ways && spread->age < SK_PANEL_AHEAD && !spread->off_course && !(spread->gone > 0)) spread->age++;
    else {
        box_panels(touch, ways);
        part(touch, (more ? 1 + room : 1) * near_of(touch));
        spread->age = SK_PANEL_AHEAD;
    }
    spread->off_course = false;
    if (!memcmp(spread->was_out, spread->out, spread->count)) return false;
    if (are_few_out(spread)) {
        memset(spread->out, 0, spread->count);
        spread->rest = REST;
        if (!spread->out_count) return false;
    }
    return turn(touch);
}

bool sk_spread_look(sk_touch *touch, bool more) {
    sk_spread *spread = &touch->spread;
    spread->thickness = touch->thickness;
    spread->stale = false;
    measure(touch, touch->p, false);
    bool lost = judge(touch, more, false);
    spread->gone = 0;
    return lost;
}

/* Where vertices are slow, and all are out: how long that holds. */
static void look_ahead(sk_touch *touch, real way) {
    sk_spread *spread = &touch->spread;
    const real margin = (real)0.5 * touch->thickness, few = 16; // substeps
    if (!(few * way < margin)) return;
    real least = (real)0.5 * margin;
    for (size_t b = 0; b < spread->block_count && least > way; b++)
        least = sk_min(least, room_of(touch, &spread->block[b]));
    if (!(least > way)) return;
    box_panels(touch, true);
    part(touch, near_of(touch) + margin);
    if (!memchr(spread->out, 0, spread->count)) spread->holds = least;
    memcpy(spread->out, spread->was_out, spread->count);
}

/* Whether all that are out stay apart from all others as they go on: then boxes need not be compared for a while. */
static void set_courses(sk_touch *touch) {
    enum { WAIT = 8 }; // where they do not
    sk_spread *spread = &touch->spread;
    if (spread->wait-- > 0) return;
    for (size_t p = 0; p < spread->count; p++) {
        sk_panels *panels = &spread->sixteen[p / SK_PANEL_LANES];
        const size_t l = p % SK_PANEL_LANES;
        sk_box *box = &spread->box[p];
        for (int k = 0; k < 3; k++) {
            real low = panels->low[k][l], high = panels->high[k][l];
            box->low[0][k] = low, box->low[1][k] = low + SK_PANEL_AHEAD * (low - panels->low_before[k][l]);
            box->high[0][k] = high, box->high[1][k] = high + SK_PANEL_AHEAD * (high - panels->high_before[k][l]);
            for (int end = 0; end < 2; end++)
                panels->course.low[end][k][l] = box->low[end][k], panels->course.high[end][k][l] = box->high[end][k];
        }
        bound_box(box);
    }
    part(touch, near_of(touch) + 2 * off_course_of(touch));
    bool good = !memcmp(spread->was_out, spread->out, spread->count);
    memcpy(spread->out, spread->was_out, spread->count);
    spread->age = good ? 0 : SK_PANEL_AHEAD;
    spread->wait = good ? 0 : WAIT;
}

bool sk_spread_follow(sk_touch *touch, real way) {
    sk_spread *spread = &touch->spread;
    const bool all = spread->out_count == spread->count;
    if (spread->stale) measure(touch, touch->p, false), spread->gone = 0;
    spread->stale = false;
    measure(touch, touch->q, true);
    if (judge(touch, false, true)) {
        if (!all) spread->gone = 0; // else this asks on
        return true;
    }
    if (spread->age == SK_PANEL_AHEAD && !(spread->gone > 0)) set_courses(touch);
    if (all) look_ahead(touch, way);
    spread->gone = 0;
    return false;
}

void sk_spread_follow_held(sk_touch *touch) {
    box_panels(touch, true);
    part(touch, near_of(touch));
    turn(touch);
    touch->spread.gone = 0;
}

real sk_spread_longest_way(const sk_touch *touch, const sk_vec4 *x, size_t packed) {
    return sk_sqrt(longest_kernel[touch->isa](touch->before, x, packed, touch->slots));
}

static void bring_in(sk_spread *spread, size_t p) {
    spread->came_in |= spread->out[p];
    spread->out[p] = 0;
}

void sk_spread_disturb(sk_touch *touch, size_t v) {
    sk_spread *spread = &touch->spread;
    const sk_skin *skin = &touch->skin;
    spread->stale = true;
    for (uint32_t k = skin->leaf_start[v]; k < skin->leaf_start[v + 1] && spread->out_count; k++) {
        const uint32_t p = spread->of_leaf[skin->leaf_of[k]];
        for (uint32_t i = spread->through.start[p]; i < spread->through.start[p + 1]; i++) {
            const uint32_t b = spread->through.number[i];
            for (uint32_t j = spread->members.start[b]; j < spread->members.start[b + 1]; j++)
                bring_in(spread, spread->members.number[j]);
        }
    }
}

bool sk_spread_come_in(sk_touch *touch) {
    bool any = touch->spread.came_in && turn(touch);
    touch->spread.came_in = false;
    return any;
}

bool sk_spread_end(sk_touch *touch) {
    sk_spread *spread = &touch->spread;
    if (!spread->out_count) return false;
    memset(spread->out, 0, spread->count);
    return turn(touch);
}
#endif
