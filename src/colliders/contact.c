/* Contact: what happens to particles that touch a collider, the same for every shape.
 *
 *            n                 A particle touches when its distance d is under the thickness.
 *        p   ^                 Forces, velocities and moves split into a normal and a tangential
 *     ---o---|------- d        part, both relative to the surface's own velocity at p, so that a
 *   =========|=========        turning sphere carries what lies on it (Coulomb friction).
 *
 * What the surface answers, with F the force and v the velocity relative to it:
 *
 *   v.n < 0   the normal part becomes -e v.n (e: the restitution, or what a mass makes of it), and friction takes
 *             up to mu (1 + e) |v.n| of the tangential part: the same law, for the impulse
 *   F.n < 0   as much of it is cancelled as would bring the particle inwards within the substep, all of it where
 *             v.n = 0; and friction of up to mu times that goes against the tangential velocity that F would leave at
 *             the end of the substep: against the slide while there is one, never so much that it turns it round, and
 *             against whatever pulls where there is none
 *
 * What leaves after a bounce is pulled back by its springs from the first: cancelling that too would be work out of
 * nothing (measured: undamped springs at e = 1 gained a quarter of their energy in 5 s). A collider with a mass is the
 * textbook's, which cancels all of F.n < 0 while it touches: its cubes hop.
 *
 * Position methods say the same with moves: friction takes up to mu times the push out.
 * Many particles at a time; lanes that do not touch are masked out. */
#include "colliders/collider.h"

#include <math.h>
#include <string.h>

#include "base/kernels.h"

#define SK_UNIT contact
SK_KERNELS(sk_op_kernel, contact_force);
SK_KERNELS(sk_op_kernel, contact_impulse);
SK_KERNELS(sk_op_kernel, contact_push);
SK_KERNELS(sk_op_kernel, contact_update);
SK_KERNELS(sk_op_kernel, contact_find_held);
SK_KERNELS(sk_op_kernel, contact_hold);
SK_KERNELS(sk_probe_sixteen, probe_sixteen);

#ifdef SK_ISA

#include "colliders/start.h"

/* Probes a part of a block; false where nobody touches. */
SK_INLINE bool meet(sk_run *run, const sk_op *op, const contact_law *law, const sk_pose *pose, size_t slot,
                    encounter *e) {
    probe(op->rule, law, pose, sk_load_part(run->vector[SK_X], slot, slot < op->packed), (sk_wide){0}, e);
    if (!sk_any(e->touching)) return false;
    find_motion(op->rule, pose, e);
    return true;
}

/* The same at the end of a substep, with a look back to its start. */
SK_INLINE bool meet_at_end(sk_run *run, const sk_op *op, const contact_law *law, const sk_pose *pose, const origin *o,
                           size_t slot, encounter *e) {
    probe_at_end(run, op, law, pose, o, slot, e);
    if (!sk_any(e->touching)) return false;
    find_motion(op->rule, pose, e);
    return true;
}

void SK_KERNEL(contact_force)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    const contact_law law = law_of(op->rule, op->dt);
    sk_pose pose = sk_collider_pose_at(op->rule, run->time - op->before_end);
    encounter e;
    for (size_t slot = begin; slot < end; slot += SK_PART) {
        bool packed = slot < op->packed;
        if (!meet(run, op, &law, &pose, slot, &e)) continue;
        sk_wide4 f = sk_load_part(run->vector[op->dst], slot, packed),
                 v = sk_load_part(run->vector[SK_V], slot, packed);
        sk_store_part(run->vector[op->dst], slot, packed, vec4_of(force_after(law, e, xyz(v), xyz(f)), f.w));
    }
}

void SK_KERNEL(contact_impulse)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    const contact_law law = law_of(op->rule, op->dt);
    sk_pose pose = sk_collider_pose_at(op->rule, run->time - op->before_end);
    const origin o = find_origin(op, &pose);
    encounter e;
    for (size_t slot = begin; slot < end; slot += SK_PART) {
        bool packed = slot < op->packed;
        if (!meet_at_end(run, op, &law, &pose, &o, slot, &e)) continue;
        sk_wide4 v = sk_load_part(run->vector[op->dst], slot, packed);
        sk_store_part(run->vector[op->dst], slot, packed, vec4_of(velocity_after(law, e, v), v.w));
    }
}

/* Puts down for contact between surfaces who is pushed by this collider, and by which normal. */
SK_INLINE void tell_support(sk_run *run, const sk_op *op, size_t slot, encounter e) {
    if (!op->also_writes || op->coefficient[1] > 0) return; // else it puts down more
    if (!__atomic_load_n(run->supported, __ATOMIC_RELAXED)) __atomic_store_n(run->supported, true, __ATOMIC_RELAXED);
    bool packed = slot < op->packed;
    sk_wide4 support = sk_load_part(run->vector[SK_SUPPORT], slot, packed);
    sk_wide3 normal = pick3(e.touching & sk_positive(push_of(e)), e.normal, xyz(support));
    sk_store_part(run->vector[SK_SUPPORT], slot, packed, vec4_of(normal, support.w));
}

void SK_KERNEL(contact_push)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    const contact_law law = law_of(op->rule, op->dt);
    sk_pose pose = sk_collider_pose_at(op->rule, run->time - op->before_end);
    const origin o = find_origin(op, &pose);
    encounter e;
    for (size_t slot = begin; slot < end; slot += SK_PART) {
        if (!meet_at_end(run, op, &law, &pose, &o, slot, &e)) continue;
        tell_support(run, op, slot, e);
        sk_store_part(run->vector[op->dst], slot, slot < op->packed, vec4_of(pushed_out(e), e.x.w));
    }
}

/* Puts down by which plane some are held: its normal, a point of it with the friction in w (T0), and how far the surface goes there in a substep
 * (T1), which takes the plane along. */
SK_INLINE void put_plane(sk_run *run, const sk_op *op, size_t slot, const contact_law *law, const encounter *e,
                         sk_mask held, sk_wide3 at, sk_wide3 goes) {
    const bool packed = slot < op->packed;
    const sk_wide4 normal = sk_load_part(run->vector[SK_SUPPORT], slot, packed),
                   level = sk_load_part(run->vector[SK_T0], slot, packed);
    const sk_wide4 old = sk_load_part(run->vector[SK_T1], slot, packed);
    sk_store_part(run->vector[SK_SUPPORT], slot, packed, vec4_of(pick3(held, e->normal, xyz(normal)), normal.w));
    sk_store_part(run->vector[SK_T0], slot, packed,
                  vec4_of(pick3(held, at, xyz(level)), sk_select(held, sk_splat(law->friction), level.w)));
    sk_store_part(run->vector[SK_T1], slot, packed, vec4_of(pick3(held, goes, xyz(old)), old.w));
    __atomic_store_n(run->supported, true, __ATOMIC_RELAXED);
}

/* Whether they are to be held: what bounces, only where it does not. */
SK_INLINE sk_mask is_resting(const contact_law *law, const encounter *e, sk_wide3 came, sk_wide3 force) {
    if (!law->bounces) return ~(sk_mask){0};
    return sk_at_most(-dot(from_surface(came, *e), e->normal), resting_speed(*e, force, law->h));
}

void SK_KERNEL(contact_update)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    const contact_law law = law_of(op->rule, op->dt);
    sk_pose pose = sk_collider_pose_at(op->rule, run->time - op->before_end);
    const origin o = find_origin(op, &pose);
    const bool leaves = op->coefficient[1] > 0 && run->strained;
    encounter e;
    for (size_t slot = begin; slot < end; slot += SK_PART) {
        bool packed = slot < op->packed;
        if (!meet_at_end(run, op, &law, &pose, &o, slot, &e)) continue;
        sk_wide4 v = sk_load_part(run->vector[SK_V], slot, packed);
        sk_wide3 start = xyz(sk_load_part(run->vector[op->source[1]], slot, packed));
        sk_wide3 came = xyz(sk_load_part(run->vector[op->source[2]], slot, packed)), force = came;
        if (law.bounces) force = xyz(sk_load_part(run->vector[SK_F], slot, packed));
        tell_support(run, op, slot, e);
        if (leaves) { // the next substep's limits hold them there
            const sk_mask rests = e.touching & ~e.leaving & is_resting(&law, &e, came, force);
            if (sk_any(rests))
                put_plane(run, op, slot, &law, &e, rests, plus(xyz(e.x), times(law.thickness - e.distance, e.normal)),
                          e.moves ? times(law.h, e.surface) : vec3_of(0, 0, 0));
        }
        sk_wide3 way = way_out(law, e, start);
        add_where(e.touching & sk_positive(push_of(e)), &e.x, way);
        sk_store_part(run->vector[op->dst], slot, packed, e.x);
        sk_wide3 after = velocity_moved(law, e, v, way, came, force, (real)(1 / op->dt));
        sk_store_moved(run->vector[SK_V], slot, packed, vec4_of(after, v.w));
    }
}

/* Where particles began a substep, taken along by the surface as a whole. */
SK_INLINE sk_wide4 start_of(const sk_run *run, const sk_op *op, const sk_pose *pose, const origin *o, size_t slot) {
    const sk_wide4 x = sk_load_part(run->vector[SK_X], slot, slot < op->packed);
    const sk_wide3 start = xyz(sk_load_part(run->vector[o->vector], slot, slot < op->packed));
    if (!o->moves) return vec4_of(start, x.w);
    const sk_wide3 arm = minus(start, vec3_of(pose->position.x, pose->position.y, pose->position.z));
    return vec4_of(plus(start, motion_of(vec3_of(o->shift.x, o->shift.y, o->shift.z),
                                         vec3_of(o->turn.x, o->turn.y, o->turn.z), arm)),
                   x.w);
}

/* Who touched when the substep began is held by what he touched: pulled in beside a corner, he is nearer to another face. Else by what he has
 * come into. Not who began inside: he comes out slowly, and not by velocity. With a coefficient of 1 only in the first substep: the others
 * know it from the update of the one before. */
void SK_KERNEL(contact_find_held)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    if (op->coefficient[0] > 0 && run->iteration) return;
    const contact_law law = law_of(op->rule, op->dt);
    sk_pose pose = sk_collider_pose_at(op->rule, run->time - op->before_end);
    const origin o = find_origin(op, &pose);
    encounter e, first;
    for (size_t slot = begin; slot < end; slot += SK_PART) {
        if (!meet(run, op, &law, &pose, slot, &e)) continue;
        const sk_mask in = e.touching & sk_positive(law.thickness - e.distance);
        if (!sk_any(in)) continue;
        sk_wide3 way;
        sk_mask came = in & ~began_deep(law, e, off_plane(run, op, &pose, &o, slot, &e, &way));
        const sk_wide3 start = xyz(sk_load_part(run->vector[o.vector], slot, slot < op->packed));
        probe(op->rule, &law, &pose, start_of(run, op, &pose, &o, slot), (sk_wide){0}, &first);
        sk_mask rested = in & first.touching & ~began_deep(law, first, first.distance);
        if (law.bounces) {
            const sk_wide3 v = xyz(sk_load_part(run->vector[SK_V], slot, slot < op->packed)),
                           f = xyz(sk_load_part(run->vector[SK_F], slot, slot < op->packed));
            find_motion(op->rule, &pose, &first);
            rested &= is_resting(&law, &first, v, f);
            came &= rested;
        }
        const sk_wide3 behind = times(law.thickness - e.distance, e.normal),
                       under = times(law.thickness - first.distance, first.normal);
        // T0 is where the plane was before the surface went on
        if (sk_any(came & ~rested))
            put_plane(run, op, slot, &law, &e, came & ~rested, plus(plus(start, way), behind),
                      minus(minus(xyz(e.x), start), way));
        if (sk_any(rested))
            put_plane(run, op, slot, &law, &first, rested, plus(start, under), minus(xyz(first.x), start));
    }
}

/* What rounding may be of a place: who is so little behind his plane lies on it. Else who was put there would be put there again and again. */
#define HOLD_ROUNDING ((real)(sizeof(real) == 4 ? 5e-7 : 1e-15))

/* Holds a part of a block; false if nobody moves. */
SK_INLINE bool hold_part(sk_run *run, const sk_op *op, size_t slot) {
    const bool packed = slot < op->packed;
    const sk_wide3 normal = xyz(sk_load_part(run->vector[op->source[0]], slot, packed));
    const sk_mask held = sk_positive(dot(normal, normal));
    if (!sk_any(held)) return false;
    const sk_wide4 x = sk_load_part(run->vector[op->dst], slot, packed),
                   level = sk_load_part(run->vector[op->source[1]], slot, packed);
    const sk_wide3 goes = xyz(sk_load_part(run->vector[op->source[2]], slot, packed)), from = minus(xyz(x), goes);
    const sk_wide push = dot(normal, minus(xyz(level), from)),
                  size = sk_wide_abs(level.x) + sk_wide_abs(level.y) + sk_wide_abs(level.z);
    const sk_mask in = sk_more(push, HOLD_ROUNDING * size) & held;
    if (!sk_any(in)) return false;
    const sk_wide3 moved = minus(from, xyz(sk_load_part(run->vector[SK_X0], slot, packed)));
    const sk_wide3 slide = across(moved, normal, dot(moved, normal));
    const sk_wide share = share_of(root(dot(slide, slide)), level.w * push);
    const sk_wide3 to = plus(xyz(x), minus(times(push, normal), times(share, slide)));
    sk_store_part(run->vector[op->dst], slot, packed, vec4_of(pick3(in, to, xyz(x)), x.w));
    return true;
}

void SK_KERNEL(contact_hold)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    if (!__atomic_load_n(run->supported, __ATOMIC_RELAXED)) return;
    const sk_watch watch = sk_watch_of(run, op);
    for (size_t block = begin; block < end; block += SK_LANES) {
        if (watch.moved && sk_watch_holds(&watch, run->found_held[block / SK_LANES], block)) continue;
        bool moves = false;
        for (size_t slot = block; slot < block + SK_LANES; slot += SK_PART) moves |= hold_part(run, op, slot);
        if (!watch.moved) continue;
        run->found_held[block / SK_LANES] = moves ? 0 : watch.now;
        if (moves) sk_watch_move(&watch, block);
    }
}

void SK_KERNEL(probe_sixteen)(const sk_collider *collider, const sk_pose *pose, real p[3][SK_LANES], real reach,
                              sk_sixteen_contacts *contacts) {
    const sk_collider_type *type = collider->type;
    const sk_wide most = sk_splat(reach);
    for (size_t l = 0; l < SK_LANES; l += SK_PART) {
        sk_wide3 at;
        sk_contact c;
        memcpy(&at.x, p[0] + l, sizeof at.x), memcpy(&at.y, p[1] + l, sizeof at.y);
        memcpy(&at.z, p[2] + l, sizeof at.z);
        if (type->near[SK_THIS_ISA] && reach < SK_REAL_MAX)
            type->near[SK_THIS_ISA](collider->params, pose, &at, &most, &c);
        else type->probe[SK_THIS_ISA](collider->params, pose, &at, &c);
        memcpy(contacts->normal[0] + l, &c.normal.x, sizeof c.normal.x);
        memcpy(contacts->normal[1] + l, &c.normal.y, sizeof c.normal.y);
        memcpy(contacts->normal[2] + l, &c.normal.z, sizeof c.normal.z);
        memcpy(contacts->distance + l, &c.distance, sizeof c.distance);
        if (!type->deforms) continue;
        const sk_wide3 own = type->changes ? plus(times(c.speed, c.normal), c.slide) : times(c.speed, c.normal);
        memcpy(contacts->own[0] + l, &own.x, sizeof own.x), memcpy(contacts->own[1] + l, &own.y, sizeof own.y);
        memcpy(contacts->own[2] + l, &own.z, sizeof own.z);
    }
}

#else

sk_probe_sixteen *const sk_probe_sixteen_of[SK_ISA_COUNT] = SK_EACH_ISA(probe_sixteen);
const sk_kernels sk_contact_force = {SK_EACH_ISA(contact_force)};
const sk_kernels sk_contact_impulse = {SK_EACH_ISA(contact_impulse)};
const sk_kernels sk_contact_push = {SK_EACH_ISA(contact_push)};
const sk_kernels sk_contact_update = {SK_EACH_ISA(contact_update)};
const sk_kernels sk_contact_find_held = {SK_EACH_ISA(contact_find_held)};
const sk_kernels sk_contact_hold = {SK_EACH_ISA(contact_hold)};

void sk_contact_let_go(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    if (op->coefficient[0] > 0 && run->iteration) return;
    memset(run->vector[op->dst] + begin, 0,
           (end - begin) * sizeof *run->vector[op->dst]); // packed or not, it is as long
}

const skein_field sk_collider_fields[] = {
    SK_TEXT(sk_collider_common, name, "name", "", "for paths and messages"),
    SK_BOOL(sk_collider_common, enabled, "enabled", 1, "false: as if it were not there"),
    SK_BOOL(sk_collider_common, visible, "visible", 1, "whether it is drawn"),
    SK_TEXT(sk_collider_common, on, "on", "",
            "the names of the bodies, or of groups of them, that it meets, commas between them; empty: every particle"),
    SK_REAL(sk_collider_common, thickness, "thickness", "m", 0.002, 0, SK_FAR, "particles are kept so far off"),
    SK_REAL(sk_collider_common, friction, "friction", "", 0.3, 0, SK_FAR, "Coulomb's coefficient, at rest and sliding"),
    SK_REAL(sk_collider_common, recovery, "recovery", "m/s", 1, 0, SK_FAR,
            "what begins inside comes out at this speed, and is not thrown: the way out is no velocity"),
    SK_REAL(sk_collider_common, restitution, "restitution", "", 0, 0, 1, "speed after a bounce over speed before"),
    SK_VEC3(sk_collider_common, velocity, "motion.velocity", "m/s", 0, 0, 0, "it moves so from motion.start on"),
    SK_VEC3(sk_collider_common, axis, "motion.axis", "", 0, 1, 0, "axis of the spin, through its own point"),
    SK_REAL(sk_collider_common, spin, "motion.spin", "rad/s", 0, -1e6, 1e6, "angular speed from motion.start on"),
    SK_REAL(sk_collider_common, start, "motion.start", "s", 0, 0, SK_FAR, "when the motion begins"),
};
const size_t sk_collider_field_count = sizeof sk_collider_fields / sizeof *sk_collider_fields;

void sk_contact_follow(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    const sk_collider *collider = op->rule;
    (void)begin, (void)end;
    collider->type->follow(collider->params, run->time - op->before_end);
}

double sk_collider_mass(const sk_collider *collider) {
    return collider->type->mass ? collider->type->mass(collider->params) : 0;
}

bool sk_contact_reads_force(const sk_collider *collider) {
    return collider->common->restitution > 0 || sk_collider_mass(collider) > 0;
}

/* How near a particle at q has to be to count as in touch: rounding must not break a resting contact. */
static double touching_distance(sk_vec4 q, double thickness) {
    const double size = fmax(fabs((double)q.x), fmax(fabs((double)q.y), fabs((double)q.z)));
    return thickness * 1.001 + 4e-6 * (size + 0.1);
}

/* Probes sixteen particles from `first` on, or as many as there are, for what is in touch; returns how many. */
static size_t probe_block(const sk_collider *collider, const sk_pose *pose, sk_isa isa, const sk_vec4 *x,
                          const uint32_t *slot_of, size_t first, size_t particle_count, sk_sixteen_contacts *contacts) {
    size_t count = particle_count - first < SK_LANES ? particle_count - first : SK_LANES;
    real p[3][SK_LANES];
    double reach = 0;
    for (size_t i = 0; i < SK_LANES; i++) {
        const sk_vec4 q = x[slot_of[first + (i < count ? i : 0)]];
        p[0][i] = q.x, p[1][i] = q.y, p[2][i] = q.z;
        reach = fmax(reach, touching_distance(q, collider->common->thickness));
    }
    sk_probe_sixteen_of[isa](collider, pose, p, (real)(1.001 * reach), contacts);
    return count;
}

void sk_collider_measure(const sk_collider *collider, double time, sk_isa isa, const sk_vec4 *x,
                         const uint32_t *slot_of, size_t particle_count, double *penetration, size_t *contacts) {
    sk_pose pose = sk_collider_pose_at(collider, time);
    double thickness = collider->common->thickness;
    for (size_t first = 0; first < particle_count; first += SK_LANES) {
        sk_sixteen_contacts contact;
        size_t count = probe_block(collider, &pose, isa, x, slot_of, first, particle_count, &contact);
        for (size_t i = 0; i < count; i++) {
            sk_vec4 q = x[slot_of[first + i]];
            double distance = (double)contact.distance[i];
            if (distance <= touching_distance(q, thickness)) ++*contacts;
            if (q.w > 0 && thickness - distance > *penetration) *penetration = thickness - distance;
        }
    }
}

void sk_collider_probe_points(const sk_collider *collider, double time, sk_isa isa, size_t count, const double *points,
                              double *distances, double *normals) {
    sk_pose pose = sk_collider_pose_at(collider, time);
    for (size_t first = 0; first < count; first += SK_LANES) {
        size_t lanes = count - first < SK_LANES ? count - first : SK_LANES;
        real p[3][SK_LANES] = {{0}};
        sk_sixteen_contacts contact;
        for (size_t i = 0; i < lanes; i++)
            for (int k = 0; k < 3; k++) p[k][i] = (real)points[3 * (first + i) + (size_t)k];
        sk_probe_sixteen_of[isa](collider, &pose, p, SK_REAL_MAX, &contact);
        for (size_t i = 0; i < lanes; i++) {
            double *normal = normals ? normals + 3 * (first + i) : NULL;
            if (distances) distances[first + i] = (double)contact.distance[i];
            for (int k = 0; normal && k < 3; k++) normal[k] = (double)contact.normal[k][i];
        }
    }
}

size_t sk_collider_count_guarded(const sk_collider *collider, double time, const sk_vec4 *x, const uint32_t *slot_of,
                                 size_t particle_count) {
    sk_pose pose = sk_collider_pose_at(collider, time);
    size_t guarded = 0;
    for (size_t i = 0; i < particle_count && collider->type->guarded; i++) {
        sk_vec4 q = x[slot_of[i]];
        const double at[3] = {(double)q.x, (double)q.y, (double)q.z};
        if (q.w > 0) guarded += collider->type->guarded(collider->params, &pose, at);
    }
    return guarded;
}

void sk_collider_visit(const sk_collider *collider, double time, sk_isa isa, const sk_vec4 *x, const uint32_t *slot_of,
                       size_t particle_count,
                       void (*visit)(void *user, size_t particle, sk_vec3 normal, double distance), void *user) {
    sk_pose pose = sk_collider_pose_at(collider, time);
    for (size_t first = 0; first < particle_count; first += SK_LANES) {
        sk_sixteen_contacts contact;
        size_t count = probe_block(collider, &pose, isa, x, slot_of, first, particle_count, &contact);
        for (size_t i = 0; i < count; i++) {
            double distance = (double)contact.distance[i];
            if (!(distance <= touching_distance(x[slot_of[first + i]], collider->common->thickness))) continue;
            sk_vec3 normal = {contact.normal[0][i], contact.normal[1][i], contact.normal[2][i]};
            visit(user, first + i, normal, distance);
        }
    }
}
#endif
