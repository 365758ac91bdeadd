/* A frame: all that is in one picture, as plain data.
 *
 *     world --world_frame.c--> frame --draw.c--> target --> image, film or window
 *
 * Whoever wants a picture fills a frame (world_frame.c does it from a world; tests do it by hand);
 * draw.c reads it. A frame owns nothing: every pointer belongs to whoever filled it and must live until
 * the frame is drawn. Lengths are metres, y is up. Colours are as a screen shows them (sRGB), 0 to 1. */
#ifndef SKEIN_RENDER_FRAME_H
#define SKEIN_RENDER_FRAME_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "render/colours.h"
#include "render/image.h"

typedef enum render_pattern {
    RENDER_PLAIN,
    RENDER_CHECKER, /* squares of colour and accent, by UV */
    RENDER_WEAVE,   /* gingham: woven bands of colour and accent with fine threads, by UV */
    RENDER_IMAGE,   /* the frame's image, by UV */
    RENDER_VALUES   /* the surface's values as colours of its map */
} render_pattern;

typedef struct render_material {
    float colour[3]; /* the front */
    float accent[3]; /* the pattern's other colour */
    float lining[3]; /* the back */
    render_pattern pattern;
    float repeats[2];   /* how often the pattern repeats along u and v */
    float translucency; /* light that passes through from behind, 0 to 1 */
    bool glazed;        /* smooth and lit through, as jelly is: it mirrors the sky; else cloth */
} render_material;

/* A triangle mesh, drawn with smooth normals that the renderer computes. */
typedef struct render_surface {
    const double *positions; /* vertex_count x 3 */
    size_t vertex_count;
    const uint32_t *triangles; /* triangle_count x 3, each below vertex_count */
    size_t triangle_count;
    const uint32_t *weld; /* whose normal each vertex takes: its own, or that of one at its place; or NULL */
    const float *uv;      /* vertex_count x 2; or NULL: neither pattern nor image is drawn */
    bool rows_first;      /* u goes down an image and v across, as in a grid; else u goes across and v up */
    const float *values;  /* vertex_count, 0 to 1, for RENDER_VALUES; or NULL */
    render_colour_map map;
    bool scenery;   /* the picture need not hold all of it: terrain */
    uint64_t shape; /* changes whenever triangles, weld or uv do; 0: they may be new every frame */
    render_material material;
} render_surface;

/* An infinite plane. One that lies level is drawn as ground out to the horizon, others as a slab
 * about as large as the rest of the picture. */
typedef struct render_plane {
    double point[3];
    double normal[3]; /* towards the free side; of any length */
} render_plane;

typedef struct render_sphere {
    double centre[3];
    double radius;
    double rotation[9]; /* rows of a rotation matrix; turns the marking */
    float colour[3], marking[3];
} render_sphere;

/* All that is within a radius of a box: a box with round edges, or a rod with round ends where only the first
 * extent is over 0. A box's edges are marked; so are a rod's ends and a line along it. */
typedef struct render_solid {
    double centre[3];
    double extent[3]; /* half the inner box's sides */
    double radius;
    double rotation[9]; /* rows of a rotation matrix */
    float colour[3], marking[3];
} render_solid;

/* The lower part of a hollow sphere: its far wall is solid to the eye, the near one is glass. */
typedef struct render_bowl {
    double centre[3];
    double radius;
    double rotation[9]; /* turns the marking; the rim stays level */
    float colour[3], marking[3];
} render_bowl;

/* Particles as little balls of one size and colour. */
typedef struct render_points {
    const double *positions; /* count x 3 */
    size_t count;
    double radius;
    float colour[3];
    const float *colours; /* count x 3; or NULL: all have the one colour */
} render_points;

/* A flock: birds that fly along their velocities (render/birds.h). */
typedef enum render_feathers {
    RENDER_OWN_FEATHERS,
    RENDER_BY_DIRECTION_FEATHERS,
    RENDER_ONE_FEATHER,
    RENDER_BY_SPEED_FEATHERS
} render_feathers;
typedef struct render_birds {
    size_t count;
    const float *positions, *velocities; /* count x 4; the fourth is not used */
    /* Or OpenGL's buffers of the same in this context, 0 if there are none. The i-th bird is in slots[i]; or, where
     * that is NULL, bird_buffer holds the bird of every slot. */
    unsigned position_buffer, velocity_buffer, bird_buffer;
    const uint32_t *slots;
    double span; /* from tip to tip */
    render_feathers paint;
    float colour[3];
    double range;                       /* m/s: the speed at the end of the colours */
    double least[3], most[3];           /* the box that they are in, about */
    double core_least[3], core_most[3]; /* and the one without strays */
} render_birds;

/* Straight lines, `width` pixels wide wherever they are. */
typedef struct render_lines {
    const double *positions; /* count x 6: both ends */
    size_t count;
    double width;
    float colour[3];
    const float *colours; /* count x 3; or NULL: all have the one colour */
    bool aside;           /* a note beside the picture: neither camera nor light make room for it */
} render_lines;

/* Light and surroundings. Start from render_default_look(). */
typedef struct render_look {
    double sun[3];     /* direction to the sun, of any length */
    double sun_spread; /* degrees from the sun's middle to its rim: how soft shadows are */
    float zenith[3];   /* the sky straight above */
    float horizon[3];  /* the sky at the horizon; the ground fades into it */
    float ground[3];   /* the ground's own colour */
    double exposure;   /* 1 is as it is */
    bool plain;        /* Blinn-Phong: no shadows, the same light from all sides */
    bool grid;         /* lines on the ground */
    bool floor;        /* a ground of no effect, where no plane gives one */
    double floor_height;
} render_look;

typedef struct render_frame {
    const render_surface *surfaces;
    size_t surface_count;
    const render_plane *planes;
    size_t plane_count;
    const render_sphere *spheres;
    size_t sphere_count;
    const render_solid *solids; /* few: colliders */
    size_t solid_count;
    const render_solid *rods; /* many: pieces of ropes; drawn more coarsely */
    size_t rod_count;
    const render_bowl *bowls;
    size_t bowl_count;
    const render_points *points;
    size_t points_count;
    const render_birds *birds;
    size_t bird_count;
    const render_lines *lines;
    size_t lines_count;
    const render_image *image; /* for RENDER_IMAGE; NULL: there is none */
    uint64_t image_number;     /* changes whenever the image does; not 0 */
    render_look look;
    double time;              /* s: what moves by itself in a picture, as wings do, stands as it would then */
    double middle[3], radius; /* what haze and grid are measured by; radius 0: by what is in the frame */
    double anchor[3];         /* where the middle was at first: slabs go along with it, their grids do not */
} render_frame;

/* A box along the axes; empty while least > most. */
typedef struct render_bounds {
    double least[3], most[3];
} render_bounds;

/* A frame with nothing in it, under the default light. */
render_frame render_default_frame(void);
render_look render_default_look(void);
/* Gingham in a warm colour, another one for each `index`; and the same in one softer colour. */
render_material render_default_material(size_t index);
render_material render_plain_material(size_t index);
/* Jelly of that colour. */
render_material render_jelly_material(size_t index);
/* A painted ball at the origin: radius 1, not turned. In the same paint: a cube with a side of 2, a bowl. */
render_sphere render_default_sphere(void);
render_solid render_default_solid(void);
render_bowl render_default_bowl(void);
/* The height of a bowl's rim above its lowest point, and the rim's radius; in radii of its sphere. */
extern const double render_bowl_height, render_bowl_width;

/* The box around everything finite: surfaces, spheres, solids, bowls, points, lines. Points that are not finite
 * do not count. */
render_bounds render_frame_bounds(const render_frame *frame);
render_bounds render_bounds_nothing(void);
bool render_bounds_empty(const render_bounds *bounds);
void render_bounds_add(render_bounds *bounds, const double point[3], double radius);
/* Half the box's diagonal; 0 for an empty one. */
double render_bounds_radius(const render_bounds *bounds);
void render_bounds_centre(const render_bounds *bounds, double centre[3]);

#endif
