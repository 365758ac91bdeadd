/* Shader programs, from the files in render/shaders/ that the build turns into C (embed.cmake).
 *
 * Called by the files that draw. A stage is made of several files, put one after the other; each
 * begins with common.glsl, which holds #version and what all stages share. */
#ifndef SKEIN_RENDER_SHADER_H
#define SKEIN_RENDER_SHADER_H

#include "skein/skein.h"

/* What embed.cmake writes: every file by name, ending with a NULL name. */
typedef struct render_shader_file {
    const char *name; /* "sky.frag.glsl" */
    const char *text;
} render_shader_file;
extern const render_shader_file render_shader_files[];

/* Links a program of a vertex stage and a fragment stage. Both are lists of file names with commas
 * between them ("shadow,surface.frag": ".glsl" is added), after common.glsl; fragment may be NULL.
 * 0 on failure: `error` holds the driver's words. */
unsigned render_shader_link(const char *vertex, const char *fragment, skein_error *error);
/* The same of a compute stage alone. */
unsigned render_shader_link_compute(const char *files, skein_error *error);

#endif
