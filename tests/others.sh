#!/bin/sh
# Other people's readers judge what skein writes: others.sh SKEIN MODULES
# MODULES is the folder of node_modules that `tools/setup test` fills from tests/npm. Where there is no node, or no such
# folder, this ends with 77: the test is skipped.
set -u
skein=$1 modules=$2
here=$(dirname "$0")
if ! command -v node >/dev/null || [ ! -d "$modules/node_modules/gltf-validator" ] ||
    [ ! -d "$modules/node_modules/three" ]; then
    echo "skipped: no gltf-validator and three in $modules/node_modules; where node and npm are, 'tools/setup test' installs it"
    exit 77
fi
folder=$(mktemp -d) || exit 1
trap 'rm -rf "$folder"' EXIT

# A cloth with texture coordinates and a seam, a rope, a flock, and a soft body; one frame, and many.
cat >"$folder/seam.obj" <<'OBJ'
v 0 0 0
v 0 0 1
v 1 0 0
v 1 0 1
v 2 0.5 0
v 2 0.5 1
v 3 0.5 1
vt 0 0
vt 0 1
vt 0.5 1
vt 0.5 0
vt 1 1
vt 1 0
f 1/1 2/2 4/3 3/4
f 3/1 4/2 6/5 5/6
OBJ
"$skein" run "$folder/seam.obj" --frames 6 --quiet --out "$folder/seam.glb" || exit 1
"$skein" run "$folder/seam.obj" --frames 0 --quiet --out "$folder/still.glb" || exit 1
"$skein" run rope --frames 4 --quiet --out "$folder/rope.glb" || exit 1
"$skein" run birds --frames 2 --quiet --out "$folder/birds.glb" || exit 1
"$skein" run meshes/ball.node --frames 3 --quiet --scale 100 --out "$folder/ball.glb" || exit 1
"$skein" run flag --frames 10 --quiet --fps 24 --out "$folder/flag.glb" || exit 1
node "$here/npm/check_glb.cjs" "$modules" "$folder"/*.glb || exit 1

usda() { # SCENE NAME UP SCALE FPS
    "$skein" run "$1" --frames 4 --quiet --up "$3" --scale "$4" --fps "$5" --out "$folder/usd" \
        --set 'output=["pc2", "usda"]' && node "$here/npm/check_usda.mjs" "$modules" "$folder/usd" "$2" "$3" "$4" "$5"
}
usda "$folder/seam.obj" mesh y 1 60 && usda flag flag z 100 24 && usda rope slack z 0.01 30 && usda birds birds y 1 60
