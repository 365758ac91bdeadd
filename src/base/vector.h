/* What <skein/inside/vector.h> says, and the public header. */
#include <skein/skein.h>

#include <skein/inside/vector.h>
