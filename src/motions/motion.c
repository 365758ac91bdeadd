/* The fields that motions of all types have: name, whom they lead, and from when on. */
#include "motions/motion.h"

const skein_field sk_motion_fields[] = {
    SK_TEXT(sk_motion_common, name, "name", "", "for paths and messages"),
    SK_BOOL(sk_motion_common, enabled, "enabled", 1, "false: as if it were not there"),
    SK_TEXT(sk_motion_common, on, "on", "", "the name of the body whose pins it leads; if it has none, all pins"),
    SK_TEXT(
        sk_motion_common, pins, "pins", "",
        "which of them: numbers, \"box x y z x y z\", \"sphere x y z r\"; if there is nothing, all that are pinned"),
    SK_REAL(sk_motion_common, start, "start", "s", 0, 0, SK_FAR, "when it begins"),
};
const size_t sk_motion_field_count = sizeof sk_motion_fields / sizeof *sk_motion_fields;
