/* What a good student writes: particles as structs, springs as structs, one after the other, in float.
 * Built with -O3 -march=native, as the student would. */
#include <math.h>
#include <stdlib.h>

#include "bench/bench.h"

typedef struct plain_particle {
    float x[3], v[3], f[3], w;
} plain_particle;

typedef struct plain_spring {
    int a, b;
    float rest, compliance, stiffness, damping;
} plain_spring;

struct plain_cloth {
    plain_particle *particles;
    plain_spring *springs;
    size_t particle_count, spring_count;
    float per_step;
};

/* All springs of one step (dr, dc), row by row. */
static void add_direction(plain_cloth *cloth, int n, int dr, int dc, double stiffness) {
    for (int r = 0; r + dr < n; r++)
        for (int c = dc < 0 ? -dc : 0; c + (dc > 0 ? dc : 0) < n; c++) {
            float h = 1.0f / (float)(n - 1);
            cloth->springs[cloth->spring_count++] = (plain_spring){r * n + c,
                                                                   (r + dr) * n + c + dc,
                                                                   h * sqrtf((float)(dr * dr + dc * dc)),
                                                                   (float)(1 / stiffness),
                                                                   (float)stiffness,
                                                                   (float)(stiffness * 1e-4)};
        }
}

plain_cloth *plain_cloth_create(int n, double stiffness, double substep) {
    plain_cloth *cloth = calloc(1, sizeof *cloth);
    cloth->particle_count = (size_t)n * (size_t)n;
    cloth->particles = calloc(cloth->particle_count, sizeof *cloth->particles);
    cloth->springs = calloc(6 * cloth->particle_count, sizeof *cloth->springs);
    cloth->per_step = (float)(1 / (substep * substep));
    for (int r = 0; r < n; r++)
        for (int c = 0; c < n; c++) {
            plain_particle *p = &cloth->particles[r * n + c];
            p->x[0] = (float)c / (float)(n - 1);
            p->x[1] = 0.002f * (float)((c * 7 + r * 13) % 5) / (float)n;
            p->x[2] = (float)r / (float)(n - 1);
            p->w = r == 0 && (c == 0 || c == n - 1) ? 0 : (float)(n * n) / 0.2f;
        }
    static const int steps[6][2] = {{0, 1}, {0, 2}, {1, 0}, {1, 1}, {1, -1}, {2, 0}};
    for (int d = 0; d < 6; d++) add_direction(cloth, n, steps[d][0], steps[d][1], stiffness);
    return cloth;
}

void plain_cloth_destroy(plain_cloth *cloth) {
    free(cloth->particles);
    free(cloth->springs);
    free(cloth);
}

size_t plain_cloth_springs(const plain_cloth *cloth) {
    return cloth->spring_count;
}

void plain_cloth_project(void *data) {
    plain_cloth *cloth = data;
    for (size_t s = 0; s < cloth->spring_count; s++) {
        const plain_spring *spring = &cloth->springs[s];
        plain_particle *a = &cloth->particles[spring->a], *b = &cloth->particles[spring->b];
        float dx = a->x[0] - b->x[0], dy = a->x[1] - b->x[1], dz = a->x[2] - b->x[2];
        float length = sqrtf(dx * dx + dy * dy + dz * dz);
        float k = (spring->rest - length) / (length * (a->w + b->w + spring->compliance * cloth->per_step));
        a->x[0] += k * a->w * dx, a->x[1] += k * a->w * dy, a->x[2] += k * a->w * dz;
        b->x[0] -= k * b->w * dx, b->x[1] -= k * b->w * dy, b->x[2] -= k * b->w * dz;
    }
}

void plain_cloth_force(void *data) {
    plain_cloth *cloth = data;
    for (size_t s = 0; s < cloth->spring_count; s++) {
        const plain_spring *spring = &cloth->springs[s];
        plain_particle *a = &cloth->particles[spring->a], *b = &cloth->particles[spring->b];
        float dx = a->x[0] - b->x[0], dy = a->x[1] - b->x[1], dz = a->x[2] - b->x[2];
        float length = sqrtf(dx * dx + dy * dy + dz * dz), inverse = 1 / length;
        float rate = ((a->v[0] - b->v[0]) * dx + (a->v[1] - b->v[1]) * dy + (a->v[2] - b->v[2]) * dz) * inverse;
        float pull = (spring->stiffness * (length - spring->rest) + spring->damping * rate) * inverse;
        a->f[0] -= pull * dx, a->f[1] -= pull * dy, a->f[2] -= pull * dz;
        b->f[0] += pull * dx, b->f[1] += pull * dy, b->f[2] += pull * dz;
    }
}
