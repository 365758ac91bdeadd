/* Pairs of bodies that a rule of contact does not let meet: "cape:shirt, cape:cape", by their names or by those of groups that
 * they are in.
 *
 * A body is many of the text's words at once: its name and its groups. So the bodies that are the same words have one number,
 * and a matrix says which numbers do not meet: those of which one is the left word of a pair, and the other the right one. */
#include <string.h>

#include "base/names.h"
#include "base/status.h"
#include "contact/touch.h"

skein_status sk_ignored_check(const char *text, skein_error *error) {
    sk_word pair[2];
    for (const char *at = text, *next = text; sk_pairs_next(&next, pair); at = next) {
        const char *list = at + strspn(at, " ");
        if (*list == ',') continue;
        sk_word whole = sk_names_next(&list, ",");
        const char *colon = memchr(whole.at, ':', whole.length);
        if (!colon) continue;
        int length = whole.length < 60 ? (int)whole.length : 60;
        if (memchr(pair[1].at, ':', pair[1].length))
            return sk_fail(error, SKEIN_ERROR_VALUE, "ignore",
                           "'%.*s': expected two names, \"cape:shirt\"; between pairs is a comma", length, whole.at);
        for (int k = 0; k < 2; k++)
            if (!pair[k].length)
                return sk_fail(
                    error, SKEIN_ERROR_VALUE, "ignore",
                    "'%.*s': a name is missing %s the colon: expected two, \"cape:shirt\", or one without a colon for "
                    "what does not meet itself",
                    length, whole.at, k ? "behind" : "before");
    }
    return SKEIN_OK;
}

static size_t count_pairs(const char *text) {
    sk_word pair[2];
    size_t count = 0;
    while (sk_pairs_next(&text, pair)) count++;
    return count;
}

/* The body of a leaf: that of its first corner. */
static size_t body_of(const sk_skin *skin, const sk_leaf *leaf, const sk_meeting_parts *parts) {
    uint32_t v = leaf->triangles ? skin->triangle[leaf->first_triangle][0] : skin->edge[leaf->first_edge][0];
    size_t body = 0;
    while (body < parts->body_count &&
           !(skin->particle[v] >= parts->body[body].first && skin->particle[v] < parts->body[body].end))
        body++;
    return body;
}

/* Which words of each pair a body is: bit 0 the left one, bit 1 the right one. False where it is none at all. */
static bool find_words(const char *text, const sk_meeting_body *body, uint8_t *words) {
    sk_word pair[2];
    bool any = false;
    for (; sk_pairs_next(&text, pair); words++) {
        *words = 0;
        for (int k = 0; k < 2; k++)
            if (sk_is_called(body->name, body->groups, pair[k])) *words |= (uint8_t)(1 << k);
        any |= *words != 0;
    }
    return any;
}

static bool do_not_meet(const uint8_t *a, const uint8_t *b, size_t pairs) {
    for (size_t i = 0; i < pairs; i++)
        if (((a[i] & 1) && (b[i] & 2)) || ((a[i] & 2) && (b[i] & 1))) return true;
    return false;
}

/* Numbers bodies: 0 are those that are no word. `words` has room for a row of `pairs` for each number, and one more. */
static size_t number_bodies(const char *text, const sk_meeting_parts *parts, size_t pairs, uint8_t *words,
                            uint32_t *number) {
    size_t numbers = 1;
    for (size_t i = 0; i < parts->body_count; i++) {
        uint8_t *own = words + numbers * pairs;
        size_t same = 1;
        number[i] = 0;
        if (!find_words(text, &parts->body[i], own)) continue;
        while (same < numbers && memcmp(words + same * pairs, own, pairs) != 0) same++;
        numbers += same == numbers;
        number[i] = (uint32_t)same;
    }
    return numbers;
}

bool sk_ignored_make(sk_ignored *ignored, sk_allocator *allocator, const sk_skin *skin, const char *text,
                     const sk_meeting_parts *parts) {
    sk_ignored_release(ignored, allocator);
    size_t pairs = count_pairs(text), bodies = parts->body_count, room = SIZE_MAX / 2;
    if (!pairs) return true;
    if (bodies > UINT32_MAX - 2 || pairs > room / (bodies + 2)) return false;
    uint8_t *words = sk_allocate(allocator, (bodies + 2) * pairs);
    uint32_t *number = sk_allocate(allocator, (bodies + 1) * sizeof *number);
    ignored->of_leaf = sk_allocate(allocator, (skin->leaf_count + 1) * sizeof *ignored->of_leaf);
    bool good = words && number && ignored->of_leaf;
    size_t width = good ? number_bodies(text, parts, pairs, words, number) : 1;
    good = good && width <= room / width && (ignored->pair = sk_allocate(allocator, width * width)) != NULL;
    if (good) {
        number[bodies] = 0; // of leaves that are of no body
        for (size_t i = 0; i < skin->leaf_count; i++)
            ignored->of_leaf[i] = number[body_of(skin, &skin->leaf[i], parts)];
        for (size_t a = 1; a < width; a++)
            for (size_t b = 1; b < width; b++)
                ignored->pair[a * width + b] = do_not_meet(words + a * pairs, words + b * pairs, pairs);
        ignored->width = width;
        ignored->any = width > 1;
    }
    sk_release(allocator, words);
    sk_release(allocator, number);
    if (!good) sk_ignored_release(ignored, allocator);
    return good;
}

void sk_ignored_release(sk_ignored *ignored, sk_allocator *allocator) {
    sk_release(allocator, ignored->of_leaf);
    sk_release(allocator, ignored->pair);
    *ignored = (sk_ignored){.any = false};
}
