/* Wind on triangles: drag along the air's velocity, lift across it (after Keckeisen and others 2004).
 *
 *   u  the air's velocity past the triangle        n  the unit normal, turned to u.n >= 0
 *   F = 1/2 rho A ((drag - lift) (u.n) u + lift |u|^2 n (u.n)/|u|),   a third to each corner
 *
 * A triangle edge-on to the wind feels nothing; one square to it feels drag alone. */
#include "forces/force.h"

typedef struct surface_wind_params {
    double velocity[3], drag, lift, density;
} surface_wind_params;

static const skein_field fields[] = {
    SK_VEC3(surface_wind_params, velocity, "velocity", "m/s", 0, 0, 0, "the air's velocity; 0 is still air"),
    SK_REAL(surface_wind_params, drag, "drag", "", 1.0, 0, 100, "coefficient of the part along the wind"),
    SK_REAL(surface_wind_params, lift, "lift", "", 0.4, 0, 100, "coefficient of the part along the normal"),
    SK_REAL(surface_wind_params, density, "density", "kg/m3", 1.2, 0, 1e4, "of the air"),
};

static void kernel(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    const surface_wind_params *params = ((const sk_force *)row->rule)->params;
    const sk_vec4 *x = run->vector[SK_X], *v = run->vector[SK_V];
    sk_vec4 *f = run->vector[row->dst];
    sk_vec3 wind = sk_v3_of(params->velocity);
    real drag = (real)params->drag, lift = (real)params->lift, third = (real)1 / 3;
    real half_density = (real)(0.5 * params->density);
    for (size_t t = begin; t < end; t++) {
        const uint32_t *c = run->triangles->corner[t];
        sk_vec3 p[3], moving = {0, 0, 0};
        for (int k = 0; k < 3; k++) {
            p[k] = sk_xyz(sk_load(x, row->packed, c[k]));
            moving = sk_add(moving, sk_xyz(sk_load(v, row->packed, c[k])));
        }
        sk_vec3 flow = sk_sub(wind, sk_scale(third, moving));
        // twice the area along the normal; |across| = |u| 2 A cos(angle)
        sk_vec3 normal = sk_cross(sk_sub(p[1], p[0]), sk_sub(p[2], p[0]));
        real twice_area = sk_length(normal), speed = sk_length(flow);
        if (!(twice_area > 0) || !(speed > 0)) continue;
        real across = sk_dot(normal, flow);
        real sign = across < 0 ? (real)-1 : (real)1;
        real along = half_density * (drag - lift) * (sign * across) * (real)0.5;
        real lifting = half_density * lift * speed * across * (real)0.5 / twice_area;
        sk_vec3 share = sk_scale(third, sk_add(sk_scale(along, flow), sk_scale(lifting, normal)));
        for (int k = 0; k < 3; k++) sk_add_at(f, row->packed, c[k], share);
    }
}

const sk_force_type sk_surface_wind = {
    .kind = {"surface_wind", "wind by triangle: lift and drag from its normal and its velocity through the air",
             SKEIN_FORCE, fields, sizeof fields / sizeof *fields, sizeof(surface_wind_params)},
    .domain = SK_OVER_TRIANGLES,
    .on_velocity = true,
    .kernel = {SK_ANY_ISA(kernel)},
};
