/* Which panels lie spread out: bounds on how their triangles lie, sixteen panels at a time, and the boxes around them. */
#include <string.h>

#include "base/kernels.h"
#include "base/tasks.h"
#include "contact/touch.h"
#define SK_UNIT spread

/* Of sixteen panels: the least and the most of J's numbers, the square of how much it has changed, and where they are. */
typedef struct sk_panels_measured {
    SK_VECTOR_ALIGNED real least[6][SK_PANEL_LANES], most[6][SK_PANEL_LANES], change[SK_PANEL_LANES];
    SK_VECTOR_ALIGNED real low[3][SK_PANEL_LANES], high[3][SK_PANEL_LANES];
} sk_panels_measured;
/* Of places x of vertices; J is noted. */
typedef void sk_measure_kernel(const sk_vec4 *x, const sk_spread *spread, size_t group, sk_panels_measured *out);
SK_KERNELS(sk_measure_kernel, measure);
/* The square of the longest way of all slots. */
typedef real sk_longest_kernel(const sk_vec4 *before, const sk_vec4 *x, size_t packed, size_t slots);
SK_KERNELS(sk_longest_kernel, longest);

#ifdef SK_ISA

SK_INLINE sk_wide *lanes_of(real *reals) {
    return (sk_wide *)(void *)reals;
}

SK_INLINE sk_wide least_of(sk_wide a, sk_wide b) {
    return sk_select(sk_more(b, a), a, b);
}

SK_INLINE sk_wide most_of(sk_wide a, sk_wide b) {
    return sk_select(sk_more(a, b), a, b);
}

/* Bounds of sixteen panels, while their rows are gone through. */
typedef struct bounds {
    sk_wide least[6], most[6], change, low[3], high[3];
} bounds;

/* J = [d1 d2] / [u1 u2], where d are differences of corners and u those on the plane. */
SK_INLINE void add_triangle(bounds *b, sk_wide3 d1, sk_wide3 d2, real (*inverse)[SK_PANEL_LANES], real (*gradient)[SK_PANEL_LANES],
                            size_t l) {
    const sk_wide i0 = *lanes_of(inverse[0] + l), i1 = *lanes_of(inverse[1] + l);
    const sk_wide i2 = *lanes_of(inverse[2] + l), i3 = *lanes_of(inverse[3] + l);
    const sk_wide j[6] = {d1.x * i0 + d2.x * i1, d1.y * i0 + d2.y * i1, d1.z * i0 + d2.z * i1,
                          d1.x * i2 + d2.x * i3, d1.y * i2 + d2.y * i3, d1.z * i2 + d2.z * i3};
    sk_wide change = sk_splat(0);
    for (int k = 0; k < 6; k++) {
        sk_wide *was = lanes_of(gradient[k] + l), off = j[k] - *was;
        change = change + off * off;
        *was = j[k];
        b->least[k] = least_of(b->least[k], j[k]);
        b->most[k] = most_of(b->most[k], j[k]);
    }
    b->change = most_of(b->change, change);
}

void SK_KERNEL(measure)(const sk_vec4 *x, const sk_spread *spread, size_t group, sk_panels_measured *out) {
    const sk_wide far = sk_splat(SK_REAL_MAX);
    for (size_t l = 0; l < SK_PANEL_LANES; l += SK_PART) {
        bounds b = {.change = sk_splat(0)};
        for (int k = 0; k < 6; k++) b.least[k] = far, b.most[k] = -far;
        for (int k = 0; k < 3; k++) b.low[k] = far, b.high[k] = -far;
        for (size_t r = spread->row_start[group]; r < spread->row_start[group + 1]; r++) {
            sk_wide3 at[4];
            for (int c = 0; c < 4; c++) {
                sk_wide4 here = sk_gather(x, spread->corner[r][c] + l);
                at[c] = (sk_wide3){here.x, here.y, here.z};
                b.low[0] = least_of(b.low[0], here.x), b.high[0] = most_of(b.high[0], here.x);
                b.low[1] = least_of(b.low[1], here.y), b.high[1] = most_of(b.high[1], here.y);
                b.low[2] = least_of(b.low[2], here.z), b.high[2] = most_of(b.high[2], here.z);
            }
            const sk_wide3 along = {at[1].x - at[0].x, at[1].y - at[0].y, at[1].z - at[0].z};
            for (int t = 0; t < 2; t++) {
                const sk_wide3 other = {at[2 + t].x - at[0].x, at[2 + t].y - at[0].y, at[2 + t].z - at[0].z};
                add_triangle(&b, along, other, spread->inverse[r][t], spread->gradient[r][t], l);
            }
        }
        for (int k = 0; k < 6; k++) *lanes_of(out->least[k] + l) = b.least[k], *lanes_of(out->most[k] + l) = b.most[k];
        for (int k = 0; k < 3; k++) *lanes_of(out->low[k] + l) = b.low[k], *lanes_of(out->high[k] + l) = b.high[k];
        *lanes_of(out->change + l) = b.change;
    }
}

real SK_KERNEL(longest)(const sk_vec4 *before, const sk_vec4 *x, size_t packed, size_t slots) {
    sk_wide most = sk_splat(0);
    for (size_t b = 0; b < slots; b += 16)
        for (size_t l = b; l < b + 16; l += SK_PART) {
            sk_wide4 from = sk_load_part(before, l, b < packed), to = sk_load_part(x, l, b < packed);
            sk_wide3 way = {to.x - from.x, to.y - from.y, to.z - from.z};
            most = most_of(most, sk_dot_wide(way, way));
        }
    real square = 0;
    for (size_t l = 0; l < SK_PART; l++) square = sk_max(square, most[l]);
    return square;
}
#else
static sk_longest_kernel *const longest_kernel[SK_ISA_COUNT] = SK_EACH_ISA(longest);
static sk_measure_kernel *const measure_kernel[SK_ISA_COUNT] = SK_EACH_ISA(measure);

enum { GROUPS_AT_ONCE = 4, BLOCKS_AT_ONCE = 64 };

/* A pair that loses less than nine tenths of its gap in a substep does not close. */
static const real closing_share = (real)0.8;
/* Who is to go out has to have more room: it is looked for if it comes in. */
static const real room = (real)1.2;

/* ---- where panels are, and how they lie ---- */

typedef struct measuring {
    sk_touch *touch;
    const sk_vec4 *x;
    bool ways; /* from where they were to x */
} measuring;

/* The box of a panel's way: of who is held back, too, which goes what all go together. */
static sk_box box_of_way(const sk_touch *touch, const sk_panel *panel, const real low[3], const real high[3], bool ways) {
    const real common[3] = {touch->common.x, touch->common.y, touch->common.z};
    const bool held = touch->spread.out_count < touch->spread.count;
    const real gone = touch->spread.gone; // since it was there
    sk_box box = {{{0}}, {{0}}};
    for (int k = 0; k < 3; k++) {
        real least = low[k], most = high[k];
        if (ways) least = sk_min(least, panel->low[k] - gone), most = sk_max(most, panel->high[k] + gone);
        if (ways && held) least = sk_min(least, panel->low[k] + common[k] - gone), most = sk_max(most, panel->high[k] + common[k] + gone);
        box.low[0][k] = box.low[1][k] = least, box.high[0][k] = box.high[1][k] = most;
    }
    return box;
}

/* How far from where they are expected panels may be. */
static real off_course_of(const sk_touch *touch) {
    return touch->thickness;
}

/* Whether a panel is where it is expected after this substep, on any shares of its way. */
static bool is_on_course(const sk_touch *touch, size_t p, const real low[3], const real high[3]) {
    const sk_spread *spread = &touch->spread;
    const sk_panel *panel = &spread->panel[p];
    const sk_box *course = &spread->course[p];
    const bool held = spread->out_count < spread->count;
    const real common[3] = {touch->common.x, touch->common.y, touch->common.z};
    const real share = (real)(spread->age + 1) / SK_PANEL_AHEAD, off = off_course_of(touch);
    bool on = true;
    for (int k = 0; k < 3; k++) {
        real least = course->low[0][k] + share * (course->low[1][k] - course->low[0][k]) - off;
        real most = course->high[0][k] + share * (course->high[1][k] - course->high[0][k]) + off;
        on &= low[k] >= least && high[k] <= most;
        on &= !held || (panel->low[k] + common[k] >= least && panel->high[k] + common[k] <= most);
    }
    return on;
}

static void measure_some(void *data, int thread, size_t begin, size_t end) {
    (void)thread;
    const measuring *job = data;
    sk_touch *touch = job->touch;
    sk_spread *spread = &touch->spread;
    for (size_t g = begin; g < end; g++) {
        sk_panels_measured m;
        measure_kernel[touch->isa](job->x, spread, g, &m);
        for (size_t l = 0, p = g * SK_PANEL_LANES; l < SK_PANEL_LANES && p < spread->count; l++, p++) {
            sk_panel *panel = &spread->panel[p];
            real low[3], high[3];
            for (int k = 0; k < 6; k++) panel->least[k] = m.least[k][l], panel->least[6 + k] = -m.most[k][l];
            for (int k = 0; k < 3; k++) low[k] = m.low[k][l], high[k] = m.high[k][l];
            panel->change = m.change[l];
            if (job->ways && spread->age < SK_PANEL_AHEAD && !is_on_course(touch, p, low, high))
                __atomic_store_n(&spread->off_course, true, __ATOMIC_RELAXED);
            spread->box[p] = box_of_way(touch, panel, low, high, job->ways);
            for (int k = 0; k < 3; k++) panel->low_step[k] = low[k] - panel->low[k], panel->high_step[k] = high[k] - panel->high[k];
            memcpy(panel->low, low, sizeof low);
            memcpy(panel->high, high, sizeof high);
        }
    }
}

static void measure(sk_touch *touch, const sk_vec4 *x, bool ways) {
    measuring job = {touch, x, ways};
    const size_t groups = (touch->spread.count + SK_PANEL_LANES - 1) / SK_PANEL_LANES;
    sk_parallel_pieces(touch->tasks, 0, groups, GROUPS_AT_ONCE, measure_some, &job);
}

/* How well places are known. */
static real rounding_of(const sk_panel *panel) {
    const real share = sizeof(real) == 8 ? (real)4e-15 : (real)2e-6;
    real far = 0;
    for (int k = 0; k < 3; k++) far = sk_max(far, sk_max(sk_abs(panel->low[k]), sk_abs(panel->high[k])));
    return share * far;
}

/* c / |A| of a block and those around it, where A is the middle of all J; and the most that J has changed, squared. */
static real keeps_of(const sk_spread *spread, size_t b, real *change) {
    real least[16];
    const uint32_t first = spread->around.start[b], end = spread->around.start[b + 1];
    memcpy(least, spread->panel[spread->around.number[first]].least, sizeof least);
    *change = spread->panel[spread->around.number[first]].change;
    for (uint32_t i = first + 1; i < end; i++) {
        const sk_panel *other = &spread->panel[spread->around.number[i]];
        for (int k = 0; k < 16; k++) least[k] = other->least[k] < least[k] ? other->least[k] : least[k];
        *change = sk_max(*change, other->change);
    }
    real a[6], half[6];
    for (int k = 0; k < 6; k++) a[k] = (real)0.5 * (least[k] - least[6 + k]), half[k] = (real)-0.5 * (least[k] + least[6 + k]);
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
    const real need = (SK_NEAR_THICKNESSES + (real)0.01) * thickness + rounding_of(&spread->panel[spread->members.number[spread->members.start[b]]]);
    real change, keeps = keeps_of(spread, b, &change), kept = block->keeps, off = block->steep * spread->gone;
    block->keeps = keeps;
    if (!(keeps * block->apart > (block->spread ? 1 : room) * need)) return false; // of what is no number, neither
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
    for (uint32_t i = spread->blocks.start[p]; i < spread->blocks.start[p + 1]; i++) all &= spread->block[spread->blocks.number[i]].spread;
    return all;
}

/* ---- boxes ---- */

/* Puts all boxes into the tree. */
static void fit(sk_spread *spread) {
    sk_tree *tree = &spread->tree;
    for (int level = 0; level < tree->levels; level++)
        for (size_t b = 0; b < tree->blocks[level]; b++)
            for (size_t l = 0, i = b * SK_TREE_WIDTH; l < SK_TREE_WIDTH; l++, i++) {
                sk_tree_block *block = &tree->block[level][b];
                const sk_tree_block *below = level ? &tree->block[level - 1][i] : NULL;
                const bool there = i < (level ? tree->blocks[level - 1] : spread->count);
                for (int n = 0; n < 6; n++) {
                    const int end = n / 3, k = n % 3;
                    real low = SK_REAL_MAX, high = -SK_REAL_MAX;
                    if (there && !level) low = spread->wide[i].low[end][k], high = spread->wide[i].high[end][k];
                    for (int m = 0; m < SK_TREE_WIDTH && there && level; m++)
                        low = sk_min(low, below->low[end][k][m]), high = sk_max(high, below->high[end][k][m]);
                    block->low[end][k][l] = low, block->high[end][k][l] = high;
                }
            }
}

static bool is_beside(const sk_spread *spread, size_t p, size_t other) {
    for (uint32_t i = spread->beside.start[p]; i < spread->beside.start[p + 1]; i++)
        if (spread->beside.number[i] == other) return true;
    return false;
}

/* Who is out and may come nearer to another one that is not beside it comes in, and so does that. */
static void part(sk_touch *touch, const sk_box *box, real near) {
    sk_spread *spread = &touch->spread;
    const real half = (real)0.5 * near;
    const sk_quad wider = {half, half, half, 0};
    uint32_t hit[SK_TREE_WIDTH * SK_TREE_WIDTH];
    for (size_t p = 0; p < spread->count; p++)
        for (int end = 0; end < 2; end++) {
            spread->wide[p].low[end] = box[p].low[end] - wider;
            spread->wide[p].high[end] = box[p].high[end] + wider;
        }
    fit(spread);
    for (size_t a = 0; a < spread->tree.blocks[0]; a++) {
        const size_t first = a * SK_TREE_WIDTH, left = spread->count - first;
        const uint32_t lanes = left < SK_TREE_WIDTH ? (1u << left) - 1 : (1u << SK_TREE_WIDTH) - 1;
        sk_box all = spread->wide[first];
        for (size_t p = first + 1; p < first + SK_TREE_WIDTH && p < spread->count; p++) sk_box_widen(&all, &spread->wide[p]);
        size_t blocks = sk_tree_blocks[touch->isa](&spread->tree, &all, a, spread->met);
        for (size_t k = 0; k < blocks; k++) {
            size_t b = spread->met[k], count = sk_tree_hits[touch->isa](&spread->tree, a, b, lanes, spread->wide, true, hit);
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

/* Notes what of a patch's leaves all are out. */
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
    if (any && none_had) touch->until = sk_min(touch->until, touch->now + 10); // or boxes would lead far ahead
    turn_patches(touch);
    spread->turned = true;
    touch->holds = false;
    return any;
}

/* What is no nearer along an axis is not near. */
static real near_of(const sk_touch *touch) {
    return (SK_NEAR_THICKNESSES + (real)0.01) * touch->thickness;
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
    else part(touch, spread->box, (more ? room : 1) * near_of(touch)), spread->age = SK_PANEL_AHEAD;
    spread->off_course = false;
    spread->gone = 0;
    if (!memcmp(spread->was_out, spread->out, spread->count)) return false;
    return turn(touch);
}

bool sk_spread_look(sk_touch *touch, bool more) {
    sk_spread *spread = &touch->spread;
    spread->thickness = touch->thickness;
    spread->stale = false;
    measure(touch, touch->p, false);
    return judge(touch, more, false);
}

/* Boxes of ways for those that are held back, too, where nobody could be. */
static void widen_by_common_way(sk_touch *touch) {
    sk_spread *spread = &touch->spread;
    const sk_quad way = {sk_abs(touch->common.x), sk_abs(touch->common.y), sk_abs(touch->common.z), 0};
    for (size_t p = 0; p < spread->count; p++)
        for (int end = 0; end < 2; end++) spread->box[p].low[end] -= way, spread->box[p].high[end] += way;
}

/* Where vertices are slow, and all are out: how long that holds. */
static void look_ahead(sk_touch *touch, real way) {
    sk_spread *spread = &touch->spread;
    const real margin = (real)0.5 * touch->thickness, few = 16; // substeps
    if (!(few * way < margin)) return;
    real least = (real)0.5 * margin;
    for (size_t b = 0; b < spread->block_count && least > way; b++) least = sk_min(least, room_of(touch, &spread->block[b]));
    if (!(least > way)) return;
    part(touch, spread->box, near_of(touch) + margin);
    if (!memchr(spread->out, 0, spread->count)) spread->holds = least;
    memcpy(spread->out, spread->was_out, spread->count);
}

/* Whether all that are out stay apart from all others as they go on: then boxes need not be compared for a while. */
static void set_courses(sk_touch *touch) {
    enum { WAIT = 8 }; // where they do not
    sk_spread *spread = &touch->spread;
    if (spread->wait-- > 0) return;
    for (size_t p = 0; p < spread->count; p++) {
        const sk_panel *panel = &spread->panel[p];
        sk_box *course = &spread->course[p];
        for (int k = 0; k < 3; k++) {
            course->low[0][k] = panel->low[k], course->high[0][k] = panel->high[k];
            course->low[1][k] = panel->low[k] + SK_PANEL_AHEAD * panel->low_step[k];
            course->high[1][k] = panel->high[k] + SK_PANEL_AHEAD * panel->high_step[k];
        }
    }
    part(touch, spread->course, near_of(touch) + 2 * off_course_of(touch));
    bool good = !memcmp(spread->was_out, spread->out, spread->count);
    memcpy(spread->out, spread->was_out, spread->count);
    spread->age = good ? 0 : SK_PANEL_AHEAD;
    spread->wait = good ? 0 : WAIT;
}

bool sk_spread_follow(sk_touch *touch, real way) {
    sk_spread *spread = &touch->spread;
    if (spread->stale) measure(touch, touch->p, false), spread->gone = 0;
    spread->stale = false;
    measure(touch, touch->q, true);
    const bool one = !(spread->gone > 0); // substep since it was last looked
    if (judge(touch, false, true)) return true;
    if (spread->age == SK_PANEL_AHEAD && one) set_courses(touch);
    if (spread->out_count == spread->count) look_ahead(touch, way);
    return false;
}

real sk_spread_longest_way(const sk_touch *touch, const sk_vec4 *x, size_t packed) {
    return sk_sqrt(longest_kernel[touch->isa](touch->before, x, packed, touch->slots));
}

void sk_spread_follow_held(sk_touch *touch) {
    widen_by_common_way(touch);
    part(touch, touch->spread.box, near_of(touch));
    turn(touch);
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
        bring_in(spread, p);
        for (uint32_t i = spread->through.start[p]; i < spread->through.start[p + 1]; i++) {
            const uint32_t b = spread->through.number[i];
            for (uint32_t j = spread->members.start[b]; j < spread->members.start[b + 1]; j++) bring_in(spread, spread->members.number[j]);
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
