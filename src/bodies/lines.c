/* A grid's rows and columns: found in a sheet, measured, and turned into elements of bending, shear and spans. */
#include "bodies/lines.h"

#include <math.h>
#include <string.h>

#include "base/status.h"
#include "bodies/body.h"

enum { ALONG_ROW, ALONG_COLUMN, DIRECTIONS };

/* The lengths of spans in edges. A sweep over edges carries a correction over a few of them; short spans carry it over
 * some tens, and longer ones over all. Measured on the default cloth of 128 x 128 let go from level, swinging by two
 * corners, 10 substeps, 99th percentile of stretch, the worst of every fifth frame: 15 % without spans, 2.7 % with those of 5, 2.1 %
 * with 10, 7.5 % with 20, 1.1 % with 5 and 20, 1.5 % with 5 and 41, 1.0 % with 3, 9 and 30. */
static const uint32_t span_edges[] = {5, 20};
enum { SPANS = sizeof span_edges / sizeof *span_edges };

static size_t place_at(const sk_lines *lines, size_t row, size_t column) {
    return row * lines->columns + column;
}

static const double *position_at(const sk_lines *lines, size_t place) {
    return lines->sheet->position[lines->particle[place]];
}

static void difference(const double *to, const double *from, double out[3]) {
    for (int k = 0; k < 3; k++) out[k] = to[k] - from[k];
}

static double dot(const double *a, const double *b) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static double distance(const double *a, const double *b) {
    double d[3];
    difference(a, b, d);
    return sqrt(dot(d, d));
}

/* ---- cells ---- */

/* Notes along which diagonal a triangle cuts its cell: it has one of the two corners off the main one, or both. */
static void note_cut(sk_lines *lines, size_t face, const uint32_t *place_of, const uint32_t low[2]) {
    const sk_sheet *sheet = lines->sheet;
    size_t off = 0, first = sheet->face_start[face];
    if (sheet->face_start[face + 1] != first + 3) return;
    for (size_t k = first; k < first + 3; k++) {
        uint32_t place = place_of ? place_of[sheet->corners[k]] : sheet->corners[k];
        off += place / lines->columns - low[0] != place % lines->columns - low[1];
    }
    lines->cut[off == 1] = true;
}

/* Adds a face to the cell that it lies in; false if it lies in none. */
static bool put_in_cell(sk_lines *lines, size_t face, const uint32_t *place_of) {
    const sk_sheet *sheet = lines->sheet;
    if (sheet->face_start[face + 1] == sheet->face_start[face]) return true; // welded shut
    uint32_t low[2] = {UINT32_MAX, UINT32_MAX}, high[2] = {0, 0};
    for (size_t k = sheet->face_start[face]; k < sheet->face_start[face + 1]; k++) {
        uint32_t place = place_of ? place_of[sheet->corners[k]] : sheet->corners[k];
        uint32_t at[2] = {place / lines->columns, place % lines->columns};
        for (int i = 0; i < 2; i++) {
            if (at[i] < low[i]) low[i] = at[i];
            if (at[i] > high[i]) high[i] = at[i];
        }
    }
    if (high[0] != low[0] + 1 || high[1] != low[1] + 1) return false;
    note_cut(lines, face, place_of, low);
    lines->area[place_at(lines, low[0], low[1])] += sheet->face_area[face];
    return true;
}

/* Twice the area of a cell's four corners along its normal; false where a corner is missing or it is no rectangle. */
static bool measure_cell(const sk_lines *lines, size_t place, double normal[3]) {
    const double nearly = 1e-3;
    size_t columns = lines->columns, corner[4] = {place, place + 1, place + columns, place + columns + 1};
    for (int k = 0; k < 4; k++)
        if (lines->particle[corner[k]] == UINT32_MAX) return false;
    double u[3], v[3], w[3], t[3];
    difference(position_at(lines, corner[1]), position_at(lines, corner[0]), u);
    difference(position_at(lines, corner[2]), position_at(lines, corner[0]), v);
    difference(position_at(lines, corner[3]), position_at(lines, corner[2]), w);
    difference(u, w, t);
    for (int k = 0; k < 3; k++) normal[k] = u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
    double size = sqrt(dot(u, u) * dot(v, v));
    return size > 0 && fabs(dot(u, v)) < nearly * size && dot(t, t) < nearly * nearly * size;
}

/* Whether all cells are rectangles that look the same way, and share their edges' directions. */
static bool is_flat(const sk_lines *lines) {
    const double nearly = 1e-3;
    double first[3] = {0, 0, 0}, normal[3];
    for (size_t place = 0; place < (size_t)lines->rows * lines->columns; place++) {
        if (!(lines->area[place] > 0)) continue;
        if (!measure_cell(lines, place, normal)) return false;
        if (!(dot(first, first) > 0)) memcpy(first, normal, sizeof first);
        double size = sqrt(dot(first, first) * dot(normal, normal));
        if (!(dot(first, normal) > (1 - 0.5 * nearly * nearly) * size)) return false;
    }
    return dot(first, first) > 0;
}

bool sk_lines_find(sk_lines *lines, const sk_sheet *sheet, uint32_t rows, uint32_t columns, const uint32_t *place) {
    *lines = (sk_lines){.allocator = sheet->allocator, .sheet = sheet, .rows = rows, .columns = columns};
    size_t places = (size_t)rows * columns;
    lines->particle = sk_allocate(sheet->allocator, places * sizeof *lines->particle);
    lines->area = sk_allocate(sheet->allocator, places * sizeof *lines->area);
    if (!lines->particle || !lines->area) return false;
    memset(lines->particle, 0xff, places * sizeof *lines->particle);
    for (uint32_t i = 0; i < sheet->particle_count; i++) lines->particle[place ? place[i] : i] = i;
    bool all = true;
    for (size_t f = 0; f < sheet->face_count; f++) all &= put_in_cell(lines, f, place);
    lines->flat = all && is_flat(lines);
    lines->even = lines->flat && !(lines->cut[0] && lines->cut[1]);
    return true;
}

void sk_lines_release(sk_lines *lines) {
    if (!lines->allocator) return;
    sk_release(lines->allocator, lines->particle);
    sk_release(lines->allocator, lines->area);
    *lines = (sk_lines){.allocator = NULL};
}

/* ---- elements ---- */

/* Elements under construction: room for `most`. */
typedef struct maker {
    const sk_lines *lines;
    sk_body *body;
    sk_elements made;
    size_t arity, rests, most;
} maker;

static bool start(maker *m, const sk_lines *lines, sk_body *body, size_t arity, size_t rests, size_t most) {
    sk_allocator *allocator = lines->allocator;
    *m = (maker){lines, body, {.count = 0}, arity, rests, most};
    m->made.particle = sk_allocate(allocator, most * arity * sizeof *m->made.particle);
    m->made.rest = sk_allocate(allocator, most * rests * sizeof *m->made.rest);
    m->made.scale = sk_allocate(allocator, most * sizeof *m->made.scale);
    return m->made.particle && m->made.rest && m->made.scale;
}

/* Rest values lie most apart until all are known. */
static void add(maker *m, const size_t *places, const double *rest, double scale) {
    sk_elements *made = &m->made;
    for (size_t i = 0; i < m->arity; i++)
        made->particle[made->count * m->arity + i] = m->body->first_particle + m->lines->particle[places[i]];
    for (size_t r = 0; r < m->rests; r++) made->rest[r * m->most + made->count] = (real)rest[r];
    made->scale[made->count++] = (real)scale;
}

/* The square of the stiffest element's angular frequency, for a stiffness of 1: the sum of w c^2 times its scale, where
 * c are its particles' weights in the sum under the root: (a, -a - b, b) for three in a line, a and -a around a cell.
 * Elements that overlap with it raise the frequency: by up to 16/9 around a cell, by 32/14 in a line along the border
 * (sums of w c c' over all that share particles). may_wait()'s bound includes the latter, so cells count less here. */
static double quickness_of(const maker *m, const skein_world *world) {
    static const double cell = 16.0 / 9 / (32.0 / 14);
    const sk_elements *made = &m->made;
    double most = 0;
    for (size_t e = 0; e < made->count; e++) {
        double a = made->rest[e], b = m->rests > 1 ? made->rest[made->count + e] : 0, sum = 0;
        const double counts[2][4] = {{a, -a - b, b, 0}, {a, -a, a, -a}};
        for (size_t i = 0; i < m->arity; i++) {
            double mass = world->particles.mass[made->particle[e * m->arity + i]], c = counts[m->arity == 4][i];
            if (mass > 0) sum += c * c / mass;
        }
        most = fmax(most, sum * made->scale[e] * (m->arity == 4 ? cell : 1));
    }
    return most;
}

static skein_status finish(maker *m, skein_world *world, const sk_constraint_type *type, const char *label,
                           double stiffness, bool good, skein_error *error) {
    sk_elements *made = &m->made;
    for (size_t r = 1; r < m->rests && good; r++)
        memmove(made->rest + r * made->count, made->rest + r * m->most, made->count * sizeof *made->rest);
    skein_status status = good
                              ? sk_world_add_body_batch(world, m->body, type, label, (sk_material){stiffness, 0}, false,
                                                        made->count, made->particle, made->rest, made->scale, error)
                              : sk_fail_memory(error, label);
    if (!status && type != &sk_distance) {
        sk_world_take_seldom(m->body, quickness_of(m, world));
        sk_world_sweep_both_ways(m->body);
    }
    sk_release(m->lines->allocator, made->particle);
    sk_release(m->lines->allocator, made->rest);
    sk_release(m->lines->allocator, made->scale);
    return status;
}

/* The area of a cell, and 0 outside of the grid. */
static double area_at(const sk_lines *lines, int64_t row, int64_t column) {
    if (row < 0 || column < 0 || row + 1 >= lines->rows || column + 1 >= lines->columns) return 0;
    return lines->area[place_at(lines, (size_t)row, (size_t)column)];
}

/* The share of the sheet that bends at a place along a row or column: on each side a quarter of both cells. */
static double bent_area(const sk_lines *lines, size_t row, size_t column, int direction) {
    double sum = 0;
    for (int side = 0; side < 2; side++) {
        int64_t r = (int64_t)row, c = (int64_t)column;
        double one = direction == ALONG_ROW ? area_at(lines, r - side, c - 1) : area_at(lines, r - 1, c - side);
        double other = direction == ALONG_ROW ? area_at(lines, r - side, c) : area_at(lines, r, c - side);
        if (one > 0 && other > 0) sum += (one + other) / 4;
    }
    return sum;
}

static skein_status add_straight(const sk_lines *lines, skein_world *world, sk_body *body, double rigidity,
                                 skein_error *error) {
    maker m;
    size_t places = (size_t)lines->rows * lines->columns;
    bool good = start(&m, lines, body, 3, 2, DIRECTIONS * places);
    for (int direction = 0; direction < DIRECTIONS && good; direction++) {
        size_t step = direction == ALONG_ROW ? 1 : lines->columns;
        for (size_t row = 0, place = 0; row < lines->rows; row++)
            for (size_t column = 0; column < lines->columns; column++, place++) {
                double area = bent_area(lines, row, column, direction);
                if (!(area > 0)) continue;
                const double *x = position_at(lines, place);
                double before = distance(x, position_at(lines, place - step));
                double after = distance(x, position_at(lines, place + step)), length = (before + after) / 2;
                add(&m, (const size_t[]){place - step, place, place + step}, (const double[]){1 / before, 1 / after},
                    area / (length * length));
            }
    }
    return finish(&m, world, &sk_straight, "bend", rigidity, good, error);
}

/* A cell that has only one of its triangles is half as stiff. */
static skein_status add_twist(const sk_lines *lines, skein_world *world, sk_body *body, double rigidity,
                              skein_error *error) {
    maker m;
    size_t places = (size_t)lines->rows * lines->columns, columns = lines->columns;
    bool good = start(&m, lines, body, 4, 1, places);
    for (size_t place = 0; place < places && good; place++) {
        double normal[3];
        if (!(lines->area[place] > 0) || !measure_cell(lines, place, normal)) continue;
        double whole = sqrt(dot(normal, normal));
        add(&m, (const size_t[]){place, place + 1, place + columns + 1, place + columns},
            (const double[]){1 / sqrt(whole)}, 2 * lines->area[place] / whole);
    }
    return finish(&m, world, &sk_twist, "twist", rigidity, good, error);
}

skein_status sk_lines_add_bending(const sk_lines *lines, skein_world *world, sk_body *body, double rigidity,
                                  skein_error *error) {
    skein_status status = add_straight(lines, world, body, rigidity, error);
    return status ? status : add_twist(lines, world, body, rigidity, error);
}

/* ---- spans ---- */

/* Length of an edge along a row or column; 0 where no cell is beside it. */
static double edge_length(const sk_lines *lines, size_t row, size_t column, int direction) {
    int64_t r = (int64_t)row, c = (int64_t)column;
    bool there =
        area_at(lines, r, c) > 0 || (direction == ALONG_ROW ? area_at(lines, r - 1, c) : area_at(lines, r, c - 1)) > 0;
    if (!there) return 0;
    size_t place = place_at(lines, row, column), next = direction == ALONG_ROW ? place + 1 : place + lines->columns;
    if (lines->particle[place] == UINT32_MAX || lines->particle[next] == UINT32_MAX) return 0; // of one triangle
    return distance(position_at(lines, place), position_at(lines, next));
}

double sk_lines_edge(const sk_lines *lines, size_t row, size_t column, bool along_column) {
    return edge_length(lines, row, column, along_column ? ALONG_COLUMN : ALONG_ROW);
}

static double mean_edge(const sk_lines *lines, int direction) {
    double sum = 0;
    size_t count = 0;
    for (size_t place = 0; place < (size_t)lines->rows * lines->columns; place++) {
        double length = edge_length(lines, place / lines->columns, place % lines->columns, direction);
        sum += length, count += length > 0;
    }
    return count ? sum / (double)count : 0;
}

bool sk_lines_square(const sk_lines *lines) {
    static const double most = 1.1;
    double a = mean_edge(lines, ALONG_ROW), b = mean_edge(lines, ALONG_COLUMN);
    return a <= most * b && b <= most * a;
}

/* All spans of so many edges along one row or column. */
static void add_spans_along(maker *m, size_t line, uint32_t edges, int direction, double *length) {
    const sk_lines *lines = m->lines;
    size_t count = direction == ALONG_ROW ? lines->columns : lines->rows;
    double sum = 0;
    uint32_t whole = 0; // edges in a row that are there
    for (size_t i = 0; i + 1 < count; i++) {
        size_t row = direction == ALONG_ROW ? line : i, column = direction == ALONG_ROW ? i : line;
        length[i] = edge_length(lines, row, column, direction);
        whole = length[i] > 0 ? whole + 1 : 0;
        if (whole < edges) continue;
        sum = 0;
        for (size_t k = i + 1 - edges; k <= i; k++) sum += length[k];
        size_t step = direction == ALONG_ROW ? 1 : lines->columns, last = place_at(lines, row, column) + step;
        add(m, (const size_t[]){last - edges * step, last}, &sum, 1);
    }
}

/* Sixteen strips lie beside each other (particles/particles.h): a span of as many columns as a strip has, or of a
 * multiple, would meet itself there, and could not walk along. */
static uint32_t length_in_strips(uint32_t edges, uint32_t columns) {
    uint32_t width = (columns + 15) / 16;
    return width > 2 && edges % width == 0 ? edges + 1 : edges;
}

skein_status sk_lines_add_spans(const sk_lines *lines, skein_world *world, sk_body *body, skein_error *error) {
    size_t longest = lines->rows > lines->columns ? lines->rows : lines->columns;
    double *length = sk_allocate(lines->allocator, longest * sizeof *length);
    skein_status status = length ? SKEIN_OK : sk_fail_memory(error, "span");
    for (int i = SPANS; i-- > 0 && !status;) { // long ones first
        uint32_t edges = length_in_strips(span_edges[i], lines->columns);
        if (edges >= longest) continue;
        maker m;
        bool good = start(&m, lines, body, 2, 1, DIRECTIONS * (size_t)lines->rows * lines->columns);
        for (size_t row = 0; row < lines->rows && good; row++) add_spans_along(&m, row, edges, ALONG_ROW, length);
        for (size_t c = 0; c < lines->columns && good; c++) add_spans_along(&m, c, edges, ALONG_COLUMN, length);
        status = finish(&m, world, &sk_distance, "span", 0, good, error);
        if (!status) sk_world_only_bound(body, &body->tether_bound);
    }
    sk_release(lines->allocator, length);
    return status;
}
