/* Bullet's soft body, made of the same particles and springs as the world beside it. */
#ifndef SKEIN_BENCH_BULLET_H
#define SKEIN_BENCH_BULLET_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct bullet_scene {
    const double *positions, *masses; /* particle_count x 3, kg (0: held) */
    size_t particle_count;
    const uint32_t *pairs; /* pair_count x 2, in the order of sweeps */
    size_t pair_count;
    int iterations;   /* sweeps a frame */
    double drag;      /* 1/s */
    bool floor, ball; /* what is there to fall on */
    double floor_height, ball_height, ball_radius, friction, thickness;
} bullet_scene;

typedef struct bullet_world bullet_world;

bullet_world *bullet_create(const bullet_scene *scene);
void bullet_step(void *world); /* 1/60 s */
void bullet_positions(const bullet_world *world, double *xyz);
void bullet_destroy(bullet_world *world);

#ifdef __cplusplus
}
#endif
#endif
