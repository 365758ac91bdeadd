/* The smallest whole program: a cloth hangs from two corners for ten seconds. README.md shows it. */
#include <skein/skein.h>
#include <stdio.h>

int main(void) {
    skein_error failure = {0};
    skein_world *world = skein_world_create(NULL, &failure);
    const skein_setting cloth[] = {SKEIN_PAIR("grid", 33, 33), SKEIN_TEXT("pins", "top corners"), SKEIN_END};
    bool good =
        world && !skein_body_add(world, "cloth", NULL, cloth, NULL) && !skein_force_add(world, "gravity", NULL, NULL);
    for (int i = 0; good && i < 900; i++) good = !skein_world_step(world, SKEIN_DEFAULT_STEP);
    skein_statistics now;
    good = good && !skein_world_statistics(world, &now);
    if (good) printf("%zu particles, %.1f s, stretch %.2f %%\n", now.particles, now.time, 100 * now.max_stretch);
    const skein_error *why = world ? skein_world_error(world) : &failure;
    if (!good) fprintf(stderr, "hello_cloth: %s %s\n", why->where, why->message);
    skein_world_destroy(world);
    return !good;
}
