/* Groups: who meets whom, by the layers that bodies are in. Of two sheets that fall on a tray the one of the group "ghosts"
 * goes through it; then the other one is put into that group, too. */
#include <skein/skein.h>
#include <stdio.h>
#include <stdlib.h>

static void check(const skein_world *world, skein_status status) {
    if (!status) return;
    fprintf(stderr, "groups: %s %s\n", skein_world_error(world)->where, skein_world_error(world)->message);
    exit(1);
}

static skein_handle add_sheet(skein_world *world, const char *groups, double height, const char *pins) {
    skein_handle sheet;
    const skein_setting settings[] = {
        SKEIN_PAIR("grid", 10, 10),   SKEIN_PAIR("size", 0.3, 0.3), SKEIN_VEC3("position", 0, height, 0),
        SKEIN_TEXT("groups", groups), SKEIN_TEXT("pins", pins),     SKEIN_END};
    check(world, skein_body_add(world, "cloth", NULL, settings, &sheet));
    return sheet;
}

static double height(skein_world *world, skein_handle sheet) {
    skein_surface surface;
    double place[3];
    check(world, skein_body_surface(world, sheet, &surface));
    check(world, skein_positions_copy(world, surface.first_particle, 1, place));
    return place[1];
}

static void run(skein_world *world, int steps) {
    for (int i = 0; i < steps; i++) check(world, skein_world_step(world, SKEIN_DEFAULT_STEP));
}

int main(void) {
    skein_error failure = {0};
    skein_world *world = skein_world_create(NULL, &failure);
    if (!world) return fprintf(stderr, "groups: %s\n", failure.message), 1;
    const skein_setting touch[] = {SKEIN_REAL("thickness", 0.01), SKEIN_TEXT("ignore", "ghosts:things, ghosts"),
                                   SKEIN_END};
    const skein_setting ground[] = {SKEIN_REAL("offset", -1), SKEIN_TEXT("on", "things, ghosts"), SKEIN_END};
    check(world, skein_force_add(world, "gravity", NULL, NULL));
    check(world, skein_force_add(world, "contact", touch, NULL));
    check(world, skein_collider_add(world, "plane", ground, NULL));
    add_sheet(world, "things", 0, "all");
    skein_handle blanket = add_sheet(world, "things, soft", 0.05, ""), spirit = add_sheet(world, "ghosts", 0.1, "");
    run(world, 60);
    double first[2] = {height(world, blanket), height(world, spirit)};
    check(world, skein_set(world, blanket, "groups", skein_text("ghosts"))); /* from the next step on */
    run(world, 60);
    double then = height(world, blanket);
    printf("after 1 s the blanket is at %.2f m, the spirit at %.2f m; after 2 s the blanket at %.2f m\n", first[0],
           first[1], then);
    skein_world_destroy(world);
    return !(first[0] > 0 && first[1] < -0.9 && then < -0.9);
}
