/* A force of one's own: a whirlwind, which lifts what is near its axis and turns it round. It is written twice: as a
 * formula, which is all that a force needs to run under every method and on graphics cards; and as C, sixteen particles
 * at a time. Both are registered, set by name, and lift the same cloth. Built as a shared object this file's kinds are
 * the command's, too (skein/kinds.h):
 *     cc -shared -fPIC own_force.c -o own_force.so && SKEIN_KINDS=own_force.so skein list forces */
#include <math.h>
#include <skein/kinds.h>
#include <stdio.h>

/* ---- as a formula: its fields stand in the text by their names ---- */

static const skein_field whirl_fields[] = {
    SKEIN_FIELD_OF_FORMULA("lift", "m/s2", 14, -1e3, 1e3, "upwards, at the axis"),
    SKEIN_FIELD_OF_FORMULA("turn", "1/s2", 2, -1e3, 1e3, "around the axis, for each metre from it"),
    SKEIN_FIELD_OF_FORMULA("width", "m", 1, 1e-3, 1e3, "how far from the axis it is felt"),
};
static const skein_force_type whirl = {
    .kind = {"whirl", "a whirlwind about the vertical axis", SKEIN_FORCE, whirl_fields, 3, 0},
    .formula = "vec3(turn * p.z, lift, -turn * p.x) * exp(-(p.x^2 + p.z^2) / width^2) - 0.5 * v",
};

/* ---- as C: its fields are in a struct ---- */

typedef struct gust_params {
    double lift, turn, width;
} gust_params;
static const skein_field gust_fields[] = {
    SKEIN_FIELD_OF_REAL(gust_params, lift, "lift", "m/s2", 14, -1e3, 1e3, "upwards, at the axis"),
    SKEIN_FIELD_OF_REAL(gust_params, turn, "turn", "1/s2", 2, -1e3, 1e3, "around the axis, for each metre from it"),
    SKEIN_FIELD_OF_REAL(gust_params, width, "width", "m", 1, 1e-3, 1e3, "how far from the axis it is felt"),
};
static void gust_force(const void *data, double time, const skein_lanes *in, skein_real force[3][SKEIN_LANES]) {
    const gust_params *p = data;
    (void)time;
    for (int i = 0; i < SKEIN_LANES; i++) {
        double x = in->x[0][i], z = in->x[2][i], m = in->mass[i], near = exp(-(x * x + z * z) / (p->width * p->width));
        force[0][i] = (skein_real)(m * (p->turn * z * near - 0.5 * in->v[0][i]));
        force[1][i] = (skein_real)(m * (p->lift * near - 0.5 * in->v[1][i]));
        force[2][i] = (skein_real)(m * (-p->turn * x * near - 0.5 * in->v[2][i]));
    }
}
static const skein_force_type gust = {
    .kind = {"gust", "the same whirlwind, in C", SKEIN_FORCE, gust_fields, 3, sizeof(gust_params)},
    .on_velocity = true,
    .force = gust_force,
};

const skein_kind *const skein_module_kinds[] = {&whirl.kind, &gust.kind, NULL};

/* ---- a program that has them ---- */

static double height_under(const skein_kinds *kinds, const char *force) {
    skein_world_desc desc = skein_default_world_desc();
    desc.kinds = kinds;
    skein_world *world = skein_world_create(&desc, NULL);
    const skein_setting strong[] = {SKEIN_REAL("lift", 20), SKEIN_END};
    double x[3] = {0, -1, 0};
    bool good = world && !skein_body_add(world, "cloth", NULL, SKEIN_SETTINGS(SKEIN_PAIR("grid", 9, 9)), NULL) &&
                !skein_force_add(world, "gravity", NULL, NULL) && !skein_force_add(world, force, strong, NULL);
    for (int i = 0; good && i < 60; i++) good = !skein_world_step(world, SKEIN_DEFAULT_STEP);
    if (good) skein_positions_copy(world, 40, 1, x); // the middle one
    else fprintf(stderr, "own_force: %s\n", skein_world_error(world)->message);
    skein_world_destroy(world);
    return good ? x[1] : -1;
}

int main(void) {
    skein_error error = {SKEIN_OK, "", ""};
    skein_kinds *kinds = skein_kinds_create(&error);
    bool good = kinds != NULL;
    for (int i = 0; good && skein_module_kinds[i]; i++)
        good = !skein_kind_register(kinds, skein_module_kinds[i], &error);
    if (!good) return fprintf(stderr, "own_force: %s %s\n", error.where, error.message), 1;
    double by_formula = height_under(kinds, "whirl"), by_function = height_under(kinds, "gust");
    printf("lifted by %.3f m and %.3f m\n", by_formula, by_function);
    skein_kinds_destroy(kinds);
    return by_formula > 0.5 && fabs(by_formula - by_function) < 1e-3 ? 0 : 1;
}
