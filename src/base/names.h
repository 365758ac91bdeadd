/* Lists of names, as texts hold them, "cape, flag", and what a body is called: by its own name and by the groups that it is
 * in. A rule that names either means the body. */
#ifndef SK_BASE_NAMES_H
#define SK_BASE_NAMES_H

#include <stdbool.h>
#include <stddef.h>

/* A name within a text: where it begins, and how long it is. */
typedef struct sk_word {
    const char *at;
    size_t length;
} sk_word;

sk_word sk_word_of(const char *text);
bool sk_word_is(sk_word word, const char *name);
/* The next name of a list without the blanks around it, between any of these characters; its length is 0 at the end. */
sk_word sk_names_next(const char **list, const char *between);
/* Whether a list has this name: it is the name, commas and all, or has it between commas. No list has the empty name. */
bool sk_names_have(const char *names, sk_word name);
/* Whether a body of that name, in these groups, is called so. */
bool sk_is_called(const char *name, const char *groups, sk_word word);
/* Whether a list has the body's name or one of its groups. */
bool sk_names_mean(const char *names, const char *name, const char *groups);
/* The next of pairs of names, "cape:shirt, cape:cape", without blanks; what has no colon is a name twice. False at the end. */
bool sk_pairs_next(const char **pairs, sk_word pair[2]);
/* Whether one of such pairs is two bodies, in either order. */
bool sk_pairs_mean(const char *pairs, const char *name, const char *groups, const char *other,
                   const char *others_groups);

#endif
