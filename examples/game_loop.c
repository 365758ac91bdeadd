/* A game's loop: frames come as they like, the world takes equal steps of 1/90 s.
 *
 * The pacer keeps the time that is left over for the next frame, and drops what a hitch would pile up.
 * What is drawn lies between the last two states, so that motion is smooth though steps and frames do
 * not fall together. Runs 600 made-up frames, 1/60 s long on average; with the argument "live" it reads
 * a clock instead and takes as long as it simulates. */
#define _POSIX_C_SOURCE 200809L
#include <skein/skein.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { FRAMES = 600 };
static const double frame_seconds = 1.0 / 60;

/* Of a clock that only goes forward: a clock of the day may jump. */
static double clock_seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* The time since the last frame began: uneven, yet 1/60 s on average. */
static double next_frame(bool live, int frame, double *last) {
    static const double uneven[] = {1.0, 0.4, 1.6, 0.7, 1.3};
    if (!live) return uneven[frame % 5] * frame_seconds;
    nanosleep(&(struct timespec){0, (long)(1e9 * frame_seconds)}, NULL); /* in place of drawing */
    double now = clock_seconds(), spent = now - *last;
    *last = now;
    return spent;
}

static void draw(int frame, int steps, double blend, const double corner[3]) {
    if (frame < 10) printf("frame %d: steps %d, blend %.2f, corner at y = %.4f m\n", frame, steps, blend, corner[1]);
}

static skein_status play(skein_world *world, bool live) {
    skein_pacer pacer = skein_default_pacer(); /* steps of 1/90 s, at most 8 a frame */
    double fed = 0, last = clock_seconds();    /* read once everything is loaded: loading takes no world time */
    unsigned taken = 0;
    skein_status status;
    for (int frame = 0; frame < FRAMES; frame++) {
        double seconds = next_frame(live, frame, &last), corner[3];
        int steps = skein_pacer_feed(&pacer, seconds);
        for (int i = 0; i < steps; i++)
            if ((status = skein_world_step(world, pacer.step))) return status;
        double blend = skein_pacer_blend(&pacer);
        if ((status = skein_positions_blend(world, blend, skein_particle_count(world) - 1, 1, corner))) return status;
        draw(frame, steps, blend, corner);
        taken += (unsigned)steps;
        fed += seconds;
    }
    printf("%d frames, %.3f s: %u steps, %.3f s dropped\n", FRAMES, fed, taken, pacer.dropped);
    int steps = skein_pacer_feed(&pacer, 2.0); /* a hitch: the world slows down, the game does not freeze */
    printf("a frame of 2 s: %d steps, %.3f s dropped\n", steps, pacer.dropped);
    return SKEIN_OK;
}

int main(int argc, char **argv) {
    skein_error failure = {0};
    skein_world *world = skein_world_create(NULL, &failure);
    const skein_setting cloth[] = {SKEIN_PAIR("grid", 17, 17), SKEIN_TEXT("pins", "top edge"), SKEIN_END};
    bool good = world && !skein_body_add(world, "cloth", NULL, cloth, NULL) &&
                !skein_force_add(world, "gravity", NULL, NULL) && !play(world, argc > 1 && !strcmp(argv[1], "live"));
    const skein_error *why = world ? skein_world_error(world) : &failure;
    if (!good) fprintf(stderr, "game_loop: %s %s\n", why->where, why->message);
    skein_world_destroy(world);
    return good ? EXIT_SUCCESS : EXIT_FAILURE;
}
