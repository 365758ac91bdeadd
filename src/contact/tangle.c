/* Which surfaces have gone through each other, what contact leaves out of them, and where they are led. */
#include <math.h>
#include <string.h>

#include "base/union_find.h"
#include "contact/touch.h"

/* ---- parts ---- */

/* What hangs together without the edges that go through something. */
static void find_parts(sk_touch *touch) {
    sk_tangle *tangle = &touch->tangle;
    const sk_skin *skin = &touch->skin;
    memset(tangle->cut, 0, skin->edge_count);
    for (size_t i = 0; i < tangle->crossing.count; i++) tangle->cut[tangle->crossing.data[i].edge] = 1;
    for (uint32_t v = 0; v < skin->vertex_count; v++) tangle->part[v] = v, tangle->size[v] = 0;
    for (size_t e = 0; e < skin->edge_count; e++)
        if (!tangle->cut[e]) sk_union_join(tangle->part, skin->edge[e][0], skin->edge[e][1]);
    for (uint32_t v = 0; v < skin->vertex_count; v++) tangle->size[tangle->part[v] = sk_union_root(tangle->part, v)]++;
}

static uint32_t size_at(const sk_tangle *tangle, uint32_t v) {
    return tangle->size[tangle->part[v]];
}

/* Which end of an edge that goes through a triangle is to go back through it: that in the smaller part. Or neither: the
 * triangle's surface, which is divided there, too, has a smaller one; or the edge does not divide anything. */
typedef enum inner_end { FIRST_END, SECOND_END, THEIRS, UNKNOWN } inner_end;

/* Whether an edge between two parts has its second end in the smaller one. */
static bool second_is_inner(const sk_tangle *tangle, const uint32_t edge[2]) {
    const uint32_t a = tangle->part[edge[0]], b = tangle->part[edge[1]];
    return tangle->size[b] < tangle->size[a] || (tangle->size[b] == tangle->size[a] && b < a);
}

static bool is_solid(const sk_skin *skin, uint32_t v) {
    return skin->closed[skin->piece[v]];
}

static sk_vec3 side_of(const sk_vec4 *x, uint32_t from, uint32_t to) {
    return sk_sub(sk_xyz(x[to]), sk_xyz(x[from]));
}

/* Of an edge of a solid that goes through another one's triangle the end behind this is inside, whatever is larger. */
static inner_end find_inside(const sk_touch *touch, const uint32_t edge[2], const uint32_t t[3]) {
    const sk_vec3 along = side_of(touch->p, edge[0], edge[1]),
                  n = sk_cross(side_of(touch->p, t[0], t[1]), side_of(touch->p, t[0], t[2]));
    return sk_dot(along, n) * (real)touch->skin.closed[touch->skin.piece[t[0]]] > 0 ? FIRST_END : SECOND_END;
}

static inner_end find_inner(const sk_touch *touch, const uint32_t edge[2], const uint32_t t[3]) {
    const sk_tangle *tangle = &touch->tangle;
    if (touch->skin.piece[edge[0]] != touch->skin.piece[t[0]] && is_solid(&touch->skin, edge[0]) &&
        is_solid(&touch->skin, t[0]))
        return find_inside(touch, edge, t);
    if (tangle->part[edge[0]] == tangle->part[edge[1]]) return UNKNOWN;
    const bool second = second_is_inner(tangle, edge);
    const uint32_t size = size_at(tangle, edge[second]);
    bool divided = tangle->part[t[0]] != tangle->part[t[1]] || tangle->part[t[0]] != tangle->part[t[2]];
    for (int c = 0; c < 3 && divided; c++)
        if (size_at(tangle, t[c]) < size) return THEIRS;
    return second ? SECOND_END : FIRST_END;
}

/* ---- where a crossing leads ---- */

/* The third corners of up to two triangles that have an edge; their number. */
static int find_faces(const sk_skin *skin, const uint32_t edge[2], uint32_t third[2]) {
    int count = 0;
    for (uint32_t i = skin->leaf_start[edge[0]]; i < skin->leaf_start[edge[0] + 1]; i++) {
        const sk_leaf *leaf = &skin->leaf[skin->leaf_of[i]];
        for (uint32_t t = leaf->first_triangle; t < leaf->first_triangle + leaf->triangles; t++) {
            const uint32_t *v = skin->triangle[t];
            for (int k = 0; k < 3 && count < 2; k++) {
                bool there = v[k] == edge[0] && v[(k + 1) % 3] == edge[1];
                bool back = v[k] == edge[1] && v[(k + 1) % 3] == edge[0];
                if (there || back) third[count++] = v[(k + 2) % 3];
            }
        }
    }
    return count;
}

static sk_vec3 unit(sk_vec3 a) {
    real length = sk_length(a);
    return length > (real)1e-18 ? sk_scale(1 / length, a) : (sk_vec3){0, 0, 0};
}

static sk_vec3 normal_of(const sk_vec4 *x, const uint32_t t[3]) {
    return unit(sk_cross(side_of(x, t[0], t[1]), side_of(x, t[0], t[2])));
}

/* Along the line in which the edge's face with that third corner crosses the triangle's plane, into the face. */
static sk_vec3 along_line(const sk_vec4 *x, const uint32_t edge[2], uint32_t third, const uint32_t t[3]) {
    const sk_vec3 n = normal_of(x, t), along = unit(side_of(x, edge[0], edge[1])), to = side_of(x, edge[0], third);
    const sk_vec3 inward = sk_sub(to, sk_scale(sk_dot(along, to), along)), r = unit(sk_cross(sk_cross(along, to), n));
    return sk_dot(r, inward) < 0 ? sk_scale(-1, r) : r;
}

/* Where an edge that goes through a triangle is to move against it, so that the lines in which the edge's faces cross the
 * triangle's plane get shorter: each begins at the edge, and goes on into its face along r. When the plane moves along
 * its normal n, it meets the edge elsewhere, the farther off the flatter the edge lies. */
static sk_vec3 way_to_shorten(const sk_vec4 *x, const uint32_t edge[2], const uint32_t third[2], int faces,
                              const uint32_t t[3]) {
    const real flattest = (real)0.05, small = (real)0.01; // (faces lead apart, and what rounding leaves is no way)
    const sk_vec3 n = normal_of(x, t), along = unit(side_of(x, edge[0], edge[1]));
    real steep = sk_dot(along, n);
    if (sk_abs(steep) < flattest) steep = steep < 0 ? -flattest : flattest;
    sk_vec3 way = {0, 0, 0};
    for (int f = 0; f < faces; f++) {
        const sk_vec3 r = along_line(x, edge, third[f], t);
        way = sk_add(way, sk_sub(r, sk_scale(2 * sk_dot(along, r) / steep, n)));
    }
    return sk_scale(1 / sk_sqrt(sk_dot(way, way) + small), way);
}

/* Where one of its ends is to move, to be on the side of the triangle where the other one is. */
static sk_vec3 way_through(const sk_vec4 *x, const uint32_t edge[2], int end, const uint32_t t[3]) {
    const sk_vec3 n = normal_of(x, t);
    return sk_scale(sk_dot(n, side_of(x, edge[end], edge[1 - end])) < 0 ? -1 : 1, n);
}

/* How much farther the edge goes than the triangle: the lighter one goes, of 1 together. */
static real share_of(const sk_vec4 *x, const uint32_t edge[2], const uint32_t t[3]) {
    real first = (x[edge[0]].w + x[edge[1]].w) / 2, second = (x[t[0]].w + x[t[1]].w + x[t[2]].w) / 3;
    return first + second > 0 ? first / (first + second) : 0;
}

static void lead(sk_tangle *tangle, uint32_t v, sk_vec3 way) {
    sk_accumulate(&tangle->lead[v], way);
    tangle->lead[v].w++;
}

/* ---- what is led as a whole ---- */

/* Where a sheet is gone through, who is lighter may be held by pins: so both go. */
static const real half = (real)0.5;

static sk_whole *piece_of(const sk_touch *touch, uint32_t v) {
    return &touch->tangle.whole[touch->skin.piece[v]];
}

static sk_whole *part_of(const sk_touch *touch, uint32_t v) {
    return &touch->tangle.whole[touch->skin.vertex_count + touch->tangle.part[v]];
}

static void add_way(sk_whole *whole, sk_vec3 way, real share) {
    whole->way = sk_add(whole->way, way);
    whole->share += share;
    whole->count++;
}

static void add_place(sk_whole *whole, sk_vec4 built) {
    whole->low = (sk_vec3){sk_min(whole->low.x, built.x), sk_min(whole->low.y, built.y), sk_min(whole->low.z, built.z)};
    whole->high =
        (sk_vec3){sk_max(whole->high.x, built.x), sk_max(whole->high.y, built.y), sk_max(whole->high.z, built.z)};
}

/* Of an edge of a solid that a sheet cuts in two: the solid goes to the side of its larger part, and what of the sheet is inside it to
 * the other. (By its own crossings, it would go out on all sides of the solid at once.) */
static void add_cut_solid(sk_touch *touch, const uint32_t edge[2], const uint32_t t[3]) {
    sk_tangle *tangle = &touch->tangle;
    if (!is_solid(&touch->skin, edge[0]) || is_solid(&touch->skin, t[0]) ||
        tangle->part[edge[0]] == tangle->part[edge[1]])
        return;
    const sk_vec3 way = way_through(touch->p, edge, second_is_inner(tangle, edge), t);
    add_way(piece_of(touch, edge[0]), way, half);
    uint32_t largest = 0;
    for (int c = 0; c < 3; c++) largest = size_at(tangle, t[c]) > largest ? size_at(tangle, t[c]) : largest;
    for (int c = 0; c < 3; c++)
        if (size_at(tangle, t[c]) < largest) add_way(part_of(touch, t[c]), sk_scale(-1, way), half);
}

/* Of two sheets: a part that is divided off goes back, and takes all around it along; where nothing is divided, the border of one goes
 * along the line of the crossing, so that it gets shorter. */
static void add_sheets(sk_touch *touch, const uint32_t edge[2], const uint32_t third[2], int faces, const uint32_t t[3],
                       inner_end inner, sk_vec3 way) {
    if (inner == UNKNOWN && faces == 2) return;
    if (inner == UNKNOWN) way = along_line(touch->p, edge, third[0], t);
    for (int c = 0; c < 2; c++) add_place(piece_of(touch, edge[0]), touch->skin.built[edge[c]]);
    for (int c = 0; c < 3; c++) add_place(piece_of(touch, t[0]), touch->skin.built[t[c]]);
    add_way(piece_of(touch, edge[0]), way, half);
    add_way(piece_of(touch, t[0]), sk_scale(-1, way), half);
}

/* Whether an edge only goes through a triangle since its solid is taken to be a little aside (sides.c): one of its ends is in the triangle's plane. */
static bool is_by_nothing(const sk_touch *touch, const uint32_t edge[2], const uint32_t t[3]) {
    const sk_vec3 n = normal_of(touch->p, t);
    const real first = sk_dot(n, side_of(touch->p, t[0], edge[0])),
               second = sk_dot(n, side_of(touch->p, t[0], edge[1]));
    return sk_min(sk_abs(first), sk_abs(second)) <= 2 * sk_length(sk_touch_aside(touch, edge[0], t[0]));
}

/* Notes of one of two solids whether the other one comes before it, and where they cross. */
static void note_crossed(sk_touch *touch, uint32_t v, uint32_t other, const uint32_t edge[2], bool by_nothing) {
    sk_whole *whole = piece_of(touch, v);
    whole->after += touch->skin.piece[other] < touch->skin.piece[v] ? 1 : -1;
    whole->by_nothing += by_nothing;
    whole->crossed =
        sk_add(whole->crossed, sk_scale(half, sk_add(sk_xyz(touch->p[edge[0]]), sk_xyz(touch->p[edge[1]]))));
}

/* What a crossing says of where pieces are to go as wholes. */
static void add_wholes(sk_touch *touch, const uint32_t edge[2], const uint32_t third[2], int faces, const uint32_t t[3],
                       inner_end inner, sk_vec3 way, real share) {
    const sk_skin *skin = &touch->skin;
    if (skin->piece[edge[0]] == skin->piece[t[0]] || is_solid(skin, edge[0]) != is_solid(skin, t[0])) return;
    if (!is_solid(skin, edge[0])) {
        add_sheets(touch, edge, third, faces, t, inner, way);
        return;
    }
    add_way(piece_of(touch, edge[0]), way, share);
    add_way(piece_of(touch, t[0]), sk_scale(-1, way), 1 - share);
    const bool by_nothing = is_by_nothing(touch, edge, t);
    note_crossed(touch, edge[0], t[0], edge, by_nothing);
    note_crossed(touch, t[0], edge[0], edge, by_nothing);
}

/* Leads both features of a crossing apart by twice a step. */
static void lead_crossing(sk_touch *touch, const uint32_t edge[2], const uint32_t third[2], int faces,
                          const uint32_t t[3], real step) {
    sk_tangle *tangle = &touch->tangle;
    add_cut_solid(touch, edge, t);
    inner_end inner = find_inner(touch, edge, t);
    if (inner == THEIRS) return;
    sk_vec3 way =
        inner == UNKNOWN ? way_to_shorten(touch->p, edge, third, faces, t) : way_through(touch->p, edge, (int)inner, t);
    const real share = share_of(touch->p, edge, t);
    add_wholes(touch, edge, third, faces, t, inner, way, share);
    way = sk_scale(2 * step, way);
    for (int c = 0; c < 2; c++)
        if (inner == UNKNOWN || (int)inner == c) lead(tangle, edge[c], sk_scale(share, way));
    for (int c = 0; c < 3; c++) lead(tangle, t[c], sk_scale(share - 1, way));
}

/* ---- what contact leaves out ---- */

/* Whether contact of neighbours reaches what goes through each other. Features of no more than some thicknesses do: with
 * 5 crumpled sheets stayed as they were, and with as many rings around them as make up 3, or where larger ones counted,
 * what was pressed together fell through itself. */
static bool are_fine(const sk_touch *touch, const uint32_t edge[2], const uint32_t t[3]) {
    const sk_vec4 *built = touch->skin.built;
    real longest = sk_length(side_of(built, edge[0], edge[1]));
    for (int c = 0; c < 3; c++) longest = sk_max(longest, sk_length(side_of(built, t[c], t[(c + 1) % 3])));
    return longest < 7 * touch->thickness;
}

static void mark(sk_crossings_at *at, size_t number, const uint32_t edge[2], const uint32_t t[3]) {
    const uint64_t bit = (uint64_t)1 << number % 64;
    for (int c = 0; c < 2; c++) at[edge[c]].edges |= bit;
    for (int c = 0; c < 3; c++) at[t[c]].triangles |= bit;
}

/* Whether two solids are both in others, and one of them is stuck there. */
static bool are_stuck(const sk_touch *touch, uint32_t v, uint32_t other) {
    const sk_whole *one = piece_of(touch, v), *two = piece_of(touch, other);
    return one != two && one->vertices && two->vertices && (one->stuck || two->stuck);
}

bool sk_pair_is_tangled(const sk_touch *touch, const uint32_t corner[4], int sort) {
    const uint64_t none = 0, all = ~none;
    const uint32_t first = corner[0], second = corner[sort == SK_EDGES ? 2 : 1];
    if (are_stuck(touch, first, second)) return true;
    sk_crossings_at of[2] = {{all, all}, {all, all}}, around[2] = {{none, none}, {none, none}};
    for (int c = 0; c < 4; c++) {
        const int feature = c >= (sort == SK_EDGES ? 2 : 1);
        const sk_crossings_at *at = &touch->tangle.of[corner[c]], *fine = &touch->tangle.fine[corner[c]];
        of[feature].edges &= at->edges, of[feature].triangles &= at->triangles;
        around[feature].edges |= fine->edges, around[feature].triangles |= fine->triangles;
    }
    return (of[0].edges & of[1].triangles) | (of[0].triangles & of[1].edges) | (around[0].edges & around[1].triangles) |
           (around[0].triangles & around[1].edges);
}

/* ---- before a substep, in it and after it ---- */

bool sk_tangle_reserve(sk_touch *touch, sk_allocator *allocator) {
    sk_tangle *tangle = &touch->tangle;
    size_t vertices = touch->skin.vertex_count + 1;
    if (tangle->cut) return true;
    tangle->of = sk_allocate(allocator, vertices * sizeof *tangle->of);
    tangle->fine = sk_allocate(allocator, vertices * sizeof *tangle->fine);
    tangle->part = sk_allocate(allocator, vertices * sizeof *tangle->part);
    tangle->size = sk_allocate(allocator, vertices * sizeof *tangle->size);
    tangle->lead = sk_allocate(allocator, vertices * sizeof *tangle->lead);
    tangle->whole = sk_allocate(allocator, 2 * vertices * sizeof *tangle->whole);
    tangle->group = sk_allocate(allocator, vertices * sizeof *tangle->group);
    tangle->marked = sk_allocate(allocator, vertices);
    if (tangle->of && tangle->fine && tangle->part && tangle->size && tangle->lead && tangle->whole && tangle->group &&
        tangle->marked)
        tangle->cut = sk_allocate(allocator, touch->skin.edge_count + 1);
    if (!tangle->cut) sk_tangle_release(tangle, allocator);
    return tangle->cut != NULL;
}

/* Leads the neighbours of who is led, and theirs, along with them. */
static void lead_along(sk_touch *touch) {
    sk_tangle *tangle = &touch->tangle;
    const sk_skin *skin = &touch->skin;
    for (uint8_t ring = 1; ring <= 3; ring++) {
        for (size_t v = 0; v < skin->vertex_count; v++) tangle->marked[v] = tangle->lead[v].w > 0;
        for (size_t e = 0; e < skin->edge_count; e++)
            for (int c = 0; c < 2; c++) {
                uint32_t from = skin->edge[e][c], to = skin->edge[e][1 - c];
                const sk_vec4 *own = &tangle->lead[from];
                if (tangle->marked[from] && !tangle->marked[to]) lead(tangle, to, sk_scale(1 / own->w, sk_xyz(*own)));
            }
    }
}

/* How much of its piece's way a vertex goes: all of it, but of a sheet that is pinned none as far from where it is gone through as
 * that is wide, as it was built. */
static real share_at(const sk_whole *whole, sk_vec4 built) {
    if (!whole->pinned) return 1;
    const sk_vec3 off = {sk_max(0, sk_max(whole->low.x - built.x, built.x - whole->high.x)),
                         sk_max(0, sk_max(whole->low.y - built.y, built.y - whole->high.y)),
                         sk_max(0, sk_max(whole->low.z - built.z, built.z - whole->high.z))};
    const real wide = sk_length(sk_sub(whole->high, whole->low));
    return sk_max(0, 1 - sk_length(off) / wide);
}

/* Who goes through each other is of one group. */
static void find_groups(sk_touch *touch) {
    const sk_skin *skin = &touch->skin;
    sk_tangle *tangle = &touch->tangle;
    for (uint32_t i = 0; i < skin->vertex_count; i++) tangle->group[i] = i;
    for (size_t i = 0; i < tangle->crossing.count; i++) {
        const sk_crossing *crossing = &tangle->crossing.data[i];
        sk_union_join(tangle->group, skin->piece[skin->edge[crossing->edge][0]],
                      skin->piece[skin->triangle[crossing->triangle][0]]);
    }
    for (size_t i = 0; i < skin->inner_count; i++) tangle->whole[skin->inner[i].piece].filled = true;
    for (uint32_t v = 0; v < skin->vertex_count; v++) {
        sk_whole *group = &tangle->whole[sk_union_root(tangle->group, skin->piece[v])];
        if (!piece_of(touch, v)->filled) group->hollow = true;
        if (piece_of(touch, v)->pinned) group->hangs = true;
    }
}

/* Finds solids whose crossings lead to all sides; they go away from where these are in the mean, or, if that is nowhere, along x. Two cubes of 1 m
 * and 8 particles a side, 0.8 m above each other, beside each other by 3 cm or not at all, drove over the ground together for ever, with 22 to 30 J, for
 * their ways added up to 0.05 of what they were, and faces in one plane held each other; turned, and half in each other, with 5 a side, they had
 * 85 J and more with time. Of 11 heaps of two to five cubes in each other 4 stayed so, with up to 9,000 J, and none with 0.15, 0.3 or 0.5 here. With 0.6
 * pairs that chance puts in each other take longer than a second; but where faces are in one plane it is 0.58, a third each along three faces, and
 * contact of what is around these holds the two. */
static void find_stuck(sk_touch *touch) {
    const sk_skin *skin = &touch->skin;
    const real least = (real)0.5, least_by_nothing = (real)0.65, most = (real)0.8;
    for (uint32_t v = 0; v < skin->vertex_count; v++) {
        sk_whole *whole = piece_of(touch, v);
        if (!whole->count || !is_solid(skin, v)) continue;
        whole->middle = sk_add(whole->middle, sk_xyz(touch->p[v]));
        whole->vertices++;
    }
    for (uint32_t i = 0; i < skin->vertex_count; i++) {
        sk_whole *whole = &touch->tangle.whole[i];
        const real count = (real)whole->count, agreed = 2 * whole->by_nothing < whole->count ? least : least_by_nothing;
        if (!whole->vertices || sk_length(whole->way) > most * count) continue;
        const bool hollow = touch->tangle.whole[sk_union_root(touch->tangle.group, i)].hollow;
        whole->stuck = !hollow && sk_tangle_way_out(touch, i, &whole->way);
        if (whole->stuck || sk_length(whole->way) > agreed * count) continue;
        const sk_vec3 away =
            sk_sub(sk_scale(1 / (real)whole->vertices, whole->middle), sk_scale(1 / count, whole->crossed));
        whole->stuck = true;
        whole->way = sk_length(away) > (real)0.1 * touch->thickness ? away : (sk_vec3){whole->after, 0, 0};
    }
}

/* Sums up how groups move. */
static void find_motion(sk_touch *touch, const sk_run *run, const sk_op *op) {
    const sk_skin *skin = &touch->skin;
    for (uint32_t v = 0; v < skin->vertex_count; v++) {
        if (!(touch->p[v].w > 0)) continue;
        sk_whole *group = &touch->tangle.whole[sk_union_root(touch->tangle.group, skin->piece[v])];
        const sk_vec3 velocity = sk_xyz(sk_load(run->vector[SK_V], op->packed, touch->slot[v]));
        const double mass = 1 / (double)touch->p[v].w;
        group->mass_of_all += mass, group->motion += mass * (double)sk_dot(velocity, velocity);
    }
}

/* How many times sooner than others sheets of a group are led apart as wholes: as fast as all of it moves, and up to four times. Sheets that
 * are thrown through each other fall into one heap meanwhile, and out of its folds nothing leads. (Of 80 pairs of 24 x 24 and 22 x 22 with up
 * to 3 m/s and a floor, 4, 8 and 20 substeps, 14 stayed so, with 2,500 crossings in all; with four times, however fast, 3, and 15 crossings;
 * but two that stood still had 0.19 J by then.) What is pinned cannot go there: with this, pairs of which one is had three times the energy. */
static real find_sooner(const sk_whole *group, real step, double dt) {
    const real most = 4;
    if (group->hangs || !(group->mass_of_all > 0)) return 1;
    return sk_max(1, sk_min(most, (real)(sqrt(group->motion / group->mass_of_all) * dt) / step));
}

/* Leads what goes through each other apart as wholes: deep in each other, crossings lead to all sides, and neighbours hold back who is
 * led alone. (Of 60 pairs of cubes 17 stayed so for three seconds, of 120 cubes in which a cloth began 28, of 120 pairs of sheets 43.) */
static void lead_wholes(sk_touch *touch, const sk_run *run, const sk_op *op, real step) {
    sk_tangle *tangle = &touch->tangle;
    const sk_skin *skin = &touch->skin;
    for (uint32_t v = 0; v < skin->vertex_count; v++)
        if (!(touch->p[v].w > 0) && !is_solid(skin, v)) piece_of(touch, v)->pinned = true;
    find_groups(touch);
    find_motion(touch, run, op);
    find_stuck(touch);
    for (uint32_t i = 0; i < 2 * skin->vertex_count; i++) {
        sk_whole *whole = &tangle->whole[i];
        if (!whole->count) continue;
        const bool agreed =
            i < skin->vertex_count && !skin->closed[i]; // or what contradicts itself makes sheets tremble
        const sk_whole *group = agreed ? &tangle->whole[sk_union_root(tangle->group, i)] : NULL;
        const real count = (real)whole->count, sooner = group ? find_sooner(group, step, op->dt) : 1;
        whole->way = sk_scale(2 * whole->share / count * sooner * step,
                              agreed ? sk_scale(1 / count, whole->way) : unit(whole->way));
    }
    for (uint32_t v = 0; v < skin->vertex_count; v++) {
        const sk_whole *piece = piece_of(touch, v), *part = part_of(touch, v);
        sk_vec4 *own = &tangle->lead[v];
        if (piece->stuck) *own = (sk_vec4){0, 0, 0, 0}; // all of it goes alike
        if (part->count) *own = (sk_vec4){part->way.x, part->way.y, part->way.z, 1};
        if (!piece->count) continue;
        if (!(own->w > 0)) own->w = 1; // it goes there, too
        sk_accumulate(own, sk_scale(own->w * share_at(piece, skin->built[v]), piece->way));
    }
}

/* Edges without faces are left as they are: they may be sewn in. */
static void lead_all(sk_touch *touch, const sk_run *run, const sk_op *op, real step) {
    sk_tangle *tangle = &touch->tangle;
    const sk_skin *skin = &touch->skin;
    memset(tangle->of, 0, skin->vertex_count * sizeof *tangle->of);
    memset(tangle->fine, 0, skin->vertex_count * sizeof *tangle->fine);
    memset(tangle->lead, 0, skin->vertex_count * sizeof *tangle->lead);
    const sk_vec3 far = {SK_REAL_MAX, SK_REAL_MAX, SK_REAL_MAX};
    for (size_t i = 0; i < 2 * skin->vertex_count; i++)
        tangle->whole[i] = (sk_whole){.low = far, .high = sk_scale(-1, far)};
    find_parts(touch);
    bool coarse = false;
    for (size_t i = 0; i < tangle->crossing.count; i++) {
        const uint32_t *edge = skin->edge[tangle->crossing.data[i].edge],
                       *t = skin->triangle[tangle->crossing.data[i].triangle];
        uint32_t third[2];
        int faces = find_faces(skin, edge, third);
        if (!faces) continue;
        tangle->any = true;
        mark(tangle->of, i, edge, t);
        if (are_fine(touch, edge, t)) mark(tangle->fine, i, edge, t);
        else coarse = true;
        lead_crossing(touch, edge, third, faces, t, step);
    }
    // a corner of a few large cells alone gives way, and springs back: with this, two cubes of 5 and 6 cells a side come apart
    if (coarse) lead_along(touch);
    lead_wholes(touch, run, op, step);
}

static bool is_torn(const sk_tangle *tangle) {
    return __atomic_load_n(&tangle->torn, __ATOMIC_RELAXED);
}

static bool is_at(sk_vec4 a, sk_vec4 b) {
    return !memcmp(&a, &b, sizeof a);
}

/* Marks who is not where the last bound left it; of others it is known that they go through nothing. Whether there are any. */
static bool mark_changed(sk_touch *touch, const sk_vec4 *x, size_t packed) {
    sk_tangle *tangle = &touch->tangle;
    bool any = false;
    for (size_t v = 0; v < touch->skin.vertex_count; v++) {
        tangle->marked[v] = !is_at(sk_load(x, packed, touch->slot[v]), sk_load(tangle->left, packed, touch->slot[v]));
        any |= tangle->marked[v];
    }
    return any;
}

/* Marks who was around a crossing, or in a solid that was stuck: no other pair was left out of the bound, so nothing else can go through
 * anything now. */
static void mark_around(sk_touch *touch) {
    sk_tangle *tangle = &touch->tangle;
    for (size_t v = 0; v < touch->skin.vertex_count; v++) {
        const sk_crossings_at *of = &tangle->of[v], *fine = &tangle->fine[v];
        tangle->marked[v] =
            (of->edges | of->triangles | fine->edges | fine->triangles) != 0 || piece_of(touch, (uint32_t)v)->stuck;
    }
}

bool sk_tangle_look(sk_touch *touch, const sk_run *run, const sk_op *op, real step, bool known) {
    sk_tangle *tangle = &touch->tangle;
    sk_allocator *allocator = run->allocator;
    const sk_vec4 *x = run->vector[SK_X];
    const size_t packed = op->packed;
    bool goes_on = known && tangle->any && !tangle->forced && !is_torn(tangle);
    bool left = tangle->clean && tangle->left_count == touch->slots;
    tangle->any = tangle->forced = false;
    tangle->same = tangle->clean && (known || (left && !memcmp(tangle->left, x, touch->slots * sizeof *x)));
    if (tangle->same) return true;
    if (!sk_tangle_reserve(touch, allocator)) return false;
    if (left && !mark_changed(touch, x, packed)) return true;
    if (goes_on) mark_around(touch);
    sk_touch_load(touch, packed);
    sk_torn_know(touch, packed);
    const uint8_t *of = left || goes_on ? tangle->marked : NULL;
    if (!sk_touch_list_crossings(touch, allocator, of, &tangle->crossing, true)) return false;
    if (tangle->crossing.count) lead_all(touch, run, op, step);
    return true;
}

void sk_tangle_lead(const sk_touch *touch, sk_vec4 *x, sk_vec4 *before, size_t packed) {
    const sk_tangle *tangle = &touch->tangle;
    for (size_t v = 0; v < touch->skin.vertex_count && tangle->any; v++) {
        sk_vec4 sum = tangle->lead[v];
        if (!(sum.w > 0) || !(touch->p[v].w > 0)) continue;
        sk_vec3 way = sk_scale(1 / sum.w, sk_xyz(sum));
        sk_add_at(x, packed, touch->slot[v], way);
        if (before) sk_add_at(before, packed, touch->slot[v], way);
    }
    for (size_t i = 0; i < touch->skin.inner_count && tangle->any;
         i++) { // or springs would bring them along, and speed with it
        const sk_whole *whole = &tangle->whole[touch->skin.inner[i].piece];
        const uint32_t slot = touch->inner_slot[i];
        if (!whole->count || !(sk_load(x, packed, slot).w > 0)) continue;
        sk_add_at(x, packed, slot, whole->way);
        if (before) sk_add_at(before, packed, slot, whole->way);
    }
}

bool sk_tangle_leave(sk_touch *touch, sk_allocator *allocator, const sk_vec4 *x, bool keeps, bool last) {
    sk_tangle *tangle = &touch->tangle;
    tangle->clean = keeps && !tangle->any && !tangle->forced && !is_torn(tangle);
    tangle->left_count = 0;
    if (!tangle->clean || (touch->alone && !last)) return true; // the next begin knows
    if (touch->slots > tangle->left_capacity) {
        sk_release(allocator, tangle->left);
        tangle->left = sk_allocate(allocator, touch->slots * sizeof *x);
        tangle->left_capacity = tangle->left ? touch->slots : 0;
        if (!tangle->left) return tangle->clean = false;
    }
    memcpy(tangle->left, x, touch->slots * sizeof *x);
    tangle->left_count = touch->slots;
    return true;
}

void sk_tangle_release(sk_tangle *tangle, sk_allocator *allocator) {
    void *arrays[] = {tangle->left,  tangle->of,    tangle->fine,   tangle->part, tangle->size,         tangle->lead,
                      tangle->whole, tangle->group, tangle->marked, tangle->cut,  tangle->crossing.data};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) sk_release(allocator, arrays[i]);
    *tangle = (sk_tangle){.any = false};
}
