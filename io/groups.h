/* Groups of bodies, where one body alone can be meant. */
#ifndef SKEIN_IO_GROUPS_H
#define SKEIN_IO_GROUPS_H

#include <skein/skein.h>

/* What is to be said besides of a name that no body has: that it is a group's, or "". */
const char *io_group_words(const skein_world *world, const char *name);

#endif
