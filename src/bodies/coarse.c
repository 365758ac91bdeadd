/* Making a cloth's coarse grids, each from the finer one before it, down to the coarsest. */
#include "bodies/coarse.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/status.h"

/* Measured on the default cloth of 128 x 128 that is let go from level and swings by two corners with drag, 10 substeps,
 * 99th percentile and largest stretch, the worst of all frames: 0.68 and 2.2 %; spans of 5 and 20 edges on all particles
 * 1.5 and 3.6. One sweep of the finest of these grids: 0.77 here, but 0.99 instead of 0.66 at 64 x 64, and 1.8 instead of
 * 1.2 at 100 x 64; three of the coarser ones 0.62. On the way there: tethers of all particles after everything else 0.80
 * and 2.0, and without the coarsest grid's own, on grids that began at the first row and column, 0.75 and 2.6; without the
 * fifth neighbours, but with diagonals, 1.1 and 4.7; one sweep a grid, with diagonals, 1.2 and 3.7; two and diagonals 0.7
 * and 2.6, which is no better and takes a fifth longer. */
enum {
    MOST_GRIDS = 8,
    LEAST_ROWS = 3,  /* of the coarsest grid */
    LEAST_WIDTH = 4, /* columns a strip: smaller sheets, to 48, are as firm with spans, and faster */
    LONG = 5,        /* neighbours on: the longest distances */
    SWEEPS = 2       /* of a grid's own distances, forth and back */
};

/* A grid under construction, and how much mass goes with each of its particles. */
typedef struct level {
    sk_coarse_grid grid;
    size_t rows, columns; /* of the coarse grid */
    double *mass;         /* rows x columns */
} level;

typedef struct builder {
    const sk_lines *lines;
    sk_allocator *allocator;
    size_t width;                /* columns a strip */
    level level[MOST_GRIDS + 1]; /* the first: all particles */
    size_t count;
} builder;

bool sk_coarse_fits(const sk_lines *lines) {
    if (!lines->even) return false;
    for (size_t row = 0, place = 0; row < lines->rows; row++)
        for (size_t column = 0; column < lines->columns; column++, place++) {
            if (lines->particle[place] == UINT32_MAX) return false;
            bool cell = row + 1 < lines->rows && column + 1 < lines->columns;
            if (cell && !(lines->area[place] > 0)) return false;
        }
    return lines->rows >= 2 * LEAST_ROWS && sk_strip_width(lines->columns) >= LEAST_WIDTH;
}

bool sk_coarse_fits_across(uint32_t rows, uint32_t columns) {
    return columns >= 2 * LEAST_ROWS && sk_strip_width(columns) < LEAST_WIDTH && sk_strip_width(rows) >= LEAST_WIDTH;
}

static bool in_grid(const sk_coarse_grid *grid, size_t width, size_t row, size_t column) {
    size_t block = column % width;
    return row >= grid->row_first && (row - grid->row_first) % grid->row_step == 0 && block >= grid->first &&
           (block - grid->first) % grid->step == 0;
}

bool sk_coarse_has(const sk_coarse_grid *grid, const sk_lines *lines, uint32_t particle) {
    size_t places = (size_t)lines->rows * lines->columns, width = sk_strip_width(lines->columns);
    size_t place = lines->particle[particle] == particle ? particle : 0;
    while (place < places && lines->particle[place] != particle) place++;
    return place < places && in_grid(grid, width, place / lines->columns, place % lines->columns);
}

/* ---- where the grids lie ---- */

/* The one of the first two places of `step` that leaves more equal margins at both ends, and so more equal masses. */
static uint32_t middle_first(uint32_t first, uint32_t step, size_t count) {
    uint32_t second = first + step;
    int64_t a = (int64_t)first - (int64_t)((count - 1 - first) % (2 * step));
    int64_t b = (int64_t)second - (int64_t)((count - 1 - second) % (2 * step));
    return second < count && llabs(b) < llabs(a) ? second : first;
}

static size_t row_of(const level *l, size_t i) {
    return l->grid.row_first + i * l->grid.row_step;
}
/* The i-th of a grid's columns, counted through all strips. */
static size_t column_of(const builder *b, const level *l, size_t i) {
    size_t each = sk_coarse_columns(&l->grid, b->width);
    return i / each * b->width + l->grid.first + i % each * l->grid.step;
}

static void measure_grid(const builder *b, level *l) {
    l->rows = sk_coarse_rows(&l->grid, b->lines->rows);
    l->columns = b->lines->columns / b->width * sk_coarse_columns(&l->grid, b->width);
    while (column_of(b, l, l->columns) < b->lines->columns) l->columns++;
}

/* Adds the next coarser grid; false if it would be too coarse: strips need at least two columns. */
static bool halve(builder *b) {
    const sk_coarse_grid *finer = &b->level[b->count - 1].grid;
    if (b->count > MOST_GRIDS || sk_coarse_columns(finer, b->width) < 3) return false;
    level *l = &b->level[b->count];
    *l = (level){.grid = {middle_first(finer->row_first, finer->row_step, b->lines->rows), 2 * finer->row_step,
                          middle_first(finer->first, finer->step, b->width), 2 * finer->step}};
    if (sk_coarse_columns(&l->grid, b->width) < 2) l->grid.first = finer->first;
    measure_grid(b, l);
    return l->rows >= LEAST_ROWS;
}

/* ---- masses ---- */

/* The two lines of a grid that a place is between, and how far along; beyond the last ones, the nearest alone. */
typedef struct between {
    size_t low, high;
    double share; /* of the high one */
} between;

static between find_between(const builder *b, const level *l, size_t place, bool row) {
    size_t count = row ? l->rows : l->columns, low = 0, high = count;
    while (high - low > 1) { // the last that is not beyond the place
        size_t middle = (low + high) / 2, at = row ? row_of(l, middle) : column_of(b, l, middle);
        if (at <= place) low = middle;
        else high = middle;
    }
    size_t at = row ? row_of(l, low) : column_of(b, l, low);
    if (place <= at || low + 1 == count) return (between){low, low, 0};
    size_t next = row ? row_of(l, low + 1) : column_of(b, l, low + 1);
    return (between){low, low + 1, (double)(place - at) / (double)(next - at)};
}

/* The masses that a grid's particles carry: by the transpose of the interpolation, so that momentum is conserved. */
static bool sum_up_masses(const builder *b, const level *finer, level *l) {
    l->mass = sk_allocate(b->allocator, l->rows * l->columns * sizeof *l->mass);
    if (!l->mass) return false;
    for (size_t i = 0; i < finer->rows; i++) {
        between r = find_between(b, l, row_of(finer, i), true);
        for (size_t j = 0; j < finer->columns; j++) {
            between c = find_between(b, l, column_of(b, finer, j), false);
            double mass = finer->mass[i * finer->columns + j];
            l->mass[r.low * l->columns + c.low] += (1 - r.share) * (1 - c.share) * mass;
            l->mass[r.low * l->columns + c.high] += (1 - r.share) * c.share * mass;
            l->mass[r.high * l->columns + c.low] += r.share * (1 - c.share) * mass;
            l->mass[r.high * l->columns + c.high] += r.share * c.share * mass;
        }
    }
    return true;
}

static bool start(builder *b, const sk_lines *lines, const double *mass) {
    *b = (builder){.lines = lines, .allocator = lines->allocator, .width = sk_strip_width(lines->columns), .count = 1};
    level *all = &b->level[0];
    all->grid = (sk_coarse_grid){0, 1, 0, 1};
    all->rows = lines->rows, all->columns = lines->columns;
    all->mass = sk_allocate(b->allocator, all->rows * all->columns * sizeof *all->mass);
    if (!all->mass) return false;
    for (size_t place = 0; place < all->rows * all->columns; place++) all->mass[place] = mass[lines->particle[place]];
    for (; halve(b); b->count++)
        if (!sum_up_masses(b, &b->level[b->count - 1], &b->level[b->count])) return false;
    return true;
}

/* ---- distances ---- */

typedef struct distances {
    uint32_t *pairs;
    double *rest; /* lengths, then shares of first ends, then of second ones */
    size_t count, most;
} distances;

static void add_distance(const builder *b, const level *l, distances *d, size_t first_particle, size_t i, size_t j,
                         size_t to_i, size_t to_j) {
    const sk_lines *lines = b->lines;
    size_t row = row_of(l, i), column = column_of(b, l, j), to_row = row_of(l, to_i), to_column = column_of(b, l, to_j);
    double length = 0;
    for (size_t r = row; r < to_row; r++) length += sk_lines_edge(lines, r, column, true);
    for (size_t c = column; c < to_column; c++) length += sk_lines_edge(lines, row, c, false);
    size_t from = row * lines->columns + column, to = to_row * lines->columns + to_column, e = d->count++;
    d->pairs[2 * e] = (uint32_t)first_particle + lines->particle[from];
    d->pairs[2 * e + 1] = (uint32_t)first_particle + lines->particle[to];
    d->rest[e] = length;
    d->rest[d->most + e] = b->level[0].mass[from] / l->mass[i * l->columns + j];
    d->rest[2 * d->most + e] = b->level[0].mass[to] / l->mass[to_i * l->columns + to_j];
}

/* All distances to the n-th neighbours along rows and columns, as a batch. */
static skein_status add_batch(const builder *b, const level *l, size_t n, const sk_coarse *coarse, skein_world *world,
                              sk_body *body, skein_error *error) {
    distances d = {.most = 2 * l->rows * l->columns};
    d.pairs = sk_allocate(b->allocator, 2 * d.most * sizeof *d.pairs);
    d.rest = sk_allocate(b->allocator, 3 * d.most * sizeof *d.rest);
    real *rest = sk_allocate(b->allocator, 3 * d.most * sizeof *rest);
    skein_status status = d.pairs && d.rest && rest ? SKEIN_OK : sk_fail_memory(error, "coarse grid");
    for (size_t i = 0; i < l->rows && !status; i++)
        for (size_t j = 0; j < l->columns; j++) {
            if (j + n < l->columns) add_distance(b, l, &d, body->first_particle, i, j, i, j + n);
            if (i + n < l->rows) add_distance(b, l, &d, body->first_particle, i, j, i + n, j);
        }
    for (size_t e = 0; e < 3 * d.count && !status; e++) rest[e] = (real)d.rest[e / d.count * d.most + e % d.count];
    if (!status)
        status = sk_world_add_body_batch(world, body, &sk_coarse_distance, "coarse", (sk_material){0, 0}, false,
                                         d.count, d.pairs, rest, NULL, error);
    if (!status && !sk_world_bound_coarse(world, body, &body->tether_bound, coarse))
        status = sk_fail_memory(error, "coarse grid");
    sk_release(b->allocator, d.pairs);
    sk_release(b->allocator, d.rest);
    sk_release(b->allocator, rest);
    return status;
}

skein_status sk_coarse_add(const sk_lines *lines, const double *mass, skein_world *world, sk_body *body,
                           sk_coarse_grid *coarsest, skein_error *error) {
    builder *b = sk_allocate(lines->allocator, sizeof *b);
    skein_status status = b && start(b, lines, mass) ? SKEIN_OK : sk_fail_memory(error, "coarse grid");
    *coarsest = (sk_coarse_grid){0};
    for (size_t k = b ? b->count : 0; k-- > 1 && !status;) {
        const level *l = &b->level[k];
        sk_coarse coarse = {l->grid, b->level[k - 1].grid, lines->columns, false, 1};
        size_t each = sk_coarse_columns(&l->grid, b->width), n = LONG % each ? LONG : LONG + 1; // else it meets itself
        if (k + 1 == b->count) *coarsest = l->grid;
        if (k + 1 == b->count) status = add_batch(b, l, n, &coarse, world, body, error);
        coarse.carries = true, coarse.times = SWEEPS;
        if (!status) status = add_batch(b, l, 1, &coarse, world, body, error);
    }
    for (size_t k = 0; b && k <= MOST_GRIDS; k++) sk_release(lines->allocator, b->level[k].mass);
    sk_release(lines->allocator, b);
    return status;
}
