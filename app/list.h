/* skein list for people (list.c) and for programs (list_json.c). */
#ifndef SKEIN_APP_LIST_H
#define SKEIN_APP_LIST_H

#include <jansson.h>

#include "app/command.h"

/* A kind with all of its fields, those that every kind of its category has among them. */
json_t *app_kind_json(const skein_kind *kind);

#endif
