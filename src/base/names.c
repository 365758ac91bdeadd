/* Lists of names, and what bodies are called. */
#include "base/names.h"

#include <string.h>

sk_word sk_word_of(const char *text) {
    return (sk_word){text, strlen(text)};
}

bool sk_word_is(sk_word word, const char *name) {
    return !strncmp(name, word.at, word.length) && !name[word.length];
}

sk_word sk_names_next(const char **list, const char *between) {
    const char *at = *list;
    while (*at && (*at == ' ' || strchr(between, *at))) at++;
    sk_word word = {at, strcspn(at, between)};
    *list = at + word.length;
    while (word.length && at[word.length - 1] == ' ') word.length--;
    return word;
}

static bool are_same(sk_word a, sk_word b) {
    return a.length == b.length && !memcmp(a.at, b.at, a.length);
}

bool sk_names_have(const char *names, sk_word name) {
    if (!name.length) return false;
    if (sk_word_is(name, names)) return true;
    for (sk_word word; (word = sk_names_next(&names, ",")).length;)
        if (are_same(word, name)) return true;
    return false;
}

bool sk_is_called(const char *name, const char *groups, sk_word word) {
    return (word.length && sk_word_is(word, name)) || sk_names_have(groups, word);
}

bool sk_names_mean(const char *names, const char *name, const char *groups) {
    if (sk_names_have(names, sk_word_of(name))) return true;
    for (sk_word group; (group = sk_names_next(&groups, ",")).length;)
        if (sk_names_have(names, group)) return true;
    return false;
}

static sk_word trimmed(const char *at, const char *end) {
    while (at < end && *at == ' ') at++;
    while (end > at && end[-1] == ' ') end--;
    return (sk_word){at, (size_t)(end - at)};
}

bool sk_pairs_next(const char **pairs, sk_word pair[2]) {
    const char *at = *pairs, *end = at + strcspn(at, ","), *colon = memchr(at, ':', (size_t)(end - at));
    if (!*at) return false;
    pair[0] = trimmed(at, colon ? colon : end);
    pair[1] = colon ? trimmed(colon + 1, end) : pair[0];
    *pairs = end + (*end == ',');
    return true;
}

bool sk_pairs_mean(const char *pairs, const char *name, const char *groups, const char *other,
                   const char *others_groups) {
    for (sk_word pair[2]; sk_pairs_next(&pairs, pair);)
        for (int k = 0; k < 2; k++)
            if (sk_is_called(name, groups, pair[k]) && sk_is_called(other, others_groups, pair[1 - k])) return true;
    return false;
}
