/* What a rule is on a graphics card: its arithmetic in GLSL, and its parameters as the shader sees them.
 *
 * A kind that says its arithmetic (base/arithmetic.h) names its file; that arithmetic is GLSL as it is, and gpu/ops.c
 * makes the struct of parameters and the calls from the kind's fields. A kind of which that cannot be said has a .glsl
 * file of its own. gpu/ puts the texts of an op's rule and of its neighbours in the plan together to one compute
 * shader. In a .glsl file '@' stands for the op's number in that shader, so that rules of one kind do not meet:
 * `rule@[k]` is the k-th vector of the rule's block. What it must define is in the header of its floor (force.h,
 * collider.h). What of a text depends on parameters, a formula say, the type writes itself; it stands before the file.
 */
#ifndef SK_PLAN_SHADER_H
#define SK_PLAN_SHADER_H

#include <stdbool.h>
#include <stddef.h>

typedef struct sk_shader {
    const char *arithmetic; /* "forces/gravity": of src/forces/gravity.c, whose names begin with "gravity_"; */
    const char *file;       /* or "forces/flocking": src/forces/flocking.glsl; neither: it cannot run on a card */
    size_t size;            /* of a file's block, in vectors of four floats */
    /* Fills a file's block, which is zero before. */
    void (*pack)(const void *params, float (*block)[4]);
    /* NULL if it can run on a card with these parameters, else why not, as the end of a sentence. Itself NULL: always.
     */
    const char *(*refuse)(const void *params);
    /* The rest may be NULL. Text before the file's, with '@' as there; false when there is no memory. */
    bool (*write)(const void *params, void (*put)(void *user, const char *text), void *user);
    /* Whether it is another at another time, which is then in op@[1].z; NULL: it never is. */
    bool (*changes)(const void *params);
    /* Whether a rule that bounds moves particles, by shift@ (forces/force.h), instead. */
    bool (*shifts)(const void *params);
} sk_shader;

/* Three numbers of a parameter struct, as the first three of a block's vector. */
static inline void sk_shader_vector(float vector[4], const double v[3]) {
    for (int k = 0; k < 3; k++) vector[k] = (float)v[k];
}

#endif
