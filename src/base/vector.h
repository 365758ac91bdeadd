/* See <skein/inside/vector.h>; also includes the public header. */
#include <skein/skein.h>

#include <skein/inside/vector.h>
