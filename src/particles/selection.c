/* Selections by number, box and sphere. Words that only a sheet knows come from its builder
 * (bodies/sheet_selection.c). */
#include "particles/selection.h"

#include <ctype.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/number.h"
#include "base/status.h"

typedef struct selector {
    const sk_selectable *of;
    const char *where;
    bool *chosen;
    skein_error *error;
} selector;

/* Reads up to `most` numbers; returns how many, or -1 if the text holds anything else. */
static int read_numbers(const char *text, double *numbers, int most) {
    int count = 0;
    for (;;) {
        while (isspace((unsigned char)*text)) text++;
        if (!*text) return count;
        double x = 0;
        size_t size = sk_number_read_signed(text, &x);
        if (!size || count == most || !isfinite(x)) return -1;
        numbers[count++] = x;
        text += size;
    }
}

static skein_status choose_in_box_or_sphere(const selector *s, const char *part) {
    bool box = part[0] == 'b';
    const char *rest = part + (box ? 3 : 6);
    double n[7];
    int count = read_numbers(rest, n, 7);
    if (count != (box ? 6 : 4))
        return sk_fail(s->error, SKEIN_ERROR_VALUE, s->where, "'%.80s': expected %s", part,
                       box ? "box and 6 numbers: two corners" : "sphere and 4 numbers: centre and radius");
    size_t found = 0;
    for (size_t i = 0; i < s->of->particle_count; i++) {
        const double *p = s->of->position[i];
        bool inside = true;
        if (box) {
            for (int k = 0; k < 3; k++) inside &= p[k] >= fmin(n[k], n[k + 3]) && p[k] <= fmax(n[k], n[k + 3]);
        } else {
            double d[3] = {p[0] - n[0], p[1] - n[1], p[2] - n[2]};
            inside = d[0] * d[0] + d[1] * d[1] + d[2] * d[2] <= n[3] * n[3];
        }
        if (inside) s->chosen[i] = true;
        found += inside;
    }
    if (!found) return sk_fail(s->error, SKEIN_ERROR_VALUE, s->where, "'%s': no particle is in there", part);
    return SKEIN_OK;
}

/* A number of the list; negative ones count from the end. */
static skein_status read_index(const selector *s, const char *at, char **end, size_t *index) {
    long long most = (long long)s->of->number_count, number = strtoll(at, end, 10);
    bool ends = !**end || isspace((unsigned char)**end) || !strncmp(*end, "..", 2);
    if (*end == at || !ends)
        return sk_fail(s->error, SKEIN_ERROR_VALUE, s->where, "'%.40s': expected whole numbers", at);
    long long from_start = number < 0 ? number + most : number;
    if (from_start < 0 || from_start >= most)
        return sk_fail(s->error, SKEIN_ERROR_VALUE, s->where, "%s %lld is out of range: %s has %lld, 0 to %lld",
                       s->of->number_means, number, s->of->whole, most, most - 1);
    *index = (size_t)from_start;
    return SKEIN_OK;
}

/* A list of vertex numbers of any length; "4..9" is six of them. */
static skein_status choose_by_number(const selector *s, const char *part) {
    for (const char *at = part;;) {
        while (isspace((unsigned char)*at)) at++;
        if (!*at) return SKEIN_OK;
        char *end;
        size_t first = 0, last = 0;
        skein_status status = read_index(s, at, &end, &first);
        last = first;
        bool span = !status && !strncmp(end, "..", 2);
        if (span) status = read_index(s, end + 2, &end, &last);
        if (!status && ((span && last < first) || (*end && !isspace((unsigned char)*end))))
            status =
                sk_fail(s->error, SKEIN_ERROR_VALUE, s->where, "'%.40s': expected a first number .. a last one", at);
        if (status) return status;
        for (size_t i = first; i <= last; i++)
            s->chosen[s->of->particle_of_number ? s->of->particle_of_number[i] : i] = true;
        at = end;
    }
}

static skein_status choose_part(const selector *s, const char *part) {
    if (isdigit((unsigned char)part[0]) || part[0] == '-') return choose_by_number(s, part);
    if (!strncmp(part, "box ", 4) || !strncmp(part, "sphere ", 7)) return choose_in_box_or_sphere(s, part);
    return s->of->choose_words(s->of->data, part);
}

skein_status sk_selection_apply(const char *text, const sk_selectable *of, const char *where, bool *chosen,
                                skein_error *error) {
    selector s = {of, where, chosen, error};
    char *copy = sk_copy_text(of->allocator, text);
    skein_status status = copy ? SKEIN_OK : sk_fail_memory(error, where);
    char *part = copy;
    while (!status && part) {
        // cut off the next part and trim it
        char *comma = strchr(part, ',');
        if (comma) *comma = 0;
        while (isspace((unsigned char)*part)) part++;
        size_t length = strlen(part);
        while (length && isspace((unsigned char)part[length - 1])) part[--length] = 0;
        if (length) status = choose_part(&s, part);
        part = comma ? comma + 1 : NULL;
    }
    sk_release(of->allocator, copy);
    return status;
}
