/* Where a collider stands, and how it moves there.
 *
 * Its own fields say where it is built (`place`, `turn`, `axis` of its type); `motion` moves it on from there as time
 * goes by, and all of that stands in a frame, where one leads it (world/frames.c). And when a field of its own has been set since the last step, it *travels*: through the next step it goes
 * from where it stood to where it is said to be, straight and turning evenly, so that it has a velocity for friction
 * and impacts and meets what is in its way. Where the fields lead is always the end: travel is what is still to go.
 *
 *   fields set --note, changed--> `from` --a step begins--> the rest of the way, less and less --its end--> none */
#include <math.h>
#include <string.h>

#include "base/rotation.h"
#include "colliders/collider.h"

/* ---- by its fields ---- */

/* rotation = rotation times the shape's own. */
static void turn_first(const sk_collider *collider, real rotation[9]) {
    double own[9];
    real moved[9];
    collider->type->turn(collider->params, own);
    memcpy(moved, rotation, sizeof moved);
    for (int r = 0; r < 3; r++)
        for (int c = 0; c < 3; c++)
            rotation[3 * r + c] =
                moved[3 * r] * (real)own[c] + moved[3 * r + 1] * (real)own[3 + c] + moved[3 * r + 2] * (real)own[6 + c];
}

static sk_vec3 turned(const real r[9], sk_vec3 n) {
    return sk_v3(r[0] * n.x + r[1] * n.y + r[2] * n.z, r[3] * n.x + r[4] * n.y + r[5] * n.z,
                 r[6] * n.x + r[7] * n.y + r[8] * n.z);
}

/* The same pose in a frame that has moved. */
static void put_into_frame(const sk_frame *frame, sk_pose *pose, double position[3]) {
    double place[3];
    real turn[9], own[9];
    sk_frame_place(frame, position, place);
    memcpy(position, place, sizeof place);
    memcpy(own, pose->rotation, sizeof own);
    for (int i = 0; i < 9; i++) turn[i] = (real)frame->turn[i];
    for (int i = 0; i < 9; i++) {
        int r = i / 3 * 3, c = i % 3;
        pose->rotation[i] = turn[r] * own[c] + turn[r + 1] * own[3 + c] + turn[r + 2] * own[6 + c];
    }
    pose->position = sk_v3_of(position);
    pose->velocity = turned(turn, pose->velocity);
    pose->spin = turned(turn, pose->spin);
    pose->axis = turned(turn, pose->axis);
}

/* Its position as exact as it is given, too: velocities are differences. */
static sk_pose stand(const sk_collider *collider, double time, double position[3]) {
    const sk_collider_common *common = collider->common;
    double since = time - common->start, axis[3] = {0, 1, 0};
    bool moving = since >= 0;
    if (!moving) since = 0;
    collider->type->place(collider->params, position);
    for (int k = 0; k < 3; k++) position[k] += common->velocity[k] * since;
    const double *a = common->axis;
    double spin = moving ? common->spin : 0, length = 0; // most do not turn: this is called for every few particles
    if (spin != 0) length = sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
    if (!(length > 0)) spin = 0;
    for (int k = 0; k < 3 && length > 0; k++) axis[k] = a[k] / length;

    sk_pose pose = {.position = sk_v3_of(position), .time = time};
    pose.velocity = moving ? sk_v3_of(common->velocity) : sk_v3(0, 0, 0);
    pose.spin = sk_v3((real)(axis[0] * spin), (real)(axis[1] * spin), (real)(axis[2] * spin));
    pose.rotation[0] = pose.rotation[4] = pose.rotation[8] = 1;
    if (spin != 0) {
        double matrix[9];
        sk_rotation_about(axis, spin * since, matrix);
        for (int i = 0; i < 9; i++) pose.rotation[i] = (real)matrix[i];
    }
    if (collider->type->turn) turn_first(collider, pose.rotation);
    if (collider->type->axis) {
        double unit[3];
        collider->type->axis(collider->params, unit);
        pose.axis = turned(pose.rotation, sk_v3_of(unit));
    }
    if (collider->led) put_into_frame(&collider->frame, &pose, position);
    return pose;
}

/* ---- on its way ---- */

sk_pose sk_collider_pose_at(const sk_collider *collider, double time) {
    double position[3];
    sk_pose pose = stand(collider, time, position);
    const sk_travel *travel = &collider->travel;
    if (!travel->moving) return pose;
    double rest = 1 - (time - travel->start) / travel->dt;
    rest = rest < 0 ? 0 : rest > 1 ? 1 : rest;
    for (int k = 0; k < 3; k++) position[k] += rest * travel->way[k];
    const double v = -1 / travel->dt;
    pose.position = sk_v3_of(position);
    pose.velocity = sk_v3(pose.velocity.x + (real)(v * travel->way[0]), pose.velocity.y + (real)(v * travel->way[1]),
                          pose.velocity.z + (real)(v * travel->way[2]));
    if (!(travel->angle > 0)) return pose;
    const double *u = travel->axis;
    double matrix[9], spin = v * travel->angle;
    real back[9], own[9];
    sk_rotation_about(u, rest * travel->angle, matrix);
    for (int i = 0; i < 9; i++) back[i] = (real)matrix[i], own[i] = pose.rotation[i];
    for (int i = 0; i < 9; i++) {
        int r = i / 3 * 3, c = i % 3;
        pose.rotation[i] = back[r] * own[c] + back[r + 1] * own[3 + c] + back[r + 2] * own[6 + c];
    }
    pose.axis = turned(back, pose.axis);
    pose.spin = sk_add(turned(back, pose.spin), sk_v3((real)(u[0] * spin), (real)(u[1] * spin), (real)(u[2] * spin)));
    return pose;
}

sk_pose sk_collider_pose_unled(const sk_collider *collider, double time) {
    sk_collider alone = *collider;
    const sk_travel *travel = &collider->travel;
    double position[3];
    alone.led = false;
    sk_pose pose = stand(&alone, time, position);
    if (!travel->noted || !travel->changed || collider->led) return pose;
    pose.position = sk_v3_of(travel->position); // it stands there until the next step
    for (int i = 0; i < 9; i++) pose.rotation[i] = (real)travel->rotation[i];
    if (collider->type->axis) pose.axis = sk_v3_of(travel->direction);
    return pose;
}

void sk_collider_own_place(const sk_collider *collider, double own[static 15]) {
    memset(own, 0, 15 * sizeof *own);
    collider->type->place(collider->params, own);
    if (collider->type->turn) collider->type->turn(collider->params, own + 3);
    if (collider->type->axis) collider->type->axis(collider->params, own + 12);
}

void sk_collider_note(sk_collider *collider, double time) {
    sk_travel *travel = &collider->travel;
    if (travel->noted || !collider->common->enabled) return;
    // the step is over: it has arrived
    sk_pose pose = stand(collider, time, travel->position);
    for (int i = 0; i < 9; i++) travel->rotation[i] = (double)pose.rotation[i];
    travel->direction[0] = (double)pose.axis.x, travel->direction[1] = (double)pose.axis.y,
    travel->direction[2] = (double)pose.axis.z;
    sk_collider_own_place(collider, travel->own);
    travel->noted = true;
}

bool sk_collider_changed(sk_collider *collider) {
    sk_travel *travel = &collider->travel;
    double own[15];
    if (!collider->common->enabled) travel->noted = travel->changed = false; // it is not there
    if (!travel->noted) return false;
    sk_collider_own_place(collider, own);
    travel->changed |= memcmp(own, travel->own, sizeof own) != 0;
    bool first = travel->changed && !travel->ever;
    travel->ever |= travel->changed;
    return first;
}

void sk_collider_begin(sk_collider *collider, double time, double dt) {
    sk_travel *travel = &collider->travel;
    if (collider->type->begin) collider->type->begin(collider->params, time, dt);
    bool changed = travel->changed;
    travel->moving = travel->noted = travel->changed = false;
    if (!changed) return;
    double position[3], rotation[9];
    sk_pose pose = stand(collider, time, position);
    const double direction[3] = {(double)pose.axis.x, (double)pose.axis.y, (double)pose.axis.z};
    for (int k = 0; k < 3; k++) {
        travel->way[k] = travel->position[k] - position[k];
        travel->moving |= travel->way[k] != 0;
    }
    for (int i = 0; i < 9; i++) rotation[i] = (double)pose.rotation[i];
    travel->angle = 0;
    if (collider->type->turn || collider->led)
        travel->angle = sk_rotation_from_to(travel->rotation, rotation, travel->axis);
    else if (collider->type->axis)
        travel->angle = sk_rotation_of_directions(travel->direction, direction, travel->axis);
    travel->moving |= travel->angle > 0;
    travel->start = time;
    travel->dt = dt;
}

void sk_collider_lead(sk_collider *collider, double time, const sk_frame *now, const sk_frame *carried,
                      const sk_frame *end) {
    sk_travel *travel = &collider->travel;
    collider->led = true;
    collider->frame = *now;
    sk_collider_note(collider, time);
    collider->frame = *end;
    if (!travel->noted) return; // it is not there
    double place[3], turned_by[9];
    sk_frame_place(carried, travel->position, place);
    memcpy(travel->position, place, sizeof place);
    sk_frame_turn(carried, travel->direction, place);
    memcpy(travel->direction, place, sizeof place);
    for (int i = 0; i < 9; i++) {
        const double *a = carried->turn + i / 3 * 3, *b = travel->rotation + i % 3;
        turned_by[i] = a[0] * b[0] + a[1] * b[3] + a[2] * b[6];
    }
    memcpy(travel->rotation, turned_by, sizeof turned_by);
    travel->changed = travel->ever = true;
}

void sk_collider_stop(sk_collider *collider) {
    sk_travel *travel = &collider->travel;
    travel->moving = travel->noted = travel->changed = false;
    if (collider->type->stop) collider->type->stop(collider->params);
}

bool sk_collider_moves(const sk_collider *collider) {
    const double *v = collider->common->velocity;
    return v[0] != 0 || v[1] != 0 || v[2] != 0 || collider->common->spin != 0 || collider->travel.ever;
}
