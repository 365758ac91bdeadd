/* Steering clear of a collider: what looks ahead along its flight and sees the surface nearer than the clearance there,
 * half way or all the way, is pushed along the surface's normal: by (1 - distance/clearance) strength, twice that at
 * the most. The op's coefficients are the time ahead, the clearance and the strength. */
#include "base/arithmetic.h"
#include "base/kernels.h"
#include "colliders/collider.h"

#define SK_UNIT avoid
SK_KERNELS(sk_op_kernel, avoid);

#ifdef SK_ISA

// ---- arithmetic ----
/* What its steering gets, where it is nearer than the clearance. */
SK_INLINE vec3 kept_off(vec3 normal, num distance, scalar clearance, scalar strength) {
    num k = 1 - distance / clearance;
    return times(strength * pick(k > 2, 2, k), normal);
}
// ---- end of arithmetic ----

void SK_KERNEL(avoid)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    const sk_collider *collider = op->rule;
    sk_pose pose = sk_collider_pose_at(collider, run->time);
    real clearance = (real)(op->coefficient[1] + collider->common->thickness), dv = (real)(op->dt * op->coefficient[2]);
    for (size_t slot = begin; slot < end; slot += SK_PART) {
        bool packed = slot < op->packed;
        sk_wide4 x = sk_load_part(run->vector[SK_X], slot, packed);
        sk_wide4 v = sk_load_part(run->vector[SK_V], slot, packed);
        sk_wide4 s = sk_load_part(run->vector[op->dst], slot, packed);
        sk_mask moved = sk_lanes_between(slot, op->group->first_slot, op->group->end_slot);
        for (int look = 1; look <= 2; look++) {
            real ahead = (real)(0.5 * look * op->coefficient[0]);
            sk_wide3 p = {x.x + ahead * v.x, x.y + ahead * v.y, x.z + ahead * v.z};
            sk_contact contact;
            collider->type->probe[SK_THIS_ISA](collider->params, &pose, &p, &contact);
            sk_mask near = moved & sk_more(sk_splat(clearance), contact.distance);
            if (!sk_any(near)) continue;
            s = vec4_of(pick3(near, plus(xyz(s), kept_off(contact.normal, contact.distance, clearance, dv)), xyz(s)),
                        s.w);
        }
        sk_store_part(run->vector[op->dst], slot, packed, s);
    }
}

#else

const sk_kernels sk_avoid = {SK_EACH_ISA(avoid)};
#endif
