#!/bin/sh
# What is committed and made by programs is what they write, byte for byte: emitted.sh ROOT SKEIN NAMES
#   src/constraints/emitted, the constraints' kernels, and the example's: `make emit`
#   include/skein/names.h, from the tables of fields: `make names`
set -u
cd "$1" || exit 2
skein=$2 names=$3 faults=0
made=$(mktemp) || exit 2
trap 'rm -f "$made"' EXIT
for file in src/constraints/emitted/*.h tests/changed_distance.h; do
    text=$(sed -n '1s,^// ,,p' "$file")
    "$skein" formula "$text" --emit kernel >"$made" || faults=1
    cmp "$made" "$file" || faults=1
    lines=$(wc -l <"$file")
    [ "$lines" -lt 200 ] || { echo "$file: $lines lines, more than a reader takes in"; faults=1; }
    # no layout and no instruction set in the body
    if grep -n '_mm\|sk_\|\[' "$file" | grep -v '^[0-9]*://'; then faults=1; fi
done
file=examples/compiled_spring/spring.c
"$skein" formula "$(sed -n '1s,^// ,,p' $file)" --param L=1 --emit c --name spring >"$made" || faults=1
cmp "$made" $file || faults=1
"$names" >"$made" || faults=1
cmp "$made" include/skein/names.h || { echo "include/skein/names.h is out of date: make names"; faults=1; }
exit $faults
