/* Many pictures of one world, one after the other: what a film is made of.
 *
 *     world --shoot--> drawing goes on by itself --develop--> image
 *
 * Called by the command, for films. Between the two the caller can step the world: the card, or Mesa's own
 * threads, draw meanwhile. Invariant: a studio's context is current on the thread that made it; the camera
 * stands still from the first picture on, or goes round where the view has it orbit. */
#ifndef SKEIN_RENDER_STUDIO_H
#define SKEIN_RENDER_STUDIO_H

#include "render/frame.h"
#include "render/image.h"
#include "render/subject.h"
#include "render/view.h"

typedef struct render_studio render_studio;

/* Pictures of `size` with so many samples a pixel, or the most that the driver has. The view (NULL: the usual one)
 * must outlive the studio. NULL on failure. */
render_studio *render_studio_create(const int32_t size[2], int samples, const render_view *view, skein_error *error);
void render_studio_destroy(render_studio *studio); /* NULL is allowed */

/* The camera shall hold this, too. Before the first picture. */
void render_studio_hold(render_studio *studio, const render_subject *subject);
/* Begins to draw the world as it stands. */
skein_status render_studio_shoot(render_studio *studio, skein_world *world, skein_error *error);
/* Waits for the picture that was begun last. */
skein_status render_studio_develop(render_studio *studio, render_image *image, skein_error *error);

/* The samples a pixel that there are. */
int render_studio_samples(const render_studio *studio);

#endif
