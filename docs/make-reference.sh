#!/bin/sh
# Writes the reference of all kinds and fields, from the tables that the library itself uses:
#     docs/make-reference.sh >docs/reference.md
# Runs build/skein, or the command named by the variable SKEIN.
set -u
cd "$(dirname "$0")/.." || exit 1
skein=${SKEIN:-build/skein}
list=$("$skein" list) || exit 1

cat <<'HEAD'
# Reference: every kind and its fields

Made by `docs/make-reference.sh >docs/reference.md`, which prints what `skein list` says; do not edit it by
hand. `skein list forces` shows one part of it on the terminal.

A field has the same name in a scene, in `--set`, and in a program. Dots are groups: `stretch.stiffness` is
`"stretch": { "stiffness": 2e4 }` in a scene, `--set bodies.0.stretch.stiffness=2e4` on the command line, and
`SKEIN_REAL("stretch.stiffness", 2e4)` in C; `skein/names.h` has a constant for each name, for a cloth's
`SKEIN_CLOTH_STRETCH_STIFFNESS`. Where no range stands, any finite number will do. The functions of the library are
described in [`include/skein/skein.h`](../include/skein/skein.h).
HEAD

# A line of one word begins a category; each becomes a heading and a block, with blank lines only inside.
printf '%s\n' "$list" | awk '
    /^[a-z]+$/ {
        if (categories++) print "```"
        print "\n## " toupper(substr($0, 1, 1)) substr($0, 2) "\n\n```text"
        lines = blank = 0
        next
    }
    /^$/ { blank = lines; next }
    !categories { exit }
    {
        if (blank) print ""
        print
        lines++
        blank = 0
    }
    END {
        if (categories) print "```"
        else print "make-reference: skein list begins with no category" >"/dev/stderr"
        exit !categories
    }'
