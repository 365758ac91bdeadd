#!/bin/sh
# Programs outside of this project use the library: run.sh ROOT BUILD
#   1  installed into a fresh prefix: the shared library shows its own symbols only, and all of them
#   2  by pkg-config: C11 and C++17, gcc and clang, the shared library and the archive, and the archive in a plugin
#   3  by CMake: find_package, add_subdirectory and FetchContent, archive and shared library
#   4  the installed command finds what belongs to it, also when all of it has moved
# Each program prints the hash of its world, and all print the same. A compiler that is not there is said and left out.
set -u
root=$(cd "$1" && pwd) || exit 2
build=$(cd "$2" && pwd) || exit 2
work=$(mktemp -d) || exit 2
trap 'rm -rf "$work"' EXIT
unset CFLAGS CXXFLAGS LDFLAGS CC CXX PKG_CONFIG_LIBDIR LD_LIBRARY_PATH DESTDIR SKEIN_SCENES SKEIN_MODULES CMAKE_GENERATOR
faults=0 ran=0 first=''
fault() {
    echo "outside: $*" >&2
    faults=$((faults + 1))
}
has() { command -v "$1" >/dev/null || { echo "outside: there is no $1: left out"; false; }; }
# Runs quietly; its words are shown if it fails.
quietly() { "$@" >"$work/words" 2>&1 || { cat "$work/words" >&2; fault "failed: $*"; return 1; }; }
# A program's hash must be everybody's.
prints_the_hash() {
    hash=$("$@") || { fault "failed: $*"; return; }
    [ -n "$first" ] || first=$hash
    [ "$hash" = "$first" ] || fault "$* printed $hash, others $first"
    ran=$((ran + 1))
}

# ---- 1: what is installed ----
quietly cmake --install "$build" --prefix "$work/there" || exit 1
mv "$work/there" "$work/moved" # whoever unpacks a package does the same
prefix=$work/moved
PKG_CONFIG_PATH=$(dirname "$(find "$prefix" -name skein.pc)") # lib/pkgconfig, or lib/x86_64-linux-gnu/pkgconfig
export PKG_CONFIG_PATH
lib=$(pkg-config --variable=libdir skein) || { fault "pkg-config does not find skein"; exit 1; }
names() { awk 'NF == 3 && $2 ~ /[A-Z]/ { print $3 }' | sort -u; }
nm -D --defined-only "$lib/libskein.so" | names >"$work/shown"
nm -g --defined-only "$lib/libskein.a" 2>/dev/null | names | grep '^skein_' >"$work/public"
grep -v '^skein_' "$work/shown" && fault "the shared library shows more than its own symbols: above"
[ "$(wc -l <"$work/shown")" -ge 50 ] || fault "the shared library shows next to nothing"
diff "$work/public" "$work/shown" || fault "the shared library does not show the same as the archive has: above"
readelf -d "$lib/libskein.so" | grep -q 'SONAME.*\[libskein[.]so[.][0-9]*[.][0-9]*\]' || fault "no soname with a version"
[ "skein $(pkg-config --modversion skein)" = "$("$prefix/bin/skein" --version)" ] || fault "two versions"

# ---- 2: pkg-config ----
cp "$root/tests/outside/program.c" "$work/program.cpp"
cd "$work" || exit 2
flags=$(pkg-config --cflags skein)
shared="$(pkg-config --libs skein) -Wl,-rpath,$lib"
static="$lib/libskein.a $(pkg-config --static --libs skein | sed 's/-lskein//')"
for compiler in gcc clang g++ clang++; do
    has $compiler || continue
    case $compiler in
    *++) source=program.cpp standard=c++17 ;;
    *) source=$root/tests/outside/program.c standard=c11 ;;
    esac
    for how in shared static; do
        eval "libraries=\$$how"
        # shellcheck disable=SC2086 # they are lists
        quietly $compiler -std=$standard -Wall -Wextra -Wpedantic -Werror $flags "$source" $libraries \
            -o "$compiler-$how" && prints_the_hash "./$compiler-$how"
    done
    case $compiler in *++) continue ;; esac
    # shellcheck disable=SC2086
    quietly $compiler -shared -fPIC -Dmain=run_plugin $flags "$source" -Wl,--exclude-libs,ALL $static -o plugin.so &&
        quietly $compiler "$root/tests/outside/plugin.c" -ldl -o engine && prints_the_hash ./engine ./plugin.so
    nm -D --defined-only plugin.so | grep ' skein_' && fault "the plugin shows the library's symbols: above"
done

# ---- 3: CMake ----
# configure FOLDER C-COMPILER C++-COMPILER HOW SKEIN_ROOT [OPTION...]; then the programs run
project() {
    folder=$1 c=$2 cxx=$3 how=$4 from=$5
    shift 5
    quietly cmake -S "$root/tests/outside" -B "$work/$folder" -DCMAKE_C_COMPILER="$c" -DCMAKE_CXX_COMPILER="$cxx" \
        -DHOW="$how" -DSKEIN_ROOT="$from" "$@" && quietly cmake --build "$work/$folder" -j 2 || return
    for program in "$work/$folder/programs"/*; do
        prints_the_hash "$program"
    done
}
linked_to() { readelf -d "$work/$1/programs/in_c" | grep -q 'NEEDED.*libskein[.]so'; }

for pair in "gcc g++" "clang clang++"; do
    has "${pair% *}" && has "${pair#* }" || continue
    project "package-${pair% *}" "${pair% *}" "${pair#* }" package "$prefix"
    linked_to "package-${pair% *}" && fault "find_package took the shared library unasked"
done
project package-shared gcc g++ package "$prefix" -DBUILD_SHARED_LIBS=ON
linked_to package-shared || fault "find_package took the archive where BUILD_SHARED_LIBS is on"

# The library compiles in this project's own build: for one instruction set, as a debug build, that is half a minute.
quick='-DSKEIN_ONE_ISA=ON -DCMAKE_BUILD_TYPE=Debug -DCMAKE_C_FLAGS_DEBUG=-O0'
# shellcheck disable=SC2086
project sources gcc g++ subdirectory "$root" $quick
built=$(cd "$work/sources/skein" && find . -name CMakeFiles -prune -o -type f \( -perm -100 -o -name '*.a' -o -name '*.so*' \) -print)
[ "$built" = ./libskein.a ] || fault "as a subdirectory it builds more than its library:" $built
# shellcheck disable=SC2086
project sources gcc g++ fetch "$root" $quick -DBUILD_SHARED_LIBS=ON
linked_to sources || fault "as a subdirectory with BUILD_SHARED_LIBS it is no shared library"

# Of the other precision, packages say so.
quietly cmake -S "$root" -B "$work/double" -DSKEIN_APP=OFF -DSKEIN_EXAMPLES=OFF -DSKEIN_DOUBLE=ON
grep -q -e -DSKEIN_DOUBLE "$work/double/skein.pc" || fault "skein.pc of a double build does not say so"

# ---- 4: the installed command, from somewhere else ----
cd / || exit 2
skein=$prefix/bin/skein
heavy=$(readelf -d "$skein" | grep -e NEEDED | grep -e libav -e libsw) &&
    fault "the command loads libraries of films before one is asked for:" $heavy
for scene in "$prefix"/share/skein/scenes/*.json; do
    quietly "$skein" check "$scene"
done
if [ -n "$(find "$prefix" -name skein_film.so)" ]; then
    scene=$prefix/share/skein/scenes/drape.json
    quietly "$skein" render "$scene" -o "$work/a.gif" --frames 2 --size 64x36 --samples 1 --quiet
    [ -s "$work/a.gif" ] || fault "the installed command made no film"
fi

echo "outside: $ran programs ran, $faults faults"
[ $faults -eq 0 ]
