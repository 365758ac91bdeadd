/* A mesh by itself becomes a scene: it falls on a ball that is as large as suits it, over a ground below.
 *
 * Faces are a cloth, tetrahedra a soft body. Called by io_scene_read() for a path with a mesh's ending. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

#include "io/mesh.h"
#include "io/scene_settings.h"

static const char *ending_of(const char *path) {
    const char *dot = strrchr(path, '.');
    return dot && !strchr(dot, '/') ? dot : "";
}

static bool is_tetrahedra(const char *path) {
    return !strcasecmp(ending_of(path), ".node");
}

/* The corners of the box around it. */
static void bound(const io_mesh *mesh, double least[3], double most[3]) {
    for (int k = 0; k < 3; k++) least[k] = INFINITY, most[k] = -INFINITY;
    for (size_t v = 0; v < mesh->vertex_count; v++)
        for (int k = 0; k < 3; k++) {
            least[k] = fmin(least[k], mesh->positions[3 * v + (size_t)k]);
            most[k] = fmax(most[k], mesh->positions[3 * v + (size_t)k]);
        }
}

/* The scene's text; NULL when there is no memory. */
static char *make_text(const char *path, const io_mesh *mesh) {
    double least[3], most[3], side = 0;
    bound(mesh, least, most);
    for (int k = 0; k < 3; k++) side = fmax(side, most[k] - least[k]);
    if (!(side > 0 && isfinite(side))) side = 1;
    double radius = 0.22 * side, ground = least[1] - 3 * radius;
    const char *slash = strrchr(path, '/'), *file = slash ? slash + 1 : path;
    bool soft = is_tetrahedra(path);
    json_t *root = json_pack(
        "{s:i, s:s, s:s, s:i, s:{s:s, s:i}, s:[{s:s, s:s, s:s, s:f}], s:[{s:s}, {s:s, s:f}],"
        " s:[{s:s, s:s, s:f, s:f, s:f}, {s:s, s:s, s:[f, f, f], s:f, s:f, s:f}]}",
        "skein", 1, "name", file, "description", soft ? "a mesh as a soft body" : "a mesh as a cloth", "frames", 300,
        // the method, the body and the forces
        "method", "type", "xpbd", "substeps", 20, "bodies", "type", soft ? "tetrahedra" : "cloth", "name", "mesh",
        "mesh", file, "density", soft ? 1000.0 : 0.25, "forces", "type", "gravity", "type", "drag", "rate", 0.4,
        // what it falls on
        "colliders", "type", "plane", "name", "ground", "offset", ground, "thickness", 0.003 * side, "friction", 0.6,
        "type", "sphere", "name", "ball", "centre", 0.5 * (least[0] + most[0]), least[1] - 1.6 * radius,
        0.5 * (least[2] + most[2]), "radius", radius, "thickness", 0.004 * side, "friction", 0.6);
    char *text = root ? json_dumps(root, JSON_INDENT(2)) : NULL;
    json_decref(root);
    return text;
}

io_scene *io_scene_of_mesh(const char *path, const char *const *sets, const skein_kind *const *exporters,
                           io_faults *faults) {
    io_mesh mesh;
    skein_error error = {SKEIN_OK, "", ""};
    io_place place = {path, "", faults};
    if (io_mesh_read(path, &mesh, (io_warnings){NULL, NULL}, &error)) {
        place.file = error.where[0] ? error.where : path;
        io_fault(place, "", error.status, "%s", error.message);
        return NULL;
    }
    char *text = make_text(path, &mesh);
    io_mesh_free(&mesh);
    if (!text) io_fault(place, "", SKEIN_ERROR_MEMORY, "the file's name is not UTF-8, or there is no memory");
    io_scene *scene = text ? io_scene_read_text(text, strlen(text), path, sets, exporters, faults) : NULL;
    free(text);
    return scene;
}
