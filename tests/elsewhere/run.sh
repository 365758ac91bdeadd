#!/bin/sh
# The same bits on another processor: run.sh ROOT CROSS-COMPILER EMULATOR PRECISION...
# Builds the library and bits.c for it, in each PRECISION (float, double), and runs them there.
set -eu
cd "$1"
compiler=$2 emulator=$3
shift 3
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
# without a graphics card
files=$(ls src/*.c src/*/*.c | grep -v '^src/gpu/')
for precision; do
    [ "$precision" = double ] && macro=-DSKEIN_DOUBLE || macro=
    "$compiler" $macro -O1 -std=gnu17 -ffp-contract=off -fno-math-errno -Wno-psabi -static -Iinclude -Isrc \
        $files src/gpu/absent.c tests/elsewhere/bits.c -o "$work/bits" -lm -pthread
    "$emulator" "$work/bits"
done
