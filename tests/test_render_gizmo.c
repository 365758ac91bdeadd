/* Handles without a window: what a pointer does with an arrow, a ring or a box in the picture, and what becomes of an
 * object's fields, whatever kind it is of. What is shown while one drags is what is built afterwards. */
#include "helpers.h"

#include "viewer/spot.h"

static const viewer_tool tools[] = {VIEWER_MOVES, VIEWER_TURNS, VIEWER_SIZES};

static viewer_sight sight_from(double x, double y, double z) {
    return (viewer_sight){{{x, y, z}, {0.2, 0.1, -0.1}, {0, 1, 0}, 40, 0.01}, 0, 640, 480};
}

static viewer_gizmo gizmo_at(viewer_tool tool, double x, double y, double z) {
    viewer_gizmo gizmo = {
        tool,          {x, y, z}, {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, {true, true, true, true, true, true, true},
        GIZMO_NOTHING, 1};
    if (tool != VIEWER_MOVES) gizmo.has[3] = gizmo.has[4] = gizmo.has[5] = false;
    if (tool == VIEWER_TURNS) gizmo.has[GIZMO_ALL] = false;
    return gizmo;
}

/* A ray through where a place is seen meets that place. */
static void rays_go_through_what_is_seen(void **state) {
    (void)state;
    uint64_t seed = 3;
    viewer_sight sight = sight_from(3, 2, 4);
    sight.left = 100;
    for (int i = 0; i < 200; i++) {
        double place[3], at[2], ray[3], off[3], along = 0, across = 0;
        for (int k = 0; k < 3; k++) place[k] = random_between(&seed, -1, 1);
        assert_true(viewer_sight_project(&sight, place, at));
        viewer_sight_ray(&sight, at[0], at[1], ray);
        for (int k = 0; k < 3; k++) off[k] = place[k] - sight.lens.eye[k], along += off[k] * ray[k];
        for (int k = 0; k < 3; k++) across += (off[k] - along * ray[k]) * (off[k] - along * ray[k]);
        assert_true(along > 0 && sqrt(across) < 1e-12);
    }
    assert_false(viewer_sight_project(&sight, (double[3]){6, 4, 8}, (double[2]){0})); // behind the eye
}

/* Each part is met where it is said to be, and nothing far from all of them. */
static void parts_are_picked(void **state) {
    (void)state;
    static const double eyes[][3] = {{3, 2, 4}, {-2, 3, -3}, {0.5, -1, 4}};
    for (size_t e = 0; e < COUNT(eyes); e++)
        for (size_t t = 0; t < COUNT(tools); t++) {
            viewer_sight sight = sight_from(eyes[e][0], eyes[e][1], eyes[e][2]);
            viewer_gizmo gizmo = gizmo_at(tools[t], 0.1, 0.2, 0);
            size_t found = 0;
            for (int part = 0; part < GIZMO_PARTS; part++) {
                double at[2];
                if (!viewer_gizmo_place(&gizmo, &sight, part, at)) continue;
                assert_int_equal(viewer_gizmo_pick(&gizmo, &sight, at[0], at[1]), part);
                assert_true(at[0] > 0 && at[0] < 640 && at[1] > 0 && at[1] < 480);
                found++;
            }
            assert_true(found >= (tools[t] == VIEWER_MOVES ? 6 : 3));
            assert_int_equal(viewer_gizmo_pick(&gizmo, &sight, 5, 5), GIZMO_NOTHING);
            assert_int_equal(viewer_gizmo_pick(&gizmo, &sight, 635, 470), GIZMO_NOTHING);
        }
}

/* Pulled to where the moved origin is seen, an arrow, a square or the middle has moved it there. */
static void moves_follow_the_pointer(void **state) {
    (void)state;
    viewer_sight sight = sight_from(3, 2, 4);
    viewer_gizmo gizmo = gizmo_at(VIEWER_MOVES, 0.3, 0.1, -0.2);
    for (int part = 0; part < GIZMO_ALL; part++) {
        double goal[3], from[2], to[2], by[3], way[3] = {0.4, -0.25, 0.3};
        for (int k = 0; k < 3; k++) {
            bool free = part < GIZMO_PLANE ? part == k : part - GIZMO_PLANE != k;
            if (!free) way[k] = 0;
            goal[k] = gizmo.origin[k] + way[k];
        }
        assert_true(viewer_sight_project(&sight, gizmo.origin, from) && viewer_sight_project(&sight, goal, to));
        assert_true(viewer_gizmo_follow(&gizmo, &sight, part, from, to, by));
        for (int k = 0; k < 3; k++) assert_near(by[k], way[k], 1e-9);
    }
    // the middle goes along the picture, at its depth
    double by[3], off = 0, right[3], up[3], back[3];
    render_camera_axes(&sight.lens, right, up, back);
    assert_true(viewer_gizmo_follow(&gizmo, &sight, GIZMO_ALL, (double[2]){300, 200}, (double[2]){350, 170}, by));
    for (int k = 0; k < 3; k++) off += by[k] * back[k];
    assert_near(off, 0, 1e-12);
    // an arrow that is looked at from its end leads nowhere
    viewer_sight end = sight_from(0.3 + 5, 0.1, -0.2);
    end.lens.target[0] = 0.3, end.lens.target[1] = 0.1, end.lens.target[2] = -0.2;
    assert_false(viewer_gizmo_follow(&gizmo, &end, 0, (double[2]){320, 240}, (double[2]){330, 240}, by));
}

/* Round a ring by 50 degrees, on its plane as on its edge. */
static void turns_follow_the_pointer(void **state) {
    (void)state;
    const double angle = 50;
    for (int part = 0; part < 3; part++) {
        viewer_sight sight = sight_from(3, 2.5, 3.5);
        viewer_gizmo gizmo = gizmo_at(VIEWER_TURNS, 0, 0.1, 0);
        double p[3], q[3], from[2], to[2], by[3];
        const double *u = gizmo.axes[(part + 1) % 3], *v = gizmo.axes[(part + 2) % 3];
        for (int k = 0; k < 3; k++) {
            p[k] = gizmo.origin[k] + 0.5 * (cos(0.3) * u[k] + sin(0.3) * v[k]);
            q[k] = gizmo.origin[k] + 0.5 * (cos(0.3 + angle * PI / 180) * u[k] + sin(0.3 + angle * PI / 180) * v[k]);
        }
        assert_true(viewer_sight_project(&sight, p, from) && viewer_sight_project(&sight, q, to));
        assert_true(viewer_gizmo_follow(&gizmo, &sight, part, from, to, by));
        assert_near(by[0], angle, 1e-7);
        // and what it holds goes there, not the other way round
        viewer_spot spot = {.factor = 1};
        viewer_spot_carry(&spot, &gizmo, part, by, p);
        for (int k = 0; k < 3; k++) assert_near(p[k], q[k], 1e-9);
    }
    // seen from its edge: the front goes with the pointer, an arm's length is a radian
    viewer_sight edge = {{{0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 40, 0.01}, 0, 640, 480};
    viewer_gizmo gizmo = gizmo_at(VIEWER_TURNS, 0, 0, 0);
    double by[3];
    assert_true(viewer_gizmo_follow(&gizmo, &edge, 1, (double[2]){320, 240}, (double[2]){320 + 92, 240}, by));
    assert_near(by[0], 180 / PI, 1e-6);
    assert_true(viewer_gizmo_follow(&gizmo, &edge, 0, (double[2]){320, 240}, (double[2]){320, 240 + 46}, by));
    assert_near(by[0], 90 / PI, 1e-6);
}

/* Twice as far out is twice as large. */
static void sizes_follow_the_pointer(void **state) {
    (void)state;
    viewer_sight sight = sight_from(3, 2, 4);
    viewer_gizmo gizmo = gizmo_at(VIEWER_SIZES, 0.1, 0.2, 0);
    for (int part = 0; part < 3; part++) {
        double p[3], q[3], from[2], to[2], by[3];
        for (int k = 0; k < 3; k++) p[k] = q[k] = gizmo.origin[k];
        p[part] += 0.4, q[part] += 0.8;
        assert_true(viewer_sight_project(&sight, p, from) && viewer_sight_project(&sight, q, to));
        assert_true(viewer_gizmo_follow(&gizmo, &sight, part, from, to, by));
        for (int k = 0; k < 3; k++) assert_near(by[k], k == part ? 2 : 1, 1e-9);
        assert_true(viewer_gizmo_follow(&gizmo, &sight, part, from,
                                        (double[2]){2 * from[0] - to[0] * 1, from[1] * 2 - to[1]}, by));
        assert_true(by[part] > 0); // never inside out
    }
}

/* ---- every kind ------------------------------------------------------------------------------------ */

/* A world with one object of a kind: of a mesh where it needs one, and away from where it is by default. */
static skein_world *world_with(skein_category category, const skein_kind *kind, const viewer_spot_change *changes,
                               size_t count) {
    static const double mesh_places[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    static const uint32_t corners[] = {0, 1, 2, 3}, sizes[] = {4};
    static const uint32_t faces[] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3}, threes[] = {3, 3, 3, 3};
    const skein_mesh solid = {mesh_places, 4, sizes, 1, corners, 4}, closed = {mesh_places, 4, threes, 4, faces, 12},
                     *mesh = NULL;
    skein_world *world = new_world("xpbd", 1);
    skein_setting settings[16] = {{0}};
    size_t n = 0;
    static const struct {
        const char *name;
        double v[3];
    } start[] = {{"position", {0.3, 0.2, -0.1}}, {"centre", {0.3, 0.2, -0.1}}, {"rotation", {20, -35, 50}},
                 {"from", {-0.4, 0.3, 0.2}},     {"to", {0.5, 0.1, -0.3}},     {"normal", {0.2, 0.9, 0.1}}};
    for (size_t s = 0; s < COUNT(start); s++)
        if (skein_field_find(kind, start[s].name, NULL))
            settings[n++] = (skein_setting){start[s].name, skein_vector(start[s].v[0], start[s].v[1], start[s].v[2])};
    const skein_field *grid = skein_field_find(kind, "grid", NULL), *flock = skein_field_find(kind, "spread", NULL);
    if (grid && grid->type == SKEIN_FIELD_INT2) settings[n++] = (skein_setting){"grid", {2, {3, 4, 0}, NULL}};
    if (grid && grid->type == SKEIN_FIELD_INT3) settings[n++] = (skein_setting){"grid", {3, {3, 4, 2}, NULL}};
    if (flock) settings[n++] = (skein_setting){"count", skein_number(20)};
    if (!grid && skein_field_find(kind, "mesh", NULL)) mesh = category == SKEIN_COLLIDER ? &closed : &solid;
    for (size_t c = 0; c < count; c++) settings[n++] = (skein_setting){changes[c].field->name, changes[c].value};
    skein_status status = SKEIN_ERROR_VALUE;
    skein_handle handle;
    if (category == SKEIN_BODY) status = skein_body_add(world, kind->name, mesh, settings, &handle);
    else if (category == SKEIN_COLLIDER && mesh)
        status = skein_collider_add_mesh(world, kind->name, mesh, settings, &handle);
    else if (category == SKEIN_COLLIDER) status = skein_collider_add(world, kind->name, settings, &handle);
    else status = skein_force_add(world, kind->name, settings, &handle);
    if (status) fail_msg("%s: %s", kind->name, skein_world_error(world)->message);
    return world;
}

/* What is tried with a kind: each axis has its own size, too. */
static const struct {
    viewer_tool tool;
    int part; /* where there is none, all of it */
    double by[3];
} tries[] = {
    {VIEWER_MOVES, GIZMO_ALL, {0.25, -0.5, 0.75}},
    {VIEWER_TURNS, 2, {40, 0, 0}},
    {VIEWER_TURNS, 0, {-25, 0, 0}},
    {VIEWER_SIZES, GIZMO_ALL, {1.5, 1.5, 1.5}},
    {VIEWER_SIZES, 0, {1.5, 1, 1}},
    {VIEWER_SIZES, 1, {1, 0.5, 1}},
    {VIEWER_SIZES, 2, {1, 1, 2}},
};

/* Where a body's particles are after its fields were changed is where they were carried to. */
static void check_kind(skein_category category, const skein_kind *kind, size_t *tried) {
    skein_world *world = world_with(category, kind, NULL, 0);
    viewer_spot spot;
    bool named = skein_field_find(kind, "position", NULL) || skein_field_find(kind, "centre", NULL) ||
                 skein_field_find(kind, "from", NULL) || skein_field_find(kind, "normal", NULL);
    assert_true(viewer_spot_find(&spot, world, category, 0) == named);
    for (size_t t = 0; named && t < COUNT(tries); t++) {
        viewer_gizmo gizmo;
        viewer_spot_change changes[2];
        if (!viewer_spot_can(&spot, tries[t].tool)) continue;
        viewer_spot_gizmo(&spot, tries[t].tool, (double[3]){0, 0, 0}, &gizmo);
        int part =
            tries[t].part == GIZMO_ALL && !gizmo.has[GIZMO_ALL] ? 1 : tries[t].part; // a plane goes along its normal
        const double *by = tries[t].by;
        if (!gizmo.has[part]) continue;
        size_t count = viewer_spot_apply(&spot, &gizmo, part, by, 1e-9, changes);
        assert_true(count >= 1 && count <= 2);
        skein_world *after = world_with(category, kind, changes, count);
        viewer_spot now;
        assert_true(viewer_spot_find(&now, after, category, 0));
        double was[3], is[3];
        viewer_spot_middle(&spot, (double[3]){0, 0, 0}, was);
        viewer_spot_middle(&now, was, is);
        viewer_spot_carry(&spot, &gizmo, part, by, was);
        if (now.normal) viewer_spot_middle(&now, was, is); // any place of a plane is its middle
        for (int k = 0; k < 3; k++) assert_near(is[k], was[k], 1e-6);
        (*tried)++;
        for (size_t i = 0; i < skein_particle_count(world) && category == SKEIN_BODY; i++) {
            double x[3], y[3];
            OK(world, skein_positions_copy(world, i, 1, x));
            OK(after, skein_positions_copy(after, i, 1, y));
            viewer_spot_carry(&spot, &gizmo, part, by, x);
            // rotations are rounded to a hundredth of a degree
            for (int k = 0; k < 3; k++)
                if (fabs(x[k] - y[k]) > (tries[t].tool == VIEWER_TURNS ? 5e-4 : 3e-6))
                    fail_msg("%s, try %zu: particle %zu is at %g, not at %g", kind->name, t, i, y[k], x[k]);
        }
        skein_world_destroy(after);
    }
    skein_world_destroy(world);
}

static void any_kind_is_moved_by_its_fields(void **state) {
    (void)state;
    static const skein_category categories[] = {SKEIN_BODY, SKEIN_COLLIDER, SKEIN_FORCE};
    size_t tried = 0;
    for (size_t c = 0; c < COUNT(categories); c++)
        for (size_t k = 0; skein_kind_at(categories[c], k); k++)
            check_kind(categories[c], skein_kind_at(categories[c], k), &tried);
    assert_true(tried >= 40);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(rays_go_through_what_is_seen), cmocka_unit_test(parts_are_picked),
        cmocka_unit_test(moves_follow_the_pointer),     cmocka_unit_test(turns_follow_the_pointer),
        cmocka_unit_test(sizes_follow_the_pointer),     cmocka_unit_test(any_kind_is_moved_by_its_fields),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
