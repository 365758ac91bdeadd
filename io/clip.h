/* Clips: a body's motion, or one frame of it, as a file for other programs.
 *
 *   grows with the run       pc2  mdd  glb  usda      one file of all frames
 *   one frame, one file      obj  ply  stl            the last frame; or a sequence, NAME_0000.obj, NAME_0010.obj ...
 *
 * Owns: what all of these formats share: the parameters, the body as a file needs it, and how axes and units change.
 * Each format is one file, with its table of fields, and one row in io/exporters.c. Called by app/clips.c and by
 * tests. Invariant: positions come already placed (io_clip_place()); a file stands under its final name only when it is
 * complete; numbers that are not finite are refused by the formats that other programs could not read then.
 */
#ifndef SKEIN_IO_CLIP_H
#define SKEIN_IO_CLIP_H

#include "io/mesh.h"

typedef enum io_up { IO_UP_Y, IO_UP_Z } io_up;

/* Parameters of every format; each has the fields that mean something to it. */
typedef struct io_clip_params {
    int32_t every;   /* frames from one sample to the next; 0: only the last frame */
    int32_t up;      /* an io_up */
    int32_t normals; /* a skein_normals */
    double scale;    /* a metre's length in the file */
} io_clip_params;

/* The fields that formats share. The file's axes: y up as in Skein, or x, -z, y. */
#define IO_CLIP_FIELD_EVERY(initial_, least_, help_)                                                           \
    {                                                                                                          \
        .name = "every", .type = SKEIN_FIELD_INT, .offset = offsetof(io_clip_params, every), .unit = "frames", \
        .initial = {initial_, 0, 0}, .least = least_, .most = 1000000, .help = help_                           \
    }
#define IO_CLIP_FIELD_UP                                                                                \
    {                                                                                                   \
        .name = "up", .type = SKEIN_FIELD_CHOICE, .offset = offsetof(io_clip_params, up), .unit = "",   \
        .initial = {IO_UP_Y, 0, 0}, .least = IO_UP_Y, .most = IO_UP_Z, .choices = "y|z",                \
        .help = "the axis that points up: y as in Skein, or z as in Blender (x, y, z becomes x, -z, y)" \
    }
#define IO_CLIP_FIELD_SCALE                                                                                  \
    {                                                                                                        \
        .name = "scale", .type = SKEIN_FIELD_REAL, .offset = offsetof(io_clip_params, scale), .unit = "1/m", \
        .initial = {1, 0, 0}, .least = 1e-6, .most = 1e6,                                                    \
        .help = "length of a metre in the file: 100 where the other program's unit is a centimetre"          \
    }
#define IO_CLIP_FIELD_NORMALS                                                                                   \
    {                                                                                                           \
        .name = "normals", .type = SKEIN_FIELD_CHOICE, .offset = offsetof(io_clip_params, normals), .unit = "", \
        .initial = {SKEIN_NORMALS_AREA, 0, 0}, .least = SKEIN_NORMALS_AREA, .most = SKEIN_NORMALS_ANGLE,        \
        .choices = "area|uniform|angle",                                                                        \
        .help = "what a face counts in its vertices' normals: its area, one, or its angle at the vertex"        \
    }

/* A body, as files need it. What it points to need not outlive the call. */
typedef struct io_clip {
    const char *name;       /* of the body */
    skein_mesh mesh;        /* positions: of the present frame, placed */
    const float *corner_uv; /* face_vertex_count x 2, or NULL */
    double fps;             /* frames a second; a sample comes each params->every of them */
    uint32_t samples;       /* as many as come if nothing stops the run */
    const io_mesh *read;    /* the mesh as it was read, of the same faces, and from where; NULL: none */
    const char *read_path;
    const io_clip_params *params;
} io_clip;

/* A format. Either the first five calls are there, for a file that grows, or `write`. */
typedef struct io_clip_format {
    skein_kind kind;
    const char *ending; /* ".mdd" */
    bool by_default;    /* written where a scene names no outputs */
    bool needs_faces;   /* a body without any cannot be shown */
    bool keeps_marks;   /* wants `read` */
    void *(*create)(const io_clip *clip, const char *path, skein_error *error);   /* NULL on failure */
    skein_status (*add)(void *file, const double *positions, skein_error *error); /* vertices x 3, placed */
    skein_status (*commit)(void *file, skein_error *error);                       /* frees, in any case */
    /* Keeps the whole samples that there are, under another path, and frees; after a failure to add one, too. Where
     * there is none it fails, and nothing is left. */
    skein_status (*keep)(void *file, const char *path, skein_error *error);
    void (*abandon)(void *file); /* NULL is allowed */
    skein_status (*write)(const io_clip *clip, const char *path, skein_error *error);
} io_clip_format;

extern const io_clip_format io_clip_obj, io_clip_pc2, io_clip_mdd, io_clip_glb, io_clip_usda, io_clip_ply, io_clip_stl;

/* The formats, `index` from 0; NULL past the end. */
const io_clip_format *io_clip_format_at(size_t index);
/* That of an exporter's name ("mdd"), and that of a path's ending in any case ("a/cape.MDD"); or NULL. */
const io_clip_format *io_clip_format_named(const char *name);
const io_clip_format *io_clip_format_of(const char *path);

/* Turns and scales positions, count x 3, from Skein's axes and metres to those of the file. */
void io_clip_place(const io_clip_params *params, double *positions, size_t count);

/* Writes the present frame as OBJ (io/obj_write.c). */
skein_status io_obj_write_clip(const io_clip *clip, const char *path, skein_error *error);

/* ---- For the formats ------------------------------------------------------------------------- */

/* Fails where a position is not finite as a float: no reader knows what to do with it. */
skein_status io_clip_check_positions(const char *path, const double *positions, size_t count, skein_error *error);
/* Appends `size` bytes of a part file from `offset` on, of another output that was flushed, to this one. */
void io_clip_append_part(io_output *output, const char *part, uint64_t offset, uint64_t size);

#endif
