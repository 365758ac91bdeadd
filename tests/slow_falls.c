/* What falls far in a substep on a pinned edge, a corner or a border stops there: no edge goes through a face in any
 * frame, by the library's own count and by ours, for any threads, and from a snapshot taken in the midst of it. What
 * comes goes by several cells in a substep (contact/yield.c). */
#include "crossings.h"

typedef struct fall {
    const char *method;
    int substeps, side;
    double height; /* m, of what falls; what hangs is pinned at 1.5 m if it is upright, else at 1, */
    const char *pins;
    double turned, yaw; /* degrees */
    double lower;       /* m: or so much lower */
} fall;

/* Up to 10 m/s, 23 mm in a substep, more than a cell. */
static const fall falls[] = {
    {"xpbd", 5, 40, 3.5, "top edge", 90, 20, 0},
    {"xpbd", 5, 50, 4, "top edge", 90, 20, 0},
    {"xpbd", 10, 50, 7, "top edge", 90, 20, 0},
    {"xpbd", 3, 40, 2.5, "top edge", 90, 45, 0},
    {"xpbd", 5, 40, 3.5, "top edge", 90, 90, 0},
    {"xpbd", 5, 40, 3.5, "top corners", 90, 20, 0},
    {"xpbd", 5, 40, 3.5, "top edge, bottom edge", 0, 20, 0},
    {"xpbd", 5, 40, 3.5, "top edge", 30, 20, 0},
    {"pbd", 10, 40, 3.5, "top edge", 90, 75, 0},
    {"backward_euler", 5, 30, 3.5, "top edge", 90, 20, 0},
};

static skein_world *world_of(const fall *f, int threads) {
    skein_world_desc desc = skein_default_world_desc();
    desc.thread_count = threads;
    skein_world *world = skein_world_create(&desc, NULL);
    assert_non_null(world);
    OK(world, skein_method_set(world, f->method, SKEIN_SETTINGS(SKEIN_REAL("substeps", f->substeps))));
    add_gravity(world);
    OK(world, skein_force_add(world, "contact", SKEIN_SETTINGS(SKEIN_REAL("thickness", 0.006)), NULL));
    OK(world, skein_body_add(world, "cloth", NULL,
                             SKEIN_SETTINGS(SKEIN_TEXT("name", "edge"), SKEIN_PAIR("grid", f->side, f->side),
                                            SKEIN_TEXT("pins", f->pins), SKEIN_VEC3("position", 0, 1 - f->lower, 0),
                                            SKEIN_VEC3("rotation", f->turned, 0, 0)),
                             NULL));
    OK(world,
       skein_body_add(world, "cloth", NULL,
                      SKEIN_SETTINGS(SKEIN_PAIR("grid", f->side, f->side), SKEIN_VEC3("position", 0, f->height, 0),
                                     SKEIN_VEC3("rotation", 3, f->yaw, 0)),
                      NULL));
    return world;
}

/* The frame in which it lands. */
static int landing_of(const fall *f) {
    return (int)(60 * sqrt(2 * (f->height - (f->turned > 0 ? 1.5 : 1)) / 9.81));
}

static void it_stops_there(void **state) {
    (void)state;
    for (size_t k = 0; k < COUNT(falls); k++) {
        const fall *f = &falls[k];
        skein_world *world = world_of(f, 1);
        crossing_search all = crossing_begin(world);
        const int land = landing_of(f);
        for (int i = 1; i <= land + 40; i++) {
            steps(world, 1, 1.0 / 60);
            size_t ours = i + 2 < land ? 0 : crossings_now(&all, world), theirs = statistics_of(world).crossings;
            if (ours || theirs)
                fail_msg("fall %zu, frame %d: %zu crossings by our count, %zu by the library's", k, i, ours, theirs);
        }
        // what has landed does not fly up again, and has not fallen on, but for what slides off a sheet that began aslant and swings away, as it does
        // with 100 substeps: it lands with 4.4 to 10.4 m/s
        const bool slides = f->turned > 0 && f->turned < 90;
        double highest = -1, lowest = 9;
        for (size_t i = skein_particle_count(world) / 2; i < skein_particle_count(world); i++) {
            const double y = position_of(world, i).y;
            highest = fmax(highest, y), lowest = fmin(lowest, y);
        }
        if (!(highest > 0 && highest < 2 && lowest > -1.5) && !(slides && lowest < -3 && lowest > -5))
            fail_msg("fall %zu: from %g to %g m", k, lowest, highest);
        crossing_free(&all);
        skein_world_destroy(world);
    }
}

/* Which pairs are known when it lands depends on what has gone on before: it must not count. */
static void it_needs_no_memory_of_its_own(void **state) {
    (void)state;
    static const struct {
        size_t fall;
        int side;
    } some[] = {{0, 40}, {3, 30}, {4, 30}, {3, 26}, {3, 40}, {7, 30}};
    for (size_t k = 0; k < COUNT(some); k++) {
        fall f = falls[some[k].fall];
        f.side = some[k].side;
        const int land = landing_of(&f), end = land + 8;
        skein_world *world = world_of(&f, 1);
        enum { SAVED = 5 };
        void *saved[SAVED];
        size_t size[SAVED];
        for (int i = 0; i < end; i++) {
            const int s = i - (land - 1);
            if (s >= 0 && s < SAVED) {
                size[s] = skein_snapshot_size(world);
                saved[s] = malloc(size[s]);
                OK(world, skein_snapshot_write(world, saved[s], size[s], &size[s]));
            }
            steps(world, 1, 1.0 / 60);
        }
        const uint64_t hash = skein_world_hash(world);
        for (int s = 0; s < SAVED; s++) {
            skein_world *other = world_of(&f, 1 + s % 3);
            OK(other, skein_snapshot_read(other, saved[s], size[s]));
            steps(other, end - (land - 1) - s, 1.0 / 60);
            if (skein_world_hash(other) != hash) fail_msg("fall %zu goes on otherwise from frame %d", k, land - 1 + s);
            skein_world_destroy(other);
            free(saved[s]);
        }
        skein_world_destroy(world);
    }
}

/* An edge is led up by 1.2 m in 0.3 s, under a loose sheet: that is lifted, and what hangs from the edge flies up and
 * does not go through it when it stops. */
static void what_rises_lifts(void **state) {
    (void)state;
    static const int substeps[] = {10, 20};
    for (size_t k = 0; k < COUNT(substeps); k++) {
        fall f = {"xpbd", substeps[k], 30, 1.2, "top edge", 90, 15, 0.7};
        skein_world *world = world_of(&f, 1);
        OK(world,
           skein_motion_add(
               world, "keys", NULL,
               SKEIN_SETTINGS(SKEIN_TEXT("on", "edge"), SKEIN_TEXT("keys", "0 0 0 0, 0.1 0 0 0, 0.4 0 1.2 0")), NULL));
        crossing_search all = crossing_begin(world);
        for (int i = 1; i <= 70; i++) {
            steps(world, 1, 1.0 / 60);
            const size_t ours = crossings_now(&all, world);
            if (ours) fail_msg("%d substeps, frame %d: %zu crossings", substeps[k], i, ours);
        }
        assert_true(position_of(world, 0).y > 1.9 || position_of(world, 29).y > 1.9);
        crossing_free(&all);
        skein_world_destroy(world);
    }
}

int main(void) {
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(it_stops_there),
        cmocka_unit_test(it_needs_no_memory_of_its_own),
        cmocka_unit_test(what_rises_lifts),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
