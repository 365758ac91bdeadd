/* A program that reads numbers as wide as it was compiled for. Linked to a library of the other precision it would print
 * garbage: it does not link (tests/programs.sh). */
#include <skein/skein.h>
#include <stdio.h>

int main(void) {
    skein_world *world = skein_world_create(NULL, NULL);
    const double positions[6] = {1, 2, 3, 4, 5, 6}, masses[2] = {1, 1};
    skein_particles_add(world, 2, positions, NULL, masses, NULL);
    skein_view view = skein_position_view(world);
    const skein_real *x = view.xyzw + 4 * view.slot_of[1];
    printf("%zu bytes: %g %g %g\n", sizeof(skein_real), (double)x[0], (double)x[1], (double)x[2]);
    skein_world_destroy(world);
    return !(skein_version() == SKEIN_VERSION_NUMBER);
}
