/* Texts of a scene or a mesh, made fit to be printed: what would steer a terminal shows as '?'.
 *
 * That is control characters (those of ASCII, and U+0080 to U+009F, which some terminals obey as well), marks that turn
 * the direction of writing round, and bytes that are not UTF-8. Other letters stay as they are.
 *
 * Owns: that judgement. Called by the scene reader for its faults, and by the command for all that it prints. */
#ifndef SKEIN_IO_PRINTABLE_H
#define SKEIN_IO_PRINTABLE_H

#include <stdbool.h>
#include <stddef.h>

/* The length of the letter at `text`, of `left` bytes; `fine`: whether it may be printed. 0: more bytes are needed to
 * tell. A line's end and a tab are fine. */
size_t io_printable_letter(const char *text, size_t left, bool *fine);
/* Replaces, in place, what may not be printed; where not `lines`, line ends and tabs too. */
void io_printable(char *text, bool lines);

#endif
