#!/bin/sh
# Checks that the documents are still true: docs/check.sh [SKEIN]      (SKEIN: build/skein)
#   1  a block ```c FILE is in that file word for word, or, if there is none, compiles where it would stand
#   2  a block ```json passes `skein check`
#   3  a block ```text skein explain SCENE is what that prints
#   4  reference.md is what make-reference.sh makes
#   5  links to files of this repository lead somewhere
# Prints each fault, and fails if there is one.
set -u
cd "$(dirname "$0")/.." || exit 2
skein=${1:-build/skein}
case $skein in /*) ;; *) skein=$PWD/$skein ;; esac
work=$(mktemp -d) || exit 2
trap 'rm -rf "$work"' EXIT
faults=0 blocks=0
fault() {
    echo "$1" >&2
    faults=$((faults + 1))
}

# ---- Every marked block into a file of its own, with its words (a file, a command) in another beside it ----
for document in README.md docs/*.md; do
    awk -v stem="$work/$(basename "$document" .md)" '
        /^```/ {
            if (out) { close(out); out = ""; next }
            n = split(substr($0, 4), word, " ")
            kind = n == 2 && word[1] == "c" && word[2] != "fragment" ? "c" : n == 1 && word[1] == "json" ? "json" : ""
            if (n == 4 && word[1] == "text" && word[3] == "explain") kind = "explain"
            out = kind ? stem "-" NR "." kind : "/dev/null"
            if (kind) { print word[n] >(out ".word"); close(out ".word") }
            next
        }
        out { print >out }' "$document"
done

for block in "$work"/*.c; do
    [ -e "$block" ] || continue
    blocks=$((blocks + 1))
    file=$(cat "$block.word")
    if [ -e "$file" ]; then
        awk 'FNR == NR { block = block $0 "\n"; next } { file = file $0 "\n" } END { exit !index(file, block) }' \
            "$block" "$file" || fault "$(basename "$block" .c): is not in $file any more"
    else
        ${CC:-cc} -std=gnu17 -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Werror -Iinclude -Isrc -fsyntax-only \
            "$block" || fault "$(basename "$block" .c): does not compile as $file"
    fi
done

for block in "$work"/*.json; do
    [ -e "$block" ] || continue
    blocks=$((blocks + 1))
    "$skein" check "$block" >/dev/null || fault "$(basename "$block" .json): is not a good scene"
done

for block in "$work"/*.explain; do
    [ -e "$block" ] || continue
    blocks=$((blocks + 1))
    "$skein" explain "$(cat "$block.word")" | cmp -s - "$block" ||
        fault "$(basename "$block" .explain): is not what skein explain $(cat "$block.word") prints"
done

SKEIN=$skein docs/make-reference.sh >"$work/reference.md"
cmp -s "$work/reference.md" docs/reference.md ||
    fault "docs/reference.md is out of date: docs/make-reference.sh >docs/reference.md"

for document in README.md docs/*.md; do
    grep -o '](\([^)#]*\)' "$document" | sed 's/](//' | grep -v '^http' | sort -u | while read -r link; do
        [ -z "$link" ] || [ -e "$(dirname "$document")/$link" ] || echo "$document: the link $link leads nowhere"
    done
done >"$work/links"
[ ! -s "$work/links" ] || fault "$(cat "$work/links")"

echo "documents: $blocks blocks tried, $faults faults"
[ $faults -eq 0 ]
