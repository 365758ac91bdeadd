#!/bin/sh
# The same bits on another processor or with another compiler: run.sh ROOT COMPILER LAUNCHER PRECISION...
# Builds the library and bits.c with COMPILER, in each PRECISION (float, double), and has LAUNCHER run them: an
# emulator, or env. BITS_FLAGS may hold more for the compiler.
set -eu
cd "$1"
compiler=$2 launcher=$3
shift 3
[ "$launcher" = env ] && static= || static=-static # an emulator has no libraries
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
# without a graphics card
files=$(ls src/*.c src/*/*.c | grep -v '^src/gpu/')
for precision; do
    [ "$precision" = double ] && macro=-DSKEIN_DOUBLE || macro=
    "$compiler" ${BITS_FLAGS:-} $macro -O1 -std=gnu17 -ffp-contract=off -fno-math-errno -Wno-psabi $static -Iinclude -Isrc \
        $files src/gpu/absent.c tests/elsewhere/bits.c -o "$work/bits" -lm -pthread
    "$launcher" "$work/bits"
done
