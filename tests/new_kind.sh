#!/bin/sh
# A new kind is one file: what is compiled for it are its own units, the list of kinds, and the list of shaders.
#     new_kind.sh C-COMPILER CMAKE [OPTION...]        (from the root)
# The archive is made from a copy of the sources by a compiler that only looks who includes whom. Then the file that
# docs/design.md shows as a whole new force is put there, and it is made once more.
set -u
cc=$1 cmake=$2
shift 2
folder=$(mktemp -d) || exit 1
trap 'rm -rf "$folder"' EXIT
mkdir -p "$folder/copy/render" || exit 1
cp -R CMakeLists.txt cmake include solvers src "$folder/copy" && cp render/embed.cmake "$folder/copy/render" || exit 1

# Stands before the compiler: of a unit of the library it writes what that includes, and an empty object.
cat >"$folder/launch" <<'SH'
#!/bin/sh
out= previous=
for word; do
    shift
    if [ "$previous" = -o ]; then out=$word; fi
    case $previous,$word in
    -o,*skein_library*.o) set -- "$@" /dev/null ;;
    *) set -- "$@" "$word" ;;
    esac
    previous=$word
done
case $out in
*skein_library*.o) "$@" -E && : >"$out" ;;
*) exec "$@" ;;
esac
SH
chmod +x "$folder/launch"
"$cmake" -G Ninja -S "$folder/copy" -B "$folder/build" -DCMAKE_C_COMPILER="$cc" "$@" \
    -DCMAKE_C_COMPILER_LAUNCHER="$folder/launch" -DSKEIN_APP=OFF -DSKEIN_CHOLMOD=OFF -DSKEIN_EXAMPLES=OFF \
    -DSKEIN_INSTALL=OFF -DSKEIN_TESTS=OFF -DSKEIN_ONE_ISA=ON -DBUILD_SHARED_LIBS=OFF >"$folder/words" 2>&1 ||
    { cat "$folder/words"; exit 1; }
"$cmake" --build "$folder/build" --target skein_library >"$folder/words" 2>&1 || { tail -20 "$folder/words"; exit 1; }
all=$(grep -c 'Building C object' "$folder/words")

sed -n '/^```c src\/forces\/attractor.c$/,/^```$/p' docs/design.md | sed '1d;$d' >"$folder/copy/src/forces/attractor.c"
[ -s "$folder/copy/src/forces/attractor.c" ] || { echo "new_kind: docs/design.md shows no src/forces/attractor.c"; exit 1; }
"$cmake" --build "$folder/build" --target skein_library >"$folder/words" 2>&1 || { tail -20 "$folder/words"; exit 1; }
compiled=$(sed -n 's/.*Building C object .*dir\/\(.*\)\.o$/\1/p' "$folder/words" | sort -u)
[ "$(echo $compiled)" = "library_shaders.c src/catalogue.c src/forces/attractor.c" ] ||
    [ "$(echo $compiled)" = "src/catalogue.c src/forces/attractor.c" ] || { # (where there is no card)
    echo "new_kind: for one new force these are compiled:"
    echo "$compiled"
    exit 1
}
count=$(grep -c 'Building C object' "$folder/words")
echo "new_kind: a new force is $count units of $all: $(echo $compiled)"
[ "$all" -gt 100 ]
