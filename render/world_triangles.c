/* Colliders that are drawn by their own triangles; see world_triangles.h. */
#include "render/world_triangles.h"

#include <stdlib.h>
#include <string.h>

/* Texture coordinates are metres along x and z, as the mesh first lay: for terrain, whose squares go with it. */
static bool make(render_world_triangles *t, const skein_triangles *from) {
    size_t corners = 3 * from->count;
    uint32_t *sizes = malloc(from->count * sizeof *sizes + 1), *self = malloc(from->vertex_count * sizeof *self + 1);
    float *uv = malloc(2 * corners * sizeof *uv + 1);
    bool good = sizes && self && uv;
    for (size_t i = 0; i < from->count && good; i++) sizes[i] = 3;
    for (size_t v = 0; v < from->vertex_count && good; v++) self[v] = (uint32_t)v;
    for (size_t c = 0; c < corners && good; c++) {
        const double *place = &t->places[3 * (size_t)from->vertices[c]];
        uv[2 * c] = (float)place[0], uv[2 * c + 1] = (float)place[2];
    }
    skein_surface surface = {.particle_count = (uint32_t)from->vertex_count,
                             .particle_of_vertex = self,
                             .vertex_count = from->vertex_count,
                             .face_sizes = sizes,
                             .face_count = from->count,
                             .face_vertices = from->vertices,
                             .face_vertex_count = corners,
                             .corner_uv = uv};
    good = good && render_body_mesh_make(&t->mesh, &surface, t->places, false);
    free(sizes);
    free(self);
    free(uv);
    return good && (t->positions = malloc(3 * t->mesh.vertex_count * sizeof *t->positions + 1)) != NULL;
}

bool render_take_triangles(render_world_triangles *t, const skein_world *world, skein_handle collider, bool *any) {
    skein_triangles from;
    *any = skein_collider_triangles(world, collider, &from) == SKEIN_OK && from.count > 0;
    if (!*any) return true;
    if (!t->places && !(t->places = malloc(3 * from.vertex_count * sizeof *t->places))) return false;
    if (skein_collider_vertices_copy(world, collider, skein_doubles(t->places, 0)) != SKEIN_OK) return false;
    t->made = t->made || make(t, &from);
    if (!t->made) return false;
    t->box = render_bounds_nothing();
    for (size_t v = 0; v < t->mesh.vertex_count; v++) {
        const double *place = &t->places[3 * (size_t)t->mesh.particles[v]];
        memcpy(&t->positions[3 * v], place, 3 * sizeof *place);
        render_bounds_add(&t->box, place, 0);
    }
    return true;
}

void render_show_triangles(const render_world_triangles *t, render_surface *surface) {
    *surface = (render_surface){.positions = t->positions,
                                .vertex_count = t->mesh.vertex_count,
                                .triangles = t->mesh.triangles,
                                .triangle_count = t->mesh.triangle_count,
                                .weld = t->mesh.weld,
                                .uv = t->mesh.uv,
                                .shape = t->mesh.shape};
}

void render_triangles_release(render_world_triangles *t) {
    render_body_mesh_release(&t->mesh);
    free(t->places);
    free(t->positions);
    memset(t, 0, sizeof *t);
}
