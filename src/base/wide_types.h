/* See <skein/inside/wide_types.h>. */
#include <skein/inside/wide_types.h>
