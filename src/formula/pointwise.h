/* A formula of one particle, for colliders and forces: their kernels call it on a vector of places at a time. Made from
 * a text field (parameters.h) with its object; not changed by running, so threads share one. */
#ifndef SK_FORMULA_POINTWISE_H
#define SK_FORMULA_POINTWISE_H

#include "formula/formula.h"
#include "formula/parameters.h"
#include "formula/tape.h"

enum {
    SK_POINTWISE_MOST_OUTPUTS = 12,
    SK_POINTWISE_BLOCK = SKEIN_FORMULA_MOST_PARAMETERS / 4 /* vectors of a shader's block that hold the parameters */
};

typedef struct sk_pointwise {
    skein_formula *formula;
    sk_tape tape;
    int parameters;
    sk_node output[SK_POINTWISE_MOST_OUTPUTS]; /* of the graph */
    /* for single places, by whoever owns the world: which nodes the value and the outputs need, and room for theirs */
    bool *live;
    double *values;
} sk_pointwise;

/* Chooses the outputs of the tape, and may extend the formula's graph for them; returns how many nodes. */
typedef size_t sk_pointwise_choice(skein_formula *formula, sk_node outputs[static SK_POINTWISE_MOST_OUTPUTS]);

/* Makes one from the text of a field; `first` is said when its object is made, and then every parameter has to be
 * named. Fails with the field as the place. */
skein_status sk_pointwise_create(const char *field, const char *text, skein_formula_desc desc,
                                 sk_pointwise_choice *choose, const skein_kind *own, bool first,
                                 sk_allocator *allocator, sk_pointwise **made, skein_error *error);
void sk_pointwise_destroy(sk_pointwise *pointwise, sk_allocator *allocator); /* NULL is allowed */

/* As many places as a vector has (`v` may be NULL where the formula takes no velocities); output k into out[k]. Lanes
 * with an output that is not finite, or over SK_FAR, get 0s and count as guarded. */
typedef void sk_pointwise_run(const sk_pointwise *pointwise, const double *parameters, double time, const sk_wide3 *p,
                              const sk_wide3 *v, sk_wide *out, sk_mask *guarded);
extern sk_pointwise_run *const sk_pointwise_run_of[SK_ISA_COUNT];

/* The same on a graphics card: the parameters as vectors of a block, and as GLSL
 *     void formula@(vec3 p0, vec3 v0, float t, out float o[outputs])
 * for a rule whose block has them from vector `first` on. False when there is no memory. */
void sk_pointwise_pack(const sk_pointwise *pointwise, const double *parameters, float (*block)[4]);
bool sk_pointwise_put_glsl(const sk_pointwise *pointwise, int first, void (*put)(void *user, const char *text),
                           void *user);

/* The value at one place, in double, and whether it or an output had to be guarded (NULL: never mind). Not for several
 * threads at once. */
void sk_pointwise_value(const sk_pointwise *pointwise, const double *parameters, double time, const double p[3],
                        const double v[3], double value[3], bool *guarded);

#endif
