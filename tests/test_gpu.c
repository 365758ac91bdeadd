/* The plan on the graphics card: the same worlds stepped on both devices agree, and what cannot run there is named.
 * Runs on whatever OpenGL there is; Mesa's llvmpipe plays a card where there is none. */
#include "gpu.h"

static skein_world *falling(const char *method, size_t count) {
    skein_world *world = new_world(method, 4);
    add_gravity(world);
    OK(world, skein_force_add(world, "wind", SKEIN_SETTINGS(SKEIN_VEC3("force", 0.5, 0, 1)), NULL));
    OK(world, skein_force_add(world, "drag", SKEIN_SETTINGS(SKEIN_REAL("linear", 0.2), SKEIN_REAL("rate", 0.1)), NULL));
    scatter(world, count, 2, 7);
    return world;
}

static void falling_agrees_under_every_method(void **state) {
    (void)state;
    for (size_t m = 0; m < COUNT(explicit_methods); m++) {
        skein_world *cpu = falling(explicit_methods[m], 300), *gpu = falling(explicit_methods[m], 300);
        to_card(gpu);
        for (int i = 0; i < 10; i++) {
            OK(cpu, skein_world_step(cpu, dt));
            OK(gpu, skein_world_step(gpu, dt));
        }
        double off = difference(cpu, gpu);
        if (off > 1e-4) fprintf(stderr, "%s is off by %g\n", explicit_methods[m], off);
        assert_true(off <= 1e-4);
        skein_world_destroy(cpu);
        skein_world_destroy(gpu);
    }
}

/* ---- contact ------------------------------------------------------------------------------------ */

static const struct shape {
    const char *kind;
    skein_setting settings[8];
} shapes[] = {
    {"plane", {SKEIN_VEC3("normal", 0.1, 1, 0), SKEIN_REAL("offset", -1), SKEIN_REAL("friction", 0.2)}},
    {"sphere", {SKEIN_REAL("radius", 0.9), SKEIN_REAL("restitution", 0.7), SKEIN_VEC3("motion.velocity", 0.3, 0.1, 0)}},
    {"sphere", {SKEIN_REAL("radius", 0.8), SKEIN_REAL("mass", 5)}},
    {"bowl", {SKEIN_REAL("radius", 1.8), SKEIN_REAL("friction", 0.6)}},
    {"capsule",
     {SKEIN_VEC3("from", -1, 0, 0), SKEIN_VEC3("to", 1, 0.3, 0), SKEIN_REAL("radius", 0.5),
      SKEIN_REAL("motion.spin", 3), SKEIN_VEC3("motion.axis", 1, 1, 0)}},
    {"box",
     {SKEIN_VEC3("size", 1, 1.5, 0.8), SKEIN_VEC3("rotation", 20, 30, 40), SKEIN_REAL("motion.spin", -2),
      SKEIN_REAL("motion.start", 0.02), SKEIN_REAL("restitution", 0.3)}},
    {"formula",
     {SKEIN_TEXT("surface", "length(p) - R - 0.3*sin(20*t)*p.x"), SKEIN_REAL("parameters.R", 0.8),
      SKEIN_VEC3("rotation", 20, 30, 40), SKEIN_REAL("restitution", 0.5), SKEIN_REAL("friction", 0.3),
      SKEIN_REAL("motion.spin", 1)}},
};

static skein_world *colliding(const char *method, const struct shape *shape) {
    skein_world *world = new_world(method, 3);
    add_gravity(world);
    OK(world, skein_collider_add(world, shape->kind, shape->settings, NULL));
    scatter(world, 400, 3, 11);
    return world;
}

static void contact_agrees_for_every_shape(void **state) {
    (void)state;
    for (size_t s = 0; s < COUNT(shapes); s++) {
        for (int m = 0; m < 2; m++) {
            skein_world *cpu = colliding(method_names[m], &shapes[s]), *gpu = colliding(method_names[m], &shapes[s]);
            assert_agree(cpu, gpu, 4, 1e-4, shapes[s].kind);
        }
    }
    // and it is there at all: nobody is deep in the ball, once it lets them out at once
    skein_world *world = colliding("xpbd", &shapes[1]);
    OK(world, skein_set_path(world, "colliders.0.recovery", skein_number(1e6)));
    to_card(world);
    skein_statistics statistics;
    OK(world, skein_world_statistics(world, &statistics));
    assert_true(statistics.max_penetration > 0.1);
    OK(world, skein_world_step(world, dt));
    OK(world, skein_world_statistics(world, &statistics));
    assert_true(statistics.max_penetration < 1e-3);
    skein_world_destroy(world);
    // nor does what is fast pass a thin plate or a thin shell
    for (int n = 0; n < 4; n++) {
        world = new_world(method_names[n % 2], 3);
        skein_setting plate[] = {n / 2 ? (skein_setting)SKEIN_TEXT("surface", "abs(p.y) - 0.0005")
                                       : (skein_setting)SKEIN_VEC3("size", 60, 0.001, 60),
                                 SKEIN_END};
        OK(world, skein_collider_add(world, n / 2 ? "formula" : "box", plate, NULL));
        for (int i = 0; i < 10; i++) add_moving(world, 1, 0.1 * i, 0.3 + 0.1 * i, 0, 3 * i, -40 * i, 0);
        to_card(world);
        steps(world, 12, dt);
        for (size_t i = 0; i < 10; i++) assert_true(position_of(world, i).y > 0);
        skein_world_destroy(world);
    }
}

/* ---- neighbours --------------------------------------------------------------------------------- */

static skein_world *pushing(const char *method, size_t count, double size, double radius) {
    skein_world *world = new_world(method, 2);
    OK(world, skein_force_add(world, "drag", SKEIN_SETTINGS(SKEIN_REAL("quadratic", 0.3)), NULL));
    OK(world, skein_force_add(world, "separation",
                              SKEIN_SETTINGS(SKEIN_REAL("radius", radius), SKEIN_REAL("strength", 0.5)), NULL));
    scatter(world, count, size, count);
    return world;
}

/* Few and many, in one cell and far apart; a second rule of another reach. */
static void neighbours_agree(void **state) {
    (void)state;
    static const struct {
        size_t count;
        double size, radius;
    } crowds[] = {{1, 1, 0.2}, {2, 0.1, 0.2}, {40, 0.01, 0.5}, {700, 2, 0.3}, {3000, 4, 0.35}, {500, 1e6, 1e5}};
    for (size_t c = 0; c < COUNT(crowds); c++) {
        skein_world *world[2];
        for (int w = 0; w < 2; w++) {
            world[w] = pushing(c % 2 ? "xpbd" : "leapfrog", crowds[c].count, crowds[c].size, crowds[c].radius);
            OK(world[w], skein_force_add(world[w], "separation",
                                         SKEIN_SETTINGS(SKEIN_REAL("radius", crowds[c].radius / 2)), NULL));
        }
        assert_agree(world[0], world[1], 2, 1e-4 * fmax(1, crowds[c].size / 10), "a crowd");
    }
}

static void particles_that_are_nowhere_harm_nobody(void **state) {
    (void)state;
    skein_world *world = pushing("symplectic_euler", 200, 1, 0.2);
    to_card(world);
    OK(world, skein_velocities_set(world, 3, 1, (const double[]){1e15, 0, 0}));
    OK(world, skein_world_step(world, 1e6)); // drag overflows
    skein_statistics statistics;
    OK(world, skein_world_statistics(world, &statistics));
    assert_true(statistics.nonfinite >= 1);
    OK(world, skein_world_step(world, 1e-3));
    skein_world_destroy(world);
}

static void the_same_bits_come_again(void **state) {
    (void)state;
    uint64_t hash[2];
    for (int w = 0; w < 2; w++) {
        skein_world *world = pushing("xpbd", 2000, 2, 0.3);
        to_card(world);
        for (int i = 0; i < 5; i++) {
            OK(world, skein_world_step(world, dt));
            if (w) skein_world_hash(world); // looking changes nothing
        }
        hash[w] = skein_world_hash(world);
        skein_world_destroy(world);
    }
    assert_true(hash[0] == hash[1]);
}

/* ---- memory ------------------------------------------------------------------------------------- */

typedef struct purse {
    size_t calls, fail_at, blocks;
} purse;

static void *take(void *user, size_t size, size_t alignment) {
    purse *p = user;
    if (p->calls++ == p->fail_at) return NULL;
    p->blocks++;
    return aligned_alloc(alignment, size);
}

static void give_back(void *user, void *memory, size_t size) {
    (void)size;
    ((purse *)user)->blocks--;
    free(memory);
}

/* Whichever allocation fails on the way to the card, the call says so, can be made again, and nothing is left. */
static void failed_allocations_are_survived(void **state) {
    (void)state;
    purse p = {0, SIZE_MAX, 0};
    bool failed = true;
    for (size_t n = 0; failed; n++) {
        skein_world_desc desc = skein_default_world_desc();
        desc.allocate = take, desc.release = give_back, desc.memory_user = &p;
        skein_world *world = skein_world_create(&desc, NULL);
        OK(world, skein_force_add(world, "separation", SKEIN_SETTINGS(SKEIN_REAL("radius", 0.3)), NULL));
        OK(world, skein_method_set(world, "symplectic_euler", NULL));
        scatter(world, 60, 1, 3);
        OK(world, skein_world_step(world, dt)); // what is not the card's is there already
        p.fail_at = p.calls + n;
        skein_status status = skein_world_device_set(world, SKEIN_DEVICE_GPU);
        if (status == SKEIN_ERROR_MEMORY) status = skein_world_device_set(world, SKEIN_DEVICE_GPU);
        if (status) fprintf(stderr, "skipped: %s\n", skein_world_error(world)->message);
        for (int i = 0; i < 4 && !status; i++) {
            skein_status stepped = skein_world_step(world, dt);
            if (!stepped) continue;
            assert_int_equal(stepped, SKEIN_ERROR_MEMORY);
            OK(world, skein_world_step(world, dt));
        }
        failed = p.calls > p.fail_at && !status;
        p.fail_at = SIZE_MAX;
        skein_statistics statistics;
        OK(world, skein_world_statistics(world, &statistics));
        skein_world_destroy(world);
        assert_int_equal(p.blocks, 0);
        if (status) skip();
        assert_true(n > 5 || failed);
    }
}

/* ---- limits of drivers: a binding smaller than a vector, an axis shorter than the groups -------- */

static void small_bindings_and_short_axes_do(void **state) {
    (void)state;
    skein_world *cpu = colliding("xpbd", &shapes[4]), *gpu = colliding("xpbd", &shapes[4]);
    scatter(cpu, 5000, 3, 3);
    scatter(gpu, 5000, 3, 3);
    to_card(gpu);
    sk_gpu_device *device = (sk_gpu_device *)(void *)gpu->device;
    device->most_bytes = 16 * 1000; // 7 parts of it are 896 slots
    device->most_groups = 3;
    for (int i = 0; i < 3; i++) {
        OK(cpu, skein_world_step(cpu, dt));
        OK(gpu, skein_world_step(gpu, dt));
    }
    assert_under(difference(cpu, gpu), 1e-4 * FLOAT_OFF);
    // with neighbours everybody must be in reach
    OK(gpu, skein_force_add(gpu, "separation", NULL, NULL));
    FAILS(gpu, SKEIN_ERROR_LIMIT, "5400 particles", skein_world_step(gpu, dt));
    device->most_bytes = 1 << 20;
    OK(gpu, skein_world_step(gpu, dt));
    OK(cpu, skein_force_add(cpu, "separation", NULL, NULL));
    OK(cpu, skein_world_step(cpu, dt));
    assert_under(difference(cpu, gpu), 2e-4 * FLOAT_OFF); // 1.1e-4 on an H200, which fuses what llvmpipe does not
    skein_world_destroy(cpu);
    skein_world_destroy(gpu);
}

/* ---- the state goes to and fro ------------------------------------------------------------------ */

static void change_by_hand(skein_world *world) {
    OK(world, skein_positions_set(world, 4, 1, (const double[]){0.1, 0.2, 0.3}));
    OK(world, skein_velocities_set(world, 5, 2, (const double[]){1, 2, 3, 4, 5, 6}));
    OK(world, skein_particle_pin(world, 6, true));
}

static void changes_by_hand_arrive(void **state) {
    (void)state;
    skein_world *cpu = pushing("xpbd", 100, 1, 0.2), *gpu = pushing("xpbd", 100, 1, 0.2);
    to_card(gpu);
    for (int turn = 0; turn < 6; turn++) {
        skein_world *both[] = {cpu, gpu};
        for (int w = 0; w < 2; w++) {
            if (turn == 1) change_by_hand(both[w]);
            if (turn == 2) scatter(both[w], 30, 1, 5); // others join, and slots change
            if (turn == 3) OK(both[w], skein_set_path(both[w], "forces.1.radius", skein_number(0.4)));
            if (turn == 4) add_gravity(both[w]);
            OK(both[w], skein_world_step(both[w], dt));
        }
        assert_under(difference(cpu, gpu), 1e-4 * FLOAT_OFF);
        double blend[2][3];
        for (int w = 0; w < 2; w++) OK(both[w], skein_positions_blend(both[w], 0.5, 7, 1, blend[w]));
        for (int k = 0; k < 3; k++) assert_near(blend[0][k], blend[1][k], 1e-4);
    }
    // back to the processor in the middle of it, and to the card again
    OK(gpu, skein_world_device_set(gpu, SKEIN_DEVICE_CPU));
    assert_int_equal(skein_world_device(gpu).device, SKEIN_DEVICE_CPU);
    OK(cpu, skein_world_step(cpu, dt));
    OK(gpu, skein_world_step(gpu, dt));
    assert_under(difference(cpu, gpu), 1e-4 * FLOAT_OFF);
    OK(gpu, skein_world_device_set(gpu, SKEIN_DEVICE_GPU));
    OK(cpu, skein_world_reset(cpu));
    OK(gpu, skein_world_reset(gpu));
    OK(cpu, skein_world_step(cpu, dt));
    OK(gpu, skein_world_step(gpu, dt));
    assert_under(difference(cpu, gpu), 1e-4 * FLOAT_OFF);
    skein_world_destroy(cpu);
    skein_world_destroy(gpu);
}

/* The library reads the state only when asked, and asks for no more memory than it needs. */
static void the_card_is_described(void **state) {
    (void)state;
    skein_world *world = falling("symplectic_euler", 1000);
    to_card(world);
    skein_device_info info = skein_world_device(world);
    assert_int_equal(info.device, SKEIN_DEVICE_GPU);
    assert_true(strlen(info.name) > 3 && !info.position_buffer);
    OK(world, skein_world_step(world, dt));
    assert_true(world->device->ahead);
    info = skein_world_device(world);
    assert_true(world->device->ahead && info.position_buffer && info.velocity_buffer);
    assert_int_equal(info.slot_count, world->particles.slot_count);
    // forces never leave the shader, so that X, V and P are all there is; and a substep is one pass
    assert_int_equal(info.bytes, 3 * 16 * info.slot_count);
    assert_int_equal(info.pass_count, 3);
    skein_position_view(world);
    assert_false(world->device->ahead);
    skein_world_destroy(world);
}

/* ---- what cannot run ---------------------------------------------------------------------------- */

static void keep_line(void *user, const char *line) {
    strncat(user, line, 200);
    strcat(user, "\n");
}

static void what_cannot_run_is_named(void **state) {
    (void)state;
    skein_world *world = new_world("xpbd", 2);
    add_gravity(world);
    OK(world, skein_body_add(world, "cloth", NULL, SKEIN_SETTINGS(SKEIN_TEXT("name", "sail"), SKEIN_PAIR("grid", 8, 8)),
                             NULL));
    to_card(world);
    FAILS(world, SKEIN_ERROR_VALUE, "sail: its ", skein_world_step(world, dt));
    FAILS(world, SKEIN_ERROR_VALUE, "--device cpu", skein_world_explain(world, dt, NULL, NULL));
    OK(world, skein_world_device_set(world, SKEIN_DEVICE_CPU));
    OK(world, skein_world_step(world, dt));
    skein_world_destroy(world);

    world = new_world("backward_euler", 1);
    scatter(world, 10, 1, 1);
    to_card(world);
    FAILS(world, SKEIN_ERROR_VALUE, "cannot run on the graphics card", skein_world_step(world, dt));
    skein_world_destroy(world);
}

static void the_plan_has_the_same_rows(void **state) {
    (void)state;
    static char lines[2][8192];
    skein_world *world = pushing("xpbd", 100, 1, 0.2);
    OK(world, skein_collider_add(world, "plane", NULL, NULL));
    lines[0][0] = lines[1][0] = 0;
    OK(world, skein_world_explain(world, dt, keep_line, lines[0]));
    to_card(world);
    OK(world, skein_world_explain(world, dt, keep_line, lines[1]));
    char *rest = strstr(lines[0], "combine    V   = V, 0 where at most"); // the processors' alone
    assert_non_null(rest);
    memmove(rest, strchr(rest, '\n') + 1, strlen(strchr(rest, '\n')));
    assert_string_equal(lines[0], lines[1]);
    assert_non_null(strstr(lines[1], "neighbour"));
    skein_world_destroy(world);
}

static void without_a_current_context_there_is_no_adopting(void **state) {
    (void)state;
    skein_world *world = new_world("xpbd", 2);
    FAILS(world, SKEIN_ERROR_VALUE, "", skein_world_device_set(world, SKEIN_DEVICE_CURRENT_GL));
    assert_int_equal(skein_world_device(world).device, SKEIN_DEVICE_CPU);
    skein_world_destroy(world);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(falling_agrees_under_every_method),
        cmocka_unit_test(contact_agrees_for_every_shape),
        cmocka_unit_test(neighbours_agree),
        cmocka_unit_test(particles_that_are_nowhere_harm_nobody),
        cmocka_unit_test(the_same_bits_come_again),
        cmocka_unit_test(failed_allocations_are_survived),
        cmocka_unit_test(small_bindings_and_short_axes_do),
        cmocka_unit_test(changes_by_hand_arrive),
        cmocka_unit_test(the_card_is_described),
        cmocka_unit_test(what_cannot_run_is_named),
        cmocka_unit_test(the_plan_has_the_same_rows),
        cmocka_unit_test(without_a_current_context_there_is_no_adopting),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
