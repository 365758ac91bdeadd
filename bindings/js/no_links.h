/* Put before files of io/ that ask for it: there are no links in a page, so that each path is what it seems. */
#ifndef SKEIN_JS_NO_LINKS_H
#define SKEIN_JS_NO_LINKS_H

#include <string.h>

#define realpath(path_, room_) strdup(path_)

#endif
