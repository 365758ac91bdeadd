/* Nearest points of pairs, a vector of them at a time: a vertex and a triangle, two edges (Ericson, Real-Time Collision
 * Detection, 5.1). All branches are worked out, and the right one is chosen. Where features touch, the normal is 0. */
#ifndef SK_CONTACT_CLOSEST_H
#define SK_CONTACT_CLOSEST_H

#include "contact/touch.h"

#define LEAST_SQUARE ((real)1e-20) /* m2: what is nearer has no direction */
#define LEAST_AREA ((real)1e-30)
#define PARALLEL ((real)1e-6)

/* Where pairs are nearest, as sk_pairs has it. */
typedef struct nearest_points {
    sk_wide distance, share[2];
    sk_wide3 normal;
} nearest_points;

SK_INLINE sk_wide3 between(sk_wide4 a, sk_wide4 b) {
    return (sk_wide3){a.x - b.x, a.y - b.y, a.z - b.z};
}

SK_INLINE sk_wide at_least(sk_wide a, real least) {
    return sk_select(sk_more(sk_splat(least), a), sk_splat(least), a);
}

/* From 0 to 1. */
SK_INLINE sk_wide clamped(sk_wide a) {
    a = at_least(a, 0);
    return sk_select(sk_more(a, sk_splat(1)), sk_splat(1), a);
}

/* Points that r leads between. */
SK_INLINE nearest_points points_apart(sk_wide3 r, sk_wide u, sk_wide v) {
    sk_wide square = sk_dot_wide(r, r), length = sk_wide_sqrt(square);
    sk_wide scale = sk_keep(sk_more(square, sk_splat(LEAST_SQUARE)), sk_splat(1) / at_least(length, (real)1e-10));
    return (nearest_points){length, {u, v}, {r.x * scale, r.y * scale, r.z * scale}};
}

/* Where features are nearest within themselves, some normal n of both is the pair's: r leads from one to the other. */
SK_INLINE nearest_points points_within(nearest_points points, sk_mask within, sk_wide3 n, sk_wide3 r) {
    sk_wide square = sk_dot_wide(n, n), along = sk_dot_wide(n, r);
    within &= sk_more(square, sk_splat(LEAST_AREA));
    sk_wide scale = sk_splat(1) / sk_wide_sqrt(at_least(square, LEAST_AREA));
    scale = sk_select(sk_negative(along), -scale, scale);
    points.distance = sk_select(within, along * scale, points.distance);
    points.normal.x = sk_select(within, n.x * scale, points.normal.x);
    points.normal.y = sk_select(within, n.y * scale, points.normal.y);
    points.normal.z = sk_select(within, n.z * scale, points.normal.z);
    return points;
}

/* A vertex and a triangle, by the places of all corners. */
SK_INLINE nearest_points nearest_of_corners(const sk_wide4 x[4]) {
    const sk_wide one = sk_splat(1);
    sk_wide3 ab = between(x[2], x[1]), ac = between(x[3], x[1]), ap = between(x[0], x[1]);
    sk_wide bb = sk_dot_wide(ab, ab), bc = sk_dot_wide(ab, ac), cc = sk_dot_wide(ac, ac);
    sk_wide bp = sk_dot_wide(ab, ap), cp = sk_dot_wide(ac, ap), area = bb * cc - bc * bc;
    sk_wide inverse = one / at_least(area, LEAST_AREA);
    sk_wide u = (cc * bp - bc * cp) * inverse, v = (bb * cp - bc * bp) * inverse;
    // on the edges: a b at t1, a c at t2, b c at t3
    sk_wide t1 = clamped(bp / at_least(bb, LEAST_AREA)), t2 = clamped(cp / at_least(cc, LEAST_AREA));
    sk_wide t3 = clamped((cp - bp - bc + bb) / at_least(bb - bc - bc + cc, LEAST_AREA)), u3 = one - t3;
    sk_wide q1 = t1 * (t1 * bb - bp - bp), q2 = t2 * (t2 * cc - cp - cp);
    sk_wide q3 = u3 * (u3 * bb - bp - bp) + t3 * (t3 * cc - cp - cp) + (u3 + u3) * t3 * bc;
    sk_mask first = sk_at_most(q1, q2), third = sk_more(sk_select(first, q1, q2), q3);
    sk_wide edge_u = sk_select(third, u3, sk_keep(first, t1)), edge_v = sk_select(third, t3, sk_keep(~first, t2));
    sk_mask inside = ~sk_negative(u) & ~sk_negative(v) & sk_at_most(u + v, one) & sk_more(area, sk_splat(LEAST_AREA));
    u = sk_select(inside, u, edge_u), v = sk_select(inside, v, edge_v);
    sk_wide3 r = {ap.x - u * ab.x - v * ac.x, ap.y - u * ab.y - v * ac.y, ap.z - u * ab.z - v * ac.z};
    sk_wide3 n = {ab.y * ac.z - ab.z * ac.y, ab.z * ac.x - ab.x * ac.z, ab.x * ac.y - ab.y * ac.x};
    return points_within(points_apart(r, u, v), inside, n, ap);
}

SK_INLINE nearest_points nearest_of_edges(const sk_wide4 x[4]) {
    sk_wide3 a = between(x[1], x[0]), b = between(x[3], x[2]), r = between(x[0], x[2]);
    sk_wide aa = sk_dot_wide(a, a), bb = sk_dot_wide(b, b), ab = sk_dot_wide(a, b);
    sk_wide ar = sk_dot_wide(a, r), br = sk_dot_wide(b, r), apart = aa * bb - ab * ab;
    sk_wide inverse_a = sk_splat(1) / at_least(aa, LEAST_AREA), inverse_b = sk_splat(1) / at_least(bb, LEAST_AREA);
    sk_wide s = clamped((ab * br - ar * bb) / at_least(apart, LEAST_AREA));
    s = sk_select(sk_more(apart, sk_splat(PARALLEL) * aa * bb), s, sk_splat((real)0.5));
    sk_wide free = (ab * s + br) * inverse_b, t = clamped(free);
    s = sk_select(sk_differ(free, t), clamped((ab * t - ar) * inverse_a), s);
    sk_wide3 d = {r.x + s * a.x - t * b.x, r.y + s * a.y - t * b.y, r.z + s * a.z - t * b.z};
    // within both edges, they lie across each other: their directions know the normal better than a distance of nothing
    sk_wide3 n = {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
    sk_mask within = sk_positive(s) & sk_more(sk_splat(1), s) & sk_positive(t) & sk_more(sk_splat(1), t) &
                     sk_more(apart, sk_splat(PARALLEL) * aa * bb);
    return points_within(points_apart(d, s, t), within, n, r);
}

SK_INLINE nearest_points nearest_points_of(const sk_wide4 x[4], int sort) {
    return sort == SK_EDGES ? nearest_of_edges(x) : nearest_of_corners(x);
}

#endif
