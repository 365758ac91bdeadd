/* Names of groups where a body's name is expected: said in words. */
#include "io/groups.h"

#include <string.h>

static bool has(const char *groups, const char *name) {
    size_t wanted = strlen(name);
    while (*groups) {
        groups += strspn(groups, ", ");
        size_t length = strcspn(groups, ","), end = length;
        while (end && groups[end - 1] == ' ') end--;
        if (end && end == wanted && !strncmp(groups, name, end)) return true;
        groups += length;
    }
    return false;
}

const char *io_group_words(const skein_world *world, const char *name) {
    for (size_t i = 0; i < skein_object_count(world, SKEIN_BODY); i++) {
        skein_value groups;
        if (!skein_get(world, skein_object_at(world, SKEIN_BODY, i), "groups", &groups) && has(groups.text, name))
            return "; it is the name of a group, and one body is meant";
    }
    return "";
}
