/* The fields common to all motions: name, particles, start, and their settings as moving frames and leashes. */
#include "motions/motion.h"

#include <ctype.h>
#include <string.h>

#include "base/number.h"
#include "base/status.h"

const skein_field sk_motion_fields[] = {
    SK_TEXT(sk_motion_common, name, "name", "", "for paths and messages"),
    SK_BOOL(sk_motion_common, enabled, "enabled", 1, "false: as if it were not there"),
    SK_TEXT(sk_motion_common, on, "on", "",
            "the names of the bodies, or of groups of them, whose pins it leads, commas between them; empty: all pins"),
    SK_TEXT(
        sk_motion_common, pins, "pins", "",
        "which of them: as the body's own pins, \"top edge\", numbers, \"box x y z x y z\", \"sphere x y z r\"; if there is nothing, "
        "all that are pinned"),
    SK_REAL(sk_motion_common, start, "start", "s", 0, 0, SK_FAR, "when it begins"),
    SK_TEXT(sk_motion_common, colliders, "colliders", "",
            "the names of the colliders that it leads as it leads pins, commas between them"),
    SK_REAL(
        sk_motion_common, inertia, "inertia", "", 1, 0, 1,
        "the share of its velocity and acceleration that the body feels: 1 all of it; by the rest it is carried along, "
        "with colliders; 0: as if it stood still"),
    SK_REAL(
        sk_motion_common, jump, "jump", "m", SK_UNBOUNDED, 0, SK_UNBOUNDED,
        "a step in which it goes farther is a jump: the body and the colliders are carried along, whatever inertia says"),
    SK_REAL(sk_motion_common, jump_turn, "jump_turn", "deg", 180, 0, 180, "the same where it turns farther in a step"),
    SK_TEXT(sk_motion_common, jump_times, "jump_times", "",
            "steps that come to one of these times are jumps, too: seconds after the start, \"1.5 4\""),
    SK_REAL(sk_motion_common, pull, "pull", "N/m", 0, 0, SK_FAR,
            "of those that it names, or of all, what is free is pulled to its place by this: a pin that gives way"),
    SK_REAL(sk_motion_common, max_distance, "max_distance", "m", SK_UNBOUNDED, 0, SK_UNBOUNDED,
            "what is free comes no farther from the place where it would be if it were led"),
    SK_REAL(sk_motion_common, backstop, "backstop", "m", SK_UNBOUNDED, -SK_FAR, SK_UNBOUNDED,
            "and so far behind the surface of those places, against its normals, at most: a ball is there"),
    SK_REAL(sk_motion_common, backstop_radius, "backstop_radius", "m", 1, 1e-6, 1e6, "the radius of that ball"),
    SK_TEXT(sk_motion_common, map, "map", "",
            "a share of max_distance for each particle, in their order: as many numbers as it leads or could; empty: 1"),
};
const size_t sk_motion_field_count = sizeof sk_motion_fields / sizeof *sk_motion_fields;

bool sk_motion_takes(const sk_motion_type *type, const char *field) {
    static const char *const of_frames[] = {"colliders", "inertia", "jump", "jump_turn", "jump_times"};
    for (size_t i = 0; type->carrier && i < sizeof of_frames / sizeof *of_frames; i++)
        if (!strcmp(field, of_frames[i])) return false;
    return true;
}

const skein_field *sk_motion_refused(const sk_motion_type *type, const sk_motion_common *common) {
    for (size_t i = 0; i < sk_motion_field_count; i++) {
        const skein_field *field = &sk_motion_fields[i];
        if (sk_motion_takes(type, field->name)) continue;
        const skein_value value = sk_field_load(field, common);
        const double number = value.number[0], usual = field->initial[0];
        if (field->type == SKEIN_FIELD_TEXT ? value.text && value.text[0] : number < usual || number > usual)
            return field;
    }
    return NULL;
}

/* Reads the next number of a text, 0 or more; NULL at its end, and `*wrong` if there is anything else. */
static const char *next_time(const char *at, double *time, bool *wrong) {
    while (isspace((unsigned char)*at) || *at == ',') at++;
    if (!*at) return NULL;
    size_t size = sk_number_read_signed(at, time);
    *wrong = !size || !(*time >= 0) || !(*time <= SK_FAR) ||
             (at[size] && at[size] != ',' && !isspace((unsigned char)at[size]));
    return *wrong ? NULL : at + size;
}

bool sk_motion_jumps(const sk_motion_common *common, double from, double to) {
    double time = 0, hair = 1e-6 * (to - from); // tolerance: times of steps are rounded sums
    bool wrong = false;
    for (const char *at = common->jump_times; (at = next_time(at, &time, &wrong));)
        if (time > from + hair && time <= to + hair) return true;
    return false;
}

skein_status sk_motion_check_jumps(const sk_motion_common *common, skein_error *error) {
    double time = 0, before = 0;
    bool wrong = false;
    for (const char *at = common->jump_times; (at = next_time(at, &time, &wrong)); before = time)
        if (time < before)
            return sk_fail(error, SKEIN_ERROR_VALUE, "jump_times",
                           "'%.60s': %g s comes after %g s: expected times that rise, such as \"1.5 4\"",
                           common->jump_times, time, before);
    if (!wrong) return SKEIN_OK;
    return sk_fail(error, SKEIN_ERROR_VALUE, "jump_times",
                   "'%.60s': expected times in seconds, 0 or more, such as \"1.5 4\"", common->jump_times);
}

skein_status sk_motion_read_map(const sk_motion_common *common, double *share, size_t most, size_t *count,
                                skein_error *error) {
    double number = 0;
    bool wrong = false;
    const char *rest = common->map;
    *count = 0;
    for (const char *at; (at = next_time(rest, &number, &wrong)); rest = at, ++*count)
        if (*count < most) share[*count] = number;
    if (!wrong) return SKEIN_OK;
    while (isspace((unsigned char)*rest) || *rest == ',') rest++;
    size_t length = strcspn(rest, ", \t\r\n");
    return sk_fail(error, SKEIN_ERROR_VALUE, "map",
                   "number %zu, '%.*s': expected numbers, 0 or more, one for each particle", *count + 1,
                   (int)(length < 60 ? length : 60), rest);
}
