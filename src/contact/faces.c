/* Colliders against what lies between particles. Colliders meet particles (colliders/contact.c): a corner of a box, an edge or a small ball would
 * go in between. So edges and triangles are kept off all that have an inside, too.
 *
 *      o               o        Along an edge the distance f from a convex solid is a convex function: above its tangents, of which the derivative at
 *       \___       ___/         a place is one, n . e. If they fall towards each other at the ends, the nearest place is in between, and not
 *        \  \__f__/  /          lower than where they meet: there is looked next, until that is so near that it is as good (Kelley's cutting
 *         \         /           planes, 1960). Of an edge that lies along a face they do not: most take a comparison.
 *
 * A triangle is nearest on its edges, or, where a corner or a ball is in front of it, within: from a place on it by f against n and back onto its
 * plane leads there (alternating projections), at a corner at once, and along an edge that leads to one in steps that get small: so the last one says along
 * which line it is looked for, as on an edge. Where a solid is not convex all that holds near what is: an edge or a corner of a mesh.
 *
 * Who sags by less than a quarter of the thickness between his corners, as most do on what is round, is left to these. The others are pushed as pairs of
 * features are (push.c), one of which is the surface; those that were found where a substep ended are held in the next one while limits are swept. One
 * after the other: by collider, edges before triangles, in the skin's order. */
#include <string.h>

#include "base/tasks.h"
#include "colliders/trimesh.h"
#include "contact/touch.h"

enum { LANES = SK_LANES, MOST_ROUNDS = 6 };

/* A place on a line, as a part of its way, with its distance and how fast that grows along the line. */
typedef struct tangent {
    real t, f, slope;
} tangent;

/* As many edges or triangles as are looked at together. */
typedef struct batch {
    sk_face face[LANES];
    sk_vec3 corner[LANES][3], place[LANES];
    real weight[LANES][3], best[LANES]; /* where it is looked; the least distance that was found */
    real line[LANES][2][3];             /* the ends, by weights, of the edge, or of a line on the triangle; */
    tangent end[LANES][2];              /* what is known before the nearest place on it, and after it */
    real under[LANES];                  /* m: farther off it asks for nothing */
    sk_sixteen_contacts contacts;
    size_t count;
} batch;

typedef struct meeting {
    sk_touch *touch;
    sk_run *run;
    const sk_op *op;
    bool *loaded;
    const sk_collider *collider;
    sk_pose pose, start;
    real h, thickness, sag; /* s; m: how far off it is to be; how much nearer than their corners they may be */
    real reach, far; /* m: what is farther off touches in no substep; and who is farther off, with none of its edges */
} meeting;

static void probe(const meeting *m, const sk_pose *pose, const sk_vec3 *place, size_t count, real reach,
                  sk_sixteen_contacts *contacts) {
    SK_VECTOR_ALIGNED real at[3][LANES];
    for (size_t l = 0; l < LANES; l++) {
        const sk_vec3 x = place[l < count ? l : 0];
        at[0][l] = x.x, at[1][l] = x.y, at[2][l] = x.z;
    }
    sk_probe_sixteen_of[m->touch->isa](m->collider, pose, at, reach, contacts);
}

static sk_vec3 lane_of(const real x[3][LANES], size_t l) {
    return (sk_vec3){x[0][l], x[1][l], x[2][l]};
}

static sk_vec3 normal_of(const sk_sixteen_contacts *contacts, size_t l) {
    return lane_of((const real(*)[LANES])contacts->normal, l);
}

static sk_vec3 sum_of(const real weight[3], const sk_vec3 x[3]) {
    return sk_add(sk_add(sk_scale(weight[0], x[0]), sk_scale(weight[1], x[1])), sk_scale(weight[2], x[2]));
}

/* Looks at the places by those weights, and keeps the nearest so far. */
static void look(const meeting *m, batch *b) {
    for (size_t l = 0; l < b->count; l++) b->place[l] = sum_of(b->weight[l], b->corner[l]);
    probe(m, &m->pose, b->place, b->count, m->far, &b->contacts);
    for (size_t l = 0; l < b->count; l++) {
        const real f = b->contacts.distance[l], *w = b->weight[l];
        if (!(f < b->best[l]) || !(sk_min(w[0], sk_min(w[1], w[2])) >= 0)) continue;
        sk_face *face = &b->face[l];
        b->best[l] = f, face->normal = normal_of(&b->contacts, l);
        face->at = sk_sub(b->place[l], sk_scale(f, face->normal)), face->way = (sk_vec3){0, 0, 0};
        if (m->collider->type->deforms) face->way = sk_scale(m->h, lane_of((const real(*)[LANES])b->contacts.own, l));
        memcpy(face->weight, w, sizeof face->weight);
    }
}

/* Where the tangents at both ends meet, and how far from the solid. */
static tangent meet_of(const tangent end[2]) {
    const tangent a = end[0], b = end[1];
    const real t = a.slope < b.slope
                       ? sk_max(a.t, sk_min(b.t, (b.f - b.slope * b.t - a.f + a.slope * a.t) / (a.slope - b.slope)))
                       : b.t;
    return (tangent){t, a.f + a.slope * (t - a.t), 0};
}

/* Looks at the place on each line that is a part t of its way, and what that says of the distance there. */
static void look_on_line(const meeting *m, batch *b, const real t[LANES], tangent found[LANES]) {
    for (size_t l = 0; l < b->count; l++)
        for (int c = 0; c < 3; c++) b->weight[l][c] = b->line[l][0][c] + t[l] * (b->line[l][1][c] - b->line[l][0][c]);
    look(m, b);
    for (size_t l = 0; l < b->count; l++) {
        const sk_vec3 along = sk_sub(sum_of(b->line[l][1], b->corner[l]), sum_of(b->line[l][0], b->corner[l]));
        found[l] = (tangent){t[l], b->contacts.distance[l], sk_dot(normal_of(&b->contacts, l), along)};
    }
}

static void find_on_lines(const meeting *m, batch *b) {
    const real little = (real)0.02 * m->thickness;
    real t[LANES];
    tangent found[LANES];
    bool further = true;
    for (int round = 0; round < MOST_ROUNDS && further; round++) {
        further = false;
        for (size_t l = 0; l < b->count; l++) t[l] = meet_of(b->end[l]).t;
        look_on_line(m, b, t, found);
        for (size_t l = 0; l < b->count; l++) {
            b->end[l][found[l].slope < 0 ? 0 : 1] = found[l];
            const real low = meet_of(b->end[l]).f;
            further |= low < b->under[l] && b->best[l] - low > little;
        }
    }
}

/* The weights of the corners at the place in their plane that is nearest to p; of those without an area none. */
static void find_weights(const sk_vec3 x[3], sk_vec3 p, real weight[3]) {
    const sk_vec3 a = sk_sub(x[1], x[0]), b = sk_sub(x[2], x[0]), r = sk_sub(p, x[0]), n = sk_cross(a, b);
    const real square = sk_dot(n, n), per = square > 0 ? 1 / square : 0;
    weight[1] = per * sk_dot(n, sk_cross(r, b));
    weight[2] = per * sk_dot(n, sk_cross(a, r));
    weight[0] = per * square - weight[1] - weight[2];
}

/* Where a line from one place through another, by their weights, is within a triangle. */
static void clip_line(const real a[3], const real b[3], real line[2][3]) {
    real t[2] = {-1e6, 1e6};
    for (int c = 0; c < 3; c++) {
        const real way = b[c] - a[c];
        if (way > 0) t[0] = sk_max(t[0], -a[c] / way);
        if (way < 0) t[1] = sk_min(t[1], -a[c] / way);
    }
    for (int end = 0; end < 2; end++)
        for (int c = 0; c < 3; c++) line[end][c] = a[c] + (t[0] < t[1] ? t[end] : 0) * (b[c] - a[c]);
}

static void find_within(const meeting *m, batch *b) {
    real ends[2][LANES] = {{0}}, before[LANES][3];
    tangent found[LANES];
    for (size_t l = 0; l < b->count; l++)
        b->weight[l][0] = b->weight[l][1] = b->weight[l][2] = (real)(1.0 / 3), ends[1][l] = 1;
    for (int round = 0; round < 2; round++) {
        look(m, b);
        for (size_t l = 0; l < b->count; l++) {
            const real f = b->contacts.distance[l];
            // from within a solid, where there is no nearest place of both, a little further in
            const sk_vec3 to =
                sk_sub(b->place[l], sk_scale(f > 0 ? f : (real)0.5 * m->thickness, normal_of(&b->contacts, l)));
            memcpy(before[l], b->weight[l], sizeof before[l]);
            find_weights(b->corner[l], to, b->weight[l]);
        }
    }
    for (size_t l = 0; l < b->count; l++) clip_line(before[l], b->weight[l], b->line[l]);
    for (int end = 0; end < 2; end++) {
        look_on_line(m, b, ends[end], found);
        for (size_t l = 0; l < b->count; l++) b->end[l][end] = found[l];
    }
    find_on_lines(m, b);
}

/* Lists those of a batch that are near, with how far off they are to be: what began nearer comes out slowly. */
static void take_batch(const meeting *m, batch *b, void (*find)(const meeting *m, batch *b)) {
    sk_faces *faces = &m->touch->faces;
    const size_t first = faces->near.count;
    size_t count = 0;
    if (!SK_RESERVE(m->run->allocator, &faces->near, first + LANES)) m->run->no_memory = true, b->count = 0;
    for (size_t l = 0; l < b->count; l++) b->best[l] = SK_REAL_MAX;
    if (b->count) find(m, b);
    for (size_t l = 0; l < b->count; l++) {
        sk_face *face = &b->face[l];
        if (!(b->best[l] < b->under[l])) continue;
        sk_vec3 before[3];
        for (int c = 0; c < 3; c++) before[c] = sk_xyz(m->touch->p[face->corner[c]]);
        b->place[count++] = sum_of(face->weight, before);
        face->wanted =
            sk_dot(face->normal, face->way); // what it had more of a distance, where the surface came by itself
        face->way = sk_add(
            face->way,
            sk_scale(m->h, sk_add(m->pose.velocity, sk_cross(m->pose.spin, sk_sub(face->at, m->pose.position)))));
        faces->near.data[faces->near.count++] = *face;
    }
    b->count = 0;
    if (!count) return;
    probe(m, &m->start, b->place, count, m->reach, &b->contacts);
    const real gain = 60 * m->h * m->thickness; // a thickness in a sixtieth of a second
    for (size_t i = 0; i < count; i++) {
        sk_face *face = &faces->near.data[first + i];
        face->wanted = sk_min(m->thickness, face->wanted + b->contacts.distance[i] + gain);
    }
}

/* How much farther off vertex b is than a, by the plane there. */
static real fall(const sk_touch *touch, uint32_t a, uint32_t b) {
    return sk_dot(sk_xyz(touch->faces.plane[a]), sk_sub(sk_xyz(touch->q[b]), sk_xyz(touch->q[a])));
}

/* Whether not all corners are above the same plane: along that no distance falls from both ends. Or all are far. */
static inline bool may_sag(const sk_vec4 *plane, const uint32_t *v, int corners) {
    const size_t normal = 3 * sizeof(real);
    return memcmp(&plane[v[0]], &plane[v[1]], normal) != 0 ||
           (corners == 3 && memcmp(&plane[v[0]], &plane[v[2]], normal) != 0);
}

/* Adds an edge or a triangle whose distance falls from each corner to another one, and not only to what is too far, or hardly nearer than they are.
 * Of a triangle, whose distance is above three tangent planes, it is above their mean, too, which is least at a corner. */
static void add(const meeting *m, batch *b, const uint32_t *v, int corners, void (*find)(const meeting *m, batch *b)) {
    const sk_touch *touch = m->touch;
    sk_face *face = &b->face[b->count];
    real low = -SK_REAL_MAX, nearest = SK_REAL_MAX, sum[3] = {0, 0, 0};
    for (int c = 0; c < corners; c++) {
        const sk_vec4 plane = touch->faces.plane[v[c]];
        if (!(plane.w < SK_REAL_MAX)) return;
        const int next = corners == 2 ? 1 - c : (c + 1) % 3, after = corners == 2 ? next : (c + 2) % 3;
        const real to_next = fall(touch, v[c], v[next]),
                   to_after = after == next ? to_next : fall(touch, v[c], v[after]), slope = sk_min(to_next, to_after);
        if (!(slope < 0)) return;
        low = sk_max(low, plane.w + slope), nearest = sk_min(nearest, plane.w);
        sum[c] += plane.w, sum[next] += plane.w + to_next, sum[after] += plane.w + to_after;
        b->end[b->count][c & 1] = (tangent){(real)(c & 1), plane.w, c ? -slope : slope};
    }
    const real under = sk_min(m->reach, nearest - m->sag);
    const real mean = corners == 2 ? meet_of(b->end[b->count]).f : sk_min(sum[0], sk_min(sum[1], sum[2])) / 3;
    if (!(sk_max(low, mean) < under) || !sk_only_has(&m->collider->only, touch->skin.particle[v[0]])) return;
    b->under[b->count] = under;
    for (int c = 0; c < 3; c++) {
        face->corner[c] = v[c < corners ? c : 0];
        b->corner[b->count][c] = sk_xyz(touch->q[face->corner[c]]);
        b->line[b->count][0][c] = c == 0, b->line[b->count][1][c] = c == 1;
    }
    face->thickness = m->thickness, face->friction = (real)m->collider->common->friction;
    if (++b->count == LANES) take_batch(m, b, find);
}

/* Loads where all are, of whom somebody is near a collider. */
static void load(const meeting *m) {
    sk_touch *touch = m->touch;
    if (!*m->loaded) sk_touch_load(touch, m->op->packed);
    for (size_t v = 0; v < touch->skin.vertex_count; v++) {
        if (!*m->loaded) touch->q[v] = sk_load(m->run->vector[SK_X], m->op->packed, touch->slot[v]);
        touch->faces.plane[v] = (sk_vec4){0, 0, 0, SK_REAL_MAX};
    }
    *m->loaded = true;
}

/* Asks for the planes of sixteen slots' vertices. */
static void find_planes_of(const meeting *m, size_t first) {
    sk_touch *touch = m->touch;
    sk_sixteen_contacts contacts;
    sk_vec3 place[LANES];
    for (size_t l = 0; l < LANES; l++) place[l] = sk_xyz(sk_load(m->run->vector[SK_X], m->op->packed, first + l));
    probe(m, &m->pose, place, LANES, m->far, &contacts);
    for (size_t l = 0; l < LANES; l++) {
        const sk_vec3 n = normal_of(&contacts, l);
        if (touch->faces.here[first + l] > 0 && contacts.distance[l] < m->far)
            touch->faces.plane[touch->vertex_at[first + l]] = (sk_vec4){n.x, n.y, n.z, contacts.distance[l]};
    }
}

/* Asks for the planes of vertices that are near; returns whether there are any. */
static bool find_planes(const meeting *m) {
    const sk_vec4 *block = m->touch->faces.block;
    const size_t count = m->touch->slots / LANES;
    sk_sixteen_contacts contacts;
    sk_vec3 place[LANES];
    bool any = false;
    place[0] = sk_xyz(block[count]);
    probe(m, &m->pose, place, 1, block[count].w + m->far, &contacts);
    if (!(contacts.distance[0] < block[count].w + m->far)) return false;
    for (size_t first = 0; first < count; first += LANES) {
        const size_t lanes = count - first < LANES ? count - first : LANES;
        real widest = 0;
        for (size_t l = 0; l < lanes; l++)
            place[l] = sk_xyz(block[first + l]), widest = sk_max(widest, block[first + l].w);
        probe(m, &m->pose, place, lanes, widest + m->far, &contacts);
        for (size_t l = 0; l < lanes; l++) {
            if (block[first + l].w < 0 || !(contacts.distance[l] < block[first + l].w + m->far)) continue;
            if (!any) load(m);
            any = true;
            find_planes_of(m, LANES * (first + l));
        }
    }
    return any;
}

typedef struct blocking {
    sk_touch *touch;
    const sk_vec4 *x;
    size_t packed;
} blocking;

/* Finds what is around those of sixteen slots who can touch. */
static sk_vec4 block_of(const blocking *job, size_t first) {
    const real *here = job->touch->faces.here + first;
    real x[3][LANES];
    if (first < job->packed) memcpy(x, job->x + first, sizeof x); // as they lie
    else
        for (size_t l = 0; l < LANES; l++) {
            const sk_vec4 at = job->x[first + l];
            x[0][l] = at.x, x[1][l] = at.y, x[2][l] = at.z;
        }
    size_t one = 0;
    while (one < LANES && !(here[one] > 0)) one++;
    if (one == LANES) return (sk_vec4){0, 0, 0, -1};
    const sk_vec3 middle = lane_of((const real(*)[LANES])x, one);
    sk_quad most = {0, 0, 0, 0};
    for (size_t l = 0; l < LANES; l += 4) {
        sk_quad at[3], is_here;
        memcpy(&is_here, here + l, sizeof is_here);
        for (int d = 0; d < 3; d++) memcpy(&at[d], x[d] + l, sizeof at[d]);
        at[0] -= middle.x, at[1] -= middle.y, at[2] -= middle.z;
        const sk_quad square = at[0] * at[0] + at[1] * at[1] + at[2] * at[2];
        most = sk_most_quad((sk_quad)((is_here > 0) & (sk_quad_lanes)square), most); // who is nobody's may be anywhere
    }
    const real widest = sk_max(sk_max(most[0], most[1]), sk_max(most[2], most[3]));
    return (sk_vec4){middle.x, middle.y, middle.z, (real)1.0001 * sk_sqrt(widest)};
}

static void find_some_blocks(void *data, int thread, size_t begin, size_t end) {
    (void)thread;
    const blocking *job = data;
    for (size_t b = begin; b < end; b++) job->touch->faces.block[b] = block_of(job, LANES * b);
}

/* And what is around all of them. */
static void find_blocks(sk_touch *touch, const sk_run *run, const sk_op *op) {
    enum { AT_ONCE = 128 };
    const size_t count = touch->slots / LANES;
    blocking job = {touch, run->vector[SK_X], op->packed};
    sk_parallel_pieces(touch->tasks, 0, count, AT_ONCE, find_some_blocks, &job);
    sk_vec4 *block = touch->faces.block, *all = block + count;
    *all = (sk_vec4){0, 0, 0, -1};
    for (; block < all; block++) {
        if (all->w < 0) *all = *block;
        else if (block->w >= 0)
            all->w = sk_max(all->w, (real)1.0001 * (block->w + sk_length(sk_sub(sk_xyz(*block), sk_xyz(*all)))));
    }
}

static void find_at(const meeting *m) {
    const sk_skin *skin = &m->touch->skin;
    if (!find_planes(m)) return;
    batch b = {.count = 0};
    for (size_t e = 0; e < skin->edge_count; e++)
        if (may_sag(m->touch->faces.plane, skin->edge[e], 2)) add(m, &b, skin->edge[e], 2, find_on_lines);
    take_batch(m, &b, find_on_lines);
    for (size_t t = 0; t < skin->triangle_count; t++)
        if (may_sag(m->touch->faces.plane, skin->triangle[t], 3)) add(m, &b, skin->triangle[t], 3, find_within);
    take_batch(m, &b, find_within);
}

/* Whether a solid is so round that no feature sags by that between its corners. No place on a triangle is farther from all three of them than 0.58 of its
 * longest side, and at a right angle to the way there the solid is nearest; sides may have got a quarter longer. */
static bool is_round(const sk_collider *collider, real longest, real sag) {
    skein_shape shape = {0};
    if (collider->type->shape) collider->type->shape(collider->params, &shape);
    if (shape.sort != SKEIN_SHAPE_BALL && shape.sort != SKEIN_SHAPE_CAPSULE) return false;
    const double aside = 0.58 * 1.25 * (double)longest, up = shape.radius - (double)sag;
    return up > 0 && up * up + aside * aside < shape.radius * shape.radius;
}

/* Lists what is near whatever collider, in the order of these. */
static void find_all(sk_touch *touch, sk_run *run, const sk_op *op) {
    sk_faces *faces = &touch->faces;
    faces->near.count = 0;
    bool loaded = false;
    find_blocks(touch, run, op);
    for (size_t i = 0; i < faces->count && !run->no_memory; i++) {
        const sk_collider *collider = faces->collider[i];
        const real whole = (real)collider->common->thickness, longest = touch->skin.longest;
        const meeting m = {touch,
                           run,
                           op,
                           &loaded,
                           collider,
                           sk_collider_pose_at(collider, run->time - op->before_end),
                           sk_collider_pose_at(collider, run->time - op->dt),
                           (real)op->dt,
                           whole,
                           (real)0.25 * whole,
                           (real)1.5 * whole,
                           (real)1.5 * whole + (real)1.25 * longest};
        if (collider->common->enabled && !is_round(collider, longest, m.sag)) find_at(&m);
    }
}

/* Goes on with what was near where the last substep ended; false where that is not known. */
static bool go_on(sk_touch *touch, const sk_run *run) {
    sk_faces *faces = &touch->faces;
    const bool known = run->iteration > 0 && faces->clock + 1 == touch->clock;
    for (size_t i = 0; i < faces->near.count && known; i++)
        faces->near.data[i].at = sk_add(faces->near.data[i].at, faces->near.data[i].way);
    return known;
}

void sk_touch_start_faces(sk_touch *touch, sk_run *run, const sk_op *op) {
    sk_faces *faces = &touch->faces;
    if (!faces->count || !touch->found) return;
    if (!go_on(touch, run)) {
        find_all(touch, run, op);
        for (size_t i = 0; i < faces->near.count; i++)
            faces->near.data[i].at = sk_add(faces->near.data[i].at, faces->near.data[i].way);
    }
    faces->clock = touch->clock;
}

void sk_touch_push_faces(sk_run *run, const sk_op *op, size_t from, size_t end) {
    (void)from, (void)end;
    sk_touch *touch = ((const sk_force *)op->rule)->state;
    if (!touch || !touch->faces.count || !touch->found) return;
    sk_faces *faces = &touch->faces;
    if (touch->before != touch->copied) touch->before = run->vector[op->source[2]];
    const bool ends = op->coefficient[0] > 0, known = faces->clock == touch->clock;
    if (ends || !(known || go_on(touch, run))) find_all(touch, run, op);
    faces->clock = touch->clock;
    if (faces->near.count) sk_touch_load(touch, op->packed);
    for (size_t i = 0; i < faces->near.count; i++) {
        const sk_face *face = &faces->near.data[i];
        sk_vec3 x[3];
        for (int c = 0; c < 3; c++) x[c] = sk_xyz(sk_load(run->vector[SK_X], op->packed, touch->slot[face->corner[c]]));
        if (sk_dot(face->normal, sk_sub(sum_of(face->weight, x), face->at)) < face->wanted)
            sk_touch_push_face(touch, run, op, face);
    }
}

/* Whether what is in it is another side than what is not: no ball has more than one within, and of an open sheet nobody knows from which side who
 * crosses it came. */
static bool has_inside(const sk_collider *collider) {
    const sk_trimesh *mesh = collider->type->surface ? collider->type->surface(collider->params) : NULL;
    return collider->type->passing != SK_NEVER_PASSED && !(mesh && mesh->sheet);
}

bool sk_faces_take(sk_faces *faces, sk_allocator *allocator, const sk_meeting_parts *parts) {
    sk_release(allocator, faces->collider);
    faces->count = 0;
    faces->collider = sk_allocate(allocator, (parts->collider_count + 1) * sizeof *faces->collider);
    for (size_t i = 0; i < parts->collider_count && faces->collider; i++)
        if (has_inside(parts->collider[i])) faces->collider[faces->count++] = parts->collider[i];
    return faces->collider;
}
