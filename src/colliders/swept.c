/* Swept contact: a particle whose way in the substep leads through a surface stops at the surface, on the side that it came from.
 *
 *     x0 o                      The way from x0 to x, as the collider sees it, first crosses the surface at c. What is
 *         \                     left of it there goes on along the surface, up to three times more; friction takes
 *     =====c---o x'===          from it what it takes of a push as long as what is lost of it. Ordinary contact, which
 *           \                   comes next, then finds the particle in touch.
 *            o x
 *
 * The kernel is of types that say where a way crosses them (`cross`): ordinary contact keeps particles at the thickness, so that
 * ways up to half of it need no look. Of all others contact itself finds out who is asked (start.h). Position methods give the
 * velocity the same move.
 *
 * Of a surface that a program leads, where x0 was is seen as what is nearest to x has gone since. */
#include "base/kernels.h"
#include "colliders/collider.h"

#define SK_UNIT contact_sweep
SK_KERNELS(sk_op_kernel, sweep);

#ifdef SK_ISA

/* Starts as the surface sees them where it is now, by what of it is nearest to x within reach. */
SK_INLINE sk_wide3 led_along(const sk_collider *collider, const sk_pose *pose, sk_wide3 from, sk_wide4 x, real h,
                             sk_wide reach) {
    const sk_wide3 p = {x.x, x.y, x.z};
    sk_contact contact;
    collider->type->near[SK_THIS_ISA](collider->params, pose, &p, &reach, &contact);
    const sk_wide3 n = contact.normal, s = contact.slide;
    return (sk_wide3){from.x + h * (contact.speed * n.x + s.x), from.y + h * (contact.speed * n.y + s.y),
                      from.z + h * (contact.speed * n.z + s.z)};
}

void SK_KERNEL(sweep)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    const sk_collider *collider = op->rule;
    sk_swept sweep = sk_swept_begin(collider, run->time - op->dt, run->time - op->before_end, op->coefficient[0] > 0);
    real half = (real)(0.5 * collider->common->thickness), per_step = (real)(op->coefficient[0] / op->dt);
    real h = (real)(op->dt - op->before_end),
         led = collider->type->fastest ? h * (real)collider->type->fastest(collider->params) : 0;
    for (size_t slot = begin; slot < end; slot += SK_PART) {
        bool packed = slot < op->packed;
        sk_wide4 x = sk_load_part(run->vector[SK_X], slot, packed),
                 x0 = sk_load_part(run->vector[op->source[1]], slot, packed);
        const real *r = sweep.turn;
        sk_wide3 from = {x0.x, x0.y, x0.z};
        if (sweep.moves)
            from = (sk_wide3){r[0] * x0.x + r[1] * x0.y + r[2] * x0.z + sweep.shift.x,
                              r[3] * x0.x + r[4] * x0.y + r[5] * x0.z + sweep.shift.y,
                              r[6] * x0.x + r[7] * x0.y + r[8] * x0.z + sweep.shift.z};
        sk_wide3 way = {x.x - from.x, x.y - from.y, x.z - from.z};
        sk_wide3 off = {x.x - sweep.middle.x, x.y - sweep.middle.y, x.z - sweep.middle.z};
        sk_wide length = sk_wide_sqrt(sk_dot_wide(way, way)) + led, near = length + sweep.radius;
        sk_mask looked =
            sk_positive(x.w) & sk_more(length, sk_splat(half)) & sk_at_most(sk_dot_wide(off, off), near * near);
        if (!sk_any(looked)) continue;
        if (led > 0) from = led_along(collider, &sweep.pose, from, x, h, sk_select(looked, length, sk_splat(-1)));
        sk_wide4 v = sk_load_part(run->vector[SK_V], slot, packed);
        bool any = false;
        for (int l = 0; l < SK_PART; l++) {
            if (!looked[l]) continue;
            const double a[3] = {(double)from.x[l], (double)from.y[l], (double)from.z[l]};
            double to[3] = {(double)x.x[l], (double)x.y[l], (double)x.z[l]};
            if (!sk_swept_stop(&sweep, a, to)) continue;
            any = true;
            real moved[3] = {(real)to[0], (real)to[1], (real)to[2]};
            v.x[l] += per_step * (moved[0] - x.x[l]), v.y[l] += per_step * (moved[1] - x.y[l]),
                v.z[l] += per_step * (moved[2] - x.z[l]);
            x.x[l] = moved[0], x.y[l] = moved[1], x.z[l] = moved[2];
        }
        if (!any) continue;
        sk_store_part(run->vector[op->dst], slot, packed, x);
        if (per_step > 0) sk_store_moved(run->vector[SK_V], slot, packed, v);
    }
}

#else

#include <math.h>

enum { MOST_CROSSINGS = 4 };

const sk_kernels sk_contact_sweep = {SK_EACH_ISA(sweep)};

sk_swept sk_swept_begin(const sk_collider *collider, double from, double to, bool rubs) {
    sk_pose start = sk_collider_pose_at(collider, from);
    sk_swept sweep = {.collider = collider, .pose = sk_collider_pose_at(collider, to), .rubs = rubs};
    const real *a = start.rotation, *b = sweep.pose.rotation;
    const real p[3] = {start.position.x, start.position.y, start.position.z};
    const real q[3] = {sweep.pose.position.x, sweep.pose.position.y, sweep.pose.position.z};
    real shift[3];
    for (int r = 0; r < 3; r++) {
        for (int c = 0; c < 3; c++)
            sweep.turn[3 * r + c] = b[3 * r] * a[3 * c] + b[3 * r + 1] * a[3 * c + 1] + b[3 * r + 2] * a[3 * c + 2];
        shift[r] = q[r] - (sweep.turn[3 * r] * p[0] + sweep.turn[3 * r + 1] * p[1] + sweep.turn[3 * r + 2] * p[2]);
    }
    for (int i = 0; i < 9; i++) sweep.moves |= a[i] != b[i];
    for (int k = 0; k < 3; k++) sweep.moves |= p[k] != q[k];
    sweep.shift = sk_v3(shift[0], shift[1], shift[2]);
    if (collider->type->ball) collider->type->ball(collider->params, &sweep.pose, &sweep.middle, &sweep.radius);
    sweep.radius += (real)collider->common->thickness;
    return sweep;
}

bool sk_swept_stop(const sk_swept *sweep, const double start[3], double x[3]) {
    const sk_collider *collider = sweep->collider;
    double from[3] = {start[0], start[1], start[2]}, normal[3];
    double size = fabs(x[0]) + fabs(x[1]) + fabs(x[2]) + 0.1;
    double off = fmax(0.5 * collider->common->thickness, (sizeof(real) == 4 ? 2e-6 : 1e-9) * size);
    for (int turn = 0; turn < MOST_CROSSINGS; turn++) {
        double part = sk_collider_cross(collider, &sweep->pose, from, x, normal);
        if (part > 1) return turn > 0;
        double closing = 0, length = 0, rest[3];
        for (int k = 0; k < 3; k++) closing -= normal[k] * (x[k] - from[k]);
        part = closing > 0 ? fmax(0, part - off / closing) : 0;
        double lost = (1 - part) * closing;
        for (int k = 0; k < 3; k++) {
            double way = x[k] - from[k];
            rest[k] = (1 - part) * way + lost * normal[k];
            from[k] += part * way;
            length += rest[k] * rest[k];
        }
        length = sqrt(length);
        double rub = sweep->rubs ? collider->common->friction * lost : 0;
        double keep = length > rub ? 1 - rub / length : 0;
        for (int k = 0; k < 3; k++) x[k] = from[k] + keep * rest[k];
    }
    // in a corner with walls all round it stays where it came to
    if (sk_collider_cross(collider, &sweep->pose, from, x, normal) <= 1)
        for (int k = 0; k < 3; k++) x[k] = from[k];
    return true;
}
#endif
