/* The loops over particles for forces with marked arithmetic (base/arithmetic.h). A kind's file defines PARAMS, its
 * struct, and its function as one of these, before it includes this, which makes `kernel` of it:
 *
 *     PUSH    vec3 (PARAMS p, vec3 v, num mass): newtons of a force that is the same everywhere; `at`, which is made
 *             too, lets methods that predict find out whether it is uniform (force.h)
 *     PUSH_AT vec3 (PARAMS p, vec3 x, vec3 v, num mass): newtons that depend on the place
 *     STEER   vec4 (PARAMS p, vec3 x, exact dt): a change of velocity, and of the allowed speed in w. LOOKS_FROM names
 *             the field that is replaced by a particle's position if the rule is placed at one; SELDOM says that most
 *             particles get no change
 *     BOUND   vec3 (PARAMS p, vec4 x, vec3 v, vec4 steering, exact dt): the velocity that is allowed; x.w is the inverse
 *             mass. If its shader's `shifts` says that it moves particles instead: SHIFT, vec3 (PARAMS p, vec3 x) */
#ifdef SK_ISA

#ifdef PUSH
#define PUSH_AT(p, x, v, mass) PUSH(p, v, mass)
#endif

#ifdef PUSH_AT
void SK_KERNEL(kernel)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    const PARAMS p = *(const PARAMS *)((const sk_force *)op->rule)->params;
    for (size_t slot = begin; slot < end; slot += SK_PART) {
        bool packed = slot < op->packed;
        vec4 v = sk_load_part(run->vector[SK_V], slot, packed), f = {0};
        if (!op->sets) f = sk_load_part(run->vector[op->dst], slot, packed);
        vec3 push = PUSH_AT(p, xyz(sk_load_part(run->vector[SK_X], slot, packed)), xyz(v), v.w);
        f.x += push.x, f.y += push.y, f.z += push.z;
        sk_store_part(run->vector[op->dst], slot, packed, f);
    }
}
#endif

#ifdef STEER
void SK_KERNEL(kernel)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    const sk_force *force = op->rule;
    PARAMS p = *(const PARAMS *)force->params;
    size_t own = SIZE_MAX; // the slot of the particle that it is placed at, checked when the plan was written
#ifdef LOOKS_FROM
    if (sk_force_particle(force) >= 0) {
        own = run->slot_of[sk_force_particle(force)];
        sk_vec4 at = sk_load(run->vector[SK_X], op->packed, own);
        p.LOOKS_FROM[0] = (double)at.x, p.LOOKS_FROM[1] = (double)at.y, p.LOOKS_FROM[2] = (double)at.z;
    }
#endif
    const exact dt = op->dt; // which what follows would read anew after every store
    for (size_t slot = begin; slot < end; slot += SK_PART) {
        bool packed = slot < op->packed;
        vec4 x = sk_load_part(run->vector[SK_X], slot, packed);
        flag moved = sk_lanes_between(slot, force->moved.first_slot, force->moved.end_slot);
        if (own - slot < SK_PART) moved[own - slot] = 0;
        vec4 change = STEER(p, xyz(x), dt);
#ifdef SELDOM // tested lane by lane, so that results do not depend on the width
        moved &= (change.x != 0) | (change.y != 0) | (change.z != 0) | (change.w != 0);
        if (none(moved)) continue;
#endif
        vec4 s = sk_load_part(run->vector[op->dst], slot, packed);
        s.x = sk_plus_where(moved, s.x, change.x), s.y = sk_plus_where(moved, s.y, change.y);
        s.z = sk_plus_where(moved, s.z, change.z), s.w = sk_plus_where(moved, s.w, change.w);
        sk_store_part(run->vector[op->dst], slot, packed, s);
    }
}
#endif

#ifdef SHIFT
/* Moves particles in all vectors that hold present or earlier positions. */
SK_INLINE void shift(sk_run *run, const sk_op *op, size_t slot, flag moved, vec4 x, vec3 by) {
    moved &= (by.x != 0) | (by.y != 0) | (by.z != 0);
    if (none(moved)) return;
    vec4 before = sk_load_part(run->vector[SK_PREVIOUS], slot, false); // always quads
    sk_store_part(run->vector[SK_X], slot, slot < op->packed, vec4_of(pick3(moved, plus(xyz(x), by), xyz(x)), x.w));
    before = vec4_of(pick3(moved, plus(xyz(before), by), xyz(before)), before.w);
    sk_store_part(run->vector[SK_PREVIOUS], slot, false, before);
}
#endif

#ifdef BOUND
void SK_KERNEL(kernel)(sk_run *run, const sk_op *op, size_t begin, size_t end) {
    const sk_force *force = op->rule;
    const PARAMS p = *(const PARAMS *)force->params;
    const exact dt = op->dt; // which what follows would read anew after every store
    for (size_t slot = begin; slot < end; slot += SK_PART) {
        bool packed = slot < op->packed;
        vec4 x = sk_load_part(run->vector[SK_X], slot, packed);
        vec4 v = sk_load_part(run->vector[SK_V], slot, packed), steering = {0};
        if (op->source[2] != SK_NONE) steering = sk_load_part(run->vector[op->source[2]], slot, packed);
        flag moved = sk_lanes_between(slot, force->moved.first_slot, force->moved.end_slot);
#ifdef SHIFT
        if (force->type->shader.shifts(&p)) {
            shift(run, op, slot, moved & (x.w > 0), x, SHIFT(p, xyz(x)));
            continue;
        }
#endif
        vec3 bound = BOUND(p, x, xyz(v), steering, dt);
        moved &= (bound.x != v.x) | (bound.y != v.y) | (bound.z != v.z);
        if (none(moved)) continue; // most particles are mostly within bounds, and storing quads takes long
        sk_store_moved(run->vector[SK_V], slot, packed, vec4_of(pick3(moved, bound, xyz(v)), v.w));
    }
}
#endif

#elif defined(PUSH)

/* The force on one particle. */
static void at(const void *params, const double v[3], double mass, double force[3]) {
    vec3 f = PUSH(*(const PARAMS *)params, (vec3){v[0], v[1], v[2]}, mass);
    force[0] = f.x, force[1] = f.y, force[2] = f.z;
}

#endif
