/* A cape on somebody who walks: a figure of capsules, and pins on its shoulders, both moved by the program before each
 * step. What is set is where they are at the end of the step; Skein sees how fast that is. */
#include <math.h>
#include <skein/skein.h>
#include <stdio.h>
#include <stdlib.h>

enum { ROWS = 33, COLUMNS = 21, LIMBS = 6 };
static const double dt = 1.0 / 60, speed = 1.4, stride = 2 * 3.14159265358979 / 1.1; // 1.1 s for two steps

/* A rod of the figure, from one joint to another; its joints swing about the hip or the shoulder. */
typedef struct limb {
    double from[3], to[3], radius, swing; /* swing: radians, of what is below `from`, forth and back */
    skein_handle collider;
} limb;

static limb figure[LIMBS] = {
    {{0, 1.05, 0}, {0, 1.38, 0}, 0.15, 0, {0}},            /* trunk */
    {{-0.13, 1.42, 0}, {0.13, 1.42, 0}, 0.08, 0, {0}},     /* shoulders */
    {{-0.10, 0.92, 0}, {-0.10, 0.10, 0}, 0.08, 0.45, {0}}, /* legs */
    {{0.10, 0.92, 0}, {0.10, 0.10, 0}, 0.08, -0.45, {0}},
    {{-0.24, 1.36, 0}, {-0.26, 0.80, 0}, 0.05, -0.35, {0}}, /* arms */
    {{0.24, 1.36, 0}, {0.26, 0.80, 0}, 0.05, 0.35, {0}},
};

static void check(const skein_world *world, skein_status status) {
    if (!status) return;
    fprintf(stderr, "%s: %s\n", skein_world_error(world)->where, skein_world_error(world)->message);
    exit(1);
}

/* How far it has come, and how much it bobs: it sets out gently. */
static double way(double t) {
    return t < 1 ? 0.5 * speed * t * t : speed * (t - 0.5);
}
static double bob(double t) {
    return 0.02 * cos(2 * stride * t) * fmin(t, 1);
}

static void ends_of(const limb *l, double t, double from[3], double to[3]) {
    double angle = l->swing * sin(stride * t) * fmin(t, 1), down = l->to[1] - l->from[1],
           shift[3] = {0, bob(t), way(t)};
    for (int k = 0; k < 3; k++) from[k] = l->from[k] + shift[k], to[k] = l->to[k] + shift[k];
    if (l->swing != 0) to[1] = from[1] + down * cos(angle), to[2] = from[2] + down * sin(angle);
}

static void build(skein_world *world) {
    const skein_setting cape[] = {SKEIN_PAIR("grid", ROWS, COLUMNS),
                                  SKEIN_PAIR("size", 0.5, 0.85),
                                  SKEIN_VEC3("rotation", 90, 0, 0),
                                  SKEIN_VEC3("position", 0, 1.03, -0.17),
                                  SKEIN_TEXT("pins", "top edge"),
                                  SKEIN_REAL("stretch.damping", 1),
                                  {NULL, {0, {0}, NULL}}};
    const skein_setting air[] = {SKEIN_REAL("rate", 0.5), {NULL, {0, {0}, NULL}}};
    check(world, skein_body_add(world, "cloth", NULL, cape, NULL));
    check(world, skein_force_add(world, "gravity", NULL, NULL));
    check(world, skein_force_add(world, "drag", air, NULL));
    check(world, skein_collider_add(world, "plane", NULL, NULL)); // the ground
    for (int i = 0; i < LIMBS; i++) {
        const double *a = figure[i].from, *b = figure[i].to;
        const skein_setting rod[] = {SKEIN_VEC3("from", a[0], a[1], a[2]),
                                     SKEIN_VEC3("to", b[0], b[1], b[2]),
                                     SKEIN_REAL("radius", figure[i].radius),
                                     SKEIN_REAL("thickness", 0.006),
                                     {NULL, {0, {0}, NULL}}};
        check(world, skein_collider_add(world, "capsule", rod, &figure[i].collider));
    }
}

int main(void) {
    skein_world *world = skein_world_create(NULL, NULL);
    if (!world) return 1;
    build(world);
    double shoulders[3 * COLUMNS], at[3 * COLUMNS], from[3], to[3], worst = 0;
    check(world, skein_positions_copy(world, 0, COLUMNS, shoulders)); // the first row is pinned
    for (int step = 1; step <= 300; step++) {
        double t = step * dt;
        for (int i = 0; i < LIMBS; i++) {
            ends_of(&figure[i], t, from, to);
            check(world, skein_set(world, figure[i].collider, "from", skein_vector(from[0], from[1], from[2])));
            check(world, skein_set(world, figure[i].collider, "to", skein_vector(to[0], to[1], to[2])));
        }
        for (int i = 0; i < COLUMNS; i++)
            at[3 * i] = shoulders[3 * i], at[3 * i + 1] = shoulders[3 * i + 1] + bob(t),
                   at[3 * i + 2] = shoulders[3 * i + 2] + way(t);
        check(world, skein_pins_move(world, NULL, COLUMNS, at));
        check(world, skein_world_step(world, dt));
        skein_statistics now;
        check(world, skein_world_statistics(world, &now));
        worst = fmax(worst, now.max_stretch);
    }
    check(world, skein_positions_copy(world, (ROWS - 1) * COLUMNS + COLUMNS / 2, 1, at));
    printf("walked %.2f m; the hem is %.2f m behind, %.2f m up; largest stretch %.1f %%\n", way(300 * dt),
           way(300 * dt) - at[2], at[1], 100 * worst);
    skein_world_destroy(world);
    return 0;
}
