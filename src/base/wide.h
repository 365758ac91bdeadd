/* See <skein/inside/wide.h>. */
#include <skein/inside/wide.h>
