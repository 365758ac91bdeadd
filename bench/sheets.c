/* Milliseconds a frame of hanging sheets, and hashes, of nothing but the library: for machines on which skein_bench does
 * not run. `cmake --build --preset wasm` makes it for WebAssembly:
 *     node --no-warnings tests/wasm/run.mjs build-wasm/bench_sheets
 * Structural springs, both diagonals, skip-one; undamped, two corners held, 10 substeps of XPBD, one thread: w1 of
 * skein_bench in three sizes. The hashes are the same everywhere. */
#include <math.h>
#include <skein/skein.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static double milliseconds(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return 1e3 * (double)t.tv_sec + 1e-6 * (double)t.tv_nsec;
}

static void must(const skein_world *world, skein_status status) {
    if (!status) return;
    fprintf(stderr, "%s\n", skein_world_error(world)->message);
    exit(1);
}

static skein_world *sheet(int side) {
    skein_world_desc desc = skein_default_world_desc();
    desc.thread_count = 1;
    skein_world *world = skein_world_create(&desc, NULL);
    if (!world) exit(1);
    const skein_setting cloth[] = {SKEIN_PAIR("grid", side, side),
                                   SKEIN_REAL("density", 0.2),
                                   SKEIN_TEXT("pins", "top corners"),
                                   SKEIN_REAL("stretch.stiffness", 1e4),
                                   SKEIN_REAL("shear.stiffness", 1e4),
                                   SKEIN_TEXT("bend.by", "springs"),
                                   SKEIN_REAL("bend.stiffness", 1e4),
                                   SKEIN_REAL("stretch.damping", 0),
                                   SKEIN_REAL("shear.damping", 0),
                                   SKEIN_REAL("bend.damping", 0),
                                   SKEIN_REAL("stretch.limit", INFINITY),
                                   SKEIN_REAL("stretch.tether", INFINITY),
                                   SKEIN_END};
    must(world, skein_body_add(world, "cloth", NULL, cloth, NULL));
    must(world, skein_force_add(world, "gravity", NULL, NULL));
    must(world, skein_method_set(world, "xpbd", SKEIN_SETTINGS(SKEIN_REAL("substeps", 10))));
    return world;
}

int main(void) {
    static const struct {
        int side;
        double bar; /* ms as WebAssembly in node */
    } sheets[] = {{32, 0.35}, {64, 1.2}, {128, 3}};
    enum { FRAMES = 300, SOON = 60 };
    printf("sheet       least ms a frame  WebAssembly's bar  hash after %d frames\n", SOON);
    for (size_t i = 0; i < sizeof sheets / sizeof *sheets; i++) {
        skein_world *world = sheet(sheets[i].side);
        double least = INFINITY;
        unsigned long long hash = 0;
        for (int frame = 1; frame <= FRAMES; frame++) {
            double start = milliseconds();
            must(world, skein_world_step(world, 1.0 / 60));
            least = fmin(least, milliseconds() - start);
            if (frame == SOON) hash = skein_world_hash(world);
        }
        printf("%3d x %3d   %16.3f  %17.2f  %016llx\n", sheets[i].side, sheets[i].side, least, sheets[i].bar, hash);
        skein_world_destroy(world);
    }
    return 0;
}
