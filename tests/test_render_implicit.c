/* Colliders that are formulas, as the triangles that are drawn: where they are, whether they are whole, when they are
 * made again. */
#include "framed.h"
#include "render/net.h"

/* ---- Nets ------------------------------------------------------------------------------------------- */

/* Two balls in a box of 40 x 30 x 20 cells. */
static double two_balls(const double p[3]) {
    double a = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]) - 0.7,
           b = sqrt((p[0] - 2) * (p[0] - 2) + p[1] * p[1] + p[2] * p[2]) - 0.5;
    return fmin(a, b);
}

static uint32_t count_edge(const render_net *net, uint32_t from, uint32_t to) {
    uint32_t count = 0;
    for (size_t t = 0; t < net->triangle_count; t++)
        for (size_t k = 0; k < 3; k++)
            count += net->triangles[3 * t + k] == from && net->triangles[3 * t + (k + 1) % 3] == to;
    return count;
}

static void nets_are_whole(void **state) {
    (void)state;
    enum { X = 40, Y = 20, Z = 20 };
    static float values[(X + 1) * (Y + 1) * (Z + 1)];
    render_net_grid grid = {{-1, -1, -1}, 0.1, {X, Y, Z}, values};
    for (size_t i = 0; i < COUNT(values); i++) {
        double p[3] = {-1 + 0.1 * (double)(i % (X + 1)), -1 + 0.1 * (double)(i / (X + 1) % (Y + 1)),
                       -1 + 0.1 * (double)(i / ((X + 1) * (Y + 1)))};
        values[i] = (float)two_balls(p);
    }
    render_net net = {0};
    assert_true(render_net_make(&net, &grid));
    for (size_t v = 0; v < net.vertex_count; v++) assert_under(two_balls(&net.positions[3 * v]), 0.01);
    // every edge has a triangle on either side, so V - E + F is 2 for each ball
    double volume = 0;
    for (size_t t = 0; t < net.triangle_count; t++) {
        const uint32_t *c = &net.triangles[3 * t];
        const double *p = &net.positions[3 * c[0]], *q = &net.positions[3 * c[1]], *r = &net.positions[3 * c[2]];
        for (size_t k = 0; k < 3; k++) assert_int_equal(count_edge(&net, c[(k + 1) % 3], c[k]), 1);
        volume += (p[0] * (q[1] * r[2] - q[2] * r[1]) + p[1] * (q[2] * r[0] - q[0] * r[2]) +
                   p[2] * (q[0] * r[1] - q[1] * r[0])) /
                  6;
    }
    assert_int_equal(net.vertex_count - net.triangle_count / 2, 4);
    assert_share(volume, 4 * PI / 3 * (0.343 + 0.125), 0.04); // fronts are outside
    // values that are none, and an empty box
    for (size_t i = 0; i < COUNT(values); i += 7) values[i] = NAN;
    for (size_t i = 1; i < COUNT(values); i += 11) values[i] = INFINITY;
    assert_true(render_net_make(&net, &grid));
    for (size_t v = 0; v < 3 * net.vertex_count; v++) assert_true(isfinite(net.positions[v]));
    for (size_t i = 0; i < COUNT(values); i++) values[i] = 1;
    assert_true(render_net_make(&net, &grid));
    assert_int_equal(net.triangle_count, 0);
    render_net_release(&net);
}

/* ---- In a picture ----------------------------------------------------------------------------------- */

static scene scene_with(const skein_setting *settings) {
    scene s = scene_under_cloth(1);
    OK(s.world, skein_collider_add(s.world, "formula", settings, &s.collider));
    return s;
}

/* A ball of any size is found, stands where its collider does, and follows it. */
static void balls_are_round(void **state) {
    (void)state;
    static const double radii[] = {0.04, 0.3, 4};
    for (size_t i = 0; i < COUNT(radii); i++) {
        scene s =
            scene_with(SKEIN_SETTINGS(SKEIN_TEXT("surface", "length(p) - R"), SKEIN_REAL("parameters.R", radii[i]),
                                      SKEIN_VEC3("centre", 0.3, 0.5, -0.2), SKEIN_VEC3("motion.velocity", 0.5, 0, 0)));
        for (int step = 0; step < 2; step++) {
            const render_surface *surface = look(&s);
            double x = 0.3 + 0.5 * skein_world_time(s.world);
            assert_non_null(surface);
            assert_false(surface->scenery);
            assert_true(surface->triangle_count > 1000);
            for (size_t v = 0; v < surface->vertex_count; v++) {
                const double *p = &surface->positions[3 * v];
                double r = sqrt((p[0] - x) * (p[0] - x) + (p[1] - 0.5) * (p[1] - 0.5) + (p[2] + 0.2) * (p[2] + 0.2));
                assert_share(r, radii[i], 2e-3);
            }
            steps(s.world, 1, 0.1);
        }
        end(&s);
    }
}

static void terrain_is_scenery(void **state) {
    (void)state;
    scene s =
        scene_with(SKEIN_SETTINGS(SKEIN_TEXT("surface", "p.y - a*sin(3*p.x - t)"), SKEIN_REAL("parameters.a", 0.1)));
    const render_surface *surface = look(&s);
    assert_non_null(surface);
    assert_true(surface->scenery);
    // under the cloth and beyond, and the camera does not make room for it
    double least = 0, most = 0;
    for (size_t v = 0; v < surface->vertex_count; v++) {
        const double *p = &surface->positions[3 * v];
        least = fmin(least, p[0]), most = fmax(most, p[0]);
        assert_near(p[1], 0.1 * sin(3 * p[0]), 1e-3);
    }
    assert_true(least < -1 && most > 1);
    render_bounds bounds = render_frame_bounds(render_world_frame_get(s.frame));
    assert_true(bounds.least[1] > 0.5);
    // it moves on
    steps(s.world, 1, 0.5);
    surface = look(&s);
    for (size_t v = 0; v < surface->vertex_count; v++)
        assert_near(surface->positions[3 * v + 1], 0.1 * sin(3 * surface->positions[3 * v] - 0.5), 1e-3);
    // and up, out of the box that it was found in
    OK(s.world, skein_set(s.world, s.collider, "surface", skein_text("p.y - a*sin(3*p.x - t) - 0.4")));
    surface = look(&s);
    assert_true(surface && surface->triangle_count > 1000);
    for (size_t v = 0; v < surface->vertex_count; v++)
        assert_near(surface->positions[3 * v + 1], 0.4 + 0.1 * sin(3 * surface->positions[3 * v] - 0.5), 1e-3);
    end(&s);
}

static void hidden_and_removed_ones_are_not_drawn(void **state) {
    (void)state;
    scene s = scene_with(SKEIN_SETTINGS(SKEIN_TEXT("surface", "length(p) - 0.3")));
    assert_non_null(look(&s));
    OK(s.world, skein_set(s.world, s.collider, "visible", skein_number(0)));
    assert_null(look(&s));
    OK(s.world, skein_set(s.world, s.collider, "visible", skein_number(1)));
    OK(s.world, skein_set(s.world, s.collider, "surface", skein_text("length(p) + 1"))); // there is none
    assert_null(look(&s));
    OK(s.world, skein_set(s.world, s.collider, "surface", skein_text("length(p) - 0.2")));
    assert_non_null(look(&s));
    OK(s.world, skein_remove(s.world, s.collider));
    assert_null(look(&s));
    end(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(nets_are_whole),
        cmocka_unit_test(balls_are_round),
        cmocka_unit_test(terrain_is_scenery),
        cmocka_unit_test(hidden_and_removed_ones_are_not_drawn),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
