/* What a rule is on a graphics card: its arithmetic in GLSL, and its parameters as the shader sees them.
 *
 * A kind whose arithmetic stands in a marked section (base/arithmetic.h) names that file: the section is GLSL as it is,
 * and gpu/ops.c makes the struct of parameters and the calls from the kind's fields. Others have a .glsl file.
 * gpu/ joins the texts of neighbouring ops of the plan to one compute shader. In a .glsl file '@' stands for the op's
 * number in that shader, so that rules of one kind do not collide: `rule@[k]` is the k-th vector of the rule's block.
 * force.h and collider.h say what the file must define. Text that depends on parameters, such as a formula, is written
 * by `write` and precedes the file's. */
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
    /* Returns NULL if it can run on a card with these parameters, else the reason, as the end of a sentence. The
     * pointer is NULL for kinds that always can. */
    const char *(*refuse)(const void *params);
    /* The rest may be NULL. Writes text that precedes the file's, with '@' as there; false when there is no memory. */
    bool (*write)(const void *params, void (*put)(void *user, const char *text), void *user);
    /* Whether it depends on time, which is then in op@[1].z; NULL: it never does. */
    bool (*changes)(const void *params);
    /* Whether a rule that bounds velocities moves particles instead, by shift@ (forces/force.h). */
    bool (*shifts)(const void *params);
} sk_shader;

/* Writes three parameters into the first three components of a block's vector. */
static inline void sk_shader_vector(float vector[4], const double v[3]) {
    for (int k = 0; k < 3; k++) vector[k] = (float)v[k];
}

#endif
