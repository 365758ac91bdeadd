#!/bin/sh
# Checks that the documents are still true: docs/check.sh [SKEIN]      (SKEIN: build/skein)
#   1  a block ```c FILE is in that file word for word, or, if there is none, compiles where it would stand
#   2  a block ```json or ```json NEW-FILE passes `skein check`; one ```json SCENE is in that file word for word
#   3  a block ```text skein explain SCENE is what that prints
#   4  reference.md is what make-reference.sh makes
#   5  links to files of this repository lead somewhere, and so do the files that CONTRIBUTING.md names
#   6  methods.md names every method, body, constraint, force, collider and motion there is, and its formulas are those that the
#      kernels are made of (a block ```formula NAME)
#   7  gallery.md, the pages of scenes and performance.md are what their scripts make of scenes and kept benchmarks
# What the documents tell readers to type is run by run-commands.sh.
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
            kind = n == 2 && word[1] == "c" && word[2] != "fragment" ? "c" : word[1] == "json" && word[2] != "fragment" ? "json" : ""
            if (n == 2 && word[1] == "formula") kind = "formula"
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
    file=$(cat "$block.word")
    if [ -e "$file" ]; then # a part of a scene
        awk 'FNR == NR { block = block $0 "\n"; next } { file = file $0 "\n" } END { exit !index(file, block) }' \
            "$block" "$file" || fault "$(basename "$block" .json): is not in $file any more"
        continue
    fi
    mesh=$(sed -n 's/.*"mesh": "\([^"]*\)".*/\1/p' "$block" | head -n 1)
    [ -z "$mesh" ] || [ -e "$work/$mesh" ] || continue # a command of the document makes it: run-commands.sh has both
    "$skein" check "$block" >/dev/null || fault "$(basename "$block" .json): is not a good scene"
done

for block in "$work"/*.explain; do
    [ -e "$block" ] || continue
    blocks=$((blocks + 1))
    "$skein" explain "$(cat "$block.word")" | cmp -s - "$block" ||
        fault "$(basename "$block" .explain): is not what skein explain $(cat "$block.word") prints"
done

for block in "$work"/*.formula; do
    [ -e "$block" ] || continue
    blocks=$((blocks + 1))
    sed -n '1s,^// ,,p' "src/constraints/emitted/$(cat "$block.word").h" | cmp -s - "$block" ||
        fault "$(basename "$block" .formula): is not the formula of src/constraints/emitted/$(cat "$block.word").h"
done
for file in src/constraints/emitted/*.h; do
    grep -q "^\`\`\`formula $(basename "$file" .h)\$" docs/methods.md ||
        fault "docs/methods.md: lacks the formula of $file"
done
for category in methods bodies constraints forces colliders motions; do
    "$skein" list $category | sed -n 's/^  \([a-z_0-9]*\):.*/\1/p' | while read -r kind; do
        grep -q -e "^### $kind\$" -e "\`$kind\`" docs/methods.md || echo "docs/methods.md: nothing about '$kind'"
    done
done >"$work/kinds"
[ ! -s "$work/kinds" ] || fault "$(cat "$work/kinds")"

SKEIN=$skein docs/make-reference.sh >"$work/reference.md"
cmp -s "$work/reference.md" docs/reference.md ||
    fault "docs/reference.md is out of date: docs/make-reference.sh >docs/reference.md"

docs/make-gallery.sh "$skein" | cmp -s - docs/gallery.md ||
    fault "docs/gallery.md is out of date: docs/make-gallery.sh >docs/gallery.md"
docs/make-performance.sh | cmp -s - docs/performance.md ||
    fault "docs/performance.md is out of date: docs/make-performance.sh >docs/performance.md"
docs/make-scene-pages.sh --keep "$work/scenes" "$skein"
for page in $(ls "$work/scenes" docs/scenes | grep '[.]md$' | sort -u); do
    cmp -s "$work/scenes/$page" "docs/scenes/$page" || fault "docs/scenes/$page is out of date: docs/make-scene-pages.sh"
done

for document in README.md CONTRIBUTING.md docs/*.md docs/scenes/*.md; do
    grep -o '](\([^)#]*\)' "$document" | sed 's/](//' | grep -v '^http' | sort -u | while read -r link; do
        [ -z "$link" ] || [ -e "$(dirname "$document")/$link" ] || echo "$document: the link $link leads nowhere"
    done
done >"$work/links"
# the files that contributors are sent to
grep -o '`[a-z]*/[a-z/_.]*[.][ch]`' CONTRIBUTING.md | tr -d '`' | sort -u | while read -r file; do
    [ -e "$file" ] || echo "CONTRIBUTING.md: there is no $file"
done >>"$work/links"
[ ! -s "$work/links" ] || fault "$(cat "$work/links")"

echo "documents: $blocks blocks tried, $faults faults"
[ $faults -eq 0 ]
