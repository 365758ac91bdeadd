/* The gallery's scenes and their pictures, on the stage's side. */
#ifndef SKEIN_VIEWER_GALLERY_H
#define SKEIN_VIEWER_GALLERY_H

#include "viewer/stage.h"

enum { VIEWER_CARD_WIDTH = 288, VIEWER_CARD_HEIGHT = 162 };

#endif
