/* The student's flock. Built with -O3 -march=native -ffast-math -fopenmp-simd, so that the loops over neighbours are
 * wide: every weight is worked out for every candidate, and those that do not count are multiplied by 0. */
#include "bench/plain_flock.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static float *numbers(size_t count) {
    return aligned_alloc(64, (count + 64) * sizeof(float) / 64 * 64 + 64);
}

plain_flock *plain_flock_create(size_t count, const double *positions, const double *velocities, double separation,
                                double alignment, double cohesion, double dt) {
    plain_flock *f = calloc(1, sizeof *f);
    if (!f) return NULL;
    *f = (plain_flock){.count = count,
                       .separation = (float)separation,
                       .alignment = (float)alignment,
                       .cohesion = (float)cohesion,
                       .dt = (float)dt};
    double low = 0, high = 0;
    for (size_t i = 0; i < 3 * count; i++) low = fmin(low, positions[i]), high = fmax(high, positions[i]);
    f->low = (float)low;
    f->size = (float)(separation + alignment + cohesion);
    f->cells = (size_t)((high - low) / (separation + alignment + cohesion)) + 1;
    bool good = true;
    for (int k = 0; k < 3; k++) {
        float **arrays[] = {&f->x[k], &f->v[k], &f->u[k], &f->to_x[k], &f->to_v[k]};
        for (int a = 0; a < 5; a++) good &= (*arrays[a] = numbers(count)) != NULL;
    }
    f->start = malloc((f->cells * f->cells * f->cells + 2) * sizeof(int));
    f->cell = malloc(count * sizeof(int));
    f->id = malloc(count * sizeof(int));
    f->to_id = malloc(count * sizeof(int));
    if (!good || !f->start || !f->cell || !f->id || !f->to_id) {
        plain_flock_destroy(f);
        return NULL;
    }
    for (size_t i = 0; i < count; i++) {
        const double *x = positions + 3 * i, *v = velocities + 3 * i;
        float speed = (float)sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
        for (int k = 0; k < 3; k++) {
            f->x[k][i] = (float)x[k], f->v[k][i] = (float)v[k];
            f->u[k][i] = speed > 0 ? (float)v[k] / speed : 0;
        }
        f->id[i] = (int)i;
    }
    return f;
}

void plain_flock_destroy(plain_flock *f) {
    if (!f) return;
    for (int k = 0; k < 3; k++) free(f->x[k]), free(f->v[k]), free(f->u[k]), free(f->to_x[k]), free(f->to_v[k]);
    free(f->start), free(f->cell), free(f->id), free(f->to_id);
    free(f);
}

/* cos(2 pi (t + 0.5)) by t^2. */
static inline float cosine(float s) {
    return -1.f + s * (19.7392088f +
                       s * (-64.939394f + s * (85.4568172f + s * (-60.2446414f + s * (26.4262568f + s * -7.9035364f)))));
}

/* Adds to `sum` what bird i gets from the candidates [begin, end). */
static inline void add_range(const plain_flock *f, size_t i, int begin, int end, float sum[3]) {
    const float *x = f->x[0], *y = f->x[1], *z = f->x[2], *ux = f->u[0], *uy = f->u[1], *uz = f->u[2];
    float px = x[i], py = y[i], pz = z[i], reach = f->size, per = 1 / reach;
    float away = f->separation * per, along = (f->separation + f->alignment) * per;
    float per_along = 1 / (along - away), per_towards = 1 / (1 - along);
    float sx = 0, sy = 0, sz = 0;
#pragma omp simd reduction(+ : sx, sy, sz)
    for (int j = begin; j < end; j++) {
        float dx = x[j] - px, dy = y[j] - py, dz = z[j] - pz, square = dx * dx + dy * dy + dz * dz;
        float inside = square < reach * reach ? 1.f : 0.f, distance = sqrtf(square < 1e-8f ? 1e-8f : square);
        float relative_distance = distance * per, inverse = 1 / distance;
        float a = relative_distance < along ? (relative_distance - away) * per_along
                                            : (relative_distance - along) * per_towards;
        float c = 0.5f * cosine((a - 0.5f) * (a - 0.5f));
        float towards = relative_distance < away ? 1 - away / relative_distance : relative_distance < along ? 0.f : c;
        float with = relative_distance < away ? 0.f : relative_distance < along ? 1 - c : 0.f;
        towards *= inside * inverse, with *= inside;
        sx += towards * dx + with * ux[j], sy += towards * dy + with * uy[j], sz += towards * dz + with * uz[j];
    }
    sum[0] += sx, sum[1] += sy, sum[2] += sz;
}

/* Takes bird i on by what it got. */
static inline void move(plain_flock *f, size_t i, const float sum[3]) {
    for (int k = 0; k < 3; k++) {
        f->to_v[k][i] = f->v[k][i] + f->dt * sum[k];
        f->to_x[k][i] = f->x[k][i] + f->dt * f->to_v[k][i];
    }
}

static int cell_along(const plain_flock *f, float x) {
    int c = (int)((x - f->low) / f->size);
    return c < 0 ? 0 : c >= (int)f->cells ? (int)f->cells - 1 : c;
}

/* What the step has written goes back in the order of cells, with directions. */
static void sort_cells(plain_flock *f) {
    size_t n = f->cells, count = n * n * n;
    memset(f->start, 0, (count + 2) * sizeof *f->start);
    for (size_t i = 0; i < f->count; i++) {
        f->cell[i] = (int)(((size_t)cell_along(f, f->to_x[2][i]) * n + (size_t)cell_along(f, f->to_x[1][i])) * n) +
                     cell_along(f, f->to_x[0][i]);
        f->start[f->cell[i] + 2]++;
    }
    for (size_t c = 2; c < count + 2; c++) f->start[c] += f->start[c - 1];
    memcpy(f->to_id, f->id, f->count * sizeof *f->id);
    for (size_t i = 0; i < f->count; i++) {
        int to = f->start[f->cell[i] + 1]++;
        float square = 0;
        for (int k = 0; k < 3; k++) square += f->to_v[k][i] * f->to_v[k][i];
        float per = square > 0 ? 1 / sqrtf(square) : 0;
        for (int k = 0; k < 3; k++) {
            f->x[k][to] = f->to_x[k][i], f->v[k][to] = f->to_v[k][i];
            f->u[k][to] = per * f->to_v[k][i];
        }
        f->id[to] = f->to_id[i];
    }
}

void plain_flock_grid(void *data) {
    plain_flock *f = data;
    int n = (int)f->cells;
    for (int k = 0; k < 3; k++) {
        memcpy(f->to_x[k], f->x[k], f->count * sizeof(float));
        memcpy(f->to_v[k], f->v[k], f->count * sizeof(float));
    }
    sort_cells(f);
    for (size_t i = 0; i < f->count; i++) {
        int cx = cell_along(f, f->x[0][i]), cy = cell_along(f, f->x[1][i]), cz = cell_along(f, f->x[2][i]);
        float sum[3] = {0, 0, 0};
        for (int z = cz > 0 ? cz - 1 : 0; z <= cz + 1 && z < n; z++)
            for (int y = cy > 0 ? cy - 1 : 0; y <= cy + 1 && y < n; y++) {
                const int *line = f->start + ((size_t)z * (size_t)n + (size_t)y) * (size_t)n;
                add_range(f, i, line[cx > 0 ? cx - 1 : 0], line[cx + 1 < n ? cx + 2 : cx + 1], sum);
            }
        move(f, i, sum);
    }
}

void plain_flock_all_pairs(void *data) {
    plain_flock *f = data;
    for (size_t i = 0; i < f->count; i++) {
        float sum[3] = {0, 0, 0};
        add_range(f, i, 0, (int)f->count, sum);
        move(f, i, sum);
    }
}
