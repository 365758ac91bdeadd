/* The kinds of ops, a row each: with the op's own members this is all that the code that runs, fuses, explains,
 * reverses or translates a plan knows of an op. Functions that statements call are in .glsl files. In reverse a sum that also
 * reads dst is a correction, one whose rule is a uniform force a pull, and elastic ops that write X are projections. */
#include "plan/op.h"

#define BIT(vector) (1u << (vector))
#define X BIT(SK_X)
#define V BIT(SK_V)
#define F BIT(SK_F)
#define X0 BIT(SK_X0)
#define P BIT(SK_PREVIOUS)

/* The end of a prediction on a card, given the new V: V0 = V, X0 = X, X += h V; or X0 = X + h V where only the
 * correction reads X0. */
static const char *set_out(const sk_op *op) {
#define DRIFT "    X.xyz = X.xyz + op@[0].w * V.xyz;\n"
    if (op->source[2] == SK_X) return DRIFT "    X0.xyz = X.xyz;\n";
    if (op->source[2] == SK_V0) return "    V0.xyz = V.xyz;\n    X0.xyz = X.xyz;\n" DRIFT;
    return "    X0.xyz = X.xyz;\n" DRIFT;
}

#define PULLED "    V.xyz = pulled@(X.w, V.xyz);\n"
#define CONTACT_CALL                                                                                       \
    "vec4 probe@(vec3 x) {\n"                                                                              \
    "    sk_pose where = sk_pose(pose@[0].xyz, pose@[3].xyz, pose@[4].xyz, pose@[5].xyz, pose@[6].xyz);\n" \
    "    sk_contact contact = $k_probe(params@(), where, x);\n"                                            \
    "    return vec4(contact.normal, contact.distance);\n}\n"
#define CONTACT_FILES .shared = "colliders/response", .file = "colliders/contact"
#define PUSH_CALL                                                              \
    "#define sum@ vec3\n"                                                      \
    "vec3 start@(vec3 heading) { return vec3(0); }\n"                          \
    "void meet@(inout vec3 sum, vec3 apart, float square, vec3 direction) {\n" \
    "    if (square > 0) sum += $k_push(params@(), apart, sqrt(square));\n"    \
    "}\n"                                                                      \
    "vec3 finish@(vec3 sum, float dt) { return sum; }\n"

const sk_op_type sk_op_types[SK_OP_KIND_COUNT] = {
    [SK_OP_PACK] = {"pack", .reverse = SK_REVERSE_NOTHING},
    [SK_OP_UNPACK] = {"unpack", .reverse = SK_REVERSE_NOTHING},

    /* ---- whole vectors: plan/combine.c ---- */
    [SK_OP_SUM] = {"combine", &sk_combine_sum, "$s", .arithmetic = true, .reverse = SK_REVERSE_SUM,
                   .reads = SK_USES_SOURCES, .writes = SK_USES_DST, .card = {.statement = "    $d.xyz = $s;\n"}},
    // on a card too the same operations that predicted p, so that a p that nothing has moved since gives exactly 0
    [SK_OP_CORRECTION] = {"combine", &sk_combine_correction, "$d + $1 ($p - $q$b)", .arithmetic = true,
                          .reverse = SK_REVERSE_SUM, .reads = SK_USES_SOURCES | SK_USES_DST, .writes = SK_USES_DST,
                          .card = {.statement = "    $d.xyz = $d.xyz + op@[0].x * ($p.xyz - $b);\n"}},
    [SK_OP_KICK] = {"combine", &sk_combine_kick, "$p + $1 w $q", .arithmetic = true, .reverse = SK_REVERSE_KICK,
                    .reads = SK_USES_SOURCES | X, .writes = SK_USES_DST,
                    .card = {.statement = "    $d.xyz = $p.xyz + op@[0].x * X.w * $q.xyz;\n"}},
    [SK_OP_WIPE] = {"combine", &sk_combine_wipe, "0", .arithmetic = true, .reverse = SK_REVERSE_SUM,
                    .reads = SK_USES_SOURCES, .writes = SK_USES_DST, .card = {.statement = "    $d = vec4(0);\n"}},
    [SK_OP_STEER] = {"combine", &sk_combine_steer, "$d + $q, where free", .arithmetic = true,
                     .reads = SK_USES_SOURCES | X, .writes = SK_USES_DST,
                     .card = {.statement = "    if (X.w > 0) $d.xyz += $q.xyz;\n"}},
    [SK_OP_LEAD] = {"combine", &sk_combine_lead, "$p + $1 $q where pinned", .arithmetic = true,
                    .reads = SK_USES_SOURCES | X, .writes = SK_USES_DST,
                    .card = {.statement = "    if (!(X.w > 0)) $d.xyz += op@[0].x * $q.xyz;\n"}},
    [SK_OP_PULL] = {"combine", &sk_combine_pull, "V + h ($u)", SK_RULE_UNIFORM, .arithmetic = true,
                    .reverse = SK_REVERSE_SUM, .reads = X | V, .writes = V},
    [SK_OP_PREDICT] = {"combine", &sk_combine_predict, "X + h V, V + h w F; $o", .arithmetic = true, .reads = X | V | F,
                       .writes = X | V | X0 | SK_USES_THIRD,
                       .card = {.statement = "    V.xyz = V.xyz + op@[0].w * X.w * F.xyz;\n$o", .other = set_out}},
    [SK_OP_PREDICT_UNIFORM] = {"combine", &sk_combine_predict_uniform, "X + h V, V + h ($u); $o", SK_RULE_UNIFORM,
                               .arithmetic = true, .reads = X | V, .writes = X | V | X0 | SK_USES_THIRD,
                               .card = {.statement = PULLED "$o", .file = "gpu/pull", .other = set_out}},
    // in the last iteration X0 stays as it is, so that it counts as read
    [SK_OP_CORRECT_AND_PREDICT] = {"combine", &sk_combine_correct_and_predict,
                                   "V + $1 (X - X0); X + h V, V + h ($u); X0 = X, but for the last iteration",
                                   SK_RULE_UNIFORM, .arithmetic = true, .reads = X | V | X0,
                                   .writes = X | V | X0 | SK_USES_THIRD,
                                   .card = {.statement = "    V.xyz = V.xyz + op@[0].x * (X.xyz - X0.xyz);\n"
                                                         "    if (!last_iteration) {\n" PULLED "$o    }\n",
                                            .file = "gpu/pull",
                                            .other = set_out}},
    [SK_OP_REST] = {"combine", &sk_combine_rest, "$p, 0 where at most $1 m/s", .arithmetic = true,
                    .reverse = SK_REVERSE_NOTHING},
    [SK_OP_PASS] = {"combine", .arithmetic = true, .reverse = SK_REVERSE_BY_SOLVE},

    /* ---- forces ---- */
    [SK_OP_SORT] = {"grid", .sorts = true, .reads = X | V},
    [SK_OP_SORT_ON] = {"grid", .goes_on = true, .reads = X | V},
    [SK_OP_FIELD] =
        {"field", .rule = SK_RULE_FORCE, .reverse = SK_REVERSE_FIELD, .reads = X | V | SK_USES_DST,
         .writes = SK_USES_DST,
         .card = {.statement = "    $d.xyz $= force@(X.xyz, V.xyz, V.w);\n",
                  .call = "vec3 force@(vec3 x, vec3 v, float mass) { return $k_force(params@(), $xv, mass); }\n"}},
    [SK_OP_STEERING] = {"field", .rule = SK_RULE_FORCE, .reads = X | V | SK_USES_DST, .writes = SK_USES_DST,
                        .card = {.statement = "    $d += steer@(X.xyz, op@[0].w);\n",
                                 .call = "vec4 steer@(vec3 x, float dt) { return $k_steer(params@(), x, dt); }\n"}},
    [SK_OP_AVOID] = {"field", .rule = SK_RULE_COLLIDER, .reads = X | V | SK_USES_DST, .writes = SK_USES_DST,
                     .at_end = true,
                     .card = {.statement = "    $d += avoid@(X.xyz, V.xyz);\n",
                              .call = CONTACT_CALL,
                              .shared = "colliders/avoid",
                              .file = "colliders/look_ahead"}},
    // pair formulas read the time at the end of the substep
    [SK_OP_NEIGHBOUR] = {"neighbour", .rule = SK_RULE_FORCE, .walks = true, .at_end = true,
                         .reads = X | V | SK_USES_DST, .writes = SK_USES_DST,
                         .card = {.statement = "    $d.xyz += walk@(place, X.xyz, V.xyz);\n",
                                  .call = PUSH_CALL,
                                  .file = "gpu/walk"}},
    [SK_OP_BOUND] = {"limit", .rule = SK_RULE_FORCE, .reads = X | V | SK_USES_THIRD, .writes = V,
                     .card = {.statement = "    V.xyz = bound@(X, V.xyz, $r, op@[0].w);\n",
                              .call = "vec3 bound@(vec4 x, vec3 v, vec4 steering, float dt) {\n"
                                      "    return $k_bound(params@(), x, v, steering, dt);\n}\n"}},
    [SK_OP_SHIFT] = {"limit", .rule = SK_RULE_FORCE, .reads = X | P, .writes = X | P,
                     .card = {.statement =
                                  "    if (X.w > 0) { vec3 shift = shift@(X.xyz); X.xyz += shift; P.xyz += shift; }\n",
                              .call = "vec3 shift@(vec3 x) { return $k_shift(params@(), x); }\n"}},

    /* ---- constraints ---- */
    [SK_OP_FORCE] = {"force", .reverse = SK_REVERSE_ELASTIC},
    [SK_OP_PROJECT] = {"project", .reverse = SK_REVERSE_ELASTIC},
    [SK_OP_MULTIPLIER] = {"multiplier", .reverse = SK_REVERSE_NOTHING},
    [SK_OP_LIMIT] = {.name = "limit"},

    /* ---- contact ---- */
    [SK_OP_CONTACT_FORCE] = {"contact F", .rule = SK_RULE_COLLIDER, .reads = X | V | F, .writes = F,
                             .card = {.statement = "    contact_force@(X, V, F);\n",
                                      .call = CONTACT_CALL,
                                      CONTACT_FILES}},
    [SK_OP_CONTACT_VELOCITY] = {"contact V", .rule = SK_RULE_COLLIDER, .reads = X | V | SK_USES_THIRD, .writes = X | V,
                                .card = {.statement = "    contact_impulse@(X, V, $r);\n",
                                         .call = CONTACT_CALL,
                                         CONTACT_FILES}},
    [SK_OP_CONTACT_POSITION] = {"contact X", .rule = SK_RULE_COLLIDER, .reads = X | SK_USES_THIRD, .writes = X,
                                .card = {.statement = "    contact_push@(X, $r);\n",
                                         .call = CONTACT_CALL,
                                         CONTACT_FILES}},
    [SK_OP_CONTACT_SWEEP] = {"contact X", .rule = SK_RULE_COLLIDER},
    [SK_OP_CONTACT_UPDATE] =
        {"contact XV", .rule = SK_RULE_COLLIDER, .reads = X | V | SK_USES_SECOND | SK_USES_THIRD, .writes = X | V,
         .card = {.statement = "    contact_update@(X, V, $f, $q, $r);\n", .call = CONTACT_CALL, CONTACT_FILES}},
    [SK_OP_MEET] = {.name = "meet"},

    /* ---- implicit solves ---- */
    [SK_OP_APPLY] = {"apply", .reverse = SK_REVERSE_BY_SOLVE},
    [SK_OP_LINEARISE] = {"linearise", .reverse = SK_REVERSE_BY_SOLVE},
    [SK_OP_CONTACT_FILTER] = {.name = "contact S"},
    [SK_OP_CALL] = {"call", .factors = true, .reverse = SK_REVERSE_BY_SOLVE},
    [SK_OP_SOLVE] = {"solve", .leads = true, .reverse = SK_REVERSE_SOLVE},
    [SK_OP_PART] = {"part", .leads = true, .reverse = SK_REVERSE_BY_SOLVE},
    [SK_OP_REPEAT] = {"repeat", .leads = true, .reverse = SK_REVERSE_NOTHING},
};

/* Replaces the bits that stand for the op's dst and sources by the bits of those vectors. */
static uint32_t resolved(const sk_op *op, uint32_t uses) {
    const uint32_t own[] = {SK_USES_DST, SK_USES_FIRST, SK_USES_SECOND, SK_USES_THIRD};
    const sk_vector vector[] = {op->dst, op->source[0], op->source[1], op->source[2]};
    for (int i = 0; i < 4; i++)
        if (uses & own[i]) uses = (uses & ~own[i]) | BIT(vector[i]);
    return uses & ~BIT(SK_NONE);
}

uint32_t sk_op_writes(const sk_op *op) {
    return resolved(op, sk_op_types[op->kind].writes | op->also_writes);
}

uint32_t sk_op_reads(const sk_op *op) {
    uint32_t uses = sk_op_types[op->kind].reads, writes = sk_op_writes(op);
    if (op->sets) uses &= ~(uint32_t)SK_USES_DST;
    // X and V keep their w when x, y and z are written, and slots outside of the op's range keep everything
    return resolved(op, uses | op->also_reads) | (writes & (op->inner ? ~0u : X | V));
}
