/* Registered colliders by functions: one call for each point, in the collider's own frame. */
#include "colliders/collider.h"
#include "base/kernels.h"

#define SK_UNIT outside_collider
SK_KERNELS(sk_probe, probe);

/* Finds one point's distance and normal; the same function for all widths. */
typedef void sk_outside_ask(const void *params, const sk_pose *pose, const real p[3], real answer[4]);
extern sk_outside_ask sk_outside_ask_collider;

#ifdef SK_ISA

void SK_KERNEL(probe)(const void *params, const sk_pose *pose, const sk_wide3 *p, sk_contact *contact) {
    contact->speed = sk_splat(0);
    for (int i = 0; i < SK_PART; i++) {
        const real at[3] = {p->x[i], p->y[i], p->z[i]};
        real answer[4];
        sk_outside_ask_collider(params, pose, at, answer);
        contact->normal.x[i] = answer[0], contact->normal.y[i] = answer[1], contact->normal.z[i] = answer[2];
        contact->distance[i] = answer[3];
    }
}

#else

#include <math.h>

#include "outside/outside.h"

void sk_outside_ask_collider(const void *params, const sk_pose *pose, const real p[3], real answer[4]) {
    const skein_collider_type *given = sk_outside_of(params)->given;
    const real *r = pose->rotation;
    const double d[3] = {(double)(p[0] - pose->position.x), (double)(p[1] - pose->position.y),
                         (double)(p[2] - pose->position.z)};
    double own[3], normal[3] = {0, 1, 0};
    for (int k = 0; k < 3; k++) own[k] = (double)r[k] * d[0] + (double)r[3 + k] * d[1] + (double)r[6 + k] * d[2];
    double distance = given->distance(sk_given_params(params), pose->time, own, normal);
    double square = normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2];
    if (!(square > 0 && square < SK_FAR)) normal[0] = normal[2] = 0, normal[1] = square = 1; // else up
    double scale = 1 / sqrt(square);
    for (int k = 0; k < 3; k++)
        answer[k] = (real)(scale * ((double)r[3 * k] * normal[0] + (double)r[3 * k + 1] * normal[1] +
                                    (double)r[3 * k + 2] * normal[2]));
    answer[3] = (real)(distance > -SK_FAR && distance < SK_FAR ? distance : SK_FAR);
}

static void place(const void *params, double position[3]) {
    const skein_collider_type *given = sk_outside_of(params)->given;
    position[0] = position[1] = position[2] = 0;
    if (given->place) given->place(sk_given_params(params), position);
}

static void tell_shape(const void *params, skein_shape *shape) {
    const skein_collider_type *given = sk_outside_of(params)->given;
    given->shape(sk_given_params(params), shape);
}

void sk_outside_collider(sk_outside *outside, const skein_collider_type *given) {
    static sk_probe *const probes[SK_ISA_COUNT] = SK_EACH_ISA(probe);
    sk_collider_type *type = &outside->type.collider;
    type->place = place;
    type->passing = SK_ANY_SHAPE;
    for (int i = 0; i < SK_ISA_COUNT; i++) type->probe[i] = probes[i];
    if (given->shape) type->shape = tell_shape;
    type->making = &outside->making;
}
#endif
