/* Contact inside an implicit solve: which particles a collider will hold through a substep, and in which
 * directions, as a filter S that the solve applies to all it does.
 *
 *   sticks     friction can stop it: it goes with the surface, S = 0
 *   slides     it keeps its normal velocity, and friction is a force: S loses the normal
 *   arrives    it would be inside by the end: it may come as far as the surface, S loses the normal
 *              (not where it bounces: then it has to arrive with its own velocity)
 *
 * Whether a particle is held follows from its force at the start of the substep, contact's own left out:
 * where that pulls it off, it is free. */
#include "base/kernels.h"
#include "colliders/collider.h"

#define SK_UNIT filter
SK_KERNELS(sk_row_kernel, contact_filter);
SK_KERNELS(sk_row_kernel, contact_filter_more);

#ifdef SK_ISA

typedef struct filtering {
    sk_wide4 d, o; /* S: xx yy zz and xy xz yz */
    sk_wide4 v, friction;
} filtering;

SK_INLINE sk_wide3 through(const filtering *f, sk_wide3 p) {
    return (sk_wide3){f->d.x * p.x + f->o.x * p.y + f->o.y * p.z, f->o.x * p.x + f->d.y * p.y + f->o.z * p.z,
                      f->o.y * p.x + f->o.z * p.y + f->d.z * p.z};
}

/* Changes the velocity along n by `change` in the lanes of the mask, and takes n out of S: as far as S lets it
 * through, and only if that is more than `least` of its square. */
SK_INLINE void hold_normal(filtering *f, sk_mask mask, sk_wide3 n, sk_wide change, real least) {
    sk_wide3 m = through(f, n);
    sk_wide square = sk_dot_wide(m, m);
    mask &= sk_more(square, sk_splat(least));
    sk_wide s = sk_keep(mask, 1 / square), t = s * change, *const v[3] = {&f->v.x, &f->v.y, &f->v.z};
    sk_wide *const d[3] = {&f->d.x, &f->d.y, &f->d.z}, *const o[3] = {&f->o.x, &f->o.y, &f->o.z};
    const sk_wide along[3] = {m.x, m.y, m.z}, first[3] = {m.x, m.x, m.y}, second[3] = {m.y, m.z, m.z};
    for (int k = 0; k < 3; k++) {
        *v[k] = sk_plus_where(mask, *v[k], t * along[k]);
        *d[k] = sk_plus_where(mask, *d[k], -(s * along[k] * along[k]));
        *o[k] = sk_plus_where(mask, *o[k], -(s * first[k] * second[k]));
    }
}

/* Rounding must not break a resting contact: a little beyond the thickness counts as touching. */
SK_INLINE sk_mask touches(const sk_collider *collider, sk_wide3 p, sk_wide gap) {
    sk_wide size = sk_wide_abs(p.x) + sk_wide_abs(p.y) + sk_wide_abs(p.z);
    real thickness = (real)collider->common->thickness;
    return sk_at_most(gap, (real)1e-3 * thickness + (real)4e-6 * (size + (real)0.1));
}

/* The velocity relative to the surface at p. */
SK_INLINE sk_wide3 against(const sk_collider *collider, const sk_pose *pose, sk_wide3 p, const sk_contact *contact,
                           sk_wide4 v) {
    sk_vec3 u = pose->velocity, spin = pose->spin;
    sk_wide3 arm = {p.x - pose->position.x, p.y - pose->position.y, p.z - pose->position.z};
    sk_wide3 out = {v.x - (u.x + (spin.y * arm.z - spin.z * arm.y)), v.y - (u.y + (spin.z * arm.x - spin.x * arm.z)),
                    v.z - (u.z + (spin.x * arm.y - spin.y * arm.x))};
    if (!collider->type->deforms) return out;
    sk_wide3 n = contact->normal;
    return (sk_wide3){out.x - contact->speed * n.x, out.y - contact->speed * n.y, out.z - contact->speed * n.z};
}

/* What comes faster than a substep's force alone would bring it is to bounce, if the collider lets it. */
SK_INLINE sk_mask bounces(const sk_collider *collider, sk_wide speed, sk_wide hw, sk_wide4 force) {
    sk_wide3 f = {force.x, force.y, force.z};
    sk_wide resting = 2 * hw * sk_wide_sqrt(sk_dot_wide(f, f));
    sk_mask fast = sk_more(-speed, resting);
    return sk_contact_reads_force(collider) ? fast : fast & ~fast;
}

SK_INLINE void hold(const sk_collider *collider, const sk_pose *pose, sk_wide4 x, sk_wide4 force, real h,
                    filtering *f) {
    sk_contact contact;
    sk_wide3 p = {x.x, x.y, x.z}, n;
    collider->type->probe[SK_THIS_ISA](collider->params, pose, &p, &contact);
    n = contact.normal;
    sk_wide3 slide = against(collider, pose, p, &contact, f->v);
    sk_wide speed = sk_dot_wide(slide, n), hw = h * x.w;
    slide = (sk_wide3){slide.x - speed * n.x, slide.y - speed * n.y, slide.z - speed * n.z};
    sk_wide3 f3 = {force.x, force.y, force.z};
    sk_wide normal_force = sk_dot_wide(f3, n), coming = speed + hw * normal_force;

    sk_wide gap = contact.distance - (real)collider->common->thickness;
    sk_mask is_free = sk_positive(x.w), touching = touches(collider, p, gap) & is_free;
    sk_mask held = touching & sk_negative(coming) & ~bounces(collider, speed, hw, force);
    // by its velocity alone: what a stiff spring would do to it over a whole substep it does not get to do
    sk_mask arriving = is_free & ~touching & sk_negative(gap + h * speed);
    if (sk_contact_reads_force(collider)) arriving &= ~arriving;
    if (!sk_any(held | arriving)) return;

    // the friction that would stop it in this substep, against Coulomb's cone
    sk_wide mass = sk_keep(is_free, 1 / hw);
    sk_wide3 stop = {-mass * slide.x - (f3.x - normal_force * n.x), -mass * slide.y - (f3.y - normal_force * n.y),
                     -mass * slide.z - (f3.z - normal_force * n.z)};
    sk_wide needed = sk_wide_sqrt(sk_dot_wide(stop, stop));
    sk_wide most = (real)collider->common->friction * -(mass * coming);
    sk_mask sticks = held & sk_at_most(needed, most);
    sk_wide share = sk_keep(held & ~sticks & sk_positive(needed), most / needed);
    sk_wide target = sk_keep(arriving, -gap / h);
    hold_normal(f, held | arriving, n, target - speed, (real)1e-3);
    sk_wide none = {0};
    sk_wide3 along = through(f, slide);
    f->v.x = sk_plus_where(sticks, f->v.x, -along.x);
    f->v.y = sk_plus_where(sticks, f->v.y, -along.y);
    f->v.z = sk_plus_where(sticks, f->v.z, -along.z);
    f->d = (sk_wide4){sk_select(sticks, none, f->d.x), sk_select(sticks, none, f->d.y), sk_select(sticks, none, f->d.z),
                      f->d.w};
    f->o = (sk_wide4){sk_select(sticks, none, f->o.x), sk_select(sticks, none, f->o.y), sk_select(sticks, none, f->o.z),
                      f->o.w};
    f->friction.x = sk_plus_where(held, f->friction.x, share * stop.x);
    f->friction.y = sk_plus_where(held, f->friction.y, share * stop.y);
    f->friction.z = sk_plus_where(held, f->friction.z, share * stop.z);
}

void SK_KERNEL(contact_filter)(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    const sk_collider *collider = row->rule;
    sk_pose pose = sk_collider_pose_at(collider, run->time - row->before);
    sk_vec4 *diagonal = run->vector[row->dst], *off = run->vector[row->source[1]], *rub = run->vector[row->source[2]];
    for (size_t slot = begin; slot < end; slot += SK_PART) {
        bool packed = slot < row->packed;
        sk_wide4 x = sk_load_part(run->vector[SK_X], slot, packed);
        sk_wide4 force = sk_load_part(run->vector[SK_F], slot, packed);
        filtering f = {sk_load_part(diagonal, slot, packed), sk_load_part(off, slot, packed),
                       sk_load_part(run->vector[SK_V], slot, packed), sk_load_part(rub, slot, packed)};
        hold(collider, &pose, x, force, (real)row->dt, &f);
        sk_store_part(diagonal, slot, packed, f.d);
        sk_store_part(off, slot, packed, f.o);
        sk_store_part(run->vector[SK_V], slot, packed, f.v);
        sk_store_part(rub, slot, packed, f.friction);
    }
}

/* What the solve must hold of what is inside at its present guess: all that comes from outside (but what is to
 * bounce), and of what lay on the surface only what presses. The rest is inside because its tangent leads there, in
 * a hollow, and the solve may take it off: holding that would glue it on, with more weight and friction for the rest.
 */
SK_INLINE sk_mask comes_inside(const sk_run *run, const sk_row *row, const sk_pose *start, size_t slot, sk_wide4 x,
                               sk_wide4 v, const sk_contact *contact) {
    const sk_collider *collider = row->rule;
    bool packed = slot < row->packed;
    real thickness = (real)collider->common->thickness;
    sk_wide4 x0 = sk_load_part(run->vector[SK_X0], slot, packed);
    sk_wide4 v0 = sk_load_part(run->vector[SK_V0], slot, packed);
    sk_wide4 force = sk_load_part(run->vector[SK_F], slot, packed);
    sk_mask inside = sk_negative(contact->distance - thickness) & sk_positive(x.w);
    if (!sk_any(inside)) return inside;
    sk_wide3 p0 = {x0.x, x0.y, x0.z}, n = contact->normal;
    sk_contact before;
    collider->type->probe[SK_THIS_ISA](collider->params, start, &p0, &before);
    sk_mask lay = touches(collider, p0, before.distance - thickness);
    // the balance of momentum along the normal, without what contact does to it
    sk_wide hw = (real)row->dt * x.w;
    sk_wide3 short_of = {hw * force.x - (v.x - v0.x), hw * force.y - (v.y - v0.y), hw * force.z - (v.z - v0.z)};
    sk_mask presses = sk_negative(sk_dot_wide(short_of, n));
    if (!sk_contact_reads_force(collider)) return inside & (presses | ~lay);
    sk_wide speed = sk_dot_wide(against(collider, start, p0, &before, v0), before.normal);
    return inside & lay & presses & ~bounces(collider, speed, hw, force);
}

/* Within the solve: what has come inside is held too, and taken back to the surface. What is held already goes on
 * along its tangent. */
void SK_KERNEL(contact_filter_more)(sk_run *run, const sk_row *row, size_t begin, size_t end) {
    const sk_collider *collider = row->rule;
    sk_pose pose = sk_collider_pose_at(collider, run->time - row->before);
    sk_pose start = sk_collider_pose_at(collider, run->time - row->dt);
    sk_vec4 *diagonal = run->vector[row->dst], *off = run->vector[row->source[1]];
    real thickness = (real)collider->common->thickness;
    for (size_t slot = begin; slot < end; slot += SK_PART) {
        bool packed = slot < row->packed;
        sk_wide4 x = sk_load_part(run->vector[SK_X], slot, packed);
        sk_wide4 v = sk_load_part(run->vector[SK_V], slot, packed);
        sk_wide3 p = {x.x, x.y, x.z};
        sk_contact contact;
        collider->type->probe[SK_THIS_ISA](collider->params, &pose, &p, &contact);
        sk_mask inside = comes_inside(run, row, &start, slot, x, v, &contact);
        if (!sk_any(inside)) continue;
        sk_wide gap = contact.distance - thickness;
        filtering f = {sk_load_part(diagonal, slot, packed), sk_load_part(off, slot, packed), v, {{0}, {0}, {0}, {0}}};
        hold_normal(&f, inside, contact.normal, -gap / (real)row->dt, (real)0.5);
        sk_store_part(diagonal, slot, packed, f.d);
        sk_store_part(off, slot, packed, f.o);
        sk_store_part(run->vector[SK_V], slot, packed, f.v);
    }
}

#else

const sk_kernels sk_contact_filter = {SK_EACH_ISA(contact_filter)};
const sk_kernels sk_contact_filter_more = {SK_EACH_ISA(contact_filter_more)};
#endif
