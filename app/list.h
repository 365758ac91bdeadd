/* skein list for people (list.c) and for programs (list_json.c), and of scenes (list_scenes.c). */
#ifndef SKEIN_APP_LIST_H
#define SKEIN_APP_LIST_H

#include <jansson.h>

#include "app/command.h"

/* A kind with all of its fields, those that every kind of its category has among them. */
json_t *app_kind_json(const skein_kind *kind);

/* list.c: a name, and words about it in lines of their own column. */
void app_print_row(const char *name, const char *words);
/* list_scenes.c: the scenes that come with the program; an exit status. */
int app_list_scenes(bool as_json);

#endif
