/* Unit vertex normals of polygon meshes: see space/normals.h and skein.h for the contract.
 *
 *         next            A face's normal is Newell's: the sum of the cross products around it, taken
 *        /                from its first corner so that a mesh far from the origin loses nothing. Its
 *   corner --- ...        length is twice the area, for concave and slightly bent polygons as well.
 *        \                The angle at a corner runs from the edge to `next` to the edge to `previous`;
 *         previous        where they turn against the face's normal the corner is a reflex one.
 *
 * The three ways: Gouraud 1971 (uniform), Thuermer and Wuethrich 1998 (angle), Max 1999 (area and more).
 */
#include "space/normals.h"

#include <assert.h>
#include <math.h>
#include <string.h>

#include "base/status.h"

static const double *corner_position(const skein_mesh *mesh, const uint32_t *face, uint32_t corner) {
    assert(face[corner] < mesh->vertex_count);
    return mesh->positions + 3 * (size_t)face[corner];
}

static void subtract(double out[3], const double a[3], const double b[3]) {
    for (int k = 0; k < 3; k++) out[k] = a[k] - b[k];
}

static void cross(double out[3], const double a[3], const double b[3]) {
    out[0] = a[1] * b[2] - a[2] * b[1];
    out[1] = a[2] * b[0] - a[0] * b[2];
    out[2] = a[0] * b[1] - a[1] * b[0];
}

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* Divides by the largest component first: nothing overflows, and a vector along an axis stays exact. */
static bool normalise(double v[3]) {
    double largest = fmax(fabs(v[0]), fmax(fabs(v[1]), fabs(v[2])));
    if (!(largest > 0) || !isfinite(largest)) return false;
    for (int k = 0; k < 3; k++) v[k] /= largest;
    double length = sqrt(dot(v, v));
    for (int k = 0; k < 3; k++) v[k] = v[k] / length + 0.0; // turns -0 into 0
    return true;
}

/* Newell's normal, twice the area long. False where the face has no area beyond rounding. */
static bool face_normal(const skein_mesh *mesh, const uint32_t *face, uint32_t size, double out[3]) {
    const double *origin = corner_position(mesh, face, 0);
    double a[3], b[3], product[3], squares = 0;
    memset(out, 0, 3 * sizeof *out);
    subtract(a, corner_position(mesh, face, 1), origin);
    for (uint32_t corner = 2; corner < size; corner++) {
        subtract(b, corner_position(mesh, face, corner), origin);
        cross(product, a, b);
        for (int k = 0; k < 3; k++) out[k] += product[k];
        squares += dot(a, a) + dot(b, b);
        memcpy(a, b, sizeof a);
    }
    return sqrt(dot(out, out)) > 1e-10 * squares;
}

/* The angle at a corner, 0 to 2 pi. `unit` is the face's unit normal. */
static double corner_angle(const skein_mesh *mesh, const uint32_t *face, uint32_t size, uint32_t corner,
                           const double unit[3]) {
    const double *here = corner_position(mesh, face, corner);
    double next[3], previous[3], product[3];
    subtract(next, corner_position(mesh, face, corner + 1 < size ? corner + 1 : 0), here);
    subtract(previous, corner_position(mesh, face, corner > 0 ? corner - 1 : size - 1), here);
    cross(product, next, previous);
    double angle = atan2(sqrt(dot(product, product)), dot(next, previous));
    return dot(product, unit) < 0 ? 2 * 3.14159265358979323846 - angle : angle;
}

void sk_mesh_normals(const skein_mesh *mesh, skein_normals weighting, double *out) {
    memset(out, 0, 3 * mesh->vertex_count * sizeof *out);
    const uint32_t *face = mesh->face_vertices;
    for (size_t f = 0; f < mesh->face_count; face += mesh->face_sizes[f++]) {
        uint32_t size = mesh->face_sizes[f];
        double normal[3];
        assert(size >= 3);
        if (!face_normal(mesh, face, size, normal) || (weighting != SKEIN_NORMALS_AREA && !normalise(normal))) continue;
        for (uint32_t corner = 0; corner < size; corner++) {
            double weight = weighting == SKEIN_NORMALS_ANGLE ? corner_angle(mesh, face, size, corner, normal) : 1;
            for (int k = 0; k < 3; k++) out[3 * (size_t)face[corner] + (size_t)k] += weight * normal[k];
        }
    }
    for (size_t v = 0; v < mesh->vertex_count; v++) {
        double *normal = out + 3 * v;
        if (!normalise(normal)) {
            normal[0] = normal[2] = 0;
            normal[1] = 1;
        }
    }
}

skein_status sk_mesh_check_pointers(const skein_mesh *mesh, skein_error *error) {
    if (mesh->vertex_count && !mesh->positions) return sk_fail_null(error, "mesh->positions");
    if (mesh->face_count && !mesh->face_sizes) return sk_fail_null(error, "mesh->face_sizes");
    if (mesh->face_vertex_count && !mesh->face_vertices) return sk_fail_null(error, "mesh->face_vertices");
    return SKEIN_OK;
}

skein_status skein_mesh_normals(const skein_mesh *mesh, skein_normals weighting, double *out, skein_error *error) {
    if (!mesh) return sk_fail_null(error, "mesh");
    if (mesh->vertex_count && !out) return sk_fail_null(error, "out");
    if (weighting > SKEIN_NORMALS_ANGLE)
        return sk_fail(error, SKEIN_ERROR_VALUE, "weighting", "%d: expected an area, uniform or angle weighting",
                       (int)weighting);
    skein_status status = sk_mesh_check_pointers(mesh, error);
    if (status) return status;
    size_t corner = 0;
    for (size_t f = 0; f < mesh->face_count; f++) {
        uint32_t size = mesh->face_sizes[f];
        if (size < 3 || size > mesh->face_vertex_count - corner)
            return sk_fail(error, SKEIN_ERROR_MESH, "", "face %zu has %u corners: expected 3 or more, of the %zu left",
                           f, size, mesh->face_vertex_count - corner);
        for (uint32_t i = 0; i < size; i++, corner++)
            if (mesh->face_vertices[corner] >= mesh->vertex_count)
                return sk_fail(error, SKEIN_ERROR_MESH, "", "face %zu names vertex %u: the mesh has %zu", f,
                               mesh->face_vertices[corner], mesh->vertex_count);
    }
    sk_mesh_normals(mesh, weighting, out);
    return SKEIN_OK;
}
