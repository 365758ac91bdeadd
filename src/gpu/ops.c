/* Each sort of op as the card has it: what it reads, what it writes, its text and numbers, or why it cannot. */
#include "gpu/ops.h"

#include <stdio.h>
#include <string.h>

#define BIT(vector) (1u << (vector))

const char *sk_gpu_vector_name(sk_vector vector) {
    static const char *const names[SK_VECTOR_COUNT] = {"none", "X",  "V",  "F",  "X0", "V0", "P",  "T0",  "T1",  "T2",
                                                       "T3",   "T4", "T5", "T6", "T7", "T8", "T9", "T10", "T11", "S"};
    return names[vector];
}

static bool is_contact(const sk_op *op) {
    return op->kind >= SK_OP_CONTACT_FORCE && op->kind <= SK_OP_CONTACT_UPDATE;
}

static bool is_uniform_prediction(const sk_op *op) {
    return sk_op_is(op, &sk_combine_predict_uniform) || sk_op_is(op, &sk_combine_correct_and_predict);
}

/* Steering clear of a collider, which is the op's rule. */
static bool is_avoid(const sk_op *op) {
    return op->kind == SK_OP_FIELD && sk_op_is(op, &sk_avoid);
}

static bool has_pose(const sk_op *op) {
    return is_contact(op) || is_avoid(op);
}

/* Fields, neighbours, and bounds on velocities: limits on positions are of another sort. */
static const sk_force *force_of(const sk_op *op) {
    if (is_avoid(op)) return NULL;
    bool is_force =
        op->kind == SK_OP_FIELD || op->kind == SK_OP_NEIGHBOUR || (op->kind == SK_OP_LIMIT && op->dst == SK_V);
    return is_force ? op->rule : NULL;
}

static const sk_shader *shader_of(const sk_op *op) {
    if (force_of(op)) return &force_of(op)->type->shader;
    if (has_pose(op)) return &((const sk_collider *)op->rule)->type->shader;
    return NULL;
}

static bool has_text(const sk_shader *shader) {
    return shader && (shader->arithmetic || shader->file);
}

static const skein_kind *kind_of(const sk_op *op) {
    return force_of(op) ? &force_of(op)->type->kind : &((const sk_collider *)op->rule)->type->kind;
}

static const void *params_of(const sk_op *op) {
    if (force_of(op)) return force_of(op)->params;
    return has_pose(op) ? ((const sk_collider *)op->rule)->params : NULL;
}

static bool is_combine(const sk_op *op) {
    static const sk_kernels *const known[] = {
        &sk_combine_sum,     &sk_combine_correction,      &sk_combine_kick,
        &sk_combine_predict, &sk_combine_predict_uniform, &sk_combine_correct_and_predict,
        &sk_combine_wipe,    &sk_combine_steer,           &sk_combine_lead};
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        if (sk_op_is(op, known[i])) return true;
    return false;
}

bool sk_gpu_op_can(const sk_op *op, const char **why) {
    const sk_shader *shader = shader_of(op);
    if (has_text(shader) && shader->refuse && (*why = shader->refuse(params_of(op)))) return false;
    if (op->kind == SK_OP_NEIGHBOUR && force_of(op)->type->phase == SK_PUSHES && force_of(op)->only.some) {
        *why = "where it is 'on' some bodies only";
        return false;
    }
    switch (op->kind) {
    case SK_OP_GRID: return true;
    case SK_OP_REPEAT: return true;
    case SK_OP_COMBINE: return is_combine(op);
    case SK_OP_FIELD:
    case SK_OP_NEIGHBOUR:
    case SK_OP_LIMIT:
    case SK_OP_CONTACT_FORCE:
    case SK_OP_CONTACT_VELOCITY:
    case SK_OP_CONTACT_UPDATE: return has_text(shader);
    case SK_OP_CONTACT_POSITION: return has_text(shader) && op->source[1] == SK_NONE;
    default: return false;
    }
}

static int32_t particle_of(const sk_op *op) {
    const sk_force *force = force_of(op);
    return force ? sk_force_particle(force) : -1;
}

bool sk_gpu_op_has_target(const sk_op *op) {
    return particle_of(op) >= 0;
}

size_t sk_gpu_op_target_to(void) {
    return SK_GPU_OP;
}

/* A slot as two numbers that are exact as floats. */
size_t sk_gpu_op_target_from(const float (*block)[4]) {
    return (size_t)block[1][1] << 16 | (size_t)block[1][3];
}

static bool shifts(const sk_op *op) {
    const sk_shader *shader = shader_of(op);
    return op->kind == SK_OP_LIMIT && shader && shader->shifts && shader->shifts(force_of(op)->params);
}

bool sk_gpu_op_everyone(const sk_op *op, size_t particle_count) {
    const sk_force *force = force_of(op);
    if (force->type->phase == SK_PUSHES) return true;
    return force->moved.first == 0 && force->moved.end == particle_count && force->seen.first == 0 &&
           force->seen.end == particle_count;
}

bool sk_gpu_op_knows_no_slots(const sk_op *op, size_t particle_count) {
    const sk_force *force = force_of(op);
    if (op->inner) return false;
    if (is_avoid(op)) return op->group->first == 0 && op->group->end == particle_count;
    if (sk_gpu_op_has_target(op)) return false;
    if (op->kind == SK_OP_GRID) return op->group->first == 0 && op->group->end == particle_count;
    return !force || force->type->phase == SK_PUSHES || sk_gpu_op_everyone(op, particle_count);
}

/* ---- vectors ---- */

static sk_gpu_use use_of_combine(const sk_op *op) {
    sk_gpu_use use = {0, BIT(op->dst)};
    bool predicts = sk_op_is(op, &sk_combine_predict);
    if (predicts || is_uniform_prediction(op)) {
        use.reads = BIT(SK_X) | BIT(SK_V) | (predicts ? BIT(SK_F) : 0);
        use.writes = BIT(SK_X) | BIT(SK_V) | BIT(SK_X0) | (op->source[2] == SK_V0 ? BIT(SK_V0) : 0);
        if (sk_op_is(op, &sk_combine_correct_and_predict)) use.reads |= BIT(SK_X0); // in the last iteration it stays
        return use;
    }
    for (int i = 0; i < 3; i++) use.reads |= BIT(op->source[i]);
    if (sk_op_is(op, &sk_combine_kick) || sk_op_is(op, &sk_combine_steer) || sk_op_is(op, &sk_combine_lead))
        use.reads |= BIT(SK_X);
    if (sk_op_is(op, &sk_combine_correction)) use.reads |= BIT(op->dst);
    return use;
}

sk_gpu_use sk_gpu_op_use(const sk_op *op) {
    sk_gpu_use use = {0, 0};
    switch (op->kind) {
    case SK_OP_COMBINE: use = use_of_combine(op); break;
    case SK_OP_GRID: use.reads = BIT(SK_X) | BIT(SK_V); break;
    case SK_OP_FIELD:
    case SK_OP_NEIGHBOUR:
        use.reads = BIT(SK_X) | BIT(SK_V) | (op->sets ? 0 : BIT(op->dst));
        use.writes = BIT(op->dst);
        break;
    case SK_OP_LIMIT:
        use.reads = BIT(SK_X) | BIT(SK_V) | BIT(op->source[2]);
        use.writes = BIT(SK_V);
        if (shifts(op)) use = (sk_gpu_use){BIT(SK_X) | BIT(SK_PREVIOUS), BIT(SK_X) | BIT(SK_PREVIOUS)};
        break;
    case SK_OP_CONTACT_FORCE: use = (sk_gpu_use){BIT(SK_X) | BIT(SK_V) | BIT(SK_F), BIT(SK_F)}; break;
    case SK_OP_CONTACT_VELOCITY: use = (sk_gpu_use){BIT(SK_X) | BIT(SK_V) | BIT(op->source[2]), BIT(SK_X) | BIT(SK_V)}; break;
    case SK_OP_CONTACT_POSITION: use = (sk_gpu_use){BIT(SK_X) | BIT(op->source[2]), BIT(SK_X)}; break;
    case SK_OP_CONTACT_UPDATE:
        use = (sk_gpu_use){BIT(SK_X) | BIT(SK_V) | BIT(op->source[1]) | BIT(op->source[2]), BIT(SK_X) | BIT(SK_V)};
        if (sk_contact_reads_force(op->rule)) use.reads |= BIT(SK_F);
        break;
    default: break;
    }
    use.reads &= ~BIT(SK_NONE);
    // the w of a state vector stays, whoever writes the rest; and so does what slots beside the op's have
    use.reads |= use.writes & (op->inner ? ~0u : BIT(SK_X) | BIT(SK_V));
    return use;
}

/* ---- the block ---- */

/* How many numbers of a block a field is; 0: none, it is a text. */
static size_t numbers_of(const skein_field *field) {
    if (field->type == SKEIN_FIELD_TEXT || strpbrk(field->name, ".*")) return 0;
    return field->type == SKEIN_FIELD_VEC3 ? 3 : 1;
}

static size_t rule_size(const sk_op *op) {
    const sk_shader *shader = shader_of(op);
    if (shader && shader->arithmetic) {
        const skein_kind *kind = kind_of(op);
        size_t count = 0;
        for (size_t i = 0; i < kind->field_count; i++) count += numbers_of(&kind->fields[i]);
        return (count + 3) / 4;
    }
    return shader ? shader->size : op->kind == SK_OP_COMBINE && is_uniform_prediction(op) ? 3 : 0;
}

size_t sk_gpu_op_size(const sk_op *op) {
    return SK_GPU_OP + (has_pose(op) ? (size_t)SK_GPU_POSE : 0) + rule_size(op);
}

static void pack_pose(const sk_collider *collider, double time, double dt, float (*block)[4]) {
    sk_pose pose = sk_collider_pose_at(collider, time);
    const sk_vec3 three[4] = {pose.position, pose.velocity, pose.spin, pose.axis};
    const double one[4] = {collider->common->thickness, collider->common->friction, collider->common->restitution,
                           sk_collider_mass(collider)};
    for (int i = 0; i < 4; i++) {
        block[i][0] = (float)three[i].x, block[i][1] = (float)three[i].y, block[i][2] = (float)three[i].z;
        block[i][3] = (float)one[i];
    }
    for (int i = 0; i < 9; i++) block[4 + i / 3][i % 3] = (float)pose.rotation[i];
    block[4][3] = (float)pose.time;
    block[5][3] = (float)collider->common->recovery;
    block[6][3] = (float)collider->type->passing;
    double since = time - collider->common->start;
    block[7][0] = (float)(collider->travel.moving || since > dt ? dt : since > 0 ? since : 0);
}

/* A rule's parameters: of arithmetic the fields, number after number. */
static void pack_rule(const sk_op *op, const sk_shader *shader, float (*block)[4]) {
    const void *params = params_of(op);
    if (shader->pack) shader->pack(params, block);
    if (!shader->arithmetic) return;
    const skein_kind *kind = kind_of(op);
    for (size_t i = 0, at = 0; i < kind->field_count; i++) {
        skein_value value = sk_field_load(&kind->fields[i], params);
        for (size_t k = 0; k < numbers_of(&kind->fields[i]); k++, at++) block[at / 4][at % 4] = (float)value.number[k];
    }
}

void sk_gpu_op_pack(const sk_op *op, const sk_run *run, float (*block)[4]) {
    double time = run->time;
    for (int k = 0; k < 3; k++) block[0][k] = (float)op->coefficient[k];
    block[0][3] = (float)op->dt;
    if (op->kind == SK_OP_NEIGHBOUR) {
        const sk_force *force = op->rule;
        block[1][0] = (float)force->type->radius(force->params);
    }
    if (op->kind == SK_OP_CONTACT_UPDATE) block[1][0] = sk_contact_reads_force(op->rule);
    if (sk_gpu_op_has_target(op)) {
        uint32_t slot = run->slot_of[particle_of(op)];
        block[1][1] = (float)(slot >> 16), block[1][3] = (float)(slot & 0xffff);
    }
    // pair rules by formula know the end of the substep, fields the moment of the state
    block[1][2] = (float)(op->kind == SK_OP_NEIGHBOUR ? time : time - op->before_end);
    block += SK_GPU_OP;
    const sk_shader *shader = shader_of(op);
    if (has_pose(op)) {
        const sk_collider *collider = op->rule;
        pack_pose(collider, is_avoid(op) ? time : time - op->before_end, op->dt, block);
        pack_rule(op, shader, block + SK_GPU_POSE);
    } else if (shader) {
        pack_rule(op, shader, block);
    } else if (rule_size(op)) {
        const sk_uniform_force *uniform = op->rule;
        sk_shader_vector(block[0], uniform->acceleration);
        sk_shader_vector(block[1], uniform->force);
        block[2][0] = (float)uniform->linear, block[2][1] = (float)uniform->rate;
    }
}

bool sk_gpu_op_moves(const sk_op *op) {
    const sk_shader *shader = shader_of(op);
    if (shader && shader->changes && shader->changes(params_of(op))) return true;
    if (!has_pose(op)) return false;
    return sk_collider_moves(op->rule);
}

/* ---- texts ---- */

void sk_gpu_put_members(sk_gpu_text *text, const sk_op *op, size_t number) {
    sk_gpu_put(text, "    vec4 op%zu[%d];\n", number, SK_GPU_OP);
    if (has_pose(op)) sk_gpu_put(text, "    vec4 pose%zu[%d];\n", number, SK_GPU_POSE);
    if (rule_size(op)) sk_gpu_put(text, "    vec4 rule%zu[%zu];\n", number, rule_size(op));
}

/* A text that a type writes, with the op's number in it. */
typedef struct numbered {
    sk_gpu_text *text;
    size_t number;
} numbered;

static void put_numbered(void *user, const char *text) {
    const numbered *to = user;
    sk_gpu_put_text(to->text, text, to->number);
}

static void put_written(sk_gpu_text *text, const sk_op *op, size_t number) {
    const sk_shader *shader = shader_of(op);
    numbered to = {text, number};
    if (shader->write && !shader->write(params_of(op), put_numbered, &to)) text->no_memory = true;
}

/* "gravity" of "forces/gravity": what the names in its arithmetic begin with. */
static const char *stem_of(const sk_shader *shader) {
    return strrchr(shader->arithmetic, '/') + 1;
}

/* The struct of a kind's parameters, as its own file has it, and its arithmetic. */
static void put_arithmetic(sk_gpu_text *text, const sk_op *op, const sk_shader *shader) {
    const skein_kind *kind = kind_of(op);
    sk_gpu_put(text, "struct %s_params {\n", stem_of(shader));
    for (size_t i = 0; i < kind->field_count; i++) {
        size_t numbers = numbers_of(&kind->fields[i]);
        if (numbers) sk_gpu_put(text, "    %s %s;\n", numbers == 3 ? "vec3" : "float", kind->fields[i].name);
    }
    sk_gpu_put(text, "};\n");
    sk_gpu_put_file(text, shader->arithmetic, 0);
}

/* params@(): the parameters of one rule, from its block. */
static void put_params(sk_gpu_text *text, const sk_op *op, const sk_shader *shader, size_t n) {
    const skein_kind *kind = kind_of(op);
    const char *stem = stem_of(shader), *comma = "";
    sk_gpu_put(text, "%s_params params%zu() {\n    return %s_params(", stem, n, stem);
    for (size_t i = 0, at = 0; i < kind->field_count; i++) {
        size_t numbers = numbers_of(&kind->fields[i]);
        if (!numbers) continue;
        sk_gpu_put(text, numbers == 3 ? "%svec3(" : "%s(", comma);
        for (size_t k = 0; k < numbers; k++, at++)
            sk_gpu_put(text, "%srule%zu[%zu][%zu]", k ? ", " : "", n, at / 4, at % 4);
        sk_gpu_put(text, ")");
        comma = ", ";
    }
    sk_gpu_put(text, ");\n}\n");
}

/* What walks and statements call, from what the kind's arithmetic defines. */
static void put_calls(sk_gpu_text *text, const sk_op *op, const sk_shader *shader, size_t n) {
    const char *stem = stem_of(shader);
    const sk_force *force = force_of(op);
    put_params(text, op, shader, n);
    if (op->kind == SK_OP_NEIGHBOUR)
        sk_gpu_put(text, "#define sum%zu vec3\n"
                         "vec3 start%zu(vec3 heading) { return vec3(0); }\n"
                         "void meet%zu(inout vec3 sum, vec3 apart, float square, vec3 direction) {\n"
                         "    if (square > 0) sum += %s_push(params%zu(), apart, sqrt(square));\n"
                         "}\n"
                         "vec3 finish%zu(vec3 sum, float dt) { return sum; }\n", n, n, n, stem, n, n);
    else if (force && shader->shifts && shader->shifts(force->params))
        sk_gpu_put(text, "vec3 shift%zu(vec3 x) { return %s_shift(params%zu(), x); }\n", n, stem, n);
    else if (force && op->kind == SK_OP_LIMIT)
        sk_gpu_put(text, "vec3 bound%zu(vec4 x, vec3 v, vec4 steering, float dt) {\n"
                         "    return %s_bound(params%zu(), x, v, steering, dt);\n}\n", n, stem, n);
    else if (!force)
        sk_gpu_put(text, "vec4 probe%zu(vec3 x) {\n"
                         "    sk_pose where = sk_pose(pose%zu[0].xyz, pose%zu[3].xyz, pose%zu[4].xyz, pose%zu[5].xyz, pose%zu[6].xyz);\n"
                         "    sk_contact contact = %s_probe(params%zu(), where, x);\n"
                         "    return vec4(contact.normal, contact.distance);\n}\n", n, n, n, n, n, n, stem, n);
    else if (force->type->phase == SK_STEERS)
        sk_gpu_put(text, "vec4 steer%zu(vec3 x, float dt) { return %s_steer(params%zu(), x, dt); }\n", n, stem, n);
    else
        sk_gpu_put(text, "vec3 force%zu(vec3 x, vec3 v, float mass) { return %s_force(params%zu(), %sv, mass); }\n", n,
                   stem, n, force->type->at_velocity ? "" : "x, ");
}

void sk_gpu_put_functions(sk_gpu_text *text, const sk_op *const *ops, size_t number) {
    const sk_op *op = ops[number];
    if (op->kind == SK_OP_COMBINE && is_uniform_prediction(op)) sk_gpu_put_file(text, "gpu/pull", number);
    if (has_pose(op)) sk_gpu_put_file(text, "colliders/pose", number);
    if (shader_of(op)) put_written(text, op, number);
    const sk_shader *shader = shader_of(op);
    if (shader && shader->file) sk_gpu_put_file(text, shader->file, number);
    if (shader && shader->arithmetic) {
        bool there = false, shapes = false; // rules of one kind share it, and shapes their words
        for (size_t i = 0; i < number; i++) {
            there |= shader_of(ops[i]) == shader;
            shapes |= has_pose(ops[i]) && shader_of(ops[i])->arithmetic;
        }
        if (has_pose(op) && !shapes) sk_gpu_put_file(text, "colliders/shape", 0);
        if (!there) put_arithmetic(text, op, shader);
        put_calls(text, op, shader, number);
    }
    if (is_contact(op)) sk_gpu_put_file(text, "colliders/contact", number);
    if (is_avoid(op)) sk_gpu_put_file(text, "colliders/avoid", number);
    if (op->kind == SK_OP_NEIGHBOUR) sk_gpu_put_file(text, "gpu/walk", number);
}

/* V = v, V0 = V, X0 = X, X += h V; or, where only the correction will ask, X0 = X + h V. */
static void put_set_out(sk_gpu_text *text, const sk_op *op, size_t n) {
    if (op->source[2] == SK_V0) sk_gpu_put(text, "    V0.xyz = V.xyz;\n");
    if (op->source[2] != SK_X) sk_gpu_put(text, "    X0.xyz = X.xyz;\n");
    sk_gpu_put(text, "    X.xyz = X.xyz + op%zu[0].w * V.xyz;\n", n);
    if (op->source[2] == SK_X) sk_gpu_put(text, "    X0.xyz = X.xyz;\n");
}

static void put_combine(sk_gpu_text *text, const sk_op *op, size_t n) {
    const char *dst = sk_gpu_vector_name(op->dst), *p = sk_gpu_vector_name(op->source[0]),
               *q = sk_gpu_vector_name(op->source[1]), *r = sk_gpu_vector_name(op->source[2]);
    if (sk_op_is(op, &sk_combine_predict)) {
        sk_gpu_put(text, "    V.xyz = V.xyz + op%zu[0].w * X.w * F.xyz;\n", n);
        put_set_out(text, op, n);
    } else if (sk_op_is(op, &sk_combine_predict_uniform)) {
        sk_gpu_put(text, "    V.xyz = pulled%zu(X.w, V.xyz);\n", n);
        put_set_out(text, op, n);
    } else if (sk_op_is(op, &sk_combine_correct_and_predict)) {
        sk_gpu_put(text, "    V.xyz = V.xyz + op%zu[0].x * (X.xyz - X0.xyz);\n    if (!last_iteration) {\n", n);
        sk_gpu_put(text, "    V.xyz = pulled%zu(X.w, V.xyz);\n", n);
        put_set_out(text, op, n);
        sk_gpu_put(text, "    }\n");
    } else if (sk_op_is(op, &sk_combine_kick)) {
        sk_gpu_put(text, "    %s.xyz = %s.xyz + op%zu[0].x * X.w * %s.xyz;\n", dst, p, n, q);
    } else if (sk_op_is(op, &sk_combine_wipe)) {
        sk_gpu_put(text, "    %s = vec4(0);\n", dst);
    } else if (sk_op_is(op, &sk_combine_steer)) {
        sk_gpu_put(text, "    if (X.w > 0) %s.xyz += %s.xyz;\n", dst, q);
    } else if (sk_op_is(op, &sk_combine_lead)) {
        sk_gpu_put(text, "    if (!(X.w > 0)) %s.xyz += op%zu[0].x * %s.xyz;\n", dst, n, q);
    } else if (sk_op_is(op, &sk_combine_correction)) {
        // the same operations as predicted p, so that an untouched p corrects nothing
        if (op->coefficient[1] == 0)
            sk_gpu_put(text, "    %s.xyz = %s.xyz + op%zu[0].x * (%s.xyz - %s.xyz);\n", dst, dst, n, p, q);
        else
            sk_gpu_put(text, "    %s.xyz = %s.xyz + op%zu[0].x * (%s.xyz - (%s.xyz + op%zu[0].y * %s.xyz));\n", dst,
                       dst, n, p, q, n, dst);
    } else { // a sum
        sk_gpu_put(text, "    %s.xyz = ", dst);
        if (op->source[0] == SK_NONE) sk_gpu_put(text, "vec3(0)");
        else sk_gpu_put(text, "op%zu[0].x * %s.xyz", n, p);
        if (op->source[1] != SK_NONE) sk_gpu_put(text, " + op%zu[0].y * %s.xyz", n, q);
        if (op->source[2] != SK_NONE) sk_gpu_put(text, " + op%zu[0].z * %s.xyz", n, r);
        sk_gpu_put(text, ";\n");
    }
}

/* Only for the particles that the rule moves, where these are not all, and not for the one that it looks at. */
static void put_guard(sk_gpu_text *text, const sk_op *op, size_t n, size_t particle_count) {
    const sk_force *force = force_of(op);
    if (sk_gpu_op_has_target(op))
        sk_gpu_put(text, "    if (first_slot + slot != uint(op%zu[1].y) * 65536u + uint(op%zu[1].w))\n", n, n);
    if (op->kind == SK_OP_NEIGHBOUR || (force && force->type->phase == SK_PUSHES)) return;
    const sk_group *group = force ? &force->moved : op->group;
    if (group->first == 0 && group->end == particle_count) return;
    sk_gpu_put(text, "    if (first_slot + slot >= %zuu && first_slot + slot < %zuu)\n", group->first_slot,
               group->end_slot);
}

static void put_force(sk_gpu_text *text, const sk_op *op, size_t n, size_t particle_count) {
    const char *dst = sk_gpu_vector_name(op->dst);
    put_guard(text, op, n, particle_count);
    if (is_avoid(op)) sk_gpu_put(text, "    %s += avoid%zu(X.xyz, V.xyz);\n", dst, n);
    else if (op->kind == SK_OP_NEIGHBOUR) sk_gpu_put(text, "    %s.xyz += walk%zu(place, X.xyz, V.xyz);\n", dst, n);
    else if (shifts(op))
        sk_gpu_put(text, "    if (X.w > 0) { vec3 shift = shift%zu(X.xyz); X.xyz += shift; P.xyz += shift; }\n", n);
    else if (op->kind == SK_OP_LIMIT)
        sk_gpu_put(text, "    V.xyz = bound%zu(X, V.xyz, %s, op%zu[0].w);\n", n,
                   op->source[2] == SK_NONE ? "vec4(0)" : "S", n);
    else if (force_of(op)->type->phase == SK_STEERS)
        sk_gpu_put(text, "    %s += steer%zu(X.xyz, op%zu[0].w);\n", dst, n, n);
    else sk_gpu_put(text, "    %s.xyz %s force%zu(X.xyz, V.xyz, V.w);\n", dst, op->sets ? "=" : "+=", n);
}

static void put_statements(sk_gpu_text *text, const sk_op *op, size_t n, size_t particle_count) {
    switch (op->kind) {
    case SK_OP_COMBINE: put_combine(text, op, n); break;
    case SK_OP_FIELD:
    case SK_OP_NEIGHBOUR:
    case SK_OP_LIMIT: put_force(text, op, n, particle_count); break;
    case SK_OP_CONTACT_FORCE: sk_gpu_put(text, "    contact_force%zu(X, V, F);\n", n); break;
    case SK_OP_CONTACT_VELOCITY:
        sk_gpu_put(text, "    contact_impulse%zu(X, V, %s);\n", n, sk_gpu_vector_name(op->source[2]));
        break;
    case SK_OP_CONTACT_POSITION:
        sk_gpu_put(text, "    contact_push%zu(X, %s);\n", n, sk_gpu_vector_name(op->source[2]));
        break;
    case SK_OP_CONTACT_UPDATE:
        sk_gpu_put(text, "    contact_update%zu(X, V, %s, %s, %s);\n", n,
                   sk_contact_reads_force(op->rule) ? "F" : "vec4(0)", sk_gpu_vector_name(op->source[1]),
                   sk_gpu_vector_name(op->source[2]));
        break;
    default: break;
    }
}

void sk_gpu_put_statements(sk_gpu_text *text, const sk_op *op, size_t n, size_t particle_count) {
    if (op->inner)
        sk_gpu_put(text, "    if (first_slot + slot >= %zuu && first_slot + slot < %zuu) {\n", op->first_slot, op->end_slot);
    put_statements(text, op, n, particle_count);
    if (op->inner) sk_gpu_put(text, "    }\n");
}
