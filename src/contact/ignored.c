/* Pairs of bodies that a rule of contact does not let meet: "cape:shirt, cape:cape", by their names. */
#include <string.h>

#include "contact/touch.h"

/* A name of the text: where it begins, and how long it is. */
typedef struct word {
    const char *at;
    size_t length;
} word;

static word trimmed(const char *at, const char *end) {
    while (at < end && *at == ' ') at++;
    while (end > at && end[-1] == ' ') end--;
    return (word){at, (size_t)(end - at)};
}

/* The next pair; false at the end. What has no colon is a body that does not meet itself. */
static bool next_pair(const char **text, word pair[2]) {
    const char *at = *text, *end = at + strcspn(at, ","), *colon = memchr(at, ':', (size_t)(end - at));
    if (!*at) return false;
    pair[0] = trimmed(at, colon ? colon : end);
    pair[1] = colon ? trimmed(colon + 1, end) : pair[0];
    *text = end + (*end == ',');
    return true;
}

static bool is(const word *w, const char *name) {
    return strlen(name) == w->length && !memcmp(name, w->at, w->length);
}

/* The number of a body among those that the text names, by the first place of its name there; 0 for any other. */
static size_t number_of(const char *text, const char *name) {
    word pair[2];
    for (size_t number = 1; name[0] && next_pair(&text, pair); number += 2)
        for (size_t k = 0; k < 2; k++)
            if (is(&pair[k], name)) return number + k;
    return 0;
}

static size_t number_of_word(const char *text, const word *w) {
    word pair[2];
    for (size_t number = 1; next_pair(&text, pair); number += 2)
        for (size_t k = 0; k < 2; k++)
            if (pair[k].length == w->length && !memcmp(pair[k].at, w->at, w->length)) return number + k;
    return 0;
}

/* The body of a leaf: that of its first corner. */
static size_t body_of(const sk_skin *skin, const sk_leaf *leaf, const sk_meeting_parts *parts) {
    uint32_t v = leaf->triangles ? skin->triangle[leaf->first_triangle][0] : skin->edge[leaf->first_edge][0];
    size_t body = 0;
    while (body < parts->body_count && !(skin->particle[v] >= parts->body[body].first && skin->particle[v] < parts->body[body].end)) body++;
    return body;
}

bool sk_ignored_make(sk_ignored *ignored, sk_allocator *allocator, const sk_skin *skin, const char *text,
                     const sk_meeting_parts *parts) {
    sk_ignored_release(ignored, allocator);
    word pair[2];
    size_t width = 1;
    for (const char *at = text; next_pair(&at, pair);) width += 2;
    if (width == 1) return true;
    uint16_t *number = sk_allocate(allocator, (parts->body_count + 1) * sizeof *number);
    ignored->of_leaf = sk_allocate(allocator, (skin->leaf_count + 1) * sizeof *ignored->of_leaf);
    ignored->pair = sk_allocate(allocator, width * width);
    bool good = number && ignored->of_leaf && ignored->pair;
    if (good) {
        memset(ignored->pair, 0, width * width);
        for (size_t i = 0; i < parts->body_count; i++) number[i] = (uint16_t)number_of(text, parts->body[i].name);
        number[parts->body_count] = 0;
        for (size_t i = 0; i < skin->leaf_count; i++) ignored->of_leaf[i] = number[body_of(skin, &skin->leaf[i], parts)];
        for (const char *at = text; next_pair(&at, pair);) {
            size_t a = number_of_word(text, &pair[0]), b = number_of_word(text, &pair[1]);
            ignored->pair[a * width + b] = ignored->pair[b * width + a] = 1;
        }
        ignored->width = width;
        ignored->any = true;
    }
    sk_release(allocator, number);
    if (!good) sk_ignored_release(ignored, allocator);
    return good;
}

void sk_ignored_release(sk_ignored *ignored, sk_allocator *allocator) {
    sk_release(allocator, ignored->of_leaf);
    sk_release(allocator, ignored->pair);
    *ignored = (sk_ignored){.any = false};
}
