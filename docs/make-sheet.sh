#!/bin/sh
# Makes docs/images/framing.jpg: a still of every scene by an older Skein and by this one, side by side, each as
# `skein render SCENE -o a.png` takes it, at the last frame. The older one is a checkout of its own, with its scenes, that
# was built (git worktree add ../older 39fcedf; a scene that it lacks is left grey). Needs ImageMagick.
#     docs/make-sheet.sh OLDER_CHECKOUT
set -u
cd "$(dirname "$0")/.." || exit 1
older=${1:?make-sheet: which folder has the older Skein, with build/skein in it?}
work=$(mktemp -d) || exit 1
trap 'rm -rf "$work"' EXIT
for scene in scenes/*.json; do
    name=$(basename "$scene" .json)
    for side in before after; do
        root=.
        [ $side = after ] || root=$older
        (cd "$root" && build/skein render "scenes/$name.json" -o "$work/$name.$side.png" --size 256x144 --quiet) 2>/dev/null
        # a run that is judged to end badly has its picture all the same
        [ -s "$work/$name.$side.png" ] || convert -size 256x144 xc:grey85 "$work/$name.$side.png"
    done
    montage -label "$name: before" "$work/$name.before.png" -label after "$work/$name.after.png" -tile 2x1 \
        -geometry +1+1 -pointsize 11 "$work/pair.$name.png" || exit 1
done
montage "$work"/pair.*.png -tile 3x -geometry +4+3 -quality 82 docs/images/framing.jpg
ls -l docs/images/framing.jpg
