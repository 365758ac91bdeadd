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
# without a graphics card; what stands in for a part that is left out (*_alone, *_absent) would be there twice
files=$(find src -name '*.c' | sort | grep -v -e '^src/gpu/' -e '_alone[.]c$' -e '_absent[.]c$')
# the list of kinds, as the build makes it
cmake -DOUTPUT="$work/catalogue_kinds.h" "-DFILES=$(echo "$files" | sed "s|^|$PWD/|" | paste -sd ';')" -P cmake/kinds.cmake
for precision; do
    [ "$precision" = double ] && macro=-DSKEIN_DOUBLE || macro=
    flags="${BITS_FLAGS:-} $macro -O1 -std=gnu17 -ffp-contract=off -fno-math-errno -Wno-psabi -Iinclude -Isrc -I$work"
    # files of kernels once more for each instruction set, as CMakeLists.txt has them
    sets=plain
    printf '#include "base/isa.h"\n#ifdef SK_X86_ISAS\nseveral\n#endif\n' | "$compiler" $flags -E - | grep -q several &&
        sets='sse avx2 avx512'
    objects=
    for set in $sets; do
        case $set in
        plain) own=-DSK_WIDTH=16 ;;
        sse) own='-DSK_WIDTH=16 -msse4.1' ;;
        avx2) own='-DSK_WIDTH=32 -mavx2' ;;
        avx512) own='-DSK_WIDTH=64 -mavx2 -mavx512f -mavx512dq -mavx512bw -mavx512vl' ;;
        esac
        for file in $(grep -lE '^#ifn?def SK_ISA$' $files); do
            object=$work/$set-$(echo "$file" | tr / -).o
            "$compiler" $flags $own -DSK_ISA=$set -c "$file" -o "$object"
            objects="$objects $object"
        done
    done
    "$compiler" $flags $static $files $objects src/gpu/absent.c tests/elsewhere/bits.c -o "$work/bits" -lm -pthread
    "$launcher" "$work/bits"
done
