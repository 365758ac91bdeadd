/* A frame from a world; see world_frame.h. */
#include "render/world_frame.h"

#include "render/fail.h"
#include "render/planes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What is kept for a body, by its place among the world's bodies. */
typedef struct body {
    skein_handle handle;
    uint64_t shape; /* a hash of all that stays */
    size_t vertex_count, triangle_count;
    uint32_t *triangles, *weld;
    float *uv, repeats[2];
    double *positions;
} body;

/* Positions of particles that are drawn as such. */
typedef struct particles {
    double *positions;
    size_t count;
} particles;

/* How a particle is shown: by itself, as part of a surface, or not at all. */
enum { LOOSE, IN_SURFACE, HIDDEN };

struct render_world_frame {
    render_frame frame;
    render_view view; /* of the last update; its texts are not ours */
    body *bodies;
    size_t body_count;
    render_surface *surfaces;
    render_plane *planes;
    render_sphere *spheres;
    render_points points[2]; /* loose particles, pins */
    particles loose, pins;
    unsigned char *shown; /* by particle: how */
    double *all;          /* every particle's position, in the user's order */
    size_t particle_count;
    bool has_floor;
    double floor_height;
};

/* The pattern repeats so often along a grid's longer side. */
static const double weave_repeats = 20;
/* Radii of particles and pins, in radii of the scene. */
static const double loose_size = 0.014, pin_size = 0.010;
/* The ground is near when it is no farther below things than this part of their height. */
static const double floor_gap = 0.25;

render_world_frame *render_world_frame_create(skein_error *error) {
    render_world_frame *made = calloc(1, sizeof *made);
    if (!made) {
        render_fail_memory(error, "a frame");
        return NULL;
    }
    made->frame = render_default_frame();
    return made;
}

static void release_body(body *b) {
    free(b->triangles);
    free(b->weld);
    free(b->uv);
    free(b->positions);
    memset(b, 0, sizeof *b);
}

void render_world_frame_destroy(render_world_frame *made) {
    if (!made) return;
    for (size_t i = 0; i < made->body_count; i++) release_body(&made->bodies[i]);
    free(made->bodies);
    free(made->surfaces);
    free(made->planes);
    free(made->spheres);
    free(made->loose.positions);
    free(made->pins.positions);
    free(made->shown);
    free(made->all);
    free(made);
}

const render_frame *render_world_frame_get(const render_world_frame *made) {
    return &made->frame;
}

/* Grows an array of `count` items; false where there is no memory. */
static bool grow(void *array, size_t count, size_t size) {
    void **pointer = array;
    void *grown = realloc(*pointer, count * size + 1);
    if (grown) *pointer = grown;
    return grown != NULL;
}

static bool is_visible(const skein_world *world, skein_handle handle) {
    skein_value value;
    return skein_get(world, handle, "visible", &value) != SKEIN_OK || value.number[0] != 0;
}

/* ---- Bodies --------------------------------------------------------------------------------- */

/* Every polygon as a fan about its first corner. */
static void make_triangles(body *b, const skein_surface *surface) {
    const uint32_t *corner = surface->face_vertices;
    uint32_t *out = b->triangles;
    for (size_t f = 0; f < surface->face_count; f++) {
        for (uint32_t k = 2; k < surface->face_sizes[f]; k++) {
            *out++ = corner[0], *out++ = corner[k - 1], *out++ = corner[k];
        }
        corner += surface->face_sizes[f];
    }
}

/* Vertices of one particle share a normal: each points to the first of them. */
static bool make_weld(body *b, const skein_surface *surface, size_t particle_count) {
    uint32_t *first = malloc(particle_count * sizeof *first + 1);
    b->weld = malloc(b->vertex_count * sizeof *b->weld + 1);
    if (!first || !b->weld) {
        free(first);
        return false;
    }
    memset(first, 0xff, particle_count * sizeof *first);
    for (size_t v = 0; v < b->vertex_count; v++) {
        uint32_t *place = &first[surface->particle_of_vertex[v]];
        if (*place == UINT32_MAX) *place = (uint32_t)v;
        b->weld[v] = *place;
    }
    free(first);
    return true;
}

/* How long a line of a grid is, over `count` vertices that are `step` apart. */
static double line_length(const body *b, size_t count, size_t step) {
    double sum = 0;
    for (size_t i = 1; i < count; i++) {
        const double *p = &b->positions[3 * (i - 1) * step], *q = &b->positions[3 * i * step];
        sum += sqrt((q[0] - p[0]) * (q[0] - p[0]) + (q[1] - p[1]) * (q[1] - p[1]) + (q[2] - p[2]) * (q[2] - p[2]));
    }
    return isfinite(sum) && sum > 0 ? sum : 1;
}

/* u along the rows, v along the columns; patches as square as the cloth's own sides tell. */
static bool make_uv(body *b, size_t rows, size_t columns) {
    b->uv = malloc(b->vertex_count * 2 * sizeof *b->uv);
    if (!b->uv) return false;
    for (size_t v = 0; v < b->vertex_count; v++) {
        b->uv[2 * v] = (float)(v / columns) / (float)(rows - 1);
        b->uv[2 * v + 1] = (float)(v % columns) / (float)(columns - 1);
    }
    double along_u = line_length(b, rows, columns), along_v = line_length(b, columns, 1);
    double unit = fmax(along_u, along_v) / weave_repeats;
    b->repeats[0] = (float)fmax(1, round(along_u / unit));
    b->repeats[1] = (float)fmax(1, round(along_v / unit));
    return true;
}

static void gather(body *b, const skein_surface *surface, const double *all) {
    for (size_t v = 0; v < b->vertex_count; v++) {
        memcpy(&b->positions[3 * v], &all[3 * surface->particle_of_vertex[v]], 3 * sizeof *all);
    }
}

/* FNV-1a, by words. */
static uint64_t hash(uint64_t so_far, const void *data, size_t words) {
    const uint32_t *word = data;
    for (size_t i = 0; i < words; i++) so_far = (so_far ^ word[i]) * 0x100000001b3u;
    return so_far;
}

/* All that stays of a body. */
static bool make_body(body *b, const skein_surface *surface, skein_handle handle, const render_world_frame *made) {
    release_body(b);
    size_t rows = surface->grid_rows, columns = surface->grid_columns;
    b->handle = handle;
    b->vertex_count = surface->vertex_count;
    b->triangle_count = surface->face_vertex_count - 2 * surface->face_count;
    b->triangles = malloc(b->triangle_count * 3 * sizeof *b->triangles + 1);
    b->positions = malloc(b->vertex_count * 3 * sizeof *b->positions + 1);
    if (!b->triangles || !b->positions) return false;

    make_triangles(b, surface);
    gather(b, surface, made->all);
    if (b->vertex_count > surface->particle_count && !make_weld(b, surface, made->particle_count)) return false;
    bool grid = rows >= 2 && columns >= 2 && rows * columns == b->vertex_count;
    if (grid && !make_uv(b, rows, columns)) return false;

    b->shape = hash(0xcbf29ce484222325u, b->triangles, 3 * b->triangle_count);
    if (b->weld) b->shape = hash(b->shape, b->weld, b->vertex_count);
    if (b->uv) b->shape = hash(b->shape, b->uv, 2 * b->vertex_count);
    b->shape |= 1;
    return true;
}

static void add_surface(render_world_frame *made, const body *b, size_t index) {
    render_surface *surface = &made->surfaces[made->frame.surface_count++];
    *surface = (render_surface){
        .positions = b->positions,
        .vertex_count = b->vertex_count,
        .triangles = b->triangles,
        .triangle_count = b->triangle_count,
        .weld = b->weld,
        .uv = b->uv,
        .shape = b->shape,
        .material = b->uv ? render_default_material(index) : render_plain_material(index),
    };
    if (b->uv) memcpy(surface->material.repeats, b->repeats, sizeof b->repeats);
}

static skein_status take_bodies(render_world_frame *made, const skein_world *world, skein_error *error) {
    size_t count = skein_object_count(world, SKEIN_BODY);
    if (!grow(&made->surfaces, count, sizeof *made->surfaces)) return render_fail_memory(error, "a frame");
    if (count > made->body_count) {
        if (!grow(&made->bodies, count, sizeof *made->bodies)) return render_fail_memory(error, "a frame");
        memset(made->bodies + made->body_count, 0, (count - made->body_count) * sizeof *made->bodies);
        made->body_count = count;
    }
    made->frame.surfaces = made->surfaces;
    made->frame.surface_count = 0;
    for (size_t i = 0; i < count; i++) {
        skein_handle handle = skein_object_at(world, SKEIN_BODY, i);
        skein_surface surface;
        skein_status status = skein_body_surface(world, handle, &surface);
        if (status != SKEIN_OK) return render_fail(error, status, "", "a body's surface cannot be read");
        body *b = &made->bodies[i];
        bool same = b->positions && b->handle.index == handle.index && b->handle.generation == handle.generation &&
                    b->vertex_count == surface.vertex_count;
        if (!same && !make_body(b, &surface, handle, made)) return render_fail_memory(error, "a body's surface");
        gather(b, &surface, made->all);

        // a body without faces shows its particles; a hidden one shows nothing
        bool visible = is_visible(world, handle);
        if (visible && b->triangle_count > 0) add_surface(made, b, i);
        int shown = !visible ? HIDDEN : b->triangle_count > 0 ? IN_SURFACE : LOOSE;
        memset(made->shown + surface.first_particle, shown, surface.particle_count);
    }
    return SKEIN_OK;
}

/* ---- Particles ------------------------------------------------------------------------------ */

/* Loose particles, and pins: held particles of a surface, unless most of it is held. */
static skein_status take_particles(render_world_frame *made, const skein_world *world, skein_error *error) {
    static const float loose_colour[3] = {0.925f, 0.640f, 0.200f}, pin_colour[3] = {0.27f, 0.26f, 0.27f};
    size_t count = made->particle_count;
    skein_view view = skein_position_view(world);
    if (!grow(&made->loose.positions, 3 * count, sizeof(double)) ||
        !grow(&made->pins.positions, 3 * count, sizeof(double))) {
        return render_fail_memory(error, "the particles");
    }
    made->loose.count = made->pins.count = 0;
    for (size_t p = 0; p < count && p < view.count; p++) {
        bool held = view.xyzw[4 * (size_t)view.slot_of[p] + 3] == 0;
        if (made->shown[p] == HIDDEN || (made->shown[p] == IN_SURFACE && !held)) continue;
        particles *to = made->shown[p] == LOOSE ? &made->loose : &made->pins;
        memcpy(&to->positions[3 * to->count++], &made->all[3 * p], 3 * sizeof(double));
    }
    if (4 * made->pins.count > count) made->pins.count = 0;

    made->points[0] = (render_points){.positions = made->loose.positions, .count = made->loose.count};
    made->points[1] = (render_points){.positions = made->pins.positions, .count = made->pins.count};
    memcpy(made->points[0].colour, loose_colour, sizeof loose_colour);
    memcpy(made->points[1].colour, pin_colour, sizeof pin_colour);
    made->frame.points = made->points;
    made->frame.points_count = 2;
    render_bounds bounds = render_frame_bounds(&made->frame);
    double radius = render_bounds_radius(&bounds);
    made->points[0].radius = loose_size * (radius > 0 ? radius : 1);
    made->points[1].radius = pin_size * radius * (made->pins.count > 12 ? 0.6 : 1.0);
    return SKEIN_OK;
}

/* ---- Colliders ------------------------------------------------------------------------------ */

static void add_plane(render_world_frame *made, const skein_world *world, skein_handle handle, const skein_pose *pose) {
    skein_value normal;
    if (skein_get(world, handle, "normal", &normal) != SKEIN_OK) return;
    render_plane *plane = &made->planes[made->frame.plane_count++];
    memcpy(plane->point, pose->position, sizeof plane->point);
    for (int r = 0; r < 3; r++) {
        plane->normal[r] = 0;
        for (int c = 0; c < 3; c++) plane->normal[r] += pose->rotation[3 * r + c] * normal.number[c];
    }
}

static void add_sphere(render_world_frame *made, const skein_world *world, skein_handle handle,
                       const skein_pose *pose) {
    skein_value radius;
    if (skein_get(world, handle, "radius", &radius) != SKEIN_OK) return;
    render_sphere *sphere = &made->spheres[made->frame.sphere_count++];
    *sphere = render_default_sphere();
    sphere->radius = radius.number[0];
    memcpy(sphere->centre, pose->position, sizeof sphere->centre);
    memcpy(sphere->rotation, pose->rotation, sizeof sphere->rotation);
}

static skein_status take_colliders(render_world_frame *made, const skein_world *world, skein_error *error) {
    size_t count = skein_object_count(world, SKEIN_COLLIDER);
    if (!grow(&made->planes, count, sizeof *made->planes) || !grow(&made->spheres, count, sizeof *made->spheres)) {
        return render_fail_memory(error, "the colliders");
    }
    made->frame.planes = made->planes, made->frame.plane_count = 0;
    made->frame.spheres = made->spheres, made->frame.sphere_count = 0;
    for (size_t i = 0; i < count; i++) {
        skein_handle handle = skein_object_at(world, SKEIN_COLLIDER, i);
        const skein_kind *kind = skein_object_kind(world, handle);
        skein_pose pose;
        if (!kind || !is_visible(world, handle) || skein_collider_pose(world, handle, &pose) != SKEIN_OK) continue;
        if (strcmp(kind->name, "plane") == 0) add_plane(made, world, handle, &pose);
        if (strcmp(kind->name, "sphere") == 0) add_sphere(made, world, handle, &pose);
    }
    return SKEIN_OK;
}

/* ---- All of it ------------------------------------------------------------------------------ */

/* Where no plane is ground, one is put at height 0 if the things stand not far above it, else a little
 * below them. */
static void place_floor(render_world_frame *made) {
    bool level = false;
    for (size_t i = 0; i < made->frame.plane_count; i++) level |= render_plane_level(&made->planes[i]);
    if (!made->has_floor && !level) {
        render_bounds bounds = render_frame_bounds(&made->frame);
        double size = 2 * render_bounds_radius(&bounds), lowest = bounds.least[1];
        if (render_bounds_empty(&bounds)) lowest = size = 0;
        made->floor_height = lowest >= 0 && lowest <= size ? 0 : lowest - 0.1 * size;
        made->has_floor = true;
    }
    made->frame.look.floor = made->has_floor && !level;
    made->frame.look.floor_height = made->floor_height;
}

skein_status render_world_frame_update(render_world_frame *made, skein_world *world, const render_view *view,
                                       skein_error *error) {
    made->view = view ? *view : render_view_default();
    size_t count = skein_particle_count(world);
    if (!grow(&made->all, 3 * count, sizeof *made->all) || !grow(&made->shown, count, sizeof *made->shown)) {
        return render_fail_memory(error, "the particles");
    }
    made->particle_count = count;
    memset(made->shown, 0, count * sizeof *made->shown);
    skein_status status = count > 0 ? skein_positions_copy(world, 0, count, made->all) : SKEIN_OK;
    if (status != SKEIN_OK) return render_fail(error, status, "", "the positions cannot be read");

    status = take_bodies(made, world, error);
    if (status == SKEIN_OK) status = take_colliders(made, world, error);
    if (status == SKEIN_OK) status = take_particles(made, world, error);
    if (status == SKEIN_OK) place_floor(made);
    return status;
}

void render_world_frame_settle(render_world_frame *made) {
    render_bounds bounds = render_frame_bounds(&made->frame);
    if (!made->frame.look.floor || render_bounds_empty(&bounds)) return;
    double most_gap = floor_gap * (bounds.most[1] - bounds.least[1]);
    made->floor_height = fmax(made->floor_height, bounds.least[1] - most_gap);
    made->frame.look.floor_height = made->floor_height;
}

render_camera render_world_frame_camera(const render_world_frame *made, double aspect) {
    const render_look *look = &made->frame.look;
    render_bounds bounds = render_frame_bounds(&made->frame);
    double gap = bounds.least[1] - look->floor_height, most_gap = floor_gap * (bounds.most[1] - bounds.least[1]);
    if (look->floor && gap > 0 && gap < 1.01 * most_gap) bounds.least[1] = look->floor_height;
    return render_camera_framing(&bounds, aspect);
}
