/* Questions about where things are: rays against surfaces and colliders, particles near a point or a ray.
 *
 * All look at everything there is, once: some milliseconds for half a million faces. Only read. */
#include <math.h>

#include "world/cut.h"

static double dot(const double a[3], const double b[3]) {
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void cross(const double a[3], const double b[3], double out[3]) {
    double x = a[1] * b[2] - a[2] * b[1], y = a[2] * b[0] - a[0] * b[2], z = a[0] * b[1] - a[1] * b[0];
    out[0] = x, out[1] = y, out[2] = z;
}

static void position_of(const skein_world *world, size_t particle, double x[3]) {
    sk_world_fetch(world); // a device's positions come once; a failure stands in the world's error
    sk_vec4 p = world->particles.vector[SK_X][world->particles.slot_of[particle]];
    x[0] = (double)p.x, x[1] = (double)p.y, x[2] = (double)p.z;
}

/* The direction with length 1. */
static skein_status check_ray(const skein_world *world, const double origin[3], const double direction[3],
                              double along[3]) {
    double most = 0;
    bool good = true;
    for (int k = 0; k < 3; k++) {
        good &= origin[k] >= -SK_FAR && origin[k] <= SK_FAR && direction[k] >= -SK_FAR && direction[k] <= SK_FAR;
        most = fmax(most, fabs(direction[k]));
    }
    if (!good || !(most > 0))
        return sk_fail(sk_world_error(world), SKEIN_ERROR_VALUE, "direction",
                       "a ray needs finite numbers under 1e15, and a direction that is not 0");
    for (int k = 0; k < 3; k++) along[k] = direction[k] / most;
    double length = sqrt(dot(along, along));
    for (int k = 0; k < 3; k++) along[k] /= length;
    return SKEIN_OK;
}

/* ---- Bodies ---- */

/* Where the ray meets a triangle from either side; infinity if it does not (Moeller, Trumbore 1997). */
static double meet_triangle(const double origin[3], const double along[3], double corner[3][3]) {
    double u[3], v[3], p[3], q[3], s[3];
    for (int k = 0; k < 3; k++) {
        u[k] = corner[1][k] - corner[0][k], v[k] = corner[2][k] - corner[0][k];
        s[k] = origin[k] - corner[0][k];
    }
    cross(along, v, p);
    double det = dot(u, p);
    if (!(fabs(det) > 0)) return INFINITY;
    double a = dot(s, p) / det;
    cross(s, u, q);
    double b = dot(along, q) / det, t = dot(v, q) / det;
    return a >= 0 && b >= 0 && a + b <= 1 && t >= 0 ? t : INFINITY;
}

static void note_face(const double along[3], double corner[3][3], skein_hit *hit) {
    double u[3], v[3], n[3];
    for (int k = 0; k < 3; k++) u[k] = corner[1][k] - corner[0][k], v[k] = corner[2][k] - corner[0][k];
    cross(u, v, n);
    double length = sqrt(dot(n, n)), side = dot(n, along) > 0 ? -1 : 1;
    for (int k = 0; k < 3; k++) hit->normal[k] = length > 0 ? side * n[k] / length : -along[k];
}

static void cast_at_body(const skein_world *world, const sk_body *body, const double origin[3], const double along[3],
                         skein_handle handle, skein_hit *hit) {
    const uint32_t *face = body->face_vertices;
    for (size_t f = 0; f < body->face_count; face += body->face_sizes[f++]) {
        if (sk_is_cut(body, f)) continue;
        double corner[3][3];
        position_of(world, body->particle_of_vertex[face[0]], corner[0]);
        for (uint32_t c = 2; c < body->face_sizes[f]; c++) {
            position_of(world, body->particle_of_vertex[face[c - 1]], corner[1]);
            position_of(world, body->particle_of_vertex[face[c]], corner[2]);
            double t = meet_triangle(origin, along, corner), nearest = INFINITY;
            if (!(t < hit->t)) continue;
            hit->t = t;
            hit->object = handle;
            hit->face = f;
            for (int k = 0; k < 3; k++) hit->point[k] = origin[k] + t * along[k];
            note_face(along, corner, hit);
            for (uint32_t n = 0; n < body->face_sizes[f]; n++) {
                double x[3], off[3];
                position_of(world, body->particle_of_vertex[face[n]], x);
                for (int k = 0; k < 3; k++) off[k] = x[k] - hit->point[k];
                if (dot(off, off) < nearest) nearest = dot(off, off), hit->particle = body->particle_of_vertex[face[n]];
            }
        }
    }
}

/* ---- Colliders ---- */

static void cast_at_collider(const skein_world *world, const sk_collider *collider, const double origin[3],
                             const double along[3], skein_handle handle, skein_hit *hit) {
    double normal[3] = {0, 0, 0}, t = sk_collider_cast(collider, world->time, origin, along, fmin(hit->t, 1e9), normal);
    if (!(t < hit->t)) return;
    hit->t = t;
    hit->object = handle;
    hit->face = 0;
    hit->particle = UINT32_MAX;
    for (int k = 0; k < 3; k++) hit->point[k] = origin[k] + t * along[k], hit->normal[k] = normal[k];
}

skein_status skein_ray_cast(const skein_world *world, const double origin[3], const double direction[3],
                            skein_category category, skein_hit *hit) {
    SK_NEED(world, world);
    SK_NEED(world, origin);
    SK_NEED(world, direction);
    SK_NEED(world, hit);
    double along[3];
    *hit = (skein_hit){.t = INFINITY};
    if (category != SKEIN_BODY && category != SKEIN_COLLIDER)
        return sk_fail(sk_world_error(world), SKEIN_ERROR_VALUE, "category", "rays meet bodies and colliders, no %s",
                       skein_category_text(category));
    skein_status status = check_ray(world, origin, direction, along);
    if (!status) status = sk_world_fetch(world);
    if (status) return status;
    for (size_t i = 0; i < world->objects.count; i++) {
        const sk_object *object = world->objects.data[i];
        if (object->category != category) continue;
        skein_handle handle = sk_handle_at(world, i);
        if (category == SKEIN_BODY && object->common.plain.visible && object->common.plain.enabled)
            cast_at_body(world, object->as.body, origin, along, handle, hit);
        if (category == SKEIN_COLLIDER && object->common.collider.visible && object->common.collider.enabled)
            cast_at_collider(world, object->as.collider, origin, along, handle, hit);
    }
    return SKEIN_OK;
}

/* ---- Particles ---- */

static skein_status check_particles(const skein_world *world) {
    if (world->particles.count == world->particles.out_count - world->particles.asleep_count)
        return sk_fail(sk_world_error(world), SKEIN_ERROR_VALUE, "", "the world has no particles");
    return sk_world_fetch(world);
}

skein_status skein_particle_near_point(const skein_world *world, const double point[3], uint32_t *particle,
                                       double *metres) {
    SK_NEED(world, world);
    SK_NEED(world, point);
    SK_NEED(world, particle);
    skein_status status = check_particles(world);
    if (status) return status;
    double nearest = INFINITY;
    *particle = 0;
    for (size_t i = 0; i < world->particles.count; i++) {
        double x[3], off[3];
        if (!sk_particle_counts(&world->particles, i)) continue;
        position_of(world, i, x);
        for (int k = 0; k < 3; k++) off[k] = x[k] - point[k];
        if (dot(off, off) < nearest) nearest = dot(off, off), *particle = (uint32_t)i;
    }
    if (metres) *metres = sqrt(nearest);
    return SKEIN_OK;
}

skein_status skein_particle_near_ray(const skein_world *world, const double origin[3], const double direction[3],
                                     double radius, double slope, uint32_t *particle, double *t) {
    SK_NEED(world, world);
    SK_NEED(world, origin);
    SK_NEED(world, direction);
    SK_NEED(world, particle);
    SK_NEED(world, t);
    double along[3], best = 1;
    *t = INFINITY;
    *particle = UINT32_MAX;
    skein_status status = check_ray(world, origin, direction, along);
    if (status) return status;
    if (!(radius >= 0) || !(slope >= 0) || !(radius + slope > 0))
        return sk_fail(sk_world_error(world), SKEIN_ERROR_VALUE, "radius",
                       "radius %g m and slope %g: expected 0 or more, and one of them more", radius, slope);
    status = sk_world_fetch(world);
    if (status) return status;
    for (size_t i = 0; i < world->particles.count; i++) {
        double x[3], off[3];
        if (!sk_particle_counts(&world->particles, i)) continue;
        position_of(world, i, x);
        for (int k = 0; k < 3; k++) off[k] = x[k] - origin[k];
        double ahead = dot(off, along);
        if (!(ahead > 0)) continue;
        for (int k = 0; k < 3; k++) off[k] -= ahead * along[k];
        double measure = sqrt(dot(off, off)) / (radius + slope * ahead);
        // of those that are equally near, the one in front
        if (measure > best || (measure == best && *particle != UINT32_MAX && ahead >= *t)) continue;
        best = measure;
        *t = ahead;
        *particle = (uint32_t)i;
    }
    return SKEIN_OK;
}
