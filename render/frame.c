/* Frames: the defaults, which decide how everything looks, and the box around a frame. See frame.h. */
#include "render/frame.h"

#include <math.h>
#include <string.h>

/* ---- Defaults ------------------------------------------------------------------------------- */

render_look render_default_look(void) {
    /* A late morning in a bright room: the sun high on the left, the sky pale. */
    return (render_look){
        .sun = {-0.62, 0.86, 0.42},
        .sun_spread = 2.2,
        .zenith = {0.30f, 0.56f, 0.82f},
        .horizon = {0.915f, 0.925f, 0.925f},
        .ground = {0.755f, 0.727f, 0.69f},
        .exposure = 1.0,
        .grid = true,
        .floor = false,
        .floor_height = 0.0,
    };
}

render_frame render_default_frame(void) {
    render_frame frame;
    memset(&frame, 0, sizeof frame);
    frame.look = render_default_look();
    return frame;
}

render_material render_default_material(size_t index) {
    static const float colours[6][3] = {
        {0.790f, 0.255f, 0.165f}, /* terracotta */
        {0.925f, 0.640f, 0.200f}, /* saffron */
        {0.250f, 0.560f, 0.560f}, /* sea */
        {0.560f, 0.330f, 0.520f}, /* plum */
        {0.470f, 0.600f, 0.330f}, /* moss */
        {0.360f, 0.470f, 0.700f}, /* denim */
    };
    static const float cream[3] = {0.965f, 0.905f, 0.815f};
    render_material material;
    memset(&material, 0, sizeof material);
    for (int i = 0; i < 3; i++) {
        float colour = colours[index % 6][i];
        material.colour[i] = colour;
        material.accent[i] = cream[i];
        material.lining[i] = colour * 0.92f;
    }
    material.pattern = RENDER_WEAVE;
    material.repeats[0] = material.repeats[1] = 20.0f;
    material.translucency = 0.3f;
    return material;
}

render_material render_plain_material(size_t index) {
    render_material material = render_default_material(index);
    material.pattern = RENDER_PLAIN;
    for (int i = 0; i < 3; i++) {
        material.colour[i] += 0.28f * (material.accent[i] - material.colour[i]);
        material.lining[i] = material.colour[i] * 0.92f;
    }
    return material;
}

render_material render_jelly_material(size_t index) {
    render_material material = render_default_material(index);
    material.pattern = RENDER_PLAIN;
    material.glazed = true;
    for (int i = 0; i < 3; i++) material.lining[i] = material.colour[i];
    return material;
}

/* The paint of colliders, and its marking. */
#define PAINT \
    { 0.150f, 0.330f, 0.400f }
#define MARKING \
    { 0.930f, 0.890f, 0.800f }
#define NOT_TURNED \
    { 1, 0, 0, 0, 1, 0, 0, 0, 1 }

render_sphere render_default_sphere(void) {
    return (render_sphere){.radius = 1, .rotation = NOT_TURNED, .colour = PAINT, .marking = MARKING};
}

render_solid render_default_solid(void) {
    return (render_solid){
        .extent = {0.94, 0.94, 0.94}, .radius = 0.06, .rotation = NOT_TURNED, .colour = PAINT, .marking = MARKING};
}

const double render_bowl_height = 0.577382, render_bowl_width = 0.906308; // 65 degrees from the lowest point up

render_bowl render_default_bowl(void) {
    return (render_bowl){.radius = 1, .rotation = NOT_TURNED, .colour = PAINT, .marking = MARKING};
}

/* ---- Bounds --------------------------------------------------------------------------------- */

render_bounds render_bounds_nothing(void) {
    return (render_bounds){{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}};
}

bool render_bounds_empty(const render_bounds *bounds) {
    return !(bounds->least[0] <= bounds->most[0]);
}

void render_bounds_add(render_bounds *bounds, const double point[3], double radius) {
    if (!isfinite(point[0]) || !isfinite(point[1]) || !isfinite(point[2]) || !isfinite(radius)) return;
    for (int i = 0; i < 3; i++) {
        bounds->least[i] = fmin(bounds->least[i], point[i] - radius);
        bounds->most[i] = fmax(bounds->most[i], point[i] + radius);
    }
}

double render_bounds_radius(const render_bounds *bounds) {
    if (render_bounds_empty(bounds)) return 0;
    double sum = 0;
    for (int i = 0; i < 3; i++) {
        double side = bounds->most[i] - bounds->least[i];
        sum += side * side;
    }
    return 0.5 * sqrt(sum);
}

void render_bounds_centre(const render_bounds *bounds, double centre[3]) {
    bool empty = render_bounds_empty(bounds);
    for (int i = 0; i < 3; i++) centre[i] = empty ? 0 : 0.5 * (bounds->least[i] + bounds->most[i]);
}

static void add_solid(render_bounds *bounds, const render_solid *solid) {
    for (int corner = 0; corner < 8; corner++) {
        double point[3];
        for (int r = 0; r < 3; r++) {
            point[r] = solid->centre[r];
            for (int c = 0; c < 3; c++)
                point[r] += solid->rotation[3 * r + c] * (corner >> c & 1 ? solid->extent[c] : -solid->extent[c]);
        }
        render_bounds_add(bounds, point, solid->radius);
    }
}

static void add_bowl(render_bounds *bounds, const render_bowl *bowl) {
    double wide = render_bowl_width * bowl->radius, point[3];
    for (int corner = 0; corner < 4; corner++) {
        point[0] = bowl->centre[0] + (corner & 1 ? wide : -wide);
        point[1] = bowl->centre[1] - bowl->radius * (corner & 2 ? 1 : 1 - render_bowl_height);
        point[2] = bowl->centre[2] + (corner & 1 ? wide : -wide);
        render_bounds_add(bounds, point, 0);
    }
}

render_bounds render_frame_bounds(const render_frame *frame) {
    render_bounds bounds = render_bounds_nothing();
    for (size_t i = 0; i < frame->bird_count; i++) {
        if (!frame->birds[i].count) continue;
        render_bounds_add(&bounds, frame->birds[i].least, 0.5 * frame->birds[i].span);
        render_bounds_add(&bounds, frame->birds[i].most, 0.5 * frame->birds[i].span);
    }
    for (size_t s = 0; s < frame->surface_count; s++) {
        const render_surface *surface = &frame->surfaces[s];
        for (size_t v = 0; v < surface->vertex_count && !surface->scenery; v++) {
            render_bounds_add(&bounds, &surface->positions[3 * v], 0);
        }
    }
    for (size_t s = 0; s < frame->sphere_count; s++) {
        render_bounds_add(&bounds, frame->spheres[s].centre, frame->spheres[s].radius);
    }
    for (size_t s = 0; s < frame->solid_count; s++) add_solid(&bounds, &frame->solids[s]);
    for (size_t s = 0; s < frame->rod_count; s++) add_solid(&bounds, &frame->rods[s]);
    for (size_t s = 0; s < frame->bowl_count; s++) add_bowl(&bounds, &frame->bowls[s]);
    for (size_t s = 0; s < frame->points_count; s++) {
        const render_points *points = &frame->points[s];
        for (size_t p = 0; p < points->count; p++) {
            render_bounds_add(&bounds, &points->positions[3 * p], points->radius);
        }
    }
    for (size_t s = 0; s < frame->lines_count; s++) {
        const render_lines *lines = &frame->lines[s];
        if (lines->aside) continue;
        for (size_t p = 0; p < 2 * lines->count; p++) {
            render_bounds_add(&bounds, &lines->positions[3 * p], 0);
        }
    }
    return bounds;
}
