/* How planes are shown; see planes.h. */
#include "render/planes.h"

#include "render/linear.h"

/* Radii of the scene from a slab's middle to its side. */
static const double slab_size = 1.1;

bool render_plane_level(const render_plane *plane) {
    double length = sqrt(render_dot(plane->normal, plane->normal));
    return plane->normal[1] > 0.9999 * length;
}

bool render_find_ground(const render_frame *frame, double *height) {
    bool found = frame->look.floor;
    *height = frame->look.floor_height;
    for (size_t i = 0; i < frame->plane_count; i++) {
        const render_plane *plane = &frame->planes[i];
        if (!render_plane_level(plane)) continue;
        if (!found || plane->point[1] > *height) *height = plane->point[1];
        found = true;
    }
    return found;
}

void render_place_slab(const render_plane *plane, const double middle[3], double radius, double vectors[4][3]) {
    double off[3], side = slab_size * radius, *normal = vectors[3];
    for (int k = 0; k < 3; k++) normal[k] = plane->normal[k], off[k] = plane->point[k] - middle[k];
    render_normalise(normal);
    render_basis(normal, vectors[1], vectors[2]);

    // the scene's middle, brought on to the plane
    double distance = render_dot(off, normal);
    for (int k = 0; k < 3; k++) {
        vectors[0][k] = middle[k] + distance * normal[k];
        vectors[1][k] *= side, vectors[2][k] *= side;
    }
}

void render_bounds_add_slabs(render_bounds *bounds, const render_frame *frame, const double middle[3], double radius) {
    for (size_t i = 0; i < frame->plane_count; i++) {
        double v[4][3];
        if (render_plane_level(&frame->planes[i])) continue;
        render_place_slab(&frame->planes[i], middle, radius, v);
        for (int c = 0; c < 4; c++) {
            double corner[3], along = c & 1 ? 1 : -1, across = c & 2 ? 1 : -1;
            for (int k = 0; k < 3; k++) corner[k] = v[0][k] + along * v[1][k] + across * v[2][k];
            render_bounds_add(bounds, corner, 0);
        }
    }
}

double render_grid_cell(double radius) {
    double about = 0.25 * radius, power = pow(10, floor(log10(about))), times = about / power;
    return power * (times < 2 ? 1 : times < 5 ? 2 : 5);
}
