#!/bin/sh
# The same bits on another processor: run.sh ROOT CROSS-COMPILER EMULATOR
# Builds the library and bits.c for it, in float and double, and runs them there.
set -eu
cd "$1"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
# without a graphics card
files=$(ls src/*.c src/*/*.c | grep -v '^src/gpu/')
for precision in "" -DSKEIN_DOUBLE; do
    "$2" $precision -O1 -std=gnu17 -ffp-contract=off -fno-math-errno -Wno-psabi -static -Iinclude -Isrc \
        $files src/gpu/absent.c tests/elsewhere/bits.c -o "$work/bits" -lm -pthread
    "$3" "$work/bits"
done
