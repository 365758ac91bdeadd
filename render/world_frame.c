/* A frame from a world; see world_frame.h. */
#include "render/world_frame.h"

#include "render/body_mesh.h"
#include "render/fail.h"
#include "render/planes.h"
#include "render/world_birds.h"
#include "render/world_flock.h"
#include "render/world_follow.h"
#include "render/world_implicit.h"
#include "render/world_lines.h"
#include "render/world_points.h"
#include "render/world_solids.h"
#include "render/world_state.h"

#include <skein/cut.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What is kept for a body, by its place among the world's bodies. */
typedef struct body {
    skein_handle handle;
    bool rope;
    skein_look look;
    skein_surface source; /* that it was made from */
    bool made;
    render_body_mesh mesh;
    skein_cuts cuts;   /* what the mesh is drawn without */
    double *positions; /* by vertex: now */
    float *values;     /* by vertex, where colours tell numbers */
} body;

struct render_world_frame {
    render_frame frame;
    render_view view; /* of the last update; its texts are not ours */
    double time;      /* of the last update */
    double blend;     /* between the last two steps */
    render_world_state state;
    render_world_lines lines;
    render_chosen chosen;
    render_world_points points;
    render_world_birds birds;
    body *bodies;
    size_t body_count;
    render_surface *surfaces;
    render_world_solids solids;
    render_world_implicit implicit;
    render_image image;
    char *image_path; /* of the image that is loaded */
    bool unread;      /* this time the particles' numbers stay where they are */
    unsigned updates;
    uint32_t bird; /* that is chosen; UINT32_MAX: none */
    bool has_floor;
    double floor_height;
    render_subject held; /* in the picture, whatever the frame has */
    render_followed followed;
};

/* The patterns and images repeat so often along a body's longer side. */
static const double usual_repeats[] = {
    [RENDER_PLAIN] = 1, [RENDER_CHECKER] = 8, [RENDER_WEAVE] = 20, [RENDER_IMAGE] = 1, [RENDER_VALUES] = 1};
/* Lengths of normals and contacts, in radii of the scene. */
static const double normal_length = 0.03, contact_length = 0.06;
enum { updates_between_looks = 30 };
/* The ground is near when it is no farther below things than this part of their height. */
static const double floor_gap = 0.25;
/* The ground lies so far below terrain, in radii of the things on it: less would meet where waves go down. */
static const double ground_gap = 0.02;
/* The surroundings of a body that is followed, in its radii. */
static const double around = 6;
/* A level plane is in the picture when it is no farther below things than so many of their radii. */
static const double seen_fall = 2;

render_world_frame *render_world_frame_create(skein_error *error) {
    render_world_frame *made = calloc(1, sizeof *made);
    if (!made) {
        render_fail_memory(error, "a frame");
        return NULL;
    }
    made->frame = render_default_frame();
    made->held = render_subject_nothing();
    made->blend = 1;
    made->bird = UINT32_MAX;
    return made;
}

static void release_body(body *b) {
    render_body_mesh_release(&b->mesh);
    free(b->positions);
    free(b->values);
    memset(b, 0, sizeof *b);
}

void render_world_frame_destroy(render_world_frame *made) {
    if (!made) return;
    for (size_t i = 0; i < made->body_count; i++) release_body(&made->bodies[i]);
    render_world_state_release(&made->state);
    render_world_lines_release(&made->lines);
    render_world_points_release(&made->points);
    render_world_birds_release(&made->birds);
    render_image_release(&made->image);
    free(made->image_path);
    free(made->bodies);
    free(made->surfaces);
    render_world_solids_release(&made->solids);
    render_world_implicit_release(&made->implicit);
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

static render_bounds bounds_to_hold(const render_world_frame *made) {
    render_bounds bounds = render_frame_bounds(&made->frame), held = render_hull_bounds(&made->held.all);
    if (render_bounds_empty(&held)) return bounds;
    render_bounds_add(&bounds, held.least, 0);
    render_bounds_add(&bounds, held.most, 0);
    return bounds;
}

static bool says(const skein_world *world, skein_handle handle, const char *field) {
    skein_value value;
    return skein_get(world, handle, field, &value) != SKEIN_OK || value.number[0] != 0;
}

static bool is_visible(const skein_world *world, skein_handle handle) {
    return says(world, handle, "visible");
}

/* ---- The image ------------------------------------------------------------------------------ */

/* Reads the view's image, unless it is there already. */
static skein_status take_image(render_world_frame *made, skein_error *error) {
    const char *path = made->view.image ? made->view.image : "";
    made->frame.image = NULL;
    if (!path[0]) return SKEIN_OK;
    if (!made->image_path || strcmp(made->image_path, path) != 0) {
        skein_status status = render_image_read(&made->image, path, error);
        char *kept = status == SKEIN_OK ? strdup(path) : NULL;
        free(made->image_path);
        made->image_path = kept;
        if (status != SKEIN_OK) return status;
        if (!kept) return render_fail_memory(error, "an image");
        made->frame.image_number++;
    }
    made->frame.image = &made->image;
    return SKEIN_OK;
}

/* ---- Bodies --------------------------------------------------------------------------------- */

/* What a body is drawn as; one that has nothing to say about that has no surface, or is cloth. */
static skein_look look_of(const skein_world *world, skein_handle handle) {
    const skein_kind *kind = skein_object_kind(world, handle);
    skein_value value;
    if (!kind || !skein_field_find(kind, "look", NULL) || skein_get(world, handle, "look", &value))
        return SKEIN_LOOK_CLOTH;
    return (skein_look)value.number[0];
}

static bool make_body(body *b, const skein_world *world, const skein_surface *surface, skein_handle handle) {
    const size_t count = skein_particle_count(world);
    double *built = malloc(3 * count * sizeof *built + 1); // its first shape, whenever it is drawn first
    skein_look look = look_of(world, handle);
    skein_shape shape;
    release_body(b);
    const bool good = built && skein_positions_built(world, 0, count, built) == SKEIN_OK &&
                      render_body_mesh_make(&b->mesh, surface, built, look == SKEIN_LOOK_JELLY);
    free(built);
    if (!good) return false;
    b->handle = handle;
    b->rope = skein_shape_of(world, handle, &shape) == SKEIN_OK && shape.sort == SKEIN_SHAPE_CHAIN;
    b->look = look;
    b->source = *surface;
    b->made = grow(&b->positions, 3 * b->mesh.vertex_count, sizeof *b->positions) &&
              grow(&b->values, b->mesh.vertex_count, sizeof *b->values);
    return b->made;
}

/* Its faces without those that are cut. */
static bool leave_out_cut(body *b, const skein_world *world) {
    skein_cuts now;
    if (skein_body_cuts(world, b->handle, &now) != SKEIN_OK) return true;
    if (now.face == b->cuts.face && now.changes == b->cuts.changes) return true;
    if (!render_body_mesh_leave_out(&b->mesh, &b->source, now.count ? now.face : NULL)) return false;
    b->cuts = now;
    return true;
}

static void gather(body *b, const render_world_state *state) {
    for (size_t v = 0; v < b->mesh.vertex_count; v++) {
        size_t particle = b->mesh.particles[v];
        memcpy(&b->positions[3 * v], &state->positions[3 * particle], 3 * sizeof *b->positions);
        if (state->range > 0) b->values[v] = state->values[particle];
    }
}

/* Which pattern a body's surface has under a view. */
static render_pattern pattern_of(const render_world_frame *made) {
    static const render_pattern patterns[] = {RENDER_WEAVE, RENDER_WEAVE, RENDER_CHECKER, RENDER_PLAIN};
    const render_view *view = &made->view;
    if (view->colour == RENDER_BY_SPEED || view->colour == RENDER_BY_STRAIN) return RENDER_VALUES;
    if (view->colour == RENDER_BY_BODY) return RENDER_PLAIN;
    return made->frame.image ? RENDER_IMAGE : patterns[view->pattern];
}

static void dress(const render_world_frame *made, const body *b, size_t index, render_material *material) {
    bool suited = made->view.pattern == 0 && pattern_of(made) == RENDER_WEAVE,
         jelly = suited && b->look == SKEIN_LOOK_JELLY;
    render_pattern pattern = suited && b->look == SKEIN_LOOK_PLAIN ? RENDER_PLAIN : pattern_of(made);
    *material = jelly                     ? render_jelly_material(index)
                : pattern == RENDER_PLAIN ? render_plain_material(index)
                                          : render_default_material(index);
    if (jelly) return;
    material->pattern = pattern;
    double repeats = made->view.repeats > 0 ? made->view.repeats : usual_repeats[pattern];
    double unit = fmax(b->mesh.sides[0], b->mesh.sides[1]) / repeats;
    for (int k = 0; k < 2; k++) material->repeats[k] = (float)fmax(1, round(b->mesh.sides[k] / unit));
}

static void add_surface(render_world_frame *made, const body *b, size_t index) {
    render_surface *surface = &made->surfaces[made->frame.surface_count++];
    *surface = (render_surface){
        .positions = b->positions,
        .vertex_count = b->mesh.vertex_count,
        .triangles = b->mesh.triangles,
        .triangle_count = b->mesh.triangle_count,
        .weld = b->mesh.weld,
        .uv = b->mesh.uv,
        .rows_first = b->mesh.grid,
        .values = made->state.range > 0 ? b->values : NULL,
        .map = made->state.map,
        .shape = b->mesh.shape,
    };
    dress(made, b, index, &surface->material);
}

/* Notes how a body's particles are shown. */
static void mark(render_world_state *state, const skein_surface *surface, int shown, size_t index) {
    memset(state->shown + surface->first_particle, shown, surface->particle_count);
    for (size_t p = 0; p < surface->particle_count; p++) state->body[surface->first_particle + p] = (uint32_t)index;
}

static skein_status take_body(render_world_frame *made, const skein_world *world, size_t index, skein_error *error) {
    skein_handle handle = skein_object_at(world, SKEIN_BODY, index);
    skein_surface surface;
    skein_status status = skein_body_surface(world, handle, &surface);
    if (status != SKEIN_OK) return render_fail(error, status, "", "a body's surface cannot be read");
    body *b = &made->bodies[index];
    bool same = b->made && b->handle.index == handle.index && b->handle.generation == handle.generation &&
                b->source.face_vertices == surface.face_vertices && b->source.corner_uv == surface.corner_uv &&
                b->source.vertex_count == surface.vertex_count && b->look == look_of(world, handle);
    if (!same && !make_body(b, world, &surface, handle)) return render_fail_memory(error, "a body's surface");
    if (!leave_out_cut(b, world)) return render_fail_memory(error, "a body's surface");
    gather(b, &made->state);

    // a body without faces shows its particles; a hidden one shows nothing
    bool visible = is_visible(world, handle) && says(world, handle, "enabled"), faces = b->mesh.triangle_count > 0;
    bool rope = b->rope && made->view.surface;
    if (visible && render_are_birds(world, handle, &made->view)) {
        mark(&made->state, &surface, RENDER_HIDDEN, index);
        return render_add_birds(&made->birds, world, &made->state, &surface, index)
                   ? SKEIN_OK
                   : render_fail_memory(error, "the birds");
    }
    mark(&made->state, &surface, !visible ? RENDER_HIDDEN : faces || rope ? RENDER_IN_SURFACE : RENDER_LOOSE, index);
    if (!visible) return SKEIN_OK;
    if (rope && !render_add_rope(&made->solids, &made->state, &surface, index, &made->view))
        return render_fail_memory(error, "a rope");
    if (faces && made->view.surface) add_surface(made, b, index);
    if (made->view.wireframe) render_add_wireframe(&made->lines, &b->mesh, &made->state);
    return SKEIN_OK;
}

static skein_status take_bodies(render_world_frame *made, skein_world *world, skein_error *error) {
    size_t count = skein_object_count(world, SKEIN_BODY);
    if (!grow(&made->surfaces, count, sizeof *made->surfaces)) return render_fail_memory(error, "a frame");
    if (count > made->body_count) {
        if (!grow(&made->bodies, count, sizeof *made->bodies)) return render_fail_memory(error, "a frame");
        memset(made->bodies + made->body_count, 0, (count - made->body_count) * sizeof *made->bodies);
        made->body_count = count;
    }
    made->frame.surfaces = made->surfaces;
    made->frame.surface_count = 0;
    render_world_solids_clear(&made->solids);
    render_world_birds_clear(&made->birds);
    skein_status status = SKEIN_OK;
    for (size_t i = 0; i < count && status == SKEIN_OK; i++) status = take_body(made, world, i, error);
    // predators are of a world that has birds
    if (!status && made->birds.count && !render_add_predators(&made->birds, &made->lines, world, &made->state))
        status = render_fail_memory(error, "a predator");
    if (!status && made->birds.count && made->bird != UINT32_MAX)
        render_add_zones(&made->lines, world, &made->state, made->bird);
    render_world_birds_show(&made->birds, &made->view, made->state.range, &made->frame);
    return status;
}

/* ---- Colliders that are formulas or meshes -------------------------------------------------- */

/* Their meshes come after the bodies', and fill what the rest of the picture takes. */
static skein_status take_implicit(render_world_frame *made, const skein_world *world, skein_error *error) {
    if (!made->view.colliders) return SKEIN_OK;
    render_bounds things = bounds_to_hold(made);
    skein_status status = render_take_implicit(&made->implicit, world, &things, error);
    if (status != SKEIN_OK) return status;
    if (!grow(&made->surfaces, made->frame.surface_count + made->implicit.count, sizeof *made->surfaces))
        return render_fail_memory(error, "a frame");
    made->frame.surfaces = made->surfaces;
    made->frame.surface_count += render_show_implicit(&made->implicit, made->surfaces + made->frame.surface_count);
    return SKEIN_OK;
}

/* ---- Particles ------------------------------------------------------------------------------ */

/* The mean length of some edges, as a measure of how close particles are; infinite where there are none. */
static double mean_edge(const render_world_frame *made) {
    double sum = 0;
    size_t count = 0;
    for (size_t i = 0; i < made->body_count; i++) {
        const render_body_mesh *mesh = &made->bodies[i].mesh;
        size_t stride = 1 + mesh->all_edge_count / 512; // what is cut was as close
        for (size_t e = 0; e < mesh->all_edge_count; e += stride, count++) {
            const double *p = &made->state.positions[3 * (size_t)mesh->all_edges[2 * e]],
                         *q = &made->state.positions[3 * (size_t)mesh->all_edges[2 * e + 1]];
            sum += sqrt((q[0] - p[0]) * (q[0] - p[0]) + (q[1] - p[1]) * (q[1] - p[1]) + (q[2] - p[2]) * (q[2] - p[2]));
        }
    }
    return count && isfinite(sum) ? sum / (double)count : INFINITY;
}

static skein_status take_particles(render_world_frame *made, const skein_world *world, skein_error *error) {
    skein_view where = made->unread ? (skein_view){NULL, NULL, 0} : skein_position_view(world);
    if (!render_world_points_take(&made->points, &made->state, &where, &made->view))
        return render_fail_memory(error, "the particles");
    made->frame.points = made->points.points;
    made->frame.points_count = RENDER_POINT_KIND_COUNT;

    render_bounds bounds = render_frame_bounds(&made->frame);
    double radius = made->frame.radius > 0 ? made->frame.radius : render_bounds_radius(&bounds);
    render_world_birds_size(&made->birds, &made->view, radius);
    render_world_points_size(&made->points, &made->view, radius, mean_edge(made));
    render_world_solids_size(&made->solids, &made->view, radius);
    return SKEIN_OK;
}

/* ---- All of it ------------------------------------------------------------------------------ */

/* Arrows over a box around the things, on a grid. */
static skein_status take_fields(render_world_frame *made, const skein_world *world, const render_bounds *things,
                                skein_error *error) {
    enum { ALONG = 9 }; // arrows along the longest side
    render_bounds box = *things;
    double longest = 0, spacing;
    size_t n[3], count = 1;
    for (int k = 0; k < 3; k++) longest = fmax(longest, box.most[k] - box.least[k]);
    if (!(longest > 0 && isfinite(longest))) return SKEIN_OK;
    spacing = longest / (ALONG - 1);
    for (int k = 0; k < 3; k++) {
        n[k] = (size_t)((box.most[k] - box.least[k]) / spacing + 1e-6) + 1;
        count *= n[k];
    }
    double *points = malloc(6 * count * sizeof *points), *forces = points ? points + 3 * count : NULL;
    if (!points) return render_fail_memory(error, "the arrows of a field");
    for (size_t i = 0; i < count; i++) {
        size_t place[3] = {i % n[0], i / n[0] % n[1], i / (n[0] * n[1])};
        for (int k = 0; k < 3; k++) {
            double middle = 0.5 * (box.least[k] + box.most[k]);
            points[3 * i + (size_t)k] = middle + spacing * ((double)place[k] - 0.5 * (double)(n[k] - 1));
        }
    }
    for (size_t f = 0; f < skein_object_count(world, SKEIN_FORCE); f++) {
        skein_handle handle = skein_object_at(world, SKEIN_FORCE, f);
        skein_value enabled;
        if (!is_visible(world, handle) || skein_get(world, handle, "enabled", &enabled) || enabled.number[0] == 0 ||
            skein_force_probe(world, handle, count, points, forces)) // most are no fields
            continue;
        render_add_field(&made->lines, count, points, forces, 0.8 * spacing);
    }
    free(points);
    return SKEIN_OK;
}

static skein_status take_lines(render_world_frame *made, skein_world *world, skein_error *error) {
    const render_view *view = &made->view;
    if (view->springs) render_add_springs(&made->lines, &made->state);
    render_world_lines_show(&made->lines, view->line_width, &made->frame);
    render_bounds bounds = render_frame_bounds(&made->frame);
    double radius = render_bounds_radius(&bounds);
    for (size_t i = 0; i < made->frame.surface_count && view->normals; i++)
        render_add_normals(&made->lines, &made->surfaces[i], normal_length * radius);
    if (view->velocities) render_add_velocities(&made->lines, &made->state, view->velocity_scale);
    if (view->contacts) render_add_contacts(&made->lines, &made->state, contact_length * radius);
    double ball = made->points.points[RENDER_PARTICLES].count ? made->points.points[RENDER_PARTICLES].radius : 0;
    if (render_take_constraints(&made->lines, &made->state, world, view, &made->chosen, radius, ball, error))
        return SKEIN_ERROR_MEMORY;
    if (view->fields && take_fields(made, world, &bounds, error)) return SKEIN_ERROR_MEMORY;
    if (view->axes) render_add_axes(&made->lines, render_grid_cell(radius > 0 ? radius : 1));
    render_world_lines_show(&made->lines, view->line_width, &made->frame);
    return made->lines.no_memory ? render_fail_memory(error, "the lines") : SKEIN_OK;
}

/* The lowest that slabs and terrain reach; infinite where there are none. */
static double lowest_slab(const render_world_frame *made) {
    render_bounds things = bounds_to_hold(made), slabs = render_bounds_nothing();
    double middle[3], radius = render_bounds_radius(&things);
    render_bounds_centre(&things, middle);
    render_bounds_add_slabs(&slabs, &made->frame, middle, radius > 0 ? radius : 1);
    for (size_t s = 0; s < made->frame.surface_count; s++) {
        const render_surface *surface = &made->surfaces[s];
        for (size_t v = 0; v < surface->vertex_count && surface->scenery; v++)
            slabs.least[1] =
                fmin(slabs.least[1], surface->positions[3 * v + 1] - ground_gap * (radius > 0 ? radius : 1));
    }
    return slabs.least[1];
}

/* Where no plane is ground, one is put at height 0 if the things stand not far above it, else a little
 * below them; and slopes stand on it. */
static void place_floor(render_world_frame *made) {
    bool level = false;
    for (size_t i = 0; i < made->frame.plane_count; i++) level |= render_plane_level(&made->frame.planes[i]);
    if (!made->has_floor && !level && made->view.ground) {
        render_bounds bounds = bounds_to_hold(made);
        double size = 2 * render_bounds_radius(&bounds), lowest = bounds.least[1];
        if (render_bounds_empty(&bounds)) lowest = size = 0;
        made->floor_height = fmin(lowest >= 0 && lowest <= size ? 0 : lowest - 0.1 * size, lowest_slab(made));
        made->has_floor = true;
    }
    // down a slope a body that is followed gets below any ground
    const char *follows = made->view.camera.follow;
    bool slides = follows && follows[0] && made->frame.plane_count > 0;
    made->frame.look.floor = made->has_floor && !level && made->view.ground && !slides;
    made->frame.look.floor_height = made->floor_height;
}

static void take_look(render_world_frame *made) {
    render_look *look = &made->frame.look;
    memcpy(look->sun, made->view.sun, sizeof look->sun);
    look->exposure = made->view.exposure;
    look->plain = made->view.shading == RENDER_BLINN_PHONG;
    look->grid = made->view.grid;
}

/* Birds that a card moves are drawn where they are, and their numbers come here only now and then: so that the camera
 * knows about where. It takes a world of nothing else. */
static bool needs_no_numbers(render_world_frame *made, const skein_world *world) {
    skein_device_info device = skein_world_device(world);
    if (made->bird != UINT32_MAX || render_has_flying_predator(world)) return false;
    if (device.device != SKEIN_DEVICE_CURRENT_GL || !device.position_buffer || made->view.velocities ||
        made->view.contacts || made->state.particle_count != skein_particle_count(world) ||
        ++made->updates % updates_between_looks == 0)
        return false;
    size_t birds = 0;
    for (size_t i = 0; i < skein_object_count(world, SKEIN_BODY); i++) {
        skein_handle handle = skein_object_at(world, SKEIN_BODY, i);
        skein_surface surface;
        if (!render_are_birds(world, handle, &made->view) || skein_body_surface(world, handle, &surface) != SKEIN_OK)
            return false;
        birds += surface.particle_count;
    }
    return birds == made->state.particle_count;
}

/* What surrounds the body that is followed goes along with it, as wide as it was at first, and wide enough that a slope
 * reaches out of the picture. */
static void follow(render_world_frame *made, const skein_world *world) {
    bool did = made->followed.any, held = !render_hull_empty(&made->held.all);
    made->followed = render_follow(world, made->view.camera.follow, &made->state);
    if (made->followed.any && !did) {
        render_bounds bounds = bounds_to_hold(made);
        made->frame.radius = fmax(render_bounds_radius(&bounds), around * made->followed.radius);
        if (!held) memcpy(made->frame.anchor, made->followed.middle, sizeof made->frame.anchor);
    }
    if (made->followed.any) memcpy(made->frame.middle, made->followed.middle, sizeof made->frame.middle);
    else if (did && !held) made->frame.radius = 0;
}

skein_status render_world_frame_update(render_world_frame *made, skein_world *world, const render_view *view,
                                       skein_error *error) {
    made->view = view ? *view : render_view_default();
    made->time = made->frame.time = skein_world_time(world);
    render_world_lines_clear(&made->lines);
    take_look(made);
    skein_status status = take_image(made, error);
    made->unread = needs_no_numbers(made, world);
    if (status == SKEIN_OK && !made->unread)
        status = render_world_state_read(&made->state, world, &made->view, made->blend, error);
    if (status == SKEIN_OK) status = take_bodies(made, world, error);
    if (status == SKEIN_OK) status = render_take_colliders(&made->solids, world, &made->view, error);
    render_world_solids_show(&made->solids, &made->frame);
    if (status == SKEIN_OK) status = take_implicit(made, world, error);
    if (status == SKEIN_OK) status = take_particles(made, world, error);
    if (status == SKEIN_OK) status = take_lines(made, world, error);
    if (status == SKEIN_OK) place_floor(made);
    if (status == SKEIN_OK) follow(made, world);
    return status;
}

double render_world_frame_range(const render_world_frame *made) {
    return made->state.range > 0 ? made->state.range : made->state.spring_range;
}

void render_world_frame_choose(render_world_frame *made, const render_chosen *chosen) {
    made->chosen = *chosen;
}

void render_world_frame_choose_bird(render_world_frame *made, uint32_t particle) {
    made->bird = particle;
}

double render_world_frame_span(const render_world_frame *made) {
    return made->birds.count ? made->birds.birds[0].span : 0;
}

void render_world_frame_blend(render_world_frame *made, double blend) {
    made->blend = blend;
}

void render_world_frame_settle(render_world_frame *made) {
    render_bounds bounds = render_frame_bounds(&made->frame);
    if (!made->frame.look.floor || render_bounds_empty(&bounds) || isfinite(lowest_slab(made))) return;
    double most_gap = floor_gap * (bounds.most[1] - bounds.least[1]);
    made->floor_height = fmax(made->floor_height, bounds.least[1] - most_gap);
    made->frame.look.floor_height = made->floor_height;
}

void render_world_frame_hold(render_world_frame *made, const render_subject *subject) {
    made->held = *subject;
    render_bounds bounds = render_hull_bounds(&subject->all);
    made->frame.radius = render_bounds_radius(&bounds);
    render_bounds_centre(&bounds, made->frame.middle);
    memcpy(made->frame.anchor, made->frame.middle, sizeof made->frame.anchor);
}

/* Where they stand above the ground, as in their shadows, belongs to what is around. */
static void add_ground(render_hull *all, double height) {
    const render_hull above = *all;
    for (int i = 0; i < RENDER_HULL_DIRECTIONS; i++) {
        const double below[3] = {above.point[i][0], height, above.point[i][2]};
        render_hull_add(all, below, 0);
    }
}

render_subject render_world_frame_subject(const render_world_frame *made) {
    const render_look *look = &made->frame.look;
    render_subject subject = render_subject_of(&made->frame);
    render_subject_join(&subject, &made->held);
    if (render_hull_empty(&subject.all)) return subject;
    render_bounds bounds = render_hull_bounds(&subject.all);
    double gap = bounds.least[1] - look->floor_height, most_gap = floor_gap * (bounds.most[1] - bounds.least[1]),
           ground;
    if (look->floor && gap > 0 && gap < 1.01 * most_gap) add_ground(&subject.all, look->floor_height);
    // ground that is a collider is what things fall on to, or hang over: its shadows belong to the picture
    bool is_there = !look->floor && render_find_ground(&made->frame, &ground);
    if (is_there && bounds.least[1] > ground && bounds.least[1] - ground < seen_fall * render_bounds_radius(&bounds))
        add_ground(&subject.all, ground);
    return subject;
}

bool render_world_frame_followed(const render_world_frame *made, double middle[3]) {
    memcpy(middle, made->followed.middle, sizeof made->followed.middle);
    return made->followed.any;
}

bool render_world_frame_middle(const render_world_frame *made, double middle[3]) {
    if (render_world_frame_followed(made, middle)) return true;
    const render_world_state *state = &made->state;
    size_t count = 0;
    middle[0] = middle[1] = middle[2] = 0;
    for (size_t p = 0; p < state->particle_count; p++) {
        const double *x = &state->positions[3 * p];
        bool hidden = state->shown[p] == RENDER_HIDDEN && !made->frame.bird_count; // birds are drawn in their own way
        if (hidden || !isfinite(x[0]) || !isfinite(x[1]) || !isfinite(x[2])) continue;
        for (int k = 0; k < 3; k++) middle[k] += x[k];
        count++;
    }
    for (int k = 0; k < 3 && count; k++) middle[k] /= (double)count;
    return count > 0;
}

render_camera render_world_frame_camera(const render_world_frame *made, double aspect) {
    const render_view_camera *view = &made->view.camera;
    const render_followed *followed = &made->followed;
    render_subject subject = followed->any ? render_followed_subject(followed) : render_world_frame_subject(made);
    render_camera camera = render_camera_of_view(view, &subject, made->time, aspect);
    // a place that is given says from which side and how far
    if (followed->any && memcmp(view->from, view->at, sizeof view->from) != 0)
        for (int k = 0; k < 3; k++) {
            double way = followed->middle[k] - camera.target[k];
            camera.eye[k] += way, camera.target[k] += way;
        }
    return camera;
}
