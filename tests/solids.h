/* Solids of triangles and quads, for tests of what is made from meshes; each is released with free(). */
#ifndef SKEIN_TESTS_SOLIDS_H
#define SKEIN_TESTS_SOLIDS_H

#include "helpers.h"

typedef struct solid {
    double position[30000][3];
    uint32_t size[30000], corner[120000];
    skein_mesh mesh;
} solid;

static inline void close_mesh(solid *s, size_t vertices, size_t faces, size_t corners) {
    s->mesh = (skein_mesh){&s->position[0][0], vertices, s->size, faces, s->corner, corners};
}

/* A box about the origin, of six quads. */
static inline solid *make_box(double x, double y, double z) {
    static const uint32_t quads[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                         {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    solid *s = calloc(1, sizeof *s);
    for (int v = 0; v < 8; v++)
        s->position[v][0] = (v & 1 ? x : -x) / 2, s->position[v][1] = (v & 2 ? y : -y) / 2,
        s->position[v][2] = (v & 4 ? z : -z) / 2;
    for (int f = 0; f < 6; f++) s->size[f] = 4;
    memcpy(s->corner, quads, sizeof quads);
    close_mesh(s, 8, 6, 24);
    return s;
}

/* A ball with bumps of height `bumps`, of triangles and, at the poles, too. */
static inline solid *make_ball(double radius, double bumps, int rings) {
    solid *s = calloc(1, sizeof *s);
    size_t vertices = 0, faces = 0, around = 2 * (size_t)rings;
    for (int i = 1; i < rings; i++)
        for (size_t j = 0; j < around; j++, vertices++) {
            double a = PI * i / rings, b = 2 * PI * (double)j / (double)around,
                   r = radius + bumps * sin(5 * a) * cos(4 * b);
            s->position[vertices][0] = r * sin(a) * cos(b), s->position[vertices][1] = r * cos(a),
            s->position[vertices][2] = r * sin(a) * sin(b);
        }
    uint32_t top = (uint32_t)vertices++, bottom = (uint32_t)vertices++;
    s->position[top][1] = radius, s->position[bottom][1] = -radius;
    uint32_t *corner = s->corner;
    for (size_t i = 0; i < (size_t)rings; i++)
        for (size_t j = 0; j < around; j++) {
            uint32_t k = (uint32_t)((j + 1) % around), above = (uint32_t)((i - 1) * around),
                     below = (uint32_t)(i * around);
            const uint32_t quad[4] = {above + (uint32_t)j, above + k, below + k, below + (uint32_t)j};
            s->size[faces++] = i == 0 || i + 1 == (size_t)rings ? 3 : 4;
            if (i == 0) *corner++ = top, *corner++ = quad[2], *corner++ = quad[3];
            else if (i + 1 == (size_t)rings) *corner++ = quad[0], *corner++ = quad[1], *corner++ = bottom;
            else
                for (int c = 0; c < 4; c++) *corner++ = quad[c];
        }
    close_mesh(s, vertices, faces, (size_t)(corner - s->corner));
    return s;
}

/* A level square sheet of side `size`, its faces up. */
static inline solid *make_sheet(double size) {
    solid *s = calloc(1, sizeof *s);
    static const uint32_t corners[] = {0, 2, 3, 1};
    for (int v = 0; v < 4; v++)
        s->position[v][0] = (v & 1 ? size : -size) / 2, s->position[v][2] = (v & 2 ? size : -size) / 2;
    s->size[0] = 4;
    memcpy(s->corner, corners, sizeof corners);
    close_mesh(s, 4, 1, 4);
    return s;
}

#endif
