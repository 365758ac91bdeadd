/* Colliders by distances sampled from meshes: their error against the same solids by formulas and how it falls with the cells, what
 * rests, slides, bounces and is carried on them under every method, what is fast, what is refused, and the same bits for any width. */
#include "all_methods.h"
#include "helpers.h"
#include "solids.h"

static skein_handle add_field(skein_world *world, solid *s, const skein_setting *settings) {
    skein_handle handle;
    OK(world, skein_collider_add_mesh(world, "field", &s->mesh, settings, &handle));
    free(s); // it is copied
    return handle;
}

static double random_in(uint64_t *seed, double low, double high) {
    *seed = *seed * 6364136223846793005u + 1442695040888963407u;
    return low + (high - low) * (double)(*seed >> 40) / (double)(1 << 24);
}

/* ---- distances ---- */

typedef struct misfit {
    double distance, normal; /* root of the mean square, m; and the largest angle, rad */
    double worst;            /* m */
} misfit;

/* Of a field of a ball of radius 1, near its surface. */
static misfit misfit_of(double cell, int rings) {
    enum { POINTS = 2000 };
    skein_world *world = skein_world_create(NULL, NULL);
    static double points[POINTS][3], distance[POINTS], normal[POINTS][3];
    skein_handle field = add_field(world, make_ball(1, 0, rings), SKEIN_SETTINGS(SKEIN_REAL("cell", cell)));
    uint64_t seed = 7;
    double radius[POINTS];
    for (int i = 0; i < POINTS; i++) {
        double size = 0;
        for (int k = 0; k < 3; k++) points[i][k] = random_in(&seed, -1, 1), size += points[i][k] * points[i][k];
        radius[i] = random_in(&seed, 0.9, 1.1);
        for (int k = 0; k < 3; k++) points[i][k] *= radius[i] / sqrt(size);
    }
    OK(world, skein_collider_probe(world, field, POINTS, points[0], distance, normal[0]));
    misfit m = {0, 0, 0};
    for (int i = 0; i < POINTS; i++) {
        double off = distance[i] - (radius[i] - 1), along = 0;
        for (int k = 0; k < 3; k++) along += normal[i][k] * points[i][k] / radius[i];
        m.distance += off * off / POINTS;
        m.worst = fmax(m.worst, fabs(off));
        m.normal = fmax(m.normal, acos(fmin(1, along)));
    }
    m.distance = sqrt(m.distance);
    skein_world_destroy(world);
    return m;
}

/* A ball's distances are those of a sphere to a small part of a cell, and at least four times as near with cells half as large, as far as
 * the mesh is round: the diagonals of its faces, which are pi/120 wide, are so far within the sphere. */
static void a_ball_is_a_sphere(void **state) {
    (void)state;
    enum { RINGS = 120 };
    const double flat = 2 * (1 - cos(PI / (2 * RINGS)));
    misfit coarse = misfit_of(0.4, RINGS), middle = misfit_of(0.2, RINGS), fine = misfit_of(0.1, RINGS);
    print_message("ball: %.2e %.2e %.2e m off, at worst %.2e %.2e %.2e; normals %.2e %.2e %.2e rad\n", coarse.distance,
                  middle.distance, fine.distance, coarse.worst, middle.worst, fine.worst, coarse.normal, middle.normal,
                  fine.normal);
    assert_true(coarse.worst < 0.4 * 0.1 && middle.worst < 0.2 * 0.05 && fine.worst < 0.1 * 0.02);
    assert_true(middle.distance - flat < coarse.distance / 4);
    assert_true(fine.distance - flat < middle.distance / 4);
    assert_true(fine.normal < 0.05);
}

/* A field of a box is the box, moved, turned and scaled: but for rounding over its faces, by a part of a cell at its edges. */
static void a_box_is_a_box(void **state) {
    (void)state;
    enum { POINTS = 2000 };
    skein_world *world = skein_world_create(NULL, NULL);
    const double middle[3] = {1, 2, -1}, half[3] = {0.5, 0.3, 0.4}, cell = 0.05;
    skein_handle box,
        field = add_field(world, make_box(0.5, 0.3, 0.4),
                          SKEIN_SETTINGS(SKEIN_VEC3("position", 1, 2, -1), SKEIN_VEC3("rotation", 0, 90, 0),
                                         SKEIN_REAL("scale", 2), SKEIN_REAL("cell", cell)));
    OK(world, skein_collider_add(world, "box",
                                 SKEIN_SETTINGS(SKEIN_VEC3("centre", 1, 2, -1), SKEIN_VEC3("rotation", 0, 90, 0),
                                                SKEIN_VEC3("size", 1, 0.6, 0.8)),
                                 &box));
    static double points[POINTS][3], distance[2][POINTS], normal[2][POINTS][3];
    uint64_t seed = 1;
    for (int i = 0; i < POINTS; i++)
        for (int k = 0; k < 3; k++) points[i][k] = middle[k] + random_in(&seed, -1, 1);
    OK(world, skein_collider_probe(world, field, POINTS, points[0], distance[0], normal[0][0]));
    OK(world, skein_collider_probe(world, box, POINTS, points[0], distance[1], normal[1][0]));
    int over_faces = 0, inside = 0;
    for (int i = 0; i < POINTS; i++) {
        const double own[3] = {points[i][2] - middle[2], points[i][1] - middle[1], points[i][0] - middle[0]};
        int beyond = 0, axis = 0, beside = 0;
        for (int k = 0; k < 3; k++)
            if (fabs(own[k]) > half[k]) beyond++, axis = k;
        for (int k = 0; k < 3; k++) beside += k != axis && fabs(own[k]) > half[k] - 2 * cell;
        bool deep = distance[1][i] < 0;
        inside += deep;
        if (beyond == 1 && !beside && distance[1][i] < cell) {
            over_faces++;
            assert_near(distance[0][i], distance[1][i], 60 * EPSILON);
            double dot = 0;
            for (int k = 0; k < 3; k++) dot += normal[0][i][k] * normal[1][i][k];
            assert_true(dot > 1 - 1e-5);
        }
        // beyond the cubes, which end 2 cells from the box, the foot of one on them stands for the point's own
        double most = distance[1][i] < 2 * cell ? 0.5 * cell : 0.25 * distance[1][i];
        if (fabs(distance[0][i] - distance[1][i]) > most)
            print_error("%g for %g at %g %g %g\n", distance[0][i], distance[1][i], own[0], own[1], own[2]);
        assert_true(fabs(distance[0][i] - distance[1][i]) <= most);
    }
    assert_true(over_faces > 20 && inside > 100);
    skein_world_destroy(world);
}

/* ---- what is said ---- */

typedef struct heard {
    char text[400];
} heard;
static void hear(void *user, skein_log_level level, const char *message) {
    heard *h = user;
    if (level == SKEIN_LOG_WARNING) snprintf(h->text, sizeof h->text, "%s", message);
}

/* A box without its lid is solid inside, and says that it is open; what is thinner than its cells is told. */
static void what_is_open(void **state) {
    (void)state;
    heard h = {""};
    skein_world_desc desc = skein_default_world_desc();
    desc.log = hear, desc.log_user = &h;
    skein_world *world = skein_world_create(&desc, NULL);
    solid *s = make_box(1, 1, 1);
    s->mesh.face_count = 5, s->mesh.face_vertex_count = 20; // without the face at +x
    skein_handle open = add_field(world, s, NULL);
    assert_non_null(strstr(h.text, "4 open edges"));
    double points[][3] = {{-0.4, 0, 0}, {-0.6, 0, 0}, {0, 0, 0.45}, {0, -0.45, 0.1}}, distance[4];
    OK(world, skein_collider_probe(world, open, 4, points[0], distance, NULL));
    assert_near(distance[0], -0.1, 60 * EPSILON);
    assert_near(distance[1], 0.1, 60 * EPSILON);
    assert_near(distance[2], -0.05, 60 * EPSILON);
    assert_near(distance[3], -0.05, 60 * EPSILON);
    // a box with a mast: cells find the box, and no mast
    solid *mast = make_box(1, 1, 1);
    static const uint32_t quads[24] = {8,  10, 11, 9,  12, 13, 15, 14, 8, 9,  13, 12,
                                       10, 14, 15, 11, 8,  12, 14, 10, 9, 11, 15, 13};
    for (int v = 0; v < 8; v++)
        mast->position[8 + v][0] = v & 1 ? 0.01 : -0.01, mast->position[8 + v][1] = v & 2 ? 2 : 0.6,
                           mast->position[8 + v][2] = v & 4 ? 0.01 : -0.01;
    for (int f = 0; f < 6; f++) mast->size[6 + f] = 4;
    memcpy(mast->corner + 24, quads, sizeof quads);
    close_mesh(mast, 16, 12, 48);
    h.text[0] = 0;
    add_field(world, mast, SKEIN_SETTINGS(SKEIN_REAL("cell", 0.11)));
    assert_non_null(strstr(h.text, "8 of the mesh's 24 triangles"));
    skein_world_destroy(world);
}

static void what_is_refused(void **state) {
    (void)state;
    skein_world *world = skein_world_create(NULL, NULL);
    solid *s = make_box(1, 1, 1), *sheet = make_sheet(1);
    FAILS(world, SKEIN_ERROR_MESH, "needs a mesh", skein_collider_add(world, "field", NULL, NULL));
    FAILS(world, SKEIN_ERROR_MESH, "type mesh", skein_collider_add_mesh(world, "field", &sheet->mesh, NULL, NULL));
    FAILS(world, SKEIN_ERROR_MESH, "smaller cells",
          skein_collider_add_mesh(world, "field", &s->mesh, SKEIN_SETTINGS(SKEIN_REAL("cell", 100)), NULL));
    FAILS(world, SKEIN_ERROR_LIMIT, "distances for a mesh of 1 m",
          skein_collider_add_mesh(world, "field", &s->mesh, SKEIN_SETTINGS(SKEIN_REAL("cell", 1e-3)), NULL));
    assert_int_equal(skein_object_count(world, SKEIN_COLLIDER), 0);
    free(s);
    free(sheet);
    skein_handle good = add_field(world, make_box(1, 1, 1), NULL);
    double places[8][3] = {{0}};
    FAILS(world, SKEIN_ERROR_VALUE, "no vertices", skein_collider_vertices_set(world, good, places[0], 8));
    FAILS(world, SKEIN_ERROR_VALUE, "shapes", skein_set(world, good, "mesh", skein_text("x.obj")));
    FAILS(world, SKEIN_ERROR_VALUE, "cell", skein_set(world, good, "cell", skein_number(0.1)));
    skein_world_destroy(world);
}

/* ---- contact ---- */

static skein_world *with_floor(const char *method, double friction, double restitution, double tilt,
                               skein_handle *handle) {
    skein_world *world = new_world(method, 20);
    add_gravity(world);
    *handle = add_field(world, make_box(6, 1, 6),
                        SKEIN_SETTINGS(SKEIN_REAL("friction", friction), SKEIN_REAL("restitution", restitution),
                                       SKEIN_VEC3("rotation", 0, 0, tilt), SKEIN_REAL("cell", 0.125)));
    return world;
}

static void run(skein_world *world, int frames) {
    for (int f = 0; f < frames; f++) OK(world, skein_world_step(world, 1.0 / 60));
}

static void place_of(skein_world *world, double x[3]) {
    OK(world, skein_positions_copy(world, 0, 1, x));
}

/* As on a mesh: it rests at the thickness, stays on a slope of 20 degrees or slides down it as g (sin - mu cos) says, and
 * bounces as high as the restitution says. */
static void rest_slope_and_bounce(void **state) {
    (void)state;
    for (size_t i = 0; i < COUNT(all_methods); i++) {
        skein_handle floor;
        double x[3], speed[3];
        skein_world *world = with_floor(all_methods[i], 0.3, 0, 0, &floor);
        uint32_t p;
        OK(world, skein_particles_add(world, 1, (double[]){0.1, 0.6, 0.2}, NULL, (double[]){0.1}, &p));
        run(world, 60);
        place_of(world, x);
        assert_near(x[1], 0.502, 2e-5);
        skein_world_destroy(world);

        const double tilt = 20 * PI / 180, c = cos(tilt), s = sin(tilt);
        for (int slips = 0; slips < 2; slips++) {
            double friction = slips ? 0.2 : 0.5;
            world = with_floor(all_methods[i], friction, 0, -20, &floor);
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

        world = with_floor(all_methods[i], 0, 0.5, 0, &floor);
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

/* What lies on a field that turns at 1 rad/s goes round with it. */
static void it_carries(void **state) {
    (void)state;
    for (size_t i = 0; i < COUNT(all_methods); i++) {
        skein_handle floor;
        double x[3];
        uint32_t p;
        skein_world *world = with_floor(all_methods[i], 0.8, 0, 0, &floor);
        OK(world, skein_particles_add(world, 1, (double[]){0.3, 0.502, 0}, NULL, (double[]){0.1}, &p));
        OK(world, skein_set(world, floor, "motion.spin", skein_number(1)));
        run(world, 60);
        place_of(world, x);
        assert_near(atan2(-x[2], x[0]), 1, 0.05);
        assert_near(hypot(x[0], x[2]), 0.3, 0.01);
        skein_world_destroy(world);
    }
}

/* A cloth comes to rest on a ball: nowhere within it, and on its top at the thickness. */
static void a_cloth_rests_on_it(void **state) {
    (void)state;
    skein_world *world = new_world("xpbd", 10);
    enum { SIDE = 25 };
    add_gravity(world);
    OK(world, skein_force_add(world, "drag", SKEIN_SETTINGS(SKEIN_REAL("rate", 2)), NULL));
    add_field(world, make_ball(0.5, 0, 40),
              SKEIN_SETTINGS(SKEIN_REAL("thickness", 0.01), SKEIN_REAL("friction", 1), SKEIN_REAL("cell", 0.03)));
    OK(world, skein_body_add(world, "cloth", NULL,
                             SKEIN_SETTINGS(SKEIN_PAIR("grid", SIDE, SIDE), SKEIN_PAIR("size", 1, 1),
                                            SKEIN_VEC3("position", 0, 0.55, 0)),
                             NULL));
    run(world, 240);
    static double x[SIDE * SIDE][3], v[SIDE * SIDE][3];
    OK(world, skein_positions_copy(world, 0, SIDE * SIDE, x[0]));
    OK(world, skein_velocities_copy(world, 0, SIDE * SIDE, v[0]));
    double nearest = 10, fastest = 0, highest = -10;
    for (int i = 0; i < SIDE * SIDE; i++) {
        nearest = fmin(nearest, sqrt(x[i][0] * x[i][0] + x[i][1] * x[i][1] + x[i][2] * x[i][2]));
        fastest = fmax(fastest, sqrt(v[i][0] * v[i][0] + v[i][1] * v[i][1] + v[i][2] * v[i][2]));
        highest = fmax(highest, x[i][1]);
    }
    print_message("cloth: %g m from the middle, its top at %g, at most %g m/s\n", nearest, highest, fastest);
    assert_true(nearest > 0.51 - 0.0015);
    assert_near(highest, 0.51, 0.002);
    assert_true(fastest < 0.1);
    skein_world_destroy(world);
}

/* ---- speed ---- */

/* What comes at up to 400 m/s, straight or aslant, at a plate that is two cells thick, standing or coming towards it, stays on its side. */
static void nothing_passes(void **state) {
    (void)state;
    static const double speeds[] = {2, 20, 200, 400}, thicknesses[] = {0, 0.0005, 0.002, 0.01}, aslant[] = {0, 30, -80};
    for (size_t i = 0; i < COUNT(all_methods); i++)
        for (int n = 0; n < 4 * 4 * 3 * 2; n++) {
            double speed = speeds[n % 4], thickness = thicknesses[n / 4 % 4], side = aslant[n / 16 % 3];
            bool comes = n / 48 % 2;
            if (SPARING && n % 7) continue;
            skein_world *world = new_world(all_methods[i], 5);
            add_gravity(world);
            skein_handle plate = add_field(world, make_box(40, 1, 40),
                                           SKEIN_SETTINGS(SKEIN_REAL("thickness", thickness),
                                                          SKEIN_VEC3("rotation", 0, 30, 0), SKEIN_REAL("cell", 0.5),
                                                          SKEIN_VEC3("motion.velocity", 0, comes ? speed / 2 : 0, 0)));
            uint32_t p;
            double x[3];
            OK(world, skein_particles_add(world, 1, (double[]){0.1, 1, 0.2}, (double[]){side, -speed, 0.3 * side},
                                          (double[]){0.1}, &p));
            for (int f = 0; f < 12; f++) {
                run(world, 1);
                skein_pose pose;
                place_of(world, x);
                OK(world, skein_collider_pose(world, plate, &pose));
                if (!(x[1] - pose.position[1] >= 0.5 - 1e-4))
                    print_error("%s at %g m/s, %g aslant, thickness %g%s: %g\n", all_methods[i], speed, side, thickness,
                                comes ? ", which comes" : "", x[1] - pose.position[1]);
                assert_true(x[1] - pose.position[1] >= 0.5 - 1e-4);
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
    add_field(world, make_ball(0.8, 0.2, 16), SKEIN_SETTINGS(SKEIN_REAL("motion.spin", 1)));
    solid *s = make_ball(0.4, 0, 8);
    s->mesh.face_vertex_count -= 3, s->mesh.face_count--; // open: by winding numbers
    add_field(world, s, SKEIN_SETTINGS(SKEIN_VEC3("position", 1, 0, 0)));
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
        cmocka_unit_test(a_ball_is_a_sphere),  cmocka_unit_test(a_box_is_a_box),        cmocka_unit_test(what_is_open),
        cmocka_unit_test(what_is_refused),     cmocka_unit_test(rest_slope_and_bounce), cmocka_unit_test(it_carries),
        cmocka_unit_test(a_cloth_rests_on_it), cmocka_unit_test(nothing_passes),        cmocka_unit_test(the_same_bits),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
