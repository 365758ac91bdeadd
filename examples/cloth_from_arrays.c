/* A cloth from a program's own arrays: pinned by two corners, in a wind, and hit by a ball that comes
 * flying. Writes the last state as an OBJ: cloth_from_arrays [FILE], else to the standard output.
 *
 * Kinds and fields are named by the constants of skein/names.h, which an editor completes and a compiler checks. */
#include <skein/names.h>
#include <skein/skein.h>

#include <stdio.h>
#include <stdlib.h>

enum { ACROSS = 31, DOWN = 41, VERTICES = ACROSS * DOWN, FACES = 2 * (ACROSS - 1) * (DOWN - 1) };

static double positions[VERTICES][3];
static uint32_t face_sizes[FACES], face_vertices[FACES][3];

/* A curtain of 0.9 by 1.2 m in the plane z = 0, its upper edge at y = 1.5, cut into triangles. */
static void fill_arrays(void) {
    for (int i = 0; i < VERTICES; i++) {
        positions[i][0] = 0.9 * (i % ACROSS) / (ACROSS - 1) - 0.45;
        positions[i][1] = 1.5 - 1.2 * (i / ACROSS) / (DOWN - 1);
    }
    for (uint32_t f = 0; f < FACES; f++) {
        uint32_t cell = f / 2, a = cell / (ACROSS - 1) * ACROSS + cell % (ACROSS - 1), below = a + ACROSS;
        face_sizes[f] = 3;
        face_vertices[f][0] = f % 2 ? a + 1 : a;
        face_vertices[f][1] = below;
        face_vertices[f][2] = f % 2 ? below + 1 : a + 1;
    }
}

static skein_status build(skein_world *world, skein_handle *cloth) {
    skein_mesh mesh = {positions[0], VERTICES, face_sizes, FACES, face_vertices[0], (size_t)3 * FACES};
    /* vertices 0 and 30 are the upper corners; "top corners" would find them, too */
    const skein_setting sheet[] = {SKEIN_TEXT(SKEIN_CLOTH_PINS, "0 30"), SKEIN_REAL(SKEIN_CLOTH_DENSITY, 0.15),
                                   SKEIN_END};
    const skein_setting wind[] = {SKEIN_VEC3(SKEIN_SURFACE_WIND_VELOCITY, 0.5, 0, 2.5), SKEIN_END};
    /* the ball starts behind the curtain and goes through its plane in half a second */
    const skein_setting ball[] = {SKEIN_VEC3(SKEIN_SPHERE_CENTRE, 0, 0.9, -0.8), SKEIN_REAL(SKEIN_SPHERE_RADIUS, 0.2),
                                  SKEIN_REAL(SKEIN_COLLIDER_THICKNESS, 0.01),
                                  SKEIN_VEC3(SKEIN_COLLIDER_MOTION_VELOCITY, 0, 0, 1.6), SKEIN_END};
    skein_status status;
    if ((status = skein_body_add(world, SKEIN_CLOTH, &mesh, sheet, cloth))) return status;
    if ((status = skein_force_add(world, SKEIN_GRAVITY, NULL, NULL))) return status;
    if ((status = skein_force_add(world, SKEIN_SURFACE_WIND, wind, NULL))) return status;
    return skein_collider_add(world, SKEIN_SPHERE, ball, NULL);
}

/* Vertices and their normals come interleaved, as a graphics card takes them. */
static bool write_obj(skein_world *world, skein_handle cloth, FILE *to) {
    static struct vertex { float position[3], normal[3]; } v[VERTICES];
    skein_surface s;
    if (skein_body_surface(world, cloth, &s) ||
        skein_body_vertices_copy(world, cloth, 1, skein_floats(v[0].position, sizeof *v),
                                 skein_floats(v[0].normal, sizeof *v)))
        return false;
    for (size_t i = 0; i < s.vertex_count; i++)
        fprintf(to, "v %.6f %.6f %.6f\nvn %.6f %.6f %.6f\n", (double)v[i].position[0], (double)v[i].position[1],
                (double)v[i].position[2], (double)v[i].normal[0], (double)v[i].normal[1], (double)v[i].normal[2]);
    const uint32_t *corner = s.face_vertices;
    for (size_t f = 0; f < s.face_count; f++) {
        fputc('f', to);
        for (uint32_t k = 0; k < s.face_sizes[f]; k++, corner++) fprintf(to, " %u//%u", *corner + 1, *corner + 1);
        fputc('\n', to);
    }
    return !ferror(to);
}

int main(int argc, char **argv) {
    skein_error failure = {0};
    skein_handle cloth;
    fill_arrays();
    skein_world *world = skein_world_create(NULL, &failure);
    bool good = world && !build(world, &cloth);
    for (int i = 0; good && i < 90; i++) good = !skein_world_step(world, SKEIN_DEFAULT_STEP);
    const skein_error *why = world ? skein_world_error(world) : &failure;
    if (!good) fprintf(stderr, "cloth_from_arrays: %s %s\n", why->where, why->message);
    if (good) {
        FILE *to = argc > 1 ? fopen(argv[1], "w") : stdout;
        good = to && write_obj(world, cloth, to);
        if (to && fclose(to)) good = false; /* the disk may be full only now */
        if (!good) perror("cloth_from_arrays");
    }
    skein_world_destroy(world);
    return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
