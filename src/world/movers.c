/* What moves a body whatever it does itself: rules that change as time goes by, rules that steer, motions; and colliders that move and
 * come near. Looked at before a step, for who sleeps is to be awake in it. */
#include <ctype.h>
#include <math.h>
#include <string.h>

#include "colliders/trimesh.h"
#include "world/sleep.h"

/* ---- rules that change ---- */

/* Whether a formula has a name in it. */
static bool has_name(const char *text, const char *name) {
    const size_t length = strlen(name);
    for (bool in_word = false; *text; text++) {
        const bool letter = isalnum((unsigned char)*text) || *text == '_' || *text == '.';
        if (letter && !in_word && !strncmp(text, name, length) && !isalnum((unsigned char)text[length]) &&
            text[length] != '_')
            return true;
        in_word = letter;
    }
    return false;
}

/* Whether a rule that is made may be another one at another time: one by formulas with t in them, or by what cannot be read. */
static bool may_change(const sk_object *object) {
    if (!object->making) return false;
    if (!object->making->by_text) return true;
    for (size_t f = 0; f < object->kind->field_count; f++) {
        const skein_field *field = &object->kind->fields[f];
        const char *text = field->type == SKEIN_FIELD_TEXT ? sk_field_load(field, object->params).text : NULL;
        if (text && has_name(text, "t")) return true;
    }
    return false;
}

/* How far the vertices of a mesh are led in the next step, at most, m. */
static double way_of_vertices(const sk_collider *collider) {
    const sk_trimesh *m = collider->type->surface ? collider->type->surface(collider->params) : NULL;
    return m ? sk_trimesh_way(m) * (collider->type->scale ? collider->type->scale(collider->params) : 1) : 0;
}

/* Whether a collider is elsewhere, or another, when the next step is over. */
static bool moves_on(const sk_object *object, const sk_pose pose[2]) {
    const sk_collider *collider = object->as.collider;
    const bool made = object->making && !collider->type->take; // by a formula, or by functions of the program's
    if (memcmp(&pose[0].position, &pose[1].position, sizeof pose[0].position) != 0) return true;
    if (memcmp(pose[0].rotation, pose[1].rotation, sizeof pose[0].rotation) != 0) return true;
    if (memcmp(&pose[0].axis, &pose[1].axis, sizeof pose[0].axis) != 0) return true;
    return collider->common->spin != 0 || way_of_vertices(collider) > 0 || (made && may_change(object));
}

/* The farthest point of a body's box from a pose. */
static double reach_of(const sk_pose *pose, const sk_sleeper *s) {
    const double from[3] = {(double)pose->position.x, (double)pose->position.y, (double)pose->position.z};
    double far = 0;
    for (int k = 0; k < 3; k++)
        far += pow(fmax(fabs((double)s->low[k] - from[k]), fabs((double)s->high[k] - from[k])), 2);
    return sqrt(far);
}

/* How far a point of the body's box may be led by what a collider does between two poses. */
static double way_between(const sk_pose *a, const sk_pose *b, const sk_sleeper *s) {
    const double way[3] = {(double)(b->position.x - a->position.x), (double)(b->position.y - a->position.y),
                           (double)(b->position.z - a->position.z)};
    const double axis[3] = {(double)(b->axis.x - a->axis.x), (double)(b->axis.y - a->axis.y),
                            (double)(b->axis.z - a->axis.z)};
    double turned = 0;
    for (int i = 0; i < 9; i++) turned += pow((double)b->rotation[i] - (double)a->rotation[i], 2);
    for (int k = 0; k < 3; k++) turned += axis[k] * axis[k];
    return sqrt(way[0] * way[0] + way[1] * way[1] + way[2] * way[2]) + sqrt(turned) * reach_of(a, s);
}

/* What is met on the way from one pose to the other is no farther from one of them than half that way. Vertices that are led are
 * looked for where they are. */
static bool is_met_by(const skein_world *world, const sk_collider *collider, const sk_pose pose[2], const sk_sleeper *s,
                      double dt) {
    const double spins = dt * fabs(collider->common->spin) * reach_of(&pose[0], s);
    const double clear =
        2 * collider->common->thickness + way_between(&pose[0], &pose[1], s) + spins + way_of_vertices(collider);
    for (int i = 0; i < 2; i++)
        if (!sk_collider_is_far(world, collider, &pose[i], s->low, s->high, clear) &&
            !(sk_collider_distance(world, collider, &pose[i], s->body) > clear))
            return true;
    return false;
}

bool sk_is_met(const skein_world *world, const sk_sleeper *s, double dt) {
    for (size_t i = 0; i < world->objects.count; i++) {
        const sk_object *object = world->objects.data[i];
        sk_pose pose[2];
        if (object->category != SKEIN_COLLIDER || !object->as.collider->common->enabled) continue;
        const char *on = object->as.collider->common->on;
        if (on[0] && !sk_names_mean(on, s->common->name, s->common->groups)) continue;
        sk_collider_find_poses(world, object->as.collider, dt, pose);
        if (moves_on(object, pose) && is_met_by(world, object->as.collider, pose, s, dt)) return true;
    }
    return false;
}

bool sk_is_driven(const skein_world *world, const sk_sleeper *s) {
    const sk_body *body = s->body;
    for (size_t i = 0; i < world->objects.count; i++) {
        const sk_object *object = world->objects.data[i];
        if (object->category == SKEIN_FORCE && object->common.plain.enabled) {
            const sk_force *force = object->as.force;
            const char *on = object->common.plain.on;
            const bool pushes = force->type->phase == SK_PUSHES || force->type->phase == SK_MEETS;
            const bool steers = !pushes || force->type->radius || sk_force_particle(force) >= 0;
            if ((steers || may_change(object)) && (!on[0] || sk_names_mean(on, s->common->name, s->common->groups)))
                return true;
        }
        if (object->category == SKEIN_CONSTRAINT && object->common.plain.enabled && may_change(object)) {
            const sk_batch *batch = object->as.batch;
            for (size_t k = 0; k < batch->count * batch->arity; k++)
                if (batch->particle[k] - body->first_particle < body->particle_count) return true;
        }
    }
    return sk_world_carries(world, s->common);
}
