#!/bin/sh
# Kinds from outside, as somebody writes them: examples/own_force.c and own_method.c become shared objects with the public
# headers alone, and the command lists them, checks scenes that name them, steps them under every method, and draws them.
#     own_kinds.sh SKEIN C-COMPILER [DEFINITION...]
set -u
skein=$1 cc=$2
shift 2
folder=$(mktemp -d) || exit 1
trap 'rm -rf "$folder"' EXIT
faults=0
fault() {
    echo "own_kinds: $*"
    faults=$((faults + 1))
}
has() { # FILE WORDS: the words are in it
    grep -q -- "$2" "$1" || { fault "no '$2' in:"; cat "$1"; }
}

for name in own_force own_method; do
    "$cc" -std=c17 -O2 -ffp-contract=off "$@" -Iinclude -shared -fPIC "examples/$name.c" -o "$folder/$name.so" -lm || exit 1
done
cat >"$folder/fault.c" <<'C'
#include <skein/kinds.h>
static const skein_force_type bad = {.kind = {"bad", "a fault in its text", SKEIN_FORCE, NULL, 0, 0}, .formula = "p +"};
const skein_kind *const skein_module_kinds[] = {&bad.kind, NULL};
C
"$cc" -std=c17 "$@" -Iinclude -shared -fPIC "$folder/fault.c" -o "$folder/fault.so" || exit 1
export SKEIN_KINDS="$folder/own_force.so:$folder/own_method.so"

# ---- listed ----
"$skein" list forces >"$folder/list" || fault "list fails"
has "$folder/list" "  whirl: a whirlwind about the vertical axis"
has "$folder/list" "    width "
"$skein" list whirl --json >"$folder/json" || fault "list --json fails"
has "$folder/json" '"lift"'
"$skein" list methods >"$folder/list" && has "$folder/list" "  heun: "

# ---- set and checked ----
cat >"$folder/scene.json" <<'JSON'
{ "skein": 1, "name": "own", "frames": 6,
  "bodies": [ { "type": "cloth", "grid": [9, 9], "stretch": { "stiffness": 100 }, "shear": { "stiffness": 10 } } ],
  "forces": [ { "type": "gravity" }, { "type": "whirl", "lift": 20 } ] }
JSON
"$skein" check "$folder/scene.json" >"$folder/said" 2>&1 || { fault "its scene is not good"; cat "$folder/said"; }
"$skein" check "$folder/scene.json" --set forces.1.lfit=3 >"$folder/said" 2>&1 && fault "a misspelt field is taken"
has "$folder/said" "did you mean"
"$skein" check "$folder/scene.json" --set forces.1.width=0 >"$folder/said" 2>&1 && fault "a width of 0 is taken"
has "$folder/said" "forces.1.width"
SKEIN_KINDS= "$skein" check "$folder/scene.json" >"$folder/said" 2>&1 && fault "a kind that is not there is taken"
has "$folder/said" "there is no force 'whirl'"

# ---- stepped ----
hash_of() { # ARGUMENTS: of a run of the scene
    "$skein" run "$folder/scene.json" --no-progress --out "$folder/out" --set 'output=[]' "$@" >"$folder/said" 2>&1 ||
        { fault "a run fails: $*"; cat "$folder/said"; }
    sed -n 's/^state hash //p' "$folder/said"
}
for method in $(SKEIN_KINDS= "$skein" list methods | sed -n 's/^  \([a-z0-9_]*\): .*/\1/p') heun; do
    with() {
        hash_of --set "method={\"type\":\"$method\"}" "$@"
    }
    one=$(with) two=$(with --set forces.1.lift=10) three=$(with --set forces.1.turn=0) four=$(with --set forces.1.width=3)
    [ "$one" ] && [ "$one" != "$two" ] && [ "$one" != "$three" ] && [ "$one" != "$four" ] && [ "$two" != "$three" ] ||
        fault "under $method a field has no effect: $one $two $three $four"
done

# ---- on a card, or the processor that plays one ----
birds() {
    "$skein" run "$folder/birds.json" --no-progress --out "$folder/out" --set 'output=[]' "$@" >"$folder/said" 2>&1
}
cat >"$folder/birds.json" <<'JSON'
{ "skein": 1, "name": "own", "frames": 6, "method": { "type": "symplectic_euler" },
  "bodies": [ { "type": "flock", "count": 200, "spread": [2, 2, 2], "speed": 1 } ], "forces": [ { "type": "whirl" } ] }
JSON
if birds --device gpu; then
    one=$(sed -n 's/^state hash //p' "$folder/said")
    birds --device gpu --set forces.0.lift=10 || fault "a run on the card fails"
    [ "$one" != "$(sed -n 's/^state hash //p' "$folder/said")" ] || fault "on the card a field has no effect"
    birds --device gpu --set 'forces.0={"type":"gust"}' && fault "the card takes a force that is C"
    has "$folder/said" "gust cannot run on the graphics card"
    birds --device auto --set 'forces.0={"type":"gust"}' || fault "auto does not take the processor for a force that is C"
else
    grep -q "graphics card" "$folder/said" || { fault "a run on the card fails"; cat "$folder/said"; }
    echo "own_kinds: not tried on a card: $(head -1 "$folder/said")"
fi

# ---- faults are told ----
SKEIN_KINDS=$folder/fault.so "$skein" list forces >"$folder/said" 2>&1 && fault "a kind with a fault is taken"
has "$folder/said" "bad"
has "$folder/said" "column"
SKEIN_KINDS=$folder/none.so "$skein" list forces >"$folder/said" 2>&1 && fault "a file that is not there is taken"
has "$folder/said" "none.so"

echo "own_kinds: $faults faults"
[ "$faults" = 0 ]
