/* Colliders made from meshes: their distances against the same solids by formulas and against a search over all triangles, what lies on
 * them, slides, bounces and is carried under every method, what is said of meshes with holes, and the same bits for any width. */
#include "all_methods.h"
#include "helpers.h"
#include "solids.h"

static skein_handle add_solid(skein_world *world, solid *s, const skein_setting *settings) {
    skein_handle handle;
    OK(world, skein_collider_add_mesh(world, "mesh", &s->mesh, settings, &handle));
    free(s); // it is copied
    return handle;
}

static double random_in(uint64_t *seed, double low, double high) {
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    return low + (high - low) * (double)(*seed >> 40) / (double)(1 << 24);
}

/* ---- distances ---- */

/* A mesh of a box and a box are the same solid, turned and moved. */
static void a_box_is_a_box(void **state) {
    (void)state;
    enum { POINTS = 500 };
    skein_world *world = skein_world_create(NULL, NULL);
    const skein_setting where[] = {SKEIN_VEC3("position", 1, 2, -1), SKEIN_VEC3("rotation", 20, 30, 40),
                                   SKEIN_REAL("scale", 2), SKEIN_END};
    skein_handle mesh = add_solid(world, make_box(0.5, 0.3, 0.4), where), box;
    OK(world, skein_collider_add(world, "box",
                                 SKEIN_SETTINGS(SKEIN_VEC3("centre", 1, 2, -1), SKEIN_VEC3("rotation", 20, 30, 40),
                                                SKEIN_VEC3("size", 1, 0.6, 0.8)),
                                 &box));
    double points[POINTS][3], distance[2][POINTS], normal[2][POINTS][3];
    uint64_t seed = 1;
    for (int i = 0; i < POINTS; i++)
        for (int k = 0; k < 3; k++) points[i][k] = (k == 0 ? 1 : k == 1 ? 2 : -1) + random_in(&seed, -1, 1);
    OK(world, skein_collider_probe(world, mesh, POINTS, points[0], distance[0], normal[0][0]));
    OK(world, skein_collider_probe(world, box, POINTS, points[0], distance[1], normal[1][0]));
    int inside = 0;
    for (int i = 0; i < POINTS; i++) {
        assert_near(distance[0][i], distance[1][i], 40 * EPSILON);
        inside += distance[1][i] < 0;
        double dot = 0;
        for (int k = 0; k < 3; k++) dot += normal[0][i][k] * normal[1][i][k];
        // deep inside two faces may be as near
        if (fabs(distance[1][i]) > 1e-3 && distance[1][i] > -0.2) assert_true(dot > 0.999 || distance[1][i] < 0);
    }
    assert_true(inside > 20 && inside < POINTS - 20);
    skein_world_destroy(world);
}

static double to_segment(const double p[3], const double a[3], const double b[3]) {
    double ab[3], ap[3], square = 0, along = 0, sum = 0;
    for (int k = 0; k < 3; k++)
        ab[k] = b[k] - a[k], ap[k] = p[k] - a[k], square += ab[k] * ab[k], along += ab[k] * ap[k];
    double t = fmax(0, fmin(1, along / square));
    for (int k = 0; k < 3; k++) sum += pow(ap[k] - t * ab[k], 2);
    return sqrt(sum);
}

/* The distance to a triangle, by its sides and its plane. */
static double to_triangle(const double p[3], const double a[3], const double b[3], const double c[3]) {
    double least = fmin(to_segment(p, a, b), fmin(to_segment(p, b, c), to_segment(p, c, a))), ab[3], ac[3], ap[3];
    for (int k = 0; k < 3; k++) ab[k] = b[k] - a[k], ac[k] = c[k] - a[k], ap[k] = p[k] - a[k];
    double n[3] = {ab[1] * ac[2] - ab[2] * ac[1], ab[2] * ac[0] - ab[0] * ac[2], ab[0] * ac[1] - ab[1] * ac[0]};
    double nn = n[0] * n[0] + n[1] * n[1] + n[2] * n[2], up = (n[0] * ap[0] + n[1] * ap[1] + n[2] * ap[2]) / nn;
    double bb = 0, bc = 0, cc = 0, pb = 0, pc = 0;
    for (int k = 0; k < 3; k++)
        bb += ab[k] * ab[k], bc += ab[k] * ac[k], cc += ac[k] * ac[k], pb += ap[k] * ab[k], pc += ap[k] * ac[k];
    double v = (cc * pb - bc * pc) / (bb * cc - bc * bc), w = (bb * pc - bc * pb) / (bb * cc - bc * bc);
    return v >= 0 && w >= 0 && v + w <= 1 ? fmin(least, fabs(up) * sqrt(nn)) : least;
}

/* The nearest of all triangles is found, from wherever one looks; and the side: here a ball with bumps, whose radius is known. */
static void the_nearest_of_all(void **state) {
    (void)state;
    enum { POINTS = 400 };
    skein_world *world = skein_world_create(NULL, NULL);
    solid *s = make_ball(1, 0.2, 20), copy = *s;
    copy.mesh.positions = &copy.position[0][0], copy.mesh.face_sizes = copy.size, copy.mesh.face_vertices = copy.corner;
    skein_handle mesh = add_solid(world, s, NULL);
    double points[POINTS][3], distance[POINTS];
    uint64_t seed = 3;
    for (int i = 0; i < POINTS * 3; i++) points[i / 3][i % 3] = random_in(&seed, -1.6, 1.6);
    OK(world, skein_collider_probe(world, mesh, POINTS, points[0], distance, NULL));
    int inside = 0;
    for (int i = 0; i < POINTS; i++) {
        double least = INFINITY, r = 0, flat = hypot(points[i][0], points[i][2]);
        const uint32_t *corner = copy.corner;
        for (size_t f = 0; f < copy.mesh.face_count; corner += copy.size[f++])
            for (uint32_t k = 2; k < copy.size[f]; k++)
                least = fmin(least, to_triangle(points[i], copy.position[corner[0]], copy.position[corner[k - 1]],
                                                copy.position[corner[k]]));
        for (int k = 0; k < 3; k++) r += points[i][k] * points[i][k];
        assert_near(fabs(distance[i]), least, 100 * EPSILON);
        double a = atan2(flat, points[i][1]),
               surface = 1 + 0.2 * sin(5 * a) * cos(4 * atan2(points[i][2], points[i][0]));
        if (fabs(sqrt(r) - surface) > 0.05) assert_int_equal(distance[i] < 0, sqrt(r) < surface);
        inside += distance[i] < 0;
    }
    assert_true(inside > 20);
    skein_world_destroy(world);
}

typedef struct heard {
    char text[400];
} heard;
static void hear(void *user, skein_log_level level, const char *message) {
    heard *h = user;
    if (level == SKEIN_LOG_WARNING) snprintf(h->text, sizeof h->text, "%s", message);
}

/* A box with a hole is still solid inside, and says that it is open; one without its lid holds what lies in it; a sheet is solid
 * from both sides. */
static void what_is_open(void **state) {
    (void)state;
    heard h = {""};
    skein_world_desc desc = skein_default_world_desc();
    desc.log = hear, desc.log_user = &h;
    skein_world *world = skein_world_create(&desc, NULL);
    solid *s = make_box(1, 1, 1);
    s->size[5] = 3, s->mesh.face_vertex_count = 23; // half of the face at +x
    skein_handle open = add_solid(world, s, NULL);
    assert_non_null(strstr(h.text, "3 open edges"));
    double points[][3] = {{-0.4, 0, 0}, {-0.6, 0, 0}, {0, 0, 0.45}, {0, -0.45, 0.1}}, distance[4], normal[4][3];
    OK(world, skein_collider_probe(world, open, 4, points[0], distance, normal[0]));
    assert_near(distance[0], -0.1, 10 * EPSILON);
    assert_near(distance[1], 0.1, 10 * EPSILON);
    assert_near(distance[2], -0.05, 10 * EPSILON);
    assert_near(normal[0][0], -1, 10 * EPSILON);
    assert_near(normal[2][2], 1, 10 * EPSILON);
    s = make_box(1, 1, 1);
    s->mesh.face_count = 5, s->mesh.face_vertex_count = 20; // without the face at +x
    skein_handle crate = add_solid(world, s, NULL);
    assert_non_null(strstr(h.text, "4 open edges"));
    OK(world, skein_collider_probe(world, crate, 4, points[0], distance, normal[0]));
    for (int i = 0; i < 4; i++) assert_near(distance[i], i < 2 ? 0.1 : 0.05, 10 * EPSILON);
    assert_near(normal[0][0], 1, 10 * EPSILON);
    assert_near(normal[1][0], -1, 10 * EPSILON);
    skein_handle sheet = add_solid(world, make_sheet(1), NULL);
    double sides[][3] = {{0.1, 0.2, 0}, {0.1, -0.2, 0}, {0.1, 0, 0}};
    OK(world, skein_collider_probe(world, sheet, 3, sides[0], distance, normal[0]));
    for (int i = 0; i < 2; i++)
        assert_near(distance[i], 0.2, 10 * EPSILON), assert_near(normal[i][1], i ? -1 : 1, 10 * EPSILON);
    assert_near(distance[2], 0, 10 * EPSILON);
    assert_near(normal[2][1], 1, 10 * EPSILON);
    // the lower half of a ball, whose faces look down, holds what lies in it
    s = make_ball(0.5, 0, 8);
    const size_t faces = 64, corners = 48 + 3 * 64;
    memmove(s->size, s->size + faces, (s->mesh.face_count - faces) * sizeof *s->size);
    memmove(s->corner, s->corner + corners, (s->mesh.face_vertex_count - corners) * sizeof *s->corner);
    s->mesh.face_count -= faces, s->mesh.face_vertex_count -= corners;
    skein_handle dish = add_solid(world, s, NULL);
    OK(world, skein_collider_probe(world, dish, 2, (double[]){0, -0.4, 0, 0, -0.6, 0}, distance, normal[0]));
    for (int i = 0; i < 2; i++) assert_near(distance[i], 0.1, 0.003), assert_near(normal[i][1], i ? -1 : 1, 0.02);
    // faces that look inwards are turned; those that do not agree are told
    s = make_box(1, 1, 1);
    for (int f = 0; f < 6; f++) {
        uint32_t kept = s->corner[4 * f + 1];
        s->corner[4 * f + 1] = s->corner[4 * f + 3], s->corner[4 * f + 3] = kept;
    }
    h.text[0] = 0;
    skein_handle turned = add_solid(world, s, NULL);
    assert_string_equal(h.text, "");
    OK(world, skein_collider_probe(world, turned, 1, (double[]){0, 0.4, 0}, distance, NULL));
    assert_near(distance[0], -0.1, 10 * EPSILON);
    s = make_box(1, 1, 1);
    uint32_t kept = s->corner[1];
    s->corner[1] = s->corner[3], s->corner[3] = kept;
    add_solid(world, s, NULL);
    assert_non_null(strstr(h.text, "4 edges whose faces disagree"));
    skein_world_destroy(world);
}

static void what_is_refused(void **state) {
    (void)state;
    skein_world *world = skein_world_create(NULL, NULL);
    solid *s = make_box(1, 1, 1);
    FAILS(world, SKEIN_ERROR_MESH, "needs a mesh", skein_collider_add(world, "mesh", NULL, NULL));
    FAILS(world, SKEIN_ERROR_MESH, "without a mesh", skein_collider_add_mesh(world, "box", &s->mesh, NULL, NULL));
    s->corner[3] = 8;
    FAILS(world, SKEIN_ERROR_MESH, "names vertex 8", skein_collider_add_mesh(world, "mesh", &s->mesh, NULL, NULL));
    s->corner[3] = 1, s->position[2][1] = NAN;
    FAILS(world, SKEIN_ERROR_MESH, "vertex 2", skein_collider_add_mesh(world, "mesh", &s->mesh, NULL, NULL));
    memset(s->position, 0, sizeof s->position);
    FAILS(world, SKEIN_ERROR_MESH, "three corners", skein_collider_add_mesh(world, "mesh", &s->mesh, NULL, NULL));
    assert_int_equal(skein_object_count(world, SKEIN_COLLIDER), 0);
    free(s);
    skein_handle good = add_solid(world, make_box(1, 1, 1), NULL), box;
    double places[8][3] = {{0}};
    FAILS(world, SKEIN_ERROR_VALUE, "7 places", skein_collider_vertices_set(world, good, places[0], 7));
    places[5][1] = INFINITY;
    FAILS(world, SKEIN_ERROR_VALUE, "vertex 5", skein_collider_vertices_set(world, good, places[0], 8));
    FAILS(world, SKEIN_ERROR_VALUE, "shapes", skein_set(world, good, "mesh", skein_text("x.obj")));
    OK(world, skein_collider_add(world, "box", NULL, &box));
    FAILS(world, SKEIN_ERROR_VALUE, "no vertices", skein_collider_vertices_set(world, box, places[0], 8));
    skein_world_destroy(world);
}

/* ---- contact ---- */

static skein_world *with_floor(const char *method, solid *floor, double friction, double restitution, double tilt,
                               skein_handle *handle) {
    skein_world *world = new_world(method, 20);
    add_gravity(world);
    const skein_setting settings[] = {SKEIN_REAL("friction", friction), SKEIN_REAL("restitution", restitution),
                                      SKEIN_VEC3("rotation", 0, 0, tilt), SKEIN_END};
    *handle = add_solid(world, floor, settings);
    return world;
}

static void run(skein_world *world, int frames) {
    for (int f = 0; f < frames; f++) OK(world, skein_world_step(world, 1.0 / 60));
}

static void place_of(skein_world *world, double x[3]) {
    OK(world, skein_positions_copy(world, 0, 1, x));
}

/* What falls on a mesh of a box rests at its thickness; on a slope of 20 degrees it stays with a friction over tan 20 and goes with one under,
 * as fast as g (sin - mu cos) says; and it bounces as high as its restitution says. */
static void rest_slope_and_bounce(void **state) {
    (void)state;
    for (size_t i = 0; i < COUNT(all_methods); i++) {
        skein_handle floor;
        double x[3], speed[3];
        skein_world *world = with_floor(all_methods[i], make_box(20, 1, 20), 0.3, 0, 0, &floor);
        uint32_t p;
        OK(world, skein_particles_add(world, 1, (double[]){0.1, 0.6, 0.2}, NULL, (double[]){0.1}, &p));
        run(world, 60);
        place_of(world, x);
        assert_near(x[1], 0.502, 2e-5);
        skein_world_destroy(world);

        const double tilt = 20 * PI / 180, c = cos(tilt), s = sin(tilt);
        for (int slips = 0; slips < 2; slips++) {
            double friction = slips ? 0.2 : 0.5;
            world = with_floor(all_methods[i], make_box(40, 1, 40), friction, 0, -20, &floor);
            OK(world, skein_particles_add(world, 1, (double[]){0.5021 * s, 0.5021 * c, 0}, NULL, (double[]){0.1}, &p));
            run(world, 60);
            place_of(world, x);
            OK(world, skein_velocities_copy(world, 0, 1, speed));
            double along = x[0] * c - x[1] * s, v = speed[0] * c - speed[1] * s;
            assert_near(x[0] * s + x[1] * c, 0.502, 3e-5);
            if (!slips) assert_near(along, 0, 2e-3);
            else assert_share(v, 9.81 * (s - friction * c), 0.02);
            skein_world_destroy(world);
        }

        world = with_floor(all_methods[i], make_box(20, 1, 20), 0, 0.5, 0, &floor);
        OK(world, skein_particles_add(world, 1, (double[]){0.1, 1.502, 0.2}, NULL, (double[]){0.1}, &p));
        double highest = 0;
        for (int f = 0; f < 45 + 35; f++) {
            run(world, 1);
            place_of(world, x);
            if (f > 30) highest = fmax(highest, x[1]); // it arrives after 27
        }
        assert_near(highest, 0.502 + 0.25, 0.02);
        skein_world_destroy(world);
    }
}

/* What lies on a mesh that moves goes with it, and what lies on one that turns, too: 0.3 m from the axis at 1 rad/s. */
static void it_carries(void **state) {
    (void)state;
    for (size_t i = 0; i < COUNT(all_methods); i++) {
        skein_handle floor;
        double x[3];
        uint32_t p;
        skein_world *world = with_floor(all_methods[i], make_box(4, 1, 4), 0.8, 0, 0, &floor);
        OK(world, skein_particles_add(world, 1, (double[]){0.3, 0.502, 0}, NULL, (double[]){0.1}, &p));
        OK(world, skein_set(world, floor, "motion.spin", skein_number(1)));
        run(world, 60);
        place_of(world, x);
        assert_near(atan2(-x[2], x[0]), 1, 0.05);
        assert_near(hypot(x[0], x[2]), 0.3, 0.01);
        OK(world, skein_set(world, floor, "motion.spin", skein_number(0)));
        run(world, 30);
        double before = (place_of(world, x), x[0]);
        for (int f = 1; f <= 30; f++) {
            OK(world, skein_set(world, floor, "position", skein_vector(f / 60.0, 0.1 * f / 60.0, 0)));
            run(world, 1);
        }
        place_of(world, x);
        assert_near(x[0] - before, 0.5 - 1 / (2 * 0.8 * 9.81), 0.02); // until it goes along
        assert_near(x[1], 0.502 + 0.05, 2e-3);
        skein_world_destroy(world);
    }
}

/* A floor whose vertices a program lifts, and moves aside, takes along what lies on it. */
static void a_program_deforms_it(void **state) {
    (void)state;
    for (size_t i = 0; i < COUNT(all_methods); i++) {
        skein_handle floor;
        double x[3], v[3];
        uint32_t p;
        solid *s = make_sheet(4);
        skein_world *world = with_floor(all_methods[i], s, 0.5, 0, 0, &floor);
        s = make_sheet(4);
        OK(world, skein_particles_add(world, 1, (double[]){0.3, 0.002, 0.1}, NULL, (double[]){0.1}, &p));
        for (int f = 1; f <= 30; f++) {
            for (int k = 0; k < 4; k++) s->position[k][1] = 0.3 * f / 60.0;
            OK(world, skein_collider_vertices_set(world, floor, s->position[0], 4));
            run(world, 1);
        }
        place_of(world, x);
        OK(world, skein_velocities_copy(world, 0, 1, v));
        assert_near(x[1], 0.152, 1e-4);
        assert_near(v[1], 0.3, 0.02);
        free(s);
        skein_world_destroy(world);
    }
}

/* Its vertices slide under what lies on it: that comes along, as friction lets it. A band at 0.5 m/s. */
static void a_program_slides_it(void **state) {
    (void)state;
    for (size_t i = 0; i < COUNT(all_methods); i++)
        for (int closed = 0; closed < 2; closed++) {
            skein_handle floor;
            double x[3];
            uint32_t p;
            const double y = closed ? 0.5 : 0;
            skein_world *world =
                with_floor(all_methods[i], closed ? make_box(8, 1, 8) : make_sheet(8), 0.3, 0, 0, &floor);
            solid *s = closed ? make_box(8, 1, 8) : make_sheet(8);
            const int count = closed ? 8 : 4;
            double built[8];
            for (int k = 0; k < count; k++) built[k] = s->position[k][0];
            OK(world, skein_particles_add(world, 1, (double[]){0.3, y + 0.002, 0.1}, NULL, (double[]){0.1}, &p));
            for (int f = 1; f <= 60; f++) {
                for (int k = 0; k < count; k++) s->position[k][0] = built[k] + 0.5 * f / 60.0;
                OK(world, skein_collider_vertices_set(world, floor, s->position[0], (size_t)count));
                run(world, 1);
            }
            place_of(world, x);
            assert_near(x[0] - 0.3, 0.5 - 0.5 * 0.5 / (2 * 0.3 * 9.81), 0.01); // until it goes along
            assert_near(x[1], y + 0.002, 1e-4);
            free(s);
            skein_world_destroy(world);
        }
}

/* A ball with a hole in its top, through which particles fall into its inside: none is thrown. And a crate without a lid holds them. */
static void a_hole_throws_nobody(void **state) {
    (void)state;
    for (size_t i = 0; i < COUNT(all_methods); i++)
        for (int crate = 0; crate < 2; crate++) {
            skein_world *world = new_world(all_methods[i], !strcmp(all_methods[i], "backward_euler") ? 4 : 40);
            solid *s = crate ? make_box(1, 1, 1) : make_ball(0.5, 0, 8);
            if (crate) {
                memmove(s->corner + 4 * 3, s->corner + 4 * 4, 8 * sizeof *s->corner); // without the one at +y
                s->mesh.face_count = 5, s->mesh.face_vertex_count = 20;
            } else { // without the sixteen triangles at its top
                memmove(s->size, s->size + 16, (s->mesh.face_count - 16) * sizeof *s->size);
                memmove(s->corner, s->corner + 48, (s->mesh.face_vertex_count - 48) * sizeof *s->corner);
                s->mesh.face_count -= 16, s->mesh.face_vertex_count -= 48;
            }
            add_gravity(world);
            add_solid(world, s, NULL);
            for (int p = 0; p < 9; p++) add_particle(world, 0.1, 0.04 * (p % 3 - 1), 0.8, 0.04 * (p / 3 - 1.2));
            double most = 0; // of the energy of 1 kg, J
            for (int f = 0; f < 60; f++) {
                run(world, 1);
                for (uint32_t p = 0; p < 9; p++) {
                    const vec3 v = velocity_of(world, p);
                    most = fmax(most, 0.5 * (v.x * v.x + v.y * v.y + v.z * v.z) + 9.81 * position_of(world, p).y);
                }
            }
            // 1 m/s is half a joule, and that is how they come out; of an implicit solve with up to 2.5
            const double more = strcmp(all_methods[i], "backward_euler") ? 0.6 : 3.5;
            if (!(most < 9.81 * 0.8 + more))
                print_error("%s, %s: %g J/kg\n", all_methods[i], crate ? "a crate" : "a ball", most);
            assert_true(most < 9.81 * 0.8 + more);
            for (uint32_t p = 0; p < 9 && crate; p++) assert_near(position_of(world, p).y, -0.498, 0.001);
            skein_world_destroy(world);
        }
}

/* ---- speed ---- */

/* A plate of 1 mm, or a sheet, whose vertices a program leads at up to 100 m/s, against what hangs still in the air and across what
 * flies along it, takes it along on the side where it was. */
static void nothing_passes_what_is_led(void **state) {
    (void)state;
    static const double speeds[] = {1, 10, 100}, asides[] = {0, 30};
    for (size_t i = 0; i < COUNT(all_methods); i++)
        for (int n = 0; n < 3 * 2 * 2; n++) {
            const double speed = speeds[n % 3], aside = asides[n / 3 % 2];
            const bool sheet = n / 6;
            skein_world *world = new_world(all_methods[i], 5);
            skein_handle plate = add_solid(world, sheet ? make_sheet(60) : make_box(60, 0.001, 60),
                                           SKEIN_SETTINGS(SKEIN_REAL("thickness", 0.002)));
            solid *s = sheet ? make_sheet(60) : make_box(60, 0.001, 60);
            const int count = sheet ? 4 : 8;
            double built[8][2], x[3];
            uint32_t p;
            for (int k = 0; k < count; k++) built[k][0] = s->position[k][0], built[k][1] = s->position[k][1];
            OK(world, skein_particles_add(world, 1, (double[]){0.1, 0.5, 0.2}, NULL, (double[]){0.1}, &p));
            for (int f = 1; f <= 60; f++) {
                for (int k = 0; k < count; k++) {
                    s->position[k][0] = built[k][0] + aside * f / 60, s->position[k][1] = built[k][1] + speed * f / 60;
                }
                OK(world, skein_collider_vertices_set(world, plate, s->position[0], (size_t)count));
                run(world, 1);
                place_of(world, x);
                if (!(x[1] - speed * f / 60 >= -1e-5))
                    print_error("%s: it comes at %g m/s, %g aside%s\n", all_methods[i], speed, aside,
                                sheet ? ", a sheet" : "");
                assert_true(x[1] - speed * f / 60 >= -1e-5);
            }
            free(s);
            skein_world_destroy(world);
        }
}

/* What comes at up to 400 m/s, straight or aslant, at a plate of 1 mm, a sheet without any, standing or coming towards it, stays on its side. */
static void nothing_passes(void **state) {
    (void)state;
    static const double speeds[] = {2, 20, 200, 400}, thicknesses[] = {0, 0.0005, 0.002, 0.01}, aslant[] = {0, 30, -80};
    for (size_t i = 0; i < COUNT(all_methods); i++)
        for (int n = 0; n < 4 * 4 * 3 * 4; n++) {
            double speed = speeds[n % 4], thickness = thicknesses[n / 4 % 4], side = aslant[n / 16 % 3];
            bool sheet = n / 48 % 2, comes = n / 96 % 2;
            if (SPARING && n % 7) continue;
            if (sheet && thickness == 0) continue; // what lies on it is on neither side
            skein_world *world = new_world(all_methods[i], 5);
            const skein_setting settings[] = {SKEIN_REAL("thickness", thickness), SKEIN_VEC3("rotation", 0, 30, 0),
                                              SKEIN_VEC3("motion.velocity", 0, comes ? speed / 2 : 0, 0), SKEIN_END};
            add_gravity(world);
            skein_handle plate = add_solid(world, sheet ? make_sheet(60) : make_box(60, 0.001, 60), settings);
            uint32_t p;
            double x[3];
            OK(world, skein_particles_add(world, 1, (double[]){0.1, 0.5, 0.2}, (double[]){side, -speed, 0.3 * side},
                                          (double[]){0.1}, &p));
            for (int f = 0; f < 12; f++) {
                run(world, 1);
                skein_pose pose;
                place_of(world, x);
                OK(world, skein_collider_pose(world, plate, &pose));
                if (!(x[1] - pose.position[1] >= -1e-5))
                    print_error("%s at %g m/s, %g aslant, thickness %g%s%s\n", all_methods[i], speed, side, thickness,
                                sheet ? ", a sheet" : "", comes ? ", which comes" : "");
                assert_true(x[1] - pose.position[1] >= -1e-5);
            }
            skein_world_destroy(world);
        }
}

/* ---- bits ---- */

static uint64_t hash_with(const char *simd, int threads) {
    setenv("SKEIN_SIMD", simd, 1);
    skein_world_desc desc = skein_default_world_desc();
    desc.thread_count = threads;
    skein_world *world = skein_world_create(&desc, NULL);
    unsetenv("SKEIN_SIMD");
    if (!world) return 0;
    add_gravity(world);
    OK(world, skein_body_add(world, "cloth", NULL,
                             SKEIN_SETTINGS(SKEIN_PAIR("grid", 30, 30), SKEIN_PAIR("size", 2, 2),
                                            SKEIN_VEC3("position", 0, 1.1, 0)),
                             NULL));
    add_solid(world, make_ball(0.8, 0.2, 16), (skein_setting[]){SKEIN_REAL("motion.spin", 1), SKEIN_END});
    solid *s = make_ball(0.4, 0, 8);
    s->mesh.face_vertex_count -= 3, s->mesh.face_count--; // open: by winding numbers
    add_solid(world, s, (skein_setting[]){SKEIN_VEC3("position", 1, 0, 0), SKEIN_END});
    run(world, 40);
    uint64_t hash = skein_world_hash(world);
    skein_world_destroy(world);
    return hash;
}

static void the_same_bits(void **state) {
    (void)state;
    static const char *const sets[] = {"sse", "avx2", "avx512"};
    uint64_t first = hash_with("sse", 1);
    assert_true(first != 0);
    for (int i = 0; i < 3; i++)
        for (int threads = 1; threads <= 3; threads += 2) assert_true(hash_with(sets[i], threads) == first);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(a_box_is_a_box),
        cmocka_unit_test(the_nearest_of_all),
        cmocka_unit_test(what_is_open),
        cmocka_unit_test(what_is_refused),
        cmocka_unit_test(rest_slope_and_bounce),
        cmocka_unit_test(it_carries),
        cmocka_unit_test(a_program_deforms_it),
        cmocka_unit_test(a_program_slides_it),
        cmocka_unit_test(a_hole_throws_nobody),
        cmocka_unit_test(nothing_passes),
        cmocka_unit_test(nothing_passes_what_is_led),
        cmocka_unit_test(the_same_bits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
