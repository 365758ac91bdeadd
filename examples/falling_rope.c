/* A rope of loose particles: held at one end, let go level, it swings down onto the floor.
 *
 * Prints the free end and the rope's largest stretch each tenth of a second. Shows particles and
 * constraints without any body, and a way to check every call: a function returns the first status
 * that is not 0 (SKEIN_OK), and the world keeps the words for it. */
#include <skein/skein.h>

#include <stdio.h>
#include <stdlib.h>

enum { LINKS = 40, PARTICLES = LINKS + 1, STEPS_A_TENTH = 9, TENTHS = 40 };

static const double length = 2.0, height = 1.5, mass = 0.3; /* m, m, kg */

/* Particles in a line, the first one held (its mass is 0), and a distance between neighbours. */
static skein_status add_rope(skein_world *world) {
    double positions[PARTICLES][3], masses[PARTICLES];
    uint32_t pairs[LINKS][2], first;
    for (int i = 0; i < PARTICLES; i++) {
        positions[i][0] = length * i / LINKS;
        positions[i][1] = height;
        positions[i][2] = 0;
        masses[i] = i ? mass / LINKS : 0;
    }
    skein_status status = skein_particles_add(world, PARTICLES, positions[0], NULL, masses, &first);
    if (status) return status;
    for (uint32_t i = 0; i < LINKS; i++) {
        pairs[i][0] = first + i;
        pairs[i][1] = first + i + 1;
    }
    const skein_setting stiff[] = {SKEIN_REAL("stiffness", 5e4), SKEIN_REAL("damping", 1), SKEIN_END};
    return skein_constraint_add(world, "distance", pairs[0], LINKS, stiff, NULL);
}

static skein_status build(skein_world *world) {
    skein_status status = add_rope(world);
    if (status) return status;
    if ((status = skein_method_set(world, "xpbd", SKEIN_SETTINGS(SKEIN_REAL("substeps", 20))))) return status;
    if ((status = skein_force_add(world, "gravity", NULL, NULL))) return status;
    if ((status = skein_force_add(world, "drag", SKEIN_SETTINGS(SKEIN_REAL("rate", 0.2)), NULL))) return status;
    const skein_setting floor[] = {SKEIN_VEC3("normal", 0, 1, 0), SKEIN_REAL("friction", 0.5), SKEIN_END};
    return skein_collider_add(world, "plane", floor, NULL);
}

static skein_status simulate(skein_world *world) {
    printf("  time, s      end x, y, z, m       stretch, %%\n");
    for (int tenth = 0; tenth <= TENTHS; tenth++) {
        double end[3];
        skein_statistics now;
        skein_status status = skein_positions_copy(world, PARTICLES - 1, 1, end);
        if (status || (status = skein_world_statistics(world, &now))) return status;
        printf("  %7.1f  %8.3f %7.3f %7.3f  %10.3f\n", now.time, end[0], end[1], end[2], 100 * now.max_stretch);
        for (int i = 0; i < STEPS_A_TENTH && tenth < TENTHS; i++)
            if ((status = skein_world_step(world, SKEIN_DEFAULT_STEP))) return status;
    }
    return SKEIN_OK;
}

int main(void) {
    skein_error failure = {0};
    skein_world *world = skein_world_create(NULL, &failure);
    bool good = world && !build(world) && !simulate(world);
    const skein_error *why = world ? skein_world_error(world) : &failure;
    if (!good) fprintf(stderr, "falling_rope: %s %s\n", why->where, why->message);
    skein_world_destroy(world);
    return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
