/* Ops on a card: whether they can run there, their part of the block, and their text. */
#include "gpu/ops.h"

#include <stdio.h>
#include <string.h>

#define BIT(vector) (1u << (vector))

const char *sk_gpu_vector_name(sk_vector vector) {
    static const char *const names[SK_VECTOR_COUNT] = {"none", "X",  "V",  "F",   "X0",  "V0", "P",
                                                       "T0",   "T1", "T2", "T3",  "T4",  "T5", "T6",
                                                       "T7",   "T8", "T9", "T10", "T11", "S",  "SUPPORT"};
    return names[vector];
}

/* Whether its rule is a collider, which has a pose. */
static bool has_pose(const sk_op *op) {
    return sk_op_type_of(op)->rule == SK_RULE_COLLIDER;
}

static const sk_force *force_of(const sk_op *op) {
    return sk_op_type_of(op)->rule == SK_RULE_FORCE ? op->rule : NULL;
}

static const sk_shader *shader_of(const sk_op *op) {
    if (force_of(op)) return &force_of(op)->type->shader;
    return has_pose(op) ? &((const sk_collider *)op->rule)->type->shader : NULL;
}

static const skein_kind *kind_of(const sk_op *op) {
    return force_of(op) ? &force_of(op)->type->kind : &((const sk_collider *)op->rule)->type->kind;
}

static const void *params_of(const sk_op *op) {
    return force_of(op) ? force_of(op)->params : ((const sk_collider *)op->rule)->params;
}

bool sk_gpu_op_can(const sk_op *op, const char **why) {
    const sk_op_type *type = sk_op_type_of(op);
    const sk_shader *shader = shader_of(op);
    if (type->sorts || type->goes_on || op->kind == SK_OP_REPEAT) return true;
    if (shader && !shader->arithmetic && !shader->file) return false;
    if (shader && shader->refuse && (*why = shader->refuse(params_of(op)))) return false;
    if (type->walks && !op->group && force_of(op)->only.some) {
        *why = "where it is 'on' some bodies only";
        return false;
    }
    return type->card.statement != NULL;
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

/* Reads a slot from two numbers, each exact as a float. */
size_t sk_gpu_op_target_from(const float (*block)[4]) {
    return (size_t)block[1][1] << 16 | (size_t)block[1][3];
}

static bool is_everybody(const sk_group *group, size_t particle_count) {
    return !group || (group->first == 0 && group->end == particle_count);
}

bool sk_gpu_op_everyone(const sk_op *op, size_t particle_count) {
    return is_everybody(op->group, particle_count) && is_everybody(op->seen, particle_count);
}

bool sk_gpu_op_knows_no_slots(const sk_op *op, size_t particle_count) {
    return !op->inner && !sk_gpu_op_has_target(op) && sk_gpu_op_everyone(op, particle_count);
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
    return shader ? shader->size : sk_op_type_of(op)->rule == SK_RULE_UNIFORM ? 3 : 0;
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
    const sk_op_type *type = sk_op_type_of(op);
    double time = type->at_end ? run->time : run->time - op->before_end;
    for (int k = 0; k < 3; k++) block[0][k] = (float)op->coefficient[k];
    block[0][3] = (float)op->dt;
    block[1][0] = type->walks ? (float)force_of(op)->type->radius(params_of(op)) : (float)(op->also_reads >> SK_F & 1);
    if (sk_gpu_op_has_target(op)) {
        uint32_t slot = run->slot_of[particle_of(op)];
        block[1][1] = (float)(slot >> 16), block[1][3] = (float)(slot & 0xffff);
    }
    block[1][2] = (float)time;
    block += SK_GPU_OP;
    const sk_shader *shader = shader_of(op);
    if (has_pose(op)) {
        const sk_collider *collider = op->rule;
        pack_pose(collider, time, op->dt, block);
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

static void put_letter(sk_gpu_text *text, const sk_op *op, char letter, size_t n);

/* A text of a kind's, with the op's number and its own words. */
static void put_template(sk_gpu_text *text, const sk_op *op, const char *from, size_t n) {
    while (*from) {
        size_t length = strcspn(from, "@$");
        sk_gpu_put(text, "%.*s", (int)length, from);
        from += length;
        if (*from == '@') sk_gpu_put(text, "%zu", n);
        else if (*from) put_letter(text, op, *++from, n);
        if (*from) from++;
    }
}

/* The weighted sum of its sources. */
static void put_sum(sk_gpu_text *text, const sk_op *op, size_t n) {
    for (int i = 0; i < 3 && op->source[i] != SK_NONE; i++)
        sk_gpu_put(text, "%sop%zu[0][%d] * %s.xyz", i ? " + " : "", n, i, sk_gpu_vector_name(op->source[i]));
    if (op->source[0] == SK_NONE) sk_gpu_put(text, "vec3(0)");
}

/* Writes the replacement of a letter in a kind's GLSL (sk_on_card). */
static void put_letter(sk_gpu_text *text, const sk_op *op, char letter, size_t n) {
    const char *name = "";
    switch (letter) {
    case 'd': name = sk_gpu_vector_name(op->dst); break;
    case 'p': name = sk_gpu_vector_name(op->source[0]); break;
    case 'q': name = sk_gpu_vector_name(op->source[1]); break;
    case 'r': name = op->source[2] == SK_NONE ? "vec4(0)" : sk_gpu_vector_name(op->source[2]); break;
    case 'f': name = op->also_reads >> SK_F & 1 ? "F" : "vec4(0)"; break;
    case '=': name = op->sets ? "=" : "+="; break;
    case 'x': name = force_of(op)->type->at_velocity ? "" : "x, "; break;
    case 'k': name = stem_of(shader_of(op)); break;
    case 's': put_sum(text, op, n); break;
    case 'b': put_template(text, op, op->coefficient[1] == 0 ? "$q.xyz" : "($q.xyz + op@[0].y * $d.xyz)", n); break;
    case 'o': put_template(text, op, sk_op_type_of(op)->card.other(op), n); break;
    default: break;
    }
    sk_gpu_put(text, "%s", name);
}

/* Whether an earlier op of the pass has written the text that they share. */
static bool is_shared_before(const sk_op *const *ops, size_t number) {
    const char *shared = sk_op_type_of(ops[number])->card.shared;
    for (size_t i = 0; i < number; i++) {
        const char *other = sk_op_type_of(ops[i])->card.shared;
        if (other && !strcmp(other, shared)) return true;
    }
    return false;
}

void sk_gpu_put_functions(sk_gpu_text *text, const sk_op *const *ops, size_t number) {
    const sk_op *op = ops[number];
    const sk_on_card *card = &sk_op_type_of(op)->card;
    const sk_shader *shader = shader_of(op);
    if (has_pose(op)) sk_gpu_put_file(text, "colliders/pose", number);
    if (shader) put_written(text, op, number);
    if (shader && shader->file) sk_gpu_put_file(text, shader->file, number);
    if (shader && shader->arithmetic) {
        bool there = false, shapes = false; // rules of a kind share their arithmetic, and shapes a vocabulary
        for (size_t i = 0; i < number; i++) {
            there |= shader_of(ops[i]) == shader;
            shapes |= has_pose(ops[i]) && shader_of(ops[i])->arithmetic;
        }
        if (has_pose(op) && !shapes) sk_gpu_put_file(text, "colliders/shape", 0);
        if (!there) put_arithmetic(text, op, shader);
        put_params(text, op, shader, number);
        put_template(text, op, card->call, number);
    }
    if (card->shared && !is_shared_before(ops, number)) sk_gpu_put_file(text, card->shared, 0);
    if (card->file) sk_gpu_put_file(text, card->file, number);
}

static void put_between(sk_gpu_text *text, size_t first, size_t end) {
    sk_gpu_put(text, "    if (first_slot + slot >= %zuu && first_slot + slot < %zuu)\n", first, end);
}

void sk_gpu_put_statements(sk_gpu_text *text, const sk_op *op, size_t n, size_t particle_count) {
    const sk_op_type *type = sk_op_type_of(op);
    // only for the particles that the rule moves, if these are not all, and not for the one that it is placed at
    if (op->inner) put_between(text, op->first_slot, op->end_slot);
    if (sk_gpu_op_has_target(op))
        sk_gpu_put(text, "    if (first_slot + slot != uint(op%zu[1].y) * 65536u + uint(op%zu[1].w))\n", n, n);
    if (!type->walks && !is_everybody(op->group, particle_count))
        put_between(text, op->group->first_slot, op->group->end_slot);
    sk_gpu_put(text, "    {\n");
    put_template(text, op, type->card.statement, n);
    sk_gpu_put(text, "    }\n");
}
