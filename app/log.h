/* run.csv: a line of measures for each step. */
#ifndef SKEIN_APP_LOG_H
#define SKEIN_APP_LOG_H

#include <skein/skein.h>

typedef struct app_log app_log;

/* Begins a file with its header; NULL after a printed fault. */
app_log *app_log_begin(const char *path);
void app_log_line(app_log *log, const skein_statistics *statistics);
/* The line that was written last; and a line as it was written once. */
const char *app_log_last(const app_log *log);
void app_log_text(app_log *log, const char *line);
/* Gives the file its name, or prints why it cannot be; frees the log. NULL is allowed, and true. */
bool app_log_finish(app_log *log);

#endif
