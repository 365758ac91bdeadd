/* A cape that begins partly inside the body that wears it: clean within a second, and so for 1,000 frames while the body runs, turns and
 * is put elsewhere, by brute force over all particles and the middles of all edges. */
#include "helpers.h"
#include "solids.h"

enum { ROWS = 36, COLUMNS = 25, FRAMES = 1000 };
static const double dt = 1.0 / 60, radius = 0.25, thickness = 0.006;

typedef struct stand {
    double place[3], yaw;
} stand;

/* It stands for a second, then runs to and fro at up to 5 m/s and turns, and jumps by 10 m every 200 frames. */
static stand stand_at(int frame) {
    double t = fmax(0, (frame - 60) * dt), ease = 1 - exp(-2 * t);
    return (stand){{4 * ease * sin(1.25 * t) + 10 * (frame / 200), 0, 2 * ease * sin(0.7 * t)}, 1.2 * ease * sin(2 * t)};
}

static void put(vec3 p, const stand *s, double out[3]) {
    out[0] = s->place[0] + cos(s->yaw) * p.x + sin(s->yaw) * p.z;
    out[1] = s->place[1] + p.y;
    out[2] = s->place[2] - sin(s->yaw) * p.x + cos(s->yaw) * p.z;
}

/* How far off the capsule a point is. */
static double gap_of(vec3 p, const stand *s) {
    double y = fmax(-0.6, fmin(0.6, p.y)), x = p.x - s->place[0], z = p.z - s->place[2];
    return sqrt(x * x + (p.y - y) * (p.y - y) + z * z) - radius;
}

/* The least gap of free particles and of edges' middles. */
static double least_gap(const skein_world *world, const stand *s) {
    double least = 1;
    for (uint32_t r = 0; r < ROWS; r++)
        for (uint32_t c = 0; c < COLUMNS; c++) {
            vec3 p = position_of(world, r * COLUMNS + c);
            least = fmin(least, gap_of(p, s));
            for (int k = 0; k < 3; k++) {
                uint32_t down = r + (k > 0), right = c + (k != 1);
                if (down >= ROWS || right >= COLUMNS) continue;
                vec3 q = position_of(world, down * COLUMNS + right);
                least = fmin(least, gap_of((vec3){(p.x + q.x) / 2, (p.y + q.y) / 2, (p.z + q.z) / 2}, s));
            }
        }
    return least;
}

/* The body and all that it wears are elsewhere, as they were. */
static void jump(skein_world *world, skein_handle body, const stand *from, const stand *to) {
    enum { COUNT_ = ROWS * COLUMNS };
    static double x[3 * COUNT_];
    OK(world, skein_positions_copy(world, 0, COUNT_, x));
    for (size_t i = 0; i < 3 * COUNT_; i++) x[i] += to->place[i % 3] - from->place[i % 3];
    OK(world, skein_positions_set(world, 0, COUNT_, x));
    OK(world, skein_set(world, body, "from", skein_vector(to->place[0], -0.6, to->place[2])));
    OK(world, skein_set(world, body, "to", skein_vector(to->place[0], 0.6, to->place[2])));
    OK(world, skein_collider_teleport(world, body));
}

static void a_cape_comes_clean_and_stays_so(void **state) {
    (void)state;
    static const char *const methods[] = {"xpbd", "pbd"};
    for (size_t m = 0; m < COUNT(methods); m++) {
        skein_world *world = new_world(methods[m], 20);
        skein_handle body;
        add_gravity(world);
        OK(world, skein_force_add(world, "drag", SKEIN_SETTINGS(SKEIN_REAL("rate", 0.5)), NULL));
        OK(world, skein_collider_add(world, "capsule",
                                     SKEIN_SETTINGS(SKEIN_VEC3("from", 0, -0.6, 0), SKEIN_VEC3("to", 0, 0.6, 0),
                                                    SKEIN_REAL("radius", radius), SKEIN_REAL("thickness", thickness)),
                                     &body));
        // upright, 0.12 m deep in the middle
        OK(world, skein_body_add(world, "cloth", NULL,
                                 SKEIN_SETTINGS(SKEIN_PAIR("grid", ROWS, COLUMNS), SKEIN_PAIR("size", 1.0, 0.8),
                                                SKEIN_VEC3("position", 0, 0, 0.13), SKEIN_VEC3("rotation", 90, 0, 0),
                                                SKEIN_TEXT("pins", "top corners"), SKEIN_REAL("density", 0.2)),
                                 NULL));
        assert_int_equal(skein_particle_count(world), ROWS * COLUMNS);
        uint32_t pins[2] = {0, COLUMNS - 1};
        vec3 at[2] = {position_of(world, pins[0]), position_of(world, pins[1])};
        stand s = stand_at(0);
        assert_true(least_gap(world, &s) < -0.1);
        double least = 1, fastest = 0;
        for (int f = 0; f < FRAMES; f++) {
            stand next = stand_at(f + 1);
            if (fabs(next.place[0] - s.place[0]) > 5) {
                stand there = next;
                jump(world, body, &s, &there);
            } else {
                OK(world, skein_set(world, body, "from", skein_vector(next.place[0], -0.6, next.place[2])));
                OK(world, skein_set(world, body, "to", skein_vector(next.place[0], 0.6, next.place[2])));
            }
            double places[6];
            for (int i = 0; i < 2; i++) put(at[i], &next, places + 3 * i);
            OK(world, skein_pins_move(world, pins, 2, places));
            steps(world, 1, dt);
            s = next;
            double gap = least_gap(world, &s);
            if (f >= 60) {
                if (!(gap > 0)) print_error("%s, frame %d: %g m inside\n", methods[m], f, -gap);
                assert_true(gap > 0);
                least = fmin(least, gap);
            }
            for (uint32_t p = 0; p < ROWS * COLUMNS; p++) fastest = fmax(fastest, length3(velocity_of(world, p)));
        }
        print_message("%s: least gap %.3g mm of %g, fastest %.3g m/s\n", methods[m], 1e3 * least, 1e3 * thickness,
                      fastest);
        assert_true(fastest < 40);
        skein_world_destroy(world);
    }
}

/* The keys of the same stands, so that a motion leads cape and body: with a turn to the other side and back besides, and jumps
 * of 10 m, each with half a turn. */
static char *write_keys(void) {
    enum { EACH = 4, LINE = 120 };
    char *text = calloc(FRAMES / EACH + 20, LINE), *at = text;
    for (int f = 0; f <= FRAMES + EACH; f += EACH) {
        stand s = stand_at(f);
        double side = 180 * (f / 200 % 2), yaw = s.yaw * 180 / PI + side + 150 * sin(f / 90.0) * (f > 60);
        bool jumps = f % 200 == 0 && f; // just after the key before it
        at += sprintf(at, "%s%.6f %.6f 0 %.6f 0 %.6f 0", f ? ", " : "", jumps ? (f - EACH) * dt + 1e-4 : f * dt,
                      s.place[0], s.place[2], yaw);
    }
    return text;
}

/* The same where one motion says all, whatever share of it the cape feels. */
static void a_motion_leads_both(void **state) {
    (void)state;
    static const double shares[] = {1, 0.5, 0};
    char *keys = write_keys();
    for (size_t i = 0; i < COUNT(shares); i++) {
        skein_world *world = new_world("xpbd", 20);
        skein_handle body;
        add_gravity(world);
        OK(world, skein_force_add(world, "drag", SKEIN_SETTINGS(SKEIN_REAL("rate", 0.5)), NULL));
        OK(world, skein_collider_add(world, "capsule",
                                     SKEIN_SETTINGS(SKEIN_TEXT("name", "wearer"), SKEIN_VEC3("from", 0, -0.6, 0),
                                                    SKEIN_VEC3("to", 0, 0.6, 0), SKEIN_REAL("radius", radius),
                                                    SKEIN_REAL("thickness", thickness)),
                                     &body));
        OK(world, skein_body_add(world, "cloth", NULL,
                                 SKEIN_SETTINGS(SKEIN_TEXT("name", "cape"), SKEIN_PAIR("grid", ROWS, COLUMNS),
                                                SKEIN_PAIR("size", 1.0, 0.8), SKEIN_VEC3("position", 0, 0, 0.13),
                                                SKEIN_VEC3("rotation", 90, 0, 0), SKEIN_TEXT("pins", "top corners"),
                                                SKEIN_REAL("density", 0.2)),
                                 NULL));
        OK(world, skein_motion_add(world, "keys", NULL,
                                   SKEIN_SETTINGS(SKEIN_TEXT("keys", keys), SKEIN_TEXT("on", "cape"),
                                                  SKEIN_TEXT("colliders", "wearer"), SKEIN_REAL("smooth", 0),
                                                  SKEIN_REAL("inertia", shares[i]), SKEIN_REAL("jump", 2)),
                                   NULL));
        double least = 1, fastest = 0, farthest = 0;
        for (int f = 0; f < FRAMES; f++) {
            skein_pose pose;
            steps(world, 1, dt);
            OK(world, skein_collider_pose(world, body, &pose));
            stand s = {{pose.position[0], pose.position[1], pose.position[2]}, 0};
            double gap = least_gap(world, &s);
            if (f < 60) continue;
            if (!(gap > 0)) print_error("inertia %g, frame %d: %g m inside\n", shares[i], f, -gap);
            assert_true(gap > 0);
            least = fmin(least, gap);
            for (uint32_t p = 0; p < ROWS * COLUMNS; p++) {
                fastest = fmax(fastest, length3(velocity_of(world, p)));
                farthest = fmax(farthest, length3(minus(position_of(world, p),
                                                        (vec3){pose.position[0], pose.position[1], pose.position[2]})));
            }
        }
        print_message("inertia %g: least gap %.3g mm of %g, fastest %.3g m/s, at most %.3g m away\n", shares[i],
                      1e3 * least, 1e3 * thickness, fastest, farthest);
        assert_true(fastest < 80);
        assert_true(farthest < 2); // nobody is left behind
        skein_world_destroy(world);
    }
    free(keys);
}

/* ---- on a mesh ---- */

/* The least distance of free particles and of edges' middles from the collider, as it stands. */
static double least_off(const skein_world *world, skein_handle body) {
    enum { POINTS = 3 * ROWS * COLUMNS };
    static double points[POINTS][3], off[POINTS];
    size_t count = 0;
    for (size_t i = 0; i < ROWS * COLUMNS; i++) {
        vec3 p = position_of(world, i);
        for (int k = 0; k < 3; k++) { // itself, and to the right, and below
            size_t j = k == 1 ? i + 1 : k == 2 ? i + COLUMNS : i;
            if (j >= ROWS * COLUMNS || (k == 1 && j % COLUMNS == 0)) continue;
            vec3 q = position_of(world, j);
            points[count][0] = (p.x + q.x) / 2, points[count][1] = (p.y + q.y) / 2,
            points[count++][2] = (p.z + q.z) / 2;
        }
    }
    OK(world, skein_collider_probe(world, body, count, points[0], off, NULL));
    double least = 1;
    for (size_t i = 0; i < count; i++) least = fmin(least, off[i]);
    return least;
}

/* A body of a mesh, taller than broad, broader than deep, and with bumps; or by distances that are sampled from it. */
static void a_mesh_wears_it(void **state) {
    (void)state;
    static const char *const kinds[] = {"mesh", "field"};
    char *keys = write_keys();
    for (size_t i = 0; i < COUNT(kinds); i++) {
        skein_world *world = new_world("xpbd", 20);
        skein_handle body;
        solid *s = make_ball(0.25, 0.015, 16);
        for (size_t v = 0; v < s->mesh.vertex_count; v++) s->position[v][0] *= 1.1, s->position[v][1] *= 3.4;
        add_gravity(world);
        OK(world, skein_force_add(world, "drag", SKEIN_SETTINGS(SKEIN_REAL("rate", 0.5)), NULL));
        OK(world, skein_collider_add_mesh(
                      world, kinds[i], &s->mesh,
                      SKEIN_SETTINGS(SKEIN_TEXT("name", "wearer"), SKEIN_REAL("thickness", thickness)), &body));
        free(s);
        OK(world, skein_body_add(world, "cloth", NULL,
                                 SKEIN_SETTINGS(SKEIN_TEXT("name", "cape"), SKEIN_PAIR("grid", ROWS, COLUMNS),
                                                SKEIN_PAIR("size", 1.0, 0.8), SKEIN_VEC3("position", 0, 0, 0.13),
                                                SKEIN_VEC3("rotation", 90, 0, 0), SKEIN_TEXT("pins", "top corners"),
                                                SKEIN_REAL("density", 0.2)),
                                 NULL));
        OK(world, skein_motion_add(world, "keys", NULL,
                                   SKEIN_SETTINGS(SKEIN_TEXT("keys", keys), SKEIN_TEXT("on", "cape"),
                                                  SKEIN_TEXT("colliders", "wearer"), SKEIN_REAL("smooth", 0),
                                                  SKEIN_REAL("inertia", 0.5), SKEIN_REAL("jump", 2)),
                                   NULL));
        double least = 1, deepest = least_off(world, body);
        assert_true(deepest < -0.1);
        for (int f = 0; f < FRAMES; f++) {
            steps(world, 1, dt);
            if (f < 60) continue;
            double off = least_off(world, body);
            if (!(off > 0)) print_error("%s, frame %d: %g m inside\n", kinds[i], f, -off);
            assert_true(off > 0);
            least = fmin(least, off);
        }
        print_message("%s: from %.3g m inside; least gap %.3g mm of %g\n", kinds[i], -deepest, 1e3 * least,
                      1e3 * thickness);
        assert_int_equal(statistics_of(world).nonfinite, 0);
        skein_world_destroy(world);
    }
    free(keys);
}

int main(void) {
    const struct CMUnitTest tests[] = {cmocka_unit_test(a_cape_comes_clean_and_stays_so),
                                       cmocka_unit_test(a_motion_leads_both), cmocka_unit_test(a_mesh_wears_it)};
    return cmocka_run_group_tests(tests, NULL, NULL);
}
