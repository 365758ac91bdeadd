/* What is near within an implicit solve (press.c): the pairs that press their features apart by forces. */
#ifndef SK_CONTACT_PRESS_H
#define SK_CONTACT_PRESS_H

#include "base/quad.h"
#include "plan/op.h"

/* A pair that presses its features apart within an implicit solve, as it was when the substep began. */
typedef struct sk_press {
    uint32_t slot[4], at[4]; /* of corners, and their numbers among all that press */
    real weight[4];
    sk_vec3 normal, surface; /* surface: the velocity of the collider that one of both is, m/s */
    real wanted, stiffness;  /* m, N/m */
    real grip, rest;         /* the most that friction is, N; m/s: what is slower all but rests */
} sk_press;
/* What the solve's matrix has of one that does press: a symmetric block, times the weights of both corners. */
typedef struct sk_pressing {
    sk_quad column[3];
    uint32_t at[4];
    real weight[4];
} sk_pressing;
/* All of them, in the order of pairs. */
typedef struct sk_presses {
    struct {
        sk_press *data;
        size_t count, capacity;
    } pair;
    struct {
        sk_pressing *data;
        size_t count, capacity;
    } now;            /* those that press where the matrix was last asked for */
    uint32_t *number; /* by vertex: its number among those that press, from 1 on; */
    uint32_t *slot;   /* and of these, their slots */
    size_t slot_count;
} sk_presses;

/* They run in this order in a substep; products are those of the matrix whose diagonal was asked for last. */
sk_op_kernel sk_press_begin, sk_press_force, sk_press_diagonal, sk_press_apply;

#endif
