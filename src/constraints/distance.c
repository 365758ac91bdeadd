/* Distance: C = |p0 - p1| - L. As a force it is the classical spring and damper pair. */
#define SK_ARITY 2
#define SK_RESTS 1
#ifndef SK_FORMULA // a test defines another formula and unit
#define SK_FORMULA "constraints/emitted/distance.h"
#define SK_UNIT distance
#define SK_BEYOND beyond
#endif
#define SK_WITH_STRIPS
#define SK_WITH_STRAIN
#define SK_WITH_LIMITS
#define SK_ACROSS
#include "constraints/element.h"

#if defined SK_ISA && defined SK_BEYOND
/* By squares, since most spans are slack, and a root takes as long as the rest; with a margin for rounding. */
SK_INLINE sk_mask beyond(const sk_element *e, sk_wide most) {
    const real nearly = (real)0.99999;
    sk_wide x = e->x[0].x - e->x[1].x, y = e->x[0].y - e->x[1].y, z = e->x[0].z - e->x[1].z;
    sk_wide reach = nearly * (e->rest[0] + most);
    return sk_more(z * z + (x * x + y * y), reach * reach);
}
#endif

#include "constraints/element_kind.h"

SK_KERNELS(sk_any_beyond_kernel, any_beyond);
#ifdef SK_ISA
bool SK_KERNEL(any_beyond)(const sk_batch *batch, const sk_vec4 *x, real most) {
    const real nearly = (real)0.99999, square = nearly * (1 + most) * (1 + most); // for rounding
    for (size_t begin = 0; begin < batch->count; begin += SK_PART) {
        uint32_t from[SK_PART], to[SK_PART];
        sk_wide rest;
        for (size_t l = 0; l < SK_PART; l++) {
            const size_t e = begin + l < batch->count ? begin + l : batch->count - 1;
            from[l] = batch->slot[2 * e], to[l] = batch->slot[2 * e + 1], rest[l] = batch->rest[e];
        }
        const sk_wide4 a = sk_gather(x, from), b = sk_gather(x, to);
        const sk_wide3 r = {a.x - b.x, a.y - b.y, a.z - b.z};
        if (sk_any(~sk_at_most(sk_dot_wide(r, r), square * rest * rest))) return true; // also of what is no number
    }
    return false;
}
#endif

#ifndef SK_ISA

static const skein_field fields[] = {
    SK_REAL(sk_material, stiffness, "stiffness", "N/m", 1e4, 0, SK_UNBOUNDED,
            "force a metre of stretch; \"infinite\" is rigid (position methods only)"),
    SK_REAL(sk_material, damping, "damping", "N s/m", 0, 0, SK_FAR,
            "force a metre a second of stretching; it does not slow other motion"),
};

const sk_constraint_type sk_distance = {
    .kind = {"distance", "keeps two particles at their rest distance (a spring and damper)", SKEIN_CONSTRAINT, fields,
             sizeof fields / sizeof *fields, sizeof(sk_material)},
    SK_ELEMENT_RULES,
    .limit = SK_WALKS_OF(limit),
    .limit_moving = SK_WALKS_OF(limit_moving),
    .strain = strain,
    .any_beyond = SK_EACH_ISA(any_beyond),
};
#endif
