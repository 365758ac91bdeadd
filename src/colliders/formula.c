/* An implicit surface: solid where a formula is under 0, free where it is over 0.
 *
 * To first order a particle is f/|grad f| away from the surface, which is exact where f is a distance, and good near
 * the surface wherever f is smooth there. The normal is grad f/|grad f|; where t makes the surface move, it moves along
 * it at -(df/dt)/|grad f|. Where there is no gradient, as in the middle of a ball, up is the way out. */
#include "base/kernels.h"
#include "base/rotation.h"
#include "base/status.h"
#include "colliders/collider.h"
#include "formula/pointwise.h"

typedef struct formula_params {
    double parameter[SKEIN_FORMULA_MOST_PARAMETERS];
    double centre[3], rotation[3];
    char *surface;
    sk_pointwise *compiled;
} formula_params;

#define SK_UNIT surface
SK_KERNELS(sk_probe, probe);

#ifdef SK_ISA

void SK_KERNEL(probe)(const void *data, const sk_pose *pose, const sk_wide3 *p, sk_contact *contact) {
    const formula_params *params = data;
    const real *r = pose->rotation;
    sk_wide out[SK_POINTWISE_MOST_OUTPUTS], one = sk_splat(1), none = {0};
    sk_mask guarded;
    sk_wide3 d = {p->x - pose->position.x, p->y - pose->position.y, p->z - pose->position.z};
    sk_wide3 own = {r[0] * d.x + r[3] * d.y + r[6] * d.z, r[1] * d.x + r[4] * d.y + r[7] * d.z,
                    r[2] * d.x + r[5] * d.y + r[8] * d.z};
    sk_pointwise_run_of[SK_THIS_ISA](params->compiled, params->parameter, pose->time, &own, NULL, out, &guarded);
    sk_wide3 g = {out[1], out[2], out[3]};
    sk_wide square = sk_dot_wide(g, g);
    sk_mask slopes = sk_positive(square) & sk_at_most(square, sk_splat(SK_REAL_MAX));
    sk_wide inverse = 1 / sk_wide_sqrt(sk_select(slopes, square, one));
    sk_wide nx = sk_keep(slopes, g.x * inverse), nz = sk_keep(slopes, g.z * inverse),
            ny = sk_select(slopes, g.y * inverse, one);
    contact->normal = (sk_wide3){r[0] * nx + r[1] * ny + r[2] * nz, r[3] * nx + r[4] * ny + r[5] * nz,
                                 r[6] * nx + r[7] * ny + r[8] * nz};
    // without a slope, what is not inside is far off
    sk_wide flat = sk_select(sk_negative(out[0]), out[0], sk_splat((real)SK_FAR));
    contact->distance = sk_select(slopes, out[0] * inverse, flat);
    contact->speed = sk_select(slopes, -out[4] * inverse, none);
}

#else

static const skein_field fields[] = {
    SK_TEXT(formula_params, surface, "surface", "p.y",
            "a formula of p and t: over 0 where particles may be, under 0 in the solid; best a distance"),
    SK_PARAMETERS(formula_params, parameter, "a number that the formula names: { \"R\": 0.5 }, say"),
    SK_VEC3(formula_params, centre, "centre", "m", 0, 0, 0, "where the formula's p is 0, before any motion"),
    SK_VEC3(formula_params, rotation, "rotation", "deg", 0, 0, 0, "turned about x, then y, then z, before any motion"),
};

static void place(const void *data, double position[3]) {
    for (int k = 0; k < 3; k++) position[k] = ((const formula_params *)data)->centre[k];
}

static void turn(const void *data, double rotation[9]) {
    sk_rotation_of_degrees(((const formula_params *)data)->rotation, rotation);
}

/* The value, its gradient, its change in time. */
static size_t choose(skein_formula *f, sk_node outputs[static SK_POINTWISE_MOST_OUTPUTS]) {
    outputs[0] = f->value[0];
    for (int axis = 0; axis < 3; axis++) outputs[1 + axis] = f->by_position[0][axis];
    outputs[4] = f->by_time[0];
    return 5;
}

static skein_status make(void *data, const skein_kind *kind, sk_allocator *allocator, skein_error *error) {
    formula_params *params = data;
    skein_formula_desc desc = {.result = SKEIN_FORMULA_NUMBER};
    sk_pointwise *made;
    skein_status status =
        sk_pointwise_create("surface", params->surface, desc, choose, kind, !params->compiled, allocator, &made, error);
    if (status) return status;
    if (!(made->formula->uses & SK_USES_POSITION)) {
        sk_pointwise_destroy(made, allocator);
        return sk_fail(error, SKEIN_ERROR_VALUE, "surface",
                       "a surface is a formula of p, and this one is the same everywhere");
    }
    sk_pointwise_destroy(params->compiled, allocator);
    params->compiled = made;
    return SKEIN_OK;
}

static void unmake(void *data, sk_allocator *allocator) {
    sk_pointwise_destroy(((formula_params *)data)->compiled, allocator);
}

static bool is_guarded(const void *data, const sk_pose *pose, const double x[3]) {
    const formula_params *params = data;
    const real *r = pose->rotation;
    double d[3] = {x[0] - (double)pose->position.x, x[1] - (double)pose->position.y, x[2] - (double)pose->position.z};
    double own[3], value[3];
    for (int k = 0; k < 3; k++) own[k] = (double)r[k] * d[0] + (double)r[3 + k] * d[1] + (double)r[6 + k] * d[2];
    bool guarded;
    sk_pointwise_value(params->compiled, params->parameter, pose->time, own, NULL, value, &guarded);
    return guarded;
}

static void pack(const void *data, float (*block)[4]) {
    const formula_params *params = data;
    sk_pointwise_pack(params->compiled, params->parameter, block);
}

static bool write(const void *data, void (*put)(void *user, const char *text), void *user) {
    return sk_pointwise_put_glsl(((const formula_params *)data)->compiled, 0, put, user);
}

static bool changes(const void *data) {
    return ((const formula_params *)data)->compiled->formula->uses & SK_USES_TIME;
}

static const sk_making making = {.make = make, .unmake = unmake, .by_text = true};
const sk_collider_type sk_formula_surface = {
    .kind = {"formula", "any surface that a formula describes, also one that moves and changes", SKEIN_COLLIDER, fields,
             sizeof fields / sizeof *fields, sizeof(formula_params)},
    .place = place,
    .turn = turn,
    .probe = SK_EACH_ISA(probe),
    .deforms = true,
    .passing = SK_ANY_SHAPE,
    .guarded = is_guarded,
    .making = &making,
    .shader = {.file = "colliders/formula", .size = SK_POINTWISE_BLOCK, .pack = pack, .write = write, .changes = changes},
};
#endif
