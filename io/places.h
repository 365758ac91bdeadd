/* Where the files lie that come with Skein: its scenes, and the modules that are loaded when they are needed.
 *
 * Called by the command, the window and whoever loads a module. A program may run from the folder where it was
 * built, from where it was installed, or from where that was moved to, so they are looked for from the program's own
 * file on. */
#ifndef SKEIN_IO_PLACES_H
#define SKEIN_IO_PLACES_H

#include <stdbool.h>
#include <stddef.h>

enum { IO_PLACE_SIZE = 4096 };

/* The folders that hold scenes, the one to prefer first, each once; `index` from 0. False past the end. They are:
 * what the environment's SKEIN_SCENES names, and no other, if it is set (whether it is there or not); else those of
 * "scenes" in the current folder, "scenes" beside the program (in a build), the installed one, that there are. */
bool io_scenes_folder(size_t index, char path[IO_PLACE_SIZE]);

/* The folders in which a module may lie, whether they are there or not: what SKEIN_MODULES names, and no other, if it
 * is set; else beside the program, and where modules are installed. False past the end. */
bool io_modules_folder(size_t index, char path[IO_PLACE_SIZE]);

#endif
