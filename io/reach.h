/* Which files a scene may have read: it may come from a stranger.
 *
 * Called where a file is opened that a scene names (meshes, caches, images). A program that trusts its scenes gives no
 * reach, and nothing is refused. */
#ifndef SKEIN_IO_REACH_H
#define SKEIN_IO_REACH_H

#include "io/scene_settings.h"

/* A scene's files lie in its own folder, in a folder "meshes" beside that, in the current folder, or in what was allowed; links
 * and ".." are followed first. And what the user named himself, in a set, he may. */
struct io_reach {
    const char *const *allowed; /* files, and folders with all in them, NULL-terminated; NULL: none */
    const char *const *sets;    /* as for io_scene_read() */
};

/* Whether the scene may have `path` read, which it calls `file`; if not, that is a fault of `member`. A file that is not
 * there may: whoever opens it says so. */
bool io_reach_check(io_place place, const char *member, const char *file, const char *path);

#endif
