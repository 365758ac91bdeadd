#!/bin/sh
# Programs as users write them, against the library that was built: programs.sh ROOT LIBRARY C-COMPILER [C++-COMPILER...]
#   1  a program of the library's precision links and reads what it wrote; one of the other does not link, and the
#      linker's words name the precision that is missing
#   2  tests/programs/settings.cpp, by each C++ compiler with and without optimisation: settings are what was written;
#      a pointer to settings that are about to go does not compile
#   3  a misspelt constant of names.h does not compile; it goes with all other headers, before and behind them, in C and C++
# Prints each fault, and fails if there is one.
set -u
cd "$1" || exit 2
library=$2 cc=$3
shift 3
work=$(mktemp -d) || exit 2
trap 'rm -rf "$work"' EXIT
faults=0
fault() {
    echo "programs: $1"
    [ ! -s "$work/words" ] || sed 's/^/    /' "$work/words" | head -20
    faults=$((faults + 1))
}

# ---- 1: precision ----
build() { # NAME FLAGS...: precision.c as a program
    name=$1
    shift
    "$cc" -std=gnu17 -Iinclude "$@" tests/programs/precision.c "$library" $links -lm -pthread -o "$work/$name" 2>"$work/words"
}
links=''
build float || build double -DSKEIN_DOUBLE || { links='-lepoxy'; : >"$work/words"; }
rm -f "$work/float" "$work/double"
if build float; then
    own='' right=float right_says='4 bytes: 4 5 6' other=-DSKEIN_DOUBLE wrong=double
else
    own=-DSKEIN_DOUBLE right=double right_says='8 bytes: 4 5 6' other='' wrong=float
fi
if build right $own; then
    said=$("$work/right") || fault "a program of the library's own precision fails: $said"
    [ "$said" = "$right_says" ] || fault "a program of the library's own precision says '$said', not '$right_says'"
else
    fault "a program of the library's own precision does not link"
fi
if build wrong $other; then
    fault "a program in $wrong links to a library in $right"
else
    grep -q "skein_world_create_$wrong" "$work/words" || fault "the linker does not name skein_world_create_$wrong"
    grep -q "skein_position_view_$wrong" "$work/words" || fault "the linker does not name skein_position_view_$wrong"
fi
: >"$work/words"

# ---- 2: settings in C++ ----
strict='-Wall -Wextra -Wpedantic -Wold-style-cast -Werror -Iinclude'
for cxx in "$@"; do
    for optimised in -O0 -O2; do
        "$cxx" -std=c++17 $strict $optimised $own tests/programs/settings.cpp "$library" $links -lm -pthread \
            -o "$work/settings" 2>"$work/words" || { fault "settings.cpp by $cxx $optimised"; continue; }
        "$work/settings" >"$work/words" || fault "settings.cpp by $cxx $optimised: other settings than were written"
    done
    printf '#include <skein/skein.h>\nint main() { %s return !s->name; }\n' \
        'const skein_setting *s = SKEIN_SETTINGS(SKEIN_REAL("radius", 1));' >"$work/dangling.cpp"
    if "$cxx" -std=c++17 -Iinclude -fsyntax-only "$work/dangling.cpp" 2>"$work/words"; then
        fault "$cxx takes a pointer to settings that are about to go"
    fi
    grep -q 'deleted' "$work/words" || fault "$cxx refuses such a pointer, but not because its conversion is deleted"
    : >"$work/words"
done

# ---- 3: names.h ----
others='skein formula compiled compiled_formula'
for order in "names $others" "$others names"; do
    for header in $order; do echo "#include <skein/$header.h>"; done >"$work/all.c"
    echo 'extern const char *const names[3];
    const char *const names[3] = {SKEIN_CLOTH, SKEIN_CLOTH_STRETCH_STIFFNESS, SKEIN_PARAMETER("L")};' >>"$work/all.c"
    "$cc" -x c -std=c17 -Wall -Wextra -Wpedantic -Werror -Iinclude -fsyntax-only "$work/all.c" 2>"$work/words" ||
        fault "names.h in C among the other headers, in the order $order"
    for cxx in "$@"; do
        "$cxx" -x c++ -std=c++17 -Wall -Wextra -Wpedantic -Werror -Iinclude -fsyntax-only "$work/all.c" 2>"$work/words" ||
            fault "names.h in C++ by $cxx, in the order $order"
    done
done
echo '#include <skein/names.h>
const char *const name = SKEIN_CLOTH_STRETCH_STIFNESS;' >"$work/typo.c"
if "$cc" -Iinclude -fsyntax-only "$work/typo.c" 2>"$work/words"; then fault "a misspelt constant compiles"; fi
: >"$work/words"

[ $# -gt 0 ] || echo "programs: no C++ compiler, so settings were not tried in C++"
echo "programs: $# C++ compilers, a library in $right, $faults faults"
[ $faults -eq 0 ]
