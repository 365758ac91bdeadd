/* Where particles were when the substep began, for files of kernels: whether the surface lay in between, and whether they were inside.
 *
 *        n  ^                      s is how far off the tangent plane of what is nearest to x, at the end, the start x0 was:
 *     ------|------ 0              where s is the thickness or more, as it is wherever nothing is fast or deep, the particle
 *        x  o   ^                  came from outside through the surface that it will be pushed out of, and nothing
 *          /    | s < 0            more is to be asked. Of a convex solid x0 is at least s away.
 *     x0  o     v
 *
 *   s < 0                    the way may lead through the solid, or x0 was inside: rays say which (cast.c), and what crosses the
 *                            surface stops there (swept.c), on the side that it came from
 *   s < thickness            by more than a tenth of recovery h: it may have been inside at x0, so that its distance d0 there is
 *                            found. It is pushed no further than to d0 + recovery h, and that push is no velocity; nor is d0 more
 *                            than the way leads: who falls through the hole of an open mesh is inside at once
 *
 * Of solids that are not convex a long way may also lead through a wall and end before another one that faces its start:
 * ways longer than five thicknesses are asked for all the same, wherever the surface is nearer than they are long. */
#include "colliders/response.h"

typedef struct origin {
    bool known, moves, deforms, settles; /* settles: what stops gives the velocity its move */
    sk_vector vector;
    sk_passing passing;
    real long_way;       /* the square of five thicknesses */
    real least;          /* s and the reach together are at least this where nothing is to be asked */
    sk_vec3 shift, turn; /* of the collider in the substep: m, rad */
    real bend;           /* what turning adds to that at an arm of 1 m, at most */
} origin;

/* Of an op that answers at the end of a substep. */
SK_INLINE origin find_origin(const sk_op *op, const sk_pose *pose) {
    const sk_collider *collider = op->rule;
    real thickness = (real)collider->common->thickness, h = (real)op->dt;
    origin o = {.settles = op->source[2] == SK_V0, .deforms = collider->type->deforms};
    o.vector = o.settles ? op->source[1] : op->source[2];
    o.known = o.vector != SK_NONE;
    o.passing = collider->type->cross ? SK_NEVER_PASSED : collider->type->passing;
    o.long_way = 25 * thickness * thickness;
    real let = (real)0.1 * (real)(op->dt * collider->common->recovery);
    o.least = thickness + (thickness > let ? thickness - let : 0);
    o.shift = sk_scale(h, pose->velocity), o.turn = sk_scale(h, pose->spin);
    real angle = sk_dot(o.turn, o.turn);
    o.bend = (real)0.5 * angle;
    o.moves = angle > 0 || sk_dot(o.shift, o.shift) > 0;
    return o;
}

/* How far off the tangent plane they were; where the collider turns, at least. */
SK_INLINE sk_wide off_plane(const sk_run *run, const sk_op *op, const sk_pose *pose, const origin *o, size_t slot,
                            const encounter *e, sk_wide3 *way) {
    *way = minus(xyz(e->x), xyz(sk_load_part(run->vector[o->vector], slot, slot < op->packed)));
    sk_wide bend = {0};
    if (o->moves) {
        sk_vec3 t = o->turn, s = o->shift;
        sk_wide3 arm = {e->x.x - pose->position.x, e->x.y - pose->position.y, e->x.z - pose->position.z};
        *way = minus(*way, (sk_wide3){s.x + (t.y * arm.z - t.z * arm.y), s.y + (t.z * arm.x - t.x * arm.z),
                                      s.z + (t.x * arm.y - t.y * arm.x)});
        bend = o->bend * (sk_wide_abs(arm.x) + sk_wide_abs(arm.y) + sk_wide_abs(arm.z));
    }
    sk_wide s = e->distance - sk_dot_wide(*way, e->normal) - bend;
    return o->deforms ? s + (real)op->dt * e->speed : s;
}

/* Whether a way of a shape that is not convex, longer than its end is far off, needs no look: it ends inside, was so all along
 * since it came in, and will be pushed out of the surface that it came through. */
SK_INLINE bool only_enters(const sk_swept *sweep, const double a[3], const double b[3]) {
    double normal[3], part = sk_collider_cross(sweep->collider, &sweep->pose, a, b, normal);
    if (part > 1) return true;
    real p[3][SK_LANES];
    for (int i = 0; i < SK_LANES; i++)
        for (int k = 0; k < 3; k++) p[k][i] = (real)(a[k] + (part + (1 - part) * (i + 1) / SK_LANES) * (b[k] - a[k]));
    sk_sixteen_contacts contacts;
    sk_probe_sixteen_of[0](sweep->collider, &sweep->pose, p, SK_REAL_MAX, &contacts);
    for (int i = 0; i < SK_LANES; i++)
        if (contacts.distance[i] > 0) return false;
    return true;
}

/* Stops those whose way crosses the surface; `behind`: s < 0. Whether any did. */
SK_INLINE bool stop_at_surface(sk_run *run, const sk_op *op, const origin *o, size_t slot, sk_wide3 from,
                               sk_mask crossing, sk_mask behind) {
    bool packed = slot < op->packed, any = false;
    sk_wide4 x = sk_load_part(run->vector[SK_X], slot, packed), v = sk_load_part(run->vector[SK_V], slot, packed);
    real per_step = o->settles ? (real)(1 / op->dt) : 0;
    sk_swept sweep = sk_swept_begin(op->rule, run->time - op->dt, run->time - op->before_end, o->settles);
    for (int l = 0; l < SK_PART; l++) {
        if (!crossing[l]) continue;
        const double a[3] = {(double)from.x[l], (double)from.y[l], (double)from.z[l]};
        double to[3] = {(double)x.x[l], (double)x.y[l], (double)x.z[l]};
        if (!behind[l] && only_enters(&sweep, a, to)) continue;
        if (!sk_swept_stop(&sweep, a, to)) continue;
        any = true;
        real moved[3] = {(real)to[0], (real)to[1], (real)to[2]};
        v.x[l] += per_step * (moved[0] - x.x[l]), v.y[l] += per_step * (moved[1] - x.y[l]),
            v.z[l] += per_step * (moved[2] - x.z[l]);
        x.x[l] = moved[0], x.y[l] = moved[1], x.z[l] = moved[2];
    }
    if (!any) return false;
    sk_store_part(run->vector[SK_X], slot, packed, x);
    if (per_step > 0) sk_store_moved(run->vector[SK_V], slot, packed, v);
    return true;
}

/* Where they began, as the collider sees it where it is now. */
SK_INLINE sk_wide3 find_start(const sk_run *run, const sk_op *op, const origin *o, size_t slot) {
    sk_wide3 x = xyz(sk_load_part(run->vector[o->vector], slot, slot < op->packed));
    if (!o->moves) return x;
    sk_swept sweep = sk_swept_begin(op->rule, run->time - op->dt, run->time - op->before_end, false);
    const real *r = sweep.turn;
    sk_vec3 s = sweep.shift;
    return (sk_wide3){r[0] * x.x + r[1] * x.y + r[2] * x.z + s.x, r[3] * x.x + r[4] * x.y + r[5] * x.z + s.y,
                      r[6] * x.x + r[7] * x.y + r[8] * x.z + s.z};
}

/* Of those that are asked about, stops who comes through, and finds how far those may be pushed that were inside when the substep began. Whether any
 * stopped. (Not of the others that lie beside them: by rounding one of them may seem to have been inside here, and who lies beside whom depends on
 * how many lanes there are.) */
static __attribute__((noinline)) bool look_back(sk_run *run, const sk_op *op, const contact_law *law,
                                                const sk_pose *pose, origin o, size_t slot, sk_mask asked,
                                                encounter *e) {
    const sk_collider *collider = op->rule;
    sk_wide3 from = find_start(run, op, &o, slot), seen = from;
    if (o.deforms) seen = plus(plus(from, times(law->h * e->speed, e->normal)), times(law->h, e->surface));
    sk_wide3 way = minus(xyz(e->x), seen);
    sk_wide s = e->distance - sk_dot_wide(way, e->normal), slack = e->reach - law->thickness;
    sk_mask behind = asked & sk_more(-slack, s), crossing = (sk_mask){0};
    if (o.passing != SK_NEVER_PASSED) crossing = behind;
    if (o.passing == SK_ANY_SHAPE) {
        sk_wide square = sk_dot_wide(way, way), d = e->distance;
        crossing |= asked & sk_more(square, sk_splat(o.long_way)) & (sk_negative(d) | sk_more(square, d * d));
    }
    bool stopped = sk_any(crossing) && stop_at_surface(run, op, &o, slot, seen, crossing, behind);
    sk_mask deep = asked & began_deep(*law, *e, s);
    if (!sk_any(deep)) return stopped;
    sk_contact start;
    collider->type->probe[SK_THIS_ISA](collider->params, pose, &from, &start);
    sk_wide began = o.deforms ? start.distance + law->h * start.speed : start.distance;
    *e = coming_out(*law, *e, deep, depth_before(*law, *e, began, root(dot(way, way))));
    return stopped;
}

/* Probes those at x at the end of a substep, and looks back to where they began where that matters: what crossed the surface on its
 * way is where it stops, and probed there. */
SK_INLINE void probe_at_end(sk_run *run, const sk_op *op, const contact_law *law, const sk_pose *pose, const origin *o,
                            size_t slot, encounter *e) {
    bool packed = slot < op->packed;
    probe(op->rule, law, pose, sk_load_part(run->vector[SK_X], slot, packed), (sk_wide){0}, e);
    e->level = sk_splat(law->thickness);
    e->leaving = (sk_mask){0};
    if (!o->known || (o->passing == SK_NEVER_PASSED && !sk_any(e->touching))) return;
    sk_wide3 way;
    sk_wide s = off_plane(run, op, pose, o, slot, e, &way);
    sk_mask asked = sk_more(sk_splat(o->least), s + e->reach);
    if (o->passing == SK_ANY_SHAPE) asked |= sk_more(sk_dot_wide(way, way), sk_splat(o->long_way));
    asked &= sk_positive(e->x.w);
    if (!sk_any(asked)) return;
    encounter seen = *e;
    bool stopped = look_back(run, op, law, pose, *o, slot, asked, &seen);
    if (stopped) probe(op->rule, law, pose, sk_load_part(run->vector[SK_X], slot, packed), (sk_wide){0}, e);
    e->level = seen.level, e->leaving = seen.leaving;
}
