/* How a collider answers what comes near it, for files of kernels: contact.c answers with forces, velocities and moves,
 * filter.c within an implicit solve. The arithmetic is the cards', too (base/arithmetic.h): there it stands before
 * colliders/contact.glsl. */
#include "base/arithmetic.h"
#include "colliders/collider.h"

// ---- arithmetic ----
/* What of a collider counts. */
STRUCT(contact_law) {
    scalar thickness, friction, restitution, mass; /* m, 1, 1, kg: with a mass that counts, not the restitution */
    scalar h, recovery;                            /* s, the substep; m, of recovery in it */
    bool bounces;
};

/* A particle near a collider. */
STRUCT(encounter) {
    vec4 x;
    vec3 normal, surface;   /* unit, out of the solid; the velocity of the surface there */
    num distance, speed;    /* from it, below 0 inside; its own along the normal, of surfaces that deform */
    num reach;              /* a free particle touches as far off as this, a hair beyond the thickness */
    num level;              /* so far off it is pushed: the thickness, or less where it comes out slowly (start.h) */
    flag touching, leaving; /* leaving: as it does then */
    bool moves;             /* the surface: most stand still, and need no arithmetic */
};

/* Rounding must not break a resting contact: forces and velocities look a little beyond the thickness. */
SK_INLINE num reach_of(contact_law law, vec3 p) {
    num size = absolute(p.x), ay = absolute(p.y), az = absolute(p.z);
    size = pick(ay > size, ay, size);
    size = pick(az > size, az, size);
    return law.thickness + PARAM(1e-3) * law.thickness + PARAM(4e-6) * (size + PARAM(0.1));
}

/* The velocity of the surface of a solid that moves and turns, and may have a speed of its own. */
SK_INLINE vec3 motion_of(vec3 velocity, vec3 spin, vec3 arm) {
    return plus(velocity, cross(spin, arm));
}

/* A velocity as the surface sees it. */
SK_INLINE vec3 from_surface(vec3 v, encounter e) {
    if (e.moves) return minus(v, e.surface);
    return v;
}

/* What is left of u without its part along a unit normal. */
SK_INLINE vec3 across(vec3 u, vec3 normal, num along) {
    return minus(u, times(along, normal));
}

/* The part of a vector of this length that friction takes, at most `most`: 1 where it takes all. */
SK_INLINE num share_of(num length, num most) {
    return pick(length > most, most / length, 1);
}

/* The friction that would stop the slide within a substep, against what pulls along the surface. */
SK_INLINE vec3 stopping(num mass_per_step, vec3 slide, vec3 pull) {
    return minus(times(-mass_per_step, slide), pull);
}

/* Speed after a bounce over speed before: of a collider with a mass (m - M)/(m + M), but never inwards. */
SK_INLINE num restitution_of(contact_law law, num mass) {
    if (!(law.mass > 0)) return NUM(law.restitution);
    num share = (law.mass - mass) / (law.mass + mass);
    return pick(share > 0, share, 0);
}

/* The speed up to which what comes is no impact, but what a substep's force alone brings: bouncing that would make
 * resting things jitter. */
SK_INLINE num resting_speed(encounter e, vec3 force, scalar h) {
    return (2 * h) * e.x.w * root(dot(force, force));
}

/* The force on it: what would bring it inwards is cancelled, and what slides is rubbed, within Coulomb's cone. */
SK_INLINE vec3 force_after(contact_law law, encounter e, vec3 v, vec3 force) {
    vec3 past = from_surface(v, e);
    num inward = dot(force, e.normal), parting = dot(past, e.normal);
    vec3 pull = across(force, e.normal, inward), slide = across(past, e.normal, parting);
    num mass_per_step = 1 / (e.x.w * law.h), pressing = inward;
    if (!(law.mass > 0)) pressing = inward + mass_per_step * pick(parting > 0, parting, 0);
    vec3 stop = stopping(mass_per_step, slide, pull);
    num share = share_of(root(dot(stop, stop)), law.friction * -pressing);
    vec3 change = plus(times(-pressing, e.normal), times(share, stop));
    return pick3(both(e.touching, pressing < 0), plus(force, change), force);
}

/* Its velocity: what goes inwards bounces, and is rubbed. */
SK_INLINE vec3 velocity_after(contact_law law, encounter e, vec4 v) {
    vec3 past = from_surface(xyz(v), e);
    num approach = dot(past, e.normal);
    vec3 slide = across(past, e.normal, approach);
    num bounce = (1 + restitution_of(law, v.w)) * -approach;
    num share = share_of(root(dot(slide, slide)), law.friction * bounce);
    vec3 change = minus(times(bounce, e.normal), times(share, slide));
    return pick3(both(e.touching, approach < 0), plus(xyz(v), change), xyz(v));
}

/* How far it is to be pushed out. */
SK_INLINE num push_of(encounter e) {
    return e.level - e.distance;
}

SK_INLINE vec3 pushed_out(encounter e) {
    num push = push_of(e);
    return pick3(both(e.touching, push > 0), plus(xyz(e.x), times(push, e.normal)), xyz(e.x));
}

/* The way out, less the slide since the start of the substep that friction takes back: up to mu times the push. */
SK_INLINE vec3 way_out(contact_law law, encounter e, vec3 start) {
    num push = push_of(e);
    vec3 moved = minus(xyz(e.x), start);
    if (e.moves) moved = minus(moved, times(law.h, e.surface));
    vec3 slide = across(moved, e.normal, dot(moved, e.normal));
    num share = share_of(root(dot(slide, slide)), law.friction * push);
    return minus(times(push, e.normal), times(share, slide));
}

/* Its velocity once it has gone that way. The move is velocity, too, but no push that lets out what began inside; and along
 * the normal what counts is how the particle came. */
SK_INLINE vec3 velocity_moved(contact_law law, encounter e, vec4 v, vec3 way, vec3 came, vec3 force, scalar per_step) {
    num push = push_of(e);
    flag pushed = both(e.touching, push > 0), slowly = both(pushed, e.leaving);
    vec3 now = pick3(pushed, plus(xyz(v), times(per_step, way)), xyz(v));
    if (!none(slowly)) now = pick3(slowly, plus(now, times(-per_step * push, e.normal)), now);
    num approach = dot(from_surface(came, e), e.normal), change = -dot(from_surface(now, e), e.normal);
    if (law.bounces)
        change = change + pick(-approach > resting_speed(e, force, law.h), restitution_of(law, v.w) * -approach, 0);
    return pick3(both(e.touching, either(approach < 0, both(e.leaving, change > 0))),
                 plus(now, times(change, e.normal)), now);
}

/* Whether it was inside at the start of the substep, when it was `behind` off the tangent plane of what is nearest now. */
SK_INLINE flag began_deep(contact_law law, encounter e, num behind) {
    num slack = e.reach - law.thickness;
    return both(e.touching, law.thickness - slack - PARAM(0.1) * law.recovery > behind);
}

/* How far off the surface a particle began, whose way was so long. Where it began farther off than that leads, it did not come through
 * the surface: the inside of a mesh with a hole begins in the air there. Then it is as if it had been where it is. */
SK_INLINE num depth_before(contact_law law, encounter e, num start, num way) {
    return pick(start > e.distance + way + (e.reach - law.thickness), e.distance, start);
}

/* Of a particle that began deep, `start` off the surface: it comes out no further than it may recover. */
SK_INLINE encounter coming_out(contact_law law, encounter e, flag deep, num start) {
    num level = start + law.recovery, slack = e.reach - law.thickness;
    e.leaving = both(deep, law.thickness - slack + law.recovery > level);
    e.level = pick(both(e.leaving, law.thickness > level), level, law.thickness);
    return e;
}
// ---- end of arithmetic ----

SK_INLINE contact_law law_of(const sk_collider *collider, double h) {
    const sk_collider_common *common = collider->common;
    return (contact_law){.thickness = (real)common->thickness,
                         .friction = (real)common->friction,
                         .restitution = (real)common->restitution,
                         .mass = (real)sk_collider_mass(collider),
                         .h = (real)h,
                         .recovery = (real)(h * common->recovery),
                         .bounces = sk_contact_reads_force(collider)};
}

SK_INLINE void add_where(sk_mask mask, sk_wide4 *a, sk_wide3 b) {
    a->x = sk_plus_where(mask, a->x, b.x), a->y = sk_plus_where(mask, a->y, b.y), a->z = sk_plus_where(mask, a->z, b.z);
}

/* Probes a part of a block at x: who touches. What is farther off than that, and by more than `ahead`, need not be known. */
SK_INLINE void probe(const sk_collider *collider, const contact_law *law, const sk_pose *pose, sk_wide4 x,
                     sk_wide ahead, encounter *e) {
    sk_wide3 p = xyz(x);
    sk_contact contact;
    e->x = x;
    e->reach = reach_of(*law, p);
    sk_probe_near *near = collider->type->near[SK_THIS_ISA];
    if (near) {
        sk_wide far =
            sk_select(sk_positive(x.w), (real)1.01 * e->reach + ahead, sk_splat(-1)); // who is held meets nothing
        near(collider->params, pose, &p, &far, &contact);
    } else {
        collider->type->probe[SK_THIS_ISA](collider->params, pose, &p, &contact);
    }
    e->normal = contact.normal, e->distance = contact.distance;
    if (collider->type->deforms) e->speed = contact.speed;
    e->surface = collider->type->changes ? contact.slide : vec3_of(0, 0, 0); // until the rest is known, too
    e->touching = sk_at_most(e->distance, e->reach) & sk_positive(x.w);
}

/* How the surface moves where it was probed, once. */
SK_INLINE void find_motion(const sk_collider *collider, const sk_pose *pose, encounter *e) {
    sk_vec3 v = pose->velocity, s = pose->spin;
    e->moves = collider->type->deforms || v.x != 0 || v.y != 0 || v.z != 0 || s.x != 0 || s.y != 0 || s.z != 0;
    if (!e->moves) return;
    vec3 arm = minus(xyz(e->x), vec3_of(pose->position.x, pose->position.y, pose->position.z));
    vec3 motion = motion_of(vec3_of(v.x, v.y, v.z), vec3_of(s.x, s.y, s.z), arm);
    e->surface = collider->type->deforms ? plus(plus(motion, times(e->speed, e->normal)), e->surface) : motion;
}
