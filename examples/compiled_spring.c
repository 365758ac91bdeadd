/* A formula at compiled speed: a net of springs that breathe, twice, on the formula's tape and on code that was
 * compiled with this program. Both move to the last bit alike.
 *
 * The formula became C beforehand:
 *     skein formula 'length(p0 - p1) - L * (1 + 0.2 * sin(t))' --param L=1 --emit c --name spring \
 *         > examples/compiled_spring/spring.c
 * which is compiled like any other file; for speed, with the flags that its first lines name. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <skein/formula.h>

extern const skein_compiled spring; /* examples/compiled_spring/spring.c */

enum { SIDE = 200, STEPS = 30 };

static void need(skein_world *world, skein_status status) {
    if (!status) return;
    fprintf(stderr, "%s: %s\n", skein_world_error(world)->where, skein_world_error(world)->message);
    exit(1);
}

static skein_world *make_net(void) {
    static double positions[SIDE * SIDE][3], masses[SIDE * SIDE];
    static uint32_t pairs[2 * SIDE * SIDE][2];
    size_t count = 0;
    for (uint32_t i = 0; i < SIDE * SIDE; i++) {
        positions[i][0] = 0.01 * (i % SIDE), positions[i][1] = 0, positions[i][2] = 0.01 * (i / SIDE);
        masses[i] = i < SIDE ? 0 : 1e-4; // the first row is held
        if (i % SIDE) pairs[count][0] = i - 1, pairs[count++][1] = i;
        if (i / SIDE) pairs[count][0] = i - SIDE, pairs[count++][1] = i;
    }
    skein_world *world = skein_world_create(NULL, NULL);
    if (!world) exit(1);
    need(world, skein_method_set(world, "xpbd", SKEIN_SETTINGS(SKEIN_REAL("substeps", 10))));
    need(world, skein_force_add(world, "gravity", NULL, NULL));
    need(world, skein_particles_add(world, SIDE * SIDE, positions[0], NULL, masses, NULL));
    need(world, skein_constraint_add(world, "formula", pairs[0], count,
                                     SKEIN_SETTINGS(SKEIN_TEXT("constraint", "length(p0 - p1) - L * (1 + 0.2 * sin(t))"),
                                                    SKEIN_REAL("parameters.L", 0.01), SKEIN_REAL("stiffness", 1000)),
                                     NULL));
    return world;
}

/* Milliseconds a step. */
static double run(skein_world *world) {
    need(world, skein_world_step(world, 1.0 / 60));
    clock_t start = clock();
    for (int i = 0; i < STEPS; i++) need(world, skein_world_step(world, 1.0 / 60));
    return 1e3 * (double)(clock() - start) / CLOCKS_PER_SEC / STEPS;
}

int main(void) {
    skein_world *on_tape = make_net(), *compiled = make_net();
    need(compiled, skein_formula_register(compiled, &spring)); // this one call is all
    if (!skein_formula_is_compiled(compiled, skein_object_at(compiled, SKEIN_CONSTRAINT, 0))) return 1;
    printf("%d springs: %.2f ms a step by tape, ", 2 * SIDE * (SIDE - 1), run(on_tape));
    printf("%.2f ms compiled\n", run(compiled));
    bool same = skein_world_hash(on_tape) == skein_world_hash(compiled);
    printf("state %016llx, %s\n", (unsigned long long)skein_world_hash(compiled), same ? "both" : "NOT the same");
    skein_world_destroy(on_tape);
    skein_world_destroy(compiled);
    return same ? 0 : 1;
}
