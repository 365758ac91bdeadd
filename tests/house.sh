#!/bin/sh
# Checks the rules of the house, which no compiler checks: house.sh ROOT [C-COMPILER [C++-COMPILER]]
#   1  src/ includes only the C library, <skein/...> and floors below or beside it in its own folder; it calls
#      nothing of src/catalogue.c, the roof
#   2  no method has a loop: src/methods/ writes ops, and only the builder's own files walk over rules
#   3  src/world/ names no kind: what the catalogue lists is unknown to the step; nor does src/gpu/; and render/,
#      viewer/ and app/ compare no kind's name
#      and neither names a kind of op but repeat: what is so of a kind says its row in src/plan/op_types.c
#   4  each public header compiles alone, as C17 and as C++17
#   5  each file of C and GLSL opens with a comment: what it owns
#   6  src/ asks the environment for nothing but SKEIN_...: a switch that was tried with stays in no library
#   7  files are laid out as tools/format does it, where that is the version of clang-format that they are laid out by
# Prints each fault as FILE:LINE: words, and fails if there is one.
set -u
cd "$1" || exit 2
cc=${2:-cc} cxx=${3:-}
export LC_ALL=C
faults=$(mktemp) || exit 2
trap 'rm -f "$faults"' EXIT

files=$(find src -name '*.[ch]' | sort)
[ -n "$files" ] || { echo "house: no files in src/"; exit 1; }

# ---- 1: the floors, from below; those on one line do not include each other ----
floors='
base
formula
space
plan
particles
constraints forces colliders limits motions
contact
methods
world
bodies
outside
gpu
'
libc='assert complex ctype errno fenv float inttypes limits locale math setjmp signal stdalign stdarg
stdatomic stdbool stddef stdint stdio stdlib stdnoreturn string tgmath time wchar
dirent dlfcn fcntl pthread sched semaphore strings unistd sys/mman sys/stat sys/types sys/time
cpuid immintrin arm_neon wasm_simd128'

awk -v floors="$floors" -v libc="$libc" '
    BEGIN {
        count = split(floors, lines, "\n")
        for (i = 1; i <= count; i++) {
            n = split(lines[i], names, " ")
            for (j = 1; j <= n; j++) height[names[j]] = i
        }
        n = split(libc, names, /[ \n]+/)
        for (j = 1; j <= n; j++) system_header["<" names[j] ".h>"] = 1
    }
    FNR == 1 {
        n = split(FILENAME, path, "/")
        own = n > 2 ? path[2] : "" # a file in src/ itself is the roof: it sees all floors
        if (own != "" && !(own in height)) print FILENAME ":1: the folder is no floor that tests/house.sh knows"
    }
    /^[ \t]*#[ \t]*include/ {
        what = $0
        sub(/^[ \t]*#[ \t]*include[ \t]*/, "", what)
        if (what == "SK_FORMULA") next # the kernel that was emitted for a kind
        if (what ~ /^</) {
            sub(/>.*/, ">", what)
            if (own == "gpu" && what ~ /^<epoxy\/e?gl[.]h>/) next # it speaks to the graphics card
            if (what !~ /^<skein\// && !(what in system_header))
                print FILENAME ":" FNR ": includes " what ", which is no header of the C library"
            next
        }
        sub(/^"/, "", what)
        sub(/".*/, "", what)
        if (own == "" && what == "catalogue_kinds.h") next # what the build has found (cmake/kinds.cmake)
        split(what, path, "/")
        floor = path[1]
        if (!(floor in height))
            print FILENAME ":" FNR ": includes \"" what "\", which is on no floor of src/"
        else if (own != "" && floor != own && height[floor] == height[own])
            print FILENAME ":" FNR ": includes \"" what "\", of a neighbour on the same floor"
        else if (own != "" && height[floor] > height[own])
            print FILENAME ":" FNR ": includes \"" what "\", from a floor above its own"
    }' $files >>"$faults"

# ---- The code alone: comments blanked, and what stands in quotes (0), or (2) kept with its quotes ----
code() {
    awk -v strings="$1" '
        FNR == 1 { comment = 0 }
        {
            line = $0
            out = ""
            while (line != "") {
                if (comment) {
                    at = index(line, "*/")
                    if (!at) break
                    line = substr(line, at + 2)
                    comment = 0
                    continue
                }
                if (!match(line, /\/\*|\/\/|"|\047/)) {
                    out = out line
                    break
                }
                out = out substr(line, 1, RSTART - 1) " "
                mark = substr(line, RSTART, RLENGTH)
                line = substr(line, RSTART + RLENGTH)
                if (mark == "//") break
                if (mark == "/*") {
                    comment = 1
                    continue
                }
                for (i = 1; i <= length(line) && substr(line, i, 1) != mark; i++)
                    if (substr(line, i, 1) == "\\") i++
                if (strings && mark == "\"") out = out "\"" substr(line, 1, i - 1) "\" "
                line = substr(line, i + 1)
            }
            print FILENAME ":" FNR ": " out
        }' $2
}

# The roof is seen by nobody: what it defines is called by no floor (a circle without an include is one, too).
roof=$(sed -n 's/^[a-z][^=;]*[ *]\(skein_[a-z_]*\)(.*/\1/p' src/catalogue.c)
[ -n "$roof" ] || echo "src/catalogue.c:1: tests/house.sh finds no function in it" >>"$faults"
code 0 "$(echo "$files" | grep -v '^src/catalogue[.]c$')" | awk -v roof="$roof" '
    BEGIN { count = split(roof, name, /[ \n]+/) }
    {
        place = $1
        sub(/^[^ ]*/, "")
        for (i = 1; i <= count; i++)
            if (index($0, name[i] "(") && match($0, "(^|[^A-Za-z0-9_])" name[i] "[(]"))
                print place " calls " name[i] "() of src/catalogue.c, which is above all floors"
    }' >>"$faults"

# ---- 2: no loops in methods ----
methods=$(find src/methods -name '*.[ch]' ! -name 'plan_builder*.c' | sort)
code 0 "$methods" | awk '
    {
        place = $1
        sub(/^[^ ]*/, "")
        if (match($0, /(^|[^A-Za-z0-9_])(for|while|do|goto)([^A-Za-z0-9_]|$)/))
            print place " a loop in a method: a method writes ops, the plan runs them"
    }' >>"$faults"

# ---- 3: the world knows no kind ----
kinds=$(sed -n 's/^const sk_\(body\|constraint\|force\|collider\|limit\)_type sk_\([a-z0-9_]*\) = .*/\2/p' \
    src/bodies/*.c src/constraints/*.c src/forces/*.c src/colliders/*.c)
names=$(code 2 "$(find src/bodies src/constraints src/forces src/colliders -name '*.c' | sort)" | awk '
    /[.]kind =/ { begun = 1 }
    begun && match($0, /"[a-z0-9_]+"/) { print substr($0, RSTART + 1, RLENGTH - 2); begun = 0 }')
[ -n "$kinds" ] && [ -n "$names" ] || echo "src:1: tests/house.sh finds no kind in it" >>"$faults"
# A symbol is a kind's if it is sk_KIND, or begins so and no header of a floor without kinds has it: a kind may be called
# `op` although there is an sk_op_kernel. A text is a kind's if it is its name, or its file's, as a whole: a kind may be
# called `line`. What is declared by hand, with extern, is no excuse.
shared=$(find src/base src/formula src/space src/plan src/particles src/methods src/world src/gpu -name '*.h')
common=$(grep -hv '^ *extern' $shared | grep -o 'sk_[A-Za-z0-9_]*' | sort -u)
code 2 "$(find src/world src/gpu -name '*.[ch]' | sort)" | awk -v kinds="$kinds" -v names="$names" -v common="$common" '
    BEGIN {
        n = split(common, list, /[ \n]+/)
        for (i = 1; i <= n; i++) known[list[i]] = 1
        count = split(kinds, kind, /[ \n]+/)
        n = split(names, list, /[ \n]+/)
        for (i = 1; i <= n; i++) name[list[i]] = 1
    }
    function fault(what) { print place " names the kind \"" what "\": the step knows none" }
    {
        place = $1
        sub(/^[^ ]*/, "")
        rest = $0
        while (match(rest, /"[^"]*"/)) {
            text = tolower(substr(rest, RSTART + 1, RLENGTH - 2))
            sub(/^.*\//, "", text)
            sub(/[.][a-z]*$/, "", text)
            if (text in name) fault(text)
            rest = substr(rest, 1, RSTART - 1) " " substr(rest, RSTART + RLENGTH)
        }
        while (match(rest, /[A-Za-z_][A-Za-z0-9_]*/)) {
            symbol = tolower(substr(rest, RSTART, RLENGTH))
            rest = substr(rest, RSTART + RLENGTH)
            for (i = 1; i <= count; i++)
                if (symbol == "sk_" kind[i] || (!(symbol in known) && index(symbol, "sk_" kind[i] "_") == 1)) fault(kind[i])
        }
    }' >>"$faults"

# Nor a kind of op, but the repeat.
grep -q 'SK_OP_REPEAT,' src/plan/op.h || echo "src/plan/op.h:1: tests/house.sh finds no kind of op in it" >>"$faults"
code 0 "$(find src/world src/gpu -name '*.[ch]' | sort)" | awk '
    {
        place = $1
        sub(/^[^ ]*/, "")
        while (match($0, /(^|[^A-Za-z0-9_])(SK_OP_[A-Z_]+|sk_(combine|sort)_[a-z_]+)/)) {
            symbol = substr($0, RSTART, RLENGTH)
            sub(/^[^A-Za-z0-9_]/, "", symbol)
            $0 = substr($0, RSTART + RLENGTH)
            if (symbol != "SK_OP_REPEAT")
                print place " names the op " symbol ": what is so of a kind of op says its row in src/plan/op_types.c"
        }
    }' >>"$faults"

# Nor does whoever draws or shows: what a thing looks like is asked for (skein_shape_of).
code 2 "$(find render viewer app -name '*.[ch]' | sort)" | awk -v names="$names" '
    BEGIN {
        n = split(names, list, /[ \n]+/)
        for (i = 1; i <= n; i++) name[list[i]] = 1
    }
    /cmp\(.*kind/ {
        rest = $0
        while (match(rest, /"[^"]*"/)) {
            text = substr(rest, RSTART + 1, RLENGTH - 2)
            rest = substr(rest, RSTART + RLENGTH)
            if (text in name) print $1 " compares the name of the kind \"" text "\": a kind says what it looks like"
        }
    }' >>"$faults"

# ---- 4: headers that stand alone ----
compile_alone() { # HEADER LANGUAGE STANDARD COMPILER
    case $1 in # this one is there to be included several times, each time with other numbers
    */dual.h) first='#define SKEIN_DUAL_N 6' second='#define SKEIN_DUAL_N 12\n#define SKEIN_DUAL_REAL double' ;;
    *) first='' second='' ;;
    esac
    printf "$first\n#include <%s>\n$second\n#include <%s>\n" "${1#include/}" "${1#include/}" |
        $4 -x "$2" -std="$3" -Wall -Wextra -Wpedantic -Werror -Iinclude -fsyntax-only - >"$faults.words" 2>&1 ||
        { sed 's/^/    /' "$faults.words"; echo "$1:1: does not compile alone as $3"; } >>"$faults"
    rm -f "$faults.words"
}
for header in include/skein/*.h; do
    compile_alone "$header" c c17 "$cc"
    [ -z "$cxx" ] || compile_alone "$header" c++ c++17 "$cxx"
done
[ -n "$cxx" ] || echo "house: no C++ compiler, so the headers were not tried as C++"

# ---- 5: files that say what they are ----
find $(ls -d src include io render viewer app film bench solvers bindings examples fuzz tests 2>/dev/null) \
    \( -path '*/node_modules' -o -path '*/build*' \) -prune -o -name '*.[ch]' -print -o -name '*.glsl' -print -o -name '*.cpp' -print |
    xargs awk '
        FNR == 1 { silent = 0 }
        !silent && NF && !/^#version/ { # which GLSL wants first
            silent = 1
            if ($1 !~ /^(\/\*|\/\/)/) print FILENAME ":1: does not open with a comment: what it owns"
            nextfile
        }' >>"$faults"

# ---- 6: switches ----
grep -n 'getenv *(' $files | grep -v 'getenv("SKEIN_[A-Z]*")' |
    sed 's/^\([^:]*:[0-9]*\):.*/\1: asks the environment for something else than SKEIN_.../' >>"$faults"

# ---- 7: layout ----
if [ -e .git ] && clang-format --version 2>/dev/null | grep -q 'version 14\.'; then
    tools/format --check 2>/dev/null | sed 's/$/:1: is not laid out as tools\/format does it/' >>"$faults"
else
    echo "house: no clang-format 14, so the layout was not looked at"
fi

cat "$faults"
echo "house: $(echo "$files" | wc -l) files, $(echo "$kinds" | wc -l) kinds, $(grep -c '^[^ ]' "$faults") faults"
[ ! -s "$faults" ]
