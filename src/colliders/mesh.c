/* A solid whose surface is a mesh: any triangles, moved and turned as a whole, or by a program.
 *
 * Points are taken into the mesh's own frame, and their nearest triangles found there (trimesh_near.h); distance and
 * normal are then worked out from the one that was found, in double. Contact asks only within its reach: what is
 * farther off, but for what is deep inside, costs a look at a few boxes. */
#include "colliders/mesh.h"
#include "base/kernels.h"
#include "base/rotation.h"
#include "base/status.h"

typedef sk_mesh_params mesh_params;

#define SK_UNIT mesh
SK_KERNELS(sk_probe, probe);
SK_KERNELS(sk_probe_near, near);

#ifdef SK_ISA
#include "colliders/trimesh_near.h"

/* Of the lanes in which nothing was found within `reach`: how far to look, squared; -1: no further, it is outside. */
static sk_wide look_further(const sk_trimesh *m, sk_wide3 p, sk_mask looked, sk_wide reach) {
    sk_mask lost = looked & (trimesh_box(&m->node[0], p) == (sk_wide){0});
    sk_wide further = sk_splat(-1);
    uint32_t bits = trimesh_bits(lost);
    for (int l = 0; l < SK_PART; l++) {
        if (!(bits >> l & 1)) continue;
        sk_trimesh_side side = sk_trimesh_side_of(m, (const real[3]){p.x[l], p.y[l], p.z[l]}, reach[l]);
        further[l] = side == SK_OUTSIDE ? -1 : side == SK_INSIDE ? (real)1e30 : m->cell_span * m->cell_span;
    }
    return further;
}

SK_INLINE sk_wide3 turned(const real r[9], sk_wide3 a) {
    return (sk_wide3){r[0] * a.x + r[1] * a.y + r[2] * a.z, r[3] * a.x + r[4] * a.y + r[5] * a.z,
                      r[6] * a.x + r[7] * a.y + r[8] * a.z};
}

SK_INLINE void ask(const void *data, const sk_pose *pose, const sk_wide3 *p, const sk_wide *reach, sk_contact *contact) {
    const mesh_params *params = data;
    const sk_trimesh *m = params->made;
    const real *r = pose->rotation, scale = (real)params->scale, per = (real)(1 / params->scale);
    sk_wide3 d = {p->x - pose->position.x, p->y - pose->position.y, p->z - pose->position.z};
    sk_wide3 own = {per * (r[0] * d.x + r[3] * d.y + r[6] * d.z), per * (r[1] * d.x + r[4] * d.y + r[7] * d.z),
                    per * (r[2] * d.x + r[5] * d.y + r[8] * d.z)};
    sk_wide best = sk_splat((real)1e30);
    sk_mask all = (sk_mask){0} - 1, found;
    if (reach) {
        best = *reach * per;
        best = sk_select(sk_negative(best), best, best * best);
    }
    sk_mask looked = reach ? ~sk_negative(best) : all;
    trimesh_near(m, own, &best, &found);
    for (int turn = 0; reach && turn < 2 && sk_any(looked & (found < 0)); turn++) {
        sk_wide within = turn ? sk_splat(m->cell_span) : *reach * per;
        sk_mask more;
        best = look_further(m, own, looked & (found < 0), within);
        if (!sk_any(~sk_negative(best))) break;
        trimesh_near(m, own, &best, &more);
        found = ((found < 0) & more) | (~(found < 0) & found);
    }
    contact->normal = (sk_wide3){{0}, sk_splat(1), {0}};
    contact->distance = sk_splat((real)SK_FAR), contact->speed = sk_splat(0);
    sk_wide3 n = contact->normal, slide = {{0}, {0}, {0}};
    for (int l = 0; l < SK_PART; l++) {
        if (found[l] < 0) continue;
        const real at[3] = {own.x[l], own.y[l], own.z[l]};
        sk_trimesh_spot spot;
        sk_trimesh_look(m, (uint32_t)found[l], at, &spot);
        n.x[l] = (real)spot.normal[0], n.y[l] = (real)spot.normal[1], n.z[l] = (real)spot.normal[2];
        contact->distance[l] = (real)spot.distance * scale, contact->speed[l] = (real)spot.speed * scale;
        slide.x[l] = (real)spot.slide[0] * scale, slide.y[l] = (real)spot.slide[1] * scale,
        slide.z[l] = (real)spot.slide[2] * scale;
    }
    contact->slide = turned(r, slide);
    contact->normal = turned(r, n);
}

void SK_KERNEL(probe)(const void *params, const sk_pose *pose, const sk_wide3 *p, sk_contact *contact) {
    ask(params, pose, p, NULL, contact);
}

void SK_KERNEL(near)(const void *params, const sk_pose *pose, const sk_wide3 *p, const sk_wide *reach,
                     sk_contact *contact) {
    ask(params, pose, p, reach, contact);
}

#else

static const skein_field fields[] = {SK_MESH_FIELDS(mesh_params)};

void sk_mesh_place(const void *data, double position[3]) {
    for (int k = 0; k < 3; k++) position[k] = ((const mesh_params *)data)->position[k];
}

void sk_mesh_turn(const void *data, double rotation[9]) {
    sk_rotation_of_degrees(((const mesh_params *)data)->rotation, rotation);
}

/* The mesh comes when the collider is added, and by no text. */
skein_status sk_mesh_make(void *data, const skein_kind *kind, sk_allocator *allocator, skein_error *error) {
    (void)kind, (void)allocator;
    if (!((const mesh_params *)data)->made) return SKEIN_OK;
    return sk_fail(error, SKEIN_ERROR_VALUE, "mesh",
                   "the mesh shapes what is already built: set it when the collider is added");
}

void sk_mesh_unmake(void *data, sk_allocator *allocator) {
    (void)allocator;
    sk_trimesh_destroy(((mesh_params *)data)->made);
}

skein_status sk_mesh_take(void *data, const skein_mesh *mesh, sk_allocator *allocator, sk_faults_text *faults,
                          skein_error *error) {
    mesh_params *params = data;
    skein_status status = sk_trimesh_create(mesh, allocator, &params->made, error);
    if (!status) sk_trimesh_faults(params->made, params->mesh, faults->text, sizeof faults->text);
    return status;
}

sk_trimesh *sk_mesh_surface(const void *data) {
    return ((const mesh_params *)data)->made;
}

double sk_mesh_scale(const void *data) {
    return ((const mesh_params *)data)->scale;
}

static bool is_shaped_by(const char *field) {
    return !__builtin_strcmp(field, "mesh");
}

static void begin(const void *data, double time, double dt) {
    sk_trimesh_begin(((const mesh_params *)data)->made, time, dt);
}

static double cross(const void *data, const sk_pose *pose, const double a[3], const double b[3], double normal[3]) {
    const mesh_params *params = data;
    const real *r = pose->rotation;
    const double place[3] = {(double)pose->position.x, (double)pose->position.y, (double)pose->position.z};
    double own[2][3], n[3];
    for (int k = 0; k < 3; k++) {
        own[0][k] = own[1][k] = 0;
        for (int i = 0; i < 3; i++) {
            own[0][k] += (double)r[3 * i + k] * (a[i] - place[i]) / params->scale;
            own[1][k] += (double)r[3 * i + k] * (b[i] - place[i]) / params->scale;
        }
    }
    double part = sk_trimesh_cross(params->made, own[0], own[1], n);
    for (int k = 0; k < 3 && part <= 1; k++)
        normal[k] = (double)r[3 * k] * n[0] + (double)r[3 * k + 1] * n[1] + (double)r[3 * k + 2] * n[2];
    return part;
}

static void ball(const void *data, const sk_pose *pose, sk_vec3 *middle, real *radius) {
    const mesh_params *params = data;
    const sk_tree_node *box = &params->made->node[0];
    const real *r = pose->rotation, half = (real)(0.5 * params->scale);
    sk_vec3 m = {half * (box->low[0] + box->high[0]), half * (box->low[1] + box->high[1]),
                 half * (box->low[2] + box->high[2])};
    sk_vec3 reach = {half * (box->high[0] - box->low[0]), half * (box->high[1] - box->low[1]),
                     half * (box->high[2] - box->low[2])};
    *middle = sk_add(pose->position, sk_v3(r[0] * m.x + r[1] * m.y + r[2] * m.z, r[3] * m.x + r[4] * m.y + r[5] * m.z,
                                           r[6] * m.x + r[7] * m.y + r[8] * m.z));
    *radius = (real)1.0001 * sk_length(reach);
}

static bool changes(const void *data) {
    return ((const mesh_params *)data)->made->led != NULL;
}

static void follow(const void *data, double time) {
    sk_trimesh_follow(((const mesh_params *)data)->made, time);
}

static void stop(const void *data) {
    sk_trimesh_stop(((const mesh_params *)data)->made);
}

static double fastest(const void *data) {
    return ((const mesh_params *)data)->scale * ((const mesh_params *)data)->made->fastest;
}

static const sk_making making = {.make = sk_mesh_make, .unmake = sk_mesh_unmake};
const sk_collider_type sk_solid_mesh = {
    .kind = {"mesh", "what a mesh encloses, or an open one from both sides; moved as a whole, or by a program",
             SKEIN_COLLIDER, fields, sizeof fields / sizeof *fields, sizeof(mesh_params)},
    .place = sk_mesh_place,
    .turn = sk_mesh_turn,
    .probe = SK_EACH_ISA(probe),
    .near = SK_EACH_ISA(near),
    .deforms = true,
    .passing = SK_ANY_SHAPE,
    .making = &making,
    .take = sk_mesh_take,
    .is_shaped_by = is_shaped_by,
    .surface = sk_mesh_surface,
    .scale = sk_mesh_scale,
    .begin = begin,
    .cross = cross,
    .ball = ball,
    .changes = changes,
    .follow = follow,
    .stop = stop,
    .fastest = fastest,
};
#endif
