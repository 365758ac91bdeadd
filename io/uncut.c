/* A body's surface without the faces that are cut; see uncut.h. */
#include "io/uncut.h"

#include <stdlib.h>
#include <string.h>

#include <skein/cut.h>

/* Of each face whether it is cut; NULL where none is. */
static const uint8_t *cut_faces(const skein_world *world, skein_handle body) {
    skein_cuts cuts;
    return skein_body_cuts(world, body, &cuts) || !cuts.count ? NULL : cuts.face;
}

bool io_surface_uncut(const skein_world *world, skein_handle body, skein_surface *s, uint32_t **room) {
    const uint8_t *cut = cut_faces(world, body);
    *room = NULL;
    if (!cut) return true;
    size_t faces = 0, corners = 0;
    uint32_t *sizes = malloc((s->face_count + 3 * s->face_vertex_count) * sizeof *sizes);
    if (!(*room = sizes)) return false;
    uint32_t *vertices = sizes + s->face_count;
    float *uv = (float *)(void *)(vertices + s->face_vertex_count);
    for (size_t f = 0, c = 0; f < s->face_count; c += s->face_sizes[f++]) {
        if (cut[f]) continue;
        sizes[faces++] = s->face_sizes[f];
        for (size_t k = c; k < c + s->face_sizes[f]; k++, corners++) {
            vertices[corners] = s->face_vertices[k];
            if (s->corner_uv) memcpy(uv + 2 * corners, s->corner_uv + 2 * k, 2 * sizeof *uv);
        }
    }
    s->face_sizes = sizes, s->face_vertices = vertices;
    if (s->corner_uv) s->corner_uv = uv;
    s->face_count = faces, s->face_vertex_count = corners;
    return true;
}

void io_mesh_uncut(io_mesh *read, const skein_world *world, skein_handle body) {
    const uint8_t *cut = cut_faces(world, body);
    size_t faces = 0, corners = 0, mark = 0;
    for (size_t f = 0, c = 0; cut && f < read->face_count; f++) {
        uint32_t size = read->face_sizes[f];
        // what is said of the faces from a cut one on is said of those that follow it
        for (; mark < read->mark_count && read->marks[mark].face <= f; mark++) read->marks[mark].face = faces;
        if (!cut[f]) {
            read->face_sizes[faces++] = size;
            memmove(read->face_vertices + corners, read->face_vertices + c, size * sizeof *read->face_vertices);
            memmove(read->face_uvs + corners, read->face_uvs + c, size * sizeof *read->face_uvs);
            corners += size;
        }
        c += size;
    }
    if (cut) read->face_count = faces, read->face_vertex_count = corners;
}
