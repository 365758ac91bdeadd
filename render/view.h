/* How a world is shown: what is drawn, in which colours, and from where.
 *
 * One struct, described by one table of fields. It comes from a scene's "view", from --set view.FIELD=...,
 * or from a window; world_frame.c and picture.c read it. */
#ifndef SKEIN_RENDER_VIEW_H
#define SKEIN_RENDER_VIEW_H

#include "skein/skein.h"

typedef enum render_shading {
    RENDER_BEAUTIFUL, /* sun with soft shadows, sky, ground light */
    RENDER_BLINN_PHONG
} render_shading;

/* What the colour of surfaces, particles and springs tells. */
typedef enum render_colouring {
    RENDER_BY_MATERIAL,
    RENDER_BY_BODY,
    RENDER_BY_SPEED,
    RENDER_BY_STRAIN,
    RENDER_BY_DIRECTION /* of flight: birds */
} render_colouring;

typedef enum render_shown_particles {
    RENDER_LOOSE_PARTICLES,
    RENDER_ALL_PARTICLES,
    RENDER_NO_PARTICLES
} render_shown_particles;

typedef struct render_view_camera {
    double from[3], at[3]; /* the same: the camera frames the scene by itself */
    double fov, azimuth, elevation, orbit, zoom;
    char *follow; /* the body that it goes along with (world_follow.h); "" for none */
} render_view_camera;

typedef struct render_view {
    int32_t shading; /* a render_shading */
    bool surface, wireframe, springs, constraints, gradients;
    int32_t particles; /* a render_shown_particles */
    bool birds;        /* flocks, else as balls */
    bool pins, normals, velocities, contacts, fields, colliders, ground, grid, axes;
    int32_t colour;  /* a render_colouring */
    double range;    /* the speed or strain at the end of the colours; 0: the largest there is now */
    int32_t pattern; /* 0: as suits the body; else woven, checker or none */
    char *image;     /* path of a picture that is laid on instead of the pattern; "" for none */
    double repeats;  /* along a body's longer side; 0: as suits the pattern */
    double particle_radius, line_width, velocity_scale, gradient_scale;
    double sun[3], exposure;
    render_view_camera camera;
} render_view;

/* The kind "view" with its fields. Its parameters are a render_view. */
const skein_kind *render_view_kind(void);
/* The table's defaults. Its texts are constant: do not free them. */
render_view render_view_default(void);

#endif
