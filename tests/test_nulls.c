/* Every public function with NULL for each pointer that must not be NULL: a status and a word, or nothing; no crash.
 * The last test reads the headers: a function that is declared there and not called here is a failure. */
#include <ctype.h>

#include <skein/attach.h>
#include <skein/compiled.h>
#include <skein/cut.h>
#include <skein/formula.h>
#include <skein/gradient.h>
#include <skein/kinds.h>
#include <skein/record.h>
#include <skein/share.h>

#include "helpers.h"

typedef struct scene {
    skein_world *world;
    skein_handle cloth, ball, field, rod;
} scene;

static scene make_scene(void) {
    scene s = {.world = new_world("xpbd", 2)};
    OK(s.world, skein_body_add(s.world, "cloth", NULL, SKEIN_SETTINGS(SKEIN_PAIR("grid", 3, 3)), &s.cloth));
    OK(s.world, skein_collider_add(s.world, "sphere", NULL, &s.ball));
    OK(s.world, skein_force_add(s.world, "force_field", SKEIN_SETTINGS(SKEIN_TEXT("force", "p")), &s.field));
    OK(s.world, skein_constraint_add(s.world, "distance", (const uint32_t[]){0, 1}, 1, NULL, &s.rod));
    return s;
}

/* The call returns SKEIN_ERROR_VALUE, and the world's error names the argument. */
#define REFUSES(argument_, call_)                                          \
    do {                                                                   \
        FAILS(s.world, SKEIN_ERROR_VALUE, argument_ " is NULL", call_);    \
        assert_string_equal(skein_world_error(s.world)->where, argument_); \
    } while (0)
/* The same where there is no world to say it, or where the words are in an error of the caller's. */
#define REFUSES_ALL(call_) assert_int_equal((call_), SKEIN_ERROR_VALUE)
#define SAYS(argument_, call_)                             \
    do {                                                   \
        error = (skein_error){0};                          \
        assert_int_equal((call_), SKEIN_ERROR_VALUE);      \
        assert_int_equal(error.status, SKEIN_ERROR_VALUE); \
        assert_string_equal(error.where, argument_);       \
    } while (0)

static double xyz[27];
static uint32_t index_of, pair[2] = {0, 1};
static size_t count;
static skein_value value;

static void building(void **state) {
    (void)state;
    scene s = make_scene();
    skein_error error = {0};
    static const double masses[1] = {1};
    REFUSES("positions", skein_particles_add(s.world, 1, NULL, NULL, masses, NULL));
    REFUSES("masses", skein_particles_add(s.world, 1, xyz, NULL, NULL, NULL));
    REFUSES("kind", skein_body_add(s.world, NULL, NULL, NULL, NULL));
    REFUSES("kind", skein_constraint_add(s.world, NULL, pair, 1, NULL, NULL));
    REFUSES("particles", skein_constraint_add(s.world, "distance", NULL, 1, NULL, NULL));
    REFUSES("kind", skein_constraint_arity(s.world, NULL, NULL, &count));
    REFUSES("arity", skein_constraint_arity(s.world, "distance", NULL, NULL));
    REFUSES("kind", skein_force_add(s.world, NULL, NULL, NULL));
    REFUSES("kind", skein_collider_add(s.world, NULL, NULL, NULL));
    REFUSES("kind", skein_collider_add_mesh(s.world, NULL, NULL, NULL, NULL));
    REFUSES("kind", skein_method_set(s.world, NULL, NULL));
    const uint32_t sizes[1] = {3}, corners[3] = {0, 1, 2};
    skein_mesh mesh = {NULL, 3, sizes, 1, corners, 3};
    REFUSES("mesh->positions", skein_body_add(s.world, "cloth", &mesh, NULL, NULL));
    mesh.positions = xyz, mesh.face_sizes = NULL;
    REFUSES("mesh->face_sizes", skein_body_add(s.world, "cloth", &mesh, NULL, NULL));
    mesh.face_sizes = sizes, mesh.face_vertices = NULL;
    REFUSES("mesh->face_vertices", skein_body_add(s.world, "tetrahedra", &mesh, NULL, NULL));
    SAYS("mesh->face_vertices", skein_mesh_normals(&mesh, SKEIN_NORMALS_AREA, xyz, &error));
    SAYS("mesh", skein_mesh_normals(NULL, SKEIN_NORMALS_AREA, xyz, &error));
    mesh.face_vertices = corners;
    SAYS("out", skein_mesh_normals(&mesh, SKEIN_NORMALS_AREA, NULL, &error));
    assert_int_equal(skein_mesh_normals(&mesh, SKEIN_NORMALS_AREA, xyz, NULL), SKEIN_OK);
    // what is said to be allowed
    OK(s.world, skein_particles_add(s.world, 0, NULL, NULL, NULL, NULL));
    OK(s.world, skein_constraint_add(s.world, "distance", NULL, 0, NULL, NULL));
    skein_world_destroy(NULL);
    // no world
    REFUSES_ALL(skein_particles_add(NULL, 1, xyz, NULL, masses, NULL));
    REFUSES_ALL(skein_body_add(NULL, "cloth", NULL, NULL, NULL));
    REFUSES_ALL(skein_constraint_add(NULL, "distance", pair, 1, NULL, NULL));
    REFUSES_ALL(skein_constraint_arity(NULL, "distance", NULL, &count));
    REFUSES_ALL(skein_force_add(NULL, "gravity", NULL, NULL));
    REFUSES_ALL(skein_collider_add(NULL, "sphere", NULL, NULL));
    REFUSES_ALL(skein_collider_add_mesh(NULL, "sphere", NULL, NULL, NULL));
    REFUSES_ALL(skein_motion_add(NULL, "translate", NULL, NULL, NULL));
    REFUSES_ALL(skein_method_set(NULL, "xpbd", NULL));
    REFUSES_ALL(skein_remove(NULL, s.ball));
    REFUSES("kind", skein_motion_add(s.world, NULL, NULL, NULL, NULL));
    assert_false(skein_particle_present(NULL, 0));
    assert_false(skein_body_asleep(NULL, (skein_handle){0, 0, 0}));
    assert_false(skein_world_is_driven(NULL));
    assert_int_equal(skein_world_error(NULL)->status, SKEIN_ERROR_VALUE);
    assert_true(skein_object_count(s.world, SKEIN_BODY) == 1 && skein_particle_count(s.world) == 9);
    skein_world_destroy(s.world);
}

static void kinds_and_fields(void **state) {
    (void)state;
    scene s = make_scene();
    skein_error error = {0};
    const skein_kind *sphere = skein_kind_find(SKEIN_COLLIDER, "sphere", NULL);
    const skein_field *radius = skein_field_find(sphere, "radius", NULL);
    assert_null(skein_kind_find(SKEIN_BODY, NULL, &error));
    assert_string_equal(error.message, "name is NULL");
    assert_null(skein_kind_find(SKEIN_BODY, "no such kind", NULL));
    assert_null(skein_field_find(NULL, "radius", &error));
    assert_string_equal(error.message, "kind is NULL");
    assert_null(skein_field_find(sphere, NULL, &error));
    assert_string_equal(error.message, "name is NULL");
    assert_null(skein_field_find(sphere, "no such field", NULL));
    assert_null(skein_common_fields(SKEIN_BODY, NULL));
    assert_false(skein_kind_takes(NULL, "name"));
    assert_false(skein_kind_takes(skein_kind_at(SKEIN_BODY, 0), NULL));
    SAYS("field", skein_field_check(NULL, &value, &error));
    SAYS("value", skein_field_check(radius, NULL, &error));
    char text[8] = "before";
    assert_int_equal(skein_value_text(NULL, &value, text, sizeof text), 0);
    assert_string_equal(text, "");
    assert_int_equal(skein_value_text(radius, NULL, text, sizeof text), 0);
    value = skein_number(12.5);
    assert_int_equal(skein_value_text(radius, &value, NULL, 8), 4); // only the length is wanted

    REFUSES("name", skein_set(s.world, s.ball, NULL, value));
    REFUSES("name", skein_get(s.world, s.ball, NULL, &value));
    REFUSES("value", skein_get(s.world, s.ball, "radius", NULL));
    REFUSES("path", skein_set_path(s.world, NULL, value));
    REFUSES("path", skein_get_path(s.world, NULL, &value));
    REFUSES("value", skein_get_path(s.world, "colliders.0.radius", NULL));
    FAILS(s.world, SKEIN_ERROR_VALUE, "a text", skein_set(s.world, s.ball, "name", skein_text(NULL)));
    assert_false(skein_field_is_live(s.world, s.ball, NULL));
    REFUSES_ALL(skein_set(NULL, s.ball, "radius", value));
    REFUSES_ALL(skein_get(NULL, s.ball, "radius", &value));
    REFUSES_ALL(skein_set_path(NULL, "colliders.0.radius", value));
    REFUSES_ALL(skein_get_path(NULL, "colliders.0.radius", &value));
    assert_false(skein_field_is_live(NULL, s.ball, "radius"));
    assert_true(skein_object_count(NULL, SKEIN_METHOD) == 0);
    assert_false(skein_handle_valid(s.world, skein_object_at(NULL, SKEIN_METHOD, 0)));
    assert_null(skein_object_kind(NULL, s.ball));
    assert_false(skein_handle_valid(NULL, s.ball));
    REFUSES_ALL(skein_user_set(NULL, s.ball, text));
    assert_null(skein_user(NULL, s.ball));
    skein_world_destroy(s.world);
}

static void stepping(void **state) {
    (void)state;
    scene s = make_scene();
    skein_pass pass;
    REFUSES_ALL(skein_world_step(NULL, 0.01));
    REFUSES_ALL(skein_world_reset(NULL));
    REFUSES_ALL(skein_world_time_set(NULL, 1));
    assert_true(skein_world_time(NULL) == 0);
    REFUSES_ALL(skein_world_explain(NULL, 0.01, NULL, NULL));
    skein_world_fuse(NULL, false);
    REFUSES_ALL(skein_world_profile(NULL, 0.01, &pass, 1, &count));
    REFUSES("out", skein_world_profile(s.world, 0.01, NULL, 1, &count));
    REFUSES("count", skein_world_profile(s.world, 0.01, &pass, 1, NULL));
    OK(s.world, skein_world_profile(s.world, 0.01, NULL, 0, &count));
    REFUSES_ALL(skein_world_device_set(NULL, SKEIN_DEVICE_CPU));
    assert_true(skein_world_device(NULL).slot_count == 0 && skein_world_device(NULL).name);
    skein_world_wait(NULL);
    const skein_sparse_solver nothing = {.name = "nothing"};
    REFUSES_ALL(skein_sparse_solver_set(NULL, NULL));
    FAILS(s.world, SKEIN_ERROR_VALUE, "needs analyse", skein_sparse_solver_set(s.world, &nothing));
    OK(s.world, skein_sparse_solver_set(s.world, NULL));
    skein_state shared;
    const skein_part no_part = {.user = NULL};
    const skein_runner no_runner = {.name = "nobody"};
    REFUSES_ALL(skein_world_part_set(NULL, NULL));
    FAILS(s.world, SKEIN_ERROR_VALUE, "needs number", skein_world_part_set(s.world, &no_part));
    OK(s.world, skein_world_part_set(s.world, NULL));
    REFUSES_ALL(skein_world_runner_set(NULL, NULL));
    FAILS(s.world, SKEIN_ERROR_VALUE, "needs name, step", skein_world_runner_set(s.world, &no_runner));
    OK(s.world, skein_world_runner_set(s.world, NULL));
    REFUSES_ALL(skein_world_can_share(NULL, 0.01));
    skein_share_body share_body;
    size_t share_count;
    REFUSES_ALL(skein_world_share_bodies(NULL, 0.01, &share_body, 1, &share_count));
    REFUSES("count", skein_world_share_bodies(s.world, 0.01, &share_body, 1, NULL));
    REFUSES("out", skein_world_share_bodies(s.world, 0.01, NULL, 1, &share_count));
    REFUSES_ALL(skein_world_part_shadow(NULL, 0));
    FAILS(s.world, SKEIN_ERROR_VALUE, "no body 100000", skein_world_part_shadow(s.world, 100000));
    REFUSES_ALL(skein_world_state(NULL, &shared));
    REFUSES("state", skein_world_state(s.world, NULL));
    assert_int_equal(skein_pacer_feed(NULL, 1), 0);
    assert_true(skein_pacer_blend(NULL) == 0);
    skein_world_destroy(s.world);
}

static void reading_and_writing(void **state) {
    (void)state;
    scene s = make_scene();
    skein_surface surface;
    skein_pose pose;
    float uv[2];
    assert_true(skein_particle_count(NULL) == 0);
    assert_true(!skein_position_view(NULL).xyzw && !skein_position_view(NULL).count);
    assert_true(!skein_velocity_view(NULL).xyzw && !skein_velocity_view(NULL).count);
    REFUSES("out", skein_positions_copy(s.world, 0, 1, NULL));
    REFUSES("out", skein_velocities_copy(s.world, 0, 1, NULL));
    REFUSES("out", skein_positions_built(s.world, 0, 1, NULL));
    REFUSES("out", skein_snapshot_write(s.world, NULL, 1, NULL));
    REFUSES("bytes", skein_snapshot_read(s.world, NULL, 1));
    REFUSES_ALL(skein_snapshot_write(NULL, xyz, 1, NULL));
    REFUSES_ALL(skein_snapshot_read(NULL, xyz, 1));
    REFUSES_ALL(skein_snapshot_look(NULL, 1, &(skein_snapshot_info){0}, NULL));
    REFUSES_ALL(skein_snapshot_look(xyz, 1, NULL, NULL));
    assert_int_equal(skein_snapshot_size(NULL), 0);
    skein_recorder nowhere = {NULL, NULL, NULL};
    REFUSES("recorder", skein_record_begin(s.world, NULL));
    REFUSES("write", skein_record_begin(s.world, &nowhere));
    REFUSES("bytes", skein_replay(s.world, NULL, 1, &(skein_difference){0}));
    REFUSES("difference", skein_replay(s.world, xyz, 1, NULL));
    REFUSES_ALL(skein_record_begin(NULL, &nowhere));
    REFUSES_ALL(skein_record_end(NULL));
    REFUSES_ALL(skein_replay(NULL, xyz, 1, &(skein_difference){0}));
    REFUSES_ALL(skein_recording_look(NULL, 1, &(skein_recording_info){0}, NULL));
    REFUSES_ALL(skein_recording_look(xyz, 1, NULL, NULL));
    REFUSES("to", skein_positions_copy_to(s.world, 0, 1, skein_floats(NULL, 0)));
    REFUSES("to", skein_velocities_copy_to(s.world, 0, 1, skein_doubles(NULL, 0)));
    REFUSES("out", skein_positions_blend(s.world, 1, 0, 1, NULL));
    REFUSES("xyz", skein_positions_set(s.world, 0, 1, NULL));
    REFUSES("xyz", skein_velocities_set(s.world, 0, 1, NULL));
    OK(s.world, skein_positions_copy(s.world, 9, 0, NULL));
    OK(s.world, skein_positions_set(s.world, 9, 0, NULL));
    OK(s.world, skein_positions_copy_to(s.world, 0, 0, skein_floats(NULL, 0)));
    REFUSES("surface", skein_body_surface(s.world, s.cloth, NULL));
    REFUSES("count", skein_body_elements(s.world, s.cloth, SKEIN_EDGES, NULL, 0, NULL));
    REFUSES("text", skein_body_select(s.world, s.cloth, NULL, NULL, 0, &count));
    REFUSES("count", skein_body_select(s.world, s.cloth, "0", NULL, 0, NULL));
    REFUSES("out", skein_body_select(s.world, s.cloth, "0", NULL, 1, &count));
    OK(s.world, skein_body_select(s.world, s.cloth, "0", NULL, 0, &count));
    REFUSES("particles", skein_attachments_find(s.world, NULL, 1, s.cloth, &(uint32_t){0}));
    REFUSES("out", skein_attachments_find(s.world, &(uint32_t){0}, 1, s.cloth, NULL));
    OK(s.world, skein_attachments_find(s.world, NULL, 0, s.cloth, NULL));
    REFUSES("blade", skein_cut(s.world, s.cloth, NULL, &count));
    OK(s.world, skein_cut(s.world, s.cloth, (const double[3][3]){{9, 9, 9}, {9, 9, 8}, {9, 8, 9}}, NULL));
    REFUSES("faces", skein_cut_faces(s.world, s.cloth, NULL, 1));
    OK(s.world, skein_cut_faces(s.world, s.cloth, NULL, 0));
    REFUSES("cuts", skein_body_cuts(s.world, s.cloth, NULL));
    OK(s.world, skein_body_elements(s.world, s.cloth, SKEIN_EDGES, NULL, 0, &count));
    OK(s.world, skein_body_elements(s.world, s.cloth, SKEIN_HINGES, NULL, 100, &count));
    REFUSES("corner_uv", skein_body_uv_set(s.world, s.cloth, NULL, 16));
    OK(s.world, skein_body_vertices_copy(s.world, s.cloth, 1, skein_floats(NULL, 0), skein_floats(NULL, 0)));
    REFUSES("pose", skein_collider_pose(s.world, s.ball, NULL));
    REFUSES_ALL(skein_positions_copy(NULL, 0, 1, xyz));
    REFUSES_ALL(skein_velocities_copy(NULL, 0, 1, xyz));
    REFUSES_ALL(skein_positions_built(NULL, 0, 1, xyz));
    REFUSES_ALL(skein_positions_copy_to(NULL, 0, 1, skein_doubles(xyz, 0)));
    REFUSES_ALL(skein_velocities_copy_to(NULL, 0, 1, skein_doubles(xyz, 0)));
    REFUSES_ALL(skein_positions_blend(NULL, 1, 0, 1, xyz));
    REFUSES_ALL(skein_positions_set(NULL, 0, 1, xyz));
    REFUSES_ALL(skein_velocities_set(NULL, 0, 1, xyz));
    REFUSES_ALL(skein_particle_pin(NULL, 0, true));
    OK(s.world, skein_particle_pin(s.world, 0, true));
    REFUSES("xyz", skein_pins_move(s.world, &index_of, 1, NULL));
    OK(s.world, skein_pins_move(s.world, NULL, 1, xyz));
    OK(s.world, skein_pins_move(s.world, NULL, 0, NULL));
    REFUSES_ALL(skein_pins_move(NULL, &index_of, 1, xyz));
    REFUSES_ALL(skein_body_surface(NULL, s.cloth, &surface));
    REFUSES_ALL(skein_body_elements(NULL, s.cloth, SKEIN_EDGES, NULL, 0, &count));
    REFUSES_ALL(skein_body_select(NULL, s.cloth, "0", NULL, 0, &count));
    REFUSES_ALL(skein_attachments_find(NULL, NULL, 0, s.cloth, NULL));
    REFUSES_ALL(skein_cut(NULL, s.cloth, NULL, NULL));
    REFUSES_ALL(skein_cut_faces(NULL, s.cloth, NULL, 0));
    REFUSES_ALL(skein_cut_mend(NULL, s.cloth));
    REFUSES_ALL(skein_body_cuts(NULL, s.cloth, &(skein_cuts){NULL, 0, 0}));
    REFUSES_ALL(skein_body_uv_set(NULL, s.cloth, uv, 1));
    REFUSES_ALL(skein_body_vertices_copy(NULL, s.cloth, 1, skein_doubles(xyz, 0), skein_doubles(NULL, 0)));
    REFUSES_ALL(skein_collider_pose(NULL, s.ball, &pose));
    REFUSES_ALL(skein_collider_teleport(NULL, s.ball));
    skein_triangles triangles;
    REFUSES_ALL(skein_collider_triangles(NULL, s.ball, &triangles));
    REFUSES("triangles", skein_collider_triangles(s.world, s.ball, NULL));
    REFUSES_ALL(skein_collider_vertices_copy(NULL, s.ball, skein_doubles(xyz, 0)));
    size_t touching;
    REFUSES_ALL(skein_surface_contacts_copy(NULL, NULL, 0, &touching));
    REFUSES("count", skein_surface_contacts_copy(s.world, NULL, 0, NULL));
    REFUSES("out", skein_surface_contacts_copy(s.world, NULL, 1, &touching));
    REFUSES_ALL(skein_body_teleport(NULL, s.cloth, NULL, NULL));
    OK(s.world, skein_body_teleport(s.world, s.cloth, NULL, NULL));
    REFUSES_ALL(skein_collider_vertices_set(NULL, s.ball, NULL, 0));
    REFUSES("positions", skein_collider_vertices_set(s.world, s.ball, NULL, 0));
    skein_world_destroy(s.world);
}

static void lists_and_questions(void **state) {
    (void)state;
    scene s = make_scene();
    skein_spring spring;
    skein_contact contact;
    skein_hit hit;
    double t;
    REFUSES("out", skein_springs_copy(s.world, NULL, 1, &count));
    REFUSES("count", skein_springs_copy(s.world, &spring, 1, NULL));
    OK(s.world, skein_springs_copy(s.world, NULL, 0, &count));
    REFUSES("out", skein_contacts_copy(s.world, NULL, 1, &count));
    REFUSES("count", skein_contacts_copy(s.world, &contact, 1, NULL));
    skein_constraint_value constraint;
    skein_operation operation;
    REFUSES("count", skein_constraint_count(s.world, s.rod, NULL));
    REFUSES("value", skein_constraint_evaluate(s.world, s.rod, 0, NULL, pair, xyz, 2));
    REFUSES("particles", skein_constraint_evaluate(s.world, s.rod, 0, &constraint, NULL, xyz, 2));
    REFUSES("gradient", skein_constraint_evaluate(s.world, s.rod, 0, &constraint, pair, NULL, 2));
    OK(s.world, skein_constraint_evaluate(s.world, s.rod, 0, &constraint, NULL, NULL, 0));
    REFUSES("operations", skein_constraint_operations(s.world, s.rod, 0, NULL, NULL, 1, &count));
    REFUSES("count", skein_constraint_operations(s.world, s.rod, 0, &operation, NULL, 1, NULL));
    OK(s.world, skein_constraint_operations(s.world, s.rod, 0, &operation, NULL, 1, &count));
    REFUSES_ALL(skein_constraint_count(NULL, s.rod, &count));
    REFUSES_ALL(skein_constraint_evaluate(NULL, s.rod, 0, &constraint, NULL, NULL, 0));
    REFUSES_ALL(skein_constraint_operations(NULL, s.rod, 0, NULL, NULL, 0, &count));
    REFUSES("points", skein_collider_probe(s.world, s.ball, 1, NULL, xyz, NULL));
    OK(s.world, skein_collider_probe(s.world, s.ball, 1, xyz, NULL, NULL));
    REFUSES("points", skein_force_probe(s.world, s.field, 1, NULL, xyz));
    REFUSES("forces", skein_force_probe(s.world, s.field, 1, xyz, NULL));
    OK(s.world, skein_force_probe(s.world, s.field, 0, NULL, NULL));
    static const double down[3] = {0, -1, 0};
    REFUSES("origin", skein_ray_cast(s.world, NULL, down, SKEIN_BODY, &hit));
    REFUSES("direction", skein_ray_cast(s.world, xyz, NULL, SKEIN_BODY, &hit));
    REFUSES("hit", skein_ray_cast(s.world, xyz, down, SKEIN_BODY, NULL));
    REFUSES("point", skein_particle_near_point(s.world, NULL, &index_of, NULL));
    REFUSES("particle", skein_particle_near_point(s.world, xyz, NULL, NULL));
    OK(s.world, skein_particle_near_point(s.world, xyz, &index_of, NULL));
    REFUSES("origin", skein_particle_near_ray(s.world, NULL, down, 1, 0, &index_of, &t));
    REFUSES("direction", skein_particle_near_ray(s.world, xyz, NULL, 1, 0, &index_of, &t));
    REFUSES("particle", skein_particle_near_ray(s.world, xyz, down, 1, 0, NULL, &t));
    REFUSES("t", skein_particle_near_ray(s.world, xyz, down, 1, 0, &index_of, NULL));
    REFUSES_ALL(skein_springs_copy(NULL, &spring, 1, &count));
    REFUSES_ALL(skein_contacts_copy(NULL, &contact, 1, &count));
    REFUSES_ALL(skein_collider_probe(NULL, s.ball, 1, xyz, xyz, NULL));
    REFUSES_ALL(skein_force_probe(NULL, s.field, 1, xyz, xyz));
    REFUSES_ALL(skein_ray_cast(NULL, xyz, down, SKEIN_BODY, &hit));
    REFUSES_ALL(skein_particle_near_point(NULL, xyz, &index_of, NULL));
    REFUSES_ALL(skein_particle_near_ray(NULL, xyz, down, 1, 0, &index_of, &t));
    skein_world_destroy(s.world);
}

static void measures(void **state) {
    (void)state;
    scene s = make_scene();
    skein_statistics statistics;
    skein_order order;
    skein_stability stability;
    REFUSES("statistics", skein_world_statistics(s.world, NULL));
    REFUSES("centre", skein_order_measure(s.world, 0, 1, NULL, 0, &order));
    REFUSES("order", skein_order_measure(s.world, 0, 1, xyz, 0, NULL));
    REFUSES("stability", skein_world_stability(s.world, NULL));
    REFUSES_ALL(skein_world_statistics(NULL, &statistics));
    REFUSES_ALL(skein_order_measure(NULL, 0, 1, xyz, 0, &order));
    REFUSES_ALL(skein_world_stability(NULL, &stability));
    assert_true(skein_world_hash(NULL) == 0);
    OK(s.world, skein_world_stability(s.world, &stability));
    assert_true(isnan(skein_stable_substep(NULL, &stability)) && isnan(skein_stable_substep("xpbd", NULL)));
    skein_world_destroy(s.world);
}

static void hear_text(void *user, const char *text) {
    (void)text;
    ++*(int *)user;
}

static void formulas(void **state) {
    (void)state;
    scene s = make_scene();
    skein_error error = {0};
    const skein_formula_desc desc = {.text = "dot(p0, p0)", .second = true}, no_text = {.second = true};
    assert_null(skein_formula_create(NULL, NULL, &error));
    assert_string_equal(error.where, "desc");
    assert_null(skein_formula_create(&no_text, NULL, &error));
    assert_string_equal(error.where, "desc->text");
    skein_formula *f = skein_formula_create(&desc, NULL, NULL);
    assert_non_null(f);
    skein_formula_value result;
    const skein_formula_point point = {.positions = xyz}, nowhere = {.time = 0};
    double hessian[9];
    char shown[16] = "before";
    const skein_formula_mark mark = {1, 1, 1};
    SAYS("formula", skein_formula_evaluate(NULL, &point, &result, &error));
    SAYS("point", skein_formula_evaluate(f, NULL, &result, &error));
    SAYS("value", skein_formula_evaluate(f, &point, NULL, &error));
    SAYS("", skein_formula_evaluate(f, &nowhere, &result, &error));
    assert_int_equal(skein_formula_evaluate(f, &point, &result, NULL), SKEIN_OK);
    SAYS("formula", skein_formula_hessian(NULL, &point, hessian, &error));
    SAYS("point", skein_formula_hessian(f, NULL, hessian, &error));
    SAYS("hessian", skein_formula_hessian(f, &point, NULL, &error));
    assert_int_equal(skein_formula_show(NULL, &mark, shown, sizeof shown), 0);
    assert_string_equal(shown, "");
    assert_int_equal(skein_formula_show("p0", NULL, shown, sizeof shown), 0);
    assert_int_equal(skein_formula_show("p0", &mark, NULL, 9), 5);
    assert_null(skein_formula_warning(NULL, 0, NULL));
    assert_int_equal(skein_formula_about(NULL).size, 0);
    assert_true(skein_formula_hash(NULL) == 0 && skein_formula_hash(f) != 0);
    int pieces = 0;
    SAYS("formula", skein_formula_emit(NULL, SKEIN_FORMULA_C, hear_text, &pieces, &error));
    SAYS("write", skein_formula_emit(f, SKEIN_FORMULA_C, NULL, NULL, &error));
    SAYS("formula", skein_formula_emit_compiled(NULL, NULL, hear_text, &pieces, &error));
    SAYS("write", skein_formula_emit_compiled(f, NULL, NULL, NULL, &error));
    assert_int_equal(pieces, 0);
    assert_int_equal(skein_formula_emit_compiled(f, NULL, hear_text, &pieces, NULL), SKEIN_OK);
    assert_true(pieces > 0);
    const skein_compiled hollow = {.abi = SKEIN_COMPILED_ABI, .real_size = sizeof(skein_real), .lanes = 4};
    REFUSES("compiled", skein_formula_register(s.world, NULL));
    FAILS(s.world, SKEIN_ERROR_VALUE, "is not whole", skein_formula_register(s.world, &hollow));
    REFUSES_ALL(skein_formula_register(NULL, &hollow));
    assert_null(skein_formula_of(NULL, s.rod));
    assert_false(skein_formula_is_compiled(NULL, s.rod));
    assert_true(skein_formula_function(0, NULL, NULL));
    skein_formula_destroy(NULL);
    skein_formula_destroy(f);
    skein_world_destroy(s.world);
}

/* ---- nothing is left out ---- */

static char *read_text(const char *path) {
    FILE *file = fopen(path, "r");
    assert_non_null(file);
    char *text = calloc(1, 1 << 20);
    assert_non_null(text);
    assert_true(fread(text, 1, (1 << 20) - 1, file) > 0);
    fclose(file);
    return text;
}

static void blank_comments(char *text) {
    for (char *at = text; (at = strstr(at, "/*")) != NULL;) {
        char *end = strstr(at, "*/");
        assert_non_null(end);
        while (at < end + 2) *at++ = ' ';
    }
}

/* Whether the name is followed by a bracket somewhere in the text. */
static bool is_called(const char *text, const char *name) {
    size_t length = strlen(name);
    for (const char *at = text; (at = strstr(at, name)) != NULL; at += length)
        if (at[length] == '(' && !isalnum((unsigned char)at[-1]) && at[-1] != '_') return true;
    return false;
}

/* Kinds of a program's own; writing and building are calls from within a step and a body, which have their writer. */
static void kinds_of_its_own(void **state) {
    (void)state;
    scene s = make_scene();
    skein_error error = {0};
    skein_stability stability = {.mode_count = 0};
    skein_shape shape;
    skein_kinds *kinds = skein_kinds_create(NULL);
    skein_kinds_destroy(NULL);
    SAYS("kinds", skein_kind_register(NULL, skein_kind_at(SKEIN_FORCE, 0), &error));
    SAYS("kind", skein_kind_register(kinds, NULL, &error));
    assert_non_null(skein_kinds_at(NULL, SKEIN_FORCE, 0));
    assert_null(skein_kinds_find(kinds, SKEIN_FORCE, NULL, &error));
    assert_string_equal(error.where, "name");
    assert_non_null(skein_kinds_find(NULL, SKEIN_FORCE, "gravity", NULL));
    assert_true(isnan(skein_kinds_stable_substep(kinds, NULL, &stability)));
    assert_true(isnan(skein_kinds_stable_substep(kinds, "rk4", NULL)));
    assert_false(isnan(skein_kinds_stable_substep(NULL, "rk4", &stability)));
    skein_gradient_desc gradient = {.dt = 0.01, .steps = 1};
    skein_gradient_result derivatives;
    REFUSES_ALL(skein_gradient(NULL, &gradient, &derivatives));
    REFUSES("desc", skein_gradient(s.world, NULL, &derivatives));
    REFUSES("result", skein_gradient(s.world, &gradient, NULL));
    REFUSES("desc->measure", skein_gradient(s.world, &gradient, &derivatives));
    REFUSES("shape", skein_shape_of(s.world, s.ball, NULL));
    REFUSES_ALL(skein_shape_of(NULL, s.ball, &shape));
    assert_int_equal(skein_write_repeat(NULL, 1, 1), 0);
    skein_write_end(NULL, 0), skein_write_stage_time(NULL, 1), skein_write_forces(NULL), skein_write_steering(NULL);
    skein_write_sum(NULL, SKEIN_X, 1, SKEIN_X, 1, SKEIN_V), skein_write_kick(NULL, SKEIN_V, SKEIN_V, 1, SKEIN_F);
    skein_write_bounds(NULL), skein_write_projections(NULL, 1), skein_write_contacts(NULL);
    REFUSES_ALL(skein_build_particles(NULL, 1, xyz, NULL, xyz));
    REFUSES_ALL(skein_build_springs(NULL, "x", 1, pair, 1, 1));
    REFUSES_ALL(skein_build_triangles(NULL, 1, pair));
    REFUSES_ALL(skein_build_fail(NULL, "", ""));
    skein_world_destroy(s.world);
    skein_kinds_destroy(kinds);
}

static void every_function_was_called(void **state) {
    (void)state;
    static const char *const without_pointers[] = {
        "skein_status_text",  "skein_version", "skein_category_text", "skein_kind_at",       "skein_default_world_desc",
        "skein_number",       "skein_vector",  "skein_handle_equal",  "skein_default_pacer", "skein_settings_of",
        "skein_world_create", // whose pointers may both be NULL
    };
    static const char *const headers[] = {"include/skein/skein.h",    "include/skein/record.h",
                                          "include/skein/formula.h",  "include/skein/kinds.h",
                                          "include/skein/gradient.h", "include/skein/cut.h"};
    char *own = read_text("tests/test_nulls.c");
    blank_comments(own);
    size_t found = 0, missing = 0;
    for (size_t h = 0; h < COUNT(headers); h++) {
        char *text = read_text(headers[h]);
        blank_comments(text);
        for (char *at = text; (at = strstr(at, "skein_")) != NULL;) {
            char name[80];
            size_t length = strspn(at, "abcdefghijklmnopqrstuvwxyz0123456789_");
            bool whole = at == text || (!isalnum((unsigned char)at[-1]) && at[-1] != '_');
            snprintf(name, sizeof name, "%.*s", (int)length, at);
            at += length;
            if (!whole || *at != '(') continue;
            found++;
            bool known = is_called(own, name);
            for (size_t i = 0; i < COUNT(without_pointers); i++) known |= !strcmp(name, without_pointers[i]);
            if (!known)
                fprintf(stderr, "%s declares %s, which is not called with NULL here\n", headers[h], name), missing++;
        }
        free(text);
    }
    free(own);
    assert_int_equal(missing, 0);
    assert_true(found > 80); // or the headers were not read
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(building),
        cmocka_unit_test(kinds_and_fields),
        cmocka_unit_test(stepping),
        cmocka_unit_test(reading_and_writing),
        cmocka_unit_test(lists_and_questions),
        cmocka_unit_test(measures),
        cmocka_unit_test(formulas),
        cmocka_unit_test(kinds_of_its_own),
        cmocka_unit_test(every_function_was_called),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
