/* Each sort of row as the card has it: what it reads, what it writes, its text and numbers, or why it cannot. */
#include "gpu/rows.h"

#include <stdio.h>
#include <string.h>

#define BIT(vector) (1u << (vector))

const char *sk_gpu_vector_name(sk_vector vector) {
    static const char *const names[SK_VECTOR_COUNT] = {"none", "X",  "V",  "F",  "X0", "V0", "P",  "T0",  "T1",  "T2",
                                                       "T3",   "T4", "T5", "T6", "T7", "T8", "T9", "T10", "T11", "S"};
    return names[vector];
}

static bool is_contact(const sk_row *row) {
    return row->kind >= SK_ROW_CONTACT_FORCE && row->kind <= SK_ROW_CONTACT_SETTLE;
}

static bool is_fall(const sk_row *row) {
    return sk_row_is(row, &sk_combine_fall) || sk_row_is(row, &sk_combine_fall_on);
}

/* Steering clear of a collider, which is the row's rule. */
static bool is_avoid(const sk_row *row) {
    return row->kind == SK_ROW_FIELD && sk_row_is(row, &sk_avoid);
}

static bool has_pose(const sk_row *row) {
    return is_contact(row) || is_avoid(row);
}

/* Fields, neighbours, and bounds on velocities: limits on positions are of another sort. */
static const sk_force *force_of(const sk_row *row) {
    if (is_avoid(row)) return NULL;
    bool is_force =
        row->kind == SK_ROW_FIELD || row->kind == SK_ROW_NEIGHBOUR || (row->kind == SK_ROW_LIMIT && row->dst == SK_V);
    return is_force ? row->rule : NULL;
}

static const sk_shader *shader_of(const sk_row *row) {
    if (force_of(row)) return &force_of(row)->type->shader;
    if (has_pose(row)) return &((const sk_collider *)row->rule)->type->shader;
    return NULL;
}

static bool has_text(const sk_shader *shader) {
    return shader && (shader->arithmetic || shader->file);
}

static const skein_kind *kind_of(const sk_row *row) {
    return force_of(row) ? &force_of(row)->type->kind : &((const sk_collider *)row->rule)->type->kind;
}

static const void *params_of(const sk_row *row) {
    if (force_of(row)) return force_of(row)->params;
    return has_pose(row) ? ((const sk_collider *)row->rule)->params : NULL;
}

static bool is_combine(const sk_row *row) {
    static const sk_kernels *const known[] = {&sk_combine_sum,     &sk_combine_correction, &sk_combine_kick,
                                              &sk_combine_predict, &sk_combine_fall,       &sk_combine_fall_on,
                                              &sk_combine_wipe,    &sk_combine_steer,      &sk_combine_lead};
    for (size_t i = 0; i < sizeof known / sizeof *known; i++)
        if (sk_row_is(row, known[i])) return true;
    return false;
}

bool sk_gpu_row_can(const sk_row *row, const char **why) {
    const sk_shader *shader = shader_of(row);
    if (has_text(shader) && shader->refuse && (*why = shader->refuse(params_of(row)))) return false;
    if (row->kind == SK_ROW_NEIGHBOUR && force_of(row)->type->deed == SK_PUSHES && force_of(row)->only.some) {
        *why = "where it is 'on' some bodies only";
        return false;
    }
    switch (row->kind) {
    case SK_ROW_GRID: return true;
    case SK_ROW_REPEAT: return true;
    case SK_ROW_COMBINE: return is_combine(row);
    case SK_ROW_FIELD:
    case SK_ROW_NEIGHBOUR:
    case SK_ROW_LIMIT:
    case SK_ROW_CONTACT_FORCE:
    case SK_ROW_CONTACT_VELOCITY:
    case SK_ROW_CONTACT_SETTLE: return has_text(shader);
    case SK_ROW_CONTACT_POSITION: return has_text(shader) && row->source[1] == SK_NONE;
    default: return false;
    }
}

static int32_t particle_of(const sk_row *row) {
    const sk_force *force = force_of(row);
    return force ? sk_force_particle(force) : -1;
}

bool sk_gpu_row_looks(const sk_row *row) {
    return particle_of(row) >= 0;
}

size_t sk_gpu_row_looks_to(void) {
    return SK_GPU_ROW;
}

/* A slot as two numbers that are exact as floats. */
size_t sk_gpu_row_looks_from(const float (*block)[4]) {
    return (size_t)block[1][1] << 16 | (size_t)block[1][3];
}

static bool shifts(const sk_row *row) {
    const sk_shader *shader = shader_of(row);
    return row->kind == SK_ROW_LIMIT && shader && shader->shifts && shader->shifts(force_of(row)->params);
}

bool sk_gpu_row_everyone(const sk_row *row, size_t particle_count) {
    const sk_force *force = force_of(row);
    if (force->type->deed == SK_PUSHES) return true;
    return force->moved.first == 0 && force->moved.end == particle_count && force->seen.first == 0 &&
           force->seen.end == particle_count;
}

bool sk_gpu_row_knows_no_slots(const sk_row *row, size_t particle_count) {
    const sk_force *force = force_of(row);
    if (row->inner) return false;
    if (is_avoid(row)) return row->group->first == 0 && row->group->end == particle_count;
    if (sk_gpu_row_looks(row)) return false;
    if (row->kind == SK_ROW_GRID) return row->group->first == 0 && row->group->end == particle_count;
    return !force || force->type->deed == SK_PUSHES || sk_gpu_row_everyone(row, particle_count);
}

/* ---- vectors ---- */

static sk_gpu_use use_of_combine(const sk_row *row) {
    sk_gpu_use use = {0, BIT(row->dst)};
    bool predicts = sk_row_is(row, &sk_combine_predict);
    if (predicts || is_fall(row)) {
        use.reads = BIT(SK_X) | BIT(SK_V) | (predicts ? BIT(SK_F) : 0);
        use.writes = BIT(SK_X) | BIT(SK_V) | BIT(SK_X0) | (row->source[2] == SK_V0 ? BIT(SK_V0) : 0);
        if (sk_row_is(row, &sk_combine_fall_on)) use.reads |= BIT(SK_X0); // in the last turn it stays
        return use;
    }
    for (int i = 0; i < 3; i++) use.reads |= BIT(row->source[i]);
    if (sk_row_is(row, &sk_combine_kick) || sk_row_is(row, &sk_combine_steer) || sk_row_is(row, &sk_combine_lead))
        use.reads |= BIT(SK_X);
    if (sk_row_is(row, &sk_combine_correction)) use.reads |= BIT(row->dst);
    return use;
}

sk_gpu_use sk_gpu_row_use(const sk_row *row) {
    sk_gpu_use use = {0, 0};
    switch (row->kind) {
    case SK_ROW_COMBINE: use = use_of_combine(row); break;
    case SK_ROW_GRID: use.reads = BIT(SK_X) | BIT(SK_V); break;
    case SK_ROW_FIELD:
    case SK_ROW_NEIGHBOUR:
        use.reads = BIT(SK_X) | BIT(SK_V) | (row->sets ? 0 : BIT(row->dst));
        use.writes = BIT(row->dst);
        break;
    case SK_ROW_LIMIT:
        use.reads = BIT(SK_X) | BIT(SK_V) | BIT(row->source[2]);
        use.writes = BIT(SK_V);
        if (shifts(row)) use = (sk_gpu_use){BIT(SK_X) | BIT(SK_PREVIOUS), BIT(SK_X) | BIT(SK_PREVIOUS)};
        break;
    case SK_ROW_CONTACT_FORCE: use = (sk_gpu_use){BIT(SK_X) | BIT(SK_V) | BIT(SK_F), BIT(SK_F)}; break;
    case SK_ROW_CONTACT_VELOCITY: use = (sk_gpu_use){BIT(SK_X) | BIT(SK_V), BIT(SK_V)}; break;
    case SK_ROW_CONTACT_POSITION: use = (sk_gpu_use){BIT(SK_X), BIT(SK_X)}; break;
    case SK_ROW_CONTACT_SETTLE:
        use = (sk_gpu_use){BIT(SK_X) | BIT(SK_V) | BIT(row->source[1]) | BIT(row->source[2]), BIT(SK_X) | BIT(SK_V)};
        if (sk_contact_reads_force(row->rule)) use.reads |= BIT(SK_F);
        break;
    default: break;
    }
    use.reads &= ~BIT(SK_NONE);
    // the w of a state vector stays, whoever writes the rest; and so does what slots beside the row's have
    use.reads |= use.writes & (row->inner ? ~0u : BIT(SK_X) | BIT(SK_V));
    return use;
}

/* ---- the block ---- */

/* How many numbers of a block a field is; 0: none, it is a text. */
static size_t numbers_of(const skein_field *field) {
    if (field->type == SKEIN_FIELD_TEXT || strpbrk(field->name, ".*")) return 0;
    return field->type == SKEIN_FIELD_VEC3 ? 3 : 1;
}

static size_t rule_size(const sk_row *row) {
    const sk_shader *shader = shader_of(row);
    if (shader && shader->arithmetic) {
        const skein_kind *kind = kind_of(row);
        size_t count = 0;
        for (size_t i = 0; i < kind->field_count; i++) count += numbers_of(&kind->fields[i]);
        return (count + 3) / 4;
    }
    return shader ? shader->size : row->kind == SK_ROW_COMBINE && is_fall(row) ? 3 : 0;
}

size_t sk_gpu_row_size(const sk_row *row) {
    return SK_GPU_ROW + (has_pose(row) ? (size_t)SK_GPU_POSE : 0) + rule_size(row);
}

static void pack_pose(const sk_collider *collider, double time, float (*block)[4]) {
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
}

/* A rule's parameters: of arithmetic the fields, number after number. */
static void pack_rule(const sk_row *row, const sk_shader *shader, float (*block)[4]) {
    const void *params = params_of(row);
    if (shader->pack) shader->pack(params, block);
    if (!shader->arithmetic) return;
    const skein_kind *kind = kind_of(row);
    for (size_t i = 0, at = 0; i < kind->field_count; i++) {
        skein_value value = sk_field_load(&kind->fields[i], params);
        for (size_t k = 0; k < numbers_of(&kind->fields[i]); k++, at++) block[at / 4][at % 4] = (float)value.number[k];
    }
}

void sk_gpu_row_pack(const sk_row *row, const sk_run *run, float (*block)[4]) {
    double time = run->time;
    for (int k = 0; k < 3; k++) block[0][k] = (float)row->coefficient[k];
    block[0][3] = (float)row->dt;
    if (row->kind == SK_ROW_NEIGHBOUR) {
        const sk_force *force = row->rule;
        block[1][0] = (float)force->type->radius(force->params);
    }
    if (row->kind == SK_ROW_CONTACT_SETTLE) block[1][0] = sk_contact_reads_force(row->rule);
    if (sk_gpu_row_looks(row)) {
        uint32_t slot = run->slot_of[particle_of(row)];
        block[1][1] = (float)(slot >> 16), block[1][3] = (float)(slot & 0xffff);
    }
    // pair rules by formula know the end of the substep, fields the moment of the state
    block[1][2] = (float)(row->kind == SK_ROW_NEIGHBOUR ? time : time - row->before);
    block += SK_GPU_ROW;
    const sk_shader *shader = shader_of(row);
    if (has_pose(row)) {
        const sk_collider *collider = row->rule;
        pack_pose(collider, is_avoid(row) ? time : time - row->before, block);
        pack_rule(row, shader, block + SK_GPU_POSE);
    } else if (shader) {
        pack_rule(row, shader, block);
    } else if (rule_size(row)) {
        const sk_plain_force *plain = row->rule;
        sk_shader_vector(block[0], plain->acceleration);
        sk_shader_vector(block[1], plain->force);
        block[2][0] = (float)plain->linear, block[2][1] = (float)plain->rate;
    }
}

bool sk_gpu_row_moves(const sk_row *row) {
    const sk_shader *shader = shader_of(row);
    if (shader && shader->changes && shader->changes(params_of(row))) return true;
    if (!has_pose(row)) return false;
    return sk_collider_moves(row->rule);
}

/* ---- texts ---- */

void sk_gpu_put_members(sk_gpu_text *text, const sk_row *row, size_t number) {
    sk_gpu_put(text, "    vec4 row%zu[%d];\n", number, SK_GPU_ROW);
    if (has_pose(row)) sk_gpu_put(text, "    vec4 pose%zu[%d];\n", number, SK_GPU_POSE);
    if (rule_size(row)) sk_gpu_put(text, "    vec4 rule%zu[%zu];\n", number, rule_size(row));
}

/* A text that a type writes, with the row's number in it. */
typedef struct numbered {
    sk_gpu_text *text;
    size_t number;
} numbered;

static void put_numbered(void *user, const char *text) {
    const numbered *to = user;
    sk_gpu_put_text(to->text, text, to->number);
}

static void put_written(sk_gpu_text *text, const sk_row *row, size_t number) {
    const sk_shader *shader = shader_of(row);
    numbered to = {text, number};
    if (shader->write && !shader->write(params_of(row), put_numbered, &to)) text->no_memory = true;
}

/* "gravity" of "forces/gravity": what the names in its arithmetic begin with. */
static const char *stem_of(const sk_shader *shader) {
    return strrchr(shader->arithmetic, '/') + 1;
}

/* The struct of a kind's parameters, as its own file has it, and its arithmetic. */
static void put_arithmetic(sk_gpu_text *text, const sk_row *row, const sk_shader *shader) {
    const skein_kind *kind = kind_of(row);
    sk_gpu_put(text, "struct %s_params {\n", stem_of(shader));
    for (size_t i = 0; i < kind->field_count; i++) {
        size_t numbers = numbers_of(&kind->fields[i]);
        if (numbers) sk_gpu_put(text, "    %s %s;\n", numbers == 3 ? "vec3" : "float", kind->fields[i].name);
    }
    sk_gpu_put(text, "};\n");
    sk_gpu_put_file(text, shader->arithmetic, 0);
}

/* params@(): the parameters of one rule, from its block. */
static void put_params(sk_gpu_text *text, const sk_row *row, const sk_shader *shader, size_t n) {
    const skein_kind *kind = kind_of(row);
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
static void put_calls(sk_gpu_text *text, const sk_row *row, const sk_shader *shader, size_t n) {
    const char *stem = stem_of(shader);
    const sk_force *force = force_of(row);
    put_params(text, row, shader, n);
    if (row->kind == SK_ROW_NEIGHBOUR)
        sk_gpu_put(text, "#define sum%zu vec3\n"
                         "vec3 start%zu(vec3 heading) { return vec3(0); }\n"
                         "void meet%zu(inout vec3 sum, vec3 apart, float square, vec3 direction) {\n"
                         "    if (square > 0) sum += %s_push(params%zu(), apart, sqrt(square));\n"
                         "}\n"
                         "vec3 finish%zu(vec3 sum, float dt) { return sum; }\n", n, n, n, stem, n, n);
    else if (force && shader->shifts && shader->shifts(force->params))
        sk_gpu_put(text, "vec3 shift%zu(vec3 x) { return %s_shift(params%zu(), x); }\n", n, stem, n);
    else if (force && row->kind == SK_ROW_LIMIT)
        sk_gpu_put(text, "vec3 bound%zu(vec4 x, vec3 v, vec4 steering, float dt) {\n"
                         "    return %s_bound(params%zu(), x, v, steering, dt);\n}\n", n, stem, n);
    else if (!force)
        sk_gpu_put(text, "vec4 probe%zu(vec3 x) {\n"
                         "    sk_pose where = sk_pose(pose%zu[0].xyz, pose%zu[3].xyz, pose%zu[4].xyz, pose%zu[5].xyz, pose%zu[6].xyz);\n"
                         "    sk_contact contact = %s_probe(params%zu(), where, x);\n"
                         "    return vec4(contact.normal, contact.distance);\n}\n", n, n, n, n, n, n, stem, n);
    else if (force->type->deed == SK_STEERS)
        sk_gpu_put(text, "vec4 steer%zu(vec3 x, float dt) { return %s_steer(params%zu(), x, dt); }\n", n, stem, n);
    else
        sk_gpu_put(text, "vec3 force%zu(vec3 x, vec3 v, float mass) { return %s_force(params%zu(), %sv, mass); }\n", n,
                   stem, n, force->type->at_velocity ? "" : "x, ");
}

void sk_gpu_put_functions(sk_gpu_text *text, const sk_row *const *rows, size_t number) {
    const sk_row *row = rows[number];
    if (row->kind == SK_ROW_COMBINE && is_fall(row)) sk_gpu_put_file(text, "gpu/pull", number);
    if (has_pose(row)) sk_gpu_put_file(text, "colliders/pose", number);
    if (shader_of(row)) put_written(text, row, number);
    const sk_shader *shader = shader_of(row);
    if (shader && shader->file) sk_gpu_put_file(text, shader->file, number);
    if (shader && shader->arithmetic) {
        bool there = false, shapes = false; // rules of one kind share it, and shapes their words
        for (size_t i = 0; i < number; i++) {
            there |= shader_of(rows[i]) == shader;
            shapes |= has_pose(rows[i]) && shader_of(rows[i])->arithmetic;
        }
        if (has_pose(row) && !shapes) sk_gpu_put_file(text, "colliders/shape", 0);
        if (!there) put_arithmetic(text, row, shader);
        put_calls(text, row, shader, number);
    }
    if (is_contact(row)) sk_gpu_put_file(text, "colliders/contact", number);
    if (is_avoid(row)) sk_gpu_put_file(text, "colliders/avoid", number);
    if (row->kind == SK_ROW_NEIGHBOUR) sk_gpu_put_file(text, "gpu/walk", number);
}

/* V = v, V0 = V, X0 = X, X += h V; or, where only the correction will ask, X0 = X + h V. */
static void put_set_out(sk_gpu_text *text, const sk_row *row, size_t n) {
    if (row->source[2] == SK_V0) sk_gpu_put(text, "    V0.xyz = V.xyz;\n");
    if (row->source[2] != SK_X) sk_gpu_put(text, "    X0.xyz = X.xyz;\n");
    sk_gpu_put(text, "    X.xyz = X.xyz + row%zu[0].w * V.xyz;\n", n);
    if (row->source[2] == SK_X) sk_gpu_put(text, "    X0.xyz = X.xyz;\n");
}

static void put_combine(sk_gpu_text *text, const sk_row *row, size_t n) {
    const char *dst = sk_gpu_vector_name(row->dst), *p = sk_gpu_vector_name(row->source[0]),
               *q = sk_gpu_vector_name(row->source[1]), *r = sk_gpu_vector_name(row->source[2]);
    if (sk_row_is(row, &sk_combine_predict)) {
        sk_gpu_put(text, "    V.xyz = V.xyz + row%zu[0].w * X.w * F.xyz;\n", n);
        put_set_out(text, row, n);
    } else if (sk_row_is(row, &sk_combine_fall)) {
        sk_gpu_put(text, "    V.xyz = pulled%zu(X.w, V.xyz);\n", n);
        put_set_out(text, row, n);
    } else if (sk_row_is(row, &sk_combine_fall_on)) {
        sk_gpu_put(text, "    V.xyz = V.xyz + row%zu[0].x * (X.xyz - X0.xyz);\n    if (!last_turn) {\n", n);
        sk_gpu_put(text, "    V.xyz = pulled%zu(X.w, V.xyz);\n", n);
        put_set_out(text, row, n);
        sk_gpu_put(text, "    }\n");
    } else if (sk_row_is(row, &sk_combine_kick)) {
        sk_gpu_put(text, "    %s.xyz = %s.xyz + row%zu[0].x * X.w * %s.xyz;\n", dst, p, n, q);
    } else if (sk_row_is(row, &sk_combine_wipe)) {
        sk_gpu_put(text, "    %s = vec4(0);\n", dst);
    } else if (sk_row_is(row, &sk_combine_steer)) {
        sk_gpu_put(text, "    if (X.w > 0) %s.xyz += %s.xyz;\n", dst, q);
    } else if (sk_row_is(row, &sk_combine_lead)) {
        sk_gpu_put(text, "    if (!(X.w > 0)) %s.xyz += row%zu[0].x * %s.xyz;\n", dst, n, q);
    } else if (sk_row_is(row, &sk_combine_correction)) {
        // the same operations as predicted p, so that an untouched p corrects nothing
        if (row->coefficient[1] == 0)
            sk_gpu_put(text, "    %s.xyz = %s.xyz + row%zu[0].x * (%s.xyz - %s.xyz);\n", dst, dst, n, p, q);
        else
            sk_gpu_put(text, "    %s.xyz = %s.xyz + row%zu[0].x * (%s.xyz - (%s.xyz + row%zu[0].y * %s.xyz));\n", dst,
                       dst, n, p, q, n, dst);
    } else { // a sum
        sk_gpu_put(text, "    %s.xyz = ", dst);
        if (row->source[0] == SK_NONE) sk_gpu_put(text, "vec3(0)");
        else sk_gpu_put(text, "row%zu[0].x * %s.xyz", n, p);
        if (row->source[1] != SK_NONE) sk_gpu_put(text, " + row%zu[0].y * %s.xyz", n, q);
        if (row->source[2] != SK_NONE) sk_gpu_put(text, " + row%zu[0].z * %s.xyz", n, r);
        sk_gpu_put(text, ";\n");
    }
}

/* Only for the particles that the rule moves, where these are not all, and not for the one that it looks at. */
static void put_guard(sk_gpu_text *text, const sk_row *row, size_t n, size_t particle_count) {
    const sk_force *force = force_of(row);
    if (sk_gpu_row_looks(row))
        sk_gpu_put(text, "    if (first_slot + slot != uint(row%zu[1].y) * 65536u + uint(row%zu[1].w))\n", n, n);
    if (row->kind == SK_ROW_NEIGHBOUR || (force && force->type->deed == SK_PUSHES)) return;
    const sk_group *group = force ? &force->moved : row->group;
    if (group->first == 0 && group->end == particle_count) return;
    sk_gpu_put(text, "    if (first_slot + slot >= %zuu && first_slot + slot < %zuu)\n", group->first_slot,
               group->end_slot);
}

static void put_force(sk_gpu_text *text, const sk_row *row, size_t n, size_t particle_count) {
    const char *dst = sk_gpu_vector_name(row->dst);
    put_guard(text, row, n, particle_count);
    if (is_avoid(row)) sk_gpu_put(text, "    %s += avoid%zu(X.xyz, V.xyz);\n", dst, n);
    else if (row->kind == SK_ROW_NEIGHBOUR) sk_gpu_put(text, "    %s.xyz += walk%zu(place, X.xyz, V.xyz);\n", dst, n);
    else if (shifts(row))
        sk_gpu_put(text, "    if (X.w > 0) { vec3 shift = shift%zu(X.xyz); X.xyz += shift; P.xyz += shift; }\n", n);
    else if (row->kind == SK_ROW_LIMIT)
        sk_gpu_put(text, "    V.xyz = bound%zu(X, V.xyz, %s, row%zu[0].w);\n", n,
                   row->source[2] == SK_NONE ? "vec4(0)" : "S", n);
    else if (force_of(row)->type->deed == SK_STEERS)
        sk_gpu_put(text, "    %s += steer%zu(X.xyz, row%zu[0].w);\n", dst, n, n);
    else sk_gpu_put(text, "    %s.xyz %s force%zu(X.xyz, V.xyz, V.w);\n", dst, row->sets ? "=" : "+=", n);
}

static void put_statements(sk_gpu_text *text, const sk_row *row, size_t n, size_t particle_count) {
    switch (row->kind) {
    case SK_ROW_COMBINE: put_combine(text, row, n); break;
    case SK_ROW_FIELD:
    case SK_ROW_NEIGHBOUR:
    case SK_ROW_LIMIT: put_force(text, row, n, particle_count); break;
    case SK_ROW_CONTACT_FORCE: sk_gpu_put(text, "    contact_force%zu(X, V, F);\n", n); break;
    case SK_ROW_CONTACT_VELOCITY: sk_gpu_put(text, "    contact_impulse%zu(X, V);\n", n); break;
    case SK_ROW_CONTACT_POSITION: sk_gpu_put(text, "    contact_push%zu(X);\n", n); break;
    case SK_ROW_CONTACT_SETTLE:
        sk_gpu_put(text, "    contact_settle%zu(X, V, %s, %s, %s);\n", n,
                   sk_contact_reads_force(row->rule) ? "F" : "vec4(0)", sk_gpu_vector_name(row->source[1]),
                   sk_gpu_vector_name(row->source[2]));
        break;
    default: break;
    }
}

void sk_gpu_put_statements(sk_gpu_text *text, const sk_row *row, size_t n, size_t particle_count) {
    if (row->inner)
        sk_gpu_put(text, "    if (first_slot + slot >= %zuu && first_slot + slot < %zuu) {\n", row->first_slot, row->end_slot);
    put_statements(text, row, n, particle_count);
    if (row->inner) sk_gpu_put(text, "    }\n");
}
