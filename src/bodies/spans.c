/* The walks over a mesh's faces, unfolded one by one, that end in spans. */
#include "bodies/spans.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/status.h"
#include "bodies/body.h"
#include "bodies/order.h"

/* Edges a span is long, as on grids (lines.c), and how many a straight walk crosses for each of its length. Measured on
 * irregular meshes that are let go from level and swing by two corners, 10 substeps, the worst of all frames: 4,096 vertices, 99th
 * percentile of stretch 2.6 %, largest 7.4 (without spans 9.9 and 23); 16,384 vertices, 2.4 and 12 % (17 and 40 with a
 * strain limit of 5 %). */
static const uint32_t span_edges[] = {5, 20};
enum { SPANS = sizeof span_edges / sizeof *span_edges, CROSSED_AN_EDGE = 2, DIRECTIONS = 2 };

/* The faces as triangles, with those beside them. Side k of a triangle leads from its corner k to the next one. */
typedef struct faces {
    sk_allocator *allocator;
    const sk_sheet *sheet;
    uint32_t (*corner)[3], (*beside)[3]; /* UINT32_MAX: nobody */
    size_t count;
    double (*side)[3]; /* lengths, m */
    size_t *start;     /* of a particle's triangles in `around`; particles + 1 */
    uint32_t *around;
} faces;

typedef struct point {
    double x, y;
} point;

/* A strip of triangles unfolded in the plane, from the origin on: its last side, left and right of the walk's line, and
 * the triangle that lies before it. */
typedef struct strip {
    uint32_t triangle, left, right;
    point at_left, at_right;
} strip;

static void difference(const double *to, const double *from, double out[3]) {
    for (int k = 0; k < 3; k++) out[k] = to[k] - from[k];
}

static double dot(const double *a, const double *b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double *a, const double *b, double out[3]) {
    for (int k = 0; k < 3; k++) out[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

static double distance(const double *a, const double *b) {
    double d[3];
    difference(a, b, d);
    return sqrt(dot(d, d));
}

/* ---- faces ---- */

static void release(faces *f) {
    sk_release(f->allocator, f->corner);
    sk_release(f->allocator, f->beside);
    sk_release(f->allocator, f->side);
    sk_release(f->allocator, f->start);
    sk_release(f->allocator, f->around);
}

static void cut(faces *f) {
    const sk_sheet *sheet = f->sheet;
    size_t count = 0;
    for (size_t face = 0; face < sheet->face_count; face++) {
        const uint32_t *c = sheet->corners + sheet->face_start[face];
        size_t size = sheet->face_start[face + 1] - sheet->face_start[face];
        for (size_t k = 1; k + 1 < size; k++, count++)
            if (f->corner) memcpy(f->corner[count], (const uint32_t[]){c[0], c[k], c[k + 1]}, sizeof *f->corner);
    }
    f->count = count;
}

/* The triangles around each particle: count, sum up, scatter. */
static void scatter(faces *f) {
    size_t particles = f->sheet->particle_count;
    for (size_t t = 0; t < f->count; t++)
        for (int k = 0; k < 3; k++) f->start[f->corner[t][k] + 2]++;
    for (size_t i = 2; i < particles + 2; i++) f->start[i] += f->start[i - 1];
    for (size_t t = 0; t < f->count; t++)
        for (int k = 0; k < 3; k++) f->around[f->start[f->corner[t][k] + 1]++] = (uint32_t)t;
}

/* Which triangle lies on the other side of side k of t; nobody, too, where there are several. */
static uint32_t find_beside(const faces *f, uint32_t t, int k) {
    uint32_t a = f->corner[t][k], b = f->corner[t][(k + 1) % 3], found = UINT32_MAX;
    for (size_t i = f->start[a]; i < f->start[a + 1]; i++) {
        uint32_t other = f->around[i];
        if (other == t) continue;
        for (int j = 0; j < 3; j++) {
            if (f->corner[other][j] != b) continue;
            if (found != UINT32_MAX) return UINT32_MAX;
            found = other;
        }
    }
    return found;
}

static const double *at(const faces *f, uint32_t particle) {
    return f->sheet->position[particle];
}

static bool find_faces(faces *f, const sk_sheet *sheet) {
    *f = (faces){.allocator = sheet->allocator, .sheet = sheet};
    cut(f);
    f->corner = sk_allocate(f->allocator, f->count * sizeof *f->corner);
    f->beside = sk_allocate(f->allocator, f->count * sizeof *f->beside);
    f->side = sk_allocate(f->allocator, f->count * sizeof *f->side);
    f->start = sk_allocate(f->allocator, (sheet->particle_count + 2) * sizeof *f->start);
    f->around = sk_allocate(f->allocator, 3 * f->count * sizeof *f->around);
    if (!f->corner || !f->beside || !f->side || !f->start || !f->around) return false;
    cut(f);
    scatter(f);
    for (uint32_t t = 0; t < f->count; t++)
        for (int k = 0; k < 3; k++) {
            f->beside[t][k] = find_beside(f, t, k);
            f->side[t][k] = distance(at(f, f->corner[t][k]), at(f, f->corner[t][(k + 1) % 3]));
        }
    return true;
}

/* ---- walks ---- */

/* Lays the apex of a triangle whose side from p to q is known, and how long it is: to the left of the way from p to q. */
static point lay(point p, point q, double length, double from_p, double from_q) {
    const double whole = 1 / length, ex = whole * (q.x - p.x), ey = whole * (q.y - p.y);
    const double along = 0.5 * (whole * (from_p * from_p - from_q * from_q) + length);
    const double square = from_p * from_p - along * along, away = sqrt(square > 0 ? square : 0);
    return (point){p.x + ex * along - ey * away, p.y + ey * along + ex * away};
}

/* Begins in the triangle around v that the direction leads into; the line becomes the x axis. False if none is there. */
static bool set_out(const faces *f, uint32_t v, const double direction[3], strip *s) {
    for (size_t i = f->start[v]; i < f->start[v + 1]; i++) {
        uint32_t t = f->around[i];
        const uint32_t *c = f->corner[t];
        int k = c[0] == v ? 0 : c[1] == v ? 1 : 2;
        double a[3], b[3], normal[3], n1[3], n2[3];
        difference(at(f, c[(k + 1) % 3]), at(f, v), a);
        difference(at(f, c[(k + 2) % 3]), at(f, v), b);
        cross(a, b, normal);
        double square = dot(normal, normal), la = sqrt(dot(a, a)), lb = sqrt(dot(b, b));
        if (!(square > 1e-12 * la * la * lb * lb)) continue;
        cross(direction, b, n1);
        cross(a, direction, n2);
        double of_a = dot(n1, normal) / square,
               of_b = dot(n2, normal) / square; // direction = of_a a + of_b b + a normal
        if (of_a < 0 || of_b < 0 || !(of_a + of_b > 0)) continue;
        double x[3], size = 0;
        for (int n = 0; n < 3; n++) x[n] = of_a * a[n] + of_b * b[n], size += x[n] * x[n];
        size = sqrt(size);
        double ax = dot(a, x) / size, bx = dot(b, x) / size;
        *s = (strip){t,
                     c[(k + 2) % 3],
                     c[(k + 1) % 3],
                     {bx, sqrt(fmax(0, lb * lb - bx * bx))},
                     {ax, -sqrt(fmax(0, la * la - ax * ax))}};
        return true;
    }
    return false;
}

static uint32_t beyond(const faces *f, const strip *s) {
    const uint32_t *c = f->corner[s->triangle];
    for (int k = 0; k < 3; k++) {
        uint32_t a = c[k], b = c[(k + 1) % 3];
        if ((a == s->left && b == s->right) || (a == s->right && b == s->left)) return f->beside[s->triangle][k];
    }
    return UINT32_MAX;
}

/* Goes on over the last side; false at the sheet's border. */
static bool go_on(const faces *f, strip *s) {
    uint32_t next = beyond(f, s);
    if (next == UINT32_MAX) return false;
    const uint32_t *c = f->corner[next];
    int k = 0;
    while (k < 2 && (c[k] == s->left || c[k] == s->right)) k++;
    const uint32_t apex = c[k];
    const double *side = f->side[next], after = side[k], before = side[(k + 2) % 3];
    const bool left_first = c[(k + 1) % 3] == s->left;
    const point p =
        lay(s->at_left, s->at_right, side[(k + 1) % 3], left_first ? after : before, left_first ? before : after);
    s->triangle = next;
    if (p.y >= 0) s->left = apex, s->at_left = p;
    else s->right = apex, s->at_right = p;
    return true;
}

/* The particle that a straight walk over so many edges leads to, and its distance; UINT32_MAX if a border comes
 * first. */
static uint32_t walk(const faces *f, uint32_t from, const double direction[3], uint32_t edges, double *length) {
    strip s;
    if (!set_out(f, from, direction, &s)) return UINT32_MAX;
    for (uint32_t i = 1; i < CROSSED_AN_EDGE * edges; i++)
        if (!go_on(f, &s)) return UINT32_MAX;
    bool left = s.at_left.y < -s.at_right.y; // the nearer to the line
    point p = left ? s.at_left : s.at_right;
    uint32_t to = left ? s.left : s.right;
    // a strip that turns may be left by the straight line: never shorter than it is
    *length = fmax(sqrt(p.x * p.x + p.y * p.y), distance(at(f, from), at(f, to)));
    return to == from || !isfinite(*length) || !(*length > 0) ? UINT32_MAX : to;
}

/* ---- spans ---- */

typedef struct span {
    uint32_t first, a, b; /* `first`: the lower of their ranks, or 0 */
    double length;
} span;

static int compare_spans(const void *p, const void *q) {
    const span *s = p, *t = q;
    if (s->first != t->first) return s->first < t->first ? -1 : 1;
    if (s->a != t->a) return s->a < t->a ? -1 : 1;
    return s->b < t->b ? -1 : s->b > t->b;
}

/* The sheet's normal at a particle, by area. */
static void find_normal(const faces *f, uint32_t v, double out[3]) {
    memset(out, 0, 3 * sizeof *out);
    for (size_t i = f->start[v]; i < f->start[v + 1]; i++) {
        const uint32_t *c = f->corner[f->around[i]];
        double a[3], b[3], n[3];
        difference(at(f, c[1]), at(f, c[0]), a);
        difference(at(f, c[2]), at(f, c[0]), b);
        cross(a, b, n);
        for (int k = 0; k < 3; k++) out[k] += n[k];
    }
}

/* The directions of walks from a particle: along the first axis, unless it stands nearly on the sheet, and across. */
static void find_directions(const faces *f, uint32_t v, const double (*axes)[3], double out[DIRECTIONS][3]) {
    double normal[3], u[3];
    find_normal(f, v, normal);
    double square = dot(normal, normal), along = dot(normal, axes[0]);
    memcpy(u, along * along > 0.75 * square ? axes[1] : axes[0], sizeof u);
    along = square > 0 ? dot(normal, u) / square : 0;
    for (int k = 0; k < 3; k++) out[0][k] = u[k] - along * normal[k];
    cross(normal, out[0], out[1]);
}

/* A walk each way from every particle; the opposite way where a border is near. */
static size_t find_spans(const faces *f, const double (*axes)[3], const uint32_t *rank, uint32_t edges, span *out) {
    size_t count = 0;
    for (uint32_t v = 0; v < f->sheet->particle_count; v++) {
        double direction[DIRECTIONS][3];
        find_directions(f, v, axes, direction);
        for (int d = 0; d < DIRECTIONS; d++) {
            double length;
            uint32_t to = walk(f, v, direction[d], edges, &length);
            if (to == UINT32_MAX) {
                for (int k = 0; k < 3; k++) direction[d][k] = -direction[d][k];
                to = walk(f, v, direction[d], edges, &length);
            }
            if (to == UINT32_MAX) continue;
            out[count++] = (span){!rank ? 0 : rank[v] < rank[to] ? rank[v] : rank[to], v, to, length};
        }
    }
    qsort(out, count, sizeof *out, compare_spans);
    return count;
}

static skein_status add_batch(const faces *f, skein_world *world, sk_body *body, const span *spans, size_t count,
                              bool scattered, skein_error *error) {
    uint32_t *pairs = sk_allocate(f->allocator, 2 * count * sizeof *pairs);
    real *rest = sk_allocate(f->allocator, count * sizeof *rest);
    uint32_t *place = sk_allocate(f->allocator, count * sizeof *place);
    skein_status status = pairs && rest && place ? SKEIN_OK : sk_fail_memory(error, "span");
    if (scattered && !status) sk_order_scatter(place, count);
    for (size_t i = 0; i < count && !status; i++) {
        const span *s = &spans[scattered ? place[i] : i];
        pairs[2 * i] = body->first_particle + s->a, pairs[2 * i + 1] = body->first_particle + s->b;
        rest[i] = (real)s->length;
    }
    sk_release(f->allocator, place);
    if (!status)
        status = sk_world_add_body_batch(world, body, &sk_distance, "span", (sk_material){0, 0}, false, count, pairs,
                                         rest, NULL, error);
    if (!status) sk_world_only_bound(body, &body->tether_bound);
    sk_release(f->allocator, pairs);
    sk_release(f->allocator, rest);
    return status;
}

/* Whether each side of each face has another face beside it. */
static bool is_closed(const faces *f) {
    bool closed = true;
    for (size_t t = 0; t < f->count; t++)
        for (int k = 0; k < 3; k++) closed &= f->beside[t][k] != UINT32_MAX;
    return closed;
}

skein_status sk_spans_add(const sk_sheet *sheet, const double (*axes)[3], const uint32_t *rank, bool may_grow,
                          skein_world *world, sk_body *body, skein_error *error) {
    faces f;
    span *spans = sk_allocate(sheet->allocator, DIRECTIONS * sheet->particle_count * sizeof *spans);
    skein_status status = find_faces(&f, sheet) && spans ? SKEIN_OK : sk_fail_memory(error, "span");
    const bool bounded = !status && !(may_grow && is_closed(&f));
    for (int i = SPANS; i-- > 0 && bounded && !status;) {                             // long ones first
        if ((size_t)span_edges[i] * span_edges[i] >= sheet->particle_count) continue; // it would lead all around
        size_t count = find_spans(&f, axes, rank, span_edges[i], spans);
        if (count) status = add_batch(&f, world, body, spans, count, !rank, error);
    }
    sk_release(sheet->allocator, spans);
    release(&f);
    return status;
}
