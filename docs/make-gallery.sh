#!/bin/sh
# Writes docs/gallery.md: every scene with its picture and what it shows, in the words of its own file. --pictures draws
# the pictures anew before (256 x 144, as many frames in as tell most of the scene: three tenths, 150 at most).
#     docs/make-gallery.sh [--pictures] [SKEIN] >docs/gallery.md
set -u
cd "$(dirname "$0")/.." || exit 1
pictures=docs/images/scenes draw=no
if [ "${1-}" = --pictures ]; then draw=yes && shift; fi
skein=${1-build/skein}

# The text of a field at the top of a scene, in one line.
field() { sed -n "s/^  \"$2\": *\"\{0,1\}\(.*[^\",]\)\"\{0,1\},\{0,1\}\$/\1/p" "$1" | head -n 1 | sed 's/\\"/"/g'; }

cat <<'HEAD'
# Scenes that come with Skein

Made by `docs/make-gallery.sh >docs/gallery.md` from the scenes' own words; do not edit it by hand. `skein list scenes`
prints the same list, `skein view NAME` opens a scene in a window, and `skein view` shows all of them there. Each has a page
with what it is made of, and what its first second comes to.
[One sheet](images/framing.jpg) has the stills of most of them twice: as commit 39fcedf framed them, and as they are today.

| | scene | what it shows |
|---|---|---|
HEAD
for scene in scenes/*.json; do
    name=$(basename "$scene" .json)
    frames=$(sed -n 's/.*"frames": *\([0-9]*\).*/\1/p' "$scene" | head -n 1)
    frame=$((${frames:-240} * 3 / 10))
    [ $frame -le 150 ] || frame=150
    if [ $draw = yes ]; then
        "$skein" render "$scene" -o "$pictures/$name.png" --frame $frame --size 256x144 --samples 8 --quiet ||
            echo "gallery: $name has no new picture" >&2
    fi
    cell=
    [ ! -s "$pictures/$name.png" ] || cell="![$name](images/scenes/$name.png)"
    printf '| %s | [`%s`](scenes/%s.md) | %s |\n' "$cell" "$name" "$name" "$(field "$scene" description | sed 's/|/\\|/g')"
done
