/* Colliders made from meshes, as the triangles that are drawn: their own, wherever the collider or a program has put them. */
#include "framed.h"
#include "solids.h"

static scene scene_with(const char *kind, solid *s, const skein_setting *settings) {
    scene made = scene_under_cloth(3);
    OK(made.world, skein_collider_add_mesh(made.world, kind, &s->mesh, settings, &made.collider));
    free(s);
    return made;
}

/* The corners of the sheet that solids.h makes, wherever they are, each once; `ought` is 4 x 3. */
static void assert_corners(const render_surface *surface, const double *ought) {
    assert_non_null(surface);
    assert_int_equal(surface->vertex_count, 4);
    assert_int_equal(surface->triangle_count, 2);
    for (size_t c = 0; c < 4; c++) {
        double least = INFINITY;
        for (size_t v = 0; v < 4; v++) {
            const double *p = &surface->positions[3 * v], *q = &ought[3 * c];
            least = fmin(least, hypot(hypot(p[0] - q[0], p[1] - q[1]), p[2] - q[2]));
        }
        assert_under(least, 1e-6);
    }
}

/* A flat sheet has no inside, and no distance below 0. */
static void open_ones_are_drawn(void **state) {
    (void)state;
    scene s = scene_with("mesh", make_sheet(2), SKEIN_SETTINGS(SKEIN_VEC3("position", 0, 0.5, 0)));
    const render_surface *surface = look(&s);
    assert_corners(surface, (double[]){-1, 0.5, -1, 1, 0.5, -1, -1, 0.5, 1, 1, 0.5, 1});
    assert_false(surface->scenery);
    // what the camera makes room for has it in it
    render_bounds bounds = render_frame_bounds(render_world_frame_get(s.frame));
    assert_near(bounds.least[1], 0.5, 1e-6);
    end(&s);
}

/* Each face of a cube keeps its own normals, and its corners are the cube's to the last bit of a float; so also where it goes and turns. */
static void edges_are_sharp(void **state) {
    (void)state;
    scene s = scene_with("mesh", make_box(1, 1, 1),
                         SKEIN_SETTINGS(SKEIN_REAL("scale", 2), SKEIN_VEC3("position", 0, 1, 0),
                                        SKEIN_VEC3("rotation", 0, 90, 0), SKEIN_VEC3("motion.velocity", 0.5, 0, 0),
                                        SKEIN_REAL("motion.spin", 0.7)));
    uint64_t shape = 0;
    for (int step = 0; step < 3; step++) {
        const render_surface *surface = look(&s);
        assert_non_null(surface);
        assert_int_equal(surface->vertex_count, 24);
        assert_int_equal(surface->triangle_count, 12);
        if (step) assert_true(surface->shape == shape); // the card keeps what it has
        shape = surface->shape;
        assert_true(shape != 0);
        double distance[24];
        OK(s.world, skein_collider_probe(s.world, s.collider, 24, surface->positions, distance, NULL));
        for (size_t v = 0; v < 24; v++) {
            const double *p = &surface->positions[3 * v];
            assert_under(fabs(distance[v]), 1e-5);
            assert_near(hypot(hypot(p[0] - 0.05 * step, p[1] - 1), p[2]), sqrt(3), 1e-5);
            assert_int_equal(surface->weld[v], v);
        }
        // fronts are outside
        double volume = 0;
        for (size_t t = 0; t < 12; t++) {
            const uint32_t *c = &surface->triangles[3 * t];
            const double *a = &surface->positions[3 * c[0]], *b = &surface->positions[3 * c[1]],
                         *d = &surface->positions[3 * c[2]];
            volume += (a[0] * (b[1] * d[2] - b[2] * d[1]) + a[1] * (b[2] * d[0] - b[0] * d[2]) +
                       a[2] * (b[0] * d[1] - b[1] * d[0])) /
                      6;
        }
        assert_near(volume, 8, 1e-4);
        steps(s.world, 1, 0.1);
    }
    end(&s);
}

/* Where a program leads the vertices, as soon as the step is over; also where nobody can touch them. */
static void led_vertices_are_drawn(void **state) {
    (void)state;
    for (int enabled = 0; enabled < 2; enabled++) {
        scene s = scene_with("mesh", make_sheet(2), NULL);
        OK(s.world, skein_set(s.world, s.collider, "enabled", skein_number(enabled)));
        double at[12] = {-1, 0, -1, 1, 0, -1, -1, 0, 1, 1, 0, 1};
        assert_corners(look(&s), at);
        for (int step = 1; step < 4; step++) {
            double before[12];
            memcpy(before, at, sizeof at);
            at[1] = 0.2 * step, at[10] = -0.1 * step, at[9] = 1 + 0.1 * step;
            OK(s.world, skein_collider_vertices_set(s.world, s.collider, at, 4));
            assert_corners(look(&s), before);
            steps(s.world, 1, 0.02);
            assert_corners(look(&s), at);
        }
        end(&s);
    }
}

/* A ground that goes on far beyond what is on it is drawn as ground, all of it, and the camera makes no room for it. */
static void grounds_are_scenery(void **state) {
    (void)state;
    scene s = scene_with("mesh", make_sheet(200), NULL);
    const render_surface *surface = look(&s);
    assert_corners(surface, (double[]){-100, 0, -100, 100, 0, -100, -100, 0, 100, 100, 0, 100});
    assert_true(surface->scenery);
    assert_int_equal(surface->material.pattern, RENDER_CHECKER);
    for (size_t v = 0; v < 4; v++)
        for (size_t k = 0; k < 2; k++)
            assert_near((double)surface->uv[2 * v + k], surface->positions[3 * v + 2 * k], 1e-4);
    render_bounds bounds = render_frame_bounds(render_world_frame_get(s.frame));
    assert_true(bounds.least[1] > 2);
    end(&s);
}

/* Contact knows a field by what was sampled of its mesh: that is what is drawn. */
static void fields_are_drawn_as_contact_sees_them(void **state) {
    (void)state;
    scene s = scene_with("field", make_box(1, 1, 1), SKEIN_SETTINGS(SKEIN_REAL("cell", 0.1)));
    skein_triangles triangles = {.count = 1};
    double at[3];
    OK(s.world, skein_collider_triangles(s.world, s.collider, &triangles));
    assert_int_equal(triangles.count, 0);
    FAILS(s.world, SKEIN_ERROR_VALUE, "a field has no triangles",
          skein_collider_vertices_copy(s.world, s.collider, skein_doubles(at, 0)));
    const render_surface *surface = look(&s);
    assert_true(surface && surface->triangle_count > 1000);
    end(&s);
}

static void hidden_and_removed_ones_are_not_drawn(void **state) {
    (void)state;
    scene s = scene_with("mesh", make_sheet(2), NULL);
    assert_non_null(look(&s));
    OK(s.world, skein_set(s.world, s.collider, "visible", skein_number(0)));
    assert_null(look(&s));
    OK(s.world, skein_set(s.world, s.collider, "visible", skein_number(1)));
    assert_non_null(look(&s));
    OK(s.world, skein_remove(s.world, s.collider));
    assert_null(look(&s));
    end(&s);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(open_ones_are_drawn),
        cmocka_unit_test(edges_are_sharp),
        cmocka_unit_test(led_vertices_are_drawn),
        cmocka_unit_test(grounds_are_scenery),
        cmocka_unit_test(fields_are_drawn_as_contact_sees_them),
        cmocka_unit_test(hidden_and_removed_ones_are_not_drawn),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
