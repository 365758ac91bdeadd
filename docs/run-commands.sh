#!/bin/sh
# Runs what the documents tell their readers to type, as it is written: docs/run-commands.sh [BUILD-FOLDER [DOCUMENT...]]
#   ```sh              each command must end well. `make TARGET` must be a target; `skein view` must open a window and
#                      stay open (under Xvfb, if it is there); a graphics card is asked for only if SKEIN_DOCS_GPU is set
#   ```json FILE       is written to that file, for the commands after it
#   ```text of "$ COMMAND" lines: each ends well, and prints the lines below it
#   ```text COMMAND    what it prints has these lines, in this order; times may differ, and a line of dots skips some
# They run in a folder that has the repository's files as links, so that what they write is gone afterwards. Placeholders
# that readers bring themselves (shirt.obj, photo.jpg) are made from files of the repository. Prints each fault.
set -u
root=$(cd "$(dirname "$0")/.." && pwd) || exit 2
build=$(cd "${1:-$root/build}" && pwd) || exit 2
[ $# -eq 0 ] || shift
cd "$root" || exit 2
[ $# -gt 0 ] || set -- README.md docs/*.md docs/scenes/*.md
sandbox=$(mktemp -d) || exit 2
server=''
trap 'rm -rf "$sandbox"; [ -z "$server" ] || kill "$server" 2>/dev/null' EXIT

for entry in "$root"/*; do
    case $(basename "$entry") in
    build* | out) ;;
    scenes) cp -r "$entry" "$sandbox/" ;; # what --set names beside a scene is put there
    *) ln -s "$entry" "$sandbox/" ;;
    esac
done
ln -s "$build" "$sandbox/build"
HOME=$sandbox/home PATH=$build:$PATH # compiled formulas are kept in the home folder
unset XDG_CACHE_HOME SKEIN_CACHE
export HOME PATH
mkdir -m 700 "$sandbox/home"
cp "$root/meshes/ball.obj" "$sandbox/shirt.obj"
cp "$root/docs/images/drape.png" "$sandbox/scenes/photo.jpg"

# ---- A list: kind, place and file of each block that is to be run ----
list=$sandbox/.list
: >"$list"
for document; do
    awk -v stem="$sandbox/.$(basename "$document" .md)" -v document="$document" -v list="$list" '
        /^```/ {
            if (out) { close(out); out = ""; next }
            info = substr($0, 4)
            n = split(info, word, " ")
            kind = info == "sh" ? "sh" : n == 2 && word[1] == "json" ? "json" : \
                n > 1 && word[1] == "text" && (word[2] ~ /^build\/|^[.]\//) ? "text" : info == "text" ? "session" : ""
            out = kind ? stem "-" NR : "/dev/null"
            if (kind) {
                rest = info
                sub(/^[a-z]* */, "", rest)
                print kind "\t" document ":" NR "\t" out "\t" rest >>list
                printf "" >out
            }
            next
        }
        out { print >out }' "$document"
done

faults=0 ran=0 left=0
fault() {
    printf '%s\n' "$1" >&2
    faults=$((faults + 1))
}

open_display() {
    [ -z "$server" ] && command -v Xvfb >/dev/null || return
    for number in 91 92 93 94 95; do
        Xvfb ":$number" -screen 0 1280x720x24 -nolisten tcp >/dev/null 2>&1 &
        server=$!
        sleep 1
        if kill -0 "$server" 2>/dev/null; then
            DISPLAY=:$number
            export DISPLAY
            return
        fi
        server=''
    done
}

# A command line of a block, at its place.
try() {
    case $2 in
    "make "* | make)
        ran=$((ran + 1))
        (cd "$root" && make -n ${2#make} >/dev/null 2>&1) || fault "$1: there is no '$2'"
        return
        ;;
    *--device\ gpu*)
        if [ -z "${SKEIN_DOCS_GPU:-}" ]; then
            left=$((left + 1))
            return
        fi
        ;;
    *scenes/elephant.json* | *scenes/statue.json*) # meshes that `make demo` fetches
        if [ ! -e "$root/meshes/fetched/elephant.off" ]; then
            left=$((left + 1))
            return
        fi
        ;;
    *skein\ view*)
        open_display
        if [ -z "$server" ]; then
            left=$((left + 1))
            return
        fi
        ran=$((ran + 1))
        (cd "$sandbox" && exec timeout -k 5 5 sh -c "exec $2") >"$sandbox/.said" 2>&1 </dev/null
        [ $? -eq 124 ] || fault "$1: the window of '$2' did not stay open: $(tail -n 3 "$sandbox/.said")"
        return
        ;;
    esac
    ran=$((ran + 1))
    (cd "$sandbox" && sh -c "$2") >"$sandbox/.said" 2>&1 </dev/null ||
        fault "$1: fails: $2
$(tail -n 5 "$sandbox/.said")"
}

# Numbers that another run has otherwise: times, and what is worked out from them.
without_times() {
    sed -E 's/[0-9.e+-]+ ms a step/# ms a step/; s/[0-9.e+-]+ times real time/# times real time/; s/ in [0-9.]+ s$/ in # s/
        s,/[^ ]*/[.]cache/,/#/.cache/,' |
        awk '$1 ~ /_euler$|^rk4$|^leapfrog$|^midpoint$|pbd$/ && NF == 9 { $8 = $9 = "#" } { $1 = $1; print }'
}

# Whether the lines of a file are among what a command prints, in their order.
compare() { # PLACE FILE COMMAND [succeeds]
    ran=$((ran + 1))
    (cd "$sandbox" && sh -c "$3") </dev/null >"$sandbox/.printed" 2>&1 || [ -z "${4:-}" ] || fault "$1: fails: $3"
    without_times <"$sandbox/.printed" >"$sandbox/.said"
    without_times <"$2" | awk -v place="$1" -v command="$3" '
        FNR == NR { said[++count] = $0; next }
        /^[.]+$/ { next }
        {
            for (k = at + 1; k <= count && said[k] != $0; k++) continue
            if (k > count) { print place ": " command " does not print (there, or at all): " $0; bad = 1; exit 1 }
            at = k
        }' "$sandbox/.said" - >&2 || faults=$((faults + 1))
}

# Commands after "$ ", each with the lines that it is to print.
session() { # PLACE FILE
    awk -v stem="$2" '/^[$] / { n++; print substr($0, 3) >(stem "." n); next } n { print >(stem "." n ".says") }' "$2"
    for number in 1 2 3 4 5 6 7 8 9; do
        [ -e "$2.$number" ] || continue
        [ -e "$2.$number.says" ] || : >"$2.$number.says"
        compare "$1" "$2.$number.says" "$(cat "$2.$number")" succeeds
    done
}

tab=$(printf '\t')
while IFS="$tab" read -r kind place file rest; do
    case $kind in
    json) [ -e "$root/$rest" ] || [ "$rest" = fragment ] || cp "$file" "$sandbox/$rest" ;;
    text) compare "$place" "$file" "$rest" ;;
    session) session "$place" "$file" ;;
    sh)
        # lines that end with \ go on; comments go
        sed -e ':a' -e '/\\$/{N;s/\\\n *//;ba' -e '}' -e 's/[[:space:]][[:space:]]*#.*$//' -e '/^#/d' -e '/^[[:space:]]*$/d' \
            "$file" >"$file.lines"
        while IFS= read -r line; do try "$place" "$line"; done <"$file.lines"
        ;;
    esac
done <"$list"

echo "documents: $ran commands run, $left left out (no card, no display, or a mesh that is not fetched), $faults faults"
[ $faults -eq 0 ]
