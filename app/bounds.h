/* How much of the machine a command may take: --max-memory and --max-time. */
#ifndef SKEIN_APP_BOUNDS_H
#define SKEIN_APP_BOUNDS_H

#include "app/command.h"

/* Bounds this process by its options, where it has them; false after a printed fault. */
bool app_bounds_set(const app_arguments *arguments);
/* The end of the command: a run that its time ended is no good one. Returns the status to end with. */
int app_bounds_end(const app_arguments *arguments, int status);
/* Says which bound it was, behind an error about memory. */
void app_bounds_explain(skein_status status);

#endif
