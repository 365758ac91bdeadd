/* Drawing a frame; see draw.h. */
#include "render/draw.h"

#include "render/birds.h"
#include "render/fail.h"
#include "render/instances.h"
#include "render/light.h"
#include "render/linear.h"
#include "render/meshes.h"
#include "render/paints.h"
#include "render/planes.h"
#include "render/shader.h"
#include "render/solids.h"

#include <epoxy/gl.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Those that have a depth-only twin for the light maps, DEPTH_ONLY further on, come first. */
enum { PLANE, SURFACE, BALL, DEPTH_ONLY };
enum { SKY = 2 * DEPTH_ONLY, FINE_SURFACE, GLAZED_SURFACE, FINE_BALL, LINE, PROGRAM_COUNT };

struct render_draw {
    GLuint programs[PROGRAM_COUNT];
    GLuint uniforms; /* the pass blocks, then the scene block */
    GLuint no_arrays;
    render_light light;
    render_paints paints;
    render_shape disc, square;
    render_shape sphere, pearl, grain; /* fine for colliders, coarse for particles, and for many of them */
    render_instances balls, particles, lines;
    render_solids solids;
    render_flight flight;
    size_t part; /* triangles that are drawn at a time; 0: all */
    double line_scale;
    const render_shape *particle_shape; /* in this frame */
    render_mesh *meshes;                /* by the surface's place in the frame */
    size_t mesh_count;
};

/* What a frame comes to, worked out before the first triangle. */
typedef struct drawing {
    const render_frame *frame;
    const render_camera *camera;
    int width, height;
    double radius, middle[3]; /* of everything finite */
    bool has_ground;
    double ground; /* height of the ground */
    render_scene_block block;
} drawing;

static const double degree = 0.017453292519943295;

/* The ground ends so many radii away, where the haze has long swallowed it. */
static const double ground_size = 60;
/* Cloth that lies on something wins against it: it is drawn nearer by this part of its distance. */
static const float lift = 5e-4f;
/* Where edges are under so many pixels, shadows on surfaces are found by vertex: a pixel each would cost more and
 * show no more. */
static const double fine_edge = 4.5;
/* Pixels of a picture's height that are drawn at a time, where it is drawn in parts. */
enum { band_height = 60, overlap = 4 };
/* More particles than these have the coarser shape: they are small then, and a sphere each is a lot to draw. */
enum { many_particles = 600 };
/* Taps of a shadow's map. (Loops that the compiler cannot unroll end early where all of a pixel's neighbours have
 * ended: unrolled ones took 1.4 times as long, on llvmpipe.) */
enum { search_taps = 12, edge_taps = 20, rim_taps = 7 };

/* ---- Making --------------------------------------------------------------------------------- */

static skein_status make_all(render_draw *draw, skein_error *error) {
    static const char *const stages[PROGRAM_COUNT][2] = {
        [SKY] = {"sky.vert", "display,sky.frag"},
        [PLANE] = {"plane.vert", "display,light,plane.frag"},
        [SURFACE] = {"surface.vert", "display,light,surface.frag"},
        [FINE_SURFACE] = {"fine,light,surface.vert", "fine,display,surface.frag"},
        [GLAZED_SURFACE] = {"surface.vert", "glazed,display,light,glaze,jelly,surface.frag"},
        [BALL] = {"ball.vert", "display,light,glaze,ball.frag"},
        [FINE_BALL] = {"fine,light,ball.vert", "fine,display,glaze,ball.frag"},
        [PLANE + DEPTH_ONLY] = {"plane.vert", NULL},
        [SURFACE + DEPTH_ONLY] = {"depth.vert", NULL},
        [BALL + DEPTH_ONLY] = {"ball.vert", NULL},
        [LINE] = {"line.vert", "display,line.frag"},
    };
    for (int i = 0; i < PROGRAM_COUNT; i++) {
        draw->programs[i] = render_shader_link(stages[i][0], stages[i][1], error);
        if (!draw->programs[i]) return SKEIN_ERROR_VALUE;
    }
    skein_status status = render_light_create(&draw->light, error);
    if (status == SKEIN_OK) status = render_shape_disc(&draw->disc, error);
    if (status == SKEIN_OK) status = render_shape_square(&draw->square, error);
    if (status == SKEIN_OK) status = render_shape_sphere(&draw->sphere, 24, error);
    if (status == SKEIN_OK) status = render_shape_sphere(&draw->pearl, 10, error);
    if (status == SKEIN_OK) status = render_shape_dome(&draw->grain, error);
    if (status == SKEIN_OK) status = render_solids_create(&draw->solids, error);
    if (status == SKEIN_OK) status = render_flight_create(&draw->flight, error);
    if (status != SKEIN_OK) return status;

    render_instances_make_balls(&draw->balls, &draw->sphere);
    render_instances_make_balls(&draw->particles, &draw->pearl);
    render_instances_make_lines(&draw->lines);
    render_paints_create(&draw->paints);
    glCreateVertexArrays(1, &draw->no_arrays);
    glCreateBuffers(1, &draw->uniforms);
    glNamedBufferStorage(draw->uniforms, RENDER_SCENE_OFFSET + sizeof(render_scene_block), NULL, GL_DYNAMIC_STORAGE_BIT);
    return SKEIN_OK;
}

render_draw *render_draw_create(skein_error *error) {
    render_draw *draw = calloc(1, sizeof *draw);
    if (!draw) {
        render_fail_memory(error, "the renderer");
        return NULL;
    }
    draw->line_scale = 1;
    if (make_all(draw, error) != SKEIN_OK) {
        render_draw_destroy(draw);
        return NULL;
    }
    return draw;
}

void render_draw_destroy(render_draw *draw) {
    if (!draw) return;
    for (int i = 0; i < PROGRAM_COUNT; i++) {
        if (draw->programs[i]) glDeleteProgram(draw->programs[i]);
    }
    for (size_t i = 0; i < draw->mesh_count; i++) render_mesh_destroy(&draw->meshes[i]);
    free(draw->meshes);
    render_instances_destroy(&draw->balls);
    render_instances_destroy(&draw->particles);
    render_instances_destroy(&draw->lines);
    render_shape_destroy(&draw->disc);
    render_shape_destroy(&draw->square);
    render_shape_destroy(&draw->sphere);
    render_shape_destroy(&draw->pearl);
    render_shape_destroy(&draw->grain);
    render_solids_destroy(&draw->solids);
    render_flight_destroy(&draw->flight);
    render_paints_destroy(&draw->paints);
    render_light_destroy(&draw->light);
    glDeleteVertexArrays(1, &draw->no_arrays);
    glDeleteBuffers(1, &draw->uniforms);
    free(draw);
}

void render_draw_in_parts(render_draw *draw, size_t triangles) {
    draw->part = triangles;
}

void render_draw_line_scale(render_draw *draw, double scale) {
    draw->line_scale = scale;
}

/* ---- Bringing a frame to the card ----------------------------------------------------------- */

static skein_status bring_surfaces(render_draw *draw, const render_frame *frame, skein_error *error) {
    if (frame->surface_count > draw->mesh_count) {
        render_mesh *meshes = realloc(draw->meshes, frame->surface_count * sizeof *meshes);
        if (!meshes) return render_fail_memory(error, "the surfaces");
        memset(meshes + draw->mesh_count, 0, (frame->surface_count - draw->mesh_count) * sizeof *meshes);
        draw->meshes = meshes;
        draw->mesh_count = frame->surface_count;
    }
    for (size_t i = 0; i < frame->surface_count; i++) {
        skein_status status = render_mesh_update(&draw->meshes[i], &frame->surfaces[i], error);
        if (status != SKEIN_OK) return status;
    }
    return SKEIN_OK;
}

/* Few particles are spheres; many are the domes of spheres, turned to the viewer. */
static skein_status bring_particles(render_draw *draw, const drawing *d, skein_error *error) {
    double right[3], up[3], back[3], rotation[9];
    size_t count = 0;
    for (size_t i = 0; i < d->frame->points_count; i++) count += d->frame->points[i].count;
    render_camera_axes(d->camera, right, up, back);
    for (int k = 0; k < 3; k++) rotation[3 * k] = right[k], rotation[3 * k + 1] = up[k], rotation[3 * k + 2] = back[k];
    draw->particle_shape = count > many_particles ? &draw->grain : &draw->pearl;
    render_instances_take_shape(&draw->particles, draw->particle_shape);
    return render_instances_bring_points(&draw->particles, d->frame, rotation, error);
}

static skein_status bring(render_draw *draw, const drawing *d, skein_error *error) {
    skein_status status = bring_surfaces(draw, d->frame, error);
    if (status == SKEIN_OK) status = render_instances_bring_spheres(&draw->balls, d->frame, error);
    if (status == SKEIN_OK) status = render_solids_bring(&draw->solids, d->frame, error);
    if (status == SKEIN_OK) status = bring_particles(draw, d, error);
    if (status == SKEIN_OK) status = render_flight_bring(&draw->flight, d->frame, error);
    if (status == SKEIN_OK) status = render_instances_bring_lines(&draw->lines, d->frame, error);
    if (status == SKEIN_OK) status = render_paints_bring(&draw->paints, d->frame, error);
    return status;
}

/* The scene block, but for what belongs to the light maps. */
static void fill_block(drawing *d, const double sun[3], double tangent) {
    static const float white[3] = {1.0f, 0.975f, 0.935f};
    const render_look *look = &d->frame->look;
    render_scene_block *block = &d->block;
    double tall = tan(0.5 * d->camera->fov * degree), wide = tall * d->width / d->height;
    double right[3], up[3], back[3];

    render_camera_axes(d->camera, right, up, back);
    render_store(d->camera->eye, 1, block->eye);
    for (int k = 0; k < 3; k++) {
        block->view_right[k] = (float)(right[k] * wide);
        block->view_up[k] = (float)(up[k] * tall);
        block->view_forward[k] = (float)-back[k];
    }
    block->view_right[3] = 2.0f / (float)d->width;
    block->view_up[3] = 2.0f / (float)d->height;
    render_store(sun, tangent, block->sun);
    render_store(d->middle, d->radius, block->middle);
    render_to_light(white, 1.27f, block->sun_light);
    block->sun_light[3] = (float)look->exposure;
    render_to_light(look->zenith, 1, block->zenith);
    render_to_light(look->horizon, 1, block->horizon);
    render_to_light(look->ground, 1, block->ground);
    block->ground[3] = (float)d->ground;

    size_t balls = d->frame->sphere_count < RENDER_BALL_COUNT ? d->frame->sphere_count : RENDER_BALL_COUNT;
    for (size_t i = 0; i < balls; i++) {
        render_store(d->frame->spheres[i].centre, d->frame->spheres[i].radius, block->balls[i]);
    }
    block->counts[0] = look->plain ? 0 : (int32_t)balls;
    block->counts[1] = search_taps, block->counts[2] = edge_taps, block->counts[3] = rim_taps;
    block->modes[0] = look->plain, block->modes[1] = look->grid;
}

static void send_matrix(const render_draw *draw, render_pass pass, const double matrix[16]) {
    float numbers[16];
    for (int i = 0; i < 16; i++) numbers[i] = (float)matrix[i];
    glNamedBufferSubData(draw->uniforms, pass * RENDER_PASS_STRIDE, sizeof numbers, numbers);
}

/* Works out light, camera and matrices, and sends them. */
static void aim(render_draw *draw, drawing *d) {
    double sun[3], view[16], projection[16], camera[16], to_sun[16], to_below[16];
    render_bounds finite = render_frame_bounds(d->frame);
    double tangent = tan(d->frame->look.sun_spread * degree);

    d->radius = render_bounds_radius(&finite);
    if (d->radius < 1e-9) d->radius = 1;
    render_bounds_centre(&finite, d->middle);
    if (d->frame->radius > 0) {
        d->radius = d->frame->radius;
        memcpy(d->middle, d->frame->middle, sizeof d->middle);
    }
    d->has_ground = render_find_ground(d->frame, &d->ground);
    for (int k = 0; k < 3; k++) sun[k] = d->frame->look.sun[k];
    render_normalise(sun);
    fill_block(d, sun, tangent);

    render_bounds shading = finite;
    render_bounds_add_slabs(&shading, d->frame, d->middle, d->radius);
    if (d->frame->look.plain) shading = render_bounds_nothing(); // nothing casts a shadow
    render_light_aim(&draw->light, sun, tangent, &shading, d->has_ground ? &d->ground : NULL, &d->block, to_sun,
                     to_below);
    render_camera_view(d->camera, view);
    render_camera_projection(d->camera, (double)d->width / d->height, projection);
    render_multiply(projection, view, camera);
    send_matrix(draw, RENDER_PASS_CAMERA, camera);
    send_matrix(draw, RENDER_PASS_SUN, to_sun);
    send_matrix(draw, RENDER_PASS_BELOW, to_below);
    glNamedBufferSubData(draw->uniforms, RENDER_SCENE_OFFSET, sizeof d->block, &d->block);
}

/* ---- Drawing -------------------------------------------------------------------------------- */

static void draw_shape(const render_shape *shape, GLuint arrays, size_t instance_count) {
    glBindVertexArray(arrays);
    glDrawElementsInstanced(GL_TRIANGLES, shape->index_count, GL_UNSIGNED_SHORT, NULL, (GLsizei)instance_count);
}

/* The ground, or a slab whose grid is shifted. */
static void draw_plane(const render_draw *draw, int twin, const render_shape *shape, const double vectors[4][3],
                       double cell, const float *shift) {
    GLuint program = draw->programs[PLANE + twin];
    glUseProgram(program);
    for (GLint i = 0; i < (twin ? 3 : 4); i++) {
        glProgramUniform3f(program, i, (float)vectors[i][0], (float)vectors[i][1], (float)vectors[i][2]);
    }
    if (!twin) {
        glProgramUniform1f(program, 4, (float)cell);
        glProgramUniform1i(program, 5, !shift);
        if (shift) glProgramUniform2fv(program, 6, 1, shift);
    }
    draw_shape(shape, shape->arrays, 1);
}

/* How far a slab's middle is from where its grid was laid, within five cells: then its lines come again. */
static void shift_of(const drawing *d, const double vectors[4][3], double cell, float shift[2]) {
    double off[3] = {0, 0, 0};
    for (int k = 0; k < 3 && d->frame->radius > 0; k++) off[k] = d->middle[k] - d->frame->anchor[k];
    for (int a = 0; a < 2; a++) {
        const double *side = vectors[1 + a];
        shift[a] = (float)fmod(render_dot(off, side) / sqrt(render_dot(side, side)), 5 * cell);
    }
}

static void draw_slabs(const render_draw *draw, const drawing *d, int twin) {
    for (size_t i = 0; i < d->frame->plane_count; i++) {
        double vectors[4][3];
        if (render_plane_level(&d->frame->planes[i])) continue;
        render_place_slab(&d->frame->planes[i], d->middle, d->radius, vectors);
        double cell = render_grid_cell(d->radius);
        float shift[2];
        shift_of(d, (const double(*)[3])vectors, cell, shift);
        draw_plane(draw, twin, &draw->square, (const double(*)[3])vectors, cell, shift);
    }
}

static void draw_ground(const render_draw *draw, const drawing *d) {
    // from beneath there is no ground to see
    if (!d->has_ground || d->camera->eye[1] <= d->ground) return;
    double size = ground_size * d->radius;
    const double vectors[4][3] = {{d->middle[0], d->ground, d->middle[2]}, {size, 0, 0}, {0, 0, -size}, {0, 1, 0}};
    draw_plane(draw, 0, &draw->disc, vectors, render_grid_cell(d->radius), NULL);
}

/* How thick a body is, and a little more, so that few corners are left outside: for light that goes through. */
static void set_body(GLuint program, const render_mesh *mesh) {
    const double corners = 1.2, largest = fmax(fmax(mesh->spread[0], mesh->spread[1]), mesh->spread[2]);
    double thin = INFINITY;
    float middle[3], curve[3];
    for (int k = 0; k < 3; k++) {
        double half = fmax(fmax(corners * mesh->spread[k], 0.02 * largest), 1e-9);
        thin = fmin(thin, half);
        middle[k] = (float)mesh->middle[k];
        curve[k] = (float)(1 / half);
    }
    glProgramUniform3fv(program, 9, 1, middle);
    glProgramUniform3fv(program, 10, 1, curve);
    glProgramUniform1f(program, 11, (float)thin);
}

static void draw_surfaces(const render_draw *draw, const drawing *d, int twin) {
    for (size_t i = 0; i < d->frame->surface_count; i++) {
        const render_mesh *mesh = &draw->meshes[i];
        bool glazed = !twin && d->frame->surfaces[i].material.glazed;
        bool fine = !twin && !glazed && render_mesh_edge_pixels(mesh, d->camera, d->height) < fine_edge;
        GLuint program = draw->programs[fine ? FINE_SURFACE : glazed ? GLAZED_SURFACE : SURFACE + twin];
        glUseProgram(program);
        if (!twin) {
            glProgramUniform1f(program, 0, lift);
            render_set_material(program, &d->frame->surfaces[i]);
            if (glazed) set_body(program, mesh);
        }
        glBindVertexArray(mesh->arrays);
        size_t part = draw->part ? draw->part : mesh->triangle_count;
        for (size_t t = 0; t < mesh->triangle_count; t += part) {
            size_t count = mesh->triangle_count - t < part ? mesh->triangle_count - t : part;
            const void *begin = (const void *)(uintptr_t)(3 * t * sizeof(uint32_t)); // an offset
            glDrawElements(GL_TRIANGLES, (GLsizei)(3 * count), GL_UNSIGNED_INT, begin);
            if (draw->part) glFinish();
        }
    }
}

static void draw_balls(const render_draw *draw, int twin) {
    GLuint program = draw->programs[BALL + twin];
    bool fine = !twin && draw->particle_shape == &draw->grain;
    glUseProgram(program);
    glEnable(GL_CULL_FACE);
    if (!twin) glProgramUniform1i(program, 1, 1);
    if (draw->balls.count > 0) draw_shape(&draw->sphere, draw->balls.arrays, draw->balls.count);
    if (!twin) glProgramUniform1i(program, 1, 0);
    if (fine) glUseProgram(draw->programs[FINE_BALL]);
    if (draw->particles.count > 0) draw_shape(draw->particle_shape, draw->particles.arrays, draw->particles.count);
    glDisable(GL_CULL_FACE);
}

/* All that stands between a light and the ground. */
static void draw_casters(const render_draw *draw, const drawing *d) {
    draw_surfaces(draw, d, DEPTH_ONLY);
    draw_balls(draw, DEPTH_ONLY);
    render_flight_draw(&draw->flight, d->frame, true, draw->part);
    render_solids_draw_depth(&draw->solids, d->frame);
}

static void use_pass(const render_draw *draw, render_pass pass) {
    glBindBufferRange(GL_UNIFORM_BUFFER, 1, draw->uniforms, pass * RENDER_PASS_STRIDE, 16 * sizeof(float));
}

/* Both maps of the light: nothing but depth is kept. */
static void draw_light(const render_draw *draw, const drawing *d) {
    if (render_light_begin_sun(&draw->light)) {
        use_pass(draw, RENDER_PASS_SUN);
        draw_casters(draw, d);
        draw_slabs(draw, d, DEPTH_ONLY);
    }
    if (draw->part) glFinish();
    if (render_light_begin_below(&draw->light)) {
        use_pass(draw, RENDER_PASS_BELOW);
        draw_casters(draw, d);
        render_light_end_below(&draw->light);
    }
    if (draw->part) glFinish();
}

/* What covers much of a picture, with few triangles. */
static void draw_still(const render_draw *draw, const drawing *d) {
    render_solids_draw(&draw->solids, d->frame);
    draw_slabs(draw, d, 0);
    draw_ground(draw, d);
}

/* The sky fills what is left, so that colours need no clearing. */
static void draw_sky(const render_draw *draw, const drawing *d) {
    (void)d;
    glDepthFunc(GL_GEQUAL);
    glUseProgram(draw->programs[SKY]);
    glBindVertexArray(draw->no_arrays);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glDepthFunc(GL_GREATER);
}

/* Where a picture is drawn in parts, those are parts of its height here, for what may be drawn twice: they overlap,
 * since llvmpipe leaves samples out along a scissor's edge. */
static void in_bands(const render_draw *draw, const drawing *d, void (*part)(const render_draw *, const drawing *)) {
    if (!draw->part) {
        part(draw, d);
        return;
    }
    glEnable(GL_SCISSOR_TEST);
    for (int y = 0; y < d->height; y += band_height) {
        glScissor(0, y - overlap, d->width, band_height + 2 * overlap);
        part(draw, d);
        glFinish();
    }
    glDisable(GL_SCISSOR_TEST);
}

static void draw_picture(const render_draw *draw, const drawing *d, unsigned framebuffer) {
    static const float nearest_nothing = 0.0f;
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    glViewport(0, 0, d->width, d->height);
    glEnable(GL_MULTISAMPLE);
    glDisable(GL_DEPTH_CLAMP);
    glDepthMask(GL_TRUE);
    glClearBufferfv(GL_DEPTH, 0, &nearest_nothing);

    // what hides most comes first (depth alone in a pass before saved nothing, on llvmpipe)
    use_pass(draw, RENDER_PASS_CAMERA);
    render_light_bind(&draw->light);
    render_paints_bind(&draw->paints);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_GREATER);
    draw_surfaces(draw, d, 0);
    draw_balls(draw, 0);
    render_flight_draw(&draw->flight, d->frame, false, draw->part);
    in_bands(draw, d, draw_still);
    render_instances_draw_lines(&draw->lines, draw->programs[LINE], d->frame, (double)d->width / draw->line_scale,
                                (double)d->height / draw->line_scale, draw->part);
    in_bands(draw, d, draw_sky);
    render_solids_draw_glass(&draw->solids, d->frame);
}

skein_status render_draw_frame(render_draw *draw, const render_frame *frame, const render_camera *camera,
                               unsigned framebuffer, int width, int height, skein_error *error) {
    drawing d = {.frame = frame, .camera = camera, .width = width, .height = height};
    skein_status status = bring(draw, &d, error);
    if (status != SKEIN_OK) return status;
    aim(draw, &d);

    // whatever a window's panels left behind
    glDisable(GL_BLEND);
    glDisable(GL_CULL_FACE);
    glDisable(GL_SCISSOR_TEST);
    glDisable(GL_STENCIL_TEST);
    glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glEnable(GL_FRAMEBUFFER_SRGB);
    glClipControl(GL_LOWER_LEFT, GL_ZERO_TO_ONE);
    glBindBufferRange(GL_UNIFORM_BUFFER, 0, draw->uniforms, RENDER_SCENE_OFFSET, sizeof d.block);

    draw_light(draw, &d);
    draw_picture(draw, &d, framebuffer);
    glBindSampler(0, 0);
    glClipControl(GL_LOWER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
    return SKEIN_OK;
}
