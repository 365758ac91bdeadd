/* Somebody's program, in what C11 and C++17 have in common: a cloth hangs for a second. Its caller compares the hash.
 */
#include <skein/formula.h>
#include <skein/names.h>
#include <skein/skein.h>
#include <stdio.h>

int main(int argc, char **argv) {
    skein_error error = {SKEIN_OK, "", ""};
    skein_world *world = skein_world_create(NULL, &error);
    const skein_setting cloth[] = {SKEIN_PAIR(SKEIN_CLOTH_GRID, 9, 9), SKEIN_TEXT(SKEIN_CLOTH_PINS, "top corners"),
                                   SKEIN_END};
    skein_statistics now;
    int good =
        world && !skein_body_add(world, "cloth", NULL, cloth, NULL) && !skein_force_add(world, "gravity", NULL, NULL);
    for (int i = 0; good && i < 60; i++) good = !skein_world_step(world, SKEIN_DEFAULT_STEP);
    good = good && !skein_world_statistics(world, &now) && now.particles == 81;
    if (good) printf("%016llx\n", (unsigned long long)skein_world_hash(world));
    else fprintf(stderr, "program: %s\n", world ? skein_world_error(world)->message : error.message);
    skein_world_destroy(world);
    (void)argc;
    (void)argv;
    return !good;
}
