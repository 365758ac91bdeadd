/* What contact is made of, for files of kernels: a part's particles near a collider, how they move against its surface,
 * and what friction can take. contact.c answers with forces, velocities and moves, filter.c within an implicit solve. */
#include "colliders/collider.h"

typedef struct encounter {
    sk_wide4 x;
    sk_contact contact;
    bool moves;       /* the surface: most stand still, and need no arithmetic */
    sk_wide3 surface; /* its velocity there */
    sk_mask touching; /* free particles within the thickness, and a hair beyond it */
    sk_wide reach;    /* that far off, all told */
    sk_wide level;    /* so far off they are pushed: the thickness, or less where they come out slowly (start.h), */
    sk_mask leaving;  /* as these do */
} encounter;

SK_INLINE sk_wide3 minus(sk_wide3 a, sk_wide3 b) {
    return (sk_wide3){a.x - b.x, a.y - b.y, a.z - b.z};
}
SK_INLINE sk_wide3 times(sk_wide s, sk_wide3 a) {
    return (sk_wide3){s * a.x, s * a.y, s * a.z};
}
SK_INLINE sk_wide3 three(sk_wide4 a) {
    return (sk_wide3){a.x, a.y, a.z};
}

SK_INLINE void add_where(sk_mask mask, sk_wide4 *a, sk_wide3 b) {
    a->x = sk_plus_where(mask, a->x, b.x), a->y = sk_plus_where(mask, a->y, b.y), a->z = sk_plus_where(mask, a->z, b.z);
}

/* Splits u into its part along the unit normal (returned) and the rest. */
SK_INLINE sk_wide split(sk_wide3 u, sk_wide3 normal, sk_wide3 *tangential) {
    sk_wide along = sk_dot_wide(u, normal);
    *tangential = minus(u, times(along, normal));
    return along;
}

/* Probes a part of a block at x: who touches. What is farther off than that, and by more than `ahead`, need not be known. */
SK_INLINE void probe(const sk_collider *collider, const sk_pose *pose, sk_wide4 x, sk_wide ahead, encounter *e) {
    sk_wide3 p = three(x);
    e->x = x;
    // rounding must not break a resting contact: forces and velocities look a little beyond the thickness
    sk_wide size = sk_wide_abs(p.x), ay = sk_wide_abs(p.y), az = sk_wide_abs(p.z);
    size = sk_select(sk_more(ay, size), ay, size);
    size = sk_select(sk_more(az, size), az, size);
    real thickness = (real)collider->common->thickness;
    sk_wide reach = thickness + (real)1e-3 * thickness + (real)4e-6 * (size + (real)0.1);
    sk_probe_near *near = collider->type->near[SK_THIS_ISA];
    if (near) {
        sk_wide far = sk_select(sk_positive(x.w), (real)1.01 * reach + ahead, sk_splat(-1)); // who is held meets nothing
        near(collider->params, pose, &p, &far, &e->contact);
    } else {
        collider->type->probe[SK_THIS_ISA](collider->params, pose, &p, &e->contact);
    }
    e->touching = sk_at_most(e->contact.distance, reach) & sk_positive(x.w);
    e->reach = reach;
}

/* How the surface moves where it was probed. */
SK_INLINE void find_motion(const sk_collider *collider, const sk_pose *pose, encounter *e) {
    sk_vec3 v = pose->velocity, s = pose->spin;
    e->moves = collider->type->deforms || v.x != 0 || v.y != 0 || v.z != 0 || s.x != 0 || s.y != 0 || s.z != 0;
    if (!e->moves) return;
    sk_wide3 arm = {e->x.x - pose->position.x, e->x.y - pose->position.y, e->x.z - pose->position.z};
    e->surface = (sk_wide3){v.x + (s.y * arm.z - s.z * arm.y), v.y + (s.z * arm.x - s.x * arm.z),
                            v.z + (s.x * arm.y - s.y * arm.x)};
    if (!collider->type->deforms) return;
    sk_wide3 own = times(e->contact.speed, e->contact.normal);
    e->surface = (sk_wide3){e->surface.x + own.x, e->surface.y + own.y, e->surface.z + own.z};
}

/* A velocity as the surface sees it. */
SK_INLINE sk_wide3 from_surface(sk_wide3 v, const encounter *e) {
    return e->moves ? minus(v, e->surface) : v;
}

/* The part of a vector of length `length` that friction takes, at most `most`: 1 where it takes all. */
SK_INLINE sk_wide share_of(sk_wide length, sk_wide most) {
    return sk_select(sk_more(length, most), most / length, sk_splat(1));
}

/* The friction that would stop the slide within a substep, against what pulls along the surface. */
SK_INLINE sk_wide3 stopping(sk_wide mass_per_step, sk_wide3 slide, sk_wide3 force_t) {
    return minus(times(-mass_per_step, slide), force_t);
}

/* The speed up to which what comes is no impact, but what a substep's force alone brings: bouncing that would make
 * resting things jitter. */
SK_INLINE sk_wide resting_speed(const encounter *e, sk_wide4 force, real h) {
    sk_wide3 f = three(force);
    return (2 * h) * e->x.w * sk_wide_sqrt(sk_dot_wide(f, f));
}
