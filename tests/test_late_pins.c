/* Tethers to what is pinned once a body is built: a hand that grabs, a brush that paints, a program that holds. They keep as firm as those to
 * pins that a body is built with, and follow from who is pinned, whatever came before. */
#include "helpers.h"
#include "irregular.h"

#include "skein/cut.h"

static const double dt = 1.0 / 60;

enum { SIDE = 25, COUNT_OF = SIDE * SIDE, MIDDLE = SIDE * (SIDE / 2) + SIDE / 2 };

typedef enum kind { GRID, MESH, ROPE, KINDS } kind;

/* A metre of cloth or of rope. */
static skein_world *make(kind k, const char *pins, skein_handle *body) {
    skein_world *world = new_world("xpbd", 10);
    add_particle(world, 1, 9, 9, 9); // so that the body does not begin with particle 0
    add_gravity(world);
    if (k == MESH) {
        add_irregular(world, SIDE, SKEIN_SETTINGS(SKEIN_TEXT("pins", pins)));
        *body = skein_object_at(world, SKEIN_BODY, 0);
    } else if (k == ROPE)
        OK(world, skein_body_add(world, "rope", NULL,
                                 SKEIN_SETTINGS(SKEIN_REAL("count", COUNT_OF), SKEIN_TEXT("pins", pins)), body));
    else
        OK(world, skein_body_add(world, "cloth", NULL,
                                 SKEIN_SETTINGS(SKEIN_PAIR("grid", SIDE, SIDE), SKEIN_TEXT("pins", pins)), body));
    return world;
}

static double farthest_from(const skein_world *world, size_t who) {
    double most = 0;
    for (size_t i = 1; i < skein_particle_count(world); i++)
        most = fmax(most, length3(minus(position_of(world, i), position_of(world, who))));
    return most;
}

/* Leads one in a circle, at full speed from a fifth of a second on; the greatest distance that somebody gets from it. */
static double lead(skein_world *world, uint32_t who, double speed, int frames) {
    const double radius = 0.5, ramp = 0.2;
    const vec3 at = position_of(world, who);
    double most = 0;
    for (int frame = 1; frame <= frames; frame++) {
        const double t = frame * dt, way = speed * (t < ramp ? t * t / (2 * ramp) : t - ramp / 2), angle = way / radius;
        OK(world,
           skein_pins_move(world, &who, 1,
                           (double[]){at.x + radius * sin(angle), at.y + 0.5 * t, at.z + radius * (1 - cos(angle))}));
        steps(world, 1, dt);
        most = fmax(most, farthest_from(world, who));
    }
    return most;
}

/* 10 m of way in a second, 50 m/s2: nobody gets farther from it than along the cloth, which lies flat as it is built. */
static void who_is_grabbed_draws_all_after_it(void **state) {
    (void)state;
    for (kind k = 0; k < KINDS; k++) {
        skein_handle body;
        skein_world *world = make(k, "", &body);
        const uint32_t who = k == ROPE ? COUNT_OF : 1 + MIDDLE;
        const double along = farthest_from(world, who);
        steps(world, 5, dt);
        OK(world, skein_particle_pin(world, who, true));
        assert_under(lead(world, who, 5, 60), along * (k == MESH ? 1.03 : 1.02));
        // let go, it flies on: nothing holds it there
        OK(world, skein_particle_pin(world, who, false));
        const double height = position_of(world, who).y;
        steps(world, 60, dt);
        assert_true(position_of(world, who).y < height - 2);
        skein_world_destroy(world);
    }
}

/* Who was pinned in another order, or in between, or was pinned when a snapshot was taken, is tethered alike: the same bits. */
static void tethers_follow_from_who_is_pinned(void **state) {
    (void)state;
    for (kind k = 0; k < KINDS; k++) {
        skein_handle body;
        skein_world *one = make(k, "0", &body), *other = make(k, "0", &body);
        const uint32_t who = 1 + MIDDLE, beside = 1 + MIDDLE / 2;
        OK(one, skein_particle_pin(one, who, true));
        OK(one, skein_particle_pin(one, beside, true));
        OK(other, skein_particle_pin(other, 7, true));
        steps(other, 3, dt);
        OK(other, skein_particle_pin(other, 7, false));
        OK(other, skein_particle_pin(other, beside, true));
        steps(other, 3, dt);
        OK(other, skein_particle_pin(other, who, true));
        steps(one, 20, dt);
        size_t size = skein_snapshot_size(one), written;
        unsigned char *bytes = malloc(size);
        assert_non_null(bytes);
        OK(one, skein_snapshot_write(one, bytes, size, &written));
        OK(other, skein_snapshot_read(other, bytes, written));
        skein_world *fresh = make(k, "0", &body);
        OK(fresh, skein_snapshot_read(fresh, bytes, written));
        skein_world *const worlds[] = {one, other, fresh};
        uint64_t hash[COUNT(worlds)];
        for (size_t w = 0; w < COUNT(worlds); w++) {
            lead(worlds[w], who, 3, 20);
            hash[w] = skein_world_hash(worlds[w]);
        }
        assert_true(hash[0] == hash[1] && hash[0] == hash[2]);
        free(bytes);
        for (size_t w = 0; w < COUNT(worlds); w++) skein_world_destroy(worlds[w]);
    }
}

/* Pins that a body was built with keep their own tethers, let go and held again or not: nothing is added for them. */
static void pins_of_the_start_stay_as_they_are(void **state) {
    (void)state;
    for (kind k = 0; k < KINDS; k++) {
        skein_handle body;
        skein_world *plain = make(k, "0 3 5 9 11", &body), *again = make(k, "0 3 5 9 11", &body);
        OK(again, skein_particle_pin(again, 4, false));
        OK(again, skein_particle_pin(again, 4, true));
        OK(again, skein_particle_pin(again, 6, true));
        steps(plain, 30, dt);
        steps(again, 30, dt);
        assert_true(skein_world_hash(plain) == skein_world_hash(again));
        skein_world_destroy(plain);
        skein_world_destroy(again);
    }
}

/* A row held by a program: as firm as one held from the start. */
static void a_row_held_later_holds(void **state) {
    (void)state;
    double stretch[2];
    for (int late = 0; late < 2; late++) {
        skein_world *world = new_world("xpbd", 10);
        add_gravity(world);
        OK(world, skein_body_add(world, "cloth", NULL,
                                 SKEIN_SETTINGS(SKEIN_PAIR("grid", 60, 60), SKEIN_TEXT("pins", late ? "" : "top edge"),
                                                SKEIN_VEC3("rotation", 90, 0, 0), SKEIN_REAL("stretch.stiffness", 100)),
                                 NULL));
        for (size_t i = 0; i < 60 && late; i++) OK(world, skein_particle_pin(world, i, true));
        steps(world, 60, dt);
        stretch[late] = statistics_of(world).max_stretch;
        skein_world_destroy(world);
    }
    assert_under(stretch[1], 1.5 * stretch[0] + 1e-4);
}

/* What a cut leaves hanging by nothing falls, whether it was cut before somebody was held or after. */
static void what_is_cut_off_is_let_go(void **state) {
    (void)state;
    for (int first = 0; first < 2; first++) {
        skein_handle body;
        skein_world *world = make(GRID, "", &body);
        if (!first) OK(world, skein_particle_pin(world, 1 + MIDDLE, true));
        if (!first) steps(world, 3, dt);
        uint32_t row[SIDE - 1];
        for (uint32_t c = 0; c + 1 < SIDE; c++) row[c] = 3 * (SIDE - 1) + c;
        OK(world, skein_cut_faces(world, body, row, SIDE - 1));
        if (first) OK(world, skein_particle_pin(world, 1 + MIDDLE, true));
        steps(world, 90, dt);
        assert_true(position_of(world, 1).y < -5);
        assert_true(position_of(world, COUNT_OF).y > -1);
        skein_world_destroy(world);
    }
}

/* ---- memory that runs out ---- */

static size_t left;

static void *take(void *user, size_t size, size_t alignment) {
    (void)user;
    if (!left) return NULL;
    left--;
    return aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
}

static void give(void *user, void *memory, size_t size) {
    (void)user;
    (void)size;
    free(memory);
}

/* The step that wants them says so and changes nothing, however far it got, and the next one has them. */
static void without_memory_a_step_is_taken_later(void **state) {
    (void)state;
    uint64_t hash[2];
    for (int short_of = 0; short_of < 2; short_of++) {
        skein_world_desc desc = skein_default_world_desc();
        desc.allocate = take, desc.release = give, left = SIZE_MAX;
        skein_world *world = skein_world_create(&desc, NULL);
        assert_non_null(world);
        add_gravity(world);
        for (int b = 0; b < 2; b++)
            OK(world, skein_body_add(
                          world, b ? "rope" : "cloth", NULL,
                          b ? SKEIN_SETTINGS(SKEIN_REAL("count", 9)) : SKEIN_SETTINGS(SKEIN_PAIR("grid", 5, 7)), NULL));
        steps(world, 2, dt);
        OK(world, skein_particle_pin(world, 3, true));
        OK(world, skein_particle_pin(world, 38, true));
        const uint64_t before = skein_world_hash(world);
        size_t tries = 0;
        if (short_of) do
                left = tries++;
            while (skein_world_step(world, dt) == SKEIN_ERROR_MEMORY && skein_world_hash(world) == before);
        else steps(world, 1, dt);
        assert_true(!short_of || tries > 10);
        left = SIZE_MAX;
        steps(world, 9, dt);
        hash[short_of] = skein_world_hash(world);
        skein_world_destroy(world);
    }
    assert_true(hash[0] == hash[1]);
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(who_is_grabbed_draws_all_after_it),  cmocka_unit_test(tethers_follow_from_who_is_pinned),
        cmocka_unit_test(pins_of_the_start_stay_as_they_are), cmocka_unit_test(a_row_held_later_holds),
        cmocka_unit_test(what_is_cut_off_is_let_go),          cmocka_unit_test(without_memory_a_step_is_taken_later),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
