/* Standard output and error, through which nothing passes that would steer a terminal.
 *
 * Labels of a scene, names of files and words of a driver are printed in many places; here is the one place that all of
 * it goes through. Called by main() before anything is printed. */
#ifndef SKEIN_APP_TERMINAL_H
#define SKEIN_APP_TERMINAL_H

/* From here on what is printed to stdout and stderr is cleaned as io/printable.h says. Where the C library has no
 * streams of one's own (it is not glibc), they stay as they are. */
void app_terminal_guard(void);
/* Writes to standard error as it is: for a bar that is drawn again in place. */
void app_terminal_draw(const char *format, ...) __attribute__((format(printf, 1, 2)));

#endif
