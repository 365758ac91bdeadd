/* Geometry on the card; see meshes.h. */
#include "render/meshes.h"

#include "render/fail.h"
#include "render/linear.h"

#include <epoxy/gl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Along a quarter of a solid's round edges. */
enum { fine_steps = 6, coarse_steps = 2 };

static const double pi = 3.141592653589793;

/* ---- Surfaces that move --------------------------------------------------------------------- */

double render_surface_normals(const render_surface *surface, float *normals) {
    double area = 0;
    const double *x = surface->positions;
    const uint32_t *weld = surface->weld;
    memset(normals, 0, 3 * surface->vertex_count * sizeof *normals);

    // the cross product of two sides is the unit normal times twice the area
    for (size_t t = 0; t < surface->triangle_count; t++) {
        const uint32_t *corner = &surface->triangles[3 * t];
        const double *a = &x[3 * corner[0]], *b = &x[3 * corner[1]], *c = &x[3 * corner[2]];
        double u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
        float n[3] = {(float)(u[1] * v[2] - u[2] * v[1]), (float)(u[2] * v[0] - u[0] * v[2]),
                      (float)(u[0] * v[1] - u[1] * v[0])};
        area += 0.5 * sqrt((double)n[0] * n[0] + (double)n[1] * n[1] + (double)n[2] * n[2]);
        for (int k = 0; k < 3; k++) {
            float *sum = &normals[3 * (weld ? weld[corner[k]] : corner[k])];
            sum[0] += n[0], sum[1] += n[1], sum[2] += n[2];
        }
    }

    for (size_t i = 0; i < surface->vertex_count; i++) {
        float *n = &normals[3 * i];
        double length = sqrt((double)n[0] * n[0] + (double)n[1] * n[1] + (double)n[2] * n[2]);
        float scale = length > 0 && isfinite(length) ? (float)(1.0 / length) : 0.0f;
        for (int k = 0; k < 3; k++) n[k] = scale > 0 ? n[k] * scale : 0.0f;
    }

    // copies at the same place (along a seam) take their owner's
    for (size_t i = 0; weld && i < surface->vertex_count; i++) {
        if (weld[i] != i) memcpy(&normals[3 * i], &normals[3 * weld[i]], 3 * sizeof *normals);
    }
    return area;
}

static GLuint make_buffer(size_t size, const void *data, GLbitfield flags) {
    GLuint buffer = 0;
    glCreateBuffers(1, &buffer);
    glNamedBufferStorage(buffer, (GLsizeiptr)(size ? size : 4), size ? data : NULL, flags);
    return buffer;
}

/* Makes attribute `location` of a vertex array read `parts` floats from its own buffer. */
static void attach(GLuint arrays, GLuint location, GLuint buffer, GLint parts) {
    glVertexArrayVertexBuffer(arrays, location, buffer, 0, (GLsizei)((size_t)parts * sizeof(float)));
    glVertexArrayAttribFormat(arrays, location, parts, GL_FLOAT, GL_FALSE, 0);
    glVertexArrayAttribBinding(arrays, location, location);
    glEnableVertexArrayAttrib(arrays, location);
}

void render_mesh_destroy(render_mesh *mesh) {
    const GLuint buffers[5] = {mesh->positions, mesh->normals, mesh->uv, mesh->values, mesh->triangles};
    glDeleteBuffers(5, buffers);
    glDeleteVertexArrays(1, &mesh->arrays);
    free(mesh->staged);
    memset(mesh, 0, sizeof *mesh);
}

/* All that stays while a surface moves. */
static skein_status rebuild(render_mesh *mesh, const render_surface *surface, skein_error *error) {
    size_t vertices = surface->vertex_count * 3 * sizeof(float);
    render_mesh_destroy(mesh);
    mesh->staged = malloc(2 * vertices + 1);
    if (!mesh->staged) return render_fail_memory(error, "a surface");

    mesh->vertex_count = surface->vertex_count;
    mesh->triangle_count = surface->triangle_count;
    mesh->shape = surface->shape;
    mesh->positions = make_buffer(vertices, NULL, GL_DYNAMIC_STORAGE_BIT);
    mesh->normals = make_buffer(vertices, NULL, GL_DYNAMIC_STORAGE_BIT);
    mesh->triangles = make_buffer(surface->triangle_count * 3 * sizeof(uint32_t), surface->triangles, 0);
    glCreateVertexArrays(1, &mesh->arrays);
    attach(mesh->arrays, 0, mesh->positions, 3);
    attach(mesh->arrays, 1, mesh->normals, 3);
    if (surface->uv) {
        mesh->uv = make_buffer(surface->vertex_count * 2 * sizeof(float), surface->uv, 0);
        attach(mesh->arrays, 2, mesh->uv, 2);
    }
    if (surface->values) {
        mesh->values = make_buffer(surface->vertex_count * sizeof(float), NULL, GL_DYNAMIC_STORAGE_BIT);
        attach(mesh->arrays, 3, mesh->values, 1);
    }
    glVertexArrayElementBuffer(mesh->arrays, mesh->triangles);
    return SKEIN_OK;
}

skein_status render_mesh_update(render_mesh *mesh, const render_surface *surface, skein_error *error) {
    bool same = mesh->arrays && surface->shape != 0 && mesh->shape == surface->shape &&
                mesh->vertex_count == surface->vertex_count && mesh->triangle_count == surface->triangle_count &&
                (mesh->uv != 0) == (surface->uv != NULL) && (mesh->values != 0) == (surface->values != NULL);
    if (!same) {
        skein_status status = rebuild(mesh, surface, error);
        if (status != SKEIN_OK) return status;
    }
    if (mesh->vertex_count == 0) return SKEIN_OK;

    size_t numbers = 3 * mesh->vertex_count;
    float *positions = mesh->staged, *normals = mesh->staged + numbers;
    double sum[3] = {0, 0, 0}, squares[3] = {0, 0, 0}, count = (double)mesh->vertex_count;
    for (size_t i = 0; i < numbers; i++) {
        double off = surface->positions[i] - mesh->middle[i % 3]; // from where it was: sums of small numbers are exact
        positions[i] = (float)surface->positions[i];
        sum[i % 3] += off;
        squares[i % 3] += off * off;
    }
    for (int k = 0; k < 3; k++) { // of a ball's surface, the mean square along an axis is a third of its radius's
        mesh->middle[k] += sum[k] / count;
        mesh->spread[k] = sqrt(fmax(3 * (squares[k] - sum[k] * sum[k] / count) / count, 0));
    }
    // a triangle of two equal short sides at a right angle, as in a grid
    double area = render_surface_normals(surface, normals);
    mesh->edge = sqrt(2 * area / (double)(mesh->triangle_count ? mesh->triangle_count : 1));
    glNamedBufferSubData(mesh->positions, 0, (GLsizeiptr)(numbers * sizeof(float)), positions);
    glNamedBufferSubData(mesh->normals, 0, (GLsizeiptr)(numbers * sizeof(float)), normals);
    if (surface->values) {
        glNamedBufferSubData(mesh->values, 0, (GLsizeiptr)(mesh->vertex_count * sizeof(float)), surface->values);
    }
    return SKEIN_OK;
}

double render_mesh_edge_pixels(const render_mesh *mesh, const render_camera *camera, int height) {
    double away[3];
    for (int k = 0; k < 3; k++) away[k] = mesh->middle[k] - camera->eye[k];
    double distance = fmax(sqrt(render_dot(away, away)), camera->near);
    return mesh->edge * height / (2 * tan(0.5 * camera->fov * pi / 180) * distance);
}

/* ---- Fixed shapes --------------------------------------------------------------------------- */

/* A grid of rings x sectors quads over vertices that `place` computes; `parts` floats each. */
static skein_status make_shape(render_shape *shape, int rings, int sectors, int parts,
                               void (*place)(double along, double around, float *out), skein_error *error) {
    size_t vertex_count = (size_t)(rings + 1) * (size_t)(sectors + 1);
    size_t index_count = (size_t)rings * (size_t)sectors * 6, i = 0;
    float *vertices = malloc(vertex_count * (size_t)parts * sizeof *vertices);
    uint16_t *indices = malloc(index_count * sizeof *indices);
    if (!vertices || !indices) {
        free(vertices);
        free(indices);
        return render_fail_memory(error, "the fixed shapes");
    }
    for (int r = 0; r <= rings; r++) {
        for (int s = 0; s <= sectors; s++) {
            int v = r * (sectors + 1) + s;
            place((double)r / rings, (double)s / sectors, &vertices[v * parts]);
            if (r == rings || s == sectors) continue;
            const int corners[6] = {v, v + sectors + 1, v + 1, v + 1, v + sectors + 1, v + sectors + 2};
            for (int k = 0; k < 6; k++) indices[i++] = (uint16_t)corners[k];
        }
    }
    shape->index_count = (int)index_count;
    shape->vertices = make_buffer(vertex_count * (size_t)parts * sizeof *vertices, vertices, 0);
    shape->indices = make_buffer(index_count * sizeof *indices, indices, 0);
    glCreateVertexArrays(1, &shape->arrays);
    attach(shape->arrays, 0, shape->vertices, parts);
    glVertexArrayElementBuffer(shape->arrays, shape->indices);
    free(vertices);
    free(indices);
    return SKEIN_OK;
}

static void place_sphere(double along, double around, float *out) {
    out[0] = (float)(sin(pi * along) * cos(2 * pi * around));
    out[1] = (float)cos(pi * along);
    out[2] = (float)(-sin(pi * along) * sin(2 * pi * around));
}

/* A sphere that is cut into its eight octants, which go apart to the corners of a box. Rows from the middle of the top:
 * there, the top's rim, down to the equator, the equator again, down to the rim of the bottom, its middle. */
static void place_solid(int steps, double along, double around, float *out) {
    int row = (int)lround(along * (2 * steps + 3)), column = (int)lround(around * 4 * (steps + 1));
    int quarter = column / (steps + 1) % 4, lower = row > steps + 1;
    double turn = 0.5 * pi * (quarter + (double)(column % (steps + 1)) / steps);
    double tilt = 0.5 * pi * fmin(fmax((double)(row - 1 - lower) / steps, 0), 2);
    bool middle = row == 0 || row == 2 * steps + 3;
    const double corner[3] = {middle                         ? 0
                              : quarter == 0 || quarter == 3 ? 1
                                                             : -1,
                              lower ? -1 : 1,
                              middle        ? 0
                              : quarter < 2 ? -1
                                            : 1};
    const double direction[3] = {sin(tilt) * cos(turn), cos(tilt), -sin(tilt) * sin(turn)};
    for (int k = 0; k < 3; k++) out[k] = (float)(4 * corner[k] + direction[k]);
}

static void place_fine_solid(double along, double around, float *out) {
    place_solid(fine_steps, along, around, out);
}

static void place_coarse_solid(double along, double around, float *out) {
    place_solid(coarse_steps, along, around, out);
}

/* From the rim down. */
static void place_bowl(double along, double around, float *out) {
    double rim = acos(render_bowl_height - 1);
    place_sphere((rim + (pi - rim) * along) / pi, around, out);
}

static void place_dome(double along, double around, float *out) {
    out[0] = (float)(sin(0.5 * pi * along) * cos(2 * pi * around));
    out[1] = (float)(sin(0.5 * pi * along) * sin(2 * pi * around));
    out[2] = (float)cos(0.5 * pi * along);
}

static void place_disc(double along, double around, float *out) {
    out[0] = (float)(along * cos(2 * pi * around));
    out[1] = (float)(-along * sin(2 * pi * around));
}

static void place_square(double along, double around, float *out) {
    out[0] = (float)(2 * around - 1);
    out[1] = (float)(1 - 2 * along);
}

skein_status render_shape_sphere(render_shape *shape, int rings, skein_error *error) {
    return make_shape(shape, rings, 2 * rings, 3, place_sphere, error);
}

skein_status render_shape_solid(render_shape *shape, bool fine, skein_error *error) {
    int steps = fine ? fine_steps : coarse_steps;
    return make_shape(shape, 2 * steps + 3, 4 * (steps + 1), 3, fine ? place_fine_solid : place_coarse_solid, error);
}

skein_status render_shape_bowl(render_shape *shape, skein_error *error) {
    return make_shape(shape, 16, 64, 3, place_bowl, error);
}

skein_status render_shape_dome(render_shape *shape, skein_error *error) {
    return make_shape(shape, 1, 8, 3, place_dome, error);
}

skein_status render_shape_disc(render_shape *shape, skein_error *error) {
    return make_shape(shape, 1, 8, 2, place_disc, error);
}

skein_status render_shape_square(render_shape *shape, skein_error *error) {
    return make_shape(shape, 1, 1, 2, place_square, error);
}

void render_shape_destroy(render_shape *shape) {
    const GLuint buffers[2] = {shape->vertices, shape->indices};
    glDeleteBuffers(2, buffers);
    glDeleteVertexArrays(1, &shape->arrays);
    memset(shape, 0, sizeof *shape);
}
