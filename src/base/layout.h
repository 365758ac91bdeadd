/* See <skein/inside/layout.h>. */
#include <skein/inside/layout.h>
