/* A flag: a mesh of your own as cloth, held along its pole, in the wind, with the numbers of a real fabric; as an OBJ at the
 * end, for any program that shows meshes. */
#include <skein/skein.h>
#include <stdio.h>

enum { ROWS = 25, COLUMNS = 41 };

int main(void) {
    static double points[3 * ROWS * COLUMNS];
    static uint32_t corners[4 * (ROWS - 1) * (COLUMNS - 1)], sizes[(ROWS - 1) * (COLUMNS - 1)], pole[ROWS];
    size_t faces = 0;
    for (uint32_t r = 0; r < ROWS; r++) {
        pole[r] = r * COLUMNS;
        for (uint32_t c = 0; c < COLUMNS; c++) {
            double *p = points + 3 * (r * COLUMNS + c); /* 1.5 m x 0.9 m, from the pole along x, in metres */
            p[0] = 1.5 * c / (COLUMNS - 1), p[1] = 2 - 0.9 * r / (ROWS - 1), p[2] = 0;
            if (r + 1 == ROWS || c + 1 == COLUMNS) continue;
            uint32_t first = r * COLUMNS + c, quad[4] = {first, first + COLUMNS, first + COLUMNS + 1, first + 1};
            for (int k = 0; k < 4; k++) corners[4 * faces + (size_t)k] = quad[k];
            sizes[faces++] = 4;
        }
    }
    skein_mesh mesh = {points, ROWS * COLUMNS, sizes, faces, corners, 4 * faces};
    const skein_setting cloth[] = {SKEIN_TEXT("fabric", "silk"), SKEIN_REAL("stretch.limit", 0.05), SKEIN_END};
    const skein_setting wind[] = {SKEIN_VEC3("velocity", 8, 0, 3), SKEIN_END};

    skein_error failure = {0};
    skein_world *world = skein_world_create(NULL, &failure);
    bool good = world && !skein_body_add(world, "cloth", &mesh, cloth, NULL) &&
                !skein_force_add(world, "gravity", NULL, NULL) && !skein_force_add(world, "surface_wind", wind, NULL);
    for (uint32_t r = 0; r < ROWS && good; r++) good = !skein_particle_pin(world, pole[r], true);
    for (int i = 0; i < 270 && good; i++) good = !skein_world_step(world, SKEIN_DEFAULT_STEP);
    good = good && !skein_positions_copy(world, 0, ROWS * COLUMNS, points);
    if (good) {
        printf("# a flag after 3 s of wind\n");
        for (size_t i = 0; i < ROWS * COLUMNS; i++)
            printf("v %.6f %.6f %.6f\n", points[3 * i], points[3 * i + 1], points[3 * i + 2]);
        for (size_t f = 0; f < faces; f++)
            printf("f %u %u %u %u\n", corners[4 * f] + 1, corners[4 * f + 1] + 1, corners[4 * f + 2] + 1,
                   corners[4 * f + 3] + 1);
    }
    const skein_error *why = world ? skein_world_error(world) : &failure;
    if (!good) fprintf(stderr, "flag: %s %s\n", why->where, why->message);
    skein_world_destroy(world);
    return !good;
}
