/* Contact inside an implicit solve: which particles a collider will hold through a substep, and in which
 * directions, as a filter S that the solve applies to all it does.
 *
 *   sticks     friction can stop it: it goes with the surface, S = 0
 *   slides     it keeps its normal velocity, and friction is a force: S loses the normal
 *   arrives    it would be inside by the end: it may come as far as the surface, S loses the normal
 *              (not where it bounces: then it has to arrive with its own velocity)
 *
 * Who touches, how fast, and what friction takes is as in all contact (response.h).
 *
 * Whether a particle is held follows from its force at the start of the substep, contact's own left out:
 * where that pulls it off, it is free. */
#include "base/kernels.h"
#include "colliders/collider.h"
#include "plan/solve.h"

#define SK_UNIT filter
SK_KERNELS(sk_op_kernel, contact_filter);
SK_KERNELS(sk_op_kernel, contact_filter_more);

#ifdef SK_ISA
#include "colliders/response.h"

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
    sk_wide s = sk_keep(mask, 1 / square);
    add_where(mask, &f->v, times(s * change, m));
    add_where(mask, &f->d, (sk_wide3){-(s * m.x * m.x), -(s * m.y * m.y), -(s * m.z * m.z)});
    add_where(mask, &f->o, (sk_wide3){-(s * m.x * m.y), -(s * m.x * m.z), -(s * m.y * m.z)});
}

/* Touching: by the sum of the coordinates, a hair further than in other contact, which measures by the largest. (Taking
 * that changed what stands on spheres in its last digits.) */
SK_INLINE sk_mask touches(const contact_law *law, const encounter *e) {
    sk_wide size = sk_wide_abs(e->x.x) + sk_wide_abs(e->x.y) + sk_wide_abs(e->x.z);
    real thickness = law->thickness;
    return sk_at_most(e->distance - thickness, (real)1e-3 * thickness + (real)4e-6 * (size + (real)0.1));
}

/* What comes faster than a substep's force alone would bring it is to bounce, if the collider lets it. */
SK_INLINE sk_mask bounces(const contact_law *law, const encounter *e, sk_wide speed, sk_wide4 force) {
    sk_mask fast = sk_more(-speed, resting_speed(*e, xyz(force), law->h));
    return law->bounces ? fast : fast & ~fast;
}

SK_INLINE void hold(const sk_collider *collider, const contact_law *law, const sk_pose *pose, sk_wide4 x,
                    sk_wide4 force, filtering *f) {
    const real h = law->h;
    encounter e;
    // as far as its velocity, and its force, lead within the substep; and `touches` looks a hair further
    sk_wide3 v = xyz(f->v), by_force = xyz(force);
    sk_wide ahead = h * (sk_wide_sqrt(sk_dot_wide(v, v)) + h * x.w * sk_wide_sqrt(sk_dot_wide(by_force, by_force)));
    probe(collider, law, pose, x, ahead + (real)1e-5 * (sk_wide_abs(x.x) + sk_wide_abs(x.y) + sk_wide_abs(x.z) + 1), &e);
    find_motion(collider, pose, &e);
    sk_wide3 n = e.normal, past = from_surface(xyz(f->v), e);
    sk_wide speed = sk_dot_wide(past, n), normal_force = sk_dot_wide(xyz(force), n), hw = h * x.w;
    sk_wide3 slide = across(past, n, speed), pull = across(xyz(force), n, normal_force);
    sk_wide coming = speed + hw * normal_force, gap = e.distance - law->thickness;
    sk_mask is_free = sk_positive(x.w), touching = touches(law, &e) & is_free;
    sk_mask held = touching & sk_negative(coming) & ~bounces(law, &e, speed, force);
    // by its velocity alone: what a stiff spring would do to it over a whole substep it does not get to do
    sk_mask arriving = is_free & ~touching & sk_negative(gap + h * speed);
    if (law->bounces) arriving &= ~arriving;
    if (!sk_any(held | arriving)) return;

    // against Coulomb's cone
    sk_wide mass = sk_keep(is_free, 1 / hw);
    sk_wide3 stop = stopping(mass, slide, pull);
    sk_wide needed = sk_wide_sqrt(sk_dot_wide(stop, stop));
    sk_wide most = law->friction * -(mass * coming);
    sk_mask sticks = held & sk_at_most(needed, most);
    sk_wide share = sk_keep(held & ~sticks & sk_positive(needed), most / needed);
    sk_wide target = sk_keep(arriving, -gap / h);
    hold_normal(f, held | arriving, n, target - speed, (real)1e-3);
    add_where(sticks, &f->v, times(sk_splat(-1), through(f, slide)));
    f->d = (sk_wide4){sk_keep(~sticks, f->d.x), sk_keep(~sticks, f->d.y), sk_keep(~sticks, f->d.z), f->d.w};
    f->o = (sk_wide4){sk_keep(~sticks, f->o.x), sk_keep(~sticks, f->o.y), sk_keep(~sticks, f->o.z), f->o.w};
    add_where(held, &f->friction, times(share, stop));
}

void SK_KERNEL(contact_filter)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    const sk_collider *collider = op->rule;
    const contact_law law = law_of(collider, op->dt);
    sk_pose pose = sk_collider_pose_at(collider, run->time - op->before_end);
    sk_vec4 *diagonal = run->vector[op->dst], *off = run->vector[op->source[1]], *rub = run->vector[op->source[2]];
    for (size_t slot = begin; slot < end; slot += SK_PART) {
        bool packed = slot < op->packed;
        sk_wide4 x = sk_load_part(run->vector[SK_X], slot, packed);
        sk_wide4 force = sk_load_part(run->vector[SK_F], slot, packed);
        filtering f = {sk_load_part(diagonal, slot, packed), sk_load_part(off, slot, packed),
                       sk_load_part(run->vector[SK_V], slot, packed), sk_load_part(rub, slot, packed)};
        hold(collider, &law, &pose, x, force, &f);
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
SK_INLINE sk_mask comes_inside(const sk_run *run, const sk_op *op, const contact_law *law, const sk_pose *start,
                               size_t slot, sk_wide4 v, const encounter *e, sk_wide *level) {
    const sk_collider *collider = op->rule;
    bool packed = slot < op->packed;
    sk_wide4 v0 = sk_load_part(run->vector[SK_V0], slot, packed);
    sk_wide4 force = sk_load_part(run->vector[SK_F], slot, packed);
    sk_mask inside = sk_negative(e->distance - law->thickness) & sk_positive(e->x.w);
    if (!sk_any(inside)) return inside;
    encounter before;
    sk_wide4 x0 = sk_load_part(run->vector[SK_X0], slot, packed);
    x0.w = e->x.w; // which X0 does not keep, and who weighs nothing meets nothing
    probe(collider, law, start, x0, sk_splat((real)1e-3), &before);
    find_motion(collider, start, &before);
    // what began inside comes out at its own speed
    sk_wide3 way = minus(xyz(e->x), xyz(x0));
    if (before.moves) way = minus(way, times(law->h, before.surface));
    sk_wide most = depth_before(*law, *e, before.distance, sk_wide_sqrt(sk_dot_wide(way, way))) + law->recovery;
    *level = sk_select(sk_more(*level, most), most, *level);
    inside &= sk_more(*level, e->distance);
    // the balance of momentum along the normal, without what contact does to it
    sk_wide hw = law->h * e->x.w;
    sk_wide3 short_of = minus(times(hw, xyz(force)), minus(xyz(v), xyz(v0)));
    sk_mask lay = touches(law, &before), presses = sk_negative(sk_dot_wide(short_of, e->normal));
    if (!law->bounces) return inside & (presses | ~lay);
    sk_wide speed = sk_dot_wide(from_surface(xyz(v0), before), before.normal);
    return inside & lay & presses & ~bounces(law, e, speed, force);
}

/* Friction of who slides is a force, from what pressed and pulled when the substep began. A stiff spring does so for a part
 * of it only: where the solve finds that friction drives what it is to brake, and faster than that came, as the surface sees
 * it (or a hundredth of the thickness in the substep), it is so much less. Returns whether that is so anywhere. */
SK_INLINE bool ease_friction(const sk_collider *collider, const contact_law *law, const sk_pose *pose, sk_wide4 v,
                             sk_wide4 v0, encounter *e, sk_wide4 *rub) {
    sk_wide3 force = xyz(*rub);
    sk_wide square = sk_dot_wide(force, force);
    sk_mask rubs = sk_positive(square) & sk_more(sk_splat(2 * law->thickness), e->distance);
    if (!sk_any(rubs)) return false;
    find_motion(collider, pose, e);
    sk_wide3 was = from_surface(xyz(v0), *e);
    sk_wide3 past = from_surface(xyz(v), *e), slide = across(past, e->normal, sk_dot_wide(past, e->normal));
    sk_wide driven = sk_dot_wide(force, slide) / sk_wide_sqrt(square);
    sk_wide own = sk_wide_sqrt(sk_dot_wide(was, was)) + sk_splat((real)0.01 * law->thickness / law->h);
    sk_mask drives = rubs & sk_more(driven, own);
    add_where(drives, rub, times(2 * own / (own + driven) - 1, force));
    return sk_any(drives);
}

/* Within the solve: what has come inside is held too, and taken back to the surface. What is held already goes on
 * along its tangent. */
void SK_KERNEL(contact_filter_more)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    const sk_collider *collider = op->rule;
    sk_pose pose = sk_collider_pose_at(collider, run->time - op->before_end);
    sk_pose start = sk_collider_pose_at(collider, run->time - op->dt);
    sk_vec4 *diagonal = run->vector[op->dst], *off = run->vector[op->source[1]], *friction = run->vector[SK_FRICTION];
    const contact_law law = law_of(collider, op->dt);
    for (size_t slot = begin; slot < end; slot += SK_PART) {
        bool packed = slot < op->packed;
        sk_wide4 x = sk_load_part(run->vector[SK_X], slot, packed);
        sk_wide4 v = sk_load_part(run->vector[SK_V], slot, packed);
        encounter e;
        probe(collider, &law, &pose, x, (sk_wide){0}, &e);
        sk_wide4 rub = law.friction > 0 ? sk_load_part(friction, slot, packed) : (sk_wide4){{0}, {0}, {0}, {0}};
        sk_wide4 v0 = sk_load_part(run->vector[SK_V0], slot, packed);
        if (ease_friction(collider, &law, &pose, v, v0, &e, &rub)) sk_store_part(friction, slot, packed, rub);
        sk_wide level = sk_splat(law.thickness);
        sk_mask inside = comes_inside(run, op, &law, &start, slot, v, &e, &level);
        if (!sk_any(inside)) continue;
        sk_wide gap = e.distance - level;
        filtering f = {sk_load_part(diagonal, slot, packed), sk_load_part(off, slot, packed), v, {{0}, {0}, {0}, {0}}};
        hold_normal(&f, inside, e.normal, -gap / law.h, (real)0.5);
        sk_store_part(diagonal, slot, packed, f.d);
        sk_store_part(off, slot, packed, f.o);
        sk_store_part(run->vector[SK_V], slot, packed, f.v);
    }
}

#else

const sk_kernels sk_contact_filter = {SK_EACH_ISA(contact_filter)};
const sk_kernels sk_contact_filter_more = {SK_EACH_ISA(contact_filter_more)};
#endif
