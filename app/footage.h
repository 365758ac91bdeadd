/* A film of a world while it is stepped: drawing, and a film that takes the pictures.
 *
 * Used by `skein render`, and by `skein run` for the exporter "film". A picture is drawn while the world takes
 * its next steps, and encoded by a thread of its own. */
#ifndef SKEIN_APP_FOOTAGE_H
#define SKEIN_APP_FOOTAGE_H

#include "app/command.h"
#include "film/film.h"

typedef struct app_footage app_footage;

/* Opens everything that can fail (OpenGL, encoder, file), then looks ahead through `frames` frames, with a
 * world of its own, to place the camera. Notes what it changed (an odd size, say) unless `quiet`. NULL after a
 * printed fault. */
app_footage *app_footage_begin(const app_scene *loaded, const char *path, const film_options *options, int frames,
                               bool quiet);
/* Takes the world's present state as the next frame. False after a printed fault. */
bool app_footage_frame(app_footage *footage);

typedef struct app_footage_facts {
    int pictures, size[2];
    double rate; /* at which they play */
} app_footage_facts;

/* Completes the film. False after a printed fault. Frees the footage in any case; `facts` may be NULL. */
bool app_footage_end(app_footage *footage, app_footage_facts *facts);
/* Ends without a film. NULL is allowed. */
void app_footage_abandon(app_footage *footage);

#endif
